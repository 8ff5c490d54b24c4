"""The end of a step: memories, the new state, divergence, means and what is kept of the trajectory."""

OUTCOME = """\
        for i in range(NODES):
            # The rate at the corrected middle of the step: with the predicted one a stiff branch would feed back.
            for b in range(BLOCK):
                c_rate[i, b] = 0.0
            for j in range(n):
                Cij = C[i, j]
                for b in range(BLOCK):
                    c_rate[i, b] += Cij * (v[j, b] + 0.5 * h * acc[j, b])
@REMEMBERED@
        for d in range(D):
            j = dynamic[d]
            for b in range(BLOCK):
                u[j, b] += h * v[j, b] + 0.5 * h * h * acc[j, b]
                v[j, b] += h * acc[j, b]
                before[j, b] = last[j, b] if step > 0 else acc[j, b]
                last[j, b] = acc[j, b]
        if not free_theta:
            for b in range(BLOCK):
                u[n, b] = mid[n, b] + 0.5 * h * mid_rate[n, b] + 0.125 * h * h * acc[n, b]
                v[n, b] = mid_rate[n, b] + 0.5 * h * acc[n, b]
        else:
            for b in range(BLOCK):
                integral[b] += h * (base[0, step, base_lane[b]] - mid[n, b])
        for d in range(D):
            j = dynamic[d]
            for b in range(BLOCK):
                if not (abs(u[j, b]) < 1e3 and abs(v[j, b]) < 1e6):
                    if diverged[b] < 0.0:
                        diverged[b] = t
                    u[j, b] = 0.0; v[j, b] = 0.0; last[j, b] = 0.0; before[j, b] = 0.0; integral[b] = 0.0
        for b in range(BLOCK):
            window[0, b] += fluid_x[b]
            window[1, b] += fluid_y[b]
            window[2, b] += residual[n + 1, b] if not free_rail else fluid_y[b]
            window[3, b] += torque[b]
        if step >= average_from:
            for b in range(BLOCK):
                sums[0, b] += fluid_x[b]
                sums[1, b] += fluid_y[b]
                sums[2, b] += torque[b] * mid_rate[n, b]
                sums[3, b] += max(torque[b] * mid_rate[n, b], 0.0)
        if stride > 0 and (step + 1) % stride == 0:
            for b in range(BLOCK):
                if first + b < count:
                    for j in range(columns):
                        out_u[stored, j, first + b] = u[j, b]
                        out_rate[stored, j, first + b] = v[j, b]
                    for k in range(4):
                        out_force[stored - 1, k, first + b] = window[k, b] / stride
            stored += 1
            for k in range(4):
                for b in range(BLOCK):
                    window[k, b] = 0.0
    kept = max(steps - average_from, 1)
    for b in range(BLOCK):
        if first + b < count:
            for k in range(4):
                summary[k, first + b] = sums[k, b] / kept
            summary[4, first + b] = diverged[b]
            for j in range(columns):
                summary[5 + j, first + b] = u[j, b]
                summary[5 + columns + j, first + b] = v[j, b]

"""

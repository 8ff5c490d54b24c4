"""The end of a step: memories, the new state, divergence, means and what is kept of the trajectory."""

TRAJECTORY = """\
        if stride > 0 and (step + 1) % stride == 0:
            for b in range(BLOCK):
                if first + b < count:
                    for j in range(D):
                        out_u[stored, j, first + b] = u[j, b]
                        out_rate[stored, j, first + b] = v[j, b]
                    for k in range(4):
                        out_force[stored - 1, k, first + b] = window[k, b] / float(stride)
            if out_past.shape[0] > 0:
                for b in range(BLOCK):
                    if first + b < count:
                        for j in range(D):
                            out_past[stored - 1, j, first + b] = last[j, b]
                            out_past[stored - 1, D + j, first + b] = before[j, b]
                        out_past[stored - 1, 2 * D, first + b] = integral[b]
                        for slot in range(start_store.shape[0]):
                            for i in range(NODES):
                                out_store[stored - 1, slot, i, first + b] = store[slot, i, b]
            stored += 1
            for k in range(4):
                for b in range(BLOCK):
                    window[k, b] = 0.0
"""

SUMMARY = """\
    kept = max(steps - average_from, 1)
    for b in range(BLOCK):
        if first + b < count:
            for k in range(4):
                summary[k, first + b] = sums[k, b] / float(kept)
            summary[4, first + b] = diverged[b]
            for j in range(D):
                summary[5 + j, first + b] = u[j, b]
                summary[5 + D + j, first + b] = v[j, b]
"""

OUTCOME = """\
        if @REMEMBERS@:
            for i in range(NODES):
                # The rate at the corrected middle of the step: with the predicted one a stiff branch would feed back.
                for b in range(BLOCK):
                    c_rate[i, b] = total(C[i, j] * (v[j, b] + 0.5 * h * acc[j, b]) for j in unrolled(n))
@REMEMBERED@
        for b in range(BLOCK):
            for j in unrolled(n):
                u[j, b] += h * v[j, b] + 0.5 * h * h * acc[j, b]
                v[j, b] += h * acc[j, b]
        if free_theta:
            for b in range(BLOCK):
                integral[b] += h * (command[0, b] - mid[n, b])
                u[n, b] += h * v[n, b] + 0.5 * h * h * acc[n, b]
                v[n, b] += h * acc[n, b]
        else:
            for b in range(BLOCK):
                u[n, b] = mid[n, b] + 0.5 * h * mid_rate[n, b] + 0.125 * h * h * acc[n, b]
                v[n, b] = mid_rate[n, b] + 0.5 * h * acc[n, b]
        if free_rail:
            for b in range(BLOCK):
                u[n + 1, b] += h * v[n + 1, b] + 0.5 * h * h * acc[n + 1, b]
                v[n + 1, b] += h * acc[n + 1, b]
        for _ in unrolled(FREE):
            for b in range(BLOCK):
                u[n + 2, b] += h * v[n + 2, b] + 0.5 * h * h * acc[n + 2, b]
                v[n + 2, b] += h * acc[n + 2, b]
        started = 1.0 if step + age > 0 else 0.0
        sound = 0.0
        for b in range(BLOCK):
            within = 1.0
            for j in unrolled(D):
                before[j, b] = started * last[j, b] + (1.0 - started) * acc[j, b]
                last[j, b] = acc[j, b]
                within *= 1.0 if (abs(u[j, b]) < 1e3) & (abs(v[j, b]) < 1e6) else 0.0
            sound += within
        if sound < float(BLOCK):
            for b in range(BLOCK):
                within = 1.0
                for j in range(D):
                    within *= 1.0 if (abs(u[j, b]) < 1e3) & (abs(v[j, b]) < 1e6) else 0.0
                if within == 0.0:
                    if diverged[b] < 0.0:
                        diverged[b] = t[b]
                    integral[b] = 0.0
                    for j in range(D):
                        u[j, b] = 0.0
                        v[j, b] = 0.0
                        last[j, b] = 0.0
                        before[j, b] = 0.0
                    for i in range(NODES):
                        for slot in range(start_store.shape[0]):
                            store[slot, i, b] = 0.0
        rail_share = 1.0 if free_rail else 0.0
        counts = 1.0 if step >= average_from else 0.0
        for b in range(BLOCK):
            power = torque[b] * mid_rate[n, b]
            for _ in unrolled(FREE):
                power = torque[b] * command[1, b]  # the servo turns the arm against the hull
            window[0, b] += fluid_x[b]
            window[1, b] += fluid_y[b]
            window[2, b] += rail_share * fluid_y[b] + (1.0 - rail_share) * residual[n + 1, b]
            window[3, b] += torque[b]
            sums[0, b] += counts * fluid_x[b]
            sums[1, b] += counts * fluid_y[b]
            sums[2, b] += counts * power
            sums[3, b] += counts * (power if power > 0.0 else 0.0)
@KEPT@
@SUMMARY@
"""

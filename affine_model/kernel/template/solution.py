"""Point masses at the tip, servo and rail, and the solution for the correction of the accelerations."""

SOLUTION = """\
            # Point masses: the payload at s = 1, and what hangs from the tip at a reach along its tangent.
            for body in range(2):
                heaviest = 0.0
                for b in range(BLOCK):
                    point[b] = tip_mass[b] if body == 0 else hung_mass[b]
                    ahead[b] = 0.0 if body == 0 else hung_reach[b]
                    heaviest = max(heaviest, abs(point[b]))
                if heaviest == 0.0:
                    continue
                for b in range(BLOCK):
                    tip_phi[b] = mid[n, b]
                    tip_rate[b] = mid_rate[n, b]
                    tip_twist[b] = acc[n, b]
                for j in range(n):
                    for b in range(BLOCK):
                        tip_phi[b] += A_end[j] * mid[j, b]
                        tip_rate[b] += A_end[j] * mid_rate[j, b]
                        tip_twist[b] += A_end[j] * acc[j, b]
                for b in range(BLOCK):
                    tip_sine[b], tip_cosine[b] = sincos(tip_phi[b])
                for j in range(n + 1):
                    for b in range(BLOCK):
                        tip_x[j, b] = @SUM_TIP_X@
                        tip_y[j, b] = @SUM_TIP_Y@
                        tip_x[j, b] -= ahead[b] * A_end[j] * tip_cosine[b]
                        tip_y[j, b] -= ahead[b] * A_end[j] * tip_sine[b]
                for b in range(BLOCK):
                    acceleration_x[b] = @SUM_TIP_SWING_X@
                    acceleration_y[b] = acc[n + 1, b] + @SUM_TIP_SWING_Y@
                    acceleration_x[b] -= ahead[b] * tip_cosine[b] * tip_twist[b]
                    acceleration_y[b] -= ahead[b] * tip_sine[b] * tip_twist[b]
                    acceleration_x[b] += ahead[b] * tip_sine[b] * tip_rate[b] * tip_rate[b]
                    acceleration_y[b] -= ahead[b] * tip_cosine[b] * tip_rate[b] * tip_rate[b]
                for j in range(columns):
                    for b in range(BLOCK):
                        residual[j, b] += point[b] * (tip_x[j, b] * (gravity_x[b] - acceleration_x[b])
                                                      + tip_y[j, b] * (gravity_y[b] - acceleration_y[b]))
                for d in range(D):
                    j = dynamic[d]
                    for e in range(d + 1):
                        l = dynamic[e]
                        for b in range(BLOCK):
                            matrix[d, e, b] += point[b] * (tip_x[j, b] * tip_x[l, b] + tip_y[j, b] * tip_y[l, b])
            for b in range(BLOCK):
                torque[b] = -residual[n, b]  # what the servo must give so that the base moves as prescribed
            if free_theta:
                # PID servo with torque limit and rotor inertia; the base table holds the command.
                d = n
                for b in range(BLOCK):
                    error = base[0, step, base_lane[b]] - mid[n, b]
                    error_rate = base[1, step, base_lane[b]] - mid_rate[n, b]
                    wanted = servo[0] * error + servo[1] * (integral[b] + 0.5 * h * error) + servo[2] * error_rate
                    given = min(max(wanted, -servo[3]), servo[3])
                    torque[b] = given
                    residual[n, b] += given - servo[4] * acc[n, b]
                    matrix[d, d, b] += servo[4]
                    if wanted == given:
                        matrix[d, d, b] += 0.5 * h * servo[2] + 0.25 * h * h * (servo[0] + 0.5 * h * servo[1])
            if free_rail:
                d = D - 1
                for b in range(BLOCK):
                    grip = math.tanh(mid_rate[n + 1, b] / rail[3])
                    residual[n + 1, b] -= rail[0] * acc[n + 1, b] + rail[1] * mid_rate[n + 1, b] + rail[2] * grip
                    matrix[d, d, b] += rail[0] + 0.5 * h * (rail[1] + rail[2] * (1.0 - grip * grip) / rail[3])
            # Cholesky solution for the correction of the acceleration, lane by lane.
            for d in range(D):
                for e in range(d + 1):
                    for k in range(e):
                        for b in range(BLOCK):
                            matrix[d, e, b] -= matrix[d, k, b] * matrix[e, k, b]
                    if e == d:
                        for b in range(BLOCK):
                            matrix[d, d, b] = 1.0 / math.sqrt(matrix[d, d, b])
                    else:
                        for b in range(BLOCK):
                            matrix[d, e, b] *= matrix[e, e, b]
            for d in range(D):
                j = dynamic[d]
                for k in range(d):
                    l = dynamic[k]
                    for b in range(BLOCK):
                        residual[j, b] -= matrix[d, k, b] * residual[l, b]
                for b in range(BLOCK):
                    residual[j, b] *= matrix[d, d, b]
            for reverse in range(D):
                d = D - 1 - reverse
                j = dynamic[d]
                for k in range(d + 1, D):
                    l = dynamic[k]
                    for b in range(BLOCK):
                        residual[j, b] -= matrix[k, d, b] * residual[l, b]
                for b in range(BLOCK):
                    residual[j, b] *= matrix[d, d, b]
            for d in range(D):
                j = dynamic[d]
                for b in range(BLOCK):
                    acc[j, b] += residual[j, b]
"""

"""Point masses at the tip, servo and rail, and the solution for the correction of the accelerations."""

SOLUTION = """\
            # Point masses: the payload at s = 1, and what hangs from the tip at a reach along its tangent.
            for body in range(2):
                whole = 0.0
                for b in range(BLOCK):
                    point[b] = tip_mass[b] if body == 0 else hung_mass[b]
                    ahead[b] = 0.0 if body == 0 else hung_reach[b]
                    whole += abs(point[b])
                if whole == 0.0:
                    continue
                for b in range(BLOCK):
                    tip_rate = mid_rate[n, b] + total(A_end[j] * mid_rate[j, b] for j in unrolled(n))
                    tip_twist = acc[n, b] + total(A_end[j] * acc[j, b] for j in unrolled(n))
                    sine, cosine = sincos(mid[n, b] + total(A_end[j] * mid[j, b] for j in unrolled(n)))
                    for j in unrolled(n + 1):
                        tip_x[j, b] = (total(LwA[j, k] * normal_x[k, b] for k in unrolled(NODES))
                                       - ahead[b] * A_end[j] * cosine)
                        tip_y[j, b] = (total(LwA[j, k] * normal_y[k, b] for k in unrolled(NODES))
                                       - ahead[b] * A_end[j] * sine)
                    tip_x[n + 1, b] = 0.0
                    tip_y[n + 1, b] = 1.0
                    pull_x = gravity_x[b] - total(Lw[k] * swing_x[k, b] for k in unrolled(NODES))
                    pull_y = gravity_y[b] - total(Lw[k] * swing_y[k, b] for k in unrolled(NODES)) - acc[n + 1, b]
                    pull_x -= ahead[b] * (sine * tip_rate * tip_rate - cosine * tip_twist)
                    pull_y += ahead[b] * (cosine * tip_rate * tip_rate + sine * tip_twist)
                    for j in unrolled(n + 2):
                        residual[j, b] += point[b] * (tip_x[j, b] * pull_x + tip_y[j, b] * pull_y)
                        for l in unrolled(j + 1):
                            matrix[j, l, b] += point[b] * (tip_x[j, b] * tip_x[l, b] + tip_y[j, b] * tip_y[l, b])
            for b in range(BLOCK):
                torque[b] = -residual[n, b]  # what the servo must give so that the base moves as prescribed
            if free_theta:
                # PID servo with torque limit and rotor inertia; the base table holds the command.
                for b in range(BLOCK):
                    error = command[0, b] - mid[n, b]
                    error_rate = command[1, b] - mid_rate[n, b]
                    wanted = servo[0] * error + servo[1] * (integral[b] + 0.5 * h * error) + servo[2] * error_rate
                    given = min(max(wanted, -servo[3]), servo[3])
                    follows = 1.0 if wanted == given else 0.0
                    torque[b] = given
                    residual[n, b] += given - servo[4] * acc[n, b]
                    matrix[n, n, b] += servo[4] + follows * (
                        0.5 * h * servo[2] + 0.25 * h * h * (servo[0] + 0.5 * h * servo[1]))
            if free_rail:
                for b in range(BLOCK):
                    residual[n + 1, b] -= rail[0] * acc[n + 1, b] + rail[1] * mid_rate[n + 1, b]
                    matrix[n + 1, n + 1, b] += rail[0] + 0.5 * h * rail[1]
                if rail[2] > 0.0:
                    for b in range(BLOCK):
                        grip = math.tanh(mid_rate[n + 1, b] / rail[3])
                        residual[n + 1, b] -= rail[2] * grip
                        matrix[n + 1, n + 1, b] += 0.5 * h * rail[2] * (1.0 - grip * grip) / rail[3]
@SOLUTION@
"""

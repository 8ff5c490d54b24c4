"""Point masses at the tip, servo, rail or hull, and the solution for the correction of the accelerations."""

SOLUTION = """\
@TIP_FORCES@
            # Compact bodies at the tip: the payload, and what hangs there undeclared.
            for body in range(BODIES):
                whole = 0.0
                for b in range(BLOCK):
                    whole += abs(body_mass[body, b])
                if whole > 0.0:
                    for b in range(BLOCK):
                        reach = body_reach[body, b]
                        drop = body_drop[body, b]
                        displaced = body_displaced[body, b]
                        carries = 0.5 * displaced  # a sphere's: affine_model.dynamics.BODY_ADDED_MASS
                        heavy_mass = body_mass[body, b]
                        tip_rate = mid_rate[n, b] + total(A_end[j] * mid_rate[j, b] for j in unrolled(n))
                        tip_twist = acc[n, b] + total(A_end[j] * acc[j, b] for j in unrolled(n))
                        sine, cosine = sincos(mid[n, b] + total(A_end[j] * mid[j, b] for j in unrolled(n)))
                        place_x = drop * cosine - reach * sine
                        place_y = drop * sine + reach * cosine
                        for j in unrolled(n + 1):
                            tip_x[j, b] = (length * total(wA[j, k] * normal_x[k, b] for k in unrolled(NODES))
                                           - A_end[j] * place_y)
                            tip_y[j, b] = (length * total(wA[j, k] * normal_y[k, b] for k in unrolled(NODES))
                                           + A_end[j] * place_x)
                        tip_x[n + 1, b] = 0.0
                        tip_y[n + 1, b] = 1.0
                        for _ in unrolled(FREE):
                            tip_x[n + 2, b] = 1.0
                            tip_y[n + 2, b] = 0.0
                        body_x = (travel[4, b] + length * total(w[k] * swing_x[k, b] for k in unrolled(NODES))
                                  - place_y * tip_twist - place_x * tip_rate * tip_rate)
                        body_y = (travel[5, b] + acc[n + 1, b]
                                  + length * total(w[k] * swing_y[k, b] for k in unrolled(NODES))
                                  + place_x * tip_twist - place_y * tip_rate * tip_rate)
                        for _ in unrolled(FREE):
                            body_x += acc[n + 2, b]
                        flow_x = (displaced + carries) * surge_x[b] - carries * body_x
                        flow_y = (displaced + carries) * surge_y[b] - carries * body_y
                        fluid_x[b] += flow_x
                        fluid_y[b] += flow_y
                        pull_x = (heavy_mass - displaced) * gravity_x[b] - heavy_mass * body_x + flow_x
                        pull_y = (heavy_mass - displaced) * gravity_y[b] - heavy_mass * body_y + flow_y
                        inertia = heavy_mass + carries
                        for j in unrolled(D):
                            residual[j, b] += tip_x[j, b] * pull_x + tip_y[j, b] * pull_y
                            for l in unrolled(j + 1):
                                matrix[j, l, b] += inertia * (tip_x[j, b] * tip_x[l, b] + tip_y[j, b] * tip_y[l, b])
            for b in range(BLOCK):
                torque[b] = -residual[n, b]  # what the servo must give so that the base moves as prescribed
            for _ in unrolled(1 - FREE):
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
            # A hull that floats freely (affine_model.free_body): yaw = theta - command.
            for _ in unrolled(FREE):
                for b in range(BLOCK):
                    yaw_rate = mid_rate[n, b] - command[1, b]
                    sine, cosine = sincos(mid[n, b] - command[0, b])
                    drift_x = mid_rate[n + 2, b] - water_x[b]
                    drift_y = mid_rate[n + 1, b] - water_y[b]
                    across = drift_x * cosine + drift_y * sine
                    along = drift_y * cosine - drift_x * sine
                    drag_n = (rail[2] + rail[4] * abs(across)) * across
                    drag_t = (rail[3] + rail[5] * abs(along)) * along
                    slip_n = 0.5 * h * (rail[2] + 2.0 * rail[4] * abs(across))
                    slip_t = 0.5 * h * (rail[3] + 2.0 * rail[5] * abs(along))
                    residual[n, b] -= rail[1] * (acc[n, b] - command[2, b])
                    residual[n, b] -= (rail[6] + rail[7] * abs(yaw_rate)) * yaw_rate
                    residual[n + 1, b] -= rail[0] * acc[n + 1, b] + drag_n * sine + drag_t * cosine
                    residual[n + 2, b] -= rail[0] * acc[n + 2, b] + drag_n * cosine - drag_t * sine
                    matrix[n, n, b] += rail[1] + 0.5 * h * (rail[6] + 2.0 * rail[7] * abs(yaw_rate))
                    matrix[n + 1, n + 1, b] += rail[0] + slip_n * sine * sine + slip_t * cosine * cosine
                    matrix[n + 2, n + 1, b] += (slip_n - slip_t) * cosine * sine
                    matrix[n + 2, n + 2, b] += rail[0] + slip_n * cosine * cosine + slip_t * sine * sine
@SOLUTION@
"""

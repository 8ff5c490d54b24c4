"""A step's predictor, the motion of all sections at mid-step, and the assembly of residual and matrix over them."""

TABLE = """\
        if own_base:
            for b in range(BLOCK):
                for k in unrolled(3):
                    command[k, b] = base[k, step, first + b]
        else:
            for b in range(BLOCK):
                for k in unrolled(3):
                    command[k, b] = base[k, step, base_lane[b]]
        if base.shape[0] > 3:
            for b in range(BLOCK):
                for k in unrolled(6):
                    travel[k, b] = base[3 + k, step, base_lane[b]]
"""

MOTION = """\
    for step in range(steps):
        for b in range(BLOCK):
            t[b] = t0[lane[b]] + (float(step) + 0.5) * h
        # Predictor: the mean acceleration of the step, extrapolated from the two before.
        for b in range(BLOCK):
            for j in unrolled(D):
                acc[j, b] = 2.0 * last[j, b] - before[j, b]
        # The water's velocity and acceleration that are the same everywhere.
        for b in range(BLOCK):
            stream_x[b] = 0.0
            stream_y[b] = 0.0
            rush_x[b] = 0.0
            rush_y[b] = 0.0
@STREAM@
@COMMAND@
        if not free_theta:
            for b in range(BLOCK):
                mid[n, b] = command[0, b]
                mid_rate[n, b] = command[1, b]
                acc[n, b] = command[2, b]
        rounds = iterations if step + age > 1 else iterations + 3
        for iteration in range(cautious + rounds):
            # Laws that level off take some corrections more. The other lanes wait, so that no lane changes another.
            usual = 1.0 if iteration >= cautious else 0.0
            for b in range(BLOCK):
                eager[b] = grip[b] + (1.0 - grip[b]) * usual
            for b in range(BLOCK):
                for j in unrolled(n):
                    mid[j, b] = u[j, b] + 0.5 * h * v[j, b] + 0.25 * h * h * acc[j, b]
                    mid_rate[j, b] = v[j, b] + 0.5 * h * acc[j, b]
            if free_theta:
                for b in range(BLOCK):
                    mid[n, b] = u[n, b] + 0.5 * h * v[n, b] + 0.25 * h * h * acc[n, b]
                    mid_rate[n, b] = v[n, b] + 0.5 * h * acc[n, b]
            if free_rail:
                for b in range(BLOCK):
                    mid_rate[n + 1, b] = v[n + 1, b] + 0.5 * h * acc[n + 1, b]
            for _ in unrolled(FREE):
                for b in range(BLOCK):
                    mid[n + 1, b] = u[n + 1, b] + 0.5 * h * v[n + 1, b] + 0.25 * h * h * acc[n + 1, b]
                    mid[n + 2, b] = u[n + 2, b] + 0.5 * h * v[n + 2, b] + 0.25 * h * h * acc[n + 2, b]
                    mid_rate[n + 2, b] = v[n + 2, b] + 0.5 * h * acc[n + 2, b]
            for i in range(NODES):
                for b in range(BLOCK):
                    angle = mid[n, b] + total(A[i, j] * mid[j, b] for j in unrolled(n))
                    turning = mid_rate[n, b] + total(A[i, j] * mid_rate[j, b] for j in unrolled(n))
                    twisting = acc[n, b] + total(A[i, j] * acc[j, b] for j in unrolled(n))
                    sine, cosine = sincos(angle)
                    phi[i, b] = angle
                    phi_rate[i, b] = turning
                    twist[i, b] = twisting
                    c[i, b] = total(C[i, j] * mid[j, b] for j in unrolled(n)) - natural[i, b]
                    c_rate[i, b] = total(C[i, j] * mid_rate[j, b] for j in unrolled(n))
                    normal_x[i, b] = cosine
                    normal_y[i, b] = sine
                    swing_x[i, b] = sine * turning * turning - cosine * twisting
                    swing_y[i, b] = -cosine * turning * turning - sine * twisting
@TIP_CHANGING@
            for b in range(BLOCK):
                fluid_x[b] = 0.0
                fluid_y[b] = 0.0
                for j in unrolled(D):
                    residual[j, b] = 0.0
                    for l in unrolled(j + 1):
                        matrix[j, l, b] = 0.0
            for i in range(NODES):
                for b in range(BLOCK):
                    for j in unrolled(n + 1):
                        jac_x[j, i, b] = length * total(WA[j, i, k] * normal_x[k, b] for k in unrolled(NODES))
                        jac_y[j, i, b] = length * total(WA[j, i, k] * normal_y[k, b] for k in unrolled(NODES))
                    velocity_x[b] = travel[2, b] + total(jac_x[j, i, b] * mid_rate[j, b] for j in unrolled(n + 1))
                    velocity_y[b] = (travel[3, b] + mid_rate[n + 1, b]
                                     + total(jac_y[j, i, b] * mid_rate[j, b] for j in unrolled(n + 1)))
                    acceleration_x[b] = travel[4, b] + length * total(W[i, k] * swing_x[k, b] for k in unrolled(NODES))
                    acceleration_y[b] = (travel[5, b] + acc[n + 1, b]
                                         + length * total(W[i, k] * swing_y[k, b] for k in unrolled(NODES)))
                    # The base angle's lever arm is the position itself: dr/d theta = (-y, x).
                    x[i, b] = travel[0, b] + jac_y[n, i, b]
                    y[i, b] = travel[1, b] - jac_x[n, i, b]
                    for _ in unrolled(FREE):
                        velocity_x[b] += mid_rate[n + 2, b]
                        acceleration_x[b] += acc[n + 2, b]
                        x[i, b] += mid[n + 2, b]
                        y[i, b] += mid[n + 1, b]
                    water_x[b] = stream_x[b]
                    water_y[b] = stream_y[b]
                    surge_x[b] = rush_x[b]
                    surge_y[b] = rush_y[b]
@WATER@
                for b in range(BLOCK):
                    relative_x = velocity_x[b] - water_x[b]
                    relative_y = velocity_y[b] - water_y[b]
                    u_n[i, b] = relative_x * normal_x[i, b] + relative_y * normal_y[i, b]
                    u_t[i, b] = relative_y * normal_x[i, b] - relative_x * normal_y[i, b]
                    speed[i, b] = math.sqrt(u_n[i, b] * u_n[i, b] + u_t[i, b] * u_t[i, b] + 1e-16)
                    force_n[b] = 0.0
                    force_t[b] = 0.0
                    slope_n[b] = 0.0
                    slope_t[b] = 0.0
@SECTION_CHANGING@
@FORCES@
                for b in range(BLOCK):
                    bend[i, b] = 0.25 * h * h * stiffness[i, b]
                    moment[i, b] = stiffness[i, b] * c[i, b]
@MOMENTS@
                for b in range(BLOCK):
                    nx = normal_x[i, b]
                    ny = normal_y[i, b]
                    # Added mass: f = -d/dt(m_a u_n n), with the couple m_a u_n u_t (Lighthill 1960).
                    drift_x = acceleration_x[b] - surge_x[b]
                    drift_y = acceleration_y[b] - surge_y[b]
                    along_n = force_n[b] - added[i, b] * (drift_x * nx + drift_y * ny + phi_rate[i, b] * u_t[i, b])
                    along_t = force_t[b] - added[i, b] * phi_rate[i, b] * u_n[i, b]
                    displaced = fluid_density * area[i]
                    water_force_x = along_n * nx - along_t * ny + displaced * surge_x[b] - round_it[i, b] * drift_x
                    water_force_y = along_n * ny + along_t * nx + displaced * surge_y[b] - round_it[i, b] * drift_y
                    fluid_x[b] += Lw[i] * water_force_x
                    fluid_y[b] += Lw[i] * water_force_y
                    net_x = Lw[i] * (water_force_x + heavy[i, b] * gravity_x[b] - carried[i, b] * acceleration_x[b])
                    net_y = Lw[i] * (water_force_y + heavy[i, b] * gravity_y[b] - carried[i, b] * acceleration_y[b])
                    spin = Lw[i] * (couple[i, b] + added[i, b] * u_n[i, b] * u_t[i, b] - rotary[i, b] * twist[i, b])
                    across = added[i, b] + 0.5 * h * slope_n[b]
                    slip = 0.5 * h * slope_t[b]
                    every_way = carried[i, b] + round_it[i, b]
                    xx = Lw[i] * (every_way + across * nx * nx + slip * ny * ny)
                    xy = Lw[i] * (across - slip) * nx * ny
                    yy = Lw[i] * (every_way + across * ny * ny + slip * nx * nx)
                    for j in unrolled(n):
                        residual[j, b] += (jac_x[j, i, b] * net_x + jac_y[j, i, b] * net_y
                                           + A[i, j] * spin - C[i, j] * (bending[i] * moment[i, b]))
                        push_x = xx * jac_x[j, i, b] + xy * jac_y[j, i, b]
                        push_y = xy * jac_x[j, i, b] + yy * jac_y[j, i, b]
                        for l in unrolled(j + 1):
                            matrix[j, l, b] += (push_x * jac_x[l, i, b] + push_y * jac_y[l, i, b]
                                                + (A[i, j] * A[i, l]) * (Lw[i] * rotary[i, b])
                                                + (C[i, j] * C[i, l]) * (bending[i] * bend[i, b]))
                    residual[n, b] += jac_x[n, i, b] * net_x + jac_y[n, i, b] * net_y + spin
                    residual[n + 1, b] += net_y
                    for _ in unrolled(FREE):
                        residual[n + 2, b] += net_x
                    tensor_xx[b] = xx
                    tensor_xy[b] = xy
                    tensor_yy[b] = yy
                if free_theta:
                    for b in range(BLOCK):
                        push_x = tensor_xx[b] * jac_x[n, i, b] + tensor_xy[b] * jac_y[n, i, b]
                        push_y = tensor_xy[b] * jac_x[n, i, b] + tensor_yy[b] * jac_y[n, i, b]
                        for l in unrolled(n + 1):
                            matrix[n, l, b] += (push_x * jac_x[l, i, b] + push_y * jac_y[l, i, b]
                                                + A[i, l] * (Lw[i] * rotary[i, b]))
                if free_rail:
                    for b in range(BLOCK):
                        for l in unrolled(n + 1):
                            matrix[n + 1, l, b] += tensor_xy[b] * jac_x[l, i, b] + tensor_yy[b] * jac_y[l, i, b]
                        matrix[n + 1, n + 1, b] += tensor_yy[b]
                for _ in unrolled(FREE):
                    for b in range(BLOCK):
                        for l in unrolled(n + 1):
                            matrix[n + 2, l, b] += tensor_xx[b] * jac_x[l, i, b] + tensor_xy[b] * jac_y[l, i, b]
                        matrix[n + 2, n + 1, b] += tensor_xy[b]
                        matrix[n + 2, n + 2, b] += tensor_xx[b]
"""

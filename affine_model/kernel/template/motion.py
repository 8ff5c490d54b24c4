"""A step's predictor, the motion of all sections at mid-step, and the assembly of residual and matrix over them."""

MOTION = """\
    for step in range(steps):
        t = t0 + (step + 0.5) * h
        # Predictor: the mean acceleration of the step, extrapolated from the two before.
        for j in range(columns):
            for b in range(BLOCK):
                acc[j, b] = 2.0 * last[j, b] - before[j, b]
        if not free_theta:
            for b in range(BLOCK):
                mid[n, b] = base[0, step, base_lane[b]]
                mid_rate[n, b] = base[1, step, base_lane[b]]
                acc[n, b] = base[2, step, base_lane[b]]
        if not free_rail:
            for b in range(BLOCK):
                acc[n + 1, b] = 0.0
        rounds = iterations if step > 1 else iterations + 3
        for iteration in range(rounds):
            for d in range(D):
                j = dynamic[d]
                for b in range(BLOCK):
                    mid[j, b] = u[j, b] + 0.5 * h * v[j, b] + 0.25 * h * h * acc[j, b]
                    mid_rate[j, b] = v[j, b] + 0.5 * h * acc[j, b]
            for i in range(NODES):
                for b in range(BLOCK):
                    phi[i, b] = mid[n, b]
                    phi_rate[i, b] = mid_rate[n, b]
                    twist[i, b] = acc[n, b]
                    c[i, b] = 0.0
                    c_rate[i, b] = 0.0
                for j in range(n):
                    Aij = A[i, j]; Cij = C[i, j]
                    for b in range(BLOCK):
                        phi[i, b] += Aij * mid[j, b]
                        phi_rate[i, b] += Aij * mid_rate[j, b]
                        twist[i, b] += Aij * acc[j, b]
                        c[i, b] += Cij * mid[j, b]
                        c_rate[i, b] += Cij * mid_rate[j, b]
                for b in range(BLOCK):
                    sine, cosine = sincos(phi[i, b])
                    normal_x[i, b] = cosine
                    normal_y[i, b] = sine
                    square = phi_rate[i, b] * phi_rate[i, b]
                    swing_x[i, b] = sine * square - cosine * twist[i, b]
                    swing_y[i, b] = -cosine * square - sine * twist[i, b]
            for i in range(NODES):
                for j in range(n + 1):
                    for b in range(BLOCK):
                        jac_x[j, i, b] = @SUM_JACOBIAN_X@
                        jac_y[j, i, b] = @SUM_JACOBIAN_Y@
@TIP_CHANGING@
            for b in range(BLOCK):
                sine, cosine = sincos(tilt[b])
                gravity_x[b] = gravity * sine
                gravity_y[b] = gravity * cosine
                fluid_x[b] = 0.0
                fluid_y[b] = 0.0
            for i in range(NODES):
                for b in range(BLOCK):
                    velocity_x[b] = 0.0
                    velocity_y[b] = mid_rate[n + 1, b]
                    acceleration_x[b] = @SUM_SWING_X@
                    acceleration_y[b] = acc[n + 1, b] + @SUM_SWING_Y@
                    # The base angle's lever arm is the position itself: dr/d theta = (-y, x).
                    x[i, b] = jac_y[n, i, b]
                    y[i, b] = -jac_x[n, i, b]
                    water_x[b] = 0.0
                    water_y[b] = 0.0
                    surge_x[b] = 0.0
                    surge_y[b] = 0.0
                    force_n[b] = 0.0
                    force_t[b] = 0.0
                    slope_n[b] = 0.0
                    slope_t[b] = 0.0
                for j in range(n + 1):
                    for b in range(BLOCK):
                        velocity_x[b] += jac_x[j, i, b] * mid_rate[j, b]
                        velocity_y[b] += jac_y[j, i, b] * mid_rate[j, b]
@WATER@
                for b in range(BLOCK):
                    relative_x = velocity_x[b] - water_x[b]
                    relative_y = velocity_y[b] - water_y[b]
                    u_n[i, b] = relative_x * normal_x[i, b] + relative_y * normal_y[i, b]
                    u_t[i, b] = relative_y * normal_x[i, b] - relative_x * normal_y[i, b]
                    speed[i, b] = math.sqrt(u_n[i, b] * u_n[i, b] + u_t[i, b] * u_t[i, b] + 1e-16)
@SECTION_CHANGING@
@FORCES@
                for b in range(BLOCK):
                    bend[i, b] = 0.25 * h * h * stiffness[i, b]
                    moment[i, b] = stiffness[i, b] * c[i, b]
@MOMENTS@
                wL = Lw[i]
                for b in range(BLOCK):
                    nx = normal_x[i, b]
                    ny = normal_y[i, b]
                    # Added mass: f = -d/dt(m_a u_n n), with the couple m_a u_n u_t (Lighthill 1960).
                    drift_x = acceleration_x[b] - surge_x[b]
                    drift_y = acceleration_y[b] - surge_y[b]
                    along_n = force_n[b] - added[i, b] * (drift_x * nx + drift_y * ny + phi_rate[i, b] * u_t[i, b])
                    along_t = force_t[b] - added[i, b] * phi_rate[i, b] * u_n[i, b]
                    displaced = fluid_density * area[i]
                    water_force_x = along_n * nx - along_t * ny + displaced * surge_x[b]
                    water_force_y = along_n * ny + along_t * nx + displaced * surge_y[b]
                    fluid_x[b] += wL * water_force_x
                    fluid_y[b] += wL * water_force_y
                    net_x[i, b] = wL * (water_force_x + heavy[i, b] * gravity_x[b] - carried[i, b] * acceleration_x[b])
                    net_y[i, b] = wL * (water_force_y + heavy[i, b] * gravity_y[b] - carried[i, b] * acceleration_y[b])
                    spin[i, b] = wL * (couple[i, b] + added[i, b] * u_n[i, b] * u_t[i, b] - rotary[i, b] * twist[i, b])
                    moment[i, b] *= w[i]
                    bend[i, b] *= w[i]
                    across = added[i, b] + 0.5 * h * slope_n[b]
                    slip = 0.5 * h * slope_t[b]
                    force_n[b] = wL * (carried[i, b] + across * nx * nx + slip * ny * ny)  # the tensor's xx
                    force_t[b] = wL * (across - slip) * nx * ny  # xy
                    slope_n[b] = wL * (carried[i, b] + across * ny * ny + slip * nx * nx)  # yy
                for d in range(D):
                    j = dynamic[d]
                    for b in range(BLOCK):
                        push_x[j, i, b] = force_n[b] * jac_x[j, i, b] + force_t[b] * jac_y[j, i, b]
                        push_y[j, i, b] = force_t[b] * jac_x[j, i, b] + slope_n[b] * jac_y[j, i, b]
            for j in range(n + 1):
                for b in range(BLOCK):
                    residual[j, b] = (@SUM_FORCE@)
                    residual[j, b] += @SUM_TURN@
            for b in range(BLOCK):
                residual[n + 1, b] = @SUM_RAIL@
            for d in range(D):
                j = dynamic[d]
                for e in range(d + 1):
                    l = dynamic[e]
                    for b in range(BLOCK):
                        matrix[d, e, b] = (@SUM_MASS@)
                        matrix[d, e, b] += @SUM_BEND@
"""

"""The explicit time loop in one Taichi kernel: many steps per launch, with the energy balance."""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"
# (Taichi compiles these functions and interprets their annotations)

from functools import cache

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti
from tisim.kernels.elements import _f1, _f2, _f4, _i2, force_functions
from tisim.kernels.isochoric import NONE, Features
from tisim.laws._law import Law

# entries of `state`, initially 0 and kept between launches
SPENT, START, DRIFT, SCALE, KINETIC, MIN_JACOBIAN, STEPS, LOST = range(8)
STATE_SIZE = 8


@cache
def leapfrog_kernel(law: Law, features: Features = NONE) -> Kernel:
    """Kernel of a material that takes `steps` leapfrog steps; compiled once for any mesh and parameters.

    `features` must have no state (neither viscosity nor softening).
    """
    ensure_runtime()
    _, add_forces = force_functions(law, features)

    @ti.kernel
    def leapfrog(
        x: _f2,
        v: _f2,
        f: _f2,
        before: _f2,
        rest: _f2,
        load: _f2,
        mass: _f2,
        conn: _i2,
        grad: _f4,
        weight: _f2,
        prm: _f1,
        kp: _f1,
        kb: f64,
        mass_damping: f64,
        stiffness_damping: f64,
        dt: f64,
        dt_before: f64,
        limit: f64,
        steps: i32,
        state: _f1,
    ):
        """Advance x at a step [m], v at the half step before it [m/s] and f at the step before [N], (n, 3).

        mass (n, 3) [kg] is 0 for prescribed components; dt and dt_before [s] are this and the last step.

        The energy at a step is H = 1/2 v(-) M v(+) + E(x) - load (x - rest). The work of damping is summed by
        the trapezoidal rule over half steps. For linear forces H plus this work is constant to rounding.
        Above the stable step it stays constant while 1/2 v(-) M v(+) goes to minus infinity: both are
        monitored.

        Entries of state: work of damping [J]; H at the start [J]; largest |drift| of the balance [J]; largest
        energy so far [J]; kinetic energy [J]; smallest det F; number of steps taken; 1 if the balance is
        lost. It is lost if the drift exceeds `limit` times the largest energy, the kinetic energy is below
        minus that, or an element inverts.
        """
        ti.loop_config(serialize=True)
        for _ in range(1):
            gap = 0.5 * (dt_before + dt)
            last = dt_before
            for _step in range(steps):
                for n in range(x.shape[0]):
                    for i in ti.static(range(3)):
                        before[n, i] = f[n, i]
                        f[n, i] = 0.0
                elastic, minj = add_forces(x, conn, grad, weight, prm, prm, kp, kb, f)
                kinetic = 0.0
                true_kinetic = 0.0
                work = 0.0
                half = 0.0
                spent = 0.0
                for n in range(x.shape[0]):
                    for i in ti.static(range(3)):
                        m = mass[n, i]
                        work += load[n, i] * (x[n, i] - rest[n, i])
                        if m > 0.0:
                            rate = stiffness_damping * (f[n, i] - before[n, i]) / last
                            push = gap * (load[n, i] - f[n, i] - rate) / m
                            drag = 0.5 * gap * mass_damping
                            old = v[n, i]
                            new = ((1.0 - drag) * old + push) / (1.0 + drag)
                            mid = 0.5 * (old + new)
                            damping = mass_damping * m * mid + rate
                            half += 0.5 * last * old * damping
                            spent += 0.5 * (last * old + dt * new) * damping
                            kinetic += 0.5 * m * old * new
                            true_kinetic += 0.5 * m * mid * mid
                            v[n, i] = new
                            x[n, i] = x[n, i] + dt * new
                balance = kinetic + elastic - work + state[SPENT] + half
                first = state[STEPS] == 0.0
                if first:
                    state[START] = balance
                state[SPENT] = state[SPENT] + spent
                state[DRIFT] = ti.max(state[DRIFT], ti.abs(balance - state[START]))
                state[SCALE] = ti.max(state[SCALE], ti.abs(kinetic) + elastic)
                state[KINETIC] = true_kinetic
                state[MIN_JACOBIAN] = minj
                state[STEPS] = state[STEPS] + 1.0
                gap = dt
                last = dt
                # after a release from rest v(-) = -v(+), and there is no energy to compare with
                if not (
                    minj > 0.0
                    and state[DRIFT] <= limit * state[SCALE]
                    and (first or kinetic >= -limit * state[SCALE])
                    and balance - balance == 0.0
                ):
                    state[LOST] = 1.0
                    break

    return leapfrog

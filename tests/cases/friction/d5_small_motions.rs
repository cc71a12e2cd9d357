//! D5: equilibria whose small motions were reported as those of one moment. The bound for a moving state took account neither of
//! the number type's rounding nor of the stiffness of the mechanism.

use mbs_runtime::dynamics::{
    Explicit, Projection, RungeKutta4, Simulation, equilibrium_with_states, linearize_with_states,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A pendulum of 50 mm that a spring holds aside, and a sensor that follows it.
    mechanism Pendulum;
    param k: N*m/rad = 0.4;
    param tau: s = 1ms;
    coord phi: rad = 0.3;
    body bob { mass: 1, inertia: 1e-3, com: 50mm*unit(phi), angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    torque spring: k*(1 - phi) on phi;
    state seen: rad = 0;
    der(seen) == (phi - seen)/tau;
}

/// `true` if the small motions about an equilibrium, displaced by `aside`, are those of one moment (frozen-time).
macro_rules! moves {
    ($real:ty, $k:expr, $tau:expr, $aside:expr) => {{
        let pendulum = Pendulum::<$real> { k: $k, tau: $tau };
        let (rest, states) = equilibrium_with_states(&pendulum, 0.0, &[0.9]).expect("a rest");
        let method = Explicit::new(RungeKutta4, Projection::default());
        let q = rest.q.map(|q| q + $aside);
        let run = Simulation::start(pendulum, method, 0.0, q, [0.0]).expect("it starts");
        let mut instant = *run.instant();
        instant.y.states = states;
        linearize_with_states(run.mechanism(), &instant, &[]).expect("small motions").0.frozen
    }};
}

#[test]
fn a_rest_is_one_in_single_precision_and_under_stiff_springs() {
    for k in [0.4, 40.0, 4e3, 4e6] {
        for tau in [1.0, 1e-3, 1e-6] {
            assert!(!moves!(f64, k, tau, 0.0), "{k}, {tau}");
            assert!(!moves!(f32, k as f32, tau as f32, 0.0), "{k}, {tau} in single precision");
        }
    }
}

#[test]
fn a_pendulum_beside_its_rest_moves() {
    for k in [0.4, 40.0, 4e3, 4e6] {
        for aside in [1e-8, -1e-6, 1e-3] {
            assert!(moves!(f64, k, 1.0, aside), "{k}, {aside}");
        }
        assert!(moves!(f32, k as f32, 1.0, 1e-3), "{k} in single precision");
    }
}

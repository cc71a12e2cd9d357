//! Implicit methods of fixed steps need slopes of the forces: they refuse friction that sticks.

use mbs_runtime::dynamics::{AugmentedLagrangian, Extrapolated, GeneralizedAlpha, Method, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A block with friction that sticks.
    pub mechanism Block;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction rub { along: x, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
}

fn refused<X>(found: Result<X, Failure>) {
    let failure = found.err().expect("it is refused");
    assert!(matches!(failure.kind, FailureKind::SetValuedForce { row } if row.name == "rub"), "{failure}");
    assert!(failure.to_string().contains("`Explicit` with `Radau5`"), "{failure}");
}

fn starts<X: Method<Block<f64>, f64, 1, 0>>(method: X) {
    refused(Simulation::start_from_text(Block::default(), method, 0.0_f64));
}

#[test]
fn what_needs_slopes_is_refused_with_a_cure() {
    starts(AugmentedLagrangian);
    starts(GeneralizedAlpha::default());
    starts(Extrapolated);
}

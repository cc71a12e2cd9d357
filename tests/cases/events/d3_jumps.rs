//! D3: event functions that jump, to zero and beyond it, are told at the time of the jump.

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Thrown;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
}

/// Values before a jump, behind it, and from `STAY` (s) later on, which is longer than an eighth of any step.
const JUMPS: [[f64; 3]; 8] = [
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [1e-9, 0.0, 0.0],
    [-1.0, 1.0, 1.0],
    [1.0, -1e-9, -1.0],
];

const STAY: f64 = 0.2;

#[test]
fn a_jump_to_zero_is_told_at_its_time() {
    for (k, [before, behind, later]) in JUMPS.into_iter().cycle().take(400).enumerate() {
        let jump = 0.1 + 0.8 * (0.618 * k as f64).fract();
        let method = Explicit::new(DormandPrince8, Projection::default());
        let mut run =
            Simulation::start(Thrown::<f64>::default(), method, 0.0, [0.0], [5.0]).expect("a start");
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| {
            if t < jump {
                before
            } else if t < jump + STAY {
                behind
            } else {
                later
            }
        };
        let told = run.advance_until_event(1.0, Direction::Any, event).expect("it runs");
        // A jump to zero is bisected to the rounding of times. Of one beyond it every fourth try is a bisection, twenty at most, of a
        // part that is a four-thousandth of a step.
        let allowed = if behind == 0.0 { 1e-14 } else { 1e-9 };
        assert!(told && (run.t() - jump).abs() < allowed, "{k}: {} {jump} {:e}", run.t(), run.t() - jump);
    }
}

/// A root that is met exactly is one evaluation more, and the same time.
#[test]
fn a_root_that_is_met_exactly_stays_where_it_is() {
    for (place, scale) in [(0.5, 1.0), (0.25, 1e-6), (0.75, 1e6), (0.375, -2.0)] {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let mut run =
            Simulation::start(Thrown::<f64>::default(), method, 0.0, [0.0], [5.0]).expect("a start");
        let told = run.advance_until_event(1.0, Direction::Any, |t, _, _| scale * (t - place));
        assert!(told.expect("it runs"));
        assert_eq!(run.t(), place);
    }
}

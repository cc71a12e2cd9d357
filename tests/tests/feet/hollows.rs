//! Round pads over a hollow: the nearest place of a curve changes from one flank to the other, in rows and in contacts.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Failure, FailureKind, Stepper, mechanism};

use crate::{WAIST, Waves, nearest};

mechanism! {
    /// A round pad is led over a curve that stands still, and touches it.
    pub mechanism Led;
    param rho: m = 6mm;
    param bound: m = 1mm;
    function pitch: m(rad), C3, periodic TAU;
    coord h: m = 29mm;
    curve rim = polar pitch about [0m, 0m];
    let A = [-18mm + 20 [mm/s]*t, h];
    foot w of circle(A, rho) on rim within bound near 130deg;
    constraint rolls { w_gap == 0m; }
}

mechanism! {
    /// A round pad flies past the same curve, which it may touch.
    pub mechanism Thrown;
    param bound: m = 1mm;
    param rise: m/s = 0;
    function pitch: m(rad), C3, periodic TAU;
    coord p: [m; 2] = [-18mm, 28mm];
    curve rim = polar pitch about [0m, 0m];
    foot w of circle(p, 6mm) on rim within bound near 130deg;
    body pad { mass: 0.1kg, com: p }
    contact face { gap: w_gap, stiffness: 1e6, exponent: 1.5, depth: 1mm }
    start p = [-18mm, 28mm] rate [50 [mm/s], rise];
    out gap: m = w_gap;
}

fn is_reach(failure: &Failure) -> bool {
    matches!(failure.kind, FailureKind::BeyondLimit { limit, .. } if limit.name == "w_reach")
}

/// Largest error (m) of a pad's gap until it is behind the hollow or refused, and the place (m) at which it is refused.
type Passage = (f64, Option<(f64, Failure)>);

fn led(rho: f64, bound: f64) -> Passage {
    let led = Led { rho, bound, ..Led::new(WAIST) };
    let mut stepper = match Stepper::assemble(led, [0.022 + rho, 2.2], 0.0) {
        Ok(stepper) => stepper,
        Err(failure) => return (0.0, Some((-0.018, failure))),
    };
    let mut wrong = 0.0_f64;
    for k in 1..=180 {
        let t = 0.01 * f64::from(k);
        let x = -0.018 + 0.020 * t;
        if let Err(failure) = stepper.advance_to(t) {
            return (wrong, Some((x, failure)));
        }
        wrong = wrong.max((nearest(&WAIST, [x, stepper.q()[0]])[0] - rho).abs());
    }
    (wrong, None)
}

type Run = Simulation<Thrown<Waves>, Explicit<DormandPrince8, Projection>, f64, 3, 1>;

fn thrown(rise: f64, bound: f64, advance: impl Fn(&mut Run, f64) -> Result<(), Failure>) -> Passage {
    let thrown = Thrown { rise, bound, ..Thrown::new(WAIST) };
    let mut run = Run::start_from_text(thrown, Explicit::default(), 0.0).expect("a foot");
    let mut wrong = 0.0_f64;
    for k in 1..=72 {
        if let Err(failure) = advance(&mut run, 0.01 * f64::from(k)) {
            return (wrong, Some((run.q()[0], failure)));
        }
        let [x, y, _] = *run.q();
        let [gap] = run.outputs().map(|output| output.value);
        wrong = wrong.max((nearest(&WAIST, [x, y])[0] - 0.006 - gap).abs());
    }
    (wrong, None)
}

#[test]
fn round_pads_pass_a_hollow_or_are_refused_before_the_other_flank_is_nearer() {
    let [_, outside] = WAIST.reach();
    // In the hollow, where the nearest place moves on; led by a row, and past a contact in steps of both kinds.
    let (wrong, refused) = led(0.006, outside);
    assert!(wrong < 1e-15 && refused.is_none(), "{wrong:e} {refused:?}");
    let in_steps = |run: &mut Run, t: f64| run.step_to(t, 4);
    let adaptive = |run: &mut Run, t: f64| run.advance_to(t);
    for (wrong, refused) in [thrown(0.0, outside, in_steps), thrown(0.0, outside, adaptive)] {
        assert!(wrong < 1e-14 && refused.is_none(), "{wrong:e} {refused:?}");
    }
    // Above it, where it jumps from one flank to the other: a pad that is too large for the hollow, and one that is thrown higher.
    let (wrong, refused) = led(0.015, outside);
    assert!(wrong == 0.0 && refused.is_some_and(|(_, failure)| is_reach(&failure)));
    for (wrong, refused) in [thrown(0.02, outside, in_steps), thrown(0.02, outside, adaptive)] {
        let (x, failure) = refused.expect("the flanks are as near in the middle");
        println!("refused {x} m beside the middle, gaps to {wrong:.1e} m until then");
        assert!(wrong < 1e-14 && (-0.018..0.0).contains(&x) && is_reach(&failure), "{wrong:e} {x} {failure}");
    }
    // A bound that nothing backs keeps the foot that a motion began with, until there is none on that flank any more.
    for (wrong, refused) in [led(0.015, 1.0), thrown(0.02, 1.0, in_steps), thrown(0.02, 1.0, adaptive)] {
        let (x, failure) = refused.expect("no foot is left");
        assert!(wrong > 1e-4 && (0.0..0.002).contains(&x) && !is_reach(&failure), "{wrong:e} {x} {failure}");
    }
}

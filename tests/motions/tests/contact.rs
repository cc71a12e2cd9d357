//! Contacts against closed forms: duration, depth and returned energy.
#![forbid(unsafe_code)]

use core::f64::consts::PI;

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::mechanism;

type Method = Explicit<DormandPrince8, Projection>;

mechanism! {
    /// A ball above a floor that gives way in proportion to the force.
    pub mechanism Ball;
    param m: kg = 0.5;
    param k: N/m = 2e4;
    param h: m = 0.3;
    coord y: m = 0.3;
    body ball { mass: m, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, stiffness: k }
    start y = h rate 0;
}

mechanism! {
    /// A ball that flies at a wall: Hertz's contact, damped or not.
    pub mechanism Shot;
    param m: kg = 1;
    param k: N/m = 1e6;
    param depth: m = 1e-4;
    param d: s/m = 0;
    param v: m/s = 0.3;
    coord x: m = 1mm;
    body ball { mass: m, com: [x, 0] }
    contact wall { gap: x, stiffness: k, exponent: 1.5, depth: depth, damping: d }
    start x = 1mm rate -v;
}

#[test]
fn a_ball_bounces_to_its_height_and_touches_when_it_should() {
    /// Time (s), place (m), of five bounces together.
    const EXACT: f64 = 1e-9;
    let ball: Ball = Ball::default();
    let run = Simulation::start_from_text(ball, Method::default(), 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let (g, frequency) = (9.81_f64, (ball.k / ball.m).sqrt());
    let (fall, speed) = ((2.0 * ball.h / g).sqrt(), (2.0 * g * ball.h).sqrt());
    // y = −(g/ω²)(1 − cos ωt) − (v/ω) sin ωt until it is zero again; below, g/ω² and v/ω as one amplitude.
    let contact = 2.0 * (PI - (frequency * speed / g).atan()) / frequency;
    let depth = g / (frequency * frequency) + (g / (frequency * frequency)).hypot(speed / frequency);
    let (mut start, mut worst) = (0.0, 0.0_f64);
    for _ in 0..5 {
        assert!(run.advance_until_event(5.0, Direction::Falling, |_, q, _| q[0]).expect("it falls"));
        worst = worst.max((run.t() - (start + fall)).abs()).max((run.qd()[0] + speed).abs());
        assert!(run.advance_until_event(5.0, Direction::Rising, |_, _, qd| qd[0]).expect("it is deep"));
        worst = worst.max((run.q()[0] + depth).abs());
        assert!(run.advance_until_event(5.0, Direction::Rising, |_, q, _| q[0]).expect("it rises"));
        worst = worst.max((run.t() - (start + fall + contact)).abs());
        assert!(run.advance_until_event(5.0, Direction::Falling, |_, _, qd| qd[0]).expect("it is high"));
        start += 2.0 * fall + contact;
        worst = worst.max((run.t() - start).abs()).max((run.q()[0] - ball.h).abs());
    }
    println!("contact, bounces: {worst:.1e} s, m, m/s of {EXACT:e}, energy {:.1e} J", run.balance().defect);
    assert!(worst < EXACT && run.balance().defect.abs() < EXACT, "{worst:e}");
}

/// The ball at the deepest point and when it leaves, and the duration of the contact.
fn shot(shot: Shot) -> ([f64; 2], Simulation<Shot, Method, f64, 1, 0>, f64) {
    let run = Simulation::start_from_text(shot, Method::default(), 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-13));
    assert!(run.advance_until_event(1.0, Direction::Falling, |_, q, _| q[0]).expect("it flies"));
    let touched = run.t();
    assert!((touched - 1e-3 / shot.v).abs() < 1e-13, "{touched}");
    assert!(run.advance_until_event(1.0, Direction::Rising, |_, _, qd| qd[0]).expect("it is deep"));
    let deepest = [-run.q()[0], run.qdd()[0] * shot.m];
    assert!(run.advance_until_event(1.0, Direction::Rising, |_, q, _| q[0]).expect("it leaves"));
    let lasted = run.t() - touched;
    (deepest, run, lasted)
}

#[test]
fn hertzs_impact_is_as_deep_as_energy_allows_and_as_long_as_published() {
    let hertz: Shot = Shot::default();
    let ([depth, force], run, lasted) = shot(hertz);
    // ½ m v² = ⅖ K p^(5/2) with K = k/√depth = 1e8 N/m^(3/2).
    let deepest = (1.25 * hertz.m * hertz.v * hertz.v / (hertz.k / hertz.depth.sqrt())).powf(0.4);
    println!(
        "contact, Hertz: depth {:.1e}, force {:.1e}, duration {:.1e} beside energy and table, of 1e-9",
        depth / deepest - 1.0,
        force / 427.2592890212634 - 1.0,
        lasted / 0.0025832748929815194 - 1.0
    );
    assert!((depth - deepest).abs() < 1e-10 * deepest && (deepest - 0.00026330615364198953).abs() < 1e-15);
    assert!((force - 427.2592890212634).abs() < 1e-10 * force, "{force}");
    assert!((lasted - 0.0025832748929815194).abs() < 1e-9 * lasted, "{lasted}");
    assert!((run.qd()[0] - hertz.v).abs() < 1e-10, "{:?}", run.qd());
}

#[test]
fn damping_takes_what_its_power_says_whatever_the_exponent() {
    let damped: Shot = Shot { d: 1.5, ..Shot::default() };
    let (_, run, _) = shot(damped);
    // v dv/(1 + d v) = −(force/m) dp, whose right side is the same on both ways. So v/d − ln(1 + d v)/d² is equal at −v' and v.
    let at = |v: f64| v / damped.d - (damped.d * v).ln_1p() / (damped.d * damped.d);
    let left = run.qd()[0];
    let (arrived, leaves) = (at(damped.v), at(-left));
    println!(
        "damped: leaves at {left} of {} m/s, {:.1e} beside the closed form",
        damped.v,
        leaves / arrived - 1.0
    );
    assert!(left < 0.8 * damped.v && (leaves / arrived - 1.0).abs() < 1e-9);
    let lost = 0.5 * damped.m * (damped.v * damped.v - left * left);
    let balance = run.balance();
    assert!((balance.work + lost).abs() < 1e-11 && balance.defect.abs() < 1e-11, "{lost} {balance:?}");
}

//! Events whose begin still holds where they end: `t > 0.5s until t > 1.5s` switched without end.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Projection, RungeKutta4, Simulation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A cart pushed by a pulse of the time, and by one of its place, which ends and begins again.
    pub mechanism Pulsed;
    param first: s = 0.5;
    coord x: m = 0;
    coord y: m = 0;
    body cart { mass: 2kg, com: [x, 0] }
    body other { mass: 1kg, com: [y, 1m] }
    event pulse: t > first until t > first + 1s;
    event between: y > 0.1m until y > 0.3m;
    force push: 4N*pulse on x;
    force brake: -1N*between on y;
    start x = 0 rate 0.1;
    start y = 0 rate 0.5;
    out on: [1; 2] = [pulse, between];
}

/// Place of the first cart: closed form.
fn place(first: f64, t: f64) -> f64 {
    let pushed = (t - first).clamp(0.0, 1.0);
    0.1 * t + pushed * pushed + 2.0 * pushed * (t - first - 1.0).max(0.0)
}

/// Of the second one: braked by 1 m/s² from 0.1 m on. It turns back before 0.3 m, so the event never ends.
fn other(t: f64) -> f64 {
    let first = 0.2;
    if t < first { 0.5 * t } else { 0.1 + 0.5 * (t - first) - 0.5 * (t - first) * (t - first) }
}

fn follows<I: Embedded + Copy>(integrator: I) {
    for first in [0.5, 0.0, 0.123] {
        let method = Explicit::new(integrator, Projection::default());
        let mechanism = Pulsed { first };
        let mut run = Simulation::start_from_text(mechanism, method, 0.0_f64).expect("it starts");
        for instant in 1..=20 {
            let t = 0.1 * f64::from(instant);
            run.advance_to(t).expect("it moves");
            let [x, y] = *run.q();
            assert!((x - place(first, t)).abs() < 1e-9, "{first} {t}: {x} {}", place(first, t));
            assert!((y - other(t)).abs() < 1e-9, "{first} {t}: {y} {}", other(t));
        }
    }
}

#[test]
fn a_pulse_of_the_time_ends_and_stays_ended() {
    follows(DormandPrince8);
    follows(DormandPrince5);
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Pulsed::default(), method, 0.0_f64).expect("it starts");
    for step in 1..=100 {
        run.step(0.02).expect("it moves");
        let t = 0.02 * f64::from(step);
        assert!((run.q()[0] - place(0.5, t)).abs() < 1e-9, "{t}: {:?}", run.q());
    }
}

mechanism! {
    /// A pulse of two levels that a swing passes to and fro: on between them alone, for its begin holds above both.
    pub mechanism Swing;
    coord x: m = 0;
    body cart { mass: 1kg, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 4, length: 1 }
    event between: x > 0.1m until x > 0.3m;
    latch since: s = t at between;
    start x = 0 rate 1;
    out on: 1 = between;
    out when: s = since;
}

#[test]
fn an_event_that_is_over_begins_anew_where_its_end_holds_no_longer() {
    // x = sin(2t)/2: up through 0.1 and 0.3, down through 0.3, where the begin holds and the end no longer does.
    let at = |x: f64| (2.0 * x).asin() / 2.0;
    let half = std::f64::consts::FRAC_PI_2;
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Swing::default(), method, 0.0_f64).expect("it starts");
    for (t, on, since) in [
        (0.5 * at(0.1), 0.0, 0.0),
        (0.5 * (at(0.1) + at(0.3)), 1.0, at(0.1)),
        (0.5 * half, 0.0, at(0.1)),
        (half - at(0.2), 1.0, half - at(0.3)),
    ] {
        run.advance_to(t).expect("it swings");
        let found = run.loads();
        assert!(
            (found[0] - on).abs() < 1e-12 && (found[1] - since).abs() < 1e-9,
            "{t}: {found:?} {on} {since}"
        );
    }
}

//! D3: contacts that close and open within a step, against closed forms.

use super::texts::{Ball, Roofed};
use mbs_cases::every;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Formulation, Projection, Simulation, Tolerance,
    VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Bounded;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact roof { gap: 1.9m - y, stiffness: 1e6, bound: 9.81 }
}

const G: f64 = 9.81;

/// Duration (s) of a contact of 1e6 N/m with 1 kg under gravity that is met at `speed` (m/s).
///
/// x = A cos(ω t − δ) − g/ω² with x(0) = 0, ẋ(0) = speed is 0 again at ω t = 2 δ.
fn duration(speed: f64) -> f64 {
    let omega = 1e3;
    2.0 * (speed / omega).atan2(G / (omega * omega)) / omega
}

/// Speed (m/s) at the start of a ball that meets the roof at `speed` (m/s), and the time (s) of that.
fn throw(speed: f64) -> (f64, f64) {
    let start = (speed * speed + 2.0 * G * 1.9).sqrt();
    (start, (start - speed) / G)
}

fn start<I, F>(
    integrator: I,
    formulation: F,
    speed: f64,
) -> Simulation<Roofed<f64>, Explicit<I, F>, f64, 1, 0>
where
    I: Embedded,
    F: Formulation<Roofed<f64>, f64, 1, 0>,
{
    let method = Explicit::new(integrator, formulation);
    Simulation::start(Roofed::default(), method, 0.0, [0.0], [speed]).expect("a start")
}

#[test]
fn no_throw_at_a_roof_passes_through_it() {
    // No common factor with the patterns below.
    for index in (0..1000_u32).step_by(every(13)) {
        let speed = 10.0_f64.powf(-6.0 + 6.8 * f64::from(index) / 999.0);
        let (up, met) = throw(speed);
        let left = met + duration(speed);
        let last = left + 0.3;
        let height = 1.9 - speed * 0.3 - 0.5 * G * 0.09;
        // Half of the runs are cut into pieces, one piece ends within the contact.
        let cuts = match index % 4 {
            0 => vec![last],
            1 => vec![0.5 * met, last],
            2 => vec![0.5 * (met + left), last],
            _ => (1..=7).map(|piece| last * f64::from(piece) / 7.0).collect(),
        };
        let (y, defect) = if index % 3 == 0 {
            let mut run = start(DormandPrince5, VelocityTransformation, up);
            cuts.iter().for_each(|cut| run.advance_to(*cut).expect("it runs"));
            (run.q()[0], run.balance().defect)
        } else {
            let mut run = start(DormandPrince8, Projection::default(), up);
            cuts.iter().for_each(|cut| run.advance_to(*cut).expect("it runs"));
            (run.q()[0], run.balance().defect)
        };
        // Rounding of the start, ε v², over the speed of the passage; the tolerance of 1e-9 for every step in the contact.
        let allowed = 1e-7 + 1e-14 / speed;
        assert!((y - height).abs() < allowed, "{index}: {speed:e} {y} {height} {:e}", y - height);
        assert!(defect.abs() < 1e-6, "{index}: {defect:e}");
    }
}

#[test]
fn the_way_a_run_is_cut_does_not_change_its_result() {
    let (up, _) = throw(3.0);
    let mut whole = start(DormandPrince8, Projection::default(), up);
    whole.advance_to(1.2).expect("it runs");
    for pieces in [2, 3, 10, 97] {
        let mut run = start(DormandPrince8, Projection::default(), up);
        for piece in 1..=pieces {
            run.advance_to(1.2 * f64::from(piece) / f64::from(pieces)).expect("it runs");
        }
        assert!((run.q()[0] - whole.q()[0]).abs() < 1e-8, "{pieces}: {:e}", run.q()[0] - whole.q()[0]);
    }
}

/// With the bound of its acceleration an open contact is one gap a step: as many evaluations and the same steps as without it.
#[test]
fn an_open_contact_with_a_bound_costs_no_evaluation() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let tolerance = Tolerance::new(1e-9);
    let mut free = Simulation::start(Ball::<f64>::default(), method, 0.0, [0.0], [6.0]).expect("a start");
    let mut open = Simulation::start(Bounded::<f64>::default(), method, 0.0, [0.0], [6.0]).expect("a start");
    free = free.with_tolerance(tolerance).with_largest_step(0.05);
    open = open.with_tolerance(tolerance).with_largest_step(0.05);
    free.advance_to(1.0).expect("it runs");
    open.advance_to(1.0).expect("it runs");
    assert_eq!(open.counts().steps, free.counts().steps);
    let (more, least) = (open.counts().evaluations, free.counts().evaluations);
    // Steps within 50 ms of the roof, which the parabola reaches.
    assert!(more <= least + 3 * 8, "{more} {least}");
    assert!((open.q()[0] - free.q()[0]).abs() < 1e-12);
    // And it is met where it is.
    let (up, met) = throw(4.0);
    let mut run = Simulation::start(Bounded::<f64>::default(), method, 0.0, [0.0], [up]).expect("a start");
    let last = met + duration(4.0) + 0.2;
    run.advance_to(last).expect("it runs");
    assert!((run.q()[0] - (1.9 - 0.8 - 0.5 * G * 0.04)).abs() < 1e-7);
}

mechanism! {
    pub mechanism Box;
    coord x: m = 0;
    body ball { mass: 1, com: [x, 0] }
    contact left { gap: x, stiffness: 1e6 }
    contact right { gap: 2m - x, stiffness: 4e6 }
}

/// A hundred bounces between two walls: half a period of ω in each contact, at any speed.
#[test]
fn bounces_between_two_walls_keep_their_time() {
    for speed in [0.01, 1.0, 30.0] {
        let method = Explicit::new(DormandPrince8, VelocityTransformation);
        let mut run = Simulation::start(Box::default(), method, 0.0, [1.0], [speed]).expect("a start");
        let turn = 4.0 / speed + core::f64::consts::PI * (1e-3 + 0.5e-3);
        run.advance_to(50.0 * turn).expect("it runs");
        let (x, v) = (run.q()[0], run.qd()[0]);
        assert!((v - speed).abs() < 1e-6 * speed, "{speed}: {v}");
        // A speed within ten tolerances of 1e-9 m/s, over the whole time.
        let allowed = 1e-8 * 50.0 * turn + 1e-6;
        assert!((x - 1.0).abs() < allowed, "{speed}: {x} {allowed:e}");
    }
}

mechanism! {
    pub mechanism Paddle;
    coord y: m = 1;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact plate { gap: y - 0.05m*sin(20*t/1s), stiffness: 1e7, exponent: 1.5, depth: 1mm, damping: 0.2 }
}

/// A ball on a plate that shakes, against fixed steps of the test's own.
#[test]
fn a_contact_that_the_time_moves_is_met() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start(Paddle::default(), method, 0.0, [1.0], [0.0]).expect("a start");
    run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(0.9).expect("it runs");
    let acceleration = |t: f64, y: f64, v: f64| {
        let p = (0.05 * (20.0 * t).sin() - y).max(0.0);
        let rate = 0.05 * 20.0 * (20.0 * t).cos() - v;
        -G + 1e7 * 1e-3 * (p / 1e-3).powf(1.5) * (1.0 + 0.2 * rate).max(0.0)
    };
    let (mut t, mut y, mut v) = (0.0, 1.0, 0.0);
    let h = 1e-7;
    for step in 1..=9_000_000_u32 {
        // The midpoint rule, which is exact where the ball is free.
        let (a, m) = (acceleration(t, y, v), 0.5 * h);
        let b = acceleration(t + m, y + m * v, v + m * a);
        y += h * v + 0.5 * h * h * b;
        v += h * b;
        t = f64::from(step) * h;
    }
    assert!((run.q()[0] - y).abs() < 1e-5, "{} {y}", run.q()[0]);
}

mechanism! {
    pub mechanism Bell;
    coord phi: rad = 0;
    coord p: [m; 2] = [0.5, 0];
    body clapper { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint arm { p == 0.5m*unit(phi); }
    contact wall { gap: p[0] + 0.2m, stiffness: 1e7 }
}

/// A pendulum that starts from the horizontal hits a wall after its lowest point: energy is conserved, and it turns back.
#[test]
fn a_pendulum_does_not_swing_through_a_wall() {
    for (index, tolerance) in [1e-4, 1e-6, 1e-9].into_iter().enumerate() {
        let method = Explicit::new(DormandPrince8, VelocityTransformation);
        let run = Simulation::start(Bell::default(), method, 0.0, [0.0, 0.5, 0.0], [0.0; 3]);
        let mut run = run.expect("a start").with_tolerance(Tolerance::new(tolerance));
        let mut deepest = 0.0_f64;
        run.watch(3.0, 3000, |run| deepest = deepest.min(run.q()[1] + 0.2)).expect("it runs");
        assert!(deepest > -2.5e-3, "{index}: {deepest}");
        assert!(run.balance().defect.abs() < 1e2 * tolerance, "{index}: {:e}", run.balance().defect);
    }
}

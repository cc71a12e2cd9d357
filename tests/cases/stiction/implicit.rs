//! Friction that sticks, rigid contacts and events by implicit steps: texts with stiff parts against closed forms.

use mbs_runtime::dynamics::{Direction, Explicit, Projection, Radau5, Simulation, Tolerance, Unstabilized};
use mbs_runtime::{Dynamic, mechanism};

fn radau() -> Explicit<Radau5, Projection> {
    Explicit::new(Radau5, Projection::default())
}

mechanism! {
    /// A ball above a floor, and a damper of a microsecond beside it.
    pub mechanism Ball;
    coord y: m = 1;
    coord z: m = 0;
    body ball { mass: 2, com: [0, y] }
    body bob { mass: 1, com: [z, 0] }
    force weight: -2*9.81N on y;
    force damper: 1e6 [N*s/m]*(0.1 [m/s] - der(z)) on z;
    contact floor { gap: y, restitution: 0.9 }
    start y = 1 rate 0;
    start z = 0 rate 0.1;
    out push: N = force(floor);
}

/// Height of a ball dropped from 1 m at rest, with a coefficient of restitution of 0.9.
pub(crate) fn height(t: f64) -> f64 {
    let fall = (2.0_f64 / 9.81).sqrt();
    if t < fall {
        return 1.0 - 0.5 * 9.81 * t * t;
    }
    let (mut begin, mut speed) = (fall, 9.81 * fall);
    for _ in 0..2000 {
        speed *= 0.9;
        let flight = 2.0 * speed / 9.81;
        if t < begin + flight {
            let t = t - begin;
            return speed * t - 0.5 * 9.81 * t * t;
        }
        begin += flight;
    }
    0.0
}

#[test]
fn a_ball_beside_a_stiff_damper_bounces() {
    let run = Simulation::start_from_text(Ball::default(), radau(), 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    for index in 1..=50 {
        let t = 0.2 * f64::from(index);
        run.advance_to(t).expect("it bounces");
        assert!((run.q()[0] - height(t)).abs() < 1e-8, "{t}: {} {}", run.q()[0], height(t));
        assert!((run.q()[1] - 0.1 * t).abs() < 1e-9, "{t}: {}", run.q()[1]);
    }
    let parameters = run.parameters_with_forces();
    let since = Ball::set_valued_modes(&parameters)[0].since;
    assert!((since - 8.578_949).abs() < 1e-6, "{since}");
    assert!((run.loads()[0] - 2.0 * 9.81).abs() < 1e-10, "{:?}", run.loads());
    assert!(run.counts().steps < 3000, "{:?}", run.counts());
}

#[test]
fn fixed_implicit_steps_end_at_impacts() {
    let method = Explicit::new(Radau5, Unstabilized);
    let mut run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("it starts");
    run.step_to(6.0, 600).expect("it bounces");
    assert!((run.q()[0] - height(6.0)).abs() < 1e-8, "{} {}", run.q()[0], height(6.0));
    run.step_to(10.0, 100).expect("it comes to rest");
    assert!(run.q()[0].abs() < 1e-12 && (run.loads()[0] - 19.62).abs() < 1e-8);
    let run = Simulation::start_from_text(Ball::<f32>::default(), radau(), 0.0_f32).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(2.0).expect("it bounces");
    assert!((f64::from(run.q()[0]) - height(2.0)).abs() < 5e-4, "{} {}", run.q()[0], height(2.0));
}

mechanism! {
    /// A block on a belt that a spring holds back, with a damper of a microsecond between the parts of the block.
    pub mechanism Belt;
    param v: m/s = 0.1;
    coord x: m = 0.075;
    coord z: m = 0.075;
    body block { mass: 0.5, com: [x, 0] }
    body rider { mass: 0.5, com: [z, 1] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    force damper: 5e7 [N*s/m]*(der(x) - der(z)) on z;
    force back: 5e7 [N*s/m]*(der(z) - der(x)) on x;
    friction rub { along: x - v*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
    start x = 0.075 rate 0.1;
    start z = 0.075 rate 0.1;
}

#[test]
fn a_belt_keeps_its_period_beside_a_stiff_damper() {
    let run = Simulation::start_from_text(Belt::default(), radau(), 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    let mut times = [0.0; 6];
    for time in &mut times {
        assert!(run.advance_until_event(100.0, Direction::Falling, |_, q, _| q[0] - 0.5).expect("it moves"));
        *time = run.t();
    }
    let periods = [(times[5] - times[1]) / 4.0, times[5] - times[4]];
    for period in periods {
        assert!((period - 7.523_422).abs() < 2e-6, "{periods:?}");
    }
    assert!(run.counts().steps < 4000, "{:?}", run.counts());
}

mechanism! {
    /// A bead that a stiff spring presses on a hub, around which it slides with friction.
    pub mechanism Hub;
    coord r: m = 1;
    coord a: rad = 0;
    body bead { mass: 2, com: r*unit(a) }
    tsda spring { from: [0, 0], to: r*unit(a), stiffness: 1e6, length: 1 - 8e-6 }
    contact hub { gap: r - 1m, restitution: 0 }
    friction rub { along: 1m*a, normal: normal(hub), coefficient: 0.2, sticks: 0.3 }
    start r = 1 rate 0;
    start a = 0 rate 1.5;
    out push: N = force(hub);
}

/// Angle, speed and normal force of the bead, with N = F − m v² and m v̇ = −μ N.
pub(crate) fn around(t: f64) -> [f64; 3] {
    let (force, mu, a) = (8.0_f64, 0.2_f64, 2.0_f64); // a = √(F/m)
    let c = (1.5 / a).atanh();
    let left = (c - mu * a * t).max(0.0);
    let speed = a * left.tanh();
    [(c.cosh() / left.cosh()).ln() / mu, speed, force - 2.0 * speed * speed]
}

#[test]
fn a_stiff_spring_along_a_closed_contact_costs_no_steps() {
    let run = Simulation::start_from_text(Hub::default(), radau(), 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-9));
    for index in 1..=40 {
        let t = 0.1 * f64::from(index);
        run.advance_to(t).expect("it slides");
        let [angle, speed, push] = around(t);
        assert!((run.q()[1] - angle).abs() < 1e-7, "{t}: {} {angle}", run.q()[1]);
        assert!((run.qd()[1] - speed).abs() < 1e-7, "{t}: {} {speed}", run.qd()[1]);
        assert!((run.loads()[0] - push).abs() < 1e-7, "{t}: {:?} {push}", run.loads());
    }
    assert!(run.qd()[1] == 0.0 || run.qd()[1].abs() < 1e-12, "{:?}", run.qd());
    assert!(run.counts().steps < 200, "{:?}", run.counts());
}

mechanism! {
    /// A load with a motor that begins below a level, and a stiff damper beside it.
    pub mechanism Lift;
    coord y: m = 1;
    coord z: m = 0;
    body load { mass: 2, com: [0, y] }
    body bob { mass: 1, com: [z, 0] }
    force weight: -2*9.81N on y;
    force damper: 1e6 [N*s/m]*(0.1 [m/s] - der(z)) on z;
    event low: y < 0 until y > 0.5m;
    latch since: s = t at low;
    force motor: 40N*low on y;
    out when: s = since;
    start y = 1 rate 0;
}

/// Times at which the motor of the load begins and ends.
pub(crate) fn switched() -> [f64; 2] {
    let (g, up) = (9.81_f64, 40.0 / 2.0 - 9.81);
    let (first, speed) = ((2.0_f64 / g).sqrt(), (2.0_f64 * g).sqrt());
    [first, first + (speed + (speed * speed + 2.0 * up * 0.5).sqrt()) / up]
}

/// Height of the load: down to 0, on to where 10.19 m/s² have turned it, up to 0.5 m, and free from there on.
pub(crate) fn lifted(t: f64) -> f64 {
    let (g, up) = (9.81_f64, 40.0 / 2.0 - 9.81);
    let (speed, [first, end]) = ((2.0_f64 * g).sqrt(), switched());
    if t < first {
        1.0 - 0.5 * g * t * t
    } else if t < end {
        let t = t - first;
        -speed * t + 0.5 * up * t * t
    } else {
        let t = t - end;
        0.5 + (speed * speed + 2.0 * up * 0.5).sqrt() * t - 0.5 * g * t * t
    }
}

#[test]
fn an_event_switches_a_force_of_a_stiff_text() {
    let [first, end] = switched();
    let run = Simulation::start_from_text(Lift::default(), radau(), 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    let mut fixed = Simulation::start_from_text(Lift::default(), radau(), 0.0_f64).expect("it starts");
    for index in 1..=18 {
        let t = 0.1 * f64::from(index);
        run.advance_to(t).expect("it moves");
        fixed.step(0.1).expect("it moves");
        assert!((run.q()[0] - lifted(t)).abs() < 1e-9, "{t}: {} {}", run.q()[0], lifted(t));
        assert!((fixed.q()[0] - lifted(t)).abs() < 1e-9, "{t}: {} {}", fixed.q()[0], lifted(t));
    }
    assert!((run.loads()[0] - first).abs() < 1e-9, "{:?}", run.loads());
    assert!(end < 1.8 && run.counts().steps < 300, "{:?}", run.counts());
}

mechanism! {
    /// A disk that a growing pressure lifts off its seat, as the third power of the time.
    pub mechanism Disk;
    coord x: m = 0;
    body disk { mass: 1, com: [0, x] }
    contact seat { gap: x, restitution: 0.3 }
    force pressure: 2500 [N/s]*t - 100N on x;
    start x = 0 rate 0;
}

#[test]
fn a_disk_that_lifts_off_slowly_takes_few_steps() {
    for tolerance in [1e-6, 1e-9] {
        let run = Simulation::start_from_text(Disk::default(), radau(), 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        run.advance_to(0.078).expect("it lifts off");
        let exact = 2500.0 / 6.0 * 0.038_f64.powi(3);
        assert!((run.q()[0] - exact).abs() < 1e-9, "{} {exact}", run.q()[0]);
        // Errors within a step are as large as the gap: a step there that ends where they pass zero leads nowhere.
        assert!(run.counts().steps < 300, "{tolerance}: {:?}", run.counts());
    }
}

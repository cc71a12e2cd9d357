//! Rigid contacts: bounces that end, impacts of several bodies, contacts that open.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    Direction, DormandPrince5, DormandPrince8, Explicit, Formulation, Projection, RungeKutta4, Simulation,
    Tolerance, Unstabilized, VelocityTransformation,
};
use mbs_runtime::{Dynamic, FailureKind, Real, mechanism};

mechanism! {
    /// A ball above a floor.
    pub mechanism Ball;
    param e: 1 = 0.9;
    param ground: m = 0;
    coord y: m = 1;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y - ground, restitution: e }
    out push: N = force(floor);
    out height: m = gap(floor);
}

/// Time at which infinitely many bounces have ended.
fn end(e: f64) -> f64 {
    (2.0_f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e)
}

/// Height at a time.
fn height(e: f64, t: f64) -> f64 {
    let fall = (2.0_f64 / 9.81).sqrt();
    if t < fall {
        return 1.0 - 0.5 * 9.81 * t * t;
    }
    let (mut begin, mut speed) = (fall, 9.81 * fall);
    for _ in 0..2000 {
        speed *= e;
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
fn a_ball_comes_to_rest_after_infinitely_many_bounces() {
    assert!((end(0.9) - 8.578_949).abs() < 1e-6);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    let mut last = f64::MAX;
    for index in 1..=100 {
        let t = 0.1 * f64::from(index);
        run.advance_to(t).expect("it bounces");
        let energy = run.balance().energy;
        let energy = energy.kinetic + energy.potential;
        assert!(energy <= last + 1e-9, "{t}: {energy} after {last}");
        assert!((run.q()[0] - height(0.9, t)).abs() < 1e-9, "{t}: {} {}", run.q()[0], height(0.9, t));
        assert!(run.balance().defect.abs() < 1e-9, "{t}: {:?}", run.balance());
        last = energy;
    }
    let parameters = run.parameters_with_forces();
    let [mode] = Ball::set_valued_modes(&parameters) else { panic!("one contact") };
    assert!((mode.since - end(0.9)).abs() < 1e-6, "{} {}", mode.since, end(0.9));
    assert!((run.loads()[0] - 2.0 * 9.81).abs() < 1e-12, "{:?}", run.loads());
}

/// Height at 0.5 s, at 6 s, and the time of rest, by fixed steps.
fn by_steps<F: Formulation<Ball<f64>, f64, 1, 0>>(formulation: F, h: f64) -> [f64; 3] {
    let method = Explicit::new(RungeKutta4, formulation);
    let mut run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("it starts");
    let steps = |t: f64| (t / h).round() as u32;
    run.step_to(0.5, steps(0.5)).expect("it bounces");
    let first = run.q()[0];
    run.step_to(6.0, steps(5.5)).expect("it bounces");
    let last = run.q()[0];
    run.step_to(10.0, steps(4.0)).expect("it comes to rest");
    assert!(run.balance().defect.abs() < 1e-9 && run.q()[0].abs() < 1e-12);
    [first, last, Ball::set_valued_modes(&run.parameters_with_forces())[0].since]
}

#[test]
fn fixed_steps_end_at_each_impact() {
    // A parabola is exact for the method: what is left are the times of impacts.
    for found in [
        by_steps(Projection::default(), 1e-2),
        by_steps(VelocityTransformation, 3e-3),
        by_steps(Unstabilized, 0.05),
    ] {
        let [first, last, end_of] = found;
        assert!((first - height(0.9, 0.5)).abs() < 1e-11, "{first}");
        assert!((last - height(0.9, 6.0)).abs() < 1e-9, "{last}");
        assert!((end_of - end(0.9)).abs() < 1e-6, "{end_of}");
    }
}

#[test]
fn impacts_are_where_gaps_are_none_in_single_precision_too() {
    // Passages are found 1.5e-5 m below the floor, 3.5e-6 s late: the impact is 8.4 m/s, so heights would be 3e-5 m off.
    let fall = (2.0_f64 / 9.81).sqrt();
    let start = || {
        let method = Explicit::new(DormandPrince8, Projection::default());
        Simulation::start_from_text(Ball::<f32>::default(), method, 0.0_f32).expect("it starts")
    };
    let method = Explicit::new(RungeKutta4, Projection::default());
    let fixed = Simulation::start_from_text(Ball::<f32>::default(), method, 0.0_f32);
    let (mut adaptive, mut fixed) = (start().with_tolerance(Tolerance::new(1e-5)), fixed.expect("it starts"));
    adaptive.advance_to(0.6).expect("it bounces");
    fixed.step_to(0.6, 40).expect("it bounces");
    // A step that ends within the rounding of places below or above the floor: the impact is at the floor.
    let [below, above] = [1e-6, -1e-6].map(|aside| {
        let mut run = start();
        run.advance_to((fall + aside) as f32).expect("it bounces");
        run.advance_to(0.6).expect("it bounces");
        run
    });
    for q in [adaptive.q()[0], fixed.q()[0], below.q()[0], above.q()[0]] {
        let off = f64::from(q) - height(0.9, 0.6);
        assert!(off.abs() < 2e-6, "{off:e}");
    }
}

/// Largest error (s) of the times at which a run up to events stops where the gap of a ball is none, up to 4 s: `stop` goes on to the next.
fn off_impacts<R: Real>(mut stop: impl FnMut() -> Option<R>) -> f64 {
    let (mut next, mut speed) = ((2.0_f64 / 9.81).sqrt(), (2.0_f64 * 9.81).sqrt());
    let mut worst = 0.0_f64;
    while next < 4.0 {
        let t = stop().expect("it stops at each impact").to_f64();
        worst = worst.max((t - next).abs());
        speed *= 0.9;
        next += 2.0 * speed / 9.81;
    }
    assert!(stop().is_none(), "no other stops");
    worst
}

#[test]
fn runs_up_to_an_event_stop_where_an_impact_turns_it_back() {
    // A place of 1000 m has roundings far above those of a gap of a metre.
    for ground in [0.0, -0.5, 1000.0_f64] {
        let ball = Ball { ground, ..Ball::default() };
        let start = || {
            let method = Explicit::new(DormandPrince8, Projection::default());
            Simulation::start(ball, method, 0.0, [ground + 1.0], [0.0]).expect("it starts")
        };
        for direction in [Direction::Any, Direction::Falling] {
            let mut run = start().with_tolerance(Tolerance::new(1e-12));
            let off = off_impacts(|| {
                let stopped = run.advance_until_event(4.0, direction, |_, q, _| q[0] - ground);
                stopped.expect("it bounces").then(|| run.t())
            });
            assert!(off < 1e-11 * (1.0 + ground.abs()), "{ground} {direction:?}: {off:e}");
        }
        let mut run = start().with_tolerance(Tolerance::new(1e-12));
        assert_eq!(run.advance_until_event(4.0, Direction::Rising, |_, q, _| q[0] - ground), Ok(false));
        for steps in [37, 400] {
            let mut run = start();
            let off = off_impacts(|| {
                let rest = ((4.0 - run.t()) / 4.0 * f64::from(steps)).ceil() as u32;
                let stopped = run.step_until_event(4.0, rest.max(1), Direction::Any, |_, q, _| q[0] - ground);
                stopped.expect("it bounces").then(|| run.t())
            });
            assert!(off < 1e-11 * (1.0 + ground.abs()), "{ground} {steps}: {off:e}");
        }
    }
    for tolerance in [1e-3, 1e-5] {
        let method = Explicit::new(DormandPrince5, Projection::default());
        let run = Simulation::start_from_text(Ball::<f32>::default(), method, 0.0_f32).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        let off = off_impacts(|| {
            let stopped = run.advance_until_event(4.0, Direction::Any, |_, q, _| q[0]);
            stopped.expect("it bounces").then(|| run.t())
        });
        assert!(off < 1e-5, "{tolerance:e}: {off:e}");
    }
}

#[test]
fn single_precision_and_other_coefficients_bounce() {
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Ball::<f32>::default(), method, 0.0_f32).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(2.0).expect("it bounces");
    assert!((f64::from(run.q()[0]) - height(0.9, 2.0)).abs() < 2e-4, "{}", run.q()[0]);
    run.advance_to(10.0).expect("it comes to rest");
    assert!(run.q()[0].abs() < 1e-6 && run.qd()[0] == 0.0);
    let method = Explicit::new(DormandPrince8, Projection::default());
    for e in [0.0, 0.3, 0.99, 1.0] {
        let ball = Ball { e, ..Ball::default() };
        let run = Simulation::start_from_text(ball, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-11));
        run.advance_to(20.0).expect("it bounces");
        assert!((run.q()[0] - height(e, 20.0)).abs() < 1e-7, "{e}: {} {}", run.q()[0], height(e, 20.0));
        assert!(run.balance().defect.abs() < 1e-8, "{e}: {:?}", run.balance());
    }
}

mechanism! {
    /// A ball on a plate that shakes, in a frame far away.
    pub mechanism Plate;
    const A: m = 10mm;
    param e: 1 = 0;
    param away: m = 0;
    coord y: m = 0;
    body ball { mass: 0.3, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact plate { gap: y - away - A*sin(50rad/1s*t), restitution: e }
    out push: N = force(plate);
    start y = away rate 0.5;
}

#[test]
fn a_ball_leaves_a_plate_that_falls_faster() {
    let (a, omega) = (0.01_f64, 50.0_f64);
    let leaves = (9.81 / (a * omega * omega)).asin() / omega;
    for away in [0.0, 900.0] {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let plate = Plate { away, ..Plate::default() };
        let run = Simulation::start_from_text(plate, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-11));
        run.advance_to(leaves - 1e-4).expect("it is carried");
        let push = 0.3 * (9.81 - a * omega * omega * (omega * run.t()).sin());
        assert!((run.loads()[0] - push).abs() < 1e-9, "{} {push}", run.loads()[0]);
        // A plastic impact, then the plate again, from a phase at which it pushes.
        let mut flight = |t: f64| {
            run.advance_to(t).expect("it flies");
            let tau = t - leaves;
            let begin = a * (omega * leaves).sin() + away;
            begin + a * omega * (omega * leaves).cos() * tau - 0.5 * 9.81 * tau * tau
        };
        let wanted = flight(leaves + 0.05);
        assert!((run.q()[0] - wanted).abs() < 1e-9, "{away}: {} {wanted}", run.q()[0]);
        assert!(run.loads()[0] == 0.0);
        run.advance_to(5.0).expect("it hops");
        // Relative to places of 900 m a tolerance of 1e-11 allows 9e-9 m a step.
        let allowed = 1e-11 + 0.3 * 9.81 * away * 1e-11;
        assert!(run.balance().defect.abs() < allowed, "{away}: {:?}", run.balance());
    }
}

mechanism! {
    /// Three balls in a row between two walls.
    pub mechanism Row;
    param e: 1 = 1;
    coord x1: m = 0.1; coord x2: m = 0.5; coord x3: m = 0.6;
    body a { mass: 1, com: [x1, 0] }
    body b { mass: 1, com: [x2, 0] }
    body c { mass: 1, com: [x3, 0] }
    contact left { gap: x1 - 50mm, restitution: e }
    contact first { gap: x2 - x1 - 0.1m, restitution: e }
    contact second { gap: x3 - x2 - 0.1m, restitution: e }
    contact right { gap: 1m - x3, restitution: e }
    start x1 = 0.1 rate 1;
}

#[test]
fn a_row_of_balls_shares_its_impact_as_moreau_says() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Row::default(), method, 0.0_f64).expect("it starts");
    run.advance_to(0.31).expect("they strike");
    // Both contacts reflect at once: the first ball returns with a third of its speed.
    for (found, wanted) in run.qd().iter().zip([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]) {
        assert!((found - wanted).abs() < 1e-12, "{:?}", run.qd());
    }
    run.advance_to(100.0 / every(5) as f64).expect("they go on");
    let balance = run.balance();
    assert!((balance.energy.kinetic - 0.5).abs() < 1e-9 && balance.defect.abs() < 1e-9, "{balance:?}");
    let row = Row { e: 0.5 };
    let mut run = Simulation::start_from_text(row, method, 0.0_f64).expect("it starts");
    let mut last = 0.5;
    for index in 1..400 {
        run.advance_to(0.1 * f64::from(index)).expect("they go on");
        let kinetic = run.balance().energy.kinetic;
        assert!(kinetic <= last + 1e-12, "{index}: {kinetic} {last}");
        last = kinetic;
        let q = run.q();
        let gaps = [q[0] - 0.05, q[1] - q[0] - 0.1, q[2] - q[1] - 0.1, 1.0 - q[2]];
        assert!(gaps.iter().all(|gap| -1e-12 < *gap), "{gaps:?}");
    }
}

mechanism! {
    /// Two balls above each other.
    pub mechanism Stack;
    coord y1: m = 0.5; coord y2: m = 1.2;
    body low { mass: 2, com: [0, y1] }
    body high { mass: 1, com: [0, y2] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y1, restitution: 0.6 }
    contact between { gap: y2 - y1 - 0.1m, restitution: 0.5 }
    out floored: N = force(floor);
    out carried: N = force(between);
}

/// Time in which a ball at height `y` with the speed `v` falls to 0.
fn fall(y: f64, v: f64) -> f64 {
    (v + (v * v + 2.0 * 9.81 * y.max(0.0)).sqrt()) / 9.81
}

/// Heights of two balls by parabolas from impact to impact, up to `until`. Flights below 1e-9 s end the bounces on the floor.
fn stack(until: f64) -> [f64; 2] {
    let (mut t, mut y, mut v, mut rests) = (0.0, [0.5_f64, 1.2], [0.0_f64, 0.0], false);
    loop {
        let (gap, closing) = (y[1] - y[0] - 0.1, v[0] - v[1]);
        let meets = match rests {
            true => fall(gap, v[1]),
            false if closing > 1e-15 => gap.max(0.0) / closing,
            false => f64::MAX,
        };
        let falls = if rests { f64::MAX } else { fall(y[0], v[0]) };
        let step = meets.min(falls).min(until - t);
        for index in (usize::from(rests))..2 {
            y[index] += v[index] * step - 0.5 * 9.81 * step * step;
            v[index] -= 9.81 * step;
        }
        t += step;
        if t >= until || rests && step < 1e-9 {
            return y;
        }
        if falls <= meets {
            rests = step < 1e-9;
            (y[0], v[0]) = (0.0, if rests { 0.0 } else { -0.6 * v[0] });
        } else if rests {
            v[1] *= -0.5;
        } else {
            let impulse = 1.5 * (v[0] - v[1]) / (1.0 / 2.0 + 1.0);
            (v[0], v[1]) = (v[0] - impulse / 2.0, v[1] + impulse);
        }
    }
}

#[test]
fn alternating_bounces_end_with_both_balls_at_rest() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Stack::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    for index in 1..=8 {
        let t = 0.2 * f64::from(index);
        run.advance_to(t).expect("they bounce");
        let wanted = stack(t);
        assert!((run.q()[0] - wanted[0]).abs() < 1e-7, "{t}: {:?} {wanted:?}", run.q());
        assert!((run.q()[1] - wanted[1]).abs() < 1e-7, "{t}: {:?} {wanted:?}", run.q());
    }
    run.advance_to(20.0).expect("they come to rest");
    let [floor, between] = run.loads();
    assert!((floor - 29.43).abs() < 1e-9 && (between - 9.81).abs() < 1e-9, "{floor} {between}");
    assert!(run.q()[0].abs() < 1e-10 && (run.q()[1] - 0.1).abs() < 1e-10, "{:?}", run.q());
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Stack::default(), method, 0.0_f64).expect("it starts");
    run.step_to(20.0, 4000).expect("they come to rest");
    assert!(run.q()[0].abs() < 1e-10 && (run.q()[1] - 0.1).abs() < 1e-10, "{:?}", run.q());
}

mechanism! {
    /// A beam over three supports, which its two degrees of freedom do not tell apart.
    pub mechanism Beam;
    param x: m = 0.1;
    coord y: m = 0.2; coord a: rad = 0.1;
    body beam { mass: 3, com: [0, y], inertia: 0.25, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    force load: [0, -20] on [x*cos(a), y + x*sin(a)];
    contact left { gap: y - 0.5m*sin(a), restitution: 0.4 }
    contact middle { gap: y, restitution: 0.4 }
    contact right { gap: y + 0.5m*sin(a), restitution: 0.4 }
    out pushes: [N; 3] = [force(left), force(middle), force(right)];
}

#[test]
fn a_beam_comes_to_rest_on_three_supports_that_only_push() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for x in [0.0, 0.1, 0.45] {
        let beam = Beam { x };
        let mut run = Simulation::start_from_text(beam, method, 0.0_f64).expect("it starts");
        run.advance_to(10.0).expect("it comes to rest");
        let [left, middle, right] = run.loads();
        let (sum, turn) = (left + middle + right, 0.5 * (right - left));
        assert!((sum - 49.43).abs() < 1e-8 && (turn - 20.0 * x).abs() < 1e-8, "{x}: {:?}", run.loads());
        assert!(run.loads().iter().all(|push| -1e-9 <= *push), "{x}: {:?}", run.loads());
        assert!(run.q().iter().all(|q| q.abs() < 1e-9), "{:?}", run.q());
        assert!(run.balance().defect.abs() < 1e-8, "{:?}", run.balance());
    }
}

mechanism! {
    /// A pendulum in Cartesian coordinates that strikes a wall below its pivot.
    pub mechanism Wall;
    coord p: [m; 2] = [1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    contact wall { gap: p[0], restitution: 0.5 }
}

#[test]
fn impacts_keep_constraints() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Wall::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    let mut highest = -1.0_f64;
    let strike = run.advance_until_event(3.0, Direction::Falling, |_, q, _| q[0] - 1e-9);
    assert!(strike.expect("it falls"));
    run.watch(run.t() + 1.2, 2400, |run| {
        highest = highest.max(run.q()[1]);
        let balance = run.balance();
        assert!(balance.phi < 1e-12 && balance.phi_d < 1e-11 && balance.defect.abs() < 1e-9, "{balance:?}");
    })
    .expect("it returns");
    // A quarter of the energy is left.
    assert!((highest + 0.75).abs() < 1e-5, "{highest}");
}

mechanism! {
    /// A ball below its floor.
    pub mechanism Below;
    coord y: m = -1mm;
    body ball { mass: 2, com: [0, y] }
    contact floor { gap: y, restitution: 0.5 }
}

#[test]
fn what_is_undefined_is_refused() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let failure = Simulation::start_from_text(Below::default(), method, 0.0_f64).expect_err("refused");
    assert!(
        matches!(failure.kind, FailureKind::Penetration { contact, .. } if contact.name == "floor"),
        "{failure}"
    );
    let mut run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("it starts");
    run.advance_to(1.0).expect("it bounces");
    let before = *run.instant();
    run.change(|ball| ball.e = 1.5);
    let failure = run.advance_to(2.0).expect_err("it would gain energy");
    assert!(matches!(failure.kind, FailureKind::Negative { .. }), "{failure}");
    assert_eq!(*run.instant(), before);
}

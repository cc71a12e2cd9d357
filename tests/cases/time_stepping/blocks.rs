//! Blocks that slide and stick: stops of the closed form, the friction limit of a slope, feet that share their forces, belts.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, MoreauJean, Projection, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    /// A block on a rough floor.
    pub mechanism Block;
    param mu: 1 = 0.3;
    coord p: [m; 2] = [0, 0];
    body block { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: p[1], restitution: 0.5 }
    friction rub { along: p[0], normal: normal(floor), coefficient: mu, sticks: mu }
    start p = [0, 0] rate [2, 0];
    out drag: N = force(rub);
    out push: N = force(floor);
}

mechanism! {
    /// A block on two feet on a slope: frictions of both act along one direction.
    pub mechanism Slope;
    param mu: 1 = 0.5;
    param slope: rad = 0.4;
    coord s: [m; 2] = [0, 0];
    coord a: rad = 0;
    body block { mass: 2, com: s, inertia: 0.01, angle: a }
    gravity weight { acceleration: [9.81*sin(slope), -9.81*cos(slope)] }
    contact left { gap: s[1] - 0.1m*sin(a) - 0.05m*cos(a) + 0.05m, restitution: 0 }
    contact right { gap: s[1] + 0.1m*sin(a) - 0.05m*cos(a) + 0.05m, restitution: 0 }
    friction one { along: s[0] - 0.1m*cos(a) + 0.05m*sin(a), normal: normal(left), coefficient: mu, sticks: mu }
    friction two { along: s[0] + 0.1m*cos(a) + 0.05m*sin(a), normal: normal(right), coefficient: mu, sticks: mu }
    out loads: [N; 4] = [force(left), force(right), force(one), force(two)];
}

mechanism! {
    /// A block on a belt, held by a spring: its normal force is given.
    pub mechanism Belt;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction rub { along: x - 0.1 [m/s]*t, normal: 9.81, coefficient: 0.1, sticks: 0.15 }
    start x = 0 rate 0.1;
    out drag: N = force(rub);
}

#[test]
fn a_block_stops_after_its_way_and_rests_there() {
    // v²/(2 μ g), whatever the place of the stop in its step.
    let way = 4.0 / (2.0 * 0.3 * 9.81);
    for h in [8e-3, 4e-3, 2e-3, 1e-3] {
        let mut run = Simulation::start_from_text(Block::default(), MoreauJean, 0.0_f64).expect("it starts");
        run.step_to(2.0, (2.0_f64 / h).round() as u32).expect("it slides");
        let off = run.q()[0] - way;
        println!("block that slides to rest: off by {off:.1e} m in steps of {h} s");
        assert!(off.abs() < 0.2 * h * h * 9.81, "{h}: {off:e}");
        assert_eq!((run.qd(), run.loads().as_ref()), (&[0.0; 2], &[0.0, 2.0 * 9.81][..]));
        let place = *run.q();
        run.step_to(3.0, (1.0_f64 / h).round() as u32).expect("it rests");
        assert_eq!(run.q(), &place);
        // Half of the friction's work in the step of the stop is not seen.
        assert!(run.balance().defect.abs() < 10.0 * h * h, "{:?}", run.balance());
    }
}

#[test]
fn a_thrown_block_agrees_with_located_impacts() {
    let located = {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let mut run =
            Simulation::start(Block::default(), method, 0.0_f64, [0.0, 0.5], [3.0, 0.0]).expect("a start");
        run.advance_to(2.0).expect("it bounces and slides");
        *run.q()
    };
    for h in [2e-3, 1e-3, 5e-4] {
        let start = Simulation::start(Block::default(), MoreauJean, 0.0_f64, [0.0, 0.5], [3.0, 0.0]);
        let mut run = start.expect("a start");
        let mut last = f64::MAX;
        for _ in 0..(2.0_f64 / h).round() as u32 {
            run.step(h).expect("it bounces and slides");
            let energy = run.balance().energy;
            assert!(energy.kinetic + energy.potential <= last + 1e-12, "{:?}", run.instant());
            last = energy.kinetic + energy.potential;
        }
        let off = run.q()[0] - located[0];
        assert!(off.abs() < 0.1 * h && run.q()[1].abs() < 1e-4, "{h}: {off:e} {:?}", run.q());
    }
}

#[test]
fn a_slope_holds_up_to_its_limit_and_not_beyond() {
    let slope: f64 = 0.4;
    for (above, holds) in [(1e-3, true), (1e-6, true), (-1e-6, false), (-1e-3, false)] {
        let block = Slope { mu: slope.tan() + above, slope };
        let mut run = Simulation::start(block, MoreauJean, 0.0_f64, [0.0; 3], [0.0; 3]).expect("a start");
        run.step_to(1.0, 250).expect("it rests or slides");
        let wanted = if holds { 0.0 } else { -0.5 * above * 9.81 * slope.cos() };
        assert!((run.q()[0] - wanted).abs() < 1e-12, "{above}: {:?}", run.q());
        // Weight and moment about both feet: the lower one bears more.
        let loads = run.loads();
        let [left, right, one, two] = loads;
        let weight = 2.0 * 9.81;
        let drag = if holds { weight * slope.sin() } else { (slope.tan() + above) * weight * slope.cos() };
        assert!((left + right - weight * slope.cos()).abs() < 1e-9, "{loads:?}");
        assert!((one + two + drag).abs() < 1e-9, "{loads:?}");
        assert!((0.1 * (right - left) - 0.05 * drag).abs() < 1e-9, "{loads:?}");
    }
    // Pushed downwards on a rough slope: it stops after v²/(2 g (μ cos − sin)).
    let run = Simulation::start(Slope { mu: 0.5, slope }, MoreauJean, 0.0_f64, [0.0; 3], [2.0, 0.0, 0.0]);
    let mut run = run.expect("a start");
    run.step_to(3.0, 1500).expect("it stops");
    let way = 4.0 / (2.0 * 9.81 * (0.5 * slope.cos() - slope.sin()));
    assert!((run.q()[0] - way).abs() < 1e-5 && run.qd()[0].abs() < 1e-15, "{:?} {way}", run.instant());
}

#[test]
fn a_belt_takes_a_block_along_and_lets_it_slip() {
    // It sticks up to 1.4715 N at x = 0.73575; sliding it swings about 0.4905 m with √2 rad/s until it has the belt's speed again.
    let (low, high, omega) = (0.1 * 9.81 / 2.0, 0.15 * 9.81 / 2.0, 2.0_f64.sqrt());
    let slip = high / 0.1;
    let phase = (0.1 / omega).atan2(high - low);
    let stick = slip + 2.0 * (std::f64::consts::PI - phase) / omega;
    for (t, x) in
        [(5.0, 0.5), (8.0, low + (high - low).hypot(0.1 / omega) * (omega * (8.0 - slip) - phase).cos())]
    {
        for h in [4e-3, 1e-3] {
            let mut run =
                Simulation::start_from_text(Belt::default(), MoreauJean, 0.0_f64).expect("it starts");
            run.step_to(t, (t / h).round() as u32).expect("it moves");
            assert!((run.q()[0] - x).abs() < 0.2 * h, "{h}: {:?} {x}", run.q());
        }
    }
    let mut run = Simulation::start_from_text(Belt::default(), MoreauJean, 0.0_f64).expect("it starts");
    run.step_to(stick + 0.5, 6000).expect("it sticks again");
    assert!((run.qd()[0] - 0.1).abs() < 1e-14, "{:?}", run.instant());
    let place = run.q()[0];
    run.step_to(stick + 1.5, 1000).expect("it sticks");
    assert!((run.q()[0] - place - 0.1).abs() < 1e-13, "{:?}", run.instant());
}

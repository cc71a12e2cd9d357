//! Simulations at rest that sleep: up to when, at what cost, and that nothing else changes.
//!
//! Times are compared with closed forms, motions with the same simulations that never sleep.

#[path = "../worst_case/counted.rs"]
mod counted;

use counted::{Counted, counted};
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Counts, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method,
    MoreauJean, Projection, RungeKutta4, Simulation, Simulations,
};
use mbs_runtime::{Dynamic, Failure, Real, Signal, mechanism};

type Fixed = Explicit<RungeKutta4, Projection>;

fn fixed() -> Fixed {
    Explicit::new(RungeKutta4, Projection::default())
}

fn started<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: S,
) -> Simulation<S, Fixed, R, N, M> {
    Simulation::start_from_text(mechanism, fixed(), R::constant(0.0)).expect("a start")
}

fn all<const L: usize>(results: [Result<(), Failure>; L]) {
    results.into_iter().for_each(|result| result.expect("a step"));
}

/// Steps a lane and the same simulation without sleep; the lane's sleep behind each step, and the largest difference.
fn beside<S: Dynamic<f64, N, M>, X: Method<S, f64, N, M> + Copy, const N: usize, const M: usize>(
    run: Simulation<S, X, f64, N, M>,
    h: f64,
    steps: usize,
) -> (Vec<Option<f64>>, f64)
where
    Simulation<S, X, f64, N, M>: Clone,
{
    let (mut awake, mut lanes) = (run.clone(), Simulations::new([run]));
    let (mut sleeps, mut apart) = (Vec::new(), 0.0_f64);
    for _ in 0..steps {
        awake.step(h).expect("a step");
        all(lanes.step(h));
        sleeps.push(lanes.asleep_until()[0]);
        let lane = lanes.read(0).expect("a lane").expect("forces");
        assert_eq!(lane.t(), awake.t());
        for (one, other) in [(lane.q(), awake.q()), (lane.qd(), awake.qd()), (lane.qdd(), awake.qdd())] {
            one.iter().zip(other).for_each(|(one, other)| apart = apart.max((one - other).abs()));
        }
        lane.lambda()
            .iter()
            .zip(awake.lambda())
            .for_each(|(one, other)| apart = apart.max((one - other).abs()));
        let [one, other] = [lane.balance(), awake.balance()].map(|balance| balance.defect);
        apart = apart.max((one - other).abs());
    }
    (sleeps, apart)
}

mechanism! {
    /// A block on a slope, drawn down by a force that grows.
    pub mechanism Slope;
    param m: kg = 2;
    param beta: rad = 0.3;
    param growth: N/s = 3;
    param mu: 1 = 0.4;
    param mus: 1 = 0.5;
    coord s: m = 0.1;
    coord n: m = 0;
    let place = s*unit(-beta) + n*unit(90deg - beta);
    body block { mass: m, com: place }
    gravity weight { acceleration: [0, -9.81] }
    force draw: growth*t*unit(-beta) on place;
    contact floor { gap: n, restitution: 0 }
    friction rub { along: s, normal: normal(floor), coefficient: mu, sticks: mus }
    start s = 0.1 rate 0;
    start n = 0 rate 0;
    out held: N = force(rub);
}

#[test]
fn a_block_on_a_slope_wakes_where_it_begins_to_slide() {
    let slope: Slope = Slope::default();
    let (sine, cosine) = slope.beta.sin_cos();
    let weight = slope.m * 9.81;
    let slides = weight * (slope.mus * cosine - sine) / slope.growth;
    let (sleeps, apart) = beside(started(slope), 1e-2, 300);
    let until = sleeps[0].expect("it sleeps after the first step");
    println!("sleep up to {until:.12} s, exactly {slides:.12}, change of the motion {apart:.1e}");
    assert!((until - slides).abs() < 1e-9 && until <= slides);
    for (step, sleep) in sleeps.iter().enumerate() {
        let t = 1e-2 * (step + 1) as f64;
        assert_eq!(sleep.is_some(), t < slides, "{t}");
    }
    assert!(apart < 1e-11, "{apart}");

    // Methods that carry accelerations from step to step, and implicit ones.
    let implicit = [
        beside(
            Simulation::start_from_text(slope, GeneralizedAlpha::default(), 0.0).expect("a start"),
            1e-2,
            200,
        ),
        beside(Simulation::start_from_text(slope, AugmentedLagrangian, 0.0).expect("a start"), 1e-2, 200),
        beside(Simulation::start_from_text(slope, Extrapolated, 0.0).expect("a start"), 1e-2, 200),
    ];
    for (sleeps, apart) in implicit {
        println!("by an implicit method: change of the motion {apart:.1e}");
        assert!(sleeps[117].is_some() && sleeps[119].is_none() && apart < 1e-8, "{apart}");
    }

    // The time at which it slides, from its speed: m v = Δ τ + growth τ²/2 with the drop Δ of friction.
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut lanes = Simulations::new([Simulation::start_from_text(slope, method, 0.0).expect("a start")]);
    for t in [0.1, 0.5, slides + 0.5] {
        all(lanes.advance_to(t));
        assert_eq!(lanes.asleep_until()[0].is_some(), t < slides);
    }
    let v = lanes.read(0).expect("a lane").expect("forces").qd()[0];
    let drop = weight * cosine * (slope.mus - slope.mu);
    let tau = ((drop * drop + 2.0 * slope.growth * slope.m * v).sqrt() - drop) / slope.growth;
    println!("it slides {:.1e} s off", tau - 0.5);
    assert!((tau - 0.5).abs() < 1e-9);
}

#[test]
fn a_step_of_a_lane_that_sleeps_evaluates_nothing() {
    let number = |value: f64| Counted(value);
    let slope = Slope { growth: number(0.0), ..Slope::default() };
    let mut lanes = Simulations::new([started(slope)]);
    let (_, awake) = counted(|| all(lanes.step(number(1e-3))));
    assert!(lanes.asleep_until()[0].is_some_and(|until| until.0 > 1e12));
    let before = lanes.read(0).expect("a lane").expect("forces").counts();
    let (_, asleep) = counted(|| (0..1000).for_each(|_| all(lanes.step(number(1e-3)))));
    println!("operations of a step: {awake:?} at first, {asleep:?} of 1000 asleep");
    assert!(asleep.multiplications == 0 && asleep.functions == 0 && asleep.divisions == 0);
    assert!(asleep.additions <= 6 * 1000 && asleep.comparisons <= 10 * 1000, "{asleep:?}");
    let lane = lanes.read(0).expect("a lane").expect("forces");
    let counts = Counts { evaluations: before.evaluations + 1, ..before };
    assert!((lane.t().0 - 1.001).abs() < 1e-12 && lane.counts() == counts, "{:?}", lane.counts());
    assert_eq!(lane.q()[0].0, 0.1);
}

mechanism! {
    /// A pendulum of a rod.
    pub mechanism Pendulum;
    param c: N*m*s/rad = 0;
    param moment: N*m = 0;
    param angle: rad = -90deg;
    coord phi: rad = angle;
    coord p: [m; 2] = [0, -0.5];
    body rod { mass: 1, com: p, inertia: 1/12, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    constraint place { p == 0.5m*unit(phi); }
    torque oil: -c*der(phi) on phi;
    torque load: moment*max(0, t - 0.5s)/1s on phi;
    start phi = angle rate 0;
}

mechanism! {
    /// The same with friction in its pivot.
    pub mechanism Held;
    param moment: N*m = 3;
    param force: N = 60;
    param angle: rad = 90deg;
    coord phi: rad = angle;
    coord p: [m; 2] = [0, 0.5];
    body rod { mass: 1, com: p, inertia: 1/12, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    constraint place { p == 0.5m*unit(phi); }
    friction pivot { along: 0.1m*phi, normal: force, coefficient: 0.9, sticks: 1 }
    torque load: moment*t/1s on phi;
    start phi = angle rate 0;
}

#[test]
fn a_stable_rest_sleeps_and_an_unstable_one_never() {
    let sleeps = |pendulum: Pendulum, steps| beside(started(pendulum), 1e-3, steps);
    let (hangs, apart) = sleeps(Pendulum::default(), 100);
    assert!(hangs.iter().all(Option::is_some) && apart < 1e-12, "{apart}");
    let (stands, _) = sleeps(Pendulum { angle: 90.0_f64.to_radians(), ..Pendulum::default() }, 1000);
    assert!(stands.iter().all(Option::is_none));
    // One that swings falls asleep once its swing is less than a nanoradian: after ln(1e9)/(c/2 J) s, J = 1/3.
    let swings = Pendulum { c: 1.0, angle: -89.0_f64.to_radians(), ..Pendulum::default() };
    let (sleeps, apart) = beside(started(swings), 2e-3, 8000);
    let first = sleeps.iter().position(Option::is_some).expect("it comes to rest");
    let after = 2e-3 * first as f64;
    println!("a pendulum that swings out sleeps after {after} s, change of the motion {apart:.1e}");
    assert!((11.0..14.0).contains(&after) && apart < 5e-8, "{after} {apart}");
    // A load on a free motion wakes it where that begins.
    let (loaded, apart) = beside(started(Pendulum { moment: 2.0, ..Pendulum::default() }), 1e-2, 100);
    assert!(loaded[0].is_some_and(|until| (until - 0.5).abs() < 1e-7), "{:?}", loaded[0]);
    assert!(loaded[30].is_some() && loaded[51..].iter().all(Option::is_none) && apart < 1e-7, "{apart}");
    // Friction holds the unstable one: 60 N on a radius of 0.1 m against 3 N m/s.
    let (held, apart) = beside(started(Held::<f64>::default()), 1e-2, 250);
    assert!(held[0].is_some_and(|until| (until - 2.0).abs() < 1e-9), "{:?}", held[0]);
    assert!(held[198].is_some() && held[200..].iter().all(Option::is_none) && apart < 1e-11, "{apart}");
}

mechanism! {
    /// A block on a rough floor, drawn by an input.
    pub mechanism Block;
    input draw: N, rates;
    param pulse: N = 0;
    param late: N = 0;
    param when: s = 1e11;
    param tilt: m/s^3 = 0;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    gravity weight { acceleration: [tilt*t, -9.81] }
    force along: [draw + pulse*exp(-((t - 5s)/1ms)^2), 0] on [x, 0];
    friction rub { along: x, normal: 10N, coefficient: 0.2, sticks: 0.3 }
    event begins: t > when;
    force behind: [late*begins, 0] on [x, 0];
    start x = 0 rate 0;
}

fn drawn(value: f64, rate: f64, acceleration: f64) -> Block {
    Block { draw: Signal { value, rate, acceleration }, ..Block::default() }
}

#[test]
fn a_block_wakes_by_inputs_pulses_and_events() {
    let until = |block: Block| {
        let mut lanes = Simulations::new([started(block)]);
        all(lanes.step(0.01));
        lanes.asleep_until()[0].expect("it sleeps")
    };
    // An input with rates reaches 3 N.
    assert!((until(drawn(1.0, 0.5, 0.0)) - 4.0).abs() < 1e-9);
    assert!((until(drawn(-1.0, 0.0, -0.25)) - 4.0).abs() < 1e-9);
    assert!(until(drawn(2.9, 0.0, 0.0)) > 9e10);
    // A pulse of 50 N that lasts for milliseconds, seconds later.
    let pulse = until(Block { pulse: 50.0, ..drawn(0.0, 0.0, 0.0) });
    let begins = 5.0 - 1e-3 * (50.0_f64 / 3.0).ln().sqrt();
    assert!((pulse - begins).abs() < 1e-9 && pulse <= begins, "{pulse}");
    assert!(until(Block { pulse: 2.9, ..drawn(0.0, 0.0, 0.0) }) > 9e10);
    // A force that an event switches on.
    let late = until(Block { late: 5.0, when: 2.0, ..drawn(0.0, 0.0, 0.0) });
    assert!((late - 2.0).abs() < 1e-9 && late <= 2.0, "{late}");

    let blocks = [
        (drawn(1.0, 0.5, 0.0), 500),
        (Block { pulse: 50.0, ..drawn(0.0, 0.0, 0.0) }, 520),
        (Block { late: 5.0, when: 2.0, ..drawn(0.0, 0.0, 0.0) }, 300),
        (Block { late: 2.0, when: 2.0, ..drawn(0.0, 0.0, 0.0) }, 300),
        (Block { tilt: 1.0, ..drawn(0.0, 0.0, 0.0) }, 400),
    ];
    for (block, steps) in blocks {
        let (sleeps, apart) = beside(started(block), 1e-2, steps);
        let asleep = sleeps.iter().filter(|sleep| sleep.is_some()).count();
        println!("asleep in {asleep} of {steps} steps, change of the motion {apart:.1e}");
        assert!(2 * asleep > steps && apart < 1e-10, "{apart}");
    }
}

#[test]
fn a_changed_input_wakes_one_lane() {
    let mut lanes = Simulations::new([started(drawn(1.0, 0.0, 0.0)); 2]);
    for _ in 0..100 {
        all(lanes.step(0.01));
    }
    assert!(lanes.asleep_until().iter().all(Option::is_some));
    assert!(lanes.change(0, |block| block.draw.value = 4.0).is_some());
    assert!(lanes.change(2, |_| ()).is_none() && lanes.read(2).is_none());
    assert!(lanes.asleep_until()[0].is_none() && lanes.asleep_until()[1].is_some());
    for _ in 0..100 {
        all(lanes.step(0.01));
    }
    let [slides, rests] = [0, 1].map(|lane| {
        let lane = lanes.read(lane).expect("a lane").expect("forces");
        (lane.t(), lane.q()[0])
    });
    // 4 N less 2 N of friction on 1 kg for 1 s.
    assert!((slides.1 - 1.0).abs() < 1e-12 && rests.1 == 0.0 && slides.0 == rests.0);
    assert!(lanes.asleep_until()[0].is_none());
    // It comes to rest and sleeps again.
    lanes.change(0, |block| block.draw.value = 0.0);
    for _ in 0..110 {
        all(lanes.step(0.01));
    }
    assert!(lanes.asleep_until()[0].is_some());
    let stopped = lanes.read(0).expect("a lane").expect("forces").q()[0];
    assert!((stopped - 2.0).abs() < 1e-9, "{stopped}");
    // No step of a lane that sleeps hides a wrong one.
    assert!(lanes.step(-0.01)[0].is_err() && lanes.step(f64::NAN)[1].is_err());
}

mechanism! {
    /// Two blocks, one on the other, between a spring and forces of any kind.
    pub mechanism Stack;
    param swings: N = 1;
    param omega: rad/s = 1;
    param phase: rad = 0;
    param grows: N/s = 0;
    param pulse: N = 0;
    param at: s = 1;
    param width: s = 0.1;
    param k: N/m = 10;
    coord x: m = 0;
    coord y: m = 0;
    coord h: m = 0;
    body low { mass: 2, com: [x, h] }
    body high { mass: 1, com: [y, h] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: h, restitution: 0 }
    friction under { along: x, normal: normal(floor), coefficient: 0.2, sticks: 0.3 }
    friction between { along: y - x, normal: 9.81N, coefficient: 0.3, sticks: 0.4 }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: k, length: 1 }
    force on_high: [swings*sin(omega*t + phase) + grows*t + pulse*exp(-((t - at)/width)^2), 0] on [y, h];
    start x = 0 rate 0;
    start y = 0 rate 0;
    start h = 0 rate 0;
}

#[test]
fn random_forces_move_lanes_that_sleep_as_they_move_others() {
    let mut seed = 1_u64;
    let mut random = |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut asleep, mut slept, mut most) = (0, 0, 0.0_f64);
    for _ in 0..8 {
        let stack = Stack {
            swings: random(0.0, 5.0),
            omega: random(0.1, 8.0),
            phase: random(-3.0, 3.0),
            grows: random(-1.0, 1.5),
            pulse: random(-6.0, 6.0),
            at: random(0.0, 3.0),
            width: random(0.02, 0.3),
            k: random(0.0, 30.0),
        };
        let (sleeps, apart) = beside(started(stack), 1.5e-2, 200);
        let here = sleeps.iter().filter(|sleep| sleep.is_some()).count();
        (asleep, slept, most) = (asleep + here, slept + usize::from(here > 0), most.max(apart));
    }
    println!("{slept} of 8 sleep, in {asleep} of 1600 steps, change of the motion {most:.1e}");
    assert!(slept > 6 && asleep > 400 && asleep < 1500 && most < 1e-9, "{slept} {asleep} {most}");
}

mechanism! {
    /// A block on a floor with friction that is smooth.
    pub mechanism Creeping;
    param draw: N = 1;
    param k: N/m = 0;
    param slow: m/s = 1mm/1s;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    force along: [draw, 0] on [x, 0];
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: k, length: 1 }
    friction rub { along: x, normal: 10N, coefficient: 0.3, speed: slow }
    start x = 0 rate 0;
}

#[test]
fn smooth_friction_never_sleeps() {
    let method = Explicit::new(mbs_runtime::dynamics::Radau5, Projection::default());
    // It creeps by 1e-11 m/s, by 1e-9 m/s, and not at all; a spring draws it back as slowly.
    for creeping in [
        Creeping { slow: 3e-11, ..Creeping::default() },
        Creeping { slow: 3e-9, ..Creeping::default() },
        Creeping { draw: 0.0, ..Creeping::default() },
        Creeping { k: 1.0, slow: 1e-10, ..Creeping::default() },
    ] {
        let run = Simulation::start_from_text(creeping, method, 0.0).expect("a start");
        let mut lanes = Simulations::new([run]);
        for step in 1..=100 {
            all(lanes.advance_to(0.1 * f64::from(step)));
            assert!(lanes.asleep_until()[0].is_none(), "{creeping:?}");
        }
    }
}

mechanism! {
    /// A block between a floor that a screw lowers and a press whose force falls.
    pub mechanism Pressed;
    param falls: N/s = 1;
    param lowers: m/s = 0;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 1, com: [x, y] }
    force press: [2N, -(20N - falls*t)] on [x, y];
    constraint guide { y == min(0, 1s - t)*lowers; }
    friction rub { along: x, normal: lambda(guide), coefficient: 0.4, sticks: 0.5 }
    start x = 0 rate 0;
}

#[test]
fn normal_forces_and_drives_are_watched() {
    // The normal force is 20 N − t, its half 2 N at 16 s.
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = |pressed: Pressed| Simulation::start_from_text(pressed, method, 0.0).expect("a start");
    let mut lanes = Simulations::new([
        start(Pressed::default()),
        start(Pressed { falls: 0.0, ..Pressed::default() }),
        start(Pressed { falls: 0.0, lowers: 0.1 }),
    ]);
    all(lanes.advance_to(0.1));
    let [falls, stays, lowers] = lanes.asleep_until();
    assert!(falls.is_some_and(|until| (until - 16.0).abs() < 1e-9), "{falls:?}");
    assert!(stays.is_some_and(|until| until > 1e12), "{stays:?}");
    assert!(lowers.is_some_and(|until| (until - 1.0).abs() < 1e-9), "{lowers:?}");
    all(lanes.advance_to(2.0));
    let [y, rate] = {
        let lane = lanes.read(2).expect("a lane").expect("forces");
        [lane.q()[1], lane.qd()[1]]
    };
    assert!((y + 0.1).abs() < 1e-12 && (rate + 0.1).abs() < 1e-12);
    assert!(lanes.asleep_until()[2].is_none());
}

mechanism! {
    /// A block on two supports that share its weight, and one that hangs above a floor that rises.
    pub mechanism Supports;
    param rises: m/s = 0;
    param draw: N/s = 0;
    coord y: m = 0;
    coord z: m = 1;
    body low { mass: 1, com: [0, y] }
    body high { mass: 1, com: [1, z] }
    gravity weight { acceleration: [0, -9.81] }
    contact one { gap: y, restitution: 0 }
    contact two { gap: 2*y, restitution: 0 }
    tsda spring { from: [1, 2], to: [1, z], stiffness: 1000, length: 1 - 9.81/1000 }
    contact floor { gap: z - 0.5m - rises*t, restitution: 0.5 }
    force up: [0, draw*t] on [0, y];
    start y = 0 rate 0;
    start z = 1 rate 0;
}

#[test]
fn contacts_that_share_a_force_and_gaps_that_close() {
    let mut lanes = Simulations::new([
        started(Supports::<f64>::default()),
        started(Supports { rises: 0.25, ..Supports::default() }),
        started(Supports { draw: 9.81, ..Supports::default() }),
    ]);
    all(lanes.step(1e-3));
    let [rests, closes, lifted] = lanes.asleep_until();
    assert!(rests.is_some_and(|until| until > 1e12), "{rests:?}");
    assert!(closes.is_some_and(|until| (until - 2.0).abs() < 1e-9), "{closes:?}");
    // Forces that are shared are not followed over the time.
    assert!(lifted.is_none(), "{lifted:?}");
}

#[test]
fn lanes_in_single_precision_sleep_too_and_time_stepping_does_not() {
    let mut lanes = Simulations::new([started(Slope::<f32>::default())]);
    all(lanes.step(1e-2));
    let slides = 2.0 * 9.81 * (0.5 * 0.3_f32.cos() - 0.3_f32.sin()) / 3.0;
    assert!(lanes.asleep_until()[0].is_some_and(|until| (until - slides).abs() < 1e-3 * slides));
    let run = Simulation::start_from_text(Slope::default(), MoreauJean, 0.0).expect("a start");
    let mut lanes = Simulations::new([run]);
    all(lanes.step(1e-2));
    assert!(lanes.asleep_until()[0].is_none());
}

//! D15: the stiff method with all further features of a text: first-order states, rates, events, redundant rows, `f32`.

use mbs_runtime::dynamics::{Direction, Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::mechanism;

use crate::texts::{Belt, Oscillator};

fn radau() -> Explicit<Radau5, Projection> {
    Explicit::new(Radau5, Projection::default())
}

mechanism! {
    /// A mass that a controller holds through a fast actuator and a faster filter.
    pub mechanism Loop;
    param k: N/m = 40;
    param c: N*s/m = 9;
    param tau: s = 1e-5;
    param delay: s = 1e-4;
    coord x: m = 1;
    body mass { mass: 1, com: [x, 0] }
    state pull: N = 0;
    state seen: m = 0;
    der(seen) == (x - seen)/tau;
    der(pull) == (-k*seen - c*der(x) - pull)/delay;
    force actuator: [pull, 0] on [x, 0];
    start x = 1 rate 0;
}

/// e^A applied to a vector, by Taylor's series of a share of A and repeated squares.
fn exponential(matrix: [[f64; 4]; 4], start: [f64; 4]) -> [f64; 4] {
    const SQUARES: i32 = 30;
    let product = |a: &[[f64; 4]; 4], b: &[[f64; 4]; 4]| -> [[f64; 4]; 4] {
        core::array::from_fn(|i| core::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let small = matrix.map(|row| row.map(|entry| entry / 2_f64.powi(SQUARES)));
    // e^B − 1, which keeps its digits without the 1.
    let mut less_one = small;
    let mut term = small;
    for order in 2..12 {
        term = product(&term, &small).map(|row| row.map(|entry| entry / f64::from(order)));
        for (sum, term) in less_one.iter_mut().flatten().zip(term.iter().flatten()) {
            *sum += term;
        }
    }
    for _ in 0..SQUARES {
        let square = product(&less_one, &less_one);
        for (sum, square) in less_one.iter_mut().flatten().zip(square.iter().flatten()) {
            *sum = 2.0 * *sum + square;
        }
    }
    core::array::from_fn(|i| start[i] + (0..4).map(|k| less_one[i][k] * start[k]).sum::<f64>())
}

#[test]
fn first_order_states_with_short_time_constants_cost_no_short_steps() {
    for (tau, delay) in [(1e-2, 1e-3), (1e-5, 1e-4), (1e-7, 1e-6)] {
        let text: Loop = Loop { tau, delay, ..Loop::default() };
        let run = Simulation::start_from_text(text, radau(), 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-8));
        run.advance_to(2.0).expect("it moves");
        let rates = [
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, -text.c / delay, -1.0 / delay, -text.k / delay],
            [1.0 / tau, 0.0, 0.0, -1.0 / tau],
        ];
        let [x, v, pull, seen] =
            exponential(rates.map(|row| row.map(|rate| 2.0 * rate)), [1.0, 0.0, 0.0, 0.0]);
        let states = run.states();
        let apart = [run.q()[0] - x, run.qd()[0] - v, (states[0] - pull) / text.k, states[1] - seen];
        let error = apart.iter().fold(0.0_f64, |worst, apart| worst.max(apart.abs()));
        let counts = run.counts();
        println!(
            "loop, {tau:e} s: {error:.1e}, {} right-hand sides, {} steps",
            counts.evaluations, counts.steps
        );
        assert!(error < 1e-6 && counts.steps < 1000, "{tau:e}: {error:e} in {} steps", counts.steps);
    }
}

mechanism! {
    /// A crank at a prescribed rate that a stiff spring joins to a damped wheel.
    pub mechanism Coupled;
    coord crank: rad = 0;
    coord wheel: rad = 0;
    body flywheel { mass: 1, com: [0, 0], inertia: 1e-3, angle: wheel }
    rsda spring { angle: wheel - crank, stiffness: 1e5, damping: 1e2 }
    drive motor: rate(crank) == 2rad/1s + 1rad/1s*sin(3*t/1s);
    start wheel = 0 rate 2;
}

#[test]
fn a_prescribed_rate_is_integrated_within_the_tolerance() {
    for tolerance in [1e-4, 1e-6, 1e-8] {
        let run = Simulation::start_from_text(Coupled::default(), radau(), 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        run.advance_to(4.0).expect("it turns");
        let exact = 2.0 * 4.0 + (1.0 - f64::cos(12.0)) / 3.0;
        let error = (run.q()[0] - exact).abs();
        println!("rate, {tolerance:e}: {error:.1e}, {} steps", run.counts().steps);
        assert!(error < 10.0 * exact * tolerance, "{tolerance:e}: {error:e}");
    }
}

#[test]
fn an_event_ends_a_stiff_step() {
    let start = || Simulation::start_from_text(Oscillator::default(), radau(), 0.0_f64).expect("it starts");
    let mut found = Vec::new();
    for tolerance in [1e-6, 1e-9] {
        let mut run = start().with_tolerance(Tolerance::new(tolerance));
        assert!(run.advance_until_event(5.0, Direction::Rising, |_, q, _| q[0] - 0.05).expect("it moves"));
        found.push(run.t());
        assert!((run.q()[0] - 0.05).abs() < 1e-12, "{:e}", run.q()[0] - 0.05);
    }
    let apart = (found[1] - found[0]).abs();
    println!("event at {} s, {apart:.1e} s apart from a coarser tolerance", found[1]);
    assert!(apart < 1e-4);
    // The position there is that of a run that ends at the time.
    let mut run = start().with_tolerance(Tolerance::new(1e-9));
    run.advance_to(found[1]).expect("it moves");
    assert!((run.q()[0] - 0.05).abs() < 1e-7, "{:e}", run.q()[0] - 0.05);
}

#[test]
fn instants_between_stiff_steps_are_on_the_way() {
    let mut run = Simulation::start_from_text(Belt::default(), radau(), 0.0_f64).expect("it starts");
    run = run.with_tolerance(Tolerance::new(1e-8));
    let mut seen = Vec::new();
    run.sample(3.0, 60, |instant| seen.push((instant.t, instant.y.q[0]))).expect("it moves");
    let mut worst = 0.0_f64;
    for (t, x) in seen {
        let mut other = Simulation::start_from_text(Belt::default(), radau(), 0.0_f64).expect("it starts");
        other = other.with_tolerance(Tolerance::new(1e-10));
        other.advance_to(t).expect("it moves");
        worst = worst.max((other.q()[0] - x).abs());
    }
    println!("between steps: {worst:.1e} m");
    assert!(worst < 1e-5, "{worst:e}");
}

mechanism! {
    /// A pendulum in Cartesian coordinates whose row is typed twice.
    pub mechanism Twice;
    coord p: [m; 2] = [1, 0];
    body bob { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod redundant { dot(p, p) == 1 [m^2]; 2*dot(p, p) == 2 [m^2]; }
    start p = [1, 0] rate [0, 0];
}

/// Angle of the pendulum below the level after `t` (s), by RK4 with steps of a ten-thousandth of a second.
fn swung(t: f64) -> f64 {
    let (h, mut y) = (1e-4, [0.0, 0.0]);
    let rates = |[angle, rate]: [f64; 2]| [rate, 9.81 * f64::cos(angle)];
    for _ in 0..(t / h).round() as u32 {
        let moved = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let first = rates(y);
        let second = rates(moved(first, 0.5));
        let third = rates(moved(second, 0.5));
        let fourth = rates(moved(third, 1.0));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    y[0]
}

#[test]
fn redundant_rows_need_no_care_in_stiff_steps() {
    let run = Simulation::start_from_text(Twice::default(), radau(), 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-9));
    run.advance_to(3.0).expect("it swings");
    let angle = swung(3.0);
    let error = (run.q()[0] - angle.cos()).hypot(run.q()[1] + angle.sin());
    let balance = run.balance();
    println!("twice: {error:.1e} m, {:.1e} J, {:.1e}", balance.defect, balance.phi);
    assert!(error < 1e-7 && balance.defect.abs() < 1e-6 && balance.phi < 1e-13);
}

#[test]
fn single_precision_keeps_what_it_can() {
    let belt: Belt = Belt::default();
    let mut run = Simulation::start_from_text(belt, radau(), 0.0).expect("it starts");
    run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(3.0).expect("it moves");
    let single: Belt<f32> = Belt::default();
    let mut rough = Simulation::start_from_text(single, radau(), 0.0_f32).expect("it starts");
    rough = rough.with_tolerance(Tolerance::new(1e-5));
    rough.advance_to(3.0).expect("it moves");
    let error = (f64::from(rough.q()[0]) - run.q()[0]).abs();
    println!("f32: {error:.1e} m");
    assert!(error < 1e-4, "{error:e}");
}

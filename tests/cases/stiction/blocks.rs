//! Several frictions that stick: blocks on each other, brakes that share a force, a chain of blocks.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance};
use mbs_runtime::mechanism;

mechanism! {
    /// A block on a block on the ground, the lower one pulled by a rising force.
    pub mechanism Stack;
    coord x: m = 0;
    coord y: m = 0;
    body lower { mass: 2kg, com: [x, 0] }
    body upper { mass: 1kg, com: [y, 1m] }
    friction ground { along: x, normal: 3*9.81N, coefficient: 0.1, sticks: 0.2 }
    friction top { along: y - x, normal: 9.81N, coefficient: 0.3, sticks: 0.4 }
    force pull: 4 [N/s]*t on x;
    out forces: [N; 2] = [force(ground), force(top)];
}

const G: f64 = 9.81;

/// Places of both blocks at 5 s, by the three phases.
fn stacked(until: f64) -> [f64; 2] {
    // At rest until the pull has the limit of the ground, then together.
    let first = 0.2 * 3.0 * G / 4.0;
    let together = |t: f64| (4.0 * t - 0.1 * 3.0 * G) / 3.0;
    // The upper one sticks up to 0.4 g.
    let second = (3.0 * 0.4 * G + 0.1 * 3.0 * G) / 4.0;
    assert!(together(first) < 0.4 * G && first < second && second < until);
    let integral = |rate: f64, constant: f64, from: f64, to: f64| {
        let h = to - from;
        let start = rate * from + constant;
        [start * h + rate * h * h / 2.0, start * h * h / 2.0 + rate * h * h * h / 6.0]
    };
    let [v, s] = integral(4.0 / 3.0, -0.1 * G, first, second);
    let h = until - second;
    let lower = integral(2.0, (-0.1 * 3.0 * G - 0.3 * G) / 2.0, second, until);
    let upper = integral(0.0, 0.3 * G, second, until);
    [s + v * h + lower[1], s + v * h + upper[1]]
}

#[test]
fn blocks_on_each_other_move_as_the_closed_form() {
    let exact = stacked(5.0);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Stack::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(1.0).expect("it rests");
    assert!(run.q().iter().chain(run.qd()).all(|x| x.abs() < 1e-20), "{:?}", run.instant());
    assert!((run.loads()[0] + 4.0).abs() < 1e-12 && run.loads()[1].abs() < 1e-12, "{:?}", run.loads());
    run.advance_to(5.0).expect("it moves");
    for (found, exact) in run.q().iter().zip(exact) {
        assert!((found - exact).abs() < 1e-10, "{:?} {exact}", run.instant());
    }
    let mut run = Simulation::start_from_text(
        Stack::default(),
        Explicit::new(RungeKutta4, Projection::default()),
        0.0_f64,
    )
    .expect("it starts");
    run.step_to(5.0, 23).expect("it moves");
    for (found, exact) in run.q().iter().zip(exact) {
        assert!((found - exact).abs() < 1e-11, "{:?} {exact}", run.instant());
    }
    let mut run = Simulation::start_from_text(
        Stack::<f32>::default(),
        Explicit::new(RungeKutta4, Projection::default()),
        0.0,
    )
    .expect("it starts");
    run.step_to(5.0, 23).expect("it moves");
    for (found, exact) in run.q().iter().zip(exact) {
        assert!((f64::from(*found) - exact).abs() < 3e-5, "{:?} {exact}", run.instant());
    }
}

mechanism! {
    /// Six blocks in a row, joined by springs: let go stretched, they slide, stick, and come to rest one by one.
    pub mechanism Chain;
    coord x: [m; 6] = [0, 0.9, 2.3, 3.1, 4.6, 5.4];
    for i in 0..6 {
        body block { mass: 1kg, com: [x[i], 0] }
        friction rub { along: x[i], normal: 9.81N, coefficient: 0.1, sticks: 0.2 }
    }
    for i in 0..5 { tsda spring { from: [x[i], 0], to: [x[i + 1], 0], stiffness: 30, length: 1 } }
}

#[test]
fn energy_never_rises_and_ends_at_rest() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Chain::default(), method, 0.0_f64).expect("it starts");
    let energy = |run: &Simulation<Chain<f64>, _, f64, 6, 0>| {
        let energy = run.balance().energy;
        energy.kinetic + energy.potential
    };
    let mut before = energy(&run);
    for _ in 0..500 {
        run.step(0.01).expect("it moves");
        let now = energy(&run);
        assert!(now <= before + 1e-14, "{before} {now} at {}", run.t());
        before = now;
    }
    assert!(run.qd().iter().all(|speed| *speed == 0.0 || speed.abs() < 1e-25), "{:?}", run.qd());
    let method = Explicit::new(DormandPrince8, Projection::default());
    let adaptive = Simulation::start_from_text(Chain::default(), method, 0.0_f64).expect("it starts");
    let mut adaptive = adaptive.with_tolerance(Tolerance::new(1e-12));
    adaptive.advance_to(5.0).expect("it moves");
    for (fixed, exact) in run.q().iter().zip(adaptive.q()) {
        assert!((fixed - exact).abs() < 1e-5, "{:?} {:?}", run.q(), adaptive.q());
    }
    assert!(adaptive.balance().defect.abs() < 1e-9);
}

//! Dry friction against the same law integrated by hand, and against Coulomb's law without smoothing.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince8, Explicit, Penalty, Projection, RungeKutta4, Simulation, Tolerance,
};
use mbs_runtime::{Dynamic, Failure, Mechanism, mechanism};

/// Free fall (m/s²).
const G: f64 = 9.81;

mechanism! {
    /// A block on a moving belt, held by a spring.
    pub mechanism Belt;
    param m: kg = 1;
    param k: N/m = 100;
    param mu: 1 = 0.3;
    /// Speed of the belt, and that below which friction is smooth.
    param v: m/s = 0.2;
    param smooth: m/s = 1e-3;
    coord x: m = 0;
    body block { mass: m, com: [x, 0] }
    tsda spring { from: [-1m, 0], to: [x, 0], stiffness: k, length: 1 }
    friction belt { along: x - v*t, normal: m*9.81 [m/s^2], coefficient: mu, speed: smooth }
    start x = 0 rate v;
}

/// Place and speed of the block on the belt after `t` (s), by RK4 with steps of a hundredth of a millisecond.
fn on_the_belt(belt: &Belt, t: f64) -> [f64; 2] {
    let h = 1e-5;
    let rates = |[x, v]: [f64; 2]| {
        [v, (-belt.k * x - belt.mu * belt.m * G * ((v - belt.v) / belt.smooth).tanh()) / belt.m]
    };
    let mut y = [0.0, belt.v];
    for _ in 0..(t / h).round() as u32 {
        let moved = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let first = rates(y);
        let second = rates(moved(first, 0.5));
        let third = rates(moved(second, 0.5));
        let fourth = rates(moved(third, 1.0));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    y
}

#[test]
fn a_block_on_a_belt_sticks_then_slides_as_the_law_says() {
    /// The integrator's tolerance, met by all steps together.
    const EXACT: f64 = 1e-9;
    let belt: Belt = Belt::default();
    let run = Simulation::start_from_text(belt, Explicit::new(DormandPrince8, Projection::default()), 0.0);
    let mut run = run.expect("it starts").with_tolerance(Tolerance::new(1e-11));
    let frequency = (belt.k / belt.m).sqrt();
    // Displacement that friction can hold, and the time at which the belt has carried the block there.
    let held = belt.mu * belt.m * G / belt.k;
    let slips = held / belt.v;
    let (mut error, mut apart) = (0.0_f64, 0.0_f64);
    for tenth in 1..=30_u32 {
        let t = f64::from(tenth) / 10.0;
        run.advance_to(t).expect("it moves");
        let [x, v] = on_the_belt(&belt, t);
        error = error.max((run.q()[0] - x).abs()).max((run.qd()[0] - v).abs());
        let unsmoothed = match t - slips {
            late if late < 0.0 => belt.v * t,
            late => held + belt.v / frequency * (frequency * late).sin(),
        };
        apart = apart.max((run.q()[0] - unsmoothed).abs());
    }
    let defect = run.balance().defect;
    println!(
        "friction, belt: {error:.1e} m, m/s of {EXACT:e} beside the same law, {apart:.1e} m from Coulomb's, energy {defect:.1e} J"
    );
    assert!(error < EXACT && defect.abs() < EXACT, "{error:e} {defect:e}");
    // Smoothing lets the block creep: a thousandth of a metre a second for as long as it sticks.
    assert!((1e-6..5.0 * belt.smooth * slips).contains(&apart), "{apart:e}");
}

mechanism! {
    /// A block on an incline, by its way: the normal force is that of its weight and of a push.
    pub mechanism Slope;
    param m: kg = 2;
    param alpha: rad = 30deg;
    param mu: 1 = 0.4;
    param smooth: m/s = 1e-3;
    param push: N = 0;
    param viscous: N*s/m = 0;
    coord s: m = 0;
    body block { mass: m, com: -s*unit(alpha) }
    gravity weight { acceleration: [0, -9.81] }
    friction ground {
        along: s, normal: m*9.81 [m/s^2]*cos(alpha) + push*(1 + sin(7*t/1s)), coefficient: mu, speed: smooth, viscous: viscous
    }
    start s = 0 rate 0;
}

mechanism! {
    /// The same block in two coordinates: the row of the ground has the normal force as its multiplier.
    pub mechanism Grounded;
    param m: kg = 2;
    param alpha: rad = 30deg;
    param mu: 1 = 0.4;
    param smooth: m/s = 1e-3;
    param push: N = 0;
    param viscous: N*s/m = 0;
    coord P: [m; 2] = [0, 0];
    let across = unit(alpha + 90deg);
    body block { mass: m, com: P }
    gravity weight { acceleration: [0, -9.81] }
    force press: -push*(1 + sin(7*t/1s))*across on P;
    constraint ground { dot(P, across) == 0m; }
    friction rubbing {
        along: -dot(P, unit(alpha)), normal: lambda(ground), coefficient: mu, speed: smooth, viscous: viscous
    }
    start P = [0, 0] rate [0, 0];
}

fn explicit() -> Explicit<DormandPrince8, Projection> {
    Explicit::new(DormandPrince8, Projection::default())
}

#[test]
fn a_steep_block_slides_with_what_friction_leaves_of_its_weight_and_a_flat_one_creeps() {
    let slope: Slope = Slope { smooth: 1e-4, ..Slope::default() };
    let mut run = Simulation::start_from_text(slope, explicit(), 0.0).expect("it starts");
    run.advance_to(1.0).expect("it slides");
    let acceleration = G * (slope.alpha.sin() - slope.mu * slope.alpha.cos());
    // Less friction up to a few times the speed of smoothing: so much faster.
    let ahead = run.qd()[0] - acceleration;
    println!(
        "friction, incline: {:.1e} m/s² from g (sin − μ cos), {ahead:.1e} m/s ahead",
        run.qdd()[0] - acceleration
    );
    assert!((run.qdd()[0] - acceleration).abs() < 1e-12 && (0.0..5.0 * slope.smooth).contains(&ahead));
    assert!(run.balance().work < 0.0 && run.balance().defect.abs() < 1e-8);
    // Less steep than friction holds: tanh(ṡ/v₀) = tan α/μ.
    let flat: Slope = Slope { alpha: 0.2, ..Slope::default() };
    let mut run = Simulation::start_from_text(flat, explicit(), 0.0).expect("it starts");
    run.advance_to(1.0).expect("it creeps");
    let creep = flat.smooth * (flat.alpha.tan() / flat.mu).atanh();
    println!("friction, flat: creeps at {:e} m/s, {:.1e} beside the law", run.qd()[0], run.qd()[0] - creep);
    assert!((run.qd()[0] - creep).abs() < 1e-9 && run.q()[0] < flat.smooth);
}

/// Way and speed along the incline, and the normal force, at every tenth of a second.
fn grounded<X: mbs_runtime::dynamics::Method<Grounded, f64, 2, 1>>(
    block: Grounded,
    method: X,
    steps: u32,
) -> Result<Vec<[f64; 3]>, Failure> {
    let mut run = Simulation::start_from_text(block, method, 0.0)?;
    let along = |[x, y]: [f64; 2]| -(x * block.alpha.cos() + y * block.alpha.sin());
    let mut found = Vec::new();
    for tenth in 1..=10_u32 {
        run.step_to(f64::from(tenth) / 10.0, steps)?;
        let position = block.position(&block.parameters(), run.q(), run.t());
        let powers = block.powers(&block.parameters(), &position, run.qd(), &[], run.lambda());
        let names = Grounded::<f64>::FORCES.iter().map(|entry| entry.name);
        let (rubbing, _) = powers.iter().zip(names).find(|(_, name)| *name == "rubbing").expect("its name");
        assert!(*rubbing <= 0.0, "friction supplies {rubbing} W");
        // The row's force on the block is −λ across the ground.
        found.push([along(*run.q()), along(*run.qd()), -run.lambda()[0]]);
    }
    Ok(found)
}

#[test]
fn friction_with_a_multiplier_is_friction_with_the_force_it_stands_for() {
    /// Error of RK4 with steps of a tenth of a millisecond (m, m/s, N).
    const EXACT: f64 = 1e-10;
    for viscous in [0.0, 3.0] {
        let slope: Slope = Slope { push: 4.0, viscous, smooth: 0.05, ..Slope::default() };
        let block: Grounded = Grounded { push: 4.0, viscous, smooth: 0.05, ..Grounded::default() };
        let mut run = Simulation::start_from_text(slope, explicit(), 0.0).expect("it starts");
        run = run.with_tolerance(Tolerance::new(1e-12));
        let mut known = Vec::new();
        for tenth in 1..=10_u32 {
            run.advance_to(f64::from(tenth) / 10.0).expect("it slides");
            let normal = 2.0 * G * slope.alpha.cos() + 4.0 * (1.0 + (7.0 * run.t()).sin());
            known.push([run.q()[0], run.qd()[0], normal]);
        }
        // Of way and speed, and of the normal force.
        let errors = |found: Vec<[f64; 3]>| {
            let mut worst = [0.0_f64; 2];
            for (found, known) in found.iter().zip(&known) {
                for (i, (found, known)) in found.iter().zip(known).enumerate() {
                    worst[i / 2] = worst[i / 2].max((found - known).abs());
                }
            }
            worst
        };
        let projected = Explicit::new(RungeKutta4, Projection::default());
        let projected = errors(grounded(block, projected, 1000).expect("it slides"));
        // Of order 2, for coarse steps: at small ones its penalty, 4e4 m/h², times the rounding of the row moves the normal force.
        let lagrangian = errors(grounded(block, AugmentedLagrangian, 100).expect("it slides"));
        let penalty = Explicit::new(RungeKutta4, Penalty::default());
        let penalty = errors(grounded(block, penalty, 1000).expect("it slides"));
        println!(
            "friction, multiplier as N: {projected:?} of {EXACT:e}, implicit {lagrangian:?}, penalty {penalty:?}"
        );
        assert!(projected.iter().all(|error| *error < EXACT), "{projected:?}");
        assert!(lagrangian.iter().all(|error| *error < 1e-4), "{lagrangian:?}");
        // A penalty of 1e7 is a ground that gives way by as much.
        assert!(penalty.iter().all(|error| *error < 1e-6), "{penalty:?}");
    }
}

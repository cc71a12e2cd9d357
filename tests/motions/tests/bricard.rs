//! Bricard's mechanism: a threefold-symmetric loop of one degree of freedom, with two angles for six joints.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, MethodWarning, ProjectedStages, Projection, RungeKutta4, Simulation, Tolerance,
    equilibrium,
};
use mbs_runtime::{Dynamic, Mechanism};
use mechanisms::bricard::Bricard;

type Vector = [f64; 3];

fn cross([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + k b.
fn plus(a: Vector, k: f64, b: Vector) -> Vector {
    core::array::from_fn(|i| a[i] + k * b[i])
}

/// Axes of a body: the images of x, y and z.
type Axes = [Vector; 3];

/// The body's own vector in the ground.
fn seen(axes: Axes, [x, y, z]: Vector) -> Vector {
    plus(plus(plus([0.0; 3], x, axes[0]), y, axes[1]), z, axes[2])
}

/// Axes turned by `angle` about their own axis `about`.
fn turned(axes: Axes, about: usize, angle: f64) -> Axes {
    let (sine, cosine) = angle.sin_cos();
    let (next, last) = ((about + 1) % 3, (about + 2) % 3);
    let mut found = axes;
    found[next] = plus(plus([0.0; 3], cosine, axes[next]), sine, axes[last]);
    found[last] = plus(plus([0.0; 3], cosine, axes[last]), -sine, axes[next]);
    found
}

/// The last point of the open chain of five rods from P1, with the energy (J). Its joints turn alternately by a and b, at their
/// rates.
fn chain([a, b]: [f64; 2], [a_d, b_d]: [f64; 2]) -> (Vector, f64) {
    /// Axis of the joint before each rod, and the rod at the start.
    const RODS: [(usize, Vector); 5] = [
        (1, [1.0, 0.0, 0.0]),
        (2, [0.0, -1.0, 0.0]),
        (0, [0.0, 0.0, 1.0]),
        (1, [-1.0, 0.0, 0.0]),
        (2, [0.0, 1.0, 0.0]),
    ];
    let (thin, long) = (0.01 / 6.0, 1.01 / 12.0);
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let (mut point, mut velocity, mut spin, mut energy) = ([0.0; 3], [0.0; 3], [0.0; 3], 0.0);
    for (index, (about, rod)) in RODS.into_iter().enumerate() {
        let (angle, rate) = if index % 2 == 0 { (a, a_d) } else { (b, b_d) };
        spin = plus(spin, rate, axes[about]);
        axes = turned(axes, about, angle);
        let rod = seen(axes, rod);
        let along = cross(spin, rod);
        let middle = plus(velocity, 0.5, along);
        let turning = long * dot(spin, spin) + (thin - long) * dot(spin, rod).powi(2);
        energy += 0.5 * dot(middle, middle) + 0.5 * turning + 9.81 * plus(point, 0.5, rod)[1];
        point = plus(point, 1.0, rod);
        velocity = plus(velocity, 1.0, along);
    }
    (point, energy)
}

#[test]
fn bricards_loop_moves_as_one_degree_of_freedom_with_two_angles() {
    /// Distance of the loop's ends (m), error of the angles' relation, energy over the largest weight's, angle a step (rad).
    const EXACT: f64 = 1e-9;
    const STEP: f64 = 0.01;
    let method = Explicit::new(DormandPrince8, Projection { stages: ProjectedStages::All });
    let run = Simulation::start_from_text(Bricard::<f64>::default(), method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    let mut worst = [0.0_f64; 4];
    let mut before = (0.0, 0.0, run.qdd()[0]);
    let (start, mut swing) = (chain([0.0; 2], [0.0; 2]).1, 0.0_f64);
    for step in 1..=1000_u32 {
        run.advance_to(STEP * f64::from(step)).expect("it moves");
        // The last rod turns against the last joint of the chain.
        let ([a, b], [a_d, b_d]) = ([run.q()[0], -run.q()[1]], [run.qd()[0], -run.qd()[1]]);
        let (end, energy) = chain([a, b], [a_d, b_d]);
        // Chen, You & Tarnai 2005: of right angles between the axes this is left of the closure.
        let relation = a.sin() + b.sin() + a.sin() * b.sin();
        let slope = a_d * a.cos() * (1.0 + b.sin()) + b_d * b.cos() * (1.0 + a.sin());
        // Rates are those of the angle: Hermite's rule.
        let now = (a, a_d, run.qdd()[0]);
        let passed = STEP / 2.0 * (before.1 + now.1) + STEP * STEP / 12.0 * (before.2 - now.2);
        let found = [
            plus(end, -1.0, [0.0, 0.0, 1.0]).into_iter().fold(0.0, |most: f64, x| most.max(x.abs())),
            relation.abs().max(slope.abs()),
            (energy - start).abs() / 9.81,
            (now.0 - before.0 - passed).abs(),
        ];
        worst.iter_mut().zip(found).for_each(|(worst, found)| *worst = worst.max(found));
        swing = swing.max(a.abs());
        before = now;
    }
    let [ends, relation, energy, rate] = worst;
    println!(
        "bricard, by two angles: ends {ends:.1e}, relation {relation:.1e}, energy {energy:.1e}, rate {rate:.1e} of {EXACT:e}; swings to \
         {swing:.3} rad"
    );
    assert!(worst.iter().all(|worst| *worst < EXACT) && swing > 0.5, "{worst:?}, {swing}");
}

/// Bricard's mechanism from rest, by RK4 in steps of `h` (s), its stages as `projection` has them.
fn in_equal_steps(
    projection: Projection,
    h: f64,
) -> Simulation<Bricard, Explicit<RungeKutta4, Projection>, f64, 23, 23> {
    let method = Explicit::new(RungeKutta4, projection);
    let mut run = Simulation::start_from_text(Bricard::<f64>::default(), method, 0.0).expect("it starts");
    run.step_to(2.0, (2.0 / h).round() as u32).expect("it moves");
    run
}

#[test]
fn by_default_rk4_keeps_its_order_where_rows_follow_from_others_on_the_constraints_alone() {
    /// Ratio of the energy defects at twice the step and at the step: 2⁴ and a contribution of the terms of order 5 and 6.
    const RATIOS: std::ops::Range<f64> = 12.0..50.0;
    let runs = [0.04, 0.02, 0.01].map(|h| in_equal_steps(Projection::default(), h));
    let defects = runs.map(|run| run.balance().defect.abs());
    println!("bricard, RK4 by default in 50, 100, 200 steps: energy {defects:?} J");
    assert!(defects.windows(2).all(|pair| RATIOS.contains(&(pair[0] / pair[1]))), "{defects:?}");
    let [.., fine] = runs;
    assert_eq!((fine.doubt(0.01), fine.passage()), (None, None));
    assert_eq!(fine.counts().projected_stages, fine.counts().evaluations);
}

#[test]
fn stages_left_beside_the_constraints_are_doubtful_where_the_rank_rises_there() {
    let run = in_equal_steps(Projection { stages: ProjectedStages::None }, 1e-3);
    assert_eq!(run.doubt(1e-3), Some(MethodWarning::RisingRank));
    println!("bricard, RK4 with stages beside the constraints: energy {:.2} J", run.balance().defect);
    assert!(run.balance().defect.abs() > 0.1);
}

#[test]
fn by_default_order_eight_takes_steps_as_long_as_with_all_stages_projected() {
    let counts = [Projection::default(), Projection { stages: ProjectedStages::All }].map(|projection| {
        let method = Explicit::new(DormandPrince8, projection);
        let mut run = Simulation::start_from_text(Bricard::<f64>::default(), method, 0.0).expect("it starts");
        run.advance_to(2.0).expect("it moves");
        assert!(run.balance().defect.abs() < 1e-8, "{:?}", run.balance());
        run.counts()
    });
    println!("bricard, 2 s by order 8: {} evaluations", counts[0].evaluations);
    assert_eq!(counts[0], counts[1]);
    assert!(counts[0].evaluations < 1000);
}

#[test]
fn at_rest_the_joints_share_the_weight_by_the_shortest_multipliers() {
    let bricard: Bricard = Bricard::default();
    let guess = bricard.guess(&bricard.parameters());
    let rest = equilibrium(&bricard, 0.0, &guess).expect("it rests");
    // Five rods of 1 kg: no joint carries more than a few times their weight.
    let largest = rest.lambda.iter().fold(0.0_f64, |largest, lambda| largest.max(lambda.abs()));
    println!("bricard at rest: largest multiplier {largest:.3}");
    assert!(largest > 1.0 && largest < 200.0, "{:?}", rest.lambda);
    let parameters = bricard.parameters();
    let position = bricard.position(&parameters, &rest.q, 0.0);
    let force = bricard.force(&parameters, &position, &[0.0; 23], &[], &rest.lambda);
    let reaction = bricard.reaction(&parameters, &position, &rest.lambda);
    for (force, reaction) in force.iter().zip(reaction) {
        assert!((force - reaction).abs() < 1e-8, "{force} {reaction}");
    }
}

#[test]
fn in_single_precision_the_same_row_follows_from_the_others() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let single = Simulation::start_from_text(Bricard::<f32>::default(), method, 0.0);
    let double = Simulation::start_from_text(Bricard::<f64>::default(), method, 0.0);
    let (mut single, mut double) = (single.expect("it starts"), double.expect("it starts"));
    for step in 1..=20_u32 {
        let found = single.determinacy().expect("finite rows");
        let known = double.determinacy().expect("finite rows");
        assert_eq!((found.rank, known.rank), (22, 22));
        assert_eq!(found.dependent, known.dependent);
        single.step_to(0.05 * step as f32, 10).expect("it moves");
        double.step_to(0.05 * f64::from(step), 10).expect("it moves");
    }
    // Single precision: seven digits, of which a second of integration takes two.
    let off = single.q().iter().zip(double.q()).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
    println!("bricard in single precision: {off:.1e} of 1e-4 after 1 s, {:.1e} J", single.balance().defect);
    assert!(off < 1e-4, "{off:e}");
}

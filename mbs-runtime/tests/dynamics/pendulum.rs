//! The point pendulum in x and y, from the horizontal: every method against the exact motion.

use mbs_runtime::dynamics::{
    Baumgarte, Direction, DormandPrince5, DormandPrince8, Embedded, Explicit, FixedStep, Formulation, Method,
    MethodWarning, ProjectedStages, Projection, RungeKutta4, SemiImplicitEuler, Simulation, Tolerance,
    Unstabilized,
};
use mbs_runtime::{Failure, FailureKind};

use crate::linkage::{Linkage, pendulum};

/// Position and velocity at 10 s, released from x = −1, y = 0 with g = 9.81: to all digits printed, by elliptic functions
/// and by an integrator of high order.
const AT_TEN: [f64; 4] = [-0.2750874625761169, -0.961419205099125, 4.175598100951729, -1.1947490545604753];

/// Time of a full swing (s), by the same.
const PERIOD: f64 = 2.3678419475762373;

type Pendulum<X> = Simulation<Linkage<2, 1>, X, f64, 2, 1>;

fn released<X: Method<Linkage<2, 1>, f64, 2, 1>>(method: X) -> Pendulum<X> {
    Simulation::start(pendulum(), method, 0.0, [-1.0, 0.0], [0.0, 0.0]).unwrap()
}

fn error<X: Method<Linkage<2, 1>, f64, 2, 1>>(simulation: &Pendulum<X>) -> f64 {
    let ([x, y], [u, v]) = (simulation.q(), simulation.qd());
    [x, y, u, v].iter().zip(AT_TEN).map(|(found, exact)| (*found - exact).abs()).fold(0.0, f64::max)
}

/// Ten seconds in `steps` equal steps.
fn stepped<I: FixedStep, F: Formulation<Linkage<2, 1>, f64, 2, 1>>(
    method: Explicit<I, F>,
    steps: u32,
) -> Pendulum<Explicit<I, F>> {
    let mut simulation = released(method);
    simulation.step_to(10.0, steps).unwrap();
    simulation
}

#[test]
fn ten_seconds_are_right_to_ten_digits_with_either_pair() {
    let mut eighth =
        released(Explicit::new(DormandPrince8, Projection::default())).with_tolerance(Tolerance::new(1e-12));
    eighth.advance_to(10.0).unwrap();
    assert!(error(&eighth) < 1e-9, "{:e} {:?}", error(&eighth), eighth.counts());
    let balance = eighth.balance();
    assert!(balance.defect.abs() < 1e-10 && balance.phi < 1e-13 && balance.phi_d < 1e-12, "{balance:?}");
    let mut fifth =
        released(Explicit::new(DormandPrince5, Projection::default())).with_tolerance(Tolerance::new(1e-12));
    fifth.advance_to(10.0).unwrap();
    assert!(error(&fifth) < 1e-8, "{:e}", error(&fifth));
    assert!(2 * eighth.counts().evaluations < fifth.counts().evaluations);
}

#[test]
fn projected_methods_keep_their_order() {
    let order = |coarse: f64, fine: f64| (coarse / fine).log2();
    let projected = Projection::default();
    let first = |steps| error(&stepped(Explicit::new(SemiImplicitEuler, projected), steps));
    let fourth = |steps| error(&stepped(Explicit::new(RungeKutta4, projected), steps));
    let fifth = |steps| error(&stepped(Explicit::new(DormandPrince5, projected), steps));
    let eighth = |steps| error(&stepped(Explicit::new(DormandPrince8, projected), steps));
    assert!((order(first(20_000), first(40_000)) - 1.0).abs() < 0.1);
    assert!(order(fourth(8000), fourth(16_000)) > 3.8, "{:e} {:e}", fourth(8000), fourth(16_000));
    assert!(order(fifth(800), fifth(1600)) > 4.8);
    assert!(order(eighth(150), eighth(300)) > 7.5, "{:e} {:e}", eighth(150), eighth(300));
}

#[test]
fn stages_on_the_constraints_give_the_same_motion() {
    let method = Explicit::new(RungeKutta4, Projection { stages: ProjectedStages::All });
    let simulation = stepped(method, 4000);
    assert!(error(&simulation) < 2e-8, "{:e}", error(&simulation));
    assert!(simulation.counts().projected_stages >= 16_000);
}

#[test]
fn drift_is_removed_by_projection_bounded_by_baumgarte_and_left_by_neither() {
    let phi = |balance: mbs_runtime::dynamics::Balance<f64>| balance.phi;
    let none = stepped(Explicit::new(RungeKutta4, Unstabilized), 4000);
    let baumgarte = stepped(Explicit::new(RungeKutta4, Baumgarte::default()), 4000);
    let projection = stepped(Explicit::new(RungeKutta4, Projection::default()), 4000);
    assert!(
        phi(none.balance()) > 1e-7 && phi(baumgarte.balance()) < 1e-8 && phi(projection.balance()) < 1e-14
    );
    assert!(error(&projection) < error(&baumgarte) && error(&baumgarte) < error(&none));
}

#[test]
fn baumgarte_warns_of_long_steps_and_short_runs_and_refuses_unstable_ones() {
    let mut simulation = released(Explicit::new(RungeKutta4, Baumgarte::default()));
    simulation.step(0.02).unwrap();
    assert_eq!(simulation.doubt(0.02), Some(MethodWarning::IdleStabilization));
    simulation.step_to(1.0, 49).unwrap();
    assert_eq!(simulation.doubt(0.02), None);
    assert_eq!(simulation.doubt(0.04), Some(MethodWarning::StiffStabilization));
    let before = *simulation.instant();
    let failure = simulation.step(0.11).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::StepTooLong { allowed: 1.0, .. }, .. }),
        "{failure}"
    );
    assert_eq!(before, *simulation.instant());
}

#[test]
fn the_tension_of_the_rod_is_its_multiplier() {
    // Φ = d·d − L²: the force on the mass is −2 λ d, and λ = T/(2 L).
    let simulation = stepped(Explicit::new(RungeKutta4, Projection::default()), 8000);
    assert!((2.0 * simulation.lambda()[0] - 28.29456720606725).abs() < 1e-7, "{:?}", simulation.lambda());
}

#[test]
fn half_a_swing_ends_where_the_velocity_passes_zero() {
    let mut simulation =
        released(Explicit::new(DormandPrince8, Projection::default())).with_tolerance(Tolerance::new(1e-12));
    simulation.advance_to(0.1).unwrap();
    let found = simulation.advance_until_event(10.0, Direction::Any, |_, q, qd| q[0] * qd[1] - q[1] * qd[0]);
    assert_eq!(found, Ok(true));
    assert!((simulation.t() - PERIOD / 2.0).abs() < 1e-9, "{}", simulation.t());
    assert!(simulation.balance().phi < 1e-13);
}

#[test]
fn samples_between_steps_are_as_good_as_steps() {
    let mut simulation =
        released(Explicit::new(DormandPrince8, Projection::default())).with_tolerance(Tolerance::new(1e-11));
    let mut energies = Vec::new();
    simulation
        .sample(10.0, 400, |instant| {
            let ([_, y], [u, v]) = (instant.y.q, instant.y.qd);
            energies.push((0.5 * (u * u + v * v) + 9.81 * y).abs());
        })
        .unwrap();
    assert_eq!(energies.len(), 400);
    assert!(
        energies.iter().all(|energy| *energy < 2e-9),
        "{:e}",
        energies.iter().copied().fold(0.0, f64::max)
    );
    assert!(simulation.counts().steps < 300 && simulation.t() == 10.0);
}

/// Largest error of positions and velocities, and of multipliers, at `instants` equal distances of ten seconds: those between the
/// steps of one run, and the ends of as many runs; with the one run.
fn shown<I: Embedded>(
    integrator: I,
    tolerance: f64,
    instants: u32,
) -> ([[f64; 2]; 2], Pendulum<Explicit<I, Projection>>) {
    let method = Explicit::new(integrator, Projection::default());
    let start = released(method).with_tolerance(Tolerance::new(tolerance));
    let mut exact = released(Explicit::new(DormandPrince8, Projection::default()));
    exact = exact.with_tolerance(Tolerance::new(1e-13));
    let (mut run, mut errors) = (start, [[0.0_f64; 2]; 2]);
    run.watch(10.0, instants, |run| {
        exact.advance_to(run.t()).unwrap();
        let mut ending = start;
        ending.advance_to(run.t()).unwrap();
        // The last instant is no other than the last step's end.
        let ends = usize::from(run.t() == 10.0);
        for (errors, found) in errors.iter_mut().zip([run, &ending]).skip(ends) {
            let state = found.q().iter().chain(found.qd()).zip(exact.q().iter().chain(exact.qd()));
            errors[0] = state.fold(errors[0], |largest, (found, exact)| largest.max((found - exact).abs()));
            errors[1] = errors[1].max((found.lambda()[0] - exact.lambda()[0]).abs());
            assert!(found.balance().phi < 1e-13 && found.balance().phi_d < 1e-12);
        }
    })
    .unwrap();
    (errors, run)
}

/// The force of the rod is largest at the lowest point, 3 m g: parts of steps find it, and the run keeps its bits.
#[test]
fn parts_of_steps_find_the_largest_force_of_the_rod() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = released(method).with_tolerance(Tolerance::new(1e-9));
    let (mut run, mut alone) = (start, start);
    let (mut most, mut instants, mut last) = (0.0_f64, 0_u64, 0.0);
    run.watch_steps(PERIOD, 16, |run| {
        assert!(last < run.t());
        (most, instants, last) = (most.max(run.lambda()[0].abs()), instants + 1, run.t());
    })
    .unwrap();
    alone.advance_to(PERIOD).unwrap();
    // The row x² + y² = 1 has twice the rod's direction for a gradient.
    let low = 1.0 - 2.0 * most / (3.0 * 9.81);
    println!("largest force of the rod in {instants} parts: low by {low:.1e} of 1e-3");
    assert!((-1e-7..1e-3).contains(&low), "{low:e}");
    assert_eq!((last, instants), (PERIOD, 16 * run.counts().steps));
    assert_eq!((run.q(), run.qd()), (alone.q(), alone.qd()));
    assert_eq!(run.counts().evaluations, alone.counts().evaluations);
    // A run that does not move is shown once.
    let mut seen = 0;
    run.watch_steps(PERIOD, 16, |_| seen += 1).unwrap();
    assert_eq!(seen, 1);
}

#[test]
fn instants_between_steps_are_as_right_as_the_run() {
    /// Of the largest error of the run: what the instants looked at miss of it.
    const SHARE: f64 = 1.1;
    for tolerance in [1e-5, 1e-8, 1e-11] {
        let runs = [shown(DormandPrince8, tolerance, 41).0, shown(DormandPrince5, tolerance, 41).0];
        println!("tolerance {tolerance:e}, orders 8 and 5, between steps and at their ends: {runs:?}");
        for [between, ends] in runs {
            assert!(between.iter().zip(ends).all(|(between, end)| *between < SHARE * end));
        }
    }
}

#[test]
fn a_run_that_is_watched_takes_the_steps_of_one_that_is_not() {
    let (_, watched) = shown(DormandPrince8, 1e-9, 41);
    let mut alone = released(Explicit::new(DormandPrince8, Projection::default()));
    alone = alone.with_tolerance(Tolerance::new(1e-9));
    alone.advance_to(10.0).unwrap();
    assert_eq!(alone.instant(), watched.instant());
    let (counts, watched) = (alone.counts(), watched.counts());
    assert_eq!((counts.evaluations, counts.steps, counts.shown), (watched.evaluations, watched.steps, 0));
    assert!(watched.shown > 41);
    // A tolerance that is coarser costs less, however many instants are shown.
    let (_, coarse) = shown(DormandPrince8, 1e-4, 41);
    assert!(2 * coarse.counts().evaluations < counts.evaluations);
}

#[test]
fn a_pivot_that_moves_puts_its_work_into_the_balance() {
    let shaken = Linkage { shake: [0.2, 5.0], damping: 0.3, ..pendulum() };
    let qd = [0.2 * 5.0, 0.0];
    let mut simulation =
        Simulation::start(shaken, Explicit::new(DormandPrince8, Projection::default()), 0.0, [0.0, -1.0], qd)
            .unwrap()
            .with_tolerance(Tolerance::new(1e-11));
    simulation.advance_to(5.0).unwrap();
    let balance = simulation.balance();
    assert!(balance.work.abs() > 0.1 && balance.defect.abs() < 1e-8, "{balance:?}");
    assert!(balance.phi_d < 1e-12);
}

#[test]
fn two_runs_are_equal_to_the_last_bit() {
    let run = || {
        let mut simulation = released(Explicit::new(DormandPrince5, Projection::default()));
        simulation.advance_to(3.0).unwrap();
        *simulation.instant()
    };
    assert_eq!(run(), run());
}

#[test]
fn an_input_changed_between_steps_is_felt_by_the_next() {
    let mut simulation = Simulation::start(
        pendulum(),
        Explicit::new(RungeKutta4, Projection::default()),
        0.0,
        [0.0, -1.0],
        [0.0; 2],
    )
    .unwrap();
    simulation.step(1e-3).unwrap();
    assert_eq!(simulation.qd(), &[0.0, 0.0]);
    simulation.change(|pendulum| pendulum.push = 3.0);
    simulation.step(1e-3).unwrap();
    assert!((simulation.qd()[0] - 3e-3).abs() < 1e-6);
    assert!(simulation.balance().defect.abs() < 1e-12);
}

//! D15: largest mechanism of the stiff method, and motions that are not stiff but difficult otherwise.

use mbs_runtime::dynamics::{Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::{Failure, FailureKind, mechanism};

use crate::texts::{Governor, Oscillator};

fn radau() -> Explicit<Radau5, Projection> {
    Explicit::new(Radau5, Projection::default())
}

mechanism! {
    /// As many coordinates as the stiff method takes: falling bobs.
    pub mechanism Bobs;
    coord p: [m; 60, 2] = 0;
    for i in 0..60 { body bob { mass: 1, com: p[i] } }
    gravity weight { acceleration: [0, -9.81] }
}

#[test]
fn the_largest_mechanism_that_compiles_runs_on_four_megabytes_of_stack() {
    /// Bytes: the matrices of a step, and as much for the data that they are computed from. Without optimisation, which this package does
    /// not do for the crates that it stands on, matrices are copied on the way.
    const STACK: usize = if cfg!(debug_assertions) { 8 << 20 } else { 4 << 20 };
    let run = || {
        let mut run = Simulation::start_from_text(Bobs::default(), radau(), 0.0_f64).expect("it starts");
        run.advance_to(1.0).expect("they fall");
        run.q()[1]
    };
    let height = std::thread::Builder::new().stack_size(STACK).spawn(run).expect("a thread").join();
    let matrices = Radau5::stack::<Bobs, f64, 120, 0>();
    println!("stack of a stiff step of 120 coordinates: {matrices} B of {STACK} B");
    assert!((height.expect("it runs") + 0.5 * 9.81).abs() < 1e-8 && 2 * matrices < 4 << 20);
}

mechanism! {
    /// A parallelogram of points, whose rods come in line twice a turn.
    pub mechanism Parallelogram;
    coord A: [m; 2] = [0, 1];
    coord B: [m; 2] = [2, 1];
    body left { mass: 1, com: A }
    body right { mass: 1, com: B }
    gravity weight { acceleration: [0, -9.81] }
    constraint rods { dot(A, A) == 1 [m^2]; dot(B - [2m, 0], B - [2m, 0]) == 1 [m^2]; dot(B - A, B - A) == 4 [m^2]; }
    start A = [0, 1] rate [2, 0];
    start B = [2, 1] rate [2, 0];
}

#[test]
fn rods_that_come_in_line_are_passed_or_the_failure_is_typed() {
    for tolerance in [1e-6, 1e-8, 1e-10] {
        let run = Simulation::start_from_text(Parallelogram::default(), radau(), 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        let failure = run.advance_to(3.0).err();
        let (q, balance) = (run.q(), run.balance());
        let apart = (q[2] - q[0] - 2.0).hypot(q[3] - q[1]);
        println!(
            "in line, {tolerance:e}: {apart:.1e} m, {:.1e} J, t {}, {failure:?}",
            balance.defect,
            run.t()
        );
        // The rods stay parallel as far as the run goes.
        assert!(apart < 1e-3 && balance.defect.abs() < 1e3 * tolerance, "{tolerance:e}");
        let typed = matches!(
            failure,
            None | Some(
                Failure { kind: FailureKind::Undecided { .. }, .. }
                    | Failure { kind: FailureKind::StepTooSmall { .. }, .. }
                    | Failure { kind: FailureKind::EquilibriumNotConverged { .. }, .. }
            )
        );
        assert!(typed, "{failure:?}");
    }
}

#[test]
fn the_energy_of_stiff_dampers_is_accounted_for() {
    let run = Simulation::start_from_text(Governor::default(), radau(), 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-9));
    run.advance_to(1.0).expect("it moves");
    let balance = run.balance();
    println!("governor: {:.1e} J of {:.1e} J of work", balance.defect, balance.work);
    assert!(balance.defect.abs() < 1e-5 && balance.phi < 1e-12 && balance.phi_d < 1e-10);
}

#[test]
fn a_tolerance_that_is_not_resolved_is_refused_and_a_run_in_pieces_is_the_same() {
    let start = || Simulation::start_from_text(Oscillator::default(), radau(), 0.0_f64).expect("it starts");
    let refused = start().with_tolerance(Tolerance::new(1e-17)).advance_to(1.0);
    assert!(
        matches!(refused, Err(Failure { kind: FailureKind::UnresolvedTolerance { .. }, .. })),
        "{refused:?}"
    );
    let (mut whole, mut pieces) =
        (start().with_tolerance(Tolerance::new(1e-9)), start().with_tolerance(Tolerance::new(1e-9)));
    whole.advance_to(5.0).expect("it moves");
    for piece in 1..=100_u32 {
        pieces.advance_to(f64::from(piece) * 0.05).expect("it moves");
    }
    let apart = (whole.q()[0] - pieces.q()[0]).abs();
    println!("in pieces: {apart:.1e} m");
    assert!(apart < 1e-8, "{apart:e}");
}

mechanism! {
    /// Two masses with a stiff spring between them and a soft one to the ground.
    pub mechanism StiffAndSoft;
    param stiffness: N/m = 1e9;
    coord x: m = 0.1;
    coord y: m = 0.1;
    body one { mass: 1, com: [x, 0] }
    body other { mass: 1, com: [y, 0] }
    tsda soft { from: [-1, 0], to: [x, 0], stiffness: 10, length: 1 }
    tsda stiff { from: [x, 0], to: [y + 1m, 0], stiffness: stiffness, length: 1, damping: 2e4 }
    start x = 0.1 rate 0;
    start y = 0.1 rate 0;
}

#[test]
fn the_last_digit_of_a_stiff_spring_does_not_shorten_steps() {
    // With 1e10 N/m the last digit of a metre is 2e-6 N, and a tolerance of 1e-11 follows the vibration that this excites.
    for (stiffness, last) in [(1e8, 11), (1e9, 11), (1e10, 10)] {
        let mut before = f64::INFINITY;
        for decade in 6..=last {
            let tolerance = 10.0_f64.powi(-decade);
            let spring = StiffAndSoft { stiffness };
            let run = Simulation::start_from_text(spring, radau(), 0.0_f64).expect("it starts");
            let mut run = run.with_tolerance(Tolerance::new(tolerance));
            run.advance_to(1.0).expect("it moves");
            // Both masses as one, but for the stretch of the stiff spring.
            let apart = (run.q()[0] - 0.1 * 5.0_f64.sqrt().cos()).abs();
            let evaluations = run.counts().evaluations as f64;
            println!("{stiffness:e} N/m, {tolerance:e}: {evaluations} evaluations, {apart:.1e} m");
            assert!(apart < 100.0 * tolerance + 10.0 / stiffness, "{apart:e}");
            // Ten times better takes 10^(1/4) times the steps.
            assert!(evaluations < 3.0 * before, "{evaluations} after {before}");
            before = evaluations;
        }
    }
}

//! Failures of simulations name their cause, and the state stays.

use mbs_runtime::dynamics::{
    Baumgarte, DormandPrince5, DormandPrince8, Explicit, GeneralizedAlpha, Method, Metric, Penalty,
    Projection, RungeKutta4, Simulation, System, Tolerance,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

use crate::linkage::{End, Linkage, Rod, parallel_loops, pendulum};

type Pendulum = Simulation<Linkage<2, 1>, Explicit<RungeKutta4, Projection>, f64, 2, 1>;

fn start(q: [f64; 2], qd: [f64; 2]) -> Result<Pendulum, Failure> {
    Simulation::start(pendulum(), Explicit::default(), 0.0, q, qd)
}

#[test]
fn a_start_off_the_constraints_names_the_row_and_a_start_near_them_is_projected() {
    let failure = start([1.001, 0.0], [0.0, 0.0]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::OffConstraints { rate: false, .. }, .. }),
        "{failure}"
    );
    let failure = start([1.0, 0.0], [0.1, 0.0]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::OffConstraints { rate: true, .. }, .. }),
        "{failure}"
    );
    let near: Pendulum =
        Simulation::start_near(pendulum(), Explicit::default(), 0.0, [1.2, 0.0], [0.1, 2.0]).unwrap();
    assert!((near.q()[0] - 1.0).abs() < 1e-14 && near.qd()[0].abs() < 1e-14 && near.qd()[1] == 2.0);
}

#[test]
fn steps_that_lead_nowhere_are_refused_and_the_state_stays() {
    let mut simulation = start([1.0, 0.0], [0.0, 0.0]).unwrap();
    let before = *simulation.instant();
    for h in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let failure = simulation.step(h).unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::InvalidStep { .. }, .. }), "{failure}");
    }
    for until in [1.0, 0.0] {
        let failure = simulation.step_to(until, 0).unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::NoSteps { .. }, .. }), "{failure}");
        assert!(failure.to_string().contains("their number is 0"), "{failure}");
    }
    assert!(simulation.step(1e300).is_err());
    assert_eq!(before, *simulation.instant());
    let mut late: Pendulum =
        Simulation::start(pendulum(), Explicit::default(), 1e6, [1.0, 0.0], [0.0, 0.0]).unwrap();
    assert!(matches!(late.step(1e-12), Err(Failure { kind: FailureKind::InvalidStep { .. }, .. })));
}

#[test]
fn numbers_that_are_none_are_named() {
    for (q, qd) in [([f64::NAN, 0.0], [0.0; 2]), ([1.0, 0.0], [0.0, f64::INFINITY]), ([1e308, 0.0], [0.0; 2])]
    {
        let failure = start(q, qd).unwrap_err();
        assert!(
            matches!(
                failure,
                Failure { kind: FailureKind::NonFinite { name: "x", .. }, .. }
                    | Failure { kind: FailureKind::Unresolved { .. }, .. }
            ),
            "{failure}"
        );
    }
    let mut simulation = start([1.0, 0.0], [0.0, 0.0]).unwrap();
    let before = *simulation.instant();
    simulation.change(|pendulum| pendulum.push = f64::NAN);
    assert_eq!(simulation.step(1e-3), Err(FailureKind::NonFinite { name: "push", line: 5 }.without_time()));
    assert_eq!(before, *simulation.instant());
    simulation.change(|pendulum| pendulum.push = 0.0);
    simulation.step(1e-3).unwrap();
}

#[test]
fn a_failed_adaptive_run_leaves_the_state_bit_for_bit() {
    let mut simulation = Simulation::start(
        pendulum(),
        Explicit::new(DormandPrince8, Projection::default()),
        0.0,
        [1.0, 0.0],
        [0.0; 2],
    )
    .unwrap()
    .with_tolerance(Tolerance { relative: 0.0, absolute: 1e-30 });
    let before = *simulation.instant();
    let failure = simulation.advance_to(1.0).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::UnresolvedTolerance { .. }, .. }), "{failure}");
    assert_eq!(before, *simulation.instant());
}

/// Two rods in a row from the ground, masses at the joint and at the end.
fn chain(joint: f64, end: f64) -> Linkage<4, 2> {
    let rods = [
        Rod { from: End::Ground([0.0; 2]), to: End::Point(0), length: 1.0, mass: 0.0 },
        Rod { from: End::Point(0), to: End::Point(1), length: 1.0, mass: 0.0 },
    ];
    Linkage::new(rods, [joint, joint, end, end], [0.0, -9.81])
}

#[test]
fn a_massless_joint_is_carried_and_a_massless_end_is_named() {
    let run = |linkage| {
        let method: Explicit<RungeKutta4, Projection> = Explicit::default();
        Simulation::start(linkage, method, 0.0, [0.6, -0.8, 1.6, -0.8], [0.0; 4])
    };
    // Nothing but the end has mass: the joint goes where the rods' force lets it, and the rods pull in line.
    let failure = run(chain(1.0, 0.0)).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::SingularMass { .. }, .. }), "{failure}");
    assert!(run(chain(1.0, 1.0)).is_ok());
    let straight: Explicit<RungeKutta4, Projection> = Explicit::default();
    let light = Simulation::start(chain(0.0, 1.0), straight, 0.0, [0.6, -0.8, 1.2, -1.6], [0.0; 4]);
    // In line, a massless joint moves sideways without any mass moving.
    assert!(matches!(light.unwrap_err(), Failure { kind: FailureKind::SingularMass { .. }, .. }));
    let bent = run(chain(0.0, 1.0)).unwrap();
    assert!(bent.qdd().iter().all(|acceleration| acceleration.is_finite()));
}

#[test]
fn a_rod_without_length_is_named_whatever_integrates() {
    let rods = [
        Rod { from: End::Ground([0.0; 2]), to: End::Point(0), length: 1.0, mass: 0.0 },
        Rod { from: End::Point(0), to: End::Point(1), length: 0.0, mass: 0.0 },
    ];
    let chain = Linkage::new(rods, [1.0; 4], [0.0, -9.81]);
    // Both hanging aside, and level, where both begin to fall alike.
    for start in [[0.6, -0.8, 0.6, -0.8], [1.0, 0.0, 1.0, 0.0]] {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let failure = Simulation::start(chain, method, 0.0, start, [0.0; 4]).unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::VanishingGradient { .. }, .. }), "{failure}");
        let method: Explicit<RungeKutta4, Projection> = Explicit::default();
        let failure = Simulation::start(chain, method, 0.0, start, [0.0; 4]).unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::VanishingGradient { .. }, .. }), "{failure}");
    }
}

#[test]
fn a_rod_too_short_to_hold_is_named_where_a_run_fails() {
    let rods = [
        Rod { from: End::Ground([0.0; 2]), to: End::Point(0), length: 1.0, mass: 0.0 },
        Rod { from: End::Point(0), to: End::Point(1), length: 1e-9, mass: 0.0 },
    ];
    let chain = Linkage::new(rods, [1.0; 4], [0.0, -9.81]);
    let method: Explicit<RungeKutta4, Projection> = Explicit::default();
    let short = Simulation::start(chain, method, 0.0, [0.6, -0.8, 0.6, -0.8 - 1e-9], [0.0; 4]);
    let failure = short.and_then(|mut run| run.step_to(1.0, 100)).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::VanishingGradient { .. }, .. }), "{failure}");
}

#[test]
fn a_massless_joint_that_falls_into_line_is_named_where_the_run_ends() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    // The end falls freely until both rods are in line.
    let start = [0.6, -0.8, 1.2, 0.0];
    let mut light = Simulation::start(chain(0.0, 1.0), method, 0.0, start, [0.0; 4]).unwrap();
    let failure = light.advance_to(2.0).unwrap_err();
    let Failure { kind: FailureKind::SingularMass { .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    let fallen = (2.0 * (4.0_f64 - 1.44).sqrt() / 9.81).sqrt();
    assert!((time - fallen).abs() < 1e-6, "{time} {fallen}");
}

#[test]
fn a_row_twice_shares_its_multiplier_and_is_named() {
    let (linkage, q, _) = parallel_loops::<4, 4>(0.3, 1.0);
    use mbs_runtime::{Dynamic, Mechanism};
    let metric = Metric::of(&linkage, &());
    let position = linkage.position(&(), &q, 0.0);
    let system = System::new(&linkage.mass(&(), &position), &linkage.phi_q(&(), &position), &metric);
    let factors = system.factorize(Linkage::<4, 4>::COORDINATES, 0.0).unwrap();
    assert_eq!(factors.rank(), 3);
    assert_eq!(factors.unique_multipliers(), [false, true, true, false]);
    let dependent = factors.dependent_rows();
    assert!(dependent[0] != dependent[3] && !dependent[1] && !dependent[2]);
    let (_, lambda) = factors.solve(&linkage.force(&(), &position, &[0.0; 4], &[], &[0.0; 4]), &[0.0; 4]);
    assert!((lambda[0] - lambda[3]).abs() < 1e-12 && lambda[0].abs() > 0.1, "{lambda:?}");
}

#[test]
fn the_same_mechanism_in_millimetres_moves_the_same() {
    let run = |unit: f64| {
        let (linkage, q, qd) = parallel_loops::<6, 6>(0.0, 1.0);
        let linkage = linkage.in_unit(unit);
        let method: Explicit<RungeKutta4, Projection> = Explicit::default();
        let mut simulation =
            Simulation::start(linkage, method, 0.0, q.map(|q| q * unit), qd.map(|qd| qd * unit)).unwrap();
        simulation.step_to(2.0, 500).unwrap();
        simulation.q().map(|q| q / unit)
    };
    let (metres, millimetres) = (run(1.0), run(1000.0));
    for (a, b) in metres.iter().zip(millimetres) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_motion_that_is_lost_within_a_step_is_called_so_and_an_end_that_no_step_resolves_too() {
    let mut simulation = start([1.0, 0.0], [0.0, 1e5]).unwrap();
    let failure = simulation.step(100.0).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::Unbounded { .. }, .. }), "{failure}");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut adaptive = Simulation::start(pendulum(), method, 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
    let failure = adaptive.advance_to(1e300).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::OutOfReach { until: 1e300, .. }, .. }),
        "{failure}"
    );
}

#[test]
fn a_run_by_any_method_notices_the_first_singular_position_that_it_passes() {
    let (loops, q, qd) = parallel_loops::<6, 5>(0.0, 1.0);
    let method = Explicit::new(RungeKutta4, Baumgarte::default());
    let mut simulation = Simulation::start(loops, method, 0.0, q, qd).unwrap();
    simulation.step_to(0.5, 100).unwrap();
    assert_eq!(simulation.passage(), None);
    simulation.step_to(0.8, 60).unwrap();
    let fixed = simulation.passage().unwrap().t;
    let mut adaptive =
        Simulation::start(loops, Explicit::new(DormandPrince8, Projection::default()), 0.0, q, qd).unwrap();
    for instant in 1..=80 {
        adaptive.advance_to(f64::from(instant) / 100.0).unwrap();
    }
    let found = adaptive.passage().unwrap().t;
    assert!((fixed - 0.72).abs() < 0.02 && (found - 0.72).abs() < 0.02, "{fixed} {found}");
}

#[test]
fn a_tolerance_below_rounding_and_an_end_of_too_many_steps_are_refused_at_once() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = Simulation::start(pendulum(), method, 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
    let least: f64 = Tolerance::least();
    for tolerance in [1e-30, 0.4 * least] {
        let mut run = start.with_tolerance(Tolerance::new(tolerance));
        let failure = run.advance_to(1.0).unwrap_err();
        assert!(
            matches!(failure, Failure { kind: FailureKind::UnresolvedTolerance { .. }, .. }),
            "{failure}"
        );
        assert_eq!((run.counts(), run.t()), (start.counts(), 0.0));
    }
    start.with_tolerance(Tolerance::new(0.5 * least)).advance_to(0.1).unwrap();
    let mut run = start;
    let failure = run.advance_to(1e9).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::OutOfReach { until: 1e9, .. }, .. }), "{failure}");
    // What was reached is kept.
    assert!(run.counts().steps == 1000 && run.t() > 10.0, "{} {}", run.counts().steps, run.t());
}

mechanism! {
    /// A stone that is thrown up between two stops.
    pub mechanism Stone;
    const G: m/s^2 = 9.81;
    param ceiling: m = 1;
    param speed: m/s = 3;
    coord x: m = 0;
    coord y: m = 0;
    body stone { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -G] }
    constraint plumb { x == 0; }
    start y = 0 rate speed;
    limit height: -2m <= y <= ceiling;
}

/// Fails where the stone passes a stop; how far it had come.
fn thrown<I: mbs_runtime::dynamics::Embedded>(integrator: I, stone: Stone) -> (Failure, f64) {
    let method = Explicit::new(integrator, Projection::default());
    let mut run = Simulation::start_from_text(stone, method, 0.0).unwrap();
    let failure = run.advance_to(2.0).unwrap_err();
    assert!(run.balance().defect.abs() < 1e-8);
    (failure, run.t())
}

#[test]
fn a_limit_is_passed_where_it_is_and_not_at_the_end_of_a_step() {
    // 3 t − g t²/2 = −2.
    let below = (3.0 + (9.0_f64 + 4.0 * 9.81).sqrt()) / 9.81;
    for (failure, reached) in
        [thrown(DormandPrince8, Stone::default()), thrown(DormandPrince5, Stone::default())]
    {
        let Failure { kind: FailureKind::BeyondLimit { value, .. }, time: Some(time) } = failure else {
            panic!("{failure}")
        };
        assert!((time - below).abs() < 1e-9 && (value + 2.0).abs() < 1e-8, "{time} {value}");
        assert!(0.0 < reached && reached <= time, "{reached}");
    }
    // Up to 0.4587 m: a ceiling below that is passed and left again within a step.
    let low = Stone { ceiling: 0.4, ..Stone::default() };
    let above = (3.0 - (9.0_f64 - 2.0 * 9.81 * 0.4).sqrt()) / 9.81;
    let (failure, _) = thrown(DormandPrince8, low);
    let Failure { kind: FailureKind::BeyondLimit { .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    assert!((time - above).abs() < 1e-9, "{time} {above}");
}

#[test]
fn numbers_that_a_method_cannot_have_are_named_before_anything_moves() {
    fn refused<X: Method<Linkage<2, 1>, f64, 2, 1>>(method: X) -> &'static str {
        let failure =
            Simulation::start(pendulum(), method, 0.0, [1.0, 0.0], [0.0; 2]).map(|_| ()).unwrap_err();
        let Failure { kind: FailureKind::InvalidMethodParameter { name, .. }, .. } = failure else {
            panic!("{failure}")
        };
        name
    }
    for rho in [1.5, -0.5, f64::NAN] {
        assert_eq!(refused(GeneralizedAlpha { rho }), "spectral radius rho");
    }
    let baumgarte = |xi, omega| refused(Explicit::new(RungeKutta4, Baumgarte { xi, omega }));
    assert_eq!(baumgarte(-1.0, 10.0), "damping xi");
    assert_eq!(baumgarte(1.0, f64::NAN), "frequency omega");
    let penalty = Penalty { alpha: -1e7, ..Penalty::default() };
    assert_eq!(refused(Explicit::new(RungeKutta4, penalty)), "penalty alpha");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = Simulation::start(pendulum(), method, 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
    for value in [-1e-9, f64::NAN] {
        let failure = start.with_tolerance(Tolerance::new(value)).advance_to(1.0).unwrap_err();
        let Failure { kind: FailureKind::InvalidMethodParameter { name, value: found, .. }, .. } = failure
        else {
            panic!("{failure}")
        };
        assert!(name == "relative tolerance" && (found == value || value.is_nan()));
    }
}

mechanism! {
    /// A block on two floors.
    pub mechanism Contradicting;
    param off: m = 1e-3;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint floors redundant { y == 0; 2*y == off; }
}

#[test]
fn rows_that_contradict_each_other_are_named_at_the_start() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let near = Simulation::start_near(Contradicting::default(), method, 0.0, [0.0; 2], [0.0; 2]);
    let strict = Simulation::start(Contradicting::default(), method, 0.0, [0.0; 2], [0.0; 2]);
    for failure in [near.unwrap_err(), strict.unwrap_err()] {
        let Failure { kind: FailureKind::Inconsistent { rows, .. }, .. } = failure else {
            panic!("{failure}")
        };
        assert_eq!(rows.rows().count(), 2, "{failure}");
    }
    assert!(Simulation::start(Contradicting { off: 0.0 }, method, 0.0, [0.0; 2], [0.0; 2]).is_ok());
    // One of both is enough for a start that is off; the rows agree.
    let beside = Simulation::start(Contradicting { off: 0.0 }, method, 0.0, [0.0, 1e-3], [0.0; 2]);
    assert!(matches!(beside, Err(Failure { kind: FailureKind::OffConstraints { .. }, .. })));
}

mechanism! {
    /// A ladder between a floor and a wall, both rough.
    pub mechanism Ladder;
    param mu: 1 = 2.5;
    coord x: m = 0.3;
    coord y: m = 0.4;
    coord phi: rad = 2.214_297_435_588_181;
    let foot = [x, y] - 0.5m*unit(phi);
    let head = [x, y] + 0.5m*unit(phi);
    body rod { mass: 3, inertia: 0.25, com: [x, y], angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    constraint floor { foot[1] == 0; }
    constraint wall { head[0] == 0; }
    friction below { along: foot[0], normal: lambda(floor), coefficient: mu, speed: 0.01 }
    friction beside { along: head[1], normal: lambda(wall), coefficient: mu, speed: 0.01 }
}

#[test]
fn friction_that_jams_a_mechanism_is_called_so_and_no_step_is_blamed() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let (phi, rate): (f64, f64) = (2.214_297_435_588_181, 0.8);
    let q = [-0.5 * phi.cos(), 0.5 * phi.sin(), phi];
    let qd = [0.5 * phi.sin() * rate, 0.5 * phi.cos() * rate, rate];
    let failure = Simulation::start(Ladder::default(), method, 0.0, q, qd).unwrap_err();
    let Failure { kind: FailureKind::FrictionLocked { row, .. }, .. } = failure else { panic!("{failure}") };
    assert!(
        ["floor", "wall"].contains(&row.name) && failure.to_string().contains("whatever the step"),
        "{failure}"
    );
    let failure = Simulation::start(Ladder { mu: 1.9 }, method, 0.0, q, qd).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::Ambiguous { solutions: 2, all: true, .. }, .. }),
        "{failure}"
    );
    // At 1.5 the forces turn round, and there is one set of them.
    for mu in [0.4, 1.5] {
        assert!(Simulation::start(Ladder { mu }, method, 0.0, q, qd).is_ok());
    }
}

//! Constraints marked `redundant`: solved if they are consistent, refused with their names if not.

use std::f64::consts::TAU;

use mbs_runtime::{
    Budget, DerivativeOrder, Failure, FailureKind, Kinematic, Lanes, Mechanism, Outcome, Real, Step, Stepper,
    mechanism,
};

mechanism! {
    pub mechanism FourBar;
    param L1: m = 0.10;
    param L2: m = 0.25;
    param L3: m = 0.20;
    param L4: m = 0.30;
    coord phi1: rad = 0.0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { L1*unit(phi1) + L2*unit(phi2) == [L4, 0] + L3*unit(phi3); }
    drive crank: phi1 == TAU*t/1s;
    branch open: sin(phi3 - phi2) > 0;
}

mechanism! {
    /// The same loop, its rows written twice, the second time as distances and turned.
    pub mechanism Doubled;
    param L1: m = 0.10;
    param L2: m = 0.25;
    param L3: m = 0.20;
    param L4: m = 0.30;
    coord phi1: rad = 0.0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    coord rocker: [m; 2] = [0.2, 0.2];
    constraint closure { L1*unit(phi1) + L2*unit(phi2) == [L4, 0] + L3*unit(phi3); }
    constraint joint { rocker == [L4, 0] + L3*unit(phi3); }
    drive crank: phi1 == TAU*t/1s;
    constraint again redundant {
        3*(L1*cos(phi1) + L2*cos(phi2) - rocker.0) == L1*sin(phi1) + L2*sin(phi2) - rocker.1;
        dot(rocker - L1*unit(phi1), rocker - L1*unit(phi1)) == L2^2;
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    branch open: sin(phi3 - phi2) > 0;
}

mechanism! {
    /// A locomotive's wheels: a rod on either side, a quarter turn apart. Where one side stands in line the other turns.
    pub mechanism Wheels;
    param r: m = 0.3;
    param L: m = 1.4;
    param quarter: rad = TAU/4;
    param longer: m = 0;
    coord driven: rad = 0.3;
    coord coupled: rad = 0.3;
    coord near_rod: rad = 0;
    coord far_rod: rad = 0;
    constraint near redundant { r*unit(driven) + L*unit(near_rod) == [L, 0] + r*unit(coupled); }
    constraint far redundant {
        r*unit(driven + TAU/4) + (L + longer)*unit(far_rod) == [L, 0] + r*unit(coupled + quarter);
    }
    drive engine: driven == TAU*t/1s + 0.3;
}

mechanism! {
    /// Three cranks on one plate, what its middle one does told by margins and ratios; by a clock or by a speed.
    pub mechanism Told;
    param u: m = 1;
    param omega: rad/s = 0.7;
    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    coord y: m = 0.5;
    constraint first redundant { u*(unit(alpha) + 2*unit(psi)) == u*([2, 0] + unit(beta)); }
    constraint second redundant { u*(unit(alpha) + unit(psi)) == u*([1, 0] + unit(gamma)); }
    constraint height { y == u*sin(gamma); }
    effect timed { drive crank: alpha == 0.5 + omega*t; }
    effect rated { drive crank: rate(alpha) == omega; }
    out margins: [1; 2] = [margin(first), margin(height)];
    out turn: 1 = ratio(gamma, crank);
    out rise: m = ratio(y, crank);
    scene Timed = timed;
    scene Rated = rated;
}

mechanism! {
    /// A third crank on the coupler of two; `error` is what it is longer.
    pub mechanism Cranks;
    param unit_length: m = 1;
    param error: 1 = 0;
    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    constraint first redundant {
        unit_length*(unit(alpha) + 2*unit(psi)) == unit_length*([2, 0] + unit(beta));
    }
    constraint second redundant {
        unit_length*(unit(alpha) + unit(psi)) == unit_length*([1, 0] + (1 + error)*unit(gamma));
    }
    drive crank: alpha == 0.5 + 0.4*sin(TAU*t/1s);
}

mechanism! {
    /// Two drives of one slide by way of its rod that agree at one instant alone.
    pub mechanism Once;
    param start: m = 0.2;
    param slow: m/s = 0.1;
    param fast: m/s = 0.3;
    coord x: m = 0.1;
    coord y: m = 0.1;
    constraint slide redundant { x^2 == y^2; x == y + fast*t; }
    drive motor: y == start + slow*t;
}

mechanism! {
    /// A drive with a mass whose only row stands twice.
    pub mechanism Hanging;
    param L: m = 0.5;
    param g: m/s^2 = 9.81;
    coord p: [m; 2] = [0.5, 0];
    constraint rod { dot(p, p) == L^2; }
    constraint again redundant { 2*dot(p, p) == 2*L^2; }
    body bob { mass: 2, com: p }
    gravity weight { acceleration: [0, -g] }
}

fn assembled<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: S,
) -> Result<Stepper<S, R, N, M>, Failure> {
    let guess = mechanism.guess(&mechanism.parameters());
    Stepper::assemble(mechanism, guess, R::constant(0.0))
}

#[test]
fn a_loop_with_doubled_rows_moves_as_the_loop_alone() {
    let mut plain = assembled::<_, f64, 3, 3>(FourBar::default()).expect("it assembles");
    let mut doubled = assembled::<_, f64, 5, 8>(Doubled::default()).expect("it assembles");
    for k in 0..=720 {
        let t = f64::from(k) / 720.0;
        plain.advance_to(t).expect("it moves");
        doubled.advance_to(t).expect("it moves");
        let pairs = [
            (plain.q(), doubled.q(), 1.0),
            (plain.qd(), doubled.qd(), TAU),
            (plain.qdd(), doubled.qdd(), TAU * TAU),
        ];
        for (single, double, scale) in pairs {
            for (a, b) in single.iter().zip(double) {
                assert!((a - b).abs() < 1e-12 * scale, "{t}: {a} {b}");
            }
        }
    }
}

#[test]
fn the_rows_that_follow_are_the_marked_ones() {
    let doubled = assembled::<_, f64, 5, 8>(Doubled::default()).expect("it assembles");
    let redundancy = doubled.redundancy();
    assert_eq!(redundancy.rank, 5);
    assert_eq!(redundancy.rows().map(|row| row.name).collect::<Vec<_>>(), ["again.0", "again.1", "again.2"]);
    let plain = assembled::<_, f64, 3, 3>(FourBar::default()).expect("it assembles").redundancy();
    assert_eq!((plain.rank, plain.rows().count()), (3, 0));
}

#[test]
fn a_side_out_of_phase_carries_the_other_over_its_dead_centre() {
    let mut wheels = assembled::<_, f64, 4, 5>(Wheels::default()).expect("it assembles");
    let mut least = f64::INFINITY;
    for k in 0..=1000 {
        let t = f64::from(k) / 500.0;
        wheels.advance_to(t).expect("no dead centre");
        least = least.min(wheels.margin());
        let angle = TAU * t + 0.3;
        for (found, expected) in wheels.q().iter().zip([angle, angle, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-12, "{t}: {found} {expected}");
        }
        assert!((wheels.qd()[1] - TAU).abs() < 1e-10 && wheels.qdd()[1].abs() < 1e-8);
    }
    // Each side alone is singular four times in these two turns.
    assert!(least > 0.05 && wheels.passages() == 0, "{least}");
    let broken = Wheels { quarter: 0.2499 * TAU, ..Wheels::default() };
    let refused = (0..20).find_map(|k| {
        let start = f64::from(k) * 0.05;
        Stepper::assemble(broken, [TAU * start + 0.3, TAU * start + 0.3, 0.0, 0.0], start).err()
    });
    assert!(matches!(refused, Some(Failure { kind: FailureKind::Inconsistent { .. }, .. })), "{refused:?}");
}

#[test]
fn an_error_of_the_dimensions_is_refused_with_the_rows_from_rounding_on() {
    for exponent in 3..=12 {
        let error = 10_f64.powi(-exponent);
        let found = assembled::<_, f64, 4, 5>(Cranks { error, ..Cranks::default() });
        let Err(Failure {
            kind: FailureKind::Inconsistent { rows, level: DerivativeOrder::Position, residual, required, .. },
            ..
        }) = found
        else {
            panic!("{error}: {:?}", found.map(|stepper| *stepper.q()));
        };
        // Least squares share the error among the rows; none of them takes all of it.
        assert!(residual < error && residual > 0.05 * error && required < 1e-13, "{error}: {residual}");
        let names: Vec<&str> = rows.rows().map(|row| row.name).collect();
        assert!(names.len() >= 2 && names.iter().all(|name| !name.starts_with("crank")), "{names:?}");
    }
    for error in [0.0, 2e-16, 1e-15, 1e-14] {
        assembled::<_, f64, 4, 5>(Cranks { error, ..Cranks::default() }).expect("rounding of the lengths");
    }
}

#[test]
fn an_error_that_appears_in_motion_is_refused_and_nothing_is_lost() {
    let mut cranks = assembled::<_, f64, 4, 5>(Cranks::default()).expect("it assembles");
    cranks.advance(0.01).expect("it moves");
    let before = *cranks.q();
    cranks.change(|cranks| cranks.error = 1e-6);
    assert!(matches!(cranks.advance(0.01), Err(Failure { kind: FailureKind::Inconsistent { .. }, .. })));
    let budget = Budget { newton: 5, fallback: 5 };
    assert!(matches!(
        cranks.step(0.01, budget),
        Step::Refused(Failure { kind: FailureKind::Inconsistent { .. }, .. })
    ));
    assert_eq!((*cranks.q(), cranks.t()), (before, 0.01));
    cranks.change(|cranks| cranks.error = 0.0);
    assert!(matches!(cranks.step(0.01, budget), Step::Done(_)));
}

#[test]
fn a_step_of_one_evaluation_follows_the_motion() {
    let mut cranks = assembled::<_, f64, 4, 5>(Cranks::default()).expect("it assembles");
    for _ in 0..500 {
        let step = cranks.step(1e-3, Budget { newton: 1, fallback: 0 });
        assert!(matches!(step, Step::Done(_) | Step::Degraded { .. }), "{step:?}");
    }
    let expected = 0.5 + 0.4 * (TAU * cranks.t()).sin();
    assert!(cranks.q()[..3].iter().all(|angle| (angle - expected).abs() < 1e-5), "{:?}", cranks.q());
}

#[test]
fn nanometres_and_kilometres_have_the_same_rank_and_the_same_failures() {
    for unit_length in [1e-9, 1e-3, 1.0, 1e3] {
        let cranks =
            assembled::<_, f64, 4, 5>(Cranks { unit_length, ..Cranks::default() }).expect("it assembles");
        let redundancy = cranks.redundancy();
        let names: Vec<&str> = redundancy.rows().map(|row| row.name).collect();
        assert_eq!((redundancy.rank, &names[..]), (4, &["second.1"][..]), "{unit_length}");
        let reference = assembled::<_, f64, 4, 5>(Cranks::default()).expect("it assembles");
        assert!((cranks.margin() / reference.margin() - 1.0).abs() < 1e-9, "{unit_length}");
        for error in [1e-12, 1e-6] {
            let found = assembled::<_, f64, 4, 5>(Cranks { unit_length, error });
            let Err(Failure { kind: FailureKind::Inconsistent { residual, .. }, .. }) = found else {
                panic!("{unit_length} {error}")
            };
            assert!(residual / unit_length > 0.05 * error && residual / unit_length < error);
        }
    }
}

#[test]
fn rows_that_agree_at_one_instant_alone_are_refused_in_their_rates() {
    let found = assembled::<_, f64, 2, 3>(Once::default());
    let Err(Failure {
        kind: FailureKind::Inconsistent { rows, level: DerivativeOrder::Velocity, .. }, ..
    }) = found
    else {
        panic!("{:?}", found.map(|stepper| *stepper.qd()));
    };
    assert!(rows.rows().any(|row| row.name.starts_with("slide")));
    let message = found.expect_err("refused").to_string();
    assert!(
        message.contains("the rates of `slide") && message.contains("contradict each other"),
        "{message}"
    );
}

#[test]
fn each_lane_is_judged_by_itself() {
    type Four = Lanes<f64, 4>;
    let cranks = Cranks::<Four> { error: Lanes([0.0, 1e-6, 0.0, f64::NAN]), unit_length: Lanes([1.0; 4]) };
    let parameters = cranks.parameters();
    let mut q = cranks.guess(&parameters);
    let outcome = cranks.solve_blocks(
        &parameters,
        &mut q,
        Lanes([0.1; 4]),
        &mut mbs_runtime::Newton::new(Lanes([1.0; 4])),
    );
    assert!(matches!(
        outcome,
        [Outcome::Converged, Outcome::Inconsistent { .. }, Outcome::Converged, Outcome::NonFinite { .. }]
    ));
    assert!((q[1].0[0] - (0.5 + 0.4 * (0.1 * TAU).sin())).abs() < 1e-12);
}

#[test]
fn single_precision_solves_and_refuses_too() {
    let cranks = Cranks::<f32>::default();
    assert!(assembled::<_, f32, 4, 5>(cranks).is_ok());
    assert!(matches!(
        assembled::<_, f32, 4, 5>(Cranks { error: 1e-3, ..cranks }),
        Err(Failure { kind: FailureKind::Inconsistent { .. }, .. })
    ));
}

#[test]
fn a_mass_on_a_doubled_row_has_functions_of_two_rows() {
    let hanging = Hanging::<f64>::default();
    let parameters = hanging.parameters();
    let position = hanging.position(&parameters, &[0.3, -0.4], 0.0);
    assert_eq!(hanging.phi(&parameters, &position), [0.0, 0.0]);
    assert_eq!(<Hanging as Mechanism<f64, 2, 2>>::REDUNDANT, [false, true]);
}

#[test]
fn margins_and_ratios_are_those_of_the_rows_that_agree_in_any_unit() {
    fn check<S: Kinematic<f64, 5, 6>>(mechanism: S, unit: f64) {
        let parameters = mechanism.parameters();
        let mut guess = mechanism.guess(&parameters);
        guess[4] *= unit;
        let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("it assembles");
        for k in 1..=30 {
            stepper.advance_to(0.1 * f64::from(k)).expect("it moves");
            let values: Vec<f64> = stepper.outputs().as_ref().iter().map(|output| output.value).collect();
            let [first, height, turn, rise] = values[..] else { panic!("four outputs") };
            assert!((first - stepper.margin()).abs() < 1e-15 && height == 1.0, "{values:?}");
            // Rounding error of the position, a few ε, over the margin.
            let bound = 1e-14 / stepper.margin();
            // Crank and plate: ∂γ/∂α = 1, ∂y/∂α = cos α, and rates over the crank's.
            assert!((turn - 1.0).abs() < bound, "{turn}");
            assert!((rise / unit - stepper.q()[0].cos()).abs() < bound, "{rise}");
            assert!((rise - stepper.qd()[4] / stepper.qd()[0]).abs() < bound * unit, "{rise}");
        }
    }
    for unit in [1e-9, 1e-3, 1.0, 1e3] {
        let told = ToldTimed { u: unit, ..Default::default() };
        check(told, unit);
        let rated: ToldRated = told.scene();
        check(rated, unit);
    }
}

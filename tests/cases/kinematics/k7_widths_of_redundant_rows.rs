//! K7: a redundant row with an error of the size of its data's digits was refused, and no text could give an allowed error.

use mbs_runtime::{
    Batch, Budget, DerivativeOrder, Failure, FailureKind, Lanes, Real, Step, Stepper, mechanism,
};

mechanism! {
    /// A plate on three cranks, of which the third is longer by `error`.
    pub mechanism Exact;
    param error: m = 0;
    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    constraint first redundant { 1m*unit(alpha) + 2m*unit(psi) == [2m, 0] + 1m*unit(beta); }
    constraint second redundant { 1m*unit(alpha) + 1m*unit(psi) == [1m, 0] + (1m + error)*unit(gamma); }
    drive crank: alpha == 0.5 + 0.4*sin(2*t/1s);
}

mechanism! {
    /// The same with a width.
    pub mechanism Stated;
    param error: m = 0;
    param play: m = 1e-6;
    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    constraint first redundant { 1m*unit(alpha) + 2m*unit(psi) == [2m, 0] + 1m*unit(beta); }
    constraint second redundant within play { 1m*unit(alpha) + 1m*unit(psi) == [1m, 0] + (1m + error)*unit(gamma); }
    drive crank: alpha == 0.5 + 0.4*sin(2*t/1s);
}

mechanism! {
    /// The same in natural coordinates, in millimetres, its rows squares of lengths; the width is a number.
    pub mechanism Points;
    param error: m = 0;
    coord A: [m; 2] = [877mm, 479mm];
    coord B: [m; 2] = [2877mm, 479mm];
    coord P: [m; 2] = [1877mm, 479mm];
    constraint crank { A == 1m*unit(0.5 + 0.4*sin(2*t/1s)); }
    constraint plate { dot(B - A, B - A) == 4 [m^2]; P == 0.5*(A + B); }
    constraint rocker { dot(B - [2m, 0], B - [2m, 0]) == 1 [m^2]; }
    constraint third redundant within 2e-6 [m^2] { dot(P - [1m, 0], P - [1m, 0]) == (1m + error)^2; }
}

const GUESS: [f64; 4] = [0.5, 0.5, 0.5, 0.0];

/// Residuals of four rows caused by a crank's length error, to first order.
///
/// `first` does not yield, so ψ = 0 and β = α. What γ makes of `second`, (sin γ, −cos γ) δγ, is normal to its contradiction.
fn yielded(alpha: f64, error: f64) -> [f64; 4] {
    let (sine, cosine) = alpha.sin_cos();
    [0.0, 0.0, -error * cosine, -error * sine]
}

#[test]
fn residuals_of_data_with_fifteen_digits_are_no_contradiction() {
    for error in [1e-15, 1e-14, 3e-14, 1e-13, -1e-13] {
        let mut exact =
            Stepper::assemble(Exact::<f64> { error }, GUESS, 0.0).expect("the digits of the data");
        for k in 1..=300 {
            exact.advance_to(0.01 * f64::from(k)).expect("the digits of the data");
        }
    }
    let found = Stepper::assemble(Exact::<f64> { error: 3e-12 }, GUESS, 0.0);
    assert!(matches!(
        found,
        Err(Failure { kind: FailureKind::Inconsistent { level: DerivativeOrder::Position, .. }, .. })
    ));
}

#[test]
fn rows_with_a_width_yield_and_the_others_are_closed() {
    for error in [1e-10, 1e-8, -1e-7, 1e-6] {
        let mut stated = Stepper::assemble(Stated::<f64> { error, play: 1e-6 }, GUESS, 0.0).expect("within");
        let mut largest = 0.0_f64;
        for k in 1..=400 {
            stated.advance_to(0.01 * f64::from(k)).expect("within the width");
            let alpha = stated.q()[0];
            assert!((alpha - 0.5 - 0.4 * (2.0 * stated.t()).sin()).abs() < 1e-14, "the drive is held");
            // Residuals that the solver grants, 5e-14 of a reference length of 2 m in each of two rows, and 4e-11 of the contradiction, which
            // the weight leaves. The first row tells β from α by sin α, 0.1 at least.
            let allowed = (2e-13 + 1e-10 * error.abs()) / alpha.sin();
            let [alpha, beta, gamma, psi] = *stated.q();
            assert!((beta - alpha).abs() < allowed && psi.abs() < allowed, "{error} {beta} {psi}");
            assert!((gamma - alpha).abs() < allowed + error * error, "{error}: {:e}", gamma - alpha);
            let open = stated.phi();
            let rest = yielded(alpha, error);
            assert!(
                open[..4].iter().zip(rest).all(|(a, b)| (a - b).abs() < 2.0 * allowed),
                "{open:?} {rest:?}"
            );
            largest = open[..4].iter().fold(largest, |largest, open| largest.max(open.abs()));
            let [of_alpha, of_beta, of_gamma, of_psi] = *stated.qd();
            let allowed = 1e-12 + 1e-9 * error.abs();
            assert!((of_beta - of_alpha).abs() < allowed && of_psi.abs() < allowed, "{of_beta} {of_psi}");
            assert!((of_gamma - of_alpha).abs() < 1e-12 + error.abs(), "{:e}", of_gamma - of_alpha);
        }
        assert!(largest <= 1e-6, "no row is open by more than the width: {largest}");
    }
}

mechanism! {
    /// A slide with a second law that differs by a wave.
    pub mechanism Slide;
    param wave: m = 0.5um;
    param waves: 1 = 3;
    param play: m = 1um;
    coord theta: rad;
    coord x: m = 50mm;
    constraint first { x == 50mm*cos(theta); }
    constraint second redundant within play { x == 50mm*cos(theta) + wave*sin(waves*theta); }
    drive shaft: theta == 40 [rad/s]*t + 30 [rad/s^2]*t^2;
}

#[test]
fn mismatches_are_those_of_the_difference_of_both_laws() {
    // Contradictions of tables have hundreds of waves a turn. Their accelerations are as large as those of the slide here.
    for waves in [3.0, 30.0, 300.0] {
        follow_the_slide(waves);
    }
}

fn follow_the_slide(waves: f64) {
    let slide = Slide { waves, ..Slide::<f64>::default() };
    let mut slide = Stepper::assemble(slide, [0.0, 0.05], 0.0).expect("within");
    let mut largest = [0.0_f64; 3];
    for k in 1..=300 {
        slide.advance_to(0.001 * f64::from(k)).expect("within the width");
        let t = slide.t();
        let (theta, speed, bend) = (40.0 * t + 30.0 * t * t, 40.0 + 60.0 * t, 60.0);
        let (sine, cosine) = (waves * theta).sin_cos();
        let expected = [
            -5e-7 * sine,
            -5e-7 * waves * cosine * speed,
            -5e-7 * (waves * cosine * bend - waves * waves * sine * speed * speed),
        ];
        let [found] = slide.mismatches().collect::<Vec<_>>().try_into().expect("one row yields");
        assert_eq!((found.row.name, found.row.unit, found.width), ("second", "m", 1e-6));
        let found = [found.position, found.rate, found.acceleration];
        // Rounding of x, of its rate of 3 m/s and of its acceleration of 170 m/s², and the part that the other row keeps.
        for ((found, expected), (allowed, largest)) in
            found.iter().zip(expected).zip([1e-16, 1e-14, 1e-12].iter().zip(&mut largest))
        {
            assert!((found - expected).abs() < allowed + 1e-9 * expected.abs(), "{found:e} {expected:e}");
            *largest = largest.max(found.abs());
        }
        assert!(slide.phi()[0].abs() < 1e-16, "the other row is closed: {:e}", slide.phi()[0]);
        assert!(slide.closure_error() < 1e-14, "{:e}", slide.closure_error());
    }
    let least = [4.9e-7, 2e-5 * waves, 7e-4 * waves * waves];
    assert!(largest.iter().zip(least).all(|(largest, least)| *largest > least), "{largest:?}");
    // Without a width no row yields.
    let exact = Stepper::assemble(Exact::<f64> { error: 0.0 }, GUESS, 0.0).expect("no contradiction");
    assert_eq!(exact.mismatches().count(), 0);
}

mechanism! {
    /// Two laws that agree at one angle alone.
    pub mechanism Crossing;
    param slope: m/rad = 5mm/1rad;
    coord theta: rad;
    coord x: m = 50mm;
    constraint first { x == 50mm*cos(theta); }
    constraint second redundant within 1um { x == 50mm*cos(theta) + slope*theta; }
    drive shaft: theta == 40 [rad/s]*t;
}

#[test]
fn laws_that_cross_are_refused_where_they_meet() {
    let found = Stepper::assemble(Crossing::<f64>::default(), [0.0, 0.05], 0.0).map(|_| ());
    let level = DerivativeOrder::Velocity;
    assert!(
        matches!(found, Err(Failure { kind: FailureKind::Inconsistent { level: found, .. }, .. }) if found == level),
        "{found:?}"
    );
}

#[test]
fn rows_beyond_their_width_are_refused() {
    for (error, play) in [(1e-5, 1e-6), (1e-4, 1e-5), (1e-9, 1e-10), (1e-3, 0.0), (1e-3, f64::NAN)] {
        let found = Stepper::assemble(Stated::<f64> { error, play }, GUESS, 0.0);
        if play.is_nan() {
            assert!(found.is_err());
            continue;
        }
        let Err(Failure { kind: FailureKind::Inconsistent { residual, required, .. }, .. }) = found else {
            panic!("{error} {play}")
        };
        assert!(residual > required && required < play + 2e-13, "{residual} {required}");
    }
}

#[test]
fn a_width_that_is_left_in_motion_is_refused_there() {
    // The residual of each row goes with the direction of the cranks: cos and sin of the angle.
    let width = 0.9 * largest_rest(1e-5);
    let mut stated = Stepper::assemble(Stated::<f64> { error: 1e-5, play: width }, GUESS, 0.0);
    let mut outcomes = [0; 2];
    for k in 0..400 {
        let t = 0.01 * f64::from(k);
        let refused = match &mut stated {
            Ok(stepper) => stepper.advance_to(t).err(),
            Err(failure) => Some(*failure),
        };
        let alpha = 0.5 + 0.4 * (2.0 * t).sin();
        let rest = yielded(alpha, 1e-5).iter().fold(0.0_f64, |largest, rest| largest.max(rest.abs()));
        // Refused if the residual of first order exceeds the width; differences of second order are not judged.
        if (rest - width).abs() > 1e-8 {
            assert_eq!(refused.is_some(), rest > width, "{t}: {rest} of {width}: {refused:?}");
        }
        if let Some(failure) = refused {
            assert!(matches!(failure, Failure { kind: FailureKind::Inconsistent { .. }, .. }), "{failure:?}");
            outcomes[1] += 1;
            if stated.is_err() {
                let next = 0.5 + 0.4 * (2.0 * (t + 0.01)).sin();
                stated =
                    Stepper::assemble(Stated { error: 1e-5, play: width }, [next, next, next, 0.0], t + 0.01);
            }
        } else {
            outcomes[0] += 1;
        }
    }
    assert!(outcomes.iter().all(|count| *count > 20), "{outcomes:?}");
}

/// The largest residual over the motion.
fn largest_rest(error: f64) -> f64 {
    let rests = (0..400).flat_map(|k| yielded(0.5 + 0.4 * (0.02 * f64::from(k)).sin(), error));
    rests.fold(0.0, |largest, rest| largest.max(rest.abs()))
}

#[test]
fn natural_coordinates_budgets_and_lanes_have_the_same_width() {
    let guess = [0.877, 0.479, 2.877, 0.479, 1.877, 0.479];
    // The square of 1 m and an error has the width of 2e-6 m² at 1e-6 m.
    for error in [1e-9, 1e-7, 0.99e-6] {
        let mut points = Stepper::assemble(Points::<f64> { error }, guess, 0.0).expect("within the width");
        for k in 1..=200 {
            let step = points.step(0.01, Budget { newton: 6, fallback: 4 });
            assert!(matches!(step, Step::Done(_)), "{k}: {step:?}");
        }
    }
    assert!(matches!(
        Stepper::assemble(Points::<f64> { error: 1e-5 }, guess, 0.0),
        Err(Failure { kind: FailureKind::Inconsistent { .. }, .. })
    ));
    let lanes = Stated::<Lanes<f64, 4>> {
        error: Lanes([0.0, 1e-7, 1e-5, 1e-7]),
        play: Lanes([1e-6, 1e-6, 1e-6, 1e-9]),
    };
    let outcome = lanes_outcome(lanes);
    assert_eq!(outcome, [true, true, false, false]);
}

fn lanes_outcome(lanes: Stated<Lanes<f64, 4>>) -> [bool; 4] {
    use mbs_runtime::{Kinematic, Mechanism, Newton, Outcome};
    let parameters = lanes.parameters();
    let mut q = GUESS.map(|angle| Lanes([angle; 4]));
    let outcome = lanes.solve_blocks(&parameters, &mut q, Lanes([0.1; 4]), &mut Newton::new(Lanes([1.0; 4])));
    outcome.map(|outcome| outcome == Outcome::Converged)
}

#[test]
fn single_precision_has_widths_too() {
    fn assembles<R: Real>(error: f64, play: f64) -> bool {
        let (error, play) = (R::constant(error), R::constant(play));
        let guess = GUESS.map(R::constant);
        Stepper::<_, R, 4, 5>::assemble(Stated { error, play }, guess, R::constant(0.0)).is_ok()
    }
    assert!(assembles::<f32>(1e-4, 1e-4) && !assembles::<f32>(1e-3, 1e-4));
    assert!(assembles::<f64>(1e-4, 1e-4) && !assembles::<f64>(1e-3, 1e-4));
}

#[test]
fn a_width_below_zero_is_refused_by_its_row() {
    let refused = |failure: Failure| {
        assert!(
            matches!(failure, Failure { kind: FailureKind::Negative { value: -1e-6, .. }, .. }),
            "{failure}"
        );
        let message = failure.to_string();
        assert!(message.starts_with("the width of row `second.0` (line "), "{message}");
        assert!(message.contains(") is -1e-6: "), "{message}");
    };
    let below = Stated { error: 0.0, play: -1e-6 };
    refused(Stepper::assemble(below, GUESS, 0.0).map(|_| ()).expect_err("a width below zero"));
    let mut stated = Stepper::assemble(Stated { error: 0.0, play: 1e-6 }, GUESS, 0.0).expect("an assembly");
    stated.change(|stated| stated.play = -1e-6);
    refused(stated.advance(0.01).expect_err("a width below zero"));
    stated.change(|stated| stated.play = 0.0);
    stated.advance(0.01).expect("a width of zero");
    let play = Lanes([1e-6, -1e-6, 0.0, 1e-6]);
    let lanes = Stated { error: Lanes([0.0; 4]), play };
    let mut lanes = Batch::assemble_each(lanes, &[GUESS; 4], [0.0; 4]).expect("other lanes");
    refused(lanes.failures()[1].expect("a width below zero in a lane"));
    assert!([0, 2, 3].iter().all(|lane| lanes.failures()[*lane].is_none()));
    lanes.change(|stated| stated.play = Lanes([-1e-6, 1e-6, 0.0, 1e-6]));
    let steps = lanes.advance_to([0.01; 4]);
    refused(steps[0].expect_err("a width below zero in a lane"));
    assert!(steps[2].is_ok() && steps[3].is_ok());
}

mechanism! {
    /// Two parallelograms of one crank in line at 0 and half a turn, every row redundant: they keep each other.
    pub mechanism Locomotive;
    coord alpha: rad = 0.4;
    coord psi: rad = 0;
    coord beta: rad = 0.4;
    coord gamma: rad = 0.4;
    constraint first redundant { 1m*unit(alpha) + 2m*unit(psi) == [2m, 0] + 1m*unit(beta); }
    constraint second redundant { 1m*unit(alpha) + 1m*unit(psi) == [1m, 0] + 1m*unit(gamma); }
    drive crank: alpha == 0.4 + 3*t/1s;
}

#[test]
fn redundant_parallelograms_lead_on_from_every_position() {
    let mut locomotive =
        Stepper::assemble(Locomotive::default(), [0.4, 0.0, 0.4, 0.4], 0.0).expect("an assembly");
    for k in 1..=3000 {
        let t = 0.003 * f64::from(k);
        locomotive.advance_to(t).unwrap_or_else(|failure| panic!("{t}: {failure}"));
        let [alpha, psi, beta, gamma] = *locomotive.q();
        let off = [psi, beta - alpha, gamma - alpha].into_iter().fold(0.0, |off: f64, x| off.max(x.abs()));
        assert!(off < 1e-7, "{t}: {off:e}");
    }
}

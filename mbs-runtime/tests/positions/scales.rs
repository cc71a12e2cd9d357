//! Rows that nearly say the same, and lengths of very different size.

use mbs_runtime::{Failure, FailureKind, IllScaled, Stepper, mechanism};

mechanism! {
    /// The point where two lines meet; one stands, the other moves so that it runs along the first at about 1 m/s.
    mechanism Scissors;
    param between: rad = 0.1;
    param tilt: rad = 0.7;
    coord p: [m; 2] = [0.5, 0.5];
    constraint lines {
        cross(unit(tilt), p) == 0;
        cross(unit(tilt + between), p) + between*t*1m/1s == 0;
    }
}

mechanism! {
    /// A short link at a far place, by the squared distance.
    mechanism FarAway;
    param place: m = 1e6;
    param link: m = 1e-3;
    coord p: [m; 2] = [place + link, 0];
    let arm = p - [place, 0];
    constraint length { dot(arm, arm) == link^2; }
    drive motor: cross(unit(t*1rad/1s), arm) == 0;
    branch ahead: dot(unit(t*1rad/1s), arm) > 0;
}

mechanism! {
    /// The same by its angle.
    mechanism Angle;
    param place: m = 1e6;
    param link: m = 1e-3;
    coord phi: rad;
    coord p: [m; 2];
    constraint tip { p == [place, 0] + link*unit(phi); }
    drive motor: phi == t*1rad/1s;
}

#[test]
fn two_lines_that_are_nearly_one_are_told_by_the_margin_and_refused_where_rates_would_be_noise() {
    for k in 1..=9 {
        let between = 10.0_f64.powi(-k);
        let design = Scissors { between, ..Scissors::default() };
        match Stepper::assemble(design, [0.5, 0.5], 1.0) {
            Ok(stepper) => {
                assert!(
                    (stepper.margin() / between.sin() - 1.0).abs() < 1e-6,
                    "{between:e}: {:e}",
                    stepper.margin()
                );
                let speed = between / between.sin();
                let exact = [speed * 0.7_f64.cos(), speed * 0.7_f64.sin()];
                for (rate, exact) in stepper.qd().iter().zip(exact) {
                    // Round-off of the sines over the angle between.
                    assert!(
                        (rate / exact - 1.0).abs() < 8.0 * f64::EPSILON / between,
                        "{between:e}: {rate} {exact}"
                    );
                }
            }
            Err(failure) => {
                assert!(matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }), "{failure}");
                assert!(between < 32.0 * f64::EPSILON.sqrt(), "{between:e}");
            }
        }
    }
}

#[test]
fn a_link_of_a_millimetre_a_thousand_kilometres_away_is_reported_and_its_square_is_refused() {
    let stepper = Stepper::assemble(Angle::default(), [0.0, 1e6, 0.0], 0.3).expect("it assembles");
    let [_, x, y]: [f64; 3] = *stepper.q();
    // Coordinates of 1e6 m come in steps of 1.2e-10 m.
    assert!((x - 1e6 - 1e-3 * 0.3_f64.cos()).abs() < 1.2e-10 && (y - 1e-3 * 0.3_f64.sin()).abs() < 1e-18);
    let IllScaled { variable, value, resolution } =
        stepper.ill_scaled().expect("a millimetre beside 1000 km");
    assert_eq!((variable.name, value), ("link", 1e-3));
    assert!((resolution / (64.0 * f64::EPSILON * 1e6) - 1.0).abs() < 1e-6, "{resolution:e}");
    // 1e-6 m² are nothing beside 1e12 m²: there is no rate to be had.
    let failure =
        Stepper::assemble(FarAway::default(), [1e6 + 1e-3, 0.0], 0.3).expect_err("no digit is left");
    assert!(
        matches!(
            failure,
            Failure { kind: FailureKind::Singular { .. }, .. }
                | Failure { kind: FailureKind::WrongBranch { .. }, .. }
        ),
        "{failure}"
    );
}

#[test]
fn a_link_of_a_millimetre_a_metre_away_is_no_matter() {
    let near = FarAway { place: 1.0, ..FarAway::default() };
    let stepper = Stepper::assemble(near, [1.001, 0.0], 0.3).expect("it assembles");
    let [x, y]: [f64; 2] = *stepper.q();
    assert!(((x - 1.0).hypot(y) / 1e-3 - 1.0).abs() < 1e-12, "{x} {y}");
    assert_eq!(stepper.ill_scaled(), None);
    // In single precision it is.
    let near = Angle { place: 1.0_f32, link: 1e-3 };
    let single = Stepper::assemble(near, [0.0, 1.0, 0.0], 0.3).expect("it assembles");
    assert!(single.ill_scaled().is_some_and(|found| found.variable.name == "link"));
}

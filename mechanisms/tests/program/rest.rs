//! Rest, loads, small motions, and the numbers of the commands.

use super::*;

#[test]
fn rest_and_the_loads_of_a_driven_motion_are_analyses_too() {
    let scratch = Scratch::new("analyses");
    let held = standard_output(run_into(&scratch, &["equilibrium", "slider_crank_mass:Driven"]));
    // At 60° the piston's pin carries half the rod, the motor that at the crank's end and the crank's own weight.
    assert!((figure(&held, "piston_pin.1") - 0.5 * 0.6 * 9.81).abs() < 1e-6, "{held}");
    let torque = 0.5 * 9.81 * (0.4 * 0.025 + 0.5 * 0.6 * 0.05);
    assert!((figure(&held, "motor_torque") - torque).abs() < 1e-6, "{held}");
    let text = standard_output(run_into(&scratch, &["inverse", "slider_crank_mass:Driven", "--steps", "36"]));
    assert!(text.contains("motor_torque: -") && text.contains("N*m"), "{text}");
    // The energy is the same after a turn: the motor's work is the error of the quadrature.
    assert!(figure(&text, "work of drive crank_drive").abs() < 1e-3, "{text}");
    let header = scratch.text("motion.csv").lines().next().map(str::to_string).expect("a header");
    assert!(header.contains(",motor_torque (N*m),") && header.contains(",lambda closure.0 (N),"), "{header}");
}

#[test]
fn a_pendulum_rests_where_its_guess_leads_and_swings_about_it_with_its_frequency() {
    let scratch = Scratch::new("rest");
    let run = |arguments: &[&str]| standard_output(run_into(&scratch, arguments));
    for (side, tension) in [("-0.9", 9.81), ("0.9", -9.81)] {
        let guess = format!("P.1={side}");
        let text = run(&["equilibrium", "pendulum", "--guess", "P.0=0.1", "--guess", &guess]);
        assert!(figure(&text, "P.0 at rest").abs() < 1e-9, "{text}");
        assert!(
            (figure(&text, "P.1 at rest") - side.parse::<f64>().unwrap().signum()).abs() < 1e-9,
            "{text}"
        );
        assert!((figure(&text, "tension") - tension).abs() < 1e-6, "{text}");
        assert!(
            scratch
                .text("report.html")
                .contains(&format!("mbs equilibrium pendulum --guess P.0=0.1 --guess {guess}"))
        );
    }
    // ±√(g/L) i about the lower position, ±√(g/L) about the upper one.
    let rate = 9.81_f64.sqrt();
    let text = run(&["modes", "pendulum", "--guess", "P.0=0.1", "--guess", "P.1=-0.9"]);
    let eigenvalue =
        text.lines().find_map(|line| line.trim().strip_prefix("eigenvalues 1, 2: ")).expect("a pair");
    let frequency = eigenvalue.split(" ± ").nth(1).and_then(|rest| rest.split('i').next()).expect("a pair");
    assert!((frequency.parse::<f64>().expect("a number") - rate).abs() < 2e-6, "{text}");
    assert!(eigenvalue.starts_with("0 ± ") && eigenvalue.ends_with(" Hz, undamped, marginal"), "{text}");
    let modes = scratch.text("modes.csv");
    let line = modes.lines().nth(1).expect("a mode");
    assert!(line.starts_with("released,1,2,") && line.contains(",marginal,1.0,0.0,"), "{modes}");
    let text = run(&["modes", "pendulum", "--guess", "P.0=0.1", "--guess", "P.1=0.9"]);
    let both = [figure(&text, "eigenvalue 1"), figure(&text, "eigenvalue 2")];
    assert!(both.iter().all(|value| (value.abs() - rate).abs() < 2e-6) && both[0] * both[1] < 0.0, "{text}");
}

#[test]
fn small_motions_about_a_moment_say_that_it_moves() {
    let scratch = Scratch::new("moment");
    let arguments = ["modes", "pendulum", "--at", "0.3", "--steps", "3"];
    let text = standard_output(run_into(&scratch, &arguments));
    assert!(
        text.contains("small motions about: the state at t = 0.3 s, which moves")
            && text.contains("(frozen-time), which depend on the coordinates")
    );
    assert_eq!(figure(&text, "degrees of freedom"), 1.0);
    assert_eq!(scratch.text("motion.csv").lines().count(), 5);
    let text = standard_output(run_into(&scratch, &["modes", "quarter_car"]));
    // Body and wheel on their springs with the other held still are near: 1.1 and 10 Hz.
    assert!(
        text.contains("1.142825 Hz, natural frequency 1.189761 Hz, damping ratio 0.2781, stable")
            && text.contains("9.973777 Hz"),
        "{text}"
    );
    // With springs of 20 and 180 kN/m.
    let stiffer = ["modes", "quarter_car", "--param", "k.0=20000", "--param", "k.1=180000"];
    let text = standard_output(run_into(&scratch, &stiffer));
    for (natural, ratio) in [("1.252", "0.2639"), ("11.07", "0.2754")] {
        let said =
            |line: &str| line.contains(&format!("natural frequency {natural}")) && line.contains(ratio);
        assert!(text.lines().any(said), "{text}");
    }
}

#[test]
fn small_motions_are_those_of_the_text_s_independent_coordinates_where_they_determine_the_others() {
    let scratch = Scratch::new("independent");
    let about = |t: &str| {
        let arguments = ["modes", "pendulum", "--at", t, "--steps", "3"];
        standard_output(run_into(&scratch, &arguments))
    };
    let fallen = about("0.3");
    assert!(fallen.lines().any(|line| line.trim() == "in the coordinates: P.0"), "{fallen}");
    // If the rod is level, x does not determine y.
    let level = about("0");
    assert!(level.contains("in the coordinates: P.1; P.0 would not determine the others there"), "{level}");
}

/// Values that the option `--analysis` of earlier versions gave: command, file, row, and numbers of the row.
#[test]
fn commands_give_the_numbers_of_the_analyses_that_they_replace() {
    let stored = include_str!("analyses.txt");
    let scratch = Scratch::new("replaced-analyses");
    let cases: Vec<&str> = stored.split("\n\n").filter(|case| !case.trim().is_empty()).collect();
    assert_eq!(cases.len(), 9, "a command each, with `run` and small motions of two kinds");
    for case in cases {
        let mut lines = case.trim().lines();
        let (command, file) = (lines.next().expect("a command"), lines.next().expect("a file"));
        standard_output(run_into(&scratch, &command.split(' ').collect::<Vec<_>>()));
        let text = scratch.text(file);
        let found: Vec<&str> = text.lines().collect();
        let (rows, lines) = ([found[1], found[found.len() - 1]], lines.collect::<Vec<_>>());
        assert_eq!(lines.len(), rows.len(), "{command}");
        for (expected, found) in lines.into_iter().zip(rows) {
            let numbers = |row: &str| row.split(',').map(|cell| cell.parse::<f64>().ok()).collect::<Vec<_>>();
            let (expected, found) = (numbers(expected), numbers(found));
            assert_eq!(expected.len(), found.len(), "{command}");
            for (a, b) in expected.iter().zip(&found) {
                let near = a.zip(*b).is_none_or(|(a, b)| (a - b).abs() <= 1e-9 * a.abs().max(1.0));
                assert!(near && a.is_some() == b.is_some(), "{command}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn rest_is_found_beside_what_no_force_answers_and_is_called_by_its_name() {
    let scratch = Scratch::new("stability");
    let run =
        |arguments: &[&str]| standard_output(run_into(&scratch, &[&["equilibrium"], arguments].concat()));
    // A level rod gives no stiffness: the weight gives the direction.
    let text = run(&["pendulum"]);
    assert!(
        text.contains("this rest is: stable: small motions go on") && figure(&text, "P.1 at rest") == -1.0,
        "{text}"
    );
    let text = run(&["pendulum", "--guess", "P.0=0.1", "--guess", "P.1=0.9"]);
    assert!(
        text.contains("this rest is: unstable: small motions grow, the fastest by e in 0.3193 s"),
        "{text}"
    );
    // Pushed from there it falls to the stable equilibrium, which is listed below with its own label.
    let settled = text.split("\nreleased, settled\n").nth(1).expect("a second rest");
    assert!(
        text.contains("a stable rest is: found below") && figure(settled, "P.1 at rest") == -1.0,
        "{text}"
    );
    assert!(settled.contains("this rest is: stable: small motions go on"), "{text}");
    assert_eq!(scratch.text("motion.csv").lines().count(), 3);
    for (name, coordinates) in
        [("cart_pole", "x, P.0:"), ("governor", "phi, r.0.1, r.1.1, e.0.1"), ("heavy_top", "e.2, e.3:")]
    {
        let text = run(&[name]);
        assert!(
            text.contains("this rest is: indifferent: one motion meets no force, no other grows"),
            "{text}"
        );
        assert!(text.contains(&format!("indifferent coordinates: {coordinates}")), "{text}");
    }
    // Of two loads one is too large for the weights to hold.
    let text = run(&["slider_crank_mass:Released"]);
    let reason = "left out: slider_crank_mass:Released: torque: no position of rest at t = 0 s";
    assert!(text.contains("theta at rest: 1.570796 rad") && text.contains(reason), "{text}");
    assert!(scratch.text("report.html").contains("torque: no position of rest at t = 0 s"));
    let message = failure(mbs(&["equilibrium", "slider_crank_mass:Released", "--param", "tau=1"]), 1);
    assert!(message.contains("still push `theta`") && message.contains("`--guess theta=…`"), "{message}");
    // One coordinate at its guess, the others follow so that the rows hold.
    let text = run(&["bricard", "--guess", "first=0.3"]);
    assert!((figure(&text, "first at rest") - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{text}");
    let text = standard_output(run_into(&scratch, &["modes", "car_axis"]));
    assert!(text.contains("small motions about: a position of rest, the time held at 0 s"), "{text}");
}

#[test]
fn an_analysis_that_cannot_be_says_which_can() {
    let refused = |arguments: &[&str]| failure(mbs(arguments), 2);
    let message = refused(&["simulate", "four_bar"]);
    assert!(message.contains("neither masses nor forces"), "{message}");
    for analysis in ["kinematics", "inverse"] {
        let message = refused(&[analysis, "pendulum"]);
        assert!(message.contains("free to move") && message.contains("mbs simulate pendulum"), "{message}");
    }
    refused(&["run", "pendulum", "--until", "0"]);
    refused(&["run", "pendulum", "--method", "hope"]);
}

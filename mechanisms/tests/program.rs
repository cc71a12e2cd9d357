//! The program `mbs` as a person meets it.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A directory of this test alone, removed with its owner.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        Scratch(path)
    }

    /// A file of the report; of a table what stands below the line that names its origin.
    fn text(&self, file: &str) -> String {
        let text = fs::read_to_string(self.0.join(file)).expect("a file of the report");
        match text.strip_prefix("# mbs ").and_then(|rest| rest.split_once('\n')) {
            Some((_, table)) => table.to_string(),
            None => text,
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn mbs(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mbs-catalogue")).args(arguments).output().expect("the program starts")
}

fn run_into(scratch: &Scratch, arguments: &[&str]) -> Output {
    let directory = scratch.0.to_str().expect("a path of the build");
    mbs(&[arguments, &["--out", directory]].concat())
}

#[track_caller]
fn standard_output(output: Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{:?}: {errors}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The message of a command that must fail with `code`, without a panic and with nothing on standard output.
#[track_caller]
fn failure(output: Output, code: i32) -> String {
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "");
    message
}

fn cells(line: &str) -> Vec<f64> {
    line.split(',').skip(1).map(|cell| cell.parse().expect("a number")).collect()
}

#[test]
fn without_arguments_the_four_bar_runs_one_turn() {
    let text = standard_output(mbs(&[]));
    for part in
        ["Four-bar", "coupler curve", "open assembly", "crossed assembly", "iterations", "closure error"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let path = text.lines().find_map(|line| line.strip_prefix("report  ")).expect("where the report is");
    assert!(fs::read_to_string(path).expect("the report").contains("<title>Four-bar"));
}

#[test]
fn the_list_names_every_mechanism_with_its_parameters() {
    let text = standard_output(mbs(&["list"]));
    for card in mechanisms::CATALOGUE.fixed() {
        let title = card.picture().expect("a text").title;
        assert!(text.contains(&card.name()) && text.contains(&title), "{text}");
    }
    assert!(text.contains("omega=30 rad/s"), "{text}");
}

#[test]
fn every_mechanism_runs_and_writes_its_report() {
    for card in mechanisms::CATALOGUE.iter() {
        let (name, runs) = (card.name(), card.runs().expect("a text").len());
        let name = name.as_str();
        let scratch = Scratch::new(name);
        // Matrices of 163 rows, implicit steps of a millisecond and impacts take a moment each where nothing is optimised.
        let until = match name {
            "n_four_bar_40" | "governor" | "woodpecker" => &["--until", "0.1"][..],
            "valve_spring" => &["--until", "0.01"],
            "bouncing_balls" | "bricard" | "door_with_closer" => &["--until", "1"],
            _ => &[],
        };
        standard_output(run_into(&scratch, &[&["run", name, "--steps", "24"], until].concat()));
        let values = scratch.text("motion.csv");
        assert_eq!(values.lines().count(), 1 + 25 * runs, "{name}");
        let columns = values.lines().next().map(|line| line.split(',').count());
        assert!(values.lines().all(|line| Some(line.split(',').count()) == columns));
        assert!(scratch.text("report.html").contains(&format!("\"name\":\"{name}\"")));
        let files = fs::read_dir(&scratch.0).expect("the directory").count();
        assert_eq!(files, 2, "only the report and its values");
    }
}

/// The number before ` J` or the unit in the line that begins with `name`.
#[track_caller]
fn figure(text: &str, name: &str) -> f64 {
    let line = text.lines().find_map(|line| line.trim().strip_prefix(name)?.strip_prefix(": "));
    let line = line.unwrap_or_else(|| panic!("no `{name}` in\n{text}"));
    line.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}

#[test]
fn a_free_mechanism_moves_by_its_forces_and_the_constraints_tell_the_methods_apart() {
    let run = |method: &str| {
        let scratch = Scratch::new(&format!("method-{method}"));
        let arguments = ["run", "pendulum", "--steps", "40", "--until", "5", "--method", method];
        let text = standard_output(run_into(&scratch, &arguments));
        assert_eq!(scratch.text("motion.csv").lines().count(), 42);
        assert!(
            figure(&text, "largest energy defect") < 1e-6 && figure(&text, "evaluations") > 100.0,
            "{text}"
        );
        figure(&text, "largest |Φ|")
    };
    let [none, baumgarte, projection, velocity] = ["none", "baumgarte", "projection", "velocity"].map(run);
    // Rounding, the residue of damping, the undamped drift.
    assert!(
        projection.max(velocity) < 1e-13 && 1e-13 < baumgarte && 10.0 * baumgarte < none,
        "{none} {baumgarte}"
    );
}

#[test]
fn every_integrator_and_the_penalty_can_be_chosen() {
    let run = |arguments: &[&str]| {
        let scratch = Scratch::new(&format!("chosen{}", arguments.concat()));
        let text = standard_output(run_into(
            &scratch,
            &[&["run", "pendulum", "--steps", "20", "--until", "1"], arguments].concat(),
        ));
        assert!(scratch.text("report.html").contains(&arguments.join(" ")), "the page repeats the command");
        (figure(&text, "largest energy defect"), figure(&text, "evaluations"), figure(&text, "largest |Φ|"))
    };
    let order5 = run(&["--integrator", "order5", "--tolerance", "1e-8"]);
    assert!(order5.0 < 1e-6 && order5.2 < 1e-13, "{order5:?}");
    // The cost of a tolerance is visible for any instants.
    let [exact, coarse] = ["1e-12", "1e-3"].map(|tolerance| run(&["--tolerance", tolerance]));
    assert!(exact.0 < 1e-10 && 1e-10 < coarse.0 && coarse.1 < 0.3 * exact.1, "{exact:?} {coarse:?}");
    // Four evaluations a step of Runge and Kutta's method, one of Euler's, and one to start with.
    let (rk4, euler) = (
        run(&["--integrator", "rk4", "--step", "2.5e-2"]),
        run(&["--integrator", "euler", "--step", "2.5e-2"]),
    );
    assert_eq!((rk4.1, euler.1), (161.0, 41.0));
    assert!(rk4.0 < 1e-3 && 0.1 < euler.0, "{rk4:?} {euler:?}");
    // A step is taken as long as it is asked for.
    let scratch = Scratch::new("long-steps");
    let long = ["run", "pendulum", "--until", "2", "--method", "generalized-alpha", "--step", "0.05"];
    let text = standard_output(run_into(&scratch, &long));
    assert!(text.contains(" steps: 40, 0 rejected"), "{text}");
    assert_eq!(figure(&text, "size of the equal steps"), 0.05);
    let penalty = run(&["--method", "penalty", "--frequency", "20"]);
    assert!(1e-12 < penalty.2 && penalty.2 < 1e-6, "{penalty:?}");
}

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
        text.contains("1.142825 Hz, damping ratio 0.2781, stable") && text.contains("9.973777 Hz"),
        "{text}"
    );
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

#[test]
fn a_lost_run_is_lost_and_not_one_that_passed_a_singular_position() {
    let scratch = Scratch::new("lost");
    fs::create_dir_all(&scratch.0).expect("a directory");
    let picture = scratch.0.join("drift.svg");
    let drift = |arguments: &[&str]| {
        let out = ["--out", picture.to_str().expect("a path of the build")];
        standard_output(mbs(&[&["drift"], arguments, &out].concat()))
    };
    let lost = drift(&["bricard", "--methods", "none,baumgarte"]);
    assert!(lost.contains("ends early: the motion grows without bound"), "{lost}");
    assert!(lost.contains("is too long to follow the motion: it ends with a kinetic energy of"), "{lost}");
    assert_eq!(lost.matches("ends early: ").count(), 2, "{lost}");
    assert!(!lost.contains("not determined: "), "{lost}");
    let passed = drift(&["n_four_bar", "--methods", "baumgarte", "--until", "1"]);
    assert!(!passed.contains("ends early") && passed.contains("it passes a singular position"), "{passed}");
}

#[test]
fn obstacles_of_a_motion_are_named() {
    let scratch = Scratch::new("obstacle");
    let fails = |arguments: &[&str]| failure(run_into(&scratch, &[&["run"], arguments].concat()), 1);
    for method in [&["--method", "projection"][..], &["--method", "velocity"], &["--integrator", "rk4"]] {
        let message = fails(&[&["pendulum", "--param", "L=0"], method].concat());
        assert!(message.contains("row `rod` (line ") && message.contains("a length is 0"), "{message}");
    }
    // A bob on a massless cart falls straight down until the pole is upright.
    let light = ["cart_pole", "--param", "cart_mass=0", "--steps", "4", "--tolerance", "1e-6"];
    let message = fails(&light);
    assert!(message.contains("can move without any mass moving; give it mass"), "{message}");
    assert!(message.contains("t = 0.4515"), "{message}");
}

#[test]
fn methods_that_ran_in_place_of_independent_coordinates_are_named() {
    let scratch = Scratch::new("replaced");
    let run = |arguments: &[&str]| standard_output(run_into(&scratch, &[&["run"], arguments].concat()));
    let text = run(&["bricard", "--method", "velocity", "--steps", "2", "--until", "0.02"]);
    assert!(text.contains("method: projection onto all rows together"), "{text}");
    assert!(scratch.text("report.html").contains("projection onto all rows together"));
    // If the rod is level, x does not determine y.
    let text = run(&["pendulum", "--method", "velocity", "--steps", "4", "--until", "2"]);
    assert!(figure(&text, "independent motions chosen anew") > 0.0 && !text.contains("method: "), "{text}");
    // The default goes through blocks too, and says where it leaves them.
    let text = run(&["pendulum", "--steps", "4", "--until", "2"]);
    assert!(figure(&text, "independent motions chosen anew") > 0.0 && !text.contains("method: "), "{text}");
    assert!(
        !run(&["pendulum", "--method", "baumgarte", "--steps", "4", "--until", "2"]).contains("chosen anew")
    );
    // All rods in line, the rows lose rank.
    let text =
        run(&["n_four_bar", "--method", "velocity", "--integrator", "rk4", "--step", "1e-3", "--until", "1"]);
    assert!(figure(&text, "handed over to projection") > 0.0, "{text}");
}

#[test]
fn a_multiplier_that_is_one_choice_of_many_is_never_shown_without_a_word() {
    let scratch = Scratch::new("unique");
    let run = |arguments: &[&str]| {
        let text = standard_output(run_into(&scratch, &[&["run"], arguments].concat()));
        let values = scratch.text("motion.csv");
        let header = values.lines().next().expect("a header").to_string();
        (text, header, cells(values.lines().last().expect("a row")).pop(), scratch.text("report.html"))
    };
    let (text, header, dependent, page) = run(&["bricard", "--steps", "2", "--until", "0.02"]);
    assert!(text.contains("rows that follow from others: `joint.19` (line "), "{text}");
    assert!(
        text.lines()
            .any(|line| line.contains("lambda joint.0: ")
                && line.ends_with("not unique: the shortest of many"))
    );
    assert!(
        header.contains(",lambda joint.0 (N; not unique),") && header.ends_with(",dependent rows (1)"),
        "{header}"
    );
    assert_eq!(dependent, Some(1.0));
    assert!(page.contains("\"shared\":3") && page.contains("\"dependent_rows\":[{\"name\":\"joint.19\""));
    let (text, header, dependent, page) = run(&["pendulum", "--steps", "2", "--until", "0.02"]);
    assert!(!text.contains("not unique") && !header.contains("not unique"), "{text}{header}");
    assert!(dependent == Some(0.0) && page.contains("\"shared\":0") && !page.contains("\"dependent_rows\":"));
}

#[test]
fn options_that_an_analysis_has_no_use_for_are_refused() {
    let cases: [(&[&str], &str); 21] = [
        (&["equilibrium", "pendulum", "--until", "3"], "unexpected argument '--until'"),
        (&["equilibrium", "pendulum", "--steps", "3"], "unexpected argument '--steps'"),
        (&["equilibrium", "pendulum", "--at", "0.3"], "unexpected argument '--at'"),
        (&["simulate", "pendulum", "--guess", "P.0=1"], "unexpected argument '--guess'"),
        (&["kinematics", "four_bar", "--method", "velocity"], "unexpected argument '--method'"),
        (&["modes", "pendulum", "--at", "1", "--until", "2"], "unexpected argument '--until'"),
        (&["modes", "pendulum", "--at", "0.3", "--guess", "P.0=1"], "cannot be used with"),
        (&["modes", "pendulum", "--steps", "3"], "--at <T>"),
        (&["modes", "pendulum", "--method", "none"], "use `mbs simulate`, or `mbs modes` with `--at`"),
        (
            &["run", "four_bar", "--method", "velocity"],
            "`--method` is how a motion from forces is integrated",
        ),
        (
            &["run", "four_bar", "--integrator", "rk4"],
            "`--integrator` is how a motion from forces is integrated",
        ),
        (
            &["run", "four_bar", "--tolerance", "1e-3"],
            "`--tolerance` is how a motion from forces is integrated",
        ),
        (&["simulate", "pendulum", "--step", "0.1"], "adaptive steps take `--tolerance`"),
        (&["simulate", "pendulum", "--frequency", "3"], "belong to `--method baumgarte` or `penalty`"),
        (
            &["simulate", "pendulum", "--method", "extrapolated", "--tolerance", "1e-3"],
            "this method takes `--step`",
        ),
        (
            &["simulate", "pendulum", "--method", "extrapolated", "--integrator", "rk4"],
            "others take `--step`",
        ),
        (&["simulate", "pendulum", "--integrator", "rk4", "--tolerance", "1e-3"], "equal ones take `--step`"),
        (
            &["simulate", "pendulum", "--method", "baumgarte", "--alpha", "1e5"],
            "belongs to `--method penalty`",
        ),
        (&["simulate", "pendulum", "--method", "penalty", "--alpha", "1e9"], "at most 1e8"),
        (&["equilibrium", "pendulum", "--guess", "P=1"], "it is an array, `P.0`, `P.1`"),
        (&["equilibrium", "four_bar"], "neither masses nor forces"),
    ];
    for (arguments, words) in cases {
        let message = failure(mbs(arguments), 2);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    assert!(failure(mbs(&["modes", "pendulum", "--at", "-1"]), 2).contains("at least 0"));
    assert!(failure(mbs(&["equilibrium", "pendulum", "--guess", "P.0=far"]), 2).contains("not a number"));
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

#[test]
fn a_parameter_changes_the_motion() {
    let scratch = Scratch::new("parameter");
    standard_output(run_into(&scratch, &["run", "slider_crank", "--param", "omega=20", "--steps", "4"]));
    let values = scratch.text("motion.csv");
    let header = values.lines().next().expect("a header");
    assert!(header.starts_with("run,t (s),theta (rad),theta_d (rad/s),theta_dd (rad/s^2),"), "{header}");
    let last = cells(values.lines().last().expect("a row"));
    assert!((last[0] - core::f64::consts::TAU / 20.0).abs() < 1e-15 && (last[2] - 20.0).abs() < 1e-12);
}

#[test]
fn the_values_are_those_of_the_library_bit_by_bit() {
    let scratch = Scratch::new("bits");
    standard_output(run_into(&scratch, &["run", "four_bar", "--steps", "7"]));
    let card = mechanisms::CATALOGUE.find("four_bar").expect("in the list");
    let mechanism = card.fixed_instance(&card.runs().expect("a text")[0]).expect("a preset");
    let duration = card.duration(mechanism.as_ref()).expect("a duration");
    let motion = mbs_workbench::catalogue::sweep(mechanism.as_ref(), duration, 7).expect("it turns");
    for (row, line) in scratch.text("motion.csv").lines().skip(1).take(8).enumerate() {
        let found = cells(line);
        assert_eq!(found[0].to_bits(), motion.time[row].to_bits());
        for (index, coordinate) in motion.coordinates.iter().enumerate() {
            let expected = [coordinate.q[row], coordinate.qd[row], coordinate.qdd[row]];
            let cells = &found[1 + 3 * index..4 + 3 * index];
            assert!(
                cells.iter().zip(expected).all(|(found, expected)| found.to_bits() == expected.to_bits())
            );
        }
    }
}

#[test]
fn a_mechanism_that_cannot_be_assembled_says_so_and_leaves_no_report() {
    let scratch = Scratch::new("impossible");
    let message = failure(run_into(&scratch, &["run", "four_bar", "--param", "L2=0.05"]), 1);
    assert!(message.contains("cannot be assembled") && message.contains("closure"), "{message}");
    assert!(!scratch.0.exists());
}

/// Data of the page.
fn data(scratch: &Scratch) -> serde_json::Value {
    let page = scratch.text("report.html");
    let (_, rest) = page.split_once("id=\"data\">").expect("the data");
    serde_json::from_str(rest.split_once("</script>").expect("its end").0).expect("JSON")
}

/// The line that tells the end, of a command that fails and writes its page.
#[track_caller]
fn early_end(scratch: &Scratch, arguments: &[&str]) -> String {
    let output = run_into(scratch, arguments);
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{message}");
    // One line a run; below them the rows, each with its equation.
    let is_row =
        |line: &&str| line.trim_start().starts_with(|c: char| c.is_ascii_digit()) && line.contains(" | ");
    let (rows, runs): (Vec<&str>, Vec<&str>) = message.lines().partition(is_row);
    assert!(runs.iter().all(|line| line.contains("the motion ends at t = ")), "one line a run: {message}");
    assert!(
        !rows.is_empty() && rows.iter().all(|row| row.contains(" == ") && row.ends_with(';')),
        "{message}"
    );
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.contains("report  "), "{text}");
    let line = data(scratch)["runs"][0]["ended"].as_str().expect("an end").to_string();
    assert!(message.contains(&line), "{message} {line}");
    // Four digits, but for names and lines of the text.
    let numbers = line.split(' ').filter(|word| word.parse::<f64>().is_ok());
    let digits = |word: &str| word.trim_start_matches(['0', '.']).replace('.', "").len();
    assert!(numbers.map(digits).all(|digits| digits <= 4), "{line}");
    line
}

#[test]
fn a_mechanism_that_locks_on_its_way_has_its_page_up_to_there() {
    let scratch = Scratch::new("locks");
    // Shortest and longest link, 0.45 m + 0.75 m, exceed the two others, 1.1 m: the crank cannot pass 180°.
    let line = early_end(&scratch, &["run", "four_bar", "--param", "L1=0.45", "--param", "L4=0.75"]);
    // Coupler and rocker in line: (0.6 m + 0.5 m)² = L1² + L4² − 2 L1 L4 cos θ.
    let turn = ((0.45_f64.powi(2) + 0.75_f64.powi(2) - 1.1_f64.powi(2)) / (2.0 * 0.45 * 0.75)).acos();
    let limit = turn / core::f64::consts::TAU;
    let time = line.strip_prefix("the motion ends at t = ").and_then(|rest| rest.split(' ').next());
    let time: f64 = time.and_then(|time| time.parse().ok()).expect("a time");
    assert!((time / limit - 1.0).abs() < 1e-3, "{line}");
    assert!(line.contains("`closure.0` (line") && line.contains("`closure.1` (line"), "{line}");
    // The motion reaches to the last instant before.
    let values = scratch.text("motion.csv");
    let rows = values.lines().filter(|line| line.starts_with("open assembly")).count();
    let expected = (limit * 720.0).floor() as usize + 1;
    assert!(expected <= rows && rows <= expected + 1, "{rows} rows, {expected} before the end");
}

#[test]
fn a_crank_longer_than_its_rod_has_pages_of_motion_and_forces_up_to_the_lock() {
    // r sin θ = L + offset: 0.2 m sin 30 t = 0.19 m.
    let limit = (0.19_f64 / 0.2).asin() / 30.0;
    for arguments in [
        ["kinematics", "slider_crank", "--param", "r=0.2"],
        ["kinematics", "slider_crank_scenes:DrivenCrank", "--param", "r=0.2"],
    ] {
        let scratch = Scratch::new(&format!("lock-{}", arguments[1].replace(':', "-")));
        let line = early_end(&scratch, &arguments);
        assert!(line.starts_with(&format!("the motion ends at t = {limit:.5} s: ")), "{line}");
        let (data, rates) = (data(&scratch), |value: &serde_json::Value| value.as_f64().map(f64::abs));
        let speeds = data["runs"][0]["coordinates"][0]["qd"].as_array().expect("rates");
        assert!(speeds.iter().filter_map(rates).all(|rate| rate < 1e3), "rates beyond bounds");
    }
    let scratch = Scratch::new("lock-forces");
    let line = early_end(&scratch, &["inverse", "slider_crank_mass:Driven", "--param", "r=0.2"]);
    assert!(line.starts_with("the motion ends at t = "), "{line}");
    let torque = &data(&scratch)["runs"][0]["dynamics"]["loads"];
    assert!(torque.as_array().expect("loads").len() == 7, "{torque}");
}

#[test]
fn a_page_of_a_rest_has_its_verdict_and_the_places_of_its_reactions() {
    let scratch = Scratch::new("verdict");
    standard_output(run_into(&scratch, &["equilibrium", "four_bar_mass:Released"]));
    let data = data(&scratch);
    assert_eq!(data["analysis"], "equilibrium");
    let verdict =
        |run: usize, key: &str| data["runs"][run]["verdict"][key].as_str().expect("a verdict").to_string();
    assert_eq!([0, 1].map(|run| verdict(run, "course")), ["unstable", "marginal"]);
    let text = verdict(0, "text");
    assert!(
        text.starts_with("unstable; falls to the stable one at x2 = ") && text.contains("; e-fold 0.1"),
        "{text}"
    );
    let forces = data["forces"].as_array().expect("forces");
    let places = data["runs"][0]["places"].as_array().expect("places");
    assert_eq!(forces.len(), 4);
    for force in forces {
        let at = format!("{}.0", force["at"].as_str().expect("a place"));
        assert!(places.iter().any(|place| place["name"] == at.as_str()), "{at}");
    }
}

/// The cart's place is free: no force answers it, so it stays where the command line names it.
#[test]
fn a_coordinate_that_a_guess_names_is_held_where_no_force_moves_it() {
    for (guesses, place) in
        [(&["x=0.1"][..], "0.1 m"), (&["x=5"], "5 m"), (&["P.0=-300cm", "phi=-1"], "-3 m")]
    {
        let scratch = Scratch::new(&format!("held{}", guesses.concat()));
        let options: Vec<&str> = guesses.iter().flat_map(|guess| ["--guess", guess]).collect();
        let text = standard_output(run_into(
            &scratch,
            &[&["equilibrium", "cart_pole"], options.as_slice()].concat(),
        ));
        for name in ["x", "P.0"] {
            assert!(text.contains(&format!("  {name} at rest: {place}\n")), "{guesses:?}: {text}");
        }
    }
}

#[test]
fn an_unknown_mechanism_gets_a_proposal() {
    for command in ["run", "expand", "verify"] {
        let message = failure(mbs(&[command, "slidercrank"]), 2);
        assert!(
            message.contains("did you mean `slider_crank`?") && message.contains("open_chain"),
            "{message}"
        );
    }
}

#[test]
fn an_end_that_no_one_waits_for_is_refused_after_a_thousand_steps() {
    let message = failure(mbs(&["run", "pendulum", "--until", "1e9"]), 1);
    assert!(message.contains("t = 1e9 s is out of reach"), "{message}");
}

#[test]
fn senseless_arguments_are_refused_in_plain_words() {
    let cases: [(&[&str], &str); 35] = [
        (&["run", "four_bar", "--until", "-1"], "a number above 0"),
        (&["run", "pendulum", "--step", "-1"], "a number above 0"),
        (&["run", "pendulum", "--tolerance", "-1"], "a number above 0"),
        (&["run", "pendulum", "--tolerance", "1e-30"], "at least 3.6e-15 is possible"),
        (
            &["run", "pendulum", "--until", "0.01", "--integrator", "rk4", "--step", "1e-14"],
            "t = 0.01 s are 1.0e12, more than the 1e8 of a run",
        ),
        (&["run", "pendulum", "--until", "1e9", "--integrator", "rk4"], "let them adapt"),
        (&["run", "governor", "--until", "1e9"], "take longer ones by `--step`"),
        (&["run", "pendulum", "--steps", "-1"], "whole number"),
        (&["run", "pendulum", "--param", "m=-1"], "`mass` of `bob` is negative: -1"),
        (&["run", "quarter_car", "--param", "k.0=-5"], "`stiffness` of `"),
        (&["drift", "pendulum", "--integrator", "order5"], "use `--integrator rk4` or `euler`"),
        (&["print", "four_bar", "M"], "neither masses nor forces"),
        (&["run", "four_bar", "--steps", "0"], "at least 1"),
        (&["run", "four_bar", "--steps", "many"], "whole number"),
        (&["run", "four_bar", "--param", "omega"], "NAME=VALUE"),
        (&["run", "four_bar", "--param", "omega=nan"], "finite"),
        (&["run", "four_bar", "--param", "omega=1e999"], "finite"),
        (&["run", "four_bar", "--param", "omega=two"], "not a number"),
        (&["run", "four_bar", "--param", "omgea=2"], "did you mean `omega`?"),
        (&["run", "four_bar", "--param", "L1=60rpm"], "`L1` is in `m`, `60rpm` is in `1/s`"),
        (&["run", "four_bar", "--param", "L1=200 mm"], "write `200mm`"),
        (&["run", "four_bar", "--param", "L1=-0.1"], "a link has no negative length"),
        (&["run", "four_bar", "--param", "L1=1e-300"], "lost in rounding"),
        (&["kinematics", "slider_crank", "--param", "r=-5cm"], "a link has no negative length"),
        (&["run", "andrews", "--param", "m=1"], "it is an array, `m.0` … `m.6`"),
        (&["equilibrium", "pendulum", "--guess", "P.0=2kg"], "`P.0` is in `m`, `2kg` is in `kg`"),
        (&["run", "FOUR_BAR"], "did you mean `four_bar`?"),
        (&["run", "four-bar"], "did you mean `four_bar`?"),
        (&["four_bar"], "`mbs run four_bar`"),
        (&["Four_Bar"], "`mbs run four_bar`"),
        (&["simulat", "pendulum"], "'simulate'"),
        (&["structure", "four_bar", "--out", "x.png"], "name it FILE.svg"),
        (&["run", "four_bar", "--param", "omega=0"], "never ends"),
        (&["verify"], "required"),
        (&["verify", "four_bar", "--states", "0"], "at least 1"),
    ];
    for (arguments, words) in cases {
        let message = failure(mbs(arguments), 2);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}

#[test]
fn a_directory_that_cannot_be_made_is_named() {
    let scratch = Scratch::new("file");
    fs::create_dir_all(scratch.0.parent().expect("a directory")).expect("a directory");
    fs::write(&scratch.0, "in the way").expect("a file");
    let output = run_into(&scratch, &["run", "open_chain", "--steps", "2"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write"));
    fs::remove_file(&scratch.0).expect("the file");
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    for arguments in [&["list"][..], &["expand", "four_bar"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        // The pipe closes before the program writes, or while it does.
        drop(child.stdout.take());
        let mut message = String::new();
        let mut errors = BufReader::new(child.stderr.take().expect("piped"));
        errors.read_to_string(&mut message).expect("UTF-8");
        assert!(child.wait().expect("it ends").success(), "{message}");
        assert_eq!(message, "");
    }
}

#[test]
fn a_reader_that_leaves_still_gets_the_report() {
    let scratch = Scratch::new("pipe");
    let mut child = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
        .args(["run", "open_chain", "--steps", "2", "--out"])
        .arg(&scratch.0)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(scratch.text("motion.csv").lines().count(), 4);
}

#[test]
fn a_page_shows_long_motions_thinned_and_the_values_whole() {
    let scratch = Scratch::new("long");
    standard_output(run_into(&scratch, &["run", "open_chain", "--steps", "5000"]));
    assert_eq!(scratch.text("motion.csv").lines().count(), 5002);
    let page = scratch.text("report.html");
    let (_, rest) = page.split_once("id=\"data\">").expect("the data");
    let json = rest.split_once("</script>").expect("its end").0;
    let data: serde_json::Value = serde_json::from_str(json).expect("JSON");
    let times = data["runs"][0]["time"].as_array().expect("instants");
    assert_eq!(times.len(), 2000);
    assert_eq!((times.first(), times.last()), (Some(&0.0.into()), Some(&1.0.into())));
}

#[test]
fn the_emitted_code_is_printed() {
    let text = standard_output(mbs(&["expand", "four_bar"]));
    for part in ["pub struct FourBar", "fn phi_q", "fn gamma", "impl"] {
        assert!(text.contains(part), "{part} is missing");
    }
    assert!(text.lines().count() > 100);
}

#[test]
fn verify_confirms_every_mechanism_by_its_name() {
    let text = standard_output(mbs(&["verify", "--all", "--states", "2"]));
    assert!(!text.contains("DIFFERS"), "{text}");
    for name in ["CamLaw", "FourBar", "Andrews"] {
        assert!(text.contains(name), "{name}: {text}");
    }
}

#[test]
fn verify_prints_the_largest_error_of_each_function() {
    let text = standard_output(mbs(&["verify", "slider_crank"]));
    for part in ["SliderCrank at 1000 states", "Φ_q", "Φ_tt", "γ", "d² output/dt²", "agrees (bound 1e-13)"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let first = BufReader::new(text.as_bytes()).lines().next().expect("a line").expect("UTF-8");
    assert!(first.contains("as a part of the row's scale"));
}

#[test]
fn verify_without_python_names_the_cure() {
    let output = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
        .args(["verify", "four_bar"])
        .env("MBS_PYTHON", "no-such-python")
        .output()
        .expect("the program starts");
    let message = failure(output, 1);
    assert!(message.contains("install Python 3") && message.contains("MBS_PYTHON"), "{message}");
}

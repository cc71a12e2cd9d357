//! Motions from forces: methods, values, and what a run tells beside them.

use super::*;

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
fn a_decay_that_bounds_the_steps_of_an_explicit_method_is_told_with_its_cure() {
    let told = |options: &[&str]| {
        let scratch = Scratch::new(&format!("stiff{}", options.concat().replace(' ', "")));
        let run = ["run", "quarter_car", "--until", "0.4", "--steps", "16"];
        let text = standard_output(run_into(&scratch, &[&run, options].concat()));
        text.lines().find(|line| line.trim_start().starts_with("stiff")).map(str::to_string)
    };
    // The damper takes the difference of both velocities away in 1/(c/40 kg + c/300 kg).
    let damper = ["--param", "c=1e5"];
    let line = told(&damper).expect("a stiff motion");
    assert!(line.contains("decays in 0.00035 s") && line.contains("`--method radau`"), "{line}");
    assert_eq!(told(&[]), None);
    assert_eq!(told(&[&damper[..], &["--method", "radau"]].concat()), None);
}

//! Pages: of a motion up to its end, of a rest, of long motions.

use super::*;

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

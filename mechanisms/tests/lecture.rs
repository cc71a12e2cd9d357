//! The teaching commands of `mbs`, called as a user calls them.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A file of this test alone, removed with its owner.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        Scratch(
            PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("lecture-{}-{name}", std::process::id())),
        )
    }

    fn path(&self) -> &str {
        self.0.to_str().expect("a path of the build")
    }

    fn text(&self) -> String {
        fs::read_to_string(&self.0).expect("the file was written")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn mbs(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mbs-catalogue")).args(arguments).output().expect("the program starts")
}

#[track_caller]
fn text_of(arguments: &[&str]) -> String {
    let output = mbs(arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[track_caller]
fn failure(arguments: &[&str], code: i32) -> String {
    let output = mbs(arguments);
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(!message.contains("panicked"), "{message}");
    message
}

#[track_caller]
fn line<'a>(text: &'a str, start: &str) -> &'a str {
    text.lines()
        .find(|line| line.trim_start().starts_with(start))
        .unwrap_or_else(|| panic!("{start}:\n{text}"))
}

/// The numbers of a line, without its other words.
#[track_caller]
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn print_shows_the_numbers_of_the_library() {
    let text = text_of(&["print", "four_bar", "--at", "0.1"]);
    for part in ["at t = 0.1 s", "Phi\n", "Phi_q\n", "Phi_t\n", "gamma\n", "closure.0 (m/s^2)"] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let crank = text.lines().filter(|line| line.trim_start().starts_with("crank"));
    let crank: Vec<Vec<f64>> = crank.map(numbers).collect();
    assert_eq!(crank[1], [0.0, 0.0, 1.0, 0.0, 0.0]);
    assert!((crank[2][0] + core::f64::consts::TAU).abs() < 1e-6);
    let text = text_of(&["print", "four_bar", "q", "--at", "0.125", "--param", "omega=4"]);
    assert_eq!(numbers(line(&text, "phi1 (rad)")), [0.5]);
    assert!(!text.contains("gamma"));
}

#[test]
fn print_shows_formulas_with_the_names_of_the_text() {
    let text = text_of(&["print", "four_bar", "--symbols", "phi_q", "GAMMA"]);
    let closure: Vec<&str> = line(&text, "closure.0").split_whitespace().collect();
    assert_eq!(closure, ["closure.0", "0", "0", "L1*sin(phi1)", "L2*sin(phi2)", "-L3*sin(phi3)"]);
    assert!(text.contains("- L1*phi1'^2*cos(phi1)"), "{text}");
    assert!(!text.contains("Phi_t"));
}

/// Stride through the catalogue: every mechanism with the feature `long`, else every third.
const STRIDE: usize = if cfg!(feature = "long") { 1 } else { 3 };

#[test]
fn free_mechanisms_have_formulas_structure_matrices_and_degrees_of_freedom() {
    for card in mechanisms::CATALOGUE.free().step_by(STRIDE) {
        let (name, title) = (card.name(), card.picture().expect("a text").title);
        assert!(text_of(&["print", &name, "--symbols"]).contains(&title));
        let text = text_of(&["print", &name, "q", "qd", "qdd", "Phi"]);
        assert!(text.contains("qdd") && !text.contains("NaN"), "{text}");
        assert!(text_of(&["structure", &name]).contains("Phi_q"), "{name}");
        let text = text_of(&["dof", &name]);
        assert!(text.contains("forces move the others") && text.contains("joints and guides take"), "{text}");
        assert!(text_of(&["latex", &name]).ends_with("\\end{document}\n"));
    }
    // Rows that may follow from others have no blocks; of the others one coordinate is left.
    let drawn = Scratch::new("bricard.svg");
    let text = text_of(&["structure", "bricard", "--out", drawn.path()]);
    assert!(text.contains("solved together: all 23 rows") && !text.contains("block after block"), "{text}");
    assert!(drawn.text().contains("all are solved together") && drawn.text().contains(">last<"));
    assert!(text_of(&["structure", "andrews"]).contains("independent: beta, which forces move"));
    // Two points of two coordinates each, two rods.
    let text = text_of(&["dof", "double_pendulum"]);
    assert!(line(&text, "degrees of freedom").ends_with("= 2"), "{text}");
    assert!(line(&text, "Grübler's count").ends_with("= 2"), "{text}");
    // A quarter of a second on, forces have moved it.
    let [start, later] = ["0", "0.25"].map(|t| text_of(&["print", "double_pendulum", "q", "--at", t]));
    assert!(start.lines().skip(1).ne(later.lines().skip(1)), "{later}");
    let message = failure(&["print", "double_pendulum", "--at", "-1"], 2);
    assert!(message.contains("from 0 s"), "{message}");
}

#[test]
fn every_mechanism_has_formulas_structure_and_degrees_of_freedom() {
    for card in mechanisms::CATALOGUE.fixed().step_by(STRIDE) {
        let (name, title) = (card.name(), card.picture().expect("a text").title);
        assert!(text_of(&["print", &name, "--symbols"]).contains(&title));
        assert!(text_of(&["structure", &name]).contains("solved block after block"), "{name}");
        let text = text_of(&["dof", &name]);
        assert!(text.contains("every coordinate is determined"), "{name}: {text}");
        assert!(text_of(&["latex", &name]).ends_with("\\end{document}\n"));
    }
}

#[test]
fn latex_writes_a_document_to_a_file() {
    let file = Scratch::new("four_bar.tex");
    assert!(text_of(&["latex", "four_bar", "--out", file.path()]).starts_with("document  "));
    let text = file.text();
    for part in
        ["\\documentclass", "\\varphi_{1}", "L_{5}\\,\\sin\\left(\\alpha + \\varphi_{2}\\right)", "\\gamma"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}

#[test]
fn structure_prints_the_order_and_draws_it() {
    let file = Scratch::new("structure.svg");
    let text = text_of(&["structure", "four_bar", "--out", file.path()]);
    assert!(line(&text, "1.").contains("phi1 from crank (explicit"), "{text}");
    assert!(line(&text, "2.").contains("phi2, phi3 from closure.0, closure.1 (2 × 2"), "{text}");
    assert!(line(&text, "crank").contains("[1]"), "{text}");
    let svg = file.text();
    assert!(svg.starts_with("<svg") && svg.matches("class=\"block\"").count() == 4, "{svg}");
}

#[test]
fn newton_prints_quadratic_convergence_and_the_assembly() {
    let text = text_of(&["newton", "four_bar"]);
    for part in
        ["1. phi1 = 0 rad, assigned from crank", "2. phi2, phi3 from closure", "branch assembly", "holds"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let plain = text_of(&["newton", "four_bar", "--plain", "--guess", "phi2=-0.9", "--guess", "phi3=-1.6"]);
    assert!(plain.contains("on all 5 rows") && plain.contains("does not hold: another assembly"), "{plain}");
    let iteration = |k: usize| numbers(line(&plain, &format!("{k} ")));
    let residuals = [0, 1, 2, 3].map(|k| iteration(k)[1]);
    assert!(residuals.windows(2).all(|pair| pair[1] < pair[0]), "{residuals:?}");
}

#[test]
fn newton_says_what_assemble_does_by_formulas() {
    let text = text_of(&["newton", "four_bar", "--guess", "phi2=-0.9", "--guess", "phi3=-1.6"]);
    let taken = line(&text, "dyad of two bars: phi2 = 0.98415");
    assert!(
        taken.ends_with("(taken)") && text.contains("phi2 = -0.98415 rad, phi3 = -1.606518 rad (the other)"),
        "{text}"
    );
    let text = text_of(&["newton", "three_rrr"]);
    assert!(!text.contains("`assemble`"), "no block of it is a dyad: {text}");
    for guess in ["phi2=1e300", "phi2=-1e17", "x2=1e300"] {
        for more in [&[][..], &["--plain"]] {
            let message = failure(&[&["newton", "four_bar", "--guess", guess], more].concat(), 1);
            assert!(message.contains("too large for its number type"), "{guess}: {message}");
        }
    }
    failure(&["newton", "four_bar", "--guess", "phi2=nan"], 2);
    failure(&["newton", "four_bar", "--guess", "phi2=inf"], 2);
}

#[test]
fn newton_that_finds_nothing_shows_its_way_and_fails() {
    let output = mbs(&["newton", "four_bar", "--param", "L2=0.05"]);
    assert_eq!(output.status.code(), Some(1));
    let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("iteration") && text.contains("Levenberg"), "{text}");
    assert!(text.contains("dyad of two bars: phi2, phi3 have no position"), "{text}");
    assert!(errors.contains("no position at t = 0 s") && errors.contains("closure"), "{errors}");
}

#[test]
fn basins_draws_three_maps_and_prints_their_shares() {
    let file = Scratch::new("basins.svg");
    let text = text_of(&["basins", "four_bar", "--size", "20", "--out", file.path()]);
    assert!(text.contains("20 × 20 guesses of phi2 and phi3"), "{text}");
    let declared = line(&text, "phi2 = 56.39°, phi3 = 92.05° (the declared assembly)");
    assert!(declared.trim_end().ends_with("100.0 %"), "{declared}");
    let svg = file.text();
    for part in
        ["full Newton–Raphson", "assemble, no branch", "assemble, branch declared", "no assembly found"]
    {
        assert!(svg.contains(part) && text.contains(part.trim_end()), "{part} is missing");
    }
    let text =
        text_of(&["basins", "four_bar", "--size", "4", "--x", "phi3", "--y", "x2", "--out", file.path()]);
    assert!(text.contains("guesses of phi3 and x2"), "{text}");
}

#[test]
fn the_picture_of_the_basins_stays_small() {
    let file = Scratch::new("large.svg");
    text_of(&["basins", "four_bar", "--size", "100", "--out", file.path()]);
    // Runs along a row: at 100 they are shortest against the size, and 400 has at most 16 times as many.
    assert!(file.text().len() * 16 < 2_000_000, "{} bytes", file.text().len());
}

#[test]
fn next_compares_the_ways_to_the_next_position() {
    let text = text_of(&["next", "four_bar", "--starts", "6"]);
    let first = line(&text, "0.00139 s");
    assert_eq!(first.matches("6/0/0").count(), 3, "{first}");
    let safe = text.split_once("largest step").expect("the last part").1;
    let degrees = |way: &str| {
        let line = line(safe, way);
        let number = line.split_once('=').expect("degrees").1.split('°').next().expect("a number");
        number.trim().parse::<f64>().expect("a number")
    };
    assert!(degrees("previous") > 10.0 && degrees("stepper") >= degrees("previous"), "{safe}");
}

#[test]
fn dof_names_independent_and_dependent_coordinates() {
    let text = text_of(&["dof", "four_bar", "--at", "0.2"]);
    assert!(line(&text, "rows m").contains("5 (4 of constraints, 1 of drives)"), "{text}");
    assert!(line(&text, "degrees of freedom").ends_with("5 − 4 = 1"), "{text}");
    assert!(line(&text, "independent").ends_with(" phi1"), "{text}");
    assert!(text.contains("Chosen, for the text names none"), "{text}");
    assert!(line(&text, "dependent").ends_with(" x2, y2, phi2, phi3"), "{text}");
    assert!(line(&text, "Grübler's count").ends_with("5 − 4 = 1"), "{text}");
    // Joints of the declared bodies take the freedoms that the rows do not: four pins.
    let text = text_of(&["dof", "four_bar_mass:Driven"]);
    assert!(text.contains("9 freedoms apart; joints and guides take 8"), "{text}");
}

#[test]
fn compare_shows_the_same_motion_in_four_kinds_of_coordinates() {
    let text = text_of(&["compare", "four_bar", "--steps", "60"]);
    for name in ["four_bar ", "four_bar_reference_point", "four_bar_natural", "four_bar_mixed"] {
        assert!(line(&text, name).contains("µs"), "{text}");
    }
    assert_eq!(text.matches("of the largest").count(), 3, "{text}");
    let text = text_of(&["compare", "four_bar", "--steps", "8", "--coordinates", "natural,mixed"]);
    assert_eq!(text.matches("of the largest").count(), 1, "{text}");
}

#[test]
fn drift_draws_a_curve_a_method_and_prints_how_far_each_went() {
    let file = Scratch::new("drift.svg");
    let text = text_of(&["drift", "pendulum", "--steps", "500", "--out", file.path()]);
    let largest = |method: &str| numbers(line(&text, method))[0];
    let [none, baumgarte, projection] = ["none", "baumgarte", "projection"].map(largest);
    assert!(none > 10.0 * baumgarte && baumgarte > 1e3 * projection && projection < 1e-13, "{text}");
    assert_eq!(file.text().matches("<polyline").count(), 6);
    let message = failure(&["drift", "four_bar"], 2);
    assert!(message.contains("neither masses nor forces"), "{message}");
}

#[test]
fn drift_of_a_loop_against_the_count_shows_what_lasts_and_where_the_others_are_lost() {
    let file = Scratch::new("drift-bricard.svg");
    let text = text_of(&["drift", "bricard", "--until", "0.5", "--steps", "50", "--out", file.path()]);
    let [phi, _, defect, evaluations] = numbers(line(&text, "projection"))[..] else { panic!("{text}") };
    assert!(phi < 1e-13 && defect < 1e-6 && evaluations == 201.0, "{text}");
    // Neither of the others can hold rows together that follow from each other on the constraints alone.
    assert_eq!(text.matches("ends early").count(), 2, "{text}");
    assert_eq!(text.matches("do not beside them").count(), 2, "{text}");
    let picture = file.text();
    assert!(picture.contains(">none, lost at") && picture.contains(">baumgarte, lost at"), "{picture}");
    assert!(picture.contains(">projection</text>") && !picture.contains(">1e0</text>"), "{picture}");
}

#[test]
fn senseless_arguments_are_refused_in_plain_words() {
    let cases: [(&[&str], &str); 19] = [
        (&["print", "fourbar"], "did you mean `four_bar`?"),
        (&["print", "four_bar", "Phi_x"], "possible values"),
        (&["print", "four_bar", "--at", "nan"], "not a finite number"),
        (&["print", "four_bar", "--symbols", "--numbers"], "cannot be used with"),
        (&["newton", "four_bar", "--guess", "phi9=1"], "has no coordinate `phi9`"),
        (&["newton", "four_bar", "--guess", "phi2"], "NAME=VALUE"),
        (&["basins", "four_bar", "--x", "phj2"], "did you mean `phi2`?"),
        (&["basins", "four_bar", "--x", "phi2", "--y", "phi2"], "two coordinates"),
        (&["basins", "four_bar", "--size", "0"], "at least 1"),
        (&["basins", "four_bar", "--size", "4000"], "at most 400"),
        (&["next", "four_bar", "--starts", "0"], "at least 1"),
        (&["next", "four_bar", "--param", "omega=0"], "never ends"),
        (&["compare", "four_bar", "--coordinates", "polar"], "coordinates of the kind `polar`"),
        (&["compare", "four_bar", "--coordinates", "natral"], "did you mean `natural`?"),
        (&["compare", "jansen"], "one set of coordinates; several have: `mbs compare four_bar`"),
        (&["compare", "four_bar_natural"], "`four_bar` in coordinates of the kind `natural`"),
        (&["compare", "natral"], "no mechanism `natral`"),
        (&["print", "slider_crank_scenes"], "name one: `slider_crank_scenes:DrivenCrank`"),
        (&["dof"], "required"),
    ];
    for (arguments, words) in cases {
        let message = failure(arguments, 2);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let file = Scratch::new("in-the-way");
    fs::write(&file.0, "").expect("a file");
    let beneath = format!("{}/structure.svg", file.path());
    let message = failure(&["structure", "four_bar", "--out", &beneath], 1);
    assert!(message.contains("cannot write") && message.contains("structure.svg"), "{message}");
}

#[test]
fn a_position_beyond_a_limit_says_when_the_mechanism_locks() {
    let message =
        failure(&["print", "four_bar", "--at", "0.5", "--param", "L1=0.45", "--param", "L4=0.75"], 1);
    assert!(message.contains("four_bar: ") && message.contains("t = "), "{message}");
}

#[test]
fn masses_forces_multipliers_and_energies_are_printed_too() {
    let text = text_of(&["print", "pendulum", "M", "Q", "lambda", "energy"]);
    // Level and at rest: the rod carries no force.
    for line in
        ["P.0  1.000000         0", "P.1  -9.810000", "rod (N/m)  0", "kinetic (J)    0", "potential (J)  0"]
    {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
    let text = text_of(&["print", "pendulum", "M", "Q", "energy", "--symbols"]);
    for line in ["P.1  0    m", "P.1  -g*m", "potential  g*m*P.1"] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
}

#[test]
fn energies_that_no_body_counts_are_told() {
    let text = text_of(&["dof", "n_four_bar"]);
    assert!(text.contains("5 point masses have 10 freedoms apart; joints and guides take 9"), "{text}");
    assert!(text.contains("energy of its own (`kinetic`)"), "{text}");
}

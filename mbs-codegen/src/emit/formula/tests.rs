use crate::diagnostics::Diagnostics;
use crate::emit::formula::formulas as print;
use crate::emit::formula::notation::Notation;
use crate::equations::{Equations, derive};
use crate::symbolic::{Leaf, NodeId, evaluate::evaluate};
use crate::{Formulas, formulas, latex_formulas};

const FOUR_BAR: &str = "mechanism FourBar;
    param L1: m = 0.2; param L2: m = 0.6; param L3: m = 0.5; param L4: m = 0.55; param L5: m = 0.35;
    param alpha: rad = 30deg; param omega: rad/s = 1;
    coord x2: m; coord y2: m; coord phi1: rad; coord phi2: rad = 0.9; coord phi3: rad = 1.8;
    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;";

/// Entries of one row `entry` of one coordinate `x` with a parameter `a`.
fn row(entry: &str) -> Formulas {
    formulas(&text(entry), None).expect("a good text")
}

fn text(entry: &str) -> String {
    format!("mechanism M; param a: 1 = 2; param b: 1 = 3; coord x: 1; constraint c {{ {entry} == 0; }}")
}

#[test]
fn the_four_bar_reads_as_on_the_slides() {
    let found = formulas(FOUR_BAR, None).expect("a good text");
    assert_eq!(
        found.phi,
        [
            "x2 - L1*cos(phi1) - L5*cos(alpha + phi2)",
            "y2 - L1*sin(phi1) - L5*sin(alpha + phi2)",
            "L4 + L3*cos(phi3) - L1*cos(phi1) - L2*cos(phi2)",
            "L1*sin(phi1) + L2*sin(phi2) - L3*sin(phi3)",
            "phi1 - omega*t",
        ]
    );
    assert_eq!(found.phi_q[2], ["0", "0", "L1*sin(phi1)", "L2*sin(phi2)", "-L3*sin(phi3)"]);
    assert_eq!(found.phi_t, ["0", "0", "0", "0", "-omega"]);
    assert_eq!(found.gamma[3], "L1*phi1'^2*sin(phi1) + L2*phi2'^2*sin(phi2) - L3*phi3'^2*sin(phi3)");
    assert_eq!(found.gamma[4], "0");
}

#[test]
fn latex_reads_as_on_the_slides() {
    let found = latex_formulas(FOUR_BAR, None).expect("a good text");
    assert_eq!(found.coordinates[2..], ["\\varphi_{1}", "\\varphi_{2}", "\\varphi_{3}"]);
    assert_eq!(found.phi_q[0][3], "L_{5}\\,\\sin\\left(\\alpha + \\varphi_{2}\\right)");
    assert_eq!(found.rows[0], "\\mathrm{coupler\\_point.0}");
    let expected = "L_{1}\\,\\dot{\\varphi}_{1}^{2}\\,\\sin \\varphi_{1}";
    assert!(found.gamma[3].starts_with(expected), "{}", found.gamma[3]);
}

#[test]
fn functions_of_an_array_have_their_numbers() {
    let text = "mechanism M; function lift: [1; 12](1), C3; coord x: 1; constraint c { lift[0](x) + lift[11].d1(2*x) == 0; }";
    let found = formulas(text, None).expect("a good text");
    assert_eq!(found.phi, ["lift[0](x) + lift[11]'(2*x)"]);
    assert_eq!(found.phi_q[0], ["lift[0]'(x) + 2*lift[11]''(2*x)"]);
    let found = latex_formulas(text, None).expect("a good text");
    let expected = "\\mathit{lift}_{0}\\left(x\\right) + \\mathit{lift}_{11}'\\left(2\\,x\\right)";
    assert_eq!(found.phi, [expected]);
}

#[test]
fn parentheses_stand_only_where_they_are_needed() {
    let cases = [
        ("x - (a - b)", "x - a + b"),
        ("(x + a)*b", "b*(a + x)"),
        ("-(x + a)*b", "-b*(a + x)"),
        ("x/(a*b)", "x/(a*b)"),
        ("x/a/b", "x/(a*b)"),
        ("x/(a + b)", "x/(a + b)"),
        ("(x + a)^2", "(a + x)^2"),
        ("x*x*x", "x^3"),
        ("sin(x)^2/x", "sin(x)^2/x"),
        ("1/x", "1/x"),
        ("x^a", "x^a"),
        ("x^2.5", "x^2.5"),
        ("x^(a - b)", "x^(a - b)"),
        ("(x + 1)^a", "(x + 1)^a"),
        ("x - 90deg", "x - PI/2"),
        ("x + 30deg", "x + PI/6"),
        ("x*2*PI", "2*PI*x"),
        ("x/3 + 0.25", "x/3 + 0.25"),
        ("atan2(x, a)", "atan2(x, a)"),
        ("x*a + 2*a*x - b", "3*a*x - b"),
        ("x - x + a", "a"),
        ("x - x", "0"),
        ("dot([x, a], [x, a])", "x^2 + a^2"),
    ];
    for (entry, expected) in cases {
        // The operands of a sum are in the order of their first occurrence in the text.
        assert_eq!(row(entry).phi, [expected], "{entry}");
    }
}

#[test]
fn powers_of_powers_stay_unambiguous() {
    assert_eq!(row("x^2").phi_q, [["2*x"]]);
    assert_eq!(row("(x^a)*(x^a)").phi, ["(x^a)^2"]);
    let latex = latex_formulas(&text("(x^a)*(x^a)"), None).expect("a good text");
    assert_eq!(latex.phi, ["\\left({x}^{a}\\right)^{2}"]);
}

#[test]
fn rates_of_inputs_go_by_the_name_of_the_input() {
    let source = "mechanism M; input theta: rad, rates; coord x: rad; drive d: x == theta;";
    let found = formulas(source, None).expect("a good text");
    assert_eq!((found.phi_t, found.phi_tt), (vec!["-theta'".into()], vec!["-theta''".into()]));
    let latex = latex_formulas(source, None).expect("a good text");
    assert_eq!(latex.gamma, ["\\ddot{\\theta}"]);
}

/// Φ trebles thirty times over: as a tree it has 3³⁰ leaves.
#[test]
fn huge_trees_get_names_for_their_parts() {
    let mut source = String::from("mechanism M; coord x: 1; let a0 = x;");
    for k in 1..=30 {
        source += &format!("let a{k} = a{}*sin(a{}) + cos(a{});", k - 1, k - 1, k - 1);
    }
    let found = formulas(&(source + "constraint c { a30 == 1; }"), None).expect("a good text");
    let whole: usize = found.definitions.iter().map(|(_, text)| text.len()).sum();
    assert!(found.definitions.len() > 10 && whole < 100_000, "{whole}");
    assert!(found.definitions.iter().enumerate().all(|(k, (name, _))| *name == format!("e{}", k + 1)));
}

#[test]
fn a_long_sum_is_cut_into_parts() {
    let source = "mechanism M; coord x: 1; constraint c { sum(i in 0..3000: sin(i*x)) == 0; }";
    let found = formulas(source, None).expect("a good text");
    assert!(!found.definitions.is_empty() && found.phi[0].len() < 2000);
}

#[test]
fn latex_is_balanced() {
    let entries =
        ["abs(x)", "min(x, a)", "sqrt(x + a)/b", "exp(-x^2.5)", "sign(x)*hypot(x, a)", "asin(x)/1e-9"];
    for entry in entries {
        let found = latex_formulas(&text(entry), None).expect("a good text");
        for text in found.phi.iter().chain(&found.phi_q[0]).chain(&found.gamma) {
            let count = |part: &str| text.matches(part).count();
            assert_eq!((count("{"), count("\\left")), (count("}"), count("\\right")), "{text}");
            assert_eq!(count("\\begin"), count("\\end"), "{text}");
        }
    }
}

#[test]
fn faults_come_back_with_their_places() {
    let fault = formulas("mechanism M; coord x: rad; drive d: y == 0;", None).expect_err("y is unknown");
    assert!(fault.contains("`y`"), "{fault}");
    assert!(latex_formulas("(", None).is_err() && crate::structure_of("", None).is_err());
}

#[test]
fn the_structure_of_the_four_bar() {
    let found = crate::structure_of(FOUR_BAR, None).expect("a good text");
    let blocks: Vec<(&[usize], &[usize], bool)> =
        found.blocks.iter().map(|b| (&b.rows[..], &b.coordinates[..], b.explicit)).collect();
    let expected: [(&[usize], &[usize], bool); 4] =
        [(&[4], &[2], true), (&[2, 3], &[3, 4], false), (&[0], &[0], true), (&[1], &[1], true)];
    assert_eq!(blocks, expected);
    assert_eq!(
        found.rows.iter().map(|row| row.driven).collect::<Vec<_>>(),
        [false, false, false, false, true]
    );
    assert_eq!(found.rows[0].entries[0], (0, crate::EntryKind::Number));
    assert!(found.rows.iter().all(|row| row.matched.is_some()) && found.operations > 20);
}

#[test]
fn a_text_that_is_not_square_is_a_fault_of_the_structure_alone() {
    let source = "mechanism M; coord x: rad; coord y: rad; constraint c { x + y == 0; }";
    assert!(crate::structure_of(source, None).expect_err("one row short").contains("1 row"));
    assert_eq!(formulas(source, None).expect("formulas need no square").phi, ["x + y"]);
}

#[test]
fn texts_cut_off_anywhere_are_faults_and_no_panics() {
    for end in 0..FOUR_BAR.len() {
        let cut = &FOUR_BAR[..end];
        let faults = [
            formulas(cut, None).err(),
            latex_formulas(cut, None).err(),
            crate::structure_of(cut, None).err(),
        ];
        assert!(faults[2].is_some() || end > FOUR_BAR.len() - 2, "{cut}");
        assert_eq!(faults[0], faults[1]);
    }
}

/// Declarations of all that the rows below use, velocities as coordinates of their own.
const NAMES: &str = "param a: 1 = 2; param b: 1 = 3; param w: 1/s = 1;
    coord x: 1 = 0.1; coord y: 1 = 0.1; coord phi: rad = 0.1; coord x_d: 1/s = 0.1; coord y_d: 1/s = 0.1; coord phi_d: rad/s = 0.1;";

fn equations_of(rows: &str) -> (crate::model::Model, Equations) {
    let mut diagnostics = Diagnostics::default();
    let source = format!("mechanism M; {NAMES} constraint c {{ {rows}; }}");
    let (_, mut scenes) = crate::model::scenes::read_source(&source, &mut diagnostics).expect("a good text");
    let model = scenes.scenes.remove(0).model;
    assert!(diagnostics.is_empty(), "{rows}: {}", diagnostics.to_text());
    let equations = derive(&model);
    (model, equations)
}

/// Some number for each leaf; the velocity of coordinate k is that of coordinate k + 3.
fn value(leaf: Leaf) -> f64 {
    match leaf {
        Leaf::Parameter(k) => 0.7 + 0.4 * f64::from(k),
        Leaf::Position(k) => 0.35 + 0.17 * f64::from(k),
        Leaf::Velocity(k) => value(Leaf::Position(k + 3)),
        _ => 0.6,
    }
}

#[test]
fn formulas_read_back_have_the_value_of_the_graph() {
    let rows = [
        "y - b*sin(phi)*(x - 2)^2/(a + x) == 0",
        "sqrt(a + x^2)*atan2(y, b)/3 - (x - (a - cos(phi)/x)) == 0",
        "dot([y, b], [y, b])/(b*(y - 2*b))^2 - a*b^2/y^2 == 0",
        "cosh(y)*tanh(x)/y + ln(x)*exp(-a*x) - (x + 1)^(a + x) == 0",
        "phi - w*t - 30deg - sin(w*t*x)/PI == 0",
        "-(x - a)*-(x + a)/-(2*x)^-3 - asin(x/a)^2 == 0",
    ];
    for row in rows {
        let (model, equations) = equations_of(row);
        let text = print(&model, &equations, "M", Notation::Text);
        let own = &equations.rows[0];
        let roots = [Some(own.phi), own.phi_t, own.phi_tt, own.phi_qt_qd, own.gamma];
        let mut pairs: Vec<(Option<NodeId>, &String)> = roots
            .into_iter()
            .zip([&text.phi, &text.phi_t, &text.phi_tt, &text.phi_qt_qd, &text.gamma].map(|t| &t[0]))
            .collect();
        pairs.extend(own.phi_q.iter().map(|(column, entry)| (Some(*entry), &text.phi_q[0][*column])));
        for (root, formula) in pairs {
            let Some(root) = root else {
                assert_eq!(formula, "0");
                continue;
            };
            let written = spelled_out(formula, &text.definitions);
            let (_, read) = equations_of(&format!("{written} == 0"));
            let found = evaluate(&read.graph, &[read.rows[0].phi], value)[0];
            let expected = evaluate(&equations.graph, &[root], value)[0];
            let error = (found - expected).abs() / expected.abs().max(1.0);
            assert!(error < 1e-12, "{row}: {formula}: {found} instead of {expected}");
        }
    }
}

/// Formula in the language: rates by their coordinates' names, parts in place of their names.
fn spelled_out(formula: &str, definitions: &[(String, String)]) -> String {
    let mut text = formula.to_string();
    for (name, meaning) in definitions.iter().rev() {
        text = text.replace(name.as_str(), &format!("({meaning})"));
    }
    text.replace('\'', "_d")
}

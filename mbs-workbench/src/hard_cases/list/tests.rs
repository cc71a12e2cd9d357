use super::*;
use crate::hard_cases::course::Course;
use crate::hard_cases::list::description::MethodKind;
use crate::hard_cases::oracle::{Oracle, OracleState};
use crate::hard_cases::similarity::Similarity;
use crate::hard_cases::variation::{Class, Variation, VariedParts};
use crate::hard_cases::verdict::{Outcome, Verdict};
use crate::setting::MotionMethod;

const SPRING: &str = "mechanism Spring; coord x: m = 1; body bob { mass: 1, com: [x, 0] } \
                      tsda spring { from: [-1, 0], to: [x, 0], stiffness: 1, length: 1 } out off: m = x - 1m*cos(t/1s);";

fn description(more: &str) -> Description {
    let text = format!(
        "title = 'a'\norigin = 'b'\nwhy = 'c'\nelsewhere = 'd'\nhere = 'e'\n{more}\n[bounds]\nadaptive = 1e-6\nsingle = 1e-3\n"
    );
    Description::read(&text).unwrap_or_else(|fault| panic!("{fault}"))
}

fn outcome(verdict: Verdict, reason: &str) -> Outcome {
    Outcome {
        case: String::new(),
        seed: 0,
        class: Class::Steps,
        method: "Projection with DormandPrince8".to_string(),
        variant: String::new(),
        verdict,
        error: Some(1e-9),
        bound: Some(1e-3),
        reason: reason.to_string(),
        is_expected: false,
        not_made: Vec::new(),
        work: 1,
        course: Course::default(),
    }
}

fn variation(finer: f64) -> Variation {
    let subject = VariedParts { classes: vec![Class::Steps], ..VariedParts::default() };
    Variation { finer, similarity: Similarity { power: 0 }, ..Variation::of(0, &subject) }
}

/// Exact states of the spring, `off` (m) beside it.
fn states(off: f64) -> Vec<OracleState> {
    let state = |k: u32| {
        let t = 0.1 * f64::from(k);
        OracleState {
            t,
            q: vec![t.cos() + off],
            qd: vec![-t.sin()],
            qdd: vec![-t.cos()],
            ..OracleState::default()
        }
    };
    (0..20).map(state).collect()
}

fn judged(case: &Description, off: f64, finer: f64) -> Outcome {
    let oracle = Oracle::read(SPRING, None, &|_| None).expect("a text");
    let outcome = outcome(Verdict::Right, "");
    case.judged(outcome, MethodKind::Adaptive, &variation(finer), (&states(off), &oracle))
}

#[test]
fn every_case_has_a_text_of_its_name_with_bounds_and_known_values() {
    let cases = cases().unwrap_or_else(|fault| panic!("{fault}"));
    assert!(cases.len() > 25, "{}", cases.len());
    for case in &cases {
        let words: Vec<&str> = case.text.split(|letter: char| !letter.is_alphanumeric()).collect();
        let is_named = words.windows(2).any(|pair| pair[0] == "mechanism" && pair[1] == case.type_name());
        assert!(is_named, "{} declares no {}", case.name, case.type_name());
        let Description { bounds, known, tables, refused, why, elsewhere, here, .. } = &case.description;
        let is_known = !known.is_empty() || !tables.is_empty();
        let is_judged = !bounds.is_empty() && is_known;
        assert!(
            is_judged != refused.is_some(),
            "{} has either bounds and known values, or a refusal",
            case.name
        );
        assert!(bounds.values().all(|bound| *bound > 0.0), "{}", case.name);
        for name in case.description.few.iter().flat_map(|few| &few.methods) {
            assert!(
                MotionMethod::all().iter().any(|method| method.to_string() == *name),
                "{}: {name}",
                case.name
            );
        }
        for part in [why, elsewhere, here] {
            assert!(part.len() > 20 && part.split_whitespace().count() < 40, "{}: {part}", case.name);
        }
        for known in known.iter().chain(tables.iter().flat_map(|table| &table.known)) {
            let is_there =
                known.value == "energy" || words.contains(&known.value.split('.').next().unwrap_or_default());
            assert!(is_there, "{}: {}", case.name, known.value);
        }
    }
}

#[test]
fn a_run_beside_a_known_value_is_wrong() {
    let case = description("[[known]]\nvalue = 'off'\nsource = 'closed form'");
    for (off, finer, expected) in [
        (0.0, 1.0, Verdict::Right),
        (9e-7, 1.0, Verdict::Right),
        (1.1e-6, 1.0, Verdict::Wrong),
        // Half as many steps may be 16 times as far off.
        (1.1e-6, 0.5, Verdict::Right),
        (f64::NAN, 1.0, Verdict::Wrong),
    ] {
        let found = judged(&case, off, finer);
        assert_eq!(found.verdict, expected, "{off}, {finer}: {}", found.reason);
    }
    let at_end = "[[known]]\nvalue = 'x'\nwhen = 'end'\nis = -0.323289567\nsize = 2.0\nsource = 'cos 1.9'";
    assert_eq!(judged(&description(at_end), 0.0, 1.0).verdict, Verdict::Right);
    assert_eq!(judged(&description(at_end), 4e-6, 1.0).verdict, Verdict::Wrong);
    let energy = description("[[known]]\nvalue = 'energy'\nsource = 'no damper'");
    assert_eq!(judged(&energy, 0.0, 1.0).verdict, Verdict::Right);
    assert_eq!(judged(&energy, 1e-5, 1.0).verdict, Verdict::Wrong);
}

#[test]
fn a_run_that_claims_no_digits_is_refused_where_the_list_foresees_it_alone() {
    let known = "[[known]]\nvalue = 'off'\nsource = 'closed form'";
    let outside = "[[outside]]\nmethods = ['DormandPrince8']\nwhy = 'd'";
    let oracle = Oracle::read(SPRING, None, &|_| None).expect("a text");
    let found = |case: &str, off: f64| {
        let doubtful = outcome(Verdict::Refused, "no digits are claimed");
        description(case).judged(doubtful, MethodKind::Adaptive, &variation(1.0), (&states(off), &oracle))
    };
    let wrong = found(known, 1e-5);
    assert!(wrong.verdict == Verdict::Wrong && wrong.reason.contains("closed form"), "{}", wrong.reason);
    for (case, off) in [(known.to_string(), 9e-7), (format!("{known}\n{outside}"), 1e-5)] {
        let refused = found(&case, off);
        assert!(
            refused.verdict == Verdict::Refused && refused.reason.contains("no digits"),
            "{}",
            refused.reason
        );
    }
}

#[test]
fn a_table_is_known_at_its_times_alone() {
    let tabled = |rows: &str| {
        let mut case = description("[[tables]]\nfile = 'a.csv'\nsize = 2.0\nsource = 'cos t'");
        case.tables[0].fill(&format!("t,x\n{rows}")).map(|()| case)
    };
    let right = tabled("0.5,0.8775825618903728\n0.55,7.0\n1.9,-0.3232895668635034").expect("a table");
    assert_eq!(judged(&right, 0.0, 1.0).verdict, Verdict::Right);
    assert_eq!(judged(&right, 3e-6, 1.0).verdict, Verdict::Wrong);
    let wrong = tabled("0.5,0.87759").expect("a table");
    let found = judged(&wrong, 0.0, 1.0);
    assert_eq!(found.verdict, Verdict::Wrong);
    assert!(found.reason.contains("at t = 0.5000 s"), "{}", found.reason);
    assert!(tabled("0.5,a").is_err_and(|fault| fault.starts_with("a.csv:2: ")));
    assert!(tabled("0.5,1.0\n0.6").is_err_and(|fault| fault == "a.csv:3: 1 values for 2 names"));
}

#[test]
fn rates_and_exact_turns_are_known_values() {
    let rates = description("[[known]]\nvalue = 'off'\nrate = 1.0\nsource = 'closed form'");
    assert_eq!(judged(&rates, 0.0, 1.0).verdict, Verdict::Right);
    let oracle = Oracle::read(SPRING, None, &|_| None).expect("a text");
    let mut late = states(0.0);
    late[7].qd[0] += 1e-5;
    let right = || outcome(Verdict::Right, "");
    let found = rates.judged(right(), MethodKind::Adaptive, &variation(1.0), (&late, &oracle));
    assert_eq!(found.verdict, Verdict::Wrong, "{}", found.reason);
    // 1e6 rad/s after 1e3 s, in numbers of 50 digits: 1e9 rad is 0.577395423501385 rad behind whole turns.
    let turning = description("[[known]]\nvalue = 'x'\nturning = 1e6\nsource = 'exact product'");
    let at = |angle: f64| {
        vec![OracleState { t: 1e3, q: vec![angle], qd: vec![0.0], qdd: vec![0.0], ..OracleState::default() }]
    };
    for (angle, expected) in [(0.577_395_423_501_385_2, Verdict::Right), (0.577_398, Verdict::Wrong)] {
        let found = turning.judged(right(), MethodKind::Adaptive, &variation(1.0), (&at(angle), &oracle));
        assert_eq!(found.verdict, expected, "{angle}: {}", found.reason);
    }
}

#[test]
fn an_answer_where_there_is_none_is_wrong_and_another_reason_is_not_foreseen() {
    let text = "[refused]\nwords = 'closure'\nat = 1.0\nwithin = 0.1\nsource = 'out of reach'";
    let case = description(text);
    let verdict = |outcome, failed| {
        let found = case.refused(outcome, failed);
        (found.verdict, found.is_expected)
    };
    assert_eq!(verdict(outcome(Verdict::Right, ""), None), (Verdict::Wrong, false));
    let open = || outcome(Verdict::Refused, "`closure.0` stays open");
    assert_eq!(verdict(open(), Some(1.05)), (Verdict::Refused, true));
    assert_eq!(verdict(open(), Some(1.2)), (Verdict::Wrong, false));
    assert_eq!(verdict(outcome(Verdict::Refused, "singular"), Some(1.0)), (Verdict::Refused, false));
}

#[test]
fn a_fault_of_a_description_is_told_with_its_line() {
    let fault = Description::read("title = 'a'\nbonds = 3").expect_err("no such field");
    assert!(fault.contains("line 2") && fault.contains("bonds"), "{fault}");
    let case = description("[[outside]]\nmethods = ['Baumgarte']\nvariants = ['f32']\nwhy = 'drift'");
    assert!(case.is_outside("Baumgarte with RungeKutta4", Class::Single));
    assert!(!case.is_outside("Baumgarte with RungeKutta4", Class::Steps));
    assert!(!case.is_outside("Projection with RungeKutta4", Class::Single));
}

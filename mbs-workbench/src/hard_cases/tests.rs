use std::time::Duration;

use mbs_runtime::Function;

use crate::erased::erase::erase;
use crate::erased::facade::AnyEquations;
use crate::erased::variations::Variable;
use crate::hard_cases::judge::{Bounds, judge};
use crate::hard_cases::list::description::Description;
use crate::hard_cases::oracle::{Oracle, OracleState};
use crate::hard_cases::result::MatrixResult;
use crate::hard_cases::study::{Clock, Extent, Own, study};
use crate::hard_cases::variation::Class;
use crate::hard_cases::verdict::{Outcome, Verdict};
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod};

mbs_runtime::mechanism! {
    /// A point mass on a rod, in Cartesian coordinates.
    pub mechanism Pendulum;
    param length: m = 1 in 0.9..1.1;
    param g: m/s^2 = 9.81;
    coord p: [m; 2] = [1, -0.1];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -g] }
    constraint rod { dot(p, p) == length^2; }
}

mbs_runtime::mechanism! {
    /// The same with a row that is wrong by a thousandth.
    pub mechanism OtherRow;
    param length: m = 1 in 0.9..1.1;
    param g: m/s^2 = 9.81;
    coord p: [m; 2] = [1, -0.1];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -g] }
    constraint rod { dot(p, p) == 1.001*length^2; }
}

mbs_runtime::mechanism! {
    /// The same with a force that is wrong by a thousandth.
    pub mechanism OtherForce;
    param length: m = 1 in 0.9..1.1;
    param g: m/s^2 = 9.81;
    coord p: [m; 2] = [1, -0.1];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -1.001*g] }
    constraint rod { dot(p, p) == length^2; }
}

mbs_runtime::mechanism! {
    /// A crank with its slider.
    pub mechanism CrankSlider;
    param crank: m = 0.1 in 0.08..0.12;
    param speed: rad/s = 2;
    coord phi: rad;
    coord psi: rad = -0.3;
    coord x: m = 0.4;
    constraint loop_ { crank*unit(phi) + 0.3m*unit(psi) == [x, 0]; }
    drive motor: phi == speed*t + 0.4;
    branch rod_ahead: cos(psi) > 0;
}

mbs_runtime::mechanism! {
    /// The same with a motor that is late by a thousandth of a radian.
    pub mechanism OtherDrive;
    param crank: m = 0.1 in 0.08..0.12;
    param speed: rad/s = 2;
    coord phi: rad;
    coord psi: rad = -0.3;
    coord x: m = 0.4;
    constraint loop_ { crank*unit(phi) + 0.3m*unit(psi) == [x, 0]; }
    drive motor: phi == speed*t + 0.399;
    branch rod_ahead: cos(psi) > 0;
}

mbs_runtime::mechanism! {
    /// A follower on a cam.
    pub mechanism Follower;
    function lift: m(rad), C3, periodic TAU;
    coord theta: rad;
    coord y: m = 20mm;
    drive shaft: theta == 10 [rad/s]*t;
    constraint face { y == 20mm + lift(theta); }
}

/// 5 mm times a sine, in `f64` alone, with this slope in place of 1.
#[derive(Clone)]
struct Wave(f64);

impl Function<f64> for Wave {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        let all = [x.sin(), self.0 * x.cos(), -x.sin(), -x.cos()];
        core::array::from_fn(|order| 5e-3 * all[order])
    }
}

const METHODS: [MotionMethod; 3] = [
    MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8),
    MotionMethod::Explicit(FormulationName::Baumgarte, IntegratorName::RungeKutta4),
    MotionMethod::Implicit(ImplicitName::Extrapolated),
];

fn result(
    make: fn(&[(usize, f64)]) -> Variable,
    equations: &dyn AnyEquations,
    methods: &[MotionMethod],
    until: f64,
) -> MatrixResult {
    let extent = Extent {
        methods: methods.to_vec(),
        seeds: (0..14).collect(),
        until,
        in_turn: None,
        description: None,
    };
    let clock = Clock::of(Duration::from_secs(600));
    let found = study(&Own { make, equations }, &extent, &clock, &mut |_, _| ()).expect("a study");
    MatrixResult::of(found, "own".to_string(), "Own".to_string())
}

/// All that a failed assertion should show.
fn all(result: &MatrixResult) -> String {
    let reasons = [Verdict::Wrong, Verdict::Refused, Verdict::Late].map(|verdict| result.reasons(verdict));
    format!("{}\n{}\n{reasons:#?}\n{:#?}", result.matrix(), result.sentence(), result.left_out)
}

#[test]
fn variants_of_a_pendulum_are_right_by_every_method() {
    let equations = erase(Pendulum::default()).into_equations();
    let result = result(crate::variable!(Pendulum::default()), equations.as_ref(), &METHODS, 0.6);
    assert_eq!(result.count(Verdict::Right), result.outcomes.len(), "{}", all(&result));
    let kinds = ["steps", "parameters", "guess", "rows", "frame", "f32", "similar"];
    assert!(kinds.iter().all(|kind| result.matrix().contains(kind)), "{}", all(&result));
    assert_eq!((result.outcomes.len(), result.left_out.len()), (42, 1), "{}", all(&result));
    assert!(result.not_made().is_empty(), "{:?}", result.not_made());
    let mut others = result.outcomes.iter().filter(|outcome| outcome.class != Class::Similar);
    assert!(others.all(|outcome| outcome.error.is_some_and(|error| error > 0.0)));
    let mut similar = result.outcomes.iter().filter(|outcome| outcome.class == Class::Similar);
    assert!(
        similar.clone().count() == 6 && similar.all(|outcome| outcome.error < Some(1e-10)),
        "{}",
        all(&result)
    );
}

#[test]
fn an_emitted_row_or_force_that_is_not_the_texts_is_wrong() {
    let equations = erase(Pendulum::default()).into_equations();
    let (row, force) = (crate::variable!(OtherRow::default()), crate::variable!(OtherForce::default()));
    for (make, words) in [(row as fn(&[(usize, f64)]) -> Variable, "is open by"), (force, "M q̈ + Φ_qᵀλ − Q")]
    {
        let result = result(make, equations.as_ref(), &METHODS[..1], 0.3);
        // Single precision does not tell a force from one that is a thousandth off; similar ones have the same fault.
        let is_double = |outcome: &&Outcome| !matches!(outcome.class, Class::Single | Class::Similar);
        let double = || result.outcomes.iter().filter(is_double);
        assert!(double().count() >= 10, "{}", all(&result));
        assert!(double().all(|outcome| outcome.verdict == Verdict::Wrong), "{}", all(&result));
        assert!(
            result.reasons(Verdict::Wrong).iter().any(|(reason, ..)| reason.contains(words)),
            "{}",
            all(&result)
        );
    }
}

#[test]
fn variants_of_a_motion_from_drives_are_right_and_a_late_motor_is_wrong() {
    let equations = erase(CrankSlider::default()).into_equations();
    let result = result(crate::variable!(CrankSlider::default()), equations.as_ref(), &[], 3.0);
    assert_eq!(result.count(Verdict::Right), result.outcomes.len(), "{}", all(&result));
    let kinds = ["steps", "parameters", "guess", "f32", "lanes"];
    assert!(kinds.iter().all(|kind| result.matrix().contains(kind)), "{}", all(&result));
    let late = self::result(crate::variable!(OtherDrive::default()), equations.as_ref(), &[], 3.0);
    let closed = late.outcomes.iter().filter(|outcome| outcome.method.ends_with("closed"));
    assert!(
        closed.clone().count() > 5
            && closed
                .clone()
                .all(|outcome| outcome.verdict == Verdict::Wrong || outcome.class == Class::Single),
        "{}",
        all(&late)
    );
}

#[test]
fn a_function_in_doubles_runs_in_all_numbers_and_one_that_contradicts_itself_is_wrong() {
    let equations = erase(Follower::new(Wave(1.0))).into_equations();
    let make = crate::variable!(Follower::new(Wave(1.0)), Follower, [lift]);
    let result = result(make, equations.as_ref(), &[], 1.0);
    assert_eq!(result.count(Verdict::Right), result.outcomes.len(), "{}", all(&result));
    let equations = erase(Follower::new(Wave(1.001))).into_equations();
    let make = crate::variable!(Follower::new(Wave(1.001)), Follower, [lift]);
    let other = self::result(make, equations.as_ref(), &[], 1.0);
    let told = other.outcomes.iter().filter(|outcome| outcome.reason.contains("`lift` contradicts itself"));
    assert!(told.count() > other.outcomes.len() / 2, "{}", all(&other));
}

/// The pendulum as a case of the list, with a known value.
fn as_a_case(known: &str) -> MatrixResult {
    let text = format!(
        "title = 'a'\norigin = 'b'\nwhy = 'c'\nelsewhere = 'd'\nhere = 'e'\n\
         [bounds]\nadaptive = 1e-5\nimplicit = 1e-2\nsingle = 1e-2\n[[known]]\n{known}\nsource = 'f'\n"
    );
    let description = Description::read(&text).unwrap_or_else(|fault| panic!("{fault}"));
    let equations = erase(Pendulum::default()).into_equations();
    let own = Own { make: crate::variable!(Pendulum::default()), equations: equations.as_ref() };
    let extent = Extent {
        methods: METHODS.to_vec(),
        seeds: (0..7).collect(),
        until: 0.3,
        in_turn: None,
        description: Some(description),
    };
    let found = study(&own, &extent, &Clock::of(Duration::from_secs(600)), &mut |_, _| ()).expect("a study");
    let outcomes = found.outcomes.into_iter().map(|outcome| Outcome { case: "own".to_string(), ..outcome });
    let methods = METHODS.iter().map(ToString::to_string).collect();
    MatrixResult::of_cases(outcomes.collect(), vec!["own".to_string()], methods)
}

#[test]
fn a_case_of_the_list_is_judged_by_its_known_values() {
    let right = as_a_case("value = 'energy'\nsize = 9.81");
    // Baumgarte's oscillators have no bound, so they are not run.
    assert_eq!((right.count(Verdict::Right), right.outcomes.len()), (14, 14), "{}", all(&right));
    assert!(right.refusing().is_empty() && right.matrix().lines().count() == 2, "{}", all(&right));
    let picture = crate::hard_cases::matrix::svg(&right.picture(), &right.sentence());
    assert_eq!((picture.matches('✓').count(), picture.matches('✗').count()), (3, 1), "{picture}");
    let wrong = as_a_case("value = 'p.0'\nwhen = 'end'\nis = 0.2\nexcept = ['parameters']");
    // Similar mechanisms, other parameters and a shaken guess have other ends.
    assert_eq!((wrong.count(Verdict::Wrong), wrong.outcomes.len()), (8, 14), "{}", all(&wrong));
    assert!(wrong.page().contains("own") && wrong.csv().contains("\nown,"), "{}", all(&wrong));
}

#[test]
fn a_page_holds_all_variants_and_a_seed_replays_one() {
    let equations = erase(Pendulum::default()).into_equations();
    let own = Own { make: crate::variable!(Pendulum::default()), equations: equations.as_ref() };
    let run = |seeds: Vec<u64>| {
        let extent =
            Extent { methods: METHODS[..1].to_vec(), seeds, until: 0.2, in_turn: None, description: None };
        let found =
            study(&own, &extent, &Clock::of(Duration::from_secs(600)), &mut |_, _| ()).expect("a study");
        MatrixResult::of(found, "own".to_string(), "Own <b>".to_string())
    };
    let (whole, one) = (run((0..6).collect()), run(vec![4]));
    let figures = |result: &MatrixResult| {
        let outcome = result.outcomes.iter().find(|outcome| outcome.seed == 4).expect("the seed");
        (outcome.variant.clone(), outcome.error, outcome.bound, outcome.work)
    };
    assert_eq!(figures(&whole), figures(&one));
    let page = whole.page();
    assert!(page.contains("Own &lt;b&gt;: hard cases") && !page.contains("{{"), "{page:.200}");
    assert_eq!(whole.document()["outcomes"].as_array().map(Vec::len), Some(6));
    assert_eq!(whole.csv().lines().count(), 7);
}

#[test]
fn there_is_an_end_to_the_time() {
    let equations = erase(Pendulum::default()).into_equations();
    let own = Own { make: crate::variable!(Pendulum::default()), equations: equations.as_ref() };
    let extent = Extent {
        methods: METHODS[..1].to_vec(),
        seeds: (0..9).collect(),
        until: 0.1,
        in_turn: None,
        description: None,
    };
    let found = study(&own, &extent, &Clock::of(Duration::ZERO), &mut |_, _| ()).expect("a study");
    assert_eq!((found.outcomes.len(), found.not_run), (0, 9));
}

#[test]
fn half_the_step_excuses_a_noise_of_accelerations_and_no_wrong_velocity() {
    let oracle = Oracle::read("mechanism Cart; coord x: m = 0; drive push: x == sin(t/1s);", None, &|_| None)
        .expect("a text");
    let bounds = Bounds { rows: f64::INFINITY, balance: 1.0, estimate: 1e-12, rounding: 1e-12, digit: 0.0 };
    let run = |factor: f64, noise: f64| -> Vec<OracleState> {
        let at = |index: u32| {
            let t = f64::from(index) / 64.0;
            let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
            OracleState {
                t,
                q: vec![t.sin()],
                qd: vec![factor * t.cos()],
                qdd: vec![-t.sin() + sign * noise],
                ..OracleState::default()
            }
        };
        (0..=64).map(at).collect()
    };
    let wrong =
        |run: &[OracleState], fine: &[OracleState]| judge([run, fine], &oracle, &[1.0], bounds, 1).wrong;
    let [right, noisy, fast] = [run(1.0, 0.0), run(1.0, 1e-3), run(1.001, 0.0)];
    assert_eq!(wrong(&right, &right), None);
    assert!(wrong(&noisy, &[]).is_some(), "nothing says that it is noise");
    assert_eq!(wrong(&noisy, &right), None);
    assert!(wrong(&fast, &fast).is_some(), "half the step has the same wrong velocity");
}

#[test]
fn velocities_between_the_instants_of_a_cluster_are_judged() {
    let oracle = Oracle::read("mechanism Cart; coord x: m = 0; drive push: x == sin(t/1s);", None, &|_| None)
        .expect("a text");
    let bounds = Bounds { rows: f64::INFINITY, balance: 1.0, estimate: 1e-12, rounding: 1e-9, digit: 0.0 };
    let run = |factor: f64| -> Vec<OracleState> {
        let at = |index: u32| {
            // Five instants at distances of 0.1 s in each 40 s: six turns in between.
            let t = 40.0 * f64::from(index / 5) + 0.1 * f64::from(index % 5);
            let [q, qd, qdd] = [t.sin(), factor * t.cos(), -t.sin()].map(|value| vec![value]);
            OracleState { t, q, qd, qdd, ..OracleState::default() }
        };
        (0..40).map(at).collect()
    };
    let found = |factor: f64| judge([&run(factor), &[]], &oracle, &[1.0], bounds, 1);
    assert_eq!(found(1.0), Default::default());
    assert!(found(1.001).wrong.is_some_and(|words| words.contains("integral of q̇")));
}

//! The study with a stand-in for built programs, whose outputs follow from the effects of each scene.

use super::comparison::{changes, range};
use super::measurement::{Curve, Measured, Order, instants};
use super::result::{EffectsResult, percent};
use super::scene::{Scene, Text};
use super::study::{Study, study};

/// A slide with effects that cost a different number of operations; `held` is needed, for nothing else holds it.
const TEXT: &str = "mechanism Slide;
    coord x: m = 0;
    body slide { mass: 2kg, com: [x, 0] }
    out place: m = x;
    effect strong { force pull: [3, 0] on [x, 0]; }
    effect weak { force push: 1e-3*[sin(x/1m), 0]*1N on [x, 0]; }
    effect opposed { force back: -1e-3*[sin(2*x/1m)*cos(x/1m), 0]*1N on [x, 0]; }
    effect faulty { coord y: m; }
    start x = 0 rate 1;";

fn text(effects: &[&str]) -> Text {
    let groups = mbs_codegen::effects(TEXT);
    let effects = effects.iter().map(|name| (*name).to_string()).collect();
    Text { source: TEXT.to_string(), groups, effects, kept: Vec::new() }
}

fn order() -> Order {
    Order { until: 1.0, instants: 10, tolerance: 1e-9, ..Order::default() }
}

/// Contributions of `strong`, `weak` and `opposed` to an output whose range is 1 with `strong`, and to the time of a step.
const SIZES: [f64; 3] = [1.0, 0.008, -0.007];
const STEPS: [f64; 3] = [10e-9, 20e-9, 40e-9];

/// A scene that moves as its effects say.
fn stand_in(name: &str, times: &[f64]) -> Measured {
    let bits: u16 = name.strip_prefix("Compared").expect("its name").parse().expect("its effects");
    let sum = |parts: [f64; 3]| (0..3).filter(|k| bits & (1 << k) != 0).map(|k| parts[k]).sum::<f64>();
    let values = times.iter().map(|t| t * sum(SIZES)).collect();
    let place = Curve { name: "place".to_string(), unit: "m".to_string(), values, ..Curve::default() };
    Measured {
        name: name.to_string(),
        is_moved_by_forces: true,
        outputs: vec![place],
        steps: 10,
        step: 100e-9 + sum(STEPS),
        bytes: Some(1000 + u64::from(bits)),
        ..Measured::default()
    }
}

fn studied(within: f64) -> (Study, Vec<usize>) {
    let times = instants(&order());
    let mut rounds = Vec::new();
    let mut workshop = |_: usize, copy: &str, names: &[String]| {
        rounds.push(names.len());
        // Each scene is a statement of the copy, and all of it compiles.
        assert!(names.iter().all(|name| copy.contains(&format!("scene {name} = "))));
        assert!(mbs_codegen::expand_source(copy).is_ok());
        Ok(names.iter().map(|name| stand_in(name, &times)).collect())
    };
    let found = study(text(&["strong", "weak", "opposed"]), &order(), within, &mut workshop);
    (found.expect("a study"), rounds)
}

#[test]
fn effects_are_left_out_while_the_outputs_stay_within_the_bound() {
    // Each of the small ones alone is within 1 %, and so are both, which nearly cancel.
    let (found, rounds) = studied(0.01);
    assert_eq!((found.enough, found.eliminated.len()), (Scene(0b001), 3));
    // The dearer one with the smaller change goes first. All scenes of the next rounds are known from the first.
    assert_eq!(found.eliminated[1], Scene(0b011));
    assert_eq!(rounds, [8]);
    // Without either the change is 0.8 % or 0.7 %: nothing can be left out within 0.5 % but both together.
    let (found, _) = studied(0.005);
    assert_eq!((found.eliminated.len(), found.enough), (1, Scene(0b001)));
    let (found, _) = studied(0.0005);
    assert_eq!(found.enough, found.whole());
}

#[test]
fn contributions_are_differences_and_the_scene_to_paste_compiles() {
    let (study, _) = studied(0.01);
    let result = EffectsResult {
        study,
        within: 0.01,
        title: "Slide".to_string(),
        origin: "mbs".to_string(),
        command: "mbs effects slide.mbs".to_string(),
        facts: Vec::new(),
    };
    let found = result.contributions();
    for (one, (size, step)) in found.iter().zip(SIZES.iter().zip(STEPS)) {
        let change = one.changes[0].size.as_ref().expect("comparable");
        assert!((change.largest - size.abs() / 1.001).abs() < 1e-12, "{}: {change:?}", one.name);
        assert!((one.step.expect("a time") - step).abs() < 1e-15 && change.at == 1.0);
        assert!(one.operations > 0 && one.coordinates == 0 && one.reason.is_none());
    }
    let sentence = result.sentence();
    assert_eq!(
        sentence,
        "cheapest scene within 1 % of the whole on `place` (largest and RMS): strong, 0.65 of its cost"
    );
    let paste = result.to_paste();
    assert_eq!(paste, "scene Enough = strong;");
    // It alone, in the text as it is.
    let whole = TEXT.replace("effect faulty { coord y: m; }", "");
    assert!(mbs_codegen::expand_source(&format!("{whole}\n{paste}")).is_ok());
    assert!(result.page().contains("const DATA = {") && !result.page().contains("{{"));
    assert_eq!(result.csv().lines().count(), 4);
}

#[test]
fn an_effect_whose_parameter_a_preset_sets_can_be_left_out() {
    let source = TEXT.replace("force pull: [3, 0]", "param drawn: N = 3; force pull: [drawn, 0]");
    let source = format!("{source} preset far \"a stronger pull\" {{ drawn: 5 }}");
    let of_presets = Text { source, ..text(&["strong", "weak"]) };
    let of_presets = Text { groups: mbs_codegen::effects(&of_presets.source), ..of_presets };
    assert!(of_presets.measures(Scene(0b10)).is_ok(), "{:?}", of_presets.measures(Scene(0b10)));
}

#[test]
fn a_scene_that_is_no_mechanism_is_named_with_its_reason() {
    let reason = text(&["strong", "faulty"]).measures(Scene(0b11)).expect_err("a coordinate without mass");
    assert!(!reason.is_empty() && !reason.contains("Compared"), "{reason}");
    let failed = study(text(&["strong", "faulty"]), &order(), 0.01, &mut |_, _, _| Ok(Vec::new()));
    assert!(failed.expect_err("the whole is faulty").contains("the whole is no mechanism"));
}

#[test]
fn runs_with_errors_of_their_own_are_not_comparable() {
    let times = instants(&order());
    let (whole, mut other) = (stand_in("Compared7", &times), stand_in("Compared3", &times));
    assert!(changes(&whole, &other, &times, 0.01)[0].is_within(0.01));
    other.outputs[0].error = 2e-3;
    let change = &changes(&whole, &other, &times, 0.01)[0];
    assert!(change.size.as_ref().expect_err("an error").contains("not comparable"));
    other.outputs[0].error = 0.0;
    // An envelope as wide as the bound says nothing about it; a narrow one is compared by its ends.
    let values = other.outputs[0].values.clone();
    let wider =
        |by: f64| Some([values.iter().map(|x| x - by).collect(), values.iter().map(|x| x + by).collect()]);
    other.outputs[0].envelope = wider(0.02);
    assert!(changes(&whole, &other, &times, 0.01)[0].size.is_err());
    other.outputs[0].envelope = wider(0.001);
    let size = changes(&whole, &other, &times, 0.01)[0].size.clone().expect("comparable");
    assert!((size.largest - (0.007 + 0.001) / 1.001).abs() < 1e-3, "{size:?}");
    let mut none = other.clone();
    (none.outputs[0].envelope, none.outputs[0].values[3]) = (None, f64::NAN);
    for (a, b) in [(&whole, &none), (&none, &other)] {
        let reason = changes(a, b, &times, 0.01)[0].size.clone().expect_err("no number");
        assert!(reason.contains("is no number at t = 0.3 s"), "{reason}");
    }
    other.outputs.clear();
    assert!(changes(&whole, &other, &times, 0.01)[0].size.is_err());
}

#[test]
fn a_constant_output_is_compared_with_its_size() {
    assert_eq!((range(&[2.0, 2.0]), range(&[0.0, 0.0]), range(&[-1.0, 3.0])), (2.0, 1.0, 4.0));
    assert_eq!(
        (percent(0.0123), percent(0.31), percent(0.0)),
        ("1.2 %".into(), "31 %".into(), "0 %".to_string())
    );
    assert_eq!((percent(20.0), percent(1e-7)), ("> 1000 %".to_string(), "1e-5 %".to_string()));
}

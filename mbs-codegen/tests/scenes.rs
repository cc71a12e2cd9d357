//! A scene without an effect is the text that never mentioned it: the same operations in the same order.
#![forbid(unsafe_code)]

#[path = "scenes/release.rs"]
mod release;

use std::collections::BTreeMap;

use quote::ToTokens;
use syn::visit::{Visit, visit_item_impl};

/// Texts in two parts: a common one, and an effect. The effect has longer lengths, and names, rows and branches of
/// its own. Any of these would change the operations, the metric or the order of solution.
const TEXTS: [(&str, &str); 4] = [
    (
        "param r: m = 0.05; param L: m = 0.18; param omega: rad/s = 10; input shift: m, rates;
         coord theta: rad = 0.1; coord phi: rad = 0; coord x: m = 0.2;
         constraint closure { r*unit(theta) + L*unit(phi) == [x + shift, 0]; }
         drive crank: theta == omega*t; branch ahead: cos(phi) > 0; out tip: [m; 2] = r*unit(theta); out v: m/s = der(x);",
        "const N: 1 = 2; param arm: [m; N] = [3, 4]; coord psi: rad = 0.3; coord y: [m; 2];
         constraint follower { y == arm[0]*unit(psi) + [x, 0]; arm.1*sin(psi) == r*sin(theta); }
         branch low: cos(psi) > 0; let k = x/arm[0]; out height: 1 = k;",
    ),
    (
        "param p: 1 = 2; coord q: 1 = 0.1; coord w: [1; 2] = [0.1, 0.2];
         for i in 0..2 { drive each: w[i]*(2 + sin(q)) == p*t/1s + i; } drive d: q == exp(sin(t/1s)); out y: 1 = w[0]*w.1;",
        "input u: 1, rates; coord z: 1 = 0.1; drive e: z^3 + z*p == u + q; out s: 1 = z*sin(q)*exp(sin(t/1s));",
    ),
    (
        "coord a: rad; drive d: a == 2*t/1s;",
        "param c: m = 1; coord b: m; constraint e { b == c*sin(a); } out o: m = der(b)*1s;",
    ),
    (
        "param w: rad/s = 2; coord a: rad; coord y: m; drive crank: rate(a) == w*(1 + t/1s);
         constraint e { y == 2m*sin(a); } limit stroke: -1m <= y <= 1m; out v: m/s = der(y);",
        "input fast: rad/s, rates; coord b: rad; drive second: rate(b) == fast + w;
         coord z: m; constraint f { z == y*cos(b); } limit reach: -1m <= z <= 1m;",
    ),
];

/// Items of the implementations for one type, by trait and name, without the parts that may differ.
struct Found<'a> {
    /// Traits whose implementations are looked at.
    traits: &'a [&'a str],
    scene: Option<&'a str>,
    items: BTreeMap<String, String>,
}

impl Visit<'_> for Found<'_> {
    fn visit_item_impl(&mut self, block: &syn::ItemImpl) {
        let target = block.self_ty.to_token_stream().to_string();
        let wanted = self.scene.is_none_or(|scene| target.ends_with(&format!(":: {scene} >")));
        let Some((path, _)) = block.trait_.as_ref().filter(|_| wanted) else {
            return visit_item_impl(self, block);
        };
        let name = path.segments.last().expect("a trait").ident.to_string();
        if !self.traits.contains(&name.as_str()) {
            return;
        }
        for item in &block.items {
            let key = match item {
                syn::ImplItem::Fn(function) => function.sig.ident.to_string(),
                syn::ImplItem::Const(constant) => constant.ident.to_string(),
                syn::ImplItem::Type(kind) => kind.ident.to_string(),
                other => panic!("{}", other.to_token_stream()),
            };
            // The text, the scene's name, and copies of the whole struct.
            if !["SOURCE", "SCENE", "Lane", "lane", "Group", "group", "enclosed"].contains(&key.as_str()) {
                self.items.insert(format!("{name}::{key}"), item.to_token_stream().to_string());
            }
        }
    }
}

fn items(text: &str, scene: Option<&str>) -> BTreeMap<String, String> {
    let tokens = mbs_codegen::expand_source(text).unwrap_or_else(|faults| panic!("{text}\n{faults}"));
    let mut found = Found { traits: &["Mechanism", "Kinematic"], scene, items: BTreeMap::new() };
    found.visit_file(&syn::parse2(tokens).expect("Rust"));
    assert!(found.items.len() > 25, "{:?}", found.items.keys());
    found.items
}

#[test]
fn a_scene_without_an_effect_computes_what_the_text_without_it_computes() {
    for (common, effect) in TEXTS {
        let alone = items(&format!("mechanism M; {common}"), None);
        let texts = [
            format!(
                "mechanism M; {common} effect extra {{ {effect} }} effect none {{}} scene With = extra; scene Without = none;"
            ),
            format!(
                "mechanism M; effect extra {{ {effect} }} scene With = extra; effect none {{}} scene Without = none; {common}"
            ),
        ];
        for text in texts {
            let without = items(&text, Some("Without"));
            for (key, item) in &alone {
                assert_eq!(without.get(key), Some(item), "{key}");
            }
            assert_eq!(without.len(), alone.len());
            // The control: with the effect every function of the position has changed.
            let with = items(&text, Some("With"));
            for key in
                ["Mechanism::phi", "Mechanism::phi_q", "Mechanism::COORDINATES", "Kinematic::solve_blocks"]
            {
                assert_ne!(with[key], alone[key], "{key}");
            }
        }
    }
}

/// The text of a ready mechanism with nine effects: masses, forces, friction on multipliers, springs, a joint with play.
fn engine() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../mechanisms/src/slider_crank_engine.rs");
    let source = std::fs::read_to_string(path).expect("the file of the engine");
    let calls = mbs_codegen::calls(&source).expect("Rust");
    calls.into_iter().next().expect("a mechanism").source
}

/// Items of the implementations for each of `scenes`, those of masses and forces included.
fn dynamic_items(text: &str, scenes: &[Option<&str>]) -> Vec<BTreeMap<String, String>> {
    let tokens = mbs_codegen::expand_source(text).unwrap_or_else(|faults| panic!("{faults}"));
    let file = syn::parse2(tokens).expect("Rust");
    let of = |scene: &Option<&str>| {
        let traits = &["Mechanism", "Dynamic", "Partitioned"];
        let mut found = Found { traits, scene: *scene, items: BTreeMap::new() };
        found.visit_file(&file);
        assert!(found.items.len() > 50, "{:?}", found.items.keys());
        found.items
    };
    scenes.iter().map(of).collect()
}

#[test]
fn scenes_of_the_engine_are_the_texts_in_which_their_other_effects_were_never_written() {
    let text = engine();
    let groups = mbs_codegen::effects(&text);
    assert_eq!(groups.effects.len(), 9);
    let others = |left_out: &String| -> Vec<String> {
        groups.effects.iter().filter(|name| *name != left_out).cloned().collect()
    };
    let scenes: Vec<(String, Vec<String>)> =
        groups.effects.iter().map(|name| (format!("Without_{name}"), others(name))).collect();
    let copy = groups.with_scenes(&text, &groups.effects, &scenes);
    let names: Vec<Option<&str>> = scenes.iter().map(|(name, _)| Some(name.as_str())).collect();
    let found = dynamic_items(&copy, &names);
    for (left_out, without) in groups.effects.iter().zip(&found) {
        let never_written =
            dynamic_items(&groups.with_scenes(&text, &others(left_out), &[]), &[None]).remove(0);
        assert_eq!(without.len(), never_written.len(), "{left_out}");
        for (key, item) in &never_written {
            assert!(without.get(key) == Some(item), "`{key}` without `{left_out}`");
        }
    }
    // The control: no two of them are alike.
    assert!(found.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn a_scene_computes_what_the_text_of_its_effects_alone_computes() {
    for (common, effect) in TEXTS {
        let written_out = items(&format!("mechanism M; {common} {effect}"), None);
        let text = format!(
            "mechanism M; {common} effect extra {{ {effect} }} effect none {{}} scene With = extra; scene Without = none;"
        );
        assert_eq!(items(&text, Some("With")), written_out);
        // No other effect adds a statement: the whole text is the same.
        assert_eq!(items(&text, Some("AllEffects")), written_out);
        assert_eq!(items(&format!("mechanism M; {common} effect extra {{ {effect} }}"), None), written_out);
    }
}

#[test]
fn a_text_grows_with_its_scenes_and_no_faster() {
    let (common, effect) = TEXTS[0];
    let size = |scenes: usize| {
        let mut text = format!("mechanism M; {common} effect extra {{ {effect} }}");
        for number in 0..scenes {
            text += &format!("scene Number{number:02} = extra;");
        }
        mbs_codegen::expand_source(&text).expect("a valid text").to_string().len()
    };
    let [four, eight, sixteen] = [4, 8, 16].map(size);
    assert_eq!(sixteen - eight, 2 * (eight - four));
}

#[test]
fn views_of_a_scene_are_asked_for_by_its_name() {
    let text = "mechanism M; param c: 1 = 2; effect slow { coord a: rad; drive d: a == c*t/1s; }
                effect fast { coord b: rad; drive d: b == t^2/1 [s^2]; } scene Slow = slow; scene Fast = fast;";
    let slow = mbs_codegen::structure_of(text, Some("Slow")).expect("a scene");
    assert_eq!((slow.name.as_str(), slow.coordinates[0].name.as_str()), ("MSlow", "a"));
    let fast = mbs_codegen::formulas(text, Some("Fast")).expect("a scene");
    assert_eq!((fast.coordinates, fast.phi), (vec!["b".to_owned()], vec!["b - t^2".to_owned()]));
    let casadi = mbs_codegen::casadi_definition(text, Some("Slow")).expect("a scene");
    assert!(casadi.contains("NAME = \"MSlow\"") && casadi.contains("v[0]"), "{casadi}");
    let unknown = mbs_codegen::structure_of(text, Some("Slo")).expect_err("no such scene");
    assert_eq!(unknown, "there is no scene `Slo`; the text has `Slow`, `Fast`, `AllEffects`");
    // The whole text is faulty: both effects declare `d`.
    let whole = mbs_codegen::structure_of(text, None).expect_err("both drives are called `d`");
    assert!(whole.contains("`d` is declared twice"), "{whole}");
    assert!(mbs_codegen::formulas(text, Some("AllEffects")).is_err());
}

#[test]
fn a_scene_may_stand_in_a_text_without_others_where_all_effects_are_one() {
    for (common, effect) in TEXTS {
        let effects = format!("effect none {{}} effect extra {{ {effect} }}");
        let text = format!("mechanism M; {common} {effects} scene Enough = none;");
        let both = format!("mechanism M; {common} {effects} scene Enough = none; scene All = none + extra;");
        // Fields of the effect that it leaves out are those of `AllEffects`.
        for scene in ["Enough", "AllEffects"] {
            assert_eq!(items(&text, Some(scene)), items(&both, Some(scene)), "{effect}");
        }
    }
    // A function of such an effect is a type parameter.
    let text = "mechanism M; coord x: m = 0; body b { mass: 1kg, com: [x, 0] } effect pull { force pull: 1N on x; }
         effect table { param share: 1 = 0.5; function load: N(m), C1; force pressed: share*load(x) on x; } scene Enough = pull;";
    let code = mbs_codegen::expand_source(text).expect("a valid text").to_string();
    assert!(code.contains("Load") && code.contains("share"));
    // Two drives of one coordinate: all effects are no scene, so each belongs to one.
    let text = "mechanism M; coord a: rad; effect slow { drive d: a == 1rad*t/1s; } effect fast { drive e: a == 2rad*t/1s; }
         scene Slow = slow;";
    let fault = mbs_codegen::expand_source(text).expect_err("no scene has it");
    assert!(fault.contains("no scene selects effect `fast`"), "{fault}");
}

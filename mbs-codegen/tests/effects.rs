//! A text with every effect of the library: what a scene leaves out was never written, and costs nothing to expand.
#![forbid(unsafe_code)]

use std::collections::BTreeMap;
use std::fs;
use std::time::Duration;

use quote::ToTokens;
use syn::visit::{Visit, visit_item_impl};

include!("../../tests/tests/every_effect/text.rs");
include!("../../tests/tests/every_effect/rows.rs");

macro_rules! strings {
    ([$($common:tt)*] $($name:ident { $($text:tt)* })*) => {
        /// Bodies that the effects act on.
        pub const COMMON: &str = concat!("mechanism Library;", stringify!($($common)*));

        /// One a kind of force, each with names of its own.
        pub const EFFECTS: [(&str, &str); COUNT] = [$((stringify!($name), stringify!($($text)*))),*];

        /// Number of effects.
        const COUNT: usize = [$(stringify!($name)),*].len();
    };
}
every_effect!(strings);

/// Effects with rows.
mod rows {
    macro_rules! strings {
        ([] $($name:ident { $($text:tt)* })*) => {
            pub const EFFECTS: &[(&str, &str)] = &[$((stringify!($name), stringify!($($text)*))),*];
        };
    }
    every_row!(strings);
}

/// Each so many of the effects is left out once: all of them take half a minute.
const STRIDE: usize = if cfg!(feature = "long") { 1 } else { 4 };

fn text(effects: &[(&str, &str)], scenes: &str) -> String {
    let written = effects.iter().map(|(name, text)| format!("effect {name} {{ {text} }}\n"));
    format!("{COMMON}\n{}{scenes}", written.collect::<String>())
}

fn scene(name: &str, of: impl Iterator<Item = &'static str>) -> String {
    let names: Vec<&str> = of.collect();
    format!("scene {name} = {};\n", names.join(" + "))
}

/// The scene of all effects: each one must be in a scene.
fn whole() -> String {
    scene("Whole", EFFECTS.iter().map(|(name, _)| *name))
}

/// Items of the implementations for a scene by trait and name, without the text and copies of the whole struct.
struct Found<'a> {
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
        if !["Mechanism", "Dynamic", "Partitioned"].contains(&name.as_str()) {
            return;
        }
        for item in &block.items {
            let key = match item {
                syn::ImplItem::Fn(function) => function.sig.ident.to_string(),
                syn::ImplItem::Const(constant) => constant.ident.to_string(),
                syn::ImplItem::Type(kind) => kind.ident.to_string(),
                other => panic!("{}", other.to_token_stream()),
            };
            if !["SOURCE", "SCENE", "Lane", "lane", "Group", "group", "enclosed"].contains(&key.as_str()) {
                self.items.insert(format!("{name}::{key}"), item.to_token_stream().to_string());
            }
        }
    }
}

fn items(file: &syn::File, scene: Option<&str>) -> BTreeMap<String, String> {
    let mut found = Found { scene, items: BTreeMap::new() };
    found.visit_file(file);
    assert!(found.items.len() > 50, "{:?}", found.items.keys());
    found.items
}

fn expanded(text: &str) -> syn::File {
    let tokens = mbs_codegen::expand_source(text).unwrap_or_else(|faults| panic!("{faults}"));
    syn::parse2(tokens).expect("Rust")
}

#[test]
fn a_scene_without_an_effect_is_the_text_in_which_it_was_never_written() {
    let effects = [&EFFECTS[..], rows::EFFECTS].concat();
    let others = |left_out: &str| -> Vec<(&'static str, &'static str)> {
        effects.iter().filter(|(name, _)| *name != left_out).copied().collect()
    };
    // Those with rows come last.
    let left_out = || effects.iter().rev().step_by(STRIDE).map(|(name, _)| *name);
    let names = |effects: Vec<(&'static str, &'static str)>| effects.into_iter().map(|(name, _)| name);
    let scenes: String =
        left_out().map(|name| scene(&format!("Without_{name}"), names(others(name)))).collect();
    let all = scene("Whole", names(effects.clone()));
    let whole = expanded(&text(&effects, &format!("{all}{scenes}")));
    for name in left_out() {
        let without = items(&whole, Some(&format!("Without_{name}")));
        let never_written = items(&expanded(&text(&others(name), "")), None);
        assert_eq!(without.len(), never_written.len(), "{name}");
        for (key, item) in &never_written {
            assert!(without.get(key) == Some(item), "`{key}` without `{name}`");
        }
    }
}

/// Processor time of this thread, where the system tells it: other work on the machine does not count.
fn processor_time() -> Option<Duration> {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// Code that a scene adds grows with its effects; time does too, where the system tells that of a thread.
#[test]
fn what_a_scene_takes_to_expand_grows_with_what_it_selects() {
    let names = EFFECTS.map(|(name, _)| name);
    let expanded = |scenes: &str| {
        let text = text(&EFFECTS, &format!("{}{scenes}", whole()));
        mbs_codegen::expand_source(&text).unwrap_or_else(|faults| panic!("{faults}"))
    };
    let base = expanded("").to_string().len();
    let adds =
        |names: &[&'static str]| expanded(&scene("Next", names.iter().copied())).to_string().len() - base;
    let singles = names.map(|name| adds(&[name]));
    let all = adds(&names);
    let (least, sum) = (singles.iter().min().expect("effects"), singles.iter().sum::<usize>());
    assert!(2 * least < all && all < sum, "{least} {all} {sum}");

    let time = |names: &[&'static str]| {
        let scenes: String =
            (0..6).map(|number| scene(&format!("Number{number}"), names.iter().copied())).collect();
        let once = || {
            let started = processor_time()?;
            expanded(&scenes);
            Some(processor_time()? - started)
        };
        (0..3).filter_map(|_| once()).min()
    };
    // The whole is in both.
    if let Some((few, many)) = time(&["drag"]).zip(time(&names)) {
        println!(
            "scenes of one effect and of {}: {few:?} and {many:?}, {least} and {all} characters",
            names.len()
        );
        assert!(3 * few < 2 * many, "{few:?} for one effect, {many:?} for all");
    }
}

/// Operations of a right-hand side: of the position, the forces and the rates of states.
fn operations(scenes: &str) -> usize {
    let report = mbs_codegen::structure_of(&text(&EFFECTS, &format!("{}{scenes}", whole())), Some("Scene"))
        .expect("a scene");
    let counted = ["`position`", "`force`", "`state_rates`"];
    let costs =
        report.costs.into_iter().filter(|(name, _)| counted.iter().any(|counted| name.starts_with(counted)));
    costs
        .map(|(_, cost)| {
            cost.additions
                + cost.multiplications
                + cost.divisions
                + cost.sine_cosines
                + cost.functions
                + cost.selects
        })
        .sum()
}

#[test]
fn operations_of_a_right_hand_side_are_those_of_its_effects() {
    let of = |names: &[&'static str]| operations(&scene("Scene", names.iter().copied()));
    // A torque that is constant: it adds nothing that another effect takes.
    let base = of(&["constant"]);
    let names = EFFECTS.map(|(name, _)| name);
    let others = &names[1..];
    let singles: Vec<usize> = others.iter().map(|name| of(&["constant", name]) - base).collect();
    for (name, operations) in others.iter().zip(&singles) {
        println!("{name}: {operations} operations a right-hand side");
    }
    let all = of(&names) - base;
    let sum: usize = singles.iter().sum();
    assert!(all <= sum && 10 * all > 8 * sum, "{all} of {sum}");
    let cost =
        |wanted: &str| others.iter().zip(&singles).find(|(name, _)| **name == wanted).map(|(_, cost)| *cost);
    // The force and the rate of the deflection take the same values, each for itself.
    let [smooth, bristles] = ["smooth", "bristles"].map(|name| cost(name).expect("an effect"));
    assert!(smooth >= 5 && bristles <= 2 * (smooth + 10), "{smooth} {bristles}");
}

//! `mbs effects` on the engine, through the forge: minutes of a compiler, so behind the feature `long`.
#![cfg(feature = "long")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mechanisms::slider_crank_engine;
use serde_json::Value;

fn scratch(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    fs::create_dir_all(&path).expect("a directory");
    path
}

#[track_caller]
fn mbs(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {said}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[track_caller]
fn result(folder: &Path, arguments: &[&str]) -> Value {
    let text =
        mbs(folder, &[&["effects", "slider_crank_engine", "--json", "--out", "."], arguments].concat());
    let document: Value = serde_json::from_str(&text).expect("a document");
    document["result"].clone()
}

/// A column of the table of a run of a scene.
fn column(folder: &Path, scene: &str, name: &str) -> Vec<f64> {
    mbs(
        folder,
        &["run", &format!("./engine.mbs:SliderCrankEngine:{scene}"), "--steps", "500", "--out", scene],
    );
    let table = fs::read_to_string(folder.join(scene).join("motion.csv")).expect("a table");
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("names").split(',').collect();
    let index = head.iter().position(|column| column.split(' ').next() == Some(name)).expect("the column");
    lines
        .map(|line| line.split(',').nth(index).and_then(|cell| cell.parse().ok()).expect("a number"))
        .collect()
}

#[test]
fn the_scene_that_is_printed_for_the_engine_compiles_and_stays_within_the_bound() {
    let folder = scratch("effects-engine");
    let found = result(&folder, &["--watch", "side_load", "--within", "1%"]);
    println!("{}", found["sentence"]);
    let paste = found["paste"].as_str().expect("a statement");
    assert!(paste.starts_with("scene Enough = ") && paste.contains("gas"), "{paste}");
    for file in ["effects.html", "effects.svg", "effects.csv"] {
        assert!(folder.join(file).is_file(), "{file}");
    }
    assert_eq!(found["effects"].as_array().map(Vec::len), Some(8));
    // The gas has the largest side load, and all changes are known.
    for effect in found["effects"].as_array().into_iter().flatten() {
        assert!(effect["changes"][0]["largest"].as_f64().is_some(), "{effect}");
    }
    let source = slider_crank_engine::CARD.equations().source();
    fs::write(folder.join("engine.mbs"), format!("{source}\n{paste}\n")).expect("a text");
    let (enough, whole) = (column(&folder, "Enough", "side_load"), column(&folder, "Tight", "side_load"));
    let (low, high) = whole.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let change = enough.iter().zip(&whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (high - low);
    println!("side load of the printed scene: {:.2} % of 1 %", 100.0 * change);
    assert!(enough.len() == 501 && change < 0.01, "{change}");
    fs::remove_dir_all(folder).expect("scratch");
}

#[test]
fn effects_at_zero_coefficients_change_nothing() {
    let folder = scratch("effects-at-zero");
    // Not the spring: its end counts for the reference length, and so for the steps.
    let parameters: Vec<&str> =
        ["g=0", "drag=0", "stall=0"].iter().flat_map(|zero| ["--param", *zero]).collect();
    let only = ["--only", "gravity,fan,motor", "--watch", "side_load,crank_speed", "--until", "0.02"];
    let found = result(&folder, &[&parameters[..], &only].concat());
    for effect in found["effects"].as_array().into_iter().flatten() {
        for change in effect["changes"].as_array().into_iter().flatten() {
            let largest = change["largest"].as_f64().expect("a change");
            println!("{} at zero, {}: {largest:.1e}", effect["name"], change["output"]);
            assert!(largest < 1e-12, "{effect}");
        }
    }
    // So the scene of the other effects alone is enough, and costs less.
    assert_eq!(found["paste"], "scene Enough = gas + rod + liner_friction + pin_friction + spring;");
    fs::remove_dir_all(folder).expect("scratch");
}

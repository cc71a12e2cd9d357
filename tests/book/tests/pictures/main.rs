//! Pictures of laws of effects in the book, computed by the texts beside them.
//!
//! `build.rs` takes the texts out of the chapters, and some out of tests and ready mechanisms. After a change that is meant, run
//! `UPDATE_SNAPSHOTS=1 cargo test -p mbs-book --features long --test pictures` and look at the pictures.
#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};
use std::{env, fs};

use mbs_workbench::study::plot::{Curve, Plot};

/// Values of `$seen` of a run at its start and at `$parts` equal parts of the time from 0 to `$until`.
macro_rules! traced {
    ($text:expr, $until:expr, $parts:expr, |$run:ident| $seen:expr) => {{
        use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
        let method = Explicit::new(DormandPrince8, Projection::default());
        let start = Simulation::start_from_text($text, method, 0.0_f64).expect("it starts");
        let mut $run = start.with_tolerance(Tolerance::new(1e-9));
        let mut seen = vec![$seen];
        for part in 1..=$parts {
            $run.advance_to($until * f64::from(part) / f64::from($parts)).expect("it moves");
            seen.push($seen);
        }
        seen
    }};
}

/// Value of `$seen` at the start of a text.
macro_rules! begun {
    ($text:expr, |$run:ident| $seen:expr) => {{
        use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
        let method = Explicit::new(DormandPrince8, Projection::default());
        let $run = Simulation::start_from_text($text, method, 0.0_f64).expect("it starts");
        $seen
    }};
}

mod contact;
mod friction;
mod motors;
mod slopes;
mod springs;
mod tyres;

/// Texts of the chapters and of tests.
mod texts {
    use mbs_runtime::mechanism;

    include!(concat!(env!("OUT_DIR"), "/laws.rs"));
}

/// Names of all pictures.
const PICTURES: [&str; 27] = [
    "backlash",
    "bounces",
    "bushing",
    "clearance",
    "coasting",
    "contact_loop",
    "disk",
    "door",
    "drag",
    "friction_coefficient",
    "gas_spring",
    "half_car",
    "kerb",
    "lugre_speed",
    "motor_current",
    "one_way_spring",
    "pin_in_eye",
    "presliding",
    "restitution_asked",
    "restitution_speed",
    "stick_slip",
    "torque_speed",
    "torsion_bar",
    "turning_frame",
    "tyre_relaxation",
    "tyre_slip",
    "tyre_standstill",
];

/// Largest file (bytes).
const LARGEST: usize = 30_000;

/// Difference of two numbers of a drawing that is not seen.
const UNSEEN: f64 = 0.15;

/// A folder of the book.
fn book(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src").join(folder)
}

/// Curve through these places.
fn curve(label: &str, points: Vec<[f64; 2]>) -> Curve {
    Curve { label: label.to_string(), points, is_dashed: false }
}

/// Dashed line at a value.
fn level(label: &str, [from, to]: [f64; 2], value: f64) -> Curve {
    curve(label, vec![[from, value], [to, value]]).dashed()
}

/// Plot with the names of its axes.
fn plot(caption: &str, [x, y]: [&str; 2], curves: Vec<Curve>) -> Plot {
    Plot { caption: caption.to_string(), x: x.to_string(), y: y.to_string(), curves, ..Plot::default() }
}

/// Intervals of x in which a condition holds.
fn spans(seen: impl IntoIterator<Item = (f64, bool)>) -> Vec<[f64; 2]> {
    let (mut found, mut open) = (Vec::<[f64; 2]>::new(), false);
    for (x, holds) in seen {
        match found.last_mut() {
            Some(last) if holds && open => last[1] = x,
            _ if holds => found.push([x, x]),
            _ => {}
        }
        open = holds;
    }
    found
}

/// Numbers of a drawing, each with the letter behind it.
fn numbers(text: &str) -> Vec<(&str, &str)> {
    let pieces = text.split_inclusive(|letter: char| !letter.is_ascii_digit() && !".-".contains(letter));
    pieces.map(|piece| piece.split_at(piece.char_indices().next_back().map_or(0, |(at, _)| at))).collect()
}

/// `true` if two drawings look alike.
fn agree(one: &str, other: &str) -> bool {
    let alike = |(a, b): (&str, &str)| {
        let values = a.parse::<f64>().ok().zip(b.parse::<f64>().ok());
        a == b || values.is_some_and(|(a, b)| (a - b).abs() < UNSEEN)
    };
    let (one, other) = (numbers(one), numbers(other));
    one.len() == other.len() && one.iter().zip(&other).all(|(a, b)| a.1 == b.1 && alike((a.0, b.0)))
}

/// `true` if pictures are written anew.
fn is_update() -> bool {
    env::var_os("UPDATE_SNAPSHOTS").is_some()
}

/// Compares a picture with its file, or writes it.
fn hold(name: &str, plot: &Plot) {
    assert!(PICTURES.contains(&name), "{name} is not in the list");
    let path = book("pictures/laws").join(name).with_extension("svg");
    let drawn = plot.file();
    assert!(drawn.len() < LARGEST, "{name}: {} bytes", drawn.len());
    if is_update() {
        fs::write(&path, &drawn).expect("a file of the book");
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    assert!(agree(&stored, &drawn), "{} is not what its text gives", path.display());
}

#[test]
fn each_file_is_in_the_list_and_in_a_chapter_of_laws() {
    // Other tests write them meanwhile.
    if is_update() {
        return;
    }
    let names = fs::read_dir(book("pictures/laws")).expect("a folder").flatten();
    let mut names: Vec<String> =
        names.map(|entry| entry.path().file_stem().unwrap_or_default().to_string_lossy().into()).collect();
    names.sort();
    assert_eq!(names, PICTURES);
    let chapters = ["friction", "contact", "spring", "motor", "tyre"];
    let chapters = chapters.map(|family| book("language").join(format!("{family}_laws.md")));
    let chapters = chapters.map(|path| fs::read_to_string(path).expect("a chapter")).concat();
    let shown = |name: &&str| chapters.contains(&format!("](../pictures/laws/{name}.svg)"));
    assert_eq!(PICTURES.iter().filter(|name| !shown(name)).count(), 0);
}

#[test]
fn drawings_that_differ_by_what_is_seen_are_told() {
    let drawing = "<path class=\"line0\" d=\"M62.0 -1.5L70.1 20\"/>é";
    assert!(agree(drawing, &drawing.replace("70.1", "70.2")));
    assert!(!agree(drawing, &drawing.replace("70.1", "70.4")));
    assert!(!agree(drawing, &drawing.replace('M', "L")) && !agree(drawing, ""));
}

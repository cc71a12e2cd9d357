//! The emitted code of the four-bar, laid out and stored: a change of cost or of code is a difference to read.
//!
//! After a change that is meant, run `UPDATE_SNAPSHOTS=1 cargo test -p mbs-codegen --test emitted`.
#![forbid(unsafe_code)]

use std::fs;
use std::path::Path;

/// The example of the design (`DESIGN.md`, §1).
const FOUR_BAR: &str = "/// Four-bar linkage with a coupler point.
pub mechanism FourBar;
const L1: m = 0.10;
const L2: m = 0.25;
const L3: m = 0.20;
const L4: m = 0.30;
const L5: m = 0.15;
const ALPHA: rad = 0.4;
param omega: rad/s = TAU;
coord x2: m;
coord y2: m;
coord phi1: rad = 0.0;
coord phi2: rad = 0.9;
coord phi3: rad = 1.8;
constraint coupler_point {
    x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
    y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
}
constraint closure {
    L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
    L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
}
drive crank: phi1 == omega*t;
branch open: sin(phi3 - phi2) > 0;
out transmission_angle: rad = phi3 - phi2;
";

/// Code laid out as `rustfmt` would.
fn laid_out(text: &str) -> String {
    let items = mbs_codegen::expand_source(text).expect("a valid text");
    prettyplease::unparse(&syn::parse2(items).expect("Rust"))
}

#[test]
fn the_four_bar_is_what_is_stored() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/emitted/four_bar.rs");
    let found = laid_out(FOUR_BAR);
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &found).expect("a writable copy");
    }
    let stored = fs::read_to_string(&path).expect("the stored copy");
    for (number, (found, stored)) in found.lines().zip(stored.lines()).enumerate() {
        assert_eq!(found, stored, "line {} of {}", number + 1, path.display());
    }
    assert_eq!(found, stored);
}

#[test]
fn the_stored_code_states_its_cost() {
    let found = laid_out(FOUR_BAR);
    for function in ["parameters", "position", "phi", "phi_q", "phi_t", "gamma", "solve_with_position"] {
        assert!(found.contains(&format!("/// | `{function}`")), "{function}");
    }
}

/// A ball over a table, and a roller over a cam.
const CONTACTS: &str = "/// Two contacts.
pub mechanism Contacts;
function profile: m(rad), C3, periodic TAU;
coord x: m = 0.01;
coord y: m = 0.1;
curve cam = polar profile about [0, 0] turned t/1s*1rad;
body roller { mass: 1kg, com: [x, y] }
contact table { gap: y, stiffness: 1e6 [N/m] }
contact nose { gap: distance([x, y], cam), stiffness: 1e6 [N/m], damping: 1 [s/m] }
";

/// Body of Q.
fn force_of(text: &str) -> String {
    let found = laid_out(text);
    let force = found.split("fn force(").nth(1).expect("forces");
    force.split("fn force_q(").next().expect("a body").to_string()
}

#[test]
fn a_long_block_of_a_contact_ends_at_an_open_gap_and_a_short_one_has_no_test() {
    let force = force_of(CONTACTS);
    let blocks: Vec<&str> = force.split("if __p.1[").skip(1).collect();
    let [gap_of_nose, table, nose] = blocks[..] else { panic!("three blocks: {force}") };
    let places = [gap_of_nose, table, nose].map(|block| &block[..2]);
    assert_eq!(places, ["1]", "0]", "1]"], "gaps come before forces: {force}");
    assert!(table.contains("__sum[1] =") && !table.contains("T::all("), "{table}");
    let (kept, nose) =
        nose.split_once("if !T::all(T::less(T::constant(0.0f64), ").expect("a test of the gap");
    assert!(kept.contains("] = __gap1;"), "{kept}");
    let gap = nose.split_once(')').expect("the gap").0;
    assert!(
        gap_of_nose.contains(&format!("let {gap} =")) && gap_of_nose.contains("::jet::<"),
        "{gap_of_nose}"
    );
    assert!(!nose.contains("::jet::<") && nose.contains("__sum[0] ="), "{nose}");
    // Not evaluated: the gap is 1, which is open.
    assert!(gap_of_nose.contains("[T::constant(1.0f64); "), "{gap_of_nose}");
}

#[test]
fn contacts_share_the_sines_of_an_angle_and_keep_their_own() {
    let force = force_of(
        "/// A bar with two ends, and a wheel.
pub mechanism Bar;
coord y: m = 1;
coord phi: rad = 0.1;
coord psi: rad = 0.2;
body bar { mass: 1kg, com: [0, y], inertia: 1, angle: phi }
body wheel { mass: 1kg, com: [0, y], inertia: 1, angle: psi }
contact left { gap: y - sin(phi)*1m, stiffness: 1e6 [N/m] }
contact right { gap: y + sin(phi)*1m, stiffness: 1e6 [N/m] }
contact rim { gap: y + sin(psi)*1m, stiffness: 1e6 [N/m] }
",
    );
    // Nothing is computed for contacts of which none is evaluated.
    let (open, blocks) = force.split_once("if __p.1[0] || __p.1[1] {").expect("shared values");
    assert!(!open.contains("T::sin_cos(["), "{open}");
    let (shared, own) = blocks.split_once("} else {").expect("values that nobody reads");
    assert!(shared.contains("T::sin_cos([__s.0[1]])"), "{shared}");
    assert_eq!(own.matches("T::sin_cos([").count(), 1, "{own}");
    assert!(own.contains("T::sin_cos([__s.0[2]])"), "{own}");
}

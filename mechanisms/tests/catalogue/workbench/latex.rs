//! Documents of ready mechanisms.

use mbs_workbench::output::latex::*;
use mechanisms::CATALOGUE;

/// Every brace and every environment that is opened is closed in order.
#[track_caller]
fn assert_well_formed(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}', '\\']) {
        let (mark, after) = rest[at..].split_at(1);
        rest = after;
        match mark {
            "{" => open.push("{"),
            "}" => assert_eq!(open.pop(), Some("{"), "before {}", &rest[..rest.len().min(80)]),
            _ if rest.starts_with("begin{") => open.push(&rest[6..rest.find('}').expect("a name")]),
            _ if rest.starts_with("end{") => {
                assert_eq!(open.pop(), Some(&rest[4..rest.find('}').expect("a name")]));
            }
            _ => rest = &rest[rest.chars().next().map_or(0, char::len_utf8)..],
        }
        if mark == "\\" && (rest.starts_with("begin{") || rest.starts_with("end{")) {
            rest = &rest[rest.find('}').expect("a name") + 1..];
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert_eq!(text.matches("\\left").count(), text.matches("\\right").count());
    assert_eq!(text.matches('$').count() % 2, 0);
}

#[test]
fn every_mechanism_is_a_well_formed_document() {
    for card in CATALOGUE.fixed() {
        let mechanism = card.equations();
        let formulas =
            mbs_codegen::latex_formulas(mechanism.source(), Some(mechanism.scene())).expect("a good text");
        let text =
            document(&values(mechanism.as_ref()), &formulas, None, &card.picture().expect("a text").title);
        assert_well_formed(&text);
        assert!(text.starts_with("\\documentclass") && text.ends_with("\\end{document}\n"));
    }
}

#[test]
fn masses_and_forces_stand_behind_the_constraints() {
    for card in CATALOGUE.free().filter(|card| card.name() != "n_four_bar_40") {
        let mechanism = card.equations();
        let (source, scene) = (mechanism.source(), Some(mechanism.scene()));
        let formulas = mbs_codegen::latex_formulas(source, scene).expect("a good text");
        let dynamic = mbs_codegen::latex_dynamic_formulas(source, scene).expect("a good text");
        let dynamic = dynamic.expect("it has masses");
        let text = document(
            &values(mechanism.as_ref()),
            &formulas,
            Some(&dynamic),
            &card.picture().expect("a text").title,
        );
        assert_well_formed(&text);
        let [motion, mass, force] = ["\\mathbf{M}\\,\\ddot{\\mathbf{q}}", "\\mathbf{M} = ", "\\mathbf{Q} = "]
            .map(|part| text.find(part));
        assert!(motion.is_some() && motion < mass && mass < force, "{}", card.name());
    }
}

#[test]
fn the_pendulum_has_the_mass_and_the_weight_of_its_bob() {
    let mechanism = mechanisms::pendulum::CARD.equations();
    let dynamic = mbs_codegen::latex_dynamic_formulas(mechanism.source(), None).expect("a good text");
    let dynamic = dynamic.expect("it has masses");
    let formulas = mbs_codegen::latex_formulas(mechanism.source(), None).expect("a good text");
    let text = document(&values(mechanism.as_ref()), &formulas, Some(&dynamic), "");
    assert!(text.contains("\\mathbf{M} = \\begin{bmatrix}\n  m & 0 \\\\\n  0 & m\n\\end{bmatrix}"), "{text}");
    assert!(
        dynamic.force[1].starts_with('-') && ["g", "m"].iter().all(|part| dynamic.force[1].contains(part))
    );
}

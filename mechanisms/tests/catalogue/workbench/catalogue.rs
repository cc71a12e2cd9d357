//! The list of ready mechanisms: names, presets, pictures.

use mbs_workbench::card::Card;
use mbs_workbench::catalogue::Catalogue;
use mbs_workbench::mismatch::{Mismatch, set};

use mechanisms::CATALOGUE;

#[test]
fn names_are_unique_and_found() {
    assert_eq!(CATALOGUE.repeated(), None);
    for card in CATALOGUE.iter() {
        let found = CATALOGUE.find(&card.name()).expect("in the list");
        assert_eq!(found.constructor, card.constructor);
    }
}

#[test]
fn a_name_is_found_without_instances_of_other_texts() {
    let card = *CATALOGUE.find("four_bar_mass:Driven").expect("in the list");
    let dear = Card { make: || panic!("an instance was made"), constructor: "dear()", ..card };
    let cards = [dear, card];
    let catalogue = Catalogue { cards: &cards };
    assert_eq!(catalogue.repeated(), None);
    assert!(catalogue.find("four_bar_mass:Driven").is_ok());
    assert_eq!(Catalogue { cards: &[dear, card, card] }.repeated().as_deref(), Some("four_bar_mass:Driven"));
}

#[test]
fn a_free_mechanism_has_equations_and_says_that_it_cannot_be_run() {
    for card in CATALOGUE.free() {
        let equations = card.equations();
        // Rows that follow from others may hide degrees of freedom from a count.
        let hidden = usize::from(equations.source().contains(" redundant {"));
        assert!(equations.rows().len() < equations.coordinates().len() + hidden, "{}", card.name());
        assert!(equations.tables().is_some(), "{}", card.name());
        let text = card.mechanism().expect_err("free").to_string();
        assert!(text.contains("is free to move"), "{text}");
    }
    let four_bar = CATALOGUE.find("four_bar").expect("in the list");
    assert_eq!(four_bar.equations().type_name(), "FourBar");
}

#[test]
fn an_unknown_mechanism_gets_a_proposal_and_the_list() {
    let text = CATALOGUE.find("fourbar").expect_err("no such name").to_string();
    assert!(text.contains("did you mean `four_bar`?") && text.contains("slider_crank"), "{text}");
    let text = CATALOGUE.find("zzz").expect_err("no such name").to_string();
    assert!(!text.contains("did you mean") && text.contains("four_bar"), "{text}");
}

#[test]
fn every_preset_fits_its_mechanism() {
    for card in CATALOGUE.iter() {
        let picture = card.picture().expect("a text");
        assert!(!picture.presets.is_empty() && picture.span.is_some(), "{}", card.name());
        for run in &picture.presets {
            let mechanism = card.instance(run).expect("parameters of the preset");
            assert!(card.duration(mechanism.equations()).expect("a duration") > 0.0);
        }
    }
}

#[test]
fn no_motion_comes_near_a_singular_position() {
    /// Rates are refused below 5e-7; the least here is 0.063, at `determinant_guide`.
    const MARGIN: f64 = 0.05;
    for card in CATALOGUE.fixed() {
        for (index, run) in card.runs().expect("a text").iter().enumerate() {
            let margin = crate::reference::one_turn(card, index, 360).margin;
            let least = margin.into_iter().fold(f64::INFINITY, f64::min);
            assert!(least > MARGIN, "{}, {}: {least}", card.name(), run.label);
        }
    }
}

#[test]
fn pictures_are_drawn_by_their_texts_from_outputs_and_coordinates() {
    for card in CATALOGUE.iter() {
        let picture = card.picture().expect("a text");
        assert!(!picture.is_guessed, "{}", card.name());
        let coordinates = card.equations().coordinates();
        for place in picture.places() {
            let is_coordinate = coordinates.iter().any(|entry| entry.name == place.name && entry.is_angle());
            let is_pin = picture.forces.iter().any(|force| force.at == place.name);
            assert!(place.is_output || is_coordinate || is_pin, "{}: {}", card.name(), place.name);
        }
    }
}

#[test]
fn a_bad_parameter_changes_nothing() {
    let mut mechanism = CATALOGUE[0].mechanism().expect("its rows fix it");
    let before = mechanism.get(0);
    assert!(matches!(set(mechanism.as_mut(), "L9", 1.0), Err(Mismatch::Parameter { .. })));
    let name = mechanism.variables()[0].name;
    assert!(matches!(set(mechanism.as_mut(), name, f64::NAN), Err(Mismatch::NotFinite { .. })));
    assert_eq!(mechanism.get(0), before);
}

#[test]
fn a_crank_at_rest_never_ends_its_turn() {
    let mut mechanism = CATALOGUE[0].mechanism().expect("its rows fix it");
    set(mechanism.as_mut(), "omega", 0.0).expect("a parameter");
    assert!(matches!(CATALOGUE[0].duration(mechanism.as_ref()), Err(Mismatch::NoTurn { .. })));
}

#[test]
fn every_mechanism_with_functions_has_stand_ins() {
    for card in CATALOGUE.fixed() {
        assert_eq!(card.equations().functions().is_empty(), card.stand_in.is_none(), "{}", card.name());
    }
}

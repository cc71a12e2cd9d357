//! Step sizes for which Newton converges on ready mechanisms.

use mbs_workbench::teaching::next_position::*;
use mechanisms::CATALOGUE;

#[test]
fn the_predictor_bears_larger_steps_than_the_previous_position() {
    let card = CATALOGUE.find("four_bar").expect("in the list");
    let mechanism = card.mechanism().expect("its rows fix it");
    let course = ReferenceMotion::new(mechanism.as_ref(), 1.0, 12).expect("it turns");
    let small = STEP_METHODS.map(|way| course.trial(way, 1.0 / 360.0));
    assert!(small.iter().all(StepAttempts::is_safe), "{small:?}");
    assert!(small[0].iterations > small[1].iterations, "{small:?}");
    let steps: Vec<f64> = (1..=18).map(|k| f64::from(k) / 36.0).collect();
    let [previous, _, stepper] = STEP_METHODS.map(|way| course.largest_safe_step(way, &steps));
    assert!(previous > 0.01 && previous < stepper, "{previous} {stepper}");
}

#[test]
fn an_open_chain_bears_any_step() {
    let card = CATALOGUE.find("open_chain").expect("in the list");
    let mechanism = card.mechanism().expect("its rows fix it");
    let course = ReferenceMotion::new(mechanism.as_ref(), 1.0, 4).expect("it moves");
    assert_eq!(course.largest_safe_step(StepMethod::Previous, &[0.1, 0.5]), 0.5);
    assert_eq!(course.trial(StepMethod::Previous, 0.5).failed(), 0);
}

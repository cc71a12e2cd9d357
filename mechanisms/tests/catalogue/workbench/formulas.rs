//! Closed-form positions of ready mechanisms.

use mechanisms::CATALOGUE;

#[test]
fn the_four_bar_has_two_mirrored_positions_and_the_assembly_takes_the_declared_one() {
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    let experiment = mechanism.experiment();
    for mirror in [1.0, -1.0] {
        let guess: Vec<f64> = experiment.guess().iter().map(|q| mirror * q).collect();
        let [formula] = &experiment.formulas(&guess, 0.0)[..] else { panic!("one dyad") };
        let [first, second] = formula.positions.as_ref().expect("the bars reach");
        assert!(first.iter().zip(second).all(|(a, b)| (a + b).sin().abs() < 1e-12), "{formula:?}");
        let assembled = experiment.assembled(&guess, 0.0, true).expect("it assembles");
        let taken: Vec<f64> = formula.coordinates.iter().map(|index| assembled[*index]).collect();
        assert_eq!(formula.taken, taken);
    }
}

#[test]
fn bars_that_do_not_reach_have_no_position() {
    let mut mechanism =
        CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    mbs_workbench::mismatch::set(mechanism.as_mut(), "L2", 0.05).expect("a parameter");
    let experiment = mechanism.experiment();
    let [formula] = &experiment.formulas(&experiment.guess(), 0.0)[..] else { panic!("one dyad") };
    assert!(formula.positions.is_none(), "{formula:?}");
}

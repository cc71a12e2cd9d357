//! Single steps of the solvers on ready mechanisms.

use mechanisms::CATALOGUE;

#[test]
fn newton_converges_with_order_two_on_the_four_bar() {
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    for plain in [false, true] {
        let protocol = mechanism.experiment().iterations(&mechanism.experiment().guess(), 0.1, plain);
        assert!(protocol.found.is_ok());
        let block = protocol.blocks.iter().max_by_key(|b| b.iterates.len()).expect("a block");
        let orders: Vec<f64> = (0..block.iterates.len()).filter_map(|k| block.order(k)).collect();
        let last = orders.last().expect("an order");
        assert!((1.7..2.4).contains(last), "{orders:?}");
    }
}

#[test]
fn a_mechanism_without_branches_takes_the_assembly_that_is_near() {
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    let mirror: Vec<f64> = mechanism.experiment().guess().iter().map(|q| -q).collect();
    let sides = [true, false].map(|branches| {
        let q = mechanism.experiment().assembled(&mirror, 0.0, branches).expect("an assembly");
        mechanism.experiment().branch_values(&q, 0.0)[0]
    });
    assert!(sides[0] > 0.0 && sides[1] < 0.0, "{sides:?}");
}

#[test]
fn a_step_of_the_stepper_is_that_of_the_motion() {
    let mechanism =
        CATALOGUE.find("slider_crank").expect("in the list").mechanism().expect("its rows fix it");
    let q =
        mechanism.experiment().assembled(&mechanism.experiment().guess(), 0.0, true).expect("it assembles");
    let (next, _) = mechanism.experiment().advance(&q, 0.0, 0.001).expect("it moves");
    let motion = mechanism.follow(&[0.0, 0.001], &mut |_| ()).expect("it moves");
    let last: Vec<f64> = motion.coordinates.iter().map(|curve| curve.q[1]).collect();
    assert!(next.iter().zip(last).all(|(a, b)| (a - b).abs() < 1e-14));
}

//! Tests of `mechanisms::scotch_yoke`.

use crate::closed_form::{Jet, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::scotch_yoke::*;

#[test]
fn the_yoke_moves_harmonically() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "x", "y"], 1e-14, |Jet([t, ..])| {
        let (w, r) = (10.0, 0.06);
        let (s, c) = (w * t).sin_cos();
        vec![
            Jet([w * t, w, 0.0]),
            Jet([r * c, -r * w * s, -r * w * w * c]),
            Jet([r * s, r * w * c, -r * w * w * s]),
        ]
    });
}

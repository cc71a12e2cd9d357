//! Tests of `mechanisms::n_four_bar`.

use mechanisms::n_four_bar::*;

/// Time (s), place of B0 (m) and its velocity (m/s), by integrators of high order apart from this workspace: N = 1 and 2.
const ROWS: [[[f64; 5]; 2]; 2] = [
    [
        [1.0, -0.2607126751836504, -0.9654164391590732, -6.6378094961217515, 1.7925539703889306],
        [10.0, 0.47838505776097057, 0.8781501787912093, 1.7272640755471536, -0.9409521793715157],
    ],
    [
        [1.0, -0.1950203019494351, -0.9807992056621738, -6.6766780368811585, 1.3275783251604871],
        [10.0, 0.3284581115408154, 0.944518538178601, 1.4230514702069441, -0.49486884548704296],
    ],
];

#[test]
fn the_closed_form_has_the_numbers_of_the_reference() {
    for (card, rows) in [mechanisms::n_four_bar_1::CARD, CARD].iter().zip(ROWS) {
        for [t, x, y, vx, vy] in rows {
            let found = closed_form(card.equations().as_ref(), t).expect("they turn");
            let apart = found.q[..2].iter().chain(&found.qd[..2]).zip([x, y, vx, vy]);
            let apart = apart.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(apart < 2e-12, "{} at {t}: {apart:e}", card.name());
        }
    }
}

//! Tests of `mechanisms::pendulum`.

use mechanisms::pendulum::*;

/// Time (s), position (m) and velocity (m/s), by quadrature apart from this workspace.
const ROWS: [[f64; 5]; 3] = [
    [1.0, 0.9862917511318753, -0.16501085312554117, 0.2969055159163158, 1.7746436411126556],
    [5.0, -0.9423054350437573, -0.3347543384140006, 0.8579042568859491, -2.4149286543704886],
    [10.0, -0.2750874625761169, -0.961419205099125, 4.175598100951729, -1.1947490545604753],
];

#[test]
fn the_closed_form_has_the_numbers_of_the_reference() {
    for [t, x, y, vx, vy] in ROWS {
        let found = closed_form(CARD.equations().as_ref(), t).expect("a swing");
        let apart = found.q.iter().chain(&found.qd).zip([x, y, vx, vy]);
        let apart = apart.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
        assert!(apart < 2e-13, "{t}: {apart:e}");
    }
}

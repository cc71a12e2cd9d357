//! D26: a declared rate at a dead centre, where its coordinate has none but 0, was met with 1e9 rad/s of the others.

use mbs_runtime::dynamics::{DormandPrince5, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Dynamic, mechanism};

mechanism! {
    /// A point on a rod, started by its abscissa.
    pub mechanism Rod;
    param L: m = 1;
    param x: m = 1;
    param v: m/s = 1;
    coord p: [m; 2] = [0.5, 0.5];
    body bob { mass: 1, com: p }
    constraint rod { norm(p) == L; }
    start p[0] = x rate v;
}

mechanism! {
    /// The same by its angle.
    pub mechanism Cosine;
    param L: m = 1;
    param v: m/s = 1;
    coord x: m = 0.5;
    coord a: rad = 0.3;
    body slider { mass: 1, com: [x, 0] }
    body wheel { mass: 1, inertia: 1, com: [0, 0], angle: a }
    constraint scotch { x == L*cos(a); }
    start x = L rate v;
}

mechanism! {
    /// A slider-crank started by its slider, with a rotor of its own that turns fast.
    pub mechanism Crank;
    param x0: m = 0.23;
    param v: m/s = 1;
    coord x: m = 0.2;
    coord a: rad = 0.3;
    coord b: rad = -0.1;
    coord g: rad = 0;
    body crank { mass: 1, inertia: 1e-3, com: 25mm*unit(a), angle: a }
    body slider { mass: 1, com: [x, 0] }
    body rotor { mass: 1, inertia: 1, com: [0, 0], angle: g }
    constraint closure { 50mm*unit(a) + 180mm*unit(b) == [x, 0]; }
    start x = x0 rate v;
    start g = 0 rate 1e3;
}

mechanism! {
    /// A four-bar linkage whose rocker starts next to the end of its swing.
    pub mechanism FourBar;
    param off: rad = 0;
    param v: rad/s = 1;
    coord c: rad = 1.8;
    coord a: rad = 0.3;
    coord b: rad = 0.9;
    body crank { mass: 1, inertia: 1e-3, com: 50mm*unit(a), angle: a }
    body rocker { mass: 1, inertia: 1e-2, com: [0.3m, 0] + 0.1m*unit(c), angle: c }
    constraint closure { 0.1m*unit(a) + 0.25m*unit(b) == [0.3m, 0] + 0.2m*unit(c); }
    start c = PI - acos((0.3^2 + 0.2^2 - 0.35^2)/(2*0.3*0.2)) + off rate v;
}

mechanism! {
    /// Two rods that have nothing in common, each started by its abscissa.
    pub mechanism TwoRods;
    param v: m/s = 1;
    param w: m/s = -1;
    param off: m = 0;
    coord p: [m; 2] = [0.5, 0.5];
    coord r: [m; 2] = [0.5, 0.5];
    body first { mass: 1, com: p }
    body second { mass: 1, com: r }
    constraint rods { norm(p) == 1m; norm(r) == 1m; }
    start p[0] = 1 rate v;
    start r[0] = 1m - off rate w;
}

/// Rates of a start, and the rate that was moved with its declared and its actual value.
fn started<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: S,
) -> ([f64; N], Option<(bool, f64, f64)>) {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run =
        Simulation::start_from_text(mechanism, method, 0.0).unwrap_or_else(|failure| panic!("{failure}"));
    (*run.qd(), run.moved_start().map(|moved| (moved.rate, moved.declared, moved.actual)))
}

/// The declared rate is told as moved to 0, and no other is larger than `most`.
fn assert_no_rate<const N: usize>(
    what: &str,
    (qd, moved): ([f64; N], Option<(bool, f64, f64)>),
    declared: f64,
    most: f64,
) {
    let (rate, told, actual) = moved.unwrap_or_else(|| panic!("{what}: {qd:?} not told"));
    assert!(rate && told == declared && actual.abs() < 1e-6 * declared.abs(), "{what}: {told} {actual}");
    let fastest = qd.iter().fold(0.0, |fastest: f64, rate| fastest.max(rate.abs()));
    assert!(fastest <= most, "{what}: {qd:?}");
}

#[test]
fn a_rate_that_no_motion_has_at_a_dead_centre_is_told() {
    for v in [1.0, -1.0, 1e-3, 1e3] {
        for length in [1.0, 0.3, 1000.0] {
            let rod = Rod { L: length, x: length, v };
            assert_no_rate("rod", started(rod), v, v.abs());
            assert_no_rate("cosine", started(Cosine { L: length, v }), v, v.abs());
        }
        for x0 in [0.23, 0.13] {
            assert_no_rate("crank", started(Crank { x0, v }), v, 1e3);
        }
        assert_no_rate("four-bar", started(FourBar { v, ..FourBar::default() }), v, v.abs());
    }
}

#[test]
fn next_to_a_dead_centre_within_rounding_the_rate_is_that_of_the_dead_centre() {
    for off in [1e-16, 1e-15, 5e-15] {
        assert_no_rate("rod", started(Rod { x: 1.0 - off, ..Rod::default() }), 1.0, 1.0);
        assert_no_rate("crank", started(Crank { x0: 0.23 * (1.0 - off), v: 1.0 }), 1.0, 1e3);
        assert_no_rate("four-bar", started(FourBar { off, ..FourBar::default() }), 1.0, 1.0);
    }
}

#[test]
fn off_a_dead_centre_large_rates_are_kept() {
    for off in [0.1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11] {
        let (qd, moved) = started(Rod { x: 1.0 - off, ..Rod::default() });
        // y = √(1 − x²), ẏ = −x v/y; x itself is known to 1e-16.
        let exact = -(1.0 - off) / (off * (2.0 - off)).sqrt();
        assert!(
            moved.is_none() && (qd[1] / exact - 1.0).abs() < 1e-12 + 1e-14 / off,
            "{off:e}: {qd:?} {exact}"
        );
        let (qd, moved) = started(FourBar { off, ..FourBar::default() });
        assert!(
            moved.is_none() && (qd[0] - 1.0).abs() < 1e-9 && qd[1].abs() > 0.5 / off.sqrt(),
            "{off:e}: {qd:?}"
        );
        let (qd, moved) = started(Crank { x0: 0.23 * (1.0 - off), v: 1.0 });
        assert!(
            moved.is_none() && (qd[0] - 1.0).abs() < 1e-9 && qd[1].abs() > 1.0 / off.sqrt(),
            "{off:e}: {qd:?}"
        );
    }
    // At rest nothing is moved.
    assert_eq!(started(Rod { v: 0.0, ..Rod::default() }), ([0.0; 2], None));
}

#[test]
fn dead_centres_of_parts_with_nothing_in_common_are_told_apart() {
    for w in [-1.0_f64, 1.0, 1e3] {
        let most = w.abs();
        assert_no_rate(
            "both",
            started(TwoRods { w, ..TwoRods::default() }),
            if most > 1.0 { w } else { 1.0 },
            most,
        );
        for off in [1e-10, 1e-3, 0.3] {
            let (qd, moved) = started(TwoRods { w, off, ..TwoRods::default() });
            let (rate, declared, actual) = moved.expect("the first has no rate");
            assert!(rate && declared == 1.0 && actual.abs() < 1e-6, "{off:e}: {moved:?}");
            let exact = -w * (1.0 - off) / (off * (2.0 - off)).sqrt();
            let error = (qd[2] / w - 1.0).abs().max((qd[3] / exact - 1.0).abs());
            assert!(
                qd[0].abs() < 1e-6 && qd[1].abs() < 1.0 && error < 1e-9 + 1e-14 / off,
                "{off:e}: {qd:?} {exact}"
            );
        }
    }
}

#[test]
fn single_precision_tells_a_dead_centre_within_its_own_rounding() {
    for length in [1.0_f32, 0.3, 1000.0] {
        let start = |x: f32| {
            let rod = Rod { L: length, x, v: 1.0_f32 };
            let method = Explicit::new(DormandPrince5, Projection::default());
            let run = Simulation::start_from_text(rod, method, 0.0).expect("a start");
            (*run.qd(), run.moved_start().map(|moved| moved.actual))
        };
        let (qd, moved) = start(length);
        assert!(moved.is_some_and(|actual| actual < 1e-3) && qd[1].abs() < 1.0, "{length}: {qd:?}");
        let (qd, moved) = start(length * 0.999);
        assert!(moved.is_none() && (qd[1] + 22.344).abs() < 0.1, "{length}: {qd:?}");
    }
}

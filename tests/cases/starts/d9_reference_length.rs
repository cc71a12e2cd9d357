//! D9: a guess in other units than the dimensions set the reference length, and with it the tolerance.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Mechanism, Stepper, mechanism};

mechanism! {
    /// A pendulum as a point on a rod, with a guess for a rod of a metre.
    pub mechanism ShortPendulum;
    param L: m = 1;
    param x0: m = 1;
    coord x: m = 1;
    coord y: m = -1m;
    body bob { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { norm([x, y]) == L; }
    start x = x0 rate 0;
}

/// Place at `t` (s) of a pendulum of length `l` (m) that starts at rest at the angle `phi`, by RK4 in the angle.
fn swung(l: f64, phi: f64, t: f64) -> [f64; 2] {
    let (steps, rate) = (4000, |[phi, w]: [f64; 2]| [w, -9.81 / l * phi.sin()]);
    let h = t / f64::from(steps);
    let mut y = [phi, 0.0];
    let along = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    for _ in 0..steps {
        let a = rate(y);
        let b = rate(along(y, a, 0.5 * h));
        let c = rate(along(y, b, 0.5 * h));
        let d = rate(along(y, c, h));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    [l * y[0].sin(), -l * y[0].cos()]
}

#[test]
fn a_short_pendulum_with_its_guess_in_metres_is_as_exact_as_a_long_one() {
    for k in 0..200 {
        // From half a millimetre to two; up to 1.4 rad; three swings.
        let (l, phi) = (5e-4 + 1e-5 * f64::from(k % 150), 0.007 * f64::from(k));
        let t = 6.0 * core::f64::consts::PI * (l / 9.81).sqrt();
        let pendulum = ShortPendulum::<f64> { L: l, x0: l * phi.sin() };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let mut run = Simulation::start_from_text(pendulum, method, 0.0).unwrap();
        run.advance_to(t).unwrap();
        let (q, exact) = (run.q(), swung(l, phi, t));
        let error = (q[0] - exact[0]).abs().max((q[1] - exact[1]).abs()) / l;
        // 1e-9 a step over some tens of them.
        assert!(error < 1e-7, "L = {l}, {phi} rad: {error:e}");
    }
}

mechanism! {
    /// A slider-crank whose lengths are multiples of one, its guess in metres.
    pub mechanism Ratios;
    param r: m = 1;
    coord A: [m; 2] = [0.5, 0.8];
    coord x: m = 4;
    constraint crank { A == r*unit(0.3 + 1*t/1s); }
    constraint rod { norm(A - [x, 0]) == 3*r; }
    branch ahead: x > dot(A, [1, 0]);
}

#[test]
fn a_mechanism_is_the_same_in_every_size() {
    let of = |r: f64| {
        let ratios = Ratios { r };
        let guess = ratios.guess(&ratios.parameters());
        assert_eq!(ratios.reference().map(|entry| entry.name), Some("r"));
        let mut run = Stepper::assemble(ratios, guess, 0.0).unwrap();
        run.advance_to(0.5).unwrap();
        (run.q().map(|q| q / r), run.margin())
    };
    let (known, margin) = of(1.0);
    for r in [1e-6, 1e-3, 1e3] {
        let (q, found) = of(r);
        let error = q.iter().zip(known).map(|(q, known)| (q - known).abs()).fold(0.0, f64::max);
        assert!(error < 1e-13 && (found - margin).abs() < 1e-12, "{r}: {q:?} {found}");
    }
}

mechanism! {
    /// Lengths that the text does not know: a spacer of a millimetre beside what an input gives.
    pub mechanism Measured;
    input reach: m, rates;
    coord x: m = 2;
    constraint along { x == reach + 1mm; }
}

#[test]
fn guesses_count_where_the_text_has_no_other_lengths() {
    let measured = Measured::<f64>::default();
    assert_eq!(measured.coordinate_scales(&measured.parameters()), [2.0]);
    let zero = Ratios { r: 0.0 };
    assert_eq!(zero.coordinate_scales(&zero.parameters()), [4.0; 3]);
}

mechanism! {
    /// A block without a length: the millimetre of a speed is none.
    pub mechanism Block;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    force load: 10N on y;
    constraint guide { y == 0; }
    friction rub { along: x, normal: lambda(guide), coefficient: 0.5, speed: 1mm/1s }
}

#[test]
fn the_millimetre_of_a_speed_is_no_length_of_the_mechanism() {
    let block = Block::<f64>::default();
    assert_eq!(block.coordinate_scales(&block.parameters()), [1.0; 2]);
}

mechanism! {
    /// A block on a floor whose stiffness is a force over a millimetre.
    pub mechanism Sprung;
    const soft: N/m = 5N/1mm;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    force drive: [3N, 0] on [x, y];
    contact floor { gap: y, stiffness: 2N/1mm, damping: 1s/1mm }
    tsda hold { from: [-1, 0], to: [x, y], stiffness: soft, damping: 3 [N*s]/1mm }
    constraint guide { y == 0; }
}

#[test]
fn the_millimetre_of_a_stiffness_is_no_length_of_the_mechanism() {
    let sprung = Sprung::<f64>::default();
    assert_eq!(sprung.coordinate_scales(&sprung.parameters()), [1.0; 2]);
}

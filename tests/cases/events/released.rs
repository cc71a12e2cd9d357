//! Effects that release a constraint: a pendulum that is cut loose, and a crank whose rod comes off, against closed forms.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    /// A bob on a rod that may be cut.
    mechanism Cut;
    const L: m = 0.8;
    coord p: [m; 2] = [0.48, -0.64];
    body bob { mass: 0.5kg, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == L^2; }
    start p = [0.48, -0.64] rate [2.4, 1.8];
    out pull: N = 2*L*lambda(rod);
    effect rubbing {
        friction rub { along: p[0], normal: lambda(rod)*2*L, coefficient: 0.5, sticks: 0.6, viscous: 0 }
    }
    effect cut { release rod; }
    effect burnt { release rod; }
    effect none {}
    scene Swinging = none;
    scene Flying = cut;
    scene Rubbed = cut + rubbing + burnt;
}

mechanism! {
    /// Two carts on a bar, or on a spring in its place.
    mechanism Carts;
    coord x: [m; 2] = [0, 1];
    for i in 0..2 { body cart { mass: 2kg, com: [x[i], 0] } }
    constraint bar { x[1] - x[0] == 1m; }
    out pull: N = lambda(bar);
    effect elastic {
        release bar;
        tsda coupling { from: [x[0], 0], to: [x[1], 0], stiffness: 100, length: 1 }
        start x = [0, 1] rate [1, 0];
    }
}

/// Number of rows.
fn rows<const N: usize, const M: usize>(_: &impl Mechanism<f64, N, M>) -> usize {
    M
}

fn method() -> Explicit<DormandPrince8, Projection> {
    Explicit::new(DormandPrince8, Projection::default())
}

/// Place and velocity of a flight from `p` with `v`.
fn flight(p: [f64; 2], v: [f64; 2], t: f64) -> [f64; 4] {
    [p[0] + v[0] * t, p[1] + v[1] * t - 9.81 * t * t / 2.0, v[0], v[1] - 9.81 * t]
}

fn assert_flies(found: ([f64; 2], [f64; 2]), expected: [f64; 4]) {
    let ([x, y], [u, v]) = found;
    for (found, expected) in [x, y, u, v].into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-13, "{found} is not {expected}");
    }
}

#[test]
fn a_bob_that_is_cut_loose_flies_on_a_parabola() {
    assert_eq!((rows(&CutSwinging::<f64>::default()), rows(&CutFlying::<f64>::default())), (1, 0));
    let mut run = Simulation::start_from_text(CutFlying::<f64>::default(), method(), 0.0).expect("a start");
    // The force of a row that is not there is known without a motion.
    assert_eq!(run.outputs()[0].value, 0.0);
    run.advance_to(0.9).expect("a flight");
    assert_flies((*run.q(), *run.qd()), flight([0.48, -0.64], [2.4, 1.8], 0.9));
    let mut rubbed =
        Simulation::start_from_text(CutRubbed::<f64>::default(), method(), 0.0).expect("a start");
    rubbed.advance_to(0.9).expect("a flight");
    assert_flies((*rubbed.q(), *rubbed.qd()), flight([0.48, -0.64], [2.4, 1.8], 0.9));
}

#[test]
fn a_bob_is_cut_loose_while_it_swings() {
    let run = Simulation::start_from_text(CutSwinging::<f64>::default(), method(), 0.0).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(0.4).expect("it swings");
    let ([x, y], [u, v]) = (*run.q(), *run.qd());
    assert!((x.hypot(y) - 0.8).abs() < 1e-12 && (x * u + y * v).abs() < 1e-12);
    // Newton's law along the rod.
    let [pull] = run.loads();
    let expected = 0.5 * ((u * u + v * v) / 0.8 - 9.81 * y / 0.8);
    assert!((pull - expected).abs() < 1e-10, "{pull} is not {expected}");
    let flying: CutFlying<f64> = run.mechanism().scene();
    let mut flying = run.continue_as(flying, method()).expect("nothing contradicts").run;
    flying.advance_to(1.0).expect("it flies");
    assert_flies((*flying.q(), *flying.qd()), flight([x, y], [u, v], 0.6));
}

#[test]
fn a_spring_takes_the_place_of_a_bar() {
    let run = Simulation::start_from_text(Carts::<f64>::default(), method(), 0.0).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(0.7).expect("it moves");
    // Of the relative motion the mass is 1 kg.
    let omega = 10.0_f64;
    let stretch = -(omega * 0.7).sin() / omega;
    let [x, y] = *run.q();
    assert!((y - x - 1.0 - stretch).abs() < 1e-11, "{}", y - x - 1.0);
    assert!((x + y - 1.0 - 0.7).abs() < 1e-12);
}

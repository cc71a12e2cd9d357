//! D5: friction with the normal force of a contact, which is a function of positions and rates: in a loop, in two sets of coordinates.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, GeneralizedAlpha, Method, Projection, Simulation, Tolerance,
};
use mbs_runtime::{Dynamic, Mechanism, mechanism};

mechanism! {
    /// Two equal balls that slide on a floor which gives way: one by its place, one by the sum and difference of two coordinates.
    mechanism Sledges;
    param k: N/m = 2e4;
    coord x: m = 0;
    coord y: m = 0;
    coord a: m = 0;
    coord b: m = 0;
    let p = [[x, y], [a + b, a - b]];
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..2 {
        body ball { mass: 2kg, com: p[i] }
        friction drag { along: p[i, 0], normal: normal(floor[i]), coefficient: 0.3, speed: 0.5 }
        out carried: N = normal(floor[i]);
        out lost: W = -power(drag[i]);
    }
    for i in 0..2 { contact floor { gap: p[i, 1], stiffness: k, damping: 0.2 } }
    start x = 0 rate 2;
    start y = 0 rate 0;
    start a = 0 rate 1;
    start b = 0 rate 1;
}

const END: f64 = 0.4;

/// Place and rate of a ball at the end, by Runge and Kutta's method on the law typed by hand.
fn slid() -> [f64; 4] {
    let normal = |y: f64, v: f64| 2e4 * (-y).max(0.0) * (1.0 - 0.2 * v).max(0.0);
    let rates = |[_, y, u, v]: [f64; 4]| {
        let n = normal(y, v);
        [u, v, -0.3 * n * (u / 0.5).tanh() / 2.0, n / 2.0 - 9.81]
    };
    let (h, mut s) = (1e-5, [0.0, 0.0, 2.0, 0.0]);
    for _ in 0..(END / h).round() as u32 {
        let moved = |k: [f64; 4], part: f64| core::array::from_fn(|i| s[i] + part * h * k[i]);
        let first = rates(s);
        let second = rates(moved(first, 0.5));
        let third = rates(moved(second, 0.5));
        let fourth = rates(moved(third, 1.0));
        s = core::array::from_fn(|i| s[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    s
}

/// Largest error of both balls.
fn error(q: [f64; 4], qd: [f64; 4]) -> f64 {
    let places = |[x, y, a, b]: [f64; 4]| [[x, y], [a + b, a - b]];
    let [sx, sy, su, sv] = slid();
    let places = places(q).into_iter().zip(places(qd));
    let errors = places.map(|([x, y], [u, v])| {
        [x - sx, y - sy, u - su, v - sv].into_iter().fold(0.0, |worst: f64, error| worst.max(error.abs()))
    });
    errors.fold(0.0, f64::max)
}

fn in_steps(method: impl Method<Sledges, f64, 4, 0>) -> f64 {
    let mut run = Simulation::start_from_text(Sledges::default(), method, 0.0).expect("a start");
    run.step_to(END, 4000).expect("it slides");
    error(*run.q(), *run.qd())
}

#[test]
fn balls_slide_as_the_law_says_in_both_sets_of_coordinates() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Sledges::default(), method, 0.0).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(END).expect("it slides");
    let found = error(*run.q(), *run.qd());
    assert!(found < 1e-7, "explicit: {found:e}");
    let found = in_steps(GeneralizedAlpha::default());
    assert!(found < 1e-3, "generalized α: {found:e}");
}

#[test]
fn balls_slide_so_in_single_precision() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Sledges::<f32>::default(), method, 0.0).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(END as f32).expect("it slides");
    let found = error(run.q().map(f64::from), run.qd().map(f64::from));
    assert!(found < 2e-3, "{found:e}");
}

/// ∂Q/∂q and ∂Q/∂q̇ of both balls against differences of Q.
#[test]
fn the_slopes_of_the_friction_are_exact() {
    let sledges: Sledges = Sledges::default();
    let parameters = sledges.parameters();
    let (q, qd) = ([0.3, -2e-3, 0.1, 0.102], [0.4, -0.1, 0.2, 0.25]);
    let force = |q: &[f64; 4], qd: &[f64; 4]| {
        sledges.force(&parameters, &sledges.position(&parameters, q, 0.0), qd, &[], &[])
    };
    let position = sledges.position(&parameters, &q, 0.0);
    let by_q = sledges.force_q(&parameters, &position, &qd, &[], &[]);
    let by_qd = sledges.force_qd(&parameters, &position, &qd, &[], &[]);
    for column in 0..4 {
        let (h, mut moved) = (1e-7, [[q, qd], [q, qd], [q, qd], [q, qd]]);
        moved[0][0][column] += h;
        moved[1][0][column] -= h;
        moved[2][1][column] += h;
        moved[3][1][column] -= h;
        let [p, n, u, d] = moved.map(|[q, qd]| force(&q, &qd));
        for row in 0..4 {
            let found = [(p[row] - n[row]) / (2.0 * h), (u[row] - d[row]) / (2.0 * h)];
            let exact = [by_q[row][column], by_qd[row][column]];
            for (found, exact) in found.iter().zip(exact) {
                assert!(
                    (found - exact).abs() < 1e-6 * (1e3 + exact.abs()),
                    "{row} {column}: {found} and {exact}"
                );
            }
        }
    }
}

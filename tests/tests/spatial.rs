//! Bodies in space against closed forms, other descriptions of the same body, and other frames.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Failure, FailureKind, Mechanism, mechanism};

mechanism! {
    /// A body that nothing acts on.
    mechanism Spinning;
    param J: [kg*m^2; 3] = [1, 2, 3];
    param w: [rad/s; 3] = [1, 0, 0.6];
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 2, com: r, inertia: J, orientation: e }
    start e = [1, 0, 0, 0] rate [0, w[0]/2, w[1]/2, w[2]/2];
    let back = [e[0], -e[1], -e[2], -e[3]];
    out spin: [rad/s; 3] = rotate(back, angular_velocity(e));
    out momentum: [kg*m^2/s; 3] = rotate(e, [
        J[0]*rotate(back, angular_velocity(e))[0],
        J[1]*rotate(back, angular_velocity(e))[1],
        J[2]*rotate(back, angular_velocity(e))[2]
    ]);
}

/// Jacobi's sn, cn, dn of `u` for 0 < k < 1, by the arithmetic-geometric mean (Abramowitz & Stegun, 16.4).
fn jacobi(u: f64, k: f64) -> [f64; 3] {
    const STEPS: usize = 8;
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    let mut ratios = Vec::new();
    for _ in 0..STEPS {
        let c = (a - b) / 2.0;
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        ratios.push(c / a);
    }
    let mut angle = f64::from(1_u32 << STEPS) * a * u;
    for ratio in ratios.iter().rev() {
        angle = (angle + (ratio * angle.sin()).asin()) / 2.0;
    }
    let sine = angle.sin();
    [sine, angle.cos(), (1.0 - k * k * sine * sine).sqrt()]
}

/// Angular velocity in the axes of a free body that starts with (w₁, 0, w₃), J₁ < J₂ < J₃ and |L|² > 2 T J₂.
/// Source: Landau & Lifshitz, Mechanics, §37.
fn free_spin([j1, j2, j3]: [f64; 3], [w1, w3]: [f64; 2], t: f64) -> [f64; 3] {
    let energy = j1 * w1 * w1 + j3 * w3 * w3;
    let momentum = (j1 * w1).powi(2) + (j3 * w3).powi(2);
    let (low, high) = (energy * j3 - momentum, momentum - energy * j1);
    assert!(momentum > energy * j2);
    let k = ((j2 - j1) * low / ((j3 - j2) * high)).sqrt();
    let [sn, cn, dn] = jacobi(t * ((j3 - j2) * high / (j1 * j2 * j3)).sqrt(), k);
    [w1 * cn, (low / (j2 * (j3 - j2))).sqrt() * sn, w3 * dn]
}

#[test]
fn a_free_body_spins_as_elliptic_functions_say_and_keeps_momentum_and_energy() {
    const BOUND: f64 = 1e-10;
    /// A projection stops at some ten roundings.
    const ROUNDING: f64 = 100.0 * f64::EPSILON;
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Spinning::default(), method, 0.0)
        .unwrap()
        .with_tolerance(Tolerance::new(1e-13));
    for second in 1..=20 {
        let t = f64::from(second);
        run.advance_to(t).unwrap();
        let exact = free_spin([1.0, 2.0, 3.0], [1.0, 0.6], t);
        let found = run.outputs();
        let value = |name: &str| {
            let index = <Spinning as Mechanism<f64, 7, 1>>::OUTPUTS
                .iter()
                .position(|output| output.name == name)
                .unwrap();
            found[index].value
        };
        let names = ["spin.0", "spin.1", "spin.2", "momentum.0", "momentum.1", "momentum.2"];
        for (name, exact) in names.iter().zip(exact.into_iter().chain([1.0, 0.0, 1.8])) {
            assert!(
                (value(name) - exact).abs() < BOUND,
                "{name} at {t} s: {} instead of {exact}",
                value(name)
            );
        }
        let balance = run.balance();
        assert!(
            balance.defect.abs() < BOUND && balance.phi < ROUNDING && balance.phi_d < ROUNDING,
            "{balance:?}"
        );
    }
}

mechanism! {
    /// A body on a point, in any frame: gravity, place on the body, inertia and start are parameters.
    mechanism Pendulum3;
    param J: [kg*m^2; 6] = [0.2, 0.5, 0.4, 0.02, -0.03, 0.05];
    param arm: [m; 3] = [0.3, 0.9, -0.2];
    param g: [m/s^2; 3] = [0, 0, -9.81];
    param e0: [1; 4] = [1, 0, 0, 0];
    param rates: [rad/s; 4] = [0, 1, 4, -2];
    coord r: [m; 3] = [0, 1, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 3, com: r, inertia: J, orientation: e }
    gravity weight { acceleration: g }
    constraint pivot { r == rotate(e, arm); }
    start r = rotate(e0, arm);
    start e = e0 rate rates;
}

type Quaternion = [f64; 4];

fn product(a: Quaternion, b: Quaternion) -> Quaternion {
    let [a0, a1, a2, a3] = a;
    let [b0, b1, b2, b3] = b;
    [
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    ]
}

fn conjugate([a0, a1, a2, a3]: Quaternion) -> Quaternion {
    [a0, -a1, -a2, -a3]
}

fn turned(e: Quaternion, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [_, x, y, z] = product(product(e, [0.0, x, y, z]), conjugate(e));
    [x, y, z]
}

/// A Jᵀ Aᵀ of the symmetric matrix Jxx, Jyy, Jzz, Jxy, Jxz, Jyz.
fn turned_inertia(e: Quaternion, [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 6] {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| turned(conjugate(e), axis));
    let entry = |a: [f64; 3], b: [f64; 3]| {
        let row = [
            xx * b[0] + xy * b[1] + xz * b[2],
            xy * b[0] + yy * b[1] + yz * b[2],
            xz * b[0] + yz * b[1] + zz * b[2],
        ];
        a[0] * row[0] + a[1] * row[1] + a[2] * row[2]
    };
    let [x, y, z] = axes;
    [entry(x, x), entry(y, y), entry(z, z), entry(x, y), entry(x, z), entry(y, z)]
}

/// The centre of mass after two seconds.
fn after_two_seconds(pendulum: Pendulum3) -> [f64; 3] {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(pendulum, method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(2.0).unwrap();
    [run.q()[0], run.q()[1], run.q()[2]]
}

const TURN: Quaternion = [0.5, -0.1, 0.7, 0.5];

fn assert_same(found: [f64; 3], expected: [f64; 3]) {
    const BOUND: f64 = 1e-9;
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < BOUND, "{found} instead of {expected}");
    }
}

#[test]
fn a_turned_ground_turns_the_motion() {
    assert!((TURN.iter().map(|e| e * e).sum::<f64>() - 1.0).abs() < f64::EPSILON);
    let plain = Pendulum3::default();
    let before = after_two_seconds(plain);
    let moved = Pendulum3 {
        g: turned(TURN, plain.g),
        e0: product(TURN, plain.e0),
        rates: product(TURN, plain.rates),
        ..plain
    };
    assert_same(after_two_seconds(moved), turned(TURN, before));
}

#[test]
fn other_axes_of_the_body_change_nothing() {
    let plain = Pendulum3::default();
    let before = after_two_seconds(plain);
    let moved = Pendulum3 {
        J: turned_inertia(conjugate(TURN), plain.J),
        arm: turned(conjugate(TURN), plain.arm),
        e0: product(plain.e0, TURN),
        rates: product(plain.rates, TURN),
        ..plain
    };
    assert_same(after_two_seconds(moved), before);
}

mechanism! {
    /// A body by Euler's angles, its parameters made of them.
    mechanism ByParameters;
    param J: [kg*m^2; 3] = [1, 2, 3];
    coord psi: rad = 0.3;
    coord theta: rad = 0.7;
    coord phi: rad = 0.2;
    let e = [
        cos(theta/2)*cos((psi + phi)/2),
        sin(theta/2)*cos((psi - phi)/2),
        sin(theta/2)*sin((psi - phi)/2),
        cos(theta/2)*sin((psi + phi)/2)
    ];
    body top { mass: 2, com: rotate(e, [0, 0, 1m]), inertia: J, orientation: e }
    gravity weight { acceleration: [0, 0, -9.81] }
}

mechanism! {
    /// The same body by its kinetic energy.
    mechanism ByEnergy;
    param J: [kg*m^2; 3] = [1, 2, 3];
    coord psi: rad = 0.3;
    coord theta: rad = 0.7;
    coord phi: rad = 0.2;
    body point { mass: 2, com: 1m*[sin(theta)*sin(psi), -sin(theta)*cos(psi), cos(theta)] }
    gravity weight { acceleration: [0, 0, -9.81] }
    kinetic turning = (J[0]*(der(psi)*sin(theta)*sin(phi) + der(theta)*cos(phi))^2
        + J[1]*(der(psi)*sin(theta)*cos(phi) - der(theta)*sin(phi))^2
        + J[2]*(der(psi)*cos(theta) + der(phi))^2)/2;
}

#[test]
fn parameters_made_of_angles_give_the_masses_and_forces_of_the_angles() {
    const BOUND: f64 = 1e-13;
    let (one, other) = (ByParameters::<f64>::default(), ByEnergy::<f64>::default());
    let (p, o) = (one.parameters(), other.parameters());
    assert!(<ByParameters as Mechanism<f64, 3, 0>>::ROWS.is_empty());
    for state in 0..50 {
        let at = |k: f64| 3.0 * (f64::from(state) * k).sin();
        let (q, qd) = ([at(1.1), at(2.3), at(3.7)], [at(4.1), at(5.3), at(6.7)]);
        let (s, u) = (one.position(&p, &q, 0.0), other.position(&o, &q, 0.0));
        let (mass, expected) = (one.mass(&p, &s), other.mass(&o, &u));
        for (a, b) in mass.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < BOUND * 5.0, "state {state}: {mass:?} instead of {expected:?}");
        }
        let (force, expected) = (one.force(&p, &s, &qd, &[], &[]), other.force(&o, &u, &qd, &[], &[]));
        let size = expected.iter().fold(20.0, |size: f64, force| size.max(force.abs()));
        for (a, b) in force.iter().zip(expected) {
            assert!((a - b).abs() < BOUND * size, "state {state}: {force:?} instead of {expected:?}");
        }
    }
}

mechanism! {
    /// A force at a point of a body, and its moment about the centre of mass.
    mechanism Pushed;
    param F: [N; 3] = [1, -2, 3];
    param c: [m; 3] = [0.2, -0.5, 0.7];
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 2, com: r, inertia: [1, 2, 3], orientation: e }
    effect at_the_point { force push: F on r + rotate(e, c); }
    effect at_the_centre {
        force push: F on r;
        torque moment: cross(rotate(e, c), F) on e;
    }
    scene Point = at_the_point;
    scene Centre = at_the_centre;
}

#[test]
fn a_force_at_a_point_is_one_at_the_centre_with_its_moment() {
    let (point, centre) = (PushedPoint::<f64>::default(), PushedCentre::<f64>::default());
    let (p, o) = (point.parameters(), centre.parameters());
    let e = TURN;
    let (spin, qd) =
        ([0.0, 0.3, -0.4, 0.9], |e: Quaternion, spin: Quaternion| product(e, spin).map(|x| x / 2.0));
    let [d0, d1, d2, d3] = qd(e, spin);
    let (q, qd) = ([1.0, 2.0, 3.0, e[0], e[1], e[2], e[3]], [0.5, 0.1, -0.7, d0, d1, d2, d3]);
    let (s, u) = (point.position(&p, &q, 0.0), centre.position(&o, &q, 0.0));
    let (found, expected) = (point.force(&p, &s, &qd, &[], &[0.0]), centre.force(&o, &u, &qd, &[], &[0.0]));
    // The row e·e = 1 takes the component along e; the moment e⁻¹ Q is compared.
    let turning = |force: [f64; 7]| {
        let [_, x, y, z] = product(conjugate(e), [force[3], force[4], force[5], force[6]]);
        [force[0], force[1], force[2], x, y, z]
    };
    for (a, b) in turning(found).iter().zip(turning(expected)) {
        assert!((a - b).abs() < 1e-13, "{found:?} instead of {expected:?}");
    }
    let power = point.powers(&p, &s, &qd, &[], &[0.0]);
    let sum: f64 = centre.powers(&o, &u, &qd, &[], &[0.0]).iter().sum();
    assert!((power[0] - sum).abs() < 1e-13 && sum.abs() > 0.1, "{power:?} {sum}");
}

mechanism! {
    /// Two points of two bodies with a spring and a damper.
    mechanism Tied;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    coord s: [m; 3] = [1, 1, 0.5];
    coord f: [1; 4] = [1, 0, 0, 0];
    body one { mass: 2, com: r, inertia: [0.1, 0.2, 0.25], orientation: e }
    body two { mass: 1, com: s, inertia: [0.3, 0.2, 0.15], orientation: f }
    // A second body on the same axes: its parameters have their row already.
    body weight { mass: 0.5, com: r + rotate(e, [0.1m, 0, 0]), inertia: [0.01, 0.02, 0.02], orientation: e }
    tsda spring { from: r + rotate(e, [0.2m, 0.3m, 0]), to: s + rotate(f, [0, 0.1m, -0.4m]), stiffness: 80, length: 0.6, damping: 1.5 }
    start r = [0, 0, 0] rate [0, 0.1, 0];
    start e = [1, 0, 0, 0] rate [0, 0.4, -0.2, 0.6];
    out momentum: [kg*m/s; 3] = 2*der(r)*1kg + der(s)*1kg + 0.5*der(r + rotate(e, [0.1m, 0, 0]))*1kg;
}

#[test]
fn a_spring_between_points_of_two_bodies_changes_no_momentum_and_accounts_for_its_energy() {
    let rows = <Tied as Mechanism<f64, 14, 2>>::ROWS.iter().map(|row| row.name).collect::<Vec<_>>();
    assert_eq!(rows, ["one", "two"]);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Tied::default(), method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let momentum = |run: &Simulation<Tied, _, f64, 14, 2>| {
        run.outputs().as_ref().iter().map(|x| x.value).collect::<Vec<_>>()
    };
    let before = momentum(&run);
    run.advance_to(3.0).unwrap();
    for (found, before) in momentum(&run).iter().zip(before) {
        assert!((found - before).abs() < 1e-11, "{found} instead of {before}");
    }
    let balance = run.balance();
    assert!(balance.work < -0.1 && balance.defect.abs() < 1e-9 * balance.energy.kinetic, "{balance:?}");
}

mechanism! {
    /// A free body with a moment of deviation.
    mechanism Skewed;
    param Jxy: kg*m^2 = 0;
    param Jyz: kg*m^2 = 0;
    param Jxz: kg*m^2 = 0;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 2, com: r, inertia: [1, 1.2, 1.4, Jxy, Jxz, Jyz], orientation: e }
    start e = [1, 0, 0, 0] rate [0, 0, 0, 0];
}

/// Failure of a start with an inertia, if it is refused.
fn refused<S: Dynamic<f64, 7, 1>>(body: S) -> Option<Failure> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    Simulation::start_from_text(body, method, 0.0).err()
}

#[test]
fn an_inertia_that_no_body_has_is_refused_where_a_run_starts() {
    let spinning = |last: f64| refused(Spinning { J: [1.0, 2.0, last], ..Spinning::default() });
    // A flat body, and one of less than that; rounding of a flat one is none.
    assert_eq!([3.0, 2.5, 1.0, 3.0 + 1e-9].map(spinning), [None; 4]);
    for last in [3.01, 0.99] {
        let failure = spinning(last).expect("no body");
        let Failure { kind: FailureKind::Negative { name, parameter, value, .. }, .. } = failure else {
            panic!("{failure}")
        };
        assert!(
            name == "top.inertia, two moments less the third" && parameter.starts_with("J."),
            "{failure}"
        );
        assert!((value + 0.01).abs() < 1e-5, "{value}");
    }
    let flat: Spinning<f32> = Spinning { J: [0.1, 0.2, 0.3], ..Spinning::default() };
    let method = Explicit::new(DormandPrince8, Projection::default());
    assert!(Simulation::start_from_text(flat, method, 0.0_f32).is_ok());
    // 2 ∫ x² … = 1.6, 1.2, 0.8: |2 Jxy| up to √(1.6·1.2) = 1.386, and the bound of the determinant.
    let skewed = |[jxy, jyz, jxz]: [f64; 3]| refused(Skewed { Jxy: jxy, Jyz: jyz, Jxz: jxz });
    for possible in [[0.69, 0.0, 0.0], [0.0, -0.48, 0.0], [-0.4, 0.3, 0.4], [0.4, -0.3, 0.4]] {
        assert_eq!(skewed(possible), None, "{possible:?}");
    }
    for (wrong, what) in [
        ([0.7, 0.0, 0.0], "a minor of the second moments"),
        ([0.0, -0.5, 0.0], "a minor of the second moments"),
        ([0.4, 0.3, 0.3], "the determinant of the second moments"),
        ([-0.4, -0.3, 0.3], "the determinant of the second moments"),
    ] {
        let failure = skewed(wrong).expect("no body");
        let Failure { kind: FailureKind::Negative { name, .. }, .. } = failure else { panic!("{failure}") };
        assert!(name.ends_with(what), "{wrong:?}: {name}");
    }
}

//! Masses and forces end to end. M, Q, energies and loads are compared with d'Alembert's sums in second-order Taylor
//! arithmetic, their derivatives with differences, accelerations with closed forms.
#![forbid(unsafe_code)]

#[allow(dead_code, reason = "the comparison of kinematics has a test file of its own")]
#[path = "../jet/mod.rs"]
mod jet;

mod arm;
mod squeezer;

use jet::{Jet, close};
use mbs_runtime::{Dynamic, DynamicState, Mechanism, Newton, Outcome, Partitioned, mechanism};
use mechanisms::andrews::Andrews;
use mechanisms::n_four_bar::NFourBar;

/// Step of the differences below: its fourth power is a few hundred roundings.
const STEP: f64 = 2e-4;
/// Rounding of a fourth-order difference with that step, a part of the entries' size.
const DIFFERENCE: f64 = 1e-9;

mechanism! {
    /// A point on a massless rod, in Cartesian coordinates.
    pub mechanism Pendulum;
    param m: kg = 2;
    param L: m = 0.7;
    coord x: m = 0;
    coord y: m = 0;
    body bob { mass: m, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { x^2 + y^2 == L^2; }
    start x = -L;
    start y = 0 rate 0.5;
    out tension: N = 2*lambda(rod)*L;
}

mechanism! {
    /// A trolley with a pendulum, spring, dampers and a motor; nothing moves it from outside but forces.
    pub mechanism Trolley;
    coord x: m = 0.1;
    coord phi: rad = 0.4;
    const K: N/m = 40;
    const C: N*m*s = 0.3;
    input u: N;
    let bob = [x, 0] + 0.8*1m*unit(phi);
    body cart { mass: 2, com: [x, 0] }
    body rod { mass: 0.5, inertia: 0.03, com: bob, angle: phi }
    gravity g { acceleration: [0, -9.81] }
    tsda strut { from: [0, 1m], to: bob, stiffness: 60, length: 0.5, damping: 3, actuator: 2 }
    tsda stiffening { from: [0, -1m], to: bob, stiffness: K*(1 + x^2/1 [m^2]), length: 0.1 }
    rsda hinge { angle: phi, stiffness: 2, rest: 0.1, damping: 0.2, torque: 0.3 }
    potential well = K*x^4/4/1 [m^2];
    dissipation bearing = C*der(phi)^2/2;
    force motor: u on x;
}

#[test]
fn energy_changes_by_what_forces_supply_and_nothing_else() {
    let trolley = Trolley { u: 1.7 };
    let p = trolley.parameters();
    assert_eq!(Trolley::<f64>::FORCES.len(), 5);
    for (q, qd, qdd) in [([0.3, 0.4], [1.0, -2.0], [3.0, 0.5]), ([-0.7, 2.4], [-1.5, 0.8], [-2.0, 4.0])] {
        let at = |tau: f64| {
            let q: [f64; 2] = std::array::from_fn(|i| q[i] + qd[i] * tau + 0.5 * qdd[i] * tau * tau);
            let qd: [f64; 2] = std::array::from_fn(|i| qd[i] + qdd[i] * tau);
            let energy = trolley.energy(&p, &trolley.position(&p, &q, 0.0), &qd);
            energy.kinetic + energy.potential
        };
        let slope = (at(-2.0 * STEP) - 8.0 * at(-STEP) + 8.0 * at(STEP) - at(2.0 * STEP)) / (12.0 * STEP);
        let here = trolley.position(&p, &q, 0.0);
        let inertia = trolley.mass_times(&p, &here, &qdd);
        let force = trolley.force(&p, &here, &qd, &[], &[]);
        let unbalanced: f64 = (0..2).map(|i| qd[i] * (inertia[i] - force[i])).sum();
        let powers: f64 = trolley.powers(&p, &here, &qd, &[], &[]).iter().sum();
        assert!((slope - unbalanced - powers).abs() < DIFFERENCE * (1.0 + slope.abs()), "{slope}");
        assert_eq!(trolley.powers(&p, &here, &qd, &[], &[])[4], 1.7 * qd[0]);
    }
}

#[test]
fn a_spring_of_no_length_has_no_direction_and_keeps_its_stiffness() {
    mechanism! {
        mechanism Slider;
        coord x: m = 0;
        coord y: m = 0;
        body bob { mass: 1, com: [x, y] }
        tsda strut { from: [1m, 2m], to: [x, y], stiffness: 50, length: 0.2, damping: 3, actuator: 2 }
    }
    let slider: Slider = Slider::default();
    let position = slider.position(&slider.parameters(), &[1.0, 2.0], 0.0);
    let (q, none) = (slider.parameters(), []);
    assert_eq!(slider.force(&q, &position, &[3.0, 4.0], &none, &none), [0.0, 0.0]);
    let stiffness = slider.force_q(&q, &position, &[3.0, 4.0], &none, &none);
    assert_eq!(stiffness, [[-50.0, 0.0], [0.0, -50.0]]);
    assert_eq!(slider.force_qd(&q, &position, &[3.0, 4.0], &none, &none), [[0.0; 2]; 2]);
    close(slider.energy(&q, &position, &[0.0; 2]).potential, 0.5 * 50.0 * 0.04, "potential");
}

/// Accelerations and multipliers from M q̈ + Φ_qᵀ λ = Q, Φ_q q̈ = γ by elimination with pivots.
fn solve<S: Dynamic<f64, N, M, States = [f64; 0]>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
) -> (Vec<f64>, Vec<f64>) {
    let p = mechanism.parameters();
    let position = mechanism.position(&p, q, t);
    let (mass, phi_q) = (mechanism.mass(&p, &position), mechanism.phi_q(&p, &position));
    let force = mechanism.force(&p, &position, qd, &[], &[0.0; M]);
    let gamma = mechanism.gamma(&p, &position, qd);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for i in 0..N {
        let transposed = phi_q.iter().map(|row| row[i]);
        rows.push(mass[i].into_iter().chain(transposed).chain([force[i]]).collect());
    }
    for (row, right) in phi_q.iter().zip(gamma) {
        rows.push(row.iter().copied().chain([0.0; M]).chain([right]).collect());
    }
    let size = N + M;
    for k in 0..size {
        let pivot = (k..size).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("a row");
        rows.swap(k, pivot);
        let upper = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / upper[k];
            assert!(factor.is_finite(), "singular at {k}, {i}");
            row.iter_mut().zip(&upper).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    let mut solution: Vec<f64> = (0..size).map(|k| rows[k][size] / rows[k][k]).collect();
    let lambda = solution.split_off(N);
    (solution, lambda)
}

/// Accelerations and multipliers of a mechanism with one degree of freedom, without any matrix of all rows. The dependent
/// coordinates follow the independent one, and the inertia is reduced to it.
fn follow<S, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
    qd: &[f64; N],
) -> ([f64; N], [f64; M])
where
    S: Dynamic<f64, N, M, States = [f64; 0]> + Partitioned<f64, N, M>,
{
    let p = mechanism.parameters();
    let here = mechanism.position(&p, q, 0.0);
    let &[independent] = S::INDEPENDENT else { panic!("{:?}", S::INDEPENDENT) };
    let independent = usize::from(independent);
    let (partition, margin) = mechanism.partition(&p, &here);
    assert!(margin.value > 1e-3, "{}", margin.value);
    let mut along = [0.0; N];
    along[independent] = 1.0;
    mechanism.complete(&partition, &[0.0; M], &mut along);
    let mut rest = [0.0; N];
    mechanism.complete(&partition, &mechanism.gamma(&p, &here, qd), &mut rest);
    let force = mechanism.force(&p, &here, qd, &[], &[0.0; M]);
    let reduced = |x: &[f64; N]| {
        let mut y = mechanism.mass_times(&p, &here, x);
        mechanism.reduce(&partition, &mut y);
        y[independent]
    };
    let mut applied = force;
    mechanism.reduce(&partition, &mut applied);
    let acceleration = (applied[independent] - reduced(&rest)) / reduced(&along);
    let qdd = std::array::from_fn(|i| rest[i] + acceleration * along[i]);
    let inertia = mechanism.mass_times(&p, &here, &qdd);
    let mut unbalanced = std::array::from_fn(|i| force[i] - inertia[i]);
    (qdd, mechanism.reduce(&partition, &mut unbalanced))
}

#[test]
fn a_pendulum_falls_as_it_should_and_its_rod_pulls() {
    let pendulum = Pendulum::default();
    let p = pendulum.parameters();
    assert_eq!(pendulum.guess(&p), [-0.7, 0.0]);
    assert_eq!(pendulum.start_rates(&p), [0.0, 0.5]);
    let (angle, rate) = (-0.9_f64, 1.3);
    let (sine, cosine) = angle.sin_cos();
    let (q, qd) = ([0.7 * cosine, 0.7 * sine], [-0.7 * rate * sine, 0.7 * rate * cosine]);
    let (qdd, lambda) = solve(&pendulum, &q, &qd, 0.0);
    let angular = -9.81 / 0.7 * cosine;
    close(qdd[0], 0.7 * (-angular * sine - rate * rate * cosine), "ẍ");
    close(qdd[1], 0.7 * (angular * cosine - rate * rate * sine), "ÿ");
    let position = pendulum.position(&p, &q, 0.0);
    let motion = DynamicState { qd: &qd, qdd: &[qdd[0], qdd[1]], lambda: &[lambda[0]], states: &[] };
    let [tension] = pendulum.loads(&p, &position, &motion);
    close(tension, 2.0 * (0.7 * rate * rate - 9.81 * sine), "tension");
    let energy = pendulum.energy(&p, &position, &qd);
    close(energy.kinetic + energy.potential, 0.49 * rate * rate + 2.0 * 9.81 * q[1], "energy");
}

mechanism! {
    /// A four-bar with uniform rods, its crank driven or free.
    pub mechanism FourBar;
    const L1: m = 0.1;
    const L2: m = 0.25;
    const L3: m = 0.2;
    coord phi1: rad = 0.5;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    body crank { mass: 1, inertia: L1^2/12*1kg, com: L1/2*unit(phi1), angle: phi1 }
    body coupler { mass: 2.5, inertia: 2.5kg*L2^2/12, com: L1*unit(phi1) + L2/2*unit(phi2), angle: phi2 }
    body rocker { mass: 2, inertia: 2kg*L3^2/12, com: [300mm, 0] + L3/2*unit(phi3), angle: phi3 }
    gravity g { acceleration: [0, -1g0] }
    constraint closure { L1*unit(phi1) + L2*unit(phi2) == [300mm, 0] + L3*unit(phi3); }
    drive motor: phi1 == 0.5 + 4rad/1s*t;
    out torque_1: N*m = effort(motor);
}

#[test]
fn the_effort_of_a_drive_is_what_the_energy_takes() {
    let four_bar: FourBar = FourBar::default();
    let p = four_bar.parameters();
    let guess = four_bar.guess(&p);
    let mut motion = mbs_runtime::Stepper::assemble(four_bar, guess, 0.0).expect("it closes");
    let energy = |motion: &mbs_runtime::Stepper<FourBar, f64, 3>| {
        let energy = four_bar.energy(&p, &four_bar.position(&p, motion.q(), 0.0), motion.qd());
        energy.kinetic + energy.potential
    };
    let mut energies = Vec::new();
    let mut power = 0.0;
    for step in 0..5 {
        motion.advance_to(0.1 + f64::from(step) * 1e-3).expect("it turns");
        energies.push(energy(&motion));
        if step == 2 {
            // Inverse dynamics of a driven mechanism: the rows balance Q − M q̈.
            let (qdd, lambda) = solve(&four_bar, motion.q(), motion.qd(), 0.102);
            for (solved, kinematic) in qdd.iter().zip(motion.qdd()) {
                close(*solved, *kinematic, "acceleration");
            }
            power = -lambda[2] * 4.0;
        }
    }
    let slope = (energies[0] - 8.0 * energies[1] + 8.0 * energies[3] - energies[4]) / 12e-3;
    assert!((slope - power).abs() < 1e-6 * power.abs(), "{slope} {power}");
}

#[test]
fn two_parallelograms_swing_as_one_pendulum() {
    let bars: NFourBar = NFourBar::default();
    let (theta, rate) = (0.7_f64, 1.3);
    let (sine, cosine) = theta.sin_cos();
    let q = [sine, cosine, 1.0 + sine, cosine, 2.0 + sine, cosine];
    let qd: [f64; 6] = std::array::from_fn(|i| rate * if i % 2 == 0 { cosine } else { -sine });
    // Three rods about an end, two that only move along: I = 3/3 + 2, moment of the weights 3/2 + 2.
    let angular = 3.5 * 9.81 * sine / 3.0;
    let (qdd, lambda) = solve(&bars, &q, &qd, 0.0);
    let (followed, multipliers) = follow(&bars, &q, &qd);
    for i in 0..6 {
        let expected = match i % 2 {
            0 => angular * cosine - rate * rate * sine,
            _ => -angular * sine - rate * rate * cosine,
        };
        close(qdd[i], expected, "acceleration by all rows");
        close(followed[i], expected, "acceleration by one coordinate");
    }
    for (found, expected) in multipliers.iter().zip(&lambda) {
        close(*found, *expected, "multiplier");
    }
    let p = bars.parameters();
    assert_eq!(bars.start_rates(&p), [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
}

#[test]
fn dependent_coordinates_are_found_and_independent_ones_stay() {
    let andrews: Andrews = Andrews::default();
    let p = andrews.parameters();
    assert_eq!(Andrews::<f64>::INDEPENDENT, [0]);
    let mut q = andrews.guess(&p);
    q[0] += 0.01;
    let mut solver = Newton::new(1.0);
    let outcome = andrews.solve_dependent(&p, &mut q, 0.0, &mut solver);
    assert!(outcome.iter().all(|outcome| *outcome == Outcome::Converged));
    assert_eq!(q[0], andrews.guess(&p)[0] + 0.01);
    for residual in andrews.phi(&p, &andrews.position(&p, &q, 0.0)) {
        assert!(residual.abs() < 1e-15, "{residual}");
    }
    // The text decides first: the pendulum's start names both coordinates, so the later one is dependent.
    assert_eq!(Pendulum::<f64>::INDEPENDENT, [0]);
    assert_eq!(FourBar::<f64>::INDEPENDENT, [0_u16; 0]);
}

mechanism! {
    /// Two links, a force on their joint that the one or the other bears.
    pub mechanism Borne;
    const L: m = 0.5;
    coord phi: [rad; 2] = [0.1, 0.2];
    let elbow = L*unit(phi[0]);
    body upper { mass: 1.5, com: elbow/2, inertia: 0.1, angle: phi[0] }
    body lower { mass: 0.8, com: elbow + L/2*unit(phi[1]), inertia: 0.1, angle: phi[1] }
    pin shoulder: ground, upper at [0, 0];
    pin knuckle: upper, lower at elbow;
    out bearing: [N; 2] = reaction(knuckle, lower);
    effect by_upper { force hung: [10, -20] on elbow of upper; }
    effect by_lower { force held: [10, -20] on elbow of lower; }
    scene Hung = by_upper;
    scene Held = by_lower;
}

#[test]
fn a_force_on_a_joint_is_borne_by_the_body_that_the_text_names() {
    let (q, qd) = ([0.3, 1.1], [0.7, -1.3]);
    let (hung, held): (BorneHung, BorneHeld) = (BorneHung::default(), BorneHeld::default());
    let (qdd, _) = solve(&hung, &q, &qd, 0.0);
    assert_eq!(qdd, solve(&held, &q, &qd, 0.0).0);
    let qdd = [qdd[0], qdd[1]];
    let [[ax, ay], [bx, by]] = [0, 1].map(|i: usize| {
        let (sine, cosine) = f64::sin_cos(q[i]);
        [-qdd[i] * sine - qd[i] * qd[i] * cosine, qdd[i] * cosine - qd[i] * qd[i] * sine]
    });
    let inertia = [0.8 * (0.5 * ax + 0.25 * bx), 0.8 * (0.5 * ay + 0.25 * by)];
    let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &[], states: &[] };
    let p = hung.parameters();
    let [x, y] = hung.loads(&p, &hung.position(&p, &q, 0.0), &motion);
    close(x, inertia[0], "x, borne by the other");
    close(y, inertia[1], "y, borne by the other");
    let p = held.parameters();
    let [x, y] = held.loads(&p, &held.position(&p, &q, 0.0), &motion);
    close(x, inertia[0] - 10.0, "x, borne by itself");
    close(y, inertia[1] + 20.0, "y, borne by itself");
}

//! Inertia, forces and their derivatives of an arm whose points are typed from its sketch.

use super::*;

mechanism! {
    /// Every statement of dynamics at once: a two-link arm on a moving support, in relative angles.
    pub mechanism Arm;
    param m1: kg = 1.5;
    param m2: kg = 0.8;
    param J1: kg*m^2 = 0.02;
    param J2: kg*m^2 = 0.03;
    param L1: m = 0.6;
    param k: N/m = 120;
    param c: N*s/m = 4;
    param omega: rad/s = 3;
    const CM: N*m*s = 0.2;
    const CS: N*s/m = 0.5;
    const V: m/s = 0.01;
    input u: N*m;
    coord psi1: rad = 0.3;
    coord psi2: rad = 0.8;
    coord s: m = 0.2;
    state z: N = 0.5;
    let phi2 = psi1 + psi2;
    let base = [0.1*1m*sin(omega*t), 0];
    let elbow = base + L1*unit(psi1);
    let hand = elbow + s*unit(phi2);
    body upper { mass: m1, inertia: J1, com: base + 0.3*1m*unit(psi1), angle: psi1 }
    body lower { mass: m2, inertia: J2, com: elbow + 0.5*s*unit(phi2) + V*t*[1, 1], angle: phi2 }
    body load { mass: 0.4, com: hand }
    gravity g { acceleration: [0.3, -9.81] }
    force push: [2N + z, CS*der(s)] on hand;
    torque motor: u - CM*der(psi1) on psi1;
    force slip: -lambda(slot)*0.1 on s;
    tsda strut {
        from: [200mm, -400mm], to: hand, stiffness: k, length: 0.35, damping: c, actuator: 3N*sin(2*t/1s)
    }
    rsda knee { angle: psi2, stiffness: 5, rest: 0.4, damping: 0.3, torque: 0.1 }
    potential well = 3N/1m*s^2*cos(psi1);
    kinetic rotor = 0.01*J1*der(psi2)*(der(psi2) + 3*der(psi1));
    dissipation bearing = 0.05*CM*der(psi1)^2*exp(psi2);
    der(z) == (4N - z)/0.1s + 2N/1m*der(s);
    constraint slot { s == 300mm + 50mm*cos(psi2); }
    out squeeze: N = lambda(slot) + z;
    out mixed: m/s^2 = der2(s) + lambda(slot)/1kg;
    out speed: m/s = der(s);
}

/// A state of the arm; nothing of it satisfies the constraint.
struct State {
    q: [f64; 3],
    qd: [f64; 3],
    qdd: [f64; 3],
    z: [f64; 1],
    lambda: [f64; 1],
    t: f64,
}

const STATES: [State; 2] = [
    State {
        q: [0.4, 0.9, 0.25],
        qd: [1.1, -0.7, 0.6],
        qdd: [2.0, 3.0, -1.0],
        z: [0.7],
        lambda: [5.0],
        t: 0.3,
    },
    State {
        q: [-2.1, 0.2, 0.5],
        qd: [-3.0, 2.2, -1.4],
        qdd: [0.5, -9.0, 4.0],
        z: [-2.0],
        lambda: [-1.0],
        t: 1.7,
    },
];

/// A value that does work along a displacement, or a mass that moves along it.
type Pair = (Jet, Jet);

/// Points and angles of the arm with masses, and with forces, typed from the sketch and not from the text.
fn arm(arm: &Arm, [psi1, psi2, s]: [Jet; 3], t: Jet, z: f64, lambda: f64) -> (Vec<Pair>, Vec<Pair>) {
    let n = Jet::number;
    let phi2 = psi1 + psi2;
    let base = [0.1 * (arm.omega * t).sin(), n(0.0)];
    let elbow = [base[0] + arm.L1 * psi1.cos(), base[1] + arm.L1 * psi1.sin()];
    let hand = [elbow[0] + s * phi2.cos(), elbow[1] + s * phi2.sin()];
    let middle = [elbow[0] + 0.5 * s * phi2.cos() + 0.01 * t, elbow[1] + 0.5 * s * phi2.sin() + 0.01 * t];
    let upper = [base[0] + 0.3 * psi1.cos(), base[1] + 0.3 * psi1.sin()];
    let masses = vec![
        (n(arm.m1), upper[0]),
        (n(arm.m1), upper[1]),
        (n(arm.J1), psi1),
        (n(arm.m2), middle[0]),
        (n(arm.m2), middle[1]),
        (n(arm.J2), phi2),
        (n(0.4), hand[0]),
        (n(0.4), hand[1]),
        // 0.01 J (ψ̇₂² + 3 ψ̇₁ψ̇₂) as squares: ψ̇₁ψ̇₂ = ((ψ₁ + ψ₂)˙² − ψ̇₁² − ψ̇₂²)/2.
        (n(0.02 * arm.J1), psi2),
        (n(0.03 * arm.J1), phi2),
        (n(-0.03 * arm.J1), psi1),
        (n(-0.03 * arm.J1), psi2),
    ];
    let [dx, dy] = [hand[0] - 0.2, hand[1] + 0.4];
    let length = (dx * dx + dy * dy).sqrt();
    let tension = arm.k * (length - 0.35) + arm.c * length.rate() + 3.0 * (2.0 * t).sin();
    let mut forces: Vec<Pair> = [(upper, arm.m1), (middle, arm.m2), (hand, 0.4)]
        .into_iter()
        .flat_map(|(place, mass)| [(n(0.3 * mass), place[0]), (n(-9.81 * mass), place[1])])
        .collect();
    forces.extend([
        (n(2.0 + z), hand[0]),
        (0.5 * s.rate(), hand[1]),
        (arm.u - 0.2 * psi1.rate(), psi1),
        (n(-0.1 * lambda), s),
        (-tension, length),
        (-(5.0 * (psi2 - 0.4) + 0.3 * psi2.rate() + n(0.1)), psi2),
        (n(-1.0), 3.0 * s * s * psi1.cos()),
        (-(0.02 * psi1.rate() * psi2.exp()), psi1),
    ]);
    (masses, forces)
}

/// Σ m ∂p/∂q_i p̈ − Σ F ∂P/∂q_i for each coordinate: the expected M q̈ − Q.
fn d_alembert(design: &Arm, state: &State) -> [f64; 3] {
    let State { q, qd, qdd, t, .. } = *state;
    let at = |qd: [f64; 3], qdd: [f64; 3], pace: f64| {
        let q = std::array::from_fn(|i| Jet::new(q[i], qd[i], qdd[i]));
        arm(design, q, Jet::new(t, pace, 0.0), state.z[0], state.lambda[0])
    };
    let (masses, forces) = at(qd, qdd, 1.0);
    std::array::from_fn(|i| {
        let (mass_axes, force_axes) = at(std::array::from_fn(|j| f64::from(i == j)), [0.0; 3], 0.0);
        let inertia = masses.iter().zip(&mass_axes).map(|((mass, place), (_, axis))| {
            mass.value() * place.rate().rate().value() * axis.rate().value()
        });
        let work =
            forces.iter().zip(&force_axes).map(|((value, _), (_, axis))| value.value() * axis.rate().value());
        inertia.sum::<f64>() - work.sum::<f64>()
    })
}

#[test]
fn inertia_and_forces_are_d_alemberts_sums() {
    let arm = Arm { u: 1.7, ..Arm::default() };
    let parameters = arm.parameters();
    for state in &STATES {
        let position = arm.position(&parameters, &state.q, state.t);
        let inertia = arm.mass_times(&parameters, &position, &state.qdd);
        let force = arm.force(&parameters, &position, &state.qd, &state.z, &state.lambda);
        let mass = arm.mass(&parameters, &position);
        for (i, expected) in d_alembert(&arm, state).into_iter().enumerate() {
            close(inertia[i] - force[i], expected, &format!("row {i} of M q̈ − Q"));
            let product: f64 = (0..3).map(|j| mass[i][j] * state.qdd[j]).sum();
            close(product, inertia[i], &format!("row {i} of M q̈"));
            let column = mass.map(|row| row[i]);
            assert_eq!(mass[i], column, "M is symmetric");
        }
    }
}

#[test]
fn the_kinetic_energy_is_that_of_the_velocities() {
    let arm_1 = Arm::default();
    let parameters = arm_1.parameters();
    for state in &STATES {
        let position = arm_1.position(&parameters, &state.q, state.t);
        let energy = arm_1.energy(&parameters, &position, &state.qd);
        let q = std::array::from_fn(|i| Jet::new(state.q[i], state.qd[i], 0.0));
        let (masses, _) = arm(&arm_1, q, Jet::new(state.t, 1.0, 0.0), 0.0, 0.0);
        let square = |place: &Jet| place.rate().value().powi(2);
        let kinetic: f64 = masses.iter().map(|(mass, place)| 0.5 * mass.value() * square(place)).sum();
        close(energy.kinetic, kinetic, "kinetic energy");
    }
}

/// Derivative of a vector function along each axis, of fourth order: row by row.
fn differences<const N: usize>(q: [f64; N], f: impl Fn([f64; N]) -> [f64; N]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for j in 0..q.len() {
        let at = |steps: f64| f(std::array::from_fn(|i| if i == j { q[i] + steps * STEP } else { q[i] }));
        let ([a, b], [c, d]) = ([at(-2.0), at(-1.0)], [at(1.0), at(2.0)]);
        for (i, row) in matrix.iter_mut().enumerate() {
            row[j] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * STEP);
        }
    }
    matrix
}

#[track_caller]
fn near<const N: usize>(found: [[f64; N]; N], expected: [[f64; N]; N], what: &str) {
    let size = 1.0 + expected.iter().flatten().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        for (j, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < DIFFERENCE * size, "{what} {i}, {j}: {found} for {expected}");
        }
    }
}

#[test]
fn only_forces_with_multipliers_are_asked_for_again() {
    const { assert!(Arm::<f64>::FORCE_USES_MULTIPLIERS, "its slot rubs") };
    // Its tension is of the multiplier, its forces are not.
    const { assert!(!Pendulum::<f64>::FORCE_USES_MULTIPLIERS) };
    const { assert!(!Trolley::<f64>::FORCE_USES_MULTIPLIERS) };
}

#[test]
fn derivatives_of_forces_inertia_and_reactions_are_those_of_differences() {
    let arm = Arm { u: 1.7, ..Arm::default() };
    let p = arm.parameters();
    for State { q, qd, qdd, z, lambda, t } in &STATES {
        let at = |q: [f64; 3]| arm.position(&p, &q, *t);
        let here = at(*q);
        let force = differences(*q, |q| arm.force(&p, &at(q), qd, z, lambda));
        near(arm.force_q(&p, &here, qd, z, lambda), force, "∂Q/∂q");
        let force = differences(*qd, |qd| arm.force(&p, &here, &qd, z, lambda));
        near(arm.force_qd(&p, &here, qd, z, lambda), force, "∂Q/∂q̇");
        let inertia = differences(*q, |q| arm.mass_times(&p, &at(q), qdd));
        near(arm.mass_times_q(&p, &here, qdd), inertia, "(M x)_q");
        let reaction = differences(*q, |q| arm.reaction(&p, &at(q), lambda));
        near(arm.reaction_q(&p, &here, lambda), reaction, "(Φ_qᵀ λ)_q");
        let phi_q = arm.phi_q(&p, &here);
        for (i, entry) in arm.reaction(&p, &here, lambda).into_iter().enumerate() {
            close(entry, phi_q[0][i] * lambda[0], "Φ_qᵀ λ");
        }
    }
}

#[test]
fn states_have_starts_and_rates_and_stand_in_outputs() {
    let arm = Arm::default();
    let p = arm.parameters();
    assert_eq!(Arm::<f64>::STATES[0].name, "z");
    assert_eq!(arm.start_states(&p), [0.5]);
    let State { q, qd, qdd, z, lambda, t } = &STATES[0];
    let here = arm.position(&p, q, *t);
    let [rate] = arm.state_rates(&p, &here, qd, z, lambda);
    close(rate, (4.0 - z[0]) / 0.1 + 2.0 * qd[2], "ż");
    let names: Vec<&str> = Arm::<f64>::LOADS.iter().map(|load| load.name).collect();
    assert_eq!(names, ["squeeze", "mixed"]);
    let loads = arm.loads(&p, &here, &DynamicState { qd, qdd, lambda, states: z });
    assert_eq!(loads, [lambda[0] + z[0], qdd[2] + lambda[0]]);
    assert_eq!(Arm::<f64>::OUTPUTS[0].name, "speed");
}

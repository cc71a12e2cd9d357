//! CasADi against a text that uses every statement of dynamics. Its Lagrange's equations from energies and works must agree
//! with the equations that the macro emits from Jacobians.

use mbs_runtime::mechanism;
use mbs_workbench::erased::erase::erase;
use mbs_workbench::erased::facade::{AnyEquations, Description, Functions, State};
use mbs_workbench::erased::masses::{Loads, Masses, Tables};
use mbs_workbench::verify::compare::compare;
use mbs_workbench::verify::{Oracle, generated_definition, states_of};
use mechanisms::CATALOGUE;

mechanism! {
    /// Meaningless as a machine, complete as a text of dynamics.
    pub mechanism Heap;
    const C: N*m*s = 0.2;
    const D: N*s/m = 0.5;
    param m: [kg; 2] = [1.5, 0.8];
    param J: [kg*m^2; 2] = [0.02, 0.03];
    param L: m = 0.6;
    param k: N/m = 120;
    param omega: rad/s = 3;
    input u: N*m;
    input shift: m, rates;
    coord psi: [rad; 2] = [0.3, 0.8];
    coord s: m = 0.2;
    coord p: [m; 2] = [0.3, 0.4];
    state z: N = 0.5;
    state w: [rad; 2] = [0.1, 0.2];
    let phi2 = psi[0] + psi[1];
    let base = [0.1*L*sin(omega*t), shift];
    let elbow = base + L*unit(psi[0]);
    let hand = elbow + s*unit(phi2);
    for i in 0..2 {
        body rods { mass: m[i], inertia: J[i], com: elbow + i*s/2*unit(phi2) + omega*t*[s, i*s], angle: psi[i]*(1 + i*t/10s) }
    }
    body bob { mass: 0.4, com: p }
    gravity g { acceleration: [0.3 [m/s^2]*sin(omega*t), -9.81] }
    force push: [2N + z, D*der(s)] on hand;
    force friction: -tanh(der(s)*10s/1m)*abs(lambda(slot)) on s;
    torque motor: u - C*der(psi[0])*w[0] on psi[0];
    tsda strut { from: p, to: hand, stiffness: k, length: 0.35, damping: 4, actuator: 3N*sin(2*t/1s) }
    tsda stiffening { from: [0, 0], to: p, stiffness: k*(1 + dot(p, p)/L^2), length: s }
    tsda cable { from: base, to: p, stiffness: 30 }
    rsda knee { angle: psi[1], stiffness: 5, rest: 0.4, damping: 0.3, torque: 0.1*w[1]*1N*1m }
    potential well = k*s^2*cos(psi[0])/2;
    kinetic rotor = J[0]*der(psi[1])*(der(psi[1]) + 3*der(psi[0])) + m[0]*L*der(s)*der(psi[0])*sin(psi[0])/9;
    kinetic swirl = m[1]*(p[0]*der(p[1]) - p[1]*der(p[0]))*omega;
    dissipation bearing = C*der(psi[0])^2*exp(sin(psi[1]))/2;
    friction shoe { along: s + 0.1*L*sin(psi[0]), normal: lambda(slot) + z, coefficient: 0.3, speed: 0.2, viscous: 2 }
    contact stop { gap: p[0] - 0.2m*sin(psi[1]), stiffness: 7*k*(1 + w[0]^2), damping: 0.4 }
    contact ball { gap: s - 0.1m, stiffness: 2000, exponent: 1.5, depth: 1mm, damping: 0.2 }
    der(z) == (4N - z)/0.1s + k*der(s);
    der(w) == [der(psi[0]) - w[0]/1s, w[0]*w[1]*cos(psi[0])/1s];
    constraint slot { s == L/2 + 50mm*cos(psi[1]); }
    constraint rod { dot(p - hand, p - hand) == L^2; }
    out squeeze: N = lambda(slot) + z;
    out pull: [N; 2] = 2*lambda(rod)*(p - hand);
    out mixed: m/s^2 = der2(s) + lambda(slot)/m[0];
    out speed: m/s = der(s);
}

mechanism! {
    /// A driven slider-crank: square, so that its forces are those of inverse dynamics.
    pub mechanism Driven;
    param r: m = 0.05;
    param l: m = 0.18;
    coord theta: rad = 0.2;
    coord phi: rad = 0;
    coord x: m = 0.2;
    body crank { mass: 0.4, inertia: 1e-4, com: r/2*unit(theta), angle: theta }
    body rod { mass: 0.6, inertia: 2e-3, com: r*unit(theta) + l/2*unit(phi), angle: phi }
    body piston { mass: 0.5, com: [x, 0] }
    gravity g { acceleration: [0, -1g0] }
    force gas: -80N*cos(theta) on x;
    constraint closure { r*unit(theta) + l*unit(phi) == [x, 0]; }
    drive motor: theta == 0.2 + 30rad/1s*t + 2*sin(3*t/1s);
    out torque_1: N*m = effort(motor);
}

mechanism! {
    /// A crank, a rod in relative coordinates and a block in a guide, with everything that may act on bodies.
    pub mechanism Jointed;
    param a: m = 0.3;
    param b: m = 0.5;
    param force: N = 7;
    param tau: N*m = 3;
    param damping: N*m*s = 0.1;
    coord theta: rad = 0.5;
    coord psi: rad = -0.9;
    coord c: [m; 2] = [0.7, 0.02];
    coord beta: rad = 0;
    let elbow = a*unit(theta);
    let phi = theta + psi;
    body crank { mass: 0.4, inertia: 3e-3, com: elbow/3, angle: theta }
    body rod { mass: 0.6, inertia: 0.6kg*b^2/12, com: elbow + b/2*unit(phi), angle: phi }
    body block { mass: 0.8, inertia: 2e-3, com: c, angle: beta }
    gravity g { acceleration: [0.2 [m/s^2], -1g0] }
    pin O: ground, crank at [0, 0];
    pin A: rod, crank at elbow;
    pin B: rod, block at c;
    tsda spring { from: [0.1, 0.4], to: 0.8*elbow, stiffness: 40, length: 0.2, damping: 3 }
    tsda across { from: elbow + b/4*unit(phi + 0.3), to: c + 0.05m*unit(beta), damping: 2, actuator: 5N*sin(t/1s) }
    rsda knee { angle: psi, stiffness: 4, rest: -1, damping: 0.2, torque: 0.3 }
    torque motor: tau - damping*der(theta) on theta;
    torque inner: tau/6 on -psi;
    force push: [force, -2N] on c + 0.03m*unit(beta);
    force slide: -force*tanh(der(c[0])*10s/1m) on c[0];
    constraint joint { elbow + b*unit(phi) == c; }
    constraint guide { 20mm == c[1]; beta == 0; }
    out frame: [N; 2] = reaction(O, crank);
    out inside: [N; 2] = 2*reaction(A, crank) + lambda(guide[0])*[1, 0];
    out end: N = norm(reaction(B, block));
}

mechanism! {
    /// A loop in natural coordinates: every joint is written into the coordinates, none into a row.
    pub mechanism Natural;
    param d: m = 0.55;
    coord a: [m; 2] = [0.1, 0.17];
    coord b: [m; 2] = [0.5, 0.5];
    body crank { mass: 0.4, inertia: 2e-3, com: a/2, angle: atan2(a[1], a[0]) }
    body coupler { mass: 1.2, inertia: 0.04, com: (a + b)/2, angle: atan2(b[1] - a[1], b[0] - a[0]) }
    body rocker { mass: 1, inertia: 0.02, com: (b + [d, 0])/2, angle: atan2(b[1], b[0] - d) }
    gravity g { acceleration: [0, -1g0] }
    constraint rigid {
        dot(a, a) == (0.2m)^2;
        dot(b - a, b - a) == (0.6m)^2;
        dot(b - [d, 0], b - [d, 0]) == (0.5m)^2;
    }
    drive motor: atan2(a[1], a[0]) == 60deg + 2rad/1s*t;
    pin O: ground, crank at [0, 0];
    pin A: crank, coupler at a;
    pin B: coupler, rocker at b;
    pin D: rocker, ground at [d, 0];
    out forces: [N; 4] = [reaction(O, crank).0, reaction(A, coupler).1, reaction(B, rocker).0, reaction(D, rocker).1];
}

#[test]
fn casadi_confirms_every_function_of_masses_and_forces() {
    let oracle = Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let driven: Box<dyn AnyEquations> = erase(Driven::default()).into_equations();
    let ready = CATALOGUE.free().map(|card| card.equations());
    let joints: [Box<dyn AnyEquations>; 2] =
        [erase(Jointed::default()).into_equations(), erase(Natural::default()).into_equations()];
    for mut mechanism in
        [erase(Heap::default()).into_equations(), driven].into_iter().chain(joints).chain(ready)
    {
        let definition = generated_definition(mechanism.as_ref()).unwrap_or_else(|error| panic!("{error}"));
        let states = states_of(mechanism.coordinates().len());
        let agreement = compare(mechanism.as_mut(), &oracle, &definition, states);
        let agreement = agreement.unwrap_or_else(|error| panic!("{error}"));
        println!("{agreement}");
        assert!(agreement.holds(), "{agreement}");
        let functions: Vec<&str> = agreement.functions.iter().map(|function| function.function).collect();
        for function in ["M", "Q", "(Φ_qᵀ λ)_q", "energy"] {
            assert!(functions.contains(&function), "{function}");
        }
    }
}

type Slip = fn(&mut Masses);

/// A mechanism with a fault in one function of masses and forces.
struct Slipped {
    mechanism: Box<dyn AnyEquations>,
    slip: Slip,
}

impl AnyEquations for Slipped {
    fn description(&self) -> &'static Description {
        self.mechanism.description()
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.mechanism.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.mechanism.set(index, value)
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        self.mechanism.coordinate_scales()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.mechanism.row_scales()
    }
    fn evaluate(&self, state: &State) -> Functions {
        self.mechanism.evaluate(state)
    }
    fn tables(&self) -> Option<Tables> {
        self.mechanism.tables()
    }
    fn masses(&self, state: &State, loads: &Loads) -> Option<Masses> {
        let mut masses = self.mechanism.masses(state, loads)?;
        (self.slip)(&mut masses);
        Some(masses)
    }
}

/// A slip of 1e-9 in each function of masses and forces is found there and nowhere else.
#[test]
fn a_slip_in_every_quantity_is_found() {
    fn off(values: &mut [f64]) {
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let place = values.iter().position(|value| value.abs() == largest).expect("a value");
        values[place] *= 1.0 + 1e-9;
    }
    let slips: [(&str, Slip); 19] = [
        ("M", |m| off(&mut m.mass)),
        ("M q̈", |m| off(&mut m.mass_times)),
        ("Q", |m| off(&mut m.force)),
        ("∂Q/∂q", |m| off(&mut m.force_q)),
        ("∂Q/∂q̇", |m| off(&mut m.force_qd)),
        ("∂Q/∂λ", |m| off(&mut m.force_lambda)),
        ("∂Q/∂z", |m| off(&mut m.force_z)),
        ("(M q̈)_q", |m| off(&mut m.mass_times_q)),
        ("Φ_qᵀ λ", |m| off(&mut m.reaction)),
        ("(Φ_qᵀ λ)_q", |m| off(&mut m.reaction_q)),
        ("Φ̇_qᵀ λ", |m| off(&mut m.reaction_rate)),
        ("λᵀγ̇", |m| off(&mut m.gamma_rate)),
        ("energy", |m| off(&mut m.energy)),
        ("power", |m| off(&mut m.powers)),
        ("ż", |m| off(&mut m.state_rates)),
        ("∂ż/∂q", |m| off(&mut m.state_slopes[0])),
        ("∂ż/∂q̇", |m| off(&mut m.state_slopes[1])),
        ("∂ż/∂z", |m| off(&mut m.state_slopes[2])),
        ("load", |m| off(&mut m.loads)),
    ];
    let oracle = Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let definition =
        generated_definition(erase(Heap::default()).equations()).unwrap_or_else(|error| panic!("{error}"));
    for (name, slip) in slips {
        let mut slipped = Slipped { mechanism: erase(Heap::default()).into_equations(), slip };
        let agreement =
            compare(&mut slipped, &oracle, &definition, 30).unwrap_or_else(|error| panic!("{error}"));
        let differing = agreement.functions.iter().filter(|function| function.error > 1e-13);
        let differing: Vec<&str> = differing.map(|function| function.function).collect();
        assert_eq!(differing, [name], "{agreement}");
    }
}

/// The control of the test above: a wrong sign in the text of a force must be detected, with its place.
#[test]
fn a_slip_in_a_force_is_found() {
    let oracle = Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let mut mechanism = erase(Heap::default()).into_equations();
    let definition = generated_definition(mechanism.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    let right = "potential.append(elastic * (place -";
    assert!(definition.contains(right));
    let slipped = definition.replacen(right, "potential.append(elastic * (place +", 1);
    let agreement = compare(mechanism.as_mut(), &oracle, &slipped, 20).unwrap_or_else(|e| panic!("{e}"));
    assert!(!agreement.holds());
    let differing = agreement.functions.iter().filter(|function| function.error > 1e-13);
    let differing: Vec<&str> = differing.map(|function| function.function).collect();
    assert_eq!(differing, ["Q", "∂Q/∂q", "energy"]);
}

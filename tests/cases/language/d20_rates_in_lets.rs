//! D20: `der` was refused in `let`.

use mbs_codegen::expand_source;
use mbs_runtime::{Dynamic, mechanism};

mechanism! {
    /// A bob on two angles, its rates named once.
    mechanism Named;
    param L: m = 0.5;
    param c: N*s/m = 0.7;
    coord phi: rad = 0.1;
    coord psi: rad = 0.4;
    let place = L*unit(phi) + L*unit(psi);
    let v = der(place);
    let speed = norm(v);
    let a = der(v);
    let turning: rad/s = der(phi) - der(psi);
    body bob { mass: 2, com: place }
    body wheel { mass: 1, inertia: 0.3, com: L*unit(phi), angle: phi }
    force drag: -c*speed*v/1 [m/s] on place;
    torque joint: -0.2 [N*m*s]*turning on phi - psi;
    dissipation R = 0.1 [N*s/m]*speed^2;
    kinetic rotor = 0.05 [kg*m^2]*turning^2;
    for i in 0..2 {
        let w = v[i];
        force wind: [1 - i, i]*(-0.3 [N*s/m])*w on place;
    }
    out fast: m/s = speed;
    out pull: [m/s^2; 2] = a;
    out twice: [m/s^2; 2] = der2(place);
    out spin: rad/s = turning;
}

mechanism! {
    mechanism Written;
    param L: m = 0.5;
    param c: N*s/m = 0.7;
    coord phi: rad = 0.1;
    coord psi: rad = 0.4;
    let place = L*unit(phi) + L*unit(psi);
    body bob { mass: 2, com: place }
    body wheel { mass: 1, inertia: 0.3, com: L*unit(phi), angle: phi }
    force drag: -c*norm(der(place))*der(place)/1 [m/s] on place;
    torque joint: -0.2 [N*m*s]*(der(phi) - der(psi)) on phi - psi;
    dissipation R = 0.1 [N*s/m]*norm(der(place))^2;
    kinetic rotor = 0.05 [kg*m^2]*(der(phi) - der(psi))^2;
    for i in 0..2 {
        force wind: [1 - i, i]*(-0.3 [N*s/m])*der(place[i]) on place;
    }
    out fast: m/s = norm(der(place));
    out pull: [m/s^2; 2] = der2(place);
    out twice: [m/s^2; 2] = der2(place);
    out spin: rad/s = der(phi) - der(psi);
}

const Q: [f64; 2] = [0.3, -1.1];
const QD: [f64; 2] = [2.0, -0.7];
const QDD: [f64; 2] = [0.4, 5.0];

/// Forces, mass matrix and outputs.
fn values<S>(mechanism: S) -> (Vec<f64>, Vec<f64>, Vec<f64>)
where
    S: Dynamic<f64, 2, 0>,
{
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, &Q, 0.0);
    let force = mechanism.force(&parameters, &position, &QD, &mechanism.start_states(&parameters), &[]);
    let mass = mechanism.mass(&parameters, &position);
    let outputs = mechanism.outputs(&parameters, &position, &QD, &QDD);
    (
        force.to_vec(),
        mass.as_flattened().to_vec(),
        outputs.as_ref().iter().map(|output| output.value).collect(),
    )
}

#[test]
fn a_rate_in_a_let_is_that_of_the_place_where_it_is_used() {
    assert_eq!(values(Named::default()), values(Written::default()));
    let (_, _, outputs) = values(Named::default());
    let l = 0.5;
    let velocity =
        [-l * (Q[0].sin() * QD[0] + Q[1].sin() * QD[1]), l * (Q[0].cos() * QD[0] + Q[1].cos() * QD[1])];
    let acceleration = [
        -l * (0..2).map(|i| Q[i].sin() * QDD[i] + Q[i].cos() * QD[i].powi(2)).sum::<f64>(),
        l * (0..2).map(|i| Q[i].cos() * QDD[i] - Q[i].sin() * QD[i].powi(2)).sum::<f64>(),
    ];
    let [x, y] = acceleration;
    let expected = [velocity[0].hypot(velocity[1]), x, y, x, y, QD[0] - QD[1]];
    for (found, expected) in outputs.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14 * (1.0 + expected.abs()), "{found} for {expected}");
    }
}

/// Messages about a text whose `let`s are rates; empty if it is right.
fn report(statement: &str) -> String {
    let text = format!(
        "mechanism M; coord x: m = 0.1; coord y: m = 0.2; let u = v; let v = der(x); let a = der(u); let b = der2(y); \
         let half: m/s = 0.5*v; body bob {{ mass: 1, com: [x, y] }} {statement}"
    );
    expand_source(&text).err().unwrap_or_default()
}

#[test]
fn a_rate_in_a_let_is_refused_where_rates_are_and_nowhere_else() {
    for accepted in [
        "",
        "out speed: m/s = half;",
        "out force: m/s^2 = a + b;",
        "force drag: [-1 [N*s/m]*u, 0] on [x, y];",
        "tsda d { from: [0, 0], to: [x, y], actuator: 2 [N*s/m]*half }",
        "dissipation R = 1 [N*s/m]*v*u;",
        "state z: m = 0; der(z) == v;",
        "for i in 0..2 { let w = (i + 1)*v; force drag: [-1 [N*s/m]*w, 0] on [x, y]; }",
    ] {
        assert_eq!(report(accepted), "", "{accepted}");
    }
    for (refused, message) in [
        ("constraint c { x + half*1s == y; }", "`half` takes a rate"),
        ("drive d: x == v*t;", "`v` takes a rate"),
        ("drive d: rate(x) == v;", "`v` takes a rate"),
        ("branch up: u > 0;", "`u` takes a rate"),
        ("limit l: 0 <= u*1s <= 1;", "`u` takes a rate"),
        ("start x = v*1s;", "`v` takes a rate"),
        ("potential V = 1 [N*s/m]*v*1m;", "`v` takes a rate"),
        ("contact c { gap: x + v*1s, stiffness: 1e6 }", "`v` takes a rate"),
        ("body other { mass: 1, com: [x + v*1s, y] }", "`v` takes a rate"),
        ("coord z: m = v*1s;", "cannot be used here"),
        ("force push: [1kg*a, 0] on [x, y];", "`a` takes an acceleration"),
        ("force push: [1kg*b, 0] on [x, y];", "`b` takes an acceleration"),
        ("force push: [1kg*der(u), 0] on [x, y];", "an acceleration stands in a force"),
        ("for i in 0..2 { let w = (i + 1)*v; constraint c { x + w*1s == y; } }", "`w` takes a rate"),
    ] {
        let found = report(refused);
        assert!(found.contains(message), "{refused}: {found}");
    }
}

#[test]
fn casadi_sees_the_same_rates() {
    let definition = |rate: &str| {
        let text = format!(
            "mechanism M; coord x: m = 0.1; {} body bob {{ mass: 1, com: [x, x] }} \
             force drag: [-1 [N*s/m]*{rate}, 0] on [x, x]; out speed: m/s = 2*{rate};",
            if rate == "v" { "let v = der(x);" } else { "" }
        );
        mbs_codegen::casadi_definition(&text, None).expect("a definition")
    };
    let (named, written) = (definition("v"), definition("der(x)"));
    assert!(named.contains("der(") && written.contains("der("));
    let signature = |text: &str| text.lines().filter(|line| line.contains("return")).count();
    assert_eq!(signature(&named), signature(&written));
}

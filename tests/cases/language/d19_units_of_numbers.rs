//! D19: compound units on numbers (`2kg*m^2`, `30rad/s`) were unknown names; `[0, 10*cos(a)]` had no unit although `[0, 10]` had.

use std::f64::consts::PI;

use mbs_codegen::expand_source;
use mbs_runtime::{Dynamic, Mechanism, Stepper, mechanism};

/// Messages about a text; empty if it is right.
fn report(statement: &str) -> String {
    let text = format!(
        "mechanism M; param L: m = 0.5; param n: 1 = 3; coord phi: rad = 0.1; \
         body bob {{ mass: 1, com: L*unit(phi) }} {statement}"
    );
    expand_source(&text).err().unwrap_or_default()
}

#[test]
fn a_compound_unit_without_brackets_is_told_its_form() {
    for (written, unit, form) in [
        ("2kg*m^2", "kg*m^2", "2 [kg*m^2]"),
        ("30rad/s", "rad/s", "30 [rad/s]"),
        ("30deg/s^2", "rad/s^2", "30 [deg/s^2]"),
        ("5N*s/m", "N*s/m", "5 [N*s/m]"),
        ("1.5kN/mm", "N/m", "1.5 [kN/mm]"),
        ("9.81m/s^2*2", "m/s^2", "9.81 [m/s^2]"),
        ("1 + 2kg*m^2", "kg*m^2", "2 [kg*m^2]"),
    ] {
        let found = report(&format!("out a: {unit} = {written};"));
        assert!(found.contains("unknown name") && found.contains(&format!("`{form}`")), "{written}: {found}");
        assert_eq!(report(&format!("out a: {unit} = {form};")), "", "{form}");
    }
}

#[test]
fn brackets_hold_a_unit_behind_a_number_alone() {
    assert_eq!(report("out a: [m; 2] = [1 [m], 2 [cm]]; out b: m = [1, 2 [m/s]*1s][1] + [3 [m]][0];"), "");
    assert_eq!(report("out a: m = sum(i in 0..2: [1 [m], 2 [m]][i]);"), "");
    for (written, cure) in [
        ("2 [1, 0]", "`2*[x, y]`"),
        ("2 [L]", "`L` is no known unit"),
        ("2m [s]", "a number has one unit"),
        ("2 [m", "`[` is never closed"),
        ("2 []", "hold no unit"),
        ("2 [m^99]", "reach up to 12"),
        ("2 [m] [m]", "an index"),
        ("1e-300 [(nm^12)^12]", "too small"),
        ("1e300 [(km^12)^12]", "too large"),
    ] {
        let found = report(&format!("out a: m = {written};"));
        assert!(!found.is_empty(), "{written}");
        assert!(found.contains(cure) || cure == "an index", "{written}: {found}");
    }
}

mechanism! {
    mechanism Units;
    coord x: m;
    drive d: x == 1m*t/1s;
    out inertia: kg*m^2 = 2 [gram*mm^2];
    out speed: rad/s = 180 [deg/s];
    out slow: m/s = 36 [km/h];
    out pressure: Pa = 1 [N/mm^2];
    out stiffness: N*m/rad = 1 [N*m/deg];
    out rotor: rad/s^2 = 30 [rpm/s];
    out number: 1 = 7 [1];
    out weight: m/s^2 = -1 [g0];
    out heat: W/m^2 = 3 [(kW/m)/(m)];
}

#[test]
fn symbols_in_brackets_have_their_factors_and_powers() {
    let motion = Stepper::assemble(Units::default(), [0.0], 0.0).expect("assembled");
    let expected = [2e-9, PI, 10.0, 1e6, 180.0 / PI, PI, 7.0, -9.80665, 3000.0];
    for (index, (output, expected)) in motion.outputs().iter().zip(expected).enumerate() {
        // Few roundings: factors, divisors, their quotient.
        let error = (output.value - expected).abs() / expected.abs();
        assert!(error <= 4.0 * f64::EPSILON, "{index}: {} for {expected}", output.value);
    }
}

#[test]
fn multiples_without_a_unit_take_the_declared_one_wherever_numbers_do() {
    for accepted in [
        "force push: [0, 10*cos(phi)] on L*unit(phi);",
        "force push: [10*sin(t/1s), 5] on L*unit(phi);",
        "force push: 10*unit(phi) on L*unit(phi);",
        "force push: rot(phi)*[10, 0] on L*unit(phi);",
        "force push: [10*exp(-t/1s), -2*n] on L*unit(phi);",
        "force push: [10N, 5*tanh(t/1s)] on L*unit(phi);",
        "force push: [3*(1 + cos(phi)), 3 - cos(phi)] on L*unit(phi);",
        "force push: [10*t/1s, 10*L/1m] on L*unit(phi);",
        "let F = 10*cos(phi); force push: [0, F] on L*unit(phi);",
        "let F: N = 10*cos(phi); force push: [0, F] on L*unit(phi);",
        "torque turning: 10*cos(phi) on phi;",
        "gravity weight { acceleration: [0, -9.81*(1 + 0.1*sin(t/1s))] }",
        "tsda spring { from: [0, 0.5*cos(t/1s)], to: L*unit(phi), stiffness: 100*exp(-t/1s) }",
        "potential V = 3*cos(phi);",
        "out height: m = 2*sin(phi);",
        "out place: [m; 2] = [1, 2*sin(phi)];",
        "param F: N = 10*cos(PI/3); force push: [0, F] on L*unit(phi);",
        "start phi = 0.2 rate 3*cos(n);",
    ] {
        assert_eq!(report(accepted), "", "{accepted}");
    }
}

#[test]
fn expressions_without_a_number_for_the_unit_keep_their_own() {
    for refused in [
        "force push: [0, cos(phi)] on L*unit(phi);",
        "force push: [0, sin(2*phi)] on L*unit(phi);",
        "force push: [0, 10*phi] on L*unit(phi);",
        "force push: [0, phi/2] on L*unit(phi);",
        "force push: [0, 10*L*cos(phi)] on L*unit(phi);",
        "force push: [0, 10*atan2(L, L)] on L*unit(phi);",
        "force push: [0, n] on L*unit(phi);",
        "force push: [0, 2^n] on L*unit(phi);",
        "force push: [0, 10N + 5*cos(phi)] on L*unit(phi);",
        "potential V = 0.5*phi^2;",
        "out height: m = sin(phi);",
        "out height: m = L/1m;",
        "out height: m = 30deg*2;",
        "out height: m = n^2;",
        "out speed: m = angular_velocity([cos(phi/2), 0, 0, sin(phi/2)]).2*1s;",
        "out axis: [m; 3] = rotate([cos(phi/2), 0, 0, sin(phi/2)], [n, 0, 0]);",
        "constraint c { L == 2*cos(phi); }",
    ] {
        let found = report(refused);
        assert!(found.lines().count() == 2 && found.contains(" in `"), "{refused}: {found}");
    }
}

mechanism! {
    mechanism Pushed;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    body bob { mass: 2, com: L*unit(phi) }
    force push: [0, 10*cos(phi)] on L*unit(phi);
    torque brake: -3*sin(phi) - 2*t/1s on phi;
}

#[test]
fn a_multiple_is_in_si() {
    let pushed = Pushed::default();
    let parameters = pushed.parameters();
    let (phi, t) = (0.3_f64, 0.5);
    let position = pushed.position(&parameters, &[phi], t);
    let [force] = pushed.force(&parameters, &position, &[0.0], &pushed.start_states(&parameters), &[]);
    let expected = 0.5 * phi.cos() * 10.0 * phi.cos() - 3.0 * phi.sin() - 2.0 * t;
    assert!((force - expected).abs() < 1e-14, "{force} for {expected}");
}

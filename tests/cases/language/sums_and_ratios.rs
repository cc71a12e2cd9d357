//! A `sum` without terms was a scalar beside vectors; a ratio of two angles was an angle; Euler parameters asked for a branch.

use mbs_codegen::{expand_source, warnings};

/// Messages about a text; empty if it is right.
fn report(statements: &str) -> String {
    expand_source(&format!("mechanism M; {statements}")).err().unwrap_or_default()
}

#[test]
fn a_sum_without_terms_is_zero_in_any_shape() {
    // The forward kinematics of a chain, as one writes it.
    let chain = |place: &str| {
        format!(
            "const N: 1 = 3; param L: m = 0.2; coord phi: [rad; N] = 0.1; \
             for i in 0..N {{ body link {{ mass: 1kg, com: {place}, inertia: 1e-3, angle: phi[i] }} }}"
        )
    };
    let before = "sum(j in 0..i: L*unit(phi[j]))";
    for place in [
        format!("{before} + L/2*unit(phi[i])"),
        format!("L/2*unit(phi[i]) + {before}"),
        format!("L*unit(phi[i]) - ({before} - L*unit(0.3))"),
    ] {
        assert_eq!(report(&chain(&place)), "", "{place}");
        let long =
            chain(&place.replace("sum(j in 0..i: L*unit(phi[j]))", "sum(j in 0..i + 1: L*unit(phi[j]))"));
        assert_eq!(report(&long), "", "{long}");
    }
    // A vector of another length does not fit.
    let wrong = report(&chain("L*unit(phi[i]) + [L, L, L]"));
    assert!(wrong.contains("cannot be added"), "{wrong}");
    let of_scalar = report(&chain("L*unit(phi[i]) + L*phi[0]"));
    assert!(of_scalar.contains("a vector of 2 and a scalar cannot be added"), "{of_scalar}");
}

#[test]
fn a_ratio_of_angles_is_a_number() {
    let torque = |value: &str| {
        report(&format!(
            "param idle: rad/s = 40; coord phi: rad = 0.1; body shaft {{ mass: 1kg, com: [0, 0], inertia: 1, angle: phi }} \
             torque motor: {value} on phi;"
        ))
    };
    for value in
        ["6*(1 - der(phi)/idle)", "6*(1 - der(phi)/40rpm)", "6*(1 - phi/30deg)", "6*(1 - (der(phi)/idle)^2)"]
    {
        assert_eq!(torque(value), "", "{value}");
    }
    // An angle has a unit, and so has a rate of one times a time.
    for value in ["6*phi", "6*(1 - phi)", "6*(1 - der(phi)*1s)", "phi/30deg"] {
        assert!(torque(value).contains("`motor` is in `N*m`"), "{value}: {}", torque(value));
    }
}

#[test]
fn euler_parameters_ask_for_no_branch() {
    let text = "mechanism M; coord e: [1; 4] = [1, 0, 0, 0]; \
                body top { mass: 1kg, com: rotate(e, [0, 0, 0.1]), inertia: [2e-3, 2e-3, 1e-3], orientation: e }";
    let found = warnings(text).expect("no faults");
    assert!(found.is_empty(), "{found:?}");
    let loop_of_two = "mechanism M; coord a: rad = 0.5; coord b: rad = 1; coord c: rad = 1.5; \
                       constraint closure { 0.1m*unit(a) + 0.3m*unit(b) == [0.3m, 0] + 0.25m*unit(c); } drive d: a == t/1s;";
    let found = warnings(loop_of_two).expect("no faults");
    assert!(found.iter().any(|warning| warning.message.contains("no branch chooses one")), "{found:?}");
}

//! A row that is an earlier one times a factor is reported, however it is written; no other row is.
#![forbid(unsafe_code)]

/// Declarations that the rows use, with free motions left for masses.
const TEXT: &str = "mechanism M;
param L: m = 0.5;
param k: 1 = 2;
input u: m, rates;
function lift: m(rad), C3, periodic TAU;
function other: m(rad), C3;
coord phi: rad = 0.3;
coord psi: rad = 0.4;
coord x: m = 0.3;
coord y: m = 0.2;
coord p: [m; 2] = [0.5, 0];
coord q: [m; 2] = [0.5, 1];
coord e: [1; 4] = [1, 0, 0, 0];
coord f: [1; 4] = [1, 0, 0, 0];
body first { mass: 1, com: rotate(e, [0, 0, 1m]), inertia: [1, 2, 2], orientation: e }
body second { mass: 1, com: rotate(f, [0, 0, 1m]), inertia: [1, 2, 2], orientation: f }
potential height = 1N*(p.0 + p.1 + q.0 + q.1 + x + y) + 1 [N*m]*(phi + psi);
kinetic all = 1kg*(dot(der(p), der(p)) + dot(der(q), der(q)) + der(x)^2 + der(y)^2)/2 + 1 [kg*m^2]*(der(phi)^2 + der(psi)^2)/2;
out used: m = lift(phi) + other(psi) + u;
";

fn faults(rows: &str) -> Vec<String> {
    let text = format!("{TEXT}{rows}");
    match mbs_codegen::outline(&text) {
        Ok(_) => Vec::new(),
        Err(faults) => faults.into_iter().map(|fault| fault.message).collect(),
    }
}

/// Two equations, the second the first one in another form.
const SAME: [[&str; 2]; 24] = [
    ["x == y", "y == x"],
    ["x == y", "2*x - 2*y == 0m"],
    ["x == y", "L*x == L*y"],
    ["x == y", "(x - y)/(L + 1m) == 0"],
    ["x == L*cos(phi)", "k*(x - L*cos(phi)) == 0m"],
    ["x == u", "3*x == 3*u"],
    ["x == 0.1m*sin(t/1s)", "-x == -0.1m*sin(t/1s)"],
    ["dot(p, p) == L^2", "p.0^2 + p.1^2 == L^2"],
    ["dot(p, p) == L^2", "(p.0 - L)*(p.0 + L) + p.1^2 == 0 [m^2]"],
    ["dot(p, p) == L^2", "2*L^2 - 2*dot(p, p) == 0 [m^2]"],
    ["dot(p - q, p - q) == L^2", "dot(p, p) - 2*dot(p, q) + dot(q, q) == L^2"],
    ["dot(p - q, p - q) == L^2", "dot(q - p, q - p) == L*L"],
    ["sin(phi - psi) == 0", "sin(phi)*cos(psi) == cos(phi)*sin(psi)"],
    ["cos(2*phi) == 0.5", "2*cos(phi)^2 == 1.5"],
    ["sin(phi) == 0.2", "-sin(phi + PI) == 0.2"],
    ["x == lift(phi)", "2*lift(phi) == 2*x"],
    ["x == lift(2*phi)", "lift(phi + phi) - x == 0m"],
    ["x == lift.d1(phi)", "3*x == 3*lift.d1(phi)"],
    ["norm(p)^2 == dot(q, q)", "dot(p, p) == dot(q, q)"],
    ["cross([p.0, p.1, 0m], [q.0, q.1, 0m]).2 == 0 [m^2]", "det([p, q]) == 0 [m^2]"],
    ["tan(phi)*cos(phi) == sin(psi)", "sin(phi) == sin(psi)"],
    ["exp(phi)*exp(psi) == 2", "exp(phi + psi) == 2"],
    ["e.1*f.0 == e.0*f.1", "k*e.0*f.1 == k*e.1*f.0"],
    ["dot(rot(phi)*p, q) == 0 [m^2]", "dot(p, rot(-phi)*q) == 0 [m^2]"],
];

#[test]
fn a_row_in_another_form_is_reported() {
    for [first, second] in SAME {
        for (one, other) in [(first, second), (second, first)] {
            let found = faults(&format!("constraint a {{ {one}; }} constraint b {{ {other}; }}"));
            assert_eq!(found.len(), 1, "{one} and {other}: {found:?}");
            assert!(found[0].contains("`b` is the row `a` once more"), "{one} and {other}: {found:?}");
        }
        let marked = faults(&format!("constraint a {{ {first}; }} constraint b redundant {{ {second}; }}"));
        assert!(marked.is_empty(), "{first} and {second}: {marked:?}");
    }
}

/// Equations that look alike, or hold together in a part of all positions alone.
const DIFFERENT: [[&str; 2]; 26] = [
    ["x == y", "x == y + 1nm"],
    ["x == y", "x == (1 + 1e-9)*y"],
    ["x == y", "x == k*y"],
    ["x == y", "abs(x) == abs(y)"],
    ["x == y", "sqrt(x^2) == sqrt(y^2)"],
    ["x == y", "x^2 == y^2"],
    ["x == y", "x*(x - y) == 0 [m^2]"],
    ["x == y", "max(x, y) == y"],
    ["x == y", "hypot(x, 0m) == hypot(y, 0m)"],
    ["phi == psi", "sin(phi - psi) == 0"],
    ["phi == psi", "asin(sin(phi)) == psi"],
    ["phi == psi", "atan2(sin(phi), cos(phi)) == psi"],
    ["phi == psi", "tan(phi) == tan(psi)"],
    ["phi == psi", "ln(exp(phi)) == psi + 1e-8"],
    ["sin(phi) == sin(psi)", "cos(phi) == cos(psi)"],
    ["sin(phi) == 0.2", "sin(phi) == 0.2000001"],
    ["sin(phi) == 0.2", "sin(psi) == 0.2"],
    ["x == lift(phi)", "x == other(phi)"],
    ["x == lift(phi)", "x == lift(phi + 1e-6)"],
    ["x == lift(phi)", "x == lift.d1(phi)"],
    ["x == u", "x == 1.000001*u"],
    ["x == 1 [m/s]*t", "x == 0.2m"],
    ["dot(p, p) == L^2", "dot(q, q) == L^2"],
    ["dot(p, p) == L^2", "norm(p) == L"],
    ["dot(e, f) == 0.5", "dot(rotate(e, [1, 0, 0]), rotate(f, [1, 0, 0])) == 0.5"],
    ["e.0 == f.0", "abs(e.0) == abs(f.0)"],
];

#[test]
fn rows_that_are_two_are_not_reported() {
    for [first, second] in DIFFERENT {
        let found = faults(&format!("constraint a {{ {first}; }} constraint b {{ {second}; }}"));
        assert!(!found.iter().any(|fault| fault.contains("once more")), "{first} and {second}: {found:?}");
    }
}

#[test]
fn lengths_of_the_parameters_of_several_bodies_are_reported() {
    for row in [
        "dot(e, e) == dot(f, f)",
        "dot(f, f) - dot(e, e) == 0",
        "2*norm(e) == 2*norm(f)",
        "e.0^2 + e.1^2 + e.2^2 + e.3^2 == f.0^2 + f.1^2 + f.2^2 + f.3^2",
        "dot(e, e)*dot(f, f) == 1",
        "dot(e, e) + dot(f, f) == 2",
    ] {
        let found = faults(&format!("constraint a {{ {row}; }}"));
        assert_eq!(found, ["the row `a` follows from the lengths of Euler parameters"], "{row}");
    }
    for row in ["dot(e, f) == 1", "dot(e, e) == dot(f, f) + e.1", "e.0 == f.0", "dot(e, e)*f.1 == 0"] {
        assert!(faults(&format!("constraint a {{ {row}; }}")).is_empty(), "{row}");
    }
}

#[test]
fn drives_and_rows_of_one_constraint_count_too() {
    let found = faults("constraint a { x == y; y + 1m == x + 1m; }");
    assert!(found.iter().any(|fault| fault.starts_with("the row `a.1` is the row `a.0`")), "{found:?}");
    let found = faults("drive a: phi == 3*t/1s; drive b: 2*phi == 6*t/1s;");
    assert!(found.iter().any(|fault| fault.starts_with("the row `b` is the row `a`")), "{found:?}");
}

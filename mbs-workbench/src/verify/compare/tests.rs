//! A mechanism whose functions were differentiated by hand, and the same with faults that must be found.

use mbs_runtime::{Entry, OutputValue};

use super::*;
use crate::erased::facade::{Description, State};
use crate::erased::masses::Loads;
use crate::verify::BOUND;
use crate::verify::states::Sample;

/// Independent definition: one input with rates, an output with all and one with fewer derivatives.
const DEFINITION: &str = "
NAME = 'Hand'
N = 2
V = 4
RATES = [(1, 2, 3)]

def define(ca, q, v, t, der):
    theta, x = q[0], q[1]
    length, u = v[0], v[1]
    phi = [length * ca.cos(theta) * u - x, theta - t * t * u]
    return phi, [(x * theta, 2), (der(x), 1)]
";

const fn entry(name: &'static str, unit: &'static str) -> Entry {
    Entry { name, unit, line: 1 }
}

type Fault = fn(&mut Functions);

struct Hand {
    variables: [f64; 4],
    fault: Fault,
}

impl AnyEquations for Hand {
    fn description(&self) -> &'static Description {
        const {
            &Description {
                type_name: "Hand",
                told: core::any::type_name::<Self>,
                scene: "AllEffects",
                source: "",
                coordinates: &[entry("theta", "rad"), entry("x", "m")],
                rows: &[entry("first", "m"), entry("second", "rad")],
                variables: &[
                    entry("length", "m"),
                    entry("u", "1"),
                    entry("u_rate", "1/s"),
                    entry("u_acceleration", "1/s^2"),
                ],
                outputs: &[entry("product", "m"), entry("speed", "m/s")],
                functions: &[],
            }
        }
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.variables.get(index).copied()
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.variables.get_mut(index).is_some_and(|variable| {
            *variable = value;
            true
        })
    }
    fn row_scales(&self) -> Vec<f64> {
        vec![1.0; self.rows().len()]
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        vec![1.0, 0.3]
    }
    fn evaluate(&self, state: &State) -> Functions {
        let [l, u, ud, udd] = self.variables;
        let ([theta, x], [w, v]) = ([state.q[0], state.q[1]], [state.qd[0], state.qd[1]]);
        let ([e, a], t, s, c) = ([state.qdd[0], state.qdd[1]], state.t, state.q[0].sin(), state.q[0].cos());
        let phi_tt = vec![l * c * udd, -2.0 * u - 4.0 * t * ud - t * t * udd];
        let gamma = vec![l * c * u * w * w + 2.0 * l * s * ud * w - phi_tt[0], -phi_tt[1]];
        let product = OutputValue {
            value: x * theta,
            rate: Some(v * theta + x * w),
            acceleration: Some(a * theta + 2.0 * v * w + x * e),
        };
        let speed = OutputValue { value: v, rate: Some(a), acceleration: None };
        let mut functions = Functions {
            phi: vec![l * c * u - x, theta - t * t * u],
            phi_q: vec![-l * s * u, -1.0, 1.0, 0.0],
            phi_t: vec![l * c * ud, -2.0 * t * u - t * t * ud],
            phi_tt,
            phi_qt_qd: vec![-l * s * ud * w, 0.0],
            gamma,
            outputs: vec![product, speed],
        };
        (self.fault)(&mut functions);
        functions
    }
}

fn oracle() -> Oracle {
    Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn digits(fault: Fault) -> Agreement {
    let mut hand = Hand { variables: [0.3, 1.5, 0.0, 0.0], fault };
    compare_digits(&mut hand, &oracle(), DEFINITION, 20).unwrap_or_else(|error| panic!("{error}"))
}

fn agreement(fault: Fault) -> Agreement {
    let mut hand = Hand { variables: [0.3, 1.5, 0.0, 0.0], fault };
    compare(&mut hand, &oracle(), DEFINITION, 1000).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn derivatives_by_hand_agree() {
    let agreement = agreement(|_| ());
    assert!(agreement.holds(), "{agreement}");
    assert_eq!((agreement.states, agreement.functions.len()), (1000, 9));
}

#[test]
fn every_function_is_compared() {
    let faults: [(&str, Fault); 9] = [
        ("Φ", |f| f.phi[1] += 1e-10),
        ("Φ_q", |f| f.phi_q[2] += 1e-12),
        ("Φ_t", |f| f.phi_t[0] *= 1.0 + 1e-12),
        ("Φ_tt", |f| f.phi_tt[1] += 1e-10),
        ("Φ_qt q̇", |f| f.phi_qt_qd[1] += 1e-300),
        ("γ", |f| f.gamma[0] = -f.gamma[0]),
        ("output", |f| f.outputs[0].value += 1e-11),
        ("d output/dt", |f| f.outputs[1].rate = Some(f64::NAN)),
        ("d² output/dt²", |f| f.outputs[0].acceleration = None),
    ];
    for (name, fault) in faults {
        let agreement = agreement(fault);
        let failing: Vec<_> =
            agreement.functions.iter().filter(|f| f.error > BOUND).map(|f| f.function).collect();
        assert_eq!(failing, [name], "{agreement}");
    }
}

#[test]
fn fifty_digits_tell_roundings_from_slips() {
    let good = digits(|_| ());
    assert!(good.holds() && good.values == 20 * 19, "{good}");
    let faults: [(&str, Fault); 9] = [
        ("Φ", |f| f.phi[1] += 1e-12),
        ("Φ_q", |f| f.phi_q[2] += 1e-13),
        ("Φ_t", |f| f.phi_t[0] *= 1.0 + 1e-12),
        ("Φ_tt", |f| f.phi_tt[1] += 1e-11),
        // Its bound is that of the second derivatives whose difference it is.
        ("Φ_qt q̇", |f| f.phi_qt_qd[1] += 1e-11),
        ("γ", |f| f.gamma[0] = -f.gamma[0]),
        ("output", |f| f.outputs[0].value += 1e-12),
        ("d output/dt", |f| f.outputs[1].rate = Some(f64::NAN)),
        ("d² output/dt²", |f| f.outputs[0].acceleration = None),
    ];
    for (name, fault) in faults {
        let agreement = digits(fault);
        let failing: Vec<_> =
            agreement.functions.iter().filter(|f| f.error > 1.0).map(|f| f.function).collect();
        assert_eq!(failing, [name], "{agreement}");
    }
}

/// Published expansions of sin 1, cos 1 and e, which a derivative by mpmath must reach too.
#[test]
fn fifty_digits_are_the_published_ones() {
    let definition = "
NAME = 'Known'
N = 2
V = 0
RATES = []

def define(ca, q, v, t, der):
    return [ca.sin(q[0]), ca.exp(q[1])], []
";
    let state = State { q: vec![1.0; 2], qd: vec![1.0; 2], qdd: vec![0.0; 2], t: 0.0 };
    let answer =
        oracle().evaluate_digits(definition, &[Sample { state, variables: vec![], loads: Loads::default() }]);
    let functions = answer.unwrap_or_else(|error| panic!("{error}")).functions;
    let (sine, cosine) =
        ([0.8414709848078965, 1.776845092935536e-18], [0.5403023058681398, -4.760954612604417e-17]);
    let e = [core::f64::consts::E, 1.4456468917292501e-16];
    let expected = [
        ("phi", 0, sine),
        ("phi", 1, e),
        ("phi_q", 0, cosine),
        ("phi_q", 3, e),
        ("gamma", 0, sine),
        ("gamma", 1, e.map(|x| -x)),
    ];
    for (function, entry, [value, rest]) in expected {
        let found = functions[function][0][entry].expect("a value");
        assert_eq!(found.value, value, "{function} {entry}");
        assert!((found.rest - rest).abs() <= 1e-32, "{function} {entry}: {}", found.rest);
    }
}

/// No value is compared if rounding decides on which side of a kink it is; all others are.
#[test]
fn only_what_rounding_decides_is_left_out() {
    let definition = "
NAME = 'Torn'
N = 2
V = 0
RATES = []

def define(ca, q, v, t, der):
    return [ca.fabs(q[0] * ca.SX(3.0) - ca.SX(0.3)), ca.fabs(q[1])], []
";
    let state = State { q: vec![0.1, 0.1], qd: vec![1.0; 2], qdd: vec![0.0; 2], t: 0.0 };
    let answer =
        oracle().evaluate_digits(definition, &[Sample { state, variables: vec![], loads: Loads::default() }]);
    let functions = answer.unwrap_or_else(|error| panic!("{error}")).functions;
    let bounds: Vec<bool> =
        functions["phi"][0].iter().map(|entry| entry.expect("a value").bound.is_some()).collect();
    assert_eq!(bounds, [false, true]);
}

/// The first row by a detour that loses six digits: CasADi is off, the emitted values are not.
#[test]
fn fifty_digits_decide_where_casadi_itself_cancels() {
    let detour = DEFINITION.replace("- x, theta", "- x + ca.exp(ca.log(x * x + 1e6)) - (x * x + 1e6), theta");
    let compared = |fault: Fault, states: usize| {
        let mut hand = Hand { variables: [0.3, 1.5, 0.0, 0.0], fault };
        compare(&mut hand, &oracle(), &detour, states).unwrap_or_else(|error| panic!("{error}"))
    };
    let right = compared(|_| (), 12);
    assert!(right.holds() && right.decisions.iter().any(|decision| decision.function == "Φ"), "{right}");
    assert!(
        right.decisions.iter().all(|decision| decision.share <= 1.0 && decision.condition > 1e5),
        "{right}"
    );
    let wrong = compared(|f| f.phi[0] += 1e-7, 12);
    assert!(!wrong.holds() && wrong.to_string().contains("DIFFERS"), "{wrong}");
    // At so many states it is no matter of rounding.
    assert!(!compared(|_| (), 200).holds());
}

#[test]
fn a_function_that_has_entries_and_no_values_is_not_confirmed() {
    let agreement = agreement(|f| f.phi_t.clear());
    assert!(!agreement.holds() && agreement.to_string().contains("NOT COMPARED"), "{agreement}");
}

#[test]
fn the_largest_error_names_row_and_coordinate() {
    let agreement = agreement(|f| f.phi_q[1] = 0.5);
    let worst = agreement.worst().expect("functions");
    assert_eq!((worst.entry.as_str(), worst.emitted, worst.oracle), ("first, x", Some(0.5), Some(-1.0)));
    assert!(agreement.to_string().contains("DIFFERS") && !agreement.holds());
}

#[test]
fn a_definition_of_another_size_is_refused() {
    let mut hand = Hand { variables: [0.3, 1.5, 0.0, 0.0], fault: |_| () };
    let smaller = DEFINITION.replace("V = 4", "V = 5");
    let error = compare(&mut hand, &oracle(), &smaller, 2).expect_err("sizes differ");
    assert!(error.to_string().contains("has 2 coordinates and 5 variables"), "{error}");
    let other = DEFINITION.replace("'Hand'", "'Foot'");
    let error = compare(&mut hand, &oracle(), &other, 2).expect_err("names differ");
    assert!(matches!(error, OracleError::Answer { .. }), "{error}");
    let failing = compare(&mut hand, &oracle(), "NAME = 1 +", 2).expect_err("no Python");
    assert!(failing.to_string().contains("SyntaxError"), "{failing}");
}

#[test]
fn infinite_numbers_come_through() {
    let mut hand = Hand { variables: [0.3, 1.5, 0.0, 0.0], fault: |f| f.phi[0] = f64::INFINITY };
    let definition = DEFINITION.replace("- x, theta", "- x + ca.log(0 * x), theta");
    let agreement = compare(&mut hand, &oracle(), &definition, 3).unwrap_or_else(|error| panic!("{error}"));
    assert!(!agreement.holds(), "{agreement}");
}

//! Functions that the caller supplies, on numbers with derivatives.
//!
//! Their values and derivatives are data of the caller. Each derivative that is used is compared with differences of what it is the
//! derivative of, so that a function cannot contradict itself unseen.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::rc::Rc;

use super::evaluation::Gap;
use super::number::Number;

/// Value and derivatives of a function at an argument, as many as the text needs.
pub type Jet = Rc<dyn Fn(f64) -> Vec<f64>>;

/// Step of the differences as a part of the argument, and the least argument that it is a part of.
const STEP: f64 = 1e-6;
const LEAST: f64 = 1e-3;

/// Rounding of a value of the caller in ε.
const DIGITS: f64 = 1e3;

/// The functions of a text by their names, `lift` or `lift[0]`.
#[derive(Default)]
pub struct Laws {
    pub known: BTreeMap<String, Jet>,
    fault: RefCell<Option<String>>,
}

impl fmt::Debug for Laws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.known.keys()).finish()
    }
}

impl Laws {
    /// `true` for a function, or an array of functions.
    pub fn has(&self, name: &str) -> bool {
        self.known.contains_key(name) || self.known.contains_key(&format!("{name}[0]"))
    }

    /// The derivative of an order at an argument that moves.
    ///
    /// # Errors
    /// There is no such derivative.
    pub fn call(&self, name: &str, index: Option<usize>, order: usize, x: Number) -> Result<Number, Gap> {
        let name = index.map_or_else(|| name.to_string(), |index| format!("{name}[{index}]"));
        let law = self.known.get(&name).ok_or_else(|| Gap(format!("the caller's function `{name}`")))?;
        let jet = law(x.value.v);
        if jet.len() <= order {
            return Err(Gap(format!("derivative {order} of the caller's function `{name}`")));
        }
        if self.fault.borrow().is_none() {
            *self.fault.borrow_mut() = contradiction(&name, law, x.value.v, &jet);
        }
        let part = |more: usize| jet.get(order + more).copied().unwrap_or(f64::NAN);
        Ok(x.through([0, 1, 2, 3].map(part)))
    }

    /// The first derivative that contradicts the values of its function, in words.
    pub fn fault(&self) -> Option<String> {
        self.fault.borrow().clone()
    }
}

/// A derivative of `law` at `x` that is beside the slopes on both sides, in words.
fn contradiction(name: &str, law: &Jet, x: f64, jet: &[f64]) -> Option<String> {
    let width = STEP * x.abs().max(LEAST);
    let (before, after) = (x - width, x + width);
    let (left, right) = (law(before), law(after));
    for (order, pair) in jet.windows(2).enumerate() {
        let [value, slope] = pair else { continue };
        let slopes = [(value - left.get(order)?) / (x - before), (right.get(order)? - value) / (after - x)];
        let [low, high] = [slopes[0].min(slopes[1]), slopes[0].max(slopes[1])];
        let digit = DIGITS * f64::EPSILON * (value.abs() + (x * slope).abs()) / width;
        let slack = (high - low) + digit;
        if *slope < low - slack || *slope > high + slack {
            let next = order + 1;
            return Some(format!(
                "the caller's function `{name}` contradicts itself: derivative {next} at {x:.6} is {slope:.6e}, \
                 by differences it is {low:.6e}"
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws(jet: impl Fn(f64) -> Vec<f64> + 'static) -> Laws {
        let known = BTreeMap::from([("lift".to_string(), Rc::new(jet) as Jet)]);
        Laws { known, ..Laws::default() }
    }

    #[test]
    fn a_called_function_has_the_derivatives_of_the_same_in_the_language() {
        let sine = laws(|x| vec![x.sin(), x.cos(), -x.sin(), -x.cos()]);
        let mut x = Number::still(0.4);
        (x.value.a, x.value.b, x.value.c) = (0.7, -0.3, 0.2);
        (x.rate.v, x.rate.a, x.rate.b) = (-0.3, 0.5, 0.9);
        for (order, name) in [(0, "sin"), (1, "cos")] {
            let found = sine.call("lift", None, order, x).expect("a value");
            let expected = x.function(name).expect("a function");
            let parts =
                |n: Number| [n.value.v, n.value.a, n.value.b, n.value.c, n.rate.v, n.rate.a, n.rate.b];
            for (a, b) in parts(found).into_iter().zip(parts(expected)) {
                assert!((a - b).abs() < 1e-15, "{name}: {found:?} {expected:?}");
            }
        }
        assert_eq!(sine.fault(), None);
        assert!(sine.call("lift", None, 4, x).is_err() && sine.call("drop", None, 0, x).is_err());
    }

    #[test]
    fn a_derivative_beside_the_values_is_a_fault_and_a_kink_is_none() {
        let fault = |jet: fn(f64) -> Vec<f64>, x: f64| {
            let laws = laws(jet);
            laws.call("lift", None, 0, Number::still(x)).expect("a value");
            laws.fault()
        };
        for x in [0.0, 1e-9, 0.3, 1.0, 2.0, 700.0] {
            assert_eq!(fault(|x| vec![0.02 * x.sin(), 0.02 * x.cos(), -0.02 * x.sin()], x), None, "{x}");
            // Slopes of both sides of a kink are right, whichever is told.
            assert_eq!(fault(|x| vec![(x - 1.0).abs(), if x < 1.0 { -1.0 } else { 1.0 }], x), None, "{x}");
        }
        let first = fault(|x| vec![x.sin(), 1.0001 * x.cos(), -x.sin()], 0.3).expect("a fault");
        assert!(first.contains("derivative 1"), "{first}");
        let second = fault(|x| vec![x.sin(), x.cos(), x.sin()], 0.3).expect("a fault");
        assert!(second.contains("derivative 2"), "{second}");
        let degrees = fault(|x| vec![x.to_radians().sin(), x.to_radians().cos()], 20.0);
        assert!(degrees.is_some());
    }
}

//! Functions of the language on values.

use super::evaluation::{Gap, Value};
use super::number::Number;

fn wrong(function: &str) -> Gap {
    Gap(format!("`{function}` of these arguments"))
}

/// Σ aᵢ bᵢ.
pub fn dot(a: &[Number], b: &[Number]) -> Number {
    a.iter().zip(b).fold(Number::still(0.0), |sum, (a, b)| sum + *a * *b)
}

/// a × b in space.
pub fn cross(a: [Number; 3], b: [Number; 3]) -> [Number; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn three(value: &[Number]) -> Option<[Number; 3]> {
    value.try_into().ok()
}

/// The value of a function of the language.
pub fn call(function: &str, arguments: Vec<Value>) -> Result<Value, Gap> {
    let wrong = || wrong(function);
    let scalars = || arguments.iter().map(Value::number).collect::<Result<Vec<Number>, Gap>>();
    let folded = |join: fn(Number, Number) -> Number| -> Result<Value, Gap> {
        let all = scalars()?;
        Ok(Value::scalar(all.into_iter().reduce(join).ok_or_else(wrong)?))
    };
    match (function, arguments.as_slice()) {
        ("atan2", [y, x]) => Ok(Value::scalar(y.number()?.atan2(x.number()?))),
        ("min", _) => folded(|a, b| if a.value.v < b.value.v { a } else { b }),
        ("max", _) => folded(|a, b| if a.value.v < b.value.v { b } else { a }),
        ("hypot", _) => folded(Number::hypot),
        ("dot", [a, b]) => Ok(Value::scalar(dot(&a.items, &b.items))),
        ("cross", [a, b]) => match (a.items.as_slice(), b.items.as_slice()) {
            ([ax, ay], [bx, by]) => Ok(Value::scalar(*ax * *by - *ay * *bx)),
            (a, b) => {
                let (a, b) = three(a).zip(three(b)).ok_or_else(wrong)?;
                Ok(Value::vector(cross(a, b).to_vec()))
            }
        },
        ("norm", [a]) => {
            let joined = a.items.iter().copied().reduce(Number::hypot).ok_or_else(wrong)?;
            let norm = if a.items.len() == 1 { joined.function("abs").ok_or_else(wrong)? } else { joined };
            Ok(Value::scalar(norm))
        }
        ("det", all) => {
            let items: Vec<Number> = all.iter().flat_map(|value| value.items.clone()).collect();
            match items.as_slice() {
                [a, b, c, d] => Ok(Value::scalar(*a * *d - *b * *c)),
                [a @ .., d, e, f, g, h, i] => {
                    let a = three(a).ok_or_else(wrong)?;
                    Ok(Value::scalar(dot(&a, &cross([*d, *e, *f], [*g, *h, *i]))))
                }
                _ => Err(wrong()),
            }
        }
        ("unit" | "rot", [angle]) => {
            let angle = angle.number()?;
            let [cos, sin] =
                [angle.function("cos"), angle.function("sin")].map(|part| part.ok_or_else(wrong));
            let (cos, sin) = (cos?, sin?);
            Ok(match function {
                "unit" => Value::vector(vec![cos, sin]),
                _ => Value { shape: vec![2, 2], items: vec![cos, -sin, sin, cos] },
            })
        }
        ("rotate", [e, v]) => {
            let v = three(&v.items).ok_or_else(wrong)?;
            Ok(Value::vector(rotated(&e.items, v).ok_or_else(wrong)?.to_vec()))
        }
        ("angular_velocity", [e]) => {
            Ok(Value::vector(angular_velocity(&e.items, 1.0).ok_or_else(wrong)?.to_vec()))
        }
        ("der", [a]) => {
            Ok(Value { shape: a.shape.clone(), items: a.items.iter().map(|a| a.der()).collect() })
        }
        (_, [a]) => {
            let found = a.number()?.function(function);
            Ok(Value::scalar(found.ok_or_else(|| Gap(format!("the function `{function}`")))?))
        }
        _ => Err(Gap(format!("the function `{function}`"))),
    }
}

/// v turned by the Euler parameters e: v + 2 ε × (ε × v + e₀ v).
fn rotated(e: &[Number], v: [Number; 3]) -> Option<[Number; 3]> {
    let [e0, axis @ ..] = <[Number; 4]>::try_from(e).ok()?;
    let inner = cross(axis, v);
    let inner = [0, 1, 2].map(|k| inner[k] + e0 * v[k]);
    let turn = cross(axis, inner);
    Some([0, 1, 2].map(|k| v[k] + Number::still(2.0) * turn[k]))
}

/// 2 (e₀ ε̇ − ė₀ ε ± ε × ε̇): in the axes of the ground with `side` 1, of the body with −1.
pub fn angular_velocity(e: &[Number], side: f64) -> Option<[Number; 3]> {
    let [e0, axis @ ..] = <[Number; 4]>::try_from(e).ok()?;
    let [d0, rate @ ..] = [e0, axis[0], axis[1], axis[2]].map(Number::der);
    let turn = cross(axis, rate);
    let two = Number::still(2.0);
    Some([0, 1, 2].map(|k| two * (e0 * rate[k] - d0 * axis[k] + Number::still(side) * turn[k])))
}

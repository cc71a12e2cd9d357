//! Text of a B-spline law: `degree 5; knots 0deg 80deg 160deg; at 0deg: s = 0, v = 0; at 80deg: s = 11mm`.

use core::f64::consts::TAU;

use super::{BSpline, Constraint};
use crate::cams::CamError;
use crate::tables::Unit;

/// Names of the lift and its derivatives.
const NAMES: [&str; 4] = ["s", "v", "a", "j"];

/// An example for faults.
const EXAMPLE: &str = "degree 5; knots 0deg 80deg 160deg; at 0deg: s = 0, v = 0, a = 0; at 80deg: s = 11mm, v = 0; at 160deg: s = 0, v = 0, a = 0";

fn fault<T>(line: &str, why: &str) -> Result<T, CamError> {
    Err(CamError::Value("B-spline", format!("`{line}`: {why}\nhelp: write it as `{EXAMPLE}`")))
}

/// A number with its unit in SI; the unit must be `coherent`. Zero needs none.
fn quantity(text: &str, coherent: &str) -> Result<f64, String> {
    let text = text.trim();
    // An exponent belongs to the number: 1e-3mm.
    let digit = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.');
    let end = text
        .char_indices()
        .find(|(k, c)| {
            let next = text[k + c.len_utf8()..].chars().next();
            !(digit(*c) || (matches!(c, 'e' | 'E') && next.is_some_and(digit)))
        })
        .map_or(text.len(), |(k, _)| k);
    let (number, unit) = text.split_at(end);
    let number: f64 = number.parse().map_err(|_| format!("`{text}` is no number"))?;
    if !number.is_finite() {
        return Err(format!("`{text}` is not finite"));
    }
    if unit.trim().is_empty() {
        return if number == 0.0 { Ok(0.0) } else { Err(format!("`{text}` needs a unit like `{coherent}`")) };
    }
    let unit = Unit::parse(unit)?;
    let is_rate = coherent == "1" || coherent.starts_with("rad/");
    // An angle over an angle may be written as a number: 1/rad for rad/rad^2.
    let fits =
        unit.coherent == coherent || (is_rate && unit.coherent == coherent.replacen("rad/rad", "1", 1));
    if fits { Ok(number * unit.factor) } else { Err(format!("`{text}` is not in `{coherent}`")) }
}

/// Reads a law; statements end with a line or a semicolon, `#` begins a comment. `by_angle`: the lift is an angle.
///
/// # Errors
/// [`CamError::Value`] with the statement, and as [`BSpline::new`].
pub fn parse(text: &str, by_angle: bool) -> Result<BSpline, CamError> {
    let lift = if by_angle { "rad" } else { "m" };
    let units = [lift.to_string(), format!("{lift}/rad"), format!("{lift}/rad^2"), format!("{lift}/rad^3")];
    let (mut degree, mut knots, mut constraints, mut is_periodic) = (None, Vec::new(), Vec::new(), false);
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or(""));
    for line in lines.flat_map(|line| line.split(';')).map(str::trim).filter(|line| !line.is_empty()) {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match word {
            "degree" => match rest.trim().parse::<usize>() {
                Ok(read) if degree.is_none() => degree = Some(read),
                Ok(_) => return fault(line, "the degree is said twice"),
                Err(_) => return fault(line, "the degree is no whole number"),
            },
            "knots" => {
                for one in rest.split([' ', '\t', ',']).filter(|one| !one.is_empty()) {
                    knots.push(quantity(one, "rad").or_else(|why| fault(line, &why))?);
                }
            }
            "periodic" if rest.is_empty() => is_periodic = true,
            "at" => {
                let Some((angle, list)) = rest.split_once(':') else {
                    return fault(line, "a colon stands after the angle");
                };
                let angle = quantity(angle, "rad").or_else(|why| fault(line, &why))?;
                for one in list.split(',') {
                    let Some((name, value)) = one.split_once('=') else {
                        return fault(line, "a constraint is written as `s = 11mm`");
                    };
                    let Some(order) = NAMES.iter().position(|known| *known == name.trim()) else {
                        return fault(line, "the lift is `s`, its derivatives are `v`, `a` and `j`");
                    };
                    let value = quantity(value, &units[order]).or_else(|why| fault(line, &why))?;
                    constraints.push(Constraint { angle, order, value });
                }
            }
            _ => return fault(line, "statements are `degree`, `knots`, `at` and `periodic`"),
        }
    }
    let Some(degree) = degree else { return fault(text.trim(), "the degree is missing") };
    // A turn in degrees and its double in radians are one.
    if let [first, .., last] = knots.as_mut_slice()
        && (*last - *first - TAU).abs() < 1e-9
    {
        let end = *first + TAU;
        constraints.iter_mut().filter(|one| one.angle == *last).for_each(|one| one.angle = end);
        *last = end;
    }
    BSpline::new(degree, &knots, &constraints, is_periodic)
}

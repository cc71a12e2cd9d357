//! `NAME=VALUE` of the command line: a number in the unit of the text, or with a unit of its own.

use crate::mismatch::listed;
use mbs_codegen::{Quantity, quantity};

use super::{CommandError, summary};

/// A name with a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    pub name: String,
    quantity: Quantity,
    /// The number as it was written.
    written: String,
}

impl Assignment {
    /// The number in the unit that the text declares.
    pub fn in_unit(&self, unit: &str) -> Result<f64, CommandError> {
        let Assignment { name, quantity, written } = self;
        if quantity.fits(unit) {
            return Ok(quantity.value);
        }
        let found = quantity.unit.as_deref().unwrap_or("1");
        let declared =
            if unit == "1" { "a number without a unit".to_string() } else { format!("in `{unit}`") };
        Err(CommandError::Usage(format!("`{name}` is {declared}, `{written}` is in `{found}`")))
    }

    /// The same on the command line.
    pub fn written(&self) -> String {
        let Assignment { name, written, .. } = self;
        match written.contains([' ', '*', '(', '[']) {
            true => format!("'{name}={written}'"),
            false => format!("{name}={written}"),
        }
    }
}

/// Reads `omega=20`, `L1=200mm`, `A=4 [m^2]`, `k[0]=2`.
pub fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) = text.split_once('=').ok_or("write it as NAME=VALUE, for example omega=20")?;
    let (name, written) = (name.trim(), value.trim());
    if name.is_empty() {
        return Err("a name is needed before the `=`".to_string());
    }
    // Words that a number may be elsewhere.
    if written.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
        return Err(format!("`{written}` is not a finite number"));
    }
    let quantity = quantity(written)
        .map_err(|(message, help)| format!("`{written}` is not a number: {message}; {help}"))?;
    Ok(Assignment { name: listed(name), quantity, written: written.to_string() })
}

/// The number as messages quote it: `0.2 m`.
pub fn with_unit(value: f64, unit: &str) -> String {
    format!("{}{}", summary::significant(value, 6), summary::unit(unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, unit: &str) -> Result<f64, String> {
        assignment(text)?.in_unit(unit).map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_take_the_unit_of_the_text_or_bring_their_own() {
        for (text, unit, expected) in [
            ("omega=2e1", "rad/s", 20.0),
            ("omega=60rpm", "rad/s", core::f64::consts::TAU),
            ("L1=200mm", "m", 0.2),
            (" L1 = 0.2 ", "m", 0.2),
            ("A=4 [m^2]", "m^2", 4.0),
            ("phi=-90deg", "rad", -core::f64::consts::FRAC_PI_2),
            ("phi=-90deg", "1", -core::f64::consts::FRAC_PI_2),
            ("k=1 [N/mm]", "N/m", 1000.0),
            ("x=-0", "m", 0.0),
        ] {
            let found = value(text, unit).expect(text);
            assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{text}: {found}");
        }
    }

    #[test]
    fn components_are_named_as_in_lists_or_in_texts() {
        for text in ["B.1.0=2", "B[1][0]=2", "B[1, 0]=2", "B[1,0]=2", "B[1].0=2"] {
            assert_eq!(assignment(text).expect(text).name, "B.1.0", "{text}");
        }
    }

    #[test]
    fn a_unit_of_another_kind_is_refused_with_both() {
        assert_eq!(value("L1=60rpm", "m").expect_err("a speed"), "`L1` is in `m`, `60rpm` is in `1/s`");
        let ratio = value("ratio=2mm", "1").expect_err("a length");
        assert_eq!(ratio, "`ratio` is a number without a unit, `2mm` is in `m`");
    }

    #[test]
    fn values_that_are_no_numbers_are_refused_with_a_cure() {
        for (text, cure) in [
            ("omega", "NAME=VALUE"),
            ("=2", "a name is needed"),
            ("omega=", "write a number"),
            ("omega=nan", "finite"),
            ("omega=inf", "finite"),
            ("omega=1e999", "finite"),
            ("omega=two", "`two` is not a number"),
            ("L1=200 mm", "200mm"),
            ("A=4m^2", "4 [m^2]"),
            ("L=2in", "2inch"),
        ] {
            let found = assignment(text).expect_err(text);
            assert!(found.contains(cure), "{text}: {found}");
        }
    }
}

//! A number with its unit outside of a text: one of a command line.

use proc_macro2::TokenStream;

use super::elaborator::Elaborator;
use super::expression::Expressions;
use super::initialiser::numbers;
use super::names::Names;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Reach};
use crate::diagnostics::Diagnostics;
use crate::syntax;

/// A number in coherent SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its value (coherent SI).
    pub value: f64,
    /// Its unit; `None` for a number without one, which takes on that of the place where it stands.
    pub unit: Option<String>,
    dimension: Dimension,
}

impl Quantity {
    /// `true` if a value that is declared in `unit` may be this number.
    pub fn fits(&self, unit: &str) -> bool {
        self.unit.is_none() || dimension(unit) == Some(self.dimension)
    }
}

/// Dimension of a unit as written.
fn dimension(unit: &str) -> Option<Dimension> {
    let mut diagnostics = Diagnostics::default();
    let unit = syntax::unit_of(unit.parse().ok()?, &mut diagnostics)?;
    Dimension::of(&unit, &mut diagnostics)
}

/// A number with its unit as the language writes it: `200mm`, `60rpm`, `4 [m^2]`, `-2*PI`.
///
/// # Errors
/// Message and cure.
pub fn quantity(text: &str) -> Result<Quantity, (String, String)> {
    let no_number = || {
        let help = "write a number with its unit: `0.2`, `200mm`, `60rpm`, `4 [m^2]`";
        (format!("`{text}` is no number"), help.to_owned())
    };
    let mut diagnostics = Diagnostics::default();
    let tokens = text.parse::<TokenStream>().map_err(|_| no_number())?;
    let read = syntax::expression_of(tokens, &mut diagnostics);
    let value = read.map_or(Err(Fault), |expression| {
        let mut work = Elaborator {
            expressions: &mut Expressions::default(),
            names: &mut Names::default(),
            diagnostics: &mut diagnostics,
            reach: Reach::Position,
            needs: Reach::Position,
            groups: &[],
        };
        let value = work.value(&expression)?;
        let scalar = work.scalar(&value, "a value", value.span)?;
        let numbers = numbers(&mut work, &expression, &value, "a value")?;
        Ok((numbers.first().copied().ok_or(Fault)?, scalar))
    });
    match (value, diagnostics.first()) {
        (_, Some(fault)) => Err((fault.message, fault.help)),
        (Err(Fault), None) => Err(no_number()),
        (Ok((value, scalar)), None) => {
            let dimension = scalar.quantity.dimension();
            let unit = match scalar.bare {
                Bare::Zero | Bare::Wholly => None,
                Bare::Angle if dimension == Dimension::NUMBER => Some("rad".to_owned()),
                _ => Some(dimension.to_string()),
            };
            Ok(Quantity { value, unit, dimension })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_units_of_the_language() {
        for (text, value, unit) in [
            ("200mm", 0.2, Some("m")),
            ("60 [deg/s]", core::f64::consts::PI / 3.0, Some("1/s")),
            ("-90deg", -core::f64::consts::FRAC_PI_2, Some("rad")),
            ("4 [m^2]", 4.0, Some("m^2")),
            ("1e3", 1000.0, None),
            ("-2*PI", -core::f64::consts::TAU, None),
            ("0", 0.0, None),
        ] {
            let found = quantity(text).expect(text);
            assert!((found.value - value).abs() < 1e-15, "{text}");
            assert_eq!(found.unit.as_deref(), unit, "{text}");
        }
        assert!(quantity("60rpm").expect("a speed").fits("rad/s"));
        assert!(quantity("3").expect("a number").fits("N/m"));
        assert!(!quantity("3mm").expect("a length").fits("kg"));
    }

    #[test]
    fn text_that_is_no_number_is_told_with_its_cure() {
        for (text, cure) in [
            ("200 mm", "write `200mm`"),
            ("4m^2", "`4 [m^2]`"),
            ("2in", "did you mean `2inch`?"),
            ("", "write a number"),
            ("two", "declare it"),
            ("2;3", ""),
            ("[1, 2]", ""),
            ("1/0", "division by zero"),
            ("(", "write a number"),
        ] {
            let (message, help) = quantity(text).expect_err(text);
            assert!(help.contains(cure), "{text}: {message}, {help}");
        }
    }
}

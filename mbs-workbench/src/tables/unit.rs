//! Units of columns: those that may follow a number in a mechanism's text, and products of them.

/// A column's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As written: `mm/deg`.
    pub name: String,
    /// In SI: `m/rad`.
    pub coherent: String,
    /// A value in SI over the number in the column.
    pub factor: f64,
}

impl Unit {
    /// `deg`, `mm`, `rpm`, `N*m`, `m/s^2`, `1`.
    ///
    /// # Errors
    /// A message with the fault in `text`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let name: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let (mut coherent, mut factor) = (String::new(), 1.0);
        let mut rest = name.as_str();
        let mut sign = 1;
        loop {
            let end = rest.find(['*', '/']).unwrap_or(rest.len());
            let (part, behind) = rest.split_at(end);
            let (symbol, power) = part.split_once('^').unwrap_or((part, "1"));
            let exponent: i32 = power.parse().map_err(|_| format!("`{power}` is no whole exponent"))?;
            let (scale, base) = symbol_scale(symbol)?;
            factor *= f64::powi(scale, sign * exponent);
            let base =
                if base.contains('/') && (sign < 0 || exponent != 1) { format!("({base})") } else { base };
            coherent += &if exponent == 1 { base } else { format!("{base}^{exponent}") };
            let Some(operator) = behind.chars().next() else { break };
            sign = if operator == '/' { -1 } else { 1 };
            coherent.push(operator);
            rest = &behind[1..];
        }
        Ok(Unit { name, coherent, factor })
    }

    /// A turn in SI, where the unit is one of angles.
    pub fn turn(&self) -> Option<f64> {
        (self.coherent == "rad").then_some(core::f64::consts::TAU)
    }

    /// Unit of the derivative of order `order` with respect to a quantity in `of`, in SI.
    pub fn derivative(&self, of: &Unit, order: usize) -> String {
        let power = if order == 1 { String::new() } else { format!("^{order}") };
        let bracketed = |name: &str| {
            if name.contains(['*', '/']) { format!("({name})") } else { name.to_string() }
        };
        if order == 0 {
            self.coherent.clone()
        } else {
            format!("{}/{}{power}", self.coherent, bracketed(&of.coherent))
        }
    }
}

fn symbol_scale(symbol: &str) -> Result<(f64, String), String> {
    if symbol == "1" {
        return Ok((1.0, "1".to_string()));
    }
    mbs_codegen::unit_of_suffix(symbol)
        .map(|(factor, coherent)| (factor, coherent.to_string()))
        .map_err(|(message, help)| format!("{message}; {help}"))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    #[test]
    fn units_are_those_of_the_language_and_their_products() {
        let known = [
            ("deg", "rad", PI / 180.0),
            ("mm", "m", 1e-3),
            ("rpm", "rad/s", PI / 30.0),
            ("N*mm", "N*m", 1e-3),
            ("mm / s^2", "m/s^2", 1e-3),
            ("mm^2", "m^2", 1e-6),
            ("1/ms", "1/s", 1e3),
            ("s/turn", "s/rad", 1.0 / (2.0 * PI)),
            ("1", "1", 1.0),
        ];
        for (text, coherent, factor) in known {
            let unit = Unit::parse(text).expect(text);
            assert_eq!(unit.coherent, coherent);
            assert!((unit.factor / factor - 1.0).abs() < 1e-15, "{text}: {}", unit.factor);
        }
        let unknown = Unit::parse("degs").expect_err("no unit");
        assert!(unknown.contains("`degs`") && unknown.contains("deg"), "{unknown}");
        assert!(Unit::parse("mm^x").is_err() && Unit::parse("").is_err() && Unit::parse("mm/").is_err());
    }

    #[test]
    fn derivatives_have_the_units_of_quotients() {
        let [lift, angle, speed] = ["mm", "deg", "rpm"].map(|text| Unit::parse(text).expect("a unit"));
        assert_eq!([0, 1, 2].map(|order| lift.derivative(&angle, order)), ["m", "m/rad", "m/rad^2"]);
        assert_eq!(lift.derivative(&speed, 1), "m/(rad/s)");
    }
}

//! Units: dimensions of declared units and of number suffixes.

use std::fmt;

use proc_macro2::Span;

use crate::diagnostics::{Diagnostics, nearest};
use crate::syntax::NUMBER_TYPES;
use crate::syntax::ast;
use crate::syntax::unit_symbols::{SUFFIXES, SYMBOLS, in_si, is_symbol, meant, of_quantity};

/// Exponents of the base units, in sixtieths, so that roots up to the sixth are exact.
///
/// Angles are pure numbers; a cycle is kept apart, so that `Hz` is no `rad/s`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension([i16; 8]);

const BASE: [&str; 8] = ["m", "kg", "s", "A", "K", "mol", "cd", "cycle"];
const WHOLE: i16 = 60;
const HALF: i16 = WHOLE / 2;
const CYCLE: usize = 7;

impl Dimension {
    /// Dimension of pure numbers and angles.
    pub const NUMBER: Self = Dimension([0; 8]);
    /// Dimension of lengths.
    pub const METRE: Self = Dimension([WHOLE, 0, 0, 0, 0, 0, 0, 0]);
    /// Dimension of times.
    pub const SECOND: Self = Dimension([0, 0, WHOLE, 0, 0, 0, 0, 0]);

    /// Dimension of masses.
    pub const KILOGRAM: Self = Dimension([0, WHOLE, 0, 0, 0, 0, 0, 0]);
    /// Dimension of forces.
    pub const NEWTON: Self = Dimension([WHOLE, WHOLE, -2 * WHOLE, 0, 0, 0, 0, 0]);
    /// Dimension of energies and torques.
    pub const JOULE: Self = Dimension([2 * WHOLE, WHOLE, -2 * WHOLE, 0, 0, 0, 0, 0]);
    /// Dimension of moments of inertia.
    pub const INERTIA: Self = Dimension([2 * WHOLE, WHOLE, 0, 0, 0, 0, 0, 0]);

    /// Dimension of a product.
    pub fn times(self, other: Self) -> Self {
        self.combine(other, 1)
    }

    /// Dimension of a quotient.
    pub fn over(self, other: Self) -> Self {
        self.combine(other, -1)
    }

    fn combine(self, other: Self, sign: i16) -> Self {
        let mut sum = self.0;
        for (exponent, more) in sum.iter_mut().zip(other.0) {
            // The least number has no opposite.
            *exponent = exponent.saturating_add(more.saturating_mul(sign)).max(-i16::MAX);
        }
        Dimension(sum)
    }

    /// Dimension of a power; `None` where an exponent is no sixtieth.
    pub fn power(self, exponent: f64) -> Option<Self> {
        let mut product = self.0;
        for power in &mut product {
            let exact = f64::from(*power) * exponent;
            if (exact - exact.round()).abs() > 1e-9 || exact.abs() > f64::from(i16::MAX) {
                return None;
            }
            *power = exact.round() as i16;
        }
        Some(Dimension(product))
    }

    /// Dimension with a cycle turned into 2π radians.
    pub fn without_cycles(self) -> Self {
        let mut exponents = self.0;
        exponents[CYCLE] = 0;
        Dimension(exponents)
    }

    /// Exponent of the metre, where it is the only base unit that counts for a reference length.
    pub fn metres(self) -> f64 {
        f64::from(self.0[0]) / f64::from(WHOLE)
    }

    /// `true` for metres, square metres and so on.
    pub fn is_power_of_length(self) -> bool {
        let metres = self.metres();
        metres > 0.0 && Self::METRE.power(metres) == Some(self)
    }

    /// Side (m) of a positive `size` of this power of a length: of an area its root.
    pub fn side(self, size: f64) -> f64 {
        match self.metres() {
            1.0 => size,
            2.0 => size.sqrt(),
            3.0 => size.cbrt(),
            metres => size.powf(1.0 / metres),
        }
    }

    fn of_symbol(symbol: &str) -> Option<Self> {
        SYMBOLS
            .iter()
            .find(|(known, _)| *known == symbol)
            .map(|(_, exponents)| Dimension(exponents.map(|e| e * WHOLE)))
    }

    /// Before: a unit as written. After: its dimension; symbols that are no coherent unit are reported, and the
    /// dimension is then `None`.
    pub fn of(unit: &ast::Unit, diagnostics: &mut Diagnostics) -> Option<Self> {
        let mut dimension = Some(Dimension::NUMBER);
        for (symbol, exponent) in &unit.factors {
            let coherent = Self::of_symbol(&symbol.text);
            if coherent.is_none() {
                let (message, help) =
                    of_a_compound(unit, &symbol.text).unwrap_or_else(|| unknown_unit(&symbol.text));
                diagnostics.report(symbol.span, message, help);
            }
            let base = coherent.or_else(|| with_suffix(1.0, &symbol.text).ok().map(|(_, meant)| meant));
            let power = base.and_then(|base| base.power(*exponent));
            dimension = dimension.zip(power).map(|(product, power)| product.times(power));
        }
        dimension
    }
}

/// Value in coherent SI of one of a symbol's unit, and that SI unit; `Err` holds message and cure.
pub fn coherent(symbol: &str) -> Result<(f64, &'static str), (String, String)> {
    if let Some((known, _)) = SYMBOLS.iter().find(|(known, _)| *known == symbol) {
        return Ok((1.0, known));
    }
    match SUFFIXES.iter().find(|(known, ..)| *known == symbol) {
        Some((_, factor, divisor, unit)) => Ok((factor / divisor, unit)),
        None => Err(unknown_suffix(symbol)),
    }
}

fn unknown_suffix(symbol: &str) -> (String, String) {
    let known =
        || SYMBOLS.iter().map(|(symbol, _)| *symbol).chain(SUFFIXES.iter().map(|(suffix, ..)| *suffix));
    let help = match meant(symbol).or_else(|| nearest(symbol, known()).map(str::to_owned)) {
        _ if in_si(1.0, symbol).is_some() => of_si(symbol),
        Some(known) => format!("did you mean `{known}`?"),
        None => USUAL.into(),
    };
    (format!("`{symbol}` is no known unit"), help)
}

/// A unit outside of the SI in one of the SI.
fn of_si(symbol: &str) -> String {
    format!("units are those of the SI: 1{symbol} is {}", in_si(1.0, symbol).unwrap_or_default())
}

/// Units that are met most.
const USUAL: &str =
    "usual are m, mm, kg, s, rad, deg, rpm, N, N*m, J, W, Pa; numbers without a unit have `1`";

/// Message and cure at a symbol with a prefix in a compound unit: `N/m` for `kN/m`.
fn of_a_compound(unit: &ast::Unit, symbol: &str) -> Option<(String, String)> {
    let (_, _, _, coherent) = SUFFIXES.iter().find(|(suffix, ..)| *suffix == symbol)?;
    let rest = unit.text.strip_prefix(symbol).filter(|rest| rest.starts_with(['*', '/', '^']))?;
    Some((
        format!("`{symbol}` is no coherent SI unit"),
        format!(
            "declare `{coherent}{rest}` and write the unit in brackets behind the number: `100 [{}]`",
            unit.text
        ),
    ))
}

fn unknown_unit(symbol: &str) -> (String, String) {
    if let Some((_, _, _, coherent)) = SUFFIXES.iter().find(|(suffix, ..)| *suffix == symbol) {
        return (
            format!("`{symbol}` is no coherent SI unit"),
            format!("declare `{coherent}` and write the unit behind the number: `100{symbol}`"),
        );
    }
    if NUMBER_TYPES.contains(&symbol) {
        return (
            format!("`{symbol}` is a type of numbers, no unit"),
            "write the unit, such as `m` or `rad/s`; `1` where there is none".into(),
        );
    }
    if let Some(unit) = of_quantity(symbol) {
        return (format!("`{symbol}` is a quantity, no unit"), format!("write its unit: `{unit}`"));
    }
    let near = || nearest(symbol, SYMBOLS.iter().map(|(known, _)| *known)).map(str::to_owned);
    let help = match meant(symbol).or_else(near) {
        _ if in_si(1.0, symbol).is_some() => of_si(symbol),
        Some(known) => match SUFFIXES.iter().find(|(suffix, ..)| *suffix == known) {
            Some((.., coherent)) => {
                format!("declare `{coherent}`, the SI unit, and write `{known}` behind numbers: `100{known}`")
            }
            None => format!("did you mean `{known}`?"),
        },
        None => USUAL.into(),
    };
    (format!("`{symbol}` is no known unit"), help)
}

/// Value in SI and dimension of a number in a unit of any known symbols; `Err` holds place, message and cure.
///
/// Factors and divisors are multiplied apart, so that `1 [km/h]` is rounded once.
pub fn in_unit(value: f64, unit: &ast::Unit) -> Result<(f64, Dimension), (Span, String, String)> {
    if let [(symbol, 1.0)] = unit.factors.as_slice() {
        return with_suffix(value, &symbol.text).map_err(|(message, help)| (symbol.span, message, help));
    }
    let (mut factor, mut divisor, mut dimension) = (1.0, 1.0, Dimension::NUMBER);
    for (symbol, exponent) in &unit.factors {
        let Ok((_, base)) = with_suffix(1.0, &symbol.text) else {
            let (message, help) = unknown_suffix(&symbol.text);
            return Err((symbol.span, message, help));
        };
        let known = SUFFIXES.iter().find(|(known, ..)| *known == symbol.text);
        let (times, over) = known.map_or((1.0, 1.0), |(_, times, over, _)| (*times, *over));
        let (times, over) = if *exponent < 0.0 { (over, times) } else { (times, over) };
        factor *= raised_to(times, exponent.abs());
        divisor *= raised_to(over, exponent.abs());
        let raised = base.power(*exponent).ok_or_else(|| {
            (
                symbol.span,
                format!("`{}` has an exponent that is too large", unit.text),
                "write smaller exponents".into(),
            )
        })?;
        dimension = dimension.times(raised);
    }
    Ok((value * factor / divisor, dimension))
}

/// A power, by multiplication where the exponent is an integer.
fn raised_to(base: f64, exponent: f64) -> f64 {
    let whole = exponent.trunc();
    let root = if whole == exponent { 1.0 } else { base.sqrt() };
    // At most 12 times the 12 of as many parentheses: exact in an `i32`.
    f64::powi(base, whole as i32) * root
}

/// Value and dimension of a number with a suffix; `Err` holds message and cure.
pub fn with_suffix(value: f64, suffix: &str) -> Result<(f64, Dimension), (String, String)> {
    if let Some(dimension) = Dimension::of_symbol(suffix) {
        return Ok((value, dimension));
    }
    match SUFFIXES.iter().find(|(known, ..)| *known == suffix) {
        Some((_, factor, divisor, unit)) => {
            let dimension = match *unit {
                "rad/s" => Dimension::NUMBER.over(Dimension::SECOND),
                "m/s^2" => Dimension::METRE.over(Dimension::SECOND).over(Dimension::SECOND),
                symbol => Dimension::of_symbol(symbol).unwrap_or_default(),
            };
            Ok((value * factor / divisor, dimension))
        }
        None => {
            let known =
                SYMBOLS.iter().map(|(symbol, _)| *symbol).chain(SUFFIXES.iter().map(|(suffix, ..)| *suffix));
            if let Some(number) = in_si(value, suffix) {
                let help = format!("units are those of the SI: write `{number}`");
                return Err((format!("`{suffix}` is no known unit of a number"), help));
            }
            let help = match meant(suffix).or_else(|| nearest(suffix, known).map(str::to_owned)) {
                Some(meant) if is_symbol(&meant) => format!("did you mean `{value}{meant}`?"),
                Some(meant) => format!("did you mean `{value} [{meant}]`?"),
                None => USUAL.into(),
            };
            Err((format!("`{suffix}` is no known unit of a number"), help))
        }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Dimension::NUMBER {
            return f.write_str("1");
        }
        let named = SYMBOLS.iter().find(|(_, exponents)| exponents.map(|e| e * WHOLE) == self.0);
        if let Some((symbol, _)) = named.filter(|(symbol, _)| *symbol != "J") {
            return f.write_str(symbol);
        }
        if *self == Dimension([2 * WHOLE, WHOLE, -2 * WHOLE, 0, 0, 0, 0, 0]) {
            return f.write_str("N*m");
        }
        let factors = |sign: i16| {
            let parts = BASE.iter().zip(self.0).filter(move |(_, e)| e.signum() == sign);
            parts.map(|(base, e)| power(base, e.abs())).collect::<Vec<_>>()
        };
        let (over, under) = (factors(1), factors(-1));
        f.write_str(&if over.is_empty() { "1".into() } else { over.join("*") })?;
        for base in under {
            write!(f, "/{base}")?;
        }
        Ok(())
    }
}

fn power(base: &str, sixtieths: i16) -> String {
    match (sixtieths / WHOLE, sixtieths % WHOLE) {
        (1, 0) => base.into(),
        (whole, 0) => format!("{base}^{whole}"),
        (whole, HALF) => format!("{base}^{whole}.5"),
        _ => {
            let divisor = (1..=WHOLE).rev().find(|d| sixtieths % d == 0 && WHOLE % d == 0).unwrap_or(1);
            format!("{base}^({}/{})", sixtieths / divisor, WHOLE / divisor)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn suffixes_are_rounded_once() {
        assert_eq!(with_suffix(100.0, "mm").expect("known"), (0.1, Dimension::METRE));
        assert_eq!(with_suffix(180.0, "deg").expect("known").0, PI);
        assert_eq!(with_suffix(3000.0, "rpm").expect("known").0, 100.0 * PI);
        assert!(with_suffix(1.0, "mmm").expect_err("unknown").1.contains("`1mm`"));
    }

    #[test]
    fn compound_units_multiply_the_factors_of_their_symbols() {
        let of = |factors: &[(&str, f64)], value: f64| {
            let span = Span::call_site();
            let factors = factors
                .iter()
                .map(|(text, exponent)| (crate::syntax::ast::Name { text: (*text).into(), span }, *exponent))
                .collect();
            in_unit(value, &ast::Unit { factors, text: String::new(), span }).expect("known")
        };
        let area = Dimension::METRE.power(2.0).expect("area");
        assert_eq!(of(&[("mm", 2.0)], 4.0), (4e-6, area));
        assert_eq!(of(&[("km", 1.0), ("h", -1.0)], 36.0), (10.0, Dimension::METRE.over(Dimension::SECOND)));
        assert_eq!(of(&[("N", 1.0), ("mm", -2.0)], 1.0), (1e6, Dimension::NEWTON.over(area)));
        assert_eq!(of(&[("deg", 1.0), ("s", -1.0)], 180.0), (PI, Dimension::NUMBER.over(Dimension::SECOND)));
        assert_eq!(of(&[], 2.0), (2.0, Dimension::NUMBER));
        // 1 N/cm^1.5 is 1000 N/m^1.5.
        let rise = Dimension::NEWTON.over(Dimension::METRE.power(1.5).expect("halves"));
        assert_eq!(of(&[("N", 1.0), ("cm", -1.5)], 1.0), (1e3, rise));
    }

    #[test]
    fn dimensions_print_as_an_engineer_writes_them() {
        let newton = Dimension::of_symbol("N").expect("known");
        assert_eq!(newton.to_string(), "N");
        assert_eq!(newton.times(Dimension::METRE).to_string(), "N*m");
        assert_eq!(Dimension::METRE.over(Dimension::SECOND).to_string(), "m/s");
        assert_eq!(Dimension::METRE.power(0.5).expect("half").to_string(), "m^0.5");
        assert_eq!(Dimension::METRE.power(1.0 / 3.0).expect("third").to_string(), "m^(1/3)");
        assert_eq!(Dimension::NUMBER.over(Dimension::SECOND).to_string(), "1/s");
        assert_eq!(Dimension::METRE.power(1.0 / 7.0), None);
    }
}

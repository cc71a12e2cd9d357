//! Symbols of units: coherent SI, and the suffixes of numbers.

use std::f64::consts::{PI, TAU};

/// Symbols of coherent SI units with their exponents of m, kg, s, A, K, mol, cd, cycle.
pub const SYMBOLS: [(&str, [i16; 8]); 23] = [
    ("m", [1, 0, 0, 0, 0, 0, 0, 0]),
    ("kg", [0, 1, 0, 0, 0, 0, 0, 0]),
    ("s", [0, 0, 1, 0, 0, 0, 0, 0]),
    ("A", [0, 0, 0, 1, 0, 0, 0, 0]),
    ("K", [0, 0, 0, 0, 1, 0, 0, 0]),
    ("mol", [0, 0, 0, 0, 0, 1, 0, 0]),
    ("cd", [0, 0, 0, 0, 0, 0, 1, 0]),
    ("rad", [0; 8]),
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("J", [2, 1, -2, 0, 0, 0, 0, 0]),
    ("W", [2, 1, -3, 0, 0, 0, 0, 0]),
    ("Pa", [-1, 1, -2, 0, 0, 0, 0, 0]),
    ("Hz", [0, 0, -1, 0, 0, 0, 0, 1]),
    ("V", [2, 1, -3, -1, 0, 0, 0, 0]),
    ("C", [0, 0, 1, 1, 0, 0, 0, 0]),
    ("F", [-2, -1, 4, 2, 0, 0, 0, 0]),
    ("ohm", [2, 1, -3, -2, 0, 0, 0, 0]),
    ("H", [2, 1, -2, -2, 0, 0, 0, 0]),
    ("T", [0, 1, -2, -1, 0, 0, 0, 0]),
    ("Wb", [2, 1, -2, -1, 0, 0, 0, 0]),
    ("S", [-2, -1, 3, 2, 0, 0, 0, 0]),
    ("sr", [0; 8]),
    ("lm", [0, 0, 0, 0, 0, 0, 1, 0]),
];

/// Suffixes of numbers that are no coherent SI units: value = number · factor / divisor, in the SI unit.
pub const SUFFIXES: [(&str, f64, f64, &str); 31] = [
    ("km", 1e3, 1.0, "m"),
    ("cm", 1.0, 1e2, "m"),
    ("mm", 1.0, 1e3, "m"),
    ("um", 1.0, 1e6, "m"),
    ("nm", 1.0, 1e9, "m"),
    ("inch", 254.0, 1e4, "m"),
    ("gram", 1.0, 1e3, "kg"),
    ("tonne", 1e3, 1.0, "kg"),
    ("ms", 1.0, 1e3, "s"),
    ("us", 1.0, 1e6, "s"),
    ("ns", 1.0, 1e9, "s"),
    ("min", 60.0, 1.0, "s"),
    ("h", 3600.0, 1.0, "s"),
    ("deg", PI, 180.0, "rad"),
    ("mrad", 1.0, 1e3, "rad"),
    ("turn", TAU, 1.0, "rad"),
    ("rpm", PI, 30.0, "rad/s"),
    ("kHz", 1e3, 1.0, "Hz"),
    ("mN", 1.0, 1e3, "N"),
    ("kN", 1e3, 1.0, "N"),
    ("MN", 1e6, 1.0, "N"),
    ("kPa", 1e3, 1.0, "Pa"),
    ("MPa", 1e6, 1.0, "Pa"),
    ("GPa", 1e9, 1.0, "Pa"),
    ("bar", 1e5, 1.0, "Pa"),
    ("mJ", 1.0, 1e3, "J"),
    ("kJ", 1e3, 1.0, "J"),
    ("kW", 1e3, 1.0, "W"),
    ("mA", 1.0, 1e3, "A"),
    ("mV", 1.0, 1e3, "V"),
    // Standard gravity, ISO 80000-3.
    ("g0", 9.80665, 1.0, "m/s^2"),
];

/// `true` where a number may have this unit.
pub fn is_symbol(word: &str) -> bool {
    SYMBOLS.iter().any(|(known, _)| *known == word) || SUFFIXES.iter().any(|(known, ..)| *known == word)
}

/// The coherent SI unit of a symbol.
pub fn coherent_unit(symbol: &str) -> Option<&'static str> {
    let known = SYMBOLS.iter().find(|(known, _)| *known == symbol).map(|(known, _)| *known);
    known.or_else(|| SUFFIXES.iter().find(|(known, ..)| *known == symbol).map(|(.., unit)| *unit))
}

/// `N*m` of `Nm`, `N*m*s` of `Nms`, `kg*m` of `kgm`, `N*m` of `N·m`: the product of symbols written together. A symbol that
/// ends with a capital letter, or the kilogram, is not the beginning of a longer one.
pub fn as_product(word: &str) -> Option<String> {
    let parts: Vec<&str> = word.split(DOTS).collect();
    if parts.len() > 1 {
        return parts.iter().all(|part| is_symbol(part)).then(|| parts.join("*"));
    }
    let splits = word.char_indices().filter(|(_, letter)| letter.is_ascii_uppercase() || *letter == 'g');
    let parts = splits.filter_map(|(index, _)| word.split_at_checked(index + 1));
    let mut parts = parts.filter(|(first, _)| is_symbol(first) && (*first == "kg" || !first.ends_with('g')));
    parts.find_map(|(first, rest)| {
        // Newton metres are the product that is meant: `Nms` is no millisecond.
        let metres = rest.strip_prefix('m').filter(|rest| is_symbol(rest));
        match metres {
            Some(behind)
                if first.ends_with('N')
                    && !SUFFIXES.iter().any(|(known, ..)| *known == rest && behind == "m") =>
            {
                Some(format!("{first}*m*{behind}"))
            }
            _ if is_symbol(rest) => Some(format!("{first}*{rest}")),
            _ => None,
        }
    })
}

/// Dots of products, which are letters to the lexer.
pub const DOTS: [char; 2] = ['·', '•'];

/// Units by other names, and the symbols that are meant.
const OTHER_NAMES: [(&str, &str); 41] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("sek", "s"),
    ("minute", "min"),
    ("minutes", "min"),
    ("hour", "h"),
    ("hours", "h"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("millimeter", "mm"),
    ("millimeters", "mm"),
    ("millimetre", "mm"),
    ("millimetres", "mm"),
    ("centimeter", "cm"),
    ("centimetre", "cm"),
    ("micron", "um"),
    ("µm", "um"),
    ("μm", "um"),
    ("in", "inch"),
    ("inches", "inch"),
    ("kilogram", "kg"),
    ("kilograms", "kg"),
    ("kgs", "kg"),
    ("g", "gram"),
    ("grams", "gram"),
    ("t", "tonne"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("grad", "deg"),
    ("rev", "turn"),
    ("newton", "N"),
    ("newtons", "N"),
    ("joule", "J"),
    ("hertz", "Hz"),
    ("watt", "W"),
];

/// Quantities by name, and their units.
const QUANTITIES: [(&str, &str); 20] = [
    ("length", "m"),
    ("distance", "m"),
    ("angle", "rad"),
    ("time", "s"),
    ("mass", "kg"),
    ("speed", "m/s"),
    ("velocity", "m/s"),
    ("acceleration", "m/s^2"),
    ("angular_velocity", "rad/s"),
    ("angular_speed", "rad/s"),
    ("force", "N"),
    ("torque", "N*m"),
    ("moment", "N*m"),
    ("inertia", "kg*m^2"),
    ("stiffness", "N/m"),
    ("damping", "N*s/m"),
    ("energy", "J"),
    ("power", "W"),
    ("pressure", "Pa"),
    ("number", "1"),
];

/// The unit of a quantity that is named in place of its unit.
pub fn of_quantity(word: &str) -> Option<&'static str> {
    let lower = word.to_lowercase();
    QUANTITIES.iter().find(|(quantity, _)| *quantity == lower).map(|(_, unit)| *unit)
}

/// The symbol that a unit by another name means.
pub fn foreign_name(word: &str) -> Option<&'static str> {
    let lower = word.to_lowercase();
    let named = OTHER_NAMES.iter().find(|(other, _)| *other == word || (word.len() > 2 && *other == lower));
    named.map(|(_, symbol)| *symbol)
}

/// The symbol, power or product that a unit by another name means: `s` of `sec`, `m^2` of `m2`, `N*m` of `Nm`, `kg*m^2` of `kgm2`.
pub fn meant(word: &str) -> Option<String> {
    let power = || {
        let (base, exponent) = word.split_at_checked(word.len().checked_sub(1)?)?;
        let is_power = matches!(exponent, "2" | "3" | "4");
        let base = match is_symbol(base) {
            true => base.to_owned(),
            false => foreign_name(base).map(str::to_owned).or_else(|| as_product(base))?,
        };
        is_power.then(|| format!("{base}^{exponent}"))
    };
    // A thousand is a small letter: `Km` is no kelvin metre.
    let thousand = || {
        let small = format!("k{}", word.strip_prefix('K')?);
        is_symbol(&small).then_some(small)
    };
    let named = foreign_name(word).map(str::to_owned);
    named.or_else(power).or_else(thousand).or_else(|| as_product(word))
}

/// Units outside of the SI: their values, and the units that these are in.
const NO_SI: [(&str, f64, &str); 28] = [
    ("dm", 0.1, "m"),
    ("ft", 0.3048, "m"),
    ("foot", 0.3048, "m"),
    ("feet", 0.3048, "m"),
    ("yd", 0.9144, "m"),
    ("mi", 1609.344, "m"),
    ("mile", 1609.344, "m"),
    ("miles", 1609.344, "m"),
    ("mil", 2.54e-5, "m"),
    ("thou", 2.54e-5, "m"),
    ("lb", 0.453_592_37, "kg"),
    ("lbs", 0.453_592_37, "kg"),
    ("lbm", 0.453_592_37, "kg"),
    ("oz", 0.028_349_523_125, "kg"),
    ("lbf", 4.448_221_615_260_5, "N"),
    ("kgf", 9.806_65, "N"),
    ("kp", 9.806_65, "N"),
    ("dyn", 1e-5, "N"),
    ("psi", 6_894.757_293_168_4, "Pa"),
    ("atm", 101_325.0, "Pa"),
    ("hp", 745.699_871_582_27, "W"),
    ("l", 1e-3, "m^3"),
    ("L", 1e-3, "m^3"),
    ("liter", 1e-3, "m^3"),
    ("litre", 1e-3, "m^3"),
    ("mph", 0.447_04, "m/s"),
    ("kmh", 1.0, "km/h"),
    ("kph", 1.0, "km/h"),
];

/// A number in a unit outside of the SI as one in an SI unit: `0.6096m` of 2 and `ft`.
pub fn in_si(value: f64, word: &str) -> Option<String> {
    let (_, factor, unit) = NO_SI.iter().find(|(other, ..)| *other == word)?;
    // Digits of the product beyond those of the factors are rounding.
    let value = format!("{:.12e}", value * factor).parse::<f64>().ok()?;
    Some(match unit.chars().all(char::is_alphanumeric) {
        true => format!("{value}{unit}"),
        false => format!("{value} [{unit}]"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_written_together_are_taken_apart() {
        assert_eq!(as_product("Nm").as_deref(), Some("N*m"));
        assert_eq!(as_product("kNmm").as_deref(), Some("kN*mm"));
        assert_eq!(as_product("Ns").as_deref(), Some("N*s"));
        assert_eq!(as_product("Nms").as_deref(), Some("N*m*s"));
        assert_eq!(as_product("kgm").as_deref(), Some("kg*m"));
        assert_eq!(as_product("N·m").as_deref(), Some("N*m"));
        for (word, meaning) in
            [("kgm2", "kg*m^2"), ("in2", "inch^2"), ("Km", "km"), ("KN", "kN"), ("m2", "m^2")]
        {
            assert_eq!(meant(word).as_deref(), Some(meaning));
        }
        assert_eq!(in_si(3.0, "ft").as_deref(), Some("0.9144m"));
        assert_eq!(in_si(2.0, "L").as_deref(), Some("0.002 [m^3]"));
        for word in ["N", "mmm", "Nx", "", "Né"] {
            assert_eq!(as_product(word), None, "{word}");
        }
    }
}

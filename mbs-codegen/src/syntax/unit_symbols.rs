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

/// `N*m` of `Nm`, `kW*h` of `kWh`: the product of two symbols, the first of which ends with a capital letter.
pub fn as_product(word: &str) -> Option<String> {
    let splits = word.char_indices().filter(|(_, letter)| letter.is_ascii_uppercase());
    let mut parts = splits.filter_map(|(index, _)| word.split_at_checked(index + 1));
    let (first, second) = parts.find(|(first, second)| is_symbol(first) && is_symbol(second))?;
    Some(format!("{first}*{second}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_written_together_are_taken_apart() {
        assert_eq!(as_product("Nm").as_deref(), Some("N*m"));
        assert_eq!(as_product("kNmm").as_deref(), Some("kN*mm"));
        assert_eq!(as_product("Ns").as_deref(), Some("N*s"));
        for word in ["N", "mmm", "Nx", "", "Né"] {
            assert_eq!(as_product(word), None, "{word}");
        }
    }
}

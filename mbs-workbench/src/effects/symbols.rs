//! Sizes of the functions of the running program, by what their names contain.

/// Bytes of the functions of the running program whose names contain each of the type names; `None` where its format is not known.
///
/// Names are mangled by Rust's scheme v0, which writes the length of an identifier in front of it.
pub fn bytes_of(names: &[&str]) -> Option<Vec<u64>> {
    let program = std::fs::read(std::env::current_exe().ok()?).ok()?;
    let symbols = functions(&program)?;
    Some(names.iter().map(|name| total(&symbols, name)).collect())
}

/// Bytes of the functions whose names contain the identifier `name`.
fn total(symbols: &[(&str, u64)], name: &str) -> u64 {
    let separator = if name.starts_with(|c: char| c.is_ascii_digit() || c == '_') { "_" } else { "" };
    let mangled = format!("{}{separator}{name}", name.len());
    let contains = |symbol: &str| {
        let is_number = |before: Option<char>| before.is_some_and(|c| c.is_ascii_digit());
        symbol.match_indices(&mangled).any(|(at, _)| !is_number(symbol[..at].chars().next_back()))
    };
    symbols.iter().filter(|(symbol, _)| contains(symbol)).map(|(_, size)| size).sum()
}

/// Names and sizes of the functions in a 64-bit little-endian ELF file.
///
/// Source: Tool Interface Standard, Executable and Linking Format 1.2, and its 64-bit extension.
fn functions(file: &[u8]) -> Option<Vec<(&str, u64)>> {
    const SYMBOL_TABLE: u64 = 2;
    const FUNCTION: u64 = 2;
    if file.get(..6)? != [0x7f, b'E', b'L', b'F', 2, 1] {
        return None;
    }
    let number = |at: u64, bytes: usize| -> Option<u64> {
        let at = usize::try_from(at).ok()?;
        let digits = file.get(at..at.checked_add(bytes)?)?;
        Some(digits.iter().rev().fold(0, |value, digit| value << 8 | u64::from(*digit)))
    };
    let (sections, each, count) = (number(0x28, 8)?, number(0x3a, 2)?, number(0x3c, 2)?);
    let section = |index: u64| sections.checked_add(each.checked_mul(index)?);
    let mut found = Vec::new();
    for index in 0..count {
        let at = section(index)?;
        if number(at + 4, 4)? != SYMBOL_TABLE {
            continue;
        }
        let (start, size, link, entry) =
            (number(at + 0x18, 8)?, number(at + 0x20, 8)?, number(at + 0x28, 4)?, number(at + 0x38, 8)?);
        let strings = number(section(link)? + 0x18, 8)?;
        for symbol in 0..size.checked_div(entry)? {
            let at = start.checked_add(symbol.checked_mul(entry)?)?;
            if number(at + 4, 1)? & 0xf == FUNCTION {
                let from = usize::try_from(strings.checked_add(number(at, 4)?)?).ok()?;
                let rest = file.get(from..)?;
                let length = rest.iter().position(|byte| *byte == 0)?;
                let name = core::str::from_utf8(&rest[..length]).ok();
                found.extend(name.map(|name| (name, number(at + 0x10, 8).unwrap_or_default())));
            }
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[inline(never)]
    fn a_function_to_be_found(x: f64) -> f64 {
        core::hint::black_box(x).sin() + 1.0
    }

    #[test]
    fn an_identifier_is_found_as_a_whole() {
        let symbols = [("_RNvC1a4Pump", 10), ("_RNvC1a14Pump_and_other", 100), ("_RNvC1a5Pumps", 1000)];
        assert_eq!(total(&symbols, "Pump"), 10);
        assert_eq!(total(&symbols, "Pumps"), 1000);
    }

    #[test]
    fn functions_of_this_program_have_sizes() {
        assert!(a_function_to_be_found(1.0) > 1.0);
        let program = std::fs::read(std::env::current_exe().expect("a program")).expect("its bytes");
        if program.starts_with(b"\x7fELF") {
            let symbols = functions(&program).expect("its symbols");
            let own = symbols.iter().find(|(name, _)| name.contains("a_function_to_be_found"));
            assert!(own.is_some_and(|(_, size)| *size > 0));
        }
        assert!(functions(b"\x7fELF\x02\x01").is_none() && functions(b"MZ").is_none());
    }
}

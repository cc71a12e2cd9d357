//! The short table that a run prints.

use std::io::{self, Write};
use std::time::Duration;

use crate::erased::facade::{Motion, OutputCurve, spread};
use crate::output::csv::rate_unit;
use mbs_codegen::picture::Shape;

/// Rows of the table, first and last instant included.
const ROWS: usize = 9;

/// Motion of the first traced point at a few instants, and figures.
pub fn write(
    out: &mut dyn Write,
    drawing: &[Shape],
    label: &str,
    motion: &Motion,
    figures: &[[String; 2]],
) -> io::Result<()> {
    writeln!(out, "\n{label}")?;
    let outputs = || motion.outputs.iter().map(|output| output.name);
    let traced = drawing.iter().find_map(|shape| match shape {
        Shape::Trace { of, label } if outputs().any(|name| name == format!("{of}.0")) => Some((of, label)),
        _ => None,
    });
    if let Some((point, name)) = traced {
        write_point(out, point, name, motion)?;
    }
    for [name, value] in figures {
        writeln!(out, "  {name}: {value}")?;
    }
    Ok(())
}

/// Largest contradictions of rows that yield, as pairs of name and value.
pub fn mismatches(motion: &Motion) -> impl Iterator<Item = [String; 2]> {
    motion.mismatches.iter().map(|row| {
        let [position, rate, acceleration] = row.largest();
        let unit = |order: usize| match (row.unit, order) {
            ("1", 1) => "1/s".to_string(),
            ("1", 2) => "1/s^2".to_string(),
            ("1", _) => "1".to_string(),
            (unit, order) => rate_unit(unit, order),
        };
        let value = format!(
            "position {position:.2e} {} of {} allowed, rate {rate:.2e} {}, acceleration {acceleration:.2e} {}",
            unit(0),
            significant(row.width, 3),
            unit(1),
            unit(2)
        );
        [format!("largest mismatch of `{}` (line {})", row.name, row.line), value]
    })
}

/// Cost and accuracy of the solver, as pairs of name and value.
pub fn figures(motion: &Motion, step_time: Duration) -> [[String; 2]; 4] {
    let count = motion.iterations.len().max(1) as f64;
    let mean = motion.iterations.iter().map(|n| f64::from(*n)).sum::<f64>() / count;
    let most = motion.iterations.iter().max().copied().unwrap_or(0);
    let closure = motion.closure.iter().copied().fold(0.0, f64::max);
    let margin = motion.margin.iter().copied().fold(f64::INFINITY, f64::min);
    let pair = |name: &str, value: String| [name.to_string(), value];
    [
        pair("iterations", format!("{mean:.1} a step, at most {most}")),
        pair("largest closure error", format!("{closure:.1e} of the reference length")),
        pair("smallest margin to singularity", format!("{margin:.3}")),
        pair("time a step", format!("{:.2} µs", step_time.as_secs_f64() * 1e6)),
    ]
}

/// A number with six digits and no needless zeros.
pub fn short(value: f64) -> String {
    // No minus in front of a rounded zero.
    let text = format!("{:.6}", if value.abs() < 5e-7 { 0.0 } else { value });
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        trimmed.to_string()
    }
}

/// A number of any size with the given number of digits and no needless zeros.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = rounded.split_once('e').and_then(|(_, power)| power.parse().ok()).unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text.to_string(),
    };
    match (usize::try_from(exponent), rounded.split_once('e')) {
        (Ok(power), _) if power < digits.max(6) => {
            trimmed(&format!("{value:.*}", digits.saturating_sub(power + 1)))
        }
        (Err(_), _) if exponent >= -4 => {
            let behind = digits.saturating_sub(1) + exponent.unsigned_abs() as usize;
            trimmed(&format!("{value:.behind$}"))
        }
        (_, Some((mantissa, power))) => format!("{}e{power}", trimmed(mantissa)),
        (_, None) => rounded,
    }
}

/// A unit after a number; none where it is 1.
pub fn unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

fn write_point(out: &mut dyn Write, point: &str, name: &str, motion: &Motion) -> io::Result<()> {
    let component =
        |suffix: &str| motion.outputs.iter().find(|output| output.name == format!("{point}{suffix}"));
    let components: Vec<&OutputCurve> = [".0", ".1", ".2"].into_iter().map_while(component).collect();
    if motion.time.len() == 1 {
        // A rest has neither time nor rates.
        let place = |curve: &&OutputCurve| format!("{:.6}", signless(curve.value[0], 6));
        let place: Vec<String> = components.iter().map(place).collect();
        return writeln!(out, "  point {point} ({name}): {} m", place.join(", "));
    }
    writeln!(out, "  point {point} ({name}): position (m), velocity (m/s), acceleration (m/s²)")?;
    write!(out, "  {:>9}", "t (s)")?;
    for (mark, width) in [("", 10), ("v", 10), ("a", 11)] {
        write!(out, " ")?;
        for (axis, _) in ["x", "y", "z"].iter().zip(&components) {
            write!(out, " {:>width$}", format!("{mark}{axis}"))?;
        }
    }
    writeln!(out)?;
    for index in spread(motion.time.len(), ROWS) {
        write!(out, "  {:>9.5}", motion.time[index])?;
        let cell = |curve: &Option<Vec<f64>>| curve.as_ref().map_or(f64::NAN, |values| values[index]);
        write!(out, " ")?;
        components.iter().try_for_each(|curve| write!(out, " {:>10.6}", signless(curve.value[index], 6)))?;
        write!(out, " ")?;
        components.iter().try_for_each(|curve| write!(out, " {:>10.5}", signless(cell(&curve.rate), 5)))?;
        write!(out, " ")?;
        components
            .iter()
            .try_for_each(|curve| write!(out, " {:>11.4}", signless(cell(&curve.acceleration), 4)))?;
        writeln!(out)?;
    }
    Ok(())
}

/// Zero without a sign where the number rounds to zero.
pub fn signless(value: f64, digits: usize) -> f64 {
    if value.abs() < 0.5 * 0.1_f64.powi(digits as i32) { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_kept_of_every_size() {
        let found = [2.397_199_4, -0.000_123_456_789, 1.2e-5, 654_321.987, 9.999_999_9, 3e9, 0.0, -20.0];
        let expected = ["2.397199", "-0.0001234568", "1.2e-5", "654322", "10", "3e9", "0", "-20"];
        assert_eq!(found.map(|value| significant(value, 7)), expected);
        assert_eq!((significant(0.1, 3), significant(1234.5, 3)), ("0.1".into(), "1234".into()));
    }

    #[test]
    fn short_numbers_keep_what_matters() {
        assert_eq!(
            [0.2, 20.0, 0.0, core::f64::consts::TAU, 1e-9, -3.0].map(short),
            ["0.2", "20", "0", "6.283185", "1e-9", "-3"]
        );
    }
}

//! The short table that a run prints.

use std::io::{self, Write};
use std::time::Duration;

use mechanisms::drawing::Shape;
use mechanisms::facade::{Motion, OutputCurve, spread};

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
    let traced = drawing.iter().find_map(|shape| match shape {
        Shape::Trace { of, label } => Some((*of, *label)),
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

/// What the solver spent and reached, as pairs of name and value.
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

/// A unit after a number; none where it is 1.
pub fn unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

fn write_point(out: &mut dyn Write, point: &str, name: &str, motion: &Motion) -> io::Result<()> {
    let component =
        |suffix: &str| motion.outputs.iter().find(|output| output.name == format!("{point}{suffix}"));
    let (Some(x), Some(y)) = (component(".0"), component(".1")) else { return Ok(()) };
    writeln!(out, "  point {point} ({name}): position (m), velocity (m/s), acceleration (m/s²)")?;
    writeln!(
        out,
        "  {:>9}  {:>10} {:>10}  {:>10} {:>10}  {:>11} {:>11}",
        "t (s)", "x", "y", "vx", "vy", "ax", "ay"
    )?;
    for index in spread(motion.time.len(), ROWS) {
        write!(out, "  {:>9.5}", motion.time[index])?;
        let cell = |curve: &Option<Vec<f64>>| curve.as_ref().map_or(f64::NAN, |values| values[index]);
        let pair = |pick: fn(&OutputCurve, usize) -> f64| (pick(x, index), pick(y, index));
        let (px, py) = pair(|curve, index| curve.value[index]);
        write!(out, "  {:>10.6} {:>10.6}", signless(px, 6), signless(py, 6))?;
        write!(out, "  {:>10.5} {:>10.5}", signless(cell(&x.rate), 5), signless(cell(&y.rate), 5))?;
        let (ax, ay) = (cell(&x.acceleration), cell(&y.acceleration));
        writeln!(out, "  {:>11.4} {:>11.4}", signless(ax, 4), signless(ay, 4))?;
    }
    Ok(())
}

/// Zero without a sign where the number rounds to zero.
fn signless(value: f64, digits: i32) -> f64 {
    if value.abs() < 0.5 * 10_f64.powi(-digits) { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_keep_what_matters() {
        assert_eq!(
            [0.2, 20.0, 0.0, core::f64::consts::TAU, 1e-9, -3.0].map(short),
            ["0.2", "20", "0", "6.283185", "1e-9", "-3"]
        );
    }
}

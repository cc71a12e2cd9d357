//! Motions as comma-separated values.

use core::fmt::Write;

use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::facade::Motion;
use crate::motion::{Forces, LoadCurve};

/// The motions of several runs below one header with names and units.
///
/// Columns: `run`, `t`, `q`, `q̇`, `q̈` of each coordinate, value and derivatives of each output, mismatches of rows that yield,
/// and the solver's figures.
/// With masses also energies, loads, multipliers, powers and works. A load or multiplier that is not unique at some instant of
/// some run is marked next to its unit. The last column has the number of rows that follow from others. Numbers are the shortest
/// that read back as the same bits. All motions are of one mechanism.
pub fn write(runs: &[(&str, &Motion)]) -> String {
    let mut text = String::new();
    if let Some((_, motion)) = runs.first() {
        let mut names: Vec<String> = columns(motion).into_iter().map(|(name, _)| name).collect();
        for (_, other) in &runs[1..] {
            // The mark of any run is the longer name.
            let others = names.iter_mut().zip(columns(other));
            others
                .filter(|(name, (other, _))| name.len() < other.len())
                .for_each(|(name, (other, _))| *name = other);
        }
        let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
        text.push_str("run,t (s),");
        text.push_str(&names.join(","));
        text.push_str(",closure (1),iterations (1),margin (1)");
        text.push_str(if motion.dynamics.is_some() { ",dependent rows (1)\n" } else { "\n" });
    }
    for (label, motion) in runs {
        let columns = columns(motion);
        for (row, time) in motion.time.iter().enumerate() {
            text.push_str(&quoted(label));
            let numbers = columns.iter().map(|(_, values)| values[row]);
            let figures = [motion.closure[row], f64::from(motion.iterations[row]), motion.margin[row]];
            let dependent = motion.dynamics.iter().filter_map(|forces| forces.dependent.get(row));
            let figures = figures.into_iter().chain(dependent.map(|count| f64::from(*count)));
            for number in core::iter::once(*time).chain(numbers).chain(figures) {
                write!(text, ",{number:?}").expect("a string takes all");
            }
            text.push('\n');
        }
    }
    text
}

/// Modes of several runs below one header, one mode on each line. Columns: its eigenvalue (one of a conjugate pair), its kind,
/// and real and imaginary part of its shape, coordinate by coordinate.
pub fn write_modes(runs: &[(&str, &Motion, &SmallMotions)]) -> String {
    let mut text = "run,mode,eigenvalues,real (1/s),imaginary (1/s),frequency (Hz),course".to_string();
    for c in runs.iter().take(1).flat_map(|(_, motion, _)| &motion.coordinates) {
        let column = |part: &str| quoted(&format!("{} {part} ({})", c.name, c.unit));
        write!(text, ",{},{}", column("real"), column("imaginary")).expect("a string takes all");
    }
    text.push('\n');
    for (label, motion, small) in runs {
        for (number, mode) in small.modes.iter().enumerate() {
            let [real, imaginary] = mode.eigenvalue;
            let frequency = imaginary / core::f64::consts::TAU;
            let (count, course) = (mode.of.len(), mode.course.word());
            write!(
                text,
                "{},{},{count},{real:?},{imaginary:?},{frequency:?},{course}",
                quoted(label),
                number + 1
            )
            .expect("a string takes all");
            for index in 0..motion.coordinates.len() {
                // No coordinate moves in a mode of states alone.
                let [re, im] = mode.coordinates.get(index).copied().unwrap_or_default();
                write!(text, ",{re:?},{im:?}").expect("a string takes all");
            }
            text.push('\n');
        }
    }
    text
}

/// The unit of a time derivative of order `order` of a quantity in `unit`.
pub fn rate_unit(unit: &str, order: usize) -> String {
    match (order, unit.contains(['/', '*'])) {
        (0, _) => unit.to_string(),
        (1, false) => format!("{unit}/s"),
        (_, false) => format!("{unit}/s^{order}"),
        (1, true) => format!("({unit})/s"),
        (_, true) => format!("({unit})/s^{order}"),
    }
}

fn columns(motion: &Motion) -> Vec<(String, &[f64])> {
    let head = |name: &str, unit: &str, order: usize| {
        format!("{name}{} ({})", ["", "_d", "_dd"][order], rate_unit(unit, order))
    };
    let mut columns = Vec::new();
    for c in &motion.coordinates {
        for (order, values) in [&c.q, &c.qd, &c.qdd].into_iter().enumerate() {
            columns.push((head(c.name, c.unit, order), values.as_slice()));
        }
    }
    for o in &motion.outputs {
        let values = [Some(&o.value), o.rate.as_ref(), o.acceleration.as_ref()];
        for (order, values) in values.into_iter().enumerate() {
            columns.extend(values.map(|values| (head(o.name, o.unit, order), values.as_slice())));
        }
    }
    for row in &motion.mismatches {
        for (order, values) in row.columns().into_iter().enumerate() {
            columns.push((head(&format!("mismatch {}", row.name), row.unit, order), values));
        }
    }
    columns.extend(motion.dynamics.iter().flat_map(force_columns));
    columns
}

fn force_columns(forces: &Forces) -> Vec<(String, &[f64])> {
    let named = [
        ("kinetic energy (J)", &forces.kinetic),
        ("potential energy (J)", &forces.potential),
        ("work (J)", &forces.work),
        ("energy defect (J)", &forces.defect),
        ("closure rate (1/s)", &forces.closure_rate),
    ];
    let kept = named.into_iter().filter(|(_, values)| !values.is_empty());
    let mut columns: Vec<(String, &[f64])> =
        kept.map(|(name, values)| (name.to_string(), values.as_slice())).collect();
    let curve = |kind: &str, curve: &'_ LoadCurve| {
        let mark = if curve.shared > 0 { "; not unique" } else { "" };
        format!("{kind}{} ({}{mark})", curve.name, curve.unit)
    };
    columns.extend(forces.loads.iter().map(|load| (curve("", load), load.value.as_slice())));
    columns.extend(forces.multipliers.iter().map(|row| (curve("lambda ", row), row.value.as_slice())));
    for supply in &forces.supplies {
        columns.push((format!("power of {} (W)", supply.title()), supply.power.as_slice()));
        columns.push((format!("work of {} (J)", supply.title()), supply.work.as_slice()));
    }
    columns
}

/// A cell in quotes where it holds a separator.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::erased::facade::{CoordinateCurve, OutputCurve};
    use crate::motion::mismatch::MismatchCurve;
    use crate::motion::power_balance::{PowerCurve, PowerSource};

    fn motion() -> Motion {
        let tenth = 0.1 + 0.2;
        Motion {
            time: vec![0.0, tenth],
            coordinates: vec![CoordinateCurve {
                name: "phi",
                unit: "rad",
                q: vec![1e-300, tenth],
                qd: vec![-0.0, 1.0 / 3.0],
                qdd: vec![2.0, 1e22],
            }],
            outputs: vec![OutputCurve {
                name: "v",
                unit: "m/s",
                value: vec![1.0, 2.0],
                rate: Some(vec![3.0, 4.0]),
                acceleration: None,
            }],
            closure: vec![0.0, 1e-17],
            iterations: vec![3, 2],
            margin: vec![1.0, 0.5],
            mismatches: Vec::new(),
            dynamics: None,
        }
    }

    #[test]
    fn mismatches_of_rows_that_yield_stand_behind_the_outputs() {
        let row = MismatchCurve {
            name: "second",
            unit: "m",
            value: vec![0.5, 0.25],
            rate: vec![1.5, 1.25],
            acceleration: vec![2.5, 2.25],
            ..MismatchCurve::default()
        };
        let text = write(&[("run", &Motion { mismatches: vec![row], ..motion() })]);
        let header = text.lines().next().unwrap_or("");
        let expected = "v_d ((m/s)/s),mismatch second (m),mismatch second_d (m/s),mismatch second_dd (m/s^2),closure (1)";
        assert!(header.contains(expected), "{header}");
        assert!(text.contains(",4.0,0.25,1.25,2.25,1e-17,"), "{text}");
    }

    #[test]
    fn energies_loads_and_multipliers_stand_between_outputs_and_figures() {
        let curve =
            |name, unit: &str| LoadCurve { name, unit: unit.to_string(), value: vec![5.0, 6.0], shared: 0 };
        let forces = Forces {
            kinetic: vec![1.0, 2.0],
            potential: vec![3.0, 4.0],
            loads: vec![curve("tension", "N")],
            multipliers: vec![curve("rod", "N/m")],
            supplies: vec![PowerCurve {
                name: "motor",
                by: PowerSource::Drive,
                power: vec![7.0, 8.0],
                work: vec![0.0, 9.0],
            }],
            dependent: vec![0, 2],
            ..Forces::default()
        };
        let whole = Motion { dynamics: Some(forces.clone()), ..motion() };
        let text = write(&[("run", &whole)]);
        let header = text.lines().next().unwrap_or("");
        let end = "kinetic energy (J),potential energy (J),tension (N),lambda rod (N/m),power of drive motor (W),work of drive motor (J),closure (1),\
                   iterations (1),margin (1),dependent rows (1)";
        assert!(header.ends_with(end), "{header}");
        assert!(text.ends_with(",2.0,4.0,6.0,6.0,8.0,9.0,1e-17,2.0,0.5,2.0\n"), "{text}");
        // Loads that are not unique in any of the runs are marked in the header of all.
        let mut shared = forces;
        shared.multipliers[0].shared = 1;
        let text = write(&[("run", &whole), ("other", &Motion { dynamics: Some(shared), ..motion() })]);
        let header = text.lines().next().unwrap_or("");
        assert!(header.contains(",tension (N),lambda rod (N/m; not unique),power"), "{header}");
    }

    #[test]
    fn the_header_names_columns_with_units() {
        let text = write(&[("a, b", &motion())]);
        let header = text.lines().next();
        let expected = "run,t (s),phi (rad),phi_d (rad/s),phi_dd (rad/s^2),v (m/s),v_d ((m/s)/s),closure (1),\
                        iterations (1),margin (1)";
        assert_eq!(header, Some(expected));
        assert!(text.lines().nth(1).is_some_and(|line| line.starts_with("\"a, b\",0.0,")));
    }

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        let text = write(&[("run", &motion())]);
        let cells: Vec<f64> = text
            .lines()
            .nth(2)
            .into_iter()
            .flat_map(|line| line.split(',').skip(1))
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        let expected = [0.1 + 0.2, 0.1 + 0.2, 1.0 / 3.0, 1e22, 2.0, 4.0, 1e-17, 2.0, 0.5];
        assert_eq!(cells.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), expected.map(f64::to_bits));
    }
}

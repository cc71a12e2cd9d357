//! Summary of the forces in a motion: loads or multipliers, powers and works, redundant rows.

use crate::erased::facade::Motion;
use crate::motion::power_balance::{PowerCurve, PowerSource};
use crate::motion::{DependentRow, Forces, LoadCurve};

use crate::commands::summary::{significant, signless};

/// Largest number of curves of one name and unit that have a line each; more of them share one line.
const MOST_LINES: usize = 24;

/// Ranges of the text's loads, or of the multipliers if it has none. Many rows of one constraint share one range.
pub(super) fn loads(motion: &Motion) -> Vec<[String; 2]> {
    let Some(forces) = &motion.dynamics else { return Vec::new() };
    let (prefix, curves) =
        if forces.loads.is_empty() { ("lambda ", &forces.multipliers) } else { ("", &forces.loads) };
    let mut lines = Vec::new();
    let mut rest = curves.as_slice();
    while let Some(first) = rest.first() {
        let alike = |curve: &LoadCurve| family(curve.name) == family(first.name) && curve.unit == first.unit;
        let count = rest.iter().take_while(|curve| alike(curve)).count();
        let (family_of, others) = rest.split_at(count);
        rest = others;
        if count > MOST_LINES {
            lines.push(together(prefix, family_of));
        } else {
            lines.extend(family_of.iter().map(|curve| line(prefix, curve)));
        }
    }
    lines.extend(surplus(forces));
    lines
}

/// The name without its indices.
fn family(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

fn line(prefix: &str, curve: &LoadCurve) -> [String; 2] {
    let shared = match curve.shared {
        0 => String::new(),
        all if all == curve.value.len() => ", not unique: the shortest of many".to_string(),
        some => format!(", not unique at {some} of {} instants", curve.value.len()),
    };
    [format!("{prefix}{}", curve.name), format!("{} {}{shared}", range(&curve.value, 4), curve.unit)]
}

/// One line of all curves of a name.
fn together(prefix: &str, curves: &[LoadCurve]) -> [String; 2] {
    let values: Vec<f64> = curves.iter().flat_map(|curve| curve.value.iter().copied()).collect();
    let shared = match curves.iter().filter(|curve| curve.shared > 0).count() {
        0 => String::new(),
        count => format!(", {count} of them not unique at some instants"),
    };
    let (name, unit) = curves.first().map_or(("", ""), |curve| (family(curve.name), curve.unit.as_str()));
    [format!("{prefix}{name}, all {}", curves.len()), format!("{} {unit}{shared}", range(&values, 4))]
}

/// Largest value (m, N and so on) from which four decimals tell it.
const FOUR_DECIMALS: f64 = 0.1;

/// Least of the largest values that are printed without an exponent.
const LEAST_DECIMAL: f64 = 1e-6;

/// Least and largest value, of a single one the value. Small values have decimals in addition, so that the largest one has four digits.
fn range(values: &[f64], decimals: usize) -> String {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let is_small = 0.0 < largest && largest < FOUR_DECIMALS;
    let more = if is_small { (-largest.log10()).floor() as usize } else { 0 };
    let digits = more + if values.len() == 1 { 6 } else { decimals };
    let shown = |value: f64| match is_small && largest < LEAST_DECIMAL {
        true => significant(value, 5),
        false => format!("{:.digits$}", signless(value, digits)),
    };
    let least = shown(values.iter().copied().fold(f64::INFINITY, f64::min));
    let most = shown(values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    if values.len() == 1 { least } else { format!("{least} to {most}") }
}

/// The work of each force and drive with the range of its power, and the energy balance.
pub(super) fn energies(motion: &Motion) -> Vec<[String; 2]> {
    let Some(forces) = &motion.dynamics else { return Vec::new() };
    let active: Vec<&PowerCurve> = forces.supplies.iter().filter(|supply| !supply.is_idle()).collect();
    let error = open(forces);
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, value| most.max(value.abs()));
    let energies = forces.kinetic.iter().chain(&forces.work).copied();
    let most_work = largest(&mut energies.chain(active.iter().map(|supply| supply.total())));
    let span = motion.time.last().zip(motion.time.first()).map_or(0.0, |(last, first)| last - first);
    let mean = if 0.0 < span { most_work / span } else { 0.0 };
    let most_power = largest(&mut active.iter().flat_map(|supply| supply.power.iter().copied())).max(mean);
    let line = |supply: &&PowerCurve| {
        let (least, most) = supply
            .power
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), power| (a.min(*power), b.max(*power)));
        let [least, most] = [least, most].map(|power| unrounded(power, most_power));
        let total = unrounded(supply.total(), most_work);
        let powers = match (least, most) {
            (0.0, 0.0) if total != 0.0 => "power between the instants shown alone".into(),
            _ => format!("power {} to {} W", significant(least, 5), significant(most, 5)),
        };
        [format!("work of {}", supply.title()), format!("{} J, {powers}", settled(total, error))]
    };
    let mut lines: Vec<[String; 2]> = active.iter().take(MOST_LINES).map(line).collect();
    if let Some(left) = active.len().checked_sub(MOST_LINES).filter(|left| *left > 0) {
        let rest: f64 = active.iter().skip(MOST_LINES).map(|supply| supply.total()).sum();
        lines.push([format!("work of {left} more"), format!("{} J", settled(rest, error))]);
    }
    if !active.is_empty() {
        lines.push(balance(forces, &active, most_work));
    }
    lines
}

/// A value, or 0 where it is rounding beside the largest of its kind.
fn unrounded(value: f64, largest: f64) -> f64 {
    /// Part of the largest value, as on the page.
    const ROUNDING: f64 = 1e-12;
    if value.abs() <= ROUNDING * largest { 0.0 } else { value }
}

/// Error of the works at the last instant (J). It is the larger of two differences: their sum less the work integrated for all
/// together, and the energy defect.
fn open(forces: &Forces) -> f64 {
    let last = |values: &[f64]| values.last().copied().unwrap_or(0.0);
    let sum: f64 = forces.supplies.iter().map(PowerCurve::total).sum();
    (sum - last(&forces.work)).abs().max(last(&forces.defect).abs())
}

/// A work (J) with the digits that are reliable at an error of `error` (J), at most seven and at least one.
fn settled(work: f64, error: f64) -> String {
    const MOST: f64 = 7.0;
    let digits = (work / error).abs().log10().floor();
    // Neither if the error is zero nor if there is no work.
    let digits = if digits.is_finite() { digits.clamp(1.0, MOST) } else { MOST };
    significant(work, digits as usize)
}

/// Energy that impacts take, over the energies of a motion, from which it is no rounding.
const LEAST_JUMP: f64 = 1e-9;

/// Energy balance: the change of the energy and the works that add up to it, as name and value. `most_work`: the largest energy (J).
fn balance(forces: &Forces, active: &[&PowerCurve], most_work: f64) -> [String; 2] {
    let at = |values: &[f64], last: bool| {
        let value = if last { values.last() } else { values.first() };
        value.copied().unwrap_or(0.0)
    };
    let energy = |last: bool| at(&forces.kinetic, last) + at(&forces.potential, last);
    let change = energy(true) - energy(false);
    let mut sum = 0.0;
    let mut parts = Vec::new();
    let error = open(forces);
    for (by, name) in [
        (PowerSource::Drive, "drives"),
        (PowerSource::Constraint, "constraints"),
        (PowerSource::Force, "forces"),
        (PowerSource::Time, "the time"),
    ] {
        let of = || active.iter().filter(|supply| supply.by == by);
        if of().next().is_some() {
            let work = unrounded(of().map(|supply| supply.total()).sum(), most_work);
            sum += work;
            parts.push(format!("{name} {} J", settled(work, error)));
        }
    }
    // The energy that impacts take: what a run leaves out of its balance.
    let over = |values: &[f64]| at(values, true) - at(values, false);
    let jumps = change - over(&forces.work) - over(&forces.defect);
    if forces.work.len() == forces.kinetic.len()
        && jumps < -LEAST_JUMP * at(&forces.kinetic, true).max(-change)
    {
        sum += jumps;
        parts.push(format!("impacts {} J", settled(jumps, error)));
    }
    let value = format!(
        "{} J, work of {}; {:.1e} J between them",
        significant(change, 7),
        parts.join(" + "),
        change - sum
    );
    ["change of kinetic and potential energy".to_string(), value]
}

/// The rows that follow from others, each once, and the number of multipliers that are not unique because of them.
fn surplus(forces: &Forces) -> Option<[String; 2]> {
    let instants = forces.dependent.len();
    let row = |row: &DependentRow| {
        let when = if row.instants == instants {
            String::new()
        } else {
            format!(" at {} of {instants} instants", row.instants)
        };
        format!("`{}` (line {}){when}", row.name, row.line)
    };
    let rows: Vec<String> = forces.dependent_rows.iter().map(row).collect();
    let shared = forces.multipliers.iter().filter(|curve| curve.shared > 0).count();
    let all = forces.multipliers.len();
    let rest = format!("the multipliers of {shared} of {all} rows are not unique, but the shortest of many");
    (!rows.is_empty())
        .then(|| ["rows that follow from others".to_string(), format!("{}; {rest}", rows.join(", "))])
}

#[cfg(test)]
mod tests {
    use super::{range, settled, unrounded};

    #[test]
    fn ranges_have_digits_of_their_largest_value() {
        assert_eq!(range(&[0.0, 4.905], 4), "0.0000 to 4.9050");
        assert_eq!(range(&[-706.047_412, 3.0], 4), "-706.0474 to 3.0000");
        assert_eq!(range(&[0.0, 1e-4], 4), "0.00000000 to 0.00010000");
        assert_eq!(range(&[-0.05, 0.02], 4), "-0.05000 to 0.02000");
        assert_eq!(range(&[0.0, 2.0554e-7], 4), "0 to 2.0554e-7");
        assert_eq!(range(&[0.0, 0.0], 4), "0.0000 to 0.0000");
        assert_eq!(range(&[45.341_95], 4), "45.341950");
        assert_eq!(range(&[1.25e-4], 4), "0.000125000");
        assert_eq!(range(&[0.0], 4), "0.000000");
    }

    #[test]
    fn rounding_is_no_work() {
        assert_eq!(unrounded(1e-35, 0.04), 0.0);
        assert_eq!(unrounded(-1.9e-15, 12.0), 0.0);
        assert_eq!(unrounded(7.7e-8, 0.5), 7.7e-8);
    }

    #[test]
    fn works_are_printed_with_the_digits_that_their_error_leaves() {
        assert_eq!(settled(-0.003_125_412, 2e-7), "-0.003125");
        assert_eq!(settled(-0.003_125_412, 0.0), "-0.003125412");
        assert_eq!(settled(1_234.567_89, 1e-12), "1234.568");
        assert_eq!(settled(3e-5, 1e-3), "3e-5");
        assert_eq!(settled(0.0, 1e-3), "0");
    }
}

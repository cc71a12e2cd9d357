//! Rows that are another row times a number, found by their values, however they are written.

use super::expression::{Expressions, Node};
use super::vanishing::{Sized, values};
use super::{ConstraintRow, Model};
use crate::diagnostics::Diagnostics;
use crate::sample_points::fraction;

/// Positions that are tried. Analytic functions whose quotient is the same at so many positions of either sign have it everywhere:
/// parts of a function with two branches, `sqrt(x^2)`, agree at each of them with a probability of a half.
const TRIALS: usize = 32;
/// Trials with the same parameters, inputs and time, on which a factor may depend.
const TRIALS_OF_A_DESIGN: usize = 8;
/// Trials that must give numbers: some positions are out of a function's domain.
const FEWEST: usize = 20;
/// Difference of two products in parts of their terms: rounding of a few thousand operations.
const ROUNDING: f64 = 1e-12;
/// Least part of its terms that a row may be at a trial: below it the difference of two rows says little.
const LEAST: f64 = 1e-3;
/// Relative difference of quotients by which pairs are picked.
const NEAR: f64 = 1e-9;
/// Distinguishes these from other keys of scattered numbers.
const KIND: u64 = 1 << 21;

/// Before: a model without faults. After: rows that are an earlier one times a number, or times a function of parameters and time,
/// are reported. Those marked `redundant` may be.
///
/// Two numbers of each row pick the pairs; only these are tried further. Nothing is reported that is not certain.
pub fn check(model: &Model, diagnostics: &mut Diagnostics) {
    let rows = &model.rows;
    if rows.len() < 2 {
        return;
    }
    let of_rows = |trial: usize| -> Vec<Option<Sized>> {
        let values = at(&model.expressions, trial);
        let finite = |(value, size): &Sized| value.is_finite() && size.is_finite();
        rows.iter().map(|row| values.get(row.residual.index()).copied().flatten().filter(finite)).collect()
    };
    let [first, second] = [of_rows(0), of_rows(1)];
    let mut quotients: Vec<(f64, usize)> = Vec::new();
    for (index, (first, second)) in first.iter().zip(&second).enumerate() {
        if let (Some((first, _)), Some((second, _))) = (first, second)
            && *first != 0.0
        {
            quotients.push((second / first, index));
        }
    }
    quotients.sort_by(|(a, i), (b, j)| a.total_cmp(b).then(i.cmp(j)));
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for pair in quotients.windows(2) {
        let [(a, i), (b, j)] = pair else { continue };
        if (a - b).abs() <= NEAR * a.abs() {
            pairs.push((*i.min(j), *i.max(j)));
        }
    }
    if pairs.is_empty() {
        return;
    }
    let trials: Vec<Vec<Option<Sized>>> = (0..TRIALS).map(of_rows).collect();
    pairs.sort_unstable();
    for (earlier, later) in pairs {
        let (Some(one), Some(other)) = (rows.get(earlier), rows.get(later)) else { continue };
        if !one.redundant && !other.redundant && is_multiple(&trials, earlier, later) {
            report(one, other, diagnostics);
        }
    }
}

/// `true` if two rows have the same quotient at all trials of a design.
fn is_multiple(trials: &[Vec<Option<Sized>>], earlier: usize, later: usize) -> bool {
    let mut agreed = 0;
    for design in trials.chunks(TRIALS_OF_A_DESIGN) {
        let pair = |trial: &Vec<Option<Sized>>| {
            let (a, b) = ((*trial.get(earlier)?)?, (*trial.get(later)?)?);
            let is_plain = |(value, size): Sized| value.abs() > LEAST * size;
            (is_plain(a) && is_plain(b)).then_some((a, b))
        };
        let mut known = design.iter().filter_map(pair);
        let Some((a, b)) = known.next() else { continue };
        agreed += 1;
        for (c, d) in known {
            let difference = d.0 * a.0 - c.0 * b.0;
            let size = d.1 * a.1 + c.1 * b.1;
            if difference.abs() > ROUNDING * size {
                return false;
            }
            agreed += 1;
        }
    }
    agreed >= FEWEST
}

/// Values of all expressions at a trial.
fn at(expressions: &Expressions, trial: usize) -> Vec<Option<Sized>> {
    let design = trial / TRIALS_OF_A_DESIGN;
    // Small positions are in the domain of roots, large ones are beyond a turn.
    let reach = [0.5, 2.0, 10.0].get(trial % 3).copied().unwrap_or(1.0);
    let index = |index: usize| u32::try_from(index).unwrap_or(0);
    let leaf = |node: Node| {
        Some(match node {
            Node::Coordinate(coordinate) => reach * (2.0 * fraction(KIND, index(coordinate), trial) - 1.0),
            Node::Variable(variable) => 0.2 + fraction(KIND + 1, index(variable), design),
            _ => 0.2 + fraction(KIND + 2, 0, design),
        })
    };
    // A function of the caller may be any: one without a period, its derivatives as functions of their own.
    let called = |function: usize, order: u8, argument: f64| {
        let phase = fraction(KIND + 3, index(function), usize::from(order));
        Some(libm::sin(1.3 * argument + 6.0 * phase) + (0.1 + phase) * argument)
    };
    values(expressions, leaf, called)
}

fn report(one: &ConstraintRow, other: &ConstraintRow, diagnostics: &mut Diagnostics) {
    let line = one.span.start().line;
    let message = format!("the row `{}` is the row `{}` once more, up to a factor", other.name, one.name);
    let group = other.name.split('.').next().unwrap_or(&other.name);
    let help = match other.driven || one.driven {
        true => format!("remove it or the one in line {line}: they hold the same coordinates"),
        false => format!(
            "remove it or the one in line {line}; rows that may follow from others are marked: `constraint {group} redundant {{ … }}`"
        ),
    };
    diagnostics.report(other.span, message, help);
}

//! Forces that a text does not give: those of rigid contacts, and of frictions that stick.
//!
//! They are what the equations of motion leave over along their places, by least squares. Then they must keep their laws: a contact
//! pushes and stays closed, a friction holds within its limit.

use super::evaluation::Gap;
use super::mechanics::{Held, Law, Normal, mechanics};
use super::number::Number;
use super::state::OracleState;
use super::{Along, Oracle};

/// Deviations up to which a law counts as kept, as parts of what is compared.
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    /// Of a gap: as a part of the reference lengths; of rates and accelerations a hundred times of it.
    pub rows: f64,
    /// Of a force: as a part of all forces.
    pub forces: f64,
    /// Largest rates and accelerations of the run in the reference metric.
    pub pace: [f64; 2],
}

/// Forces of a state, and laws that they break.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeldForces {
    /// One each contact and friction, in the order of the text.
    pub forces: Vec<f64>,
    /// Laws that are broken, in words.
    pub broken: Vec<String>,
    /// `true` where forces share what is left over, so that their laws are not checked.
    pub is_shared: bool,
}

/// Column that a force has among the unknown ones, and what is known of it.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// The unknown force, times a factor.
    of: Option<(usize, f64)>,
    known: f64,
}

/// A column is dependent where less of it than this is left beside the others.
const DEPENDENT: f64 = 1e-9;

impl Oracle {
    /// Forces of rigid contacts and of frictions that stick, from the rest of the equations of motion.
    ///
    /// # Errors
    /// The part of the text that cannot be evaluated.
    pub fn held(&self, state: &OracleState, scales: &[f64], slack: Slack) -> Result<HeldForces, Gap> {
        let all = mechanics(&self.placed, &self.names(state, Along::Nothing))?.held;
        if all.is_empty() {
            return Ok(HeldForces::default());
        }
        let without = OracleState { held: vec![0.0; all.len()], ..state.clone() };
        // What is left over along each coordinate, and the way of each place along it.
        let (mut rest, mut size) = (Vec::new(), 0.0_f64);
        let mut ways = vec![Vec::new(); all.len()];
        for (j, scale) in scales.iter().enumerate() {
            let mut w = vec![0.0; scales.len()];
            w[j] = *scale;
            let balance = self.equations_of_motion(&without, &w)?;
            rest.push(balance.sum);
            size = size.max(balance.size);
            let moved = mechanics(&self.placed, &self.names(state, Along::Positions(&w)))?.held;
            ways.iter_mut().zip(moved).for_each(|(way, held)| way.push(held.place.value.a));
        }
        let mut found = HeldForces::default();
        let widths: Vec<f64> = ways.iter().map(|way| way.iter().map(|part| part.abs()).sum()).collect();
        let (parts, count) = parts(&all, &widths, slack);
        let mut columns = vec![vec![0.0; rest.len()]; count];
        for (part, way) in parts.iter().zip(&ways) {
            rest.iter_mut().zip(way).for_each(|(rest, way)| *rest -= part.known * way);
            if let Some((of, factor)) = part.of {
                columns[of].iter_mut().zip(way).for_each(|(entry, way)| *entry += factor * way);
            }
        }
        let (solution, is_shared) = least_squares(columns, &rest);
        found.is_shared = is_shared;
        found.forces = parts
            .iter()
            .map(|part| part.known + part.of.map_or(0.0, |(of, factor)| factor * solution[of]))
            .collect();
        broken(&all, &parts, (&widths, size), slack, &mut found);
        Ok(found)
    }
}

impl Oracle {
    /// `true` where the time moves the gap of a rigid contact, whose impacts may bring in energy.
    ///
    /// # Errors
    /// The part of the text that cannot be evaluated.
    pub fn drives_contacts(&self, state: &OracleState) -> Result<bool, Gap> {
        let along = mechanics(&self.placed, &self.names(state, Along::Positions(&state.qd)))?.held;
        let is_driven = |held: &Held| {
            let Number { value, rate } = held.place;
            matches!(held.law, Law::Contact)
                && (rate.v - value.a).abs() > 1e-9 * (rate.v.abs() + value.a.abs())
        };
        Ok(along.iter().any(is_driven))
    }
}

/// The places of forces among the unknown ones, and their number.
fn parts(all: &[Held], widths: &[f64], slack: Slack) -> (Vec<Part>, usize) {
    let rate = |width: f64| 100.0 * slack.rows * width * (1.0 + slack.pace[0]);
    let mut count = 0;
    let mut next = || {
        count += 1;
        Some((count - 1, 1.0))
    };
    let none = Part { of: None, known: 0.0 };
    let mut parts = vec![none; all.len()];
    // A friction may stand before the contact that it is on.
    for (part, (held, width)) in parts.iter_mut().zip(all.iter().zip(widths)) {
        let (place, speed) = (held.place.value.v, held.place.rate.v);
        let is_closed = place.abs() <= 10.0 * slack.rows * width && speed.abs() <= rate(*width);
        if matches!(held.law, Law::Contact) && is_closed {
            part.of = next();
        }
    }
    for (index, (held, width)) in all.iter().zip(widths).enumerate() {
        let Law::Friction { normal, sliding, viscous, .. } = &held.law else { continue };
        let speed = held.place.rate.v;
        let slides = speed.abs() > rate(*width);
        let known = -viscous * speed;
        let on = match *normal {
            Normal::Of(contact) => parts.get(contact).and_then(|contact| contact.of).map(|(of, _)| of),
            Normal::Force(_) => None,
        };
        parts[index] = match (*normal, on) {
            (Normal::Of(_), None) => Part { of: None, known },
            (Normal::Of(_), Some(of)) if slides => Part { of: Some((of, -sliding * speed.signum())), known },
            (Normal::Force(normal), _) if slides => {
                Part { of: None, known: known - sliding * normal.abs() * speed.signum() }
            }
            _ => Part { of: next(), known },
        };
    }
    (parts, count)
}

/// Laws that the forces break.
fn broken(all: &[Held], parts: &[Part], (widths, size): (&[f64], f64), slack: Slack, found: &mut HeldForces) {
    let largest = found.forces.iter().fold(size, |largest: f64, force| largest.max(force.abs()));
    for (index, (held, width)) in all.iter().zip(widths).enumerate() {
        let width = width.max(f64::MIN_POSITIVE);
        let Held { name, place, .. } = held;
        let force = found.forces[index];
        let digit = slack.forces * largest.max(force.abs() * width) / width;
        let second = place.rate.b;
        let moves = second.abs() > 100.0 * slack.rows * width * (1.0 + slack.pace[1]);
        // The top of a flight that is lower than what is called closed.
        let flies = place.value.v > 0.0 && force.abs() <= digit;
        match &held.law {
            Law::Contact if place.value.v < -10.0 * slack.rows * width => {
                found
                    .broken
                    .push(format!("the gap of `{name}` is {:.1e}: it does not push back", place.value.v));
            }
            _ if found.is_shared || parts[index].of.is_none_or(|(_, factor)| factor != 1.0) => {}
            Law::Contact if force < -digit => {
                found.broken.push(format!("`{name}` pulls with {:.1e}", -force));
            }
            Law::Contact if moves && !flies && (second < 0.0 || force > digit) => {
                found.broken.push(format!("`{name}` pushes with {force:.1e} and moves with {second:.1e}"));
            }
            Law::Friction { normal, holding, .. } => {
                let normal = match *normal {
                    Normal::Force(normal) => normal.abs(),
                    Normal::Of(contact) => found.forces.get(contact).copied().unwrap_or(0.0),
                };
                let (held, limit) = (force - parts[index].known, holding * normal);
                if held.abs() > limit + digit {
                    found.broken.push(format!(
                        "`{name}` holds with {:.6e} where {limit:.6e} is its limit",
                        held.abs()
                    ));
                } else if moves && held.abs() < limit - digit {
                    found.broken.push(format!("`{name}` moves with {second:.1e} below its limit"));
                }
            }
            Law::Contact => {}
        }
    }
}

/// x with the least |b − Σ xₖ aₖ|, by Gram and Schmidt's columns, the longest first; dependent columns have x = 0, and `true` is told.
fn least_squares(columns: Vec<Vec<f64>>, b: &[f64]) -> (Vec<f64>, bool) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let lengths: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
    let mut left = columns.clone();
    let mut x = vec![0.0; columns.len()];
    let mut chosen: Vec<(usize, Vec<f64>)> = Vec::new();
    loop {
        let share = |k: &usize| dot(&left[*k], &left[*k]).sqrt() / lengths[*k];
        let free =
            (0..left.len()).filter(|k| lengths[*k] > 0.0 && chosen.iter().all(|(other, _)| other != k));
        let Some(k) = free.max_by(|a, b| share(a).total_cmp(&share(b))) else { break };
        if share(&k) < DEPENDENT {
            break;
        }
        let length = dot(&left[k], &left[k]).sqrt();
        let direction: Vec<f64> = left[k].iter().map(|entry| entry / length).collect();
        for column in &mut left {
            // Twice is enough: the second pass takes what rounding has left of the first.
            for _ in 0..2 {
                let along = dot(column, &direction);
                column.iter_mut().zip(&direction).for_each(|(entry, part)| *entry -= along * part);
            }
        }
        chosen.push((k, direction));
    }
    let mut rest = b.to_vec();
    let mut sides = Vec::new();
    for (_, direction) in &chosen {
        let along = dot(&rest, direction);
        rest.iter_mut().zip(direction).for_each(|(entry, part)| *entry -= along * part);
        sides.push(along);
    }
    for i in (0..chosen.len()).rev() {
        let (k, direction) = &chosen[i];
        let later: f64 =
            chosen[i + 1..].iter().map(|(other, _)| x[*other] * dot(&columns[*other], direction)).sum();
        x[*k] = (sides[i] - later) / dot(&columns[*k], direction);
    }
    (x, chosen.len() < columns.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_take_what_columns_can() {
        let columns = vec![vec![1.0, 0.0, 2.0], vec![0.0, 3.0, 0.0]];
        let (x, is_shared) = least_squares(columns.clone(), &[2.0, -3.0, 4.0]);
        assert!((x[0] - 2.0).abs() < 1e-15 && (x[1] + 1.0).abs() < 1e-15 && !is_shared, "{x:?}");
        let (x, is_shared) = least_squares([columns, vec![vec![2.0, 3.0, 4.0]]].concat(), &[2.0, -3.0, 4.0]);
        let sum = [x[0] + 2.0 * x[2], 3.0 * x[1] + 3.0 * x[2], 2.0 * x[0] + 4.0 * x[2]];
        assert!(is_shared && sum.iter().zip([2.0, -3.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-14), "{x:?}");
        assert_eq!(least_squares(Vec::new(), &[1.0]), (Vec::new(), false));
    }
}

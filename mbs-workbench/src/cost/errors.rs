//! Errors of a run against a reference solution: coordinates, velocities, multipliers, energy, times of contacts and events.

use crate::cost::continued::continued;
use crate::cost::points::Errors;
use crate::cost::reference::linear::worse;
use crate::cost::reference::{Contact, Reference, Shot};
use crate::double_double::DoubleDouble as D;
use crate::erased::timed_runs::Seen;

/// Largest values of a motion, by which errors are measured.
#[derive(Clone, Debug)]
pub struct Sizes {
    /// Reference metric of the coordinates: N.
    pub scales: Vec<f64>,
    /// Reference metric of the rows: M.
    rows: Vec<f64>,
    /// Largest velocity.
    pub rate: f64,
    multiplier: f64,
    reaction: f64,
    energy: f64,
    /// Largest magnitude of each output.
    pub outputs: Vec<f64>,
    /// Multipliers that are unique, at each instant of the reference: M.
    unique: Vec<Vec<bool>>,
}

/// Largest magnitude; 1 where all are 0.
fn size(values: impl Iterator<Item = f64>) -> f64 {
    let largest = values.map(f64::abs).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

impl Sizes {
    /// Those of `reference`, in the metric `scales` of coordinates (N) and `rows` (M). `unique` tells for time (s) and coordinates (N)
    /// which multipliers are unique there.
    pub fn of(
        reference: &Reference,
        [scales, rows]: [Vec<f64>; 2],
        unique: &dyn Fn(f64, &[f64]) -> Vec<bool>,
    ) -> Self {
        let shots = || reference.shots.iter();
        let rates =
            shots().flat_map(|shot| shot.at.qd.iter().zip(&scales).map(|(qd, scale)| qd.high / scale));
        let reactions = shots()
            .flat_map(|shot| shot.observed.reaction.iter().zip(&scales).map(|(r, scale)| r.high * scale));
        let energy = size(shots().map(|shot| shot.observed.kinetic.high));
        let count = reference.shots.first().map_or(0, |shot| shot.observed.outputs.len());
        let outputs = (0..count).map(|k| size(shots().map(move |shot| shot.observed.outputs[k].high)));
        let at = |shot: &Shot| {
            let q: Vec<f64> = shot.at.q.iter().map(|value| value.high).collect();
            unique(shot.at.t.high, &q)
        };
        let unique: Vec<Vec<bool>> = shots().map(at).collect();
        let multipliers = shots().zip(&unique).flat_map(|(shot, unique)| {
            let entries = shot.lambda.iter().zip(&rows).zip(unique).filter(|(_, unique)| **unique);
            entries.map(|((value, scale), _)| value.high * scale)
        });
        let (rate, reaction, multiplier) = (size(rates), size(reactions), size(multipliers));
        let outputs = outputs.collect();
        Sizes { rate, reaction, energy, multiplier, outputs, unique, scales, rows }
    }
}

/// Difference of a value and the reference, in `f64`.
pub fn apart(value: f64, reference: D) -> f64 {
    ((value - reference.high) - reference.low).abs()
}

/// Error of the judged quantity at one instant.
fn judged(seen: &Seen, shot: &Shot, sizes: &Sizes, watched: &[usize]) -> f64 {
    if watched.is_empty() {
        let pairs = seen.q.iter().zip(&shot.at.q).zip(&sizes.scales);
        return pairs.map(|((q, exact), scale)| apart(*q, *exact) / scale).fold(0.0, worse);
    }
    let of = |k: &usize| apart(seen.observed.outputs[*k], shot.observed.outputs[*k]) / sizes.outputs[*k];
    watched.iter().map(of).fold(0.0, worse)
}

/// Error of the velocities of a run that is `late` (s) by what it makes of the last contact, in the reference metric.
fn of_rates(seen: &Seen, shot: &Shot, sizes: &Sizes, late: f64) -> f64 {
    let rates = seen.qd.iter().zip(&shot.at.qd).zip(&shot.qdd).zip(&sizes.scales);
    let of =
        |(((qd, exact), qdd), scale): (((&f64, &D), &D), &f64)| apart(qd + late * qdd.high, *exact) / scale;
    rates.map(of).fold(0.0, worse) / sizes.rate
}

/// Error of the velocities at an instant that lies between an impact `pair` in the run and in the reference: against those of the
/// reference at the time shifted by the impact's error, on the side of the impact that the run is on. What the continued reference
/// leaves open is taken off. None where the reference has too few instants on that side.
fn of_rates_between(seen: &Seen, pair: &Matched, reference: &Reference, sizes: &Sizes) -> Option<f64> {
    let late = pair.of_run - pair.exact;
    let is_before = late > 0.0;
    let events = || reference.contacts.iter().map(|contact| contact.t);
    let (from, to) = match is_before {
        true => (events().filter(|t| *t < pair.exact).fold(f64::NEG_INFINITY, f64::max), pair.exact),
        false => (pair.exact, events().filter(|t| *t > pair.exact).fold(f64::INFINITY, f64::min)),
    };
    let piece = reference.shots.iter().filter(|shot| (from < shot.at.t.high) && (shot.at.t.high < to));
    let [exact, open] = continued(piece, seen.t - late)?;
    let rates = seen.qd.iter().zip(&exact).zip(&open).zip(&sizes.scales);
    let of = |(((qd, exact), open), scale): (((&f64, &D), &D), &f64)| {
        let over = apart(*qd, *exact) - open.high.abs();
        // NaN stays.
        if over < 0.0 { 0.0 } else { over / scale }
    };
    Some(rates.map(of).fold(0.0, worse) / sizes.rate)
}

/// Error of the multipliers that are unique at the `index`th instant, over the largest; NaN where none is.
fn of_multipliers(seen: &Seen, shot: &Shot, sizes: &Sizes, index: usize) -> f64 {
    let unique = sizes.unique.get(index).map_or(&[][..], Vec::as_slice);
    let entries = seen.lambda.iter().zip(&shot.lambda).zip(&sizes.rows).zip(unique);
    let errors = entries
        .filter(|(_, unique)| **unique)
        .map(|(((value, exact), scale), _)| apart(*value, *exact) * scale / sizes.multiplier);
    errors.reduce(worse).unwrap_or(f64::NAN)
}

/// Times (s) of a contact or an event in a run and in the reference.
#[derive(Clone, Copy, Debug)]
struct Matched {
    of_run: f64,
    exact: f64,
    closes: bool,
    jumps: bool,
}

impl Matched {
    /// `true` at a time (s) at which one of both motions has jumped and the other one has not.
    fn is_between(&self, t: f64) -> bool {
        self.jumps && (t - self.exact) * (t - self.of_run) <= 0.0
    }
}

/// Time between impacts, over that of the last one, below which they are the end of infinitely many: types of number count them differently.
const ACCUMULATED: f64 = 1e-6;

/// `true` for as many changes, or for impacts of which one motion has more at the end of infinitely many.
fn are_as_many(times: &[f64], exact: &[&Contact]) -> bool {
    let exact_times: Vec<f64> = exact.iter().map(|contact| contact.t).collect();
    let [few, many] = if times.len() < exact.len() { [times, &exact_times] } else { [&exact_times, times] };
    let jumps = exact.iter().all(|contact| contact.jumps);
    let last = many.last().copied().unwrap_or(0.0);
    let rest = many.get(few.len().saturating_sub(1)..).unwrap_or(&[]);
    let is_end = rest.windows(2).all(|pair| pair[1] - pair[0] <= ACCUMULATED * last);
    few.len() == many.len() || jumps && !few.is_empty() && is_end
}

/// The `k`th change of each contact in a run and in the reference; none where a run has more changes or fewer.
fn matched(found: &[Vec<f64>], reference: &[Contact]) -> Option<Vec<Matched>> {
    let mut pairs = Vec::new();
    for (index, times) in found.iter().enumerate() {
        let own: Vec<&Contact> = reference.iter().filter(|contact| contact.index == index).collect();
        if !are_as_many(times, &own) {
            return None;
        }
        let of = |(exact, time): (&&Contact, &f64)| Matched {
            of_run: *time,
            exact: exact.t,
            closes: exact.closes,
            jumps: exact.jumps,
        };
        pairs.extend(own.iter().zip(times).map(of));
    }
    pairs.sort_by(|a, b| a.exact.total_cmp(&b.exact));
    Some(pairs)
}

/// Widths of the time between a contact in a run and in the reference, up to which an instant is at the contact.
const NEAR: f64 = 10.0;

/// Time (s) by which a run is late at `t` (s), if that is during a contact or next to its ends.
fn late(pairs: &[Matched], t: f64) -> Option<f64> {
    let last = pairs.iter().rposition(|pair| pair.exact <= t);
    let is_near = |pair: &Matched| (t - pair.exact).abs() <= NEAR * (pair.of_run - pair.exact).abs();
    let near = last.into_iter().chain(last.map_or(Some(0), |last| Some(last + 1)));
    let chosen = near
        .filter_map(|index| pairs.get(index))
        .find(|pair| pair.closes && pair.exact <= t || is_near(pair));
    chosen.map(|pair| pair.of_run - pair.exact)
}

/// Errors of `run`, whose contacts and events change at the times `contacts` (s, one list each), against `reference`.
pub fn errors(
    run: &[Seen],
    contacts: &[Vec<f64>],
    reference: &Reference,
    sizes: &Sizes,
    watched: &[usize],
) -> Option<Errors> {
    let parts = reference.shots.len().checked_sub(1)?;
    let stride = (parts / run.len().checked_sub(1)?.max(1)).max(1);
    let mut all = Vec::new();
    let mut errors = Errors { multiplier: f64::NAN, contact: f64::NAN, ..Errors::default() };
    let pairs = matched(contacts, &reference.contacts);
    if !contacts.is_empty() && !reference.contacts.is_empty() || pairs.is_none() {
        let of =
            |pairs: &Vec<Matched>| pairs.iter().map(|pair| (pair.of_run - pair.exact).abs()).fold(0.0, worse);
        errors.contact = pairs.as_ref().map_or(f64::INFINITY, of);
    }
    let pairs = pairs.unwrap_or_default();
    for (index, (seen, shot)) in run.iter().zip(reference.shots.iter().step_by(stride)).enumerate() {
        all.push(judged(seen, shot, sizes, watched));
        let plain = of_rates(seen, shot, sizes, 0.0);
        let shifted = late(&pairs, shot.at.t.high).map_or(plain, |late| of_rates(seen, shot, sizes, late));
        // NaN stays.
        let rate = if shifted < plain { shifted } else { plain };
        let reaction = seen.observed.reaction.iter().zip(&shot.observed.reaction).zip(&sizes.scales);
        let reaction = reaction.map(|((r, exact), scale)| apart(*r, *exact) * scale / sizes.reaction);
        let is_between = pairs.iter().any(|pair| pair.is_between(shot.at.t.high));
        let mut between = pairs.iter().filter(|pair| pair.is_between(shot.at.t.high));
        // Between an impact of the run and that of the reference both have no velocity and no energy in common.
        let rate = match (between.next(), between.next()) {
            (None, _) => Some(rate),
            (Some(pair), None) => of_rates_between(seen, pair, reference, sizes),
            (Some(_), Some(_)) => None,
        };
        errors.rate = worse(errors.rate, rate.unwrap_or(0.0));
        errors.second = worse(errors.second, reaction.fold(0.0, worse));
        let multiplier = of_multipliers(seen, shot, sizes, index * stride);
        if !multiplier.is_nan() {
            errors.multiplier = errors.multiplier.max(multiplier);
        }
        if !is_between {
            let energy = apart(seen.observed.energy, shot.observed.energy) / sizes.energy;
            errors.energy = worse(errors.energy, energy);
        }
        errors.violation = worse(errors.violation, seen.violation);
    }
    errors.judged = all.iter().copied().fold(0.0, worse);
    all.sort_by(f64::total_cmp);
    errors.median = all.get(all.len() / 2).copied().unwrap_or(0.0);
    Some(errors)
}

/// Largest difference of two runs in the judged quantity, at the instants that both have.
pub fn between(a: &[Seen], b: &[Seen], sizes: &Sizes, watched: &[usize]) -> Option<f64> {
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let stride = many.len().checked_sub(1)? / few.len().checked_sub(1)?.max(1);
    let difference = |(a, b): (&Seen, &Seen)| {
        if watched.is_empty() {
            let pairs = a.q.iter().zip(&b.q).zip(&sizes.scales);
            return pairs.map(|((a, b), scale)| (a - b).abs() / scale).fold(0.0, worse);
        }
        let of = |k: &usize| (a.observed.outputs[*k] - b.observed.outputs[*k]).abs() / sizes.outputs[*k];
        watched.iter().map(of).fold(0.0, worse)
    };
    Some(few.iter().zip(many.iter().step_by(stride.max(1))).map(difference).fold(0.0, worse))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::reference::motion::shot_of;
    use crate::erased::exact::Observed;

    fn seen_of(t: f64, qd: f64) -> Seen {
        Seen {
            t,
            q: vec![0.0],
            qd: vec![qd],
            qdd: Vec::new(),
            lambda: Vec::new(),
            states: Vec::new(),
            observed: Observed { reaction: Vec::new(), energy: 0.0, kinetic: 0.0, outputs: Vec::new() },
            violation: 0.0,
        }
    }

    fn contact(t: f64, index: usize, closes: bool) -> Contact {
        Contact { t, index, closes, jumps: false }
    }

    #[test]
    fn contacts_are_matched_one_by_one_and_a_missed_one_is_known() {
        let reference = [contact(0.1, 0, true), contact(0.2, 0, false), contact(0.15, 1, true)];
        let pairs = matched(&[vec![0.1001, 0.2002], vec![0.15]], &reference).expect("as many");
        assert_eq!(pairs.iter().map(|pair| pair.exact).collect::<Vec<_>>(), [0.1, 0.15, 0.2]);
        assert!(matched(&[vec![0.1], vec![0.15]], &reference).is_none());
    }

    #[test]
    fn a_run_is_late_during_a_contact_and_next_to_its_ends_alone() {
        let reference = [contact(0.1, 0, true), contact(0.2, 0, false)];
        let pairs = matched(&[vec![0.101, 0.203]], &reference).expect("as many");
        let near = |t| late(&pairs, t).map(|late| (late * 1e6).round());
        assert_eq!(near(0.05), None);
        assert_eq!(near(0.095), Some(1e3));
        assert_eq!(near(0.15), Some(1e3));
        assert_eq!(near(0.21), Some(3e3));
        assert_eq!(near(0.4), None);
    }

    #[test]
    fn impacts_at_the_end_of_infinitely_many_need_no_counterpart() {
        let jump = |t: f64| Contact { jumps: true, ..contact(t, 0, true) };
        let reference = [jump(1.0), jump(1.5), jump(1.5 + 1e-8), jump(1.5 + 1.1e-8)];
        let pairs = matched(&[vec![1.0 + 1e-5, 1.5]], &reference).expect("the rest is the end");
        assert_eq!(pairs.len(), 2);
        assert!(pairs[0].is_between(1.0 + 5e-6) && !pairs[0].is_between(1.1));
        assert!(matched(&[vec![1.0]], &reference).is_none());
        assert!(matched(&[vec![]], &reference).is_none());
    }

    #[test]
    fn an_instant_between_two_impacts_is_compared_at_the_time_shifted_by_their_error() {
        // A ball falls from rest and bounces with a restitution of 0.5; it reaches the floor at 0.5 s.
        const G: f64 = 9.81;
        let speed =
            |t: f64, impact: f64| if t < impact { -G * t } else { 0.5 * G * impact - G * (t - impact) };
        let run_of = |impact: f64, parts: u32| {
            let times = (0..=parts).map(move |k| f64::from(k) / f64::from(parts));
            times.map(move |t| shot_of(t, vec![0.0], vec![speed(t, impact)], vec![-G]))
        };
        let contacts = vec![Contact { jumps: true, ..contact(0.4987, 0, true) }];
        let shots = run_of(0.4987, 200).collect();
        let reference = Reference { shots, tolerance: 0.0, steps: 0, contacts, stuck: None };
        let sizes = Sizes::of(&reference, [vec![1.0], Vec::new()], &|_, _| Vec::new());
        for impact in [0.5063, 0.4926] {
            let with = |added: f64| {
                let run: Vec<Seen> = run_of(impact, 200)
                    .map(|shot| {
                        let t = shot.at.t.high;
                        let is_between = (t - impact) * (t - 0.4987) < 0.0;
                        let qd = shot.at.qd[0].high + if is_between { added } else { 0.0 };
                        seen_of(t, qd)
                    })
                    .collect();
                errors(&run, &[vec![impact]], &reference, &sizes, &[]).expect("errors")
            };
            let late = impact - 0.4987;
            let (plain, faulty) = (with(0.0), with(1.0));
            assert!((plain.contact - late.abs()).abs() < 1e-15, "{plain:?}");
            // Accelerations are those of the fall, so velocities at the shifted time differ by g times the shift before the impact.
            let own = (G * late).abs() / sizes.rate;
            assert!((plain.rate - own).abs() < 0.6 * own, "{} {own}", plain.rate);
            assert!((faulty.rate - 1.0 / sizes.rate).abs() < 1.6 * own, "{} {own}", faulty.rate);
        }
    }
}

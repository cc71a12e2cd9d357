//! The third leg: a closed form or published digits against both references.

use crate::cost::advice::two_digits;
use crate::cost::errors::apart;
use crate::cost::reference::linear::worse;
use crate::double_double::DoubleDouble as D;
use crate::known_motion::{KnownState, KnownStates};

/// Difference of two times over the span at which both are one instant.
const SAME: f64 = 1e-12;

/// Difference over the error of the third leg and the width of the references, up to which they do not contradict each other.
const AGREEING: f64 = 10.0;

/// An instant of a reference: time (s), q and q̇ (N each).
pub type FollowedInstant<'a> = (f64, &'a [D], &'a [D]);

/// A reference at its instants.
pub struct Followed<'a> {
    /// Name of the reference.
    pub name: &'a str,
    /// Instants.
    pub instants: Vec<FollowedInstant<'a>>,
}

/// A third leg beside the references.
#[derive(Clone, Debug, PartialEq)]
pub struct ThirdLeg {
    /// Origin, in words.
    source: String,
    /// Its own error, in the reference metric.
    error: f64,
    /// Instants of the references that it has.
    instants: usize,
    /// Name of each reference with the largest difference of the coordinates, in the reference metric, and of the velocities, over the
    /// largest; NaN where they are not known.
    differences: Vec<(String, [f64; 2])>,
    /// Difference of the coordinates that it may have from a reference.
    most: f64,
}

impl ThirdLeg {
    /// `known` against `references`, whose difference is `width`, with the scales of the coordinates (N).
    pub fn of(known: &KnownStates, references: &[Followed], scales: &[f64], width: Option<f64>) -> Self {
        let mut instants = 0;
        let differences = references.iter().map(|reference| {
            let span = reference.instants.last().map_or(0.0, |(t, _, _)| t.abs());
            let pairs: Vec<(&KnownState, &FollowedInstant)> = known
                .states
                .iter()
                .filter_map(|state| {
                    let is_same = |found: &&FollowedInstant| (found.0 - state.t).abs() <= SAME * span;
                    Some((state, reference.instants.iter().find(is_same)?))
                })
                .collect();
            instants = instants.max(pairs.len());
            let rates = reference.instants.iter().flat_map(|(_, _, qd)| qd.iter().zip(scales));
            let fastest = rates.map(|(qd, scale)| qd.high.abs() / scale).fold(0.0, f64::max);
            let fastest = if fastest > 0.0 { fastest } else { 1.0 };
            let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(worse).unwrap_or(f64::NAN);
            let of_q = &mut pairs.iter().flat_map(|(state, found)| distances(&state.q, found.1, scales));
            let of_qd = &mut pairs.iter().flat_map(|(state, found)| distances(&state.qd, found.2, scales));
            (reference.name.to_string(), [largest(of_q), largest(of_qd) / fastest])
        });
        let differences = differences.collect();
        let most = AGREEING * known.error.max(width.unwrap_or(0.0));
        ThirdLeg { source: known.source.clone(), error: known.error, instants, differences, most }
    }

    /// Its differences in words.
    pub fn words(&self) -> String {
        let ThirdLeg { source, error, instants, .. } = self;
        if *instants == 0 {
            return format!("{source}: none of its times is an instant of the study; leave `--until` out");
        }
        let from = self.differences.iter().map(|(name, [of_q, of_qd])| {
            let rates =
                if of_qd.is_nan() { String::new() } else { format!(", velocities {}", two_digits(*of_qd)) };
            format!("{} from the {name}{rates}", two_digits(*of_q))
        });
        let times = if *instants == 1 { "1 instant".to_string() } else { format!("{instants} instants") };
        format!(
            "{source}, good to {}: at {times} {}",
            two_digits(*error),
            from.collect::<Vec<_>>().join("; ")
        )
    }

    /// The contradiction in words, where a reference is further away than errors of both allow.
    pub fn contradiction(&self) -> Option<String> {
        // NaN is one.
        let is_near = |(_, [of_q, _]): &(String, [f64; 2])| *of_q <= self.most;
        let is_known = self.instants > 0 && !self.differences.iter().all(is_near);
        is_known.then(|| {
            format!(
                "the third leg and the references contradict each other by more than {}: {}",
                two_digits(self.most),
                self.words()
            )
        })
    }
}

/// Distances of known values from those of a reference, in the reference metric.
fn distances<'a>(known: &'a [f64], exact: &'a [D], scales: &'a [f64]) -> impl Iterator<Item = f64> {
    let pairs = known.iter().zip(exact).zip(scales).filter(|((known, _), _)| !known.is_nan());
    pairs.map(|((known, exact), scale)| apart(*known, *exact) / scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbs_runtime::Scalar;

    fn known(error: f64, q: f64) -> KnownStates {
        let states = vec![
            KnownState { t: 0.25, q: vec![7.0, 7.0], qd: Vec::new() },
            KnownState { t: 0.5, q: vec![q, f64::NAN], qd: vec![4.0, f64::NAN] },
        ];
        KnownStates { source: "a table".to_string(), error, states }
    }

    #[test]
    fn a_third_leg_is_compared_at_its_instants_and_contradicts_where_it_is_far() {
        let [q, qd] = [[2.0, 5.0], [4.0, -8.0]].map(|values| values.map(D::constant));
        let reference =
            Followed { name: "reference", instants: vec![(0.0, &qd, &q), (0.5 + 1e-16, &q, &qd)] };
        let of = |known: &KnownStates, width| {
            ThirdLeg::of(known, std::slice::from_ref(&reference), &[0.5, 1.0], width)
        };
        let leg = of(&known(1e-6, 2.0 + 1e-7), None);
        assert_eq!(leg.contradiction(), None);
        assert_eq!(leg.words(), "a table, good to 1e-6: at 1 instant 2e-7 from the reference, velocities 0");
        assert!(of(&known(1e-9, 2.0 + 1e-7), None).contradiction().is_some());
        assert_eq!(of(&known(1e-9, 2.0 + 1e-7), Some(1e-7)).contradiction(), None);
        assert!(of(&known(1e-9, f64::NAN), None).contradiction().is_some());
        let mut late = known(1e-9, 9.0);
        late.states.pop();
        let leg = of(&late, None);
        assert!(leg.contradiction().is_none() && leg.words().contains("none of its times"), "{leg:?}");
    }
}

//! Mechanisms that samples of an encoder move: lost ones, doubled ones, time stamps that go backwards.

use core::f64::consts::TAU;

use crate::erased::driven_variations::DrivenVariants;
use crate::hard_cases::course::Course;
use crate::hard_cases::judge::{exceeds, of_driven};
use crate::hard_cases::list::description::{Description, MethodKind, Samples};
use crate::hard_cases::list::stored::Miss;
use crate::hard_cases::oracle::{Gap, Oracle, OracleState};
use crate::hard_cases::study::Extent;
use crate::hard_cases::variation::{Class, Variation, VariedParts, numbers};
use crate::hard_cases::verdict::{Outcome, Verdict, larger};
use crate::setting::Numbers;

/// A case with an encoder.
pub struct Encoder<'a> {
    /// The case.
    pub case: &'a Description,
    /// Its encoder.
    pub samples: &'a Samples,
    /// Index of the input.
    pub index: usize,
}

impl Encoder<'_> {
    /// All variants: each has other samples that are lost, doubled or late.
    ///
    /// # Errors
    /// The course of the angle cannot be evaluated.
    pub fn outcomes(
        &self,
        mechanism: &dyn DrivenVariants,
        oracle: &mut Oracle,
        subject: &VariedParts,
        extent: &Extent,
    ) -> Result<Vec<Outcome>, String> {
        let subject = VariedParts { classes: vec![Class::Steps, Class::Single], ..subject.clone() };
        let mut outcomes = Vec::new();
        for (_, seed) in extent.seeds.iter().enumerate().filter(|(index, _)| extent.runs(0, *index)) {
            let variation = Variation { finer: 1.0, ..Variation::of(*seed, &subject) };
            let Some(bound) = self.case.bound(MethodKind::Drives, &variation) else { continue };
            let samples = self.samples(oracle, extent.until, *seed).map_err(|Gap(reason)| reason)?;
            let words = format!(
                "{} samples of {} bits, some lost, doubled or late",
                samples.len(),
                self.samples.bits
            );
            let outcome = Outcome::blank(&Variation { words, ..variation }, "Stepper, closed".to_string());
            outcomes.push(self.outcome(mechanism, oracle, &samples, (outcome, bound)));
        }
        Ok(outcomes)
    }

    fn outcome(
        &self,
        mechanism: &dyn DrivenVariants,
        oracle: &mut Oracle,
        samples: &[(f64, f64)],
        (outcome, bound): (Outcome, f64),
    ) -> Outcome {
        let numbers = if outcome.class == Class::Single { Numbers::Single } else { Numbers::Double };
        let (mut worst, mut wrong, mut course) = (0.0_f64, None, Vec::new());
        let mut refused: Vec<String> = Vec::new();
        let started = mechanism.sampled(numbers, self.index, samples, &mut |number, placed| {
            let placed = match placed {
                Ok(placed) => placed,
                Err(failure) => return refused.push(failure.to_string()),
            };
            course.extend(placed.motion[0].last());
            let state = of_driven(&placed);
            oracle.set(&self.samples.input, samples[number].1);
            match self.error(&state, oracle, outcome.class) {
                Ok(error) if !exceeds(error, bound) => worst = worst.max(error),
                Ok(error) => {
                    wrong.get_or_insert(format!(
                        "sample {number} at t = {:.4} s is off by {error:.1e}",
                        placed.t
                    ));
                }
                Err(Gap(reason)) => {
                    wrong.get_or_insert(format!("a known value cannot be compared: {reason}"));
                }
            }
        });
        let (verdict, reason) = match (started, wrong, refused.first()) {
            (Err(failure), ..) => (Verdict::Refused, failure.to_string()),
            (Ok(()), Some(wrong), _) => (Verdict::Wrong, wrong),
            (Ok(()), None, Some(first)) => {
                (Verdict::Refused, format!("{} of {} samples: {first}", refused.len(), samples.len()))
            }
            (Ok(()), None, None) => (Verdict::Right, String::new()),
        };
        let (error, bound) = (Some(worst), Some(bound));
        Outcome {
            verdict,
            reason,
            error,
            bound,
            work: samples.len() as u64,
            course: Course::of_place(course),
            ..outcome
        }
    }

    /// Largest open row, and largest miss of a known value.
    fn error(&self, state: &OracleState, oracle: &Oracle, class: Class) -> Result<f64, Gap> {
        let known = self.case.worst(core::slice::from_ref(state), oracle, class)?;
        let known = known.map_or(0.0, |Miss { error, .. }| error);
        let rows = oracle.rows(state)?.into_iter().map(|row| row.phi.unwrap_or(0.0).abs());
        Ok(rows.fold(known, larger))
    }

    /// Time stamps (s) and angles (rad) of the samples of a variant.
    fn samples(&self, oracle: &Oracle, until: f64, seed: u64) -> Result<Vec<(f64, f64)>, Gap> {
        let Samples { course, rate, bits, dropped, doubled, backwards, .. } = self.samples;
        let mut random = numbers(seed);
        let step = TAU / 2.0_f64.powi(*bits);
        let mut samples = Vec::new();
        for k in 0..=(until * rate) as u32 {
            let t = f64::from(k) / rate;
            let zeros = vec![0.0; oracle.size()];
            let state =
                OracleState { t, q: zeros.clone(), qd: zeros.clone(), qdd: zeros, ..OracleState::default() };
            let asked = oracle.quantities(course, &state)?.first().map_or(f64::NAN, |found| found.value);
            let angle = step * (asked / step).round();
            let chance = random.uniform(0.0, 1.0);
            if k > 0 && chance < *dropped {
                continue;
            }
            let stamp = if k > 2 && random.uniform(0.0, 1.0) < *backwards { t - 2.0 / rate } else { t };
            samples.push((stamp, angle));
            if random.uniform(0.0, 1.0) < *doubled {
                samples.push((stamp, angle));
            }
        }
        Ok(samples)
    }
}

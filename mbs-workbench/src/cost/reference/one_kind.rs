//! References by explicit methods of the runtime in double-double numbers: of effects whose modes the other references do not decide.

use std::time::{Duration, Instant};

use mbs_runtime::Scalar;

use super::motion::{Contact, Leg, Reference, Shot, Stuck};
use crate::double_double::DoubleDouble as D;
use crate::erased::costs::OneKind;
use crate::erased::exact::{Moving, Observed};
use crate::erased::timed_runs::Seen;
use crate::setting::{FormulationName, IntegratorName, MotionMethod, Resolution};

/// Tolerances of a leg, from coarse to fine: a run is made where the one before tells that it is in time.
const TOLERANCES: [f64; 4] = [1e-9, 1e-11, 1e-13, 1e-15];

/// Order by which the time of a run grows with its tolerance, at least.
fn order(leg: Leg) -> f64 {
    match leg {
        Leg::Order5 => 5.0,
        Leg::Order8 | Leg::Extrapolated | Leg::Collocated => 8.0,
    }
}

/// Formulations beside projection, the preferred one first.
const OTHERS: [FormulationName; 2] = [FormulationName::VelocityTransformation, FormulationName::Baumgarte];

/// Method of a leg of one kind.
pub fn method(of: &OneKind, leg: Leg) -> MotionMethod {
    let by = |name| MotionMethod::Explicit(name, IntegratorName::DormandPrince5);
    let other = OTHERS.into_iter().map(by).find(|method| of.runs.admits(*method));
    match leg {
        Leg::Order5 => other.unwrap_or(by(FormulationName::Projection)),
        Leg::Order8 | Leg::Extrapolated | Leg::Collocated => {
            MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8)
        }
    }
}

/// The motion through `times` (s) by `leg` with the least tolerance from `least` on that is in time, and the one of a coarser tolerance.
pub fn of_one_kind(
    of: &OneKind,
    leg: Leg,
    times: &[f64],
    least: f64,
    budget: Duration,
) -> (Reference, Option<Reference>) {
    let (mut found, mut coarser): (Option<Reference>, Option<Reference>) = (None, None);
    for tolerance in TOLERANCES.into_iter().filter(|tolerance| *tolerance >= 0.99 * least) {
        let began = Instant::now();
        let next = run(of, leg, times, tolerance);
        let time = began.elapsed();
        match (&next.stuck, found.take()) {
            // A finer run that fails leaves the one before.
            (Some(_), Some(before)) => {
                found = Some(before);
                break;
            }
            (Some(_), None) => return (next, None),
            (None, before) => (found, coarser) = (Some(next), before.or(coarser)),
        }
        if time.mul_f64(100.0_f64.powf(1.0 / order(leg))) > budget {
            break;
        }
    }
    (found.unwrap_or_else(|| stopped(Stuck::OutOfTime, TOLERANCES[0])), coarser)
}

fn stopped(stuck: Stuck, tolerance: f64) -> Reference {
    Reference { shots: Vec::new(), tolerance, steps: 0, contacts: Vec::new(), stuck: Some(stuck) }
}

fn run(of: &OneKind, leg: Leg, times: &[f64], tolerance: f64) -> Reference {
    let (method, resolution) = (method(of, leg), Resolution::Tolerance(tolerance));
    let mut shots = Vec::new();
    let ran = of.runs.run(method, resolution, times, Some(&mut |seen| shots.push(shot(seen))));
    let contacts = ran.and_then(|effort| Ok((effort, of.runs.contacts(method, resolution, times)?)));
    match contacts {
        Ok((effort, found)) => {
            let [soft, rigid] = of.contacts;
            let changes = found.iter().enumerate().flat_map(|(index, times)| {
                let (closes, jumps) = (index < soft + rigid, (soft..soft + rigid).contains(&index));
                times.iter().map(move |t| Contact { t: *t, index, closes, jumps })
            });
            let mut contacts: Vec<Contact> = changes.collect();
            contacts.sort_by(|a, b| a.t.total_cmp(&b.t));
            Reference { shots, tolerance, steps: effort.steps, contacts, stuck: None }
        }
        Err(failure) => Reference { shots, ..stopped(Stuck::Refused(failure.to_string()), tolerance) },
    }
}

fn shot(seen: Seen) -> Shot {
    let exact = |values: &[f64]| values.iter().map(|value| D::constant(*value)).collect::<Vec<D>>();
    let Observed { reaction, energy, kinetic, outputs } = &seen.observed;
    Shot {
        at: Moving {
            t: D::constant(seen.t),
            q: exact(&seen.q),
            qd: exact(&seen.qd),
            states: exact(&seen.states),
        },
        qdd: exact(&seen.qdd),
        lambda: exact(&seen.lambda),
        observed: Observed {
            reaction: exact(reaction),
            energy: D::constant(*energy),
            kinetic: D::constant(*kinetic),
            outputs: exact(outputs),
        },
    }
}

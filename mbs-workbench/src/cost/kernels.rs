//! Points of kinematics with other sines: a program that was built with them writes its points to a file, another one reads them.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::cost::points::{Errors, Outcome, Point, Verdict};
use crate::erased::timed_runs::Effort;
use crate::setting::{Closing, Kernel, Numbers, Setting};

/// A point of kinematics in a file. Numbers that are none are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Written {
    is_single: bool,
    lanes: u32,
    most_evaluations: Option<u32>,
    steps: u32,
    refused: Option<String>,
    is_wrong: bool,
    /// Of q, its median, q̇ and q̈.
    errors: [Option<f64>; 4],
    evaluations: u64,
    taken: u64,
    nanoseconds: f64,
}

/// `points` as text for [`read`].
pub fn written(points: &[Point]) -> String {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let of = |point: &Point| {
        let Setting::Kinematics { numbers, lanes, closing, steps, .. } = point.setting else { return None };
        let (refused, errors, is_wrong) = match &point.outcome {
            Outcome::Refused(reason) => (Some(reason.clone()), [None; 4], false),
            Outcome::Done { errors, verdict, .. } => {
                let errors = [errors.judged, errors.median, errors.rate, errors.second].map(finite);
                (None, errors, *verdict == Verdict::Wrong)
            }
        };
        Some(Written {
            is_single: numbers == Numbers::Single,
            lanes,
            most_evaluations: match closing {
                Closing::Closed => None,
                Closing::Evaluations(most) => Some(most),
            },
            steps,
            refused,
            is_wrong,
            errors,
            evaluations: point.effort.evaluations,
            taken: point.effort.steps,
            nanoseconds: point.effort.elapsed.as_secs_f64() * 1e9,
        })
    };
    let all: Vec<Written> = points.iter().filter_map(of).collect();
    serde_json::to_string(&all).unwrap_or_default()
}

/// Points that [`written`] made, in a program with the sines of `kernel`.
///
/// # Errors
/// The text is no list of points, in words.
pub fn read(text: &str, kernel: Kernel) -> Result<Vec<Point>, String> {
    let all: Vec<Written> = serde_json::from_str(text).map_err(|error| error.to_string())?;
    Ok(all.into_iter().map(|written| point(written, kernel)).collect())
}

fn point(written: Written, kernel: Kernel) -> Point {
    let Written {
        is_single,
        lanes,
        most_evaluations,
        steps,
        refused,
        is_wrong,
        errors,
        evaluations,
        taken,
        nanoseconds,
    } = written;
    let [judged, median, rate, second] = errors.map(|error| error.unwrap_or(f64::NAN));
    let verdict = if is_wrong { Verdict::Wrong } else { Verdict::Right };
    let known = Errors { judged, median, rate, second, energy: 0.0, violation: 0.0, ..Errors::unknown() };
    let outcome = match refused {
        Some(reason) => Outcome::Refused(reason),
        None => Outcome::Done { errors: known, expected: None, verdict },
    };
    let numbers = if is_single { Numbers::Single } else { Numbers::Double };
    let closing = most_evaluations.map_or(Closing::Closed, Closing::Evaluations);
    let elapsed = Duration::from_secs_f64(nanoseconds.max(0.0) * 1e-9);
    Point {
        setting: Setting::Kinematics { numbers, lanes, closing, steps, kernel },
        outcome,
        effort: Effort { evaluations, steps: taken, elapsed, ..Effort::default() },
        time: nanoseconds / taken.max(1) as f64,
        perturbed: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_as_they_were_written_with_their_sines() {
        let setting = |kernel| Setting::Kinematics {
            numbers: Numbers::Single,
            lanes: 8,
            closing: Closing::Evaluations(2),
            steps: 36,
            kernel,
        };
        let errors = Errors { judged: 1e-5, median: 1e-6, rate: 2e-5, second: f64::NAN, ..Errors::unknown() };
        let effort =
            Effort { evaluations: 72, steps: 36, elapsed: Duration::from_nanos(7200), ..Effort::default() };
        let done = Outcome::Done { errors, expected: None, verdict: Verdict::Wrong };
        let points = [done, Outcome::Refused("no".to_string())].map(|outcome| Point {
            setting: setting(Kernel::Own),
            outcome,
            effort,
            time: 200.0,
            perturbed: None,
        });
        let found = read(&written(&points), Kernel::Library).expect("a list");
        assert_eq!(
            found.iter().map(|point| point.setting).collect::<Vec<_>>(),
            [setting(Kernel::Library); 2]
        );
        let Outcome::Done { errors: back, verdict: Verdict::Wrong, .. } = found[0].outcome else {
            panic!("it was done")
        };
        assert_eq!((back.judged, back.median, back.rate), (1e-5, 1e-6, 2e-5));
        assert!(back.second.is_nan() && (found[0].time - 200.0).abs() < 1e-6);
        assert!(matches!(&found[1].outcome, Outcome::Refused(reason) if reason == "no"));
        assert!(read("nothing", Kernel::Library).is_err());
    }
}

//! Points of the study: a setting with its true error, its time and its counts.

use crate::erased::timed_runs::Effort;
use crate::setting::{FormulationName, Kernel, MotionMethod, Numbers, Setting};

/// Errors of a run at its instants: the largest counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of the quantity that is judged: coordinates in the reference metric, or the watched outputs.
    pub judged: f64,
    /// Width of the reference where that error is below 100 widths, and known with it alone; else 0.
    pub width: f64,
    /// Its median over the instants.
    pub median: f64,
    /// Of velocities, over the largest of the motion.
    pub rate: f64,
    /// Of accelerations (drives), or of Φ_qᵀ λ (forces), over the largest of the motion.
    pub second: f64,
    /// Of the multipliers that are unique, over the largest of the motion; NaN where none is.
    pub multiplier: f64,
    /// Largest error (s) of the times at which contacts close or open and events of the text begin or end; infinite where one is missed,
    /// NaN where there are none.
    pub contact: f64,
    /// Of the energy, over the largest kinetic energy of the motion; 0 where there are no masses.
    pub energy: f64,
    /// Largest violation of a row in the reference metric.
    pub violation: f64,
}

impl Errors {
    /// Nothing is known: all NaN.
    pub fn unknown() -> Self {
        let none = f64::NAN;
        Errors {
            judged: none,
            width: 0.0,
            median: none,
            rate: none,
            second: none,
            multiplier: none,
            contact: none,
            energy: none,
            violation: none,
        }
    }
}

/// Judgement of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The error is what the neighbouring points let expect.
    Right,
    /// The error is below 100 widths of the reference: it is known with that width alone.
    Hollow,
    /// An error of more than ten times the expected one, of which there is a warning: by the run itself, by an estimate that is not
    /// trusted, or by a method that changes the problem.
    Untrusted,
    /// `Ok` with an error of more than ten times the expected one.
    Wrong,
}

/// Error that other points of a curve let expect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// The error.
    pub error: f64,
    /// `true` where it is trusted: as [`ErrorEstimate`](mbs_runtime::dynamics::ErrorEstimate) is, for adaptive steps.
    pub is_trusted: bool,
}

/// Result of a setting.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It went through.
    Done {
        /// True errors.
        errors: Errors,
        /// Error that other points of its curve let expect; none where there are none.
        expected: Option<Expected>,
        /// Judgement.
        verdict: Verdict,
    },
    /// It ended with a failure, in words.
    Refused(String),
}

/// A setting with its result.
#[derive(Clone, Debug)]
pub struct Point {
    /// The setting.
    pub setting: Setting,
    /// Result.
    pub outcome: Outcome,
    /// Counts and the shortest time.
    pub effort: Effort,
    /// Time (µs) a second of the motion; of kinematics a step (ns).
    pub time: f64,
    /// Largest error for perturbed parameters, of points on the front of motions from forces.
    pub perturbed: Option<f64>,
}

impl Point {
    /// `true` for a run of one mechanism with the runtime's own sines; lanes are of use for many at once.
    pub fn is_single(&self) -> bool {
        matches!(
            self.setting,
            Setting::Motion { .. } | Setting::Kinematics { lanes: 1, kernel: Kernel::Own, .. }
        )
    }

    /// `true` for many mechanisms at once, with the runtime's own sines.
    fn is_in_lanes(&self) -> bool {
        matches!(self.setting, Setting::Kinematics { lanes: 2.., kernel: Kernel::Own, .. })
    }

    /// `true` for a setting to choose: without a stabilisation the error grows with the time, however small it is at the end.
    pub fn is_advised(&self) -> bool {
        let method = match self.setting {
            Setting::Motion { method, .. } => Some(method),
            Setting::Kinematics { .. } => None,
        };
        let is_unstabilized =
            matches!(method, Some(MotionMethod::Explicit(FormulationName::Unstabilized, _)));
        self.is_single() && !is_unstabilized
    }

    /// The largest error that it may have, where it is trusted: with the width of the reference.
    pub fn bound(&self) -> Option<f64> {
        match &self.outcome {
            Outcome::Done { errors, .. } => self.error().map(|error| error + errors.width),
            Outcome::Refused(_) => None,
        }
    }

    /// Its error, where it is trusted.
    pub fn error(&self) -> Option<f64> {
        match &self.outcome {
            Outcome::Done { errors, verdict: Verdict::Right | Verdict::Hollow, .. } => Some(errors.judged),
            _ => None,
        }
    }
}

/// Error over the expected one that makes a point wrong.
pub const WRONG: f64 = 10.0;

/// Judges the points of a curve of equal steps, from coarse to fine, by what the order of the method predicts from finer ones. It is the larger of
/// the predictions from the next two, for one alone may be small by chance. More than ten times that, and more than `rounding`, is wrong; or
/// untrusted where there is a warning of the point (`is_warned`). A finer point with other events than the reference is not in the range of its
/// order, so its prediction is not trusted.
pub fn judge_by_order(
    points: &mut [Point],
    order: i32,
    rounding: f64,
    steps: impl Fn(&Point) -> f64,
    is_warned: impl Fn(&Point) -> bool,
) {
    for index in 1..points.len() {
        let (before, rest) = points.split_at_mut(index);
        let ([.., point], [next, ..]) = (before, &*rest) else { continue };
        let own = steps(point);
        let predicted = |finer: &Point| match finer.outcome {
            Outcome::Done { errors, .. } => {
                Some((errors.judged * (steps(finer) / own).powi(order), errors.contact.is_infinite()))
            }
            Outcome::Refused(_) => None,
        };
        let Some((first, has_other_events)) = predicted(next) else { continue };
        let error = rest.get(1).and_then(predicted).map_or(first, |(second, _)| first.max(second));
        let doubted = has_other_events || is_warned(point);
        let Outcome::Done { errors, expected, verdict: verdict @ Verdict::Right } = &mut point.outcome else {
            continue;
        };
        *expected = Some(Expected { error, is_trusted: !has_other_events });
        if errors.judged > (WRONG * error).max(rounding) || errors.judged.is_nan() {
            *verdict = if doubted { Verdict::Untrusted } else { Verdict::Wrong };
        }
    }
}

/// Share of the best error so far that a dearer point must stay below to be on the front: what differs by less is the same.
const GAIN: f64 = 0.7;

/// Errors above it are no accuracy.
pub const COARSEST: f64 = 0.1;

/// Indices of the points of one mechanism that no other one beats in error and time, from coarse to fine.
pub fn front(points: &[Point]) -> Vec<usize> {
    front_of(points, Point::is_single)
}

/// Indices of the points to choose from, of which each may be the cheapest for some error. They are the front of those that are advised, and that of
/// `f64` alone. For no error below 100 ε of `f32` is advised with it.
pub fn advised_front(points: &[Point]) -> Vec<usize> {
    let is_double = |point: &Point| point.is_advised() && point.setting.numbers() == Numbers::Double;
    let mut front = front_of(points, Point::is_advised);
    front.extend(front_of(points, is_double));
    front.sort_unstable();
    front.dedup();
    front
}

/// The front of the points that are `chosen`.
fn front_of(points: &[Point], chosen: impl Fn(&Point) -> bool) -> Vec<usize> {
    let mut known: Vec<(usize, f64, f64)> = points
        .iter()
        .enumerate()
        .filter(|(_, point)| chosen(point))
        .filter_map(|(index, point)| Some((index, point.error()?, point.time)))
        .filter(|(_, error, time)| *error <= COARSEST && time.is_finite())
        .collect();
    known.sort_by(|a, b| a.2.total_cmp(&b.2).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    let mut front = Vec::new();
    for (index, error, _) in known {
        if error < GAIN * best {
            best = error;
            front.push(index);
        }
    }
    front
}

/// Error asked for over that of a setting which is advised: other parameters change errors by up to this factor.
const MARGIN: f64 = 2.0;

/// Least error for which a type of number is advised, over its ε: parameters are rounded to it, and those of a text may be round by chance.
/// That of `with_accuracy`.
const ROUNDINGS: f64 = 100.0;

/// The cheapest trusted point of one mechanism that reaches `asked` with a margin.
pub fn cheapest(points: &[Point], asked: f64) -> Option<&Point> {
    reaching(points, asked).filter(|point| point.is_advised()).min_by(|a, b| a.time.total_cmp(&b.time))
}

/// The cheapest trusted point of many mechanisms at once that reaches `asked` with a margin; its time is that of one.
pub fn cheapest_in_lanes(points: &[Point], asked: f64) -> Option<&Point> {
    reaching(points, asked).filter(|point| point.is_in_lanes()).min_by(|a, b| a.time.total_cmp(&b.time))
}

/// The cheapest trusted point of one mechanism with these sines that reaches `asked` with a margin.
pub fn cheapest_with(points: &[Point], asked: f64, kernel: Kernel) -> Option<&Point> {
    let is_of = |point: &&Point| matches!(point.setting, Setting::Kinematics { lanes: 1, kernel: own, .. } if own == kernel);
    reaching(points, asked).filter(is_of).min_by(|a, b| a.time.total_cmp(&b.time))
}

/// Points whose error is below `asked`, for perturbed parameters too. Where these were not run, the margin and the next finer point of the
/// curve stand for them: where finer steps make it worse, rounding decides, and the point is small by chance.
fn reaching(points: &[Point], asked: f64) -> impl Iterator<Item = &Point> {
    let is_below =
        move |point: &Point, margin: f64| point.bound().is_some_and(|error| margin * error <= asked);
    let has_runs = points.iter().any(|point| point.perturbed.is_some());
    points.iter().enumerate().filter_map(move |(index, point)| {
        if asked < ROUNDINGS * point.setting.numbers().epsilon() {
            return None;
        }
        if has_runs && point.is_single() {
            let is_sure = point.perturbed.is_some_and(|error| error <= asked) && is_below(point, 1.0);
            return is_sure.then_some(point);
        }
        let curve = point.setting.curve();
        let finer = points.get(index + 1).filter(|finer| finer.setting.curve() == curve);
        let finer = finer.is_none_or(|finer| finer.error().is_none() || is_below(finer, MARGIN));
        (is_below(point, MARGIN) && finer).then_some(point)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::Closing;

    fn point(error: f64, time: f64, verdict: Verdict) -> Point {
        let setting = Setting::Kinematics {
            numbers: Numbers::Double,
            lanes: 1,
            closing: Closing::Closed,
            steps: 1,
            kernel: Kernel::Own,
        };
        let errors = Errors { judged: error, ..Errors::default() };
        let outcome = Outcome::Done { errors, expected: None, verdict };
        Point { setting, outcome, effort: Effort::default(), time, perturbed: None }
    }

    #[test]
    fn the_front_has_what_nothing_beats() {
        let points = [
            point(1e-3, 1.0, Verdict::Right),
            point(1e-2, 2.0, Verdict::Right),
            point(1e-6, 3.0, Verdict::Right),
            point(1e-9, 2.5, Verdict::Wrong),
            point(1e-8, 9.0, Verdict::Hollow),
        ];
        assert_eq!(front(&points), [0, 2, 4]);
        assert!(cheapest(&points, 1e-12).is_none());
    }

    #[test]
    fn a_point_of_f32_hides_none_of_f64_from_the_choice() {
        let mut points = [point(0.0, 1.0, Verdict::Right), point(1e-9, 2.0, Verdict::Right)];
        let Setting::Kinematics { numbers, .. } = &mut points[0].setting else { panic!("of kinematics") };
        *numbers = Numbers::Single;
        assert_eq!((front(&points), advised_front(&points)), (vec![0], vec![0, 1]));
        points.iter_mut().for_each(|point| point.perturbed = point.error());
        assert_eq!(cheapest(&points, 1e-6).map(|point| point.time), Some(2.0));
    }

    #[test]
    fn the_width_of_the_reference_counts_in_the_advice() {
        let mut points = [point(1e-9, 1.0, Verdict::Hollow), point(2e-8, 2.0, Verdict::Right)];
        assert_eq!(cheapest(&points, 1e-7).map(|point| point.time), Some(1.0));
        let Outcome::Done { errors, .. } = &mut points[0].outcome else { panic!("it was done") };
        errors.width = 1e-6;
        assert_eq!(cheapest(&points, 1e-7).map(|point| point.time), Some(2.0));
    }

    #[test]
    fn a_point_is_wrong_above_ten_times_what_its_order_predicts_from_finer_ones() {
        let judged = |errors: &[f64], is_warned: bool| {
            let mut points: Vec<Point> =
                errors.iter().map(|error| point(*error, 1.0, Verdict::Right)).collect();
            for (index, point) in points.iter_mut().enumerate() {
                point.effort.steps = 10 << index;
            }
            judge_by_order(&mut points, 4, 1e-10, |point| point.effort.steps as f64, |_| is_warned);
            let verdict = |point: Point| match point.outcome {
                Outcome::Done { verdict, .. } => verdict,
                Outcome::Refused(_) => panic!("it was done"),
            };
            points.into_iter().map(verdict).collect::<Vec<_>>()
        };
        use Verdict::{Right, Untrusted, Wrong};
        // Order 4, a lower order, and rounding.
        assert_eq!(judged(&[1.6e-3, 1e-4, 6e-6], false), [Right; 3]);
        assert_eq!(judged(&[1e-3, 5e-4, 2.5e-4], false), [Right; 3]);
        assert_eq!(judged(&[9e-11, 1e-16], false), [Right; 2]);
        // 161 times the finer one; also a number that is none.
        assert_eq!(judged(&[1.61e-2, 1e-4, 6e-6], false), [Wrong, Right, Right]);
        assert_eq!(judged(&[f64::NAN, 1e-4], false), [Wrong, Right]);
        assert_eq!(judged(&[1.61e-2, 1e-4], true), [Untrusted, Right]);
        // The second is small by chance, which the third tells.
        assert_eq!(judged(&[1.5e-4, 7e-7, 2.3e-7, 1e-8], false), [Right; 4]);
        assert_eq!(judged(&[4.3e-4, 1.8e-7, 3.8e-8, 2e-9], false), [Wrong, Right, Right, Right]);
    }

    #[test]
    fn the_order_of_a_run_with_other_events_predicts_nothing() {
        let verdict = |contacts: [f64; 2]| {
            let mut points = [2e-1, 5e-3].map(|error| point(error, 1.0, Verdict::Right));
            for (index, (point, time)) in points.iter_mut().zip(contacts).enumerate() {
                let Outcome::Done { errors, .. } = &mut point.outcome else { panic!("it was done") };
                errors.contact = time;
                point.effort.steps = 480 << index;
            }
            judge_by_order(&mut points, 1, 1e-10, |point| point.effort.steps as f64, |_| false);
            match points[0].outcome {
                Outcome::Done { verdict, expected: Some(expected), .. } => (verdict, expected.is_trusted),
                _ => panic!("it was done"),
            }
        };
        let missed = f64::INFINITY;
        assert_eq!(verdict([missed, missed]), (Verdict::Untrusted, false));
        // A coarse run that misses an event which the finer one has is wrong, as is one with all of them.
        assert_eq!(verdict([missed, 1e-3]), (Verdict::Wrong, true));
        assert_eq!(verdict([1e-2, 1e-3]), (Verdict::Wrong, true));
        assert_eq!(verdict([f64::NAN, f64::NAN]), (Verdict::Wrong, true));
    }

    #[test]
    fn the_advice_has_a_margin_and_is_no_chance() {
        let points = [
            point(1e-3, 1.0, Verdict::Right),
            point(4e-7, 2.0, Verdict::Right),
            point(3e-6, 3.0, Verdict::Right),
            point(8e-7, 4.0, Verdict::Right),
            point(1e-8, 5.0, Verdict::Right),
        ];
        // The second is followed by a worse one, the fourth has no margin.
        assert_eq!(cheapest(&points, 1e-6).map(|point| point.time), Some(5.0));
        assert_eq!(cheapest(&points, 1e-5).map(|point| point.time), Some(2.0));
        // Runs for other parameters tell more.
        let mut points = points;
        points[1].perturbed = Some(2e-6);
        points[3].perturbed = Some(9e-7);
        assert_eq!(cheapest(&points, 1e-6).map(|point| point.time), Some(4.0));
    }
}

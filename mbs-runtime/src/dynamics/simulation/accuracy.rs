//! Errors of adaptive runs: an estimate beside the run, and a run to a wanted error.

use crate::dynamics::first_order_form::explicit::Explicit;
use crate::dynamics::integrators::embedded::Embedded;
use crate::dynamics::model::Formulation;
use crate::dynamics::model::metric::Tolerance;
use crate::dynamics::simulation::Simulation;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::accuracy;

/// An adaptive run with two runs beside it, made by [`Simulation::with_error_estimate`].
///
/// A run of a tenth of the tolerance differs from it by its error. A run of ten times the tolerance tells if errors follow the tolerance.
/// They do not where a motion is chaotic, where steps are too long for a force, or at rounding.
#[derive(Clone, Copy)]
pub struct Estimated<S: Dynamic<R, N, M>, X, R: Real, const N: usize, const M: usize> {
    run: Simulation<S, X, R, N, M>,
    /// Runs of ten times and of a tenth of the tolerance; none after one of them failed.
    beside: Option<[Simulation<S, X, R, N, M>; 2]>,
    /// Largest differences so far: of the coarse run and the run, and of the run and the fine one.
    differences: [R; 2],
    /// Right-hand sides of both runs beside it.
    evaluations: u64,
}

/// Estimated error of a run, in the reference metric (rad, reference lengths).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorEstimate<R> {
    /// An error at least 0.3 times and at most 30 times the true one.
    Trusted(R),
    /// A number that no such bounds hold for: errors do not follow the tolerance.
    Untrusted(R),
}

impl<R: Real> ErrorEstimate<R> {
    /// That of the middle one of three runs, each of a tenth of the tolerance of the one before. `looser` is the largest difference of the
    /// first two, `tighter` of the last two. `steps` are those that all three accepted.
    ///
    /// It is twice `tighter`: where errors at least halve from run to run, those of all finer runs add up to no more. It is trusted where
    /// the steps differ enough to tell an error, the differences fall, and the error is not above 0.1.
    pub fn of([looser, tighter]: [R; 2], steps: [u32; 3]) -> Self {
        let estimate = tighter + tighter;
        let [least, most] = accuracy::FALLS.map(R::constant);
        let falls = least * tighter <= looser && looser <= most * tighter;
        let is_small = estimate <= R::constant(accuracy::COARSEST);
        let [coarse, own, fine] = steps;
        if falls && is_small && is_more(coarse, own) && is_more(own, fine) {
            ErrorEstimate::Trusted(estimate)
        } else {
            ErrorEstimate::Untrusted(estimate)
        }
    }

    /// The number, trusted or not.
    pub fn value(self) -> R {
        match self {
            ErrorEstimate::Trusted(value) | ErrorEstimate::Untrusted(value) => value,
        }
    }

    /// The error, where it is trusted.
    pub fn trusted(self) -> Option<R> {
        match self {
            ErrorEstimate::Trusted(value) => Some(value),
            ErrorEstimate::Untrusted(_) => None,
        }
    }
}

/// Remainder of a geometric series behind two of its differences, which fall by 3 at least. A fall that is faster than the largest that is
/// trusted may be chance, and one that no order of a method explains does not go on.
fn left_of<R: Real>(looser: R, tighter: R) -> R {
    let [least, trusted, steep] =
        [accuracy::FALLS_TO_ERROR[0], accuracy::TRUSTED, accuracy::STEEP].map(R::constant);
    let fall = if steep * tighter < looser { least } else { (looser / tighter).min(trusted) };
    tighter / (fall - R::constant(1.0))
}

/// `true` where `many` steps are so many more than `few` that the difference of both runs tells an error.
fn is_more(few: u32, many: u32) -> bool {
    f64::from(many) >= accuracy::FINER * f64::from(few)
}

/// An adaptive run to a wanted error, made by [`Simulation::with_accuracy`].
#[derive(Clone, Copy)]
pub struct Accurate<S: Dynamic<R, N, M>, X, R: Real, const N: usize, const M: usize> {
    run: Simulation<S, X, R, N, M>,
    accuracy: R,
    estimate: Option<R>,
    /// Right-hand sides of all runs.
    evaluations: u64,
}

impl<S, I, F, R, const N: usize, const M: usize> Simulation<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M> + Clone,
    R: Real,
{
    /// With runs of a tenth and of ten times the tolerance beside it, which tell the error.
    ///
    /// ```
    /// use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
    /// use mbs_runtime::mechanism;
    ///
    /// # mechanism! {
    /// #     /// A pendulum of a rod.
    /// #     pub mechanism Pendulum;
    /// #     coord phi: rad = -1;
    /// #     body rod { mass: 1, com: 0.5m*unit(phi), inertia: 1/12, angle: phi }
    /// #     gravity weight { acceleration: [0, -9.81] }
    /// #     start phi = -60deg rate 0;
    /// # }
    ///
    /// let method = Explicit::new(DormandPrince8, Projection::default());
    /// let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    /// let mut run = run.with_tolerance(Tolerance::new(1e-9)).with_error_estimate();
    /// run.advance_to(2.0)?;
    /// assert!(run.error_estimate().value() < 1e-6);
    /// # Ok::<(), mbs_runtime::Failure>(())
    /// ```
    pub fn with_error_estimate(self) -> Estimated<S, Explicit<I, F>, R, N, M> {
        let Tolerance { relative, absolute } = self.tolerance;
        let with = |ratio: R| {
            let tolerance = Tolerance { relative: ratio * relative, absolute: ratio * absolute };
            self.clone().with_tolerance(tolerance)
        };
        let ratio = R::constant(accuracy::RATIO);
        // No finer than numbers of this type can keep to, and a little more for rounding.
        let least = R::constant(accuracy::ABOVE_LEAST) * Tolerance::<R>::least();
        let finer = (least / (relative + absolute)).max(R::constant(1.0) / ratio);
        let beside = Some([with(ratio), with(finer)]);
        Estimated { beside, run: self, differences: [R::constant(0.0); 2], evaluations: 0 }
    }

    /// With a wanted error in place of a tolerance of steps. It is at most `accuracy` at the end of each
    /// [`advance_to`](Accurate::advance_to), in the reference metric (rad, reference lengths).
    ///
    /// ```
    /// use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
    /// use mbs_runtime::{FailureKind, mechanism};
    ///
    /// # mechanism! {
    /// #     /// A pendulum of a rod.
    /// #     pub mechanism Pendulum;
    /// #     coord phi: rad = -1;
    /// #     body rod { mass: 1, com: 0.5m*unit(phi), inertia: 1/12, angle: phi }
    /// #     gravity weight { acceleration: [0, -9.81] }
    /// #     start phi = -60deg rate 0;
    /// # }
    ///
    /// let method = Explicit::new(DormandPrince8, Projection::default());
    /// let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    /// let mut run = run.with_accuracy(1e-8)?;
    /// run.advance_to(2.0)?;
    /// assert!(run.error_estimate() <= Some(1e-8));
    /// assert!(run.with_accuracy(1e-30).is_err_and(|failure| {
    ///     matches!(failure.kind, FailureKind::Unreachable { .. })
    /// }));
    /// # Ok::<(), mbs_runtime::Failure>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidMethodParameter`](FailureKind::InvalidMethodParameter) for NaN, for 0 and less, and above 0.1;
    /// [`Unreachable`](FailureKind::Unreachable) below 100 ε.
    pub fn with_accuracy(self, accuracy: R) -> Result<Accurate<S, Explicit<I, F>, R, N, M>, Failure> {
        let most = R::constant(accuracy::COARSEST);
        if !(R::constant(0.0) < accuracy && accuracy <= most) {
            let (value, most) = (accuracy.to_f64(), most.to_f64());
            return Err(FailureKind::InvalidMethodParameter { name: "accuracy", value, most }.without_time());
        }
        let least = accuracy::LEAST.of::<R>();
        if accuracy < least {
            let (accuracy, best) = (accuracy.to_f64(), least.to_f64());
            return Err(FailureKind::Unreachable { accuracy, best }.without_time());
        }
        Ok(Accurate { run: self, accuracy, estimate: None, evaluations: 0 })
    }
}

/// Instants of a run at which it is compared: at few runs may agree by chance.
const INSTANTS: usize = 16;

/// Coordinates of a run at instants of equal distance, the end included.
type Course<R, const N: usize> = [[R; N]; INSTANTS];

/// A run with its course.
type Followed<S, I, F, R, const N: usize, const M: usize> =
    (Simulation<S, Explicit<I, F>, R, N, M>, Course<R, N>);

/// Moves `run` on to `until` (s); its coordinates on the way.
fn followed<S, I, F, R, const N: usize, const M: usize>(
    run: &mut Simulation<S, Explicit<I, F>, R, N, M>,
    until: R,
) -> Result<Course<R, N>, Failure>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    let mut course = [run.now.y.q; INSTANTS];
    let mut places = course.iter_mut();
    run.sample(until, INSTANTS as u32, |instant| {
        if let Some(place) = places.next() {
            *place = instant.y.q;
        }
    })?;
    Ok(course)
}

/// Largest difference of two courses in the reference metric with these scales of the coordinates (N).
fn difference<R: Real, const N: usize>(a: &Course<R, N>, b: &Course<R, N>, scales: &[R; N]) -> R {
    let pairs = a.iter().flatten().zip(b.iter().flatten()).zip(scales.iter().cycle());
    pairs.fold(R::constant(0.0), |largest, ((a, b), scale)| {
        let distance = ((*a - *b) / *scale).abs();
        // NaN stays.
        if distance <= largest { largest } else { distance }
    })
}

/// `true` where `fine` has so many more steps that the difference of both tells an error.
fn is_finer<S, X, R, const N: usize, const M: usize>(
    fine: &Simulation<S, X, R, N, M>,
    coarse: &Simulation<S, X, R, N, M>,
) -> bool
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    is_more(coarse.adaptive.accepted, fine.adaptive.accepted)
}

impl<S, I, F, R, const N: usize, const M: usize> Estimated<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M> + Clone,
    R: Real,
{
    /// Moves all runs on to `until` (s). A run beside it that fails ends the estimate, not the run.
    ///
    /// # Errors
    /// Those of [`Simulation::advance_to`] for the run itself; nothing has changed then.
    pub fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        let mut next = self.clone();
        let own: Course<R, N> = followed(&mut next.run, until)?;
        next.beside = next.beside.and_then(|[mut coarse, mut fine]| {
            let before = coarse.counts.evaluations + fine.counts.evaluations;
            let courses = followed(&mut coarse, until).and_then(|a| Ok([a, followed(&mut fine, until)?]));
            next.evaluations += coarse.counts.evaluations + fine.counts.evaluations - before;
            let [a, b] = courses.ok()?;
            let scales = &next.run.metric.coordinates;
            let found = [difference(&a, &own, scales), difference(&own, &b, scales)];
            let [looser, tighter] = next.differences;
            // Written so that NaN stays.
            let stays = |so_far: R, new: R| new <= so_far || !so_far.is_finite();
            let largest = |so_far: R, new: R| if stays(so_far, new) { so_far } else { new };
            next.differences = [largest(looser, found[0]), largest(tighter, found[1])];
            Some([coarse, fine])
        });
        *self = next;
        Ok(())
    }

    /// Largest error of the coordinates so far in the reference metric (rad, reference lengths), at 16 instants of each
    /// [`advance_to`](Self::advance_to); see [`ErrorEstimate::of`].
    ///
    /// Without differences to tell it, an untrusted sum of the errors that the steps estimate.
    pub fn error_estimate(&self) -> ErrorEstimate<R> {
        let Tolerance { relative, absolute } = self.run.tolerance;
        let local = self.run.errors * (relative + absolute);
        let Some([coarse, fine]) = &self.beside else { return ErrorEstimate::Untrusted(local) };
        let steps = [coarse, &self.run, fine].map(|run| run.adaptive.accepted);
        match ErrorEstimate::of(self.differences, steps) {
            ErrorEstimate::Untrusted(value) => ErrorEstimate::Untrusted(value.max(local)),
            trusted => trusted,
        }
    }

    /// Right-hand sides that the estimate costs.
    pub fn evaluations_of_estimate(&self) -> u64 {
        self.evaluations
    }

    /// The run, to read.
    pub fn run(&self) -> &Simulation<S, Explicit<I, F>, R, N, M> {
        &self.run
    }

    /// The run, to go on without an estimate.
    pub fn into_run(self) -> Simulation<S, Explicit<I, F>, R, N, M> {
        self.run
    }
}

impl<S, I, F, R, const N: usize, const M: usize> Accurate<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M> + Clone,
    R: Real,
{
    /// Moves on to `until` (s) by the run of three, a factor of ten in tolerance apart, that is the finest.
    ///
    /// They are compared at 16 instants. The finest counts where their differences fall by 3 to 1000 and the error that is then left is
    /// small enough; else the three are made finer. The first two have ten times the wanted error and that error as tolerance: errors at
    /// the end are larger than those of the steps. Their difference tells if a coarser or a finer one is the third. Errors of several
    /// calls add up.
    ///
    /// # Errors
    /// [`Unreachable`](FailureKind::Unreachable) where differences no longer fall, with the best error seen; those of
    /// [`Simulation::advance_to`]. The state is then as before.
    pub fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        let ratio = R::constant(accuracy::RATIO);
        let mut evaluations = self.evaluations;
        let before = self.run.counts.evaluations;
        let scales = self.run.metric.coordinates;
        let mut at = |tolerance: R| -> Result<Followed<S, I, F, R, N, M>, Failure> {
            let tolerance = Tolerance { relative: tolerance, absolute: tolerance };
            let mut run = self.run.clone().with_tolerance(tolerance);
            let course = followed(&mut run, until)?;
            evaluations += run.counts.evaluations - before;
            Ok((run, course))
        };
        let coarsest = R::constant(accuracy::COARSEST_STEPS);
        let mut tolerance = (self.accuracy * ratio).min(coarsest) / ratio;
        let (mut coarse, mut middle) = (at(tolerance * ratio)?, at(tolerance)?);
        let (wanted, first) = (self.accuracy, difference(&coarse.1, &middle.1, &scales));
        let coarser = tolerance * ratio * ratio;
        let mut coarser = (first <= R::constant(accuracy::EASY) * wanted && coarser <= coarsest)
            .then(|| at(coarser).ok())
            .flatten();
        let mut counts = first <= R::constant(accuracy::HARD) * wanted;
        let [least, most] = accuracy::FALLS_TO_ERROR.map(R::constant);
        let mut best: Option<R> = None;
        let unreachable = |best: Option<R>| {
            let best = best.map_or(f64::INFINITY, R::to_f64);
            Err(FailureKind::Unreachable { accuracy: wanted.to_f64(), best }.at(until.to_f64()))
        };
        loop {
            let fine = match coarser.take() {
                Some(coarser) => {
                    let fine = core::mem::replace(&mut middle, coarse);
                    coarse = coarser;
                    fine
                }
                None => {
                    tolerance = tolerance / ratio;
                    if tolerance + tolerance < Tolerance::<R>::least() {
                        return unreachable(best);
                    }
                    at(tolerance)?
                }
            };
            let (first, second) =
                (difference(&coarse.1, &middle.1, &scales), difference(&middle.1, &fine.1, &scales));
            let tells = is_finer(&fine.0, &middle.0) && is_finer(&middle.0, &coarse.0);
            let falls = tells && second * least <= first && first <= second * most;
            if falls && counts {
                let left = left_of(first, second);
                best = Some(best.map_or(left, |best| best.min(left)));
                if left <= wanted {
                    *self = Accurate { run: fine.0, estimate: Some(left), evaluations, ..*self };
                    return Ok(());
                }
            } else if tells
                && first < second * least
                && second <= R::constant(accuracy::NOISE) * Tolerance::<R>::least()
            {
                // Rounding is all that the last digits show.
                return unreachable(Some(best.map_or(second, |best| best.min(second))));
            }
            counts = true;
            (coarse, middle) = (middle, fine);
        }
    }

    /// Estimated error of the last [`advance_to`](Self::advance_to) in the reference metric (rad, reference lengths); none before.
    pub fn error_estimate(&self) -> Option<R> {
        self.estimate
    }

    /// Right-hand sides of all runs so far, those that only told the error included.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// The run, to read.
    pub fn run(&self) -> &Simulation<S, Explicit<I, F>, R, N, M> {
        &self.run
    }

    /// The run, to go on with its last tolerance.
    pub fn into_run(self) -> Simulation<S, Explicit<I, F>, R, N, M> {
        self.run
    }

    /// The run with another accuracy.
    ///
    /// # Errors
    /// As [`Simulation::with_accuracy`].
    pub fn with_accuracy(self, accuracy: R) -> Result<Self, Failure> {
        self.run.with_accuracy(accuracy)
    }
}

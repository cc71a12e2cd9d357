//! Several mechanisms in motion side by side: designs, or phases of one turn.

use core::array::from_fn;

use crate::diagnosis::{Statistics, extent, largest};
use crate::instant::REGULAR_ZONE;
use crate::kinematics::COARSEST_RESOLUTION;
use crate::path::{LARGEST_APPROACH, LARGEST_SECOND_ORDER_TERM};
use crate::{Failure, Kinematic, Lanes, Mechanism, Newton, Outcome, Real, Scalar, Stepper};

/// `L` mechanisms of one text, a lane each, each with its own design, time, state and failures.
///
/// A step is taken in all lanes at once. A lane in which something else happens than next to a regular position (no
/// convergence, the singular zone, a branch, a limit, a doubt about the assembly, changed inputs) is taken alone, by the
/// [`Stepper`] that it would have as a single mechanism; the others do not notice. So each lane is, to round-off, what it
/// is alone. Drives that prescribe a rate are taken alone in every step.
#[derive(Clone)]
pub struct Batch<S, R, const L: usize, const N: usize, const M: usize = N>
where
    S: Mechanism<Lanes<R, L>, N, M>,
    R: Real,
{
    mechanism: S,
    parameters: S::Parameters,
    t: Lanes<R, L>,
    q: [Lanes<R, L>; N],
    qd: [Lanes<R, L>; N],
    qdd: [Lanes<R, L>; N],
    margin: Lanes<R, L>,
    /// What a lane has besides; time, position, rates and margin stand above.
    steppers: [Stepper<S::Lane, R, N, M>; L],
}

/// What a step in all lanes came to.
struct Trial<R: Real, const L: usize, const N: usize> {
    q: [Lanes<R, L>; N],
    qd: [Lanes<R, L>; N],
    qdd: [Lanes<R, L>; N],
    margin: Lanes<R, L>,
    orientation: [u64; L],
    statistics: [Statistics; L],
    /// Lanes in which nothing else happened than next to a regular position.
    plain: [bool; L],
}

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// Assembles each lane of `mechanism` from its `guess` (L of N) at its time `t` (L, s).
    ///
    /// # Errors
    /// The first lane that cannot be assembled, with its failure; see [`Stepper::assemble`].
    pub fn assemble(mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Self, (usize, Failure)> {
        let assembled: [Result<_, Failure>; L] = from_fn(|lane| {
            let start = guess.get(lane).copied().unwrap_or([R::constant(0.0); N]);
            Stepper::assemble(mechanism.lane(lane), start, Lanes(t).lane(lane))
        });
        let mut first = None;
        for (lane, result) in assembled.iter().enumerate() {
            match result {
                Ok(stepper) => first = first.or(Some(stepper.clone())),
                Err(failure) => return Err((lane, *failure)),
            }
        }
        let Some(first) = first else {
            return Err((0, Failure::NonFinite { name: "t", line: 0 }));
        };
        let zero = Lanes([R::constant(0.0); L]);
        let parameters = mechanism.parameters();
        let steppers = assembled.map(|result| result.unwrap_or_else(|_| first.clone()));
        let (q, qd, qdd) = ([zero; N], [zero; N], [zero; N]);
        let mut batch = Batch { mechanism, parameters, t: zero, q, qd, qdd, margin: zero, steppers };
        (0..L).for_each(|lane| batch.gather(lane));
        Ok(batch)
    }

    /// Moves each lane on to its time `t` (L, s).
    ///
    /// Returns what the step of each lane cost (`evaluations` are those of the lane that needed most), or why it was not
    /// made: that lane then is bit for bit what it was, the others have moved. See [`Stepper::advance_to`].
    pub fn advance_to(&mut self, t: [R; L]) -> [Result<Statistics, Failure>; L] {
        if !S::PHASES.is_empty() {
            return from_fn(|lane| self.alone(lane, Lanes(t).lane(lane)));
        }
        let trial = self.tried(Lanes(t));
        self.take(&trial, Lanes(t));
        from_fn(|lane| match (trial.plain.get(lane), trial.statistics.get(lane)) {
            (Some(true), Some(statistics)) => Ok(*statistics),
            _ => self.alone(lane, Lanes(t).lane(lane)),
        })
    }

    /// Changes parameters or inputs of any lanes; see [`Stepper::change`].
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        let result = change(&mut self.mechanism);
        self.parameters = self.mechanism.parameters();
        for (lane, stepper) in self.steppers.iter_mut().enumerate() {
            stepper.change(|mechanism| *mechanism = self.mechanism.lane(lane));
        }
        result
    }

    /// The mechanism in lane `lane` alone; of the last lane where there are fewer.
    pub fn stepper(&self, lane: usize) -> Option<Stepper<S::Lane, R, N, M>> {
        let mut stepper = self.steppers.get(lane).or(self.steppers.last()).cloned()?;
        let of = |values: &[Lanes<R, L>; N]| values.map(|value| value.lane(lane));
        let q = of(&self.q);
        let margin = self.margin.lane(lane);
        stepper.state.set((self.t.lane(lane), q, of(&self.qd), of(&self.qdd)), margin);
        Some(stepper)
    }

    /// Times (s).
    pub fn t(&self) -> Lanes<R, L> {
        self.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[Lanes<R, L>; N] {
        &self.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[Lanes<R, L>; N] {
        &self.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[Lanes<R, L>; N] {
        &self.qdd
    }

    /// A step in all lanes, without a look at what is special in one.
    #[inline(always)]
    fn tried(&self, t: Lanes<R, L>) -> Trial<R, L, N> {
        let Batch { mechanism, parameters, .. } = self;
        let scales = mechanism.coordinate_scales(parameters);
        let start = self.predicted(t, &scales);
        let mut solver = Newton::new(extent(&start, &scales));
        let mut q = start;
        let (outcomes, position) = mechanism.solve_with_position(parameters, &mut q, t, &mut solver);
        let (factors, margin) = mechanism.factorize(parameters, &position);
        let qd = mechanism.solve_linear(&factors, &mechanism.phi_t(parameters, &position).map(|rate| -rate));
        let qdd = mechanism.solve_linear(&factors, &mechanism.gamma(parameters, &position, &qd));
        let mut way = q;
        for ((way, start), scale) in way.iter_mut().zip(&start).zip(&scales) {
            *way = (*way - *start) * (Lanes::constant(1.0) / *scale);
        }
        let correction = largest(&way);
        let zone = Lanes::constant(REGULAR_ZONE);
        // Written so that NaN is not plain.
        let mut plain = zone.less(margin.value) & zone.less(self.margin);
        plain = plain & correction.less(Lanes::constant(LARGEST_APPROACH) * margin.value);
        for (coordinate, scale) in q.iter().zip(&scales) {
            let resolution = Lanes::splat(R::EPSILON) * coordinate.abs();
            plain = plain & resolution.less(Lanes::constant(COARSEST_RESOLUTION) * *scale);
        }
        for (rate, acceleration) in qd.iter().zip(&qdd) {
            plain = plain & rate.is_finite() & acceleration.is_finite();
        }
        for branch in mechanism.branches(parameters, &position).as_ref() {
            plain = plain & Lanes::constant(0.0).less(*branch);
        }
        for limit in mechanism.limits(parameters, &position).as_ref() {
            plain = plain & limit.low.less(limit.value) & limit.value.less(limit.high);
        }
        let diagnosis = solver.diagnosis();
        let converged = |lane: usize| outcomes.get(lane) == Some(&Outcome::Converged);
        let waits = |lane: usize| self.steppers.get(lane).is_none_or(Stepper::waits);
        Trial {
            q,
            qd,
            qdd,
            margin: margin.value,
            orientation: margin.orientation,
            statistics: from_fn(|lane| Statistics {
                evaluations: diagnosis.evaluations,
                fallback: diagnosis.fallback,
                residual: diagnosis.worst.ratio.lane(lane).to_f64(),
                row: diagnosis.worst.row.get(lane).copied().unwrap_or(0),
                correction: correction.lane(lane).to_f64(),
                passed: false,
            }),
            plain: from_fn(|lane| Lanes::<R, L>::test(plain, lane) && converged(lane) && !waits(lane)),
        }
    }

    /// q + h q̇ + h²/2 q̈, without the last term where it is too large to be trusted.
    #[inline(always)]
    fn predicted(&self, t: Lanes<R, L>, scales: &[Lanes<R, L>; N]) -> [Lanes<R, L>; N] {
        let h = t - self.t;
        let half_square = Lanes::constant(0.5) * h * h;
        let second = self.qdd.map(|acceleration| half_square * acceleration);
        let mut trusted = Lanes::<R, L>::mask(true);
        for (term, scale) in second.iter().zip(scales) {
            trusted = trusted & !(Lanes::constant(LARGEST_SECOND_ORDER_TERM) * *scale).less(term.abs());
        }
        let mut predicted = self.q;
        for ((coordinate, rate), second) in predicted.iter_mut().zip(&self.qd).zip(second) {
            let second = Lanes::select(trusted, second, Lanes::constant(0.0));
            *coordinate = *coordinate + h * *rate + second;
        }
        predicted
    }

    /// Takes the step over in the lanes where it is plain.
    #[inline(always)]
    fn take(&mut self, trial: &Trial<R, L, N>, t: Lanes<R, L>) {
        let before = (self.t, self.margin);
        let mask = crate::lanes::LaneMask(trial.plain);
        let merge = |old: &mut [Lanes<R, L>; N], new: &[Lanes<R, L>; N]| {
            old.iter_mut().zip(new).for_each(|(old, new)| *old = Lanes::select(mask, *new, *old));
        };
        merge(&mut self.q, &trial.q);
        merge(&mut self.qd, &trial.qd);
        merge(&mut self.qdd, &trial.qdd);
        self.t = Lanes::select(mask, t, self.t);
        self.margin = Lanes::select(mask, trial.margin, self.margin);
        let changes = (self.margin - before.1, self.t - before.0);
        for (lane, stepper) in self.steppers.iter_mut().enumerate() {
            if Lanes::<R, L>::test(mask, lane) {
                let (Some(orientation), Some(statistics)) =
                    (trial.orientation.get(lane), trial.statistics.get(lane))
                else {
                    continue;
                };
                let (change, time) = (changes.0.lane(lane), changes.1.lane(lane));
                stepper.state.note(*orientation, *statistics, change, time);
            }
        }
    }

    /// The step of one lane as if it were alone.
    #[cold]
    #[inline(never)]
    fn alone(&mut self, lane: usize, t: R) -> Result<Statistics, Failure> {
        let Some(mut stepper) = self.stepper(lane) else {
            return Err(Failure::NonFinite { name: "t", line: 0 });
        };
        let statistics = stepper.advance_to(t)?;
        if let Some(slot) = self.steppers.get_mut(lane) {
            *slot = stepper;
        }
        self.gather(lane);
        Ok(statistics)
    }

    /// Puts the state of a lane's stepper beside the others'.
    fn gather(&mut self, lane: usize) {
        let Some(stepper) = self.steppers.get(lane) else { return };
        let put = |lanes: &mut Lanes<R, L>, value: R| {
            if let Some(slot) = lanes.0.get_mut(lane) {
                *slot = value;
            }
        };
        for (vector, values) in
            [(&mut self.q, stepper.q()), (&mut self.qd, stepper.qd()), (&mut self.qdd, stepper.qdd())]
        {
            vector.iter_mut().zip(values).for_each(|(lanes, value)| put(lanes, *value));
        }
        put(&mut self.t, stepper.t());
        put(&mut self.margin, stepper.margin());
    }
}

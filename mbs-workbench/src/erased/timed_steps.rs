//! Runs of settings for motion from drives, timed and recorded, in any type of number and number of lanes.

use core::marker::PhantomData;
use std::time::Instant;

use mbs_runtime::{Batch, Budget, Failure, Kinematic, Lanes, Mechanism, Real, Scalar, Step, Stepper};

use super::timed_runs::Effort;
use crate::double_double::DoubleDouble as D;
use crate::setting::Closing;

/// A state of a motion that drives prescribe: time (s), q, q̇, q̈ (N each).
#[derive(Clone, Debug)]
pub struct Placed<T> {
    /// Time (s).
    pub t: f64,
    /// q, q̇, q̈.
    pub motion: [Vec<T>; 3],
}

/// Runs of a mechanism whose rows fix it.
pub trait TimedSteps {
    /// The motion from the text's guess at the first of `times` (s) through the others, a step each. Elapsed is the time of one
    /// lane.
    ///
    /// # Errors
    /// The stepper's failure.
    fn run(
        &self,
        closing: Closing,
        times: &[f64],
        see: Option<&mut dyn FnMut(Placed<f64>)>,
    ) -> Result<Effort, Failure>;
    /// Reference metric of the coordinates: N.
    fn scales(&self) -> Vec<f64>;
}

/// A mechanism in numbers `R`, one at a time.
pub struct Single<S, R, const N: usize, const M: usize> {
    mechanism: S,
    /// Distance of the guess from that of the text.
    shift: [f64; N],
    kind: PhantomData<R>,
}

/// A mechanism in `L` lanes of `R`.
pub struct InLanes<S, R, const L: usize, const N: usize, const M: usize>(S, PhantomData<R>);

impl<S, R, const N: usize, const M: usize> Single<S, R, N, M> {
    /// `mechanism` as it is.
    pub fn of(mechanism: S) -> Self {
        Self::beside(mechanism, [0.0; N])
    }

    /// `mechanism` with a guess `shift` beside that of the text.
    pub fn beside(mechanism: S, shift: [f64; N]) -> Self {
        Single { mechanism, shift, kind: PhantomData }
    }
}

impl<S, R, const L: usize, const N: usize, const M: usize> InLanes<S, R, L, N, M> {
    /// `mechanism` as it is.
    pub fn of(mechanism: S) -> Self {
        InLanes(mechanism, PhantomData)
    }
}

fn numbers<R: Real>(values: &[R]) -> Vec<f64> {
    values.iter().map(|value| value.to_f64()).collect()
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> TimedSteps for Single<S, R, N, M> {
    fn run(
        &self,
        closing: Closing,
        times: &[f64],
        see: Option<&mut dyn FnMut(Placed<f64>)>,
    ) -> Result<Effort, Failure> {
        let first = R::constant(times.first().copied().unwrap_or(0.0));
        let mut guess = self.mechanism.guess(&self.mechanism.parameters());
        guess.iter_mut().zip(self.shift).for_each(|(q, shift)| *q = *q + R::constant(shift));
        let mut stepper = Stepper::assemble(self.mechanism.clone(), guess, first)?;
        let mut nothing = |_: Placed<f64>| ();
        let is_watched = see.is_some();
        let see: &mut dyn FnMut(Placed<f64>) = see.unwrap_or(&mut nothing);
        let mut effort = Effort::default();
        let mut show = |stepper: &Stepper<S, R, N, M>, t: f64| {
            if is_watched {
                let motion = [stepper.q(), stepper.qd(), stepper.qdd()].map(|values| numbers(values));
                see(Placed { t, motion });
            }
        };
        show(&stepper, times.first().copied().unwrap_or(0.0));
        let began = Instant::now();
        for time in times.iter().skip(1) {
            let until = R::constant(*time);
            let evaluations = match closing {
                Closing::Closed => stepper.advance_to(until)?.evaluations,
                Closing::Evaluations(most) => {
                    let budget = Budget { newton: most, fallback: 0 };
                    match stepper.step(until - stepper.t(), budget) {
                        Step::Done(statistics) | Step::Degraded { statistics, .. } => statistics.evaluations,
                        Step::Refused(failure) => return Err(failure),
                    }
                }
            };
            effort.evaluations += u64::from(evaluations);
            effort.steps += 1;
            show(&stepper, *time);
        }
        effort.elapsed = began.elapsed();
        Ok(effort)
    }

    fn scales(&self) -> Vec<f64> {
        numbers(&self.mechanism.coordinate_scales(&self.mechanism.parameters()))
    }
}

impl<S, R, const L: usize, const N: usize, const M: usize> TimedSteps for InLanes<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    fn run(
        &self,
        _closing: Closing,
        times: &[f64],
        see: Option<&mut dyn FnMut(Placed<f64>)>,
    ) -> Result<Effort, Failure> {
        let first = R::constant(times.first().copied().unwrap_or(0.0));
        let lane = self.0.lane(0);
        let guess = lane.guess(&lane.parameters());
        let mut batch = Batch::<S, R, L, N, M>::assemble(self.0.clone(), &[guess; L], [first; L])
            .map_err(|(_, failure)| failure)?;
        let mut nothing = |_: Placed<f64>| ();
        let is_watched = see.is_some();
        let see: &mut dyn FnMut(Placed<f64>) = see.unwrap_or(&mut nothing);
        let mut effort = Effort::default();
        // The last lane stands for all: they have the same design.
        let mut show = |batch: &Batch<S, R, L, N, M>, t: f64| {
            if is_watched {
                let motion = [batch.q(), batch.qd(), batch.qdd()]
                    .map(|values| values.iter().map(|value| value.lane(L - 1).to_f64()).collect());
                see(Placed { t, motion });
            }
        };
        show(&batch, times.first().copied().unwrap_or(0.0));
        let began = Instant::now();
        for time in times.iter().skip(1) {
            for result in batch.advance_to([R::constant(*time); L]) {
                effort.evaluations += u64::from(result?.evaluations);
            }
            effort.steps += 1;
            show(&batch, *time);
        }
        effort.evaluations /= L as u64;
        effort.elapsed = began.elapsed() / L as u32;
        Ok(effort)
    }

    fn scales(&self) -> Vec<f64> {
        let scales = self.0.coordinate_scales(&self.0.parameters());
        scales.iter().map(|scale| scale.lane(0).to_f64()).collect()
    }
}

/// Positions and rates in double-double numbers, for references of kinematics.
pub trait ExactPositions {
    /// Starts drives that prescribe a rate at `q` (N) and `t` (s).
    fn begin(&mut self, t: f64, q: &[f64]);
    /// Numbers of coordinates and rows.
    fn sizes(&self) -> [usize; 2];
    /// Reference metric of coordinates (N) and rows (M).
    fn scales(&self) -> [Vec<f64>; 2];
    /// Φ (M) and Φ_q (M rows of N) at `q` (N) and `t` (s).
    fn rows(&self, q: &[D], t: D) -> [Vec<D>; 2];
    /// Φ_t (M) and, for velocities `qd` (N), γ (M).
    fn rates(&self, q: &[D], qd: &[D], t: D) -> [Vec<D>; 2];
    /// The first row that may contradict others by a width: `redundant within`.
    fn row_with_width(&self) -> Option<&'static str>;
}

/// A mechanism in double-double numbers with its drives at a time.
pub struct Positions<S, const N: usize, const M: usize> {
    mechanism: S,
    t: D,
}

impl<S, const N: usize, const M: usize> Positions<S, N, M> {
    /// `mechanism` as it is.
    pub fn of(mechanism: S) -> Self {
        Positions { mechanism, t: D::constant(0.0) }
    }
}

fn array<const K: usize>(values: &[D]) -> [D; K] {
    <[D; K]>::try_from(values).expect("a vector of the mechanism's size")
}

impl<S: Kinematic<D, N, M>, const N: usize, const M: usize> Positions<S, N, M> {
    fn at(&self, t: D) -> S {
        let mut mechanism = self.mechanism.clone();
        if !S::PHASES.is_empty() {
            mechanism.advance_phases(self.t, t);
        }
        mechanism
    }
}

impl<S: Kinematic<D, N, M>, const N: usize, const M: usize> ExactPositions for Positions<S, N, M> {
    fn begin(&mut self, t: f64, q: &[f64]) {
        let q: Vec<D> = q.iter().map(|value| D::constant(*value)).collect();
        self.t = D::constant(t);
        self.mechanism.start_phases(&array(&q), self.t);
    }
    fn sizes(&self) -> [usize; 2] {
        [N, M]
    }
    fn scales(&self) -> [Vec<f64>; 2] {
        let parameters = self.mechanism.parameters();
        let high = |values: &[D]| values.iter().map(|value| value.high).collect();
        [high(&self.mechanism.coordinate_scales(&parameters)), high(&self.mechanism.row_scales(&parameters))]
    }
    fn rows(&self, q: &[D], t: D) -> [Vec<D>; 2] {
        let mechanism = self.at(t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(q), t);
        let phi_q = mechanism.phi_q(&parameters, &position);
        [mechanism.phi(&parameters, &position).to_vec(), phi_q.into_iter().flatten().collect()]
    }
    fn rates(&self, q: &[D], qd: &[D], t: D) -> [Vec<D>; 2] {
        let mechanism = self.at(t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(q), t);
        let gamma = mechanism.gamma(&parameters, &position, &array(qd));
        [mechanism.phi_t(&parameters, &position).to_vec(), gamma.to_vec()]
    }
    fn row_with_width(&self) -> Option<&'static str> {
        let widths = self.mechanism.widths(&self.mechanism.parameters());
        let wide = widths.iter().position(|width| width.high > 0.0);
        wide.and_then(|row| S::ROWS.get(row)).map(|row| row.name)
    }
}

//! Phases of drives that prescribe a rate, integrated with the motion.

use crate::dynamics::first_order_form::equations::Equations;
use crate::dynamics::integrators::equation::Equation;
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::phase::{Phase, Speed};
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::{Real, Scalar};

/// Order of the integrals that [`Mechanism::advance_phases`] takes over a step: methods of a higher order integrate the
/// prescribed rates themselves.
pub(crate) const ORDER_OF_INTEGRALS: u32 = 6;

/// A state with the increments of phases of drives that prescribe a rate, since a run began; as a rate, with the
/// prescribed rates. So the step control sees the error of phases of a rate that varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phased<Y, P> {
    /// Coordinates, velocities, first-order states, work.
    pub y: Y,
    /// One phase a drive that prescribes a rate, of which the values count alone.
    pub phases: P,
}

impl<T: Scalar, Y: Vector<T>, P: Copy + AsRef<[Phase<T>]> + AsMut<[Phase<T>]>> Vector<T> for Phased<Y, P> {
    #[inline(always)]
    fn zero(&self) -> Self {
        Phased { y: self.y.zero(), phases: unmoved(self.phases) }
    }

    #[inline(always)]
    fn add(&mut self, weight: T, term: &Self) {
        self.y.add(weight, &term.y);
        add(&mut self.phases, weight, &term.phases);
    }

    #[inline(always)]
    fn scaled(&self, weight: T) -> Self {
        let mut scaled = Phased { y: self.y.scaled(weight), phases: self.phases };
        scaled.phases.as_mut().iter_mut().for_each(|phase| phase.value = weight * phase.value);
        scaled
    }

    #[inline(always)]
    fn semi_implicit(&self, h: T, rate: &Self) -> Self {
        let mut next = Phased { y: self.y.semi_implicit(h, &rate.y), phases: self.phases };
        add(&mut next.phases, h, &rate.phases);
        next
    }
}

/// Adds `weight` times the values of `term`.
#[inline(always)]
fn add<T: Scalar, P: AsRef<[Phase<T>]> + AsMut<[Phase<T>]>>(phases: &mut P, weight: T, term: &P) {
    for (phase, term) in phases.as_mut().iter_mut().zip(term.as_ref()) {
        phase.value = phase.value + weight * term.value;
    }
}

/// As many phases, none moved on.
#[inline(always)]
pub(crate) fn unmoved<T: Scalar, P: AsMut<[Phase<T>]>>(mut phases: P) -> P {
    phases.as_mut().iter_mut().for_each(|phase| phase.value = T::constant(0.0));
    phases
}

/// Phases at the beginning of a run, `increments` further on, where the prescribed rates are `rates`.
#[inline]
pub(crate) fn advanced<T: Scalar, P: Copy + AsRef<[Phase<T>]> + AsMut<[Phase<T>]>>(
    mut start: P,
    increments: &P,
    rates: &P,
) -> P {
    let moves = increments.as_ref().iter().zip(rates.as_ref());
    for (phase, (increment, rate)) in start.as_mut().iter_mut().zip(moves) {
        *phase = phase.advanced(increment.value, Speed { value: rate.value, rate: rate.rate });
    }
    start
}

/// Phases without a state.
type Bare<R, P> = Phased<[R; 0], P>;

/// The phases of `mechanism` where they are, with the rates that its drives prescribe at time `t` (s).
pub(crate) fn at_present<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize>(
    mechanism: &S,
    t: T,
) -> S::Phases {
    let phases = mechanism.phases();
    advanced(phases, &unmoved(phases), &mechanism.phase_rates(t))
}

/// The prescribed rates of a mechanism: phases move whatever else does.
struct Rates<'a, S, T, const N: usize, const M: usize> {
    /// The mechanism as it is at time `from` (s).
    start: &'a S,
    from: T,
    /// The same with its inputs carried on.
    moved: S,
}

impl<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize> Equation<T> for Rates<'_, S, T, N, M> {
    type State = Bare<T, S::Phases>;

    fn rate(&mut self, t: T, _: &Self::State) -> Result<Self::State, Failure> {
        self.moved.carry_signals(self.start, t - self.from);
        Ok(Phased { y: [], phases: self.moved.phase_rates(t) })
    }
}

/// The phases after a step of `h` from `t` (s) by `method`: those that the stages of its own steps come to.
///
/// # Errors
/// None of its own.
pub(crate) fn stepped<I: FixedStep, S, R: Real, const N: usize, const M: usize>(
    method: &I,
    mechanism: &S,
    t: R,
    h: R,
) -> Result<S::Phases, Failure>
where
    S: Mechanism<R, N, M>,
{
    let start = mechanism.phases();
    let mut equation = Rates::<S, R, N, M> { start: mechanism, from: t, moved: mechanism.clone() };
    let y: Bare<R, S::Phases> = Phased { y: [], phases: unmoved(start) };
    let rate = equation.rate(t, &y)?;
    let end = method.step(&mut equation, t, h, &y, &rate)?;
    let rates = equation.rate(t + h, &end)?;
    Ok(advanced(start, &end.phases, &rates.phases))
}

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    /// Reference metric of a phase: that of rows of its unit, of which its drive is one.
    pub(super) fn scale(&self, phase: &Entry) -> R {
        let scales = self.model.mechanism.row_scales(self.model.parameters);
        let mut rows = S::ROWS.iter().zip(scales);
        rows.find(|(row, _)| row.unit == phase.unit).map_or(R::constant(1.0), |(_, scale)| scale)
    }
}

//! Steps of fixed size: semi-implicit Euler and the classical Runge–Kutta method.

use crate::dynamics::integrators::equation::Equation;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::scalar::number::Scalar;

/// An explicit method with steps of the caller's size: fixed work, no memory of earlier steps.
pub trait FixedStep: Copy {
    /// Order of convergence.
    fn order(&self) -> u32;

    /// `true` if its steps need derivatives of the forces.
    #[inline]
    fn uses_slopes(&self) -> bool {
        false
    }

    /// The state at `t + h`, not yet settled, from the state `y` at `t` (s) and its rate.
    ///
    /// # Errors
    /// Those of the equation.
    fn step<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        t: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure>;
}

/// q̇ₙ₊₁ = q̇ₙ + h q̈ₙ, then qₙ₊₁ = qₙ + h q̇ₙ₊₁. One evaluation a step, order 1, and no drift of the energy of an
/// oscillation as long as ω h < 2.
///
/// Source: Hairer, Lubich & Wanner 2006, §I.1.2 (symplectic Euler).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SemiImplicitEuler;

impl FixedStep for SemiImplicitEuler {
    #[inline]
    fn order(&self) -> u32 {
        1
    }

    #[inline]
    fn step<T: Scalar, E: Equation<T>>(
        &self,
        _: &mut E,
        _: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure> {
        Ok(y.semi_implicit(h, rate))
    }
}

/// The classical method of order 4, four evaluations a step.
///
/// Source: Hairer, Nørsett & Wanner 1993, table II.1.2 (left).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RungeKutta4;

impl FixedStep for RungeKutta4 {
    #[inline]
    fn order(&self) -> u32 {
        4
    }

    #[inline]
    fn step<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        t: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure> {
        // Places and weights of the stages after the first; as a loop, so that the equation is compiled into it once.
        const STAGES: [(f64, f64); 3] = [(0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];
        let (mut stage, mut change) = (*rate, rate.scaled(T::constant(1.0 / 6.0)));
        for (place, weight) in STAGES {
            let (t, y) = (t + T::constant(place) * h, y.plus(h, &[place], [&stage]));
            stage = match equation.rate_of_stage(t, &y) {
                Some(rate) => rate,
                None => equation.rate(t, &y)?,
            };
            change.add(T::constant(weight), &stage);
        }
        let mut next = *y;
        next.add(h, &change);
        Ok(next)
    }
}

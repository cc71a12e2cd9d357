//! Order 5 with an estimate of order 4: the pair for accuracies from 1e-3 to 1e-7.

use crate::dynamics::integrators::embedded::{Embedded, StepAttempt, StepControl, Taken, hermite, nested};
use crate::dynamics::integrators::equation::{Equation, ErrorNorm};
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::scalar::number::{Real, Scalar};

/// The pair of Dormand and Prince, seven stages, with dense output of order 4.
///
/// Source: Dormand & Prince 1980; Hairer, Nørsett & Wanner 1993, table II.5.2, and §II.6 for the dense output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DormandPrince5;

const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
const A5: [f64; 4] = [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0];
const A6: [f64; 5] = [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0];
/// Of stages 1, 3, 4, 5, 6.
const B: [f64; 5] = [35.0 / 384.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
/// Solution of order 5 less the one of order 4, of stages 1, 3, 4, 5, 6, 7.
const E: [f64; 6] =
    [71.0 / 57600.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Of stages 1, 3, 4, 5, 6, 7.
const D: [f64; 6] = [
    -12715105075.0 / 11282082432.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

impl FixedStep for DormandPrince5 {
    #[inline]
    fn order(&self) -> u32 {
        5
    }

    /// The solution of order 5, whatever its error.
    #[inline]
    fn step<T: Scalar, S: Equation<T>>(
        &self,
        equation: &mut S,
        t: T,
        h: T,
        y: &S::State,
        rate: &S::State,
    ) -> Result<S::State, Failure> {
        Ok(self.trial(equation, (t, h), (y, rate), &())?.y)
    }
}

impl Embedded for DormandPrince5 {
    /// Stages 3 to 7.
    type Stages<Y: Copy> = [Y; 5];
    type Memory<R: Copy, Y: Copy> = ();
    type Dense<Y: Copy> = [Y; 5];

    #[inline]
    fn control(&self) -> StepControl {
        StepControl { memory: 0.04, ..StepControl::of(5, 10.0) }
    }

    #[inline]
    fn trial<T: Scalar, S: Equation<T>>(
        &self,
        equation: &mut S,
        (t, h): (T, T),
        (y, k1): (&S::State, &S::State),
        _: &(),
    ) -> Result<StepAttempt<S::State, [S::State; 5]>, Failure> {
        let at = |c: f64| t + T::constant(c) * h;
        let k2 = equation.rate(at(0.2), &y.plus(h, &[0.2], [k1]))?;
        let k3 = equation.rate(at(0.3), &y.plus(h, &A3, [k1, &k2]))?;
        let k4 = equation.rate(at(0.8), &y.plus(h, &A4, [k1, &k2, &k3]))?;
        let k5 = equation.rate(at(8.0 / 9.0), &y.plus(h, &A5, [k1, &k2, &k3, &k4]))?;
        let k6 = equation.rate(t + h, &y.plus(h, &A6, [k1, &k2, &k3, &k4, &k5]))?;
        let next = y.plus(h, &B, [k1, &k3, &k4, &k5, &k6]);
        let k7 = equation.rate(t + h, &next)?;
        Ok(StepAttempt { y: next, stages: [k3, k4, k5, k6, k7] })
    }

    #[inline]
    fn remember<R: Real, Y: Vector<R>>(_: &Taken<'_, R, Y, [Y; 5]>) {}

    #[inline]
    fn error<R: Real, S: ErrorNorm<R>>(
        equation: &S,
        h: R,
        y: &S::State,
        k1: &S::State,
        trial: &StepAttempt<S::State, [S::State; 5]>,
    ) -> R {
        let [k3, k4, k5, k6, k7] = &trial.stages;
        let error = y.zero().plus(h, &E, [k1, k3, k4, k5, k6, k7]);
        let [error] = equation.measure(y, &trial.y, [&error]);
        error
    }

    #[inline]
    fn dense<R: Real, S: Equation<R>>(
        _: &mut S,
        step: &Taken<'_, R, S::State, [S::State; 5]>,
    ) -> Result<[S::State; 5], Failure> {
        let (Taken { h, .. }, (y, k1)) = (*step, step.start);
        let [k3, k4, k5, k6, k7] = step.stages;
        let [change, bend, twist] = hermite(h, step.start, step.end);
        let rest = y.zero().plus(h, &D, [k1, k3, k4, k5, k6, k7]);
        Ok([*y, change, bend, twist, rest])
    }

    #[inline]
    fn interpolate<T: Scalar, Y: Vector<T>>([start, terms @ .., last]: &[Y; 5], theta: T) -> Y {
        nested(start, (terms, last), theta)
    }
}

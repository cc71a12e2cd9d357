//! One of two integrators, chosen at run time.

use crate::dynamics::integrators::embedded::{AttemptOf, Embedded, StepAttempt, StepControl, Taken};
use crate::dynamics::integrators::equation::{Equation, ErrorNorm};
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::scalar::number::{Real, Scalar};

/// One of two integrators, or the data of one of them. A program that lets its user choose compiles all else of a run once for both.
///
/// ```
/// use mbs_runtime::dynamics::{DormandPrince5, DormandPrince8, Either, Explicit, Projection, Simulation};
/// use mbs_runtime::mechanism;
///
/// # mechanism! {
/// #     /// A point mass in free fall.
/// #     pub mechanism Stone;
/// #     coord y: m = 0;
/// #     body stone { mass: 1, com: [0, y] }
/// #     gravity weight { acceleration: [0, -9.81] }
/// # }
///
/// for pair in [Either::First(DormandPrince5), Either::Second(DormandPrince8)] {
///     let method = Explicit::new(pair, Projection::default());
///     let mut run = Simulation::start(Stone::default(), method, 0.0_f64, [0.0], [0.0])?;
///     run.advance_to(1.0)?;
///     assert!((run.q()[0] + 4.905).abs() < 1e-12);
/// }
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Either<A, B> {
    /// The first one.
    First(A),
    /// The second one.
    Second(B),
}

impl<A: Default, B> Default for Either<A, B> {
    fn default() -> Self {
        Either::First(A::default())
    }
}

impl<A: FixedStep, B: FixedStep> FixedStep for Either<A, B> {
    fn order(&self) -> u32 {
        match self {
            Either::First(method) => method.order(),
            Either::Second(method) => method.order(),
        }
    }

    fn uses_slopes(&self) -> bool {
        match self {
            Either::First(method) => method.uses_slopes(),
            Either::Second(method) => method.uses_slopes(),
        }
    }

    fn step<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        t: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure> {
        match self {
            Either::First(method) => method.step(equation, t, h, y, rate),
            Either::Second(method) => method.step(equation, t, h, y, rate),
        }
    }
}

impl<A: Embedded, B: Embedded> Embedded for Either<A, B> {
    type Memory<R: Copy, Y: Copy> = Either<A::Memory<R, Y>, B::Memory<R, Y>>;
    type Stages<Y: Copy> = Either<A::Stages<Y>, B::Stages<Y>>;
    type Dense<Y: Copy> = Either<A::Dense<Y>, B::Dense<Y>>;

    fn control(&self) -> StepControl {
        match self {
            Either::First(method) => method.control(),
            Either::Second(method) => method.control(),
        }
    }

    fn trial<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        span: (T, T),
        start: (&E::State, &E::State),
        memory: &Self::Memory<T, E::State>,
    ) -> Result<AttemptOf<Self, E::State>, Failure> {
        match self {
            Either::First(method) => {
                let memory = if let Either::First(memory) = memory { *memory } else { Default::default() };
                let StepAttempt { y, stages } = method.trial(equation, span, start, &memory)?;
                Ok(StepAttempt { y, stages: Either::First(stages) })
            }
            Either::Second(method) => {
                let memory = if let Either::Second(memory) = memory { *memory } else { Default::default() };
                let StepAttempt { y, stages } = method.trial(equation, span, start, &memory)?;
                Ok(StepAttempt { y, stages: Either::Second(stages) })
            }
        }
    }

    fn error<R: Real, E: ErrorNorm<R>>(
        equation: &E,
        h: R,
        y: &E::State,
        rate: &E::State,
        trial: &AttemptOf<Self, E::State>,
    ) -> R {
        match trial.stages {
            Either::First(stages) => A::error(equation, h, y, rate, &StepAttempt { y: trial.y, stages }),
            Either::Second(stages) => B::error(equation, h, y, rate, &StepAttempt { y: trial.y, stages }),
        }
    }

    fn growth<Y: Copy>(&self, stages: &Self::Stages<Y>) -> f64 {
        match (self, stages) {
            (Either::First(method), Either::First(stages)) => method.growth(stages),
            (Either::Second(method), Either::Second(stages)) => method.growth(stages),
            // Stages of the other one.
            _ => self.control().largest_growth,
        }
    }

    fn remember<R: Real, Y: Vector<R>>(step: &Taken<'_, R, Y, Self::Stages<Y>>) -> Self::Memory<R, Y> {
        match step.stages {
            Either::First(stages) => Either::First(A::remember(&step.with(stages))),
            Either::Second(stages) => Either::Second(B::remember(&step.with(stages))),
        }
    }

    fn dense<R: Real, E: Equation<R>>(
        equation: &mut E,
        step: &Taken<'_, R, E::State, Self::Stages<E::State>>,
    ) -> Result<Self::Dense<E::State>, Failure> {
        match step.stages {
            Either::First(stages) => A::dense(equation, &step.with(stages)).map(Either::First),
            Either::Second(stages) => B::dense(equation, &step.with(stages)).map(Either::Second),
        }
    }

    fn interpolate<T: Scalar, Y: Vector<T>>(dense: &Self::Dense<Y>, theta: T) -> Y {
        match dense {
            Either::First(dense) => A::interpolate(dense, theta),
            Either::Second(dense) => B::interpolate(dense, theta),
        }
    }
}

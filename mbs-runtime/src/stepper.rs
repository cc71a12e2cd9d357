//! A mechanism in motion: state and mechanism in one place, one call a step.

use crate::diagnosis::Statistics;
use crate::kinematics::{
    branch_failure, coordinate_failure, factorize, largest_difference, solve_acceleration, solve_correction,
    solve_position, solve_velocity, time_failure, variable_failure,
};
use crate::{Failure, Kinematic, Mechanism, Real, Sweep, assemble};

/// Margin to singularity below which the last regular tangent predicts, not the rates of the state: those are
/// wrong by the inverse square of the margin, and past a change point pick the assembly by chance.
const REGULAR_ZONE: f64 = 1e-2;

/// Largest part of a prediction (rad, or reference lengths) that may come from accelerations: beyond it the step
/// is too long for a second-order polynomial, and the first-order one is nearer.
const LARGEST_SECOND_ORDER_TERM: f64 = 0.5;

/// Largest Newton step from a position that is kept open, in the reference metric, over its margin.
///
/// By Kantorovich's theorem a step η converges where β κ η ≤ 1/2, and to a point not farther than 2η. Links turn with
/// curvature κ ≤ 1 in the metric and the inverse β is about 2/margin, so that a quarter is the limit: the position is
/// nearer to the solution that it approximates than to where the assemblies meet.
const LARGEST_OPEN_STEP: f64 = 0.25;

/// A mechanism with its state. It owns everything, allocates nothing, and a failed call leaves it as it was.
///
/// For a control loop: [`change`](Self::change) the inputs, [`advance`](Self::advance), read
/// [`q`](Self::q), [`qd`](Self::qd), [`outputs`](Self::outputs). With a deadline, [`step`](Self::step) in its place.
#[derive(Clone, Copy, Debug)]
pub struct Stepper<S: Mechanism<R, N, N>, R: Real, const N: usize> {
    pub(crate) mechanism: S,
    pub(crate) parameters: S::Parameters,
    /// What is wrong with the parameters or inputs, since they were changed last.
    pub(crate) fault: Option<Failure>,
    pub(crate) state: State<R, N>,
}

/// Position, velocity and acceleration at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State<R, const N: usize> {
    pub(crate) t: R,
    pub(crate) q: [R; N],
    qd: [R; N],
    qdd: [R; N],
    pub(crate) margin: R,
    /// What the margin changed by in the last step over the time (s) that it took.
    pub(crate) margin_rate: R,
    statistics: Statistics,
    tangent: Tangent<R, N>,
    /// The Newton step that is still to be made, where the position does not close.
    pub(crate) repair: Option<[R; N]>,
}

/// A position that a solver came to.
#[derive(Clone, Copy)]
pub(crate) struct Found<R, const N: usize> {
    pub(crate) t: R,
    pub(crate) q: [R; N],
    pub(crate) statistics: Statistics,
    /// Why it does not close, if so.
    pub(crate) open: Option<Failure>,
}

/// What a position follows.
#[derive(Clone, Copy)]
pub(crate) enum Before<'a, R, const N: usize> {
    /// A guess: branches that pick the assembly alone count.
    Guess,
    /// A position that was one of this assembly.
    Saved,
    /// The state before the step.
    State(&'a State<R, N>),
}

/// How the mechanism moved with its drivers where it was regular last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tangent<R, const N: usize> {
    qd: [R; N],
    /// Φ_t there, over the rows' scales: speed and direction of the drivers.
    drive: [R; N],
}

impl<S: Kinematic<R, N>, R: Real, const N: usize> Stepper<S, R, N> {
    /// Assembles `mechanism` from `guess` (N) at time `t` (s); velocity and acceleration follow.
    ///
    /// # Errors
    /// Those of [`assemble`](crate::assemble()), and [`Failure::Singular`] where the first position does not
    /// determine rates.
    pub fn assemble(mechanism: S, guess: impl Into<[R; N]>, t: R) -> Result<Self, Failure> {
        let assembled = assemble(&mechanism, guess, t)?;
        let parameters = mechanism.parameters();
        let found = Found { t, q: assembled.q, statistics: assembled.statistics, open: None };
        let state = State::at(&mechanism, &parameters, found, Before::Guess)?;
        Ok(Stepper { mechanism, parameters, fault: None, state })
    }

    /// Moves on by `h` (s); 0 solves anew, negative goes back.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    #[inline]
    pub fn advance(&mut self, h: R) -> Result<Statistics, Failure> {
        self.advance_to(self.state.t + h)
    }

    /// Moves on to time `t` (s).
    ///
    /// Predicts q + h q̇ + h²/2 q̈ (near a singular position by the last regular tangent), solves the position by [`Newton`](crate::Newton), factorises Φ_q once, and
    /// solves velocity and acceleration with it.
    ///
    /// # Errors
    /// [`Failure::NonFinite`], [`Failure::NotConverged`], [`Failure::Singular`], [`Failure::WrongBranch`]; the
    /// state is then bit for bit what it was.
    #[inline]
    pub fn advance_to(&mut self, t: R) -> Result<Statistics, Failure> {
        if let Some(failure) = self.fault.or(time_failure(t)) {
            return Err(failure);
        }
        let start = self.predicted(t);
        let (q, statistics) = solve_position(&self.mechanism, &self.parameters, &start, t)?;
        let found = Found { t, q, statistics, open: None };
        self.state = State::at(&self.mechanism, &self.parameters, found, Before::State(&self.state))?;
        Ok(statistics)
    }

    /// The frames from now to `until` (s) in `steps` equal steps; see [`Sweep`].
    pub fn sweep(&mut self, until: R, steps: u32) -> Sweep<'_, S, R, N> {
        Sweep::new(self, until, steps)
    }

    /// Changes parameters or inputs. The state stands until the next advance solves with the new values.
    ///
    /// A value that is NaN or infinite is reported by that advance; change it back, and go on.
    #[inline]
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        let result = change(&mut self.mechanism);
        self.parameters = self.mechanism.parameters();
        self.fault = variable_failure(&self.mechanism);
        result
    }

    /// Time (s).
    pub fn t(&self) -> R {
        self.state.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[R; N] {
        &self.state.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[R; N] {
        &self.state.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[R; N] {
        &self.state.qdd
    }

    /// The mechanism with its parameters and inputs.
    pub fn mechanism(&self) -> &S {
        &self.mechanism
    }

    /// Stage-0 values of the mechanism.
    pub fn parameters(&self) -> &S::Parameters {
        &self.parameters
    }

    /// Margin to singularity: 0 where singular, at most 1, independent of units.
    pub fn margin(&self) -> R {
        self.state.margin
    }

    /// What the last position cost.
    pub fn statistics(&self) -> Statistics {
        self.state.statistics
    }

    /// Outputs with their time derivatives.
    ///
    /// Not finite where a definition has no value at this position, the root of a negative number for instance; a
    /// [`Sweep`] reports that as [`Failure::NonFinite`].
    #[inline]
    pub fn outputs(&self) -> S::Outputs {
        self.mechanism.outputs(&self.parameters, &self.position(), &self.state.qd, &self.state.qdd)
    }

    /// Residuals Φ(q, t): N, in the unit of the row.
    pub fn phi(&self) -> [R; N] {
        self.mechanism.phi(&self.parameters, &self.position())
    }

    /// Largest |Φᵢ| over its row's scale: how far the loops are open, in reference lengths (rad for angle rows).
    pub fn closure_error(&self) -> R {
        let scales = self.mechanism.row_scales(&self.parameters);
        let errors = self.phi().into_iter().zip(scales).map(|(residual, scale)| (residual / scale).abs());
        errors.fold(R::constant(0.0), |largest, error| largest.max(error))
    }

    /// Stage-1 values of the state.
    fn position(&self) -> S::Position {
        self.mechanism.position(&self.parameters, &self.state.q, self.state.t)
    }

    /// The position at `t` as the state foresees it.
    #[inline(always)]
    pub(crate) fn predicted(&self, t: R) -> [R; N] {
        let state = &self.state;
        let mut predicted =
            if state.is_regular() { self.extrapolated(t - state.t) } else { self.continued(t) };
        if let Some(repair) = &state.repair {
            predicted.iter_mut().zip(repair).for_each(|(coordinate, step)| *coordinate = *coordinate + *step);
        }
        // A jump in time that overflows the prediction is left to the solver, from where the mechanism stands.
        if predicted.iter().fold(true, |all, coordinate| all & coordinate.is_finite()) {
            predicted
        } else {
            state.q
        }
    }

    /// q + h q̇ + h²/2 q̈, without the last term where it is too large to be trusted.
    #[inline(always)]
    fn extrapolated(&self, h: R) -> [R; N] {
        let State { q, qd, qdd, .. } = self.state;
        let half_square = R::constant(0.5) * h * h;
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let limit = R::constant(LARGEST_SECOND_ORDER_TERM);
        let mut trusted = true;
        for (acceleration, scale) in qdd.iter().zip(&scales) {
            trusted &= (half_square * *acceleration).abs() <= limit * *scale;
        }
        let curvature = if trusted { half_square } else { R::constant(0.0) };
        let mut predicted = q;
        for ((coordinate, rate), acceleration) in predicted.iter_mut().zip(qd).zip(qdd) {
            *coordinate = *coordinate + h * rate + curvature * acceleration;
        }
        predicted
    }

    /// Near a singular position: the tangent of the last regular one times what the drivers have moved since.
    ///
    /// The drivers' movement is read from the rows that they open: Φ(q, t) with the new time and inputs, along Φ_t
    /// at the tangent. So a driver that jitters, dwells or turns back is followed in what it does.
    #[cold]
    #[inline(never)]
    fn continued(&self, t: R) -> [R; N] {
        let State { q, tangent, .. } = &self.state;
        let position = self.mechanism.position(&self.parameters, q, t);
        let opened = self.mechanism.phi(&self.parameters, &position);
        let scales = self.mechanism.row_scales(&self.parameters);
        let (mut moved, mut square) = (R::constant(0.0), R::constant(0.0));
        for ((residual, scale), drive) in opened.iter().zip(&scales).zip(&tangent.drive) {
            moved = moved + *residual / *scale * *drive;
            square = square + *drive * *drive;
        }
        let elapsed = if R::constant(0.0) < square { moved / square } else { R::constant(0.0) };
        let mut predicted = *q;
        predicted
            .iter_mut()
            .zip(&tangent.qd)
            .for_each(|(coordinate, rate)| *coordinate = *coordinate + elapsed * *rate);
        predicted
    }
}

impl<R: Real, const N: usize> State<R, N> {
    /// The state at a position that closes, or nearly so: not singular, in the declared assembly, with finite rates.
    #[inline(always)]
    pub(crate) fn at<S: Kinematic<R, N>>(
        mechanism: &S,
        parameters: &S::Parameters,
        found: Found<R, N>,
        before: Before<'_, R, N>,
    ) -> Result<Self, Failure> {
        let Found { t, q, statistics, open } = found;
        let scales = mechanism.coordinate_scales(parameters);
        if let Some(failure) = coordinate_failure::<S, R, N>(&q, &scales, t) {
            return Err(failure);
        }
        let position = mechanism.position(parameters, &q, t);
        let factors = factorize(mechanism, parameters, &position, t)?;
        if let Some(failure) =
            branch_failure(mechanism, parameters, &position, t, matches!(before, Before::Guess))
        {
            return Err(failure);
        }
        let qd = solve_velocity(mechanism, parameters, &position, &factors)?;
        let qdd = solve_acceleration(mechanism, parameters, &position, &qd, &factors)?;
        let drive = || {
            let mut drive = mechanism.phi_t(parameters, &position);
            let scales = mechanism.row_scales(parameters);
            drive.iter_mut().zip(scales).for_each(|(rate, scale)| *rate = *rate / scale);
            drive
        };
        let margin = factors.margin();
        let tangent = match before {
            Before::State(last) if margin < R::constant(REGULAR_ZONE) => last.tangent,
            _ => Tangent { qd, drive: drive() },
        };
        let margin_rate = match before {
            Before::State(last) if t == last.t => last.margin_rate,
            Before::State(last) => (margin - last.margin) / (t - last.t),
            _ => R::constant(0.0),
        };
        let repair = match open {
            None => None,
            Some(failure) => {
                let step = solve_correction(mechanism, parameters, &position, &factors)?;
                let size = largest_difference(&step, &[R::constant(0.0); N], &scales);
                let near = size <= R::constant(LARGEST_OPEN_STEP) * margin;
                Some(if near { step } else { return Err(failure) })
            }
        };
        Ok(State { t, q, qd, qdd, margin, margin_rate, statistics, tangent, repair })
    }

    fn is_regular(&self) -> bool {
        R::constant(REGULAR_ZONE) <= self.margin
    }
}

//! Solvers of kinematics.

use mbs_runtime::Kept;
use mbs_runtime::{
    Assembled, Budget, Failure, Frame, Kinematic, Real, RegularFactors, Saved, Statistics, Step, Stepper,
};

entry_points! {
    /// The next position.
    fn solve_position[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, start: &[R; N], t: R,
    ) -> Result<([R; N], Statistics), Failure> {
        mbs_runtime::solve_position(mechanism, parameters, start, t)
    }
    /// Factors that rates are solved with.
    fn factorize[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, t: R,
    ) -> Result<RegularFactors<S::Factors, R>, Failure> {
        mbs_runtime::factorize(mechanism, parameters, position, t)
    }
    /// q̇.
    fn solve_velocity[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, factors: &RegularFactors<S::Factors, R>,
    ) -> Result<[R; N], Failure> {
        mbs_runtime::solve_velocity(mechanism, parameters, position, factors)
    }
    /// q̈.
    fn solve_acceleration[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[R; N],
        factors: &RegularFactors<S::Factors, R>,
    ) -> Result<[R; N], Failure> {
        mbs_runtime::solve_acceleration(mechanism, parameters, position, qd, factors)
    }
    /// The first position.
    fn assemble[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, guess: [R; N], t: R,
    ) -> Result<Assembled<R, N>, Failure> {
        mbs_runtime::assemble(mechanism, guess, t)
    }
    /// The lecture's method.
    fn newton_raphson[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, q: [R; N], t: R,
    ) -> Result<([R; N], u32), Failure> {
        mbs_runtime::newton_raphson(mechanism, q, t)
    }
    /// A stepper in its first position.
    fn stepper[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: S, guess: [R; N], t: R,
    ) -> Result<Stepper<S, R, N, M>, Failure> {
        Stepper::assemble(mechanism, guess, t)
    }
    /// A step.
    fn advance[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &mut Stepper<S, R, N, M>, h: R,
    ) -> Result<Statistics, Failure> {
        stepper.advance(h)
    }
    /// A step in a fixed amount of work.
    fn step[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &mut Stepper<S, R, N, M>, h: R, budget: Budget,
    ) -> Step {
        stepper.step(h, budget)
    }
    /// Several periods at once; whether the last is degraded, and the time to singular.
    fn skip[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &mut Stepper<S, R, N, M>, period: R, periods: u32, budget: Budget,
    ) -> (Step, bool, Option<R>) {
        (stepper.skip(period, periods, budget), stepper.is_degraded(), stepper.time_to_singular())
    }
    /// A state as bytes.
    fn save[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>, bytes: &mut [u8],
    ) -> Option<usize> {
        stepper.save().to_le_bytes_into(bytes)
    }
    /// A state from bytes.
    fn saved[const N: usize, V: Kept](bytes: &[u8]) -> Option<Saved<N, V>> {
        Saved::from_le_bytes(bytes)
    }
    /// A stepper after a reset.
    fn assemble_near[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: S, saved: &Saved<N, S::Kept>, t: R,
    ) -> Result<Stepper<S, R, N, M>, Failure> {
        Stepper::assemble_near(mechanism, saved, t)
    }
    /// A change of a variable by name.
    fn change[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &mut Stepper<S, R, N, M>, name: &str, value: R,
    ) -> bool {
        stepper.change(|mechanism| S::variable(name).is_some_and(|index| mechanism.set(index, value)))
    }
    /// Bracket of the time at which a motion stops.
    fn stop[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](stepper: &Stepper<S, R, N, M>, t: R) -> Option<(R, R)> {
        stepper.reach_towards(t).map(|stop| (stop.reachable, stop.refused))
    }
    /// A length too small beside the rest.
    fn ill_scaled[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](stepper: &Stepper<S, R, N, M>) -> Option<f64> {
        stepper.ill_scaled().map(|found| found.resolution)
    }
    /// Bracket of the value at which a variable stops.
    fn reach_of[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>, index: usize, value: R,
    ) -> Option<(R, R)> {
        stepper.reach_of(index, value).map(|stop| (stop.reachable, stop.refused))
    }
    /// The state with its outputs.
    fn frame[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>,
    ) -> Frame<R, S::Outputs, N> {
        stepper.frame()
    }
    /// A motion; the last frame's closure error, and how many frames there were.
    fn sweep[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &mut Stepper<S, R, N, M>, until: R, steps: u32,
    ) -> Result<(R, u32), Failure> {
        let (mut closure_error, mut frames) = (R::constant(0.0), 0_u32);
        for frame in stepper.sweep(until, steps) {
            closure_error = frame?.closure_error;
            frames = frames.saturating_add(1);
        }
        Ok((closure_error, frames))
    }
    /// Rank, and how many rows follow from others.
    fn redundancy[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>,
    ) -> (usize, usize) {
        let redundancy = stepper.redundancy();
        (redundancy.rank, redundancy.rows().count())
    }
    /// Working ranges, and how many are nearly left.
    fn warnings[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>,
    ) -> (S::Limits, usize) {
        (stepper.limits(), stepper.warnings().count())
    }
    /// Residuals, closure error and outputs.
    fn open[S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize](
        stepper: &Stepper<S, R, N, M>,
    ) -> ([R; M], R, S::Outputs) {
        (stepper.phi(), stepper.closure_error(), stepper.outputs())
    }
}

//! Every function of emitted code, every solver, each by itself.
//!
//! With the feature `no-panic` a function that can panic does not link, and the linker names it.

use mbs_runtime::driver::{
    CubicSpline, End, FitError, Law, LawError, PeriodicQuintic, Rise, Segment, Segments, Trapezoidal,
};
use mbs_runtime::{
    Assembled, Budget, Evaluation, Failure, Frame, Function, Kinematic, Margin, Mechanism, Newton, Outcome,
    Real, RegularFactors, Saved, Scalar, Statistics, Step, Stepper,
};
#[cfg(feature = "no-panic")]
use no_panic::no_panic;

macro_rules! entry_points {
    ($($(#[$attribute:meta])* fn $name:ident[$($generics:tt)*]($($argument:ident: $kind:ty),* $(,)?) -> $result:ty $body:block)*) => {
        $(
            $(#[$attribute])*
            #[cfg_attr(feature = "no-panic", no_panic)]
            #[inline(never)]
            pub fn $name<$($generics)*>($($argument: $kind),*) -> $result $body
        )*
    };
}

entry_points! {
    /// Sets every parameter and input to what it is.
    fn access[S: Mechanism<T, N, N>, T: Scalar, const N: usize](mechanism: &mut S) -> bool {
        (0..=S::VARIABLES.len()).fold(true, |all, index| match mechanism.get(index) {
            Some(value) => all & mechanism.set(index, value),
            None => all & (index == S::VARIABLES.len()),
        })
    }
    /// The design in one lane.
    fn lane[S: Mechanism<T, N, N>, T: Scalar, const N: usize](mechanism: &S, lane: usize) -> S::Lane {
        mechanism.lane(lane)
    }
    /// Stage 0.
    fn parameters[S: Mechanism<T, N, N>, T: Scalar, const N: usize](mechanism: &S) -> S::Parameters {
        mechanism.parameters()
    }
    /// The text's guess.
    fn guess[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; N] {
        mechanism.guess(parameters)
    }
    /// Metric of the coordinates.
    fn coordinate_scales[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; N] {
        mechanism.coordinate_scales(parameters)
    }
    /// Metric of the rows.
    fn row_scales[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; N] {
        mechanism.row_scales(parameters)
    }
    /// Stage 1.
    fn position[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, q: &[T; N], t: T,
    ) -> S::Position {
        mechanism.position(parameters, q, t)
    }
    /// Φ.
    fn phi[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; N] {
        mechanism.phi(parameters, position)
    }
    /// Φ_q.
    fn phi_q[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [[T; N]; N] {
        mechanism.phi_q(parameters, position)
    }
    /// Φ_t.
    fn phi_t[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; N] {
        mechanism.phi_t(parameters, position)
    }
    /// Φ_tt.
    fn phi_tt[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; N] {
        mechanism.phi_tt(parameters, position)
    }
    /// Φ_qt q̇.
    fn phi_qt_qd[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N],
    ) -> [T; N] {
        mechanism.phi_qt_qd(parameters, position, qd)
    }
    /// γ.
    fn gamma[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N],
    ) -> [T; N] {
        mechanism.gamma(parameters, position, qd)
    }
    /// Branch conditions.
    fn branches[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> S::Branches {
        mechanism.branches(parameters, position)
    }
    /// Outputs.
    fn outputs[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N], qdd: &[T; N],
    ) -> S::Outputs {
        mechanism.outputs(parameters, position, qd, qdd)
    }
    /// Φ, Φ_q, Φ_t, γ in one call.
    fn evaluate[S: Mechanism<T, N, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, q: &[T; N], t: T, qd: &[T; N],
    ) -> Evaluation<T, S::Entries, N> {
        mechanism.evaluate(parameters, q, t, qd)
    }
    /// Positions of all lanes at once.
    fn solve_blocks[S: Kinematic<T, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, q: &mut [T; N], t: T,
    ) -> T::Lanes<Outcome> {
        mechanism.solve_blocks(parameters, q, t, &mut Newton::new(T::constant(1.0)))
    }
    /// Factors of all lanes at once.
    fn factorize_blocks[S: Kinematic<T, N>, T: Scalar, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> (S::Factors, Margin<T>) {
        mechanism.factorize(parameters, position)
    }
    /// Φ_q x = b.
    fn solve_linear[S: Kinematic<T, N>, T: Scalar, const N: usize](
        mechanism: &S, factors: &S::Factors, b: &[T; N],
    ) -> [T; N] {
        mechanism.solve_linear(factors, b)
    }

    /// The next position.
    fn solve_position[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, parameters: &S::Parameters, start: &[R; N], t: R,
    ) -> Result<([R; N], Statistics), Failure> {
        mbs_runtime::solve_position(mechanism, parameters, start, t)
    }
    /// Factors that rates are solved with.
    fn factorize[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, t: R,
    ) -> Result<RegularFactors<S::Factors, R>, Failure> {
        mbs_runtime::factorize(mechanism, parameters, position, t)
    }
    /// q̇.
    fn solve_velocity[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, factors: &RegularFactors<S::Factors, R>,
    ) -> Result<[R; N], Failure> {
        mbs_runtime::solve_velocity(mechanism, parameters, position, factors)
    }
    /// q̈.
    fn solve_acceleration[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[R; N],
        factors: &RegularFactors<S::Factors, R>,
    ) -> Result<[R; N], Failure> {
        mbs_runtime::solve_acceleration(mechanism, parameters, position, qd, factors)
    }
    /// The first position.
    fn assemble[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, guess: [R; N], t: R,
    ) -> Result<Assembled<R, N>, Failure> {
        mbs_runtime::assemble(mechanism, guess, t)
    }
    /// The lecture's method.
    fn newton_raphson[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: &S, q: [R; N], t: R,
    ) -> Result<([R; N], u32), Failure> {
        mbs_runtime::newton_raphson(mechanism, q, t)
    }
    /// A stepper in its first position.
    fn stepper[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: S, guess: [R; N], t: R,
    ) -> Result<Stepper<S, R, N>, Failure> {
        Stepper::assemble(mechanism, guess, t)
    }
    /// A step.
    fn advance[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &mut Stepper<S, R, N>, h: R,
    ) -> Result<Statistics, Failure> {
        stepper.advance(h)
    }
    /// A step in a fixed amount of work.
    fn step[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &mut Stepper<S, R, N>, h: R, budget: Budget,
    ) -> Step {
        stepper.step(h, budget)
    }
    /// Several periods at once; whether the last is degraded, and the time to singular.
    fn skip[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &mut Stepper<S, R, N>, period: R, periods: u32, budget: Budget,
    ) -> (Step, bool, Option<R>) {
        (stepper.skip(period, periods, budget), stepper.is_degraded(), stepper.time_to_singular())
    }
    /// A state as bytes.
    fn save[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &Stepper<S, R, N>, bytes: &mut [u8],
    ) -> Option<usize> {
        stepper.save().to_le_bytes_into(bytes)
    }
    /// A state from bytes.
    fn saved[const N: usize](bytes: &[u8]) -> Option<Saved<N>> {
        Saved::from_le_bytes(bytes)
    }
    /// A stepper after a reset.
    fn assemble_near[S: Kinematic<R, N>, R: Real, const N: usize](
        mechanism: S, saved: &Saved<N>, t: R,
    ) -> Result<Stepper<S, R, N>, Failure> {
        Stepper::assemble_near(mechanism, saved, t)
    }
    /// A change of a variable by name.
    fn change[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &mut Stepper<S, R, N>, name: &str, value: R,
    ) -> bool {
        stepper.change(|mechanism| S::variable(name).is_some_and(|index| mechanism.set(index, value)))
    }
    /// Where a motion stops: its bracket.
    fn stop[S: Kinematic<R, N>, R: Real, const N: usize](stepper: &Stepper<S, R, N>, t: R) -> Option<(R, R)> {
        stepper.stop_towards(t).map(|stop| (stop.reachable, stop.refused))
    }
    /// A length too small beside the rest.
    fn ill_scaled[S: Kinematic<R, N>, R: Real, const N: usize](stepper: &Stepper<S, R, N>) -> Option<f64> {
        stepper.ill_scaled().map(|found| found.resolution)
    }
    /// Where a variable stops.
    fn stop_of[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &Stepper<S, R, N>, index: usize, value: R,
    ) -> Option<(R, R)> {
        stepper.stop_of(index, value).map(|stop| (stop.reachable, stop.refused))
    }
    /// The state with its outputs.
    fn frame[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &Stepper<S, R, N>,
    ) -> Frame<R, S::Outputs, N> {
        stepper.frame()
    }
    /// A motion; the last frame's closure error, and how many frames there were.
    fn sweep[S: Kinematic<R, N>, R: Real, const N: usize](
        stepper: &mut Stepper<S, R, N>, until: R, steps: u32,
    ) -> Result<(R, u32), Failure> {
        let (mut closure_error, mut frames) = (R::constant(0.0), 0_u32);
        for frame in stepper.sweep(until, steps) {
            closure_error = frame?.closure_error;
            frames = frames.saturating_add(1);
        }
        Ok((closure_error, frames))
    }

    /// Value and derivatives of a driver.
    fn jet[F: Function<T>, T: Scalar, const K: usize](function: &F, x: T) -> [T; K] {
        function.jet(x)
    }
    /// Where a driver is less smooth.
    fn breakpoint_after[F: Function<T>, T: Scalar](function: &F, x: f64) -> Option<f64> {
        function.breakpoint_after(x)
    }
    /// A motion law between dwells.
    fn rise[L: Law](start: f64, duration: f64, from: f64, to: f64) -> Result<Rise<L>, LawError> {
        Rise::new(start, duration, from, to)
    }
    /// A periodic cam law.
    fn segments[L: Law, const S: usize](start: f64, segments: [Segment; S]) -> Result<Segments<L, S>, LawError> {
        Segments::new(start, segments)
    }
    /// Motion within limits.
    fn trapezoidal[](distance: f64, speed: f64, acceleration: f64) -> Result<Trapezoidal, LawError> {
        Trapezoidal::new(distance, speed, acceleration)
    }
    /// A cubic fit.
    fn cubic_spline[const P: usize](
        knots: &[f64; P], ends: [End; 2], x: &[f64], y: &[f64],
    ) -> Result<CubicSpline<P>, FitError> {
        CubicSpline::least_squares(knots, ends, x, y)
    }
    /// A periodic fit.
    fn periodic_quintic[const P: usize](
        knots: &[f64; P], period: f64, x: &[f64], y: &[f64],
    ) -> Result<PeriodicQuintic<P>, FitError> {
        PeriodicQuintic::least_squares(knots, period, x, y)
    }
}

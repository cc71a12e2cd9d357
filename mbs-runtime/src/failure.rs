//! What can go wrong, as values that name the row or the coordinate and its line in the text.

use core::fmt;

use crate::{Entry, Scalar};

/// How the solution of one diagonal block, or of all of them, ended in one lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every residual is within its tolerance.
    Converged,
    /// The residual of `row` stayed above its tolerance.
    NotConverged {
        /// Index of the row in Φ.
        row: u16,
    },
    /// Rows more than coordinates contradict each other: their least residual is above its tolerance.
    Inconsistent {
        /// Index in Φ of the row that is farthest above it.
        row: u16,
    },
    /// The residual or the Jacobian became NaN or infinite.
    NonFinite {
        /// Index of the row in Φ.
        row: u16,
    },
}

/// Position, or which of its time derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// The rows themselves.
    Position,
    /// Their first time derivatives.
    Velocity,
    /// Their second time derivatives.
    Acceleration,
}

/// Lane by lane the first of two outcomes that is no success.
pub fn first_failure<T: Scalar>(first: T::Lanes<Outcome>, second: T::Lanes<Outcome>) -> T::Lanes<Outcome> {
    let at = |outcomes: &T::Lanes<Outcome>, lane: usize| outcomes.as_ref().get(lane).copied();
    T::per_lane(|lane| match at(&first, lane) {
        Some(failure) if failure != Outcome::Converged => failure,
        _ => at(&second, lane).unwrap_or(Outcome::Converged),
    })
}

/// Why a mechanism was not assembled, moved or solved. The caller's state is as it was before the call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// A value that came in, or a row evaluated from finite values, is NaN or infinite.
    NonFinite {
        /// The coordinate, parameter, input, time or row.
        name: &'static str,
        /// Its line in the text; 0 for the time.
        line: u32,
    },
    /// A mass, moment of inertia or stiffness is negative with the parameters as they are.
    Negative {
        /// Body or force, and field.
        name: &'static str,
        /// Its line in the text.
        line: u32,
        /// The first parameter that it is made of.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// A coordinate is so large that its number type no longer resolves a thousandth of its scale.
    Unresolved {
        /// The coordinate.
        coordinate: Entry,
        /// Its value, in its unit.
        value: f64,
        /// Time (s).
        time: f64,
    },
    /// Newton's method did not reach the tolerance from the previous position.
    NotConverged {
        /// The row with the largest residual, in the reference metric.
        row: Entry,
        /// Its residual, in the unit of the row.
        residual: f64,
        /// The tolerance that it missed, in the unit of the row.
        required: f64,
        /// Evaluations of the constraints spent.
        iterations: u32,
        /// Time (s) of the position that was sought.
        time: f64,
    },
    /// No start led to a position: the mechanism cannot be assembled as it is dimensioned, or not from there.
    NotAssemblable {
        /// The row with the largest part of the least residual found, in the reference metric.
        row: Entry,
        /// That part, in the unit of the row.
        residual: f64,
        /// All rows that hold it: they contradict each other there, and nothing can close one of them without opening
        /// another farther.
        rows: Holding,
        /// Time (s) at which the position was sought.
        time: f64,
    },
    /// The Jacobian is singular, a dead centre or a bifurcation: rates are not determined.
    Singular {
        /// A row of the singular block.
        row: Entry,
        /// A coordinate that the block does not determine.
        coordinate: Entry,
        /// Margin to singularity: 0 where singular, at most 1, independent of units.
        margin: f64,
        /// The margin below which rates are refused.
        required: f64,
        /// What sets the reference length, in parts of which the margin counts lengths. Where it is far longer than the
        /// links, everything looks singular.
        reference: Option<&'static Entry>,
        /// Time (s).
        time: f64,
    },
    /// The position solves the constraints in another assembly than the text's `branch` declares.
    WrongBranch {
        /// The branch condition.
        branch: Entry,
        /// Its value, which should be positive.
        value: f64,
        /// Time (s).
        time: f64,
    },
    /// A quantity leaves the working range that a `limit` of the text allows it.
    BeyondLimit {
        /// The limit.
        limit: Entry,
        /// The quantity, in the limit's unit.
        value: f64,
        /// The bound that it passes.
        bound: f64,
        /// Time (s) of the position that was sought.
        time: f64,
    },
    /// The position nearest to a saved state is not next to it.
    TooFar {
        /// The coordinate that is farthest off.
        coordinate: Entry,
        /// By how much, in the reference metric (rad, or reference lengths).
        distance: f64,
        /// The distance that is allowed.
        allowed: f64,
        /// Time (s).
        time: f64,
    },
    /// A number that sets a method, or its tolerance, is outside what it may be.
    Unsuitable {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The largest that is allowed; the least is 0.
        most: f64,
    },
    /// No multiplier balances the forces that depend on it: friction changes it by as much as it takes up.
    Locked {
        /// The row whose multiplier changes most.
        row: Entry,
        /// Iterations spent.
        iterations: u32,
        /// Time (s).
        time: f64,
    },
    /// A step that is 0, negative, no number, or too small to change the time.
    InvalidStep {
        /// The step (s).
        step: f64,
        /// Time (s) at which it was to be taken.
        time: f64,
    },
    /// A step takes a coordinate farther than a mechanism moves: the integration has lost the motion.
    Unbounded {
        /// The coordinate that it takes farthest, in the reference metric.
        coordinate: Entry,
        /// Its value there.
        value: f64,
        /// Time (s) of the step's end, or of a stage of it.
        time: f64,
    },
    /// The end of an adaptive run takes more steps than one call may, as far as its first thousand tell.
    OutOfReach {
        /// The end (s).
        until: f64,
        /// The step (s) that the tolerance allows.
        step: f64,
        /// Time (s) that was reached.
        time: f64,
    },
    /// The tolerance of adaptive steps is below what the number type can keep to.
    UnresolvedTolerance {
        /// Relative and absolute tolerance together.
        tolerance: f64,
        /// The smallest that is possible.
        least: f64,
        /// Time (s) at which it was to be kept to.
        time: f64,
    },
    /// Next to a singular position no step is accurate enough: rounding decides where the motion goes.
    Undecided {
        /// How near Φ_q is to losing rank.
        margin: f64,
        /// Time (s) that was reached.
        time: f64,
    },
    /// No step that still changes the time is accurate enough.
    StepTooSmall {
        /// The last step (s) tried.
        step: f64,
        /// Time (s) that was reached.
        time: f64,
    },
    /// The step is too long for the method to be stable.
    StepTooLong {
        /// Step times frequency.
        product: f64,
        /// The largest that is allowed.
        allowed: f64,
        /// Time (s).
        time: f64,
    },
    /// Rows of which some should follow from others contradict each other: nothing satisfies all of them.
    Inconsistent {
        /// The rows that stay open, those farthest off first.
        rows: Holding,
        /// Whether they, or their time derivatives.
        level: Level,
        /// What the worst of them is off by where all together are least so, in its unit (per s, per s²).
        residual: f64,
        /// What is allowed.
        required: f64,
        /// Time (s).
        time: f64,
    },
    /// The start, or a state to be put back onto the constraints, violates a row.
    OffConstraints {
        /// The row that is violated most, in the reference metric.
        row: Entry,
        /// Whether its rate is violated, and not the row itself.
        rate: bool,
        /// By how much, in the unit of the row (per second).
        residual: f64,
        /// What is allowed.
        allowed: f64,
        /// Time (s).
        time: f64,
    },
    /// A motion that the rows leave free moves no mass, so that its acceleration is not determined.
    Inertialess {
        /// The coordinate that moves most in it.
        coordinate: Entry,
        /// Time (s).
        time: f64,
    },
    /// No coordinate changes a row, so that it holds nothing where it should: the length between two points is 0, or bars at rest are
    /// in line.
    Flat {
        /// The row.
        row: Entry,
        /// Time (s).
        time: f64,
    },
    /// Forces and inertia did not come into balance within the iterations of an implicit method, or of the search for a rest, or what
    /// states integrate not to 0.
    Unbalanced {
        /// The coordinate that is farthest from balance.
        coordinate: Entry,
        /// Iterations spent.
        iterations: u32,
        /// Time (s).
        time: f64,
    },
    /// There is no position of rest near: where the forces come nearest to balance they still push.
    Restless {
        /// A coordinate that moves as they push.
        coordinate: Entry,
        /// Work (J) that they would do along a unit of it, the others following.
        force: f64,
        /// Time (s).
        time: f64,
    },
    /// A first-order state has no value at which it rests: its rate is not 0 where the search came to its end and neither it nor a free
    /// motion changes that, or is held at 0 by what no force of its own bears.
    Unsettled {
        /// The state.
        state: Entry,
        /// Time (s).
        time: f64,
    },
    /// The text has first-order states, and what is asked for depends on their values at that time.
    StatesUnknown {
        /// The first of them.
        state: Entry,
        /// Time (s).
        time: f64,
    },
    /// The saved state is that of a mechanism with another name or other coordinates.
    Foreign {
        /// Name of the mechanism that it was to be the state of.
        mechanism: &'static str,
    },
}

/// Rows that hold a mechanism open, those with the largest parts of the residual first; at most four of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holding {
    entries: &'static [Entry],
    indices: [u16; Holding::MOST],
    count: usize,
}

impl Holding {
    /// Rows that are kept.
    const MOST: usize = 4;

    /// Part of the largest residual from which a row counts. A least residual is stationary to √ε of itself: what
    /// a row is off beside is a ten-millionth.
    const SHARE: f64 = 1e-3;

    /// Those of `entries` whose `residuals`, in the reference metric, count.
    pub(crate) fn of(entries: &'static [Entry], residuals: impl Iterator<Item = f64> + Clone) -> Self {
        let largest = residuals.clone().fold(0.0, f64::max);
        let mut holding = Holding { entries, indices: [0; Self::MOST], count: 0 };
        let mut parts = [0.0; Self::MOST];
        for (index, residual) in (0_u16..).zip(residuals) {
            if residual > Self::SHARE * largest {
                holding.insert(&mut parts, index, residual);
            }
        }
        holding
    }

    /// Sorts a row in; the smallest falls out where there is no room.
    fn insert(&mut self, parts: &mut [f64; Self::MOST], index: u16, residual: f64) {
        let (mut index, mut residual) = (index, residual);
        for (at, part) in self.indices.iter_mut().zip(parts.iter_mut()) {
            if *part < residual {
                core::mem::swap(part, &mut residual);
                core::mem::swap(at, &mut index);
            }
        }
        self.count = Self::MOST.min(self.count.saturating_add(1));
    }

    /// The rows, those that hold most first.
    pub fn rows(&self) -> impl Iterator<Item = Entry> + '_ {
        self.indices
            .iter()
            .take(self.count)
            .filter_map(|index| self.entries.get(usize::from(*index)).copied())
    }
}

impl fmt::Display for Holding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, row) in self.rows().enumerate() {
            let separator = if number == 0 { "" } else { ", " };
            write!(f, "{separator}`{}` (line {})", row.name, row.line)?;
        }
        Ok(())
    }
}

impl Failure {
    /// The same at `now` (s).
    pub(crate) fn at(mut self, now: f64) -> Self {
        match &mut self {
            Failure::Unresolved { time, .. }
            | Failure::NotConverged { time, .. }
            | Failure::NotAssemblable { time, .. }
            | Failure::Singular { time, .. }
            | Failure::WrongBranch { time, .. }
            | Failure::BeyondLimit { time, .. }
            | Failure::TooFar { time, .. }
            | Failure::InvalidStep { time, .. }
            | Failure::Unbounded { time, .. }
            | Failure::OutOfReach { time, .. }
            | Failure::UnresolvedTolerance { time, .. }
            | Failure::Undecided { time, .. }
            | Failure::StepTooSmall { time, .. }
            | Failure::StepTooLong { time, .. }
            | Failure::Inconsistent { time, .. }
            | Failure::OffConstraints { time, .. }
            | Failure::Inertialess { time, .. }
            | Failure::Flat { time, .. }
            | Failure::Restless { time, .. }
            | Failure::Unsettled { time, .. }
            | Failure::StatesUnknown { time, .. }
            | Failure::Locked { time, .. }
            | Failure::Unbalanced { time, .. } => *time = now,
            Failure::NonFinite { .. }
            | Failure::Negative { .. }
            | Failure::Unsuitable { .. }
            | Failure::Foreign { .. } => {}
        }
        self
    }

    /// Time (s) at which it happened; 0 where no time has a part in it.
    fn time(&self) -> f64 {
        match self {
            Failure::Unresolved { time, .. }
            | Failure::NotConverged { time, .. }
            | Failure::NotAssemblable { time, .. }
            | Failure::Singular { time, .. }
            | Failure::WrongBranch { time, .. }
            | Failure::BeyondLimit { time, .. }
            | Failure::TooFar { time, .. }
            | Failure::InvalidStep { time, .. }
            | Failure::Unbounded { time, .. }
            | Failure::OutOfReach { time, .. }
            | Failure::UnresolvedTolerance { time, .. }
            | Failure::Undecided { time, .. }
            | Failure::StepTooSmall { time, .. }
            | Failure::StepTooLong { time, .. }
            | Failure::Inconsistent { time, .. }
            | Failure::OffConstraints { time, .. }
            | Failure::Inertialess { time, .. }
            | Failure::Flat { time, .. }
            | Failure::Restless { time, .. }
            | Failure::Unsettled { time, .. }
            | Failure::StatesUnknown { time, .. }
            | Failure::Locked { time, .. }
            | Failure::Unbalanced { time, .. } => *time,
            Failure::NonFinite { .. }
            | Failure::Negative { .. }
            | Failure::Unsuitable { .. }
            | Failure::Foreign { .. } => 0.0,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = Time(self.time());
        match self {
            Failure::NonFinite { name, line: 0 } => write!(f, "`{name}` is not a finite number"),
            Failure::NonFinite { name, line } => write!(f, "`{name}` (line {line}) is not a finite number"),
            Failure::Negative { name, line, parameter, value } => write!(
                f,
                "`{name}` (line {line}) is {value:e}, with `{parameter}` as it is: masses, moments of inertia and the sum of two less the third, \
                 stiffness, damping and friction are at least 0"
            ),
            Failure::Unresolved { coordinate, value, .. } => write!(
                f,
                "`{}` (line {}) is {value:.3e} {} at t = {time} s, too large for its number type to tell positions \
                 apart; take off whole turns, or use `f64`",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            Failure::NotConverged { row, residual, required, iterations, .. } => write!(
                f,
                "no position at t = {time} s: after {iterations} iterations row `{}` (line {}) is still {residual:.3e} {} \
                 off, required {required:.3e}; take a smaller step, or check that the mechanism can reach this position",
                row.name, row.line, row.unit
            ),
            Failure::NotAssemblable { row, residual, rows, .. } => write!(
                f,
                "the mechanism cannot be assembled at t = {time} s: {rows} cannot hold {}, `{}` stays {residual:.3e} \
                 {} open at best; check the dimensions, or start from a better guess",
                if rows.rows().nth(1).is_some() { "together" } else { "with what is driven" },
                row.name,
                row.unit
            ),
            Failure::Singular { row, coordinate, margin, required, reference, .. } => {
                write!(
                    f,
                    "the mechanism is singular at t = {time} s: rows around `{}` (line {}) do not determine `{}` (line \
                     {}); margin {margin:.3e}, required {required:.3e}",
                    row.name, row.line, coordinate.name, coordinate.line
                )?;
                match reference {
                    Some(Entry { name, line, .. }) => {
                        write!(f, ", lengths in parts of `{name}` (line {line})")
                    }
                    None => Ok(()),
                }
            }
            Failure::WrongBranch { branch, value, .. } => write!(
                f,
                "the assembly found at t = {time} s is not the declared one: branch `{}` (line {}) is {value:.3e}, not \
                 positive; take a smaller step, or assemble from a guess on the other side",
                branch.name, branch.line
            ),
            Failure::BeyondLimit { limit, value, bound, .. } => write!(
                f,
                "limit `{}` (line {}) is passed at t = {time} s: {value} {} is beyond {bound}; turn back, or widen the \
                 range",
                limit.name, limit.line, limit.unit
            ),
            Failure::TooFar { coordinate, distance, allowed, .. } => write!(
                f,
                "the position at t = {time} s is not next to the saved one: `{}` (line {}) differs by {distance:.3e} in \
                 the reference metric, allowed {allowed:.3e}; start at the time and with the inputs of the saved state",
                coordinate.name, coordinate.line
            ),
            Failure::Unsuitable { name, value, most } if most.is_finite() => {
                write!(f, "the method's {name} is {value}: it must be between 0 and {most}")
            }
            Failure::Unsuitable { name, value, .. } => {
                write!(f, "the method's {name} is {value:e}: it must be a number and at least 0")
            }
            Failure::Locked { row, iterations, .. } => write!(
                f,
                "no balance of forces at t = {time} s after {iterations} iterations: friction changes the force of row `{}` (line {}) by as \
                 much as it takes up; with this coefficient the mechanism jams there, whatever the step",
                row.name, row.line
            ),
            Failure::InvalidStep { step, .. } => write!(
                f,
                "a step of {step:e} s from t = {time} s leads nowhere: it must be positive and change the time"
            ),
            Failure::Unbounded { coordinate, value, .. } => write!(
                f,
                "the motion grows without bound: a step takes `{}` (line {}) to {value:.3e} {} at t = {time} s; take smaller \
                 steps, project onto the constraints where they drift, or use an implicit method where the mechanism is stiff",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            Failure::OutOfReach { until, step, .. } => write!(
                f,
                "t = {} s is out of reach from t = {time} s: steps of {step:.3e} s, as the tolerance asks for, are too many; \
                 end earlier, loosen the tolerance, or advance in several calls",
                Time(*until)
            ),
            Failure::UnresolvedTolerance { tolerance, least, .. } => write!(
                f,
                "rounding alone is more than a tolerance of {tolerance:e} allows: at least {least:.1e} is needed in numbers of \
                 this type"
            ),
            Failure::Undecided { margin, .. } => write!(
                f,
                "rounding decides where the motion goes at t = {time} s, next to a singular position (margin {margin:.1e}): \
                 project onto the constraints, give the dimensions all their digits, or loosen the tolerance"
            ),
            Failure::StepTooSmall { step, .. } => write!(
                f,
                "stuck at t = {time} s: even a step of {step:.3e} s is not accurate enough; loosen the tolerance, look for \
                 a jump in the forces or for a mass or length of 0, or use an implicit method where the mechanism is stiff"
            ),
            Failure::StepTooLong { product, allowed, .. } => write!(
                f,
                "the step at t = {time} s is too long: step times frequency is {product:.3}, allowed {allowed:.3}; take a \
                 smaller step or a lower frequency"
            ),
            Failure::Inconsistent { rows, level, residual, required, .. } => write!(
                f,
                "{}{rows} contradict each other at t = {time} s: {residual:.3e} stays open at best, required \
                 {required:.3e}; give the dimensions that let these rows follow from one another all their digits, or \
                 leave the surplus rows out",
                match level {
                    Level::Position => "",
                    Level::Velocity => "the rates of ",
                    Level::Acceleration => "the accelerations of ",
                }
            ),
            Failure::OffConstraints { row, rate, residual, allowed, .. } => write!(
                f,
                "{} `{}` (line {}) is violated at t = {time} s: {residual:.3e}, allowed {allowed:.3e}; start on the \
                 constraints or let the start be projected; on the way, take smaller steps",
                if *rate { "the rate of row" } else { "row" },
                row.name,
                row.line
            ),
            Failure::Inertialess { coordinate, .. } => write!(
                f,
                "the acceleration of `{}` (line {}) is not determined at t = {time} s: it can move without any mass \
                 moving; give it mass, or a row that fixes it",
                coordinate.name, coordinate.line
            ),
            Failure::Flat { row, .. } => write!(
                f,
                "row `{}` (line {}) holds nothing at t = {time} s: no coordinate changes it there, as where a length is 0 or bars at \
                 rest are in line; give the length a value, or start beside that position",
                row.name, row.line
            ),
            Failure::Restless { coordinate, force, .. } => write!(
                f,
                "no position of rest at t = {time} s: where the forces come nearest to balance they still push `{}` (line \
                 {}) with {force:.3e} J/{}; let a force answer it, hold it by a drive, or start elsewhere",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            Failure::Unbalanced { coordinate, iterations, .. } => write!(
                f,
                "no balance of forces at t = {time} s after {iterations} iterations: `{}` (line {}) is farthest off; take \
                 a smaller step, or search for a rest from nearer",
                coordinate.name, coordinate.line
            ),
            Failure::Unsettled { state, .. } => write!(
                f,
                "no position of rest at t = {time} s: the rate of the state `{}` (line {}) does not vanish for any value of it",
                state.name, state.line
            ),
            Failure::StatesUnknown { state, .. } => write!(
                f,
                "the forces at t = {time} s depend on the state `{}` (line {}), whose value is not known; give the states too",
                state.name, state.line
            ),
            Failure::Foreign { mechanism } => {
                write!(f, "the saved state is not one of `{mechanism}`: name or coordinates differ")
            }
        }
    }
}

/// A time in plain digits, or with an exponent where those would be many.
struct Time(f64);

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Time(time) = *self;
        let plain = time == 0.0 || (1e-5..1e9).contains(&time.max(-time));
        if plain { write!(f, "{time}") } else { write!(f, "{time:e}") }
    }
}

impl core::error::Error for Failure {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    const ROW: Entry = Entry { name: "closure.0", unit: "m", line: 21 };

    #[test]
    fn every_failure_names_its_line_in_the_text() {
        let (time, residual, required) = (0.5, 1e-3, 1e-14);
        let failures = [
            Failure::NonFinite { name: "omega", line: 21 },
            Failure::Negative { name: "rod.mass", line: 21, parameter: "rho", value: -1.0 },
            Failure::Unresolved { coordinate: ROW, value: 1e300, time },
            Failure::NotConverged { row: ROW, residual, required, iterations: 9, time },
            Failure::NotAssemblable {
                row: ROW,
                residual,
                rows: Holding::of(&[ROW], [1.0].into_iter()),
                time,
            },
            Failure::Singular { row: ROW, coordinate: ROW, margin: 0.0, required, reference: None, time },
            Failure::WrongBranch { branch: ROW, value: -1.0, time },
            Failure::BeyondLimit { limit: ROW, value: 2.0, bound: 1.0, time },
            Failure::TooFar { coordinate: ROW, distance: 1.0, allowed: 0.5, time },
            Failure::Inconsistent {
                rows: Holding::of(&[ROW], [1.0].into_iter()),
                level: Level::Velocity,
                residual,
                required,
                time,
            },
            Failure::OffConstraints { row: ROW, rate: false, residual, allowed: required, time },
            Failure::Unbounded { coordinate: ROW, value: 1e12, time },
            Failure::Inertialess { coordinate: ROW, time },
            Failure::Flat { row: ROW, time },
            Failure::Restless { coordinate: ROW, force: 0.5, time },
            Failure::Unbalanced { coordinate: ROW, iterations: 9, time },
            Failure::Locked { row: ROW, iterations: 9, time },
            Failure::Unsettled { state: ROW, time },
            Failure::StatesUnknown { state: ROW, time },
        ];
        for failure in failures {
            assert!(failure.to_string().contains("(line 21)"), "{failure}");
        }
        let foreign = Failure::Foreign { mechanism: "Crank" }.to_string();
        assert_eq!(foreign, "the saved state is not one of `Crank`: name or coordinates differ");
        let (name, most) = ("spectral radius rho", 1.0);
        let radius = Failure::Unsuitable { name, value: 1.5, most }.to_string();
        assert_eq!(radius, "the method's spectral radius rho is 1.5: it must be between 0 and 1");
        assert_eq!(Failure::NonFinite { name: "t", line: 0 }.to_string(), "`t` is not a finite number");
    }

    #[test]
    fn rows_that_hold_are_named_with_the_largest_first() {
        const ENTRIES: &[Entry] = &[
            Entry { name: "a", unit: "m", line: 1 },
            Entry { name: "b", unit: "m", line: 2 },
            Entry { name: "c", unit: "m", line: 3 },
            Entry { name: "d", unit: "m", line: 4 },
            Entry { name: "e", unit: "m", line: 5 },
            Entry { name: "f", unit: "m", line: 6 },
        ];
        let names = |residuals: [f64; 6]| -> std::vec::Vec<&str> {
            Holding::of(ENTRIES, residuals.into_iter()).rows().map(|row| row.name).collect()
        };
        assert_eq!(names([0.0, 0.2, 1e-5, 0.3, 0.0, 0.1]), ["d", "b", "f"]);
        assert_eq!(names([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), ["f", "e", "d", "c"]);
        assert_eq!(names([0.0; 6]), [""; 0]);
        let two = Holding::of(ENTRIES, [0.0, 0.2, 0.0, 0.3].into_iter()).to_string();
        assert_eq!(two, "`d` (line 4), `b` (line 2)");
    }

    #[test]
    fn the_first_failure_of_a_lane_stays() {
        let (converged, first) = (Outcome::Converged, Outcome::NotConverged { row: 1 });
        let second = Outcome::NonFinite { row: 2 };
        type Three = crate::Lanes<f64, 3>;
        let outcomes = first_failure::<Three>([converged, first, converged], [converged, second, second]);
        assert_eq!(outcomes, [converged, first, second]);
    }
}

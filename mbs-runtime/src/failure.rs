//! What can go wrong, as values that name the row or the coordinate and its line in the text.

mod holding;
mod message;

use crate::{Entry, MissingSlope, Scalar};

pub use holding::Holding;

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
        /// The coordinate, parameter, input, time, row, limit or event function.
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
    /// From the last position to the one that is sought no way leads that leaves no doubt of the assembly.
    NotFollowed {
        /// Part of the way (0 to 1) to which it was followed.
        part: f64,
        /// Margin to singularity there.
        margin: f64,
        /// Time (s) of the position that was sought.
        time: f64,
    },
    /// The budget of a step ended on the way to the position that is sought; the next step goes on from where it ended, unless the
    /// budget leaves fewer evaluations than any part of a way takes.
    OverBudget {
        /// Part of the way (0 to 1) that was followed, from where this step began.
        part: f64,
        /// Evaluations of the constraints that the budget left for the way.
        evaluations: u32,
        /// The fewest that a part of a way takes.
        required: u32,
        /// Time (s) of the position that was sought.
        time: f64,
    },
    /// A row jumps between the last position and the one that is sought: a function of the time or of an input is not continuous.
    Discontinuous {
        /// The row that changes most.
        row: Entry,
        /// Part of the way (0 to 1) at which it jumps.
        part: f64,
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
    /// No multipliers balance the forces that depend on them: friction jams the mechanism.
    Locked {
        /// The row whose multiplier friction changes most.
        row: Entry,
        /// Time (s).
        time: f64,
    },
    /// More than one set of multipliers balances the forces that depend on them: friction leaves the motion undetermined.
    Ambiguous {
        /// The row whose multiplier friction changes most.
        row: Entry,
        /// How many sets of multipliers.
        solutions: u32,
        /// Whether these are all; else there are at least so many, and it is not known that there is but one.
        all: bool,
        /// Time (s).
        time: f64,
    },
    /// Friction depends on a multiplier that is not unique: rows that follow from each other share a force in any way, and each way makes
    /// another motion.
    SharedNormalForce {
        /// A row that shares the force.
        row: Entry,
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
    /// A step of fixed size whose energy grows by more than the power supplied can explain: it is too long to follow the motion.
    EnergyGain {
        /// Kinetic energy (J) at its end.
        kinetic: f64,
        /// Kinetic energy (J) at its start, with the potential energy released and the work of the power supplied on the way.
        available: f64,
        /// Time (s) of the step's end.
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
    /// What is asked for needs a derivative of the forces that a declared function is not smooth enough for.
    NotSmooth {
        /// The derivative, the function, and what it would have to be.
        missing: &'static MissingSlope,
    },
    /// The saved state is that of a mechanism with another name or other coordinates.
    Foreign {
        /// Name of the mechanism that it was to be the state of.
        mechanism: &'static str,
    },
}

impl Failure {
    /// The same at `now` (s).
    pub(crate) fn at(mut self, now: f64) -> Self {
        match &mut self {
            Failure::Unresolved { time, .. }
            | Failure::NotConverged { time, .. }
            | Failure::NotFollowed { time, .. }
            | Failure::OverBudget { time, .. }
            | Failure::Discontinuous { time, .. }
            | Failure::NotAssemblable { time, .. }
            | Failure::Singular { time, .. }
            | Failure::WrongBranch { time, .. }
            | Failure::BeyondLimit { time, .. }
            | Failure::TooFar { time, .. }
            | Failure::InvalidStep { time, .. }
            | Failure::Unbounded { time, .. }
            | Failure::EnergyGain { time, .. }
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
            | Failure::Ambiguous { time, .. }
            | Failure::SharedNormalForce { time, .. }
            | Failure::Unbalanced { time, .. } => *time = now,
            Failure::NonFinite { .. }
            | Failure::Negative { .. }
            | Failure::Unsuitable { .. }
            | Failure::NotSmooth { .. }
            | Failure::Foreign { .. } => {}
        }
        self
    }

    /// Time (s) at which it happened; 0 where no time has a part in it.
    fn time(&self) -> f64 {
        match self {
            Failure::Unresolved { time, .. }
            | Failure::NotConverged { time, .. }
            | Failure::NotFollowed { time, .. }
            | Failure::OverBudget { time, .. }
            | Failure::Discontinuous { time, .. }
            | Failure::NotAssemblable { time, .. }
            | Failure::Singular { time, .. }
            | Failure::WrongBranch { time, .. }
            | Failure::BeyondLimit { time, .. }
            | Failure::TooFar { time, .. }
            | Failure::InvalidStep { time, .. }
            | Failure::Unbounded { time, .. }
            | Failure::EnergyGain { time, .. }
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
            | Failure::Ambiguous { time, .. }
            | Failure::SharedNormalForce { time, .. }
            | Failure::Unbalanced { time, .. } => *time,
            Failure::NonFinite { .. }
            | Failure::Negative { .. }
            | Failure::Unsuitable { .. }
            | Failure::NotSmooth { .. }
            | Failure::Foreign { .. } => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_failure_of_a_lane_stays() {
        let (converged, first) = (Outcome::Converged, Outcome::NotConverged { row: 1 });
        let second = Outcome::NonFinite { row: 2 };
        type Three = crate::Lanes<f64, 3>;
        let outcomes = first_failure::<Three>([converged, first, converged], [converged, second, second]);
        assert_eq!(outcomes, [converged, first, second]);
    }
}

//! Failures as values that name the row or the coordinate and its line in the text.

pub(crate) mod checks;
pub(crate) mod conflicting_rows;
pub(crate) mod message;

use crate::failure::conflicting_rows::ConflictingRows;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::MissingSlope;
use crate::scalar::number::Real;
use crate::tolerances::is_single;

/// Position, or one of its time derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DerivativeOrder {
    /// The rows themselves.
    Position,
    /// Their first time derivatives.
    Velocity,
    /// Their second time derivatives.
    Acceleration,
}

/// Failure of an assembly, a step or a solution. The caller's state is as it was before the call.
///
/// ```
/// use mbs_runtime::{Mechanism, Stepper, mechanism};
///
/// # mechanism! {
/// #     /// A crank and a rod that slides along x.
/// #     pub mechanism Crank;
/// #     param r: m = 50mm;
/// #     coord theta: rad = 0;
/// #     coord phi: rad = 0;
/// #     coord x: m = 0.23;
/// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
/// #     drive motor: theta == 30 [rad/s]*t;
/// #     branch ahead: cos(phi) > 0;
/// # }
///
/// let long: Crank = Crank { r: 0.2, ..Crank::default() }; // longer than the rod of 180 mm
/// let guess = long.guess(&long.parameters());
/// let mut motion = Stepper::assemble(long, guess, 0.0)?;
/// let failure = motion.advance(0.05).expect_err("0.2 m sin(1.5) is longer than the rod");
/// assert!(failure.to_string().contains("`closure.")); // the row, its line, the residual, the cure
/// assert_eq!(motion.t(), 0.0); // the state is what it was
/// motion.advance(0.01)?;
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// The reason, with the row or coordinate that shows it.
    pub kind: FailureKind,
    /// Time (s) at which it arose, or at which a position was sought; `None` where the time has no part in it.
    pub time: Option<f64>,
}

/// The reason of a [`Failure`]. Further reasons may be added: a `match` needs an arm for them. [`source`](Self::source) says which part
/// of the computation produces it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FailureKind {
    /// A value that came in, or a row evaluated from finite values, is NaN or infinite.
    NonFinite {
        /// The coordinate, parameter, input, time, row, limit or event function.
        name: &'static str,
        /// Its line in the text; 0 for the time.
        line: u32,
    },
    /// A mass, moment of inertia or stiffness, or the width of a redundant row, is negative with the parameters as they are.
    Negative {
        /// Body or force, and field; or the row.
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
        coordinate: &'static Entry,
        /// Its value, in its unit.
        value: f64,
    },
    /// Newton's method did not reach the tolerance from the previous position.
    NotConverged {
        /// The row with the largest residual, in the reference metric.
        row: &'static Entry,
        /// Its residual, in the unit of the row.
        residual: f64,
        /// The tolerance that it missed, in the unit of the row.
        required: f64,
        /// Evaluations of the constraints spent.
        iterations: u32,
    },
    /// No path from the last position to the one that is sought leaves the assembly beyond doubt.
    NotFollowed {
        /// Part of the path (0 to 1) that was followed.
        part: f64,
        /// Margin to singularity there.
        margin: f64,
        /// Numbers of single precision: those of double precision decide nearer to singular positions.
        single: bool,
    },
    /// The budget of a step ended on the path to the position that is sought. The next step goes on from there, unless the
    /// budget leaves fewer evaluations than any part of a path takes.
    OverBudget {
        /// Part of the path (0 to 1) that was followed, from where this step began.
        part: f64,
        /// Evaluations of the constraints that the budget left for the path.
        evaluations: u32,
        /// The fewest that a part of a path takes.
        required: u32,
    },
    /// A row jumps between the last position and the one that is sought: a function of the time or of an input is not continuous.
    Discontinuous {
        /// The row that changes most.
        row: &'static Entry,
        /// Part of the path (0 to 1) at which it jumps.
        part: f64,
    },
    /// No start led to a position: the mechanism cannot be assembled as it is dimensioned, or not from there.
    NotAssemblable {
        /// The row with the largest part of the least residual found, in the reference metric.
        row: &'static Entry,
        /// That part, in the unit of the row.
        residual: f64,
        /// All rows that hold it: they contradict each other there, and nothing can close one of them without opening
        /// another farther.
        rows: ConflictingRows,
    },
    /// The Jacobian is singular, a dead centre or a bifurcation: rates are not determined.
    Singular {
        /// A row of the singular block.
        row: &'static Entry,
        /// A coordinate that the block does not determine.
        coordinate: &'static Entry,
        /// Margin to singularity: 0 where singular, at most 1, independent of units.
        margin: f64,
        /// The margin below which rates are refused.
        required: f64,
        /// Entry that sets the reference length, in parts of which the margin counts lengths. Where it is far longer than the
        /// links, every position looks singular.
        reference: Option<&'static Entry>,
    },
    /// The position solves the constraints in another assembly than the text's `branch` declares.
    WrongBranch {
        /// The branch condition.
        branch: &'static Entry,
        /// Its value, which should be positive.
        value: f64,
    },
    /// A quantity leaves the working range that a `limit` of the text allows it.
    BeyondLimit {
        /// The limit.
        limit: &'static Entry,
        /// The quantity, in the limit's unit.
        value: f64,
        /// The bound that it passes.
        bound: f64,
    },
    /// The position nearest to a saved state is not next to it.
    TooFar {
        /// The coordinate that is farthest off.
        coordinate: &'static Entry,
        /// Its distance, in the reference metric (rad, or reference lengths).
        distance: f64,
        /// The distance that is allowed.
        allowed: f64,
    },
    /// A number that sets a method, or its tolerance, is outside its range.
    InvalidMethodParameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The largest that is allowed; the least is 0.
        most: f64,
    },
    /// No multipliers balance the forces that depend on them: friction jams the mechanism.
    FrictionLocked {
        /// The row whose multiplier friction changes most.
        row: &'static Entry,
    },
    /// More than one set of multipliers balances the forces that depend on them: friction leaves the motion undetermined.
    Ambiguous {
        /// The row whose multiplier friction changes most.
        row: &'static Entry,
        /// Number of sets of multipliers found.
        solutions: u32,
        /// `true` if these are all; else there are at least so many, and uniqueness is not proved.
        all: bool,
    },
    /// Friction depends on a multiplier that is not unique. Rows that follow from each other share a force in any ratio, and each
    /// ratio gives another motion.
    SharedNormalForce {
        /// A row that shares the force.
        row: &'static Entry,
    },
    /// A friction that sticks or a rigid contact between two modes, where small motions have no linear equation: at its limit, without a force.
    SetValuedEdge {
        /// The friction or contact.
        row: &'static Entry,
    },
    /// Friction with stiction or a rigid contact, of which the method or analysis does not know the force or the slope.
    SetValuedForce {
        /// The friction or contact.
        row: &'static Entry,
    },
    /// Values that an event sets belong to a motion that the method or analysis does not follow, or change from rest to rest.
    EventOfMotion {
        /// The first event of the text.
        event: &'static Entry,
    },
    /// No way of sticking and sliding is consistent with the forces at this time, or frictions along lengths that follow from each other
    /// share a force in a ratio that is not known.
    StickingUndecided {
        /// A friction that may stick or slide, or a contact that may open.
        row: &'static Entry,
    },
    /// No force of a contact with friction is consistent with the motion, or several are (Painlevé's paradox): friction presses the contact
    /// deeper than its force lifts it.
    ContactUndecided {
        /// The contact.
        contact: &'static Entry,
        /// Number of modes found, open, sticking or sliding, that are consistent with different accelerations.
        modes: u32,
    },
    /// The gap of a contact is below zero, where it is open, at a start or after a change; or a motion has missed its touch.
    Penetration {
        /// The contact.
        contact: &'static Entry,
        /// Its gap (m).
        gap: f64,
    },
    /// No impulses of the contacts that touch fulfil their laws of impact at this time: gaps follow from each other, and their coefficients
    /// of restitution contradict. Or friction on them allows impulses with several outcomes.
    ImpactUndecided {
        /// A contact that closes.
        contact: &'static Entry,
    },
    /// Frictions stick and slide, contacts close and open, or events begin and end, more often within one step than a step is divided, or
    /// without end at one instant.
    Chatter {
        /// The first friction with stiction, rigid contact or event.
        entry: &'static Entry,
        /// Parts that the step was divided into, or changes next to each other.
        parts: u32,
    },
    /// A step that is 0, negative, no number, or too small to change the time.
    InvalidStep {
        /// The step (s).
        step: f64,
    },
    /// An end that is to be reached in 0 steps of equal size.
    NoSteps {
        /// The end (s).
        until: f64,
    },
    /// A step takes a coordinate farther than a mechanism moves: the integration has lost the motion.
    Unbounded {
        /// The coordinate that it takes farthest, in the reference metric.
        coordinate: &'static Entry,
        /// Its value there.
        value: f64,
    },
    /// A step of fixed size whose energy grows by more than the power supplied can explain: it is too long to follow the motion.
    EnergyGain {
        /// Kinetic energy (J) at its end.
        kinetic: f64,
        /// Kinetic energy (J) at its start, with the potential energy released and the work of the power supplied on the way.
        available: f64,
    },
    /// The end of an adaptive run takes more steps than one call may, as far as its first thousand tell.
    OutOfReach {
        /// The end (s).
        until: f64,
        /// The step (s) that the tolerance allows.
        step: f64,
    },
    /// The tolerance of adaptive steps, or of positions, is finer than the number type resolves.
    UnresolvedTolerance {
        /// Relative and absolute tolerance together, or that of positions.
        tolerance: f64,
        /// The smallest that is possible.
        least: f64,
    },
    /// The error that is asked for at the end of a run cannot be reached: rounding, or a motion that forgets its start, is larger.
    Unreachable {
        /// Error asked for, in the reference metric.
        accuracy: f64,
        /// The least one that was estimated.
        best: f64,
    },
    /// Next to a singular position no step is accurate enough: rounding decides where the motion goes.
    Undecided {
        /// Margin of Φ_q to a loss of rank.
        margin: f64,
        /// Numbers of single precision: those of double precision decide nearer to the position.
        single: bool,
    },
    /// No step that still changes the time is accurate enough.
    StepTooSmall {
        /// The last step (s) tried.
        step: f64,
    },
    /// The step of an implicit method is so short that rounding of positions, over its square, hides multipliers which the forces use.
    StepTooShort {
        /// The step (s).
        step: f64,
        /// A step (s) that resolves them.
        least: f64,
    },
    /// The step is too long for the method to be stable.
    StepTooLong {
        /// Step times frequency.
        product: f64,
        /// The largest that is allowed.
        allowed: f64,
    },
    /// A part of a step of fixed size and its thirds lead to velocities that differ by too much: the step is too long to follow the forces.
    StepUnresolved {
        /// The part (s).
        step: f64,
        /// Correction by the thirds, over the largest velocity in the reference metric.
        part: f64,
        /// The largest that is allowed.
        allowed: f64,
    },
    /// Rows of which some should follow from others contradict each other: nothing satisfies all of them.
    Inconsistent {
        /// The rows that stay open, those farthest off first.
        rows: ConflictingRows,
        /// Order of the derivative in which they contradict each other.
        level: DerivativeOrder,
        /// Residual of the worst row where all together are smallest, in its unit (per s, per s²).
        residual: f64,
        /// Allowed residual.
        required: f64,
    },
    /// The start, or a state to be put back onto the constraints, violates a row.
    OffConstraints {
        /// The row that is violated most, in the reference metric.
        row: &'static Entry,
        /// `true` if its rate is violated, and not the row itself.
        rate: bool,
        /// Residual, in the unit of the row (per second).
        residual: f64,
        /// Allowed residual.
        allowed: f64,
    },
    /// A motion that the rows leave free moves no mass, so that its acceleration is not determined.
    SingularMass {
        /// The coordinate that moves most in it.
        coordinate: &'static Entry,
    },
    /// No coordinate changes a row, which then holds nothing: the length between two points is 0, or bars at rest are
    /// in line.
    VanishingGradient {
        /// The row.
        row: &'static Entry,
    },
    /// Forces and inertia were not balanced within the iterations of an implicit method or of the search for equilibrium; or the
    /// integrands of states did not reach 0.
    EquilibriumNotConverged {
        /// The coordinate that is farthest from balance.
        coordinate: &'static Entry,
        /// Iterations spent.
        iterations: u32,
    },
    /// There is no equilibrium near: where the forces come nearest to balance, they still push.
    NoEquilibrium {
        /// A coordinate that moves as they push.
        coordinate: &'static Entry,
        /// Work (J) that they would do along a unit of it, the others following.
        force: f64,
    },
    /// A first-order state has no equilibrium value. At the end of the search its rate is not 0 and neither it nor a free
    /// motion changes that; or its rate is held at 0, and it has no force of its own.
    NoStateEquilibrium {
        /// The state.
        state: &'static Entry,
    },
    /// The text has first-order states, and the requested analysis depends on their values at that time.
    StatesUnknown {
        /// The first of them.
        state: &'static Entry,
    },
    /// The requested analysis needs a derivative of the forces that a declared function is not smooth enough for.
    NotSmooth {
        /// The derivative, the function, and the continuity that it would need.
        missing: &'static MissingSlope,
    },
    /// The saved state is that of a mechanism with another name or other coordinates.
    MechanismMismatch {
        /// Name of the mechanism that it was to be the state of.
        mechanism: &'static str,
    },
}

/// The part of a computation that a failure comes from. Each [`FailureKind`] belongs to one; a control loop can match all five.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureSource {
    /// A value, parameter, tolerance, step size or saved state of the caller: the call has to change.
    Input,
    /// Constraint equations: a position, its assembly, or its velocities and accelerations.
    Constraints,
    /// Masses and forces: accelerations or multipliers at one instant.
    Forces,
    /// Step size and step control of a motion.
    Integration,
    /// The search for an equilibrium, or for that of forces and inertia in an implicit step.
    Equilibrium,
}

impl FailureKind {
    /// The part of the computation that produces this kind.
    pub const fn source(&self) -> FailureSource {
        match self {
            FailureKind::NonFinite { .. }
            | FailureKind::Negative { .. }
            | FailureKind::Unresolved { .. }
            | FailureKind::InvalidMethodParameter { .. }
            | FailureKind::InvalidStep { .. }
            | FailureKind::NoSteps { .. }
            | FailureKind::UnresolvedTolerance { .. }
            | FailureKind::Unreachable { .. }
            | FailureKind::StatesUnknown { .. }
            | FailureKind::NotSmooth { .. }
            | FailureKind::SetValuedForce { .. }
            | FailureKind::SetValuedEdge { .. }
            | FailureKind::EventOfMotion { .. }
            | FailureKind::Penetration { .. }
            | FailureKind::MechanismMismatch { .. } => FailureSource::Input,
            FailureKind::NotConverged { .. }
            | FailureKind::NotFollowed { .. }
            | FailureKind::OverBudget { .. }
            | FailureKind::Discontinuous { .. }
            | FailureKind::NotAssemblable { .. }
            | FailureKind::Singular { .. }
            | FailureKind::WrongBranch { .. }
            | FailureKind::BeyondLimit { .. }
            | FailureKind::TooFar { .. }
            | FailureKind::Inconsistent { .. }
            | FailureKind::OffConstraints { .. }
            | FailureKind::VanishingGradient { .. } => FailureSource::Constraints,
            FailureKind::FrictionLocked { .. }
            | FailureKind::Ambiguous { .. }
            | FailureKind::SharedNormalForce { .. }
            | FailureKind::StickingUndecided { .. }
            | FailureKind::ContactUndecided { .. }
            | FailureKind::ImpactUndecided { .. }
            | FailureKind::SingularMass { .. } => FailureSource::Forces,
            FailureKind::Unbounded { .. }
            | FailureKind::Chatter { .. }
            | FailureKind::EnergyGain { .. }
            | FailureKind::OutOfReach { .. }
            | FailureKind::Undecided { .. }
            | FailureKind::StepTooSmall { .. }
            | FailureKind::StepTooShort { .. }
            | FailureKind::StepTooLong { .. }
            | FailureKind::StepUnresolved { .. } => FailureSource::Integration,
            FailureKind::NoEquilibrium { .. }
            | FailureKind::NoStateEquilibrium { .. }
            | FailureKind::EquilibriumNotConverged { .. } => FailureSource::Equilibrium,
        }
    }

    /// [`NotFollowed`](FailureKind::NotFollowed) beyond a `part` of the way, at a `margin`.
    pub(crate) fn not_followed<R: Real>(part: f64, margin: R) -> Self {
        FailureKind::NotFollowed { part, margin: margin.to_f64(), single: is_single::<R>() }
    }

    /// [`Undecided`](FailureKind::Undecided) at a `margin`.
    pub(crate) fn undecided<R: Real>(margin: R) -> Self {
        FailureKind::Undecided { margin: margin.to_f64(), single: is_single::<R>() }
    }

    /// The failure of this kind at `time` (s).
    #[inline]
    pub const fn at(self, time: f64) -> Failure {
        Failure { kind: self, time: Some(time) }
    }

    /// The failure of this kind in which the time has no part.
    #[inline]
    pub const fn without_time(self) -> Failure {
        Failure { kind: self, time: None }
    }
}

impl Failure {
    /// The same at `now` (s), unless the time has no part in it.
    pub(crate) fn at(self, now: f64) -> Self {
        Failure { time: self.time.and(Some(now)), ..self }
    }
}

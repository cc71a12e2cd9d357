//! Contract with emitted code: a mechanism as functions of its coordinates.

pub(crate) mod block;
pub(crate) mod dynamic;
pub(crate) mod enclosure;
pub(crate) mod event;
pub(crate) mod function;
pub(crate) mod limit;
pub(crate) mod margin;
pub(crate) mod normal_forces;
pub(crate) mod operations;
pub(crate) mod outcome;
pub(crate) mod phase;
pub(crate) mod reveal;
pub(crate) mod roots;
pub(crate) mod saved_variables;
pub(crate) mod set_valued;
pub(crate) mod transformed;

use crate::mechanism::block::BlockSolver;
use crate::mechanism::function::FunctionEntry;
use crate::mechanism::limit::Limit;
use crate::mechanism::margin::Margin;
use crate::mechanism::outcome::Outcome;
use crate::mechanism::phase::Phase;
use crate::mechanism::saved_variables::Kept;
use crate::scalar::number::{Real, Scalar};

/// The scene of a text with all its effects, which every mechanism is in unless a type says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AllEffects;

/// A name of the text with its unit and its line in the source file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// As the text spells it; components of vectors are counted from 0: `closure.1`.
    pub name: &'static str,
    /// Coherent SI unit as the text spells it.
    pub unit: &'static str,
    /// Line in the source file.
    pub line: u32,
}

impl Entry {
    /// `true` if the unit is that of an angle.
    pub fn is_angle(&self) -> bool {
        self.unit == "rad"
    }
}

/// Lengths whose largest is the reference length, the unit of length of the reference metric. They are those of rows and of places
/// of bodies and forces; where these have none, those of guesses and laws of forces. If all are 0 it is the largest guess, or 1 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The largest length (m) among constants and numbers; guesses are some where rows have lengths of another origin.
    pub longest: Option<(&'static Entry, f64)>,
    /// Indices of parameters that are lengths.
    pub parameters: &'static [u16],
}

impl Reference {
    /// That of a text in which nothing is measured by a length.
    pub const NONE: Self = Reference { longest: None, parameters: &[] };
}

/// A measured or commanded quantity with its time derivatives: an `input … , rates`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signal<T> {
    /// Value, in the declared unit.
    pub value: T,
    /// First time derivative, in the declared unit per second.
    pub rate: T,
    /// Second time derivative, in the declared unit per second squared.
    pub acceleration: T,
}

impl<T: Scalar> Signal<T> {
    /// A quantity with its first and second time derivatives, in the declared unit, per s and per s².
    #[inline]
    pub const fn new(value: T, rate: T, acceleration: T) -> Self {
        Signal { value, rate, acceleration }
    }

    /// A quantity that does not move, in the declared unit.
    #[inline]
    pub fn at_rest(value: T) -> Self {
        Signal::new(value, T::constant(0.0), T::constant(0.0))
    }

    /// The signal `h` (s) later, at constant acceleration.
    #[inline]
    pub fn moved(self, h: T) -> Self {
        let Signal { value, rate, acceleration } = self;
        let value = value + h * (rate + T::constant(0.5) * h * acceleration);
        Signal { value, rate: rate + h * acceleration, acceleration }
    }
}

/// A named output with as many exact time derivatives as its definition leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputValue<T> {
    /// Value, in the declared unit.
    pub value: T,
    /// First time derivative; `None` where the definition uses `der2`.
    pub rate: Option<T>,
    /// Second time derivative; `None` where the definition uses `der` or `der2`.
    pub acceleration: Option<T>,
}

/// Φ, Φ_q, Φ_t and γ of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation<T, E, const M: usize> {
    /// Constraint residuals Φ(q, t): M.
    pub phi: [T; M],
    /// Entries of Φ_q at the places of [`Mechanism::SPARSITY`].
    pub phi_q_entries: E,
    /// Partial time derivative ∂Φ/∂t: M.
    pub phi_t: [T; M],
    /// γ = −(Φ_q q̇)_q q̇ − 2 Φ_qt q̇ − Φ_tt: M.
    pub gamma: [T; M],
}

/// A mechanism of `N` coordinates and `M` constraint rows, as emitted by [`mechanism!`](crate::mechanism!).
///
/// Evaluation is staged: [`parameters`](Self::parameters) once a design, [`position`](Self::position) once a
/// `(q, t)`, everything else from those two.
pub trait Mechanism<T: Scalar, const N: usize, const M: usize>: Clone {
    /// Values of the parameters alone.
    type Parameters: Copy;
    /// Values of `(q, t)` that more than one function shares.
    type Position: Copy;
    /// One value an entry of Φ_q that is not zero by structure.
    type Entries: AsRef<[T]> + Copy;
    /// One value a `branch` of the text.
    type Branches: AsRef<[T]> + Copy;
    /// One range a `limit` of the text.
    type Limits: AsRef<[Limit<T>]> + Copy;
    /// The phase of each drive that prescribes a rate.
    type Phases: Copy + AsRef<[Phase<T>]> + AsMut<[Phase<T>]>;
    /// One value a variable.
    type Values: Copy + AsRef<[T]> + AsMut<[T]>;
    /// As many numbers, for a [`Saved`](crate::Saved) state.
    type Kept: Kept;
    /// One value a component of an `out` of the text.
    type Outputs: AsRef<[OutputValue<T>]> + Copy;
    /// The same design in one lane, for fallbacks and diagnosis.
    type Lane: Mechanism<T::Real, N, M>;

    /// Name of the mechanism.
    const NAME: &'static str;
    /// Name of the scene; `AllEffects` for all effects at once, and where the text declares no scene.
    const SCENE: &'static str = "AllEffects";
    /// The text between the braces of the macro; not linked where unused.
    const SOURCE: &'static str;
    /// Coordinates in the order of `q`: N.
    const COORDINATES: &'static [Entry];
    /// Constraint rows in the order of Φ: M.
    const ROWS: &'static [Entry];
    /// `true` for each row that may follow from others: a constraint marked `redundant`. Empty where none may.
    const REDUNDANT: &'static [bool] = &[];
    /// Row and column of each entry of Φ_q that is not zero by structure, row by row, columns ascending.
    const SPARSITY: &'static [(u16, u16)];
    /// Parameters and inputs, the public fields, component by component, as far as the scene's own statements declare
    /// them: [`variable`](Self::variable) finds the index
    /// that [`get`](Self::get) and [`set`](Self::set) take.
    const VARIABLES: &'static [Entry];
    /// Indices of parameters and inputs that are angles, without their rates: an angle that comes round again may have moved far.
    const ANGLES: &'static [u16] = &[];
    /// Indices of inputs that the text declares as `turn`, without their rates. Nothing changes with a whole turn of theirs, and
    /// they change the short way round.
    const TURNING_INPUTS: &'static [u16] = &[];
    /// Indices of parameters and inputs on whose way rows may come back to where they were, as those of a stroke r cos θ do: a position
    /// next to the last one is then no sign of a short way.
    const FOLDING: &'static [u16] = &[];
    /// Lengths that determine the reference length; see [`reference`](Self::reference).
    const REFERENCE: Reference = Reference::NONE;
    /// Branch conditions.
    const BRANCHES: &'static [Entry];
    /// `true` for each branch that picks the assembly alone and may change its sign afterwards.
    const BRANCHES_AT_START: &'static [bool] = &[];
    /// Working ranges.
    const LIMITS: &'static [Entry] = &[];
    /// Drives that prescribe a rate, in the unit of the driven coordinate; their phases are among the variables.
    const PHASES: &'static [Entry] = &[];
    /// Indices of coordinates that the text declares as `turn`. No row changes with a whole turn of theirs, except by the phase
    /// with which a drive holds them.
    const TURNS: &'static [u16] = &[];
    /// Outputs, component by component.
    const OUTPUTS: &'static [Entry];
    /// Functions that the caller supplies, each the public field of its name.
    const FUNCTIONS: &'static [FunctionEntry] = &[];

    /// Value of the parameter or input at `index` of [`VARIABLES`](Self::VARIABLES).
    fn get(&self, index: usize) -> Option<T>;
    /// Sets the parameter or input at `index` of [`VARIABLES`](Self::VARIABLES); false where there is none.
    fn set(&mut self, index: usize, value: T) -> bool;
    /// The design in lane `lane`.
    fn lane(&self, lane: usize) -> Self::Lane;

    /// Shows `see` the value at `x` of the function at `index` of [`FUNCTIONS`](Self::FUNCTIONS), and its derivatives up to the order
    /// there, all in SI units: one number more than the order. Without such a function it shows nothing.
    #[inline]
    fn jets(&self, _index: usize, _x: T, _see: impl FnOnce(&[T])) {}

    /// The parameters and inputs of [`VARIABLES`](Self::VARIABLES), in their order.
    fn values(&self) -> Self::Values;
    /// Restores the parameters and inputs.
    #[inline]
    fn set_values(&mut self, values: Self::Values) {
        for (index, value) in values.as_ref().iter().enumerate() {
            self.set(index, *value);
        }
    }

    /// `true` if a text with masses has inputs with rates.
    const HAS_SIGNALS: bool = false;

    /// Advances inputs with rates: each becomes that of `start` after `h` (s) at constant acceleration.
    #[inline]
    fn carry_signals(&mut self, _start: &Self, _h: T) {}

    /// The phases of drives that prescribe a rate, in the order of [`PHASES`](Self::PHASES).
    fn phases(&self) -> Self::Phases;
    /// Restores the phases.
    fn set_phases(&mut self, phases: Self::Phases);
    /// Starts the phases of drives that prescribe a rate such that their rows hold at `q` (N) and `t` (s).
    #[inline]
    fn start_phases(&mut self, _q: &[T; N], _t: T) {}
    /// Moves these phases on from time `from` to time `to` (s).
    ///
    /// The increment is the integral of the prescribed rate. Parameters and inputs without rates count as held since
    /// `from`, inputs with rates as moving to their present value with their present acceleration. A rate that
    /// varies within the step is averaged with [`means`](crate::mechanism::phase::means).
    #[inline]
    fn advance_phases(&mut self, _from: T, _to: T) {}
    /// Time derivatives of the phases at time `t` (s). Each value is the prescribed rate at the present parameters and inputs,
    /// and its rate the derivative of that.
    #[inline]
    fn phase_rates(&self, _t: T) -> Self::Phases {
        self.phases()
    }

    /// Takes `turns` whole turns of a coordinate of [`TURNS`](Self::TURNS) off the phases that hold it.
    #[inline]
    fn turn_back(&mut self, _coordinate: u16, _turns: i64) {}

    /// Stage 0: values that depend on parameters alone.
    fn parameters(&self) -> Self::Parameters;
    /// The text's guess of the coordinates: N.
    fn guess(&self, parameters: &Self::Parameters) -> [T; N];
    /// Reference metric, coordinates: 1 for angles and pure numbers, the reference length for lengths: N.
    fn coordinate_scales(&self, parameters: &Self::Parameters) -> [T; N];
    /// Reference metric, rows: the reference length to the power that the row's unit has of metres: M.
    fn row_scales(&self, parameters: &Self::Parameters) -> [T; M];
    /// Contradiction that rows of constraints marked `redundant within …` may keep, in the unit of the row; 0 for all
    /// others: M.
    #[inline]
    fn widths(&self, _parameters: &Self::Parameters) -> [T; M] {
        [T::constant(0.0); M]
    }

    /// Stage 1: values that depend on `q` (N) and `t` (s).
    fn position(&self, parameters: &Self::Parameters, q: &[T; N], t: T) -> Self::Position;
    /// Constraint residuals Φ(q, t): M, in the unit of the row.
    fn phi(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M];
    /// Jacobian ∂Φ/∂q: M rows of N.
    fn phi_q(&self, parameters: &Self::Parameters, position: &Self::Position) -> [[T; N]; M];
    /// The entries of Φ_q at the places of [`SPARSITY`](Self::SPARSITY).
    fn phi_q_entries(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Entries;
    /// Partial time derivative ∂Φ/∂t, rates of inputs included: M.
    fn phi_t(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M];
    /// Second partial time derivative ∂²Φ/∂t², rates of inputs included: M.
    fn phi_tt(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M];
    /// Mixed derivative Φ_qt q̇: M.
    fn phi_qt_qd(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> [T; M];
    /// γ = −(Φ_q q̇)_q q̇ − 2 Φ_qt q̇ − Φ_tt, the right-hand side of Φ_q q̈ = γ: M.
    fn gamma(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> [T; M];
    /// Branch conditions, each positive where it holds.
    fn branches(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Branches;
    /// Working ranges, each with its quantity at `position`.
    fn limits(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Limits;
    /// Outputs with their time derivatives.
    fn outputs(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        qdd: &[T; N],
    ) -> Self::Outputs;

    /// Φ, the entries of Φ_q, Φ_t and γ in one call, nothing kept in between.
    #[inline]
    fn evaluate(
        &self,
        parameters: &Self::Parameters,
        q: &[T; N],
        t: T,
        qd: &[T; N],
    ) -> Evaluation<T, Self::Entries, M> {
        let position = self.position(parameters, q, t);
        Evaluation {
            phi: self.phi(parameters, &position),
            phi_q_entries: self.phi_q_entries(parameters, &position),
            phi_t: self.phi_t(parameters, &position),
            gamma: self.gamma(parameters, &position, qd),
        }
    }

    /// The constant, number, guess or parameter that sets the reference length at present, in the first lane.
    fn reference(&self) -> Option<&'static Entry> {
        let Reference { longest, parameters } = Self::REFERENCE;
        let mut set = longest;
        for index in parameters.iter().map(|index| usize::from(*index)) {
            let Some((entry, value)) = Self::VARIABLES.get(index).zip(self.get(index)) else { continue };
            let length = value.lane(0).to_f64().abs();
            if set.is_none_or(|(_, longest)| longest < length) && length > 0.0 {
                set = Some((entry, length));
            }
        }
        set.map(|(entry, _)| entry)
    }

    /// Index of a parameter or input in [`VARIABLES`](Self::VARIABLES).
    fn variable(name: &str) -> Option<usize> {
        Self::VARIABLES.iter().position(|entry| entry.name == name)
    }
}

/// A mechanism whose rows fix every coordinate: as many rows as coordinates, or more where constraints are marked
/// `redundant`. Emitted only where the structure says so.
pub trait Kinematic<T: Scalar, const N: usize, const M: usize = N>: Mechanism<T, N, M> {
    /// Factorised diagonal blocks and the entries of Φ_q off them.
    type Factors: Copy;
    /// Numbers of the lanes that a [`Batch`](crate::Batch) computes together where it has more: a register's worth. Single ones
    /// where functions of the caller may take no others; then all lanes are computed together.
    type GroupNumber: Scalar<Real = T::Real>;
    /// The same designs in as many lanes.
    type Group: Kinematic<Self::GroupNumber, N, M>;
    /// `true` if [`solve_motion`](Self::solve_motion) goes block by block, so that steps gain from it.
    const BLOCK_BY_BLOCK: bool = false;
    /// `true` if dyads are circles and lines, whose second derivatives a step takes: [`BlockSolver::solve_round`].
    const HAS_CIRCLES: bool = false;
    /// `true` if [`solve_motion`](Self::solve_motion) eliminates a block in an order of its own, which may ask for pivoting instead.
    const HAS_ORDERS: bool = false;

    /// The designs in the lanes from `first` on.
    fn group(&self, first: usize) -> Self::Group;

    /// Solves Φ(q, t) = 0 block after block in the compile-time order, each to convergence before the next
    /// begins; coordinates that a row gives explicitly are assigned.
    ///
    /// `q`: start values in, solution out; meaningful only in lanes that converged.
    fn solve_blocks<S: BlockSolver<T>>(
        &self,
        parameters: &Self::Parameters,
        q: &mut [T; N],
        t: T,
        solver: &mut S,
    ) -> T::Lanes<Outcome>;

    /// As [`solve_blocks`](Self::solve_blocks), with the stage-1 values of the solution: emitted code keeps them as it
    /// solves, so that no sine is computed again.
    #[inline(always)]
    fn solve_with_position<S: BlockSolver<T>>(
        &self,
        parameters: &Self::Parameters,
        q: &mut [T; N],
        t: T,
        solver: &mut S,
    ) -> (T::Lanes<Outcome>, Self::Position) {
        let outcome = self.solve_blocks(parameters, q, t, solver);
        (outcome, self.position(parameters, q, t))
    }

    /// Position, velocity and acceleration in one go: [`solve_with_position`](Self::solve_with_position), then
    /// [`factorize`](Self::factorize), then [`solve_linear`](Self::solve_linear) twice.
    ///
    /// Emitted code does the same operations block after block. The next block waits for a position alone, and meanwhile the
    /// processor computes the rates of this one. `motion`: q with its start values, and two more rows of N numbers, in; q, q̇, q̈
    /// out, meaningful only in lanes that converged.
    #[inline(always)]
    fn solve_motion<S: BlockSolver<T>>(
        &self,
        parameters: &Self::Parameters,
        motion: &mut [[T; N]; 3],
        t: T,
        solver: &mut S,
    ) -> Solved<Self::Position, T> {
        let [q, qd, qdd] = motion;
        let (_, position) = self.solve_with_position(parameters, q, t, solver);
        let (factors, margin) = self.factorize(parameters, &position);
        *qd = self.solve_linear(&factors, &negated(self.phi_t(parameters, &position)));
        *qdd = self.solve_linear(&factors, &self.gamma(parameters, &position, qd));
        Solved { position, margin, sum: margin.value, ordered: T::mask(true) }
    }

    /// Factorises Φ_q block by block, once for velocity and acceleration.
    ///
    /// Returns the factors and the smallest margin of any block (see [`Factorization::factorize`](crate::Factorization::factorize)).
    fn factorize(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
    ) -> (Self::Factors, Margin<T>);

    /// Solves Φ_q x = b (M) with factors from [`factorize`](Self::factorize): `−Φ_t` gives q̇, `γ` gives q̈; by least
    /// squares in the reference metric where a block has more rows than coordinates.
    fn solve_linear(&self, factors: &Self::Factors, b: &[T; M]) -> [T; N];
}

/// Stage-1 values and margin to singularity of a solved position.
#[derive(Clone, Copy)]
pub struct Solved<P, T: Scalar> {
    /// Its stage-1 values.
    pub position: P,
    /// The smallest margin of any block.
    pub margin: Margin<T>,
    /// Finite where no block is singular, and where none is too large or too small for the number type. Elsewhere factors and
    /// rates are of no use.
    pub sum: T,
    /// Lanes in which blocks with an elimination order of their own kept their multipliers small. Elsewhere rates and margin are
    /// of no use: these blocks need pivoting.
    pub ordered: T::Mask,
}

/// The numbers with the other sign.
#[inline(always)]
pub(crate) fn negated<T: Scalar, const M: usize>(mut numbers: [T; M]) -> [T; M] {
    for number in &mut numbers {
        *number = -*number;
        T::side_by_side();
    }
    numbers
}

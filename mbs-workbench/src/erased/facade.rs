//! Object-safe traits for all mechanisms: the emitted types differ in their array lengths, these traits do not.

use core::fmt;
use core::hint::black_box;
use std::rc::Rc;
use std::time::{Duration, Instant};

use mbs_runtime::{
    Entry, Failure, Frame, FunctionEntry, Kinematic, Mechanism, OutputValue, ReachLimit, Scalar, Stepper,
};

use crate::erased::branching::Branching;
use crate::erased::dynamics::AnyDynamics;
use crate::erased::experiment::Experiment;
use crate::erased::feeds::Feeds;
use crate::erased::masses::{Loads, Masses, Tables};
use crate::motion;
use crate::motion::course::Course;
pub use crate::motion::{CoordinateCurve, Motion, OutputCurve, State, spread};

/// Value and derivatives of the function at an index of [`functions`](AnyEquations::functions), at an argument.
pub type Jets = Rc<dyn Fn(usize, f64) -> Vec<f64>>;

/// Names and functions of a mechanism of any size, with its parameters; it need not be square. Vectors are in the
/// order of the text.
pub trait AnyEquations {
    /// Names of the emitted type.
    fn description(&self) -> &'static Description;
    /// Value of a parameter or input, in the unit of the text.
    fn get(&self, index: usize) -> Option<f64>;
    /// Sets a parameter or input, in the unit of the text; false where there is none at `index`.
    fn set(&mut self, index: usize, value: f64) -> bool;
    /// Makes the input at `index` follow `course` in the unit of the text, with its rates where the text asks for them. Motions have it
    /// at every instant. `false` where it cannot be.
    fn feed(&mut self, _index: usize, _course: Course) -> bool {
        false
    }
    /// Value of a parameter or input at `t` (s), in the unit of the text.
    fn get_at(&self, index: usize, _t: f64) -> Option<f64> {
        self.get(index)
    }
    /// Reference metric of the coordinates: 1 for angles, the reference length for lengths: N.
    fn coordinate_scales(&self) -> Vec<f64>;
    /// Reference metric of the rows: the reference length to the power that the row has of metres: M.
    fn row_scales(&self) -> Vec<f64>;
    /// The functions that the caller supplies; nothing of those that are not there.
    fn jets(&self) -> Jets {
        Rc::new(|_, _| Vec::new())
    }
    /// All functions of one state, which need not satisfy the constraints.
    ///
    /// # Panics
    /// If the state's vectors do not have N components.
    fn evaluate(&self, state: &State) -> Functions;

    /// Name of the emitted type.
    fn type_name(&self) -> &'static str {
        self.description().type_name
    }
    /// Name of the scene; `AllEffects` where the text declares none.
    fn scene(&self) -> &'static str {
        self.description().scene
    }
    /// The text.
    fn source(&self) -> &'static str {
        self.description().source
    }
    /// Coordinates: N.
    fn coordinates(&self) -> &'static [Entry] {
        self.description().coordinates
    }
    /// Constraint rows: M.
    fn rows(&self) -> &'static [Entry] {
        self.description().rows
    }
    /// Parameters and inputs, component by component.
    fn variables(&self) -> &'static [Entry] {
        self.description().variables
    }
    /// Outputs, component by component.
    fn outputs(&self) -> &'static [Entry] {
        self.description().outputs
    }
    /// Functions that the text declares.
    fn functions(&self) -> &'static [FunctionEntry] {
        self.description().functions
    }
    /// Name of the type in its scene, as generated code and definitions for CasADi spell it.
    fn full_name(&self) -> String {
        let scene = if self.scene() == mbs_codegen::WHOLE { "" } else { self.scene() };
        format!("{}{scene}", self.type_name())
    }
    /// The same behind the module that has the text, `my_crate::wiper::Wiper`; without it where that is not told.
    fn path(&self) -> String {
        let name = self.type_name();
        path((self.description().told)(), name).unwrap_or_default() + &self.full_name()
    }
    /// Names of states, forces and loads; `None` if the text has no masses or forces.
    fn tables(&self) -> Option<Tables> {
        None
    }
    /// Functions of masses and forces at one state; `None` if there are none, or if a vector has a wrong length.
    fn masses(&self, _state: &State, _loads: &Loads) -> Option<Masses> {
        None
    }
    /// Direct and inverse dynamics; `None` if the text has no masses or forces.
    fn dynamics(&self) -> Option<&dyn AnyDynamics> {
        None
    }
}

/// The modules of the type `name` in a type as the compiler tells it, `a::Wrapped<b::c::Name<f64>>`: `b::c::`.
fn path(told: &str, name: &str) -> Option<String> {
    let is_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let of = |part: &str| part.strip_suffix(name).filter(|path| path.ends_with("::")).map(str::to_string);
    told.split(|c| !is_of_path(c)).find_map(of)
}

/// Names of an emitted type.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// Name of the type.
    pub type_name: &'static str,
    /// Its name with modules and arguments, as the compiler tells it.
    pub told: fn() -> &'static str,
    /// Name of the scene; `AllEffects` where the text declares none.
    pub scene: &'static str,
    /// The text.
    pub source: &'static str,
    /// Coordinates: N.
    pub coordinates: &'static [Entry],
    /// Constraint rows: M.
    pub rows: &'static [Entry],
    /// Parameters and inputs, component by component.
    pub variables: &'static [Entry],
    /// Outputs, component by component.
    pub outputs: &'static [Entry],
    /// Functions that the text declares.
    pub functions: &'static [FunctionEntry],
}

impl Description {
    /// That of `S`.
    pub const fn of<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize>() -> Self {
        Description {
            type_name: S::NAME,
            told: core::any::type_name::<S>,
            scene: S::SCENE,
            source: S::SOURCE,
            coordinates: S::COORDINATES,
            rows: S::ROWS,
            variables: S::VARIABLES,
            outputs: S::OUTPUTS,
            functions: S::FUNCTIONS,
        }
    }
}

/// A mechanism of any size that can be solved.
pub trait AnyMechanism: AnyEquations {
    /// Assembles the mechanism at the first instant (s) and follows it through the others.
    ///
    /// `progress` gets the number of instants done. An empty list gives an empty motion.
    ///
    /// # Errors
    /// The solver's [`Failure`] at the first instant that has no solution.
    fn follow(&self, times: &[f64], progress: &mut dyn FnMut(usize)) -> Result<Motion, Failure>;
    /// Time of one step (position, velocity, acceleration and outputs), the mean over `times` (s).
    ///
    /// # Errors
    /// The solver's [`Failure`].
    fn time_a_step(&self, times: &[f64]) -> Result<Duration, Failure>;
    /// Limit of a motion over `times` (s) that fails; `None` if it does not assemble or has no limit.
    fn stop(&self, times: &[f64]) -> Option<MotionStop>;
    /// Single steps of the solvers, for teaching.
    fn experiment(&self) -> &dyn Experiment;
}

impl fmt::Debug for dyn AnyMechanism + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyMechanism({})", self.type_name())
    }
}

/// Bracket in time of a motion's end; see [`mbs_runtime::ReachLimit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionStop {
    /// The last time (s) with a position.
    pub reachable: f64,
    /// The first time (s) that is refused.
    pub refused: f64,
    /// Failure at the end of the refused step.
    pub failure: Failure,
}

/// Every emitted function at one state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Functions {
    /// Φ: M.
    pub phi: Vec<f64>,
    /// Φ_q, row after row: M·N.
    pub phi_q: Vec<f64>,
    /// Φ_t: M.
    pub phi_t: Vec<f64>,
    /// Φ_tt: M.
    pub phi_tt: Vec<f64>,
    /// Φ_qt q̇: M.
    pub phi_qt_qd: Vec<f64>,
    /// γ: M.
    pub gamma: Vec<f64>,
    /// Outputs with their time derivatives.
    pub outputs: Vec<OutputValue<f64>>,
}

/// A mechanism of `N` coordinates and `M` rows behind the common face, with its masses and forces where `F` has them.
#[derive(Clone, Debug)]
pub struct Facade<S, const N: usize, const M: usize = N, F = ()>(pub S, pub(super) F, pub(super) Feeds);

/// Masses and forces of `S`, as a part of its [`Facade`]; `()` where it has none.
pub trait Forced<S, const N: usize, const M: usize>: Sized {
    /// Names beyond the kinematics.
    const TABLES: Option<Tables> = None;

    /// Functions of masses and forces of one state.
    fn masses(_mechanism: &S, _state: &State, _loads: &Loads) -> Option<Masses> {
        None
    }
    /// Motion from forces and forces from motion.
    fn dynamics(_facade: &Facade<S, N, M, Self>) -> Option<&dyn AnyDynamics> {
        None
    }
}

impl<S, const N: usize, const M: usize> Forced<S, N, M> for () {}

impl<S, const N: usize, const M: usize> Facade<S, N, M> {
    /// `mechanism` without its masses and forces.
    pub fn of(mechanism: S) -> Self {
        Facade(mechanism, (), Feeds::default())
    }
}

impl<S, F, const N: usize, const M: usize> AnyEquations for Facade<S, N, M, F>
where
    S: Mechanism<f64, N, M> + 'static,
    F: Forced<S, N, M>,
{
    fn description(&self) -> &'static Description {
        const { &Description::of::<S, f64, N, M>() }
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.0.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.0.set(index, value)
    }
    fn feed(&mut self, index: usize, course: Course) -> bool {
        self.2.feed(S::VARIABLES, index, course)
    }
    fn get_at(&self, index: usize, t: f64) -> Option<f64> {
        self.2.value(index, t).or_else(|| self.0.get(index))
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        self.0.coordinate_scales(&self.0.parameters()).to_vec()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.0.row_scales(&self.0.parameters()).to_vec()
    }
    fn jets(&self) -> Jets {
        let mechanism = self.0.clone();
        Rc::new(move |index, x| {
            let mut found = Vec::new();
            mechanism.jets(index, x, |jet| found.extend_from_slice(jet));
            found
        })
    }

    fn evaluate(&self, state: &State) -> Functions {
        let array = |values: &[f64]| <[f64; N]>::try_from(values).expect("a state has N components");
        let (q, qd, qdd) = (array(&state.q), array(&state.qd), array(&state.qdd));
        let parameters = self.0.parameters();
        let position = self.0.position(&parameters, &q, state.t);
        Functions {
            phi: self.0.phi(&parameters, &position).to_vec(),
            phi_q: self.0.phi_q(&parameters, &position).as_flattened().to_vec(),
            phi_t: self.0.phi_t(&parameters, &position).to_vec(),
            phi_tt: self.0.phi_tt(&parameters, &position).to_vec(),
            phi_qt_qd: self.0.phi_qt_qd(&parameters, &position, &qd).to_vec(),
            gamma: self.0.gamma(&parameters, &position, &qd).to_vec(),
            outputs: self.0.outputs(&parameters, &position, &qd, &qdd).as_ref().to_vec(),
        }
    }

    fn tables(&self) -> Option<Tables> {
        F::TABLES
    }
    fn masses(&self, state: &State, loads: &Loads) -> Option<Masses> {
        F::masses(&self.0, state, loads)
    }
    fn dynamics(&self) -> Option<&dyn AnyDynamics> {
        F::dynamics(self)
    }
}

impl<S, F, const N: usize, const M: usize> AnyMechanism for Facade<S, N, M, F>
where
    S: Kinematic<f64, N, M> + 'static,
    F: Forced<S, N, M>,
{
    fn follow(&self, times: &[f64], progress: &mut dyn FnMut(usize)) -> Result<Motion, Failure> {
        let Some((first, rest)) = times.split_first() else { return Ok(Motion::default()) };
        let mut stepper = self.assembled(*first)?;
        let mut motion = Motion::of(S::COORDINATES, S::OUTPUTS, stepper.outputs().as_ref());
        push(&mut motion, &stepper.frame());
        motion.push_mismatches(stepper.mismatches());
        for (done, time) in rest.iter().enumerate() {
            progress(done + 1);
            self.lead(&mut stepper, *time)?;
            push(&mut motion, &stepper.frame());
            motion.push_mismatches(stepper.mismatches());
        }
        progress(times.len());
        Ok(motion)
    }

    fn time_a_step(&self, times: &[f64]) -> Result<Duration, Failure> {
        let Some((first, rest)) = times.split_first() else { return Ok(Duration::ZERO) };
        let mut stepper = self.assembled(*first)?;
        let start = Instant::now();
        for time in rest {
            self.lead(&mut stepper, *time)?;
            black_box(stepper.outputs());
        }
        Ok(start.elapsed() / u32::try_from(rest.len().max(1)).unwrap_or(u32::MAX))
    }

    fn stop(&self, times: &[f64]) -> Option<MotionStop> {
        let (first, rest) = times.split_first()?;
        let mut stepper = self.assembled(*first).ok()?;
        let (mut reachable, mut refused, mut failure) = (*first, *first, None);
        for time in rest {
            match self.lead(&mut stepper, *time) {
                Ok(()) => reachable = *time,
                Err(found) => {
                    (refused, failure) = (*time, Some(found));
                    break;
                }
            }
        }
        let mut failure = failure?;
        if self.2.is_empty() {
            let ReachLimit { reachable, refused, failure, .. } = stepper.reach_towards(refused)?;
            return Some(MotionStop { reachable, refused, failure });
        }
        // A refused step leaves the position as it is, so the end is bisected along the courses of the inputs.
        for _ in 0..HALVINGS {
            let middle = 0.5 * (reachable + refused);
            match self.lead(&mut stepper, middle) {
                Ok(()) => reachable = middle,
                Err(found) => (refused, failure) = (middle, found),
            }
        }
        Some(MotionStop { reachable, refused, failure })
    }

    fn experiment(&self) -> &dyn Experiment {
        self
    }
}

/// Halvings of the instant in which a motion ends: to a millionth of it.
const HALVINGS: usize = 20;

impl<S: Kinematic<f64, N, M>, F, const N: usize, const M: usize> Facade<S, N, M, F> {
    fn assembled(&self, t: f64) -> Result<Stepper<Branching<S>, f64, N, M>, Failure> {
        let mut mechanism = Branching::declared(self.0.clone());
        self.set_inputs(&mut mechanism, t);
        let guess = mechanism.guess(&mechanism.parameters());
        Stepper::assemble(mechanism, guess, t)
    }

    /// The mechanism with its inputs of the time `t` (s).
    fn set_inputs(&self, mechanism: &mut Branching<S>, t: f64) {
        self.2.show(t, |index, value| {
            mechanism.set(index, value);
        });
    }

    /// A step to `t` (s) with the inputs of that time.
    fn lead(&self, stepper: &mut Stepper<Branching<S>, f64, N, M>, t: f64) -> Result<(), Failure> {
        if !self.2.is_empty() {
            stepper.change(|mechanism| self.set_inputs(mechanism, t));
        }
        stepper.advance_to(t).map(|_| ())
    }
}

fn push<O: AsRef<[OutputValue<f64>]>, const N: usize>(motion: &mut Motion, frame: &Frame<f64, O, N>) {
    motion.push(&motion::Instant {
        t: frame.t,
        q: [&frame.q, &frame.qd, &frame.qdd],
        outputs: frame.outputs.as_ref(),
        closure: frame.closure_error,
        iterations: frame.statistics.evaluations,
        margin: frame.margin,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modules_of_a_type_are_read_from_what_the_compiler_tells() {
        let of = |told| path(told, "Wiper");
        assert_eq!(of("own::cars::Wiper<f64, own::cars::Fast>").as_deref(), Some("own::cars::"));
        assert_eq!(of("mbs::Fed<[own::Wiper; 2]>").as_deref(), Some("own::"));
        assert_eq!(of("own::RearWiper<other::wiper::Lift>"), None);
        assert_eq!(of("Wiper"), None);
    }
}

//! A mechanism in the variants that hard cases are run in: parameters, starts, coordinates, rows, types of number, lanes.

use core::marker::PhantomData;

use mbs_runtime::{Dynamic, Failure, InNumbers, Kinematic, Lanes, Mechanism, Partitioned, Reveal, Visitor};

use super::adapted::Adapted;
use super::adaption::Adaption;
use super::driven_variations::{Beside, Driven, DrivenVariants, OfBatch, OfSingle, array};
use super::dynamics::integrators::{All, ExplicitOnly, Integrators};
use super::timed_runs::{Effort, Runs, Seen, TimedRuns};
use crate::setting::{MotionMethod, Numbers, Resolution};

/// Other coordinates, rows and start of a mechanism of any size: see [`Adaption`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Row that each one is, and its factor: M; empty as they are.
    pub rows: Vec<(usize, f64)>,
    /// A: N rows of N; empty as they are.
    pub map: Vec<Vec<f64>>,
    /// b: N; empty for none.
    pub shift: Vec<f64>,
}

/// A mechanism whose variants can be run, by what moves it.
pub enum Variable {
    /// Nothing.
    Still,
    /// Drives.
    Driven(Box<dyn DrivenVariants>),
    /// Forces.
    Moved(Box<dyn MovedVariants>),
}

/// Variants of a mechanism that forces move.
pub trait MovedVariants {
    /// Indices of the coordinates that the text starts.
    fn started(&self) -> Vec<usize>;
    /// `true` for each row that may follow from others; empty where none may.
    fn redundant(&self) -> Vec<bool>;
    /// The text's guess and rates: N each.
    fn guess(&self) -> [Vec<f64>; 2];
    /// Coordinates and velocities of the start that the text has: N each.
    ///
    /// # Errors
    /// The mechanism cannot start.
    fn start_of_text(&self) -> Result<[Vec<f64>; 2], Failure>;
    /// Coordinates and velocities of the start next to these (N each), all of which count as given.
    ///
    /// # Errors
    /// The mechanism cannot start there.
    fn start(&self, near: &[Vec<f64>; 2]) -> Result<[Vec<f64>; 2], Failure>;
    /// `true` where the method suits the mechanism in a type of number.
    fn admits(&self, method: MotionMethod, numbers: Numbers) -> bool;
    /// A motion in `f64` or `f32` as the text has it.
    ///
    /// # Errors
    /// Those of the run.
    fn run(
        &self,
        numbers: Numbers,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: &mut dyn FnMut(Seen),
    ) -> Result<Effort, Failure>;
    /// A motion from `start` in other coordinates and rows; what is seen is in those of the text.
    ///
    /// # Errors
    /// Those of the run.
    fn run_changed(
        &self,
        change: &Change,
        start: &[Vec<f64>; 2],
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: &mut dyn FnMut(Seen),
    ) -> Result<Effort, Failure>;
}

/// A function from parameters and inputs by their indices to the variants of the mechanism that an expression makes:
/// `variable!(Wiper::default())`. With the name of its type and its functions of the caller these may be in `f64` alone:
/// `variable!(make(), Wiper, [lift])`.
#[macro_export]
macro_rules! variable {
    ($make:expr, $kind:ident, [$($function:ident),* $(,)?] $(,)?) => {
        |values: &[(usize, f64)]| {
            let (mechanism, _) = $crate::erased::in_double::in_all_numbers!($make, $kind, [$($function),*], values);
            $crate::erased::variations::variable(&mechanism)
        }
    };
    ($make:expr $(,)?) => {
        |values: &[(usize, f64)]| {
            let mut mechanism = $make;
            for (index, value) in values {
                ::mbs_runtime::Mechanism::set(&mut mechanism, *index, *value);
            }
            $crate::erased::variations::variable(&mechanism)
        }
    };
}

/// The variants of `mechanism`.
pub fn variable<S>(mechanism: &S) -> Variable
where
    S: Reveal + Clone + InNumbers<f32> + InNumbers<Lanes<f64, 4>>,
    <S as InNumbers<f32>>::Mechanism: Reveal<f32>,
    <S as InNumbers<Lanes<f64, 4>>>::Mechanism: Reveal<Lanes<f64, 4>>,
{
    let single = InNumbers::<f32>::in_numbers(mechanism).reveal(InSingle);
    let lanes = || InNumbers::<Lanes<f64, 4>>::in_numbers(mechanism).reveal(OfLanes);
    match mechanism.clone().reveal(InDouble) {
        Form::Still => Variable::Still,
        Form::Driven(double) => {
            let Form::Driven(single) = single else { return Variable::Still };
            Variable::Driven(Box::new(Driven { double, single, lanes: lanes() }))
        }
        Form::Moved(double) => {
            let Form::Moved(single) = single else { return Variable::Still };
            Variable::Moved(Box::new(Moved { double, single }))
        }
    }
}

/// Inverse of the change: puts a state in the coordinates and rows of the text.
type Back = Box<dyn Fn(Seen) -> Seen>;

/// Runs of a mechanism in `f64`, in other coordinates too.
trait Changeable {
    fn runs(&self) -> &dyn TimedRuns;
    fn started(&self) -> Vec<usize>;
    fn redundant(&self) -> Vec<bool>;
    fn guess(&self) -> [Vec<f64>; 2];
    fn changed(&self, change: &Change, start: &[Vec<f64>; 2]) -> (Box<dyn TimedRuns>, Back);
}

struct OfRuns<S, I, R, const N: usize, const M: usize> {
    mechanism: S,
    runs: Runs<S, I, R, N, M>,
}

impl<S: Clone, I, R, const N: usize, const M: usize> OfRuns<S, I, R, N, M> {
    fn of(mechanism: S) -> Self {
        OfRuns { runs: Runs::of(mechanism.clone()), mechanism }
    }
}

impl Change {
    fn adaption<const N: usize, const M: usize>(&self, start: &[Vec<f64>; 2]) -> Adaption<N, M> {
        let mut adaption = Adaption::none([array(&start[0]), array(&start[1])]);
        adaption.rows.iter_mut().zip(&self.rows).for_each(|(own, row)| *own = *row);
        adaption.map.iter_mut().zip(&self.map).for_each(|(own, row)| *own = array(row));
        adaption.shift = array(&self.shift);
        adaption
    }
}

impl<S, I, const N: usize, const M: usize> Changeable for OfRuns<S, I, f64, N, M>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + 'static,
    I: Integrators,
{
    fn runs(&self) -> &dyn TimedRuns {
        &self.runs
    }
    fn started(&self) -> Vec<usize> {
        S::STARTED.iter().map(|index| usize::from(*index)).collect()
    }
    fn redundant(&self) -> Vec<bool> {
        S::REDUNDANT.to_vec()
    }
    fn guess(&self) -> [Vec<f64>; 2] {
        let parameters = self.mechanism.parameters();
        [self.mechanism.guess(&parameters).to_vec(), self.mechanism.start_rates(&parameters).to_vec()]
    }
    fn changed(&self, change: &Change, start: &[Vec<f64>; 2]) -> (Box<dyn TimedRuns>, Back) {
        let adaption = change.adaption::<N, M>(start);
        let adapted = Adapted { mechanism: self.mechanism.clone(), adaption: adaption.clone() };
        let back = move |mut state: Seen| {
            state.q = adaption.position(&array(&state.q)).to_vec();
            state.qd = adaption.direction(&array(&state.qd)).to_vec();
            state.qdd = adaption.direction(&array(&state.qdd)).to_vec();
            state.observed.reaction = adaption.direction(&array(&state.observed.reaction)).to_vec();
            state.lambda = adaption.multipliers(&array(&state.lambda)).to_vec();
            state
        };
        (Box::new(Runs::<_, I, f64, N, M>::of(adapted)), Box::new(back))
    }
}

struct Moved {
    double: Box<dyn Changeable>,
    single: Box<dyn TimedRuns>,
}

impl Moved {
    fn runs(&self, numbers: Numbers) -> &dyn TimedRuns {
        if numbers == Numbers::Double { self.double.runs() } else { self.single.as_ref() }
    }
}

impl MovedVariants for Moved {
    fn started(&self) -> Vec<usize> {
        self.double.started()
    }
    fn redundant(&self) -> Vec<bool> {
        self.double.redundant()
    }
    fn guess(&self) -> [Vec<f64>; 2] {
        self.double.guess()
    }
    fn start_of_text(&self) -> Result<[Vec<f64>; 2], Failure> {
        self.double.runs().start(0.0)
    }
    fn start(&self, near: &[Vec<f64>; 2]) -> Result<[Vec<f64>; 2], Failure> {
        self.double.changed(&Change::default(), near).0.start(0.0)
    }
    fn admits(&self, method: MotionMethod, numbers: Numbers) -> bool {
        self.runs(numbers).admits(method)
    }
    fn run(
        &self,
        numbers: Numbers,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: &mut dyn FnMut(Seen),
    ) -> Result<Effort, Failure> {
        self.runs(numbers).run(method, resolution, times, Some(see))
    }
    fn run_changed(
        &self,
        change: &Change,
        start: &[Vec<f64>; 2],
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: &mut dyn FnMut(Seen),
    ) -> Result<Effort, Failure> {
        let (runs, back) = self.double.changed(change, start);
        runs.run(method, resolution, times, Some(&mut |state| see(back(state))))
    }
}

/// A mechanism in one type of number, by what moves it.
enum Form<M> {
    Still,
    Driven(Box<dyn Beside>),
    Moved(M),
}

/// Visits in `f64`, or in `f32` of which no other coordinates are run.
struct InDouble;
struct InSingle;

macro_rules! visitor {
    ($visitor:ident, $real:ty, $moved:ty, $make:expr) => {
        impl<S: 'static> Visitor<S, $real> for $visitor {
            type Output = Form<$moved>;

            fn described<const N: usize, const M: usize>(self, _: S) -> Self::Output
            where
                S: Mechanism<$real, N, M>,
            {
                Form::Still
            }
            fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
            where
                S: Kinematic<$real, N, M>,
            {
                Form::Driven(Box::new(OfSingle::<S, $real, N, M>(mechanism, PhantomData)))
            }
            fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
            where
                S: Kinematic<$real, N, M> + Dynamic<$real, N, M> + Partitioned<$real, N, M>,
            {
                Form::Driven(Box::new(OfSingle::<S, $real, N, M>(mechanism, PhantomData)))
            }
            fn free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
            where
                S: Dynamic<$real, N, M> + Partitioned<$real, N, M>,
            {
                $make(OfRuns::<S, All, $real, N, M>::of(mechanism))
            }
            fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
            where
                S: Kinematic<$real, N, M> + Dynamic<$real, N, M> + Partitioned<$real, N, M>,
            {
                Form::Driven(Box::new(OfSingle::<S, $real, N, M>(mechanism, PhantomData)))
            }
            fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
            where
                S: Dynamic<$real, N, M> + Partitioned<$real, N, M>,
            {
                $make(OfRuns::<S, ExplicitOnly, $real, N, M>::of(mechanism))
            }
        }
    };
}

visitor!(InDouble, f64, Box<dyn Changeable>, |own| Form::Moved(changeable(own)));
visitor!(InSingle, f32, Box<dyn TimedRuns>, |own| Form::Moved(runs_of(own)));

fn changeable<S, I, const N: usize, const M: usize>(own: OfRuns<S, I, f64, N, M>) -> Box<dyn Changeable>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + 'static,
    I: Integrators,
{
    Box::new(own)
}

fn runs_of<S, I, const N: usize, const M: usize>(own: OfRuns<S, I, f32, N, M>) -> Box<dyn TimedRuns>
where
    S: Dynamic<f32, N, M> + Partitioned<f32, N, M> + 'static,
    I: Integrators,
{
    Box::new(own.runs)
}

/// Visits in lanes.
struct OfLanes;

impl<S: 'static> Visitor<S, Lanes<f64, 4>> for OfLanes {
    type Output = Option<Box<dyn Beside>>;

    fn described<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Mechanism<Lanes<f64, 4>, N, M>,
    {
        None
    }
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<f64, 4>, N, M, Lane: Kinematic<f64, N, M>> + Kinematic<Lanes<f64, 4>, N, M>,
    {
        Some(Box::new(OfBatch::<S, N, M>(mechanism)))
    }
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<f64, 4>, N, M, Lane: Kinematic<f64, N, M>>
            + Kinematic<Lanes<f64, 4>, N, M>
            + Dynamic<Lanes<f64, 4>, N, M>
            + Partitioned<Lanes<f64, 4>, N, M>,
    {
        Some(Box::new(OfBatch::<S, N, M>(mechanism)))
    }
    fn free<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Dynamic<Lanes<f64, 4>, N, M> + Partitioned<Lanes<f64, 4>, N, M>,
    {
        None
    }
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<f64, 4>, N, M, Lane: Kinematic<f64, N, M>>
            + Kinematic<Lanes<f64, 4>, N, M>
            + Dynamic<Lanes<f64, 4>, N, M>
            + Partitioned<Lanes<f64, 4>, N, M>,
    {
        Some(Box::new(OfBatch::<S, N, M>(mechanism)))
    }
    fn large_free<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Dynamic<Lanes<f64, 4>, N, M> + Partitioned<Lanes<f64, 4>, N, M>,
    {
        None
    }
}

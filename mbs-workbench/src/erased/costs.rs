//! A mechanism in all numbers that its settings are compared in.

use core::marker::PhantomData;

use mbs_runtime::{Dynamic, InNumbers, Kinematic, Lanes, Mechanism, Partitioned, Real, Reveal, Visitor};

use super::dynamics::integrators::{All, ExplicitOnly};
use super::exact::{Exact, ExactEquations};
use super::timed_runs::{Runs, TimedRuns};
use super::timed_steps::{ExactPositions, InLanes, Positions, Single, TimedSteps};
use crate::double_double::DoubleDouble as D;
use crate::setting::Numbers;

/// A mechanism whose settings can be compared.
pub enum Comparable {
    /// Its rows leave it free and nothing moves it.
    Still,
    /// Drives move it.
    Driven(Box<DrivenCosts>),
    /// Forces move it.
    Moved(Box<MovedCosts>),
}

impl Comparable {
    /// With the names of functions that exist in `f64` alone.
    pub fn with_doubles(mut self, names: Vec<&'static str>) -> Self {
        match &mut self {
            Comparable::Still => {}
            Comparable::Driven(mechanism) => mechanism.doubles = names,
            Comparable::Moved(mechanism) => mechanism.doubles = names,
        }
        self
    }
}

/// A mechanism that drives move.
pub struct DrivenCosts {
    /// In double-double numbers.
    pub exact: Box<dyn ExactPositions>,
    /// By type of number and number of lanes.
    pub runs: Vec<(Numbers, u32, Box<dyn TimedSteps>)>,
    /// Functions of the caller that exist in `f64` alone.
    pub doubles: Vec<&'static str>,
}

/// Effect with modes, which the runtime alone decides, with the runs that references are made of.
pub struct OneKind {
    /// The first of the text: a friction that sticks, a rigid contact or an event.
    pub effect: &'static str,
    /// Numbers of its contacts with stiffness, and of rows that are rigid contacts or stand beside them. Lists of
    /// [`TimedRuns::contacts`] are in this order, those of events last.
    pub contacts: [usize; 2],
    /// In double-double numbers.
    pub runs: Box<dyn TimedRuns>,
}

/// A mechanism that forces move.
pub struct MovedCosts {
    /// In double-double numbers.
    pub exact: Box<dyn ExactEquations>,
    /// Runs for references of one kind, where forces are no functions of the state.
    pub one_kind: Option<OneKind>,
    /// By type of number.
    pub runs: Vec<(Numbers, Box<dyn TimedRuns>)>,
    /// Functions of the caller that exist in `f64` alone.
    pub doubles: Vec<&'static str>,
}

/// A function from parameters and inputs by their indices to all that a comparison needs of the mechanism that an expression makes:
/// `comparable!(Wiper::default())`. With the names of some functions of its caller, which exist in `f64` alone, their constructor
/// `Wiper::new` takes them in all numbers: `comparable!(wiper(), Wiper, [lift])`.
#[macro_export]
macro_rules! comparable {
    ($make:expr, $kind:ident, [$($function:ident),* $(,)?] $(,)?) => {
        |values: &[(usize, f64)]| {
            let (mechanism, doubles) = $crate::erased::in_double::in_all_numbers!($make, $kind, [$($function),*], values);
            $crate::erased::costs::comparable(&mechanism).with_doubles(doubles)
        }
    };
    ($make:expr $(,)?) => {
        |values: &[(usize, f64)]| {
            let mut mechanism = $make;
            for (index, value) in values {
                ::mbs_runtime::Mechanism::set(&mut mechanism, *index, *value);
            }
            $crate::erased::costs::comparable(&mechanism)
        }
    };
}

/// All that the comparison needs of `mechanism`.
pub fn comparable<S>(mechanism: &S) -> Comparable
where
    S: Reveal
        + Clone
        + InNumbers<D>
        + InNumbers<f32>
        + InNumbers<Lanes<f64, 4>>
        + InNumbers<Lanes<f64, 8>>
        + InNumbers<Lanes<f64, 16>>
        + InNumbers<Lanes<f32, 8>>,
    <S as InNumbers<D>>::Mechanism: Reveal<D>,
    <S as InNumbers<f32>>::Mechanism: Reveal<f32>,
    <S as InNumbers<Lanes<f64, 4>>>::Mechanism: Reveal<Lanes<f64, 4>>,
    <S as InNumbers<Lanes<f64, 8>>>::Mechanism: Reveal<Lanes<f64, 8>>,
    <S as InNumbers<Lanes<f64, 16>>>::Mechanism: Reveal<Lanes<f64, 16>>,
    <S as InNumbers<Lanes<f32, 8>>>::Mechanism: Reveal<Lanes<f32, 8>>,
{
    let double = mechanism.clone().reveal(InOne::<f64>(PhantomData));
    let single = InNumbers::<f32>::in_numbers(mechanism).reveal(InOne::<f32>(PhantomData));
    match InNumbers::<D>::in_numbers(mechanism).reveal(InExact) {
        ExactForm::Still => Comparable::Still,
        ExactForm::Moved(exact, one_kind) => {
            let runs = [(Numbers::Double, double.moved), (Numbers::Single, single.moved)];
            let runs = runs.into_iter().filter_map(|(numbers, runs)| Some((numbers, runs?))).collect();
            Comparable::Moved(Box::new(MovedCosts { exact, one_kind, runs, doubles: Vec::new() }))
        }
        ExactForm::Driven(exact) => {
            let runs = [
                (Numbers::Double, 1, double.driven),
                (Numbers::Single, 1, single.driven),
                (Numbers::Double, 4, in_lanes::<S, f64, 4>(mechanism)),
                (Numbers::Double, 8, in_lanes::<S, f64, 8>(mechanism)),
                (Numbers::Double, 16, in_lanes::<S, f64, 16>(mechanism)),
                (Numbers::Single, 8, in_lanes::<S, f32, 8>(mechanism)),
            ];
            let runs = runs.into_iter().filter_map(|(numbers, lanes, run)| Some((numbers, lanes, run?)));
            Comparable::Driven(Box::new(DrivenCosts { exact, runs: runs.collect(), doubles: Vec::new() }))
        }
    }
}

fn in_lanes<S, R, const L: usize>(mechanism: &S) -> Option<Box<dyn TimedSteps>>
where
    R: Real,
    S: InNumbers<Lanes<R, L>>,
    S::Mechanism: Reveal<Lanes<R, L>>,
{
    mechanism.in_numbers().reveal(OfLanes::<R, L>(PhantomData))
}

/// Form of a mechanism in double-double numbers.
enum ExactForm {
    Still,
    Driven(Box<dyn ExactPositions>),
    Moved(Box<dyn ExactEquations>, Option<OneKind>),
}

impl ExactForm {
    fn moved<S, const N: usize, const M: usize>(mechanism: S) -> Self
    where
        S: Dynamic<D, N, M> + Partitioned<D, N, M> + Clone + 'static,
    {
        let mut one_kind = None;
        // A text without modes compiles no runs in these numbers.
        if const { S::HAS_MODES }
            && let Some(entry) = S::SET_VALUED.first().or(S::EVENTS.first())
        {
            let runs = Box::new(Runs::<S, ExplicitOnly, D, N, M>::of(mechanism.clone()));
            let rigid = if S::HAS_RIGID_CONTACTS { S::SET_VALUED.len() } else { 0 };
            one_kind = Some(OneKind { effect: entry.name, contacts: [S::CONTACTS.len(), rigid], runs });
        }
        ExactForm::Moved(Box::new(Exact::<S, N, M>::of(mechanism)), one_kind)
    }
}

struct InExact;

impl<S: 'static> Visitor<S, D> for InExact {
    type Output = ExactForm;

    fn described<const N: usize, const M: usize>(self, _: S) -> ExactForm
    where
        S: Mechanism<D, N, M>,
    {
        ExactForm::Still
    }
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> ExactForm
    where
        S: Kinematic<D, N, M>,
    {
        ExactForm::Driven(Box::new(Positions::<S, N, M>::of(mechanism)))
    }
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> ExactForm
    where
        S: Kinematic<D, N, M> + Dynamic<D, N, M> + Partitioned<D, N, M>,
    {
        ExactForm::Driven(Box::new(Positions::<S, N, M>::of(mechanism)))
    }
    fn free<const N: usize, const M: usize>(self, mechanism: S) -> ExactForm
    where
        S: Dynamic<D, N, M> + Partitioned<D, N, M>,
    {
        ExactForm::moved(mechanism)
    }
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> ExactForm
    where
        S: Kinematic<D, N, M> + Dynamic<D, N, M> + Partitioned<D, N, M>,
    {
        ExactForm::Driven(Box::new(Positions::<S, N, M>::of(mechanism)))
    }
    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> ExactForm
    where
        S: Dynamic<D, N, M> + Partitioned<D, N, M>,
    {
        ExactForm::moved(mechanism)
    }
}

/// Runs of a mechanism in one type of number.
struct OneForm {
    driven: Option<Box<dyn TimedSteps>>,
    moved: Option<Box<dyn TimedRuns>>,
}

impl OneForm {
    fn driven<S, R, const N: usize, const M: usize>(mechanism: S) -> Self
    where
        S: Kinematic<R, N, M> + 'static,
        R: Real,
    {
        OneForm { driven: Some(Box::new(Single::<S, R, N, M>::of(mechanism))), moved: None }
    }
}

struct InOne<R>(PhantomData<R>);

impl<S: 'static, R: Real> Visitor<S, R> for InOne<R> {
    type Output = OneForm;

    fn described<const N: usize, const M: usize>(self, _: S) -> OneForm
    where
        S: Mechanism<R, N, M>,
    {
        OneForm { driven: None, moved: None }
    }
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> OneForm
    where
        S: Kinematic<R, N, M>,
    {
        OneForm::driven::<S, R, N, M>(mechanism)
    }
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> OneForm
    where
        S: Kinematic<R, N, M> + Dynamic<R, N, M> + Partitioned<R, N, M>,
    {
        OneForm::driven::<S, R, N, M>(mechanism)
    }
    fn free<const N: usize, const M: usize>(self, mechanism: S) -> OneForm
    where
        S: Dynamic<R, N, M> + Partitioned<R, N, M>,
    {
        OneForm { driven: None, moved: Some(Box::new(Runs::<S, All, R, N, M>::of(mechanism))) }
    }
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> OneForm
    where
        S: Kinematic<R, N, M> + Dynamic<R, N, M> + Partitioned<R, N, M>,
    {
        OneForm::driven::<S, R, N, M>(mechanism)
    }
    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> OneForm
    where
        S: Dynamic<R, N, M> + Partitioned<R, N, M>,
    {
        OneForm { driven: None, moved: Some(Box::new(Runs::<S, ExplicitOnly, R, N, M>::of(mechanism))) }
    }
}

struct OfLanes<R, const L: usize>(PhantomData<R>);

impl<S: 'static, R: Real, const L: usize> Visitor<S, Lanes<R, L>> for OfLanes<R, L> {
    type Output = Option<Box<dyn TimedSteps>>;

    fn described<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Mechanism<Lanes<R, L>, N, M>,
    {
        None
    }
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<R, L>, N, M, Lane: Kinematic<R, N, M>> + Kinematic<Lanes<R, L>, N, M>,
    {
        Some(Box::new(InLanes::<S, R, L, N, M>::of(mechanism)))
    }
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<R, L>, N, M, Lane: Kinematic<R, N, M>>
            + Kinematic<Lanes<R, L>, N, M>
            + Dynamic<Lanes<R, L>, N, M>
            + Partitioned<Lanes<R, L>, N, M>,
    {
        Some(Box::new(InLanes::<S, R, L, N, M>::of(mechanism)))
    }
    fn free<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Dynamic<Lanes<R, L>, N, M> + Partitioned<Lanes<R, L>, N, M>,
    {
        None
    }
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<Lanes<R, L>, N, M, Lane: Kinematic<R, N, M>>
            + Kinematic<Lanes<R, L>, N, M>
            + Dynamic<Lanes<R, L>, N, M>
            + Partitioned<Lanes<R, L>, N, M>,
    {
        Some(Box::new(InLanes::<S, R, L, N, M>::of(mechanism)))
    }
    fn large_free<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Dynamic<Lanes<R, L>, N, M> + Partitioned<Lanes<R, L>, N, M>,
    {
        None
    }
}

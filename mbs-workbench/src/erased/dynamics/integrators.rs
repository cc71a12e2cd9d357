//! Integrators that a mechanism is moved by: chosen at run time, so that all else of a run is compiled once a mechanism.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Either, Embedded, FixedStep, Radau5, RungeKutta4, SemiImplicitEuler,
};

use super::direct_dynamics::{Pair, Rule};

/// Explicit pairs.
pub type Pairs = Either<DormandPrince8, DormandPrince5>;

/// Explicit methods of fixed steps.
pub type Rules = Either<RungeKutta4, SemiImplicitEuler>;

/// Integrators that suit the size of a mechanism.
pub trait Integrators: Copy + 'static {
    /// Those of adaptive steps.
    type Adaptive: Embedded + 'static;
    /// Those of fixed steps.
    type Fixed: FixedStep + 'static;
    /// Radau IIA in both kinds of steps; none where its matrices are too large for a stack.
    const RADAU: Option<(Self::Adaptive, Self::Fixed)>;

    /// An explicit pair.
    fn pair(pair: Pair) -> Self::Adaptive;
    /// An explicit method of fixed steps.
    fn rule(rule: Rule) -> Self::Fixed;
}

/// Explicit ones and Radau IIA.
#[derive(Clone, Copy, Debug)]
pub struct All;

/// Explicit ones.
#[derive(Clone, Copy, Debug)]
pub struct ExplicitOnly;

const fn pairs(pair: Pair) -> Pairs {
    match pair {
        Pair::Order8 => Either::First(DormandPrince8),
        Pair::Order5 => Either::Second(DormandPrince5),
    }
}

const fn rules(rule: Rule) -> Rules {
    match rule {
        Rule::RungeKutta4 => Either::First(RungeKutta4),
        Rule::SemiImplicitEuler => Either::Second(SemiImplicitEuler),
    }
}

impl Integrators for All {
    type Adaptive = Either<Pairs, Radau5>;
    type Fixed = Either<Rules, Radau5>;
    const RADAU: Option<(Self::Adaptive, Self::Fixed)> =
        Some((Either::Second(Radau5), Either::Second(Radau5)));

    fn pair(pair: Pair) -> Self::Adaptive {
        Either::First(pairs(pair))
    }
    fn rule(rule: Rule) -> Self::Fixed {
        Either::First(rules(rule))
    }
}

impl Integrators for ExplicitOnly {
    type Adaptive = Pairs;
    type Fixed = Rules;
    const RADAU: Option<(Self::Adaptive, Self::Fixed)> = None;

    fn pair(pair: Pair) -> Self::Adaptive {
        pairs(pair)
    }
    fn rule(rule: Rule) -> Self::Fixed {
        rules(rule)
    }
}

//! Functions of the caller that exist in `f64` alone, in all numbers.

use mbs_runtime::{Function, Interval, Lanes, Mechanism, Real, Scalar};

use crate::double_double::DoubleDouble as D;

/// A function in `f64`, evaluated lane by lane. In numbers of more digits its derivatives carry it over the rest of the argument, so its
/// values have the digits of `f64`.
#[derive(Clone, Debug)]
pub struct InDouble<F>(pub F);

impl<T: Scalar, F: Function<f64>> Function<T> for InDouble<F> {
    const ORDER: usize = F::ORDER;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let lanes = T::per_lane(|lane| {
            let x = x.lane(lane);
            let whole = x.to_f64();
            let rest = x - T::Real::constant(whole);
            let values = self.0.jet::<K>(whole);
            core::array::from_fn::<T::Real, K, _>(|order| {
                let value = T::Real::constant(values[order]);
                values.get(order + 1).map_or(value, |slope| value + T::Real::constant(*slope) * rest)
            })
        });
        core::array::from_fn(|order| {
            T::from_lanes(|lane| {
                let jet = lanes.as_ref().get(lane).or(lanes.as_ref().last());
                jet.map_or(T::Real::constant(f64::NAN), |jet| jet[order])
            })
        })
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        self.0.breakpoint_after(x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        self.0.enclosure(from, to)
    }
}

/// A function of the caller, or an array of them, whose numbers are looked at. `(&Given(function)).chosen()` is the function itself where
/// it takes all numbers of a study, else [`InDouble`]. All four traits must be in scope; the compiler takes the first that fits.
#[derive(Clone, Debug)]
pub struct Given<F>(pub F);

/// A function that takes all numbers of a study.
pub trait InAllNumbers {
    /// The function.
    type Function;
    /// The function as it is.
    fn chosen(&self) -> Self::Function;
    /// `false`: it takes other numbers than `f64`.
    fn is_double(&self) -> bool {
        false
    }
}

impl<F> InAllNumbers for Given<F>
where
    F: Clone
        + Function<f64>
        + Function<D>
        + Function<f32>
        + Function<Lanes<f64, 4>>
        + Function<Lanes<f32, 8>>,
{
    type Function = F;

    fn chosen(&self) -> F {
        self.0.clone()
    }
}

/// A function in `f64`.
pub trait InDoubleAlone {
    /// The function in all numbers.
    type Function;
    /// The function in all numbers.
    fn chosen(&self) -> Self::Function;
    /// `true`: it takes no other numbers.
    fn is_double(&self) -> bool {
        true
    }
}

impl<F: Clone + Function<f64>> InDoubleAlone for &Given<F> {
    type Function = InDouble<F>;

    fn chosen(&self) -> InDouble<F> {
        InDouble(self.0.clone())
    }
}

/// An array of functions that take all numbers of a study.
pub trait EachInAllNumbers {
    /// The functions.
    type Functions;
    /// The functions as they are.
    fn chosen(&self) -> Self::Functions;
    /// `false`: they take other numbers than `f64`.
    fn is_double(&self) -> bool {
        false
    }
}

impl<F: Clone, const N: usize> EachInAllNumbers for Given<[F; N]>
where
    Given<F>: InAllNumbers,
{
    type Functions = [F; N];

    fn chosen(&self) -> [F; N] {
        self.0.clone()
    }
}

/// An array of functions in `f64`.
pub trait EachInDoubleAlone {
    /// The functions in all numbers.
    type Functions;
    /// The functions in all numbers.
    fn chosen(&self) -> Self::Functions;
    /// `true`: they take no other numbers.
    fn is_double(&self) -> bool {
        true
    }
}

impl<F: Clone + Function<f64>, const N: usize> EachInDoubleAlone for &Given<[F; N]> {
    type Functions = [InDouble<F>; N];

    fn chosen(&self) -> [InDouble<F>; N] {
        self.0.clone().map(InDouble)
    }
}

/// The mechanism that an expression makes, with its functions of the caller in all numbers and with `values` of parameters and inputs by
/// their indices, and the names of functions that are in `f64` alone: `in_all_numbers!(make(), Wiper, [lift], values)`.
#[macro_export]
macro_rules! in_all_numbers {
    ($make:expr, $kind:ident, [$($function:ident),* $(,)?], $values:expr) => {{
        #[allow(unused_imports)]
        use $crate::erased::in_double::{
            EachInAllNumbers, EachInDoubleAlone, Given, InAllNumbers, InDoubleAlone,
        };
        let given = $make;
        let mut doubles = ::std::vec::Vec::new();
        $(if (&Given(::core::clone::Clone::clone(&given.$function))).is_double() {
            doubles.push(::core::stringify!($function));
        })*
        let mut mechanism = $kind::new($((&Given(::core::clone::Clone::clone(&given.$function))).chosen()),*);
        for index in 0..$crate::erased::in_double::variables(&given) {
            if let ::core::option::Option::Some(value) = ::mbs_runtime::Mechanism::get(&given, index) {
                ::mbs_runtime::Mechanism::set(&mut mechanism, index, value);
            }
        }
        for (index, value) in $values {
            ::mbs_runtime::Mechanism::set(&mut mechanism, *index, *value);
        }
        (mechanism, doubles)
    }};
}

pub use in_all_numbers;

/// Number of components of parameters and inputs.
pub fn variables<S: Mechanism<f64, N, M>, const N: usize, const M: usize>(_: &S) -> usize {
    S::VARIABLES.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x³ in `f64`.
    #[derive(Clone)]
    struct Cube;

    impl Function<f64> for Cube {
        const ORDER: usize = 3;

        fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
            let all = [x * x * x, 3.0 * x * x, 6.0 * x, 6.0];
            core::array::from_fn(|order| all[order])
        }
    }

    /// x in any numbers.
    #[derive(Clone)]
    struct Line;

    impl<T: Scalar> Function<T> for Line {
        const ORDER: usize = 1;

        fn jet<const K: usize>(&self, x: T) -> [T; K] {
            core::array::from_fn(|order| [x, T::constant(1.0)][order])
        }
    }

    #[test]
    fn a_function_in_doubles_is_smooth_below_their_rounding() {
        let x = D::constant(0.5) + D::constant(1e-20);
        let [value, slope] = Function::<D>::jet::<2>(&InDouble(Cube), x);
        let rest = (value - D::constant(0.125)).high;
        assert!((rest - 0.75e-20).abs() < 1e-30, "{rest:e}");
        assert_eq!(slope.high, 0.75);
        let lanes = Lanes::<f64, 4>::from_lanes(|lane| lane as f64);
        let [value] = Function::<Lanes<f64, 4>>::jet::<1>(&InDouble(Cube), lanes);
        assert_eq!([0, 1, 2, 3].map(|lane| value.lane(lane)), [0.0, 1.0, 8.0, 27.0]);
    }

    #[test]
    #[allow(clippy::needless_borrow, reason = "the borrow is what tells both traits apart")]
    fn only_functions_without_other_numbers_are_taken_in_doubles() {
        assert!((&Given(Cube)).is_double());
        assert!(!(&Given(Line)).is_double());
        let _: InDouble<Cube> = (&Given(Cube)).chosen();
        let _: Line = (&Given(Line)).chosen();
        assert!((&Given([Cube, Cube])).is_double());
        assert!(!(&Given([Line, Line])).is_double());
        let _: [InDouble<Cube>; 2] = (&Given([Cube, Cube])).chosen();
        let _: [Line; 2] = (&Given([Line, Line])).chosen();
    }
}

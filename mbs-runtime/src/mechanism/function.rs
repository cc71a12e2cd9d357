//! Functions that are supplied at run time: tabulated laws, splines, a user's own.

use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// A function that a text declares, as its emitted type lists it: the requirements on a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionEntry {
    /// As the text spells it, `lift` or `lift[0]`; the public field of this name, or this element of it, holds the function.
    pub name: &'static str,
    /// Coherent SI unit of the value as the text spells it.
    pub unit: &'static str,
    /// Coherent SI unit of the argument as the text spells it.
    pub argument_unit: &'static str,
    /// Number of continuous derivatives that the text counts on.
    pub continuity: u8,
    /// Highest derivative that the emitted code asks for; a type with a smaller [`ORDER`](Function::ORDER) does not
    /// compile.
    pub order: u8,
    /// Period in the unit of the argument. Arguments come as they are, over many periods.
    pub period: Option<f64>,
    /// Line in the source file.
    pub line: u32,
}

/// A scalar function with derivatives, of one argument: a `function` of the text at run time.
///
/// The data of a function are numbers; only its argument and its values are of the scalar type, so that one function
/// serves `f64`, `f32` and lanes alike.
pub trait Function<T: Scalar> {
    /// Number of continuous derivatives: 2 for a natural cubic spline. A text that needs more does not compile:
    ///
    /// ```compile_fail,E0080
    /// use mbs_runtime::{Function, Mechanism, Scalar, mechanism};
    ///
    /// mechanism! {
    ///     /// A follower whose row needs two derivatives, as all rows do.
    ///     pub mechanism Follower;
    ///     function lift: m(rad), C2;
    ///     coord theta: rad;
    ///     coord y: m;
    ///     drive cam: theta == t/1s;
    ///     constraint face { y == lift(theta); }
    /// }
    ///
    /// #[derive(Clone)]
    /// struct Polyline;
    ///
    /// impl<T: Scalar> Function<T> for Polyline {
    ///     const ORDER: usize = 0; // with 2 it compiles
    ///
    ///     fn jet<const K: usize>(&self, x: T) -> [T; K] {
    ///         let mut jet = [T::constant(0.0); K];
    ///         for (derivative, value) in jet.iter_mut().zip([x, T::constant(1.0)]) {
    ///             *derivative = value;
    ///         }
    ///         jet
    ///     }
    /// }
    ///
    /// let follower: Follower<Polyline> = Follower::new(Polyline);
    /// let _ = follower.parameters();
    /// ```
    const ORDER: usize;

    /// Value and the first `K` − 1 derivatives at `x`: K, in the function's unit over that of `x` to the power of the
    /// derivative. Asked for with `K <= ORDER + 1` alone.
    fn jet<const K: usize>(&self, x: T) -> [T; K];

    /// The least argument above `x` where a derivative of order `ORDER` + 1 may jump; `None` where none does.
    ///
    /// An integrator that steps to it keeps its order.
    fn breakpoint_after(&self, _x: f64) -> Option<f64> {
        None
    }

    /// Bounds of the value and of the first `K` − 1 derivatives at all arguments from `from` to `to`; `None` where none are known.
    /// Asked for with `K <= ORDER + 1` alone.
    ///
    /// Searches that may miss nothing ask for them, as [`reach`](crate::driver::reach()) does; no step does. The bounds of a
    /// shorter interval must be closer. [`Bounded`](crate::driver::Bounded) makes them from a bound of the third derivative.
    fn enclosure<const K: usize>(&self, _from: f64, _to: f64) -> Option<[Interval<f64>; K]> {
        None
    }
}

impl<T: Scalar, F: Function<T>> Function<T> for &F {
    const ORDER: usize = F::ORDER;

    #[inline(always)]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        (*self).jet(x)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        (*self).breakpoint_after(x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        (*self).enclosure(from, to)
    }
}

//! Points of a vector space that an integrator advances, of any parts.

use crate::scalar::number::Scalar;

/// A point that integrators add multiples of others to.
///
/// Arrays are points; so is the [`IntegratorState`] of a mechanism, whose `[T; 2 * N]` stable Rust cannot write.
pub trait Vector<T: Scalar>: Copy {
    /// The origin, of the same shape.
    fn zero(&self) -> Self;
    /// `self` + h Σ weightₖ termₖ. The sum is formed first, so that a small change keeps its digits.
    fn plus<const K: usize>(&self, h: T, weights: &[f64; K], terms: [&Self; K]) -> Self;

    /// A step of the semi-implicit Euler method: velocities by their rate, then coordinates by the new velocities.
    /// A point without such parts takes the explicit step.
    #[inline(always)]
    fn semi_implicit(&self, h: T, rate: &Self) -> Self {
        self.plus(h, &[1.0], [rate])
    }
}

impl<T: Scalar, const L: usize> Vector<T> for [T; L] {
    #[inline(always)]
    fn zero(&self) -> Self {
        [T::constant(0.0); L]
    }

    #[inline(always)]
    fn plus<const K: usize>(&self, h: T, weights: &[f64; K], terms: [&Self; K]) -> Self {
        let mut sum = *self;
        add(&mut sum, h, weights, terms);
        sum
    }
}

/// Adds h Σ weightₖ termₖ to `sum`.
#[inline(always)]
fn add<T: Scalar, const L: usize, const K: usize>(
    sum: &mut [T; L],
    h: T,
    weights: &[f64; K],
    terms: [&[T; L]; K],
) {
    let mut change = [T::constant(0.0); L];
    for (weight, term) in weights.iter().zip(terms) {
        let weight = T::constant(*weight);
        change.iter_mut().zip(term).for_each(|(change, term)| *change = *change + weight * *term);
    }
    sum.iter_mut().zip(&change).for_each(|(component, change)| *component = *component + h * *change);
}

/// [`add`] where the type does not tell the length.
#[inline(always)]
fn add_slices<T: Scalar, const K: usize>(sum: &mut [T], h: T, weights: &[f64; K], terms: [&[T]; K]) {
    for (index, component) in sum.iter_mut().enumerate() {
        let mut change = T::constant(0.0);
        for (weight, term) in weights.iter().zip(terms) {
            if let Some(term) = term.get(index) {
                change = change + T::constant(*weight) * *term;
            }
        }
        *component = *component + h * change;
    }
}

/// Position, velocity and first-order states of a mechanism; as a rate, the derivative of each part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorState<T, const N: usize, Z> {
    /// Coordinates q: N.
    pub q: [T; N],
    /// Velocities q̇: N, in coordinate unit per second.
    pub qd: [T; N],
    /// First-order states of the text.
    pub states: Z,
    /// Work (J) of forces and drives since the start, without gravity and all else that is potential.
    pub work: T,
}

impl<T: Scalar, const N: usize, Z: Copy + AsRef<[T]> + AsMut<[T]>> Vector<T> for IntegratorState<T, N, Z> {
    #[inline(always)]
    fn zero(&self) -> Self {
        let mut zero = *self;
        zero.states.as_mut().iter_mut().for_each(|state| *state = T::constant(0.0));
        IntegratorState { q: self.q.zero(), qd: self.qd.zero(), states: zero.states, work: T::constant(0.0) }
    }

    #[inline(always)]
    fn plus<const K: usize>(&self, h: T, weights: &[f64; K], terms: [&Self; K]) -> Self {
        let mut sum = *self;
        add(&mut sum.q, h, weights, terms.map(|term| &term.q));
        add(&mut sum.qd, h, weights, terms.map(|term| &term.qd));
        add_slices(sum.states.as_mut(), h, weights, terms.map(|term| term.states.as_ref()));
        let work = terms.map(|term| core::array::from_ref(&term.work));
        add(core::array::from_mut(&mut sum.work), h, weights, work);
        sum
    }

    #[inline(always)]
    fn semi_implicit(&self, h: T, rate: &Self) -> Self {
        let mut next = self.plus(h, &[1.0], [rate]);
        next.q = self.q.plus(h, &[1.0], [&next.qd]);
        next
    }
}

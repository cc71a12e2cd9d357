//! Points of a vector space that an integrator advances, of any parts.

use crate::scalar::number::Scalar;

/// A point that integrators add multiples of others to.
///
/// Arrays are points; so is the [`IntegratorState`] of a mechanism, whose `[T; 2 * N]` stable Rust cannot write.
pub trait Vector<T: Scalar>: Copy {
    /// The origin, of the same shape.
    fn zero(&self) -> Self;

    /// Adds `weight` times `term`.
    fn add(&mut self, weight: T, term: &Self);

    /// `weight` times `self`.
    #[inline(always)]
    fn scaled(&self, weight: T) -> Self {
        let mut scaled = self.zero();
        scaled.add(weight, self);
        scaled
    }

    /// `self` + h Σ weightₖ termₖ. The sum is formed first, so that a small change keeps its digits.
    #[inline(always)]
    fn plus<const K: usize>(&self, h: T, weights: &[f64; K], terms: [&Self; K]) -> Self {
        let mut all = weights.iter().zip(&terms);
        let mut change = match all.next() {
            Some((weight, term)) => term.scaled(T::constant(*weight)),
            None => self.zero(),
        };
        for (weight, term) in all {
            change.add(T::constant(*weight), term);
        }
        let mut sum = *self;
        sum.add(h, &change);
        sum
    }

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
    fn add(&mut self, weight: T, term: &Self) {
        add(self, weight, term);
    }

    #[inline(always)]
    fn scaled(&self, weight: T) -> Self {
        let mut scaled = *self;
        scaled.iter_mut().for_each(|term| *term = weight * *term);
        scaled
    }
}

/// Adds `weight` times `term` to `sum`.
#[inline(always)]
fn add<T: Scalar>(sum: &mut [T], weight: T, term: &[T]) {
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum = *sum + weight * *term;
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
    fn add(&mut self, weight: T, term: &Self) {
        add(&mut self.q, weight, &term.q);
        add(&mut self.qd, weight, &term.qd);
        add(self.states.as_mut(), weight, term.states.as_ref());
        self.work = self.work + weight * term.work;
    }

    #[inline(always)]
    fn scaled(&self, weight: T) -> Self {
        let mut states = self.states;
        states.as_mut().iter_mut().for_each(|term| *term = weight * *term);
        IntegratorState {
            q: self.q.scaled(weight),
            qd: self.qd.scaled(weight),
            states,
            work: weight * self.work,
        }
    }

    #[inline(always)]
    fn semi_implicit(&self, h: T, rate: &Self) -> Self {
        let mut next = self.plus(h, &[1.0], [rate]);
        next.q = self.q.plus(h, &[1.0], [&next.qd]);
        next
    }
}

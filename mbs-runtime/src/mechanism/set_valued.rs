//! Set-valued forces: rows of frictions that stick and of rigid contacts, and the mode of each.

use crate::scalar::number::Scalar;

/// Mode of a friction with stiction or of a rigid contact: constant within a step, changed at events between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetValuedMode<T> {
    /// Direction in which it slides: 1, −1, or 0 where it sticks. Of a contact, and of a friction on it, 1 where the contact is open. 0 where
    /// a contact is closed.
    pub direction: T,
    /// Force (N) along the length with which it sticks, or of the closed contact; 0 while equations are solved for it, and where it
    /// slides or is open.
    pub force: T,
    /// The length (m) at which it sticks; 0 of a contact, and below it the gap in which [`MoreauJean`](crate::dynamics::MoreauJean) has left it.
    pub place: T,
    /// Time (s) since which a contact is closed, with the time that its last, infinitely many bounces take together. Of others without meaning.
    pub since: T,
    /// Impulse (N s) of the last impact of a contact, of several at one time their sum: 0 before the first one, and of others.
    pub impulse: T,
}

impl<T: Scalar> SetValuedMode<T> {
    /// Neither slides nor holds: before anything is known of the motion.
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        SetValuedMode { direction: zero, force: zero, place: zero, since: zero, impulse: zero }
    }
}

impl<T: Scalar> Default for SetValuedMode<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The length s of a friction with stiction, or the gap s of a rigid contact, in one state: s̈ = J q̈ − γ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetValuedRow<T, const N: usize> {
    /// s (m).
    pub place: T,
    /// ṡ (m/s).
    pub rate: T,
    /// J = ∂s/∂q: N.
    pub gradient: [T; N],
    /// γ (m/s²).
    pub gamma: T,
    /// Largest force (N) with which it sticks; 0 of a contact, whose force is any that pushes, and of a friction on one, where it is
    /// [`OnContact::sticking`] times that force.
    pub limit: T,
    /// Coefficient of restitution e of a contact, 0 ≤ e ≤ 1; `None` of a friction.
    pub restitution: Option<T>,
    /// `true` for a contact that strikes by itself, one after the other with those that close at the same time.
    pub ordered: bool,
    /// The rigid contact whose force is the normal force of a friction.
    pub on: Option<OnContact<T>>,
}

/// Friction on a rigid contact with the force N: −σ μ N along s where it slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnContact<T> {
    /// Index of the contact among the rows.
    pub contact: usize,
    /// Coefficient μ of impacts.
    pub coefficient: T,
    /// Coefficient μ at the present speed.
    pub sliding: T,
    /// Coefficient μₛ ≥ μ with which it sticks.
    pub sticking: T,
}

impl<T: Scalar, const N: usize> SetValuedRow<T, N> {
    /// Every entry 0.
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        SetValuedRow {
            place: zero,
            rate: zero,
            gradient: [zero; N],
            gamma: zero,
            limit: zero,
            restitution: None,
            ordered: false,
            on: None,
        }
    }
}

impl<T: Scalar, const N: usize> Default for SetValuedRow<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A function of the rows of all frictions with stiction and rigid contacts, whatever their number.
pub trait WithSetValuedRows<T, const N: usize> {
    /// Its result.
    type Output;
    /// Its value.
    fn at<const K: usize>(self, rows: &[SetValuedRow<T, N>; K]) -> Self::Output;
}

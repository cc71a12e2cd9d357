//! Steps where contacts close or open: ended there, in parts that grow with the root of the time, or as if nothing were there.

use crate::dynamics::model::method::Method;
use crate::dynamics::simulation::Simulation;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::{Dynamic, Gap};
use crate::scalar::number::Real;

/// Parts that contacts may cut a step of fixed size into.
const MOST_PARTS: u32 = 8;

/// Parts that a graded step is taken in at most: one of √τ at ten steps a span has four, in each of several contacts.
const MOST_GRADED_PARTS: u32 = 64;

/// Steps where contacts close or open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ContactSteps<R> {
    /// They end there.
    Located,
    /// They end there; those of fixed size are taken in parts up to this time (s) beside it.
    Graded(R),
    /// They go over it.
    Unlocated,
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Takes steps of fixed size in parts of equal length in √τ, up to a time τ of `span` (s) beside a touch or a lift-off.
    ///
    /// The force K pⁿ of a contact with a fractional n is not smooth where the contact closes or opens: with n = 1.5 its fourth
    /// derivative grows as τ^−2.5. So errors of equal steps h fall as h^2.5, whatever the order of the method and however
    /// exact the touch is located. A part here is h (2√(τ/T) + h/T) long, at most h, with T = `span`. This mesh is equal in √τ and keeps
    /// order 4. τ is the depth over its rate. T stays as it is where h is halved; a contact's duration is a good one. A larger T makes
    /// parts shorter, as its root: a step next to a touch is taken in about √(T/h) of them. Texts without contacts go on as without.
    ///
    /// Source: Brunner 1985, Math. Comp. 45, 417 (graded meshes).
    ///
    /// # Errors
    /// [`FailureKind::InvalidMethodParameter`] for a `span` that is not positive and finite.
    pub fn with_graded_steps(self, span: R) -> Result<Self, Failure> {
        if R::constant(0.0) < span && span.is_finite() {
            return Ok(Simulation { contact_steps: ContactSteps::Graded(span), ..self });
        }
        let (name, value) = ("span of graded steps", span.to_f64());
        Err(FailureKind::InvalidMethodParameter { name, value, most: f64::INFINITY }.without_time())
    }

    /// Lets steps go over touches and lift-offs of contacts, as over any other change of a force.
    ///
    /// Only the error estimate of an adaptive run makes steps short there. It costs no search, but order and certainty: a contact that is
    /// shorter than a step may be missed. It suits forces K pⁿ with n above 1 whose contacts last for several steps, as
    /// [`with_largest_step`](Self::with_largest_step) can ensure.
    pub fn without_located_contacts(self) -> Self {
        Simulation { contact_steps: ContactSteps::Unlocated, ..self }
    }

    /// Number of parts that a step of fixed size is taken in at most.
    pub(super) fn most_parts(&self) -> u32 {
        let parts = if matches!(self.contact_steps, ContactSteps::Graded(_)) {
            MOST_GRADED_PARTS
        } else {
            MOST_PARTS
        };
        parts.max(Self::most_slips())
    }

    /// Length (s) of the next part of a step of `whole` (s) of which `rest` (s) is left.
    pub(super) fn part_of(&self, whole: R, rest: R) -> R {
        let (zero, one, two) = (R::constant(0.0), R::constant(1.0), R::constant(2.0));
        // A step that is none is refused as it was asked for.
        let ContactSteps::Graded(span) = self.contact_steps else { return rest };
        if rest <= zero || !rest.is_finite() {
            return rest;
        }
        // One part of the span is no less than the span.
        let first = (whole / span).min(one);
        let mut share = one;
        self.model().gaps(self.now.t, (self.now.t, &self.now.y), |Gap { gap, rate, .. }| {
            if gap < zero {
                let near = (-gap / (rate.abs() * span)).sqrt();
                // Towards the opening the part ends nearer to it than it begins.
                let step = if zero < rate { (two * near - first).max(first) } else { two * near + first };
                // A depth that rests is far from both: not a number, or infinite.
                share = share.min(if step < one { step } else { one });
            }
        });
        let length = whole * share;
        // No sliver is left over.
        if rest < R::constant(1.25) * length { rest } else { length }
    }
}

//! Angles declared as `turn`: coordinates whose whole turns are kept apart, inputs that change the short way round.

use std::borrow::Cow;

use crate::syntax::ast::{Name, Type, Unit};

/// Before: the type of a coordinate or an input as written. After: its type, an angle if it is declared as `turn`, and `true` if
/// it is.
pub(super) fn turning(kind: &Type) -> (Cow<'_, Type>, bool) {
    if kind.unit.text != "turn" {
        return (Cow::Borrowed(kind), false);
    }
    let span = kind.unit.span;
    let radian = Name { text: "rad".into(), span };
    let unit = Unit { factors: vec![(radian, 1.0)], text: "rad".into(), span };
    (Cow::Owned(Type { unit, shape: kind.shape.clone() }), true)
}

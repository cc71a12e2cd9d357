//! Types of declarations: units and lengths of arrays, and names of components.

use super::counts::LONGEST;
use super::declarations::Declarations;
use super::expression::Id;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Scalar, Value};
use crate::syntax::ast::{Name, Type};

/// A type that was declared.
pub struct DeclaredType {
    pub dimension: Dimension,
    /// `Bare::Angle` if its values are angles.
    pub bare: Bare,
    pub shape: Vec<usize>,
    pub size: usize,
    /// Reported; the rest is a guess.
    pub faulty: bool,
}

impl Declarations<'_> {
    /// Before: a type as written. After: its dimension and lengths; a faulty part is reported and replaced by an
    /// array of one component, a number.
    pub(super) fn declared(&mut self, kind: &Type) -> DeclaredType {
        let dimension = Dimension::of(&kind.unit, self.diagnostics);
        let shape = self.elaborate(|work| {
            kind.shape
                .iter()
                .map(|length| {
                    let value = work.value(length)?;
                    match work.count(&value)? {
                        0 => Err(work.fault(
                            value.span,
                            "an array needs at least one component",
                            "write a positive length",
                        )),
                        length => Ok(length),
                    }
                })
                .collect::<Result<Vec<_>, Fault>>()
        });
        let sized = shape.ok().and_then(|shape| {
            let size = shape.iter().try_fold(1_usize, |size, length| size.checked_mul(*length));
            let size = size.filter(|size| *size <= LONGEST);
            if size.is_none() {
                let message = format!("the array has more than {LONGEST} components");
                self.diagnostics.report(kind.unit.span, message, "split it");
            }
            Some((shape, size?))
        });
        let faulty = dimension.is_none() || sized.is_none();
        let (shape, size) = sized.unwrap_or_else(|| (vec![1; kind.shape.len()], 1));
        DeclaredType {
            dimension: dimension.unwrap_or_default(),
            bare: Bare::of(&kind.unit),
            shape,
            size,
            faulty,
        }
    }

    /// Gives the name its value; a faulty declaration's uses are not reported.
    pub(super) fn define(&mut self, name: &Name, declared: &DeclaredType, ids: Vec<Id>) {
        let bare = declared.bare;
        if declared.faulty {
            return self.names.give_up(&name.text);
        }
        let quantity = Quantity::Known(declared.dimension);
        let items = ids.into_iter().map(|id| Scalar { id, quantity, bare, span: name.span }).collect();
        self.names.define(&name.text, Value { shape: declared.shape.clone(), items, span: name.span });
    }
}

/// `p`, or `p.0`, `p.1`, …, or `p.0.0`, … for the components of an array.
pub fn component_names<'a>(name: &'a str, shape: &'a [usize]) -> impl Iterator<Item = String> + 'a {
    (0..shape.iter().product()).map(move |flat| {
        let mut suffix = String::new();
        let mut rest = flat;
        for length in shape.iter().rev() {
            suffix = format!(".{}{suffix}", rest % length.max(&1));
            rest /= length.max(&1);
        }
        format!("{name}{suffix}")
    })
}

//! Constraints and branches: equations → rows of Φ, conditions → expressions that are positive.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::resolve::behind_loop;
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Reach, Scalar};
use super::written::operands;
use super::{Branch, ConstraintRow};
use crate::symbolic::Binary;
use crate::syntax::ast::{Equation, Expression, Instruction, Item, Name, Operation};

impl Resolver<'_> {
    /// Rows of a constraint, its loops unrolled.
    pub(super) fn constraint(&mut self, name: &Name, items: &[Item]) -> Result<(), Fault> {
        self.constraint_rows((name, "constraint"), items)
    }

    /// Rows of a group of this kind.
    pub(super) fn constraint_rows(
        &mut self,
        (name, kind): (&Name, &'static str),
        items: &[Item],
    ) -> Result<(), Fault> {
        let group = self.group(name, kind)?;
        let outer = self.loops.len();
        let mut next = 0;
        while let Some(item) = items.get(next) {
            next += 1;
            match item {
                Item::For(head) => {
                    let is_end = |item: &Item| matches!(item, Item::EndFor);
                    let is_for = |item: &Item| matches!(item, Item::For(_));
                    next = self.enter(head, next).unwrap_or_else(|| behind_loop(items, next, is_for, is_end));
                }
                Item::EndFor if self.loops.len() > outer => next = self.repeat().unwrap_or(next),
                Item::EndFor => {}
                Item::On { point, curve, span } => {
                    if self.on_curve(point, curve, *span, group).is_err() {
                        self.names.mark_faulty_rows(&name.text);
                    }
                }
                Item::Equation(equation) => {
                    if self.equation(equation, group).is_err() {
                        self.names.mark_faulty_rows(&name.text);
                    }
                }
            }
            if self.too_large() {
                return Err(Fault);
            }
        }
        Ok(())
    }

    /// Adds one row a component.
    pub(super) fn equation(&mut self, equation: &Equation, group: usize) -> Result<(), Fault> {
        let (left, right) = self.elaborate(Reach::Position, |work| {
            let (left, right) = (work.value(&equation.left), work.value(&equation.right));
            Ok::<_, Fault>((left?, right?))
        })?;
        let span = equation.span;
        // `x == 0` holds for every component of a vector x.
        let right = right.spread_zero(&left);
        let left = left.spread_zero(&right);
        let residuals = self.elaborate(Reach::Position, |work| {
            let (of_left, of_right) = (&equation.left.code, &equation.right.code);
            work.beside_angle((&left, of_left), of_right)?;
            work.beside_angle((&right, of_right), of_left)?;
            work.same_shape(&left, &right, "`==`", right.span)?;
            let pairs = left.items.iter().zip(&right.items).enumerate();
            let residuals = pairs.map(|(component, (a, b))| {
                let known = work.names.unit_faults.len();
                let residual = residual(work, *a, *b, span);
                if residual.is_err() {
                    let sides = [of_right, of_left].map(|side| component_of(side, component));
                    work.concern(known, Place::Sides, sides[0], sides[1]);
                }
                residual
            });
            residuals.collect::<Result<Vec<_>, Fault>>()
        })?;
        for (residual, dimension) in residuals {
            let reversed = self.is_reversed(residual);
            let (name, driven, redundant) = (String::new(), false, false);
            let row =
                ConstraintRow { name, dimension, residual, driven, reversed, redundant, within: None, span };
            self.push_row(group, row);
        }
        Ok(())
    }

    pub(super) fn branch(
        &mut self,
        name: &Name,
        at_start: bool,
        larger: &Expression,
        smaller: &Expression,
    ) -> Result<(), Fault> {
        let group = self.group(name, "branch")?;
        let (sides, written) = ((smaller, Some(larger)), larger);
        let (value, dimension) = self.elaborate(Reach::Position, |work| {
            let (larger, smaller) = (work.value(larger), work.value(smaller));
            let (larger, smaller) = (larger?, smaller?);
            work.beside_angle((&larger, &written.code), &sides.0.code)?;
            work.beside_angle((&smaller, &sides.0.code), &written.code)?;
            let a = work.scalar(&larger, "a branch", larger.span)?;
            let b = work.scalar(&smaller, "a branch", smaller.span)?;
            work.concerning(Place::Sides, sides, |work| residual(work, a, b, name.span))
        })?;
        self.count_row(group, self.model.branches.len());
        self.model.branches.push(Branch {
            name: name.text.clone(),
            dimension,
            at_start,
            value,
            span: name.span,
        });
        Ok(())
    }
}

fn residual(work: &mut Elaborator<'_>, a: Scalar, b: Scalar, span: Span) -> Result<(Id, Dimension), Fault> {
    let quantity = work.agree(a, b)?;
    let id = if work.expressions.node(b.id) == Node::Number(0.0) {
        a.id
    } else {
        work.push_binary(Binary::Subtract, a.id, b.id, span)?
    };
    Ok((id, quantity.dimension()))
}

/// The component of a vector that is written out; of any other expression the whole.
fn component_of(side: &[Instruction], component: usize) -> &[Instruction] {
    match side.split_last() {
        Some((Instruction { operation: Operation::Array { length }, .. }, parts)) => {
            operands(parts, parts.len(), *length)
                .and_then(|parts| parts.get(component).copied())
                .unwrap_or(side)
        }
        _ => side,
    }
}

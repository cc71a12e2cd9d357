//! Rows of a text, equation by equation.

use mbs_codegen::syntax_tree::{Item, StatementKind};

use super::evaluation::{Gap, Names, Scope, value};
use super::functions::dot;
use super::number::Number;
use super::tree::{Placed, equations};
use super::{Oracle, orientation, prescribed, residual};

/// Name of a constraint, indices of its rows, their values, and whether a drive gives them.
type See<'a> = &'a mut dyn FnMut(&str, core::ops::Range<usize>, &[(Number, bool)]);

impl Oracle {
    /// Shows `see` the rows of each equation: its constraint, their indices, their values.
    pub(super) fn each_row(&self, names: &Names, see: See<'_>) -> Result<(), Gap> {
        self.each_row_of(false, names, see)
    }

    /// Before: `gone` is `true`. After: the same of the constraints that effects release, and of no other rows.
    pub(super) fn each_row_of(&self, gone: bool, names: &Names, see: See<'_>) -> Result<(), Gap> {
        let mut count = 0;
        let mut show = |group: &str, found: Vec<(Number, bool)>| {
            see(group, count..count + found.len(), &found);
            count += found.len();
        };
        for (index, placed) in self.placed.iter().enumerate() {
            let Placed { kind, rounds } = placed;
            match kind {
                StatementKind::Element { name, .. } if !gone && self.turning.contains(&index) => {
                    let e = orientation(placed, names)?.unwrap_or_default();
                    let square = dot(&e, &e) - Number::still(1.0);
                    show(&name.text, vec![(square, true)]);
                }
                StatementKind::Constraint { name, items, released, .. } if *released == gone => {
                    let mut rounds = rounds.clone();
                    equations(items, names, &mut rounds, &mut |item, rounds| {
                        if let Item::Equation(equation) = item {
                            let found = residual(equation, &Scope::of(names, rounds))?;
                            show(&name.text, found.items.into_iter().map(|number| (number, true)).collect());
                        }
                        if let Item::On { point, curve, .. } = item {
                            let scope = Scope::of(names, rounds);
                            // A row that is left out would be one that always holds.
                            let found = scope.curve(&curve.text).and_then(|index| names.curves.get(index));
                            let found = found.ok_or_else(|| Gap(format!("the curve `{}`", curve.text)))?;
                            let row = found.row(&value(point, &scope)?, &scope)?;
                            show(&name.text, vec![(row, true)]);
                        }
                        Ok(())
                    })?;
                }
                StatementKind::Drive { name, equation } if !gone => {
                    let scope = Scope::of(names, rounds);
                    let found = match prescribed(equation) {
                        None => {
                            let found = residual(equation, &scope)?;
                            found.items.into_iter().map(|number| (number, true)).collect()
                        }
                        Some(driven) => {
                            let driven = value(&driven, &scope)?.number()?;
                            let asked = value(&equation.right, &scope)?.number()?;
                            // The rate is known, the phase itself is not.
                            vec![(Number { rate: driven.rate - asked.value, ..driven }, false)]
                        }
                    };
                    show(&name.text, found);
                }
                _ => {}
            }
        }
        Ok(())
    }
}

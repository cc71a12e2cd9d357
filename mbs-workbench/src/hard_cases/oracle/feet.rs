//! Feet on curves with their bounds, found by the statements that a foot stands for.

use std::rc::Rc;

use mbs_codegen::syntax_tree::{Expression, Operation, StatementKind};

use super::evaluation::{Gap, Scope, value};
use super::state::OracleState;
use super::tree::Placed;
use super::{Along, Jet, Oracle};

/// A foot on a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Name of its place.
    pub name: String,
    /// The curve.
    pub curve: Outline,
    /// Follower that touches the curve there.
    pub follower: Follower,
}

/// A curve by its functions.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// Its polar radius, or both components: functions of the caller, `pitch` or `rim[0]`.
    pub functions: Vec<String>,
}

/// Follower of a foot.
#[derive(Clone, Debug, PartialEq)]
pub enum Follower {
    /// A point, or the centre of a circle, which is no farther from the curve than `bound` (m). `lowest` is the least gap (m) that
    /// a limit of the text allows.
    Point {
        /// Bound behind `within`.
        bound: f64,
        /// Lower bound of the gap.
        lowest: f64,
    },
    /// A flat face.
    Flat,
    /// Another curve, within `bound` (m).
    Curve {
        /// The other curve.
        other: Outline,
        /// Bound behind `within`.
        bound: f64,
    },
}

impl Oracle {
    /// Feet of a text in a scene (`None`: all effects), with values of its parameters and inputs by component. Functions of the caller are
    /// not called.
    ///
    /// # Errors
    /// The part of the text that cannot be read.
    pub fn feet(
        source: &str,
        scene: Option<&str>,
        known: &dyn Fn(&str) -> Option<f64>,
    ) -> Result<Vec<Foot>, Gap> {
        let none = |_: &str| Some(Rc::new(|_: f64| Vec::new()) as Jet);
        Oracle::of_names(source, scene, known, &none)?.feet_of_names()
    }

    fn feet_of_names(&self) -> Result<Vec<Foot>, Gap> {
        let state = OracleState { q: vec![0.0; self.size()], ..OracleState::default() };
        let names = self.names(&state, Along::Nothing);
        let mut feet = Vec::new();
        for limit in self.placed.iter() {
            let StatementKind::Limit { name, second, third: None, .. } = &limit.kind else { continue };
            let Some(name) = name.text.strip_suffix("_reach") else { continue };
            let scope = Scope::of(&names, &limit.rounds);
            let bound = || value(second, &scope)?.number().map(|number| number.value.v);
            let beside = Beside { placed: &self.placed, limit };
            let Some(curve) = beside.curve(name) else { continue };
            let curve = self.outline(curve, &scope)?;
            let follower = match beside.other_place(name) {
                Some(other) => Follower::Curve { other: self.outline(other, &scope)?, bound: bound()? },
                None if beside.is_flat(name) => Follower::Flat,
                None => {
                    let mut lowest = f64::NEG_INFINITY;
                    for bound in beside.lower_bounds(&format!("{name}_gap")) {
                        lowest = lowest.max(value(bound, &scope)?.number()?.value.v);
                    }
                    Follower::Point { bound: bound()?, lowest }
                }
            };
            feet.push(Foot { name: name.to_string(), curve, follower });
        }
        Ok(feet)
    }

    fn outline(&self, name: &str, scope: &Scope<'_>) -> Result<Outline, Gap> {
        let unknown = || Gap(format!("the curve `{name}`"));
        let curve = scope.curve(name).and_then(|index| self.curves.get(index)).ok_or_else(unknown)?;
        Ok(Outline { name: name.to_string(), functions: curve.labels(scope)? })
    }
}

/// Statements in the same rounds of loops as a limit.
struct Beside<'a> {
    placed: &'a [Placed],
    limit: &'a Placed,
}

impl<'a> Beside<'a> {
    fn statements(&self) -> impl Iterator<Item = &'a StatementKind> {
        let rounds = &self.limit.rounds;
        self.placed.iter().filter(move |placed| placed.rounds == *rounds).map(|placed| &placed.kind)
    }

    fn definition(&self, wanted: &str) -> Option<&'a Expression> {
        self.statements().find_map(|statement| match statement {
            StatementKind::Let { name, value, .. } if name.text == wanted => Some(value),
            _ => None,
        })
    }

    /// The curve that `w` is a place on: `let w_place = place(w, cam);`.
    fn curve(&self, w: &str) -> Option<&'a str> {
        let [.., curve, call] = self.definition(&format!("{w}_place"))?.code.as_slice() else { return None };
        match (&curve.operation, &call.operation) {
            (Operation::Name(curve), Operation::Call { function, .. }) if function == "place" => Some(curve),
            _ => None,
        }
    }

    /// The other curve of a pair, whose foot has two rows.
    fn other_place(&self, w: &str) -> Option<&'a str> {
        let foot = format!("{w}_foot");
        self.statements().find_map(|statement| match statement {
            StatementKind::Constraint { name, items, .. } if name.text == foot && items.len() == 2 => {
                Some(())
            }
            _ => None,
        })?;
        let Operation::Name(place) = &self.definition(&format!("{w}_from"))?.code.first()?.operation else {
            return None;
        };
        self.curve(place.strip_suffix("_place")?)
    }

    /// `true` of a face whose normal has a direction of its own: `let w_normal = unit(alpha);`.
    fn is_flat(&self, w: &str) -> bool {
        let last = self.definition(&format!("{w}_normal")).and_then(|normal| normal.code.last());
        matches!(last.map(|last| &last.operation), Some(Operation::Call { function, .. }) if function == "unit")
    }

    /// Lower bounds of limits whose value is this name alone.
    fn lower_bounds(&self, wanted: &str) -> impl Iterator<Item = &'a Expression> {
        self.statements().filter_map(move |statement| {
            let StatementKind::Limit { first, second, .. } = statement else { return None };
            match second.code.as_slice() {
                [only] if matches!(&only.operation, Operation::Name(name) if name == wanted) => Some(first),
                _ => None,
            }
        })
    }
}

//! Names of the text and their meaning; words that the language keeps for itself.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Span;

use super::forces_by_name::Seen;
use super::unit_faults::UnitFault;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::uses::{Undeclared, Uses};
use super::value::{Reach, Value};
use crate::diagnostics::Diagnostics;
use crate::symbolic::Unary;
use crate::syntax::ast::{Declares, Name, Statement, StatementKind};
use crate::syntax::rust_identifiers::UNUSABLE;

/// Names with a meaning of their own.
pub const RESERVED: [&str; 13] = [
    "t", "PI", "TAU", "der", "der2", "rate", "lambda", "effort", "reaction", "margin", "ratio", "joint",
    "curve",
];

/// Functions of the language with several arguments, with vectors or with rates.
const OTHER_FUNCTIONS: [&str; 15] = [
    "atan2",
    "min",
    "max",
    "hypot",
    "sum",
    "dot",
    "cross",
    "norm",
    "det",
    "rot",
    "unit",
    "rotate",
    "angular_velocity",
    "der",
    "der2",
];

/// Functions of a point and a curve, and of an angle and a curve.
pub const OF_CURVES: [&str; 3] = ["distance", "outward", "place"];

/// The function of partial derivatives.
pub const PARTIAL: &str = "d";

/// Names of all functions: those of one argument from the table of operations, then the others.
pub fn functions<'a>() -> impl Iterator<Item = &'a str> {
    kept().chain(OF_CURVES).chain([PARTIAL])
}

/// Names of functions that nothing else can have. Others take two arguments, as no function of the caller does, so that these and
/// values may have their names.
fn kept<'a>() -> impl Iterator<Item = &'a str> {
    Unary::called().map(|function| -> &'a str { function.entry().name }).chain(OTHER_FUNCTIONS)
}

/// `true` if `name` is that of a function of the language, and of nothing else.
pub fn is_function(name: &str) -> bool {
    kept().any(|function| function == name)
}

/// `true` if a call of `name` with so many arguments is one of a function of the language that shares its name.
pub fn is_of_two(name: &str, arguments: usize) -> bool {
    arguments == 2 && (name == PARTIAL || OF_CURVES.contains(&name))
}

/// Names that have a value without a declaration.
pub(super) const CONSTANTS: [&str; 3] = ["t", "PI", "TAU"];

/// A declared function as expressions see it.
#[derive(Clone, Copy, Debug)]
pub struct Callable {
    /// Index among the functions of the text, of the first one of an array.
    pub(super) index: usize,
    /// Number of functions, where it is an array.
    pub(super) length: Option<usize>,
    /// Unit of the value.
    pub(super) unit: Dimension,
    /// Unit of the argument.
    pub(super) argument: Dimension,
    /// `Bare::Angle` if its values are angles.
    pub(super) bare: Bare,
}

/// A curve by its polar radius, or by two components over a parameter.
#[derive(Clone, Debug)]
pub struct Curve {
    pub(super) form: CurveForm,
    pub(super) centre: Value,
    /// Angle by which it is turned.
    pub(super) turned: Value,
}

/// Functions of a curve with their names.
#[derive(Clone, Debug)]
pub enum CurveForm {
    /// The polar radius.
    Polar((Callable, String)),
    /// Both components in the axes of the curve.
    Parametric([(Callable, String); 2]),
}

/// Meaning of a name.
#[derive(Clone, Debug)]
pub enum Symbol {
    /// A value: constants, parameters, inputs, coordinates, and `let`s once they are elaborated.
    Value(Value),
    /// A declared function.
    Function(Callable),
    /// A declared curve.
    Curve(Box<Curve>),
    /// A count of a loop or a sum.
    Count(usize),
    /// Declared, but not usable here yet.
    Pending,
    /// A `let` of forces by their names, which are not known yet.
    Later,
    /// Declared with a fault that was reported.
    Faulty,
}

/// Rows of a constraint or drive.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Indices in Φ, and the dimension of each.
    pub rows: Vec<(usize, Dimension)>,
    /// `true` if a `drive` declares them.
    pub driven: bool,
    /// `true` if an effect of the scene releases them: none is there, and their indices mean nothing.
    pub released: bool,
}

/// A pin by its index, and the names of its bodies.
#[derive(Clone, Debug)]
pub struct Joint {
    pub pin: usize,
    pub bodies: [String; 2],
}

/// Names that effects declare which the scene does not select, with these effects.
#[derive(Clone, Debug, Default)]
pub struct Elsewhere {
    /// Values.
    pub values: BTreeMap<String, String>,
    /// Bodies, forces and pins.
    pub loads: BTreeMap<String, String>,
}

/// Names of values, with the scopes of loops and sums; names of rows and pins apart.
#[derive(Clone, Debug, Default)]
pub struct Names {
    declared: BTreeMap<String, (Symbol, Span)>,
    scoped: Vec<(String, Symbol)>,
    /// Names that a loop somewhere in the text declares for itself.
    local: BTreeSet<String>,
    rows: BTreeMap<String, Rows>,
    pins: BTreeMap<String, Vec<Joint>>,
    /// Forces that expressions may refer to.
    pub seen: Seen,
    /// Quantities that a `let` uses, where these are more than positions.
    needs: BTreeMap<String, Reach>,
    /// Names that effects declare which the scene does not select, with these effects.
    pub elsewhere: Elsewhere,
    /// Uses of all names in the text.
    pub uses: Uses,
    /// Names that are declared nowhere, as they were reported.
    pub undeclared: Vec<Undeclared>,
    /// Units that do not fit, as they were reported.
    pub unit_faults: Vec<UnitFault>,
    /// Bodies and elements with a fault that was reported.
    faulty_elements: BTreeSet<String>,
    /// Constraints and drives some of whose rows have a fault that was reported.
    faulty_rows: BTreeSet<String>,
    /// `true` if the rate of some state has a fault that was reported.
    pub faulty_rate: bool,
    /// `true` if the text has masses or forces, so that its rows have multipliers.
    pub dynamic: bool,
}

impl Names {
    /// Before: a declaration. After: the name is known, as faulty where it is taken; a clash is reported and the
    /// first declaration kept.
    pub fn declare(&mut self, name: &Name, diagnostics: &mut Diagnostics) {
        if let Some((_, first)) = self.declared.get(&name.text) {
            return report_double(name, *first, diagnostics);
        }
        let symbol = if usable(name, diagnostics) { Symbol::Pending } else { Symbol::Faulty };
        if !UNUSABLE.contains(&name.text.as_str()) {
            self.declared.insert(name.text.clone(), (symbol, name.span));
        }
    }

    /// `true` if a loop, a sum or a `let` in a loop may use this name; otherwise the clash is reported.
    pub fn is_free(&self, name: &Name, diagnostics: &mut Diagnostics) -> bool {
        if !usable(name, diagnostics) {
            return false;
        }
        if let Some((_, first)) = self.declared.get(&name.text) {
            report_double(name, *first, diagnostics);
            return false;
        }
        let free = self.scoped.iter().all(|(known, _)| *known != name.text);
        if !free {
            diagnostics.report(
                name.span,
                format!("`{}` has a meaning in this loop already", name.text),
                "choose another name",
            );
        }
        free
    }

    /// Notes that a loop declares the name for itself.
    pub fn declare_in_loop(&mut self, name: &Name) {
        self.local.insert(name.text.clone());
    }

    /// `true` if some loop declares the name for itself.
    pub fn is_local(&self, name: &str) -> bool {
        self.local.contains(name)
    }

    /// Gives a declared name its value.
    pub fn define(&mut self, name: &str, value: Value) {
        if let Some((symbol @ Symbol::Pending, _)) = self.declared.get_mut(name) {
            *symbol = Symbol::Value(value);
        }
    }

    /// Gives a declared name its function.
    pub fn define_function(&mut self, name: &str, callable: Callable) {
        if let Some((symbol @ Symbol::Pending, _)) = self.declared.get_mut(name) {
            *symbol = Symbol::Function(callable);
        }
    }

    /// Gives a declared name its curve.
    pub fn define_curve(&mut self, name: &str, curve: Curve) {
        if let Some((symbol @ Symbol::Pending, _)) = self.declared.get_mut(name) {
            *symbol = Symbol::Curve(Box::new(curve));
        }
    }

    /// All curves.
    pub fn curves(&self) -> impl Iterator<Item = &str> {
        let is_curve = |symbol: &Symbol| matches!(symbol, Symbol::Curve(_));
        self.declared.iter().filter(move |(_, (symbol, _))| is_curve(symbol)).map(|(name, _)| name.as_str())
    }

    /// Marks a declared name that got no value, so that its uses are not reported too.
    pub fn give_up(&mut self, name: &str) {
        if let Some((symbol @ Symbol::Pending, _)) = self.declared.get_mut(name) {
            *symbol = Symbol::Faulty;
        }
    }

    /// The effect that declares a name and is not selected.
    pub fn effect_of(&self, name: &str) -> Option<&str> {
        self.elsewhere.values.get(name).map(String::as_str)
    }

    /// The effect that declares a body or a force and is not selected.
    pub fn effect_of_load(&self, name: &str) -> Option<&str> {
        self.elsewhere.loads.get(name).map(String::as_str)
    }

    /// Marks a declared name whose value is known among the forces alone.
    pub fn postpone(&mut self, name: &str) {
        if let Some((symbol @ Symbol::Pending, _)) = self.declared.get_mut(name) {
            *symbol = Symbol::Later;
        }
    }

    /// Gives a name of [`Names::postpone`] its meaning.
    pub fn settle(&mut self, name: &str, meaning: Symbol) {
        if let Some((symbol @ Symbol::Later, _)) = self.declared.get_mut(name) {
            *symbol = meaning;
        }
    }

    /// Notes bodies and elements that could not be read.
    pub fn note_faulty(&mut self, statements: &[Statement]) {
        for statement in statements {
            let StatementKind::Faulty { name, declares, .. } = &statement.kind else { continue };
            match declares {
                Declares::Element => self.mark_faulty_element(&name.text),
                Declares::Rows => self.mark_faulty_rows(&name.text),
                Declares::Rate => self.faulty_rate = true,
                _ => {}
            }
        }
    }

    /// Notes a body or an element with a fault that was reported.
    pub fn mark_faulty_element(&mut self, name: &str) {
        self.faulty_elements.insert(name.to_owned());
    }

    /// Notes a constraint or drive with a row whose fault was reported.
    pub fn mark_faulty_rows(&mut self, name: &str) {
        self.faulty_rows.insert(name.to_owned());
    }

    /// `true` if a row of this constraint or drive had a fault.
    pub fn has_faulty_rows(&self, name: &str) -> bool {
        self.faulty_rows.contains(name)
    }

    /// `true` if no body or element had a fault.
    pub fn elements_are_sound(&self) -> bool {
        self.faulty_elements.is_empty()
    }

    /// `true` if a body or element of this name, or one of its rounds, had a fault.
    pub fn is_faulty_element(&self, name: &str) -> bool {
        let base = name.split('.').next().unwrap_or(name);
        self.faulty_elements.contains(base)
    }

    /// Marks a name that is declared nowhere and was reported, so that its other uses are not reported too.
    pub fn report_once(&mut self, name: &str, span: Span) {
        self.declared.entry(name.to_owned()).or_insert((Symbol::Faulty, span));
    }

    /// Meaning of the name in the innermost scope.
    pub fn get(&self, name: &str) -> Option<&Symbol> {
        let scoped = self.scoped.iter().rev().find(|(known, _)| known == name).map(|(_, symbol)| symbol);
        scoped.or_else(|| self.declared.get(name).map(|(symbol, _)| symbol))
    }

    /// `true` for a name of a loop that is being unrolled.
    pub fn is_scoped(&self, name: &str) -> bool {
        self.scoped.iter().any(|(known, _)| known == name)
    }

    /// Notes the quantities that the value of a `let` uses.
    pub fn define_needs(&mut self, name: &str, needs: Reach) {
        self.needs.insert(name.to_owned(), needs);
    }

    /// Quantities that must be allowed where this name is used.
    pub fn needs(&self, name: &str) -> Reach {
        self.needs.get(name).copied().unwrap_or(Reach::Position)
    }

    /// All declared functions.
    pub fn functions(&self) -> impl Iterator<Item = &str> {
        let is_function = |symbol: &Symbol| matches!(symbol, Symbol::Function(_));
        self.declared
            .iter()
            .filter(move |(_, (symbol, _))| is_function(symbol))
            .map(|(name, _)| name.as_str())
    }

    /// All declared names.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        let undeclared = |name: &&String| !self.undeclared.iter().any(|fault| fault.name == **name);
        self.declared
            .keys()
            .filter(undeclared)
            .map(String::as_str)
            .chain(self.scoped.iter().map(|(name, _)| name.as_str()))
    }

    /// Gives a constraint or drive its rows.
    pub fn define_rows(&mut self, name: &str, rows: Rows) {
        self.rows.insert(name.to_owned(), rows);
    }

    /// The rows of a constraint or drive.
    pub fn rows(&self, name: &str) -> Option<&Rows> {
        self.rows.get(name)
    }

    /// All constraints and drives.
    pub fn row_groups(&self) -> impl Iterator<Item = &str> {
        self.rows.keys().map(String::as_str)
    }

    /// Adds a pin to those of its name; a loop declares several.
    pub fn define_pin(&mut self, name: &str, joint: Joint) {
        self.pins.entry(name.to_owned()).or_default().push(joint);
    }

    /// The pins of a name.
    pub fn pin(&self, name: &str) -> Option<&[Joint]> {
        self.pins.get(name).map(Vec::as_slice)
    }

    /// All names of pins.
    pub fn pin_names(&self) -> impl Iterator<Item = &str> {
        self.pins.keys().map(String::as_str)
    }

    /// Token that declares the name outside any loop.
    pub fn declared_at(&self, name: &str) -> Option<Span> {
        self.declared.get(name).map(|(_, span)| *span)
    }

    /// Opens a scope with one name; returns the mark to close it with.
    pub fn enter(&mut self, name: &str, symbol: Symbol) -> usize {
        self.scoped.push((name.to_owned(), symbol));
        self.scoped.len() - 1
    }

    /// Closes the scope opened with `mark`.
    pub fn leave(&mut self, mark: usize) {
        self.scoped.truncate(mark);
    }
}

/// Reports names that the language or Rust keeps for itself.
fn usable(name: &Name, diagnostics: &mut Diagnostics) -> bool {
    let text = name.text.as_str();
    let fault = if RESERVED.contains(&text) {
        format!("`{text}` is reserved by the language")
    } else if is_function(text) {
        format!("`{text}` is the name of a function")
    } else {
        return can_be_field(name, diagnostics);
    };
    diagnostics.report(name.span, fault, format!("choose another name, `{text}_1` for instance"));
    false
}

/// Reports names that no field of the emitted code can have.
pub fn can_be_field(name: &Name, diagnostics: &mut Diagnostics) -> bool {
    let text = name.text.as_str();
    if !UNUSABLE.contains(&text) {
        return true;
    }
    let fault = format!("`{text}` is a word of Rust that cannot be a name");
    diagnostics.report(name.span, fault, format!("choose another name, `{text}_1` for instance"));
    false
}

/// Reports a second declaration.
pub fn report_double(name: &Name, first: Span, diagnostics: &mut Diagnostics) {
    diagnostics.report(
        name.span,
        format!("`{}` is declared twice", name.text),
        format!("the first declaration is in line {}; rename one of them", first.start().line),
    );
}

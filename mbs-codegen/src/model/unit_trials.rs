//! Declarations at fault: with another unit of one, the text is resolved again and has fewer faults of units.

use proc_macro2::Span;

use super::names::Elsewhere;
use super::resolve::resolve;
use super::unit_faults::{Place, UnitFault, UnitOf, count, parsed};
use super::units::Dimension;
use super::written::written;
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Instruction, Name, Operation, Statement, StatementKind, Type, Unit};

/// Most statements of a text whose declarations are tried with other units: each trial resolves it once more.
const MOST_STATEMENTS: usize = 400;
/// Most trials for one fault.
const MOST_TRIALS: usize = 24;

/// The declarations of a text with faults of units.
pub struct Declarations<'a> {
    pub statements: &'a [Statement],
    /// Number of faults that are none of these.
    pub others: usize,
    pub faults: &'a [UnitFault],
}

/// A declaration with a unit.
pub struct Declared<'a> {
    pub index: usize,
    pub keyword: &'static str,
    pub name: &'a Name,
    pub unit: &'a Unit,
    pub kind: Option<&'a Type>,
}

impl Declarations<'_> {
    /// The declaration of a name.
    pub fn find(&self, wanted: &str) -> Option<Declared<'_>> {
        self.statements.iter().enumerate().find_map(|(index, statement)| {
            let (keyword, name, unit, kind) = declared(&statement.kind)?;
            (name.text == wanted).then_some(Declared { index, keyword, name, unit, kind })
        })
    }

    /// Declared names in an expression, each once.
    pub fn names<'e>(&self, code: &'e [Instruction]) -> Vec<&'e str> {
        let mut found: Vec<&str> = Vec::new();
        for instruction in code {
            if let Operation::Name(name) | Operation::Call { function: name, .. } = &instruction.operation
                && !found.contains(&name.as_str())
                && self.find(name).is_some()
            {
                found.push(name);
            }
        }
        found
    }

    /// The declaration whose unit leaves no fault of units, where it is another one.
    ///
    /// Returns place, message and cure, and which faults it leaves no more.
    pub fn declaration(&self, fault: &UnitFault) -> Option<((Span, String, String), Vec<bool>)> {
        if self.statements.len() > MOST_STATEMENTS {
            return None;
        }
        if let Place::Value(name) = &fault.place
            && let Some(own) = self.find(name)
            && let Some(vanished) = self.vanished(&own, fault.found, fault)
        {
            let (unit, new) = (own.unit.text.as_str(), fault.found.text());
            let value = match own.keyword {
                "out" | "let" => "its definition",
                _ => "its value",
            };
            let message = format!("`{name}` is declared in `{unit}`, {value} is in `{new}`");
            let is_rate = fault.found.to(fault.wanted).dimension == Dimension::NUMBER.over(Dimension::SECOND);
            let rate = match is_rate && own.keyword == "out" {
                true => format!(", or take the rate: `der({})`", written(&fault.operand)),
                false => String::new(),
            };
            return Some(((own.unit.span, message, cure(&own, &new) + &rate), vanished));
        }
        let ratio = fault.found.to(fault.wanted);
        let inverse = fault.wanted.to(fault.found);
        let mut trials = 0;
        for (code, ratio, of) in [(&fault.operand, ratio, fault.wanted), (&fault.other, inverse, fault.found)]
        {
            for name in self.names(code) {
                let Some(own) = self.find(name) else { continue };
                let Some(dimension) = Dimension::of(own.unit, &mut Diagnostics::default()) else { continue };
                for exponent in [1.0, -1.0, 0.5] {
                    trials += 1;
                    if trials > MOST_TRIALS {
                        return None;
                    }
                    let Some(factor) = ratio.dimension.power(exponent) else { continue };
                    let is_angle = of.is_angle || fault.place_is_of_angles();
                    let unit = UnitOf { dimension: dimension.times(factor), is_angle };
                    if unit.dimension != dimension
                        && let Some(vanished) = self.vanished(&own, unit, fault)
                    {
                        let new = unit.text();
                        let message =
                            format!("`{name}` is declared in `{}`, but used in `{new}`", own.unit.text);
                        return Some(((own.unit.span, message, cure(&own, &new)), vanished));
                    }
                }
            }
        }
        None
    }

    /// The faults of units that vanish with another unit of a declaration; `None` where this one stays, or others come.
    fn vanished(&self, own: &Declared<'_>, unit: UnitOf, fault: &UnitFault) -> Option<Vec<bool>> {
        let unit = parsed(&unit.text(), own.unit.span)?;
        let mut statements = self.statements.to_vec();
        if let Some(statement) = statements.get_mut(own.index) {
            set_unit(&mut statement.kind, unit);
        }
        let mut diagnostics = Diagnostics::default();
        let (_, names) = resolve(&statements, Elsewhere::default(), &mut diagnostics);
        let place = |fault: &UnitFault| (fault.span.start().line, fault.span.start().column);
        let left: Vec<_> = names.unit_faults.iter().map(place).collect();
        let known: Vec<_> = self.faults.iter().map(place).collect();
        let is_better = !left.contains(&place(fault)) && left.iter().all(|place| known.contains(place));
        let others = diagnostics.number().saturating_sub(count(&names.unit_faults, &diagnostics));
        (is_better && others <= self.others)
            .then(|| known.iter().map(|place| !left.contains(place)).collect())
    }
}

/// The declaration with its unit in place of the one that it has.
fn cure(own: &Declared<'_>, unit: &str) -> String {
    let kind = match own.kind {
        Some(kind) if !kind.shape.is_empty() => {
            let lengths: Vec<String> = kind.shape.iter().map(|length| written(&length.code)).collect();
            format!("[{unit}; {}]", lengths.join(", "))
        }
        _ => unit.to_owned(),
    };
    format!("write `{} {}: {kind}`", own.keyword, own.name.text)
}

/// Keyword, name, unit and type of a declaration with a unit.
fn declared(kind: &StatementKind) -> Option<(&'static str, &Name, &Unit, Option<&Type>)> {
    Some(match kind {
        StatementKind::Const { name, unit, .. } => ("const", name, unit, None),
        StatementKind::Let { name, unit: Some(unit), .. } => ("let", name, unit, None),
        StatementKind::Param { name, kind, .. } => ("param", name, &kind.unit, Some(kind)),
        StatementKind::Input { name, kind, .. } => ("input", name, &kind.unit, Some(kind)),
        StatementKind::Coord { name, kind, .. } => ("coord", name, &kind.unit, Some(kind)),
        StatementKind::State { name, kind, .. } => ("state", name, &kind.unit, Some(kind)),
        StatementKind::Latch { name, kind, .. } => ("latch", name, &kind.unit, Some(kind)),
        StatementKind::Out { name, kind, .. } => ("out", name, &kind.unit, Some(kind)),
        StatementKind::Function { name, signature } => (
            "function",
            name,
            &signature.value.unit,
            Some(&signature.value).filter(|kind| !kind.shape.is_empty()),
        ),
        _ => return None,
    })
}

fn set_unit(kind: &mut StatementKind, new: Unit) {
    match kind {
        StatementKind::Const { unit, .. } | StatementKind::Let { unit: Some(unit), .. } => *unit = new,
        StatementKind::Param { kind, .. }
        | StatementKind::Input { kind, .. }
        | StatementKind::Coord { kind, .. }
        | StatementKind::State { kind, .. }
        | StatementKind::Latch { kind, .. }
        | StatementKind::Out { kind, .. } => kind.unit = new,
        StatementKind::Function { signature, .. } => signature.value.unit = new,
        _ => {}
    }
}

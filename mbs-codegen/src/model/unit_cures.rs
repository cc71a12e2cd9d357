//! Cures of units that do not fit, in the words of the text.
//!
//! A declaration is at fault where another unit of it leaves fewer faults of units in the whole text.

use proc_macro2::Span;

use super::names::Names;
use super::unit_faults::{Place, UnitFault, UnitOf, count};
use super::unit_trials::Declarations;
use super::units::Dimension;
use super::written::{Factor, factors, number, with_unit, written};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Instruction, Operation, Operator, Statement};

/// Before: statements, their names with the faults of units. After: each of these is reported with its cure; a declaration
/// at fault once for all of them.
pub fn explain(statements: &[Statement], names: &mut Names, diagnostics: &mut Diagnostics) {
    let mut faults = std::mem::take(&mut names.unit_faults);
    faults.sort_by_key(|fault| (fault.span.start().line, fault.span.start().column));
    // What could not be named stays as it was reported.
    let named = |fault: &UnitFault| fault.settled && !fault.operand.is_empty();
    let mut work = Declarations {
        statements,
        others: diagnostics.number() - count(&faults, diagnostics),
        faults: &faults,
    };
    let mut explained = vec![false; faults.len()];
    for (index, fault) in faults.iter().enumerate().filter(|(_, fault)| named(fault)) {
        let simple = [Declarations::cycle, Declarations::time, Declarations::literal];
        if explained.get(index) == Some(&true) || simple.iter().any(|cure| cure(&work, fault).is_some()) {
            continue;
        }
        let Some((found, vanished)) = work.declaration(fault) else { continue };
        // A number with a unit of its own may be at fault as well as a declaration that is used once.
        let is_number =
            matches!(fault.operand.as_slice(), [Instruction { operation: Operation::Number { .. }, .. }]);
        if is_number
            && vanished.iter().filter(|vanished| **vanished).count() < 2
            && fault.place == Place::Sides
        {
            continue;
        }
        for (index, fault) in
            faults.iter().enumerate().filter(|(index, _)| vanished.get(*index) == Some(&true))
        {
            diagnostics.withdraw(fault.span, &fault.message);
            if let Some(mark) = explained.get_mut(index) {
                *mark = true;
            }
        }
        diagnostics.report(found.0, found.1, found.2);
        work.others += 1;
    }
    let open = faults.iter().zip(&explained).filter(|(fault, explained)| named(fault) && !**explained);
    for (fault, _) in open {
        let of_number = |fault: &UnitFault| work.literal(fault).or_else(|| work.factor(fault));
        let cure = work.cycle(fault).or_else(|| work.time(fault)).or_else(|| of_number(fault));
        let mut seen = None;
        let cure = cure.or_else(|| of_number(seen.insert(fault.seen_from_the_other_side()?)));
        let told = seen.as_ref().filter(|_| cure.is_some()).unwrap_or(fault);
        let (span, help) = cure.unwrap_or_else(|| (work.span(fault), work.declarations(fault)));
        if diagnostics.withdraw(fault.span, &fault.message) {
            diagnostics.report(span, work.message(told), help);
        }
    }
}

type Cure = (Span, String);

impl Declarations<'_> {
    /// First token of the operand.
    fn span(&self, fault: &UnitFault) -> Span {
        let first = fault.operand.iter().map(|instruction| instruction.span);
        first.min_by_key(|span| (span.start().line, span.start().column)).unwrap_or(fault.span)
    }

    /// Unit of an operand in the user's words: as declared, where it is a name.
    fn unit(&self, code: &[Instruction], unit: UnitOf) -> String {
        match code {
            [Instruction { operation: Operation::Name(name), .. }] => {
                self.find(name).map_or_else(|| unit.text(), |declared| declared.unit.text.clone())
            }
            _ => unit.text(),
        }
    }

    fn message(&self, fault: &UnitFault) -> String {
        let UnitFault { place, found, wanted, operand, other, .. } = fault;
        let (found, needed) = (self.unit(operand, *found), wanted.text());
        let text = if operand.is_empty() { "this".into() } else { format!("`{}`", written(operand)) };
        let opposite = || match other.is_empty() {
            true => format!("the other side in `{needed}`"),
            false => format!("`{}` in `{}`", written(other), self.unit(other, *wanted)),
        };
        match place {
            Place::Terms => format!("{text} is in `{found}`, {}: they cannot be added", opposite()),
            Place::Sides => format!("{text} is in `{found}`, {}", opposite()),
            Place::Rate => format!("{text} is in `{found}`, the prescribed rate in `{needed}`"),
            Place::Argument(function) => {
                let kind = if wanted.is_angle { "an angle" } else { "a number" };
                format!("the argument of `{function}` is in `{found}`; it must be {kind}")
            }
            Place::Value(name) => {
                format!(
                    "`{name}` is declared in `{}`, {text} is in `{found}`",
                    self.declared_unit(name, *wanted)
                )
            }
            Place::Field(name) => format!("`{name}` is in `{needed}`, {text} in `{found}`"),
        }
    }

    fn declared_unit(&self, name: &str, unit: UnitOf) -> String {
        self.find(name).map_or_else(|| unit.text(), |declared| declared.unit.text.clone())
    }

    /// Cures of a time too many or too few.
    fn time(&self, fault: &UnitFault) -> Option<Cure> {
        let ratio = fault.found.to(fault.wanted);
        let per_second = Dimension::NUMBER.over(Dimension::SECOND);
        let found = factors(&fault.operand);
        let name = |factor: &&Factor| match fault.operand.get(factor.from..factor.to) {
            Some([Instruction { operation: Operation::Name(name), span }]) => Some((name.as_str(), *span)),
            _ => None,
        };
        let text = written(&fault.operand);
        if ratio.dimension == Dimension::SECOND
            && matches!(fault.place, Place::Sides)
            && !fault.operand.is_empty()
        {
            let product = if is_sum(&fault.operand) { format!("({text})*t") } else { format!("{text}*t") };
            return Some((self.span(fault), format!("multiply it by the time: `{product}`")));
        }
        if let ([Instruction { operation: Operation::Name(only), span }], Place::Sides) =
            (fault.operand.as_slice(), &fault.place)
            && only == "t"
        {
            let rate = with_unit(1.0, &ratio.text());
            return Some((*span, format!("multiply the time by a rate: `{rate}*t`")));
        }
        let time = found
            .iter()
            .find(|factor| factor.exponent == 1.0 && name(factor).is_some_and(|(n, _)| n == "t"))?;
        let (_, span) = name(&time)?;
        let is_pi = |factor: &Factor| name(&factor).is_some_and(|(n, _)| matches!(n, "PI" | "TAU"));
        let bare = found.iter().find_map(|factor| {
            match (fault.operand.get(factor.from..factor.to)?, factor.exponent == 1.0) {
                ([Instruction { operation: Operation::Number { value, unit: None, .. }, span }], true) => {
                    Some((*value, *span))
                }
                _ => None,
            }
        });
        // Radians a turn times the time: the law of an angle, where its rate is prescribed.
        if let (Some((value, at)), Place::Rate, true) = (bare, &fault.place, found.iter().any(is_pi)) {
            let rate = with_name(&fault.operand, at, &with_unit(value, &fault.wanted.text()));
            let rest = without(&rate, &found, time)?;
            return Some((span, format!("the speed stands without the time: `{rest}`")));
        }
        if let (Some((value, at)), false) =
            (bare, found.iter().any(is_pi) || ratio.dimension == Dimension::NUMBER)
            && !matches!(&fault.place, Place::Argument(_) if !fault.wanted.is_angle)
        {
            let quantity = with_unit(value, &ratio.text());
            let cure = replaced(&fault.operand, at, &quantity);
            return Some((at, format!("give the number its unit: `{cure}`")));
        }
        if ratio.dimension != per_second {
            return None;
        }
        if matches!(fault.place, Place::Argument(_)) {
            return Some((
                span,
                format!("divide the time by its unit: `{}`", replaced(&fault.operand, span, "t/1s")),
            ));
        }
        let rest = without(&fault.operand, &found, time)?;
        Some((span, format!("leave out the time: `{rest}`")))
    }

    /// Cure of a number that has no unit, or another one than its field.
    fn literal(&self, fault: &UnitFault) -> Option<Cure> {
        let (code, sign) = match fault.operand.as_slice() {
            [number, Instruction { operation: Operation::Negate, .. }] => (number, "-"),
            [number] => (number, ""),
            _ => return None,
        };
        let Operation::Number { value, unit, .. } = &code.operation else { return None };
        let is_field = matches!(fault.place, Place::Field(_));
        (unit.is_none() || is_field).then(|| {
            let number = with_unit(*value, &fault.wanted.text());
            (code.span, format!("write `{sign}{number}`"))
        })
    }

    /// Cure of a frequency for an angular speed.
    fn cycle(&self, fault: &UnitFault) -> Option<Cure> {
        let (found, wanted) = (fault.found.dimension, fault.wanted.dimension);
        let text = written(&fault.operand);
        let product = if is_sum(&fault.operand) { format!("TAU*({text})") } else { format!("TAU*{text}") };
        let help = match found {
            _ if found.without_cycles() != wanted.without_cycles() => return None,
            _ if found == found.without_cycles() => {
                "a cycle is TAU radians: multiply the frequency by `TAU`".into()
            }
            _ => format!("a cycle is TAU radians: `{product}`"),
        };
        Some((self.span(fault), help))
    }

    /// Cure by a factor that stands there already, or by the unit of a bare number.
    fn factor(&self, fault: &UnitFault) -> Option<Cure> {
        let ratio = fault.found.to(fault.wanted);
        let found = factors(&fault.operand);
        let part = |factor: &Factor| fault.operand.get(factor.from..factor.to).unwrap_or_default();
        for factor in &found {
            if let [Instruction { operation: Operation::Name(name), span }] = part(factor)
                && let Some(own) = self.find(name)
                && Dimension::of(own.unit, &mut Diagnostics::default()) == Some(ratio.dimension)
                && factor.exponent == 1.0
            {
                let text = replaced(&fault.operand, *span, &format!("{name}^2"));
                return Some((*span, format!("a factor in `{}` is missing: `{text}`", ratio.text())));
            }
        }
        let bare = found.iter().find_map(|factor| match part(factor) {
            [Instruction { operation: Operation::Number { value, unit: None, .. }, span }]
                if factor.exponent == 1.0 =>
            {
                Some((*value, *span))
            }
            _ => None,
        });
        let (value, span) = bare?;
        let text = replaced(&fault.operand, span, &with_unit(value, &ratio.text()));
        Some((span, format!("give the number its unit: `{text}`")))
    }

    /// The declarations of all names on both sides, and the factor that is missing.
    fn declarations(&self, fault: &UnitFault) -> String {
        let mut names = self.names(&fault.operand);
        names.extend(self.names(&fault.other).into_iter().filter(|name| {
            !fault.operand.iter().any(|i| matches!(&i.operation, Operation::Name(n) if n == name))
        }));
        let own = match &fault.place {
            Place::Value(name) => self.find(name).map(|own| own.name.text.clone()),
            _ => None,
        };
        names.extend(own.as_deref());
        let listed: Vec<String> = names
            .iter()
            .filter_map(|name| self.find(name))
            .take(3)
            .map(|own| {
                format!("`{}: {}` in line {}", own.name.text, own.unit.text, own.name.span.start().line)
            })
            .collect();
        let ratio = fault.found.to(fault.wanted).text();
        if fault.found.dimension == Dimension::NUMBER
            && matches!(fault.place, Place::Value(_) | Place::Field(_))
        {
            let product = format!("1 [{ratio}]*{}", bracketed(&fault.operand));
            return format!("multiply it by a quantity in `{ratio}`: `{product}`");
        }
        let missing = match ratio.strip_prefix("1/") {
            Some(divisor) => format!("it lacks a divisor in `{divisor}`"),
            None => format!("it lacks a factor in `{ratio}`"),
        };
        match listed.is_empty() {
            true => missing,
            false => format!("{missing}; declared are {}", listed.join(", ")),
        }
    }
}

/// An operand as a factor of a product.
fn bracketed(code: &[Instruction]) -> String {
    if is_sum(code) { format!("({})", written(code)) } else { written(code) }
}

fn is_sum(code: &[Instruction]) -> bool {
    matches!(
        code.last().map(|last| &last.operation),
        Some(Operation::Binary(Operator::Add | Operator::Subtract))
    )
}

/// The expression with another text for the number or name at `span`.
fn replaced(code: &[Instruction], span: Span, text: &str) -> String {
    written(&with_name(code, span, text))
}

/// The expression with `text` as a name in place of the number or name at a place.
fn with_name(code: &[Instruction], span: Span, text: &str) -> Vec<Instruction> {
    let at =
        |other: Span| (other.start().line, other.start().column) == (span.start().line, span.start().column);
    let named = |instruction: &Instruction| match &instruction.operation {
        Operation::Number { .. } | Operation::Name(_) if at(instruction.span) => {
            Instruction { operation: Operation::Name(text.to_owned()), span: instruction.span }
        }
        _ => instruction.clone(),
    };
    code.iter().map(named).collect()
}

/// The product without one of its factors; `None` where it has no other one.
fn without(code: &[Instruction], found: &[Factor], left_out: &Factor) -> Option<String> {
    let part = |factor: &Factor| {
        let text = written(code.get(factor.from..factor.to).unwrap_or_default());
        let is_atom = factor.to - factor.from == 1;
        let text = if is_atom { text } else { format!("({text})") };
        match factor.exponent.abs() {
            1.0 => text,
            power => format!("{text}^{}", number(power)),
        }
    };
    let (over, under): (Vec<&Factor>, Vec<&Factor>) =
        found.iter().filter(|factor| *factor != left_out).partition(|factor| factor.exponent > 0.0);
    if over.is_empty() {
        return None;
    }
    let over: Vec<String> = over.into_iter().map(part).collect();
    let under: Vec<String> = under.into_iter().map(|factor| format!("/{}", part(factor))).collect();
    Some(format!("{}{}", over.join("*"), under.concat()))
}

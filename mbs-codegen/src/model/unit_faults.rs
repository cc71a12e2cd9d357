//! Faults of units: what stands where, in which units, and the change that mends it.
//!
//! A declaration is at fault where another unit of it leaves no fault of units in the whole text.

use proc_macro2::Span;

use super::names::Names;
use super::resolve::resolved;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::Scalar;
use super::written::{Factor, factors, number, operands, with_unit, written};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Instruction, Name, Operation, Statement, StatementKind, Type, Unit};

/// Kind of place at which a unit does not fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Terms of a sum, or arguments of `min` and its like.
    Terms,
    /// Sides of an equation or a condition.
    Sides,
    /// Side of a drive that prescribes a rate.
    Rate,
    /// Argument of a function that takes an angle or a number, and the name of the function.
    Argument(String),
    /// Value of a declaration, by its name.
    Value(String),
    /// Value of a field, by its name.
    Field(String),
}

/// A unit that does not fit.
#[derive(Clone, Debug)]
pub struct UnitFault {
    /// Its place, and the message as it was reported.
    pub span: Span,
    pub message: String,
    pub place: Place,
    /// Unit of the operand, and the unit that is needed there.
    pub found: UnitOf,
    pub wanted: UnitOf,
    /// The operand as written, and what stands on the other side; empty where they are not known.
    pub operand: Vec<Instruction>,
    pub other: Vec<Instruction>,
    /// `true` once place and operands are known.
    pub settled: bool,
}

/// Dimension of a value, and `true` if it is an angle or a power of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitOf {
    pub dimension: Dimension,
    pub is_angle: bool,
}

impl UnitOf {
    /// That of a scalar.
    pub fn scalar(scalar: Scalar) -> Self {
        UnitOf { dimension: scalar.quantity.dimension(), is_angle: scalar.bare == Bare::Angle }
    }

    /// Spelling that an engineer uses.
    fn text(self) -> String {
        let per_second = Dimension::NUMBER.over(Dimension::SECOND);
        let angles = [
            (Dimension::NUMBER, "rad"),
            (per_second, "rad/s"),
            (per_second.over(Dimension::SECOND), "rad/s^2"),
        ];
        let (newton, metre, second) = (Dimension::NEWTON, Dimension::METRE, Dimension::SECOND);
        let usual = [
            (newton.over(metre), "N/m"),
            (newton.times(second), "N*s"),
            (newton.times(second).over(metre), "N*s/m"),
            (Dimension::JOULE.times(second), "N*m*s"),
            (Dimension::INERTIA, "kg*m^2"),
            (Dimension::KILOGRAM.times(metre), "kg*m"),
        ];
        let named = |list: &[(Dimension, &'static str)]| {
            list.iter().find(|(known, _)| *known == self.dimension).map(|(_, text)| *text)
        };
        let text = if self.is_angle { named(&angles).or_else(|| named(&usual)) } else { named(&usual) };
        text.map_or_else(|| self.dimension.to_string(), str::to_owned)
    }

    /// Unit that this one must be multiplied by to give `other`.
    fn to(self, other: UnitOf) -> UnitOf {
        let is_angle = other.is_angle && !self.is_angle;
        UnitOf { dimension: other.dimension.over(self.dimension), is_angle }
    }
}

/// Before: statements, their names with the faults of units. After: each of these is reported with its cure; a declaration
/// at fault once for all of them.
pub fn explain(statements: &[Statement], names: &mut Names, diagnostics: &mut Diagnostics) {
    let mut faults = std::mem::take(&mut names.unit_faults);
    faults.sort_by_key(|fault| (fault.span.start().line, fault.span.start().column));
    // What could not be named stays as it was reported.
    let named = |fault: &UnitFault| fault.settled && !fault.operand.is_empty();
    let mut work = Explanation {
        statements,
        others: diagnostics.number() - count(&faults, diagnostics),
        faults: &faults,
    };
    let mut explained = vec![false; faults.len()];
    for (index, fault) in faults.iter().enumerate().filter(|(_, fault)| named(fault)) {
        let simple = [Explanation::cycle, Explanation::time, Explanation::literal];
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
        let cure = work.cycle(fault).or_else(|| work.time(fault)).or_else(|| work.literal(fault));
        let cure = cure.or_else(|| work.factor(fault));
        let (span, help) = cure.unwrap_or_else(|| (work.span(fault), work.declarations(fault)));
        if diagnostics.withdraw(fault.span, &fault.message) {
            diagnostics.report(span, work.message(fault), help);
        }
    }
}

/// Number of the faults that were reported: in a loop some are reported once and found several times.
fn count(faults: &[UnitFault], diagnostics: &Diagnostics) -> usize {
    let mut places: Vec<_> = faults
        .iter()
        .filter(|fault| diagnostics.holds(fault.span, &fault.message))
        .map(|fault| (fault.span.start().line, fault.span.start().column, fault.message.as_str()))
        .collect();
    places.sort_unstable();
    places.dedup();
    places.len()
}

/// Most statements of a text whose declarations are tried with other units: each trial resolves it once more.
const MOST_STATEMENTS: usize = 400;
/// Most trials for one fault.
const MOST_TRIALS: usize = 24;

struct Explanation<'a> {
    statements: &'a [Statement],
    /// Number of faults that are none of these.
    others: usize,
    faults: &'a [UnitFault],
}

/// A declaration with a unit.
struct Declared<'a> {
    index: usize,
    keyword: &'static str,
    name: &'a Name,
    unit: &'a Unit,
    kind: Option<&'a Type>,
}

type Cure = (Span, String);

impl Explanation<'_> {
    /// The declaration of a name.
    fn find(&self, wanted: &str) -> Option<Declared<'_>> {
        self.statements.iter().enumerate().find_map(|(index, statement)| {
            let (keyword, name, unit, kind) = declared(&statement.kind)?;
            (name.text == wanted).then_some(Declared { index, keyword, name, unit, kind })
        })
    }

    /// Declared names in an expression, each once.
    fn names<'e>(&self, code: &'e [Instruction]) -> Vec<&'e str> {
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

    /// The declaration whose unit leaves no fault of units, where it is another one.
    ///
    /// Returns place, message and cure, and which faults it leaves no more.
    fn declaration(&self, fault: &UnitFault) -> Option<((Span, String, String), Vec<bool>)> {
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
        let (_, names) = resolved(&statements, &mut diagnostics);
        let place = |fault: &UnitFault| (fault.span.start().line, fault.span.start().column);
        let left: Vec<_> = names.unit_faults.iter().map(place).collect();
        let known: Vec<_> = self.faults.iter().map(place).collect();
        let is_better = !left.contains(&place(fault)) && left.iter().all(|place| known.contains(place));
        let others = diagnostics.number().saturating_sub(count(&names.unit_faults, &diagnostics));
        (is_better && others <= self.others)
            .then(|| known.iter().map(|place| !left.contains(place)).collect())
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

impl UnitFault {
    fn place_is_of_angles(&self) -> bool {
        matches!(self.place, Place::Argument(_)) && self.wanted.is_angle
    }
}

/// An operand as a factor of a product.
fn bracketed(code: &[Instruction]) -> String {
    if is_sum(code) { format!("({})", written(code)) } else { written(code) }
}

/// Of a vector that is written out, the component that holds the token at `span`; of any other expression the whole.
pub fn component_at(code: &[Instruction], span: Span) -> &[Instruction] {
    let place = |span: Span| (span.start().line, span.start().column);
    let Some((Instruction { operation: Operation::Array { length }, .. }, parts)) = code.split_last() else {
        return code;
    };
    let components = operands(parts, parts.len(), *length).unwrap_or_default();
    let holds = |component: &&[Instruction]| component.iter().any(|part| place(part.span) == place(span));
    components.into_iter().find(holds).unwrap_or(code)
}

fn is_sum(code: &[Instruction]) -> bool {
    use crate::syntax::ast::Operator;
    matches!(
        code.last().map(|last| &last.operation),
        Some(Operation::Binary(Operator::Add | Operator::Subtract))
    )
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
        StatementKind::Out { name, kind, .. } => ("out", name, &kind.unit, Some(kind)),
        StatementKind::Function { name, signature } => ("function", name, &signature.unit, None),
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
        | StatementKind::Out { kind, .. } => kind.unit = new,
        StatementKind::Function { signature, .. } => signature.unit = new,
        _ => {}
    }
}

/// A unit of symbols, powers, products and quotients.
pub fn parsed(text: &str, span: Span) -> Option<Unit> {
    let mut factors = Vec::new();
    let mut sign = 1;
    let mut rest = text;
    loop {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let (factor, behind) = rest.split_at_checked(end)?;
        let (symbol, power) = match factor.split_once('^') {
            Some((symbol, power)) => (symbol, power.parse::<i32>().ok()?),
            None => (factor, 1),
        };
        if symbol != "1" {
            factors.push((Name { text: symbol.to_owned(), span }, sign * power));
        }
        let Some(operator) = behind.chars().next() else { break };
        sign = if operator == '*' { 1 } else { -1 };
        rest = behind.get(1..)?;
    }
    Some(Unit { factors, text: text.to_owned(), span })
}

/// The expression with another text for the number or name at `span`.
fn replaced(code: &[Instruction], span: Span, text: &str) -> String {
    let at =
        |other: Span| (other.start().line, other.start().column) == (span.start().line, span.start().column);
    let code: Vec<Instruction> = code
        .iter()
        .map(|instruction| match &instruction.operation {
            Operation::Number { .. } | Operation::Name(_) if at(instruction.span) => {
                Instruction { operation: Operation::Name(text.to_owned()), span: instruction.span }
            }
            _ => instruction.clone(),
        })
        .collect();
    written(&code)
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

//! Expressions as written → scalar expressions: shapes flattened, loops unrolled, units checked.

use proc_macro2::Span;

use super::bare::Bare;
use super::compound;
use super::declared_functions;
use super::expression::{Expressions, Id, Node};
use super::functions::{self, FUNCTIONS};
use super::names::{Names, Symbol};
use super::operands::Operands;
use super::references::{REFERRING, is_reference};
use super::units::{Dimension, in_unit, with_suffix};
use super::{Longest, Reference};
use crate::diagnostics::{Diagnostics, nearest};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::{Expression, Instruction, Name, Operation, Operator, Target, Unit};

/// A fault was reported.
#[derive(Clone, Copy, Debug)]
pub struct Fault;

/// Most operations that a text may unroll to: their derivatives and stages are several times as many. Of a text that repeats itself
/// these are the 100 000 of `cargo xtask growth`, and some more.
pub const MOST_OPERATIONS: usize = 64_000;
/// Most expressions, numbers included, which cost less.
pub const MOST_EXPRESSIONS: usize = 200_000;
/// Longest array.
pub const LONGEST: usize = 6_000;
/// Largest count, and most rounds of all loops together.
pub const MOST_ROUNDS: usize = 100_000;

const RATES: &str = "write rates in `out` definitions and forces; a drive takes its rates from the time and from inputs with rates";
const ACCELERATIONS: &str =
    "forces use positions and rates; what grows with the acceleration is a mass: `kinetic T = …;`";

/// Names that have a value without a declaration.
const CONSTANTS: [&str; 3] = ["t", "PI", "TAU"];

/// Dimension of a scalar, or none: `0` fits any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    Any,
    Known(Dimension),
}

impl Quantity {
    /// The dimension; that of a number where any fits.
    pub fn dimension(self) -> Dimension {
        match self {
            Quantity::Any => Dimension::NUMBER,
            Quantity::Known(dimension) => dimension,
        }
    }
}

/// A scalar with its unit.
#[derive(Clone, Copy, Debug)]
pub struct Scalar {
    pub id: Id,
    pub quantity: Quantity,
    /// Share of bare numbers, which take on a declared unit.
    pub bare: Bare,
    /// The token that it comes from.
    pub span: Span,
}

/// A scalar, vector or matrix.
#[derive(Clone, Debug)]
pub struct Value {
    /// None for a scalar.
    pub shape: Vec<usize>,
    /// Row by row.
    pub items: Vec<Scalar>,
    /// The token that it comes from.
    pub span: Span,
}

impl Value {
    /// A value without shape.
    pub fn scalar(scalar: Scalar, span: Span) -> Self {
        Value { shape: Vec::new(), items: vec![scalar], span }
    }

    /// Description in a message.
    pub fn describe(&self) -> String {
        match self.shape.as_slice() {
            [] => "a scalar".into(),
            [length] => format!("a vector of {length}"),
            shape => {
                format!("an array of {}", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × "))
            }
        }
    }
}

/// Quantities that an expression may use in addition to coordinates, parameters, inputs and the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// None of them.
    Position,
    /// `der(x)`, multipliers and first-order states.
    Force,
    /// `der2(x)` too.
    Output,
    /// Any rate: the definition of a `let`, whose uses are checked.
    Let,
}

/// Executes the postfix code of expressions.
pub struct Elaborator<'a> {
    pub expressions: &'a mut Expressions,
    pub names: &'a mut Names,
    pub diagnostics: &'a mut Diagnostics,
    /// Quantities that are allowed here.
    pub reach: Reach,
    /// Quantities used here so far.
    pub needs: Reach,
    /// Groups that `margin` and `ratio` can refer to.
    pub groups: &'a [Reference],
    /// Largest length of the text so far.
    pub longest: Option<Longest>,
}

fn list(names: &[&str]) -> String {
    match names {
        [] => "no constraint yet".into(),
        _ => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}

/// A `sum` that is being unrolled.
struct Sum {
    variable: String,
    count: usize,
    high: usize,
    scope: usize,
    total: Option<Value>,
}

impl Elaborator<'_> {
    /// Before: an expression as written. After: its value, or the fault reported.
    pub fn value(&mut self, expression: &Expression) -> Result<Value, Fault> {
        let mut stack = Operands::default();
        let mut sums: Vec<Sum> = Vec::new();
        let mut next = 0;
        let result = loop {
            let Some(instruction) = expression.code.get(next) else { break stack.pop(self.names) };
            if self.expressions.operations() > MOST_OPERATIONS || self.expressions.len() > MOST_EXPRESSIONS {
                break Err(self.fault(
                    instruction.span,
                    format!("the text unrolls to more than {MOST_OPERATIONS} operations"),
                    "shorten the loops",
                ));
            }
            match self.step(expression, next, &mut stack, &mut sums) {
                Ok(following) => next = following,
                Err(fault) => {
                    self.unknown_names(expression, next + 1);
                    break Err(fault);
                }
            }
        };
        if let Some(outermost) = sums.first() {
            self.names.leave(outermost.scope);
        }
        result
    }

    /// Reports the unknown names after a fault, which are not evaluated any more.
    fn unknown_names(&mut self, expression: &Expression, from: usize) {
        let is_variable = |name: &str| {
            expression.code.iter().any(|instruction| {
                matches!(&instruction.operation, Operation::SumBegin { variable, .. } if variable.text == name)
            })
        };
        for (index, instruction) in expression.code.iter().enumerate().skip(from) {
            match &instruction.operation {
                Operation::Name(_) if is_reference(&expression.code, index) => {}
                Operation::Name(name) if !is_variable(name) => {
                    let known = self.names.get(name).is_some() || CONSTANTS.contains(&name.as_str());
                    // The units of one product are one fault.
                    let follows = compound::in_brackets(&expression.code, index).is_some()
                        && !compound::is_first(&expression.code, index);
                    if !known && !follows {
                        self.unknown_name(name, (&expression.code, index));
                    }
                }
                Operation::Call { function, .. }
                    if function != "rate"
                        && !REFERRING.contains(&function.as_str())
                        && !self.knows_function(function) =>
                {
                    self.unknown_function(function, instruction.span);
                }
                _ => {}
            }
        }
    }

    /// Executes one instruction; returns the index of the next.
    fn step<'e>(
        &mut self,
        expression: &'e Expression,
        index: usize,
        stack: &mut Operands<'e>,
        sums: &mut Vec<Sum>,
    ) -> Result<usize, Fault> {
        let instruction = expression.code.get(index).ok_or(Fault)?;
        let span = instruction.span;
        let value = match &instruction.operation {
            Operation::Number { value, unit, .. } => self.literal(*value, unit.as_ref(), span)?,
            Operation::Name(_) if is_reference(&expression.code, index) => return Ok(index + 1),
            Operation::Name(name) if matches!(self.names.get(name), Some(Symbol::Value(_))) => {
                self.allows(name, span)?;
                stack.push_named(name, span);
                return Ok(index + 1);
            }
            Operation::Name(name) => self.name(name, (&expression.code, index), span)?,
            Operation::Negate => {
                let a = stack.pop(self.names)?;
                self.each(&a, span, |work, item| work.unary_scalar(Unary::Negate, item, item.quantity, span))?
            }
            Operation::Binary(operator) => {
                let (b, a) = (stack.pop(self.names)?, stack.pop(self.names)?);
                self.operator(*operator, &a, &b, span)?
            }
            Operation::Call { function, order: 0, arguments } if REFERRING.contains(&function.as_str()) => {
                let group = index.checked_sub(1).and_then(|before| expression.code.get(before));
                let values = arguments.saturating_sub(1);
                let arguments = stack.pop_many(values, self.names)?;
                self.referring(function, group, arguments, span)?
            }
            Operation::Call { function, order, arguments } => {
                let arguments = stack.pop_many(*arguments, self.names)?;
                match (self.names.get(function), order) {
                    (Some(Symbol::Function(callable)), _) => {
                        declared_functions::call(self, *callable, (function, *order), arguments, span)?
                    }
                    (Some(Symbol::Faulty), _) if !FUNCTIONS.contains(&function.as_str()) => {
                        return Err(Fault);
                    }
                    (Some(Symbol::Pending), _) => return Err(self.too_early(function, span)),
                    (_, 0) => functions::call(self, function, arguments, span)?,
                    _ => return Err(self.no_derivative(function, span)),
                }
            }
            Operation::Array { length } => {
                let items = stack.pop_many(*length, self.names)?;
                self.array(items, span)?
            }
            Operation::Index { indices } => {
                let indices = stack.pop_many(*indices, self.names)?;
                self.index(stack, &indices, span)?
            }
            Operation::Reference { function, targets } => {
                let indexed = targets.iter().filter(|target| target.indexed).count();
                let counts = stack.pop_many(indexed, self.names)?;
                self.reference(function, targets, counts, span)?
            }
            Operation::SumBegin { variable, end } => {
                let (high, low) = (stack.pop(self.names)?, stack.pop(self.names)?);
                let (low, high) = self.range(&low, &high, follows_literals(&expression.code, index))?;
                if !self.names.is_free(variable, self.diagnostics) {
                    return Err(Fault);
                }
                if low >= high {
                    stack.push(Value::scalar(self.number_literal(0.0, span), span));
                    return Ok(end + 1);
                }
                let scope = self.names.enter(&variable.text, Symbol::Count(low));
                sums.push(Sum { variable: variable.text.clone(), count: low, high, scope, total: None });
                return Ok(index + 1);
            }
            Operation::SumEnd { begin } => {
                let term = stack.pop(self.names)?;
                let sum = sums.last_mut().ok_or(Fault)?;
                let total = match sum.total.take() {
                    None => term,
                    Some(total) => self.operator(Operator::Add, &total, &term, term.span)?,
                };
                sum.count += 1;
                self.names.leave(sum.scope);
                if sum.count < sum.high {
                    self.names.enter(&sum.variable, Symbol::Count(sum.count));
                    sum.total = Some(total);
                    return Ok(begin + 1);
                }
                sums.pop();
                Value { span, ..total }
            }
        };
        stack.push(value);
        Ok(index + 1)
    }

    /// A number as written, in SI.
    fn literal(&mut self, number: f64, unit: Option<&Unit>, span: Span) -> Result<Value, Fault> {
        let Some(unit) = unit else { return Ok(Value::scalar(self.number_literal(number, span), span)) };
        let (value, dimension) =
            in_unit(number, unit).map_err(|(at, message, help)| self.fault(at, message, help))?;
        if !value.is_finite() {
            return Err(self.fault(span, "this number is too large in SI units", "choose another unit"));
        }
        if value == 0.0 && number != 0.0 {
            return Err(self.fault(span, "this number is too small in SI units", "choose another unit"));
        }
        if dimension == Dimension::METRE {
            Longest::note(&mut self.longest, value, || format!("{} m", value.abs()), span);
        }
        let id = self.expressions.push(Node::Number(value));
        let scalar = Scalar { id, quantity: Quantity::Known(dimension), bare: Bare::of(unit), span };
        Ok(Value::scalar(scalar, span))
    }

    /// A bare number; `0` fits any unit.
    pub fn number_literal(&mut self, value: f64, span: Span) -> Scalar {
        let (quantity, bare) = match value == 0.0 {
            true => (Quantity::Any, Bare::Zero),
            false => (Quantity::Known(Dimension::NUMBER), Bare::Wholly),
        };
        Scalar { id: self.expressions.push(Node::Number(value)), quantity, bare, span }
    }

    /// Value of a name that is no declared value.
    fn name(&mut self, name: &str, place: (&[Instruction], usize), span: Span) -> Result<Value, Fault> {
        match self.names.get(name) {
            Some(Symbol::Count(count)) => {
                let count = *count as f64;
                return Ok(Value::scalar(self.number_literal(count, span), span));
            }
            Some(Symbol::Function(_)) => {
                let message = format!("`{name}` is a function");
                return Err(self.fault(span, message, format!("write `{name}(…)`")));
            }
            Some(Symbol::Pending) => return Err(self.too_early(name, span)),
            Some(Symbol::Faulty) => return Err(Fault),
            Some(Symbol::Value(_)) | None => {}
        }
        let number = |work: &mut Self, value| {
            let id = work.expressions.push(Node::Number(value));
            let quantity = Quantity::Known(Dimension::NUMBER);
            Value::scalar(Scalar { id, quantity, bare: Bare::Wholly, span }, span)
        };
        match name {
            "PI" => Ok(number(self, std::f64::consts::PI)),
            "TAU" => Ok(number(self, std::f64::consts::TAU)),
            "t" => {
                let id = self.expressions.push(Node::Time);
                let quantity = Quantity::Known(Dimension::SECOND);
                Ok(Value::scalar(Scalar { id, quantity, bare: Bare::Not, span }, span))
            }
            _ => Err(self.unknown_name(name, place)),
        }
    }

    /// A fault at a name that is used before its declaration allows it.
    fn too_early(&mut self, name: &str, span: Span) -> Fault {
        self.fault(
            span,
            format!("`{name}` cannot be used here"),
            "constants and defaults use constants alone, guesses use constants and parameters",
        )
    }

    /// `true` if the name is that of a function, or of a declaration that was reported.
    fn knows_function(&self, name: &str) -> bool {
        let declared =
            matches!(self.names.get(name), Some(Symbol::Function(_) | Symbol::Pending | Symbol::Faulty));
        declared || FUNCTIONS.contains(&name)
    }

    /// A fault at the derivative of a function that is not declared.
    fn no_derivative(&mut self, name: &str, span: Span) -> Fault {
        if !FUNCTIONS.contains(&name) {
            return self.unknown_function(name, span);
        }
        let message = format!("`{name}` is no declared function, and has no `.d1` or `.d2`");
        self.fault(span, message, "write its derivative as an expression")
    }

    /// A fault at an unknown name.
    fn unknown_name(&mut self, name: &str, (code, index): (&[Instruction], usize)) -> Fault {
        let span = code.get(index).map_or_else(Span::call_site, |instruction| instruction.span);
        if self.names.is_local(name) {
            let message = format!("`{name}` is known inside its `for` alone, behind its declaration");
            return self.fault(span, message, "move this into the loop, or declare a `let` outside of it");
        }
        let help = if FUNCTIONS.contains(&name) {
            format!("`{name}` is a function; write `{name}(…)`")
        } else if let Some(number) = compound::in_brackets(code, index) {
            format!("write a compound unit in brackets behind its number: `{number}`")
        } else if let Some(known) = nearest(name, self.names.all().chain(CONSTANTS)) {
            format!("did you mean `{known}`?")
        } else if with_suffix(1.0, name).is_ok() {
            format!(
                "a unit is joined to its number, `2{name}`, or stands in brackets behind it: `30 [rad/s]`"
            )
        } else {
            "declare it with `const`, `param`, `input`, `coord` or `let`".into()
        };
        self.fault(span, format!("unknown name `{name}`"), help)
    }

    /// A fault at an unknown function.
    pub fn unknown_function(&mut self, name: &str, span: Span) -> Fault {
        let known = || self.names.functions().chain(FUNCTIONS);
        let help = match nearest(name, known()) {
            Some(known) => format!("did you mean `{known}`?"),
            None => format!("known are {}", known().collect::<Vec<_>>().join(", ")),
        };
        self.fault(span, format!("unknown function `{name}`"), help)
    }

    /// Total time derivative of one scalar or vector.
    pub fn rate(&mut self, arguments: Vec<Value>, name: &str, order: u8, span: Span) -> Result<Value, Fault> {
        let [argument] = self.arguments(name, arguments, span)?;
        if self.reach == Reach::Position {
            return Err(self.fault(span, format!("`{name}` stands outside an output or a force"), RATES));
        }
        let inner = self.expressions.reachable(argument.items.iter().map(|item| item.id));
        let inside = |wanted: fn(Node) -> bool| {
            self.expressions.iter().any(|(id, node)| inner.get(id.index()) == Some(&true) && wanted(node))
        };
        if inside(|node| matches!(node, Node::State(_) | Node::Multiplier(_) | Node::Pin(..))) {
            return Err(self.fault(
                span,
                format!("`{name}` of a state or of a multiplier is not known"),
                "take rates of coordinates, inputs with rates and the time; `der(z) == …;` defines that of a state",
            ));
        }
        let accelerates = order > 1 || inside(|node| matches!(node, Node::Rate(..)));
        if self.reach == Reach::Force && accelerates {
            return Err(self.fault(span, "an acceleration stands in a force", ACCELERATIONS));
        }
        self.needs = self.needs.max(if accelerates { Reach::Output } else { Reach::Force });
        let seconds = Dimension::SECOND.power(f64::from(order)).unwrap_or_default();
        for item in &argument.items {
            self.of_position(*item, name)?;
        }
        self.each(&argument, span, |work, item| {
            let quantity = Quantity::Known(item.quantity.dimension().over(seconds));
            Ok(Scalar {
                id: work.expressions.push(Node::Rate(item.id, order)),
                quantity,
                bare: item.bare.rate(),
                span,
            })
        })
    }

    /// Before: a name with a value. After: the quantities of its `let` are allowed here, or the fault is reported.
    fn allows(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        let needs = self.names.needs(name);
        self.needs = self.needs.max(needs);
        if needs <= self.reach {
            return Ok(());
        }
        Err(if self.reach == Reach::Position {
            self.fault(span, format!("`{name}` takes a rate and stands outside an output or a force"), RATES)
        } else {
            self.fault(span, format!("`{name}` takes an acceleration and stands in a force"), ACCELERATIONS)
        })
    }

    /// `lambda(row)`, `effort(drive)`, `reaction(pin, body)`.
    fn reference(
        &mut self,
        function: &str,
        targets: &[Target],
        counts: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        if function == "reaction" {
            return self.reaction(targets, counts, span);
        }
        if matches!(self.reach, Reach::Position | Reach::Let) {
            return Err(self.fault(
                span,
                format!("`{function}` stands outside an output or a force"),
                "multipliers are known to forces and outputs alone",
            ));
        }
        if !matches!(function, "lambda" | "effort") {
            return Err(self.unknown_function(function, span));
        }
        if !self.names.dynamic {
            let help =
                "declare what moves: `body rod { mass: 2kg, com: P }`; without masses no row has a force";
            return Err(self.fault(span, format!("`{function}` stands in a text without masses"), help));
        }
        let [target] = targets else {
            let message = format!("`{function}` takes 1 name, not {}", targets.len());
            return Err(self.fault(span, message, format!("write `{function}(row)`")));
        };
        let Some(rows) = self.names.rows(&target.name.text).cloned() else {
            let known: Vec<&str> = self.names.row_groups().collect();
            let help = match nearest(&target.name.text, known.iter().copied()) {
                Some(name) => format!("did you mean `{name}`?"),
                None => format!("rows are those of {}", list(&known)),
            };
            let message = format!("`{}` is no constraint or drive", target.name.text);
            return Err(self.fault(target.name.span, message, help));
        };
        if function == "effort" && !rows.driven {
            let message = format!("`{}` is no drive", target.name.text);
            let help = format!("write `lambda({})` for the multiplier of a constraint", target.name.text);
            return Err(self.fault(target.name.span, message, help));
        }
        if rows.rows.is_empty() {
            return Err(self.without_rows(&target.name));
        }
        let chosen = match counts.first() {
            None => rows.rows.clone(),
            Some(count) => {
                let index = self.count(count)?;
                let Some(row) = rows.rows.get(index) else {
                    let (name, length) = (&target.name.text, rows.rows.len());
                    return Err(self.fault(
                        count.span,
                        format!("`{name}` has no row {index}"),
                        format!("its rows are counted from 0; the last is {}", length.saturating_sub(1)),
                    ));
                };
                vec![*row]
            }
        };
        let mut items = Vec::new();
        for (row, dimension) in &chosen {
            let quantity = Quantity::Known(Dimension::JOULE.over(*dimension));
            let id = self.expressions.push(Node::Multiplier(*row));
            let scalar = Scalar { id, quantity, bare: Bare::Not, span };
            items.push(match function {
                "effort" => self.unary_scalar(Unary::Negate, scalar, quantity, span)?,
                _ => scalar,
            });
        }
        let shape = if items.len() == 1 { Vec::new() } else { vec![items.len()] };
        Ok(Value { shape, items, span })
    }

    /// Reports that a group has no row, unless that follows from a fault in one.
    fn without_rows(&mut self, group: &Name) -> Fault {
        if !self.diagnostics.is_empty() {
            return Fault;
        }
        let message = format!("`{}` has no row and so no multiplier", group.text);
        self.fault(group.span, message, "write the equation whose force is meant")
    }

    /// A value that counts: a non-negative integer from literals, constants and loop names.
    pub fn count(&mut self, value: &Value) -> Result<usize, Fault> {
        let help = "counts are made of integers, integer constants and loop names";
        let number = match value.items.as_slice() {
            [item] if value.shape.is_empty() => match self.expressions.node(item.id) {
                Node::Number(number) if item.quantity.dimension() == Dimension::NUMBER => Some(number),
                _ => None,
            },
            _ => None,
        };
        match number {
            Some(number) if number >= 0.0 && number <= MOST_ROUNDS as f64 && number.fract() == 0.0 => {
                Ok(number as usize)
            }
            Some(number) if number > MOST_ROUNDS as f64 => Err(self.fault(
                value.span,
                format!("this count is larger than {MOST_ROUNDS}"),
                "shorten the loop or the array",
            )),
            Some(number) => Err(self.fault(value.span, format!("{number} is no count"), help)),
            None => Err(self.fault(value.span, "this is no count", help)),
        }
    }

    /// The counts of a range from `low` up to the one before `high`; `written`: both are numbers as written. Constants and
    /// outer loops may leave a range empty; an empty range of numbers is a fault.
    pub fn range(&mut self, low: &Value, high: &Value, written: bool) -> Result<(usize, usize), Fault> {
        let (first, end) = (self.count(low)?, self.count(high)?);
        if written && first >= end {
            let message = format!("the range `{first}..{end}` is empty");
            let help =
                "write the first count, and behind the dots one more than the last: `0..3` counts 0, 1, 2";
            return Err(self.fault(low.span, message, help));
        }
        Ok((first, end))
    }

    /// Stacks values of one shape.
    pub fn array(&mut self, values: Vec<Value>, span: Span) -> Result<Value, Fault> {
        let first = values.first().ok_or(Fault)?.clone();
        let mut items = Vec::new();
        let mut shape = vec![values.len()];
        shape.extend(&first.shape);
        if shape.iter().product::<usize>() > LONGEST {
            return Err(self.fault(
                span,
                format!("the array has more than {LONGEST} components"),
                "split it",
            ));
        }
        for value in values {
            self.same_shape(&first, &value, "an array", value.span)?;
            items.extend(value.items);
        }
        Ok(Value { shape, items, span })
    }

    fn index(&mut self, stack: &mut Operands<'_>, indices: &[Value], span: Span) -> Result<Value, Fault> {
        let base = stack.top_shape(self.names)?;
        if indices.len() > base.len() {
            let what = Value { shape: base, items: Vec::new(), span }.describe();
            return Err(self.fault(
                span,
                format!("{what} cannot take {} indices", indices.len()),
                "remove an index",
            ));
        }
        let mut offset = 0;
        for (value, length) in indices.iter().zip(&base) {
            let index = self.count(value)?;
            if index >= *length {
                return Err(self.fault(
                    value.span,
                    format!("index {index} is beyond the last of {length} components"),
                    format!("components are counted from 0; the last is {}", length.saturating_sub(1)),
                ));
            }
            offset = offset * length + index;
        }
        let shape: Vec<usize> = base.into_iter().skip(indices.len()).collect();
        let length = shape.iter().product::<usize>();
        let items = stack.pop_components(offset * length, length, self.names)?;
        Ok(Value { shape, items, span })
    }

    /// Reports a fault.
    pub fn fault(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Fault {
        self.diagnostics.report(span, message, help);
        Fault
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_unary(&mut self, function: Unary, a: Id, span: Span) -> Result<Id, Fault> {
        match self.expressions.node(a) {
            Node::Number(a) => self.folded((function.entry().value)(a), span),
            _ => Ok(self.expressions.push(Node::Unary(function, a))),
        }
    }

    /// Before: any operands. After: an expression of numbers is folded to its value, which must be finite.
    pub fn push_binary(&mut self, function: Binary, a: Id, b: Id, span: Span) -> Result<Id, Fault> {
        match (self.expressions.node(a), self.expressions.node(b)) {
            (Node::Number(a), Node::Number(b)) => self.folded((function.entry().value)(a, b), span),
            _ => Ok(self.expressions.push(Node::Binary(function, a, b))),
        }
    }

    fn folded(&mut self, value: f64, span: Span) -> Result<Id, Fault> {
        if value.is_finite() {
            return Ok(self.expressions.push(Node::Number(value)));
        }
        Err(self.fault(
            span,
            "this is not a finite number",
            "check for a division by zero, or a root or logarithm of a negative number",
        ))
    }
}

/// `true` if the two values before `index` are numbers as written.
fn follows_literals(code: &[Instruction], index: usize) -> bool {
    let is_literal = |back: usize| {
        let before = index.checked_sub(back).and_then(|index| code.get(index));
        matches!(before.map(|instruction| &instruction.operation), Some(Operation::Number { .. }))
    };
    is_literal(1) && is_literal(2)
}

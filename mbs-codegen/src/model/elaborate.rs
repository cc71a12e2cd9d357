//! Expressions as written → scalar expressions: shapes flattened, loops unrolled, units checked.

use proc_macro2::Span;

use super::compound;
use super::counts::follows_literals;
use super::elaborator::Elaborator;
use super::expression::Node;
use super::functions;
use super::names::{CONSTANTS, Callable, CurveForm, PARTIAL, RESERVED, Symbol, is_function, is_of_two};
use super::operands::Operands;
use super::references::{REFERRING, is_reference};
use super::unit_inference::Bare;
use super::units::{Dimension, in_unit};
use super::uses::OF_ANGLES;
use super::value::{Fault, Quantity, Scalar, Value};
use super::written;
use crate::symbolic::Unary;
use crate::syntax::ast::{Expression, Instruction, Operation, Operator, Unit};
use crate::syntax::unit_symbols::meant;

/// Most operations that a text may unroll to: their derivatives and stages are several times as many. Of a text that repeats itself
/// these are the 100 000 of `cargo xtask growth`, and some more.
pub const MOST_OPERATIONS: usize = 64_000;
/// Most expressions, numbers included, which cost less.
pub const MOST_EXPRESSIONS: usize = 200_000;

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
            if self.expressions.operations() > MOST_OPERATIONS || self.expressions.spent() > MOST_EXPRESSIONS
            {
                break Err(self.fault(
                    instruction.span,
                    format!("the text unrolls to more than {MOST_OPERATIONS} operations"),
                    "shorten the loops",
                ));
            }
            let known = self.names.unit_faults.len();
            match self.step(expression, next, &mut stack, &mut sums) {
                Ok(following) => next = following,
                Err(fault) => {
                    self.name_operands(&expression.code, next, known);
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
            // Its fault was reported where it was read.
            Operation::Number { value, .. } if value.is_nan() => return Err(Fault),
            Operation::Number { value, unit: None, .. } => {
                Value::scalar(self.number_literal(*value, span), span)
            }
            Operation::Number { value, unit: Some(unit), .. } => {
                self.quantity(*value, unit, (&expression.code, index))?
            }
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
                if matches!(operator, Operator::Add | Operator::Subtract) {
                    self.angles_in_sum(&expression.code, index, (&a, &b))?;
                }
                self.operator(*operator, &a, &b, span)?
            }
            Operation::Call { function, order: 0, arguments, indexed: false }
                if REFERRING.contains(&function.as_str()) =>
            {
                let group = index.checked_sub(1).and_then(|before| expression.code.get(before));
                let values = arguments.saturating_sub(1);
                let arguments = stack.pop_many(values, self.names)?;
                self.referring(function, group, arguments, span)?
            }
            Operation::Call { function, order: 0, arguments, indexed: false }
                if is_of_two(function, *arguments) =>
            {
                let is_of_curve = function != PARTIAL;
                let curve = index.checked_sub(1).and_then(|before| expression.code.get(before));
                let is_name = matches!(curve.map(|curve| &curve.operation), Some(Operation::Name(_)));
                let values = if is_of_curve && is_name { 1 } else { 2 };
                let arguments = stack.pop_many(values, self.names)?;
                match is_of_curve {
                    true => self.of_curve(function, curve, arguments, span)?,
                    false => self.partial(arguments, span)?,
                }
            }
            Operation::Call { function, order, arguments, indexed: true } => {
                let arguments = stack.pop_many(*arguments, self.names)?;
                let number = stack.pop(self.names)?;
                self.of_array((function, *order), &number, arguments, span)?
            }
            Operation::Call { function, order, arguments, indexed: false } => {
                if *arguments == 1 && OF_ANGLES.contains(&function.as_str()) {
                    let before = index.checked_sub(1).and_then(|at| expression.code.get(at..index));
                    self.bare_angles(before.unwrap_or_default())?;
                }
                let arguments = stack.pop_many(*arguments, self.names)?;
                match (self.names.get(function), order) {
                    (Some(Symbol::Function(callable)), _) => {
                        functions::call_declared(self, *callable, (function, *order), arguments, span)?
                    }
                    (Some(Symbol::Faulty), _) if !is_function(function) => {
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

    /// Reports a bare number of more than two turns beside an angle.
    fn angles_in_sum(
        &mut self,
        code: &[Instruction],
        index: usize,
        (a, b): (&Value, &Value),
    ) -> Result<(), Fault> {
        // Operands are looked for in short expressions alone: a chain of n sums would cost n² steps.
        let is_short = index < written::LONGEST;
        if !is_short || !self.is_large(a) && !self.is_large(b) {
            return Ok(());
        }
        let Some(operands) = written::operands(code, index, 2) else { return Ok(()) };
        match operands.as_slice() {
            [left, right] => {
                self.beside_angle((b, right), left)?;
                self.beside_angle((a, left), right)
            }
            _ => Ok(()),
        }
    }

    /// A number with its unit, in SI.
    fn quantity(
        &mut self,
        number: f64,
        unit: &Unit,
        (code, index): (&[Instruction], usize),
    ) -> Result<Value, Fault> {
        let span = code.get(index).map_or(unit.span, |instruction| instruction.span);
        let (value, dimension) = in_unit(number, unit).map_err(|(at, message, help)| {
            let name = unit.text.as_str();
            let is_name = self.names.get(name).is_some() || CONSTANTS.contains(&name);
            let product = || format!("a product needs its operator: `{}*{name}`", written::number(number));
            let help = match (compound::of_number(code, index), meant(name)) {
                (Some(number), _) => {
                    format!("write a compound unit in brackets behind its number: `{number}`")
                }
                (None, Some(_)) if is_name => format!("{help} {}", product()),
                _ if is_name => product(),
                _ => help,
            };
            self.fault(at, message, help)
        })?;
        if !value.is_finite() {
            return Err(self.fault(span, "this number is too large in SI units", "choose another unit"));
        }
        if value == 0.0 && number != 0.0 {
            return Err(self.fault(span, "this number is too small in SI units", "choose another unit"));
        }
        let id = self.expressions.push(Node::Number(value));
        self.expressions.name_length(id, dimension, |length| format!("{length} m"), span);
        let scalar = Scalar { id, quantity: Quantity::Known(dimension), bare: Bare::of(unit), span };
        Ok(Value::scalar(scalar, span))
    }

    /// A call of one of an array of functions.
    fn of_array(
        &mut self,
        (name, order): (&str, u8),
        number: &Value,
        arguments: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        match self.names.get(name) {
            Some(Symbol::Function(array)) => {
                let (function, name) = functions::element(self, *array, name, number, span)?;
                functions::call_declared(self, function, (&name, order), arguments, span)
            }
            Some(Symbol::Faulty) => Err(Fault),
            Some(Symbol::Pending) => Err(self.too_early(name, span)),
            None if !is_function(name) && !RESERVED.contains(&name) => Err(self.unknown_function(name, span)),
            _ => {
                let message = format!("`{name}` is no array of functions");
                Err(self.fault(
                    span,
                    message,
                    "an array of functions is declared, `function lift: [m; 2](rad), C3;`",
                ))
            }
        }
    }

    /// Value of a name that is no declared value.
    fn name(&mut self, name: &str, place: (&[Instruction], usize), span: Span) -> Result<Value, Fault> {
        match self.names.get(name) {
            Some(Symbol::Count(count)) => {
                let count = *count as f64;
                return Ok(Value::scalar(self.number_literal(count, span), span));
            }
            Some(Symbol::Function(Callable { length: Some(length), .. })) => {
                let length = *length;
                return Err(functions::bare_array(self, (name, 0), length, span));
            }
            Some(Symbol::Function(_)) => {
                let message = format!("`{name}` is a function");
                return Err(self.fault(span, message, format!("write `{name}(…)`")));
            }
            Some(Symbol::Curve(curve)) => {
                let help = match curve.form {
                    CurveForm::Polar(_) => {
                        format!("write `A on {name}` in a constraint, or `distance(A, {name})`")
                    }
                    CurveForm::Parametric(_) => {
                        format!(
                            "write `place(w, {name})`, or `foot w of A on {name} within 8mm near 90deg;`; on another curve it has a place, \
                             `foot w of {name} at v on cam`"
                        )
                    }
                };
                return Err(self.fault(span, format!("`{name}` is a curve"), help));
            }
            Some(Symbol::Pending) => return Err(self.too_early(name, span)),
            Some(Symbol::Later) => return Err(self.of_forces(name, span)),
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
}

//! The value of an expression: its postfix code on a stack of values.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use mbs_codegen::syntax_tree::{Expression, Operation, Operator, SUFFIXES, StatementKind, Unit};

use super::curves::Curve;
use super::functions;
use super::laws::Laws;
use super::mechanics::by_name;
use super::number::Number;
use super::tree::{Placed, Round};

/// A part of the language that the oracle does not evaluate, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap(pub String);

/// A scalar, or an array with the lengths of its dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Lengths; none of a scalar.
    pub shape: Vec<usize>,
    /// Components, the last index the fastest.
    pub items: Vec<Number>,
}

impl Value {
    /// A scalar.
    pub fn scalar(number: Number) -> Self {
        Value { shape: Vec::new(), items: vec![number] }
    }

    /// A vector.
    pub fn vector(items: Vec<Number>) -> Self {
        Value { shape: vec![items.len()], items }
    }

    /// The number that it is.
    pub fn number(&self) -> Result<Number, Gap> {
        match self.items.as_slice() {
            [number] => Ok(*number),
            items => Err(Gap(format!("{} components in place of a scalar", items.len()))),
        }
    }

    /// The count that it is.
    pub fn count(&self) -> Result<usize, Gap> {
        let value = self.number()?.value.v;
        if value >= 0.0 && value.fract() == 0.0 {
            Ok(value as usize)
        } else {
            Err(Gap(format!("{value} as a count")))
        }
    }
}

/// A definition, with the rounds of the loops that it stands in.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Its rounds.
    pub rounds: Vec<Round>,
    /// Its expression.
    pub value: Expression,
}

/// Names with their values at a state.
#[derive(Debug, Default)]
pub struct Names {
    /// Constants, parameters and inputs.
    pub given: Rc<BTreeMap<String, Value>>,
    /// Coordinates and first-order states.
    pub moving: BTreeMap<String, Value>,
    /// `let`s by name; those of loops once a round.
    pub definitions: Rc<BTreeMap<String, Vec<Definition>>>,
    /// The statements.
    pub placed: Rc<Vec<Placed>>,
    /// Deflections (m) of bristles by the places of their frictions among the statements.
    pub bristles: BTreeMap<usize, f64>,
    /// Functions of the caller.
    pub laws: Rc<Laws>,
    /// Curves in the order of the text.
    pub curves: Rc<Vec<Curve>>,
    /// λ of the rows of each constraint and drive.
    pub lambda: BTreeMap<String, Vec<Number>>,
    /// The time.
    pub time: Number,
    /// Values of `let`s that were asked for at this state, by name and place in the list.
    pub known: RefCell<BTreeMap<(String, usize), Value>>,
}

/// Names as a statement sees them.
#[derive(Clone, Copy, Debug)]
pub struct Scope<'a> {
    names: &'a Names,
    rounds: &'a [Round],
    depth: usize,
}

/// Deepest chain of definitions that use each other.
const DEEPEST: usize = 200;

impl<'a> Scope<'a> {
    /// Names in the rounds of loops.
    pub fn of(names: &'a Names, rounds: &'a [Round]) -> Self {
        Scope { names, rounds, depth: 0 }
    }

    /// The same names in other rounds.
    pub fn within<'b>(&self, rounds: &'b [Round]) -> Scope<'b>
    where
        'a: 'b,
    {
        Scope { names: self.names, rounds, depth: self.depth }
    }

    /// Functions of the caller.
    pub fn laws(&self) -> &'a Laws {
        &self.names.laws
    }

    /// Deflection (m) of the bristles of a friction by its place among the statements.
    pub fn deflection(&self, index: usize) -> f64 {
        self.names.bristles.get(&index).copied().unwrap_or(f64::NAN)
    }

    /// Place among the statements of an element or a load, of those in loops the one of a number or of the same rounds.
    fn element(&self, name: &str, number: Option<usize>) -> Option<usize> {
        let is_it = |placed: &Placed| match &placed.kind {
            StatementKind::Element { name: own, .. } | StatementKind::Load { name: own, .. } => {
                own.text == name
            }
            _ => false,
        };
        let is_seen = |placed: &Placed| {
            placed.rounds.len() <= self.rounds.len()
                && placed.rounds.iter().zip(self.rounds).all(|(own, round)| own.id == round.id)
        };
        let mut all = self.names.placed.iter().enumerate().filter(|(_, placed)| is_it(placed));
        let found = match number {
            Some(number) => all.nth(number),
            None => all.find(|(_, placed)| is_seen(placed)),
        };
        found.map(|(index, _)| index)
    }

    /// Place among the statements of the element whose normal force is the whole of an expression.
    pub fn referred(&self, expression: &Expression) -> Option<usize> {
        let (last, number) = expression.code.split_last()?;
        let Operation::Reference { function, targets } = &last.operation else { return None };
        let [target] = targets.as_slice() else { return None };
        let number = match target.indexed {
            true => Some(value(&Expression { code: number.to_vec() }, self).ok()?.count().ok()?),
            false => None,
        };
        matches!(function.as_str(), "normal" | "force").then(|| self.element(&target.name.text, number))?
    }

    /// The statement at a place, and its names.
    pub fn statement(&self, index: usize) -> Option<(&'a StatementKind, Scope<'a>)> {
        let placed = self.names.placed.get(index)?;
        Some((&placed.kind, Scope { names: self.names, rounds: &placed.rounds, depth: self.depth + 1 }))
    }

    /// Number of the curve `name` among all.
    pub fn curve(&self, name: &str) -> Option<usize> {
        let is_seen = |curve: &Curve| {
            curve.name == name
                && curve.rounds.len() <= self.rounds.len()
                && curve.rounds.iter().zip(self.rounds).all(|(own, round)| own.id == round.id)
        };
        self.names.curves.iter().rposition(is_seen)
    }

    fn name(&self, name: &str) -> Result<Value, Gap> {
        if let Some(round) = self.rounds.iter().rev().find(|round| round.variable == name) {
            return Ok(Value::scalar(Number::still(round.count as f64)));
        }
        if let Some(value) = self.names.moving.get(name).or_else(|| self.names.given.get(name)) {
            return Ok(value.clone());
        }
        match name {
            "t" => return Ok(Value::scalar(self.names.time)),
            "PI" => return Ok(Value::scalar(Number::still(core::f64::consts::PI))),
            "TAU" => return Ok(Value::scalar(Number::still(core::f64::consts::TAU))),
            _ => {}
        }
        // The name of a curve stands for its number, which its functions take.
        if let Some(index) = self.curve(name) {
            return Ok(Value::scalar(Number::still(index as f64)));
        }
        // Of the names of a text without faults those of events and of what they latch are left.
        let all = self.names.definitions.get(name);
        let all = all.ok_or_else(|| Gap(format!("event or latch `{name}`, which a motion alone knows")))?;
        let is_seen = |definition: &Definition| {
            definition.rounds.len() <= self.rounds.len()
                && definition.rounds.iter().zip(self.rounds).all(|(own, round)| own.id == round.id)
        };
        let seen = all.iter().enumerate().filter(|(_, definition)| is_seen(definition));
        let (index, definition) = seen
            .max_by_key(|(_, definition)| definition.rounds.len())
            .ok_or_else(|| Gap(format!("`{name}` outside of its loop")))?;
        let key = (name.to_string(), index);
        if let Some(value) = self.names.known.borrow().get(&key) {
            return Ok(value.clone());
        }
        if self.depth > DEEPEST {
            return Err(Gap(format!("a chain of more than {DEEPEST} definitions at `{name}`")));
        }
        let inner = Scope { names: self.names, rounds: &definition.rounds, depth: self.depth + 1 };
        let found = value(&definition.value, &inner)?;
        self.names.known.borrow_mut().insert(key, found.clone());
        Ok(found)
    }
}

/// The sum that is being added up.
struct Sum {
    round: Round,
    high: usize,
    total: Option<Value>,
}

/// The value of an expression.
pub fn value(expression: &Expression, scope: &Scope<'_>) -> Result<Value, Gap> {
    let mut stack: Vec<Value> = Vec::new();
    let mut sums: Vec<Sum> = Vec::new();
    let mut rounds: Vec<Round> = scope.rounds.to_vec();
    let mut next = 0;
    while let Some(instruction) = expression.code.get(next) {
        next += 1;
        let result = match &instruction.operation {
            Operation::Number { value, unit, .. } => {
                Value::scalar(Number::still(in_si(*value, unit.as_ref())?))
            }
            Operation::Name(name) => Scope { rounds: &rounds, ..*scope }.name(name)?,
            Operation::Negate => {
                let a = pop(&mut stack)?;
                Value { items: a.items.into_iter().map(|item| -item).collect(), ..a }
            }
            Operation::Binary(operator) => {
                let (b, a) = (pop(&mut stack)?, pop(&mut stack)?);
                joined(*operator, a, b)?
            }
            Operation::Call { function, order, indexed, .. } if scope.laws().has(function) => {
                let x = pop(&mut stack)?.number()?;
                let index = if *indexed { Some(pop(&mut stack)?.count()?) } else { None };
                Value::scalar(scope.laws().call(function, index, usize::from(*order), x)?)
            }
            Operation::Call { function, indexed: true, .. } => {
                return Err(Gap(format!("`{function}` of the caller")));
            }
            Operation::Call { function, order: 0, arguments: 2, .. }
                if matches!(function.as_str(), "distance" | "outward" | "place") =>
            {
                let (number, argument) = (pop(&mut stack)?.count()?, pop(&mut stack)?);
                let curve = scope.names.curves.get(number);
                let curve = curve.ok_or_else(|| Gap(format!("`{function}` of no curve")))?;
                curve.call(function, &argument, scope)?
            }
            Operation::Call { function, order: 0, arguments, indexed: false } => {
                let arguments = pop_many(&mut stack, *arguments)?;
                functions::call(function, arguments)?
            }
            Operation::Call { function, .. } => return Err(Gap(format!("the derivative of `{function}`"))),
            Operation::Array { length } => {
                let items = pop_many(&mut stack, *length)?;
                let mut shape = vec![items.len()];
                shape.extend(items.first().map(|first| first.shape.clone()).unwrap_or_default());
                Value { shape, items: items.into_iter().flat_map(|item| item.items).collect() }
            }
            Operation::Index { indices } => {
                let indices = pop_many(&mut stack, *indices)?;
                component(pop(&mut stack)?, &indices)?
            }
            Operation::SumBegin { variable, end } => {
                let (high, low) = (pop(&mut stack)?.count()?, pop(&mut stack)?.count()?);
                if low >= high {
                    stack.push(Value::scalar(Number::still(0.0)));
                    next = end + 1;
                    continue;
                }
                let round = Round { id: usize::MAX, variable: variable.text.clone(), count: low };
                rounds.push(round.clone());
                sums.push(Sum { round, high, total: None });
                continue;
            }
            Operation::SumEnd { begin } => {
                let term = pop(&mut stack)?;
                let sum = sums.last_mut().ok_or_else(|| Gap("a sum without a begin".to_string()))?;
                let total = match sum.total.take() {
                    None => term,
                    Some(total) => joined(Operator::Add, total, term)?,
                };
                sum.round.count += 1;
                rounds.pop();
                if sum.round.count < sum.high {
                    rounds.push(sum.round.clone());
                    sum.total = Some(total);
                    next = begin + 1;
                    continue;
                }
                sums.pop();
                total
            }
            Operation::Reference { function, targets } => {
                let [target] = targets.as_slice() else { return Err(Gap(format!("`{function}`"))) };
                let index = if target.indexed { Some(pop(&mut stack)?.count()?) } else { None };
                let own = Scope { rounds: &rounds, ..*scope };
                if let Some(element) = own.element(&target.name.text, index) {
                    stack.push(by_name(function, element, &own)?);
                    continue;
                }
                let rows = scope.names.lambda.get(&target.name.text);
                let rows = rows.ok_or_else(|| Gap(format!("`{function}({})`", target.name.text)))?;
                let sign = match function.as_str() {
                    "lambda" => 1.0,
                    "effort" => -1.0,
                    _ => return Err(Gap(format!("`{function}({}, …)`", target.name.text))),
                };
                let items: Vec<Number> = rows.iter().map(|row| *row * Number::still(sign)).collect();
                match (index, items.as_slice()) {
                    (None, [only]) => Value::scalar(*only),
                    (None, _) => Value::vector(items),
                    (Some(index), _) => {
                        let item =
                            items.get(index).ok_or_else(|| Gap("a row beyond the last".to_string()))?;
                        Value::scalar(*item)
                    }
                }
            }
        };
        stack.push(result);
    }
    pop(&mut stack)
}

fn pop(stack: &mut Vec<Value>) -> Result<Value, Gap> {
    stack.pop().ok_or_else(|| Gap("an operand is missing".to_string()))
}

fn pop_many(stack: &mut Vec<Value>, count: usize) -> Result<Vec<Value>, Gap> {
    let rest = stack.len().checked_sub(count).ok_or_else(|| Gap("an operand is missing".to_string()))?;
    Ok(stack.split_off(rest))
}

/// A number with its unit, in SI.
fn in_si(number: f64, unit: Option<&Unit>) -> Result<f64, Gap> {
    let mut value = number;
    for (symbol, exponent) in unit.iter().flat_map(|unit| &unit.factors) {
        if let Some((_, factor, divisor, _)) = SUFFIXES.iter().find(|(name, ..)| *name == symbol.text) {
            let scaled = |value: f64, [factor, divisor]: [f64; 2]| {
                if *exponent > 0.0 { value * factor / divisor } else { value / factor * divisor }
            };
            for _ in 0..exponent.abs() as u32 {
                value = scaled(value, [*factor, *divisor]);
            }
            if exponent.fract() != 0.0 {
                value = scaled(value, [factor.sqrt(), divisor.sqrt()]);
            }
        }
    }
    Ok(value)
}

fn component(base: Value, indices: &[Value]) -> Result<Value, Gap> {
    let mut offset = 0;
    for (index, length) in indices.iter().zip(&base.shape) {
        offset = offset * length + index.count()?;
    }
    let shape: Vec<usize> = base.shape.iter().copied().skip(indices.len()).collect();
    let length = shape.iter().product::<usize>();
    let items = base.items.get(offset * length..(offset + 1) * length);
    let items = items.ok_or_else(|| Gap("an index beyond the last".to_string()))?.to_vec();
    Ok(Value { shape, items })
}

/// Two values joined by an operator.
pub fn joined(operator: Operator, a: Value, b: Value) -> Result<Value, Gap> {
    let each = |f: &dyn Fn(Number, Number) -> Number, a: &Value, b: &Value| {
        let items = a.items.iter().zip(&b.items).map(|(a, b)| f(*a, *b)).collect();
        Value { shape: a.shape.clone(), items }
    };
    let scaled = |factor: Number, of: &Value| Value {
        shape: of.shape.clone(),
        items: of.items.iter().map(|item| factor * *item).collect(),
    };
    Ok(match operator {
        Operator::Add | Operator::Subtract if a.shape != b.shape => {
            return Err(Gap("a sum of different shapes".to_string()));
        }
        Operator::Add => each(&|a, b| a + b, &a, &b),
        Operator::Subtract => each(&|a, b| a - b, &a, &b),
        Operator::Multiply => match (a.shape.as_slice(), b.shape.as_slice()) {
            ([], _) => scaled(a.number()?, &b),
            (_, []) => scaled(b.number()?, &a),
            ([rows, columns], [length]) if columns == length => {
                let row = |row: &[Number]| {
                    let products = row.iter().zip(&b.items).map(|(a, b)| *a * *b);
                    products.fold(Number::still(0.0), |sum, product| sum + product)
                };
                Value { shape: vec![*rows], items: a.items.chunks((*columns).max(1)).map(row).collect() }
            }
            _ => return Err(Gap("a product of arrays".to_string())),
        },
        Operator::Divide => {
            let divisor = b.number()?;
            Value { shape: a.shape.clone(), items: a.items.iter().map(|item| *item / divisor).collect() }
        }
        Operator::Power => {
            let power = a.number()?.power(b.number()?);
            Value::scalar(power.ok_or_else(|| Gap("this power".to_string()))?)
        }
    })
}

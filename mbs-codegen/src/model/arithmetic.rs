//! Arithmetic on values: shapes and units of operators, checked at the offending operand.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::unit_faults::{Place, UnitOf};
use super::unit_inference::Bare;
use super::units::Dimension;
use super::uses::OF_ANGLES;
use super::value::{Fault, Quantity, Scalar, Value};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Operator;

impl Elaborator<'_> {
    /// Joins two values.
    pub fn operator(&mut self, operator: Operator, a: &Value, b: &Value, span: Span) -> Result<Value, Fault> {
        match operator {
            Operator::Add => self.sum(Binary::Add, a, b, span),
            Operator::Subtract => self.sum(Binary::Subtract, a, b, span),
            Operator::Multiply => self.product(a, b, span),
            Operator::Divide => {
                let divisor = self.scalar(b, "a division", b.span)?;
                self.each(a, span, |work, item| {
                    let quantity =
                        Quantity::Known(item.quantity.dimension().over(divisor.quantity.dimension()));
                    let quantity = if item.quantity == Quantity::Any { Quantity::Any } else { quantity };
                    work.binary_scalar(Binary::Divide, item, divisor, quantity, span)
                })
            }
            Operator::Power => self.power(a, b, span),
        }
    }

    fn sum(&mut self, function: Binary, a: &Value, b: &Value, span: Span) -> Result<Value, Fault> {
        // A 0, as of a `sum` without terms, is one of any shape.
        let (a, b) = (&a.spread_zero(b), &b.spread_zero(a));
        if a.shape != b.shape {
            return Err(self.fault(
                b.span,
                format!("{} and {} cannot be added", a.describe(), b.describe()),
                "both operands need the same shape",
            ));
        }
        let mut items = Vec::new();
        for (x, y) in a.items.iter().zip(&b.items) {
            let quantity = self.agree(*x, *y)?;
            items.push(self.binary_scalar(function, *x, *y, quantity, span)?);
        }
        Ok(Value { shape: a.shape.clone(), items, span })
    }

    fn product(&mut self, a: &Value, b: &Value, span: Span) -> Result<Value, Fault> {
        match (a.shape.as_slice(), b.shape.as_slice(), a.items.as_slice(), b.items.as_slice()) {
            ([], _, [factor], _) => self.each(b, span, |work, item| work.multiply(*factor, item, span)),
            (_, [], _, [factor]) => self.each(a, span, |work, item| work.multiply(item, *factor, span)),
            ([rows, columns], [length], _, _) if columns == length => {
                let mut items = Vec::new();
                for row in a.items.chunks((*columns).max(1)) {
                    items.push(self.sum_of_products(row.iter().copied().zip(b.items.iter().copied()), span)?);
                }
                Ok(Value { shape: vec![*rows], items, span })
            }
            _ => Err(self.fault(
                b.span,
                format!("{} times {} has no meaning", a.describe(), b.describe()),
                "multiply by a scalar, write `dot(a, b)` or `cross(a, b)`, or `rot(phi)*v`, `rotate(e, v)`",
            )),
        }
    }

    /// The product of two scalars.
    pub fn multiply(&mut self, a: Scalar, b: Scalar, span: Span) -> Result<Scalar, Fault> {
        let quantity = match (a.quantity, b.quantity) {
            (Quantity::Any, _) | (_, Quantity::Any) => Quantity::Any,
            (Quantity::Known(x), Quantity::Known(y)) => {
                // TAU radians are one cycle: `TAU*50Hz` is an angular speed.
                let turns = |work: &Self, s: Scalar| {
                    work.expressions.node(s.id) == Node::Number(std::f64::consts::TAU)
                };
                let product = x.times(y);
                Quantity::Known(if turns(self, a) || turns(self, b) {
                    product.without_cycles()
                } else {
                    product
                })
            }
        };
        self.binary_scalar(Binary::Multiply, a, b, quantity, span)
    }

    fn power(&mut self, a: &Value, b: &Value, span: Span) -> Result<Value, Fault> {
        let (base, exponent) = (self.scalar(a, "a power", a.span)?, self.scalar(b, "a power", b.span)?);
        self.number(exponent, "an exponent", b.span)?;
        let quantity = match self.expressions.node(exponent.id) {
            Node::Number(power) => self.root(base.quantity, power, span)?,
            _ => {
                self.number(base, "the base of a variable exponent", a.span)?;
                Quantity::Known(Dimension::NUMBER)
            }
        };
        self.binary(Binary::Power, base, exponent, quantity, span)
    }

    /// Unit of a power.
    pub fn root(&mut self, quantity: Quantity, exponent: f64, span: Span) -> Result<Quantity, Fault> {
        let Quantity::Known(dimension) = quantity else { return Ok(Quantity::Any) };
        match dimension.power(exponent) {
            Some(power) => Ok(Quantity::Known(power)),
            None => Err(self.fault(
                span,
                format!("`{dimension}` to the power of {exponent} is no unit"),
                "divide by a reference quantity first, so that the base is a number",
            )),
        }
    }

    /// Applies a scalar function to every component.
    pub fn each(
        &mut self,
        a: &Value,
        span: Span,
        mut function: impl FnMut(&mut Self, Scalar) -> Result<Scalar, Fault>,
    ) -> Result<Value, Fault> {
        let items = a.items.iter().map(|item| function(self, *item)).collect::<Result<_, _>>()?;
        Ok(Value { shape: a.shape.clone(), items, span })
    }

    /// A function of one scalar.
    pub fn unary(
        &mut self,
        function: Unary,
        a: Scalar,
        quantity: Quantity,
        span: Span,
    ) -> Result<Value, Fault> {
        Ok(Value::scalar(self.unary_scalar(function, a, quantity, span)?, span))
    }

    /// A function of one scalar.
    pub fn unary_scalar(
        &mut self,
        function: Unary,
        a: Scalar,
        quantity: Quantity,
        span: Span,
    ) -> Result<Scalar, Fault> {
        let id = self.push_unary(function, a.id, span)?;
        self.expressions.inherit_length(id, quantity.dimension(), [a.id].into_iter());
        Ok(Scalar { id, quantity, bare: Bare::unary(function, a.bare), span })
    }

    /// A function of two scalars.
    pub fn binary(
        &mut self,
        function: Binary,
        a: Scalar,
        b: Scalar,
        quantity: Quantity,
        span: Span,
    ) -> Result<Value, Fault> {
        Ok(Value::scalar(self.binary_scalar(function, a, b, quantity, span)?, span))
    }

    /// A function of two scalars.
    pub fn binary_scalar(
        &mut self,
        function: Binary,
        a: Scalar,
        b: Scalar,
        quantity: Quantity,
        span: Span,
    ) -> Result<Scalar, Fault> {
        let id = self.push_binary(function, a.id, b.id, span)?;
        self.expressions.inherit_length(id, quantity.dimension(), [a.id, b.id].into_iter());
        Ok(Scalar { id, quantity, bare: Bare::binary(function, a.bare, b.bare), span })
    }

    /// `Σ aᵢ bᵢ`, all terms of one unit.
    pub fn sum_of_products(
        &mut self,
        pairs: impl Iterator<Item = (Scalar, Scalar)>,
        span: Span,
    ) -> Result<Scalar, Fault> {
        let mut total: Option<Scalar> = None;
        for (a, b) in pairs {
            let term = self.multiply(a, b, span)?;
            total = Some(match total {
                None => term,
                Some(total) => {
                    let quantity = self.agree(total, term)?;
                    self.binary_scalar(Binary::Add, total, term, quantity, span)?
                }
            });
        }
        total.ok_or(Fault)
    }

    /// `a₀ b₁ − a₁ b₀`.
    pub fn determinant2(&mut self, a: [Scalar; 2], b: [Scalar; 2], span: Span) -> Result<Scalar, Fault> {
        let (first, second) = (self.multiply(a[0], b[1], span)?, self.multiply(a[1], b[0], span)?);
        let quantity = self.agree(first, second)?;
        self.binary_scalar(Binary::Subtract, first, second, quantity, span)
    }

    /// Two operands of one unit; otherwise both units are printed at the second.
    pub fn agree(&mut self, a: Scalar, b: Scalar) -> Result<Quantity, Fault> {
        match (a.quantity, b.quantity) {
            (Quantity::Any, other) | (other, Quantity::Any) => Ok(other),
            (Quantity::Known(x), Quantity::Known(y)) if x == y => Ok(a.quantity),
            (Quantity::Known(x), Quantity::Known(y)) => {
                let help = if x.without_cycles() == y.without_cycles() {
                    "a cycle is TAU radians: multiply the frequency by `TAU`"
                } else if a.bare == Bare::Wholly || b.bare == Bare::Wholly {
                    "a bare number has no unit; write it with one: `100mm`, `30deg`"
                } else {
                    "bring both sides to one unit"
                };
                let message = format!("units differ: `{y}` here, `{x}` on the other side");
                Err(self.unit_fault((Place::Terms, b, UnitOf::scalar(a)), message, help))
            }
        }
    }

    /// A pure number or an angle.
    pub fn number(&mut self, scalar: Scalar, what: &str, span: Span) -> Result<(), Fault> {
        match scalar.quantity {
            Quantity::Known(unit) if unit != Dimension::NUMBER => Err(self.fault(
                span,
                format!("{what} has the unit `{unit}`; it must be a number or an angle"),
                "divide it by a quantity of the same unit",
            )),
            _ => Ok(()),
        }
    }

    /// The argument of a function that takes an angle or a number.
    pub fn argument_of(&mut self, function: &str, scalar: Scalar, span: Span) -> Result<(), Fault> {
        let Quantity::Known(unit) = scalar.quantity else { return Ok(()) };
        let is_angle = OF_ANGLES.contains(&function);
        if unit == Dimension::NUMBER {
            return Ok(());
        }
        let message = format!("the argument of `{function}` is in `{unit}`; it must be a number or an angle");
        let wanted = UnitOf { dimension: Dimension::NUMBER, is_angle };
        let place = Place::Argument(function.to_owned());
        Err(self.unit_fault(
            (place, Scalar { span, ..scalar }, wanted),
            message,
            "divide it by a quantity of the same unit",
        ))
    }

    /// The only component of a scalar.
    pub fn scalar(&mut self, value: &Value, user: &str, span: Span) -> Result<Scalar, Fault> {
        match value.items.as_slice() {
            [item] if value.shape.is_empty() => Ok(*item),
            _ => Err(self.wrong_shape(user, "a scalar", value, span)),
        }
    }

    /// A vector of any length.
    pub fn vector(&mut self, value: &Value, user: &str, span: Span) -> Result<(), Fault> {
        if value.shape.len() == 1 { Ok(()) } else { Err(self.wrong_shape(user, "a vector", value, span)) }
    }

    /// Two values of one shape.
    pub fn same_shape(&mut self, a: &Value, b: &Value, user: &str, span: Span) -> Result<(), Fault> {
        if a.shape == b.shape {
            return Ok(());
        }
        let message = format!("{user} joins {} and {}", a.describe(), b.describe());
        Err(self.fault(span, message, "both need the same shape"))
    }

    /// Reports a shape that does not fit.
    pub fn wrong_shape(&mut self, user: &str, expected: &str, found: &Value, span: Span) -> Fault {
        let message = format!("{user} takes {expected}, not {}", found.describe());
        self.fault(span, message, "take a component `v[0]`, or build a vector `[x, y]`")
    }

    /// Reports a wrong number of arguments.
    pub fn arity(&mut self, function: &str, expected: &str, found: usize, span: Span) -> Fault {
        let parameters = match function {
            "atan2" => "y, x",
            "unit" | "rot" => "phi",
            "det" => "m",
            "norm" => "v",
            "rotate" => "e, v",
            "angular_velocity" => "e",
            "d" => "z, u",
            "distance" | "outward" => "A, cam",
            "place" => "w, cam",
            "dot" | "cross" | "min" | "max" | "hypot" => "a, b",
            _ => "x",
        };
        let message = format!("`{function}` takes {expected}, not {found}");
        self.fault(span, message, format!("write `{function}({parameters})`"))
    }

    /// Arguments in the number that the function takes.
    pub fn arguments<const K: usize>(
        &mut self,
        function: &str,
        arguments: Vec<Value>,
        span: Span,
    ) -> Result<[Value; K], Fault> {
        let found = arguments.len();
        let expected = if K == 1 { "1 argument".into() } else { format!("{K} arguments") };
        arguments.try_into().map_err(|_| self.arity(function, &expected, found, span))
    }
}

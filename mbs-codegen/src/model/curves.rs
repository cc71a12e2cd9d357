//! Curves, points on them, distances to them and their normals, as rows and functions of the text.
//!
//! A polar curve is star-shaped: r = R(w − θ) about its centre C, w the angle of a point A seen from C. It has one row, r − R, and no
//! coordinate of its own. A circle that rolls on a contour is a point, its centre, on the pitch curve, which lies the circle's radius
//! outside. So every curve here is one of points.
//!
//! A parametric curve has two components over a parameter. It has places alone; points beside it have feet.

use std::f64::consts::TAU;

use proc_macro2::Span;

use super::declarations::Declarations;
use super::elaborator::Elaborator;
use super::names::{Callable, Curve, CurveForm, Symbol};
use super::resolver::Resolver;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use super::{ConstraintRow, functions};
use crate::diagnostics::nearest;
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::{Expression, Instruction, Name, Operation, Operator};

/// Relative error of a period as a part of a turn: that of its decimals.
const OF_PERIOD: f64 = 1e-12;

/// A point as a curve sees it.
struct Seen {
    /// From the centre (m).
    from: [Scalar; 2],
    /// Distance to the centre.
    r: Scalar,
    /// R there.
    radius: Scalar,
    /// Polar angle in the axes of the curve.
    angle: Scalar,
    /// The polar radius as a function.
    of: (Callable, String),
}

impl Declarations<'_> {
    /// The curve of a declaration, and the quantities that must be allowed where it is used.
    pub(super) fn curve(
        &mut self,
        centre: &Expression,
        turned: &Expression,
        functions: &[(Expression, Option<Expression>)],
    ) -> Result<(Curve, Reach), Fault> {
        let is_polar = functions.len() == 1;
        let read: Vec<_> = functions
            .iter()
            .map(|(call, number)| self.curve_function(call, number.as_ref(), is_polar))
            .collect();
        let form = match read.into_iter().collect::<Result<Vec<_>, Fault>>()?.as_slice() {
            [radius] => CurveForm::Polar(radius.clone()),
            [x, y] => CurveForm::Parametric([x.clone(), y.clone()]),
            _ => return Err(Fault),
        };
        self.elaborate(|work| {
            work.reach = Reach::Let;
            let (centre, turned) = (work.value(centre), work.value(turned));
            let (centre, turned) = (centre?, turned?);
            is_point(work, &centre, "the centre of a curve")?;
            let angle = work.scalar(&turned, "`turned`", turned.span)?;
            work.number(angle, "the angle of a curve", turned.span)?;
            Ok((Curve { form: form.clone(), centre, turned }, work.needs))
        })
    }

    /// A polar radius, or a component of a parametric curve: a length over an angle that closes after a turn.
    fn curve_function(
        &mut self,
        call: &Expression,
        number: Option<&Expression>,
        is_polar: bool,
    ) -> Result<(Callable, String), Fault> {
        let Some(Instruction { operation: Operation::Call { function, .. }, span }) = call.code.last() else {
            return Err(Fault);
        };
        let what = if is_polar { "polar radius" } else { "component of a closed curve" };
        let (callable, function) = match self.names.get(function) {
            Some(Symbol::Function(callable)) => self.one_of((*callable, function), number, *span)?,
            Some(Symbol::Faulty) => return Err(Fault),
            _ => {
                let message = format!("`{function}` is no declared function");
                let help = format!("declare the {what}: `function {function}: m(rad), C3, periodic TAU;`");
                self.diagnostics.report(*span, message, help);
                return Err(Fault);
            }
        };
        let declared = self.model.functions.get(callable.index);
        let turns = declared.and_then(|function| function.period).map(|period| TAU / period);
        // A curve that closes in a part of a turn would be gone through twice, so each of its places would have two parameters.
        let closes = turns.is_some_and(|turns| {
            let whole = if is_polar { turns.round() } else { 1.0 };
            (turns - whole).abs() <= OF_PERIOD * turns
        });
        let of_angle = callable.unit == Dimension::METRE && callable.argument == Dimension::NUMBER;
        if !closes || !of_angle {
            let message = match is_polar {
                true => {
                    format!("`{function}` is no polar radius: a length over an angle, closed after a turn")
                }
                false => format!(
                    "`{function}` is no component of a closed curve: a length over an angle, with the period TAU"
                ),
            };
            let name = declared.map_or(function.as_str(), |declared| &declared.name.text);
            let unit = match declared.and_then(|declared| declared.array) {
                Some(array) => format!("[m; {}]", array.length),
                None => "m".into(),
            };
            let help = format!("declare it as `function {name}: {unit}(rad), C3, periodic TAU;`");
            self.diagnostics.report(*span, message, help);
            return Err(Fault);
        }
        Ok((callable, function))
    }

    /// The function of a curve, and its name; one of an array by its number.
    fn one_of(
        &mut self,
        (function, name): (Callable, &str),
        number: Option<&Expression>,
        span: Span,
    ) -> Result<(Callable, String), Fault> {
        self.elaborate(|work| match (number, function.length) {
            (Some(number), _) => {
                let number = work.value(number)?;
                functions::element(work, function, name, &number, span)
            }
            (None, Some(length)) => Err(functions::bare_array(work, (name, 0), length, span)),
            (None, None) => Ok((function, name.to_owned())),
        })
    }
}

/// Two components in metres.
fn is_point(work: &mut Elaborator<'_>, value: &Value, what: &str) -> Result<[Scalar; 2], Fault> {
    let [x, y] = value.items.as_slice() else {
        return Err(work.wrong_shape(what, "a point of 2 components", value, value.span));
    };
    if value.shape.len() != 1 {
        return Err(work.wrong_shape(what, "a point of 2 components", value, value.span));
    }
    let metre = Scalar { quantity: Quantity::Known(Dimension::METRE), bare: Bare::Not, ..*x };
    work.agree(metre, *x)?;
    work.agree(metre, *y)?;
    Ok([*x, *y])
}

impl Elaborator<'_> {
    /// `distance(A, curve)`, `outward(A, curve)` or `place(w, curve)`, where `curve` is the instruction before the call.
    pub(super) fn of_curve(
        &mut self,
        function: &str,
        curve: Option<&Instruction>,
        arguments: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        let point = arguments.into_iter().next().ok_or(Fault)?;
        let curve = match curve {
            Some(Instruction { operation: Operation::Name(name), span }) => self.curve_of(name, *span)?,
            _ => {
                let help = match function {
                    "place" => "write `place(w, cam)`, an angle and a curve".to_string(),
                    _ => format!(
                        "write `{function}(A, cam)`, a point and a curve; between points it is `norm(A - B)`"
                    ),
                };
                return Err(self.fault(span, format!("`{function}` ends with no curve"), help));
            }
        };
        if function == "place" {
            return self.place(&curve, &point, span);
        }
        let seen = self.seen(&curve, function, &point, span)?;
        let slope = self.of_angle(&seen.of, 1, seen.angle, span)?;
        // 1/√(1 + (R′/r)²) = r/√(r² + R′²), with no quotient that another one waits for.
        let length = self.binary_scalar(Binary::Hypot, seen.r, slope, seen.r.quantity, span)?;
        match function {
            "distance" => {
                let gap = self.binary_scalar(Binary::Subtract, seen.r, seen.radius, seen.r.quantity, span)?;
                let cosine = self.over(seen.r, length, span)?;
                Ok(Value::scalar(self.multiply(gap, cosine, span)?, span))
            }
            _ => {
                // r e_r − R′ e_t, over its length.
                let [x, y] = seen.from;
                let slope = self.over(slope, seen.r, span)?;
                let [of_x, of_y] = [self.multiply(slope, x, span)?, self.multiply(slope, y, span)?];
                let x = self.binary_scalar(Binary::Add, x, of_y, x.quantity, span)?;
                let y = self.binary_scalar(Binary::Subtract, y, of_x, y.quantity, span)?;
                let items = vec![self.over(x, length, span)?, self.over(y, length, span)?];
                Ok(Value { shape: vec![2], items, span })
            }
        }
    }

    /// The point of the curve at the polar angle or parameter `angle` in its own axes: C + R(w) e(w + θ), or C + rot(θ) [x(w), y(w)].
    fn place(&mut self, curve: &Curve, angle: &Value, span: Span) -> Result<Value, Fault> {
        let angle = self.scalar(angle, "`place`", angle.span)?;
        self.number(angle, "the place on a curve", angle.span)?;
        let radius = match &curve.form {
            CurveForm::Polar(radius) => self.of_angle(radius, 0, angle, span)?,
            CurveForm::Parametric([x, y]) => {
                let items = vec![self.of_angle(x, 0, angle, span)?, self.of_angle(y, 0, angle, span)?];
                let turned = functions::call(self, "rot", vec![curve.turned.clone()], span)?;
                let place = Value { shape: vec![2], items, span };
                let place = self.operator(Operator::Multiply, &turned, &place, span)?;
                return self.operator(Operator::Add, &curve.centre, &place, span);
            }
        };
        let turned = self.scalar(&curve.turned, "`turned`", span)?;
        let number = Quantity::Known(Dimension::NUMBER);
        let direction = self.binary_scalar(Binary::Add, angle, turned, number, span)?;
        let mut items = Vec::new();
        for (function, centre) in [Unary::Cos, Unary::Sin].into_iter().zip(&curve.centre.items) {
            let part = self.unary_scalar(function, direction, number, span)?;
            let part = self.multiply(radius, part, span)?;
            items.push(self.binary_scalar(Binary::Add, *centre, part, radius.quantity, span)?);
        }
        Ok(Value { shape: vec![2], items, span })
    }

    /// The curve of a name.
    fn curve_of(&mut self, name: &str, span: Span) -> Result<Curve, Fault> {
        match self.names.get(name) {
            Some(Symbol::Curve(curve)) => {
                let curve = (**curve).clone();
                self.allows(name, span)?;
                return Ok(curve);
            }
            Some(Symbol::Faulty | Symbol::Pending) => return Err(Fault),
            _ => {}
        }
        let help = match nearest(name, self.names.curves()) {
            Some(known) => format!("did you mean `{known}`?"),
            None if self.names.get(name).is_some() => {
                "name a curve, declared `curve cam = polar R about C turned theta;`; between points it is `norm(A - B)`".into()
            }
            None => format!("declare it: `curve {name} = polar R about C turned theta;`"),
        };
        Err(self.fault(span, format!("`{name}` is no curve"), help))
    }

    /// `function` is the function of the language, or `on`.
    fn seen(&mut self, curve: &Curve, function: &str, point: &Value, span: Span) -> Result<Seen, Fault> {
        let CurveForm::Polar(of) = &curve.form else {
            let then = match function {
                "on" => "and the row `w_gap == 0m;`",
                "outward" => "its normal is `w_normal`",
                _ => "its distance is `w_gap`",
            };
            let message = format!("`{function}` sees a curve from its centre, and this one is parametric");
            let help = format!("write `foot w of A on rim within 8mm near 0deg;`, {then}");
            return Err(self.fault(span, message, help));
        };
        is_point(self, point, "a point on a curve")?;
        let from = self.operator(Operator::Subtract, point, &curve.centre, span)?;
        let [x, y] = from.items.as_slice() else { return Err(Fault) };
        let [x, y] = [*x, *y];
        let r = self.binary_scalar(Binary::Hypot, x, y, Quantity::Known(Dimension::METRE), span)?;
        let number = Quantity::Known(Dimension::NUMBER);
        let polar = self.binary_scalar(Binary::Atan2, y, x, number, span)?;
        let turned = self.scalar(&curve.turned, "`turned`", span)?;
        let angle = self.binary_scalar(Binary::Subtract, polar, turned, number, span)?;
        let radius = self.of_angle(of, 0, angle, span)?;
        Ok(Seen { from: [x, y], r, radius, angle, of: of.clone() })
    }

    /// A function of a curve, or its derivative of this order, at an angle.
    fn of_angle(
        &mut self,
        (function, name): &(Callable, String),
        order: u8,
        angle: Scalar,
        span: Span,
    ) -> Result<Scalar, Fault> {
        let angle = Value::scalar(angle, span);
        let value = functions::call_declared(self, *function, (name, order), vec![angle], span)?;
        self.scalar(&value, "a curve", span)
    }

    fn over(&mut self, a: Scalar, b: Scalar, span: Span) -> Result<Scalar, Fault> {
        let quantity = Quantity::Known(a.quantity.dimension().over(b.quantity.dimension()));
        self.binary_scalar(Binary::Divide, a, b, quantity, span)
    }
}

impl Resolver<'_> {
    /// Adds the row of `point on curve`.
    pub(super) fn on_curve(
        &mut self,
        point: &Expression,
        curve: &Name,
        span: Span,
        group: usize,
    ) -> Result<(), Fault> {
        let residual = self.elaborate(Reach::Position, |work| {
            let (point, curve) = (work.value(point), work.curve_of(&curve.text, curve.span));
            let seen = work.seen(&curve?, "on", &point?, span)?;
            work.binary_scalar(Binary::Subtract, seen.r, seen.radius, seen.r.quantity, span)
        })?;
        self.push_row(
            group,
            ConstraintRow {
                name: String::new(),
                dimension: Dimension::METRE,
                residual: residual.id,
                driven: false,
                reversed: false,
                redundant: false,
                within: None,
                span,
            },
        );
        Ok(())
    }
}

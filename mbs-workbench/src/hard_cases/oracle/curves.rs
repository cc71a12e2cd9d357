//! Curves by their polar radius about a centre, or by two components; points beside them.

use mbs_codegen::syntax_tree::{Expression, Operation};

use super::evaluation::{Gap, Scope, Value, value};
use super::functions::dot;
use super::number::Number;
use super::tree::Round;

/// A curve as the text declares it, with the rounds of the loops that it stands in.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Its rounds.
    pub rounds: Vec<Round>,
    /// Its centre.
    pub centre: Expression,
    /// The angle by which it is turned.
    pub turned: Expression,
    /// Its polar radius, or its two components: a call, and the number in an array of functions.
    pub functions: Vec<(Expression, Option<Expression>)>,
}

/// A curve at a state.
struct Placed<'a> {
    /// Names of its functions, and their numbers in arrays.
    functions: Vec<(&'a str, Option<usize>)>,
    centre: [Number; 2],
    angle: Number,
    scope: Scope<'a>,
}

/// A point in polar coordinates about the centre, in the axes of the curve.
struct Seen {
    /// Distance and direction from the centre.
    r: Number,
    direction: [Number; 2],
    /// Polar angle.
    w: Number,
}

fn two(value: &Value) -> Result<[Number; 2], Gap> {
    value.items.as_slice().try_into().map_err(|_| Gap("a curve beyond the plane".to_string()))
}

impl Curve {
    /// Names of its functions and their numbers in arrays.
    fn called<'a>(&'a self, scope: &Scope<'_>) -> Result<Vec<(&'a str, Option<usize>)>, Gap> {
        let functions = self.functions.iter().map(|(call, number)| {
            let Some(Operation::Call { function, .. }) = call.code.last().map(|call| &call.operation) else {
                return Err(Gap(format!("the curve `{}`", self.name)));
            };
            let index = number.as_ref().map(|number| value(number, scope)?.count()).transpose()?;
            Ok((function.as_str(), index))
        });
        functions.collect()
    }

    /// Its functions as the text calls them, `pitch` or `rim[0]`.
    pub fn labels(&self, scope: &Scope<'_>) -> Result<Vec<String>, Gap> {
        let label = |(name, index): (&str, Option<usize>)| match index {
            Some(index) => format!("{name}[{index}]"),
            None => name.to_string(),
        };
        Ok(self.called(&scope.within(&self.rounds))?.into_iter().map(label).collect())
    }

    fn placed<'a>(&'a self, scope: &Scope<'a>) -> Result<Placed<'a>, Gap> {
        let scope = scope.within(&self.rounds);
        let functions = self.called(&scope)?;
        let angle = value(&self.turned, &scope)?.number()?;
        let centre = two(&value(&self.centre, &scope)?)?;
        Ok(Placed { functions, centre, angle, scope })
    }

    /// r − R of a point: 0 on the curve.
    pub fn row(&self, point: &Value, scope: &Scope<'_>) -> Result<Number, Gap> {
        let placed = self.placed(scope)?;
        let seen = placed.seen(two(point)?)?;
        Ok(seen.r - placed.radius(seen.w, 0)?)
    }

    /// `distance(A, cam)`, `outward(A, cam)` or `place(w, cam)`.
    pub fn call(&self, function: &str, argument: &Value, scope: &Scope<'_>) -> Result<Value, Gap> {
        let placed = self.placed(scope)?;
        if function == "place" {
            let w = argument.number()?;
            if placed.functions.len() == 2 {
                let [x, y] = [placed.function(0, w, 0)?, placed.function(1, w, 0)?];
                let [cosine, sine] = unit(placed.angle)?;
                let place = [cosine * x - sine * y, sine * x + cosine * y];
                return Ok(Value::vector([0, 1].map(|k| placed.centre[k] + place[k]).to_vec()));
            }
            let radius = placed.radius(w, 0)?;
            let direction = unit(w + placed.angle)?;
            let place = [0, 1].map(|k| placed.centre[k] + radius * direction[k]);
            return Ok(Value::vector(place.to_vec()));
        }
        let Seen { r, direction: [x, y], w } = placed.seen(two(argument)?)?;
        let (radius, tilt) = (placed.radius(w, 0)?, placed.radius(w, 1)? / r);
        let length = Number::still(1.0).hypot(tilt);
        match function {
            "distance" => Ok(Value::scalar((r - radius) / length)),
            // e_r − (R′/r) e_w, made a unit vector.
            "outward" => Ok(Value::vector(vec![(x + tilt * y) / length, (y - tilt * x) / length])),
            _ => Err(Gap(format!("`{function}` of the curve `{}`", self.name))),
        }
    }
}

fn unit(angle: Number) -> Result<[Number; 2], Gap> {
    let part = |name| angle.function(name).ok_or_else(|| Gap("an angle".to_string()));
    Ok([part("cos")?, part("sin")?])
}

impl Placed<'_> {
    fn radius(&self, w: Number, order: usize) -> Result<Number, Gap> {
        match self.functions.len() {
            1 => self.function(0, w, order),
            _ => Err(Gap("the polar radius of a parametric curve".to_string())),
        }
    }

    fn function(&self, place: usize, w: Number, order: usize) -> Result<Number, Gap> {
        let (name, index) = *self.functions.get(place).ok_or_else(|| Gap("a curve".to_string()))?;
        self.scope.laws().call(name, index, order, w)
    }

    fn seen(&self, point: [Number; 2]) -> Result<Seen, Gap> {
        let from = [0, 1].map(|k| point[k] - self.centre[k]);
        let r = dot(&from, &from).function("sqrt").ok_or_else(|| Gap("a distance".to_string()))?;
        let w = from[1].atan2(from[0]) - self.angle;
        Ok(Seen { r, direction: from.map(|part| part / r), w })
    }
}

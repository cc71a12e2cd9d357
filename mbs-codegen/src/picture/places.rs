//! Points, angles and directions by their names in the text.

use std::collections::BTreeMap;

use proc_macro2::Span;

use super::found::{Found, Outside, Unit, component, first, numbered};
use crate::diagnostics::{Diagnostics, nearest};
use crate::model::dynamics::{Action, Dynamics};
use crate::model::elaborator::Elaborator;
use crate::model::expression::{Expressions, Id};
use crate::model::names::{Names, Symbol};
use crate::model::unit_inference::Bare;
use crate::model::units::Dimension;
use crate::model::value::Fault;
use crate::model::value::Reach;
use crate::model::value::{Quantity, Value};
use crate::model::{Model, Output};
use crate::syntax::ast::Expression;
use crate::syntax::picture as written;

/// A point, an angle or a direction of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name in the shapes. That of an output is the output's; parts are joined by points, `rod.2.com`.
    pub name: String,
    /// Meaning of its components.
    pub kind: PlaceKind,
    /// `true` where an output of the text has the name.
    pub is_output: bool,
    /// `false` where its value calls a function of the caller or uses multipliers or states: only the mechanism itself can
    /// evaluate such an output.
    pub is_evaluated: bool,
}

/// Meaning of the components of a [`Place`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    /// A point of a plane (m): two components.
    Point,
    /// A point in space (m): three components.
    PointInSpace,
    /// An angle (rad): one component.
    Angle,
    /// A direction: two components.
    Direction,
    /// A direction in space: three components.
    DirectionInSpace,
}

impl PlaceKind {
    /// Number of components.
    pub fn components(self) -> usize {
        match self {
            PlaceKind::Angle => 1,
            PlaceKind::Point | PlaceKind::Direction => 2,
            PlaceKind::PointInSpace | PlaceKind::DirectionInSpace => 3,
        }
    }
}

/// Use of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    Point,
    Angle,
    Direction,
}

/// A place with the expressions of its components.
#[derive(Debug)]
pub struct Known {
    pub place: Place,
    pub ids: Vec<Id>,
    /// Its first use.
    pub span: Span,
}

/// Looks names up in a scene, and keeps what was found.
pub struct Places<'a> {
    pub model: &'a Model,
    pub names: &'a mut Names,
    pub expressions: &'a mut Expressions,
    pub diagnostics: &'a mut Diagnostics,
    pub known: Vec<Known>,
    /// Counts of the loops that are being unrolled, the outermost first.
    pub rounds: Vec<usize>,
    by_name: BTreeMap<String, usize>,
    /// Reason why the text alone cannot evaluate each expression so far.
    outside: Vec<Option<Outside>>,
    outputs: BTreeMap<&'a str, &'a Output>,
}

impl<'a> Places<'a> {
    pub fn new(
        model: &'a Model,
        names: &'a mut Names,
        expressions: &'a mut Expressions,
        diagnostics: &'a mut Diagnostics,
    ) -> Self {
        let loads = model.dynamics.iter().flat_map(|dynamics| &dynamics.loads);
        let outputs =
            model.outputs.iter().chain(loads).map(|output| (output.name.as_str(), output)).collect();
        let (known, rounds, by_name) = (Vec::new(), Vec::new(), BTreeMap::new());
        let outside = Vec::new();
        Places { model, names, expressions, diagnostics, known, rounds, by_name, outside, outputs }
    }

    /// Takes over places that are known already.
    pub fn keep(&mut self, known: Vec<Known>) {
        for known in known {
            self.by_name.insert(known.place.name.clone(), self.known.len());
            self.known.push(known);
        }
    }

    pub fn elaborate<T>(&mut self, run: impl FnOnce(&mut Elaborator<'_>) -> T) -> T {
        run(&mut Elaborator {
            expressions: self.expressions,
            names: self.names,
            diagnostics: self.diagnostics,
            reach: Reach::Position,
            needs: Reach::Position,
            groups: &[],
        })
    }

    pub fn fault(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Fault {
        self.diagnostics.report(span, message, help);
        Fault
    }

    /// Counts in brackets.
    pub fn counts(&mut self, indices: &[Expression]) -> Result<Vec<usize>, Fault> {
        self.elaborate(|work| {
            let counts = indices.iter().map(|index| {
                let value = work.value(index)?;
                work.count(&value)
            });
            counts.collect()
        })
    }

    /// Before: a name as written. After: the name of its place, which is known; or the fault reported.
    pub fn place(&mut self, place: &written::Place, wanted: Wanted) -> Result<String, Fault> {
        let counts = self.counts(&place.indices)?;
        let found = self.find(place, &counts)?;
        let kind = self.kind(place, &found, wanted)?;
        self.note(found, kind, place.name.span)
    }

    /// A point of the model, which needs no check.
    pub fn point(&mut self, name: String, ids: &[Id], is_output: bool) -> Result<String, Fault> {
        let kind = if ids.len() == 2 { PlaceKind::Point } else { PlaceKind::PointInSpace };
        self.note(Found { is_output, ..Found::point(name, ids) }, kind, Span::call_site())
    }

    /// Value of a name with its counts: a `let` of a loop, an output, a pin, a value; with a part, a point of a body or spring.
    fn find(&mut self, place: &written::Place, counts: &[usize]) -> Result<Found, Fault> {
        let name = numbered(&place.name.text, counts);
        if let Some(part) = &place.part {
            return match self.part(&name, &part.text) {
                Some(ids) => Ok(Found::point(format!("{name}.{}", part.text), &ids)),
                None => Err(self.unknown(place, &format!("{name}.{}", part.text))),
            };
        }
        if self.names.is_scoped(&place.name.text) {
            let found = self.value(place, counts, &name)?;
            return Ok(Found { name: self.of_round(name, &found.ids), ..found });
        }
        if let Some(found) = self.output(&name) {
            return Ok(found);
        }
        let pins = self.model.dynamics.iter().flat_map(|dynamics| &dynamics.pins);
        if let Some(pin) = pins.into_iter().find(|pin| pin.name == name) {
            return Ok(Found::point(name, &pin.at));
        }
        self.value(place, counts, &name)
    }

    /// `true` if an output, or the first component of one, has this name.
    pub fn is_output(&self, name: &str) -> bool {
        self.output(name).is_some()
    }

    /// The output of this name, with its components.
    fn output(&self, name: &str) -> Option<Found> {
        let found = |outputs: Vec<&Output>, shape: Vec<usize>| {
            let said = outputs.first().map(|output| output.unit.clone()).unwrap_or_default();
            let ids = outputs.iter().map(|output| output.value).collect();
            Found { name: name.to_owned(), ids, shape, unit: Unit::written(&said), said, is_output: true }
        };
        if let Some(output) = self.outputs.get(name) {
            return Some(found(vec![output], Vec::new()));
        }
        let component = |index: usize| self.outputs.get(format!("{name}.{index}").as_str()).copied();
        let components: Vec<&Output> = (0..).map_while(component).collect();
        if !components.is_empty() {
            let length = components.len();
            return Some(found(components, vec![length]));
        }
        // Rows of an array.
        let is_array = self.outputs.contains_key(format!("{name}.0.0").as_str());
        is_array.then(|| found(Vec::new(), vec![0, 0]))
    }

    /// The value of this name, its array indexed.
    fn value(&mut self, place: &written::Place, counts: &[usize], name: &str) -> Result<Found, Fault> {
        let value = match self.names.get(&place.name.text) {
            Some(Symbol::Value(value)) => value,
            Some(Symbol::Pending | Symbol::Later | Symbol::Faulty) => return Err(Fault),
            Some(Symbol::Function(_) | Symbol::Curve(_) | Symbol::Count(_)) | None => {
                return Err(self.unknown(place, name));
            }
        };
        let Some((shape, items)) = component(value, counts) else { return Err(self.unknown(place, name)) };
        let (ids, unit) = (items.iter().map(|item| item.id).collect(), Unit::of(items));
        let mut units = items.iter().filter_map(|item| match item.quantity {
            Quantity::Known(dimension) if !matches!(item.bare, Bare::Wholly | Bare::Zero) => Some(dimension),
            _ => None,
        });
        // The first of several units that is no length.
        let first = units.next();
        let said = units
            .find(|unit| *unit != Dimension::METRE)
            .or(first)
            .map(|unit| unit.to_string())
            .unwrap_or_default();
        Ok(Found { name: name.to_owned(), ids, shape, unit, said, is_output: false })
    }

    /// Centre of mass of a body, end of a spring.
    fn part(&self, name: &str, part: &str) -> Option<Vec<Id>> {
        let dynamics = self.model.dynamics.as_ref()?;
        if part == COM {
            return dynamics.bodies.iter().find(|body| body.name == name).map(|body| body.com.clone());
        }
        lines(dynamics).find(|(known, ..)| *known == name).and_then(|(_, from, to)| match part {
            "from" => Some(from.to_vec()),
            "to" => Some(to.to_vec()),
            _ => None,
        })
    }

    /// Name of a loop's point, which differs in each round.
    fn of_round(&self, name: String, ids: &[Id]) -> String {
        let mut name = numbered(&name, &self.rounds);
        let differs = |place: &usize| self.known.get(*place).is_some_and(|known| known.ids != ids);
        while self.by_name.get(&name).is_some_and(differs) || self.output(&name).is_some() {
            name.push('\'');
        }
        name
    }

    /// Components and unit as its use needs them.
    fn kind(&mut self, place: &written::Place, found: &Found, wanted: Wanted) -> Result<PlaceKind, Fault> {
        let (is_length, is_number) = (found.unit.fits(Unit::Metre), found.unit.fits(Unit::Number));
        match (wanted, found.shape.as_slice()) {
            (Wanted::Point, [2]) if is_length => Ok(PlaceKind::Point),
            (Wanted::Point, [3]) if is_length => Ok(PlaceKind::PointInSpace),
            (Wanted::Angle | Wanted::Direction, []) if is_number => Ok(PlaceKind::Angle),
            (Wanted::Direction, [2]) => Ok(PlaceKind::Direction),
            (Wanted::Direction, [3]) => Ok(PlaceKind::DirectionInSpace),
            _ => Err(self.misfit(place, found, wanted)),
        }
    }

    fn misfit(&mut self, place: &written::Place, found: &Found, wanted: Wanted) -> Fault {
        let value = Value { shape: found.shape.clone(), items: Vec::new(), span: place.name.span };
        let what = match found.shape.as_slice() {
            [_, _, ..] => "an array".into(),
            _ => value.describe(),
        };
        let fits = matches!(
            (wanted, found.shape.as_slice()),
            (Wanted::Point, [2 | 3]) | (Wanted::Angle | Wanted::Direction, [])
        );
        let (noun, help) = match wanted {
            Wanted::Point if fits => ("point", "a point is a vector of 2 or 3 components in `m`"),
            Wanted::Point if found.shape.len() > 1 => ("point", "take one of its points by a count: `P[0]`"),
            Wanted::Point => ("point", "a point is a vector of 2 or 3 components in `m`: `let P = [x, y];`"),
            Wanted::Angle => ("angle", "an angle is a scalar in `rad`"),
            Wanted::Direction => {
                ("direction", "a direction is an angle in `rad` or a vector of 2 components")
            }
        };
        let message = match fits {
            true => format!("`{}` is no {noun}, its unit is `{}`", found.name, found.said),
            false => format!("`{}` is no {noun}, it is {what}", found.name),
        };
        self.fault(place.name.span, message, help)
    }

    /// Keeps a place under its name.
    fn note(&mut self, found: Found, kind: PlaceKind, span: Span) -> Result<String, Fault> {
        let Found { name, ids, is_output, .. } = found;
        if let Some(known) = self.by_name.get(&name).and_then(|place| self.known.get(*place))
            && known.ids == ids
        {
            return Ok(name);
        }
        let outside = self.outside(&ids);
        if let (Some(outside), false) = (outside, is_output) {
            let message = format!("the point `{name}` {}", outside.message());
            let help =
                format!("make it an output and draw that: `out {}: [m; 2] = …;`", name.replace('.', "_"));
            return Err(self.fault(span, message, help));
        }
        self.by_name.insert(name.clone(), self.known.len());
        let is_evaluated = outside.is_none();
        let place = Place { name: name.clone(), kind, is_output, is_evaluated };
        self.known.push(Known { place, ids, span });
        Ok(name)
    }

    /// Reason why the text alone cannot evaluate some expressions, if any.
    pub fn outside(&mut self, ids: &[Id]) -> Option<Outside> {
        for node in self.expressions.nodes_from(self.outside.len()) {
            let below = |id: Id| self.outside.get(id.index()).copied().flatten();
            self.outside.push(Outside::of(*node).or_else(|| node.operands().find_map(below)));
        }
        ids.iter().find_map(|id| self.outside.get(id.index()).copied().flatten())
    }

    fn unknown(&mut self, place: &written::Place, name: &str) -> Fault {
        let span = place.part.as_ref().map_or(place.name.span, |part| part.span);
        let span = if self.is_body(&place.name.text) { span } else { place.name.span };
        let mut known = self.all();
        known.sort();
        let near = nearest(name, known.iter().map(String::as_str));
        let help = match near {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if place.part.is_none() && self.is_body(&place.name.text) => {
                format!("draw its centre of mass, `{name}.{COM}`, or a point of it: `out P: [m; 2] = …;`")
            }
            None => format!("declare it: `out {}: [m; 2] = [x, y];` or `let {0} = [x, y];`", place.name.text),
        };
        self.fault(span, format!("unknown point `{name}`"), help)
    }

    fn is_body(&self, name: &str) -> bool {
        self.model.dynamics.iter().flat_map(|dynamics| &dynamics.bodies).any(|body| first(&body.name) == name)
    }

    /// Names that a point may have, as they are written.
    fn all(&self) -> Vec<String> {
        let outputs = self.outputs.keys().map(|name| first(name).to_owned());
        let values = self.names.all().filter(
            |name| matches!(self.names.get(name), Some(Symbol::Value(value)) if !value.shape.is_empty()),
        );
        let mut all: Vec<String> = outputs.chain(values.map(str::to_owned)).collect();
        if let Some(dynamics) = &self.model.dynamics {
            all.extend(dynamics.pins.iter().map(|pin| first(&pin.name).to_owned()));
            all.extend(dynamics.bodies.iter().map(|body| format!("{}.{COM}", body.name)));
            all.extend(lines(dynamics).flat_map(|(name, ..)| [format!("{name}.from"), format!("{name}.to")]));
        }
        all
    }
}

/// Centre of mass of a body.
pub const COM: &str = "com";

/// Springs between two points: name, begin, end.
pub fn lines(dynamics: &Dynamics) -> impl Iterator<Item = (&str, &[Id], &[Id])> {
    dynamics.forces.iter().filter_map(|force| match &force.action {
        Action::Line(line) => Some((force.name.as_str(), line.from.as_slice(), line.to.as_slice())),
        _ => None,
    })
}

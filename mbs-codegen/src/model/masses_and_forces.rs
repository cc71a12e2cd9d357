//! Statements of dynamics → model: fields, shapes and units checked.

use proc_macro2::Span;

use super::dynamics::{Action, Carrier, Dynamics, Force, Kinetic};
use super::elaborator::Elaborator;
use super::element_fields::{FieldKind, known};
use super::expression::{Id, Node};
use super::forces_by_name::Force as Seen;
use super::inertia::check_shape;
use super::initialiser::{fits_shape, initialiser};
use super::non_negative::{Least, NonNegative};
use super::resolver::Resolver;
use super::rotation::{moments, parameters};
use super::springs::SpringDamper;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Value};
use super::written::written;
use crate::diagnostics::nearest;
use crate::syntax::ast::{Element, Energy, Expression, Field, Joined, Load, Name, Statement, StatementKind};
use crate::syntax::meant_field;

/// `true` if the statement is one of masses or forces, so that the text is one of dynamics.
pub fn is_dynamic(statement: &Statement) -> bool {
    matches!(
        statement.kind,
        StatementKind::Element { .. }
            | StatementKind::Load { .. }
            | StatementKind::Energy { .. }
            | StatementKind::State { .. }
            | StatementKind::Rate { .. }
            | StatementKind::Event { .. }
            | StatementKind::Latch { .. }
    )
}

/// The fields of a tension that are points of bodies.
const ENDS: [&str; 2] = ["from", "to"];

/// The values of an element's fields, and its fields that are words.
pub(super) struct Given(Vec<(&'static str, Value)>, Vec<&'static str>);

impl Given {
    pub(super) fn value(&self, name: &str) -> Option<&Value> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// `true` if the field that is a word is given.
    pub(super) fn has(&self, word: &str) -> bool {
        self.1.contains(&word)
    }

    pub(super) fn scalar(&self, name: &str) -> Option<Id> {
        self.value(name).and_then(|value| value.items.first()).map(|item| item.id)
    }

    pub(super) fn vector(&self, name: &str) -> Vec<Id> {
        self.value(name).map(|value| value.items.iter().map(|item| item.id).collect()).unwrap_or_default()
    }
}

impl Resolver<'_> {
    /// Before: a body or an element as written. After: it is in the model, or its faults are reported.
    pub(super) fn element(&mut self, kind: Element, name: &Name, fields: &[Field]) -> Result<(), Fault> {
        let group = if kind == Element::Body { "body" } else { "force" };
        let full = self.numbered(name, group)?;
        let before =
            self.model.dynamics.as_ref().map_or((0, 0), |known| (known.signed.len(), known.forces.len()));
        let given =
            self.fields(kind, name, fields).inspect_err(|_| self.names.mark_faulty_element(&name.text))?;
        let read = match kind {
            Element::Body => self.body(name, full, &given),
            Element::Gravity => self.gravity(name, &given),
            Element::Tsda => self.line(name, full, &given, fields),
            Element::Friction => self.friction(name, full, &given),
            Element::Contact => self.contact(name, full, &given),
            Element::Rsda => self.turn(name, full, &given),
        };
        // Nothing is left of a friction whose normal force is that of a row which is not there.
        if kind == Element::Friction && read.is_ok() && self.dynamics().forces.len() == before.1 {
            self.dynamics().signed.truncate(before.0);
        }
        // Uses of its force are no faults of their own.
        read.inspect_err(|_| self.names.mark_faulty_element(&name.text))
    }

    fn line(&mut self, name: &Name, full: String, given: &Given, fields: &[Field]) -> Result<(), Fault> {
        let (from, to) = (given.vector("from"), given.vector("to"));
        if from.len() != to.len() {
            let message =
                format!("`{}` joins points of {} and of {} components", name.text, from.len(), to.len());
            return Err(self.fault(name.span, message, "give both points in one plane or space"));
        }
        let constant = ["stiffness", "length"].iter().filter_map(|field| given.scalar(field));
        let stores = constant.into_iter().all(|id| self.model.is_constant(id));
        let line = SpringDamper {
            from,
            to,
            stiffness: given.scalar("stiffness"),
            length: given.scalar("length"),
            damping: given.scalar("damping"),
            actuator: given.scalar("actuator"),
            stores,
        };
        let mut carriers = [None, None];
        for (carrier, end) in carriers.iter_mut().zip(ENDS) {
            let field = fields.iter().find(|field| field.name.text == end);
            *carrier = self.carrier(field.and_then(|field| field.of.as_ref()))?;
        }
        self.names.seen.define(&name.text, Seen::Line(line.clone()));
        self.force_on(name, full, Action::Line(line), carriers);
        Ok(())
    }

    /// Before: fields as written. After: values of all that are known; others, and missing ones, are reported.
    fn fields(&mut self, kind: Element, name: &Name, fields: &[Field]) -> Result<Given, Fault> {
        let (kind_of, known) = (kind, known(kind));
        let mut given = Given(Vec::new(), Vec::new());
        let mut faulty = false;
        // A required field that another name was meant for is not missing too.
        let mut misspelled: Vec<&str> = Vec::new();
        let is_given = |wanted: &str| fields.iter().any(|field| field.name.text == wanted);
        for field in fields {
            let found = known.iter().find(|(known, ..)| *known == field.name.text);
            let Some((known_name, kind, _)) = found else {
                let names: Vec<&str> = known.iter().map(|(known, ..)| *known).collect();
                let begins = |name: &&str| field.name.text.len() > 2 && name.starts_with(&field.name.text);
                let near = nearest(&field.name.text, names.iter().copied());
                let meant = meant_field(&field.name.text, &names)
                    .or(near)
                    .or_else(|| names.iter().copied().find(|name| begins(name)));
                misspelled.extend(meant);
                let help = match meant.filter(|meant| !is_given(meant)) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("known are {}", names.join(", ")),
                };
                let message = format!("`{}` has no field `{}`", name.text, field.name.text);
                let _reported = self.fault(field.name.span, message, help);
                faulty = true;
                continue;
            };
            if given.value(known_name).is_some() || given.has(known_name) {
                let message = format!("field `{known_name}` is given twice");
                let _reported = self.fault(field.name.span, message, "remove one of them");
                faulty = true;
            }
            if let Some(of) =
                field.of.as_ref().filter(|_| kind_of != Element::Tsda || !ENDS.contains(known_name))
            {
                let message = format!("`{known_name}` is no point that acts on a body");
                let help = "leave out `of …`: it stands behind the ends of a `tsda`, and behind the point of a `force`";
                let _reported = self.fault(of.name.span, message, help);
                faulty = true;
            }
            if let FieldKind::Word(word) = kind {
                faulty |= self.word(field, word).is_err();
                given.1.push(known_name);
                continue;
            }
            match self.field(field, *kind) {
                Ok(value) => {
                    let rigid = kind_of == Element::Contact && !is_given("stiffness");
                    let value = self.signed(known_name, name, (value, rigid));
                    given.0.push((known_name, value));
                }
                Err(Fault) => faulty = true,
            }
        }
        // Friction with stiction or bristles needs no speed at which it is smooth.
        let spared = |name: &str| {
            name == "speed" && (is_given("sticks") || is_given("bristles"))
                || name == "stiffness" && is_given("restitution")
        };
        let is_missing = |name: &str| !is_given(name) && !misspelled.contains(&name) && !spared(name);
        for (missing, ..) in known.iter().filter(|(known, _, needed)| *needed && is_missing(known)) {
            let (message, help) = match (kind_of, *missing) {
                (Element::Friction, "speed") => (
                    format!("`{}` has neither `speed` nor `sticks`", name.text),
                    "write `speed: …` for a law that is smooth below it, or `sticks: …` for one that sticks"
                        .into(),
                ),
                _ => (
                    format!("`{}` has no field `{missing}`", name.text),
                    format!("write `{missing}: …` in its braces"),
                ),
            };
            let _reported = self.fault(name.span, message, help);
            faulty = true;
        }
        if faulty { Err(Fault) } else { Ok(given) }
    }

    /// Keeps values that have a least one, to be checked with all others; entries of an inertia off its diagonal have none. The
    /// law goes on with 1 in place of a number that it cannot divide by, for quotients of numbers are computed at once.
    fn signed(&mut self, field: &'static str, name: &Name, (mut value, rigid): (Value, bool)) -> Value {
        let Some(least) = Least::of(field) else { return value };
        // Of a rigid contact nothing divides by it.
        let least = if rigid && field == "restitution" { Least::Zero } else { least };
        let (of, span) = (name.text.clone(), value.span);
        for item in value.items.iter_mut().take(3) {
            let signed = NonNegative { field, least, of: of.clone(), value: item.id, span };
            let node = self.model.expressions.node(item.id);
            self.dynamics().signed.push(signed);
            if least == Least::AboveZero && matches!(node, Node::Number(number) if number <= 0.0) {
                item.id = self.model.expressions.push(Node::Number(1.0));
            }
        }
        value
    }

    fn word(&mut self, field: &Field, word: &str) -> Result<(), Fault> {
        let given = written(&field.value.code);
        if given == word {
            return Ok(());
        }
        let message = format!("`{}` is `{given}`", field.name.text);
        Err(self.fault(
            field.name.span,
            message,
            format!("write `{}: {word}`, or leave it out", field.name.text),
        ))
    }

    fn field(&mut self, field: &Field, kind: FieldKind) -> Result<Value, Fault> {
        let (dimension, reach) = match kind {
            FieldKind::Constant(dimension) | FieldKind::Vector(dimension) => (dimension, Reach::Position),
            FieldKind::Scalar(dimension, reach) => (dimension, reach),
            FieldKind::Point => (Dimension::METRE, Reach::Position),
            FieldKind::Inertia => (Dimension::INERTIA, Reach::Position),
            FieldKind::Orientation | FieldKind::Word(_) => (Dimension::NUMBER, Reach::Position),
        };
        let user = format!("`{}`", field.name.text);
        let value = self.elaborate(reach, |work| {
            if matches!(field.name.text.as_str(), "angle" | "rest") {
                work.bare_angles(&field.value.code)?;
            }
            let value = work.value(&field.value)?;
            let place = Place::Field(field.name.text.clone());
            let value =
                work.concerning(place, (&field.value, None), |work| initialiser(work, value, dimension))?;
            match kind {
                FieldKind::Constant(_) | FieldKind::Scalar(..) => fits_shape(work, &value, &[])?,
                FieldKind::Vector(_) if value.shape.is_empty() => {
                    let message = format!("{user} takes a vector of 2 or of 3 components, not a scalar");
                    let help = format!("write it with its direction: `[0, {}]`", written(&field.value.code));
                    return Err(work.fault(value.span, message, help));
                }
                FieldKind::Point | FieldKind::Vector(_) => point(work, &value, &user)?,
                FieldKind::Inertia => check_shape(work, &value)?,
                FieldKind::Orientation => parameters(work, &value, &user).map(|_| ())?,
                FieldKind::Word(_) => {}
            }
            Ok::<_, Fault>(value)
        })?;
        if reach == Reach::Position {
            self.stateless(&value)?;
        }
        let varies = |work: &Self, item: Id, allowed: fn(Node) -> bool| !work.model.made_of(item, allowed);
        for item in &value.items {
            if matches!(kind, FieldKind::Constant(_) | FieldKind::Inertia) && !self.model.is_constant(item.id)
            {
                let message = format!("{user} varies");
                let help = match field.name.text.as_str() {
                    "bound" => "make it of numbers and parameters: the largest of all of the motion",
                    _ => "make it of numbers and parameters; what varies is an energy: `kinetic T = …;`",
                };
                return Err(self.fault(value.span, message, help));
            }
            let free = |node: Node| !matches!(node, Node::Coordinate(_)) && !node.is_of_motion();
            if matches!(kind, FieldKind::Vector(_)) && varies(self, item.id, free) {
                let message = format!("{user} depends on where the mechanism is");
                return Err(self.fault(value.span, message, "write a field of forces as `potential V = …;`"));
            }
        }
        Ok(value)
    }

    /// `force … on P;` and `torque … on phi;`
    pub(super) fn load(
        &mut self,
        kind: Load,
        name: &Name,
        value: &Expression,
        (on, of): (&Expression, Option<&Joined>),
    ) -> Result<(), Fault> {
        let full = self.numbered(name, "force")?;
        let (dimension, along) = match kind {
            Load::Force => (Dimension::NEWTON, Dimension::METRE),
            Load::Torque => (Dimension::JOULE, Dimension::NUMBER),
        };
        let on = self.elaborate(Reach::Position, |work| {
            let written = on;
            let on = work.value(on)?;
            if kind == Load::Torque && on.shape != [4] {
                work.scalar(&on, "a torque", on.span)?;
            }
            let fits = |quantity| quantity == Quantity::Any || quantity == Quantity::Known(along);
            if let Some(item) = on.items.iter().find(|item| !fits(item.quantity)) {
                // A point is not meant as an angle: a unit of neither kind is one that does not fit.
                if ![Dimension::NUMBER, Dimension::METRE].contains(&item.quantity.dimension()) {
                    let place = Place::Field(name.text.clone());
                    return work.concerning(place, (written, None), |work| initialiser(work, on, along));
                }
                let message = match kind {
                    Load::Force => {
                        format!("a force acts on a point, not on a `{}`", item.quantity.dimension())
                    }
                    Load::Torque => {
                        format!("a torque acts on an angle, not on a `{}`", item.quantity.dimension())
                    }
                };
                let help = "write `force f: [fx, fy] on [x, y];` or `torque m: tau on phi;`, in space `torque m: [mx, my, mz] on e;`";
                return Err(work.fault(on.span, message, help));
            }
            Ok(on)
        })?;
        self.stateless(&on)?;
        let (given, value) = self.elaborate(Reach::Force, |work| {
            let written_value = value;
            let value = work.value(value)?;
            let place = Place::Field(name.text.clone());
            let given =
                work.concerning(place, (written_value, None), |work| initialiser(work, value, dimension))?;
            let mut value = given.clone();
            if kind == Load::Torque && on.shape == [4] {
                vector_of_three(work, &value)?;
                let parameters = parameters(work, &on, "a torque")?;
                value.items = moments(work, &value, parameters, value.span)?.to_vec();
            } else {
                if kind == Load::Force && value.shape.is_empty() && !on.shape.is_empty() {
                    let message =
                        format!("the force `{}` has one component, its point {}", name.text, on.items.len());
                    let force = written(&written_value.code);
                    let zeros = ", 0".repeat(on.items.len().saturating_sub(1));
                    let help = format!(
                        "write its components, `[{force}{zeros}] on …`, or the length that it acts along"
                    );
                    return Err(work.fault(value.span, message, help));
                }
                work.same_shape(&on, &value, "`on`", value.span)?;
            }
            Ok::<_, Fault>((given, value))
        })?;
        let pairs: Vec<_> = value.items.iter().zip(&on.items).map(|(value, on)| (value.id, on.id)).collect();
        self.names.seen.define(&name.text, Seen::Load { value: given, pairs: pairs.clone() });
        let carrier = self.carrier(of)?;
        self.force_on(name, full, Action::Work(pairs), [carrier, None]);
        Ok(())
    }

    /// `potential`, `kinetic` and `dissipation`.
    pub(super) fn energy(&mut self, kind: Energy, name: &Name, value: &Expression) -> Result<(), Fault> {
        let full = self.numbered(name, "force")?;
        let dimension = match kind {
            Energy::Dissipation => Dimension::JOULE.over(Dimension::SECOND),
            Energy::Potential | Energy::Kinetic => Dimension::JOULE,
        };
        let reach = if kind == Energy::Potential { Reach::Position } else { Reach::Force };
        let (value, span) = self.elaborate(reach, |work| {
            let written = value;
            let value = work.value(value)?;
            let place = Place::Field(name.text.clone());
            let value =
                work.concerning(place, (written, None), |work| initialiser(work, value, dimension))?;
            let scalar = work.scalar(&value, "an energy", value.span)?;
            Ok::<_, Fault>((scalar.id, value.span))
        })?;
        let stateless = |node: Node| !node.is_of_motion();
        if kind != Energy::Dissipation && !self.model.made_of(value, stateless) {
            let message = format!("the energy `{}` uses a state or a multiplier", name.text);
            let help =
                "energies are functions of the coordinates; write the force itself: `force f: … on P;`";
            return Err(self.fault(span, message, help));
        }
        match kind {
            Energy::Potential => self.dynamics().potentials.push(value),
            Energy::Kinetic => self.kinetic(name, full, value, span)?,
            Energy::Dissipation => self.force(name, full, Action::Dissipation(value)),
        }
        Ok(())
    }

    fn kinetic(&mut self, name: &Name, full: String, value: Id, span: Span) -> Result<(), Fault> {
        let model = &*self.model;
        let without_rates = |node| match node {
            Node::Variable(index) => {
                model.variables.get(index).is_none_or(|variable| variable.kind != super::VariableKind::Input)
            }
            _ => true,
        };
        if !model.made_of(value, without_rates) {
            let message = format!("the kinetic energy `{}` uses an input without rates", name.text);
            let help = "its momenta change as the input does: declare the input with `, rates`";
            return Err(self.fault(span, message, help));
        }
        self.dynamics().kinetics.push(Kinetic { name: full, value, span: name.span });
        Ok(())
    }

    pub(super) fn force(&mut self, name: &Name, full: String, action: Action) {
        self.force_on(name, full, action, [None, None]);
    }

    fn force_on(&mut self, name: &Name, full: String, action: Action, carriers: [Option<Carrier>; 2]) {
        if let Some(action) = self.present(action) {
            self.dynamics().forces.push(Force { name: full, action, carriers, span: name.span });
        }
    }

    /// The name of a statement, with its round in a loop.
    pub(super) fn numbered(&mut self, name: &Name, kind: &'static str) -> Result<String, Fault> {
        let group = self.group(name, kind)?;
        let round = self.rows_of(group);
        self.count_row(group, round);
        Ok(if self.loops.is_empty() { name.text.clone() } else { format!("{}.{round}", name.text) })
    }

    pub(super) fn fault(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Fault {
        self.diagnostics.report(span, message, help);
        Fault
    }

    pub(super) fn dynamics(&mut self) -> &mut Dynamics {
        self.model.dynamics.get_or_insert_default()
    }
}

/// A vector of two or three components.
fn point(work: &mut Elaborator<'_>, value: &Value, user: &str) -> Result<(), Fault> {
    match value.shape.as_slice() {
        [2 | 3] => Ok(()),
        _ => Err(work.wrong_shape(user, "a vector of 2 or of 3 components", value, value.span)),
    }
}

/// A torque in space.
fn vector_of_three(work: &mut Elaborator<'_>, value: &Value) -> Result<(), Fault> {
    match value.shape.as_slice() {
        [3] => Ok(()),
        _ => {
            Err(work.wrong_shape("a torque on an orientation", "a vector of 3 components", value, value.span))
        }
    }
}

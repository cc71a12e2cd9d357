//! Presets and spans: parameters and inputs of a scene by name, and values for them.

use super::Preset;
use super::content::Reader;
use super::found::numbered;
use crate::diagnostics::nearest;
use crate::model::declared_types::component_names;
use crate::model::initialiser::{filling, initialiser, numbers};
use crate::model::units::Dimension;
use crate::model::value::Fault;
use crate::model::{Role, Variable, VariableKind};
use crate::syntax::ast::Expression;
use crate::syntax::picture::{Label, Place, Setting};

/// Parts of inputs with rates.
const RATES: [&str; 2] = ["rate", "acceleration"];

/// A parameter or input, or an array of them.
struct Target {
    /// Name with its counts.
    name: String,
    /// Lengths of the rest of its array.
    shape: Vec<usize>,
    /// `.rate` or `.acceleration`, else empty.
    suffix: String,
    dimension: Dimension,
}

impl Reader<'_, '_> {
    pub fn preset(&mut self, label: &Label, description: &str, settings: &[Setting]) -> Result<(), Fault> {
        self.once(&format!("preset {}", label.text), label.span)?;
        let (mut set, mut faulty) = (Vec::new(), false);
        for setting in settings {
            match self.setting(setting) {
                Ok(values) => set.extend(values),
                Err(Fault) => faulty = true,
            }
        }
        if faulty {
            return Err(Fault);
        }
        let (label, description) = (label.text.clone(), description.to_owned());
        self.content.presets.push(Preset { label, description, set });
        Ok(())
    }

    /// Names of components and their values; none of a parameter that belongs to an effect which the scene leaves out.
    fn setting(&mut self, setting: &Setting) -> Result<Vec<(String, f64)>, Fault> {
        let name = &setting.place.name.text;
        let is_field = self.places.model.fields.iter().any(|field| field.name.text == *name);
        if !is_field && self.places.names.effect_of(name).is_some() {
            return Ok(Vec::new());
        }
        let Target { name, shape, suffix, dimension } = self.target(&setting.place)?;
        let values = self.places.elaborate(|work| {
            let value = work.value(&setting.value)?;
            let value = initialiser(work, value, dimension)?;
            let value = filling(work, value, &shape)?;
            numbers(work, &setting.value, &value, "a preset")
        })?;
        let names = component_names(&name, &shape).map(|name| name + &suffix);
        Ok(names.zip(values).collect())
    }

    /// The parameter or input of a name.
    fn target(&mut self, place: &Place) -> Result<Target, Fault> {
        let counts = self.places.counts(&place.indices)?;
        let fields = self.places.model.fields.iter().filter(|field| field.role != Role::Phase);
        let Some(field) = fields.clone().find(|field| field.name.text == place.name.text) else {
            let known: Vec<&str> = fields.map(|field| field.name.text.as_str()).collect();
            let help = match nearest(&place.name.text, known.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None if known.is_empty() => "the text declares none; write `param omega: rad/s = 10;`".into(),
                None => format!("known are {}", known.join(", ")),
            };
            let message = format!("`{}` is no parameter or input", place.name.text);
            return Err(self.places.fault(place.name.span, message, help));
        };
        let suffix = place.part.as_ref().map(|part| format!(".{}", part.text)).unwrap_or_default();
        let name = numbered(&place.name.text, &counts);
        let shape = field.shape.get(counts.len()..).map(<[usize]>::to_vec).unwrap_or_default();
        let first = component_names(&name, &shape).next().unwrap_or_default() + &suffix;
        let variable = self.places.model.variables.iter().find(|variable| variable.name == first);
        match variable {
            Some(Variable { dimension, .. }) => Ok(Target { name, shape, suffix, dimension: *dimension }),
            None => {
                let message = format!("`{}` has no component `{name}{suffix}`", place.name.text);
                let help = match &place.part {
                    Some(_) => format!("an input with rates has the parts {}", RATES.join(" and ")),
                    None => "components are counted from 0".into(),
                };
                Err(self.places.fault(place.name.span, message, help))
            }
        }
    }

    /// Name of the angular velocity of a turn.
    pub fn turn(&mut self, place: &Place) -> Result<String, Fault> {
        let Target { name, shape, suffix, dimension } = self.target(place)?;
        let name = name + &suffix;
        let variable = self.places.model.variables.iter().find(|variable| variable.name == name);
        let is_constant = variable.is_some_and(|variable| variable.kind != VariableKind::InputRate);
        if shape.is_empty() && is_constant && dimension == Dimension::NUMBER.over(Dimension::SECOND) {
            return Ok(name);
        }
        let message = format!("`{name}` is no angular velocity");
        let help = "name a scalar parameter or input in `rad/s`, or give the time: `span 2s;`";
        Err(self.places.fault(place.name.span, message, help))
    }

    /// A time (s).
    pub fn seconds(&mut self, time: &Expression) -> Result<f64, Fault> {
        let span = time.code.first().map(|instruction| instruction.span);
        let seconds = self.places.elaborate(|work| {
            let value = work.value(time)?;
            let value = initialiser(work, value, Dimension::SECOND)?;
            work.scalar(&value, "a span", value.span)?;
            numbers(work, time, &value, "a span")
        })?;
        match (seconds.as_slice(), span) {
            ([seconds], _) if *seconds > 0.0 => Ok(*seconds),
            (_, Some(span)) => Err(self.places.fault(span, "a span must be positive", "write `span 2s;`")),
            _ => Err(Fault),
        }
    }
}

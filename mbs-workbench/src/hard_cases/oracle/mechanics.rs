//! Masses, springs and loads of the text → energies, and forces along places.

use mbs_codegen::syntax_tree::{Element, Energy, Expression, Field, Load, StatementKind};

use super::evaluation::{Gap, Names, Scope, Value, value};
use super::functions::{angular_velocity, cross, dot};
use super::number::{Dual, Number};
use super::tree::Placed;

/// A force and the place that it moves along.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    /// Force (N, N m).
    pub force: f64,
    /// Place (m, rad).
    pub place: Number,
}

/// A force that the text does not give, with its place and its law.
#[derive(Clone, Debug)]
pub struct Held {
    /// Name in the text.
    pub name: String,
    /// Gap or length.
    pub place: Number,
    /// Its law.
    pub law: Law,
}

/// Law of a force that the text does not give.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    /// That of a rigid contact.
    Contact,
    /// That of a friction that sticks: coefficients at its speed and at rest, and c.
    Friction { normal: Normal, sliding: f64, holding: f64, viscous: f64 },
}

/// Normal force of a friction.
#[derive(Clone, Copy, Debug)]
pub enum Normal {
    /// A force (N).
    Force(f64),
    /// That of a rigid contact, by its place among all such laws.
    Of(usize),
}

/// Energies and forces of a state, one entry each a statement.
#[derive(Clone, Debug, Default)]
pub struct Mechanics {
    /// Kinetic energies (J).
    pub kinetic: Vec<Dual>,
    /// Potential energies (J).
    pub potential: Vec<Dual>,
    /// Forces that no energy holds.
    pub forces: Vec<Along>,
    /// Functions of dissipation (W).
    pub dissipation: Vec<Dual>,
    /// Rigid contacts and frictions that stick.
    pub held: Vec<Held>,
}

/// A body's mass (kg) with the components of its centre of mass (m).
type Heavy = (Number, Vec<Number>);

/// Energies and forces of all statements at the state of `names`.
pub fn mechanics(placed: &[Placed], names: &Names) -> Result<Mechanics, Gap> {
    let mut found = Mechanics::default();
    let mut heavy: Vec<Heavy> = Vec::new();
    let mut fields: Vec<Vec<Number>> = Vec::new();
    for (index, Placed { kind, rounds }) in placed.iter().enumerate() {
        let scope = Scope::of(names, rounds);
        match kind {
            StatementKind::Element { kind, name, fields: given } => {
                let fields_of = Fields { given, scope };
                match kind {
                    Element::Body => heavy.push(body(&fields_of, &mut found)?),
                    Element::Gravity => fields.push(fields_of.vector("acceleration")?),
                    Element::Tsda => {
                        let along = length(&fields_of)?;
                        sprung(&fields_of, along, ["length", "actuator"], &mut found)?;
                    }
                    Element::Rsda => {
                        let angle = fields_of.required("angle")?;
                        sprung(&fields_of, angle, ["rest", "torque"], &mut found)?;
                    }
                    Element::Friction => match friction(&fields_of, index)? {
                        Some(along) => found.forces.push(along),
                        None => found.held.push(sticking(&name.text, &fields_of, placed)?),
                    },
                    Element::Contact => match contact(&fields_of)? {
                        Some(along) => found.forces.push(along),
                        None => {
                            let (name, place) = (name.text.clone(), fields_of.required("gap")?);
                            found.held.push(Held { name, place, law: Law::Contact });
                        }
                    },
                }
            }
            StatementKind::Load { kind, value: force, on, .. } => {
                load(*kind, &value(force, &scope)?, value(on, &scope)?, &mut found)?;
            }
            StatementKind::Energy { kind, value: energy, .. } => {
                let energy = value(energy, &scope)?.number()?.value;
                match kind {
                    Energy::Potential => found.potential.push(energy),
                    Energy::Kinetic => found.kinetic.push(energy),
                    Energy::Dissipation => found.dissipation.push(energy),
                }
            }
            _ => {}
        }
    }
    for field in &fields {
        for (mass, com) in &heavy {
            if field.iter().all(|component| component.is_still()) {
                let height = dot(field, com);
                found.potential.push(-(mass.value * height.value));
                continue;
            }
            // A field that varies in time is a force.
            let parts = field.iter().zip(com);
            let along =
                |(g, place): (&Number, &Number)| Along { force: mass.value.v * g.value.v, place: *place };
            found.forces.extend(parts.map(along));
        }
    }
    Ok(found)
}

/// Fields of an element.
pub struct Fields<'a> {
    pub given: &'a [Field],
    pub scope: Scope<'a>,
}

impl Fields<'_> {
    fn expression(&self, name: &str) -> Option<&Expression> {
        self.given.iter().find(|field| field.name.text == name).map(|field| &field.value)
    }

    fn scalar(&self, name: &str) -> Result<Option<Number>, Gap> {
        self.expression(name).map(|expression| value(expression, &self.scope)?.number()).transpose()
    }

    /// μ at the speed of a friction, and μₛ.
    fn coefficients(&self) -> Result<[f64; 2], Gap> {
        let sliding = self.required("coefficient")?.value.v;
        let holding = self.scalar("sticks")?.map_or(sliding, |sticks| sticks.value.v.max(sliding));
        let share = match self.scalar("speed")? {
            Some(speed) => (-(self.required("along")?.rate.v / speed.value.v).powi(2)).exp(),
            None => 0.0,
        };
        Ok([sliding + (holding - sliding) * share, holding])
    }

    /// z and ż = ṡ − |ṡ| z μ/(δ g(ṡ)) of bristles.
    fn bristles(&self, index: usize, bend: f64) -> Result<(f64, f64), Gap> {
        let (speed, z) = (self.required("along")?.rate.v, self.scope.deflection(index));
        let [level, _] = self.coefficients()?;
        let sliding = self.required("coefficient")?.value.v;
        Ok((z, speed - speed.abs() * z * sliding / (bend * level)))
    }

    fn required(&self, name: &str) -> Result<Number, Gap> {
        self.scalar(name)?.ok_or_else(|| Gap(format!("a field `{name}` that is not there")))
    }

    fn vector(&self, name: &str) -> Result<Vec<Number>, Gap> {
        match self.expression(name) {
            Some(expression) => Ok(value(expression, &self.scope)?.items),
            None => Ok(Vec::new()),
        }
    }
}

const HALF: Dual = Dual::still(0.5);

fn body(fields: &Fields<'_>, found: &mut Mechanics) -> Result<Heavy, Gap> {
    let (mass, com) = (fields.required("mass")?, fields.vector("com")?);
    for place in &com {
        found.kinetic.push(HALF * mass.value * place.rate * place.rate);
    }
    let inertia = fields.vector("inertia")?;
    if let Some(angle) = fields.scalar("angle")? {
        let inertia = inertia.first().ok_or_else(|| Gap("an angle without inertia".to_string()))?;
        found.kinetic.push(HALF * inertia.value * angle.rate * angle.rate);
    } else if fields.expression("orientation").is_some() {
        let e = fields.vector("orientation")?;
        let omega = angular_velocity(&e, -1.0).ok_or_else(|| Gap("this orientation".to_string()))?;
        let omega = omega.map(|part| part.value);
        const PLACES: [(usize, usize, f64); 6] =
            [(0, 0, 0.5), (1, 1, 0.5), (2, 2, 0.5), (0, 1, 1.0), (0, 2, 1.0), (1, 2, 1.0)];
        for ((i, j, factor), entry) in PLACES.iter().zip(&inertia) {
            found.kinetic.push(Dual::still(*factor) * entry.value * omega[*i] * omega[*j]);
        }
    }
    Ok((mass, com))
}

/// A spring of rate k about a rest, a damper and a drive, along a length or an angle: −(k (x − x₀) + c ẋ + f).
fn sprung(
    fields: &Fields<'_>,
    along: Number,
    [rest, drive]: [&str; 2],
    found: &mut Mechanics,
) -> Result<(), Gap> {
    let rest = fields.scalar(rest)?.unwrap_or_default();
    if let Some(stiffness) = fields.scalar("stiffness")? {
        let extension = along - rest;
        if stiffness.is_still() && rest.is_still() {
            found.potential.push(HALF * stiffness.value * extension.value * extension.value);
        } else {
            found.forces.push(Along { force: -stiffness.value.v * extension.value.v, place: along });
        }
    }
    if let Some(damping) = fields.scalar("damping")? {
        found.forces.push(Along { force: -damping.value.v * along.rate.v, place: along });
    }
    if let Some(drive) = fields.scalar(drive)? {
        found.forces.push(Along { force: -drive.value.v, place: along });
    }
    Ok(())
}

fn length(fields: &Fields<'_>) -> Result<Number, Gap> {
    let (from, to) = (fields.vector("from")?, fields.vector("to")?);
    let length = from.iter().zip(&to).map(|(from, to)| *to - *from).reduce(Number::hypot);
    length.ok_or_else(|| Gap("a tension between no points".to_string()))
}

/// k (x − x₀) + c ẋ + f along a length or an angle.
fn pull(fields: &Fields<'_>, place: Number, [rest, drive]: [&str; 2]) -> Result<Along, Gap> {
    let of = |name: &str| Ok(fields.scalar(name)?.unwrap_or_default().value.v);
    let extension = place.value.v - of(rest)?;
    let force = of("stiffness")? * extension + of("damping")? * place.rate.v + of(drive)?;
    Ok(Along { force: -force, place })
}

/// A value whose motion is not known: forces are values alone.
fn unknown(value: f64) -> Number {
    let none = Dual::still(f64::NAN);
    Number { value: Dual { v: value, a: f64::NAN, b: f64::NAN, c: f64::NAN }, rate: none }
}

/// `force(…)`, `normal(…)`, `power(…)`, `slip(…)`, `gap(…)` or `deflection(…)` of the element or load at a place among the statements.
pub fn by_name(function: &str, index: usize, scope: &Scope<'_>) -> Result<Value, Gap> {
    let none = |name: &str| Gap(format!("`{function}({name})`"));
    let Some((kind, scope)) = scope.statement(index) else { return Err(none("")) };
    let (kind, name, given) = match kind {
        StatementKind::Element { kind, name, fields } => (kind, name, fields),
        StatementKind::Load { name, value: force, on, .. } => {
            let (force, on) = (value(force, &scope)?, value(on, &scope)?);
            let values = force.items.iter().map(|part| part.value.v);
            return match function {
                "force" => Ok(Value { items: values.map(unknown).collect(), shape: force.shape }),
                "power" if force.items.len() == on.items.len() => {
                    let power = values.zip(&on.items).map(|(force, place)| force * place.rate.v).sum();
                    Ok(Value::scalar(unknown(power)))
                }
                _ => Err(none(&name.text)),
            };
        }
        _ => return Err(none("")),
    };
    let fields = Fields { given, scope };
    let (along, sign) = match kind {
        Element::Tsda => (Some(pull(&fields, length(&fields)?, ["length", "actuator"])?), -1.0),
        Element::Rsda => (Some(pull(&fields, fields.required("angle")?, ["rest", "torque"])?), -1.0),
        Element::Friction => (friction(&fields, index)?, 1.0),
        Element::Contact => (contact(&fields)?, 1.0),
        Element::Body | Element::Gravity => return Err(none(&name.text)),
    };
    let place = match kind {
        Element::Contact => fields.required("gap")?,
        _ => along.map_or_else(|| fields.required("along"), |along| Ok(along.place))?,
    };
    Ok(Value::scalar(match (function, along) {
        ("gap", _) => place,
        ("slip", _) => place.der(),
        ("deflection", _) => unknown(fields.scope.deflection(index)),
        ("force" | "normal", Some(along)) => unknown(sign * along.force),
        ("power", Some(along)) => unknown(along.force * place.rate.v),
        _ => return Err(none(&name.text)),
    }))
}

/// −(μ |N| tanh(ṡ/v₀) + c ṡ), or −(μ |N| (z/δ + d ż) + c ṡ) with bristles; none where it sticks.
fn friction(fields: &Fields<'_>, index: usize) -> Result<Option<Along>, Gap> {
    let place = fields.required("along")?;
    let [normal, coefficient] = ["normal", "coefficient"];
    let viscous = fields.scalar("viscous")?.unwrap_or_default().value.v * place.rate.v;
    if let Some(bend) = fields.scalar("bristles")? {
        let limit = fields.required(coefficient)?.value.v * fields.required(normal)?.value.v.abs();
        let damping = fields.scalar("damping")?.unwrap_or_default().value.v;
        let (z, rate) = fields.bristles(index, bend.value.v)?;
        let force = limit * (z / bend.value.v + damping * rate) + viscous;
        return Ok(Some(Along { force: -force, place }));
    }
    if fields.expression("sticks").is_some() {
        return Ok(None);
    }
    let [normal, coefficient, speed] = [normal, coefficient, "speed"].map(|name| fields.required(name));
    let limit = coefficient?.value.v * normal?.value.v.abs();
    let force = limit * (place.rate.v / speed?.value.v).tanh() + viscous;
    Ok(Some(Along { force: -force, place }))
}

/// The law of a friction that sticks: μ + (μₛ − μ) exp(−(ṡ/v)²) at its speed.
fn sticking(name: &str, fields: &Fields<'_>, placed: &[Placed]) -> Result<Held, Gap> {
    let (place, [sliding, holding]) = (fields.required("along")?, fields.coefficients()?);
    let normal = match fields.expression("normal").and_then(|normal| fields.scope.referred(normal)) {
        Some(contact) if is_rigid(&placed[contact].kind) => {
            let before = placed[..contact].iter().filter(|placed| is_held(&placed.kind)).count();
            Normal::Of(before)
        }
        _ => Normal::Force(fields.required("normal")?.value.v),
    };
    let viscous = fields.scalar("viscous")?.unwrap_or_default().value.v;
    Ok(Held { name: name.to_string(), place, law: Law::Friction { normal, sliding, holding, viscous } })
}

/// `true` for a contact without stiffness.
pub fn is_rigid(kind: &StatementKind) -> bool {
    let has = |fields: &[Field], name: &str| fields.iter().any(|field| field.name.text == name);
    matches!(kind, StatementKind::Element { kind: Element::Contact, fields, .. } if !has(fields, "stiffness"))
}

/// `true` for a contact without stiffness and a friction that sticks.
fn is_held(kind: &StatementKind) -> bool {
    let has = |fields: &[Field], name: &str| fields.iter().any(|field| field.name.text == name);
    is_rigid(kind)
        || matches!(kind, StatementKind::Element { kind: Element::Friction, fields, .. }
            if has(fields, "sticks") && !has(fields, "bristles"))
}

/// k p₀ (p/p₀)ⁿ max(1 − d ġ, 0) with the depth p = max(−g, 0); none where it is rigid.
fn contact(fields: &Fields<'_>) -> Result<Option<Along>, Gap> {
    let gap = fields.required("gap")?;
    let Some(stiffness) = fields.scalar("stiffness")? else { return Ok(None) };
    let depth = (-gap.value.v).max(0.0);
    let depth = match (fields.scalar("exponent")?, fields.scalar("depth")?) {
        (Some(exponent), Some(reference)) => {
            let reference = reference.value.v;
            reference * (depth / reference).powf(exponent.value.v)
        }
        _ => depth,
    };
    let damping = match fields.scalar("restitution")? {
        Some(restitution) => restituted(restitution.value.v) / fields.required("approach")?.value.v,
        None => fields.scalar("damping")?.unwrap_or_default().value.v,
    };
    let share = (1.0 - damping * gap.rate.v).max(0.0);
    Ok(Some(Along { force: stiffness.value.v * depth * share, place: gap }))
}

/// The root c in 0 to 1/e of c − ln(1 + c) = −e c − ln(1 − e c), by bisection: what a contact makes of the speed v₀ is e v₀.
fn restituted(e: f64) -> f64 {
    let e = e.clamp(1e-6, 1.0);
    // Both sides are c²/2 for e = 1 and a small c.
    let open = |c: f64| (c - c.ln_1p()) + e * c + (-e * c).ln_1p();
    let (mut low, mut high) = (0.0, 1.0 / e);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if open(middle) > 0.0 { low = middle } else { high = middle }
    }
    if e == 1.0 { 0.0 } else { low }
}

fn load(kind: Load, force: &Value, on: Value, found: &mut Mechanics) -> Result<(), Gap> {
    let along = |force: &[Number], places: Vec<Number>, found: &mut Mechanics| {
        let pairs = force.iter().zip(places);
        found.forces.extend(pairs.map(|(force, place)| Along { force: force.value.v, place }));
    };
    if let (Load::Torque, [e0, x, y, z], [mx, my, mz]) = (kind, on.items.as_slice(), force.items.as_slice()) {
        // τ·ω with ω = 2 (e₀ ε̇ − ė₀ ε + ε × ε̇), as forces on the parameters.
        let (axis, moment) = ([*x, *y, *z], [*mx, *my, *mz]);
        let turn = cross(moment, axis);
        let two = Number::still(2.0);
        let first = -(two * dot(&axis, &moment));
        let rest = [0, 1, 2].map(|k| two * (*e0 * moment[k] + turn[k]));
        along(&[first, rest[0], rest[1], rest[2]], on.items, found);
        return Ok(());
    }
    if force.items.len() != on.items.len() {
        return Err(Gap("a load of another shape than its place".to_string()));
    }
    along(&force.items, on.items, found);
    Ok(())
}

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
}

/// A body's mass (kg) with the components of its centre of mass (m).
type Heavy = (Number, Vec<Number>);

/// Energies and forces of all statements at the state of `names`.
pub fn mechanics(placed: &[Placed], names: &Names) -> Result<Mechanics, Gap> {
    let mut found = Mechanics::default();
    let mut heavy: Vec<Heavy> = Vec::new();
    let mut fields: Vec<Vec<Number>> = Vec::new();
    for Placed { kind, rounds } in placed {
        let scope = Scope::of(names, rounds);
        match kind {
            StatementKind::Element { kind, fields: given, .. } => {
                let fields_of = Fields { given, scope };
                match kind {
                    Element::Body => heavy.push(body(&fields_of, &mut found)?),
                    Element::Gravity => fields.push(fields_of.vector("acceleration")?),
                    Element::Tsda => tension(&fields_of, &mut found)?,
                    Element::Rsda => {
                        let angle = fields_of.required("angle")?;
                        sprung(&fields_of, angle, ["rest", "torque"], &mut found)?;
                    }
                    Element::Friction => friction(&fields_of, &mut found)?,
                    Element::Contact => contact(&fields_of, &mut found)?,
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
struct Fields<'a> {
    given: &'a [Field],
    scope: Scope<'a>,
}

impl Fields<'_> {
    fn expression(&self, name: &str) -> Option<&Expression> {
        self.given.iter().find(|field| field.name.text == name).map(|field| &field.value)
    }

    fn scalar(&self, name: &str) -> Result<Option<Number>, Gap> {
        self.expression(name).map(|expression| value(expression, &self.scope)?.number()).transpose()
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

fn tension(fields: &Fields<'_>, found: &mut Mechanics) -> Result<(), Gap> {
    let (from, to) = (fields.vector("from")?, fields.vector("to")?);
    let length = from.iter().zip(&to).map(|(from, to)| *to - *from).reduce(Number::hypot);
    let length = length.ok_or_else(|| Gap("a tension between no points".to_string()))?;
    sprung(fields, length, ["length", "actuator"], found)
}

/// −(μ |N| tanh(ṡ/v₀) + c ṡ).
fn friction(fields: &Fields<'_>, found: &mut Mechanics) -> Result<(), Gap> {
    if fields.scalar("sticks")?.is_some() {
        return Err(Gap("friction that sticks".to_string()));
    }
    if fields.scalar("bristles")?.is_some() {
        return Err(Gap("friction with bristles".to_string()));
    }
    let along = fields.required("along")?;
    let [normal, coefficient, speed] = ["normal", "coefficient", "speed"].map(|name| fields.required(name));
    let limit = coefficient?.value.v * normal?.value.v.abs();
    let viscous = fields.scalar("viscous")?.unwrap_or_default().value.v;
    let force = limit * (along.rate.v / speed?.value.v).tanh() + viscous * along.rate.v;
    found.forces.push(Along { force: -force, place: along });
    Ok(())
}

/// k p₀ (p/p₀)ⁿ max(1 − d ġ, 0) with the depth p = max(−g, 0).
fn contact(fields: &Fields<'_>, found: &mut Mechanics) -> Result<(), Gap> {
    if fields.scalar("restitution")?.is_some() {
        return Err(Gap("a contact with a restitution".to_string()));
    }
    let (gap, stiffness) = (fields.required("gap")?, fields.required("stiffness")?.value.v);
    let depth = (-gap.value.v).max(0.0);
    let depth = match (fields.scalar("exponent")?, fields.scalar("depth")?) {
        (Some(exponent), Some(reference)) => {
            let reference = reference.value.v;
            reference * (depth / reference).powf(exponent.value.v)
        }
        _ => depth,
    };
    let damping = fields.scalar("damping")?.unwrap_or_default().value.v;
    let share = (1.0 - damping * gap.rate.v).max(0.0);
    found.forces.push(Along { force: stiffness * depth * share, place: gap });
    Ok(())
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

//! Named forces, gravity and potentials → generalized forces by virtual work, with powers and energies.

use super::jacobian;
use super::lower::Clock;
use super::power_of_time;
use super::sum::Sum;
use crate::model::dynamics::{Action, Dynamics as Declared};
use crate::model::expression::Id;
use crate::model::springs::{SpringDamper, Turn};
use crate::symbolic::{Graph, Leaf, NodeId, Unary, tangent};

/// Place that a force acts on: a point of the plane, or an angle or a length.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    Point([NodeId; 2]),
    Scalar(NodeId),
    /// A point of space.
    Elsewhere,
}

/// Part of a force: its value, of two components on a point, of the first alone elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Acting {
    /// Index among the named forces.
    pub force: usize,
    /// 1 for the end of a tension, 0 for its begin and for forces with one place.
    pub end: usize,
    pub place: Place,
    pub value: [NodeId; 2],
}

/// Sum of all forces.
pub struct Forces {
    /// One a coordinate.
    pub force: Vec<Sum>,
    /// Potential energy.
    pub potential: Sum,
    /// One a named force: its power, without what it stores as potential energy.
    pub powers: Vec<Option<NodeId>>,
    /// Places that the named forces act on, without those that come from a function of dissipation.
    pub acting: Vec<Acting>,
    /// Power with which time alone changes the energies.
    pub carried: Sum,
}

/// Before: the forces of the text; the number of coordinates, and the power of time alone in the kinetic energy. After: the sum
/// on each coordinate, the potential, the powers of the named forces and that of time alone. Named forces of `left_out` are
/// omitted.
pub fn derive(
    g: &mut Graph,
    declared: &Declared,
    of: &impl Fn(Id) -> NodeId,
    clock: &Clock,
    (count, carried, left_out): (usize, Sum, &[usize]),
) -> Forces {
    let mut work = Work {
        force: vec![Sum::default(); count],
        potential: Sum::default(),
        carried,
        clock,
        acting: Vec::new(),
        current: 0,
    };
    let mut powers = Vec::new();
    for (index, force) in declared.forces.iter().enumerate() {
        work.current = index;
        if left_out.contains(&index) {
            powers.push(None);
            continue;
        }
        powers.push(match &force.action {
            Action::Work(pairs) => {
                let mut power = Sum::default();
                for (value, on) in pairs {
                    work.along(g, of(*value), of(*on));
                    work.power(g, of(*value), of(*on), &mut power);
                }
                let (values, places): (Vec<_>, Vec<_>) =
                    pairs.iter().map(|(value, on)| (of(*value), of(*on))).unzip();
                work.acts(0, &places, &values);
                power.0
            }
            Action::Dissipation(value) => work.dissipation(g, of(*value)),
            Action::Line(line) => work.line(g, line, of),
            Action::Turn(turn) => work.turn(g, turn, of),
        });
    }
    for field in &declared.gravity {
        for body in &declared.bodies {
            for (place, acceleration) in body.com.iter().zip(field) {
                let vanishes = |g: &Graph, id: Id| g.constant_value(of(id)) == Some(0.0);
                if vanishes(g, *acceleration) || vanishes(g, body.mass) {
                    continue;
                }
                let weight = g.multiply(of(body.mass), of(*acceleration));
                work.along(g, weight, of(*place));
                let energy = g.multiply(weight, of(*place));
                let energy = g.negate(energy);
                work.potential.add(g, energy);
                power_of_time::weight(g, weight, of(*place), clock, &mut work.carried);
            }
        }
    }
    for potential in &declared.potentials {
        work.slope(g, of(*potential), Leaf::Position);
        work.potential.add(g, of(*potential));
        power_of_time::potential(g, of(*potential), clock, &mut work.carried);
    }
    Forces {
        force: work.force,
        potential: work.potential,
        powers,
        acting: work.acting,
        carried: work.carried,
    }
}

/// Variables that move.
#[derive(Clone, Copy)]
enum RateOf {
    All,
    /// The coordinates alone.
    Coordinates,
    /// The time and inputs alone.
    Time,
}

struct Work<'a> {
    force: Vec<Sum>,
    potential: Sum,
    carried: Sum,
    clock: &'a Clock,
    acting: Vec<Acting>,
    /// Index of the force.
    current: usize,
}

impl Work<'_> {
    /// Keeps the place of the current force.
    fn acts(&mut self, end: usize, places: &[NodeId], values: &[NodeId]) {
        let (place, value) = match (places, values) {
            ([place], [value]) => (Place::Scalar(*place), [*value; 2]),
            ([px, py], [x, y]) => (Place::Point([*px, *py]), [*x, *y]),
            (_, [value, ..]) => (Place::Elsewhere, [*value; 2]),
            (_, []) => return,
        };
        self.acting.push(Acting { force: self.current, end, place, value });
    }

    /// Adds (∂place/∂q)ᵀ value.
    fn along(&mut self, g: &mut Graph, value: NodeId, place: NodeId) {
        for (coordinate, entry) in
            jacobian(g, &[place], self.force.len(), Leaf::Position).into_iter().flatten()
        {
            let force = g.multiply(entry, value);
            if let Some(sum) = self.force.get_mut(coordinate) {
                sum.add(g, force);
            }
        }
    }

    /// Subtracts the slope of `energy` along the axes.
    fn slope(&mut self, g: &mut Graph, energy: NodeId, axis: fn(u32) -> Leaf) -> Vec<(usize, NodeId)> {
        let slopes = jacobian(g, &[energy], self.force.len(), axis).pop().unwrap_or_default();
        for (coordinate, slope) in &slopes {
            if let Some(sum) = self.force.get_mut(*coordinate) {
                *sum = sum.minus(g, Some(*slope));
            }
        }
        slopes
    }

    /// Adds value · ∂place/∂q q̇: the part of the place's velocity due to time alone gives no power to the mechanism.
    fn power(&self, g: &mut Graph, value: NodeId, place: NodeId, power: &mut Sum) {
        if let Some(velocity) = self.velocity(g, place, RateOf::Coordinates) {
            let term = g.multiply(value, velocity);
            power.add(g, term);
        }
    }

    fn velocity(&self, g: &mut Graph, place: NodeId, motion: RateOf) -> Option<NodeId> {
        let clock = self.clock;
        let direction = |g: &mut Graph, leaf| match (motion, leaf) {
            (RateOf::All, _) => clock.total(g, leaf, false),
            (RateOf::Coordinates, Leaf::Position(i)) => Some(g.leaf(Leaf::Velocity(i))),
            (RateOf::Coordinates, _) => None,
            (RateOf::Time, _) => clock.partial(g, leaf),
        };
        tangent(g, &[place], direction).pop().flatten()
    }

    /// Σ direction · velocity.
    fn rate(&self, g: &mut Graph, directions: &[NodeId], places: &[NodeId], motion: RateOf) -> Sum {
        let mut rate = Sum::default();
        for (direction, place) in directions.iter().zip(places) {
            if let Some(velocity) = self.velocity(g, *place, motion) {
                let term = g.multiply(*direction, velocity);
                rate.add(g, term);
            }
        }
        rate
    }

    /// −∂R/∂q̇; its power is −q̇·∂R/∂q̇.
    fn dissipation(&mut self, g: &mut Graph, function: NodeId) -> Option<NodeId> {
        let mut power = Sum::default();
        for (coordinate, slope) in self.slope(g, function, Leaf::Velocity) {
            let velocity = g.leaf(Leaf::Velocity(coordinate as u32));
            let term = g.multiply(slope, velocity);
            power = power.minus(g, Some(term));
        }
        power.0
    }

    /// A tension between two points: k d + (c l̇ + f − k l₀) d/l pulls the end back, d from begin to end.
    fn line(&mut self, g: &mut Graph, line: &SpringDamper, of: &impl Fn(Id) -> NodeId) -> Option<NodeId> {
        let zero = g.constant(0.0);
        let span: Vec<NodeId> =
            line.from.iter().zip(&line.to).map(|(a, b)| g.subtract(of(*b), of(*a))).collect();
        let mut square = Sum::default();
        for d in &span {
            let term = g.multiply(*d, *d);
            square.add(g, term);
        }
        // √(d·d) needs no hypot: only beyond 1e154 does it overflow, and at 0 the directions are chosen, not divided.
        let length = g.unary(Unary::Sqrt, square.0.unwrap_or(zero));
        let directions: Vec<NodeId> = span
            .iter()
            .map(|d| {
                let ratio = g.divide(*d, length);
                g.select(zero, length, ratio, zero)
            })
            .collect();
        let [rate, own, moved] = [RateOf::All, RateOf::Coordinates, RateOf::Time]
            .map(|motion| self.rate(g, &directions, &span, motion));
        let mut active = Sum(line.actuator.map(of));
        if let (Some(damping), Some(rate)) = (line.damping, rate.0) {
            let viscous = g.multiply(of(damping), rate);
            active.add(g, viscous);
        }
        let stiffness = line.stiffness.map(of);
        let slack = stiffness.zip(line.length.map(of)).map(|(k, rest)| g.multiply(k, rest));
        let tension = active.minus(g, slack);
        let (mut pulls, mut forces) = (Vec::new(), Vec::new());
        for (d, direction) in span.iter().zip(&directions) {
            let mut pull = Sum(stiffness.map(|k| g.multiply(k, *d)));
            if let Some(tension) = tension.0 {
                let term = g.multiply(tension, *direction);
                pull.add(g, term);
            }
            if let Some(pull) = pull.0 {
                let force = g.negate(pull);
                self.along(g, force, *d);
                pulls.push(pull);
                forces.push(force);
            }
        }
        let ends = |points: &[Id]| points.iter().map(|point| of(*point)).collect::<Vec<_>>();
        self.acts(0, &ends(&line.from), &pulls);
        self.acts(1, &ends(&line.to), &forces);
        let spring = stiffness.map(|k| (k, self.stretch(g, length, line.length.map(of))));
        self.element_power(g, spring, active, [own, moved], line.stores)
    }

    /// A torque against an angle.
    fn turn(&mut self, g: &mut Graph, turn: &Turn, of: &impl Fn(Id) -> NodeId) -> Option<NodeId> {
        let angle = of(turn.angle);
        let [rate, own, moved] = [RateOf::All, RateOf::Coordinates, RateOf::Time]
            .map(|motion| Sum(self.velocity(g, angle, motion)));
        let mut active = Sum(turn.torque.map(of));
        if let (Some(damping), Some(rate)) = (turn.damping, rate.0) {
            let viscous = g.multiply(of(damping), rate);
            active.add(g, viscous);
        }
        let spring = turn.stiffness.map(|k| (of(k), self.stretch(g, angle, turn.rest.map(of))));
        let mut total = Sum(spring.map(|(k, stretch)| g.multiply(k, stretch)));
        if let Some(active) = active.0 {
            total.add(g, active);
        }
        if let Some(total) = total.0 {
            let torque = g.negate(total);
            self.along(g, torque, angle);
            self.acts(0, &[angle], &[torque]);
        }
        self.element_power(g, spring, active, [own, moved], turn.stores)
    }

    fn stretch(&self, g: &mut Graph, value: NodeId, rest: Option<NodeId>) -> NodeId {
        rest.map_or(value, |rest| g.subtract(value, rest))
    }

    /// A spring that stores adds to the potential energy, and to the power only where the time moves its ends.
    fn element_power(
        &mut self,
        g: &mut Graph,
        spring: Option<(NodeId, NodeId)>,
        mut active: Sum,
        [own, moved]: [Sum; 2],
        stores: bool,
    ) -> Option<NodeId> {
        let mut supplied = None;
        if let Some((stiffness, stretch)) = spring {
            if stores {
                let half = g.constant(0.5);
                let half = g.multiply(half, stiffness);
                let square = g.multiply(stretch, stretch);
                let energy = g.multiply(half, square);
                self.potential.add(g, energy);
                if let Some(moved) = moved.0 {
                    let elastic = g.multiply(stiffness, stretch);
                    supplied = Some(g.multiply(elastic, moved));
                }
            } else {
                let elastic = g.multiply(stiffness, stretch);
                active.add(g, elastic);
            }
        }
        let spent = active.0.zip(own.0).map(|(active, own)| g.multiply(active, own));
        Sum(supplied).minus(g, spent).0
    }
}

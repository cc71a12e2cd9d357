//! Masses and forces by virtual work, displacement by displacement, in arithmetic of mixed derivatives.

use super::mixed_derivatives::{AGAIN, DISPLACED, MOTION, Nilpotent, VARIED};
use super::oracle::{Evaluation, Expected};
use crate::model::dynamics::{Action, Body, Dynamics, Force, Rotation};
use crate::model::expression::{Id, Node};
use crate::model::springs::{SpringDamper, Turn};
use crate::model::{Model, VariableKind};
use crate::symbolic::Unary;

/// Displaced or varied quantity: a coordinate, or its rate.
#[derive(Clone, Copy)]
enum Axis {
    Position(usize),
    Velocity(usize),
}

/// Path of the coordinates along the two directions of the motion.
#[derive(Clone, Copy)]
enum Path {
    /// Along the state's rates, without accelerations.
    Free,
    /// The same with the clock stopped.
    Stopped,
    /// Along q̈ in place of q̇, with the clock stopped: the vector that M is multiplied with.
    Product,
    /// Along the state's rates, without accelerations, in three directions; no quantity is displaced or varied.
    Thrice,
}

/// One number an expression, displaced and varied along an axis each.
struct Numbers(Vec<Nilpotent>);

impl Numbers {
    fn of(model: &Model, state: &Evaluation, motion: Path, [displaced, varied]: [Axis; 2]) -> Self {
        let mut numbers: Vec<Nilpotent> = Vec::with_capacity(model.expressions.len());
        for (_, node) in model.expressions.iter() {
            let number = match node {
                Node::Number(value) => Nilpotent::constant(value),
                Node::Time => moving(motion, [state.t, 1.0, 0.0]),
                Node::Coordinate(index) => {
                    let rate = match motion {
                        Path::Free | Path::Stopped | Path::Thrice => state.qd[index],
                        Path::Product => state.qdd[index],
                    };
                    let mut terms = vec![(0, state.q[index]), (MOTION, rate), (AGAIN, rate)];
                    if matches!(motion, Path::Thrice) {
                        terms.push((DISPLACED, rate));
                        numbers.push(Nilpotent::new(&terms));
                        continue;
                    }
                    terms.extend(match displaced {
                        Axis::Position(moved) if moved == index => Some((DISPLACED, 1.0)),
                        // The rates that the text writes: ∂/∂q̇ leaves the path of the coordinates unchanged.
                        Axis::Velocity(moved) if moved == index => Some((DISPLACED | AGAIN, 1.0)),
                        _ => None,
                    });
                    match varied {
                        Axis::Position(moved) if moved == index => terms.push((VARIED, 1.0)),
                        Axis::Velocity(moved) if moved == index => {
                            terms.extend([(VARIED | MOTION, 1.0), (VARIED | AGAIN, 1.0)]);
                        }
                        _ => {}
                    }
                    Nilpotent::new(&terms)
                }
                Node::Variable(index) => {
                    let v = |offset: usize| state.variables.get(index + offset).copied().unwrap_or(0.0);
                    match model.variables[index].kind {
                        VariableKind::InputWithRates => moving(motion, [v(0), v(1), v(2)]),
                        _ => Nilpotent::constant(v(0)),
                    }
                }
                Node::State(index) => Nilpotent::constant(state.states[index]),
                Node::Multiplier(index) => Nilpotent::constant(state.lambda[index]),
                Node::Unary(function, a) => numbers[a.index()].unary(function),
                Node::Binary(function, a, b) => numbers[a.index()].binary(function, numbers[b.index()]),
                Node::Rate(a, 1) => numbers[a.index()].rate(),
                Node::Call { function, order, argument } => {
                    numbers[argument.index()].call(function as u32, order)
                }
                Node::Rate(..)
                | Node::Pin(..)
                | Node::Margin(_)
                | Node::Ratio(..)
                | Node::Sliding(_)
                | Node::Holding(_)
                | Node::Impulse(_)
                | Node::Remembered(_) => {
                    unreachable!("random texts with masses use no `der2`, no pin, no margin and no ratio")
                }
            };
            numbers.push(number);
        }
        Numbers(numbers)
    }

    fn at(&self, id: Id) -> Nilpotent {
        self.0[id.index()]
    }

    fn optional(&self, id: Option<Id>) -> Nilpotent {
        id.map_or(Nilpotent::constant(0.0), |id| self.at(id))
    }

    /// Places that have inertia, each with it: centres of mass and angles.
    fn inertias(&self, body: &Body) -> Vec<(Nilpotent, Nilpotent)> {
        let mut all: Vec<_> = body.com.iter().map(|place| (self.at(body.mass), self.at(*place))).collect();
        match &body.rotation {
            Some(Rotation::Plane { inertia, angle }) => all.push((self.at(*inertia), self.at(*angle))),
            Some(Rotation::Space { .. }) => unreachable!("random bodies are plane"),
            None => {}
        }
        all
    }

    /// Tension of an element between two points: elastic part, other part, and its length.
    fn line(&self, line: &SpringDamper) -> [Nilpotent; 3] {
        let mut square = Nilpotent::constant(0.0);
        for (from, to) in line.from.iter().zip(&line.to) {
            let d = self.at(*to).minus(self.at(*from));
            square = square.plus(d.times(d));
        }
        let length = square.unary(Unary::Sqrt);
        let elastic = self.optional(line.stiffness).times(length.minus(self.optional(line.length)));
        let viscous = self.optional(line.damping).times(length.rate());
        [elastic, viscous.plus(self.optional(line.actuator)), length]
    }

    /// The same for an angle.
    fn turn(&self, turn: &Turn) -> [Nilpotent; 3] {
        let angle = self.at(turn.angle);
        let elastic = self.optional(turn.stiffness).times(angle.minus(self.optional(turn.rest)));
        let viscous = self.optional(turn.damping).times(angle.rate());
        [elastic, viscous.plus(self.optional(turn.torque)), angle]
    }

    /// The work of all forces and inertia forces on the displacement of a coordinate.
    fn work(&self, declared: &Dynamics) -> Nilpotent {
        let mut work = Nilpotent::constant(0.0);
        let along = |value: Nilpotent, place: Nilpotent| value.times(place.along(DISPLACED));
        for body in &declared.bodies {
            for (inertia, place) in self.inertias(body) {
                work = work.minus(along(inertia.times(place.along(MOTION).along(AGAIN)), place));
            }
            for field in &declared.gravity {
                for (place, acceleration) in body.com.iter().zip(field) {
                    let weight = self.at(body.mass).times(self.at(*acceleration));
                    work = work.plus(along(weight, self.at(*place)));
                }
            }
        }
        for force in &declared.forces {
            work = match &force.action {
                Action::Work(pairs) => pairs
                    .iter()
                    .fold(work, |work, (value, on)| work.plus(along(self.at(*value), self.at(*on)))),
                Action::Dissipation(_) => work,
                Action::Line(line) => resisted(work, self.line(line)),
                Action::Turn(turn) => resisted(work, self.turn(turn)),
            };
        }
        for potential in &declared.potentials {
            work = work.minus(self.at(*potential).along(DISPLACED));
        }
        for kinetic in &declared.kinetics {
            work = work.plus(self.at(kinetic.value).along(DISPLACED));
        }
        work
    }

    /// Loss on the displacement of a rate: ∂R/∂q̇ and d/dt ∂T/∂q̇.
    fn loss(&self, declared: &Dynamics) -> Nilpotent {
        let mut loss = Nilpotent::constant(0.0);
        for force in &declared.forces {
            if let Action::Dissipation(function) = force.action {
                loss = loss.plus(self.at(function).along(DISPLACED));
            }
        }
        for kinetic in &declared.kinetics {
            loss = loss.plus(self.at(kinetic.value).along(DISPLACED).along(MOTION));
        }
        loss
    }

    /// Power of a named force on the coordinates, and power of moved places on a spring that stores; `stopped`: the same
    /// state with the clock stopped.
    fn power(&self, stopped: &Self, force: &Force, state: &Evaluation, model: &Model) -> Nilpotent {
        let zero = Nilpotent::constant(0.0);
        let element = |[elastic, other, place]: [Nilpotent; 3], still: [Nilpotent; 3], stores: bool| {
            let own = still[2].rate();
            let spent = other.times(own);
            let moved = place.rate().minus(own);
            elastic.times(if stores { moved } else { own.negated() }).minus(spent)
        };
        match &force.action {
            Action::Work(pairs) => pairs
                .iter()
                .fold(zero, |power, (value, on)| power.plus(self.at(*value).times(stopped.at(*on).rate()))),
            Action::Dissipation(function) => (0..state.q.len()).fold(zero, |power, index| {
                let axes = [Axis::Velocity(index), Axis::Position(index)];
                let slope = Numbers::of(model, state, Path::Free, axes).at(*function).along(DISPLACED);
                power.minus(slope.times(Nilpotent::constant(state.qd[index])))
            }),
            Action::Line(line) => element(self.line(line), stopped.line(line), line.stores),
            Action::Turn(turn) => element(self.turn(turn), stopped.turn(turn), turn.stores),
        }
    }

    /// Kinetic and potential energy.
    fn energies(&self, declared: &Dynamics) -> [Nilpotent; 2] {
        let half = |x: Nilpotent| x.times(Nilpotent::constant(0.5));
        let (mut kinetic, mut potential) = (Nilpotent::constant(0.0), Nilpotent::constant(0.0));
        for body in &declared.bodies {
            for (inertia, place) in self.inertias(body) {
                let velocity = place.rate();
                kinetic = kinetic.plus(half(inertia.times(velocity.times(velocity))));
            }
            for field in &declared.gravity {
                for (place, acceleration) in body.com.iter().zip(field) {
                    let weight = self.at(body.mass).times(self.at(*acceleration));
                    potential = potential.minus(weight.times(self.at(*place)));
                }
            }
        }
        for energy in &declared.kinetics {
            kinetic = kinetic.plus(self.at(energy.value));
        }
        for energy in &declared.potentials {
            potential = potential.plus(self.at(*energy));
        }
        let stored = |[elastic, _, place]: [Nilpotent; 3], rest: Option<Id>| {
            half(elastic.times(place.minus(self.optional(rest))))
        };
        for force in &declared.forces {
            potential = match &force.action {
                Action::Line(line) if line.stores => potential.plus(stored(self.line(line), line.length)),
                Action::Turn(turn) if turn.stores => potential.plus(stored(self.turn(turn), turn.rest)),
                _ => potential,
            };
        }
        [kinetic, potential]
    }
}

fn moving(motion: Path, [value, rate, acceleration]: [f64; 3]) -> Nilpotent {
    match motion {
        Path::Free => {
            Nilpotent::new(&[(0, value), (MOTION, rate), (AGAIN, rate), (MOTION | AGAIN, acceleration)])
        }
        Path::Thrice => Nilpotent::new(&[
            (0, value),
            (MOTION, rate),
            (AGAIN, rate),
            (DISPLACED, rate),
            (MOTION | AGAIN, acceleration),
            (MOTION | DISPLACED, acceleration),
            (AGAIN | DISPLACED, acceleration),
        ]),
        Path::Stopped | Path::Product => Nilpotent::constant(value),
    }
}

/// `work` less that against an element.
fn resisted(work: Nilpotent, [elastic, other, place]: [Nilpotent; 3]) -> Nilpotent {
    work.minus(elastic.plus(other).times(place.along(DISPLACED)))
}

/// All functions in the order in which the interpreter gives them: M, M q̈, Q, Φ_qᵀ λ, ∂Q/∂q, ∂Q/∂q̇, (M q̈)_q, (Φ_qᵀ λ)_q, Φ̇_qᵀ λ, λᵀγ̇,
/// kinetic and potential energy, powers, rates of states, outputs of multipliers and states. Matrices row by row.
pub fn run(model: &Model, declared: &Dynamics, state: &Evaluation) -> Vec<Expected> {
    let n = state.q.len();
    let one = |number: Nilpotent, set: usize| Expected {
        value: number.v[set],
        bound: number.b[set],
        torn: number.torn,
    };
    let numbers = |motion, displaced, varied| Numbers::of(model, state, motion, [displaced, varied]);
    let (mut mass, mut force_q, mut force_qd) = (Vec::new(), Vec::new(), Vec::new());
    let (mut mass_times_q, mut reaction_q) = (Vec::new(), Vec::new());
    let (mut mass_times, mut force, mut reaction) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..n {
        let (place, rate) = (Axis::Position(row), Axis::Velocity(row));
        for column in 0..n {
            let (by_place, by_rate) = (Axis::Position(column), Axis::Velocity(column));
            let [along, slow] = [place, rate].map(|axis| numbers(Path::Free, axis, by_place));
            let [turned, fast] = [place, rate].map(|axis| numbers(Path::Free, axis, by_rate));
            let forced = along.work(declared).minus(slow.loss(declared));
            force_q.push(one(forced, VARIED));
            force_qd.push(one(turned.work(declared).minus(fast.loss(declared)), VARIED));
            mass.push(one(entry(declared, &along, &fast), 0));
            let [places, rates] = [place, rate].map(|axis| numbers(Path::Product, axis, by_place));
            let product = inertial(declared, &places, &rates);
            mass_times_q.push(one(product, VARIED));
            let reacting = reacting(model, &along, state);
            reaction_q.push(one(reacting, VARIED));
            if column == 0 {
                force.push(one(forced, 0));
                mass_times.push(one(product, 0));
                reaction.push(one(reacting, 0));
            }
        }
    }
    let [plain, stopped] =
        [Path::Free, Path::Stopped].map(|motion| numbers(motion, Axis::Position(0), Axis::Position(0)));
    let mut expected: Vec<Expected> = [mass, mass_times, force, reaction].into_iter().flatten().collect();
    expected.extend([force_q, force_qd, mass_times_q, reaction_q].into_iter().flatten());
    expected.extend(third(model, state));
    expected.extend(plain.energies(declared).map(|energy| one(energy, 0)));
    let power = |force| one(plain.power(&stopped, force, state, model), 0);
    expected.extend(declared.forces.iter().map(power));
    expected.extend(declared.states.iter().map(|known| one(plain.optional(known.rate), 0)));
    expected.extend(declared.loads.iter().map(|load| one(plain.at(load.value), 0)));
    expected
}

/// An entry of M: displaced along its row and varied along its column, by positions and by rates.
fn entry(declared: &Dynamics, places: &Numbers, rates: &Numbers) -> Nilpotent {
    let mut entry = Nilpotent::constant(0.0);
    for body in &declared.bodies {
        for (inertia, place) in places.inertias(body) {
            entry = entry.plus(inertia.times(place.along(DISPLACED).times(place.along(VARIED))));
        }
    }
    for kinetic in &declared.kinetics {
        entry = entry.plus(rates.at(kinetic.value).along(DISPLACED).along(VARIED));
    }
    entry
}

/// A component of M x, x the motion: the momentum, displaced along positions and along rates.
fn inertial(declared: &Dynamics, places: &Numbers, rates: &Numbers) -> Nilpotent {
    let mut product = Nilpotent::constant(0.0);
    for body in &declared.bodies {
        for (inertia, place) in places.inertias(body) {
            product = product.plus(inertia.times(place.along(DISPLACED).times(place.along(MOTION))));
        }
    }
    for kinetic in &declared.kinetics {
        product = product.plus(rates.at(kinetic.value).along(DISPLACED));
    }
    product
}

/// Φ̇_qᵀ λ, and λᵀΦ less its third derivative along the motion.
fn third(model: &Model, state: &Evaluation) -> Vec<Expected> {
    let one = |number: Nilpotent, set: usize| Expected {
        value: number.v[set],
        bound: number.b[set],
        torn: number.torn,
    };
    let axes = |index: usize| Numbers::of(model, state, Path::Free, [Axis::Position(index); 2]);
    let mut found: Vec<Expected> =
        (0..state.q.len()).map(|index| one(reacting(model, &axes(index), state), MOTION)).collect();
    let along = Numbers::of(model, state, Path::Thrice, [Axis::Position(0); 2]);
    let rows = model.rows.iter().zip(&state.lambda).fold(Nilpotent::constant(0.0), |sum, (row, lambda)| {
        sum.minus(along.at(row.residual).times(Nilpotent::constant(*lambda)))
    });
    found.push(one(rows, MOTION | AGAIN | DISPLACED));
    found
}

/// A component of Φ_qᵀ λ.
fn reacting(model: &Model, numbers: &Numbers, state: &Evaluation) -> Nilpotent {
    model.rows.iter().zip(&state.lambda).fold(Nilpotent::constant(0.0), |sum, (row, lambda)| {
        sum.plus(numbers.at(row.residual).along(DISPLACED).times(Nilpotent::constant(*lambda)))
    })
}

//! An oracle of its own for a mechanism: the text itself, interpreted.
//!
//! Of the compiler of texts it uses the statements as they are written, nothing behind them. Names, shapes, units, derivatives,
//! energies and forces are read and computed here. So no fault of resolving, differentiation, structure or emission is shared. It
//! shares the reader of the language. A part of the language that it does not evaluate is a [`Gap`], which is told.

mod curves;
mod evaluation;
mod feet;
mod functions;
mod held;
mod laws;
mod mechanics;
mod number;
mod quantities;
mod rows;
mod state;
#[cfg(test)]
mod tests;
mod tree;

use std::collections::BTreeMap;
use std::rc::Rc;

use mbs_codegen::syntax_tree::{Element, Equation, Expression, Operation, Operator, StatementKind, Type};

use self::curves::Curve;
pub use self::evaluation::Gap;
use self::evaluation::{Definition, Names, Scope, Value, joined, value};
pub use self::feet::{Follower, Foot, Outline};
pub use self::held::{HeldForces, Slack};
pub use self::laws::Jet;
use self::laws::Laws;
use self::mechanics::mechanics;
use self::number::{Dual, Number};
pub use self::state::{Balance, OracleRow, OracleState, Quantity};
use self::tree::{Placed, unrolled};

/// Direction of the first derivative.
#[derive(Clone, Copy)]
enum Along<'a> {
    Nothing,
    Positions(&'a [f64]),
    Velocities(&'a [f64]),
}

/// A mechanism as its text says it.
#[derive(Debug)]
pub struct Oracle {
    placed: Rc<Vec<Placed>>,
    /// Names and shapes of coordinates and of first-order states.
    coordinates: Vec<(String, Vec<usize>)>,
    states: Vec<(String, Vec<usize>)>,
    /// `true` for each coordinate that is the same after a whole turn.
    turns: Vec<bool>,
    /// Constants, parameters and inputs.
    given: Rc<BTreeMap<String, Value>>,
    definitions: Rc<BTreeMap<String, Vec<Definition>>>,
    /// Functions of the caller, and curves.
    laws: Rc<Laws>,
    curves: Rc<Vec<Curve>>,
    /// Names of constraints and drives, with the indices of their rows.
    groups: Vec<(String, core::ops::Range<usize>)>,
    /// Constraints that effects release, with the number of rows that are not there.
    released: BTreeMap<String, usize>,
    /// Frictions with bristles by their places in the text: each has a state behind those of the text.
    bristled: Vec<usize>,
    /// Bodies whose Euler parameters are coordinates, by their places in the text: each has a row of its own, e·e = 1.
    turning: Vec<usize>,
}

/// Components of an array in their order.
fn components(name: &str, shape: &[usize]) -> Vec<String> {
    let mut names = vec![name.to_string()];
    for length in shape {
        names = names.iter().flat_map(|name| (0..*length).map(move |k| format!("{name}.{k}"))).collect();
    }
    names
}

impl Oracle {
    /// The text in a scene (`None`: all effects), with values of its parameters and inputs by component.
    ///
    /// # Errors
    /// The part of the text that cannot be read.
    pub fn read(source: &str, scene: Option<&str>, known: &dyn Fn(&str) -> Option<f64>) -> Result<Self, Gap> {
        Oracle::with_functions(source, scene, known, &|_| None)
    }

    /// The same with functions of the caller by their names, `lift` or `lift[0]`.
    ///
    /// # Errors
    /// The part of the text that cannot be read.
    pub fn with_functions(
        source: &str,
        scene: Option<&str>,
        known: &dyn Fn(&str) -> Option<f64>,
        functions: &dyn Fn(&str) -> Option<Jet>,
    ) -> Result<Self, Gap> {
        let mut oracle = Oracle::of_names(source, scene, known, functions)?;
        // A first look at a state without two equal numbers tells which bodies turn with coordinates, and how many rows there are.
        let count = oracle.states.iter().map(|(_, shape)| shape.iter().product::<usize>()).sum();
        let apart = |first: f64| (0..oracle.size()).map(|j| first + 0.017 * j as f64).collect::<Vec<_>>();
        let state =
            OracleState { q: apart(0.5), qd: apart(0.3), states: vec![0.0; count], ..OracleState::default() };
        oracle.turning = oracle.turning_bodies(&oracle.names(&state, Along::Nothing), &state)?;
        let mut groups = Vec::new();
        oracle.each_row(&oracle.names(&state, Along::Nothing), &mut |group, rows, _| {
            groups.push((group.to_string(), rows))
        })?;
        oracle.groups = groups;
        let mut released: BTreeMap<String, usize> = BTreeMap::new();
        oracle.each_row_of(true, &oracle.names(&state, Along::Nothing), &mut |group, rows, _| {
            *released.entry(group.to_string()).or_default() += rows.len();
        })?;
        oracle.released = released;
        Ok(oracle)
    }

    /// The same before its rows are looked at.
    fn of_names(
        source: &str,
        scene: Option<&str>,
        known: &dyn Fn(&str) -> Option<f64>,
        functions: &dyn Fn(&str) -> Option<Jet>,
    ) -> Result<Self, Gap> {
        let placed = unrolled(source, scene).map_err(Gap)?;
        let mut names = Names::default();
        let (mut coordinates, mut states, mut turns) = (Vec::new(), Vec::new(), Vec::new());
        let mut definitions: BTreeMap<String, Vec<Definition>> = BTreeMap::new();
        let (mut laws, mut curves) = (Laws::default(), Vec::new());
        for Placed { kind, rounds } in &placed {
            match kind {
                StatementKind::Const { name, value: expression, .. } => {
                    let found = value(expression, &Scope::of(&names, rounds))?;
                    names.moving.insert(name.text.clone(), found);
                }
                StatementKind::Param { name, kind, .. } | StatementKind::Input { name, kind, .. } => {
                    let shape = shape(kind, &names)?;
                    let component = |name: String| match known(&name) {
                        Some(value) => Ok(Number::still(value)),
                        None => Err(Gap(format!("`{name}`, whose value is not known"))),
                    };
                    let items: Result<Vec<_>, _> =
                        components(&name.text, &shape).into_iter().map(component).collect();
                    names.moving.insert(name.text.clone(), Value { shape, items: items? });
                }
                StatementKind::Coord { name, kind, .. } => {
                    let shape = shape(kind, &names)?;
                    let count = shape.iter().product::<usize>();
                    turns.extend(core::iter::repeat_n(kind.unit.text == "turn", count));
                    coordinates.push((name.text.clone(), shape));
                }
                StatementKind::State { name, kind, .. } => {
                    states.push((name.text.clone(), shape(kind, &names)?));
                }
                StatementKind::Let { name, value, .. } => {
                    let definition = Definition { rounds: rounds.clone(), value: value.clone() };
                    definitions.entry(name.text.clone()).or_default().push(definition);
                }
                StatementKind::Function { name, signature } => {
                    let name = &name.text;
                    let labels = match shape(&signature.value, &names)?.first() {
                        Some(length) => (0..*length).map(|index| format!("{name}[{index}]")).collect(),
                        None => vec![name.clone()],
                    };
                    for label in labels {
                        let law = functions(&label);
                        let law = law.ok_or_else(|| Gap(format!("the caller's function `{label}`")))?;
                        laws.known.insert(label, law);
                    }
                }
                StatementKind::Curve { name, centre, turned, functions } => curves.push(Curve {
                    name: name.text.clone(),
                    rounds: rounds.clone(),
                    centre: centre.clone(),
                    turned: turned.clone(),
                    functions: functions.clone(),
                }),
                _ => {}
            }
        }
        let (given, definitions) = (Rc::new(names.moving), Rc::new(definitions));
        let is_bristled = |(index, placed): (usize, &Placed)| {
            let StatementKind::Element { kind: Element::Friction, fields, .. } = &placed.kind else {
                return None;
            };
            fields.iter().any(|field| field.name.text == "bristles").then_some(index)
        };
        let bristled = placed.iter().enumerate().filter_map(is_bristled).collect();
        Ok(Oracle {
            placed: Rc::new(placed),
            coordinates,
            states,
            turns,
            given,
            definitions,
            laws: Rc::new(laws),
            curves: Rc::new(curves),
            groups: Vec::new(),
            released: BTreeMap::new(),
            bristled,
            turning: Vec::new(),
        })
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        self.coordinates.iter().map(|(_, shape)| shape.iter().product::<usize>()).sum()
    }

    /// `true` for each coordinate that is the same after a whole turn: N.
    pub fn turns(&self) -> &[bool] {
        &self.turns
    }

    /// Gives the first component of a parameter or an input another value.
    pub fn set(&mut self, name: &str, value: f64) {
        if let Some(known) = Rc::make_mut(&mut self.given).get_mut(name)
            && let Some(first) = known.items.first_mut()
        {
            *first = Number::still(value);
        }
    }

    /// A function of the caller whose derivatives contradict its values, where one was called so far.
    pub fn contradiction(&self) -> Option<String> {
        self.laws.fault()
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.groups.last().map_or(0, |(_, rows)| rows.end)
    }

    fn names(&self, state: &OracleState, along: Along<'_>) -> Names {
        let time = Dual { v: state.t, b: 1.0, ..Dual::default() };
        let mut names = Names {
            given: self.given.clone(),
            definitions: self.definitions.clone(),
            placed: self.placed.clone(),
            laws: self.laws.clone(),
            curves: self.curves.clone(),
            time: Number { value: time, rate: Dual::still(1.0) },
            ..Names::default()
        };
        let mut j = 0;
        for (name, shape) in &self.coordinates {
            let length = shape.iter().product::<usize>();
            let items = (j..j + length).map(|j| {
                let part = |values: &[f64]| values.get(j).copied().unwrap_or(0.0);
                let (on_q, on_qd) = match along {
                    Along::Nothing => (0.0, 0.0),
                    Along::Positions(w) => (part(w), 0.0),
                    Along::Velocities(w) => (0.0, part(w)),
                };
                Number {
                    value: Dual { v: part(&state.q), a: on_q, b: part(&state.qd), c: 0.0 },
                    rate: Dual { v: part(&state.qd), a: on_qd, b: part(&state.qdd), c: 0.0 },
                }
            });
            let value = Value { shape: shape.clone(), items: items.collect() };
            names.moving.insert(name.clone(), value);
            j += length;
        }
        let mut k = 0;
        for (name, shape) in &self.states {
            let length = shape.iter().product::<usize>();
            let number = |k| Number::still(state.states.get(k).copied().unwrap_or(f64::NAN));
            let items = (k..k + length).map(number).collect();
            names.moving.insert(name.clone(), Value { shape: shape.clone(), items });
            k += length;
        }
        let deflection = |(place, index): (usize, usize)| {
            (index, state.states.get(k + place).copied().unwrap_or(f64::NAN))
        };
        names.bristles = self.bristled.iter().copied().enumerate().map(deflection).collect();
        let multiplier = |row| Number::still(state.lambda.get(row).copied().unwrap_or(f64::NAN));
        for (group, rows) in &self.groups {
            names.lambda.entry(group.clone()).or_default().extend(rows.clone().map(multiplier));
        }
        for (group, rows) in &self.released {
            names.lambda.insert(group.clone(), vec![Number::still(0.0); *rows]);
        }
        names
    }

    /// Bodies whose orientation has coordinates among its components; of those with the same ones the first.
    fn turning_bodies(&self, names: &Names, state: &OracleState) -> Result<Vec<usize>, Gap> {
        let mut known: Vec<Vec<Option<usize>>> = Vec::new();
        let mut bodies = Vec::new();
        for (index, placed) in self.placed.iter().enumerate() {
            let Some(e) = orientation(placed, names)? else { continue };
            let coordinate = |e: &Number| {
                (0..state.q.len()).find(|j| e.value.v == state.q[*j] && e.rate.v == state.qd[*j])
            };
            let found: Vec<_> = e.iter().map(coordinate).collect();
            if found.iter().all(Option::is_none) || known.contains(&found) {
                continue;
            }
            if found.iter().all(Option::is_some) {
                known.push(found);
            }
            bodies.push(index);
        }
        Ok(bodies)
    }

    /// Σ |∂Φ/∂q_j| s_j of each row: what moves it where all coordinates move by their scales `scales`.
    ///
    /// # Errors
    /// The part of the rows that cannot be evaluated.
    pub fn gradients(&self, state: &OracleState, scales: &[f64]) -> Result<Vec<f64>, Gap> {
        let mut gradients = vec![0.0; self.row_count()];
        for (j, scale) in scales.iter().enumerate() {
            let mut w = vec![0.0; scales.len()];
            w[j] = *scale;
            self.each_row(&self.names(state, Along::Positions(&w)), &mut |_, rows, found| {
                let sums = gradients[rows].iter_mut().zip(found);
                sums.for_each(|(sum, (number, _))| *sum += number.value.a.abs());
            })?;
        }
        Ok(gradients)
    }

    /// The rows at a state.
    ///
    /// # Errors
    /// The part of the rows that cannot be evaluated.
    pub fn rows(&self, state: &OracleState) -> Result<Vec<OracleRow>, Gap> {
        let mut all = Vec::new();
        self.each_row(&self.names(state, Along::Nothing), &mut |_, _, found| {
            let row = |(number, is_known): &(Number, bool)| OracleRow {
                phi: is_known.then_some(number.value.v),
                rate: number.rate.v,
                second: number.rate.b,
            };
            all.extend(found.iter().map(row));
        })?;
        Ok(all)
    }

    /// wᵀ(M q̈ + Φ_qᵀ λ − Q) by Lagrange's equations, from the energies and the work of the forces along w (N).
    ///
    /// # Errors
    /// The part of the text that cannot be evaluated.
    pub fn equations_of_motion(&self, state: &OracleState, w: &[f64]) -> Result<Balance, Gap> {
        let (at, moving) = (self.names(state, Along::Positions(w)), self.names(state, Along::Velocities(w)));
        let (place, pace) = (mechanics(&self.placed, &at)?, mechanics(&self.placed, &moving)?);
        let mut balance = Balance::default();
        pace.kinetic.iter().for_each(|kinetic| balance.add(kinetic.c));
        place.kinetic.iter().for_each(|kinetic| balance.add(-kinetic.a));
        place.potential.iter().for_each(|potential| balance.add(potential.a));
        pace.dissipation.iter().for_each(|dissipation| balance.add(dissipation.a));
        place.forces.iter().for_each(|along| balance.add(-along.force * along.place.value.a));
        for (index, held) in place.held.iter().enumerate() {
            let force = state.held.get(index);
            let force = force
                .ok_or_else(|| Gap(format!("the force of `{}`, which is not in the state", held.name)))?;
            balance.add(-force * held.place.value.a);
        }
        self.each_row(&at, &mut |_, rows, found| {
            for ((number, _), row) in found.iter().zip(rows) {
                balance.add(state.lambda.get(row).copied().unwrap_or(f64::NAN) * number.value.a);
            }
        })?;
        Ok(balance)
    }

    /// Largest change of [`equations_of_motion`](Self::equations_of_motion) by the rounding of the state (N): of each position by
    /// `digit` times its scale, of each velocity by `digit` times itself. A spring of 1e9 N/m makes 2e-7 N of the last digit of 1 m.
    ///
    /// # Errors
    /// The part of the text that cannot be evaluated.
    pub fn rounding_of_equations(
        &self,
        state: &OracleState,
        w: &[f64],
        (scales, digit): (&[f64], f64),
    ) -> Result<f64, Gap> {
        let sum = self.equations_of_motion(state, w)?.sum;
        let mut change = 0.0;
        for (index, scale) in scales.iter().enumerate() {
            let [mut placed, mut paced] = [state.clone(), state.clone()];
            if let (Some(q), Some(qd)) = (placed.q.get_mut(index), paced.qd.get_mut(index)) {
                *q += digit * scale;
                *qd += digit * *qd;
            }
            for rounded in [placed, paced] {
                change += (self.equations_of_motion(&rounded, w)?.sum - sum).abs();
            }
        }
        Ok(change)
    }

    /// Kinetic and potential energy, T + V (J), and its rate (W) that velocities and accelerations give it.
    ///
    /// # Errors
    /// The part of the energies that cannot be evaluated.
    pub fn energy(&self, state: &OracleState) -> Result<[f64; 2], Gap> {
        let found = mechanics(&self.placed, &self.names(state, Along::Nothing))?;
        let all = found.kinetic.iter().chain(&found.potential);
        Ok(all.fold([0.0; 2], |[energy, rate], part| [energy + part.v, rate + part.b]))
    }

    /// Values of the branches that hold always, each positive where it holds.
    ///
    /// # Errors
    /// The part of a branch that cannot be evaluated.
    pub fn branches(&self, state: &OracleState) -> Result<Vec<(String, f64)>, Gap> {
        let names = self.names(state, Along::Nothing);
        let mut found = Vec::new();
        for Placed { kind, rounds } in self.placed.iter() {
            if let StatementKind::Branch { name, at_start: false, larger, smaller } = kind {
                let scope = Scope::of(&names, rounds);
                let [larger, smaller] = [larger, smaller].map(|side| value(side, &scope)?.number());
                found.push((name.text.clone(), (larger? - smaller?).value.v));
            }
        }
        Ok(found)
    }
}

fn shape(kind: &Type, names: &Names) -> Result<Vec<usize>, Gap> {
    kind.shape.iter().map(|length| value(length, &Scope::of(names, &[]))?.count()).collect()
}

/// The orientation of a body that has one.
fn orientation(placed: &Placed, names: &Names) -> Result<Option<Vec<Number>>, Gap> {
    let StatementKind::Element { kind: Element::Body, fields, .. } = &placed.kind else { return Ok(None) };
    let Some(field) = fields.iter().find(|field| field.name.text == "orientation") else { return Ok(None) };
    Ok(Some(value(&field.value, &Scope::of(names, &placed.rounds))?.items))
}

/// Left side less right side.
fn residual(equation: &Equation, scope: &Scope<'_>) -> Result<Value, Gap> {
    joined(Operator::Subtract, value(&equation.left, scope)?, value(&equation.right, scope)?)
}

/// The argument of `rate(…)` where it is all of the left side.
fn prescribed(equation: &Equation) -> Option<Expression> {
    let (last, argument) = equation.left.code.split_last()?;
    let is_rate = matches!(&last.operation, Operation::Call { function, order: 0, arguments: 1, indexed: false } if function == "rate");
    is_rate.then(|| Expression { code: argument.to_vec() })
}

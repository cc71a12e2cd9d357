//! First-order states with their rates, and starts of coordinates: statements → model, units and dependence checked.

use proc_macro2::Span;

use super::expression::Node;
use super::initialiser::{filling, initialiser};
use super::names::Symbol;
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::syntax::ast::Expression;

impl Resolver<'_> {
    /// `der(state) == rate;`
    pub(super) fn rate_of_state(
        &mut self,
        state: &Expression,
        rate: &Expression,
        span: Span,
    ) -> Result<(), Fault> {
        let state = self.elaborate(Reach::Force, |work| work.value(state))?;
        let found = self.elaborate(Reach::Force, |work| {
            let rate = work.value(rate)?;
            work.same_shape(&state, &rate, "`==`", rate.span)?;
            let dimensions = state.items.iter().map(|item| item.quantity.dimension().over(Dimension::SECOND));
            let pairs: Vec<_> = dimensions.zip(&rate.items).collect();
            for (dimension, item) in &pairs {
                let expected = Scalar { quantity: Quantity::Known(*dimension), ..**item };
                work.agree(expected, **item)?;
            }
            Ok::<_, Fault>(rate)
        });
        // A faulty rate is one all the same: that it is missing would be a second fault.
        let faulty = self.model.expressions.push(Node::Number(0.0));
        let rates = found.as_ref().map(|rate| rate.items.iter().map(|item| item.id).collect());
        let rates: Vec<_> = rates.unwrap_or_else(|_| vec![faulty; state.items.len()]);
        for (state, rate) in state.items.iter().zip(rates) {
            let Node::State(index) = self.model.expressions.node(state.id) else {
                let help = "only what `state z: … = 0;` declares has a rate of its own";
                return Err(self.fault(state.span, "this is no state", help));
            };
            let slot = self.dynamics().states.get_mut(index).ok_or(Fault)?;
            if slot.rate.is_some() {
                let message = format!("the rate of `{}` is given twice", slot.name);
                return Err(self.fault(span, message, "remove one of the equations"));
            }
            slot.rate = Some(rate);
        }
        found.map(|_| ())
    }

    /// `start x = value rate value;`
    pub(super) fn start(
        &mut self,
        coordinate: &Expression,
        value: &Expression,
        rate: Option<&Expression>,
        span: Span,
    ) -> Result<(), Fault> {
        let coordinate = self.elaborate(Reach::Position, |work| work.value(coordinate))?;
        let value = self.start_value(value, &coordinate, Dimension::NUMBER)?;
        let rate = rate.map(|rate| self.start_value(rate, &coordinate, Dimension::SECOND)).transpose()?;
        if rate.is_some() && self.model.dynamics.is_none() {
            let help = "leave the rate out: the rows give it; or declare masses: `body rod { … }`";
            return Err(self.fault(span, "a start rate stands in a text without masses", help));
        }
        for (component, item) in coordinate.items.iter().enumerate() {
            let Node::Coordinate(index) = self.model.expressions.node(item.id) else {
                return Err(self.fault(
                    item.span,
                    "this is no coordinate",
                    "write `start phi1 = 0.3 rate 2.0;`",
                ));
            };
            if self.starts.contains(&index) {
                let help = "remove one of the statements";
                return Err(self.fault(item.span, "this coordinate has a start already", help));
            }
            self.starts.insert(index);
            let at = |value: &Value| value.items.get(component).map(|item| item.id);
            if let Some(coordinate) = self.model.coordinates.get_mut(index) {
                coordinate.guess = at(&value);
            }
            let rate = rate.as_ref().and_then(at);
            if let Some(dynamics) = &mut self.model.dynamics {
                dynamics.started.push(index);
                dynamics.rates.extend(rate.map(|rate| (index, rate)));
            }
        }
        Ok(())
    }

    /// A value in the unit of `coordinate` per `per`, of parameters alone; a scalar fills every component.
    fn start_value(
        &mut self,
        value: &Expression,
        coordinate: &Value,
        per: Dimension,
    ) -> Result<Value, Fault> {
        let value = self.elaborate(Reach::Position, |work| {
            let written = value;
            let value = work.value(value)?;
            if per == Dimension::NUMBER {
                work.beside_angle((coordinate, &[]), &written.code)?;
            }
            let dimension =
                coordinate.items.first().map(|item| item.quantity.dimension()).unwrap_or_default();
            let value = work.concerning(Place::Sides, (written, None), |work| {
                initialiser(work, value, dimension.over(per))
            })?;
            filling(work, value, &coordinate.shape)
        })?;
        if value.items.iter().all(|item| self.model.is_constant(item.id)) {
            return Ok(value);
        }
        Err(self.fault(value.span, "a start varies", "make it of numbers, constants and parameters"))
    }

    /// Refuses a state in a place, which depends on coordinates alone.
    pub(super) fn stateless(&mut self, value: &Value) -> Result<(), Fault> {
        let plain = |node| !matches!(node, Node::State(_));
        if value.items.iter().all(|item| self.model.made_of(item.id, plain)) {
            return Ok(());
        }
        Err(self.fault(
            value.span,
            "a state stands in a place",
            "states may stand in forces and outputs alone",
        ))
    }

    /// Every state has a rate, and its start is constant; no row, branch, limit or guess uses one.
    pub(super) fn check_states(&mut self) {
        let (model, model_names) = (&*self.model, &*self.names);
        let is_given_up = |name: &str| {
            let declared = name.split('.').next().unwrap_or(name);
            matches!(model_names.get(declared), Some(Symbol::Faulty))
        };
        let Some(dynamics) = model.dynamics.as_ref().filter(|dynamics| !dynamics.states.is_empty()) else {
            return;
        };
        let plain = |node| !matches!(node, Node::State(_));
        let rows = model.rows.iter().map(|row| (row.residual, row.span, &row.name));
        let branches = model.branches.iter().map(|branch| (branch.value, branch.span, &branch.name));
        let guesses = model.coordinates.iter().filter_map(|c| Some((c.guess?, c.span, &c.name)));
        let limits = model.limits.iter().map(|limit| (limit.value, limit.span, &limit.name));
        for (value, span, name) in rows.chain(branches).chain(limits).chain(guesses) {
            if !model.made_of(value, plain) {
                let help = "states may stand in forces and outputs alone; what a row needs is a `coord`";
                self.diagnostics.report(span, format!("`{name}` uses a state"), help);
            }
        }
        for state in &dynamics.states {
            if state.start.is_some_and(|start| !model.is_constant(start)) {
                let message = format!("the start of `{}` varies", state.name);
                self.diagnostics.report(state.span, message, "make it of numbers, constants and parameters");
            }
            let is_faulty = model_names.faulty_rate || is_given_up(&state.name);
            if state.rate.is_none() && !is_faulty {
                let message = format!("state `{}` has no rate", state.name);
                self.diagnostics.report(state.span, message, format!("write `der({}) == …;`", state.name));
            }
        }
    }
}

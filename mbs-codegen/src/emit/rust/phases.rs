//! Drives that prescribe a rate: start and advance of their phases.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::emit::rust::code::lets;
use crate::emit::rust::scope::{Scope, number, place};
use crate::equations::Equations;
use crate::equations::folds::folding;
use crate::equations::turns::{Turning, turning};
use crate::model::{Model, VariableKind};
use crate::program::Program;
use crate::symbolic::{Leaf, Node, NodeId};

/// `start_phases`, `advance_phases` and `phase_rates`, and the inherent function of the prescribed rates at a time; all empty
/// where no drive prescribes a rate.
pub fn functions(equations: &Equations, program: &Program, scope: &Scope<'_>) -> (String, String) {
    if equations.phases.is_empty() {
        return (String::new(), String::new());
    }
    let functions = start(equations, program, scope) + &advance(equations, scope) + RATES;
    (functions, speeds(equations, program, scope))
}

/// `phase_rates`, from the inherent function.
const RATES: &str = "#[inline]\nfn phase_rates(&self, __t: T) -> Self::Phases {\n\
                     self.__speeds(__t).map(__mbs::Phase::derivative)\n}\n";

/// `FOLDING`, where rows may come back on the way of a parameter or an input.
pub fn folds(equations: &Equations, model: &Model) -> String {
    let indices: Vec<String> = folding(model, equations).iter().map(|index| index.to_string()).collect();
    if indices.is_empty() {
        return String::new();
    }
    format!("const FOLDING: &'static [::core::primitive::u16] = &[{}];\n", indices.join(", "))
}

/// `TURNS` and `turn_back`, where coordinates turn.
pub fn turns(equations: &Equations, model: &Model) -> String {
    let turning = turning(model, equations);
    if turning.is_empty() {
        return String::new();
    }
    let indices: Vec<String> = turning.iter().map(|turning| turning.coordinate.to_string()).collect();
    let mut text = format!("const TURNS: &'static [::core::primitive::u16] = &[{}];\n", indices.join(", "));
    let fields: Vec<String> = fields(model).collect();
    let mut arms = String::new();
    for Turning { coordinate, phases } in &turning {
        let mut arm = String::new();
        for (field, count) in phases.iter().filter_map(|(phase, count)| Some((fields.get(*phase)?, count))) {
            let turns = match count {
                1 => "__turns".to_owned(),
                _ => format!("::core::primitive::i64::saturating_mul(__turns, {count})"),
            };
            let _ = writeln!(arm, "{field} = {field}.turned_back({turns});");
        }
        if !arm.is_empty() {
            let _ = writeln!(arms, "{coordinate} => {{\n{arm}}}");
        }
    }
    if !arms.is_empty() {
        let _ = writeln!(
            text,
            "#[inline]\nfn turn_back(&mut self, __coordinate: ::core::primitive::u16, __turns: ::core::primitive::i64) \
             {{\nmatch __coordinate {{\n{arms}_ => {{}}\n}}\n}}"
        );
    }
    text
}

fn start(equations: &Equations, program: &Program, scope: &Scope<'_>) -> String {
    let n = scope.model.coordinates.len();
    let mut text = format!("#[inline]\nfn start_phases(&mut self, __q: &[T; {n}], __t: T) {{\n");
    lets(&program.phase_arguments, scope, &mut text);
    let starts: Vec<String> = equations.phases.iter().map(|phase| scope.operand(phase.argument)).collect();
    let _ = writeln!(text, "let __starts = [{}];\nlet __speeds = self.__speeds(__t);", starts.join(", "));
    for (index, field) in fields(scope.model).enumerate() {
        let _ = writeln!(text, "{field} = __mbs::Phase::new(__starts[{index}], __speeds[{index}]);");
    }
    text + "}\n"
}

fn advance(equations: &Equations, scope: &Scope<'_>) -> String {
    let inputs: BTreeSet<NodeId> = moving_inputs(equations, scope.model);
    let varies = |speed: NodeId| {
        let varying = |id: NodeId| inputs.contains(&id) || scope.graph.node(id) == Node::Leaf(Leaf::Time);
        scope.graph.reachable([speed]).into_iter().any(varying)
    };
    let varying: Vec<bool> = equations.phases.iter().map(|phase| varies(phase.speed)).collect();
    let mut text = String::new();
    let mut given = String::new();
    if varying.contains(&true) {
        text += "let __means = __mbs::__private::means(__from, __to, |__t, __ahead| {\n";
        let places = |id: &NodeId| match scope.graph.node(*id) {
            Node::Leaf(Leaf::Input(index)) => Some(place(scope.model, index as usize)),
            _ => None,
        };
        let places: BTreeSet<String> = inputs.iter().filter_map(places).collect();
        if places.is_empty() {
            // The time alone varies.
            text += "self.__speeds(__t)\n});\n";
        } else {
            let places: Vec<String> = places.into_iter().map(|place| format!("self.{place}")).collect();
            for (index, place) in places.iter().enumerate() {
                let _ = writeln!(text, "{place} = __given[{index}].moved(__ahead);");
            }
            let fields = places.join(", ");
            text += "self.__speeds(__t)\n});\n";
            let _ = writeln!(text, "[{fields}] = __given;");
            // Moved in place and put back: a copy of the mechanism would carry its tables along.
            given = format!("let __given = [{fields}];\n");
        }
    }
    for (index, (field, varies)) in fields(scope.model).zip(varying).enumerate() {
        let mean = match varies {
            true => format!("__means[{index}]"),
            false => format!("[__speeds[{index}].value, {}]", number(0.0)),
        };
        let _ = writeln!(text, "{field} = {field}.moved({mean}, __to - __from, __speeds[{index}]);");
    }
    format!(
        "#[inline]\nfn advance_phases(&mut self, __from: T, __to: T) {{\n\
         let __speeds = self.__speeds(__to);\n{given}{text}}}\n"
    )
}

fn speeds(equations: &Equations, program: &Program, scope: &Scope<'_>) -> String {
    let count = equations.phases.len();
    let mut body = String::new();
    lets(&program.phase_speeds, scope, &mut body);
    let speeds: Vec<String> = equations
        .phases
        .iter()
        .map(|phase| {
            let (value, rate) = (scope.operand(phase.speed), scope.or_zero(phase.acceleration));
            format!("__mbs::Speed {{ value: {value}, rate: {rate} }}")
        })
        .collect();
    format!(
        "/// Prescribed rates with their time derivatives.\n#[inline]\n\
         fn __speeds(&self, __t: T) -> [__mbs::Speed<T>; {count}] {{\n{body}[{}]\n}}\n",
        speeds.join(", ")
    )
}

/// Places of the phases in `self`.
fn fields(model: &Model) -> impl Iterator<Item = String> + '_ {
    model.phase_fields().map(|field| format!("self.{}", place(model, field.first)))
}

/// Values and rates of inputs that move within a step, as far as speeds use them.
fn moving_inputs(equations: &Equations, model: &Model) -> BTreeSet<NodeId> {
    let moves = |index: u32| {
        let kind = model.variables.get(index as usize).map(|variable| variable.kind);
        matches!(kind, Some(VariableKind::InputWithRates | VariableKind::InputRate))
    };
    let graph = &equations.graph;
    let used = graph.reachable(equations.phases.iter().map(|phase| phase.speed));
    let is_moving = |id: &NodeId| matches!(graph.node(*id), Node::Leaf(Leaf::Input(index)) if moves(index));
    used.into_iter().filter(is_moving).collect()
}

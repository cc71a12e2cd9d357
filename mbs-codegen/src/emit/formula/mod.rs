//! The third back end: Φ and its derivatives as formulas to read.

pub(crate) mod atom;
pub(crate) mod notation;
pub(crate) mod terms;

use crate::emit::formula::atom::{Atom, Rank};
use crate::emit::formula::notation::Notation;
use crate::emit::formula::terms::Sum;
use crate::equations::Equations;
use crate::model::{Model, VariableKind};
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Formulas of a mechanism, entry by entry; `0` where an entry is structurally zero.
///
/// Constants of the text are numbers in them, parameters and inputs go by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Formulas {
    /// Name of the mechanism.
    pub name: String,
    /// Coordinates: N.
    pub coordinates: Vec<String>,
    /// Parameters and inputs, component by component, rates of inputs after their values.
    pub variables: Vec<String>,
    /// Names of the rows: M.
    pub rows: Vec<String>,
    /// Φ: M.
    pub phi: Vec<String>,
    /// Φ_q: M rows of N.
    pub phi_q: Vec<Vec<String>>,
    /// Φ_t: M.
    pub phi_t: Vec<String>,
    /// Φ_tt: M.
    pub phi_tt: Vec<String>,
    /// Φ_qt q̇: M.
    pub phi_qt_qd: Vec<String>,
    /// γ = −(Φ_q q̇)_q q̇ − 2 Φ_qt q̇ − Φ_tt: M.
    pub gamma: Vec<String>,
    /// Names and formulas of long parts that the entries share; each uses earlier ones alone.
    pub definitions: Vec<(String, String)>,
}

/// Formulas of masses and forces, entry by entry; `0` where an entry is structurally zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DynamicFormulas {
    /// Coordinates: N.
    pub coordinates: Vec<String>,
    /// M: N rows of N.
    pub mass: Vec<Vec<String>>,
    /// Q, inertia forces of the velocities included: N.
    pub force: Vec<String>,
    /// Kinetic energy.
    pub kinetic: String,
    /// Potential energy.
    pub potential: String,
    /// Names and formulas of long parts that the entries share; each uses earlier ones alone.
    pub definitions: Vec<(String, String)>,
}

/// Longest part (bytes) that is written out within another. A longer one has a name, so that text grows with the
/// graph and not with the tree that the graph unfolds to. LaTeX needs thrice the letters for the same formula.
const LONGEST_PART: usize = 240;
const LONGEST_LATEX: usize = 720;

/// Before: a model without faults and its equations. After: every entry as text.
pub fn formulas(model: &Model, equations: &Equations, name: &str, notation: Notation) -> Formulas {
    let mut printer = Printer::new(model, &equations.graph, notation, ["e", "w", "z", "part"]);
    let rows = &equations.rows;
    let roots = rows.iter().flat_map(|row| {
        let entries = row.phi_q.iter().map(|(_, entry)| *entry);
        let rates = [row.phi_t, row.phi_tt, row.phi_qt_qd, row.gamma].into_iter().flatten();
        core::iter::once(row.phi).chain(entries).chain(rates)
    });
    printer.unfold(roots);
    let entry = |row: &crate::equations::Row, column: usize| {
        row.phi_q.iter().find(|(known, _)| *known == column).map(|(_, entry)| *entry)
    };
    let columns = model.coordinates.len();
    let print = |id: Option<NodeId>| printer.text(id);
    Formulas {
        name: name.into(),
        coordinates: model.coordinates.iter().map(|c| notation.name(&c.name, 0)).collect(),
        variables: (0..model.variables.len()).map(|index| variable(model, index, notation)).collect(),
        rows: model.rows.iter().map(|row| notation.label(&row.name)).collect(),
        phi: rows.iter().map(|row| print(Some(row.phi))).collect(),
        phi_q: rows.iter().map(|row| (0..columns).map(|c| print(entry(row, c))).collect()).collect(),
        phi_t: rows.iter().map(|row| print(row.phi_t)).collect(),
        phi_tt: rows.iter().map(|row| print(row.phi_tt)).collect(),
        phi_qt_qd: rows.iter().map(|row| print(row.phi_qt_qd)).collect(),
        gamma: rows.iter().map(|row| print(row.gamma)).collect(),
        definitions: printer.definitions,
    }
}

/// Before: a model without faults and its equations. After: M, Q and the energies as text; `None` where the text has no
/// masses.
pub fn dynamic_formulas(model: &Model, equations: &Equations, notation: Notation) -> Option<DynamicFormulas> {
    let dynamics = equations.dynamics.as_ref()?;
    // Names other than those of the rows' parts, which may occur together with them.
    let mut printer = Printer::new(model, &equations.graph, notation, ["d", "u", "v", "piece"]);
    let masses = dynamics.mass.iter().flatten().map(|(_, entry)| *entry);
    let energies = [dynamics.kinetic, dynamics.potential].into_iter().flatten();
    printer.unfold(masses.chain(dynamics.force.iter().copied().flatten()).chain(energies));
    let print = |id: Option<NodeId>| printer.text(id);
    let columns = model.coordinates.len();
    let entry = |row: &[(usize, NodeId)], column: usize| {
        row.iter().find(|(known, _)| *known == column).map(|(_, entry)| *entry)
    };
    Some(DynamicFormulas {
        coordinates: model.coordinates.iter().map(|c| notation.name(&c.name, 0)).collect(),
        mass: dynamics.mass.iter().map(|row| (0..columns).map(|c| print(entry(row, c))).collect()).collect(),
        force: dynamics.force.iter().map(|force| print(*force)).collect(),
        kinetic: print(dynamics.kinetic),
        potential: print(dynamics.potential),
        definitions: printer.definitions,
    })
}

/// A parameter or input by its name; the rates of an input by that of the input.
fn variable(model: &Model, index: usize, notation: Notation) -> String {
    let Some(variable) = model.variables.get(index) else { return "?".into() };
    let rate = variable.kind == VariableKind::InputRate;
    match variable.name.rsplit_once('.') {
        Some((input, "rate")) if rate => notation.name(input, 1),
        Some((input, "acceleration")) if rate => notation.name(input, 2),
        _ => notation.name(&variable.name, 0),
    }
}

struct Printer<'a> {
    model: &'a Model,
    graph: &'a Graph,
    notation: Notation,
    /// Formula of each node, once it is known.
    sums: Vec<Option<Sum>>,
    /// Name of a node within other formulas, where its own is too long to be written out.
    names: Vec<Option<Sum>>,
    definitions: Vec<(String, String)>,
    /// Start of the names of parts; no name of the text is this and a number.
    prefix: &'static str,
}

impl<'a> Printer<'a> {
    fn new(model: &'a Model, graph: &'a Graph, notation: Notation, prefixes: [&'static str; 4]) -> Self {
        let taken = |prefix: &&str| {
            let coordinates = model.coordinates.iter().map(|c| &c.name);
            let mut names = coordinates.chain(model.variables.iter().map(|v| &v.name));
            let is_number = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit());
            names.any(|name| name.strip_prefix(*prefix).is_some_and(is_number))
        };
        let prefix = prefixes.into_iter().find(|prefix| !taken(prefix)).unwrap_or("part_");
        let empty = || vec![None; graph.len()];
        Printer { model, graph, notation, sums: empty(), names: empty(), definitions: Vec::new(), prefix }
    }

    /// Operands precede their users, so that one pass is enough.
    fn unfold(&mut self, roots: impl Iterator<Item = NodeId>) {
        for id in self.graph.reachable(roots) {
            let node = self.graph.node(id);
            node.operands().for_each(|operand| self.name_if_long(operand));
            let sum = self.sum(node);
            if let Some(slot) = self.sums.get_mut(id.index()) {
                *slot = Some(sum);
            }
        }
    }

    fn name_if_long(&mut self, id: NodeId) {
        let named = self.names.get(id.index()).is_none_or(Option::is_some);
        let Some(Some(sum)) = self.sums.get(id.index()).filter(|_| !named) else { return };
        let text = sum.text(self.notation);
        let longest = if self.notation == Notation::Text { LONGEST_PART } else { LONGEST_LATEX };
        if text.len() <= longest {
            return;
        }
        let name = self.notation.name(&format!("{}{}", self.prefix, self.definitions.len() + 1), 0);
        let atom = Atom { head: name.clone(), tail: String::new(), rank: Rank::Variable };
        if let Some(slot) = self.names.get_mut(id.index()) {
            *slot = Some(Sum::atom(atom));
        }
        self.definitions.push((name, text));
    }

    /// Name of an operand, or its formula where it has none.
    fn operand(&self, id: NodeId) -> Sum {
        let of = |sums: &[Option<Sum>]| sums.get(id.index()).cloned().flatten();
        of(&self.names).or_else(|| of(&self.sums)).unwrap_or_else(|| Sum::number(f64::NAN, self.notation))
    }

    fn sum(&self, node: Node) -> Sum {
        let notation = self.notation;
        let (of, text) = (|id| self.operand(id), |id| self.operand(id).text(notation));
        match node {
            Node::Constant(bits) => Sum::number(f64::from_bits(bits), notation),
            Node::Leaf(leaf) => Sum::atom(self.leaf(leaf)),
            Node::Unary(Unary::Negate, a) => of(a).negated(),
            Node::Unary(function, a) => Sum::atom(notation.call(function, &text(a), is_symbol(&of(a)))),
            Node::Binary(Binary::Add, a, b) => of(a).plus(&of(b)),
            Node::Binary(Binary::Subtract, a, b) => of(a).plus(&of(b).negated()),
            Node::Binary(Binary::Multiply, a, b) => of(a).times(&of(b), notation),
            Node::Binary(Binary::Divide, a, b) => of(a).over(&of(b), notation),
            Node::Binary(Binary::Power, a, b) => {
                let (base, exponent) = (of(a), of(b));
                let one_exponent = is_symbol(&exponent) || exponent.is_number();
                let (base, one_base) = (base.text(notation), is_symbol(&base));
                let exponent = exponent.text(notation);
                Sum::atom(notation.general_power((&base, one_base), (&exponent, one_exponent)))
            }
            Node::Binary(function, a, b) => Sum::atom(notation.call_two(function, &text(a), &text(b))),
            Node::Call { function, order, argument } => {
                let function = self.model.functions.get(function as usize);
                let name = function.map_or_else(
                    || "?".into(),
                    |function| match notation {
                        Notation::Text => function.label(),
                        Notation::Latex => function.component(),
                    },
                );
                Sum::atom(notation.declared(&name, usize::from(order), &text(argument)))
            }
            Node::Select { less, than, yes, no } => {
                let [less, than, yes, no] = [less, than, yes, no].map(text);
                Sum::atom(notation.choice([&less, &than, &yes, &no]))
            }
        }
    }

    fn leaf(&self, leaf: Leaf) -> Atom {
        let coordinate = |index: u32, order: usize| {
            let found = self.model.coordinates.get(index as usize);
            self.notation.name(found.map_or("?", |coordinate| &coordinate.name), order)
        };
        let (head, rank) = match leaf {
            Leaf::Parameter(index) => (variable(self.model, index as usize, self.notation), Rank::Parameter),
            Leaf::Input(index) => (variable(self.model, index as usize, self.notation), Rank::Variable),
            Leaf::Time => ("t".into(), Rank::Variable),
            Leaf::Position(index) => (coordinate(index, 0), Rank::Variable),
            Leaf::Velocity(index) => (coordinate(index, 1), Rank::Rate),
            Leaf::Acceleration(index) => (coordinate(index, 2), Rank::Rate),
            Leaf::State(index) => {
                let state = self.model.dynamics.as_ref().and_then(|d| d.states.get(index as usize));
                (self.notation.name(state.map_or("?", |state| &state.name), 0), Rank::Variable)
            }
            Leaf::Multiplier(index) | Leaf::Direction(index) => {
                (self.notation.name(&format!("lambda.{index}"), 0), Rank::Rate)
            }
            Leaf::Sliding(index) => (self.notation.name(&format!("sigma.{index}"), 0), Rank::Rate),
            Leaf::Holding(index) => (self.notation.name(&format!("h.{index}"), 0), Rank::Rate),
            Leaf::Impulse(index) => (self.notation.name(&format!("P.{index}"), 0), Rank::Rate),
            Leaf::Remembered(index) => {
                let dynamics = self.model.dynamics.as_ref();
                let name = dynamics.and_then(|dynamics| dynamics.remembered(index as usize));
                (self.notation.name(name.unwrap_or("?"), 0), Rank::Rate)
            }
            // Occurs in outputs alone, which have no formulas here.
            Leaf::Given(..) => ("?".into(), Rank::Variable),
        };
        Atom { head, tail: String::new(), rank }
    }

    /// The whole entry; 0 where there is none.
    fn text(&self, id: Option<NodeId>) -> String {
        let sum = id.and_then(|id| self.sums.get(id.index()).and_then(Option::as_ref));
        sum.map_or_else(|| "0".into(), |sum| sum.text(self.notation))
    }
}

/// `true` if a function may precede it without parentheses.
fn is_symbol(sum: &Sum) -> bool {
    sum.as_atom().is_some_and(|atom| atom.rank < Rank::Function)
}

#[cfg(test)]
mod tests;

//! Scalar expressions in one arena; operands always precede their users.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Span;

use super::units::Dimension;
use crate::symbolic::{Binary, Unary};

/// A length of the text, and its place there.
#[derive(Clone, Debug)]
pub struct Length {
    /// Its magnitude (m).
    pub length: f64,
    /// The constant, `guess of x`, or the number itself.
    pub name: String,
    /// Place in the text.
    pub span: Span,
}

/// Index into [`Expressions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Id(u32);

/// A scalar expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number, in SI.
    Number(f64),
    /// The time.
    Time,
    /// A coordinate by its index.
    Coordinate(usize),
    /// A parameter or input by its index.
    Variable(usize),
    /// A first-order state by its index.
    State(usize),
    /// The multiplier λ of a row by the row's index.
    Multiplier(usize),
    /// Direction in which a friction with stiction slides by its index: 1, −1, or 0 where it sticks.
    Sliding(usize),
    /// Force along the length with which it sticks; 0 where it slides.
    Holding(usize),
    /// Impulse of the last impact of a rigid contact, by its index among the set-valued forces.
    Impulse(usize),
    /// A value that events set: of one that holds 1, otherwise 0; then those that they latch.
    Remembered(usize),
    /// A component of the force of a pin on the first of its bodies, by the pin's index.
    Pin(usize, usize),
    /// A function of one argument.
    Unary(Unary, Id),
    /// A function of two arguments.
    Binary(Binary, Id, Id),
    /// Total time derivative of first or second order.
    Rate(Id, u8),
    /// A declared function by its index, or its derivative of this order, at an argument.
    Call { function: usize, order: u8, argument: Id },
    /// Margin to singularity of the blocks that hold the rows of a constraint or drive, by its index.
    Margin(usize),
    /// ∂/∂drive of an expression, by the drive's row.
    Ratio(Id, usize),
}

/// A call of a declared function as the text writes it.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// The [`Node::Call`].
    pub id: Id,
    /// The function's name there.
    pub span: Span,
}

/// An end of the arena.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    nodes: usize,
    calls: usize,
    lengths: usize,
}

/// The arena.
#[derive(Clone, Debug, Default)]
pub struct Expressions {
    nodes: Vec<Node>,
    operations: usize,
    /// Expressions that were taken back.
    spent: usize,
    /// Forces of rows that are not there, and what is 0 with them.
    absent: BTreeSet<Id>,
    /// Expressions that partial derivatives went through.
    visited: usize,
    calls: Vec<Call>,
    /// Lengths of the text, in the order in which they were met.
    lengths: Vec<Length>,
    /// Numbers that are lengths or their powers, each with the largest length that it is made of.
    measures: BTreeMap<Id, usize>,
    /// Numbers with metres in their unit that are no power of a length, as a speed.
    rates_of_length: BTreeSet<Id>,
}

impl Expressions {
    /// Adds an expression.
    pub fn push(&mut self, node: Node) -> Id {
        self.operations += usize::from(node.operands().next().is_some());
        self.nodes.push(node);
        Id((self.nodes.len() - 1) as u32)
    }

    /// Adds a call at `span`.
    pub fn push_call(&mut self, function: usize, order: u8, argument: Id, span: Span) -> Id {
        let id = self.push(Node::Call { function, order, argument });
        self.calls.push(Call { id, span });
        id
    }

    /// The end of the arena so far.
    pub fn mark(&self) -> Mark {
        Mark { nodes: self.nodes.len(), calls: self.calls.len(), lengths: self.lengths.len() }
    }

    /// Takes back what was added since `mark`, which nothing else uses. It counts as spent nevertheless.
    pub fn restore(&mut self, mark: Mark) {
        self.spent = self.spent.saturating_add(self.nodes.len().saturating_sub(mark.nodes));
        self.nodes.truncate(mark.nodes);
        self.calls.truncate(mark.calls);
        self.lengths.truncate(mark.lengths);
        let end = Id(mark.nodes as u32);
        self.measures.split_off(&end);
        self.rates_of_length.split_off(&end);
        self.absent.split_off(&end);
    }

    /// Adds the force of a row that is not there.
    pub fn push_absent(&mut self) -> Id {
        let id = self.push(Node::Number(0.0));
        self.absent.insert(id);
        id
    }

    /// `true` if it is 0 because a row is not there.
    pub fn is_absent(&self, id: Id) -> bool {
        self.absent.contains(&id)
    }

    /// Counts `more` expressions that a partial derivative goes through; `false` where all of them are more than `most`.
    pub fn spend(&mut self, more: usize, most: usize) -> bool {
        self.visited = self.visited.saturating_add(more);
        self.visited <= most
    }

    /// `roots` and the expressions that they depend on, operands first.
    pub fn operands_first(&self, roots: &[Id]) -> BTreeSet<Id> {
        let mut found = BTreeSet::new();
        let mut waiting = roots.to_vec();
        while let Some(id) = waiting.pop() {
            if found.insert(id) {
                waiting.extend(self.node(id).operands());
            }
        }
        found
    }

    /// Calls of declared functions, in the order in which they were added.
    pub fn calls(&self) -> &[Call] {
        &self.calls
    }

    /// Before: a number of the unit `dimension`. After: in a power of the metre it has its name as a length of the text, of
    /// an area or a volume the side. In another unit with metres it is noted. Zero is none.
    pub fn name_length(
        &mut self,
        id: Id,
        dimension: Dimension,
        name: impl FnOnce(f64) -> String,
        span: Span,
    ) {
        let Node::Number(number) = self.node(id) else { return };
        if number == 0.0 || dimension.metres() == 0.0 {
            return;
        }
        if !dimension.is_power_of_length() {
            self.rates_of_length.insert(id);
            return;
        }
        let length = dimension.side(number.abs());
        self.measures.insert(id, self.lengths.len());
        self.lengths.push(Length { length, name: name(length), span });
    }

    /// `true` if a number has metres in its unit and is no power of a length.
    pub fn is_rate_of_length(&self, id: Id) -> bool {
        self.rates_of_length.contains(&id)
    }

    /// `true` if a number is a length of the text, or made of one.
    pub fn measures(&self, id: Id) -> bool {
        self.measures.contains_key(&id)
    }

    /// Before: a number of the unit `dimension`, computed from others. After: in metres, square metres and so on it is made of
    /// their lengths, in another unit with metres it is noted; the millimetre of a stiffness is none of the mechanism.
    pub fn inherit_length(&mut self, id: Id, dimension: Dimension, operands: impl Iterator<Item = Id>) {
        if !dimension.is_power_of_length() {
            if let (Node::Number(_), true) = (self.node(id), dimension.metres() != 0.0) {
                self.rates_of_length.insert(id);
            }
            return;
        }
        let lengths = operands.filter_map(|operand| self.measures.get(&operand).copied());
        if let (Node::Number(_), Some(longest)) = (self.node(id), self.longest_of(lengths)) {
            self.measures.insert(id, longest);
        }
    }

    /// The largest length that expressions marked in `reached` are made of.
    pub fn longest(&self, reached: &[bool]) -> Option<Length> {
        let reached = self.measures.iter().filter(|(id, _)| reached.get(id.index()) == Some(&true));
        self.longest_of(reached.map(|(_, length)| *length)).and_then(|index| self.lengths.get(index)).cloned()
    }

    /// The longest of `lengths`. Of equal ones the later counts: it names the purpose of an earlier number.
    fn longest_of(&self, lengths: impl Iterator<Item = usize>) -> Option<usize> {
        let length = |index: &usize| self.lengths.get(*index).map_or(0.0, |length| length.length);
        lengths.max_by(|a, b| length(a).total_cmp(&length(b)).then(a.cmp(b)))
    }

    /// The expression.
    pub fn node(&self, id: Id) -> Node {
        self.nodes.get(id.0 as usize).copied().unwrap_or(Node::Number(f64::NAN))
    }

    /// Number of expressions, those that were taken back included.
    pub fn spent(&self) -> usize {
        self.nodes.len().saturating_add(self.spent)
    }

    /// Number of expressions.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Number of expressions that compute something.
    pub fn operations(&self) -> usize {
        self.operations
    }

    /// All expressions, operands first.
    pub fn iter(&self) -> impl Iterator<Item = (Id, Node)> + '_ {
        self.nodes.iter().enumerate().map(|(index, node)| (Id(index as u32), *node))
    }

    /// The expressions from the one at `first` on, operands first.
    pub fn nodes_from(&self, first: usize) -> &[Node] {
        self.nodes.get(first..).unwrap_or_default()
    }

    /// `true` if `root`, or an expression that it depends on, is of this kind.
    pub fn contain(&self, root: Id, is: impl Fn(Node) -> bool) -> bool {
        let mut marked = vec![false; self.nodes.len()];
        let mut waiting = vec![root];
        while let Some(id) = waiting.pop() {
            let Some(mark) = marked.get_mut(id.index()).filter(|mark| !**mark) else { continue };
            *mark = true;
            let node = self.node(id);
            if is(node) {
                return true;
            }
            waiting.extend(node.operands());
        }
        false
    }

    /// Marks the expressions that depend on one of a kind, these included: one flag an expression.
    pub fn made_of(&self, is: impl Fn(Node) -> bool) -> Vec<bool> {
        let mut marked = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let below = |operand: Id| marked.get(operand.index()) == Some(&true);
            marked.push(is(*node) || node.operands().any(below));
        }
        marked
    }

    /// Marks `roots` and the expressions that they depend on: one flag an expression.
    pub fn reachable(&self, roots: impl IntoIterator<Item = Id>) -> Vec<bool> {
        let mut marked = vec![false; self.nodes.len()];
        let mut waiting: Vec<Id> = roots.into_iter().collect();
        while let Some(id) = waiting.pop() {
            if let Some(mark) = marked.get_mut(id.index())
                && !*mark
            {
                *mark = true;
                waiting.extend(self.node(id).operands());
            }
        }
        marked
    }
}

impl Id {
    /// Position in the arena.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Node {
    /// `true` for what the equations of motion alone know: states, multipliers, forces of pins, how friction sticks and slides, values that
    /// events set.
    pub fn is_of_motion(self) -> bool {
        matches!(
            self,
            Node::State(_)
                | Node::Multiplier(_)
                | Node::Pin(..)
                | Node::Sliding(_)
                | Node::Holding(_)
                | Node::Impulse(_)
                | Node::Remembered(_)
        )
    }

    /// Its operands.
    pub fn operands(self) -> impl Iterator<Item = Id> {
        let (first, second) = match self {
            Node::Number(_)
            | Node::Time
            | Node::Coordinate(_)
            | Node::Variable(_)
            | Node::State(_)
            | Node::Multiplier(_)
            | Node::Sliding(_)
            | Node::Holding(_)
            | Node::Impulse(_)
            | Node::Remembered(_)
            | Node::Pin(..)
            | Node::Margin(_) => (None, None),
            Node::Unary(_, a) | Node::Rate(a, _) | Node::Call { argument: a, .. } | Node::Ratio(a, _) => {
                (Some(a), None)
            }
            Node::Binary(_, a, b) => (Some(a), Some(b)),
        };
        first.into_iter().chain(second)
    }
}

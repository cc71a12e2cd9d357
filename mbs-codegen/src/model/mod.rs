//! ast → resolved model: every name, shape, unit and loop resolved; later stages do not change it.

mod arithmetic;
mod bare_angles;
mod bodies;
mod bristles;
mod compound;
mod constraints;
mod contact;
pub mod counts;
pub mod curves;
pub mod declarations;
mod declared_coordinates;
mod declared_fields;
mod declared_functions;
pub mod declared_types;
mod drives;
pub mod dynamics;
pub mod elaborate;
pub mod elaborator;
pub mod element_fields;
mod event;
mod event_rounds;
pub mod expression;
pub mod forces_by_name;
mod friction;
pub mod functions;
mod inertia;
pub mod initialiser;
mod inputs;
mod late_lets;
mod limits;
pub mod link_lengths;
pub mod masses_and_forces;
mod multipliers;
pub mod names;
pub mod non_negative;
mod operands;
mod order;
mod orientation;
mod partial;
mod pins;
pub mod quantity;
mod ranges;
pub mod rates;
mod reference_checks;
pub mod reference_length;
pub mod references;
mod release;
pub mod repeated;
pub mod resolve;
mod resolver;
mod restitution;
mod rotation;
pub mod scene;
pub mod scenes;
pub mod seen;
mod seen_order;
pub mod selection;
mod shared;
pub mod springs;
mod states_and_starts;
mod surplus;
mod torsion_spring;
mod turns;
mod undeclared;
mod unit_cures;
pub mod unit_faults;
pub mod unit_inference;
mod unit_trials;
pub mod units;
mod unknown_names;
mod unused_elements;
mod uses;
pub mod value;
pub mod vanishing;
mod width;
mod written;

use proc_macro2::Span;

use crate::symbolic::Binary;
use dynamics::Dynamics;
use expression::Length;
use expression::{Expressions, Id, Node};
use units::Dimension;

/// A mechanism with every name resolved.
#[derive(Debug, Default)]
pub struct Model {
    /// All scalar expressions.
    pub expressions: Expressions,
    /// Public fields, in the order of the text.
    pub fields: Vec<Field>,
    /// Functions that the caller supplies, in the order of the text.
    pub functions: Vec<Function>,
    /// Coordinates, component by component.
    pub coordinates: Vec<Coordinate>,
    /// Declared coordinates, scalar or array, in the order of the text.
    pub coordinate_fields: Vec<CoordinateField>,
    /// Parameters and inputs, component by component; inputs with rates count thrice.
    pub variables: Vec<Variable>,
    /// Rows of Φ.
    pub rows: Vec<ConstraintRow>,
    /// Phases of drives that prescribe a rate.
    pub phases: Vec<Phase>,
    /// Branch conditions.
    pub branches: Vec<Branch>,
    /// Working ranges.
    pub limits: Vec<Limit>,
    /// Constraints and drives that outputs can refer to.
    pub references: Vec<Reference>,
    /// Coordinates that are declared independent; none where the text declares none.
    pub independent: Vec<Independent>,
    /// Outputs, component by component.
    pub outputs: Vec<Output>,
    /// Declared outputs that are no loads, in the order of the text.
    pub output_fields: Vec<OutputField>,
    /// Bodies, forces and first-order states, where the text has any.
    pub dynamics: Option<Dynamics>,
    /// Largest length among the constants and numbers that determine the reference length.
    pub longest: Option<Length>,
    /// Indices of the parameters that determine it.
    pub lengths: Vec<usize>,
    /// Largest length among guesses and starts.
    pub longest_guess: Option<Length>,
}

impl Model {
    /// Index of the first function of the declaration that this one is of.
    pub fn first_of_declaration(&self, function: usize) -> usize {
        let array = self.functions.get(function).and_then(|function| function.array);
        function.saturating_sub(array.map_or(0, |array| array.index))
    }

    /// `true` if functions of the text can be bounded over parts of a motion. So it is where the text calls no function of the
    /// caller and no drive prescribes a rate.
    pub fn can_be_enclosed(&self) -> bool {
        self.functions.is_empty() && self.phases.is_empty()
    }

    /// Indices of the parameters and inputs that are angles, without their rates and without phases.
    pub fn angles(&self) -> impl Iterator<Item = usize> + '_ {
        let held = self.fields.iter().filter(|field| field.unit == "rad" && field.role != Role::Phase);
        held.flat_map(|field| {
            let parts = if field.role == Role::InputWithRates { 3 } else { 1 };
            (0..field.shape.iter().product()).map(move |component: usize| field.first + parts * component)
        })
    }

    /// Fields that keep the phases, in the order of these.
    pub fn phase_fields(&self) -> impl Iterator<Item = &Field> {
        self.fields.iter().filter(|field| field.role == Role::Phase)
    }

    /// `true` if a value depends on numbers and parameters alone.
    pub fn is_constant(&self, value: Id) -> bool {
        self.made_of(value, |node| match node {
            Node::Variable(index) => {
                self.variables.get(index).is_some_and(|variable| variable.kind == VariableKind::Parameter)
            }
            Node::Number(_) => true,
            _ => false,
        })
    }

    /// `true` if every leaf and every rate of a value is one of those that `allowed` accepts.
    fn made_of(&self, value: Id, allowed: impl Fn(Node) -> bool) -> bool {
        let refused = |node| !matches!(node, Node::Unary(..) | Node::Binary(..)) && !allowed(node);
        !self.expressions.contain(value, refused)
    }
}

/// A public field of the emitted struct.
#[derive(Clone, Debug)]
pub struct Field {
    /// Name and token.
    pub name: crate::syntax::ast::Name,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Unit as written.
    pub unit: String,
    /// Lengths of the array; none for a scalar.
    pub shape: Vec<usize>,
    /// Index of the first component's first variable.
    pub first: usize,
    /// Its role.
    pub role: Role,
}

/// Role of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Part of the design.
    Parameter,
    /// Set before each step.
    Input,
    /// Set before each step with its rates.
    InputWithRates,
    /// Phase of a drive that prescribes a rate, kept by the stepper.
    Phase,
}

/// A function that the text declares and the caller supplies.
#[derive(Clone, Debug)]
pub struct Function {
    /// Name and token.
    pub name: crate::syntax::ast::Name,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Unit of the value as written.
    pub unit: String,
    /// Unit of the argument as written.
    pub argument_unit: String,
    /// Their dimensions; none where a unit is at fault.
    pub dimensions: [Option<Dimension>; 2],
    /// Number of continuous derivatives that the text counts on.
    pub continuity: u8,
    /// Period, in the unit of the argument.
    pub period: Option<f64>,
    /// Its place, where the text declares an array of functions.
    pub array: Option<InArray>,
}

/// Place in an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InArray {
    /// Number, from 0.
    pub index: usize,
    /// Length of the array.
    pub length: usize,
}

impl Function {
    /// As the text calls it: `lift`, or `lift[0]` of an array.
    pub fn label(&self) -> String {
        match self.array {
            Some(InArray { index, .. }) => format!("{}[{index}]", self.name.text),
            None => self.name.text.clone(),
        }
    }

    /// As components are called: `lift`, or `lift.0` of an array.
    pub fn component(&self) -> String {
        match self.array {
            Some(InArray { index, .. }) => format!("{}.{index}", self.name.text),
            None => self.name.text.clone(),
        }
    }

    /// Lengths of its field, as those of other fields: none for a function by itself.
    pub fn shape(&self) -> Vec<usize> {
        self.array.iter().map(|array| array.length).collect()
    }

    /// Unit of the value in a declaration: `m`, or `[m; 2]` of an array.
    pub fn declared_unit(&self) -> String {
        match self.array {
            Some(InArray { length, .. }) => format!("[{}; {length}]", self.unit),
            None => self.unit.clone(),
        }
    }
}

/// A scalar coordinate.
#[derive(Debug)]
pub struct Coordinate {
    /// Name, with the component's number for arrays.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// `true` if the text declares it as `turn`: an angle that is kept within a turn, whole turns apart.
    pub turns: bool,
    /// Start value of the assembly, of parameters alone.
    pub guess: Option<Id>,
    /// The declaring token.
    pub span: Span,
}

/// A declared coordinate.
#[derive(Debug)]
pub struct CoordinateField {
    /// Name and token.
    pub name: crate::syntax::ast::Name,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Unit as written.
    pub unit: String,
    /// Lengths of the array; none for a scalar.
    pub shape: Vec<usize>,
    /// Index of the first component.
    pub first: usize,
}

/// A scalar parameter or input.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Name, with the component's number for arrays and `rate` or `acceleration` for those of an input.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Default value; 0 for inputs.
    pub default: f64,
    /// Least and largest value that the text allows; infinite where it says nothing. No code depends on it.
    pub range: [f64; 2],
    /// Largest deviation of a part that is made, where the text says it.
    pub tolerance: Option<f64>,
    /// `true` if the text declares it as `turn`: an input whose changes go the short way round.
    pub turns: bool,
    /// Its kind.
    pub kind: VariableKind,
    /// The declaring token.
    pub span: Span,
}

/// Kind of a [`Variable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableKind {
    /// Constant in time.
    Parameter,
    /// Set before each step; no rates known.
    Input,
    /// Value of an input or a phase whose rate and acceleration are the next two variables.
    InputWithRates,
    /// Rate or acceleration of one.
    InputRate,
}

/// A row of Φ.
#[derive(Debug)]
pub struct ConstraintRow {
    /// Name of its group, with its number where the group has several.
    pub name: String,
    /// Dimension of the residual.
    pub dimension: Dimension,
    /// `left − right`.
    pub residual: Id,
    /// `true` if a `drive` declares it.
    pub driven: bool,
    /// `true` if the prescribed side is the left one.
    pub reversed: bool,
    /// `true` if it may follow from others: its constraint is marked `redundant`.
    pub redundant: bool,
    /// Largest residual allowed where it contradicts other rows, in its unit.
    pub within: Option<Id>,
    /// The `==`.
    pub span: Span,
}

impl ConstraintRow {
    /// Unit of the residual; that of an angle where the row fixes an angle.
    pub fn unit(&self, model: &Model) -> String {
        let is_angle = |id: Id| match model.expressions.node(id) {
            Node::Coordinate(index) => model.coordinates.get(index).is_some_and(|c| c.unit == "rad"),
            _ => false,
        };
        let sides = match model.expressions.node(self.residual) {
            Node::Binary(Binary::Subtract, a, b) => [a, b],
            _ => [self.residual; 2],
        };
        if self.dimension == Dimension::NUMBER && sides.into_iter().any(is_angle) {
            return "rad".into();
        }
        self.dimension.to_string()
    }
}

/// A constraint or a drive.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Its name.
    pub name: String,
    /// Its index among the references.
    pub index: usize,
    /// Indices of its rows.
    pub rows: Vec<usize>,
    /// Row and dimension, where it is a drive of one row.
    pub drive: Option<(usize, units::Dimension)>,
}

/// Value at which a drive that prescribes a rate holds its argument.
#[derive(Debug)]
pub struct Phase {
    /// Index of the variable that holds its value.
    pub variable: usize,
    /// Driven expression.
    pub argument: Id,
    /// Its rate, of time, parameters and inputs.
    pub speed: Id,
}

/// A working range.
#[derive(Debug)]
pub struct Limit {
    /// Its name.
    pub name: String,
    /// Unit of the value.
    pub unit: String,
    /// Lower bound, of parameters alone.
    pub low: Id,
    /// Bounded expression.
    pub value: Id,
    /// Upper bound, of parameters alone.
    pub high: Id,
    /// The token of the value.
    pub span: Span,
}

/// A coordinate that is meant as independent.
#[derive(Debug)]
pub struct Independent {
    /// Its index.
    pub coordinate: usize,
    /// Place in the text.
    pub span: Span,
}

/// A branch condition.
#[derive(Debug)]
pub struct Branch {
    /// Its name.
    pub name: String,
    /// Dimension of the value.
    pub dimension: Dimension,
    /// `true` if it is checked at the assembly alone.
    pub at_start: bool,
    /// Positive where the condition holds.
    pub value: Id,
    /// The declaring token.
    pub span: Span,
}

/// A scalar output.
#[derive(Debug)]
pub struct Output {
    /// Name, with the component's number for arrays.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Its definition.
    pub value: Id,
    /// The declaring token.
    pub span: Span,
}

/// A declared output, scalar or array; of a loop all its rounds.
#[derive(Debug)]
pub struct OutputField {
    /// Name and token.
    pub name: crate::syntax::ast::Name,
    /// Unit as written.
    pub unit: String,
    /// Lengths of the array in the first round; none for a scalar.
    pub shape: Vec<usize>,
    /// Rounds of its loops; none outside of loops.
    pub rounds: Option<usize>,
    /// Indices of its components in [`Model::outputs`].
    pub components: Vec<usize>,
}

impl OutputField {
    /// Lengths of the array of all rounds. Rounds of different lengths, and vectors that are loads in part, make one list.
    pub fn lengths(&self) -> Vec<usize> {
        let lengths: Vec<usize> = self.rounds.into_iter().chain(self.shape.iter().copied()).collect();
        let is_whole = lengths.iter().product::<usize>() == self.components.len();
        if is_whole { lengths } else { vec![self.components.len()] }
    }
}

//! The text as written: statements in order, expressions as postfix code.

use proc_macro2::Span;

use super::picture::Picture;

/// A name and its token.
#[derive(Clone, Debug)]
pub struct Name {
    /// Without the `r#` of a raw identifier.
    pub text: String,
    /// Its token.
    pub span: Span,
}

/// One instruction of an expression in postfix order: operands precede their operator.
#[derive(Clone, Debug)]
pub struct Instruction {
    /// Operation on the values of the stack.
    pub operation: Operation,
    /// The token that it comes from.
    pub span: Span,
}

/// Effect of an [`Instruction`] on the stack of values.
#[derive(Clone, Debug)]
pub enum Operation {
    /// Pushes a number, in the unit joined to it (`4mm`) or in brackets after it (`4 [kg*m^2]`).
    Number { value: f64, unit: Option<Unit>, integer: bool },
    /// Pushes the value of a name.
    Name(String),
    /// Negates one value.
    Negate,
    /// Joins two values.
    Binary(Operator),
    /// Applies a function, or its derivative of this order, to `arguments` values; `indexed`: it is one of an array, whose number is
    /// popped from below the arguments.
    Call { function: String, order: u8, arguments: usize, indexed: bool },
    /// Makes an array of `length` values.
    Array { length: usize },
    /// Pops `indices` counts and indexes the array below them.
    Index { indices: usize },
    /// Pops the bounds and repeats the instructions up to `end` for `variable`; `end` is the matching `SumEnd`.
    SumBegin { variable: Name, end: usize },
    /// Adds the body's value to the sum that began at `begin`.
    SumEnd { begin: usize },
    /// Applies `function` to rows, drives, pins or bodies; pops the counts of those that are indexed.
    Reference { function: String, targets: Vec<Target> },
}

/// A row, drive, pin or body that a function refers to.
#[derive(Clone, Debug)]
pub struct Target {
    pub name: Name,
    /// `true` if a count in brackets follows it.
    pub indexed: bool,
}

/// Operator between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// An expression in postfix order.
#[derive(Clone, Debug)]
pub struct Expression {
    /// Never empty.
    pub code: Vec<Instruction>,
}

impl Expression {
    /// `true` if it is a number as written.
    pub fn is_literal(&self) -> bool {
        matches!(self.code.as_slice(), [Instruction { operation: Operation::Number { .. }, .. }])
    }
}

/// A unit as written, parentheses resolved: a product of symbols with exponents.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Symbols and exponents, integers or halves of integers; `1` is left out.
    pub factors: Vec<(Name, f64)>,
    /// Without spaces, as written.
    pub text: String,
    /// Its first token.
    pub span: Span,
}

impl Unit {
    /// A unit of one symbol.
    pub fn of_symbol(symbol: &str, span: Span) -> Self {
        Unit { factors: vec![(Name { text: symbol.to_owned(), span }, 1.0)], text: symbol.to_owned(), span }
    }
}

/// Unit and shape of a declaration.
#[derive(Clone, Debug)]
pub struct Type {
    /// Unit of every component.
    pub unit: Unit,
    /// Lengths of the array; none for a scalar.
    pub shape: Vec<Expression>,
}

/// Units, continuity and period of a declared function, or of an array of them.
#[derive(Clone, Debug)]
pub struct Signature {
    /// Unit of the value, and the number of functions in an array.
    pub value: Type,
    /// Unit of the argument.
    pub argument: Unit,
    /// Number of continuous derivatives.
    pub continuity: u8,
    /// Period, in the unit of the argument.
    pub period: Option<Expression>,
}

/// `left == right`.
#[derive(Clone, Debug)]
pub struct Equation {
    pub left: Expression,
    pub right: Expression,
    /// The `==`.
    pub span: Span,
}

/// Item in the braces of a constraint, loops flattened to begin and end.
#[derive(Clone, Debug)]
pub enum Item {
    Equation(Equation),
    /// `point on curve;`, `span` is that of the `on`.
    On {
        point: Expression,
        curve: Name,
        span: Span,
    },
    For(Loop),
    EndFor,
}

/// `for variable in low..high`.
#[derive(Clone, Debug)]
pub struct Loop {
    pub variable: Name,
    pub low: Expression,
    pub high: Expression,
}

/// A statement with its doc comment.
#[derive(Clone, Debug)]
pub struct Statement {
    /// Lines of the doc comment.
    pub docs: Vec<String>,
    /// Its declaration.
    pub kind: StatementKind,
}

/// The statements of the language, loops and effects flattened to begin and end.
#[derive(Clone, Debug)]
pub enum StatementKind {
    Const {
        name: Name,
        unit: Unit,
        value: Expression,
    },
    Param {
        name: Name,
        kind: Type,
        value: Option<Expression>,
        bounds: Bounds,
    },
    Input {
        name: Name,
        kind: Type,
        rates: bool,
    },
    Coord {
        name: Name,
        kind: Type,
        guess: Option<Expression>,
    },
    Let {
        name: Name,
        unit: Option<Unit>,
        value: Expression,
    },
    Function {
        name: Name,
        signature: Signature,
    },
    /// `curve name = polar R about centre turned angle;` or `curve name = parametric x, y about centre turned angle;`
    Curve {
        name: Name,
        centre: Expression,
        /// The angle by which it is turned.
        turned: Expression,
        /// R, or x and y: a call, and the number in an array of functions.
        functions: Vec<(Expression, Option<Expression>)>,
    },
    Constraint {
        name: Name,
        /// The word by which rows may follow from others.
        redundant: Option<Span>,
        /// Largest contradiction allowed between such rows.
        within: Option<Expression>,
        items: Vec<Item>,
        /// `true` in a scene whose effects release it: its rows are not there.
        released: bool,
    },
    Drive {
        name: Name,
        equation: Equation,
    },
    Branch {
        name: Name,
        at_start: bool,
        larger: Expression,
        smaller: Expression,
    },
    /// `low <= value <= high`, or one bound alone: `low <= value`, `value <= high`.
    Limit {
        name: Name,
        first: Expression,
        second: Expression,
        third: Option<Expression>,
    },
    Independent {
        names: Vec<Name>,
    },
    /// `event name: begins until ends;`
    Event {
        name: Name,
        begins: Condition,
        ends: Ends,
    },
    /// `latch name: kind = value at event;`
    Latch {
        name: Name,
        kind: Type,
        value: Expression,
        /// The event, with its round where a loop has several.
        event: Joined,
    },
    Out {
        name: Name,
        kind: Type,
        value: Expression,
    },
    /// A body, or an element between two places, by its fields.
    Element {
        kind: Element,
        name: Name,
        fields: Vec<Field>,
    },
    /// A joint of two bodies, for the force in it.
    Pin {
        name: Name,
        bodies: [Joined; 2],
        at: Expression,
    },
    /// A force on a point, a torque on an angle.
    Load {
        kind: Load,
        name: Name,
        value: Expression,
        on: Expression,
        /// The body that a force acts on.
        of: Option<Joined>,
    },
    /// A part of the energies or of the dissipation.
    Energy {
        kind: Energy,
        name: Name,
        value: Expression,
    },
    State {
        name: Name,
        kind: Type,
        value: Option<Expression>,
    },
    /// `der(state) == rate;`
    Rate {
        state: Expression,
        rate: Expression,
        span: Span,
    },
    Start {
        coordinate: Expression,
        value: Expression,
        rate: Option<Expression>,
        span: Span,
    },
    For(Loop),
    EndFor,
    /// At the top level alone.
    Effect {
        name: Name,
    },
    EndEffect,
    /// `release name, name;` in an effect alone: constraints outside of effects.
    Release {
        names: Vec<Name>,
    },
    /// At the top level alone.
    Scene {
        name: Name,
        effects: Vec<Name>,
        /// `true` where braces with statements of its picture follow.
        open: bool,
    },
    EndScene,
    /// A description for the viewer; `span` is its first word.
    Picture {
        picture: Picture,
        span: Span,
    },
    /// Reported; its name is kept, so that its uses are not reported too.
    Faulty {
        name: Name,
        declares: Declares,
        kind: Option<Type>,
    },
}

/// `larger > smaller`
#[derive(Clone, Debug)]
pub struct Condition {
    pub larger: Expression,
    pub smaller: Expression,
}

/// End of what an event begins.
#[derive(Clone, Debug)]
pub enum Ends {
    /// The condition of its begin holds no longer.
    Opposite,
    When(Condition),
    Never,
}

/// Range and tolerance of a parameter: for programs, without code.
#[derive(Clone, Debug, Default)]
pub struct Bounds {
    /// Least and largest value.
    pub range: Option<(Expression, Expression)>,
    /// Largest deviation of a part that is made.
    pub tolerance: Option<Expression>,
}

/// `name: value` in the braces of an element.
#[derive(Clone, Debug)]
pub struct Field {
    pub name: Name,
    pub value: Expression,
    /// The body of a point.
    pub of: Option<Joined>,
}

/// A body that a pin joins, or that a point is one of; an event at which a value is latched.
#[derive(Clone, Debug)]
pub struct Joined {
    pub name: Name,
    /// Index of one of those that a loop declares.
    pub index: Option<Expression>,
}

/// Element that is declared by fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    Body,
    Gravity,
    /// Spring, damper and actuator between two points.
    Tsda,
    /// Spring, damper and torque on an angle.
    Rsda,
    /// Dry friction along a length.
    Friction,
    /// A force that opens a gap which has closed.
    Contact,
}

/// Load along a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    Force,
    Torque,
}

/// Kind of an energy statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Energy {
    Potential,
    Kinetic,
    /// Rayleigh's function.
    Dissipation,
}

/// Kind of name that a statement declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declares {
    Param,
    Input {
        rates: bool,
    },
    Coord,
    Function,
    /// Bodies, elements, forces and pins, whose names are no values.
    Element,
    /// Constraints and drives, some of whose rows could not be read.
    Rows,
    /// The rate of a state.
    Rate,
    /// Names without a field: constants, `let`s, declarations of later versions.
    Value,
}

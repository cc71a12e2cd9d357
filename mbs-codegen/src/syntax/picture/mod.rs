//! Statements that describe a mechanism to its viewer: title, presets, span and picture. No code is emitted for them.

pub mod forms;
mod read;

use proc_macro2::Span;

use super::ast::{Expression, Name, Statement, StatementKind};
use forms::Form;
pub use read::{read, starts};

/// Words that begin such a statement; elsewhere they are names like others.
pub const PICTURES: [&str; 6] = ["title", "about", "preset", "span", "draw", "trace"];

/// Name of the span that is one turn.
pub const TURN: &str = "turn";

/// A statement of the picture.
#[derive(Clone, Debug)]
pub enum Picture {
    /// `title "…";`
    Title(String),
    /// `about "…";`
    About(String),
    /// `preset label "…" { omega: 60rpm }`
    Preset { label: Label, description: String, settings: Vec<Setting> },
    /// `span turn(omega);`
    Turn(Place),
    /// `span 2s;`
    Time(Expression),
    /// `draw link crank: O, A;` or `trace P;`
    Shape(Shape),
}

/// A shape as written.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The form that it has.
    pub form: &'static Form,
    /// Name drawn at it.
    pub label: Option<Label>,
    /// Points in front of its words.
    pub points: Vec<Place>,
    /// Words with their arguments.
    pub words: Vec<Word>,
    /// The word of the form.
    pub span: Span,
}

/// A name for the reader: an identifier or a string.
#[derive(Clone, Debug)]
pub struct Label {
    /// Without quotes.
    pub text: String,
    /// Its token.
    pub span: Span,
}

/// `name[i, j].part`: a point, an angle, a parameter.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its name.
    pub name: Name,
    /// Counts in brackets.
    pub indices: Vec<Expression>,
    /// `com` of a body, an end of a spring, a rate of an input.
    pub part: Option<Name>,
}

/// `omega: 60rpm` in the braces of a preset.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The parameter or input.
    pub place: Place,
    /// Its value.
    pub value: Expression,
}

/// A word after the points of a shape, `rim R`.
#[derive(Clone, Debug)]
pub struct Word {
    /// The word.
    pub name: Name,
    /// Its argument.
    pub argument: Argument,
}

/// Argument of a [`Word`].
#[derive(Clone, Debug)]
pub enum Argument {
    /// No argument.
    None,
    /// A point, angle or direction by its name.
    Place(Place),
    /// Numbers.
    Value(Expression),
}

/// Before: all statements of a text. After: those that code is emitted for. Returns all statements as they were, or none if
/// no statement is one of a picture.
pub fn take(statements: &mut Vec<Statement>) -> Vec<Statement> {
    let is_picture = |statement: &Statement| {
        matches!(statement.kind, StatementKind::Picture { .. } | StatementKind::EndScene)
    };
    if !statements.iter().any(is_picture) {
        return Vec::new();
    }
    let all = std::mem::take(statements);
    let idle = idle_loops(&all);
    let mut in_scene = false;
    for (statement, idle) in all.iter().zip(idle) {
        match &statement.kind {
            StatementKind::Scene { open: true, .. } => in_scene = true,
            StatementKind::EndScene => in_scene = false,
            kind if in_scene || idle || matches!(kind, StatementKind::Picture { .. }) => continue,
            _ => {}
        }
        if !matches!(statement.kind, StatementKind::EndScene) {
            statements.push(statement.clone());
        }
    }
    all
}

/// Marks loops that draw and have no other effect, with all their statements: a `let` there has no other use.
fn idle_loops(statements: &[Statement]) -> Vec<bool> {
    struct Open {
        begin: usize,
        draws: bool,
        works: bool,
    }
    let mut idle = vec![false; statements.len()];
    let mut open: Vec<Open> = Vec::new();
    for (index, statement) in statements.iter().enumerate() {
        match &statement.kind {
            StatementKind::For(_) => open.push(Open { begin: index, draws: false, works: false }),
            StatementKind::EndFor => {
                let Some(closed) = open.pop() else { continue };
                if closed.draws && !closed.works {
                    idle.iter_mut().take(index + 1).skip(closed.begin).for_each(|mark| *mark = true);
                }
                if let Some(outer) = open.last_mut() {
                    outer.draws |= closed.draws;
                    // An empty loop is kept as the text has it.
                    outer.works |= closed.works || !closed.draws;
                }
            }
            StatementKind::Picture { .. } => open.iter_mut().for_each(|open| open.draws = true),
            StatementKind::Let { .. } => {}
            _ => open.iter_mut().for_each(|open| open.works = true),
        }
    }
    idle
}

/// `true` for a word that may follow an expression in a picture.
pub fn is_word(word: &str) -> bool {
    word == TURN || forms::FORMS.iter().any(|form| form.words.iter().any(|(known, ..)| *known == word))
}

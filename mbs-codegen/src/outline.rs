//! Names of a text, and the texts of a Rust source: for programs that choose among texts and scenes.

pub mod declarations;
pub mod effects;
pub mod warnings;

use core::ops::Range;

use proc_macro2::{TokenStream, TokenTree};

use crate::diagnostics::{Diagnostic, Fault};
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::{Function, InArray, Model, VariableKind};
use crate::syntax::Text;
use crate::syntax::unreadable::{Unreadable, span_at, unreadable_call};

/// Names that a text without faults declares.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Name of the mechanism.
    pub name: String,
    /// Names of its scenes; none where it declares none.
    pub scenes: Vec<String>,
    /// `true` where it declares scenes, and all effects together are a mechanism too.
    pub has_whole: bool,
    /// Functions that the caller gives, in the order of `new`; each one of an array.
    pub functions: Vec<DeclaredFunction>,
}

/// A function that the caller gives.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredFunction {
    /// As the text calls it: `lift`, or `lift[0]` of an array.
    pub name: String,
    /// Coherent unit of the value.
    pub unit: String,
    /// Coherent unit of the argument.
    pub argument_unit: String,
    /// Number of continuous derivatives that the text counts on.
    pub continuity: u8,
    /// Period, in the unit of the argument.
    pub period: Option<f64>,
}

/// A parameter or input of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name, with the component's number for arrays.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Default value (coherent SI); 0 for an input.
    pub default: f64,
    /// Least and largest value that the text allows (coherent SI); infinite where it says nothing.
    pub range: [f64; 2],
    /// Largest deviation of a part that is made (coherent SI), where the text says it.
    pub tolerance: Option<f64>,
    /// `true` for an input, `false` for a parameter and for the rates of an input.
    pub is_input: bool,
}

/// A call of `mechanism!` in a Rust source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// Name of the mechanism; `None` where its header has none.
    pub name: Option<String>,
    /// The text at its own lines and columns: blanks stand for what is before it.
    pub source: String,
    /// Line of the call, from 1.
    pub line: usize,
    /// Place of the text between the brackets of the call, in bytes of the Rust source.
    pub place: Range<usize>,
}

/// Calls of `mechanism!` in a Rust source, in its order.
///
/// # Errors
/// The place where the source is no Rust.
pub fn calls(rust: &str) -> Result<Vec<Call>, Fault> {
    let tokens: TokenStream = rust.parse().map_err(|error: proc_macro2::LexError| {
        let known = unreadable_call(rust).map(|Unreadable { line, column, message, help }| Diagnostic {
            message,
            help,
            span: span_at(line, column),
        });
        Fault::from(known.unwrap_or_else(|| Diagnostic {
            message: format!("this is no Rust: {error}"),
            help: "close every bracket and quote".into(),
            span: error.span(),
        }))
    })?;
    let mut found = Vec::new();
    let mut streams = vec![tokens.into_iter()];
    // The last two tokens, where they are `mechanism` and `!`.
    let (mut name, mut mark) = (false, false);
    while let Some(stream) = streams.last_mut() {
        match stream.next() {
            None => {
                streams.pop();
                (name, mark) = (false, false);
            }
            Some(TokenTree::Group(group)) => {
                if mark {
                    found.extend(call(rust, &group));
                } else {
                    streams.push(group.stream().into_iter());
                }
                (name, mark) = (false, false);
            }
            Some(TokenTree::Punct(punctuation)) => {
                (name, mark) = (false, name && punctuation.as_char() == '!')
            }
            Some(TokenTree::Ident(word)) => (name, mark) = (word == "mechanism", false),
            Some(TokenTree::Literal(_)) => (name, mark) = (false, false),
        }
    }
    Ok(found)
}

/// The call with the text in `group`; `None` in the definition of a macro, whose text has `$`.
fn call(rust: &str, group: &proc_macro2::Group) -> Option<Call> {
    let (open, close) = (group.span_open(), group.span_close());
    let place = open.byte_range().end..close.byte_range().start;
    let text = rust.get(place.clone())?;
    let mut name = None;
    let mut before = false;
    for token in group.stream() {
        match token {
            TokenTree::Punct(mark) if mark.as_char() == '$' => return None,
            TokenTree::Punct(mark) if mark.as_char() == ';' => break,
            TokenTree::Ident(word) if before && name.is_none() => {
                name = Some(word.to_string().trim_start_matches("r#").to_owned());
            }
            TokenTree::Ident(word) => before = word == "mechanism",
            _ => {}
        }
    }
    let start = open.end();
    let mut source = "\n".repeat(start.line.saturating_sub(1));
    source.extend(std::iter::repeat_n(' ', start.column));
    source += text;
    Some(Call { name, source, line: open.start().line, place })
}

/// Before: a text without faults; `has_whole` where all its effects together are a mechanism beside its scenes. After: its names.
pub(crate) fn names(text: &Text, scenes: &Scenes, has_whole: bool) -> Outline {
    Outline {
        name: text.header.label(),
        scenes: scenes.scenes.iter().filter_map(Scene::label).map(str::to_owned).collect(),
        has_whole,
        functions: scenes.shared.functions.iter().flat_map(declared_functions).collect(),
    }
}

/// A function, or those of the array that begins with it.
fn declared_functions(function: &Function) -> Vec<DeclaredFunction> {
    let length = function.array.map_or(1, |array| array.length);
    let one = |index: usize| {
        let array = function.array.map(|array| InArray { index, ..array });
        DeclaredFunction {
            name: Function { array, ..function.clone() }.label(),
            unit: function.unit.clone(),
            argument_unit: function.argument_unit.clone(),
            continuity: function.continuity,
            period: function.period,
        }
    };
    (0..length).map(one).collect()
}

/// Before: a model. After: its parameters and inputs.
pub(crate) fn variables(model: &Model) -> Vec<Variable> {
    let variable = |variable: &crate::model::Variable| Variable {
        name: variable.name.clone(),
        unit: variable.unit.clone(),
        default: variable.default,
        range: variable.range,
        tolerance: variable.tolerance,
        is_input: matches!(variable.kind, VariableKind::Input | VariableKind::InputWithRates),
    };
    model.variables.iter().map(variable).collect()
}

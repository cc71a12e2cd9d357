//! Names and values that do not fit a mechanism, with proposals.

use core::fmt;

use crate::erased::facade::AnyEquations;

/// A name or a value that does not fit a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Mismatch {
    /// No mechanism of this name.
    Mechanism {
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// The text has several scenes, each a mechanism of its own.
    Scenes {
        /// The name asked for.
        name: String,
        /// Their names.
        scenes: Vec<String>,
    },
    /// The mechanism is written in one set of coordinates.
    Alone {
        /// The mechanism.
        name: String,
        /// The linkage that it is a variant of, and the kind of its coordinates.
        variant_of: Option<(String, &'static str)>,
        /// The linkages that are written in several.
        several: Vec<String>,
    },
    /// No variant of the mechanism in these coordinates.
    Coordinates {
        /// The mechanism.
        name: String,
        /// The kind asked for.
        kind: String,
        /// Those that there are.
        known: Vec<&'static str>,
    },
    /// The mechanism is free to move, and the command needs rows that fix it.
    Free {
        /// The name asked for.
        name: String,
    },
    /// No parameter of this name.
    Parameter {
        /// The name asked for.
        name: String,
        /// The mechanism.
        mechanism: String,
        /// The names that there are.
        known: Vec<&'static str>,
    },
    /// A parameter that is no finite number.
    NotFinite {
        /// The parameter.
        name: String,
    },
    /// The text of a mechanism cannot be read.
    Text {
        /// The mechanism.
        name: String,
        /// The faults, as the macro would report them.
        faults: String,
    },
    /// A turn never ends.
    NoTurn {
        /// The parameter that gives the angular velocity.
        rate: String,
        /// Its value (rad/s).
        value: f64,
    },
}

/// Sets the parameter or input `name` (coherent SI unit of the text).
///
/// # Errors
/// [`Mismatch::Parameter`] and [`Mismatch::NotFinite`]; the mechanism is then as it was.
pub fn set(mechanism: &mut dyn AnyEquations, name: &str, value: f64) -> Result<(), Mismatch> {
    let variables = mechanism.variables();
    let index = variables.iter().position(|entry| entry.name == name);
    if !value.is_finite() {
        return Err(Mismatch::NotFinite { name: name.to_string() });
    }
    match index {
        Some(index) if mechanism.set(index, value) => Ok(()),
        _ => Err(Mismatch::Parameter {
            name: name.to_string(),
            mechanism: mechanism.type_name().to_string(),
            known: variables.iter().map(|entry| entry.name).collect(),
        }),
    }
}

/// The name of `known` that is nearest to `name`, if any is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Below this Jaro-Winkler similarity a proposal confuses more than it helps.
    const NEAR: f64 = 0.75;
    // `FOUR_BAR` and `four-bar` are `four_bar`.
    let plain = |text: &str| listed(text).to_lowercase().replace(['-', ' '], "_");
    let name = plain(name);
    let rated = known.into_iter().map(|known| (strsim::jaro_winkler(&name, &plain(known)), known));
    rated.filter(|(nearness, _)| *nearness > NEAR).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, known)| known)
}

fn write_known<S: AsRef<str>>(f: &mut fmt::Formatter<'_>, name: &str, known: &[S]) -> fmt::Result {
    let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    if let Some(array) = array(name, &known) {
        return write!(f, ": it is an array, {array}");
    }
    if let Some(nearest) = nearest(name, known.iter().copied()) {
        write!(f, "; did you mean `{nearest}`?")?;
    }
    write!(f, "\nknown: {}", wrapped(&known))
}

/// A component as lists name it, `B.1.0`, from one that is written as in a text, `B[1][0]` or `B[1, 0]`.
pub fn listed(name: &str) -> String {
    name.replace("][", ".").replace(", ", ".").replace(['[', ','], ".").replace(']', "")
}

/// The components of the array called `name`: `m.0` … `m.6`; `None` where it is no array.
pub fn array(name: &str, known: &[&str]) -> Option<String> {
    let is_component = |known: &&&str| known.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
    let components: Vec<&&str> = known.iter().filter(is_component).collect();
    match components.as_slice() {
        [] => None,
        [only] => Some(format!("`{only}`")),
        [first, last] => Some(format!("`{first}`, `{last}`")),
        [first, .., last] => Some(format!("`{first}` … `{last}`")),
    }
}

/// Characters of a line of a list.
const WIDTH: usize = 100;

/// Names in lines that a terminal shows whole.
pub fn wrapped(names: &[&str]) -> String {
    let (mut text, mut column) = (String::new(), "known: ".len());
    for (index, name) in names.iter().enumerate() {
        let comma = if index + 1 < names.len() { "," } else { "" };
        let length = name.chars().count() + comma.len() + 1;
        if index > 0 && column + length > WIDTH {
            text += "\n  ";
            column = 2;
        } else if index > 0 {
            text.push(' ');
        }
        text += name;
        text += comma;
        column += length;
    }
    text
}

impl Mismatch {
    /// The same of the mechanism as it was asked for: types of one text share a part of their names.
    pub fn of(self, card: &str) -> Self {
        match self {
            Mismatch::Parameter { name, known, .. } => {
                Mismatch::Parameter { name, mechanism: card.to_string(), known }
            }
            other => other,
        }
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mismatch::Mechanism { name, known } => {
                write!(f, "there is no mechanism `{name}`")?;
                if known.is_empty() {
                    return write!(
                        f,
                        "; this program has none of its own\na file is named with its suffix, `mbs run {name}.mbs`; `mbs new {name}` writes a crate with one"
                    );
                }
                write_known(f, name, known)
            }
            Mismatch::Scenes { name, scenes } => write!(
                f,
                "`{name}` has several scenes, each a mechanism of its own; name one: {}",
                scenes.iter().map(|scene| format!("`{scene}`")).collect::<Vec<_>>().join(", ")
            ),
            Mismatch::Alone { name, variant_of, several } => {
                write!(f, "`{name}` is written in one set of coordinates")?;
                if let Some((linkage, kind)) = variant_of {
                    write!(f, ": it is `{linkage}` in coordinates of the kind `{kind}`")?;
                }
                let several: Vec<String> =
                    several.iter().map(|name| format!("`mbs compare {name}`")).collect();
                if several.is_empty() { Ok(()) } else { write!(f, "; several have: {}", several.join(", ")) }
            }
            Mismatch::Coordinates { name, kind, known } => {
                write!(f, "`{name}` is not written in coordinates of the kind `{kind}`")?;
                write_known(f, kind, known)
            }
            Mismatch::Free { name } => write!(
                f,
                "`{name}` is free to move: its rows do not fix it; `mbs run {name}` moves it by its forces, and \
                 `print`, `latex`, `structure`, `dof`, `expand` and `verify` know it too"
            ),
            Mismatch::Parameter { name, mechanism, known } => {
                write!(f, "`{mechanism}` has no parameter `{name}`")?;
                write_known(f, name, known)
            }
            Mismatch::NotFinite { name } => write!(f, "parameter `{name}` must be a finite number"),
            Mismatch::Text { name, faults } => write!(f, "the text of `{name}` cannot be read\n{faults}"),
            Mismatch::NoTurn { rate, value } => {
                write!(f, "at `{rate}` = {value} rad/s a turn never ends; give `{rate}` another value")
            }
        }
    }
}

impl core::error::Error for Mismatch {}

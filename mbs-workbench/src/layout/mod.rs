//! Texts laid out: one statement a line, blanks and indentation by rule. Tokens and comments stay as they are.
//!
//! `pieces` has the tokens of a text with the comments between them, and `blanks` says which stand apart. `lines` breaks a statement
//! into lines, `statements` lays out blocks.
//!
//! Line ends of the author stay where a statement may have one: behind brackets and commas, next to operators. A line of more than
//! 120 characters is broken. So a matrix keeps its rows, and a second layout changes nothing.

mod blanks;
mod lines;
mod pieces;
mod statements;
#[cfg(test)]
mod tests;

use mbs_codegen::{Call, Fault};

use self::pieces::pieces;
use self::statements::laid_out;

/// Columns of one more level.
const LEVEL: usize = 4;

/// A file with its texts laid out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Content of the file; texts with faults of their form are as they were.
    pub content: String,
    /// Faults of the form, with their lines in the file.
    pub faults: Vec<Fault>,
}

/// The bare text of a mechanism, as a `.mbs` file has it.
pub fn bare(content: &str) -> Layout {
    whole(content, |content| match text(content, content, 0) {
        Ok(text) => Layout { content: text, faults: Vec::new() },
        Err(faults) => Layout { content: content.to_string(), faults },
    })
}

/// The texts in calls of `mechanism!` of a Rust source; the rest of the source is as it was.
///
/// # Errors
/// The place where the source is no Rust.
pub fn rust(content: &str) -> Result<Layout, Fault> {
    let calls = mbs_codegen::calls(&plain(content))?;
    Ok(whole(content, |content| {
        let (mut laid, mut from, mut faults) = (String::new(), 0, Vec::new());
        for Call { source, place, .. } in &calls {
            let written = &content[place.clone()];
            let line = content[..place.start].rsplit('\n').next().unwrap_or_default();
            let margin = line.len() - line.trim_start().len();
            laid += &content[from..place.start];
            match text(source, written, margin + LEVEL) {
                Ok(text) => laid += &format!("\n{text}{}", " ".repeat(margin)),
                Err(found) => {
                    laid += written;
                    faults.extend(found);
                }
            }
            from = place.end;
        }
        laid += &content[from..];
        Layout { content: laid, faults }
    }))
}

/// The text laid out at a margin. `source` is the text at its lines of the file, `written` the text alone.
fn text(source: &str, written: &str, margin: usize) -> Result<String, Vec<Fault>> {
    let faults = mbs_codegen::faults_of_form(source);
    if !faults.is_empty() {
        return Err(faults);
    }
    let refused = |message: &str| {
        let line = source.lines().position(|line| !line.trim().is_empty()).unwrap_or(0) + 1;
        let help = "report this text; it is left as it is".to_string();
        vec![Fault { line, column: 1, end_line: line, end_column: 2, message: message.to_string(), help }]
    };
    let before = pieces(written).ok_or_else(|| refused("the text has marks that no layout is known for"))?;
    let laid = laid_out(&before, margin);
    // Nothing but blanks may have changed, whatever the rules above say.
    let is_same = |after: Vec<pieces::Piece<'_>>| {
        after.len() == before.len() && after.iter().zip(&before).all(|(after, before)| after.is_same(before))
    };
    match pieces(&laid).is_some_and(is_same) {
        true => Ok(laid),
        false => Err(refused("a layout would change the tokens of the text")),
    }
}

/// A layout of content without byte order mark and carriage returns, which are put back.
fn whole(content: &str, lay_out: impl FnOnce(&str) -> Layout) -> Layout {
    let mark = if content.starts_with('\u{feff}') { "\u{feff}" } else { "" };
    let Layout { content: laid, faults } = lay_out(&plain(content));
    let laid = if content.contains("\r\n") { laid.replace('\n', "\r\n") } else { laid };
    Layout { content: format!("{mark}{laid}"), faults }
}

fn plain(content: &str) -> String {
    content.trim_start_matches('\u{feff}').replace("\r\n", "\n")
}

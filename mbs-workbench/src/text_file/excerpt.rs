//! Messages with the line of the file that they are about, as the Rust compiler shows them.

use mbs_codegen::Fault;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excerpt<'a> {
    /// Path of the file.
    pub path: &'a str,
    /// The whole file.
    pub content: &'a str,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Characters that are marked.
    pub length: usize,
}

impl Excerpt<'_> {
    /// The message with the marked line; `notes` stand below it, each with its kind.
    pub fn message(&self, message: &str, notes: &[(&str, &str)]) -> String {
        let Excerpt { path, content, line, column, length } = *self;
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        let mut text = format!("error: {message}\n{margin} --> {path}:{line}:{column}\n");
        if let Some(shown) = content.lines().nth(line.saturating_sub(1)) {
            let before = shown.chars().take(column.saturating_sub(1));
            let indent: String = before.map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
            let marks = "^".repeat(length.max(1));
            text += &format!("{margin} |\n{number} | {shown}\n{margin} | {indent}{marks}\n");
        }
        for (kind, note) in notes {
            text += &format!("{margin} = {kind}: {note}\n");
        }
        text
    }
}

/// Faults of a text that stands in `content`, the file at `path`; `error: ` of the first one is left to the program.
pub fn faults(path: &str, content: &str, faults: &[Fault]) -> String {
    let shown = |fault: &Fault| {
        let Fault { line, column, message, help, .. } = fault;
        Excerpt { path, content, line: *line, column: *column, length: fault.width() }
            .message(message, &[("help", help)])
    };
    joined(&faults.iter().map(shown).collect::<Vec<_>>())
}

/// Warnings of a text that stands in `content`, the file at `path`.
pub fn warnings(path: &str, content: &str, warnings: &[Fault]) -> Vec<String> {
    let shown = |fault: &Fault| {
        let Fault { line, column, message, help, .. } = fault;
        let excerpt = Excerpt { path, content, line: *line, column: *column, length: fault.width() };
        excerpt.message(message, &[("help", help)]).replacen("error: ", "warning: ", 1)
    };
    warnings.iter().map(shown).collect()
}

/// Messages one below the other, as the text of an error that the program prints behind `error: `.
pub fn joined(messages: &[String]) -> String {
    let text = messages.join("\n");
    text.strip_prefix("error: ").unwrap_or(&text).trim_end().to_string()
}

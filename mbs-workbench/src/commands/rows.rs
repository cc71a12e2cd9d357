//! Rows of a text in the messages of failures: the statement that declares each, at its line of the text.

/// Before: a message with rows as `name` (line 55), counted in the source that the program was built from, and the text of the
/// mechanism. After: lines are those of the text, and the rows stand below.
///
/// `keeps_lines`: `true` where the source is the user's own file, whose lines stay.
pub fn with_rows(message: &str, source: &str, keeps_lines: bool) -> String {
    let (mut text, mut rest) = (String::new(), message);
    let mut rows: Vec<(String, &str)> = Vec::new();
    while let Some((before, behind)) = rest.split_once("` (line ") {
        text += before;
        text.push('`');
        let (number, after) = behind.split_once(')').unwrap_or((behind, ""));
        let name = before.rsplit('`').next().unwrap_or_default();
        rest = after;
        let Some((line, statement)) = declared(source, name) else {
            text += &format!(" (line {number})");
            continue;
        };
        let shown = if keeps_lines { number.to_string() } else { line.to_string() };
        text += &format!(" (line {shown}{})", if keeps_lines { "" } else { " of the text" });
        if !rows.iter().any(|(_, known)| *known == statement) {
            rows.push((shown, statement));
        }
    }
    text += rest;
    let width = rows.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
    for (line, statement) in rows {
        text += &format!("\n  {line:>width$} | {statement}");
    }
    text
}

/// Words that a named statement begins with.
const KEYWORDS: [&str; 23] = [
    "constraint",
    "drive",
    "branch",
    "limit",
    "coord",
    "param",
    "input",
    "state",
    "out",
    "body",
    "pin",
    "gravity",
    "force",
    "torque",
    "tsda",
    "rsda",
    "friction",
    "contact",
    "potential",
    "kinetic",
    "dissipation",
    "function",
    "let",
];

/// Line, from 1, and text of the line on which the statement of this name, or of its component, begins.
fn declared<'a>(source: &'a str, name: &str) -> Option<(usize, &'a str)> {
    let begins = |line: &str, name: &str| {
        KEYWORDS.iter().any(|keyword| {
            line.match_indices(keyword).any(|(at, _)| {
                let is_word = |c: char| c.is_alphanumeric() || c == '_';
                let (before, behind) = (&line[..at], &line[at + keyword.len()..]);
                let behind =
                    behind.strip_prefix(' ').and_then(|behind| behind.trim_start().strip_prefix(name));
                !before.ends_with(is_word) && behind.is_some_and(|behind| !behind.starts_with(is_word))
            })
        })
    };
    // `closure.0` is a row of `closure`, `bob.mass` a field of `bob`.
    let names = [name, name.split('.').next().unwrap_or(name)];
    names.iter().find_map(|name| {
        let found = source.lines().enumerate().find(|(_, line)| begins(line, name))?;
        Some((found.0 + 1, found.1.trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "mechanism Crank;\nparam drive_ratio: 1 = 2;\ncoord phi: rad;\nconstraint closure {\n    phi == 1;\n}\ndrive closure_2: phi == t/1s;\n";

    #[test]
    fn rows_of_a_message_stand_below_it() {
        let message =
            "rows around `closure.0` (line 55), `closure.1` (line 55) and `closure_2` (line 58) contradict";
        assert_eq!(
            with_rows(message, SOURCE, false),
            "rows around `closure.0` (line 4 of the text), `closure.1` (line 4 of the text) and `closure_2` (line 7 of the text) \
             contradict\n  4 | constraint closure {\n  7 | drive closure_2: phi == t/1s;"
        );
        assert_eq!(
            with_rows("`phi` (line 12) jumps", SOURCE, true),
            "`phi` (line 12) jumps\n  12 | coord phi: rad;"
        );
        for message in ["`other` (line 3) is none", "no row", "`open (line"] {
            assert_eq!(with_rows(message, SOURCE, false), message);
        }
    }
}

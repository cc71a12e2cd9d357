//! Rows of a text in the messages of failures: the statement that declares each, at its line of the text.

use mbs_codegen::Declaration;

/// Before: a message with rows as `name` (line 55), counted in the source that the program was built from, and the declarations of the
/// text. After: lines are those of the text, and the rows stand below.
///
/// `keeps_lines`: `true` where the source is the user's own file, whose lines stay.
pub fn with_rows(message: &str, declarations: &[Declaration], keeps_lines: bool) -> String {
    let (mut text, mut rest) = (String::new(), message);
    let mut rows: Vec<(String, &str)> = Vec::new();
    while let Some((before, behind)) = rest.split_once("` (line ") {
        text += before;
        text.push('`');
        let (number, after) = behind.split_once(')').unwrap_or((behind, ""));
        let name = before.rsplit('`').next().unwrap_or_default();
        rest = after;
        let Some(Declaration { line, text: statement, .. }) = declared(declarations, name) else {
            text += &format!(" (line {number})");
            continue;
        };
        let shown = if keeps_lines { number.to_string() } else { line.to_string() };
        text += &format!(" (line {shown}{})", if keeps_lines { "" } else { " of the text" });
        if !rows.iter().any(|(line, known)| *known == statement && *line == shown) {
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

/// The statement of this name; of `bob.mass`, which is a field, that of `bob`.
fn declared<'a>(declarations: &'a [Declaration], name: &str) -> Option<&'a Declaration> {
    let find = |name: &str| declarations.iter().find(|declaration| declaration.name == name);
    find(name).or_else(|| find(name.split('.').next().unwrap_or(name)))
}

#[cfg(test)]
mod tests {
    use mbs_codegen::declarations;

    use super::*;

    const SOURCE: &str = "mechanism Crank;\nparam drive_ratio: 1 = 2;\ncoord phi: rad; coord p: [m; 2];\n\
                          constraint closure {\n    p.0 == 1m*cos(phi); // across\n    p.1\n        == 1m*sin(phi);\n}\n\
                          /// A motor.\ndrive closure_2: phi == t/1s;\nbody bob { mass: 1, com: p }\n";

    #[test]
    fn rows_of_a_message_stand_below_it() {
        let known = declarations(SOURCE, None).expect("a text");
        let message =
            "rows around `closure.0` (line 55), `closure.1` (line 55) and `closure_2` (line 58) contradict";
        assert_eq!(
            with_rows(message, &known, false),
            "rows around `closure.0` (line 5 of the text), `closure.1` (line 7 of the text) and `closure_2` (line 10 of the text) \
             contradict\n   5 | p.0 == 1m*cos(phi);\n   7 | p.1 == 1m*sin(phi);\n  10 | drive closure_2: phi == t/1s;"
        );
        assert_eq!(
            with_rows("`phi` (line 12) jumps", &known, true),
            "`phi` (line 12) jumps\n  12 | coord phi: rad;"
        );
        // A field is quoted with the statement that it stands in.
        assert!(with_rows("`bob.mass` (line 3) is 0", &known, true).ends_with("\n  3 | body bob"));
        for message in ["`other` (line 3) is none", "no row", "`open (line"] {
            assert_eq!(with_rows(message, &known, false), message);
        }
    }

    #[test]
    fn names_are_those_of_the_scene() {
        let text = "mechanism A;\ncoord phi: rad;\neffect a { drive d: phi == t/1s; }\neffect b {\n    drive d: phi == 2*t/1s;\n}\n\
                    scene One = a;\nscene Two = b;\n";
        let row = |scene: &str| {
            let known = declarations(text, Some(scene)).expect("a text");
            with_rows("`d` (line 9) is open", &known, false)
        };
        assert!(row("One").ends_with("\n  3 | drive d: phi == t/1s;"), "{}", row("One"));
        assert!(row("Two").ends_with("\n  5 | drive d: phi == 2*t/1s;"), "{}", row("Two"));
    }
}

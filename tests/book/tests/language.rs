//! The language reference against the parser: words, functions, units, fields, limits, examples and messages.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use mbs_codegen::{expand_source, vocabulary};

/// A folder or file of the workspace.
fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// Files with this extension in a folder: name and text, sorted.
fn files(folder: &str, extension: &str) -> Vec<(String, String)> {
    let entries = fs::read_dir(path(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut files: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .map(|path| (path.display().to_string(), fs::read_to_string(&path).expect("a text file")))
        .collect();
    files.sort();
    files
}

/// All chapters of the reference as one text.
fn reference() -> String {
    files("book/src/language", "md").into_iter().map(|(_, text)| text).collect()
}

/// Words in code of the reference: inline code and blocks, cut at everything that is no letter, digit or `_`.
fn words_in_code(text: &str) -> BTreeSet<String> {
    let code = text.split('`').skip(1).step_by(2);
    code.flat_map(|code| code.split(|letter: char| !letter.is_alphanumeric() && letter != '_'))
        .map(str::to_owned)
        .collect()
}

/// Terminals of the grammar that are words: `"coord"` but not `"=="`.
fn terminals() -> BTreeSet<String> {
    let text = fs::read_to_string(path("book/src/language/grammar.md")).expect("the grammar");
    let grammar = text.split("```ebnf").nth(1).and_then(|rest| rest.split("```").next()).expect("a grammar");
    let quoted = grammar.split('"').skip(1).step_by(2);
    quoted.filter(|word| word.chars().all(|letter| letter.is_alphanumeric())).map(str::to_owned).collect()
}

/// Words that the parser asks for inside a statement, out of its source.
fn inner_words() -> BTreeSet<String> {
    let sources = files("mbs-codegen/src/syntax", "rs");
    let words = sources.iter().flat_map(|(_, text)| {
        ["take_word(\"", "at_word(\""].into_iter().flat_map(|call| text.split(call).skip(1))
    });
    words.filter_map(|rest| rest.split('"').next()).map(str::to_owned).collect()
}

#[test]
fn every_word_of_the_parser_stands_in_the_reference() {
    let words = words_in_code(&reference());
    let known = vocabulary::statements()
        .chain(vocabulary::functions())
        .chain(vocabulary::referring())
        .chain(vocabulary::reserved());
    let known =
        known.chain(vocabulary::later()).chain(vocabulary::drawn()).map(str::to_owned).chain(inner_words());
    let missing: Vec<String> = known.filter(|word| !words.contains(word)).collect();
    assert!(missing.is_empty(), "not in book/src/language: {missing:?}");
}

#[test]
fn the_grammar_and_the_parser_know_the_same_words() {
    let terminals = terminals();
    // `C0` to `C9`, the number 1 and derivatives are read by their letters.
    let read_by_letters = ["C", "1", "d1", "d2", "mechanism", "sum", "der"];
    let known: BTreeSet<String> = vocabulary::statements()
        .chain(vocabulary::referring().filter(|word| !["margin", "ratio"].contains(word)))
        .chain(read_by_letters)
        .chain(vocabulary::drawn())
        .map(str::to_owned)
        .chain(inner_words())
        .collect();
    let unknown: Vec<_> = terminals.difference(&known).collect();
    assert!(unknown.is_empty(), "the parser does not know these words of the grammar: {unknown:?}");
    let missing: Vec<_> = known.difference(&terminals).collect();
    assert!(missing.is_empty(), "the grammar does not have these words of the parser: {missing:?}");
}

#[test]
fn a_statement_of_the_grammar_begins_a_statement() {
    for word in terminals() {
        let begins = vocabulary::statements().any(|known| known == word);
        let text = format!("mechanism M; coord x: m; drive d: x == 1m; {word};");
        let message = expand_source(&text).err().unwrap_or_default();
        let refused = message.contains("begins no statement") || message.contains("second header");
        assert_ne!(begins, refused || message.contains("expected a statement"), "{word}: {message}");
    }
}

/// Cells of the first column of tables whose header begins with `header`, their back quotes left out.
fn column<'a>(text: &'a str, header: &str) -> BTreeSet<&'a str> {
    let mut cells = BTreeSet::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.starts_with(header) {
            let rows = lines.by_ref().take_while(|line| line.starts_with('|')).skip(1);
            cells.extend(
                rows.filter_map(|row| row.split('|').nth(1)).map(|cell| cell.trim().trim_matches('`')),
            );
        }
    }
    cells
}

fn assert_same(found: &BTreeSet<&str>, known: &BTreeSet<&str>, subject: &str) {
    let (missing, unknown) =
        (known.difference(found).collect::<Vec<_>>(), found.difference(known).collect::<Vec<_>>());
    assert!(missing.is_empty() && unknown.is_empty(), "{subject}: missing {missing:?}, unknown {unknown:?}");
}

#[test]
fn the_tables_of_units_are_those_of_the_parser() {
    let text = reference();
    assert_same(&column(&text, "| symbol |"), &vocabulary::symbols().collect(), "symbols");
    let suffixes = vocabulary::SUFFIXES.iter().map(|(suffix, ..)| *suffix).collect();
    assert_same(&column(&text, "| suffix |"), &suffixes, "suffixes");
}

#[test]
fn each_suffix_has_the_factor_of_the_table() {
    let text = reference();
    for (suffix, factor, divisor, unit) in vocabulary::SUFFIXES {
        let row = text.lines().find(|line| line.starts_with(&format!("| `{suffix}` |")));
        let row = row.unwrap_or_else(|| panic!("no row of `{suffix}`"));
        let cell = row.split('|').nth(2).expect("a value").trim();
        let (number, written) = cell.split_once(' ').expect("number and unit");
        let number = number.replace("π", &std::f64::consts::PI.to_string());
        let value = match number.split_once('/') {
            Some((a, b)) => a.parse::<f64>().expect(a) / b.parse::<f64>().expect(b),
            None => number.split('·').map(|part| part.parse::<f64>().expect(part)).product(),
        };
        assert!((value - factor / divisor).abs() < 1e-14 * value, "{suffix}: {cell}");
        assert_eq!(written.trim_matches('`'), unit, "{suffix}");
    }
}

#[test]
fn the_tables_of_functions_are_those_of_the_parser() {
    let text = reference();
    let names: BTreeSet<&str> =
        column(&text, "| function |").into_iter().filter_map(|cell| cell.split(['(', ' ']).next()).collect();
    assert_same(&names, &vocabulary::functions().chain(vocabulary::referring()).collect(), "functions");
}

#[test]
fn each_statement_with_fields_has_a_table_of_them() {
    let text = reference();
    for word in vocabulary::statements() {
        let known: BTreeSet<(String, bool)> = vocabulary::fields()
            .filter(|(statement, ..)| *statement == word)
            .map(|(_, field, required)| (field.to_owned(), required))
            .collect();
        if known.is_empty() {
            continue;
        }
        let header = format!("| field of `{word}` |");
        let table = text.split(&header).nth(1).unwrap_or_else(|| panic!("no table {header}"));
        let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
        let found = rows.map(|row| {
            let mut cells = row.split('|').skip(1).map(|cell| cell.trim().trim_matches('`').to_owned());
            (cells.next().unwrap_or_default(), cells.next().is_some_and(|cell| cell == "yes"))
        });
        assert_eq!(found.collect::<BTreeSet<_>>(), known, "fields of `{word}`");
    }
}

#[test]
fn the_table_of_limits_is_that_of_the_parser() {
    let text = reference();
    for (name, limit) in vocabulary::LIMITS {
        let digits = limit.to_string();
        let cut = digits.len().saturating_sub(3);
        let written = match digits.split_at(cut) {
            ("", _) => digits.clone(),
            (thousands, rest) => format!("{thousands} {rest}"),
        };
        assert!(text.contains(&format!("| {name} | {written} |")), "no row `| {name} | {written} |`");
    }
}

/// Blocks of a language in a chapter: the attributes after the language, the lines with hidden ones shown, the text after it.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<(&'a str, String, &'a str)> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while let Some((_, opened)) = rest.split_once(&format!("```{language}")) {
        let Some((info, body)) = opened.split_once('\n') else { break };
        let Some((body, behind)) = body.split_once("```") else { break };
        let lines = body.lines().map(|line| line.strip_prefix("# ").unwrap_or(line));
        blocks.push((info, lines.collect::<Vec<_>>().join("\n"), behind));
        rest = behind;
    }
    blocks
}

/// A block with the header that short ones leave out.
fn whole(body: &str) -> String {
    if body.contains("mechanism ") { body.to_owned() } else { format!("mechanism Example; {body}") }
}

#[test]
fn every_example_of_the_reference_is_a_text_without_faults() {
    let (mut count, mut found) = (0, String::new());
    for (chapter, text) in files("book/src/language", "md") {
        for (_, body, _) in blocks(&text, "mbs").into_iter().filter(|(info, ..)| info.is_empty()) {
            count += 1;
            if let Err(faults) = expand_source(&whole(&body)) {
                found += &format!("{chapter}\n{body}\n{faults}\n");
            }
        }
    }
    assert!(found.is_empty(), "{found}");
    assert!(count > 30, "{count} examples");
}

#[test]
fn every_faulty_example_has_the_message_that_the_reference_shows() {
    let mut count = 0;
    for (chapter, text) in files("book/src/language", "md") {
        for (info, body, behind) in blocks(&text, "mbs") {
            if info == ",faulty" {
                count += 1;
                let faults = expand_source(&whole(&body)).err().unwrap_or_default();
                let place = |line: &str| {
                    let message = line.splitn(3, ':').collect::<Vec<_>>();
                    match message.as_slice() {
                        [row, _, message] if row.parse::<u32>().is_ok() => format!("error:{message}"),
                        _ => line.to_owned(),
                    }
                };
                let found = faults.lines().map(place).collect::<Vec<_>>().join("\n");
                let shown = blocks(behind, "text").into_iter().next().map(|(_, shown, _)| shown);
                assert_eq!(shown.as_deref(), Some(found.as_str()), "{chapter}:\n{body}");
            }
        }
    }
    assert!(count > 10, "{count} faulty examples");
}

#[test]
fn every_message_in_a_table_is_one_of_the_compiler() {
    let folders = ["", "/syntax", "/model", "/equations", "/structure", "/picture"];
    let sources = folders.map(|folder| files(&format!("mbs-codegen/src{folder}"), "rs")).concat();
    let source: String = sources.into_iter().map(|(_, text)| text.replace('`', "")).collect();
    let text = reference();
    let messages = column(&text, "| message |");
    assert!(messages.len() > 20, "{} messages", messages.len());
    let parts =
        messages.iter().flat_map(|message| message.split('…').map(|part| part.trim_matches([' ', ':'])));
    let unknown: Vec<&str> = parts.filter(|part| !source.contains(part)).collect();
    assert!(unknown.is_empty(), "in no message of mbs-codegen: {unknown:?}");
}

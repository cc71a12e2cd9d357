//! A reader's aid, no gate: doc comments that begin with a question word, and long sentences.

use std::fs;
use std::path::{Path, PathBuf};

use crate::shell::root;

/// Beginnings that hide the noun.
const QUESTIONS: [&str; 4] = ["What", "Whether", "How", "Where"];

/// Words of a sentence, at most.
const MOST: usize = 25;

/// A place and the text in question.
struct Finding {
    path: PathBuf,
    line: usize,
    text: String,
}

/// Prints both lists, or their lengths alone.
///
/// # Errors
/// A file that cannot be read.
pub fn run(count: bool) -> Result<(), String> {
    let sources = files(&root(), "rs")?;
    let mut questions = Vec::new();
    let mut long = Vec::new();
    for path in &sources {
        let text = read(path)?;
        questions.extend(comments(&text).into_iter().filter(|(_, comment)| is_question(comment)).map(
            |(line, comment)| {
                let text = comment.lines().next().unwrap_or_default().to_string();
                Finding { path: path.clone(), line, text }
            },
        ));
        if path.components().any(|part| part.as_os_str() == "src") {
            long.extend(public(&text).into_iter().flat_map(|(line, text)| findings(path, line, &text)));
        }
    }
    let mut documents = files(&root().join("book/src"), "md")?;
    documents.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    for path in documents {
        long.extend(findings(&path, 1, &read(&path)?));
    }
    print("doc comments that begin with What, Whether, How or Where", &questions, count);
    print(
        &format!(
            "sentences of more than {MOST} words in README, ARCHITECTURE, CONTRIBUTING, book and public docs"
        ),
        &long,
        count,
    );
    Ok(())
}

fn print(title: &str, findings: &[Finding], count: bool) {
    if !count {
        for Finding { path, line, text } in findings {
            println!("{}:{line}: {text}", path.strip_prefix(root()).unwrap_or(path).display());
        }
    }
    println!("{}: {title}\n", findings.len());
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Files with an ending in `folder` and below, without the folders of cargo and git.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            found.extend(files(&path, ending)?);
        } else if path.extension().is_some_and(|extension| extension == ending) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Doc comments of a source with the line of their beginning.
fn comments(source: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (index, line) in source.lines().enumerate() {
        let line = line.trim_start();
        let text = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        match (text, found.last_mut()) {
            (Some(text), Some((_, comment))) if open => {
                comment.push('\n');
                comment.push_str(text.trim());
            }
            (Some(text), _) => found.push((index + 1, text.trim().to_string())),
            (None, _) => {}
        }
        open = text.is_some();
    }
    found
}

/// Doc comments of modules and of public items.
fn public(source: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = source.lines().map(str::trim_start).collect();
    let is_public = |(line, comment): &(usize, String)| {
        let end = line - 1 + comment.lines().count().max(1);
        let item = lines[end.min(lines.len())..].iter().find(|line| !line.starts_with("#["));
        lines[line - 1].starts_with("//!") || item.is_some_and(|item| item.starts_with("pub "))
    };
    comments(source).into_iter().filter(is_public).collect()
}

fn is_question(comment: &str) -> bool {
    let first = comment.split(|letter: char| !letter.is_alphanumeric()).next();
    first.is_some_and(|first| QUESTIONS.contains(&first))
}

/// Long sentences of a text in Markdown that begins in `line`.
fn findings(path: &Path, line: usize, text: &str) -> Vec<Finding> {
    let long = sentences(text).into_iter().filter(|(_, sentence)| words(sentence) > MOST);
    long.map(|(offset, text)| Finding { path: path.to_path_buf(), line: line + offset, text }).collect()
}

/// Words of a sentence. Symbols of formulas are none, and neither are numbers and letters that an operator joins, as in `a = 38`.
fn words(sentence: &str) -> usize {
    let tokens: Vec<&str> = sentence.split_whitespace().collect();
    let is_operand = |index: usize| {
        let before = index.checked_sub(1).and_then(|index| tokens.get(index));
        [before, tokens.get(index + 1)].into_iter().flatten().any(|token| is_operator(token))
    };
    let is_word = |(index, token): (usize, &&str)| {
        has_two_letters(token) || (is_article_or_number(token) && !is_operand(index))
    };
    tokens.iter().enumerate().filter(|&pair| is_word(pair)).count()
}

fn is_operator(token: &str) -> bool {
    !token.is_empty() && token.chars().all(|letter| "=+−-·×/<>≤≥≈←".contains(letter))
}

/// True for words and their abbreviations, not for symbols such as `Φ_q`, `q̈`, `λᵀγ̇` and `N`.
fn has_two_letters(token: &str) -> bool {
    let is_letter = |letter: &char| letter.is_ascii_alphabetic() || ('\u{c0}'..='\u{24f}').contains(letter);
    let letters: Vec<char> = token.chars().collect();
    let is_pair = |index: usize| {
        let combining = letters.get(index + 2).is_some_and(|letter| ('\u{300}'..='\u{36f}').contains(letter));
        letters[index..].iter().take(2).filter(|letter| is_letter(letter)).count() == 2 && !combining
    };
    (0..letters.len()).any(is_pair)
}

/// True for an article of one letter, the pronoun and plain numbers.
fn is_article_or_number(token: &str) -> bool {
    let bare = token.trim_matches(|letter: char| !letter.is_alphanumeric());
    ["a", "A", "I"].contains(&bare) || bare.starts_with(|letter: char| letter.is_ascii_digit())
}

/// Sentences with the lines of their beginning, counted from 0. Blocks of code have none, cells of tables and items of lists are
/// sentences of their own.
fn sentences(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let (mut sentence, mut begin, mut code) = (String::new(), 0, false);
    let mut close = |sentence: &mut String, begin: usize| {
        if !sentence.trim().is_empty() {
            found.push((begin, sentence.trim().to_string()));
        }
        sentence.clear();
    };
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.starts_with("```") {
            code = !code;
        }
        let starts = ["```", "- ", "* ", "#", "|", ">", "<"].iter().any(|mark| line.starts_with(mark))
            || line.split_once(". ").is_some_and(|(number, _)| number.parse::<u32>().is_ok());
        if line.is_empty() || starts || code {
            close(&mut sentence, begin);
        }
        if code || line.starts_with("```") {
            continue;
        }
        for cell in line.split(" | ") {
            for word in without_code(cell).split_whitespace() {
                if sentence.is_empty() {
                    begin = index;
                }
                sentence.push_str(word);
                sentence.push(' ');
                let end = word.trim_end_matches([')', '"', '*', '_']);
                if end.ends_with(['.', '?', '!', ';'])
                    && !["e.g.", "i.e.", "vol.", "ch.", "no."].contains(&end)
                {
                    close(&mut sentence, begin);
                }
            }
            if line.starts_with(['|', '#']) {
                close(&mut sentence, begin);
            }
        }
    }
    close(&mut sentence, begin);
    found
}

/// A line with each piece of code as one word.
fn without_code(line: &str) -> String {
    let parts = line.split('`').enumerate();
    parts
        .map(|(index, part)| if index % 2 == 0 { part.to_string() } else { part.replace(' ', "_") })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn question_words_begin_a_comment() {
        let source =
            "/// What it is.\n/// Whether not.\nfn a() {}\n    //! How so.\n/// Whatever.\n// Where\n";
        let found: Vec<_> = comments(source).into_iter().filter(|(_, text)| is_question(text)).collect();
        assert_eq!(found.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 4]);
    }

    #[test]
    fn private_items_are_left_out() {
        let source = "//! Module.\n\n/// Public.\n#[inline]\npub fn a() {}\n/// Private.\nfn b() {}\n/// Inside.\npub(crate) fn c() {}\n";
        let found: Vec<_> = public(source).into_iter().map(|(_, text)| text).collect();
        assert_eq!(found, ["Module.", "Public."]);
    }

    #[test]
    fn sentences_end_at_marks_items_and_cells() {
        let text = "# Title\nOne, e.g. this one.\nTwo goes\non (`a. bc d`). Three\n\n- four\n- five\n\n| six | seven |\n|---|---|\n```text\nnone. here.\n```\nEight";
        let found = sentences(text);
        let begins: Vec<usize> = found.iter().map(|(line, _)| *line).collect();
        assert_eq!(begins, [0, 1, 2, 3, 5, 6, 8, 8, 9, 13], "{found:?}");
        assert_eq!(words(&found[2].1), 4, "code is one word: {found:?}");
    }

    #[test]
    fn symbols_and_operands_are_no_words() {
        for (sentence, count) in [
            ("M q̈ + Φ_qᵀ λ = Q, with λᵀγ̇ at q", 2),
            ("lengths a = 38, b = 41.5 and a length of 3 m", 6),
            ("Brüls took 1.5 ≤ x, the sum_of_all", 4),
        ] {
            assert_eq!(words(sentence), count, "{sentence}");
        }
    }
}

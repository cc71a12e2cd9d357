//! `mbs cost --all`: the study of each mechanism in a process of its own, and an index of their pictures.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::CommandError;
use super::document::Output;
use super::report_files::{require_writable, write_report};
use crate::catalogue::Catalogue;
use crate::output::origin::VERSION;
use crate::output::page::escaped;
use crate::target_directory::target_directory;

/// A study as the index shows it.
struct Entry {
    name: String,
    title: String,
    told: Told,
}

/// Result of a study.
enum Told {
    /// The choice in one sentence, and the number of wrong settings.
    Done(String, usize),
    /// There is nothing to compare, or nothing to compare with.
    Without(String),
    /// The study failed.
    Failed(String),
}

/// Studies all mechanisms of the list with `options`, and writes an index into `directory`.
pub fn run(
    catalogue: &Catalogue,
    options: &[String],
    directory: Option<PathBuf>,
    out: &mut Output,
) -> Result<ExitCode, CommandError> {
    if catalogue.is_empty() {
        return Err(CommandError::Usage("this program has no mechanisms; name a file".to_string()));
    }
    let directory = directory.unwrap_or_else(|| target_directory().join("mbs").join("cost"));
    require_writable(&directory)?;
    let program = std::env::current_exe()
        .map_err(|error| CommandError::Failed(format!("the program does not know its place: {error}")))?;
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").expect("a valid template");
    let bar = ProgressBar::new(catalogue.len() as u64).with_style(style);
    let mut entries = Vec::new();
    for name in catalogue.names() {
        bar.set_message(name.clone());
        let place = directory.join(name.replace(':', "_"));
        let told = Command::new(&program)
            .args(["cost", &name, "--json", "--out"])
            .arg(&place)
            .args(options)
            .output()
            .map_err(|error| {
                CommandError::Failed(format!("{} does not start: {error}", program.display()))
            })?;
        let entry = entry(name, &told.stdout, &told.stderr);
        let (title, line) = (&entry.title, entry.line());
        writeln!(out, "{}: {line}", entry.name)?;
        out.flush()?;
        out.push("mechanisms", json!({ "name": entry.name, "title": title, "result": line }));
        entries.push(entry);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let paths = write_report(&directory, &[("index.html", index(&entries, options))])?;
    for path in paths {
        out.put_file("page", &path);
        writeln!(out, "page     {}", path.display())?;
    }
    out.flush()?;
    let bad = entries.iter().filter(|entry| entry.is_bad()).count();
    match bad {
        0 => Ok(ExitCode::SUCCESS),
        _ => Err(CommandError::Failed(format!(
            "{bad} of {} studies failed or have wrong settings",
            entries.len()
        ))),
    }
}

/// The study of `name` by its document.
fn entry(name: String, document: &[u8], words: &[u8]) -> Entry {
    let document: Value = serde_json::from_slice(document).unwrap_or_default();
    let text = |value: &Value| value.as_str().map(str::to_string);
    let title = text(&document["text"]["title"]).unwrap_or_else(|| name.clone());
    let failed = || {
        let words = String::from_utf8_lossy(words);
        let last = words.lines().rfind(|line| !line.trim().is_empty());
        last.unwrap_or("it ended without a document").to_string()
    };
    let told = match (text(&document["result"]["sentence"]), text(&document["no_study"])) {
        (Some(sentence), _) => {
            let curves = document["result"]["curves"].as_array().into_iter().flatten();
            let points = curves.filter_map(|curve| curve["points"].as_array()).flatten();
            Told::Done(sentence, points.filter(|point| point["verdict"] == "wrong").count())
        }
        (None, Some(reason)) => Told::Without(reason),
        (None, None) => Told::Failed(text(&document["error"]["message"]).unwrap_or_else(failed)),
    };
    Entry { name, title, told }
}

impl Entry {
    fn is_bad(&self) -> bool {
        matches!(self.told, Told::Done(_, 1..) | Told::Failed(_))
    }

    fn line(&self) -> String {
        match &self.told {
            Told::Done(sentence, 0) => sentence.clone(),
            Told::Done(sentence, wrong) => format!("{sentence} {wrong} settings are wrong."),
            Told::Without(reason) | Told::Failed(reason) => {
                reason.lines().next().unwrap_or_default().to_string()
            }
        }
    }
}

fn index(entries: &[Entry], options: &[String]) -> String {
    let mut sections = String::new();
    for entry in entries {
        let place = entry.name.replace(':', "_");
        let title = escaped(&entry.title);
        let class = if entry.is_bad() { " class=\"wrong\"" } else { "" };
        let picture = match entry.told {
            Told::Done(..) => format!(
                "<a href=\"{place}/cost.html\"><img src=\"{place}/cost.svg\" alt=\"error over time of {title}\" loading=\"lazy\"></a>"
            ),
            _ => String::new(),
        };
        sections += &format!(
            "<section><h2>{title} <code class=\"soft\">{}</code></h2>{picture}<p{class}>{}</p></section>\n",
            escaped(&entry.name),
            escaped(&entry.line())
        );
    }
    let command = ["mbs cost --all", &options.join(" ")].join(" ");
    let head = format!("{} mechanisms, made by {}", entries.len(), command.trim());
    include_str!("../cost/page/atlas.html")
        .replace("{{origin}}", &format!("mbs {VERSION}"))
        .replace("{{head}}", &escaped(&head))
        .replace("{{sections}}", &sections)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_without_a_motion_are_told_and_failed_ones_count() {
        let done = r#"{"text":{"title":"A <b>"},"result":{"sentence":"1e-6: take this.","curves":[{"points":[{"verdict":"right"}]}]}}"#;
        let wrong = done.replace("right", "wrong");
        let without = r#"{"text":{"title":"C"},"no_study":"it has no motion"}"#;
        let entries = [
            entry("a:B".to_string(), done.as_bytes(), b""),
            entry("b".to_string(), wrong.as_bytes(), b""),
            entry("c".to_string(), without.as_bytes(), b""),
            entry("d".to_string(), b"", b"error: it does not compile\n"),
        ];
        let bad: Vec<bool> = entries.iter().map(Entry::is_bad).collect();
        assert_eq!(bad, [false, true, false, true]);
        let page = index(&entries, &["--quick".to_string()]);
        assert!(page.contains("href=\"a_B/cost.html\"") && page.contains("A &lt;b&gt;"), "{page}");
        assert!(page.contains("it does not compile") && page.contains("mbs cost --all --quick"), "{page}");
        assert!(!page.contains("href=\"c/"), "{page}");
    }
}

//! `mbs study`.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::CommandError;
use super::assignment::{Assignment, assignment};
use super::chosen::{finite, write_file};
use super::document::Output;
use super::law_options::{self, in_unit};
use super::report_files::require_writable;
use crate::card::Card;
use crate::catalogue::Catalogue;
use crate::mismatch::nearest;
use crate::output::origin::Origin;
use crate::study::{Range, Report, Study, Values, page};
use crate::target_directory::target_directory;

#[derive(Args)]
pub struct Arguments {
    /// Mechanism whose study is run [default: the studies are listed]
    name: Option<String>,
    /// Speed of the study in revolutions a minute: its parameter `speed`
    #[arg(long, value_name = "RPM", value_parser = revolutions, allow_hyphen_values = true)]
    speed: Option<f64>,
    /// Set a parameter of the study, in its unit or with a unit of its own
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    param: Vec<Assignment>,
    /// Lift law in place of the study's own, in the words of `mbs cam`: `lift.csv`, `"4567 --lift 8mm --rise 75deg"`
    #[arg(long, value_name = "LAW")]
    law: Option<String>,
    /// Folder of the page [default: mbs/study/NAME in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Revolutions a minute: a number, or a speed with its unit.
fn revolutions(text: &str) -> Result<f64, String> {
    finite(text).or_else(|why| {
        let speed = in_unit(text, "rad/s", "9000rpm");
        speed.map(|speed| speed * 30.0 / core::f64::consts::PI).map_err(|_| {
            format!("{why}: write revolutions a minute, as `9000`, or a speed with its unit, as `9000rpm`")
        })
    })
}

/// Runs a study: prints its tables and writes its page.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let Some(name) = &arguments.name else { return list(catalogue, out) };
    let (card, study) = found(catalogue, name)?;
    let mut values = Values::of(study);
    let usage = |error: crate::study::StudyError| CommandError::Usage(error.to_string());
    for one in &arguments.param {
        let unit =
            study.parameters.iter().find(|known| known.name == one.name).map_or("1", |known| known.unit);
        let value = match study.parameters.iter().any(|known| known.name == one.name) {
            true => one.in_unit(unit)?,
            // The study names what it knows.
            false => 0.0,
        };
        values.set(&one.name, value).map_err(usage)?;
    }
    if let Some(speed) = arguments.speed {
        values.set("speed", speed * core::f64::consts::PI / 30.0).map_err(usage)?;
    }
    let mut said = None;
    if let Some(law) = &arguments.law {
        if !study.takes_law {
            let help = "leave out `--law`";
            return Err(CommandError::Usage(format!("the study of `{name}` has no lift law\nhelp: {help}")));
        }
        let given = law_options::written(law).map_err(|error| match error {
            CommandError::Usage(why) => CommandError::Usage(format!("`--law`: {why}")),
            CommandError::Failed(why) => CommandError::Failed(format!("`--law`: {why}")),
            other => other,
        })?;
        said = Some(format!(" Lift law: {}.", given.table.unwrap_or_else(|| law.clone())));
        values.law = Some(given.lift);
    }
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| target_directory().join("mbs").join("study").join(card.file_name()));
    require_writable(&directory)?;
    let mut report = (study.run)(&values, &mut |step| {
        // For a reader who waits.
        if std::io::stderr().is_terminal() {
            let _ = writeln!(std::io::stderr(), "{step} ...");
        }
    })
    .map_err(|error| CommandError::Failed(error.to_string()))?;
    report.sentence.extend(said);
    let origin = Origin::of_text(&card.name(), card.equations().source());
    let path = directory.join("study.html");
    write_file(&path, &page::html(&report, &command(arguments, name), &origin.line()))?;
    out.put_text(&origin, &report.title, None);
    out.put("sections", sections(&report));
    out.put_file("page", &path);
    print(out, &report)?;
    writeln!(out, "\npage: {}", path.display())?;
    Ok(())
}

/// The studies of all mechanisms with their parameters.
fn list(catalogue: &Catalogue, out: &mut Output) -> Result<(), CommandError> {
    for card in catalogue.iter() {
        let Some(study) = card.study else { continue };
        let name = card.name();
        let parameters: Vec<_> = study
            .parameters
            .iter()
            .map(|one| json!({ "name": one.name, "unit": one.unit, "value": one.value, "range": one.range.to_string(), "about": one.about }))
            .collect();
        out.push("studies", json!({ "name": name, "about": study.about, "parameters": parameters }));
        writeln!(out, "mbs study {}: {}", name.split(':').next().unwrap_or(&name), study.about)?;
        for one in study.parameters {
            let range = match one.range {
                Range::Any | Range::Sign => String::new(),
                range => format!(" ({range})"),
            };
            writeln!(out, "  {:<15}{:<18}{}{range}", one.name, one.written(one.value), one.about)?;
        }
    }
    Ok(())
}

/// The card of this name, or of this text, that brings a study.
fn found<'a>(catalogue: &Catalogue<'a>, name: &str) -> Result<(&'a Card, &'static Study), CommandError> {
    let of_text = |card: &&Card| card.text_name() == name || card.is_called(name);
    let own = catalogue.cards.iter().filter(of_text).find_map(|card| Some((card, card.study?)));
    own.ok_or_else(|| {
        let with_study = catalogue.cards.iter().filter(|card| card.study.is_some());
        let known: Vec<String> = with_study.map(Card::text_name).collect();
        if known.is_empty() {
            let help = "a card brings one by `card!(…).studied_by(&STUDY)`";
            return CommandError::Usage(format!("no mechanism brings a study\nhelp: {help}"));
        }
        let what = match catalogue.cards.iter().any(|card| of_text(&card)) {
            true => format!("`{name}` brings no study"),
            false => format!("there is no study `{name}`"),
        };
        let near = nearest(name, known.iter().map(String::as_str));
        let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        let list = "`mbs study` without a name lists them with their parameters";
        CommandError::Usage(format!("{what}{near}\nknown: {}\nhelp: {list}", known.join(", ")))
    })
}

/// The line that makes the page again.
fn command(arguments: &Arguments, name: &str) -> String {
    let speed = arguments.speed.map(|speed| format!(" --speed {speed}")).unwrap_or_default();
    let parameters: String =
        arguments.param.iter().map(|one| format!(" --param {}", one.written())).collect();
    let law = arguments.law.as_ref().map(|law| format!(" --law \"{law}\"")).unwrap_or_default();
    format!("mbs study {name}{speed}{law}{parameters}")
}

fn sections(report: &Report) -> Vec<serde_json::Value> {
    let table = |table: &crate::study::Table| json!({ "head": table.head, "rows": table.rows });
    let section = |section: &crate::study::Section| json!({ "title": section.title, "text": section.text, "tables": section.tables.iter().map(table).collect::<Vec<_>>() });
    report.sections.iter().map(section).collect()
}

fn print(out: &mut Output, report: &Report) -> Result<(), CommandError> {
    writeln!(out, "{}\n{}", report.title, report.sentence)?;
    for (index, section) in report.sections.iter().enumerate() {
        writeln!(out, "\n{}. {}", index + 1, section.title)?;
        for paragraph in &section.text {
            writeln!(out, "{paragraph}")?;
        }
        for line in section.tables.iter().flat_map(|table| table.lines()) {
            writeln!(out, "  {line}")?;
        }
    }
    Ok(())
}

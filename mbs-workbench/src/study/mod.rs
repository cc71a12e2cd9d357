//! Studies: a chain of computations that a card brings, with one report.
//!
//! A [`Study`] has parameters and a function that makes a [`Report`] of their values. `mbs study` prints its tables and writes its
//! [`page`]. [`plot`] draws curves as inline SVG.

pub mod page;
pub mod plot;

use core::fmt;

use crate::cams::lift::Lift;
use crate::mismatch::nearest;

/// A chain of computations of a card: `card!(…).studied_by(&STUDY)`.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// One sentence for the command line.
    pub about: &'static str,
    /// Parameters that `--param` may change.
    pub parameters: &'static [Parameter],
    /// `true` if `--law` may replace the lift law.
    pub takes_law: bool,
    /// Makes the report; the second argument shows what is being computed.
    pub run: Run,
}

/// Makes a report of values of the parameters.
pub type Run = fn(&Values, &mut dyn FnMut(&str)) -> Result<Report, StudyError>;

/// Parameter of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name on the command line.
    pub name: &'static str,
    /// Coherent unit.
    pub unit: &'static str,
    /// Default in this unit.
    pub value: f64,
    /// Meaning.
    pub about: &'static str,
}

/// Values of all parameters of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    numbers: Vec<(&'static str, f64)>,
    /// Lift law in place of the study's own.
    pub law: Option<Lift>,
}

impl Values {
    /// Defaults of `study`.
    pub fn of(study: &Study) -> Self {
        let numbers = study.parameters.iter().map(|parameter| (parameter.name, parameter.value)).collect();
        Values { numbers, law: None }
    }

    /// Sets a value in the unit of its parameter.
    ///
    /// # Errors
    /// [`StudyError`] with the known names, and for a number that is not finite.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), StudyError> {
        if !value.is_finite() {
            return Err(StudyError(format!("`{name}` is not a finite number")));
        }
        let known = || self.numbers.iter().map(|(name, _)| *name).collect::<Vec<_>>();
        match self.numbers.iter().position(|(known, _)| *known == name) {
            Some(at) => self.numbers[at].1 = value,
            None => {
                let near = nearest(name, known());
                let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                let message =
                    format!("the study has no parameter `{name}`{hint}\nknown: {}", known().join(", "));
                return Err(StudyError(message));
            }
        }
        Ok(())
    }

    /// Value of a parameter; NaN of one that the study does not have.
    pub fn get(&self, name: &str) -> f64 {
        self.numbers.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }
}

/// Reason why a study has no report, with its cure where there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyError(pub String);

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for StudyError {}

/// Result of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// Result in one or two sentences.
    pub sentence: String,
    /// Steps of the study.
    pub sections: Vec<Section>,
}

/// A step of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Paragraphs before tables and pictures.
    pub text: Vec<String>,
    /// Tables, printed on the terminal too.
    pub tables: Vec<Table>,
    /// Pictures with their captions.
    pub pictures: Vec<Picture>,
}

/// A picture of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Heading.
    pub caption: String,
    /// SVG element.
    pub svg: String,
}

/// Numbers in rows; the first column is on the left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Headings of columns.
    pub head: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// With these headings and no row.
    pub fn new<const N: usize>(head: [&str; N]) -> Self {
        Table { head: head.map(str::to_string).to_vec(), rows: Vec::new() }
    }

    /// With one row more.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        self.rows.push(row.to_vec());
    }

    /// Lines of text with aligned columns.
    pub fn lines(&self) -> Vec<String> {
        let all = || core::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| {
            all().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_string()
        };
        all().map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: Study = Study {
        about: "A study of a test.",
        parameters: &[Parameter { name: "speed", unit: "rad/s", value: 2.0, about: "of the cam" }],
        takes_law: false,
        run: |_, _| Ok(Report::default()),
    };

    #[test]
    fn values_begin_at_their_defaults_and_are_set_by_name() {
        let mut values = Values::of(&STUDY);
        assert_eq!(values.get("speed"), 2.0);
        values.set("speed", 3.0).expect("a parameter");
        assert_eq!(values.get("speed"), 3.0);
        let refused = values.set("sped", 1.0).expect_err("no parameter").to_string();
        assert!(refused.contains("did you mean `speed`?") && refused.contains("known: speed"), "{refused}");
        assert!(values.set("speed", f64::NAN).is_err() && values.get("speed") == 3.0);
        assert!(values.get("other").is_nan());
    }

    #[test]
    fn columns_of_a_table_are_aligned() {
        let mut table = Table::new(["step", "force"]);
        table.push(["first".to_string(), "1200 N".to_string()]);
        table.push(["2".to_string(), "3 N".to_string()]);
        assert_eq!(table.lines(), ["step    force", "first  1200 N", "2         3 N"]);
    }
}

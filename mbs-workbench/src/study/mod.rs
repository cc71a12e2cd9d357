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
    /// Values that it may have.
    pub range: Range,
    /// Meaning.
    pub about: &'static str,
}

impl Parameter {
    /// A value in six digits with the unit.
    pub fn written(&self, value: f64) -> String {
        let shown = format!("{value:.5e}").parse::<f64>().unwrap_or(value);
        let is_short = shown == 0.0 || (1e-4..1e6).contains(&shown.abs());
        let number = if is_short { shown.to_string() } else { format!("{shown:e}") };
        if self.unit == "1" { number } else { format!("{number} {}", self.unit) }
    }
}

/// Values that a parameter may have; not a finite number is none of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Every number.
    Any,
    /// Above 0.
    Positive,
    /// 0 and above.
    NotNegative,
    /// Between both, these included.
    Within(f64, f64),
    /// A whole number between both, these included.
    Whole(u32, u32),
    /// 1 or −1.
    Sign,
}

impl Range {
    /// `true` if `value` is one of them.
    pub fn has(self, value: f64) -> bool {
        let is_whole = value.fract() == 0.0;
        value.is_finite()
            && match self {
                Range::Any => true,
                Range::Positive => value > 0.0,
                Range::NotNegative => value >= 0.0,
                Range::Within(least, most) => (least..=most).contains(&value),
                Range::Whole(least, most) => {
                    is_whole && (f64::from(least)..=f64::from(most)).contains(&value)
                }
                Range::Sign => value.abs() == 1.0,
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Range::Any => write!(f, "a finite number"),
            Range::Positive => write!(f, "above 0"),
            Range::NotNegative => write!(f, "0 or above"),
            Range::Within(least, most) => write!(f, "between {least} and {most}"),
            Range::Whole(least, most) => write!(f, "a whole number between {least} and {most}"),
            Range::Sign => write!(f, "1 or -1"),
        }
    }
}

/// Values of all parameters of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    numbers: Vec<(Parameter, f64)>,
    /// Lift law in place of the study's own.
    pub law: Option<Lift>,
}

impl Values {
    /// Defaults of `study`.
    pub fn of(study: &Study) -> Self {
        let numbers = study.parameters.iter().map(|parameter| (*parameter, parameter.value)).collect();
        Values { numbers, law: None }
    }

    /// Sets a value in the unit of its parameter.
    ///
    /// # Errors
    /// [`StudyError`] with the nearest and all known names, and for a value that the parameter may not have.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), StudyError> {
        let Some(at) = self.numbers.iter().position(|(known, _)| known.name == name) else {
            let known: Vec<&str> = self.numbers.iter().map(|(known, _)| known.name).collect();
            let near = nearest(name, known.iter().copied());
            let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            let message = format!("the study has no parameter `{name}`{hint}\nknown: {}", known.join(", "));
            return Err(StudyError(message));
        };
        let (parameter, number) = &mut self.numbers[at];
        let Parameter { range, about, value: usual, .. } = *parameter;
        if !range.has(value) {
            let [given, usual] = [value, usual].map(|value| parameter.written(value));
            let message =
                format!("`{name}`, {about}, is {given}: it must be {range}\nhelp: its default is {usual}");
            return Err(StudyError(message));
        }
        *number = value;
        Ok(())
    }

    /// Value of a parameter; NaN of one that the study does not have.
    pub fn get(&self, name: &str) -> f64 {
        self.numbers.iter().find(|(known, _)| known.name == name).map_or(f64::NAN, |(_, value)| *value)
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
        parameters: &[
            Parameter {
                name: "speed",
                unit: "rad/s",
                value: 2.0,
                range: Range::Positive,
                about: "speed of the cam",
            },
            Parameter {
                name: "turns",
                unit: "1",
                value: 3.0,
                range: Range::Whole(1, 9),
                about: "turns from rest",
            },
        ],
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
        assert!(values.get("other").is_nan());
    }

    #[test]
    fn a_value_out_of_its_range_is_refused_with_range_and_default() {
        let mut values = Values::of(&STUDY);
        for (name, value, expected) in [
            (
                "speed",
                f64::NAN,
                "`speed`, speed of the cam, is NaN rad/s: it must be above 0\nhelp: its default is 2 rad/s",
            ),
            ("speed", 0.0, "is 0 rad/s: it must be above 0"),
            ("turns", 2.5, "is 2.5: it must be a whole number between 1 and 9"),
            ("turns", 1e9, "is 1e9: it must be"),
        ] {
            let refused = values.set(name, value).expect_err("out of range").to_string();
            assert!(refused.contains(expected), "{refused}");
        }
        assert_eq!(values, Values::of(&STUDY));
        for (range, inside, outside) in [
            (Range::Any, -1e300, f64::INFINITY),
            (Range::NotNegative, 0.0, -1e-9),
            (Range::Within(0.0, 0.9), 0.9, 1.0),
            (Range::Sign, -1.0, 0.5),
        ] {
            assert!(range.has(inside) && !range.has(outside), "{range:?}");
        }
    }

    #[test]
    fn columns_of_a_table_are_aligned() {
        let mut table = Table::new(["step", "force"]);
        table.push(["first".to_string(), "1200 N".to_string()]);
        table.push(["2".to_string(), "3 N".to_string()]);
        assert_eq!(table.lines(), ["step    force", "first  1200 N", "2         3 N"]);
    }
}

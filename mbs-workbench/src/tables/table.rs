//! A table from a file as the function of a text.

use core::f64::consts::TAU;
use core::fmt;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mbs_runtime::driver::FitError;
use mbs_runtime::{Function, Interval, Scalar};

use super::reader::{Columns, Points, ReadFault, read};
use super::spline::{Spline, SplineKind, close_period};

/// Periodic quintic spline through or along the points of a table over one turn, in SI: four continuous derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    spline: Spline,
}

/// A file that is no table, with the place in it and the cure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableError {
    /// The file.
    pub path: PathBuf,
    /// Line, column, message and cure.
    pub fault: ReadFault,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.fault)
    }
}

impl Error for TableError {}

impl Table {
    /// Through every point of a file of angles and values over one turn. `columns`: units of the columns, as `"deg, mm"`, a `-` for
    /// one that is not read.
    ///
    /// A last line that repeats the first one a turn later is taken as the same point.
    ///
    /// # Errors
    /// [`TableError`]: a file that cannot be read, a faulty unit or cell, lines out of order, a turn not covered, a curve not
    /// closed.
    pub fn from_csv(path: impl AsRef<Path>, columns: &str) -> Result<Self, TableError> {
        Self::of_file(path.as_ref(), columns, None)
    }

    /// [`from_csv`](Self::from_csv) along the points by least squares, with evenly spaced knots: for measured values, whose rounding
    /// a spline through every point would keep.
    ///
    /// # Errors
    /// Those of [`from_csv`](Self::from_csv), and a number of knots that the points do not determine.
    pub fn along_csv(path: impl AsRef<Path>, columns: &str, knots: usize) -> Result<Self, TableError> {
        Self::of_file(path.as_ref(), columns, Some(knots))
    }

    fn of_file(path: &Path, columns: &str, knots: Option<usize>) -> Result<Self, TableError> {
        let named = |fault| TableError { path: path.to_path_buf(), fault };
        let whole = |message: String, cure: &str| named(ReadFault::new(0, 0, message, cure));
        let columns = Columns::parse(columns)
            .map_err(|message| whole(message, "name the units of two columns: `\"deg, mm\"`"))?;
        let unit = &columns.x.1;
        if unit.coherent != "rad" {
            let message = format!("the first column is in `{}`, not in an angle", unit.name);
            return Err(whole(message, "a table over one turn has `deg` or `rad` in its first column"));
        }
        let bytes = fs::read(path).map_err(|error| {
            whole(format!("cannot be read: {error}"), "check the path and the permissions")
        })?;
        let mut points = read(&bytes, Some(&columns)).map_err(named)?;
        close_period(&mut points, TAU).map_err(|fault| {
            let cure = "write the angles and values of one turn, the last line a step before the first one or equal to it";
            named(ReadFault { cure: cure.to_string(), ..fault })
        })?;
        let spline = Spline::fit(&points.x, &points.y, SplineKind::PeriodicQuintic(TAU), knots)
            .map_err(|error| named(explained(error, &points)))?;
        Ok(Table { spline })
    }

    /// Arguments (rad) at which the pieces of the spline meet, within one turn.
    pub fn knots(&self) -> &[f64] {
        &self.spline.knots
    }
}

/// The fault of points that no spline goes through, with its line.
pub fn explained(error: FitError, points: &Points) -> ReadFault {
    let (point, cure) = match error {
        FitError::PointsNotIncreasing { point }
        | FitError::PointOutside { point }
        | FitError::PointNotFinite { point } => (Some(point), "correct the line"),
        FitError::TooFewPoints { .. } => (None, "write more points, or ask for fewer knots"),
        FitError::TooFewKnots { .. } => (None, "write more points, or ask for more knots"),
        FitError::Undetermined { .. } => {
            (None, "ask for fewer knots, or write more points where there are few")
        }
        _ => (None, "check the table"),
    };
    let line = point.and_then(|point| points.lines.get(point).copied());
    ReadFault::new(line.unwrap_or(0), line.map_or(0, |_| points.columns.x.0 + 1), error.to_string(), cure)
}

impl<T: Scalar> Function<T> for Table {
    const ORDER: usize = 4;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        self.spline.jet(x)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        self.spline.breakpoint_after(x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        self.spline.enclosure(from, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of a text, or the message with the folder left out.
    fn table(name: &str, text: &str, columns: &str) -> Result<Table, String> {
        let folder = std::env::temp_dir().join(format!("mbs_table_{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join(name);
        fs::write(&file, text).expect("a file");
        let found = Table::from_csv(&file, columns);
        fs::remove_file(&file).expect("the file");
        found.map_err(|error| error.to_string().replace(&format!("{}/", folder.display()), ""))
    }

    fn circle(count: usize, last: &str) -> String {
        let line = |k: usize| {
            let degrees = 360.0 * k as f64 / count as f64;
            format!("{degrees},{}\n", 20.0 + degrees.to_radians().sin())
        };
        (0..count).map(line).collect::<String>() + last
    }

    #[test]
    fn a_table_over_a_turn_is_a_function_of_the_angle() {
        for last in ["", "360,20\n"] {
            let table = table("circle.csv", &circle(72, last), "deg, mm").expect("a table");
            assert_eq!(table.knots().len(), 72);
            for x in [0.0, 0.3, 5.9, -2.0, 100.0] {
                let [value, first, second]: [f64; 3] = table.jet(x);
                let errors = [value - 0.02 - 1e-3 * x.sin(), first - 1e-3 * x.cos(), second + 1e-3 * x.sin()];
                assert!(errors.iter().all(|error| error.abs() < 1e-9), "{x}: {errors:?}");
            }
            let next = Function::<f64>::breakpoint_after(&table, 0.1).expect("a knot");
            assert!((next - TAU * 2.0 / 72.0).abs() < 1e-12, "{next}");
        }
    }

    #[test]
    fn a_file_that_is_no_table_is_told_with_its_place_and_cure() {
        let message = |text: &str, columns: &str| table("t.csv", text, columns).expect_err("a fault");
        let begins = |text: &str, columns: &str, start: &str| {
            let found = message(text, columns);
            assert!(found.starts_with(start) && found.contains("\nhelp: "), "{found}");
        };
        begins("0,1\n90,x\n", "deg, mm", "t.csv: line 2, column 2: `x` is not a number");
        begins("0,1\n90,2\n80,3\n", "deg, mm", "t.csv: line 3, column 1: 80 is not above the line before");
        begins(&circle(12, "361,20\n"), "deg, mm", "t.csv: line 13, column 1: the table spans 361 deg");
        begins("0,1\n10,2\n20,1\n", "deg, mm", "t.csv: line 3, column 1: the table ends 340 deg before");
        begins(&circle(12, "360,25\n"), "deg, mm", "t.csv: line 13, column 2: the curve does not close");
        begins("0,1\n", "s, mm", "t.csv: the first column is in `s`, not in an angle");
        begins("0,1\n", "deg", "t.csv: two columns are read, not 1");
        begins("0,1\n", "deg, milimetre", "t.csv: ");
        begins("0,1\n180,2\n", "deg, mm", "t.csv: ");
        let missing = Table::from_csv("/no/such/file.csv", "deg, mm").expect_err("no file").to_string();
        assert!(missing.starts_with("/no/such/file.csv: cannot be read"), "{missing}");
        let knots = |knots| {
            let file = std::env::temp_dir().join(format!("mbs_table_knots_{}.csv", std::process::id()));
            fs::write(&file, circle(72, "")).expect("a file");
            let found = Table::along_csv(&file, "deg, mm", knots);
            fs::remove_file(&file).expect("the file");
            found.map_err(|error| error.fault.cure)
        };
        assert_eq!(knots(24).map(|table| table.knots().len()), Ok(24));
        assert_eq!(knots(100).map(|_| ()), Err("write more points, or ask for fewer knots".to_string()));
    }
}

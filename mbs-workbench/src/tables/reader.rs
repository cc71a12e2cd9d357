//! Files of numbers: comma, semicolon or tab, comments, headers, decimal commas.

use std::fmt;

use super::Unit;

/// Fault of a file with its place and cure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadFault {
    /// Line of the file, from 1; 0 for the file as a whole.
    pub line: usize,
    /// Column of the table, from 1; 0 for the line as a whole.
    pub column: usize,
    /// Description of the fault.
    pub message: String,
    /// Cure of the fault.
    pub cure: String,
}

impl ReadFault {
    pub(super) fn new(line: usize, column: usize, message: String, cure: &str) -> Self {
        ReadFault { line, column, message, cure: cure.to_string() }
    }
}

impl fmt::Display for ReadFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (0, _) => write!(f, "{}", self.message)?,
            (line, 0) => write!(f, "line {line}: {}", self.message)?,
            (line, column) => write!(f, "line {line}, column {column}: {}", self.message)?,
        }
        write!(f, "\nhelp: {}", self.cure)
    }
}

/// Columns of abscissa and ordinate, with their units.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Index of the abscissa's column and its unit.
    pub x: (usize, Unit),
    /// Index of the ordinate's column and its unit.
    pub y: (usize, Unit),
}

impl Columns {
    /// `deg, mm`; a `-` is a column that is not read.
    ///
    /// # Errors
    /// A message with the fault in `text`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut read = Vec::new();
        for (index, unit) in
            text.split([',', ';']).map(str::trim).enumerate().filter(|(_, unit)| *unit != "-")
        {
            read.push((index, Unit::parse(unit)?));
        }
        match <[_; 2]>::try_from(read) {
            Ok([x, y]) => Ok(Columns { x, y }),
            Err(read) => {
                Err(format!("two columns are read, not {}: write `\"deg, mm\"`, `-` for others", read.len()))
            }
        }
    }

    /// From a header like `cam (deg), lift [mm]`, which may go on with derivatives, as `velocity (mm/rad)`.
    fn of_header(head: &Head) -> Result<Self, ReadFault> {
        let fault = |message: String, cure: &str| Err(ReadFault::new(head.line, 0, message, cure));
        let read: Vec<(usize, Unit)> =
            head.with_units().into_iter().map(|(index, _, unit)| (index, unit)).collect();
        let [x, y, rest @ ..] = read.as_slice() else {
            return fault(
                UNITS_UNKNOWN.to_string(),
                "say `--columns \"deg, mm\"`, or write a header `cam (deg), lift (mm)`",
            );
        };
        let mut derivatives = (1..).map(|order| y.1.derivative(&x.1, order));
        if rest.iter().any(|(_, unit)| Some(&unit.coherent) != derivatives.next().as_ref()) {
            return fault(
                format!("the header has {} columns with units, and two are read", read.len()),
                "name the units of both, a `-` for each column before them, as `--columns \"deg, -, mm\"`",
            );
        }
        Ok(Columns { x: x.clone(), y: y.clone() })
    }
}

/// Columns of a file in SI, the first one increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Columns that were read: index in the file and unit.
    pub columns: Vec<(usize, Unit)>,
    /// Names of the header; empty where there is none.
    pub names: Vec<String>,
    /// Numbers of each column.
    pub values: Vec<Vec<f64>>,
    /// Line of each row in the file.
    pub lines: Vec<usize>,
}

/// Head of a file.
pub struct Head<'a> {
    /// Its cells; of the first line of numbers where the file has no header.
    pub cells: &'a [String],
    /// `true` where it is a header, without a number.
    pub is_header: bool,
    /// Its line in the file, from 1.
    pub line: usize,
}

impl Head<'_> {
    /// Names and units of the columns that have a unit, as `cam (deg)`, with their indices.
    pub fn with_units(&self) -> Vec<(usize, String, Unit)> {
        let read = |(index, cell): (usize, &String)| {
            let open = cell.rfind(['(', '['])?;
            let unit = cell.get(open + 1..)?.trim_end().strip_suffix([')', ']'])?;
            Some((index, cell.get(..open)?.trim().to_string(), Unit::parse(unit).ok()?))
        };
        self.cells.iter().enumerate().filter(|_| self.is_header).filter_map(read).collect()
    }
}

/// A table in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Columns of the file that the numbers are from.
    pub columns: Columns,
    /// Names of abscissa and ordinate: those of the header, else `x` and `y`.
    pub names: [String; 2],
    /// Abscissae, increasing.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Line of each point in the file.
    pub lines: Vec<usize>,
}

/// Message where neither the header nor the caller tells the units.
pub(crate) const UNITS_UNKNOWN: &str = "the units of the columns are not known";

/// Reads a file; `columns` where the header has no units.
///
/// A header with two columns that have units, or with derivatives of the second one behind them, tells which are read.
///
/// Cells are separated by the first of semicolon, tab and comma, in this order, that the first line has. Unless it is the comma,
/// numbers may have decimal commas. Lines that begin with `#` are comments.
///
/// # Errors
/// The first fault.
pub fn read(bytes: &[u8], columns: Option<&Columns>) -> Result<Points, ReadFault> {
    read_points(bytes, columns, true)
}

fn read_points(bytes: &[u8], columns: Option<&Columns>, is_ordered: bool) -> Result<Points, ReadFault> {
    let choose = |head: &Head| {
        let Columns { x, y } = columns.cloned().map_or_else(|| Columns::of_header(head), Ok)?;
        Ok(vec![x, y])
    };
    let table = read_rows(bytes, choose, is_ordered)?;
    let Table { columns, names, values, lines } = table;
    let [x, y] = <[_; 2]>::try_from(columns).expect("two columns are asked for");
    let [abscissae, ordinates] = <[_; 2]>::try_from(values).expect("two columns are read");
    let name = |index: usize, otherwise: &str| match names.get(index) {
        Some(cell) => cell.split(['(', '[']).next().unwrap_or("").trim().to_string(),
        None => otherwise.to_string(),
    };
    let names = [name(x.0, "x"), name(y.0, "y")];
    Ok(Points { columns: Columns { x, y }, names, x: abscissae, y: ordinates, lines })
}

/// Reads the columns of a file that `choose` finds in its head, the first of them increasing; see [`read`].
///
/// # Errors
/// The first fault.
pub fn read_columns(
    bytes: &[u8],
    choose: impl FnOnce(&Head) -> Result<Vec<(usize, Unit)>, ReadFault>,
) -> Result<Table, ReadFault> {
    read_rows(bytes, choose, true)
}

/// As [`read`], with abscissae in any order: `x` of the result need not increase.
///
/// # Errors
/// The first fault.
pub fn read_unordered(bytes: &[u8], columns: Option<&Columns>) -> Result<Points, ReadFault> {
    read_points(bytes, columns, false)
}

fn read_rows(
    bytes: &[u8],
    choose: impl FnOnce(&Head) -> Result<Vec<(usize, Unit)>, ReadFault>,
    is_ordered: bool,
) -> Result<Table, ReadFault> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) || bytes.contains(&0) {
        return Err(ReadFault::new(
            0,
            0,
            "the file is not text in UTF-8".to_string(),
            "save it as CSV in UTF-8",
        ));
    }
    // Names of other encodings lose their accents, numbers do not.
    let text = String::from_utf8_lossy(bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line)).filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let nothing =
        || ReadFault::new(0, 0, "the file has no lines of numbers".to_string(), "write one point a line");
    let (first_number, first) = lines.next().ok_or_else(nothing)?;
    let separator = [';', '\t'].into_iter().find(|c| first.contains(*c)).unwrap_or(',');
    let head = cells(first, separator);
    let is_header = !head.iter().any(|cell| number(cell, separator).is_some());
    let columns = choose(&Head { cells: &head, is_header, line: first_number })?;
    let mut values = vec![Vec::new(); columns.len()];
    let mut numbers = Vec::new();
    let body = (!is_header).then_some((first_number, first)).into_iter().chain(lines);
    for (line, text) in body {
        let row = cells(text, separator);
        for (column, values) in columns.iter().zip(&mut values) {
            values.push(value(&row, column, line, separator)?);
        }
        let rises = values.first().is_none_or(|x| x.windows(2).last().is_none_or(|pair| pair[0] < pair[1]));
        if is_ordered && !rises {
            let index = columns[0].0;
            let message = format!("{} is not above the line before", row[index]);
            return Err(ReadFault::new(line, index + 1, message, "sort the lines and remove repeated ones"));
        }
        numbers.push(line);
    }
    if numbers.is_empty() {
        return Err(nothing());
    }
    let names = if is_header { head } else { Vec::new() };
    Ok(Table { columns, names, values, lines: numbers })
}

/// The cells of a line, without quotes and the blanks around them.
fn cells(line: &str, separator: char) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            _ if letter == separator && !quoted => cells.push(String::new()),
            _ => cells.last_mut().expect("there is one").push(letter),
        }
    }
    cells.iter().map(|cell| cell.trim().to_string()).collect()
}

/// A number, NaN and infinity included.
fn number(cell: &str, separator: char) -> Option<f64> {
    let plain = cell.parse::<f64>().ok();
    plain.or_else(|| if separator == ',' { None } else { cell.replacen(',', ".", 1).parse().ok() })
}

fn value(row: &[String], column: &(usize, Unit), line: usize, separator: char) -> Result<f64, ReadFault> {
    let (index, unit) = column;
    let fault = |message: String, cure: &str| Err(ReadFault::new(line, index + 1, message, cure));
    let Some(cell) = row.get(*index) else {
        return fault(
            format!("the line has {} cells alone", row.len()),
            "write every line with the same columns",
        );
    };
    match number(cell, separator) {
        Some(number) if (number * unit.factor).is_finite() => Ok(number * unit.factor),
        Some(_) => fault(format!("`{cell}` is not a finite number"), "remove the line, or measure it again"),
        None if cell.is_empty() => fault("the cell is empty".to_string(), "remove the line, or fill it in"),
        None if cell.split_whitespace().count() > 1
            && cell.split_whitespace().all(|word| number(word, separator).is_some()) =>
        {
            fault(
                format!("`{cell}` is not a number"),
                "separate the columns by a comma, a semicolon or a tab",
            )
        }
        None if separator == ',' || !cell.contains(['.', ',']) => fault(
            format!("`{cell}` is not a number"),
            "write numbers as 1.5 or 1e-3, comments behind a `#` at the beginning of a line",
        ),
        None => fault(
            format!("`{cell}` is not a number"),
            "write numbers as 1,5 or 1.5, without marks for thousands",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Points {
        read(text.as_bytes(), Some(&Columns::parse("1, mm").expect("columns"))).expect(text)
    }

    fn fault(text: &str) -> ReadFault {
        read(text.as_bytes(), Some(&Columns::parse("1, mm").expect("columns"))).expect_err(text)
    }

    #[test]
    fn every_common_dialect_reads_the_same() {
        let dialects = [
            "x,y\n1,2.5\n2,3.5\n",
            "\u{feff}x,y\r\n1,2.5\r\n2,3.5\r\n",
            "# a comment\n\nx;y\n1;2,5\n# another\n2;3,5",
            "x\ty\n1\t2,5\n2\t3.5\n",
            "\"x\" , \"y\"\n \"1\" , \"2.5\"\n2,3.5,more\n",
        ];
        for text in dialects {
            let found = points(text);
            assert_eq!(
                (found.x, found.y, found.names),
                (vec![1.0, 2.0], vec![2.5e-3, 3.5e-3], ["x", "y"].map(String::from))
            );
        }
        assert_eq!(points("# c\n1,2\n2,3\n").lines, [2, 3]);
        assert_eq!(points("1;-1,5e-1\n2;0").y, [-0.15e-3, 0.0]);
    }

    #[test]
    fn units_may_stand_in_the_header_and_columns_may_be_left_out() {
        let found = read(b"no;cam angle [deg];lift (mm)\n1;180;2\n2;360;3\n", None).expect("units are known");
        assert_eq!(found.x, [core::f64::consts::PI, core::f64::consts::TAU]);
        assert_eq!((found.y, found.names), (vec![2e-3, 3e-3], ["cam angle", "lift"].map(String::from)));
        // Derivatives of the second column may follow it.
        for text in [
            "a (deg),s (mm),v (mm/rad),a (mm/rad^2)\n0,2,1,1\n1,3,1,1\n",
            "a (deg),s (deg),v (deg/rad)\n0,2,1\n1,3,1\n",
        ] {
            let found = read(text.as_bytes(), None).expect(text);
            assert_eq!((found.columns.x.0, found.columns.y.0, found.x.len()), (0, 1, 2));
        }
        let columns = Columns::parse("-, s, -, m/s").expect("columns");
        assert_eq!((columns.x.0, columns.y.0), (1, 3));
        let found = read(b"9,1,9,2\n9,2,9,4\n", Some(&columns)).expect("numbers");
        assert_eq!((found.x, found.y), (vec![1.0, 2.0], vec![2.0, 4.0]));
        for bad in ["deg", "deg, mm, s", "deg, milimetre", ""] {
            assert!(Columns::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_fault_names_line_and_column_and_what_helps() {
        let place = |text: &str| (fault(text).line, fault(text).column);
        assert_eq!(place("x,y\n1,2\n2,oops\n"), (3, 2));
        assert_eq!(place("x,y\n1,2\n2,nan\n"), (3, 2));
        assert_eq!(place("x,y\n1,2\n\n1,3\n"), (4, 1));
        assert_eq!(place("x,y\n1,2\n2\n"), (3, 2));
        assert_eq!(place("x,y\n1,2\n2,\n"), (3, 2));
        assert_eq!(place("x;y\n1;2\n2;1.000,5\n"), (3, 2));
        assert_eq!(place(""), (0, 0));
        assert_eq!(place("x,y\n"), (0, 0));
        let text = fault("x,y\n1,2\n1,3\n").to_string();
        assert_eq!(
            text,
            "line 3, column 1: 1 is not above the line before\nhelp: sort the lines and remove repeated ones"
        );
        let many = read(b"a (deg),x (mm),y (mm)\n1,2,3\n", None).expect_err("which two").to_string();
        assert!(many.contains("3 columns with units") && many.contains("--columns"), "{many}");
        let unknown = read(b"a,b\n1,2\n", None).expect_err("no units");
        assert!(unknown.cure.contains("--columns"), "{unknown}");
        let wide = read(&[0xFF, 0xFE, b'1', 0], None).expect_err("UTF-16");
        assert!(wide.cure.contains("UTF-8"), "{wide}");
    }
}

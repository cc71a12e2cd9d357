//! Matrices with names on rows and columns, as text.

/// A matrix of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Named {
    /// Title, the first line.
    pub title: String,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// Names of the columns; none for a vector.
    pub columns: Vec<String>,
    /// Entries, row by row.
    pub cells: Vec<Vec<String>>,
    /// Numbers of the entries, row by row; none for formulas.
    pub values: Vec<Vec<f64>>,
}

impl Named {
    /// A column with a name a row.
    pub fn vector(title: &str, rows: &[String], cells: &[String]) -> Self {
        let cells = cells.iter().map(|cell| vec![cell.clone()]).collect();
        Named { title: title.into(), rows: rows.to_vec(), cells, ..Named::default() }
    }

    /// The same with numbers as entries, row by row.
    pub fn with_values(mut self, values: &[f64]) -> Self {
        self.values = values.chunks(self.columns.len().max(1)).map(<[f64]>::to_vec).collect();
        self.cells = self.values.iter().map(|row| row.iter().copied().map(number).collect()).collect();
        self
    }

    /// The same with entries padded on their right, as formulas are read.
    pub fn aligned_left(mut self) -> Self {
        let count = self.cells.iter().map(Vec::len).max().unwrap_or(0);
        for k in 0..count {
            let head = self.columns.get(k).map_or(0, |name| name.chars().count());
            let cells = || self.cells.iter().filter_map(|row| row.get(k));
            let width = cells().map(|cell| cell.chars().count()).max().unwrap_or(0).max(head);
            let pad = |text: &mut String| *text = format!("{text:width$}");
            self.columns.get_mut(k).into_iter().for_each(pad);
            self.cells.iter_mut().filter_map(|row| row.get_mut(k)).for_each(pad);
        }
        self
    }

    /// Lines of text: title, names of the columns, rows; entries are below the name of their column, aligned right.
    pub fn lines(&self) -> Vec<String> {
        let width =
            |texts: &mut dyn Iterator<Item = &String>| texts.map(|t| t.chars().count()).max().unwrap_or(0);
        let names = width(&mut self.rows.iter());
        let count = self.cells.iter().map(Vec::len).max().unwrap_or(0);
        let widths: Vec<usize> = (0..count)
            .map(|k| {
                width(
                    &mut self
                        .columns
                        .get(k)
                        .into_iter()
                        .chain(self.cells.iter().filter_map(|row| row.get(k))),
                )
            })
            .collect();
        let line = |name: &str, cells: &[String]| {
            let cells = cells.iter().zip(&widths).map(|(cell, width)| format!("  {cell:>width$}"));
            format!("  {name:names$}{}", cells.collect::<String>()).trim_end().to_string()
        };
        let mut lines = vec![self.title.clone()];
        if !self.columns.is_empty() {
            lines.push(line("", &self.columns));
        }
        lines.extend(self.rows.iter().zip(&self.cells).map(|(name, cells)| line(name, cells)));
        lines
    }
}

/// A number of six digits in a form that aligns; a rounding residue of zero is printed with its exponent.
pub fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-4..1e6).contains(&size) => format!("{value:.6}"),
        _ => format!("{value:.3e}"),
    }
}

/// A number of six digits without needless zeros.
pub fn short(value: f64) -> String {
    let text = number(value);
    match text.contains('e') || !text.contains('.') {
        true => text,
        false => text.trim_end_matches('0').trim_end_matches('.').to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_stand_under_their_names() {
        let words = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
        let matrix = Named {
            title: "A".into(),
            rows: words(&["long", "b"]),
            columns: words(&["x", "phi"]),
            cells: vec![words(&["1", "-2.5"]), words(&["0", "3"])],
            ..Named::default()
        };
        assert_eq!(matrix.lines(), ["A", "        x   phi", "  long  1  -2.5", "  b     0     3"]);
        let vector = Named::vector("v", &words(&["a"]), &words(&["7"]));
        assert_eq!(vector.lines(), ["v", "  a  7"]);
    }

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!([0.0, -0.5, 1e-9, 2e7].map(number), ["0", "-0.500000", "1.000e-9", "2.000e7"]);
        assert_eq!([0.0, 0.25, -3.0, 1e-9].map(short), ["0", "0.25", "-3", "1.000e-9"]);
    }
}

//! Elimination by one pivot after the other, and the closed form of what is left.

use std::fmt::Write;

use super::printer::Printer;
use super::scales::Component;
use super::value::{Entry, Value, negated};
use crate::emit::rust::code::list;
use crate::emit::rust::scope::number;
use crate::program::Operations;
use crate::structure::pivots::Pivot;

/// Exclusive or of the sign so far and that of another pivot.
const TURN: &str = "__reverses = (__reverses | __turn) & !(__reverses & __turn);";

/// A pivot with what was eliminated by it.
pub(super) struct Eliminated {
    pub(super) pivot: Pivot,
    /// Column by column of the pivot, a weight for each of its rows; empty for the last pivot.
    pub(super) inverse: Vec<Vec<Entry>>,
    /// Factor of a component by these weights; none for other pivots.
    pub(super) length: Entry,
    /// Rows below, that of the component across among them, and the multipliers of the pivot's rows that are subtracted from each.
    pub(super) multipliers: Vec<(usize, Vec<Entry>)>,
    /// Columns outside the pivot, and the pivot's rows there.
    pub(super) upper: Vec<(usize, Vec<Entry>)>,
    /// Determinant by which the rows below were multiplied in place of a division; none where they were not.
    pub(super) factor: Entry,
}

/// The inverse of a pivot, as the elimination uses it and as the solutions do.
#[derive(Default)]
struct Inverse {
    /// With the determinant as a factor where the pivot is the closing one.
    used: Vec<Vec<Entry>>,
    kept: Vec<Vec<Entry>>,
}

impl Printer {
    /// Eliminates a pivot. The rows below the `closing` one, which the closed form follows, are multiplied by its determinant: so
    /// nothing waits for its reciprocal. The determinant is returned, too.
    pub(super) fn eliminate(&mut self, pivot: &Pivot, closing: bool) -> (Eliminated, Entry) {
        let (mut factor, mut across, mut length) = (None, None, None);
        let places = (pivot.component(), pivot.rows.as_slice(), pivot.columns.as_slice());
        let (inverse, determinant) = match places {
            (Some((rows, column)), ..) => {
                let (along, share, ways) = self.component(rows, column);
                (across, length) = (Some((rows[1], ways)), share);
                (Inverse { kept: vec![along], ..Inverse::default() }, None)
            }
            (_, &[first, second], &[left, right]) if closing => {
                let (adjugate, inverse, determinant) = self.adjugate([first, second], [left, right]);
                factor = determinant.clone();
                (Inverse { used: adjugate, kept: inverse }, determinant)
            }
            (_, &[first, second], &[left, right]) => {
                let (inverse, determinant) = self.inverse([first, second], [left, right]);
                (Inverse { used: inverse.clone(), kept: inverse }, determinant)
            }
            (_, &[row], &[column]) => {
                let inverse = vec![vec![self.reciprocal(row, column)]];
                (Inverse { used: inverse.clone(), kept: inverse }, self.entry(row, column))
            }
            _ => (Inverse::default(), None),
        };
        let size = self.entries.len();
        let (mut growth, block) = (String::new(), self.block(pivot));
        let below = |row: &usize| pivot.sources().all(|source| source != *row);
        let rows: Vec<usize> = self.rest.iter().copied().filter(below).collect();
        let columns: Vec<usize> = (0..size).filter(|column| !pivot.columns.contains(column)).collect();
        let above = |printer: &Self, column: usize| -> Vec<Entry> {
            pivot.sources().map(|row| printer.entry(row, column)).collect()
        };
        let upper: Vec<(usize, Vec<Entry>)> =
            columns.iter().map(|column| (*column, above(self, *column))).collect();
        let upper: Vec<(usize, Vec<Entry>)> =
            upper.into_iter().filter(|(_, entries)| entries.iter().any(Option::is_some)).collect();
        let mut multipliers = Vec::new();
        for row in &rows {
            let below: Vec<Entry> = pivot.columns.iter().map(|column| self.entry(*row, *column)).collect();
            if below.iter().all(Option::is_none) && factor.is_none() {
                continue;
            }
            let factors: Vec<Entry> =
                (0..pivot.rows.len()).map(|k| self.multiplier(&below, &inverse.used, k)).collect();
            for (multiplier, of) in factors.iter().zip(&pivot.rows) {
                self.bound(multiplier, &factor, (*row, *of), &mut growth);
            }
            for column in &columns {
                let entries = upper.iter().find(|(above, _)| above == column);
                let start = self.entry(*row, *column);
                let start = self.times(start, &factor);
                let products = match entries {
                    Some((_, entries)) => factors.iter().cloned().zip(entries.iter().cloned()).collect(),
                    None => Vec::new(),
                };
                let value = self.less(start, products);
                self.set(*row, *column, value);
            }
            multipliers.push((*row, factors));
            if self.once {
                self.text += "if T::LANES == 1 && !T::all(__bounded) {\nreturn (*__b, __bounded);\n}\n";
            }
        }
        match across {
            None => self.measure(pivot, determinant, &block, (&growth, factor.is_some())),
            Some((second, ways)) => {
                for (column, entries) in &upper {
                    let value = self.less(None, ways.iter().cloned().zip(entries.iter().cloned()).collect());
                    self.set(second, *column, value);
                }
                multipliers.push((second, ways));
                self.measure_component(second);
            }
        }
        self.rest.retain(|row| !pivot.rows.contains(row));
        for row in &pivot.rows {
            (0..size).for_each(|column| self.set(*row, column, None));
        }
        for column in &pivot.columns {
            (0..size).for_each(|row| self.set(row, *column, None));
        }
        let mut keep_all = |entries: Vec<Entry>| -> Vec<Entry> {
            entries.into_iter().map(|entry| self.keep(entry)).collect()
        };
        let (inverse, multipliers, upper) = (
            inverse.kept.into_iter().map(&mut keep_all).collect(),
            multipliers.into_iter().map(|(row, entries)| (row, keep_all(entries))).collect(),
            upper.into_iter().map(|(column, entries)| (column, keep_all(entries))).collect(),
        );
        let (kept, length) = (self.keep(factor.clone()), self.keep(length));
        (Eliminated { inverse, length, multipliers, upper, factor: kept, pivot: pivot.clone() }, factor)
    }

    /// Σ over the pivot's columns of the row's entries times column `k` of the inverse.
    fn multiplier(&mut self, below: &[Entry], inverse: &[Vec<Entry>], k: usize) -> Entry {
        let products =
            below.iter().zip(inverse).map(|(entry, row)| (negated(entry), row.get(k).cloned().flatten()));
        let products: Vec<(Entry, Entry)> = products.collect();
        self.less(None, products)
    }

    /// One over a pivot.
    fn reciprocal(&mut self, row: usize, column: usize) -> Entry {
        let pivot = self.entry(row, column)?;
        self.turn(&pivot);
        match pivot {
            Value::Number(value) => Some(Value::Number(1.0 / value)),
            Value::Local(name) => {
                self.operations.divisions += 1;
                let reciprocal = self.name(&format!("__one / {name}"));
                self.finite(&reciprocal);
                Some(reciprocal)
            }
        }
    }

    /// Weights of two rows in their component along a column, the component's own factor, and what is subtracted of each row in the
    /// component across. The latter is as long as the column, so nothing waits for a root: the metric of its row has it. Factors that
    /// are kept have the length in the reference metric.
    fn component(&mut self, [first, second]: [usize; 2], column: usize) -> (Vec<Entry>, Entry, Vec<Entry>) {
        let unit = if self.once { None } else { self.weights([(first, column)]) };
        let along = [first, second].map(|row| self.times(self.entry(row, column), &unit));
        let squares = along.clone().map(|entry| (negated(&entry), entry));
        let square = self.less(None, squares.into()).unwrap_or(Value::Number(0.0)).text();
        self.operations.divisions += 1;
        let reciprocal = self.name(&format!("__one / {square}"));
        // Where a length vanishes the block is singular, and one solution is of no use.
        if !self.once {
            self.reciprocals.push(reciprocal.text());
        }
        self.operations.functions += 1;
        let length = self.name(&format!("T::sqrt({square})"));
        let shortened = self.times(Some(length.clone()), &Some(reciprocal.clone()));
        let weight = self.times(Some(Value::Local(self.weight_of(second))), &shortened);
        let weight = weight.map_or_else(String::new, |weight| weight.text());
        let own = [first, second].map(|row| (row, column)).into_iter().filter(|place| self.is_own(*place));
        let places = own.collect();
        let scale = format!("({} * {})", self.scale_of(second), length.text());
        self.scales.components.insert(second, Component { length: length.text(), scale, weight, places });
        let reciprocal = self.times(Some(reciprocal), &unit);
        let [x, y] = along.clone();
        (along.into(), reciprocal, vec![y, negated(&x)])
    }

    /// The inverse of two rows, and their determinant.
    fn inverse(
        &mut self,
        [first, second]: [usize; 2],
        [left, right]: [usize; 2],
    ) -> (Vec<Vec<Entry>>, Entry) {
        let places = [(first, left), (first, right), (second, left), (second, right)];
        let [p, q, r, s] = places.map(|(row, column)| self.entry(row, column));
        let cross = self.less(None, vec![(q.clone(), r.clone())]);
        let determinant = self.less(cross, vec![(negated(&p), s.clone())]).unwrap_or(Value::Number(0.0));
        self.turn(&determinant);
        self.operations.divisions += 1;
        let reciprocal = self.name(&format!("__one / {}", determinant.text()));
        self.finite(&reciprocal);
        let reciprocal = Some(reciprocal);
        let mut entry = |value: Entry, negative: bool| {
            let value = if negative { value } else { negated(&value) };
            self.less(None, vec![(value, reciprocal.clone())])
        };
        let inverse = vec![vec![entry(s, false), entry(q, true)], vec![entry(r, true), entry(p, false)]];
        (inverse, Some(determinant))
    }

    /// The adjugate of two rows times the metric of their determinant, their inverse, and the determinant in the reference
    /// metric.
    fn adjugate(
        &mut self,
        [first, second]: [usize; 2],
        [left, right]: [usize; 2],
    ) -> (Vec<Vec<Entry>>, Vec<Vec<Entry>>, Entry) {
        let places = [(first, left), (first, right), (second, left), (second, right)];
        let plain = places.map(|(row, column)| self.entry(row, column));
        let unit = self.weights([(first, left), (second, right)]);
        let [p, q, r, s] = plain.clone().map(|entry| self.times(entry, &unit));
        let [own_p, own_q, ..] = plain;
        let cross = self.less(None, vec![(own_q, r.clone())]);
        let determinant = self.less(cross, vec![(negated(&own_p), s.clone())]).unwrap_or(Value::Number(0.0));
        self.turn(&determinant);
        self.operations.divisions += 1;
        let reciprocal = self.name(&format!("__one / {}", determinant.text()));
        self.finite(&reciprocal);
        let reciprocal = Some(reciprocal);
        let adjugate = vec![vec![s, negated(&q)], vec![negated(&r), p]];
        let mut inverse = Vec::new();
        for line in &adjugate {
            inverse.push(line.iter().map(|entry| self.times(entry.clone(), &reciprocal)).collect());
        }
        (adjugate, inverse, Some(determinant))
    }

    /// Notes that a reciprocal must be finite: a pivot without entries below it has no multiplier that would show it.
    pub(super) fn finite(&mut self, reciprocal: &Value) {
        let _ = writeln!(self.text, "__bounded = __bounded & T::is_finite({});", reciprocal.text());
        self.comparisons += 1;
    }

    /// Prints the update by the sign of a pivot's determinant.
    fn turn(&mut self, determinant: &Value) {
        if self.once {
            return;
        }
        match determinant {
            Value::Number(value) => self.odd ^= *value < 0.0,
            Value::Local(name) => {
                let _ = writeln!(self.text, "let __turn = T::less({name}, {});\n{TURN}", number(0.0));
                self.comparisons += 1;
            }
        }
    }

    /// Prints the bound on the multiplier of row `of` in `row`, times `factor`; `growth` is the largest of these.
    fn bound(&mut self, multiplier: &Entry, factor: &Entry, (row, of): (usize, usize), growth: &mut String) {
        let (from, to) = (self.scales.group(of), self.scales.group(row));
        let mut size = match multiplier {
            None => return,
            Some(Value::Number(value)) if from == to && value.abs() <= 1.0 && factor.is_none() => return,
            Some(multiplier) => format!("T::abs({})", multiplier.text()),
        };
        if from != to {
            let scale = match self.scales.components.get(&of) {
                Some(component) => component.scale.clone(),
                None => format!("__row_scales[{from}]"),
            };
            let _ = write!(size, " * {scale} * {}", self.weight_of(row));
            self.operations.multiplications += 2;
        }
        let size = self.name(&size).text();
        let limit = match factor {
            None => "__limit".to_owned(),
            Some(factor) => {
                self.operations.multiplications += 1;
                format!("__limit * T::abs({})", factor.text())
            }
        };
        let _ = writeln!(self.text, "__bounded = __bounded & T::less({size}, {limit});");
        self.operations.selects += 1;
        self.comparisons += 1;
        if !growth.is_empty() {
            *growth = format!("T::max({growth}, {size})");
            self.operations.selects += 1;
        } else {
            *growth = size;
        }
    }

    /// Closed form of the rows and columns that are left, times the determinant `factor` of the pivot before, and the margin of
    /// all.
    pub(super) fn last(&mut self, last: &Pivot, odd: bool, factor: &Entry) {
        let rank = last.rows.len();
        let zero = || number(0.0);
        let rows = self.rows_of(&last.rows, &last.columns);
        let coordinate_scales = list(last.columns.iter().map(|i| format!("__coordinate_scales[{i}]")));
        let kind = format!("<__mbs::Direct{rank}<T> as __mbs::Factorization<T, {rank}>>");
        // The weights of components are at hand, their scales are not.
        let weighted = last.rows.iter().any(|row| self.scales.components.contains_key(row));
        let measures = last.rows.iter().map(|row| match weighted {
            true => self.weight_of(*row),
            false => self.scale_of(*row),
        });
        let (measures, factorize) = match weighted {
            true => (list(measures), format!("__mbs::Direct{rank}::<T>::weighted")),
            false => (list(measures), format!("{kind}::factorize")),
        };
        let places = last.rows.iter().flat_map(|row| last.columns.iter().map(|column| (*row, *column)));
        let mut left = self.largest(places);
        if let Some(factor) = factor {
            left = format!("{left} / T::abs({})", factor.text());
            self.operations.divisions += 1;
        }
        let mut odd = if odd != self.odd { "__reverses = !__reverses;\n" } else { "" }.to_owned();
        if let (Some(factor), 1 | 3) = (factor, rank) {
            let _ = write!(odd, "let __turn = T::less({}, {});\n{TURN}\n", factor.text(), zero());
            self.comparisons += 1;
        }
        let _ = write!(
            self.text,
            "let (__last, __own) = {factorize}(&{rows}, &{measures}, &{coordinate_scales});\n\
             let __turn = {kind}::reverses(&__last);\n\
             {TURN}\n{odd}\
             let __ratio = T::min(__least, {left} * __own) / __largest;\n\
             let __margin = T::select(T::is_finite(__ratio), T::min(__ratio, __one), {});\n",
            zero()
        );
        self.operations += Operations { divisions: 1, multiplications: 1, selects: 3, ..Default::default() };
        self.comparisons += 2;
    }

    /// The rows and columns that are left, as text.
    pub(super) fn rows_of(&self, rows: &[usize], columns: &[usize]) -> String {
        let text = |entry: Entry| entry.map_or_else(|| number(0.0), |value| value.text());
        list(rows.iter().map(|row| list(columns.iter().map(|c| text(self.entry(*row, *c))))))
    }
}

//! Solutions with the factors: forwards through the multipliers, backwards through the pivots.

use std::fmt::Write;

use super::pivots::Eliminated;
use super::printer::Printer;
use super::value::{Entry, Value, at, negated, put};
use crate::emit::rust::code::list;
use crate::emit::rust::scope::number;
use crate::structure::pivots::Pivot;

impl Printer {
    /// Forwards through the multipliers, then the unknowns from the last pivot to the first.
    pub(super) fn solve(&mut self, done: &[Eliminated], last: &Pivot) -> String {
        let size = self.entries.len();
        let given = |index: usize| Some(Value::Local(format!("__b[{index}]")));
        let (mut b, mut x): (Vec<Entry>, Vec<Entry>) = ((0..size).map(given).collect(), vec![None; size]);
        for Eliminated { pivot, multipliers, factor, .. } in done {
            for (row, factors) in multipliers {
                let products = factors.iter().cloned().zip(pivot.rows.iter().map(|of| at(&b, *of))).collect();
                let start = self.times(at(&b, *row), factor);
                let value = self.less(start, products);
                put(&mut b, *row, value);
            }
        }
        let method = if self.once { "solve_once" } else { "solve" };
        let right = last.rows.iter().map(|row| at(&b, *row));
        self.solve_last(method, right, (&last.columns, &last.rows), &mut x);
        for Eliminated { pivot, inverse, upper, .. } in done.iter().rev() {
            let mut rest = Vec::new();
            for (k, row) in pivot.rows.iter().enumerate() {
                let products =
                    upper.iter().map(|(column, entries)| (at(entries, k), at(&x, *column))).collect();
                rest.push(self.less(at(&b, *row), products));
            }
            for (column, inverse) in pivot.columns.iter().zip(inverse) {
                let products = inverse.iter().map(negated).zip(rest.iter().cloned()).collect();
                let value = self.less(None, products);
                put(&mut x, *column, value);
            }
        }
        self.finish(&x)
    }

    /// The same backwards with all factors transposed.
    pub(super) fn transposed(&mut self, done: &[Eliminated], last: &Pivot) -> String {
        let size = self.entries.len();
        let given = |index: usize| Some(Value::Local(format!("__b[{index}]")));
        let (mut b, mut x): (Vec<Entry>, Vec<Entry>) = ((0..size).map(given).collect(), vec![None; size]);
        for Eliminated { pivot, inverse, upper, .. } in done {
            for (k, row) in pivot.rows.iter().enumerate() {
                let of =
                    |(column, inverse): (&usize, &Vec<Entry>)| (negated(&at(inverse, k)), at(&b, *column));
                let products = pivot.columns.iter().zip(inverse).map(of).collect();
                let value = self.less(None, products);
                put(&mut x, *row, value);
            }
            for (column, entries) in upper {
                let products =
                    entries.iter().cloned().zip(pivot.rows.iter().map(|row| at(&x, *row))).collect();
                let value = self.less(at(&b, *column), products);
                put(&mut b, *column, value);
            }
        }
        let right = last.columns.iter().map(|column| at(&b, *column));
        self.solve_last("solve_transposed", right, (&last.rows, &last.columns), &mut x);
        for Eliminated { pivot, multipliers, factor, .. } in done.iter().rev() {
            for (k, row) in pivot.rows.iter().enumerate() {
                let products =
                    multipliers.iter().map(|(below, factors)| (at(factors, k), at(&x, *below))).collect();
                let value = self.less(at(&x, *row), products);
                put(&mut x, *row, value);
            }
            // What was solved belongs to rows that are multiplied by the factor.
            for (below, _) in multipliers {
                let value = self.times(at(&x, *below), factor);
                put(&mut x, *below, value);
            }
        }
        self.finish(&x)
    }

    fn solve_last(
        &mut self,
        method: &str,
        right: impl Iterator<Item = Entry>,
        (places, others): (&[usize], &[usize]),
        x: &mut [Entry],
    ) {
        let rank = places.len();
        let right = list(right.map(|entry| entry.map_or_else(|| number(0.0), |value| value.text())));
        let names: Vec<String> = places.iter().map(|place| format!("__l{place}")).collect();
        let unknowns = names.join(", ");
        let kind = format!("<__mbs::Direct{rank}<T> as __mbs::Factorization<T, {rank}>>");
        let _ = match self.once {
            true => {
                let rows = self.rows_of(&Pivot { rows: others.to_vec(), columns: places.to_vec() });
                let scales = |name: &str, of: &[usize]| list(of.iter().map(|i| format!("{name}[{i}]")));
                let scales = format!(
                    "&{}, &{}",
                    scales("__row_scales", others),
                    scales("__coordinate_scales", places)
                );
                writeln!(self.text, "let ([{unknowns}], _) = {kind}::{method}(&{rows}, &{right}, {scales});")
            }
            false => writeln!(self.text, "let [{unknowns}] = {kind}::{method}(&self.last, &{right});"),
        };
        for (place, name) in places.iter().zip(names) {
            put(x, *place, Some(Value::Local(name)));
        }
    }

    fn finish(&mut self, x: &[Entry]) -> String {
        let values = x.iter().map(|entry| entry.as_ref().map_or_else(|| number(0.0), Value::text));
        let values = list(values);
        core::mem::take(&mut self.text) + &values + "\n"
    }
}

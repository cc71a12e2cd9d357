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
        let mut right = Vec::new();
        for Eliminated { pivot, multipliers, factor, .. } in done {
            // As they are before the component across takes a row's place.
            let own: Vec<Entry> = pivot.sources().map(|row| at(&b, row)).collect();
            for (row, factors) in multipliers {
                let products = factors.iter().cloned().zip(own.iter().cloned()).collect();
                let start = at(&b, *row).filter(|_| pivot.across != Some(*row));
                let start = self.times(start, factor);
                let value = self.less(start, products);
                put(&mut b, *row, value);
            }
            right.push(own);
        }
        let method = if self.once { "solve_once" } else { "solve" };
        let remaining = last.rows.iter().map(|row| at(&b, *row));
        self.solve_last(method, remaining, (&last.columns, &last.rows), &mut x);
        for (Eliminated { pivot, inverse, length, upper, .. }, own) in done.iter().zip(right).rev() {
            let mut rest = Vec::new();
            for (k, own) in own.into_iter().enumerate() {
                let products =
                    upper.iter().map(|(column, entries)| (at(entries, k), at(&x, *column))).collect();
                rest.push(self.less(own, products));
            }
            for (column, inverse) in pivot.columns.iter().zip(inverse) {
                let products = inverse.iter().map(negated).zip(rest.iter().cloned()).collect();
                let value = self.less(None, products);
                let value = self.times(value, length);
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
        let mut left = Vec::new();
        for Eliminated { pivot, inverse, length, upper, .. } in done {
            let mut own = Vec::new();
            let right: Vec<Entry> =
                pivot.columns.iter().map(|column| self.times(at(&b, *column), length)).collect();
            for (k, _) in pivot.sources().enumerate() {
                let of = |(inverse, right): (&Vec<Entry>, &Entry)| (negated(&at(inverse, k)), right.clone());
                let products = inverse.iter().zip(&right).map(of).collect();
                own.push(self.less(None, products));
            }
            for (column, entries) in upper {
                let products = entries.iter().cloned().zip(own.iter().cloned()).collect();
                let value = self.less(at(&b, *column), products);
                put(&mut b, *column, value);
            }
            left.push(own);
        }
        let right = last.columns.iter().map(|column| at(&b, *column));
        self.solve_last("solve_transposed", right, (&last.rows, &last.columns), &mut x);
        for (Eliminated { pivot, multipliers, factor, .. }, own) in done.iter().zip(left).rev() {
            let mut values = Vec::new();
            for (k, own) in own.into_iter().enumerate() {
                let products =
                    multipliers.iter().map(|(below, factors)| (at(factors, k), at(&x, *below))).collect();
                values.push(self.less(own, products));
            }
            pivot.sources().zip(values).for_each(|(row, value)| put(&mut x, row, value));
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
                let rows = self.rows_of(others, places);
                let row_scales = list(others.iter().map(|row| self.scale_of(*row)));
                let coordinate_scales = list(places.iter().map(|i| format!("__coordinate_scales[{i}]")));
                let scales = format!("&{row_scales}, &{coordinate_scales}");
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

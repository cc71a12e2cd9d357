//! Sizes of pivots in the reference metric, of which the margin is made.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::printer::Printer;
use super::scales::Component;
use super::value::{Entry, Value};
use crate::emit::rust::scope::number;
use crate::structure::pivots::Pivot;

impl Printer {
    pub(super) fn absolute(&mut self, entry: &Value) -> String {
        match entry {
            Value::Number(value) => number(value.abs()),
            Value::Local(name) => {
                self.operations.selects += 1;
                format!("T::abs({name})")
            }
        }
    }

    /// A size in the reference metric.
    pub(super) fn weighted(&mut self, size: String, row: usize, column: usize) -> String {
        self.operations.multiplications += 1;
        let mut text = format!("{size} * {}", self.weight_of(row));
        if let Some(scale) = self.scales.columns.get(column).copied().flatten() {
            let _ = write!(text, " * __coordinate_scales[{scale}]");
            self.operations.multiplications += 1;
        }
        text
    }

    /// The factor that brings an entry, or the determinant of a pivot with these places, into the reference metric.
    pub(super) fn weights<const N: usize>(&mut self, places: [(usize, usize); N]) -> Entry {
        let mut unit = places.map(|(row, _)| self.weight_of(row)).join(" * ");
        self.operations.multiplications += N.saturating_sub(1);
        for (_, column) in places {
            if let Some(scale) = self.scales.columns.get(column).copied().flatten() {
                let _ = write!(unit, " * __coordinate_scales[{scale}]");
                self.operations.multiplications += 1;
            }
        }
        Some(self.name(&unit))
    }

    /// The largest of the entries in the reference metric, as text: those of one scale are compared before they are weighted.
    pub(super) fn largest(&mut self, places: impl Iterator<Item = (usize, usize)>) -> String {
        let mut groups: BTreeMap<(usize, Option<usize>), (usize, usize, String)> = BTreeMap::new();
        for (row, column) in places {
            let Some(entry) = self.entry(row, column) else { continue };
            let scale = (self.scales.group(row), self.scales.columns.get(column).copied().flatten());
            let size = self.absolute(&entry);
            match groups.get_mut(&scale) {
                None => drop(groups.insert(scale, (row, column, size))),
                Some((.., largest)) if *largest == size => {}
                Some((.., largest)) => {
                    *largest = format!("T::max({largest}, {size})");
                    self.operations.selects += 1;
                }
            }
        }
        let mut all = String::new();
        for (row, column, size) in groups.into_values() {
            let size = self.weighted(size, row, column);
            all = match all.is_empty() {
                true => size,
                false => format!("T::max({all}, {size})"),
            };
            self.operations.selects += 1;
        }
        if all.is_empty() { number(0.0) } else { all }
    }

    /// Prints the largest entry of the block. Lengths of columns that components are taken along stand for their entries.
    pub(super) fn largest_of_all(&mut self) {
        let size = self.entries.len();
        let components: Vec<Component> = self.scales.components.values().cloned().collect();
        let measured =
            |place: &(usize, usize)| components.iter().any(|component| component.places.contains(place));
        let places = (0..size).flat_map(|row| (0..size).map(move |column| (row, column)));
        let places: Vec<(usize, usize)> = places.filter(|place| !measured(place)).collect();
        let (own, scales) = (self.own.clone(), self.scales.clone());
        let rest = core::mem::replace(&mut self.entries, own);
        self.scales.components.clear();
        let mut largest = self.largest(places.into_iter());
        (self.entries, self.scales) = (rest, scales);
        for Component { length, .. } in components {
            largest = format!("T::max({largest}, {length})");
            self.operations.selects += 1;
        }
        let _ = writeln!(self.text, "let __largest = {largest};");
    }

    /// The largest entry of a pivot's columns; empty for a single entry.
    pub(super) fn block(&mut self, pivot: &Pivot) -> String {
        if pivot.rows.len() < 2 || self.once {
            return String::new();
        }
        let size = self.entries.len();
        let places = (0..size).flat_map(|row| pivot.columns.iter().map(move |column| (row, *column)));
        let text = self.largest(places);
        self.name(&text).text()
    }

    /// Prints the update by the length of a column's component in two rows, the second of which is `row` now.
    pub(super) fn measure_component(&mut self, row: usize) {
        let Some(component) = self.scales.components.get(&row).filter(|_| !self.once) else { return };
        self.operations.selects += 1;
        let _ = writeln!(self.text, "__least = T::min(__least, {});", component.length);
    }

    /// Prints the update by the size of a pivot, as the best choice of rows for its columns would leave it; for two rows the
    /// determinant over their largest entry. That of a `closing` pivot is in the reference metric already, and a factor of
    /// `growth`.
    pub(super) fn measure(
        &mut self,
        pivot: &Pivot,
        determinant: Entry,
        block: &str,
        (growth, closing): (&str, bool),
    ) {
        let Some(determinant) = determinant.filter(|_| !self.once) else { return };
        let mut size = self.absolute(&determinant);
        let own = size.clone();
        for (row, column) in pivot.rows.iter().zip(&pivot.columns).filter(|_| !closing) {
            size = self.weighted(size, *row, *column);
        }
        if !block.is_empty() {
            size = format!("{size} / {block}");
            self.operations.divisions += 1;
        }
        if closing && !growth.is_empty() {
            // The determinant times the largest multiplier of at least 1.
            size = match block.is_empty() {
                true => format!("T::max({own}, {growth})"),
                false => format!("T::max({own}, {growth}) / {block}"),
            };
            self.operations.selects += 1;
        } else if !growth.is_empty() {
            size = format!("{size} * T::max(__one, {growth})");
            self.operations.multiplications += 1;
            self.operations.selects += 1;
        }
        if self.sizes.insert(size.clone()) {
            let _ = writeln!(self.text, "__least = T::min(__least, {size});");
            self.operations.selects += 1;
        }
    }
}

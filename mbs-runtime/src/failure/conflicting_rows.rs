//! Rows that hold a mechanism open.

use core::fmt;

use crate::mechanism::Entry;

/// Rows that hold a mechanism open, those with the largest parts of the residual first; at most four of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConflictingRows {
    entries: &'static [Entry],
    indices: [u16; ConflictingRows::MOST],
    count: usize,
}

impl ConflictingRows {
    /// Rows that are kept.
    const MOST: usize = 4;

    /// Part of the largest residual from which a row counts. A least residual is stationary to √ε of itself: any further
    /// residual of a row is a ten-millionth.
    const SHARE: f64 = 1e-3;

    /// Those of `entries` whose `residuals`, in the reference metric, count.
    pub(crate) fn of(entries: &'static [Entry], residuals: impl Iterator<Item = f64> + Clone) -> Self {
        let largest = residuals.clone().fold(0.0, f64::max);
        let mut holding = ConflictingRows { entries, indices: [0; Self::MOST], count: 0 };
        let mut parts = [0.0; Self::MOST];
        for (index, residual) in (0_u16..).zip(residuals) {
            if residual > Self::SHARE * largest {
                holding.insert(&mut parts, index, residual);
            }
        }
        holding
    }

    /// Sorts a row in; the smallest falls out where there is no room.
    fn insert(&mut self, parts: &mut [f64; Self::MOST], index: u16, residual: f64) {
        let (mut index, mut residual) = (index, residual);
        for (at, part) in self.indices.iter_mut().zip(parts.iter_mut()) {
            if *part < residual {
                core::mem::swap(part, &mut residual);
                core::mem::swap(at, &mut index);
            }
        }
        self.count = Self::MOST.min(self.count.saturating_add(1));
    }

    /// The rows, those that hold most first.
    pub fn rows(&self) -> impl Iterator<Item = Entry> + '_ {
        self.indices
            .iter()
            .take(self.count)
            .filter_map(|index| self.entries.get(usize::from(*index)).copied())
    }
}

impl fmt::Display for ConflictingRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, row) in self.rows().enumerate() {
            let separator = if number == 0 { "" } else { ", " };
            write!(f, "{separator}`{}` (line {})", row.name, row.line)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn rows_that_hold_are_named_with_the_largest_first() {
        const ENTRIES: &[Entry] = &[
            Entry { name: "a", unit: "m", line: 1 },
            Entry { name: "b", unit: "m", line: 2 },
            Entry { name: "c", unit: "m", line: 3 },
            Entry { name: "d", unit: "m", line: 4 },
            Entry { name: "e", unit: "m", line: 5 },
            Entry { name: "f", unit: "m", line: 6 },
        ];
        let names = |residuals: [f64; 6]| -> std::vec::Vec<&str> {
            ConflictingRows::of(ENTRIES, residuals.into_iter()).rows().map(|row| row.name).collect()
        };
        assert_eq!(names([0.0, 0.2, 1e-5, 0.3, 0.0, 0.1]), ["d", "b", "f"]);
        assert_eq!(names([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), ["f", "e", "d", "c"]);
        assert_eq!(names([0.0; 6]), [""; 0]);
        let two = ConflictingRows::of(ENTRIES, [0.0, 0.2, 0.0, 0.3].into_iter()).to_string();
        assert_eq!(two, "`d` (line 4), `b` (line 2)");
    }
}

//! Strongly connected parts of the matched rows: the diagonal blocks, in the order in which they can be solved.

use super::matching::Matching;

/// Before: a matching of all rows. After: the rows of each block, ascending; a block uses earlier ones alone.
///
/// Tarjan's algorithm on an explicit stack; rows are visited in the order of the text, so that equal texts give
/// equal orders.
pub fn blocks(rows: &[Vec<usize>], matching: &Matching) -> Vec<Vec<usize>> {
    let mut search = Search {
        // A row needs the rows that determine its other coordinates.
        needs: rows
            .iter()
            .map(|columns| {
                columns.iter().filter_map(|c| matching.of_column.get(*c).copied().flatten()).collect()
            })
            .collect(),
        number: vec![None; rows.len()],
        low: vec![0; rows.len()],
        open: vec![false; rows.len()],
        stack: Vec::new(),
        next: 0,
        blocks: Vec::new(),
    };
    for row in 0..rows.len() {
        if search.number.get(row) == Some(&None) {
            search.run(row);
        }
    }
    search.blocks
}

struct Search {
    needs: Vec<Vec<usize>>,
    number: Vec<Option<usize>>,
    low: Vec<usize>,
    open: Vec<bool>,
    stack: Vec<usize>,
    next: usize,
    blocks: Vec<Vec<usize>>,
}

impl Search {
    fn run(&mut self, root: usize) {
        let mut path = vec![(root, 0)];
        self.enter(root);
        while let Some((row, edge)) = path.last_mut() {
            let row = *row;
            let Some(needed) = self.needs.get(row).and_then(|needs| needs.get(*edge)).copied() else {
                path.pop();
                self.leave(row);
                if let Some((parent, _)) = path.last() {
                    self.lower(*parent, self.low_of(row));
                }
                continue;
            };
            *edge += 1;
            match self.number.get(needed).copied().flatten() {
                None => {
                    self.enter(needed);
                    path.push((needed, 0));
                }
                Some(number) if self.open.get(needed) == Some(&true) => self.lower(row, number),
                Some(_) => {}
            }
        }
    }

    fn low_of(&self, row: usize) -> usize {
        self.low.get(row).copied().unwrap_or(0)
    }

    fn lower(&mut self, row: usize, to: usize) {
        if let Some(low) = self.low.get_mut(row) {
            *low = (*low).min(to);
        }
    }

    fn enter(&mut self, row: usize) {
        if let (Some(number), Some(low), Some(open)) =
            (self.number.get_mut(row), self.low.get_mut(row), self.open.get_mut(row))
        {
            (*number, *low, *open) = (Some(self.next), self.next, true);
        }
        self.next += 1;
        self.stack.push(row);
    }

    /// Closes a block where `row` is the first of it that was reached.
    fn leave(&mut self, row: usize) {
        if self.number.get(row).copied().flatten() != Some(self.low_of(row)) {
            return;
        }
        let mut block = Vec::new();
        while let Some(member) = self.stack.pop() {
            if let Some(open) = self.open.get_mut(member) {
                *open = false;
            }
            block.push(member);
            if member == row {
                break;
            }
        }
        block.sort_unstable();
        self.blocks.push(block);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::matching::match_rows;

    #[test]
    fn the_four_bar_falls_into_drive_loop_and_coupler_point() {
        // Rows: x2, y2, two of the closure, the drive. Columns: x2 y2 phi1 phi2 phi3.
        let rows = [vec![0, 2, 3], vec![1, 2, 3], vec![2, 3, 4], vec![2, 3, 4], vec![2]];
        let order = blocks(&rows, &match_rows(&rows, 5));
        assert_eq!(order, [vec![4], vec![2, 3], vec![0], vec![1]]);
    }
}

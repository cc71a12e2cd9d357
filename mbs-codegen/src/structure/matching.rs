//! Maximum matching of rows and coordinates.

/// Coordinate that each row determines.
#[derive(Debug)]
pub struct Matching {
    /// One a row.
    pub of_row: Vec<Option<usize>>,
    /// One a coordinate.
    pub of_column: Vec<Option<usize>>,
}

impl Matching {
    /// Rows without a coordinate.
    pub fn free_rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.of_row.iter().enumerate().filter(|(_, column)| column.is_none()).map(|(row, _)| row)
    }

    /// Coordinates without a row.
    pub fn free_columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.of_column.iter().enumerate().filter(|(_, row)| row.is_none()).map(|(column, _)| column)
    }
}

/// Before: the columns of each row. After: a matching of most rows; earlier rows are served first.
pub fn match_rows(rows: &[Vec<usize>], columns: usize) -> Matching {
    match_in_order(rows, columns, 0..rows.len())
}

/// Before: the columns of each row. After: a matching of most rows; those that `order` names first are matched first,
/// so that free ones are as late in it as can be.
pub fn match_in_order(
    rows: &[Vec<usize>],
    columns: usize,
    order: impl IntoIterator<Item = usize>,
) -> Matching {
    let mut matching = Matching { of_row: vec![None; rows.len()], of_column: vec![None; columns] };
    for row in order {
        augment(rows, row, &mut matching);
    }
    matching
}

/// Finds a path from a free row to a free column, breadth first, and turns it over.
fn augment(rows: &[Vec<usize>], start: usize, matching: &mut Matching) {
    // The row through which each column was reached.
    let mut reached: Vec<Option<usize>> = vec![None; matching.of_column.len()];
    let mut waiting = std::collections::VecDeque::from([start]);
    while let Some(row) = waiting.pop_front() {
        for column in rows.get(row).into_iter().flatten() {
            match reached.get_mut(*column) {
                Some(from @ None) => *from = Some(row),
                _ => continue,
            }
            match matching.of_column.get(*column).copied().flatten() {
                Some(next) => waiting.push_back(next),
                None => return turn(*column, &reached, matching),
            }
        }
    }
}

fn turn(end: usize, reached: &[Option<usize>], matching: &mut Matching) {
    let mut column = end;
    while let Some(row) = reached.get(column).copied().flatten() {
        let previous = matching.of_row.get(row).copied().flatten();
        if let Some(slot) = matching.of_row.get_mut(row) {
            *slot = Some(column);
        }
        if let Some(slot) = matching.of_column.get_mut(column) {
            *slot = Some(row);
        }
        match previous {
            Some(previous) => column = previous,
            None => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_turned_over_where_the_first_choice_blocks() {
        let matching = match_rows(&[vec![0, 1], vec![0]], 2);
        assert_eq!(matching.of_row, [Some(1), Some(0)]);
    }

    #[test]
    fn unmatched_unknowns_stay_free() {
        let matching = match_rows(&[vec![0], vec![0], vec![1, 2]], 3);
        assert_eq!(matching.free_rows().collect::<Vec<_>>(), [1]);
        assert_eq!(matching.free_columns().count(), 1);
    }
}

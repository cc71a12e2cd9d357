//! Rows that may follow from others: which of them are surplus, and the blocks that they are solved with.

use std::collections::BTreeSet;

use super::Block;
use super::matching::{Matching, match_in_order};
use crate::model::Model;

/// The order in which rows are matched: rows of constraints marked `redundant` last, so that only they can stay free.
pub fn order(model: &Model) -> Vec<usize> {
    let mut order: Vec<usize> = (0..model.rows.len()).collect();
    order.sort_by_key(|row| model.rows.get(*row).is_some_and(|row| row.redundant));
    order
}

/// Advice on `rows` of which `surplus` are too many: to mark their constraint where the rest would be square.
pub fn cure(model: &Model, rows: &[Vec<usize>], part: &[usize], surplus: usize) -> String {
    let plain = "remove what follows from the other rows, or declare the coordinate that is missing in them";
    let is_driven = |row: usize| model.rows.get(row).is_some_and(|row| row.driven);
    // Matched last, constraints give way to drives wherever they can.
    let mut order: Vec<usize> = part.to_vec();
    order.sort_by_key(|row| !is_driven(*row));
    let matching = match_in_order(rows, model.coordinates.len(), order);
    let of_row = |row: usize| matching.of_row.get(row).copied().flatten();
    let free: Vec<usize> = part.iter().copied().filter(|row| of_row(*row).is_none()).collect();
    let name = free.last().and_then(|row| model.rows.get(*row)).map(|row| {
        let (group, number) = row.name.rsplit_once('.').unwrap_or((&row.name, ""));
        if number.bytes().all(|digit| digit.is_ascii_digit()) { group.to_owned() } else { row.name.clone() }
    });
    match name {
        Some(name) if free.len() == surplus && !free.iter().any(|row| is_driven(*row)) => {
            format!(
                "{plain}; rows that may follow from others are marked: `constraint {name} redundant {{ … }}`"
            )
        }
        _ => plain.to_owned(),
    }
}

/// Before: square blocks in the order of their solution, and rows that none of them took. After: each such row is
/// solved together with every block that it depends on. So it determines what these leave open where they are singular.
/// Explicit blocks that depend on no such block remain separate.
///
/// The blocks that a surplus row depends on are closed: each depends on blocks among them alone. So explicit blocks
/// go first, then the merged ones, then all others in their order.
pub fn merged(
    blocks: Vec<Block>,
    surplus: &[usize],
    rows: &[Vec<usize>],
    matching: &Matching,
    coordinates: usize,
) -> Vec<Block> {
    if surplus.is_empty() {
        return blocks;
    }
    let mut solved_in = vec![None; coordinates];
    for (index, block) in blocks.iter().enumerate() {
        for coordinate in &block.coordinates {
            if let Some(slot) = solved_in.get_mut(*coordinate) {
                *slot = Some(index);
            }
        }
    }
    let mut parts: Vec<(BTreeSet<usize>, Vec<usize>)> = Vec::new();
    let mut first = BTreeSet::new();
    for row in surplus {
        let reached = depended_on(*row, &solved_in, rows, matching);
        let joint = solved_together(&reached, &blocks, &solved_in, rows);
        first.extend(reached.difference(&joint).copied());
        // Rows that share a block are one part.
        let (joined, apart): (Vec<_>, Vec<_>) =
            parts.into_iter().partition(|(other, _)| !other.is_disjoint(&joint));
        let mut part = (joint, vec![*row]);
        for (blocks, surplus) in joined {
            part.0.extend(blocks);
            part.1.extend(surplus);
        }
        parts = apart;
        parts.push(part);
    }
    let mut kept: Vec<Option<Block>> = blocks.into_iter().map(Some).collect();
    let mut take = |index: usize| kept.get_mut(index).and_then(Option::take);
    // A block assigned for one row may be the only assignment possible for another; then that part is first.
    parts.sort_by_key(|(members, _)| members.last().copied());
    let is_joint = |index: &usize| parts.iter().any(|(members, _)| members.contains(index));
    let first: Vec<usize> = first.into_iter().filter(|index| !is_joint(index)).collect();
    let mut order: Vec<Block> = first.into_iter().filter_map(&mut take).collect();
    for (members, surplus) in parts {
        let members: Vec<Block> = members.into_iter().filter_map(&mut take).collect();
        order.push(joined(members, surplus));
    }
    order.extend(kept.into_iter().flatten());
    order
}

/// One block of several, with surplus rows.
fn joined(members: Vec<Block>, surplus: Vec<usize>) -> Block {
    let (mut rows, mut coordinates) = (surplus, Vec::new());
    for block in members {
        rows.extend(block.rows);
        coordinates.extend(block.coordinates);
    }
    rows.sort_unstable();
    coordinates.sort_unstable();
    Block { rows, coordinates, explicit: None, dyad: None, order: None, curvature: None }
}

/// Indices of all blocks that a row depends on, directly or through others.
fn depended_on(
    row: usize,
    solved_in: &[Option<usize>],
    rows: &[Vec<usize>],
    matching: &Matching,
) -> BTreeSet<usize> {
    let (mut seen, mut reached, mut waiting) = (BTreeSet::from([row]), BTreeSet::new(), vec![row]);
    while let Some(row) = waiting.pop() {
        for coordinate in rows.get(row).into_iter().flatten() {
            reached.extend(solved_in.get(*coordinate).copied().flatten());
            let next = matching.of_column.get(*coordinate).copied().flatten();
            waiting.extend(next.filter(|next| seen.insert(*next)));
        }
    }
    reached
}

/// Those of the `reached` blocks that are solved together; the others are assigned before them. If all could be
/// assigned it is the last one, for the surplus row must be in a block.
fn solved_together(
    reached: &BTreeSet<usize>,
    blocks: &[Block],
    solved_in: &[Option<usize>],
    rows: &[Vec<usize>],
) -> BTreeSet<usize> {
    let mut joint = BTreeSet::new();
    for index in reached {
        let Some(block) = blocks.get(*index) else { continue };
        let needed = block.rows.iter().filter_map(|row| rows.get(*row)).flatten();
        let mut needed = needed.filter_map(|coordinate| solved_in.get(*coordinate).copied().flatten());
        if block.explicit.is_none() || needed.any(|block| joint.contains(&block)) {
            joint.insert(*index);
        }
    }
    if joint.is_empty() {
        joint.extend(reached.last());
    }
    joint
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(rows: &[usize], coordinates: &[usize], explicit: bool) -> Block {
        let explicit = explicit.then(|| crate::structure::Explicit {
            value: crate::symbolic::Graph::default().constant(0.0),
            coefficient: 1.0,
        });
        Block {
            rows: rows.to_vec(),
            coordinates: coordinates.to_vec(),
            explicit,
            dyad: None,
            order: None,
            curvature: None,
        }
    }

    fn order(
        blocks: Vec<Block>,
        surplus: &[usize],
        rows: &[Vec<usize>],
        columns: usize,
    ) -> Vec<(Vec<usize>, Vec<usize>)> {
        let serving: Vec<usize> = (0..rows.len()).filter(|row| !surplus.contains(row)).collect();
        let matching = match_in_order(rows, columns, serving);
        let merged = merged(blocks, surplus, rows, &matching, columns);
        merged.into_iter().map(|block| (block.rows, block.coordinates)).collect()
    }

    #[test]
    fn a_surplus_row_joins_the_blocks_that_it_depends_on() {
        // A drive, a loop of two, a point that it carries, a second loop, and a row that ties the point to the first loop.
        let rows = [vec![0], vec![0, 1, 2], vec![0, 1, 2], vec![1, 3], vec![0, 4], vec![2, 3]];
        let blocks = vec![
            block(&[0], &[0], true),
            block(&[4], &[4], false),
            block(&[1, 2], &[1, 2], false),
            block(&[3], &[3], true),
        ];
        let found = order(blocks, &[5], &rows, 5);
        let expected = [(vec![0], vec![0]), (vec![1, 2, 3, 5], vec![1, 2, 3]), (vec![4], vec![4])];
        assert_eq!(found, expected);
    }

    #[test]
    fn surplus_rows_of_loops_apart_stay_apart() {
        let rows = [vec![0], vec![0, 1], vec![0, 2], vec![0, 1], vec![0, 2]];
        let blocks = vec![block(&[0], &[0], true), block(&[1], &[1], false), block(&[2], &[2], false)];
        let found = order(blocks, &[3, 4], &rows, 3);
        assert_eq!(found, [(vec![0], vec![0]), (vec![1, 3], vec![1]), (vec![2, 4], vec![2])]);
    }

    #[test]
    fn a_row_beside_assignments_alone_joins_the_last_of_them() {
        let rows = [vec![0], vec![0, 1], vec![0, 1]];
        let blocks = vec![block(&[0], &[0], true), block(&[1], &[1], true)];
        assert_eq!(order(blocks, &[2], &rows, 2), [(vec![0], vec![0]), (vec![1, 2], vec![1])]);
    }
}

//! The order in which a block of four and more unknowns is eliminated: decided here, guarded at run time.
//!
//! Closures are vectors. So a single entry of a loop, −L sin φ, vanishes within each turn, whereas the two rows for two
//! angles do not. Pivots are therefore constant entries (numbers), 2 × 2, or the two rows of a column that has no others. Of these rows
//! the component along the column gives its unknown; the component across is free of it and stays. The remaining block is up to 3 × 3.

use crate::symbolic::sample_points::scattered;
use crate::symbolic::{Graph, Leaf, NodeId, evaluate::evaluate};

/// Smallest block that is worth an order: closed forms are shorter below.
const SMALLEST: usize = 4;

/// Largest block of which all pairs of rows are tried as pivots; of a larger one, pairs within `NEAR`.
const LARGEST_TRIED: usize = 12;

/// Largest distance of two rows of a large block that are tried together: the components of a vector equation and its neighbours.
const NEAR: usize = 3;

/// Largest block that is eliminated by straight-line code.
const LARGEST: usize = 64;

/// States at which pivots are tried.
const SAMPLES: usize = 8;

/// Most samples at which a pivot may be refused; at such states the elimination with pivoting is an extra cost.
const MOST_UNBORNE: usize = 2;

/// Largest multiplier of an accepted pivot: half of the limit at run time.
const LARGEST_MULTIPLIER: f64 = 8.0;

/// Price of a reciprocal in products.
const RECIPROCAL: usize = 8;

/// Price of the determinant and the inverse of a 2 × 2 pivot without its reciprocal.
const INVERSE: usize = 8;

/// Price of a column's length and of the weight of a component without the reciprocal.
const LENGTH: usize = 7;

/// Price of the bound on a multiplier.
const BOUND: usize = 5;

/// Pivots in the order of the elimination; each has as many rows as columns, the last one is the rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// Pivots of one or two rows, the last one of up to three.
    pub pivots: Vec<Pivot>,
}

/// Rows and columns within the block, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pivot {
    /// Its rows.
    pub rows: Vec<usize>,
    /// Its columns.
    pub columns: Vec<usize>,
    /// The second row of a single column: the pivot is the component of both rows along it, that across it takes this row's place.
    pub across: Option<usize>,
}

impl Pivot {
    /// The rows that it is made of, that of the component across at the end.
    pub fn sources(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().copied().chain(self.across)
    }

    /// Both rows and the column of a component.
    pub fn component(&self) -> Option<([usize; 2], usize)> {
        match (self.rows.as_slice(), self.columns.as_slice(), self.across) {
            (&[first], &[column], Some(second)) => Some(([first, second], column)),
            _ => None,
        }
    }
}

/// Before: the Jacobian of a block, row by row, and the scales of its rows. After: the order with the fewest products at each step, of
/// pivots that most states accept. `None` where there is no such order, or the block is too small or too large.
pub fn order(graph: &Graph, phi_q: &[Vec<Option<NodeId>>], scales: &[NodeId]) -> Option<Order> {
    let size = phi_q.len();
    if !(SMALLEST..=LARGEST).contains(&size) {
        return None;
    }
    let mut rest = Rest::of(graph, phi_q, scales)?;
    let mut pivots = Vec::new();
    while rest.rows.len() > 2 {
        let cheapest = |candidates: Vec<Pivot>, price: &dyn Fn(&Pivot) -> usize| {
            let accepted = candidates.into_iter().filter(|pivot| rest.accepts(pivot));
            accepted.min_by_key(|pivot| (price(pivot), pivot.rows.clone(), pivot.columns.clone()))
        };
        let components = cheapest(rest.components(), &|pivot| rest.work(pivot));
        let best = match rest.rows.len() {
            // The closed form of three is the cheaper one unless lengths are at hand already.
            3 if pivots.iter().all(|pivot: &Pivot| pivot.across.is_none()) => None,
            3 => components,
            _ => {
                let usual = cheapest(rest.candidates(), &|pivot| rest.price(pivot));
                let both = usual.into_iter().chain(components);
                Some(both.min_by_key(|pivot| rest.work(pivot))?)
            }
        };
        let Some(best) = best else { break };
        rest.eliminate(&best);
        pivots.push(best);
    }
    pivots.push(Pivot { rows: rest.rows, columns: rest.columns, across: None });
    Some(Order { pivots })
}

/// Part that is not eliminated yet.
struct Rest {
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// Entries that are not zero by structure, by row and column of the block.
    present: Vec<Vec<bool>>,
    /// Entries that are numbers of the text.
    fixed: Vec<Vec<bool>>,
    /// Scale of each row as it is in the text; none of a component of two rows.
    scales: Vec<Option<NodeId>>,
    /// The block in each sample.
    samples: Vec<Vec<Vec<f64>>>,
}

impl Rest {
    fn of(graph: &Graph, phi_q: &[Vec<Option<NodeId>>], scales: &[NodeId]) -> Option<Self> {
        let size = phi_q.len();
        let nodes: Vec<NodeId> = phi_q.iter().flatten().copied().flatten().collect();
        let mut samples = Vec::new();
        for sample in 0..SAMPLES {
            let mut values = evaluate(graph, &nodes, |leaf| value(leaf, sample)).into_iter();
            let mut next = |entry: &Option<NodeId>| entry.and_then(|_| values.next()).unwrap_or(0.0);
            samples.push(phi_q.iter().map(|row| row.iter().map(&mut next).collect()).collect());
        }
        let finite = samples.iter().flatten().flatten().all(|value: &f64| value.is_finite());
        let each = |holds: &dyn Fn(NodeId) -> bool| -> Vec<Vec<bool>> {
            phi_q.iter().map(|row| row.iter().map(|entry| entry.is_some_and(holds)).collect()).collect()
        };
        finite.then(|| Rest {
            rows: (0..size).collect(),
            columns: (0..size).collect(),
            present: each(&|_| true),
            fixed: each(&|id| graph.constant_value(id).is_some_and(|value| value != 0.0)),
            scales: (0..size).map(|row| scales.get(row).copied()).collect(),
            samples,
        })
    }

    fn is_present(&self, row: usize, column: usize) -> bool {
        self.present.get(row).and_then(|row| row.get(column)).copied().unwrap_or(false)
    }

    fn is_fixed(&self, row: usize, column: usize) -> bool {
        self.fixed.get(row).and_then(|row| row.get(column)).copied().unwrap_or(false)
    }

    /// The remaining columns with an entry in a row.
    fn columns_of(&self, row: usize) -> Vec<usize> {
        self.columns.iter().copied().filter(|column| self.is_present(row, *column)).collect()
    }

    /// Numbers, and 2 × 2 that are regular by structure.
    fn candidates(&self) -> Vec<Pivot> {
        let mut candidates = Vec::new();
        let near = if self.rows.len() <= LARGEST_TRIED { self.rows.len() } else { NEAR };
        for (index, &first) in self.rows.iter().enumerate() {
            let own = self.columns_of(first);
            let fixed = own.iter().filter(|column| self.is_fixed(first, **column));
            candidates.extend(fixed.map(|column| Pivot {
                rows: vec![first],
                columns: vec![*column],
                across: None,
            }));
            for &second in self.rows.iter().skip(index + 1).take(near) {
                let other = self.columns_of(second);
                for &a in &own {
                    for &b in other.iter().filter(|b| **b != a) {
                        // Both ways round are one candidate.
                        let (low, high) = (a.min(b), a.max(b));
                        let twice = a > b && self.is_present(first, b) && self.is_present(second, a);
                        if !twice {
                            let (rows, columns) = (vec![first, second], vec![low, high]);
                            candidates.push(Pivot { rows, columns, across: None });
                        }
                    }
                }
            }
        }
        candidates
    }

    /// Columns with entries in two rows alone, both of one scale, neither of which is a component already: so lengths are not
    /// multiplied again.
    fn components(&self) -> Vec<Pivot> {
        let component = |column: usize| {
            let rows: Vec<usize> =
                self.rows.iter().copied().filter(|row| self.is_present(*row, column)).collect();
            let &[first, second] = rows.as_slice() else { return None };
            let [scale, other] = [first, second].map(|row| self.scales.get(row).copied().flatten());
            let fits = scale.is_some() && scale == other;
            let varies = !self.is_fixed(first, column) && !self.is_fixed(second, column);
            (fits && varies).then(|| Pivot { rows: vec![first], columns: vec![column], across: Some(second) })
        };
        self.columns.iter().copied().filter_map(component).collect()
    }

    /// Rows outside a pivot that have an entry in its columns, and columns outside it with one in its rows.
    fn beside(&self, pivot: &Pivot) -> (Vec<usize>, Vec<usize>) {
        let rows = self.rows.iter().copied().filter(|row| pivot.sources().all(|source| source != *row));
        let rows = rows.filter(|row| pivot.columns.iter().any(|column| self.is_present(*row, *column)));
        let columns = self.columns.iter().copied().filter(|column| !pivot.columns.contains(column));
        let columns = columns.filter(|column| pivot.sources().any(|row| self.is_present(row, *column)));
        (rows.collect(), columns.collect())
    }

    /// Products of the elimination, an unknown; of equal ones the pivot of fewer rows is cheaper to solve with.
    fn price(&self, pivot: &Pivot) -> usize {
        let (rows, columns) = self.beside(pivot);
        let size = pivot.rows.len();
        let inverse = match size {
            1 => 0,
            _ => INVERSE + RECIPROCAL,
        };
        let multipliers = rows.len() * size * size;
        // Twice, so that an unknown's share of two is a whole number.
        2 * (inverse + multipliers + rows.len() * size * columns.len()) / size
    }

    /// Instructions of a step, an unknown: two eliminations, three solutions, bounds. It decides between components and other pivots.
    fn work(&self, pivot: &Pivot) -> usize {
        let (rows, columns) = self.beside(pivot);
        let (rows, columns, size) = (rows.len(), columns.len(), pivot.rows.len());
        let (elimination, solution) = match (size, pivot.across) {
            (1, Some(_)) => (LENGTH + RECIPROCAL + 3 * columns, 4 * columns + 7),
            (1, None) => (rows + 2 * rows * columns, 2 * rows + 2 * columns + 1),
            _ => {
                let multipliers = rows * size * (2 * size - 1 + BOUND);
                let elimination = INVERSE + LENGTH + RECIPROCAL + multipliers + 2 * rows * size * columns;
                (elimination, size * (2 * rows + 2 * columns + 2 * size - 1))
            }
        };
        2 * (2 * elimination + 3 * solution) / size
    }

    /// `true` if enough samples keep their multipliers small; a component has none.
    fn accepts(&self, pivot: &Pivot) -> bool {
        if let Some((rows, column)) = pivot.component() {
            return self.samples.iter().all(|a| rows.iter().any(|row| at(a, *row, column) != 0.0));
        }
        let (rows, _) = self.beside(pivot);
        let unborne = self.samples.iter().filter(|a| {
            let inverse = inverse(a, pivot);
            let largest = |row: &usize| multipliers(a, *row, pivot, &inverse).into_iter().fold(0.0, f64::max);
            // NaN is refused.
            !rows.iter().all(|row| largest(row) <= LARGEST_MULTIPLIER)
                || !inverse.iter().flatten().all(|x| x.is_finite())
        });
        unborne.count() <= MOST_UNBORNE
    }

    /// The rest without the pivot's rows and columns.
    fn eliminate(&mut self, pivot: &Pivot) {
        let (rows, columns) = self.beside(pivot);
        if let Some(scale) = pivot.across.and_then(|second| self.scales.get_mut(second)) {
            *scale = None;
        }
        for row in rows.iter().copied().chain(pivot.across) {
            for column in &columns {
                set(&mut self.present, row, *column, true);
                set(&mut self.fixed, row, *column, false);
            }
        }
        for a in &mut self.samples {
            if let Some(([first, second], column)) = pivot.component() {
                let (x, y) = (at(a, first, column), at(a, second, column));
                for other in &columns {
                    let across = x * at(a, second, *other) - y * at(a, first, *other);
                    set(a, second, *other, across / x.hypot(y));
                }
            }
            let inverse = inverse(a, pivot);
            for row in &rows {
                let multipliers = signed_multipliers(a, *row, pivot, &inverse);
                for column in &columns {
                    let taken: f64 = multipliers
                        .iter()
                        .zip(&pivot.rows)
                        .map(|(l, above)| l * at(a, *above, *column))
                        .sum();
                    let left = at(a, *row, *column) - taken;
                    set(a, *row, *column, left);
                }
            }
        }
        self.rows.retain(|row| !pivot.rows.contains(row));
        self.columns.retain(|column| !pivot.columns.contains(column));
    }
}

fn at(a: &[Vec<f64>], row: usize, column: usize) -> f64 {
    a.get(row).and_then(|row| row.get(column)).copied().unwrap_or(0.0)
}

fn set<X>(a: &mut [Vec<X>], row: usize, column: usize, value: X) {
    if let Some(entry) = a.get_mut(row).and_then(|row| row.get_mut(column)) {
        *entry = value;
    }
}

/// The inverse of a pivot of one or two rows; not finite where it is singular.
fn inverse(a: &[Vec<f64>], pivot: &Pivot) -> Vec<Vec<f64>> {
    match (pivot.rows.as_slice(), pivot.columns.as_slice()) {
        (&[first, second], &[left, right]) => {
            let (p, q, r, s) =
                (at(a, first, left), at(a, first, right), at(a, second, left), at(a, second, right));
            let reciprocal = 1.0 / (p * s - q * r);
            vec![vec![s * reciprocal, -q * reciprocal], vec![-r * reciprocal, p * reciprocal]]
        }
        (&[row], &[column]) => vec![vec![1.0 / at(a, row, column)]],
        _ => Vec::new(),
    }
}

/// Multipliers with which the pivot's rows are subtracted from a row: one factor each.
fn signed_multipliers(a: &[Vec<f64>], row: usize, pivot: &Pivot, inverse: &[Vec<f64>]) -> Vec<f64> {
    let column = |k: usize| {
        let entries = pivot.columns.iter().zip(inverse);
        entries.map(|(column, inverse)| at(a, row, *column) * inverse.get(k).copied().unwrap_or(0.0)).sum()
    };
    (0..pivot.rows.len()).map(column).collect()
}

fn multipliers(a: &[Vec<f64>], row: usize, pivot: &Pivot, inverse: &[Vec<f64>]) -> Vec<f64> {
    signed_multipliers(a, row, pivot, inverse).into_iter().map(f64::abs).collect()
}

/// A leaf's value in a sample: what may be a length between ½ and 1½, a coordinate between −3 and 3.
fn value(leaf: Leaf, sample: usize) -> f64 {
    let fraction = scattered(leaf, sample);
    if matches!(leaf, Leaf::Position(_)) { 6.0 * fraction - 3.0 } else { 0.5 + fraction }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries `1` are the number one, `x` vary from row to row and column to column.
    fn of(rows: &[&str]) -> Option<Order> {
        let mut graph = Graph::default();
        let mut index = 0;
        let mut entries = Vec::new();
        for row in rows {
            let mut line = Vec::new();
            for letter in row.chars().filter(|letter| !letter.is_whitespace()) {
                line.push(match letter {
                    '1' => Some(graph.constant(1.0)),
                    'x' => {
                        index += 1;
                        Some(graph.leaf(Leaf::Position(index)))
                    }
                    _ => None,
                });
            }
            entries.push(line);
        }
        let scale = graph.constant(2.0);
        order(&graph, &entries, &vec![scale; entries.len()])
    }

    fn pivots(order: &Order) -> Vec<(&[usize], &[usize])> {
        order.pivots.iter().map(|pivot| (pivot.rows.as_slice(), pivot.columns.as_slice())).collect()
    }

    #[test]
    fn numbers_go_first_and_every_row_and_column_is_taken_once() {
        let order = of(&["1.xx..", ".1xx..", "1..xx.", ".1.xx.", "1...xx", ".1..xx"]).expect("an order");
        let [first, second, ..] = order.pivots.as_slice() else { panic!("{order:?}") };
        assert_eq!((first.rows.len(), second.rows.len()), (1, 1), "{order:?}");
        let mut rows: Vec<usize> = order.pivots.iter().flat_map(|pivot| pivot.rows.clone()).collect();
        let mut columns: Vec<usize> = order.pivots.iter().flat_map(|pivot| pivot.columns.clone()).collect();
        rows.sort_unstable();
        columns.sort_unstable();
        assert_eq!((rows, columns), ((0..6).collect(), (0..6).collect()));
    }

    #[test]
    fn loops_of_two_rows_are_taken_together() {
        let order = of(&["xxx.", "xxx.", "x..x", "x..x"]);
        // The second loop has one angle of its own alone: the first is eliminated.
        let order = order.expect("an order");
        assert_eq!(pivots(&order).first(), Some(&([0, 1].as_slice(), [1, 2].as_slice())), "{order:?}");
    }

    #[test]
    fn columns_with_two_rows_are_taken_by_components() {
        let order = of(&["xxx.", "xxx.", "xx.x", "xx.x"]).expect("an order");
        let taken: Vec<_> = order.pivots.iter().map(Pivot::component).collect();
        assert_eq!(taken, [Some(([0, 1], 2)), Some(([2, 3], 3)), None], "{order:?}");
        assert_eq!(pivots(&order).last(), Some(&([1, 3].as_slice(), [0, 1].as_slice())), "{order:?}");
    }

    #[test]
    fn components_are_of_rows_of_one_scale() {
        let (mut graph, mut index) = (Graph::default(), 0);
        let mut entry = |row: usize, column: usize| {
            index += 1;
            (column < 2 || column - 2 == row / 2).then(|| graph.leaf(Leaf::Position(index)))
        };
        let rows: Vec<Vec<_>> = (0..4).map(|row| (0..4).map(|column| entry(row, column)).collect()).collect();
        let scales = [1.0, 2.0, 3.0, 4.0].map(|scale| graph.constant(scale));
        let order = order(&graph, &rows, &scales).expect("an order");
        assert!(order.pivots.iter().all(|pivot| pivot.across.is_none()), "{order:?}");
    }

    #[test]
    fn blocks_in_closed_form_have_no_order() {
        assert_eq!(of(&["xx.", ".xx", "x.x"]), None);
    }

    #[test]
    fn a_chain_that_closes_stays_sparse() {
        let size = 40;
        let row = |i: usize| -> String {
            (0..size)
                .map(|j| if j == i || j == (i + 1) % size || j == (i + 2) % size { 'x' } else { '.' })
                .collect()
        };
        let rows: Vec<String> = (0..size).map(row).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let order = of(&rows).expect("an order");
        assert_eq!(order.pivots.iter().map(|pivot| pivot.rows.len()).sum::<usize>(), size);
    }
}

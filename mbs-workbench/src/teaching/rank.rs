//! The rank of a matrix in the reference metric, and columns that carry it.

/// Part of the largest column below which the remainder of a column counts as zero: √ε. Near a dead centre a position is
/// known to √ε only, and with it Φ_q. The bound is far above the rounding of its entries.
const NOTHING: f64 = 1.5e-8;

/// Columns that are linearly independent, in the order in which they were taken.
///
/// `rows`: the matrix, row by row. Each step takes the longest remaining column; columns marked in `last` are taken only when
/// no others are left. Source: Golub & Van Loan 2013, §5.4.2 (QR with column pivoting).
pub fn independent_columns(rows: &[Vec<f64>], last: &[bool]) -> Vec<usize> {
    let count = rows.first().map_or(0, Vec::len);
    let mut columns: Vec<Vec<f64>> =
        (0..count).map(|k| rows.iter().map(|row| row[k]).collect::<Vec<f64>>()).collect();
    let largest = columns.iter().map(|column| length(column)).fold(0.0, f64::max);
    let mut taken: Vec<usize> = Vec::new();
    for late in [false, true] {
        loop {
            let open =
                (0..count).filter(|k| !taken.contains(k) && last.get(*k).copied().unwrap_or(false) == late);
            let next = open.map(|k| (length(&columns[k]), k)).max_by(|a, b| a.0.total_cmp(&b.0));
            match next {
                Some((size, k)) if size > NOTHING * largest => {
                    taken.push(k);
                    let direction: Vec<f64> = columns[k].iter().map(|entry| entry / size).collect();
                    columns.iter_mut().for_each(|column| remove(column, &direction));
                }
                _ => break,
            }
        }
    }
    taken
}

/// The rank of the matrix.
pub fn rank(rows: &[Vec<f64>]) -> usize {
    independent_columns(rows, &[]).len()
}

/// Singular values, descending, by one-sided Jacobi rotations.
///
/// Source: Golub & Van Loan 2013, §8.6.3.
pub fn singular_values(rows: &[Vec<f64>]) -> Vec<f64> {
    /// Sweeps; six or seven do for any size met here.
    const SWEEPS: usize = 30;
    let mut columns = transposed(rows);
    for _ in 0..SWEEPS {
        let mut turned = false;
        for j in 1..columns.len() {
            let (before, rest) = columns.split_at_mut(j);
            for column in before {
                turned |= make_orthogonal(column, &mut rest[0]);
            }
        }
        if !turned {
            break;
        }
    }
    let mut values: Vec<f64> = columns.iter().map(|column| length(column)).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Rotates two columns until they are orthogonal; `true` if they were not.
fn make_orthogonal(a: &mut [f64], b: &mut [f64]) -> bool {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    if ab == 0.0 || ab.abs() <= f64::EPSILON * (aa * bb).sqrt() {
        return false;
    }
    let tau = (bb - aa) / (2.0 * ab);
    let tangent = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (cosine * (*x - tangent * *y), cosine * (*y + tangent * *x));
    }
    true
}

/// The matrix with rows and columns exchanged.
pub fn transposed(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = rows.first().map_or(0, Vec::len);
    (0..count).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
}

fn length(column: &[f64]) -> f64 {
    column.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// Removes the component along a unit vector, twice because of rounding.
fn remove(column: &mut [f64], direction: &[f64]) {
    for _ in 0..2 {
        let part: f64 = column.iter().zip(direction).map(|(a, b)| a * b).sum();
        column.iter_mut().zip(direction).for_each(|(entry, d)| *entry -= part * d);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependent_row_lowers_the_rank() {
        let rows = vec![vec![1.0, 2.0, 3.0], vec![0.0, 1.0, 1.0], vec![1.0, 3.0, 4.0]];
        assert_eq!(rank(&rows), 2);
        assert_eq!(rank(&[vec![0.0; 3]]), 0);
        assert_eq!(rank(&[]), 0);
        assert_eq!(rank(&transposed(&rows)), 2);
    }

    #[test]
    fn singular_values_of_known_matrices() {
        let near = |found: Vec<f64>, expected: &[f64]| {
            found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14)
        };
        assert!(near(singular_values(&[vec![0.0, 2.0], vec![-1.0, 0.0]]), &[2.0, 1.0]));
        // [[1, 1], [0, 1]]: the golden ratio and its inverse.
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        assert!(near(singular_values(&[vec![1.0, 1.0], vec![0.0, 1.0]]), &[golden, 1.0 / golden]));
        assert!(near(singular_values(&[vec![1.0, 1.0], vec![1.0, 1.0]]), &[2.0, 0.0]));
    }

    #[test]
    fn columns_marked_last_are_taken_only_where_needed() {
        let rows = vec![vec![9.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]];
        assert_eq!(independent_columns(&rows, &[true, false, false]).len(), 2);
        assert!(!independent_columns(&rows, &[true, false, false]).contains(&0));
        assert!(independent_columns(&rows, &[false, true, false]).contains(&0));
    }
}

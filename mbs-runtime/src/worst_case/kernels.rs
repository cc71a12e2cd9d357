//! Largest operation counts of the runtime's kernels: m rows for k unknowns, m ≥ k.

use crate::mechanism::operations::Operations;

pub const fn add(count: u64) -> Operations {
    Operations { additions: count, ..Operations::NONE }
}

pub const fn multiply(count: u64) -> Operations {
    Operations { multiplications: count, ..Operations::NONE }
}

pub const fn divide(count: u64) -> Operations {
    Operations { divisions: count, ..Operations::NONE }
}

pub const fn root(count: u64) -> Operations {
    Operations { functions: count, ..Operations::NONE }
}

pub const fn select(count: u64) -> Operations {
    Operations { selections: count, ..Operations::NONE }
}

pub const fn compare(count: u64) -> Operations {
    Operations { comparisons: count, ..Operations::NONE }
}

/// `count` products and sums.
pub const fn products(count: u64) -> Operations {
    multiply(count).and(add(count))
}

/// Pairs i < j of k.
const fn pairs(k: u64) -> u64 {
    k * k.saturating_sub(1) / 2
}

/// Σ_{i<k} (k − 1 − i)², the updates of an elimination.
const fn updates(k: u64) -> u64 {
    k.saturating_sub(1) * k * (2 * k).saturating_sub(1) / 6
}

// Judging a point: `diagnosis`, `newton`, `budgeted`.

/// `extent` of n coordinates.
pub const fn largest(n: u64) -> Operations {
    divide(n).and(multiply(n)).and(select(2 * n))
}

/// `largest_difference` of n components.
pub const fn difference(n: u64) -> Operations {
    largest(n).and(add(n))
}

/// `all_finite` of m rows for k unknowns.
pub const fn finite(m: u64, k: u64) -> Operations {
    compare(m + m * k)
}

pub const fn required(m: u64, k: u64) -> Operations {
    products(m * k).and(select(m * k)).and(multiply(3 * m)).and(add(m))
}

pub const fn outer_rounding(m: u64, k: u64) -> Operations {
    products(m * k).and(select(m * k)).and(multiply(3 * m))
}

pub const fn within(m: u64) -> Operations {
    add(m).and(select(m)).and(compare(m))
}

/// `Worst::of_block`.
pub const fn worst(m: u64) -> Operations {
    divide(m).and(multiply(2 * m)).and(select(8 * m)).and(compare(4 * m))
}

/// `Best::meets`.
pub const fn meets(m: u64, k: u64) -> Operations {
    finite(m, k).and(required(m, k)).and(worst(m)).and(compare(1)).and(outer_rounding(m, k)).and(within(m))
}

/// `capped`, where the step is too long.
const fn capped(k: u64) -> Operations {
    select(2 * k + 1).and(compare(1)).and(divide(1)).and(multiply(k))
}

/// An iteration of `gauss_newton` without its evaluation.
pub const fn gauss_newton_step(m: u64, k: u64) -> Operations {
    let ratio = divide(m).and(select(2 * m)).and(compare(1));
    let factors = orthogonal(m, k).and(add(m)).and(orthogonal_solve(m, k));
    let change = products(m * k).and(outer_rounding(m, k)).and(within(m).times(3)).and(add(2 * m));
    finite(m, k).and(ratio).and(factors).and(change).and(capped(k)).and(add(k)).and(select(k))
}

/// An iteration of `newton` without its evaluation, where the Jacobian is singular.
pub const fn newton_step(k: u64) -> Operations {
    let ratio = divide(k).and(select(2 * k)).and(compare(1));
    let fall = multiply(1).and(compare(2)).and(select(2)).and(add(1));
    let singular = multiply(1).and(compare(1)).and(add(k)).and(minimum_norm(k));
    finite(k, k)
        .and(ratio)
        .and(fall)
        .and(factorize(k))
        .and(solve(k))
        .and(add(k))
        .and(singular)
        .and(capped(k))
        .and(add(k))
        .and(select(k))
}

// Levenberg–Marquardt: `safeguarded`.

/// `NormalEquations::of`.
pub const fn normal_equations(m: u64, k: u64) -> Operations {
    let row = divide(1).and(multiply(1)).and(multiply(2 * k)).and(products(1 + k + k * k));
    row.times(m)
}

/// A trial without its evaluation and its normal equations.
pub const fn trial(m: u64, k: u64) -> Operations {
    let stationary = products(k).and(add(k)).and(multiply(3)).and(compare(2));
    let replaced = select(m + m * k + 2 * k + k * k + 1);
    let damping = multiply(2).and(select(2));
    required(m, k)
        .and(within(m))
        .and(stationary)
        .and(damped_step(k))
        .and(capped(k))
        .and(add(k))
        .and(select(k))
        .and(compare(1))
        .and(finite(m, k))
        .and(replaced)
        .and(damping)
}

/// `NormalEquations::step`.
const fn damped_step(k: u64) -> Operations {
    let damping = add(k).and(divide(1)).and(root(1)).and(select(1)).and(multiply(2)).and(add(k));
    let pivots = compare(2 * k).and(select(2 * k));
    let elimination = divide(pairs(k)).and(products(updates(k) + pairs(k)));
    let back = products(pairs(k)).and(divide(k)).and(multiply(k));
    damping.and(add(k)).and(pivots).and(elimination).and(back)
}

// Linear systems: `linear`.

const fn in_metric(m: u64, k: u64) -> Operations {
    divide(m).and(multiply(2 * m * k))
}

/// `mean_square` and `reciprocal_and_margin`.
const fn margin(k: u64) -> Operations {
    let square = if k > 1 { products(k * k).and(multiply(1)) } else { Operations::NONE };
    square.and(divide(2)).and(select(7)).and(compare(5))
}

/// `Direct1`, `Direct2`, `Direct3`, `Lu`: the factors with their margin.
const fn factorize(k: u64) -> Operations {
    match k {
        1 => in_metric(1, 1).and(margin(1)),
        2 => in_metric(2, 2).and(margin(2)).and(multiply(8)).and(add(4)),
        3 => in_metric(3, 3)
            .and(margin(3))
            .and(multiply(4 * 6 + 2 * 3 + 1 + 9))
            .and(add(4 * 3 + 2 * 2))
            .and(root(1)),
        _ => {
            let swaps = select(2 * pairs(k)).and(compare(pairs(k))).and(select(pairs(k) * 2 * k));
            let pivot = select(6).and(compare(3)).and(divide(2)).times(k);
            let elimination = multiply(pairs(k)).and(products(updates(k)));
            in_metric(k, k).and(swaps).and(pivot).and(elimination).and(divide(1 + k)).and(select(3))
        }
    }
}

/// The factors of a block with their margin.
pub const fn factorize_block(m: u64, k: u64) -> Operations {
    if m > k { orthogonal(m, k) } else { factorize(k) }
}

/// A solution with them.
pub const fn solve_block(m: u64, k: u64) -> Operations {
    if m > k { orthogonal_solve(m, k) } else { solve(k) }
}

/// `Factorization::solve`.
const fn solve(k: u64) -> Operations {
    match k {
        1 => multiply(1),
        2 | 3 => multiply(k * k).and(add(k * (k - 1))),
        _ => multiply(3 * k).and(select(2 * pairs(k))).and(products(2 * pairs(k))),
    }
}

/// `orthogonal::minimum_norm` of full rank, which is the longest.
const fn minimum_norm(k: u64) -> Operations {
    let mut total =
        in_metric(k, k).and(divide(k)).and(multiply(k)).and(products(3 * k * k)).and(multiply(k * k));
    let mut column = 0;
    while column < k {
        let rest = k - column;
        let reflection = products(2 * rest).and(root(1)).and(compare(2)).and(add(1)).and(divide(1));
        let applied = products(2 * k).and(multiply(k)).times(rest);
        let pivot = products(2 * rest).and(compare(1)).times(rest - 1);
        let length = products(rest).and(root(1)).and(multiply(1)).and(compare(2));
        // Columns and the right-hand side, then the rows.
        let right = products(2 * k).and(multiply(k));
        let rows = reflection.and(applied).and(products(column)).and(divide(1));
        total = total.and(pivot).and(length).and(reflection).and(applied).and(right).and(rows);
        column += 1;
    }
    total
}

/// `Reflection::of` of m components, and the cost of applying one.
const fn reflection(m: u64) -> (Operations, Operations) {
    let made = products(2 * m).and(root(1)).and(compare(2)).and(add(1)).and(divide(1));
    (made, products(2 * m).and(multiply(m)))
}

/// `Orthogonal::factorize` of m rows for k unknowns, of full rank, with its margin.
const fn orthogonal(m: u64, k: u64) -> Operations {
    // Pivots, mean square, volume.
    let pivots = products(m * k).and(root(k)).and(select(k));
    let mean = products(m * k).and(divide(1)).and(root(1));
    let volume = divide(k).and(multiply(k)).and(compare(1)).and(select(1));
    // Rows that yield: their scales and order.
    let yielding = divide(1).and(multiply(1 + m)).and(select(m)).and(compare(6 * m));
    let mut total = in_metric(m, k).and(root(1)).and(pivots).and(mean).and(volume).and(yielding);
    let (made, applied) = reflection(m);
    let mut column = 0;
    while column < k {
        let rest = k - column;
        let longest = products(2 * (m - column)).and(compare(1)).times(rest - 1);
        let length = products(m - column).and(root(1)).and(multiply(1)).and(compare(2));
        total = total.and(longest).and(length).and(made).and(applied.times(rest));
        column += 1;
    }
    total
}

/// `Orthogonal::solve` where a column is lost, which is longer than full rank.
const fn orthogonal_solve(m: u64, k: u64) -> Operations {
    let (_, of_rows) = reflection(m);
    let (made, applied) = reflection(k);
    let ordered = compare(5 * m);
    let mut total = divide(m).and(of_rows.times(k)).and(multiply(k)).and(applied.times(m)).and(ordered);
    let mut row = 0;
    while row < k {
        total = total.and(made).and(applied.times(m - row)).and(products(row)).and(divide(1));
        row += 1;
    }
    total
}

//! What a step of bounded work can cost at most: emitted counts, and those of the runtime's kernels.
//!
//! The counts of the kernels follow their sources line by line, each from the code that it names. Where a count
//! depends on the numbers, the longer way is taken. A test counts what steps really do.

use crate::{Budget, Operations};

/// What the emitted functions of a mechanism cost, one call each on top of the stages before it.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// N.
    pub coordinates: usize,
    /// M.
    pub rows: usize,
    /// Entries of Φ_q that are not zero by structure.
    pub entries: usize,
    /// Number of branch conditions.
    pub branches: usize,
    /// Number of working ranges.
    pub limits: usize,
    /// Number of drives that prescribe a rate.
    pub phases: usize,
    /// Number of inputs with rates.
    pub inputs: usize,
    /// Values of `(q, t)` that functions share.
    pub position: Operations,
    /// Φ
    pub phi: Operations,
    /// Φ_q
    pub phi_q: Operations,
    /// Φ_t
    pub phi_t: Operations,
    /// γ
    pub gamma: Operations,
    /// Branch conditions.
    pub branch_values: Operations,
    /// Working ranges.
    pub limit_values: Operations,
    /// Rates that drives prescribe.
    pub phase_speeds: Operations,
    /// Reference metric of the coordinates.
    pub coordinate_scales: Operations,
    /// Reference metric of the rows.
    pub row_scales: Operations,
    /// The solution of Φ = 0, block after block.
    pub blocks: &'static [BlockWork],
}

/// What a diagonal block costs.
#[derive(Clone, Copy, Debug)]
pub struct BlockWork {
    /// Unknowns of Newton's method; 0 where the row gives its coordinate explicitly.
    pub unknowns: usize,
    /// Once, before its coordinates are known.
    pub before: Operations,
    /// Residual and Jacobian.
    pub evaluation: Operations,
}

/// A mechanism of which a step of bounded work has a known cost at most; emitted with [`Kinematic`](crate::Kinematic).
pub trait WorstCase {
    /// What its functions cost.
    const WORK: Work;

    /// Most operations of [`Stepper::step`](crate::Stepper::step) with [`Budget::DEFAULT`].
    const WORST_CASE_OPERATIONS: Operations = Budget::DEFAULT.worst_case_of(&Self::WORK);
    /// Most operations with Newton's method of [`Budget::DEFAULT`] alone.
    const WORST_CASE_OPERATIONS_WITHOUT_FALLBACK: Operations =
        Budget { fallback: 0, ..Budget::DEFAULT }.worst_case_of(&Self::WORK);
}

impl Budget {
    /// Six evaluations by Newton's method, and twelve trials of the fallback: from the prediction of a smooth
    /// motion two evaluations do, from half a radian away six.
    pub const DEFAULT: Self = Budget { newton: 6, fallback: 12 };

    /// Most operations that [`Stepper::step`](crate::Stepper::step) costs with this budget, on numbers of one lane.
    ///
    /// ```
    /// # use mbs_runtime::{Budget, Operations, WorstCase, mechanism};
    /// # mechanism! {
    /// #     mechanism Crank;
    /// #     coord phi: rad = 0.1;
    /// #     coord x: m = 0.1;
    /// #     constraint slide { x^2 + 0.1m*x == 0.02m^2*(2 + cos(phi)); }
    /// #     drive motor: phi == 3*t/1s;
    /// # }
    /// const MOST: Operations = Budget { newton: 3, fallback: 0 }.worst_case::<Crank<f64>>();
    /// assert!(MOST.within(Crank::<f64>::WORST_CASE_OPERATIONS));
    /// ```
    pub const fn worst_case<S: WorstCase>(self) -> Operations {
        self.worst_case_of(&S::WORK)
    }

    /// [`worst_case`](Self::worst_case) from the cost of the emitted functions.
    pub const fn worst_case_of(self, work: &Work) -> Operations {
        let n = work.coordinates as u64;
        // Time, its test, extent, correction.
        let frame = add(1).and(compare(2)).and(largest(n)).and(difference(n)).and(work.coordinate_scales);
        let mut total = frame.and(phases(work)).and(prediction(work)).and(state(work));
        let mut index = 0;
        while index < work.blocks.len() {
            total = total.and(self.block(&work.blocks[index]));
            index += 1;
        }
        total
    }

    /// One block by the solver of `step`.
    const fn block(self, block: &BlockWork) -> Operations {
        let k = block.unknowns as u64;
        if k == 0 {
            return block.before;
        }
        let newton = if self.newton == 0 { 1 } else { self.newton as u64 };
        let evaluation = block.evaluation.and(meets(k));
        let recorded = select(3).and(compare(2));
        let first = block
            .before
            .and(recorded)
            .and(evaluation.and(required(k)).times(newton))
            // Once more where the solution, for what the position stage keeps of it, was not the last point.
            .and(block.evaluation.and(compare(2 * k)))
            .and(newton_step(k).times(newton - 1))
            // Iterations that ask whether the residual has stalled.
            .and(
                outer_rounding(k)
                    .and(within(k))
                    .and(add(1))
                    .and(compare(1))
                    .times((newton - 1).saturating_sub(4)),
            )
            .and(worst(k));
        if self.fallback == 0 {
            return first;
        }
        let trials = self.fallback as u64;
        first
            .and(evaluation.and(normal_equations(k)).times(trials.saturating_add(1)))
            .and(trial(k).times(trials))
            .and(finite(k))
            .and(required(k))
            .and(outer_rounding(k))
            .and(within(k))
            .and(worst(k))
    }
}

const fn add(count: u64) -> Operations {
    Operations { additions: count, ..Operations::NONE }
}

const fn multiply(count: u64) -> Operations {
    Operations { multiplications: count, ..Operations::NONE }
}

const fn divide(count: u64) -> Operations {
    Operations { divisions: count, ..Operations::NONE }
}

const fn root(count: u64) -> Operations {
    Operations { functions: count, ..Operations::NONE }
}

const fn select(count: u64) -> Operations {
    Operations { selections: count, ..Operations::NONE }
}

const fn compare(count: u64) -> Operations {
    Operations { comparisons: count, ..Operations::NONE }
}

/// `count` products and sums.
const fn products(count: u64) -> Operations {
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
const fn largest(n: u64) -> Operations {
    divide(n).and(multiply(n)).and(select(2 * n))
}

/// `largest_difference` of n components.
const fn difference(n: u64) -> Operations {
    largest(n).and(add(n))
}

const fn finite(k: u64) -> Operations {
    compare(k + k * k)
}

const fn required(k: u64) -> Operations {
    products(k * k).and(select(k * k)).and(multiply(3 * k)).and(add(k))
}

const fn outer_rounding(k: u64) -> Operations {
    products(k * k).and(select(k * k)).and(multiply(3 * k))
}

const fn within(k: u64) -> Operations {
    add(k).and(select(k)).and(compare(k))
}

/// `Worst::of_block`.
const fn worst(k: u64) -> Operations {
    divide(k).and(select(6 * k)).and(compare(3 * k))
}

/// `Best::meets`.
const fn meets(k: u64) -> Operations {
    finite(k).and(required(k)).and(worst(k)).and(compare(1)).and(outer_rounding(k)).and(within(k))
}

/// `capped`, where the step is too long.
const fn capped(k: u64) -> Operations {
    select(2 * k + 1).and(compare(1)).and(divide(1)).and(multiply(k))
}

/// An iteration of `newton` without its evaluation, where the Jacobian is singular.
const fn newton_step(k: u64) -> Operations {
    let ratio = divide(k).and(select(2 * k)).and(compare(1));
    let fall = multiply(1).and(compare(2)).and(select(2)).and(add(1));
    let singular = multiply(1).and(compare(1)).and(add(k)).and(minimum_norm(k));
    finite(k)
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
const fn normal_equations(k: u64) -> Operations {
    let row = divide(1).and(multiply(1)).and(multiply(2 * k)).and(products(1 + k + k * k));
    row.times(k)
}

/// A trial without its evaluation and its normal equations.
const fn trial(k: u64) -> Operations {
    let stationary = products(k).and(add(k)).and(multiply(3)).and(compare(2));
    let replaced = select(2 * (k + k * k) + k + 1);
    let damping = multiply(2).and(select(2));
    required(k)
        .and(within(k))
        .and(stationary)
        .and(damped_step(k))
        .and(capped(k))
        .and(add(k))
        .and(select(k))
        .and(compare(1))
        .and(finite(k))
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

const fn in_metric(k: u64) -> Operations {
    divide(k).and(multiply(2 * k * k))
}

/// `mean_square` and `reciprocal_and_margin`.
const fn margin(k: u64) -> Operations {
    let square = if k > 1 { products(k * k).and(multiply(1)) } else { Operations::NONE };
    square.and(divide(2)).and(select(7)).and(compare(5))
}

/// `Direct1`, `Direct2`, `Direct3`, `Lu`: the factors with their margin.
const fn factorize(k: u64) -> Operations {
    match k {
        1 => in_metric(1).and(margin(1)),
        2 => in_metric(2).and(margin(2)).and(multiply(8)).and(add(4)),
        3 => in_metric(3)
            .and(margin(3))
            .and(multiply(4 * 6 + 2 * 3 + 1 + 9))
            .and(add(4 * 3 + 2 * 2))
            .and(root(1)),
        _ => {
            let swaps = select(2 * pairs(k)).and(compare(pairs(k))).and(select(pairs(k) * 2 * k));
            let pivot = select(6).and(compare(3)).and(divide(2)).times(k);
            let elimination = multiply(pairs(k)).and(products(updates(k)));
            in_metric(k).and(swaps).and(pivot).and(elimination).and(divide(1 + k)).and(select(3))
        }
    }
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
        in_metric(k).and(divide(k)).and(multiply(k)).and(products(3 * k * k)).and(multiply(k * k));
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

// The instant: `kinematics`, `stepper`, `path`, `limit`, `phase`.

/// `Kinematic::factorize`: Φ_q, each block with its margin and the sign of its determinant.
const fn factors(work: &Work) -> Operations {
    let mut total = work.phi_q;
    let mut index = 0;
    while index < work.blocks.len() {
        let k = work.blocks[index].unknowns as u64;
        if k > 0 {
            let signs = if k > 3 { k } else { 1 };
            total = total.and(factorize(k)).and(compare(1 + signs)).and(select(1));
        }
        index += 1;
    }
    total
}

/// `Kinematic::solve_linear`, as if every entry stood off the diagonal blocks.
const fn linear(work: &Work) -> Operations {
    let mut total = products(work.entries as u64).and(add(work.rows as u64)).and(divide(work.rows as u64));
    let mut index = 0;
    while index < work.blocks.len() {
        let k = work.blocks[index].unknowns as u64;
        if k > 0 {
            total = total.and(solve(k));
        }
        index += 1;
    }
    total
}

/// `solve_rates` from a right-hand side that changes its sign.
const fn rates(work: &Work) -> Operations {
    linear(work).and(add(work.rows as u64)).and(compare(work.coordinates as u64))
}

/// `displaced`
const fn displaced(work: &Work) -> Operations {
    let n = work.coordinates as u64;
    work.coordinate_scales.and(select(n)).and(multiply(n)).and(compare(n)).and(add(2 * n))
}

/// The larger of `extrapolated` with a repair and `Way::predicted`.
const fn prediction(work: &Work) -> Operations {
    let (n, m) = (work.coordinates as u64, work.rows as u64);
    let extrapolated = add(1 + n).and(multiply(2 + 2 * n));
    let way = work
        .position
        .and(factors(work))
        .and(work.phi)
        .and(add(m))
        .and(linear(work).times(2))
        .and(work.gamma.times(3))
        .and(add(n + 2 * m))
        .and(multiply(2 * m));
    extrapolated.or(way).and(displaced(work)).and(compare(1 + n))
}

/// `State::at`
const fn state(work: &Work) -> Operations {
    let (n, m) = (work.coordinates as u64, work.rows as u64);
    let (branches, limits) = (work.branches as u64, work.limits as u64);
    let placed = work.position.and(factors(work)).and(multiply(2)).and(compare(3));
    let resolved = work.coordinate_scales.and(select(n)).and(multiply(2 * n)).and(compare(3 * n));
    let correction = work.phi.and(rates(work));
    // A position that closes is polished in the singular zone, one that does not gets the step that it lacks.
    let polished = work
        .row_scales
        .and(correction)
        .and(work.phi.and(difference(m)).times(2))
        .and(add(n))
        .and(compare(1))
        .and(placed);
    let repaired = correction.and(difference(n)).and(multiply(1)).and(compare(1));
    let branched = work.branch_values.and(compare(2 * branches));
    let ranges = work
        .limit_values
        .and(select(3 * limits))
        .and(multiply(2 * limits))
        .and(add(2 * limits))
        .and(compare(3 * limits));
    let moved = work.phi_t.and(work.gamma).and(rates(work).times(2));
    let margins = add(2).and(divide(1)).and(compare(2));
    // What a report of a failure looks up.
    let reported = multiply(1).and(root(1)).and(compare(n + m));
    placed
        .and(resolved)
        .and(polished.or(repaired))
        .and(branched)
        .and(ranges)
        .and(moved)
        .and(margins)
        .and(reported)
}

/// `Mechanism::advance_phases`: rates at four times, inputs moved to three of them, sums compensated.
const fn phases(work: &Work) -> Operations {
    if work.phases == 0 {
        return Operations::NONE;
    }
    let quadrature = add(5).and(multiply(6));
    let moved = add(3).and(multiply(4)).times(3 * work.inputs as u64);
    let integral = add(3).and(multiply(4));
    let advanced = add(7).and(multiply(1)).and(select(3)).and(compare(1));
    work.phase_speeds
        .times(4)
        .and(quadrature)
        .and(moved)
        .and(integral.and(advanced).times(work.phases as u64))
}

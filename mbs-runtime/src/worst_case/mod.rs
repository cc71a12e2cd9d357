//! Largest operation count of a step of bounded work: emitted counts, and those of the runtime's kernels.
//!
//! The counts of the kernels follow their sources line by line, each from the code that it names. Where a count
//! depends on the numbers, the more expensive branch is taken. A test counts the operations of real steps.

pub(crate) mod kernels;
pub(crate) mod work;

use crate::block_solvers::budget::Budget;
use crate::mechanism::operations::Operations;
use crate::worst_case::kernels::{
    add, compare, difference, divide, finite, gauss_newton_step, largest, meets, multiply, newton_step,
    normal_equations, outer_rounding, products, required, root, select, trial, within, worst,
};
use crate::worst_case::work::{BlockWork, Work};

/// A mechanism whose step of bounded work has a known largest cost; emitted with [`Kinematic`](crate::Kinematic).
pub trait WorstCase {
    /// Operation counts of its functions.
    const WORK: Work;

    /// Most operations of [`Stepper::step`](crate::Stepper::step) with [`Budget::DEFAULT`].
    const WORST_CASE_OPERATIONS: Operations = Budget::DEFAULT.worst_case_of(&Self::WORK);
    /// Most operations with Newton's method of [`Budget::DEFAULT`] alone.
    const WORST_CASE_OPERATIONS_WITHOUT_FALLBACK: Operations =
        Budget { fallback: 0, ..Budget::DEFAULT }.worst_case_of(&Self::WORK);
}

impl Budget {
    /// Six evaluations by Newton's method, and twelve trials of the fallback. From the prediction of a smooth
    /// motion two evaluations are enough, from half a radian away six.
    pub const DEFAULT: Self = Budget { newton: 6, fallback: 12 };

    /// Most operations that [`Stepper::step`](crate::Stepper::step) costs with this budget, on numbers of one lane.
    ///
    /// ```
    /// # use mbs_runtime::{Budget, Operations, WorstCase, mechanism};
    /// # mechanism! {
    /// #     mechanism Crank;
    /// #     coord phi: rad = 0.1;
    /// #     coord x: m = 0.1;
    /// #     constraint slide { x^2 + 0.1m*x == (0.02m)^2*(2 + cos(phi)); }
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
        let frame = frame.and(phases(work)).and(prediction(work)).and(state(work)).and(settled(work));
        // The homotopy has what the first solution leaves of the budget. More of one is less of the other, in straight pieces: the most
        // is where one of them begins or ends.
        let all = self.evaluations();
        let newton = if self.newton == 0 { 1 } else { self.newton };
        let ends = self.solution(work).or(self.followed_after(1, work));
        frame.and(ends.or(self.followed_after(newton, work)).or(way(work, all)))
    }

    /// A solution in so many evaluations, then the homotopy in the rest.
    const fn followed_after(self, evaluations: u32, work: &Work) -> Operations {
        let left = self.evaluations().saturating_sub(evaluations);
        Budget { newton: evaluations, fallback: 0 }.solution(work).and(way(work, left))
    }

    /// The blocks by the solver of `step`.
    const fn solution(self, work: &Work) -> Operations {
        let mut total = Operations::NONE;
        let mut rest = work.blocks;
        while let [block, others @ ..] = rest {
            total = total.and(self.block(block).times(block.count as u64));
            rest = others;
        }
        total
    }

    /// One block by the solver of `step`.
    const fn block(self, block: &BlockWork) -> Operations {
        let (m, k) = (block.rows as u64, block.unknowns as u64);
        if k == 0 {
            return block.before;
        }
        let newton = if self.newton == 0 { 1 } else { self.newton as u64 };
        let evaluation = block.evaluation.and(meets(m, k));
        let recorded = select(3).and(compare(2));
        let steps = if m > k {
            gauss_newton_step(m, k)
        } else {
            newton_step(k).and(block.order()).and(block.solve())
        };
        let first = block
            .before
            .and(recorded)
            .and(evaluation.and(required(m, k)).times(newton))
            // Once more where the solution, for what the position stage keeps of it, was not the last point.
            .and(block.evaluation.and(compare(2 * k)))
            .and(steps.times(newton - 1))
            // What the least residual of surplus rows may be.
            .and(if m > k { widths(m) } else { Operations::NONE })
            // Iterations that ask whether the residual has stalled.
            .and(
                outer_rounding(m, k)
                    .and(within(m))
                    .and(add(1))
                    .and(compare(1))
                    .times((newton - 1).saturating_sub(4)),
            )
            .and(worst(m));
        if self.fallback == 0 {
            return first;
        }
        let trials = self.fallback as u64;
        first
            .and(evaluation.and(normal_equations(m, k)).times(trials.saturating_add(1)))
            .and(trial(m, k).times(trials))
            .and(finite(m, k))
            .and(required(m, k))
            .and(outer_rounding(m, k))
            .and(within(m))
            .and(worst(m))
    }
}

// The instant: `kinematics`, `stepper`, `path`, `limit`, `phase`, `redundancy`.

/// `Widths::granted`, added to allowances and tolerances.
const fn widths(m: u64) -> Operations {
    largest_width(m)
        .and(multiply(2 * m + 3))
        .and(select(2 * m))
        .and(compare(m))
        .and(select(1))
        .and(add(2 * m))
}

/// `largest_width`
const fn largest_width(m: u64) -> Operations {
    divide(m).and(select(m))
}

/// `true` if some rows may follow from others.
const fn has_surplus(work: &Work) -> bool {
    work.rows > work.coordinates
}

/// `Kinematic::factorize`: Φ_q, each block with its margin and the sign of its determinant.
const fn factors(work: &Work) -> Operations {
    let mut total = work.phi_q;
    let mut rest = work.blocks;
    while let [block, others @ ..] = rest {
        let k = block.unknowns as u64;
        if k > 0 {
            let signs = if k > 3 { k } else { 1 };
            // Rows that yield have factors of their own beside those of the margin.
            let times = if block.rows > block.unknowns { 2 } else { 1 };
            let factors = block.factorize().times(times).and(compare(1 + signs)).and(select(1));
            total = total.and(factors.times(block.count as u64));
        }
        rest = others;
    }
    total
}

/// `Kinematic::solve_linear`, as if every entry were off the diagonal blocks.
const fn linear(work: &Work) -> Operations {
    let mut total = products(work.entries as u64).and(add(work.rows as u64)).and(divide(work.rows as u64));
    let mut rest = work.blocks;
    while let [block, others @ ..] = rest {
        if block.unknowns > 0 {
            total = total.and(block.solve().times(block.count as u64));
        }
        rest = others;
    }
    total
}

/// `solve_rates` from a right-hand side that changes its sign.
const fn rates(work: &Work) -> Operations {
    linear(work).and(add(work.rows as u64)).and(compare(work.coordinates as u64))
}

/// `Stepper::predicted` with a repair, and how certain it is.
const fn prediction(work: &Work) -> Operations {
    let n = work.coordinates as u64;
    work.coordinate_scales
        .and(add(1 + 3 * n))
        .and(multiply(4 + 2 * n))
        .and(difference(n).times(2))
        .and(select(2 * n + 8))
        .and(compare(8))
}

/// `Walk::station`
const fn station(work: &Work) -> Operations {
    let (variables, m) = (work.variables as u64, work.rows as u64);
    add(3 + 2 * variables + m).and(multiply(1 + variables + m)).and(compare(2)).and(work.parameters)
}

/// `Walk::residuals` at a station.
const fn residuals(work: &Work) -> Operations {
    work.position.and(work.phi).and(add(work.rows as u64))
}

/// `combined`, with its weights.
const fn combined(work: &Work) -> Operations {
    let m = work.rows as u64;
    multiply(4 * m).and(add(4 * m)).and(divide(4)).and(multiply(4))
}

/// `Walk::size`
const fn size(work: &Work) -> Operations {
    let n = work.coordinates as u64;
    work.parameters.and(work.coordinate_scales).and(difference(n)).and(add(n))
}

/// `Walk::slope`
const fn slope(work: &Work) -> Operations {
    let points = station(work).and(residuals(work)).times(3);
    points.and(combined(work)).and(linear(work)).and(multiply(4)).and(add(2))
}

/// `Walk::spot`, and its tests.
const fn spot(work: &Work) -> Operations {
    let placed = station(work).and(residuals(work)).and(factors(work)).and(slope(work));
    placed.and(size(work).times(3)).and(add(work.coordinates as u64))
}

/// Movements of points, and the tests by them.
const fn measured(work: &Work) -> Operations {
    let n = work.coordinates as u64;
    work.parameters
        .and(work.coordinate_scales)
        .and(add(8 * n))
        .and(multiply(14 * n + 8))
        .and(divide(8 * n + 4))
        .and(select(6 * n + 4))
        .and(compare(12 * n))
}

/// `Stepper::settles`: the tangent of the way, and movements measured by it.
const fn settled(work: &Work) -> Operations {
    let tangent = station(work).and(residuals(work)).and(spot(work)).and(slope(work));
    let ends = work.coordinate_scales.and(difference(work.coordinates as u64).times(2));
    tangent.and(ends).and(measured(work).times(2))
}

/// `Way::followed` in at most `evaluations`, the position and the rates at its end.
const fn way(work: &Work, evaluations: u32) -> Operations {
    let end = crate::stepper::homotopy_step::FINAL;
    if evaluations < crate::kinematics::homotopy::LEAST_EVALUATIONS + end.newton {
        return Operations::NONE;
    }
    let bounded = (evaluations - end.newton) as u64;
    let (n, m) = (work.coordinates as u64, work.rows as u64);
    let (station, residuals, size) = (station(work), residuals(work), size(work));
    let (combined, slope, measured) = (combined(work), slope(work), measured(work));
    // Of a spot, the halves of a forecast and a correction none costs more than this; each is one evaluation, of the five that a piece is
    // made of at least.
    let forecast = slope
        .and(residuals.and(multiply(n)).and(add(n)).times(3))
        .and(combined)
        .and(linear(work))
        .and(add(3 * n))
        .and(multiply(3 * n))
        .and(size.times(2));
    let beyond_parabola = residuals
        .and(multiply(2 * n))
        .and(add(2 * n))
        .times(3)
        .and(combined)
        .and(linear(work))
        .times(2)
        .and(add(5 * n))
        .and(multiply(2 * n))
        .and(divide(1))
        .and(size);
    let spot = spot(work);
    let correction = station
        .and(residuals)
        .and(factors(work))
        .and(linear(work))
        .and(work.coordinate_scales)
        .and(add(n))
        .and(difference(n).times(2));
    let decided = compare(40).and(multiply(40)).and(divide(8)).and(root(12)).and(add(20));
    let most = forecast.or(beyond_parabola).or(spot).or(correction).and(decided).and(measured);
    let end = end.solution(work).and(state(work)).and(difference(n)).and(work.coordinate_scales);
    // Beside them: where the way begins, and the row that jumps.
    most.times(bounded)
        .and(spot)
        .and(slope)
        .and(measured)
        .and(station.and(residuals).and(difference(m)).times(4))
        .and(end)
}

/// `StepperState::at`
const fn state(work: &Work) -> Operations {
    let (n, m) = (work.coordinates as u64, work.rows as u64);
    let (branches, limits) = (work.branches as u64, work.limits as u64);
    let placed = work.position.and(factors(work)).and(multiply(4)).and(compare(5));
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
    let surplus = if has_surplus(work) { contradicted(work) } else { Operations::NONE };
    placed
        .and(surplus)
        .and(resolved)
        .and(polished.or(repaired))
        .and(branched)
        .and(ranges)
        .and(moved)
        .and(margins)
        .and(reported)
}

/// `disagreement` of velocities and accelerations, and `holding` where the position is at fault.
const fn contradicted(work: &Work) -> Operations {
    let (n, m) = (work.coordinates as u64, work.rows as u64);
    let scales = work.row_scales.and(work.coordinate_scales);
    let open = work.phi_q.and(products(n * m)).and(add(m)).and(divide(m)).and(select(m));
    let size = divide(n + m).and(select(2 * (n + m)));
    let allowed = divide(1 + 2 * m).and(multiply(1 + 5 * m)).and(add(m)).and(root(1)).and(compare(1 + m));
    let rates = scales.and(open).and(size).and(allowed).times(2);
    let right = work.phi_t.and(work.gamma).and(add(m)).and(multiply(1));
    let held = work.position.and(work.phi).and(work.row_scales).and(divide(m)).and(select(m));
    work.coordinate_scales
        .and(difference(n))
        .and(widths(m))
        .and(divide(m))
        .and(right)
        .and(rates)
        .and(held)
        .and(work.row_scales)
        .and(largest_width(m))
}

/// `Mechanism::advance_phases`: rates at four times, inputs moved to three of them, products and sums compensated.
const fn phases(work: &Work) -> Operations {
    if work.phases == 0 {
        return Operations::NONE;
    }
    let quadrature = add(5).and(multiply(6));
    let moved = add(3).and(multiply(4)).times(3 * work.inputs as u64);
    let mean = add(3).and(multiply(1));
    let increment = add(13).and(multiply(8));
    let advanced = add(13).and(multiply(1)).and(select(3)).and(compare(1));
    // The rest of the time that its rounding leaves out: the clock with its sum, and each phase moved on by it.
    let left_out = multiply(1).and(select(1)).and(compare(1));
    let clock = left_out.times(3).and(add(14)).and(compare(1));
    let rest = left_out.and(add(13)).and(multiply(1));
    work.phase_speeds
        .times(4)
        .and(clock)
        .and(rest.times(work.phases as u64))
        .and(quadrature)
        .and(moved)
        .and(mean.and(increment).and(advanced).times(work.phases as u64))
}

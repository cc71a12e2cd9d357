//! Extrapolated midpoint steps on the accelerations: Gragg 1965; Hairer, Nørsett & Wanner I, II.9.

use mbs_runtime::Scalar;

use super::motion::{Aim, Solved, StepMethod, Tried, accelerations};
use crate::double_double::DoubleDouble as D;
use crate::erased::exact::{ExactEquations, Moving};

/// Columns of the extrapolation: order 2 × 10.
const COLUMNS: usize = 10;

/// Column up to which a step is better made longer.
const EARLY: usize = 6;

/// Explicit steps of high order.
pub struct Extrapolated;

/// Rates of a state.
struct Rates {
    qd: Vec<D>,
    qdd: Vec<D>,
    states: Vec<D>,
}

fn rates(equations: &dyn ExactEquations, at: &Moving, lambda: &mut Vec<D>) -> Option<Rates> {
    let Solved { qdd, lambda: found, state_rates } = accelerations(equations, at, lambda)?;
    *lambda = found;
    Some(Rates { qd: at.qd.clone(), qdd, states: state_rates })
}

fn moved(from: &Moving, h: D, rates: &Rates, t: D) -> Moving {
    let along = |values: &[D], rates: &[D]| -> Vec<D> {
        values.iter().zip(rates).map(|(value, rate)| *value + h * *rate).collect()
    };
    Moving {
        t,
        q: along(&from.q, &rates.qd),
        qd: along(&from.qd, &rates.qdd),
        states: along(&from.states, &rates.states),
    }
}

/// `count` midpoint steps.
fn midpoint(
    equations: &dyn ExactEquations,
    from: &Moving,
    first: &Rates,
    lambda: &[D],
    h: D,
    count: usize,
) -> Option<Moving> {
    let part = h / D::constant(count as f64);
    let time = |k: usize| from.t + part * D::constant(k as f64);
    let mut lambda = lambda.to_vec();
    let mut before = from.clone();
    let mut now = moved(from, part, first, time(1));
    for k in 1..count {
        let rates = rates(equations, &now, &mut lambda)?;
        let next = moved(&before, part.scaled(2.0), &rates, time(k + 1));
        before = core::mem::replace(&mut now, next);
    }
    Some(Moving { t: from.t + h, ..now })
}

/// The Aitken–Neville step: `fine` + (`fine` − `coarse`)/(r² − 1) with r the ratio of the numbers of steps.
fn extrapolated(fine: &Moving, coarse: &Moving, divisor: D) -> Moving {
    let of = |fine: &[D], coarse: &[D]| -> Vec<D> {
        fine.iter().zip(coarse).map(|(fine, coarse)| *fine + (*fine - *coarse) / divisor).collect()
    };
    Moving {
        t: fine.t,
        q: of(&fine.q, &coarse.q),
        qd: of(&fine.qd, &coarse.qd),
        states: of(&fine.states, &coarse.states),
    }
}

impl StepMethod for Extrapolated {
    fn step(
        &mut self,
        equations: &dyn ExactEquations,
        from: &Moving,
        solved: &Solved,
        h: D,
        aim: &Aim,
    ) -> Option<Tried> {
        let first =
            Rates { qd: from.qd.clone(), qdd: solved.qdd.clone(), states: solved.state_rates.clone() };
        let mut row: Vec<Moving> = Vec::new();
        let mut last = f64::INFINITY;
        for column in 0..COLUMNS {
            let count = 2 * (column + 1);
            let mut next = vec![midpoint(equations, from, &first, &solved.lambda, h, count)?];
            for (k, coarse) in row.iter().enumerate() {
                let ratio = D::constant(count as f64) / D::constant((2 * (column - k)) as f64);
                let divisor = ratio * ratio - D::constant(1.0);
                next.push(extrapolated(&next[k], coarse, divisor));
            }
            if column > 1 {
                let error = aim.difference(&next[column], &next[column - 1]);
                if error <= aim.tolerance {
                    let growth = if column <= EARLY { 1.6 } else { 1.0 };
                    return Some(Tried { end: next.swap_remove(column), error, growth });
                }
                // Columns that no longer gain do not reach the tolerance.
                if error > last && column > EARLY || error.is_nan() {
                    return None;
                }
                last = error;
            }
            row = next;
        }
        None
    }

    fn restart(&mut self) {}

    fn accept(&mut self) {}
}

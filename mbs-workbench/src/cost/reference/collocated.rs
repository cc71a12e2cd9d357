//! Collocation at Radau's points on Φ_q q̇ + Φ_t = 0: Radau IIA on the form of index 2, without γ.
//!
//! Source: Hairer & Wanner II, IV.5 and VII.4. Positions are put back onto Φ = 0 after each step.

use mbs_runtime::Scalar;

use super::linear::{LuFactors, Matrix};
use super::motion::{Aim, Solved, StepMethod, Tried};
use crate::double_double::DoubleDouble as D;
use crate::erased::exact::{ExactEquations, Moving};

/// Stages: order 9.
const STAGES: usize = 5;

/// Iterations of a step.
const ITERATIONS: usize = 60;

/// Share of the tolerance to which a step is iterated.
const SHARE: f64 = 1e-3;

/// Radau IIA in double-double numbers.
pub struct Collocated {
    nodes: Vec<D>,
    /// ∫₀^cᵢ of the j-th Lagrange polynomial: rows of the Butcher matrix.
    weights: Vec<Vec<D>>,
    inverse: Vec<Vec<D>>,
    last: Option<CollocationStages>,
    tried: Option<CollocationStages>,
}

/// Values at the stages of a step.
#[derive(Clone)]
struct CollocationStages {
    h: D,
    qdd: Vec<Vec<D>>,
    lambda: Vec<Vec<D>>,
    states: Vec<Vec<D>>,
}

impl Default for Collocated {
    fn default() -> Self {
        let nodes = radau_nodes(STAGES);
        let weights: Vec<Vec<D>> = nodes.iter().map(|node| integrals(&nodes, *node)).collect();
        let inverse = inverse(&weights);
        Collocated { nodes, weights, inverse, last: None, tried: None }
    }
}

impl Collocated {
    /// The polynomial through stages of the last step, at the stages of the next one of `h` (s).
    fn predicted(&self, last: &CollocationStages, values: &[Vec<D>], h: D) -> Vec<Vec<D>> {
        let ratio = h / last.h;
        let at = |node: &D| {
            let x = D::constant(1.0) + *node * ratio;
            let weights = lagrange(&self.nodes, x);
            combination(values, &weights)
        };
        self.nodes.iter().map(at).collect()
    }
}

/// Σ wⱼ vⱼ.
fn combination(values: &[Vec<D>], weights: &[D]) -> Vec<D> {
    let size = values.first().map_or(0, Vec::len);
    let mut sum = vec![D::constant(0.0); size];
    for (value, weight) in values.iter().zip(weights) {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum = *sum + *weight * *value;
        }
    }
    sum
}

fn along(from: &[D], h: D, rates: &[D]) -> Vec<D> {
    from.iter().zip(rates).map(|(from, rate)| *from + h * *rate).collect()
}

impl StepMethod for Collocated {
    fn step(
        &mut self,
        equations: &dyn ExactEquations,
        from: &Moving,
        solved: &Solved,
        h: D,
        aim: &Aim,
    ) -> Option<Tried> {
        let (n, m) = (from.q.len(), solved.lambda.len());
        let constant = |values: &[D]| vec![values.to_vec(); STAGES];
        let mut stages = match &self.last {
            Some(last) => CollocationStages {
                h,
                qdd: self.predicted(last, &last.qdd, h),
                lambda: self.predicted(last, &last.lambda, h),
                states: self.predicted(last, &last.states, h),
            },
            None => CollocationStages {
                h,
                qdd: constant(&solved.qdd),
                lambda: constant(&solved.lambda),
                states: constant(&solved.state_rates),
            },
        };
        let mut factors: Vec<LuFactors> = Vec::new();
        let mut last = f64::INFINITY;
        let mut end = None;
        for iteration in 0..ITERATIONS {
            let at = self.places(from, &stages, h);
            let mut open = Vec::new();
            let mut right = Vec::new();
            let mut matrices = Vec::new();
            for (stage, at) in at.iter().enumerate() {
                let rows = equations.rows(at);
                let terms = equations.terms(at, &stages.lambda[stage]);
                let mut rest = terms.force.clone();
                for (i, rest) in rest.iter_mut().enumerate() {
                    for j in 0..n {
                        *rest = *rest - terms.mass[i * n + j] * stages.qdd[stage][j];
                    }
                    for j in 0..m {
                        *rest = *rest - rows.phi_q[j * n + i] * stages.lambda[stage][j];
                    }
                }
                if iteration == 0 || iteration == 4 {
                    let column = |i: usize, j: usize| {
                        let plain = rows.phi_q[j * n + i];
                        terms.force_lambda.as_ref().map_or(plain, |slope| plain - slope[i * m + j])
                    };
                    matrices.push(Matrix::saddle(n, m, &terms.mass, column, &rows.phi_q).factors());
                }
                stages.states[stage] = terms.state_rates;
                open.push(rows.rate);
                right.push(rest);
            }
            if !matrices.is_empty() {
                factors = matrices;
            }
            let mut change = 0.0_f64;
            for stage in 0..STAGES {
                let rate = combination(&open, &self.inverse[stage]);
                let mut b = right[stage].clone();
                b.extend(rate.iter().map(|rate| -(*rate / h)));
                let correction = factors[stage].solve(&b);
                for (j, correction) in correction.into_iter().enumerate() {
                    let place =
                        if j < n { &mut stages.qdd[stage][j] } else { &mut stages.lambda[stage][j - n] };
                    *place = *place + D::constant(correction);
                    if j < n {
                        change = change.max((correction * h.high).abs() / (aim.scales[j] * aim.rate));
                    }
                    if correction.is_nan() {
                        return None;
                    }
                }
            }
            if change <= SHARE * aim.tolerance {
                end = self.places(from, &stages, h).pop();
                break;
            }
            if iteration > 8 && change > 0.7 * last {
                return None;
            }
            last = change;
        }
        let end = Moving { t: from.t + h, ..end? };
        let error = self.error(&stages, h, aim);
        let wanted = 0.02 * aim.tolerance / error.max(1e-300);
        let growth = wanted.powf(1.0 / (2 * STAGES) as f64).clamp(0.3, 2.0);
        self.tried = Some(stages);
        Some(Tried { end, error, growth })
    }

    fn restart(&mut self) {
        (self.last, self.tried) = (None, None);
    }

    fn accept(&mut self) {
        self.last = self.tried.take();
    }
}

impl Collocated {
    /// States at the stages.
    fn places(&self, from: &Moving, stages: &CollocationStages, h: D) -> Vec<Moving> {
        let qd: Vec<Vec<D>> = self
            .weights
            .iter()
            .map(|weights| along(&from.qd, h, &combination(&stages.qdd, weights)))
            .collect();
        let place = |(weights, (node, speed)): (&Vec<D>, (&D, &Vec<D>))| Moving {
            t: from.t + h * *node,
            q: along(&from.q, h, &combination(&qd, weights)),
            qd: speed.clone(),
            states: along(&from.states, h, &combination(&stages.states, weights)),
        };
        self.weights.iter().zip(self.nodes.iter().zip(&qd)).map(place).collect()
    }

    /// Error of the end from the decay of the coefficients of the stages' polynomial: a polynomial of degree s − 1 whose last
    /// coefficient is a part ρ^(s−1) of the largest leaves ρ^(2s−1) at the end of the step.
    fn error(&self, stages: &CollocationStages, h: D, aim: &Aim) -> f64 {
        let count = self.nodes.len();
        let highest: Vec<D> = (0..count)
            .map(|j| {
                let others = (0..count).filter(|i| *i != j);
                let product =
                    others.fold(D::constant(1.0), |product, i| product * (self.nodes[j] - self.nodes[i]));
                D::constant(1.0) / product
            })
            .collect();
        // x^(s−1) in Legendre polynomials of [0, 1] has the last coefficient (s−1)!²/(2s−2)!.
        let legendre = (1..count).map(|k| k as f64 / (count + k - 1) as f64).product::<f64>();
        let part = |values: &[Vec<D>], unit: &dyn Fn(usize) -> f64| {
            let top = combination(values, &highest);
            let mut worst = 0.0_f64;
            for (j, top) in top.iter().enumerate() {
                let unit = h.high / unit(j);
                let top = top.high.abs() * legendre * unit;
                let largest = values.iter().map(|value| value[j].high.abs()).fold(0.0, f64::max) * unit;
                if largest > 0.0 && top > 0.0 {
                    let ratio = (top / largest).min(1.0);
                    let power = (2 * count - 1) as f64 / (count - 1) as f64;
                    worst = worst.max(largest * ratio.powf(power));
                }
            }
            worst
        };
        let speeds = part(&stages.qdd, &|j| aim.scales[j] * aim.rate);
        let states = part(&stages.states, &|j| aim.states[j]);
        speeds.max(states)
    }
}

/// Values at `x` of the Lagrange polynomials of `nodes`.
fn lagrange(nodes: &[D], x: D) -> Vec<D> {
    let value = |j: usize| {
        let others = nodes.iter().enumerate().filter(|(i, _)| *i != j);
        others.fold(D::constant(1.0), |product, (_, node)| product * (x - *node) / (nodes[j] - *node))
    };
    (0..nodes.len()).map(value).collect()
}

/// Integrals from 0 to `x` of the Lagrange polynomials of `nodes`.
fn integrals(nodes: &[D], x: D) -> Vec<D> {
    let integral = |j: usize| {
        // Coefficients of Π (x − cᵢ)/(cⱼ − cᵢ), lowest first.
        let mut coefficients = vec![D::constant(1.0)];
        for (i, node) in nodes.iter().enumerate().filter(|(i, _)| *i != j) {
            let divisor = nodes[j] - nodes[i];
            let mut next = vec![D::constant(0.0); coefficients.len() + 1];
            for (k, coefficient) in coefficients.iter().enumerate() {
                next[k] = next[k] - *coefficient * *node / divisor;
                next[k + 1] = next[k + 1] + *coefficient / divisor;
            }
            coefficients = next;
        }
        let terms = coefficients.iter().enumerate().rev();
        terms.fold(D::constant(0.0), |sum, (k, c)| sum * x + *c / D::constant((k + 1) as f64)) * x
    };
    (0..nodes.len()).map(integral).collect()
}

/// Radau's points in (0, 1]: zeros of Pₛ − Pₛ₋₁ of Legendre's polynomials over [0, 1].
fn radau_nodes(count: usize) -> Vec<D> {
    let value = |x: D| {
        let y = x.scaled(2.0) - D::constant(1.0);
        let (mut before, mut now) = (D::constant(1.0), y);
        for k in 1..count {
            let k = k as f64;
            let next =
                (D::constant(2.0 * k + 1.0) * y * now - D::constant(k) * before) / D::constant(k + 1.0);
            (before, now) = (now, next);
        }
        now - before
    };
    // The last one is 1; the others are between signs on a fine grid.
    const GRID: usize = 400;
    let mut nodes = Vec::new();
    for k in 0..GRID - 1 {
        let [mut low, mut high] = [k, k + 1].map(|k| D::constant(k as f64 / GRID as f64));
        let sign = value(low).high;
        if sign * value(high).high > 0.0 {
            continue;
        }
        for _ in 0..110 {
            let middle = (low + high).scaled(0.5);
            if sign * value(middle).high > 0.0 { low = middle } else { high = middle }
        }
        nodes.push((low + high).scaled(0.5));
    }
    nodes.push(D::constant(1.0));
    nodes
}

/// The inverse of a small regular matrix by elimination with pivots.
fn inverse(matrix: &[Vec<D>]) -> Vec<Vec<D>> {
    let size = matrix.len();
    let unit = |i: usize| (0..size).map(move |j| D::constant(f64::from(u8::from(i == j))));
    let mut rows: Vec<Vec<D>> =
        matrix.iter().enumerate().map(|(i, row)| row.iter().copied().chain(unit(i)).collect()).collect();
    for k in 0..size {
        let best = (k..size).max_by(|a, b| rows[*a][k].high.abs().total_cmp(&rows[*b][k].high.abs()));
        rows.swap(k, best.unwrap_or(k));
        let pivot = rows[k][k];
        rows[k].iter_mut().for_each(|entry| *entry = *entry / pivot);
        let row = rows[k].clone();
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[k];
            if i != k {
                other.iter_mut().zip(&row).for_each(|(entry, row)| *entry = *entry - factor * *row);
            }
        }
    }
    rows.into_iter().map(|row| row[size..].to_vec()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_integrate_polynomials_and_invert() {
        let method = Collocated::default();
        assert_eq!(method.nodes.len(), STAGES);
        // The last row integrates x^k over [0, 1] for k < 2s − 1.
        for k in 0..2 * STAGES - 1 {
            let sum = method.nodes.iter().zip(&method.weights[STAGES - 1]).fold(
                D::constant(0.0),
                |sum, (node, weight)| {
                    let power = (0..k).fold(D::constant(1.0), |power, _| power * *node);
                    sum + *weight * power
                },
            );
            let exact = D::constant(1.0) / D::constant((k + 1) as f64);
            assert!((sum - exact).high.abs() < 1e-28, "{k}: {sum:?}");
        }
        for i in 0..STAGES {
            let product = combination(&method.inverse, &method.weights[i]);
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            assert!(
                product
                    .iter()
                    .enumerate()
                    .all(|(j, entry)| (*entry - D::constant(unit(j))).high.abs() < 1e-27)
            );
        }
    }
}

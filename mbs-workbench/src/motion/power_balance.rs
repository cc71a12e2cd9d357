//! Power balance of a motion: powers of forces, drives, constraints and the time, with their works.

use serde::Serialize;

/// Source of a power.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PowerSource {
    /// A force of the text that is neither gravity nor a potential.
    Force,
    /// A row of a `drive`: λ Φ_t, its effort times the speed that it prescribes.
    Drive,
    /// A row of a `constraint` that depends on the time: λ Φ_t.
    Constraint,
    /// The time itself, where it carries masses along or changes a potential.
    Time,
}

/// A power over the time, positive where it feeds the mechanism.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PowerCurve {
    /// Name of the force or of the row.
    pub name: &'static str,
    /// Source of the power.
    pub by: PowerSource,
    /// Power (W).
    pub power: Vec<f64>,
    /// Work since the first instant (J): of a motion from forces integrated along its steps, else by [`works`].
    pub work: Vec<f64>,
}

impl PowerCurve {
    /// No instant yet.
    pub fn of(name: &'static str, by: PowerSource) -> Self {
        PowerCurve { name, by, power: Vec::new(), work: Vec::new() }
    }

    /// Name with the source, as headings show it: `drive crank`.
    pub fn title(&self) -> String {
        match self.by {
            PowerSource::Force => format!("force {}", self.name),
            PowerSource::Drive => format!("drive {}", self.name),
            PowerSource::Constraint => format!("constraint {}", self.name),
            PowerSource::Time => self.name.to_string(),
        }
    }

    /// `true` if it may be left out of a list: a row that supplies no power, or a time that changes nothing.
    pub fn is_idle(&self) -> bool {
        let is_zero = |curve: &[f64]| curve.iter().all(|value| *value == 0.0);
        self.by != PowerSource::Force && is_zero(&self.power) && is_zero(&self.work)
    }

    /// Work over the whole motion (J).
    pub fn total(&self) -> f64 {
        self.work.last().copied().unwrap_or(0.0)
    }
}

/// Integral of `power` (W) over `time` (s) from the first instant to each: J.
///
/// Between two instants the integrand is the polynomial of fifth degree through these and two neighbours at either side. The
/// error falls with the sixth power of the distance of the instants; across a jump of the power with the distance alone.
pub fn works(time: &[f64], power: &[f64]) -> Vec<f64> {
    /// Number of neighbours before the first of two instants, and of all nodes of the polynomial.
    const BEFORE: usize = 2;
    const NODES: usize = 6;
    let mut sum = 0.0;
    let mut works: Vec<f64> = power.iter().take(1).map(|_| 0.0).collect();
    for (index, span) in time.windows(2).enumerate() {
        let first = index.saturating_sub(BEFORE).min(time.len().saturating_sub(NODES));
        let last = (first + NODES).min(time.len());
        let (nodes, values) = (&time[first..last], &power[first..last]);
        sum += between(nodes, values, span[0], span[1]);
        works.push(sum);
    }
    works
}

/// Integral from `a` to `b` of the polynomial through `values` at `nodes`, at most of fifth degree, by three points of Gauss.
fn between(nodes: &[f64], values: &[f64], a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let away = half * 0.6_f64.sqrt();
    let at = |x: f64| interpolated(nodes, values, x);
    half / 9.0 * (5.0 * at(middle - away) + 8.0 * at(middle) + 5.0 * at(middle + away))
}

/// The polynomial through `values` at `nodes`, at `x`, by Lagrange.
fn interpolated(nodes: &[f64], values: &[f64], x: f64) -> f64 {
    let weight = |i: usize| {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(1.0, |product, (_, node)| product * (x - node) / (nodes[i] - node))
    };
    values.iter().enumerate().map(|(i, value)| weight(i) * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_of_a_power_of_fifth_degree_is_exact_at_any_instants() {
        let time = [0.0, 0.1, 0.35, 0.4, 0.7, 0.9, 1.0];
        let power = |t: f64| 1.0 - 3.0 * t + 6.0 * t.powi(5);
        let found = works(&time, &time.map(power));
        for (t, work) in time.iter().zip(found) {
            assert!((work - (t - 1.5 * t * t + t.powi(6))).abs() < 1e-14, "{t}: {work}");
        }
    }

    #[test]
    fn the_error_of_the_work_falls_with_the_sixth_power_of_the_distance() {
        let error = |steps: usize| {
            let time = crate::motion::instants(3.0, steps);
            let found = works(&time, &time.iter().map(|t| t.sin()).collect::<Vec<_>>());
            (found[steps] - (1.0 - 3.0_f64.cos())).abs()
        };
        let order = (error(15) / error(30)).log2();
        assert!((5.5..8.0).contains(&order), "{order}");
    }

    #[test]
    fn few_instants_have_a_work_too() {
        assert_eq!(works(&[], &[]), Vec::<f64>::new());
        assert_eq!(works(&[1.0], &[5.0]), [0.0]);
        assert_eq!(works(&[0.0, 2.0], &[1.0, 2.0]), [0.0, 3.0]);
    }
}

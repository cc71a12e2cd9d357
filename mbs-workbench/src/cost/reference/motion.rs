//! The course of a reference solution: steps from instant to instant, located contacts, positions put back onto the rows.

use std::time::{Duration, Instant};

use mbs_runtime::Scalar;

use super::collocated::Collocated;
use super::extrapolated::Extrapolated;
use super::linear::{Matrix, worse};
use crate::double_double::DoubleDouble as D;
use crate::erased::exact::{ExactEquations, Moving, Observed};

/// Kind of a reference method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leg {
    /// Explicit, on accelerations: uses γ.
    Extrapolated,
    /// Implicit, on velocities: without γ.
    Collocated,
    /// [`DormandPrince8`](mbs_runtime::dynamics::DormandPrince8) with projection, of the runtime in double-double numbers.
    Order8,
    /// [`DormandPrince5`](mbs_runtime::dynamics::DormandPrince5) with another formulation, of the runtime in double-double numbers.
    Order5,
}

impl Leg {
    /// Its kind in a word.
    pub fn name(self) -> &'static str {
        match self {
            Leg::Extrapolated => "extrapolated",
            Leg::Collocated => "collocated",
            Leg::Order8 => "explicit (order 8)",
            Leg::Order5 => "explicit (order 5)",
        }
    }
}

/// The state at an instant with what settings are compared in.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The state.
    pub at: Moving,
    /// Accelerations: N.
    pub qdd: Vec<D>,
    /// Multipliers: M.
    pub lambda: Vec<D>,
    /// Reactions, energy, outputs.
    pub observed: Observed<D>,
}

/// The shot of a motion with these numbers alone.
#[cfg(test)]
pub fn shot_of(t: f64, q: Vec<f64>, qd: Vec<f64>, qdd: Vec<f64>) -> Shot {
    let exact = |values: Vec<f64>| values.into_iter().map(D::constant).collect::<Vec<D>>();
    let zero = D::constant(0.0);
    let observed = Observed { reaction: Vec::new(), energy: zero, kinetic: zero, outputs: Vec::new() };
    let at = Moving { t: D::constant(t), q: exact(q), qd: exact(qd), states: Vec::new() };
    Shot { at, qdd: exact(qdd), lambda: Vec::new(), observed }
}

/// A contact that closes or opens, or an event of the text that begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Time (s).
    pub t: f64,
    /// Its index among the contacts of the text, events behind them.
    pub index: usize,
    /// `true` where a contact closes.
    pub closes: bool,
    /// `true` where velocities jump: a rigid contact.
    pub jumps: bool,
}

/// A reference solution.
#[derive(Clone, Debug)]
pub struct Reference {
    /// One an instant, as far as it came.
    pub shots: Vec<Shot>,
    /// Local tolerance of a step, in the reference metric.
    pub tolerance: f64,
    /// Steps taken.
    pub steps: u64,
    /// Contacts that closed or opened, and events that began or ended, in the order of time.
    pub contacts: Vec<Contact>,
    /// Reason why it ended early.
    pub stuck: Option<Stuck>,
}

/// Reason why a reference solution ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stuck {
    /// Steps became too small.
    SmallSteps,
    /// No time is left.
    OutOfTime,
    /// A method of the runtime ends it, with the failure in words.
    Refused(String),
}

/// Accelerations and multipliers at the end of a step.
#[derive(Clone, Debug)]
pub struct Solved {
    /// q̈: N.
    pub qdd: Vec<D>,
    /// λ: M.
    pub lambda: Vec<D>,
    /// ż.
    pub state_rates: Vec<D>,
}

/// A step that was tried.
pub struct Tried {
    /// Its end.
    pub end: Moving,
    /// Estimated error, in the reference metric.
    pub error: f64,
    /// Factor by which the next step may be longer.
    pub growth: f64,
}

/// A method of the reference.
pub trait StepMethod {
    /// A step of `h` (s) from `from`, where the state is `solved`; none where an iteration does not converge.
    fn step(
        &mut self,
        equations: &dyn ExactEquations,
        from: &Moving,
        solved: &Solved,
        h: D,
        aim: &Aim,
    ) -> Option<Tried>;
    /// Forgets what it keeps of the last step: the next one begins behind a jump.
    fn restart(&mut self);
    /// Keeps what the next step begins with: the step just tried was accepted.
    fn accept(&mut self);
}

/// Sizes that errors are measured by.
#[derive(Clone, Debug)]
pub struct Aim {
    /// Tolerance of a step.
    pub tolerance: f64,
    /// Reference metric of the coordinates: N.
    pub scales: Vec<f64>,
    /// Unit of velocities (1/s) in the reference metric.
    pub rate: f64,
    /// Units of the first-order states.
    pub states: Vec<f64>,
}

impl Aim {
    /// The largest difference of two states.
    pub fn difference(&self, a: &Moving, b: &Moving) -> f64 {
        let of = |a: &[D], b: &[D], units: &mut dyn Iterator<Item = f64>| {
            a.iter().zip(b).zip(units).map(|((a, b), unit)| (*a - *b).high.abs() / unit).fold(0.0, worse)
        };
        let q = of(&a.q, &b.q, &mut self.scales.iter().copied());
        let qd = of(&a.qd, &b.qd, &mut self.scales.iter().map(|scale| scale * self.rate));
        let states = of(&a.states, &b.states, &mut self.states.iter().copied());
        worse(worse(q, qd), states)
    }
}

/// Shortest step over the span.
const SHORTEST: f64 = 1e-13;

/// Residual of a row at which a projection ends.
const CLOSED: f64 = 1e-29;

/// Contradiction of rows that follow from others, by the rounding of the text's constants.
const ROUNDED: f64 = 1e-14;

/// Corrections of a projection.
const CORRECTIONS: usize = 12;

/// Repetitions of the equations of motion where forces depend on multipliers.
const REPETITIONS: usize = 60;

/// Accelerations and multipliers from Φ_q q̈ = γ; none where rows are singular or friction finds no balance.
pub fn accelerations(equations: &dyn ExactEquations, at: &Moving, lambda: &[D]) -> Option<Solved> {
    let rows = equations.rows(at);
    let gamma = equations.gamma(at);
    let (n, m) = (at.q.len(), rows.phi.len());
    let mut lambda = lambda.to_vec();
    for _ in 0..REPETITIONS {
        let terms = equations.terms(at, &lambda);
        let slope = |i: usize, j: usize| terms.force_lambda.as_ref().map(|slope| slope[i * m + j]);
        let column = |i: usize, j: usize| {
            let plain = rows.phi_q[j * n + i];
            slope(i, j).map_or(plain, |slope| plain - slope)
        };
        let matrix = Matrix::saddle(n, m, &terms.mass, column, &rows.phi_q);
        let mut right = terms.force.clone();
        for (i, force) in right.iter_mut().enumerate() {
            for (j, lambda) in lambda.iter().enumerate() {
                if let Some(slope) = slope(i, j) {
                    *force = *force - slope * *lambda;
                }
            }
        }
        right.extend(gamma.iter().copied());
        let found = matrix.solve(&matrix.factors(), &right)?;
        let (qdd, next) = found.split_at(n);
        let largest = next.iter().map(|value| value.high.abs()).fold(0.0, f64::max);
        let moved = next.iter().zip(&lambda).map(|(a, b)| (*a - *b).high.abs()).fold(0.0, f64::max);
        let is_last = terms.force_lambda.is_none() || moved <= 1e-27 * largest;
        lambda = next.to_vec();
        if is_last {
            return Some(Solved { qdd: qdd.to_vec(), lambda, state_rates: terms.state_rates });
        }
    }
    None
}

/// Puts positions onto Φ = 0 and velocities onto Φ_q q̇ + Φ_t = 0, nearest in the mass's measure; `false` where that fails.
pub fn project(equations: &dyn ExactEquations, at: &mut Moving) -> bool {
    let (n, m) = (at.q.len(), equations.sizes().rows);
    if m == 0 {
        return true;
    }
    let scales = equations.row_scales();
    let zero = vec![D::constant(0.0); m];
    let mass = equations.terms(at, &zero).mass;
    let correction = |rows: &crate::erased::exact::Rows, open: &[D]| {
        let matrix = Matrix::saddle(n, m, &mass, |i, j| rows.phi_q[j * n + i], &rows.phi_q);
        let mut right = vec![D::constant(0.0); n];
        right.extend(open.iter().map(|open| -*open));
        matrix.solve_within(&matrix.factors(), &right, ROUNDED)
    };
    let open = |residuals: &[D]| {
        residuals.iter().zip(&scales).map(|(residual, scale)| (residual.high / scale).abs()).fold(0.0, worse)
    };
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let rows = equations.rows(at);
        let size = open(&rows.phi);
        // Rows that contradict each other by the rounding of the text's constants stay open.
        if size <= CLOSED || size >= 0.5 * last && size < 1e-14 {
            break;
        }
        if size.is_nan() {
            return false;
        }
        last = size;
        let Some(step) = correction(&rows, &rows.phi) else { return false };
        for (q, step) in at.q.iter_mut().zip(step) {
            *q = *q + step;
        }
    }
    let rows = equations.rows(at);
    if open(&rows.phi) > 1e-14 {
        return false;
    }
    let Some(step) = correction(&rows, &rows.rate) else { return false };
    for (qd, step) in at.qd.iter_mut().zip(step) {
        *qd = *qd + step;
    }
    true
}

/// The motion from `start` through `times` (s) by `leg`, with steps of `tolerance`, within `budget`.
pub fn reference(
    equations: &mut dyn ExactEquations,
    leg: Leg,
    start: (&[f64], &[f64]),
    times: &[f64],
    tolerance: f64,
    budget: Duration,
) -> Reference {
    let exact = |values: &[f64]| values.iter().map(|value| D::constant(*value)).collect::<Vec<D>>();
    let first = times.first().copied().unwrap_or(0.0);
    let span = times.last().copied().unwrap_or(0.0) - first;
    let mut found = Reference { shots: Vec::new(), tolerance, steps: 0, contacts: Vec::new(), stuck: None };
    let mut method: Box<dyn StepMethod> = match leg {
        Leg::Extrapolated => Box::new(Extrapolated),
        Leg::Collocated => Box::new(Collocated::default()),
        // Their steps are those of the runtime: `of_one_kind`.
        Leg::Order8 | Leg::Order5 => {
            found.stuck = Some(Stuck::Refused(format!("{} steps are the runtime's", leg.name())));
            return found;
        }
    };
    let Some(mut course) = Course::begin(equations, exact(start.0), exact(start.1), first) else {
        found.stuck = Some(Stuck::SmallSteps);
        return found;
    };
    let scales = equations.scales();
    let began = Instant::now();
    found.shots.push(course.shot(equations));
    let mut h = span / 1000.0;
    for time in times.iter().skip(1) {
        let until = D::constant(*time);
        while course.at.t < until {
            if began.elapsed() > budget {
                found.stuck = Some(Stuck::OutOfTime);
                return found;
            }
            let speeds = course.at.qd.iter().zip(&scales).map(|(qd, scale)| qd.high.abs() / scale);
            course.fastest = speeds.fold(course.fastest.max(1.0 / span), f64::max);
            let states = course.at.states.iter().map(|state| state.high.abs().max(1e-6)).collect();
            let aim = Aim { tolerance, scales: scales.clone(), rate: course.fastest, states };
            let left = (until - course.at.t).high;
            if h < SHORTEST * span {
                found.stuck = Some(Stuck::SmallSteps);
                return found;
            }
            let is_whole = h >= 0.999 * left;
            let step = if is_whole { until - course.at.t } else { D::constant(h.min(0.5 * left)) };
            match course.advance(equations, method.as_mut(), step, &aim) {
                Some((growth, event)) => {
                    found.steps += 1;
                    found.contacts.extend(event);
                    // A step that an instant cut short says nothing of the length that it could have had.
                    h = h.max(step.high) * if is_whole { growth.max(1.0) } else { growth };
                }
                None => h = 0.35 * step.high,
            }
        }
        course.at.t = until;
        found.shots.push(course.shot(equations));
    }
    found
}

/// A motion under way.
struct Course {
    at: Moving,
    solved: Solved,
    fastest: f64,
}

impl Course {
    fn begin(equations: &mut dyn ExactEquations, q: Vec<D>, qd: Vec<D>, t: f64) -> Option<Self> {
        let t = D::constant(t);
        equations.begin(t, &q);
        let mut at = Moving { t, q, qd, states: equations.start_states() };
        let is_closed = project(equations, &mut at);
        let zero = vec![D::constant(0.0); equations.sizes().rows];
        let solved = accelerations(equations, &at, &zero);
        solved.filter(|_| is_closed).map(|solved| Course { at, solved, fastest: 0.0 })
    }

    fn shot(&self, equations: &dyn ExactEquations) -> Shot {
        let observed = equations.observed(&self.at, &self.solved.qdd, &self.solved.lambda);
        let Solved { qdd, lambda, .. } = self.solved.clone();
        Shot { at: self.at.clone(), qdd, lambda, observed }
    }

    /// One step, up to the first contact that opens or closes in it. Returns the factor for the next one, and that contact; none where
    /// the step is to be tried again shorter.
    fn advance(
        &mut self,
        equations: &mut dyn ExactEquations,
        method: &mut dyn StepMethod,
        h: D,
        aim: &Aim,
    ) -> Option<(f64, Option<Contact>)> {
        let tried = self.tried(equations, method, h, aim)?;
        let before = signs(equations, &self.at);
        let after = equations.gaps(&tried.end);
        let crossed = before.iter().zip(&after).position(|(sign, gap)| sign * gap[0].high < 0.0);
        let Some(crossed) = crossed else {
            method.accept();
            self.take(equations, tried.end)?;
            return Some((tried.growth, None));
        };
        // The contact by regula falsi over steps from the same start, with Illinois's weights.
        let gap = |at: &Moving| equations.gaps(at)[crossed][0];
        let (mut low, mut high) = (D::constant(0.0), h);
        let (mut at_low, mut at_high) = (gap(&self.at), after[crossed][0]);
        if before[crossed] * at_low.high <= 0.0 {
            at_low = D::constant(before[crossed] * 1e-30);
        }
        let mut end = tried.end;
        for _ in 0..80 {
            let width = high - low;
            if width.high <= 1e-28 * h.high.max(1e-3) || at_high.high.abs() <= 1e-27 {
                break;
            }
            let share = at_low / (at_low - at_high);
            let between = if share.high > 1e-3 && share.high < 0.999_999 { share } else { D::constant(0.5) };
            let middle = low + width * between;
            let tried = self.tried(equations, method, middle, aim)?;
            let value = gap(&tried.end);
            if before[crossed] * value.high < 0.0 {
                (high, at_high, end) = (middle, value, tried.end);
                at_low = at_low * D::constant(0.5);
            } else {
                (low, at_low) = (middle, value);
                at_high = at_high * D::constant(0.5);
            }
        }
        method.restart();
        self.take(equations, end)?;
        Some((
            0.25,
            Some(Contact { t: self.at.t.high, index: crossed, closes: before[crossed] > 0.0, jumps: false }),
        ))
    }

    /// A step with its end on the rows, if its error is small enough.
    fn tried(
        &self,
        equations: &dyn ExactEquations,
        method: &mut dyn StepMethod,
        h: D,
        aim: &Aim,
    ) -> Option<Tried> {
        let mut tried = method.step(equations, &self.at, &self.solved, h, aim)?;
        let is_small = tried.error <= aim.tolerance;
        (is_small && project(equations, &mut tried.end)).then_some(tried)
    }

    fn take(&mut self, equations: &mut dyn ExactEquations, end: Moving) -> Option<()> {
        let solved = accelerations(equations, &end, &self.solved.lambda)?;
        equations.move_on(end.t);
        (self.at, self.solved) = (end, solved);
        Some(())
    }
}

/// Side of each contact on which the motion goes on: that of the gap, at touch that of its rate.
fn signs(equations: &dyn ExactEquations, at: &Moving) -> Vec<f64> {
    let side = |[gap, rate]: &[D; 2]| {
        let is_touching = gap.high.abs() <= 1e-25;
        let value = if is_touching { rate.high } else { gap.high };
        if value < 0.0 { -1.0 } else { 1.0 }
    };
    equations.gaps(at).iter().map(side).collect()
}

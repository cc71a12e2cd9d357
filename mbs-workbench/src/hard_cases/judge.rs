//! Judgement of a run by the oracle: rows, velocities against positions, equations of motion, energy.

use core::f64::consts::TAU;

use crate::erased::timed_runs::Seen;
use crate::erased::timed_steps::Placed;
use crate::hard_cases::instants::stretches;
use crate::hard_cases::oracle::{Gap, Oracle, OracleState, Slack};
use crate::hard_cases::variation::numbers;
use crate::hard_cases::verdict::larger;

/// Instants of a run at which the text is interpreted.
const LOOKS: usize = 16;

/// Error of an integral of q̇ in the reference metric up to which it shows the way of q.
const RESOLVED: f64 = 0.3;

/// Bounds that a run must keep, as parts of what is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Of rows and their derivatives: as parts of the reference lengths, and of the largest rates.
    pub rows: f64,
    /// Of M q̈ + Φ_qᵀ λ − Q, as a part of its terms.
    pub balance: f64,
    /// Estimate of the run's own error in the reference metric.
    pub estimate: f64,
    /// Difference that rounding explains.
    pub rounding: f64,
    /// Rounding of one position, as a part of its size in the reference metric, and of one velocity, as a part of itself.
    pub digit: f64,
}

/// Result of a judgement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// The first fault, in words.
    pub wrong: Option<String>,
    /// Checks that were not made, with the reasons.
    pub not_made: Vec<String>,
}

impl Judgement {
    fn fault(&mut self, words: String) {
        self.wrong.get_or_insert(words);
    }

    fn gap(&mut self, check: &str, Gap(reason): Gap) {
        let words = format!("{check}: the oracle does not evaluate {reason}");
        if !self.not_made.contains(&words) {
            self.not_made.push(words);
        }
    }
}

fn digits(value: f64) -> String {
    format!("{value:.1e}")
}

/// Largest magnitude over the scales; NaN stays.
fn extent(values: &[f64], scales: &[f64]) -> f64 {
    let parts = values.iter().zip(scales).map(|(value, scale)| (value / scale).abs());
    parts.fold(0.0, larger)
}

/// `true` where a value is above its bound, or none.
pub fn exceeds(value: f64, bound: f64) -> bool {
    value.is_nan() || value > bound
}

/// A state that is judged.
pub fn of_moved(seen: &Seen) -> OracleState {
    let Seen { t, q, qd, qdd, lambda, states, .. } = seen.clone();
    OracleState { t, q, qd, qdd, lambda, states, ..OracleState::default() }
}

/// A state that is judged, of a motion that drives prescribe.
pub fn of_driven(placed: &Placed<f64>) -> OracleState {
    let [q, qd, qdd] = placed.motion.clone();
    OracleState { t: placed.t, q, qd, qdd, ..OracleState::default() }
}

/// Judges a run at instants in stretches of equal distances, by the text as `oracle` reads it. `fine`: the run of half the step at the same
/// instants, empty where there is none; `scales`: reference metric of the coordinates.
pub fn judge(
    [run, fine]: [&[OracleState]; 2],
    oracle: &Oracle,
    scales: &[f64],
    bounds: Bounds,
    seed: u64,
) -> Judgement {
    let mut found = Judgement::default();
    for state in run {
        let all = state.q.iter().chain(&state.qd).chain(&state.qdd).chain(&state.lambda).chain(&state.states);
        if let Some(value) = all.into_iter().find(|value| !value.is_finite()) {
            found.fault(format!("`Ok` with {value} at t = {:.4} s", state.t));
            return found;
        }
    }
    rows(run, oracle, scales, bounds, &mut found);
    velocities([run, fine], (oracle.turns(), oracle.has_impacts()), scales, bounds, &mut found);
    if oracle.is_dynamic() && run.iter().any(|state| !state.lambda.is_empty() || oracle.row_count() == 0) {
        balance(run, oracle, scales, bounds, (seed, &mut found));
        energy([run, fine], oracle, bounds, &mut found);
    }
    if let Some(words) = oracle.contradiction() {
        found.fault(words);
    }
    found
}

/// Instants at equal distances, the first and the last among them.
fn looks(run: &[OracleState]) -> impl Iterator<Item = &OracleState> {
    let stride = run.len().saturating_sub(1).div_ceil(LOOKS - 1).max(1);
    run.iter().step_by(stride)
}

/// Largest rates and accelerations of a run.
fn paces(run: &[OracleState], scales: &[f64]) -> [f64; 2] {
    let pace = run.iter().map(|state| extent(&state.qd, scales)).fold(0.0, f64::max);
    [pace, run.iter().map(|state| extent(&state.qdd, scales)).fold(pace * pace, f64::max)]
}

/// Φ, Φ̇ and Φ̈ are 0.
fn rows(run: &[OracleState], oracle: &Oracle, scales: &[f64], bounds: Bounds, found: &mut Judgement) {
    let mut gradients = vec![0.0_f64; oracle.row_count()];
    // A gradient may vanish at a singular position; it is measured where it is largest.
    for state in run.iter().step_by((run.len() / 3).max(1)) {
        match oracle.gradients(state, scales) {
            Ok(here) => gradients.iter_mut().zip(here).for_each(|(known, here)| *known = known.max(here)),
            Err(gap) => return found.gap("rows", gap),
        }
    }
    let [pace, push] = paces(run, scales);
    for state in looks(run) {
        let rows = match oracle.rows(state) {
            Ok(rows) => rows,
            Err(gap) => return found.gap("rows", gap),
        };
        for (index, (row, gradient)) in rows.iter().zip(&gradients).enumerate() {
            let gradient = gradient.max(f64::MIN_POSITIVE);
            let open = row.phi.unwrap_or(0.0).abs() / gradient;
            if exceeds(open, bounds.rows) {
                let open = digits(open);
                found.fault(format!("row {index} is open by {open} at t = {:.4} s", state.t));
            }
            let rates = [("velocities", row.rate, pace), ("accelerations", row.second, push)];
            for (what, value, size) in rates {
                let open = value.abs() / gradient / (1.0 + size);
                // Accelerations come from a saddle-point system, whose rows close to fewer digits.
                if exceeds(open, 100.0 * bounds.rows) {
                    let open = digits(open);
                    found.fault(format!("{what} leave row {index} by {open} at t = {:.4} s", state.t));
                }
            }
        }
    }
}

/// An angle less whole turns.
pub fn less_turns(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Indices from which on `count` instants follow each other at equal distances, each beginning where the last one ends.
fn begins(run: &[OracleState], count: usize) -> Vec<usize> {
    let times: Vec<f64> = run.iter().map(|state| state.t).collect();
    let each = |range: core::ops::Range<usize>| {
        (range.start..(range.end + 1).saturating_sub(count)).step_by(count - 1)
    };
    stretches(&times).into_iter().flat_map(each).collect()
}

/// q changes by the integral of q̇: Hermite's rule of order 6 through q̇ and q̈ of both ends, once over one interval and once over
/// two; what truncation explains falls 32 times between them. Errors of q̇ and q̈ are those that half the step shows: beside stiff
/// springs small errors of q are large ones of q̈.
fn velocities(
    [run, fine]: [&[OracleState]; 2],
    (turns, has_impacts): (&[bool], bool),
    scales: &[f64],
    bounds: Bounds,
    found: &mut Judgement,
) {
    let doubts: Vec<[f64; 2]> = run.iter().zip(fine).map(|(a, b)| doubts(a, b, scales)).collect();
    let doubt = |index: usize| {
        let h = run[index + 1].t - run[index].t;
        let of =
            |index: usize| doubts.get(index).map_or(0.0, |[rate, second]| h * rate + h * h / 12.0 * second);
        let sum = of(index) + of(index + 1);
        // A run at half the step that is NaN explains nothing.
        if sum.is_finite() { sum } else { 0.0 }
    };
    let miss = |a: &OracleState, b: &OracleState| {
        let h = b.t - a.t;
        let miss = |j: usize| {
            let mean = 0.5 * (a.qd[j] + b.qd[j]) + h / 12.0 * (a.qdd[j] - b.qdd[j]);
            let miss = b.q[j] - a.q[j] - h * mean;
            if turns[j] { less_turns(miss) } else { miss }
        };
        extent(&(0..a.q.len()).map(miss).collect::<Vec<_>>(), scales)
    };
    let mut over: Vec<(f64, f64)> = begins(run, 3)
        .into_iter()
        .filter_map(|index| {
            let three = &run[index..index + 3];
            let twice = miss(&three[0], &three[2]);
            let one = miss(&three[0], &three[1]).max(miss(&three[1], &three[2]));
            let own = bounds.estimate + doubt(index).max(doubt(index + 1));
            let allowed = twice / 8.0 + 10.0 * own + bounds.rounding;
            // Steps of whole turns do not show what is between their ends.
            let is_shown = !exceeds(twice, RESOLVED) || twice.is_nan();
            is_shown.then_some((one / allowed, one))
        })
        .collect();
    if over.is_empty() && run.len() > 2 {
        found
            .not_made
            .push("velocities against positions: the steps are too long to integrate q̇".to_string());
    }
    over.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A kink between two instants is met by few of them, impacts by many, a wrong velocity by all.
    let (share, words) = if has_impacts { (8, "most") } else { (2, "half") };
    if let Some((over, miss)) = over.get(over.len() / share).filter(|(over, _)| exceeds(*over, 1.0)) {
        found.fault(format!(
            "q and the integral of q̇ differ by {} in {words} of the intervals, {over:.0} times what the steps explain",
            digits(*miss)
        ));
    }
}

/// Largest differences of q̇ and q̈ of two runs at an instant, in the reference metric.
fn doubts(run: &OracleState, fine: &OracleState, scales: &[f64]) -> [f64; 2] {
    [(&run.qd, &fine.qd), (&run.qdd, &fine.qdd)]
        .map(|(a, b)| extent(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>(), scales))
}

/// wᵀ(M q̈ + Φ_qᵀ λ − Q) is 0 along two directions that the seed gives, less what rounding of positions and velocities makes of it.
fn balance(
    run: &[OracleState],
    oracle: &Oracle,
    scales: &[f64],
    bounds: Bounds,
    (seed, found): (u64, &mut Judgement),
) {
    let mut random = numbers(seed ^ 0xba1a);
    let mut worst: Vec<(f64, f64)> = Vec::new();
    let slack = Slack { rows: bounds.rows, forces: bounds.balance, pace: paces(run, scales) };
    let (mut broken, mut is_shared) = (Vec::new(), false);
    for state in looks(run) {
        let held = match oracle.held(state, scales, slack) {
            Ok(held) => held,
            Err(gap) => return found.gap("equations of motion", gap),
        };
        is_shared |= held.is_shared;
        broken.extend(held.broken.into_iter().map(|words| format!("{words} at t = {:.4} s", state.t)));
        let state = &OracleState { held: held.forces, ..state.clone() };
        let w: Vec<f64> = scales
            .iter()
            .map(|scale| scale * random.uniform(0.5, 1.0) * if random.index(2) == 0 { 1.0 } else { -1.0 })
            .collect();
        match oracle.equations_of_motion(state, &w) {
            Ok(balance) if exceeds(balance.open(), bounds.balance) => {
                match oracle.rounding_of_equations(state, &w, (scales, bounds.digit)) {
                    Ok(rounding) => worst.push((balance.without(rounding).open(), state.t)),
                    Err(gap) => return found.gap("equations of motion", gap),
                }
            }
            Ok(balance) => worst.push((balance.open(), state.t)),
            Err(gap) => return found.gap("equations of motion", gap),
        }
    }
    if is_shared {
        found.not_made.push("laws of forces that several contacts or frictions share".to_string());
    }
    // At a change of contact or of sticking an instant may belong to both sides.
    if let Some(words) = broken.get(2) {
        found.fault(words.clone());
    }
    worst.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Next to a singular position multipliers are cut: two looks may be there.
    if let Some((open, t)) = worst.len().checked_sub(3).map(|index| worst[index])
        && exceeds(open, bounds.balance)
    {
        let open = digits(open);
        found.fault(format!("M q̈ + Φ_qᵀλ − Q is open by {open} of its terms, at t = {t:.4} s and later"));
    }
}

/// Energies (J) and their rates (W) at the instants of a run.
fn energies(run: &[OracleState], oracle: &Oracle) -> Result<Vec<(f64, [f64; 2])>, Gap> {
    run.iter().map(|state| Ok((state.t, oracle.energy(state)?))).collect()
}

/// The energy changes by the work of q̇ and q̈: Simpson's rule over four intervals, and over twice as long ones. Errors of the powers
/// are those that half the step shows.
fn energy([run, fine]: [&[OracleState]; 2], oracle: &Oracle, bounds: Bounds, found: &mut Judgement) {
    let (all, fine) = match energies(run, oracle).and_then(|all| Ok((all, energies(fine, oracle)?))) {
        Ok(both) => both,
        Err(gap) => return found.gap("energy", gap),
    };
    if oracle.has_impacts() {
        let driven: Result<Vec<bool>, Gap> = looks(run).map(|state| oracle.drives_contacts(state)).collect();
        match driven {
            Ok(driven) if driven.contains(&true) => {
                let words = "energy: impacts on contacts that the time moves may bring it in".to_string();
                return found.not_made.push(words);
            }
            Ok(_) => {}
            Err(gap) => return found.gap("energy", gap),
        }
    }
    let doubts: Vec<f64> = all.iter().zip(&fine).map(|(a, b)| (a.1[1] - b.1[1]).abs()).collect();
    let doubt = |from: usize| {
        let largest = doubts.iter().skip(from).take(5).fold(0.0, |largest: f64, doubt| largest.max(*doubt));
        if largest.is_finite() { largest } else { 0.0 }
    };
    let Some((_, [first, _])) = all.first().copied() else { return };
    let scale = all.iter().map(|(_, [energy, _])| (energy - first).abs()).fold(0.0, f64::max);
    let size = scale.max(bounds.size_of_energy(run, oracle));
    let simpson = |a: &(f64, [f64; 2]), b: &(f64, [f64; 2]), c: &(f64, [f64; 2])| {
        (c.0 - a.0) / 6.0 * (a.1[1] + 4.0 * b.1[1] + c.1[1])
    };
    let mut over: Vec<(f64, f64)> = begins(run, 5)
        .into_iter()
        .map(|from| {
            let five = &all[from..from + 5];
            let [a, b, c, d, e] = five else { return (0.0, 0.0) };
            let work = simpson(a, b, c) + simpson(c, d, e);
            let mut explained = 2.0 * (simpson(a, c, e) - work).abs() + 2.0 * (e.0 - a.0) * doubt(from);
            let mut miss = e.1[0] - a.1[0] - work;
            // An impact takes energy, and powers jump in it: what is gained beside that is wrong in any interval.
            if oracle.has_impacts() {
                let powers = five.iter().map(|(_, [_, power])| *power);
                let [most, least] =
                    [powers.clone().fold(f64::MIN, f64::max), powers.fold(f64::MAX, f64::min)];
                explained += (e.0 - a.0) * (most - least);
                miss = miss.max(0.0);
            }
            let miss = miss.abs();
            (miss / (explained + (100.0 * bounds.estimate + bounds.rounding) * size), miss)
        })
        .collect();
    over.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A contact between two instants is met by few of them, a wrong force by all.
    let (index, words) = match oracle.has_impacts() {
        true => (over.len().saturating_sub(1), "is gained in an interval, of"),
        false => (over.len() / 2, "is what energy and work differ by in half of the intervals, of"),
    };
    if let Some((_, miss)) = over.get(index).filter(|(over, _)| exceeds(*over, 1.0)) {
        let [miss, size] = [*miss, size].map(digits);
        found.fault(format!("an energy of {miss} J {words} {size} J, more than the steps explain"));
    }
}

impl Bounds {
    /// Largest kinetic energy (J): velocities alone have it.
    fn size_of_energy(self, run: &[OracleState], oracle: &Oracle) -> f64 {
        let kinetic = |state: &OracleState| {
            let still = OracleState { qd: vec![0.0; state.qd.len()], ..state.clone() };
            let difference = oracle.energy(state).ok()?[0] - oracle.energy(&still).ok()?[0];
            Some(difference.abs())
        };
        looks(run).filter_map(kinetic).fold(f64::MIN_POSITIVE, f64::max)
    }
}

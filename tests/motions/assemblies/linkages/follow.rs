//! Cranks moved sample by sample, and every position compared with the closed form.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Budget, Failure, Lanes, Real, Scalar, Step, Stepper};

use super::texts::{By, Case};
use super::{Linkage, distance};

/// Reproducible numbers: SplitMix64. Source: Steele, Lea & Flood 2014.
pub struct Random(pub u64);

impl Random {
    /// The next number in [from, to).
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        from + (to - from) * (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub fn one_of<X: Copy>(&mut self, of: &[X]) -> X {
        of[(self.between(0.0, of.len() as f64) as usize).min(of.len() - 1)]
    }
}

/// Motion of the crank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// At constant speed.
    Steady,
    /// Every sample rounded to this number of bits a turn, with an error of up to two counts.
    Jitter(i32),
    /// Stops next to a change point for twenty samples, the last digit of 13 bits flickering.
    Dwell,
    /// Back again exactly on a change point.
    Reversal,
    /// Every 50th step twice as long.
    Doubled,
}

pub const MOTIONS: [Motion; 7] = [
    Motion::Steady,
    Motion::Jitter(10),
    Motion::Jitter(13),
    Motion::Jitter(16),
    Motion::Dwell,
    Motion::Reversal,
    Motion::Doubled,
];

/// Rates of an input.
#[derive(Clone, Copy, Debug)]
pub enum Rates {
    /// Differences of the samples.
    Differences,
    /// None.
    Zero,
}

/// Crank angles (rad), a start and samples, some `samples` of `step`.
pub fn samples(motion: Motion, linkage: &Linkage, step: f64, count: usize, random: &mut Random) -> Vec<f64> {
    samples_about(motion, linkage.centres, step, count, random)
}

/// The same about change points at crank angles `centres` (rad).
pub fn samples_about(
    motion: Motion,
    centres: &[f64],
    step: f64,
    count: usize,
    random: &mut Random,
) -> Vec<f64> {
    let direction = random.one_of(&[1.0, -1.0]);
    let centre = *centres.first().unwrap_or(&1.0);
    // A start with room on both sides.
    let start = centre + direction * (0.3 + random.between(0.0, PI - 0.6));
    let mut angles = vec![start];
    let mut heading = direction;
    let mut k = 0;
    while angles.len() <= count {
        k += 1;
        let last = *angles.last().expect("a start");
        let next = last + heading * step;
        let passed = centres.iter().find_map(|centre| {
            let turn = ((0.5 * (last + next) - centre) / TAU).round() * TAU + centre;
            ((last - turn) * (next - turn) < 0.0).then_some(turn)
        });
        match (motion, passed) {
            (Motion::Jitter(bits), _) => {
                let count = TAU / f64::from(1 << bits);
                angles.push(((next + random.between(-2.0, 2.0) * count) / count).round() * count);
            }
            (Motion::Doubled, _) if k % 50 == 0 => angles.push(next + heading * step),
            (Motion::Reversal, Some(turn)) => {
                angles.push(turn);
                // Now and then through.
                heading = if random.between(0.0, 1.0) < 0.7 { -heading } else { heading };
            }
            (Motion::Dwell, Some(turn)) => {
                let bit = TAU / f64::from(1 << 13);
                let at = turn + random.between(-0.5, 0.5) * step.min(0.1);
                angles.extend((0..20).map(|_| ((at + random.between(-1.0, 1.0) * bit) / bit).round() * bit));
                angles.push(next);
            }
            _ => angles.push(next),
        }
    }
    angles
}

/// Kind of steps.
#[derive(Clone, Copy, Debug)]
pub enum Steps {
    Advance,
    Within(Budget),
}

/// Counts of the results of runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    pub steps: u64,
    /// `Ok` and nearer to the other assembly.
    pub wrong: u64,
    /// `Ok` and on neither.
    pub off: u64,
    /// Refused at margins above 0.05.
    pub refused: u64,
    /// Refused nearer to a change point.
    pub refused_inside: u64,
    /// Steps over change points.
    pub passages: u64,
}

impl Tally {
    pub fn and(self, other: Self) -> Self {
        Tally {
            steps: self.steps + other.steps,
            wrong: self.wrong + other.wrong,
            off: self.off + other.off,
            refused: self.refused + other.refused,
            refused_inside: self.refused_inside + other.refused_inside,
            passages: self.passages + other.passages,
        }
    }

    /// Counts the result of a step to crank angle `theta`.
    pub fn take(
        &mut self,
        linkage: &Linkage,
        theta: f64,
        side: f64,
        epsilon: f64,
        step: Result<[f64; 2], Failure>,
    ) -> bool {
        let assemblies = [side, -side].map(|side| linkage.point(theta, side));
        self.judge(assemblies, linkage.margin(theta), theta, epsilon, step)
    }

    /// Counts the result of a step to crank angle `theta` (rad), where the right point and that of the other assembly are
    /// `assemblies` (m) and the margin to singularity is `margin`.
    pub fn judge(
        &mut self,
        assemblies: [[f64; 2]; 2],
        margin: f64,
        theta: f64,
        epsilon: f64,
        step: Result<[f64; 2], Failure>,
    ) -> bool {
        self.steps += 1;
        // Rounding error of a position at the margin there: of residuals, and of angles that have grown over many turns.
        let open = (2e3 + 32.0 * theta.abs()) * epsilon / margin.max(epsilon.sqrt());
        match step {
            Err(_) => {
                let inside = margin < 0.05;
                self.refused_inside += u64::from(inside);
                self.refused += u64::from(!inside);
                false
            }
            Ok(point) => {
                let [right, wrong] = assemblies.map(|assembly| distance(point, assembly));
                let apart = distance(assemblies[0], assemblies[1]) > 4.0 * open;
                self.wrong += u64::from(apart && wrong < right);
                self.off += u64::from(right.min(wrong) > open);
                true
            }
        }
    }
}

/// A linkage assembled at its first sample.
pub fn assembled<S, R, const N: usize>(
    mut mechanism: S,
    linkage: &Linkage,
    theta: f64,
    side: f64,
) -> Stepper<S, R, N>
where
    S: Case<R, N>,
    R: Real,
{
    mechanism.set_lengths(linkage);
    let angle = R::constant(theta);
    mechanism.command(angle, R::constant(if S::BY == By::Rate { 0.0 } else { 1.0 }));
    let guess = S::start(linkage, theta, linkage.point(theta, side));
    let t = if let By::Time(speed) = S::BY { R::constant(theta / speed) } else { R::constant(0.0) };
    Stepper::assemble(mechanism, guess.map(R::constant), t)
        .unwrap_or_else(|failure| panic!("{} {theta} {side}: {failure}", linkage.name))
}

/// Follows `angles` with one stepper.
pub fn follow<S, R, const N: usize>(
    mechanism: S,
    linkage: &Linkage,
    angles: &[f64],
    side: f64,
    rates: Rates,
    by: Steps,
) -> Tally
where
    S: Case<R, N>,
    R: Real,
{
    let epsilon = R::EPSILON.to_f64();
    let exact = |angle: f64| R::constant(angle).to_f64();
    let start = exact(angles[0]);
    let mut stepper = assembled::<S, R, N>(mechanism, linkage, start, side);
    let mut tally = Tally::default();
    let (mut last, mut stands) = (start, start);
    for angle in angles.iter().skip(1) {
        let theta = exact(*angle);
        let rate = match (S::BY, rates) {
            (By::Rate, _) => theta - stands,
            (_, Rates::Differences) => theta - last,
            (_, Rates::Zero) => 0.0,
        };
        if !matches!(S::BY, By::Time(_)) {
            stepper.change(|mechanism| mechanism.command(R::constant(theta), R::constant(rate)));
        }
        let t = match S::BY {
            By::Time(speed) => R::constant(theta / speed),
            _ => stepper.t() + R::constant(1.0),
        };
        let h = t - stepper.t();
        let done = match (by, S::BY) {
            (Steps::Advance, By::Time(_)) => stepper.advance_to(t).map(|_| ()),
            (Steps::Advance, _) => stepper.advance(h).map(|_| ()),
            (Steps::Within(budget), _) => match stepper.step(h, budget) {
                Step::Done(_) | Step::Degraded { .. } => Ok(()),
                Step::Refused(failure) => Err(failure),
            },
        };
        let theta = match S::BY {
            // The integral of the rate in the number type.
            By::Rate => crank::<S, R, N>(&stepper, theta, done.is_ok()),
            _ => theta,
        };
        let q = stepper.q().map(R::to_f64);
        if tally.take(linkage, theta, side, epsilon, done.map(|()| S::point(linkage, q))) {
            let between =
                |centre: &f64| ((stands - centre) / TAU).floor() != ((theta - centre) / TAU).floor();
            tally.passages += linkage.centres.iter().filter(|centre| between(centre)).count() as u64;
            stands = theta;
        }
        last = theta;
    }
    tally
}

/// The crank angle of a drive by a rate.
fn crank<S: Case<R, N>, R: Real, const N: usize>(stepper: &Stepper<S, R, N>, theta: f64, done: bool) -> f64 {
    if done { stepper.q()[0].to_f64() } else { theta }
}

/// Follows four runs in lanes.
pub fn follow_in_lanes<S, R, const N: usize>(
    mechanism: S,
    linkage: &Linkage,
    runs: &[(Vec<f64>, f64); 4],
    rates: Rates,
) -> Tally
where
    R: Real,
    S: Case<Lanes<R, 4>, N>,
    S::Lane: Case<R, N>,
{
    let mut mechanism = mechanism;
    let epsilon = R::EPSILON.to_f64();
    let exact = |angle: f64| R::constant(angle).to_f64();
    mechanism.set_lengths(linkage);
    let at = |k: usize| Lanes::<R, 4>::from_lanes(|lane| R::constant(exact(runs[lane].0[k])));
    mechanism.command(at(0), Lanes::constant(0.0));
    let guess = core::array::from_fn(|lane| {
        let (angles, side) = &runs[lane];
        let theta = exact(angles[0]);
        S::start(linkage, theta, linkage.point(theta, *side)).map(R::constant)
    });
    let time = |k: usize| match S::BY {
        By::Time(speed) => at(k).0.map(|theta| R::constant(theta.to_f64() / speed)),
        _ => [R::constant(k as f64); 4],
    };
    let mut batch = Batch::<S, R, 4, N>::assemble(mechanism, &guess, time(0))
        .unwrap_or_else(|(lane, failure)| panic!("{} {lane}: {failure}", linkage.name));
    let mut tally = Tally::default();
    let mut stands = at(0);
    let count = runs.iter().map(|(angles, _)| angles.len()).min().unwrap_or(0);
    for k in 1..count {
        let rate = match (S::BY, rates) {
            (By::Rate, _) => at(k) - stands,
            (_, Rates::Differences) => at(k) - at(k - 1),
            (_, Rates::Zero) => Lanes::constant(0.0),
        };
        if !matches!(S::BY, By::Time(_)) {
            batch.change(|mechanism| mechanism.command(at(k), rate));
        }
        // Behind a refused step all lanes are at their own times: each takes the next one.
        let t = match S::BY {
            By::Time(_) => time(k),
            _ => batch.t().0.map(|t| t + R::constant(1.0)),
        };
        let steps = batch.advance_to(t);
        for (lane, step) in steps.into_iter().enumerate() {
            let done = step.is_ok();
            let q = batch.q().map(|coordinate| coordinate.lane(lane).to_f64());
            let theta = if S::BY == By::Rate && done { q[0] } else { at(k).lane(lane).to_f64() };
            tally.take(linkage, theta, runs[lane].1, epsilon, step.map(|_| S::point(linkage, q)));
            if done {
                stands.0[lane] = R::constant(theta);
            }
        }
    }
    tally
}

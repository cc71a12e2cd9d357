//! The work of each force, of each row and of the time, by the quadrature of the method that moves the mechanism.
//!
//! A method integrates one work with the motion, which changes none of its steps. So a run that counts the power of one supply
//! takes the same steps. The works of all such runs add up to the work of all supplies but for rounding, for any instants.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Counts, Extrapolated, Formulation, Instant, IntegratorState, Method, Model, Solved,
    SteppedInModes,
};
use mbs_runtime::{Dynamic, DynamicState, Failure};

use super::direct_dynamics::Simulated;
use super::power_balance;

/// Runs that every motion may have for its supplies; the works of more supplies are quadratures over the instants.
const FEWEST_RUNS: usize = 8;

/// Solutions of one unknown that all runs of a motion may take: about a second.
const MOST_SOLUTIONS: u64 = 100_000_000;

/// The work of some supplies, counted as [`power_balance::powers`] lists them, in place of that of all, for `by`.
///
/// Of one supply its power is counted. Of several the sum of the absolute powers, which is zero where none of them ever acts.
pub(super) struct Counted<'a, X> {
    /// Formulation or method.
    pub by: X,
    /// Indices of the supplies.
    pub supplies: &'a [usize],
}

/// Quadrature of the work within a step of an implicit method.
#[derive(Clone, Copy)]
pub(super) enum Quadrature {
    /// By the powers at both ends.
    Trapezoidal,
    /// By three thirds of the trapezoidal rule against a whole one, extrapolated.
    Extrapolated,
}

/// A run of the motion that counts the work of these supplies.
type Run<'a> = &'a dyn Fn(&[usize]) -> Result<Simulated, Failure>;

/// Sets the work of each supply of `found` to the one that `run` integrates for it alone. If a single supply may act, the work of
/// all is its own. `may_act`: supplies that have power in some motion.
///
/// A supply without power at all instants may act between them. One run tells if any of these does; which ones, runs of halves.
pub(super) fn add_works(found: &mut Simulated, may_act: &[bool], run: Run<'_>) {
    let mut runs = affordable(found);
    let Some(forces) = &mut found.motion.dynamics else { return };
    let able = |index: &usize| may_act.get(*index) != Some(&false);
    let all = 0..forces.supplies.len();
    let (acting, silent): (Vec<usize>, Vec<usize>) = all
        .filter(able)
        .partition(|index| forces.supplies.get(*index).is_some_and(|supply| acts(&supply.power)));
    if acting.len() > runs {
        return;
    }
    let hidden = if silent.is_empty() { Vec::new() } else { acting_of(silent, &mut runs, run) };
    let alone = acting.len() + hidden.len() == 1;
    for index in acting.iter().chain(&hidden) {
        let Some(supply) = forces.supplies.get_mut(*index) else { continue };
        let work = if alone { Some(forces.work.clone()) } else { run(&[*index]).ok().and_then(work_of) };
        if let Some(work) = work.filter(|work| work.len() == supply.power.len()) {
            supply.work = work;
        }
    }
}

/// Those of the supplies that act anywhere in the motion, by halves; all of them where no runs are left.
fn acting_of(supplies: Vec<usize>, runs: &mut usize, run: Run<'_>) -> Vec<usize> {
    let (mut open, mut found) = (vec![supplies], Vec::new());
    while let Some(mut group) = open.pop() {
        let acts = *runs == 0 || run(&group).ok().and_then(work_of).is_none_or(|work| acts(&work));
        *runs = runs.saturating_sub(1);
        if !acts {
            continue;
        }
        if group.len() == 1 {
            found.extend(group);
        } else {
            let second = group.split_off(group.len() / 2);
            open.extend([second, group]);
        }
    }
    found
}

/// Number of runs that the supplies of a motion may have.
fn affordable(found: &Simulated) -> usize {
    let unknowns = found.motion.coordinates.len()
        + found.motion.dynamics.as_ref().map_or(0, |forces| forces.multipliers.len());
    let once = found.counts.evaluations.saturating_mul((unknowns * unknowns) as u64).max(1);
    usize::try_from(MOST_SOLUTIONS / once).unwrap_or(usize::MAX).max(FEWEST_RUNS)
}

fn acts(power: &[f64]) -> bool {
    power.iter().any(|power| *power != 0.0)
}

fn work_of(run: Simulated) -> Option<Vec<f64>> {
    run.motion.dynamics.map(|forces| forces.work)
}

impl<X> Counted<'_, X> {
    /// The power (W) of the supplies in a state whose rates are known.
    fn power<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        solved: &Solved<f64, N, M, S::States>,
    ) -> f64 {
        let position = model.position(t, y);
        let motion =
            DynamicState { qd: &y.qd, qdd: &solved.rate.qd, lambda: &solved.lambda, states: &y.states };
        let parameters = model.with_set_valued_forces(&position, y, (&solved.rate.qd, &solved.lambda));
        let powers = power_balance::powers(model.mechanism, (&parameters, &position), &motion);
        let power = |index: &usize| powers.get(*index).map_or(0.0, |(_, _, power)| *power);
        match self.supplies {
            [supply] => power(supply),
            supplies => supplies.iter().map(|supply| power(supply).abs()).sum(),
        }
    }

    /// The rates with the power of the supplies alone.
    fn alone<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        mut solved: Solved<f64, N, M, S::States>,
    ) -> Solved<f64, N, M, S::States> {
        solved.rate.work = self.power(model, t, y, &solved);
        solved
    }
}

impl<S, F, const N: usize, const M: usize> Formulation<S, f64, N, M> for Counted<'_, &F>
where
    S: Dynamic<f64, N, M>,
    F: Formulation<S, f64, N, M> + ?Sized,
{
    fn solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        let solved = self.by.solve(model, t, y, lambda, counts)?;
        Ok(self.alone(model, t, y, solved))
    }

    fn solve_as_it_is(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        let solved = self.by.solve_as_it_is(model, t, y, lambda, counts)?;
        Ok(self.alone(model, t, y, solved))
    }

    fn project(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &mut IntegratorState<f64, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        self.by.project(model, t, y, counts)
    }

    fn project_and_solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &mut IntegratorState<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        let solved = self.by.project_and_solve(model, t, y, lambda, counts)?;
        Ok(self.alone(model, t, y, solved))
    }
}

impl<S, X, const N: usize, const M: usize> Method<S, f64, N, M> for Counted<'_, (&X, Quadrature)>
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M> + ?Sized,
{
    fn solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        let solved = self.by.0.solve(model, t, y, lambda, counts)?;
        Ok(self.alone(model, t, y, solved))
    }

    fn step(
        &self,
        model: &Model<'_, S, f64, N, M>,
        from: &Instant<f64, N, M, S::States>,
        h: f64,
        counts: &mut Counts,
    ) -> Result<Instant<f64, N, M, S::States>, Failure> {
        let mut next = self.by.0.step(model, from, h, counts)?;
        let (before, after) = (from.solved.rate.work, self.power_at(model, from.t, &next));
        let work = match self.by.1 {
            Quadrature::Trapezoidal => 0.5 * h * (before + after),
            Quadrature::Extrapolated => self.extrapolated(model, from, h)?,
        };
        next.y.work = from.y.work + work;
        next.solved.rate.work = after;
        Ok(next)
    }

    fn steps_over_modes(&self) -> bool {
        self.by.0.steps_over_modes()
    }

    fn step_in_modes(
        &self,
        model: &Model<'_, S, f64, N, M>,
        from: &Instant<f64, N, M, S::States>,
        h: f64,
        counts: &mut Counts,
    ) -> Result<SteppedInModes<f64, S::Parameters, N, M, S::States>, Failure> {
        let mut stepped = self.by.0.step_in_modes(model, from, h, counts)?;
        // Powers of the end are those of its modes.
        let parameters = stepped.parameters.unwrap_or(*model.parameters);
        let after = self.power_at(&Model { parameters: &parameters, ..*model }, from.t, &stepped.next);
        let next = &mut stepped.next;
        next.y.work = from.y.work + 0.5 * h * (from.solved.rate.work + after);
        next.solved.rate.work = after;
        Ok(stepped)
    }
}

impl<X> Counted<'_, X> {
    /// The power (W) at a later instant; the mechanism itself is as it was at `start` (s).
    fn power_at<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, f64, N, M>,
        start: f64,
        instant: &Instant<f64, N, M, S::States>,
    ) -> f64 {
        moved(model, start, instant.t, |model| self.power(model, instant.t, &instant.y, &instant.solved))
    }

    /// The work (J) of a step of `h` (s) by the parts that [`Extrapolated`] goes through.
    fn extrapolated<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, f64, N, M>,
        from: &Instant<f64, N, M, S::States>,
        h: f64,
    ) -> Result<f64, Failure> {
        let mut parts = Vec::new();
        Extrapolated
            .step_in_parts(model, (from, h), &mut Counts::default(), |at, part| parts.push((*at, part)))?;
        let mut work = 0.0;
        for (index, (mut at, part)) in parts.into_iter().enumerate() {
            if index > 0 {
                at.solved.rate.work = self.power_at(model, from.t, &at);
            }
            work += moved(model, from.t, at.t, |model| self.of_thirds(model, &at, part))?;
        }
        Ok(work)
    }

    /// The work (J) of a step of `h` (s) by the thirds and the whole step that [`Quadrature::Extrapolated`] goes through.
    fn of_thirds<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, f64, N, M>,
        from: &Instant<f64, N, M, S::States>,
        h: f64,
    ) -> Result<f64, Failure> {
        let (mut counts, before, third) = (Counts::default(), from.solved.rate.work, 1.0 / 3.0 * h);
        let whole = AugmentedLagrangian.step(model, from, h, &mut counts)?;
        let once = 0.5 * h * (before + self.power_at(model, from.t, &whole));
        let (mut at, mut sum) = (*from, before);
        for weight in [2.0, 2.0, 1.0] {
            at =
                moved(model, from.t, at.t, |model| AugmentedLagrangian.step(model, &at, third, &mut counts))?;
            sum += weight * self.power_at(model, from.t, &at);
        }
        let thrice = 0.5 * third * sum;
        Ok(thrice + (thrice - once) / 8.0)
    }
}

/// Result of `look` for the mechanism at `to` (s): inputs with rates and phases are advanced from `from` (s).
fn moved<S: Dynamic<f64, N, M>, X, const N: usize, const M: usize>(
    model: &Model<'_, S, f64, N, M>,
    from: f64,
    to: f64,
    look: impl FnOnce(&Model<'_, S, f64, N, M>) -> X,
) -> X {
    let mut mechanism = model.mechanism.clone();
    mechanism.carry_signals(model.mechanism, to - from);
    mechanism.advance_phases(from, to);
    let mut parameters = mechanism.parameters();
    let modes = S::set_valued_modes_mut(&mut parameters).iter_mut();
    modes.zip(S::set_valued_modes(model.parameters)).for_each(|(to, from)| *to = *from);
    let values = S::remembered_mut(&mut parameters).iter_mut();
    values.zip(S::remembered(model.parameters)).for_each(|(to, from)| *to = *from);
    look(&Model { mechanism: &mechanism, parameters: &parameters, ..*model })
}

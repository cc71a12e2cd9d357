//! Simulations side by side, of which those at stable rest sleep.

mod quiet;
mod rest;

use crate::dynamics::first_order_form::explicit::Explicit;
use crate::dynamics::integrators::embedded::Embedded;
use crate::dynamics::model::Formulation;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::simulation::Simulation;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Steps that a lane waits at most before it is looked at again, as a power of two.
const LONGEST_WAIT: u32 = 10;

/// A sleep of fewer steps is not worth the search for its end.
const SHORT: f64 = 8.0;

/// `L` simulations of one text, a lane each, each with its own design, time and state. Lanes at stable rest sleep.
///
/// A lane falls asleep where a call ends with all speeds 0 to rounding, and no force on the motions that are free. These must be stable: their
/// stiffness is symmetric and positive definite, and no damping feeds them. Forces of frictions that stick and of rigid contacts
/// must be within their cones. A step of a lane that sleeps evaluates nothing: the time moves on, and inputs with rates.
///
/// The end of a sleep is found where it begins. Forces are bounded over spans of time, by intervals, and the lane sleeps through those spans
/// in which every force stays within its cone. So nothing is missed that happens in between, however short, and the time at which
/// a margin vanishes is located to rounding. [`change`](Self::change) wakes a lane.
///
/// A lane never sleeps at an unstable or indifferent rest, and never where smooth friction alone holds it, for that creeps. So it is with
/// texts that have first-order states or drives that prescribe a rate, next to singular positions, and with
/// [`MoreauJean`](crate::dynamics::MoreauJean). A text with functions of the caller gives no bounds, so it does not sleep either.
///
/// ```
/// use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation, Simulations};
/// use mbs_runtime::mechanism;
///
/// # mechanism! {
/// #     /// A block on a belt of rough ground, drawn by a growing force.
/// #     pub mechanism Block;
/// #     param growth: N/s = 1;
/// #     coord x: m = 0;
/// #     body block { mass: 1, com: [x, 0] }
/// #     force draw: [growth*t, 0] on [x, 0];
/// #     friction rub { along: x, normal: 10N, coefficient: 0.2, sticks: 0.3 }
/// #     start x = 0 rate 0;
/// # }
///
/// // A block is drawn by the force `growth` t; it sticks up to 3 N.
/// let method = Explicit::new(RungeKutta4, Projection::default());
/// let start = |growth| Simulation::start_from_text(Block { growth }, method, 0.0_f64);
/// let mut blocks = Simulations::new([start(1.0)?, start(2.0)?]);
/// blocks.step(0.01);
/// let [slow, fast] = blocks.asleep_until();
/// assert!((slow.unwrap_or(0.0) - 3.0).abs() < 1e-9 && (fast.unwrap_or(0.0) - 1.5).abs() < 1e-9);
/// for _ in 0..200 {
///     blocks.step(0.01);
/// }
/// let [slow, fast] = blocks.asleep_until();
/// assert!(slow.is_some() && fast.is_none()); // the second one slides
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy)]
pub struct Simulations<S: Dynamic<R, N, M>, X, R: Real, const L: usize, const N: usize, const M: usize> {
    lanes: [Lane<S, X, R, N, M>; L],
}

/// A simulation that sleeps or not.
#[derive(Clone, Copy)]
struct Lane<S: Dynamic<R, N, M>, X, R: Real, const N: usize, const M: usize> {
    run: Simulation<S, X, R, N, M>,
    sleep: Option<Sleep<R>>,
    /// Steps until the lane is looked at again, and how often it was found awake.
    wait: (u32, u32),
}

/// A sleep.
#[derive(Clone, Copy, Debug)]
struct Sleep<R> {
    /// Time (s) at which it ends.
    until: R,
    /// Time (s) of the forces and of the energy that the simulation shows.
    known: R,
}

impl<S, X, R, const L: usize, const N: usize, const M: usize> Simulations<S, X, R, L, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Takes `L` simulations, all awake.
    pub fn new(runs: [Simulation<S, X, R, N, M>; L]) -> Self {
        Simulations { lanes: runs.map(|run| Lane { run, sleep: None, wait: (0, 0) }) }
    }

    /// Moves every lane on by one step of `h` (s): [`Simulation::step`]. A lane that fails stays as it was, the others have moved.
    ///
    /// # Errors
    /// Of each lane those of [`Simulation::step`].
    pub fn step(&mut self, h: R) -> [Result<(), Failure>; L] {
        self.lanes.each_mut().map(|lane| lane.step(h))
    }

    /// Changes parameters or inputs of a lane, and wakes it: [`Simulation::change`]. `None` where there is no such lane.
    pub fn change<Y>(&mut self, lane: usize, change: impl FnOnce(&mut S) -> Y) -> Option<Y> {
        let lane = self.lanes.get_mut(lane)?;
        lane.sleep = None;
        lane.wait = (0, 0);
        Some(lane.run.change(change))
    }

    /// Times (s) up to which lanes sleep; `None` for those that are awake. Where nothing depends on the time it is 35 000 years later.
    pub fn asleep_until(&self) -> [Option<R>; L] {
        self.lanes.each_ref().map(|lane| lane.sleep.map(|sleep| sleep.until))
    }

    /// A lane as it is, with the forces of the present time; `None` where there is no such lane. Of one that sleeps the forces are solved for
    /// here.
    ///
    /// # Errors
    /// Those of the method.
    pub fn read(&mut self, lane: usize) -> Option<Result<&Simulation<S, X, R, N, M>, Failure>> {
        let lane = self.lanes.get_mut(lane)?;
        Some(lane.look().map(|()| &lane.run))
    }
}

impl<S, I, F, R, const L: usize, const N: usize, const M: usize> Simulations<S, Explicit<I, F>, R, L, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// Moves every lane on to `until` (s): [`Simulation::advance_to`]. Lanes fall asleep at the end of calls.
    ///
    /// # Errors
    /// Of each lane those of [`Simulation::advance_to`].
    pub fn advance_to(&mut self, until: R) -> [Result<(), Failure>; L] {
        self.lanes.each_mut().map(|lane| lane.advance_to(until))
    }
}

impl<S, X, R, const N: usize, const M: usize> Lane<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    fn step(&mut self, h: R) -> Result<(), Failure> {
        if let Some(sleep) = self.sleep {
            let (length, rest) = self.run.length(h);
            let (from, t) = (self.run.now.t, self.run.now.t + length);
            if R::constant(0.0) < h && from < t && t <= sleep.until {
                self.run.sleep_to(t);
                self.run.clock = (t, rest);
                return Ok(());
            }
            self.wake()?;
        }
        self.run.step(h)?;
        self.fall_asleep(h);
        Ok(())
    }

    /// Solves for the forces of the present time, of a lane that sleeps.
    fn look(&mut self) -> Result<(), Failure> {
        let Some(sleep) = &mut self.sleep else { return Ok(()) };
        let t = self.run.now.t;
        if sleep.known != t {
            self.run.solve_at_rest(sleep.known)?;
            sleep.known = t;
        }
        Ok(())
    }

    fn wake(&mut self) -> Result<(), Failure> {
        self.look()?;
        self.sleep = None;
        Ok(())
    }

    /// Begins a sleep where the lane is at a stable rest, after calls of `h` (s).
    fn fall_asleep(&mut self, h: R) {
        if !self.run.may_rest() || !self.run.is_slow() {
            self.wait = (0, 0);
            return;
        }
        let (wait, tries) = self.wait;
        if 0 < wait {
            self.wait.0 = wait - 1;
            return;
        }
        let mut counts = self.run.counts;
        let rest = self.run.rest(h, &mut counts);
        self.run.counts = counts;
        let is_long = |until: R| R::constant(SHORT) * h < until - self.run.now.t;
        let tries = if rest.is_some_and(|(_, until)| is_long(until)) { 0 } else { tries + 1 };
        self.wait = ((1_u32 << tries.min(LONGEST_WAIT)) - 1, tries.min(LONGEST_WAIT));
        if let Some((now, until)) = rest {
            self.run.now = now;
            self.sleep = Some(Sleep { until, known: now.t });
        }
    }
}

impl<S, I, F, R, const N: usize, const M: usize> Lane<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        let from = self.run.now.t;
        if let Some(sleep) = self.sleep
            && from < until
        {
            self.run.sleep_to(until.min(sleep.until));
            if until <= sleep.until {
                return Ok(());
            }
        }
        self.wake()?;
        self.run.advance_to(until)?;
        self.fall_asleep(until - from);
        Ok(())
    }
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Moves the time on to `t` (s), and inputs with rates.
    fn sleep_to(&mut self, t: R) {
        let (now, counts) = (self.now, self.counts);
        self.take(&Instant { t, ..now }, None, counts);
    }

    /// Rates and forces of a state at rest since time `known` (s), and the work that the time has done on potentials since then.
    fn solve_at_rest(&mut self, known: R) -> Result<(), Failure> {
        let (t, mut y, lambda, mut counts) = (self.now.t, self.now.y, self.now.solved.lambda, self.counts);
        let model = self.model();
        let solved = self.method.solve(&model, t, &y, &lambda, &mut counts)?;
        if !S::HAS_SIGNALS && self.balanced {
            let [before, after] = [known, t].map(|t| model.total_energy(t, &y));
            y.work = y.work + after - before;
        }
        (self.now.y, self.now.solved, self.now.carried) = (y, solved, solved.rate.qd);
        self.counts = counts;
        Ok(())
    }
}

//! Runs of settings for motion from forces, timed and recorded, in any type of number.

use core::marker::PhantomData;
use std::time::{Duration, Instant};

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, Determinacy, Direction, Explicit, Extrapolated, Formulation,
    GeneralizedAlpha, Method, MethodWarning, MoreauJean, Penalty, Projection, SetValuedRow, Simulation,
    Tolerance, Unstabilized, VelocityTransformation, WithSetValuedRows,
};
use mbs_runtime::{Dynamic, DynamicState, Failure, FailureKind, Partitioned, Real};

use super::dynamics::direct_dynamics::{Pair, Rule};
use super::dynamics::integrators::Integrators;
use super::event_times::add_changes;
use super::exact::{Observed, observed};
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod, Resolution};

/// A state of a run at an instant.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Time (s).
    pub t: f64,
    /// Coordinates: N.
    pub q: Vec<f64>,
    /// Velocities: N.
    pub qd: Vec<f64>,
    /// Accelerations: N.
    pub qdd: Vec<f64>,
    /// Multipliers: M.
    pub lambda: Vec<f64>,
    /// First-order states.
    pub states: Vec<f64>,
    /// Reactions, energy, outputs.
    pub observed: Observed<f64>,
    /// Largest violation of a row in the reference metric.
    pub violation: f64,
}

/// Effort of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Right-hand sides evaluated.
    pub evaluations: u64,
    /// Corrections by projections and iterations of implicit steps: factorizations beside those of the evaluations.
    pub corrections: u64,
    /// Steps taken.
    pub steps: u64,
    /// Iterations that ended before their corrections were rounding: a warning of the run.
    pub unfinished: u64,
    /// Warning of the run about its stabilisation.
    pub warning: Option<MethodWarning>,
    /// Time of computation.
    pub elapsed: Duration,
}

impl Effort {
    /// `true` where the run itself warns of its result.
    pub fn is_warned(&self) -> bool {
        self.unfinished > 0 || self.warning.is_some()
    }
}

/// Runs of a mechanism with masses.
pub trait TimedRuns {
    /// Coordinates and velocities of the start (N each) at `t` (s).
    ///
    /// # Errors
    /// The mechanism cannot start.
    fn start(&self, t: f64) -> Result<[Vec<f64>; 2], Failure>;
    /// `true` where the method suits the mechanism.
    fn admits(&self, method: MotionMethod) -> bool;
    /// The motion through `times` (s), at equal distances; with `see` its instants are shown, without it nothing is computed
    /// beside the motion. Of fewer steps than instants, those are shown at which a step ends.
    ///
    /// # Errors
    /// Those of the run.
    fn run(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: Option<&mut dyn FnMut(Seen)>,
    ) -> Result<Effort, Failure>;
    /// `true` for each multiplier that is unique at `t` (s) and coordinates `q` (N): M. None is where that is not known.
    fn unique(&self, t: f64, q: &[f64]) -> Vec<bool>;
    /// Times (s) at which each contact closes or opens in the run of these settings, then those at which each rigid one closes, then those
    /// at which each event of the text begins or ends.
    ///
    /// # Errors
    /// Those of the run.
    fn contacts(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
    ) -> Result<Vec<Vec<f64>>, Failure>;
}

/// Kind of a run.
enum Purpose<'a> {
    /// The motion alone, or with its instants.
    Motion(See<'a>),
    /// Its changes of contacts.
    Contacts(&'a mut Vec<Vec<f64>>),
}

/// A mechanism in numbers `R`, moved by integrators of `I`.
pub struct Runs<S, I, R, const N: usize, const M: usize> {
    mechanism: S,
    kind: PhantomData<(I, R)>,
}

impl<S, I, R, const N: usize, const M: usize> Runs<S, I, R, N, M> {
    /// `mechanism` as it is.
    pub fn of(mechanism: S) -> Self {
        Runs { mechanism, kind: PhantomData }
    }
}

type AnyFormulation<'a, S, R, const N: usize, const M: usize> = &'a dyn Formulation<S, R, N, M>;
type AnyMethod<'a, S, R, const N: usize, const M: usize> = &'a dyn Method<S, R, N, M>;

/// Shows instants of a run.
type See<'a> = Option<&'a mut dyn FnMut(Seen)>;

fn seen<S, X, R, const N: usize, const M: usize>(run: &Simulation<S, X, R, N, M>) -> Seen
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    let mechanism = run.mechanism();
    let parameters = run.parameters_with_forces();
    let position = mechanism.position(&parameters, run.q(), run.t());
    let moving = DynamicState { qd: run.qd(), qdd: run.qdd(), lambda: run.lambda(), states: run.states() };
    let Observed { reaction, energy, kinetic, outputs } =
        observed(mechanism, (&parameters, &position), &moving);
    let numbers = |values: &[R]| values.iter().map(|value| value.to_f64()).collect::<Vec<f64>>();
    Seen {
        t: run.t().to_f64(),
        q: numbers(run.q()),
        qd: numbers(run.qd()),
        qdd: numbers(run.qdd()),
        lambda: numbers(run.lambda()),
        states: numbers(run.states().as_ref()),
        observed: Observed {
            reaction: numbers(&reaction),
            energy: energy.to_f64(),
            kinetic: kinetic.to_f64(),
            outputs: numbers(&outputs),
        },
        violation: run.balance().phi.to_f64(),
    }
}

/// Effort of a run in steps of `h` (s), 0 where their size is chosen by a tolerance.
fn effort<S, X, R, const N: usize, const M: usize>(
    run: &Simulation<S, X, R, N, M>,
    h: f64,
    began: Instant,
) -> Effort
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    let (elapsed, counts) = (began.elapsed(), run.counts());
    Effort {
        evaluations: counts.evaluations,
        corrections: counts.corrections + counts.iterations,
        steps: counts.steps,
        unfinished: counts.unfinished,
        warning: run.doubt(R::constant(h)),
        elapsed,
    }
}

impl<S, I, R, const N: usize, const M: usize> Runs<S, I, R, N, M>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
    I: Integrators,
    R: Real,
{
    /// Contacts and rigid ones, in the order of their lists.
    const CONTACTS: usize = S::CONTACTS.len() + if S::HAS_RIGID_CONTACTS { S::SET_VALUED.len() } else { 0 };

    fn adaptive(
        &self,
        formulation: AnyFormulation<'_, S, R, N, M>,
        integrator: I::Adaptive,
        tolerance: f64,
        times: &[f64],
        purpose: Purpose<'_>,
    ) -> Result<Effort, Failure> {
        let (first, last) = ends(times);
        let method = Explicit::new(integrator, formulation);
        let start = Simulation::start_from_text(self.mechanism.clone(), method, R::constant(first))?;
        let tolerance = Tolerance { relative: R::constant(tolerance), absolute: R::constant(tolerance) };
        let mut run = start.with_tolerance(tolerance).without_work();
        let began = Instant::now();
        let show = |run: &Simulation<S, _, R, N, M>, see: &mut dyn FnMut(Seen)| see(seen(run));
        match purpose {
            Purpose::Contacts(found) => {
                // A text without contacts compiles no search.
                if const { !S::CONTACTS.is_empty() || S::HAS_RIGID_CONTACTS } {
                    for (contact, times) in found.iter_mut().enumerate().take(Self::CONTACTS) {
                        let mut own = run.clone();
                        let gaps = Gaps::of(&own, contact);
                        while own.t() < R::constant(last)
                            && own.advance_until_event(R::constant(last), Direction::Any, |t, q, qd| {
                                gaps.at(t, q, qd)
                            })?
                        {
                            times.push(own.t().to_f64());
                        }
                    }
                }
                if const { !S::EVENTS.is_empty() } {
                    let own = found.get_mut(Self::CONTACTS..).unwrap_or_default();
                    let (mut before, mut known) = (run.clone(), Ok(()));
                    let samples = u32::try_from(times.len().saturating_sub(1)).unwrap_or(u32::MAX);
                    run.watch(R::constant(last), samples, |run| {
                        if known.is_ok() {
                            known = add_changes((&before, run), own, |run, t| run.advance_to(t));
                            before = run.clone();
                        }
                    })?;
                    known?;
                }
            }
            Purpose::Motion(Some(see)) => {
                show(&run, see);
                let samples = u32::try_from(times.len().saturating_sub(1)).unwrap_or(u32::MAX);
                run.watch(R::constant(last), samples, |run| show(run, see))?;
            }
            Purpose::Motion(None) => run.advance_to(R::constant(last))?,
        }
        Ok(effort(&run, 0.0, began))
    }

    fn fixed(
        &self,
        method: AnyMethod<'_, S, R, N, M>,
        steps: u32,
        times: &[f64],
        purpose: Purpose<'_>,
    ) -> Result<Effort, Failure> {
        let (first, last) = ends(times);
        let h = (last - first) / f64::from(steps.max(1));
        let start = Simulation::start_from_text(self.mechanism.clone(), method, R::constant(first))?;
        let mut run = start.without_work();
        let began = Instant::now();
        let see = match purpose {
            Purpose::Motion(Some(see)) => see,
            Purpose::Motion(None) => {
                run.step_to(R::constant(last), steps)?;
                return Ok(effort(&run, h, began));
            }
            Purpose::Contacts(found) => {
                let step_end = |step: u32| {
                    let end = first + (last - first) * f64::from(step) / f64::from(steps);
                    R::constant(if step == steps { last } else { end })
                };
                if const { !S::CONTACTS.is_empty() || S::HAS_RIGID_CONTACTS } {
                    for (contact, times) in found.iter_mut().enumerate().take(Self::CONTACTS) {
                        let mut own = run.clone();
                        let gaps = Gaps::of(&own, contact);
                        for step in 1..=steps {
                            let end = step_end(step);
                            while own.t() < end
                                && own
                                    .step_until_event(end, 1, Direction::Any, |t, q, qd| gaps.at(t, q, qd))?
                            {
                                times.push(own.t().to_f64());
                            }
                        }
                    }
                }
                if const { !S::EVENTS.is_empty() } {
                    let own = found.get_mut(Self::CONTACTS..).unwrap_or_default();
                    for step in 1..=steps {
                        let before = run.clone();
                        run.step_to(step_end(step), 1)?;
                        add_changes((&before, &run), own, |run, t| run.step_to(t, 1))?;
                    }
                }
                return Ok(effort(&run, h, began));
            }
        };
        see(seen(&run));
        let parts = u32::try_from(times.len().saturating_sub(1)).unwrap_or(u32::MAX).max(1);
        let (each, stride) = (steps.div_euclid(parts).max(1), parts.div_euclid(steps.max(1)).max(1));
        for time in times.iter().skip(stride as usize).step_by(stride as usize) {
            run.step_to(R::constant(*time), each)?;
            see(seen(&run));
        }
        Ok(effort(&run, h, began))
    }
}

/// The gap of one contact of a mechanism, with its drives and inputs moved on.
struct Gaps<S, R> {
    mechanism: S,
    from: R,
    contact: usize,
}

impl<S, R> Gaps<S, R> {
    fn of<X, const N: usize, const M: usize>(run: &Simulation<S, X, R, N, M>, contact: usize) -> Self
    where
        S: Dynamic<R, N, M>,
        X: Method<S, R, N, M>,
        R: Real,
    {
        Gaps { mechanism: run.mechanism().clone(), from: run.t(), contact }
    }

    fn at<const N: usize, const M: usize>(&self, t: R, q: &[R; N], qd: &[R; N]) -> R
    where
        S: Dynamic<R, N, M>,
        R: Real,
    {
        let mut mechanism = self.mechanism.clone();
        if S::HAS_SIGNALS {
            mechanism.carry_signals(&self.mechanism, t - self.from);
        }
        if !S::PHASES.is_empty() {
            mechanism.advance_phases(self.from, t);
        }
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, q, t);
        if let Some(row) = self.contact.checked_sub(S::CONTACTS.len()) {
            // Multipliers and states have no part in a gap.
            let states = mechanism.start_states(&parameters);
            let none = [R::constant(0.0); M];
            return mechanism.set_valued_rows(&parameters, &position, qd, &states, &none, GapOf(row));
        }
        let (mut index, mut found) = (0, R::constant(f64::NAN));
        mechanism.gaps(&parameters, &position, qd, |gap| {
            found = if index == self.contact { gap.gap } else { found };
            index += 1;
        });
        found
    }
}

/// The gap of a rigid contact by its index among the rows of frictions and rigid contacts; a constant for a friction.
struct GapOf(usize);

impl<R: Real, const N: usize> WithSetValuedRows<R, N> for GapOf {
    type Output = R;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> R {
        let row = rows.get(self.0).filter(|row| row.restitution.is_some());
        row.map_or(R::constant(1.0), |row| row.place)
    }
}

/// First and last of `times`.
fn ends(times: &[f64]) -> (f64, f64) {
    (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0))
}

impl<S, I, R, const N: usize, const M: usize> TimedRuns for Runs<S, I, R, N, M>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
    I: Integrators,
    R: Real,
{
    fn start(&self, t: f64) -> Result<[Vec<f64>; 2], Failure> {
        // Texts with modes start by a method that asks for no slopes.
        let projected = Explicit::new(I::rule(Rule::RungeKutta4), Projection::default());
        let method: AnyMethod<'_, S, R, N, M> = if S::HAS_MODES { &projected } else { &AugmentedLagrangian };
        let run = Simulation::start_from_text(self.mechanism.clone(), method, R::constant(t))?;
        Ok([run.q(), run.qd()].map(|values| values.iter().map(|value| value.to_f64()).collect()))
    }

    fn admits(&self, method: MotionMethod) -> bool {
        match method {
            MotionMethod::Explicit(FormulationName::VelocityTransformation, _) if !S::IS_PARTITIONED => false,
            MotionMethod::Explicit(_, IntegratorName::Radau5) => {
                I::RADAU.is_some() && S::MISSING_SLOPE.is_none()
            }
            MotionMethod::Explicit(..) => {
                M > 0
                    || matches!(
                        method,
                        MotionMethod::Explicit(
                            FormulationName::Projection | FormulationName::VelocityTransformation,
                            _
                        )
                    )
            }
            // Without rows that come and go it is semi-implicit Euler at twice the cost.
            MotionMethod::Implicit(ImplicitName::MoreauJean) => !S::SET_VALUED.is_empty(),
            MotionMethod::Implicit(_) => S::MISSING_SLOPE.is_none(),
        }
    }

    fn run(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        see: See<'_>,
    ) -> Result<Effort, Failure> {
        self.moved(method, resolution, times, Purpose::Motion(see))
    }

    fn contacts(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let mut found = vec![Vec::new(); Self::CONTACTS + S::EVENTS.len()];
        if !found.is_empty() {
            self.moved(method, resolution, times, Purpose::Contacts(&mut found))?;
        }
        Ok(found)
    }

    fn unique(&self, t: f64, q: &[f64]) -> Vec<bool> {
        let mut place = [R::constant(0.0); N];
        place.iter_mut().zip(q).for_each(|(place, q)| *place = R::constant(*q));
        let parameters = self.mechanism.parameters();
        let position = self.mechanism.position(&parameters, &place, R::constant(t));
        let found = Determinacy::<R, M>::of::<S, N>(&self.mechanism, &parameters, &position, R::constant(t));
        found.map_or_else(|_| vec![false; M], |found| found.unique.to_vec())
    }
}

impl<S, I, R, const N: usize, const M: usize> Runs<S, I, R, N, M>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
    I: Integrators,
    R: Real,
{
    /// The run of these settings, for a purpose.
    fn moved(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
        purpose: Purpose<'_>,
    ) -> Result<Effort, Failure> {
        let (baumgarte, penalty, projection) =
            (Baumgarte::default(), Penalty::default(), Projection::default());
        let formulation = |name| -> AnyFormulation<'_, S, R, N, M> {
            match name {
                FormulationName::Projection => &projection,
                FormulationName::VelocityTransformation => &VelocityTransformation,
                FormulationName::Baumgarte => &baumgarte,
                FormulationName::Penalty => &penalty,
                FormulationName::Unstabilized => &Unstabilized,
            }
        };
        match (method, resolution) {
            (MotionMethod::Explicit(name, integrator), Resolution::Tolerance(tolerance)) => {
                let pair = match integrator {
                    IntegratorName::DormandPrince5 => Some(I::pair(Pair::Order5)),
                    IntegratorName::Radau5 => I::RADAU.map(|radau| radau.0),
                    _ => Some(I::pair(Pair::Order8)),
                };
                let Some(pair) = pair else { return Err(too_large::<N, M>()) };
                self.adaptive(formulation(name), pair, tolerance, times, purpose)
            }
            (MotionMethod::Explicit(name, integrator), Resolution::Steps(steps)) => {
                let rule = match integrator {
                    IntegratorName::SemiImplicitEuler => Rule::SemiImplicitEuler,
                    _ => Rule::RungeKutta4,
                };
                let method = Explicit::new(I::rule(rule), formulation(name));
                self.fixed(&method, steps, times, purpose)
            }
            (MotionMethod::Implicit(name), resolution) => {
                let alpha = GeneralizedAlpha::default();
                let method: AnyMethod<'_, S, R, N, M> = match name {
                    ImplicitName::AugmentedLagrangian => &AugmentedLagrangian,
                    ImplicitName::Extrapolated => &Extrapolated,
                    ImplicitName::GeneralizedAlpha => &alpha,
                    ImplicitName::MoreauJean => &MoreauJean,
                };
                let Resolution::Steps(steps) = resolution else { return Err(too_large::<N, M>()) };
                self.fixed(method, steps, times, purpose)
            }
        }
    }
}

fn too_large<const N: usize, const M: usize>() -> Failure {
    FailureKind::InvalidMethodParameter {
        name: "number of coordinates and rows",
        value: (N + M) as f64,
        most: mbs_runtime::dynamics::Radau5::MOST_UNKNOWNS as f64,
    }
    .without_time()
}

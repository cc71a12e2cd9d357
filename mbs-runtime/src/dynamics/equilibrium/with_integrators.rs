//! Newton's method for a rest under integral controls: coordinates, multipliers and the states that integrate, solved together.

use crate::dynamics::equilibrium::free_stiffness::{Answer, FreeStiffness};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::integrals::Integrals;
use crate::dynamics::model::Model;
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::dynamic::{Dynamic, StateSlope};
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// K δq + Φ_qᵀ δλ − B δz = F, Φ_q δq = Φ, G δq = ż, on the motions that the rows leave free. All ranks may be deficient: of rates
/// and of forces of states that follow from others, and of the stiffness of the motions that no state has a part in.
/// Source: Benzi, Golub & Liesen 2005, §6 (null-space methods), with other columns than rows.
#[derive(Clone, Copy)]
pub(crate) struct Saddle<R, const N: usize, const M: usize, P, Z> {
    free: FreeStiffness<R, N, M>,
    integrals: Integrals<P, Z>,
    /// Combinations of the states whose forces on the free motions are orthonormal: those in `pushing`.
    pushes: P,
    /// 1 of those, 0 of combinations without effect.
    pushing: Z,
    /// Combinations of the rates whose gradients along the free motions are orthonormal: those in `leading`.
    rates: P,
    /// 1 of those, 0 of combinations that no free motion changes.
    leading: Z,
    /// Lengths of the gradients of the rates in the metric.
    slopes: Z,
    /// Lengths of the forces of a unit of each state in the metric (J).
    forces: Z,
    /// Zᵀ K Z on motions that change no rate, against forces that no state bears.
    bare: [[R; N]; N],
    /// The largest force, stiffness, or force of a state in the metric (J).
    size: R,
}

impl<R: Real, const N: usize, const M: usize, P, Z> Saddle<R, N, M, P, Z>
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    /// That of the free motions, of states that are now at `states`.
    pub(crate) fn of(
        free: FreeStiffness<R, N, M>,
        integrals: Integrals<P, Z>,
        states: &Z,
        scales: &[R; N],
    ) -> Self {
        let (mut pushes, mut rates) = (integrals.pushes, integrals.rates);
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        for (place, row) in rates.as_mut().iter_mut().enumerate() {
            for (index, entry) in row.states.as_mut().iter_mut().enumerate() {
                *entry = if index == place { one } else { zero };
            }
        }
        let (mut slopes, mut forces) = (integrals.values, integrals.values);
        reduce(&mut pushes, &mut forces, &free, scales);
        reduce(&mut rates, &mut slopes, &free, scales);
        let pushing = orthonormalize(&mut pushes, &integrals.values);
        let leading = orthonormalize(&mut rates, &integrals.values);
        // Column by column: what a free motion that changes no rate meets.
        let mut bare = [[zero; N]; N];
        for index in 0..N {
            let along = beside(&unit(index), &rates, &leading);
            let met = beside(&times(&free.reduced, &along), &pushes, &pushing);
            for (row, met) in bare.iter_mut().zip(&met) {
                row.iter_mut().skip(index).take(1).for_each(|entry| *entry = *met);
            }
        }
        let borne = states.as_ref().iter().zip(forces.as_ref()).map(|(state, force)| (*state * *force).abs());
        let size = borne.fold(free.size, |size, borne| size.max(borne));
        Saddle { free, integrals, pushes, pushing, rates, leading, slopes, forces, bare, size }
    }

    /// Newton step for `imbalance` (N) and residuals `phi` (M) of the rows at the present rates; and the step of the states.
    pub(crate) fn answer(&self, imbalance: &[R; N], phi: &[R; M]) -> (Answer<R, N, M>, Z) {
        let (zero, one, free) = (R::constant(0.0), R::constant(1.0), &self.free);
        let closing = free.factors.solve(&[zero; N], phi).0;
        let open = imbalance.plus(-one, &[1.0], [&times(&free.stiffness, &closing)]);
        let wanted = free.motions.map(|motion| dot(&motion, &open));
        let mut left = self.integrals.values;
        for (left, row) in left.as_mut().iter_mut().zip(self.integrals.rates.as_ref()) {
            *left = *left - dot(&row.q, &closing);
        }
        let mut led = [zero; N];
        for row in chosen(&self.rates, &self.leading) {
            let share = combined(&row.states, &left);
            led.iter_mut().zip(&row.q).for_each(|(sum, part)| *sum = *sum + share * *part);
        }
        let short = wanted.plus(-one, &[1.0], [&times(&free.reduced, &led)]);
        let short = beside(&short, &self.pushes, &self.pushing);
        let found = beside(&free.shortest(&self.bare, &short), &self.rates, &self.leading);
        let w = led.plus(one, &[1.0], [&found]);
        let short = wanted.plus(-one, &[1.0], [&times(&free.reduced, &w)]);
        let states = self.bearing(&short);
        let unborne = beside(&short, &self.pushes, &self.pushing);
        let push = dot(&unborne, &unborne).sqrt();
        let step = closing.plus(one, &[1.0], [&free.moved(&w)]);
        let mut rest = imbalance.plus(-one, &[1.0], [&times(&free.stiffness, &step)]);
        for (pushed, state) in self.integrals.pushes.as_ref().iter().zip(states.as_ref()) {
            rest.iter_mut().zip(&pushed.q).for_each(|(sum, part)| *sum = *sum + *part * *state);
        }
        let mut unled = beside(&unborne, &self.rates, &self.leading);
        // Rounding, where every motion along the force changes a rate.
        if dot(&unled, &unled).sqrt() <= forces::NO_STIFFNESS.of::<R>() * push {
            unled = [zero; N];
        }
        let push = if (forces::NO_STIFFNESS.of::<R>() * self.size).less(push) { push } else { zero };
        let answer = Answer {
            step,
            change: free.factors.solve(&rest, &[zero; M]).1,
            unanswered: free.moved(&unled),
            push,
            pull: free.moved(&unborne),
            imbalance: push,
        };
        (answer, states)
    }

    /// The step of the states that balances `short` (N) on the free motions, as far as they push.
    fn bearing(&self, short: &[R; N]) -> Z {
        let mut states = self.integrals.values;
        states.as_mut().iter_mut().for_each(|state| *state = R::constant(0.0));
        for push in chosen(&self.pushes, &self.pushing) {
            let share = dot(&push.q, short);
            let parts = states.as_mut().iter_mut().zip(push.states.as_ref());
            parts.for_each(|(sum, part)| *sum = *sum - share * *part);
        }
        states
    }

    /// `true` if the forces of a step of the states are small compared with the others.
    pub(crate) fn stand(&self, step: &Z) -> bool {
        let mut parts = step.as_ref().iter().zip(self.forces.as_ref());
        parts.all(|(step, force)| (*step * *force).abs() <= forces::INTEGRAND.of::<R>() * self.size)
    }

    /// Index of the first state without a force of its own, if the states have fewer forces than rates to be held at 0.
    pub(crate) fn idle(&self) -> Option<usize> {
        let zero = R::constant(0.0);
        let count = |marks: &Z| marks.as_ref().iter().filter(|mark| zero < **mark).count();
        if count(&self.leading) <= count(&self.pushing) {
            return None;
        }
        let mut places = self.pushing.as_ref().iter().enumerate();
        places.position(|(place, pushing)| self.moves(place) && *pushing == zero)
    }

    /// `true` if the state at `place` moves by itself.
    fn moves(&self, place: usize) -> bool {
        let push = self.integrals.pushes.as_ref().get(place);
        push.is_some_and(|push| push.entry(place) != R::constant(0.0))
    }

    /// Distance of `y` with the multipliers `lambda` (M) from an equilibrium: forces, rows and rates over their scales here.
    pub(crate) fn distance<S>(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, Z>,
        lambda: &[R; M],
    ) -> R
    where
        S: Dynamic<R, N, M, States = Z>,
    {
        let (zero, position) = (R::constant(0.0), model.position(t, y));
        let model = &Model { parameters: &model.sprung(&position, y, lambda), ..*model };
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let mut sum = zero;
        let mut add = |value: R, scale: R| {
            let share = if zero < scale { value / scale } else { zero };
            sum = sum + share * share;
        };
        let imbalance = model.imbalance(&position, y, &[zero; N], (lambda, lambda));
        for (force, scale) in imbalance.iter().zip(&model.metric.coordinates) {
            add(*force * *scale, self.size);
        }
        let phi = mechanism.phi(parameters, &position);
        phi.iter().zip(&model.metric.rows).for_each(|(phi, scale)| add(*phi, *scale));
        let rates = mechanism.state_rates(parameters, &position, &y.qd, &y.states, lambda);
        rates.as_ref().iter().zip(self.slopes.as_ref()).for_each(|(rate, slope)| add(*rate, *slope));
        sum.sqrt()
    }

    /// Coordinates (N), and states (1 of those), that move without any force or rate changing.
    pub(crate) fn indifferent(&self, scales: &[R; N]) -> ([bool; N], Z) {
        let (one, share) = (R::constant(1.0), forces::INDIFFERENT.of::<R>());
        let (mut indifferent, mut states) = ([false; N], self.integrals.values);
        for (place, mark) in states.as_mut().iter_mut().enumerate() {
            *mark = if self.changes_nothing(place) { one } else { R::constant(0.0) };
        }
        for index in 0..self.free.freedom {
            let along = beside(&unit(index), &self.rates, &self.leading);
            let answered = self.free.shortest(&self.bare, &times(&self.bare, &along));
            let answered = beside(&answered, &self.rates, &self.leading);
            let slack = along.plus(-one, &[1.0], [&answered]);
            let motion = self.free.moved(&slack);
            for ((mark, part), scale) in indifferent.iter_mut().zip(&motion).zip(scales) {
                *mark |= share.less((*part / *scale).abs());
            }
            let borne = self.bearing(&times(&self.free.reduced, &slack));
            let parts = borne.as_ref().iter().zip(self.forces.as_ref());
            for (mark, (part, force)) in states.as_mut().iter_mut().zip(parts) {
                let moves = (share * self.size).less((*part * *force).abs());
                *mark = if moves { one } else { *mark };
            }
        }
        self.follow(&mut states);
        (indifferent, states)
    }

    /// `true` if the state at `place` is part of a combination without effect.
    fn changes_nothing(&self, place: usize) -> bool {
        let zero = R::constant(0.0);
        let weight = |place: usize| {
            let force = self.forces.as_ref().get(place).copied().unwrap_or(zero);
            if zero < force { force } else { R::constant(1.0) }
        };
        let mut combinations = self.pushes.as_ref().iter().zip(self.pushing.as_ref()).enumerate();
        self.moves(place)
            && combinations.any(|(index, (push, pushing))| {
                // A combination starts as one part of its own state.
                self.moves(index)
                    && *pushing == zero
                    && forces::INDIFFERENT.of::<R>().less((push.entry(place) * weight(place)).abs())
            })
    }

    /// Marks the states that follow those in `states`.
    fn follow(&self, states: &mut Z) {
        let (zero, marked) = (R::constant(0.0), *states);
        for (push, mark) in self.integrals.pushes.as_ref().iter().zip(marked.as_ref()) {
            for (state, share) in states.as_mut().iter_mut().zip(push.states.as_ref()) {
                *state = if zero < *mark && *share != zero { *mark } else { *state };
            }
        }
    }
}

/// Before: vectors (N) in the place of `q`. After: their parts along the free motions, and their combinations, over their
/// lengths in the metric, which are in `lengths`.
fn reduce<R: Real, const N: usize, const M: usize, Z, P>(
    rows: &mut P,
    lengths: &mut Z,
    free: &FreeStiffness<R, N, M>,
    scales: &[R; N],
) where
    Z: AsRef<[R]> + AsMut<[R]>,
    P: AsMut<[StateSlope<R, N, Z>]>,
{
    let zero = R::constant(0.0);
    for (row, length) in rows.as_mut().iter_mut().zip(lengths.as_mut()) {
        let mut scaled = row.q;
        scaled.iter_mut().zip(scales).for_each(|(entry, scale)| *entry = *entry * *scale);
        *length = dot(&scaled, &scaled).sqrt();
        if zero < *length {
            row.scale(R::constant(1.0) / *length);
        }
        let whole = row.q;
        row.q = free.motions.map(|motion| dot(&motion, &whole));
    }
}

/// Makes the rows orthonormal, the longest remaining one first, with their combinations; lengths start at 1 and less. Returns 1
/// in the place of each, 0 where nothing of its own is left; `like` for the shape.
fn orthonormalize<R: Real, const N: usize, Z, P>(rows: &mut P, like: &Z) -> Z
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let mut done = *like;
    done.as_mut().iter_mut().for_each(|done| *done = zero);
    for _ in 0..like.as_ref().len() {
        let mut best = (forces::NO_STIFFNESS.of::<R>(), None);
        for (index, (row, done)) in rows.as_ref().iter().zip(done.as_ref()).enumerate() {
            let length = dot(&row.q, &row.q).sqrt();
            if *done == zero && best.0 < length {
                best = (length, Some(index));
            }
        }
        let Some(index) = best.1 else { break };
        let Some(mut pivot) = rows.as_ref().get(index).copied() else { break };
        pivot.scale(one / best.0);
        for (other, (row, done)) in rows.as_mut().iter_mut().zip(done.as_mut()).enumerate() {
            if other == index {
                (*row, *done) = (pivot, one);
            } else if *done == zero {
                // Twice, for what rounding leaves of the first time.
                for _ in 0..2 {
                    let along = dot(&row.q, &pivot.q);
                    row.subtract(along, &pivot);
                }
            }
        }
    }
    done
}

/// The rows that are marked.
fn chosen<'a, R: Real, const N: usize, Z, P>(
    rows: &'a P,
    marks: &'a Z,
) -> impl Iterator<Item = &'a StateSlope<R, N, Z>>
where
    Z: AsRef<[R]> + 'a,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    let marked = rows.as_ref().iter().zip(marks.as_ref());
    marked.filter(|(_, mark)| R::constant(0.0) < **mark).map(|(row, _)| row)
}

/// `vector` (N) without its parts along the rows that are marked.
fn beside<R: Real, const N: usize, Z, P>(vector: &[R; N], rows: &P, marks: &Z) -> [R; N]
where
    Z: AsRef<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    let mut left = *vector;
    for row in chosen(rows, marks) {
        let along = dot(&left, &row.q);
        left.iter_mut().zip(&row.q).for_each(|(entry, part)| *entry = *entry - along * *part);
    }
    left
}

/// Σ shareₖ valueₖ.
fn combined<R: Real, Z: AsRef<[R]>>(shares: &Z, values: &Z) -> R {
    let parts = shares.as_ref().iter().zip(values.as_ref());
    parts.fold(R::constant(0.0), |sum, (share, value)| sum + *share * *value)
}

/// The unit vector (N) at `index`.
fn unit<R: Real, const N: usize>(index: usize) -> [R; N] {
    let mut unit = [R::constant(0.0); N];
    unit.iter_mut().skip(index).take(1).for_each(|component| *component = R::constant(1.0));
    unit
}

//! Motions that constraints leave free along a motion, without those that set-valued rows hold: R, Ṙ and R̈.
//!
//! Constraints alone leave motions f with coefficients c: r = Σ c f. Rows that hold, J q̇ + ∂s/∂t = 0, give each of these for as many
//! coefficients as there are rows, with those of the others 1 or 0. Their rates follow from J ṙ = −J̇ r and J r̈ = γ_q r + γ_q̇ ṙ − (J q̈)_q r,
//! as they do for constraints.

use crate::dynamics::formulations::set_valued::sticks;
use crate::dynamics::formulations::variation::{DIFFERENCE, FreeMotion, PREFERRED, Variation};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::Model;
use crate::linear_algebra::parts::{at, identity};
use crate::linear_algebra::vectors::{Each, dot};
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::set_valued;

/// Free motions of a state, each in the place of its independent coordinate, and which coordinates these are: N each.
pub(super) type FreeMotions<R, const N: usize> = ([FreeMotion<R, N>; N], [bool; N]);

/// The free motions of a state that moves, with what set-valued rows hold.
pub(super) struct AlongMotion<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub model: &'a Model<'a, S, R, N, M>,
    pub t: R,
    pub y: &'a IntegratorState<R, N, S::States>,
    pub qdd: &'a [R; N],
    pub lambda: &'a [R; M],
    pub variation: &'a Variation<'a, S, R, N, M>,
    /// Coordinates that are independent as far as they determine the others.
    pub preferred: &'a [u16],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> AlongMotion<'_, S, R, N, M> {
    /// Those of the constraints alone.
    pub(super) fn free_motions(&self) -> FreeMotions<R, N> {
        let (zero, independent) = (R::constant(0.0), self.variation.independent);
        let rest = FreeMotion { place: [zero; N], rate: [zero; N], acceleration: [zero; N] };
        let mut motions = [rest; N];
        for (index, motion) in
            motions.iter_mut().enumerate().filter(|(index, _)| marked(&independent, *index))
        {
            *motion = self.variation.motion(index);
        }
        (motions, independent)
    }
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for AlongMotion<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = FreeMotions<R, N>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (zero, modes) = (R::constant(0.0), S::set_valued_modes(self.model.parameters));
        let rest = FreeMotion { place: [zero; N], rate: [zero; N], acceleration: [zero; N] };
        let (motions, mut independent) = self.free_motions();
        let mut held = [false; K];
        held.iter_mut().zip(modes).for_each(|(held, mode)| *held = sticks(mode));
        let along = Held { of: &self, rows, mask: held };
        let taken = along.eliminated(&motions, &mut independent);
        let mut free = [rest; N];
        for (index, free) in free.iter_mut().enumerate().filter(|(index, _)| marked(&independent, *index)) {
            if let Some(motion) = motions.get(index) {
                *free = along.completed(motion, &motions, &taken);
            }
        }
        (free, independent)
    }
}

fn marked(marks: &[bool], index: usize) -> bool {
    marks.get(index) == Some(&true)
}

/// Rows that hold, solved for the coefficients of as many motions.
struct Taken<R, const K: usize> {
    /// The motion that each row takes, by its independent coordinate; none of a row that follows from others.
    motions: [Option<usize>; K],
    /// Coefficients by values of the rows: K rows of K.
    inverse: [[R; K]; K],
}

/// Rows that hold along a motion.
struct Held<'a, 'b, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize> {
    of: &'a AlongMotion<'b, S, R, N, M>,
    rows: &'a [SetValuedRow<R, N>; K],
    mask: [bool; K],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize>
    Held<'_, '_, S, R, N, M, K>
{
    /// Takes a motion for each row, by elimination with the largest pivots of all; those that are taken are independent no more.
    fn eliminated(&self, motions: &[FreeMotion<R, N>; N], independent: &mut [bool; N]) -> Taken<R, K> {
        let zero = R::constant(0.0);
        let mut left = [[zero; N]; K];
        for ((line, row), _) in left.iter_mut().zip(self.rows).zip(&self.mask).filter(|(_, held)| **held) {
            for (index, (entry, motion)) in line.iter_mut().zip(motions).enumerate() {
                *entry = if marked(independent, index) { dot(&row.gradient, &motion.place) } else { zero };
            }
        }
        let mut taken = Taken { motions: [None; K], inverse: identity::<R, K>() };
        let scales = &self.of.model.metric.coordinates;
        let weight = |index: usize| {
            let preferred = self.of.preferred.iter().any(|preferred| usize::from(*preferred) == index);
            at(scales, index) * R::constant(if preferred { PREFERRED } else { 1.0 })
        };
        let sizes = self.rows.map(|row| {
            row.gradient.iter().zip(scales).fold(zero, |sum, (entry, scale)| sum + (*entry * *scale).abs())
        });
        for _ in 0..K {
            let mut best = (None, zero);
            for (row, (line, motion)) in left.iter().zip(&taken.motions).enumerate() {
                for (column, entry) in line.iter().enumerate().filter(|_| motion.is_none()) {
                    let size = entry.abs() * at(scales, column);
                    let counts = marked(independent, column)
                        && set_valued::DEPENDENT.of::<R>() * at(&sizes, row) < size;
                    let pivot = entry.abs() * weight(column) / at(&sizes, row);
                    if counts && best.1 < pivot {
                        best = (Some((row, column)), pivot);
                    }
                }
            }
            let Some((row, column)) = best.0 else { break };
            independent.iter_mut().skip(column).take(1).for_each(|mark| *mark = false);
            taken.motions.iter_mut().skip(row).take(1).for_each(|motion| *motion = Some(column));
            let pivot = left.get(row).map_or(zero, |line| at(line, column));
            left.iter_mut().skip(row).take(1).flatten().for_each(|entry| *entry = *entry / pivot);
            taken.inverse.iter_mut().skip(row).take(1).flatten().for_each(|entry| *entry = *entry / pivot);
            let (Some(line), Some(answer)) = (left.get(row).copied(), taken.inverse.get(row).copied()) else {
                break;
            };
            for (index, (other, inverse)) in left.iter_mut().zip(&mut taken.inverse).enumerate() {
                if index != row {
                    let share = at(other, column);
                    *other = other.plus(-share, &[1.0], [&line]);
                    *inverse = inverse.plus(-share, &[1.0], [&answer]);
                }
            }
        }
        taken
    }

    /// A motion with those added that rows take, so that it keeps them.
    fn completed(
        &self,
        motion: &FreeMotion<R, N>,
        motions: &[FreeMotion<R, N>; N],
        taken: &Taken<R, K>,
    ) -> FreeMotion<R, N> {
        let (qd, qdd, none) = (&self.of.y.qd, self.of.qdd, [R::constant(0.0); N]);
        let one = R::constant(1.0);
        let open = |x: &[R; N], right: &[R; K]| {
            let mut open = *right;
            open.iter_mut().zip(self.rows).for_each(|(open, row)| *open = *open - dot(&row.gradient, x));
            taken.inverse.map(|line| dot(&line, &open))
        };
        let with = |base: [R; N], shares: &[R; K], part: fn(&FreeMotion<R, N>) -> &[R; N], factor: f64| {
            let mut sum = base;
            for (share, motion) in shares.iter().zip(&taken.motions) {
                if let Some(motion) = motion.and_then(|index| motions.get(index)) {
                    sum = sum.plus(*share, &[factor], [part(motion)]);
                }
            }
            sum
        };
        let shares = open(&motion.place, &[R::constant(0.0); K]);
        let place = with(motion.place, &shares, |motion| &motion.place, 1.0);
        let base = with(motion.rate, &shares, |motion| &motion.rate, 1.0);
        let turning = open(&base, &self.rate(qd, &place).each(|value| -value));
        let rate = with(base, &turning, |motion| &motion.place, 1.0);
        let base = with(motion.acceleration, &shares, |motion| &motion.acceleration, 1.0);
        let base = with(base, &turning, |motion| &motion.rate, 2.0);
        let bent = self.rate(qdd, &place).plus(-one, &[1.0], [&self.rate(&none, &place)]);
        let right = self.gamma_along(&place).plus(-one, &[2.0, 1.0], [&self.rate(qd, &rate), &bent]);
        let bending = open(&base, &right);
        FreeMotion { place, rate, acceleration: with(base, &bending, |motion| &motion.place, 1.0) }
    }

    /// γ of the rows at coordinates and velocities (N).
    fn gamma(&self, q: &[R; N], qd: &[R; N]) -> [R; K] {
        let AlongMotion { model, t, y, lambda, .. } = self.of;
        let position = model.mechanism.position(model.parameters, q, *t);
        let mut gammas = [R::constant(0.0); K];
        model.mechanism.set_valued_rows(
            model.parameters,
            &position,
            qd,
            &y.states,
            lambda,
            Gammas(&mut gammas),
        );
        gammas
    }

    /// (J v)_q r + J_t r, from γ(v + r) − γ(v − r) = −4 times it, r made as long as v.
    fn rate(&self, v: &[R; N], r: &[R; N]) -> [R; K] {
        let (speed, length) = (self.of.variation.length(v), self.of.variation.length(r));
        let alike = R::constant(0.0).less(speed) && R::constant(0.0).less(length);
        let share = if alike { speed / length } else { R::constant(1.0) };
        let ahead = self.gamma(&self.of.y.q, &v.plus(share, &[1.0], [r]));
        let behind = self.gamma(&self.of.y.q, &v.plus(share, &[-1.0], [r]));
        let factor = R::constant(-0.25) / share;
        ahead.plus(R::constant(-1.0), &[1.0], [&behind]).each(|difference| factor * difference)
    }

    /// γ_q r.
    fn gamma_along(&self, r: &[R; N]) -> [R; K] {
        let reach = R::EPSILON.sqrt().sqrt().sqrt() / self.of.variation.length(r);
        let mut sum = [R::constant(0.0); K];
        for (steps, weight) in DIFFERENCE {
            let share = R::constant(steps) * reach;
            let at = |share: R| self.gamma(&self.of.y.q.plus(share, &[1.0], [r]), &self.of.y.qd);
            let (ahead, behind) = (at(share), at(-share));
            sum = sum.plus(R::constant(weight), &[1.0, -1.0], [&ahead, &behind]);
        }
        sum.each(|sum| sum / (R::constant(60.0) * reach))
    }
}

/// Copies γ of rows.
struct Gammas<'a, R, const L: usize>(&'a mut [R; L]);

impl<R: Real, const N: usize, const L: usize> WithSetValuedRows<R, N> for Gammas<'_, R, L> {
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) {
        self.0.iter_mut().zip(rows).for_each(|(to, row)| *to = row.gamma);
    }
}

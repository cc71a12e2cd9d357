//! Tests of a step that is not quick.

use crate::kinematics::homotopy::{LARGEST_APPROACH, LARGEST_SECOND_ORDER_TERM};
use crate::kinematics::link_lengths;
use crate::scalar::number::Scalar;
use crate::stepper::fast_step::{FastStep, QUICK_SECOND_ORDER_TERM, Start, largest_size, quick, trusted};
use crate::stepper::instant::is_coarse;
use crate::tolerances::singular;

/// Answers about a step that is not quick.
pub(crate) struct Judgement<T: Scalar> {
    /// Lanes whose step passed all tests of one next to a regular position. The others are stepped with safeguards.
    pub plain: T::Mask,
    /// Lanes whose remaining residual is seen in the accelerations.
    pub coarse: T::Mask,
    /// Lanes in which a link much shorter than the reference length may have turned far: [`FastStep::settles`] tells.
    pub doubtful: T::Mask,
}

impl<T: Scalar, const N: usize> FastStep<T, N> {
    /// Answers about a step from `start` to `t` that is not quick, `with_lengths` among the coordinates or without.
    #[cold]
    #[inline(never)]
    pub(crate) fn judgement(
        &self,
        start: &Start<'_, T, N>,
        t: T,
        scales: &[T; N],
        with_lengths: bool,
    ) -> Judgement<T> {
        let [most_second, most_way] = quick::<T::Real>(with_lengths);
        let h = t - start.t;
        let half_square = T::constant(0.5) * h * h;
        let (mut foreseen, mut near) = (T::mask(true), T::mask(true));
        for (acceleration, scale) in start.qdd.iter().zip(scales) {
            let second = half_square * *acceleration;
            foreseen = foreseen & trusted(second, *scale, LARGEST_SECOND_ORDER_TERM);
            near = near & trusted(second, *scale, most_second);
        }
        // Written so that NaN is not plain.
        Judgement {
            plain: self.is_sound()
                & foreseen
                & self.correction.less(T::constant(LARGEST_APPROACH) * self.margin),
            coarse: is_coarse(self.residual, self.margin),
            doubtful: !near | !self.correction.less(T::constant(most_way) * self.margin),
        }
    }

    /// Lanes that are solved, regular at both ends, finite, on their branches and within their limits.
    fn is_sound(&self) -> T::Mask {
        self.held & singular::ZONE.of::<T>().less(self.margin) & self.size.less(largest_size())
    }

    /// `true` if the links of a doubtful step from `start` to `t` turned as predicted, so little that the assembly is kept.
    #[inline(always)] // for the points are known where it is asked
    pub(crate) fn settles(
        &self,
        metric: (&link_lengths::Points<N>, &[T; N]),
        start: &Start<'_, T, N>,
        t: T,
    ) -> T::Mask {
        let h = t - start.t;
        let half_square = T::constant(0.5) * h * h;
        let (mut off, mut near) = (self.q, T::mask(true));
        let [q, qd, qdd] = start.rates();
        let before = q.iter().zip(qd.iter().zip(qdd)).zip(metric.1);
        for (off, ((place, (rate, acceleration)), scale)) in off.iter_mut().zip(before) {
            let second = half_square * *acceleration;
            near = near & trusted(second, *scale, QUICK_SECOND_ORDER_TERM);
            *off = *off - (*place + h * *rate + second);
        }
        let least = [link_lengths::least(self.margin); N];
        let little = link_lengths::turn_little(metric, [start.qd, start.qdd, &self.qd], h, least);
        let foreseen = link_lengths::are_foreseen(metric, &off, [start.qd, start.qdd], (h, self.margin));
        (near | little) & foreseen
    }

    /// `true` only if the step passes all tests of [`judgement`](Self::judgement) and [`settles`](Self::settles), and is not coarse: one
    /// that ends at its prediction, whose second-order terms alone are not small. Each coordinate of a point is compared by itself,
    /// which takes a fraction of the operations and may refuse more.
    #[inline(always)]
    pub(crate) fn is_steady(
        &self,
        (points, scales): (&link_lengths::Points<N>, &[T; N]),
        start: &Start<'_, T, N>,
        t: T,
    ) -> T::Mask {
        let h = t - start.t;
        let (square, least) = (h * h, link_lengths::least(self.margin));
        let mut all = self.is_sound() & !is_coarse(self.residual, self.margin) & self.correction.less(least);
        let rates = start.qd.iter().zip(start.qdd).zip(&self.qd);
        for (((before, change), after), (scale, point)) in rates.zip(scales.iter().zip(points)) {
            let change = square * *change;
            all = all & trusted(change, *scale, 2.0 * LARGEST_SECOND_ORDER_TERM);
            if point.is_some() {
                let moved = [h * *before, change, h * *after];
                all = all & link_lengths::turns_little(moved, least * *scale);
            }
        }
        all
    }
}

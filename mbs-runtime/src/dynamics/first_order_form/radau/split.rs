//! LU factors of a matrix of numbers in split parts: of PARTS = 1 real, of PARTS = 2 real and imaginary part.
//!
//! A row holds its parts one after the other, so that a multiple of one is taken off another by loops over plain arrays.

use crate::linear_algebra::vectors::of_each;
use crate::scalar::number::Real;

/// A number by its parts.
pub(super) type Number<R, const PARTS: usize> = [R; PARTS];

/// The parts of L numbers.
pub(super) type Numbers<R, const L: usize, const PARTS: usize> = [[R; L]; PARTS];

/// LU factors with partial pivoting, pivots by |re| + |im|.
///
/// Source: Golub & Van Loan 2013, §3.4.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitLu<R, const N: usize, const PARTS: usize> {
    rows: [Numbers<R, N, PARTS>; N],
    /// The reciprocals of the pivots.
    reciprocals: [Number<R, PARTS>; N],
    /// The row that was brought up for each column.
    pivots: [usize; N],
}

impl<R: Real, const N: usize, const PARTS: usize> SplitLu<R, N, PARTS> {
    /// Factors of `rows`; none where a pivot is 0 or no number.
    pub(super) fn factorize(rows: [Numbers<R, N, PARTS>; N]) -> Option<Self> {
        let mut lu = SplitLu { rows, reciprocals: [[R::constant(0.0); PARTS]; N], pivots: [0; N] };
        for k in 0..N {
            let found = lu.pivot(k);
            exchange(&mut lu.rows, k, found);
            let pivot = *lu.rows.get(k)?;
            let reciprocal = reciprocal(entry(&pivot, k));
            if !reciprocal.iter().all(|part| part.is_finite()) {
                return None;
            }
            *lu.reciprocals.get_mut(k)? = reciprocal;
            *lu.pivots.get_mut(k)? = found;
            for row in lu.rows.iter_mut().skip(k + 1) {
                let multiplier = product(entry(row, k), reciprocal);
                // Most entries of a mechanism's matrices are zero.
                if multiplier.iter().any(|part| *part != R::constant(0.0)) {
                    subtract(row, multiplier, &pivot, k + 1);
                }
                put(row, k, multiplier);
            }
        }
        Some(lu)
    }

    /// The row from `k` on with the largest entry in column `k`.
    fn pivot(&self, k: usize) -> usize {
        let mut best = (k, R::constant(-1.0));
        for (index, row) in self.rows.iter().enumerate().skip(k) {
            let size = entry(row, k).iter().fold(R::constant(0.0), |size, part| size + part.abs());
            if best.1 < size {
                best = (index, size);
            }
        }
        best.0
    }

    /// The solution for the right-hand side `x`.
    pub(super) fn solve(&self, mut x: Numbers<R, N, PARTS>) -> Numbers<R, N, PARTS> {
        for (k, found) in self.pivots.iter().enumerate() {
            let (one, other) = (entry(&x, k), entry(&x, *found));
            put(&mut x, k, other);
            put(&mut x, *found, one);
        }
        for (k, row) in self.rows.iter().enumerate() {
            let value = less(entry(&x, k), sum(row, &x, 0, k));
            put(&mut x, k, value);
        }
        for (k, (row, reciprocal)) in self.rows.iter().zip(&self.reciprocals).enumerate().rev() {
            let value = product(less(entry(&x, k), sum(row, &x, k + 1, N)), *reciprocal);
            put(&mut x, k, value);
        }
        x
    }
}

/// Entry `k`; 0 where there is none.
#[inline(always)]
pub(super) fn entry<R: Real, const L: usize, const PARTS: usize>(
    row: &Numbers<R, L, PARTS>,
    k: usize,
) -> Number<R, PARTS> {
    of_each(row, |part| part.get(k).copied().unwrap_or(R::constant(0.0)))
}

#[inline(always)]
fn put<R: Real, const L: usize, const PARTS: usize>(
    row: &mut Numbers<R, L, PARTS>,
    k: usize,
    value: Number<R, PARTS>,
) {
    for (part, value) in row.iter_mut().zip(value) {
        if let Some(place) = part.get_mut(k) {
            *place = value;
        }
    }
}

fn exchange<X: Copy>(rows: &mut [X], first: usize, second: usize) {
    if let (Some(one), Some(other)) = (rows.get(first).copied(), rows.get(second).copied()) {
        rows.iter_mut().skip(first).take(1).for_each(|row| *row = other);
        rows.iter_mut().skip(second).take(1).for_each(|row| *row = one);
    }
}

/// a b.
#[inline(always)]
pub(super) fn product<R: Real, const PARTS: usize>(
    a: Number<R, PARTS>,
    b: Number<R, PARTS>,
) -> Number<R, PARTS> {
    let mut result = [R::constant(0.0); PARTS];
    match (result.as_mut_slice(), a.as_slice(), b.as_slice()) {
        ([re], [a], [b]) => *re = *a * *b,
        ([re, im], [a, a_im], [b, b_im]) => {
            *re = *a * *b - *a_im * *b_im;
            *im = *a * *b_im + *a_im * *b;
        }
        _ => {}
    }
    result
}

#[inline(always)]
fn less<R: Real, const PARTS: usize>(mut a: Number<R, PARTS>, b: Number<R, PARTS>) -> Number<R, PARTS> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a = *a - b);
    a
}

/// 1/a by Smith's formula, which neither overflows nor underflows before its result does; not finite where a is 0.
pub(super) fn reciprocal<R: Real, const PARTS: usize>(a: Number<R, PARTS>) -> Number<R, PARTS> {
    let one = R::constant(1.0);
    let mut result = [R::constant(0.0); PARTS];
    match (result.as_mut_slice(), a.as_slice()) {
        ([re], [a]) => *re = one / *a,
        ([re, im], [a, b]) => {
            let large = b.abs() <= a.abs();
            let (main, other) = if large { (*a, *b) } else { (*b, *a) };
            let ratio = other / main;
            let factor = one / (main + other * ratio);
            (*re, *im) = if large { (factor, -(ratio * factor)) } else { (ratio * factor, -factor) };
        }
        _ => {}
    }
    result
}

/// `row` − `multiplier` · `pivot` from entry `from` on.
#[inline(always)]
fn subtract<R: Real, const L: usize, const PARTS: usize>(
    row: &mut Numbers<R, L, PARTS>,
    multiplier: Number<R, PARTS>,
    pivot: &Numbers<R, L, PARTS>,
    from: usize,
) {
    match (row.as_mut_slice(), multiplier.as_slice(), pivot.as_slice()) {
        ([row], [multiplier], [pivot]) => {
            let pairs = row.iter_mut().zip(pivot).skip(from);
            pairs.for_each(|(entry, above)| *entry = *entry - *multiplier * *above);
        }
        ([re, im], [m_re, m_im], [p_re, p_im]) => {
            let entries = re.iter_mut().zip(im).zip(p_re.iter().zip(p_im)).skip(from);
            for ((re, im), (p_re, p_im)) in entries {
                *re = *re - (*m_re * *p_re - *m_im * *p_im);
                *im = *im - (*m_re * *p_im + *m_im * *p_re);
            }
        }
        _ => {}
    }
}

/// Σ of the products of entries `from` .. `to`.
#[inline(always)]
fn sum<R: Real, const L: usize, const PARTS: usize>(
    row: &Numbers<R, L, PARTS>,
    x: &Numbers<R, L, PARTS>,
    from: usize,
    to: usize,
) -> Number<R, PARTS> {
    let mut result = [R::constant(0.0); PARTS];
    match (result.as_mut_slice(), row.as_slice(), x.as_slice()) {
        ([sum], [row], [x]) => {
            for (a, b) in row.iter().zip(x).take(to).skip(from) {
                *sum = *sum + *a * *b;
            }
        }
        ([re, im], [a_re, a_im], [b_re, b_im]) => {
            let pairs = a_re.iter().zip(a_im).zip(b_re.iter().zip(b_im)).take(to).skip(from);
            for ((a_re, a_im), (b_re, b_im)) in pairs {
                *re = *re + (*a_re * *b_re - *a_im * *b_im);
                *im = *im + (*a_re * *b_im + *a_im * *b_re);
            }
        }
        _ => {}
    }
    result
}

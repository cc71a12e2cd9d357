//! v = φ(c + B v): systems of absolute values and norms, solved and their solutions counted.
//!
//! The systems are those of friction: v holds the normal forces, B their effect on each other. `φ` takes the absolute value
//! of one component, or the norm of two. It is homogeneous, φ(w) = u(w) w with u the sign or the direction. So Newton's step
//! solves (I − u B) v = u c and ends, without a tolerance, where it leaves every sign as it was.
//! Source: Mangasarian & Meyer 2006, Absolute value equations; Mangasarian 2009 for Newton's method on the signs; Qi & Sun 1993 for
//! norms; Murty 1974 for the order of pivots that has no cycle.

pub(crate) mod norms;
pub(crate) mod reduced;
#[cfg(test)]
mod tests;

use crate::dynamics::linear_systems::piecewise::reduced::Reduced;
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::parts::identity;
use crate::mechanism::normal_forces::Term;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// Steps of Newton's method on signs and directions: random systems of 8 terms needed up to 6.
const MOST_STEPS: u32 = 24;

/// Signs turned one at a time for each term: systems that Newton's method cycles on need about one a term.
const MOST_TURNS: u32 = 64;

/// Rounds of [`STEPS_OF_A_ROUND`] contracting steps and Newton's method, for norms that it does not find from afar.
const MOST_ROUNDS: u32 = 64;
const STEPS_OF_A_ROUND: u32 = 16;

/// Parts into which the signs are divided while solutions are counted: thirteen terms have as many.
const MOST_PARTS: u32 = 1 << 14;

/// Parts of the simplex of norms that are looked at for all signs together: random systems of two norms needed up to 933, of three up to 16175.
const MOST_DIVISIONS: u32 = 1 << 16;

/// Solutions of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solutions<R, const K: usize> {
    /// None.
    None,
    /// One, and no other.
    One([R; K]),
    /// So many.
    Several(u32),
    /// At least so many; there may be others.
    AtLeast(u32),
}

/// v = φ(c + B v).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piecewise<R, const K: usize> {
    /// Kind of φ, one a term.
    pub terms: [Term; K],
    /// c, one or two components a term.
    pub offset: [[R; 2]; K],
    /// B: of each term its components, of each of those one entry a term.
    pub slope: [[[R; K]; 2]; K],
}

/// Absolute values whose sign is given: the first `count` of them, a bit each that is set for a minus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Given {
    count: u32,
    minus: u64,
}

impl Given {
    const NONE: Self = Given { count: 0, minus: 0 };

    /// The sign of the absolute value at `place` among them, where it is given.
    fn sign<R: Real>(self, place: u32) -> Option<R> {
        let minus = self.minus.checked_shr(place).unwrap_or(0) & 1 == 1;
        (place < self.count).then(|| R::constant(if minus { -1.0 } else { 1.0 }))
    }

    /// One sign more: a plus.
    fn first_part(self) -> Self {
        Given { count: self.count + 1, ..self }
    }

    /// The part that comes next where this one is done.
    fn next(mut self) -> Option<Self> {
        while self.count > 0 {
            let last = 1_u64.checked_shl(self.count - 1).unwrap_or(0);
            if self.minus & last == 0 {
                return Some(Given { minus: self.minus | last, ..self });
            }
            self.minus &= !last;
            self.count -= 1;
        }
        None
    }
}

impl<R: Real, const K: usize> Piecewise<R, K> {
    /// All solutions, searched for from `start`: one where the system contracts; else the signs are divided until each part does.
    pub(crate) fn solve(&self, start: &[R; K]) -> Solutions<R, K> {
        let absolutes = self.terms.iter().filter(|term| **term == Term::Absolute).count();
        let (mut found, mut count, mut all, mut given) = (None, 0_u32, true, Given::NONE);
        let mut divisions = MOST_DIVISIONS;
        for _ in 0..MOST_PARTS {
            let reduced = self.reduced(given);
            let contracts = reduced.as_ref().is_some_and(Reduced::contracts);
            if !contracts && (given.count as usize) < absolutes.min(64) {
                given = given.first_part();
                continue;
            }
            let mut show = |v| {
                count = count.saturating_add(1);
                found = found.or(Some(v));
            };
            if contracts {
                let unique = self.unique(given, start);
                all &= unique.is_some();
                unique.filter(|v| self.keeps(given, v)).into_iter().for_each(show);
            } else {
                all &= self.of_given_signs(given, reduced.as_ref(), &mut divisions, &mut show);
            }
            match given.next() {
                Some(next) => given = next,
                None => {
                    return match (all, count, found) {
                        (true, 0, _) => Solutions::None,
                        (true, 1, Some(v)) => Solutions::One(v),
                        (true, ..) => Solutions::Several(count),
                        (false, ..) => Solutions::AtLeast(count),
                    };
                }
            }
        }
        Solutions::AtLeast(count)
    }

    /// `true` if every number of the system is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.offset.iter().flatten().chain(self.slope.iter().flatten().flatten()).all(|x| x.is_finite())
    }

    /// c + B v.
    fn sums(&self, v: &[R; K]) -> [[R; 2]; K] {
        let mut sums = self.offset;
        for (sums, slopes) in sums.iter_mut().zip(&self.slope) {
            for (sum, slopes) in sums.iter_mut().zip(slopes) {
                *sum = slopes.iter().zip(v).fold(*sum, |sum, (slope, v)| sum + *slope * *v);
            }
        }
        sums
    }

    /// u of each term at `v`, or as it is given.
    fn directions(&self, given: Given, v: &[R; K]) -> [[R; 2]; K] {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut directions, mut place) = (self.sums(v), 0);
        for (direction, term) in directions.iter_mut().zip(&self.terms) {
            let [x, y] = *direction;
            *direction = match term {
                Term::Multiplier => [one, zero],
                Term::Absolute => {
                    let sign = given.sign(place).unwrap_or(if x < zero { -one } else { one });
                    place += 1;
                    [sign, zero]
                }
                Term::Norm => {
                    let length = if y == zero { x.abs() } else { x.hypot(y) };
                    if zero < length { [x / length, y / length] } else { [one, zero] }
                }
            };
        }
        directions
    }

    /// v of (I − u B) v = u c, the terms that are `held` at their values; none where that is singular.
    fn linear(&self, directions: &[[R; 2]; K], held: impl Fn(usize) -> Option<R>) -> Option<[R; K]> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut matrix, mut right) = (identity(), [zero; K]);
        let rows = matrix.iter_mut().zip(&mut right);
        let terms = directions.iter().zip(self.offset.iter().zip(&self.slope));
        for (term, ((row, right), (direction, (offset, slope)))) in rows.zip(terms).enumerate() {
            if let Some(value) = held(term) {
                *right = value;
                continue;
            }
            for ((u, offset), slopes) in direction.iter().zip(offset).zip(slope) {
                *right = *right + *u * *offset;
                for (entry, slope) in row.iter_mut().zip(slopes) {
                    *entry = *entry - *u * *slope;
                }
            }
        }
        let (factors, margin) = Lu::factorize(&matrix, &[one; K], &[one; K]);
        let v = factors.solve(&right);
        (zero < margin && v.iter().all(|v| v.is_finite())).then_some(v)
    }

    /// Newton's method on signs and directions from those at `start`.
    fn newton(&self, given: Given, start: &[R; K]) -> Option<[R; K]> {
        let mut directions = self.directions(given, start);
        for _ in 0..MOST_STEPS {
            let v = self.linear(&directions, |_| None)?;
            let next = self.directions(given, &v);
            if self.stand(&directions, &next) {
                return Some(v);
            }
            directions = next;
        }
        None
    }

    /// `true` if no sign has changed, and no direction of a norm but by rounding.
    fn stand(&self, before: &[[R; 2]; K], after: &[[R; 2]; K]) -> bool {
        let rounding = forces::OF_PIECEWISE.of::<R>();
        before.iter().zip(after).zip(&self.terms).all(|((before, after), term)| match term {
            Term::Multiplier => true,
            Term::Absolute => before == after,
            Term::Norm => {
                before.iter().zip(after).all(|(before, after)| (*after - *before).abs() <= rounding)
            }
        })
    }

    /// The one solution of a part that contracts.
    fn unique(&self, given: Given, start: &[R; K]) -> Option<[R; K]> {
        self.newton(given, start)
            .or_else(|| self.turned(given, start))
            .or_else(|| self.contracted(given, start))
    }

    /// The first sign that does not hold is turned, until all do. Where the part contracts the system is that of a P-matrix, for which
    /// this order never comes back to signs that it had.
    #[cold]
    #[inline(never)]
    fn turned(&self, given: Given, start: &[R; K]) -> Option<[R; K]> {
        if self.terms.contains(&Term::Norm) {
            return None;
        }
        let mut directions = self.directions(given, start);
        for _ in 0..MOST_TURNS.saturating_mul(K as u32) {
            let v = self.linear(&directions, |_| None)?;
            if self.is_met(given, &v) {
                return Some(v);
            }
            let next = self.directions(given, &v);
            let wrong = directions.iter_mut().zip(&next).find(|(now, next)| now != next);
            let (now, next) = wrong?;
            *now = *next;
        }
        None
    }

    /// Steps v ← φ(c + B v), which contract, until Newton's method ends.
    #[cold]
    #[inline(never)]
    fn contracted(&self, given: Given, start: &[R; K]) -> Option<[R; K]> {
        let mut v = *start;
        for _ in 0..MOST_ROUNDS {
            for _ in 0..STEPS_OF_A_ROUND {
                let directions = self.directions(given, &v);
                let sums = self.sums(&v);
                v = self.linear(&directions, |index| self.held(given, index, &directions, &sums))?;
            }
            let found = self.newton(given, &v).or_else(|| self.is_met(given, &v).then_some(v));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// φ of the sum of an open term.
    fn held(&self, given: Given, index: usize, directions: &[[R; 2]; K], sums: &[[R; 2]; K]) -> Option<R> {
        let open = self.open(given).get(index).copied().unwrap_or(false);
        let ([ux, uy], [x, y]) = (directions.get(index)?, sums.get(index)?);
        open.then(|| *ux * *x + *uy * *y)
    }

    /// `true` if every equation is met but for rounding, with the signs that are given.
    fn is_met(&self, given: Given, v: &[R; K]) -> bool {
        let (directions, sums) = (self.directions(given, v), self.sums(v));
        let roundings = self.roundings(v);
        let rows = directions.iter().zip(&sums).zip(v.iter().zip(&roundings));
        let mut rows =
            rows.map(|(([ux, uy], [x, y]), (v, rounding))| (*ux * *x + *uy * *y - *v).abs() <= *rounding);
        rows.all(|met| met)
    }

    /// Rounding of c + B v, one a term.
    fn roundings(&self, v: &[R; K]) -> [R; K] {
        let mut roundings = [R::constant(0.0); K];
        for ((rounding, offsets), slopes) in roundings.iter_mut().zip(&self.offset).zip(&self.slope) {
            for (offset, slopes) in offsets.iter().zip(slopes) {
                let size =
                    slopes.iter().zip(v).fold(offset.abs(), |sum, (slope, v)| sum + (*slope * *v).abs());
                *rounding = *rounding + size;
            }
            *rounding = *rounding * (forces::OF_PIECEWISE.of::<R>() * R::constant(K as f64 + 1.0));
        }
        roundings
    }

    /// `true` if the sums at `v` have the signs that are given; one that is zero but for rounding counts as a plus, so that it is
    /// counted once.
    fn keeps(&self, given: Given, v: &[R; K]) -> bool {
        let (zero, mut place) = (R::constant(0.0), 0);
        let rows = self.terms.iter().zip(self.sums(v)).zip(self.roundings(v));
        let mut kept = true;
        for ((term, [x, _]), rounding) in rows {
            if *term == Term::Absolute {
                if let Some(sign) = given.sign::<R>(place) {
                    kept &= if x.abs() <= rounding { zero < sign } else { zero < sign * x };
                }
                place += 1;
            }
        }
        kept
    }

    /// Terms whose φ is not linear in a part.
    fn open(&self, given: Given) -> [bool; K] {
        let (mut open, mut place) = ([false; K], 0);
        for (open, term) in open.iter_mut().zip(&self.terms) {
            *open = match term {
                Term::Multiplier => false,
                Term::Norm => true,
                Term::Absolute => {
                    place += 1;
                    given.count < place
                }
            };
        }
        open
    }

    /// Shows the solutions of a part whose signs are all given and which does not contract: of linear equations, with one norm of a
    /// quadratic one, with two or three of a search that encloses them. Returns `true` if there are no others.
    #[cold]
    #[inline(never)]
    fn of_given_signs(
        &self,
        given: Given,
        reduced: Option<&Reduced<R, K>>,
        divisions: &mut u32,
        mut show: impl FnMut([R; K]),
    ) -> bool {
        let directions = self.directions(given, &[R::constant(0.0); K]);
        let open = self.open(given);
        match (open.iter().filter(|open| **open).count(), reduced) {
            (0, _) => {
                let v = self.linear(&directions, |_| None).filter(|v| self.keeps(given, v));
                v.into_iter().for_each(show);
                true
            }
            (1, Some(reduced)) => {
                let Some(index) = open.iter().position(|open| *open) else { return false };
                let Some(roots) = reduced.roots_alone(index) else { return false };
                for root in roots.into_iter().flatten().filter(|root| R::constant(0.0) <= *root) {
                    let v = self.linear(&directions, |term| (term == index).then_some(root));
                    v.filter(|v| self.keeps(given, v)).into_iter().for_each(&mut show);
                }
                true
            }
            (2, Some(reduced)) => self.isolate::<3>(given, reduced, divisions, show),
            (3, Some(reduced)) => self.isolate::<4>(given, reduced, divisions, show),
            _ => false,
        }
    }
}

//! The polynomial of degree 8 through nine equally spaced values, bounded by its Bernstein coefficients.

use crate::dynamics::integrators::event::Unanswered;
use crate::dynamics::integrators::event::passage;
use crate::dynamics::integrators::event::passage::Passage;
use crate::scalar::interval::Interval;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Instants of a part.
pub(super) const NODES: usize = 9;

/// Bernstein coefficients of degree 8 from the values at 0, 1/8, …, 1: the inverse of B_j(i/8); rows 5 to 8 are rows 3 to 0
/// read backwards. Each row is over its denominator.
const COEFFICIENTS: [([f64; NODES], f64); 5] = [
    ([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0),
    ([-1443.0, 6720.0, -11760.0, 15680.0, -14700.0, 9408.0, -3920.0, 960.0, -105.0], 840.0),
    ([19939.0, -135936.0, 379008.0, -568064.0, 561960.0, -370944.0, 157696.0, -39168.0, 4329.0], 8820.0),
    (
        [-40953.0, 324544.0, -1096144.0, 2030784.0, -2229500.0, 1563968.0, -691824.0, 176704.0, -19939.0],
        17640.0,
    ),
    (
        [40953.0, -349184.0, 1298304.0, -2731008.0, 3503920.0, -2731008.0, 1298304.0, -349184.0, 40953.0],
        22050.0,
    ),
];

/// Weights of the eighth difference.
const DIFFERENCE: [f64; NODES] = [1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0];

/// Share of the eighth difference that a function may be off the polynomial: the ninth comes with a factor of 0.012, and is
/// less than ten times the eighth where the values show the function at all.
const OFF: f64 = 0.125;

/// Errors of the polynomial that are kept between it and zero where no more values are asked for.
const DOUBTED: f64 = 4.0;

/// A function within a part of a step.
#[derive(Clone, Copy)]
pub(super) struct Interpolant<R> {
    start: R,
    end: R,
    pub(super) values: [R; NODES],
    coefficients: [R; NODES],
}

impl<R: Real> Interpolant<R> {
    /// Through nine values of `function` between two times (s).
    pub(super) fn through(
        function: &mut impl FnMut(R) -> R,
        start: R,
        end: R,
    ) -> Result<Self, Unanswered<R>> {
        let mut values = [R::constant(0.0); NODES];
        for (index, value) in values.iter_mut().enumerate() {
            let t = Self::instant(start, end, index);
            *value = function(t);
            if !value.is_finite() {
                return Err(Unanswered::Undefined(t));
            }
        }
        Ok(Self::of(values, start, end))
    }

    /// Through nine values that are known; apart from whoever finds them, so that it is compiled once a number type.
    ///
    /// # Errors
    /// The first time (s) at which a value is not finite.
    pub(super) fn through_values(values: [R; NODES], start: R, end: R) -> Result<Self, Unanswered<R>> {
        match values.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(Unanswered::Undefined(Self::instant(start, end, index))),
            None => Ok(Self::of(values, start, end)),
        }
    }

    /// The first half of the part, up to `middle` (s): every second value is one of the whole part.
    pub(super) fn first_half(
        &self,
        function: &mut impl FnMut(R) -> R,
        middle: R,
    ) -> Result<Self, Unanswered<R>> {
        let mut values = [R::constant(0.0); NODES];
        for (index, value) in values.iter_mut().enumerate() {
            let known = self.values.get(index / 2).filter(|_| index % 2 == 0);
            *value = match known {
                Some(known) => *known,
                None => function(Self::instant(self.start, middle, index)),
            };
        }
        Self::through_values(values, self.start, middle)
    }

    /// `true` if it is of the part between two times (s).
    pub(super) fn is_between(&self, start: R, end: R) -> bool {
        self.start == start && self.end == end
    }

    /// `true` if the first half of it is the part between two times (s).
    pub(super) fn is_halved_by(&self, start: R, middle: R) -> bool {
        self.start == start && start + R::constant(0.5) * (self.end - start) == middle
    }

    fn of(values: [R; NODES], start: R, end: R) -> Self {
        let mut coefficients = values;
        for (index, coefficient) in coefficients.iter_mut().enumerate() {
            *coefficient = if index < COEFFICIENTS.len() {
                weighted(index, values.iter())
            } else {
                weighted(NODES - 1 - index, values.iter().rev())
            };
        }
        Interpolant { start, end, values, coefficients }
    }

    /// Time (s) of instant `index` of nine.
    pub(super) fn instant(start: R, end: R, index: usize) -> R {
        let share = index as f64 / (NODES - 1) as f64;
        if index == NODES - 1 { end } else { start + (end - start) * R::constant(share) }
    }

    pub(super) fn time(&self, index: usize) -> R {
        Self::instant(self.start, self.end, index)
    }

    pub(super) fn first(&self) -> R {
        let [first, ..] = self.values;
        first
    }

    pub(super) fn largest(&self) -> R {
        self.values.iter().fold(R::constant(0.0), |largest, value| largest.max(value.abs()))
    }

    /// The smallest absolute value, and where.
    pub(super) fn least(&self) -> (usize, R) {
        let first = (0, self.first().abs());
        self.values.iter().enumerate().fold(first, |least, (index, value)| {
            if value.abs() < least.1 { (index, value.abs()) } else { least }
        })
    }

    /// Changes of sign among the values, from `side` on.
    pub(super) fn changes(&self, side: R) -> u32 {
        let zero = R::constant(0.0);
        let (count, _) = self.values.iter().fold((0, true), |(count, near), value| {
            let now = zero < side * *value;
            (count + u32::from(now != near), now)
        });
        count
    }

    /// Bound of the polynomial's error.
    fn off(&self) -> R {
        let difference = DIFFERENCE
            .iter()
            .zip(&self.values)
            .fold(R::constant(0.0), |sum, (weight, value)| sum + R::constant(*weight) * *value);
        R::constant(OFF) * difference.abs()
    }

    /// Largest distance of a function from the chord between two of the instants: bound w²/8, with `bound` that of its second
    /// derivative (1/s²).
    fn off_chord(&self, bound: R) -> R {
        let width = (self.end - self.start) * R::constant(1.0 / (NODES - 1) as f64);
        bound * width * width * R::constant(0.125)
    }

    /// The first passage of the function through zero from `side`, or from the side on which it leaves zero where it begins there but for
    /// `none`. The side goes with it.
    pub(super) fn first_passage(&self, side: Option<R>, none: R) -> (R, Passage<R>) {
        let [first, second, ..] = self.coefficients;
        let at_zero = side.is_none() && first.abs() <= none;
        let side = side.unwrap_or(if at_zero { second } else { first }).sign();
        let rounding = motion::BLURRED.of::<R>() * self.largest();
        let off = (R::constant(DOUBTED) * self.off()).max(rounding);
        (side, passage::first(self.coefficients.map(|coefficient| side * coefficient), off, at_zero))
    }

    /// Size of its change a part at the beginning.
    pub(super) fn slope(&self) -> R {
        let [first, second, ..] = self.coefficients;
        R::constant((NODES - 1) as f64) * (second - first).abs()
    }

    /// Times (s) of shares of the part.
    pub(super) fn time_of(&self, share: R) -> R {
        if share == R::constant(1.0) { self.end } else { self.start + (self.end - self.start) * share }
    }

    /// `true` if the function stays on `side` of zero.
    pub(super) fn above(&self, side: R) -> bool {
        let off = self.off();
        self.coefficients.iter().all(|coefficient| off < side * *coefficient)
    }

    /// The same of a function whose second derivative (1/s²) is at most `bound`.
    pub(super) fn above_chords(&self, side: R, bound: R) -> bool {
        let off = self.off_chord(bound);
        self.values.iter().all(|value| off < side * *value)
    }

    /// `true` if such a function stays on `side` up to the instant before `index`, and falls from there to `index` throughout: its slope
    /// is off that of the chord by bound w/2 at most.
    pub(super) fn falls_first_at(&self, index: usize, side: R, bound: R) -> bool {
        let off = self.off_chord(bound);
        let mut before = self.values.iter().take(index);
        let last = before.clone().next_back().copied().unwrap_or(R::constant(0.0));
        let value = self.values.get(index).copied().unwrap_or(last);
        let falls = R::constant(4.0) * off < side * (last - value);
        falls && (index == 1 || before.all(|value| off < side * *value))
    }

    /// The value in the middle, those of all of the polynomial, and its derivatives (1/s), where coefficients are known to `slack`.
    pub(super) fn enclosures(&self, slack: R) -> (Interval<R>, Interval<R>, Interval<R>) {
        let [first, ..] = self.coefficients;
        let around = |(low, high): (R, R), value: R| (low.min(value), high.max(value));
        let values = self.coefficients.iter().fold((first, first), |range, value| around(range, *value));
        let infinite = R::constant(f64::INFINITY);
        let later = self.coefficients.iter().skip(1);
        let changes = self.coefficients.iter().zip(later).map(|(one, next)| *next - *one);
        let changes = changes.fold((infinite, -infinite), around);
        let between = |(low, high): (R, R), slack: R| Interval::between(low - slack, high + slack);
        let per_time = Interval::of(R::constant((NODES - 1) as f64) / (self.end - self.start));
        let middle = self.values.get(NODES / 2).copied().unwrap_or(first);
        let rates = between(changes, slack + slack) * per_time;
        (Interval::of(middle), between(values, slack), rates)
    }

    /// `true` if the polynomial falls from `side` throughout, so that it passes zero once at most.
    pub(super) fn falls(&self, side: R) -> bool {
        let later = self.coefficients.iter().skip(1);
        self.coefficients.iter().zip(later).all(|(one, next)| side * *next < side * *one)
    }
}

fn weighted<'a, R: Real + 'a>(row: usize, values: impl Iterator<Item = &'a R>) -> R {
    let Some((weights, denominator)) = COEFFICIENTS.get(row) else { return R::constant(f64::NAN) };
    let terms = weights.iter().zip(values).map(|(weight, value)| R::constant(*weight) * *value);
    terms.fold(R::constant(0.0), |sum, term| sum + term) / R::constant(*denominator)
}

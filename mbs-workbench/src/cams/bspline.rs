//! B-spline laws: degree, knots, and constraints on the lift and its derivatives, as a linear system.
//!
//! Constraints are taken one after the other. One that follows from those before it must agree with them; coefficients that no
//! constraint holds are refused with their place.
//! Source: de Boor 2001, A Practical Guide to Splines, ch. IX, X and XIII; Norton 2009, Cam Design and Manufacturing Handbook, ch. 5.

mod basis;
#[cfg(test)]
mod tests;
pub mod text;

use core::array::from_fn;

use basis::Basis;
use mbs_runtime::driver::centred;
use mbs_runtime::{Interval, Real, Scalar};

use super::CamError;
use super::shapes::ORDERS;
use crate::double_double::DoubleDouble;

/// A row whose share beside those before it is smaller follows from them.
const FOLLOWS: f64 = 1e-9;

/// Values that agree to this share are equal.
const AGREES: f64 = 1e-9;

/// Share of the largest value that is rounding.
const ROUNDING: f64 = 1e-12;

/// Value of the lift or of one of its derivatives at an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Cam angle (rad).
    pub angle: f64,
    /// Order of the derivative: 0 for the lift itself.
    pub order: usize,
    /// Its value (m or rad over rad).
    pub value: f64,
}

/// A law of polynomials between knots.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline {
    /// Places at which pieces begin, and the last end.
    places: Vec<f64>,
    /// Taylor coefficients from the beginning of each piece.
    pieces: Vec<Vec<f64>>,
    /// Number of continuous derivatives.
    order: usize,
}

/// A row over the coefficients, its value, its name.
type Wanted = (Vec<DoubleDouble>, f64, String);

/// Rows made orthonormal, with the combination of constraints that each of them is.
struct Rows {
    directions: Vec<Vec<f64>>,
    combinations: Vec<Vec<f64>>,
}

fn fault<T>(why: String) -> Result<T, CamError> {
    Err(CamError::Value("B-spline", why))
}

impl core::fmt::Display for Constraint {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let name =
            ["lift", "velocity", "acceleration", "jerk"].get(self.order).copied().unwrap_or("derivative");
        write!(f, "{name} at {:.3} deg", self.angle.to_degrees())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], factor: f64, what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(a, b)| *a -= factor * b);
}

impl Rows {
    /// Part of `row` that is orthogonal to the directions, with its combination of constraints.
    fn rest(&self, mut row: Vec<f64>, mut combination: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        // Twice: once leaves rounding along the directions.
        for _ in 0..2 {
            for (direction, known) in self.directions.iter().zip(&self.combinations) {
                let along = dot(&row, direction);
                subtract(&mut row, along, direction);
                subtract(&mut combination, along, known);
            }
        }
        (row, combination)
    }

    /// Coefficients with the least squares that have these values of the constraints.
    fn solved(&self, values: &[f64], count: usize) -> Vec<f64> {
        let mut solution = vec![0.0; count];
        for (direction, combination) in self.directions.iter().zip(&self.combinations) {
            subtract(&mut solution, -dot(combination, values), direction);
        }
        solution
    }
}

impl BSpline {
    /// The law of this degree that keeps all constraints.
    ///
    /// `knots` (rad) do not decrease; a knot that stands m times leaves `degree` − m continuous derivatives there. Beyond the first and
    /// the last one the lift is 0. A periodic law begins as it ends: its knots span a turn.
    ///
    /// # Errors
    /// [`CamError::Value`] of knots and degrees that make no spline, of constraints that contradict or are too few, of a lift that jumps.
    pub fn new(
        degree: usize,
        knots: &[f64],
        constraints: &[Constraint],
        periodic: bool,
    ) -> Result<Self, CamError> {
        let basis = Basis::new(degree, knots, periodic)?;
        let [first, last] = [knots[0], knots[knots.len() - 1]];
        for one in constraints {
            check(one, degree, knots)?;
        }
        let count = basis.count();
        let mut wanted: Vec<Wanted> = constraints
            .iter()
            .map(|one| (basis.row(one.angle, one.order), one.value, one.to_string()))
            .collect();
        for order in 0..if periodic { degree } else { 0 } {
            let [start, end] = [first, last].map(|place| basis.row::<DoubleDouble>(place, order));
            let row = start.into_iter().zip(end).map(|(start, end)| start - end).collect();
            wanted.push((row, 0.0, "period".to_string()));
        }
        let scales: Vec<f64> = wanted
            .iter()
            .map(|(row, ..)| row.iter().map(|entry| entry.high * entry.high).sum::<f64>().sqrt())
            .collect();
        let values: Vec<f64> =
            wanted.iter().zip(&scales).map(|((_, value, _), scale)| value / scale).collect();
        let normal = |k: usize| wanted[k].0.iter().map(|entry| entry.high / scales[k]).collect::<Vec<f64>>();
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let mut rows = Rows { directions: Vec::new(), combinations: Vec::new() };
        for k in 0..wanted.len() {
            let mut combination = vec![0.0; wanted.len()];
            combination[k] = 1.0;
            let (mut rest, mut combination) = rows.rest(normal(k), combination);
            let length = dot(&rest, &rest).sqrt();
            if length > FOLLOWS {
                rest.iter_mut().chain(&mut combination).for_each(|entry| *entry /= length);
                rows.directions.push(rest);
                rows.combinations.push(combination);
                continue;
            }
            // Σ combination · row = 0: so must Σ combination · value be.
            let size: f64 = combination.iter().zip(&values).map(|(share, value)| (share * value).abs()).sum();
            // Combinations are known to rounding.
            if dot(&combination, &values).abs() > AGREES * size + ROUNDING * largest {
                let involved = (0..k).filter(|j| combination[*j].abs() > 1e-6);
                let mut names: Vec<&str> = involved.map(|j| wanted[j].2.as_str()).collect();
                names.dedup();
                return fault(format!(
                    "the constraint on the {} contradicts those on the {}, which hold {} of {count} coefficients\n\
                     help: leave one of them out, or add a knot between them",
                    wanted[k].2,
                    names.join(", "),
                    rows.directions.len()
                ));
            }
        }
        if rows.directions.len() < count {
            return Err(undetermined(&basis, &rows));
        }
        let mut solution = rows.solved(&values, count);
        // Residuals in twice the digits: what is left is the rounding of the coefficients.
        for _ in 0..2 {
            let left = |(row, value, _): &Wanted| {
                let number = DoubleDouble::new;
                row.iter()
                    .zip(&solution)
                    .fold(number(*value), |left, (entry, x)| left - *entry * number(*x))
                    .high
            };
            let left: Vec<f64> = wanted.iter().zip(&scales).map(|(one, scale)| left(one) / scale).collect();
            subtract(&mut solution, -1.0, &rows.solved(&left, count));
        }
        let mut law = pieces(&basis, &solution);
        law.order = law.continuity(degree, knots, periodic)?;
        Ok(law)
    }

    /// Number of continuous derivatives, the ends included.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Places at which pieces meet, the ends included (rad).
    pub fn joints(&self) -> &[f64] {
        &self.places
    }

    /// First and last angle (rad).
    pub fn range(&self) -> [f64; 2] {
        [self.places[0], self.places[self.places.len() - 1]]
    }

    /// Value and derivatives; 0 beyond the ends.
    pub(super) fn jet<T: Real>(&self, x: T) -> [T; ORDERS] {
        let [first, last] = self.range();
        let place = x.to_f64();
        if !(first..=last).contains(&place) {
            return [T::constant(0.0); ORDERS];
        }
        let index = self.places.partition_point(|start| *start <= place).clamp(1, self.pieces.len()) - 1;
        self.piece(index, x)
    }

    fn piece<T: Scalar, const K: usize>(&self, index: usize, x: T) -> [T; K] {
        let distance = x - T::constant(self.places[index]);
        from_fn(|order| {
            let falling = |k: usize| (0..order).map(|j| (k - j) as f64).product::<f64>();
            let terms = self.pieces[index].iter().enumerate().skip(order).rev();
            terms.fold(T::constant(0.0), |sum, (k, term)| sum * distance + T::constant(term * falling(k)))
        })
    }

    /// Bounds of value and `K` − 1 derivatives between two angles, `K` at most [`order`](Self::order) + 1.
    pub(super) fn enclosure<const K: usize>(&self, [from, to]: [f64; 2]) -> [Interval<f64>; K] {
        let [first, last] = self.range();
        let rest = (from < first || to > last).then_some([Interval::of(0.0); K]);
        let met = (0..self.pieces.len()).filter_map(|index| {
            let (low, high) = (from.max(self.places[index]), to.min(self.places[index + 1]));
            (low <= high).then(|| centred(|x| self.piece::<_, K>(index, x), low, high))
        });
        let around =
            |one: [Interval<f64>; K], other: [Interval<f64>; K]| from_fn(|k| one[k].around(other[k]));
        met.chain(rest).reduce(around).unwrap_or([Interval::of(0.0); K])
    }

    /// Largest magnitudes of all derivatives.
    fn magnitudes(&self, degree: usize) -> Vec<f64> {
        let at = |index: usize, share: f64, order| {
            derivative(&self.pieces[index], order, share * (self.places[index + 1] - self.places[index]))
        };
        (0..=degree)
            .map(|order| {
                let of = |index: usize| (0..=8).map(move |k| at(index, f64::from(k) / 8.0, order).abs());
                (0..self.pieces.len()).flat_map(of).fold(0.0, f64::max)
            })
            .collect()
    }

    /// Continuous derivatives: those that knots leave, and those that agree to rounding beside.
    fn continuity(&self, degree: usize, knots: &[f64], periodic: bool) -> Result<usize, CamError> {
        let largest = self.magnitudes(degree);
        let is_zero = |order: usize, jump: f64| jump.abs() <= AGREES * largest[order];
        let pieces = self.pieces.len();
        let end = |index: usize, order| {
            derivative(&self.pieces[index], order, self.places[index + 1] - self.places[index])
        };
        let start = |index: usize, order| derivative(&self.pieces[index], order, 0.0);
        let equal = |jump: &dyn Fn(usize) -> f64, sure: usize| {
            (0..=degree).take_while(|order| *order < sure || is_zero(*order, jump(*order))).count()
        };
        let mut least = usize::MAX;
        for index in 1..pieces {
            let times = knots.iter().filter(|knot| **knot == self.places[index]).count();
            let jump = |order: usize| end(index - 1, order) - start(index, order);
            least = least.min(equal(&jump, degree + 1 - times));
        }
        let ends: Vec<usize> = if periodic {
            vec![equal(&|order| end(pieces - 1, order) - start(0, order), degree)]
        } else {
            vec![equal(&|order| start(0, order), 0), equal(&|order| end(pieces - 1, order), 0)]
        };
        for (place, equal) in self.range().into_iter().zip(&ends) {
            if *equal == 0 {
                return fault(format!(
                    "the lift jumps at {:.3} deg, where it rests at 0 beyond\nhelp: say `at {:.3}deg: s = 0`",
                    place.to_degrees(),
                    place.to_degrees()
                ));
            }
        }
        Ok(ends.into_iter().fold(least, usize::min).saturating_sub(1))
    }
}

/// Derivative of a polynomial by its Taylor coefficients.
fn derivative(terms: &[f64], order: usize, distance: f64) -> f64 {
    let falling = |k: usize| (0..order).map(|j| (k - j) as f64).product::<f64>();
    terms.iter().enumerate().skip(order).rev().fold(0.0, |sum, (k, term)| sum * distance + term * falling(k))
}

fn check(one: &Constraint, degree: usize, knots: &[f64]) -> Result<(), CamError> {
    let [first, last] = [knots[0], knots[knots.len() - 1]];
    if !(one.angle.is_finite() && one.value.is_finite()) {
        return fault(format!("the constraint on the {one} is not finite"));
    }
    if !(first..=last).contains(&one.angle) {
        return fault(format!("the constraint on the {one} lies beyond the knots"));
    }
    if one.order > degree.min(3) {
        return fault(format!(
            "the constraint on the {one} is above the degree, or above the third derivative"
        ));
    }
    let times = knots.iter().filter(|knot| **knot == one.angle).count();
    let within = one.angle > first && one.angle < last;
    if within && times > 0 && one.order + times > degree {
        return fault(format!("the {one} may jump at that knot\nhelp: constrain it beside the knot"));
    }
    Ok(())
}

/// Names the interval where the coefficient that constraints hold least counts.
fn undetermined(basis: &Basis, rows: &Rows) -> CamError {
    let count = basis.count();
    let free = |k: usize| {
        let mut unit = vec![0.0; count];
        unit[k] = 1.0;
        let (rest, _) = rows.rest(unit, vec![0.0; rows.combinations.first().map_or(0, Vec::len)]);
        dot(&rest, &rest)
    };
    let freest = (0..count).max_by(|a, b| free(*a).total_cmp(&free(*b))).unwrap_or(0);
    let degrees = |knot: usize| basis.knots[knot].to_degrees();
    CamError::Value(
        "B-spline",
        format!(
            "{} independent constraints are too few for {count} coefficients (knots less one, and the degree)\n\
             help: nothing holds the lift between {:.3} and {:.3} deg: add a constraint there, or leave out a knot",
            rows.directions.len(),
            degrees(freest),
            degrees(freest + basis.degree + 1)
        ),
    )
}

fn pieces(basis: &Basis, solution: &[f64]) -> BSpline {
    let mut places = basis.knots.clone();
    places.dedup();
    let piece = |start: &f64| -> Vec<f64> {
        let interval = basis.interval(*start);
        let splines = basis.splines::<DoubleDouble>(interval, *start);
        let term = |k: usize| {
            let coefficients = solution[interval - basis.degree..].iter().map(|x| DoubleDouble::new(*x));
            let products = splines.iter().zip(coefficients).map(|(spline, x)| spline[k] * x);
            products.fold(DoubleDouble::new(0.0), |sum, product| sum + product).high
        };
        (0..=basis.degree).map(term).collect()
    };
    let pieces = places[..places.len() - 1].iter().map(piece).collect();
    BSpline { places, pieces, order: 0 }
}

//! Normalised laws that the runtime does not have: from 0 to 1, and one hump.

use core::array::from_fn;
use core::f64::consts::PI;

use mbs_runtime::driver::{Law, centred};
use mbs_runtime::{Interval, Real, Scalar};

use super::CamError;

/// Number of derivatives of a law's value that are asked for, the value included: three, and two more for the polydyne correction.
pub const ORDERS: usize = 6;

/// s = (1 − cos π u)/2. The acceleration jumps where it meets a dwell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimpleHarmonic;

/// Acceleration: a quarter sine over an eighth, half a cosine of six eighths, a quarter sine over an eighth.
///
/// Source: Norton 2009, Cam Design and Manufacturing Handbook, ch. 3 (modified sine).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModifiedSine;

/// Acceleration: a trapezoid whose flanks of an eighth each are quarter sines.
///
/// Source: Norton 2009, Cam Design and Manufacturing Handbook, ch. 3 (modified trapezoid).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModifiedTrapezoid;

/// Constant velocity, blended with the rests over a quarter at each end by a 3-4-5 polynomial of the velocity.
///
/// The ramp before a flank: a clearance is taken up at a known low velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstantVelocity;

/// Value and derivatives of `a + b u + c u² + d sin(k u + e)`.
fn wave<T: Scalar, const K: usize>(u: T, [a, b, c]: [f64; 3], d: f64, k: f64, e: f64) -> [T; K] {
    let ([sine], [cosine]) = T::sin_cos([T::constant(k) * u + T::constant(e)]);
    let quarters = [sine, cosine, -sine, -cosine];
    let mut factor = T::constant(d);
    from_fn(|order| {
        let polynomial = match order {
            0 => T::constant(a) + u * (T::constant(b) + u * T::constant(c)),
            1 => T::constant(b) + u * T::constant(2.0 * c),
            2 => T::constant(2.0 * c),
            _ => T::constant(0.0),
        };
        let derivative = polynomial + factor * quarters[order % 4];
        factor = factor * T::constant(k);
        derivative
    })
}

fn choose<T: Scalar, const K: usize>(u: T, place: f64, before: [T; K], after: [T; K]) -> [T; K] {
    let early = u.less(T::constant(place));
    from_fn(|order| T::select(early, before[order], after[order]))
}

impl Law for SimpleHarmonic {
    const ORDER: usize = 1;

    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        // −cos(π u)/2 = sin(π u − π/2)/2, with the half-angle for the value: (1 − cos π u)/2 = sin²(π u/2).
        let mut jet: [T; K] = wave(u, [0.5, 0.0, 0.0], 0.5, PI, -0.5 * PI);
        let ([sine], _) = T::sin_cos([T::constant(0.5 * PI) * u]);
        if let Some(value) = jet.first_mut() {
            *value = sine * sine;
        }
        jet
    }
}

impl Law for ModifiedSine {
    const ORDER: usize = 2;

    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        let share = 1.0 / (PI + 4.0);
        // The rates of both waves are 4π and 4π/3; they meet at 1/8 with equal value and two derivatives.
        let first = wave(u, [0.0, PI * share, 0.0], -0.25 * share, 4.0 * PI, 0.0);
        let second = wave(u, [2.0 * share, PI * share, 0.0], -2.25 * share, 4.0 * PI / 3.0, PI / 3.0);
        choose(u, 0.125, first, second)
    }
}

impl Law for ModifiedTrapezoid {
    const ORDER: usize = 2;

    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        // Largest acceleration A = 8π/(π + 2), from s(1/2) = 1/2.
        let a = 8.0 * PI / (PI + 2.0);
        let k = 4.0 * PI;
        let first = wave(u, [0.0, a / k, 0.0], -a / (k * k), k, 0.0);
        let constant = [0.0078125 * a - a / (k * k), a / k - 0.125 * a, 0.5 * a];
        let second = wave(u, constant, 0.0, k, 0.0);
        // Falls as a cosine from 3/8 on: acceleration A cos(k (u − 3/8)).
        let velocity = a / k + 0.25 * a;
        let place = constant[0] + 0.375 * constant[1] + 0.140625 * constant[2] + a / (k * k);
        let third = wave(u, [place - 0.375 * velocity, velocity, 0.0], a / (k * k), k, -1.5 * PI - 0.5 * PI);
        choose(u, 0.375, choose(u, 0.125, first, second), third)
    }
}

impl Law for ConstantVelocity {
    const ORDER: usize = 3;

    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        const BLEND: f64 = 0.25;
        let velocity = 1.0 / (1.0 - BLEND);
        // The integral of 10 w³ − 15 w⁴ + 6 w⁵ over w = u/BLEND.
        let powers = [0.0, 0.0, 0.0, 0.0, 2.5, -3.0, 1.0].map(|c| T::constant(c * velocity * BLEND));
        let mut blended = power_series(&powers, u * T::constant(1.0 / BLEND));
        let mut factor = T::constant(1.0);
        for derivative in &mut blended {
            *derivative = *derivative * factor;
            factor = factor * T::constant(1.0 / BLEND);
        }
        let even = wave(u, [-0.5 * BLEND * velocity, velocity, 0.0], 0.0, 1.0, 0.0);
        choose(u, BLEND, blended, even)
    }
}

/// Value and derivatives of Σ cⱼ xʲ.
fn power_series<T: Scalar, const K: usize>(coefficients: &[T], x: T) -> [T; K] {
    let mut jet = [T::constant(0.0); K];
    for coefficient in coefficients.iter().rev() {
        let mut carried = *coefficient;
        for derivative in &mut jet {
            let before = *derivative;
            *derivative = before * x + carried;
            carried = before;
        }
    }
    let mut factorial = 1.0;
    for (order, derivative) in jet.iter_mut().enumerate() {
        factorial *= order.max(1) as f64;
        *derivative = *derivative * T::constant(factorial);
    }
    jet
}

/// One hump s(x), −1 ≤ x ≤ 1, full at 0: 1 + Σ cₖ x^pₖ with cₖ = −∏_{j≠k} pⱼ/(pⱼ − pₖ).
///
/// With n exponents the derivatives 0 … n − 1 vanish at both ends.
#[derive(Clone, Debug, PartialEq)]
pub struct EvenPowers {
    exponents: Vec<u32>,
}

/// Largest exponent: rounding of the coefficients stays small.
const LARGEST_EXPONENT: u32 = 60;

/// Most exponents.
const MOST_EXPONENTS: usize = 8;

impl EvenPowers {
    /// Even exponents, increasing.
    ///
    /// # Errors
    /// [`CamError::Exponents`] where one is odd, zero, repeated or above 60, or where they are fewer than 2 or more than 8.
    pub fn new(exponents: &[u32]) -> Result<Self, CamError> {
        let fault = |why: &str| Err(CamError::Exponents(why.to_string()));
        if exponents.len() < 2 || exponents.len() > MOST_EXPONENTS {
            return fault("two to eight exponents are needed");
        }
        if let Some(odd) = exponents.iter().find(|p| **p % 2 == 1 || **p == 0 || **p > LARGEST_EXPONENT) {
            return fault(&format!("{odd} is not even, or not within 2 and {LARGEST_EXPONENT}"));
        }
        if exponents.windows(2).any(|pair| pair[0] >= pair[1]) {
            return fault("they must increase");
        }
        Ok(EvenPowers { exponents: exponents.to_vec() })
    }

    /// Number of continuous derivatives where the hump meets its dwell.
    pub fn order(&self) -> usize {
        self.exponents.len() - 1
    }

    /// Value and derivatives at `x`; 0 beyond the ends.
    pub fn jet<T: Real>(&self, x: T) -> [T; ORDERS] {
        let one = T::constant(1.0);
        let is_within = x.abs() < one;
        if !is_within {
            return [T::constant(if x.is_finite() { 0.0 } else { f64::NAN }); ORDERS];
        }
        self.within(x)
    }

    /// Bounds of value and `K` − 1 derivatives between two places, `K` at most the number of exponents.
    pub fn enclosure<const K: usize>(&self, [from, to]: [f64; 2]) -> [Interval<f64>; K] {
        let rest = [Interval::of(0.0); K];
        let (low, high) = (from.max(-1.0), to.min(1.0));
        let is_within = low <= high;
        if !is_within {
            return rest;
        }
        let mut bounds = centred(|x| self.within::<_, K>(x), low, high);
        if from < -1.0 || to > 1.0 {
            bounds.iter_mut().zip(rest).for_each(|(bound, rest)| *bound = bound.around(rest));
        }
        bounds
    }

    fn within<T: Scalar, const K: usize>(&self, x: T) -> [T; K] {
        let one = T::constant(1.0);
        let mut terms = vec![T::constant(0.0); self.exponents.last().map_or(1, |p| *p as usize + 1)];
        terms[0] = one;
        for p in &self.exponents {
            let others = self.exponents.iter().filter(|j| *j != p);
            let product = others.fold(one, |product, j| {
                product * T::constant(f64::from(*j)) / T::constant(f64::from(*j) - f64::from(*p))
            });
            terms[*p as usize] = -product;
        }
        power_series(&terms, x)
    }
}

/// A sum of harmonics of the cam angle: mean + Σ aₖ cos kθ + bₖ sin kθ, k = 1, 2, ….
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    mean: f64,
    amplitudes: Vec<[f64; 2]>,
}

/// Most harmonics: a wave of one degree.
const MOST_HARMONICS: usize = 360;

impl Harmonics {
    /// Mean and amplitudes [aₖ, bₖ], all in m or in rad.
    ///
    /// # Errors
    /// [`CamError::Value`] of amplitudes that are not finite, are more than 360, or move nothing.
    pub fn new(mean: f64, amplitudes: &[[f64; 2]]) -> Result<Self, CamError> {
        let fault = |why: &str| Err(CamError::Value("harmonics", why.to_string()));
        if amplitudes.len() > MOST_HARMONICS {
            return fault("they are more than 360, of which the last one is a wave of one degree");
        }
        if !amplitudes.iter().flatten().chain([&mean]).all(|value| value.is_finite()) {
            return fault("an amplitude is not finite");
        }
        if amplitudes.iter().flatten().all(|value| *value == 0.0) {
            return fault(
                "all amplitudes are 0, so the law moves nothing\nhelp: write the mean, then cosine and sine of each, as `harmonics:4mm, -4mm 0.5mm`",
            );
        }
        Ok(Harmonics { mean, amplitudes: amplitudes.to_vec() })
    }

    /// Value and derivatives at the cam angle `x` (rad).
    pub fn jet<T: Scalar, const K: usize>(&self, x: T) -> [T; K] {
        let mut sum = [T::constant(0.0); K];
        let mut order = T::constant(0.0);
        for [a, b] in &self.amplitudes {
            order = order + T::constant(1.0);
            let ([sine], [cosine]) = T::sin_cos([order * x]);
            let (a, b) = (T::constant(*a), T::constant(*b));
            let [along, across] = [a * cosine + b * sine, b * cosine - a * sine];
            let mut factor = T::constant(1.0);
            for (derivative, quarter) in
                sum.iter_mut().zip([along, across, -along, -across].into_iter().cycle())
            {
                *derivative = *derivative + factor * quarter;
                factor = factor * order;
            }
        }
        if let Some(value) = sum.first_mut() {
            *value = *value + T::constant(self.mean);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends<L: Law>(known: usize) {
        let [start, end] = [0.0, 0.5].map(|u| L::first_half::<f64, 6>(u));
        assert!((end[0] - 0.5).abs() < 1e-15, "the middle is a half: {end:?}");
        for order in 0..=L::ORDER {
            assert!(start[order].abs() < 1e-14, "order {order}: {start:?}");
        }
        assert!(start[L::ORDER + 1].abs() > 1.0 && L::ORDER == known, "{start:?}");
        // Even derivatives vanish in the middle, by s(u) + s(1 − u) = 1.
        assert!(end[2].abs() < 1e-13, "{end:?}");
    }

    #[test]
    fn laws_begin_at_rest_and_pass_the_middle() {
        ends::<SimpleHarmonic>(1);
        ends::<ModifiedSine>(2);
        ends::<ModifiedTrapezoid>(2);
        ends::<ConstantVelocity>(3);
    }

    /// Norton's table 3-2: largest velocity and acceleration.
    #[test]
    fn peaks_are_those_of_the_handbook() {
        let peaks = |jet: fn(f64) -> [f64; 3]| {
            (0..=4000)
                .map(|k| jet(f64::from(k) / 8000.0))
                .fold([0.0_f64; 2], |most, jet| [most[0].max(jet[1]), most[1].max(jet[2])])
        };
        for (found, expected) in [
            (peaks(SimpleHarmonic::first_half::<f64, 3>), [1.571, 4.935]),
            (peaks(ModifiedSine::first_half::<f64, 3>), [1.760, 5.528]),
            (peaks(ModifiedTrapezoid::first_half::<f64, 3>), [2.0, 4.888]),
        ] {
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 6e-4, "{found} {expected}");
            }
        }
    }

    /// Pieces meet at their joints in as many derivatives as the ends have.
    #[test]
    fn pieces_meet() {
        let jump = |jet: fn(f64) -> [f64; 3], place: f64| {
            let [before, after] = [place - 1e-12, place + 1e-12].map(jet);
            (0..3).map(|k| (before[k] - after[k]).abs()).fold(0.0, f64::max)
        };
        assert!(jump(ModifiedSine::first_half::<f64, 3>, 0.125) < 1e-9);
        assert!(jump(ModifiedTrapezoid::first_half::<f64, 3>, 0.125) < 1e-9);
        assert!(jump(ModifiedTrapezoid::first_half::<f64, 3>, 0.375) < 1e-9);
        assert!(jump(ConstantVelocity::first_half::<f64, 3>, 0.25) < 1e-9);
    }

    #[test]
    fn coefficients_of_the_lecture_and_their_contact_with_the_dwell() {
        let law = EvenPowers::new(&[2, 6, 8, 10, 12]).expect("exponents");
        for x in [0.0_f64, 0.3, -0.7, 0.95] {
            let known = 1.0 - 3.0 * x.powi(2) + 10.0 * x.powi(6) - 15.0 * x.powi(8) + 9.0 * x.powi(10)
                - 2.0 * x.powi(12);
            assert!((law.jet(x)[0] - known).abs() < 1e-14, "{x}");
        }
        let near = law.jet(1.0 - 1e-15);
        assert!(near[..5].iter().all(|value| value.abs() < 1e-9) && near[5].abs() > 100.0, "{near:?}");
        assert_eq!(law.order(), 4);
        for bad in [&[2_u32][..], &[2, 3], &[2, 2], &[0, 2], &[4, 2], &[2, 62]] {
            assert!(EvenPowers::new(bad).is_err(), "{bad:?}");
        }
    }
}

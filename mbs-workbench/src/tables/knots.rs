//! The number of knots at which noise and smoothing of the second derivative are least together, estimated from a table alone.
//!
//! With K knots the second derivative has the noise σ g(K), with g as [`Spline::noise_gain`], and loses what so few knots cannot follow.
//! Fits of K and of more knots L differ by noise with a variance of at most σ² g²(L). What the difference has above that, and above the
//! scatter of such a sum, is lost with K knots; the comparison that shows most of it counts.
//! Source: Lepski 1991 (choice by comparison with all finer estimates), with Mallows 1973 for the variance from residuals.

use mbs_runtime::driver::FitError;

use super::Points;
use super::spline::{Spline, SplineKind, even};

/// Points a knot of the fits that are compared.
const SHARES: [f64; 10] = [2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 24.0];

/// Fewest knots that are advised.
const FEWEST: usize = 12;

/// Places at which second derivatives are compared, of each point.
const PLACES: usize = 4;

/// Estimates for one number of knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Knots.
    pub knots: usize,
    /// Root mean square of the noise in the second derivative, in SI.
    pub noise: f64,
    /// Root mean square of what the knots cannot follow, in SI.
    pub loss: f64,
}

/// Estimates for several numbers of knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Estimates, from many knots to few.
    pub estimates: Vec<Estimate>,
    /// Standard deviation of the ordinates, in SI.
    pub deviation: f64,
}

/// A fit with what comparisons need.
struct Fit {
    knots: usize,
    gain: f64,
    /// Second derivatives at equal distances.
    second: Vec<f64>,
    /// Variance of the ordinates by its residuals.
    variance: f64,
}

impl Fit {
    /// Mean square of what this fit loses against a `finer` one, above noise and its scatter.
    fn lost(&self, finer: &Fit, variance: f64) -> f64 {
        let squares = self.second.iter().zip(&finer.second).map(|(a, b)| (a - b).powi(2));
        let apart = squares.sum::<f64>() / self.second.len() as f64;
        // Three deviations above the mean of a sum of squares; gains are known to a tenth. The weights k⁴ of the second derivative leave
        // a fifth of the freedoms.
        let scatter = 1.2 + 3.0 * (2.0 / (0.2 * finer.knots as f64)).sqrt();
        (apart - scatter * variance * finer.gain.powi(2)).max(0.0)
    }
}

impl Estimate {
    /// Root mean square error of the second derivative, in SI.
    pub fn error(&self) -> f64 {
        self.noise.hypot(self.loss)
    }
}

impl Advice {
    /// Estimates for a table; none where it has too few points.
    ///
    /// # Errors
    /// [`FitError`], as the fits themselves.
    pub fn of(points: &Points, kind: SplineKind) -> Result<Option<Self>, FitError> {
        Self::with(&points.x, &points.y, kind, |count| even(&points.x, kind, count))
    }

    /// Estimates for points whose knots `places` tells by their number.
    ///
    /// # Errors
    /// [`FitError`], as the fits themselves.
    pub fn with(
        x: &[f64],
        y: &[f64],
        kind: SplineKind,
        places: impl Fn(usize) -> Vec<f64>,
    ) -> Result<Option<Self>, FitError> {
        let count = |share: f64| (x.len() as f64 / share) as usize;
        if count(SHARES[0]) < FEWEST {
            return Ok(None);
        }
        let mut fits: Vec<Fit> = Vec::new();
        for knots in SHARES.map(count).into_iter().filter(|knots| *knots >= FEWEST) {
            let fit = Spline::along(x, y, kind, places(knots))?;
            let [first, last] = fit.range();
            let samples = PLACES * x.len();
            let place = |k: usize| first + (last - first) * (k as f64 + 0.5) / samples as f64;
            let second = (0..samples).map(|k| fit.derivatives(place(k))[2]).collect();
            let (_, mean, _) = fit.residual(x, y);
            let variance = mean * mean * x.len() as f64 / (x.len() - knots) as f64;
            fits.push(Fit { knots, gain: fit.noise_gain(x, kind)?, second, variance });
        }
        // What few knots cannot follow only adds to the residual.
        let variance = fits.iter().map(|fit| fit.variance).fold(f64::INFINITY, f64::min);
        let estimate = |(index, fit): (usize, &Fit)| {
            let lost = fits[..index].iter().map(|finer| fit.lost(finer, variance)).fold(0.0, f64::max);
            Estimate { knots: fit.knots, noise: variance.sqrt() * fit.gain, loss: lost.sqrt() }
        };
        let estimates = fits.iter().enumerate().map(estimate).collect();
        Ok(Some(Advice { estimates, deviation: variance.sqrt() }))
    }

    /// The number of knots with the least error of the second derivative.
    pub fn best(&self) -> Option<&Estimate> {
        self.estimates.iter().min_by(|a, b| a.error().total_cmp(&b.error()))
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::super::{Columns, read};
    use super::*;

    /// Points of a lift of harmonics with noise of one step of a generator that is no gauge's.
    fn table(count: usize, noise: f64, highest: i32) -> (Points, impl Fn(f64) -> f64) {
        let lift =
            move |x: f64| (1..=highest).map(|k| (f64::from(k) * x).cos() / f64::from(k * k)).sum::<f64>();
        let second = move |x: f64| -(1..=highest).map(|k| (f64::from(k) * x).cos()).sum::<f64>();
        let mut state = 7_u64;
        let mut text = String::new();
        for k in 0..count {
            let x = TAU * k as f64 / count as f64;
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let uniform = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            text += &format!("{x:.15},{:.15}\n", lift(x) + noise * uniform);
        }
        let columns = Columns::parse("rad, m").expect("columns");
        (read(text.as_bytes(), Some(&columns)).expect("numbers"), second)
    }

    /// Against the true second derivative: the advised number of knots is nearly the best of all candidates.
    #[test]
    fn the_advice_is_nearly_the_best_there_is() {
        for (count, noise, highest) in
            [(360, 1e-3, 5), (360, 1e-5, 5), (720, 1e-3, 3), (360, 1e-2, 2), (180, 1e-4, 9), (1440, 1e-4, 12)]
        {
            let (points, second) = table(count, noise, highest);
            let kind = SplineKind::PeriodicQuintic(TAU);
            let advice = Advice::of(&points, kind).expect("fits").expect("enough points");
            let truth = |knots: usize| {
                let fit = Spline::fit(&points.x, &points.y, kind, Some(knots)).expect("a fit");
                let squares = (0..2000).map(|k| TAU * (f64::from(k) + 0.3) / 2000.0);
                let squares = squares.map(|x| (fit.derivatives(x)[2] - second(x)).powi(2)).sum::<f64>();
                (squares / 2000.0).sqrt()
            };
            let best = advice.best().expect("candidates");
            let least = advice.estimates.iter().map(|one| truth(one.knots)).fold(f64::INFINITY, f64::min);
            let found = truth(best.knots);
            assert!(found < 1.5 * least, "{count} {noise:e} {highest}: {best:?} {found:e} {least:e}");
            let estimated = best.error() / found;
            assert!((0.5..2.0).contains(&estimated), "{count} {noise:e} {highest}: {estimated}");
            // A uniform deviation of `noise` in all.
            assert!((advice.deviation / (noise / 12_f64.sqrt()) - 1.0).abs() < 0.2, "{:e}", advice.deviation);
        }
    }

    #[test]
    fn too_few_points_get_no_advice() {
        let (points, _) = table(20, 1e-3, 2);
        assert_eq!(Advice::of(&points, SplineKind::PeriodicQuintic(TAU)), Ok(None));
    }
}

//! Noise of the acceleration that is read from a table of the lift, against its number of points and of knots.
//!
//! Uniform noise of the width q has the deviation σ = q/√12. The second derivatives m of a cubic spline through N points a turn solve
//! (m₋ + 4 m + m₊)/6 = δ²y/h² with h = 2π/N. White noise passes with the gain 6(1 − cos w)/(2 + cos w)/h², whose root mean square over
//! all w is 6/h². So the acceleration has the noise 6 σ/h² = √3 q N²/(2π)². Fewer knots than points keep most of it out.
//! Source: de Boor 2001, A Practical Guide to Splines, ch. IV (the equations of the spline) and XIV (least squares).

use core::f64::consts::TAU;

use mbs_runtime::driver::{End, FitError};

use super::lift::Lift;
use crate::random::Generator;
use crate::tables::{Spline, SplineKind};

/// Points a turn.
pub const POINTS: [usize; 5] = [90, 180, 360, 720, 1440];

/// Knots of the least-squares fits.
pub const KNOTS: [usize; 4] = [240, 120, 60, 30];

/// Seeds over which root mean squares are taken.
const SEEDS: u64 = 8;

/// Errors for one number of points (m or rad over rad²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseRow {
    /// Points a turn.
    pub points: usize,
    /// Root mean square noise of the second derivative, of a cubic spline through all points.
    pub through: f64,
    /// √3 q N²/(2π)².
    pub expected: f64,
    /// Root mean square error of the second derivative against the law, of quintic least-squares fits with [`KNOTS`]; none where points
    /// are fewer than two a knot.
    pub fitted: [Option<f64>; KNOTS.len()],
}

/// Study of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Width of the uniform noise in the lift (m or rad).
    pub width: f64,
    /// Largest magnitude of the law's acceleration.
    pub largest: f64,
    /// One row for each number of points.
    pub rows: Vec<NoiseRow>,
}

/// Uniform numbers in [−0.5, 0.5).
fn uniform(seed: u64, count: usize) -> Vec<f64> {
    let mut random = Generator::new(seed.wrapping_mul(0xD134_2543_DE82_EF95));
    (0..count).map(|_| random.uniform(-0.5, 0.5)).collect()
}

/// √3 q N²/(2π)², the noise of the second derivative of a cubic spline through all points.
pub fn expected(width: f64, points: usize) -> f64 {
    3_f64.sqrt() * width * (points as f64 / TAU).powi(2)
}

/// Mean over seeds of squares, as their root.
fn mean(squares: impl Iterator<Item = Result<f64, FitError>>) -> Result<f64, FitError> {
    let squares = squares.collect::<Result<Vec<f64>, FitError>>()?;
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Noise of the second derivative for one number of points, root mean square over eight seeds.
///
/// # Errors
/// [`FitError`], as the fits.
pub fn through(width: f64, points: usize) -> Result<f64, FitError> {
    let x: Vec<f64> = (0..=points).map(|k| TAU * k as f64 / points as f64).collect();
    mean((1..=SEEDS).map(|seed| {
        let y: Vec<f64> = uniform(seed, points + 1).into_iter().map(|noise| width * noise).collect();
        // A fit is linear: what noise adds to the acceleration is the fit of the noise.
        let spline = Spline::fit(&x, &y, SplineKind::Cubic([End::Natural; 2]), None)?;
        Ok(x.iter().map(|x| spline.derivatives(*x)[2].powi(2)).sum::<f64>() / x.len() as f64)
    }))
}

fn fitted(lift: &Lift, width: f64, points: usize, knots: usize) -> Result<f64, FitError> {
    let x: Vec<f64> = (0..points).map(|k| lift.origin() + TAU * k as f64 / points as f64).collect();
    let exact: Vec<[f64; 4]> = x.iter().map(|x| lift.jet(*x)).collect();
    mean((1..=SEEDS).map(|seed| {
        let noise = uniform(seed, points);
        let y: Vec<f64> = exact.iter().zip(noise).map(|(jet, noise)| jet[0] + width * noise).collect();
        let spline = Spline::fit(&x, &y, SplineKind::PeriodicQuintic(TAU), Some(knots))?;
        let squares = x.iter().zip(&exact).map(|(x, jet)| (spline.derivatives(*x)[2] - jet[2]).powi(2));
        Ok(squares.sum::<f64>() / points as f64)
    }))
}

/// Noise of the acceleration of tables of `lift` with uniform noise of `width` (m or rad).
///
/// # Errors
/// [`FitError`], as the fits.
pub fn study(lift: &Lift, width: f64) -> Result<Study, FitError> {
    let mut rows = Vec::new();
    for points in POINTS {
        let mut row = NoiseRow {
            points,
            through: through(width, points)?,
            expected: expected(width, points),
            fitted: [None; KNOTS.len()],
        };
        for (cell, knots) in row.fitted.iter_mut().zip(KNOTS) {
            if 2 * knots <= points {
                *cell = Some(fitted(lift, width, points, knots)?);
            }
        }
        rows.push(row);
    }
    let place = |k: usize| lift.origin() + TAU * k as f64 / 1440.0;
    let largest = (0..1440).map(|k| lift.jet::<f64>(place(k))[2].abs()).fold(0.0, f64::max);
    Ok(Study { width, largest, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form is not in the spline: it follows from its equations.
    #[test]
    fn the_noise_of_the_acceleration_grows_as_the_width_and_the_square_of_the_number() {
        let mut worst = 0.0_f64;
        for points in [45, 90, 180, 360, 720, 1440, 2880] {
            for width in [1e-7, 1e-6, 4e-6] {
                let found = through(width, points).expect("a spline");
                let ratio = found / expected(width, points);
                assert!((0.8..1.2).contains(&ratio), "{points} {width:e}: {ratio}");
                worst = worst.max((ratio - 1.0).abs());
            }
        }
        println!(
            "noise of the second derivative over √3 q N²/(2π)²: within {:.1} %, bound 20 %",
            100.0 * worst
        );
    }

    #[test]
    fn fewer_knots_than_points_keep_the_noise_out() {
        let law = Lift::hump(&[2, 6, 8, 10, 12], 0.011, 160_f64.to_radians()).expect("a law");
        let study = study(&law, 1e-6).expect("fits");
        let last = study.rows.last().expect("rows");
        let [_, _, sixty, _] = last.fitted;
        // A knot in 6°: noise of 1 µm leaves the acceleration; through all points nothing does.
        assert!(sixty.expect("a fit") < 0.005 * study.largest, "{last:?} {}", study.largest);
        assert!(last.through > study.largest, "{last:?} {}", study.largest);
        // More points help a fit with fixed knots.
        let of_sixty: Vec<f64> = study.rows.iter().filter_map(|row| row.fitted[2]).collect();
        assert!(of_sixty.len() == 4 && of_sixty.windows(2).all(|pair| pair[1] < pair[0]), "{of_sixty:?}");
        assert_eq!(study.rows[0].fitted[..2], [None; 2]);
    }
}

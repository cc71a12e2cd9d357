//! Errors of splines along tables of a known function, by number of points, rounding of the ordinates and number of knots.
//!
//! More points bring a spline closer to the function. But its second derivative multiplies the rounding of the ordinates by the
//! square of the number of knots. Between both the error has a lowest point.

use core::fmt;

use mbs_runtime::Reveal;
use mbs_runtime::driver::End;

use super::spline::{Spline, SplineKind};

/// A function over a period: value and two derivatives at an argument in SI.
pub type Law<'a> = &'a dyn Fn(f64) -> [f64; 3];

/// A function of a mechanism's caller, with its name in the text.
pub type NamedLaw = (&'static str, Box<dyn Fn(f64) -> [f64; 3]>);

/// `mechanism` in `f64`, which an expression alone may leave open.
pub fn in_doubles<S: Reveal>(mechanism: S) -> S {
    mechanism
}

/// Form of a spline along a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// Cubic through every point, with the function's slopes at both ends.
    Cubic,
    /// Periodic quintic through every point.
    Quintic,
    /// Periodic quintic by least squares with this many points a knot.
    LeastSquares(usize),
}

/// All forms that are compared.
pub const FORMS: [Form; 6] = [
    Form::Cubic,
    Form::Quintic,
    Form::LeastSquares(2),
    Form::LeastSquares(4),
    Form::LeastSquares(8),
    Form::LeastSquares(16),
];

/// Fewest and most points of a table: each number is twice the one before.
const FEWEST: usize = 30;
const DOUBLINGS: u32 = 7;

/// Fewest knots of a fit.
const FEWEST_KNOTS: usize = 12;

/// Places at which errors are taken, of each point.
const PLACES: usize = 4;

/// Steps to which lengths are rounded (m).
const ROUNDINGS: [f64; 6] = [0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5];

/// The same of other quantities, over their largest value.
const SHARES: [f64; 6] = [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3];

/// A spline of a table with its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Form.
    pub form: Form,
    /// Points of the table.
    pub points: usize,
    /// Step of the ordinates; 0 of exact ones.
    pub rounding: f64,
    /// Largest error of value, first and second derivative, each over its largest magnitude.
    pub errors: [f64; 3],
}

/// Splines of all forms along tables of one function.
#[derive(Clone, Debug)]
pub struct Valley {
    /// Name of the function.
    pub name: String,
    /// Units of value and argument.
    pub units: [String; 2],
    /// Largest magnitudes of value, first and second derivative.
    pub sizes: [f64; 3],
    /// Steps of the ordinates.
    pub roundings: [f64; 6],
    /// Results.
    pub fitted: Vec<Fitted>,
}

impl Form {
    /// Number of knots along so many points.
    pub fn knots(self, points: usize) -> usize {
        match self {
            Form::Cubic => points + 1,
            Form::Quintic => points,
            Form::LeastSquares(share) => points / share,
        }
    }
}

impl Valley {
    /// The study of the function `law` called `name` with this period; `units` of value and argument.
    pub fn of(name: &str, units: [&str; 2], law: Law, period: f64) -> Self {
        let mut sizes = [0.0_f64; 3];
        let most = FEWEST << DOUBLINGS;
        for k in 0..most {
            for (size, value) in sizes.iter_mut().zip(law(period * k as f64 / most as f64)) {
                *size = size.max(value.abs());
            }
        }
        let sizes = sizes.map(|size| if size > 0.0 { size } else { 1.0 });
        let roundings = if units[0] == "m" { ROUNDINGS } else { SHARES.map(|share| share * sizes[0]) };
        let mut fitted = Vec::new();
        for rounding in roundings {
            for form in FORMS {
                for doubling in 0..=DOUBLINGS {
                    let points = FEWEST << doubling;
                    if form.knots(points) < FEWEST_KNOTS {
                        continue;
                    }
                    if let Some(errors) = errors(law, period, form, points, rounding, &sizes) {
                        fitted.push(Fitted { form, points, rounding, errors });
                    }
                }
            }
        }
        Valley { name: name.to_string(), units: units.map(str::to_string), sizes, roundings, fitted }
    }

    /// The spline with the least error of the second derivative for ordinates of this rounding.
    pub fn bottom(&self, rounding: f64) -> Option<&Fitted> {
        let of = self.fitted.iter().filter(|fitted| fitted.rounding == rounding);
        of.min_by(|a, b| a.errors[2].total_cmp(&b.errors[2]))
    }

    /// The least of the forms `allowed` alone.
    fn bottom_of(&self, rounding: f64, allowed: impl Fn(Form) -> bool) -> Option<&Fitted> {
        let of = self.fitted.iter().filter(|fitted| fitted.rounding == rounding && allowed(fitted.form));
        of.min_by(|a, b| a.errors[2].total_cmp(&b.errors[2]))
    }

    /// The choice for ordinates rounded to `rounding`, in words.
    pub fn sentence(&self, rounding: f64) -> Option<String> {
        let best = self.bottom(rounding)?;
        let digits = |value: f64| format!("{value:.1e}");
        let mut text = format!(
            "{} rounded to {rounding:.0e} {}: {} points, {}: second derivative within {} of its largest",
            self.name,
            self.units[0],
            best.points,
            best.form,
            digits(best.errors[2])
        );
        let through = self
            .bottom_of(rounding, |form| form == Form::Quintic)
            .filter(|through| through.form != best.form);
        if let Some(through) = through {
            let (error, points) = (digits(through.errors[2]), through.points);
            text += &format!("; a quintic through every point reaches {error}, with {points} points");
        }
        Some(text + ".")
    }
}

/// Errors of the spline of a form along `points` rounded ordinates; none where there is no such spline.
fn errors(
    law: Law,
    period: f64,
    form: Form,
    points: usize,
    rounding: f64,
    sizes: &[f64; 3],
) -> Option<[f64; 3]> {
    let count = if form == Form::Cubic { points + 1 } else { points };
    let x: Vec<f64> = (0..count).map(|k| period * k as f64 / points as f64).collect();
    let rounded = |y: f64| if rounding > 0.0 { (y / rounding).round() * rounding } else { y };
    let y: Vec<f64> = x.iter().map(|x| rounded(law(*x)[0])).collect();
    let (kind, knots) = match form {
        Form::Cubic => (SplineKind::Cubic([0.0, period].map(|x| End::Slope(law(x)[1]))), None),
        Form::Quintic => (SplineKind::PeriodicQuintic(period), None),
        Form::LeastSquares(_) => (SplineKind::PeriodicQuintic(period), Some(form.knots(points))),
    };
    let spline = Spline::fit(&x, &y, kind, knots).ok()?;
    let places = PLACES * points;
    let mut worst = [0.0_f64; 3];
    for k in 0..places {
        // Neither at points nor in their middles alone.
        let x = period * (k as f64 + 0.39) / places as f64;
        let found = spline.derivatives(x);
        for (order, exact) in law(x).into_iter().enumerate() {
            worst[order] = worst[order].max((found[order] - exact).abs() / sizes[order]);
        }
    }
    Some(worst)
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Form::Cubic => f.write_str("cubic through every point"),
            Form::Quintic => f.write_str("quintic through every point"),
            Form::LeastSquares(share) => write!(f, "least-squares quintic, {share} points a knot"),
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;
    use std::sync::LazyLock;

    use super::*;

    /// Made once for all tests: millimetres of lift with five harmonics, smooth, so that rounding decides early.
    static VALLEY: LazyLock<Valley> = LazyLock::new(|| {
        let law = |x: f64| {
            let mut jet = [0.0; 3];
            for k in 1..=5 {
                let (k, size) = (f64::from(k), 1e-3 / f64::from(k * k));
                let (s, c) = (k * x).sin_cos();
                jet = [jet[0] + size * c, jet[1] - size * k * s, jet[2] - size * k * k * c];
            }
            jet
        };
        Valley::of("lift", ["m", "rad"], &law, TAU)
    });

    fn error(valley: &Valley, form: Form, points: usize, rounding: f64) -> f64 {
        errors(valley, form, points, rounding)[2]
    }

    fn errors(valley: &Valley, form: Form, points: usize, rounding: f64) -> [f64; 3] {
        let found = valley
            .fitted
            .iter()
            .find(|fitted| fitted.form == form && fitted.points == points && fitted.rounding == rounding);
        found.expect("a fit").errors
    }

    /// Exact ordinates of a smooth law: value and two derivatives of a cubic are of orders 4, 3 and 2, those of a quintic of 6, 5 and 4.
    #[test]
    fn exact_points_show_the_orders_of_the_splines() {
        for (form, orders) in [(Form::Cubic, [4.0, 3.0, 2.0]), (Form::Quintic, [6.0, 5.0, 4.0])] {
            let [coarse, fine] = [120, 240].map(|points| errors(&VALLEY, form, points, 0.0));
            let found = [0, 1, 2].map(|derivative| (coarse[derivative] / fine[derivative]).log2());
            println!("{form}: orders {found:.2?} of {orders:?}");
            for (found, order) in found.into_iter().zip(orders) {
                assert!((found - order).abs() < 0.3, "{form}: {found}");
            }
        }
    }

    /// Rounded ordinates: noise of the second derivative grows with the square of the number of points, and with the rounding.
    #[test]
    fn rounding_costs_the_square_of_the_number_of_points() {
        let noisy = |points| error(&VALLEY, Form::Quintic, points, 1e-6);
        let ratio = noisy(1920) / noisy(480);
        assert!((ratio.log2() / 2.0 - 2.0).abs() < 0.4, "{ratio}");
        let coarser = error(&VALLEY, Form::Quintic, 960, 1e-5) / error(&VALLEY, Form::Quintic, 960, 1e-7);
        assert!((30.0..300.0).contains(&coarser), "{coarser}");
    }

    /// The lowest point of each valley lies lower and further right for finer ordinates; fewer knots than points are better.
    #[test]
    fn the_bottom_is_found_and_fewer_knots_lower_it() {
        let bottoms: Vec<&Fitted> =
            VALLEY.roundings.iter().skip(1).filter_map(|rounding| VALLEY.bottom(*rounding)).collect();
        assert!(bottoms.windows(2).all(|pair| pair[0].errors[2] < pair[1].errors[2]), "{bottoms:?}");
        assert!(bottoms.iter().all(|best| matches!(best.form, Form::LeastSquares(_))), "{bottoms:?}");
        let through = VALLEY.bottom_of(1e-6, |form| form == Form::Quintic).expect("a fit");
        let best = VALLEY.bottom(1e-6).expect("a fit");
        assert!(best.errors[2] < 0.5 * through.errors[2], "{best:?} {through:?}");
        let words = VALLEY.sentence(1e-6).expect("words");
        assert!(words.contains("1e-6 m") && words.contains("points a knot"), "{words}");
    }
}

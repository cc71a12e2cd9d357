//! B-spline laws beside polynomials in closed form; refusals.

use core::f64::consts::TAU;

use super::text::parse;
use super::{BSpline, Constraint};
use crate::cams::jet::Jet;
use crate::cams::lift::{Flank, Lift};
use crate::double_double::DoubleDouble;

/// The product of x − root, a hundredth of it, in 32 digits.
struct Polynomial(Vec<f64>);

impl Polynomial {
    fn jet(&self, x: f64) -> [f64; 4] {
        let x = Jet::variable(DoubleDouble::new(x));
        let product =
            self.0.iter().fold(Jet::constant(0.01), |product, root| product * (x - Jet::constant(*root)));
        product.derivatives().map(|value| value.high)
    }
}

fn largest_error(found: impl Fn(f64) -> [f64; 4], exact: impl Fn(f64) -> [f64; 4], range: [f64; 2]) -> f64 {
    let places: Vec<f64> =
        (0..400).map(|k| range[0] + (range[1] - range[0]) * (f64::from(k) + 0.5) / 400.0).collect();
    let mut worst = 0.0_f64;
    for order in 0..4 {
        let scale = places.iter().map(|x| exact(*x)[order].abs()).fold(f64::MIN_POSITIVE, f64::max);
        worst =
            places.iter().map(|x| (found(*x)[order] - exact(*x)[order]).abs() / scale).fold(worst, f64::max);
    }
    worst
}

#[test]
fn a_polynomial_of_the_degree_is_reproduced() {
    let mut worst = 0.0_f64;
    for degree in 4..=8 {
        // Ends where value and velocity vanish, the rest of the roots outside.
        let mut roots = vec![-1.0, -1.0, 1.2, 1.2, -2.0, 2.1, 1.9, -1.7, 2.3];
        roots.truncate(degree);
        let exact = Polynomial(roots);
        for inner in [&[][..], &[0.1], &[-0.5, 0.1, 0.6], &[-0.5, 0.1, 0.1, 0.8]] {
            let knots = [&[-1.0][..], inner, &[1.2]].concat();
            let mut constraints = Vec::new();
            let mut add = |angle: f64, order: usize| {
                constraints.push(Constraint { angle, order, value: exact.jet(angle)[order] });
            };
            for angle in [-1.0, 1.2] {
                add(angle, 0);
                add(angle, 1);
            }
            let left = degree + 1 + inner.len() - 4;
            // One derivative of each order up to the third, then values.
            for k in 0..left {
                add(-1.0 + 2.2 * (k as f64 + 0.6) / (left as f64 + 0.2), if k < 4 { k % 3 } else { 0 });
            }
            let law = BSpline::new(degree, &knots, &constraints, false).expect("a law");
            let error = largest_error(
                |x| law.jet::<f64>(x)[..4].try_into().unwrap_or([f64::NAN; 4]),
                |x| exact.jet(x),
                [-1.0, 1.2],
            );
            assert!(error < 1e-13, "{degree} {inner:?}: {error:e}");
            worst = worst.max(error);
            assert_eq!(law.order(), 1, "{degree}");
        }
    }
    println!("polynomials by B-splines: largest share of an error {worst:.1e}, bound 1e-13");
}

#[test]
fn flanks_of_the_handbook_are_splines_with_knots_that_stand_often() {
    let ends = |j: &str| format!("at 0deg: s = 0, v = 0, a = 0{j}; at 150deg: s = 0, v = 0, a = 0{j}");
    for (flank, text) in [
        (
            Flank::Polynomial345,
            format!(
                "degree 5; knots 0deg 80deg 80deg 80deg 150deg; at 80deg: s = 11mm, v = 0, a = 0; {}",
                ends("")
            ),
        ),
        (
            Flank::Polynomial4567,
            format!(
                "degree 7\nknots 0deg, 80deg 80deg 80deg 80deg 150deg # m\nat 80deg: s = 1.1e-2m, v = 0, a = 0, j = 0\n{}",
                ends(", j = 0")
            ),
        ),
    ] {
        let law = Lift::bspline(parse(&text, false).expect("a law")).expect("a lift");
        let [rise, back] = [80_f64, 70.0].map(f64::to_radians);
        let exact = Lift::flanks(flank, 0.011, [rise, 0.0, back]).expect("a law");
        let error = largest_error(|x| law.jet(x), |x| exact.jet(x), [-1.0, 4.0]);
        assert!(error < 1e-13, "{flank:?}: {error:e}");
        let continuity = law.continuity();
        assert!(continuity.confirms() && continuity.stated == flank.order(), "{flank:?} {continuity:?}");
        assert!(law.with_ramps(1e-4, 0.2).is_ok());
    }
}

#[test]
fn continuity_follows_from_knots_and_ends_and_is_checked() {
    let ends = "at 0deg: s = 0, v = 0, a = 0, j = 0; at 160deg: s = 0, v = 0, a = 0, j = 0; at 80deg: s = 11mm, v = 0";
    let one = "; at 70deg: a = -20mm/rad^2";
    for (head, more, stated) in [
        ("degree 5; knots 0deg 50deg 70deg 90deg 110deg 160deg", "", 3),
        ("degree 6; knots 0deg 70deg 80deg 100deg 160deg", "", 3),
        // A knot that stands three times leaves 5 − 3.
        ("degree 5; knots 0deg 60deg 90deg 90deg 90deg 160deg", "", 2),
        ("degree 4; knots 0deg 40deg 60deg 75deg 95deg 115deg 160deg", "", 3),
        ("degree 5; knots 0deg 50deg 65deg 80deg 95deg 110deg 160deg", one, 3),
    ] {
        let text = format!("{head}; {ends}{more}");
        let law =
            Lift::bspline(parse(&text, false).unwrap_or_else(|why| panic!("{text}: {why}"))).expect("a lift");
        let continuity = law.continuity();
        assert!(continuity.confirms() && continuity.stated == stated, "{text}: {continuity:?}");
        assert!((law.jet::<f64>(80_f64.to_radians())[0] - 0.011).abs() < 1e-15);
        assert_eq!(law.clone().with_polydyne(0.05).is_ok(), stated > 2);
    }
}

/// A periodic law goes on through its period, for an arm too.
#[test]
fn a_periodic_law_has_no_ends() {
    let mut text = "degree 5; periodic; knots".to_string();
    (0..=24).for_each(|k| text += &format!(" {}deg", 15 * k));
    for k in 0..24 {
        let x = (15.0 * f64::from(k)).to_radians();
        text += &format!("\nat {}deg: s = {:?}rad", 15 * k, 0.1 - 0.1 * x.cos());
    }
    let law = parse(&text, true).expect("a law");
    assert_eq!(law.order(), 4);
    let law = Lift::bspline(law).expect("a lift");
    assert!(law.continuity().confirms());
    let error = largest_error(
        |x| law.jet(x),
        |x| [0.1 - 0.1 * x.cos(), 0.1 * x.sin(), 0.1 * x.cos(), -0.1 * x.sin()],
        [0.0, TAU],
    );
    // The third derivative of a quintic spline loses h³/… of the fourth power: 15° leave 1e-4.
    assert!(error < 3e-4, "{error:e}");
}

#[test]
fn conditions_without_a_law_are_refused_with_the_reason() {
    let full = "at 0deg: s = 0, v = 0, a = 0; at 160deg: s = 0, v = 0, a = 0";
    for (text, reason) in [
        (format!("degree 5; knots 0deg 80deg 160deg; {full}"), "6 independent constraints are too few for 7 coefficients"),
        (format!("degree 5; knots 0deg 80deg 160deg; {full}; at 80deg: s = 11mm, v = 1mm/rad; at 40deg: s = 4mm"), "contradicts those on the"),
        (format!("degree 5; knots 0deg 80deg 160deg; {full}; at 80deg: s = 11mm; at 80deg: s = 12mm"), "lift at 80.000 deg contradicts those on the lift at 80.000 deg"),
        // Enough in number, but nothing holds the middle.
        ("degree 3; knots 0deg 10deg 60deg 80deg 100deg 160deg; at 0deg: s = 0, v = 0, a = 0; at 3deg: s = 0; at 6deg: s = 0; at 160deg: s = 0, v = 0, a = 0".to_string(), "too few"),
        (format!("degree 1; knots 0deg 80deg 160deg; {full}"), "a degree of 1"),
        (format!("degree 5; knots 0deg 200deg 400deg; {full}"), "more than a turn"),
        (format!("degree 5; knots 0deg 90deg 80deg 160deg; {full}"), "comes after a larger one"),
        (format!("degree 5; knots 0deg 80deg 160deg; {full}; at 170deg: s = 0"), "beyond the knots"),
        ("degree 2; knots 0deg 80deg 160deg; at 80deg: a = 0".to_string(), "may jump at that knot"),
        ("degree 5; knots 0deg 160deg; at 0deg: s = 1mm, v = 0, a = 0; at 160deg: s = 0, v = 0, a = 0".to_string(), "the lift jumps at 0.000 deg"),
        (format!("degree 5; periodic; knots 0deg 80deg 160deg; {full}"), "span a turn"),
        (format!("knots 0deg 80deg 160deg; {full}"), "the degree is missing"),
        ("degree 5; knots 0 80 160deg".to_string(), "`80` needs a unit"),
        ("degree 5; at 0deg: x = 0".to_string(), "derivatives are `v`"),
        ("degree 5; at 0deg: s = 5deg".to_string(), "is not in `m`"),
        ("degree 5; at 0deg s = 5mm".to_string(), "a colon"),
        ("degree 5; knot 0deg".to_string(), "statements are"),
    ] {
        let found = parse(&text, false).map(|law| law.order());
        let message = found.expect_err(&text).to_string();
        assert!(message.contains(reason) && message.contains("B-spline"), "{text}: {message}");
    }
    // Constraints that follow from others and agree with them are kept.
    let twice = format!("degree 5; knots 0deg 80deg 160deg; {full}; at 80deg: s = 11mm, v = 0, j = 0");
    parse(&twice, false).expect("constraints that agree");
    let slow = "degree 3; knots 0deg 80deg 160deg; at 0deg: s = 0; at 80deg: s = 5mm, v = 0, a = 0; at 160deg: s = 0";
    assert!(parse(slow, false).and_then(Lift::bspline).is_err());
}

//! Tables of a mechanism's functions: data for the page, a picture of the valleys, a line a spline.

use std::fmt::Write;

use serde::Serialize;

use crate::cost::picture::{Axis, power_of_ten};
use crate::output::svg::{COLOURS, label, open};
use crate::tables::valley::{FORMS, Fitted, Form, Valley};

const WIDTH: f64 = 900.0;
const PANEL: f64 = 400.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 350.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 50.0;

/// Splines along tables of one function, as the page shows them.
#[derive(Serialize)]
pub struct PageValley<'a> {
    name: &'a str,
    unit: &'a str,
    roundings: &'a [f64],
    forms: Vec<String>,
    /// A line a rounding, empty without one.
    sentences: Vec<String>,
    points: Vec<PageSpline>,
}

/// A spline: index of its form and of its rounding.
#[derive(Serialize)]
struct PageSpline {
    form: usize,
    rounding: usize,
    points: usize,
    knots: usize,
    errors: [f64; 3],
}

/// Data of the page.
pub fn page(valleys: &[Valley]) -> Vec<PageValley<'_>> {
    let one = |valley: &'_ Valley| -> Vec<PageSpline> {
        let spline = |fitted: &Fitted| {
            let form = FORMS.iter().position(|form| *form == fitted.form)?;
            let rounding = valley.roundings.iter().position(|rounding| *rounding == fitted.rounding)?;
            let (points, errors) = (fitted.points, fitted.errors);
            Some(PageSpline { form, rounding, points, knots: fitted.form.knots(points), errors })
        };
        valley.fitted.iter().filter_map(spline).collect()
    };
    let sentence = |valley: &Valley, rounding: f64| valley.sentence(rounding).unwrap_or_default();
    valleys
        .iter()
        .map(|valley| PageValley {
            name: &valley.name,
            unit: &valley.units[0],
            roundings: &valley.roundings,
            forms: FORMS.iter().map(Form::to_string).collect(),
            sentences: valley.roundings.iter().map(|rounding| sentence(valley, *rounding)).collect(),
            points: one(valley),
        })
        .collect()
}

/// One line a spline.
pub fn csv(valleys: &[Valley]) -> String {
    let mut text =
        "function,spline,points,knots,rounding,value error,first derivative error,second derivative error\n"
            .to_string();
    for valley in valleys {
        for Fitted { form, points, rounding, errors } in &valley.fitted {
            let [value, first, second] = errors;
            let knots = form.knots(*points);
            let _ = writeln!(
                text,
                "{},\"{form}\",{points},{knots},{rounding:e},{value:e},{first:e},{second:e}",
                valley.name
            );
        }
    }
    text
}

/// The error of the second derivative over the number of points for each rounding, one panel for each function. A line is the spline
/// through every point, a dashed line the best fit of fewer knots, a ring the lowest point of all.
pub fn picture(valleys: &[Valley]) -> String {
    let mut svg = open(WIDTH as usize, (PANEL * valleys.len() as f64) as usize);
    for (index, valley) in valleys.iter().enumerate() {
        panel(&mut svg, PANEL * index as f64, valley);
    }
    svg + "</svg>\n"
}

fn panel(svg: &mut String, above: f64, valley: &Valley) {
    let across = Axis::of(valley.fitted.iter().map(|one| one.points as f64), LEFT, WIDTH - RIGHT);
    let errors = valley.fitted.iter().map(|one| one.errors[2].clamp(1e-17, 10.0));
    let up = Axis::of(errors, above + PANEL - BOTTOM, above + TOP);
    let words = format!("Tables of {}: error of the second derivative, of its largest", valley.name);
    label(svg, LEFT as usize, (above + 30.0) as usize, "font-size=\"16\" font-weight=\"bold\"", &words);
    let (Some(across), Some(up)) = (across, up) else { return };
    let floor = above + PANEL - BOTTOM;
    for (power, x) in across.marks() {
        let _ = writeln!(svg, "<path d=\"M{x:.1} {:.1}V{floor:.1}\" stroke=\"#ddd\"/>", above + TOP);
        power_of_ten(svg, x, floor + 18.0, "middle", power);
    }
    for (power, y) in up.marks() {
        let _ = writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#ddd\"/>", WIDTH - RIGHT);
        power_of_ten(svg, LEFT - 8.0, y + 4.0, "end", power);
    }
    let middle = (LEFT + WIDTH - RIGHT) / 2.0;
    label(svg, middle as usize, (floor + 38.0) as usize, "text-anchor=\"middle\"", "points a period");
    let at = |points: usize, error: f64| format!("{:.1} {:.1}", across.at(points as f64), up.at(error));
    let x = WIDTH - RIGHT + 20.0;
    for (k, rounding) in valley.roundings.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let of = || valley.fitted.iter().filter(|one| one.rounding == *rounding);
        let through: Vec<String> =
            of().filter(|one| one.form == Form::Quintic).map(|one| at(one.points, one.errors[2])).collect();
        let mut counts: Vec<usize> = of().map(|one| one.points).collect();
        counts.sort_unstable();
        counts.dedup();
        let least = |points: usize| {
            of().filter(|one| one.points == points).map(|one| one.errors[2]).fold(f64::INFINITY, f64::min)
        };
        let best: Vec<String> = counts.iter().map(|points| at(*points, least(*points))).collect();
        let line = |svg: &mut String, d: &str, dash: &str| {
            let _ = writeln!(
                svg,
                "<path d=\"M{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"{dash}/>"
            );
        };
        line(svg, &through.join("L"), "");
        line(svg, &best.join("L"), " stroke-dasharray=\"5 3\"");
        if let Some(bottom) = valley.bottom(*rounding) {
            let place = at(bottom.points, bottom.errors[2]);
            let (cx, cy) = place.split_once(' ').unwrap_or_default();
            let _ = writeln!(
                svg,
                "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"5\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>"
            );
        }
        let y = above + TOP + 20.0 * k as f64 + 10.0;
        let words = match rounding {
            0.0 => "exact points".to_string(),
            rounding => format!("rounded to {rounding:.0e} {}", valley.units[0]),
        };
        line(svg, &format!("{x} {y:.1}h22"), "");
        label(svg, (x + 28.0) as usize, (y + 4.0) as usize, "font-size=\"12\"", &words);
    }
    let y = above + TOP + 20.0 * valley.roundings.len() as f64 + 14.0;
    for (k, words) in
        ["line: quintic through every point", "dashed: the best with fewer knots", "ring: the least error"]
            .iter()
            .enumerate()
    {
        label(svg, x as usize, (y + 18.0 * k as f64) as usize, "font-size=\"12\" fill=\"#555\"", words);
    }
}

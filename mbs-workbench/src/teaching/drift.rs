//! Drift of the constraints: one motion by several stabilisations, over a logarithmic axis.

use std::fmt::Write;

use crate::motion::{Motion, spread};
use crate::output::svg::{COLOURS, label, open};

/// Violation of the constraints and energy defect of one method.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name of the method.
    pub method: String,
    /// Instants (s).
    pub time: Vec<f64>,
    /// Largest |Φᵢ| over its row's scale.
    pub closure: Vec<f64>,
    /// |Energy balance defect| (J).
    pub defect: Vec<f64>,
    /// Time (s) at which the motion was lost, where it was.
    pub lost: Option<f64>,
}

/// Size of a panel and the room around it, in pixels.
const WIDTH: usize = 640;
const HEIGHT: usize = 240;
const LEFT: usize = 80;
const TOP: usize = 50;
const GAP: usize = 60;

/// Points of a curve; more are not seen.
const POINTS: usize = 800;

/// The smallest power of ten on an axis, also for zero: below the rounding of one operation.
const LEAST: i32 = -18;

impl Curve {
    /// That of a motion from forces, which ended early where it is `lost`.
    pub fn of(method: String, motion: &Motion, lost: bool) -> Self {
        let defect = motion
            .dynamics
            .as_ref()
            .map_or_else(Vec::new, |forces| forces.defect.iter().map(|defect| defect.abs()).collect());
        let lost = motion.time.last().copied().filter(|_| lost);
        Curve { method, time: motion.time.clone(), closure: motion.closure.clone(), defect, lost }
    }
}

/// Values of a curve that a panel shows.
type Part = fn(&Curve) -> &Vec<f64>;

/// Violations above, energy below, one colour for each method. The axes fit the methods that last. The curve of a lost motion
/// leaves the panel at the top; a cross marks its end.
pub fn picture(title: &str, until: f64, curves: &[Curve]) -> String {
    let mut svg = open(LEFT + WIDTH + 30, TOP + 2 * HEIGHT + GAP + 70);
    label(&mut svg, 12, 20, "font-weight=\"bold\"", title);
    let panels: [(&str, Part); 2] = [
        ("largest |Φ|, of the reference length", |curve| &curve.closure),
        ("|energy balance defect| (J)", |curve| &curve.defect),
    ];
    for (place, (heading, values)) in panels.into_iter().enumerate() {
        let top = TOP + place * (HEIGHT + GAP);
        label(&mut svg, LEFT, top - 8, "", heading);
        let all_lost = curves.iter().all(|curve| curve.lost.is_some());
        let shown = curves.iter().filter(|curve| all_lost || curve.lost.is_none());
        let range = powers(shown.flat_map(values));
        axes(&mut svg, top, range, until);
        for (curve, colour) in curves.iter().zip(COLOURS) {
            path(&mut svg, (top, range, until), (&curve.time, values(curve)), colour);
            if let (Some(t), Some(value)) = (curve.lost, values(curve).last()) {
                let x = LEFT as f64 + WIDTH as f64 * t / until;
                cross(&mut svg, x, height(top, range, *value), colour);
            }
        }
    }
    legend(&mut svg, curves);
    svg + "</svg>\n"
}

/// Powers of ten that hold all values, at least two apart.
fn powers<'a>(values: impl Iterator<Item = &'a f64>) -> [i32; 2] {
    let mut range = [i32::MAX, i32::MIN];
    for value in values.filter(|value| **value > 0.0 && value.is_finite()) {
        let power = value.log10();
        range = [range[0].min(power.floor() as i32), range[1].max(power.ceil() as i32)];
    }
    let [low, high] = if range[0] > range[1] { [LEAST, LEAST + 2] } else { range };
    let low = low.max(LEAST);
    [low, high.max(low + 2)]
}

/// Height (pixels) of a value in a panel.
fn height(top: usize, [low, high]: [i32; 2], value: f64) -> f64 {
    let power = if value > 0.0 { value.log10() } else { f64::from(low) };
    let power = power.clamp(f64::from(low), f64::from(high));
    top as f64 + HEIGHT as f64 * (f64::from(high) - power) / f64::from(high - low)
}

fn axes(svg: &mut String, top: usize, range: [i32; 2], until: f64) {
    let right = LEFT + WIDTH;
    let stride = (range[1] - range[0] + 5) / 6;
    for power in (range[0]..=range[1]).step_by(stride as usize) {
        let y = height(top, range, 10_f64.powi(power));
        let _ = writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"#dddddd\"/>");
        label(svg, LEFT - 8, y as usize + 4, "text-anchor=\"end\"", &format!("1e{power}"));
    }
    for quarter in 0..=4 {
        let x = LEFT + WIDTH * quarter / 4;
        let _ = writeln!(svg, "<path d=\"M{x} {top}V{}\" stroke=\"#dddddd\"/>", top + HEIGHT);
        let text = format!("{}", until * quarter as f64 / 4.0);
        label(svg, x, top + HEIGHT + 18, "text-anchor=\"middle\"", &text);
    }
    label(svg, LEFT + WIDTH / 2, top + HEIGHT + 34, "text-anchor=\"middle\"", "t (s)");
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{top}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#888888\"/>"
    );
}

fn path(
    svg: &mut String,
    (top, range, until): (usize, [i32; 2], f64),
    (time, values): (&[f64], &[f64]),
    colour: &str,
) {
    let points = spread(time.len().min(values.len()), POINTS).into_iter().map(|index| {
        let x = LEFT as f64 + WIDTH as f64 * time[index] / until;
        format!("{x:.1},{:.1}", height(top, range, values[index]))
    });
    let points: Vec<String> = points.collect();
    let _ = writeln!(
        svg,
        "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\" points=\"{}\"/>",
        points.join(" ")
    );
}

/// Cross at the time at which a motion is lost.
fn cross(svg: &mut String, x: f64, y: f64, colour: &str) {
    let _ = writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}l12 12m0 -12l-12 12\" stroke=\"{colour}\" stroke-width=\"2.5\"/>",
        x - 6.0,
        y - 6.0
    );
}

fn legend(svg: &mut String, curves: &[Curve]) {
    let y = TOP + 2 * HEIGHT + GAP + 54;
    let mut x = LEFT;
    for (curve, colour) in curves.iter().zip(COLOURS) {
        let _ = writeln!(svg, "<path d=\"M{x} {}h26\" stroke=\"{colour}\" stroke-width=\"3\"/>", y - 4);
        let lost = curve.lost.map_or_else(String::new, |t| format!(", lost at {t} s"));
        let text = format!("{}{lost}", curve.method);
        label(svg, x + 34, y, "", &text);
        // Eight pixels a letter at 13 pixels' height.
        x += 60 + 8 * text.chars().count();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_all_values_and_zero_stands_at_the_bottom() {
        assert_eq!(powers([0.0, 3e-9, 2e-4].iter()), [-9, -3]);
        assert_eq!(powers([0.0].iter()), [LEAST, LEAST + 2]);
        assert_eq!(height(10, [-9, -3], 0.0), (10 + HEIGHT) as f64);
        assert_eq!(height(10, [-9, -3], 1e-3), 10.0);
    }

    #[test]
    fn every_method_has_its_curves_and_its_name() {
        let curve = |method: &str, closure: f64| Curve {
            method: method.to_string(),
            time: vec![0.0, 1.0, 2.0],
            closure: vec![0.0, closure, 10.0 * closure],
            defect: vec![0.0, 1e-12, 1e-11],
            lost: None,
        };
        let svg = picture("A & B", 2.0, &[curve("none", 1e-6), curve("projection", 1e-16)]);
        assert_eq!(svg.matches("<polyline").count(), 4);
        assert!(
            svg.contains(">none</text>") && svg.contains(">projection</text>") && svg.contains("A &amp; B")
        );
        assert!(svg.contains("1e-16") && svg.ends_with("</svg>\n"));
    }

    #[test]
    fn a_lost_motion_leaves_the_panel_and_does_not_flatten_the_others() {
        let curve = |method: &str, closure: f64, lost: Option<f64>| Curve {
            method: method.to_string(),
            time: vec![0.0, 0.01],
            closure: vec![0.0, closure],
            defect: vec![0.0, closure],
            lost,
        };
        let svg = picture("A", 2.0, &[curve("none", 1e6, Some(0.01)), curve("projection", 1e-13, None)]);
        assert!(
            svg.contains(">none, lost at 0.01 s</text>") && svg.contains("1e-13") && !svg.contains("1e6")
        );
        // At the top of the panel.
        assert_eq!(svg.matches("l12 12m0 -12l-12 12").count(), 2);
        assert_eq!(height(10, [-14, -12], 1e6), 10.0);
    }
}

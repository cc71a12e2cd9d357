//! Curves as inline SVG. Colours are classes of the page's style, so that they follow the reader's theme.

use core::fmt::Write;

use super::Picture;
use crate::output::page::escaped;

const WIDTH: f64 = 680.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 44.0;

/// Curves over one axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Heading of the picture.
    pub caption: String,
    /// Name and unit of the axis to the right.
    pub x: String,
    /// Name and unit of the axis upwards.
    pub y: String,
    /// Areas between a lower and an upper value.
    pub bands: Vec<(String, Vec<[f64; 3]>)>,
    /// Curves in the order of their colours.
    pub curves: Vec<Curve>,
    /// Intervals of x that are marked, with the meaning of the mark.
    pub marks: Option<(String, Vec<[f64; 2]>)>,
    /// Largest magnitude of y that is shown, where a peak would flatten all else.
    pub most: Option<f64>,
}

/// A curve of a plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// Places.
    pub points: Vec<[f64; 2]>,
    /// `true` of a reference, drawn with dashes.
    pub is_dashed: bool,
}

impl Curve {
    /// Through `y` over `x`.
    pub fn new(label: &str, x: &[f64], y: &[f64]) -> Self {
        let points = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
        Curve { label: label.to_string(), points, is_dashed: false }
    }

    /// With dashes.
    pub fn dashed(self) -> Self {
        Curve { is_dashed: true, ..self }
    }
}

/// Intervals of one axis in rows, one a subject.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Heading of the picture.
    pub caption: String,
    /// Name and unit of the axis to the right.
    pub x: String,
    /// Both ends of the axis.
    pub ends: [f64; 2],
    /// Subjects with their intervals.
    pub rows: Vec<(String, Vec<[f64; 2]>)>,
}

impl Timeline {
    /// The rows as a picture.
    pub fn picture(&self) -> Picture {
        const ROW: f64 = 30.0;
        const NAMES: f64 = 150.0;
        let [low, high] = self.ends;
        let x = |value: f64| NAMES + (value - low) / (high - low) * (WIDTH - NAMES - RIGHT);
        let height = ROW * self.rows.len() as f64 + 40.0;
        let bottom = height - 24.0;
        let mut svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{}\">\n",
            escaped(&self.caption)
        );
        for value in eighths(low, high) {
            let at = x(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} 16V{bottom:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                written(value)
            );
        }
        for (index, (name, spans)) in self.rows.iter().enumerate() {
            let top = 20.0 + ROW * index as f64;
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                NAMES - 8.0,
                top + 15.0,
                escaped(name)
            );
            for [from, to] in spans {
                let width = (x(*to) - x(*from)).max(0.8);
                let _ = writeln!(
                    svg,
                    "<rect class=\"bar line{}\" x=\"{:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"20\"/>",
                    index % 6,
                    x(*from)
                );
            }
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"12\" text-anchor=\"end\">{}</text></svg>",
            WIDTH - RIGHT,
            escaped(&self.x)
        );
        Picture { caption: self.caption.clone(), svg }
    }
}

/// About five round numbers between both ends.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let first = (low / step).ceil() as i64;
    let count = (((high / step).floor() as i64) - first + 1).clamp(0, 20);
    (0..count).map(|k| (first + k) as f64 * step).collect()
}

/// Eighths of a turn between both ends (deg); of a shorter range round numbers.
fn eighths(low: f64, high: f64) -> Vec<f64> {
    let step = 45.0;
    let [first, last] = [(low / step).ceil() as i64, (high / step).floor() as i64];
    let is_turn = (4..=9).contains(&(last - first));
    if is_turn { (first..=last).map(|k| k as f64 * step).collect() } else { ticks(low, high) }
}

fn written(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-4 {
        return format!("{value:.1e}");
    }
    let text = format!("{:.6}", value);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" || text.is_empty() { "0".to_string() } else { text.to_string() }
}

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    let [low, high] = finite
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low < high {
        [low, high]
    } else if low.is_finite() {
        [low - 1.0, high + 1.0]
    } else {
        [0.0, 1.0]
    }
}

impl Plot {
    /// The plot as a picture.
    pub fn picture(&self) -> Picture {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let areas = || self.bands.iter().flat_map(|(_, points)| points);
        let [left, right] = ends(points().map(|p| p[0]).chain(areas().map(|p| p[0])));
        let values = points().map(|p| p[1]).chain(areas().flat_map(|p| [p[1], p[2]]));
        let [mut low, mut high] = ends(values);
        if let Some(most) = self.most {
            (low, high) = (low.max(-most), high.min(most));
        }
        let room = 0.04 * (high - low);
        (low, high) = (low - room, high + room);
        let x = |value: f64| LEFT + (value - left) / (right - left) * (WIDTH - LEFT - RIGHT);
        let y = |value: f64| {
            let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
            HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)
        };
        let mut svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n",
            escaped(&self.caption)
        );
        let bottom = HEIGHT - BOTTOM;
        for value in ticks(low, high) {
            let at = y(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                at + 4.0,
                written(value)
            );
        }
        let along = if self.x.ends_with("(deg)") { eighths(left, right) } else { ticks(left, right) };
        for value in along {
            let at = x(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                written(value)
            );
        }
        if let Some((_, spans)) = &self.marks {
            for [from, to] in spans {
                let width = (x(*to) - x(*from)).max(0.8);
                let _ = writeln!(
                    svg,
                    "<rect class=\"mark\" x=\"{:.1}\" y=\"{TOP}\" width=\"{width:.1}\" height=\"{:.1}\"/>",
                    x(*from),
                    bottom - TOP
                );
            }
        }
        let path = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let mut text = String::new();
            for [a, b] in points.filter(|[a, b]| a.is_finite() && b.is_finite()) {
                let _ = write!(text, "{}{:.1} {:.1}", if text.is_empty() { 'M' } else { 'L' }, x(a), y(b));
            }
            text
        };
        for (_, points) in &self.bands {
            let back = points.iter().rev().map(|p| [p[0], p[2]]);
            let outline = path(&mut points.iter().map(|p| [p[0], p[1]]).chain(back));
            let _ = writeln!(svg, "<path class=\"band\" d=\"{outline}Z\"/>");
        }
        for (index, curve) in self.curves.iter().enumerate() {
            let dashes = if curve.is_dashed { " dashed" } else { "" };
            let line = path(&mut curve.points.iter().copied());
            let _ = writeln!(svg, "<path class=\"curve line{}{dashes}\" d=\"{line}\"/>", index % 6);
        }
        self.legend(&mut svg);
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><text x=\"4\" y=\"14\">{}</text></svg>",
            WIDTH - RIGHT,
            14.0,
            escaped(&self.x),
            escaped(&self.y)
        );
        Picture { caption: self.caption.clone(), svg }
    }

    /// Names of curves, bands and marks in a row below the axis.
    fn legend(&self, svg: &mut String) {
        let dashes = |curve: &Curve| if curve.is_dashed { " dashed" } else { "" };
        let curves = self.curves.iter().enumerate().map(|(index, curve)| {
            (format!("curve line{}{}", index % 6, dashes(curve)), curve.label.as_str())
        });
        let bands = self.bands.iter().map(|(label, _)| ("band".to_string(), label.as_str()));
        let marks = self.marks.iter().map(|(label, _)| ("mark".to_string(), label.as_str()));
        let mut at = LEFT;
        for (class, label) in curves.chain(bands).chain(marks) {
            let shape = if class.starts_with("curve") { "h16" } else { "v-5h16v10h-16Z" };
            let _ = writeln!(
                svg,
                "<path class=\"{class}\" d=\"M{at:.1} {:.1}{shape}\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                HEIGHT - 12.0,
                at + 20.0,
                HEIGHT - 8.0,
                escaped(label)
            );
            at += 34.0 + 6.6 * label.chars().count() as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        assert_eq!(ticks(-180.0, 180.0), [-100.0, 0.0, 100.0]);
        assert_eq!(ticks(0.0, 1.0), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(eighths(-179.75, 180.0).len(), 8);
        assert_eq!(eighths(0.0, 10.0), ticks(0.0, 10.0));
        for [low, high] in [[1e-9, 3e-9], [-7e5, 2e4], [12.0, 12.5]] {
            let found = ticks(low, high);
            assert!((2..=7).contains(&found.len()), "{found:?}");
            let rounding = 1e-9 * (high - low);
            assert!(
                found.iter().all(|tick| low - rounding <= *tick && *tick <= high + rounding),
                "{found:?}"
            );
        }
    }

    #[test]
    fn intervals_are_bars_to_scale() {
        let rows = vec![("seat".to_string(), vec![[-180.0, 0.0]]), ("cam".to_string(), Vec::new())];
        let line = Timeline { ends: [-180.0, 180.0], rows, ..Timeline::default() };
        let svg = line.picture().svg;
        // Half of the 518 units between the names and the margin.
        assert_eq!(svg.matches("class=\"bar").count(), 1);
        assert!(svg.contains("x=\"150.0\" y=\"20.0\" width=\"259.0\""), "{svg}");
    }

    #[test]
    fn numbers_that_are_none_are_left_out_and_words_are_escaped() {
        let curve = Curve::new("a<b", &[0.0, 1.0, 2.0], &[0.0, f64::NAN, 4.0]);
        let plot = Plot {
            caption: "x & y".to_string(),
            curves: vec![curve.dashed()],
            marks: Some(("lost".to_string(), vec![[0.5, 1.0]])),
            bands: vec![("all".to_string(), vec![[0.0, -1.0, 1.0], [2.0, -2.0, 2.0]])],
            ..Plot::default()
        };
        let svg = plot.picture().svg;
        assert!(!svg.contains("NaN") && svg.contains("a&lt;b") && svg.contains("x &amp; y"), "{svg}");
        assert_eq!(svg.matches("class=\"mark\"").count(), 2);
        assert_eq!(svg.matches("class=\"band\"").count(), 2);
        // A plot without a point has axes.
        assert!(!Plot::default().picture().svg.contains("inf"));
    }
}

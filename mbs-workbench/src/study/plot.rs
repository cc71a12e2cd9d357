//! Curves as inline SVG. Colours are classes of the page's style, so that they follow the reader's theme.

use core::fmt::Write;

use super::Picture;
use crate::output::page::escaped;

const RIGHT: f64 = 12.0;
const TOP: f64 = 30.0;
/// Height of a row of the legend.
const ROW: f64 = 18.0;
/// Width of a letter of 12 units.
const LETTER: f64 = 6.6;

/// A drawing for one width of the reader's screen, of which the page shows one, or for a file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    /// Class in the page's style; a file brings its own.
    class: Option<&'static str>,
    width: f64,
    height: f64,
    /// Room for the numbers of the axis.
    left: f64,
    /// Room below the axis; in a file the name of the axis stands there too.
    below: f64,
    /// Angle between two lines of the grid (deg).
    step: f64,
}

const WIDE: Frame =
    Frame { class: Some("wide"), width: 680.0, height: 330.0, left: 74.0, below: 44.0, step: 45.0 };
const NARROW: Frame =
    Frame { class: Some("narrow"), width: 350.0, height: 250.0, left: 52.0, below: 44.0, step: 90.0 };
const FILE: Frame = Frame { class: None, width: 640.0, height: 330.0, left: 62.0, below: 64.0, step: 45.0 };

/// Style of a file: the page's colours of light themes, on white ground.
const STYLE: &str = "text { fill: #3d4656; font: 12px sans-serif } .grid { stroke: #dde1e7; fill: none } \
    .curve { fill: none; stroke-width: 1.6; stroke-linejoin: round } .dashed { stroke-dasharray: 5 4 } \
    .line0 { stroke: #0072b2 } .line1 { stroke: #d55e00 } .line2 { stroke: #009e73 } .line3 { stroke: #b3669a } \
    .line4 { stroke: #b58900 } .line5 { stroke: #66707f } .band { fill: #0072b2; fill-opacity: .22 } \
    .mark { fill: #d55e00; fill-opacity: .18 }";

impl Frame {
    /// First lines of a drawing of `height`.
    fn opened(self, height: f64, caption: &str) -> String {
        let (width, caption) = (self.width, escaped(caption));
        match self.class {
            Some(class) => format!(
                "<svg class=\"{class}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{caption}\">\n"
            ),
            None => format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
                 height=\"{height}\" role=\"img\" aria-label=\"{caption}\">\n<style>{STYLE}</style>\n\
                 <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
            ),
        }
    }
}

/// The drawing for both widths.
fn for_both(drawn: impl Fn(Frame) -> String) -> String {
    [WIDE, NARROW].map(drawn).concat()
}

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
    /// `true` if both axes are logarithmic; all values are then above 0.
    pub is_logarithmic: bool,
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
        Picture { caption: self.caption.clone(), svg: for_both(|frame| self.drawn(frame)) }
    }

    fn drawn(&self, frame: Frame) -> String {
        const ROW: f64 = 30.0;
        let Frame { width, .. } = frame;
        let longest = self.rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        let names = 14.0 + LETTER * longest as f64;
        let [low, high] = self.ends;
        let x = |value: f64| names + (value - low) / (high - low) * (width - names - RIGHT);
        let height = ROW * self.rows.len() as f64 + 40.0;
        let bottom = height - 24.0;
        let mut svg = frame.opened(height, &self.caption);
        for value in parts_of_a_turn([low, high], frame) {
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
                names - 8.0,
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
            width - RIGHT,
            escaped(&self.x)
        );
        svg
    }
}

/// About five round numbers between both ends.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    // An end that is a round number stays one: 0.3 is less than 3 times 0.1.
    let rounding = 1e-9;
    let first = (low / step - rounding).ceil() as i64;
    let count = (((high / step + rounding).floor() as i64) - first + 1).clamp(0, 20);
    (0..count).map(|k| (first + k) as f64 * step).collect()
}

/// Equal parts of a turn between both ends (deg); of a shorter range round numbers.
fn parts_of_a_turn([low, high]: [f64; 2], Frame { step, .. }: Frame) -> Vec<f64> {
    let [first, last] = [(low / step).ceil() as i64, (high / step).floor() as i64];
    let is_turn = (4..=9).contains(&(((high - low) / 45.0).round() as i64));
    if is_turn { (first..=last).map(|k| k as f64 * step).collect() } else { ticks(low, high) }
}

/// Logarithms of round numbers between those of both ends, with the numbers: powers of 10 or, of a short range, 1, 2 and 5 times these.
fn decades(low: f64, high: f64) -> Vec<(f64, String)> {
    let [first, last] = [low.floor() as i32, high.ceil() as i32];
    let factors: &[f64] = if high - low < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let thinned = ((last - first) / 6).max(1) as usize;
    (first..=last)
        .step_by(thinned)
        .flat_map(|power| factors.iter().map(move |factor| factor * 10.0_f64.powi(power)))
        .filter(|value| (low..=high).contains(&value.log10()))
        .map(|value| {
            let is_short = (1e-3..1e6).contains(&value);
            (value.log10(), if is_short { written(value) } else { format!("{value:.0e}") })
        })
        .collect()
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
        Picture { caption: self.caption.clone(), svg: for_both(|frame| self.drawn(frame)) }
    }

    /// The plot as a file of its own, on white ground.
    pub fn file(&self) -> String {
        self.drawn(FILE)
    }

    /// A place on the paper before it is scaled.
    fn scale(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.log10() } else { value }
    }

    /// Round numbers of an axis with their names.
    fn round(&self, low: f64, high: f64) -> Vec<(f64, String)> {
        match self.is_logarithmic {
            true => decades(low, high),
            false => ticks(low, high).into_iter().map(|value| (value, written(value))).collect(),
        }
    }

    fn drawn(&self, frame: Frame) -> String {
        let Frame { width, left: margin, .. } = frame;
        let (keys, rows) = self.keys(frame);
        let height = frame.height + ROW * (rows - 1) as f64;
        let bottom = frame.height - frame.below;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let areas = || self.bands.iter().flat_map(|(_, points)| points);
        let scale = |value| self.scale(value);
        let [left, right] = ends(points().map(|p| scale(p[0])).chain(areas().map(|p| scale(p[0]))));
        let values = points().map(|p| p[1]).chain(areas().flat_map(|p| [p[1], p[2]])).map(scale);
        let [mut low, mut high] = ends(values);
        if let Some(most) = self.most {
            (low, high) = (low.max(-most), high.min(most));
        }
        let room = 0.04 * (high - low);
        (low, high) = (low - room, high + room);
        let x = |value: f64| margin + (value - left) / (right - left) * (width - margin - RIGHT);
        let y = |value: f64| {
            let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
            bottom - share * (bottom - TOP)
        };
        let mut svg = frame.opened(height, &self.caption);
        for (value, name) in self.round(low, high) {
            let at = y(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{margin} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>",
                width - RIGHT,
                margin - 6.0,
                at + 4.0
            );
        }
        let along = match self.x.ends_with("(deg)") {
            true => parts_of_a_turn([left, right], frame).into_iter().map(|at| (at, written(at))).collect(),
            false => self.round(left, right),
        };
        for (value, name) in along {
            let at = x(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{name}</text>",
                bottom + 17.0
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
            let scaled = points.map(|point| point.map(scale));
            for [a, b] in scaled.filter(|[a, b]| a.is_finite() && b.is_finite()) {
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
        svg += &keys;
        let above = if frame.class.is_some() { 14.0 } else { bottom + 35.0 };
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{above:.1}\" text-anchor=\"end\">{}</text><text x=\"4\" y=\"14\">{}</text></svg>",
            width - RIGHT,
            escaped(&self.x),
            escaped(&self.y)
        );
        svg
    }

    /// Names of curves, bands and marks below the axis, and the number of rows that they take.
    fn keys(&self, Frame { width, height, left, .. }: Frame) -> (String, usize) {
        let dashes = |curve: &Curve| if curve.is_dashed { " dashed" } else { "" };
        let curves = self.curves.iter().enumerate().map(|(index, curve)| {
            (format!("curve line{}{}", index % 6, dashes(curve)), curve.label.as_str())
        });
        let bands = self.bands.iter().map(|(label, _)| ("band".to_string(), label.as_str()));
        let marks = self.marks.iter().map(|(label, _)| ("mark".to_string(), label.as_str()));
        let (mut at, mut rows, mut svg) = (left, 1, String::new());
        for (class, label) in curves.chain(bands).chain(marks) {
            let long = 20.0 + LETTER * label.chars().count() as f64;
            if at > left && at + long > width {
                (at, rows) = (left, rows + 1);
            }
            let bottom = height + ROW * (rows - 1) as f64;
            let shape = if class.starts_with("curve") { "h16" } else { "v-5h16v10h-16Z" };
            let _ = writeln!(
                svg,
                "<path class=\"{class}\" d=\"M{at:.1} {:.1}{shape}\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                bottom - 12.0,
                at + 20.0,
                bottom - 8.0,
                escaped(label)
            );
            at += 14.0 + long;
        }
        (svg, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        assert_eq!(ticks(-180.0, 180.0), [-100.0, 0.0, 100.0]);
        assert_eq!(ticks(0.0, 1.0), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(0.0, 0.3).len(), 4);
        assert_eq!(ticks(0.3, 0.6).len(), 4);
        assert_eq!(parts_of_a_turn([-179.75, 180.0], WIDE).len(), 8);
        assert_eq!(parts_of_a_turn([-180.0, 180.0], NARROW), [-180.0, -90.0, 0.0, 90.0, 180.0]);
        assert_eq!(parts_of_a_turn([0.0, 10.0], WIDE), ticks(0.0, 10.0));
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
        let svg = line.drawn(WIDE);
        // Half of the 627.6 units between the names and the margin.
        assert_eq!(svg.matches("class=\"bar").count(), 1);
        assert!(svg.contains("x=\"40.4\" y=\"20.0\" width=\"313.8\""), "{svg}");
        assert!(line.picture().svg.contains("class=\"narrow\""));
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
        let svg = plot.drawn(WIDE);
        assert!(!svg.contains("NaN") && svg.contains("a&lt;b") && svg.contains("x &amp; y"), "{svg}");
        assert_eq!(svg.matches("class=\"mark\"").count(), 2);
        assert_eq!(svg.matches("class=\"band\"").count(), 2);
        // A plot without a point has axes.
        assert!(!Plot::default().picture().svg.contains("inf"));
    }

    #[test]
    fn a_file_brings_its_ground_and_colours_and_names_its_axis_below() {
        let curves = vec![Curve::new("a", &[0.0, 1.0], &[0.0, 2.0])];
        let plot = Plot { x: "time (s)".to_string(), curves, ..Plot::default() };
        let svg = plot.file();
        for part in [
            "xmlns=",
            "height=\"330\"",
            "fill=\"white\"",
            ".line0 { stroke",
            "y=\"301.0\" text-anchor=\"end\">time",
        ] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert!(!plot.picture().svg.contains("<style>"));
    }

    #[test]
    fn logarithmic_axes_name_the_numbers_and_legends_wrap() {
        let names =
            |low: f64, high: f64| decades(low, high).into_iter().map(|(_, name)| name).collect::<Vec<_>>();
        assert_eq!(names(4.2, 4.8), ["20000", "50000"]);
        assert_eq!(names(-12.8, -9.4), ["1e-12", "1e-11", "1e-10"]);
        let long = |name: &str| Curve::new(name, &[1.0, 1e3], &[1e-6, 1e-2]);
        let curves = vec![long("a name of thirty letters, about"), long("and another one that is as long")];
        let plot = Plot { curves, is_logarithmic: true, ..Plot::default() };
        assert_eq!([WIDE, NARROW].map(|frame| plot.keys(frame).1), [1, 2]);
        assert!(plot.drawn(NARROW).contains("0 0 350 268"));
    }
}

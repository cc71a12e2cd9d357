//! The work-precision picture as SVG: error over time, both logarithmic.

use std::fmt::Write;

use crate::cost::points::{Outcome, Point, Verdict, front};
use crate::cost::result::{CostResult, style};
use crate::output::page::escaped;
use crate::output::svg::{COLOURS, label, open};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 350.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 60.0;

/// A logarithmic axis.
pub(super) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    pub(super) fn of(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let logarithms = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (low, high) = logarithms
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        low.is_finite().then(|| Axis { low: (low - 0.1).floor(), high: (high + 0.1).ceil(), from, to })
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        let share = (value.max(1e-300).log10() - self.low) / (self.high - self.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Powers of ten with their places.
    pub(super) fn marks(&self) -> impl Iterator<Item = (i32, f64)> + '_ {
        let step = (((self.high - self.low) / 8.0).ceil() as usize).max(1);
        (self.low as i32..=self.high as i32).step_by(step).map(|power| (power, self.at(10.0_f64.powi(power))))
    }
}

fn error(point: &Point) -> Option<f64> {
    match &point.outcome {
        Outcome::Done { errors, .. } if errors.judged.is_finite() => Some(errors.judged.max(1e-17)),
        _ => None,
    }
}

/// Times and errors of other programs by name; those without one finished run are left out.
fn peers(result: &CostResult) -> Vec<(&str, Vec<(f64, f64)>)> {
    let mut curves: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for peer in &result.peers {
        let Ok(run) = &peer.outcome else { continue };
        if !run.errors.judged.is_finite() {
            continue;
        }
        let point = (run.time, run.errors.judged.max(1e-17));
        match curves.last_mut().filter(|(name, _)| *name == peer.program) {
            Some((_, points)) => points.push(point),
            None => curves.push((&peer.program, vec![point])),
        }
    }
    curves
}

/// Colours of a mark: filled where the error is known, hollow next to the width of the reference, dashed where the run warns, red where
/// it is wrong.
fn look(point: &Point, colour: &str) -> String {
    match point.outcome {
        Outcome::Done { verdict: Verdict::Hollow, .. } => format!("fill=\"white\" stroke=\"{colour}\""),
        Outcome::Done { verdict: Verdict::Untrusted, .. } => {
            format!("fill=\"white\" stroke=\"{colour}\" stroke-dasharray=\"2 1.5\"")
        }
        Outcome::Done { verdict: Verdict::Wrong, .. } => {
            "fill=\"white\" stroke=\"#d0021b\" stroke-width=\"2.5\"".to_string()
        }
        _ => format!("fill=\"{colour}\""),
    }
}

/// The curves that reach the front in colour, all other points in grey, the front as a line, the error asked for.
pub fn picture(result: &CostResult) -> String {
    let done = || result.points.iter().filter_map(|point| Some((point, error(point)?)));
    let peers = peers(result);
    let seen = || peers.iter().flat_map(|(_, points)| points.iter().copied());
    let times = done().map(|(point, _)| point.time).chain(seen().map(|(time, _)| time));
    let errors = done().map(|(_, error)| error).chain(seen().map(|(_, error)| error));
    let time = Axis::of(times, LEFT, WIDTH - RIGHT);
    let size = Axis::of(errors.map(|error| error.min(10.0)).chain([result.asked]), HEIGHT - BOTTOM, TOP);
    let mut svg = open(WIDTH as usize, HEIGHT as usize);
    label(&mut svg, LEFT as usize, 24, "font-size=\"16\" font-weight=\"bold\"", &result.title);
    let words = format!("error of the {} over time ({})", result.judged, result.unit());
    label(&mut svg, LEFT as usize, 44, "", &words);
    let (Some(time), Some(size)) = (time, size) else {
        label(&mut svg, LEFT as usize, 100, "", "no setting went through");
        return svg + "</svg>\n";
    };
    for (power, x) in time.marks() {
        let _ = writeln!(svg, "<path d=\"M{x:.1} {TOP}V{:.1}\" stroke=\"#ddd\"/>", HEIGHT - BOTTOM);
        power_of_ten(&mut svg, x, HEIGHT - BOTTOM + 20.0, "middle", power);
    }
    for (power, y) in size.marks() {
        let _ = writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#ddd\"/>", WIDTH - RIGHT);
        power_of_ten(&mut svg, LEFT - 8.0, y + 4.0, "end", power);
    }
    for (point, error) in done() {
        let (x, y, look) = (time.at(point.time), size.at(error), look(point, "#bbb"));
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" {look}/>");
    }
    let on_front = front(&result.points);
    let mut names: Vec<String> = Vec::new();
    for index in on_front.iter().rev() {
        let name = result.points[*index].setting.curve();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    for (k, name) in names.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let of = || done().filter(|(point, _)| point.setting.curve() == *name);
        let dash = of().next().is_some_and(|(point, _)| style(&point.setting).2);
        let dash = if dash || k >= COLOURS.len() { " stroke-dasharray=\"5 3\"" } else { "" };
        let line: Vec<String> =
            of().map(|(point, error)| format!("{:.1} {:.1}", time.at(point.time), size.at(error))).collect();
        let _ = writeln!(
            svg,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"{dash}/>",
            line.join("L")
        );
        for (point, error) in of() {
            let (x, y) = (time.at(point.time), size.at(error));
            let words = escaped(&format!("{}: {error:.1e}", point.setting));
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" {}><title>{words}</title></circle>",
                look(point, colour)
            );
        }
        let y = TOP + 20.0 * k as f64 + 10.0;
        let x = WIDTH - RIGHT + 20.0;
        let _ = writeln!(svg, "<path d=\"M{x} {y:.1}h22\" stroke=\"{colour}\" stroke-width=\"3\"{dash}/>");
        label(&mut svg, (x + 28.0) as usize, (y + 4.0) as usize, "font-size=\"12\"", name);
    }
    for (k, (name, points)) in peers.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let at = |(t, error): &(f64, f64)| (time.at(*t), size.at(*error));
        let line: Vec<String> = points.iter().map(at).map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        let stroke = format!("fill=\"none\" stroke=\"{colour}\"");
        let _ = writeln!(svg, "<path d=\"M{}\" {stroke} stroke-dasharray=\"1.5 2.5\"/>", line.join("L"));
        for (x, y) in points.iter().map(at) {
            let _ = writeln!(svg, "<path d=\"M{:.1} {:.1}l6 6m0 -6l-6 6\" {stroke}/>", x - 3.0, y - 3.0);
        }
        let y = TOP + 16.0 * k as f64 + 20.0 * names.len() as f64 + 24.0;
        let x = WIDTH - RIGHT + 20.0;
        let _ = writeln!(svg, "<path d=\"M{x} {y:.1}h22\" {stroke} stroke-dasharray=\"1.5 2.5\"/>");
        let _ = writeln!(svg, "<path d=\"M{} {:.1}l6 6m0 -6l-6 6\" {stroke}/>", x + 8.0, y - 3.0);
        label(&mut svg, (x + 28.0) as usize, (y + 4.0) as usize, "font-size=\"11\"", name);
    }
    let corners: Vec<String> = on_front
        .iter()
        .filter_map(|index| Some((&result.points[*index], error(&result.points[*index])?)))
        .map(|(point, error)| format!("{:.1} {:.1}", time.at(point.time), size.at(error)))
        .collect();
    if !corners.is_empty() {
        let _ = writeln!(
            svg,
            "<path d=\"M{}\" fill=\"none\" stroke=\"black\" stroke-width=\"6\" stroke-opacity=\"0.15\" stroke-linejoin=\"round\"/>",
            corners.join("L")
        );
    }
    let y = size.at(result.asked);
    let _ = writeln!(
        svg,
        "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#d55e00\" stroke-dasharray=\"2 3\"/>",
        WIDTH - RIGHT
    );
    label(
        &mut svg,
        (WIDTH - RIGHT) as usize - 4,
        y as usize - 4,
        "fill=\"#d55e00\" font-size=\"12\" text-anchor=\"end\"",
        "asked",
    );
    svg + "</svg>\n"
}

pub(super) fn power_of_ten(svg: &mut String, x: f64, y: f64, anchor: &str, power: i32) {
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">10<tspan dy=\"-5\" font-size=\"9\">{power}</tspan></text>"
    );
}

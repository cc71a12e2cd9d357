//! A table with its derivatives as a picture.

use core::fmt::Write;

use super::{Points, Spline};
use crate::output::svg::{COLOURS, label, open};

/// Size of a panel and the room around it, in pixels.
const WIDTH: usize = 640;
const HEIGHT: usize = 170;
const LEFT: usize = 110;
const GAP: usize = 50;

/// Places of a curve.
const PLACES: usize = 720;

/// Value with the points, first and second derivative, one above the other.
pub fn svg(points: &Points, spline: &Spline) -> String {
    let mut svg = open(LEFT + WIDTH + 30, 3 * (HEIGHT + GAP) + GAP);
    let [first, last] = spline.range();
    let curve: Vec<(f64, [f64; 4])> = (0..=PLACES)
        .map(|place| first + (last - first) * place as f64 / PLACES as f64)
        .map(|x| (x, spline.derivatives(x)))
        .collect();
    let (across, up) = (&points.columns.x.1, &points.columns.y.1);
    let [x, y] = &points.names;
    for (order, colour) in COLOURS.into_iter().take(3).enumerate() {
        let values = curve.iter().map(|(x, jet)| (*x, jet[order]));
        let name = match order {
            0 => format!("{y} ({})", up.coherent),
            1 => format!("first derivative ({})", up.derivative(across, 1)),
            _ => format!("second derivative ({})", up.derivative(across, 2)),
        };
        let measured =
            if order == 0 { points } else { &Points { x: Vec::new(), y: Vec::new(), ..points.clone() } };
        panel(&mut svg, GAP + order * (HEIGHT + GAP), &name, &values.collect::<Vec<_>>(), measured, colour);
    }
    let below = 3 * (HEIGHT + GAP) + 20;
    let end = |value: f64| {
        format!("{:.4}", value / across.factor).trim_end_matches('0').trim_end_matches('.').to_string()
    };
    label(&mut svg, LEFT, below, "", &end(first));
    label(&mut svg, LEFT + WIDTH, below, "text-anchor=\"end\"", &end(last));
    label(&mut svg, LEFT + WIDTH / 2, below, "text-anchor=\"middle\"", &format!("{x} ({})", across.name));
    svg + "</svg>\n"
}

fn panel(svg: &mut String, top: usize, name: &str, curve: &[(f64, f64)], points: &Points, colour: &str) {
    let values = || curve.iter().map(|(_, value)| *value).chain(points.y.iter().copied());
    let (low, high) =
        values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let (from, to) = (curve[0].0, curve[curve.len() - 1].0);
    let height = if high > low { high - low } else { 1.0 };
    let place = |x: f64, y: f64| {
        let across = LEFT as f64 + WIDTH as f64 * (x - from) / (to - from);
        (across, top as f64 + HEIGHT as f64 * (high - y) / height)
    };
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{top}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#888888\"/>"
    );
    label(svg, LEFT, top - 8, "font-weight=\"bold\"", name);
    label(svg, LEFT - 6, top + 12, "text-anchor=\"end\"", &format!("{high:.4e}"));
    label(svg, LEFT - 6, top + HEIGHT, "text-anchor=\"end\"", &format!("{low:.4e}"));
    for (x, y) in points.x.iter().zip(&points.y) {
        let (cx, cy) = place(*x, *y);
        let _ = writeln!(svg, "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"1.5\" fill=\"#999999\"/>");
    }
    let mut path = String::new();
    for (index, (x, y)) in curve.iter().enumerate() {
        let (across, down) = place(*x, *y);
        let _ = write!(path, "{}{across:.1} {down:.2}", if index == 0 { "M" } else { "L" });
    }
    let _ = writeln!(
        svg,
        "<path class=\"curve\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" d=\"{path}\"/>"
    );
}

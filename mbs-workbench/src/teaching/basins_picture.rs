//! Picture of the basins of attraction, as SVG.

use std::fmt::Write;

use super::basins::{Axis, BasinMethod, Basins, Map, Solution};
use crate::erased::facade::AnyMechanism;
use crate::output::svg::{COLOURS, FAILURE, label, open};

/// Side of a map and the room around it, in pixels.
const SIDE: usize = 300;
const MARGIN: usize = 60;

/// The maps side by side, with a legend of the colours.
pub fn basins(mechanism: &dyn AnyMechanism, basins: &Basins) -> String {
    let lines = basins.solutions.len() + 1;
    let height = MARGIN + SIDE + 60 + 22 * lines;
    let mut svg = open(MARGIN + (SIDE + MARGIN) * basins.maps.len(), height);
    for (place, map) in basins.maps.iter().enumerate() {
        let x = MARGIN + (SIDE + MARGIN) * place;
        panel(&mut svg, basins, map, x);
        axes(&mut svg, mechanism, basins, x);
    }
    let legend = basins
        .solutions
        .iter()
        .enumerate()
        .map(|(index, _)| (COLOURS[index % COLOURS.len()], describe(mechanism, basins, index)));
    for (line, (colour, text)) in legend.chain([(FAILURE, "no assembly found".to_string())]).enumerate() {
        let y = MARGIN + SIDE + 50 + 22 * line;
        let _ =
            writeln!(svg, "<rect x=\"{MARGIN}\" y=\"{y}\" width=\"14\" height=\"14\" fill=\"{colour}\"/>");
        label(&mut svg, MARGIN + 22, y + 12, "", &text);
    }
    svg + "</svg>\n"
}

/// The coordinates of the axes in a solution, others where those do not tell it apart, and its branches.
pub fn describe(mechanism: &dyn AnyMechanism, basins: &Basins, index: usize) -> String {
    let solution = &basins.solutions[index];
    let value = |q: &[f64], coordinate: usize| {
        let entry = &mechanism.coordinates()[coordinate];
        format!("{} = {}", entry.name, quantity(q[coordinate], entry.unit))
    };
    let axes = basins.axes.map(|axis| axis.coordinate);
    let alike =
        |other: &&Solution| axes.iter().all(|axis| value(&other.q, *axis) == value(&solution.q, *axis));
    let alike: Vec<&Solution> = basins.solutions.iter().filter(alike).collect();
    let differs = |coordinate: &usize| {
        alike.iter().any(|other| value(&other.q, *coordinate) != value(&solution.q, *coordinate))
    };
    let others = (0..solution.q.len()).filter(|k| !axes.contains(k)).filter(differs).take(2);
    let shown = axes.into_iter().chain(others).map(|coordinate| value(&solution.q, coordinate));
    let mut text = shown.collect::<Vec<_>>().join(", ");
    if !solution.branches.is_empty() {
        text += if solution.is_declared() { " (the declared assembly)" } else { " (another assembly)" };
    }
    text
}

/// An angle in degrees, anything else in its unit; a number that rounds to zero has no sign.
pub fn quantity(value: f64, unit: &str) -> String {
    let (value, digits, unit) = match unit {
        "rad" => (value.to_degrees(), 2, "°".to_string()),
        "1" => (value, 4, String::new()),
        _ => (value, 4, format!(" {unit}")),
    };
    let text = format!("{value:.digits$}");
    let zero = text.chars().all(|c| "-0.".contains(c));
    format!("{}{unit}", if zero { text.trim_start_matches('-') } else { &text })
}

/// Name of a method over its map.
pub fn heading(method: BasinMethod) -> &'static str {
    match method {
        BasinMethod::Plain => "full Newton–Raphson",
        BasinMethod::Assemble => "assemble, no branch",
        BasinMethod::Declared => "assemble, branch declared",
    }
}

/// One path a colour: runs of equal cells as strokes one cell wide, in a coordinate system of cells.
fn panel(svg: &mut String, basins: &Basins, map: &Map, x: usize) {
    let size = basins.size;
    let scale = SIDE as f64 / size as f64;
    label(svg, x, MARGIN - 15, "font-weight=\"bold\"", heading(map.method));
    let _ = writeln!(
        svg,
        "<g transform=\"translate({x} {MARGIN}) scale({scale})\" shape-rendering=\"crispEdges\" fill=\"none\">\n\
         <rect width=\"{size}\" height=\"{size}\" fill=\"{FAILURE}\"/>"
    );
    for (colour, stroke) in COLOURS.iter().enumerate() {
        let of = |cell: &Option<usize>| cell.is_some_and(|index| index % COLOURS.len() == colour);
        let mut path = String::new();
        for (row, cells) in map.cells.chunks(size).enumerate() {
            let mut column = 0;
            while column < size {
                let run = cells[column..].iter().take_while(|cell| of(cell)).count();
                if run > 0 {
                    let _ = write!(path, "M{column} {row}.5h{run}");
                }
                column += run.max(1);
            }
        }
        if !path.is_empty() {
            let _ = writeln!(svg, "<path stroke=\"{stroke}\" d=\"{path}\"/>");
        }
    }
    svg.push_str("</g>\n");
}

fn axes(svg: &mut String, mechanism: &dyn AnyMechanism, basins: &Basins, x: usize) {
    let [across, up] = basins.axes;
    let name = |axis: Axis| mechanism.coordinates()[axis.coordinate];
    let end = |axis: Axis, value: f64| quantity(value, name(axis).unit).replace(".00°", "°");
    let below = MARGIN + SIDE + 16;
    label(svg, x, below, "text-anchor=\"start\"", &end(across, across.low));
    label(svg, x + SIDE, below, "text-anchor=\"end\"", &end(across, across.high));
    label(svg, x + SIDE / 2, below, "text-anchor=\"middle\"", name(across).name);
    label(svg, x - 4, MARGIN + SIDE, "text-anchor=\"end\"", &end(up, up.low));
    label(svg, x - 4, MARGIN + 12, "text-anchor=\"end\"", &end(up, up.high));
    label(svg, x - 4, MARGIN + SIDE / 2, "text-anchor=\"end\"", name(up).name);
    let guess = mechanism.experiment().guess();
    let part = |axis: Axis| (guess[axis.coordinate] - axis.low) / (axis.high - axis.low);
    let (px, py) = (part(across), 1.0 - part(up));
    if (0.0..=1.0).contains(&px) && (0.0..=1.0).contains(&py) {
        let (cx, cy) = (x as f64 + px * SIDE as f64, MARGIN as f64 + py * SIDE as f64);
        let _ = writeln!(
            svg,
            "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"4\" fill=\"white\" stroke=\"black\" stroke-width=\"1.5\">\
             <title>the text's guess</title></circle>"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_read_as_on_a_drawing() {
        assert_eq!(quantity(-1e-9, "rad"), "0.00°");
        assert_eq!(quantity(core::f64::consts::PI, "rad"), "180.00°");
        assert_eq!([quantity(-0.25, "m"), quantity(2.0, "1")], ["-0.2500 m", "2.0000"]);
    }
}

//! Pictures as SVG: the permuted Jacobian with its blocks, basins of attraction.

use std::fmt::Write;

use mbs_codegen::{EntryKind, StructureReport};

use super::basins::{Axis, Basins, Map, Method, Solution};
use crate::facade::AnyMechanism;

/// Okabe and Ito's colours, which the colour-blind can tell apart; grey is kept for failures.
pub(crate) const COLOURS: [&str; 7] =
    ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#f0e442", "#cc79a7"];
const FAILURE: &str = "#999999";

/// Side of an entry of the Jacobian, in pixels.
const CELL: usize = 24;

pub(crate) fn open(width: usize, height: usize) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

pub(crate) fn label(svg: &mut String, x: usize, y: usize, attributes: &str, text: &str) {
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\" {attributes}>{}</text>", escaped(text));
}

/// Φ_q with rows and columns in the order of solution, each diagonal block in a frame.
pub fn structure(report: &StructureReport) -> String {
    let mut rows: Vec<usize> = report.blocks.iter().flat_map(|block| block.rows.iter().copied()).collect();
    let mut columns: Vec<usize> =
        report.blocks.iter().flat_map(|block| block.coordinates.iter().copied()).collect();
    let solved = columns.len();
    // Independent coordinates, and rows that no block has.
    columns
        .extend((0..report.coordinates.len()).filter(|index| !columns.contains(index)).collect::<Vec<_>>());
    rows.extend((0..report.rows.len()).filter(|index| !rows.contains(index)).collect::<Vec<_>>());
    let longest =
        |names: &mut dyn Iterator<Item = &String>| names.map(|n| n.chars().count()).max().unwrap_or(0);
    // Eight pixels a letter at 13 pixels' height.
    let left = 20 + 8 * longest(&mut report.rows.iter().map(|row| &row.name));
    let top = 20 + 8 * longest(&mut report.coordinates.iter().map(|coordinate| &coordinate.name));
    let (width, side) = (CELL * columns.len(), CELL * rows.len());
    let mut svg = open((left + width + 20).max(300), top + side + 60);
    for (place, column) in columns.iter().enumerate() {
        let (x, y) = (left + CELL * place + CELL / 2 + 4, top - 8);
        let turned = format!("transform=\"rotate(-90 {x} {y})\"");
        label(&mut svg, x, y, &turned, &report.coordinates[*column].name);
    }
    for (place, row) in rows.iter().enumerate() {
        let y = top + CELL * place;
        label(&mut svg, left - 8, y + 17, "text-anchor=\"end\"", &report.rows[*row].name);
        for (column, kind) in &report.rows[*row].entries {
            let at = columns.iter().position(|known| known == column).unwrap_or(0);
            entry(&mut svg, left + CELL * at, y, *kind);
        }
    }
    blocks(&mut svg, report, left, top);
    label(
        &mut svg,
        10,
        top + side + 25,
        "font-size=\"11\"",
        "light: a number; medium: parameters; dark: varies",
    );
    let order = match (report.blocks.is_empty(), solved < columns.len()) {
        (true, _) => {
            "rows that may follow from others: all are solved together, by orthogonal factors of any rank"
        }
        (false, true) => "framed: diagonal blocks, solved downwards; to the right of them what forces move",
        (false, false) => "framed: diagonal blocks, solved downwards",
    };
    label(&mut svg, 10, top + side + 42, "font-size=\"11\"", order);
    svg + "</svg>\n"
}

fn entry(svg: &mut String, x: usize, y: usize, kind: EntryKind) {
    let fill = match kind {
        EntryKind::Number => "#bdd7e7",
        EntryKind::Parameters => "#6baed6",
        EntryKind::Varies => "#08519c",
    };
    let size = CELL - 4;
    let _ = writeln!(
        svg,
        "<rect x=\"{}\" y=\"{}\" width=\"{size}\" height=\"{size}\" fill=\"{fill}\"/>",
        x + 2,
        y + 2
    );
}

fn blocks(svg: &mut String, report: &StructureReport, left: usize, top: usize) {
    let (width, height) = (CELL * report.coordinates.len(), CELL * report.rows.len());
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#888888\"/>"
    );
    let (mut x, mut y) = (left, top);
    for block in &report.blocks {
        let (width, height) = (CELL * block.coordinates.len(), CELL * block.rows.len());
        let _ = writeln!(
            svg,
            "<rect class=\"block\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"none\" \
             stroke=\"#d55e00\" stroke-width=\"2\"/>"
        );
        (x, y) = (x + width, y + height);
    }
}

/// Side of a map and the room around it, in pixels.
const SIDE: usize = 300;
const MARGIN: usize = 60;

/// The maps side by side, and what the colours stand for.
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

/// An angle in degrees, anything else in its unit; what rounds to zero has no sign.
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
pub fn heading(method: Method) -> &'static str {
    match method {
        Method::Plain => "full Newton–Raphson",
        Method::Assemble => "assemble, no branch",
        Method::Declared => "assemble, branch declared",
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
    use super::super::basins::basins as compute;
    use super::*;
    use crate::registry::{ALL, find};

    /// Every tag is closed; attributes aside, nothing but tags and text.
    fn assert_well_formed(svg: &str) {
        let mut open = Vec::new();
        for tag in svg.split('<').skip(1).map(|part| part.split('>').next().unwrap_or("")) {
            let name = tag.split([' ', '/']).next().unwrap_or("");
            if let Some(closed) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(closed), "{tag}");
            } else if !tag.ends_with('/') {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "{open:?}");
        assert_eq!(svg.matches('"').count() % 2, 0);
    }

    #[test]
    fn every_structure_is_drawn_below_its_blocks() {
        for card in ALL {
            let mechanism = (card.make)();
            let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()));
            let report = report.expect("a good text");
            let svg = structure(&report);
            assert_well_formed(&svg);
            assert_eq!(svg.matches("class=\"block\"").count(), report.blocks.len());
            let entries: usize = report.rows.iter().map(|row| row.entries.len()).sum();
            let colours = ["#bdd7e7", "#6baed6", "#08519c"];
            let drawn: usize = colours.iter().map(|colour| svg.matches(colour).count()).sum();
            assert_eq!(drawn, entries, "{}", card.name);
        }
    }

    #[test]
    fn quantities_read_as_on_a_drawing() {
        assert_eq!(quantity(-1e-9, "rad"), "0.00°");
        assert_eq!(quantity(core::f64::consts::PI, "rad"), "180.00°");
        assert_eq!([quantity(-0.25, "m"), quantity(2.0, "1")], ["-0.2500 m", "2.0000"]);
    }

    #[test]
    fn the_strokes_of_a_map_cover_what_was_found() {
        let mechanism = (find("four_bar").expect("in the list").make)();
        let axes = [3, 4].map(|coordinate| Axis::of(mechanism.as_ref(), coordinate));
        let found = compute(mechanism.as_ref(), axes, 12, 0.0, &mut |_| ());
        let svg = basins(mechanism.as_ref(), &found);
        assert_well_formed(&svg);
        let strokes = svg.lines().filter(|line| line.starts_with("<path"));
        let runs = strokes.flat_map(|line| line.split('h').skip(1));
        let digits =
            |run: &str| run.split(|c: char| !c.is_ascii_digit()).next().unwrap_or("").parse::<usize>();
        let covered: usize = runs.filter_map(|run| digits(run).ok()).sum();
        let cells: usize = found.maps.iter().map(|map| map.cells.iter().flatten().count()).sum();
        assert_eq!(covered, cells);
        assert!(svg.contains("phi2") && svg.contains("-180°"), "{svg}");
    }
}

//! The plot: ratio reached over the least one, one bar for each goal.

use std::fmt::Write;

use super::goals::Goal;

const ROW: usize = 22;
const LABELS: usize = 500;
const WIDTH: usize = 360;

/// Largest part that is drawn to scale; longer bars end there.
const LARGEST_PART: f64 = 3.0;

/// An SVG picture.
pub fn svg(goals: &[Goal]) -> String {
    let goals: Vec<(&Goal, f64)> = goals.iter().filter_map(|goal| Some((goal, goal.part()?))).collect();
    let height = ROW * (goals.len() + 4);
    let total = LABELS + WIDTH + 120;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    axis(goals.len(), &mut text);
    for (index, (goal, part)) in goals.into_iter().enumerate() {
        bar(goal, part, ROW * (index + 1), &mut text);
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#555\">bar: reached ÷ must, line: aim ÷ must; number: \
         the ratio itself</text>\n</svg>",
        total - 12,
        height - 8,
    );
    text
}

/// Horizontal position (pixels) of a part.
fn x(part: f64) -> f64 {
    LABELS as f64 + part.min(LARGEST_PART) / LARGEST_PART * WIDTH as f64
}

/// Lines and numbers of the axis below `count` bars.
fn axis(count: usize, text: &mut String) {
    let (top, bottom) = (ROW - 4, ROW * (count + 1));
    for (part, label) in [(0.0, "0"), (1.0, "1 = must"), (2.0, "2"), (LARGEST_PART, "3 or more")] {
        let x = x(part);
        let color = if part == 1.0 { "black" } else { "#ccc" };
        let _ = writeln!(
            text,
            "<line x1=\"{x:.1}\" y1=\"{top}\" x2=\"{x:.1}\" y2=\"{bottom}\" stroke=\"{color}\"/>\
             <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            bottom + 16,
        );
    }
}

/// One goal: its work, the bar, a line at the aim, and the ratio to the right of both.
fn bar(goal: &Goal, part: f64, y: usize, text: &mut String) {
    // Blue and orange, which the colour-blind can tell apart.
    let color = if part >= 1.0 { "#0072b2" } else { "#d55e00" };
    let label = goal.ratio.map_or(String::new(), |[median, ..]| format!("{median:.2}"));
    let aim = x(goal.wanted_part());
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\
         <rect x=\"{LABELS}\" y=\"{y}\" width=\"{:.1}\" height=\"{}\" fill=\"{color}\"/>\
         <line x1=\"{aim:.1}\" y1=\"{y}\" x2=\"{aim:.1}\" y2=\"{}\" stroke=\"black\" stroke-width=\"2\"/>\
         <text x=\"{}\" y=\"{}\">{label}</text>",
        LABELS - 8,
        y + 13,
        goal.work.replace('&', "&amp;").replace('<', "&lt;"),
        x(part) - LABELS as f64,
        ROW - 6,
        y + ROW - 6,
        LABELS + WIDTH + 24,
        y + 13,
    );
}

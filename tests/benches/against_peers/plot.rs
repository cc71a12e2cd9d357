//! The plot: what was reached over what must be, one bar a goal.

use std::fmt::Write;

use super::goals::Goal;

const ROW: usize = 22;
const LABELS: usize = 470;
const WIDTH: usize = 360;

/// Largest part that is drawn to scale; longer bars end there.
const LARGEST_PART: f64 = 3.0;

/// An SVG picture.
pub fn svg(goals: &[Goal]) -> String {
    let height = ROW * (goals.len() + 2);
    let total = LABELS + WIDTH + 90;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let x = |part: f64| LABELS as f64 + part.min(LARGEST_PART) / LARGEST_PART * WIDTH as f64;
    for (index, goal) in goals.iter().enumerate() {
        let y = ROW * (index + 1);
        let part = goal.part().unwrap_or(0.0);
        // Blue and orange, which the colour-blind can tell apart.
        let color = if part >= 1.0 { "#0072b2" } else { "#d55e00" };
        let label = goal.ratio.map_or("not measured".into(), |[median, ..]| format!("{median:.2}"));
        let _ = writeln!(
            text,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\
             <rect x=\"{LABELS}\" y=\"{y}\" width=\"{:.1}\" height=\"{}\" fill=\"{color}\"/>\
             <text x=\"{:.1}\" y=\"{}\">{label}</text>",
            LABELS - 8,
            y + 13,
            goal.work.replace('&', "&amp;").replace('<', "&lt;"),
            x(part) - LABELS as f64,
            ROW - 6,
            x(part) + 6.0,
            y + 13,
        );
    }
    let _ = writeln!(
        text,
        "<line x1=\"{0:.1}\" y1=\"{1}\" x2=\"{0:.1}\" y2=\"{2}\" stroke=\"black\" stroke-dasharray=\"4 3\"/>\
         <text x=\"{0:.1}\" y=\"14\" text-anchor=\"middle\">must</text>",
        x(1.0),
        ROW - 4,
        height - ROW,
    );
    text + "</svg>\n"
}

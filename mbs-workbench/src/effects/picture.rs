//! Change against cost as SVG: one point an effect.

use std::fmt::Write;

use super::result::{EffectsResult, percent};
use crate::output::page::escaped;
use crate::output::svg::{COLOURS, FAILURE, label, open};

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 460.0;
const LEFT: f64 = 90.0;
const RIGHT: f64 = 150.0;
const TOP: f64 = 70.0;
const BOTTOM: f64 = 60.0;

/// Least change that is told from none.
const LEAST: f64 = 1e-6;

/// Largest change of the watched outputs without an effect over the time of a step that it takes.
pub fn picture(result: &EffectsResult) -> String {
    let kept = result.study.text.all_of(result.study.enough);
    let points: Vec<(String, f64, f64, bool)> = result
        .contributions()
        .into_iter()
        .filter_map(|one| {
            let sizes = one.changes.iter().filter_map(|change| change.size.as_ref().ok());
            let largest = sizes
                .map(|size| size.largest)
                .fold(None, |most: Option<f64>, size| Some(most.map_or(size, |most| most.max(size))))?;
            let is_kept = kept.contains(&one.name);
            Some((one.name, 1e9 * one.step?, largest.max(LEAST), is_kept))
        })
        .collect();
    let mut svg = open(WIDTH as usize, HEIGHT as usize);
    label(&mut svg, LEFT as usize, 26, "font-size=\"16\" font-weight=\"bold\"", &result.title);
    let words =
        "largest change of the watched outputs without an effect, over the time of a step that it takes";
    label(&mut svg, LEFT as usize, 46, "fill=\"#555\"", words);
    let logarithms = points.iter().map(|(_, _, change, _)| change.log10()).chain([result.within.log10()]);
    let (low, high) =
        logarithms.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let (low, high) = ((low - 0.2).floor(), (high + 0.2).ceil());
    let (least, most) = points
        .iter()
        .fold((0.0_f64, 1.0_f64), |(low, high), (_, cost, ..)| (low.min(*cost), high.max(*cost)));
    let (least, most) = (least - 0.04 * (most - least), most + 0.04 * (most - least));
    let x = |cost: f64| LEFT + (cost - least) / (most - least) * (WIDTH - LEFT - RIGHT);
    let y = |change: f64| HEIGHT - BOTTOM - (change.log10() - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
    for power in low as i32..=high as i32 {
        let at = y(10.0_f64.powi(power));
        let _ = writeln!(svg, "<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"#ddd\"/>", WIDTH - RIGHT);
        let words = percent(10.0_f64.powi(power));
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{words}</text>",
            LEFT - 8.0,
            at + 4.0
        );
    }
    for mark in marks(least, most) {
        let at = x(mark);
        let _ = writeln!(svg, "<path d=\"M{at:.1} {TOP}V{:.1}\" stroke=\"#eee\"/>", HEIGHT - BOTTOM);
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{mark:.0}</text>",
            HEIGHT - BOTTOM + 20.0
        );
    }
    let middle = ((LEFT + WIDTH - RIGHT) / 2.0) as usize;
    label(&mut svg, middle, HEIGHT as usize - 18, "text-anchor=\"middle\"", "ns a step");
    let at = y(result.within);
    let _ = writeln!(
        svg,
        "<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"{}\" stroke-dasharray=\"4 3\"/>",
        WIDTH - RIGHT,
        COLOURS[3]
    );
    let within = format!("within {}", percent(result.within));
    let attributes = format!("fill=\"{}\" font-size=\"12\"", COLOURS[3]);
    label(&mut svg, (WIDTH - RIGHT) as usize + 6, at as usize + 4, &attributes, &within);
    let mut labels: Vec<(f64, f64)> = Vec::new();
    for (name, cost, change, is_kept) in points {
        let (x, y) = (x(cost), y(change));
        let colour = if is_kept { COLOURS[0] } else { FAILURE };
        let title = escaped(&format!("{name}: {}, {cost:.0} ns a step", percent(change)));
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{colour}\"><title>{title}</title></circle>"
        );
        // Labels of points that lie together stand below one another.
        let mut at = y + 4.0;
        while labels.iter().any(|(other, line)| (other - x).abs() < 110.0 && (line - at).abs() < 13.0) {
            at += 13.0;
        }
        labels.push((x, at));
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{at:.1}\" font-size=\"12\">{}</text>",
            x + 9.0,
            escaped(&name)
        );
    }
    let x = (WIDTH - RIGHT) as usize + 6;
    label(
        &mut svg,
        x,
        TOP as usize + 8,
        &format!("fill=\"{}\" font-size=\"12\"", COLOURS[0]),
        "in the cheapest scene",
    );
    label(&mut svg, x, TOP as usize + 24, &format!("fill=\"{FAILURE}\" font-size=\"12\""), "left out of it");
    svg + "</svg>\n"
}

/// Round numbers between two ends, five to ten of them.
fn marks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 6.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|of| of * power).into_iter().find(|step| rough <= *step);
    let step = step.unwrap_or(power * 10.0);
    let first = (low / step).ceil() as i64;
    (first..).map(|k| k as f64 * step).take_while(|mark| *mark <= high).collect()
}

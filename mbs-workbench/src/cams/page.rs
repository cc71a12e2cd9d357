//! The self-contained page of a cam: curves over the cam angle, the profile to scale and turning.

use serde_json::{Value, json};

use super::files::turn;
use super::follower::{Cam, Follower};
use super::limits::{Limits, Verdict};
use super::noise::{KNOTS, NoiseRow, Study};
use crate::output::page::Template;

/// Places of a curve.
const PLACES: usize = 720;

/// Data of the page in SI.
pub fn data(
    title: &str,
    sentence: &str,
    command: &str,
    cam: &Cam,
    limits: &Limits,
    verdicts: &[Verdict],
) -> Value {
    let places = turn(cam, PLACES);
    let column = |of: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..PLACES).map(of).collect() };
    let face = match cam.follower {
        Follower::Flat { .. } | Follower::OscillatingFlat { .. } => {
            Some(1.15 * places.iter().map(|(_, p)| p.along.abs()).fold(0.0, f64::max) + 1e-4)
        }
        _ => None,
    };
    let hertz =
        limits.hertz.map(|(_, load)| column(&|k| load.pressure(places[k].1.radius, cam.follower.pad())));
    json!({
        "title": title, "sentence": sentence, "command": command,
        "by_angle": cam.follower.lifts_by_angle(), "sense": cam.direction.sign(),
        "pad": cam.follower.pad(), "pivot": cam.follower.pivot(), "face": face, "base": cam.follower.base(),
        "theta": column(&|k| places[k].0),
        "lift": ([0, 1, 2, 3].map(|order| column(&|k| places[k].1.lift[order]))),
        "contour": ([0, 1].map(|axis| column(&|k| places[k].1.contour[axis]))),
        "centre": ([0, 1].map(|axis| column(&|k| places[k].1.centre[axis]))),
        "contact": ([0, 1].map(|axis| column(&|k| places[k].1.contact[axis]))),
        "normal": ([0, 1].map(|axis| column(&|k| places[k].1.normal[axis]))),
        "curvature": column(&|k| 1.0 / places[k].1.radius), "d2r": column(&|k| places[k].1.polar[2]),
        "pressure": column(&|k| places[k].1.pressure), "sliding": column(&|k| places[k].1.sliding),
        "hertz": hertz,
        "verdicts": verdicts.iter().map(|one| json!({
            "name": one.limit.name(), "value": finite(one.value), "bound": one.limit.bound(), "angle": one.angle, "kept": one.kept,
            "least": one.limit.is_least(),
        })).collect::<Vec<_>>(),
    })
}

/// Data of a study of noise in SI.
pub fn noise(study: &Study) -> Value {
    let column = |of: &dyn Fn(&NoiseRow) -> Option<f64>| study.rows.iter().map(of).collect::<Vec<_>>();
    let fitted = (0..KNOTS.len()).map(|k| column(&|row| row.fitted[k])).collect::<Vec<_>>();
    json!({
        "width": study.width, "largest": study.largest, "knots": KNOTS,
        "points": study.rows.iter().map(|row| row.points).collect::<Vec<_>>(),
        "through": column(&|row| Some(row.through)), "expected": column(&|row| Some(row.expected)), "fitted": fitted,
    })
}

/// JSON has no infinite number.
pub fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The page with its data.
pub fn html(data: &Value, origin: &str) -> String {
    const TEMPLATE: Template = Template {
        html: include_str!("page/page.html"),
        style: include_str!("page/page.css"),
        script: include_str!("page/page.js"),
    };
    TEMPLATE.filled(data["title"].as_str().unwrap_or("cam"), origin, data)
}

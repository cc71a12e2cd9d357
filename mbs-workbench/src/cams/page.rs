//! The self-contained page of a cam: curves over the cam angle, the profile to scale and turning.

use serde_json::{Value, json};

use super::files::Places;
use super::follower::{Cam, Follower, Place};
use super::limits::{Limits, Verdict};
use super::noise::{KNOTS, NoiseRow, Study};
use crate::output::page::Template;

/// A cam of the page: alone without a name, or one of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Its name.
    pub name: &'a str,
    /// The cam.
    pub cam: &'a Cam,
    /// Places of one turn.
    pub places: &'a Places,
    /// Its limits.
    pub verdicts: &'a [Verdict],
}

/// Data of the page in SI; all parts have the same law and as many places.
pub fn data(title: &str, sentence: &str, command: &str, limits: &Limits, parts: &[Part<'_>]) -> Value {
    let first = parts.first();
    let places = first.map_or(&[][..], |part| part.places);
    let law = |order: usize| places.iter().map(|(_, place)| place.lift[order]).collect::<Vec<f64>>();
    json!({
        "title": title, "sentence": sentence, "command": command,
        "by_angle": first.is_some_and(|part| part.cam.follower.lifts_by_angle()),
        "sense": first.map_or(1.0, |part| part.cam.direction.sign()),
        "theta": places.iter().map(|(theta, _)| *theta).collect::<Vec<f64>>(), "lift": ([0, 1, 2, 3].map(law)),
        "cams": parts.iter().map(|part| of_part(part, limits)).collect::<Vec<_>>(),
    })
}

fn of_part(part: &Part<'_>, limits: &Limits) -> Value {
    let Part { name, cam, places, verdicts } = part;
    let follower = &cam.follower;
    let column =
        |of: &dyn Fn(&Place<f64>) -> f64| -> Vec<f64> { places.iter().map(|(_, p)| of(p)).collect() };
    let points = |of: &dyn Fn(&Place<f64>) -> [f64; 2]| [0, 1].map(|axis| column(&|p| of(p)[axis]));
    let face = match follower {
        Follower::Flat { .. } | Follower::OscillatingFlat { .. } => {
            Some(1.15 * places.iter().map(|(_, p)| p.along.abs()).fold(0.0, f64::max) + 1e-4)
        }
        _ => None,
    };
    let valve = match *follower {
        Follower::Rocker { pivot, valve_pad, .. } => Some(points(&|p| {
            let (sine, cosine) = p.angle[0].sin_cos();
            let [x, y] = [0, 1].map(|axis| valve_pad[axis] - pivot[axis]);
            [pivot[0] + cosine * x - sine * y, pivot[1] + sine * x + cosine * y]
        })),
        _ => None,
    };
    let hertz = limits.hertz.map(|(_, load)| column(&|p| load.pressure(p.radius, follower.pad())));
    json!({
        "name": name, "pad": follower.pad(), "pivot": follower.pivot(), "face": face, "base": follower.base(),
        "contour": points(&|p| p.contour), "centre": points(&|p| p.centre), "contact": points(&|p| p.contact),
        "normal": points(&|p| p.normal), "valve": valve, "opens": cam.opens(),
        "curvature": column(&|p| 1.0 / p.radius), "d2r": column(&|p| p.polar[2]),
        "pressure": column(&|p| p.pressure), "sliding": column(&|p| p.sliding), "hertz": hertz,
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

//! The result of a study: what its table, page, picture and files show.

use serde::Serialize;

use crate::cost::advice::{rust, sentence, two_digits};
use crate::cost::peers::{PeerPoint, PeerRun};
use crate::cost::points::{Errors, Outcome, Point, Verdict, cheapest, front};
use crate::cost::splines::{self, PageValley};
use crate::output::page::Template;
use crate::setting::{MotionMethod, Numbers, Setting};
use crate::tables::valley::Valley;

/// A study with its words.
pub struct CostResult {
    /// Program, version and text.
    pub origin: String,
    /// Name on the command line.
    pub name: String,
    /// Heading.
    pub title: String,
    /// The command that makes it again.
    pub command: String,
    /// Constructor of the mechanism, for Rust.
    pub constructor: String,
    /// End of the motion (s).
    pub until: f64,
    /// Error asked for.
    pub asked: f64,
    /// All points, curve by curve.
    pub points: Vec<Point>,
    /// Runs of other programs, curve by curve.
    pub peers: Vec<PeerPoint>,
    /// Tables of the mechanism's functions.
    pub valleys: Vec<Valley>,
    /// Width of the reference; none where one leg alone went through.
    pub width: Option<f64>,
    /// Quantity that is judged, in words.
    pub judged: String,
    /// Quantity of [`Errors::second`](crate::cost::points::Errors::second), in words.
    pub second: &'static str,
    /// Pairs of a name and a value: references, machine, versions.
    pub facts: Vec<[String; 2]>,
}

/// Data of the page.
#[derive(Serialize)]
struct Page<'a> {
    name: &'a str,
    title: &'a str,
    command: &'a str,
    unit: &'static str,
    judged: &'a str,
    second: &'static str,
    asked: f64,
    sentence: String,
    /// The setting that the sentence names.
    choice: Option<Choice>,
    width: Option<f64>,
    facts: &'a [[String; 2]],
    curves: Vec<Curve>,
    splines: Vec<PageValley<'a>>,
}

/// The setting to take for the error asked for.
#[derive(Serialize)]
struct Choice {
    setting: String,
    error: Option<f64>,
    time: f64,
    rust: String,
}

/// A curve of the page.
#[derive(Serialize)]
struct Curve {
    name: String,
    /// Index of its colour.
    colour: usize,
    /// Index of its mark.
    mark: usize,
    dashed: bool,
    /// `true` for many mechanisms at once.
    lanes: bool,
    /// `true` for settings to choose.
    advised: bool,
    /// Source of sines of a motion from drives: `own`, or the feature of the runtime.
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<&'static str>,
    /// ε of its numbers.
    epsilon: f64,
    /// `true` for other programs.
    peer: bool,
    points: Vec<PagePoint>,
}

/// A point of the page.
#[derive(Serialize)]
struct PagePoint {
    label: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<f64>,
    /// Width of the reference, where the error is known with it alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
    median: f64,
    rate: f64,
    second: f64,
    multiplier: f64,
    /// Error (s) of the times of contacts and events, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<String>,
    energy: f64,
    violation: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<f64>,
    /// `true` where the expected error is not trusted.
    #[serde(skip_serializing_if = "core::ops::Not::not")]
    doubted: bool,
    /// Largest error for perturbed parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    perturbed: Option<f64>,
    verdict: &'static str,
    front: bool,
    time: f64,
    evaluations: u64,
    corrections: u64,
    steps: u64,
    rust: String,
}

impl PagePoint {
    fn done(label: String, errors: &Errors, time: f64) -> Self {
        PagePoint {
            label,
            refused: None,
            error: Some(errors.judged).filter(|error| error.is_finite()),
            width: Some(errors.width).filter(|width| *width > 0.0),
            median: errors.median,
            rate: errors.rate,
            second: errors.second,
            multiplier: errors.multiplier,
            contact: event_times(errors.contact),
            energy: errors.energy,
            violation: errors.violation,
            expected: None,
            doubted: false,
            perturbed: None,
            verdict: "",
            front: false,
            time,
            evaluations: 0,
            corrections: 0,
            steps: 0,
            rust: String::new(),
        }
    }

    fn refused(label: String, reason: &str) -> Self {
        let refused = Some(reason.to_string());
        let none = PagePoint::done(label, &Errors::default(), 0.0);
        PagePoint { refused, error: None, verdict: "refused", ..none }
    }
}

/// The error (s) of the times of contacts and events in words; none where there are none.
pub fn event_times(error: f64) -> Option<String> {
    match error {
        error if error.is_nan() => None,
        error if error.is_finite() => Some(format!("{} s", two_digits(error))),
        _ => Some("missed".to_string()),
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Hollow => "hollow",
        Verdict::Untrusted => "untrusted",
        Verdict::Wrong => "wrong",
    }
}

/// Indices of colour and mark: colours tell integrators apart, marks formulations.
pub fn style(setting: &Setting) -> (usize, usize, bool) {
    let dashed = setting.numbers() == Numbers::Single;
    match setting {
        Setting::Motion { method: MotionMethod::Explicit(formulation, integrator), .. } => {
            (*integrator as usize, *formulation as usize, dashed)
        }
        Setting::Motion { method: MotionMethod::Implicit(name), .. } => {
            (5 + *name as usize % 2, *name as usize, dashed)
        }
        Setting::Kinematics { lanes, closing, .. } => {
            let colour = match (lanes, closing) {
                (1, crate::setting::Closing::Closed) => 0,
                (1, crate::setting::Closing::Evaluations(most)) => *most as usize,
                (lanes, _) => 3 + lanes.ilog2() as usize / 2,
            };
            (colour % 7, colour % 5, dashed)
        }
    }
}

/// Source of sines of a motion from drives.
fn kernel(setting: &Setting) -> Option<&'static str> {
    match setting {
        Setting::Motion { .. } => None,
        Setting::Kinematics { kernel, .. } => Some(kernel.feature().unwrap_or("own")),
    }
}

impl CostResult {
    /// `true` for times of a step.
    pub fn is_step(&self) -> bool {
        self.points.iter().any(|point| matches!(point.setting, Setting::Kinematics { .. }))
    }

    /// The choice in one sentence.
    pub fn sentence(&self) -> String {
        sentence(&self.points, self.asked)
    }

    /// Points that answer `Ok` with an error that nothing announces.
    pub fn wrong(&self) -> impl Iterator<Item = &Point> {
        let is_wrong =
            |point: &&Point| matches!(point.outcome, Outcome::Done { verdict: Verdict::Wrong, .. });
        self.points.iter().filter(is_wrong)
    }

    /// The unit of times in words.
    pub fn unit(&self) -> &'static str {
        if self.is_step() { "ns a step" } else { "µs a simulated second" }
    }

    /// Data of the page, and of the document.
    fn data(&self) -> Page<'_> {
        let on_front = front(&self.points);
        let mut curves: Vec<Curve> = Vec::new();
        for (index, point) in self.points.iter().enumerate() {
            let name = point.setting.curve();
            let (colour, mark, dashed) = style(&point.setting);
            if curves.last().is_none_or(|curve| curve.name != name) {
                let lanes = !point.is_single();
                let advised = point.is_advised();
                let points = Vec::new();
                let epsilon = point.setting.numbers().epsilon();
                curves.push(Curve {
                    name,
                    colour,
                    mark,
                    dashed,
                    lanes,
                    advised,
                    kernel: kernel(&point.setting),
                    epsilon,
                    peer: false,
                    points,
                });
            }
            let rust = rust(&point.setting, &self.constructor, self.until);
            let mut page = match &point.outcome {
                Outcome::Refused(reason) => PagePoint::refused(point.setting.label(), reason),
                Outcome::Done { errors, expected, verdict: judgement } => PagePoint {
                    expected: expected.map(|expected| expected.error),
                    doubted: expected.is_some_and(|expected| !expected.is_trusted),
                    perturbed: point.perturbed.filter(|error| error.is_finite()),
                    verdict: verdict(*judgement),
                    front: on_front.contains(&index),
                    evaluations: point.effort.evaluations,
                    corrections: point.effort.corrections,
                    steps: point.effort.steps,
                    ..PagePoint::done(point.setting.label(), errors, point.time)
                },
            };
            page.rust = rust;
            if let Some(curve) = curves.last_mut() {
                curve.points.push(page);
            }
        }
        curves.extend(self.peer_curves());
        Page {
            name: &self.name,
            title: &self.title,
            command: &self.command,
            unit: self.unit(),
            judged: &self.judged,
            second: self.second,
            asked: self.asked,
            sentence: self.sentence(),
            choice: cheapest(&self.points, self.asked).map(|point| Choice {
                setting: point.setting.to_string(),
                error: point.error(),
                time: point.time,
                rust: rust(&point.setting, &self.constructor, self.until),
            }),
            width: self.width,
            facts: &self.facts,
            curves,
            splines: splines::page(&self.valleys),
        }
    }

    /// Curves of other programs.
    fn peer_curves(&self) -> Vec<Curve> {
        let mut curves: Vec<Curve> = Vec::new();
        for peer in &self.peers {
            let page = match &peer.outcome {
                Err(reason) => PagePoint::refused(peer.setting.clone(), reason),
                Ok(run) => PagePoint {
                    verdict: "right",
                    evaluations: run.evaluations,
                    ..PagePoint::done(peer.setting.clone(), &run.errors, run.time)
                },
            };
            match curves.last_mut().filter(|curve| curve.name == peer.program) {
                Some(curve) => curve.points.push(page),
                None => curves.push(Curve {
                    name: peer.program.clone(),
                    colour: curves.len(),
                    mark: 5,
                    dashed: true,
                    lanes: false,
                    advised: false,
                    kernel: None,
                    epsilon: f64::EPSILON,
                    peer: true,
                    points: vec![page],
                }),
            }
        }
        curves
    }

    /// Data of the page, for a document of the command.
    pub fn document(&self) -> serde_json::Value {
        serde_json::to_value(self.data()).expect("plain data has a JSON form")
    }

    /// The self-contained page.
    pub fn page(&self) -> String {
        const TEMPLATE: Template = Template {
            html: include_str!("page/page.html"),
            style: include_str!("page/page.css"),
            script: include_str!("page/page.js"),
        };
        TEMPLATE.filled(&self.title, &self.origin, &self.data())
    }

    /// One line a point.
    pub fn csv(&self) -> String {
        let mut text = format!(
            "numbers,curve,setting,result,error,median error,velocity error,{} error,multiplier error,event time error (s),energy error,violation,expected error,expected error is trusted,time ({}),evaluations,corrections,steps,on the front\n",
            self.second,
            self.unit()
        );
        let on_front = front(&self.points);
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let known = |value: f64| if value.is_nan() { String::new() } else { format!("{value:e}") };
        for (index, point) in self.points.iter().enumerate() {
            let head = [
                point.setting.numbers().name().to_string(),
                quoted(&point.setting.curve()),
                quoted(&point.setting.label()),
            ];
            let rest = match &point.outcome {
                Outcome::Refused(reason) => vec![quoted(reason)],
                Outcome::Done { errors, expected, verdict: judgement } => vec![
                    verdict(*judgement).to_string(),
                    format!("{:e}", errors.judged),
                    format!("{:e}", errors.median),
                    format!("{:e}", errors.rate),
                    format!("{:e}", errors.second),
                    known(errors.multiplier),
                    known(errors.contact),
                    format!("{:e}", errors.energy),
                    format!("{:e}", errors.violation),
                    expected.map_or_else(String::new, |expected| format!("{:e}", expected.error)),
                    expected.map_or_else(String::new, |expected| expected.is_trusted.to_string()),
                    format!("{:.4}", point.time),
                    point.effort.evaluations.to_string(),
                    point.effort.corrections.to_string(),
                    point.effort.steps.to_string(),
                    on_front.contains(&index).to_string(),
                ],
            };
            text += &head.into_iter().chain(rest).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        for peer in &self.peers {
            let head = ["f64".to_string(), quoted(&peer.program), quoted(&peer.setting)];
            let number = |value: f64| if value.is_finite() { format!("{value:e}") } else { String::new() };
            let rest = match &peer.outcome {
                Err(reason) => vec![quoted(reason)],
                Ok(PeerRun { errors, time, evaluations }) => {
                    let errors = [errors.judged, errors.median, errors.rate];
                    let mut rest = vec!["other program".to_string()];
                    rest.extend(errors.map(number));
                    // Reactions, multipliers, contacts, energy, violation and the expected error are not known.
                    rest.extend([const { String::new() }; 7]);
                    rest.extend([format!("{time:.4}"), evaluations.to_string()]);
                    rest.extend(["", "", "false"].map(str::to_string));
                    rest
                }
            };
            text += &head.into_iter().chain(rest).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::erased::timed_runs::Effort;
    use crate::setting::{Closing, Kernel};

    #[test]
    fn curves_of_kinematics_tell_their_sines() {
        let point = |kernel| {
            let (numbers, closing) = (Numbers::Double, Closing::Closed);
            let errors = Errors { judged: 1e-15, ..Errors::default() };
            Point {
                setting: Setting::Kinematics { numbers, lanes: 1, closing, steps: 24, kernel },
                outcome: Outcome::Done { errors, expected: None, verdict: Verdict::Right },
                effort: Effort::default(),
                time: 100.0,
                perturbed: None,
            }
        };
        let text = String::new;
        let result = CostResult {
            origin: text(),
            name: text(),
            title: text(),
            command: text(),
            constructor: text(),
            until: 1.0,
            asked: 1e-6,
            points: [Kernel::Own, Kernel::Fused, Kernel::Library].map(point).into(),
            peers: Vec::new(),
            valleys: Vec::new(),
            width: None,
            judged: text(),
            second: "acceleration",
            facts: Vec::new(),
        };
        let document = result.document();
        let kernels = document["curves"].as_array().expect("curves").iter().map(|curve| &curve["kernel"]);
        assert_eq!(kernels.collect::<Vec<_>>(), ["own", "fma", "libm"]);
    }
}

//! One self-contained HTML page with the moving mechanism, plots and figures.

use serde::Serialize;

use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::facade::Motion;
use crate::output::places::PlaceCurve;

const PAGE: &str = include_str!("report/page.html");
const STYLE: &str = include_str!("report/page.css");
/// Scripts of one scope, in the order of their dependencies.
const SCRIPT: &str = concat!(
    include_str!("report/elements.js"),
    "\n",
    include_str!("report/data.js"),
    "\n",
    include_str!("report/outlines.js"),
    "\n",
    include_str!("report/shapes.js"),
    "\n",
    include_str!("report/drawing.js"),
    "\n",
    include_str!("report/camera.js"),
    "\n",
    include_str!("report/gif.js"),
    "\n",
    include_str!("report/save.js"),
    "\n",
    include_str!("report/plots.js"),
    "\n",
    include_str!("report/groups.js"),
    "\n",
    include_str!("report/forces.js"),
    "\n",
    include_str!("report/modes.js"),
    "\n",
    include_str!("report/controls.js"),
    "\n",
    include_str!("report/page.js"),
);

/// Content of the page.
#[derive(Clone, Debug, Serialize)]
pub struct Report<'a> {
    /// Name on the command line.
    pub name: &'a str,
    /// Heading.
    pub title: &'a str,
    /// One or two sentences.
    pub description: &'a str,
    /// The text of the mechanism.
    pub source: &'a str,
    /// Program, version and hash of the text.
    pub origin: &'a str,
    /// The command that makes this page again.
    pub command: &'a str,
    /// Pairs of a name and a value worth knowing.
    pub facts: &'a [[String; 2]],
    /// Motions of the same mechanism.
    pub runs: &'a [Run<'a>],
    /// Shapes as [`shapes`](crate::output::shapes::shapes()) writes them.
    pub drawing: &'a [serde_json::Value],
    /// Outputs that are forces at places of the drawing.
    pub forces: &'a [ForceArrow<'a>],
    /// Measured points.
    #[serde(skip_serializing_if = "<[Overlay]>::is_empty")]
    pub overlays: &'a [Overlay],
    /// A parameter that the page slides through its range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slider: Option<&'a Slider<'a>>,
    /// The analysis: `kinematics`, `simulation`, `equilibrium`, `inverse` or `modes`.
    pub analysis: &'a str,
}

/// A parameter with its range and motions at some of its values.
#[derive(Clone, Debug, Serialize)]
pub struct Slider<'a> {
    /// Name, with the component of an array.
    pub name: &'a str,
    /// Unit of the values.
    pub unit: &'a str,
    /// Value of the page's runs.
    pub value: f64,
    /// Least and largest value.
    pub range: [f64; 2],
    /// Largest deviation of a part that is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// The other stops, ascending.
    pub stops: Vec<SliderStop<'a>>,
}

/// A value of a slider, with the same runs as the page or with the reason why there are none.
#[derive(Clone, Debug, Serialize)]
pub struct SliderStop<'a> {
    /// The value.
    pub value: f64,
    /// Runs in the order of the page's.
    pub runs: Vec<Run<'a>>,
    /// One line, where there are no runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'a str>,
}

/// A force that is drawn as an arrow.
#[derive(Clone, Debug, Serialize)]
pub struct ForceArrow<'a> {
    /// Name of the output, a vector (N).
    pub of: &'a str,
    /// Name of the place at which it acts, in the run's places.
    pub at: &'a str,
}

/// Measured points that are drawn over a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Overlay {
    /// Name of the output or the coordinate.
    pub of: String,
    /// File that they are from.
    pub file: String,
    /// Times (s).
    pub time: Vec<f64>,
    /// Values, in the unit of the curve.
    pub value: Vec<f64>,
}

/// Verdict on a position of rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// One of `fixed`, `stable`, `marginal`, `indifferent`, `unstable` and `unknown`.
    pub course: &'static str,
    /// The verdict in words.
    pub text: String,
}

/// A motion with its name.
#[derive(Clone, Debug, Serialize)]
pub struct Run<'a> {
    /// Short name.
    pub label: &'a str,
    /// One phrase.
    pub description: &'a str,
    /// The motion.
    #[serde(flatten)]
    pub motion: &'a Motion,
    /// Drawn places that are no outputs.
    #[serde(skip_serializing_if = "<[PlaceCurve]>::is_empty")]
    pub places: &'a [PlaceCurve],
    /// Verdict on a position of rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<&'a Verdict>,
    /// Time and reason in one line, where the motion ends before its time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended: Option<&'a str>,
    /// Small motions about its last instant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub small: Option<&'a SmallMotions>,
}

/// The page as one HTML file that needs no network.
pub fn html(report: &Report) -> String {
    let json = serde_json::to_string(report).expect("plain data has a JSON form");
    // A script element must contain neither `</script>` nor `<!--`, which comments of a text may have.
    let json = json.replace('<', "\\u003c");
    let title = escaped(report.title);
    let origin = escaped(report.origin).replace('"', "&quot;");
    let marks = [
        ("/*TITLE*/", title.as_str()),
        ("/*ORIGIN*/", origin.as_str()),
        ("/*STYLE*/", STYLE),
        ("/*DATA*/", json.as_str()),
        ("/*SCRIPT*/", SCRIPT),
    ];
    filled(PAGE, &marks)
}

/// The template with each mark replaced; inserted text is not searched for marks again.
fn filled(template: &str, marks: &[(&str, &str)]) -> String {
    let mut page =
        String::with_capacity(template.len() + marks.iter().map(|(_, text)| text.len()).sum::<usize>());
    let mut rest = template;
    let next = |rest: &str| {
        let found = marks.iter().filter_map(|(mark, text)| rest.find(mark).map(|at| (at, mark.len(), *text)));
        found.min_by_key(|(at, ..)| *at)
    };
    while let Some((at, length, text)) = next(rest) {
        page.push_str(&rest[..at]);
        page.push_str(text);
        rest = &rest[at + length..];
    }
    page.push_str(rest);
    page
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbs_codegen::picture::{Along, Shape};

    use crate::output::shapes::shapes;

    fn page(source: &str) -> String {
        let name = str::to_owned;
        let motion = Motion { time: vec![0.0], closure: vec![1e-17], ..Motion::default() };
        html(&Report {
            name: "name",
            title: "A & B",
            description: "",
            source,
            origin: "mbs 1, \"name\", text 2",
            command: "mbs run name",
            facts: &[["steps".to_string(), "1".to_string()]],
            runs: &[Run {
                label: "one",
                description: "",
                motion: &motion,
                places: &[],
                verdict: None,
                ended: Some("the motion ends at t = 0 s"),
                small: None,
            }],
            forces: &[ForceArrow { of: "bearing", at: "O" }],
            overlays: &[],
            slider: None,
            analysis: "kinematics",
            drawing: &shapes(&[
                Shape::Joint { at: name("O") },
                Shape::Slider { at: name("S"), along: Along::Fixed([1.0, 0.0]) },
                Shape::Trace { of: name("P"), label: name("curve") },
                Shape::Slider { at: name("S"), along: Along::Named(name("phi")) },
                Shape::Face { points: ["L", "R"].map(name), back: name("G"), label: name("follower") },
            ]),
        })
    }

    fn data(page: &str) -> serde_json::Value {
        let (_, rest) = page.split_once("id=\"data\">").expect("the data element");
        let (json, _) = rest.split_once("</script>").expect("its end");
        serde_json::from_str(json).expect("JSON")
    }

    #[test]
    fn the_data_has_the_schema_of_the_page() {
        let data = data(&page("mechanism!"));
        assert_eq!(data["runs"][0]["label"], "one");
        assert_eq!(data["runs"][0]["closure"][0], 1e-17);
        assert_eq!(data["facts"][0], serde_json::json!(["steps", "1"]));
        assert_eq!(data["drawing"][1], serde_json::json!({"kind": "slider", "at": "S", "along": [1.0, 0.0]}));
        assert_eq!(data["runs"][0]["ended"], "the motion ends at t = 0 s");
        assert_eq!(data["forces"][0], serde_json::json!({"of": "bearing", "at": "O"}));
        assert_eq!(data["drawing"][3]["along"], "phi");
        assert_eq!(data["drawing"][4]["points"], serde_json::json!(["L", "R"]));
        assert_eq!(data["drawing"][2], serde_json::json!({"kind": "trace", "of": "P", "label": "curve"}));
    }

    #[test]
    fn a_page_without_data_is_small() {
        let most = 200_000;
        let bare = PAGE.len() + STYLE.len() + SCRIPT.len();
        assert!(bare <= most, "{bare} bytes without data, at most {most} are allowed");
    }

    #[test]
    fn a_text_cannot_end_the_script_element() {
        let source = "</script><!-- /*STYLE*/ /*DATA*/ & \u{2028}";
        assert_eq!(data(&page(source))["source"], source);
    }

    #[test]
    fn all_marks_are_filled_and_nothing_is_fetched() {
        let page = page("text");
        assert!(page.contains("<title>A &amp; B</title>"));
        assert!(page.contains("<meta name=\"generator\" content=\"mbs 1, &quot;name&quot;, text 2\">"));
        for mark in ["/*TITLE*/", "/*ORIGIN*/", "/*STYLE*/", "/*DATA*/", "/*SCRIPT*/"] {
            assert!(!page.contains(mark), "{mark}");
        }
        for fetch in ["src=\"http", "href=\"http", "url(http", "@import", "fetch(", "import("] {
            assert!(!page.contains(fetch), "{fetch}");
        }
    }
}

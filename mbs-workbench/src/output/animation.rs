//! A motion as one SVG file that moves by itself, for documents that run no scripts.
//!
//! Shapes are read in the form that the report's page gets them in: objects with a `kind`, see [`crate::output::shapes`].

mod outlines;

use std::fmt::Write;

use serde_json::Value;

use self::outlines::{
    BAR, DURATION, Path, angle, arrow, coil, disc, distance, face, fill, joint, length, line, polygon,
    profile, rail, stroke, support, turning, written,
};
use super::places::PlaceCurve;
use super::svg::{COLOURS, open};
use crate::motion::Motion;

/// Positions of a turn: between two of them points move along straight lines.
const FRAMES: usize = 90;

/// Shortest duration of the animation (s): a faster motion is slowed down, so that eyes can follow it.
const SHORTEST: f64 = 4.0;

const WIDTH: f64 = 480.0;
const MARGIN: f64 = 36.0;

/// The motion drawn with `shapes` and with the `places` of them that are no outputs, in a loop; a motion shorter than four seconds is slowed down.
///
/// # Errors
/// A message where the motion has no second instant, a point is missing, or a shape has no animated form.
pub fn animation(shapes: &[Value], motion: &Motion, places: &[PlaceCurve]) -> Result<String, String> {
    animation_of(FRAMES, shapes, motion, places)
}

/// The same in at most this many positions. A shape of the kind `arrow` points from the first of its `points` to the second; where both are
/// one point a ring marks it.
///
/// # Errors
/// As [`animation`].
pub fn animation_of(
    frames: usize,
    shapes: &[Value],
    motion: &Motion,
    places: &[PlaceCurve],
) -> Result<String, String> {
    let (Some(first), Some(last)) = (motion.time.first(), motion.time.last()) else {
        return Err("the motion has no instant".to_string());
    };
    if motion.time.len() < 2 {
        return Err("a position of rest has no motion to draw".to_string());
    }
    let mut stage = Stage::new(frames, shapes, motion, places)?;
    for shape in shapes {
        stage.draw(shape)?;
    }
    let mut svg = open(WIDTH as usize, stage.height as usize);
    let duration = format!("dur=\"{:.2}s\" repeatCount=\"indefinite\"", (last - first).max(SHORTEST));
    for layer in [stage.ground, stage.traces, stage.bodies, stage.joints] {
        svg.push_str(&layer.replace(DURATION, &duration));
    }
    Ok(svg + "</svg>\n")
}

/// Points in pixels, and the layers of the picture from below to above.
struct Stage<'a> {
    motion: &'a Motion,
    places: &'a [PlaceCurve],
    frames: Vec<usize>,
    view: Option<[[f64; 3]; 2]>,
    scale: f64,
    shift: [f64; 2],
    height: f64,
    body: usize,
    ground: String,
    traces: String,
    bodies: String,
    joints: String,
}

impl<'a> Stage<'a> {
    fn new(
        frames: usize,
        shapes: &[Value],
        motion: &'a Motion,
        places: &'a [PlaceCurve],
    ) -> Result<Self, String> {
        let last = motion.time.len() - 1;
        let count = frames.clamp(1, last);
        let view = shapes.iter().find(|shape| shape["kind"] == "view").map(|shape| {
            ["right", "up"].map(|key| [0, 1, 2].map(|index| shape[key][index].as_f64().unwrap_or(0.0)))
        });
        let mut stage = Stage {
            motion,
            places,
            frames: (0..=count).map(|frame| frame * last / count).collect(),
            view,
            scale: 1.0,
            shift: [0.0; 2],
            height: 0.0,
            body: 0,
            ground: String::new(),
            traces: String::new(),
            bodies: String::new(),
            joints: String::new(),
        };
        stage.fit(shapes)?;
        Ok(stage)
    }

    /// Scale and shift with which all points and discs lie within the margins.
    fn fit(&mut self, shapes: &[Value]) -> Result<(), String> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for shape in shapes {
            let radius = match (shape["at"].as_str(), rim(shape)) {
                (Some(centre), Some(rim)) => {
                    let all = self.path(centre)?.into_iter().zip(self.path(rim)?);
                    all.map(|(a, b)| length([b[0] - a[0], b[1] - a[1]])).fold(0.0, f64::max)
                }
                _ => 0.0,
            };
            for name in names(shape) {
                let around = if shape["at"] == *name { radius } else { 0.0 };
                for point in self.path(name)? {
                    for axis in 0..2 {
                        low[axis] = low[axis].min(point[axis] - around);
                        high[axis] = high[axis].max(point[axis] + around);
                    }
                }
            }
        }
        let size = [0, 1].map(|axis| high[axis] - low[axis]);
        if !(size[0].is_finite() && size[1].is_finite() && size[0].max(size[1]) > 0.0) {
            return Err("the drawing has no points that differ".to_string());
        }
        // No higher than wide.
        let free = WIDTH - 2.0 * MARGIN;
        self.scale = free / size[0].max(size[1]);
        self.height = (size[1] * self.scale + 2.0 * MARGIN).ceil();
        let middle = [0, 1].map(|axis| (high[axis] + low[axis]) / 2.0 * self.scale);
        self.shift = [WIDTH / 2.0 - middle[0], self.height / 2.0 + middle[1]];
        Ok(())
    }

    /// Values of a scalar output, or of a component of a point, one an instant.
    fn column(&self, name: &str) -> Option<&'a Vec<f64>> {
        let outputs = self.motion.outputs.iter().map(|curve| (curve.name, &curve.value));
        let places = self.places.iter().map(|curve| (curve.name.as_str(), &curve.value));
        outputs.chain(places).find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// A point's path (m), one place a frame.
    fn path(&self, name: &str) -> Result<Path, String> {
        let component = |index: usize| self.column(&format!("{name}.{index}"));
        let found: Vec<&Vec<f64>> = (0..3).map_while(component).collect();
        let at = |frame: &usize| match (self.view, &found[..]) {
            (Some(view), [x, y, z]) => {
                view.map(|axis| axis[0] * x[*frame] + axis[1] * y[*frame] + axis[2] * z[*frame])
            }
            (_, components) => [components[0][*frame], components[1][*frame]],
        };
        if found.len() < 2 {
            return Err(format!("no output of two or three components has the name `{name}`"));
        }
        let path: Path = self.frames.iter().map(at).collect();
        if path.iter().flatten().any(|component| !component.is_finite()) {
            return Err(format!("`{name}` is not a number at all instants"));
        }
        Ok(path)
    }

    fn pixels(&self, name: &str) -> Result<Path, String> {
        let [dx, dy] = self.shift;
        let to_pixels = |[x, y]: [f64; 2]| [dx + x * self.scale, dy - y * self.scale];
        Ok(self.path(name)?.into_iter().map(to_pixels).collect())
    }

    fn all_pixels(&self, shape: &Value) -> Result<Vec<Path>, String> {
        names(shape).into_iter().map(|name| self.pixels(name)).collect()
    }

    /// Directions in pixels (degrees), from two numbers, an angle or a vector.
    fn directions(&self, along: &Value) -> Result<Vec<f64>, String> {
        let turned = |[x, y]: [f64; 2]| -y.atan2(x).to_degrees();
        let Some(name) = along.as_str() else {
            let fixed = [0, 1].map(|index| along[index].as_f64().unwrap_or(0.0));
            return Ok(vec![turned(fixed); self.frames.len()]);
        };
        match self.angle(name) {
            Some(angle) => Ok(angle.into_iter().map(|angle| -angle.to_degrees()).collect()),
            None => Ok(self.path(name)?.into_iter().map(turned).collect()),
        }
    }

    /// A coordinate or a scalar output, one value a frame.
    fn angle(&self, name: &str) -> Option<Vec<f64>> {
        let coordinate =
            self.motion.coordinates.iter().find(|curve| curve.name == name).map(|curve| &curve.q);
        let values = coordinate.or_else(|| self.column(name))?;
        Some(self.frames.iter().map(|frame| values[*frame]).collect())
    }

    fn draw(&mut self, shape: &Value) -> Result<(), String> {
        let kind = shape["kind"].as_str().unwrap_or_default();
        let points = self.all_pixels(shape)?;
        let colour = self.colour(kind, shape);
        match kind {
            "view" => {}
            "ground" => {
                let [x, y] = points[0][0];
                support(&mut self.ground, x, y);
                joint(&mut self.joints, &points[0]);
            }
            "joint" => joint(&mut self.joints, &points[0]),
            "trace" => {
                let path = points[0].clone();
                let points = written(&path, " ");
                let style = "fill=\"none\" stroke=\"#555555\" stroke-width=\"1.5\" stroke-dasharray=\"5 4\"";
                let _ = writeln!(self.traces, "<polyline points=\"{points}\" {style}/>");
                turning(&mut self.joints, &path, &[0.0], "<circle r=\"4\" fill=\"#555555\"/>");
            }
            "link" => line(&mut self.bodies, &points, &stroke(colour, BAR)),
            "slot" => {
                line(&mut self.bodies, &points, &stroke(colour, 2.0 * BAR));
                line(&mut self.bodies, &points, &stroke("white", BAR));
            }
            "plate" => {
                let style = format!("{} fill-opacity=\"0.35\"", stroke(colour, 0.6 * BAR));
                polygon(&mut self.bodies, &points, &style.replace("fill=\"none\"", &fill(colour)));
            }
            "arrow" => arrow(&mut self.joints, &points[0], &points[1]),
            "spring" => line(&mut self.bodies, &coil(&points), &stroke("#555555", 2.0)),
            "face" => face(&mut self.bodies, &points, colour),
            "slider" => {
                let turns = self.directions(&shape["along"])?;
                let (w, h) = (2.9 * BAR, 1.8 * BAR);
                let (x, y) = (-w / 2.0, -h / 2.0);
                let block = format!(
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"2\" {}/>",
                    fill("#bbbbbb")
                );
                turning(&mut self.bodies, &points[0], &turns, &block);
                joint(&mut self.joints, &points[0]);
            }
            "rail" => {
                let turn = self.directions(&shape["along"])?[0];
                rail(&mut self.ground, &points[0], turn);
            }
            "wheel" | "gear" => {
                let radius = distance(points[0][0], points[1][0]);
                let turns = points[0].iter().zip(&points[1]).map(|(a, b)| angle(*a, *b)).collect::<Vec<_>>();
                turning(&mut self.bodies, &points[0], &turns, &disc(shape, radius, colour));
            }
            "cam" => {
                let turn = shape["turn"].as_str().unwrap_or_default();
                let turn = self.angle(turn).ok_or_else(|| format!("no output has the name `{turn}`"))?;
                let outline = profile(&points[0], &points[1], &turn);
                let turns: Vec<f64> = turn.iter().map(|turn| -turn.to_degrees()).collect();
                let cam = format!("<polygon points=\"{}\" {}/>", written(&outline, " "), fill(colour));
                turning(&mut self.bodies, &points[0], &turns, &cam);
            }
            other => return Err(format!("`{other}` has no animated form; the report shows it")),
        }
        Ok(())
    }

    /// The next colour for a body with a name, the same for its further parts.
    fn colour(&mut self, kind: &str, shape: &Value) -> &'static str {
        let is_body = ["link", "plate", "slot", "wheel", "gear", "cam", "face"].contains(&kind);
        if is_body && shape["label"].as_str().is_some_and(|label| !label.is_empty()) {
            self.body += 1;
        }
        COLOURS[self.body.saturating_sub(1) % 5]
    }
}

/// Names of the points of a shape, in the order in which they are drawn.
fn names(shape: &Value) -> Vec<&str> {
    let listed = shape["points"].as_array().into_iter().flatten();
    let single = ["at", "of", "rim", "contact", "back"].into_iter().map(|key| &shape[key]);
    listed.chain(single).filter_map(Value::as_str).collect()
}

fn rim(shape: &Value) -> Option<&str> {
    shape["rim"].as_str().or_else(|| shape["contact"].as_str())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::outlines::continued;
    use super::*;
    use crate::motion::{CoordinateCurve, OutputCurve};

    fn output(name: &'static str, value: [f64; 3]) -> OutputCurve {
        OutputCurve { name, unit: "m", value: value.to_vec(), rate: None, acceleration: None }
    }

    /// A crank that turns from 0° to 90°.
    fn quarter() -> Motion {
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let q = vec![0.0, 0.785, 1.571];
        let angle = CoordinateCurve { name: "phi", unit: "rad", q, qd: vec![0.0; 3], qdd: vec![0.0; 3] };
        Motion {
            time: vec![0.0, 0.5, 1.0],
            coordinates: vec![angle],
            outputs: vec![
                output("O.0", [0.0; 3]),
                output("O.1", [0.0; 3]),
                output("A.0", [1.0, half, 0.0]),
                output("A.1", [0.0, half, 1.0]),
            ],
            ..Motion::default()
        }
    }

    #[test]
    fn a_bar_has_its_places_in_pixels_and_a_support_stays() {
        let shapes = [
            json!({"kind": "ground", "at": "O"}),
            json!({"kind": "link", "points": ["O", "A"], "label": "crank"}),
            json!({"kind": "trace", "of": "A", "label": "path"}),
        ];
        let svg = animation(&shapes, &quarter(), &[]).expect("a picture");
        // 408 pixels between margins of 36; y counts downwards.
        let places = "values=\"36.0,444.0 444.0,444.0;36.0,444.0 324.5,155.5;36.0,444.0 36.0,36.0\"";
        assert!(svg.contains(places), "{svg}");
        assert_eq!(svg.matches("<animate").count(), 2, "the bar and the dot on the path move: {svg}");
        assert!(svg.contains("dur=\"4.00s\"") && !svg.contains(DURATION));
    }

    #[test]
    fn discs_turn_with_their_mark_and_blocks_with_their_direction() {
        let shapes = [
            json!({"kind": "gear", "at": "O", "rim": "A", "teeth": 12, "inside": false, "label": "gear"}),
            json!({"kind": "slider", "at": "A", "along": "phi"}),
        ];
        let svg = animation(&shapes, &quarter(), &[]).expect("a picture");
        assert!(
            svg.contains(
                "type=\"rotate\" dur=\"4.00s\" repeatCount=\"indefinite\" values=\"0.0;-45.0;-90.0\""
            ),
            "{svg}"
        );
        assert_eq!(svg.matches("type=\"rotate\"").count(), 2);
    }

    #[test]
    fn an_arrow_that_has_no_length_is_a_ring() {
        let mut motion = quarter();
        motion.outputs.extend([output("F.0", [1.0, 0.0, 0.0]), output("F.1", [0.0; 3])]);
        let bar = json!({"kind": "link", "points": ["O", "A"], "label": "crank"});
        let svg = animation(&[bar, json!({"kind": "arrow", "points": ["O", "F"]})], &motion, &[]);
        let svg = svg.expect("a picture");
        assert!(svg.contains("attributeName=\"r\"") && svg.contains("values=\"0;5;5\""), "{svg}");
        // Shaft and head in the first frame, one point in the others.
        assert!(
            svg.contains("<polygon points=\"36.0,442.5") && svg.contains(";36.0,444.0 36.0,444.0"),
            "{svg}"
        );
    }

    #[test]
    fn angles_go_on_over_half_a_turn() {
        assert_eq!(continued(&[170.0, -170.0, -10.0, 150.0]), [170.0, 190.0, 350.0, 510.0]);
    }

    #[test]
    fn refusals_name_the_reason() {
        let refused =
            |shapes: &[Value], motion: &Motion| animation(shapes, motion, &[]).expect_err("a refusal");
        let joint = json!({"kind": "joint", "at": "B"});
        assert!(refused(&[joint], &quarter()).contains("`B`"));
        let road = [json!({"kind": "road", "at": "A", "speed": 1.0}), json!({"kind": "joint", "at": "O"})];
        assert!(refused(&road, &quarter()).contains("`road`"));
        let mut broken = quarter();
        broken.outputs[2].value[1] = f64::NAN;
        assert!(refused(&[json!({"kind": "joint", "at": "A"})], &broken).contains("not a number"));
        let rest = Motion { time: vec![0.0], ..quarter() };
        assert!(refused(&[], &rest).contains("rest"));
        assert!(refused(&[], &quarter()).contains("no points"));
    }
}

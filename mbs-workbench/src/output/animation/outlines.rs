//! Elements of an animated picture, in pixels.

use std::fmt::Write;

use serde_json::Value;

/// Places of a point, one a frame.
pub type Path = Vec<[f64; 2]>;

/// Width of a bar.
pub const BAR: f64 = 10.0;

/// Replaced by the duration when the layers are joined.
pub const DURATION: &str = "dur=\"?\"";

pub fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    length([b[0] - a[0], b[1] - a[1]])
}

/// Direction from `a` to `b` in pixels (degrees).
pub fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[1] - a[1]).atan2(b[0] - a[0]).to_degrees()
}

pub fn written(path: &[[f64; 2]], separator: &str) -> String {
    path.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(separator)
}

pub fn stroke(colour: &str, width: f64) -> String {
    let ends = "stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" {ends}")
}

pub fn fill(colour: &str) -> String {
    format!("fill=\"{colour}\"")
}

/// An element whose `points` change, `points[i][frame]`; without them where none moves.
fn moving(layer: &mut String, tag: &str, points: &[Path], style: &str) {
    let frame = |k: usize| written(&points.iter().map(|path| path[k]).collect::<Vec<_>>(), " ");
    let frames: Vec<String> = (0..points[0].len()).map(frame).collect();
    let _ = write!(layer, "<{tag} points=\"{}\" {style}", frames[0]);
    let _ = if frames.iter().all(|frame| *frame == frames[0]) {
        writeln!(layer, "/>")
    } else {
        let values = frames.join(";");
        writeln!(layer, ">\n<animate attributeName=\"points\" {DURATION} values=\"{values}\"/>\n</{tag}>")
    };
}

pub fn line(layer: &mut String, points: &[Path], style: &str) {
    moving(layer, "polyline", points, style);
}

pub fn polygon(layer: &mut String, points: &[Path], style: &str) {
    moving(layer, "polygon", points, style);
}

/// An element about the origin, moved to `places` and turned by `turns` (degrees); one turn alone is none.
pub fn turning(layer: &mut String, places: &Path, turns: &[f64], inner: &str) {
    let place = |[x, y]: &[f64; 2]| format!("{x:.1},{y:.1}");
    let turned = |turn: &f64| format!("{turn:.1}");
    let places = transform("translate", places.iter().map(place).collect());
    let turns = transform("rotate", continued(turns).iter().map(turned).collect());
    let _ = writeln!(layer, "<g{places}<g{turns}{inner}</g></g>");
}

/// The rest of the opening tag of a group with a transformation, animated where its values change.
fn transform(kind: &str, values: Vec<String>) -> String {
    if values.iter().all(|value| *value == values[0]) {
        return format!(" transform=\"{kind}({})\">", values[0]);
    }
    let values = values.join(";");
    format!(
        ">\n<animateTransform attributeName=\"transform\" type=\"{kind}\" {DURATION} values=\"{values}\"/>\n"
    )
}

/// Angles without jumps of whole turns (degrees).
pub fn continued(angles: &[f64]) -> Vec<f64> {
    let mut last = angles[0];
    let next = |angle: &f64| {
        last = angle + 360.0 * ((last - angle) / 360.0).round();
        last
    };
    angles.iter().map(next).collect()
}

pub fn joint(layer: &mut String, places: &Path) {
    let circle = "<circle r=\"3.6\" fill=\"white\" stroke=\"#333333\" stroke-width=\"2\"/>";
    turning(layer, places, &[0.0], circle);
}

/// An arrow from one point to another; a ring where both are one.
pub fn arrow(layer: &mut String, from: &Path, to: &Path) {
    const HEAD: f64 = 9.0;
    const RED: &str = "#c8102e";
    let mut corners: [Path; 7] = Default::default();
    for (a, b) in from.iter().zip(to) {
        let long = distance(*a, *b);
        let along = if long > 0.0 { [(b[0] - a[0]) / long, (b[1] - a[1]) / long] } else { [0.0; 2] };
        let head = HEAD.min(0.6 * long);
        let place = |forth: f64, aside: f64| {
            [a[0] + forth * along[0] - aside * along[1], a[1] + forth * along[1] + aside * along[0]]
        };
        let (neck, wing) = (long - head, 0.5 * head);
        let outline =
            [(0.0, -1.5), (neck, -1.5), (neck, -wing), (long, 0.0), (neck, wing), (neck, 1.5), (0.0, 1.5)];
        corners.iter_mut().zip(outline).for_each(|(path, (forth, aside))| path.push(place(forth, aside)));
    }
    polygon(layer, &corners, &fill(RED));
    let radii = from.iter().zip(to).map(|(a, b)| if distance(*a, *b) > 0.0 { "0" } else { "5" });
    let radii: Vec<&str> = radii.collect();
    let animated = format!(
        "<circle r=\"{}\" fill=\"none\" stroke=\"{RED}\" stroke-width=\"1.5\">\n<animate attributeName=\"r\" calcMode=\"discrete\" \
         {DURATION} values=\"{}\"/>\n</circle>",
        radii[0],
        radii.join(";")
    );
    turning(layer, from, &[0.0], &animated);
}

pub fn support(layer: &mut String, x: f64, y: f64) {
    let (w, h) = (1.2 * BAR, 2.0 * BAR);
    let style = "fill=\"#dddddd\" stroke=\"#333333\" stroke-width=\"1.5\"";
    let _ = writeln!(layer, "<path d=\"M{x:.1} {y:.1}l{w} {h}h{}z\" {style}/>", -2.0 * w);
    hatching(layer, x - 1.6 * w, x + 1.6 * w, y + h, "");
}

/// A line from `from` to `to` with strokes below it.
fn hatching(layer: &mut String, from: f64, to: f64, y: f64, attributes: &str) {
    let mut d = format!("M{from:.1} {y:.1}H{to:.1}");
    let count = ((to - from) / 7.0).max(3.0).round();
    for index in 1..=count as usize {
        let _ = write!(d, "M{:.1} {y:.1}l-6 7", from + (to - from) * index as f64 / count);
    }
    let _ = writeln!(
        layer,
        "<path d=\"{d}\" fill=\"none\" stroke=\"#333333\" stroke-width=\"1.2\" {attributes}/>"
    );
}

/// A rail under the whole path of a block, in the direction `turn` (degrees).
pub fn rail(layer: &mut String, path: &Path, turn: f64) {
    // Hatching below or at the right.
    let turn = if turn > 90.0 {
        turn - 180.0
    } else if turn <= -90.0 {
        turn + 180.0
    } else {
        turn
    };
    let (sin, cos) = turn.to_radians().sin_cos();
    let along = path.iter().map(|[x, y]| (x - path[0][0]) * cos + (y - path[0][1]) * sin);
    let (low, high) = along.fold((0.0_f64, 0.0_f64), |(low, high), s| (low.min(s), high.max(s)));
    let [x, y] = path[0];
    let place = format!("transform=\"translate({x:.1} {y:.1}) rotate({turn:.1})\"");
    hatching(layer, low - 3.0 * BAR, high + 3.0 * BAR, 0.9 * BAR, &place);
}

/// Places along a spring: a straight end, eight half coils, a straight end.
pub fn coil(ends: &[Path]) -> Vec<Path> {
    let inner = (0..9).map(|i| {
        (0.15 + 0.7 * f64::from(i) / 8.0, if i % 8 == 0 { 0.0 } else { 1.0 - f64::from(i % 2) * 2.0 })
    });
    let places = [(0.0, 0.0)].into_iter().chain(inner).chain([(1.0, 0.0)]);
    let place = |(s, side): (f64, f64)| -> Path {
        let at = |(a, b): (&[f64; 2], &[f64; 2])| {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let away = side * 0.6 * BAR / dx.hypot(dy).max(1.0);
            [a[0] + s * dx - away * dy, a[1] + s * dy + away * dx]
        };
        ends[0].iter().zip(&ends[1]).map(at).collect()
    };
    places.map(place).collect()
}

/// A flat face between two points, and its stem from the foot of the perpendicular to `back`.
pub fn face(layer: &mut String, points: &[Path], colour: &str) {
    let foot = |k: usize| {
        let [a, b, back] = [0, 1, 2].map(|index| points[index][k]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let s = ((back[0] - a[0]) * dx + (back[1] - a[1]) * dy) / (dx * dx + dy * dy).max(1e-9);
        [a[0] + s * dx, a[1] + s * dy]
    };
    let feet: Path = (0..points[0].len()).map(foot).collect();
    line(layer, &points[..2], &stroke(colour, BAR));
    line(layer, &[feet, points[2].clone()], &stroke(colour, BAR));
}

/// A wheel with a mark, or a gear with its teeth, about the origin.
pub fn disc(shape: &Value, radius: f64, colour: &str) -> String {
    let (near, far) = (0.45 * radius, 0.85 * radius);
    let Some(count) = shape["teeth"].as_u64() else {
        let mark = format!("<path d=\"M{near:.1} 0H{far:.1}\" stroke=\"white\" stroke-width=\"3\"/>");
        return format!("<circle r=\"{radius:.1}\" {}/>{mark}", fill(colour));
    };
    let module = 2.0 * radius / count as f64;
    let inside = shape["inside"].as_bool() == Some(true);
    let corners = if inside {
        [(-1.0, -0.32), (1.25, -0.18), (1.25, 0.18), (-1.0, 0.32)]
    } else {
        [(-1.25, -0.33), (1.0, -0.13), (1.0, 0.13), (-1.25, 0.33)]
    };
    let corner = |(tooth, (away, side)): (u64, (f64, f64))| {
        let angle = (tooth as f64 + side) * std::f64::consts::TAU / count as f64;
        let radius = radius + away * module;
        [radius * angle.cos(), radius * angle.sin()]
    };
    let outline: Path = (0..count).flat_map(|tooth| corners.map(|at| corner((tooth, at)))).collect();
    if inside {
        let outer = radius + 3.4 * module;
        let ring = format!(
            "M{outer:.1} 0A{outer:.1} {outer:.1} 0 1 1 -{outer:.1} 0A{outer:.1} {outer:.1} 0 1 1 {outer:.1} 0Z"
        );
        return format!(
            "<path d=\"{ring}M{}Z\" fill-rule=\"evenodd\" {}/>",
            written(&outline, "L"),
            fill(colour)
        );
    }
    let mark = format!("<circle cx=\"{:.1}\" r=\"3\" fill=\"white\"/>", far - 2.0 * module);
    format!("<polygon points=\"{}\" {}/>{mark}", written(&outline, " "), fill(colour))
}

/// The path of the contact, turned back by the cam's angle (pixels).
pub fn profile(centres: &Path, contacts: &Path, turns: &[f64]) -> Path {
    let place = |((centre, contact), turn): ((&[f64; 2], &[f64; 2]), &f64)| {
        let (sin, cos) = turn.sin_cos();
        let (x, y) = (contact[0] - centre[0], contact[1] - centre[1]);
        // Pixels count downwards: the cam turns the other way round there.
        [cos * x - sin * y, sin * x + cos * y]
    };
    centres.iter().zip(contacts).zip(turns).map(place).collect()
}

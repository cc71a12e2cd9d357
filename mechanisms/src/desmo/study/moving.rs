//! Moving pictures: permanent contact, and a turn with contact forces as arrows.

use core::f64::consts::TAU;

use mbs_runtime::Function;
use mbs_workbench::motion::Motion;
use mbs_workbench::output::animation::{animation, animation_of};
use mbs_workbench::output::places::{PlaceCurve, places};
use mbs_workbench::output::shapes::shapes;
use mbs_workbench::study::{Picture, StudyError};
use serde_json::json;

use super::super::design::{Curve, Rocker};
use super::super::motion::Turn;
use super::super::{CARD, DesmoKinematic};
use super::{Chain, failed};

/// Positions of a turn with forces.
const FRAMES: usize = 240;
/// Duration of that turn (s).
const SECONDS: f64 = 16.0;
/// Length of the arrow of the largest force (m).
const LONGEST: f64 = 0.016;

/// Both cams, rockers and valve over a turn, without play.
pub fn kinematic(chain: &Chain) -> Result<Picture, StudyError> {
    let mut mechanism: DesmoKinematic<_> = chain.design.moved_by(chain.curves.clone());
    mechanism.speed = TAU / 6.0;
    mechanism.opener_radius = chain.design.opener.radius;
    mechanism.closer_radius = chain.design.closer.radius;
    let mechanism = mbs_workbench::erased::erase::erase(mechanism).into_mechanism();
    let mechanism = mechanism.ok_or_else(|| StudyError("the cams leave the valve free".to_string()))?;
    let motion = mbs_workbench::catalogue::sweep(mechanism.as_ref(), 6.0, 180).map_err(failed)?;
    let picture = CARD.picture().map_err(failed)?;
    let places = places(&picture, mechanism.as_ref(), &motion, None);
    let svg = animation(&shapes(&picture.shapes), &motion, &places).map_err(StudyError)?;
    Ok(Picture { caption: "Both cams, rockers and valve, a turn in six seconds".to_string(), svg })
}

type Point = [f64; 2];

fn plus(a: Point, b: Point, scale: f64) -> Point {
    [a[0] + scale * b[0], a[1] + scale * b[1]]
}

fn turned(angle: f64, [x, y]: Point) -> Point {
    let (sine, cosine) = angle.sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

/// A rocker in one position.
struct Pose {
    /// Centres of the pads on cam and valve.
    pads: [Point; 2],
    /// Unit normal of the cam towards its pad.
    normal: Point,
}

impl Pose {
    /// `angle`: of the rocker; `turn`: of the cam (rad).
    fn of(rocker: &Rocker, curve: &Curve, centre: Point, angle: f64, turn: f64) -> Self {
        let pad = |place: Point| plus(rocker.pivot, turned(angle, plus(place, rocker.pivot, -1.0)), 1.0);
        let pads = [pad(rocker.cam_pad), pad(rocker.valve_pad)];
        let [x, y] = plus(pads[0], centre, -1.0);
        let r = x.hypot(y);
        let tilt = curve.jet::<2>(y.atan2(x) - turn)[1] / r;
        // r̂ − (R′/r) ŵ
        let along = [x / r + tilt * y / r, y / r - tilt * x / r];
        let long = along[0].hypot(along[1]);
        Pose { pads, normal: along.map(|part| part / long) }
    }
}

/// The turn of a study with contact forces as arrows on pads and valve; open contacts are rings.
pub fn with_forces(chain: &Chain, caption: &str, turn: &Turn) -> Result<Picture, StudyError> {
    let (design, samples) = (&chain.design, turn.angle.len());
    let most = turn.forces.iter().flatten().fold(f64::MIN_POSITIVE, |most: f64, force| most.max(*force));
    let mut points: Vec<(&str, Vec<Point>)> = Vec::new();
    let mut put = |name: &'static str, point: Point| match points.iter_mut().find(|(known, _)| *known == name)
    {
        Some((_, path)) => path.push(point),
        None => points.push((name, vec![point])),
    };
    let sense = design.direction.sign();
    let mut angles = Vec::new();
    for frame in 0..FRAMES {
        let k = frame * samples / FRAMES;
        let [theta, opener, lift, closer] = [0, 1, 2, 3].map(|index| turn.coordinates[index][k]);
        let angle = sense * theta;
        angles.push(angle);
        let [a, c] = &chain.curves;
        let opening = Pose::of(&design.opener, a, design.centre, opener, angle);
        let closing = Pose::of(&design.closer, c, design.centre, closer, angle);
        // Contours at the kinematic contact, which goes once around each cam.
        let [open_cam, close_cam] = [0, 1]
            .map(|index| plus(design.centre, turned(angle, chain.cams[index].place(theta).contour), 1.0));
        // The shorter impacts of a frame count too.
        let next = (frame + 1) * samples / FRAMES;
        let force = |index: usize| turn.forces[index][k..next].iter().copied().fold(0.0, f64::max);
        let (up, down) = ([0.0, 1.0], [0.0, -1.0]);
        let under = design.closer.valve_pad[1] + FORK;
        let arrows: [(usize, [&'static str; 2], Point, Point); 5] = [
            (
                0,
                ["nose", "nose_tip"],
                plus(opening.pads[0], opening.normal, -design.opener.radius),
                opening.normal,
            ),
            (1, ["tip", "tip_tip"], [opening.pads[1][0], -lift], down),
            (2, ["seat", "seat_tip"], [SEAT, STEM - lift], down),
            (
                3,
                ["heel", "heel_tip"],
                plus(closing.pads[0], closing.normal, -design.closer.radius),
                closing.normal,
            ),
            (4, ["fork", "fork_tip"], [closing.pads[1][0], under - lift], up),
        ];
        for (index, [from, to], place, direction) in arrows {
            put(from, place);
            put(to, plus(place, direction, LONGEST * force(index) / most));
        }
        put("C", design.centre);
        put("P", design.opener.pivot);
        put("Q", design.closer.pivot);
        put("A", opening.pads[0]);
        put("A_rim", plus(opening.pads[0], opening.normal, -design.opener.radius));
        put("B", opening.pads[1]);
        put("B_rim", plus(opening.pads[1], down, design.opener.valve_pad[1]));
        put("D", closing.pads[0]);
        put("D_rim", plus(closing.pads[0], closing.normal, -design.closer.radius));
        put("E", closing.pads[1]);
        put("E_rim", plus(closing.pads[1], up, FORK));
        put("opening_cam", open_cam);
        put("closing_cam", close_cam);
        put("valve", [0.0, under - lift]);
        put("head", [0.0, STEM - lift]);
        put("head_left", [-SEAT, STEM - lift]);
        put("head_right", [SEAT, STEM - lift]);
        let [low, high] = [under - lift, -lift];
        let corners =
            ["a", "b", "c", "d"].into_iter().zip([[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]]);
        for (corner, [x, y]) in corners {
            let upper: [&'static str; 4] = ["upper_a", "upper_b", "upper_c", "upper_d"];
            let lower: [&'static str; 4] = ["lower_a", "lower_b", "lower_c", "lower_d"];
            let index = usize::from(corner.as_bytes()[0] - b'a');
            put(upper[index], [x * ADJUSTER, high - ADJUSTER_HEIGHT * (1.0 - y)]);
            put(lower[index], [x * ADJUSTER, low + ADJUSTER_HEIGHT * y]);
        }
    }
    let mut curves: Vec<PlaceCurve> = Vec::new();
    for (name, path) in points {
        for axis in 0..2 {
            let value = path.iter().map(|point| point[axis]).collect();
            curves.push(PlaceCurve { name: format!("{name}.{axis}"), value, modes: Vec::new() });
        }
    }
    curves.push(PlaceCurve { name: "turned".to_string(), value: angles, modes: Vec::new() });
    let arrow = |from: &str, to: &str| json!({ "kind": "arrow", "points": [from, to] });
    let plate = |names: [&str; 4], label: &str| json!({ "kind": "plate", "points": names, "label": label });
    let shapes = [
        json!({ "kind": "ground", "at": "C" }),
        json!({ "kind": "ground", "at": "P" }),
        json!({ "kind": "ground", "at": "Q" }),
        json!({ "kind": "cam", "at": "C", "contact": "closing_cam", "turn": "turned", "label": "closing cam" }),
        json!({ "kind": "cam", "at": "C", "contact": "opening_cam", "turn": "turned", "label": "opening cam" }),
        json!({ "kind": "link", "points": ["A", "P", "B"], "label": "opener" }),
        json!({ "kind": "wheel", "at": "A", "rim": "A_rim", "label": "" }),
        json!({ "kind": "wheel", "at": "B", "rim": "B_rim", "label": "" }),
        json!({ "kind": "link", "points": ["D", "Q", "E"], "label": "closer" }),
        json!({ "kind": "wheel", "at": "D", "rim": "D_rim", "label": "" }),
        json!({ "kind": "wheel", "at": "E", "rim": "E_rim", "label": "" }),
        json!({ "kind": "link", "points": ["valve", "head"], "label": "valve" }),
        json!({ "kind": "link", "points": ["head_left", "head_right"], "label": "" }),
        plate(["upper_a", "upper_b", "upper_c", "upper_d"], ""),
        plate(["lower_a", "lower_b", "lower_c", "lower_d"], ""),
        arrow("nose", "nose_tip"),
        arrow("tip", "tip_tip"),
        arrow("seat", "seat_tip"),
        arrow("heel", "heel_tip"),
        arrow("fork", "fork_tip"),
    ];
    let time = (0..FRAMES).map(|frame| SECONDS * frame as f64 / FRAMES as f64).collect();
    let motion = Motion { time, ..Motion::default() };
    let svg = animation_of(FRAMES, &shapes, &motion, &curves).map_err(StudyError)?;
    let caption = format!(
        "{caption}: forces on pads and valve, the longest arrow is {:.1} kN; rings are open contacts",
        1e-3 * most
    );
    Ok(Picture { caption, svg })
}

/// Radius of the closer's pad on the lower adjuster (m).
const FORK: f64 = 0.006;
/// Drawn: place of the valve's head, half its width (m).
const STEM: f64 = -0.034;
const SEAT: f64 = 0.010;
/// Drawn: half the width of an adjuster, its height (m).
const ADJUSTER: f64 = 0.0055;
const ADJUSTER_HEIGHT: f64 = 0.002;

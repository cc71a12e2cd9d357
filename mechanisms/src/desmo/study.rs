//! The study of the valvetrain: synthesis, kinematic check, rigid dynamics at two speeds, sensitivity, cost of accuracy.

mod chain;
mod moving;
mod pictures;

use core::f64::consts::PI;

use mbs_workbench::cams::follower::{Cam, Direction};
use mbs_workbench::cams::lift::Lift;
use mbs_workbench::study::{Parameter, Range, Report, Study, StudyError, Values};

use super::Design;
use super::design::{Curve, Rocker};
use super::motion::{Ordinary, Turn, Valvetrain};

/// `mbs study desmo`.
pub const STUDY: Study = Study {
    about: "a desmodromic valvetrain from the lift law to the contact forces at two speeds",
    parameters: &[
        parameter("speed", "rad/s", 9000.0 * PI / 30.0, Range::Positive, "speed of the cam"),
        parameter("slow", "rad/s", 5000.0 * PI / 30.0, Range::Positive, "the other speed"),
        parameter("lift", "m", 0.011, Range::Positive, "lift of the valve; a `--law` has its own"),
        parameter(
            "duration",
            "rad",
            160.0 * PI / 180.0,
            Range::Positive,
            "cam angle from seat to seat; a `--law` has its own",
        ),
        parameter("sense", "1", 1.0, Range::Sign, "1 for cams that turn counter-clockwise, else -1"),
        parameter("open_play", "m", 1e-4, Range::NotNegative, "clearance between opener and valve"),
        parameter("close_play", "m", 3e-5, Range::NotNegative, "clearance between closer and valve"),
        parameter("stiffness", "N/m^1.5", 5e10, Range::Positive, "K of the contacts"),
        parameter("damping", "s/m", 1.5, Range::NotNegative, "D of the contacts"),
        parameter("valve_mass", "kg", 0.028, Range::Positive, "mass of the valve"),
        parameter("opener_inertia", "kg*m^2", 1.3e-5, Range::Positive, "moment of inertia about the pivot"),
        parameter("closer_inertia", "kg*m^2", 2.2e-5, Range::Positive, "moment of inertia about the pivot"),
        parameter(
            "preload",
            "N*m",
            1.2,
            Range::Any,
            "torque of the helper spring at lift 0, which closes the valve",
        ),
        parameter(
            "winding",
            "N*m",
            1.0,
            Range::Positive,
            "growth of that torque, for each radian of the closer",
        ),
        parameter(
            "spring",
            "N/m",
            35000.0,
            Range::NotNegative,
            "stiffness of the valve spring of the ordinary valvetrain",
        ),
        parameter("spring_preload", "N", 250.0, Range::NotNegative, "its force at lift 0"),
        parameter("drag", "N*s/m", 2.0, Range::NotNegative, "viscous friction of the guide"),
        parameter("dry", "N", 3.0, Range::NotNegative, "dry friction of the guide"),
        parameter("swing", "rad", 0.0, Range::Any, "amplitude of a harmonic of the cam's angle"),
        parameter("order", "1", 2.0, Range::Whole(1, 1000), "waves of that harmonic over a turn"),
        parameter(
            "points",
            "1",
            0.0,
            Range::Whole(0, 100_000),
            "points of the cams' tables; 0 for pitch curves in closed form",
        ),
        parameter("turns", "1", 3.0, Range::Whole(1, 1000), "turns from rest; the last one is shown"),
        parameter("runs", "1", 32.0, Range::Whole(1, 10_000), "perturbed runs of the envelope"),
        parameter(
            "spread",
            "1",
            0.2,
            Range::Within(0.0, 0.9),
            "half the width of the perturbations of K, D and clearances",
        ),
        place("centre_x", 0.012, "centre of both cams; the valve's tip is at 0, 0 and opens along -y"),
        place("centre_y", 0.020, "its height"),
        place("opener_x", 0.031, "pivot of the opener"),
        place("opener_y", 0.001, "its height"),
        place("opener_pad_x", 0.013, "centre of the opener's pad on its cam at lift 0"),
        place("opener_pad_y", -0.003_98, "its height"),
        parameter("opener_radius", "m", 0.012, Range::Positive, "radius of that pad"),
        place("opener_tip_x", 0.0, "centre of the opener's pad on the valve at lift 0"),
        place("opener_tip_y", 0.008, "its height, the radius of that pad"),
        place("closer_x", 0.035, "pivot of the closer"),
        place("closer_y", -0.009, "its height"),
        place("closer_pad_x", CLOSER_PAD[0], "centre of the closer's pad on its cam at lift 0"),
        place("closer_pad_y", CLOSER_PAD[1], "its height"),
        parameter("closer_radius", "m", 0.012, Range::Positive, "radius of that pad"),
        place("closer_fork_x", 0.0, "centre of the closer's pad under the valve at lift 0"),
        place("closer_fork_y", -0.012, "its height"),
    ],
    takes_law: true,
    run: study,
};

const fn parameter(
    name: &'static str,
    unit: &'static str,
    value: f64,
    range: Range,
    about: &'static str,
) -> Parameter {
    Parameter { name, unit, value, range, about }
}

/// A coordinate of a place.
const fn place(name: &'static str, value: f64, about: &'static str) -> Parameter {
    parameter(name, "m", value, Range::Any, about)
}

/// The pad of [`Design::ready`] on the closing cam, 29 mm from its pivot and from the cams' centre.
const CLOSER_PAD: [f64; 2] = [0.040_993_241_656_412_2, 0.019_373_950_279_223_47];

/// The pair with the places of the values. A cam that does not do what its rocker is for is refused.
fn design(values: &Values, law: Lift, direction: Direction) -> Result<Design, StudyError> {
    let at = |name: &str| [format!("{name}_x"), format!("{name}_y")].map(|name| values.get(&name));
    let rocker = |name: &str, tip: &str| Rocker {
        pivot: at(name),
        cam_pad: at(&format!("{name}_pad")),
        radius: values.get(&format!("{name}_radius")),
        valve_pad: at(&format!("{name}_{tip}")),
    };
    let (opener, closer) = (rocker("opener", "tip"), rocker("closer", "fork"));
    for (name, Rocker { cam_pad, radius, .. }) in [("opener", &opener), ("closer", &closer)] {
        let [x, y] = [0, 1].map(|axis| cam_pad[axis] - at("centre")[axis]);
        if x.hypot(y) <= *radius {
            return Err(StudyError(format!(
                "the pad of the {name}, {:.3} mm in radius, covers the cams' centre, which is {:.3} mm from its own\n\
                 help: make `{name}_radius` smaller, or move `{name}_pad_x` and `{name}_pad_y` away from there",
                1e3 * radius,
                1e3 * x.hypot(y)
            )));
        }
    }
    let design = Design { law, direction, centre: at("centre"), opener, closer };
    let cams = design.cams().map_err(|error| {
        // A length of 11 is one of 11 m.
        let is_long = STUDY.parameters.iter().any(|one| one.unit == "m" && values.get(one.name).abs() >= 0.5);
        let hint =
            if is_long { "\nhelp: lengths without a unit are in m; write `--param lift=11mm`" } else { "" };
        StudyError(format!("{error}{hint}"))
    })?;
    for (cam, (name, opens)) in cams.iter().zip([("opener", true), ("closer", false)]) {
        if cam.opens() != Some(opens) {
            let does = if opens { "closes" } else { "opens" };
            return Err(StudyError(format!(
                "the cam of the {name} {does} the valve\nhelp: put its pad on the cam, or that on the valve, on the other side of the pivot"
            )));
        }
    }
    Ok(design)
}

/// Values of a study, both cams, and the valvetrain without speed.
struct Chain<'a> {
    values: &'a Values,
    design: Design,
    cams: [Cam; 2],
    curves: [Curve; 2],
}

/// Play, speed and factors of K, D and the clearances of a run.
#[derive(Clone, Copy, Debug)]
struct Case {
    speed: f64,
    factors: [f64; 3],
    tolerance: f64,
}

/// The law itself, if the valve is closed and at rest at 180°, where all runs begin.
fn closed_half_a_turn_from_its_origin(law: Lift) -> Result<Lift, StudyError> {
    /// Shares of the largest magnitudes.
    const CLOSED: f64 = 1e-3;
    let turn = (0..720).map(|k| law.jet::<f64>(f64::from(k).to_radians() / 2.0));
    let most = turn.fold([0.0_f64; 2], |most, jet| [0, 1].map(|order| most[order].max(jet[order].abs())));
    let start = law.jet::<f64>(-PI);
    if (0..2).all(|order| start[order].abs() <= CLOSED * most[order]) {
        return Ok(law);
    }
    let message = format!(
        "the law opens the valve by {:.3} mm at 180°, where the motion begins\nhelp: shift the law: let it rise from 0°, or have full lift there",
        1e3 * start[0]
    );
    Err(StudyError(message))
}

fn failed(error: impl core::fmt::Display) -> StudyError {
    StudyError(error.to_string())
}

impl<'a> Chain<'a> {
    fn of(values: &'a Values) -> Result<Self, StudyError> {
        let direction = match values.get("sense") {
            sense if sense > 0.0 => Direction::CounterClockwise,
            _ => Direction::Clockwise,
        };
        let law = match &values.law {
            Some(law) => closed_half_a_turn_from_its_origin(law.clone())?,
            None => Design::law(values.get("lift"), values.get("duration")).map_err(failed)?,
        };
        let play = values.get("open_play") + values.get("close_play");
        let lift =
            (0..360).map(|degrees| law.jet::<f64>(f64::from(degrees).to_radians())[0]).fold(0.0, f64::max);
        // Steps of the chain double it.
        if 2.0 * play >= lift {
            return Err(StudyError(format!(
                "`open_play` and `close_play` are {:.3} mm together, half of the lift of {:.3} mm or more\n\
                 help: lengths without a unit are in m; write `--param open_play=0.05mm`",
                1e3 * play,
                1e3 * lift
            )));
        }
        let design = design(values, law, direction)?;
        let cams = design.cams().map_err(failed)?;
        let mut curves = design.curves().map_err(failed)?;
        match values.get("points") {
            0.0 => {}
            points if points >= 16.0 => curves = tables(&curves, points as u32)?,
            _ => {
                return Err(StudyError(
                    "`points` is 0 or at least 16\nhelp: 0 takes the pitch curves in closed form".to_string(),
                ));
            }
        }
        Ok(Chain { values, design, cams, curves })
    }

    /// The valvetrain of a case on these pitch curves.
    fn valvetrain(&self, pitch: &[Curve; 2], case: &Case) -> Valvetrain {
        let value = |name| self.values.get(name);
        let [hardness, damping, play] = case.factors;
        let mut valvetrain: Valvetrain = self.design.moved_by(pitch.clone()).scene();
        valvetrain.speed = case.speed;
        valvetrain.open_play = play * value("open_play");
        valvetrain.close_play = play * value("close_play");
        valvetrain.stiffness = hardness * value("stiffness");
        valvetrain.damping = damping * value("damping");
        valvetrain.valve_mass = value("valve_mass");
        valvetrain.opener_inertia = value("opener_inertia");
        valvetrain.closer_inertia = value("closer_inertia");
        // The text counts it clockwise, which closes the valve where the fork is on the left of the pivot.
        let closer = &self.design.closer;
        valvetrain.preload = (closer.pivot[0] - closer.valve_pad[0]).signum() * value("preload");
        valvetrain.winding = value("winding");
        valvetrain.drag = value("drag");
        valvetrain.dry = value("dry");
        valvetrain.swing = value("swing");
        valvetrain.order = value("order");
        valvetrain
    }

    /// The valvetrain of a case with a valve spring in place of the closing cam.
    fn ordinary(&self, case: &Case) -> Ordinary {
        let value = |name| self.values.get(name);
        let mut valvetrain: Ordinary = self.design.moved_by(self.curves.clone()).scene();
        let [hardness, damping, play] = case.factors;
        valvetrain.speed = case.speed;
        valvetrain.open_play = play * value("open_play");
        valvetrain.stiffness = hardness * value("stiffness");
        valvetrain.damping = damping * value("damping");
        valvetrain.valve_mass = value("valve_mass");
        valvetrain.opener_inertia = value("opener_inertia");
        valvetrain.drag = value("drag");
        valvetrain.dry = value("dry");
        valvetrain.valve_spring = value("spring");
        valvetrain.valve_preload = value("spring_preload");
        valvetrain
    }

    /// Turns from rest of all runs.
    fn turns(&self) -> u32 {
        (self.values.get("turns") as u32).max(1)
    }

    /// The last turn of a case.
    fn turn(&self, case: &Case) -> Result<Turn, StudyError> {
        self.turn_on(&self.curves, case)
    }

    fn turn_on(&self, curves: &[Curve; 2], case: &Case) -> Result<Turn, StudyError> {
        Turn::of(&self.valvetrain(curves, case), self.turns(), SAMPLES, case.tolerance).map_err(failed)
    }
}

/// Cam angles of a turn that are shown.
const SAMPLES: u32 = 1440;

/// Tolerance of the runs that are shown; the study of accuracy says what it is worth.
const TOLERANCE: f64 = 1e-10;

/// The case of the values at this speed, with play or without.
fn case(speed: f64, has_play: bool) -> Case {
    Case { speed, factors: [1.0, 1.0, if has_play { 1.0 } else { 0.0 }], tolerance: TOLERANCE }
}

fn tables([opening, shutting]: &[Curve; 2], points: u32) -> Result<[Curve; 2], StudyError> {
    Ok([opening.table(points).map_err(failed)?, shutting.table(points).map_err(failed)?])
}

fn study(values: &Values, say: &mut dyn FnMut(&str)) -> Result<Report, StudyError> {
    let chain = Chain::of(values)?;
    say("synthesis");
    let (synthesis, undercut) = chain::synthesis(&chain)?;
    let mut sections = vec![synthesis];
    say("kinematic check");
    sections.push(chain::kinematics(&chain)?);
    let mut sentence = String::new();
    for speed in [values.get("slow"), values.get("speed")] {
        say(&format!("motion at {:.0} 1/min", speed * 30.0 / PI));
        let (section, said) = chain::dynamics(&chain, speed)?;
        sections.push(section);
        sentence = said + &undercut;
    }
    say("valve spring");
    sections.push(chain::spring(&chain)?);
    say("sensitivity");
    sections.push(chain::sensitivity(&chain)?);
    say("envelope");
    sections.push(chain::envelope(&chain)?);
    say("accuracy");
    sections.push(chain::accuracy(&chain)?);
    Ok(Report { title: "Desmodromic valvetrain of rigid bodies".to_string(), sentence, sections })
}

//! From a lift law and the places of pivots and pads to both cams, and to the mechanism that they move.

use core::f64::consts::TAU;

use mbs_runtime::driver::FitError;
use mbs_runtime::{Function, Interval};
use mbs_workbench::cams::CamError;
use mbs_workbench::cams::follower::{Cam, Direction, Follower};
use mbs_workbench::cams::lift::Lift;
use mbs_workbench::cams::pitch::Pitch;
use mbs_workbench::tables::{Spline, SplineKind};

use super::{Desmo, Kinematic};

/// Polar radius of a pitch curve of a desmodromic pair.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// In closed form.
    Exact(Pitch<3>),
    /// Periodic quintic spline through a table.
    Table(Spline),
}

impl Curve {
    /// The spline through this curve at `points` equal angles of a turn.
    ///
    /// # Errors
    /// Those of [`Spline::fit`].
    pub fn table(&self, points: u32) -> Result<Self, FitError> {
        let angles: Vec<f64> = (0..points).map(|k| TAU * f64::from(k) / f64::from(points)).collect();
        let radii: Vec<f64> = angles.iter().map(|angle| self.jet::<1>(*angle)[0]).collect();
        Spline::fit(&angles, &radii, SplineKind::PeriodicQuintic(TAU), None).map(Curve::Table)
    }
}

impl Function<f64> for Curve {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        match self {
            Curve::Exact(pitch) => pitch.jet(x),
            Curve::Table(spline) => spline.jet(x),
        }
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        match self {
            Curve::Exact(pitch) => pitch.breakpoint_after(x),
            Curve::Table(_) => None,
        }
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        match self {
            Curve::Exact(pitch) => pitch.enclosure(from, to),
            Curve::Table(spline) => spline.enclosure(from, to),
        }
    }
}

/// A rocker between a cam and the valve: places at lift 0 in the fixed frame (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rocker {
    /// Pivot.
    pub pivot: [f64; 2],
    /// Centre of the pad on the cam.
    pub cam_pad: [f64; 2],
    /// Radius of that pad.
    pub radius: f64,
    /// Centre of the pad on the valve's end.
    pub valve_pad: [f64; 2],
}

/// Data that both cams are made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Lift of the valve over the cam angle.
    pub law: Lift,
    /// Sense of rotation of both cams.
    pub direction: Direction,
    /// Centre of both cams.
    pub centre: [f64; 2],
    /// Finger that opens.
    pub opener: Rocker,
    /// Bell crank that closes.
    pub closer: Rocker,
}

fn apart(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}

impl Design {
    /// The pair of the catalogue, for any law and sense. A finger runs on a base circle of 12 mm, a bell crank with an arm of 29 mm on a
    /// cam of 17 mm.
    pub fn ready(law: Lift, direction: Direction) -> Self {
        const ARM: f64 = 0.029;
        let centre = [0.012, 0.020];
        let opener = Rocker {
            pivot: [0.031, 0.001],
            cam_pad: [0.013, -0.00398],
            radius: 0.012,
            valve_pad: [0.0, 0.008],
        };
        // The pad is as far from the cam's centre as from the pivot, on the right of the line between them.
        let pivot = [0.035, -0.009];
        let [x, y] = apart(pivot, centre);
        let angle = y.atan2(x) - (0.5 * x.hypot(y) / ARM).acos();
        let closer = Rocker {
            pivot,
            cam_pad: [pivot[0] + ARM * angle.cos(), pivot[1] + ARM * angle.sin()],
            radius: 0.012,
            valve_pad: [0.0, -0.012],
        };
        Design { law, direction, centre, opener, closer }
    }

    /// Law of the catalogue: 11 mm within 160°, the polynomial 2-6-8-10-12.
    ///
    /// # Errors
    /// Those of [`Lift::hump`] for another height (m) or duration (rad).
    pub fn law(height: f64, duration: f64) -> Result<Lift, CamError> {
        Lift::hump(&[2, 6, 8, 10, 12], height, duration)
    }

    /// The opening and the closing cam.
    ///
    /// # Errors
    /// Those of [`Cam::new`].
    pub fn cams(&self) -> Result<[Cam; 2], CamError> {
        let cam = |rocker: &Rocker| {
            let follower = Follower::Rocker {
                pivot: apart(self.centre, rocker.pivot),
                cam_pad: apart(self.centre, rocker.cam_pad),
                radius: rocker.radius,
                valve_pad: apart(self.centre, rocker.valve_pad),
            };
            Cam::new(self.law.clone(), follower, self.direction)
        };
        Ok([cam(&self.opener)?, cam(&self.closer)?])
    }

    /// The mechanism with the pitch curves of both cams in closed form; `scene()` carries it to other scenes.
    ///
    /// # Errors
    /// Those of [`Cam::new`] and [`Pitch::new`].
    pub fn mechanism(&self) -> Result<Desmo<Curve, f64, Kinematic>, CamError> {
        Ok(self.moved_by(self.curves()?))
    }

    /// The pitch curves of both cams in closed form.
    ///
    /// # Errors
    /// Those of [`Cam::new`] and [`Pitch::new`].
    pub fn curves(&self) -> Result<[Curve; 2], CamError> {
        let [opening, closing] = self.cams()?;
        Ok([Curve::Exact(Pitch::new(&opening)?), Curve::Exact(Pitch::new(&closing)?)])
    }

    /// The mechanism on other pitch curves, as tables of them.
    pub fn moved_by<F: Function<f64>>(&self, pitch: [F; 2]) -> Desmo<F, f64, Kinematic> {
        let arms = |rocker: &Rocker| {
            (rocker.pivot, apart(rocker.pivot, rocker.cam_pad), apart(rocker.pivot, rocker.valve_pad))
        };
        let (opener_pivot, opener_cam, opener_valve) = arms(&self.opener);
        let (closer_pivot, closer_cam, closer_valve) = arms(&self.closer);
        Desmo {
            centre: self.centre,
            opener_pivot,
            opener_cam,
            opener_valve,
            closer_pivot,
            closer_cam,
            closer_valve,
            sense: self.direction.sign(),
            ..Desmo::new(pitch)
        }
    }
}

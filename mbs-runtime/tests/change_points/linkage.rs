//! Two linkages that fold flat, each in angles and in natural coordinates, with the assembly known in closed form.

use mbs_runtime::{Failure, Signal, Stepper, mechanism};

mechanism! {
    /// A four-bar whose crank angle is measured, in angles.
    pub mechanism InAngles;
    param crank: m = 1;
    param coupler: m = 2;
    param rocker: m = 1;
    param ground: m = 2;
    input theta: rad, rates;
    coord phi: rad;
    coord psi: rad = 0;
    coord chi: rad = 0;
    constraint closure { crank*unit(phi) + coupler*unit(psi) == [ground, 0] + rocker*unit(chi); }
    drive encoder: phi == theta;
}

mechanism! {
    /// The same four-bar in natural coordinates: the points between the links.
    pub mechanism InPoints;
    param crank: m = 1;
    param coupler: m = 2;
    param rocker: m = 1;
    param ground: m = 2;
    input theta: rad, rates;
    coord a: [m; 2] = [1, 0];
    coord b: [m; 2] = [3, 0];
    let rod = b - a;
    let swing = b - [ground, 0];
    constraint distances {
        dot(a, a) == crank^2;
        dot(rod, rod) == coupler^2;
        dot(swing, swing) == rocker^2;
    }
    drive encoder: cross(unit(theta), a) == 0;
}

/// Lengths of a linkage and where it folds flat.
#[derive(Clone, Copy, Debug)]
pub struct Linkage {
    pub name: &'static str,
    pub crank: f64,
    pub coupler: f64,
    pub rocker: f64,
    pub ground: f64,
    /// Crank angle (rad) of the change point.
    pub centre: f64,
}

pub const PARALLELOGRAM: Linkage =
    Linkage { name: "1/2/1/2", crank: 1.0, coupler: 2.0, rocker: 1.0, ground: 2.0, centre: 0.0 };

pub const STRETCHED: Linkage = Linkage {
    name: "1/2.5/2/3.5",
    crank: 1.0,
    coupler: 2.5,
    rocker: 2.0,
    ground: 3.5,
    centre: core::f64::consts::PI,
};

impl Linkage {
    /// The point between coupler and rocker at crank angle `theta` (rad) on one of the two smooth paths through the
    /// change point, `side` 1 or −1.
    ///
    /// From the triangle of crank tip, ground joint and that point; the height over the diagonal is that of Heron's
    /// formula and changes its sign with the crank angle.
    pub fn point(&self, theta: f64, side: f64) -> [f64; 2] {
        let tip = [self.crank * theta.cos(), self.crank * theta.sin()];
        let away = [self.ground - tip[0], -tip[1]];
        let diagonal = away[0].hypot(away[1]);
        let along = (self.coupler.powi(2) - self.rocker.powi(2) + diagonal.powi(2)) / (2.0 * diagonal);
        let (sum, excess) = (self.coupler + self.rocker, self.coupler - self.rocker);
        // How far the diagonal is from the length that it has in line, by the half angle: without loss.
        let in_line = self.ground - self.crank * self.centre.cos();
        let half = ((theta - self.centre) / 2.0).sin();
        let gap = 4.0 * self.ground * self.crank * half * half / (diagonal + in_line);
        let others = match in_line < sum {
            true => (sum + diagonal) * (sum - diagonal) * (diagonal + excess),
            false => (sum + diagonal) * (diagonal - excess) * (diagonal + excess),
        };
        let height = (gap * others).sqrt() / (2.0 * diagonal);
        let signed = side * height * (theta - self.centre).sin().signum();
        let unit = away.map(|component| component / diagonal);
        [tip[0] + along * unit[0] - signed * unit[1], tip[1] + along * unit[1] + signed * unit[0]]
    }

    /// The distance (m) between the two assemblies at crank angle `theta` (rad).
    pub fn separation(&self, theta: f64) -> f64 {
        distance(self.point(theta, 1.0), self.point(theta, -1.0))
    }
}

/// Distance of two points (m).
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A linkage in motion, whatever its coordinates.
pub trait Moving {
    /// The linkage assembled at crank angle `theta` (rad) on the path `side`, at time 0.
    fn assembled(linkage: &Linkage, theta: f64, side: f64) -> Self;
    /// The measured crank, then time `t` (s).
    fn follow(&mut self, theta: Signal<f64>, t: f64) -> Result<(), Failure>;
    /// The point between coupler and rocker (m).
    fn point(&self) -> [f64; 2];
    /// Number of singular positions passed.
    fn passages(&self) -> u32;
    /// All that the stepper shows, bit for bit.
    fn bits(&self) -> Vec<u64>;
}

macro_rules! moving {
    ($mechanism:ident, $size:literal, |$linkage:ident, $tip:ident, $point:ident| $guess:expr, |$q:ident, $design:ident| $of:expr) => {
        impl Moving for Stepper<$mechanism, f64, $size> {
            fn assembled($linkage: &Linkage, theta: f64, side: f64) -> Self {
                let design = $mechanism {
                    crank: $linkage.crank,
                    coupler: $linkage.coupler,
                    rocker: $linkage.rocker,
                    ground: $linkage.ground,
                    theta: Signal { value: theta, rate: -1.0, acceleration: 0.0 },
                };
                let $tip = [$linkage.crank * theta.cos(), $linkage.crank * theta.sin()];
                let $point = $linkage.point(theta, side);
                Stepper::assemble(design, $guess(theta), 0.0).expect("a regular position")
            }
            fn follow(&mut self, theta: Signal<f64>, t: f64) -> Result<(), Failure> {
                self.change(|mechanism| mechanism.theta = theta);
                self.advance_to(t).map(|_| ())
            }
            fn point(&self) -> [f64; 2] {
                let ($q, $design) = (self.q(), self.mechanism());
                $of
            }
            fn passages(&self) -> u32 {
                Stepper::passages(self)
            }
            fn bits(&self) -> Vec<u64> {
                let values = self.q().iter().chain(self.qd()).chain(self.qdd());
                let others = [self.t(), self.margin()];
                values
                    .chain(&others)
                    .map(|value| value.to_bits())
                    .chain([u64::from(self.passages())])
                    .collect()
            }
        }
    };
}

moving!(
    InAngles,
    3,
    |linkage, tip, point| |theta: f64| {
        let along = |from: [f64; 2]| (point[1] - from[1]).atan2(point[0] - from[0]);
        [theta, along(tip), along([linkage.ground, 0.0])]
    },
    |q, design| {
        [
            design.crank * q[0].cos() + design.coupler * q[1].cos(),
            design.crank * q[0].sin() + design.coupler * q[1].sin(),
        ]
    }
);
moving!(InPoints, 4, |_linkage, tip, point| |_: f64| [tip[0], tip[1], point[0], point[1]], |q, _design| [
    q[2], q[3]
]);

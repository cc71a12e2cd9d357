//! Four-bars that fold flat, and one that does not: their assemblies in closed form.

pub mod follow;
// Some texts are of the second tier alone.
#[cfg_attr(not(feature = "long"), allow(dead_code))]
pub mod texts;

use core::f64::consts::PI;

/// Lengths of a linkage and its change points.
#[derive(Clone, Copy, Debug)]
pub struct Linkage {
    pub name: &'static str,
    pub crank: f64,
    pub coupler: f64,
    pub rocker: f64,
    pub ground: f64,
    /// Crank angles (rad) of the change points.
    pub centres: &'static [f64],
}

pub const PARALLELOGRAM: Linkage =
    Linkage { name: "1/2/1/2", crank: 1.0, coupler: 2.0, rocker: 1.0, ground: 2.0, centres: &[0.0, PI] };
pub const STRETCHED: Linkage =
    Linkage { name: "1/2.5/2/3.5", crank: 1.0, coupler: 2.5, rocker: 2.0, ground: 3.5, centres: &[PI] };
pub const SLENDER: Linkage =
    Linkage { name: "0.3/1/0.3/1", crank: 0.3, coupler: 1.0, rocker: 0.3, ground: 1.0, centres: &[0.0, PI] };
/// A drag link, which never folds flat.
pub const DRAG_LINK: Linkage = Linkage {
    name: "275/280/250/100",
    crank: 0.275,
    coupler: 0.280,
    rocker: 0.250,
    ground: 0.100,
    centres: &[],
};

pub const LINKAGES: [Linkage; 4] = [PARALLELOGRAM, STRETCHED, SLENDER, DRAG_LINK];

/// A parallelogram with cranks of `length` on rods of 1 m.
pub fn parallelogram(length: f64) -> Linkage {
    Linkage {
        name: "short/1/short/1",
        crank: length,
        rocker: length,
        coupler: 1.0,
        ground: 1.0,
        centres: &[0.0, PI],
    }
}

/// A crank of `length` that stretches two rods of 1 m once a turn.
pub fn stretched(length: f64) -> Linkage {
    Linkage {
        name: "short/1/1/2 - short",
        crank: length,
        rocker: 1.0,
        coupler: 1.0,
        ground: 2.0 - length,
        centres: &[PI],
    }
}

impl Linkage {
    /// Tip of the crank at angle `theta` (rad).
    pub fn tip(&self, theta: f64) -> [f64; 2] {
        [self.crank * theta.cos(), self.crank * theta.sin()]
    }

    /// Vector from the tip to the ground joint, and its length.
    fn diagonal(&self, theta: f64) -> ([f64; 2], f64) {
        let tip = self.tip(theta);
        let away = [self.ground - tip[0], -tip[1]];
        (away, away[0].hypot(away[1]))
    }

    /// Twice the area of the triangle of tip, ground joint and the point between them, by Heron's formula; the factor that is
    /// small next to a change point is taken from the half angle, without loss.
    fn double_area(&self, theta: f64) -> f64 {
        let (_, diagonal) = self.diagonal(theta);
        let (sum, excess) = (self.coupler + self.rocker, self.coupler - self.rocker);
        let mut factors = [sum + diagonal, sum - diagonal, diagonal + excess, diagonal - excess];
        for centre in self.centres {
            let in_line = (self.ground - self.crank * centre.cos()).abs();
            let half = ((theta - centre) / 2.0).sin();
            let change = 4.0 * self.ground * self.crank * half * half * centre.cos() / (diagonal + in_line);
            if (in_line - sum).abs() < 1e-12 {
                factors[1] = -change;
            } else if (in_line - excess.abs()).abs() < 1e-12 {
                factors[if excess < 0.0 { 2 } else { 3 }] = change;
            }
        }
        factors.iter().product::<f64>().max(0.0).sqrt() / 2.0
    }

    /// The sign that the area has on the smooth path through the change points, `side` at angles just above the first one.
    fn sign(&self, theta: f64) -> f64 {
        match self.centres {
            [] => 1.0,
            [centre] => ((theta - centre) / 2.0).sin().signum(),
            _ => theta.sin().signum(),
        }
    }

    /// The point between coupler and rocker at crank angle `theta` (rad, whole turns count) on the smooth path `side`, 1 or −1.
    pub fn point(&self, theta: f64, side: f64) -> [f64; 2] {
        let tip = self.tip(theta);
        let (away, diagonal) = self.diagonal(theta);
        let along = (self.coupler.powi(2) - self.rocker.powi(2) + diagonal.powi(2)) / (2.0 * diagonal);
        let height = side * self.sign(theta) * self.double_area(theta) / diagonal;
        let unit = away.map(|component| component / diagonal);
        [tip[0] + along * unit[0] - height * unit[1], tip[1] + along * unit[1] + height * unit[0]]
    }

    /// Margin to singularity of coupler and rocker in the reference metric, 2 |det| over the sum of squares.
    pub fn margin(&self, theta: f64) -> f64 {
        2.0 * self.double_area(theta) / (self.coupler.powi(2) + self.rocker.powi(2))
    }
}

/// Distance of two points (m).
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn the_closed_form_closes_and_is_smooth_through_change_points() {
    for linkage in LINKAGES {
        for side in [1.0, -1.0] {
            let mut last: Option<[f64; 2]> = None;
            for k in -4000..4000 {
                let theta = f64::from(k) * 3.3e-3 + 1e-4;
                let point = linkage.point(theta, side);
                let bars = [distance(point, linkage.tip(theta)), distance(point, [linkage.ground, 0.0])];
                assert!((bars[0] - linkage.coupler).abs() + (bars[1] - linkage.rocker).abs() < 1e-9);
                assert!(last.is_none_or(|last| distance(last, point) < 0.05), "{} {theta}", linkage.name);
                last = Some(point);
            }
        }
    }
}

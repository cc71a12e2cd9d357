//! Attribution of forces and rows to bodies: a point that moves with a body, an angle that turns with it.
//!
//! Found by equal motion at a few positions, not by how it is written: virtual displacements alone count.

use crate::equations::acting_bodies::RowMotion;
use crate::equations::jacobian;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::sample_points;
use crate::symbolic::{Graph, Leaf, NodeId};

/// Positions that are tried; a function that is not finite at one of them is not judged there.
const TRIED: usize = 12;
/// Number of positions that must agree.
const AGREEING: usize = 3;
/// Largest difference of equal values, relative to their size: rounding of a few hundred operations.
const SAME: f64 = 1e-9;

/// Scalar functions of the position with their slopes, at a few positions.
pub struct Slopes {
    /// Value of each function and its slopes along the coordinates, position by position.
    samples: Vec<Vec<(f64, Vec<f64>)>>,
}

/// A plane body by the indices of its functions.
#[derive(Clone, Copy, Debug)]
pub struct PlaneBody {
    /// Both components of its centre of mass.
    pub centre: [usize; 2],
    /// Its angle; a point mass has none.
    pub angle: Option<usize>,
}

impl Slopes {
    /// Before: functions of the position. After: their slopes along `count` coordinates at positions that are the same in
    /// every build.
    pub fn of(g: &mut Graph, functions: &[NodeId], count: usize) -> Self {
        let rows = jacobian(g, functions, count, Leaf::Position);
        let entries = rows.iter().flatten().map(|(_, entry)| *entry);
        let roots: Vec<NodeId> = functions.iter().copied().chain(entries).collect();
        let sample = |trial: usize| {
            let values = evaluate(g, &roots, |leaf| scattered(leaf, trial));
            let mut slopes = values.iter().skip(functions.len());
            let mut sample = Vec::new();
            for (value, row) in values.iter().zip(&rows) {
                let mut dense = vec![0.0; count];
                for (column, _) in row {
                    if let (Some(slot), Some(slope)) = (dense.get_mut(*column), slopes.next()) {
                        *slot = *slope;
                    }
                }
                sample.push((*value, dense));
            }
            sample
        };
        Slopes { samples: (0..TRIED).map(sample).collect() }
    }

    /// `true` if a function depends on no coordinate.
    pub fn is_fixed(&self, function: usize) -> bool {
        self.hold(|sample, column| Some((slope(sample, function, column)?, 0.0)))
    }

    /// `true` if no coordinate moves a point.
    pub fn is_fixed_point(&self, point: [usize; 2]) -> bool {
        point.iter().all(|component| self.is_fixed(*component))
    }

    /// `true` if a point moves with a body.
    pub fn carries(&self, body: &PlaneBody, point: [usize; 2]) -> bool {
        [0, 1]
            .into_iter()
            .all(|component| self.hold(|sample, column| carried(sample, column, point, body, component)))
    }

    /// Body motion that a scalar function measures, for bodies that are joined in pairs.
    pub fn motion_of(
        &self,
        function: usize,
        bodies: &[PlaneBody],
        joined: &[[Option<usize>; 2]],
    ) -> Option<RowMotion> {
        let alone = (0..bodies.len()).map(|body| (body, None));
        let pairs = joined.iter().filter_map(|[a, b]| Some(((*a)?, Some((*b)?))));
        let angle = alone.chain(pairs).flat_map(|pair| [(pair, 1.0), (pair, -1.0)]).find(|(pair, sign)| {
            let turn = |sample: &Sample, body: usize, column| slope(sample, bodies.get(body)?.angle?, column);
            self.hold(|sample, column| {
                let back = pair.1.map_or(Some(0.0), |against| turn(sample, against, column))?;
                Some((slope(sample, function, column)?, sign * (turn(sample, pair.0, column)? - back)))
            })
        });
        if let Some(((body, against), sign)) = angle {
            return Some(RowMotion::Angle { body, against, sign });
        }
        let components = (0..bodies.len()).flat_map(|body| [(body, 0), (body, 1)]);
        let found = components.flat_map(|place| [(place, 1.0), (place, -1.0)]).find(|(place, sign)| {
            self.hold(|sample, column| {
                let centre = *bodies.get(place.0)?.centre.get(place.1)?;
                Some((slope(sample, function, column)?, sign * slope(sample, centre, column)?))
            })
        });
        found.map(|((body, component), sign)| RowMotion::Component { body, component, sign })
    }

    /// `true` if two slopes are equal at all positions where both are finite, and if these are enough.
    fn hold(&self, slopes: impl Fn(&Sample, usize) -> Option<(f64, f64)>) -> bool {
        let mut agreeing = 0;
        for sample in &self.samples {
            let columns = sample.first().map_or(0, |(_, slopes)| slopes.len());
            let mut known = true;
            for column in 0..columns {
                let Some((a, b)) = slopes(sample, column) else { return false };
                let difference = (a - b).abs();
                if difference > SAME * (1.0 + a.abs() + b.abs()) {
                    return false;
                }
                known &= difference.is_finite();
            }
            agreeing += usize::from(known);
        }
        agreeing >= AGREEING
    }
}

/// Value and slopes of each function.
type Sample = Vec<(f64, Vec<f64>)>;

fn slope(sample: &Sample, function: usize, column: usize) -> Option<f64> {
    sample.get(function)?.1.get(column).copied()
}

/// Slope of a point's component, and that of the body's point there: that of its centre, and the arm turned.
fn carried(
    sample: &Sample,
    column: usize,
    point: [usize; 2],
    body: &PlaneBody,
    component: usize,
) -> Option<(f64, f64)> {
    let value = |function: usize| sample.get(function).map(|(value, _)| *value);
    let (own, centre) = (*point.get(component)?, *body.centre.get(component)?);
    let (other, other_centre) = (*point.get(1 - component)?, *body.centre.get(1 - component)?);
    let turn = match body.angle {
        Some(angle) => slope(sample, angle, column)?,
        None => 0.0,
    };
    let arm = value(other)? - value(other_centre)?;
    let turned = if component == 0 { -arm } else { arm };
    Some((slope(sample, own, column)?, slope(sample, centre, column)? + turn * turned))
}

/// A value of a leaf, scattered but the same in every build; lengths and masses are positive.
pub fn scattered(leaf: Leaf, trial: usize) -> f64 {
    0.2 + sample_points::scattered(leaf, trial)
}

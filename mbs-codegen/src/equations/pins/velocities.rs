//! Velocities of points and bodies at positions that fulfil the rows, in every motion that some of the rows allow.

use super::attribution::scattered;
use super::manifold::{Manifold, Orthogonal, Point, dot};
use super::{Given, frame};
use crate::equations::jacobian;
use crate::model::Model;
use crate::model::dynamics::Dynamics as Declared;
use crate::model::expression::Id;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::{Graph, Leaf, NodeId};

/// Positions that are evaluated: at one of them a point of another place may fit by chance, at all of them never.
const POINTS: usize = 3;
/// Starts of the search for them.
const TRIED: usize = 12;
/// Most multiplications of all searches, tenths of a second of a debug build, and of a single one.
const WORK: usize = 10_000_000;
const MOST_WORK: usize = 1_000_000_000;
/// Largest part of a velocity that counts as rounding, relative to the terms of its difference.
const SAME: f64 = 1e-6;
/// Range of starts about the guess (rad, m) and about the parameters' defaults, relative to them: twice the largest distance.
/// Middle of the scattered values.
const NEAR: f64 = 0.2;
const MIDDLE: f64 = 0.7;

/// Result at a few positions.
pub enum Seen<R> {
    Somewhere(R),
    /// No position is found at which all rows hold.
    Nowhere,
    /// The search takes too long.
    TooLong,
}

/// Functions of the position whose slopes give the velocities of points.
pub struct Motions<'a> {
    model: &'a Model,
    guesses: &'a [NodeId],
    manifold: Manifold,
    /// Values, then slopes along the coordinates: of both components of the points, of centres and angles, of rows.
    roots: Vec<NodeId>,
    /// Function and coordinate of each slope.
    places: Vec<(usize, usize)>,
    coordinates: usize,
    /// Centres and angles by function, body by body.
    bodies: Vec<([usize; 2], Option<usize>)>,
    /// Rows that decide about motions, by function.
    rows: Vec<usize>,
    functions: usize,
}

impl<'a> Motions<'a> {
    /// Before: points of the plane. After: the functions for the motion of these and of the bodies where the rows
    /// that `decide` hold.
    pub fn of(
        g: &mut Graph,
        (model, declared): (&'a Model, &Declared),
        given: Given<'a>,
        points: &[[NodeId; 2]],
        decide: impl Fn(usize) -> bool,
    ) -> Self {
        let residuals: Vec<NodeId> = given.rows.iter().map(|row| row.phi).collect();
        let manifold = Manifold::of(g, &residuals);
        let zero = g.constant(0.0);
        let of = |id: Id| given.nodes.get(id.index()).copied().unwrap_or(zero);
        let mut functions: Vec<NodeId> = points.as_flattened().to_vec();
        let mut add = |node: NodeId| {
            functions.push(node);
            functions.len() - 1
        };
        let frames = declared.bodies.iter().map(|body| frame(body, of, zero));
        let bodies = frames.map(|(centre, angle)| (centre.map(&mut add), angle.map(&mut add))).collect();
        let rows = residuals.iter().enumerate().filter(|(index, _)| decide(*index));
        let rows = rows.map(|(_, phi)| add(*phi)).collect();
        let coordinates = given.guesses.len();
        let slopes = jacobian(g, &functions, coordinates, Leaf::Position);
        let count = functions.len();
        let (mut roots, mut places) = (functions, Vec::new());
        for (function, slopes) in slopes.into_iter().enumerate() {
            for (coordinate, slope) in slopes {
                roots.push(slope);
                places.push((function, coordinate));
            }
        }
        let guesses = given.guesses;
        Motions { model, guesses, manifold, roots, places, coordinates, bodies, rows, functions: count }
    }

    /// Evaluates `see` at up to `POINTS` positions and joins the results; `None` from `see` means a value that is not finite.
    pub fn seen<R>(
        &self,
        g: &Graph,
        see: impl Fn(&Here<'_>) -> Option<R>,
        join: impl Fn(R, R) -> R,
    ) -> Seen<R> {
        let one = self.manifold.work().max(1);
        if one > MOST_WORK {
            return Seen::TooLong;
        }
        let (mut all, mut points) = (Seen::Nowhere, 0);
        for trial in 0..(WORK / one).clamp(POINTS, TRIED) {
            let Some(point) = self.manifold.point(g, |leaf| self.start(g, leaf, trial)) else { continue };
            let Some(seen) = self.at(g, &point, trial, &see) else { continue };
            all = Seen::Somewhere(match all {
                Seen::Somewhere(known) => join(known, seen),
                Seen::Nowhere | Seen::TooLong => seen,
            });
            points += 1;
            if points == POINTS {
                break;
            }
        }
        all
    }

    /// Start of a search: near the guess and the parameters' defaults, every other time anywhere.
    fn start(&self, g: &Graph, leaf: Leaf, trial: usize) -> f64 {
        let anywhere = scattered(leaf, trial);
        let off = NEAR * (anywhere - MIDDLE);
        match leaf {
            _ if trial % 2 == 1 => anywhere,
            Leaf::Parameter(index) => {
                let default = self.model.variables.get(index as usize).map_or(1.0, |known| known.default);
                if default == 0.0 { off } else { default * (1.0 + off) }
            }
            Leaf::Position(index) => {
                let Some(guess) = self.guesses.get(index as usize) else { return anywhere };
                let guess = evaluate(g, &[*guess], |leaf| match leaf {
                    Leaf::Position(_) => f64::NAN,
                    other => self.start(g, other, trial),
                });
                guess.first().map_or(anywhere, |guess| guess + off)
            }
            _ => anywhere,
        }
    }

    fn at<R>(
        &self,
        g: &Graph,
        point: &Point,
        trial: usize,
        see: impl Fn(&Here<'_>) -> Option<R>,
    ) -> Option<R> {
        let values = evaluate(g, &self.roots, |leaf| match point.get(&leaf) {
            Some(value) => *value,
            None => self.start(g, leaf, trial),
        });
        if !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        let mut slopes = vec![vec![0.0; self.coordinates]; self.functions];
        for ((function, coordinate), slope) in self.places.iter().zip(values.iter().skip(self.functions)) {
            *slopes.get_mut(*function)?.get_mut(*coordinate)? = *slope;
        }
        let mut rows = Orthogonal::default();
        for row in &self.rows {
            rows.add(slopes.get(*row)?.clone());
        }
        see(&Here { motions: self, values: &values, slopes: &slopes, rows: &rows })
    }
}

/// A position.
pub struct Here<'a> {
    motions: &'a Motions<'a>,
    values: &'a [f64],
    slopes: &'a [Vec<f64>],
    rows: &'a Orthogonal,
}

/// Velocity of a point.
pub struct Velocity {
    /// Slopes of both components.
    slopes: [Vec<f64>; 2],
    /// Squares of the terms that they are the sum of: sums that vanish have the rounding of their terms.
    squares: f64,
}

impl Here<'_> {
    /// `true` if the rows leave a motion.
    pub fn moves(&self) -> bool {
        self.rows.rank() < self.motions.coordinates
    }

    /// Velocity of a point as it is written.
    pub fn own(&self, point: usize) -> Option<Velocity> {
        let slopes = [self.slopes.get(2 * point)?.clone(), self.slopes.get(2 * point + 1)?.clone()];
        Some(Velocity { squares: squares(&slopes), slopes })
    }

    /// Velocity of the body's point that is where a point is: that of its centre, and the arm turned. No body is the ground.
    pub fn carried(&self, body: Option<usize>, point: usize) -> Option<Velocity> {
        let place = [2 * point, 2 * point + 1];
        let still = || vec![0.0; self.motions.coordinates];
        let Some(body) = body else { return Some(Velocity { slopes: [still(), still()], squares: 0.0 }) };
        let (centre, angle) = self.motions.bodies.get(body)?;
        let turn = match angle {
            Some(angle) => self.slopes.get(*angle)?.clone(),
            None => still(),
        };
        let arm = |component: usize| {
            Some(self.values.get(*place.get(component)?)? - self.values.get(*centre.get(component)?)?)
        };
        let (x, y) = (arm(0)?, arm(1)?);
        let centre = [self.slopes.get(centre[0])?, self.slopes.get(centre[1])?];
        let turned = |arm: f64| turn.iter().map(|turn| arm * turn).collect::<Vec<f64>>();
        let turned = [turned(-y), turned(x)];
        let squares = squares(&turned) + centre.iter().map(|slopes| dot(slopes, slopes)).sum::<f64>();
        let both = |(centre, turned): (&Vec<f64>, &Vec<f64>)| {
            centre.iter().zip(turned).map(|(centre, turned)| centre + turned).collect()
        };
        let [turned_x, turned_y] = &turned;
        let [centre_x, centre_y] = centre;
        let slopes = [both((centre_x, turned_x)), both((centre_y, turned_y))];
        Some(Velocity { slopes, squares })
    }

    /// `true` if two velocities are the same in every motion that the rows allow.
    pub fn same(&self, a: &Velocity, b: &Velocity) -> bool {
        let size = libm::sqrt(a.squares + b.squares);
        a.slopes.iter().zip(&b.slopes).all(|(a, b)| {
            let mut difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            self.rows.take_from(&mut difference);
            libm::sqrt(dot(&difference, &difference)) <= SAME * size
        })
    }
}

fn squares(slopes: &[Vec<f64>; 2]) -> f64 {
    slopes.iter().map(|slopes| dot(slopes, slopes)).sum()
}

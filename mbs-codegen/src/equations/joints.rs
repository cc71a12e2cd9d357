//! Whether pins stand where their bodies keep together: the points of both bodies there have one velocity in every motion
//! that the rows allow.
//!
//! Elsewhere a pin's force would do work, and the sums over the bodies have no solution. Drives and guides that act on
//! bodies by themselves are no help: their forces are among the sums.

use super::attribution::scattered;
use super::jacobian;
use super::manifold::{Manifold, Orthogonal, Point, dot};
use super::pins::{Attribution, Given, frame};
use crate::model::Model;
use crate::model::dynamics::{Dynamics as Declared, Pin};
use crate::model::expression::Id;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::{Graph, Leaf, NodeId};

/// Positions that are looked at: at one of them a pin of another place may fit by chance, never at all.
const POINTS: usize = 3;
/// Starts of the search for them.
const TRIED: usize = 12;
/// Multiplications that all searches may take, tenths of a second of a debug build, and that a single one may.
const WORK: usize = 10_000_000;
const MOST_WORK: usize = 1_000_000_000;
/// Largest part of a velocity, relative to what it is the difference of, that is rounding.
const SAME: f64 = 1e-6;

/// What is wrong with the place of a pin.
pub enum Misplaced {
    /// It does not stand on one of its bodies.
    Off {
        /// Its index.
        pin: usize,
        /// The body of the two that passes its point: 0 or 1.
        body: usize,
        /// Whether the point moves with the other.
        on_other: bool,
    },
    /// No position is found at which all rows hold, to look at it.
    Unseen,
}

/// Before: what acts on which body. After: the first pin at whose point its bodies move apart, seen at positions that fulfil
/// all rows.
///
/// What holds at a few scattered positions of a design without special numbers holds at all around.
pub fn misplaced(
    g: &mut Graph,
    (model, declared): (&Model, &Declared),
    given: Given<'_>,
    found: &Attribution,
) -> Option<Misplaced> {
    let residuals: Vec<NodeId> = given.rows.iter().map(|row| row.phi).collect();
    let manifold = Manifold::of(g, &residuals);
    let work = Work::new(g, (model, declared), given, found);
    let one = manifold.work().max(1);
    if one > MOST_WORK {
        return None;
    }
    let mut faults: Option<Vec<Option<Misplaced>>> = None;
    let mut points = 0;
    for trial in 0..(WORK / one).clamp(POINTS, TRIED) {
        let Some(point) = manifold.point(g, |leaf| work.start(g, leaf, trial)) else { continue };
        let Some(seen) = work.seen(g, &point, trial) else { continue };
        faults = Some(match faults {
            None => seen,
            Some(known) => known.into_iter().zip(seen).map(|(known, seen)| known.and(seen)).collect(),
        });
        points += 1;
        if points == POINTS {
            break;
        }
    }
    match faults {
        Some(faults) => faults.into_iter().flatten().next(),
        None => Some(Misplaced::Unseen),
    }
}

/// Functions of the position whose slopes say how points move.
struct Work<'a> {
    model: &'a Model,
    pins: &'a [Pin],
    guesses: &'a [NodeId],
    /// Values, then slopes along the coordinates: of the places of pins, of centres and angles, of rows.
    roots: Vec<NodeId>,
    /// Function and coordinate of each slope.
    places: Vec<(usize, usize)>,
    coordinates: usize,
    /// Centres and angles by function, body by body.
    bodies: Vec<([usize; 2], Option<usize>)>,
    /// Rows whose forces the pins bear, by function.
    rows: Vec<usize>,
    functions: usize,
}

impl<'a> Work<'a> {
    fn new(
        g: &mut Graph,
        (model, declared): (&'a Model, &'a Declared),
        given: Given<'a>,
        found: &Attribution,
    ) -> Self {
        let zero = g.constant(0.0);
        let of = |id: Id| given.nodes.get(id.index()).copied().unwrap_or(zero);
        let mut functions: Vec<NodeId> = Vec::new();
        let mut add = |node: NodeId| {
            functions.push(node);
            functions.len() - 1
        };
        for pin in &declared.pins {
            for component in [0, 1] {
                add(pin.at.get(component).map_or(zero, |id| of(*id)));
            }
        }
        let frames = declared.bodies.iter().map(|body| frame(body, of, zero));
        let bodies = frames.map(|(centre, angle)| (centre.map(&mut add), angle.map(&mut add))).collect();
        let apart = |row: &usize| found.rows.iter().all(|(known, _)| known != row);
        let rows = given.rows.iter().enumerate().filter(|(index, _)| apart(index));
        let rows = rows.map(|(_, row)| add(row.phi)).collect();
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
        let (pins, guesses) = (declared.pins.as_slice(), given.guesses);
        Work { model, pins, guesses, roots, places, coordinates, bodies, rows, functions: count }
    }

    /// Where a search starts: near the guess and the parameters' defaults, every other time anywhere.
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

    /// Of each pin whether it is misplaced at a position; `None` where something there is no number.
    fn seen(&self, g: &Graph, point: &Point, trial: usize) -> Option<Vec<Option<Misplaced>>> {
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
        let here = Here { work: self, values: &values, slopes: &slopes, rows: &rows };
        (0..self.pins.len()).map(|pin| here.pin(pin)).collect()
    }
}

/// How far a start lies from the guess (rad, m) and, in parts of themselves, from the parameters' defaults at most twice; the
/// middle of scattered values.
const NEAR: f64 = 0.2;
const MIDDLE: f64 = 0.7;

/// A position.
struct Here<'a> {
    work: &'a Work<'a>,
    values: &'a [f64],
    slopes: &'a [Vec<f64>],
    rows: &'a Orthogonal,
}

/// How a point moves.
struct Velocity {
    /// Slopes of both components.
    slopes: [Vec<f64>; 2],
    /// Squares of what they are the sum of: sums that vanish have the rounding of their terms.
    squares: f64,
}

impl Here<'_> {
    fn pin(&self, index: usize) -> Option<Option<Misplaced>> {
        let pin = self.work.pins.get(index)?;
        let place = [2 * index, 2 * index + 1];
        let [first, second] = pin.bodies;
        let (with_first, with_second) = (self.carried(first, place)?, self.carried(second, place)?);
        if self.same(&with_first, &with_second) {
            return Some(None);
        }
        let slopes = [self.slopes.get(place[0])?.clone(), self.slopes.get(place[1])?.clone()];
        let own = Velocity { squares: squares(&slopes), slopes };
        let on_first = self.same(&own, &with_first);
        // The ground carries nothing: where the point stands on neither, the body is off.
        let body = usize::from(on_first || first.is_none());
        let on_other = on_first || self.same(&own, &with_second);
        Some(Some(Misplaced::Off { pin: index, body, on_other }))
    }

    /// Velocity of the body's point that is at `place`: that of its centre, and the arm turned.
    fn carried(&self, body: Option<usize>, place: [usize; 2]) -> Option<Velocity> {
        let still = || vec![0.0; self.work.coordinates];
        let Some(body) = body else { return Some(Velocity { slopes: [still(), still()], squares: 0.0 }) };
        let (centre, angle) = self.work.bodies.get(body)?;
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

    /// Whether two velocities are the same in every motion that the rows allow.
    fn same(&self, a: &Velocity, b: &Velocity) -> bool {
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

#[cfg(test)]
mod tests {
    /// What the compiler says of a text with `knee` as the place of that pin.
    fn fault(text: &str, knee: &str) -> Option<String> {
        crate::expand_source(&text.replace("KNEE", knee)).err()
    }

    fn accepts(text: &str, knee: &str) {
        assert_eq!(fault(text, knee), None, "{knee}");
    }

    fn refuses(text: &str, knee: &str) {
        let fault = fault(text, knee).unwrap_or_default();
        assert!(fault.contains("the pin `knee`"), "{knee}: {fault}");
    }

    /// Two bars in angles: no row at all.
    const BARS: &str = "pub mechanism Bars;
        param L: m = 0.5;
        coord phi: [rad; 2] = [0.1, 0.2];
        let a = L*unit(phi[0]);
        let b = a + L*unit(phi[1]);
        body c { mass: 1, com: a/2, inertia: 0.1, angle: phi[0] }
        body d { mass: 1, com: (a + b)/2, inertia: 0.1, angle: phi[1] }
        gravity g { acceleration: [0, -9.81] }
        pin bearing: ground, c at [0, 0];
        pin knee: c, d at KNEE;
        out force: [N; 2] = reaction(knee, d);";

    #[test]
    fn a_pin_of_relative_coordinates_stands_where_its_bodies_keep_together() {
        accepts(BARS, "a");
        for place in ["b", "[0, 0]", "a/2", "[0.5*L, 0.1]", "1.0001*a"] {
            refuses(BARS, place);
        }
    }

    /// The same in the places of the centres: rows hold them together, with lengths that are numbers.
    const CENTRES: &str = "pub mechanism Centres;
        coord r: [m; 2] = [0.15, 0];
        coord s: [m; 2] = [0.45, 0];
        coord phi: [rad; 2] = [0.1, 0.2];
        body c { mass: 1, com: r, inertia: 0.1, angle: phi[0] }
        body d { mass: 1, com: s, inertia: 0.1, angle: phi[1] }
        constraint bearing { r == 150mm*unit(phi[0]); }
        constraint knee { r + 150mm*unit(phi[0]) == s - 150mm*unit(phi[1]); }
        pin bearing: ground, c at [0, 0];
        pin knee: c, d at KNEE;
        out force: [N; 2] = reaction(knee, d);";

    /// A bar on a pivot of the ground whose velocity is a difference that rounds.
    const PIVOT: &str = "pub mechanism Pivot;
        param L: m = 0.5;
        param D: m = 0.3;
        coord phi: rad = 0.1;
        body bar { mass: 1, com: [D, 0] + L/3*unit(phi), inertia: 0.1, angle: phi }
        pin knee: bar, ground at KNEE;
        out force: [N; 2] = reaction(knee, bar);";

    #[test]
    fn a_pivot_on_the_ground_stands_still() {
        accepts(PIVOT, "[D, 0]");
        refuses(PIVOT, "[0, 0]");
        refuses(PIVOT, "[D, 0] + L*unit(phi)");
    }

    #[test]
    fn a_pin_of_reference_points_may_be_written_from_either_body() {
        for place in ["r + 150mm*unit(phi[0])", "s - 150mm*unit(phi[1])", "2*r", "300mm*unit(phi[0])"] {
            accepts(CENTRES, place);
        }
        for place in ["r", "s", "s + 150mm*unit(phi[1])", "r - 150mm*unit(phi[0])"] {
            refuses(CENTRES, place);
        }
    }

    /// Driven, in natural coordinates, with a row that repeats others.
    const DRIVEN: &str = "pub mechanism Driven;
        param L: m = 0.5;
        coord p: [m; 2] = [0.4, 0.3];
        coord q: [m; 2] = [0.9, 0.3];
        coord theta: rad = 0.6;
        let along = q - p;
        body crank { mass: 1, com: p/2, inertia: 0.1, angle: theta }
        body rod { mass: 1, com: (p + q)/2, inertia: 0.1, angle: atan2(along.1, along.0) }
        body block { mass: 1, com: q }
        constraint length { dot(q - p, q - p) == L^2; }
        constraint arm { p == 300mm*unit(theta); }
        constraint again redundant { dot(p, p) == 300mm*300mm; }
        constraint guide { q.1 == 0; }
        drive motor: theta == 3*t*1rad/1s;
        pin bearing: ground, crank at [0, 0];
        pin knee: crank, rod at KNEE;
        pin wrist: rod, block at q;
        out force: [N; 2] = reaction(knee, rod);";

    #[test]
    fn what_a_drive_or_a_guide_holds_is_no_excuse() {
        accepts(DRIVEN, "p");
        accepts(DRIVEN, "300mm*unit(theta)");
        for place in ["q", "[0, 0]", "(p + q)/2", "300mm*unit(theta + 0.01)"] {
            refuses(DRIVEN, place);
        }
    }

    /// A wheel that rolls on the floor touches it at a point that is fixed on neither.
    const WHEEL: &str = "pub mechanism Wheel;
        coord x: m = 0;
        body wheel { mass: 1, com: [x, 0.3], inertia: 0.1, angle: -x/300mm }
        pin knee: ground, wheel at KNEE;
        gravity g { acceleration: [3, -9.81] }
        out force: [N; 2] = reaction(knee, wheel);";

    #[test]
    fn the_point_where_a_wheel_touches_keeps_it_on_the_floor() {
        accepts(WHEEL, "[x, 0]");
        for place in ["[x, 0.3]", "[x, 0.01]", "[0, 0]"] {
            refuses(WHEEL, place);
        }
    }
}

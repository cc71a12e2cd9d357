//! Check of the places of pins: there the points of both bodies have one velocity in every motion that the rows allow.
//!
//! At another place a pin's force would do work, and the sums over the bodies have no solution. Drives and guides that
//! act on bodies directly do not matter: their forces are among the sums.

use super::velocities::{Here, Motions, Seen};
use super::{Attribution, Given};
use crate::model::Model;
use crate::model::dynamics::{Dynamics as Declared, Pin};
use crate::model::expression::Id;
use crate::symbolic::{Graph, NodeId};

/// PinFault in the place of a pin.
pub enum Misplaced {
    /// It is not a point of one of its bodies.
    Off {
        /// Its index.
        pin: usize,
        /// The body of the two that passes its point: 0 or 1.
        body: usize,
        /// `true` if the point moves with the other.
        on_other: bool,
    },
    /// No position is found at which all rows hold, so that it cannot be checked.
    Unseen,
}

/// Before: the body that each force and row acts on. After: the first pin at whose point its bodies move apart, at positions
/// that fulfil all rows.
///
/// A property of a few scattered positions of a design without special numbers holds at all positions around them.
pub fn misplaced(
    g: &mut Graph,
    (model, declared): (&Model, &Declared),
    given: Given<'_>,
    found: &Attribution,
) -> Option<Misplaced> {
    let zero = g.constant(0.0);
    let of = |id: Option<&Id>| id.and_then(|id| given.nodes.get(id.index())).copied().unwrap_or(zero);
    let points: Vec<[NodeId; 2]> =
        declared.pins.iter().map(|pin| [of(pin.at.first()), of(pin.at.get(1))]).collect();
    let apart = |row: usize| found.rows.iter().all(|(known, _)| *known != row);
    let motions = Motions::of(g, (model, declared), given, &points, apart);
    let all = |here: &Here<'_>| {
        declared.pins.iter().enumerate().map(|(index, pin)| at_pin(here, index, pin)).collect()
    };
    let both = |known: Vec<Option<Misplaced>>, seen: Vec<Option<Misplaced>>| {
        known.into_iter().zip(seen).map(|(known, seen)| known.and(seen)).collect()
    };
    match motions.seen(g, all, both) {
        Seen::Somewhere(faults) => faults.into_iter().flatten().next(),
        Seen::Nowhere => Some(Misplaced::Unseen),
        Seen::TooLong => None,
    }
}

/// PinFault of a pin at a position, if it is misplaced there; the outer `None` where a value is not finite.
fn at_pin(here: &Here<'_>, index: usize, pin: &Pin) -> Option<Option<Misplaced>> {
    let [first, second] = pin.bodies;
    let (with_first, with_second) = (here.carried(first, index)?, here.carried(second, index)?);
    if here.same(&with_first, &with_second) {
        return Some(None);
    }
    let own = here.own(index)?;
    let on_first = here.same(&own, &with_first);
    // The ground carries no point: where the point belongs to neither, the body is off.
    let body = usize::from(on_first || first.is_none());
    let on_other = on_first || here.same(&own, &with_second);
    Some(Some(Misplaced::Off { pin: index, body, on_other }))
}

#[cfg(test)]
mod tests {
    /// Report of the compiler on a text with `knee` as the place of that pin.
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
    fn points_held_by_a_drive_or_a_guide_are_no_excuse() {
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

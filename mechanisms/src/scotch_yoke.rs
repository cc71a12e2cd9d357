//! The Scotch yoke: a crank pin in a crosswise slot moves a yoke as `r cos θ`, exactly.
//!
//! ```text
//!             ┌─┐
//!             │ │
//!          A .[o]           θ: crank against the x axis (rad)
//!        r .' │ │           x: yoke (m)
//!        .'θ  │ │           y: crank pin in the slot (m)
//!    ───o─────┤ ├──────════
//!       O     │ │    guide
//!             └─┘
//!       |← x →|
//! ```
//!
//! Lengths in metres, `q = [θ x y]`. There is one assembly and no singular position. The rod's ends stand `b` to
//! either side of the slot.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;

use crate::drawing::{Along, Shape};
use crate::facade;
use crate::registry::{Card, Preset, Span};

mechanism! {
    /// Scotch yoke.
    pub mechanism ScotchYoke;

    param r: m = 60mm;
    param b: m = 130mm;
    param omega: rad/s = 10;

    coord theta: rad = 0;
    coord x: m = 60mm;
    coord y: m = 0;

    constraint slot { [x, y] == r*unit(theta); }
    drive crank: theta == omega*t;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out Y: [m; 2] = [x, 0];
    out R: [m; 2] = [x + b, 0];
    out L: [m; 2] = [x - b, 0];
    out slot_top: [m; 2] = [x, 1.25*r];
    out slot_bottom: [m; 2] = [x, -1.25*r];
}

/// How the mechanism is drawn.
pub const DRAWING: &[Shape] = &[
    Shape::Rail { at: "R", along: Along::Fixed([1.0, 0.0]) },
    Shape::Rail { at: "L", along: Along::Fixed([1.0, 0.0]) },
    Shape::Slider { at: "R", along: Along::Fixed([1.0, 0.0]) },
    Shape::Slider { at: "L", along: Along::Fixed([1.0, 0.0]) },
    Shape::Ground { at: "O" },
    Shape::Link { points: &["L", "R"], label: "yoke" },
    Shape::Slot { points: &["slot_bottom", "slot_top"], label: "" },
    Shape::Slider { at: "A", along: Along::Fixed([0.0, 1.0]) },
    Shape::Link { points: &["O", "A"], label: "crank" },
    Shape::Joint { at: "O" },
    Shape::Joint { at: "A" },
    Shape::Trace { of: "A", label: "crank pin" },
    Shape::Trace { of: "R", label: "rod" },
];

/// Entry in the list of mechanisms.
pub const CARD: Card = Card {
    name: "scotch_yoke",
    title: "Scotch yoke",
    description: "A crank pin in a crosswise slot: the yoke moves harmonically.",
    runs: &[Preset { label: "one turn", description: "the crank at constant speed", set: &[] }],
    span: Span::Turn { rate: "omega" },
    drawing: DRAWING,
    make: facade::boxed::<ScotchYoke, 3>,
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_form::{Jet, assert_moves_as};
    use crate::reference::one_turn;

    #[test]
    fn the_yoke_moves_harmonically() {
        let motion = one_turn(&CARD, &CARD.runs[0], 180);
        assert_moves_as(&motion, &["theta", "x", "y"], 1e-14, |Jet([t, ..])| {
            let (w, r) = (10.0, 0.06);
            let (s, c) = (w * t).sin_cos();
            vec![
                Jet([w * t, w, 0.0]),
                Jet([r * c, -r * w * s, -r * w * w * c]),
                Jet([r * s, r * w * c, -r * w * w * s]),
            ]
        });
    }
}

//! Three balls in a box without a lid: rigid contacts with floor, walls and each other.
//!
//! ```text
//!     |    o          |
//!     |         o     |    balls of radius R, box of width 2 W
//!     |   o           |
//!     +---------------+
//! ```
//!
//! Lengths in metres, masses in kg. Each contact is a row that opens and closes, with impacts of the coefficient of restitution `e`.
//!
//! Numbers: rubber balls, round. Closed form: without the air the balls fly along parabolas between impacts. The times of impacts are
//! roots of quadratic equations, for two balls fall alike.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(BouncingBalls::default());

mechanism! {
    /// Three balls in a box without a lid: rigid contacts with floor, walls and each other.
    pub mechanism BouncingBalls;
    /// Coefficient of restitution of all contacts.
    param e: 1 = 0.9 in 0..1;
    /// Masses of the balls.
    param m: [kg; 3] = [0.3, 0.2, 0.1];
    /// Drag over the square of the speed.
    param drag: N*s^2/m^2 = 4e-3;
    /// Radius of a ball.
    const R: m = 0.1;
    /// Half of the width of the box.
    const W: m = 0.6;
    coord p: [m; 3, 2] = [[-0.3, 0.9], [0.1, 1.2], [0.35, 0.7]];
    for i in 0..3 {
        body ball { mass: m[i], com: p[i] }
        out centre: [m; 2] = p[i];
        out rim: [m; 2] = p[i] + R*[0, 1];
    }
    out corner: [m; 4, 2] = [[-W, 1.2m], [-W, 0m], [W, 0m], [W, 1.2m]];
    effect weight {
        gravity fall { acceleration: [0, -9.81] }
    }
    effect floor {
        for i in 0..3 {
            contact ground { gap: p[i, 1] - R, restitution: e }
        }
    }
    effect walls {
        for i in 0..3 {
            contact left { gap: p[i, 0] + W - R, restitution: e }
            contact right { gap: W - R - p[i, 0], restitution: e }
        }
    }
    effect meetings {
        contact first { gap: norm(p[1] - p[0]) - 2*R, restitution: e }
        contact second { gap: norm(p[2] - p[1]) - 2*R, restitution: e }
        contact third { gap: norm(p[0] - p[2]) - 2*R, restitution: e }
    }
    effect air {
        for i in 0..3 { force resistance: -drag*norm(der(p[i]))*der(p[i]) on p[i]; }
    }
    start p = [[-0.3, 0.9], [0.1, 1.2], [0.35, 0.7]] rate [[1.1, 0.3], [-0.4, 0], [-0.9, 1.5]];
    title "Three balls in a box";
    about "Rigid contacts: impacts with a coefficient of restitution, and rest after infinitely many of them.";
    preset lively "e = 0.9" { e: 0.9 }
    preset dull "e = 0.5" { e: 0.5 }
    span 3s;
    draw link box: corner[0], corner[1], corner[2], corner[3];
    draw wheel centre[0] rim rim[0];
    draw wheel centre[1] rim rim[1];
    draw wheel centre[2] rim rim[2];
}

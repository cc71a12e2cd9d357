//! A quarter of a car drives onto a kerb: the tyre lifts off, the strut comes to both of its stops.
//!
//! ```text
//!       [ body ]      y.0: above its height at rest on a flat road
//!        ≀ ⊓ =        spring, damper and stops of the strut
//!       [ wheel ]     y.1
//!          ≀          tyre, which only pushes
//!     _____/‾‾‾‾‾     kerb with a rounded edge
//! ```
//!
//! Lengths in metres, masses in kg.
//!
//! | effect | law |
//! |---|---|
//! | `weight` | gravity |
//! | `spring` | linear, carries the weight of the body at y = 0 |
//! | `damper` | −c v, of 0.6 c where the strut is pressed together |
//! | `tyre` | contact with the road, stiffness and damping |
//! | `bump_stop`, `rebound_stop` | contacts at both ends of the strut's travel |
//! | `dry` | dry friction of the seals, smooth |
//!
//! Numbers: a middle-class car, round. `mechanisms/references/kerb.py` solves Newton's equations of both masses with SciPy.
//! Closed form about rest with linear damper and no friction: modes of 1.252 Hz and 11.079 Hz without damping.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Kerb::default());

mechanism! {
    /// Quarter car that drives onto a kerb.
    pub mechanism Kerb;
    /// Masses of the body and of the wheel.
    param m: [kg; 2] = [300, 40];
    /// Height of the kerb.
    param height: m = 0.1 in 0..0.15;
    /// Speed of the car.
    param speed: m/s = 8 in 2..20;
    /// Free fall, for which the springs are set.
    const G: m/s^2 = 9.81;
    const WHEEL: m = 0.35;
    const BODY: m = 0.9;
    coord y: [m; 2];
    let s = min(max((t - 0.1s)*speed/0.3m, 0), 1);
    let road = height*s^3*(10 - 15*s + 6*s^2);
    let body_centre = [0, BODY + y[0]];
    let wheel_centre = [0, WHEEL + y[1]];
    let travel = y[0] - y[1];
    body chassis { mass: m[0], com: body_centre }
    body wheel { mass: m[1], com: wheel_centre }
    start y = [0, 0] rate [0, 0];
    out chassis_centre: [m; 2] = body_centre;
    out hub: [m; 2] = wheel_centre;
    out patch: [m; 2] = [0, road];
    out comfort: m/s^2 = der2(y[0]);
    out strut: m = travel;

    effect weight {
        param g: m/s^2 = 9.81;
        gravity weight { acceleration: [0, -g] }
    }
    effect spring {
        param k: N/m = 20e3;
        force coil: k*(300kg*G/20e3 [N/m] - travel) on travel;
    }
    effect damper {
        param c: N*s/m = 1500;
        /// Part of `c` where the strut is pressed together.
        param together: 1 = 0.6;
        force damper: -c*(max(der(travel), 0) + together*min(der(travel), 0)) on travel;
    }
    effect tyre {
        param rubber: N/m = 180e3;
        param loss: s/m = 0.02;
        contact tread { gap: y[1] - road - (m[0] + m[1])*G/180e3 [N/m], stiffness: rubber, damping: loss }
        out wheel_load: N = force(tread);
    }
    effect bump_stop {
        param up: N/m = 60e3;
        contact bump { gap: 50mm + travel, stiffness: up, damping: 0.15 }
    }
    effect rebound_stop {
        param down: N/m = 60e3;
        contact rebound { gap: 40mm - travel, stiffness: down, damping: 0.15 }
    }
    effect dry {
        param rub: N = 40;
        friction seals { along: travel, normal: rub, coefficient: 1, speed: 20mm/1s }
    }

    title "Quarter car on a kerb";
    about "A wheel meets a kerb of 10 cm: the tyre lifts off, and the strut comes to both stops. `mbs effects kerb` tells which forces count.";
    preset fast "8 m/s: the tyre lifts off" {}
    preset slow "3 m/s, half the height" { speed: 3, height: 50mm }
    span 1.5s;
    draw spring suspension: hub, chassis_centre;
    draw spring tyre: patch, hub;
    draw slider chassis_centre along [0, 1];
    draw slider hub along [0, 1];
    draw joint patch;
}

//! A stiff flyball governor: shaft, two rods with balls, and a slider that springs with dampers tie to the rods.
//!
//! ```text
//!              hinges at a from the axis, 1 m up
//!           ●╲  │  ╱●          rods of 1 m, balls at their ends
//!             ╲─┼─╱
//!              ╲│╱  springs    from the middles of the rods
//!              ┌┴┐
//!              └┬┘ slider      at s above the foot of the shaft
//!               │
//! ```
//!
//! The shaft turns by φ, the slider turns with it at height s; the rods are bodies in space by position and Euler parameters, each
//! with the five rows of a revolute joint on the shaft.
//!
//! Source: IFToMM benchmark A05, stiff flyball governor. Shaft and rods 1 m with a square section of 0.01 m, slider a cube of 0.1 m,
//! 3000 kg/m³; balls of 5 kg, springs of 8e5 N/m and 4e4 N s/m, free fall along −z, 2π rad/s about the shaft at the start.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::{Card, DefaultMethod};

/// In the list of free mechanisms.
pub const CARD: Card = card!(Governor::default()).moved_by(DefaultMethod::Extrapolated);

mechanism! {
    /// A flyball governor: four degrees of freedom in 16 coordinates.
    pub mechanism Governor;
    /// Density of shaft, rods and slider.
    param rho: kg/m^3 = 3000;
    /// Mass of a ball.
    param ball_mass: kg = 5;
    /// Stiffness and damping of a spring, and its length at rest.
    param k: N/m = 8e5;
    param c: N*s/m = 4e4;
    param l0: m = 0.5;
    /// Free fall, along −z.
    param g: m/s^2 = 9.81;
    /// Speed about the shaft at the start.
    param omega: rad/s = TAU;
    /// Length and side of the section of shaft and rods, side of the slider, distance of the hinges from the axis.
    const L: m = 1;
    const A: m = 0.01;
    const B: m = 0.1;
    const H: m = 0.05;
    /// Angle of the rods below the level at the start.
    const ALPHA: rad = 30deg;

    /// Angle of the shaft.
    coord phi: rad = 0;
    /// Height of the slider.
    coord s: m = 0.5;
    /// Centres of the rods.
    coord r: [m; 2, 3] = [
        [H + L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)],
        [-H - L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)]
    ];
    /// Euler parameters of the rods: x along the rod, y its hinge.
    coord e: [1; 2, 4] = [
        [cos(ALPHA/2), 0, sin(ALPHA/2), 0],
        [0, -sin(ALPHA/2), 0, cos(ALPHA/2)]
    ];

    let turn = [cos(phi/2), 0, 0, sin(phi/2)];
    let rod_mass = rho*L*A^2;
    let slider_mass = rho*B^3;
    let thin = rod_mass*A^2/6;
    let long = rod_mass*(L^2 + A^2)/12;
    let cube = slider_mass*B^2/6;
    // From the axis to the hinge of each rod.
    let radial = [rotate(turn, [H, 0, 0]), rotate(turn, [-H, 0, 0])];

    body shaft { mass: rod_mass, com: [0, 0, L/2], inertia: [long, long, thin], orientation: turn }
    body slider { mass: slider_mass, com: [0, 0, s], inertia: [cube, cube, cube], orientation: turn }
    for i in 0..2 {
        body rod { mass: rod_mass, com: r[i], inertia: [thin, long, long], orientation: e[i] }
        body ball { mass: ball_mass, com: r[i] + L/2*rotate(e[i], [1, 0, 0]) }
        tsda spring { from: [0, 0, s] + radial[i], to: r[i], stiffness: k, length: l0, damping: c }
    }
    gravity weight { acceleration: [0, 0, -g] }
    constraint hinge {
        for i in 0..2 {
            r[i] - L/2*rotate(e[i], [1, 0, 0]) == [0, 0, L] + radial[i];
            dot(rotate(e[i], [0, 1, 0]), rotate(turn, [1, 0, 0])) == 0;
            rotate(e[i], [0, 1, 0])[2] == 0;
        }
    }
    start phi = 0 rate omega;
    start s = 0.5 rate 0;
    start r = [
        [H + L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)],
        [-H - L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)]
    ] rate [
        [0, omega*(H + L/2*cos(ALPHA)), 0],
        [0, -omega*(H + L/2*cos(ALPHA)), 0]
    ];
    start e = [
        [cos(ALPHA/2), 0, sin(ALPHA/2), 0],
        [0, -sin(ALPHA/2), 0, cos(ALPHA/2)]
    ] rate [
        [0, -omega/2*sin(ALPHA/2), 0, omega/2*cos(ALPHA/2)],
        [-omega/2*cos(ALPHA/2), 0, -omega/2*sin(ALPHA/2), 0]
    ];

    /// Height of the slider.
    out height: m = s;
    out O: [m; 3] = [0, 0, 0];
    out top: [m; 3] = [0, 0, L];
    out S: [m; 3] = [0, 0, s];
    out hinge_1: [m; 3] = [0, 0, L] + radial[0];
    out hinge_2: [m; 3] = [0, 0, L] + radial[1];
    out spring_1: [m; 3] = [0, 0, s] + radial[0];
    out spring_2: [m; 3] = [0, 0, s] + radial[1];
    out middle_1: [m; 3] = r[0];
    out middle_2: [m; 3] = r[1];
    out B1: [m; 3] = r[0] + L/2*rotate(e[0], [1, 0, 0]);
    out B2: [m; 3] = r[1] + L/2*rotate(e[1], [1, 0, 0]);

    title "Stiff flyball governor";
    about "Two balls on rods swing out as the shaft turns and carry a slider by springs and dampers so stiff \
           that explicit steps of a millisecond would blow up.";
    preset free "free, one turn a second at the start" {}
    span 10s;
    draw view diagonal;
    draw ground O;
    draw link shaft: O, top;
    draw link hinge_1, top, hinge_2;
    draw link "first rod": hinge_1, B1;
    draw link "second rod": hinge_2, B2;
    draw spring spring_1, middle_1;
    draw spring spring_2, middle_2;
    draw link slider: spring_1, S, spring_2;
    draw joint B1, B2;
    trace "first ball": B1;
}

//! Bricard's mechanism: five rods and the ground in a loop of six revolute joints, movable against Grübler's count.
//!
//! ```text
//!        P6 ═══ ground ═══ P1 ──── P2          unit cube seen along its diagonal; the joints'
//!         ╲                         ╲          axes at P1 … P6 are y z x y z x at the start
//!          P5 ──── P4 ──── P3 ───────
//! ```
//!
//! The first and the last rod turn by an angle about their joints on the ground; those between are bodies in space by position and
//! Euler parameters. Of the 20 rows of the joints between the rods 19 are independent in every position.
//!
//! Source: IFToMM benchmark A04, Bricard's mechanism. Rods of 1 m and 1 kg with a square section of 0.1 m, P1 and P6 on the ground,
//! free fall along −y, from rest.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Bricard::default());

mechanism! {
    /// Bricard's mechanism: one degree of freedom in 23 coordinates.
    pub mechanism Bricard;
    /// Mass of a rod.
    param m: kg = 1;
    /// Free fall, along −y.
    param g: m/s^2 = 9.81;
    /// Length of a rod, and the side of its section.
    const L: m = 1;
    const A: m = 0.1;
    /// Angle of the first rod about y at P1.
    coord first: rad = 0;
    /// Angle of the last rod about x at P6.
    coord last: rad = 0;
    /// Centres of mass of the three rods between them.
    coord r: [m; 3, 3] = [[1, -0.5, 0], [1, -1, 0.5], [0.5, -1, 1]];
    /// Their Euler parameters.
    coord e: [1; 3, 4] = [[1, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]];
    // The axes of all rods are those of the ground at the start.
    let x = [1, 0, 0];
    let y = [0, 1, 0];
    let z = [0, 0, 1];
    let along = [x, [0, -1, 0], z, [-1, 0, 0], y];
    let orientations = [[cos(first/2), 0, sin(first/2), 0], e[0], e[1], e[2], [cos(last/2), sin(last/2), 0, 0]];
    let half = [
        L/2*rotate(orientations[0], along[0]),
        L/2*rotate(orientations[1], along[1]),
        L/2*rotate(orientations[2], along[2]),
        L/2*rotate(orientations[3], along[3]),
        L/2*rotate(orientations[4], along[4])
    ];
    let centres = [half[0], r[0], r[1], r[2], [0, 0, L] - half[4]];
    let thin = m*A^2/6;
    let long = m*(L^2 + A^2)/12;
    let inertias = [[long, thin, long], [long, long, thin], [thin, long, long]];
    body first_rod { mass: m, com: centres[0], inertia: [thin, long, long], orientation: orientations[0] }
    for i in 0..3 {
        body rod { mass: m, com: r[i], inertia: inertias[i], orientation: e[i] }
    }
    body last_rod { mass: m, com: centres[4], inertia: [long, thin, long], orientation: orientations[4] }
    gravity weight { acceleration: [0, -g, 0] }
    // Of each joint between two rods the axis on the one, and the two axes across on the other.
    let axis = [z, x, y, z];
    let across = [x, y, z, x];
    let athwart = [y, z, x, y];
    constraint joint redundant {
        for i in 0..4 {
            centres[i] + half[i] == centres[i + 1] - half[i + 1];
            dot(rotate(orientations[i], axis[i]), rotate(orientations[i + 1], across[i])) == 0;
            dot(rotate(orientations[i], axis[i]), rotate(orientations[i + 1], athwart[i])) == 0;
        }
    }
    out P1: [m; 3] = [0, 0, 0];
    out P2: [m; 3] = centres[0] + half[0];
    /// The third joint, between the second rod and the third.
    out P3: [m; 3] = centres[1] + half[1];
    out P4: [m; 3] = centres[2] + half[2];
    out P5: [m; 3] = centres[3] + half[3];
    out P6: [m; 3] = [0, 0, L];

    title "Bricard's mechanism";
    about "Five rods and the ground in a loop of six revolute joints: by count no degree of freedom, in truth \
           one: a row of its joints follows from the others wherever it is.";
    preset falling "from rest, by its weight" {}
    span 10s;
    draw view "from x = y = z, y upwards": right [1, 0, -1] up [-1, 2, -1];
    draw ground P1, P6;
    draw link first: P1, P2;
    draw link second: P2, P3;
    draw link third: P3, P4;
    draw link fourth: P4, P5;
    draw link fifth: P5, P6;
    draw joint P1, P2, P3, P4, P5, P6;
    trace "third joint": P3;
}

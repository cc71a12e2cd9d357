//! Theo Jansen's leg: eleven bars that walk.
//!
//! ```text
//!              T
//!         e .·'│`·.  j
//!       .·'    │b   `·.
//!    V ·───────o B     `o A          crank O A = m, its centre O a to the right of B and l above it
//!      │   d   │c     .·'
//!    f │       │   .·' k            T: j from A, b from B       K: k from A, c from B
//!      │   g   │.·'                 V: e from T, d from B       W: f from V, g from K
//!    W ·───────o K                  F: h from W, i from K       (foot)
//!      │    .·'
//!    h │ .·' i
//!      F
//! ```
//!
//! `B T V` and `K W F` are rigid triangles. `q = [θ T K V W F]` with natural coordinates of the joints, squares of
//! lengths as rows (m²). Each joint hangs from two known ones; the five branches say on which side; no two bars
//! come in line during a turn. The crank turns clockwise: then the foot moves
//! to the left while it is on the ground and returns through the air; the animal walks to the right.
//!
//! Numbers: Jansen's published "holy numbers" (T. Jansen, The Great Pretender, 2007), a = 38, b = 41.5, c = 39.3,
//! d = 40.1, e = 55.8, f = 39.4, g = 36.7, h = 65.7, i = 49, j = 50, k = 61.9, with l = 7.8 and m = 15; here in mm.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Theo Jansen's walking leg.
    pub mechanism Jansen;

    param a: m = 38.0mm;
    param b: m = 41.5mm;
    param c: m = 39.3mm;
    param d: m = 40.1mm;
    param e: m = 55.8mm;
    param f: m = 39.4mm;
    param g: m = 36.7mm;
    param h: m = 65.7mm;
    param i: m = 49.0mm;
    param j: m = 50.0mm;
    param k: m = 61.9mm;
    param l: m = 7.8mm;
    param m: m = 15.0mm;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord top: [m; 2] = [-19mm, 29mm];
    coord knee: [m; 2] = [-31mm, -46mm];
    coord rear: [m; 2] = [-68mm, 20mm];
    coord heel: [m; 2] = [-66mm, -37mm];
    coord foot: [m; 2] = [-53mm, -90mm];

    let crank = m*unit(theta);
    let pivot = [-a, -l];

    constraint upper {
        dot(top - crank, top - crank) == j^2;
        dot(top - pivot, top - pivot) == b^2;
    }
    constraint lower {
        dot(knee - crank, knee - crank) == k^2;
        dot(knee - pivot, knee - pivot) == c^2;
    }
    constraint shoulder {
        dot(rear - top, rear - top) == e^2;
        dot(rear - pivot, rear - pivot) == d^2;
    }
    constraint parallel {
        dot(heel - rear, heel - rear) == f^2;
        dot(heel - knee, heel - knee) == g^2;
    }
    constraint shank {
        dot(foot - heel, foot - heel) == h^2;
        dot(foot - knee, foot - knee) == i^2;
    }
    drive turn: theta == -omega*t;
    branch top_above: cross(crank - pivot, top - pivot) > 0;
    branch knee_below: cross(crank - pivot, knee - pivot) < 0;
    branch rear_behind: cross(top - pivot, rear - pivot) > 0;
    branch heel_behind: cross(rear - knee, heel - knee) > 0;
    branch foot_below: cross(heel - knee, foot - knee) > 0;

    out O: [m; 2] = [0, 0];
    out B: [m; 2] = pivot;
    out A: [m; 2] = crank;
    out T: [m; 2] = top;
    out K: [m; 2] = knee;
    out V: [m; 2] = rear;
    out W: [m; 2] = heel;
    out F: [m; 2] = foot;

    title "Theo Jansen's leg";
    about "One crank moves a leg of eleven bars; with Jansen's numbers the foot goes along the ground on a \
           nearly level line and returns through the air.";
    preset "one step" "the crank turns clockwise" {}
    span turn(omega);
    draw ground O, B;
    draw plate "b d e": B, T, V;
    draw plate "g h i": K, W, F;
    draw link j: A, T;
    draw link k: A, K;
    draw link c: B, K;
    draw link f: V, W;
    draw link m: O, A;
    draw joint O, A, B, T, K, V, W;
    trace foot: F;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(Jansen::default());

//! The angle of a point.
//!
//! `libm::atan2` forms a quotient, then a second one of it. Here the sector is known from products, and the only quotient is the tangent
//! from the sector's line. Sectors are branches, which the processor foresees: a mechanism's directions turn slowly.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Least and largest |x| + |y| of which no sum, multiple or quotient loses digits or overflows.
const REGULAR: [f64; 2] = [f64::from_bits(0x0370_0000_0000_0000), f64::MAX / 64.0];

/// Bit of the sign.
const SIGN: u64 = 1 << 63;

/// Angle (rad) of a line in two parts, and that of its mirror image at negative x.
type Line = [[f64; 2]; 2];

/// Lines of slope 0, 1/2, 1, 3/2 and ∞.
const LEVEL: Line = [[0.0, 0.0], [PI, 1.2246467991473532e-16]];
const HALF: Line =
    [[0.4636476090008061, 2.2698777452961687e-17], [2.677945044588987, 1.5527705369303147e-16]];
const EVEN: Line = [[FRAC_PI_4, 3.061616997868383e-17], [2.356194490192345, 9.184850993605148e-17]];
const STEEP: Line =
    [[0.982793723247329, 1.3903311031230998e-17], [2.158798930342464, 2.1958367134601997e-16]];
const UPRIGHT: Line = [[FRAC_PI_2, 6.123233995736766e-17]; 2];

/// arctan t = t − t³ (A₀ + A₁ t² + …) on |t| ≤ 7/16.
/// Source: FreeBSD, msun, `s_atan.c`, Copyright (C) 1993 by Sun Microsystems, Inc.
const ARC: [f64; 11] = [
    0.3333333333333293,
    -0.19999999999876483,
    0.14285714272503466,
    -0.11111110405462356,
    0.09090887133436507,
    -0.0769187620504483,
    0.06661073137387531,
    -0.058335701337905735,
    0.049768779946159324,
    -0.036531572744216916,
    0.016285820115365782,
];

/// Angle (rad) of the point (x, y) in [−π, π], within 1.5 units of the last place, as the library's. Points next to the origin or far
/// away, infinity and NaN are the library's.
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    let (across, along) = (y.abs(), x.abs());
    let [least, most] = REGULAR;
    let size = across + along;
    let is_regular = least <= size && size <= most;
    if cfg!(feature = "libm") || !is_regular {
        return of_library(y, x);
    }
    // The tangent from the nearest line is at most 7/16. Differences are exact.
    let sixteenths = 16.0 * across;
    let (tangent, [line, mirrored]) = if sixteenths < 19.0 * along {
        if sixteenths < 7.0 * along {
            (across / along, LEVEL)
        } else if sixteenths < 11.0 * along {
            ((2.0 * across - along) / (2.0 * along + across), HALF)
        } else {
            ((across - along) / (along + across), EVEN)
        }
    } else if sixteenths < 39.0 * along {
        ((2.0 * across - 3.0 * along) / (2.0 * along + 3.0 * across), STEEP)
    } else {
        (-(along / across), UPRIGHT)
    };
    let left = x.to_bits() & SIGN;
    let [angle, rest] = if left == 0 { line } else { mirrored };
    let t = f64::from_bits(tangent.to_bits() ^ left);
    // Pairs, and pairs of those: few products wait for others. Source: Estrin 1960.
    let square = t * t;
    let fourth = square * square;
    let eighth = fourth * fourth;
    let [a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10] = ARC;
    let low = (a0 + square * a1) + fourth * (a2 + square * a3);
    let middle = (a4 + square * a5) + fourth * (a6 + square * a7);
    let high = (a8 + square * a9) + fourth * a10;
    let cubed = (t * square) * (low + eighth * (middle + eighth * high));
    let found = angle - ((cubed - rest) - t);
    f64::from_bits(found.to_bits() | (y.to_bits() & SIGN))
}

#[cold]
#[inline(never)]
fn of_library(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

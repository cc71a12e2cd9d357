//! Friction that sticks: rows that follow from others, and the edge of sticking.

use crate::tolerances::Law;

/// Least over largest pivot of W, scaled to 1, from which rows that stick are independent: half the digits are left.
pub(crate) const DEPENDENT: Law = Law::root(1.0);

/// Term added to the diagonal of a singular W, scaled to 1. Forty steps with it find the shortest solution where directions of W are
/// above it; rounding over it is what the shares of a force have.
pub(crate) const RAISED: Law = Law::fourth_root(1.0);

/// Largest force or stiffness of a text over that of springs in the place of set-valued rows, in a search for a rest: each search comes nearer by
/// as much, and a soft direction of the text loses it of the digits that stiffness is told in.
pub(crate) const SOFTNESS: Law = Law::fourth_root(1.0);

/// Part of the force at which friction slips that counts as rounding, and of the terms of an acceleration that is none: the resolution
/// of events in time and of the accelerations.
pub(crate) const EDGE: Law = Law::ulps(1024.0);

/// Part of the terms of an acceleration along a row that sticks, from which the row contradicts others.
pub(crate) const CONTRADICTED: Law = Law::root(64.0);

/// Depth of an open contact, of the terms of its gap, from which it is no rounding of a start or of an event.
pub(crate) const PENETRATION: Law = Law::at_least(1e-9, 1024.0);

/// Height of a flight between two impacts, of the terms of the gap, below which all that follow are taken together.
pub(crate) const LEAST_FLIGHT: Law = Law::ulps(8192.0);

//! Balances of forces: equilibria, multipliers, friction, states.

use crate::tolerances::Law;

/// Change of the multipliers over their size that counts as rounding.
pub(crate) const STANDING: Law = Law::ulps(16.0);

/// Sum over its terms, of parts of a normal force or of changes of a load, up to which it counts as cancelled; rounding alone is 1e-13
/// of large forces.
pub(crate) const CANCELLED: Law = Law::at_least(1e-8, 256.0);

/// Distance of two solutions of friction over their size from which they are two.
pub(crate) const APART: Law = Law::root(16.0);

/// Change of the multipliers over their size by a step that no longer falls, which counts as rounding of an ill-conditioned balance.
pub(crate) const STUCK_MULTIPLIERS: Law = Law::root(1e-2);

/// Rounding errors a term of a sum c + B v that counts as zero, and of a piecewise linear equation that counts as met.
pub(crate) const OF_PIECEWISE: Law = Law::ulps(16.0);

/// Edge of a part of the simplex of norms that is not divided further, of which two solutions are not told apart.
pub(crate) const SHORTEST_EDGE: Law = Law::root(1.0);

/// Part of the largest stiffness or force in the metric below which a motion meets none. Rounding of stiff springs leaves nine digits
/// of a soft direction; the rounding of 0 counts where that is more.
pub(crate) const NO_STIFFNESS: Law = Law::at_least(1e-9, 256.0);

/// Force over stiffness times coordinate that is none: half an ε of the coordinate, and as much for each of the forces that cancel.
pub(crate) const UNRESOLVED: Law = Law::ulps(4.0);

/// Part of a coordinate in an indifferent motion, in the metric, from which it counts as indifferent.
pub(crate) const INDIFFERENT: Law = Law::fixed(1e-6);

/// Distance to both sides of an equilibrium over the coordinates in the metric, at which free play is looked for. Compared with it the
/// side on which rounding has put the equilibrium is nothing, and the forces left by a curved motion, its square, are rounding.
pub(crate) const BESIDE: Law = Law::root(4.0);

/// Largest work along a play that counts as none, over the largest force or stiffness and [`BESIDE`] over √ε: the forces left by the
/// search for an equilibrium, and the square of the distance to the side.
pub(crate) const NO_WORK: Law = Law::ulps(32.0);

/// Distance to the equilibrium of the free motions, in the metric, at which a position with dependent rows is at rest: 1e-6 in `f64`.
/// The first-order motion of a free coordinate leaves the square of a step on the rows, so √ε is what the step resolves.
pub(crate) const BALANCED: Law = Law::root(64.0);

/// Rates in the metric (1/s, 1/s²) that a state at rest may have, and its distance from the equilibrium in the metric: that of an
/// equilibrium typed with nine digits. In single precision it is rounding.
pub(crate) const AT_REST: Law = Law::at_least(1e-9, 256.0);

/// Rounding of its terms that the rate of a first-order state at rest may have.
pub(crate) const OF_STATE_RATE: Law = Law::ulps(64.0);

/// Part of its unit and scale that the integrand of a state at rest may be.
pub(crate) const INTEGRAND: Law = Law::root(1.0);

/// Part of the largest entry of its row below which a pivot of the states counts as 0, and of the entries of a rate below which the
/// result of elimination does: rounding of the row, or of 0 where that is more.
pub(crate) const NO_PIVOT: Law = Law::at_least(1e-12, 256.0);

/// A correction that counts as rounding, over the largest coordinate in the metric or the largest that a state has been.
pub(crate) const CORRECTED: Law = Law::ulps(64.0);

/// A correction that no longer falls counts as converged below this, in the metric or of the state: nine digits, more than a method of
/// order 2 has.
pub(crate) const STUCK: Law = Law::fixed(1e-9);

/// A correction that is none, over the movement in a step.
pub(crate) const OF_MOVEMENT: Law = Law::ulps(4.0);

/// Largest correction (rad, or reference lengths) with which a step of the augmented Lagrangian method may end that has not converged.
/// Next to a singular position the multiplier of the weak direction converges slowly. Below the error of the trapezoidal rule at the
/// longest steps that the method is for.
pub(crate) const SLOW: Law = Law::fixed(1e-5);

/// Movement of a step, in the metric, of which two results may differ in any ratio: a hundred times a correction that no longer falls, in
/// single precision twice one that is rounding.
pub(crate) const UNRESOLVED_MOVEMENT: Law = Law::at_least(1e-7, 128.0);

/// The same over the size of the coordinates: twice a correction that is rounding.
pub(crate) const MOVED_BY_ROUNDING: Law = Law::ulps(128.0);

/// Part of a direction of the rows that springs take off, below which its multiplier is left as it is: the square of a margin of 1e-6 and
/// the springs' factor of 1e4. There rounding of the rows moves the coordinates as far as the force of a step does.
pub(crate) const HIDDEN: Law = Law::root(1.0);

/// Acceleration that one rounding of the positions makes over a step, of that of the motion, below which multipliers are resolved.
pub(crate) const UNSEEN: Law = Law::fixed(1e-3);

//! The singular zone, ranks and dependent rows.
//!
//! Margins are those of the reference metric: 1 where singular values are equal, 0 at a singular position.

use crate::tolerances::Law;

/// Margin below which rates are refused: 32 √ε, 4.8e-7 in `f64`.
///
/// A residual within 64 ε leaves 64 ε/μ of position open at margin μ, and so much is μ itself in doubt. At a dead centre the position
/// found is √(64 ε) off and looks as if μ = 8 √ε; four times that leaves rates wrong by a sixteenth at worst, with the square of the
/// distance less beyond.
pub(crate) const LEAST_MARGIN: Law = Law::root(32.0);

/// The square of [`LEAST_MARGIN`], for comparisons without a root.
pub(crate) const LEAST_MARGIN_SQUARED: Law = Law::ulps(32.0 * 32.0);

/// Margin above which a Newton step keeps half its digits, and part of a row or column below which it counts as dependent on others.
pub(crate) const HALF_THE_DIGITS: Law = Law::root(1.0);

/// The square of [`HALF_THE_DIGITS`].
pub(crate) const HALF_THE_DIGITS_SQUARED: Law = Law::ulps(1.0);

/// Weight of rows that yield beside those that do not: ∛ε.
///
/// Its square is the part of a contradiction that the other rows keep, 4e-11. What it leaves of a row that yields has ε/∛ε of
/// its digits open in one solution, which the next iteration takes up.
pub(crate) const YIELDING_WEIGHT: Law = Law::cube_root(1.0);

/// Margin of the singular zone in `f64`.
const ZONE_MARGIN: f64 = 1e-2;

/// Margin of the singular zone of a motion by drivers. Below it the homotopy predicts, not the rates of the state: those are wrong by
/// the inverse square of the margin, and past a change point pick the assembly by chance. 0.075 in `f32`, the margin from which on a position leads to the next one there.
pub(crate) const ZONE: Law = Law::at_least(ZONE_MARGIN, 630_000.0);

/// Margin of the singular zone of a motion by forces, in which directions that the rows determine more weakly are not corrected. Also
/// the margin below which a declared start is corrected once more, and independent coordinates are at a turning point.
///
/// Rounding ε in the rows makes ε/σ of a position and ε v/σ² of a velocity that is projected. At 1e-2 that is 1e-12, the error of the
/// integration of a step there.
pub(crate) const ZONE_OF_FORCES: Law = Law::fixed(ZONE_MARGIN);

/// Margin below which the limits of rows take the place of the rows. Orthogonal factors are used below it whatever the pivots: it is
/// twice [`ADAPTIVE_ZONE`], for the estimate is some tenths too large where masses differ.
///
/// At a distance σ the limit leaves out σ/3 of the change of an acceleration per distance, which is odd in σ. What it adds to a
/// velocity on the way in it takes off on the way out, and σ³/10 of a position is left, 1e-10. With its first order it leaves out
/// σ². The rows themselves make δ/σ² of the distance δ of a stage from the constraints.
pub(crate) const LIMIT_ROWS: Law = Law::fixed(1e-3);

/// Margin below which the evaluations of adaptive steps are looked at, far within [`ZONE_OF_FORCES`].
///
/// A stage at a distance x from the constraints has other accelerations by x/σ² where it is carried along, or has limits, than
/// where it has the rows. All stages of a step with the same right-hand side keep its order; one with another costs it. With
/// limits in the whole zone 200 runs in reference points ended within 1.8e-6 m at 1e-9. With this they ended within 4.1e-7 m;
/// at 1e-11 the whole zone took 2.4 times the evaluations.
pub(crate) const ADAPTIVE_ZONE: Law = Law::fixed(5e-4);

/// Least motion of a step in the singular zone, in the reference metric: smaller ones resolve how rods that differ by 1e-14 turn
/// aside there, which rounding decides.
pub(crate) const LEAST_MOTION: Law = Law::fixed(1e-7);

/// Margin from which on nothing is taken for a passage, and the ends of a step are not looked at however fast it goes.
pub(crate) const NO_PASSAGE: Law = Law::fixed(0.1);

/// Margin that rounding adds to it: it makes δ/s² of an acceleration at a distance s, δ the rounding of the rows. 0.17 in single
/// precision, nothing in double. Of 120 step counts of a parallelogram 21 ended wrong without it, with 0.1 one stepped over a singular
/// position unseen, with 0.17 none.
pub(crate) const NO_PASSAGE_ROUNDED: Law = Law::root(500.0);

/// Distance over a reference length within which rounding turns a mechanism aside: rows may be 64 ε off the constraints.
pub(crate) const TURNED: Law = Law::root(8.0);

/// Fourth power of the margin from which on a position leads to the next one, 4 ∜ε. Nearer to the singular position it is found from the
/// last such position.
pub(crate) const LEADS_TO_THE_FOURTH: Law = Law::ulps(256.0);

/// Largest margin at either end of a piece in which the determinant changes its sign.
pub(crate) const PASSES: Law = Law::fourth_root(8.0);

/// Margin at which rounding and the prediction of a piece are in balance. Rounding leaves ε/m of a position open at margin m, and ε/m²
/// of its slope; where a piece is as long as the margin, a prediction is off by rounding as much as by its own third-order term.
pub(crate) const BALANCE: Law = Law::fourth_root(1.0);

/// Singular value of Φ_q in the metric, relative to the largest, below which a row counts as dependent. Rounding is the error of a
/// position on the constraints, and of the factorization: 3e-5 in single precision.
pub(crate) const DEPENDENT: Law = Law::at_least(1e-10, DEPENDENT_ROUNDINGS);

/// Rounding errors that a dependent row, or a combination of rows, may have as a part of its own.
const DEPENDENT_ROUNDINGS: f64 = 256.0;

/// Part of a row outside the span of others, in the metric, and part of a null vector, below which it is none: half the digits.
pub(crate) const OWN_PART: Law = Law::at_least(1e-8, DEPENDENT_ROUNDINGS);

/// Distance by which a state is moved off the constraints to see if the rank rises, in the reference metric. It is far above the
/// residual of a projection, 1e-14, and 64 times the part below which a row counts as dependent, which decides in single precision.
pub(crate) const PROBE: Law = Law::at_least(1e-4, 64.0 * DEPENDENT_ROUNDINGS);

/// Singular value in the metric below which a direction of the free columns is not corrected: declared values may leave rows without
/// any column. Where a residual of rounding is left of a position that loses rank, the singular value is about √ε.
pub(crate) const WEAKEST_OF_START: Law = Law::root(0.125);

/// Singular value below which the second derivative of the rows tells more of a rate than the first: where the error ε/σ² of the one
/// is that of the other, σ.
pub(crate) const DOUBTFUL: Law = Law::cube_root(1.0);

/// Part of the rows' second derivatives that no accelerations answer where the rows lose rank. The singular values left out, at most
/// [`DOUBTFUL`], leave as much for accelerations a thousand times as large as γ.
pub(crate) const UNANSWERED: Law = Law::fixed(1e-2);

/// Smallest over largest pivot below which the LU factors of M and Φ_q are not used.
///
/// In the metric a nearly dependent row of singular value σ leaves a pivot σ²: at 1e-4 the row is dependent to two digits, and the
/// multipliers have lost four of theirs. Orthogonal factors lose two. It may leave two pivots of σ as well, which are looked at.
pub(crate) const LEAST_PIVOT: Law = Law::fixed(1e-4);

/// Smallest over largest pivot from which on no row is nearly dependent: two pivots of σ at [`LIMIT_ROWS`], twenty times.
pub(crate) const SURE_PIVOT: Law = Law::fixed(2e-2);

/// Smallest pivot of the reduced mass over its trace: below it, nothing but rounding moves.
pub(crate) const LEAST_INERTIA: Law = Law::ulps(64.0);

/// Inertia of a free motion over that of all of them which counts as none where no step is accurate enough: a bob of 1 kg on a cart
/// of 1e-6 kg, the lightest of the ready mechanisms, has that much and moves.
pub(crate) const NO_INERTIA: Law = Law::fixed(1e-7);

/// Largest entry of a row of Φ_q that counts as 0, over the entry a thousandth of a reference length away. A row that is flat at a
/// place holds it to the root of the 64 ε that its residual may have; its entries there are 360 √ε of those away from it.
pub(crate) const FLAT: Law = Law::root(512.0);

/// The same where a run starts: the rounding of two points in one place, 64 ε, a thousand times.
pub(crate) const FLAT_AT_START: Law = Law::ulps(64e3);

/// Rate at which a combination of rows changes, of that of the motion, below which it counts as one that follows from others wherever
/// the mechanism is; from it on a row without entries takes hold.
pub(crate) const LEAST_RATE: Law = Law::fixed(1e-6);

/// Rounding errors of a row's terms in a combination of rows, and largest product of two directions that count as orthogonal.
pub(crate) const OF_COMBINATION: Law = Law::ulps(64.0);

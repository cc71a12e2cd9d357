//! A step of fixed size next to a singular position, taken in parts whose error is estimated.
//!
//! A stage is about h²/8 of an acceleration beside the constraints, which makes that over s² of an acceleration at a distance s from a
//! singular position. So a step of about s has errors of the first order in h there, and may end too far beside the rows, or on
//! another branch. Parts of an embedded pair are as small as the passage asks for.

use super::adaptive::{Adaptive, Point};
use super::dormand_prince8::DormandPrince8;
use super::limit_rows::passes_within;
use super::metric::Tolerance;
use super::model::{Formulation, Model};
use super::motion::{Equations, Instant, Moving};
use crate::{Dynamic, Failure, Real};

/// Margin of a step's ends from which on it is not looked at, however fast it goes.
pub(super) const NEAR: f64 = 0.1;

/// Steps between a singular position and a step that is next to it: a four-bar of 60 J keeps its energy to 1e-7 J then, and to 2e-3 J
/// where only steps over the position are taken in parts.
const STEPS: f64 = 3.0;

/// Tolerances of the parts, one after the other until one of them leads through: what a step of 1e-3 of a period leaves, and what rounding
/// of the rows lets through in any set of coordinates.
const TOLERANCES: [f64; 2] = [1e-10, 1e-9];

/// Rows of a text whose steps are taken in parts at most: an evaluation next to a singular position factorizes several times, at a cost of
/// the third order in them. Ten seconds of forty loops, 81 rows, took more than eight minutes in tests, 20 s without parts.
pub(super) const MOST_ROWS: usize = 32;

/// Parts that a step may be taken in: the smallest ones in the zone of a singular position, 1e-7 of a reference length, lead a
/// thousandth of it far.
const MOST_PARTS: u32 = 10_000;

/// Whether a step of `h` (s) that begins with `from` comes next to a singular position.
#[cold]
#[inline(never)]
pub(super) fn is_next_to_singular_position<S, R, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    from: &Instant<R, N, M, S::States>,
    h: R,
) -> bool
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    passes_within(model, (from.t, &from.y), (R::constant(STEPS) * h, R::constant(NEAR)))
}

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// The end, at `until` (s), of a step from `start` that is taken in parts.
    #[cold]
    #[inline(never)]
    pub(super) fn in_parts(
        &mut self,
        start: Point<R, Moving<S, R, N, M>>,
        until: R,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let mut failed = None;
        for tolerance in TOLERANCES {
            let tolerance = R::constant(tolerance).max(Tolerance::least());
            self.divide(Tolerance { relative: tolerance, absolute: tolerance });
            let mut parts = 0;
            let run = Adaptive::default().run::<DormandPrince8, _>(
                self,
                start,
                until,
                |_| None,
                |_, part| {
                    parts += 1;
                    let step = (part.end.t - part.start.t).to_f64();
                    let time = part.end.t.to_f64();
                    if parts < MOST_PARTS { Ok(true) } else { Err(Failure::StepTooSmall { step, time }) }
                },
            );
            match run.and_then(|end| Ok((end, self.solve(until, &end.y)?))) {
                Ok((end, solved)) => {
                    let next = Instant { t: until, y: end.y.y, solved, carried: solved.rate.qd };
                    return Ok(next);
                }
                Err(failure) => failed = failed.or(Some(failure)),
            }
        }
        Err(failed.unwrap_or(Failure::StepTooSmall { step: 0.0, time: until.to_f64() }))
    }
}

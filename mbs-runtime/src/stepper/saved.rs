//! A state as plain numbers and bytes, and the way back into motion after a reset.

use core::fmt::Debug;

use crate::block_solvers::convergence::Statistics;
use crate::failure::checks::{coordinate_failure, entry, time_failure, variable_failure};
use crate::failure::{Failure, FailureKind};
use crate::kinematics::homotopy::{Anchor, EVALUATIONS, Homotopy, leads, put_short_way_round};
use crate::kinematics::least_squares_assembly::solve_nearest;
use crate::kinematics::position::solve_with_position;
use crate::linear_algebra::vectors::largest_difference;
use crate::mechanism::saved_variables::Kept;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::stepper::instant::{Predecessor, SolvedPosition};
use crate::stepper::state::StepperState;
use crate::stepper::whole_turns::Turns;
use crate::tolerances::positions;

/// Version of the layout of [`Saved`], in its first bytes. Neither erased (0xFF) nor zeroed memory has it.
const VERSION: u32 = 4;

/// Words of [`Saved`] besides coordinates and values: version and count of coordinates, count of values, mechanism, two times,
/// check value.
const OTHER_WORDS: usize = 6;

/// Largest distance from a saved position at which [`Stepper::assemble_near`] accepts one, in the reference metric
/// (rad, or reference lengths).
///
/// Newton's method is not trusted with more in one step either: beyond it the assembly next to the saved position may
/// be another one.
pub const NEAR: f64 = 0.5;

/// Time and position of a mechanism, and the values that drive it there, as plain numbers, `f64` for every number type. They
/// are the data that must survive a reset.
///
/// `V` is an array of `f64`, one for each variable: parameters, inputs (thrice with rates) and phases (thrice). It has them
/// at the position, and at the last position that leads on, if that is another one. Next to a change point the path begins
/// there. Whole turns are stored in addition to the position.
///
/// As bytes: [`BYTES`](Self::BYTES) of them, little-endian words of eight, the last one a check value over the
/// others.
///
/// ```
/// use mbs_runtime::{Mechanism, Saved, Stepper, mechanism};
///
/// # mechanism! {
/// #     /// A crank and a rod that slides along x.
/// #     pub mechanism Crank;
/// #     param r: m = 50mm;
/// #     coord theta: rad = 0;
/// #     coord phi: rad = 0;
/// #     coord x: m = 0.23;
/// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
/// #     drive motor: theta == 30 [rad/s]*t;
/// #     branch ahead: cos(phi) > 0;
/// # }
///
/// let crank: Crank = Crank::default();
/// let guess = crank.guess(&crank.parameters());
/// let mut motion = Stepper::assemble(crank, guess, 0.0)?;
/// motion.advance(0.01)?;
///
/// let mut page = [0_u8; 256];
/// let length = motion.save().to_le_bytes_into(&mut page).expect("the page is large enough");
/// let saved = Saved::from_le_bytes(&page[..length]).expect("no byte has changed");
/// let again = Stepper::assemble_near(crank, &saved, motion.t())?;
/// assert_eq!(again.q(), motion.q());
/// page[8] ^= 1;
/// assert!(Saved::<3, <Crank as Mechanism<f64, 3, 3>>::Kept>::from_le_bytes(&page[..length]).is_none());
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saved<const N: usize, V: Kept> {
    mechanism: u64,
    turns: [i64; N],
    at: Place<N, V>,
    /// The last position that leads on.
    from: Place<N, V>,
}

/// A position with all that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place<const N: usize, V> {
    t: f64,
    q: [f64; N],
    values: V,
}

impl<const N: usize, V: Kept> Place<N, V> {
    const ZEROS: Self = Place { t: 0.0, q: [0.0; N], values: V::ZEROS };

    fn words(&self) -> impl Iterator<Item = u64> {
        let numbers = [self.t].into_iter().chain(self.q).chain(self.values.as_ref().iter().copied());
        numbers.map(f64::to_bits)
    }

    fn read(words: &mut impl Iterator<Item = u64>) -> Option<Self> {
        let mut place = Self::ZEROS;
        let numbers = [&mut place.t].into_iter().chain(&mut place.q).chain(place.values.as_mut());
        let mut finite = true;
        for number in numbers {
            *number = f64::from_bits(words.next()?);
            finite &= number.is_finite();
        }
        finite.then_some(place)
    }

    /// As numbers of a mechanism, whose variables take the place of `values`.
    fn anchor<R: Real, S: AsMut<[R]>>(&self, mut values: S) -> Anchor<S, R, N> {
        let kept = values.as_mut().iter_mut().zip(self.values.as_ref());
        kept.for_each(|(value, kept)| *value = R::constant(*kept));
        Anchor { t: R::constant(self.t), q: self.q.map(R::constant), values }
    }

    fn of<R: Real, S: AsRef<[R]>>(anchor: &Anchor<S, R, N>) -> Self {
        let mut values = V::ZEROS;
        let kept = values.as_mut().iter_mut().zip(anchor.values.as_ref());
        kept.for_each(|(kept, value)| *kept = value.to_f64());
        Place { t: anchor.t.to_f64(), q: anchor.q.map(R::to_f64), values }
    }
}

impl<const N: usize, V: Kept> Saved<N, V> {
    /// Length in bytes: 48 + 24 N + 16 V.
    pub const BYTES: usize = 8 * (3 * N + 2 * V::COUNT + OTHER_WORDS);

    /// Time (s).
    pub fn t(&self) -> f64 {
        self.at.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[f64; N] {
        &self.at.q
    }

    /// Parameters, inputs and phases at the position, in the order of [`VARIABLES`](Mechanism::VARIABLES).
    pub fn values(&self) -> &[f64] {
        self.at.values.as_ref()
    }

    /// Whole turns of the coordinates that the text declares as `turn`, in addition to [`q`](Self::q); 0 of all others: N.
    pub fn turns(&self) -> &[i64; N] {
        &self.turns
    }

    /// Writes [`BYTES`](Self::BYTES) bytes to the beginning of `bytes` and returns their number; `None`, and nothing
    /// written, where there is no room.
    pub fn to_le_bytes_into(&self, bytes: &mut [u8]) -> Option<usize> {
        let (chunks, _) = bytes.get_mut(..Self::BYTES)?.as_chunks_mut::<8>();
        let words = self.words().chain([self.check_value()]);
        chunks.iter_mut().zip(words).for_each(|(chunk, word)| *chunk = word.to_le_bytes());
        Some(Self::BYTES)
    }

    /// Reads a state from the beginning of `bytes`; `None` where they are too few, of another version or number of
    /// coordinates or values, or damaged, and where a number is NaN or infinite.
    pub fn from_le_bytes(bytes: &[u8]) -> Option<Self> {
        let (chunks, _) = bytes.get(..Self::BYTES)?.as_chunks::<8>();
        let mut words = chunks.iter().map(|chunk| u64::from_le_bytes(*chunk));
        let header = [words.next()?, words.next()?];
        let mechanism = words.next()?;
        let mut turns = [0; N];
        turns.iter_mut().zip(&mut words).for_each(|(turns, word)| *turns = word.cast_signed());
        let (at, from) = (Place::read(&mut words)?, Place::read(&mut words)?);
        let saved = Saved { mechanism, turns, at, from };
        let whole = header == Self::header() && words.next()? == saved.check_value();
        whole.then_some(saved)
    }

    /// Version and number of coordinates, number of values.
    fn header() -> [u64; 2] {
        [u64::from(VERSION) | ((N as u64) << 32), V::COUNT as u64]
    }

    /// All words but the check value.
    fn words(&self) -> impl Iterator<Item = u64> {
        let header = Self::header().into_iter().chain([self.mechanism]);
        header.chain(self.turns.map(i64::cast_unsigned)).chain(self.at.words()).chain(self.from.words())
    }

    fn check_value(&self) -> u64 {
        self.words().fold(OFFSET, |hash, word| hashed(hash, &word.to_le_bytes()))
    }
}

/// FNV-1a, 64 bits: any change of one byte changes it, others with a chance of all but 2⁻⁶⁴.
/// Source: Fowler, Noll, Vo 1991.
const OFFSET: u64 = 0xCBF2_9CE4_8422_2325;
const PRIME: u64 = 0x0100_0000_01B3;

fn hashed(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(PRIME))
}

/// Name, scene, coordinates, rows and variables of a mechanism as one number; the end of each name counts.
fn fingerprint<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>() -> u64 {
    let name = |hash, name: &str| hashed(hashed(hash, name.as_bytes()), &[0xFF]);
    let entries = S::COORDINATES.iter().chain(S::ROWS).chain(S::VARIABLES);
    entries.fold(name(name(OFFSET, S::NAME), S::SCENE), |hash, entry| name(hash, entry.name))
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Time, position and the values that drive it there, to survive a reset; see [`assemble_near`](Self::assemble_near).
    ///
    /// Changes that wait for a step are not in it.
    pub fn save(&self) -> Saved<N, S::Kept> {
        let StepperState { t, q, margin, .. } = self.state;
        let values = if self.changed && leads(margin) { self.anchor.values } else { self.mechanism.values() };
        let at = Anchor { t, q, values };
        let from = if self.led || !leads(margin) { &self.anchor } else { &at };
        let mechanism = fingerprint::<S, R, N, M>();
        Saved { mechanism, turns: *self.turns(), at: Place::of(&at), from: Place::of(from) }
    }

    /// Assembles `mechanism` at time `t` (s) next to a saved state; velocity and acceleration follow.
    ///
    /// Follows the homotopy to this time and to the parameters and inputs of `mechanism`. It begins at the saved position, or
    /// at the last one that led on before it. The assembly is kept as by a step (see [`advance_to`](Self::advance_to)), at
    /// most [`NEAR`] away in any coordinate. Branches that only pick the first assembly are not tested again. At the time and
    /// the values of the saved state the position is the same to rounding; a drive that has moved on since counts as
    /// distance, whole turns included.
    ///
    /// # Errors
    /// [`FailureKind::MechanismMismatch`] for the state of another mechanism, [`FailureKind::TooFar`], [`FailureKind::WrongBranch`],
    /// [`FailureKind::NotAssemblable`], [`FailureKind::NotFollowed`], [`FailureKind::Singular`], [`FailureKind::Unresolved`],
    /// [`FailureKind::BeyondLimit`]; [`FailureKind::NonFinite`] for a parameter, input or time that is no number.
    pub fn assemble_near(mut mechanism: S, saved: &Saved<N, S::Kept>, t: R) -> Result<Self, Failure> {
        if saved.mechanism != fingerprint::<S, R, N, M>() {
            return Err(FailureKind::MechanismMismatch { mechanism: S::NAME }.without_time());
        }
        let start = saved.at.q.map(R::constant);
        let parameters = mechanism.parameters();
        let scales = mechanism.coordinate_scales(&parameters);
        let broken = variable_failure(&mechanism)
            .or(time_failure(t))
            .or_else(|| coordinate_failure::<S, R, N, _>(&start, &scales, t));
        if let Some(failure) = broken {
            return Err(failure);
        }
        mechanism.start_phases(&start, R::constant(saved.at.t));
        let reset = mechanism.values();
        mechanism.advance_phases(R::constant(saved.at.t), t);
        let [at, mut from] = [saved.at, saved.from].map(|place| place.anchor(reset));
        let values = mechanism.values();
        let kept = from.values.as_mut();
        put_short_way_round(S::TURNING_INPUTS, kept, at.values.as_ref(), values.as_ref());
        let stands = t == at.t && same(at.values.as_ref(), values.as_ref());
        let led = if stands { None } else { led(&mut mechanism, &from, t) };
        let (q, statistics) = match led {
            Some(led) => led,
            None => solve_nearest(&mechanism, &parameters, &start, t)?,
        };
        if let Some(failure) = distant::<S, R, N, M>(&q, &start, &scales, t) {
            return Err(failure);
        }
        let position = mechanism.position(&parameters, &q, t);
        let found = SolvedPosition { t, q, position, statistics, open: None };
        let state = StepperState::at(&mechanism, &parameters, found, Predecessor::Saved)?;
        if led.is_none() && !stands {
            // A position is near, but nothing tells that it is in the assembly.
            return Err(FailureKind::not_followed(0.0, state.margin).at(t.to_f64()));
        }
        let mut stepper = Self::at(mechanism, parameters, state, Turns::new(saved.turns, t));
        if !leads(stepper.state.margin) {
            stepper.anchor = from;
        }
        stepper.take_turns_off();
        Ok(stepper)
    }
}

/// `true` if the values are those that were saved.
fn same<R: Real>(saved: &[R], values: &[R]) -> bool {
    let rounding = positions::OF_SAVED.of::<R>();
    saved.iter().zip(values).all(|(saved, value)| (*saved - *value).abs() <= rounding * saved.abs())
}

/// The position at `t` (s) to which the path from a saved one leads, if it does, with its statistics.
fn led<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &mut S,
    from: &Anchor<S::Values, R, N>,
    t: R,
) -> Option<([R; N], Statistics)> {
    let values = mechanism.values();
    let end = Homotopy { from, mechanism, values, t }.followed(R::constant(1.0), EVALUATIONS);
    if end.share < R::constant(1.0) {
        return None;
    }
    let parameters = mechanism.parameters();
    let (q, _, last) = solve_with_position(mechanism, &parameters, &end.q, t).ok()?;
    let scales = mechanism.coordinate_scales(&parameters);
    let correction = largest_difference(&q, &from.q, &scales).to_f64();
    let evaluations = end.evaluations.saturating_add(last.evaluations);
    Some((q, Statistics { evaluations, correction, fallback: true, ..last }))
}

/// The coordinate that is farthest from where it was saved, if that is too far.
fn distant<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    q: &[R; N],
    saved: &[R; N],
    scales: &[R; N],
    t: R,
) -> Option<Failure> {
    let (mut farthest, mut distance) = (0_u16, 0.0_f64);
    for (index, ((new, old), scale)) in (0_u16..).zip(q.iter().zip(saved).zip(scales)) {
        let off = ((*new - *old) / *scale).abs().to_f64();
        if distance < off {
            (farthest, distance) = (index, off);
        }
    }
    let coordinate = entry(S::COORDINATES, farthest);
    (distance > NEAR).then_some(FailureKind::TooFar { coordinate, distance, allowed: NEAR }.at(t.to_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;

    type State = Saved<2, [f64; 1]>;

    const SAVED: State = Saved {
        mechanism: 7,
        turns: [-3, 0],
        at: Place { t: 1.5, q: [-0.25, 1e300], values: [0.125] },
        from: Place { t: 1.25, q: [-0.5, 1e299], values: [-2.0] },
    };

    /// Bytes of the state.
    const LENGTH: usize = 112;

    fn bytes() -> [u8; State::BYTES] {
        let mut bytes = [0; State::BYTES];
        assert_eq!(SAVED.to_le_bytes_into(&mut bytes), Some(LENGTH));
        bytes
    }

    #[test]
    fn bytes_come_back_as_the_same_numbers() {
        assert_eq!(Saved::from_le_bytes(&bytes()), Some(SAVED));
        let mut page = [0xFF; LENGTH + 16];
        assert_eq!(SAVED.to_le_bytes_into(&mut page), Some(LENGTH));
        assert_eq!((Saved::from_le_bytes(&page), page[LENGTH..] == [0xFF; 16]), (Some(SAVED), true));
        assert_eq!(bytes()[..12], [4, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0]);
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        for index in 0..LENGTH {
            for bit in 0..8 {
                let mut damaged = bytes();
                damaged[index] ^= 1 << bit;
                assert_eq!(State::from_le_bytes(&damaged), None, "bit {bit} of byte {index}");
            }
        }
        // The signs of two coordinates at once.
        let mut damaged = bytes();
        damaged[55] ^= 0x80;
        damaged[63] ^= 0x80;
        assert_eq!(State::from_le_bytes(&damaged), None);
    }

    #[test]
    fn bytes_that_are_no_state_give_none() {
        let bytes = bytes();
        assert_eq!(State::from_le_bytes(&bytes[..LENGTH - 1]), None);
        assert_eq!(State::from_le_bytes(&[]), None);
        // Another number of coordinates, of values.
        assert_eq!(Saved::<1, [f64; 1]>::from_le_bytes(&bytes), None);
        assert_eq!(Saved::<2, [f64; 0]>::from_le_bytes(&bytes), None);
        assert_eq!(State::from_le_bytes(&[0; LENGTH]).or(Saved::from_le_bytes(&[0xFF; LENGTH])), None);
        assert_eq!(SAVED.to_le_bytes_into(&mut [0; LENGTH - 1]), None);
        let mut bytes = [0; LENGTH];
        let no_number = Place { values: [f64::NAN], ..SAVED.at };
        let _ = Saved { at: no_number, ..SAVED }.to_le_bytes_into(&mut bytes);
        assert_eq!(State::from_le_bytes(&bytes), None);
        let _ = Saved { from: no_number, ..SAVED }.to_le_bytes_into(&mut bytes);
        assert_eq!(State::from_le_bytes(&bytes), None);
    }
}

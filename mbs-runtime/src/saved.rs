//! A state as plain numbers and bytes, and the way back into motion after a reset.

use crate::instant::{Before, Found};
use crate::kinematics::{coordinate_failure, entry, time_failure, variable_failure};
use crate::nearest::solve_nearest;
use crate::stepper::State;
use crate::turns::Turns;
use crate::{Failure, Kinematic, Mechanism, Real, Stepper};

/// Version of the layout of [`Saved`], in its first bytes. Neither erased (0xFF) nor zeroed memory has it.
const VERSION: u32 = 3;

/// Words of [`Saved`] beside the coordinates: version and count, mechanism, time, check value.
const OTHER_WORDS: usize = 4;

/// Largest distance from a saved position at which [`Stepper::assemble_near`] accepts one, in the reference metric
/// (rad, or reference lengths).
///
/// Newton's method is not trusted with more in one step either: beyond it the assembly next to the saved position may
/// be another one.
pub const NEAR: f64 = 0.5;

/// Time and position of a mechanism as plain numbers, `f64` for every number type: what a reset must not lose.
///
/// The phases of drives that prescribe a rate are in the position: each is what its drive holds there. Whole turns are beside
/// it.
///
/// As bytes: [`BYTES`](Self::BYTES) of them, little-endian words of eight, the last one a check value over the
/// others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saved<const N: usize> {
    mechanism: u64,
    t: f64,
    q: [f64; N],
    turns: [i64; N],
}

impl<const N: usize> Saved<N> {
    /// Length in bytes: 32 + 16 N.
    pub const BYTES: usize = 8 * (2 * N + OTHER_WORDS);

    /// Time (s).
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[f64; N] {
        &self.q
    }

    /// Whole turns of the coordinates that the text declares as `turn`, beside what [`q`](Self::q) has; 0 of all others: N.
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
    /// coordinates, or damaged, and where a number is NaN or infinite.
    pub fn from_le_bytes(bytes: &[u8]) -> Option<Self> {
        let (chunks, _) = bytes.get(..Self::BYTES)?.as_chunks::<8>();
        let mut words = chunks.iter().map(|chunk| u64::from_le_bytes(*chunk));
        let header = words.next()?;
        let mechanism = words.next()?;
        let t = f64::from_bits(words.next()?);
        let mut q = [0.0; N];
        q.iter_mut().zip(&mut words).for_each(|(coordinate, word)| *coordinate = f64::from_bits(word));
        let mut turns = [0; N];
        turns.iter_mut().zip(&mut words).for_each(|(turns, word)| *turns = word.cast_signed());
        let saved = Saved { mechanism, t, q, turns };
        let whole = header == Self::header() && words.next()? == saved.check_value();
        let finite = q.iter().fold(t.is_finite(), |all, coordinate| all & coordinate.is_finite());
        (whole && finite).then_some(saved)
    }

    /// Version and number of coordinates.
    fn header() -> u64 {
        u64::from(VERSION) | ((N as u64) << 32)
    }

    /// All words but the check value.
    fn words(&self) -> impl Iterator<Item = u64> {
        let header = [Self::header(), self.mechanism, self.t.to_bits()].into_iter();
        header.chain(self.q.map(f64::to_bits)).chain(self.turns.map(i64::cast_unsigned))
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

/// Name, scene, coordinates and rows of a mechanism as one number; the end of each name counts.
fn fingerprint<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>() -> u64 {
    let name = |hash, name: &str| hashed(hashed(hash, name.as_bytes()), &[0xFF]);
    let entries = S::COORDINATES.iter().chain(S::ROWS);
    entries.fold(name(name(OFFSET, S::NAME), S::SCENE), |hash, entry| name(hash, entry.name))
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Time and position, to survive a reset; see [`assemble_near`](Self::assemble_near).
    pub fn save(&self) -> Saved<N> {
        let state = &self.state;
        let (t, q) = (state.t.to_f64(), state.q.map(R::to_f64));
        Saved { mechanism: fingerprint::<S, R, N, M>(), t, q, turns: *self.turns() }
    }

    /// Assembles `mechanism` at time `t` (s) next to a saved state; velocity and acceleration follow.
    ///
    /// Levenberg–Marquardt from the saved position, and from there alone: the assembly is the one that it leads to, at
    /// most [`NEAR`] away in any coordinate. Branches that only pick the first assembly are not asked again. With
    /// the time and the inputs at which the state was saved the position is the same to rounding; a drive that has
    /// moved on since counts as distance, whole turns included.
    ///
    /// # Errors
    /// [`Failure::Foreign`] for the state of another mechanism, [`Failure::TooFar`], [`Failure::WrongBranch`],
    /// [`Failure::NotAssemblable`], [`Failure::Singular`], [`Failure::Unresolved`], [`Failure::BeyondLimit`];
    /// [`Failure::NonFinite`] for a parameter, input or time that is no number.
    pub fn assemble_near(mut mechanism: S, saved: &Saved<N>, t: R) -> Result<Self, Failure> {
        if saved.mechanism != fingerprint::<S, R, N, M>() {
            return Err(Failure::Foreign { mechanism: S::NAME });
        }
        let start = saved.q.map(R::constant);
        let parameters = mechanism.parameters();
        let scales = mechanism.coordinate_scales(&parameters);
        let broken = variable_failure(&mechanism)
            .or(time_failure(t))
            .or_else(|| coordinate_failure::<S, R, N, _>(&start, &scales, t));
        if let Some(failure) = broken {
            return Err(failure);
        }
        mechanism.start_phases(&start, R::constant(saved.t));
        mechanism.advance_phases(R::constant(saved.t), t);
        let (q, statistics) = solve_nearest(&mechanism, &parameters, &start, t)?;
        if let Some(failure) = distant::<S, R, N, M>(&q, &start, &scales, t) {
            return Err(failure);
        }
        let position = mechanism.position(&parameters, &q, t);
        let found = Found { t, q, position, statistics, open: None };
        let state = State::at(&mechanism, &parameters, found, Before::Saved)?;
        let mut stepper = Self::at(mechanism, parameters, state, Turns::new(saved.turns, t));
        stepper.take_turns_off();
        Ok(stepper)
    }
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
    (distance > NEAR).then_some(Failure::TooFar { coordinate, distance, allowed: NEAR, time: t.to_f64() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAVED: Saved<2> = Saved { mechanism: 7, t: 1.5, q: [-0.25, 1e300], turns: [-3, 0] };

    fn bytes() -> [u8; Saved::<2>::BYTES] {
        let mut bytes = [0; Saved::<2>::BYTES];
        assert_eq!(SAVED.to_le_bytes_into(&mut bytes), Some(64));
        bytes
    }

    #[test]
    fn bytes_come_back_as_the_same_numbers() {
        assert_eq!(Saved::from_le_bytes(&bytes()), Some(SAVED));
        let mut page = [0xFF; 80];
        assert_eq!(SAVED.to_le_bytes_into(&mut page), Some(64));
        assert_eq!((Saved::from_le_bytes(&page), page[64..] == [0xFF; 16]), (Some(SAVED), true));
        assert_eq!(bytes()[..8], [3, 0, 0, 0, 2, 0, 0, 0]);
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        for index in 0..64 {
            for bit in 0..8 {
                let mut damaged = bytes();
                damaged[index] ^= 1 << bit;
                assert_eq!(Saved::<2>::from_le_bytes(&damaged), None, "bit {bit} of byte {index}");
            }
        }
        // The signs of two coordinates at once.
        let mut damaged = bytes();
        damaged[31] ^= 0x80;
        damaged[39] ^= 0x80;
        assert_eq!(Saved::<2>::from_le_bytes(&damaged), None);
    }

    #[test]
    fn what_is_not_a_state_is_none() {
        let bytes = bytes();
        assert_eq!(Saved::<2>::from_le_bytes(&bytes[..63]), None);
        assert_eq!(Saved::<2>::from_le_bytes(&[]), None);
        assert_eq!((Saved::<3>::from_le_bytes(&bytes), Saved::<1>::from_le_bytes(&bytes)), (None, None));
        assert_eq!(Saved::<2>::from_le_bytes(&[0; 64]).or(Saved::from_le_bytes(&[0xFF; 64])), None);
        assert_eq!(SAVED.to_le_bytes_into(&mut [0; 63]), None);
        let mut bytes = [0; 48];
        let _ = Saved { q: [f64::NAN, 0.0], ..SAVED }.to_le_bytes_into(&mut bytes);
        assert_eq!(Saved::<2>::from_le_bytes(&bytes), None);
    }
}

//! Operations of long irregular functions as data: one loop works through them, where code of as many lines would keep a
//! compiler busy for minutes.
//!
//! A tape is a row of runs, each of one operation. A run has its opcode (1 byte), the number of the array that it reads (2
//! bytes), and the number of its rounds (2 bytes). Its operands follow, round by round. The result of a round follows all
//! earlier results. Numbers of values take 2 bytes, places in arrays 3, the lowest first. The operations are those of
//! straight code, so the results have the same bits.

use core::cell::Cell;
use core::slice::from_ref;

use crate::scalar::number::Scalar;

/// Angles that are taken at once.
const SIDE_BY_SIDE: usize = 8;

/// Works through a tape.
///
/// `arrays`: inputs; `values`: room for all results; `passed`: values of other parts, read and written. Entries that a tape
/// lacks, and places that do not exist, count as 0: no tape that the macro writes has any.
#[inline(never)]
pub fn run<T: Scalar>(mut tape: &[u8], arrays: &[&[T]], values: &mut [T], passed: &[Cell<T>]) {
    let values = Cell::from_mut(values).as_slice_of_cells();
    let mut machine = Machine { values, next: 0 };
    while let Some(([opcode, low, high, few, many], behind)) = tape.split_first_chunk() {
        let array = usize::from(u16::from_le_bytes([*low, *high]));
        let rounds = usize::from(u16::from_le_bytes([*few, *many]));
        let Some((round, behind)) = behind.split_at_checked(width(*opcode).saturating_mul(rounds)) else {
            return;
        };
        tape = behind;
        match opcode {
            b'@' => machine.read(arrays.get(array).copied().unwrap_or_default(), round),
            b'<' => machine.read_passed(passed, round),
            b'>' => machine.pass(passed, round),
            b'#' => machine.numbers(round),
            _ => machine.compute(*opcode, round),
        }
    }
}

/// Bytes that a round of an operation takes.
fn width(opcode: u8) -> usize {
    match opcode {
        b'@' | b'<' => 3,
        b'>' => 5,
        b'#' | b'?' => 8,
        b'+' | b'-' | b'*' | b'/' | b'^' | b'2' | b'm' | b'M' | b'h' => 4,
        _ => 2,
    }
}

/// The place of 3 bytes.
#[inline(always)]
fn place([low, middle, high]: [u8; 3]) -> usize {
    u32::from_le_bytes([low, middle, high, 0]) as usize
}

/// Values computed so far.
struct Machine<'a, T> {
    values: &'a [Cell<T>],
    next: usize,
}

impl<'a, T: Scalar> Machine<'a, T> {
    /// Room for the next values.
    #[inline(always)]
    fn room(&mut self, count: usize) -> &'a [Cell<T>] {
        let room = self.values.get(self.next..).unwrap_or_default();
        self.next = self.next.saturating_add(count);
        room.get(..count).unwrap_or(room)
    }

    /// The value of a number.
    #[inline(always)]
    fn value(&self, low: u8, high: u8) -> T {
        let value = self.values.get(usize::from(u16::from_le_bytes([low, high])));
        value.map_or(T::constant(0.0), Cell::get)
    }

    fn read(&mut self, array: &[T], round: &[u8]) {
        let (places, _) = round.as_chunks();
        for (value, of) in self.room(places.len()).iter().zip(places) {
            value.set(array.get(place(*of)).map_or(T::constant(0.0), |element| *element));
        }
    }

    fn read_passed(&mut self, passed: &[Cell<T>], round: &[u8]) {
        let (places, _) = round.as_chunks();
        for (value, of) in self.room(places.len()).iter().zip(places) {
            value.set(passed.get(place(*of)).map_or(T::constant(0.0), Cell::get));
        }
    }

    fn numbers(&mut self, round: &[u8]) {
        let (numbers, _) = round.as_chunks();
        for (value, number) in self.room(numbers.len()).iter().zip(numbers) {
            value.set(T::constant(f64::from_le_bytes(*number)));
        }
    }

    fn pass(&self, passed: &[Cell<T>], round: &[u8]) {
        let (pairs, _) = round.as_chunks();
        for [low, high, to, middle, top] in pairs {
            if let Some(passed) = passed.get(place([*to, *middle, *top])) {
                passed.set(self.value(*low, *high));
            }
        }
    }

    fn compute(&mut self, opcode: u8, round: &[u8]) {
        match opcode {
            b'+' => self.of_two(round, |a, b| a + b),
            b'-' => self.of_two(round, |a, b| a - b),
            b'*' => self.of_two(round, |a, b| a * b),
            b'/' => self.of_two(round, |a, b| a / b),
            b'^' => self.of_two(round, T::powf),
            b'2' => self.of_two(round, T::atan2),
            b'm' => self.of_two(round, T::min),
            b'M' => self.of_two(round, T::max),
            b'h' => self.of_two(round, T::hypot),
            b'~' => self.of_one(round, |a| -a),
            b'r' => self.of_one(round, T::sqrt),
            b'e' => self.of_one(round, T::exp),
            b'l' => self.of_one(round, T::ln),
            b't' => self.of_one(round, T::tan),
            b'S' => self.of_one(round, T::asin),
            b'C' => self.of_one(round, T::acos),
            b'T' => self.of_one(round, T::atan),
            b'i' => self.of_one(round, T::sinh),
            b'o' => self.of_one(round, T::cosh),
            b'a' => self.of_one(round, T::tanh),
            b'I' => self.of_one(round, T::asinh),
            b'O' => self.of_one(round, T::acosh),
            b'A' => self.of_one(round, T::atanh),
            b'|' => self.of_one(round, T::abs),
            b'g' => self.of_one(round, T::sign),
            b'c' => self.sines_and_cosines(round),
            b'?' => self.selected(round),
            _ => {}
        }
    }

    #[inline(always)]
    fn of_one(&mut self, round: &[u8], function: impl Fn(T) -> T) {
        let (numbers, _) = round.as_chunks();
        for (value, [low, high]) in self.room(numbers.len()).iter().zip(numbers) {
            value.set(function(self.value(*low, *high)));
        }
    }

    #[inline(always)]
    fn of_two(&mut self, round: &[u8], function: impl Fn(T, T) -> T) {
        let (numbers, _) = round.as_chunks();
        for (value, [low, high, other_low, other_high]) in self.room(numbers.len()).iter().zip(numbers) {
            value.set(function(self.value(*low, *high), self.value(*other_low, *other_high)));
        }
    }

    /// The third where the first is less than the second, else the fourth.
    fn selected(&mut self, round: &[u8]) {
        let (numbers, _) = round.as_chunks();
        for (value, [a, b, c, d, e, f, g, h]) in self.room(numbers.len()).iter().zip(numbers) {
            let is_less = self.value(*a, *b).less(self.value(*c, *d));
            value.set(T::select(is_less, self.value(*e, *f), self.value(*g, *h)));
        }
    }

    /// All sines, then all cosines: as many as a processor takes at once, then the rest.
    fn sines_and_cosines(&mut self, round: &[u8]) {
        let (angles, _) = round.as_chunks();
        let (sines, last_sines) = self.room(angles.len()).as_chunks::<SIDE_BY_SIDE>();
        let (cosines, last_cosines) = self.room(angles.len()).as_chunks::<SIDE_BY_SIDE>();
        let (angles, last_angles) = angles.as_chunks::<SIDE_BY_SIDE>();
        for ((sines, cosines), angles) in sines.iter().zip(cosines).zip(angles) {
            self.of_angles(sines, cosines, angles);
        }
        for ((sine, cosine), angle) in last_sines.iter().zip(last_cosines).zip(last_angles) {
            self.of_angles(from_ref(sine), from_ref(cosine), &[*angle]);
        }
    }

    #[inline(always)]
    fn of_angles<const K: usize>(&self, sines: &[Cell<T>], cosines: &[Cell<T>], angles: &[[u8; 2]; K]) {
        let found = T::sin_cos_called(angles.map(|[low, high]| self.value(low, high)));
        sines.iter().zip(found.0).for_each(|(place, sine)| place.set(sine));
        cosines.iter().zip(found.1).for_each(|(place, cosine)| place.set(cosine));
    }
}

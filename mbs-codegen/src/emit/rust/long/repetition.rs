//! Repetitions within a sequence.

use std::ops::Range;

use crate::emit::rust::lengths::Lengths;

/// A stretch of a sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// Elements in their order.
    Once(Range<usize>),
    /// Several rounds of elements, each like the first one.
    Rounds {
        /// Index at which the first round begins.
        first: usize,
        /// Length of a round.
        length: usize,
        /// Number of rounds.
        rounds: usize,
    },
}

/// Before: a sequence. After: its stretches in order. Rounds have at most `longest` elements, as many as possible at each
/// place. Elements between them `weigh` at most `longest` at once.
///
/// Linear in the sequence where it repeats itself, `longest` times that where it does not.
pub fn stretches(
    sequence: &[usize],
    weigh: impl Fn(usize) -> usize,
    longest: usize,
    lengths: Lengths,
) -> Vec<Stretch> {
    let mut stretches = Vec::new();
    let (mut open, mut here) = (0, 0);
    // Weight of all elements before each one.
    let before: Vec<usize> = (0..=sequence.len())
        .scan(0, |sum, index| {
            let before = *sum;
            *sum += weigh(index);
            Some(before)
        })
        .collect();
    while here < sequence.len() {
        match rounds(sequence, &before, here, longest, lengths) {
            Some((length, rounds)) => {
                once(open..here, (&weigh, longest), &mut stretches);
                stretches.push(Stretch::Rounds { first: here, length, rounds });
                here += length * rounds;
                open = here;
            }
            None => here += 1,
        }
    }
    once(open..here, (&weigh, longest), &mut stretches);
    stretches
}

fn once(
    range: Range<usize>,
    (weigh, longest): (&impl Fn(usize) -> usize, usize),
    stretches: &mut Vec<Stretch>,
) {
    let (mut start, mut weight) = (range.start, 0);
    for index in range.clone() {
        weight += weigh(index);
        if weight > longest && index > start {
            stretches.push(Stretch::Once(start..index));
            (start, weight) = (index, weigh(index));
        }
    }
    if start < range.end {
        stretches.push(Stretch::Once(start..range.end));
    }
}

/// Length and number of the rounds from `here` on that cover most of the sequence; the shortest of several. All elements
/// `before` one weigh as much as its entry there.
fn rounds(
    sequence: &[usize],
    before: &[usize],
    here: usize,
    longest: usize,
    lengths: Lengths,
) -> Option<(usize, usize)> {
    let rest = sequence.get(here..)?;
    let weight = |count: usize| Some(before.get(here + count)?.saturating_sub(*before.get(here)?));
    let mut best: Option<(usize, usize)> = None;
    for length in 1..=longest.min(rest.len() / lengths.rounds) {
        let behind = rest.get(length..).unwrap_or_default();
        // Most lengths end here.
        if behind.first() != rest.first() {
            continue;
        }
        let same = behind.iter().zip(rest).take_while(|(behind, before)| behind == before).count();
        let rounds = same / length + 1;
        let covered = |(length, rounds): (usize, usize)| length * rounds;
        let is_loop = rounds >= lengths.rounds && weight(length * rounds) >= Some(lengths.rolled);
        if is_loop && best.is_none_or(|best| covered(best) < length * rounds) {
            best = Some((length, rounds));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sequence that stretches represent.
    fn unrolled(stretches: &[Stretch], sequence: &[usize]) -> Vec<usize> {
        let mut all = Vec::new();
        for stretch in stretches {
            match stretch {
                Stretch::Once(range) => all.extend_from_slice(sequence.get(range.clone()).expect("a range")),
                Stretch::Rounds { first, length, rounds } => {
                    let round = sequence.get(*first..first + length).expect("a round");
                    (0..*rounds).for_each(|_| all.extend_from_slice(round));
                }
            }
        }
        all
    }

    #[test]
    fn rounds_are_found_behind_something_else() {
        let sequence: Vec<usize> =
            [7, 8].into_iter().chain((0..36).map(|index| index % 3)).chain([9]).collect();
        let found = stretches(&sequence, |_| 1, 10, Lengths::USUAL);
        let rounds = Stretch::Rounds { first: 2, length: 3, rounds: 12 };
        assert_eq!(found, [Stretch::Once(0..2), rounds, Stretch::Once(38..39)]);
    }

    #[test]
    fn rows_without_repetition_are_cut_to_length() {
        let sequence: Vec<usize> = (0..25).collect();
        assert_eq!(
            stretches(&sequence, |_| 1, 10, Lengths::USUAL),
            [Stretch::Once(0..10), Stretch::Once(10..20), Stretch::Once(20..25)]
        );
    }

    #[test]
    fn a_few_equal_elements_within_a_round_make_no_loop_of_their_own() {
        let round = [1, 1, 1, 2, 1, 1, 1, 3];
        let sequence: Vec<usize> = (0..80).filter_map(|index| round.get(index % 8)).copied().collect();
        assert_eq!(
            stretches(&sequence, |_| 1, 10, Lengths::USUAL),
            [Stretch::Rounds { first: 0, length: 8, rounds: 10 }]
        );
    }

    #[test]
    fn a_few_heavy_elements_make_a_loop_where_as_many_light_ones_do_not() {
        let sequence = [3; 8];
        let found = |weight: usize| stretches(&sequence, |_| weight, 10, Lengths::USUAL);
        assert_eq!(found(1), [Stretch::Once(0..8)]);
        assert_eq!(found(4), [Stretch::Rounds { first: 0, length: 1, rounds: 8 }]);
    }

    #[test]
    fn stretches_are_the_sequence() {
        // Digits of a small generator: some repetition, some not.
        let mut state = 1_usize;
        let mut sequence = Vec::new();
        for _ in 0..300 {
            state = (state * 75 + 74) % 65_537;
            let length = state % 5 + 1;
            (0..state % 40).for_each(|index| sequence.push(index % length));
        }
        let found = stretches(&sequence, |_| 1, 50, Lengths::USUAL);
        assert_eq!(unrolled(&found, &sequence), sequence);
        assert!(found.iter().any(|stretch| matches!(stretch, Stretch::Rounds { .. })));
    }
}

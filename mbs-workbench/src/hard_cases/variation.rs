//! Variants of a mechanism: each follows from its seed alone.

use core::f64::consts::TAU;

use crate::erased::variations::Change;
use crate::hard_cases::similarity::{Dimension, POWERS, Similarity};
use crate::random::Generator;

/// Kind of a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Step or tolerance by a factor.
    Steps,
    /// Parameters in their declared ranges.
    Parameters,
    /// Guess of the start or of the assembly shaken.
    Guess,
    /// Rows in another order and times factors.
    Rows,
    /// Frame of the points turned and moved.
    Frame,
    /// Single precision.
    Single,
    /// Four lanes.
    Lanes,
    /// A similar mechanism of another size.
    Similar,
}

impl Class {
    /// All kinds.
    pub const ALL: [Class; 8] = [
        Class::Steps,
        Class::Parameters,
        Class::Guess,
        Class::Rows,
        Class::Frame,
        Class::Single,
        Class::Lanes,
        Class::Similar,
    ];

    /// Its name in the matrix.
    pub fn name(self) -> &'static str {
        match self {
            Class::Steps => "steps",
            Class::Parameters => "parameters",
            Class::Guess => "guess",
            Class::Rows => "rows",
            Class::Frame => "frame",
            Class::Single => "f32",
            Class::Lanes => "lanes",
            Class::Similar => "similar",
        }
    }
}

/// Parts of a mechanism that can be varied.
#[derive(Clone, Debug, Default)]
pub struct VariedParts {
    /// Kinds of variants that suit it; never empty.
    pub classes: Vec<Class>,
    /// Index, lower and upper end of each parameter with a range.
    pub ranges: Vec<(usize, f64, f64)>,
    /// Reference metric of the coordinates: N.
    pub scales: Vec<f64>,
    /// Coordinates whose guess may be shaken.
    pub shaken: Vec<usize>,
    /// Indices of the components of each point of the plane or of space.
    pub points: Vec<Vec<usize>>,
    /// Index, value and dimension of each parameter, for similar mechanisms.
    pub sized: Vec<(usize, f64, Dimension)>,
    /// Dimension of each coordinate: N, or none.
    pub dimensions: Vec<Dimension>,
    /// For each row a number that it shares with those it may change places with: M.
    pub kinds: Vec<u64>,
}

/// A variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Number that it follows from.
    pub seed: u64,
    /// Its kind.
    pub class: Class,
    /// Factor of the number of steps; of the tolerance its inverse to the fourth power.
    pub finer: f64,
    /// Parameters by index.
    pub values: Vec<(usize, f64)>,
    /// Distance of the guess: N, or none.
    pub shift: Vec<f64>,
    /// Other coordinates and rows.
    pub change: Change,
    /// Size of a similar mechanism.
    pub similarity: Similarity,
    /// The variant in words.
    pub words: String,
}

/// Largest distance of a shaken guess, in the reference metric.
const SHAKEN: f64 = 0.05;

/// Largest distance of a moved frame, in the reference metric.
const MOVED: f64 = 1e3;

/// The random numbers of a variant.
pub fn numbers(seed: u64) -> Generator {
    Generator::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x6a09_e667_f3bc_c908)
}

impl Variation {
    /// The variant of a seed.
    pub fn of(seed: u64, subject: &VariedParts) -> Self {
        let class = subject.classes[(seed % subject.classes.len() as u64) as usize];
        let random = &mut numbers(seed);
        let mut variation = Variation {
            seed,
            class,
            finer: 1.0,
            values: Vec::new(),
            shift: Vec::new(),
            change: Change::default(),
            similarity: Similarity { power: 0 },
            words: "as the text has it".to_string(),
        };
        match class {
            Class::Steps => {
                let factor = [0.5, 1.0, 2.0, 4.0][random.index(4)];
                variation.finer = factor * random.uniform(0.95, 1.05);
                variation.words = format!("{:.3} times as many steps", variation.finer);
            }
            Class::Parameters => {
                let value = |(index, low, high): &(usize, f64, f64)| (*index, random.uniform(*low, *high));
                variation.values = subject.ranges.iter().map(value).collect();
                variation.words = "parameters in their ranges".to_string();
            }
            Class::Guess => {
                variation.shift = vec![0.0; subject.scales.len()];
                for j in &subject.shaken {
                    variation.shift[*j] = subject.scales[*j] * random.uniform(-SHAKEN, SHAKEN);
                }
                variation.words = format!("guess shaken by up to {SHAKEN}");
            }
            Class::Rows => {
                variation.change.rows = rows(&subject.kinds, random);
                variation.words = "rows in another order, times 1e-3 to 1e3".to_string();
            }
            Class::Frame => variation.frame(subject, random),
            Class::Similar => {
                let [low, high] = POWERS;
                let power = low + random.index((high - low + 1) as usize) as i32;
                variation.similarity = Similarity { power };
                let value = |(index, value, dimension): &(usize, f64, Dimension)| {
                    (*index, value * variation.similarity.factor(*dimension))
                };
                variation.values = subject.sized.iter().map(value).collect();
                variation.words = format!("a similar mechanism, 2^{power} times as large");
            }
            Class::Single | Class::Lanes => {
                variation.finer = random.uniform(0.95, 1.05);
                let numbers = if class == Class::Single { "f32" } else { "four lanes" };
                variation.words = format!("{numbers}, {:.3} times as many steps", variation.finer);
            }
        }
        variation
    }

    fn frame(&mut self, subject: &VariedParts, random: &mut Generator) {
        let count = subject.scales.len();
        let unit = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect();
        self.change.map = (0..count).map(unit).collect();
        self.change.shift = vec![0.0; count];
        let (angle, far) = (random.uniform(0.0, TAU), 10_f64.powf(random.uniform(0.0, MOVED.log10())));
        let direction = random.uniform(0.0, TAU);
        let (sin, cos) = angle.sin_cos();
        for point in &subject.points {
            // In space about the last axis: each turn of a frame is made of such ones.
            let [x, y] = [point[0], point[1]];
            for (i, j, entry) in [(x, x, cos), (x, y, -sin), (y, x, sin), (y, y, cos)] {
                self.change.map[i][j] = entry;
            }
            let distance = far * subject.scales[x];
            self.change.shift[x] = distance * direction.cos();
            self.change.shift[y] = distance * direction.sin();
        }
        self.words = format!("frame turned by {angle:.3} rad and moved by {far:.1} reference lengths");
    }
}

/// An order of rows among those of one kind, and factors.
fn rows(kinds: &[u64], random: &mut Generator) -> Vec<(usize, f64)> {
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    for i in (1..order.len()).rev() {
        let j = random.index(i + 1);
        if kinds[i] == kinds[j] {
            order.swap(i, j);
        }
    }
    order.into_iter().map(|row| (row, [1e-3, 1.0, 1e3][random.index(3)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> VariedParts {
        VariedParts {
            classes: Class::ALL.to_vec(),
            ranges: vec![(3, 0.1, 0.2)],
            scales: vec![1.0, 0.5, 0.5],
            shaken: vec![2],
            points: vec![vec![1, 2]],
            kinds: vec![0, 1, 0, 1, 0],
            sized: vec![(0, 2.0, Dimension { length: 1, mass: 0 })],
            dimensions: vec![Dimension::default(); 3],
        }
    }

    #[test]
    fn a_seed_gives_one_variant_and_seeds_give_all_kinds() {
        let subject = subject();
        let all: Vec<Variation> = (0..80).map(|seed| Variation::of(seed, &subject)).collect();
        assert_eq!(all[13], Variation::of(13, &subject));
        for class in Class::ALL {
            assert_eq!(all.iter().filter(|variation| variation.class == class).count(), 10, "{class:?}");
        }
        let ranged = all.iter().filter(|variation| variation.class == Class::Parameters);
        let parameters = ranged.flat_map(|variation| &variation.values);
        assert!(parameters.clone().count() == 10 && parameters.clone().all(|(_, v)| (0.1..=0.2).contains(v)));
        let factors: Vec<f64> = (0..320).map(|seed| Variation::of(seed, &subject).finer).collect();
        assert!(factors.iter().any(|f| *f < 0.6) && factors.iter().any(|f| *f > 3.5), "{factors:?}");
    }

    #[test]
    fn rows_change_places_within_their_kind_and_a_frame_stays_orthogonal() {
        let subject = subject();
        for seed in 0..70 {
            let Change { rows, map, .. } = Variation::of(seed, &subject).change;
            for (place, (row, factor)) in rows.iter().enumerate() {
                assert_eq!(subject.kinds[place], subject.kinds[*row]);
                assert!([1e-3, 1.0, 1e3].contains(factor));
            }
            for (i, a) in map.iter().enumerate() {
                for (j, b) in map.iter().enumerate() {
                    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-15);
                }
            }
        }
    }
}

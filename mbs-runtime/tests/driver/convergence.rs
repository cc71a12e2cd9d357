//! Orders of convergence, and reproducible numbers.

use mbs_runtime::Function;

use crate::series::Series;

/// Largest error of each derivative at places between the knots.
pub fn errors<F: Function<f64>, const K: usize>(
    function: &F,
    truth: fn(Series) -> Series,
    range: [f64; 2],
) -> [f64; K] {
    const PLACES: u32 = 997;
    let mut largest = [0.0; K];
    for place in 0..=PLACES {
        let x = range[0] + (range[1] - range[0]) * f64::from(place) / f64::from(PLACES);
        let expected = truth(Series::variable(x)).derivatives();
        let found: [f64; K] = function.jet(x);
        for order in 0..K {
            largest[order] = f64::max(largest[order], (found[order] - expected[order]).abs());
        }
    }
    largest
}

/// Halving the distance of the knots divides the error of derivative k by 2^(`power` − k), but for a tenth of the power.
#[track_caller]
pub fn assert_order<const K: usize>(coarse: [f64; K], fine: [f64; K], power: f64) {
    for order in 0..K {
        let seen = (coarse[order] / fine[order]).log2();
        let expected = power - order as f64;
        let context = format!("derivative {order}: {seen:.2} {:e} {:e}", coarse[order], fine[order]);
        assert!((expected - 0.1 * power..expected + 0.2 * power).contains(&seen), "{context}");
    }
}

/// SplitMix64. Source: Steele, Lea & Flood 2014.
pub struct Sequence(pub u64);

impl Sequence {
    /// The next number in [−1, 1).
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

//! Numbers at which identities are tried: without relations among each other, and the same in every build.

/// A number from 0 up to 1, by the kind and index of its quantity and the number of the trial.
///
/// The finalizer of SplitMix64: neighbouring keys have unrelated values. Numbers chosen by hand, or in equal steps, fulfil
/// equations of their own: e₁e₂ + e₀e₃ = 0, or a − 2b + c = 0.
pub fn fraction(kind: u64, index: u32, trial: usize) -> f64 {
    let mut bits = (kind << 40) ^ (u64::from(index) << 8) ^ trial as u64;
    bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::fraction;

    /// Equal steps have a − 2b + c = 0, values by hand few digits; both are found here.
    #[test]
    fn small_integer_relations_do_not_hold() {
        let of = |index| fraction(4, index, 0);
        for first in 0..20 {
            let values: Vec<f64> = (first..first + 4).map(|index| of(index) - 0.5).collect();
            for code in 1..7_i64.pow(4) {
                let digit = |place: u32| (code / 7_i64.pow(place) % 7 - 3) as f64;
                let sum: f64 = values.iter().zip(0..).map(|(value, place)| digit(place) * value).sum();
                let is_nothing = (0..4).all(|place| digit(place) == 0.0);
                assert!(is_nothing || sum.abs() > 1e-9, "{first}: {code}");
                let product = |i: u32, j: u32| of(first + i) * of(first + j);
                let pairs = [product(0, 1), product(0, 2), product(1, 3), product(2, 3)];
                let sum: f64 = pairs.iter().zip(0..).map(|(pair, place)| digit(place) * pair).sum();
                assert!(is_nothing || sum.abs() > 1e-9, "{first}: {code}");
            }
        }
    }
}

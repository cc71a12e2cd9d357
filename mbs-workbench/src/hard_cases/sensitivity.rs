//! Effect of rounding on a motion: where a start moved by rounding leads elsewhere, a run in that precision shows nothing.

use crate::hard_cases::instants::Instants;
use crate::hard_cases::references::{FIRST, Run, Varied, deviations};
use crate::hard_cases::variation::numbers;
use crate::setting::Resolution;

/// Distance of the moved starts in ε.
const ROUNDING: f64 = 4.0;

/// Part of the distance that rounding may make of a run, which moved starts may differ by.
const SHARE: f64 = 0.1;

/// Distances from the motion at its instants that rounding of the start makes.
pub struct Sensitivity(Vec<(f64, f64)>);

impl Sensitivity {
    /// That of the motion `first` in numbers of rounding `epsilon`, in `f64` from two starts beside its own.
    ///
    /// # Errors
    /// A start beside its own that the mechanism has no motion from.
    pub fn of(
        varied: &Varied<'_>,
        first: &Run,
        instants: &Instants,
        (epsilon, scales): (f64, &[f64]),
    ) -> Result<Self, String> {
        let start = first.first().ok_or("a motion without a start")?;
        let moved = |sign: f64| {
            let mut random = numbers(0xf32);
            let mut side = || if random.index(2) == 0 { sign } else { -sign };
            let rounding = |value: f64, scale: f64| ROUNDING * epsilon * value.abs().max(scale);
            let q = start.q.iter().zip(scales).map(|(q, scale)| q + side() * rounding(*q, *scale));
            let q: Vec<f64> = q.collect();
            let qd = start.qd.iter().map(|qd| qd + side() * rounding(*qd, 0.0));
            [q, qd.collect()]
        };
        let mut found: Vec<(f64, f64)> = Vec::new();
        for sign in [1.0, -1.0] {
            let start = varied.mechanism.start(&moved(sign)).map_err(|failure| failure.to_string())?;
            let run = varied.from(&start, FIRST, Resolution::Tolerance(1e-9), instants);
            let (run, _) = run.map_err(|failure| failure.to_string())?;
            found.extend(deviations(&run, first, scales));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Sensitivity(found))
    }

    /// Time (s) from which on rounding of the start has moved the motion by more than a tenth of `rounding`; none where it never does.
    pub fn end(&self, rounding: f64) -> Option<f64> {
        let over = |distance: f64| distance.is_nan() || distance > SHARE * rounding;
        self.0.iter().find(|(_, distance)| over(*distance)).map(|(t, _)| *t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_ends_where_moved_starts_differ_by_a_tenth_of_what_rounding_may() {
        let found = Sensitivity(vec![(0.0, 1e-7), (0.5, 1e-6), (1.0, 3e-4), (1.5, 1e-6)]);
        assert_eq!(found.end(1e-2), None);
        assert_eq!(found.end(1e-3), Some(1.0));
        assert_eq!(Sensitivity(vec![(0.0, 0.0), (0.5, f64::NAN)]).end(1.0), Some(0.5));
    }
}

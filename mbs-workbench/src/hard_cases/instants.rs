//! Instants at which a run is looked at: all at equal distances, or some of them, several close together.

use crate::setting::Resolution;

/// Parts of a run. Methods of equal steps begin with as many.
pub const PARTS: u32 = 64;

/// Instants of a part that are shown, where it has more than twice as many.
const CLUSTER: u32 = 5;

/// Instants of a run from t = 0 on.
#[derive(Clone, Debug, PartialEq)]
pub struct Instants {
    /// At equal distances: s.
    pub times: Vec<f64>,
    /// Those of a part: the first five of each are shown, or all of few.
    each: u32,
}

impl Instants {
    /// Instants up to `until` (s), with at most `intervals` between them. Whole steps lie between instants: a factor changes the number of
    /// instants, not the steps between them.
    pub fn of(until: f64, resolution: Resolution, intervals: u32) -> Self {
        let count = match resolution {
            Resolution::Steps(steps) => (steps / (steps / intervals).max(1)).max(1),
            Resolution::Tolerance(_) => intervals,
        };
        let times = (0..=count).map(|k| until * f64::from(k) / f64::from(count)).collect();
        Instants { times, each: (count / PARTS).max(1) }
    }

    /// `true` where the instant `t` (s) of a run is shown.
    pub fn shows(&self, t: f64) -> bool {
        let count = self.times.len() - 1;
        let index = (t / self.times[count] * count as f64).round() as usize;
        let each = self.each as usize;
        each <= 2 * CLUSTER as usize || index % each < CLUSTER as usize || index >= count
    }
}

/// Ranges of the instants (s) between which no distance is longer than the shortest one.
pub fn stretches(times: &[f64]) -> Vec<core::ops::Range<usize>> {
    let distance = |pair: &[f64]| pair[1] - pair[0];
    let shortest = times.windows(2).map(distance).fold(f64::INFINITY, f64::min);
    let mut begin = 0;
    let stretch = |stretch: &[f64]| {
        let range = begin..begin + stretch.len();
        begin = range.end;
        range
    };
    // Times of single precision are rounded.
    times.chunk_by(|a, b| b - a < 1.5 * shortest).map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(instants: &Instants) -> Vec<f64> {
        instants.times.iter().copied().filter(|t| instants.shows(*t)).collect()
    }

    #[test]
    fn few_instants_are_all_shown_and_many_in_clusters() {
        let all = Instants::of(2.0, Resolution::Tolerance(1.0), 512);
        assert_eq!(shown(&all).len(), 513);
        let many = Instants::of(2.0, Resolution::Tolerance(1.0), 4096);
        let times = shown(&many);
        assert_eq!((many.times.len(), times.len()), (4097, 321));
        assert_eq!(times.last(), Some(&2.0));
        let ranges = stretches(&times);
        assert_eq!((ranges.len(), ranges[1].clone()), (65, 5..10));
        let whole = stretches(&all.times);
        assert_eq!((whole.len(), whole[0].clone()), (1, 0..513));
    }

    #[test]
    fn steps_that_are_no_multiple_have_instants_of_their_own() {
        assert_eq!(Instants::of(1.0, Resolution::Steps(130), 64).times.len(), 66);
        assert_eq!(Instants::of(1.0, Resolution::Steps(40), 64).times.len(), 41);
        assert_eq!(Instants::of(1.0, Resolution::Steps(4096), 1024).times.len(), 1025);
    }
}

//! Least values over a turn.

/// Samples of a piece, and of each degree of it.
const FEWEST: usize = 8;
const A_DEGREE: f64 = 1.0;

/// Distance from a joint at which one side of it counts (rad).
const BESIDE: f64 = 1e-10;

/// Golden section.
const SECTION: f64 = 0.618_033_988_749_894_9;

/// Sampling angles of each piece between joints, both of its sides included.
pub fn pieces(joints: &[f64]) -> Vec<Vec<f64>> {
    let piece = |pair: &[f64]| {
        let [from, to] = [pair[0] + BESIDE, pair[1] - BESIDE];
        let count = FEWEST.max(((to - from).to_degrees() * A_DEGREE).ceil() as usize);
        (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
    };
    joints.windows(2).filter(|pair| pair[1] - pair[0] > 4.0 * BESIDE).map(piece).collect()
}

/// Second differences below this share of the largest value are rounding, as on a dwell.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Argument and value of the least `f` over samples of pieces; NaN counts as lowest.
///
/// A local minimum is refined where it may fall below all samples: by no more than the second difference about it. Next to an end of a
/// piece it may lie behind a rise from the first sample to the second one; there the largest second difference of the piece counts.
pub fn least(pieces: &[Vec<f64>], sampled: &[Vec<f64>], f: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut best = (f64::NAN, f64::INFINITY);
    for (place, value) in pieces.iter().flatten().zip(sampled.iter().flatten()) {
        if value.is_nan() {
            return (*place, f64::NAN);
        }
        if *value < best.1 {
            best = (*place, *value);
        }
    }
    for (places, values) in pieces.iter().zip(sampled) {
        let finite = values.iter().filter(|value| value.is_finite());
        let noise = ROUNDING * finite.fold(0.0, |most, value| value.abs().max(most));
        let mut look = |from: usize, to: usize, bound: f64| {
            if bound < best.1 {
                let found = refine(places[from], places[to], &f);
                // On a dwell the first sample stays the place.
                best = if found.1 < best.1 - noise { found } else { best };
            }
        };
        let mut most = 0.0_f64;
        for (k, three) in values.windows(3).enumerate() {
            let [before, value, after] = [three[0], three[1], three[2]];
            let bend = before + after - 2.0 * value;
            most = if bend.is_finite() { most.max(bend.abs()) } else { most };
            if before >= value && value <= after && bend > noise {
                look(k, k + 2, value - bend);
            }
        }
        let last = values.len().saturating_sub(1);
        for (end, next) in [(0, 1), (last, last.saturating_sub(1))] {
            let rise = values.get(next).zip(values.get(end)).map_or(f64::INFINITY, |(next, end)| next - end);
            if most > noise && (0.0..most).contains(&rise) {
                look(end.min(next), end.max(next), values[end] - most);
            }
        }
    }
    best
}

/// Golden-section search. Source: Kiefer 1953.
fn refine(mut from: f64, mut to: f64, f: &impl Fn(f64) -> f64) -> (f64, f64) {
    let (mut a, mut b) = (to - SECTION * (to - from), from + SECTION * (to - from));
    let (mut at_a, mut at_b) = (f(a), f(b));
    while to - from > 1e-8 {
        if at_a < at_b {
            (to, b, at_b) = (b, a, at_a);
            a = to - SECTION * (to - from);
            at_a = f(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = from + SECTION * (to - from);
            at_b = f(b);
        }
    }
    if at_a < at_b { (a, at_a) } else { (b, at_b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minima_within_and_at_joints_are_found() {
        let pieces = pieces(&[0.0, 1.0, 3.0]);
        let of = |f: &dyn Fn(f64) -> f64| {
            let sampled: Vec<Vec<f64>> = pieces.iter().map(|p| p.iter().map(|x| f(*x)).collect()).collect();
            least(&pieces, &sampled, f)
        };
        let (place, value) = of(&|x| (x - 1.2345).powi(2) - 5.0);
        assert!((place - 1.2345).abs() < 1e-7 && (value + 5.0).abs() < 1e-15);
        // A jump down at 1 counts with its lower side.
        let (place, value) = of(&|x| if x < 1.0 { 2.0 - x } else { 3.0 + x });
        assert!((place - 1.0).abs() < 1e-9 && (value - 1.0).abs() < 1e-9);
        assert!(of(&|x| if x > 2.0 { f64::NAN } else { x }).1.is_nan());
        // Between an end and the next sample, on either side of a joint, where the end is lower than that sample.
        let step = pieces[1][1] - pieces[1][0];
        for (shift, side) in [(0.1, 1.0), (0.3, 1.0), (0.45, 1.0), (-0.1, -1.0), (-0.3, -1.0), (-0.45, -1.0)]
        {
            let lowest = 1.0 + shift * step;
            let dip = |x: f64| (x - lowest).powi(2) * (1.0 + 20.0 * (x - lowest).abs()) - 5.0;
            let (place, value) = of(&|x| if (x - 1.0) * side > 0.0 { dip(x) } else { 0.0 });
            assert!((place - lowest).abs() < 1e-7 && (value + 5.0).abs() < 1e-14, "{shift}: {place} {value}");
        }
    }
}

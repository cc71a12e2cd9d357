//! A quantity over the time, smooth between instants at which it is known.

/// Value, rate and acceleration at instants, with polynomials of degree 5 between them (quintic Hermite interpolation).
///
/// All three are continuous, and rate and acceleration are the exact derivatives of the value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// Instants (s), increasing.
    times: Vec<f64>,
    /// Value, rate (1/s) and acceleration (1/s²) at each.
    jets: Vec<[f64; 3]>,
}

impl Course {
    /// `None` where there are fewer than two instants, where their numbers differ, or where the instants do not increase.
    pub fn new(times: Vec<f64>, jets: Vec<[f64; 3]>) -> Option<Self> {
        let rises = times.windows(2).all(|pair| pair[0] < pair[1]);
        (times.len() > 1 && times.len() == jets.len() && rises).then_some(Course { times, jets })
    }

    /// First and last instant (s).
    pub fn range(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Value, rate and acceleration at `t` (s); outside of the range those of the nearest polynomial.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let behind = self.times.partition_point(|time| *time <= t);
        let k = behind.clamp(1, self.times.len() - 1) - 1;
        let h = self.times[k + 1] - self.times[k];
        let ([p, v, a], [q, w, b]) = (self.jets[k], self.jets[k + 1]);
        // In s = (t − tₖ)/h the derivatives are those in t times h and h².
        let s = (t - self.times[k]) / h;
        let [c0, c1, c2] = [p, v * h, 0.5 * a * h * h];
        // What the parabola from the left end misses at the right one.
        let value = q - (c0 + c1 + c2);
        let rate = w * h - (c1 + 2.0 * c2);
        let bend = b * h * h - 2.0 * c2;
        let c3 = 10.0 * value - 4.0 * rate + 0.5 * bend;
        let c4 = -15.0 * value + 7.0 * rate - bend;
        let c5 = 6.0 * value - 3.0 * rate + 0.5 * bend;
        let at = c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
        let first = c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)));
        let second = 2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5));
        [at, first / h, second / (h * h)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of degree 5 and its derivatives.
    fn quintic(t: f64) -> [f64; 3] {
        let [a, b, c] = [1.0 - t, t * t, t * t * t];
        [a + b * c - 2.0 * c, -1.0 + 5.0 * b * b - 6.0 * b, 20.0 * c - 12.0 * t]
    }

    #[test]
    fn polynomials_of_degree_five_are_met_everywhere() {
        let times = vec![-1.0, 0.25, 0.5, 2.0];
        let jets = times.iter().map(|t| quintic(*t)).collect();
        let course = Course::new(times, jets).expect("a course");
        for k in 0..=300 {
            let t = -1.0 + 0.01 * f64::from(k);
            for (found, expected) in course.at(t).into_iter().zip(quintic(t)) {
                assert!((found - expected).abs() < 1e-11 * (1.0 + expected.abs()), "{t}: {found} {expected}");
            }
        }
        assert_eq!(course.range(), [-1.0, 2.0]);
    }

    #[test]
    fn instants_that_do_not_rise_make_no_course() {
        assert_eq!(Course::new(vec![0.0], vec![[0.0; 3]]), None);
        assert_eq!(Course::new(vec![0.0, 0.0], vec![[0.0; 3]; 2]), None);
        assert_eq!(Course::new(vec![0.0, 1.0], vec![[0.0; 3]]), None);
    }
}

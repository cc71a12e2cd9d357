//! Encoder reports of a crank near its change point.

use mbs_runtime::Signal;

/// Reproducible numbers: SplitMix64. Source: Steele, Lea & Flood 2014.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// The next number in [from, to).
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        from + (to - from) * (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn one_of<const K: usize, X: Copy>(&mut self, of: [X; K]) -> X {
        of[(self.between(0.0, K as f64) as usize).min(K - 1)]
    }
}

/// Motion of the crank, or kind of its reports.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// At constant speed.
    Steady,
    /// Every sample off by up to two steps, so that reports go back and forth.
    Jitter,
    /// A stop next to the point, in which the last digit of the encoder flickers.
    Dwell,
    /// Back again just before or just behind the point, as often as three times.
    Reversal,
    /// Samples that come twice, in the same period or in the next.
    DoubledSample,
}

/// Rates that come with a reported angle.
#[derive(Clone, Copy, Debug)]
enum Rates {
    /// Those of the true motion.
    True,
    /// Differences of the reports.
    Differences,
    /// None: an encoder without a filter.
    Zero,
}

/// Reports of the encoder, sample by sample.
#[derive(Debug)]
pub struct Plan {
    /// Crank angle (rad) at the start, relative to the change point.
    pub start: f64,
    /// Reports, relative to the change point, with their times (s).
    pub samples: Vec<(Signal<f64>, f64)>,
}

/// Nominal speed of the crank (rad/s).
const SPEED: f64 = 1.0;

impl Plan {
    /// A plan of `kind` with step, phase, noise and direction as `random` says.
    pub fn of(kind: Kind, random: &mut Random) -> Plan {
        // From a fine sampling to 3°, evenly in the logarithm.
        let step = random.between(0.002_f64.ln(), 0.05_f64.ln()).exp();
        let direction = random.one_of([1.0, -1.0]);
        let start = -random.between(0.1 + step, 0.4);
        let mut true_angles = vec![start];
        let walk = |to: f64, angles: &mut Vec<f64>| {
            let from = *angles.last().expect("a start");
            let steps = ((to - from).abs() / step).ceil().max(1.0);
            angles.extend((1..=steps as u32).map(|k| from + (to - from) * f64::from(k) / steps));
        };
        let end = random.between(0.1 + step, 0.4);
        let mut dwelling = 0..0;
        match kind {
            Kind::Dwell => {
                walk(random.between(-2.0, 2.0) * step, &mut true_angles);
                let at = *true_angles.last().expect("a start");
                dwelling = true_angles.len()..true_angles.len() + 100;
                true_angles.extend([at; 100]);
            }
            Kind::Reversal => {
                for _ in 0..random.one_of([1, 2, 3]) {
                    walk(random.between(-1.0, 3.0) * step, &mut true_angles);
                    walk(-random.between(-1.0, 30.0) * step, &mut true_angles);
                }
            }
            Kind::Steady | Kind::Jitter | Kind::DoubledSample => {}
        }
        walk(end, &mut true_angles);
        let noise = match kind {
            Kind::Jitter => random.between(0.2, 2.0) * step,
            // Flicker of a 20-bit encoder.
            Kind::Dwell => 6e-6,
            _ => 0.0,
        };
        let rates = random.one_of([Rates::True, Rates::Differences, Rates::Zero]);
        let mut plan = Plan { start: direction * start, samples: Vec::new() };
        let period = step / SPEED;
        let (mut last, mut t) = (start, 0.0);
        for k in 1..true_angles.len() {
            let flickers = !matches!(kind, Kind::Dwell) || dwelling.contains(&k);
            let angle = true_angles[k] + if flickers { random.between(-noise, noise) } else { 0.0 };
            let true_rate = (true_angles[k] - true_angles[k - 1]) / period;
            let rate = match rates {
                Rates::True => true_rate,
                Rates::Differences => (angle - last) / period,
                Rates::Zero => 0.0,
            };
            let signal = Signal { value: direction * angle, rate: direction * rate, acceleration: 0.0 };
            let mut report = |repeated_later: bool| {
                t += if repeated_later { period } else { 0.0 };
                plan.samples.push((signal, t));
            };
            report(true);
            if matches!(kind, Kind::DoubledSample) && random.one_of([true, false]) {
                report(random.one_of([true, false]));
            }
            last = angle;
        }
        plan
    }
}

//! The valvetrain from formulas alone.

use core::f64::consts::{PI, TAU};

/// Places in metres: cam centre, pads of 12 mm at lift 0.
const CENTRE: [f64; 2] = [0.012, 0.020];
/// Half the duration of the lift (rad), and its height (m).
const HALF: f64 = 80.0 * PI / 180.0;
const LIFT: f64 = 0.011;

/// Lift (m) and forces (N) of nose, tip, seat, heel, fork.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub lift: f64,
    pub forces: [f64; 5],
}

/// A rocker: pivot, arms to the cam's and the valve's pad.
#[derive(Clone, Copy)]
struct Rocker {
    pivot: [f64; 2],
    cam: [f64; 2],
    valve: [f64; 2],
}

/// Valvetrain with speed (rad/s), play of opener and closer (m), guide friction (N s/m, N).
pub struct Own {
    opener: Rocker,
    closer: Rocker,
    speed: f64,
    play: [f64; 2],
    guide: [f64; 2],
    /// K (N/m^1.5) and D (s/m) of all contacts.
    contact: [f64; 2],
}

fn law(theta: f64) -> [f64; 3] {
    let x = ((theta + PI).rem_euclid(TAU) - PI) / HALF;
    if x.abs() >= 1.0 {
        return [0.0; 3];
    }
    let terms = [(2, -3.0), (6, 10.0), (8, -15.0), (10, 9.0), (12, -2.0)];
    let mut s = [1.0, 0.0, 0.0];
    for (p, c) in terms {
        let power = f64::from(p);
        s[0] += c * x.powi(p);
        s[1] += c * power * x.powi(p - 1);
        s[2] += c * power * (power - 1.0) * x.powi(p - 2);
    }
    [LIFT * s[0], LIFT * s[1] / HALF, LIFT * s[2] / (HALF * HALF)]
}

impl Rocker {
    /// z and its two derivatives over the cam angle: z = e^{−iθ}(P − C + r_a e^{i(ψ+α)}).
    fn pitch(&self, theta: f64) -> [[f64; 2]; 3] {
        let [s, s1, s2] = law(theta);
        let [bx, by] = self.valve;
        // (rot(ψ) b)_y = b_y − s, left of the pivot.
        let (length, rest) = (bx.hypot(by), by.atan2(bx));
        let at = PI - ((by - s) / length).asin();
        let (mut turn, slope) = (at - rest, length * at.cos());
        turn = (turn + PI).rem_euclid(TAU) - PI;
        let turn1 = -s1 / slope;
        let turn2 = (-s2 + length * at.sin() * turn1 * turn1) / slope;
        let (sine, cosine) = turn.sin_cos();
        let a = [cosine * self.cam[0] - sine * self.cam[1], sine * self.cam[0] + cosine * self.cam[1]];
        let w = [0, 1].map(|k| self.pivot[k] - CENTRE[k] + a[k]);
        let w1 = [-turn1 * a[1], turn1 * a[0]];
        let w2 = [-turn2 * a[1] - turn1 * turn1 * a[0], turn2 * a[0] - turn1 * turn1 * a[1]];
        let (sine, cosine) = (-theta).sin_cos();
        let back = |v: [f64; 2]| [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]];
        // z' = e^{−iθ}(w' − i w), z'' = e^{−iθ}(w'' − 2 i w' − w).
        [
            back(w),
            back([w1[0] + w[1], w1[1] - w[0]]),
            back([w2[0] + 2.0 * w1[1] - w[0], w2[1] - 2.0 * w1[0] - w[1]]),
        ]
    }

    /// Polar radius and two derivatives over the polar angle; `theta` is near.
    fn radius(&self, angle: f64, mut theta: f64) -> [f64; 3] {
        for _ in 0..30 {
            let [z, z1, _] = self.pitch(theta);
            let (sine, cosine) = angle.sin_cos();
            let left = (cosine * z[1] - sine * z[0]).atan2(cosine * z[0] + sine * z[1]);
            let step = left * (z[0] * z[0] + z[1] * z[1]) / (z[0] * z1[1] - z[1] * z1[0]);
            theta -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        let [z, z1, z2] = self.pitch(theta);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let r = z[0].hypot(z[1]);
        let r1 = dot(z, z1) / r;
        let r2 = (dot(z1, z1) + dot(z, z2) - r1 * r1) / r;
        let w1 = cross(z, z1) / (r * r);
        let w2 = cross(z, z2) / (r * r) - 2.0 * r1 * w1 / r;
        [r, r1 / w1, (r2 * w1 - r1 * w2) / (w1 * w1 * w1)]
    }

    /// Gap of the cam's pad (r − R)/√(1 + (R′/r)²), its derivatives over the rocker's and the cam's angle.
    fn gap(&self, turn: f64, theta: f64) -> [f64; 3] {
        let (sine, cosine) = turn.sin_cos();
        let a = [cosine * self.cam[0] - sine * self.cam[1], sine * self.cam[0] + cosine * self.cam[1]];
        let from = [0, 1].map(|k| self.pivot[k] + a[k] - CENTRE[k]);
        let r = from[0].hypot(from[1]);
        let angle = from[1].atan2(from[0]) - theta;
        let [radius, slope, second] = self.radius(angle, theta);
        let tilt = slope / r;
        let root = (1.0 + tilt * tilt).sqrt();
        let over = |dr: f64, dw: f64| {
            let d_tilt = second * dw / r - slope * dr / (r * r);
            (dr - slope * dw) / root - (r - radius) * tilt * d_tilt / (root * root * root)
        };
        let dr = (from[0] * -a[1] + from[1] * a[0]) / r;
        let dw = (from[0] * a[0] + from[1] * a[1]) / (r * r);
        [(r - radius) / root, over(dr, dw), over(0.0, -1.0)]
    }

    /// Way of the valve's pad along the axis and its derivative.
    fn way(&self, turn: f64) -> [f64; 2] {
        let ([bx, by], (sine, cosine)) = (self.valve, turn.sin_cos());
        [by - sine * bx - cosine * by, -cosine * bx + sine * by]
    }
}

type State = [f64; 6];

impl Own {
    /// Data of the lecture.
    pub fn lecture(speed: f64, play: [f64; 2], guide: [f64; 2]) -> Self {
        let opener = Rocker { pivot: [0.031, 0.001], cam: [-0.018, -0.00498], valve: [-0.031, 0.007] };
        // Arm of 29 mm to a pad that is 29 mm from the cam's centre, right of the line to it.
        let pivot = [0.035, -0.009];
        let line = [CENTRE[0] - pivot[0], CENTRE[1] - pivot[1]];
        let half = 0.5 * line[0].hypot(line[1]);
        let angle = line[1].atan2(line[0]) - (half / 0.029).acos();
        let closer =
            Rocker { pivot, cam: [0.029 * angle.cos(), 0.029 * angle.sin()], valve: [-0.035, -0.003] };
        Own { opener, closer, speed, play, guide, contact: [5e10, 1.5] }
    }

    /// With another K and D.
    #[cfg(feature = "long")]
    pub fn with_contact(self, contact: [f64; 2]) -> Self {
        Own { contact, ..self }
    }

    fn normal(&self, gap: f64, rate: f64) -> f64 {
        let ([k, d], depth) = (self.contact, (-gap).max(0.0));
        k * depth * depth.sqrt() * (1.0 - d * rate).max(0.0)
    }

    /// Forces and the rates of the state.
    fn rates(&self, t: f64, y: &State) -> ([f64; 5], State) {
        let [opener, closer, s, opener_rate, closer_rate, rate] = *y;
        let theta = -PI + self.speed * t;
        let [nose, nose_q, nose_t] = self.opener.gap(opener, theta);
        let [heel, heel_q, heel_t] = self.closer.gap(closer, theta);
        let [opened, opened_q] = self.opener.way(opener);
        let [closed, closed_q] = self.closer.way(closer);
        let forces = [
            self.normal(nose, nose_q * opener_rate + nose_t * self.speed),
            self.normal(s - opened + self.play[0], rate - opened_q * opener_rate),
            self.normal(s, rate),
            self.normal(heel, heel_q * closer_rate + heel_t * self.speed),
            self.normal(closed - s + self.play[1], closed_q * closer_rate - rate),
        ];
        let [on_opener, tip, seat, on_closer, fork] = forces;
        let friction = self.guide[0] * rate + self.guide[1] * (rate / 0.05).tanh();
        let accelerations = [
            (on_opener * nose_q - tip * opened_q) / 1.3e-5,
            (on_closer * heel_q + fork * closed_q - 1.2 - closer) / 2.2e-5,
            (tip + seat - fork - friction) / 0.028 + 9.80665,
        ];
        let [a, b, c] = accelerations;
        (forces, [opener_rate, closer_rate, rate, a, b, c])
    }

    /// The motion from rest at 180° before full lift, at equal distances of `turns`.
    pub fn moved(&self, turns: f64, samples: u32) -> Vec<Sample> {
        let (mut t, mut y, mut h) = (0.0_f64, [0.0; 6], 1e-9_f64);
        let end = turns * TAU / self.speed;
        let mut found = Vec::new();
        for sample in 1..=samples {
            let until = end * f64::from(sample) / f64::from(samples);
            while t < until {
                let step = h.min(until - t);
                let (next, error) = self.step(t, &y, step);
                if error <= 1.0 {
                    t = if step < until - t { t + step } else { until };
                    y = next;
                }
                let factor = 0.9 * error.max(1e-10).powf(-0.2);
                // A step that a sample has cut says little of the next one.
                if error > 1.0 || step >= h {
                    h = step * factor.clamp(0.2, 4.0);
                }
            }
            found.push(Sample { lift: y[2], forces: self.rates(t, &y).0 });
        }
        found
    }

    /// A step of Dormand and Prince's pair of orders 5 and 4, and its error over the tolerance.
    fn step(&self, t: f64, y: &State, h: f64) -> (State, f64) {
        const C: [f64; 6] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
        const A: [&[f64]; 6] = [
            &[0.2],
            &[3.0 / 40.0, 9.0 / 40.0],
            &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
            &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
            &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
            &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
        ];
        const E: [f64; 7] = [
            71.0 / 57600.0,
            0.0,
            -71.0 / 16695.0,
            71.0 / 1920.0,
            -17253.0 / 339200.0,
            22.0 / 525.0,
            -1.0 / 40.0,
        ];
        /// rad, rad, m, and their rates.
        const TOLERANCE: State = [1e-12, 1e-12, 3e-14, 1e-8, 1e-8, 3e-10];
        let mut slopes = [self.rates(t, y).1; 7];
        let mut next = *y;
        for stage in 0..6 {
            next = core::array::from_fn(|k| {
                y[k] + h * A[stage].iter().zip(&slopes).map(|(a, slope)| a * slope[k]).sum::<f64>()
            });
            slopes[stage + 1] = self.rates(t + C[stage] * h, &next).1;
        }
        let error = (0..6).fold(0.0, |most: f64, k| {
            let error = h * E.iter().zip(&slopes).map(|(e, slope)| e * slope[k]).sum::<f64>();
            most.max((error / TOLERANCE[k]).abs())
        });
        (next, error)
    }
}

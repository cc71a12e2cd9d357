//! Four-bars in a row that hang: all move like one pendulum, whose motion is known.

use std::f64::consts::FRAC_PI_3;

use super::cvodes::{Integrator, TOLERANCES};
use super::emitted::{self, Run};
use super::{Accelerations, Attempt, State, casadi, exact_enough, larger};
use crate::measure::Case;
use crate::released::{NFourBar10, NFourBar40};

/// Duration (s).
const END: f64 = 10.0;

/// Samples of the motion at which it is compared.
const SAMPLES: u32 = 1000;

/// Largest allowed error of the first point at any sample (m).
const LIMIT: f64 = 1e-7;

/// States on the way.
const STATES: u32 = 64;

pub fn rates() -> Vec<Case> {
    let ten = problem::<22>(10);
    let mut cases = vec![
        ten.case("casadi_rates", casadi::n_four_bar),
        ten.case("emitted", emitted::rates::<NFourBar10, 22, 21>()),
    ];
    cases.push(problem::<82>(40).case("emitted_40", emitted::rates::<NFourBar40, 82, 81>()));
    cases
}

pub fn motions() -> Vec<Case> {
    let pendulum = Pendulum::of(10);
    let error_at = |index: u32, q: &[f64]| {
        let (angle, _) = pendulum.at(END * f64::from(index) / f64::from(SAMPLES));
        (q[0] - angle.sin()).hypot(q[1] + angle.cos())
    };
    let start = pendulum.state::<22>(0.0);
    let mut attempts: Vec<Attempt> = (0..TOLERANCES)
        .map(|index| {
            let start = [start.q, start.qd].concat();
            let samples = format!("n_four_bar_samples_{index}");
            let mut sampled = Integrator::new(&samples, start.clone(), 44 * SAMPLES as usize);
            sampled.run();
            let errors = (1..).zip(sampled.states.chunks(44)).map(|(index, state)| error_at(index, state));
            let error = errors.fold(0.0, larger);
            let mut integrator = Integrator::new(&format!("n_four_bar_end_{index}"), start, 44);
            Attempt { name: "cvodes", error, run: Box::new(move || integrator.run()) }
        })
        .collect();
    attempts.extend(Run { start, end: END }.attempts::<NFourBar10, 21>(|simulation| {
        let (mut index, mut error) = (0, 0.0);
        simulation.show(END, SAMPLES, &mut |q| {
            index += 1;
            error = larger(error, error_at(index, q));
        });
        error
    }));
    exact_enough("n_four_bar_motion", LIMIT, attempts)
}

/// States of a swing with their accelerations.
fn problem<const N: usize>(loops: u32) -> Accelerations<N> {
    let pendulum = Pendulum::of(loops);
    let times = (0..STATES).map(|state| 3.0 * f64::from(state) / f64::from(STATES));
    let (states, expected) = times.map(|t| (pendulum.state(t), pendulum.accelerations(t))).unzip();
    Accelerations { group: "n_four_bar_rates", states, expected }
}

/// α̈ = −ω² sin α, released at rest 60° from the vertical.
struct Pendulum {
    /// ω (rad/s).
    frequency: f64,
}

impl Pendulum {
    /// `loops` + 1 rods turn about an end, `loops` only move along.
    fn of(loops: u32) -> Self {
        let (turning, moving) = (f64::from(loops + 1), f64::from(loops));
        Pendulum { frequency: ((turning / 2.0 + moving) * 9.81 / (turning / 3.0 + moving)).sqrt() }
    }

    /// Angle (rad) from the vertical and its rate: sin(α/2) = k cd(ω t), k = sin 30°.
    ///
    /// Source: Whittaker 1937, §44; elliptic functions by the arithmetic-geometric mean (Abramowitz & Stegun 16.4).
    fn at(&self, t: f64) -> (f64, f64) {
        let modulus = (FRAC_PI_3 / 2.0).sin();
        let (mut a, mut b, mut c) = (vec![1.0], (1.0 - modulus * modulus).sqrt(), vec![modulus]);
        while c[c.len() - 1] > f64::EPSILON {
            let last = a[a.len() - 1];
            a.push(0.5 * (last + b));
            c.push(0.5 * (last - b));
            b = (last * b).sqrt();
        }
        let steps = a.len() - 1;
        let quarter = std::f64::consts::FRAC_PI_2 / a[steps];
        let mut phase = f64::from(1_u32 << steps) * a[steps] * (self.frequency * t + quarter);
        for step in (1..=steps).rev() {
            phase = 0.5 * (phase + (c[step] / a[step] * phase.sin()).asin());
        }
        // sn(u + K) = cd(u), cn(u + K) < 0 on the way down.
        let (sn, cn) = phase.sin_cos();
        (2.0 * (modulus * sn).asin(), 2.0 * self.frequency * modulus * cn)
    }

    fn state<const N: usize>(&self, t: f64) -> State<N> {
        let (angle, rate) = self.at(t);
        let (sine, cosine) = angle.sin_cos();
        State {
            q: std::array::from_fn(|k| if k % 2 == 0 { (k / 2) as f64 + sine } else { -cosine }),
            qd: std::array::from_fn(|k| rate * if k % 2 == 0 { cosine } else { sine }),
        }
    }

    fn accelerations<const N: usize>(&self, t: f64) -> [f64; N] {
        let (angle, rate) = self.at(t);
        let (sine, cosine) = angle.sin_cos();
        let bend = -self.frequency * self.frequency * sine;
        std::array::from_fn(|k| {
            if k % 2 == 0 { bend * cosine - rate * rate * sine } else { bend * sine + rate * rate * cosine }
        })
    }
}

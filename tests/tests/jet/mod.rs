//! Numbers that carry two derivatives along a curve, and the comparison of a mechanism with formulas in them.

use std::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::Kinematic;

/// Value, first and second derivative along a curve.
#[derive(Clone, Copy, Debug)]
pub struct Jet([f64; 3]);

impl Jet {
    pub fn new(value: f64, first: f64, second: f64) -> Self {
        Jet([value, first, second])
    }

    pub fn number(value: f64) -> Self {
        Jet([value, 0.0, 0.0])
    }

    pub fn value(self) -> f64 {
        self.0[0]
    }

    /// Value, first and second derivative.
    pub fn parts(self) -> [f64; 3] {
        self.0
    }

    /// The derivative; its own second derivative is unknown (NaN).
    pub fn rate(self) -> Self {
        Jet([self.0[1], self.0[2], f64::NAN])
    }

    /// A function with its value and first two derivatives at the value.
    pub fn apply(self, [f, df, ddf]: [f64; 3]) -> Self {
        let [_, first, second] = self.0;
        Jet([f, df * first, df * second + ddf * first * first])
    }

    pub fn sqrt(self) -> Self {
        let root = self.0[0].sqrt();
        self.apply([root, 0.5 / root, -0.25 / (root * root * root)])
    }

    pub fn exp(self) -> Self {
        self.apply([self.0[0].exp(); 3])
    }

    pub fn ln(self) -> Self {
        let x = self.0[0];
        self.apply([x.ln(), 1.0 / x, -1.0 / (x * x)])
    }

    pub fn sin(self) -> Self {
        let (sine, cosine) = self.0[0].sin_cos();
        self.apply([sine, cosine, -sine])
    }

    pub fn cos(self) -> Self {
        let (sine, cosine) = self.0[0].sin_cos();
        self.apply([cosine, -sine, -cosine])
    }

    pub fn asin(self) -> Self {
        let x = self.0[0];
        let root = (1.0 - x * x).sqrt();
        self.apply([x.asin(), 1.0 / root, x / (root * root * root)])
    }

    pub fn atan(self) -> Self {
        let x = self.0[0];
        let slope = 1.0 / (1.0 + x * x);
        self.apply([x.atan(), slope, -2.0 * x * slope * slope])
    }

    /// Of a positive number.
    pub fn pow(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, other: Jet) -> Jet {
        Jet(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        Jet(self.0.map(|part| -part))
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, other: Jet) -> Jet {
        self + -other
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, other: Jet) -> Jet {
        let ([a, da, dda], [b, db, ddb]) = (self.0, other.0);
        Jet([a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb])
    }
}

impl Div for Jet {
    type Output = Jet;
    fn div(self, other: Jet) -> Jet {
        let x = other.0[0];
        self * other.apply([1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)])
    }
}

macro_rules! with_numbers {
    ($($operation:ident $method:ident),*) => {$(
        impl $operation<f64> for Jet {
            type Output = Jet;
            fn $method(self, other: f64) -> Jet {
                $operation::$method(self, Jet::number(other))
            }
        }
        impl $operation<Jet> for f64 {
            type Output = Jet;
            fn $method(self, other: Jet) -> Jet {
                $operation::$method(Jet::number(self), other)
            }
        }
    )*};
}

with_numbers!(Add add, Sub sub, Mul mul, Div div);

/// Coordinates and time at which a mechanism is compared, with rates that follow from them.
pub struct State<const N: usize> {
    q: [f64; N],
    qd: [f64; N],
    qdd: [f64; N],
    t: f64,
}

/// A state whose first coordinates are given, the others spread over 0.2 to 0.9.
pub fn state<const N: usize, const K: usize>(first: [f64; K], t: f64) -> State<N> {
    let q = std::array::from_fn(|i| first.get(i).copied().unwrap_or(0.2 + 0.7 * i as f64 / N as f64));
    let qd = std::array::from_fn(|i| 1.3 * (1.0 + 2.0 * i as f64).sin());
    let qdd = std::array::from_fn(|i| 0.9 * (0.5 + 3.0 * i as f64).cos());
    State { q, qd, qdd, t }
}

/// Equal but for rounding.
#[track_caller]
pub fn close(found: f64, expected: f64, what: &str) {
    let error = (found - expected).abs();
    assert!(error <= 1e-12 * (1.0 + expected.abs()), "{what}: {found} instead of {expected}");
}

/// Compares residuals, all derivatives and outputs of a mechanism with formulas for its rows and outputs.
#[track_caller]
pub fn check<S: Kinematic<f64, N>, const N: usize>(
    mechanism: &S,
    state: &State<N>,
    formulas: impl Fn(&[Jet; N], Jet) -> (Vec<Jet>, Vec<Jet>),
) {
    let State { q, qd, qdd, t } = *state;
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, &q, t);
    // Rows along the curve q + s·qd + s²/2·qdd, t + s·pace.
    let along = |qd: [f64; N], qdd: [f64; N], pace: f64| {
        let q = std::array::from_fn(|i| Jet([q[i], qd[i], qdd[i]]));
        formulas(&q, Jet([t, pace, 0.0]))
    };
    let zero = [0.0; N];
    let (rows, _) = along(zero, zero, 1.0);
    let (phi, phi_t) = (mechanism.phi(&parameters, &position), mechanism.phi_t(&parameters, &position));
    let phi_tt = mechanism.phi_tt(&parameters, &position);
    assert_eq!(rows.len(), N);
    for (i, row) in rows.iter().enumerate() {
        close(phi[i], row.0[0], &format!("Φ {i}"));
        close(phi_t[i], row.0[1], &format!("Φ_t {i}"));
        close(phi_tt[i], row.0[2], &format!("Φ_tt {i}"));
    }
    let phi_q = mechanism.phi_q(&parameters, &position);
    for column in 0..N {
        let axis = std::array::from_fn(|i| if i == column { 1.0 } else { 0.0 });
        for (i, (row, entries)) in along(axis, zero, 0.0).0.iter().zip(&phi_q).enumerate() {
            close(entries[column], row.0[1], &format!("Φ_q {i}, {column}"));
        }
    }
    let ((moving, _), (held, _)) = (along(qd, zero, 1.0), along(qd, zero, 0.0));
    let gamma = mechanism.gamma(&parameters, &position, &qd);
    let phi_qt_qd = mechanism.phi_qt_qd(&parameters, &position, &qd);
    for i in 0..N {
        close(gamma[i], -moving[i].0[2], &format!("γ {i}"));
        // Second derivatives along (q̇, 1), (q̇, 0) and (0, 1).
        let mixed = 0.5 * (moving[i].0[2] - held[i].0[2] - rows[i].0[2]);
        close(phi_qt_qd[i], mixed, &format!("Φ_qt q̇ {i}"));
    }
    let (_, expected) = along(qd, qdd, 1.0);
    let outputs = mechanism.outputs(&parameters, &position, &qd, &qdd);
    assert_eq!(outputs.as_ref().len(), expected.len());
    for (i, (output, expected)) in outputs.as_ref().iter().zip(&expected).enumerate() {
        close(output.value, expected.0[0], &format!("output {i}"));
        if let Some(rate) = output.rate {
            close(rate, expected.0[1], &format!("rate of output {i}"));
        }
        if let Some(acceleration) = output.acceleration {
            close(acceleration, expected.0[2], &format!("acceleration of output {i}"));
        }
    }
    let evaluation = mechanism.evaluate(&parameters, &q, t, &qd);
    let entries = mechanism.phi_q_entries(&parameters, &position);
    assert_eq!((evaluation.phi, evaluation.phi_q_entries.as_ref()), (phi, entries.as_ref()));
    assert_eq!((evaluation.phi_t, evaluation.gamma), (phi_t, gamma));
}

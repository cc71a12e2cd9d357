//! Closed forms that the tests compare with: geometry on numbers that carry two time derivatives.
//!
//! Nothing here is shared with the symbolic core or the solvers. A position is written as a formula of the time;
//! its derivatives follow by the product and chain rules in [`Jet`]'s operators.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use core::ops::{Add, Div, Mul, Neg, Sub};

use mbs_workbench::erased::facade::Motion;

/// A value with its first and second time derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet(pub [f64; 3]);

/// A point or vector of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector(pub Jet, pub Jet);

impl Jet {
    /// The time itself (s).
    pub fn time(t: f64) -> Self {
        Jet([t, 1.0, 0.0])
    }

    /// `f(self)` by the chain rule, from the value and first two derivatives of `f`.
    fn chain(self, [f, f1, f2]: [f64; 3]) -> Self {
        let Jet([_, v, a]) = self;
        Jet([f, f1 * v, f2 * v * v + f1 * a])
    }

    pub fn sin(self) -> Self {
        let (s, c) = self.0[0].sin_cos();
        self.chain([s, c, -s])
    }

    pub fn cos(self) -> Self {
        (self + FRAC_PI_2).sin()
    }

    pub fn sqrt(self) -> Self {
        let root = self.0[0].sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * self.0[0])])
    }

    pub fn square(self) -> Self {
        self * self
    }
}

impl Vector {
    /// A point at rest.
    pub fn fixed(x: f64, y: f64) -> Self {
        Vector(x.into(), y.into())
    }

    /// The unit vector at `angle` (rad).
    pub fn unit(angle: impl Into<Jet>) -> Self {
        let angle = angle.into();
        Vector(angle.cos(), angle.sin())
    }

    pub fn dot(self, other: Self) -> Jet {
        self.0 * other.0 + self.1 * other.1
    }

    pub fn length(self) -> Jet {
        self.dot(self).sqrt()
    }

    /// A quarter turn to the left.
    pub fn left(self) -> Self {
        Vector(-self.1, self.0)
    }

    /// Direction (rad): of `ẋ = v`, `θ̇ = x × v / x²` and `θ̈ = (x × a)/x² − 2 θ̇ (x · v)/x²`.
    pub fn angle(self) -> Jet {
        let part = |k: usize| [self.0.0[k], self.1.0[k]];
        let ([x, y], [u, v], [a, b]) = (part(0), part(1), part(2));
        let square = x * x + y * y;
        let rate = (x * v - y * u) / square;
        Jet([y.atan2(x), rate, (x * b - y * a) / square - 2.0 * rate * (x * u + y * v) / square])
    }

    /// Intersection of two circles: the point at distance `r` from here and `s` from `other`. It lies on the
    /// left (`side = 1`) or right (`-1`) of the way from here to `other`.
    pub fn meet(self, r: f64, other: Self, s: f64, side: f64) -> Self {
        let way = other - self;
        let square = way.dot(way);
        let along = (square + r * r - s * s) / (square * 2.0);
        let across = (Jet::from(r * r) / square - along.square()).sqrt();
        self + way * along + way.left() * (across * side)
    }
}

/// The root `s(t)` of `f(s, t) = 0` next to `start`, with its derivatives by implicit differentiation.
///
/// `f` gets both arguments with their time derivatives and must be smooth with `∂f/∂s ≠ 0`.
pub fn root(start: f64, t: Jet, f: impl Fn(Jet, Jet) -> Jet) -> Jet {
    let still = Jet::from(t.0[0]);
    let slope = |s: f64| f(Jet([s, 1.0, 0.0]), still).0;
    // Newton's method from the previous instant's root: far more steps than it takes.
    let s = (0..50).fold(start, |s, _| {
        let [value, slope, _] = slope(s);
        s - value / slope
    });
    let [_, slope, _] = slope(s);
    let rate = -f(Jet([s, 0.0, 0.0]), t).0[1] / slope;
    Jet([s, rate, -f(Jet([s, rate, 0.0]), t).0[2] / slope])
}

/// Points `A`, `B`, `D` and the coupler point of the lecture's four-bar, with the numbers and the `side` of its text.
pub fn lecture_four_bar(t: Jet, side: f64) -> [Vector; 4] {
    let (a, d) = (Vector::unit(t * TAU) * 0.2, Vector::fixed(0.55, 0.0));
    let b = a.meet(0.6, d, 0.5, side);
    let way = (b - a) * (0.35 / 0.6);
    let (sin, cos) = (PI / 6.0).sin_cos();
    [a, b, d, a + way * cos + way.left() * sin]
}

/// The motion equals `form` at every instant, for the coordinates or outputs `names` (components `P.0` apart).
///
/// Errors of positions, rates and accelerations are parts of the largest magnitude over all `names` of that unit and
/// the whole motion; an angle counts on the circle, as a part of 1 rad at least. The scale of a derivative is at
/// least that of the position times the angular frequency of the motion, to its order. So what ought to stand still
/// is judged by what moves.
#[track_caller]
pub fn assert_moves_as(motion: &Motion, names: &[&str], bound: f64, mut form: impl FnMut(Jet) -> Vec<Jet>) {
    let columns: Vec<_> = names.iter().map(|name| column(motion, name)).collect();
    let expected: Vec<Vec<Jet>> = motion.time.iter().map(|t| form(Jet::time(*t))).collect();
    let frequency = TAU / motion.time.last().copied().unwrap_or(1.0);
    let mut worst = (0.0, String::new());
    for order in 0..3 {
        for (index, (unit, found)) in columns.iter().enumerate() {
            let same = |other: &usize| columns[*other].0 == *unit;
            let largest = |order: usize| {
                let all =
                    expected.iter().flat_map(|row| (0..names.len()).filter(same).map(|i| row[i].0[order]));
                all.fold(0.0_f64, |a, b| a.max(b.abs()))
            };
            let place = if *unit == "rad" { largest(0).max(1.0) } else { largest(0) };
            let scale = largest(order).max(place * frequency.powi(order as i32));
            for (step, (found, row)) in found[order].iter().zip(&expected).enumerate() {
                assert_eq!(row.len(), names.len(), "one value a name");
                let difference = found - row[index].0[order];
                let on_circle = order == 0 && *unit == "rad";
                let difference = if on_circle { (difference + PI).rem_euclid(TAU) - PI } else { difference };
                let error = difference.abs() / scale;
                // Not a number is no agreement.
                if error > worst.0 || error.is_nan() {
                    let (time, value) = (motion.time[step], found);
                    let text =
                        format!("{}, order {order}, at {time} s: {value}, error {error:e}", names[index]);
                    worst = (error, text);
                }
            }
        }
    }
    println!("largest error {:e} in {}", worst.0, worst.1);
    assert!(worst.0 <= bound, "{}", worst.1);
}

/// Unit and `[value, rate, acceleration]` of a coordinate or of a component of an output.
#[track_caller]
pub fn column<'a>(motion: &'a Motion, name: &str) -> (&'static str, [&'a [f64]; 3]) {
    if let Some(curve) = motion.coordinates.iter().find(|curve| curve.name == name) {
        return (curve.unit, [&curve.q, &curve.qd, &curve.qdd]);
    }
    let curve = motion.outputs.iter().find(|curve| curve.name == name);
    let curve = curve.unwrap_or_else(|| panic!("neither coordinate nor output: {name}"));
    let derivative = |column: &'a Option<Vec<f64>>| column.as_deref().expect("two derivatives");
    (curve.unit, [&curve.value, derivative(&curve.rate), derivative(&curve.acceleration)])
}

impl From<f64> for Jet {
    fn from(value: f64) -> Self {
        Jet([value, 0.0, 0.0])
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Jet(self.0.map(|x| -x))
    }
}

impl<R: Into<Jet>> Add<R> for Jet {
    type Output = Self;
    fn add(self, other: R) -> Self {
        let (Jet([a, b, c]), Jet([x, y, z])) = (self, other.into());
        Jet([a + x, b + y, c + z])
    }
}

impl<R: Into<Jet>> Sub<R> for Jet {
    type Output = Self;
    fn sub(self, other: R) -> Self {
        self + -other.into()
    }
}

impl<R: Into<Jet>> Mul<R> for Jet {
    type Output = Self;
    fn mul(self, other: R) -> Self {
        let (Jet([a, b, c]), Jet([x, y, z])) = (self, other.into());
        Jet([a * x, b * x + a * y, c * x + 2.0 * b * y + a * z])
    }
}

impl<R: Into<Jet>> Div<R> for Jet {
    type Output = Self;
    fn div(self, other: R) -> Self {
        let other = other.into();
        let inverse = 1.0 / other.0[0];
        self * other.chain([inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse])
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Vector(self.0 + other.0, self.1 + other.1)
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Vector(self.0 - other.0, self.1 - other.1)
    }
}

impl<R: Into<Jet>> Mul<R> for Vector {
    type Output = Self;
    fn mul(self, factor: R) -> Self {
        let factor = factor.into();
        Vector(self.0 * factor, self.1 * factor)
    }
}

/// Differences of second order, on a formula with every operation.
#[test]
fn jets_are_the_derivatives() {
    let f = |t: Jet| {
        let p = Vector::unit(t * 2.0) * (t.square() + 1.0) + Vector::fixed(0.3, 0.1);
        let q = Vector::fixed(1.5, 0.4).meet(2.0, p, 2.5, -1.0);
        q.angle() / (q.length() - 7.0) + root(0.5, t, |s, t| s * 2.0 + s.sin() - t)
    };
    let (t, h) = (0.4, 1e-4);
    let [before, Jet(now), after] = [t - h, t, t + h].map(|t| f(Jet::time(t)));
    let rate = (after.0[0] - before.0[0]) / (2.0 * h);
    let acceleration = (after.0[0] - 2.0 * now[0] + before.0[0]) / (h * h);
    assert!((now[1] - rate).abs() < 1e-6 * rate.abs(), "{now:?} {rate}");
    assert!((now[2] - acceleration).abs() < 1e-5 * acceleration.abs(), "{now:?} {acceleration}");
}

use std::vec::Vec;

use crate::scalar::interval::*;

extern crate std;

/// Numbers of a fixed seed between −1 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Of all sizes, zero among them.
    fn any(&mut self) -> f64 {
        let size = 10.0_f64.powf(4.0 * self.next());
        let value = size * self.next();
        if self.next() > 0.9 { 0.0 } else { value }
    }

    fn interval(&mut self) -> (f64, f64) {
        let middle = self.any();
        let width = 10.0_f64.powf(6.0 * self.next()).min(100.0);
        (middle - width * self.next().abs(), middle + width * self.next().abs())
    }

    fn within(&mut self, (low, high): (f64, f64)) -> f64 {
        match (4.0 * self.next()) as i32 {
            3 => low,
            -3 => high,
            _ => (low + (high - low) * 0.5 * (1.0 + self.next())).clamp(low, high),
        }
    }
}

type Pair<T> = (&'static str, fn(T, T) -> T);

macro_rules! functions {
    ($T:ty) => {{
        let functions: Vec<Pair<$T>> = std::vec![
            ("+", |a, b| a + b),
            ("-", |a, b| a - b),
            ("*", |a, b| a * b),
            ("/", |a, b| a / b),
            ("negate", |a, _| -a),
            ("sqrt", |a, _| a.sqrt()),
            ("exp", |a, _| a.exp()),
            ("ln", |a, _| a.ln()),
            ("sin", |a, _| Scalar::sin_cos([a]).0[0]),
            ("cos", |a, _| Scalar::sin_cos([a]).1[0]),
            ("tan", |a, _| a.tan()),
            ("asin", |a, _| a.asin()),
            ("acos", |a, _| a.acos()),
            ("atan", |a, _| a.atan()),
            ("atan2", |a, b| a.atan2(b)),
            ("sinh", |a, _| a.sinh()),
            ("cosh", |a, _| a.cosh()),
            ("tanh", |a, _| a.tanh()),
            ("asinh", |a, _| Scalar::asinh(a)),
            ("acosh", |a, _| Scalar::acosh(a)),
            ("atanh", |a, _| Scalar::atanh(a)),
            ("powf", |a, b| a.powf(b)),
            ("square", |a, _| a.powf(<$T>::constant(2.0))),
            ("cube", |a, _| a.powf(<$T>::constant(3.0))),
            ("inverse", |a, _| a.powf(<$T>::constant(-1.0))),
            ("inverse square", |a, _| a.powf(<$T>::constant(-2.0))),
            ("hypot", |a, b| a.hypot(b)),
            ("abs", |a, _| a.abs()),
            ("sign", |a, _| a.sign()),
            ("min", |a, b| a.min(b)),
            ("max", |a, b| a.max(b)),
            ("select", |a, b| Scalar::select(a.less(b), a * b, a - b)),
            ("decided", |a, b| Scalar::select(!(a.less(b)) | b.less(<$T>::constant(1.0)), b, -a)),
        ];
        functions
    }};
}

macro_rules! encloses {
    ($R:ident) => {{
        let points = functions!($R);
        let intervals = functions!(Interval<$R>);
        let mut random = Random(7);
        let mut useful = 0;
        for (point, interval) in points.iter().zip(&intervals) {
            for _ in 0..4_000 {
                let (a, b) = (random.interval(), random.interval());
                let of = |(low, high)| Interval::between(low as $R, high as $R);
                let enclosure = interval.1(of(a), of(b));
                useful += u32::from(enclosure.low.is_finite() && enclosure.high.is_finite());
                for _ in 0..8 {
                    let within = |value: f64, of: Interval<$R>| (value as $R).clamp(of.low, of.high);
                    let (x, y) = (within(random.within(a), of(a)), within(random.within(b), of(b)));
                    let value = point.1(x, y);
                    let inside = enclosure.low <= value && value <= enclosure.high;
                    let unknown = enclosure == Interval::whole();
                    assert!(
                        inside || value.is_nan() && unknown,
                        "{} {a:?} {b:?}: {x} {y} {value} {enclosure:?}",
                        point.0
                    );
                }
            }
        }
        // Of most boxes something is known.
        assert!(useful > 60_000, "{useful}");
    }};
}

#[test]
fn values_of_all_functions_are_within_their_intervals() {
    encloses!(f64);
    encloses!(f32);
}

#[test]
fn sines_of_narrow_intervals_are_narrow() {
    for step in 0..1_000 {
        let angle = 0.013 * f64::from(step);
        let ([sine], [cosine]) = Interval::sin_cos([Interval::between(angle, angle + 1e-6)]);
        assert!(sine.high - sine.low < 1.1e-6 && cosine.high - cosine.low < 1.1e-6);
    }
}

#[test]
fn an_operation_without_a_number_encloses_everything() {
    for value in [f64::NAN, f64::INFINITY] {
        let any = Interval::of(value) - Interval::of(value);
        assert_eq!((any.low, any.high), (f64::NEG_INFINITY, f64::INFINITY));
    }
    let mask = Interval::of(f64::NAN).less(Interval::of(0.0));
    assert!(!Interval::<f64>::all(mask) && !Interval::<f64>::all(!mask));
}

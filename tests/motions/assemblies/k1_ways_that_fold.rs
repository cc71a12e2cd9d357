//! K1: rows that come back on the way of a parameter, of an input together with coordinates, or of a sine and a cosine that are no
//! direction. Behind a change point the mechanism stayed on the side that it had come from, with `Ok`.

use mbs_runtime::{Batch, Budget, Kinematic, Lanes, Real, Scalar, Signal, Step, Stepper, mechanism};

/// A text whose change from −d to d leads through a change point.
trait Fold<T: Scalar, const N: usize>: Kinematic<T, N> {
    /// Puts the input or parameter at this place; an input without a rate.
    fn put(&mut self, place: T);
    /// Coordinates at a place.
    fn at(place: f64) -> [f64; N];
}

fn still<T: Scalar>(value: T) -> Signal<T> {
    Signal { value, rate: T::constant(0.0), acceleration: T::constant(0.0) }
}

macro_rules! fold {
    ($name:ident, $n:literal, { $($text:tt)* }, |$m:ident, $v:ident| $put:expr, |$d:ident| $at:expr) => {
        mechanism! {
            /// A mechanism with a change point.
            pub mechanism $name;
            $($text)*
        }
        impl<T: Scalar> Fold<T, $n> for $name<T> {
            fn put(&mut self, $v: T) {
                let $m = self;
                $put
            }
            fn at($d: f64) -> [f64; $n] {
                $at
            }
        }
    };
}

/// Angle (rad) of a toggle of two bars of 1 m that 1.5 m + 0.5 m cos α holds.
fn toggle(alpha: f64) -> f64 {
    2.0 * (0.5 * (0.5 * alpha).sin()).asin()
}

/// Height (m) of the end of a bar of 2 m whose other end is off by `d`.
fn height(d: f64) -> f64 {
    ((2.0 - d) * (2.0 + d)).sqrt()
}

fold!(Lean, 4, {
    input s: m, rates;
    coord H: [m; 2] = [0, 2];
    coord K: [m; 2] = [0.1, 1];
    constraint lean { norm([s, 0] - H) == 2m; H.0 == 0; }
    constraint bars { norm(K) == 1m; norm(K - H) == 1m; }
}, |m, v| m.s = still(v), |d| [0.0, height(d), 0.5 * d, 0.5 * height(d)]);
fold!(LeanOnAnInput, 4, {
    input s: m, rates;
    input h: m, rates;
    coord H: [m; 2] = [0, 2];
    coord K: [m; 2] = [0.1, 1];
    constraint lean { norm([s, 0] - H) == 2m; H.0 == h; }
    constraint bars { norm(K) == 1m; norm(K - H) == 1m; }
}, |m, v| m.s = still(v), |d| [0.0, height(d), 0.5 * d, 0.5 * height(d)]);
fold!(Trammel, 3, {
    input s: m, rates;
    coord y: m = 2;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint trammel { norm([s, 0] - [0, y]) == 2m; }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [y, 0]; }
}, |m, v| m.s = still(v), |d| [height(d), (0.5 * d).asin(), -(0.5 * d).asin()]);
fold!(Plumb, 5, {
    input s: m, rates;
    coord P: [m; 2] = [0, 0];
    coord y: m = 2;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint anchor { P == [0, 0]; }
    constraint line { y == 3m - norm([s, 1m] - P); }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [y, 0]; }
}, |m, v| m.s = still(v), |d| {
    // 2 − y = √(1 + d²) − 1, without cancellation.
    let fall = d * d / ((1.0 + d * d).sqrt() + 1.0);
    let phi = 2.0 * (0.5 * fall.sqrt()).asin() * d.signum();
    [0.0, 0.0, 2.0 - fall, phi, -phi]
});
fold!(Shadow, 5, {
    input alpha: rad, rates;
    coord P: [m; 2] = [0.5, 0];
    coord x: m = 2;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint arm { P == [0.5m, 0]; }
    constraint shadow { x == 1.5m + dot(P, unit(alpha)); }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [x, 0]; }
}, |m, v| m.alpha = still(v), |a| [0.5, 0.0, 1.5 + 0.5 * a.cos(), toggle(a), -toggle(a)]);
fold!(ByParameter, 2, {
    param alpha: rad = 0.3;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [1.5m + 0.5m*cos(alpha), 0]; }
}, |m, v| m.alpha = v, |a| [toggle(a), -toggle(a)]);
fold!(ByParameterOfADrive, 3, {
    param alpha: rad = 0.3;
    param r: m = 0.5;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    coord x: m = 2;
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [x, 0]; }
    drive slider: x == 2m - r + r*cos(alpha);
}, |m, v| m.alpha = v, |a| [toggle(a), -toggle(a), 1.5 + 0.5 * a.cos()]);
fold!(TwoCams, 3, {
    input theta: rad, rates;
    coord z: m;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint pump { z == 1 [um]*sin(theta); }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [1.5m + 0.5m*cos(theta), 0]; }
}, |m, v| m.theta = still(v), |a| [1e-6 * a.sin(), toggle(a), -toggle(a)]);
fold!(NoCam, 3, {
    input theta: rad, rates;
    coord z: m;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint pump { z == 0*1m*sin(theta); }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [1.5m + 0.5m*cos(theta), 0]; }
}, |m, v| m.theta = still(v), |a| [0.0, toggle(a), -toggle(a)]);
/// Phase (rad) of the stroke 0.3 cos + 0.4 sin.
fn phase() -> f64 {
    0.4_f64.atan2(0.3) - 1.0
}
fold!(Fourier, 4, {
    input theta: rad, rates;
    coord x: m = 2;
    coord y: m = 1;
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    let s = 0.3m*cos(theta + 1) + 0.4m*sin(theta + 1);
    drive a: x == 1.5m + s;
    drive b: y == 2*s;
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [x, 0]; }
}, |m, v| m.theta = still(v + T::constant(phase())), |a| {
    [1.5 + 0.5 * a.cos(), a.cos(), toggle(a), -toggle(a)]
});
fold!(Elbow, 4, {
    input theta: rad, rates;
    input beta: rad, rates;
    coord A: [m; 2] = [2, 0];
    coord phi: rad = 0.1;
    coord psi: rad = -0.1;
    constraint arm { A == 1m*unit(theta) + 1m*unit(beta); }
    constraint toggle { 1m*unit(phi) + 1m*unit(psi) == [A.0, 0]; }
}, |m, v| (m.theta, m.beta) = (still(v), still(-v)), |a| [2.0 * a.cos(), 0.0, a, -a]);

/// The state after a change from one place to another, if the step was taken, as far as it is off.
fn off<R: Real, const N: usize>(q: &[R; N], right: [f64; N]) -> f64 {
    q.iter().zip(right).map(|(found, right)| (found.to_f64() - right).abs()).fold(0.0, f64::max)
}

/// Distances from the change point, in the unit of the place: an angle changes by less than 0.35 rad. Nearer than rounding allows, the
/// first position does not determine rates.
fn distances<R: Real>() -> impl Iterator<Item = f64> {
    let least = 256.0 * R::EPSILON.to_f64().sqrt();
    (1..=32).map(|k| 0.005 * f64::from(k)).filter(move |d| least < *d)
}

/// Error that a position at a distance `d` from a change point may have: open rows within their tolerance of 64 roundings, and the rounding
/// of the coordinates, over the margin.
fn allowed<R: Real>(d: f64) -> f64 {
    96.0 * R::EPSILON.to_f64() / d
}

/// Positions behind the change point, taken by `step`; returns the number of steps refused.
fn refused<S, R, const N: usize>(mut step: impl FnMut(&mut Stepper<S, R, N>, R) -> bool) -> usize
where
    S: Fold<R, N> + Default,
    R: Real,
{
    let mut count = 0;
    for d in distances::<R>() {
        for side in [1.0, -1.0] {
            let (from, to) = (R::constant(-side * d), R::constant(side * d));
            let mut mechanism = S::default();
            mechanism.put(from);
            let guess = S::at(from.to_f64()).map(R::constant);
            let mut stepper: Stepper<S, R, N> = Stepper::assemble(mechanism, guess, R::constant(0.0))
                .unwrap_or_else(|failure| panic!("{} {d}: {failure}", S::NAME));
            stepper.change(|mechanism| mechanism.put(to));
            if step(&mut stepper, to) {
                let off = off(stepper.q(), S::at(to.to_f64()));
                assert!(off < allowed::<R>(d), "{} {d} {side}: off by {off:e}", S::NAME);
            } else {
                count += 1;
            }
        }
    }
    count
}

/// The same in lanes, each with a change of its own.
fn keeps_in_lanes<S, const N: usize>()
where
    S: Fold<Lanes<f64, 4>, N> + Default,
    S::Lane: Kinematic<f64, N>,
{
    for d in distances::<f64>() {
        let places = [-d, d, -0.5 * d, d];
        let ends = [d, -d, 0.5 * d, d];
        let mut mechanism = S::default();
        mechanism.put(Lanes(places));
        let mut batch = Batch::<S, f64, 4, N>::assemble(mechanism, &places.map(S::at), [0.0; 4])
            .unwrap_or_else(|(lane, failure)| panic!("{} {d} {lane}: {failure}", S::NAME));
        batch.change(|mechanism| mechanism.put(Lanes(ends)));
        for (lane, step) in batch.advance_to([1.0; 4]).into_iter().enumerate() {
            step.unwrap_or_else(|failure| panic!("{} {d} {lane}: {failure}", S::NAME));
            let q = batch.q().map(|coordinate| coordinate.0[lane]);
            let off = off(&q, S::at(ends[lane]));
            assert!(off < allowed::<f64>(0.5 * d), "{} {d} {lane}: off by {off:e}", S::NAME);
        }
    }
}

/// More than any step takes.
const AMPLE: Budget = Budget { newton: 3_000, fallback: 0 };

macro_rules! kept {
    ($($test:ident: $mechanism:ident, $n:literal;)*) => {
        $(#[test]
        fn $test() {
            type Text<T> = $mechanism<T>;
            let advance = |stepper: &mut Stepper<Text<f64>, f64, $n>, _| stepper.advance(1.0).is_ok();
            assert_eq!(refused::<Text<f64>, f64, $n>(advance), 0);
            // And once more where nothing changes.
            assert_eq!(refused::<Text<f64>, f64, $n>(|stepper, to| {
                stepper.advance(1.0).is_ok() && {
                    stepper.change(|mechanism| mechanism.put(to));
                    stepper.advance(1.0).is_ok()
                }
            }), 0);
            let within = |budget| {
                refused::<Text<f64>, f64, $n>(|stepper, _| matches!(stepper.step(1.0, budget), Step::Done(_)))
            };
            assert_eq!(within(AMPLE), 0);
            within(Budget::DEFAULT);
            refused::<Text<f32>, f32, $n>(|stepper, _| stepper.advance(1.0).is_ok());
            keeps_in_lanes::<Text<Lanes<f64, 4>>, $n>();
        })*
    };
}

kept! {
    a_bar_leans_on_a_point: Lean, 4;
    a_bar_leans_on_an_input: LeanOnAnInput, 4;
    a_trammel_holds_a_toggle: Trammel, 3;
    a_line_over_a_pulley_holds_a_toggle: Plumb, 5;
    a_shadow_of_an_arm_holds_a_toggle: Shadow, 5;
    a_parameter_holds_a_toggle: ByParameter, 2;
    a_parameter_of_a_drive_holds_a_toggle: ByParameterOfADrive, 3;
    a_cam_of_a_micrometre_stands_beside: TwoCams, 3;
    a_cam_of_no_stroke_stands_beside: NoCam, 3;
    a_stroke_in_two_rows_holds_a_toggle: Fourier, 4;
    an_elbow_of_two_inputs_holds_a_toggle: Elbow, 4;
}

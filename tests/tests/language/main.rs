//! The language end to end: compiled texts compute the values of their formulas.
//!
//! Every text is followed by its formulas in Rust, written for second-order [`Jet`]s that share nothing with the
//! macro; [`check`] compares all functions of the emitted code with them.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[path = "../jet/mod.rs"]
mod jet;

mod numbers;
mod values;

use std::f64::consts::{PI, TAU};

use jet::{Jet, check, close, state};
use mbs_runtime::{Kinematic, Lanes, Mechanism, Scalar, Signal, Stepper, mechanism};

/// This file, to find the lines that the tables name.
const FILE: &str = include_str!("main.rs");

mechanism! {
    /// One row an operator or a function of one argument.
    pub mechanism Operators;
    coord x: 1 = 0.3;
    coord z: 1 = 0.7;
    coord y: [1; 16];
    drive first: x == 0.3 + 0.2*sin(t/1s);
    drive second: z == 0.7 - 0.1*t/1s;
    constraint each {
        y[0] == x + z;
        y[1] == x - z;
        y[2] == x*z;
        y[3] == x/z;
        y[4] == -x;
        y[5] == (2 + x)^z;
        y[6] == x^3;
        y[7] == x^-2;
        y[8] == (1 + x)^0.5;
        y[9] == (1 + x)^-1.5;
        y[10] == sqrt(1 + x*z);
        y[11] == exp(-x*z);
        y[12] == ln(1 + x*z);
        y[13] == sin(x*z);
        y[14] == cos(x + z);
        y[15] == tan(x*z);
    }
}

mechanism! {
    /// One row a function.
    pub mechanism Functions;
    coord x: 1 = 0.3;
    coord z: 1 = 0.7;
    coord y: [1; 16];
    drive first: x == 0.3 + 0.2*sin(t/1s);
    drive second: z == 0.7 - 0.1*t/1s;
    constraint each {
        y[0] == asin(x*z);
        y[1] == acos(x*z);
        y[2] == atan(x - 3*z);
        y[3] == atan2(x, z);
        y[4] == sinh(x*z);
        y[5] == cosh(x*z);
        y[6] == tanh(x*z);
        y[7] == abs(x - z);
        y[8] == sign(x - z)*x;
        y[9] == min(x, z, x*z);
        y[10] == max(x, z, x*z);
        y[11] == hypot(x, z, x*z);
        y[12] == sum(i in 0..3: (i + 1)*x^i);
        y[13] == 1/2 + x - PI/TAU*z;
        y[14] == x*sin(x)*cos(x)/(2 + sin(x)*cos(z));
        y[15] == z^x*t/1s;
    }
}

mechanism! {
    /// Planar vectors: a point on a bar on a slide.
    mechanism Plane;
    param L: [m; 2] = [300mm, 0.2];
    param c: [m; 2] = [0.1, -50mm];
    coord p: [m; 2] = [0.1, 0.2];
    coord r: [m; 2];
    coord phi: rad = 30deg;
    let tip = p + rot(phi)*c;
    let arm = L[0]*unit(phi);
    constraint point { r == tip + arm - [L.1, 0]*2; }
    constraint length { dot(p - c, p - c) == (0.1m)^2; }
    constraint side { cross(p, unit(phi)) == 50mm; }
    drive turn: phi == 0.3 + t*0.5/1s;
    out distance: m = norm(r - p);
    out area: [m^2; 2] = [det(p, r), det([[p.0, p.1], [r[0], r[1]]])];
    out speed: [m/s; 2] = der(tip);
    out acceleration: [m/s^2; 2] = der2(tip);
}

mechanism! {
    /// Vectors of three components, matrices, arrays of parameters and coordinates.
    mechanism Space;
    param A: [1; 3, 3] = [[1, 2, 0.5], [-1, 0.3, 0], [0.2, 0, 2]];
    param b: [1; 3] = [0.5, -1, 2];
    coord v: [1; 3] = [1, 0, 0];
    coord w: [1; 3];
    constraint product { w == A*v + cross(v, b) - 2*v/3 + v*b.2; }
    constraint fixed {
        dot(v, b) == 0.1*t/1s;
        norm(v) == 2;
        det(v, b, [A[0][1], A[1, 1], A[2, 1]]) == v[0];
    }
    out length: 1 = norm([v[0]]) + norm(A[1]);
    out volume: 1 = det(A) + det([v, w, b]);
}

mechanism! {
    /// A chain of bars, written with loops.
    mechanism Chain;
    const LAST: 1 = N - 1;
    const N: 1 = 3;
    param L: [m; N] = [0.3, 0.2, 0.1];
    coord phi: [rad; N] = [0.1, 0.2, 0.3];
    coord p: [m; N, 2] = 0.1;
    constraint first { p[0] == L[0]*unit(phi[0]); }
    for i in 1..N {
        let before = p[i - 1];
        constraint bar { p[i] == before + L[i]*unit(phi[i]); }
        drive turn: phi[i] - phi[i - 1] == (0.1 + i)*t/1s;
        out height: m = p[i, 1];
    }
    constraint tip { for i in LAST..N { for j in 0..1 { p[i][j] == 0.45m + 0.01m*sin(t/1s); } } }
    out reach: m = sum(i in 0..N: L[i]*cos(phi[i])) - sum(i in LAST..2: p[i]);
}

mechanism! {
    /// Measured angles drive, a load does not.
    mechanism Measured;
    input u: rad, rates;
    input w: [m; 2], rates;
    input load: [N; 2];
    coord phi: rad;
    coord p: [m; 2];
    drive follow: phi == u*sin(u) + 0.1*t/1s;
    constraint point { p == w*cos(phi) + [w.1, 0]; }
    out power: W = dot(load, der(p));
    out angle: rad = 2*u;
    out turning: rad/s = der(u);
    out work: N*m = dot(load, p);
}

mechanism! {
    /// Numbers: precedence, units, constants in any order.
    mechanism Numbers;
    const MASS: kg = 2kg*HALF;
    const HALF: 1 = 1/2;
    const LENGTH: m = 3;
    param turn: rad = 30deg;
    param speed: rad/s = 3000rpm;
    param mains: rad/s = TAU*50Hz;
    param area: m^2 = 1cm*1mm;
    param volume: m^3 = 2;
    param stress: Pa = 210GPa;
    param weight: N = 1tonne*1g0;
    param fraction: 1 = 1_000.5e-1;
    coord x: 1 = 1.5;
    drive hold: x == 1.5;
    out inertia: kg*m^2 = MASS*LENGTH^2/12;
    out square: 1 = -x^2;
    out inverse: 1 = 2^-x;
    out tower: 1 = 2^3^2;
    out left: 1 = 8/4/2 - 3 - 2;
    out product: 1 = -x*-x;
    out signs: 1 = - - -x;
    out half: 1 = 1/2;
    out inner: 1 = (-x)^2 + 2*-3^2;
    out bound: m = max(0, LENGTH) + 0;
    out nothing: m = 0;
    out angles: rad = atan2(0, -1m) + 1 + 1rad + 180deg;
    out root: m = sqrt(volume/1m);
    out cubic: m = (volume/2)^(1/3);
}

mechanism! {
    /// At x = z = 0 everything here has a kink.
    mechanism Kinks;
    coord x: 1;
    coord z: 1;
    coord y: [1; 6];
    drive first: x == t/1s;
    drive second: z == 2*t/1s;
    constraint each {
        y[0] == abs(x);
        y[1] == sign(x);
        y[2] == min(x, z);
        y[3] == max(x, z);
        y[4] == hypot(x, z);
        y[5] == abs(z)*sign(z);
    }
}

mechanism! {
    /// Zero needs no unit.
    mechanism Zero;
    coord p: [m; 2] = [0, 0];
    coord v: m/s;
    constraint closed { p + [0, 0] == 0; }
    constraint still { 0 == v; }
    branch ahead: p.0 > 0;
    branch behind at start: 0 > v;
    out nothing: [m; 2] = p - 0*p;
}

mechanism! {
    /// Four-bar linkage with a coupler point.
    pub mechanism FourBar;
    const L1: m = 0.10;
    const L2: m = 0.25;
    const L3: m = 0.20;
    const L4: m = 0.30;
    const L5: m = 0.15;
    const ALPHA: rad = 0.4;
    /// Speed of the crank.
    param omega: rad/s = TAU;
    input wear: [m; 2];
    input nudge: rad, rates;
    coord x2: m;
    coord y2: m;
    coord phi1: rad = 0.0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    // The loop is closed at the end of the rocker.
    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
        y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t + nudge;
    branch open: sin(phi3 - phi2) > 0;
    branch up at start: phi2 > 0;
    out transmission_angle: rad = phi3 - phi2;
}

fn four_bar(q: &[Jet; 5], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let [x2, y2, phi1, phi2, phi3] = *q;
    let rows = vec![
        x2 - (0.10 * phi1.cos() + 0.15 * (0.4 + phi2).cos()),
        y2 - (0.10 * phi1.sin() + 0.15 * (0.4 + phi2).sin()),
        0.20 * phi3.cos() + 0.30 - (0.10 * phi1.cos() + 0.25 * phi2.cos()),
        0.10 * phi1.sin() + 0.25 * phi2.sin() - 0.20 * phi3.sin(),
        phi1 - TAU * t,
    ];
    (rows, vec![phi3 - phi2])
}

#[test]
fn the_four_bar_is_its_formulas() {
    let four_bar_text = FourBar::default();
    check(&four_bar_text, &state([0.1, 0.2, 0.3, 0.9, 1.7], 0.05), four_bar);
    let position = four_bar_text.position(&four_bar_text.parameters(), &[0.1, 0.2, 0.3, 0.9, 1.7], 0.05);
    let branches = four_bar_text.branches(&four_bar_text.parameters(), &position);
    close(branches[0], 0.8_f64.sin(), "open");
    close(branches[1], 0.9, "up");
}

#[test]
fn the_four_bar_turns_with_rates_that_are_differences_of_positions() {
    let guess = FourBarCoordinates { x2: 0.0, y2: 0.0, phi1: 0.0, phi2: 0.9, phi3: 1.8 };
    let mut stepper = Stepper::assemble(FourBar::default(), guess, 0.0).expect("assembled");
    let h = 1e-4;
    for instant in [0.1, 0.35, 0.8] {
        let at = |stepper: &mut Stepper<FourBar, f64, 5>, t| {
            let now = stepper.t();
            for step in 1..=20 {
                stepper.advance_to(now + (t - now) * f64::from(step) / 20.0).expect("a step");
            }
            *stepper.q()
        };
        let (before, after) = (at(&mut stepper, instant - h), at(&mut stepper, instant + h));
        let here = at(&mut stepper, instant);
        for i in 0..5 {
            let rate = (after[i] - before[i]) / (2.0 * h);
            let acceleration = (after[i] - 2.0 * here[i] + before[i]) / (h * h);
            assert!((stepper.qd()[i] - rate).abs() < 1e-5 * (1.0 + rate.abs()), "{i}: {rate}");
            assert!((stepper.qdd()[i] - acceleration).abs() < 1e-4 * (1.0 + acceleration.abs()), "{i}");
        }
        let angle = stepper.outputs()[0];
        close(angle.value, here[4] - here[3], "transmission angle");
        close(angle.rate.expect("a rate"), stepper.qd()[4] - stepper.qd()[3], "its rate");
        close(
            angle.acceleration.expect("a second rate"),
            stepper.qdd()[4] - stepper.qdd()[3],
            "its second rate",
        );
    }
}

/// All that a mechanism computes at a state, one after the other.
fn everything<S: Kinematic<T, N>, T: Scalar, const N: usize>(
    mechanism: &S,
    q: [f64; N],
    t: f64,
    spread: impl Fn(f64) -> T,
) -> Vec<T> {
    let parameters = mechanism.parameters();
    let q = q.map(&spread);
    let position = mechanism.position(&parameters, &q, spread(t));
    let (qd, qdd) = (q.map(|q| q * spread(0.3)), q.map(|q| q * spread(-0.7)));
    let mut all = Vec::new();
    all.extend(mechanism.guess(&parameters));
    all.extend(mechanism.coordinate_scales(&parameters));
    all.extend(mechanism.row_scales(&parameters));
    all.extend(mechanism.phi(&parameters, &position));
    all.extend(mechanism.phi_q(&parameters, &position).into_iter().flatten());
    all.extend(mechanism.phi_t(&parameters, &position));
    all.extend(mechanism.phi_tt(&parameters, &position));
    all.extend(mechanism.phi_qt_qd(&parameters, &position, &qd));
    all.extend(mechanism.gamma(&parameters, &position, &qd));
    all.extend(mechanism.branches(&parameters, &position).as_ref());
    for output in mechanism.outputs(&parameters, &position, &qd, &qdd).as_ref() {
        all.push(output.value);
        all.extend(output.rate.into_iter().chain(output.acceleration));
    }
    let (factors, margin) = mechanism.factorize(&parameters, &position);
    all.push(margin.value);
    all.extend(mechanism.solve_linear(&factors, &q));
    all
}

#[test]
fn lanes_compute_what_single_numbers_compute() {
    fn compare<const N: usize>(
        single: &impl Kinematic<f64, N>,
        wide: &impl Kinematic<Lanes<f64, 4>, N>,
        q: [f64; N],
        t: f64,
    ) {
        let shift = |lane: usize| 0.01 * lane as f64;
        // Each lane at a state of its own: all coordinates and the time moved by its shift.
        let spread = |value: f64| Lanes::from_lanes(|lane| value + shift(lane));
        let lanes = everything(wide, q, t, spread);
        for lane in 0..4 {
            let alone = everything(single, q, t, |value| value + shift(lane));
            for (index, (wide, single)) in lanes.iter().zip(&alone).enumerate() {
                assert_eq!(wide.lane(lane).to_bits(), single.to_bits(), "{index} in lane {lane}");
            }
        }
    }
    let q = |count: usize| move |i: usize| 0.2 + 0.6 * i as f64 / count as f64;
    compare(&Operators::default(), &Operators::default(), std::array::from_fn(q(18)), 0.4);
    compare(&Functions::default(), &Functions::default(), std::array::from_fn(q(18)), 0.4);
    compare(&Plane::default(), &Plane::default(), std::array::from_fn(q(5)), 0.4);
    compare(&Space::default(), &Space::default(), std::array::from_fn(q(6)), 0.4);
    compare(&Chain::default(), &Chain::default(), std::array::from_fn(q(9)), 0.4);
    compare(&Measured::default(), &Measured::default(), std::array::from_fn(q(3)), 0.4);
    compare(&FourBar::default(), &FourBar::default(), std::array::from_fn(q(5)), 0.4);
}

#[test]
fn single_precision_computes_the_same_to_its_own_precision() {
    fn compare<const N: usize>(
        double: &impl Kinematic<f64, N>,
        single: &impl Kinematic<f32, N>,
        q: [f64; N],
    ) {
        let double = everything(double, q, 0.4, |value| value);
        let single = everything(single, q, 0.4, |value| value as f32);
        for (index, (double, single)) in double.iter().zip(&single).enumerate() {
            let error = (f64::from(*single) - double).abs();
            assert!(error < 1e-4 * (1.0 + double.abs()), "{index}: {single} for {double}");
        }
    }
    let q = |count: usize| move |i: usize| 0.2 + 0.6 * i as f64 / count as f64;
    compare(&Operators::default(), &Operators::default(), std::array::from_fn(q(18)));
    compare(&Functions::default(), &Functions::default(), std::array::from_fn(q(18)));
    compare(&Plane::default(), &Plane::default(), std::array::from_fn(q(5)));
    compare(&FourBar::default(), &FourBar::default(), std::array::from_fn(q(5)));
}

#[test]
fn variables_are_read_and_set_by_index_and_by_name() {
    let names: Vec<&str> = FourBar::<f64>::VARIABLES.iter().map(|entry| entry.name).collect();
    let rates = ["nudge", "nudge.rate", "nudge.acceleration"];
    assert_eq!(names, [&["omega", "wear.0", "wear.1"][..], &rates].concat());
    let units: Vec<&str> = FourBar::<f64>::VARIABLES.iter().map(|entry| entry.unit).collect();
    assert_eq!(units, ["rad/s", "m", "m", "rad", "rad/s", "rad/s^2"]);
    let mut four_bar = FourBar::default();
    assert_eq!(four_bar.get(0), Some(TAU));
    for (index, name) in names.iter().enumerate() {
        assert_eq!(FourBar::<f64>::variable(name), Some(index));
        assert!(four_bar.set(index, 10.0 + index as f64));
    }
    assert_eq!(four_bar.omega, 10.0);
    assert_eq!(four_bar.wear, [11.0, 12.0]);
    assert_eq!(four_bar.nudge, Signal { value: 13.0, rate: 14.0, acceleration: 15.0 });
    for index in 0..6 {
        assert_eq!(four_bar.get(index), Some(10.0 + index as f64));
    }
    assert_eq!((four_bar.get(6), four_bar.set(6, 1.0)), (None, false));
    assert_eq!(FourBar::<f64>::variable("phi1"), None);
    let wide = FourBar::<Lanes<f64, 4>> { omega: Lanes([1.0, 2.0, 3.0, 4.0]), ..FourBar::default() };
    assert_eq!(wide.lane(2), FourBar { omega: 3.0, ..FourBar::default() });
}

#[test]
fn coordinates_have_names_and_guesses() {
    let q = [1.0, 2.0, 3.0, 4.0, 5.0];
    let named = FourBarCoordinates::from(q);
    assert_eq!((named.x2, named.phi1, named.phi3), (1.0, 3.0, 5.0));
    assert_eq!(<[f64; 5]>::from(named), q);
    let chain = ChainCoordinates::from([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!((chain.phi, chain.p), ([0.0, 1.0, 2.0], [[3.0, 4.0], [5.0, 6.0], [7.0, 8.0]]));
    assert_eq!(<[f64; 9]>::from(chain)[8], 8.0);
    let four_bar = FourBar::<f64>::default();
    assert_eq!(four_bar.guess(&four_bar.parameters()), [0.0, 0.0, 0.0, 0.9, 1.8]);
    assert_eq!(FourBar::<f64>::NAME, "FourBar");
}

/// The line of `needle` after the line of `mark`, counted from 1.
fn line_of(mark: &str, needle: &str) -> u32 {
    let behind = FILE.find(mark).expect(mark);
    let place = behind + FILE[behind..].find(needle).expect(needle);
    FILE[..place].lines().count() as u32
}

#[test]
fn tables_name_the_lines_of_the_file() {
    let line = |needle: &str| line_of("pub mechanism FourBar", needle);
    for entry in FourBar::<f64>::COORDINATES {
        assert_eq!(entry.line, line(&format!("coord {}", entry.name)), "{}", entry.name);
    }
    let rows: Vec<u32> = FourBar::<f64>::ROWS.iter().map(|row| row.line).collect();
    let expected = ["x2 ==", "y2 ==", "L3*cos", "L1*sin(phi1) + L2*sin", "drive crank"];
    assert_eq!(rows, expected.map(line));
    assert_eq!(FourBar::<f64>::VARIABLES[0].line, line("param omega"));
    assert_eq!(FourBar::<f64>::VARIABLES[2].line, line("input wear"));
    assert_eq!(FourBar::<f64>::BRANCHES[1].line, line("branch up"));
    assert_eq!(FourBar::<f64>::OUTPUTS[0].line, line("out transmission_angle"));
}

#[test]
fn the_kept_source_expands_to_the_same_code() {
    fn same<M: Mechanism<f64, N, N>, const N: usize>() {
        let header = format!("mechanism {};", M::NAME);
        let begin = FILE[..FILE.find(&header).expect("the header")].rfind("mechanism! {").expect("the macro");
        let text = &FILE[begin + "mechanism! {".len()..];
        let written = &text[..text.find("\n}\n").expect("its end")];
        let kept = mbs_codegen::expand_source(M::SOURCE).expect("a valid source").to_string();
        assert_eq!(mbs_codegen::expand_source(written).expect("a valid text").to_string(), kept);
    }
    same::<Operators, 18>();
    same::<Functions, 18>();
    same::<Plane, 5>();
    same::<Space, 6>();
    same::<Chain, 9>();
    same::<Measured, 3>();
    same::<Numbers, 1>();
    same::<Kinks, 8>();
    same::<Zero, 3>();
    same::<FourBar, 5>();
    assert!(
        FourBar::<f64>::SOURCE
            .starts_with("/// Four-bar linkage with a coupler point.\npub mechanism FourBar;\n")
    );
}

//! Arrays of functions: the same bits as functions that are declared one by one, in every place, in loops, scenes, lanes and `f32`.
#![forbid(unsafe_code)]

#[path = "function_arrays/random.rs"]
mod random;

use mbs_runtime::dynamics::{DormandPrince5, Explicit, Projection, Simulation};
use mbs_runtime::{Dynamic, Function, InNumbers, Lanes, Mechanism, Scalar, Stepper, mechanism};

/// This file, to find the line that the table names.
const FILE: &str = include_str!("function_arrays.rs");

/// `amplitude · sin(frequency · x + phase)`: the derivatives of any order in closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sine {
    amplitude: f64,
    frequency: f64,
    phase: f64,
}

impl<T: Scalar> Function<T> for Sine {
    const ORDER: usize = 9;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let angle = T::constant(self.frequency) * x + T::constant(self.phase);
        let ([sine], [cosine]) = T::sin_cos([angle]);
        std::array::from_fn(|order| {
            let factor = self.amplitude * self.frequency.powi(order as i32);
            T::constant(factor) * [sine, cosine, -sine, -cosine][order % 4]
        })
    }
}

const LIFT: [Sine; 3] = [
    Sine { amplitude: 0.8, frequency: 1.3, phase: 0.4 },
    Sine { amplitude: 0.3, frequency: 2.1, phase: -0.7 },
    Sine { amplitude: 0.5, frequency: 0.9, phase: 1.9 },
];
const LAW: [Sine; 2] = [
    Sine { amplitude: 0.4, frequency: 1.7, phase: 0.2 },
    Sine { amplitude: 0.2, frequency: 3.1, phase: -1.3 },
];
const PITCH: [Sine; 2] = [
    Sine { amplitude: 0.05, frequency: 1.0, phase: 0.3 },
    Sine { amplitude: 0.02, frequency: 2.0, phase: 0.9 },
];

mechanism! {
    /// Every place where a function of an array can stand.
    pub mechanism Together;
    const K: 1 = 1;
    param p: rad = 0.3;
    /// Lifts of the followers.
    function lift: [m; K + 2](rad), C4, periodic TAU;
    function law: [rad; 2](s), C4;
    function pitch: [m; 2](rad), C4, periodic TAU;
    coord x: rad = law[0](0.5s);
    coord y: [m; 3];
    coord z: [m; 2] = [0.1, 0.2];
    let slope = lift[K].d1(x + p);
    let total = sum(i in 0..3: lift[i](x + i));
    curve cam = polar pitch[K] about [0, 0] turned x;
    curve other = polar pitch[K - 1] about [1m, 0];
    drive first: x == law[K](t) + law[0](2*t);
    constraint each {
        for i in 0..3 {
            y[i] == lift[i](x) + 0.1*lift[(i + 1) - K].d1(2*x + p)*sin(x);
        }
    }
    branch up: lift[2](x) > -2m;
    limit reach: -1m <= lift[0](x) <= 1m;
    for i in 0..2 {
        body slide { mass: 1kg + 1kg*i, com: [z[i], 0] }
        force push: 1 [N/m]*lift[2*i](x + z[i]/1m) - 3 [N/m]*z[i] on z[i];
        contact stop { gap: z[i] - lift[i](x) + 1m, stiffness: 2e3 }
    }
    potential well = 1 [N/m]*(lift[1](z[0]/1m)*z[1]);
    out height: m = total;
    out inclination: m = slope;
    out bends: [m; 2] = [lift[0].d2(x), der(lift[2](x))*1s];
    out far: m = distance([3m, z[0]], cam) - distance([3m, z[1]], other);
}

mechanism! {
    /// [`Together`] with functions that are declared one by one.
    pub mechanism Apart;
    param p: rad = 0.3;
    function lift_0: m(rad), C4, periodic TAU;
    function lift_1: m(rad), C4, periodic TAU;
    function lift_2: m(rad), C4, periodic TAU;
    function law_0: rad(s), C4;
    function law_1: rad(s), C4;
    function pitch_0: m(rad), C4, periodic TAU;
    function pitch_1: m(rad), C4, periodic TAU;
    coord x: rad = law_0(0.5s);
    coord y: [m; 3];
    coord z: [m; 2] = [0.1, 0.2];
    let slope = lift_1.d1(x + p);
    let total = lift_0(x + 0) + lift_1(x + 1) + lift_2(x + 2);
    curve cam = polar pitch_1 about [0, 0] turned x;
    curve other = polar pitch_0 about [1m, 0];
    drive first: x == law_1(t) + law_0(2*t);
    constraint each {
        y[0] == lift_0(x) + 0.1*lift_0.d1(2*x + p)*sin(x);
        y[1] == lift_1(x) + 0.1*lift_1.d1(2*x + p)*sin(x);
        y[2] == lift_2(x) + 0.1*lift_2.d1(2*x + p)*sin(x);
    }
    branch up: lift_2(x) > -2m;
    limit reach: -1m <= lift_0(x) <= 1m;
    body slide_0 { mass: 1kg, com: [z[0], 0] }
    body slide_1 { mass: 2kg, com: [z[1], 0] }
    force push_0: 1 [N/m]*lift_0(x + z[0]/1m) - 3 [N/m]*z[0] on z[0];
    force push_1: 1 [N/m]*lift_2(x + z[1]/1m) - 3 [N/m]*z[1] on z[1];
    contact stop_0 { gap: z[0] - lift_0(x) + 1m, stiffness: 2e3 }
    contact stop_1 { gap: z[1] - lift_1(x) + 1m, stiffness: 2e3 }
    potential well = 1 [N/m]*(lift_1(z[0]/1m)*z[1]);
    out height: m = total;
    out inclination: m = slope;
    out bends: [m; 2] = [lift_0.d2(x), der(lift_2(x))*1s];
    out far: m = distance([3m, z[0]], cam) - distance([3m, z[1]], other);
}

fn together<T: Scalar>() -> Together<Sine, Sine, Sine, T> {
    Together::new(LIFT, LAW, PITCH)
}

type OneByOne<T = f64> = Apart<Sine, Sine, Sine, Sine, Sine, Sine, Sine, T>;

fn apart<T: Scalar>() -> OneByOne<T> {
    let ([a, b, c], [d, e], [f, g]) = (LIFT, LAW, PITCH);
    Apart::new(a, b, c, d, e, f, g)
}

/// Positions, velocities and multipliers that belong to no motion.
fn states<T: Scalar>(count: usize) -> impl Iterator<Item = ([T; 6], [T; 6], [T; 4], T)> {
    (0..count).map(|round| {
        let at = |place: usize| T::constant(((round * 17 + place) as f64 * 0.618).sin() * 2.5);
        let row = |place: usize| T::constant(((round * 13 + place) as f64 * 1.732).cos() * 10.0);
        (std::array::from_fn(at), std::array::from_fn(|i| at(i + 6)), std::array::from_fn(row), at(12))
    })
}

/// The digits of every function of a mechanism at several states; those of all lanes.
fn digits<T: Scalar, S: Dynamic<T, 6, 4, States = [T; 0]>>(mechanism: &S) -> Vec<String> {
    let parameters = mechanism.parameters();
    let mut found = vec![format!("{:?}", mechanism.guess(&parameters))];
    for (q, qd, lambda, t) in states::<T>(20) {
        let (p, s) = (&parameters, &mechanism.position(&parameters, &q, t));
        let mut gaps = Vec::new();
        mechanism.gaps(p, s, &qd, |gap| gaps.push(format!("{gap:?}")));
        let found_here = (
            mechanism.phi(p, s),
            mechanism.phi_q(p, s),
            mechanism.phi_t(p, s),
            mechanism.phi_tt(p, s),
            mechanism.phi_qt_qd(p, s, &qd),
            mechanism.gamma(p, s, &qd),
        );
        found.push(format!("{found_here:?} {:?}", mechanism.branches(p, s).as_ref()));
        let forces = (
            mechanism.mass(p, s),
            mechanism.force(p, s, &qd, &[], &lambda),
            mechanism.force_q(p, s, &qd, &[], &lambda),
            mechanism.energy(p, s, &qd),
            mechanism.reaction_q(p, s, &lambda),
        );
        found.push(format!("{forces:?} {gaps:?}"));
        found.push(format!(
            "{:?} {:?}",
            mechanism.outputs(p, s, &qd, &qd).as_ref(),
            mechanism.limits(p, s).as_ref()
        ));
    }
    found
}

#[track_caller]
fn same_digits<T: Scalar>() {
    let (array, single) = (digits(&together::<T>()), digits(&apart::<T>()));
    assert_eq!(array.len(), 61);
    assert_eq!(array, single);
    // Another function in one place shows everywhere.
    let mut other = together::<T>();
    other.lift[1].phase += 1.0;
    assert!(digits(&other).iter().zip(&single).filter(|(a, b)| a != b).count() > 55);
}

#[test]
fn functions_of_an_array_have_the_bits_of_functions_by_name() {
    same_digits::<f64>();
    same_digits::<f32>();
    same_digits::<Lanes<f64, 4>>();
}

/// A motion under forces through contacts, as bits of its coordinates.
fn moved<S: Dynamic<f64, 6, 4, States = [f64; 0]>>(mechanism: S) -> Vec<[u64; 6]> {
    let method = Explicit::new(DormandPrince5, Projection::default());
    let mut run = Simulation::start_from_text(mechanism, method, 0.0).expect("a start");
    let mut found = Vec::new();
    for step in 1..=20 {
        run.advance_to(0.1 * f64::from(step)).expect("a motion");
        found.push(run.q().map(f64::to_bits));
    }
    found
}

#[test]
fn a_run_has_the_same_bits() {
    let found = moved(together::<f64>());
    assert_eq!(found, moved(apart::<f64>()));
    let mut other = together::<f64>();
    other.pitch[1].amplitude = 0.5;
    assert_eq!(found, moved(other), "a function of outputs moves nothing");
    other.lift[2].phase += 1e-6;
    assert_ne!(found, moved(other));
}

#[test]
fn the_table_has_each_function_of_an_array() {
    let table = <Together<Sine, Sine, Sine> as Mechanism<f64, 6, 4>>::FUNCTIONS;
    let names: Vec<&str> = table.iter().map(|entry| entry.name).collect();
    assert_eq!(names, ["lift[0]", "lift[1]", "lift[2]", "law[0]", "law[1]", "pitch[0]", "pitch[1]"]);
    let line = FILE.lines().position(|line| line.contains("function law: [rad; 2](s), C4"));
    assert_eq!(line.map(|line| line as u32 + 1), table.get(4).map(|entry| entry.line));
    let single = <OneByOne as Mechanism<f64, 6, 4>>::FUNCTIONS;
    for (one, other) in table.iter().zip(single) {
        assert_eq!(
            (one.unit, one.argument_unit, one.order, one.period),
            (other.unit, other.argument_unit, other.order, other.period)
        );
    }
}

#[test]
fn an_array_is_a_field_of_one_type() {
    let mut mechanism: Together<Sine, Sine, Sine> = Together::default();
    assert_eq!(mechanism.lift, [Sine::default(); 3]);
    mechanism = Together { lift: LIFT, p: 0.4, ..mechanism };
    let narrow: Together<Sine, Sine, Sine, f32> = mechanism.in_numbers();
    assert_eq!((narrow.lift, narrow.p), (LIFT, 0.4));
    let wide: Together<Sine, Sine, Sine, Lanes<f64, 4>> = together();
    assert_eq!(wide.lane(2).lift, LIFT);
}

mechanism! {
    /// Shafts that rows of a loop chain, of as many blocks as are solved in a loop.
    pub mechanism Chain;
    const N: 1 = 60;
    function law: [rad; N](rad), C3;
    coord phi: [rad; N] = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    drive crank: phi[0] == law[0](t*1 [rad/s]);
    constraint chain {
        for i in 1..N { phi[i] + 0.1*law[i](phi[i]) == phi[i - 1]; }
    }
    out last: rad = phi[N - 1];
    out sum_of_all: rad = sum(i in 0..N: law[N - 1 - i](0.5*phi[i]));
}

/// Functions of a chain, no two of them alike.
fn chained() -> [Sine; 60] {
    std::array::from_fn(|i| {
        let i = i as f64;
        Sine { amplitude: 0.3 + 0.01 * i, frequency: 1.0 + 0.02 * i, phase: 0.1 * i }
    })
}

#[test]
fn a_loop_of_long_code_calls_each_function_of_an_array() {
    let laws = chained();
    let of = |i: usize, x: f64| laws[i].amplitude * (laws[i].frequency * x + laws[i].phase).sin();
    let mut motion = Stepper::assemble(Chain::new(laws), [0.0; 60], 0.0).expect("assembled");
    for step in 1..=50 {
        motion.advance(0.02).expect("a step");
        let mut phi = [of(0, 0.02 * f64::from(step)); 60];
        for i in 1..60 {
            // The slope of 0.1 f is below 0.2, so each round gains 0.7 digits.
            phi[i] = phi[i - 1];
            (0..40).for_each(|_| phi[i] = phi[i - 1] - 0.1 * of(i, phi[i]));
        }
        let sum: f64 = (0..60).map(|i| of(59 - i, 0.5 * phi[i])).sum();
        let [last, all] = motion.outputs().map(|output| output.value);
        // Rows are met within 1e-12 of their size, and sixty of them follow each other.
        assert!(
            (last - phi[59]).abs() < 1e-11 && (all - sum).abs() < 1e-10,
            "{last} {all} {} {sum}",
            phi[59]
        );
    }
    // The control: loops call them, not a line each.
    let code = mbs_codegen::expand_source(<Chain<Sine> as Mechanism<f64, 60, 60>>::SOURCE)
        .expect("a text")
        .to_string();
    let (in_loops, alone) =
        (code.matches("chunks :: jet ::").count(), code.matches("Function < T >> :: jet ::").count());
    assert!((3..30).contains(&in_loops) && alone == 0, "{in_loops} {alone}");
}

mechanism! {
    /// Followers of one scene alone have functions.
    pub mechanism Press;
    coord theta: rad;
    coord y: [m; 2];
    drive cam: theta == t/1s;
    effect rising {
        function lift: [m; 2](rad), C2;
        constraint faces { for i in 0..2 { y[i] == lift[i](theta); } }
    }
    effect level {
        constraint faces { y == [0, 1m*theta]; }
    }
    effect falling {
        function drop: [m; 33](rad), C3;
        constraint faces { y == [drop[32].d1(theta), drop[7](theta)]; }
    }
    scene Up = rising;
    scene Level = level;
    scene Down = falling;
}

#[test]
fn an_array_of_one_scene_is_kept_by_the_others() {
    /// No function at all.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Nothing;

    let rising = [LIFT[0], LIFT[1]];
    let up: PressUp<Sine, Nothing> = Press::new(rising, [Nothing; 33]);
    let phi = up.phi(&up.parameters(), &up.position(&up.parameters(), &[0.3, 0.0, 0.0], 0.3));
    let of = |law: &Sine, x: f64| Function::<f64>::jet::<2>(law, x);
    assert_eq!(phi, [0.0, -of(&LIFT[0], 0.3)[0], -of(&LIFT[1], 0.3)[0]]);
    let level: PressLevel<Sine, Nothing> = up.scene();
    assert_eq!(level.lift, rising);
    assert_eq!(<PressLevel<Sine, Nothing> as Mechanism<f64, 3, 3>>::FUNCTIONS.len(), 0);
    // More functions than arrays with a default of their own have.
    let mut down: PressDown<Nothing, Sine> = Press::default();
    (down.drop[32], down.drop[7]) = (LIFT[2], LIFT[1]);
    let phi = down.phi(&down.parameters(), &down.position(&down.parameters(), &[0.3, 0.0, 0.0], 0.3));
    assert_eq!(phi, [0.0, -of(&LIFT[2], 0.3)[1], -of(&LIFT[1], 0.3)[0]]);
}

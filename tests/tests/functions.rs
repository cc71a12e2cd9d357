//! Declared functions end to end: given at run time, differentiated by the text, asked for once a stage.
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![allow(mixed_script_confusables, reason = "angles are written in Greek")]

mod jet;

use std::cell::RefCell;
use std::f64::consts::TAU;

use jet::{Jet, check, close, state};
use mbs_runtime::{Function, Kinematic, Lanes, Mechanism, Newton, Scalar, Stepper, mechanism};

/// This file, to find the lines that the tables name.
const FILE: &str = include_str!("functions.rs");

/// `amplitude · sin(frequency · x + phase)`: the derivatives of any order in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
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
            let value = [sine, cosine, -sine, -cosine][order % 4];
            T::constant(factor) * value
        })
    }
}

impl Sine {
    /// The derivative of order `order` in the oracle's arithmetic.
    fn of(&self, order: i32, x: Jet) -> Jet {
        let derivative = |k: i32| {
            let quarter = std::f64::consts::FRAC_PI_2 * f64::from(order + k);
            let angle = self.frequency * x.value() + self.phase + quarter;
            self.amplitude * self.frequency.powi(order + k) * angle.sin()
        };
        x.apply([derivative(0), derivative(1), derivative(2)])
    }
}

const LIFT: Sine = Sine { amplitude: 0.8, frequency: 1.3, phase: 0.4 };
const SWING: Sine = Sine { amplitude: 0.3, frequency: 2.1, phase: -0.7 };

impl Default for Sine {
    fn default() -> Self {
        LIFT
    }
}

mechanism! {
    /// Every place where a declared function can stand.
    pub mechanism Everywhere;
    param p: rad = 0.3;
    /// Lift of the follower.
    function lift: m(rad), C4, periodic TAU/1.3;
    function swing: rad(s), C3;
    input u: rad, rates;
    coord x: rad = swing(1s);
    coord y: [m; 6];
    coord w: m = 0.8;
    drive first: x == swing(t) + 0.1*u;
    constraint each {
        y[0] == lift(x);
        y[1] == lift.d1(2*x + p)*sin(x);
        y[2] == lift.d2(swing(t*cos(x)));
        y[3] == lift(x)*lift.d1(x)*lift(p)/(1m*1m) + 1m*swing.d1(t)*1s;
        y[4] == min(lift(x), lift(u));
        y[5] == lift(0.25) + w;
    }
    constraint implicit { w*(2 + lift(x)/1m) == lift(w/1m); }
    branch up: lift(x + 1) > -2m;
    out height: m = lift(x - u);
    out slope: m = lift.d1(x);
    out speed: m/s = der(lift(x))*swing.d1(0s)*1s;
}

/// Rows and outputs of [`Everywhere`]; `u` as it moves.
fn everywhere(q: &[Jet; 8], t: Jet, u: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let [x, w, p] = [q[0], q[7], Jet::number(0.3)];
    let lift = |order: i32, x: Jet| LIFT.of(order, x);
    let swing = |order: i32, x: Jet| SWING.of(order, x);
    let (raised, other) = (lift(0, x), lift(0, u));
    let values = [
        raised,
        lift(1, 2.0 * x + p) * x.sin(),
        lift(2, swing(0, t * x.cos())),
        raised * lift(1, x) * lift(0, p) + swing(1, t),
        if raised.value() < other.value() { raised } else { other },
        lift(0, Jet::number(0.25)) + w,
    ];
    let mut rows = vec![x - (swing(0, t) + 0.1 * u)];
    rows.extend(values.iter().zip(&q[1..]).map(|(value, y)| *y - *value));
    rows.push(w * (2.0 + raised) - lift(0, w));
    let outputs = vec![lift(0, x - u), lift(1, x), raised.rate() * swing(1, Jet::number(0.0))];
    (rows, outputs)
}

#[test]
fn calls_have_their_value_and_derivatives_in_every_place() {
    let mut mechanism: Everywhere<Sine, Sine> = Everywhere::new(LIFT, SWING);
    let [u, rate, acceleration] = [0.4, 0.7, -1.1];
    mechanism.u = mbs_runtime::Signal { value: u, rate, acceleration };
    for (x, t) in [(0.3, 0.2), (-0.9, 1.7), (2.5, -0.4)] {
        check(&mechanism, &state([x], t), |q, t| {
            // Inputs move with the time.
            let [_, pace, _] = t.parts();
            everywhere(q, t, Jet::new(u, rate * pace, acceleration * pace * pace))
        });
    }
    let guess = mechanism.guess(&mechanism.parameters());
    close(guess[0], SWING.of(0, Jet::number(1.0)).value(), "guess");
}

#[test]
fn outputs_have_as_many_derivatives_as_are_continuous() {
    mechanism! {
        /// Twice continuously differentiable.
        pub mechanism Smooth;
        function lift: m(rad), C2;
        coord x: rad;
        drive d: x == t/1s;
        out height: m = lift(x);
        out slope: m = lift.d1(x);
        out bend: m = lift.d2(x);
        out held: m = lift.d2(0);
        out faster: m/s = der(lift(x));
    }
    let smooth: Smooth<Sine> = Smooth::new(LIFT);
    let parameters = smooth.parameters();
    let position = smooth.position(&parameters, &[0.3], 0.3);
    let outputs = smooth.outputs(&parameters, &position, &[1.0], &[0.0]);
    let known = outputs.map(|output| (output.rate.is_some(), output.acceleration.is_some()));
    assert_eq!(known, [(true, true), (true, false), (false, false), (true, true), (true, false)]);
}

/// Records the number of derivatives of each call, with its argument.
#[derive(Clone, Debug, Default)]
struct Counting {
    asked: RefCell<Vec<(usize, f64)>>,
}

impl Function<f64> for &Counting {
    const ORDER: usize = 9;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        self.asked.borrow_mut().push((K, x));
        Function::<f64>::jet(&LIFT, x)
    }
}

impl Counting {
    fn heard(&self) -> Vec<(usize, f64)> {
        self.asked.take()
    }
}

mechanism! {
    /// One function at two arguments in every function of the mechanism, at a third in outputs alone.
    pub mechanism Counted;
    param p: rad = 0.5;
    function lift: m(rad), C9;
    coord x: rad = 0;
    coord y: m = 0;
    coord z: m = 0;
    coord c: rad = 0.1;
    drive first: x == t/1s;
    constraint contact { [y, z] == [lift(x)*lift(p)/1m, lift.d1(x)]; }
    constraint implicit { 3*c + lift(c + x)/1m == lift(x)/1m + 1; }
    branch up: lift(x) > -2m;
    out height: m = lift(2*x) + lift.d1(2*x)*sin(x);
}

#[test]
fn a_jet_is_asked_for_once_a_stage_and_argument() {
    let counting = Counting::default();
    let mechanism: Counted<&Counting> = Counted::new(&counting);
    let parameters = mechanism.parameters();
    // Of p the value alone.
    assert_eq!(counting.heard(), [(1, 0.5)]);
    let _guess = mechanism.guess(&parameters);
    let q = [0.3, 0.1, 0.2, 0.15];
    let position = mechanism.position(&parameters, &q, 0.3);
    // `lift.d1(x)` in a row makes γ need the third derivative.
    let mut heard = counting.heard();
    heard.sort_by_key(|(count, _)| *count);
    assert_eq!(heard, [(3, 0.15 + 0.3), (4, 0.3)]);
    let (qd, qdd) = ([1.0; 4], [0.5; 4]);
    let _ = mechanism.phi(&parameters, &position);
    let _ = mechanism.phi_q(&parameters, &position);
    let _ = mechanism.phi_t(&parameters, &position);
    let _ = mechanism.phi_tt(&parameters, &position);
    let _ = mechanism.phi_qt_qd(&parameters, &position, &qd);
    let _ = mechanism.gamma(&parameters, &position, &qd);
    let _ = mechanism.branches(&parameters, &position);
    let _ = mechanism.factorize(&parameters, &position);
    assert_eq!(counting.heard(), []);
    let _ = mechanism.outputs(&parameters, &position, &qd, &qdd);
    // `lift.d1` with two time derivatives.
    assert_eq!(counting.heard(), [(4, 0.6)]);
}

#[test]
fn blocks_share_the_jets_of_what_is_solved_already() {
    let counting = Counting::default();
    let mechanism: Counted<&Counting> = Counted::new(&counting);
    let parameters = mechanism.parameters();
    let mut q = [0.3, 0.1, 0.2, 0.15];
    let _ = counting.heard();
    let _outcome = mechanism.solve_blocks(&parameters, &mut q, 0.3, &mut Newton::new(1.0));
    let heard = counting.heard();
    // At x once for both rows and for the position stage after them, for any number of iterations at c + x.
    let known = heard.iter().filter(|(_, x)| *x == 0.3).collect::<Vec<_>>();
    assert_eq!(known, [&(4, 0.3)]);
    // At each iterate once, of the order that the position stage keeps of the last one.
    let iterates = heard.iter().filter(|(_, x)| *x != 0.3).collect::<Vec<_>>();
    assert!(iterates.len() > 1 && iterates.iter().all(|(count, _)| *count == 3), "{iterates:?}");
    let lift = |x: f64| LIFT.of(0, Jet::number(x)).value();
    close(q[1], lift(0.3) * lift(0.5), "y");
    close(3.0 * q[3] + lift(q[3] + 0.3), lift(0.3) + 1.0, "c");
}

#[test]
fn lanes_and_single_precision_compute_the_same() {
    let wide: Everywhere<Sine, Sine, Lanes<f64, 4>> = Everywhere::new(LIFT, SWING);
    let narrow: Everywhere<Sine, Sine, f32> = Everywhere::new(LIFT, SWING);
    let plain: Everywhere<Sine, Sine> = Everywhere::new(LIFT, SWING);
    let q: [f64; 8] = std::array::from_fn(|i| 0.2 + 0.1 * i as f64);
    let one =
        |mechanism: &Everywhere<Sine, Sine>| mechanism.evaluate(&mechanism.parameters(), &q, 0.3, &[0.5; 8]);
    let expected = one(&plain);
    let lanes = |x: f64| Lanes::<f64, 4>::constant(x);
    let found = wide.evaluate(&wide.parameters(), &q.map(lanes), lanes(0.3), &[lanes(0.5); 8]);
    for (found, expected) in found.gamma.iter().zip(&expected.gamma) {
        close(found.lane(2), *expected, "γ in a lane");
    }
    assert_eq!(one(&wide.lane(1)).phi, expected.phi);
    let single = |x: f64| x as f32;
    let found = narrow.evaluate(&narrow.parameters(), &q.map(single), 0.3, &[0.5; 8]);
    for (found, expected) in found.gamma.iter().zip(&expected.gamma) {
        // A dozen roundings of f32 on numbers up to ten.
        assert!((f64::from(*found) - expected).abs() < 2e-5, "{found} instead of {expected}");
    }
}

#[test]
fn the_table_names_units_continuity_period_and_line() {
    let table = <Everywhere<Sine, Sine> as Mechanism<f64, 8, 8>>::FUNCTIONS;
    let line = |needle: &str| FILE.lines().position(|line| line.contains(needle)).map(|n| n as u32 + 1);
    let [lift, swing] = table else { panic!("{table:?}") };
    assert_eq!((lift.name, lift.unit, lift.argument_unit, lift.continuity), ("lift", "m", "rad", 4));
    assert_eq!((lift.order, lift.period), (4, Some(TAU / 1.3)));
    assert_eq!(Some(lift.line), line("function lift: m(rad), C4"));
    assert_eq!((swing.name, swing.unit, swing.argument_unit, swing.continuity), ("swing", "rad", "s", 3));
    assert_eq!((swing.order, swing.period), (3, None));
    assert_eq!(Some(swing.line), line("function swing: rad(s), C3"));
    assert_eq!(<Counted<&Counting> as Mechanism<f64, 4, 4>>::FUNCTIONS.len(), 1);
}

#[test]
fn a_mechanism_with_functions_is_assembled_and_moved() {
    let mechanism: Counted<Sine> = Counted::default();
    assert_eq!((mechanism.lift, mechanism.p), (LIFT, 0.5));
    let changed = Counted { p: 0.6, ..mechanism };
    let guess = changed.guess(&changed.parameters());
    let mut motion = Stepper::assemble(changed, guess, 0.0).expect("assembled");
    for _ in 0..100 {
        motion.advance(0.01).expect("a step");
    }
    let q = CountedCoordinates::from(*motion.q());
    let lift = |order: i32, x: f64| LIFT.of(order, Jet::number(x)).value();
    close(q.x, 1.0, "x");
    close(q.y, lift(0, q.x) * lift(0, 0.6), "y");
    close(q.z, lift(1, q.x), "z");
    close(3.0 * q.c + lift(0, q.c + q.x), lift(0, q.x) + 1.0, "c");
}

mechanism! {
    /// A follower that is lifted by one law or pressed down by another.
    pub mechanism Press;
    param base: m = 0.1;
    coord theta: rad;
    coord y: m;
    drive cam: theta == t/1s;
    effect rising {
        function lift: m(rad), C2;
        constraint face { y == base + lift(theta); }
    }
    effect falling {
        function drop: m(rad), C3;
        constraint face { y == base - drop.d1(theta); }
    }
    scene Up = rising;
    scene Down = falling;
}

#[test]
fn a_scene_calls_its_own_functions_and_keeps_the_others() {
    /// No function at all.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Nothing;

    let up: PressUp<Sine, Nothing> = Press::new(LIFT, Nothing);
    let table = <PressUp<Sine, Nothing> as Mechanism<f64, 2, 2>>::FUNCTIONS;
    assert_eq!(table.iter().map(|entry| entry.name).collect::<Vec<_>>(), ["lift"]);
    let phi = up.phi(&up.parameters(), &up.position(&up.parameters(), &[0.3, 0.2], 0.3));
    close(phi[1], 0.2 - 0.1 - LIFT.of(0, Jet::number(0.3)).value(), "up");
    let down: PressDown<Nothing, Sine> = Press { base: 0.2, ..Press::new(Nothing, SWING) };
    let phi = down.phi(&down.parameters(), &down.position(&down.parameters(), &[0.3, 0.2], 0.3));
    close(phi[1], SWING.of(1, Jet::number(0.3)).value(), "down");
    let both: PressUp<Sine, Sine> = Press::new(LIFT, SWING);
    let other: PressDown<Sine, Sine> = both.scene();
    assert_eq!((other.lift, other.drop), (LIFT, SWING));
}

mod every_name {
    //! Names of functions that emitted code might use itself.

    use super::Sine;

    mbs_runtime::mechanism! {
        /// Functions named as locals, types, type parameters, methods and keywords.
        pub(crate) mechanism Named;
        function q: 1(1), C2;
        function T: 1(1), C2;
        function S: 1(1), C2;
        function f64: 1(1), C2;
        function type: 1(1), C2;
        function self_: 1(1), C2;
        function named: 1(1), C2;
        function Named_coordinates: 1(1), C2;
        function scalar: 1(1), C2;
        function new: 1(1), C2;
        function core: 1(1), C2;
        function lift_law: 1(1), C2;
        function liftLaw: 1(1), C2;
        function Option: 1(1), C2;
        function jet: 1(1), C2;
        function d1: 1(1), C2;
        function _1: 1(1), C2;
        function θ: 1(1), C2;
        function mbs_runtime: 1(1), C2;
        coord x: 1;
        let first = q(x) + T(x) + S(x) + f64(x) + type(x) + self_(x) + named(x) + Named_coordinates(x);
        let second = scalar(x) + new(x) + core(x) + lift_law(x) + liftLaw(x) + Option(x) + jet(x);
        drive d: x == t/1s;
        out all: 1 = first + second + d1(x) + d1.d1(x) + _1(x) + θ(x) + mbs_runtime(x);
    }

    #[test]
    fn any_name_names_a_function() {
        let s = super::LIFT;
        let named: Named<_, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, Sine> =
            Named::new(s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s);
        assert_eq!(named.r#type, s);
        let mut stepper = mbs_runtime::Stepper::assemble(named, [0.0], 0.0).expect("assembled");
        stepper.advance(0.3).expect("a step");
        let lift = |order| s.of(order, super::Jet::number(0.3)).value();
        super::close(stepper.outputs()[0].value, 19.0 * lift(0) + lift(1), "all");
    }
}

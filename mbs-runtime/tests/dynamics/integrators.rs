//! Integrators on equations with known solutions: orders, control of the step, events.

use mbs_runtime::dynamics::{Adaptive, Point};
use mbs_runtime::dynamics::{Dense, Monitor, Scrutiny};
use mbs_runtime::dynamics::{
    Direction, DormandPrince5, DormandPrince8, Either, Embedded, Equation, ErrorNorm, FixedStep,
    IntegratorState, RungeKutta4, SemiImplicitEuler,
};
use mbs_runtime::{Failure, FailureKind};

/// The oscillator q̈ = −q + t from q = 1, q̇ = 0: q = cos t − sin t + t.
struct Oscillator {
    tolerance: f64,
}

impl Equation<f64> for Oscillator {
    type State = IntegratorState<f64, 1, [f64; 0]>;

    fn rate(&mut self, t: f64, y: &Self::State) -> Result<Self::State, Failure> {
        Ok(IntegratorState { q: y.qd, qd: [t - y.q[0]], states: [], work: 0.0 })
    }
}

impl ErrorNorm<f64> for Oscillator {
    fn measure<const K: usize>(
        &self,
        _: &Self::State,
        _: &Self::State,
        errors: [&Self::State; K],
    ) -> [f64; K] {
        errors.map(|error| error.q[0].abs().max(error.qd[0].abs()) / self.tolerance)
    }
}

fn start() -> IntegratorState<f64, 1, [f64; 0]> {
    IntegratorState { q: [1.0], qd: [0.0], states: [], work: 0.0 }
}

fn exact(t: f64) -> f64 {
    t.cos() - t.sin() + t
}

/// Error at t = 2 after `steps` equal steps.
fn error<I: FixedStep + Default>(steps: u32) -> f64 {
    let mut equation = Oscillator { tolerance: 1.0 };
    let h = 2.0 / f64::from(steps);
    let mut y = start();
    for step in 0..steps {
        let t = f64::from(step) * h;
        let rate = equation.rate(t, &y).unwrap();
        y = I::default().step(&mut equation, t, h, &y, &rate).unwrap();
    }
    (y.q[0] - exact(2.0)).abs()
}

/// log₂ of what halving the step gains.
fn order<I: FixedStep + Default>(steps: u32) -> f64 {
    (error::<I>(steps) / error::<I>(2 * steps)).log2()
}

#[test]
fn fixed_steps_converge_with_the_order_of_their_method() {
    for (found, expected) in [
        (order::<SemiImplicitEuler>(200), 1.0),
        (order::<RungeKutta4>(40), 4.0),
        (order::<DormandPrince5>(20), 5.0),
    ] {
        assert!((found - expected).abs() < 0.15, "{found} for {expected}");
    }
    let eighth = order::<DormandPrince8>(4);
    assert!(eighth > 7.5, "{eighth}");
}

/// Largest error of the polynomial of one step of `h` from the start.
fn dense_error<M: Embedded + Default>(h: f64) -> f64 {
    let mut equation = Oscillator { tolerance: 1e30 };
    let mut adaptive = Adaptive::default().with_first(h);
    let y = start();
    let from = Point { t: 0.0, y, rate: equation.rate(0.0, &y).unwrap() };
    let accepted = adaptive.step(M::default(), &mut equation, &from, h, false).unwrap();
    let polynomial = accepted.polynomial(&mut equation).unwrap();
    let parts = (1..20).map(|part| f64::from(part) * h / 20.0);
    parts.map(|t| (polynomial.at(t).q[0] - exact(t)).abs()).fold(0.0, f64::max)
}

#[test]
fn dense_output_of_one_step_has_the_order_of_its_polynomial() {
    let fourth = (dense_error::<DormandPrince5>(0.1) / dense_error::<DormandPrince5>(0.05)).log2();
    assert!((fourth - 5.0).abs() < 0.3, "{fourth}");
    let seventh = (dense_error::<DormandPrince8>(1.6) / dense_error::<DormandPrince8>(0.8)).log2();
    assert!((seventh - 8.0).abs() < 0.5, "{seventh}");
}

fn adaptive_error<M: Embedded + Default>(tolerance: f64) -> (f64, u32) {
    let mut equation = Oscillator { tolerance };
    let y = start();
    let from = Point { t: 0.0, y, rate: equation.rate(0.0, &y).unwrap() };
    let mut adaptive = Adaptive::default();
    let end = adaptive.run(M::default(), &mut equation, from, 20.0, |_| None, |_, _| Ok(true)).unwrap();
    assert_eq!(end.t, 20.0);
    ((end.y.q[0] - exact(20.0)).abs(), adaptive.accepted)
}

#[test]
fn adaptive_steps_follow_the_tolerance() {
    for tolerance in [1e-4, 1e-7, 1e-10] {
        for (error, _) in
            [adaptive_error::<DormandPrince5>(tolerance), adaptive_error::<DormandPrince8>(tolerance)]
        {
            assert!(error < 100.0 * tolerance, "{error} at {tolerance}");
        }
    }
    let (few, many) = (adaptive_error::<DormandPrince8>(1e-12).1, adaptive_error::<DormandPrince5>(1e-12).1);
    assert!(4 * few < many, "{few} {many}");
}

/// Ends, polynomials and counts of a run by `method`, bit by bit.
fn bits<M: Embedded>(method: M) -> (Vec<u64>, [u32; 2]) {
    let mut equation = Oscillator { tolerance: 1e-8 };
    let y = start();
    let from = Point { t: 0.0, y, rate: equation.rate(0.0, &y).unwrap() };
    let (mut adaptive, mut bits) = (Adaptive::default(), Vec::new());
    adaptive
        .run(
            method,
            &mut equation,
            from,
            20.0,
            |_| None,
            |equation, accepted| {
                let (start, end) = (accepted.start.t, &accepted.end);
                let between = accepted.polynomial(equation)?.at(0.5 * (start + end.t));
                bits.extend([end.t, end.y.q[0], between.q[0], between.qd[0]].map(f64::to_bits));
                Ok(true)
            },
        )
        .unwrap();
    let fixed = method.step(&mut equation, 0.0, 0.1, &y, &from.rate).unwrap();
    bits.push(fixed.q[0].to_bits());
    (bits, [adaptive.accepted, adaptive.rejected])
}

#[test]
fn an_integrator_that_is_chosen_at_run_time_takes_the_same_steps() {
    type One = Either<DormandPrince8, DormandPrince5>;
    assert_eq!(bits::<One>(Either::First(DormandPrince8)), bits(DormandPrince8));
    assert_eq!(bits::<One>(Either::Second(DormandPrince5)), bits(DormandPrince5));
    assert_ne!(bits(DormandPrince5), bits(DormandPrince8));
    for (method, order) in [(Either::First(SemiImplicitEuler), 1), (Either::Second(RungeKutta4), 4)] {
        assert!(method.order() == order && !method.uses_slopes());
    }
    let radau: Either<RungeKutta4, mbs_runtime::dynamics::Radau5> =
        Either::Second(mbs_runtime::dynamics::Radau5);
    assert!(radau.order() == 5 && radau.uses_slopes());
}

#[test]
fn a_passage_through_zero_is_found_in_its_direction() {
    // q̇ = 1 − sin t − cos t passes zero falling at 0 and rising at π/2.
    let mut equation = Oscillator { tolerance: 1e-12 };
    let y = start();
    let from = Point { t: 0.0, y, rate: equation.rate(0.0, &y).unwrap() };
    let mut found = Vec::new();
    let mut adaptive = Adaptive::default();
    let mut monitor = Monitor::new(Direction::Rising, Scrutiny::beyond(), (0.0, 0.0), (None, false));
    adaptive
        .run(
            DormandPrince8,
            &mut equation,
            from,
            7.0,
            |_| None,
            |equation, accepted| {
                let course = accepted.course(equation);
                let step = (course.start(), course.end());
                found.extend(
                    monitor.first(step, &mut |t| course.at(t).qd[0]).expect("a number").map(|found| found.t),
                );
                Ok(true)
            },
        )
        .unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0] - core::f64::consts::FRAC_PI_2).abs() < 1e-9, "{found:?}");
}

/// q̇ = 0 before t = 1/3, 1 after: a jump that no step may straddle.
struct Jump;

impl Equation<f64> for Jump {
    type State = [f64; 1];

    fn rate(&mut self, t: f64, _: &[f64; 1]) -> Result<[f64; 1], Failure> {
        Ok([if t < 1.0 / 3.0 { 0.0 } else { 1.0 }])
    }
}

impl ErrorNorm<f64> for Jump {
    fn measure<const K: usize>(&self, _: &[f64; 1], _: &[f64; 1], errors: [&[f64; 1]; K]) -> [f64; K] {
        errors.map(|error| error[0].abs() / 1e-6)
    }
}

#[test]
fn a_declared_jump_costs_neither_accuracy_nor_rejected_steps() {
    let run = |declared: bool| {
        let mut adaptive = Adaptive::default();
        let from = Point { t: 0.0, y: [0.0], rate: [0.0] };
        let next = |t: f64| (declared && t < 1.0 / 3.0).then_some(1.0 / 3.0);
        let end = adaptive.run(DormandPrince8, &mut Jump, from, 1.0, next, |_, _| Ok(true)).unwrap();
        ((end.y[0] - 2.0 / 3.0).abs(), adaptive.rejected)
    };
    let (error, rejected) = run(true);
    assert!(error < 1e-14 && rejected == 0, "{error} {rejected}");
    assert!(run(false).1 > 3);
}

/// ẏ = y² from 1 has no solution beyond t = 1.
struct Explosion;

impl Equation<f64> for Explosion {
    type State = [f64; 1];

    fn rate(&mut self, _: f64, y: &[f64; 1]) -> Result<[f64; 1], Failure> {
        Ok([y[0] * y[0]])
    }
}

impl ErrorNorm<f64> for Explosion {
    fn measure<const K: usize>(&self, before: &[f64; 1], _: &[f64; 1], errors: [&[f64; 1]; K]) -> [f64; K] {
        errors.map(|error| error[0].abs() / (1e-8 * before[0].abs()))
    }
}

#[test]
fn a_tolerance_that_no_step_reaches_is_a_failure() {
    let from = Point { t: 0.0, y: [1.0], rate: [1.0] };
    let run = |until: f64| {
        let run =
            Adaptive::default().run(DormandPrince5, &mut Explosion, from, until, |_| None, |_, _| Ok(true));
        run.unwrap_err()
    };
    let Failure { kind: FailureKind::StepTooSmall { .. }, time: Some(time) } = run(2.0) else {
        panic!("{}", run(2.0))
    };
    assert!((time - 1.0).abs() < 1e-6);
    assert!(
        matches!(run(1e300), Failure { kind: FailureKind::OutOfReach { .. }, time: Some(0.0) }),
        "{}",
        run(1e300)
    );
}

/// A rate that is another one each time it is asked for, with a least step worth trying; counts how often it is asked.
struct Noise {
    least: f64,
    asked: u32,
}

impl Equation<f64> for Noise {
    type State = [f64; 1];

    fn rate(&mut self, _: f64, _: &[f64; 1]) -> Result<[f64; 1], Failure> {
        self.asked += 1;
        Ok([if self.asked.is_multiple_of(2) { 1.0 } else { -1.0 }])
    }
}

impl ErrorNorm<f64> for Noise {
    /// Of an error in the rate, which no step makes smaller.
    fn measure<const K: usize>(&self, _: &[f64; 1], _: &[f64; 1], errors: [&[f64; 1]; K]) -> [f64; K] {
        errors.map(|error| if error[0] == 0.0 { 0.0 } else { 2.0 })
    }

    fn least_step(&self) -> f64 {
        self.least
    }

    fn obstacle(&self) -> Option<Failure> {
        Some(FailureKind::Undecided { margin: self.least, single: false }.at(0.0))
    }
}

#[test]
fn a_step_is_not_made_smaller_than_the_equation_says_is_worth_trying() {
    let from = Point { t: 0.0, y: [0.0], rate: [1.0] };
    let asked = |least: f64| {
        let (mut noise, mut adaptive) = (Noise { least, asked: 0 }, Adaptive::default().with_first(0.1));
        let failure = adaptive.step(DormandPrince5, &mut noise, &from, 1.0, false).unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::Undecided { .. }, .. }), "{failure}");
        (noise.asked, adaptive.step)
    };
    let ((few, step), (many, _)) = (asked(1e-3), asked(0.0));
    // A tenth to a thousandth at a fifth to nine tenths a trial; down to what the time resolves it takes five times as many decades.
    assert!(0 < few && 5 * few < many, "{few} {many}");
    assert_eq!(step, None);
}

#[test]
fn an_end_that_is_not_ahead_is_refused() {
    let from = Point { t: 1.0, y: [1.0], rate: [1.0] };
    for until in [1.0, 0.0, f64::NAN, f64::INFINITY] {
        let failure = Adaptive::default()
            .run(DormandPrince5, &mut Explosion, from, until, |_| None, |_, _| Ok(true))
            .unwrap_err();
        assert!(matches!(failure, Failure { kind: FailureKind::InvalidStep { .. }, .. }), "{failure}");
    }
}

//! Chains of four-bar loops: correct at any length, at a cost that grows linearly with it.
#![forbid(unsafe_code)]

use mbs_runtime::{BlockWork, Kinematic, Mechanism, Operations, Stepper, WorstCase, mechanism};

/// Drag links that turn each other: link i of `mean ± difference` drives link i + 1 of `mean ∓ difference` over a coupler. In
/// every second loop the ground points the other way, so that it is the mirrored loop before. Links of even number turn as the
/// motor does, those of odd number as the rocker of one four-bar, for any length of the chain.
macro_rules! chain {
    ($name:ident, $loops:literal) => {
        mechanism! {
            pub mechanism $name;
            const LOOPS: 1 = $loops;
            param mean: m = 0.275;
            param difference: m = -0.025;
            param coupler: m = 0.28;
            param ground: m = 0.1;
            param omega: rad/s = 2;
            coord link: [rad; LOOPS + 1] = 0.4;
            coord rod: [rad; LOOPS] = 0.6;
            drive motor: link[0] == 0.5 + omega*t;
            for i in 0..LOOPS {
                let side = (-1)^i;
                constraint loops {
                    (mean + side*difference)*unit(link[i]) + coupler*unit(rod[i])
                        == [side*ground, 0] + (mean - side*difference)*unit(link[i + 1]);
                }
                branch open: side*sin(link[i + 1] - rod[i]) > 0;
            }
            out last: rad = link[LOOPS];
        }
    };
}

chain!(One, 1);
chain!(Ten, 10);
chain!(Forty, 40);
chain!(TwoHundred, 200);

/// Rounding of a position: Newton's method stops within 64 roundings of a row. Each loop adds the errors of those before, times
/// a quotient of rates of at most 2, which the next loop reverses.
const PER_LOOP: f64 = 2e-13;

/// Angle, rate and acceleration.
type Motion = [f64; 3];

/// The driven link and the coupler of one four-bar, by the law of cosines and by the projections of its loop.
fn four_bar(motor: Motion) -> (Motion, Motion) {
    let (a, b, c, d) = (0.25, 0.3, 0.28, 0.1);
    let [psi, omega, alpha] = motor;
    // From the end of the crank to the pivot of the driven link.
    let (x, y) = (d - a * psi.cos(), -a * psi.sin());
    let square = x * x + y * y;
    // c u(φ) = (x, y) + b u(χ): the angle between the diagonal and the driven link.
    let along = (c * c - b * b - square) / (2.0 * b * square.sqrt());
    let chi = y.atan2(x) + along.acos();
    let phi = (y + b * chi.sin()).atan2(x + b * chi.cos());
    // a ψ̇ u⊥(ψ) + c φ̇ u⊥(φ) = b χ̇ u⊥(χ), along and across the coupler.
    let chi_rate = a * omega * (psi - phi).sin() / (b * (chi - phi).sin());
    let phi_rate = a * omega * (chi - psi).sin() / (c * (phi - chi).sin());
    let chi_acceleration =
        (a * alpha * (psi - phi).sin() + a * omega * omega * (psi - phi).cos() + c * phi_rate * phi_rate
            - b * chi_rate * chi_rate * (chi - phi).cos())
            / (b * (chi - phi).sin());
    let phi_acceleration = (a * alpha * (psi - chi).sin()
        + a * omega * omega * (psi - chi).cos()
        + c * phi_rate * phi_rate * (phi - chi).cos()
        - b * chi_rate * chi_rate)
        / (c * (chi - phi).sin());
    ([chi, chi_rate, chi_acceleration], [phi, phi_rate, phi_acceleration])
}

fn same_direction(found: f64, expected: f64) -> f64 {
    (found - expected).sin().abs() + (1.0 - (found - expected).cos())
}

/// Every link and every coupler at some times of two turns.
fn every_loop_is_one_four_bar<S: Kinematic<f64, N> + Default, const N: usize>() {
    let loops = (N - 1) / 2;
    let chain = S::default();
    let guess = chain.guess(&chain.parameters());
    let mut stepper = Stepper::assemble(chain, guess, 0.0).expect("an assembly");
    let bound = PER_LOOP * (loops as f64 + 1.0);
    for _ in 0..16 {
        for _ in 0..25 {
            stepper.advance(TURN / 200.0).expect("a step");
        }
        let motor = [0.5 + 2.0 * stepper.t(), 2.0, 0.0];
        let (driven, coupler) = four_bar(motor);
        for index in 0..=loops {
            let expected = if index % 2 == 0 { motor } else { driven };
            agree(&stepper, index, expected, bound);
        }
        for index in 0..loops {
            // Seen from the other side the coupler points the other way.
            let turned = coupler[0] + if index % 2 == 0 { 0.0 } else { core::f64::consts::PI };
            agree(&stepper, loops + 1 + index, [turned, coupler[1], coupler[2]], bound);
        }
    }
}

/// Time of a turn of the motor (s).
const TURN: f64 = core::f64::consts::PI;

fn agree<S: Kinematic<f64, N>, const N: usize>(
    stepper: &Stepper<S, f64, N, N>,
    index: usize,
    [angle, rate, acceleration]: Motion,
    bound: f64,
) {
    let name = S::COORDINATES[index].name;
    let error = same_direction(stepper.q()[index], angle);
    assert!(error <= bound, "{name}: {error} for {bound}");
    let error = (stepper.qd()[index] - rate).abs();
    assert!(error <= 10.0 * bound, "rate of {name}: {error}");
    let error = (stepper.qdd()[index] - acceleration).abs();
    assert!(error <= 100.0 * bound, "acceleration of {name}: {error}");
}

#[test]
fn one_loop_is_a_four_bar() {
    every_loop_is_one_four_bar::<One, _>();
}

#[test]
fn ten_loops_are_four_bars() {
    every_loop_is_one_four_bar::<Ten, _>();
}

#[test]
fn forty_loops_are_four_bars() {
    every_loop_is_one_four_bar::<Forty, _>();
}

#[test]
fn two_hundred_loops_are_four_bars() {
    every_loop_is_one_four_bar::<TwoHundred, _>();
}

/// Stack of a debug build for an assembly and steps (bytes): a part for any mechanism, and a part for each loop. Forty loops,
/// which are in one function, need up to 0.7 of it, the others less than half. An overflow ends the program.
const STACK: usize = 256 << 10;
const STACK_A_LOOP: usize = 8 << 10;

fn steps_within<S: Kinematic<f64, N> + Default, const N: usize>(stack: usize) {
    let steps = || {
        let chain = S::default();
        let guess = chain.guess(&chain.parameters());
        let mut stepper = Stepper::assemble(chain, guess, 0.0).expect("an assembly");
        for _ in 0..10 {
            stepper.advance(TURN / 200.0).expect("a step");
        }
        assert!(stepper.closure_error() < 1e-12);
    };
    let thread = std::thread::Builder::new().stack_size(stack).spawn(steps).expect("a thread");
    thread.join().expect("the steps are done");
}

#[test]
fn the_stack_of_a_step_grows_with_the_loops_and_no_faster() {
    let of = |loops: usize| STACK + STACK_A_LOOP * loops;
    steps_within::<One, _>(of(1));
    steps_within::<Ten, _>(of(10));
    steps_within::<Forty, _>(of(40));
    steps_within::<TwoHundred, _>(of(200));
}

mechanism! {
    /// A harmonic series, long enough to be evaluated in parts that are compiled by themselves.
    pub mechanism Series;
    const TERMS: 1 = 360;
    param amplitude: m = 0.5;
    coord phi: rad;
    coord x: m;
    drive crank: phi == 2*t/1s;
    constraint series { x == sum(k in 0..TERMS: amplitude/(k + 1)^3*sin((k + 1)*phi)*exp(-k*phi/1000)); }
}

/// The sum and its first and second derivative by φ.
fn series(phi: f64) -> Motion {
    let mut motion = [0.0; 3];
    for index in 0..360 {
        let k = f64::from(index);
        let (size, rate, decay) = (0.5 / (k + 1.0).powi(3), k + 1.0, k / 1000.0);
        let (sine, cosine) = (rate * phi).sin_cos();
        let scale = size * (-decay * phi).exp();
        motion[0] += scale * sine;
        motion[1] += scale * (rate * cosine - decay * sine);
        motion[2] += scale * ((decay * decay - rate * rate) * sine - 2.0 * decay * rate * cosine);
    }
    motion
}

#[test]
fn a_long_row_has_the_values_of_its_formula() {
    // Rounding of 360 terms, the angle of the last of which is 200 rad; a derivative multiplies it by up to 360.
    let rounding = 1e-13;
    let long = Series::default();
    let parameters = long.parameters();
    let position = long.position(&parameters, &[0.3, 0.7], 0.2);
    let [crank, row]: [f64; 2] = long.phi(&parameters, &position);
    assert!((crank + 0.1).abs() < rounding, "{crank}");
    assert!((row - (0.7 - series(0.3)[0])).abs() < rounding, "{row}");
    let mut stepper = Stepper::assemble(long, [0.0, 0.0], 0.0).expect("an assembly");
    for _ in 0..10 {
        stepper.advance(0.03).expect("a step");
        let [value, slope, curvature] = series(2.0 * stepper.t());
        let expected = [value, 2.0 * slope, 4.0 * curvature];
        let found = [stepper.q()[1], stepper.qd()[1], stepper.qdd()[1]];
        for (order, (found, expected)) in found.into_iter().zip(expected).enumerate() {
            let bound = rounding * 360.0_f64.powi(order as i32);
            assert!((found - expected).abs() < bound, "derivative {order}: {found} {expected}");
        }
        assert!(stepper.closure_error() < rounding);
    }
}

fn total(count: Operations) -> usize {
    let Operations {
        additions, multiplications, divisions, sine_cosines, functions, selections, calls, ..
    } = count;
    (additions + multiplications + divisions + sine_cosines + functions + selections + calls) as usize
}

/// Operations of each emitted function.
fn work<S: WorstCase>() -> [usize; 8] {
    let work = S::WORK;
    let before = work.blocks.iter().map(|BlockWork { count, before, .. }| count * total(*before)).sum();
    let evaluation =
        work.blocks.iter().map(|BlockWork { count, evaluation, .. }| count * total(*evaluation)).sum();
    let of = [work.position, work.phi, work.phi_q, work.phi_t, work.gamma, work.branch_values].map(total);
    let [position, phi, phi_q, phi_t, gamma, branches] = of;
    [position, phi, phi_q, phi_t, gamma, branches, before, evaluation]
}

#[test]
fn each_loop_costs_as_many_operations_as_any_other() {
    let (ten, forty, many) = (work::<Ten>(), work::<Forty>(), work::<TwoHundred>());
    for ((ten, forty), many) in ten.into_iter().zip(forty).zip(many) {
        assert_eq!((forty - ten) * 160, (many - forty) * 30, "{ten} {forty} {many}");
    }
    assert!(total(<Ten as WorstCase>::WORK.gamma) > 100);
    assert_eq!(
        (<TwoHundred as WorstCase>::WORK.entries, <TwoHundred as WorstCase>::WORK.coordinates),
        (1201, 401)
    );
}

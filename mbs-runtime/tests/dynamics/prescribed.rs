//! Drives that prescribe a rate, under forces: the phase is as exact as the motion is asked to be.

use mbs_runtime::dynamics::{
    Direction, DormandPrince5, DormandPrince8, Explicit, FixedStep, Formulation, Projection, RungeKutta4,
    Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Signal, mechanism};

mechanism! {
    /// A cart at a speed that oscillates, with a pendulum on it.
    pub mechanism Shaken;
    param w: rad/s = 4;
    coord x: m = 0;
    coord phi: rad = 0.1;
    body cart { mass: 2, com: [x, 0] }
    body bob { mass: 1, com: [x, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    drive speed: rate(x) == 0.3m/1s*cos(w*t);
    start phi = 0.1 rate 1;
}

mechanism! {
    /// The same cart, its place prescribed.
    pub mechanism Moved;
    param w: rad/s = 4;
    coord x: m = 0;
    coord phi: rad = 0.1;
    body cart { mass: 2, com: [x, 0] }
    body bob { mass: 1, com: [x, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    drive speed: x == 0.3m/1s/w*sin(w*t);
    start phi = 0.1 rate 1;
}

const END: f64 = 2.0;

type Run<I, F> = Simulation<Shaken, Explicit<I, F>, f64, 2, 1>;

fn shaken<I: FixedStep, F: Formulation<Shaken, f64, 2, 1>>(
    w: f64,
    integrator: I,
    formulation: F,
) -> Run<I, F> {
    let shaken = Shaken { w, ..Shaken::default() };
    Simulation::start_from_text(shaken, Explicit::new(integrator, formulation), 0.0).unwrap()
}

fn place(w: f64, t: f64) -> f64 {
    0.3 / w * (w * t).sin()
}

/// The pendulum's angle at the end.
fn angle(w: f64) -> f64 {
    let moved = Moved { w };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(moved, method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-13));
    run.advance_to(END).unwrap();
    run.q()[1]
}

/// Largest error of place, angle and balance against the tolerance.
#[track_caller]
fn assert_follows<I: FixedStep, F: Formulation<Shaken, f64, 2, 1> + Copy>(
    run: Run<I, F>,
    w: f64,
    advance: impl Fn(&mut Run<I, F>, f64),
) {
    let exact = angle(w);
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let mut run = run;
        advance(&mut run, tolerance);
        let [x, phi] = *run.q();
        let error = (x - place(w, END)).abs().max((phi - exact).abs()).max(run.balance().defect.abs());
        // An accepted step leaves its tolerance, a hundred steps a hundred times that; the forces are some ten newtons.
        assert!(error < 1e3 * tolerance, "{error:e} at {tolerance:e}");
        assert!(run.balance().phi < 1e-13, "{:?}", run.balance());
    }
}

#[test]
fn a_prescribed_rate_is_integrated_to_the_tolerance() {
    for w in [4.0, 40.0] {
        assert_follows(shaken(w, DormandPrince8, Projection::default()), w, |run, tolerance| {
            *run = run.with_tolerance(Tolerance::new(tolerance));
            run.advance_to(END).unwrap();
        });
        assert_follows(shaken(w, DormandPrince5, VelocityTransformation), w, |run, tolerance| {
            *run = run.with_tolerance(Tolerance::new(tolerance));
            run.advance_to(END).unwrap();
        });
    }
}

#[test]
fn samples_between_steps_are_as_exact() {
    let run = shaken(40.0, DormandPrince8, VelocityTransformation).with_tolerance(Tolerance::new(1e-10));
    let mut sampled = run;
    let mut worst = 0.0_f64;
    sampled
        .sample(END, 57, |instant| worst = worst.max((instant.y.q[0] - place(40.0, instant.t)).abs()))
        .unwrap();
    assert!(worst < 1e-8, "{worst:e}");
    let mut stopped = run;
    assert!(stopped.advance_until_event(END, Direction::Falling, |_, q, _| q[0]).unwrap());
    assert!((stopped.t() - core::f64::consts::PI / 40.0).abs() < 1e-7, "{}", stopped.t());
    // It goes on from there as if nothing had been.
    stopped.advance_to(END).unwrap();
    assert!((stopped.q()[0] - place(40.0, END)).abs() < 1e-7, "{}", stopped.q()[0]);
}

mechanism! {
    /// The cart at a speed from outside.
    pub mechanism Pushed;
    input speed: m/s;
    coord x: m = 0;
    coord phi: rad = 0.1;
    body cart { mass: 2, com: [x, 0] }
    body bob { mass: 1, com: [x, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    drive motor: rate(x) == speed;
    start phi = 0.1 rate 1;
}

#[test]
fn a_speed_that_jumps_acts_from_the_first_step_on() {
    let pushed: Pushed = Pushed { speed: 0.5, ..Pushed::default() };
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let run = Simulation::start_from_text(pushed, method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.change(|pushed| pushed.speed = -1.0);
    run.advance_to(0.5).unwrap();
    assert!((run.q()[0] + 0.5).abs() < 1e-12, "{:?}", run.q());
    // The jump keeps the momentum of the free coordinate; from then on the cart is an inertial frame.
    let rate = 1.0 - 1.5 * 0.1_f64.sin();
    let still = Simulation::start(Pushed::<f64>::default(), method, 0.0, [0.0, 0.1], [0.0, rate]).unwrap();
    let mut still = still.with_tolerance(Tolerance::new(1e-12));
    still.advance_to(0.5).unwrap();
    assert!((run.q()[1] - still.q()[1]).abs() < 1e-9, "{:?} {:?}", run.q(), still.q());
}

#[test]
fn fixed_steps_have_the_order_of_their_method_with_a_prescribed_rate() {
    fn error<I: FixedStep>(integrator: I, steps: u32) -> f64 {
        let mut run = shaken(4.0, integrator, Projection::default());
        run.step_to(END, steps).unwrap();
        (run.q()[0] - place(4.0, END)).abs()
    }
    let eighth = (error(DormandPrince8, 6) / error(DormandPrince8, 12)).log2();
    assert!(eighth > 7.5, "{eighth}");
    let integrals = (error(RungeKutta4, 6) / error(RungeKutta4, 12)).log2();
    assert!(integrals > 5.5, "{integrals}");
    assert!(error(RungeKutta4, 20) < 1e-9);
}

mechanism! {
    /// A pendulum on a cart that is where a signal says, with a spring from where it says.
    pub mechanism Followed;
    input u: m, rates;
    coord x: m = 0;
    coord phi: rad = 0.5;
    body cart { mass: 1, com: [x, 0] }
    body bob { mass: 1, com: [x, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [2*u, 0.5m], to: [x, 0] + 1m*unit(phi), stiffness: 30, length: 0.2 }
    constraint hold { x == u; }
    start phi = 0.5 rate 0;
}

mechanism! {
    /// The same pendulum, its pivot where the signal says.
    pub mechanism Borne;
    input u: m, rates;
    coord phi: rad = 0.5;
    body bob { mass: 1, com: [u, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [2*u, 0.5m], to: [u, 0] + 1m*unit(phi), stiffness: 30, length: 0.2 }
    start phi = 0.5 rate 0;
}

mechanism! {
    /// The same pendulum, its cart where the time says.
    pub mechanism Timed;
    coord x: m = 0;
    coord phi: rad = 0.5;
    body cart { mass: 1, com: [x, 0] }
    body bob { mass: 1, com: [x, 0] + 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0.6m*sin(3*t/1s), 0.5m], to: [x, 0] + 1m*unit(phi), stiffness: 30, length: 0.2 }
    drive hold: x == 0.3m*sin(3*t/1s);
    start phi = 0.5 rate 0;
}

fn signal(t: f64) -> Signal<f64> {
    let (sine, cosine) = (3.0 * t).sin_cos();
    Signal { value: 0.3 * sine, rate: 0.9 * cosine, acceleration: -2.7 * sine }
}

/// Angle and energy defect at 1 s of a run whose signals are set before each of `steps` steps.
fn followed<S, F, const N: usize, const M: usize>(
    mut mechanism: S,
    formulation: F,
    set: impl Fn(&mut S, Signal<f64>),
    steps: u32,
) -> [f64; 2]
where
    S: Dynamic<f64, N, M>,
    F: Formulation<S, f64, N, M>,
{
    set(&mut mechanism, signal(0.0));
    let method = Explicit::new(RungeKutta4, formulation);
    let mut run = Simulation::start_from_text(mechanism, method, 0.0).unwrap();
    let h = 1.0 / f64::from(steps);
    for step in 0..steps {
        run.change(|mechanism| set(mechanism, signal(h * f64::from(step))));
        run.step(h).unwrap();
        assert!(run.balance().phi < 1e-13 && run.balance().phi_d < 1e-12);
    }
    [run.q()[N - 1], run.balance().defect]
}

#[test]
fn a_signal_is_carried_along_within_a_step_in_rows_bodies_and_springs() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut exact = Simulation::start_from_text(Timed::default(), method, 0.0).unwrap();
    exact.advance_to(1.0).unwrap();
    let exact = exact.q()[1];
    let errors = |steps| {
        let hold = |followed: &mut Followed, u| followed.u = u;
        [
            followed(Followed::default(), Projection::default(), hold, steps),
            followed(Followed::default(), VelocityTransformation, hold, steps),
            followed(Borne::default(), Projection::default(), |borne: &mut Borne, u| borne.u = u, steps),
        ]
    };
    for (coarse, fine) in errors(100).into_iter().zip(errors(400)) {
        // What the third derivative of the signal leaves in a step, h²/2 of it in the rate, is a jump to the next: order 1 in all.
        let [angle, before] = [(fine[0] - exact).abs(), (coarse[0] - exact).abs()];
        assert!(angle < 1e-3 && 3.0 * angle < before, "{angle:e} {before:e}");
        assert!(fine[1].abs() < 1e-10 && 100.0 * fine[1].abs() < coarse[1].abs(), "{fine:?} {coarse:?}");
    }
}

#[test]
fn a_signal_with_a_lasting_acceleration_needs_no_steps_of_its_own() {
    let u: Signal<f64> = Signal { value: 0.0, rate: 0.3, acceleration: 0.4 };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut rows = Simulation::start_from_text(Followed::<f64> { u }, method, 0.0).unwrap();
    rows.advance_to(1.0).unwrap();
    let mut pivot = Simulation::start_from_text(Borne::<f64> { u }, method, 0.0).unwrap();
    pivot.advance_to(1.0).unwrap();
    assert!((rows.q()[0] - 0.5).abs() < 1e-14 && (rows.qd()[0] - 0.7).abs() < 1e-13, "{:?}", rows.q());
    assert!((rows.q()[1] - pivot.q()[0]).abs() < 1e-9, "{:?} {:?}", rows.q(), pivot.q());
    assert!(rows.balance().phi < 1e-14 && rows.balance().defect.abs() < 1e-8, "{:?}", rows.balance());
    assert!(pivot.balance().defect.abs() < 1e-8, "{:?}", pivot.balance());
    assert!((rows.mechanism().u.value - 0.5).abs() < 1e-14);
}

//! Numbers that are none, or far too large or small, at every entry point: a typed failure and the state as before, or an answer
//! that holds.

use std::time::{Duration, Instant};

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince5, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha,
    Projection, RungeKutta4, Simulation, Tolerance, VelocityTransformation, equilibrium, inverse,
};
use mbs_runtime::{
    Batch, Budget, Failure, Lanes, Mechanism, Scalar, Step, Stepper, assemble, mechanism, newton_raphson,
};

mechanism! {
    /// A slider-crank that a measured angle and a time law drive, with a load.
    pub mechanism Press;
    param crank: m = 0.05;
    param rod: m = 0.18;
    param speed: rad/s = 3;
    param mass: kg = 0.4;
    input measured: rad, rates;
    input load: N;
    coord theta: rad = 0.3;
    coord phi: rad = -0.1;
    coord x: m = 0.22;
    body piston { mass: mass, com: [x, 0] }
    force push: [load, 0] on [x, 0];
    constraint closure { crank*unit(theta) + rod*unit(phi) == [x, 0]; }
    drive motor: theta == 0.3 + speed*t + measured;
    branch ahead: cos(phi) > 0;
}

mechanism! {
    /// A pendulum on a spring with a damper and a force.
    pub mechanism Swing;
    param length: m = 1;
    param mass: kg = 2;
    param stiffness: N/m = 30;
    param damping: N*s/m = 0.5;
    input push: N;
    coord p: [m; 2] = [0.8, -0.6];
    body bob { mass: mass, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [1, 0], to: p, stiffness: stiffness, length: 0.4, damping: damping }
    force wind: [push, 0] on p;
    constraint rod { dot(p, p) == length^2; }
}

/// NaN, infinities, numbers whose square overflows, denormals and zeros.
const BAD: [f64; 9] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 5e-324, -5e-324, 0.0, -0.0];

/// A failure may take so long, the best of three.
const SOON: Duration = Duration::from_millis(20);

/// Bits of numbers.
fn bits(values: &[&[f64]]) -> Vec<u64> {
    values.iter().flat_map(|values| values.iter()).map(|value| value.to_bits()).collect()
}

/// An answer with the bits of the state before and after.
type Told = (Result<Vec<f64>, Failure>, Vec<u64>, Vec<u64>);

/// Combinations that were tried, and failures among the answers.
#[derive(Default)]
struct Tried {
    combinations: usize,
    failures: usize,
}

impl Tried {
    /// Tries `call` on a copy of a state. `before` and the second part of the answer are the bits of the state, the first part what
    /// must be finite and closed if it is `Ok`.
    fn call(&mut self, place: &str, bad: f64, call: &dyn Fn(f64) -> Told) {
        self.combinations += 1;
        let mut soonest = Duration::MAX;
        for _ in 0..3 {
            let began = Instant::now();
            let (answer, before, after) = call(bad);
            soonest = soonest.min(began.elapsed());
            match answer {
                Err(failure) => {
                    assert_eq!(before, after, "{place} of {bad:e}: the state has changed: {failure}");
                    assert!(!failure.to_string().is_empty());
                }
                Ok(found) => {
                    assert!(bad.is_finite(), "{place} of {bad}: `Ok` with {found:?}");
                    assert!(found.iter().all(|value| value.is_finite()), "{place} of {bad:e}: {found:?}");
                }
            }
        }
        let (answer, ..) = call(bad);
        self.failures += usize::from(answer.is_err());
        assert!(answer.is_ok() || soonest < SOON, "{place} of {bad:e} takes {soonest:?}");
    }
}

/// Values that an answer of kinematics must have, with the closure as a number that is none where it is open.
fn placed(q: &[f64], qd: &[f64], qdd: &[f64], closure: f64) -> Vec<f64> {
    let closed = if closure.abs() < 1e-9 { 0.0 } else { f64::NAN };
    [q, qd, qdd, &[closed]].concat()
}

type Running = Stepper<Press, f64, 3, 3>;

fn running() -> Running {
    let mut stepper = Stepper::assemble(Press::default(), [0.3, -0.1, 0.22], 0.0).expect("it assembles");
    stepper.advance(0.01).expect("a step");
    stepper
}

fn answered<X>(stepper: &Running, answer: Result<X, Failure>) -> Result<Vec<f64>, Failure> {
    let (q, qd, qdd) = (stepper.q(), stepper.qd(), stepper.qdd());
    answer.map(|_| placed(q, qd, qdd, stepper.closure_error()))
}

fn state(stepper: &Running) -> Vec<u64> {
    bits(&[stepper.q(), stepper.qd(), stepper.qdd(), &[stepper.t()]])
}

/// Tries a step of a running stepper.
fn step(tried: &mut Tried, place: &str, bad: f64, act: &dyn Fn(&mut Running, f64) -> Result<(), Failure>) {
    tried.call(place, bad, &|bad| {
        let mut stepper = running();
        let before = state(&stepper);
        let answer = act(&mut stepper, bad);
        (answered(&stepper, answer), before, state(&stepper))
    });
}

#[test]
fn motions_from_drives_refuse_or_answer() {
    let mut tried = Tried::default();
    for bad in BAD {
        for j in 0..4 {
            let given = |bad: f64| {
                let mut guess = [0.3, -0.1, 0.22, 0.0];
                guess[j] = bad;
                ([guess[0], guess[1], guess[2]], guess[3])
            };
            tried.call("the guess of `assemble`", bad, &|bad| {
                let (guess, t) = given(bad);
                let found = assemble::<_, f64, 3, 3>(&Press::default(), guess, t);
                (found.map(|found| found.q.to_vec()), Vec::new(), Vec::new())
            });
            tried.call("the guess of a `Stepper`", bad, &|bad| {
                let (guess, t) = given(bad);
                let found = Stepper::<_, f64, 3, 3>::assemble(Press::default(), guess, t);
                let found = found.map(|s| placed(s.q(), s.qd(), s.qdd(), s.closure_error()));
                (found, Vec::new(), Vec::new())
            });
            tried.call("the guess of `newton_raphson`", bad, &|bad| {
                let (guess, t) = given(bad);
                let found = newton_raphson::<_, f64, 3, 3>(&Press::default(), guess, t);
                (found.map(|(q, _)| q.to_vec()), Vec::new(), Vec::new())
            });
        }
        step(&mut tried, "h of `advance`", bad, &|s, bad| s.advance(bad).map(|_| ()));
        step(&mut tried, "t of `advance_to`", bad, &|s, bad| s.advance_to(bad).map(|_| ()));
        step(
            &mut tried,
            "h of `step`",
            bad,
            &|s, bad| match s.step(bad, Budget { newton: 3, fallback: 1 }) {
                Step::Refused(failure) => Err(failure),
                _ => s.advance(0.0).map(|_| ()),
            },
        );
        for index in 0..Press::<f64>::VARIABLES.len() {
            let name = Press::<f64>::VARIABLES[index].name;
            step(&mut tried, &format!("`{name}` of a `Stepper`"), bad, &|s, bad| {
                s.change(|press| press.set(index, bad));
                s.advance(1e-3).map(|_| ())
            });
            tried.call(&format!("`{name}` of `assemble`"), bad, &|bad| {
                let mut press = Press::default();
                press.set(index, bad);
                let found = Stepper::<_, f64, 3, 3>::assemble(press, [0.3, -0.1, 0.22], 0.0);
                (found.map(|s| placed(s.q(), s.qd(), s.qdd(), s.closure_error())), Vec::new(), Vec::new())
            });
        }
    }
    println!("{} combinations, {} of them failures", tried.combinations, tried.failures);
    assert!(tried.combinations >= 200 && tried.failures >= 100, "{} {}", tried.combinations, tried.failures);
}

#[test]
fn a_lane_with_a_bad_number_fails_alone() {
    type Four = Lanes<f64, 4>;
    let press = mbs_runtime::InNumbers::<Four>::in_numbers(&Press::default());
    for bad in BAD.into_iter().filter(|bad| !bad.is_finite()) {
        for lane in 0..4 {
            let mut batch = Batch::<_, f64, 4, 3, 3>::assemble(press, &[[0.3, -0.1, 0.22]; 4], [0.0; 4])
                .map_err(|(_, failure)| failure)
                .expect("it assembles");
            let before = batch.q().map(|q| q.lane(lane).to_bits());
            let mut times = [0.01; 4];
            times[lane] = bad;
            let answers = batch.advance_to(times);
            for (k, answer) in answers.iter().enumerate() {
                assert_eq!(answer.is_err(), k == lane, "lane {k} at {times:?}: {answer:?}");
            }
            assert_eq!(before, batch.q().map(|q| q.lane(lane).to_bits()));
        }
    }
}

/// Tries the entry points of a method: its start and its steps.
macro_rules! by_method {
    ($tried:expr, $name:literal, $method:expr) => {
        for bad in BAD {
            for j in 0..5 {
                $tried.call(concat!("the start of ", $name), bad, &|bad| {
                    let mut given = [0.8, -0.6, 0.0, 0.0, 0.0];
                    given[j] = bad;
                    let [x, y, vx, vy, t] = given;
                    let found = Simulation::<Swing, _, f64, 2, 1>::start(
                        Swing::default(),
                        $method,
                        t,
                        [x, y],
                        [vx, vy],
                    );
                    let found = found.map(|run| placed(run.q(), run.qd(), run.qdd(), run.balance().phi));
                    (found, Vec::new(), Vec::new())
                });
            }
            let moved = |act: &dyn Fn(&mut Simulation<Swing, _, f64, 2, 1>, f64) -> Result<(), Failure>,
                         bad: f64| {
                let mut run =
                    Simulation::<Swing, _, f64, 2, 1>::start_from_text(Swing::default(), $method, 0.0)
                        .expect("a start");
                run.step(1e-3).expect("a step");
                let state = |run: &Simulation<Swing, _, f64, 2, 1>| {
                    bits(&[run.q(), run.qd(), run.qdd(), run.lambda(), &[run.t()]])
                };
                let before = state(&run);
                let answer = act(&mut run, bad);
                let found = answer.map(|()| placed(run.q(), run.qd(), run.qdd(), run.balance().phi));
                (found, before, state(&run))
            };
            $tried.call(concat!("h of ", $name), bad, &|bad| moved(&|run, bad| run.step(bad), bad));
            $tried.call(concat!("t of ", $name), bad, &|bad| moved(&|run, bad| run.step_to(bad, 3), bad));
            for index in 0..Swing::<f64>::VARIABLES.len() {
                let place = format!("`{}` of {}", Swing::<f64>::VARIABLES[index].name, $name);
                $tried.call(&place, bad, &|bad| {
                    moved(
                        &|run, bad| {
                            run.change(|swing| swing.set(index, bad));
                            run.step(1e-3)
                        },
                        bad,
                    )
                });
            }
        }
    };
}

#[test]
fn motions_from_forces_refuse_or_answer() {
    let mut tried = Tried::default();
    by_method!(tried, "`RungeKutta4`", Explicit::new(RungeKutta4, Projection::default()));
    by_method!(tried, "`VelocityTransformation`", Explicit::new(DormandPrince5, VelocityTransformation));
    by_method!(tried, "`Baumgarte`", Explicit::new(RungeKutta4, Baumgarte::default()));
    by_method!(tried, "`AugmentedLagrangian`", AugmentedLagrangian);
    by_method!(tried, "`Extrapolated`", Extrapolated);
    by_method!(tried, "`GeneralizedAlpha`", GeneralizedAlpha::default());
    println!("{} combinations, {} of them failures", tried.combinations, tried.failures);
    assert!(tried.combinations >= 500 && tried.failures >= 200, "{} {}", tried.combinations, tried.failures);
}

#[test]
fn adaptive_runs_rest_and_inverse_dynamics_refuse_or_answer() {
    let mut tried = Tried::default();
    let method = || Explicit::new(DormandPrince8, Projection::default());
    for bad in BAD {
        // A span without end is none that a run could refuse soon; its ends are.
        if !(bad.is_finite() && bad.abs() > 1.0) {
            tried.call("t of an adaptive run", bad, &|bad| {
                let mut run =
                    Simulation::<Swing, _, f64, 2, 1>::start_from_text(Swing::default(), method(), 0.0)
                        .expect("a start");
                let state = |run: &Simulation<Swing, _, f64, 2, 1>| bits(&[run.q(), run.qd(), &[run.t()]]);
                let before = state(&run);
                let answer = run.advance_to(bad);
                (
                    answer.map(|()| placed(run.q(), run.qd(), run.qdd(), run.balance().phi)),
                    before,
                    state(&run),
                )
            });
        }
        tried.call("the tolerance of an adaptive run", bad, &|bad| {
            let run = Simulation::<Swing, _, f64, 2, 1>::start_from_text(Swing::default(), method(), 0.0);
            let mut run = run.expect("a start").with_tolerance(Tolerance { relative: bad, absolute: bad });
            let before = bits(&[run.q(), run.qd(), &[run.t()]]);
            let answer = run.advance_to(1e-3);
            let after = bits(&[run.q(), run.qd(), &[run.t()]]);
            (answer.map(|()| placed(run.q(), run.qd(), run.qdd(), run.balance().phi)), before, after)
        });
        for j in 0..3 {
            let mut given = [0.8, -0.6, 0.0];
            given[j] = bad;
            tried.call("the guess of `equilibrium`", bad, &|_| {
                let found = equilibrium::<_, f64, 2, 1>(&Swing::default(), given[2], &[given[0], given[1]]);
                (found.map(|rest| rest.q.to_vec()), Vec::new(), Vec::new())
            });
            let mut given = [0.3, -0.1, 0.22, 0.0];
            given[j] = bad;
            tried.call("the guess of `inverse`", bad, &|_| {
                let q = [given[0], given[1], given[2]];
                let found = inverse::<_, f64, 3, 3>(&Press::default(), given[3], &q);
                (found.map(|driven| driven.lambda.to_vec()), Vec::new(), Vec::new())
            });
        }
    }
    assert!(tried.combinations >= 60 && tried.failures >= 20, "{} {}", tried.combinations, tried.failures);
}

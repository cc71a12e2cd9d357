//! Hashes of the bits of results: kinematics, lanes, bounded steps, saved states, every method of dynamics, analyses.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince5, DormandPrince8, Embedded, Explicit, Extrapolated,
    GeneralizedAlpha, Method, Penalty, Projection, Radau5, RungeKutta4, SemiImplicitEuler, Simulation,
    Tolerance, Unstabilized, VelocityTransformation, equilibrium, inverse, linearize,
};
use mbs_runtime::{
    Batch, Budget, Dynamic, Failure, Kinematic, Lanes, Mechanism, Real, Signal, Step, Stepper,
};

use crate::Hash;
use crate::texts::{Block, Driven, Falling, Measured, Pump, Redundant, Resting, Slider};

impl Hash {
    fn numbers<R: Real>(&mut self, values: &[R]) {
        values.iter().for_each(|value| self.take(&value.to_f64().to_bits().to_le_bytes()));
    }

    fn outcome<X>(&mut self, index: usize, outcome: &Result<X, Failure>) {
        if outcome.is_err() {
            self.refuse(index);
        }
    }

    fn stepper<S, R, const N: usize, const M: usize>(&mut self, stepper: &Stepper<S, R, N, M>)
    where
        S: Kinematic<R, N, M>,
        R: Real,
    {
        self.numbers(&[stepper.t()]);
        for values in [stepper.q(), stepper.qd(), stepper.qdd()] {
            self.numbers(values);
        }
    }
}

/// 400 steps of a size that grows and shrinks.
fn stepped<S, R, const N: usize, const M: usize>(mechanism: S, mut change: impl FnMut(&mut S, R)) -> Hash
where
    S: Kinematic<R, N, M>,
    R: Real,
{
    let mut hash = Hash::new();
    let guess = mechanism.guess(&mechanism.parameters());
    let mut stepper = Stepper::assemble(mechanism, guess, R::constant(0.0)).expect("it assembles");
    hash.stepper(&stepper);
    for index in 0..400_usize {
        let h = R::constant([0.001, 0.004, 0.02, 0.007][index % 4]);
        let t = stepper.t() + h;
        stepper.change(|mechanism| change(mechanism, t));
        hash.outcome(index, &stepper.advance(h));
        hash.stepper(&stepper);
    }
    hash
}

/// Bounded steps, with the state saved and restored after each.
fn bounded<S, R, const N: usize>(mechanism: S) -> Hash
where
    S: Kinematic<R, N, N>,
    R: Real,
{
    let mut hash = Hash::new();
    let guess = mechanism.guess(&mechanism.parameters());
    let mut stepper = Stepper::assemble(mechanism, guess, R::constant(0.0)).expect("it assembles");
    for index in 0..200_usize {
        let budget = Budget { newton: (index % 3) as u32, fallback: (index % 5) as u32 };
        match stepper.step(R::constant(0.005), budget) {
            Step::Done(_) => {}
            Step::Degraded { residual, .. } => hash.numbers(&[residual]),
            Step::Refused(_) => hash.refuse(index),
        }
        hash.stepper(&stepper);
    }
    hash
}

fn simulated<S, X, R, const N: usize, const M: usize>(
    mechanism: S,
    method: X,
    run: impl FnOnce(&mut Simulation<S, X, R, N, M>, &mut Hash),
) -> Hash
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    let mut hash = Hash::new();
    match Simulation::start_from_text(mechanism, method, R::constant(0.0)) {
        Ok(mut simulation) => run(&mut simulation, &mut hash),
        Err(_) => hash.refuse(0),
    }
    hash
}

fn state<S, X, R, const N: usize, const M: usize>(simulation: &Simulation<S, X, R, N, M>, hash: &mut Hash)
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    hash.numbers(&[simulation.t()]);
    for values in [simulation.q(), simulation.qd(), simulation.qdd()] {
        hash.numbers(values);
    }
    hash.numbers(simulation.lambda());
    hash.numbers(simulation.states().as_ref());
}

/// 150 steps of 2 ms.
fn equal_steps<S, X, R, const N: usize, const M: usize>(mechanism: S, method: X) -> Hash
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    simulated(mechanism, method, |simulation, hash| {
        for index in 0..150 {
            hash.outcome(index, &simulation.step(R::constant(0.002)));
            state(simulation, hash);
        }
        let balance = simulation.balance();
        hash.numbers(&[balance.defect, balance.phi]);
    })
}

/// 20 instants of a run with steps from a tolerance.
fn adaptive<S, I, F, R, const N: usize, const M: usize>(mechanism: S, method: Explicit<I, F>) -> Hash
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: mbs_runtime::dynamics::Formulation<S, R, N, M>,
    R: Real,
{
    let tolerance = R::constant(1e-6).max(R::EPSILON * R::constant(100.0));
    let tolerance = Tolerance { relative: tolerance, absolute: tolerance };
    let mut hash = Hash::new();
    match Simulation::start_from_text(mechanism, method, R::constant(0.0)) {
        Ok(simulation) => {
            let mut simulation = simulation.with_tolerance(tolerance);
            for index in 1..=20_usize {
                let until = R::constant(0.1 * index as f64);
                hash.outcome(index, &simulation.advance_to(until));
                state(&simulation, &mut hash);
            }
        }
        Err(_) => hash.refuse(0),
    }
    hash
}

/// Every method on one mechanism.
macro_rules! methods {
    ($found:ident, $label:expr, $name:literal, $make:expr) => {{
        let mut equal = |name: &str, hash: Hash| $found.push((format!("{}.{}.{name}", $label, $name), hash));
        equal("rk4.projection", equal_steps($make, Explicit::new(RungeKutta4, Projection::default())));
        equal("rk4.baumgarte", equal_steps($make, Explicit::new(RungeKutta4, Baumgarte::default())));
        equal("rk4.penalty", equal_steps($make, Explicit::new(RungeKutta4, Penalty::default())));
        equal("rk4.unstabilized", equal_steps($make, Explicit::new(RungeKutta4, Unstabilized)));
        equal(
            "euler.projection",
            equal_steps($make, Explicit::new(SemiImplicitEuler, Projection::default())),
        );
        equal("augmented_lagrangian", equal_steps($make, AugmentedLagrangian::default()));
        equal("generalized_alpha", equal_steps($make, GeneralizedAlpha::default()));
        equal("extrapolated", equal_steps($make, Extrapolated::default()));
        equal("order5.projection", adaptive($make, Explicit::new(DormandPrince5, Projection::default())));
        equal("order8.projection", adaptive($make, Explicit::new(DormandPrince8, Projection::default())));
        equal("order8.velocity", adaptive($make, Explicit::new(DormandPrince8, VelocityTransformation)));
        equal("radau.projection", adaptive($make, Explicit::new(Radau5, Projection::default())));
    }};
}

/// Hashes of all runs in one number type.
pub fn of<R: Real>(label: &str) -> Vec<(String, Hash)> {
    let mut found = Vec::new();
    let mut add = |name: &str, hash: Hash| found.push((format!("{label}.{name}"), hash));
    add("driven.advance", stepped::<_, R, 5, 5>(Driven::<R>::default(), |_, _| {}));
    add(
        "driven.parameters",
        stepped::<_, R, 5, 5>(Driven::<R>::default(), |mechanism, t| mechanism.omega = R::constant(10.0) + t),
    );
    let theta = |t: R| {
        let (rate, start) = (R::constant(4.0), R::constant(0.4));
        Signal { value: start + rate * t, rate, acceleration: R::constant(0.0) }
    };
    add(
        "measured.advance",
        stepped::<_, R, 4, 4>(Measured { theta: theta(R::constant(0.0)) }, |mechanism, t| {
            mechanism.theta = theta(t)
        }),
    );
    add("redundant.advance", stepped::<_, R, 4, 5>(Redundant::<R>::default(), |_, _| {}));
    add("block.advance", stepped::<_, R, 6, 6>(Block::<R>::default(), |_, _| {}));
    add("driven.bounded", bounded::<_, R, 5>(Driven::<R>::default()));
    add("block.bounded", bounded::<_, R, 6>(Block::<R>::default()));
    add("driven.lanes", lanes::<R>());
    add("pump.inverse", inverted::<R>());
    add("resting", at_rest::<R>());
    methods!(found, label, "falling", Falling::<R>::default());
    methods!(found, label, "slider", Slider::<R>::default());
    found
}

/// Four phases of a turn in the lanes of one batch.
fn lanes<R: Real>() -> Hash {
    let mut hash = Hash::new();
    let mechanism = Driven::<Lanes<R, 4>>::default();
    let start = [0.0, 0.01, 0.02, 0.03].map(R::constant);
    let single = Driven::<R>::default();
    let guess = [single.guess(&single.parameters()); 4];
    let mut batch = Batch::assemble(mechanism, &guess, start).expect("it assembles");
    for index in 0..200_usize {
        let time = start.map(|start| start + R::constant(0.003 * (index + 1) as f64));
        for outcome in batch.advance_to(time) {
            hash.outcome(index, &outcome);
        }
        for lane in batch.q().iter().chain(batch.qd()).chain(batch.qdd()) {
            hash.numbers(&lane.0);
        }
    }
    hash
}

/// Inverse dynamics over a turn.
fn inverted<R: Real>() -> Hash {
    let mut hash = Hash::new();
    let pump = Pump::<R>::default();
    let guess = pump.guess(&pump.parameters());
    let mut motion = Stepper::assemble(pump, guess, R::constant(0.0)).expect("it assembles");
    for index in 0..100_usize {
        hash.outcome(index, &motion.advance(R::constant(0.0007)));
        match inverse(&pump, motion.t(), motion.q()) {
            Ok(driven) => {
                hash.numbers(&driven.lambda);
                hash.numbers(driven.loads.as_ref());
            }
            Err(_) => hash.refuse(index),
        }
    }
    hash
}

/// A position of rest, and the small motions about it.
fn at_rest<R: Real>() -> Hash {
    let mut hash = Hash::new();
    let mechanism = Resting::<R>::default();
    let guess = mechanism.guess(&mechanism.parameters());
    let zero = R::constant(0.0);
    let Ok(rest) = equilibrium(&mechanism, zero, &guess) else {
        hash.refuse(0);
        return hash;
    };
    hash.numbers(&rest.q);
    hash.numbers(&rest.lambda);
    match linearize(&mechanism, zero, (&rest.q, &[zero; 3], &[zero; 3]), &rest.lambda) {
        Ok(small) => [&small.mass, &small.damping, &small.stiffness]
            .map(|matrix| matrix.iter().for_each(|row| hash.numbers(row))),
        Err(_) => {
            hash.refuse(1);
            [(); 3]
        }
    };
    hash
}

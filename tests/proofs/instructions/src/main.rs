//! Evaluations and steps of emitted code, for counting their instructions.
//!
//! ```text
//! proof-instructions WORK REPETITIONS
//! ```
//!
//! `cargo xtask instructions` runs each work twice and takes the difference, so that start and end of the program do not count.
//! Without arguments the names of the works are printed.

#[macro_use]
#[path = "../../peers/src/texts.rs"]
mod texts;

#[path = "../../peers/src/released.rs"]
mod released;

use std::hint::black_box;
use std::process::ExitCode;

use mbs_runtime::dynamics::{Counts, Formulation, IntegratorState, Metric, Model, VelocityTransformation};
use mbs_runtime::{
    Batch, Dynamic, Kinematic, Lanes, Mechanism, Partitioned, Scalar, Signal, Stepper, mechanism,
};
use released::{NFourBar10, NFourBar40, Squeezer};
use texts::{AdjustableFourBar, Andrews, Chain10, Chain40, CommandedFourBar, FourBar};

chain! {
    /// One loop.
    Chain1, 1
}
chain! {
    /// As many blocks as are straight-line code.
    Chain47, 47
}
chain! {
    /// One more: each step goes through its blocks in a loop.
    Chain48, 48
}
chain! {
    /// A hundred loops.
    Chain100, 100
}
chain! {
    /// As many as the language is tested with.
    Chain200, 200
}

mechanism! {
    /// A six-bar driven off its loop: four angles are one block.
    pub mechanism SixBar;
    const d: m = 0.30;
    const La: m = 0.25;
    const Lb: m = 0.15;
    const Ld: m = 0.25;
    const r: m = 0.05;
    const l: m = 0.30;
    coord theta: rad = 0;
    coord alpha: rad = 1.1;
    coord beta: rad = 0.16;
    coord gamma: rad = 1.7;
    coord delta: rad = 0;
    let a = La*unit(alpha);
    constraint four_bar { a + Lb*unit(beta) == [d, 0] + Ld*unit(gamma); }
    constraint rod { [-150mm, 160mm] + r*unit(theta) + l*unit(delta) == a + rot(beta)*[75mm, -80mm]; }
    drive crank: theta == TAU*t/1s;
    branch open: sin(gamma - beta) > 0;
}

mechanism! {
    /// Jansen's leg: five dyads in natural coordinates, lengths as parameters.
    pub mechanism Leg;
    param m: m = 15mm;
    param bars: [m; 10] = [50mm, 41.5mm, 61.9mm, 39.3mm, 55.8mm, 40.1mm, 39.4mm, 36.7mm, 65.7mm, 49mm];
    coord theta: rad = 0;
    coord top: [m; 2] = [-19mm, 29mm];
    coord knee: [m; 2] = [-31mm, -46mm];
    coord rear: [m; 2] = [-68mm, 20mm];
    coord heel: [m; 2] = [-66mm, -37mm];
    coord foot: [m; 2] = [-53mm, -90mm];
    let crank = m*unit(theta);
    let pivot = [-38mm, -7.8mm];
    constraint upper {
        dot(top - crank, top - crank) == bars[0]^2;
        dot(top - pivot, top - pivot) == bars[1]^2;
    }
    constraint lower {
        dot(knee - crank, knee - crank) == bars[2]^2;
        dot(knee - pivot, knee - pivot) == bars[3]^2;
    }
    constraint shoulder {
        dot(rear - top, rear - top) == bars[4]^2;
        dot(rear - pivot, rear - pivot) == bars[5]^2;
    }
    constraint parallel {
        dot(heel - rear, heel - rear) == bars[6]^2;
        dot(heel - knee, heel - knee) == bars[7]^2;
    }
    constraint shank {
        dot(foot - heel, foot - heel) == bars[8]^2;
        dot(foot - knee, foot - knee) == bars[9]^2;
    }
    drive turn: theta == -TAU*t/1s;
}

/// Time of a step (s).
const STEP: f64 = 1e-3;

/// Time of a step (s) so long that its prediction must be corrected twice.
const LONG_STEP: f64 = 1.0 / 360.0;

const LANES: usize = 8;

/// A work by name, done so many times.
type Work = (&'static str, fn(u32));

const WORKS: [Work; 23] = [
    ("evaluate_four_bar", evaluate::<FourBar, 5>),
    ("evaluate_andrews", evaluate::<Andrews, 7>),
    ("evaluate_chain", evaluate::<Chain10, 22>),
    ("evaluate_four_bar_in_8_lanes", evaluate_lanes),
    ("step_four_bar", |count| steps(FourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8], count)),
    ("step_four_bar_in_8_lanes", |count| batch(FourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8], count)),
    ("step_four_bar_with_inputs", commanded_steps),
    ("step_four_bar_with_inputs_in_8_lanes", commanded_batch),
    ("step_four_bar_with_parameters", |count| {
        steps(AdjustableFourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8], count);
    }),
    ("step_six_bar", |count| steps(SixBar::default(), [0.0, 1.1, 0.16, 1.7, 0.0], count)),
    ("step_leg", |count| steps(Leg::default(), LEG, count)),
    ("long_step_leg", |count| steps_of(LONG_STEP, Leg::default(), LEG, count)),
    ("step_chain_of_1", |count| steps(Chain1::default(), upright(), count)),
    ("step_chain_of_10", |count| steps(Chain10::default(), upright(), count)),
    ("step_chain_of_10_in_8_lanes", |count| batch(Chain10::default(), upright(), count)),
    ("step_chain_of_40", |count| steps(Chain40::default(), upright(), count)),
    ("step_chain_of_47", |count| steps(Chain47::default(), upright(), count)),
    ("step_chain_of_48", |count| steps(Chain48::default(), upright(), count)),
    ("step_chain_of_100", |count| steps(Chain100::default(), upright(), count)),
    ("step_chain_of_200", |count| steps(Chain200::default(), upright(), count)),
    ("rates_andrews", |count| rates::<Squeezer, 7, 6>(SQUEEZER, count)),
    ("rates_10_hanging_loops", |count| rates::<NFourBar10, 22, 21>(hanging(), count)),
    ("rates_40_hanging_loops", |count| rates::<NFourBar40, 82, 81>(hanging(), count)),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [work, count] = &arguments[..] else {
        WORKS.iter().for_each(|(name, _)| println!("{name}"));
        return ExitCode::SUCCESS;
    };
    match (WORKS.iter().find(|(name, _)| name == work), count.parse()) {
        (Some((_, run)), Ok(count)) => run(count),
        _ => return ExitCode::FAILURE,
    }
    ExitCode::SUCCESS
}

/// Jansen's leg at the start (rad, m).
const LEG: [f64; 11] = [0.0, -0.019, 0.029, -0.031, -0.046, -0.068, 0.02, -0.066, -0.037, -0.053, -0.09];

/// Uprights upright.
fn upright<const N: usize>() -> [f64; N] {
    std::array::from_fn(|k| (k % 2) as f64)
}

fn evaluate<S: Mechanism<f64, N, N> + Default, const N: usize>(count: u32) {
    let (mechanism, q, qd) = (S::default(), [0.3; N], [0.7; N]);
    let parameters = mechanism.parameters();
    for k in 0..count {
        let t = f64::from(k) * STEP;
        black_box(mechanism.evaluate(black_box(&parameters), black_box(&q), t, black_box(&qd)));
    }
}

fn evaluate_lanes(count: u32) {
    let mechanism = FourBar::<Lanes<f64, LANES>>::default();
    let (q, qd) = ([Lanes([0.3; LANES]); 5], [Lanes([0.7; LANES]); 5]);
    let parameters = mechanism.parameters();
    for k in 0..count {
        let t = Lanes([f64::from(k) * STEP; LANES]);
        black_box(mechanism.evaluate(black_box(&parameters), black_box(&q), t, black_box(&qd)));
    }
}

fn steps<S: Kinematic<f64, N>, const N: usize>(mechanism: S, guess: [f64; N], count: u32) {
    steps_of(STEP, mechanism, guess, count);
}

/// Steps of `h` (s).
#[inline(always)]
fn steps_of<S: Kinematic<f64, N>, const N: usize>(h: f64, mechanism: S, guess: [f64; N], count: u32) {
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("it can be assembled");
    for k in 1..=count {
        stepper.advance_to(f64::from(k) * h).expect("the mechanism is regular");
    }
    black_box(stepper.q());
}

/// Steps of a mechanism whose input is set before each.
fn commanded_steps(count: u32) {
    let assembled = Stepper::assemble(CommandedFourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8], 0.0);
    let mut stepper = assembled.expect("it can be assembled");
    for k in 1..=count {
        let t = f64::from(k) * STEP;
        stepper.change(|four_bar| four_bar.angle = angle(t));
        stepper.advance_to(t).expect("the mechanism is regular");
    }
    black_box(stepper.q());
}

/// The same in lanes.
fn commanded_batch(count: u32) {
    let guess = [[0.0, 0.0, 0.0, 0.9, 1.8]; LANES];
    let assembled = Batch::assemble(CommandedFourBar::default(), &guess, [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("it can be assembled");
    for k in 1..=count {
        let t = [f64::from(k) * STEP; LANES];
        batch.change(|four_bar| four_bar.angle = angle(Lanes(t)));
        assert!(batch.advance_to(t).iter().all(Result::is_ok), "the mechanism is regular");
    }
    black_box(batch.q());
}

/// Commanded angle of the crank at time `t` (s): it turns once a second.
fn angle<T: Scalar>(t: T) -> Signal<T> {
    let rate = T::constant(std::f64::consts::TAU);
    Signal { value: rate * t, rate, acceleration: T::constant(0.0) }
}

/// Start of Andrews' mechanism (rad).
const SQUEEZER: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_37,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_56,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];

/// Uprights that hang, 30° off the vertical.
fn hanging<const N: usize>() -> [f64; N] {
    let (sine, cosine) = std::f64::consts::FRAC_PI_6.sin_cos();
    std::array::from_fn(|k| if k % 2 == 0 { (k / 2) as f64 + sine } else { -cosine })
}

/// Accelerations and multipliers of a mechanism that moves by its forces.
fn rates<S, const N: usize, const M: usize>(q: [f64; N], count: u32)
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default,
{
    let mechanism = S::default();
    let parameters = mechanism.parameters();
    let metric = Metric::of(&mechanism, &parameters);
    let model = Model::of_states(&mechanism, &parameters, &metric);
    let mut counts = Counts::default();
    let y = IntegratorState { q, qd: [0.7; N], states: mechanism.start_states(&parameters), work: 0.0 };
    for _ in 0..count {
        let solved = VelocityTransformation.solve(&model, 0.0, black_box(&y), &[0.0; M], &mut counts);
        black_box(solved.expect("the mechanism is regular"));
    }
}

fn batch<S, const N: usize>(mechanism: S, guess: [f64; N], count: u32)
where
    S: Kinematic<Lanes<f64, LANES>, N>,
    S::Lane: Kinematic<f64, N>,
{
    let assembled = Batch::assemble(mechanism, &[guess; LANES], [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("it can be assembled");
    for k in 1..=count {
        let steps = batch.advance_to([f64::from(k) * STEP; LANES]);
        assert!(steps.iter().all(Result::is_ok), "the mechanism is regular");
    }
    black_box(batch.q());
}

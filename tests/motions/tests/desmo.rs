//! The rigid desmodromic valvetrain against a program in C that shares no code with the library, `desmo/valvetrain.c`.
//!
//! The gap is the same, (r − R)/√(1 + (R′/r)²). `data/desmo.csv` has its results, and names the command that writes them.
#![forbid(unsafe_code)]

use core::f64::consts::{PI, TAU};

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance};
use mbs_runtime::mechanism;
use mbs_workbench::cams::follower::Direction;
use mechanisms::desmo::design::Curve;
use mechanisms::desmo::{Design, DesmoFriction};

type Method = Explicit<DormandPrince8, Projection>;
type Fixed = Explicit<RungeKutta4, Projection>;
type Valvetrain = DesmoFriction<Curve>;

/// Names of the quantities of a peak in the reference.
const QUANTITIES: [&str; 6] = ["valve", "nose", "tip", "seat", "heel", "fork"];

/// Lines of the reference that begin with these words, less the words.
fn reference(words: &str) -> Vec<Vec<f64>> {
    let lines = include_str!("../data/desmo.csv").lines().filter_map(|line| line.strip_prefix(words));
    lines.map(|line| line.split(',').map(|word| word.parse().expect("a number")).collect()).collect()
}

fn rpm(speed: f64) -> f64 {
    speed * PI / 30.0
}

/// The ready valvetrain at `speed` (1/min) with its play or none, without friction where `is_smooth`.
fn valvetrain(speed: f64, has_play: bool, is_smooth: bool) -> Valvetrain {
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    let mut valvetrain: Valvetrain = design.mechanism().expect("a pair of cams").scene();
    valvetrain.speed = rpm(speed);
    (valvetrain.open_play, valvetrain.close_play) = if has_play { (1e-4, 3e-5) } else { (0.0, 0.0) };
    if is_smooth {
        (valvetrain.drag, valvetrain.dry) = (0.0, 0.0);
    }
    valvetrain
}

fn started(valvetrain: Valvetrain, tolerance: f64) -> Simulation<Valvetrain, Method, f64, 4, 1> {
    let run = Simulation::start_from_text(valvetrain, Method::default(), 0.0).expect("it starts");
    run.with_tolerance(Tolerance::new(tolerance))
}

/// Largest magnitudes to `until` (s) of the valve's acceleration and of all forces, at eight parts of each step.
fn peaks(run: &mut Simulation<Valvetrain, Method, f64, 4, 1>, until: f64) -> [f64; 6] {
    let mut peaks = [0.0_f64; 6];
    run.watch_steps(until, 8, |run| {
        let outputs = run.outputs();
        let forces = outputs.as_ref().iter().map(|output| output.value);
        let values = core::iter::once(run.qdd()[2].abs()).chain(forces);
        peaks.iter_mut().zip(values).for_each(|(peak, value)| *peak = peak.max(value));
    })
    .expect("it moves");
    peaks
}

fn apart(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Lifts within `bound` (m) of the reference, and largest values within 1e-4 of them.
fn assert_agrees(case: &str, valvetrain: Valvetrain, turns: f64, bound: f64) {
    let until = turns * TAU / valvetrain.speed;
    let mut run = started(valvetrain, 1e-11);
    let (peaks, mut lifts) = (peaks(&mut run.clone(), until), Vec::new());
    run.watch(until, 72, |run| lifts.push(run.q()[2])).expect("it moves");
    let lift = apart(&lifts, &reference(&format!("lift,{case},"))[0]);
    println!("desmo, {case}: lift {lift:.1e} m of {bound:.0e}");
    assert!(lift < bound, "{lift:e}");
    let expected = &reference(&format!("peak,{case},"))[0];
    for ((name, found), expected) in QUANTITIES.into_iter().zip(peaks).zip(expected) {
        println!("  {name}: {found:.3}, {:.1e} of 1e-4", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
}

#[test]
fn without_play_the_valve_moves_as_in_an_independent_program() {
    assert_agrees("5000 fitted", valvetrain(5000.0, false, true), 1.0, 1e-9);
    assert_agrees("9000 fitted", valvetrain(9000.0, false, true), 1.0, 1e-9);
}

#[test]
fn with_play_and_friction_the_impacts_are_those_of_an_independent_program() {
    // The valve is opened, and the closer has caught it: to full lift and 20° on. Then the whole turn.
    assert_agrees("9000 play", valvetrain(9000.0, true, false), 200.0 / 360.0, 1e-8);
    assert_agrees("9000 turn", valvetrain(9000.0, true, false), 1.0, 1e-8);
}

/// Value below which a share of the sorted values lies, between two of them by a line.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[test]
fn peaks_of_perturbed_runs_are_distributed_as_in_an_independent_program() {
    let expected = reference("run,");
    assert_eq!(expected.len(), 96);
    let mut found: Vec<[f64; 6]> = Vec::new();
    for run in expected.chunks(3) {
        let [turn, stiffness, damping, play, ..] = run[0][..] else { panic!("a short line") };
        assert_eq!(turn, 3.0);
        let mut valvetrain = valvetrain(9000.0, true, false);
        valvetrain.stiffness *= stiffness;
        valvetrain.damping *= damping;
        valvetrain.open_play *= play;
        valvetrain.close_play *= play;
        let turn = TAU / valvetrain.speed;
        // The tolerance of the study's envelope.
        let mut run = started(valvetrain, 1e-9);
        run.advance_to(2.0 * turn).expect("it moves");
        found.extend([3.0, 4.0, 5.0].map(|end| peaks(&mut run, end * turn)));
    }
    for (index, name) in QUANTITIES.into_iter().enumerate() {
        let found: Vec<f64> = found.iter().map(|peaks| peaks[index]).collect();
        let expected: Vec<f64> = expected.iter().map(|line| line[4 + index]).collect();
        let quantiles = [0.05, 0.5, 0.95].map(|share| [quantile(&found, share), quantile(&expected, share)]);
        let apart = quantiles.map(|[found, expected]| found / expected - 1.0);
        let most = apart.iter().fold(0.0_f64, |most, apart| most.max(apart.abs()));
        println!("desmo, turns 3 to 5 of 32 runs, {name}: {quantiles:.1?}, {most:.1e} of 2e-2");
        assert!(apart.iter().all(|apart| apart.abs() < 0.02), "{apart:?}");
    }
}

/// Steps of fixed size where contacts close or open.
#[derive(Clone, Copy, Debug)]
enum Steps {
    Plain,
    Located,
    Graded(f64),
}

/// Lifts at 72 places of a turn in as many times `steps` equal steps.
fn in_equal_steps(valvetrain: Valvetrain, steps: u32, contacts: Steps) -> Vec<f64> {
    let turn = TAU / valvetrain.speed;
    let run = Simulation::start_from_text(valvetrain, Fixed::default(), 0.0).expect("it starts");
    let mut run = match contacts {
        Steps::Plain => run.without_located_contacts(),
        Steps::Located => run,
        Steps::Graded(span) => run.with_graded_steps(span).expect("a span"),
    };
    (1..=72)
        .map(|leg| {
            run.step_to(turn * f64::from(leg) / 72.0, steps).expect("it moves");
            run.q()[2]
        })
        .collect()
}

/// Time (s) beside a touch in which steps are graded: that of a contact. Ten times as much makes parts a third as long.
const SPAN: f64 = 5e-5;

#[test]
fn plain_steps_of_3_3_microseconds_are_exact_to_3_5e_7_and_graded_ones_to_1e_8() {
    // With the guide's friction, and without.
    for (case, is_smooth, contacts, bound) in [
        ("9000 turn", false, Steps::Plain, 3.5e-7),
        ("9000 turn", false, Steps::Located, 3.5e-7),
        ("9000 turn", false, Steps::Graded(10.0 * SPAN), 1e-8),
        ("9000 smooth", true, Steps::Plain, 3.5e-7),
        ("9000 smooth", true, Steps::Located, 3.5e-7),
        ("9000 smooth", true, Steps::Graded(10.0 * SPAN), 1e-8),
    ] {
        // 2016 steps a turn of 6.67 ms.
        let lifts = in_equal_steps(valvetrain(9000.0, true, is_smooth), 28, contacts);
        let error = apart(&lifts, &reference(&format!("lift,{case},"))[0]);
        println!("desmo, {case}, RK4 at 3.3 µs, {contacts:?}: lift {error:.1e} m of {bound:.1e}");
        assert!(error < bound, "{error:e}");
    }
}

/// A follower that jumps off its cam and falls back, between the cam and a stop.
macro_rules! follower {
    ($name:ident, $stiffness:literal, $exponent:literal) => {
        mechanism! {
            pub mechanism $name;
            param speed: rad/s = 9000rpm;
            coord theta: rad = 0;
            coord s: m = 0;
            drive shaft: theta == speed*t;
            body follower { mass: 28gram, com: [0, s] }
            tsda spring { from: [0, 60mm], to: [0, s], stiffness: 35000, length: 70mm }
            contact face {
                gap: s - 2mm*(1 - cos(theta)) + 0.1mm,
                stiffness: $stiffness,
                exponent: $exponent,
                depth: 1m,
                damping: 0.5
            }
            contact stop { gap: 5mm - s, stiffness: $stiffness, exponent: $exponent, depth: 1m, damping: 0.5 }
            start s = -0.1mm rate 0;
        }
    };
}

follower!(Linear, 1.6e8, 1);
follower!(Hertz, 5e10, 1.5);

/// Largest error of `lift` at 72 places of a turn, with `steps` equal steps between them; the reference is adaptive.
macro_rules! errors_of {
    ($follower:ident, $span:expr) => {{
        let turn = TAU / rpm(9000.0);
        let adaptive = Simulation::start_from_text($follower::default(), Method::default(), 0.0);
        let mut exact = adaptive.expect("it starts").with_tolerance(Tolerance::new(1e-13));
        let mut expected = Vec::new();
        exact.watch(turn, 72, |run| expected.push(run.q()[1])).expect("it moves");
        [28, 56, 112].map(|steps| {
            let run = Simulation::start_from_text($follower::default(), Fixed::default(), 0.0);
            let mut run = run.expect("it starts").with_graded_steps($span).expect("a span");
            let mut error = 0.0_f64;
            for (leg, expected) in (1..).zip(&expected) {
                run.step_to(turn * f64::from(leg) / 72.0, steps).expect("it moves");
                error = error.max((run.q()[1] - expected).abs());
            }
            error
        })
    }};
}

#[test]
fn graded_steps_across_impacts_keep_order_4() {
    for (name, errors) in [("n = 1", errors_of!(Linear, SPAN)), ("n = 1.5", errors_of!(Hertz, SPAN))] {
        let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        let [one, half, quarter] = errors;
        println!(
            "{name}: {one:.1e}, {half:.1e}, {quarter:.1e} m at 3.3, 1.7 and 0.8 µs, orders {orders:.2?} of 3.5"
        );
        assert!(orders.iter().all(|order| 3.5 <= *order), "{orders:?}");
    }
}

#[test]
fn the_cams_work_is_the_change_of_energy_and_what_contacts_and_guide_take() {
    for (speed, has_play) in [(9000.0, true), (5000.0, false)] {
        let mut run = started(valvetrain(speed, has_play, false), 1e-11);
        let energy = |energy: mbs_runtime::Energy<f64>| energy.kinetic + energy.potential;
        let before = energy(run.balance().energy);
        let (mut most, mut defect) = (0.0_f64, 0.0_f64);
        run.watch(TAU / rpm(speed), 360, |run| {
            let loads = run.loads();
            let [torque, work, taken] = [0, 1, 2].map(|index| loads.as_ref()[index]);
            most = most.max(work.abs());
            defect = defect.max((work - (energy(run.balance().energy) - before) - taken).abs());
            // The torque that the drive needs is that of the forces on both cams.
            assert!(torque.is_finite());
        })
        .expect("it moves");
        println!("desmo, {speed}/min: work of the cam {most:.4} J, defect {:.1e} of 1e-9", defect / most);
        assert!(most > 0.1 && defect < 1e-9 * most, "{defect:e} of {most}");
    }
}

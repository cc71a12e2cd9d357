//! The advice of `mbs cost`: the setting that is advised reaches the error it promises for perturbed parameters too, and its Rust compiles
//! as it is printed.
#![forbid(unsafe_code)]

#[rustfmt::skip]
#[path = "advice/printed.rs"]
mod printed;

use std::fmt::Write;
use std::time::Duration;
use std::{env, fs};

use mbs_runtime::Mechanism;
use mbs_workbench::comparable;
use mbs_workbench::cost::advice::rust;
use mbs_workbench::cost::moved::{Extent, moved_study};
use mbs_workbench::cost::perturbed::perturb;
use mbs_workbench::cost::points::cheapest;
use mbs_workbench::cost::reference::{Leg, reference};
use mbs_workbench::erased::costs::{Comparable, MovedCosts};
use mbs_workbench::setting::{FormulationName, IntegratorName, MotionMethod, Numbers, Resolution, Setting};

use mechanisms::andrews::Andrews;
use mechanisms::car_axis::CarAxis;
use mechanisms::cart_pole::CartPole;
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::four_bar_mass::FourBarMassReleased;
use mechanisms::heavy_top::HeavyTop;
use mechanisms::n_four_bar_1::NFourBar1;
use mechanisms::pendulum::Pendulum;
use mechanisms::quarter_car::QuarterCar;
use mechanisms::slider_crank_mass::CrankPistonReleased;

/// A mechanism in all numbers, with parameters by their indices.
type Make = fn(&[(usize, f64)]) -> Comparable;

/// A mechanism in all numbers, and the values of its parameters and inputs.
type Study = (Make, fn() -> Vec<f64>);

fn values<S: Mechanism<f64, N, M>, const N: usize, const M: usize>(mechanism: &S) -> Vec<f64> {
    (0..S::VARIABLES.len()).map(|index| mechanism.get(index).unwrap_or_default()).collect()
}

macro_rules! study {
    ($make:expr) => {
        (comparable!($make), || values(&$make))
    };
}

/// Perturbed starts of each mechanism.
const STARTS: u32 = 20;

/// Largest change of a parameter, over its value.
const CHANGE: f64 = 0.05;

/// Largest error over the one that was promised for the mechanism as it is written.
const ALLOWED: f64 = 2.0;

/// Instants at which errors are taken.
const PARTS: u32 = 120;

/// A number in [−1, 1] for each start and parameter: the fractional parts of multiples of the golden ratio.
fn shaken(start: u32, index: usize) -> f64 {
    2.0 * (f64::from(start * 31 + 7 * index as u32 + 1) * 0.618_033_988_749_895).fract() - 1.0
}

fn moved(comparable: Comparable) -> Box<MovedCosts> {
    match comparable {
        Comparable::Moved(mechanism) => mechanism,
        _ => panic!("forces move it"),
    }
}

/// Largest error of the run with `setting` against a reference of the other kind; none where it does not start.
fn error(mechanism: &mut MovedCosts, setting: Setting, until: f64) -> Option<f64> {
    let Setting::Motion { numbers, method, resolution } = setting else { panic!("a motion from forces") };
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let runs = mechanism.runs.iter().find(|(own, _)| *own == numbers).map(|(_, runs)| runs)?;
    let double = mechanism.runs.iter().find(|(own, _)| own.name() == "f64").map(|(_, runs)| runs)?;
    let [q, qd] = double.start(0.0).ok()?;
    let leg = if method.is_implicit() { Leg::Extrapolated } else { Leg::Collocated };
    let budget = Duration::from_secs(60);
    let truth = reference(mechanism.exact.as_mut(), leg, (&q, &qd), &times, 1e-11, budget);
    assert!(truth.stuck.is_none(), "{:?}", truth.stuck);
    let scales = mechanism.exact.scales();
    let mut seen = Vec::new();
    runs.run(method, resolution, &times, Some(&mut |state| seen.push(state))).ok()?;
    assert!(seen.len() > 1);
    let stride = PARTS as usize / (seen.len() - 1);
    let pairs = seen.iter().zip(truth.shots.iter().step_by(stride.max(1)));
    let apart = pairs.flat_map(|(seen, shot)| {
        let coordinates = seen.q.iter().zip(&shot.at.q).zip(&scales);
        coordinates.map(|((q, exact), scale)| ((q - exact.high) - exact.low).abs() / scale)
    });
    Some(apart.fold(0.0, f64::max))
}

/// Of fixed steps and tolerances, by formulations that users take.
fn methods() -> Vec<MotionMethod> {
    use FormulationName::{Projection, VelocityTransformation};
    use IntegratorName::{DormandPrince5, DormandPrince8, Radau5, RungeKutta4};
    let pair = |formulation, integrator| MotionMethod::Explicit(formulation, integrator);
    vec![
        pair(Projection, DormandPrince8),
        pair(Projection, DormandPrince5),
        pair(Projection, RungeKutta4),
        pair(Projection, Radau5),
        pair(VelocityTransformation, DormandPrince8),
    ]
}

#[test]
fn the_advice_reaches_what_it_promises_for_perturbed_parameters() {
    let mechanisms: [(&str, Study, f64, f64); 10] = [
        ("pendulum", study!(Pendulum::default()), 2.0, 1e-6),
        ("double pendulum", study!(DoublePendulum::default()), 1.0, 1e-6),
        ("slider-crank", study!(CrankPistonReleased::default()), 0.5, 1e-7),
        ("four-bar with masses", study!(FourBarMassReleased::default()), 0.5, 1e-6),
        ("cart-pole", study!(CartPole::default()), 1.0, 1e-6),
        ("car axis", study!(CarAxis::default()), 0.5, 1e-6),
        ("quarter car", study!(QuarterCar::default()), 1.0, 1e-6),
        ("heavy top", study!(HeavyTop::default()), 0.5, 1e-5),
        ("one four-bar", study!(NFourBar1::default()), 1.0, 1e-8),
        ("Andrews", study!(Andrews::default()), 0.01, 1e-5),
    ];
    for (name, (make, values), until, asked) in mechanisms {
        let mut own = moved(make(&[]));
        let extent = Extent {
            methods: methods(),
            longest: 0.1,
            reference: 60.0,
            tolerance: 1e-12,
            watched: Vec::new(),
        };
        let mut found = moved_study(&mut own, until, &extent, &mut |_, _| ()).expect("references");
        let values = values();
        let given: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
        perturb(&mut found.points, make, &given, until, &extent);
        let chosen =
            cheapest(&found.points, asked).unwrap_or_else(|| panic!("{name}: nothing reaches {asked:e}"));
        let mut ratios = Vec::new();
        let mut start = 0;
        while ratios.len() < STARTS as usize {
            start += 1;
            assert!(start < 3 * STARTS, "{name}: perturbed mechanisms do not start");
            let perturbed: Vec<(usize, f64)> = values
                .iter()
                .enumerate()
                .map(|(index, value)| (index, value * (1.0 + CHANGE * shaken(start, index))))
                .collect();
            let Some(error) = error(&mut moved(make(&perturbed)), chosen.setting, until) else { continue };
            ratios.push(error / asked);
        }
        let worst = ratios.iter().copied().fold(0.0, f64::max);
        println!("{name}: {}: worst error over the asked {asked:e}: {worst:.2}", chosen.setting);
        assert!(worst <= ALLOWED, "{name}: {}: {ratios:?}", chosen.setting);
    }
}

/// The settings of all methods, for a pendulum of a second.
fn settings() -> Vec<Setting> {
    let mut settings = Vec::new();
    for numbers in [Numbers::Double, Numbers::Single] {
        for method in MotionMethod::all() {
            let resolution =
                if method.is_adaptive() { Resolution::Tolerance(1e-4) } else { Resolution::Steps(2000) };
            settings.push(Setting::Motion { numbers, method, resolution });
        }
    }
    settings
}

/// `advice/printed.rs` is what the program prints, so this test does not compile where that is no Rust.
/// `UPDATE_SNAPSHOTS=1` writes the file anew.
#[test]
fn the_rust_of_the_advice_compiles_as_it_is_printed_and_moves_the_pendulum() {
    let mut text = "//! Printed by `mbs cost pendulum --rust` for each method; written by a test.\n#![allow(clippy::all)]\n\n\
                    use mbs_runtime::Failure;\nuse mbs_runtime::dynamics::*;\nuse mechanisms::pendulum::Pendulum;\n"
        .to_string();
    let settings = settings();
    for (index, setting) in settings.iter().enumerate() {
        let body = rust(setting, "Pendulum::default()", 1.0);
        let body: String = body.lines().map(|line| format!("    {line}\n")).collect();
        let _ = write!(
            text,
            "\n/// {setting}.\npub fn run_{index}() -> Result<f64, Failure> {{\n{body}    Ok(f64::from(run.q()[1]))\n}}\n"
        );
    }
    let names: Vec<String> = (0..settings.len()).map(|index| format!("run_{index}")).collect();
    let _ = write!(
        text,
        "\n/// All of them.\npub const ALL: [fn() -> Result<f64, Failure>; {}] = [{}];\n",
        names.len(),
        names.join(", ")
    );
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/advice/printed.rs");
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(path, &text).expect("a file");
    }
    assert_eq!(fs::read_to_string(path).expect("a file"), text);
    let mut exact = moved(comparable!(Pendulum::default())(&[]));
    let start: [&[f64]; 2] = [&[-1.0, 0.0], &[0.0, 0.0]];
    let budget = Duration::from_secs(60);
    let truth =
        reference(exact.exact.as_mut(), Leg::Collocated, (start[0], start[1]), &[0.0, 1.0], 1e-12, budget);
    let truth = truth.shots.last().expect("an end").at.q[1].high;
    for (run, setting) in printed::ALL.iter().zip(&settings) {
        // Springs of a penalty are at the end of the digits of `f32`.
        let is_penalty = setting.curve().starts_with("Penalty") && setting.numbers() == Numbers::Single;
        match run() {
            Ok(found) => assert!((found - truth).abs() < 5e-2, "{setting}: {found} {truth}"),
            Err(failure) => assert!(is_penalty, "{setting}: {failure}"),
        }
    }
}

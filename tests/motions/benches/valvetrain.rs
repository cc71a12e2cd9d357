//! One turn of the desmodromic valvetrain at 9000/min to 1e-7 m, against C typed by hand, SciPy and Exudyn in one run.
//!
//! ```text
//! cargo bench -p mbs-motions --bench valvetrain
//! ```
//!
//! All have the same gap and a table of 720 points of each cam. Each method takes its loosest setting that is exact enough; then all
//! take turns. The table goes to `bench/valvetrain.md` below the target directory; with `-- --docs` also next to this file. C is
//! `tests/desmo/valvetrain.c`, Python is `valvetrain/peers.py`.
#![forbid(unsafe_code)]

use core::f64::consts::{PI, TAU};
use core::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use mbs_runtime::Function;
use mbs_runtime::driver::PeriodicQuintic;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Projection, RungeKutta4, Simulation, Tolerance,
};
use mbs_workbench::cams::follower::Direction;
use mbs_workbench::verify::environment::Environment;
use mechanisms::desmo::{Design, DesmoClearance};

/// Largest error of the lift (m).
const WANTED: f64 = 1e-7;
/// Places of a turn at which the lift is compared.
const LEGS: u32 = 72;
const KNOTS: usize = 720;
/// Turns of Rust or C of which the fastest counts.
const REPEATED: usize = 20;
const REQUIREMENTS: &str = "scipy==1.17.1\nnumpy==2.4.6\nexudyn==1.13.6\n";

type Table = &'static PeriodicQuintic<KNOTS>;
type Valvetrain = DesmoClearance<Table>;

/// A program with one of its methods.
#[derive(Clone, Copy)]
struct Method {
    program: &'static str,
    name: &'static str,
    /// Settings from loose to tight: tolerances, or steps a leg.
    settings: &'static [f64],
}

const TOLERANCES: &[f64] = &[1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9];
const STEPS: &[f64] =
    &[8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0, 36.0, 40.0, 48.0, 56.0];

const METHODS: [Method; 13] = [
    Method { program: "mbs", name: "RungeKutta4", settings: STEPS },
    Method { program: "mbs", name: "DormandPrince5", settings: TOLERANCES },
    Method { program: "mbs", name: "DormandPrince8", settings: TOLERANCES },
    Method { program: "located", name: "RungeKutta4", settings: STEPS },
    Method { program: "located", name: "DormandPrince5", settings: TOLERANCES },
    Method { program: "located", name: "DormandPrince8", settings: TOLERANCES },
    Method { program: "c", name: "rk4", settings: STEPS },
    Method { program: "c", name: "dp5", settings: TOLERANCES },
    Method { program: "c", name: "dp8", settings: TOLERANCES },
    Method { program: "scipy", name: "DOP853", settings: TOLERANCES },
    Method { program: "scipy", name: "LSODA", settings: TOLERANCES },
    Method { program: "exudyn", name: "RK44", settings: STEPS },
    Method { program: "exudyn", name: "DOPRI5", settings: TOLERANCES },
];

const PROGRAMS: [(&str, &str); 5] = [
    ("mbs", "**emitted**"),
    ("located", "**emitted**, contacts located"),
    ("c", "C by hand"),
    ("scipy", "SciPy"),
    ("exudyn", "Exudyn"),
];

/// Lifts (m) and processor times (ns) of a run.
struct Found {
    lifts: Vec<f64>,
    times: Vec<f64>,
}

struct Bench {
    tables: [Table; 2],
    c: PathBuf,
    python: PathBuf,
}

impl Bench {
    fn new() -> Result<Self, String> {
        let law = Design::law(0.011, 160_f64.to_radians()).map_err(|error| error.to_string())?;
        let design = Design::ready(law, Direction::CounterClockwise);
        let curves = design.curves().map_err(|error| error.to_string())?;
        let x: [f64; KNOTS] = core::array::from_fn(|k| TAU * k as f64 / KNOTS as f64);
        let table = |curve: &mechanisms::desmo::design::Curve| -> Result<Table, String> {
            let radii = x.map(|x| curve.jet::<1>(x)[0]);
            let table = PeriodicQuintic::interpolate(&x, TAU, &radii).map_err(|error| error.to_string())?;
            Ok(Box::leak(Box::new(table)))
        };
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let c = Path::new(env!("CARGO_TARGET_TMPDIR")).join("valvetrain");
        let source = root.join("tests/desmo/valvetrain.c");
        output(Command::new("cc").args(["-O3", "-o"]).arg(&c).arg(source).arg("-lm"))?;
        let environment = Environment::ready_for(REQUIREMENTS, &|step| eprintln!("{step}"));
        let python = environment.map_err(|error| error.to_string())?.python();
        Ok(Bench { tables: [table(&curves[0])?, table(&curves[1])?], c, python })
    }

    fn valvetrain(&self, play: u32) -> Result<Valvetrain, String> {
        let law = Design::law(0.011, 160_f64.to_radians()).map_err(|error| error.to_string())?;
        let design = Design::ready(law, Direction::CounterClockwise);
        let mut valvetrain: Valvetrain = design.moved_by(self.tables).scene();
        valvetrain.speed = 9000.0 * PI / 30.0;
        valvetrain.open_play = f64::from(play) * 1e-4;
        valvetrain.close_play = f64::from(play) * 3e-5;
        Ok(valvetrain)
    }

    fn run(&self, method: &Method, setting: f64, play: u32, rounds: usize) -> Result<Found, String> {
        let repeated = if method.program == "c" { REPEATED } else { rounds };
        let words = [method.name.to_string(), setting.to_string(), play.to_string(), repeated.to_string()];
        let text = match method.program {
            "mbs" | "located" => return self.emitted(method, setting, play, rounds),
            "c" => output(Command::new(&self.c).arg("turn").args(words))?,
            program => {
                let peers = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/valvetrain/peers.py");
                output(Command::new(&self.python).arg(peers).arg(program).args(words))?
            }
        };
        let lines: Vec<&str> =
            text.lines().filter(|line| line.contains(',') || !line.contains(' ')).collect();
        let numbers = |line: Option<&&str>| -> Result<Vec<f64>, String> {
            let words = line.ok_or("a peer printed too little")?.split(',');
            words.map(|word| word.parse().map_err(|_| format!("a peer printed {word}"))).collect()
        };
        let mut times = numbers(lines.get(1))?;
        if method.program == "c" {
            times = vec![times.iter().copied().fold(f64::INFINITY, f64::min)];
        }
        Ok(Found { lifts: numbers(lines.first())?, times })
    }

    fn emitted(&self, method: &Method, setting: f64, play: u32, rounds: usize) -> Result<Found, String> {
        let valvetrain = self.valvetrain(play)?;
        let timed = |turn: &dyn Fn() -> Result<Vec<f64>, mbs_runtime::Failure>| {
            let mut found = Found { lifts: Vec::new(), times: Vec::new() };
            for _ in 0..rounds {
                // The least of some turns: what else runs only lengthens one, and the first one warms up.
                let mut least = f64::INFINITY;
                for _ in 0..REPEATED {
                    let begun = Instant::now();
                    found.lifts = turn().map_err(|failure| failure.to_string())?;
                    least = least.min(begun.elapsed().as_nanos() as f64);
                }
                found.times.push(least);
            }
            Ok(found)
        };
        let locates = method.program == "located";
        match method.name {
            "RungeKutta4" => timed(&|| in_steps(&valvetrain, setting as u32, locates)),
            "DormandPrince5" => timed(&|| adaptive::<DormandPrince5>(&valvetrain, setting, locates)),
            _ => timed(&|| adaptive::<DormandPrince8>(&valvetrain, setting, locates)),
        }
    }
}

fn ends(valvetrain: &Valvetrain) -> impl Iterator<Item = f64> {
    let turn = TAU / valvetrain.speed;
    (1..=LEGS).map(move |leg| turn * f64::from(leg) / f64::from(LEGS))
}

fn in_steps(valvetrain: &Valvetrain, steps: u32, locates: bool) -> Result<Vec<f64>, mbs_runtime::Failure> {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let run = Simulation::start_from_text(*valvetrain, method, 0.0)?.without_work();
    let mut run = if locates { run } else { run.without_located_contacts() };
    let legs = ends(valvetrain).map(|until| run.step_to(until, steps).map(|()| run.q()[2]));
    legs.collect()
}

fn adaptive<I: Embedded + Default>(
    valvetrain: &Valvetrain,
    tolerance: f64,
    locates: bool,
) -> Result<Vec<f64>, mbs_runtime::Failure> {
    let method: Explicit<I, Projection> = Explicit::default();
    let run = Simulation::start_from_text(*valvetrain, method, 0.0)?.without_work();
    let run = if locates { run } else { run.without_located_contacts() };
    let mut run = run.with_tolerance(Tolerance::new(tolerance));
    let legs = ends(valvetrain).map(|until| run.advance_to(until).map(|()| run.q()[2]));
    legs.collect()
}

fn output(command: &mut Command) -> Result<String, String> {
    let made = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if made.status.success() {
        return Ok(String::from_utf8_lossy(&made.stdout).into_owned());
    }
    Err(format!("{command:?}: {}", String::from_utf8_lossy(&made.stderr)))
}

fn apart(found: &[f64], expected: &[f64]) -> f64 {
    if found.len() != expected.len() {
        return f64::INFINITY;
    }
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (values.len().saturating_sub(1) as f64 * share).round() as usize;
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// A method with its setting, error (m) and times (ns).
struct Timed {
    method: Method,
    setting: f64,
    error: f64,
    times: Vec<f64>,
}

/// All methods in turns, with the loosest setting of each that is exact enough.
fn measured(bench: &Bench, play: u32, rounds: usize) -> Result<Vec<Timed>, String> {
    let exact = bench.run(&Method { program: "c", name: "dp5", settings: &[] }, 1e-13, play, 1)?.lifts;
    let mut all = Vec::new();
    for method in METHODS {
        for setting in method.settings {
            // A tolerance at which a method gives up is none for it.
            let Ok(found) = bench.run(&method, *setting, play, 1) else { continue };
            let error = apart(&found.lifts, &exact);
            if error <= WANTED {
                eprintln!("{} {}: {setting}, {error:.1e} m", method.program, method.name);
                all.push(Timed { method, setting: *setting, error, times: Vec::new() });
                break;
            }
        }
    }
    for round in 0..rounds {
        for one in &mut all {
            // Python takes a hundred times as long: a third of the rounds are enough for it.
            if round % 3 == 0 || matches!(one.method.program, "mbs" | "located" | "c") {
                let found = bench.run(&one.method, one.setting, play, 1)?;
                one.times.extend(found.times);
            }
        }
    }
    Ok(all)
}

fn table(bench: &Bench, rounds: usize) -> Result<String, String> {
    let mut text = String::from(
        "| play | program, its fastest method | setting | ms | 10 … 90 % | time over emitted | error of the lift (m) |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for play in [0, 1] {
        let all = measured(bench, play, rounds)?;
        let mut own = f64::NAN;
        for (program, title) in PROGRAMS {
            let of_program = all.iter().filter(|one| one.method.program == program);
            let fastest = of_program
                .min_by(|a, b| quantile(a.times.clone(), 0.5).total_cmp(&quantile(b.times.clone(), 0.5)));
            let Some(Timed { method, setting, error, times }) = fastest else { continue };
            let [low, median, high] = [0.1, 0.5, 0.9].map(|share| 1e-6 * quantile(times.clone(), share));
            own = if program == "mbs" { median } else { own };
            let play = if play == 0 { "none" } else { "0.10, 0.03 mm" };
            let setting = if *setting < 1.0 {
                format!("tolerance {setting:.0e}")
            } else {
                format!("{} steps", *setting as u32 * LEGS)
            };
            let _ = writeln!(
                text,
                "| {play} | {title}, {} | {setting} | {median:.3} | {low:.3} … {high:.3} | {:.2} | {error:.1e} |",
                method.name,
                median / own
            );
        }
    }
    Ok(text)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    // `cargo test --benches` runs this program too, without the argument.
    if !arguments.iter().any(|argument| argument == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    let rounds = arguments.iter().skip_while(|argument| *argument != "--rounds").nth(1);
    let rounds = rounds.and_then(|rounds| rounds.parse().ok()).unwrap_or(21);
    let is_for_docs = arguments.iter().any(|argument| argument == "--docs");
    match Bench::new().and_then(|bench| table(&bench, rounds)).and_then(|table| write(&table, is_for_docs)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn write(table: &str, is_for_docs: bool) -> Result<(), String> {
    let text = format!(
        "# One turn of the valvetrain against its peers\n\n\
         `cargo bench -p mbs-motions --bench valvetrain -- --docs` writes this file. One turn at 9000/min from rest, without guide \
         friction, to {WANTED:.0e} m at {LEGS} places, which all runs end a step at. All programs have the same gap and the same points of \
         both cams' tables. The reference is C's order 5 at 1e-13. The first row goes over touches as the peers do; the second one ends its steps there. Of each program its fastest method is shown, with the loosest setting that \
         is exact enough, as the median of rounds in which all took turns; a round of Rust or C is the fastest of {REPEATED} turns. Rust is compiled with `opt-level = 3`, C by `cc -O3`, both for \
         the default target. SciPy's and Exudyn's forces are Python functions.\n\n{table}"
    );
    println!("{text}");
    let mut directories = vec![Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("bench")];
    if is_for_docs {
        directories.push(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/benches")));
    }
    for directory in directories {
        let file = directory.join("valvetrain.md");
        let written = fs::create_dir_all(&directory).and_then(|()| fs::write(&file, &text));
        written.map_err(|error| format!("cannot write {}: {error}", file.display()))?;
        println!("written to {}", file.display());
    }
    Ok(())
}

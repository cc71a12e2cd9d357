//! Other programs on the same motion, in child processes: SciPy, CVODES and IDAS on CasADi's equations, and multibody programs on a tree
//! of bodies. `mbs-workbench/peers` has their scripts and the form of a tree.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::cost::points::Errors;
use crate::verify::environment::Environment;

/// Scripts by name of file.
const FILES: [(&str, &str); 7] = [
    ("peers.py", include_str!("../../peers/peers.py")),
    ("equations.py", include_str!("../../peers/equations.py")),
    ("trees.py", include_str!("../../peers/trees.py")),
    ("trees_in_space.py", include_str!("../../peers/trees_in_space.py")),
    ("pinocchio_shim.py", include_str!("../../peers/pinocchio_shim.py")),
    ("pinocchio_shim.cpp", include_str!("../../peers/pinocchio_shim.cpp")),
    ("with_casadi.py", include_str!("../../oracle/with_casadi.py")),
];

/// Programs as the script knows them, as people know them, and what pip installs.
const PROGRAMS: [(&str, &str, &str); 5] = [
    ("equations", "SciPy, CVODES, IDAS", "casadi==3.8.2\nnumpy==2.4.6\nscipy==1.17.1\n"),
    ("mujoco", "MuJoCo", "mujoco==4.0.0\nnumpy==2.4.6\n"),
    ("exudyn", "Exudyn", "exudyn==1.13.6\nnumpy==2.4.6\n"),
    ("drake", "Drake", "drake==1.51.1\nnumpy==2.4.6\n"),
    ("pinocchio", "Pinocchio", "pin==4.1.0\ncmeel-eigen==3.4.1\nnumpy==2.4.6\n"),
];

/// Time (s) that a program may take to be compiled.
const COMPILING: f64 = 300.0;

/// Longest time of one program with all its settings, over the longest of one run.
const SETTINGS: f64 = 40.0;

/// The motion that the programs are asked for.
#[derive(Clone, Debug, Serialize)]
pub struct Question {
    /// Name of the mechanism's files.
    pub name: String,
    /// Instants (s), at equal distances from the start on.
    pub times: Vec<f64>,
    /// Coordinates at the start: N.
    pub q: Vec<f64>,
    /// Velocities at the start: N.
    pub qd: Vec<f64>,
    /// First-order states at the start.
    pub z: Vec<f64>,
    /// Parameters and inputs, component by component.
    pub v: Vec<f64>,
    /// The same by name.
    pub parameters: serde_json::Map<String, serde_json::Value>,
    /// Tolerances, as negative powers of ten.
    pub digits: Vec<u32>,
    /// Longest run (s).
    pub longest: f64,
}

/// A run of another program.
#[derive(Clone, Debug)]
pub struct PeerPoint {
    /// Program and method.
    pub program: String,
    /// Tolerance or steps.
    pub setting: String,
    /// Result, or the reason why there is none.
    pub outcome: Result<PeerRun, String>,
}

/// Result of a run of another program.
#[derive(Clone, Copy, Debug)]
pub struct PeerRun {
    /// True errors; what the program does not tell is NaN.
    pub errors: Errors,
    /// Time (µs) a second of the motion.
    pub time: f64,
    /// Right-hand sides evaluated or steps taken; 0 where the program does not tell.
    pub evaluations: u64,
}

/// A line of the script.
#[derive(Deserialize)]
#[serde(untagged)]
enum Answer {
    Progress {
        program: String,
        progress: String,
    },
    Refused {
        program: String,
        setting: String,
        refused: String,
    },
    Done {
        program: String,
        setting: String,
        seconds: f64,
        evaluations: u64,
        q: Vec<Vec<Option<f64>>>,
        qd: Option<Vec<Vec<Option<f64>>>>,
    },
}

/// Definition and tree of a mechanism, for the scripts.
pub struct Described {
    /// CasADi definition, or the reason why there is none.
    pub definition: Result<String, String>,
    /// File with the mechanism as a tree of bodies.
    pub tree: PathBuf,
}

/// Errors of coordinates and velocities at the instants of a question.
pub type Judge<'a> = &'a dyn Fn(&[Vec<f64>], Option<&[Vec<f64>]>) -> Errors;

/// Asks all programs. `judge` gives the errors of states at the instants (coordinates, velocities); `progress` gets what is being done.
pub fn ask_all(
    question: &Question,
    described: &Described,
    judge: Judge,
    progress: &dyn Fn(&str),
) -> Vec<PeerPoint> {
    let mut points = Vec::new();
    for (program, name, requirements) in PROGRAMS {
        progress(&format!("installing {name}"));
        let lost = |reason: String| PeerPoint {
            program: name.to_string(),
            setting: String::new(),
            outcome: Err(reason),
        };
        match (&described.definition, program) {
            (Err(reason), "equations") => {
                points.push(lost(format!("cannot: {reason}")));
                continue;
            }
            (_, "equations") => {}
            _ if !described.tree.is_file() => {
                let path = described.tree.display();
                points.push(lost(format!("cannot: no description as a tree of bodies ({path})")));
                continue;
            }
            _ => {}
        }
        match Environment::ready_for(requirements, &|_| ()) {
            Ok(environment) => {
                progress(name);
                ask(program, name, &environment, question, described, judge, progress, &mut points);
            }
            Err(error) => points.push(lost(format!("not installed: {error}"))),
        }
    }
    points
}

/// A directory that is removed with its owner.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[allow(clippy::too_many_arguments)]
fn ask(
    program: &str,
    name: &str,
    environment: &Environment,
    question: &Question,
    described: &Described,
    judge: Judge,
    progress: &dyn Fn(&str),
    points: &mut Vec<PeerPoint>,
) {
    let before = points.len();
    let mut hear = |answer: Answer| {
        let span = question.times.last().unwrap_or(&1.0) - question.times.first().unwrap_or(&0.0);
        let rows = |rows: Vec<Vec<Option<f64>>>| -> Vec<Vec<f64>> {
            rows.into_iter().map(|row| row.into_iter().map(|x| x.unwrap_or(f64::NAN)).collect()).collect()
        };
        match answer {
            Answer::Progress { program, progress: words } => progress(&format!("{program}: {words}")),
            Answer::Refused { program, setting, refused } => {
                points.push(PeerPoint { program, setting, outcome: Err(refused) });
            }
            Answer::Done { program, setting, seconds, evaluations, q, qd } => {
                let (q, qd) = (rows(q), qd.map(rows));
                let errors = judge(&q, qd.as_deref());
                progress(&program);
                let run = PeerRun { errors, time: seconds * 1e6 / span, evaluations };
                points.push(PeerPoint { program, setting, outcome: Ok(run) });
            }
        }
    };
    let ended = converse(program, environment, question, described, &mut hear);
    if let Err(reason) = ended {
        let setting = if points.len() == before { "" } else { "further settings" };
        points.push(PeerPoint {
            program: name.to_string(),
            setting: setting.to_string(),
            outcome: Err(reason),
        });
    }
}

/// Runs the script for one program.
fn converse(
    program: &str,
    environment: &Environment,
    question: &Question,
    described: &Described,
    hear: &mut dyn FnMut(Answer),
) -> Result<(), String> {
    let scratch = environment.directory().join(format!("peers-{}", std::process::id()));
    let written = |path: &Path, text: &str| {
        std::fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
    };
    std::fs::create_dir_all(&scratch)
        .map_err(|error| format!("cannot make {}: {error}", scratch.display()))?;
    let scratch = Scratch(scratch);
    for (name, text) in FILES {
        written(&scratch.0.join(name), text)?;
    }
    let definition = scratch.0.join("definition.py");
    written(&definition, described.definition.as_deref().unwrap_or_default())?;
    let mut told = serde_json::to_value(question).map_err(|error| error.to_string())?;
    if let Some(told) = told.as_object_mut() {
        told.insert("scratch".to_string(), scratch.0.display().to_string().into());
        told.insert("cache".to_string(), environment.directory().display().to_string().into());
    }
    let mut child = Command::new(environment.python())
        .arg("-B")
        .arg(scratch.0.join("peers.py"))
        .arg(program)
        .arg(scratch.0.join("with_casadi.py"))
        .arg(&definition)
        .arg(if described.tree.is_file() { described.tree.as_path() } else { Path::new("-") })
        // Times are those of one core, as ours are.
        .env("OMP_NUM_THREADS", "1")
        .env("OPENBLAS_NUM_THREADS", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("Python does not start: {error}"))?;
    let limit = Duration::from_secs_f64(SETTINGS * question.longest + COMPILING);
    listen(&mut child, told.to_string(), limit, hear)
}

/// Feeds the child, hears its lines and ends it at the limit.
fn listen(
    child: &mut Child,
    told: String,
    limit: Duration,
    hear: &mut dyn FnMut(Answer),
) -> Result<(), String> {
    let (Some(mut input), Some(output), Some(mut errors)) =
        (child.stdin.take(), child.stdout.take(), child.stderr.take())
    else {
        return Err("its channels are closed".to_string());
    };
    let (is_late, ended) = (AtomicBool::new(false), AtomicBool::new(false));
    let child = Mutex::new(child);
    let locked = || child.lock().unwrap_or_else(PoisonError::into_inner);
    let (status, words) = std::thread::scope(|scope| {
        // A child that ends without reading breaks the pipe; its own words are the better message.
        scope.spawn(move || input.write_all(told.as_bytes()));
        let words = scope.spawn(move || {
            let mut words = Vec::new();
            let _ = errors.read_to_end(&mut words);
            String::from_utf8_lossy(&words).into_owned()
        });
        scope.spawn(|| {
            let began = Instant::now();
            while !ended.load(Ordering::Relaxed) {
                if began.elapsed() > limit {
                    is_late.store(true, Ordering::Relaxed);
                    let _ = locked().kill();
                    return;
                }
                std::thread::sleep(Duration::from_millis(50));
            }
        });
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            let answer = line.strip_prefix('@').map(serde_json::from_str::<Answer>);
            if let Some(Ok(answer)) = answer {
                hear(answer);
            }
        }
        let status = locked().wait();
        ended.store(true, Ordering::Relaxed);
        (status, words.join().unwrap_or_default())
    });
    if is_late.load(Ordering::Relaxed) {
        return Err(format!("ended after {} s", limit.as_secs()));
    }
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => {
            let last = words.lines().rfind(|line| !line.trim().is_empty());
            Err(last.map_or_else(|| status.to_string(), |line| line.trim().to_string()))
        }
        Err(error) => Err(error.to_string()),
    }
}

//! Reports of all mechanisms in headless Chromium; `xtask/src/page.mjs` uses each page, `xtask/src/tools.mjs` each of its tools,
//! `xtask/src/cost.mjs` the page of `mbs cost`.

use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::thread;

use crate::shell::{command, install, need, output, root, step, target};

/// Library that controls the browser; it contains no browser itself.
const DRIVER: &str = "playwright-core@1.55.0";

/// Mechanisms at rest, which have modes in place of a motion.
const WITH_MODES: [&str; 3] = ["double_pendulum", "quarter_car", "governor"];

/// Mechanisms whose rests are judged: unstable ones with the stable ones that they fall to, and a stable one alone.
const WITH_RESTS: [&str; 3] = ["four_bar_mass:Released", "slider_crank_mass:Released", "pendulum"];

/// Driven mechanisms with masses, whose forces are plotted.
const WITH_FORCES: [&str; 2] = ["four_bar_mass:Driven", "slider_crank_mass:Driven"];

/// A crank longer than its rod: the motion ends, the command fails, and the page is written up to there.
const ENDED: [&str; 4] = ["kinematics", "slider_crank", "--param", "r=0.2"];

/// A study of what accuracy costs, short enough for a build without optimisation.
const COST: [&str; 7] = ["cost", "pendulum", "--quick", "--until", "0.3", "--methods", "projection"];

/// A parameter with a range that the page slides through.
const SLIDING: [&str; 6] = ["run", "slider_crank_engine", "--slide", "r=4", "--until", "0.02"];

/// Measured points that are drawn over a curve, one of them beyond the end of the motion.
const MEASURED: &str = "t (s), rocker (deg)\n0.1, 91\n0.25, 80\n0.5, 95\n0.75, 110\n1.5, 90\n";

/// Writes the report of each mechanism and opens it.
///
/// # Errors
/// A missing tool with its cure, a report that cannot be written, a page that fails.
pub fn run() -> Result<(), String> {
    install("chromium", "chromium")?;
    need("npm", "install Node.js 20 or newer")?;
    let scratch = target().join("browser");
    let written = |error: std::io::Error| format!("{}: {error}", scratch.display());
    fs::create_dir_all(&scratch).map_err(written)?;
    if !scratch.join("node_modules/playwright-core").is_dir() {
        let options = ["install", "--silent", "--no-save", "--no-audit", "--no-fund", "--prefix"];
        step(command("npm", &options).arg(&scratch).arg(DRIVER))?;
    }
    // The same build as for the tests of the whole workspace, where the program is built too.
    step(&mut command("cargo", &["test", "--quiet", "--workspace", "--test", "program", "--no-run"]))?;
    println!("\n== reports in a browser");
    let pages = reports(&target().join("debug/mbs-catalogue"), &scratch)?;
    // Next to node_modules, where Node looks for it.
    let page = scratch.join("page.mjs");
    for file in ["page.mjs", "tools.mjs", "cost.mjs"] {
        fs::copy(root().join("xtask/src").join(file), scratch.join(file)).map_err(written)?;
    }
    let chromium = output(&mut command("sh", &["-c", "command -v chromium"]))?;
    crate::shell::run(command("node", &[]).arg(page).arg(chromium.trim()).args(pages))
}

/// Reports of all mechanisms, two at a time; their pages.
fn reports(program: &Path, scratch: &Path) -> Result<Vec<String>, String> {
    let program = program.to_str().ok_or("the target directory is not UTF-8")?;
    let list = output(&mut command(program, &["list"]))?;
    let names = list.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_lowercase()));
    let names = names.filter_map(|line| line.split_whitespace().next());
    let mut wanted: Vec<(String, Vec<&str>)> =
        names.map(|name| (name.to_string(), [&["run"], &options(name)[..]].concat())).collect();
    let scenes = |name: &str| name.replace(':', "_");
    wanted.extend(WITH_MODES.map(|name| (format!("{name}-linear"), vec!["modes", name])));
    wanted.extend(WITH_RESTS.map(|name| (format!("{}-rest", scenes(name)), vec!["equilibrium", name])));
    wanted.extend(WITH_FORCES.map(|name| (format!("{}-inverse", scenes(name)), vec!["inverse", name])));
    wanted.push(("slider_crank-ended".to_string(), ENDED.to_vec()));
    let table = scratch.join("rocker.csv");
    fs::write(&table, MEASURED).map_err(|error| format!("{}: {error}", table.display()))?;
    let overlay = format!("phi3={}", table.display());
    wanted.push(("four_bar-overlaid".to_string(), vec!["run", "four_bar", "--overlay", &overlay]));
    wanted.push(("slider_crank_engine-sliding".to_string(), SLIDING.to_vec()));
    wanted.push(("pendulum-cost".to_string(), COST.to_vec()));
    let page = |options: &[&str]| if options == COST { "cost.html" } else { "report.html" };
    let pages = wanted
        .iter()
        .map(|(name, options)| format!("{}/{}", scratch.join(name).display(), page(options)))
        .collect();
    let queue = Mutex::new(wanted.iter());
    let worker = || {
        loop {
            let next = queue.lock().map_err(|_| "a report has failed")?.next();
            let Some((name, options)) = next else { return Ok::<(), String>(()) };
            let mut run = command(program, options);
            let written = output(run.arg("--out").arg(scratch.join(name)));
            if options[..] != ENDED[..] {
                written?;
            } else if written.is_ok() {
                return Err(format!("{}: a motion that ends early must fail", ENDED.join(" ")));
            }
        }
    };
    thread::scope(|scope| {
        let workers = [scope.spawn(worker), scope.spawn(worker)];
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().map_err(|_| "a report has failed".to_string())?)
    })?;
    Ok(pages)
}

/// Name and shorter motions of mechanisms whose debug build takes long.
fn options(name: &str) -> Vec<&str> {
    match name {
        // Matrices of 163 rows take a moment each where nothing is optimised.
        "n_four_bar_40" => vec![name, "--until", "0.1"],
        // Each of its forces has a run of its own for its work.
        "governor" => vec![name, "--until", "1"],
        _ => vec![name],
    }
}

//! Studies of `mbs cost` that take long: other programs on the pendulum, and the index of all mechanisms.

use std::fs;

use crate::shell::{command, root, step, target};

/// Programs that must reach [`REACHED`] on the pendulum.
const PROGRAMS: [&str; 8] =
    ["SciPy DOP853", "SciPy Radau", "CVODES", "IDAS", "MuJoCo", "Exudyn", "Drake", "Pinocchio"];

/// Error that each program reaches: their trees and equations are those of the pendulum.
const REACHED: f64 = 2e-3;

/// Other programs on the pendulum.
///
/// # Errors
/// A study that fails, or a program that does not come near the true motion.
pub fn peers() -> Result<(), String> {
    let folder = target().join("peers");
    let out = folder.display().to_string();
    let words = [
        "run",
        "--release",
        "--",
        "cost",
        "pendulum",
        "--peers",
        "--quick",
        "--methods",
        "dormandprince8",
        "--out",
        &out,
    ];
    step(command("cargo", &words).current_dir(root()))?;
    let path = folder.join("cost.csv");
    let table = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    for program in PROGRAMS {
        // Numbers, name, setting, result, error: a name may have commas, a result has none.
        let errors = table
            .lines()
            .filter(|line| line.contains(&format!("\"{program}")))
            .filter_map(|line| line.split_once(",other program,")?.1.split(',').next()?.parse::<f64>().ok());
        let best = errors.fold(f64::INFINITY, f64::min);
        println!("{program}: best error {best:.1e} of {REACHED:.0e}");
        if best.is_nan() || best > REACHED {
            return Err(format!(
                "{program} does not come near the pendulum's motion: its best error is {best:.1e}"
            ));
        }
    }
    Ok(())
}

/// The index of all ready mechanisms.
///
/// # Errors
/// A study that fails or has a wrong setting.
pub fn index() -> Result<(), String> {
    let out = target().join("atlas").display().to_string();
    step(
        command("cargo", &["run", "--release", "--", "cost", "--all", "--quick", "--out", &out])
            .current_dir(root()),
    )
}

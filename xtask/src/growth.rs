//! Compile times of long mechanisms; `xtask/src/growth.py` has the texts and the limits.

use std::fs;

use crate::shell::{command, need, root, run as run_command, target};

/// Compiles mechanisms of up to 2600 loops or terms in a scratch crate and prints a table.
///
/// # Errors
/// A release build beyond its limit, a mechanism that does not compile or move, a missing tool with its cure.
pub fn run() -> Result<(), String> {
    need("python3", "install Python 3.11 or newer")?;
    println!("\n== growth");
    let scratch = target().join("growth");
    let written = |error: std::io::Error| format!("{}: {error}", scratch.display());
    fs::create_dir_all(scratch.join("src")).map_err(written)?;
    let manifest = format!(
        "[package]\nname = \"growth\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         mbs-runtime = {{ path = {:?}, default-features = false }}\n\n[workspace]\n",
        root().join("mbs-runtime").display().to_string()
    );
    fs::write(scratch.join("Cargo.toml"), manifest).map_err(written)?;
    let mut python = command("python3", &["xtask/src/growth.py"]);
    python.arg(&scratch).env("CARGO_TARGET_DIR", scratch.join("target")).env("CARGO_INCREMENTAL", "0");
    run_command(&mut python)
}

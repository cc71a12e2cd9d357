//! The machine and the compilers of a measurement, as far as they tell.

use std::fs;
use std::process::Command;

/// Processor, compilers and generators of the peers, in one sentence each.
pub fn description(requirements: &str) -> String {
    let peers: Vec<&str> = requirements.lines().filter(|line| !line.trim().is_empty()).collect();
    format!(
        "Processor: {}. Compilers: {}; {}. Peers are made by {}.",
        processor().unwrap_or_else(|| "of a kind that the system does not tell".into()),
        first_line("rustc", "--version").unwrap_or_else(|| "a rustc that does not answer".into()),
        first_line("cc", "--version").unwrap_or_else(|| "a C compiler that does not answer".into()),
        peers.join(", "),
    )
}

/// Mean number of programs that ran or waited in the last minute.
pub fn load() -> Option<String> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next().map(str::to_owned)
}

fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let models: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("model name"))
        .filter_map(|rest| rest.split_once(':'))
        .map(|(_, model)| model.trim())
        .collect();
    models.first().map(|model| format!("{model}, {} threads", models.len()))
}

fn first_line(program: &str, argument: &str) -> Option<String> {
    let output = Command::new(program).arg(argument).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.lines().next().map(str::to_owned)
}

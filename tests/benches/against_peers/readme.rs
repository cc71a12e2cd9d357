//! The table of goals in the project's README, between two comments that name the bench.

use std::fs;
use std::path::Path;

/// Puts `table` in the place of what stands between the comments.
///
/// # Errors
/// Where the file cannot be read or written, or has no such comments.
pub fn replace(name: &str, table: &str) -> Result<(), String> {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../README.md"));
    let failed = |error: std::io::Error| format!("{}: {error}", file.display());
    let text = fs::read_to_string(file).map_err(failed)?;
    let (first, last) = (format!("<!-- bench {name} -->\n"), format!("<!-- end of bench {name} -->\n"));
    let parts = text.split_once(&first).and_then(|(before, rest)| Some((before, rest.split_once(&last)?.1)));
    let Some((before, after)) = parts else {
        return Err(format!(
            "{} has no place for the table: `{}` and `{}`",
            file.display(),
            first.trim(),
            last.trim()
        ));
    };
    fs::write(file, format!("{before}{first}{table}{last}{after}")).map_err(failed)?;
    println!("written to {}", file.display());
    Ok(())
}

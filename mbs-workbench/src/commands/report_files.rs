//! Files of a report: their place, their size, and how they are written.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::CommandError;
use crate::erased::facade::Motion;

/// Characters of a number with its comma in a table.
const CELL: usize = 20;
/// Size of a file (bytes) from which on it is announced.
const LARGE: usize = 100_000_000;

/// Says how large the table will be, where that is more than one expects.
pub fn announce_size<'a>(motions: impl Iterator<Item = &'a Motion>) {
    let cells: usize = motions.map(|motion| motion.time.len() * motion.columns()).sum();
    if let Some(words) = size(cells) {
        // If it cannot be said, the file says it.
        let _ = writeln!(std::io::stderr(), "{words}");
    }
}

/// Size of a table of so many numbers in words; `None` where it is small.
fn size(cells: usize) -> Option<String> {
    let bytes = cells.saturating_mul(CELL);
    let gigabytes = bytes as f64 / 1e9;
    (bytes > LARGE).then(|| {
        format!(
            "motion.csv will have about {gigabytes:.1} GB: {cells} numbers; `--steps` sets fewer instants"
        )
    })
}

/// Refuses a directory that nothing can be written into, before anything is computed. It is not made yet: a run may fail.
pub fn require_writable(directory: &Path) -> Result<(), CommandError> {
    let fail = |reason: &str| {
        let place = directory.display();
        Err(CommandError::Failed(format!(
            "cannot write into {place}: {reason}\nname a folder that you may write into"
        )))
    };
    let absolute = std::path::absolute(directory).unwrap_or_else(|_| directory.to_path_buf());
    let Some(present) = absolute.ancestors().find(|ancestor| fs::symlink_metadata(ancestor).is_ok()) else {
        return fail("there is no such place");
    };
    if !present.is_dir() {
        let place = present.display();
        return if present == absolute {
            fail("it is no directory")
        } else {
            fail(&format!("{place} is no directory"))
        };
    }
    let probe = present.join(format!(".mbs.{}.draft", std::process::id()));
    match fs::create_dir(&probe) {
        Ok(()) => {
            drop(fs::remove_dir(&probe));
            Ok(())
        }
        Err(error) => fail(&match present == absolute {
            true => error.to_string(),
            false => format!("{}: {error}", present.display()),
        }),
    }
}

/// Refuses a file in a directory that is not there, before anything is computed: a name that is mistyped makes no directory.
pub fn require_place(path: &Path) -> Result<(), CommandError> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !parent.is_dir() {
        let reason = match parent.exists() {
            true => format!("{} is no directory", parent.display()),
            false => format!("there is no directory {}; make it first", parent.display()),
        };
        return Err(CommandError::Failed(format!("cannot write {}: {reason}", path.display())));
    }
    require_writable(parent)
}

/// Writes files of given names and texts. Each is written next to its place first, so that a full disk leaves no incomplete file.
pub fn write_report(directory: &Path, files: &[(&str, String)]) -> Result<Vec<PathBuf>, CommandError> {
    let fail = |path: &Path, error: std::io::Error| {
        CommandError::Failed(format!("cannot write {}: {error}", path.display()))
    };
    fs::create_dir_all(directory).map_err(|error| fail(directory, error))?;
    let draft = |name: &str| directory.join(format!(".{name}.{}.draft", std::process::id()));
    let written = files
        .iter()
        // The draft is not what the user has named.
        .try_for_each(|(name, text)| {
            fs::write(draft(name), text).map_err(|error| fail(&directory.join(name), error))
        });
    let placed = written.and_then(|()| {
        files.iter().try_for_each(|(name, _)| {
            let place = directory.join(name);
            fs::rename(draft(name), &place).map_err(|error| fail(&place, error))
        })
    });
    if placed.is_err() {
        // Removes the temporary files; those already in place are complete.
        files.iter().for_each(|(name, _)| drop(fs::remove_file(draft(name))));
    }
    placed.map(|()| files.iter().map(|(name, _)| directory.join(name)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target_directory::target_directory;

    #[test]
    fn large_tables_are_announced() {
        assert_eq!(size(1_000_000), None);
        let words = size(86 * 1_000_001).expect("a large table");
        assert!(words.contains("1.7 GB") && words.contains("--steps"), "{words}");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_named_as_it_was_given() {
        let scratch = target_directory().join("tmp").join(format!("writable-{}", std::process::id()));
        fs::create_dir_all(&scratch).expect("a directory");
        assert!(require_writable(&scratch).is_ok());
        assert!(require_writable(&scratch.join("deep").join("er")).is_ok());
        assert!(!scratch.join("deep").exists());
        let file = scratch.join("file");
        fs::write(&file, "").expect("a file");
        for (path, reason) in [(file.clone(), "it is no directory"), (file.join("x"), "file is no directory")]
        {
            let error = require_writable(&path).expect_err("a file").to_string();
            assert!(error.contains(&path.display().to_string()) && error.contains(reason), "{error}");
            assert!(!error.contains("draft"), "{error}");
        }
        fs::remove_dir_all(scratch).expect("scratch");
    }

    #[test]
    fn a_report_that_cannot_be_written_leaves_nothing() {
        let directory = target_directory().join("tmp").join(format!("report-{}", std::process::id()));
        fs::create_dir_all(directory.join("motion.csv")).expect("a directory in the way");
        let files = [("report.html", "page".to_string()), ("motion.csv", "values".to_string())];
        assert!(write_report(&directory, &files).is_err());
        let left = fs::read_dir(&directory).expect("the directory").flatten();
        assert!(left.into_iter().all(|file| !file.file_name().to_string_lossy().ends_with("draft")));
        fs::remove_dir_all(directory).expect("scratch");
    }
}

//! Files that the command line names.

use std::io::{Error, ErrorKind};
use std::path::Path;

use crate::mismatch::nearest;

/// Reason why a file cannot be read, with its cure: the nearest name in its directory, or `otherwise`.
pub fn unreadable(path: &Path, error: &Error, otherwise: &str) -> String {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let help = if error.kind() != ErrorKind::NotFound {
        otherwise.to_string()
    } else if directory.is_dir() {
        near_file(path, directory).map_or(otherwise.to_string(), |near| format!("did you mean `{near}`?"))
    } else {
        format!("there is no directory `{}`", directory.display())
    };
    // The number of the operating system says nothing to a reader.
    let reason = match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_string(),
        ErrorKind::IsADirectory => "it is a directory".to_string(),
        _ => error.to_string(),
    };
    format!("cannot be read: {reason}\nhelp: {help}")
}

/// The file in `directory` with nearly this name and the same ending.
fn near_file(path: &Path, directory: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let files = std::fs::read_dir(directory).ok()?.flatten();
    let known: Vec<String> = files
        .filter(|file| file.path().extension() == path.extension())
        .filter_map(|file| file.file_name().into_string().ok())
        .collect();
    let near = nearest(name, known.iter().map(String::as_str))?;
    Some(path.with_file_name(near).display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_there_is_refused_with_the_nearest_name() {
        let folder = std::env::temp_dir().join(format!("mbs_given_{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("lift.csv"), "").expect("a file");
        std::fs::write(folder.join("lift.txt"), "").expect("a file");
        let refused = |name: &str| {
            let path = folder.join(name);
            let error = std::fs::read(&path).expect_err("no file");
            unreadable(&path, &error, "name a CSV file").replace(&folder.display().to_string(), "F")
        };
        assert_eq!(
            refused("lfit.csv"),
            "cannot be read: there is no such file\nhelp: did you mean `F/lift.csv`?"
        );
        assert_eq!(refused("other.csv"), "cannot be read: there is no such file\nhelp: name a CSV file");
        assert_eq!(
            refused("no/lift.csv"),
            "cannot be read: there is no such file\nhelp: there is no directory `F/no`"
        );
        assert_eq!(refused(""), "cannot be read: it is a directory\nhelp: name a CSV file");
        std::fs::remove_dir_all(&folder).expect("the folder");
    }
}

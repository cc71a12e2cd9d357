//! `mbs watch`.

use std::fs::{self, Metadata};
use std::io::{self, Write};
use std::thread;
use std::time::{Duration, SystemTime};

use super::run::MotionArguments;
use super::{CommandError, of_file};
use crate::catalogue::Catalogue;
use crate::text_file::{Argument, is_file};

/// Time between two looks at the file.
const INTERVAL: Duration = Duration::from_millis(200);

/// Runs the text of a file whenever the file is saved; the page loads itself anew. It ends when it is interrupted.
pub fn run(catalogue: &Catalogue, arguments: &MotionArguments) -> Result<(), CommandError> {
    let name = arguments.selection.name();
    if !is_file(name) {
        return Err(CommandError::Usage(format!(
            "`{name}` is a mechanism of the list, which changes when its program is built; name the file of its text: \
             `mbs watch src/lib.rs`"
        )));
    }
    let path = Argument::of(name).path;
    let (mut seen, mut last) = (None, None);
    loop {
        let state = fs::metadata(path).ok().map(state);
        // While an editor writes, the file may be missing or half there: what lasts two looks is saved.
        let saved = state.is_some() && state != seen && state == last;
        last = state;
        if saved || seen.is_none() {
            let again = seen.is_some();
            match of_file::run(catalogue, name, Some(of_file::Watch { command: "watch", runs: "run" })) {
                Ok(_) => {}
                // Without a file or a mechanism of this name there is nothing to watch.
                Err(error @ CommandError::Usage(_)) if !again => return Err(error),
                Err(error) => writeln!(io::stderr(), "error: {error}")?,
            }
            writeln!(io::stderr(), "watching {path}; Ctrl-C ends it")?;
            seen = state.or(seen);
        }
        thread::sleep(INTERVAL);
    }
}

fn state(data: Metadata) -> (u64, Option<SystemTime>) {
    (data.len(), data.modified().ok())
}

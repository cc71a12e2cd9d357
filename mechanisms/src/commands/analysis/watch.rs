//! How far a long run is: a bar, or lines where nobody sees one.

use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines of a run that no bar shows: long enough to keep short runs silent.
const SILENCE: Duration = Duration::from_secs(5);

/// Says how far a long run is where nobody sees a bar.
pub(super) struct Watch {
    label: &'static str,
    instants: usize,
    hidden: bool,
    started: Instant,
    said: Duration,
}

impl Watch {
    pub(super) fn new(label: &'static str, instants: usize, hidden: bool) -> Self {
        Watch { label, instants, hidden, started: Instant::now(), said: Duration::ZERO }
    }

    pub(super) fn heard(&mut self, count: usize, out: &mut dyn Write) {
        let elapsed = self.started.elapsed();
        if self.hidden && elapsed >= self.said + SILENCE {
            self.said = elapsed;
            // Where nobody can read it the run goes on.
            let _ = writeln!(
                out,
                "{}: {count} of {} instants after {} s",
                self.label,
                self.instants,
                elapsed.as_secs()
            );
        }
    }
}

pub(super) fn progress(label: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a valid template");
    ProgressBar::new(0).with_style(style).with_message(label)
}

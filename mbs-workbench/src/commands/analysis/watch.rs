//! Progress of a long run: a bar, or lines if the bar is hidden.

use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines of progress: long enough to keep short runs silent.
const SILENCE: Duration = Duration::from_secs(5);

/// Prints the progress of a long run as lines if the bar is hidden.
pub(super) struct Watch {
    label: String,
    instants: usize,
    hidden: bool,
    started: Instant,
    said: Duration,
}

impl Watch {
    pub(super) fn new(label: &str, instants: usize, hidden: bool) -> Self {
        Watch { label: label.to_string(), instants, hidden, started: Instant::now(), said: Duration::ZERO }
    }

    pub(super) fn on_progress(&mut self, count: usize, out: &mut dyn Write) {
        let elapsed = self.started.elapsed();
        if self.hidden && elapsed >= self.said + SILENCE {
            self.said = elapsed;
            // The run goes on if the line cannot be written.
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

pub(super) fn progress(label: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a valid template");
    ProgressBar::new(0).with_style(style).with_message(label.to_string())
}

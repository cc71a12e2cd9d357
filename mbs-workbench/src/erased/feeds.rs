//! Courses of inputs.

use std::sync::Arc;

use mbs_runtime::Entry;

use crate::motion::course::Course;

/// Courses of inputs by the index of the value.
#[derive(Clone, Debug, Default)]
pub struct Feeds(Arc<Vec<Feed>>);

/// An input with its course.
#[derive(Clone, Debug)]
struct Feed {
    /// Index of the value among the variables.
    index: usize,
    /// `true` where its rates are the two variables behind it.
    has_rates: bool,
    course: Course,
}

// Nothing here is generic but the calls of `see`, so that it is compiled once.
impl Feeds {
    /// `true` if no input follows a course.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Makes the input at `index` of `entries` follow `course`; `false` where there is none.
    pub fn feed(&mut self, entries: &[Entry], index: usize, course: Course) -> bool {
        let Some(entry) = entries.get(index) else { return false };
        let rate = format!("{}.rate", entry.name);
        let has_rates = entries.get(index + 1).is_some_and(|next| next.name == rate);
        let feeds = Arc::make_mut(&mut self.0);
        feeds.retain(|feed| feed.index != index);
        feeds.push(Feed { index, has_rates, course });
        true
    }

    /// Shows `see` index and value of each variable that follows a course, as it is at `t` (s).
    pub fn show(&self, t: f64, mut see: impl FnMut(usize, f64)) {
        for Feed { index, has_rates, course } in self.0.iter() {
            let values = course.at(t);
            let count = if *has_rates { values.len() } else { 1 };
            values[..count].iter().enumerate().for_each(|(order, value)| see(index + order, *value));
        }
    }

    /// Value of the variable at `index` at `t` (s), where it follows a course.
    pub fn value(&self, index: usize, t: f64) -> Option<f64> {
        let mut found = None;
        self.show(t, |fed, value| {
            if fed == index {
                found = Some(value);
            }
        });
        found
    }
}

//! Laws of the language reference against closed forms, quadratures and integrations by other means.
#![forbid(unsafe_code)]

use core::fmt::Debug;

mod door;
mod drives;
mod elements;
mod half_car;
mod latched;
mod plain;
mod tyre;

/// Largest error of a law, over its scale; printed at the end.
struct Worst {
    law: &'static str,
    error: f64,
}

impl Worst {
    fn of(law: &'static str) -> Self {
        Worst { law, error: 0.0 }
    }

    /// Takes an error and asserts its bound.
    fn see(&mut self, error: f64, bound: f64, at: impl Debug) {
        assert!(error < bound, "{}: {error:e} at {at:?}", self.law);
        self.error = self.error.max(error);
    }
}

impl Drop for Worst {
    fn drop(&mut self) {
        println!("{}: {:.1e}", self.law, self.error);
    }
}

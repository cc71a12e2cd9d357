//! The study of a mechanism of one's own: what of it varies, and all its variants.

use std::time::{Duration, Instant};

use mbs_codegen::Variable as Declared;

use crate::erased::facade::AnyEquations;
use crate::erased::variations::{Variable, variable as _};
use crate::hard_cases::driven::driven_outcomes;
use crate::hard_cases::moved::moved_outcomes;
use crate::hard_cases::oracle::Oracle;
use crate::hard_cases::variation::{Class, Subject};
use crate::hard_cases::verdict::Outcome;
use crate::setting::MotionMethod;

/// Extent of a study.
#[derive(Clone, Debug)]
pub struct Extent {
    /// Methods for motions from forces.
    pub methods: Vec<MotionMethod>,
    /// Seeds of the variants.
    pub seeds: Vec<u64>,
    /// End of the motion (s).
    pub until: f64,
}

/// Time that a study may take.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    began: Instant,
    allowed: Duration,
}

impl Clock {
    /// From now on.
    pub fn of(allowed: Duration) -> Self {
        Clock { began: Instant::now(), allowed }
    }

    /// `true` behind the end.
    pub fn is_over(&self) -> bool {
        self.began.elapsed() > self.allowed
    }
}

/// All variants of a mechanism.
#[derive(Clone, Debug)]
pub struct Study {
    /// One a variant and method.
    pub outcomes: Vec<Outcome>,
    /// Kinds of variants that do not suit the mechanism, with the reasons.
    pub left_out: Vec<String>,
    /// Variants that there was no time for.
    pub not_run: usize,
}

/// Makes a mechanism with values of parameters by index.
pub type Make = fn(&[(usize, f64)]) -> Variable;

//! Links only if no entry point can panic; run, it takes three mechanisms and the drivers through all of them.
//!
//! A binary, because in a `cdylib` no-panic's missing symbol is no error.
#![forbid(unsafe_code)]

use std::error::Error;

use mbs_runtime::{Failure, Kinematic, Lanes, Real, Scalar};
use proof_subjects::{
    FourBar, Platform, Start, cam, exercise_emitted, exercise_laws, exercise_solvers, exercise_splines,
};

fn emitted<S: Kinematic<T, N>, T: Scalar, const N: usize>(mechanism: S) {
    let start = Start::of(&mechanism);
    exercise_emitted(mechanism, &start);
}

fn solvers<S: Kinematic<R, N> + Copy, R: Real, const N: usize>(
    mechanism: S,
    variable: &str,
) -> Result<(), Failure> {
    exercise_solvers(mechanism, &Start::of(&mechanism), variable)
}

fn main() -> Result<(), Box<dyn Error>> {
    exercise_laws()?;
    exercise_splines()?;
    emitted(FourBar::<f64>::default());
    emitted(FourBar::<f32>::default());
    emitted(FourBar::<Lanes<f64, 4>>::default());
    emitted(Platform::<f64>::default());
    emitted(Platform::<f32>::default());
    emitted(Platform::<Lanes<f64, 4>>::default());
    emitted(cam::<f64>());
    emitted(cam::<f32>());
    emitted(cam::<Lanes<f64, 4>>());
    solvers(FourBar::<f64>::default(), "L5")?;
    solvers(FourBar::<f32>::default(), "L5")?;
    solvers(Platform::<f64>::default(), "rod[1]")?;
    solvers(Platform::<f32>::default(), "rod[1]")?;
    solvers(cam::<f64>(), "base")?;
    solvers(cam::<f32>(), "base")?;
    Ok(())
}

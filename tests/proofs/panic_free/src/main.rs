//! Links only if no entry point can panic; run, it takes every subject through all of them.
//!
//! A binary, because in a `cdylib` no-panic's missing symbol is no error.
#![forbid(unsafe_code)]

use std::error::Error;

use mbs_runtime::{Failure, Kinematic, Lanes, Real, Scalar};
use proof_subjects::{
    FourBar, Hammer, Parallelogram, Platform, Sledge, Start, cam, engine, exercise_batch, exercise_contacts,
    exercise_dynamics, exercise_emitted, exercise_functions, exercise_laws, exercise_masses, exercise_modes,
    exercise_modes_further, exercise_sleep, exercise_solvers, exercise_splines, exercise_tape,
};

fn emitted<S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize>(mechanism: S) {
    let start = Start::of(&mechanism);
    exercise_emitted(mechanism, &start);
}

fn solvers<S: Kinematic<R, N, M> + Copy, R: Real, const N: usize, const M: usize>(
    mechanism: S,
    variable: &str,
) -> Result<(), Failure> {
    exercise_solvers(mechanism, &Start::of(&mechanism), variable)
}

fn kinematics() -> Result<(), Failure> {
    emitted(FourBar::<f64>::default());
    emitted(FourBar::<f32>::default());
    emitted(FourBar::<Lanes<f64, 4>>::default());
    emitted(Platform::<f64>::default());
    emitted(Platform::<f32>::default());
    emitted(Platform::<Lanes<f64, 4>>::default());
    emitted(Parallelogram::<f64>::default());
    emitted(Parallelogram::<f32>::default());
    emitted(Parallelogram::<Lanes<f64, 4>>::default());
    emitted(cam::<f64>());
    emitted(cam::<f32>());
    emitted(cam::<Lanes<f64, 4>>());
    solvers(FourBar::<f64>::default(), "L5")?;
    solvers(FourBar::<f32>::default(), "L5")?;
    solvers(Platform::<f64>::default(), "rod[1]")?;
    solvers(Platform::<f32>::default(), "rod[1]")?;
    solvers(Parallelogram::<f64>::default(), "h")?;
    solvers(Parallelogram::<f32>::default(), "h")?;
    solvers(cam::<f64>(), "base")?;
    solvers(cam::<f32>(), "base")?;
    exercise_batch(FourBar::default(), &Start::of(&FourBar::<f64>::default()))?;
    exercise_batch(FourBar::default(), &Start::of(&FourBar::<f32>::default()))?;
    exercise_batch(Parallelogram::default(), &Start::of(&Parallelogram::<f64>::default()))
}

fn dynamics() -> Result<(), Failure> {
    exercise_functions(engine::<f64>(), &Start::of(&engine()));
    exercise_functions(engine::<f32>(), &Start::of(&engine()));
    exercise_functions(engine::<Lanes<f64, 4>>(), &Start::of(&engine()));
    exercise_masses(engine::<f64>(), &Start::of(&engine()));
    exercise_masses(engine::<f32>(), &Start::of(&engine()));
    exercise_masses(engine::<Lanes<f64, 4>>(), &Start::of(&engine()));
    exercise_contacts(Hammer::<f64>::default())?;
    exercise_contacts(Hammer::<f32>::default())?;
    exercise_modes(Sledge::<f64>::default())?;
    exercise_modes(Sledge::<f32>::default())?;
    exercise_sleep(Sledge::<f64>::default())?;
    exercise_sleep(Sledge::<f32>::default())?;
    exercise_modes_further(Sledge::<f64>::default())?;
    exercise_modes_further(Sledge::<f32>::default())?;
    exercise_dynamics(engine::<f64>())?;
    exercise_dynamics(engine::<f32>())
}

fn main() -> Result<(), Box<dyn Error>> {
    exercise_laws()?;
    exercise_splines()?;
    kinematics()?;
    dynamics()?;
    assert!(exercise_tape::<f64>() == 3.0 && exercise_tape::<f32>() == 3.0);
    assert!(exercise_tape::<Lanes<f64, 4>>().0 == [3.0; 4]);
    Ok(())
}

//! Printed by `mbs cost pendulum --rust` for each method; written by a test.
#![allow(clippy::all)]

use mbs_runtime::Failure;
use mbs_runtime::dynamics::*;
use mechanisms::pendulum::Pendulum;

/// Projection with DormandPrince8, tolerance 1e-4.
pub fn run_0() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with DormandPrince5, tolerance 1e-4.
pub fn run_1() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with Radau5, tolerance 1e-4.
pub fn run_2() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with RungeKutta4, 2000 steps.
pub fn run_3() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with SemiImplicitEuler, 2000 steps.
pub fn run_4() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Projection::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with DormandPrince8, tolerance 1e-4.
pub fn run_5() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with DormandPrince5, tolerance 1e-4.
pub fn run_6() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with Radau5, tolerance 1e-4.
pub fn run_7() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with RungeKutta4, 2000 steps.
pub fn run_8() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with SemiImplicitEuler, 2000 steps.
pub fn run_9() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, VelocityTransformation);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with DormandPrince8, tolerance 1e-4.
pub fn run_10() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with DormandPrince5, tolerance 1e-4.
pub fn run_11() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with Radau5, tolerance 1e-4.
pub fn run_12() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with RungeKutta4, 2000 steps.
pub fn run_13() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Baumgarte::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with SemiImplicitEuler, 2000 steps.
pub fn run_14() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Baumgarte::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with DormandPrince8, tolerance 1e-4.
pub fn run_15() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with DormandPrince5, tolerance 1e-4.
pub fn run_16() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with Radau5, tolerance 1e-4.
pub fn run_17() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with RungeKutta4, 2000 steps.
pub fn run_18() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Penalty::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with SemiImplicitEuler, 2000 steps.
pub fn run_19() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Penalty::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with DormandPrince8, tolerance 1e-4.
pub fn run_20() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with DormandPrince5, tolerance 1e-4.
pub fn run_21() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with Radau5, tolerance 1e-4.
pub fn run_22() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with RungeKutta4, 2000 steps.
pub fn run_23() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Unstabilized);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with SemiImplicitEuler, 2000 steps.
pub fn run_24() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Unstabilized);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// AugmentedLagrangian, 2000 steps.
pub fn run_25() -> Result<f64, Failure> {
    let method = AugmentedLagrangian;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Extrapolated, 2000 steps.
pub fn run_26() -> Result<f64, Failure> {
    let method = Extrapolated;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// GeneralizedAlpha, 2000 steps.
pub fn run_27() -> Result<f64, Failure> {
    let method = GeneralizedAlpha::default();
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// MoreauJean, 2000 steps.
pub fn run_28() -> Result<f64, Failure> {
    let method = MoreauJean;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with DormandPrince8, f32, tolerance 1e-4.
pub fn run_29() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with DormandPrince5, f32, tolerance 1e-4.
pub fn run_30() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with Radau5, f32, tolerance 1e-4.
pub fn run_31() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with RungeKutta4, f32, 2000 steps.
pub fn run_32() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Projection with SemiImplicitEuler, f32, 2000 steps.
pub fn run_33() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Projection::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with DormandPrince8, f32, tolerance 1e-4.
pub fn run_34() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with DormandPrince5, f32, tolerance 1e-4.
pub fn run_35() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with Radau5, f32, tolerance 1e-4.
pub fn run_36() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, VelocityTransformation);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with RungeKutta4, f32, 2000 steps.
pub fn run_37() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// VelocityTransformation with SemiImplicitEuler, f32, 2000 steps.
pub fn run_38() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, VelocityTransformation);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with DormandPrince8, f32, tolerance 1e-4.
pub fn run_39() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with DormandPrince5, f32, tolerance 1e-4.
pub fn run_40() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with Radau5, f32, tolerance 1e-4.
pub fn run_41() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Baumgarte::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with RungeKutta4, f32, 2000 steps.
pub fn run_42() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Baumgarte::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Baumgarte with SemiImplicitEuler, f32, 2000 steps.
pub fn run_43() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Baumgarte::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with DormandPrince8, f32, tolerance 1e-4.
pub fn run_44() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with DormandPrince5, f32, tolerance 1e-4.
pub fn run_45() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with Radau5, f32, tolerance 1e-4.
pub fn run_46() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Penalty::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with RungeKutta4, f32, 2000 steps.
pub fn run_47() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Penalty::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Penalty with SemiImplicitEuler, f32, 2000 steps.
pub fn run_48() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Penalty::default());
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with DormandPrince8, f32, tolerance 1e-4.
pub fn run_49() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince8, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with DormandPrince5, f32, tolerance 1e-4.
pub fn run_50() -> Result<f64, Failure> {
    let method = Explicit::new(DormandPrince5, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with Radau5, f32, tolerance 1e-4.
pub fn run_51() -> Result<f64, Failure> {
    let method = Explicit::new(Radau5, Unstabilized);
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-4));
    run.advance_to(1.0)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with RungeKutta4, f32, 2000 steps.
pub fn run_52() -> Result<f64, Failure> {
    let method = Explicit::new(RungeKutta4, Unstabilized);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Unstabilized with SemiImplicitEuler, f32, 2000 steps.
pub fn run_53() -> Result<f64, Failure> {
    let method = Explicit::new(SemiImplicitEuler, Unstabilized);
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// AugmentedLagrangian, f32, 2000 steps.
pub fn run_54() -> Result<f64, Failure> {
    let method = AugmentedLagrangian;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// Extrapolated, f32, 2000 steps.
pub fn run_55() -> Result<f64, Failure> {
    let method = Extrapolated;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// GeneralizedAlpha, f32, 2000 steps.
pub fn run_56() -> Result<f64, Failure> {
    let method = GeneralizedAlpha::default();
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// MoreauJean, f32, 2000 steps.
pub fn run_57() -> Result<f64, Failure> {
    let method = MoreauJean;
    let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f32)?;
    run.step_to(1.0, 2000)?;
    Ok(f64::from(run.q()[1]))
}

/// All of them.
pub const ALL: [fn() -> Result<f64, Failure>; 58] = [run_0, run_1, run_2, run_3, run_4, run_5, run_6, run_7, run_8, run_9, run_10, run_11, run_12, run_13, run_14, run_15, run_16, run_17, run_18, run_19, run_20, run_21, run_22, run_23, run_24, run_25, run_26, run_27, run_28, run_29, run_30, run_31, run_32, run_33, run_34, run_35, run_36, run_37, run_38, run_39, run_40, run_41, run_42, run_43, run_44, run_45, run_46, run_47, run_48, run_49, run_50, run_51, run_52, run_53, run_54, run_55, run_56, run_57];

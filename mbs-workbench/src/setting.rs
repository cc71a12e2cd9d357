//! Settings of the solvers that a user can choose between.

use std::fmt;

/// Type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Numbers {
    /// `f64`.
    Double,
    /// `f32`.
    Single,
}

/// Formulation of the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FormulationName {
    /// Ends of steps are put back onto the rows.
    Projection,
    /// Independent coordinates through the blocks of the rows.
    VelocityTransformation,
    /// Baumgarte's oscillators.
    Baumgarte,
    /// Stiff springs and dampers in place of the rows.
    Penalty,
    /// Φ̈ = 0 alone.
    Unstabilized,
}

/// Integrator of an explicit or implicit run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum IntegratorName {
    /// 8(5,3), adaptive.
    DormandPrince8,
    /// 5(4), adaptive.
    DormandPrince5,
    /// 5(3), implicit, adaptive.
    Radau5,
    /// Order 4, fixed steps.
    RungeKutta4,
    /// Order 1, fixed steps.
    SemiImplicitEuler,
}

/// Method with a formulation of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ImplicitName {
    /// Order 2.
    AugmentedLagrangian,
    /// Order 3.
    Extrapolated,
    /// Order 2.
    GeneralizedAlpha,
    /// Order 1, over impacts.
    MoreauJean,
}

/// Way to move a mechanism from forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionMethod {
    /// Formulation and integrator.
    Explicit(FormulationName, IntegratorName),
    /// Both in one.
    Implicit(ImplicitName),
}

/// Fineness of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Relative and absolute tolerance of adaptive steps.
    Tolerance(f64),
    /// Equal steps over the span.
    Steps(u32),
}

/// Accuracy of a step of kinematics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Closing {
    /// Until the rows are closed.
    Closed,
    /// At most so many evaluations a block.
    Evaluations(u32),
}

/// Source of sines and cosines, a feature of `mbs-runtime`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kernel {
    /// The kernels of the runtime, the same bits on all targets.
    #[default]
    Own,
    /// The same with fused products: feature `fma`.
    Fused,
    /// Those of the crate `libm`: feature `libm`.
    Library,
}

impl Kernel {
    /// Feature of `mbs-runtime`; none of its own kernels.
    pub fn feature(self) -> Option<&'static str> {
        match self {
            Kernel::Own => None,
            Kernel::Fused => Some("fma"),
            Kernel::Library => Some("libm"),
        }
    }
}

/// A setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// Motion from forces.
    Motion {
        /// Type of number.
        numbers: Numbers,
        /// Method.
        method: MotionMethod,
        /// Tolerance or steps.
        resolution: Resolution,
    },
    /// Motion from drives.
    Kinematics {
        /// Type of number.
        numbers: Numbers,
        /// Lanes computed together; 1 is a `Stepper`.
        lanes: u32,
        /// End of the iterations.
        closing: Closing,
        /// Equal steps over the span.
        steps: u32,
        /// Source of sines and cosines.
        kernel: Kernel,
    },
}

impl MotionMethod {
    /// All methods, the recommended ones first.
    pub fn all() -> Vec<MotionMethod> {
        use FormulationName::{Baumgarte, Penalty, Projection, Unstabilized, VelocityTransformation};
        use ImplicitName::{AugmentedLagrangian, Extrapolated, GeneralizedAlpha, MoreauJean};
        use IntegratorName::{DormandPrince5, DormandPrince8, Radau5, RungeKutta4, SemiImplicitEuler};
        let formulations = [Projection, VelocityTransformation, Baumgarte, Penalty, Unstabilized];
        let integrators = [DormandPrince8, DormandPrince5, Radau5, RungeKutta4, SemiImplicitEuler];
        let pairs = formulations
            .iter()
            .flat_map(|formulation| integrators.iter().map(|integrator| (*formulation, *integrator)));
        let explicit = pairs.map(|(formulation, integrator)| MotionMethod::Explicit(formulation, integrator));
        let whole = [AugmentedLagrangian, Extrapolated, GeneralizedAlpha, MoreauJean];
        explicit.chain(whole.map(MotionMethod::Implicit)).collect()
    }

    /// `true` for steps as long as a tolerance allows.
    pub fn is_adaptive(self) -> bool {
        use IntegratorName::{DormandPrince5, DormandPrince8, Radau5};
        matches!(self, MotionMethod::Explicit(_, DormandPrince8 | DormandPrince5 | Radau5))
    }

    /// Order of a method of equal steps, where nothing is stiff; none of steps as long as a tolerance allows.
    pub fn order(self) -> Option<i32> {
        use IntegratorName::{DormandPrince5, DormandPrince8, Radau5, RungeKutta4, SemiImplicitEuler};
        match self {
            MotionMethod::Explicit(_, DormandPrince8 | DormandPrince5 | Radau5) => None,
            MotionMethod::Explicit(_, RungeKutta4) => Some(4),
            MotionMethod::Explicit(_, SemiImplicitEuler) => Some(1),
            MotionMethod::Implicit(ImplicitName::Extrapolated) => Some(3),
            MotionMethod::Implicit(ImplicitName::AugmentedLagrangian | ImplicitName::GeneralizedAlpha) => {
                Some(2)
            }
            MotionMethod::Implicit(ImplicitName::MoreauJean) => Some(1),
        }
    }

    /// `true` for methods that solve for the end of a step: the extrapolated reference judges them.
    pub fn is_implicit(self) -> bool {
        match self {
            MotionMethod::Explicit(_, integrator) => integrator == IntegratorName::Radau5,
            MotionMethod::Implicit(name) => name != ImplicitName::MoreauJean,
        }
    }
}

impl Closing {
    /// Order of a step that a budget ends: the prediction by q, q̇ and q̈ has order 3, and each correction doubles it. None of one that closes.
    pub fn order(self) -> Option<i32> {
        match self {
            Closing::Closed => None,
            Closing::Evaluations(most) => Some(3 << most.min(8)),
        }
    }
}

impl Numbers {
    /// Distance of 1 from the next number.
    pub fn epsilon(self) -> f64 {
        match self {
            Numbers::Double => f64::EPSILON,
            Numbers::Single => f64::from(f32::EPSILON),
        }
    }

    /// The type's name in Rust.
    pub fn name(self) -> &'static str {
        match self {
            Numbers::Double => "f64",
            Numbers::Single => "f32",
        }
    }
}

impl Setting {
    /// Type of number.
    pub fn numbers(&self) -> Numbers {
        match self {
            Setting::Motion { numbers, .. } | Setting::Kinematics { numbers, .. } => *numbers,
        }
    }

    /// Name of the curve that the setting is a point of.
    pub fn curve(&self) -> String {
        let single = if self.numbers() == Numbers::Single { ", f32" } else { "" };
        let feature = match self {
            Setting::Kinematics { kernel, .. } => kernel.feature(),
            Setting::Motion { .. } => None,
        };
        let feature = feature.map_or_else(String::new, |feature| format!(", feature {feature}"));
        match self {
            Setting::Motion { method, .. } => format!("{method}{single}"),
            Setting::Kinematics { lanes: 1, closing, .. } => format!("Stepper, {closing}{single}{feature}"),
            Setting::Kinematics { lanes, .. } => format!("Batch of {lanes}{single}{feature}"),
        }
    }

    /// The point's label on its curve.
    pub fn label(&self) -> String {
        match self {
            Setting::Motion { resolution: Resolution::Tolerance(tolerance), .. } => {
                format!("tolerance {tolerance:.0e}")
            }
            Setting::Motion { resolution: Resolution::Steps(steps), .. }
            | Setting::Kinematics { steps, .. } => format!("{steps} steps"),
        }
    }
}

impl fmt::Display for MotionMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MotionMethod::Explicit(formulation, integrator) => {
                write!(f, "{formulation:?} with {integrator:?}")
            }
            MotionMethod::Implicit(implicit) => write!(f, "{implicit:?}"),
        }
    }
}

impl fmt::Display for Closing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Closing::Closed => f.write_str("closed"),
            Closing::Evaluations(1) => f.write_str("1 evaluation"),
            Closing::Evaluations(most) => write!(f, "{most} evaluations"),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.curve(), self.label())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_formulation_has_every_integrator() {
        let all = MotionMethod::all();
        assert_eq!(all.len(), 5 * 5 + 4);
        assert_eq!(all[0].to_string(), "Projection with DormandPrince8");
        assert_eq!(all.iter().filter(|method| method.is_adaptive()).count(), 15);
        assert!(all.iter().all(|method| method.is_adaptive() != method.order().is_some()));
    }
}

//! Options of the command line for integrator and stabilisation of a motion from forces.

use crate::erased::dynamics::direct_dynamics::{Implicit, ImplicitMethod, Pair, Rule, Stabilization, Steps};
use clap::{Args, ValueEnum};
use mbs_runtime::dynamics::{Baumgarte, Penalty, Tolerance};

use crate::commands::chosen::finite;

/// Method that keeps a motion from forces on its constraints.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum MethodName {
    /// Positions and velocities are put back onto the constraints
    Projection,
    /// Violations are damped as oscillators of frequency `--frequency`
    Baumgarte,
    /// Stiff springs and dampers against violations, `--frequency` and `--damping` theirs: to see what a penalty is
    Penalty,
    /// Nothing: the constraints drift
    None,
    /// Independent coordinates through the blocks of the constraints
    Velocity,
    /// Implicit trapezoidal steps of `--step` with penalties and multipliers, for stiff forces
    AugmentedLagrangian,
    /// The same, three thirds of a step extrapolated against a whole one: order 3
    Extrapolated,
    /// Implicit steps of `--step` by generalised-alpha, for stiff forces
    GeneralizedAlpha,
    /// Steps of `--step` over impacts by Moreau and Jean, for many rigid contacts and frictions that stick: order 1
    MoreauJean,
    /// Implicit steps by Radau IIA of order 5, adaptive within `--tolerance`, for stiff forces
    Radau,
}

impl MethodName {
    /// `true` if the method damps violations with a frequency and a damping ratio.
    pub fn is_damped(self) -> bool {
        matches!(self, MethodName::Baumgarte | MethodName::Penalty)
    }

    /// `true` if the method has steps of its own.
    pub fn is_implicit(self) -> bool {
        matches!(
            self,
            MethodName::AugmentedLagrangian
                | MethodName::Extrapolated
                | MethodName::GeneralizedAlpha
                | MethodName::MoreauJean
        )
    }
}

/// Integrator of a motion from forces, unless the method has steps of its own.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum IntegratorName {
    /// Dormand and Prince 8(5,3), adaptive steps within `--tolerance`
    Order8,
    /// Dormand and Prince 5(4), adaptive steps within `--tolerance`
    Order5,
    /// The classical Runge-Kutta method of order 4, equal steps of at most `--step`
    Rk4,
    /// Semi-implicit Euler, order 1, equal steps of at most `--step`
    Euler,
}

impl IntegratorName {
    /// The method of equal steps, where it is one.
    pub fn rule(self) -> Option<Rule> {
        match self {
            IntegratorName::Rk4 => Some(Rule::RungeKutta4),
            IntegratorName::Euler => Some(Rule::SemiImplicitEuler),
            IntegratorName::Order8 | IntegratorName::Order5 => None,
        }
    }

    /// Adaptive steps within `tolerance`, or equal ones of at most `longest` (s).
    pub fn steps(self, tolerance: f64, longest: f64) -> Steps {
        match self {
            IntegratorName::Order8 => Steps::Adaptive { pair: Pair::Order8, tolerance },
            IntegratorName::Order5 => Steps::Adaptive { pair: Pair::Order5, tolerance },
            IntegratorName::Rk4 => Steps::Equal { rule: Rule::RungeKutta4, longest },
            IntegratorName::Euler => Steps::Equal { rule: Rule::SemiImplicitEuler, longest },
        }
    }
}

/// The constants of Baumgarte's stabilisation and of a penalty.
#[derive(Args, Clone, Copy, Default)]
pub struct Damping {
    /// Frequency omega (rad/s) of violations by Baumgarte or penalty [default: 10]
    #[arg(long, value_name = "OMEGA", value_parser = at_least_zero, allow_negative_numbers = true)]
    frequency: Option<f64>,
    /// Their damping xi, 1 is critical [default: 1]
    #[arg(long, value_name = "XI", value_parser = at_least_zero, allow_negative_numbers = true)]
    damping: Option<f64>,
    /// Penalty alpha over the largest mass, at most 1e8: the motion is wrong by about 1/alpha, accelerations by 1e-16 alpha of rounding [default: 1e7]
    #[arg(long, value_name = "A", value_parser = penalty, allow_negative_numbers = true)]
    alpha: Option<f64>,
}

impl Damping {
    /// `true` if the command line sets any of them.
    pub fn is_given(self) -> bool {
        self.frequency.is_some() || self.damping.is_some()
    }

    /// `true` if it sets the stiffness of a penalty.
    pub fn is_penalty_given(self) -> bool {
        self.alpha.is_some()
    }

    /// Options as the command line spells them.
    pub fn command(self) -> String {
        let option = |name: &str, value: Option<f64>| {
            value.map_or_else(String::new, |value| format!(" --{name} {value}"))
        };
        let alpha = self.alpha.map_or_else(String::new, |value| format!(" --alpha {value:e}"));
        option("frequency", self.frequency) + &option("damping", self.damping) + &alpha
    }

    /// `longest`: of an implicit method's steps (s).
    pub fn stabilization(self, method: MethodName, longest: f64) -> Stabilization {
        let implicit = |method| Stabilization::Implicit(Implicit { method, longest });
        let standard = Baumgarte::default();
        let (omega, xi) = (self.frequency.unwrap_or(standard.omega), self.damping.unwrap_or(standard.xi));
        match method {
            MethodName::AugmentedLagrangian => implicit(ImplicitMethod::AugmentedLagrangian),
            MethodName::Extrapolated => implicit(ImplicitMethod::Extrapolated),
            MethodName::GeneralizedAlpha => implicit(ImplicitMethod::GeneralizedAlpha),
            MethodName::MoreauJean => implicit(ImplicitMethod::MoreauJean),
            MethodName::Radau => Stabilization::Radau,
            MethodName::Projection => Stabilization::Projection,
            MethodName::None => Stabilization::None,
            MethodName::Velocity => Stabilization::Velocity,
            MethodName::Baumgarte => Stabilization::Baumgarte(Baumgarte { xi, omega }),
            MethodName::Penalty => {
                let alpha = self.alpha.unwrap_or(Penalty::default().alpha);
                Stabilization::Penalty(Penalty { alpha, xi, omega })
            }
        }
    }
}

/// A number of at least zero.
pub fn at_least_zero(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number >= 0.0 => Ok(number),
        _ => Err("a number of at least 0 is needed".to_string()),
    }
}

/// A number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number > 0.0 => Ok(number),
        _ => Err("a number above 0 is needed".to_string()),
    }
}

/// A tolerance that double precision can meet.
pub fn tolerance(text: &str) -> Result<f64, String> {
    let least = Tolerance::<f64>::least() / 2.0;
    match above_zero(text)? {
        number if number >= least => Ok(number),
        _ => {
            Err(format!("at least {least:.1e} is possible: rounding alone is more than a smaller one allows"))
        }
    }
}

/// A penalty with rounding errors below the tolerance of adaptive steps.
fn penalty(text: &str) -> Result<f64, String> {
    /// Rounding errors of accelerations are 1e-16 times the penalty. Above this limit adaptive steps of the usual tolerance
    /// become so small that a run does not end.
    const LARGEST: f64 = 1e8;
    match above_zero(text)? {
        number if number <= LARGEST => Ok(number),
        _ => Err(format!(
            "at most {LARGEST:e} is possible: beside a larger one rounding rules the accelerations"
        )),
    }
}

//! Budget of a step of bounded work.

/// The work that a step may cost at most, in each block.
///
/// ```
/// use mbs_runtime::{Budget, Mechanism, Step, Stepper, mechanism};
///
/// # mechanism! {
/// #     /// A crank and a rod that slides along x.
/// #     pub mechanism Crank;
/// #     param r: m = 50mm;
/// #     coord theta: rad = 0;
/// #     coord phi: rad = 0;
/// #     coord x: m = 0.23;
/// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
/// #     drive motor: theta == 30 [rad/s]*t;
/// #     branch ahead: cos(phi) > 0;
/// # }
///
/// let crank: Crank = Crank::default();
/// let guess = crank.guess(&crank.parameters());
/// let mut motion = Stepper::assemble(crank, guess, 0.0)?;
/// let budget = Budget { newton: 3, fallback: 0 };
/// assert!(budget.worst_case::<Crank<f64>>().total() < 2000); // operations of a step at most
/// match motion.step(1e-3, budget) {
///     Step::Done(statistics) => assert!(statistics.evaluations <= budget.evaluations()),
///     Step::Degraded { residual, row, .. } => println!("{} is open by {residual:e}", row.name),
///     Step::Refused(failure) => println!("{failure}"), // the state is what it was
/// }
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Evaluations of residual and Jacobian by Newton's method; 0 counts as 1, which shows if the prediction
    /// closes.
    pub newton: u32,
    /// Trial steps of Levenberg–Marquardt where that did not do; 0 for none.
    pub fallback: u32,
}

impl Budget {
    /// Evaluations of residual and Jacobian that a block costs at most: those of Newton's method, the trials of the
    /// fallback and one where it starts.
    ///
    /// Beside them a step costs three factorisations of Φ_q and five linear solutions at most.
    pub const fn evaluations(self) -> u32 {
        let newton = if self.newton == 0 { 1 } else { self.newton };
        match self.fallback {
            0 => newton,
            trials => newton.saturating_add(trials).saturating_add(1),
        }
    }
}

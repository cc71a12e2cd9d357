//! Readings of a mechanism in motion.

use crate::dynamics::analyses::determinacy::Determinacy;
use crate::dynamics::equilibrium::consistent_start::MovedStart;
use crate::dynamics::formulations::singular::limit_rows::is_at_limit;
use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::{Counts, MethodWarning};
use crate::dynamics::simulation::Simulation;
use crate::failure::Failure;
use crate::mechanism::dynamic::{Dynamic, DynamicState, Energy};
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Balance of a run so far: energy that is not accounted for, and rows that are violated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R> {
    /// Kinetic and potential energy (J).
    pub energy: Energy<R>,
    /// Work of forces and drives since the start (J).
    pub work: R,
    /// Energy less work less the energy at the start (J): 0 of an exact integration.
    pub defect: R,
    /// Largest |Φᵢ| over its row's scale: about the distance (rad, or reference lengths) from where it holds.
    pub phi: R,
    /// Largest |Φ̇ᵢ| over its row's scale (1/s).
    pub phi_d: R,
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Time (s).
    pub fn t(&self) -> R {
        self.now.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[R; N] {
        &self.now.y.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[R; N] {
        &self.now.y.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[R; N] {
        &self.now.solved.rate.qd
    }

    /// Multipliers λ: M; a row's force on the coordinates is −Φ_qᵀ λ. Where rows follow from others they are one choice of
    /// many, see [`determinacy`](Self::determinacy).
    pub fn lambda(&self) -> &[R; M] {
        &self.now.solved.lambda
    }

    /// First-order states of the text.
    pub fn states(&self) -> &S::States {
        &self.now.y.states
    }

    /// State, rates and multipliers together.
    pub fn instant(&self) -> &Instant<R, N, M, S::States> {
        &self.now
    }

    /// Margin of Φ_q to a loss of rank: 0 at the loss, at most 1. Where steps go through blocks of the rows, all rows are factorized
    /// for it at the call.
    pub fn margin(&self) -> R {
        let Instant { t, y, solved, .. } = &self.now;
        let of_rows = if S::IS_PARTITIONED { self.model().margin_of_rows(*t, y) } else { None };
        of_rows.unwrap_or(solved.margin)
    }

    /// First approach of the run to a singular position that it may have passed.
    pub fn passage(&self) -> Option<&Passage<R>> {
        self.passage.as_ref()
    }

    /// Entry of the start that differs most from its declared or given value; `None` where all are kept to nine digits.
    ///
    /// Of [`start_from_text`](Self::start_from_text) the entries that the text declares by `start` count, of
    /// [`start_near`](Self::start_near) all coordinates and rates.
    pub fn moved_start(&self) -> Option<&MovedStart<R>> {
        self.moved_start.as_ref()
    }

    /// The mechanism with its parameters and inputs.
    pub fn mechanism(&self) -> &S {
        &self.mechanism
    }

    /// Evaluations, steps and iterations of the run.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Warning about steps of `h` (s) from the start until now.
    pub fn doubt(&self, h: R) -> Option<MethodWarning> {
        if self.rank_rises && self.method.leaves_constraints() {
            return Some(MethodWarning::RisingRank);
        }
        self.method.doubt(h, self.now.t - self.start)
    }

    /// Outputs with their time derivatives.
    pub fn outputs(&self) -> S::Outputs {
        let position = self.model().position(self.now.t, &self.now.y);
        self.mechanism.outputs(&self.parameters, &position, self.qd(), self.qdd())
    }

    /// Outputs that use multipliers or states: reactions, efforts.
    pub fn loads(&self) -> S::Loads {
        let position = self.model().position(self.now.t, &self.now.y);
        let motion = DynamicState {
            qd: self.qd(),
            qdd: self.qdd(),
            lambda: self.lambda(),
            states: &self.now.y.states,
        };
        if const { S::SET_VALUED.is_empty() } {
            return self.mechanism.loads(&self.parameters, &position, &motion);
        }
        self.mechanism.loads(&self.parameters_with_forces(), &position, &motion)
    }

    /// Values of parameters at the present instant, with the directions of frictions that slide and the forces of those that stick.
    pub fn parameters_with_forces(&self) -> S::Parameters {
        let (model, Instant { t, y, .. }) = (self.model(), &self.now);
        model.with_set_valued_forces(&model.position(*t, y), y, (self.qdd(), self.lambda()))
    }

    /// Multipliers that are unique, and rows that follow from others, at the present position. Where a motion passes a
    /// singular position, multipliers of rows that lose their hold grow without bound. They are not unique there, and
    /// [`lambda`](Self::lambda) is without their undefined part.
    ///
    /// # Errors
    /// Those of [`Determinacy::of`].
    pub fn determinacy(&self) -> Result<Determinacy<R, M>, Failure> {
        let position = self.model().position(self.now.t, &self.now.y);
        let (t, y, margin) = (self.now.t, &self.now.y, self.now.solved.margin);
        let model = self.model();
        let passing =
            margin < singular::ZONE_OF_FORCES.of() && is_at_limit(&model, (t, y), self.lambda(), margin);
        let weakest = passing.then_some(singular::LIMIT_ROWS.of());
        Determinacy::measured(&self.mechanism, &self.parameters, &position, (t, &self.metric), weakest)
    }

    /// Marks in `unique`, one of each of [`loads`](Self::loads), those that are the same for every choice of the
    /// multipliers.
    ///
    /// # Errors
    /// Those of [`Determinacy::of`].
    pub fn mark_unique_loads(&self, unique: &mut [bool]) -> Result<(), Failure> {
        let position = self.model().position(self.now.t, &self.now.y);
        let found = self.determinacy()?;
        let motion = DynamicState {
            qd: self.qd(),
            qdd: self.qdd(),
            lambda: self.lambda(),
            states: &self.now.y.states,
        };
        found.mark_loads(&self.mechanism, &self.parameters_with_forces(), &position, &motion, unique);
        Ok(())
    }

    /// Energy balance and constraint norms.
    pub fn balance(&self) -> Balance<R> {
        let model = self.model();
        let Instant { t, y, .. } = &self.now;
        let position = model.position(*t, y);
        let energy = self.mechanism.energy(&self.parameters, &position, &y.qd);
        let largest = |values: [R; M]| {
            let over = values.iter().zip(&self.metric.rows).map(|(value, scale)| (*value / *scale).abs());
            over.fold(R::constant(0.0), |largest, value| largest.max(value))
        };
        Balance {
            energy,
            work: y.work,
            defect: energy.kinetic + energy.potential - y.work - self.reference,
            phi: largest(self.mechanism.phi(&self.parameters, &position)),
            phi_d: largest(model.constraint_rates(&position, &y.qd)),
        }
    }
}

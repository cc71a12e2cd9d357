//! A motion that goes on in another scene of its text.

use core::fmt;

use crate::dynamics::model::method::Method;
use crate::dynamics::simulation::{Origin, Simulation};
use crate::failure::Failure;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// A motion in another scene, and what it has of the motion before.
#[derive(Clone, Copy)]
pub struct Continued<S, X, R, const N: usize, const M: usize>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    /// The motion, at the same time.
    pub run: Simulation<S, X, R, N, M>,
    /// `true` for each coordinate that came over with its rate; the others begin next to the guess and start rates of the text: N.
    pub coordinates: [bool; N],
    /// Number of first-order states that came over; the others begin as they are declared.
    pub states: usize,
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    /// The motion from here on in another scene: `mechanism`, as `scene()` of this one gives it. The time, coordinates with their rates and
    /// first-order states come over, by their names and units, and the tolerances of steps and positions.
    ///
    /// Coordinates that are new meet the rows, the shortest way from the guess of the text. Rates that new rows contradict change as in an
    /// inelastic impact: by impulses of these rows alone, so that a momentum that they do not touch stays.
    /// [`moved_start`](Self::moved_start) of the new run has the largest change. Energy balance, counts, modes of contacts and frictions, events and latched
    /// values are those of a run that starts there.
    ///
    /// ```
    /// use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation};
    /// use mbs_runtime::mechanism;
    ///
    /// mechanism! {
    ///     /// Two rotors that a clutch couples.
    ///     pub mechanism Drive;
    ///     param closed_at: rad = 0;
    ///     coord a: rad = 0;
    ///     coord b: rad = 0;
    ///     body motor { mass: 4, com: [0, 0], inertia: 2, angle: a }
    ///     body load { mass: 2, com: [0, 0], inertia: 1, angle: b }
    ///     start a = 0 rate 30;
    ///     start b = 0 rate 0;
    ///     effect slip { out slip: rad/s = der(a) - der(b); }
    ///     effect clutch { constraint closed { a - b == closed_at; } }
    ///     scene Open = slip;
    ///     scene Closed = clutch;
    /// }
    ///
    /// let method = Explicit::new(RungeKutta4, Projection::default());
    /// let mut open = Simulation::start_from_text(DriveOpen::default(), method, 0.0_f64)?;
    /// open.step_to(0.1, 10)?;
    /// let mut closed: DriveClosed = open.mechanism().scene();
    /// closed.closed_at = open.q()[0] - open.q()[1];
    /// let after = open.continue_as(closed, method)?;
    /// assert!((after.run.qd()[1] - 20.0).abs() < 1e-12); // 2·30 = (2 + 1)·20
    /// # Ok::<(), mbs_runtime::Failure>(())
    /// ```
    ///
    /// # Errors
    /// [`OffConstraints`](crate::FailureKind::OffConstraints) where new coordinates cannot meet the rows of the positions that came over, and otherwise those of
    /// [`start`](Self::start).
    pub fn continue_as<B, Y, const K: usize, const L: usize>(
        &self,
        mechanism: B,
        method: Y,
    ) -> Result<Continued<B, Y, R, K, L>, Failure>
    where
        B: Dynamic<R, K, L>,
        Y: Method<B, R, K, L>,
    {
        let (t, y) = (self.now.t, &self.now.y);
        let parameters = mechanism.parameters();
        let (mut q, mut qd) = (mechanism.guess(&parameters), mechanism.start_rates(&parameters));
        let (mut coordinates, mut carried, mut count) = ([false; K], [0_u16; K], 0);
        let places = q.iter_mut().zip(&mut qd).zip(&mut coordinates).zip(B::COORDINATES).zip(0..);
        for ((((q, qd), comes), entry), index) in places {
            let Some(from) = namesake(S::COORDINATES, entry) else { continue };
            if let (Some(place), Some(rate)) = (y.q.get(from), y.qd.get(from)) {
                (*q, *qd, *comes) = (*place, *rate, true);
                carried.iter_mut().skip(count).take(1).for_each(|slot| *slot = index);
                count += 1;
            }
        }
        let mut states = 0;
        let set = |values: &mut B::States| {
            for (value, entry) in values.as_mut().iter_mut().zip(B::STATES) {
                let from = namesake(S::STATES, entry).and_then(|from| y.states.as_ref().get(from));
                if let Some(from) = from {
                    (*value, states) = (*from, states + 1);
                }
            }
        };
        let carried = carried.get(..count).unwrap_or_default();
        let run = Simulation::starting(mechanism, method, t, (q, qd), (Origin::Carried, carried, set))?;
        let Simulation { balanced, tolerance, position_tolerance, .. } = *self;
        Ok(Continued {
            run: Simulation { balanced, tolerance, position_tolerance, ..run },
            coordinates,
            states,
        })
    }
}

impl<S, X, R, const N: usize, const M: usize> fmt::Debug for Continued<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    Simulation<S, X, R, N, M>: fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Continued { run, coordinates, states } = self;
        let mut whole = f.debug_struct("Continued");
        whole.field("run", run).field("coordinates", coordinates).field("states", states).finish()
    }
}

/// Index of the entry with the same name and unit.
fn namesake(entries: &[Entry], entry: &Entry) -> Option<usize> {
    entries.iter().position(|other| other.name == entry.name && other.unit == entry.unit)
}

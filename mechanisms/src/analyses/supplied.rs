//! The powers that forces, drives and the time supply in one instant.

use mbs_runtime::{Dynamic, Motion};

use crate::motion::Forces;
use crate::supplies::Supplier;

/// Adds the powers of an instant to `forces`: of each force, λ Φ_t of each row, and what the time gives by itself; together
/// the rate of kinetic and potential energy.
pub(crate) fn push<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    forces: &mut Forces,
    mechanism: &S,
    (parameters, position): (&S::Parameters, &S::Position),
    motion: &Motion<'_, f64, N, M, S::States>,
) {
    let Motion { qd, qdd, lambda, states } = *motion;
    let powers = mechanism.powers(parameters, position, qd, states, lambda);
    let moving = mechanism.phi_t(parameters, position);
    let carried = mechanism.carried(parameters, position, qd, qdd);
    let of_forces = S::FORCES.iter().zip(powers.as_ref());
    let of_forces = of_forces.map(|(force, power)| (force.name, Supplier::Force, *power));
    let of_rows = S::ROWS.iter().zip(lambda.iter().zip(&moving));
    let of_rows = of_rows.map(|(row, (lambda, rate))| (row.name, Supplier::Drive, lambda * rate));
    let of_time = carried.map(|power| ("the time", Supplier::Time, power));
    forces.push_supplies(of_forces.chain(of_rows).chain(of_time));
}

#[cfg(test)]
mod tests {
    use crate::motion::{Forces, Motion};
    use crate::reference::dynamics_of;
    use crate::registry::{FreeCard, instants};
    use crate::{car_axis, four_bar_mass, quarter_car};

    /// Part of the largest power that may be missing: what differences of the energy over instants leave, of which there are
    /// some hundred in the shortest period.
    const BOUND: f64 = 1e-5;

    fn forces(motion: &Motion) -> &Forces {
        motion.dynamics.as_ref().expect("it has masses")
    }

    fn largest(values: impl Iterator<Item = f64>) -> f64 {
        values.fold(0.0, |largest, value| largest.max(value.abs()))
    }

    /// The powers of each instant add up to the rate of kinetic and potential energy, by differences of order 4.
    #[track_caller]
    fn assert_powers_change_the_energy(motion: &Motion) {
        let found = forces(motion);
        let energy: Vec<f64> = found.kinetic.iter().zip(&found.potential).map(|(t, v)| t + v).collect();
        let scale = largest(found.supplies.iter().flat_map(|supply| supply.power.iter().copied()));
        let h = motion.time[1] - motion.time[0];
        for k in 2..energy.len() - 2 {
            let rate =
                (energy[k - 2] - 8.0 * energy[k - 1] + 8.0 * energy[k + 1] - energy[k + 2]) / (12.0 * h);
            let sum: f64 = found.supplies.iter().map(|supply| supply.power[k]).sum();
            assert!((sum - rate).abs() < BOUND * scale, "at {} s: {sum} W of {rate} W", motion.time[k]);
        }
    }

    fn released(card: &FreeCard) -> Motion {
        dynamics_of(card, &card.runs[0], 3000).motion
    }

    fn driven() -> Motion {
        let mechanism = four_bar_mass::DRIVEN.instance(&four_bar_mass::DRIVEN.runs[0]).expect("its preset");
        let times = instants(1.0, 2000);
        let mut motion = mechanism.follow(&times, &mut |_| ()).expect("it turns");
        mechanism.dynamics().expect("it has masses").add_forces(&mut motion).expect("it is regular");
        motion
    }

    #[test]
    fn powers_are_the_rate_of_kinetic_and_potential_energy() {
        for motion in [released(&quarter_car::CARD), released(&car_axis::CARD), driven()] {
            assert!(forces(&motion).supplies.iter().any(|supply| !supply.is_idle()));
            assert_powers_change_the_energy(&motion);
        }
    }

    #[test]
    fn works_of_the_parts_are_the_work_that_is_integrated_with_the_motion() {
        for card in [&quarter_car::CARD, &car_axis::CARD] {
            let motion = released(card);
            let found = forces(&motion);
            let scale = largest(found.work.iter().copied());
            for (k, work) in found.work.iter().enumerate() {
                let sum: f64 = found.supplies.iter().map(|supply| supply.work[k]).sum();
                assert!((sum - work).abs() < BOUND * scale, "{}: {sum} J of {work} J", card.name);
            }
        }
    }

    #[test]
    fn the_work_of_a_drive_is_what_the_energy_changes_by() {
        let motion = driven();
        let found = forces(&motion);
        let motor = found.supplies.iter().find(|supply| !supply.is_idle()).expect("a drive");
        assert_eq!(motor.title(), "drive crank_drive");
        assert!(largest(found.defect.iter().copied()) < BOUND * largest(motor.work.iter().copied()));
        // Effort times speed.
        let effort = crate::reference::load(&motion, "motor_torque");
        let speed = &motion.coordinates.iter().find(|curve| curve.name == "phi1").expect("the crank").qd;
        let pairs = motor.power.iter().zip(effort.iter().zip(speed));
        pairs.for_each(|(power, (effort, speed))| assert!((power - effort * speed).abs() < 1e-9));
    }
}

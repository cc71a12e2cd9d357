//! Powers and works of forces and drives of ready mechanisms.

use crate::reference::dynamics_of;
use mbs_workbench::card::Card;
use mbs_workbench::erased::dynamics::direct_dynamics::{
    Approach, Implicit, ImplicitMethod, Pair, Stabilization, Steps,
};
use mbs_workbench::motion::instants;
use mbs_workbench::motion::power_balance::{PowerCurve, PowerSource};
use mbs_workbench::motion::{Forces, Motion};
use mechanisms::{car_axis, door_with_closer, four_bar_mass, governor, quarter_car, slider_crank_mass};

/// Part of the largest power that may be missing: the error of energy differences over instants, some hundred in the shortest
/// period.
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
        let rate = (energy[k - 2] - 8.0 * energy[k - 1] + 8.0 * energy[k + 1] - energy[k + 2]) / (12.0 * h);
        let sum: f64 = found.supplies.iter().map(|supply| supply.power[k]).sum();
        assert!((sum - rate).abs() < BOUND * scale, "at {} s: {sum} W of {rate} W", motion.time[k]);
    }
}

fn released(card: &Card) -> Motion {
    dynamics_of(card, 0, 3000).motion
}

fn driven() -> Motion {
    let mechanism = four_bar_mass::DRIVEN
        .fixed_instance(&four_bar_mass::DRIVEN.runs().expect("a text")[0])
        .expect("its preset");
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

/// The motion of `card`'s run over `span` (s) in `count` instants, by the default method of `mbs run`.
fn moved(card: &Card, run: usize, stabilization: Stabilization, span: f64, count: usize) -> Motion {
    let mechanism = card.instance(&card.runs().expect("a text")[run]).expect("parameters of the preset");
    let steps = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-10 };
    let dynamics = mechanism.dynamics().expect("it has masses");
    let approach = Approach { stabilization, steps };
    let found = dynamics.simulate(&approach, &instants(span, count), &mut |_| ()).expect("it starts");
    assert_eq!(found.failure, None, "{}", card.name());
    found.motion
}

/// Largest difference between the sum of the works and the work integrated for all, as a part of the largest of them. It is the
/// rounding of a few thousand sums, as both are the same quadrature.
const ROUNDING: f64 = 1e-12;

#[track_caller]
fn assert_the_parts_add_up(motion: &Motion) {
    let found = forces(motion);
    let parts = found.supplies.iter().flat_map(|supply| &supply.work);
    let scale = largest(found.work.iter().chain(parts).copied());
    assert!(scale > 0.0);
    for (k, work) in found.work.iter().enumerate() {
        let sum: f64 = found.supplies.iter().map(|supply| supply.work[k]).sum();
        assert!((sum - work).abs() < ROUNDING * scale, "at {} s: {sum} J of {work} J", motion.time[k]);
    }
}

#[test]
fn works_of_the_parts_are_the_work_that_is_integrated_with_the_motion() {
    let implicit = |method| Stabilization::Implicit(Implicit { method, longest: 2.5e-3 });
    for card in [&quarter_car::CARD, &car_axis::CARD] {
        for by in [
            Stabilization::Projection,
            Stabilization::Velocity,
            implicit(ImplicitMethod::AugmentedLagrangian),
            implicit(ImplicitMethod::Extrapolated),
            implicit(ImplicitMethod::GeneralizedAlpha),
        ] {
            assert_the_parts_add_up(&moved(card, 0, by, 0.2, 4));
        }
    }
}

/// A transient of 0.04 ms at the start, which instants of 14 ms do not show.
#[test]
fn works_are_those_of_the_steps_and_not_of_the_instants() {
    let method = ImplicitMethod::Extrapolated;
    let by = Stabilization::Implicit(Implicit { method, longest: 1e-3 });
    let works = [1, 4].map(|count| {
        let motion = moved(&governor::CARD, 0, by, 0.056, count);
        assert_the_parts_add_up(&motion);
        forces(&motion).supplies.iter().map(PowerCurve::total).collect::<Vec<f64>>()
    });
    let scale = largest(works[0].iter().copied());
    for (once, often) in works[0].iter().zip(&works[1]) {
        assert!((once - often).abs() < 1e-9 * scale, "{once} J, {often} J");
    }
}

#[test]
fn a_constant_torque_times_its_angle_is_its_work_whatever_the_instants() {
    for count in [3, 60] {
        let motion = moved(&slider_crank_mass::RELEASED, 1, Stabilization::Velocity, 1.0, count);
        let theta = &motion.coordinates[0].q;
        let turned = theta.last().expect("an end") - theta[0];
        let work = forces(&motion).supplies[0].total();
        assert!((work - 0.5 * turned).abs() < 1e-6 * work.abs(), "{work} J over {turned} rad");
    }
}

/// A latch that breaks within a millisecond: from the play of 3 mm its spring of 3e5 N/m is drawn to 60 N.
#[test]
fn a_force_that_acts_between_two_instants_has_its_work() {
    let torn = door_with_closer::CARD.runs().expect("presets").iter().position(|run| run.label == "torn");
    for count in [1, 5, 60] {
        let motion =
            moved(&door_with_closer::CARD, torn.expect("a preset"), Stabilization::Projection, 6.0, count);
        assert_the_parts_add_up(&motion);
        let bolt = forces(&motion).supplies.iter().find(|supply| supply.name == "bolt").expect("the latch");
        assert!((bolt.total() + 60.0 * 60.0 / (2.0 * 3e5)).abs() < 1e-9, "{count}: {} J", bolt.total());
    }
}

#[test]
fn rows_that_depend_on_the_time_are_named_by_what_they_are() {
    let motion = moved(&car_axis::CARD, 0, Stabilization::Projection, 0.1, 4);
    let acting =
        forces(&motion).supplies.iter().find(|supply| supply.by != PowerSource::Force && !supply.is_idle());
    assert_eq!(acting.expect("the road").title(), "constraint across");
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

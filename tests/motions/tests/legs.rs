//! Both references of `mbs cost` against closed forms and published digits of the ready mechanisms.
#![forbid(unsafe_code)]

use std::time::Duration;

use mbs_runtime::Scalar;
use mbs_workbench::card::Card;
use mbs_workbench::comparable;
use mbs_workbench::cost::kinematics::driven_study;
use mbs_workbench::cost::reference::{Leg, reference};
use mbs_workbench::cost::third_leg::{Followed, ThirdLeg};
use mbs_workbench::double_double::DoubleDouble;
use mbs_workbench::erased::costs::Comparable;
use mbs_workbench::known_motion::KnownStates;
use mbs_workbench::setting::Kernel;
use mechanisms::andrews::{self, Andrews};
use mechanisms::car_axis::{self, CarAxis};
use mechanisms::four_bar::{self, FourBar};
use mechanisms::heavy_top::{self, HeavyTop};
use mechanisms::n_four_bar::{self, NFourBar};
use mechanisms::n_four_bar_1::{self, NFourBar1};
use mechanisms::pendulum::{self, Pendulum};
use mechanisms::slider_crank::{self, SliderCrank};

/// Instants of a comparison.
const PARTS: u32 = 120;

fn known(card: &Card, until: f64) -> KnownStates {
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let known = card.known.and_then(|known| known.states(card.equations().as_ref(), false, &times));
    known.expect("a third leg")
}

/// Both legs of a motion to `until` (s) with steps of `tolerance`, against the card's third leg.
fn agree(card: &Card, compared: Comparable, until: f64, tolerance: f64) {
    let Comparable::Moved(mut mechanism) = compared else { panic!("forces move it") };
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let (_, runs) = &mechanism.runs[0];
    let [q, qd] = runs.start(0.0).expect("a start");
    let scales = mechanism.exact.scales();
    let known = known(card, until);
    for leg in [Leg::Extrapolated, Leg::Collocated] {
        let exact = mechanism.exact.as_mut();
        let found = reference(exact, leg, (&q, &qd), &times, tolerance, Duration::from_secs(600));
        assert_eq!(found.stuck, None, "{}: {leg:?}", card.name());
        let instants = found.shots.iter().map(|shot| (shot.at.t.high, &*shot.at.q, &*shot.at.qd)).collect();
        let followed = [Followed { name: leg.name(), instants }];
        let third = ThirdLeg::of(&known, &followed, &scales, None);
        println!("{}: {}", card.name(), third.words());
        assert_eq!(third.contradiction(), None, "{}", card.name());
    }
}

#[test]
fn both_legs_have_the_digits_of_closed_forms() {
    agree(&pendulum::CARD, comparable!(Pendulum::default())(&[]), 10.0, 1e-16);
    agree(&n_four_bar_1::CARD, comparable!(NFourBar1::default())(&[]), 0.7, 1e-16);
    agree(&n_four_bar::CARD, comparable!(NFourBar::default())(&[]), 0.7, 1e-16);
}

#[test]
fn both_legs_have_the_published_digits() {
    agree(&andrews::CARD, comparable!(Andrews::default())(&[]), 0.03, 1e-14);
    agree(&car_axis::CARD, comparable!(CarAxis::default())(&[]), 3.0, 1e-14);
    agree(&heavy_top::CARD, comparable!(HeavyTop::default())(&[]), 2.0, 1e-14);
}

#[test]
fn positions_of_drives_are_those_of_closed_forms() {
    let cards = [
        (&four_bar::CARD, comparable!(FourBar::default())(&[]), 1.0),
        (&slider_crank::CARD, comparable!(SliderCrank::default())(&[]), 0.2),
    ];
    for (card, compared, until) in cards {
        let Comparable::Driven(mut mechanism) = compared else { panic!("a drive moves it") };
        let study =
            driven_study(&mut mechanism, (until, 0.01), Kernel::Own, &mut |_, _| ()).expect("a reference");
        let instants = || study.motion.iter().map(|(t, [q, qd])| (*t, &**q, &**qd));
        let third = |instants| {
            let followed = [Followed { name: "reference", instants }];
            ThirdLeg::of(&known(card, until), &followed, &study.scales, study.width_of_positions)
        };
        let right = third(instants().collect());
        println!("{}: {}", card.name(), right.words());
        assert_eq!(right.contradiction(), None, "{}", card.name());
        // A reference that is 1e-11 beside it contradicts.
        let off =
            |q: &[DoubleDouble]| q.iter().map(|q| *q + DoubleDouble::constant(1e-11)).collect::<Vec<_>>();
        let beside: Vec<_> = instants().map(|(t, q, qd)| (t, off(q), qd)).collect();
        let beside = beside.iter().map(|(t, q, qd)| (*t, &**q, *qd)).collect();
        assert!(third(beside).contradiction().is_some(), "{}", card.name());
    }
}

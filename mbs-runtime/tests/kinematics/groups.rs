//! Lanes that are computed in groups, as they are where several blocks follow each other.

use mbs_runtime::{Batch, Failure, FailureKind, Kinematic, Lanes, Mechanism, Scalar, Stepper, mechanism};

use crate::batch::assert_as_alone;

mechanism! {
    /// A four-bar and a dyad on its coupler, turned at a prescribed rate.
    mechanism SixBar;
    param r: m = 50mm;
    param omega: rad/s = 6;
    coord theta: rad = 0;
    coord alpha: rad = 1.1;
    coord beta: rad = 0.16;
    coord gamma: rad = 1.7;
    coord delta: rad = 0;
    let a = 250mm*unit(alpha);
    constraint four_bar { a + 150mm*unit(beta) == [300mm, 0] + 250mm*unit(gamma); }
    constraint rod { [-150mm, 160mm] + r*unit(theta) + 300mm*unit(delta) == a + rot(beta)*[75mm, -80mm]; }
    drive crank: rate(theta) == omega;
    branch open: sin(gamma - beta) > 0;
}

mechanism! {
    /// Ten loops, an input beside the first.
    mechanism Chain;
    const LOOPS: 1 = 10;
    input x: m, rates;
    coord p: [m; LOOPS + 1, 2] = 0.7;
    drive motor: p[0, 0] == x + 0.5m*sin(TAU*t/1s);
    constraint uprights { for i in 0..LOOPS + 1 { p[i, 0]^2 + p[i, 1]^2 == (1m)^2; } }
    constraint couplers {
        for i in 0..LOOPS { (1m + p[i + 1, 0] - p[i, 0])^2 + (p[i + 1, 1] - p[i, 1])^2 == (1m)^2; }
    }
}

mechanism! {
    /// A plate on two bars, its tip on a dyad: rates of a large block, eliminated in an order of its own, go before those of a dyad.
    mechanism Plates;
    param omega: rad/s = TAU;
    coord theta: rad = 0;
    coord x: [1; 4] = 0.5;
    coord p: [1; 2] = [0.6, 0.8];
    drive motor: theta == omega*t;
    constraint ring { for i in 0..3 { x[i] + 0.2*sin(x[i + 1]) == sin(theta + i); } }
    constraint last { x[3] + 0.2*sin(x[0]) == cos(theta); }
    constraint tip { dot(p, p) == 1; 2*p[0] + p[1]*p[1] == 1.84 + 0.1*x[0]; }
}

type Eight = Lanes<f64, 8>;

const GUESS: [f64; 5] = [0.0, 1.1, 0.16, 1.7, 0.0];

/// Round-off of the accelerations, relative.
const ROUND_OFF: f64 = 1e-11;

fn designs() -> SixBar<Eight> {
    SixBar {
        r: Lanes([0.05, 0.04, 0.03, 0.045, 0.035, 0.02, 0.01, 0.05]),
        omega: Lanes([6.0, -5.0, 4.0, 3.0, 6.0, 2.0, 7.0, -6.0]),
        ..SixBar::default()
    }
}

fn upright<const N: usize>() -> [f64; N] {
    core::array::from_fn(|k| (k % 2) as f64)
}

#[test]
fn lanes_in_groups_go_as_each_alone() {
    assert_as_alone::<_, f64, 5>(designs(), GUESS, ROUND_OFF);
    assert_as_alone::<_, f64, 22>(Chain::default(), upright(), ROUND_OFF);
    assert_as_alone::<_, f64, 7>(Plates::default(), [0.0, 0.0, 0.7, 0.7, 0.8, 0.7, 0.7], ROUND_OFF);
    assert_as_alone::<_, f32, 5>(SixBar::default(), GUESS, 1e-4);
}

/// Any number of lanes, those of no whole number of groups too, go as one alone.
fn go_as_one<const L: usize>() {
    let batch = Batch::assemble(SixBar::<Lanes<f64, L>>::default(), &[GUESS; L], [0.0; L]);
    let mut batch = batch.map_err(|(_, failure)| failure).expect("they assemble");
    let mut alone = Stepper::assemble(SixBar::default(), GUESS, 0.0).expect("it assembles");
    for k in 1..=50 {
        let t = 2e-3 * f64::from(k);
        assert!(batch.advance_to([t; L]).iter().all(Result::is_ok), "{L} lanes");
        alone.advance_to(t).expect("it moves on");
    }
    for (found, expected) in batch.qdd().iter().zip(alone.qdd()) {
        let off = found.0.map(|found| (found - expected).abs() / (1.0 + expected.abs()));
        assert!(off.iter().all(|off| *off < ROUND_OFF), "{L} lanes: {off:?}");
    }
}

#[test]
fn any_number_of_lanes_goes_as_one_alone() {
    go_as_one::<1>();
    go_as_one::<2>();
    go_as_one::<3>();
    go_as_one::<4>();
    go_as_one::<6>();
    go_as_one::<16>();
}

#[test]
fn a_lane_of_a_group_fails_alone_and_goes_on_when_it_is_put_right() {
    let assembled = Batch::assemble(designs(), &[GUESS; 8], [0.0; 8]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("they assemble");
    assert!(batch.advance_to([0.01; 8]).iter().all(Result::is_ok));
    batch.change(|mechanism| mechanism.r.0[3] = 5.0);
    let before = [batch.q(), batch.qd(), batch.qdd()].map(|values| values.map(|value| value.0[3]));
    let steps = batch.advance_to([0.02; 8]);
    assert!(
        matches!(steps[3], Err(Failure { kind: FailureKind::NotConverged { .. }, .. })),
        "{:?}",
        steps[3]
    );
    assert!((0..8).filter(|lane| *lane != 3).all(|lane| steps[lane].is_ok()), "{steps:?}");
    let after = [batch.q(), batch.qd(), batch.qdd()].map(|values| values.map(|value| value.0[3]));
    assert_eq!((after, batch.t().0), (before, [0.02, 0.02, 0.02, 0.01, 0.02, 0.02, 0.02, 0.02]));
    // Out, it costs its neighbour nothing: all others take their steps as if it were not there.
    batch.retire(3, steps[3].expect_err("it is too long"));
    for k in 3..=20 {
        let steps = batch.advance_to([0.01 * f64::from(k); 8]);
        assert!((0..8).all(|lane| steps[lane].is_ok() == (lane != 3)), "{steps:?}");
    }
    // Groups have the changed parameters.
    batch.change(|mechanism| mechanism.r = designs().r);
    batch.revive(3, &GUESS, 0.2).expect("it closes again");
    for k in 21..=30 {
        assert!(batch.advance_to([0.01 * f64::from(k); 8]).iter().all(Result::is_ok));
    }
    for lane in (0..8).filter(|lane| *lane != 3) {
        let mut alone = Stepper::assemble(designs().lane(lane), GUESS, 0.0).expect("it assembles");
        (1..=30).for_each(|k| {
            alone.advance_to(0.01 * f64::from(k)).expect("it moves on");
        });
        for (found, expected) in batch.qdd().iter().zip(alone.qdd()) {
            let off = (found.0[lane] - expected).abs() / (1.0 + expected.abs());
            assert!(off < 1e-9, "lane {lane}: {} {expected}", found.0[lane]);
        }
    }
}

#[test]
fn a_group_has_the_designs_inputs_and_phases_of_its_lanes() {
    let mut designs = designs();
    let mut phases = Mechanism::<Eight, 5, 5>::phases(&designs);
    for phase in &mut phases {
        phase.value = Lanes([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
    Mechanism::<Eight, 5, 5>::set_phases(&mut designs, phases);
    for first in [0, 2, 4] {
        let group = Kinematic::<Eight, 5>::group(&designs, first);
        let of_group = group.phases();
        for lane in 0..group.r.0.len().min(8 - first) {
            assert_eq!(group.r.lane(lane), designs.r.0[first + lane]);
            assert_eq!(group.omega.lane(lane), designs.omega.0[first + lane]);
            assert_eq!(of_group[0].value.lane(lane), (first + lane) as f64);
        }
    }
}

#[test]
fn lanes_are_read_from_numbers_and_written_to_them() {
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(Lanes::<f64, 2>::read(&numbers, 2).0, [3.0, 4.0]);
    assert_eq!(f64::read(&numbers, 4), 5.0);
    // The last number stands for those that there are not.
    assert_eq!(Lanes::<f64, 4>::read(&numbers, 3).0, [4.0, 5.0, 5.0, 5.0]);
    assert_eq!(Lanes::<f64, 2>::read(&[], 0).0, [0.0; 2]);
    let mut places = [0.0; 5];
    Lanes([1.0, 2.0]).write(&mut places, 1);
    Lanes([3.0, 4.0, 5.0]).write(&mut places, 3);
    6.0.write(&mut places, 0);
    assert_eq!(places, [6.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(Lanes(numbers).part::<Lanes<f64, 2>>(3).0, [4.0, 5.0]);
    assert_eq!(7.0.part::<Lanes<f64, 2>>(0).0, [7.0; 2]);
}

//! Several mechanisms side by side are each as alone.

use mbs_runtime::extent;
use mbs_runtime::{AssemblySolver, Kinematic, Lanes, Mechanism, Newton, Outcome, Scalar};

use crate::four_bar::FourBar;

type Four = Lanes<f64, 4>;

/// Four cranks of which the third is too long to be assembled.
fn mechanism() -> FourBar<Four, 0> {
    let mut mechanism = FourBar::reference(1.0);
    mechanism.lengths[0] = Lanes([0.1, 0.2, 5.0, 0.15]);
    mechanism.omega = Lanes([1.0, 2.0, 3.0, -1.0]);
    mechanism
}

fn start() -> [Four; 5] {
    [0.2, 0.3, 0.0, 0.9, 1.6].map(Four::constant)
}

#[test]
fn one_lane_fails_alone_and_the_others_equal_the_single_solver() {
    let mechanism = mechanism();
    let t = Lanes([0.3, 0.4, 0.5, 0.6]);
    let mut q = start();
    let scales = mechanism.coordinate_scales(&());
    let outcomes = mechanism.solve_blocks(&(), &mut q, t, &mut Newton::new(extent(&start(), &scales)));
    let mut assembled = start();
    let mut solver = AssemblySolver::new(extent(&start(), &scales));
    let assembly = mechanism.solve_blocks(&(), &mut assembled, t, &mut solver);
    for lane in 0..4 {
        let single = mechanism.lane(lane);
        let alone_start = start().map(|x| x.lane(lane));
        let alone_extent = extent(&alone_start, &single.coordinate_scales(&()));
        let mut alone = alone_start;
        let [outcome] = single.solve_blocks(&(), &mut alone, t.lane(lane), &mut Newton::new(alone_extent));
        assert_eq!(outcomes[lane], outcome);
        assert_eq!(outcome == Outcome::Converged, lane != 2);
        if lane != 2 {
            assert_eq!(q.map(|x| x.lane(lane)), alone);
        }
        let mut alone = alone_start;
        let mut solver = AssemblySolver::new(alone_extent);
        let [outcome] = single.solve_blocks(&(), &mut alone, t.lane(lane), &mut solver);
        assert_eq!(assembly[lane], outcome);
        if lane != 2 {
            assert_eq!(assembled.map(|x| x.lane(lane)), alone);
        }
    }
}

#[test]
fn a_lane_of_nan_fails_alone() {
    let mut mechanism = mechanism();
    mechanism.lengths[0] = Lanes([0.1, f64::NAN, 0.2, 0.15]);
    let mut q = start();
    let mut solver = Newton::new(Four::constant(0.0));
    let outcomes = mechanism.solve_blocks(&(), &mut q, Four::constant(0.3), &mut solver);
    assert_eq!(outcomes[1], Outcome::NonFinite { row: 2 });
    assert!([0, 2, 3].iter().all(|lane| outcomes[*lane] == Outcome::Converged));
}

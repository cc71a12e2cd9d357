//! Periodic cam laws.

use core::f64::consts::TAU;

use mbs_runtime::Function;
use mbs_runtime::driver::{Cycloid, Law, LawError, Polynomial345, Polynomial4567, Rise, Segment, Segments};

use crate::checks::{assert_continuity, assert_lanes_agree, assert_nan_stays, assert_single_precision};

/// Rise, dwell, return in two steps without a rest between, dwell; a turn from 0.25 on.
const PARTS: [Segment; 5] = [
    Segment::to(1.5, 1.5),
    Segment::dwell(2.5),
    Segment::to(0.75, 3.5),
    Segment::to(-0.5, 5.5),
    Segment::dwell(0.25 + TAU),
];

fn law<L: Law>() -> Segments<L, 5> {
    Segments::new(0.25, PARTS).expect("a law")
}

#[test]
fn a_segment_is_a_rise() {
    let law = law::<Polynomial4567>();
    let rises = [
        Rise::<Polynomial4567>::new(0.25, 1.25, -0.5, 1.5),
        Rise::new(2.5, 1.0, 1.5, 0.75),
        Rise::new(3.5, 2.0, 0.75, -0.5),
    ]
    .map(|rise| rise.expect("a rise"));
    let expected = |x: f64| -> [f64; 6] {
        let rise = if x < 2.0 {
            rises[0]
        } else if x < 3.5 {
            rises[1]
        } else {
            rises[2]
        };
        rise.jet(x)
    };
    for step in 0..200 {
        let x = 0.25 + TAU * f64::from(step) / 200.0;
        assert_eq!(law.jet::<6>(x), expected(x), "at {x}");
    }
}

#[test]
fn the_law_repeats_after_its_period() {
    let law = law::<Cycloid>();
    assert_eq!(law.period(), TAU);
    for step in 0..50 {
        let x = 0.3 + 0.12 * f64::from(step);
        for turns in [-1000.0, -1.0, 1.0, 1000.0] {
            let far = x + turns * TAU;
            let [here, there]: [[f64; 3]; 2] = [law.jet(x), law.jet(far)];
            for order in 0..3 {
                // The far argument is rounded: 1 ε of it, times derivatives below 100.
                assert!((here[order] - there[order]).abs() < 2e-10, "{x} {turns} {order}");
            }
        }
    }
}

#[test]
fn the_continuity_holds_at_every_segments_end() {
    // Rises and durations before and after each end.
    let ends = [
        (1.5, (2.0, 1.25), (0.0, 1.0)),
        (2.5, (0.0, 1.0), (-0.75, 1.0)),
        (3.5, (-0.75, 1.0), (-1.25, 2.0)),
        (5.5, (-1.25, 2.0), (0.0, 1.0)),
        (0.25 + TAU, (0.0, 1.0), (2.0, 1.25)),
        (0.25 - 3.0 * TAU, (0.0, 1.0), (2.0, 1.25)),
    ];
    for (place, before, after) in ends {
        let jump = |size: f64, order: i32, mirrored: f64| {
            size * (after.0 / f64::powi(after.1, order) - mirrored * before.0 / f64::powi(before.1, order))
        };
        assert_continuity(&law::<Polynomial345>(), place, jump(60.0, 3, 1.0));
        assert_continuity(&law::<Cycloid>(), place, jump(TAU * TAU, 3, 1.0));
        assert_continuity(&law::<Polynomial4567>(), place, jump(840.0, 4, -1.0));
    }
}

#[test]
fn breakpoints_are_the_ends_of_the_segments_of_every_turn() {
    let law = law::<Polynomial345>();
    let next = |x: f64| Function::<f64>::breakpoint_after(&law, x);
    for turn in [-2.0, 0.0, 5.0] {
        let shift = turn * TAU;
        let mut x = shift + 0.25 - 1e-3;
        for expected in [0.25, 1.5, 2.5, 3.5, 5.5, 0.25 + TAU, 1.5 + TAU] {
            let found = next(x).expect("there is always a next one");
            assert!(found > x && (found - shift - expected).abs() < 1e-13, "{x} {found} {expected}");
            x = found;
        }
    }
    assert_eq!(next(f64::INFINITY), None);
    assert_eq!(next(1e300), None, "the next turn is the same number");
}

#[test]
fn lanes_and_single_precision_agree() {
    let places: [f64; 60] = core::array::from_fn(|step| 0.27 * step as f64 - 3.0);
    for four in places.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]) {
        assert_lanes_agree(&law::<Polynomial345>(), four);
        assert_lanes_agree(&law::<Cycloid>(), four);
    }
    assert_lanes_agree(&law::<Polynomial4567>(), [f64::NAN, 1.0, 1e9, f64::INFINITY]);
    assert_single_precision(&law::<Polynomial4567>(), &places, [3.5, 15.0, 90.0, 700.0], 8.0);
    assert_nan_stays(&law::<Polynomial4567>());
}

#[test]
fn impossible_segments_are_named() {
    let refused = |parts: [Segment; 2]| Segments::<Cycloid, 2>::new(0.0, parts).err();
    assert_eq!(refused([Segment::dwell(1.0), Segment::dwell(2.0)]), Some(LawError::NoHeight));
    assert_eq!(refused([Segment::to(1.0, 1.0), Segment::to(0.0, 1.0)]), Some(LawError::SegmentEmpty(1)));
    assert_eq!(refused([Segment::to(1.0, -1.0), Segment::to(0.0, 1.0)]), Some(LawError::SegmentEmpty(0)));
    assert_eq!(
        refused([Segment::to(1.0, 1.0), Segment::to(f64::NAN, 2.0)]),
        Some(LawError::SegmentNotFinite(0)),
        "the first segment begins at the height that is not a number"
    );
    assert_eq!(
        refused([Segment::to(1.0, f64::NAN), Segment::dwell(1.0)]),
        Some(LawError::SegmentNotFinite(0))
    );
}

#[test]
fn a_law_can_be_a_constant() {
    const LAW: Segments<Polynomial345, 5> = match Segments::new(0.25, PARTS) {
        Ok(law) => law,
        Err(_) => panic!("the segments are in order"),
    };
    assert_eq!(LAW, law());
}

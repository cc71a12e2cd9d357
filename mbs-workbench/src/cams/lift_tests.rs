//! Continuity, ramps and refusals of lift laws.

use super::*;

fn degrees(values: [f64; 3]) -> [f64; 3] {
    values.map(f64::to_radians)
}

#[test]
fn every_law_has_the_continuity_that_it_states() {
    let mut laws: Vec<Lift> = FLANKS
        .iter()
        .map(|(_, flank)| Lift::flanks(*flank, 0.01, degrees([90.0, 30.0, 110.0])).expect("a law"))
        .collect();
    // Of a flank that lies between two angles of half a degree too.
    let short = FLANKS.iter().map(|(_, flank)| Lift::flanks(*flank, 1e-5, degrees([0.2, 90.0, 1.0])));
    laws.extend(short.map(|law| law.expect("a law")));
    for exponents in [&[2_u32, 4][..], &[2, 4, 6], &[2, 6, 8, 10], &[2, 6, 8, 10, 12]] {
        laws.push(Lift::hump(exponents, 0.011, 160_f64.to_radians()).expect("a law"));
    }
    for law in laws {
        let found = law.continuity();
        assert!(found.confirms(), "{law:?}: {found:?}");
        let ramped = law.clone().with_ramps(1e-4, 0.2).expect("ramps");
        assert!(ramped.continuity().confirms(), "{ramped:?}: {:?}", ramped.continuity());
        if law.order() > 2 {
            let corrected = law.with_polydyne(0.05).expect("a correction");
            assert!(corrected.continuity().confirms(), "{corrected:?}: {:?}", corrected.continuity());
        }
    }
}

#[test]
fn a_ramp_reaches_the_flank_with_its_velocity_and_the_dwell_is_zero() {
    let law = Lift::hump(&[2, 6, 8, 10, 12], 0.011, 160_f64.to_radians()).expect("a law");
    let open = -80_f64.to_radians();
    let ramped = law.with_ramps(1e-4, 0.2).expect("ramps");
    let velocity = 1e-4 / 0.2 / 0.75;
    assert!((ramped.jet::<f64>(open)[1] - velocity).abs() < 1e-15);
    assert!((ramped.jet(0.0_f64)[0] - 0.0111).abs() < 1e-16);
    assert!(ramped.jet(-3.0)[0] == 0.0 && ramped.jet(3.0_f64)[0].abs() < 1e-18);
    assert_eq!(ramped.jet(1.0_f64 + TAU)[0], ramped.jet(1.0 + TAU - TAU)[0]);
}

#[test]
fn numbers_that_no_law_has_are_refused() {
    assert!(Lift::hump(&[2, 4], 0.01, 7.0).is_err());
    assert!(Lift::hump(&[2, 4], f64::NAN, 1.0).is_err());
    assert!(Lift::flanks(Flank::Cycloid, 0.01, [1.0, -0.1, 1.0]).is_err());
    assert!(Lift::flanks(Flank::Cycloid, 0.01, [3.0, 3.0, 3.0]).is_err());
    let short = Lift::flanks(Flank::Polynomial345, 0.01, [1.0, 0.0, 1.0]).expect("a law");
    assert!(short.with_polydyne(0.1).is_err());
}

/// Of flanks that meet at full lift, with each law, ramps and a polydyne correction: at a joint is a value beside it, never a sum of both.
#[test]
fn at_a_joint_a_law_has_a_value_of_one_of_its_sides() {
    for (name, flank) in FLANKS {
        for dwell in [0.0, 30.0] {
            let law = Lift::flanks(flank, 0.01, degrees([90.0, dwell, 80.0])).expect("a law");
            let mut laws = vec![law.clone(), law.clone().with_ramps(1e-4, 0.2).expect("ramps")];
            laws.extend(law.with_polydyne(0.02));
            for law in laws {
                for joint in law.joints() {
                    let [before, at, after] =
                        [joint - 1e-9, joint, joint + 1e-9].map(|theta| law.jet::<f64>(theta));
                    for order in 0..4 {
                        let beside = [before, after].map(|side| (at[order] - side[order]).abs());
                        assert!(
                            beside[0].min(beside[1]) < 1e-6,
                            "{name} {dwell} at {joint}: {before:?} {at:?} {after:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn ranges_are_those_of_the_handbook() {
    // Peaks over L/β and L/β² in closed form.
    let beta = 90_f64.to_radians();
    let of = |flank| Lift::flanks(flank, 1.0, [beta, 0.0, beta]).expect("a law");
    let peaks = [
        (Flank::Harmonic, [0.5 * PI, 0.5 * PI * PI]),
        (Flank::Polynomial345, [1.875, 10.0 / 3_f64.sqrt()]),
        (Flank::Cycloid, [2.0, TAU]),
    ];
    for (flank, [velocity, acceleration]) in peaks {
        for (order, peak) in [(1, velocity / beta), (2, acceleration / (beta * beta))] {
            let [low, high] = of(flank).range(order);
            assert!(
                (low / -peak - 1.0).abs() < 1e-9 && (high / peak - 1.0).abs() < 1e-9,
                "{flank:?} {order}"
            );
        }
    }
}

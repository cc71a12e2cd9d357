//! The valvetrain with permanent contact, against its lift law.

use core::f64::consts::PI;

use mbs_runtime::Stepper;
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_workbench::cams::follower::Direction;
use mbs_workbench::cams::lift::{Flank, Lift};
use mbs_workbench::study::Values;

use mechanisms::desmo::motion::{Misfit, Turn, Valvetrain, against_law};
use mechanisms::desmo::study::STUDY;
use mechanisms::desmo::{Design, DesmoFriction};

#[test]
fn the_valve_moves_by_its_law_and_both_rockers_keep_their_distance() {
    let valve = || Design::law(0.011, 160_f64.to_radians()).expect("a law");
    // Of another law whose valve stays open for a while, half a turn behind the start of its rise.
    let dwelling = || Lift::flanks(Flank::Polynomial4567, 0.008, [1.3, 0.4, 1.4]).expect("a law");
    for (name, law) in [("even powers", valve()), ("4-5-6-7 with a dwell", dwelling())] {
        for direction in [Direction::CounterClockwise, Direction::Clockwise] {
            let design = Design::ready(law.clone(), direction);
            let compared = against_law(&design, &design.curves().expect("a pair of cams"), 0.0);
            let [lift, velocity, acceleration, apart] = compared.expect("permanent contact");
            println!(
                "desmo, {name}, {direction:?}: lift {lift:.1e} m, velocity {velocity:.1e} m/rad, \
                 acceleration {acceleration:.1e} m/rad^2, rockers {apart:.1e} m of 2e-12"
            );
            assert!(lift < 1e-14 && velocity < 1e-13 && acceleration < 1e-12 && apart < 2e-12);
        }
    }
}

#[test]
fn what_both_cams_contradict_each_other_by_is_the_mismatch_of_the_row_that_yields() {
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::Clockwise);
    let exact = design.curves().expect("a pair of cams");
    let [position, rate, acceleration] =
        Misfit::of(&design, &exact, 360, 0.3).expect("no contradiction").largest();
    assert!(
        position < 1e-15 && rate < 1e-14 && acceleration < 1e-13,
        "{position:e} {rate:e} {acceleration:e}"
    );
    let tables = exact.each_ref().map(|curve| curve.table(90).expect("a table"));
    let misfit = Misfit::of(&design, &tables, 360, 0.3).expect("a contradiction below the width");
    // The same from permanent contact without the row: the distance of the rockers and its derivatives.
    let mut mechanism = design.moved_by(tables);
    mechanism.speed = 1.0;
    let mut stepper = Stepper::assemble(mechanism, [-PI, 0.0, 0.0, 0.0], 0.0).expect("permanent contact");
    // Positions of rows that do not yield are closed to 5e-14 of the reference length.
    for (k, angle) in misfit.angle.iter().enumerate() {
        stepper.advance_to(angle.to_radians() + PI).expect("permanent contact");
        let apart = stepper.outputs().as_ref()[0];
        let expected = [Some(apart.value), apart.rate, apart.acceleration];
        for ((column, expected), allowed) in misfit.columns.iter().zip(expected).zip([5e-15, 5e-14, 1e-12]) {
            let expected = -expected.expect("a smooth output");
            assert!((column[k] - expected).abs() < allowed, "{angle}: {:e} {expected:e}", column[k]);
        }
    }
    let [position, rate, acceleration] = misfit.largest();
    println!("desmo of 90 points: mismatch {position:.1e} m, {rate:.1e} m/rad, {acceleration:.1e} m/rad^2");
    assert!(position > 1e-10 && acceleration > 1e-7, "{position:e} {acceleration:e}");
}

#[test]
fn tables_of_a_quick_law_contradict_each_other_within_the_width() {
    // Jerk begins with a jump of its slope at the ends of a flank. There accelerations of tables differ most.
    let flank = 75_f64.to_radians();
    let law = Lift::flanks(Flank::Polynomial4567, 0.008, [flank, 0.0, flank]).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    for points in [720, 90] {
        let tables =
            design.curves().expect("a pair of cams").map(|curve| curve.table(points).expect("a table"));
        let largest =
            Misfit::of(&design, &tables, 1440, 0.3).expect("a contradiction below the width").largest();
        println!("desmo, 4-5-6-7 in 75 deg, {points} points: mismatch {:.1e} m", largest[0]);
        assert!(largest[0] > 0.0 && largest[0] < 1e-6, "{largest:?}");
    }
}

#[test]
fn the_first_impacts_are_those_of_an_independent_program() {
    /// Lifts (m) at 45, 54 and 72 of 72 parts of 200° from the start, from `tests/motions/data/desmo.csv`, case `9000 play`.
    const LIFTS: [(usize, f64); 3] =
        [(45, 0.0007354327731979067), (54, 0.00652443145074413), (72, 0.009013459519438745)];
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    let valvetrain: DesmoFriction<_> = design.mechanism().expect("a pair of cams").scene();
    let method: Explicit<DormandPrince8, Projection> = Explicit::default();
    let run = Simulation::start_from_text(valvetrain.clone(), method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-8));
    for (place, expected) in LIFTS {
        let until = core::f64::consts::TAU / valvetrain.speed * 200.0 / 360.0 * place as f64 / 72.0;
        run.advance_to(until).expect("it moves");
        let error = (run.q()[2] - expected).abs();
        println!("desmo at place {place}: lift {:.6} mm, {error:.1e} m of 1e-8", 1e3 * run.q()[2]);
        assert!(error < 1e-8, "{error:e}");
    }
}

#[test]
fn a_law_that_opens_the_valve_where_the_motion_begins_is_refused() {
    let mut values = Values::of(&STUDY);
    values.law = Some(Lift::flanks(Flank::Cycloid, 0.008, [2.0, 0.5, 2.0]).expect("a law"));
    let refused = (STUDY.run)(&values, &mut |_| ()).map(|_| ()).expect_err("it is open").to_string();
    assert!(refused.contains("mm at 180°") && refused.contains("shift the law"), "{refused}");
}

/// The laws that the help names have as many derivatives, and the others are refused with it.
#[test]
fn a_law_with_too_few_derivatives_is_refused_with_those_that_have_them() {
    for flank in [Flank::Polynomial345, Flank::Cycloid, Flank::ModifiedSine, Flank::ModifiedTrapezoid] {
        let mut values = Values::of(&STUDY);
        values.law = Some(Lift::flanks(flank, 0.008, [1.3, 0.0, 1.3]).expect("a law"));
        let refused = (STUDY.run)(&values, &mut |_| ()).map(|_| ()).expect_err("two derivatives").to_string();
        assert!(
            refused.contains("2 continuous derivatives, 3 are needed\nhelp: ") && refused.contains("`4567`"),
            "{refused}"
        );
    }
    for flank in [Flank::Polynomial4567, Flank::ConstantVelocity] {
        assert!(3 <= Lift::flanks(flank, 0.008, [1.3, 0.0, 1.3]).expect("a law").order());
    }
}

/// Largest values of the motion from an independent program in closed forms, DOP853 with 10 to 100 times as many instants.
#[test]
fn peaks_of_a_turn_are_those_of_the_motion_not_of_its_shown_angles() {
    let design =
        Design::ready(Design::law(0.011, 160_f64.to_radians()).expect("a law"), Direction::CounterClockwise);
    let mut valvetrain: Valvetrain = design.mechanism().expect("a pair of cams").scene();
    let turn = Turn::of(&valvetrain, 3, 360, 1e-4).expect("it moves");
    for (name, found, expected) in [("seat", turn.peak(2), 5527.0), ("opener's cam", turn.peak(0), 10799.0)] {
        println!("desmo at 9000/min, {name}: {found:.1} N of {expected}");
        assert!((found / expected - 1.0).abs() < 1e-3, "{name}: {found}");
    }
    if !cfg!(feature = "long") {
        return;
    }
    valvetrain.speed *= 5.0 / 9.0;
    let turn = Turn::of(&valvetrain, 3, 360, 1e-9).expect("it moves");
    println!("desmo at 5000/min, valve: {:.1} m/s² of 78400", turn.hardest());
    assert!((turn.hardest() / 78.4e3 - 1.0).abs() < 1e-3, "{}", turn.hardest());
}

#[test]
fn a_study_refuses_values_that_it_cannot_run_with() {
    for (name, value) in
        [("turns", 0.0), ("turns", 1.5), ("lift", -0.01), ("valve_mass", 0.0), ("sense", 2.0)]
    {
        let refused = Values::of(&STUDY).set(name, value).expect_err("out of range").to_string();
        assert!(refused.contains("it must be") && refused.contains("help: its default is"), "{refused}");
    }
    for (name, value, expected) in [
        ("points", 3.0, "`points` is 0 or at least 16"),
        ("lift", 0.1, "does not reach the cam"),
        ("lift", 11.0, "help: lengths without a unit are in m"),
        ("opener_tip_x", 0.06, "the cam of the opener closes the valve\nhelp: put its pad"),
        ("opener_radius", 0.04, "the pad of the opener, 40.000 mm in radius, covers the cams' centre"),
        ("closer_fork_x", 0.1, "the cam of the closer opens the valve\nhelp: put its pad"),
        ("open_play", 0.05, "50.030 mm together, half of the lift of 11.000 mm or more"),
    ] {
        let mut values = Values::of(&STUDY);
        values.set(name, value).expect("a parameter");
        let refused = (STUDY.run)(&values, &mut |_| ()).map(|_| ()).expect_err(name).to_string();
        assert!(refused.contains(expected), "{name}: {refused}");
    }
}

/// The places of the study are those of the ready pair.
#[test]
fn the_study_begins_with_the_ready_pair() {
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let ready = Design::ready(law, Direction::CounterClockwise);
    let (values, [opener, closer]) = (Values::of(&STUDY), [&ready.opener, &ready.closer]);
    for (name, place) in [
        ("centre", ready.centre),
        ("opener", opener.pivot),
        ("opener_pad", opener.cam_pad),
        ("opener_tip", opener.valve_pad),
        ("closer", closer.pivot),
        ("closer_pad", closer.cam_pad),
        ("closer_fork", closer.valve_pad),
    ] {
        for (axis, coordinate) in ["x", "y"].into_iter().zip(place) {
            assert!((values.get(&format!("{name}_{axis}")) - coordinate).abs() < 1e-17, "{name}_{axis}");
        }
    }
    assert_eq!([values.get("opener_radius"), values.get("closer_radius")], [opener.radius, closer.radius]);
}

/// Coarse tables of a high lift contradict each other by more than the text allows: the mismatch is told, as that of fine ones.
#[test]
fn coarse_tables_of_a_high_lift_have_a_mismatch() {
    let law = Design::law(0.020, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    let tables = design.curves().expect("a pair of cams").map(|curve| curve.table(90).expect("a table"));
    let largest = Misfit::of(&design, &tables, 1440, 0.37).expect("a row that yields").largest();
    assert!(largest[0] > 1e-5 && largest[0] < 1e-4, "{largest:?}");
}

/// Whole studies, in which every number is computed: half an hour without optimisation.
mod whole {
    use super::*;

    /// Tables and sentence of a study with these values.
    fn tables(changes: &[(&str, f64)]) -> (String, Vec<Vec<Vec<String>>>) {
        let mut values = Values::of(&STUDY);
        for (name, value) in [("runs", 1.0), ("turns", 1.0)].iter().chain(changes) {
            values.set(name, *value).expect("a parameter");
        }
        let report = (STUDY.run)(&values, &mut |_| ()).expect("a report");
        let rows = report.sections.into_iter().flat_map(|section| section.tables).map(|table| table.rows);
        (report.sentence, rows.collect())
    }

    /// Places are parameters: the mirror image of the ready pair, whose cams turn the other way, has its figures.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "takes long without optimisation: `cargo test --release`")]
    fn a_mirrored_valvetrain_has_the_figures_of_the_ready_one() {
        let of_x = STUDY.parameters.iter().filter(|one| one.name.ends_with("_x"));
        let mut mirrored = vec![("sense", -1.0)];
        mirrored.extend(of_x.map(|one| (one.name, -one.value)));
        assert_eq!(mirrored.len(), 8);
        let ((_, ready), (_, mirror)) = (tables(&[]), tables(&mirrored));
        // Rounding moves the instants at which largest values are looked for.
        let is_near = |a: &String, b: &String| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 1e-3 * a.abs().max(b.abs()),
            _ => a == b,
        };
        // Synthesis, then peaks at both speeds, with the spring, and of the sensitivity.
        for table in [0, 4, 5, 6, 7] {
            let cells = ready[table].iter().flatten().zip(mirror[table].iter().flatten());
            for (own, other) in cells {
                assert!(is_near(own, other), "table {table}: {own} {other}");
            }
        }
    }

    /// A high lift has coarse tables that contradict each other, a slow cam small figures, a quick one an undercut.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "takes long without optimisation: `cargo test --release`")]
    fn a_study_ends_with_values_far_from_its_own() {
        let (_, high) = tables(&[("lift", 0.02)]);
        assert_eq!(high[2].len(), 4, "{:?}", high[2]);
        let (said, slow) = tables(&[("speed", 10.0), ("slow", 5.0)]);
        assert!(!said.contains(" 0.0 km"), "{said}");
        assert!(slow[4..6].iter().flatten().all(|row| row[1] != "0.0"), "{slow:?}");
        let (said, _) = tables(&[("duration", 80_f64.to_radians())]);
        assert!(said.contains("The opening cam is undercut at "), "{said}");
    }
}

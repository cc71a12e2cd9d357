//! Columns of motions of ready mechanisms.

use mbs_workbench::catalogue::sweep;
use mbs_workbench::motion::rounded;
use mechanisms::CATALOGUE;

#[test]
fn a_thinned_motion_keeps_its_ends_and_every_column() {
    let mechanism = CATALOGUE[0].mechanism().expect("its rows fix it");
    let motion = sweep(mechanism.as_ref(), 1.0, 100).expect("it turns");
    let thinned = motion.decimate(11);
    assert_eq!(thinned.time, motion.time.iter().copied().step_by(10).map(rounded).collect::<Vec<_>>());
    let (last, before) = (&thinned.outputs[8], &motion.outputs[8]);
    assert_eq!(last.value.last(), before.value.last().copied().map(rounded).as_ref());
    assert_eq!(last.acceleration.as_ref().map(Vec::len), Some(11));
    assert_eq!((thinned.iterations.len(), thinned.coordinates[0].qdd.len()), (11, 11));
}

#[test]
fn columns_are_those_of_the_values() {
    let mechanism = CATALOGUE[0].mechanism().expect("its rows fix it");
    let motion = sweep(mechanism.as_ref(), 1.0, 2).expect("it turns");
    let text = mbs_workbench::output::csv::write(&[("run", &motion)]);
    let header = text.lines().next().expect("a header");
    assert_eq!(motion.columns() + 1, header.split(',').count(), "{header}");
}

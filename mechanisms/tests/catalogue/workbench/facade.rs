//! Motions of ready mechanisms behind the object-safe traits.

use mechanisms::CATALOGUE;

#[test]
fn no_instants_are_an_empty_motion() {
    let motion = CATALOGUE[0]
        .mechanism()
        .expect("its rows fix it")
        .follow(&[], &mut |_| ())
        .expect("nothing to solve");
    assert!(motion.time.is_empty());
}

#[test]
fn progress_ends_with_all_instants() {
    let mut heard = Vec::new();
    let times = mbs_workbench::motion::instants(0.1, 3);
    CATALOGUE[0]
        .mechanism()
        .expect("its rows fix it")
        .follow(&times, &mut |count| heard.push(count))
        .expect("it turns");
    assert_eq!(heard, [1, 2, 3, 4]);
}

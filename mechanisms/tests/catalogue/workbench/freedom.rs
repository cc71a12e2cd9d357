//! Degrees of freedom of ready mechanisms.

use mbs_workbench::erased::erase::erase;
use mbs_workbench::teaching::freedom::*;
use mechanisms::CATALOGUE;

fn of(name: &str) -> Freedom {
    let mechanism = CATALOGUE.find(name).expect("in the list").mechanism().expect("its rows fix it");
    let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene())).expect("a good text");
    let q =
        mechanism.experiment().assembled(&mechanism.experiment().guess(), 0.0, true).expect("it assembles");
    freedom(mechanism.as_ref(), &report, &q, 0.0)
}

#[test]
fn the_four_bar_has_one_degree_of_freedom_and_its_crank_is_independent() {
    let found = of("four_bar");
    assert_eq!((found.coordinates, found.constraints, found.drives), (5, 4, 1));
    assert_eq!((found.structural_rank, found.rank, found.whole_rank), (4, 4, 5));
    assert_eq!((&found.independent[..], &found.dependent[..]), (&[2][..], &[0, 1, 3, 4][..]));
    assert!(found.redundant.is_empty());
}

#[test]
fn named_coordinates_are_independent_unless_they_leave_others_open_at_the_position() {
    use mbs_runtime::mechanism;
    mechanism! {
        pub mechanism Named;
        coord phi: [rad; 3] = [0.3, 0.9, 1.8];
        coord x: m = 0.1;
        constraint closure { 0.1m*unit(phi[0]) + 0.25m*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
        constraint slide { x == 0.2m*cos(phi[2]); }
        drive crank: phi[0] == 0.3 + 2*t/1s;
        independent x;
    }
    let mechanism = erase(Named::default()).into_mechanism().expect("its rows fix it");
    let report = mbs_codegen::structure_of(mechanism.source(), None).expect("a good text");
    assert_eq!(report.independent, [3]);
    let q =
        mechanism.experiment().assembled(&mechanism.experiment().guess(), 0.0, true).expect("it assembles");
    let found = freedom(mechanism.as_ref(), &report, &q, 0.0);
    assert_eq!((&found.independent[..], found.declared), (&[3][..], true));
    // With the last link along x its angle does not follow from x.
    let dead = [q[0], q[1], 0.0, 0.2];
    let found = freedom(mechanism.as_ref(), &report, &dead, 0.0);
    assert!(found.independent != [3] && !found.declared, "{found:?}");
    assert!(!of("four_bar").declared);
}

#[test]
fn of_rows_that_follow_from_one_another_the_last_one_is_named() {
    let found = of("double_parallelogram");
    assert_eq!((found.constraints, found.drives, found.rank, found.whole_rank), (4, 1, 3, 4));
    assert_eq!((found.structural_rank, &found.redundant[..]), (4, &[3][..]));
}

#[test]
fn an_open_chain_has_independent_coordinates_alone() {
    let found = of("open_chain");
    assert_eq!((found.constraints, found.drives, found.rank), (0, 3, 0));
    assert_eq!(found.independent, [0, 1, 2]);
}

#[test]
fn drives_take_up_every_degree_of_freedom_of_every_mechanism() {
    for card in CATALOGUE.fixed() {
        let found = of(&card.name());
        assert_eq!(found.independent.len(), found.drives, "{}: {found:?}", card.name());
        assert_eq!(found.whole_rank, found.coordinates, "{}", card.name());
        let mechanism = card.equations();
        let surplus = mechanism.rows().len() - mechanism.coordinates().len();
        assert_eq!(found.redundant.len(), surplus, "{}", card.name());
        assert_eq!(found.structural_rank, found.rank + surplus, "{}", card.name());
    }
}

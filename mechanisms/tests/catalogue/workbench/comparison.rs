//! One linkage in several kinds of coordinates.

use mbs_workbench::teaching::comparison::*;
use mechanisms::CATALOGUE;

#[test]
fn the_same_linkage_moves_the_same_in_other_coordinates() {
    let [own, other] = ["four_bar", "four_bar_natural"]
        .map(|name| candidate(CATALOGUE.find(name).expect("in the list"), 60).expect("it turns"));
    assert_eq!((own.coordinates, own.rows, own.largest_block), (5, 5, 2));
    let differences = difference(&own.motion, &other.motion, "P").expect("both have P");
    assert!(differences.iter().all(|d| *d < 1e-10), "{differences:?}");
    assert!(other.condition >= 1.0 && own.condition >= 1.0);
    assert!(difference(&own.motion, &other.motion, "Q").is_none());
}

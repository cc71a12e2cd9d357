//! Basins of attraction of ready mechanisms.

use core::f64::consts::PI;

use mbs_workbench::teaching::basins::*;
use mechanisms::CATALOGUE;

fn four_bar(size: usize) -> Basins {
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    let axes = [3, 4].map(|coordinate| Axis::of(mechanism.as_ref(), coordinate));
    let mut heard = 0;
    let basins = basins(mechanism.as_ref(), axes, size, 0.0, &mut |rows| heard = rows);
    assert_eq!(heard, 3 * size);
    basins
}

#[test]
fn the_four_bar_has_two_assemblies_and_the_declared_one_wins_everywhere() {
    let basins = four_bar(16);
    assert_eq!(basins.solutions.len(), 2, "{:?}", basins.solutions);
    assert!(basins.solutions[0].is_declared() && !basins.solutions[1].is_declared());
    let [plain, assemble, declared] = &basins.maps[..] else { panic!("three maps") };
    assert_eq!(declared.share(Some(0)), 1.0);
    assert!(plain.share(Some(1)) > 0.1 && assemble.share(Some(1)) > 0.1);
    assert!(assemble.share(None) <= plain.share(None));
    let sum: f64 = [None, Some(0), Some(1)].map(|s| plain.share(s)).iter().sum();
    assert!((sum - 1.0).abs() < 1e-12);
}

#[test]
fn cells_run_from_the_upper_left() {
    let basins = four_bar(4);
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    let mut guess = mechanism.experiment().guess();
    (guess[3], guess[4]) = (-0.75 * PI, 0.75 * PI);
    let q = mechanism.experiment().assembled(&guess, 0.0, false).expect("an assembly");
    let side = usize::from(mechanism.experiment().branch_values(&q, 0.0)[0] < 0.0);
    assert_eq!(basins.maps[1].cells[0], Some(side));
}

//! Orders of texts: where there is one, and that it has no entry beyond those of the text where none is needed.

use super::*;
use crate::structure::analysed::analysed;

/// The order of a text, as the code is emitted from.
fn of(text: &str) -> Option<SparseOrder> {
    let (equations, structure) = analysed(text);
    order(&equations, structure.independent.len())
}

/// A chain of `links` from point to point; the mass of points is `mass`.
fn chain(links: usize, mass: &str) -> String {
    format!(
        "mechanism Chain; const N: 1 = {links}; coord P: [m; N, 2];
         for i in 0..N {{ {mass} start P[i] = [(i + 1)*0.1m, 0] rate [0, 0]; }}
         constraint first {{ dot(P[0], P[0]) == (0.1m)^2; }}
         for i in 1..N {{ constraint links {{ dot(P[i] - P[i - 1], P[i] - P[i - 1]) == (0.1m)^2; }} }}"
    )
}

const POINTS: &str = "body point { mass: 1, com: P[i] }";

#[test]
fn a_chain_fills_nothing_but_the_couplings_of_its_rows() {
    let order = of(&chain(40, POINTS)).expect("an order");
    assert_eq!(order.unknowns.len(), 120);
    assert!(order.unknowns.iter().take(80).all(|unknown| *unknown < 80), "coordinates first");
    // Four coordinates a row but two of the first, and each row with the next.
    assert_eq!(order.below.len(), 4 * 39 + 2 + 39);
    assert_eq!(order.rows.len(), 4 * 39 + 2);
    // A coordinate of two rows takes one product off their coupling; the last point has one row.
    assert_eq!(order.targets.len(), 78);
}

#[test]
fn texts_of_few_motions_and_those_without_a_mass_for_each_coordinate_have_none() {
    assert_eq!(of(&chain(4, POINTS)), None);
    let heavy = chain(40, POINTS).replace("mechanism Chain;", "mechanism Chain; coord Z: [m; 40];").replace(
        "constraint first",
        "for i in 0..40 { constraint heights { Z[i] == P[i][1]; } start Z[i] = 0 rate 0; } constraint first",
    );
    assert_eq!(of(&heavy), None);
}

#[test]
fn where_all_motions_are_coupled_there_is_none() {
    // Relative angles: M is full.
    let text = "mechanism Arms; const N: 1 = 30; coord a: [rad; N];
        for i in 0..N { body arm { mass: 1, com: [sum(j in 0..i + 1: 1m*cos(a[j])), sum(j in 0..i + 1: 1m*sin(a[j]))] }
        start a[i] = 0.1 rate 0; }";
    assert_eq!(of(text), None);
}

//! The entries of Φ_q without its zeros.

use mbs_runtime::Mechanism;
use mechanisms::{four_bar::FourBar, jansen::Jansen, three_rrr::ThreeRrr};

/// The entries at the places of the table against the dense matrix.
fn scattered_and_dense<S: Mechanism<f64, N, M> + Default, const N: usize, const M: usize>()
-> [[[f64; N]; M]; 2] {
    let mechanism = S::default();
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, &mechanism.guess(&parameters), 0.1);
    let mut scattered = [[0.0; N]; M];
    let entries = mechanism.phi_q_entries(&parameters, &position);
    assert_eq!(entries.as_ref().len(), S::SPARSITY.len());
    for ((row, column), entry) in S::SPARSITY.iter().zip(entries.as_ref()) {
        scattered[usize::from(*row)][usize::from(*column)] = *entry;
    }
    [scattered, mechanism.phi_q(&parameters, &position)]
}

#[test]
fn entries_at_their_places_are_the_dense_jacobian() {
    let [scattered, dense] = scattered_and_dense::<FourBar, _, _>();
    assert_eq!(scattered, dense);
    let [scattered, dense] = scattered_and_dense::<Jansen, _, _>();
    assert_eq!(scattered, dense);
    let [scattered, dense] = scattered_and_dense::<ThreeRrr, _, _>();
    assert_eq!(scattered, dense);
}

#[test]
fn places_stand_row_by_row_with_ascending_columns() {
    let places = <FourBar as Mechanism<f64, 5, 5>>::SPARSITY;
    assert_eq!(places.len(), 13);
    assert!(places.is_sorted() && places.windows(2).all(|pair| pair[0] != pair[1]));
}

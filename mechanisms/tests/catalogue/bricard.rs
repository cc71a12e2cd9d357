//! Tests of `mechanisms::bricard`.

use mbs_runtime::dynamics::{closed, equilibrium};
use mbs_runtime::{Dynamic, Mechanism};
use mechanisms::bricard::Bricard;

/// Off the rows the dependent one holds the loop as well: Newton's method may end at any position that closes.
#[test]
fn a_loop_with_a_dependent_row_rests_where_its_forces_balance() {
    // Three quarters of what a thread of a test has, for the analysis with most numbers at once on the largest text here.
    let small = std::thread::Builder::new().stack_size(3 << 19);
    small.spawn(rest_is_balanced).expect("a thread").join().expect("a position of rest");
}

fn rest_is_balanced() {
    let bricard = Bricard::<f64>::default();
    let parameters = bricard.parameters();
    for (first, pieces) in [(0.3, 3), (0.3, 4), (0.1, 2), (0.7, 5), (1.1, 6)] {
        let mut q = bricard.guess(&parameters);
        for piece in 1..=pieces {
            q[0] = first * f64::from(piece) / f64::from(pieces);
            q = closed(&bricard, 0.0, &q, &[0]).expect("the loop closes");
        }
        let rest = equilibrium(&bricard, 0.0, &q).expect("a position of rest");
        let position = bricard.position(&parameters, &rest.q, 0.0);
        let force = bricard.force(&parameters, &position, &[0.0; 23], &[], &rest.lambda);
        let reaction = bricard.reaction(&parameters, &position, &rest.lambda);
        let open = reaction.iter().zip(&force).map(|(reaction, force)| (reaction - force).abs());
        assert!(open.fold(0.0, f64::max) < 1e-9, "{first}: {rest:?}");
        assert!(rest.q[0].cos().abs() < 1e-7 && rest.indifferent == [false; 23], "{first}: {rest:?}");
    }
}

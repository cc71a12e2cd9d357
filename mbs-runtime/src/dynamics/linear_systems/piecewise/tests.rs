use std::vec::Vec;

use crate::dynamics::linear_systems::piecewise::*;

extern crate std;

/// Random numbers between −1 and 1.
pub(super) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

pub(super) fn residual<const K: usize>(system: &Piecewise<f64, K>, v: &[f64; K]) -> f64 {
    let pairs = system.sums(v).into_iter().zip(&system.terms).zip(v);
    pairs.fold(0.0, |worst: f64, (([x, y], term), v)| {
        let value = match term {
            Term::Multiplier => x,
            Term::Absolute => x.abs(),
            Term::Norm => (x * x + y * y).sqrt(),
        };
        worst.max((value - v).abs())
    })
}

/// A random system with entries of B up to `size`.
pub(super) fn system<const K: usize>(terms: [Term; K], size: f64, state: &mut u64) -> Piecewise<f64, K> {
    let offset = terms.map(|_| [(); 2].map(|()| random(state)));
    let slope = terms.map(|_| [(); 2].map(|()| [(); K].map(|()| size * random(state))));
    Piecewise { terms, offset, slope }
}

#[test]
fn norms_and_absolute_values_beside_multipliers_are_solved() {
    let terms = [Term::Norm, Term::Absolute, Term::Norm, Term::Multiplier, Term::Absolute];
    let mut state = 7;
    let mut solved = 0;
    for _ in 0..2000 {
        let system = system(terms, 0.35, &mut state);
        match system.solve(&[0.0; 5]) {
            Solutions::One(v) => {
                solved += 1;
                let error = residual(&system, &v);
                assert!(error < 1e-13, "{error:e}: {system:?}");
            }
            other => assert!(!matches!(other, Solutions::AtLeast(_)), "{other:?}: {system:?}"),
        }
    }
    assert!(solved > 1600, "{solved}");
}

#[test]
fn the_solutions_of_one_norm_are_those_of_its_quadratic_equation() {
    let mut state = 11;
    let mut counts = [0; 3];
    for _ in 0..2000 {
        let system = system([Term::Norm], 2.0, &mut state);
        let ([[cx, cy]], [[[bx], [by]]]) = (system.offset, system.slope);
        // n − |c + b n| changes its sign at each solution: counted on a fine grid of n/(1 + n).
        let open = |share: f64| {
            let n = share / (1.0 - share);
            n - (cx + bx * n).hypot(cy + by * n)
        };
        let signs = (0..20_000).map(|place| open(f64::from(place) / 20_000.0) > 0.0).collect::<Vec<_>>();
        let count = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let found = match system.solve(&[0.0]) {
            Solutions::None => 0,
            Solutions::One(v) => {
                assert!(residual(&system, &v) < 1e-12 * (1.0 + v[0]));
                1
            }
            Solutions::Several(count) => count as usize,
            Solutions::AtLeast(_) => panic!("one norm is counted"),
        };
        assert_eq!(found, count, "{system:?}");
        counts[count] += 1;
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

#[test]
fn signs_turned_one_at_a_time_come_to_an_end_where_the_system_contracts() {
    let mut state = 13;
    for _ in 0..500 {
        let system = system([Term::Absolute; 9], 0.2, &mut state);
        if !system.reduced(Given::NONE).is_some_and(|reduced| reduced.contracts()) {
            continue;
        }
        let start = [(); 9].map(|()| random(&mut state));
        let (newton, turned) = (system.newton(Given::NONE, &start), system.turned(Given::NONE, &start));
        let contracted = system.contracted(Given::NONE, &start);
        for v in [newton, turned, contracted].into_iter().flatten() {
            assert!(residual(&system, &v) < 1e-13);
        }
        assert!(turned.is_some() && contracted.is_some());
    }
}

#[test]
fn a_sum_of_zero_is_one_solution_and_not_two() {
    let system = Piecewise { terms: [Term::Absolute; 2], offset: [[0.0; 2]; 2], slope: [[[0.0; 2]; 2]; 2] };
    assert_eq!(system.solve(&[0.0; 2]), Solutions::One([0.0; 2]));
    let slope = [[[1.5, 0.0], [0.0; 2]], [[0.0; 2], [0.0; 2]]];
    assert_eq!(Piecewise { slope, ..system }.solve(&[1.0; 2]), Solutions::One([0.0; 2]));
}

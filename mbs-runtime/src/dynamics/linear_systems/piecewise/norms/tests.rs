use std::vec::Vec;

use crate::dynamics::linear_systems::piecewise::tests::{random, residual, system};
use crate::dynamics::linear_systems::piecewise::{Piecewise, Solutions};
use crate::linear_algebra::vectors::Each;
use crate::mechanism::normal_forces::Term;

extern crate std;

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// Product of two polynomials, the constant first.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = std::vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        b.iter().enumerate().for_each(|(j, b)| product[i + j] += a * b);
    }
    product
}

/// a − b.
fn less(mut a: Vec<f64>, b: &[f64]) -> Vec<f64> {
    a.resize(a.len().max(b.len()), 0.0);
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
    a
}

/// All roots of a polynomial by the method of Durand and Kerner.
fn roots(polynomial: &[f64]) -> Vec<Complex> {
    let leading = *polynomial.last().unwrap();
    let value = |x: Complex| {
        polynomial.iter().rev().fold((0.0, 0.0), |sum, a| {
            let (re, im) = times(sum, x);
            (re + a / leading, im)
        })
    };
    let largest = polynomial.iter().fold(0.0, |size: f64, a| size.max((a / leading).abs()));
    let radius = (1.0 + largest).sqrt();
    let count = polynomial.len() - 1;
    let mut roots = (0..count).map(|k| (0.7 + k as f64 * std::f64::consts::TAU / count as f64).sin_cos());
    let mut roots = roots.by_ref().map(|(s, c)| (radius * c, radius * s)).collect::<Vec<_>>();
    for _ in 0..2000 {
        for i in 0..count {
            let x = roots[i];
            let others = (0..count).filter(|j| *j != i);
            let (re, im) = others.fold((1.0, 0.0), |p, j| times(p, (x.0 - roots[j].0, x.1 - roots[j].1)));
            let share = times(value(x), (re, -im));
            let square = re * re + im * im;
            roots[i] = (x.0 - share.0 / square, x.1 - share.1 / square);
        }
    }
    roots
}

/// The solutions of two norms by the resultant of their squares, of degree four in the first; none where two nearly meet, or one is
/// nearly at the edge.
fn eliminated(system: &Piecewise<f64, 2>) -> Option<Vec<[f64; 2]>> {
    // nᵢ² − |cᵢ + bᵢ₁ n₁ + bᵢ₂ n₂|² in powers of n₂, with polynomials in n₁.
    let squares = [0, 1].map(|i| {
        let mut powers = [std::vec![0.0; 3], std::vec![0.0; 2], std::vec![0.0; 1]];
        powers[if i == 0 { 0 } else { 2 }][if i == 0 { 2 } else { 0 }] += 1.0;
        for component in 0..2 {
            let (c, [b1, b2]) = (system.offset[i][component], system.slope[i][component]);
            powers[0] = less(powers[0].clone(), &product(&[c, b1], &[c, b1]));
            powers[1] = less(powers[1].clone(), &product(&[2.0 * b2], &[c, b1]));
            powers[2][0] -= b2 * b2;
        }
        powers
    });
    let cross = |i: usize, j: usize| {
        less(product(&squares[0][i], &squares[1][j]), &product(&squares[1][i], &squares[0][j]))
    };
    let (ac, ab, bc) = (cross(2, 0), cross(2, 1), cross(1, 0));
    let at = |polynomial: &[f64], x: f64| polynomial.iter().rev().fold(0.0, |sum, a| sum * x + a);
    let roots = roots(&less(product(&ac, &ac), &product(&ab, &bc)));
    let mut found = Vec::new();
    for (index, (re, im)) in roots.iter().enumerate() {
        let size = 1.0 + re.hypot(*im);
        let nearest = |other: &Complex| (re - other.0).hypot(im - other.1) / size;
        let apart = roots.iter().enumerate().filter(|(other, _)| *other != index);
        let apart = apart.fold(1.0_f64, |apart, (_, other)| apart.min(nearest(other)));
        let n = [*re, -at(&ac, *re) / at(&ab, *re)];
        if im.abs() > 1e-3 * size {
            continue;
        }
        if apart < 2e-3 || n.iter().any(|n| n.abs() < 1e-3 || n.abs() > 1e3) || im.abs() > 1e-6 * size {
            return None;
        }
        if n.iter().all(|n| *n > 0.0) {
            found.push(n);
        }
    }
    Some(found)
}

#[test]
fn the_solutions_of_two_norms_are_those_of_their_resultant() {
    let mut state = 17;
    let mut counts = [0; 5];
    for round in 0..3000 {
        let size = [0.8, 1.5, 3.0][round % 3];
        let system = system([Term::Norm; 2], size, &mut state);
        let Some(known) = eliminated(&system) else { continue };
        match (known.len(), system.solve(&[0.0; 2])) {
            (0, Solutions::None) => {}
            (1, Solutions::One(v)) => {
                let error = v.iter().zip(&known[0]).fold(0.0_f64, |e, (v, n)| e.max((v / n - 1.0).abs()));
                // The roots of a polynomial of degree four lose digits.
                assert!(error < 1e-6, "{error:e}: {system:?}");
                assert!(residual(&system, &v) < 1e-12 * (1.0 + v[0] + v[1]), "{v:?} {system:?}");
            }
            (2.., Solutions::Several(count)) if count as usize == known.len() => {}
            (_, found) => panic!("{found:?} of {known:?}: {system:?}"),
        }
        counts[known.len()] += 1;
    }
    assert!(counts[..3].iter().all(|count| *count > 200) && counts[3] + counts[4] > 15, "{counts:?}");
}

/// A random system in which each norm depends on itself and on those behind it.
fn triangular<const K: usize>(size: f64, state: &mut u64) -> Piecewise<f64, K> {
    let mut system = system([Term::Norm; K], size, state);
    for (i, slopes) in system.slope.iter_mut().enumerate() {
        slopes.iter_mut().flat_map(|row| row.iter_mut().take(i)).for_each(|slope| *slope = 0.0);
    }
    system
}

/// Its solutions by one quadratic equation after the other; none where one of them is nearly at the edge.
fn in_turn<const K: usize>(system: &Piecewise<f64, K>) -> Option<Vec<[f64; K]>> {
    let mut found = std::vec![[0.0; K]];
    for i in (0..K).rev() {
        let mut next = Vec::new();
        for n in found {
            let b = [0, 1].map(|component| system.slope[i][component][i]);
            let c = system.sums(&n)[i];
            let (leading, half) = (1.0 - b[0] * b[0] - b[1] * b[1], b[0] * c[0] + b[1] * c[1]);
            let last = c[0] * c[0] + c[1] * c[1];
            let discriminant = half * half + leading * last;
            if discriminant.abs() < 1e-4 * (half * half + last) || leading.abs() < 1e-2 {
                return None;
            }
            for sign in [-1.0, 1.0].into_iter().filter(|_| 0.0 < discriminant) {
                let root = (half + sign * discriminant.sqrt()) / leading;
                if root > 0.0 {
                    let mut n = n;
                    n[i] = root;
                    next.push(n);
                }
            }
        }
        found = next;
    }
    Some(found)
}

/// Counts of solutions that agree with those of quadratic equations in turn, and how many were left open.
fn counted<const K: usize>(size: f64, rounds: u32) -> ([u32; 9], u32) {
    let (mut counts, mut open, mut state) = ([0; 9], 0, 19);
    for _ in 0..rounds {
        let system = triangular::<K>(size, &mut state);
        let Some(known) = in_turn(&system) else { continue };
        match (known.len(), system.solve(&[0.0; K])) {
            (0, Solutions::None) => {}
            (1, Solutions::One(v)) => {
                let error = v.iter().zip(&known[0]).fold(0.0_f64, |e, (v, n)| e.max((v / n - 1.0).abs()));
                assert!(error < 1e-9, "{error:e}: {system:?}");
            }
            (2.., Solutions::Several(count)) if count as usize == known.len() => {}
            (count, Solutions::AtLeast(found)) if found as usize <= count => open += 1,
            (_, found) => panic!("{found:?} of {known:?}: {system:?}"),
        }
        counts[known.len()] += 1;
    }
    (counts, open)
}

#[test]
fn the_solutions_of_norms_in_turn_are_those_of_their_quadratic_equations() {
    let (two, open) = counted::<2>(1.2, 2000);
    assert!(open == 0 && two[..3].iter().all(|count| *count > 300) && two[4] > 10, "{two:?}, {open} open");
    let (three, open) = counted::<3>(1.0, 600);
    assert!(open == 0 && three[..3].iter().all(|count| *count > 50), "{three:?}, {open} open");
}

#[test]
fn newtons_method_from_anywhere_finds_no_solution_of_three_norms_beyond_those_counted() {
    let (mut state, mut counts) = (23, [0; 3]);
    for _ in 0..200 {
        let system = system([Term::Norm; 3], 0.8, &mut state);
        let mut found: Vec<[f64; 3]> = Vec::new();
        for _ in 0..60 {
            let start = [(); 3].map(|()| (1.0 / (1e-3 + random(&mut state).abs())).powi(2) * 1e-2);
            if let Some(v) = system.newton(crate::dynamics::linear_systems::piecewise::Given::NONE, &start) {
                let apart =
                    |known: &[f64; 3]| known.iter().zip(&v).any(|(a, b)| (a - b).abs() > 1e-6 * (a + b));
                if found.iter().all(apart) {
                    found.push(v);
                }
            }
        }
        let count = match system.solve(&[0.0; 3]) {
            Solutions::None => 0,
            Solutions::One(_) => 1,
            Solutions::Several(count) => count as usize,
            Solutions::AtLeast(_) => panic!("left open: {system:?}"),
        };
        assert!(found.len() <= count, "{found:?}, {count} counted: {system:?}");
        counts[count.min(2)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
}

#[test]
fn norms_in_any_unit_and_in_single_precision_have_as_many_solutions() {
    let (mut state, mut several, mut open) = (29, 0, 0);
    for _ in 0..400 {
        let system = system([Term::Norm; 2], 1.2, &mut state);
        if eliminated(&system).is_none() {
            continue;
        }
        let count = |solutions| match solutions {
            Solutions::None => 0,
            Solutions::One(_) => 1,
            Solutions::Several(count) => count,
            Solutions::AtLeast(_) => panic!("left open: {system:?}"),
        };
        let known = count(system.solve(&[0.0; 2]));
        for unit in [1e-9, 1e9] {
            let offset = system.offset.map(|offset| offset.each(|c| unit * c));
            assert_eq!(count(Piecewise { offset, ..system }.solve(&[0.0; 2])), known, "{unit}: {system:?}");
        }
        let offset = system.offset.map(|offset| offset.map(|c| c as f32));
        let slope = system.slope.map(|slopes| slopes.map(|slopes| slopes.map(|b| b as f32)));
        let single = match (Piecewise { terms: system.terms, offset, slope }).solve(&[0.0; 2]) {
            Solutions::None => 0,
            Solutions::One(_) => 1,
            Solutions::Several(count) => count,
            // Next to solutions that meet, or to one in every size.
            Solutions::AtLeast(found) => {
                open += 1;
                assert!(found <= known, "{system:?}");
                continue;
            }
        };
        assert_eq!(single, known, "{system:?}");
        several += u32::from(known > 1);
    }
    assert!(several > 10 && open < 20, "{several}, {open} open");
}

/// Two norms that act on each other alone: n₁ = |c₁ + b n₂|, n₂ = |c₂ + b n₁|.
fn coupled(offset: [[f64; 2]; 2], b: f64) -> Piecewise<f64, 2> {
    let slope = [[[0.0, b], [0.0; 2]], [[b, 0.0], [0.0; 2]]];
    Piecewise { terms: [Term::Norm; 2], offset, slope }
}

#[test]
fn norms_without_load_have_one_solution() {
    assert_eq!(coupled([[0.0; 2]; 2], 2.0).solve(&[1.0; 2]), Solutions::One([0.0; 2]));
    // n₁ = n₂ in any size.
    assert_eq!(coupled([[0.0; 2]; 2], 1.0).solve(&[1.0; 2]), Solutions::AtLeast(0));
}

#[test]
fn two_solutions_that_meet_are_counted_or_left_open_and_never_one() {
    // Both alike, n = |c + b n|: double where the sine of the angle between c and b is 1/b, c against b.
    let b = 2.0_f64;
    let edge = std::f64::consts::PI - (1.0 / b).asin();
    for offset in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-6, -1e-3, -1e-1] {
        let (y, x) = (edge + offset).sin_cos();
        match coupled([[x, y]; 2], b).solve(&[0.0; 2]) {
            Solutions::One(v) => panic!("{offset:e}: {v:?}"),
            Solutions::None => assert!(offset < 1e-8, "{offset:e}"),
            Solutions::Several(count) => assert!(count >= 2 && offset > -1e-8, "{offset:e}: {count}"),
            Solutions::AtLeast(_) => assert!(offset.abs() < 1e-5, "{offset:e}"),
        }
    }
}

//! Newton's method on blocks of one to four unknowns.

extern crate std;
use crate::block_solvers::newton::Newton;
use crate::linear_algebra::direct1::Direct1;
use crate::linear_algebra::direct2::Direct2;
use crate::linear_algebra::lu::Lu;
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;

fn block<const K: usize>(is_angle: bool) -> Block<f64, K> {
    let rows = core::array::from_fn(|k| 7 + k as u16);
    Block {
        rows,
        coordinates: rows,
        angles: [is_angle; K],
        row_scales: [1.0; K],
        coordinate_scales: [1.0; K],
    }
}

#[test]
fn an_angle_far_away_is_reached_in_steps_of_half_a_radian() {
    let mut farthest = 0.0_f64;
    let mut last = [10.0];
    let mut newton = Newton::new(10.0);
    let (x, outcome) = newton.solve::<1, Direct1<f64>>(&block(true), last, |x| {
        farthest = farthest.max((x[0] - last[0]).abs());
        last = *x;
        ([x[0]], [[1.0]])
    });
    assert_eq!((x, outcome), ([0.0], [Outcome::Converged]));
    assert_eq!((farthest, newton.diagnosis().evaluations), (0.5, 21));
}

#[test]
fn a_cycle_of_two_points_is_left_after_a_few_iterations() {
    // x³ − 2x + 2: Newton's method goes from 0 to 1 and back; the root is −1.769.
    let cubic = |x: &[f64; 1]| ([x[0].powi(3) - 2.0 * x[0] + 2.0], [[3.0 * x[0] * x[0] - 2.0]]);
    let mut visited = std::vec::Vec::new();
    let (_, [outcome]) = Newton::new(2.0).solve::<1, Direct1<f64>>(&block(false), [0.0], |x| {
        visited.push(x[0]);
        cubic(x)
    });
    let cycle = visited.iter().take_while(|x| x.fract() == 0.0).count();
    assert!(cycle <= 8, "{visited:?}");
    // Levenberg–Marquardt goes down from there, to the root or to the least residual at √(2/3).
    assert!(outcome == Outcome::Converged || visited.len() < 160, "{visited:?}");
}

#[test]
fn a_repeated_row_is_solved_with_the_shortest_step() {
    let repeated = |x: &[f64; 2]| ([x[0] + x[1] - 1.0; 2], [[1.0; 2]; 2]);
    let mut newton = Newton::new(1.0);
    let (x, outcome) = newton.solve::<2, Direct2<f64>>(&block(false), [0.0, 0.5], repeated);
    assert_eq!(outcome, [Outcome::Converged]);
    assert!((x[0] - 0.25).abs() < 1e-15 && (x[1] - 0.75).abs() < 1e-15 && !newton.diagnosis().fallback);
}

#[test]
fn rows_that_contradict_each_other_are_not_converged_with_the_worst_row_named() {
    let contradicting = |x: &[f64; 2]| ([x[0] + x[1] - 1.0, x[0] + x[1] - 1.5], [[1.0; 2]; 2]);
    let mut newton = Newton::new(1.0);
    let (x, outcome) = newton.solve::<2, Direct2<f64>>(&block(false), [0.0, 0.5], contradicting);
    assert!(matches!(outcome, [Outcome::NotConverged { row: 7 | 8 }]) && x[0].is_finite());
    let worst = newton.diagnosis().worst;
    assert!((worst.residual - 0.25).abs() < 1e-6 && worst.required < 1e-13 && newton.diagnosis().fallback);
}

#[test]
fn an_angle_relative_to_one_many_turns_away_converges_to_what_its_sum_can_resolve() {
    // ψ1 after 1e5 turns is known outside the block alone: sin(ψ1 + ψ2) = 0.3 can hold to its rounding only.
    let outer = 1e5 * core::f64::consts::TAU;
    let evaluate = |x: &[f64; 1]| {
        let (sine, cosine) = libm::sincos(outer + x[0]);
        ([sine - 0.3], [[cosine]])
    };
    let mut newton = Newton::new(outer);
    let (x, outcome) = newton.solve::<1, Direct1<f64>>(&block(true), [0.7], evaluate);
    assert_eq!(outcome, [Outcome::Converged]);
    assert!((evaluate(&x).0[0]).abs() < 2e-10 && !newton.diagnosis().fallback);
}

#[test]
fn nan_from_a_row_is_not_finite_and_names_it() {
    let mut newton = Newton::new(1.0);
    let (x, outcome) = newton.solve::<2, Direct2<f64>>(&block(false), [1.0, 2.0], |x| {
        ([x[0], libm::sqrt(-x[1])], [[1.0, 0.0], [0.0, 1.0]])
    });
    assert_eq!(outcome, [Outcome::NonFinite { row: 8 }]);
    assert!(x.iter().all(|x| x.is_finite()));
}

#[test]
fn four_unknowns_converge_quadratically_through_lu() {
    let evaluate = |x: &[f64; 4]| {
        let mut jacobian = [[0.25; 4]; 4];
        let mut residuals = [-1.5; 4];
        for k in 0..4 {
            residuals[k] += x[k] * x[k] + 0.25 * x.iter().sum::<f64>();
            jacobian[k][k] += 2.0 * x[k];
        }
        (residuals, jacobian)
    };
    let mut newton = Newton::new(1.0);
    let (x, outcome) = newton.solve::<4, Lu<f64, 4>>(&block(false), [1.2, 0.7, 0.9, 1.4], evaluate);
    assert_eq!(outcome, [Outcome::Converged]);
    assert!(evaluate(&x).0.iter().all(|r| r.abs() < 1e-13));
    assert!(newton.diagnosis().evaluations <= 7 && !newton.diagnosis().fallback);
}

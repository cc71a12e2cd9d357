//! Orders of the steps, and what they save on dyads.

use super::*;
use crate::block_solvers::fast_newton::{FAR, FINE, FastNewton};
use crate::linear_algebra::direct2::Direct2;
use crate::mechanism::block::BlockSolver;
use crate::scalar::lanes::Lanes;

fn block<T: Scalar>() -> Block<T, 2> {
    Block {
        rows: [4, 5],
        coordinates: [0, 1],
        angles: [false; 2],
        row_scales: [T::constant(1.0); 2],
        coordinate_scales: [T::constant(1.0); 2],
    }
}

/// Circles of radii 0.7 and 0.6 around 0 and (0.9, 0.2), the second one written thrice over and its sides exchanged.
fn circles<T: Scalar>([x, y]: &[T; 2]) -> ([T; 2], [[T; 2]; 2]) {
    let number = T::constant;
    let (u, v) = (*x - number(0.9), *y - number(0.2));
    let residuals = [*x * *x + *y * *y - number(0.49), number(3.0) * (number(0.36) - u * u - v * v)];
    (residuals, [[number(2.0) * *x, number(2.0) * *y], [number(-6.0) * u, number(-6.0) * v]])
}

/// Second derivatives of both circles.
const SECOND: [f64; 2] = [2.0, -6.0];

type Rows = fn(&[f64; 2]) -> ([f64; 2], [[f64; 2]; 2]);

fn newton(jacobian: &[[f64; 2]; 2], residuals: &[f64; 2]) -> [f64; 2] {
    Direct2::newton_step(jacobian, residuals, &[1.0; 2], &[1.0; 2])
}

/// The root next to a point, by Newton's method.
fn root(rows: Rows, mut x: [f64; 2]) -> [f64; 2] {
    for _ in 0..12 {
        let (residuals, jacobian) = rows(&x);
        let step = newton(&jacobian, &residuals);
        x = [x[0] - step[0], x[1] - step[1]];
    }
    x
}

/// Error that a step leaves of one of `error`, from the root that is next to `near`.
fn left(rows: Rows, near: [f64; 2], error: f64, second: Option<[f64; 2]>) -> f64 {
    let root = root(rows, near);
    let x = [root[0] + 0.6 * error, root[1] - 0.8 * error];
    let (residuals, jacobian) = rows(&x);
    let step = match second {
        Some(second) => to_root::<f64, 2, Direct2<f64>>(&block(), &jacobian, &residuals, &second),
        None => newton(&jacobian, &residuals),
    };
    (x[0] - step[0] - root[0]).hypot(x[1] - step[1] - root[1])
}

#[test]
fn errors_fall_with_the_order_of_the_step() {
    let order = |left: &dyn Fn(f64) -> f64| (left(8e-3) / left(4e-3)).log2();
    for near in [[0.4, 0.6], [0.6, -0.4]] {
        let newton = order(&|error| left(circles, near, error, None));
        assert!((newton - 2.0).abs() < 0.15, "{newton}");
        let to_root = order(&|error| left(circles, near, error, Some(SECOND)));
        assert!((to_root - 4.0).abs() < 0.15, "{to_root}");
    }
}

#[test]
fn dyads_close_in_two_evaluations_where_newtons_method_takes_three() {
    // A hundred-thousandth of a link from the root, as predictions are.
    for near in [[0.4, 0.6], [0.6, -0.4]] {
        let end = root(circles::<f64>, near);
        let start = [end[0] + 6e-6, end[1] - 8e-6];
        let (mut straight, mut to_root) = (FastNewton::<_>::new(true), FastNewton::<f64, FAR>::new(true));
        let (x, _) = straight.solve::<2, Direct2<f64>>(&block(), start, circles);
        let (y, _) = to_root.solve_round::<2, Direct2<f64>>(&block(), start, circles, &SECOND);
        assert!(straight.closed && to_root.closed);
        assert_eq!([straight.evaluations, to_root.evaluations], [3, 2]);
        assert!((0..2).all(|k| (x[k] - y[k]).abs() < 1e-15), "{x:?} {y:?}");
    }
}

#[test]
fn a_residual_above_the_part_of_its_tolerance_takes_one_step_more() {
    // 5e-8 of a link from the root Newton's method closes with a residual within the tolerance, but above rounding.
    for near in [[0.4, 0.6], [0.6, -0.4]] {
        let end = root(circles::<f64>, near);
        let start = [end[0] + 3e-8, end[1] - 4e-8];
        let (mut coarse, mut fine) =
            (FastNewton::<_>::new(true), FastNewton::<f64, FINE>::finer(true, Some(0.1)));
        let _ = coarse.solve::<2, Direct2<f64>>(&block(), start, circles);
        let (x, _) = fine.solve::<2, Direct2<f64>>(&block(), start, circles);
        assert!(coarse.closed && fine.closed && 0.1 < coarse.ratio && fine.ratio <= 0.1);
        assert_eq!([coarse.evaluations, fine.evaluations], [2, 3]);
        assert!((0..2).all(|k| (x[k] - end[k]).abs() < 1e-15), "{x:?} {end:?}");
        // One that is rounding alone is left as it is.
        let mut again = FastNewton::<f64, FINE>::finer(true, Some(0.1));
        let _ = again.solve::<2, Direct2<f64>>(&block(), x, circles);
        assert_eq!([again.evaluations, fine.evaluations], [1, 3]);
        // A part that no residual can be within ends after that step.
        let mut never = FastNewton::<f64, FINE>::finer(true, Some(0.0));
        let _ = never.solve::<2, Direct2<f64>>(&block(), start, circles);
        assert!(never.closed && never.evaluations == 3);
    }
}

#[test]
fn second_derivatives_are_for_single_numbers_far_from_their_root() {
    const fn asked<S: BlockSolver<T>, T: Scalar>() -> bool {
        S::SECOND_ORDER
    }
    assert!(asked::<FastNewton<f64, FAR>, f64>());
    assert!(!asked::<FastNewton<f64>, f64>());
    assert!(!asked::<FastNewton<Lanes<f64, 4>, FAR>, Lanes<f64, 4>>());
}

#[test]
fn circles_that_do_not_meet_do_not_close() {
    let apart = |x: &[f64; 2]| {
        let (residuals, jacobian) = circles(x);
        ([residuals[0] + 0.48, residuals[1]], jacobian)
    };
    let mut solver = FastNewton::<f64, FAR>::new(true);
    let _ = solver.solve_round::<2, Direct2<f64>>(&block(), [0.3, 0.1], apart, &SECOND);
    assert!(!solver.closed);
}

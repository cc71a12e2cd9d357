//! Blocks of four and more unknowns, eliminated in an order chosen at compile time, against dense elimination. The order is good,
//! or fails, or fails in one of several lanes.

use mbs_runtime::{Kinematic, Lanes, Mechanism, Partitioned, mechanism};
use mechanisms::stephenson::Stephenson;
use mechanisms::three_rrr::ThreeRrr;

/// Relative error of a solution times the margin: both sides lose digits in proportion to the inverse of the margin.
const ERROR: f64 = 1e-12;

/// Factor between the margins of two orders of pivots: the largest multiplier that either accepts.
const MARGINS_APART: f64 = mbs_runtime::__private::LARGEST_MULTIPLIER;

/// Margin below which digits are too few to compare.
const LEAST_MARGIN: f64 = 1e-4;

mechanism! {
    /// Five bars in a ring of two loops without a drive: alpha is free, the other four depend on each other.
    mechanism Ring;
    param m: kg = 1;
    coord theta: rad = 0.3;
    coord alpha: rad = 1.1;
    coord beta: rad = 0.16;
    coord gamma: rad = 1.7;
    coord delta: rad = 0;
    let p = 0.25m*unit(alpha) + rot(beta)*[75mm, -80mm];
    body plate { mass: m, inertia: 0.01 [kg*m^2], com: p, angle: beta }
    constraint four_bar { 0.25m*unit(alpha) + 0.15m*unit(beta) == [300mm, 0] + 0.25m*unit(gamma); }
    constraint rod { [-150mm, 160mm] + 50mm*unit(theta) + 0.3m*unit(delta) == p; }
    independent theta;
}

mechanism! {
    /// A ring of eight bars: each loop shares a bar with the next, the last with the first.
    mechanism Wreath;
    param omega: rad/s = 1;
    coord theta: rad = 0;
    coord a: [rad; 8] = [0.4, 1.3, 2.1, -0.6, 0.9, -1.2, 2.6, 0.2];
    drive crank: theta == omega*t;
    constraint loops {
        2m*unit(a[0]) + 3m*unit(a[1]) == [1m, 2m] + unit(theta)*1m + 1m*unit(a[7]);
        3m*unit(a[1]) + 2m*unit(a[2]) + 1m*unit(a[3]) == [2m, 1m];
        2m*unit(a[3]) + 3m*unit(a[4]) + 1m*unit(a[5]) == [2m, -1m];
        2m*unit(a[5]) + 3m*unit(a[6]) + 1m*unit(a[7]) == [1m, 1m];
    }
}

mechanism! {
    /// Four bars by the places of their joints, whose coupler a crank pushes: the first pivot vanishes where two bars are in line.
    mechanism Coupled;
    coord theta: rad = 0;
    coord a: [m; 2] = [0.5m, 1.1m];
    coord b: [m; 2] = [1.3m, 1.2m];
    let tip = 0.1m*unit(theta);
    let pushed = a + 0.4*(b - a);
    drive crank: theta == t*1rad/1s;
    constraint bars {
        dot(a - [0.5m, 0.4m], a - [0.5m, 0.4m]) == (0.7m)^2;
        dot(b - [1.3m, 0.3m], b - [1.3m, 0.3m]) == (0.9m)^2;
        dot(a - b, a - b) == (0.8m)^2;
        dot(pushed - tip, pushed - tip) == (1.3m)^2;
    }
}

mechanism! {
    /// The same without a drive.
    mechanism CoupledRing;
    param m: kg = 1;
    coord theta: rad = 0;
    coord a: [m; 2] = [0.5m, 1.1m];
    coord b: [m; 2] = [1.3m, 1.2m];
    let tip = 0.1m*unit(theta);
    let pushed = a + 0.4*(b - a);
    body plate { mass: m, inertia: 0.01 [kg*m^2], com: a, angle: theta }
    constraint bars {
        dot(a - [0.5m, 0.4m], a - [0.5m, 0.4m]) == (0.7m)^2;
        dot(b - [1.3m, 0.3m], b - [1.3m, 0.3m]) == (0.9m)^2;
        dot(a - b, a - b) == (0.8m)^2;
        dot(pushed - tip, pushed - tip) == (1.3m)^2;
    }
    independent theta;
}

/// The position with the bars of the first joint in line but for `beside` (m).
fn in_line(mut q: [f64; 5], beside: f64) -> [f64; 5] {
    let (x, y) = (q[1] - 0.5, q[2] - 0.4);
    (q[3], q[4]) = (q[1] + 0.7 * x - beside * y, q[2] + 0.7 * y + beside * x);
    q
}

/// SplitMix64. Source: Steele, Lea & Flood 2014.
struct Sequence(u64);

impl Sequence {
    /// The next number in [−3, 3).
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        6.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 3.0
    }
}

/// Solution and determinant of a dense system, by elimination with complete pivoting.
fn dense<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> ([f64; N], f64) {
    let mut columns: [usize; N] = core::array::from_fn(|column| column);
    let mut determinant = 1.0;
    for k in 0..N {
        let places = (k..N).flat_map(|row| (k..N).map(move |column| (row, column)));
        let largest = places.max_by(|p, q| a[p.0][p.1].abs().total_cmp(&a[q.0][q.1].abs()));
        let (row, column) = largest.expect("a place");
        a.swap(k, row);
        b.swap(k, row);
        a.iter_mut().for_each(|row| row.swap(k, column));
        columns.swap(k, column);
        determinant *= if (row == k) == (column == k) { a[k][k] } else { -a[k][k] };
        let (pivot, right) = (a[k], b[k]);
        for (row, b) in a.iter_mut().zip(&mut b).skip(k + 1) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).for_each(|(entry, above)| *entry -= factor * above);
            *b -= factor * right;
        }
    }
    let mut x = [0.0; N];
    for k in (0..N).rev() {
        let known: f64 = (k + 1..N).map(|j| a[k][j] * x[columns[j]]).sum();
        x[columns[k]] = (b[k] - known) / a[k][k];
    }
    (x, determinant)
}

fn norm(x: impl IntoIterator<Item = f64>) -> f64 {
    x.into_iter().map(|component| component * component).sum::<f64>().sqrt()
}

/// Solves Φ_q x = b with the emitted factors at `q`, and with dense ones; the margin.
fn compare<S: Kinematic<f64, N>, const N: usize>(mechanism: &S, q: &[f64; N], b: &[f64; N]) -> f64 {
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, q, 0.2);
    let (factors, margin) = mechanism.factorize(&parameters, &position);
    if margin.value < LEAST_MARGIN {
        return margin.value;
    }
    let x = mechanism.solve_linear(&factors, b);
    let (expected, _) = dense(mechanism.phi_q(&parameters, &position), *b);
    let error = norm(x.iter().zip(expected).map(|(x, expected)| x - expected)) / norm(expected);
    assert!(error * margin.value < ERROR, "{error} at margin {} and {q:?}", margin.value);
    margin.value
}

/// Compares at `count` random positions; returns the number that were regular enough.
fn at_random<S: Kinematic<f64, N>, const N: usize>(mechanism: &S, count: u32) -> u32 {
    let mut sequence = Sequence(5);
    let mut regular = 0;
    for _ in 0..count {
        let q: [f64; N] = core::array::from_fn(|_| sequence.number());
        let b: [f64; N] = core::array::from_fn(|_| sequence.number());
        regular += u32::from(compare(mechanism, &q, &b) >= LEAST_MARGIN);
    }
    regular
}

#[test]
fn solutions_are_those_of_dense_factors_wherever_the_mechanism_is_regular() {
    assert!(at_random(&Stephenson::default(), 4000) > 3800);
    assert!(at_random(&ThreeRrr::default(), 4000) > 3800);
    assert!(at_random(&Wreath::default(), 4000) > 3500);
    assert!(at_random(&Coupled::default(), 4000) > 3500);
}

#[test]
fn a_pivot_that_vanishes_costs_no_digit() {
    assert!(eliminates::<Coupled>("elimination of a.0 with a.1"));
    let mut sequence = Sequence(7);
    let mut regular = 0;
    for run in 0..600 {
        let q: [f64; 5] = core::array::from_fn(|_| sequence.number());
        let q = in_line(q, [0.0, 1e-15, 1e-9, 1e-6, 1e-3][run % 5]);
        regular += u32::from(compare(&Coupled::default(), &q, &[0.3, -0.2, 0.7, 0.1, 0.4]) >= LEAST_MARGIN);
    }
    assert!(regular > 500, "{regular}");
}

/// `true` if a block of the mechanism is eliminated so.
fn eliminates<S: Mechanism<f64, 5, 5>>(order: &str) -> bool {
    let report = mbs_codegen::structure_of(S::SOURCE, None).expect("a structure");
    report.blocks.iter().any(|block| block.elimination.starts_with(order))
}

/// Components along links have no pivot that vanishes, and their margin has no unit.
#[test]
fn components_along_links_are_measured_alike_in_every_unit() {
    assert!(eliminates::<Stephenson>("elimination of gamma, then delta, then alpha with beta"));
    let mut sequence = Sequence(19);
    for _ in 0..200 {
        let q: [f64; 5] = core::array::from_fn(|_| sequence.number());
        let in_unit = |unit: f64| {
            let mut scaled: Stephenson = Stephenson::default();
            let Stephenson { d, La: a, Lb: b, Ld: c, m, n, fx, fy, r, l, .. } = &mut scaled;
            [d, a, b, c, m, n, fx, fy, r, l].into_iter().for_each(|length| *length *= unit);
            let parameters = scaled.parameters();
            let position = scaled.position(&parameters, &q, 0.2);
            let (factors, margin) = scaled.factorize(&parameters, &position);
            let lengths = [0.7, 0.3, -0.2, 0.5].map(|x| unit * x);
            let b = [lengths[0], lengths[1], lengths[2], lengths[3], 0.3];
            (margin.value, scaled.solve_linear(&factors, &b))
        };
        let (margin, x) = in_unit(1.0);
        for unit in [1e-30, 1e-9, 1e9, 1e30] {
            let (other, y) = in_unit(unit);
            assert!((other - margin).abs() <= ERROR * margin, "{unit}: {other} for {margin}");
            let error = norm(x.iter().zip(y).map(|(x, y)| x - y)) / norm(x);
            assert!(error * margin < ERROR, "{unit}: {error}");
        }
    }
}

#[test]
fn the_sign_of_the_determinant_is_that_of_the_dense_one() {
    // One block with unknowns, and explicit ones: its sign changes with that of the whole matrix, and only with it.
    fn of<S: Kinematic<f64, N>, const N: usize>(mechanism: &S) {
        let mut sequence = Sequence(11);
        let parameters = mechanism.parameters();
        let mut signs = std::collections::BTreeSet::new();
        for _ in 0..400 {
            let q: [f64; N] = core::array::from_fn(|_| sequence.number());
            let position = mechanism.position(&parameters, &q, 0.2);
            let (_, margin) = mechanism.factorize(&parameters, &position);
            let (_, determinant) = dense(mechanism.phi_q(&parameters, &position), [1.0; N]);
            if margin.value > 1e-9 {
                signs.insert((margin.orientation[0] & 1 == 1, determinant < 0.0));
            }
        }
        assert_eq!(signs.len(), 2, "{signs:?}");
    }
    of(&Stephenson::<f64>::default());
    of(&ThreeRrr::<f64>::default());
    of(&Wreath::<f64>::default());
}

#[test]
fn a_lane_whose_pivot_vanishes_takes_the_others_along_and_all_are_right() {
    let lanes: Coupled<Lanes<f64, 4>> = Coupled::default();
    let alone: Coupled = Coupled::default();
    let mut sequence = Sequence(13);
    for vanishing in 0..5 {
        let q: [[f64; 4]; 5] = core::array::from_fn(|_| core::array::from_fn(|_| sequence.number()));
        let mut q = q;
        if vanishing < 4 {
            let vanished = in_line(q.map(|values| values[vanishing]), 0.0);
            q.iter_mut().zip(vanished).for_each(|(values, value)| values[vanishing] = value);
        }
        let parameters = lanes.parameters();
        let position = lanes.position(&parameters, &q.map(Lanes), Lanes([0.2; 4]));
        let (factors, margin) = lanes.factorize(&parameters, &position);
        let x = lanes.solve_linear(&factors, &[Lanes([0.5, -0.3, 0.2, 0.9]); 5]);
        for (lane, b) in [0.5, -0.3, 0.2, 0.9].into_iter().enumerate() {
            let parameters = alone.parameters();
            let position = alone.position(&parameters, &q.map(|values| values[lane]), 0.2);
            let (factors, own) = alone.factorize(&parameters, &position);
            let expected = alone.solve_linear(&factors, &[b; 5]);
            for (x, expected) in x.iter().zip(expected) {
                let difference = (x.0[lane] - expected).abs() * own.value;
                assert!(difference <= ERROR * (1.0 + expected.abs()), "lane {lane}: {difference}");
            }
            // Beside a lane that pivots, all do: another order, whose margin is the same but for its multipliers.
            let ratio = margin.value.0[lane] / own.value;
            assert!((1.0 / MARGINS_APART..MARGINS_APART).contains(&ratio), "lane {lane}: {ratio}");
        }
    }
}

#[test]
fn transposed_systems_balance_forces() {
    balances(&Ring::default(), |q| q);
    balances(&CoupledRing::default(), |q| in_line(q, 0.0));
}

/// Forces that balance at random positions, of which each fourth one is changed by `vanishing`.
fn balances<S>(ring: &S, vanishing: impl Fn([f64; 5]) -> [f64; 5])
where
    S: Partitioned<f64, 5, 4>,
{
    let parameters = ring.parameters();
    let mut sequence = Sequence(17);
    let mut regular = 0;
    for run in 0..400 {
        let mut q: [f64; 5] = core::array::from_fn(|_| sequence.number());
        if run % 4 == 0 {
            q = vanishing(q);
        }
        let y: [f64; 5] = core::array::from_fn(|_| sequence.number());
        let position = ring.position(&parameters, &q, 0.0);
        let (partition, margin) = ring.partition(&parameters, &position);
        if margin.value < LEAST_MARGIN {
            continue;
        }
        regular += 1;
        let mut reduced = y;
        let lambda = ring.reduce(&partition, &mut reduced);
        let phi_q = ring.phi_q(&parameters, &position);
        let size = lambda.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        for column in 1..5 {
            let balance: f64 = (0..4).map(|row| phi_q[row][column] * lambda[row]).sum();
            assert!((balance - y[column]).abs() < ERROR * size, "{balance} for {}", y[column]);
        }
        let rest: f64 = (0..4).map(|row| phi_q[row][0] * lambda[row]).sum();
        assert!((reduced[0] - (y[0] - rest)).abs() < ERROR * size);
    }
    assert!(regular > 350, "{regular}");
}

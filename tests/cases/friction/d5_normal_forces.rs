//! D5: normal forces that depend on each other, N = N₀ + B |N|: found if there is one solution, counted if there are several.
//!
//! `Locked` was the answer if Picard's iteration did not converge, as next to a sign change of N₀ with b = 0.34.

use mbs_cases::every;
use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// Pins that a cart drags along: each presses on its guide, and its friction presses the others.
    mechanism Rack;
    const K: 1 = 8;
    param press: [1; K, K] = 0;
    param push: [N; K] = 0;
    coord x: m = 0;
    coord y: [m; K] = 0;
    body cart { mass: 1, com: [x, 0] }
    for i in 0..K {
        body pin { mass: 1, com: [0, y[i]] }
        force load: push[i] on y[i];
        friction rub {
            along: x - sum(j in 0..K: press[j, i]*y[j]), normal: lambda(guide[i]), coefficient: 1, speed: 1mm/1s
        }
    }
    constraint guide { for i in 0..K { y[i] == 0; } }
}

mechanism! {
    /// The same with twelve pins.
    mechanism LongRack;
    const K: 1 = 12;
    param press: [1; K, K] = 0;
    param push: [N; K] = 0;
    coord x: m = 0;
    coord y: [m; K] = 0;
    body cart { mass: 1, com: [x, 0] }
    for i in 0..K {
        body pin { mass: 1, com: [0, y[i]] }
        force load: push[i] on y[i];
        friction rub {
            along: x - sum(j in 0..K: press[j, i]*y[j]), normal: lambda(guide[i]), coefficient: 1, speed: 1mm/1s
        }
    }
    constraint guide { for i in 0..K { y[i] == 0; } }
}

/// Random numbers between −1 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// x of a x = b by elimination with pivoting.
fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let above = a[k].clone();
            a[i].iter_mut().zip(above).for_each(|(entry, above)| *entry -= factor * above);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}

/// All solutions of w = c + B |w|, by trying every pattern of signs.
fn enumerated(b: &[Vec<f64>], c: &[f64]) -> Vec<Vec<f64>> {
    let k = c.len();
    let mut found = Vec::new();
    for pattern in 0..1_u32 << k {
        let sign = |j: usize| if pattern >> j & 1 == 1 { -1.0 } else { 1.0 };
        let matrix =
            (0..k).map(|i| (0..k).map(|j| f64::from(i == j) - b[i][j] * sign(j)).collect()).collect();
        let w = solved(matrix, c.to_vec());
        if (0..k).all(|j| w[j] * sign(j) > 0.0) {
            found.push(w);
        }
    }
    found
}

/// Normal forces of `Rack`s from the runtime, in the order of a text that drags at 1 m/s.
macro_rules! answered {
    ($rack:ident, $k:literal, $b:expr, $c:expr) => {{
        let (b, c): (&[Vec<f64>], &[f64]) = ($b, $c);
        let at = |j: usize, i: usize| b.get(j).and_then(|row| row.get(i)).copied().unwrap_or(0.0);
        let rack = $rack {
            press: core::array::from_fn(|j| core::array::from_fn(|i| at(j, i))),
            push: core::array::from_fn(|j| c.get(j).copied().unwrap_or(0.0)),
        };
        let mut qd = [0.0; $k + 1];
        qd[0] = 1.0;
        let method = Explicit::new(RungeKutta4, Projection::default());
        Simulation::start(rack, method, 0.0, [0.0; $k + 1], qd).map(|run| run.lambda().to_vec())
    }};
}

/// Kind of the answer (0 locked, 1 unique, 2 all of several, 3 some of several) and relative error of a unique solution.
fn judged(b: &[Vec<f64>], c: &[f64], answer: Result<Vec<f64>, Failure>) -> (usize, f64) {
    let truth = enumerated(b, c);
    match (truth.as_slice(), answer) {
        ([], Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. })) => (0, 0.0),
        ([w], Ok(lambda)) => {
            let size = w.iter().fold(0.0_f64, |size, w| size.max(w.abs()));
            (1, w.iter().zip(&lambda).fold(0.0, |error: f64, (w, found)| error.max((w - found).abs() / size)))
        }
        (several, Err(Failure { kind: FailureKind::Ambiguous { solutions, all, .. }, .. }))
            if several.len() > 1 =>
        {
            assert!(if all {
                solutions as usize == several.len()
            } else {
                solutions as usize <= several.len()
            });
            (2 + usize::from(!all), 0.0)
        }
        (truth, answer) => panic!("{} solutions, answered {answer:?} for {b:?}, {c:?}", truth.len()),
    }
}

#[test]
fn one_normal_force_next_to_its_sign_change_is_found() {
    for b in [0.34, 0.78, 0.999, -0.34, -0.999, -3.0, 1.2, 3.0] {
        for push in [-1.0, -1e-3, -1e-9, 1e-9, 1e-3, 1.0] {
            let (_, error) = judged(&[vec![b]], &[push], answered!(Rack, 8, &[vec![b]], &[push]));
            // 1/(1 − b) times rounding.
            assert!(error < 1e-13 / (1.0 - f64::abs(b)).abs(), "{b} {push}: {error:e}");
        }
    }
}

#[test]
fn normal_forces_that_change_each_other_agree_with_enumeration() {
    let mut random = Random(0x5eed_0005);
    let mut kinds = [0; 4];
    let mut worst = 0.0_f64;
    for round in (0..1600).step_by(every(3)) {
        let k = 1 + round % 8;
        // From weak to stronger than a single solution is certain for.
        let size = [0.3, 0.9, 1.5, 4.0][round / 8 % 4] / (k as f64).sqrt();
        let b: Vec<Vec<f64>> = (0..k).map(|_| (0..k).map(|_| size * random.next()).collect()).collect();
        let c: Vec<f64> = (0..k).map(|_| random.next()).collect();
        let (kind, error) = judged(&b, &c, answered!(Rack, 8, &b, &c));
        kinds[kind] += 1;
        worst = worst.max(error);
    }
    println!("none {}, one {}, several {}; worst {worst:.1e}", kinds[0], kinds[1], kinds[2]);
    // Rounding times the condition of I − B S, at worst some 1e4 of 1600.
    assert!(
        worst < 1e-10 && kinds[3] == 0 && kinds[..3].iter().all(|kind| *kind > 20),
        "{kinds:?} {worst:e}"
    );
}

#[test]
fn an_iteration_that_hardly_contracts_is_not_called_locked() {
    let mut random = Random(0x5eed_0999);
    let mut worst = 0.0_f64;
    for _ in 0..400 {
        let k = 8;
        let mut b: Vec<Vec<f64>> = (0..k).map(|_| (0..k).map(|_| random.next()).collect()).collect();
        // The spectral radius of |B| by 200 steps of the power method, put to 0.999.
        let mut x = vec![1.0; k];
        let mut radius = 0.0;
        for _ in 0..200 {
            let y: Vec<f64> =
                b.iter().map(|row| row.iter().zip(&x).map(|(b, x)| b.abs() * x).sum()).collect();
            radius = y.iter().fold(0.0, |most: f64, y| most.max(*y));
            x = y.iter().map(|y| y / radius).collect();
        }
        b.iter_mut().flatten().for_each(|b| *b *= 0.999 / radius);
        let c: Vec<f64> = (0..k).map(|_| random.next()).collect();
        let (kind, error) = judged(&b, &c, answered!(Rack, 8, &b, &c));
        assert_eq!(kind, 1);
        worst = worst.max(error);
    }
    assert!(worst < 1e-11, "{worst:e}");
}

#[test]
fn twelve_normal_forces_agree_with_enumeration() {
    let mut random = Random(0x5eed_0012);
    let mut kinds = [0; 4];
    let mut worst = 0.0_f64;
    for round in (0..48).step_by(every(7)) {
        let size = [0.1, 0.25, 0.4, 0.6][round % 4];
        let b: Vec<Vec<f64>> = (0..12).map(|_| (0..12).map(|_| size * random.next()).collect()).collect();
        let c: Vec<f64> = (0..12).map(|_| random.next()).collect();
        let (kind, error) = judged(&b, &c, answered!(LongRack, 12, &b, &c));
        kinds[kind] += 1;
        worst = worst.max(error);
    }
    println!("none {}, one {}, several {}; worst {worst:.1e}", kinds[0], kinds[1], kinds[2]);
    assert!(worst < 1e-10 && kinds[3] == 0, "{kinds:?} {worst:e}");
}

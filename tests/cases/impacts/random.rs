//! Impacts with friction of random masses, contacts and speeds: no gain of energy, and the law of each contact holds.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, MoreauJean, Projection, Simulation};
use mbs_runtime::{FailureKind, mechanism};

mechanism! {
    /// Four coordinates of any mass matrix, two contacts with friction that touch.
    pub mechanism Masses;
    param l1: [1; 4] = 1;
    param l2: [1; 4] = 1;
    param l3: [1; 4] = 1;
    param l4: [1; 4] = 1;
    param n1: [1; 4] = 1;
    param n2: [1; 4] = 1;
    param s1: [1; 4] = 1;
    param s2: [1; 4] = 1;
    param v: [m/s; 4] = 1;
    param e1: 1 = 0;
    param e2: 1 = 0;
    param mu1: 1 = 0;
    param mu2: 1 = 0;
    coord x: [m; 4] = 0;
    kinetic T = 0.5kg*(dot(l1, der(x))^2 + dot(l2, der(x))^2 + dot(l3, der(x))^2 + dot(l4, der(x))^2);
    contact c1 { gap: dot(n1, x), restitution: e1 }
    contact c2 { gap: dot(n2, x), restitution: e2 }
    friction f1 { along: dot(s1, x), normal: normal(c1), coefficient: mu1, sticks: mu1 }
    friction f2 { along: dot(s2, x), normal: normal(c2), coefficient: mu2, sticks: mu2 }
    start x = 0 rate v;
}

/// A number from 0 to 1, scattered.
fn fraction(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Masses, contacts and speeds of a seed; `most` is the largest coefficient of friction.
fn seeded(seed: u64, most: f64) -> Masses<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1;
    let mut any = |from: f64, to: f64| from + (to - from) * fraction(&mut state);
    let mut factor = |index: usize| {
        let mut row = [0.0; 4].map(|_: f64| any(-1.0, 1.0));
        row[index] += 1.5;
        row
    };
    let [l1, l2, l3, l4] = [factor(0), factor(1), factor(2), factor(3)];
    let mut some = || [0.0; 4].map(|_: f64| any(-1.0, 1.0));
    let [n1, n2, s1, s2, mut v] = [some(), some(), some(), some(), some()];
    // Both approach, or one does and the other one moves away.
    let closing = |n: &[f64; 4], v: &[f64; 4]| n.iter().zip(v).map(|(n, v)| n * v).sum::<f64>();
    if closing(&n1, &v) > 0.0 {
        v = v.map(|v| -v);
    }
    Masses {
        l1,
        l2,
        l3,
        l4,
        n1,
        n2,
        s1,
        s2,
        v,
        e1: any(0.0, 1.0),
        e2: any(0.0, 1.0),
        mu1: any(0.0, most),
        mu2: any(0.0, most),
    }
}

const SEEDS: u64 = if cfg!(feature = "long") { 3000 } else { 150 };

fn along(row: &[f64; 4], v: &[f64; 4]) -> f64 {
    row.iter().zip(v).map(|(row, v)| row * v).sum()
}

/// Impulses of n1, s1, n2, s2 that lead from the start to the velocities `v`: M (v − v₀) = Jᵀ P.
fn impulses(masses: &Masses<f64>, v: &[f64; 4]) -> [f64; 4] {
    let factors = [&masses.l1, &masses.l2, &masses.l3, &masses.l4];
    let columns = [&masses.n1, &masses.s1, &masses.n2, &masses.s2];
    let jump: [f64; 4] = std::array::from_fn(|index| v[index] - masses.v[index]);
    let mut system: [[f64; 5]; 4] = std::array::from_fn(|row| {
        let right = factors.iter().map(|l| l[row] * along(l, &jump)).sum();
        std::array::from_fn(|column| if column < 4 { columns[column][row] } else { right })
    });
    for k in 0..4 {
        let pivot = (k..4).max_by(|a, b| system[*a][k].abs().total_cmp(&system[*b][k].abs())).expect("rows");
        system.swap(k, pivot);
        for row in (0..4).filter(|row| *row != k) {
            let share = system[row][k] / system[k][k];
            let upper = system[k];
            system[row].iter_mut().zip(upper).for_each(|(entry, upper)| *entry -= share * upper);
        }
    }
    std::array::from_fn(|row| system[row][4] / system[row][row])
}

fn energy(masses: &Masses<f64>, v: &[f64; 4]) -> f64 {
    let squares = [&masses.l1, &masses.l2, &masses.l3, &masses.l4].map(|l| along(l, v).powi(2));
    0.5 * squares.iter().sum::<f64>()
}

#[test]
fn no_impact_brings_in_energy() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (most, allowed) in [(0.3, 50), (1.5, 4)] {
        let (mut refused, mut struck, mut slides, mut sticks, mut lowered) = (0, 0, 0, 0, 0);
        for seed in 0..SEEDS {
            let masses = seeded(seed, most);
            let ended = Simulation::start_from_text(masses, method, 0.0_f64)
                .and_then(|mut run| run.advance_to(1e-6).map(|()| run));
            let run = match ended {
                Ok(run) => run,
                Err(failure) => {
                    let typed = matches!(
                        failure.kind,
                        FailureKind::ImpactUndecided { .. } | FailureKind::ContactUndecided { .. }
                    );
                    assert!(typed, "{seed}: {failure}");
                    refused += 1;
                    continue;
                }
            };
            let (before, after) = (energy(&masses, &masses.v), energy(&masses, run.qd()));
            struck += u64::from(after != before);
            let [p1, t1, p2, t2] = impulses(&masses, run.qd());
            // A thousand roundings of the works, which are large where rows nearly follow from each other.
            let parts = [(&masses.n1, p1), (&masses.s1, t1), (&masses.n2, p2), (&masses.s2, t2)];
            let works: f64 = parts.iter().map(|(row, p)| (p * along(row, &masses.v)).abs()).sum();
            assert!(after <= before + 2e-13 * (before + works), "{seed}: {before} {after} {works}");
            let size = p1.abs() + p2.abs() + t1.abs() + t2.abs();
            let pairs = [
                ((&masses.n1, &masses.s1), (p1, t1), (masses.mu1, masses.e1)),
                ((&masses.n2, &masses.s2), (p2, t2), (masses.mu2, masses.e2)),
            ];
            // Where both close there is one impact; without a loss its restitution was lowered.
            let once = pairs.iter().all(|((n, _), _, _)| along(n, &masses.v) < 0.0);
            let rounding = 1e-9 * (1.0 + works);
            let lost = after < before - rounding;
            for ((n, s), (p, t), (mu, e)) in pairs {
                let [gap, slip] = [n, s].map(|row| along(row, run.qd()));
                let place = format!("{seed}: {gap} {slip} {p} {t} of {mu}");
                assert!(gap >= -1e-10 && p >= -1e-8 * size, "{place}");
                assert!(t.abs() <= mu * p + 1e-8 * size, "{place}");
                if once {
                    let approach = along(n, &masses.v);
                    let slides = slip.abs() > 1e-9;
                    assert!(!slides || (t + slip.signum() * mu * p).abs() < 1e-8 * size, "{place}");
                    assert!(gap >= -e * approach - rounding || !lost, "{place}");
                    assert!(p < 1e-8 * size || (gap + e * approach).abs() < rounding || !lost, "{place}");
                    lowered += u32::from(!lost);
                }
                slides += u32::from(slip.abs() > 1e-9 && p > 1e-6 * size);
                sticks += u32::from(slip.abs() < 1e-9 && p > 1e-6 * size);
            }
        }
        assert!(allowed * refused <= SEEDS && 2 * struck >= SEEDS, "{most}: {refused} {struck} of {SEEDS}");
        assert!(u64::from(slides) > SEEDS / 4 && u64::from(sticks) > SEEDS / 20, "{most}: {slides} {sticks}");
        // Newton's law brings in energy in some impacts with much friction.
        assert!(lowered > 0 || most < 1.0, "{most}: {lowered}");
    }
}

/// One step over the same impacts: no gain of energy, impulses within their cones, gaps that open or stay.
#[test]
fn no_step_over_impacts_brings_in_energy() {
    for most in [0.3, 1.5] {
        let (mut refused, mut struck, mut at_limit) = (0, 0, 0);
        for seed in 0..SEEDS {
            let masses = seeded(seed, most);
            let run = Simulation::start(masses, MoreauJean, 0.0_f64, [0.0; 4], masses.v);
            let ended = run.and_then(|mut run| run.step(1e-3).map(|()| run));
            let run = match ended {
                Ok(run) => run,
                Err(failure) => {
                    let typed = matches!(failure.kind, FailureKind::ContactUndecided { .. });
                    assert!(typed, "{seed}: {failure}");
                    refused += 1;
                    continue;
                }
            };
            let (before, after) = (energy(&masses, &masses.v), energy(&masses, run.qd()));
            let [p1, t1, p2, t2] = impulses(&masses, run.qd());
            let parts = [(&masses.n1, p1), (&masses.s1, t1), (&masses.n2, p2), (&masses.s2, t2)];
            let works: f64 = parts.iter().map(|(row, p)| (p * along(row, &masses.v)).abs()).sum();
            assert!(after <= before + 1e-12 * (before + works), "{seed}: {before} {after} {works}");
            struck += u64::from(after < before);
            let size = p1.abs() + p2.abs() + t1.abs() + t2.abs();
            for (n, (p, t), mu) in [(&masses.n1, (p1, t1), masses.mu1), (&masses.n2, (p2, t2), masses.mu2)] {
                let place = format!("{seed}: {p} {t} of {mu}");
                // A contact that separates before the step is open in it.
                let open = along(n, &masses.v) > 0.0;
                assert!(open || along(n, run.qd()) >= -1e-10, "{place}");
                assert!(p >= -1e-8 * size && t.abs() <= mu * p + 1e-8 * size, "{place}");
                at_limit += u64::from(p > 1e-8 * size && mu * p < t.abs() + 1e-8 * size);
            }
        }
        assert!(
            refused <= SEEDS / 30 && 2 * struck > SEEDS && 4 * at_limit > SEEDS,
            "{refused} {struck} {at_limit}"
        );
    }
}

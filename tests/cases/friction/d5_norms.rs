//! D5: normal forces that are norms of two multipliers each and depend on each other: solutions are counted if the iteration does
//! not contract.
//!
//! `Ambiguous` with `all: false` was the answer, for one solution, none and several alike.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method, Projection,
    Simulation, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// Two collars that a cart drags along, each held in two directions: the friction of each presses on both.
    mechanism Collars;
    param press: [1; 2, 4] = 0;
    param load: [N; 4] = 0;
    param mu: 1 = 1;
    coord x: m = 0;
    coord y: [m; 4] = 0;
    body cart { mass: 1, com: [x, 0] }
    for i in 0..4 {
        body pin { mass: 1, com: [0, y[i]] }
        force push: load[i] on y[i];
    }
    constraint guide { for i in 0..4 { y[i] == 0; } }
    friction first {
        along: x - sum(j in 0..4: press[0, j]*y[j]), normal: hypot(lambda(guide[0]), lambda(guide[1])),
        coefficient: mu, speed: 1mm/1s
    }
    friction second {
        along: x - sum(j in 0..4: press[1, j]*y[j]), normal: hypot(lambda(guide[2]), lambda(guide[3])),
        coefficient: mu, speed: 1mm/1s
    }
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

/// λ of the guides at normal forces `n`: load and friction, each by its share.
fn forces(collars: &Collars, n: [f64; 2]) -> [f64; 4] {
    let share = |j: usize| collars.press[0][j] * n[0] + collars.press[1][j] * n[1];
    core::array::from_fn(|j| collars.load[j] + collars.mu * share(j))
}

/// Solutions if `press[0]` of the second collar's guides is 0. Then n₂ is a root of its own quadratic equation, and n₁ of another
/// for each n₂. None if one of them nearly vanishes or doubles.
fn in_turn(collars: &Collars) -> Option<Vec<[f64; 2]>> {
    let roots = |c: [f64; 2], b: [f64; 2]| {
        let (leading, half) = (1.0 - b[0] * b[0] - b[1] * b[1], b[0] * c[0] + b[1] * c[1]);
        let last = c[0] * c[0] + c[1] * c[1];
        let square = half * half + leading * last;
        let regular = square.abs() > 1e-3 * (half * half + last) && leading.abs() > 1e-2;
        let roots = [-1.0, 1.0].into_iter().filter(move |_| square > 0.0);
        let roots = roots.map(move |sign| (half + sign * square.sqrt()) / leading);
        regular.then(|| roots.filter(|root| *root > 0.0).collect::<Vec<_>>())
    };
    let b = |norm: usize, by: usize| [0, 1].map(|k| collars.mu * collars.press[by][2 * norm + k]);
    let mut found = Vec::new();
    for second in roots([collars.load[2], collars.load[3]], b(1, 1))? {
        let c = [0, 1].map(|k| collars.load[k] + b(0, 1)[k] * second);
        found.extend(roots(c, b(0, 0))?.into_iter().map(|first| [first, second]));
    }
    Some(found)
}

fn start(collars: Collars, method: impl Method<Collars, f64, 5, 4>) -> Result<[f64; 4], Failure> {
    Simulation::start(collars, method, 0.0, [0.0; 5], [1.0, 0.0, 0.0, 0.0, 0.0]).map(|run| *run.lambda())
}

#[test]
fn two_norms_that_do_not_contract_are_counted_by_every_method() {
    let mut random = Random(0x5eed_0d05);
    let mut counts = [0; 5];
    for round in 0..600 {
        let mut collars = Collars::default();
        collars.press.iter_mut().flatten().for_each(|share| *share = 1.2 * random.next());
        collars.press[0][2..].fill(0.0);
        collars.load.iter_mut().for_each(|load| *load = 100.0 * random.next());
        let Some(known) = in_turn(&collars) else { continue };
        let answers = [
            start(collars, Explicit::new(DormandPrince8, Projection::default())),
            start(collars, Explicit::new(DormandPrince8, VelocityTransformation)),
            start(collars, AugmentedLagrangian),
            start(collars, Extrapolated),
            start(collars, GeneralizedAlpha::default()),
        ];
        for answer in answers {
            match (known.as_slice(), answer) {
                ([], Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. })) => {}
                ([n], Ok(lambda)) => {
                    for (found, known) in lambda.iter().zip(forces(&collars, *n)) {
                        let size = 100.0 + n[0] + n[1];
                        assert!((found - known).abs() < 1e-10 * size, "{round}: {found} of {known}");
                    }
                }
                (
                    [_, _, ..],
                    Err(Failure { kind: FailureKind::Ambiguous { solutions, all: true, .. }, .. }),
                ) => {
                    assert_eq!(solutions as usize, known.len(), "{round}");
                }
                (known, answer) => panic!("{round}: {known:?}, answered {answer:?}"),
            }
        }
        counts[known.len()] += 1;
    }
    assert!(counts[..3].iter().all(|count| *count > 50) && counts[4] > 3, "{counts:?}");
}

#[test]
fn two_norms_in_both_directions_end_in_balance_and_are_never_left_open() {
    let mut random = Random(0x5eed_0d06);
    let mut counts = [0; 3];
    for round in 0..600 {
        let mut collars = Collars::default();
        collars.press.iter_mut().flatten().for_each(|share| *share = 0.9 * random.next());
        collars.load.iter_mut().for_each(|load| *load = 100.0 * random.next());
        match start(collars, Explicit::new(DormandPrince8, Projection::default())) {
            Ok(lambda) => {
                let n = [lambda[0].hypot(lambda[1]), lambda[2].hypot(lambda[3])];
                let size = 100.0 + n[0] + n[1];
                for (found, known) in lambda.iter().zip(forces(&collars, n)) {
                    assert!((found - known).abs() < 1e-10 * size, "{round}: {found} of {known}");
                }
                counts[1] += 1;
            }
            Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. }) => counts[0] += 1,
            Err(Failure { kind: FailureKind::Ambiguous { all: true, solutions: 2.., .. }, .. }) => {
                counts[2] += 1
            }
            Err(failure) => panic!("{round}: {failure}"),
        }
    }
    assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
}

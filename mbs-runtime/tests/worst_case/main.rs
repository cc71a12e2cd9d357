//! Operations of steps of bounded work, counted one by one, against their largest count.
#![forbid(unsafe_code)]

mod counted;

use counted::{Counted, counted};
use mbs_runtime::{
    Budget, Failure, FailureKind, Kinematic, Mechanism, Operations, Signal, Step, Stepper, WorstCase,
    mechanism,
};

mechanism! {
    /// A four-bar on a crank of prescribed speed, a slide with a working range behind it.
    pub mechanism Press;
    param crank: m = 0.10;
    input speed: rad/s, rates;
    coord phi: [rad; 3] = [0.3, 0.9, 1.8];
    coord x: m = 0.1;
    coord y: m = 0.2;
    constraint closure { crank*unit(phi[0]) + 0.25m*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
    constraint slide { hypot(x, 0.1m) == 0.05m*(3 + cos(phi[2])); }
    constraint gauge { y == x + abs(x)*max(sin(phi[1]), 0.1); }
    drive motor: rate(phi[0]) == speed*(1 + 0.1*sin(3*t/1s));
    branch open: sin(phi[2] - phi[1]) > 0;
    limit stroke: -1m <= x <= 0.105m;
}

mechanism! {
    /// A platform on three rods: one block of three.
    pub mechanism Platform;
    param rod: [m; 3] = [0.40, 0.45, 0.50];
    coord p: [m; 2] = [0.3, 0.35];
    coord a: rad = 0.1;
    constraint first { dot(p, p) == rod[0]^2 + (0.01m)^2*sin(t/1s); }
    constraint second {
        dot(p + 0.2m*unit(a) - [0.5m, 0], p + 0.2m*unit(a) - [0.5m, 0]) == rod[1]^2;
        dot(p + 0.2m*unit(a + 1) - [0.2m, 0.8m], p + 0.2m*unit(a + 1) - [0.2m, 0.8m]) == rod[2]^2;
    }
}

mechanism! {
    /// Five angles that turn each other: a block by elimination.
    pub mechanism Ring;
    param gain: 1 = 0.3;
    coord a: [rad; 5] = [0.1, 0.1, 0.1, 0.1, 0.1];
    constraint ring {
        for i in 0..4 { a[i] + gain*sin(a[i + 1]) == 0.2*sin((1 + i)*t/1s); }
        a[4] + gain*sin(a[0]) == 0.5;
    }
}

mechanism! {
    /// Two angles whose rows agree about nothing where `k` is 1: no step ever finds a position.
    pub mechanism Stuck;
    param k: 1 = -1;
    param far: rad = 0.1;
    coord x: rad = 0;
    coord y: rad = 0;
    constraint both {
        x + y + 0.2*sin(x + y) == far + 0.1*sin(t/1s);
        x + k*y + 0.2*cos(x + k*y) == 0.3;
    }
}

mechanism! {
    /// A plate on three cranks, one more than it needs, which may be too long; a slide doubled, and one on its own.
    pub mechanism Plate;
    param longer: m = 0;
    param far: rad = 0.1;
    coord a: rad = 0.5;
    coord b: rad = 0.5;
    coord c: rad = 0.5;
    coord psi: rad = 0;
    coord x: m = 0.1;
    constraint first redundant { 0.06m*unit(a) + 0.16m*unit(psi) == [0.16m, 0] + (0.06m + longer)*unit(b); }
    constraint second redundant {
        0.06m*unit(a) + 0.08m*unit(psi) + 0.07m*unit(psi + TAU/4) == [0.08m, 0.07m] + 0.06m*unit(c);
    }
    constraint slide redundant { x^2 + 0.1m*x == (0.02m)^2*(2 + cos(c)); 2*x^2 + 0.2m*x == 2*(0.02m)^2*(2 + cos(c)); }
    drive motor: a == far + 0.4 + sin(3*t/1s);
    branch level: cos(psi) > 0;
}

mechanism! {
    /// Three rows for two angles that agree about nothing where `k` is not 1.
    pub mechanism Torn;
    param k: 1 = 1;
    param far: rad = 0.1;
    coord x: rad = 0;
    coord y: rad = 0;
    constraint all redundant {
        x + y + 0.2*sin(x + y) == far + 0.1*sin(t/1s);
        x - y + 0.2*sin(x - y) == 0.2;
        k*(x + y + 0.2*sin(x + y)) + (k - 1)*sin(40*x) == k*far + k*0.1*sin(t/1s);
    }
}

/// Budgets from the least to more than any block needs.
const BUDGETS: [Budget; 7] = [
    Budget { newton: 0, fallback: 0 },
    Budget { newton: 1, fallback: 0 },
    Budget { newton: 2, fallback: 1 },
    Budget { newton: 4, fallback: 0 },
    Budget { newton: 3, fallback: 40 },
    Budget { newton: 30, fallback: 120 },
    Budget::DEFAULT,
];

/// Outcomes of the steps of a run.
#[derive(Debug, Default)]
struct Ends {
    done: u32,
    degraded: u32,
    refused: u32,
    fallbacks: u32,
    singular: u32,
    beyond: u32,
}

/// Counts `steps` steps of each budget; `disturb` changes the mechanism before a step.
fn run<S, const N: usize, const M: usize>(mechanism: S, steps: u32, disturb: impl Fn(u32, &mut S)) -> Ends
where
    S: Kinematic<Counted, N, M> + WorstCase + Copy,
{
    let mut ends = Ends::default();
    for budget in BUDGETS {
        let most = budget.worst_case::<S>();
        let guess = mechanism.guess(&mechanism.parameters());
        let mut stepper = Stepper::assemble(mechanism, guess, Counted(0.0)).unwrap();
        for k in 1..=steps {
            stepper.change(|mechanism| disturb(k, mechanism));
            // A smooth run with a long step now and then; back and forth.
            let part = (f64::from(k) * 0.618_033_988_749_895).fract() - 0.4;
            let h = if k % 7 == 0 { 2.0 * part } else { 0.02 * part };
            let h = if k % 97 == 0 { f64::NAN } else { h };
            let (step, cost) = counted(|| stepper.step(Counted(h), budget));
            assert!(cost.within(most), "{} {budget:?}, step {k}:\n{cost}\n{most}\n{step:?}", S::NAME);
            match step {
                Step::Done(statistics) | Step::Degraded { statistics, .. } => {
                    ends.fallbacks += u32::from(statistics.fallback);
                    ends.done += u32::from(matches!(step, Step::Done(_)));
                    ends.degraded += u32::from(matches!(step, Step::Degraded { .. }));
                }
                Step::Refused(failure) => {
                    ends.refused += 1;
                    ends.singular +=
                        u32::from(matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }));
                    ends.beyond +=
                        u32::from(matches!(failure, Failure { kind: FailureKind::BeyondLimit { .. }, .. }));
                }
            }
        }
    }
    ends
}

fn signal(value: f64) -> Signal<Counted> {
    Signal { value: Counted(value), rate: Counted(0.1), acceleration: Counted(0.0) }
}

#[test]
fn no_step_costs_more_than_its_worst_case() {
    let press = run(Press::<Counted>::default(), 400, |k, press| {
        press.speed = signal(if k % 50 == 0 { f64::INFINITY } else { 3.0 + f64::from(k % 5) });
        // At 0.15 m the crank locks up.
        press.crank = Counted(if k / 100 == 2 { 0.15 } else { 0.10 });
    });
    println!("{press:?}");
    assert!(press.done > 300 && press.degraded > 10 && press.refused > 50 && press.beyond > 0, "{press:?}");
    let platform = run(Platform::<Counted>::default(), 300, |k, platform| {
        // Rods that reach each other, just so, and not at all.
        platform.rod[0] = Counted([0.40, 0.40, 0.42, 0.40, 0.3, 2.0][(k / 50) as usize % 6]);
    });
    println!("{platform:?}");
    assert!(platform.done > 200 && platform.fallbacks > 0 && platform.refused > 50, "{platform:?}");
    let ring = run(Ring::<Counted>::default(), 300, |k, ring| {
        ring.gain = Counted([0.3, 0.9, 1.0, 5.0][(k / 75) as usize % 4]);
    });
    println!("{ring:?}");
    assert!(ring.done > 200 && ring.degraded + ring.refused > 20, "{ring:?}");
    let stuck = run(Stuck::<Counted>::default(), 300, |k, stuck| {
        stuck.k = Counted([-1.0, 0.99, 1.0, 1.0 - 1e-6, -1.0][(k / 60) as usize % 5]);
    });
    println!("{stuck:?}");
    assert!(stuck.done > 100 && stuck.refused > 100, "{stuck:?}");
}

#[test]
fn no_step_of_blocks_with_surplus_rows_costs_more_than_its_worst_case() {
    let plate = run(Plate::<Counted>::default(), 300, |k, plate| {
        // Fits, all but fits, does not fit; then a crank that jumps.
        plate.longer = Counted([0.0, 0.0, 1e-9, 0.02][(k / 75) as usize % 4]);
        plate.far = Counted(if k % 20 == 0 { 40.0 } else { 0.1 });
    });
    println!("{plate:?}");
    assert!(plate.done > 200 && plate.fallbacks > 0 && plate.refused > 50, "{plate:?}");
    let torn = run(Torn::<Counted>::default(), 300, |k, torn| {
        torn.k = Counted([1.0, 2.0, 1.0, 0.0][(k / 75) as usize % 4]);
        torn.far = Counted(if k % 30 == 0 { 1e3 } else { 0.1 });
    });
    println!("{torn:?}");
    assert!(torn.done > 200 && torn.fallbacks > 0 && torn.refused > 50, "{torn:?}");
}

/// Operations of a step from a regular state whose rows agree about nothing and lie far away. It does not come to the homotopy,
/// each evaluation of which costs up to four times as much as one of Newton's method in a mechanism of few operations.
fn hopeless(budget: Budget) -> Operations {
    let stuck = Stuck::<Counted>::default();
    let guess = stuck.guess(&stuck.parameters());
    let mut stepper = Stepper::assemble(stuck, guess, Counted(0.0)).unwrap();
    stepper.change(|stuck| (stuck.k, stuck.far) = (Counted(1.0), Counted(0.4)));
    let (step, cost) = counted(|| stepper.step(Counted(0.1), budget));
    assert!(matches!(step, Step::Refused(_)), "{step:?}");
    cost
}

#[test]
fn the_worst_case_is_no_more_than_four_times_what_a_hopeless_step_costs() {
    let with = Stuck::<Counted>::WORST_CASE_OPERATIONS;
    let without = Stuck::<Counted>::WORST_CASE_OPERATIONS_WITHOUT_FALLBACK;
    for (budget, most) in [(Budget::DEFAULT, with), (Budget { fallback: 0, ..Budget::DEFAULT }, without)] {
        assert_eq!(most, budget.worst_case::<Stuck<Counted>>());
        let cost = hopeless(budget);
        println!("{budget:?}\n  cost {cost}\n  most {most}");
        assert!(
            cost.within(most) && 4 * cost.total() >= most.total(),
            "{} of {}",
            cost.total(),
            most.total()
        );
    }
    assert!(without.within(with) && without != with);
}

#[test]
fn the_worst_case_of_surplus_rows_is_no_more_than_four_times_what_a_hopeless_step_costs() {
    for budget in [Budget::DEFAULT, Budget { fallback: 0, ..Budget::DEFAULT }] {
        let most = budget.worst_case::<Torn<Counted>>();
        let torn = Torn::<Counted>::default();
        let guess = torn.guess(&torn.parameters());
        let mut stepper = Stepper::assemble(torn, guess, Counted(0.0)).unwrap();
        stepper.change(|torn| (torn.k, torn.far) = (Counted(2.0), Counted(0.4)));
        let (step, cost) = counted(|| stepper.step(Counted(0.1), budget));
        println!("{budget:?}\n  cost {cost}\n  most {most}");
        assert!(matches!(step, Step::Refused(_)), "{step:?}");
        // A lost column makes a solution longer, which this one does not lose.
        assert!(
            cost.within(most) && 4 * cost.total() >= most.total(),
            "{} of {}",
            cost.total(),
            most.total()
        );
    }
}

#[test]
fn an_unlimited_budget_has_an_unlimited_worst_case() {
    let unlimited = Budget { newton: u32::MAX, fallback: u32::MAX };
    let most = unlimited.worst_case::<Ring<f64>>();
    assert!(most.total() > u64::from(u32::MAX) * 1000 && most.total() < u64::MAX);
    assert_eq!(Operations::NONE.and(most).times(u64::MAX).additions, u64::MAX);
}

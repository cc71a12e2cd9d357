//! Independent coordinates, implicit methods, penalty: each against the same exact motions.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method,
    Penalty, Projection, RungeKutta4, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, mechanism};

use crate::linkage::{End, Linkage, Rod, parallel_loops, pendulum};

/// Released from the horizontal, at 10 s: x, y, ẋ, ẏ.
const AT_TEN: [f64; 4] = [-0.2750874625761169, -0.961419205099125, 4.175598100951729, -1.1947490545604753];

type Pendulum<X> = Simulation<Linkage<2, 1>, X, f64, 2, 1>;

fn released<X: Method<Linkage<2, 1>, f64, 2, 1>>(method: X) -> Pendulum<X> {
    Simulation::start(pendulum(), method, 0.0, [-1.0, 0.0], [0.0, 0.0]).unwrap()
}

fn error<X: Method<Linkage<2, 1>, f64, 2, 1>>(simulation: &Pendulum<X>) -> f64 {
    let ([x, y], [u, v]) = (simulation.q(), simulation.qd());
    [x, y, u, v].iter().zip(AT_TEN).map(|(found, exact)| (*found - exact).abs()).fold(0.0, f64::max)
}

fn stepped<X: Method<Linkage<2, 1>, f64, 2, 1>>(method: X, steps: u32) -> Pendulum<X> {
    let mut simulation = released(method);
    simulation.step_to(10.0, steps).unwrap();
    simulation
}

#[test]
fn independent_coordinates_follow_the_motion_and_others_are_chosen_at_their_turning_points() {
    let mut simulation =
        released(Explicit::new(DormandPrince8, VelocityTransformation)).with_tolerance(Tolerance::new(1e-12));
    simulation.advance_to(10.0).unwrap();
    assert!(error(&simulation) < 1e-8, "{:e}", error(&simulation));
    let counts = simulation.counts();
    // y = 0 at either end of the swing, where the pendulum is slow.
    assert!(counts.rechosen > 0 && 5 * counts.rechosen < counts.evaluations, "{counts:?}");
    assert_eq!(counts.handed_over, 0, "the rows never lose rank");
    assert!((2.0 * simulation.lambda()[0] - 28.29456720606725).abs() < 1e-7);
    assert!(simulation.balance().phi < 1e-13 && simulation.balance().phi_d < 1e-12);
    let fixed = stepped(Explicit::new(RungeKutta4, VelocityTransformation), 10_000);
    assert!(error(&fixed) < 1e-8, "{:e}", error(&fixed));
}

#[test]
fn implicit_methods_are_of_order_two() {
    let alpha = |steps| error(&stepped(GeneralizedAlpha::default(), steps));
    let lagrangian = |steps| error(&stepped(AugmentedLagrangian, steps));
    for (coarse, fine) in [(alpha(4000), alpha(8000)), (lagrangian(4000), lagrangian(8000))] {
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.1, "{order}: {coarse:e} {fine:e}");
    }
}

#[test]
fn generalised_alpha_is_of_order_two_whatever_it_damps_and_whatever_damps_the_motion() {
    for damping in [0.0, 0.4] {
        let swinging = Linkage { damping, ..pendulum() };
        let accurate = Explicit::new(DormandPrince8, Projection::default());
        let exact = Simulation::start(swinging, accurate, 0.0, [-1.0, 0.0], [0.0, 0.0]).unwrap();
        let mut exact = exact.with_tolerance(Tolerance::new(1e-13));
        exact.advance_to(4.0).unwrap();
        // What damps has an effect: the order is not that of the motion without it.
        assert_eq!(exact.balance().work < -1.0, damping > 0.0, "{:?}", exact.balance());
        for rho in [0.0, 0.5, 0.9, 1.0] {
            let errors = [2000, 4000, 8000].map(|steps| {
                let method = GeneralizedAlpha { rho };
                let mut run = Simulation::start(swinging, method, 0.0, [-1.0, 0.0], [0.0, 0.0]).unwrap();
                run.step_to(4.0, steps).unwrap();
                let found = run.q().iter().chain(run.qd());
                let pairs = found.zip(exact.q().iter().chain(exact.qd()));
                pairs.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max)
            });
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                println!(
                    "generalised-α, ρ = {rho}, damping {damping} kg/s: order {order:.3}, {:.1e}",
                    pair[1]
                );
                assert!((order - 2.0).abs() < 0.1, "ρ {rho}, damping {damping}: {errors:?}");
            }
        }
    }
}

#[test]
fn three_thirds_of_a_step_against_a_whole_one_are_of_order_three() {
    let [coarse, fine] = [500, 1000].map(|steps| error(&stepped(Extrapolated, steps)));
    let order = (coarse / fine).log2();
    assert!((order - 3.0).abs() < 0.1, "{order}: {coarse:e} {fine:e}");
    let simulation = stepped(Extrapolated, 1000);
    assert!(simulation.balance().phi < 1e-13 && simulation.balance().phi_d < 1e-12);
}

#[test]
fn the_step_alone_sets_the_penalty_of_the_augmented_lagrangian() {
    // A fixed penalty fails at one end of this range.
    for steps in [500, 5000, 50_000] {
        let simulation = stepped(AugmentedLagrangian, steps);
        let balance = simulation.balance();
        assert!(balance.phi < 1e-8 && balance.phi_d < 1e-6, "{steps}: {balance:?}");
    }
}

#[test]
fn a_stiff_damper_is_no_matter_for_implicit_methods() {
    let stiff = Linkage { damping: 1e5, ..pendulum() };
    let run = |steps| {
        let mut simulation =
            Simulation::start(stiff, AugmentedLagrangian, 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
        simulation.step_to(1.0, steps).map(|()| simulation.q()[1])
    };
    // Creeping: d φ̇ = m g cos φ with φ small. The acceleration of the start, gone after 10 μs, is in the first step still,
    // and a method of order 2 makes some percent of one such step of it.
    let crept = run(100).unwrap();
    assert!((crept + 9.81e-5).abs() < 1e-5, "{crept:e}");
    let mut alpha = Simulation::start(stiff, GeneralizedAlpha::default(), 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
    alpha.step_to(1.0, 100).unwrap();
    assert!((alpha.q()[1] + 9.81e-5).abs() < 1e-5, "{:e}", alpha.q()[1]);
    // Damped a thousand times faster than a step shows; of what the start leaves a step takes off a thirtieth.
    let mut extrapolated = Simulation::start(stiff, Extrapolated, 0.0, [1.0, 0.0], [0.0; 2]).unwrap();
    extrapolated.step_to(1.0, 100).unwrap();
    assert!((extrapolated.q()[1] + 9.81e-5).abs() < 1e-5, "{:e}", extrapolated.q()[1]);
    let mut explicit = Simulation::start(
        stiff,
        Explicit::new(RungeKutta4, Projection::default()),
        0.0,
        [1.0, 0.0],
        [0.0; 2],
    )
    .unwrap();
    let blown = explicit.step_to(1.0, 100);
    assert!(blown.is_err() || (explicit.q()[1] + 9.81e-5).abs() > 1e-3);
}

#[test]
fn redundant_rows_and_singular_positions_are_no_matter_for_the_augmented_lagrangian() {
    let (linkage, q, qd) = parallel_loops::<6, 6>(0.2, 1.0);
    let mut simulation = Simulation::start(linkage, AugmentedLagrangian, 0.0, q, qd).unwrap();
    simulation.step_to(10.0, 10_000).unwrap();
    let balance = simulation.balance();
    let counts = simulation.counts();
    assert!(100 * counts.unfinished < counts.steps, "{counts:?}");
    assert!(balance.phi < 1e-12 && balance.defect.abs() < 1e-3, "{balance:?}");
}

#[test]
fn the_augmented_lagrangian_knows_how_near_it_is_to_a_singular_position_and_that_it_passed_one() {
    let (linkage, q, qd) = parallel_loops::<6, 5>(0.0, 1.0);
    let mut simulation = Simulation::start(linkage, AugmentedLagrangian, 0.0, q, qd).unwrap();
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut projected =
        Simulation::start(linkage, method, 0.0, q, qd).unwrap().with_tolerance(Tolerance::new(1e-9));
    for instant in 1..=10 {
        let t = 0.05 * f64::from(instant);
        simulation.step_to(t, 50).unwrap();
        projected.advance_to(t).unwrap();
        let ratio = simulation.margin() / projected.margin();
        // One by orthogonal pivots, the other by those of the whole system.
        assert!((0.3..3.0).contains(&ratio), "{} {} at {t} s", simulation.margin(), projected.margin());
    }
    assert_eq!(simulation.passage(), None);
    simulation.step_to(0.8, 300).unwrap();
    let passage = simulation.passage().unwrap();
    assert!((passage.t - 0.72).abs() < 0.02 && passage.margin < 0.01, "{passage:?}");
}

#[test]
fn a_penalty_is_another_mechanism_that_nears_the_rigid_one() {
    let run = |alpha: f64| {
        error(&stepped(Explicit::new(RungeKutta4, Penalty { alpha, ..Penalty::default() }), 10_000))
    };
    let (soft, hard) = (run(1e4), run(1e6));
    assert!(soft > 1e-5 && hard < 0.05 * soft, "{soft:e} {hard:e}");
}

/// A massless rod of 2 m with a mass of 3 kg, for the statics and the small motions.
pub fn hanging() -> Linkage<2, 1> {
    let rod = Rod { from: End::Ground([0.0; 2]), to: End::Point(0), length: 2.0, mass: 0.0 };
    Linkage::new([rod], [3.0; 2], [0.0, -9.81])
}

mechanism! {
    /// A pendulum on a pendulum, the rows of its rods times a number and times its square.
    pub mechanism Multiplied;
    const M2: m^2 = 1;
    param k: 1 = 1;
    coord p: [m; 2] = [0.5, 0];
    coord q: [m; 2] = [0.9, 0];
    body upper { mass: 1, com: p }
    body lower { mass: 2, com: q }
    gravity weight { acceleration: [0, -9.81] }
    constraint rods {
        k*(dot(p, p) - 0.25*M2) == 0;
        k*k*(norm(q - p) - 0.4m) == 0;
    }
}

/// A run of 0.3 s with rows times `k` and `k²`: coordinates, and the multipliers times `k` and `k²`.
fn multiplied<X: Method<Multiplied, f64, 4, 2>>(method: X, k: f64) -> ([f64; 4], [f64; 2]) {
    let mut run = Simulation::start_from_text(Multiplied { k }, method, 0.0).unwrap();
    run.step_to(0.3, 60).unwrap();
    let [first, second] = *run.lambda();
    (*run.q(), [k * first, k * k * second])
}

#[test]
fn rows_times_any_number_are_the_same_mechanism_for_every_method() {
    /// Newtons: what rounding leaves in accelerations, of 40 N.
    const ROUNDING: f64 = 1e-8;
    /// The same with rows times a penalty of 4e4 m/h² N/m, which has their rounding as many times.
    const PENALIZED: f64 = 1e-5;
    fn check<X: Method<Multiplied, f64, 4, 2> + Copy>(name: &str, method: X, allowed: f64) {
        let (q, lambda) = multiplied(method, 1.0);
        for k in [1e-6, 1e-3, 0.1, 30.0, 1e3, 1e6] {
            let (q_k, lambda_k) = multiplied(method, k);
            let moved = q.iter().zip(q_k).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let borne = lambda.iter().zip(lambda_k).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The motion is not chaotic yet: rounding, and what corrections leave that are below it.
            assert!(moved < 1e-10 && borne < allowed, "{name}, {k:e}: {moved:e} m, {borne:e} N");
        }
    }
    check("projection", Explicit::new(RungeKutta4, Projection::default()), ROUNDING);
    check("velocity transformation", Explicit::new(RungeKutta4, VelocityTransformation), ROUNDING);
    check("Baumgarte", Explicit::new(RungeKutta4, Baumgarte::default()), ROUNDING);
    check("penalty", Explicit::new(RungeKutta4, Penalty::default()), PENALIZED);
    check("augmented Lagrangian", AugmentedLagrangian, PENALIZED);
    check("extrapolated", Extrapolated, ROUNDING);
    check("generalised-α", GeneralizedAlpha::default(), PENALIZED);
}

#[test]
fn rows_times_any_number_refuse_the_same_starts() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    for k in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let start = |off: f64| {
            let q = [0.5, 0.0, 0.9 + off, 0.0];
            Simulation::start(Multiplied { k }, method, 0.0, q, [0.0; 4])
        };
        assert!(start(1e-9).is_ok(), "{k:e}");
        let failure = start(1e-6).unwrap_err();
        let Failure { kind: FailureKind::OffConstraints { row, .. }, .. } = failure else {
            panic!("{failure}")
        };
        assert_eq!(row.name, "rods.1");
    }
}

mechanism! {
    /// A pendulum with a very short one on it, its rod by the square of its length.
    pub mechanism ShortRod;
    const M2: m^2 = 1;
    param length: m = 0.002;
    param guess: m = 0.0021;
    coord p: [m; 2] = [1, 0];
    coord q: [m; 2] = [1m + guess, 0];
    body long { mass: 1, com: p }
    body short { mass: 0.1, com: q }
    gravity weight { acceleration: [0, -9.81] }
    constraint rods { dot(p, p) == 1*M2; dot(q - p, q - p) == length^2; }
}

#[test]
fn a_short_rod_is_as_long_as_the_text_says_whatever_the_guess() {
    /// 64 roundings of a metre, on which the rod hangs, and of the coordinates.
    const ROUNDING: f64 = 1e-13;
    fn check<X: Method<ShortRod, f64, 4, 2>>(method: X, allowed: f64) {
        let mut run = Simulation::start_from_text(ShortRod::default(), method, 0.0).unwrap();
        let length = |[px, py, qx, qy]: [f64; 4]| (qx - px).hypot(qy - py);
        assert!((length(*run.q()) - 0.002).abs() < ROUNDING, "{:e}", length(*run.q()));
        run.step_to(0.02, 2000).unwrap();
        assert!((length(*run.q()) - 0.002).abs() < allowed, "{:e}", length(*run.q()));
    }
    check(Explicit::new(RungeKutta4, Projection::default()), ROUNDING);
    check(Explicit::new(RungeKutta4, VelocityTransformation), ROUNDING);
    check(GeneralizedAlpha::default(), 1e-11);
    check(AugmentedLagrangian, 1e-11);
    let method = Explicit::new(RungeKutta4, Projection::default());
    let beside = Simulation::start(ShortRod::default(), method, 0.0, [1.0, 0.0, 1.0021, 0.0], [0.0; 4]);
    assert!(matches!(beside, Err(Failure { kind: FailureKind::OffConstraints { .. }, .. })));
}

mechanism! {
    /// A slider-crank that a motor turns.
    pub mechanism Pump;
    const SPEED: rad/s = 2;
    const GAIN: rad/s^2 = 1;
    coord th: rad = 0.3;
    coord phi: rad = -0.1;
    coord x: m = 0.2;
    body crank { mass: 1, com: 0.02m*unit(th), angle: th, inertia: 0.001 }
    body rod { mass: 0.6, inertia: 0.002, com: 0.05m*unit(th) + 0.09m*unit(phi), angle: phi }
    body piston { mass: 0.5, com: [x, 0] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, 0], to: [x, 0], stiffness: 100, length: 0.1, damping: 2 }
    constraint closure { 0.05m*unit(th) + 0.18m*unit(phi) == [x, 0]; }
    drive motor: th == 0.3 + SPEED*t + GAIN*t^2/2;
}

mechanism! {
    /// A bead that slides along a parabola with friction.
    pub mechanism Bead;
    coord p: [m; 2] = [0, 0];
    body bead { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint wire { p[1] == -0.5*p[0]*p[0]/1m; }
    friction rub { along: p[0], normal: lambda(wire), coefficient: 0.1, speed: 0.01 }
    start p = [0, 0] rate [1, 0];
}

/// Errors of velocities, multipliers and work at 0.5 s.
fn errors<S, X, const N: usize, const M: usize>(mechanism: S, method: X, steps: u32) -> [f64; 3]
where
    S: Dynamic<f64, N, M> + Copy,
    X: Method<S, f64, N, M>,
{
    let exact = Explicit::new(DormandPrince8, Projection::default());
    let exact = Simulation::start_from_text(mechanism, exact, 0.0).unwrap();
    let mut exact = exact.with_tolerance(Tolerance::new(1e-13));
    exact.advance_to(0.5).unwrap();
    let mut run = Simulation::start_from_text(mechanism, method, 0.0).unwrap();
    run.step_to(0.5, steps).unwrap();
    let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let work = (run.balance().work - exact.balance().work).abs();
    [off(run.qd(), exact.qd()), off(run.lambda(), exact.lambda()), work]
}

#[test]
fn multipliers_work_and_friction_of_implicit_methods_have_the_order_of_the_motion() {
    let (pump, bead, alpha) = (Pump::default(), Bead::default(), GeneralizedAlpha::default());
    let pairs = [
        [50, 100].map(|steps| errors(pump, AugmentedLagrangian, steps)),
        [50, 100].map(|steps| errors(bead, AugmentedLagrangian, steps)),
        [50, 100].map(|steps| errors(bead, alpha, steps)),
    ];
    for [coarse, fine] in pairs {
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            assert!((coarse / fine).log2() > 1.8, "{pairs:?}");
        }
    }
    // Of order 3 errors pass zero; they are a fiftieth of those of order 2.
    for (second, third) in [
        (errors(pump, AugmentedLagrangian, 50), errors(pump, Extrapolated, 50)),
        (errors(bead, AugmentedLagrangian, 50), errors(bead, Extrapolated, 50)),
    ] {
        assert!(
            second.iter().zip(&third).all(|(second, third)| 50.0 * third < *second),
            "{second:?} {third:?}"
        );
    }
}

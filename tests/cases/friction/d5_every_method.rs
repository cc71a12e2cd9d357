//! D5: every method solves for friction on multipliers, implicit ones with ∂Q/∂λ, and every kind of dependence.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince8, Explicit, Extrapolated, Formulation, GeneralizedAlpha,
    Method, Penalty, Projection, Simulation, Tolerance, Unstabilized, VelocityTransformation, inverse,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, Mechanism, mechanism};

mechanism! {
    /// A block that slides on a guide; its friction presses it on by b of the normal force, and a load swings through zero.
    mechanism Wedge;
    param b: 1 = 0.34;
    param pull: N = 20;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    force draw: pull on x;
    force load: 10N*cos(3*t/1s) + 1N on y;
    constraint guide { y == 0; }
    // The unit force on x and −2b on y, with half of the normal force.
    friction rub { along: x - 2*b*y, normal: lambda(guide), coefficient: 0.5, speed: 1mm/1s }
    start x = 0 rate 5;
}

/// Place and speed of the block after `t` (s): N = N₀ + b |N|, by the midpoint rule in pieces.
fn slid(wedge: &Wedge, t: f64) -> [f64; 2] {
    let steps = 200_000;
    let h = t / f64::from(steps);
    let [mut x, mut v] = [0.0, 5.0];
    for step in 0..steps {
        let load = 10.0 * (3.0 * h * (f64::from(step) + 0.5)).cos() + 1.0;
        let normal = if load > 0.0 { load / (1.0 - wedge.b) } else { load / (1.0 + wedge.b) };
        let a = (wedge.pull - 0.5 * normal.abs()) / 2.0;
        x += h * v + 0.5 * h * h * a;
        v += h * a;
    }
    [x, v]
}

/// Error of place and speed against the law after 2 s, for a run in steps of `h` (s) or with a tolerance.
fn error(wedge: Wedge, method: impl Method<Wedge, f64, 2, 1>, h: f64) -> Result<f64, Failure> {
    let mut run = Simulation::start_from_text(wedge, method, 0.0)?;
    for _ in 0..(2.0 / h).round() as u32 {
        run.step(h)?;
    }
    let truth = slid(&wedge, 2.0);
    Ok((run.q()[0] - truth[0]).abs().max((run.qd()[0] - truth[1]).abs()))
}

fn adaptive(wedge: Wedge, formulation: impl Formulation<Wedge, f64, 2, 1>) -> Result<f64, Failure> {
    let run = Simulation::start_from_text(wedge, Explicit::new(DormandPrince8, formulation), 0.0)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(2.0)?;
    let truth = slid(&wedge, 2.0);
    Ok((run.q()[0] - truth[0]).abs().max((run.qd()[0] - truth[1]).abs()))
}

#[test]
fn a_normal_force_swings_through_zero_under_every_method() {
    for b in [0.34, 0.78, 0.999, -0.78].into_iter().step_by(every(2)) {
        // N grows with 1/(1 − b): pulled on, the block does not stop.
        let pull = if b > 0.9 { 6000.0 } else { 40.0 };
        let wedge = Wedge { b, pull };
        let size = 1.0 + 5.0 / (1.0 - b);
        let explicit = [
            adaptive(wedge, Projection::default()),
            adaptive(wedge, VelocityTransformation),
            adaptive(wedge, Baumgarte::default()),
            adaptive(wedge, Unstabilized),
        ];
        for found in explicit {
            let error = found.unwrap_or_else(|failure| panic!("b = {b}: {failure}"));
            // Error that the estimate misses in steps across kinks of |N|.
            assert!(error < 1e-6 * size, "b = {b}: {error:e}");
        }
        // A spring of stiffness α in place of the guide: 1/α of the force, and of 1/(1 − b) of it.
        let error_of_penalty =
            adaptive(wedge, Penalty::default()).unwrap_or_else(|failure| panic!("b = {b}: {failure}"));
        assert!(error_of_penalty < 1e-3 * size / (1.0 - b), "b = {b}: {error_of_penalty:e}");
        let implicit = [
            error(wedge, AugmentedLagrangian, 1e-3),
            error(wedge, Extrapolated, 1e-3),
            error(wedge, GeneralizedAlpha::default(), 1e-3),
        ];
        for found in implicit {
            let error = found.unwrap_or_else(|failure| panic!("b = {b}: {failure}"));
            // h² of the force's second derivative, and of its kinks.
            assert!(error < 3e-5 * size, "b = {b}: {error:e}");
        }
    }
}

/// Speed of the block after `t` (s), with its friction smooth below 1 mm/s: N = N₀ + b τ |N|, by Runge and Kutta's method.
fn slid_and_stuck(wedge: &Wedge, t: f64) -> f64 {
    // Slopes of the friction are 2e6/s at most.
    let steps = 2_000_000;
    let h = t / f64::from(steps);
    let rate = |t: f64, v: f64| {
        let (load, share) = (10.0 * (3.0 * t).cos() + 1.0, (v / 1e-3).tanh());
        let normal = if load > 0.0 { load / (1.0 - wedge.b * share) } else { load / (1.0 + wedge.b * share) };
        (wedge.pull - 0.5 * normal.abs() * share) / 2.0
    };
    (0..steps).fold(5.0, |v, step| {
        let t = h * f64::from(step);
        let a = rate(t, v);
        let b = rate(t + 0.5 * h, v + 0.5 * h * a);
        let c = rate(t + 0.5 * h, v + 0.5 * h * b);
        let d = rate(t + h, v + h * c);
        v + h / 6.0 * (a + 2.0 * (b + c) + d)
    })
}

#[test]
fn a_brake_that_nearly_locks_itself_sticks_and_slips_under_implicit_steps() {
    fn speed(wedge: Wedge, method: impl Method<Wedge, f64, 2, 1>, h: f64) -> Result<f64, Failure> {
        let mut run = Simulation::start_from_text(wedge, method, 0.0)?;
        (0..(2.0 / h).round() as u32).try_for_each(|_| run.step(h))?;
        Ok(run.qd()[0])
    }
    // N is N₀/(1 − |b|) as long as it slides, a thousandth of it where it sticks.
    let wedge = Wedge { b: -0.999, pull: 40.0 };
    let truth = slid_and_stuck(&wedge, 2.0);
    for h in [1e-2, 1e-3] {
        let found = [
            speed(wedge, AugmentedLagrangian, h),
            speed(wedge, Extrapolated, h),
            speed(wedge, GeneralizedAlpha::default(), h),
        ];
        for found in found {
            let error = (found.unwrap_or_else(|failure| panic!("{h}: {failure}")) - truth).abs();
            // When it comes loose again is known to a step's length, in which its pull adds 20 m/s² h.
            assert!(error < 20.0 * h, "{h}: {error:e} of {truth}");
        }
    }
}

#[test]
fn several_or_no_normal_forces_are_answered_so_by_every_method() {
    // Beyond b = 1 a load that presses has no solution, one that lifts two.
    let of = |wedge: Wedge, t: f64| -> [Result<(), Failure>; 6] {
        fn start(wedge: Wedge, method: impl Method<Wedge, f64, 2, 1>, t: f64) -> Result<(), Failure> {
            Simulation::start(wedge, method, t, [0.0, 0.0], [5.0, 0.0]).map(|_| ())
        }
        [
            start(wedge, Explicit::new(DormandPrince8, Projection::default()), t),
            start(wedge, Explicit::new(DormandPrince8, VelocityTransformation), t),
            start(wedge, Explicit::new(DormandPrince8, Penalty::default()), t),
            start(wedge, AugmentedLagrangian, t),
            start(wedge, Extrapolated, t),
            start(wedge, GeneralizedAlpha::default(), t),
        ]
    };
    for found in of(Wedge { b: 1.5, pull: 40.0 }, 0.0) {
        assert!(
            matches!(found, Err(Failure { kind: FailureKind::FrictionLocked { row, .. }, .. }) if row.name == "guide"),
            "{found:?}"
        );
    }
    for found in of(Wedge { b: 1.5, pull: 40.0 }, 1.0) {
        assert!(
            matches!(
                found,
                Err(Failure { kind: FailureKind::Ambiguous { solutions: 2, all: true, .. }, .. })
            ),
            "{found:?}"
        );
        assert!(found.unwrap_err().to_string().contains("2 sets of forces"));
    }
}

#[test]
fn implicit_steps_stop_where_the_normal_force_stops_being_one() {
    // b = 1.5 with a load that lifts at 1 s and presses from 1.6 s on: two solutions from the start.
    fn stop(method: impl Method<Wedge, f64, 2, 1>) -> Failure {
        let wedge = Wedge { b: 0.9, pull: 400.0 };
        let mut run = Simulation::start(wedge, method, 0.0, [0.0, 0.0], [5.0, 0.0]).expect("it starts");
        (0..100).try_for_each(|_| run.step(1e-2)).expect("it moves");
        run.change(|wedge| wedge.b = 1.5);
        (0..100).try_for_each(|_| run.step(1e-2)).expect_err("two solutions")
    }
    for failure in [stop(AugmentedLagrangian), stop(Extrapolated), stop(GeneralizedAlpha::default())] {
        assert!(
            matches!(failure, Failure { kind: FailureKind::Ambiguous { solutions: 2, .. }, .. }),
            "{failure}"
        );
    }
}

mechanism! {
    /// A collar on a rod along z, pressed across it in two directions: its normal force is the norm of both.
    mechanism Collar;
    param mu: 1 = 0.4;
    param tilt: 1 = 0.9;
    coord p: [m; 3] = [0, 0, 0];
    body collar { mass: 2, com: p }
    force press: [6N, -3N, 1000N] on p;
    constraint rod { p[0] == 0; p[1] == 0; }
    friction rub {
        along: p[2] - tilt*p[0], normal: hypot(lambda(rod[0]), lambda(rod[1])), coefficient: mu, speed: 1mm/1s
    }
    start p = [0, 0, 0] rate [0, 0, 3];
}

/// |N| = |N₀ + b |N||: the positive root of (1 − b²) n² − 2 b·N₀ n − N₀² = 0.
fn norm(b: f64, across: [f64; 2]) -> f64 {
    let (half, square) = (b * across[0], across[0] * across[0] + across[1] * across[1]);
    (half + (half * half + (1.0 - b * b) * square).sqrt()) / (1.0 - b * b)
}

#[test]
fn a_norm_of_two_multipliers_is_a_normal_force_under_every_method() {
    fn speeds(collar: Collar) -> [Result<f64, Failure>; 6] {
        fn speed(collar: Collar, method: impl Method<Collar, f64, 3, 2>) -> Result<f64, Failure> {
            let mut run = Simulation::start_from_text(collar, method, 0.0)?;
            (0..50).try_for_each(|_| run.step(1e-2))?;
            Ok(run.qd()[2])
        }
        [
            speed(collar, Explicit::new(DormandPrince8, Projection::default())),
            speed(collar, Explicit::new(DormandPrince8, VelocityTransformation)),
            speed(collar, Explicit::new(DormandPrince8, Baumgarte::default())),
            speed(collar, AugmentedLagrangian),
            speed(collar, Extrapolated),
            speed(collar, GeneralizedAlpha::default()),
        ]
    }
    for (mu, tilt) in [(0.4, 0.9), (0.9, 1.1), (0.9, -1.1)] {
        // −μ n on z and μ tilt n on x, so that λ₀ = 6 + μ tilt n.
        let expected = 3.0 + 0.5 * (1000.0 - mu * norm(mu * tilt, [6.0, -3.0])) / 2.0;
        for found in speeds(Collar { mu, tilt }) {
            let found = found.unwrap_or_else(|failure| panic!("{mu}, {tilt}: {failure}"));
            assert!((found - expected).abs() < 1e-9 * expected, "{mu}, {tilt}: {found} of {expected}");
        }
    }
    for found in speeds(Collar { mu: 1.0, tilt: 2.0 }) {
        assert!(matches!(found, Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. })), "{found:?}");
    }
    for found in speeds(Collar { mu: 1.0, tilt: -2.0 }) {
        assert!(
            matches!(found, Err(Failure { kind: FailureKind::Ambiguous { solutions: 2, .. }, .. })),
            "{found:?}"
        );
    }
}

mechanism! {
    /// The wedge with a coefficient that falls with the pressure, with a dead load, and with the larger of two normal forces.
    mechanism Polymer;
    param b: 1 = 0.7;
    param kind: 1 = 0;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    force draw: 30N on x;
    force load: 10N on y;
    constraint guide { y == 0; }
    friction smooth {
        along: x - b*y, normal: (1 - kind)*abs(lambda(guide))/(1 + abs(lambda(guide))/20N), coefficient: 1, speed: 1mm/1s
    }
    friction pieces {
        along: x - b*y,
        normal: kind*(
            max(lambda(guide) - 4N, 0)*2 + sqrt(lambda(guide)^2 + (lambda(guide) - 3N)^2) - 0.5*lambda(guide)
        ),
        coefficient: 0.5,
        speed: 1mm/1s
    }
}

/// The friction of the guide over its coefficient, of a normal force `n` (N).
fn law(kind: f64, n: f64) -> f64 {
    let pressed = n.abs() / (1.0 + n.abs() / 20.0);
    let stepped = (n - 4.0).max(0.0) * 2.0 + n.hypot(n - 3.0) - 0.5 * n;
    (1.0 - kind) * pressed + 0.5 * kind * stepped.abs()
}

/// Sign changes of n − 10 − b law(n) within 4000 N, by scanning; none where two of them, or two that just vanished, are within a newton.
fn balances(b: f64, kind: f64) -> Option<usize> {
    let open = |n: f64| n - 10.0 - b * law(kind, n);
    let at = |index: i32| f64::from(index) * 0.02 + 1e-7;
    let signs = |share: f64| {
        (-200_000..200_000)
            .filter(|&index| (open(at(index)) + share < 0.0) != (open(at(index + 1)) + share < 0.0))
            .count()
    };
    let count = signs(0.0);
    (signs(0.05) == count && signs(-0.05) == count).then_some(count)
}

#[test]
fn any_other_dependence_is_solved_by_newtons_method_and_its_balances_counted() {
    let mut seen = [0; 3];
    for (index, kind) in (0..80).step_by(every(6)).flat_map(|index| [(index, 0.0), (index, 1.0)]) {
        let b = f64::from(index) * 0.05 - 3.0;
        let Some(count) = balances(b, kind) else { continue };
        seen[count.min(2)] += 1;
        let polymer = Polymer { b, kind };
        let projected = Explicit::new(DormandPrince8, Projection::default());
        let reduced = Explicit::new(DormandPrince8, VelocityTransformation);
        let (q, qd) = ([0.0; 2], [5.0, 0.0]);
        let found = [
            Simulation::start(polymer, projected, 0.0, q, qd).map(|run| run.lambda()[0]),
            Simulation::start(polymer, reduced, 0.0, q, qd).map(|run| run.lambda()[0]),
        ];
        for found in found {
            match (count, found) {
                (1, Ok(n)) => {
                    let residual = n - 10.0 - b * law(kind, n);
                    assert!(residual.abs() < 1e-12 * (1.0 + n.abs()), "{b}, {kind}: {n} leaves {residual:e}");
                }
                (0, Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. }))
                | (2.., Err(Failure { kind: FailureKind::Ambiguous { .. }, .. })) => {}
                (count, found) => panic!("{b}, {kind}: {count} solutions, and {found:?}"),
            }
        }
    }
    assert!(seen[1] > 60 / every(6) && seen[2] > 20 / every(6), "{seen:?}");
}

#[test]
fn the_emitted_slope_by_multipliers_is_that_of_the_force() {
    let polymer = Polymer { b: 0.7, kind: 0.3 };
    let parameters = polymer.parameters();
    let position = polymer.position(&parameters, &[0.1, 0.0], 0.0);
    let qd = [1e-3, 0.2];
    for lambda in [-7.0, -1.0, 2.0, 5.0, 40.0_f64] {
        let slope = polymer.force_lambda(&parameters, &position, &qd, &[], &[lambda]);
        let [up, down] =
            [1e-6, -1e-6].map(|change| polymer.force(&parameters, &position, &qd, &[], &[lambda + change]));
        for ((slope, up), down) in slope.iter().zip(up).zip(down) {
            assert!(f64::abs(slope[0] - (up - down) / 2e-6) < 1e-7, "{lambda}: {slope:?}");
        }
    }
}

mechanism! {
    /// A driven slider whose guide rubs: the force of the drive.
    mechanism Drawn;
    param b: 1 = 0.78;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    force load: 10N*cos(3*t/1s) + 1N on y;
    constraint guide { y == 0; }
    drive draw: x == 1m/1s*t + 0.1m*sin(t/1s);
    friction rub { along: x - 2*b*y, normal: lambda(guide), coefficient: 0.5, speed: 1mm/1s }
    out force: N = effort(draw);
}

#[test]
fn inverse_dynamics_solves_for_friction() {
    for b in [0.34, 0.78, 0.999] {
        for step in 0..200 {
            let t = 0.01 * f64::from(step);
            let found = inverse(&Drawn { b }, t, &[t + 0.1 * t.sin(), 0.0]).expect("one solution");
            let load = 10.0 * (3.0 * t).cos() + 1.0;
            let normal = if load > 0.0 { load / (1.0 - b) } else { load / (1.0 + b) };
            let expected = 2.0 * -0.1 * t.sin() + 0.5 * normal.abs();
            assert!((found.loads[0] - expected).abs() < 1e-12 * (1.0 + normal.abs()) / (1.0 - b), "{b}, {t}");
        }
    }
    assert!(matches!(
        inverse(&Drawn { b: 1.5 }, 0.0, &[0.0, 0.0]),
        Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. })
    ));
}

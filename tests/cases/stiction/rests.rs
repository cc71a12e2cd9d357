//! Rests of texts with rigid contacts, frictions that stick and events, against closed forms.

use mbs_runtime::dynamics::{
    Equilibrium, equilibrium, equilibrium_with_modes, equilibrium_with_states, linearize,
};
use mbs_runtime::{Dynamic, DynamicState, Failure, FailureKind, mechanism};

const G: f64 = 9.81;

/// A rest from `q`, with its loads.
fn rest<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
) -> Result<(Equilibrium<f64, N, M>, S::Loads), Failure> {
    let (rest, states, parameters) = equilibrium_with_modes(mechanism, 0.0, q)?;
    let (still, position) = ([0.0; N], mechanism.position(&parameters, &rest.q, 0.0));
    let motion = DynamicState { qd: &still, qdd: &still, lambda: &rest.lambda, states: &states };
    Ok((rest, mechanism.loads(&parameters, &position, &motion)))
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
}

mechanism! {
    /// A ball on a spring above a floor.
    mechanism Ball;
    param k: N/m = 0;
    coord y: m = 1;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, -1], to: [0, y], stiffness: k, length: 2 }
    contact floor { gap: y, restitution: 0.9 }
    out push: N = force(floor);
}

#[test]
fn a_ball_rests_on_the_floor_or_above_it() {
    for start in [1.0, 1e-3, 0.0, 50.0] {
        let (found, [push]) = rest(&Ball::default(), &[start]).expect("it rests");
        assert!(found.q[0].abs() < 1e-13, "{start}: {found:?}");
        near(push, 2.0 * G);
        assert!(!found.indifferent[0] && !found.held[0] && !found.shared, "{found:?}");
    }
    let (found, [push]) = rest(&Ball { k: 100.0 }, &[0.5]).expect("it floats");
    near(found.q[0], 1.0 - 2.0 * G / 100.0);
    near(push, 0.0);
    let (found, [push]) = rest(&Ball { k: 10.0 }, &[0.5]).expect("it rests");
    near(found.q[0], 0.0);
    near(push, 2.0 * G - 10.0);
    let single = equilibrium(&Ball::<f32>::default(), 0.0, &[1.0]).expect("it rests");
    assert!(single.q[0].abs() < 1e-6, "{single:?}");
}

mechanism! {
    /// A block between a spring and dry friction.
    mechanism Block;
    param mus: 1 = 0.15;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction rub { along: x, normal: 9.81N, coefficient: 0.1, sticks: mus }
    out force: N = force(rub);
}

#[test]
fn a_block_rests_where_it_is_or_at_the_next_edge() {
    // It sticks up to 0.15·9.81/2 m, and slides to 0.1·9.81/2 m from beyond.
    for start in [0.0, 0.3, -0.7, 0.73] {
        let (found, [force]) = rest(&Block::default(), &[start]).expect("it sticks");
        near(found.q[0], start);
        near(force, 2.0 * start);
        assert!(found.held[0] && !found.indifferent[0], "{found:?}");
    }
    for start in [0.74, -0.74, 2.0, -0.9, 30.0] {
        let (found, [force]) = rest(&Block::default(), &[start]).expect("it rests at the edge");
        near(found.q[0], 0.1 * G / 2.0 * f64::signum(start));
        near(force, 0.1 * G * f64::signum(start));
        assert!(found.held[0], "{found:?}");
    }
    let edge = Block { mus: 0.1 };
    let (found, [force]) = rest(&edge, &[5.0]).expect("it rests at the edge");
    near(found.q[0], 0.1 * G / 2.0);
    near(force, 0.1 * G);
}

mechanism! {
    /// A block on a slope of 30° that is a constraint.
    mechanism Slope;
    param mus: 1 = 0.6;
    coord P: [m; 2] = [0, 0];
    body block { mass: 2kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    constraint ground { dot(P, unit(120deg)) == 0m; }
    friction rub { along: dot(P, unit(30deg)), normal: lambda(ground), coefficient: 0.3, sticks: mus }
    out force: N = force(rub);
}

mechanism! {
    /// Three blocks in a row, with springs between them, on a rough floor.
    mechanism Row;
    coord x: [m; 3] = [0, 1, 2];
    for i in 0..3 {
        body block { mass: 1, com: [x[i], 0] }
        friction rub { along: x[i], normal: 9.81N, coefficient: 0.2, sticks: 0.3 }
    }
    for i in 0..2 { tsda spring { from: [x[i], 0], to: [x[i+1], 0], stiffness: 30, length: 1 } }
    out forces: [N; 3] = [force(rub[0]), force(rub[1]), force(rub[2])];
}

#[test]
fn frictions_of_a_row_slide_one_after_the_other() {
    // The last block slides to where 0.2·9.81 N hold its spring; what the others bear is below 0.3·9.81 N.
    let (found, forces) = rest(&Row::default(), &[0.0, 1.05, 2.3]).expect("it rests");
    let last = 0.2 * G / 30.0;
    [0.0, 1.05, 2.05 + last].iter().zip(&found.q).for_each(|(expected, q)| near(*q, *expected));
    // Each friction bears the difference of the springs beside it.
    [-1.5, 1.5 - 0.2 * G, 0.2 * G].iter().zip(&forces).for_each(|(expected, force)| near(*force, *expected));
    assert!(found.held == [true; 3] && !found.shared, "{found:?}");
    let single = equilibrium(&Row::<f32>::default(), 0.0, &[0.0, 1.05, 2.3]).expect("it rests");
    assert!((f64::from(single.q[2]) - 2.05 - last).abs() < 1e-5, "{single:?}");
}

mechanism! {
    /// A pendulum with friction in its pin, whose force is a multiplier.
    mechanism Pendulum;
    coord phi: rad = 0;
    coord P: [m; 2] = [0, -1];
    constraint rod { P == 1m*[sin(phi), -cos(phi)]; }
    body bob { mass: 1kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    friction pin { along: 20mm*phi, normal: hypot(lambda(rod[0]), lambda(rod[1])), coefficient: 0.8, sticks: 1 }
    out force: N = force(pin);
}

#[test]
fn a_pendulum_hangs_aside_within_the_friction_of_its_pin() {
    let at = |phi: f64| [phi, phi.sin(), -phi.cos()];
    let (found, [force]) = rest(&Pendulum::default(), &at(0.01)).expect("it sticks");
    near(found.q[0], 0.01);
    near(force * 0.02, G * 0.01_f64.sin());
    let (found, [force]) = rest(&Pendulum::default(), &at(0.4)).expect("it slides down");
    // 9.81 sin φ = 0.02 · 0.8 · 9.81
    near(found.q[0], 0.016_f64.asin());
    near(force, 0.8 * G);
}

#[test]
fn a_disk_rolls_to_its_rest_from_anywhere() {
    for start in [0.01, 0.8] {
        let (found, _, _) =
            equilibrium_with_modes(&Disk::default(), 0.0, &[start, 0.3, 0.0]).expect("it rests");
        near(found.q[0], 0.0);
        near(found.q[2], 10.0 * start);
    }
}

#[test]
fn a_block_on_a_slope_rests_below_the_limit_alone() {
    let (sine, cosine) = 30.0_f64.to_radians().sin_cos();
    let (found, [force]) = rest(&Slope::default(), &[0.7 * cosine, 0.7 * sine]).expect("it sticks");
    near(found.q[0], 0.7 * cosine);
    near(force, 2.0 * G * sine);
    assert!(found.held == [true; 2] && found.unique[0], "{found:?}");
    near(found.lambda[0].abs(), 2.0 * G * cosine);
    let slips = rest(&Slope { mus: 0.57 }, &[0.0, 0.0]).map(|(found, _)| found).expect_err("it slides");
    assert!(matches!(slips.kind, FailureKind::NoEquilibrium { .. }), "{slips}");
}

mechanism! {
    /// A ladder of 2 m on a rough floor at a smooth wall.
    mechanism Ladder;
    param mu: 1 = 0.5;
    coord p: [m; 2] = [0.6, 0.8];
    coord a: rad = 2.2;
    body ladder { mass: 10, com: p, inertia: 3, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    let foot = p - 1m*unit(a);
    let head = p + 1m*unit(a);
    contact floor { gap: foot[1], restitution: 0 }
    contact wall { gap: head[0], restitution: 0 }
    friction rub { along: foot[0], normal: normal(floor), coefficient: mu, sticks: mu }
    out floor_force: N = force(floor);
    out wall_force: N = force(wall);
    out drag: N = force(rub);
}

#[test]
fn a_ladder_stands_within_the_cone_of_its_friction() {
    let at = |angle: f64| [angle.cos(), angle.sin(), core::f64::consts::PI - angle];
    let angle = 55.0_f64.to_radians();
    let (found, [floor, wall, drag]) = rest(&Ladder::default(), &at(angle)).expect("it stands");
    near(found.q[0], angle.cos());
    near(floor, 10.0 * G);
    near(wall, 10.0 * G / (2.0 * angle.tan()));
    near(drag.abs(), wall);
    assert!(found.held.contains(&true) && !found.shared, "{found:?}");
    // Below atan(1/(2 μ)) = 45° it slips. What is found then leans on nothing: it lies, stands, or hangs from its foot.
    let low = 44.0_f64.to_radians();
    let fallen = rest(&Ladder::default(), &at(low));
    if let Ok((found, [_, wall, drag])) = fallen {
        let upright = (found.q[1].abs() - 1.0).abs() < 1e-9;
        assert!(upright || found.q[1].abs() < 1e-9, "{found:?}");
        assert!(wall.abs() < 1e-6 && drag.abs() < 1e-6, "{wall} {drag}");
    }
}

mechanism! {
    /// A disk in a groove of 60° to either side.
    mechanism Groove;
    coord p: [m; 2] = [0, 1];
    body disk { mass: 3, com: p }
    gravity weight { acceleration: [0, -9.81] }
    contact left { gap: dot(p, unit(30deg)) - 0.1m, restitution: 0 }
    contact right { gap: dot(p, unit(150deg)) - 0.1m, restitution: 0 }
    out forces: [N; 2] = [force(left), force(right)];
}

mechanism! {
    /// A beam on three supports.
    mechanism Beam;
    coord y: m = 0.5;
    coord a: rad = 0.1;
    body beam { mass: 6, com: [0, y], inertia: 1, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    contact left { gap: y - 1m*sin(a), restitution: 0 }
    contact middle { gap: y, restitution: 0 }
    contact right { gap: y + 1m*sin(a), restitution: 0 }
    out forces: [N; 3] = [force(left), force(middle), force(right)];
}

#[test]
fn several_contacts_share_a_load() {
    let (found, forces) = rest(&Groove::default(), &[0.3, 1.0]).expect("it rests");
    near(found.q[0], 0.0);
    near(found.q[1], 0.2);
    forces.iter().for_each(|force| near(*force, 3.0 * G));
    assert!(!found.shared && found.held == [false; 2], "{found:?}");
    let (found, [left, middle, right]) = rest(&Beam::default(), &[0.3, 0.1]).expect("it rests");
    near(found.q[0], 0.0);
    near(found.q[1], 0.0);
    near(left + middle + right, 6.0 * G);
    near(left, right);
    assert!(found.shared && found.indifferent == [false; 2], "{found:?}");
}

mechanism! {
    /// A load on a spring with a motor that begins below a level.
    mechanism Lift;
    param lift: N = 40;
    coord y: m = 0;
    body load { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, 1], to: [0, y], stiffness: 100, length: 1 }
    event low: y < -0.1m until y > 0.1m;
    force motor: lift*low on y;
}

#[test]
fn events_have_the_values_of_the_start_until_a_rest_changes_them() {
    let find = |lift: f64, y: f64| equilibrium(&Lift { lift }, 0.0, &[y]);
    // Without the motor it would rest at −0.196 m, where the motor has begun; with it at 0.0038 m for 20 N.
    near(find(20.0, 0.0).expect("it rests").q[0], (20.0 - 2.0 * G) / 100.0);
    // 40 N lead beyond the end of the event, and that back to its begin.
    let failure = find(40.0, 0.0).expect_err("no rest");
    assert!(matches!(failure.kind, FailureKind::EventOfMotion { event } if event.name == "low"), "{failure}");
    near(find(5.0, -1.0).expect("it rests").q[0], (5.0 - 2.0 * G) / 100.0);
    let (found, _) = equilibrium_with_states(&Lift { lift: -3.0 }, 0.0, &[0.0]).expect("it rests");
    near(found.q[0], (-3.0 - 2.0 * G) / 100.0);
}

/// ω² of the small motions about the rest next to `q`, one after the other; the matrices must be diagonal.
fn squares<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
) -> Result<Vec<f64>, Failure> {
    let (found, still) = (equilibrium(mechanism, 0.0, q)?, [0.0; N]);
    let small = linearize(mechanism, 0.0, (&found.q, &still, &still), &found.lambda)?;
    Ok((0..small.freedom).map(|index| small.stiffness[index][index] / small.mass[index][index]).collect())
}

fn at_edge(found: Result<Vec<f64>, Failure>, name: &str) {
    let failure = found.expect_err("an edge");
    assert!(matches!(failure.kind, FailureKind::SetValuedEdge { row } if row.name == name), "{failure}");
}

mechanism! {
    /// A bead in a ring, in coordinates of its point.
    mechanism Ring;
    coord p: [m; 2] = [0.3, -1.9];
    body bead { mass: 3, com: p }
    gravity weight { acceleration: [0, -9.81] }
    contact ring { gap: 2m - norm(p), restitution: 0 }
}

mechanism! {
    /// A disk on a rough floor with a spring at its axle.
    mechanism Disk;
    param mus: 1 = 0.3;
    coord p: [m; 2] = [0.01, 0.1];
    coord a: rad = 0;
    body disk { mass: 4, com: p, inertia: 0.02, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [-1, 0.1], to: p, stiffness: 60, length: 1 }
    contact floor { gap: p[1] - 0.1m, restitution: 0.5 }
    friction rub { along: p[0] + 0.1m*a, normal: normal(floor), coefficient: 0.2, sticks: mus }
}

mechanism! {
    /// Two blocks with a spring between them on a rough floor; the second one has no friction.
    mechanism Two;
    coord x: m = 0;
    coord y: m = 1;
    body first { mass: 5, com: [x, 0] }
    body second { mass: 2, com: [y, 0] }
    tsda spring { from: [x, 0], to: [y, 0], stiffness: 50, length: 1 }
    friction rub { along: x, normal: 49N, coefficient: 0.1, sticks: 0.2 }
}

#[test]
fn small_motions_are_those_of_what_holds() {
    let ring = squares(&Ring::default(), &[0.3, -1.9]).expect("small motions");
    assert_eq!(ring.len(), 1, "{ring:?}");
    near(ring[0], G / 2.0);
    // A disk that rolls has half its mass again.
    let disk = squares(&Disk::default(), &[0.01, 0.1, 0.0]).expect("small motions");
    assert_eq!(disk.len(), 1, "{disk:?}");
    near(disk[0], 60.0 / 6.0);
    let two = squares(&Two::default(), &[0.0, 1.05]).expect("small motions");
    assert_eq!(two.len(), 1, "{two:?}");
    near(two[0], 50.0 / 2.0);
    let fixed = squares(&Groove::default(), &[0.3, 1.0]).expect("small motions");
    assert!(fixed.is_empty(), "{fixed:?}");
    let ladder = squares(&Ladder::default(), &[0.5, 0.75_f64.sqrt(), 120.0_f64.to_radians()]);
    assert!(ladder.expect("small motions").is_empty());
    // Above the floor the spring alone.
    near(squares(&Ball { k: 100.0 }, &[0.5]).expect("small motions")[0], 50.0);
}

#[test]
fn between_two_modes_there_are_no_small_motions() {
    at_edge(squares(&Block { mus: 0.1 }, &[5.0]), "rub");
    at_edge(squares(&Ball { k: 2.0 * G }, &[0.5]), "floor");
    assert!(squares(&Ball { k: 19.0 }, &[0.5]).expect("it rests on the floor").is_empty());
    let touch = linearize(&Ball::default(), 0.0, (&[0.0], &[1.0], &[-G]), &[]);
    let failure = touch.expect_err("it leaves the floor");
    assert!(matches!(failure.kind, FailureKind::SetValuedEdge { row } if row.name == "floor"), "{failure}");
    let moving = linearize(&Ball::default(), 0.0, (&[0.5], &[1.0], &[-G]), &[]).expect("a flight");
    assert!(moving.frozen && moving.freedom == 1, "{moving:?}");
    let slides = linearize(&Disk::default(), 0.0, (&[0.0, 0.1, 0.0], &[1.0, 0.0, 0.0], &[0.0; 3]), &[]);
    let failure = slides.expect_err("it moves on its contact");
    assert!(matches!(failure.kind, FailureKind::SetValuedForce { .. }), "{failure}");
}

#[test]
fn small_motions_have_the_events_of_a_run_that_starts_there() {
    near(squares(&Lift { lift: 5.0 }, &[-1.0]).expect("small motions")[0], 50.0);
    // The motor of this rest began below it, and a run that starts there has none.
    let failure = squares(&Lift { lift: 20.0 }, &[0.0]).expect_err("another history");
    assert!(matches!(failure.kind, FailureKind::EventOfMotion { event } if event.name == "low"), "{failure}");
}

mechanism! {
    /// A block that a spring holds on a belt.
    mechanism Belt;
    coord x: m = 0.2;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction belt { along: x - 0.1[m/s]*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15, speed: 0.2m/1s }
    out force: N = force(belt);
}

#[test]
fn on_a_belt_a_block_rests_where_sliding_friction_holds_it() {
    let fall = 0.05 * (-0.25_f64).exp();
    for start in [0.2, -0.5, 0.9] {
        let (found, [force]) = rest(&Belt::default(), &[start]).expect("it rests");
        near(force, (0.1 + fall) * G);
        near(found.q[0], force / 2.0);
        assert!(found.held == [false], "{found:?}");
        // The friction falls with the speed, so that small motions grow.
        let small = linearize(&Belt::default(), 0.0, (&found.q, &[0.0], &[0.0]), &[]).expect("small motions");
        near(small.damping[0][0], -fall * 2.0 * 0.1 / 0.04 * G);
        near(small.stiffness[0][0], 2.0);
    }
}

//! Small motions about a motion on which rows hold, against closed forms and the same motion in coordinates without these rows.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Linearization, Projection, Simulation, Tolerance, equilibrium, linearize,
    linearize_in,
};
use mbs_runtime::{Dynamic, FailureKind, mechanism};

type Run<S, const N: usize, const M: usize> = Simulation<S, Explicit<DormandPrince8, Projection>, f64, N, M>;

fn started<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(mechanism: S) -> Run<S, N, M> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(mechanism, method, 0.0).expect("it starts");
    run.with_tolerance(Tolerance::new(1e-13))
}

fn about<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    run: &Run<S, N, M>,
    independent: &[u16],
) -> Linearization<f64, N> {
    let state = (run.q(), run.qd(), run.qdd());
    linearize_in(run.mechanism(), run.t(), state, run.lambda(), independent).expect("it is regular")
}

fn entries<const N: usize>(small: &Linearization<f64, N>) -> [f64; 3] {
    assert!(small.freedom == 1 && small.frozen, "{small:?}");
    [small.mass, small.damping, small.stiffness].map(|matrix| matrix[0][0])
}

fn alike(one: [f64; 3], other: [f64; 3], bound: f64) {
    let size = one.iter().fold(1e-3_f64, |size, entry| size.max(entry.abs()));
    let apart = one.iter().zip(&other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    println!("{one:?}: off by {:.1e}", apart / size);
    assert!(apart < bound * size, "{one:?} {other:?}");
}

mechanism! {
    /// A damped bob on a shaken pivot, in its angle.
    mechanism ByAngle;
    coord phi: rad = -1.2;
    let bob = [0.2m*sin(3*t/1s), 0.1m*cos(5*t/1s)] + 0.8m*unit(phi);
    body mass { mass: 2, com: bob }
    gravity weight { acceleration: [0, -9.81] }
    force drag: -0.7[N*s/m]*der(bob) on bob;
    start phi = -1.2 rate -1;
}

mechanism! {
    /// The same in a shaken bowl that it presses on: one row ties the angle to the place, the contact holds the other.
    mechanism InBowl;
    coord P: [m; 2] = [0.29, -0.65];
    coord phi: rad = -1.2;
    let arm = P - [0.2m*sin(3*t/1s), 0.1m*cos(5*t/1s)];
    body mass { mass: 2, com: P }
    gravity weight { acceleration: [0, -9.81] }
    force drag: -0.7[N*s/m]*der(P) on P;
    constraint direction { cross(unit(phi), arm) == 0 [m]; }
    contact bowl { gap: 0.8m - norm(arm), restitution: 0 }
    start phi = -1.2 rate -1;
    start P = [0.8*cos(-1.2), 0.1 + 0.8*sin(-1.2)] rate [0.6 + 0.8*sin(-1.2), -0.8*cos(-1.2)];
}

#[test]
fn a_contact_that_holds_has_the_neighbours_of_a_bob_on_a_rod() {
    let (mut angle, mut bowl) = (started(ByAngle::<f64>::default()), started(InBowl::<f64>::default()));
    for t in [0.2, 0.7, 1.3] {
        angle.advance_to(t).expect("it moves");
        bowl.advance_to(t).expect("it moves");
        assert!((angle.q()[0] - bowl.q()[2]).abs() < 1e-10, "it has left the bowl");
        let small = about(&bowl, &[2]);
        assert_eq!(small.independent, [false, false, true]);
        alike(entries(&about(&angle, &[])), entries(&small), 1e-11);
    }
}

mechanism! {
    /// A bob on a carriage that rides on a shaken belt.
    mechanism OnBelt;
    coord x: m = 0;
    coord P: [m; 2] = [0.29, -0.75];
    coord phi: rad = -1.2;
    body carriage { mass: 3, com: [x, 0] }
    body mass { mass: 2, com: P }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { P == [x, 0.1m*cos(5*t/1s)] + 0.8m*unit(phi); }
    friction belt { along: x - 0.2m*sin(3*t/1s), normal: 500N, coefficient: 0.3, sticks: 0.4 }
    force drag: -0.7[N*s/m]*der(P) on P;
    start phi = -1.2 rate -1;
    start x = 0 rate 0.6;
}

#[test]
fn a_friction_that_sticks_to_a_moving_belt_has_the_neighbours_of_a_bob_on_it() {
    let (mut angle, mut belt) = (started(ByAngle::<f64>::default()), started(OnBelt::<f64>::default()));
    for t in [0.2, 0.7, 1.3] {
        angle.advance_to(t).expect("it moves");
        belt.advance_to(t).expect("it moves");
        assert!((angle.q()[0] - belt.q()[3]).abs() < 1e-10, "it has slipped");
        let small = about(&belt, &[3]);
        assert_eq!(small.independent, [false, false, false, true]);
        alike(entries(&about(&angle, &[])), entries(&small), 1e-11);
        // Without a wish the belt's row still leaves one motion.
        assert!(about(&belt, &[]).freedom == 1);
    }
}

mechanism! {
    /// A bead in a bowl, in the coordinates of its place.
    mechanism Bead;
    coord p: [m; 2] = [0.3, -0.4];
    body bead { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    contact bowl { gap: 0.5m - norm(p), restitution: 0 }
    start p = [0.3, -0.4] rate [0.8, 0.6];
}

#[test]
fn a_bead_in_a_bowl_has_the_neighbours_of_the_closed_form() {
    let mut run = started(Bead::<f64>::default());
    for t in [0.0, 0.1, 0.2] {
        run.advance_to(t).expect("it moves");
        let small = about(&run, &[0]);
        assert_eq!(small.independent, [true, false]);
        // With the angle a: ä = −(g/r) cos a, and x = r cos a gives δa = c δx with c = −1/(r sin a).
        let (m, g, r) = (2.0, 9.81, 0.5);
        let ([x, y], [vx, vy]) = (*run.q(), *run.qd());
        let (cosine, sine) = (x / r, y / r);
        let speed = (x * vy - y * vx) / (r * r);
        let growth = -g / r * cosine;
        let c = -1.0 / (r * sine);
        let rate = cosine * speed / (r * sine * sine);
        let bend = (sine * (cosine * growth - sine * speed * speed) - 2.0 * cosine * cosine * speed * speed)
            / (r * sine * sine * sine);
        let expected =
            [m * r * r * c * c, 2.0 * m * r * r * c * rate, m * r * r * c * (bend - g / r * sine * c)];
        alike(expected, entries(&small), 1e-11);
    }
}

mechanism! {
    /// A disk that slides on a rough floor, and one that rolls.
    mechanism Disk;
    param mu: 1 = 0.2;
    coord p: [m; 2] = [0, 0.1];
    coord a: rad = 0;
    body disk { mass: 4, com: p, inertia: 0.02, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [-1, 0.1], to: p, stiffness: 60, length: 1 }
    contact floor { gap: p[1] - 0.1m, restitution: 0 }
    friction rub { along: p[0] + 0.1m*a, normal: normal(floor), coefficient: mu, sticks: mu }
    start p = [0, 0.1] rate [0.1, 0];
    start a = 0 rate -1;
}

#[test]
fn a_disk_has_neighbours_where_it_rolls_and_where_it_slides() {
    let rolls = started(Disk::<f64>::default());
    let small = about(&rolls, &[0]);
    // Half its mass again, and the spring.
    alike([6.0, 0.0, 60.0], entries(&small), 1e-9);
    let mut slides = started(Disk { mu: 1e-3 });
    slides.advance_to(0.4).expect("it slides");
    let small = about(&slides, &[0, 2]);
    assert!(small.freedom == 2 && small.independent == [true, false, true], "{small:?}");
    // Its weight alone presses: the friction does not vary.
    for (matrix, along, around) in
        [(small.mass, 4.0, 0.02), (small.damping, 0.0, 0.0), (small.stiffness, 60.0, 0.0)]
    {
        alike([along, 0.0, 0.0], [matrix[0][0], matrix[0][1], matrix[1][0]], 1e-11);
        assert!((matrix[1][1] - around).abs() < 1e-11, "{matrix:?}");
    }
}

mechanism! {
    /// A block on a belt that runs below it, held by a spring from above.
    mechanism OnRunningBelt;
    param mu: 1 = 0.3;
    coord p: [m; 2] = [0, 0];
    body block { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [-1m, 0.5m], to: p, stiffness: 200, length: 0.9 }
    contact floor { gap: p[1], restitution: 0 }
    friction belt { along: p[0] - 3 [m/s]*t, normal: normal(floor), coefficient: mu, sticks: mu }
    start p = [0, 0] rate [0, 0];
}

/// Compares small motions about the rest of a block on a belt with the closed form.
fn is_stiffness_with_normal_force<S: Dynamic<f64, 2, M>, const M: usize>(block: &S, mu: f64) {
    let rest = equilibrium(block, 0.0, &[0.0, 0.0]).expect("it rests");
    let x: f64 = rest.q[0];
    let small = linearize(block, 0.0, (&rest.q, &[0.0; 2], &[0.0; 2]), &rest.lambda).expect("it is regular");
    assert!(small.freedom == 1 && !small.frozen, "{small:?}");
    let (k, free) = (200.0, 0.9);
    let length = (x + 1.0).hypot(0.5);
    let pull = 1.0 - free / length;
    let slope = free * (x + 1.0) / length.powi(3);
    let balance = -k * pull * (x + 1.0) + mu * (2.0 * 9.81 - 0.5 * k * pull);
    assert!(balance.abs() < 1e-8, "{balance}");
    let across = small.basis[0][0];
    let found = [small.mass, small.damping, small.stiffness].map(|matrix| matrix[0][0] / (across * across));
    alike([2.0, 0.0, k * (pull + slope * (x + 1.0)) + 0.5 * mu * k * slope], found, 1e-12);
}

#[test]
fn a_block_at_rest_on_a_running_belt_has_the_stiffness_of_its_normal_force() {
    for mu in [0.3, 0.9] {
        is_stiffness_with_normal_force(&OnRunningBelt { mu }, mu);
        is_stiffness_with_normal_force(&OnRunningGuide { mu }, mu);
    }
}

mechanism! {
    /// The same on a guide along the belt.
    mechanism OnRunningGuide;
    param mu: 1 = 0.3;
    coord p: [m; 2] = [0, 0];
    body block { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [-1m, 0.5m], to: p, stiffness: 200, length: 0.9 }
    constraint floor { p[1] == 0 [m]; }
    friction belt { along: p[0] - 3 [m/s]*t, normal: lambda(floor), coefficient: mu, speed: 1e-3 }
    start p = [0, 0] rate [0, 0];
}

mechanism! {
    /// A bead that slides in a rough bowl, in coordinates of its place and in its angle.
    mechanism RoughBead;
    param mu: 1 = 0.2;
    coord p: [m; 2] = [0.3, -0.4];
    coord phi: rad = -0.9;
    body bead { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint direction { cross(unit(phi), p) == 0 [m]; }
    contact bowl { gap: 0.5m - norm(p), restitution: 0 }
    friction rub { along: 0.5m*phi, normal: normal(bowl), coefficient: mu, sticks: mu }
    start phi = -2.4 rate 4;
    start p = [0.5*cos(-2.4), 0.5*sin(-2.4)] rate [-2*sin(-2.4), 2*cos(-2.4)];
}

mechanism! {
    /// The same on a wire.
    mechanism RoughWire;
    param mu: 1 = 0.2;
    coord p: [m; 2] = [0.3, -0.4];
    coord phi: rad = -0.9;
    body bead { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint direction { cross(unit(phi), p) == 0 [m]; }
    constraint wire { norm(p) == 0.5m; }
    friction rub { along: 0.5m*phi, normal: lambda(wire), coefficient: mu, speed: 1e-3 }
    start phi = -2.4 rate 4;
    start p = [0.5*cos(-2.4), 0.5*sin(-2.4)] rate [-2*sin(-2.4), 2*cos(-2.4)];
}

/// Compares small motions about the motion of a bead with the closed form: m L² φ̈ = −m g L cos φ − μ L N with N = m L φ̇² − m g sin φ, φ̇ > 0.
fn slides_with_normal_force<S: Dynamic<f64, 3, M>, const M: usize>(bead: S, mu: f64) {
    let (m, g, radius) = (2.0, 9.81, 0.5);
    let mut run = started(bead);
    for t in [0.0, 0.1, 0.2] {
        run.advance_to(t).expect("it moves");
        let small = about(&run, &[2]);
        assert_eq!(small.independent, [false, false, true]);
        let (phi, speed) = (run.q()[2], run.qd()[2]);
        assert!(speed > 0.05, "it has stopped");
        let damping = 2.0 * mu * m * radius * radius * speed;
        let stiffness = -m * g * radius * phi.sin() - mu * m * g * radius * phi.cos();
        alike([m * radius * radius, damping, stiffness], entries(&small), 1e-9);
    }
}

#[test]
fn a_bead_that_slides_in_its_bowl_has_the_neighbours_of_the_closed_form() {
    for mu in [0.0, 0.2, 0.8] {
        slides_with_normal_force(RoughBead { mu }, mu);
        slides_with_normal_force(RoughWire { mu }, mu);
    }
}

mechanism! {
    /// The same on two floors in one place, one of them smooth.
    mechanism OnTwoFloors;
    coord p: [m; 2] = [0, 0];
    body block { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [-1m, 0.5m], to: p, stiffness: 200, length: 0.9 }
    contact floor { gap: p[1], restitution: 0 }
    contact ice { gap: p[1], restitution: 0 }
    friction belt { along: p[0] - 3 [m/s]*t, normal: normal(floor), coefficient: 0.3, sticks: 0.3 }
    start p = [0, 0] rate [0, 0];
}

#[test]
fn a_friction_on_a_contact_whose_force_is_one_of_many_has_no_neighbours() {
    let block = OnTwoFloors::<f64>::default();
    let state = (&[0.0, 0.0], &[0.5, 0.0], &[0.0; 2]);
    let failure = linearize(&block, 0.0, state, &[]).expect_err("the share of the floor is not known");
    assert!(matches!(failure.kind, FailureKind::SetValuedForce { .. }), "{failure}");
}

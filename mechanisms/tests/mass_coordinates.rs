//! One four-bar with masses in four kinds of coordinates: the lecture's with a dummy body, relative angles, natural and mixed
//! coordinates. The motion and the forces in its pins are the same.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, mechanism};

mechanism! {
    /// The lecture's coordinates; the coupler point carries a body without mass that turns with the coupler.
    pub mechanism Lecture;
    coord x2: m;
    coord y2: m;
    coord phi1: rad = 60deg;
    coord phi2: rad = 0.7;
    coord phi3: rad = 1.6;
    let a = 0.2m*unit(phi1);
    let b = a + 0.6m*unit(phi2);
    body crank { mass: 0.4, inertia: 4e-3/3, com: a/2, angle: phi1 }
    body coupler { mass: 1.2, inertia: 0.036, com: (a + b)/2, angle: phi2 }
    body rocker { mass: 1, inertia: 0.25/12, com: [0.55m, 0] + 0.25m*unit(phi3), angle: phi3 }
    body dummy { mass: 0, inertia: 0, com: [x2, y2], angle: phi2 }
    gravity weight { acceleration: [0, -9.81] }
    constraint coupler_point { [x2, y2] == a + 0.35m*unit(30deg + phi2); }
    constraint closure { b == [0.55m, 0] + 0.5m*unit(phi3); }
    branch open: sin(phi3 - phi2) > 0;
    start phi1 = 60deg rate 0;
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out loop_force: [N; 2] = [lambda(closure[0]), lambda(closure[1])];
}

mechanism! {
    /// Each angle against the link before.
    pub mechanism Relative;
    coord psi: [rad; 3] = [60deg, -0.35, 0.9];
    let phi2 = psi[0] + psi[1];
    let phi3 = phi2 + psi[2];
    let a = 0.2m*unit(psi[0]);
    let b = a + 0.6m*unit(phi2);
    body crank { mass: 0.4, inertia: 4e-3/3, com: a/2, angle: psi[0] }
    body coupler { mass: 1.2, inertia: 0.036, com: (a + b)/2, angle: phi2 }
    body rocker { mass: 1, inertia: 0.25/12, com: b - 0.25m*unit(phi3), angle: phi3 }
    gravity weight { acceleration: [0, -9.81] }
    constraint cut { b - 0.5m*unit(phi3) == [0.55m, 0]; }
    branch open: sin(psi[2]) > 0;
    start psi[0] = 60deg rate 0;
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, coupler at a;
    pin elbow: coupler, rocker at b;
    pin pivot: ground, rocker at [0.55, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out loop_force: [N; 2] = reaction(elbow, rocker);
}

mechanism! {
    /// The joints themselves.
    pub mechanism Natural;
    coord a: [m; 2] = [0.1, 0.17320508075688773];
    coord b: [m; 2] = [0.53, 0.5];
    let d = [0.55m, 0];
    body crank { mass: 0.4, inertia: 4e-3/3, com: a/2, angle: atan2(a[1], a[0]) }
    body coupler { mass: 1.2, inertia: 0.036, com: (a + b)/2, angle: atan2(b[1] - a[1], b[0] - a[0]) }
    body rocker { mass: 1, inertia: 0.25/12, com: (b + d)/2, angle: atan2(b[1], b[0] - 0.55m) }
    gravity weight { acceleration: [0, -9.81] }
    constraint rigid {
        dot(a, a) == (0.2m)^2;
        dot(b - a, b - a) == (0.6m)^2;
        dot(b - d, b - d) == (0.5m)^2;
    }
    start a = [0.1, 0.17320508075688773] rate [0, 0];
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, coupler at a;
    pin elbow: coupler, rocker at b;
    pin pivot: ground, rocker at d;
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out loop_force: [N; 2] = reaction(elbow, rocker);
}

mechanism! {
    /// The crank's angle beside the joint behind the coupler and the rocker's angle.
    pub mechanism Mixed;
    coord phi1: rad = 60deg;
    coord b: [m; 2] = [0.53, 0.5];
    coord phi3: rad = 1.6;
    let a = 0.2m*unit(phi1);
    let d = [0.55m, 0];
    body crank { mass: 0.4, inertia: 4e-3/3, com: a/2, angle: phi1 }
    body coupler { mass: 1.2, inertia: 0.036, com: (a + b)/2, angle: atan2(b[1] - a[1], b[0] - a[0]) }
    body rocker { mass: 1, inertia: 0.25/12, com: (b + d)/2, angle: phi3 }
    gravity weight { acceleration: [0, -9.81] }
    constraint rocker_end { b == d + 0.5m*unit(phi3); }
    constraint coupler_length { dot(b - a, b - a) == (0.6m)^2; }
    start phi1 = 60deg rate 0;
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, coupler at a;
    pin elbow: coupler, rocker at b;
    pin pivot: ground, rocker at d;
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out loop_force: [N; 2] = reaction(elbow, rocker);
}

/// Bound of the differences of places (m) and of the energy, as a part of the largest kinetic energy.
const BOUND: f64 = 1e-9;

/// Bound of the differences of forces (N): accelerations have larger errors than the tolerance of the integration.
const FORCE_BOUND: f64 = 1e-8;

/// A and B, and the force of the coupler on the rocker, in steps of 0.1 s of a fall of 2 s.
fn fall<S: Dynamic<f64, N, M> + Default, const N: usize, const M: usize>() -> Vec<([f64; 4], [f64; 2])> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(S::default(), method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let (mut samples, mut most, mut defect) = (Vec::new(), 0.0_f64, 0.0_f64);
    for k in 0..=20 {
        if k > 0 {
            run.advance_to(0.1 * f64::from(k)).expect("it falls");
        }
        let (outputs, loads) = (run.outputs(), run.loads());
        let [first, second] = [0, 1].map(|i| loads.as_ref()[i]);
        samples.push(([0, 1, 2, 3].map(|i| outputs.as_ref()[i].value), [first, second]));
        most = most.max(run.balance().energy.kinetic);
        defect = defect.max(run.balance().defect.abs());
    }
    println!(
        "four-bar with mass, {N} coordinates: energy, of the largest kinetic {:.1e} of {BOUND:e}",
        defect / most
    );
    assert!(defect < BOUND * most, "{defect:e} of {most}");
    samples
}

#[test]
fn the_fall_and_its_forces_are_the_same_in_all_coordinates() {
    let lecture = fall::<Lecture, 5, 4>();
    for (name, other) in [
        ("relative", fall::<Relative, 3, 2>()),
        ("natural", fall::<Natural, 4, 3>()),
        ("mixed", fall::<Mixed, 4, 3>()),
    ] {
        let (mut place, mut force) = (0.0_f64, 0.0_f64);
        for ((a, left), (b, right)) in lecture.iter().zip(&other) {
            place = a.iter().zip(b).fold(place, |most, (a, b)| most.max((a - b).abs()));
            force = left.iter().zip(right).fold(force, |most, (a, b)| most.max((a - b).abs()));
        }
        println!(
            "four-bar with mass, {name}: places {place:.1e} m of {BOUND:e}, forces {force:.1e} N of {FORCE_BOUND:e}"
        );
        assert!(place < BOUND && force < FORCE_BOUND, "{name}: {place:e}, {force:e}");
    }
}

//! Tests of `mechanisms::andrews`.

use crate::newton_euler::{Body, Unknown, assert_agree, cross, forces, pin, plus, turning};
use crate::reference::{dynamics_of, load};
use mbs_workbench::erased::facade::Motion;
use mechanisms::andrews::*;

/// Pins in the order of [`sums`].
const PINS: [&str; 10] = [
    "crank_bearing_force",
    "crank_end_force",
    "triangle_bearing_force",
    "upper_bearing_force",
    "upper_end_force",
    "lower_bearing_force",
    "lower_end_force",
    "triangle_force",
    "upper_force",
    "lower_force",
];

/// Place and acceleration of a point that is `along` and, clockwise, `across` a direction away from `from`.
fn point(
    from: [[f64; 2]; 2],
    [along, across]: [f64; 2],
    [angle, rate, acceleration]: [f64; 3],
) -> [[f64; 2]; 2] {
    let arm = turning(along, angle, rate, acceleration);
    let clockwise = turning(-across, angle + std::f64::consts::FRAC_PI_2, rate, acceleration);
    [0, 1].map(|i| plus(from[i], plus(arm[i], clockwise[i])))
}

/// Forces in the ten pins and the torque on the crank at instant `k`.
fn sums(motion: &Motion, k: usize) -> Vec<f64> {
    let angle = |i: usize| {
        let curve = &motion.coordinates[i];
        [curve.q[k], curve.qd[k], curve.qdd[k]]
    };
    let sum = |i: usize, j: usize| {
        let (a, b) = (angle(i), angle(j));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    };
    let ground = |at: [f64; 2]| [at, [0.0; 2]];
    let (a, b, c) = ([-0.06934, -0.00227], [-0.03635, 0.03273], [0.014, 0.072]);
    let (crank, rod, triangle) = (angle(0), sum(0, 1), angle(2));
    let (upper, upper_guide, lower, lower_guide) = (sum(3, 4), angle(4), sum(5, 6), angle(6));
    let f = point(ground([0.0; 2]), [0.007, 0.0], crank);
    let (g, h) = (point(ground(a), [0.04, 0.0], upper_guide), point(ground(a), [0.0, 0.04], lower_guide));
    let centres = [
        (point(ground([0.0; 2]), [0.00092, 0.0], crank), crank, 0.04325, 2.194e-6),
        (point(f, [-0.0115, 0.0], rod), rod, 0.00365, 4.410e-7),
        (point(ground(b), [0.01043, 0.01874], triangle), triangle, 0.02373, 5.255e-6),
        (point(g, [0.0, 0.02 - 0.01421], upper), upper, 0.00706, 5.667e-7),
        (point(ground(a), [0.02308, -0.00916], upper_guide), upper_guide, 0.0705, 1.169e-5),
        (point(h, [0.02 - 0.01421, 0.0], lower), lower, 0.00706, 5.667e-7),
        (point(ground(a), [0.00449, 0.01228], lower_guide), lower_guide, 0.05498, 1.912e-5),
    ];
    let mut bodies = centres.map(|([centre, acceleration], [_, _, angular_acceleration], mass, inertia)| {
        Body { mass, inertia, centre, acceleration, angular_acceleration }
    });
    // The spring from C pulls the triangle at D: what it does is taken from the inertia.
    let [d, _] = point(ground(b), [0.02, 0.018], triangle);
    let way = [c[0] - d[0], c[1] - d[1]];
    let length = way[0].hypot(way[1]);
    let pull = way.map(|part| 4530.0 * (length - 0.07785) * part / length);
    let sprung = &mut bodies[2];
    let arm = [d[0] - sprung.centre[0], d[1] - sprung.centre[1]];
    sprung.acceleration = [0, 1].map(|i| sprung.acceleration[i] - pull[i] / sprung.mass);
    sprung.angular_acceleration -= cross(arm, pull) / sprung.inertia;
    let [e, _] = point(f, [-0.028, 0.0], rod);
    let pins = [
        pin([0.0; 2], 0, None),
        pin(f[0], 1, Some(0)),
        pin(b, 2, None),
        pin(a, 4, None),
        pin(g[0], 3, Some(4)),
        pin(a, 6, None),
        pin(h[0], 5, Some(6)),
        pin(e, 2, Some(1)),
        pin(e, 3, Some(1)),
        pin(e, 5, Some(1)),
    ];
    let unknowns = pins.into_iter().flatten().chain([Unknown::Torque { on: 0 }]);
    forces(&bodies, [0.0; 2], &unknowns.collect::<Vec<_>>())
}

#[test]
fn forces_of_pins_are_newtons_and_eulers_and_those_of_the_reference() {
    let found = dynamics_of(&CARD, 0, 60);
    let expected: Vec<Vec<f64>> = (0..found.motion.time.len()).map(|k| sums(&found.motion, k)).collect();
    assert_agree("andrews", &found.motion, &PINS, |_| 0.033, &expected);
    // At the start, by an independent code: the forces at E on the triangle and on both rods, which do not move yet.
    const REFERENCE: [(&str, [f64; 2]); 3] = [
        ("triangle_force", [98.56687039624109, -6.122688344255662]),
        ("upper_force", [0.0; 2]),
        ("lower_force", [0.0; 2]),
    ];
    /// Of the largest of them.
    const BOUND: f64 = 1e-10;
    let errors = REFERENCE.map(|(name, force)| {
        let off = [0, 1].map(|i| load(&found.motion, &format!("{name}.{i}"))[0] - force[i]);
        off[0].hypot(off[1]) / 98.56687039624109
    });
    println!("andrews: forces at E at the start, of the largest {errors:?} of {BOUND:e}");
    assert!(errors.iter().all(|error| *error < BOUND), "{errors:?}");
}

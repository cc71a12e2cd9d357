//! Andrews' squeezer: seven bodies, three loops, a spring and a constant torque.
//!
//! ```text
//!   O ─ F ─── E      crank OF and rod FE; at E meet the triangle BDE, whose corner D the spring
//!             │      pulls to C, and the rods EG and EH, whose other ends the bodies AG and AH
//!   A, B, C fixed    guide about A
//! ```
//!
//! Source: IFToMM benchmark A03; Test Set for IVP Solvers, problem "Andrews' squeezing mechanism" (Mazzia &
//! Magherini 2008), whose letters the parameters keep.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion};

use crate::known::states;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Andrews::default()).known_by(&KNOWN);

/// Published digits, with further instants.
const KNOWN: KnownMotion = KnownMotion {
    source: "published digits of the Test Set for IVP Solvers",
    error: 1e-10,
    course: KnownCourse::Table(|| states(include_str!("../tests/data/andrews.csv"), 7)),
};

mechanism! {
    /// Andrews' squeezer: one degree of freedom in seven angles.
    pub mechanism Andrews;
    /// Masses of the seven bodies.
    param m: [kg; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498];
    /// Their moments of inertia about the centres of mass.
    param I: [kg*m^2; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
    /// Bearings.
    param A: [m; 2] = [-0.06934, -0.00227];
    param B: [m; 2] = [-0.03635, 0.03273];
    param C: [m; 2] = [0.014, 0.072];
    /// Stiffness of the spring.
    param c0: N/m = 4530;
    /// Its length at rest.
    param l0: m = 0.07785;
    /// Torque on the crank.
    param mom: N*m = 0.033;
    const d: m = 0.028;
    const da: m = 0.0115;
    const e: m = 0.02;
    const ea: m = 0.01421;
    const rr: m = 0.007;
    const ra: m = 0.00092;
    const ss: m = 0.035;
    const sa: m = 0.01874;
    const sb: m = 0.01043;
    const sc: m = 0.018;
    const sd: m = 0.02;
    const ta: m = 0.02308;
    const tb: m = 0.00916;
    const u: m = 0.04;
    const ua: m = 0.01228;
    const ub: m = 0.00449;
    const zf: m = 0.02;
    const zt: m = 0.04;
    const fa: m = 0.01421;
    coord beta: rad = -0.06171389001427645;
    coord Theta: rad = 0;
    coord gamma: rad = 0.45527981916307037;
    coord Phi: rad = 0.22266839016588588;
    coord delta: rad = 0.48736497954384256;
    coord Omega: rad = -0.22266839016588588;
    coord epsilon: rad = 1.2305474445498212;
    let E = rr*unit(beta) - d*unit(beta + Theta);
    // Across a direction of angle phi, clockwise: [sin phi, −cos phi].
    let across_gamma = [sin(gamma), -cos(gamma)];
    let across_rod = [sin(Phi + delta), -cos(Phi + delta)];
    let across_epsilon = [sin(epsilon), -cos(epsilon)];
    let D = B + sd*unit(gamma) + sc*across_gamma;
    let G = A + zt*unit(delta);
    let H = A + u*across_epsilon;
    body crank { mass: m[0], inertia: I[0], com: ra*unit(beta), angle: beta }
    body rod { mass: m[1], inertia: I[1], com: rr*unit(beta) - da*unit(beta + Theta), angle: beta + Theta }
    body triangle { mass: m[2], inertia: I[2], com: B + sa*across_gamma + sb*unit(gamma), angle: gamma }
    body upper { mass: m[3], inertia: I[3], com: G + (e - ea)*across_rod, angle: Phi + delta }
    body upper_guide { mass: m[4], inertia: I[4], com: A + ta*unit(delta) - tb*[sin(delta), -cos(delta)], angle: delta }
    body lower { mass: m[5], inertia: I[5], com: H + (zf - fa)*unit(Omega + epsilon), angle: Omega + epsilon }
    body lower_guide { mass: m[6], inertia: I[6], com: A + ua*across_epsilon + ub*unit(epsilon), angle: epsilon }
    tsda spring { from: C, to: D, stiffness: c0, length: l0 }
    torque motor: mom on beta;
    constraint at_triangle { E == B + ss*across_gamma; }
    constraint at_upper { E == G + e*across_rod; }
    constraint at_lower { E == H + zf*unit(Omega + epsilon); }
    start beta = -0.06171389001427645 rate 0;
    pin crank_bearing: ground, crank at [0, 0];
    pin crank_end: crank, rod at rr*unit(beta);
    pin triangle_bearing: ground, triangle at B;
    pin upper_guide_bearing: ground, upper_guide at A;
    pin upper_guide_end: upper_guide, upper at G;
    pin lower_guide_bearing: ground, lower_guide at A;
    pin lower_guide_end: lower_guide, lower at H;
    // At E four bodies meet: the rod with each of the others.
    pin hub_of_triangle: rod, triangle at E;
    pin hub_of_upper: rod, upper at E;
    pin hub_of_lower: rod, lower at E;
    out crank_centre: [m; 2] = [0, 0];
    out crank_pin: [m; 2] = rr*unit(beta);
    out upper_bearing: [m; 2] = A;
    out lower_bearing: [m; 2] = B;
    out spring_bearing: [m; 2] = C;
    out hub: [m; 2] = E;
    out spring_end: [m; 2] = D;
    out upper_end: [m; 2] = G;
    out lower_end: [m; 2] = H;
    /// Force of the frame on the crank.
    out crank_bearing_force: [N; 2] = reaction(crank_bearing, crank);
    /// Force of the crank on the rod.
    out crank_end_force: [N; 2] = reaction(crank_end, rod);
    /// Force of the frame on the triangle BDE.
    out triangle_bearing_force: [N; 2] = reaction(triangle_bearing, triangle);
    /// Force of the frame on the guide AG.
    out upper_bearing_force: [N; 2] = reaction(upper_guide_bearing, upper_guide);
    /// Force of the guide AG on the rod EG.
    out upper_end_force: [N; 2] = reaction(upper_guide_end, upper);
    /// Force of the frame on the guide AH.
    out lower_bearing_force: [N; 2] = reaction(lower_guide_bearing, lower_guide);
    /// Force of the guide AH on the rod EH.
    out lower_end_force: [N; 2] = reaction(lower_guide_end, lower);
    /// Force at E on the triangle BDE.
    out triangle_force: [N; 2] = reaction(hub_of_triangle, triangle);
    /// Force at E on the rod EG.
    out upper_force: [N; 2] = reaction(hub_of_upper, upper);
    /// Force at E on the rod EH.
    out lower_force: [N; 2] = reaction(hub_of_lower, lower);

    title "Andrews' squeezer";
    about "A constant torque drives a crank with seven bodies against a spring: three loops, a time scale of \
           milliseconds, accelerations up to 5e5 rad/s².";
    preset "0.03 s" "from rest, under a constant torque" {}
    span 0.03s;
    draw ground crank_centre, upper_bearing, lower_bearing, spring_bearing;
    draw spring spring: spring_bearing, spring_end;
    draw plate triangle: lower_bearing, hub, spring_end;
    draw link "upper guide": upper_bearing, upper_end;
    draw link "upper rod": upper_end, hub;
    draw link "lower guide": upper_bearing, lower_end;
    draw link "lower rod": lower_end, hub;
    draw link rod: crank_pin, hub;
    draw link crank: crank_centre, crank_pin;
    draw joint crank_centre, crank_pin, hub, spring_end, upper_end, lower_end;
    trace hub;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::newton_euler::{Body, Unknown, assert_agree, cross, forces, pin, plus, turning};
    use crate::reference::{dynamics_of, load};
    use mbs_workbench::erased::facade::Motion;

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
        let mut bodies =
            centres.map(|([centre, acceleration], [_, _, angular_acceleration], mass, inertia)| Body {
                mass,
                inertia,
                centre,
                acceleration,
                angular_acceleration,
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
}

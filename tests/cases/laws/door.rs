//! A door with a closer: five effects on one angle, against the same laws integrated by hand.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::mechanism;

use crate::Worst;

mechanism! {
    /// A hand opens a door; a gas spring closes it against a damper with a check valve, up to the frame.
    pub mechanism Door;
    const WIDTH: m = 0.9;
    param m: kg = 30;
    coord phi: rad = 1deg;
    body leaf { mass: m, com: WIDTH/2*unit(phi), inertia: m*WIDTH^2/12, angle: phi }
    effect hand { force hand: 50N*max(1 - t/0.8s, 0)*unit(phi + 90deg) on 0.8m*unit(phi); }
    effect closer {
        param p0: Pa = 10bar;
        const AREA: m^2 = 6e-5;
        const LENGTH: m = 0.5;
        let reach = hypot(0.25m*cos(phi) - 0.05m, 0.25m*sin(phi) + 0.3m);
        let drawn = reach - hypot(0.2m, 0.3m);
        tsda gas { from: [0.05, -0.3], to: 0.25m*unit(phi), actuator: p0*AREA*(LENGTH/(LENGTH - drawn))^1.2 }
    }
    effect damper { torque damper: -12 [N*m*s]*min(der(phi), 0) - 0.5 [N*m*s]*max(der(phi), 0) on phi; }
    effect hinge {
        friction hinge {
            along: 8mm*phi, normal: 300N, coefficient: 0.25, sticks: 0.35, speed: 1mm/1s, bristles: 20um, damping: 30
        }
    }
    effect frame { contact frame { gap: WIDTH*phi, stiffness: 2e4, restitution: 0.4, approach: 0.3 } }
    start phi = 1deg rate 0;
    out knock: N = force(frame);
    out bent: m = deflection(hinge);
}

/// c − ln(1 + c) = −e c − ln(1 − e c) between the double root at 0 and 1/e, by bisection.
fn damping(e: f64) -> f64 {
    let open = |c: f64| c - c.ln_1p() + e * c + (-e * c).ln_1p();
    let (mut low, mut high) = (1e-3, 1.0 / e * (1.0 - 1e-15));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if open(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn a_door_with_five_effects_moves_as_the_laws_integrated_by_hand() {
    let d = damping(0.4) / 0.3;
    let rates = |t: f64, [phi, omega, z]: [f64; 3]| {
        let (sine, cosine) = phi.sin_cos();
        let hand = 0.8 * 50.0 * (1.0 - t / 0.8).max(0.0);
        // The moment of the tension about the hinge is T dl/dφ.
        let (x, y) = (0.25 * cosine - 0.05, 0.25 * sine + 0.3);
        let reach = x.hypot(y);
        let tension = 60.0 * (0.5 / (0.5 - (reach - 0.2_f64.hypot(0.3)))).powf(1.2);
        let gas = -tension * (0.25 * cosine * y - 0.25 * sine * x) / reach;
        let damper = -12.0 * omega.min(0.0) - 0.5 * omega.max(0.0);
        let v = 0.008 * omega;
        let growth = v - v.abs() * z / 20e-6 * 0.25 / (0.25 + 0.1 * (-(v / 1e-3_f64).powi(2)).exp());
        let hinge = -0.008 * 0.25 * 300.0 * (z / 20e-6 + 30.0 * growth);
        let frame = 0.9 * 2e4 * (-0.9 * phi).max(0.0) * (1.0 - d * 0.9 * omega).max(0.0);
        [omega, (hand + gas + damper + hinge + frame) / (30.0 * 0.81 / 3.0), growth]
    };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Door::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    let stiff = Explicit::new(Radau5, Projection::default());
    let stiff = Simulation::start_from_text(Door::default(), stiff, 0.0_f64).expect("it starts");
    let mut stiff = stiff.with_tolerance(Tolerance::new(1e-9));
    let [mut exactly, mut stiffly] = ["door (rad)", "door, Radau5 (rad)"].map(Worst::of);
    let (mut y, h) = ([1_f64.to_radians(), 0.0, 0.0], 2e-5);
    let (mut widest, mut knocks) = (0.0_f64, 0);
    for step in 0..300_000_u32 {
        let t = h * f64::from(step);
        let moved = |k: [f64; 3], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
        let first = rates(t, y);
        let second = rates(t + h / 2.0, moved(first, 0.5));
        let third = rates(t + h / 2.0, moved(second, 0.5));
        let fourth = rates(t + h, moved(third, 1.0));
        let before = y[0];
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
        widest = widest.max(y[0]);
        knocks += u32::from(before > 0.0 && y[0] <= 0.0);
        if (step + 1) % 10_000 == 0 {
            let t = h * f64::from(step + 1);
            run.advance_to(t).expect("it turns");
            stiff.advance_to(t).expect("it turns");
            exactly.see((run.q()[0] - y[0]).abs(), 1e-6, t);
            stiffly.see((stiff.q()[0] - y[0]).abs(), 1e-5, t);
            assert!((run.states()[0] - y[2]).abs() < 1e-7, "{t}: {:?} {y:?}", run.states());
        }
    }
    println!("door: opens by {widest:.2} rad, knocks {knocks} times, ends at {:.1e} rad", y[0]);
    assert!(widest > 0.5 && knocks > 0 && y[0].abs() < 0.01, "{widest} {knocks} {y:?}");
}

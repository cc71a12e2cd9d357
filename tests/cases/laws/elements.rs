//! Torsion bar, bushing, backlash, turning frame.

use core::f64::consts::PI;

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::mechanism;

use crate::Worst;

mechanism! {
    /// Two discs on a bar, a body in a bushing across the axes, a body seen from a turntable: none touches another.
    pub mechanism Elements;
    const G: Pa = 80e9;
    const DIAMETER: m = 6mm;
    const LENGTH: m = 0.4;
    const TILT: rad = 30deg;
    param kx: N/m = 4000;
    param ky: N/m = 900;
    param cx: N*s/m = 12;
    param cy: N*s/m = 3;
    param kt: N*m = 25;
    param ct: N*m*s = 0.05;
    param Omega: rad/s = 3;
    coord a: [rad; 2] = [0.1, 0];
    body disc { mass: 1kg, com: [0, 0], inertia: 0.02, angle: a[0] }
    body wheel { mass: 1kg, com: [0, 0], inertia: 0.05, angle: a[1] }
    rsda bar { angle: a[0] - a[1], stiffness: G*(PI*DIAMETER^4/32)/LENGTH }

    coord p: [m; 2] = [4mm, -2mm];
    coord beta: rad = 0.05;
    body engine { mass: 2kg, com: p, inertia: 0.01, angle: beta }
    let u = [dot(p, unit(TILT)), dot(p, unit(TILT + 90deg))];
    force bushing: [-kx*u[0] - cx*der(u[0]), -ky*u[1] - cy*der(u[1])] on u;
    rsda torsion { angle: beta, stiffness: kt, damping: ct }

    coord s: [m; 2] = [0.2, 0];
    body puck { mass: 0.5kg, com: s }
    potential centrifugal = -0.5kg*Omega^2*dot(s, s)/2;
    force coriolis: 2*0.5kg*Omega*[der(s[1]), -der(s[0])] on s;

    start a = [0.1, 0] rate [0, 0];
    start p = [4mm, -2mm] rate [0, 0];
    start beta = 0.05 rate 0;
    start s = [0.2, 0] rate [0.3, 0.1];
}

/// x̂ of m ẍ + c ẋ + k x = 0 from rest at 1, less than critically damped.
fn swing(k: f64, c: f64, m: f64, t: f64) -> f64 {
    let decay = c / (2.0 * m);
    let omega = (k / m - decay * decay).sqrt();
    (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin())
}

#[test]
fn elements_and_frames_are_their_closed_forms() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Elements::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let bar = 80e9 * PI * 6e-3_f64.powi(4) / 32.0 / 0.4;
    let mut worst = ["torsion bar (rad)", "bushing (m, rad)", "turning frame (m)"].map(Worst::of);
    for part in 1..=50 {
        let t = 0.02 * f64::from(part);
        run.advance_to(t).expect("it moves");
        let q = *run.q();
        // The discs turn against each other about their common centre.
        let twist = 0.1 * swing(bar, 0.0, 0.02 * 0.05 / 0.07, t);
        let centre = 0.1 * 0.02 / 0.07;
        let discs =
            (q[0] - centre - twist * 0.05 / 0.07).abs().max((q[1] - centre + twist * 0.02 / 0.07).abs());
        // Each axis of the bushing swings by itself.
        let (sine, cosine) = 30_f64.to_radians().sin_cos();
        let along = (4e-3 * cosine - 2e-3 * sine) * swing(4000.0, 12.0, 2.0, t);
        let across = (-4e-3 * sine - 2e-3 * cosine) * swing(900.0, 3.0, 2.0, t);
        let bushing =
            (q[2] - along * cosine + across * sine).abs().max((q[3] - along * sine - across * cosine).abs());
        let torsion = (q[4] - 0.05 * swing(25.0, 0.05, 0.01, t)).abs();
        // Straight on over the ground; the table turns below.
        let (x, y) = (0.2 + 0.3 * t, (0.1 + 3.0 * 0.2) * t);
        let (sine, cosine) = (3.0 * t).sin_cos();
        let puck = (q[5] - x * cosine - y * sine).abs().max((q[6] + x * sine - y * cosine).abs());
        for (worst, error) in worst.iter_mut().zip([discs, bushing.max(torsion), puck]) {
            worst.see(error, 1e-10, t);
        }
    }
}

mechanism! {
    /// Two gears with play, as a spring with a dead zone, and as two located contacts.
    pub mechanism Gears;
    param r: [m; 2] = [30mm, 60mm];
    param play: m = 0.2mm;
    param k: N/m = 1e6;
    coord a: [rad; 2] = 0;
    coord b: [rad; 2] = 0;
    for i in 0..2 {
        body zone { mass: 1kg, com: [0, 0], inertia: 1e-4*(1 + 7*i), angle: a[i] }
        body flank { mass: 1kg, com: [0, 0], inertia: 1e-4*(1 + 7*i), angle: b[i] }
        start a[i] = 0 rate 4 - 3*i;
        start b[i] = 0 rate 4 - 3*i;
    }
    let s = r[0]*a[0] - r[1]*a[1];
    let w = r[0]*b[0] - r[1]*b[1];
    force teeth: -k*(max(s - play/2, 0) + min(s + play/2, 0)) on s;
    contact front { gap: play/2 - w, stiffness: k }
    contact back { gap: play/2 + w, stiffness: k }
}

#[test]
fn gears_with_play_hammer_at_the_period_of_flight_and_contact() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Gears::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    // One mass between two springs: m = 1/(r₁²/J₁ + r₂²/J₂), from the middle of the play with the speed r₁ ω₁ − r₂ ω₂.
    let mass = 1.0 / (0.03 * 0.03 / 1e-4 + 0.06 * 0.06 / 8e-4);
    let (omega, speed, half) = ((1e6_f64 / mass).sqrt(), 0.03 * 4.0 - 0.06, 1e-4);
    let (flight, contact) = (2.0 * half / speed, PI / omega);
    let mut worst = ["backlash, dead zone (m)", "backlash, contacts (m)"].map(Worst::of);
    let exact = |t: f64| {
        let turn = (t + half / speed) / (flight + contact);
        let (side, within) = (turn.floor(), turn.fract() * (flight + contact));
        let sign = if side.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        match within < flight {
            true => sign * (speed * within - half),
            false => sign * (half + speed / omega * (omega * (within - flight)).sin()),
        }
    };
    for part in 1..=100 {
        let t = 2e-4 * f64::from(part);
        run.advance_to(t).expect("it hammers");
        let q = run.q();
        let found = [0.03 * q[0] - 0.06 * q[1], 0.03 * q[2] - 0.06 * q[3]];
        for (worst, found) in worst.iter_mut().zip(found) {
            worst.see((found - exact(t)).abs(), 1e-9, t);
        }
        // The torques on both have the ratio of the radii: J₁ ω₁/r₁ + J₂ ω₂/r₂ stays.
        let qd = run.qd();
        let kept = 1e-4 * qd[0] / 0.03 + 8e-4 * qd[1] / 0.06;
        assert!((kept - (1e-4 * 4.0 / 0.03 + 8e-4 / 0.06)).abs() < 1e-12, "{kept}");
    }
}

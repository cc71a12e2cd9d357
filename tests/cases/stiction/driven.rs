//! Inverse dynamics with frictions that stick, rigid contacts and events, where the motion tells their modes.

use mbs_runtime::dynamics::inverse;
use mbs_runtime::{FailureKind, mechanism};

const G: f64 = 9.81;

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-10 * expected.abs().max(1.0), "{found} {expected}");
}

mechanism! {
    /// A motor moves a slide to and fro on a rough guide; a brake helps the friction from the first second on.
    mechanism Slide;
    param way: m = 0.2;
    coord x: m = 0;
    body slide { mass: 3, com: [x, 0] }
    friction guide { along: x, normal: 20N, coefficient: 0.1, sticks: 0.15, viscous: 4 }
    event late: t > 1s;
    force brake: -5N*late on x;
    drive motor: x == way*sin(2*t/1s);
    out push: N = effort(motor);
    out drag: N = force(guide);
}

#[test]
fn a_driven_friction_slides_as_its_drive_says() {
    for t in [0.3_f64, 0.9, 1.4, 2.0] {
        let (sine, cosine) = (2.0 * t).sin_cos();
        let (speed, acceleration) = (0.4 * cosine, -0.8 * sine);
        let drag = -2.0 * speed.signum() - 4.0 * speed;
        let brake = if t > 1.0 { 5.0 } else { 0.0 };
        let found = inverse(&Slide::default(), t, &[0.2 * sine]).expect("it slides");
        near(found.loads[0], 3.0 * acceleration - drag + brake);
        near(found.loads[1], drag);
    }
    // Where it turns back, the force is that from there on.
    let found = inverse(&Slide::default(), core::f64::consts::FRAC_PI_4, &[0.2]).expect("it turns back");
    near(found.loads[0], 3.0 * -0.8 - 2.0);
    // At rest drive and friction hold it together, in any ratio.
    let failure = inverse(&Slide { way: 0.0 }, 0.5, &[0.0]).expect_err("it rests");
    assert!(matches!(failure.kind, FailureKind::SetValuedForce { row } if row.name == "guide"), "{failure}");
}

mechanism! {
    /// A cart that starts with a box on it.
    mechanism Cart;
    param a: m/s^2 = 2;
    coord x: m = 0;
    coord b: [m; 2] = [0, 0.3];
    body cart { mass: 10, com: [x, 0] }
    body box { mass: 4, com: b }
    gravity weight { acceleration: [0, -9.81] }
    contact bed { gap: b[1] - 0.3m, restitution: 0.2 }
    friction rub { along: b[0] - x, normal: normal(bed), coefficient: 0.3, sticks: 0.4 }
    drive motor: x == a*t^2/2;
    out push: N = effort(motor);
    out load: N = force(bed);
    out drag: N = force(rub);
}

#[test]
fn a_box_on_a_cart_goes_along_or_slips() {
    for (a, drag) in [(2.0, 8.0), (-3.0, -12.0), (5.0, 0.3 * 4.0 * G)] {
        let found = inverse(&Cart { a }, 0.0, &[0.0, 0.0, 0.3]).expect("it starts");
        near(found.loads[0], 10.0 * a + drag);
        near(found.loads[1], 4.0 * G);
        near(found.loads[2], drag);
        near(found.qdd[1], drag / 4.0);
    }
    // In the air it falls.
    let found = inverse(&Cart { a: 2.0 }, 0.0, &[0.0, 0.0, 0.5]).expect("it falls");
    near(found.loads[0], 20.0);
    near(found.qdd[2], -G);
    let failure = inverse(&Cart { a: 2.0 }, 0.0, &[0.0, 0.0, 0.2]).expect_err("it is in the bed");
    assert!(matches!(failure.kind, FailureKind::Penetration { contact, .. } if contact.name == "bed"));
}

mechanism! {
    /// A lift with a box on its floor that a motor moves up and down.
    mechanism Lift;
    param y0: m = 0;
    param way: m = 0.5;
    coord y: m = 0;
    coord z: m = 0.2;
    body cabin { mass: 20, com: [0, y] }
    body box { mass: 5, com: [0, z] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: z - y - 0.2m, restitution: 0 }
    contact pit { gap: y + 1m, restitution: 0 }
    drive motor: y == y0 + way*(cos(2*t/1s) - 1);
    out push: N = effort(motor);
    out load: N = force(floor);
}

#[test]
fn a_contact_is_closed_where_its_motion_says_so() {
    // At the top and at the bottom nothing moves: accelerations of −2 and 2 m/s².
    let half = core::f64::consts::FRAC_PI_2;
    for (t, place, acceleration, y0) in [(0.0, 0.0, -2.0, 0.0), (half, -0.9, 2.0, 0.1)] {
        let found = inverse(&Lift { y0, ..Lift::default() }, t, &[place, place + 0.2]).expect("it is closed");
        near(found.loads[0], 25.0 * (G + acceleration));
        near(found.loads[1], 5.0 * (G + acceleration));
    }
    // A cabin that falls faster than the box leaves it behind.
    let found = inverse(&Lift { way: 3.0, y0: 0.0 }, 0.0, &[0.0, 0.2]).expect("it opens");
    near(found.loads[0], 20.0 * (G - 12.0));
    near(found.loads[1], 0.0);
    near(found.qdd[1], -G);
    let refused = |lift: Lift, t: f64, q: [f64; 2], name: &str| {
        let failure = inverse(&lift, t, &q).expect_err("refused");
        assert!(matches!(failure.kind, FailureKind::SetValuedForce { row } if row.name == name), "{failure}");
    };
    // The floor goes away from a box at rest, or strikes it.
    let place = 0.5 * (2.0 * 0.3_f64).cos() - 0.5;
    refused(Lift::default(), 0.3, [place, place + 0.2], "floor");
    // At rest the motor may press into the pit with any force; where it turns back at once it does not.
    refused(Lift { y0: -1.0, way: 0.0 }, 0.3, [-1.0, -0.8], "pit");
    let found = inverse(&Lift::default(), half, &[-1.0, -0.8]).expect("it turns back");
    near(found.loads[0], 25.0 * (G + 2.0));
}

//! Contacts and frictions beside constraints: a pendulum onto a stop, a pin with friction, a collar whose normal force is a multiplier,
//! drives, and texts without any contact.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, MoreauJean, Projection, Simulation, Tolerance};
use mbs_runtime::{FailureKind, mechanism};

mechanism! {
    /// A pendulum in its point's coordinates, with a stop below its pivot.
    pub mechanism Pendulum;
    param e: 1 = 0.7;
    coord p: [m; 2] = [1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    contact stop { gap: p[0], restitution: e }
    start p = [1, 0] rate [0, 0];
    out hold: N = force(stop);
    out pull: N = 2*lambda(rod)*1m;
}

mechanism! {
    /// A pendulum on a pin of 2 cm with friction.
    pub mechanism Pin;
    param r: m = 20mm;
    coord phi: rad = 1;
    coord P: [m; 2] = [0.8, -0.5];
    constraint rod { P == 1m*[sin(phi), -cos(phi)]; }
    body bob { mass: 1kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    friction pin { along: r*phi, normal: 20, coefficient: 0.8, sticks: 1 }
    start phi = 1 rate 0;
}

mechanism! {
    /// A collar on a rod, whose normal force is the rod's.
    pub mechanism Collar;
    param mu: 1 = 0.2;
    coord p: [m; 2] = [0, 0];
    body collar { mass: 3, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint guide { p[1] == 0m; }
    friction rub { along: p[0], normal: lambda(guide), coefficient: mu, sticks: mu }
    start p = [0, 0] rate [1.5, 0];
    out drag: N = force(rub);
}

mechanism! {
    /// A driven crank that pushes a slider against a spring, and lifts a weight off a table.
    pub mechanism Driven;
    coord phi: rad = 0;
    coord y: m = 0;
    body load { mass: 2, com: [0, y] }
    drive motor: phi == 2 [rad/s]*t + 1 [rad/s^2]*t^2;
    gravity weight { acceleration: [0, -9.81] }
    contact cam { gap: y - 20mm*(1 - cos(phi)), restitution: 0 }
    out push: N = force(cam);
    out effort: N*m = effort(motor);
}

mechanism! {
    /// An arm that a motor turns onto a stop, and a floor that may be moved.
    pub mechanism Arm;
    param level: rad = 0.2;
    input motor: N*m;
    coord phi: rad = 1;
    body arm { mass: 1, com: 0.2m*unit(phi), inertia: 0.01, angle: phi }
    torque drive_side: motor on phi;
    contact stop { gap: 0.3m*(phi - level), restitution: 0.4 }
    start phi = 1 rate 0;
    out push: N = force(stop);
}

mechanism! {
    /// A mass that is pulled to the right of 0 and pushed back from 0.2 m on, until it is back at 0.
    pub mechanism Switched;
    coord x: m = 0;
    event over: x > 0.2m until x < 0m;
    body mass { mass: 2, com: [x, 0] }
    force pull: [(1 - 3*over)*1 [N], 0] on [x, 0];
    contact wall { gap: x + 1m, restitution: 0 }
    start x = 0 rate 0;
}

mechanism! {
    /// A four-bar linkage of bars with masses, no contact: a closed loop.
    pub mechanism FourBar;
    coord a: [rad; 3] = [1, 0.3, 1.5];
    body crank { mass: 1, com: 0.1m*unit(a[0]), inertia: 1/300, angle: a[0] }
    body rod { mass: 2, com: 0.2m*unit(a[0]) + 0.25m*unit(a[1]), inertia: 1/24, angle: a[1] }
    body rocker { mass: 1, com: [500mm, 0] + 0.2m*unit(a[2]), inertia: 1/75, angle: a[2] }
    gravity weight { acceleration: [0, -9.81] }
    rsda brake { angle: a[0], damping: 0.1 }
    constraint loop { 0.2m*unit(a[0]) + 0.5m*unit(a[1]) == [500mm, 0] + 0.4m*unit(a[2]); }
    start a[0] = 1 rate 0;
}

#[test]
fn a_pendulum_bounces_off_its_stop() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut located = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64).expect("it starts");
    located.advance_to(2.0).expect("it bounces");
    let mut off = [0.0_f64; 3];
    for (off, h) in off.iter_mut().zip([2e-3, 1e-3, 5e-4]) {
        let mut run =
            Simulation::start_from_text(Pendulum::default(), MoreauJean, 0.0_f64).expect("it starts");
        let mut last = f64::MAX;
        for _ in 0..(2.0_f64 / h).round() as u32 {
            run.step(h).expect("it bounces");
            let energy = run.balance().energy;
            let energy = energy.kinetic + energy.potential;
            // A swing gains what the rule has of error in a step, of the third order.
            assert!(energy <= last + 100.0 * h.powi(3), "{h}: {energy} {last}");
            last = energy;
        }
        assert!(run.balance().phi < 1e-14 && run.balance().phi_d < 1e-13, "{:?}", run.balance());
        assert!(run.balance().defect.abs() < 50.0 * h * h, "{h}: {:?}", run.balance());
        *off = (run.q()[0] - located.q()[0]) / h;
    }
    println!("pendulum onto a stop: off by {off:.2?} m over steps of 2, 1 and 0.5 ms in s");
    assert!(off.iter().all(|off| off.abs() < 10.0), "in steps: {off:?}");
    // Without rebound it hangs at the stop, beside a pull of its weight.
    let mut run = Simulation::start_from_text(Pendulum { e: 0.0 }, MoreauJean, 0.0_f64).expect("it starts");
    run.step_to(2.0, 1000).expect("it strikes");
    assert!(run.q()[0].abs() < 1e-12 && run.qd()[0].abs() < 1e-12, "{:?}", run.instant());
    let [hold, pull] = run.loads();
    assert!(hold.abs() < 1e-9 && (pull - 9.81).abs() < 1e-9, "{:?}", run.loads());
}

#[test]
fn a_pin_with_friction_ends_where_the_closed_form_does() {
    // Half swings: the energy falls by the work of a moment of 0.32 N m; it sticks where the weight's moment is below 0.4 N m.
    let mut phi = 1.0_f64;
    while 9.81 * phi.sin().abs() > 0.4 {
        let mut next = -phi;
        for _ in 0..50 {
            let open = 9.81 * (phi.cos() - next.cos()) + 0.32 * (phi - next) * phi.signum();
            next -= open / (9.81 * next.sin() - 0.32 * phi.signum());
        }
        phi = next;
    }
    for h in [4e-3, 2e-3] {
        let mut run = Simulation::start_from_text(Pin::default(), MoreauJean, 0.0_f64).expect("it starts");
        run.step_to(20.0, (20.0_f64 / h).round() as u32).expect("it rests");
        assert!((run.q()[0] - phi).abs() < h, "{h}: {:?} {phi}", run.q());
        assert!(run.qd()[0].abs() < 1e-15, "{:?}", run.instant());
    }
}

#[test]
fn a_collar_stops_after_its_way() {
    let way = 1.5 * 1.5 / (2.0 * 0.2 * 9.81);
    for h in [4e-3, 1e-3] {
        let mut run = Simulation::start_from_text(Collar::default(), MoreauJean, 0.0_f64).expect("it starts");
        run.step_to(1.5, (1.5_f64 / h).round() as u32).expect("it stops");
        assert!((run.q()[0] - way).abs() < h, "{h}: {:?} {way}", run.q());
        assert!(run.qd()[0].abs() < 1e-15 && run.loads()[0].abs() < 1e-12, "{:?}", run.instant());
    }
}

#[test]
fn a_cam_carries_a_load_and_throws_it() {
    // y = r (1 − cos φ) until its acceleration is below −g.
    let mut run = Simulation::start_from_text(Driven::default(), MoreauJean, 0.0_f64).expect("it starts");
    run.step_to(1.0, 1000).expect("it is carried");
    let (phi, rate) = (3.0_f64, 4.0_f64);
    assert!((run.q()[1] - 0.02 * (1.0 - phi.cos())).abs() < 1e-12, "{:?}", run.instant());
    assert!((run.qd()[1] - 0.02 * rate * phi.sin()).abs() < 1e-12, "{:?}", run.instant());
    let acceleration = 0.02 * (2.0 * phi.sin() + rate * rate * phi.cos());
    assert!((run.loads()[0] - 2.0 * (9.81 + acceleration)).abs() < 1e-9, "{:?}", run.loads());
    // Ten times faster it is thrown, and falls back onto the cam.
    let mut thrown = 0.0_f64;
    run.step_to(10.6, 9600).expect("it is thrown");
    for _ in 0..200 {
        run.step(1e-3).expect("it is thrown");
        thrown = thrown.max(run.q()[1] - 0.02 * (1.0 - run.q()[0].cos()));
    }
    assert!(thrown > 5e-4, "{thrown}");
}

#[test]
fn a_text_without_contacts_is_a_method_of_first_order() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let exact = Simulation::start_from_text(FourBar::default(), method, 0.0_f64).expect("it starts");
    let mut exact = exact.with_tolerance(Tolerance::new(1e-12));
    exact.advance_to(0.5).expect("it moves");
    let off = [800, 1600, 3200].map(|steps| {
        let mut run =
            Simulation::start_from_text(FourBar::default(), MoreauJean, 0.0_f64).expect("it starts");
        run.step_to(0.5, steps).expect("it moves");
        assert!(run.balance().phi < 1e-14, "{:?}", run.balance());
        (run.q()[0] - exact.q()[0]).abs()
    });
    assert!(off[0] > 1.7 * off[1] && off[1] > 1.7 * off[2] && off[2] < 1e-4, "{off:?}");
}

#[test]
fn a_control_loop_holds_an_arm_at_its_stop() {
    let mut run = Simulation::start_from_text(Arm::default(), MoreauJean, 0.0_f64).expect("it starts");
    for index in 0..4000 {
        let torque = -2.0 - f64::from(index % 7);
        run.change(|arm| arm.motor = torque);
        run.step(1e-3).expect("it moves");
        let holds = (run.loads()[0] + torque / 0.3).abs() < 1e-12 && run.qd()[0].abs() < 1e-15;
        assert!(index < 3000 || holds, "{index}: {:?} {:?}", run.instant(), run.loads());
    }
    assert!((run.q()[0] - 0.2).abs() < 1e-4, "{:?}", run.q());
    // A stop that is moved away lets it go; one that is moved into it is refused, and everything stays.
    let before = *run.instant();
    run.change(|arm| arm.level = 0.3);
    let failure = run.step(1e-3).expect_err("the arm is in the stop");
    assert!(
        matches!(failure.kind, FailureKind::Penetration { contact, .. } if contact.name == "stop"),
        "{failure}"
    );
    assert_eq!(run.instant(), &before);
    run.change(|arm| (arm.level, arm.motor) = (0.1, -0.5));
    run.step(1e-3).expect("it goes on");
    // 0.5 N m on 0.05 kg m².
    assert!((run.qd()[0] + 0.5 / 0.05 * 1e-3).abs() < 1e-12, "{:?}", run.instant());
}

#[test]
fn events_of_a_text_begin_and_end_with_steps() {
    // To 0.2 m in √0.8 s, on with 0.447 m/s, back at 0.2 − 2 (t − 0.894)²/2 …: the event ends at 0 after a root of a quadratic.
    let (first, speed) = (0.8_f64.sqrt(), 0.5 * 0.8_f64.sqrt());
    let back = first + (speed + (speed * speed + 0.4).sqrt());
    let after = -(speed * speed + 0.4).sqrt();
    let t = back + 0.2;
    let x = after * 0.2 + 0.25 * 0.04;
    for h in [1e-3, 2.5e-4] {
        let mut run =
            Simulation::start_from_text(Switched::default(), MoreauJean, 0.0_f64).expect("it starts");
        run.step_to(t, (t / h).round() as u32).expect("it moves");
        assert!((run.q()[0] - x).abs() < 3.0 * h, "{h}: {:?} {x}", run.q());
    }
}

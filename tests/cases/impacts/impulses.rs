//! Impulses of impacts by the names of their contacts, against closed forms.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Unstabilized};
use mbs_runtime::mechanism;

const G: f64 = 9.81;

mechanism! {
    /// A ball that bounces, the sum of its impulses, and an event of them.
    mechanism Ball;
    param e: 1 = 0.8;
    coord y: m = 1;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, restitution: e }
    event struck: impulse(floor) > 14 [N*s];
    latch hardest: N*s = impulse(floor) at struck;
    latch when: s = t at struck;
    out blow: N*s = impulse(floor);
    out first: [N*s; 1] = [hardest];
    out begun: [s; 2] = [when, struck*1s];
    start y = 1 rate 0;
}

#[test]
fn each_impact_has_the_impulse_of_its_approach() {
    let (m, e, v) = (2.0, 0.8_f64, (2.0 * G).sqrt());
    let fall = v / G;
    let impulse = |bounce: i32| m * (1.0 + e) * v * e.powi(bounce);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("a start");
    let fixed = Explicit::new(RungeKutta4, Unstabilized);
    let mut stepped = Simulation::start_from_text(Ball::default(), fixed, 0.0_f64).expect("a start");
    assert_eq!(run.loads(), [0.0; 4]);
    // The middle of each flight.
    let (mut t, mut flight) = (fall, 2.0 * fall * e);
    for bounce in 0..12 {
        run.advance_to(t + 0.5 * flight).expect("a run");
        stepped.step_to(t + 0.5 * flight, 5).expect("a run");
        let expected = impulse(bounce);
        for loads in [run.loads(), stepped.loads()] {
            let [blow, first, when, holds] = loads;
            assert!((blow - expected).abs() < 1e-9, "{bounce}: {blow} {expected}");
            // Above 14 N s is the first impact alone; the second one ends the event.
            assert_eq!(holds, if expected < 14.0 { 0.0 } else { 1.0 }, "{bounce}");
            assert!((first - impulse(0)).abs() < 1e-9 && (when - fall).abs() < 1e-9, "{first} {when}");
        }
        (t, flight) = (t + flight, flight * e);
    }
}

mechanism! {
    /// Two walls and two carts in a loop; the carts meet.
    mechanism Carts;
    coord x: [m; 2] = [0.2, 0.6];
    body light { mass: 1, com: [x[0], 0] }
    body heavy { mass: 3, com: [x[1], 0] }
    contact meet { gap: x[1] - x[0] - 0.1m, restitution: 0.5 }
    for i in 0..2 { contact walls { gap: i*1m + (1 - 2*i)*x[i], restitution: 1 } }
    for i in 0..2 { out at: N*s = impulse(walls[i]); }
    out middle: N*s = impulse(meet);
    start x[0] = 0.2 rate 2;
    start x[1] = 0.6 rate -1;
}

#[test]
fn two_bodies_have_the_impulse_of_their_reduced_mass() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Carts::default(), method, 0.0_f64).expect("a start");
    run.advance_to(0.11).expect("a run");
    // (1 + e) m₁ m₂/(m₁ + m₂) (v₁ − v₂), from where the light cart goes back with 2 − P and the heavy one with −1 + P/3.
    let impulse = 1.5 * 0.75 * 3.0;
    assert!((run.loads()[2] - impulse).abs() < 1e-12 && run.loads()[..2] == [0.0; 2], "{:?}", run.loads());
    let (light, heavy) = (2.0 - impulse, impulse / 3.0 - 1.0);
    assert!((run.qd()[0] - light).abs() < 1e-12 && (run.qd()[1] - heavy).abs() < 1e-12);
    run.advance_to(0.11 + 0.4 / -light).expect("a run");
    assert!((run.loads()[0] - 2.0 * -light).abs() < 1e-12, "{:?}", run.loads());
    assert_eq!(run.loads()[1], 0.0);
}

mechanism! {
    /// A beam that falls on both ends at once with friction, and slides.
    mechanism Beam;
    coord p: [m; 2] = [0, 0.5];
    coord phi: rad = 0;
    body beam { mass: 4, com: p, inertia: 0.2, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    let ends = [p - 0.4m*unit(phi), p + 0.4m*unit(phi)];
    for i in 0..2 {
        contact feet { gap: ends[i, 1], restitution: 0.3 }
        friction rub { along: ends[i, 0], normal: normal(feet[i]), coefficient: 0.1, sticks: 0.1 }
    }
    out both: N*s = impulse(feet[0]) + impulse(feet[1]);
    start p = [0, 0.5] rate [3, 0];
    start phi = 0 rate 0;
}

#[test]
fn normal_impulses_stand_beside_friction() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Beam::default(), method, 0.0_f64).expect("a start");
    let v = (2.0 * G * 0.5_f64).sqrt();
    run.advance_to(v / G + 0.01).expect("a run");
    // Friction turns the beam, so that both feet bear other impulses; their sum lifts it, and μ times it slows it.
    let sum = run.loads()[0];
    let rate = run.qd()[1] + G * 0.01;
    assert!((sum - 4.0 * (rate + v)).abs() < 1e-10, "{sum} {rate}");
    assert!((run.qd()[0] - (3.0 - 0.1 * sum / 4.0)).abs() < 1e-10 && sum > 1.3 * 4.0 * v * 0.99, "{sum}");
}

mechanism! {
    /// Newton's cradle, whose middle ball is struck and strikes at one time.
    mechanism Cradle;
    coord x: [m; 3] = [0, 0.1, 0.2];
    for i in 0..3 { body ball { mass: 2, com: [x[i], 0] } }
    for i in 0..2 { contact touch { gap: x[i + 1] - x[i] - 0.1m, restitution: 1, simultaneous: ordered } }
    for i in 0..2 { out blows: N*s = impulse(touch[i]); }
    start x = [0, 0.1, 0.2] rate [1, 0, 0];
}

#[test]
fn impacts_one_after_the_other_have_an_impulse_each() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Cradle::default(), method, 0.0_f64).expect("a start");
    run.advance_to(0.1).expect("a run");
    assert!(run.loads().iter().all(|blow| (blow - 2.0).abs() < 1e-12), "{:?}", run.loads());
}

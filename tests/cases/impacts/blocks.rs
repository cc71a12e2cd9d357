//! Blocks on rigid contacts with friction: on a slope, thrown onto a floor, on two feet, lifted off.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Formulation, Projection, RungeKutta4, Simulation, Tolerance,
    VelocityTransformation,
};
use mbs_runtime::mechanism;

const G: f64 = 9.81;

mechanism! {
    /// A block on a slope.
    pub mechanism Slope;
    param alpha: rad = 30deg;
    param mu: 1 = 0.5;
    coord p: [m; 2] = [0, 0];
    body block { mass: 2kg, com: p }
    gravity weight { acceleration: [0, -9.81] }
    friction rub { along: dot(p, unit(alpha)), normal: normal(ground), coefficient: mu, sticks: mu }
    contact ground { gap: dot(p, unit(alpha + 90deg)), restitution: 0.5 }
    out way: m = dot(p, unit(alpha));
    out pull: N = force(rub);
    out push: N = force(ground);
}

#[test]
fn a_block_on_a_slope_slides_above_the_angle_of_friction() {
    let alpha = 30.0_f64.to_radians();
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (less, slides) in [(1e-6, true), (-1e-6, false)] {
        let slope = Slope { mu: alpha.tan() - less, ..Slope::default() };
        let mut run = Simulation::start_from_text(slope, method, 0.0_f64).expect("it starts");
        run.advance_to(100.0).expect("it goes on");
        let way = if slides { -0.5 * G * alpha.cos() * less * 1e4 } else { 0.0 };
        let rounding = 1e-9 * way.abs();
        assert!((run.outputs()[0].value - way).abs() <= rounding, "{:?} {way}", run.instant());
        let [pull, push] = run.loads();
        let wanted = 2.0 * G * alpha.cos() * if slides { slope.mu } else { alpha.tan() };
        assert!((pull - wanted).abs() < 1e-9 && (push - 2.0 * G * alpha.cos()).abs() < 1e-9, "{pull} {push}");
        assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
    }
}

mechanism! {
    /// A block thrown onto a floor.
    pub mechanism Thrown;
    param e: 1 = 0;
    param pull: N = 0;
    param lift: N = 0;
    coord p: [m; 2] = [0, 0.2];
    body block { mass: 0.5kg, com: p }
    gravity weight { acceleration: [0, -9.81] }
    force drawn: [pull, lift] on p;
    contact floor { gap: p[1], restitution: e }
    friction rub { along: p[0], normal: normal(floor), coefficient: 0.3, sticks: 0.4 }
    start p = [0, 0.2] rate [3, 0];
    out force: N = force(rub);
    out push: N = force(floor);
}

/// Place and time at which it has come to rest: each impact takes μ (1 + e) v from the speed, and the series of bounces with e is summed.
fn rest(e: f64) -> [f64; 2] {
    let (mu, fall) = (0.3, (0.4 / G).sqrt());
    let (mut x, mut t, mut vx, mut vy) = (3.0 * fall, fall, 3.0_f64, G * fall);
    for _ in 0..400 {
        vx = (vx - mu * (1.0 + e) * vy).max(0.0);
        vy *= e;
        (x, t) = (x + vx * 2.0 * vy / G, t + 2.0 * vy / G);
    }
    [x + vx * vx / (2.0 * mu * G), t + vx / (mu * G)]
}

fn comes_to_rest<F: Formulation<Thrown<f64>, f64, 2, 0>>(formulation: F, e: f64) {
    let thrown = Thrown { e, ..Thrown::default() };
    let [x, t] = rest(e);
    let mut fixed = Simulation::start_from_text(thrown, Explicit::new(RungeKutta4, &formulation), 0.0_f64)
        .expect("it starts");
    fixed.step_to(3.0, 100).expect("it comes to rest");
    assert!((fixed.q()[0] - x).abs() < 1e-8 && fixed.qd()[0].abs() < 1e-14, "{e}: {:?} {x}", fixed.instant());
    let run = Simulation::start_from_text(thrown, Explicit::new(DormandPrince8, &formulation), 0.0_f64);
    let mut run = run.expect("it starts").with_tolerance(Tolerance::new(1e-12));
    // With 0.8 it bounces on where it is.
    if e < 0.6 {
        run.advance_to(t - 1e-4).expect("it slides");
        assert!((run.qd()[0] - 0.3 * G * 1e-4).abs() < 1e-9, "{e}: {:?}", run.instant());
    }
    run.advance_to(t + 1e-4).expect("it comes to rest");
    assert!((run.q()[0] - x).abs() < 1e-9 && run.qd()[0] == 0.0, "{e}: {:?} {x}", run.instant());
    assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
}

#[test]
fn a_thrown_block_slides_to_rest() {
    for e in [0.0, 0.5, 0.8] {
        comes_to_rest(Projection::default(), e);
    }
    comes_to_rest(VelocityTransformation, 0.5);
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Thrown::<f32>::default(), method, 0.0_f32).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(2.0).expect("it comes to rest");
    assert!((f64::from(run.q()[0]) - rest(0.0)[0]).abs() < 1e-4 && run.qd()[0] == 0.0, "{:?}", run.instant());
}

#[test]
fn what_rests_is_drawn_held_and_lifted() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Thrown::default(), method, 0.0_f64).expect("it starts");
    run.advance_to(3.0).expect("it comes to rest");
    let weight = 0.5 * G;
    // 0.4 of the weight holds it, less weight does not.
    run.change(|block| block.pull = 0.39 * weight);
    run.advance_to(4.0).expect("it is held");
    assert!(run.qd()[0] == 0.0 && (run.loads()[0] + 0.39 * weight).abs() < 1e-12, "{:?}", run.loads());
    run.change(|block| block.lift = 0.1 * weight);
    run.advance_to(5.0).expect("it slides");
    let speed = 2.0 * (0.39 - 0.3 * 0.9) * weight;
    assert!((run.qd()[0] - speed).abs() < 1e-12, "{:?} {speed}", run.instant());
    run.change(|block| block.lift = 1.5 * weight);
    run.advance_to(6.0).expect("it flies");
    let wanted = [speed + 2.0 * 0.39 * weight, 0.5 * G];
    assert!(run.qd().iter().zip(wanted).all(|(v, wanted)| (v - wanted).abs() < 1e-12), "{:?}", run.instant());
    assert!(run.loads() == [0.0; 2], "{:?}", run.loads());
}

mechanism! {
    /// A box on two feet, pushed at a height.
    pub mechanism Box;
    param push: N = 0;
    param mu: 1 = 0.3;
    param v0: m/s = 0;
    const H: m = 0.5;
    coord p: [m; 2] = [0, 0.5];
    coord a: rad = 0;
    body whole { mass: 2kg, com: p, inertia: 0.2, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    force pushed: [push, 0] on p;
    let left = p - 0.4m*unit(a) - H*unit(a + 90deg);
    let right = p + 0.4m*unit(a) - H*unit(a + 90deg);
    contact l { gap: left[1], restitution: 0 }
    contact r { gap: right[1], restitution: 0 }
    friction fl { along: left[0], normal: normal(l), coefficient: mu, sticks: mu }
    friction fr { along: right[0], normal: normal(r), coefficient: mu, sticks: mu }
    start p = [0, 0.5] rate [v0, 0];
    out forces: [N; 4] = [force(l), force(r), force(fl), force(fr)];
}

#[test]
fn two_feet_share_friction_within_their_cones() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let weight = 2.0 * G;
    // It sticks, slides, and tips over its right foot where the push is more than 0.4/0.5 of the weight.
    for (push, mu) in [(0.29, 0.3), (0.5, 0.3), (0.9, 1.2)] {
        let pushed = Box { push: push * weight, mu, ..Box::default() };
        let mut run = Simulation::start_from_text(pushed, method, 0.0_f64).expect("it starts");
        run.advance_to(1e-3).expect("it goes on");
        let [l, r, fl, fr]: [f64; 4] = run.loads();
        assert!(fl.abs() <= mu * l + 1e-9 && fr.abs() <= mu * r + 1e-9, "{push}: {:?}", run.loads());
        if push < 0.8 {
            let held = -weight * f64::min(push, mu);
            assert!((l + r - weight).abs() < 1e-9 && (fl + fr - held).abs() < 1e-9, "{:?}", run.loads());
            assert!((0.4 * (r - l) + 0.5 * (fl + fr)).abs() < 1e-9, "{push}: {:?}", run.loads());
            let speed = (push - f64::min(push, mu)) * G * 1e-3;
            assert!((run.qd()[0] - speed).abs() < 1e-12, "{push}: {:?}", run.instant());
        } else {
            // About the foot, of moment of inertia 0.2 + 2 (0.4² + 0.5²).
            let turn = (0.5 * push - 0.4) * weight / (0.2 + 2.0 * 0.41);
            assert!(
                l == 0.0 && fl == 0.0 && (run.qd()[2] + turn * 1e-3).abs() < 1e-8,
                "{:?} {turn}",
                run.instant()
            );
        }
    }
    // What slides comes to rest on both feet.
    let pushed = Box { v0: 1.0, ..Box::default() };
    let mut run = Simulation::start_from_text(pushed, method, 0.0_f64).expect("it starts");
    run.advance_to(2.0).expect("it comes to rest");
    assert!((run.q()[0] - 0.5 / (0.3 * G)).abs() < 1e-9 && run.qd()[0].abs() < 1e-20, "{:?}", run.instant());
}

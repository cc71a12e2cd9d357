//! Disks that bounce, slide and roll.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance};
use mbs_runtime::mechanism;

const G: f64 = 9.81;

mechanism! {
    /// A disk above a floor.
    pub mechanism Disk;
    param m: kg = 0.4;
    param r: m = 0.1;
    param share: 1 = 0.5;
    param mu: 1 = 0.2;
    param e: 1 = 0.8;
    param height: m = 0.3;
    param v0: m/s = 1;
    param spin: rad/s = 0;
    coord p: [m; 2] = [0, 0.4];
    coord a: rad = 0;
    body disk { mass: m, com: p, inertia: share*m*r^2, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: p[1] - r, restitution: e }
    friction rub { along: p[0] + r*a, normal: normal(floor), coefficient: mu, sticks: mu }
    start p = [0, r + height] rate [v0, 0];
    start a = 0 rate spin;
    out force: N = force(rub);
}

/// Velocity and spin after the first impact, by Moreau's law: the impulse stops the slip, or is μ times the normal one.
fn bounced(disk: &Disk<f64>) -> ([f64; 3], bool) {
    let (m, r, inertia) = (disk.m, disk.r, disk.share * disk.m * disk.r * disk.r);
    let fall = (2.0 * G * disk.height).sqrt();
    let normal = (1.0 + disk.e) * m * fall;
    let slip = disk.v0 + r * disk.spin;
    let stops = slip.abs() / (1.0 / m + r * r / inertia);
    let sticks = stops <= disk.mu * normal;
    let impulse = -slip.signum() * f64::min(stops, disk.mu * normal);
    ([disk.v0 + impulse / m, disk.e * fall, disk.spin + r * impulse / inertia], sticks)
}

#[test]
fn a_disk_bounces_with_spin() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (spin, wanted) in [(-5.0, true), (-40.0, false), (-20.0, true), (60.0, false), (0.0, true)] {
        let disk = Disk { spin, ..Disk::default() };
        let run = Simulation::start_from_text(disk, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-12));
        let fall = (2.0 * disk.height / G).sqrt();
        run.advance_to(fall + 0.1).expect("it bounces");
        let ([vx, vy, turn], sticks) = bounced(&disk);
        assert_eq!(sticks, wanted, "{spin}");
        let found = run.qd();
        for (found, wanted) in found.iter().zip([vx, vy - G * 0.1, turn]) {
            assert!((found - wanted).abs() < 1e-10, "{spin}: {:?} {:?}", run.qd(), [vx, vy, turn]);
        }
        assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
    }
}

#[test]
fn a_disk_that_lands_sliding_begins_to_roll() {
    for share in [0.5, 1.0, 0.4] {
        let disk = Disk { share, height: 0.0, e: 0.0, ..Disk::default() };
        // μ g t (1 + m r²/J) = v; of a disk v/(3 μ g), of a ring v/(2 μ g), of a ball 2 v/(7 μ g).
        let rolls = 1.0 / (0.2 * G * (1.0 + 1.0 / share));
        let speed = 1.0 / (1.0 + share);
        let method = Explicit::new(DormandPrince8, Projection::default());
        let mut run = Simulation::start_from_text(disk, method, 0.0_f64).expect("it starts");
        run.advance_to(rolls - 1e-6).expect("it slides");
        assert!((run.loads()[0] + 0.2 * 0.4 * G).abs() < 1e-12, "{:?}", run.loads());
        run.advance_to(rolls + 1e-6).expect("it rolls");
        assert!(run.loads()[0].abs() < 1e-12, "{:?}", run.loads());
        run.advance_to(10.0).expect("it rolls");
        let place = rolls * (1.0 + speed) / 2.0 + speed * (10.0 - rolls);
        let [x, _, _] = *run.q();
        let [vx, vy, turn] = *run.qd();
        assert!(
            (x - place).abs() < 1e-9 && (vx - speed).abs() < 1e-12,
            "{share}: {:?} {place}",
            run.instant()
        );
        assert!(vy == 0.0 && (vx + 0.1 * turn).abs() < 1e-14, "{share}: {:?}", run.instant());
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut fixed = Simulation::start_from_text(disk, method, 0.0_f64).expect("it starts");
        fixed.step_to(10.0, 37).expect("it rolls");
        assert!((fixed.q()[0] - place).abs() < 1e-9, "{share}: {:?} {place}", fixed.instant());
    }
}

#[test]
fn energy_never_rises_until_a_bouncing_disk_rolls() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for spin in [-50.0, 10.0, 80.0] {
        let disk = Disk { spin, ..Disk::default() };
        let mut run = Simulation::start_from_text(disk, method, 0.0_f64).expect("it starts");
        let mut last = f64::MAX;
        for index in 1..=120 {
            run.advance_to(0.05 * f64::from(index)).expect("it goes on");
            let energy = run.balance().energy;
            let energy = energy.kinetic + energy.potential;
            assert!(energy <= last + 1e-11, "{spin}: {energy} {last}");
            last = energy;
        }
        let [vx, vy, turn] = *run.qd();
        assert!(vy == 0.0 && (vx + 0.1 * turn).abs() < 1e-12, "{spin}: {:?}", run.instant());
        // About a point of the floor nothing turns it: m v r − J ω is kept by every force.
        let kept = 1.0 - 0.5 * 0.1 * spin;
        assert!((vx - 0.5 * 0.1 * turn - kept).abs() < 1e-9, "{spin}: {:?} {kept}", run.instant());
    }
}

//! A cam from a measured table: a spline through 36 points becomes the motion law of a follower.

use core::array::from_fn;
use core::f64::consts::TAU;

use mbs_runtime::driver::PeriodicQuintic;
use mbs_runtime::{Mechanism, Stepper, mechanism};

mechanism! {
    /// A cam turns, a flat-faced follower rises; P is the point of contact.
    pub mechanism Follower;
    param base: m = 30mm;
    param omega: rad/s = 300rpm;
    function lift: m(rad), C4, periodic TAU;
    coord theta: rad;
    coord y: m;
    drive cam: theta == omega*t;
    constraint face { y == base + lift(theta); }
    out P: [m; 2] = [lift.d1(theta), y];
    out curvature_radius: m = base + lift(theta) + lift.d2(theta);
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // The table: every 10 degrees a lift (m). Here it is computed, so that the error is known.
    let angle: [f64; 36] = from_fn(|point| TAU * point as f64 / 36.0);
    let lift = |angle: f64| 0.004 * (1.0 - angle.cos()) + 0.0004 * (1.0 - (2.0 * angle).cos());
    let table = angle.map(lift);
    let spline = PeriodicQuintic::interpolate(&angle, TAU, &table)?;

    let follower = Follower::new(&spline);
    let guess = follower.guess(&follower.parameters());
    let mut motion = Stepper::assemble(follower, guess, 0.0)?;
    println!("cam        lift       speed        acceleration   radius of curvature");
    let (mut error, mut smallest) = (0.0_f64, f64::INFINITY);
    for step in 0..360 {
        let (q, qd, qdd): ([f64; 2], _, _) = (*motion.q(), *motion.qd(), *motion.qdd());
        let [.., radius] = motion.outputs();
        if step % 60 == 30 {
            let [lift, radius] = [q[1] - 0.03, radius.value].map(|length| 1e3 * length);
            println!(
                "{:6.1}°  {lift:6.3} mm  {:8.4} m/s  {:9.3} m/s²  {radius:9.2} mm",
                q[0].to_degrees(),
                qd[1],
                qdd[1]
            );
        }
        error = error.max((q[1] - 0.03 - lift(q[0])).abs());
        smallest = smallest.min(radius.value);
        motion.advance(TAU / 360.0 / follower.omega)?;
    }
    println!(
        "largest error of the lift {error:.0e} m, smallest radius of curvature {:.2} mm",
        1e3 * smallest
    );
    Ok(())
}

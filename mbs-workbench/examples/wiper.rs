//! Mechanisms of one's own in the program: `cargo run --example wiper -- run wiper`.

use std::process::ExitCode;

use mbs_runtime::{Function, Scalar, mechanism};
use mbs_workbench::card;

mechanism! {
    /// A windscreen wiper: a motor turns a crank, a rod moves the rocker.
    pub mechanism Wiper;
    param crank: m = 40mm;
    param rod: m = 250mm;
    param rocker: m = 80mm in 20mm..120mm, tolerance 0.1mm;
    param base: m = 240mm;
    param speed: rad/s = 45rpm;
    coord theta: rad = 0;
    coord phi: rad = 0.3;
    coord psi: rad = 1.2;
    let A = crank*unit(theta);
    constraint closure { A + rod*unit(phi) == [base, 0] + rocker*unit(psi); }
    drive motor: theta == speed*t;
    out O: [m; 2] = [0, 0];
    out C: [m; 2] = [base, 0];
    out B: [m; 2] = [base, 0] + rocker*unit(psi);
    out blade: [m; 2] = [base, 0] + 0.5m*unit(psi);
    title "Windscreen wiper";
    preset rain "45 turns a minute" {}
    preset drizzle "20 turns a minute" { speed: 20rpm }
    span turn(speed);
    draw ground O, C;
    draw link crank: O, A;
    draw link rod: A, B;
    draw link rocker: C, B, blade;
    draw joint O, A, B, C;
    trace blade;
}

mechanism! {
    /// A follower on a cam whose law the caller gives.
    pub mechanism Follower;
    param omega: rad/s = 60rpm;
    function lift: m(rad), C3, periodic TAU;
    coord theta: rad;
    coord y: m;
    constraint contact { y == 30mm + lift(theta); }
    drive turn: theta == omega*t;
    out P: [m; 2] = [0, y];
}

mechanism! {
    /// A rocker that a measured angle moves.
    pub mechanism Probe;
    param arm: m = 100mm;
    param reach: m = 150mm;
    input theta: rad, rates;
    coord phi: rad;
    let A = arm*unit(theta);
    drive encoder: phi == theta;
    out angle: rad = phi;
    out tip: [m; 2] = arm*unit(phi);
    coord x: m = 0.1;
    constraint slide { norm([x, arm*sin(phi)]) == reach; }
    branch right: x > 0;
    draw joint A;
    title "Measured rocker";
}

mechanism! {
    /// A block on a rail that a measured force pushes, with an arm on a measured angle.
    pub mechanism Pushed;
    param mass: kg = 2;
    param inertia: kg*m^2 = 0.3;
    input thrust: N;
    input theta: rad, rates;
    coord x: m = 0;
    coord phi: rad = 0;
    body block { mass: mass, com: [x, 0] }
    body arm { mass: 1, com: [0, 0], inertia: inertia, angle: phi }
    force push: [thrust, 0] on [x, 0];
    start x = 0 rate 0;
    effect turned { drive encoder: phi == theta; out torque: N*m = effort(encoder); }
    effect guided { param pace: m/s = 1; drive rail: x == pace*t; out rail_force: N = effort(rail); }
    scene Free = turned;
    scene Guided = turned + guided;
}

/// A lift of ten millimetres in one turn.
#[derive(Clone, Copy, Debug)]
struct Lift;

impl<T: Scalar> Function<T> for Lift {
    const ORDER: usize = usize::MAX;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let ([sine], [cosine]) = T::sin_cos([x]);
        let half = T::constant(0.005);
        core::array::from_fn(|order| {
            let wave = half * [-cosine, sine, cosine, -sine][order % 4];
            if order == 0 { half + wave } else { wave }
        })
    }
}

/// The cam with that lift.
fn cam() -> Follower<Lift> {
    Follower::new(Lift)
}

fn main() -> ExitCode {
    mbs_workbench::program(&[
        card!(Wiper::default()),
        card!(cam()),
        card!(Probe::default()),
        card!(PushedFree::default()),
        card!(PushedGuided::default()),
    ])
}

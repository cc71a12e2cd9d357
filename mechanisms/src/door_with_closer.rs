//! A door with a closer: friction that sticks holds it open where the gas spring is near its dead centre, a latch keeps it shut.
//!
//! ```text
//!            /
//!           / leaf       φ: 0 where it is shut (rad)
//!          /
//!      O  o----------|   frame
//!          ⊓
//!          o             gas spring and damper of the closer
//! ```
//!
//! Lengths in metres, masses in kg, `q = φ`.
//!
//! | effect | law |
//! |---|---|
//! | `closer` | gas spring that pulls: p₀ A (L/(L − s))^1.2 |
//! | `damper` | −c ω, with a check valve that lets it open |
//! | `hinge` | friction that sticks, at a radius of 20 mm |
//! | `wind` | a gust on the leaf, 16 (x (1 − x))² over its duration |
//! | `frame` | contact at the edge |
//! | `latch` | a bolt that falls in below 3 mm and gives way above its strength |
//!
//! Numbers: a door of a house, round. `mechanisms/references/door_with_closer.py` integrates the laws between switches that it finds
//! by itself, and finds the angle above which the friction holds the door.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(DoorWithCloser::default());

mechanism! {
    /// Door with a closer.
    pub mechanism DoorWithCloser;
    param m: kg = 30;
    /// Angle at the start.
    param opened: rad = 70deg;
    const WIDTH: m = 0.9;
    coord phi: rad = 70deg;
    body leaf { mass: m, com: WIDTH/2*unit(phi), inertia: m*WIDTH^2/12, angle: phi }
    start phi = opened rate 0;
    let arm = 0.25m*unit(phi);
    let foot = [0.05m, -0.3m];
    out O: [m; 2] = [0, 0];
    out edge: [m; 2] = WIDTH*unit(phi);
    out post: [m; 2, 2] = [[WIDTH - 30mm, -40mm], [WIDTH + 60mm, -40mm]];
    out gas_end: [m; 2, 2] = [foot, arm];
    out angle: rad = phi;

    effect closer {
        param p0: Pa = 10bar;
        const AREA: m^2 = 6e-5;
        const LENGTH: m = 0.5;
        let drawn = norm(arm - foot) - norm([0.2m, 0.3m]);
        tsda gas { from: foot, to: arm, actuator: p0*AREA*(LENGTH/(LENGTH - drawn))^1.2 }
    }
    effect damper {
        param c: N*m*s = 12;
        torque damper: -c*min(der(phi), 0) - c/24*max(der(phi), 0) on phi;
    }
    effect hinge {
        param mus: 1 = 0.35;
        friction hinge { along: 20mm*phi, normal: 300N, coefficient: 0.25, sticks: mus }
        out holds: N = force(hinge);
    }
    effect wind {
        /// Pressure that shuts the door.
        param gust: Pa = 0;
        param since: s = 1;
        param lasts: s = 1.5;
        let x = (t - since)/lasts;
        torque wind: -gust*2m*WIDTH^2/2*16*max(x*(1 - x), 0)^2 on phi;
    }
    effect frame {
        contact frame { gap: WIDTH*phi, stiffness: 2e5, restitution: 0.3, approach: 0.3 }
        out knock: N = force(frame);
    }
    effect latch {
        param strength: N = 60;
        let pull = 3e5 [N/m]*max(WIDTH*phi - 3mm, 0);
        event caught: WIDTH*phi < 3mm until pull > strength;
        latch shut_since: s = t at caught;
        torque bolt: -caught*WIDTH*pull on phi;
        out is_caught: 1 = caught;
        out caught_at: s = shut_since;
    }

    title "Door with a closer";
    about "A gas spring shuts a door against its damper, up to frame and latch. Wide open the friction of the hinge holds it, \
           until a gust comes.";
    preset closes "from 70°: it shuts, and the latch catches" {}
    preset held "from 95°: friction holds it" { opened: 95deg }
    preset gust "from 95°: a gust of 30 Pa shuts it" { opened: 95deg, gust: 30 }
    preset torn "shut: suction of 100 Pa breaks the latch, and it shuts again" {
        opened: 0.1deg,
        gust: -100,
        lasts: 0.3
    }
    span 6s;
    draw ground O;
    draw link frame: post[0], post[1];
    draw link leaf: O, edge;
    draw joint O;
    draw spring closer: gas_end[0], gas_end[1];
    trace edge;
}

#[cfg(test)]
mod tests {
    use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};

    use super::*;
    use crate::reference::{dynamics_at, load};

    const REFERENCE: &str = include_str!("../references/door_with_closer.txt");

    /// Numbers of the reference's lines that begin with this word.
    fn of_reference(case: &str) -> Vec<Vec<f64>> {
        let lines = REFERENCE.lines().filter_map(|line| line.strip_prefix(case)?.strip_prefix(' '));
        lines.map(|line| line.split(' ').map(|number| number.parse().expect("a number")).collect()).collect()
    }

    #[test]
    fn all_presets_move_as_the_laws_integrated_between_switches() {
        for run in CARD.runs().expect("presets") {
            let expected = of_reference(&run.label);
            assert!(expected.len() >= 6, "{}", run.label);
            let times: Vec<f64> = core::iter::once(0.0).chain(expected.iter().map(|row| row[0])).collect();
            let found = dynamics_at(&CARD, &run, &times);
            let door = &found.motion.coordinates[0];
            let mut worst = [0.0_f64; 2];
            for (k, row) in expected.iter().enumerate() {
                let errors = [(door.q[k + 1] - row[1]).abs(), (door.qd[k + 1] - row[2]).abs()];
                worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
            }
            let last = |name| *load(&found.motion, name).last().expect("an end");
            println!("door, {}: angle {:.1e} rad, rate {:.1e} rad/s", run.label, worst[0], worst[1]);
            assert!(worst[0] < 1e-8 && worst[1] < 1e-7, "{}: {worst:?}", run.label);
            let caught = of_reference(&format!("caught {}", run.label));
            assert_eq!(last("is_caught"), if caught.is_empty() { 0.0 } else { 1.0 }, "{}", run.label);
            if let Some(at) = caught.last() {
                assert!(
                    (last("caught_at") - at[0]).abs() < 1e-8,
                    "{}: {} {at:?}",
                    run.label,
                    last("caught_at")
                );
            }
        }
    }

    #[test]
    fn friction_holds_the_door_above_an_angle() {
        let border = of_reference("border")[0][0];
        for (off, holds) in [(1e-9, true), (-1e-9, false)] {
            let door = DoorWithCloser { opened: border + off, ..DoorWithCloser::default() };
            let method = Explicit::new(DormandPrince8, Projection::default());
            let run = Simulation::start_from_text(door, method, 0.0_f64).expect("it starts");
            let mut run = run.with_tolerance(Tolerance::new(1e-10));
            run.advance_to(20.0).expect("it goes on");
            let moved = (run.q()[0] - border - off).abs();
            assert!(if holds { moved < 1e-15 } else { moved > 1.0 }, "{off}: {moved}");
        }
    }
}

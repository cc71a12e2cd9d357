//! The slider-crank of a four-stroke engine whose forces are effects: which of them does the piston's side load need?
//!
//! ```text
//!      ┌──┐
//!      │[]│ P    cylinder along y, its liner holds the piston
//!      │/ │
//!      /         φ: rod against the y axis (rad)
//!   A o
//!      \
//!       o O      θ: crank against the y axis (rad), 0 where the charge is lit
//! ```
//!
//! Lengths in metres, masses in kg, `q = [θ φ c p]`. The rows are the joints, so their multipliers are the forces in the pins.
//!
//! | effect | law |
//! |---|---|
//! | `gas` | pressure of the cylinder over the crank angle as a table of 20 harmonics of θ/2, one working cycle in two turns |
//! | `rod` | mass and moment of inertia of the rod |
//! | `gravity` | weight of all bodies |
//! | `liner_friction` | rings: μ \|N\| tanh(ẏ/v₀) + c ẏ with the piston's own side load N |
//! | `pin_friction` | pins: μ \|F\| tanh(ρ Δω/v₀) at the radius ρ with the pin's own force F |
//! | `motor` | starter with the torque–speed line τ₀ (1 − ω/ω₀) |
//! | `fan` | quadratic drag −c ω \|ω\| |
//! | `spring` | spring between head and piston |
//! | `clearance` | the piston's pin with play in the eye of the rod: contact k p (1 + d ṗ) of circle in circle, with friction of its own |
//!
//! The clearance releases the constraint of the piston's pin. Its multipliers are then 0, and so is the friction that `pin_friction` has
//! there. The distance of both centres is smooth below 1 nm, for its slope at 0 is no number.
//!
//! Numbers: a small petrol engine, round. The table is of a cycle with polytropic compression and heat by Wiebe's law.
//! `mechanisms/references/slider_crank_engine.py` makes it, and solves the motion by equations that were derived by hand.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// All joints without play; in the list of free mechanisms.
pub const CARD: Card = card!(SliderCrankEngineTight::default());

mechanism! {
    /// Slider-crank of a four-stroke engine.
    pub mechanism SliderCrankEngine;
    /// Radius of the crank.
    param r: m = 40mm in 10mm..100mm;
    /// Length of the rod, and distance of its centre of mass from the crank pin.
    param L: m = 140mm in 60mm..400mm;
    param d: m = 45mm;
    param piston_mass: kg = 0.45;
    /// Moment of inertia of crank and flywheel.
    param wheel: kg*m^2 = 0.15;
    /// Speed at the start.
    param speed: rad/s = 2400rpm;

    coord theta: rad = 0;
    coord phi: rad = 0;
    coord c: [m; 2] = [0, 85mm];
    coord p: [m; 2] = [0, 180mm];
    let pin = r*[-sin(theta), cos(theta)];
    let along = [-sin(phi), cos(phi)];
    body crank { mass: 5kg, com: [0, 0], inertia: wheel, angle: theta }
    body piston { mass: piston_mass, com: p }
    constraint crank_pin { c - d*along == pin; }
    constraint piston_pin { p == c + (L - d)*along; }
    constraint liner { p[0] == 0; }
    branch upright: cos(phi) > 0;
    start theta = 0 rate speed;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = pin;
    out P: [m; 2] = p;
    /// Force of the piston on the liner.
    out side_load: N = lambda(liner);
    /// Force in the crank pin.
    out pin_force: N = hypot(lambda(crank_pin.0), lambda(crank_pin.1));
    /// Speed of the crank.
    out crank_speed: rad/s = der(theta);

    /// Gas in the cylinder above that of the surroundings.
    effect gas {
        param bore: m = 80mm in 0..200mm;
        const MEAN: Pa = 366600;
        const COSINES: Pa = [
            650400, 458000, 279800, 173300, 110100, 55900, 3100, -30800, -43500, -42900,
            -43800, -45200, -44600, -36900, -28400, -21500, -19100, -16100, -12300, -7100
        ];
        const SINES: Pa = [
            208300, 290100, 274800, 221100, 191200, 172100, 146300, 106100, 70500, 47100,
            34900, 22400, 8800, -2700, -7200, -7200, -6900, -8700, -10300, -9400
        ];
        let pressure = MEAN + sum(k in 0..20: COSINES[k]*cos((k + 1)*theta/2) + SINES[k]*sin((k + 1)*theta/2));
        force gas: [0, -PI/4*bore^2*pressure] on p;
    }
    effect rod {
        param rod_mass: kg = 0.6;
        param rod_inertia: kg*m^2 = 2.2e-3;
        body rod { mass: rod_mass, com: c, inertia: rod_inertia, angle: phi }
    }
    effect gravity {
        param g: m/s^2 = 9.81;
        gravity weight { acceleration: [0, -g] }
    }
    effect liner_friction {
        param mu_liner: 1 = 0.08;
        param viscous: N*s/m = 4;
        friction rings {
            along: p[1],
            normal: lambda(liner),
            coefficient: mu_liner,
            speed: 0.1 [m/s],
            viscous: viscous
        }
    }
    effect pin_friction {
        /// With a film of oil.
        param mu_pins: 1 = 0.002;
        friction big_end {
            along: 22mm*(phi - theta),
            normal: hypot(lambda(crank_pin.0), lambda(crank_pin.1)),
            coefficient: mu_pins,
            speed: 0.1 [m/s]
        }
        friction small_end {
            along: 11mm*phi,
            normal: hypot(lambda(piston_pin.0), lambda(piston_pin.1)),
            coefficient: 2*mu_pins,
            speed: 0.1 [m/s]
        }
    }
    effect motor {
        param stall: N*m = 60;
        param idle: rad/s = 6000rpm;
        torque motor: stall*(1 - der(theta)/idle) on theta;
    }
    effect fan {
        param drag: N*m*s^2 = 2e-4;
        torque fan: -drag*der(theta)*abs(der(theta)) on theta;
    }
    effect spring {
        param stiffness: N/m = 3000;
        tsda spring { from: [0, 260mm], to: p, stiffness: stiffness, length: 120mm }
    }
    /// The pin of the piston has play in the eye of the rod, and touches it where the charge is lit.
    effect clearance {
        /// Radius of the eye less that of the pin.
        param play: m = 15um in 1um..100um;
        param eye_stiffness: N/m = 5e8;
        param eye_damping: s/m = 20;
        param mu_eye: 1 = 0.004;
        /// Of the bush in the eye; it gives a rod without mass the mass that a contact needs.
        param bush_mass: kg = 40gram;
        release piston_pin;
        body bush { mass: bush_mass, com: c + (L - d)*along }
        let off = p - c - (L - d)*along;
        contact eye { gap: play - hypot(off[0], off[1], 1e-9m), stiffness: eye_stiffness, damping: eye_damping }
        friction eye_rubs { along: 11mm*phi, normal: normal(eye), coefficient: mu_eye, speed: 0.1 [m/s] }
        start phi = 0 rate -r*speed/L;
        start p = [0, r + L - play] rate [0, 0];
        /// Force between pin and eye.
        out eye_force: N = normal(eye);
    }
    /// All joints without play.
    scene Tight = gas + rod + gravity + liner_friction + pin_friction + motor + fan + spring;

    title "Slider-crank engine";
    about "One working cycle of a small four-stroke engine, with forces as effects: `mbs effects slider_crank_engine` \
           tells which of them a result needs.";
    preset cycle "two turns from the dead centre at 2400/min" {}
    span 50ms;
    draw ground O;
    draw rail P along [0, 1];
    draw slider P along [0, 1];
    draw link crank: O, A;
    draw link rod: A, P;
    draw joint O, A, P;
    trace piston: P;
}

//! A planetary gear: the sun drives, the ring stands still, the carrier follows by Willis's formula.
//!
//! ```text
//!            .─────────────.
//!         .'    ring, θr     '.        all angles absolute (rad)
//!        /      .───.          \
//!       │      │  S  │╲θc       │      θs: sun S, θp: planet P, θc: carrier S P, θr: ring
//!       │       '───' ╲         │
//!        \          (  P )     /       radii of the pitch circles: rs, rp, rs + 2 rp (m)
//!         '.          '──'  .'
//!            '─────────────'
//! ```
//!
//! Rolling without slip, seen from the carrier: equal arcs on both pitch circles, opposite between sun and planet,
//! equal between planet and ring. `q = [θs θp θc θr]`. Willis: `(θs − θc)/(θr − θc) = −(rs + 2 rp)/rs`. The rows are
//! linear: one assembly, no singular position. Three planets at 120° move alike; they are drawn with 30, 15 and 60
//! teeth. The radii are as the teeth, and `(30 + 60)/3` is whole. The planet's number is odd, so tooth meets gap at
//! either end of the line `S P` where all angles are 0. One turn of the sun turns the carrier by 120°.
//!
//! Numbers: chosen here, module 4 mm.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Planetary gear with a fixed ring.
    pub mechanism PlanetaryGear;

    param rs: m = 60mm;
    param rp: m = 30mm;
    param omega: rad/s = TAU;

    coord theta_s: rad = 0;
    coord theta_p: rad = 0;
    coord theta_c: rad = 0;
    coord theta_r: rad = 0;

    let rr = rs + 2*rp;
    let p1 = (rs + rp)*unit(theta_c);
    let p2 = (rs + rp)*unit(theta_c + 120deg);
    let p3 = (rs + rp)*unit(theta_c - 120deg);

    constraint sun_planet { rs*(theta_s - theta_c) == -rp*(theta_p - theta_c); }
    constraint planet_ring { rp*(theta_p - theta_c) == rr*(theta_r - theta_c); }
    constraint fixed_ring { theta_r == 0; }
    drive sun: theta_s == omega*t;

    out S: [m; 2] = [0, 0];
    out P1: [m; 2] = p1;
    out P2: [m; 2] = p2;
    out P3: [m; 2] = p3;
    out sun_rim: [m; 2] = rs*unit(theta_s);
    out ring_rim: [m; 2] = rr*unit(theta_r);
    out M: [m; 2] = p1 + rp*unit(theta_p);
    out rim_2: [m; 2] = p2 + rp*unit(theta_p);
    out rim_3: [m; 2] = p3 + rp*unit(theta_p);

    title "Planetary gear";
    about "The sun drives three planets that roll in a fixed ring; their carrier turns three times more \
           slowly.";
    preset "one turn of the sun" "the carrier turns by 120°" {}
    span turn(omega);
    draw gear ring: S rim ring_rim teeth 60 inside;
    draw gear sun: S rim sun_rim teeth 30;
    draw gear planet: P1 rim M teeth 15;
    draw gear P2 rim rim_2 teeth 15;
    draw gear P3 rim rim_3 teeth 15;
    draw link carrier: S, P1;
    draw link S, P2;
    draw link S, P3;
    draw joint S, P1, P2, P3;
    trace "point of a planet": M;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(PlanetaryGear::default());

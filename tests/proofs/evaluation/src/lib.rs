//! {Φ, Φ_q, Φ_t, γ} of the lecture's four-bar as C functions: emitted, by hand, by differences.
//!
//! All have the shape `void f(const double q[5], const double qd[5], double t, double out[40])`; `out` holds Φ (5),
//! Φ_q (5 rows of 5), Φ_t (5), γ (5).
#![no_std]

mod by_hand;
mod differences;

use mbs_runtime::{Evaluation, Lanes, Mechanism, mechanism};

mechanism! {
    /// The lecture's four-bar with its numbers as constants, as CasADi gets them.
    pub mechanism FourBar;

    const L1: m = 0.20;
    const L2: m = 0.60;
    const L3: m = 0.50;
    const L4: m = 0.55;
    const L5: m = 0.35;
    const ALPHA: rad = 30deg;
    const OMEGA: rad/s = TAU;

    coord x2: m;
    coord y2: m;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
        y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == OMEGA*t;
}

mechanism! {
    /// The same with parameters that may change at run time.
    pub mechanism AdjustableFourBar;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;

    coord x2: m;
    coord y2: m;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
}

/// What a C caller gets: 40 numbers, or 40 groups of as many numbers as lanes.
#[repr(C)]
pub struct Output<T> {
    phi: [T; 5],
    phi_q: [[T; 5]; 5],
    phi_t: [T; 5],
    gamma: [T; 5],
}

impl<T> From<Evaluation<T, 5, 5>> for Output<T> {
    #[inline(always)]
    fn from(evaluation: Evaluation<T, 5, 5>) -> Self {
        let Evaluation { phi, phi_q, phi_t, gamma } = evaluation;
        Output { phi, phi_q, phi_t, gamma }
    }
}

/// Mechanisms a call of [`emitted_lanes`].
pub const LANES: usize = 8;

/// Numbers as constants.
#[unsafe(no_mangle)]
pub extern "C" fn emitted(q: &[f64; 5], qd: &[f64; 5], t: f64, out: &mut Output<f64>) {
    let four_bar = FourBar::default();
    *out = four_bar.evaluate(&four_bar.parameters(), q, t, qd).into();
}

/// Numbers as parameters; the parameters' stage is part of the call.
#[unsafe(no_mangle)]
pub extern "C" fn emitted_adjustable(
    design: &AdjustableFourBar<f64>,
    q: &[f64; 5],
    qd: &[f64; 5],
    t: f64,
    out: &mut Output<f64>,
) {
    *out = design.evaluate(&design.parameters(), q, t, qd).into();
}

/// The design of [`emitted_adjustable`].
#[unsafe(no_mangle)]
pub extern "C" fn adjustable_design(design: &mut AdjustableFourBar<f64>) {
    *design = AdjustableFourBar::default();
}

/// Eight mechanisms in one call, component after component eight numbers each.
#[unsafe(no_mangle)]
pub extern "C" fn emitted_lanes(
    q: &[Lanes<f64, LANES>; 5],
    qd: &[Lanes<f64, LANES>; 5],
    t: &Lanes<f64, LANES>,
    out: &mut Output<Lanes<f64, LANES>>,
) {
    let four_bar = FourBar::default();
    *out = four_bar.evaluate(&four_bar.parameters(), q, *t, qd).into();
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

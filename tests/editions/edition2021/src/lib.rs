//! A mechanism in edition 2021, in a crate that calls the runtime `mbs`.
#![no_std]
#![deny(warnings, missing_docs)]
#![forbid(unsafe_code)]

mbs::mechanism! {
    /// A rod; `gen` is no keyword yet.
    pub mechanism Rod;
    param gen: m = 0.5;
    param r#async: 1 = 1;
    input dyn: rad, rates;
    coord phi: rad = 0.1;
    coord p: [m; 2];
    constraint tip { p == gen*async*unit(phi); }
    drive crank: phi == t/1s + dyn;
    out speed: [m/s; 2] = der(p);
}

/// The tip at a time (s), in m.
pub fn tip(t: f64) -> Option<[f64; 2]> {
    let mut rod = Rod::<f64>::default();
    rod.gen = 2.0 * rod.r#async;
    let mut stepper = mbs::Stepper::assemble(rod, [0.1, 0.5, 0.0], 0.0).ok()?;
    stepper.advance_to(t).ok()?;
    Some(RodCoordinates::from(*stepper.q()).p)
}

#[test]
fn the_rod_turns() {
    assert_eq!(tip(0.0), Some([2.0, 0.0]));
}

//! A table to try things on.

use core::f64::consts::TAU;
use core::fmt::Write;

use mbs_runtime::Function;
use mbs_runtime::driver::{LawError, Polynomial4567, Segment, Segments};

/// Lift of the sample (m).
pub const LIFT: f64 = 0.008;

/// The law of [`valve_lift`] (m) over the cam's angle (rad): closed for half a turn, up and down by 8 mm with 4-5-6-7
/// polynomials. Numbers: chosen here.
///
/// # Errors
/// None; they are the law's.
pub fn law() -> Result<Segments<Polynomial4567, 4>, LawError> {
    let parts = [
        Segment::dwell(TAU * 0.25),
        Segment::to(LIFT, TAU * 0.5),
        Segment::to(0.0, TAU * 0.75),
        Segment::dwell(TAU),
    ];
    Segments::new(0.0, parts)
}

/// Valve lift (mm) over cam angle (deg), one line a degree, rounded to 1 µm as a gauge shows it.
///
/// # Errors
/// None; they are the law's.
pub fn valve_lift() -> Result<String, LawError> {
    let law = law()?;
    let mut text = String::from(
        "# Valve lift of a 4-5-6-7 cam, rounded to 1 um (`mbs table --sample`)\ncam angle (deg),lift (mm)\n",
    );
    for degree in 0..360 {
        let [lift]: [f64; 1] = law.jet(TAU * f64::from(degree) / 360.0);
        let _ = writeln!(text, "{degree},{:.3}", 1e3 * lift);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_the_samples_output() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/valve_lift.csv");
        let stored = std::fs::read_to_string(path).expect("the sample");
        assert_eq!(
            stored,
            valve_lift().expect("a law"),
            "write it anew: mbs table --sample > mbs-workbench/data/valve_lift.csv"
        );
    }
}

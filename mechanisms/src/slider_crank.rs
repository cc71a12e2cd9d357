//! The offset slider-crank.
//!
//! ```text
//!             A
//!             o·._      L          θ: crank against the x axis (rad)
//!         r  /    `·._             φ: rod against the x axis (rad), here negative
//!           /         `·._  φ
//!          / θ            [S]────  guide at height `offset`
//!         o───────────────·······  x axis
//!         O
//!         |←────── x ──────→|
//! ```
//!
//! Lengths in metres, angles in rad, `q = [θ φ x]`. The crank turns at constant `ω`. The crank passes through
//! because `L − r = 130 mm` exceeds the offset; then `cos φ` never vanishes, and its sign tells the assembly: the
//! slider stays to the right of the crank pin.
//!
//! Numbers: the reference problem in `tests/data/slider_crank.csv` (`theta = 30 t`).

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::facade::AnyEquations;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState, parameter};

mechanism! {
    /// Slider-crank whose guide passes beside the crank's centre.
    pub mechanism SliderCrank;

    param r: m = 50mm;
    param L: m = 180mm;
    param offset: m = 10mm;
    param omega: rad/s = 30;

    coord theta: rad = 0;
    coord phi: rad = 0;
    coord x: m = 230mm;

    constraint closure {
        r*cos(theta) + L*cos(phi) == x;
        r*sin(theta) + L*sin(phi) == offset;
    }
    drive crank: theta == omega*t;
    branch right: cos(phi) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out S: [m; 2] = [x, offset];
    out M: [m; 2] = r*unit(theta) + L/2*unit(phi);

    title "Offset slider-crank";
    about "A crank at constant speed moves a slider whose guide passes beside the crank's centre.";
    preset "one turn" "the slider to the right of the crank" {}
    span turn(omega);
    draw ground O;
    draw rail S along [1, 0];
    draw slider S along [1, 0];
    draw link crank: O, A;
    draw link rod: A, S;
    draw joint O, A, S;
    trace slider: S;
    trace "middle of the rod": M;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(SliderCrank::default()).known_by(&KNOWN);

/// Positions and velocities in closed form.
const KNOWN: KnownMotion = KnownMotion {
    source: "closed form of the textbook",
    error: 1e-13,
    course: KnownCourse::Form(closed_form),
};

fn closed_form(slider_crank: &dyn AnyEquations, t: f64) -> Option<KnownState> {
    let [r, l, offset, omega] = ["r", "L", "offset", "omega"].map(|name| parameter(slider_crank, name));
    let (sin, cos) = (omega * t).sin_cos();
    let slope = (offset - r * sin) / l;
    let reach = (1.0 - slope * slope).sqrt();
    if reach.is_nan() {
        return None;
    }
    let rate = -r * omega * cos / (l * reach);
    let q = vec![omega * t, slope.asin(), r * cos + l * reach];
    Some(KnownState { t, q, qd: vec![omega, rate, -r * omega * sin - l * slope * rate] })
}

//! One slider-crank, three machines: the crank driven, the slider driven, or a cylinder in place of the rod.
//!
//! ```text
//!             A
//!             o·._     rod     θ: crank against the x axis (rad)
//!         r  /    `·._         φ: rod against the x axis (rad), here negative
//!           /         `·._
//!          / θ            [S]────  guide at height `offset`
//!         o───────────────·······  x axis
//!         O
//!         |←────── x ──────→|
//! ```
//!
//! Lengths in metres, angles in rad, `q = [θ φ x]`, with a cylinder `q = [θ φ x rod]`.
//!
//! - `DrivenCrank`: the crank turns at constant `ω`, as in a pump.
//! - `DrivenSlider`: the slider swings about 180 mm between the dead centres, as in an engine; the crank rocks above
//!   the line from its centre to the slider.
//! - `TelescopingRod`: the slider is locked at 180 mm, and the rod is a cylinder that swings about its length `L`, as
//!   in a tipper; the crank rocks.
//!
//! The crank pin and the slider are at home in all of them, so is the closure; the rod is a length in two scenes and
//! a coordinate in the third. Numbers: those of `slider_crank`; strokes that keep 20 mm from the dead centres.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Slider-crank whose drive is chosen by the scene.
    pub mechanism CrankSlider;

    param r: m = 50mm;
    param L: m = 180mm;
    param offset: m = 10mm;

    coord theta: rad = 1.4;
    coord phi: rad = -0.2;
    coord x: m = 180mm;

    constraint closure { r*unit(theta) + rod*unit(phi) == [x, offset]; }
    branch right: cos(phi) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out S: [m; 2] = [x, offset];

    /// A rod of constant length.
    effect rigid_rod {
        let rod = L;
        draw ground O;
        draw rail S along [1, 0];
        draw slider S along [1, 0];
        draw link crank: O, A;
        draw link rod: A, S;
        draw joint O, A, S;
        trace "crank pin": A;
        trace slider: S;
    }
    effect crank_driven {
        param omega: rad/s = 30;
        drive crank: theta == omega*t;
    }
    effect slider_driven {
        param stroke: m = 30mm;
        param pace: rad/s = TAU;
        drive ram: x == 180mm + stroke*sin(pace*t);
        branch above: sin(theta - phi) > 0;
    }
    /// A cylinder between crank pin and slider.
    effect telescoping_rod {
        param reach: m = 30mm;
        param pace: rad/s = TAU;
        coord rod: m = 180mm;
        drive lock: x == 180mm;
        drive cylinder: rod == L + reach*sin(pace*t);
        branch above: sin(theta - phi) > 0;
        out tube_end: [m; 2] = r*unit(theta) + 0.6*L*unit(phi);
        out piston: [m; 2] = [x, offset] - 0.6*L*unit(phi);
        draw ground O;
        draw rail S along [1, 0];
        draw slider S along [1, 0];
        draw link crank: O, A;
        draw slot cylinder: A, tube_end;
        draw link "piston rod": piston, S;
        draw slider piston along phi;
        draw joint O, A, S;
        trace "crank pin": A;
    }

    /// The crank turns at constant speed.
    scene DrivenCrank = rigid_rod + crank_driven {
        title "Slider-crank in scenes: the crank driven";
        about "The crank turns at constant speed; the first of three scenes of one text.";
        preset "one turn" "the slider to the right of the crank" {}
        span turn(omega);
    }
    /// The slider swings and rocks the crank.
    scene DrivenSlider = rigid_rod + slider_driven {
        title "Slider-crank in scenes: the slider driven";
        about "The slider swings between the dead centres and rocks the crank; the second of three scenes of \
               one text.";
        preset "one swing" "the crank pin above the guide" {}
        span turn(pace);
    }
    /// A cylinder rocks the crank while the slider is locked.
    scene TelescopingRod = telescoping_rod {
        title "Slider-crank in scenes: a cylinder as rod";
        about "The slider is locked and a cylinder in place of the rod rocks the crank; the last of three \
               scenes of one text.";
        preset "one swing" "the crank pin above the guide" {}
        span turn(pace);
    }
}

/// Entry in the list of mechanisms: the crank driven.
pub const DRIVEN_CRANK: Card = card!(CrankSliderDrivenCrank::default());

/// Entry in the list of mechanisms: the slider driven.
pub const DRIVEN_SLIDER: Card = card!(CrankSliderDrivenSlider::default());

/// Entry in the list of mechanisms: a cylinder in place of the rod.
pub const TELESCOPING_ROD: Card = card!(CrankSliderTelescopingRod::default());

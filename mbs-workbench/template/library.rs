//! A linkage to begin from: change the text, and `cargo run` shows it.
#![no_std]

mbs_runtime::mechanism! {
    /// A crank moves a rocker by a coupler.
    pub mechanism __TYPE__;

    // Dimensions: fields of the type, with their defaults. A range is what `--slide crank` moves through.
    param crank: m = 100mm in 50mm..140mm, tolerance 0.1mm;
    param coupler: m = 250mm;
    param rocker: m = 200mm;
    param base: m = 300mm;

    // Unknowns, with the guesses that the assembly starts from.
    coord phi1: rad = 0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    let A = crank*unit(phi1);
    let B = A + coupler*unit(phi2);
    let C = [base, 0];

    // Both ways to B end in one point: two equations. The rocker is on the upper side.
    constraint closure { B == C + rocker*unit(phi3); }
    branch open: sin(phi3 - phi2) > 0;

    // Quantities to read, with their rates and accelerations.
    out O: [m; 2] = [0, 0];
    out P: [m; 2] = A + coupler/2*unit(phi2) + 100mm*unit(phi2 + 90deg);
    out swing: rad = phi3;

    // The third equation: a motor of constant speed, or a measured angle.
    effect turning {
        param speed: rad/s = 60rpm;
        drive motor: phi1 == speed*t;
        preset design "60 turns a minute" {}
        preset slow "20 turns a minute" { speed: 20rpm }
        span turn(speed);
    }
    effect measured {
        input angle: rad, rates;
        drive encoder: phi1 == angle;
    }
    /// A motor turns the crank.
    scene Turning = turning;
    /// An encoder measures the angle of the crank.
    scene Measured = measured;

    title "__TITLE__";
    draw ground O, C;
    draw link crank: O, A;
    draw plate coupler: A, B, P;
    draw link rocker: C, B;
    draw joint O, A, B, C;
    trace P;
}

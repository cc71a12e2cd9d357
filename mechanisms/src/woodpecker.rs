//! The woodpecker toy: three contacts with friction, a limit cycle of impacts, sticking and sliding.
//!
//! ```text
//!       │ │  ⟍
//!       │ │___\       bird on a spring at the sleeve, its beak strikes the pole
//!      ┌┤ ├┐≀≀≀( )
//!      └┤ ├┘          sleeve with play on the pole: it jams while it is tilted
//!       │ │
//! ```
//!
//! Lengths in metres, masses in kg, `q = [y a b]`: height of the sleeve, its angle, that of the bird. Angles are small.
//!
//! | effect | law |
//! |---|---|
//! | `weight` | gravity |
//! | `spring` | torque between sleeve and bird |
//! | `beak` | rigid contact of the beak, e = 0.5 |
//! | `sleeve` | rigid contacts of the sleeve's lower and upper edge, e = 0 |
//! | `scraping` | friction of the beak, sticks and slides |
//! | `jamming` | friction of both edges: without it the toy falls |
//!
//! Source of model and data: Glocker & Studer 2005, after Glocker 1995 and Pfeiffer 1984.
//! `mechanisms/references/woodpecker.c` integrates it by Moreau's time-stepping.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Woodpecker::default());

mechanism! {
    /// A sleeve with play on a pole, and a bird on a spring at the sleeve, whose beak strikes the pole.
    pub mechanism Woodpecker;
    /// Masses and moments of inertia of sleeve and bird.
    param m: [kg; 2] = [0.3gram, 4.5gram];
    param J: [kg*m^2; 2] = [5e-9, 7e-7];
    coord y: m = 0;
    coord a: rad = -0.1034;
    coord b: rad = -0.2788;
    /// Radius of the pole.
    const POLE: m = 2.5mm;
    let hinge = [10mm, y + 10mm*a];
    let bird = hinge + [15mm, 15mm*b];
    let across = [cos(a), sin(a)];
    let along = [-sin(a), cos(a)];
    let forwards = [cos(b), sin(b)];
    let upwards = [-sin(b), cos(b)];
    body sleeve { mass: m[0], com: [0, y], inertia: J[0], angle: a }
    body bird { mass: m[1], com: [0, y + 10mm*a + 15mm*b], inertia: J[1], angle: b }
    start y = 0 rate -0.3411;
    start b = -0.2788 rate -7.4583;
    out pole_end: [m; 4, 2] = [[-POLE, -120mm], [POLE, -120mm], [POLE, 40mm], [-POLE, 40mm]];
    out edge: [m; 4, 2] = [
        [0, y] - 3.1mm*across - 5.8mm*along,
        [0, y] + 3.1mm*across - 5.8mm*along,
        [0, y] + 3.1mm*across + 5.8mm*along,
        [0, y] - 3.1mm*across + 5.8mm*along
    ];
    out held: [m; 2] = hinge;
    out tail: [m; 2] = bird + 5mm*forwards - 18mm*upwards;
    out crown: [m; 2] = bird - 2mm*forwards + 24mm*upwards;
    out tip: [m; 2] = bird - 20.1mm*forwards + 20mm*upwards;
    out height: m = y;

    effect weight {
        gravity weight { acceleration: [0, -9.81] }
    }
    effect spring {
        param k: N*m = 5.6e-3;
        rsda spring { angle: b - a, stiffness: k }
    }
    effect beak {
        contact beak { gap: 2.4mm - 20mm*b, restitution: 0.5 }
        out distance: m = gap(beak);
        out blow: N*s = impulse(beak);
    }
    effect sleeve {
        contact low { gap: 0.6mm + 5.8mm*a, restitution: 0 }
        contact high { gap: 0.6mm - 5.8mm*a, restitution: 0 }
    }
    effect scraping {
        friction scrapes { along: y + 10mm*a - 5.1mm*b, normal: normal(beak), coefficient: 0.3, sticks: 0.3 }
    }
    effect jamming {
        friction holds_low { along: y + 3.1mm*a, normal: normal(low), coefficient: 0.3, sticks: 0.3 }
        friction holds_high { along: y + 3.1mm*a, normal: normal(high), coefficient: 0.3, sticks: 0.3 }
        out grip: [N; 2] = [force(holds_low), force(holds_high)];
    }

    title "Woodpecker toy";
    about "A bird on a spring pecks its way down a pole: impacts with friction, and a sleeve that jams and slides.";
    preset pecks "five strikes of the beak" {}
    span 750ms;
    draw plate pole: pole_end[0], pole_end[1], pole_end[2], pole_end[3];
    draw plate sleeve: edge[0], edge[1], edge[2], edge[3];
    draw plate bird: held, tail, crown, tip;
    draw joint held;
}

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

#[cfg(test)]
mod tests {
    use mbs_runtime::dynamics::{
        Direction, DormandPrince8, Explicit, MoreauJean, Projection, Simulation, Tolerance,
    };

    use super::*;

    /// Time, y and a of the strikes of the beak, by `mechanisms/references/woodpecker.c` with steps of 1e-8 s: `cc -O2 woodpecker.c -lm -o w && ./w 1e-8 1.2`.
    const STRIKES: [[f64; 3]; 8] = [
        [0.080_989_30, -0.007_325_910, 0.089_219_199],
        [0.226_842_26, -0.026_634_691, 0.089_566_787],
        [0.372_922_65, -0.046_195_626, 0.089_272_928],
        [0.518_811_85, -0.065_544_659, 0.089_518_040],
        [0.664_861_32, -0.085_071_364, 0.089_311_144],
        [0.810_776_13, -0.104_448_804, 0.089_483_973],
        [0.956_803_91, -0.123_951_469, 0.089_338_313],
        [1.102_736_80, -0.143_348_952, 0.089_460_207],
    ];

    /// Period (s) and fall (m) of the limit cycle by the same program with steps of 1e-7 s: the mean of cycles 35 to 46.
    const PERIOD: f64 = 0.145_976_4;
    const DROP: f64 = 0.019_445_6;

    fn started() -> Simulation<Woodpecker<f64>, Explicit<DormandPrince8, Projection>, f64, 3, 0> {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(Woodpecker::default(), method, 0.0_f64).expect("it starts");
        run.with_tolerance(Tolerance::new(1e-10))
    }

    #[test]
    fn a_woodpecker_descends_as_by_time_stepping() {
        let (mut run, after) = (started(), 1e-5);
        for [t, y, a] in STRIKES {
            // The bird turns with about 17 rad/s before a strike, and back with half of it.
            run.advance_to(t - after).expect("it goes on");
            assert!(run.qd()[2] > 16.0, "{t}: {:?}", run.instant());
            run.advance_to(t + after).expect("it strikes");
            assert!(run.qd()[2] < -8.0, "{t}: {:?}", run.instant());
            let off = [run.q()[0] - run.qd()[0] * after - y, run.q()[1] - run.qd()[1] * after - a];
            // Of the reference, whose times are 3e-7 s off; the sleeve turns with 23 rad/s.
            assert!(off[0].abs() < 3e-7 && off[1].abs() < 1e-5, "{t}: {off:?}");
        }
        assert!(run.balance().defect.abs() < 1e-10, "{:?}", run.balance());
    }

    /// Steps over impacts and jams, by the library's own time-stepping: the reference is that of another program.
    #[test]
    fn steps_over_strikes_converge_to_the_reference() {
        for h in [5e-5, 1.25e-5] {
            let run = Simulation::start_from_text(Woodpecker::default(), MoreauJean, 0.0_f64);
            let (mut run, mut last) = (run.expect("it starts"), f64::MAX);
            for [t, y, _] in STRIKES.into_iter().take(2) {
                let before = run.t();
                run.step_to(t, ((t - before) / h).round() as u32).expect("it goes on");
                assert!((run.q()[0] - y).abs() < 12.0 * h, "{h} {t}: {:?} {y}", run.q());
                let energy = run.balance().energy;
                assert!(energy.kinetic + energy.potential < last, "{h} {t}: {:?}", run.balance());
                last = energy.kinetic + energy.potential;
            }
        }
    }

    #[test]
    fn a_woodpecker_settles_to_its_limit_cycle() {
        let (mut run, mut before, mut cycle) = (started(), [0.0; 4], [0.0; 4]);
        for _ in 0..60 {
            assert!(run.advance_until_event(20.0, Direction::Rising, |_, q, _| q[2]).expect("it goes on"));
            let [y, a, _] = *run.q();
            let now = [run.t(), y, a, run.qd()[2]];
            cycle = core::array::from_fn(|index| now[index] - before[index]);
            before = now;
        }
        let [period, drop, turned, faster] = cycle;
        assert!(turned.abs() < 1e-6 && faster.abs() < 1e-4, "{cycle:?}");
        assert!((period - PERIOD).abs() < 1e-6 && (drop + DROP).abs() < 1e-6, "{cycle:?}");
    }
}

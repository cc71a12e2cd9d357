//! A text with every effect: at zero coefficients it moves as the scene that has none of them.
#![forbid(unsafe_code)]

use mbs_runtime::driver::{Harmonic, Polynomial};
use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation};
use mbs_runtime::{Dynamic, mechanism};

include!("every_effect/text.rs");

macro_rules! written {
    ([$($common:tt)*] $first:ident { $($text_of_first:tt)* } $($name:ident { $($text:tt)* })*) => {
        mechanism! {
            /// Every effect, all in one scene, and none.
            pub mechanism Library;
            $($common)*
            effect $first { $($text_of_first)* }
            $(effect $name { $($text)* })*
            effect nothing {}
            scene Whole = $first $(+ $name)*;
            scene Bare = nothing;
        }
    };
}
every_effect!(written);

type Load = Polynomial<2>;
type All = LibraryWhole<Harmonic, Load>;
/// Sets the coefficients of one effect.
type Set = fn(All) -> All;

const PITCH: Harmonic = Harmonic { offset: 0.18, amplitude: 0.005, frequency: 1.0, phase: 0.3 };
const LOAD: Load = Polynomial { coefficients: [20.0, 5.0] };

/// Coordinates and rates after each of 150 steps of 0.1 ms.
fn motion<S: Dynamic<f64, 5, 0>>(mechanism: S) -> Vec<[f64; 10]> {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let start = ([0.1, 0.29, 0.1, 0.0, 0.0], [0.3, -0.9, 1.0, 2.0, -1.0]);
    let mut run = Simulation::start(mechanism, method, 0.0, start.0, start.1).expect("a start");
    let mut all = Vec::new();
    for _ in 0..150 {
        run.step(1e-4).expect("it moves");
        let values = run.q().iter().chain(run.qd());
        let mut state = [0.0; 10];
        state.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
        all.push(state);
    }
    all
}

fn apart(one: &[[f64; 10]], other: &[[f64; 10]]) -> f64 {
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

#[test]
fn effects_at_zero_coefficients_move_nothing() {
    let bare: LibraryBare<Harmonic, Load> = Library::new(PITCH, LOAD);
    let whole: All = Library::new(PITCH, LOAD);
    let zero: All = Library {
        tau: 0.0,
        k: 0.0,
        c: 0.0,
        G: 0.0,
        loss: 0.0,
        cw: 0.0,
        filling: 0.0,
        km: 0.0,
        stall: 0.0,
        most: 0.0,
        stiff: 0.0,
        soft: 0.0,
        loss_along: 0.0,
        teeth_stiffness: 0.0,
        mu: 0.0,
        oil: 0.0,
        mu_sliding: 0.0,
        mu_sticking: 0.0,
        rough_normal: 0.0,
        stop_stiffness: 0.0,
        carcass: 0.0,
        Omega: 0.0,
        lift: 0.0,
        shell: 0.0,
        pad: 0.0,
        share: 0.0,
        swell: 0.0,
        ..whole
    };
    let none = motion(bare);
    let found = apart(&motion(zero), &none);
    println!("largest change by effects at zero coefficients: {found:.1e}");
    assert!(found < 1e-12, "{found}");
    // Errors do not grow: nothing but the weight acts. And each law that is smooth at this step moves something by itself.
    let laws: [(&str, Set); 14] = [
        ("constant", |zero| Library { tau: 2.0, ..zero }),
        ("spring", |zero| Library { k: 400.0, ..zero }),
        ("bar", |zero| Library { G: 80e9, ..zero }),
        ("drag", |zero| Library { cw: 0.8, ..zero }),
        ("gas", |zero| Library { filling: 150.0, ..zero }),
        ("motor", |zero| Library { km: 0.05, ..zero }),
        ("limited", |zero| Library { stall: 5.0, most: 2.0, ..zero }),
        ("bushing", |zero| Library { stiff: 4000.0, ..zero }),
        ("smooth", |zero| Library { oil: 1.0, ..zero }),
        ("sticking", |zero| Library { mu_sliding: 0.2, mu_sticking: 0.3, ..zero }),
        ("turntable", |zero| Library { Omega: 3.0, ..zero }),
        ("switched", |zero| Library { lift: 40.0, ..zero }),
        ("table", |zero| Library { share: 0.5, ..zero }),
        ("wave", |zero| Library { swell: 3.0, ..zero }),
    ];
    for (name, law) in laws {
        let moved = apart(&motion(law(zero)), &none);
        assert!(moved > 1e-6, "{name}: {moved}");
    }
}

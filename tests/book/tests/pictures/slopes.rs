//! Slopes of forces that the laws have in emitted code, against differences of the forces along motions of the texts.

use mbs_runtime::Dynamic;

use crate::texts::{
    Armature, Braking, Coasting, Discs, Door, Dragged, Drawn, Gears, HalfCar, Kerb, Latched, Limited, Line,
    Loose, Mounted, Piston, Puck, Rolling, Smooth, Stopped, Stribeck, Touches, Wheel,
};

/// Step of the differences, far below every length and speed of the laws.
const STEP: f64 = 1e-6;

/// Instants of each motion.
const INSTANTS: u32 = 7;

/// Derivative along each axis, of fourth order: row by row.
fn differences<const N: usize>(x: &[f64; N], f: impl Fn(&[f64; N]) -> [f64; N]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for j in 0..N {
        let at = |steps: f64| f(&core::array::from_fn(|i| if i == j { x[i] + steps * STEP } else { x[i] }));
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
        for (i, row) in matrix.iter_mut().enumerate() {
            row[j] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * STEP);
        }
    }
    matrix
}

/// Largest error of ∂Q/∂q and ∂Q/∂q̇ over the largest entry of each, or of Q, by whose rounding differences are off, or 1.
fn error<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    text: &S,
    (t, q, qd): (f64, &[f64; N], &[f64; N]),
    (z, lambda): (&S::States, &[f64; M]),
) -> f64 {
    let p = text.parameters();
    let here = text.position(&p, q, t);
    let along_q = differences(q, |q| text.force(&p, &text.position(&p, q, t), qd, z, lambda));
    let along_qd = differences(qd, |qd| text.force(&p, &here, qd, z, lambda));
    let pairs = [
        (text.force_q(&p, &here, qd, z, lambda), along_q),
        (text.force_qd(&p, &here, qd, z, lambda), along_qd),
    ];
    let force = text.force(&p, &here, qd, z, lambda);
    let errors = pairs.map(|(found, wanted)| {
        let size = wanted.iter().flatten().chain(&force).fold(1.0, |size: f64, entry| size.max(entry.abs()));
        let apart = found.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max) / size
    });
    errors[0].max(errors[1])
}

macro_rules! largest {
    ($($text:ident $until:literal)*) => {
        [$({
            let errors = traced!($text::<f64>::default(), $until, INSTANTS, |run| {
                error(run.mechanism(), (run.t(), run.q(), run.qd()), (run.states(), run.lambda()))
            });
            // A motion may start in a kink.
            (stringify!($text), errors[1..].iter().copied().fold(0.0, f64::max))
        }),*]
    };
}

#[test]
fn slopes_of_the_laws_are_those_of_differences() {
    let errors = largest!(
        Smooth 0.004 Stribeck 0.004 Drawn 1.0 Touches 0.006 Latched 0.006 Loose 0.03
        Stopped 0.3 Piston 0.1 Discs 0.3 Mounted 0.3 Gears 0.0125 Door 3.0
        Dragged 1.0 Line 1.0 Limited 3.0 Armature 0.1 Puck 1.0
        Rolling 0.1 Wheel 0.5 Braking 0.5 Coasting 5.0 HalfCar 1.0 Kerb 0.9
    );
    for (text, error) in errors {
        println!("{text}: {error:.1e}");
        assert!(error < 1e-7, "{text}: {error:e}");
    }
    println!("largest of {}: {:.1e}", errors.len(), errors.iter().fold(0.0, |a: f64, b| a.max(b.1)));
}

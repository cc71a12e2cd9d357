use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::driver::foot::{FootError, nearest_foot};
use crate::driver::reach::{ReachError, reach};
use crate::driver::{ClosedCurve, Harmonic, Parametric, Polar, SMOOTH, centred};
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;
use crate::scalar::sequence::Sequence;

const fn wave(amplitude: f64, phase: f64) -> Harmonic {
    Harmonic { offset: 0.0, amplitude, frequency: 1.0, phase }
}

/// [30 cos s, 20 sin s] mm.
const ELLIPSE: [Harmonic; 2] = [wave(0.03, -FRAC_PI_2), wave(0.02, 0.0)];

fn rim([x, y]: &[Harmonic; 2]) -> Parametric<'_, Harmonic, Harmonic> {
    Parametric { x, y }
}

/// R = a + b cos 2w, or its components with the parameter w.
#[derive(Clone, Copy)]
struct Waist {
    depth: f64,
    /// `None` for R, a quarter of a turn later for y.
    phase: Option<f64>,
}

impl<T: Scalar> Function<T> for Waist {
    const ORDER: usize = SMOOTH;

    fn jet<const K: usize>(&self, w: T) -> [T; K] {
        let radius: [T; K] =
            Harmonic { offset: 0.03, amplitude: self.depth, frequency: 2.0, phase: -FRAC_PI_2 }.jet(w);
        let Some(phase) = self.phase else { return radius };
        let cosine: [T; K] = wave(1.0, phase - FRAC_PI_2).jet(w);
        // Leibniz.
        let binomial = |n: usize, k: usize| (0..k).fold(1.0, |b, j| b * (n - j) as f64 / (j + 1) as f64);
        core::array::from_fn(|n| {
            let term = |k: usize| T::constant(binomial(n, k)) * radius[k] * cosine[n - k];
            (1..=n).fold(term(0), |sum, k| sum + term(k))
        })
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        Some(centred(|w| self.jet(w), from, to))
    }
}

fn waist(depth: f64) -> [Waist; 3] {
    [None, Some(0.0), Some(FRAC_PI_2)].map(|phase| Waist { depth, phase })
}

#[test]
fn an_ellipse_has_the_reach_of_its_sharpest_place() {
    let [inside, outside]: [f64; 2] = rim(&ELLIPSE).reach().expect("bounds");
    let sharpest = 0.02 * 0.02 / 0.03;
    assert!(inside <= sharpest && inside > 0.995 * sharpest && outside.is_infinite(), "{inside} {outside}");
    let flattest: f64 = rim(&ELLIPSE).flattest().expect("convex");
    assert!((0.045..0.0452).contains(&flattest), "{flattest}");
    let [single, _]: [f32; 2] = rim(&ELLIPSE).reach().expect("bounds");
    // Rounding of places next to each other takes a part of it.
    assert!((0.875..=1.000_001).contains(&(f64::from(single) / inside)), "{single} {inside}");
}

#[test]
fn a_curve_by_components_is_the_curve_by_its_polar_radius() {
    let mut random = Sequence::new(7);
    for depth in [0.004, 0.012] {
        let [radius, x, y] = waist(depth);
        let both = Parametric { x: &x, y: &y };
        let (polar, found): ([f64; 2], [f64; 2]) =
            (reach(&radius).expect("bounds"), both.reach().expect("bounds"));
        for (one, other) in polar.into_iter().zip(found) {
            assert!(one == other || (one - other).abs() < 4e-3 * one, "{polar:?} {found:?}");
        }
        for _ in 0..50 {
            let at = [(); 2].map(|()| 0.06 * random.number());
            match (nearest_foot(&radius, at), both.nearest_foot(at)) {
                (Ok(one), Ok(other)) => {
                    assert!((one.distance - other.distance).abs() < 1e-15, "{at:?} {one:?} {other:?}");
                    assert!((one.angle - other.angle).abs() < 1e-7, "{at:?} {one:?} {other:?}");
                }
                (one, other) => panic!("{at:?} {one:?} {other:?}"),
            }
        }
        // The middle is as far from both flanks.
        let ambiguous = both.nearest_foot([0.0; 2]);
        assert!(matches!(ambiguous, Err(FootError::Ambiguous([a, b])) if ((a - b).abs() - PI).abs() < 1e-6));
    }
}

#[test]
fn ways_that_run_backwards_or_cross_themselves_are_refused() {
    let clockwise = [wave(0.03, -FRAC_PI_2), wave(-0.02, 0.0)];
    assert_eq!(ClosedCurve::<f64>::reach(&rim(&clockwise)), Err(ReachError::Clockwise));
    assert_eq!(ClosedCurve::<f64>::flattest(&rim(&clockwise)), Err(ReachError::Hollow(0.0)));
    // A limaçon turns twice and is hollow nowhere: R = 10 + 30 cos w passes its centre.
    let [x, y] = [0.0, FRAC_PI_2].map(|phase| Loops { phase });
    let both = Parametric { x: &x, y: &y };
    let found = ClosedCurve::<f64>::flattest(&both);
    assert!(matches!(found, Err(ReachError::Undecided(_))), "{found:?}");
    let found: Result<[f64; 2], _> = both.reach();
    assert!(matches!(found, Err(ReachError::Undecided(_))), "{found:?}");
}

/// (10 + 30 cos w) cos(w − phase) mm = 10 cos(w − phase) + 15 cos(2w − phase) + 15 cos(phase).
struct Loops {
    phase: f64,
}

impl<T: Scalar> Function<T> for Loops {
    const ORDER: usize = SMOOTH;

    fn jet<const K: usize>(&self, w: T) -> [T; K] {
        let one: [T; K] = wave(0.01, self.phase - FRAC_PI_2).jet(w);
        let other: [T; K] = Harmonic {
            offset: 0.015 * self.phase.cos(),
            amplitude: 0.015,
            frequency: 2.0,
            phase: self.phase - FRAC_PI_2,
        }
        .jet(w);
        core::array::from_fn(|k| one[k] + other[k])
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        Some(self.jet(Interval::between(from, to)))
    }
}

#[test]
fn what_a_hollow_leaves_to_a_pad_is_its_reach() {
    let [radius, ..] = waist(0.012);
    let cam = Polar(&radius);
    // The hollow at 90° has the radius R²/(R″ − R) = 18²/30 mm; the waist half of 36 mm, the ends 42²/90 mm.
    let (hollow, end) = (0.018 * 0.018 / 0.03, 0.042 * 0.042 / 0.09);
    let pad = |radius: f64| Harmonic { offset: radius, amplitude: 0.0, frequency: 1.0, phase: 0.0 };
    let small = pad(0.005);
    let pairs: [Result<[f64; 2], ReachError>; 2] =
        [cam.pair_reach(&Polar(&small)), Polar(&small).pair_reach(&cam)];
    for found in pairs {
        let [deep, far] = found.expect("a pair");
        let (least, most): (f64, f64) = (0.995, 1.0);
        assert!(deep <= most * (end.min(0.018) + 0.005) && deep > least * (end.min(0.018) + 0.005), "{deep}");
        assert!(far <= hollow - 0.005 && far > hollow - 0.005 - 1.5e-4, "{far}");
    }
    let pair = |radius: f64| -> Result<[f64; 2], ReachError> { cam.pair_reach(&Polar(&pad(radius))) };
    assert_eq!(pair(0.012), Err(ReachError::Narrow));
    let both: Result<[f64; 2], _> = cam.pair_reach(&cam);
    assert!(matches!(both, Err(ReachError::Hollow(_))), "{both:?}");
    let [deep, far]: [f64; 2] = rim(&ELLIPSE).pair_reach(&Polar(&small)).expect("convex curves");
    assert!(far.is_infinite() && (deep - 0.04 / 3.0 - 0.005).abs() < 1e-4, "{deep} {far}");
    let flat: Result<f64, _> = cam.flattest();
    assert!(
        matches!(flat, Err(ReachError::Hollow(w)) if (w % PI - FRAC_PI_2).abs() < 0.7 && w < TAU),
        "{flat:?}"
    );
}

use core::array::from_fn;
use core::f64::consts::{PI, TAU};

use crate::driver::foot::{FootError, nearest_foot};
use crate::driver::reach::{ReachError, reach};
use crate::driver::{
    Bounded, CubicRow, CubicSpline, Cycloid, End, Harmonic, Law, PeriodicQuintic, Polynomial, Polynomial345,
    Polynomial4567, QuinticRow, Rise, SMOOTH, Segment, Segments, Table, Trapezoidal, fit_cubic,
    fit_periodic_quintic,
};
use crate::mechanism::function::Function;
use crate::scalar::sequence::Sequence;

/// The next number between 0 and 1.
fn share(random: &mut Sequence) -> f64 {
    0.5 + 0.5 * random.number()
}

/// R = 30 mm + h s(w): a bump of a width between two of 360 angles, or anywhere.
#[derive(Clone, Copy)]
struct Bump {
    height: f64,
    at: f64,
    width: f64,
}

impl Bump {
    fn law(self) -> Segments<Polynomial4567, 3> {
        let parts = [
            Segment::to(0.03 + self.height, self.at + 0.5 * self.width),
            Segment::to(0.03, self.at + self.width),
            Segment::dwell(self.at + TAU),
        ];
        Segments::new(self.at, parts).expect("a law")
    }
}

const BUMP: Bump = Bump { height: 1e-5, at: 100.3 * PI / 180.0, width: 0.1 * PI / 180.0 };

/// The least radius of a circle that touches the bump at one of many places and passes another, or of its curvature there.
fn least_circle(law: &Segments<Polynomial4567, 3>, [from, to]: [f64; 2], side: f64) -> f64 {
    let place = |k: usize| {
        let w = from + (to - from) * k as f64 / 4000.0;
        let [r, slope, bend] = Function::<f64>::jet::<3>(law, w);
        side * (r * bend - r * r - 2.0 * slope * slope) / (r * r + slope * slope).powf(1.5)
    };
    1.0 / (0..=4000).map(place).fold(0.0, f64::max)
}

#[test]
fn a_bump_between_two_samples_is_within_the_reach() {
    let law = BUMP.law();
    // No sample of a degree meets the bump.
    assert!((0..360).all(|k| Function::<f64>::jet::<1>(&law, f64::from(k).to_radians())[0] == 0.03));
    let [inside, outside] = reach::<f64, _>(&law).expect("bounds");
    let ends = [BUMP.at, BUMP.at + BUMP.width];
    for (found, side) in [(inside, -1.0), (outside, 1.0)] {
        let known = least_circle(&law, ends, side);
        assert!(found <= known * (1.0 + 1e-6) && found > 0.995 * known, "{side}: {found:e} {known:e}");
        assert!(found < 1e-3, "{found}");
    }
    // A law without the bump.
    let [inside, outside] = reach::<f64, _>(&Bump { height: 1e-12, ..BUMP }.law()).expect("bounds");
    assert!(inside > 0.0298 && outside > 1.0, "{inside} {outside}");
}

#[test]
fn a_bump_between_two_samples_has_the_nearest_foot() {
    let law = BUMP.law();
    // From a place far outside over the bump's flank: the circle itself is nearest at 100.36 deg, its top a little beside it.
    let towards = BUMP.at + 0.2 * BUMP.width;
    let [x, y] = [towards.cos(), towards.sin()].map(|part| 0.05 * part);
    let foot = nearest_foot(&law, [x, y]).expect("a foot");
    let top = BUMP.at + 0.5 * BUMP.width;
    assert!((foot.angle - top).abs() < 0.3 * BUMP.width, "{} {top}", foot.angle);
    assert!((foot.distance - 0.01999).abs() < 2e-8, "{}", foot.distance);
    // In single precision too.
    let single = nearest_foot(&law, [x as f32, y as f32]).expect("a foot");
    assert!((f64::from(single.distance) - 0.01999).abs() < 1e-6, "{}", single.distance);
    // Midway between two bumps of the same height both tops are as near.
    let twins: Segments<Polynomial4567, 6> = Segments::new(0.0, {
        let [a, b] = [0.001, 0.101];
        [
            Segment::to(0.032, a + 0.01),
            Segment::to(0.03, a + 0.02),
            Segment::dwell(b),
            Segment::to(0.032, b + 0.01),
            Segment::to(0.03, b + 0.02),
            Segment::dwell(TAU),
        ]
    })
    .expect("a law");
    let between = 0.001 + 0.01 + 0.05;
    let found = nearest_foot(&twins, [0.04 * f64::cos(between), 0.04 * f64::sin(between)]);
    assert!(matches!(found, Err(FootError::Ambiguous([a, b])) if (a - b).abs() > 0.09), "{found:?}");
    // From the centre of a circle every place is a foot.
    let circle = Harmonic { offset: 0.03, amplitude: 0.0, frequency: 1.0, phase: 0.0 };
    assert!(matches!(nearest_foot(&circle, [0.0; 2]), Err(FootError::Undecided(_))));
}

/// Values of a function at many arguments, and both ends, are within its enclosure.
fn encloses<const K: usize>(
    name: &str,
    function: &impl Function<f64>,
    random: &mut Sequence,
    [from, to]: [f64; 2],
) {
    for _ in 0..200 {
        let width = (to - from) * 10.0_f64.powf(-7.0 * share(random));
        let low = from + (to - from) * share(random) - 0.5 * width;
        let bounds = function.enclosure::<K>(low, low + width).expect("bounds");
        let mut widest = [0.0_f64; K];
        for k in 0..=40 {
            let x = (low + width * f64::from(k) / 40.0).clamp(low, low + width);
            for (order, value) in function.jet::<K>(x).into_iter().enumerate() {
                let bound = bounds[order];
                let rounding = 1e-11 * (1.0 + value.abs());
                assert!(
                    bound.low() <= value + rounding && value <= bound.high() + rounding,
                    "{name}: {order} at {x}: {value} {bound:?}"
                );
                widest[order] = widest[order].max((value - bound.low()).max(bound.high() - value));
            }
        }
        // Short intervals have close bounds.
        assert!(
            width > 1e-4 * (to - from) || widest.iter().all(|wide| *wide < 3.0),
            "{name}: {widest:?} {width}"
        );
    }
}

#[test]
fn values_of_all_drivers_are_within_their_enclosures() {
    let random = &mut Sequence::new(1);
    let harmonic = Harmonic { offset: 1.0, amplitude: 2.0, frequency: 3.0, phase: 4.0 };
    encloses::<5>("harmonic", &harmonic, random, [-10.0, 10.0]);
    let polynomial = Polynomial { coefficients: [0.3, -0.2, 0.5, 0.1, -0.02, 0.004] };
    encloses::<7>("polynomial", &polynomial, random, [-3.0, 3.0]);
    fn laws<L: Law, const K: usize>(name: &str, random: &mut Sequence) {
        let rise: Rise<L> = Rise::new(0.3, 2.0, 0.1, 0.9).expect("a law");
        encloses::<K>(name, &rise, random, [-1.0, 3.0]);
        let parts = [Segment::to(0.8, 2.0), Segment::dwell(PI), Segment::to(0.0, 5.0), Segment::dwell(TAU)];
        let segments: Segments<L, 4> = Segments::new(0.0, parts).expect("a law");
        encloses::<K>(name, &segments, random, [-20.0, 20.0]);
    }
    laws::<Polynomial345, 3>("345", random);
    laws::<Polynomial4567, 4>("4567", random);
    laws::<Cycloid, 3>("cycloid", random);
    let slide = Trapezoidal::new(3.0, 1.0, 2.0).expect("a law");
    encloses::<2>("trapezoidal", &slide, random, [-1.0, 5.0]);
    // Unevenly spaced knots, ends that go on.
    let x: [f64; 9] = from_fn(|k| k as f64 * 0.5 + 0.2 * share(random));
    let y = x.map(|x| (1.3 * x).sin());
    let spline = CubicSpline::clamped(&x, &y, [0.4, -0.3]).expect("a spline");
    encloses::<3>("cubic spline", &spline, random, [-1.0, 6.0]);
    let (mut rows, mut pieces) = ([CubicRow::EMPTY; 9], [[0.0; 4]; 9]);
    fit_cubic(&x, [End::Natural; 2], &x, &y, &mut rows, &mut pieces).expect("a spline");
    encloses::<3>("open table", &Table::open(&x, &pieces), random, [-1.0, 6.0]);
    let x: [f64; 24] = from_fn(|k| 1.0 + (k as f64 + 0.5 * share(random)) * TAU / 24.0);
    let y = x.map(|x| x.sin() + 0.1 * (3.0 * x).cos());
    let quintic = PeriodicQuintic::interpolate(&x, TAU, &y).expect("a spline");
    encloses::<5>("periodic quintic", &quintic, random, [-30.0, 30.0]);
    let (mut rows, mut pieces) = ([QuinticRow::EMPTY; 24], [[0.0; 6]; 24]);
    fit_periodic_quintic(&x, TAU, &x, &y, &mut rows, &mut pieces).expect("a spline");
    encloses::<5>("periodic table", &&Table::periodic(&x, &pieces, TAU), random, [-30.0, 30.0]);
    encloses::<3>("stated bound", &Bounded { function: harmonic, third: 54.0 }, random, [-10.0, 10.0]);
}

/// R = 30 mm + 1 mm cos 3w, without bounds of its own.
#[derive(Clone, Copy)]
struct Plain;

impl Function<f64> for Plain {
    const ORDER: usize = SMOOTH;

    fn jet<const K: usize>(&self, w: f64) -> [f64; K] {
        let wave =
            |order: usize| 1e-3 * 3.0_f64.powi(order as i32) * (3.0 * w + order as f64 * 0.5 * PI).cos();
        from_fn(|order| wave(order) + if order == 0 { 0.03 } else { 0.0 })
    }
}

#[test]
fn a_function_without_bounds_is_refused_until_one_is_stated() {
    assert_eq!(reach::<f64, _>(&Plain), Err(ReachError::NoBounds));
    assert_eq!(nearest_foot(&Plain, [0.04, 0.0]), Err(FootError::NoBounds));
    let stated = Bounded { function: Plain, third: 0.027 };
    let [inside, outside] = reach::<f64, _>(&stated).expect("a stated bound");
    // At w = 0 R = 31 and R″ = −9 mm, at 60 deg 29 and 9 mm: convex everywhere.
    assert!(
        inside <= 0.031 * 0.031 / 0.040 && inside > 0.99 * 0.031 * 0.031 / 0.040 && outside > 1.0,
        "{inside} {outside}"
    );
    let foot = nearest_foot(&stated, [0.04, 0.0]).expect("a foot");
    assert!((foot.distance - 0.009).abs() < 1e-15 && foot.angle.min(TAU - foot.angle) < 1e-9, "{foot:?}");
    // One that the values contradict.
    assert_eq!(reach::<f64, _>(&Bounded { function: Plain, third: 1e-4 }), Err(ReachError::NoBounds));
    // A curve through its centre.
    let loops = Harmonic { offset: 0.01, amplitude: 0.03, frequency: 1.0, phase: 0.0 };
    assert!(matches!(reach::<f64, _>(&loops), Err(ReachError::Undecided(_))));
}

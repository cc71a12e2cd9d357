//! Orders of the methods in equal steps, by least squares, against the reference of the other kind.
#![forbid(unsafe_code)]

use std::time::Duration;

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince5, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method,
    Projection, Radau5, RungeKutta4, SemiImplicitEuler, Simulation,
};
use mbs_workbench::comparable;
use mbs_workbench::cost::reference::{Leg, Reference, reference};
use mbs_workbench::erased::costs::{Comparable, MovedCosts};
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::pendulum::Pendulum;
use mechanisms::slider_crank_mass::CrankPistonReleased;

/// Errors above it are not of an order yet.
const COARSE: f64 = 1e-3;

/// Widths of the reference, and roundings, below which errors are no longer of an order.
const WIDTHS: f64 = 1e3;
const ROUNDED: f64 = 1e3 * f64::EPSILON;

/// The same of implicit steps, whose iterations end at the rounding of residuals.
const ITERATED: f64 = 1e4 * f64::EPSILON;

/// Instants of a comparison.
const PARTS: u32 = 4;

/// Distance of a slope from the order.
const WITHIN: f64 = 0.3;

/// Points that a slope needs.
const POINTS: usize = 4;

/// Largest error of a slope over its smallest one: coarse steps of a high order are beside their first term.
const DECADES: f64 = 1e4;

/// Ratio of the steps of a point to those of the one before.
const RATIO: f64 = 1.2;

/// Most steps of a run, and of one of order 1.
const STEPS: f64 = 1e4;
const STEPS_OF_ORDER_1: f64 = 1e5;

/// The slope of −ln y over ln x by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logarithms: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), -y.ln())).collect();
    let (x, y) = logarithms.iter().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / count, y + b / count));
    let (up, down) = logarithms
        .iter()
        .fold((0.0, 0.0), |(up, down), (a, b)| (up + (a - x) * (b - y), down + (a - x) * (a - x)));
    up / down
}

/// References of a motion to its end, explicit and implicit, and their difference.
struct References {
    explicit: Reference,
    implicit: Reference,
    width: f64,
}

fn references(mechanism: &mut MovedCosts, times: &[f64]) -> References {
    let (_, runs) = &mechanism.runs[0];
    let [q, qd] = runs.start(0.0).expect("a start");
    let scales = mechanism.exact.scales();
    let mut of = |leg| {
        let found =
            reference(mechanism.exact.as_mut(), leg, (&q, &qd), times, 1e-15, Duration::from_secs(300));
        assert_eq!(found.stuck, None, "{leg:?}");
        found
    };
    let (explicit, implicit) = (of(Leg::Extrapolated), of(Leg::Collocated));
    let pairs = explicit.shots.iter().zip(&implicit.shots);
    let width = pairs.flat_map(|(a, b)| {
        let pairs = a.at.q.iter().zip(&b.at.q).zip(&scales);
        pairs.map(|((a, b), scale)| (*a - *b).high.abs() / scale).collect::<Vec<_>>()
    });
    let width = width.fold(0.0, f64::max);
    References { explicit, implicit, width }
}

/// Error of a run of so many equal steps; none where it fails.
fn error<S, X, const N: usize, const M: usize>(
    (mechanism, method): (&S, X),
    truth: &Reference,
    steps: u32,
) -> Option<f64>
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    let mut run = Simulation::start_from_text(mechanism.clone(), method, 0.0).ok()?;
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let mut largest = 0.0_f64;
    for shot in truth.shots.iter().skip(1) {
        run.step_to(shot.at.t.high, steps / PARTS).ok()?;
        for ((q, exact), scale) in run.q().iter().zip(&shot.at.q).zip(&scales) {
            let distance = ((q - exact.high) - exact.low).abs() / scale;
            assert!(distance.is_finite());
            largest = largest.max(distance);
        }
    }
    Some(largest)
}

/// The order of a method over the points of its range.
fn check<S, X, const N: usize, const M: usize>(
    name: &str,
    (mechanism, method): (&S, X),
    (truth, floor): (&Reference, f64),
    order: f64,
    missed: &mut Vec<String>,
) where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M> + Copy,
{
    let mut points: Vec<(f64, f64)> = Vec::new();
    let mut count = 4.0;
    let most = if order > 1.0 { STEPS } else { STEPS_OF_ORDER_1 };
    while count <= most {
        let steps = PARTS * (count / f64::from(PARTS)).round() as u32;
        count *= RATIO;
        let Some(error) = error((mechanism, method), truth, steps) else { continue };
        if error <= floor {
            break;
        }
        let is_new = points.last().is_none_or(|(last, _)| *last < f64::from(steps));
        if error < COARSE && is_new {
            points.push((f64::from(steps), error));
        }
    }
    let least = points.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
    points.retain(|(_, error)| *error <= DECADES * least);
    let slope = slope(&points);
    println!("{name}: order {slope:.2} of {order} by {} points", points.len());
    if points.len() < POINTS || (slope - order).abs() > WITHIN || slope.is_nan() {
        missed.push(format!("{name}: order {slope} of {order}, {points:?}"));
    }
}

#[test]
fn methods_have_their_orders() {
    let mut missed = Vec::new();
    macro_rules! orders {
        ($name:literal, $make:expr, $until:expr $(, $eighth:ident)?) => {{
            let Comparable::Moved(mut compared) = comparable!($make)(&[]) else { panic!("forces move it") };
            let times: Vec<f64> = (0..=PARTS).map(|k| $until * f64::from(k) / f64::from(PARTS)).collect();
            let References { explicit, implicit, width } = references(&mut compared, &times);
            let mechanism = $make;
            macro_rules! explicit {
                ($integrator:ident, $order:expr) => {
                    let method = Explicit::new($integrator, Projection::default());
                    let name = concat!($name, ", ", stringify!($integrator));
                    let truth = (&implicit, (WIDTHS * width).max(ROUNDED));
                    check(name, (&mechanism, method), truth, $order, &mut missed);
                };
            }
            macro_rules! implicit {
                ($method:expr, $order:expr) => {
                    let name = concat!($name, ", ", stringify!($method));
                    let truth = (&explicit, (WIDTHS * width).max(ITERATED));
                    check(name, (&mechanism, $method), truth, $order, &mut missed);
                };
            }
            explicit!(SemiImplicitEuler, 1.0);
            explicit!(RungeKutta4, 4.0);
            explicit!(DormandPrince5, 5.0);
            $(explicit!($eighth, 8.0);)?
            implicit!(Explicit::new(Radau5, Projection::default()), 5.0);
            implicit!(AugmentedLagrangian, 2.0);
            implicit!(GeneralizedAlpha::default(), 2.0);
            implicit!(Extrapolated, 3.0);
        }};
    }
    orders!("pendulum", Pendulum::<f64>::default(), 2.0, DormandPrince8);
    orders!("double pendulum", DoublePendulum::<f64>::default(), 0.8, DormandPrince8);
    // On it steps of order 8 are at rounding before their first term rules.
    orders!("slider-crank", CrankPistonReleased::<f64>::default(), 0.22);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

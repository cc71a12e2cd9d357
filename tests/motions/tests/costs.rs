//! Studies of what accuracy costs: orders of the methods, counts of their points, nothing wrong.
//!
//! `UPDATE_SNAPSHOTS=1` stores the counts anew in `tests/motions/data/costs.txt`.
#![forbid(unsafe_code)]

use std::fmt::Write;
use std::{env, fs};

use mbs_workbench::comparable;
use mbs_workbench::cost::moved::{Extent, MovedStudy, moved_study};
use mbs_workbench::cost::points::{Outcome, Verdict};
use mbs_workbench::erased::costs::Comparable;
use mbs_workbench::setting::{
    FormulationName, ImplicitName, IntegratorName, MotionMethod, Numbers, Resolution, Setting,
};
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::pendulum::Pendulum;
use mechanisms::slider_crank_mass::CrankPistonReleased;

/// Errors above it are not of an order yet.
const COARSE: f64 = 1e-2;

/// Widths of the reference, and roundings, below which errors are no longer of an order.
const WIDTHS: f64 = 1e3;
const ROUNDED: f64 = 1e-11;

/// Methods with their order in the number of steps, and how far the slope may be from it: adaptive steps are of unequal length.
fn orders() -> [(MotionMethod, f64, f64); 7] {
    let projected = |integrator| MotionMethod::Explicit(FormulationName::Projection, integrator);
    [
        (projected(IntegratorName::SemiImplicitEuler), 1.0, 0.3),
        (projected(IntegratorName::RungeKutta4), 4.0, 0.5),
        (MotionMethod::Implicit(ImplicitName::AugmentedLagrangian), 2.0, 0.3),
        (MotionMethod::Implicit(ImplicitName::GeneralizedAlpha), 2.0, 0.3),
        (projected(IntegratorName::DormandPrince5), 5.0, 1.5),
        (projected(IntegratorName::DormandPrince8), 8.0, 2.0),
        (projected(IntegratorName::Radau5), 5.0, 1.5),
    ]
}

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

/// A mechanism in all numbers, with parameters by their indices.
type Make = fn(&[(usize, f64)]) -> Comparable;

fn study(make: Make, until: f64) -> MovedStudy {
    let Comparable::Moved(mut mechanism) = make(&[]) else { panic!("forces move it") };
    let methods = orders().map(|(method, _, _)| method).to_vec();
    let extent = Extent { methods, longest: 0.4, reference: 300.0, tolerance: 1e-14, watched: Vec::new() };
    moved_study(&mut mechanism, until, &extent, &mut |_, _| ()).expect("references")
}

fn steps(point: &mbs_workbench::cost::points::Point) -> f64 {
    match point.setting {
        Setting::Motion { resolution: Resolution::Steps(steps), .. } => f64::from(steps),
        _ => point.effort.steps as f64,
    }
}

#[test]
fn methods_have_their_orders_their_counts_and_nothing_wrong() {
    let mut counts = String::from("# mechanism, setting: evaluations, steps\n");
    let mechanisms: [(&str, Make, f64); 3] = [
        ("pendulum", comparable!(Pendulum::default()), 1.0),
        ("double pendulum", comparable!(DoublePendulum::default()), 1.2),
        ("slider-crank", comparable!(CrankPistonReleased::default()), 0.5),
    ];
    for (name, make, until) in mechanisms {
        let found = study(make, until);
        let width = found.width.expect("both references");
        assert!(width < 1e-12, "{name}: {width:e}");
        for (method, order, within) in orders() {
            let own = found.points.iter().filter(|point| {
                matches!(point.setting, Setting::Motion { method: own, numbers: Numbers::Double, .. } if own == method)
            });
            let of = |point: &mbs_workbench::cost::points::Point| Some((steps(point), point.error()?));
            let in_order =
                |(_, error): &(f64, f64)| (WIDTHS * width).max(ROUNDED) < *error && *error < COARSE;
            let points: Vec<(f64, f64)> = own.filter_map(of).filter(in_order).collect();
            assert!(points.len() >= 4, "{name}, {method}: {} points", points.len());
            let slope = slope(&points);
            println!("{name}, {method}: order {slope:.2} by {} points", points.len());
            assert!((slope - order).abs() <= within, "{name}, {method}: order {slope}, {points:?}");
        }
        for point in &found.points {
            if let Outcome::Done { verdict, errors, expected } = &point.outcome {
                assert_ne!(
                    *verdict,
                    Verdict::Wrong,
                    "{name}: {}: {errors:?}, expected {expected:?}",
                    point.setting
                );
                let is_short = point.effort.steps <= 2000 && point.setting.numbers() == Numbers::Double;
                if is_short && errors.judged > 1e-9 {
                    let _ = writeln!(
                        counts,
                        "{name}, {}: {}, {}",
                        point.setting, point.effort.evaluations, point.effort.steps
                    );
                }
            }
        }
    }
    assert!(counts.lines().count() > 30);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/costs.txt");
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(path, &counts).expect("a file");
    }
    let stored = fs::read_to_string(path).unwrap_or_default();
    let number = |text: &str| text.trim().parse::<f64>().unwrap_or(0.0);
    let split = |line: &str| {
        let (name, numbers) = line.rsplit_once(": ").unwrap_or((line, ""));
        let (evaluations, steps) = numbers.split_once(',').unwrap_or(("", ""));
        (name.to_string(), number(evaluations), number(steps))
    };
    // Runs end at times that depend on roundings of the platform's functions by a step.
    let near = |a: f64, b: f64| (a - b).abs() <= 0.02 * a.max(b) + 13.0;
    for (found, stored) in
        counts.lines().zip(stored.lines()).map(|(found, stored)| (split(found), split(stored)))
    {
        assert_eq!(found.0, stored.0);
        assert!(near(found.1, stored.1) && near(found.2, stored.2), "{found:?} {stored:?}");
    }
    assert_eq!(counts.lines().count(), stored.lines().count());
}

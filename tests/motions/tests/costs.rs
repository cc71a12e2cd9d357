//! Studies of what accuracy costs: counts of their points, nothing wrong.
//!
//! `UPDATE_SNAPSHOTS=1` stores the counts anew in `tests/motions/data/costs.txt`.
#![forbid(unsafe_code)]

use std::fmt::Write;
use std::{env, fs};

use mbs_workbench::comparable;
use mbs_workbench::cost::moved::{Extent, MovedStudy, moved_study};
use mbs_workbench::cost::points::{Outcome, Verdict};
use mbs_workbench::erased::costs::Comparable;
use mbs_workbench::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod, Numbers};
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::pendulum::Pendulum;
use mechanisms::slider_crank_mass::CrankPistonReleased;

/// Methods of the studies.
fn methods() -> Vec<MotionMethod> {
    use IntegratorName::{DormandPrince5, DormandPrince8, Radau5, RungeKutta4, SemiImplicitEuler};
    let integrators = [SemiImplicitEuler, RungeKutta4, DormandPrince5, DormandPrince8, Radau5];
    let projected =
        integrators.map(|integrator| MotionMethod::Explicit(FormulationName::Projection, integrator));
    let implicit = [ImplicitName::AugmentedLagrangian, ImplicitName::GeneralizedAlpha];
    // Those of equal steps first: the first curve tells how long a run may take.
    let mut methods = projected.to_vec();
    methods.splice(2..2, implicit.map(MotionMethod::Implicit));
    methods
}

/// A mechanism in all numbers, with parameters by their indices.
type Make = fn(&[(usize, f64)]) -> Comparable;

fn study(make: Make, until: f64) -> MovedStudy {
    let Comparable::Moved(mut mechanism) = make(&[]) else { panic!("forces move it") };
    let extent =
        Extent { methods: methods(), longest: 0.4, reference: 300.0, tolerance: 1e-14, watched: Vec::new() };
    moved_study(&mut mechanism, until, &extent, &mut |_, _| ()).expect("references")
}

#[test]
fn methods_have_their_counts_and_nothing_wrong() {
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

//! Motions with modes: references of one kind against closed forms.

use super::moved::{Extent, MovedStudy, moved_study};
use super::points::{Outcome, Verdict};
use super::reference::Leg;
use super::tests::moved;
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod, Numbers};

const G: f64 = 9.81;

mbs_runtime::mechanism! {
    /// A block that slides to rest, a ball that bounces, and a lift that pushes once it is high.
    pub mechanism Modes;
    coord x: m = 0;
    coord y: m = 0.2;
    coord z: m = 0;
    body block { mass: 1, com: [x, 0] }
    body ball { mass: 2, com: [0, y] }
    body lift { mass: 1, com: [z, 0] }
    gravity weight { acceleration: [0, -9.81] }
    friction rub { along: x, normal: 9.81N, coefficient: 0.3, sticks: 0.4 }
    contact floor { gap: y, restitution: 0.8 }
    event high: z > 0.3m until z > 0.9m;
    force push: 2N*high on z;
    start x = 0 rate 1;
    start y = 0.2 rate 0;
    start z = 0 rate 1;
}

/// Places of block, ball and lift (m) at `t` (s), before the third impact and before the lift is at 0.9 m.
fn exact(t: f64) -> [f64; 3] {
    let (friction, fall) = (0.3 * G, (0.4 / G).sqrt());
    let slides = t.min(1.0 / friction);
    let (mut since, mut speed) = (0.0, 0.0);
    let mut y = 0.2 - 0.5 * G * t * t;
    if t > fall {
        (since, speed) = (fall, 0.8 * G * fall);
    }
    if speed > 0.0 {
        let next = since + 2.0 * speed / G;
        (since, speed) = if t > next { (next, 0.8 * speed) } else { (since, speed) };
        y = speed * (t - since) - 0.5 * G * (t - since) * (t - since);
    }
    let pushed = (t - 0.3).max(0.0);
    [slides - 0.5 * friction * slides * slides, y, t + pushed * pushed]
}

fn studied(methods: Vec<MotionMethod>) -> MovedStudy {
    let mut mechanism = moved(Modes::default());
    let extent = Extent { methods, longest: 0.1, reference: 20.0, tolerance: 1e-15, watched: Vec::new() };
    moved_study(&mut mechanism, 0.6, &extent, &mut |_, _| ()).expect("references")
}

#[test]
fn references_of_one_kind_are_the_motion_and_runs_are_judged_by_them() {
    use FormulationName::{Projection, VelocityTransformation};
    use IntegratorName::{DormandPrince8, RungeKutta4};
    let mut methods = vec![
        MotionMethod::Explicit(Projection, DormandPrince8),
        MotionMethod::Explicit(Projection, RungeKutta4),
        MotionMethod::Explicit(VelocityTransformation, DormandPrince8),
    ];
    methods.push(MotionMethod::Implicit(ImplicitName::Extrapolated));
    let study = studied(methods);
    assert_eq!(study.effect, Some("rub"));
    assert_eq!(study.references.iter().map(|(leg, _)| *leg).collect::<Vec<_>>(), [Leg::Order8, Leg::Order5]);
    for (leg, reference) in &study.references {
        assert_eq!(reference.stuck, None, "{leg:?}");
        for shot in &reference.shots {
            let t = shot.at.t.high;
            for (found, exact) in shot.at.q.iter().zip(exact(t)) {
                assert!((found.high - exact).abs() < 1e-13, "{leg:?} at {t}: {} {exact}", found.high);
            }
        }
        let times = |jumps: bool| {
            let own = reference.contacts.iter().filter(move |contact| contact.jumps == jumps);
            own.map(|contact| contact.t).collect::<Vec<f64>>()
        };
        let (impacts, events) = (times(true), times(false));
        let fall = (0.4 / G).sqrt();
        // The lift is at 0.3 m.
        assert!(events.len() == 1 && (events[0] - 0.3).abs() < 1e-13, "{events:?}");
        assert_eq!(impacts.len(), 2, "{impacts:?}");
        assert!((impacts[0] - fall).abs() < 1e-14 && (impacts[1] - 2.6 * fall).abs() < 1e-14, "{impacts:?}");
    }
    assert!(study.width.is_some_and(|width| width < 1e-12), "{:?}", study.width);
    let done = study.points.iter().filter_map(|point| match point.outcome {
        Outcome::Done { errors, verdict, .. } => Some((point.setting, errors, verdict)),
        Outcome::Refused(_) => None,
    });
    let done: Vec<_> = done.collect();
    assert!(done.len() > 6, "{}", done.len());
    for (setting, errors, verdict) in &done {
        assert_ne!(*verdict, Verdict::Wrong, "{setting}: {errors:?}");
        if setting.numbers() == Numbers::Double {
            assert!(
                errors.judged < 1e-9 && errors.contact < 1e-9 && errors.rate < 1e-8,
                "{setting}: {errors:?}"
            );
        }
    }
    let refused = study.points.iter().filter_map(|point| match &point.outcome {
        Outcome::Refused(reason) => Some((point.setting.curve(), reason)),
        Outcome::Done { .. } => None,
    });
    for (curve, reason) in refused {
        assert!(curve.starts_with("Extrapolated") && reason.contains("rub"), "{curve}: {reason}");
    }
}

mbs_runtime::mechanism! {
    /// A ball that comes to rest after infinitely many bounces.
    pub mechanism Resting;
    coord y: m = 0.1;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, restitution: 0.5 }
    start y = 0.1 rate 0;
}

#[test]
fn infinitely_many_bounces_are_the_same_motion_in_all_numbers() {
    let mut mechanism = moved(Resting::default());
    let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
    let extent = Extent {
        methods: vec![method],
        longest: 0.02,
        reference: 20.0,
        tolerance: 1e-15,
        watched: Vec::new(),
    };
    // It rests since three times the time of its fall.
    let study = moved_study(&mut mechanism, 0.6, &extent, &mut |_, _| ()).expect("references");
    let fall = (0.2 / G).sqrt();
    for (leg, reference) in &study.references {
        assert_eq!(reference.stuck, None, "{leg:?}");
        let impacts = &reference.contacts;
        assert!(impacts.len() > 15, "{leg:?}: {}", impacts.len());
        let last = impacts.last().map_or(0.0, |contact| contact.t);
        assert!((last - 3.0 * fall).abs() < 1e-6, "{leg:?}: {last} {}", 3.0 * fall);
        assert!(
            reference
                .shots
                .iter()
                .filter(|shot| shot.at.t.high > 3.0 * fall)
                .all(|shot| shot.at.q[0].high.abs() < 1e-15)
        );
    }
    let done = study.points.iter().filter_map(|point| match point.outcome {
        Outcome::Done { errors, verdict, .. } => Some((point.setting, errors, verdict)),
        Outcome::Refused(_) => None,
    });
    for (setting, errors, verdict) in done.filter(|(setting, ..)| setting.numbers() == Numbers::Double) {
        assert!(verdict != Verdict::Wrong && errors.judged < 1e-9, "{setting}: {errors:?}");
        assert!(errors.contact < 1e-6, "{setting}: {errors:?}");
    }
}

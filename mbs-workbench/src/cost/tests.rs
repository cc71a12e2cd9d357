use std::time::Duration;

use mbs_runtime::dynamics::{DormandPrince8, Equation, FixedStep, Vector};
use mbs_runtime::{Failure, InNumbers, Reveal, Scalar};

use super::kinematics::{driven_study, open_rows};
use super::moved::{Extent, moved_study};
use super::points::{Outcome, Verdict};
use super::reference::{Leg, Reference, reference};
use crate::double_double::DoubleDouble as D;
use crate::erased::costs::{Comparable, MovedCosts, comparable};
use crate::erased::dynamics::direct_dynamics::{Pair, Rule};
use crate::erased::dynamics::integrators::Integrators;
use crate::erased::exact::{Exact, ExactEquations, Moving, Observed, Rows, Sizes, Terms};
use crate::erased::timed_runs::Runs;
use crate::setting::{
    Closing, FormulationName, ImplicitName, IntegratorName, Kernel, MotionMethod, Numbers, Setting,
};

mbs_runtime::mechanism! {
    /// A01 of the IFToMM benchmark: a point mass on a rod, in Cartesian coordinates.
    pub mechanism Pendulum;
    coord p: [m; 2] = [-1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    start p = [-1, 0] rate [0, 0];
    out height: m = p.1;
    out pivot: m = 0;
}

mbs_runtime::mechanism! {
    /// The pendulum with its row written twice.
    pub mechanism TwiceHeld;
    coord p: [m; 2] = [-1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    constraint again redundant { 2*dot(p, p) == 2 [m^2]; }
    start p = [-1, 0] rate [0, 0];
}

mbs_runtime::mechanism! {
    /// A ball that falls onto a soft floor.
    pub mechanism Ball;
    coord y: m = 0.1;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, stiffness: 1e4, exponent: 1.5, depth: 0.01, damping: 0 }
    start y = 0.1 rate 0;
}

mbs_runtime::mechanism! {
    /// A crank with its slider.
    pub mechanism CrankSlider;
    coord phi: rad;
    coord psi: rad = -0.3;
    coord x: m = 0.4;
    constraint loop_ { 0.1m*unit(phi) + 0.3m*unit(psi) == [x, 0]; }
    drive crank: phi == 2 [rad/s]*t + 0.4;
    branch rod_ahead: cos(psi) > 0;
}

/// Positions (m) and velocities (m/s) at 1 s, from elliptic functions.
pub(super) const AT_ONE: [f64; 4] =
    [0.9862917511318753, -0.16501085312554117, 0.2969055159163158, 1.7746436411126556];

fn exact() -> Exact<<Pendulum as InNumbers<D>>::Mechanism, 2, 1> {
    Exact::of(Pendulum::default().in_numbers())
}

fn followed(
    equations: &mut dyn ExactEquations,
    leg: Leg,
    until: f64,
    parts: u32,
    tolerance: f64,
) -> Reference {
    let times: Vec<f64> = (0..=parts).map(|k| until * f64::from(k) / f64::from(parts)).collect();
    let start = [-1.0, 0.0];
    let found = reference(equations, leg, (&start, &[0.0, 0.0]), &times, tolerance, Duration::from_secs(120));
    assert_eq!(found.stuck, None, "{leg:?}");
    found
}

fn end(found: &Reference) -> &Moving {
    &found.shots.last().expect("an end").at
}

/// Largest difference of the coordinates of two references.
fn apart(a: &Reference, b: &Reference) -> f64 {
    let pairs = a.shots.iter().zip(&b.shots).flat_map(|(a, b)| a.at.q.iter().zip(&b.at.q));
    pairs.map(|(a, b)| (*a - *b).high.abs()).fold(0.0, f64::max)
}

#[test]
fn both_legs_have_the_digits_of_the_pendulum_and_of_each_other() {
    let a = followed(&mut exact(), Leg::Extrapolated, 1.0, 12, 1e-17);
    let b = followed(&mut exact(), Leg::Collocated, 1.0, 40, 1e-15);
    for leg in [&a, &b] {
        let Moving { q, qd, .. } = end(leg);
        for (value, exact) in q.iter().chain(qd).zip(AT_ONE) {
            assert!((value.high - exact).abs() < 4e-15, "{value:?} {exact}");
        }
    }
    let width = end(&a).q.iter().zip(&end(&b).q).map(|(a, b)| (*a - *b).high.abs()).fold(0.0, f64::max);
    assert!(width < 1e-14, "{width:e}");
    assert!(b.shots.iter().all(|shot| (shot.observed.energy.high).abs() < 1e-13));
}

/// The pendulum with a fault: a factor on γ alone.
struct FaultyGamma<E>(E, f64);

impl<E: ExactEquations> ExactEquations for FaultyGamma<E> {
    fn sizes(&self) -> Sizes {
        self.0.sizes()
    }
    fn scales(&self) -> Vec<f64> {
        self.0.scales()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.0.row_scales()
    }
    fn start_states(&self) -> Vec<D> {
        self.0.start_states()
    }
    fn begin(&mut self, t: D, q: &[D]) {
        self.0.begin(t, q);
    }
    fn move_on(&mut self, t: D) {
        self.0.move_on(t);
    }
    fn rows(&self, at: &Moving) -> Rows {
        self.0.rows(at)
    }
    fn gamma(&self, at: &Moving) -> Vec<D> {
        self.0.gamma(at).into_iter().map(|gamma| gamma * D::new(1.0 + self.1)).collect()
    }
    fn terms(&self, at: &Moving, lambda: &[D]) -> Terms {
        self.0.terms(at, lambda)
    }
    fn gaps(&self, at: &Moving) -> Vec<[D; 2]> {
        self.0.gaps(at)
    }
    fn observed(&self, at: &Moving, qdd: &[D], lambda: &[D]) -> Observed<D> {
        self.0.observed(at, qdd, lambda)
    }
}

#[test]
fn a_fault_in_gamma_alone_moves_one_leg_and_not_the_other() {
    let right = followed(&mut exact(), Leg::Collocated, 0.5, 20, 1e-13);
    let faulty = followed(&mut FaultyGamma(exact(), 1e-6), Leg::Collocated, 0.5, 20, 1e-13);
    // The end of a step is judged by accelerations, its positions are not.
    assert!(apart(&right, &faulty) < 1e-12, "{:e}", apart(&right, &faulty));
    let explicit = followed(&mut FaultyGamma(exact(), 1e-6), Leg::Extrapolated, 0.5, 20, 1e-13);
    assert!(apart(&right, &explicit) > 1e-9, "{:e}", apart(&right, &explicit));
}

#[test]
fn a_contact_is_located_by_both_legs() {
    let times: Vec<f64> = (0..=10).map(|k| 0.03 * f64::from(k)).collect();
    let run = |leg| {
        let mut ball: Exact<_, 1, 0> = Exact::of(Ball::default().in_numbers());
        reference(&mut ball, leg, (&[0.1], &[0.0]), &times, 1e-15, Duration::from_secs(120))
    };
    let (a, b) = (run(Leg::Extrapolated), run(Leg::Collocated));
    for leg in [&a, &b] {
        // Touch at 0.1428 s, off again about 25 ms later.
        assert_eq!((&leg.stuck, leg.contacts.len()), (&None, 2));
        // The floor's energy is no potential of the text.
        let open = leg.shots.iter().filter(|shot| shot.at.q[0].high > 0.0);
        let drift: Vec<f64> = open.map(|shot| (shot.observed.energy.high - 0.981).abs()).collect();
        assert!(drift.len() > 8 && drift.iter().all(|drift| *drift < 1e-12), "{drift:?}");
    }
    assert!(apart(&a, &b) < 1e-12, "{:e}", apart(&a, &b));
}

pub(super) fn moved<S>(mechanism: S) -> Box<MovedCosts>
where
    S: Reveal<f64> + Clone + InNumbers<D> + InNumbers<f32>,
    S: InNumbers<mbs_runtime::Lanes<f64, 4>> + InNumbers<mbs_runtime::Lanes<f64, 8>>,
    S: InNumbers<mbs_runtime::Lanes<f64, 16>> + InNumbers<mbs_runtime::Lanes<f32, 8>>,
    <S as InNumbers<D>>::Mechanism: Reveal<D>,
    <S as InNumbers<f32>>::Mechanism: Reveal<f32>,
    <S as InNumbers<mbs_runtime::Lanes<f64, 4>>>::Mechanism: Reveal<mbs_runtime::Lanes<f64, 4>>,
    <S as InNumbers<mbs_runtime::Lanes<f64, 8>>>::Mechanism: Reveal<mbs_runtime::Lanes<f64, 8>>,
    <S as InNumbers<mbs_runtime::Lanes<f64, 16>>>::Mechanism: Reveal<mbs_runtime::Lanes<f64, 16>>,
    <S as InNumbers<mbs_runtime::Lanes<f32, 8>>>::Mechanism: Reveal<mbs_runtime::Lanes<f32, 8>>,
{
    match comparable(&mechanism) {
        Comparable::Moved(mechanism) => mechanism,
        _ => panic!("forces move it"),
    }
}

fn extent(methods: Vec<MotionMethod>) -> Extent {
    Extent { methods, longest: 0.02, reference: 60.0, tolerance: 1e-13, watched: Vec::new() }
}

#[test]
fn errors_fall_with_the_tolerance_and_nothing_is_wrong() {
    let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
    let mut mechanism = moved(Pendulum::default());
    let study = moved_study(&mut mechanism, 0.5, &extent(vec![method]), &mut |_, _| ()).expect("references");
    assert!(study.width.is_some_and(|width| width < 1e-12), "{:?}", study.width);
    let of = |numbers| {
        let own = study.points.iter().filter(move |point| point.setting.numbers() == numbers);
        own.filter_map(|point| point.error()).collect::<Vec<f64>>()
    };
    let double = of(Numbers::Double);
    assert!(
        double.len() >= 10 && double[0] > 1e-5 && double.iter().copied().fold(1.0, f64::min) < 1e-11,
        "{double:?}"
    );
    let floor = of(Numbers::Single).into_iter().fold(1.0, f64::min);
    assert!(1e-9 < floor && floor < 1e-5, "{floor:e}");
    let is_wrong = |outcome: &Outcome| matches!(outcome, Outcome::Done { verdict: Verdict::Wrong, .. });
    let wrong: Vec<_> = study.points.iter().filter(|point| is_wrong(&point.outcome)).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    let done = study.points.iter().filter(|point| matches!(point.outcome, Outcome::Done { .. }));
    assert!(
        done.clone().count() > 14
            && done.clone().all(|point| point.time > 0.0 && point.effort.evaluations > 0)
    );
}

#[test]
fn positions_of_drives_are_known_in_all_digits() {
    let Comparable::Driven(mut mechanism) = comparable(&CrankSlider::default()) else {
        panic!("a drive moves it")
    };
    let study = driven_study(&mut mechanism, (1.0, 0.05), Kernel::Own, &mut |_, _| ()).expect("references");
    assert!(study.width < 1e-18, "{:e}", study.width);
    let closed = |point: &&super::points::Point| {
        matches!(
            point.setting,
            Setting::Kinematics { numbers: Numbers::Double, closing: Closing::Closed, .. }
        )
    };
    let errors: Vec<f64> = study.points.iter().filter(closed).filter_map(|point| point.error()).collect();
    assert!(errors.len() > 20 && errors.iter().all(|error| *error < 1e-13), "{errors:?}");
    let predicted = study.points.iter().filter(|point| point.setting.curve() == "Stepper, 1 evaluation");
    let predicted: Vec<f64> = predicted.filter_map(|point| point.error()).collect();
    assert!(predicted[0] > 100.0 * predicted[predicted.len() - 1], "{predicted:?}");
}

#[test]
fn an_output_that_keeps_one_value_is_no_measure_of_an_error() {
    let of = |watched| {
        let own = Extent { tolerance: 1e-10, watched, ..extent(Vec::new()) };
        let mut mechanism = moved(Pendulum::default());
        mechanism.runs.retain(|(numbers, _)| *numbers == Numbers::Double);
        let own = Extent { methods: vec![MotionMethod::Implicit(ImplicitName::AugmentedLagrangian)], ..own };
        moved_study(&mut mechanism, 0.1, &own, &mut |_, _| ()).map(|study| study.points.len())
    };
    let reason = of(vec![1]).expect_err("the pivot stands").reason;
    assert!(reason.contains("keep one value"), "{reason}");
    assert!(of(vec![0, 1]).is_ok_and(|points| points > 0));
}

/// Runge and Kutta's method with a fault of 1e-6 in one weight.
#[derive(Clone, Copy)]
struct FaultyWeight;

impl FixedStep for FaultyWeight {
    fn order(&self) -> u32 {
        4
    }
    fn step<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        t: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure> {
        let middle = t + T::constant(0.5) * h;
        let k2 = equation.rate(middle, &y.plus(h, &[0.5], [rate]))?;
        let k3 = equation.rate(middle, &y.plus(h, &[0.5], [&k2]))?;
        let k4 = equation.rate(t + h, &y.plus(h, &[1.0], [&k3]))?;
        let weights = [1.0 / 6.0, 1.0 / 3.0 + 1e-6, 1.0 / 3.0, 1.0 / 6.0];
        Ok(y.plus(h, &weights, [rate, &k2, &k3, &k4]))
    }
}

/// Integrators of which those of fixed steps have the fault.
#[derive(Clone, Copy)]
struct Faulty;

impl Integrators for Faulty {
    type Adaptive = DormandPrince8;
    type Fixed = FaultyWeight;
    const RADAU: Option<(DormandPrince8, FaultyWeight)> = None;

    fn pair(_: Pair) -> DormandPrince8 {
        DormandPrince8
    }
    fn rule(_: Rule) -> FaultyWeight {
        FaultyWeight
    }
}

#[test]
fn a_fault_in_one_weight_lifts_its_curve() {
    let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::RungeKutta4);
    let best = |mechanism: &mut MovedCosts| {
        let study = moved_study(mechanism, 0.5, &extent(vec![method]), &mut |_, _| ()).expect("references");
        study.points.iter().filter_map(|point| point.error()).fold(1.0, f64::min)
    };
    let mut right = moved(Pendulum::default());
    right.runs.retain(|(numbers, _)| *numbers == Numbers::Double);
    let run = Runs::<Pendulum, Faulty, f64, 2, 1>::of(Pendulum::default());
    let mut faulty = MovedCosts {
        exact: Box::new(exact()),
        one_kind: None,
        runs: vec![(Numbers::Double, Box::new(run))],
        doubles: Vec::new(),
    };
    let (right, faulty) = (best(&mut right), best(&mut faulty));
    assert!(right < 1e-10 && faulty > 1e-8, "{right:e} {faulty:e}");
}

#[test]
fn contacts_of_a_run_are_compared_with_those_of_the_reference() {
    let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
    let mut mechanism = moved(Ball::default());
    let methods =
        vec![method, MotionMethod::Explicit(FormulationName::Projection, IntegratorName::RungeKutta4)];
    // Long enough for fine steps on a busy machine.
    let own = Extent { longest: 0.1, ..extent(methods) };
    let study = moved_study(&mut mechanism, 0.3, &own, &mut |_, _| ()).expect("references");
    let of = |point: &super::points::Point| match point.outcome {
        Outcome::Done { errors, .. } => errors,
        Outcome::Refused(_) => panic!("{point:?}"),
    };
    let fine: Vec<_> =
        study.points.iter().filter(|point| point.setting.to_string().contains("1e-11")).collect();
    let errors = of(fine[0]);
    assert!(errors.contact < 1e-10 && errors.rate < 1e-9, "{errors:?}");
    // Coarse steps pass the contact late; velocities are compared at the time shifted by that.
    let coarse = of(&study.points[1]);
    assert!(coarse.contact > 1e-9 && coarse.contact < 1e-3, "{coarse:?}");
    let fixed = study.points.iter().filter(|point| point.setting.curve() == "Projection with RungeKutta4");
    let fixed: Vec<f64> = fixed.map(|point| of(point).contact).collect();
    let finest = fixed.iter().copied().fold(1.0, f64::min);
    assert!(finest < 1e-7 && finest < 1e-2 * fixed[0], "{fixed:?}");
}

#[test]
fn multipliers_are_compared_where_they_are_unique_alone() {
    let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
    let mut mechanism = moved(Pendulum::default());
    let study = moved_study(&mut mechanism, 0.5, &extent(vec![method]), &mut |_, _| ()).expect("references");
    let best = |study: &super::moved::MovedStudy| {
        let errors = study.points.iter().filter_map(|point| match point.outcome {
            Outcome::Done { errors, .. } => Some(errors),
            Outcome::Refused(_) => None,
        });
        errors.min_by(|a, b| a.judged.total_cmp(&b.judged)).expect("a run")
    };
    let errors = best(&study);
    assert!(errors.multiplier < 1e-9 && errors.second < 1e-9 && errors.contact.is_nan(), "{errors:?}");
    // The rod is written twice: of its two multipliers neither is unique, and their sum on the coordinates is.
    let mut mechanism = moved(TwiceHeld::default());
    let study = moved_study(&mut mechanism, 0.5, &extent(vec![method]), &mut |_, _| ()).expect("references");
    let errors = best(&study);
    assert!(errors.multiplier.is_nan() && errors.second < 1e-9 && errors.judged < 1e-9, "{errors:?}");
}

mbs_runtime::mechanism! {
    /// A slide that two drawings hold, which differ by a misfit.
    pub mechanism Misfitting;
    param misfit: m = 10um;
    coord x: m = 0;
    coord y: m = 0;
    drive slide: x == 1 [m/s]*t;
    constraint follows { y == x; }
    constraint holds redundant within 20um { y == x + misfit; }
}

#[test]
fn a_row_that_contradicts_others_within_its_width_is_the_reason_of_a_refusal() {
    let Comparable::Driven(mechanism) = comparable(&Misfitting::default()) else {
        panic!("a drive moves it")
    };
    let row = mechanism.exact.row_with_width();
    assert_eq!(row, Some("holds"));
    assert!(open_rows(0.0, row).contains("`holds` follows from other rows within a width"));
    let Comparable::Driven(mechanism) = comparable(&CrankSlider::default()) else {
        panic!("a drive moves it")
    };
    assert_eq!(mechanism.exact.row_with_width(), None);
}

//! A block on a slope, its normal force a multiplier: at rest, sliding, and coming to rest.

use mbs_runtime::dynamics::{
    Baumgarte, DormandPrince8, Embedded, Explicit, Formulation, Projection, Radau5, RungeKutta4, Simulation,
    Tolerance, Unstabilized, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A block on a slope of 30°.
    pub mechanism Slope;
    const ALPHA: rad = 30deg;
    param mus: 1 = 0.6;
    param mud: 1 = 0.3;
    param v0: m/s = 0;
    coord P: [m; 2] = [0, 0];
    body block { mass: 2kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    constraint ground { dot(P, unit(ALPHA + 90deg)) == 0m; }
    friction rub { along: dot(P, unit(ALPHA)), normal: lambda(ground), coefficient: mud, sticks: mus }
    start P = [0, 0] rate v0*unit(ALPHA);
    out way: m = dot(P, unit(ALPHA));
    out speed: m/s = der(dot(P, unit(ALPHA)));
    out pull: N = force(rub);

}

const G: f64 = 9.81;

fn rests<F: Formulation<Slope<f64>, f64, 2, 1>>(formulation: F) {
    let method = Explicit::new(RungeKutta4, formulation);
    let mut run = Simulation::start_from_text(Slope::default(), method, 0.0_f64).expect("it starts");
    run.step_to(1000.0, 2000).expect("it rests");
    let [way, speed] = run.outputs().map(|output| output.value);
    assert!(way.abs() < 1e-20 && speed.abs() < 1e-20, "{way:e} {speed:e}");
    assert!((run.loads()[0] - 2.0 * G / 2.0).abs() < 1e-12, "{:?}", run.loads());
}

#[test]
fn below_the_limit_nothing_creeps_in_1000_seconds() {
    rests(Projection::default());
    rests(VelocityTransformation);
    rests(Unstabilized);
    rests(Baumgarte { xi: 1.0, omega: 1.0 });
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Slope::default(), method, 0.0_f64).expect("it starts");
    run.advance_to(1000.0).expect("it rests");
    assert!(run.outputs()[0].value.abs() < 1e-20, "{:?}", run.instant());
    let implicit = Explicit::new(Radau5, Projection::default());
    let mut run = Simulation::start_from_text(Slope::default(), implicit, 0.0_f64).expect("it starts");
    run.advance_to(1000.0).expect("it rests");
    assert!(run.outputs()[0].value.abs() < 1e-20, "{:?}", run.instant());
    let mut single = Simulation::start_from_text(Slope::<f32>::default(), implicit, 0.0).expect("it starts");
    single.advance_to(1000.0).expect("it rests");
    assert!(single.outputs()[0].value.abs() < 1e-20, "{:?}", single.instant());
    let mut single = Simulation::start_from_text(Slope::<f32>::default(), method, 0.0).expect("it starts");
    single.advance_to(1000.0).expect("it rests");
    assert!(single.outputs()[0].value.abs() < 1e-20, "{:?}", single.instant());
}

#[test]
fn above_the_limit_it_slides_as_the_closed_form() {
    fn slides<I: Embedded>(integrator: I) {
        let slope = Slope { mus: 0.5, ..Slope::default() };
        let method = Explicit::new(integrator, Projection::default());
        let mut run = Simulation::start_from_text(slope, method, 0.0).expect("it starts");
        run.advance_to(2.0).expect("it slides");
        let way = -0.5 * G * (0.5 - 0.3 * 0.75_f64.sqrt()) * 4.0;
        assert!((run.outputs()[0].value - way).abs() < 1e-10, "{:?} {way}", run.instant());
        assert!((run.loads()[0] - 0.3 * 2.0 * G * 0.75_f64.sqrt()).abs() < 1e-10);
    }
    slides(DormandPrince8);
    slides(Radau5);
}

#[test]
fn uphill_it_comes_to_rest_and_stays() {
    let slope = Slope { v0: 1.0, ..Slope::default() };
    let deceleration = G * (0.5 + 0.3 * 0.75_f64.sqrt());
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(slope, method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(5.0).expect("it rests");
    let end = 0.5 / deceleration;
    assert!((run.outputs()[0].value - end).abs() < 1e-11, "{:?} {end}", run.instant());
    let before = *run.q();
    run.advance_to(500.0).expect("it rests");
    assert!(
        (run.q()[0] - before[0]).abs() < 1e-16 && run.outputs()[1].value.abs() < 1e-20,
        "{:?}",
        run.instant()
    );
    // Less friction lets it go, more friction catches it.
    run.change(|slope| slope.mus = 0.4);
    run.advance_to(500.1).expect("it slides");
    assert!(run.outputs()[1].value < -0.1, "{:?}", run.instant());
    run.change(|slope| (slope.mus, slope.mud) = (2.0, 1.5));
    run.advance_to(502.0).expect("it rests");
    assert!(run.outputs()[1].value.abs() < 1e-15, "{:?}", run.instant());
    let mut fixed =
        Simulation::start_from_text(slope, Explicit::new(RungeKutta4, Projection::default()), 0.0)
            .expect("it starts");
    fixed.step_to(1.0, 7).expect("it rests");
    assert!((fixed.outputs()[0].value - end).abs() < 1e-12, "{:?} {end}", fixed.instant());
}

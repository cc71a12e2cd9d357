//! Loops whose bars come in line several times: the rows lose rank, and the motion goes on.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Extrapolated, Method, MethodWarning, ProjectedStages, Projection, RungeKutta4,
    Simulation, Tolerance,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

use crate::linkage::{Linkage, parallel_loops};

/// The common angle of all uprights after 10 s from the vertical: θ̈ = (C/I) g sin θ with C = (n+1)/2 + n and
/// I = (n+1)/3 + n for n loops, by a method and code of its own.
fn exact_angle(loops: f64, speed: f64) -> f64 {
    let stiffness = 9.81 * ((loops + 1.0) / 2.0 + loops) / ((loops + 1.0) / 3.0 + loops);
    let (steps, h) = (50_000, 10.0 / 50_000.0);
    // Yoshida's composition of order 4 of the leapfrog: nothing in common with the integrators under test.
    let cube_root = 2.0_f64.cbrt();
    let outer = 1.0 / (2.0 - cube_root);
    let (mut angle, mut rate) = (0.0_f64, speed);
    for _ in 0..steps {
        for share in [outer, 1.0 - 2.0 * outer, outer] {
            angle += 0.5 * share * h * rate;
            rate += share * h * stiffness * angle.sin();
            angle += 0.5 * share * h * rate;
        }
    }
    angle
}

/// Distance of the first head from where it should be after 10 s.
fn error<X: Method<Linkage<N, M>, f64, N, M>, const N: usize, const M: usize>(
    method: X,
    (h, speed, angle): (f64, f64, f64),
) -> Result<f64, Failure> {
    let (linkage, q, qd) = parallel_loops::<N, M>(angle, speed);
    let mut simulation = Simulation::start(linkage, method, 0.0, q, qd)?;
    simulation.step_to(10.0, (10.0 / h).ceil() as u32)?;
    let turned = exact_angle((N / 2 - 1) as f64, speed) - angle;
    let [x, y] = [0, 1].map(|i| simulation.q()[i]);
    Ok((x - turned.sin()).hypot(y - turned.cos()))
}

fn projected() -> Explicit<RungeKutta4, Projection> {
    Explicit::default()
}

#[test]
fn the_exact_angle_is_the_published_one() {
    // Richardson limit of an independent code: (0.3284581, 0.9445185) for two loops.
    let angle = exact_angle(2.0, 1.0);
    assert!(
        (angle.sin() - 0.3284581115408154).abs() < 1e-9 && (angle.cos() - 0.944518538178601).abs() < 1e-9
    );
}

#[test]
fn one_and_two_loops_pass_ten_singular_positions() {
    assert!(error::<_, 4, 3>(projected(), (1e-3, 1.0, 0.0)).unwrap() < 1e-8);
    assert!(error::<_, 6, 5>(projected(), (1e-3, 1.0, 0.0)).unwrap() < 1e-8);
}

#[test]
fn stages_on_the_constraints_pass_singular_positions_too() {
    let method = Explicit::new(RungeKutta4, Projection { stages: ProjectedStages::All });
    for h in [1e-3, 5e-3] {
        let error = error::<_, 6, 5>(method, (h, 1.0, 0.0)).unwrap();
        println!("h = {h}: {error:.1e}");
        assert!(error < 1e-8 * (h / 1e-3).powi(4));
    }
}

#[test]
fn extrapolated_steps_pass_singular_positions_too() {
    for h in [0.025, 0.005] {
        let [one, two] =
            [error::<_, 4, 3>(Extrapolated, (h, 1.0, 0.0)), error::<_, 6, 5>(Extrapolated, (h, 1.0, 0.0))];
        let [one, two] = [one.unwrap(), two.unwrap()];
        let bound = 2.5e-2 * (h / 0.025_f64).powi(3);
        println!("extrapolated, N = 1 and 2, h = {h}: {one:.1e} {two:.1e} of {bound:.1e}");
        assert!(one < bound && two < bound);
    }
}

/// One loop whose second upright is longer by `excess` (m), from rest at half a radian from the vertical.
fn unequal(
    excess: f64,
    stages: ProjectedStages,
) -> Simulation<Linkage<4, 3>, Explicit<DormandPrince8, Projection>, f64, 4, 3> {
    let (mut linkage, ..) = parallel_loops::<4, 3>(0.0, 0.0);
    linkage.rods[1].length += excess;
    let (sine, cosine) = 0.5_f64.sin_cos();
    let q = [sine, cosine, 1.0 + sine, cosine];
    let method = Explicit::new(DormandPrince8, Projection { stages });
    Simulation::start_near(linkage, method, 0.0, q, [0.0; 4]).expect("it assembles")
}

/// Of [`unequal`] the largest angle
/// (rad) between both uprights before the first one is 0.3 m below its foot or 2 s are over, and the energy (J) that is not
/// accounted for.
fn with_a_longer_upright(excess: f64, stages: ProjectedStages) -> [f64; 2] {
    let mut run = unequal(excess, stages);
    let mut opened = 0.0_f64;
    while run.q()[1] > -0.3 && run.t() < 2.0 {
        run.advance_to(run.t() + 0.01).expect("it moves on");
        let [x1, y1, x2, y2] = *run.q();
        let (sine, cosine) = (x1 * y2 - y1 * (x2 - 1.0), x1 * (x2 - 1.0) + y1 * y2);
        opened = opened.max(sine.atan2(cosine).abs());
    }
    [opened, run.balance().defect.abs()]
}

#[test]
fn a_loop_whose_uprights_differ_turns_aside_where_its_bars_come_almost_in_line() {
    /// Of 15 J: it turns within 1e-4 of a second where the uprights differ by 1e-8.
    const DEFECT: f64 = 1e-5;
    for stages in [ProjectedStages::None, ProjectedStages::All] {
        for excess in [1e-4, -1e-4, 1e-6, -1e-6, 1e-8, -1e-8] {
            let [opened, defect] = with_a_longer_upright(excess, stages);
            println!(
                "uprights differ by {excess:e}: opened to {opened:.3}, energy {defect:.1e} of {DEFECT:e}"
            );
            assert!(opened > 3.0 && defect < DEFECT);
        }
        let [opened, defect] = with_a_longer_upright(0.0, stages);
        assert!(opened < 1e-9 && defect < 1e-8, "{opened:e} {defect:e}");
    }
}

#[test]
fn branches_that_rounding_decides_are_refused_by_strict_runs_at_most() {
    /// Of 15 J: what a turn that no step resolves may cost a loose run.
    const DEFECT: f64 = 1e-4;
    for excess in [1e-9, 3e-10, 1e-10, 5e-11, 2e-11, 1e-11] {
        for excess in [excess, -excess] {
            let mut loose = unequal(excess, ProjectedStages::None);
            loose.advance_to(2.0).unwrap_or_else(|failure| panic!("{excess:e}: {failure}"));
            assert!(loose.balance().defect.abs() < DEFECT, "{excess:e}: {:e} J", loose.balance().defect);
            let mut strict = unequal(excess, ProjectedStages::None).with_tolerance(Tolerance::new(1e-11));
            if let Err(failure) = strict.advance_to(2.0) {
                assert_undecided_in_line(failure, strict.t(), [strict.q()[1], strict.q()[3]]);
            }
        }
    }
}

/// A failure of a run that stays at `reached` (s) says that rounding decides. The rods, of 1 m, are in line there: both heads, at the
/// heights `heads` (m), are on the line of the feet.
#[track_caller]
fn assert_undecided_in_line(failure: Failure, reached: f64, heads: [f64; 2]) {
    /// Height (m) of a head: at some m/s the rods are within it for less than a thousandth of the run.
    const IN_LINE: f64 = 1e-3;
    let Failure { kind: FailureKind::Undecided { margin, .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    assert!(heads.iter().all(|height| height.abs() < IN_LINE), "{heads:?}: {failure}");
    assert!(margin < 1e-2, "{failure}");
    assert!((time - 0.05..=time).contains(&reached), "{reached}: it stays where the last step ended");
    assert!(failure.to_string().contains("loosen the tolerance"), "{failure}");
}

mechanism! {
    /// A parallelogram of light rods with a point mass on each head, on which a force turns over where all rods are in line.
    mechanism Switching;
    param jump: N = 0;
    coord p: [m; 2] = [0, 1];
    coord r: [m; 2] = [1, 1];
    body left { mass: 1, com: p }
    body right { mass: 1, com: r }
    force gate: [0, jump/2*sign(p[1])] on p;
    constraint rods {
        dot(p, p) == 1 [m^2];
        dot(r - [1m, 0], r - [1m, 0]) == 1 [m^2];
        dot(r - p, r - p) == 1 [m^2];
    }
    start p = [0, 1] rate [2, 0];
    start r = [1, 1] rate [2, 0];
}

#[test]
fn a_force_that_jumps_in_line_stops_a_strict_run_and_no_loose_one() {
    // Half of the jump moves both masses; a step of 1e-7 rad, the least in line, leaves 2.5e-8 m/s of it: five decades above the strict
    // tolerance, a decade below the loose one.
    const JUMP: f64 = 1.0;
    let run = |jump: f64, tolerance: f64| {
        let switching: Switching = Switching { jump };
        let method = Explicit::new(DormandPrince8, Projection { stages: ProjectedStages::None });
        let run = Simulation::start_from_text(switching, method, 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        (run.advance_to(2.0), run)
    };
    let (smooth, _) = run(0.0, 1e-12);
    smooth.expect("no force: the heads go round");
    let (loose, after) = run(JUMP, 1e-6);
    loose.expect("the jump is below what the tolerance sees");
    assert!(after.t() == 2.0 && after.q()[1] < 0.0, "{:?}", after.q());
    let (strict, stopped) = run(JUMP, 1e-12);
    let failure = strict.expect_err("no step keeps the tolerance");
    // cos θ = y from θ = 0: θ̈ = −(jump/4) sin θ, θ̇(0) = 2, to a right angle; by the mean of 1/θ̇.
    let slowness = |theta: f64| 1.0 / (4.0 - JUMP / 2.0 * (1.0 - theta.cos())).sqrt();
    let parts = 1000;
    let width = core::f64::consts::FRAC_PI_2 / f64::from(parts);
    let in_line = (0..parts).map(|part| slowness((f64::from(part) + 0.5) * width) * width).sum::<f64>();
    assert!((stopped.t() - in_line).abs() < 0.01, "{}: {failure}", stopped.t());
    assert_undecided_in_line(failure, stopped.t(), [stopped.q()[1], stopped.q()[3]]);
}

mechanism! {
    /// A parallelogram with a point mass on each head. A second row for the first rod says the same wherever its factor is one number;
    /// elsewhere it does so where the rod has its length alone.
    mechanism Tied;
    param above: 1/m = 0;
    param below: 1/m = 0;
    coord p: [m; 2] = [0, 1];
    coord r: [m; 2] = [1, 1];
    body left { mass: 1, com: p }
    body right { mass: 1, com: r }
    constraint rods {
        dot(p, p) == 1 [m^2];
        dot(r - [1m, 0], r - [1m, 0]) == 1 [m^2];
        dot(r - p, r - p) == 1 [m^2];
    }
    constraint tie redundant {
        (dot(p, p) - 1 [m^2])*(1 + above*p[0]*max(p[1], 0)/1m + below*p[0]*max(-p[1], 0)/1m) == 0;
    }
    start p = [0, 1] rate [2, 0];
    start r = [1, 1] rate [2, 0];
}

type Run = Simulation<Tied, Explicit<RungeKutta4, Projection>, f64, 4, 4>;

fn tied(above: f64, below: f64, stages: ProjectedStages) -> Run {
    let method = Explicit::new(RungeKutta4, Projection { stages });
    Simulation::start_from_text(Tied { above, below }, method, 0.0).expect("it starts")
}

#[test]
fn a_rank_that_rises_behind_a_change_is_noticed() {
    assert_eq!(tied(0.5, 0.0, ProjectedStages::None).doubt(1e-3), Some(MethodWarning::RisingRank));
    let mut run = tied(0.0, 0.0, ProjectedStages::None);
    run.step_to(0.1, 100).expect("it moves");
    assert_eq!(run.doubt(1e-3), None);
    run.change(|tied| tied.above = 0.5);
    run.step(1e-3).expect("it moves");
    assert_eq!(run.doubt(1e-3), Some(MethodWarning::RisingRank));
    let mut run = tied(0.0, 0.0, ProjectedStages::WhereNeeded);
    run.step(1e-3).expect("it moves");
    assert_eq!(run.counts().projected_stages, 0);
    run.change(|tied| tied.above = 0.5);
    run.step(1e-3).expect("it moves");
    assert_eq!(run.counts().projected_stages, 4 + 1, "all stages, and the changed state");
}

#[test]
fn a_rank_that_rises_behind_a_singular_position_is_noticed() {
    let mut run = tied(0.0, 0.5, ProjectedStages::None);
    // In line after a quarter turn at 2 rad/s, 0.785 s.
    run.step_to(0.7, 70).expect("it moves");
    assert_eq!(run.doubt(1e-2), None);
    run.step_to(0.9, 20).expect("it moves");
    assert_eq!(run.doubt(1e-2), Some(MethodWarning::RisingRank));
    assert!(run.passage().is_some());
    let mut twice = tied(0.0, 0.0, ProjectedStages::None);
    twice.step_to(0.9, 90).expect("it moves");
    assert_eq!(twice.doubt(1e-2), None);
}

//! D2: a four-bar whose bars 1/2.5/2/3.5 come in line once a turn, at which plain steps change to its other assembly.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, RungeKutta4, Simulation, Tolerance,
    VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, mechanism};

mechanism! {
    /// Light bars of 1, 2.5 and 2 m over a distance of 3.5 m, with 1 kg on each joint, in bar angles.
    pub mechanism FourBar;
    param speed: rad/s = 6;
    coord p1: rad = 0.5;
    coord p2: rad = 0.6;
    coord p3: rad = 2;
    body crank { mass: 1, com: 1m*unit(p1) }
    body rocker { mass: 1, com: [3.5m, 0] + 2m*unit(p3) }
    gravity weight { acceleration: [0, -2] }
    constraint closure { 1m*unit(p1) + 2.5m*unit(p2) == [3.5m, 0] + 2m*unit(p3); }
    start p1 = 0.5 rate speed;
}

const GRAVITY: f64 = 2.0;

/// The rocker's joint with the crank at `angle` (rad): the branch changes its side at each position in line, angles π, 3π, …
fn rocker_joint(angle: f64) -> [f64; 2] {
    let (dx, dy) = (3.5 - angle.cos(), -angle.sin());
    let square = dx * dx + dy * dy;
    let along = (square + 6.25 - 4.0) / (2.0 * square);
    let height = (6.25 / square - along * along).max(0.0).sqrt() * (angle / 2.0).cos().signum();
    [angle.cos() + along * dx - height * dy, angle.sin() + along * dy + height * dx]
}

/// Inertia about the crank's angle (kg m²), and potential energy (J).
fn inertia_and_potential(angle: f64) -> [f64; 2] {
    let [x, y] = rocker_joint(angle);
    // (B′ − A′)·(B − A) = 0 with B′ across the rocker and A′ across the crank.
    let (dx, dy) = (x - angle.cos(), y - angle.sin());
    let slope = (-angle.sin() * dx + angle.cos() * dy) / (-y * dx + (x - 3.5) * dy);
    [1.0 + 4.0 * slope * slope, GRAVITY * (angle.sin() + y)]
}

/// The time (s) that the crank takes from 0.5 rad at `speed` (rad/s) to `end` (rad): the quadrature of 1/φ̇, φ̇ from the energy.
pub fn time(speed: f64, end: f64) -> f64 {
    // Gauss's points and weights of order 10; panels end where the bars are in line.
    const POINTS: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    const PANELS: u32 = 60;
    let [inertia, potential] = inertia_and_potential(0.5);
    let energy = 0.5 * inertia * speed * speed + potential;
    let slowness = |angle: f64| {
        let [inertia, potential] = inertia_and_potential(angle);
        (0.5 * inertia / (energy - potential)).sqrt()
    };
    let (mut from, mut sum) = (0.5, 0.0);
    while from < end {
        let line = ((from / core::f64::consts::PI + 1e-9).floor() + 1.0) * core::f64::consts::PI;
        let to = line.min(end);
        let half = (to - from) / f64::from(2 * PANELS);
        for panel in 0..PANELS {
            let middle = from + (2.0 * f64::from(panel) + 1.0) * half;
            sum += POINTS.iter().map(|(x, weight)| weight * slowness(middle + x * half)).sum::<f64>() * half;
        }
        from = to;
    }
    sum
}

const SECONDS: f64 = 10.0;

/// Error of the crank's angle (rad) after ten seconds, and the energy defect (J).
fn judged(speed: f64, angle: f64, rate: f64, defect: f64) -> [f64; 2] {
    [((time(speed, angle) - SECONDS) * rate).abs(), defect.abs()]
}

fn adaptive<S, F, const N: usize, const M: usize>(
    text: S,
    formulation: F,
    speed: f64,
    tolerance: f64,
) -> Result<[f64; 2], Failure>
where
    S: Dynamic<f64, N, M>,
    F: Formulation<S, f64, N, M> + Copy,
{
    let run = Simulation::start_from_text(text, Explicit::new(DormandPrince8, formulation), 0.0)
        .expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(tolerance));
    run.advance_to(SECONDS)?;
    Ok(judged(speed, run.q()[0], run.qd()[0], run.balance().defect))
}

#[test]
fn a_four_bar_with_its_bars_in_line_stays_on_its_branch() {
    // Errors of the energy come back as errors of time over ten seconds: 1e3 times the tolerance of a step.
    const ANGLE: f64 = 1e3;
    for tolerance in [1e-7, 1e-9, 1e-11] {
        let mut largest = [0.0_f64; 2];
        for k in 0..16 {
            let speed = 6.0 + 0.02 * f64::from(k);
            let runs = [
                adaptive::<_, _, 3, 2>(FourBar { speed }, Projection::default(), speed, tolerance),
                adaptive::<_, _, 3, 2>(FourBar { speed }, VelocityTransformation, speed, tolerance),
            ];
            for run in runs {
                let [angle, defect] =
                    run.unwrap_or_else(|failure| panic!("{speed} rad/s, {tolerance:e}: {failure}"));
                largest = [largest[0].max(angle), largest[1].max(defect)];
            }
        }
        println!(
            "four-bar, tolerance {tolerance:e}: angle {:.1e} rad, energy {:.1e} J",
            largest[0], largest[1]
        );
        assert!(largest.iter().all(|error| *error < ANGLE * tolerance));
    }
}

#[test]
fn fixed_steps_take_a_four_bar_through_positions_in_line_on_its_branch() {
    let (mut largest, mut refused) = ([0.0_f64; 2], 0);
    for count in (6000..18000).step_by(100) {
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut run = Simulation::start_from_text(FourBar { speed: 6.0 }, method, 0.0).expect("it starts");
        if run.step_to(SECONDS, count).is_err() {
            refused += 1;
            continue;
        }
        // Of order 4: the error of a smooth motion at 6000 steps, smaller at more.
        let coarse = (6000.0 / f64::from(count)).powi(4);
        let found = judged(6.0, run.q()[0], run.qd()[0], run.balance().defect);
        largest = [largest[0].max(found[0] / coarse), largest[1].max(found[1])];
    }
    println!(
        "four-bar, 120 fixed step counts: angle {:.1e}, energy {:.1e} J, {refused} refused",
        largest[0], largest[1]
    );
    // Of 60 J, and of order 4: the error of a smooth motion at 6000 steps. Steps next to positions in line are taken in parts.
    assert!(largest[1] < 1e-6 && largest[0] < 1e-6 && refused == 0);
}

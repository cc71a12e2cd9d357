//! The slider-crank with clearance between slider and guide of Flores, Leine and Glocker (Multibody System Dynamics 23, 2010): four corners, two
//! walls. `data/clearance.py` solves it with SciPy in three angles; here it is in the places of all bodies, with rows for the pins.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::mechanism;

mechanism! {
    /// Crank, rod, and a slider with play in its guide.
    pub mechanism Loose;
    const A: m = 0.05;
    const B: m = 0.025;
    const PLAY: m = 1mm;
    const CRANK: m = 0.153;
    const ROD: m = 0.306;
    param mu: 1 = 0.1;
    coord c: [m; 2] = [0.0765, 0];
    coord r: [m; 2] = [0.306, 0];
    coord p: [m; 2] = [0.459, 0];
    coord a: [rad; 3] = 0;
    body crank { mass: 0.038, com: c, inertia: 7.4e-5, angle: a[0] }
    body rod { mass: 0.038, com: r, inertia: 5.9e-4, angle: a[1] }
    body slider { mass: 0.076, com: p, inertia: 2.7e-6, angle: a[2] }
    gravity weight { acceleration: [0, -9.81] }
    constraint bearing { c == CRANK/2*unit(a[0]); }
    constraint crank_pin { c + CRANK/2*unit(a[0]) == r - ROD/2*unit(a[1]); }
    constraint slider_pin { r + ROD/2*unit(a[1]) == p; }
    for i in 0..2 {
        for j in 0..2 {
            let corner = p + (2*i - 1)*A*unit(a[2]) + (2*j - 1)*B*unit(a[2] + 90deg);
            contact wall { gap: B + PLAY - (2*j - 1)*corner[1], stiffness: 1e6, damping: 0.3 }
            friction rub { along: corner[0], normal: normal(wall[2*i + j]), coefficient: mu, speed: 0.1 }
            out push: N = force(wall[2*i + j]);
        }
    }
    start c = [0.0765, 0] rate [0, 11.475];
    start r = [0.306, 0] rate [0, 11.475];
    start p = [0.459, 0] rate [0, 0];
    start a = 0 rate [150, -75, 0];
}

#[test]
fn a_slider_with_play_moves_as_by_equations_in_three_angles() {
    let reference = include_str!("../data/clearance.txt");
    let rows: Vec<Vec<f64>> = reference
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').map(|number| number.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.len(), 30);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Loose::default(), method, 0.0_f64).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let stiff = Explicit::new(Radau5, Projection::default());
    let implicit = Simulation::start_from_text(Loose::default(), stiff, 0.0_f64).expect("a start");
    let mut implicit = implicit.with_tolerance(Tolerance::new(1e-10));
    let mut worst = [0.0_f64; 3];
    let mut is_hit = [false; 4];
    for row in &rows {
        run.advance_to(row[0]).expect("a motion");
        implicit.advance_to(row[0]).expect("a motion");
        for k in 0..3 {
            worst[0] = worst[0].max((run.q()[6 + k] - row[1 + k]).abs());
            worst[1] = worst[1].max((run.qd()[6 + k] - row[4 + k]).abs() / 150.0);
            worst[2] = worst[2].max((implicit.q()[6 + k] - row[1 + k]).abs());
        }
        for (hit, push) in is_hit.iter_mut().zip(run.outputs()) {
            *hit |= push.value > 0.0;
        }
    }
    println!(
        "slider with play: angles {:.1e}, rates {:.1e} of 150 rad/s; by Radau {:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(worst[0] < 1e-10 && worst[1] < 1e-10 && worst[2] < 1e-8, "{worst:?}");
    assert!(is_hit.iter().filter(|hit| **hit).count() > 1, "{is_hit:?}");
}

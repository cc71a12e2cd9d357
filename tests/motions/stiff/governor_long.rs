//! The stiff flyball governor of IFToMM benchmark A05 for 1000 s: 700 swings, 900 turns, dampers that decay in 3e-5 s. `data/governor.py` solves it
//! with SciPy in slope and height; here it is in 16 coordinates with 12 rows.

use mbs_runtime::dynamics::{Explicit, Projection, Radau5, Simulation, Tolerance};

use super::texts::Governor;

#[test]
fn a_thousand_seconds_of_the_governor_keep_height_angle_energy_and_rows() {
    let rows: Vec<[f64; 3]> = include_str!("../data/governor.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().expect("a number")).collect();
            numbers.try_into().expect("three numbers a line")
        })
        .collect();
    assert_eq!((rows.len(), rows[64][0]), (65, 1000.0));
    let method = Explicit::new(Radau5, Projection::default());
    let run = Simulation::start_from_text(Governor::<f64>::default(), method, 0.0_f64).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-8));
    let [mut height, mut angle, mut defect, mut open] = [0.0_f64; 4];
    for [t, s, phi] in rows {
        run.advance_to(t).expect("a motion");
        height = height.max((run.q()[1] - s).abs());
        angle = angle.max((run.q()[0] - phi).abs());
        let balance = run.balance();
        defect = defect.max(balance.defect.abs() / balance.energy.kinetic);
        open = open.max(balance.phi);
    }
    println!(
        "governor for 1000 s: s {height:.1e} m, phi {angle:.1e} rad of 5603, energy {defect:.1e} of the kinetic one, rows {open:.1e}"
    );
    assert!(height < 1e-5 && angle < 1e-4 && defect < 1e-6 && open < 1e-10, "see the line above");
}

//! Tests of `mechanisms::car_axis`.

use crate::reference::{dynamics_of, table};
use mechanisms::car_axis::*;

/// Bounds of the differences, relative to the run's largest position, velocity and multiplier.
const BOUNDS: [f64; 3] = [1e-9, 1e-8, 1e-7];

#[test]
fn positions_velocities_and_multipliers_are_the_published_ones() {
    let reference = table(include_str!("../data/car_axis.csv"));
    let found = dynamics_of(&CARD, 0, 12);
    let forces = found.motion.dynamics.as_ref().expect("it has masses");
    let positions = found.motion.coordinates.iter().map(|coordinate| &coordinate.q);
    let velocities = found.motion.coordinates.iter().map(|coordinate| &coordinate.qd);
    let multipliers = forces.multipliers.iter().map(|multiplier| &multiplier.value);
    let groups: [Vec<&Vec<f64>>; 3] = [positions.collect(), velocities.collect(), multipliers.collect()];
    let (mut first, mut sign) = (1, 1.0);
    for ((columns, bound), name) in groups.iter().zip(BOUNDS).zip(["q", "q̇", "λ"]) {
        // The multipliers of the start are not in the table, the others stand on the other side of the equation.
        let rows = reference.iter().enumerate().skip(usize::from(columns.len() == 2));
        let entries = rows.flat_map(|(row, values)| {
            columns.iter().enumerate().map(move |(i, column)| (column[row], sign * values[first + i]))
        });
        let entries: Vec<(f64, f64)> = entries.collect();
        let largest = entries.iter().fold(0.0, |largest: f64, (_, value)| largest.max(value.abs()));
        let error = entries.iter().fold(0.0, |error: f64, (a, b)| error.max((a - b).abs()));
        println!("car axis: {name} {:.1e} of {bound:e}", error / largest);
        assert!(error < bound * largest, "{error:e} of {largest}");
        first += columns.len();
        sign = if first == 9 { -1.0 } else { 1.0 };
    }
    let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!(most(&forces.defect) < 1e-9 * most(&forces.work), "{:e}", most(&forces.defect));
}

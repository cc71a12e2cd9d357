//! Velocities of a reference on one side of an event, between its instants and beyond them.

use mbs_runtime::Scalar;

use crate::cost::reference::Shot;
use crate::double_double::DoubleDouble as D;

/// Most instants that a velocity is continued from.
const MOST: usize = 4;

/// Velocities at `t` (s) of the motion whose instants are `piece`, without events between them: polynomials through q̇ and q̈ at the
/// nearest four. The second list is what one instant fewer changes. None where the piece has fewer than two.
pub fn continued<'a>(piece: impl Iterator<Item = &'a Shot>, t: f64) -> Option<[Vec<D>; 2]> {
    let mut nearest: Vec<&Shot> = piece.collect();
    nearest.sort_by(|a, b| (a.at.t.high - t).abs().total_cmp(&(b.at.t.high - t).abs()));
    nearest.truncate(MOST);
    let [fewer @ .., _] = &nearest[..] else { return None };
    let count = fewer.first()?.at.qd.len();
    let of = |shots: &[&Shot]| (0..count).map(|j| hermite(shots, j, D::constant(t))).collect::<Vec<D>>();
    let (all, less) = (of(&nearest), of(fewer));
    let changes = all.iter().zip(&less).map(|(all, less)| *all - *less).collect();
    Some([all, changes])
}

/// Hermite's polynomial through q̇ and q̈ of coordinate `j` at `t` (s), by divided differences over each instant taken twice.
fn hermite(shots: &[&Shot], j: usize, t: D) -> D {
    let node = |i: usize| shots[i / 2].at.t;
    let mut differences: Vec<D> = (0..2 * shots.len()).map(|i| shots[i / 2].at.qd[j]).collect();
    for order in 1..differences.len() {
        for i in (order..differences.len()).rev() {
            let is_double = order == 1 && i % 2 == 1;
            differences[i] = match is_double {
                true => shots[i / 2].qdd[j],
                false => (differences[i] - differences[i - 1]) / (node(i) - node(i - order)),
            };
        }
    }
    let sum = |sum: D, (i, difference): (usize, &D)| sum * (t - node(i)) + *difference;
    differences.iter().enumerate().rev().fold(D::constant(0.0), sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::reference::motion::shot_of;

    #[test]
    fn a_velocity_is_continued_with_the_order_of_its_instants() {
        // q̇ = sin t.
        let shots: Vec<Shot> = (0..6)
            .map(|k| 0.05 * f64::from(k))
            .map(|t| shot_of(t, vec![1.0 - t.cos()], vec![t.sin()], vec![t.cos()]))
            .collect();
        let [value, change] = continued(shots.iter(), 0.29).expect("six instants");
        let error = (value[0].high - 0.29_f64.sin()).abs();
        // 8 nodes: the product of distances over 8!.
        assert!(error < 1e-13 && error < change[0].high.abs(), "{error:e} {:e}", change[0].high);
        let [value, change] = continued(shots[4..].iter(), 0.29).expect("two instants");
        let error = (value[0].high - 0.29_f64.sin()).abs();
        assert!(error > 1e-9 && error < change[0].high.abs(), "{error:e} {:e}", change[0].high);
        assert!(continued(shots[5..].iter(), 0.29).is_none());
    }
}

//! Drawn points that are no outputs: centres of mass, pins, values of the text, evaluated over a motion.

use mbs_codegen::picture::Picture;
use serde::Serialize;

use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::facade::AnyEquations;
use crate::motion::Motion;

/// A component of a drawn place over the time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceCurve {
    /// Name with the component, `ball.com.0`; of an angle the name.
    pub name: String,
    /// Values (m, rad).
    pub value: Vec<f64>,
    /// Real and imaginary part of its displacement in each mode.
    pub modes: Vec<[f64; 2]>,
}

/// Step of the difference that gives displacements in a mode, of a largest coordinate of 1: the root of rounding.
const STEP: f64 = 1e-8;

/// Places of `picture` that are neither outputs nor coordinates of `mechanism`, over `motion` and in its small motions.
pub fn places(
    picture: &Picture,
    mechanism: &dyn AnyEquations,
    motion: &Motion,
    small: Option<&SmallMotions>,
) -> Vec<PlaceCurve> {
    let coordinates = mechanism.coordinates();
    let named = picture.places().iter().enumerate().filter(|(_, place)| {
        !place.is_output && coordinates.iter().all(|coordinate| coordinate.name != place.name)
    });
    let components = named.flat_map(|(index, place)| {
        (0..place.kind.components()).map(move |component| {
            let name = match place.kind.components() {
                1 => place.name.clone(),
                _ => format!("{}.{component}", place.name),
            };
            (index, component, name)
        })
    });
    let components: Vec<(usize, usize, String)> = components.collect();
    if components.is_empty() {
        return Vec::new();
    }
    let count = mechanism.variables().len();
    let at = |k: usize, shift: &dyn Fn(usize) -> f64| {
        let column = |pick: fn(&crate::motion::CoordinateCurve) -> &Vec<f64>| -> Vec<f64> {
            motion.coordinates.iter().map(|curve| pick(curve).get(k).copied().unwrap_or(f64::NAN)).collect()
        };
        let (mut q, qd, qdd) = (column(|c| &c.q), column(|c| &c.qd), column(|c| &c.qdd));
        q.iter_mut().enumerate().for_each(|(index, value)| *value += shift(index));
        let t = motion.time[k];
        let variables: Vec<f64> =
            (0..count).map(|index| mechanism.get_at(index, t).unwrap_or(f64::NAN)).collect();
        picture.points([&q, &qd, &qdd], t, &variables)
    };
    let points: Vec<_> = (0..motion.time.len()).map(|k| at(k, &|_| 0.0)).collect();
    let last = motion.time.len().saturating_sub(1);
    // Central differences along the real and along the imaginary part of each shape.
    let along = |shape: &[[f64; 2]], part: usize| {
        let moved = |step: f64| at(last, &|index| step * shape.get(index).map_or(0.0, |value| value[part]));
        (moved(-STEP), moved(STEP))
    };
    let modes = small.map_or(&[][..], |small| &small.modes);
    let displaced: Vec<_> =
        modes.iter().map(|mode| [0, 1].map(|part| along(&mode.coordinates, part))).collect();
    let curve = |(place, component, name): (usize, usize, String)| PlaceCurve {
        name,
        value: points.iter().map(|points| points[place][component]).collect(),
        modes: displaced
            .iter()
            .map(|parts| {
                let slope = |(low, high): &(Vec<[f64; 3]>, Vec<[f64; 3]>)| {
                    (high[place][component] - low[place][component]) / (2.0 * STEP)
                };
                [slope(&parts[0]), slope(&parts[1])]
            })
            .collect(),
    };
    components.into_iter().map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::erased::erase::erase;

    mbs_runtime::mechanism! {
        pub mechanism Swing;
        param L: m = 0.5;
        coord phi: rad;
        body bob { mass: 2kg, com: L*[sin(phi), -cos(phi)] }
        gravity weight { acceleration: [0, -9.81] }
        start phi = 0.3 rate 0;
        let middle = L/2*[sin(phi), -cos(phi)];
        draw joint bob.com;
        trace middle;
    }

    #[test]
    fn points_that_are_no_outputs_move_with_the_motion_and_with_its_modes() {
        let mechanism = erase(Swing::default());
        let picture = mbs_codegen::picture(mechanism.equations().source(), None).expect("a text");
        let dynamics = mechanism.dynamics().expect("it has masses");
        let rest = dynamics.rest(&[]).expect("it hangs");
        let small = dynamics.small_motions(&rest.motion).expect("it swings");
        let found = places(&picture, mechanism.equations(), &rest.motion, Some(&small));
        let names: Vec<&str> = found.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["bob.com.0", "bob.com.1", "middle.0", "middle.1"]);
        // It hangs, and a mode of one radian moves the bob by L.
        for (curve, [value, displacement]) in
            found.iter().zip([[0.0, 0.5], [-0.5, 0.0], [0.0, 0.25], [-0.25, 0.0]])
        {
            assert!((curve.value[0] - value).abs() < 1e-9, "{curve:?}");
            assert!((curve.modes[0][0].abs() - displacement).abs() < 1e-7, "{curve:?}");
        }
    }
}

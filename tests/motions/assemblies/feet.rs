//! Feet on curves that the library has not seen, against a search of all places of the curve.

use core::f64::consts::TAU;

use mbs_runtime::driver::{Harmonic, Polynomial4567, Segment, Segments, nearest_foot, reach};
use mbs_runtime::{Function, Interval, Scalar};

use crate::linkages::follow::Random;

/// Σ of waves with a bump: a function of the caller.
#[derive(Clone)]
struct Unseen {
    waves: Vec<Harmonic>,
    bump: Segments<Polynomial4567, 3>,
}

impl Unseen {
    fn any(random: &mut Random) -> Self {
        let wave = |k: usize, random: &mut Random| Harmonic {
            offset: 0.0,
            amplitude: 0.004 * random.between(0.0, 1.0) / k as f64,
            frequency: k as f64,
            phase: TAU * random.between(0.0, 1.0),
        };
        let waves = (1..8).map(|k| wave(k, random)).collect();
        let width = 10.0_f64.powf(-3.0 + 2.5 * random.between(0.0, 1.0));
        let height = (random.between(0.0, 1.0) - 0.3) * 0.2 * width;
        let at = TAU * random.between(0.0, 1.0);
        let parts = [
            Segment::to(0.03 + height, at + 0.5 * width),
            Segment::to(0.03, at + width),
            Segment::dwell(at + TAU),
        ];
        let bump = Segments::new(at, parts).expect("a law");
        Unseen { waves, bump }
    }
}

impl<T: Scalar> Function<T> for Unseen {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let mut sum: [T; K] = self.bump.jet(x);
        for wave in &self.waves {
            sum.iter_mut().zip(wave.jet::<K>(x)).for_each(|(sum, term)| *sum = *sum + term);
        }
        sum
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let mut sum: [Interval<f64>; K] = Function::<T>::enclosure(&self.bump, from, to)?;
        for wave in &self.waves {
            let terms = Function::<T>::enclosure::<K>(wave, from, to)?;
            sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum = *sum + term);
        }
        Some(sum)
    }
}

/// A curve whose places at 1e6 angles are known.
fn places(curve: &impl Function<f64>) -> Vec<[f64; 2]> {
    let place = |k: u32| {
        let w = TAU * f64::from(k) / 1e6;
        let [r] = curve.jet(w);
        [r * w.cos(), r * w.sin()]
    };
    (0..1_000_000).map(place).collect()
}

#[test]
fn unseen_curves_have_the_feet_that_a_search_of_a_million_places_finds() {
    let mut random = Random(7);
    let mut errors = 0.0_f64;
    for _ in 0..4 {
        let curve = Unseen::any(&mut random);
        let places = places(&curve);
        let [inside, outside] = reach::<f64, _>(&curve).expect("bounds");
        for _ in 0..8 {
            let (far, towards) = (0.07 * random.between(0.0, 1.0), TAU * random.between(0.0, 1.0));
            let point = [far * towards.cos(), far * towards.sin()];
            let off = |k: usize| (places[k][0] - point[0]).hypot(places[k][1] - point[1]);
            let least = (0..places.len()).map(off).fold(f64::INFINITY, f64::min);
            let foot = nearest_foot(&curve, point).expect("a foot");
            // Places are 0.3 um apart: the nearest one is farther by no more than the square of that over twice the distance.
            let gap = least - foot.distance.abs();
            errors = errors.max(gap.abs());
            assert!(
                (-1e-15..1e-10).contains(&gap) || (0.0..4e-7).contains(&gap) && least < 1e-4,
                "{gap:e} {least}"
            );
            let [r] = Function::<f64>::jet(&curve, towards);
            assert_eq!(foot.distance < 0.0, far < r, "{foot:?}");
            // Nearer than the reach no other minimum of the distance is as near.
            let reach = if foot.distance < 0.0 { inside } else { outside };
            if foot.distance.abs() < reach {
                let minima = (0..places.len()).filter(|k| {
                    let [before, after] = [(k + places.len() - 1) % places.len(), (k + 1) % places.len()];
                    off(*k) < off(before) && off(*k) <= off(after) && off(*k) < reach * (1.0 - 1e-6)
                });
                assert_eq!(minima.count(), 1, "{point:?}");
            }
        }
    }
    println!("feet against 1e6 places: {errors:.1e} m");
}

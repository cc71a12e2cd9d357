use crate::dynamics::integrators::event::Scrutiny;
use crate::dynamics::integrators::event::group::{GROUP, Watched, first_beyond};
use crate::dynamics::integrators::event::passage;
use crate::dynamics::integrators::event::passage::Passage;

extern crate std;
use std::boxed::Box;
use std::vec::Vec;

/// Functions of the time with the number of instants at which they were evaluated.
struct Functions {
    members: Vec<Box<dyn Fn(f64) -> f64>>,
    instants: u32,
    cleared: Vec<usize>,
}

impl Functions {
    fn of(members: Vec<Box<dyn Fn(f64) -> f64>>) -> Self {
        Functions { members, instants: 0, cleared: Vec::new() }
    }
}

impl Watched<f64> for Functions {
    fn count(&self) -> usize {
        self.members.len()
    }

    fn values(&mut self, t: f64, first: usize, values: &mut [f64; GROUP]) {
        self.instants += 1;
        for (value, member) in values.iter_mut().zip(self.members.iter().skip(first)) {
            *value = member(t);
        }
    }

    fn positive(&self, _: usize) -> bool {
        false
    }

    fn scrutiny(&mut self, _: usize, _: f64) -> Scrutiny<f64> {
        Scrutiny::beyond()
    }

    fn clear_by_ends(&mut self, first: usize, _: (f64, f64), near: &mut [bool; GROUP]) {
        for member in &self.cleared {
            near[member - first] = false;
        }
    }
}

#[test]
fn a_group_that_is_clear_by_its_ends_is_not_evaluated() {
    let mut functions = Functions::of(std::vec![Box::new(|t| 1.0 + t), Box::new(|t| -1.0 - t)]);
    functions.cleared = std::vec![0, 1];
    assert_eq!(first_beyond(&mut functions, (0.0, 1.0)), Ok(None));
    assert_eq!(functions.instants, 0);
}

#[test]
fn a_near_miss_takes_nine_instants_and_a_passage_few_more() {
    let mut miss = Functions::of(std::vec![Box::new(|t| (t - 0.37) * (t - 0.37) + 1e-5)]);
    assert_eq!(first_beyond(&mut miss, (0.0, 1.0)), Ok(None));
    assert_eq!(miss.instants, 9);
    for place in [1e-6, 0.1, 1.0 / 3.0, 0.62, 1.0 - 1e-6] {
        let mut passage = Functions::of(std::vec![Box::new(move |t: f64| (place - t) * (2.0 + t.sin()))]);
        let (_, t) = first_beyond(&mut passage, (0.0, 1.0)).expect("numbers").expect("it passes");
        assert!((t - place).abs() < 1e-15 && place <= t + 1e-16, "{t} {place}");
        assert!(passage.instants <= 20, "{place}: {}", passage.instants);
    }
}

#[test]
fn the_first_member_of_several_wins_whatever_their_order() {
    for places in [[0.3, 0.7], [0.7, 0.3], [0.5, 0.5 + 1e-12]] {
        let members = places.map(|place| -> Box<dyn Fn(f64) -> f64> { Box::new(move |t| place - t) });
        let found = first_beyond(&mut Functions::of(members.into()), (0.0, 1.0));
        let (member, t) = found.expect("numbers").expect("both pass");
        let first = usize::from(places[1] < places[0]);
        assert!(member == first && (t - places[first]).abs() < 1e-15, "{places:?} {member} {t}");
    }
}

#[test]
fn windows_of_a_thousandth_of_a_step_are_found_in_a_group() {
    for width in [1e-1, 1e-2, 1e-3, 1e-4] {
        for index in 1..200 {
            let place = f64::from(index) / 200.0;
            let (one, other) = (place - 0.5 * width, place + 0.5 * width);
            if one <= 0.0 {
                continue;
            }
            let dip = move |t: f64| (t - one) * (t - other) * (1.0 + 0.3 * (3.0 * t).sin());
            let found = first_beyond(&mut Functions::of(std::vec![Box::new(dip)]), (0.0, 1.0));
            let (_, t) = found.expect("numbers").expect("it dips");
            assert!((t - one).abs() < 1e-11, "{width} {place} {t}");
        }
    }
}

#[test]
fn a_function_that_leaves_zero_is_beyond_where_it_comes_back() {
    for place in [0.2, 0.9] {
        for sign in [1.0, -1.0] {
            let arc = move |t: f64| sign * t * (place - t);
            let found = first_beyond(&mut Functions::of(std::vec![Box::new(arc)]), (0.0, 1.0));
            let (_, t) = found.expect("numbers").expect("it comes back");
            assert!((t - place).abs() < 1e-14, "{place} {sign} {t}");
        }
    }
    let away = |t: f64| t * (1.0 + t);
    let mut away = Functions::of(std::vec![Box::new(away)]);
    assert_eq!(first_beyond(&mut away, (0.0, 1.0)), Ok(None));
    assert_eq!(away.instants, 9);
}

#[test]
fn passages_of_polynomials_are_isolated_in_order() {
    // (0.23 − x)(0.47 − x)(0.79 − x) of degree 3 in coefficients of degree 8: those of the line raised by the mean.
    let raised = |mut coefficients: Vec<f64>| {
        while coefficients.len() < 9 {
            let n = coefficients.len() as f64;
            let mut next = std::vec![coefficients[0]];
            for k in 1..coefficients.len() {
                let share = k as f64 / n;
                next.push(share * coefficients[k - 1] + (1.0 - share) * coefficients[k]);
            }
            next.push(coefficients[coefficients.len() - 1]);
            coefficients = next;
        }
        coefficients.try_into().expect("nine")
    };
    // Bernstein coefficients from value and slope at both ends.
    let [a, b, c] = [0.23, 0.47, 0.79];
    let cubic = |x: f64| (a - x) * (b - x) * (c - x);
    let slope = |x: f64| -(b - x) * (c - x) - (a - x) * (c - x) - (a - x) * (b - x);
    let coefficients: [f64; 9] = raised(std::vec![
        cubic(0.0),
        cubic(0.0) + slope(0.0) / 3.0,
        cubic(1.0) - slope(1.0) / 3.0,
        cubic(1.0),
    ]);
    let Passage::Between(from, about, to) = passage::first(coefficients, 1e-12, false) else {
        panic!("three passages")
    };
    assert!(from < a && a < to && to < b && (about - a).abs() < 1e-9, "{from} {about} {to}");
    let lifted = coefficients.map(|coefficient| coefficient + 0.2);
    assert_eq!(passage::first(lifted, 1e-12, false), Passage::None);
    // The error of the polynomial is larger than it.
    assert_eq!(passage::first(coefficients, 1.0, false), Passage::Unknown);
}

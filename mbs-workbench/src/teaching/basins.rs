//! Basins of attraction: the assembly found from each guess ("desired assembly depends on the initial guess").

use core::f64::consts::PI;

use crate::erased::experiment::{SAME, difference};
use crate::erased::facade::AnyMechanism;

/// A coordinate of the guess that varies, and its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Lowest value, in the unit of the coordinate.
    pub low: f64,
    /// Highest value.
    pub high: f64,
}

/// A method that looks for the assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BasinMethod {
    /// The lecture's full Newton–Raphson.
    Plain,
    /// The runtime's assembly, as if no branch were declared.
    Assemble,
    /// The runtime's assembly with the declared branches.
    Declared,
}

/// An assembly, with its turns taken off.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Coordinates: N.
    pub q: Vec<f64>,
    /// Values of the branches; each positive where it holds.
    pub branches: Vec<f64>,
}

/// Guess → assembly by one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The method.
    pub method: BasinMethod,
    /// Index of the solution found, none where the method failed; row by row from the highest of the second axis.
    pub cells: Vec<Option<usize>>,
}

/// Result of every method from every guess.
#[derive(Clone, Debug, PartialEq)]
pub struct Basins {
    /// Across and up.
    pub axes: [Axis; 2],
    /// Guesses along each axis.
    pub size: usize,
    /// Distinct assemblies; declared ones first, then by the share of the first map.
    pub solutions: Vec<Solution>,
    /// One a method.
    pub maps: Vec<Map>,
}

impl Axis {
    /// The whole turn of an angle; twice the reference length to either side for lengths.
    pub fn of(mechanism: &dyn AnyMechanism, coordinate: usize) -> Self {
        let is_angle = mechanism.coordinates()[coordinate].is_angle();
        let width = if is_angle { PI } else { 2.0 * mechanism.coordinate_scales()[coordinate] };
        Axis { coordinate, low: -width, high: width }
    }

    /// Value at the middle of part `index` of `size`.
    fn value(&self, index: usize, size: usize) -> f64 {
        self.low + (self.high - self.low) * (index as f64 + 0.5) / size as f64
    }
}

impl Solution {
    /// `true` if every declared branch holds.
    pub fn is_declared(&self) -> bool {
        self.branches.iter().all(|value| *value > 0.0)
    }
}

impl Map {
    /// Part of the guesses that led to the solution, or to none.
    pub fn share(&self, solution: Option<usize>) -> f64 {
        let count = self.cells.iter().filter(|cell| **cell == solution).count();
        count as f64 / self.cells.len().max(1) as f64
    }
}

/// Tries `size` × `size` guesses at time `t` (s); the other coordinates start at the text's guess.
///
/// `progress` gets the number of rows of guesses done, of `size` for each map.
pub fn basins(
    mechanism: &dyn AnyMechanism,
    axes: [Axis; 2],
    size: usize,
    t: f64,
    progress: &mut dyn FnMut(usize),
) -> Basins {
    let mut methods = vec![BasinMethod::Plain, BasinMethod::Assemble];
    if !mechanism.experiment().branches().is_empty() {
        methods.push(BasinMethod::Declared);
    }
    let mut found = Basins { axes, size, solutions: Vec::new(), maps: Vec::new() };
    let mut done = 0;
    for method in methods {
        let mut cells = Vec::with_capacity(size * size);
        for row in 0..size {
            for column in 0..size {
                let mut guess = mechanism.experiment().guess();
                guess[axes[0].coordinate] = axes[0].value(column, size);
                guess[axes[1].coordinate] = axes[1].value(size - 1 - row, size);
                let q = solve(mechanism, method, &guess, t);
                cells.push(q.map(|q| found.number(mechanism, q, t)));
            }
            done += 1;
            progress(done);
        }
        found.maps.push(Map { method, cells });
    }
    found.sort();
    found
}

fn solve(mechanism: &dyn AnyMechanism, method: BasinMethod, guess: &[f64], t: f64) -> Option<Vec<f64>> {
    match method {
        BasinMethod::Plain => mechanism.experiment().newton_raphson(guess, t).ok().map(|(q, _)| q),
        BasinMethod::Assemble => mechanism.experiment().assembled(guess, t, false).ok(),
        BasinMethod::Declared => mechanism.experiment().assembled(guess, t, true).ok(),
    }
}

impl Basins {
    /// The index of the solution, a new one where it is not known yet.
    fn number(&mut self, mechanism: &dyn AnyMechanism, mut q: Vec<f64>, t: f64) -> usize {
        let (coordinates, scales) = (mechanism.coordinates(), mechanism.coordinate_scales());
        let same = |known: &Solution| difference(&known.q, &q, coordinates, &scales) < SAME;
        if let Some(index) = self.solutions.iter().position(same) {
            return index;
        }
        for (value, entry) in q.iter_mut().zip(coordinates) {
            if entry.is_angle() {
                *value -= (*value / (2.0 * PI)).round() * 2.0 * PI;
            }
        }
        let branches = mechanism.experiment().branch_values(&q, t);
        self.solutions.push(Solution { q, branches });
        self.solutions.len() - 1
    }

    fn sort(&mut self) {
        let share = |index: usize| self.maps.first().map_or(0.0, |map| map.share(Some(index)));
        let mut order: Vec<usize> = (0..self.solutions.len()).collect();
        let declared = |index: usize| !self.solutions[index].is_declared();
        order.sort_by(|a, b| declared(*a).cmp(&declared(*b)).then(share(*b).total_cmp(&share(*a))));
        let place = |old: usize| order.iter().position(|index| *index == old);
        for map in &mut self.maps {
            map.cells.iter_mut().for_each(|cell| *cell = cell.and_then(place));
        }
        self.solutions = order.iter().map(|index| self.solutions[*index].clone()).collect();
    }
}

//! Output of `scipy_radau.py`: references, and the cost of SciPy's Radau for an error.

/// Problem, tolerance, right-hand sides, Jacobians, factorizations, error, value of the reference.
const SCIPY: &str = include_str!("data/scipy_radau.csv");

/// The cells of a problem's lines.
fn lines(problem: &str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines = SCIPY.lines().map(|line| line.split(',').collect::<Vec<_>>());
    lines.filter(move |cells| cells.first() == Some(&problem))
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

/// The coordinate at the end by two independent methods.
pub fn reference(problem: &str) -> f64 {
    let line = lines(problem).find(|cells| cells[1] == "reference").expect("a reference");
    number(line[6])
}

/// Uncertainty of the reference: the difference between two methods.
pub fn doubt(problem: &str) -> f64 {
    let line = lines(problem).find(|cells| cells[1] == "reference").expect("a reference");
    number(line[5])
}

/// Errors and right-hand sides of SciPy's runs that no other one beats in both, the coarsest first.
pub fn front(problem: &str) -> Vec<(f64, f64)> {
    let runs = lines(problem).filter(|cells| cells[1] != "reference");
    let runs: Vec<(f64, f64)> = runs.map(|cells| (number(cells[5]), number(cells[2]))).collect();
    let beaten = |one: &(f64, f64)| runs.iter().any(|other| other.0 < one.0 && other.1 <= one.1);
    let mut front: Vec<(f64, f64)> = runs.iter().filter(|run| !beaten(run)).copied().collect();
    front.sort_by(|one, other| other.0.total_cmp(&one.0));
    front
}

/// The right-hand sides at an error between two runs of a front, on a straight line of their logarithms; none beyond its ends.
pub fn cost(front: &[(f64, f64)], error: f64) -> Option<f64> {
    let pair = front.windows(2).find(|pair| pair[1].0 <= error && error <= pair[0].0)?;
    let share = (pair[0].0 / error).ln() / (pair[0].0 / pair[1].0).ln();
    Some(pair[0].1 * (pair[1].1 / pair[0].1).powf(share))
}

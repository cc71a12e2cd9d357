//! The control of `derivatives.rs`: a slip in the emitted code must show.

use mbs_workbench::erased::facade::{AnyEquations, Description, Facade, Functions, State};
use mbs_workbench::verify::{CheckError, check::check_equations};
use my_crate::Mine;

/// `Mine` with a wrong sign in one entry of Φ_q.
struct Slipped(Facade<Mine, 2, 2>);

impl AnyEquations for Slipped {
    fn description(&self) -> &'static Description {
        self.0.description()
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.0.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.0.set(index, value)
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        self.0.coordinate_scales()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.0.row_scales()
    }
    fn evaluate(&self, state: &State) -> Functions {
        let mut functions = self.0.evaluate(state);
        functions.phi_q[3] = -functions.phi_q[3];
        functions
    }
}

#[test]
fn a_slip_is_found_and_named() {
    let error = check_equations(&mut Slipped(Facade::of(Mine::default()))).expect_err("a slip");
    assert!(matches!(error, CheckError::Differs(_)), "{error}");
    // The output of `unwrap`.
    let report = format!("{error:?}");
    assert!(report.contains("closure.1, beta at state") && report.contains("DIFFERS"), "{report}");
    assert!(report.contains(", CasADi ") && report.contains(", 50 digits "), "{report}");
}

//! Trust in estimated errors.

use crate::dynamics::simulation::accuracy::ErrorEstimate;

const STEPS: [u32; 3] = [30, 40, 53];

#[test]
fn an_estimate_is_twice_the_difference_from_the_finer_run_and_trusted_where_differences_fall() {
    assert_eq!(ErrorEstimate::of([1e-5, 1e-6], STEPS), ErrorEstimate::Trusted(2e-6));
    // Neither where they hardly fall nor where they fall by chance.
    assert_eq!(ErrorEstimate::of([1.9e-6, 1e-6], STEPS), ErrorEstimate::Untrusted(2e-6));
    assert_eq!(ErrorEstimate::of([1.1e-4, 1e-6], STEPS), ErrorEstimate::Untrusted(2e-6));
    assert_eq!(ErrorEstimate::of([1e-5, 0.0], STEPS), ErrorEstimate::Untrusted(0.0));
}

#[test]
fn runs_of_the_same_steps_and_large_errors_tell_nothing() {
    assert_eq!(ErrorEstimate::of([1e-5, 1e-6], [30, 40, 42]), ErrorEstimate::Untrusted(2e-6));
    assert_eq!(ErrorEstimate::of([1e-5, 1e-6], [39, 40, 53]), ErrorEstimate::Untrusted(2e-6));
    assert_eq!(ErrorEstimate::of([0.6, 0.06], STEPS), ErrorEstimate::Untrusted(0.12));
    assert!(ErrorEstimate::of([f64::NAN, 1e-6], STEPS).trusted().is_none());
    assert!(ErrorEstimate::of([1e-5, f64::NAN], STEPS).trusted().is_none());
}

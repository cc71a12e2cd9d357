//! Tests of `mechanisms::governor`.

use mbs_runtime::{Dynamic, Mechanism};

use mechanisms::governor::*;

#[test]
fn values_that_must_not_be_negative_are_known_with_their_parameter_each_once() {
    let signed = <Governor as Dynamic<f64, 16, 12>>::NON_NEGATIVE;
    let parameter = |name: &str| signed.iter().find(|signed| signed.name == name).map(|s| s.parameter);
    assert_eq!(parameter("shaft.mass"), Some("rho"));
    assert_eq!(parameter("ball.mass"), Some("ball_mass"));
    assert_eq!(parameter("spring.stiffness"), Some("k"));
    // Both rods have the mass of the shaft.
    assert_eq!(parameter("rod.mass"), None);
    let governor: Governor = Governor { rho: -1.0, ..Governor::default() };
    let mut values = Vec::new();
    governor.signed(&governor.parameters(), |value: f64| values.push(value));
    assert_eq!(values.len(), signed.len());
    let negative = |name: &str| signed.iter().position(|signed| signed.name == name).map(|i| values[i] < 0.0);
    assert_eq!((negative("shaft.mass"), negative("ball.mass")), (Some(true), Some(false)));
}

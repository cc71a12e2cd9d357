//! CasADi's and 50 digits' solutions of their own Jacobians against ratios of transmission.

use mbs_runtime::mechanism;
use mbs_workbench::erased::erase::erase;
use mbs_workbench::verify::compare::compare;
use mbs_workbench::verify::{Oracle, STATES, check};

mechanism! {
    /// A four-bar on a crank that is measured, with its prescribed side on the left, and a slide on it.
    pub mechanism Transmission;
    param coupler: m = 0.25;
    input theta: rad, rates;
    coord phi: [rad; 3] = [0.3, 0.9, 1.8];
    coord x: m = 0.1;
    coord s: m = 0;
    constraint closure { 0.1m*unit(phi[0]) + coupler*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
    constraint slide { x*cos(phi[1]) == 0.1m*cos(phi[0]) + s; }
    drive crank: 2*theta == phi[0];
    drive push: s == coupler*sin(3*t/1s);
    out rocker: 1 = ratio(phi[2], crank);
    out closeness: 1 = margin(closure);
    out point: [m; 2] = ratio(0.1m*unit(phi[0]) + coupler*unit(phi[1]), crank);
    out stroke: m = 2*ratio(x, crank)*cos(phi[2]) + 0.1m*ratio(x^2, push)/x;
}

#[test]
fn casadi_and_50_digits_confirm_ratios() {
    let check = check(Transmission::default()).unwrap();
    println!("{check}");
    for agreement in [&check.casadi, &check.digits] {
        let out = agreement.functions.iter().find(|largest| largest.function == "output");
        assert!(out.is_some_and(|out| out.emitted.is_some() && out.oracle.is_some()), "{agreement}");
    }
}

#[test]
fn a_ratio_of_the_wrong_sign_is_found() {
    let mut transmission = erase(Transmission::default()).into_equations();
    let definition = mbs_codegen::casadi_definition(transmission.source(), None)
        .unwrap_or_else(|faults| panic!("{faults}"));
    let oracle = Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let wrong = definition.replacen("rows, 3, -1)", "rows, 3, 1)", 1);
    assert_ne!(definition, wrong);
    for (definition, holds) in [(definition, true), (wrong, false)] {
        let agreement = compare(transmission.as_mut(), &oracle, &definition, STATES)
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(agreement.holds(), holds, "{agreement}");
    }
}

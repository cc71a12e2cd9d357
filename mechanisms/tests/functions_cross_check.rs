//! CasADi and 50 digits against texts with declared functions, whose values both sides know.

use mbs_runtime::mechanism;
use mbs_workbench::verify::{CheckError, StandIn, check};

mechanism! {
    /// Every place where a declared function can stand.
    pub mechanism Called;
    param p: rad = 0.3;
    function lift: m(rad), C4, periodic TAU;
    function swing: rad(s), C3;
    function bend: 1(m), C2;
    input u: rad, rates;
    coord x: rad = 0.1;
    coord y: [m; 4];
    coord w: m = 0.8;
    drive first: x == swing(t) + 0.1*u;
    constraint each {
        y[0] == lift(x);
        y[1] == lift.d1(2*x + p)*sin(x);
        y[2] == lift.d2(swing(t*cos(x)))*swing.d1(t)*1s;
        y[3] == lift(x)*bend(y[0])*bend(lift(p)) + 1m*hypot(lift(x - u)/1m, 1);
    }
    constraint implicit { w*(2 + bend(w)) == lift(w/1m); }
    out height: m = lift(x - u);
    out slope: m = lift.d2(x);
    out curvature: m = lift.d2(x)*bend(w);
    out steeper: 1/m = bend.d1(w);
    out steepest: 1/m^2 = bend.d2(w);
    out held: 1/m^2 = bend.d2(0.1m);
    out speed: m/s = der(lift(x))*swing.d1(0s)*1s;
    out jerky: 1/s = der(bend(w));
}

#[test]
fn casadi_and_50_digits_confirm_declared_functions() {
    let confirmed = check(Called::new(StandIn::<0>, StandIn::<1>, StandIn::<2>)).unwrap();
    println!("{confirmed}");
    // The point of this text: no function is zero throughout.
    assert!(confirmed.casadi.functions.iter().all(|function| function.scale > 0.0), "{confirmed}");
}

#[test]
fn functions_in_the_wrong_places_are_found() {
    let swapped = check(Called::new(StandIn::<1>, StandIn::<0>, StandIn::<2>));
    assert!(matches!(swapped, Err(CheckError::Differs(_))), "{swapped:?}");
}

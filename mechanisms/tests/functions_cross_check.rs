//! CasADi and 50 digits against texts with declared functions, whose values both sides know.

use mbs_runtime::mechanism;
use mbs_workbench::verify::{CheckError, NumberedStandIn, StandIn, check};

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

mechanism! {
    /// An array of functions behind one by itself and before another one.
    pub mechanism Arrays;
    param p: rad = 0.3;
    function swing: rad(s), C3;
    function lift: [m; 3](rad), C4, periodic TAU;
    function push: N(m), C2;
    coord x: rad = 0.1;
    coord y: [m; 3];
    coord z: m = 0.2;
    drive first: x == swing(t);
    constraint each {
        for i in 0..3 { y[i] == lift[i](x) + lift[2 - i].d1(2*x + p)*sin(x); }
    }
    body slide { mass: 2kg, com: [z, 0] }
    force pushed: push(z)*(1 + lift[1](x)/1m) on z;
    out height: m = sum(i in 0..3: lift[i](x + i)*lift[i].d2(p))/1m;
}

#[test]
fn casadi_and_50_digits_confirm_arrays_of_functions() {
    let confirmed = check(Arrays::new(StandIn::<0>, NumberedStandIn::array(1), StandIn::<4>)).unwrap();
    assert!(confirmed.casadi.functions.iter().any(|function| function.scale > 0.0), "{confirmed}");
    let [first, second, third] = NumberedStandIn::array(1);
    let swapped = check(Arrays::new(StandIn::<0>, [second, first, third], StandIn::<4>));
    assert!(matches!(swapped, Err(CheckError::Differs(_))), "{swapped:?}");
}

mechanism! {
    /// Feet of a point, a circle, a flat face and a curve, on polar and on parametric curves.
    pub mechanism Feet;
    param bound: m = 1m;
    param rho: m = 0.2m;
    function r: [m; 2](rad), C6, periodic TAU;
    function x: m(rad), C6, periodic TAU;
    function y: m(rad), C6, periodic TAU;
    coord theta: rad = 0.2;
    coord psi: rad = 0.4;
    coord p: [m; 2] = [1m, 0.5m];
    drive shaft: theta == 0.3 [rad/s]*t;
    drive other: psi == 0.4 + 0.2 [rad/s]*t;
    curve cam = polar r[0] about [0.1m, 0.2m] turned theta;
    curve rim = parametric x, y about p turned psi;
    curve still = polar r[1] about [2m, 0m];
    foot a of [1m + 0.1m*sin(t/1s), 0.7m] on rim within bound near 0.1;
    foot b of circle([0.3m, 1m], rho) turned psi on cam within bound near 0.2;
    foot c of flat(p, psi + 90deg) on cam within bound near 0.3;
    foot e of rim at f on still within bound near 0.4, 0.5;
    constraint rides { b_gap == p.0*0.1; c_gap + e_gap == 0m; }
    out gaps: [m; 4] = [a_gap, b_gap, c_gap, e_gap];
    out slips: [m/s; 4] = [a_slip, b_slip, c_slip, e_slip];
    out normals: [1; 2] = a_normal + c_normal;
}

#[test]
fn casadi_and_50_digits_confirm_feet() {
    let confirmed = check(Feet::new(NumberedStandIn::array(0), StandIn::<2>, StandIn::<3>)).unwrap();
    println!("{confirmed}");
    assert!(confirmed.casadi.functions.iter().all(|function| function.scale > 0.0), "{confirmed}");
}

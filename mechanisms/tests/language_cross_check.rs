//! CasADi and 50 digits against a text that uses every operator and function of the language, and explicit time in every
//! possible place. It has inputs with rates and a drive that prescribes a rate; no ready mechanism needs all at once.

use mbs_runtime::{Lanes, mechanism};
use mbs_workbench::erased::lanes::InLanes;
use mbs_workbench::verify::check;
use mbs_workbench::verify::check::{Check, check_equations};

mechanism! {
    /// Meaningless as a machine, complete as a text.
    pub mechanism Sampler;
    const N: 1 = 2;
    const SPAN: m = 200mm;
    param arm: [m; 3] = [0.3, 0.2, 0.5];
    param omega: rad/s = 3000rpm/1000;
    param table: [1; 2, 2] = [[1, 2], [3, 4]];
    input theta: rad, rates;
    input shift: [m; 2], rates;
    input load: N;
    coord phi: [rad; 3] = [0.1, 0.2, 0.3];
    coord p: [m; 2] = [0.1, 0.2];
    coord s: m = 0.1;
    coord w: [m; 3] = [0.1, 0.2, 0.3];
    coord z: m = 0.1;
    coord psi: rad = 0.1;

    let swing = 0.5*sin(omega*t) + 0.1*theta;
    let a = arm[0]*unit(phi[0]);
    let b: m = sqrt(dot(p, p) + SPAN^2);
    let turned = rot(phi[1] + swing)*[p.0, 2*p.1];

    constraint closure {
        a + arm.1*unit(phi[1]*(1 + 0.2*sin(omega*t))) == p + shift;
    }
    constraint functions {
        arm[2]*(exp(-sin(phi[2])^2) + ln(2 + cos(phi[0]))) == s*tanh(phi[1]) + SPAN*cosh(0.3*sin(phi[2]*t/1s)) + SPAN*(asinh(phi[0]) + acosh(1.5 + phi[1]^2) + atanh(0.6*sin(phi[2])));
        SPAN*(asin(0.5*sin(phi[0])) - acos(0.4*cos(phi[1])) + atan(phi[2])) == b*sinh(0.2*phi[0]);
        atan2(p[1] + s, b) + tan(0.3*sin(phi[1])) == hypot(s/SPAN, p[0]/SPAN)^1.5/10;
    }
    constraint kinks {
        min(s, p[0]) + max(p[1], s*sin(phi[0])) == abs(w[0])*z/SPAN + SPAN*sign(w[1])*phi[2];
    }
    constraint spatial {
        dot(cross(w, [s, p[0], p[1]]), [s, s, p[0]])/SPAN^2 == norm(w);
        det([turned, p]) + det(w, [p[0], p[1], s], [s, arm[0], b])/SPAN == w[2]^2*table[1, 0]*omega*t;
    }
    drive time: sum(i in 0..N: phi[i]*(i + 1)*table[i, 1])*cos(omega*t)^2 == theta*(2 + sin(phi[2]))^-2;
    drive steady: rate(psi*(1 + 0.1*sin(phi[0])) + 0.1*omega*t) == 0.3*theta/1s;
    for i in 0..1 {
        constraint repeated { for j in 0..1 { w[i + 1] == s*2^(sin(phi[j])) + shift[i]; } }
    }

    out speed: m/s = norm([der(p[0]), der(p[1])]);
    out power: W = load*der(s) + 0;
    out jerky: m/s^2 = der2(s)*sin(theta);
    out place: [m; 2] = turned + shift;
    out angle: rad = atan2(place_y, b);
    let place_y = turned[1];
}

/// Prints what was found. The point of this text: no function is zero throughout.
fn assert_complete(check: &Check) {
    println!("{check}");
    for agreement in [&check.casadi, &check.digits] {
        assert_eq!(agreement.functions.len(), 9, "{agreement}");
        assert!(agreement.functions.iter().all(|function| function.scale > 0.0), "{agreement}");
    }
}

#[test]
fn both_oracles_confirm_every_operator_and_function() {
    assert_complete(&check(Sampler::default()).unwrap_or_else(|error| panic!("{error}")));
}

#[test]
fn both_oracles_confirm_every_operator_and_function_in_eight_lanes() {
    let mut lanes = InLanes::new(Sampler::<Lanes<f64, 8>>::default());
    assert_complete(&check_equations(&mut lanes).unwrap_or_else(|error| panic!("{error}")));
}

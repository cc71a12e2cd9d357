//! D17: an exponent of 1.5, Hertz's, was a `powf` of fifty times the cost of √.

use mbs_runtime::{Dynamic, Mechanism, mechanism};

const SOURCE: &str = "mechanism Ball;
    param k: N/m = 1e5;
    coord y: m = 0.1;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, stiffness: k, exponent: EXPONENT, depth: 1mm, damping: 0.2 }";

mechanism! {
    mechanism Ball;
    param k: N/m = 1e5;
    coord y: m = 0.1;
    body ball { mass: 1, com: [0, y] }
    contact floor { gap: y, stiffness: k, exponent: 1.5, depth: 1mm }
}

#[test]
fn halves_and_quarters_are_roots_and_products_in_every_function() {
    for exponent in ["1.5", "2.5", "1.25", "2.75", "3/2", "5/4"] {
        let code = mbs_codegen::expand_source(&SOURCE.replace("EXPONENT", exponent))
            .expect("it compiles")
            .to_string();
        assert!(!code.contains("powf") && code.contains("sqrt"), "{exponent}");
    }
    for exponent in ["1.4", "4/3"] {
        let code = mbs_codegen::expand_source(&SOURCE.replace("EXPONENT", exponent))
            .expect("it compiles")
            .to_string();
        assert!(code.contains("powf"), "{exponent}");
    }
}

#[test]
fn hertzs_force_and_its_slopes_are_numbers_where_the_contact_opens() {
    let ball: Ball = Ball::default();
    let parameters = ball.parameters();
    for depth in [0.0, 1e-3, 2e-3, -1e-3, 1e-12] {
        let position = ball.position(&parameters, &[-depth], 0.0);
        let [force] = ball.force(&parameters, &position, &[0.3], &[], &[]);
        let [[slope]] = ball.force_q(&parameters, &position, &[0.3], &[], &[]);
        let pressed = (depth / 1e-3_f64).max(0.0);
        let expected = (1e5 * 1e-3 * pressed * pressed.sqrt(), -1e5 * 1.5 * pressed.sqrt());
        assert!((force - expected.0).abs() <= 4.0 * f64::EPSILON * expected.0, "{depth}: {force}");
        assert!((slope - expected.1).abs() <= -8.0 * f64::EPSILON * expected.1, "{depth}: {slope}");
    }
}

mechanism! {
    /// A point on a curve, in a field of force, both of a power that the caller sets.
    mechanism Shaped;
    param n: 1 = 1;
    coord x: m = 0;
    coord y: m = 0;
    body point { mass: 1, com: [x, y] }
    constraint curve { y == 1m*(x/1m)^n; }
    potential field = 1J*(x/1m)^n;
}

#[test]
fn powers_of_whole_parameters_have_derivatives_at_the_base_0() {
    // Of xⁿ: the first two derivatives at 0, and the third along x.
    for (n, [slope, curvature, third]) in
        [(0.0, [0.0; 3]), (1.0, [1.0, 0.0, 0.0]), (2.0, [0.0, 2.0, 0.0]), (3.0, [0.0, 0.0, 6.0])]
    {
        let shaped: Shaped = Shaped { n };
        let parameters = shaped.parameters();
        let position = shaped.position(&parameters, &[0.0, 0.0], 0.0);
        let rates = [1.0, slope];
        assert_eq!(shaped.force(&parameters, &position, &rates, &[], &[0.0])[0], -slope, "{n}");
        assert_eq!(shaped.force_q(&parameters, &position, &rates, &[], &[0.0])[0][0], -curvature, "{n}");
        assert_eq!(shaped.gamma(&parameters, &position, &rates), [curvature], "{n}");
        let known = shaped.third_derivative(&parameters, &position, &rates, &[1.0]);
        assert_eq!(known, Some(([-curvature, 0.0], third)), "{n}");
    }
}

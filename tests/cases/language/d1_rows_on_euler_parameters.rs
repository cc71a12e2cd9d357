//! D1: `dot(rotate(e, [1, 0, 0]), [0, 1, 0]) == 0` was reported to repeat e·e = 1, because all tried vectors fulfil it.

use mbs_codegen::{expand_source, structure_of};
use mbs_runtime::{Stepper, mechanism};

/// Messages about rows on the parameters of a body; empty if they are right.
fn report(rows: &str) -> String {
    let text = format!(
        "mechanism M; coord e: [1; 4] = [1, 0, 0, 0]; \
         body top {{ mass: 1, com: rotate(e, [0, 0, 1m]), inertia: [1, 2, 2], orientation: e }} \
         constraint own {{ {rows} }}"
    );
    expand_source(&text).err().unwrap_or_default()
}

/// Axes of a body or of the ground.
const AXES: [&str; 3] = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];

#[test]
fn axes_at_right_angles_are_no_normalisation() {
    for body in AXES {
        for ground in AXES {
            for value in ["0", "0.5", "-1", "sqrt(0.5)"] {
                let row = format!("dot(rotate(e, {body}), {ground}) == {value};");
                assert_eq!(report(&row), "", "{row}");
            }
            let row =
                format!("dot(rotate(e, [0.6, 0.8, 0]), {ground}) == dot(rotate(e, {body}), [0, 0.6, 0.8]);");
            assert_eq!(report(&row), "", "{row}");
        }
    }
}

#[test]
fn quadratic_rows_other_than_the_length_are_no_normalisation() {
    // All forms of coefficients −1, 0, 1 on the ten products but multiples of the length are right; a hundred of them.
    let mut state = 20_251_122_u64;
    let mut tried = 0;
    while tried < 100 {
        let mut terms = Vec::new();
        let mut squares = [0_i32; 4];
        let mut mixed = false;
        for (i, square) in squares.iter_mut().enumerate() {
            for j in i..4 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let coefficient = (state >> 33) as i32 % 3 - 1;
                if coefficient != 0 {
                    terms.push(format!("({coefficient})*e.{i}*e.{j}"));
                    mixed |= i != j;
                }
                if i == j {
                    *square = coefficient;
                }
            }
        }
        if terms.is_empty() || (!mixed && squares.iter().all(|square| *square == squares[0])) {
            continue;
        }
        let row = format!("{} == {};", terms.join(" + "), ["0", "1", "0.5"][tried % 3]);
        assert_eq!(report(&row), "", "{row}");
        tried += 1;
    }
}

#[test]
fn other_right_rows_on_parameters_compile() {
    for row in [
        "e.1 == 0;",
        "e.0 == e.3;",
        "e.0*e.1 == e.2*e.3;",
        "e.1*e.2 + e.0*e.3 == 0;",
        "e.1*e.2 - e.0*e.3 == 0;",
        "e.0^2 + e.1^2 == 0.5;",
        "e.0^4 + e.1^4 + e.2^4 + e.3^4 == 1;",
        "atan2(e.3, e.0) == 0.2;",
        "norm([e.1, e.2, e.3]) == 0.5;",
        "1e-14*dot(rotate(e, [1, 0, 0]), [0, 1, 0]) == 0;",
        "dot(e, [1, 2, 3, 4]) == 0;",
        "max(e.0 - 0.99, 0) == 0;",
        "dot(e, e)*e.1 == 0;",
        "(dot(e, e) - 1)*e.1 + e.2 == 0;",
        "dot(rotate(e, [1, 0, 0]), rotate(e, [0, 1, 0])) == e.2;",
    ] {
        assert_eq!(report(row), "", "{row}");
    }
}

#[test]
fn rows_that_repeat_the_normalisation_are_still_reported() {
    for row in [
        "dot(e, e) == 1;",
        "norm(e) == 1;",
        "3*dot(e, e) == 3;",
        "1e-14*(dot(e, e) - 1) == 0;",
        "1e9*dot(e, e) == 1e9;",
        "e.0^2 == 1 - e.1^2 - e.2^2 - e.3^2;",
        "ln(dot(e, e)) == 0;",
        "(dot(e, e) - 1)*e.1 == 0;",
        "dot(rotate(e, [1, 0, 0]), rotate(e, [0, 1, 0])) == 0;",
        "norm(rotate(e, [1, 0, 0])) == 1;",
        "dot(cross(rotate(e, [1, 0, 0]), rotate(e, [0, 1, 0])), rotate(e, [0, 0, 1])) == 1;",
        "e.0*e.1 == e.1*e.0;",
    ] {
        let found = report(row);
        assert!(found.contains("repeats that of `top`"), "{row}: {found}");
    }
}

mechanism! {
    /// The body's x stays at right angles to the ground's y.
    mechanism Upright;
    coord e: [1; 4] = [0.9, 0.1, 0.3, -0.1];
    body top { mass: 1, com: rotate(e, [0, 0, 1m]), inertia: [1, 2, 2], orientation: e }
    constraint upright { dot(rotate(e, [1, 0, 0]), [0, 1, 0]) == 0; }
    drive tilt: dot(rotate(e, [0, 0, 1]), [0, 1, 0]) == 0.3*sin(2*t/1s);
    drive turning: dot(rotate(e, [1, 0, 0]), [0, 0, 1]) == 0.4*sin(1*t/1s);
}

/// A share well above the rounding of a row makes it another one, a share below it does not.
#[test]
fn rows_that_nearly_repeat_the_normalisation_are_rows_of_their_own() {
    for (share, repeats) in [("1e-9", false), ("1e-11", false), ("1e-14", true)] {
        let found = report(&format!("dot(e, e) + {share}*e[0]*e[1] == 1;"));
        assert_eq!(found.contains("repeats"), repeats, "{share}: {found}");
    }
}

#[test]
fn the_row_that_was_refused_holds_along_a_motion() {
    let upright = Upright::default();
    let mut motion = Stepper::assemble(upright, [0.9, 0.1, 0.3, -0.1], 0.0).expect("assembled");
    for step in 0..500 {
        motion.advance(0.01).expect("a regular position");
        let [w, x, y, z] = *motion.q();
        let t = f64::from(step + 1) * 0.01;
        // The matrix of the quaternion, written out.
        let along_x = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)];
        let z_on_y = 2.0 * (y * z - w * x);
        for error in [
            along_x[1],
            along_x[2] - 0.4 * t.sin(),
            z_on_y - 0.3 * (2.0 * t).sin(),
            w * w + x * x + y * y + z * z - 1.0,
        ] {
            assert!(error.abs() < 1e-12, "{error:e} at {t} s");
        }
    }
}

/// Coefficients in equal steps, r − 2l + k for instance, vanished at values in equal steps, and a term was lost.
#[test]
fn a_dyad_is_not_recognised_by_the_values_that_are_tried() {
    let dyads = |before: usize, term: &str| {
        let others: String = (0..before).map(|index| format!("param p{index}: m = 0.1; ")).collect();
        let text = format!(
            "mechanism M; {others} param r: m = 0.1; param l: m = 0.3; param k: m = 0.2; \
             coord a: rad = 0.4; coord b: rad = 1; \
             constraint closure {{ r*unit(a) + l*unit(b) + {term}*[sin(a)*sin(b), 0] == [0.2m, 0.1m]; }}"
        );
        let report = structure_of(&text, None).expect("a report");
        report.blocks.iter().filter_map(|block| block.dyad).count()
    };
    for before in 0..10 {
        assert_eq!(dyads(before, "0m"), 1);
        assert_eq!(dyads(before, "(r - 2*l + k)"), 0, "{before}");
        assert_eq!(dyads(before, "(r - l)"), 0, "{before}");
    }
}

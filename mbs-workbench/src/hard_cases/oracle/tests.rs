//! The oracle against closed forms, and its independence of the compiler of texts.

use std::fs;
use std::path::Path;
use std::rc::Rc;

use super::{Gap, Jet, Oracle, OracleState};

const PENDULUM: &str = "mechanism Pendulum; param L: m = 2; param mass: kg = 3; coord p: [m; 2]; \
    body bob { mass: mass, com: p } gravity weight { acceleration: [0, -10] } \
    constraint rod { dot(p, p) == L^2; } branch below: p[1] < 0;";

fn read(source: &str) -> Result<Oracle, Gap> {
    let known = |name: &str| match name {
        "L" => Some(2.0),
        "mass" => Some(3.0),
        _ => None,
    };
    Oracle::read(source, None, &known)
}

/// The pendulum at its lowest point, with the speed `v`.
fn lowest(v: f64) -> OracleState {
    // a = v²/L upwards; the row's force is −2 p λ.
    let lambda = 3.0 * (10.0 + v * v / 2.0) / 4.0;
    OracleState {
        q: vec![0.0, -2.0],
        qd: vec![v, 0.0],
        qdd: vec![0.0, v * v / 2.0],
        lambda: vec![lambda],
        ..OracleState::default()
    }
}

#[test]
fn the_pendulum_has_its_closed_form() {
    let oracle = read(PENDULUM).expect("a text");
    let state = lowest(1.5);
    let row = oracle.rows(&state).expect("rows")[0];
    assert_eq!((row.phi, row.rate), (Some(0.0), 0.0));
    assert!(row.second.abs() < 1e-15, "{row:?}");
    let [energy, rate] = oracle.energy(&state).expect("an energy");
    assert!((energy - (1.5 * 2.25 - 60.0)).abs() < 1e-13 && rate.abs() < 1e-13, "{energy} {rate}");
    for w in [[1.0, 0.0], [0.0, 1.0], [0.3, -0.7]] {
        let balance = oracle.equations_of_motion(&state, &w).expect("a balance");
        assert!(balance.open() < 1e-15, "{balance:?}");
    }
    assert_eq!(oracle.branches(&state).expect("branches"), [("below".to_string(), 2.0)]);
    assert_eq!(oracle.gradients(&state, &[1.0, 1.0]).expect("gradients"), [4.0]);
}

#[test]
fn a_fault_in_any_part_of_the_state_shows() {
    let oracle = read(PENDULUM).expect("a text");
    let faulty = |change: fn(&mut OracleState)| {
        let mut state = lowest(1.5);
        change(&mut state);
        let row = oracle.rows(&state).expect("rows")[0];
        let balance = oracle.equations_of_motion(&state, &[0.4, 0.9]).expect("a balance").open();
        [row.phi.unwrap_or(0.0).abs(), row.rate.abs(), row.second.abs(), balance].map(|open| open > 1e-7)
    };
    assert_eq!(faulty(|_| ()), [false; 4]);
    assert!(faulty(|state| state.q[1] *= 1.0 + 1e-6)[0]);
    assert!(faulty(|state| state.qd[1] += 1e-6)[1]);
    assert_eq!(faulty(|state| state.qdd[1] += 1e-5)[2..], [true, true]);
    assert!(faulty(|state| state.lambda[0] *= 1.0 + 1e-5)[3]);
}

#[test]
fn loops_effects_and_sums_are_read_in_the_order_of_the_text() {
    let source = "mechanism Chain; const N: 1 = 3; coord a: [rad; N]; coord s: m; \
        effect up { for i in 0..N { let share = 1 [m]*(i + 1); constraint c { share*sin(a[i]) == 0; } } } \
        effect down { constraint d { s == 0; } } constraint e { for i in 0..2 { s == 2*sum(j in 0..i + 1: a[j])*1 [m]; } } \
        scene Up = up; scene Down = down;";
    let of = |scene| Oracle::read(source, scene, &|_| None).expect("a text");
    assert_eq!((of(None).row_count(), of(Some("Up")).row_count(), of(Some("Down")).row_count()), (6, 5, 3));
    let state = OracleState {
        q: vec![0.1, 0.2, 0.3, 0.5],
        qd: vec![0.0; 4],
        qdd: vec![0.0; 4],
        ..OracleState::default()
    };
    let rows = of(Some("Up")).rows(&state).expect("rows");
    let phi: Vec<f64> = rows.iter().filter_map(|row| row.phi).collect();
    let expected = [0.1_f64.sin(), 2.0 * 0.2_f64.sin(), 3.0 * 0.3_f64.sin(), 0.5 - 0.2, 0.5 - 0.6];
    assert!(phi.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15) && phi.len() == 5, "{phi:?}");
}

/// Polar radius (m) of a circle of 20 mm, 5 mm beside the centre, with its derivatives by differences in Richardson's scheme.
fn eccentric(w: f64) -> Vec<f64> {
    let radius = |w: f64| 5e-3 * w.cos() + (4e-4 - 2.5e-5 * w.sin().powi(2)).sqrt();
    let first = |h: f64| (radius(w + h) - radius(w - h)) / (2.0 * h);
    let second = |h: f64| (radius(w + h) - 2.0 * radius(w) + radius(w - h)) / (h * h);
    let better = |f: &dyn Fn(f64) -> f64| (4.0 * f(2e-3) - f(4e-3)) / 3.0;
    vec![radius(w), better(&first), better(&second)]
}

#[test]
fn curves_and_functions_of_the_caller_are_read() {
    let source = "mechanism Cam; function pitch: [m; 2](rad), C3, periodic TAU; coord theta: rad; coord A: [m; 2]; \
        curve cam = polar pitch[1] about [3mm, 1mm] turned theta; constraint ride { A on cam; } \
        out apart: m = distance(A, cam); out normal: [1; 2] = outward(A, cam); out there: [m; 2] = place(0.4, cam); \
        out slope: m = pitch[1].d1(A[0]/1m);";
    let functions = |name: &str| (name == "pitch[1]").then(|| Rc::new(eccentric) as Jet);
    let missing = Oracle::with_functions(source, None, &|_| None, &functions);
    assert!(matches!(missing, Err(Gap(words)) if words.contains("`pitch[0]`")));
    let all = |_: &str| Some(Rc::new(eccentric) as Jet);
    let oracle = Oracle::with_functions(source, None, &|_| None, &all).expect("a text");
    // A point of the circle in the direction 1.1 from its own centre.
    let at = |theta: f64, far: f64| {
        let (sin, cos) = theta.sin_cos();
        let (x, y) = (3e-3 + 5e-3 * cos, 1e-3 + 5e-3 * sin);
        OracleState {
            q: vec![theta, x + far * 1.1_f64.cos(), y + far * 1.1_f64.sin()],
            qd: vec![2.0, 0.1, -0.3],
            qdd: vec![0.0; 3],
            ..OracleState::default()
        }
    };
    let state = at(0.7, 0.02);
    assert!(oracle.rows(&state).expect("rows")[0].phi.is_some_and(|phi| phi.abs() < 1e-17));
    let found = |name: &str, state: &OracleState| {
        let all = oracle.quantities(name, state).expect("an output");
        all.into_iter().map(|found| found.value).collect::<Vec<_>>()
    };
    let close = |a: f64, b: f64, within: f64| assert!((a - b).abs() < within, "{a} {b}");
    close(found("apart", &state)[0], 0.0, 1e-17);
    // Of first order beside the curve.
    close(found("apart", &at(0.7, 0.0201))[0], 1e-4, 1e-6);
    let normal = found("normal", &state);
    close(normal[0], 1.1_f64.cos(), 1e-9);
    close(normal[1], 1.1_f64.sin(), 1e-9);
    let there = found("there", &state);
    close(
        (there[0] - state.q[1] + 0.02 * 1.1_f64.cos()).hypot(there[1] - state.q[2] + 0.02 * 1.1_f64.sin()),
        0.02,
        1e-9,
    );
    close(found("slope", &state)[0], eccentric(state.q[1])[1], 1e-17);
    // Φ̇ is the difference of Φ along the motion.
    let moved = |h: f64| {
        let q = state.q.iter().zip(&state.qd).map(|(q, qd)| q + h * qd).collect();
        oracle.rows(&OracleState { q, ..state.clone() }).expect("rows")[0].phi.unwrap_or(f64::NAN)
    };
    close(oracle.rows(&state).expect("rows")[0].rate, (moved(1e-5) - moved(-1e-5)) / 2e-5, 1e-8);
    assert_eq!(oracle.contradiction(), None);
}

#[test]
fn parts_that_are_not_evaluated_are_named() {
    let with = |rest: &str| format!("{PENDULUM} {rest}");
    let oracle = read(&with("force pull: [reaction(rod, bob), 0] on p;"));
    let found = oracle.map(|oracle| oracle.equations_of_motion(&lowest(1.0), &[1.0, 0.0]));
    assert!(
        matches!(&found, Ok(Err(Gap(words))) | Err(Gap(words)) if words.contains("reaction")),
        "{found:?}"
    );
    let Gap(words) = read(&with("function lift: m(rad), C3;")).expect_err("a function");
    assert!(words.contains("`lift`"), "{words}");
    let Gap(words) = read(&with("param unknown: m = 1;")).expect_err("a value");
    assert!(words.contains("`unknown`"), "{words}");
}

#[test]
fn laws_that_are_not_evaluated_are_named() {
    let sliding = "along: p[0], normal: 5N, coefficient: 0.2";
    let pressing = "gap: p[1] + 2m, stiffness: 1e4";
    let laws = [
        (format!("friction f {{ {sliding}, sticks: 0.3 }}"), "friction that sticks"),
        (format!("friction f {{ {sliding}, bristles: 1mm }}"), "friction with bristles"),
        (
            format!("contact c {{ {pressing}, restitution: 0.5, approach: 1 }}"),
            "a contact with a restitution",
        ),
        ("event low: p[1] < 0; force push: [1N*low, 0] on p;".to_string(), "event or latch `low`"),
        (
            "event low: p[1] < 0; latch since: s = t at low; force push: [1 [N/s]*since, 0] on p;"
                .to_string(),
            "event or latch `since`",
        ),
    ];
    let balance = |text: &str| {
        let oracle = read(&format!("{PENDULUM} {text}"))?;
        oracle.equations_of_motion(&lowest(1.5), &[0.3, 0.7])
    };
    for (law, words) in laws {
        let Err(Gap(found)) = balance(&law) else { panic!("{law}") };
        assert!(found.contains(words), "{law}: {found}");
    }
    assert!(balance(&format!("contact c {{ {pressing}, damping: 0.5 }}")).is_ok());
    // An event that no force uses is no gap.
    assert!(balance("event low: p[1] < 0; out on: 1 = low;").is_ok());
}

#[test]
fn of_the_compiler_of_texts_the_syntax_alone_is_used() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/hard_cases/oracle");
    let mut seen = 0;
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("a file").path();
        if path.ends_with("tests.rs") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("a source");
        for (crate_name, allowed) in
            [("mbs_codegen::", "syntax_tree::"), ("mbs_runtime", ""), ("crate::", "")]
        {
            for rest in text.split(crate_name).skip(1) {
                assert!(!allowed.is_empty() && rest.starts_with(allowed), "{}: {crate_name}", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen >= 4, "{seen}");
}

#[test]
fn the_last_digit_of_a_stiff_spring_is_rounding_and_a_wrong_force_is_not() {
    let oracle = read(
        "mechanism Stiff; coord x: m = 1; coord y: m = 1; body one { mass: 1, com: [x, 0] } \
         body other { mass: 1, com: [y, 0] } \
         tsda stiff { from: [x, 0], to: [y + 1m, 0], stiffness: 1e9, length: 1 } \
         tsda soft { from: [-1, 0], to: [x, 0], stiffness: 10, length: 1 }",
    )
    .expect("a text");
    // The spring pulls `one` by 5 N and `other` by −5 N, as far as digits of metres have that stretch.
    let state = OracleState {
        q: vec![1.0, 1.0 + 5e-9],
        qd: vec![0.3; 2],
        qdd: vec![5.0 - 10.0, -5.0],
        ..OracleState::default()
    };
    let open = |state: &OracleState| {
        let w = [0.7, -0.9];
        let balance = oracle.equations_of_motion(state, &w).expect("a balance");
        let rounding =
            oracle.rounding_of_equations(state, &w, (&[1.0; 2], 4.0 * f64::EPSILON)).expect("its rounding");
        [balance.open(), balance.without(rounding).open()]
    };
    let [as_it_is, without] = open(&state);
    assert!(as_it_is > 1e-9 && without == 0.0, "{as_it_is:e} {without:e}");
    let wrong = OracleState { qdd: vec![-5.001, -5.0], ..state };
    let [_, without] = open(&wrong);
    assert!(without > 1e-5, "{without:e}");
    assert!(!oracle.has_contacts());
}

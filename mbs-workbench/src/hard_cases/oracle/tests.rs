//! The oracle against closed forms, and its independence of the compiler of texts.

use std::fs;
use std::path::Path;
use std::rc::Rc;

use super::{Gap, HeldForces, Jet, Oracle, OracleState, Slack};

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
fn rows_that_effects_release_are_not_there_and_carry_no_force() {
    let base = PENDULUM.replace(
        "constraint rod {",
        "force drag: [1 [1/m]*lambda(rod.0) + lambda(rod[1])*1 [1/m^2], 0] on p; constraint rod { p[0] == L*1;",
    );
    let source =
        format!("{base} effect none {{}} effect cut {{ release rod; }} scene Whole = none; scene Cut = cut;");
    let known = |name: &str| Some(if name == "L" { 2.0 } else { 3.0 });
    let of = |scene| Oracle::read(&source, scene, &known).expect("a text");
    assert_eq!([None, Some("Cut"), Some("Whole")].map(|scene| of(scene).row_count()), [0, 0, 2]);
    let falling = OracleState { qdd: vec![0.0, -10.0], lambda: Vec::new(), ..lowest(1.5) };
    for w in [[1.0, 0.0], [0.3, -0.7]] {
        let balance = of(Some("Cut")).equations_of_motion(&falling, &w).expect("a balance");
        assert!(balance.open() < 1e-15, "{balance:?}");
    }
    assert!(of(Some("Cut")).rows(&falling).expect("rows").is_empty());
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

/// Polar radius (m) of a circle of 20 mm, 5 mm beside the centre, with two derivatives.
fn eccentric(w: f64) -> Vec<f64> {
    let (sin, cos) = w.sin_cos();
    let root = (4e-4 - 2.5e-5 * sin * sin).sqrt();
    let slope = -2.5e-5 * sin * cos / root;
    let second = -2.5e-5 * (cos * cos - sin * sin) / root - slope * slope / root;
    vec![5e-3 * cos + root, -5e-3 * sin + slope, -5e-3 * cos + second]
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
fn places_of_parametric_curves_are_read() {
    let source = "mechanism Rim; function x: [m; 2](rad), C3, periodic TAU; coord theta: rad; coord w: rad; \
        curve rim = parametric x[1], x[0] about [3mm, theta*1mm] turned theta; \
        constraint at { place(w, rim).0 == 0m; } out there: [m; 2] = place(w, rim); out apart: m = distance([1m, 0m], rim);";
    // x = 3 cos, y = 2 sin.
    let ellipse = |name: &str| -> Option<Jet> {
        let (a, b) = if name == "x[1]" { (3.0, 0.0) } else { (0.0, 2.0) };
        Some(Rc::new(move |w: f64| {
            let (sin, cos) = w.sin_cos();
            vec![a * cos + b * sin, b * cos - a * sin, -a * cos - b * sin]
        }))
    };
    let oracle = Oracle::with_functions(source, None, &|_| None, &ellipse).expect("a text");
    let state =
        OracleState { q: vec![0.7, 0.4], qd: vec![2.0, -0.3], qdd: vec![0.0; 2], ..OracleState::default() };
    let place = |theta: f64, w: f64| {
        let ((s, c), (sin, cos)) = (theta.sin_cos(), w.sin_cos());
        [3e-3 + c * 3.0 * cos - s * 2.0 * sin, theta * 1e-3 + s * 3.0 * cos + c * 2.0 * sin]
    };
    let there = oracle.quantities("there", &state).expect("an output");
    let rates = [0, 1].map(|k| {
        let at = |h: f64| place(0.7 + 2.0 * h, 0.4 - 0.3 * h)[k];
        (at(1e-5) - at(-1e-5)) / 2e-5
    });
    for (k, found) in there.iter().enumerate() {
        assert!((found.value - place(0.7, 0.4)[k]).abs() < 1e-15, "{}", found.value);
    }
    let row = &oracle.rows(&state).expect("rows")[0];
    assert!(
        row.phi.is_some_and(|phi| (phi - place(0.7, 0.4)[0]).abs() < 1e-15)
            && (row.rate - rates[0]).abs() < 1e-8
    );
    let apart = oracle.quantities("apart", &state);
    assert!(matches!(&apart, Err(Gap(words)) if words.contains("parametric")));
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
        (format!("friction f {{ {sliding}, sticks: 0.3 }}"), "the force of `f`"),
        ("contact c { gap: p[1] + 2m, restitution: 0.5 }".to_string(), "the force of `c`"),
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
    assert!(balance(&format!("friction f {{ {sliding}, bristles: 1mm }}")).is_ok());
    assert!(balance(&format!("contact c {{ {pressing}, damping: 0.5 }}")).is_ok());
    assert!(balance(&format!("contact c {{ {pressing}, restitution: 0.5, approach: 1 }}")).is_ok());
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

const SLOPE: &str = "mechanism Block; param mu: 1 = 0.4; coord p: [m; 2]; body block { mass: 2kg, com: p } \
    gravity weight { acceleration: [3, -10] } friction rub { along: p[0], normal: normal(floor), coefficient: 0.25, sticks: 0.4 } \
    contact floor { gap: p[1], restitution: 0.5 }";

/// Forces of the block on its floor, and the laws that they break.
fn held(source: &str, state: &OracleState) -> HeldForces {
    let oracle = Oracle::read(source, None, &|_| Some(0.4)).expect("a text");
    let slack = Slack { rows: 1e-8, forces: 1e-7, pace: [1.0, 10.0] };
    let found = oracle.held(state, &[1.0; 2], slack).expect("forces");
    let with = OracleState { held: found.forces.clone(), ..state.clone() };
    let open = oracle.equations_of_motion(&with, &[0.3, -0.8]).expect("a balance").open();
    assert!(open < 1e-14 || !found.broken.is_empty() || state.t > 0.0, "{found:?} {open:e}");
    found
}

#[test]
fn forces_that_hold_are_found_and_keep_their_laws() {
    let state = |q: [f64; 2], qd: [f64; 2], qdd: [f64; 2]| OracleState {
        q: q.to_vec(),
        qd: qd.to_vec(),
        qdd: qdd.to_vec(),
        ..OracleState::default()
    };
    let near = |found: &HeldForces, forces: [f64; 2]| {
        let apart = found.forces.iter().zip(forces).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-13 && !found.is_shared, "{found:?} {forces:?}");
    };
    let words = |found: &HeldForces| found.broken.join(", ");
    // It sticks: 6 N of at most 0.4 · 20 N.
    let sticks = held(SLOPE, &state([1.0, 0.0], [0.0; 2], [0.0; 2]));
    near(&sticks, [-6.0, 20.0]);
    assert!(sticks.broken.is_empty(), "{sticks:?}");
    // It slides either way, with 5 N against it.
    for sign in [1.0, -1.0] {
        let slides = held(SLOPE, &state([1.0, 0.0], [0.2 * sign, 0.0], [3.0 - 2.5 * sign, 0.0]));
        near(&slides, [-5.0 * sign, 20.0]);
        assert!(slides.broken.is_empty(), "{slides:?}");
    }
    // Friction that pushes on, the floor that pulls, what is held beyond the limit, and what moves below it.
    let pushed = state([1.0, 0.0], [0.2, 0.0], [5.5, 0.0]);
    let with = OracleState { held: held(SLOPE, &OracleState { t: 1.0, ..pushed.clone() }).forces, ..pushed };
    let oracle = Oracle::read(SLOPE, None, &|_| Some(0.4)).expect("a text");
    assert!(oracle.equations_of_motion(&with, &[1.0, 0.1]).expect("a balance").open() > 0.1);
    let pulls = held(SLOPE, &state([1.0, 0.0], [0.0; 2], [3.0, -12.0]));
    assert!(words(&pulls).contains("`floor` pulls with 4.0e0"), "{pulls:?}");
    let steep = SLOPE.replace("[3, -10]", "[5, -10]");
    let beyond = held(&steep, &state([1.0, 0.0], [0.0; 2], [0.0; 2]));
    assert!(words(&beyond).contains("its limit"), "{beyond:?}");
    let creeps = held(SLOPE, &state([1.0, 0.0], [0.0; 2], [1.0, 0.0]));
    assert!(words(&creeps).contains("below its limit"), "{creeps:?}");
    let lifted = held(SLOPE, &state([1.0, 0.0], [0.0; 2], [1.5, 1.0]));
    assert!(words(&lifted).contains("`floor` pushes"), "{lifted:?}");
    // In the air, and below the ground.
    near(&held(SLOPE, &state([1.0, 0.3], [0.2, 0.1], [3.0, -10.0])), [0.0, 0.0]);
    let deep = held(SLOPE, &state([1.0, -1e-3], [0.0; 2], [3.0, -10.0]));
    assert!(words(&deep).contains("gap of `floor`"), "{deep:?}");
    let drives = |source: &str| {
        let oracle = Oracle::read(source, None, &|_| Some(0.4)).expect("a text");
        oracle.drives_contacts(&state([1.0, 0.3], [0.2, 0.1], [0.0; 2])).expect("an answer")
    };
    assert!(!drives(SLOPE) && drives(&SLOPE.replace("gap: p[1]", "gap: p[1] - 2mm*sin(t/1s)")));
    // Two floors share what they push with.
    let shared = held(
        &format!("{SLOPE} contact other {{ gap: 2*p[1], restitution: 0 }}"),
        &state([1.0, 0.0], [0.0; 2], [0.0; 2]),
    );
    assert!(shared.is_shared && shared.broken.is_empty(), "{shared:?}");
}

#[test]
fn bristles_a_contact_with_restitution_and_forces_by_name_have_their_laws() {
    let source = "mechanism Laws; coord x: m; coord y: m; body block { mass: 1kg, com: [x, y] } \
        friction ground { along: x, normal: 10N, coefficient: 0.1, sticks: 0.15, speed: 0.2, bristles: 0.1mm, damping: 100, viscous: 0.4 } \
        contact floor { gap: y, stiffness: 1e4, restitution: 0.5, approach: 2 } \
        tsda spring { from: [0, 0], to: [x, 0], stiffness: 50, length: 0.1, damping: 3 } \
        out all: N = force(ground) + 1000*force(floor); out z: m = deflection(ground); out pull: N = force(spring); \
        out power: W = power(floor); out gap: m = gap(floor); out slip: m/s = slip(ground);";
    let oracle = Oracle::read(source, None, &|_| None).expect("a text");
    let state = OracleState {
        q: vec![0.3, -2e-3],
        qd: vec![0.2, -0.5],
        qdd: vec![0.0; 2],
        states: vec![4e-5],
        ..OracleState::default()
    };
    let found = |name: &str| oracle.quantities(name, &state).expect("an output")[0].value;
    let level = 0.1 + 0.05 * (-1.0_f64).exp();
    let rate = 0.2 - 0.2 * 4e-5 * 0.1 / (1e-4 * level);
    let ground = -(1.0 * (0.4 + 100.0 * rate) + 0.4 * 0.2);
    // The root of c − ln(1 + c) = −c/2 − ln(1 − c/2), by mpmath.
    let c = 1.432_750_533_271_375;
    let floor = 1e4 * 2e-3 * (1.0 + c / 2.0 * 0.5);
    let close = |a: f64, b: f64, within: f64| assert!((a - b).abs() < within * b.abs(), "{a} {b}");
    close(found("all") - ground, 1000.0 * floor, 1e-12);
    close(found("pull"), 50.0 * 0.2 + 3.0 * 0.2, 1e-13);
    close(found("power"), floor * -0.5, 1e-12);
    assert_eq!([found("z"), found("gap"), found("slip")], [4e-5, -2e-3, 0.2]);
    let balance = oracle.equations_of_motion(&state, &[1.0, 0.0]).expect("a balance");
    close(balance.sum, -(ground - 10.0 - 0.6), 1e-12);
}

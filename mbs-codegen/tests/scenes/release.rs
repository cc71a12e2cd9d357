//! Scenes whose effects release constraints: the texts without these constraints, and without what their forces make.

use std::collections::BTreeMap;

use super::dynamic_items;

/// A box on a floor that a rope holds, and a wall.
const BOX: &str = "mechanism M; param mu: 1 = 0.3; param v: m/s = 0.02;
    coord p: [m; 2] = [0.1, 0]; coord q: [m; 3] = [0.1, 0.2, 0.3];
    body block { mass: 2kg, com: p } for i in 0..3 { body ball { mass: 1kg + i*1kg, com: [q[i], 1m] } }
    gravity weight { acceleration: [1, -9.81] }
    FLOOR
    constraint rope { norm(p + [0, 1m]) == 1.005m; }
    start p = [0.1, 0] rate [0.5, 0];";
/// Two rows of other units, one of them in a loop.
const FLOOR: &str =
    "constraint floor { p[1] == 0; for i in 1..3 { q[i]*q[0] == i*0.01 [m^2] + 0.01 [m^2]; } }";

/// Statements with forces of the floor, and the same where it is not there.
const USES: [(&str, &str); 15] = [
    ("out n: N = lambda(floor.0);", "out n: N = 0N;"),
    ("out n: [1/s^2; 3] = [lambda(floor.0)/1kg/1m, 2*lambda(floor.1)*1m/1kg/1m, 0];", "out n: [1/s^2; 3] = [0, 0, 0];"),
    ("out n: N = hypot(lambda(floor.0), 2*lambda(floor[0])) + 3N;", "out n: N = 3N;"),
    ("friction rub { along: p[0], normal: lambda(floor.0), coefficient: mu, speed: v }", ""),
    (
        "friction rub { along: p[0], normal: 2*lambda(floor.0), coefficient: 0.2, speed: v, viscous: 3 }",
        "force rub: -3 [N*s/m]*der(p[0]) on p[0];",
    ),
    ("friction rub { along: p[0], normal: abs(lambda(floor.0)), coefficient: mu, sticks: 0.4 }", ""),
    ("friction rub { along: p[0], normal: lambda(floor.0), coefficient: mu, bristles: 1um }", ""),
    (
        "friction rub { along: p[0], normal: lambda(floor.0), coefficient: mu, sticks: 0.4 } out f: N = force(rub);
         out w: W = power(rub); out s: m/s = slip(rub);",
        "out f: N = 0N; out w: W = 0W; out s: m/s = der(p[0]);",
    ),
    (
        "friction rub { along: p[0], normal: lambda(floor.0), coefficient: mu, bristles: 1um } out z: m = deflection(rub);",
        "out z: m = 0m;",
    ),
    ("force rub: -mu*abs(lambda(floor.0))*tanh(der(p[0])/v) on p[0];", ""),
    ("force rub: [lambda(floor.0), lambda(floor.0)*sin(t/1s)/exp(t/1s)] on p; out f: N = force(rub).0;", "out f: N = 0N;"),
    (
        "force push: [1N - lambda(floor.0), 5N + mu*lambda(floor.0)] on p;",
        "force push: [1N, 5N] on p;",
    ),
    (
        "tsda s { from: [0, 2m], to: p, stiffness: 5, length: 1, actuator: lambda(floor.0) }",
        "tsda s { from: [0, 2m], to: p, stiffness: 5, length: 1 }",
    ),
    ("friction rub { along: p[0], normal: max(lambda(floor.0), 0), coefficient: mu, speed: v }", ""),
    ("force rub: -mu*lambda(floor.0) on p[0]; dissipation d = lambda(floor.0)*der(p[0]);", ""),
];

fn text(floor: &str, rest: &str) -> String {
    format!("{}\n{rest}", BOX.replace("FLOOR", floor))
}

/// An effect that releases, written before the base, behind it, by two of three, with others beside it.
const EFFECTS: [(&str, &str); 4] = [
    ("", "effect air { release floor; } scene In = air; effect none {} scene Out = none;"),
    ("effect air { release floor; } scene In = air; effect none {} scene Out = none;", ""),
    (
        "effect air { release floor; } effect gas { release floor; } effect none {}",
        "scene In = gas + none + air; scene Out = none; scene Other = gas;",
    ),
    ("", "effect air { release floor, wall; } scene In = air; effect none {} scene Out = none;"),
];

#[test]
fn a_scene_that_releases_a_constraint_is_the_text_without_it() {
    for (number, (written, cut)) in USES.iter().enumerate() {
        let (before, behind) = EFFECTS[number % EFFECTS.len()];
        let wall = if behind.contains("wall") { "constraint wall { q[0] == 0.1m; }" } else { "" };
        let scenes = text(&format!("{before} {FLOOR} {wall}"), &format!("{written} {behind}"));
        let found = dynamic_items(&scenes, &[Some("In"), Some("Out")]);
        let never = dynamic_items(&text("", cut), &[None]).remove(0);
        let kept = dynamic_items(&text(&format!("{FLOOR} {wall}"), written), &[None]).remove(0);
        // What a force was made of has no code; its nodes may order others.
        let costs = |text: &str, scene| {
            let report = mbs_codegen::structure_of(text, scene).unwrap_or_else(|faults| panic!("{faults}"));
            report.costs.iter().map(|(name, cost)| format!("{name}: {cost:?}")).collect::<Vec<_>>()
        };
        let is_made =
            ["sticks", "force ", "force:", "bristles", "2*lambda"].iter().any(|word| written.contains(word));
        if is_made {
            assert_eq!(costs(&scenes, Some("In")), costs(&text("", cut), None), "{written}");
        }
        for (key, item) in never.iter().filter(|_| !is_made) {
            assert_eq!(found[0].get(key), Some(item), "`{key}` of {written}");
        }
        // A friction of which the viscous part is left has checked fields.
        let is_checked = |key: &&String| *key == "Dynamic::NON_NEGATIVE" || *key == "Dynamic::signed";
        let keys = |items: &BTreeMap<String, String>| {
            items.keys().filter(|key| !is_checked(key)).cloned().collect::<Vec<_>>()
        };
        assert_eq!(keys(&found[0]), keys(&never), "{written}");
        assert_eq!(found[1], kept, "{written}");
        assert_ne!(found[0], found[1]);
    }
}

#[test]
fn all_effects_have_the_rows_released() {
    let of = |rest: &str| {
        mbs_codegen::structure_of(&text(FLOOR, rest), None).unwrap_or_else(|faults| panic!("{faults}"))
    };
    let rows = |rest: &str| of(rest).rows.iter().map(|row| row.name.clone()).collect::<Vec<_>>();
    assert_eq!(rows(""), ["floor.0", "floor.1", "floor.2", "rope"]);
    assert_eq!(rows("effect air { release floor; }"), ["rope"]);
    assert_eq!(rows("effect air { release floor; } effect gas { release rope, floor; }"), [""; 0]);
}

#[test]
fn rows_in_loops_redundant_rows_and_touches_of_curves_are_released() {
    let base = "mechanism M; function r: m(rad), C3, periodic TAU; coord p: [m; 2] = [0.1, 0]; coord q: [m; 2] = [0.1, 0.2];
        curve cam = polar r about [0, 0]; body block { mass: 2kg, com: p } body ball { mass: 1kg, com: q }
        force f: r(p[0]*1 [1/m])*1 [N/m] on p[1]; out far: m = distance(q, cam);";
    for (rows, use_of) in [
        ("for i in 0..2 { constraint bars { p[i] == q[i] + 0.1m; } }", "out n: [N; 2] = lambda(bars);"),
        ("constraint bars redundant within 1um { p == q; p[0] == q[0]; }", "out n: [N; 3] = lambda(bars);"),
        ("constraint bars { p on cam; q on cam; }", "out n: [N; 2] = lambda(bars);"),
        ("constraint bars { for i in 0..2 { p[i] == q[i]; } }", "out n: [N; 2] = lambda(bars);"),
    ] {
        let released = format!("{base} {rows} {use_of} effect air {{ release bars; }} scene In = air;");
        let found = dynamic_items(&released, &[Some("In")]).remove(0);
        let zeros = if rows.contains("redundant") { "[N; 3] = [0, 0, 0]" } else { "[N; 2] = [0, 0]" };
        let never = dynamic_items(&format!("{base} out n: {zeros};"), &[None]).remove(0);
        assert_eq!(found.len(), never.len(), "{rows}");
        for (key, item) in &never {
            assert_eq!(found.get(key), Some(item), "`{key}` of {rows}");
        }
    }
}

#[test]
fn rows_that_are_released_count_as_written() {
    let large = "mechanism M; const N: 1 = 2000; coord x: [m; N] = 0; for i in 0..N { body b { mass: 1kg, com: [x[i], 0] } }
        for i in 0..2000 { for j in 0..4 { constraint c { x[i] == j*1m + 2m*sin(t/1s + i); } } } effect e { release c; }";
    let fault = mbs_codegen::expand_source(large).expect_err("8000 rows");
    assert!(fault.contains("more than 6000 rows"), "{fault}");
}

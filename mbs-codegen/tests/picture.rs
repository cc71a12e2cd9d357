//! Statements of the picture: no code is emitted for them, and the values read from them.
#![forbid(unsafe_code)]

use std::fs;
use std::path::Path;

use mbs_codegen::picture::{Along, Picture, PlaceKind, Preset, Shape, Span};
use mbs_codegen::{expand_source, picture};
use proc_macro2::{TokenStream, TokenTree};

/// Emitted tokens; the text that they carry is left out.
fn code(text: &str) -> String {
    fn write(tokens: TokenStream, code: &mut String) {
        for tree in tokens {
            match tree {
                TokenTree::Group(group) => {
                    *code += &format!("{:?} ", group.delimiter());
                    write(group.stream(), code);
                    *code += "end ";
                }
                // The text, which is longer than any line of documentation.
                TokenTree::Literal(literal) if literal.to_string().contains("coord ") => *code += "TEXT ",
                tree => *code += &format!("{tree} "),
            }
        }
    }
    let mut code = String::new();
    write(expand_source(text).unwrap_or_else(|faults| panic!("{faults}{text}")), &mut code);
    assert_eq!(code.matches("TEXT").count(), 1, "{text}");
    code
}

/// Texts of the ready mechanisms, out of the files of the workspace.
fn ready() -> Vec<String> {
    fn collect(folder: &Path, texts: &mut Vec<String>) {
        let mut entries: Vec<_> =
            fs::read_dir(folder).expect("a folder").map(|e| e.expect("a file").path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                collect(&path, texts);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let file = fs::read_to_string(&path).expect("a text file");
                texts.extend(
                    file.split("\nmechanism! {\n")
                        .skip(1)
                        .filter_map(|rest| rest.split_once("\n}\n").map(|(text, _)| text.to_owned())),
                );
            }
        }
    }
    let mut texts = Vec::new();
    collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../mechanisms/src"), &mut texts);
    assert!(texts.len() >= 40, "{} texts", texts.len());
    texts
}

/// Statements of the picture that fit any text, with all points that its scenes share.
fn drawn(text: &str) -> String {
    let shared = text.split("effect ").next().unwrap_or(text);
    let points = shared.split("\n    out ").skip(1).filter_map(|rest| {
        let (name, unit) = rest.split_once(": [m; ")?;
        ["2]", "3]"].iter().any(|shape| unit.starts_with(shape)).then_some(name)
    });
    let points: String =
        points.map(|point| format!("draw joint {point}; trace \"path\": {point}; ")).collect();
    let headings = match text.contains("title \"") {
        true => "",
        false => "title \"A title\"; about \"One sentence.\" \" Another.\"; span 2s; ",
    };
    format!("{text} {headings}preset \"as it is, once more\" \"in a phrase\" {{ }} {points}")
}

#[test]
fn ready_mechanisms_have_the_same_code_with_and_without_a_picture() {
    let mut points = 0;
    for text in ready() {
        let with = drawn(&text);
        points += with.matches("draw joint").count();
        assert_eq!(code(&with), code(&text), "{text}");
    }
    assert!(points > 100, "{points} points");
}

/// Effects, scenes, loops and lengths that would change the code if they were seen.
const SCENES: &str = "pub mechanism Machine; param r: m = 50mm; param L: m = 0.18; const N: 1 = 2; @1
coord theta: rad = 0.8; coord phi: rad = -0.2; coord x: m = 0.2; @2
constraint closure { r*unit(theta) + L*unit(phi) == [x, 0]; } branch ahead: cos(phi) > 0;
out A: [m; 2] = r*unit(theta); out S: [m; 2] = [x, 0]; @3
for i in 0..N { @4 out mark: [m; 2] = [x + i*r, 0]; }
effect crank_driven { param omega: rad/s = 300rpm; drive motor: theta == omega*t; @5 }
effect slider_driven { drive gas: x == 0.18m + 20mm*sin(t/1s); branch up: sin(theta) > 0; @6 }
scene Pump = crank_driven @7
scene Engine = slider_driven @8
";

fn scenes(statements: [&str; 8]) -> String {
    let filled = statements.iter().enumerate();
    filled.fold(SCENES.to_owned(), |text, (index, statement)| {
        text.replace(&format!("@{}", index + 1), statement)
    })
}

const DRAWN: [&str; 8] = [
    "about \"A slider-crank.\";",
    "draw view \"from z\": right [1, 0, 0] up [0, 1, 0];",
    "let far = [[3, 0, 0], [0, 900m, 0]]; for i in 0..N { let P = far[i]/2; draw joint P, far[i]; }",
    "let place = [i*r, 0, 7m]; draw ground place;",
    "title \"Pump\"; span turn(omega); preset fast \"at twice the speed\" { omega: 600rpm, r: 40mm }",
    "span 3s;",
    "{ }",
    "{ title \"Engine\"; for i in 0..N { draw joint far[i]; } }",
];

#[test]
fn statements_in_effects_scenes_and_loops_leave_no_code() {
    let mut bare = [""; 8];
    // Statements that are not of the picture stay.
    bare[2] = "let far = [[3, 0, 0], [0, 900m, 0]];";
    bare[3] = "let place = [i*r, 0, 7m];";
    (bare[6], bare[7]) = (";", ";");
    assert_eq!(code(&scenes(DRAWN)), code(&scenes(bare)));
}

#[test]
fn a_scene_has_the_statements_of_its_effects_and_its_own() {
    let text = scenes(DRAWN);
    let pump = picture(&text, Some("Pump")).expect("a picture");
    assert_eq!((pump.title.as_str(), pump.about.as_str()), ("Pump", "A slider-crank."));
    assert_eq!(pump.span, Some(Span::Turn { rate: "omega".into() }));
    let twice = 600.0 * core::f64::consts::PI / 30.0;
    let set = vec![("omega".to_owned(), twice), ("r".to_owned(), 0.04)];
    assert_eq!(
        pump.presets,
        [Preset { label: "fast".into(), description: "at twice the speed".into(), set }]
    );
    let engine = picture(&text, Some("Engine")).expect("a picture");
    assert_eq!((engine.title.as_str(), engine.span.clone()), ("Engine", Some(Span::Seconds(3.0))));
    assert_eq!(engine.shapes.len(), pump.shapes.len() + 2);
    assert!(engine.presets.is_empty());
    let names: Vec<&str> = pump.places().iter().map(|place| place.name.as_str()).collect();
    assert_eq!(names, ["P.0", "far.0", "P.1", "far.1", "place.0", "place.1"]);
    let points = pump.points([&[0.0; 3], &[], &[]], 0.0, &[0.05, 0.18, 31.0]);
    assert_eq!(points[1..4], [[3.0, 0.0, 0.0], [0.0, 450.0, 0.0], [0.0, 900.0, 0.0]]);
    assert_eq!(points[5], [0.05, 0.0, 7.0]);
}

#[test]
fn a_scene_leaves_out_the_values_of_presets_that_belong_to_other_effects() {
    let text = "mechanism Door; coord phi: rad = 0.1; param opened: rad = 1; body leaf { mass: 1kg, com: [0, 0], inertia: 1, angle: phi }
        effect wind { param gust: N*m = 0; torque wind: -gust on phi; } effect closer { torque shut: -1 on phi; }
        start phi = opened rate 0; out turned: rad = phi;
        preset gust \"a gust\" { opened: 2, gust: 3 }
        scene Calm = closer; scene Windy = closer + wind;";
    let set = |scene: &str| picture(text, Some(scene)).expect("a picture").presets[0].set.clone();
    assert_eq!(set("Calm"), [("opened".to_owned(), 2.0)]);
    assert_eq!(set("Windy"), [("opened".to_owned(), 2.0), ("gust".to_owned(), 3.0)]);
    assert!(mbs_codegen::expand_source(text).is_ok());
    // A name that no effect declares is none in any scene.
    let wrong = text.replace("gust: 3 }", "guts: 3 }");
    let faults = mbs_codegen::expand_source(&wrong).expect_err("an unknown parameter");
    assert!(faults.contains("`guts` is no parameter or input"), "{faults}");
}

#[test]
fn two_titles_of_one_scene_are_an_error_and_those_of_two_scenes_are_none() {
    let mut statements = DRAWN;
    statements[0] = "title \"Of both\";";
    let faults = expand_source(&scenes(statements)).expect_err("two titles");
    assert!(faults.contains("`title` stands twice\n"), "{faults}");
    let whole = picture(&scenes(DRAWN), None).expect("the first of the titles");
    assert_eq!(whole.title, "Pump");
}

const BAR: &str = "/// A bar on a slide.
///
/// More of it.
mechanism Bar; param L: [m; 2] = [0.3, 0.4]; const N: 1 = 20; input f: m, rates; coord phi: rad = 0.3; coord s: m = 0.3;
constraint slide { L[0]*cos(phi) == s; } drive crank: phi == 2*t/1s;
out A: [m; 2] = L[0]*unit(phi); out S: [m; 2] = [s, 0]; out along: [1; 2] = unit(phi); out speed: m/s = der(s); out all: [m; 2, 2] = [A_, S_];
let A_ = [L[0]*cos(phi), L[0]*sin(phi)]; let S_ = [s, 0]; let O = [0, 0]; let V = O + der(A_)*1s; let W = [f, 0]; let two = [A_, S_]; let half = phi/2;
body rod { mass: 1kg, com: A_/2 } body block { mass: 2kg, com: S_ } pin hinge: rod, ground at O; gravity weight { acceleration: [0, -9.81] }
tsda strut { from: O, to: S_, stiffness: 100, length: 0.2 }
";

fn shapes(statements: &str) -> Vec<Shape> {
    picture(&format!("{BAR}{statements}"), None).unwrap_or_else(|faults| panic!("{faults}")).shapes
}

#[test]
fn every_shape_is_read() {
    let text = |name: &str| name.to_owned();
    let all = "draw ground O, S; draw joint A; draw link crank: O, A; draw plate \"the plate\": O, A, S; draw slot: O, A;
        draw spring strut: strut.from, strut.to; draw slider S along [1, 0]; draw rail S along along; draw slider A along half;
        draw wheel W: O rim A; draw gear G: O rim A teeth N inside; draw gear G: O teeth 2*N rim S; draw cam C: O contact A turn phi;
        draw face F: O, A back S; draw geneva O pin A wheel S rim A slots 6; draw road R: S speed 36 [km/h]; trace S; trace \"a path\": A;";
    let expected = [
        Shape::Ground { at: text("O") },
        Shape::Ground { at: text("S") },
        Shape::Joint { at: text("A") },
        Shape::Link { points: vec![text("O"), text("A")], label: text("crank") },
        Shape::Plate { points: vec![text("O"), text("A"), text("S")], label: text("the plate") },
        Shape::Slot { points: vec![text("O"), text("A")], label: text("") },
        Shape::Spring { points: [text("strut.from"), text("strut.to")], label: text("strut") },
        Shape::Slider { at: text("S"), along: Along::Fixed([1.0, 0.0]) },
        Shape::Rail { at: text("S"), along: Along::Named(text("along")) },
        Shape::Slider { at: text("A"), along: Along::Named(text("half")) },
        Shape::Wheel { at: text("O"), rim: text("A"), label: text("W") },
        Shape::Gear { at: text("O"), rim: text("A"), teeth: 20, inside: true, label: text("G") },
        Shape::Gear { at: text("O"), rim: text("S"), teeth: 40, inside: false, label: text("G") },
        Shape::Cam { at: text("O"), contact: text("A"), turn: text("phi"), label: text("C") },
        Shape::Face { points: [text("O"), text("A")], back: text("S"), label: text("F") },
        Shape::Geneva { at: text("O"), pin: text("A"), wheel: text("S"), rim: text("A"), slots: 6 },
        Shape::Road { at: text("S"), speed: 10.0, label: text("R") },
        Shape::Trace { of: text("S"), label: text("S") },
        Shape::Trace { of: text("A"), label: text("a path") },
    ];
    assert_eq!(shapes(&all.replace("draw slot:", "draw slot")), expected);
}

#[test]
fn views_are_orthonormal() {
    let text = "mechanism M; coord x: m; drive d: x == 1m; let P = [x, 0, 0]; draw joint P;";
    for (view, label) in [
        ("draw view diagonal;", "from x = y = z, z upwards"),
        ("draw view \"a label\": right [1, 0, -1] up [-1, 2, -1];", "a label"),
        ("draw view front: up [0, 0, 7] right [3, 0, 0];", "front"),
    ] {
        let picture = picture(&format!("{text} {view}"), None).expect("a picture");
        let [_, Shape::View { right, up, label: found }] = picture.shapes.as_slice() else {
            panic!("a view")
        };
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (found, expected) in [(dot(right, right), 1.0), (dot(up, up), 1.0), (dot(right, up), 0.0)] {
            assert!((found - expected).abs() < 1e-15, "{view}");
        }
        assert_eq!(found, label);
    }
}

#[test]
fn a_label_in_a_loop_is_that_of_its_first_round() {
    let labels = |statements: &str| -> Vec<String> {
        let label = |shape| match shape {
            Shape::Link { label, .. } | Shape::Spring { label, .. } => Some(label),
            _ => None,
        };
        shapes(statements).into_iter().filter_map(label).collect()
    };
    assert_eq!(
        labels("for i in 0..2 { draw ground O; draw link bars: O, two[i]; draw spring s: O, two[i]; }"),
        ["bars", "s", "", ""]
    );
    assert_eq!(labels("draw link one: O, A; draw link one: A, S; draw link A, S;"), ["one", "one", ""]);
    assert_eq!(
        labels("for i in 0..2 { draw link one: O, two[i]; draw link other: A, two[i]; }"),
        ["one", "other", "one", "other"]
    );
}

/// Point of a picture at a state of [`BAR`].
fn at(picture: &Picture, name: &str) -> [f64; 3] {
    let place = picture.places().iter().position(|place| place.name == name).expect(name);
    let (q, qd) = ([0.5, 0.2], [2.0, -1.0]);
    picture.points([&q, &qd, &[0.0; 2]], 0.1, &[0.3, 0.4, 0.7, 0.0, 0.0])[place]
}

#[test]
fn points_are_outputs_lets_pins_bodies_and_springs() {
    let statements = "draw joint A, S, V, W, two[1], all[0], hinge, rod.com, strut.to; draw slider S along half; draw rail S along along;";
    let picture = picture(&format!("{BAR}{statements}"), None).expect("a picture");
    let (sin, cos) = 0.5_f64.sin_cos();
    for (name, expected) in [
        ("A", [0.3 * cos, 0.3 * sin, 0.0]),
        ("S", [0.2, 0.0, 0.0]),
        ("V", [-0.6 * sin, 0.6 * cos, 0.0]),
        ("W", [0.7, 0.0, 0.0]),
        ("two.1", [0.2, 0.0, 0.0]),
        ("all.0", [0.3 * cos, 0.3 * sin, 0.0]),
        ("hinge", [0.0; 3]),
        ("rod.com", [0.15 * cos, 0.15 * sin, 0.0]),
        ("strut.to", [0.2, 0.0, 0.0]),
        ("half", [0.25, 0.0, 0.0]),
        ("along", [cos, sin, 0.0]),
    ] {
        let found = at(&picture, name);
        // Sine, cosine and product are each rounded once.
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{name}: {found:?}");
    }
    let outputs: Vec<bool> = picture.places().iter().map(|place| place.is_output).collect();
    assert_eq!(outputs, [true, true, false, false, false, true, false, false, false, false, true]);
    assert_eq!(picture.places()[9].kind, PlaceKind::Angle);
}

#[test]
fn a_point_of_a_called_function_must_be_an_output() {
    let text = "mechanism Cam; function lift: m(rad), C2; coord phi: rad = 0; coord y: m = 0; constraint c { y == lift(phi); }
        drive d: phi == 2*t/1s; let top = [0m, lift(phi)]; out tip: [m; 2] = top; out base: [m; 2] = [0, y];";
    let faults = expand_source(&format!("{text} draw joint top;")).expect_err("no output");
    assert!(
        faults.contains("the point `top` calls a function of the caller\n  help: make it an output"),
        "{faults}"
    );
    let picture = picture(&format!("{text} draw link \"follower\": base, tip;"), None).expect("a picture");
    let evaluated: Vec<bool> = picture.places().iter().map(|place| place.is_evaluated).collect();
    assert_eq!(evaluated, [true, false]);
    let points = picture.points([&[0.1, 0.2], &[0.0; 2], &[0.0; 2]], 0.0, &[]);
    assert_eq!(points[0], [0.0, 0.2, 0.0]);
    assert!(points[1].iter().all(|x| x.is_nan()));
}

#[test]
fn words_of_the_picture_are_names_elsewhere() {
    let text = "mechanism M; coord trace: rad = 0; param title: m = 1; param span: rad/s = 2; let draw = title*unit(trace);
        drive about: trace == span*t; out preset: [m; 2] = draw; draw joint draw; trace preset; span turn(span);";
    let picture = picture(text, None).expect("a picture");
    assert_eq!(
        picture.places().iter().map(|place| place.name.as_str()).collect::<Vec<_>>(),
        ["draw", "preset"]
    );
    expand_source(text).expect("a text without faults");
}

#[test]
fn headings_fall_back_on_name_and_doc_comment() {
    let picture = picture(BAR, None).expect("a picture");
    assert_eq!((picture.title.as_str(), picture.about.as_str()), ("Bar", "A bar on a slide."));
    assert_eq!((picture.span, picture.presets.len()), (None, 0));
}

#[test]
fn a_text_without_drawing_statements_has_a_guessed_picture() {
    let guessed = |text: &str| {
        let picture = picture(text, None).unwrap_or_else(|faults| panic!("{faults}"));
        assert!(picture.is_guessed);
        let used: Vec<&str> = picture.shapes.iter().flat_map(Shape::points).collect();
        assert!(picture.places().iter().all(|place| used.contains(&place.name.as_str())));
        format!("{:?}", picture.shapes).replace("label: \"\"", "")
    };
    let bodies = guessed(BAR);
    for part in [
        "Ground { at: \"hinge\" }",
        "Link { points: [\"hinge\", \"rod.com\"], label: \"rod\" }",
        "Joint { at: \"block.com\" }",
        "Spring { points: [\"strut.from\", \"strut.to\"], label: \"strut\" }",
    ] {
        assert!(bodies.contains(part), "{part} in {bodies}");
    }
    let outputs = guessed(
        "mechanism M; coord x: m; drive d: x == 1m; out O: [m; 2] = [0, 0]; out A: [m; 2] = [x, 0];
        out both: [m; 2, 2] = [[0, x], [x, x]]; out v: [m/s; 2] = [1, 2];",
    );
    for part in ["Ground { at: \"O\" }", "[\"O\", \"A\"]", "[\"A\", \"both.0\"]", "[\"both.0\", \"both.1\"]"]
    {
        assert!(outputs.contains(part), "{part} in {outputs}");
    }
    assert!(!outputs.contains("\"v\""), "{outputs}");
    let spatial = guessed(
        "mechanism M; coord x: m; drive d: x == 1m; out O: [m; 3] = [0, 0, 0]; out A: [m; 3] = [x, 0, 0];",
    );
    assert!(spatial.starts_with("[View"), "{spatial}");
    let masses = guessed(
        "mechanism M; coord p: [m; 2] = 0; body ball { mass: 1kg, com: p } gravity g { acceleration: [0, -9.81] }",
    );
    assert_eq!(masses, "[Joint { at: \"ball.com\" }]");
    assert_eq!(guessed("mechanism M; coord x: m; drive d: x == 1m;"), "[]");
}

#[test]
fn every_ready_mechanism_has_a_picture() {
    for text in ready() {
        let scenes: Vec<Option<&str>> = match text.split("\n    scene ").count() {
            1 => vec![None],
            _ => text
                .split("\n    scene ")
                .skip(1)
                .map(|rest| rest.split_once(" =").map(|(name, _)| name))
                .collect(),
        };
        for scene in scenes {
            let picture = picture(&text, scene).unwrap_or_else(|faults| panic!("{faults}{text}"));
            assert!(!picture.shapes.is_empty(), "{text}");
        }
    }
}

#[test]
fn outputs_that_are_forces_in_pins_have_their_places() {
    let text = "pub mechanism Arm;
        param L: m = 0.5;
        coord phi: rad = 0.3;
        let tip = L*unit(phi);
        body arm { mass: 2kg, inertia: 0.1 [kg*m^2], com: tip/2, angle: phi }
        body load { mass: 1kg, com: tip }
        gravity weight { acceleration: [0, -9.81] }
        pin bearing: ground, arm at [0, 0];
        pin end: arm, load at tip;
        start phi = 0.3 rate 0;
        out on_arm: [N; 2] = reaction(bearing, arm);
        out on_load: [N; 2] = reaction(end, load);
        out back: [N; 2] = reaction(end, arm);
        out twice: [N; 2] = 2*reaction(end, arm);
        out along: N = dot(reaction(end, arm), unit(phi));
        draw link arm: bearing, end;";
    let picture = picture(text, None).unwrap_or_else(|faults| panic!("{faults}"));
    let found: Vec<(&str, &str)> =
        picture.forces.iter().map(|force| (force.output.as_str(), force.at.as_str())).collect();
    assert_eq!(found, [("on_arm", "bearing"), ("on_load", "end"), ("back", "end")]);
    let at = |name: &str| {
        let place = picture.places().iter().position(|place| place.name == name).expect("a place");
        picture.points([&[0.3], &[0.0], &[0.0]], 0.0, &[0.5])[place]
    };
    assert_eq!(at("bearing"), [0.0; 3]);
    assert!((at("end")[0] - 0.5 * 0.3_f64.cos()).abs() < 1e-15, "{:?}", at("end"));
    assert_eq!(picture.places().iter().filter(|place| place.name == "end").count(), 1, "each place once");
}

//! K8: `function Some|Ok|Err|None` and `mechanism gen` gave errors of the compiler in emitted code.

use std::collections::BTreeSet;

use mbs_codegen::expand_source;
use mbs_runtime::{Function, Mechanism, Scalar, Stepper, mechanism};
use proc_macro2::{TokenStream, TokenTree};

/// Keywords of all editions, reserved and weak ones; words of the language; names of the prelude, of primitive types, of the
/// emitted code and of the runtime.
const NAMES: &str = "as break const continue crate else enum extern false fn for if impl in let loop match mod move mut \
    pub ref return self Self static struct super trait true type unsafe use where while async await dyn abstract become \
    box do final macro override priv typeof unsized virtual yield try gen union auto macro_rules raw safe default \
    mechanism param coord constraint drive branch out effect scene start limit body pin force torque function input state \
    independent gravity periodic redundant rates at on of \
    Some None Ok Err Option Result Vec String Box Copy Clone Debug Default Drop Fn From Into Iterator Send Sync Sized \
    PartialEq Eq Ord ToString f64 f32 usize u8 i32 bool str char core std alloc mbs_runtime \
    T S R N M K Scalar Function Mechanism Kinematic Dynamic Partitioned AllEffects Lanes Entry Signal Phase Parameters Position \
    Factors Coordinates PhantomData new get set phases lane scalar coordinate value parameters position q qd x _ \
    __S __Parameters __scene __mbs";

fn names() -> impl Iterator<Item = &'static str> {
    NAMES.split_whitespace()
}

/// `true` if the tokens contain the word as an identifier that is not raw.
fn has_word(tokens: TokenStream, word: &str) -> bool {
    tokens.into_iter().any(|tree| match tree {
        TokenTree::Group(group) => has_word(group.stream(), word),
        TokenTree::Ident(identifier) => identifier == word,
        _ => false,
    })
}

/// Checks that a text expands to Rust, or that its faults are reported at the name, each with a cure. `true` if it is Rust.
fn is_rust_or_a_fault_of_ours(text: &str, name: &str) -> bool {
    match expand_source(text) {
        Ok(items) => {
            // `syn` knows the keywords up to the edition of 2021.
            assert!(!has_word(items.clone(), "gen"), "{text}");
            assert!(syn::parse2::<syn::File>(items).is_ok(), "{text}");
            true
        }
        Err(report) => {
            for fault in report.lines().collect::<Vec<_>>().chunks(2) {
                let [message, help] = fault else { panic!("{text}: {report}") };
                assert!(message.contains(name) || name.starts_with("__"), "{text}: {report}");
                assert!(help.trim().starts_with("help: "), "{text}: {report}");
            }
            false
        }
    }
}

/// Names that a sweep of statements refuses.
fn refused(statement: impl Fn(&str) -> String) -> BTreeSet<&'static str> {
    names().filter(|name| !is_rust_or_a_fault_of_ours(&statement(name), name)).collect()
}

/// Names refused for everything that becomes a name of Rust, and `more`.
fn kept(more: &[&'static str]) -> BTreeSet<&'static str> {
    ["self", "Self", "super", "crate", "_"].iter().chain(more).copied().collect()
}

#[test]
fn every_name_of_a_mechanism_a_scene_or_a_function_works_or_is_refused_by_us() {
    let found = refused(|name| format!("mechanism {name}; coord y: m; drive d: y == 1m;"));
    assert_eq!(found, kept(&["T", "__S", "__Parameters", "__scene", "__mbs"]));
    let found = refused(|name| {
        format!("mechanism Machine; coord y: m; effect one {{ drive d: y == 1m; }} scene {name} = one;")
    });
    assert_eq!(found, kept(&["AllEffects", "Coordinates", "__S", "__Parameters", "__scene", "__mbs"]));
    let found = refused(|name| {
        format!("mechanism Machine; function {name}: m(1), C2; coord y: m; drive d: y == {name}(t/1s);")
    });
    // In an expression `if(` is the condition of other languages.
    assert_eq!(found, kept(&["if"]));
    let found = refused(|name| {
        format!(
            "mechanism Machine; function {name}: m(1), C2; coord y: m; effect {name} {{ drive d: y == {name}(t/1s); }} \
             scene Some = {name}; scene Function = {name};"
        )
    });
    assert_eq!(found, kept(&["if"]));
}

/// All names but those that are kept, each in a statement of one text; `#` is its number. Then those that are kept, one by one.
#[track_caller]
fn all_in_one_text(others: &str, statement: &str) {
    let of = |(number, name): (usize, &str)| {
        statement.replace("NAME", name).replace('#', &number.to_string()) + "\n"
    };
    let kept = kept(&[]);
    let free: String = names().enumerate().filter(|(_, name)| !kept.contains(name)).map(of).collect();
    let text = format!("mechanism Machine; {others}\n{free}");
    assert!(is_rust_or_a_fault_of_ours(&text, ""), "{}", expand_source(&text).err().unwrap_or_default());
    for name in kept {
        is_rust_or_a_fault_of_ours(&format!("mechanism Machine; {others} {}", of((0, name))), name);
    }
}

#[test]
fn every_name_of_a_field_works_or_is_refused_by_us() {
    for statement in [
        "param NAME: m = 1; out o#: m = NAME;",
        "const NAME: m = 1; out o#: m = NAME*2;",
        "input NAME: m, rates; out o#: m = NAME;",
        "input NAME: [m; 2]; out o#: m = NAME[1];",
        "let NAME = 1m*y0; out o#: m = NAME.0;",
        "coord NAME: m; drive d#: NAME == 1m*t/1s;",
        "coord NAME: [m; 2]; constraint d# { [1m, 2m] == NAME; }",
    ] {
        all_in_one_text(
            "coord y0: [1; 2]; constraint d { y0 == [1, 1]; }",
            &statement.replace("1m*y0", "1m*[y0.0, 1]"),
        );
    }
    all_in_one_text(
        "coord y0: m = 0.1; body b0 { mass: 1, com: [y0, y0] }",
        "state NAME: m = 1; der(NAME) == y0/1s;",
    );
}

#[test]
fn every_name_of_a_statement_works_or_is_refused_by_us() {
    let still = "coord y0: m = 0.1; drive d: y0 == 1m;";
    all_in_one_text(still, "coord c#: m; constraint NAME { c# == y0; }\n");
    let moving = "coord y0: m = 0.1; coord x0: m = 0.2; body b0 { mass: 1, com: [x0, y0] }";
    for statement in [
        "branch NAME: x0 > -1m;",
        "limit NAME: -1 <= x0 <= 1;",
        "out NAME: m = x0;",
        "body NAME { mass: 1, com: [2*x0, y0] }",
        "force NAME: [1, 2] on [x0, y0];",
        "tsda NAME { from: [0, 0], to: [x0, y0], stiffness: 10 }",
        "potential NAME = 3*x0/1m;",
        "gravity NAME { acceleration: [0, -9.81] }",
        "out o#: m = sum(NAME in 0..2: NAME*x0);",
        "for NAME in 0..2 { force f#: [NAME*1N, 2] on [x0, y0]; }",
        "coord c#: m = 0.1; drive NAME: c# == 1m*t/1s;",
        "coord c#: m = 0.1; drive NAME: rate(c#) == 1 [m/s];",
    ] {
        all_in_one_text(moving, statement);
    }
}

/// t², of any number type.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Square;

impl<T: Scalar> Function<T> for Square {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let mut values = [T::constant(0.0); K];
        for (value, derivative) in values.iter_mut().zip([x * x, x + x, T::constant(2.0)]) {
            *value = derivative;
        }
        values
    }
}

/// A constant of the caller next to the mechanism.
#[allow(non_upper_case_globals, dead_code, reason = "it must not be taken for an argument")]
const lift: f64 = 1.0;

mechanism! {
    /// Functions named as what patterns and types may name.
    mechanism Functions;
    function Some: m(1), C2;
    function None: m(1), C2;
    function Ok: m(1), C2;
    function Err: m(1), C2;
    function gen: m(1), C2;
    function r#try: m(1), C2;
    function async: m(1), C2;
    function T: m(1), C2;
    function S: m(1), C2;
    function f64: m(1), C2;
    function functions: m(1), C2;
    function whole: m(1), C2;
    function driven: m(1), C2;
    function scalar: m(1), C2;
    function scalar_: m(1), C2;
    function lift: m(1), C2;
    coord x: m;
    let u = t/1s;
    effect one {
        drive d: x == Some(u) + None(u) + Ok(u) + Err(u) + gen(u) + try(u) + async(u) + T(u) + S(u) + f64(u)
            + functions(u) + whole(u) + driven(u) + scalar(u) + scalar_(u) + lift(u);
    }
    scene Driven = one;
    scene gen = one;
    scene x = one;
    scene type = one;
}

mechanism! {
    /// A keyword of 2024.
    #[allow(non_camel_case_types, reason = "the name is the test")]
    mechanism gen;
    coord x: m;
    drive d: x == 1m*t/1s;
}

mechanism! {
    /// A keyword of every edition.
    #[allow(non_camel_case_types, reason = "the name is the test")]
    mechanism type;
    param __mbs: m = 2;
    param __scene: 1 = 1;
    coord x: m;
    effect one { drive d: x == __mbs*__scene*t/1s; }
    scene fn = one;
}

/// A scope in which the names of Rust's own types are the caller's.
mod types_of_the_caller {
    macro_rules! named {
        ($($name:ident)*) => { $(#[allow(non_camel_case_types, dead_code, reason = "the name is the test")] pub struct $name;)* };
    }
    named!(bool char str f32 f64 i8 i16 i32 i64 u8 u16 u32 u64 usize isize);

    super::mechanism! {
        pub mechanism Ball;
        param L: m = 2;
        coord x: m = 0.1;
        coord y: m = 1;
        body ball { mass: 1, com: [x, y] }
        friction slide { along: x, normal: 10, coefficient: 0.1, speed: 0.01 }
        constraint rod redundant { x^2 + y^2 == L^2/4; 2*x^2 + 2*y^2 == L^2/2; }
        limit stroke: -3 <= x <= 3;
        branch up: y > 0;
        effect one { drive d: x == 0.1m + 0.1m*t/1s; out z: m = x; }
        scene Driven = one;
    }
}

#[test]
fn texts_with_names_of_rust_compile_and_run() {
    let ball = types_of_the_caller::BallDriven::default();
    let motion = Stepper::assemble(ball, [0.1, 1.0], 0.0).expect("assembled");
    assert!((motion.q()[1] - 0.99_f64.sqrt()).abs() < 1e-15);
    let s = Square;
    let functions = FunctionsDriven::new(s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s);
    let motion = Stepper::assemble(functions, [0.0], 3.0).expect("assembled");
    assert_eq!(*motion.q(), [16.0 * 9.0]);
    // A scene called x is no value that a pattern would match.
    let x = Stepper::assemble(r#gen::default(), [0.0], 0.5).expect("assembled");
    assert_eq!(*x.q(), [0.5]);
    assert_eq!(genCoordinates::from(*x.q()).x, 0.5);
    let motion = Stepper::assemble(typefn::default(), [0.0], 0.5).expect("assembled");
    assert_eq!(*motion.q(), [1.0]);
    assert_eq!(<r#gen as Mechanism<f64, 1, 1>>::NAME, "gen");
}

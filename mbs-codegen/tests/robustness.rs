//! Any input ends the expansion soon, with Rust or with a report; it never panics or overflows its stack.
#![forbid(unsafe_code)]

use std::panic::{UnwindSafe, catch_unwind};
use std::thread;
use std::time::{Duration, Instant};

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

/// Stack of the thread on which the compiler runs a macro, at the least.
const STACK: usize = 2 << 20;

/// Longest time an expansion may take in a debug build.
const LONGEST: Duration = Duration::from_secs(2);

const FOUR_BAR: &str = "
/// Four-bar linkage.
pub mechanism FourBar;
const L1: m = 0.10;
param L: [m; 3] = [0.25, 0.2, 300mm];
param omega: rad/s = TAU;
input u: rad, rates;
coord p: [m; 2];
coord phi1: rad = 0.0;
coord r#type: rad = 30deg;
coord phi3: rad = 1.8;
let a = L1*unit(phi1);
constraint point { p == a + rot(type)*[0.5*L[0], 0]; }
constraint closure {
    L[1]*cos(phi3) + L.2 == L1*cos(phi1) + L[0]*cos(type);
    for i in 0..1 { L1*sin(phi1) + L[i]*sin(type) == L[i + 1]*sin(phi3); }
}
drive crank: phi1 == omega*t + u - 2^-(-t/1s)^2;
branch open: sin(phi3 - type) > 0;
branch low at start: 0 < p.1 + 10m;
out angle: rad = phi3 - type;
out speed: [m/s; 2] = der(p);
out length: m = sum(i in 0..3: abs(L[i])) + max(norm(p), hypot(L1, L.0), 1m) + det([p, a])/1m;
";

/// Statements that the four-bar does not need.
const PRESS: &str = "
/// Press with a phase.
pub mechanism Press;
param omega: rad/s = 60rpm;
param stroke: [m; 2] = [20mm, 0.4];
input load: rad, rates;
coord phi: rad = 0.5;
coord rod: rad = -0.1;
coord x: m = 0.3;
constraint closure { 0.1m*unit(phi) + 0.3m*unit(rod) == [x, 0]; }
drive crank: rate(phi + 0.1*load) == omega*(1 + 0.1*sin(t/1s));
independent phi;
limit travel: stroke[0] - 0.1m <= x + 0.01m*sin(phi) <= 2*stroke.1;
limit lean: -1 <= rod <= 60deg;
branch ahead: cos(rod) > 0;
out speed: m/s = der(x);
out pull: m/s^2 = der2(x);
";

/// Functions and scenes.
const MACHINE: &str = "
/// A cam or a crank lifts a table.
pub mechanism Machine;
param r: m = 50mm;
function lift: m(rad), C4, periodic TAU;
coord theta: rad = 0.8;
coord y: m = 0.2;
drive motor: theta == 3*t/1s;
effect cam { constraint face { y == r + lift(theta) + 0.1*lift(r/1m); } out slope: m = lift.d1(2*theta); }
effect crank {
    param L: m = 180mm;
    coord rod: rad = -0.2;
    constraint closure { r*unit(theta) + L*unit(rod) == [y, 0]; }
    branch ahead: cos(rod) > 0;
}
effect seen { out bend: m = lift.d2(theta); }
/// Follows the law.
scene Cam = cam + seen;
scene Crank = crank;
";

/// Masses and forces.
const ARM: &str = "
/// A two-link arm whose hand slides.
pub mechanism Arm;
param m1: kg = 1.5;
param k: N/m = 120;
const C: N*m*s = 0.2;
input u: N*m;
function load: N(m), C3;
coord psi1: rad = 0.3;
coord psi2: rad = 0.8;
coord s: m = 0.2;
state z: N = 0.5;
let hand = 0.6*1m*unit(psi1) + s*unit(psi1 + psi2);
body upper { mass: m1, inertia: 0.02, com: 0.3*1m*unit(psi1), angle: psi1 }
body hold { mass: 0.4, com: hand }
gravity g { acceleration: [0.3, -9.81] }
force push: [2N + z, load(s)] on hand;
torque motor: u - C*der(psi1) on psi1;
force slip: -lambda(slot)*0.1 on s;
tsda strut { from: [200mm, -400mm], to: hand, stiffness: k, length: 0.35, damping: 4, actuator: 3N*sin(2*t/1s) }
rsda knee { angle: psi2, stiffness: 5, rest: 0.4, damping: 0.3, torque: 0.1 }
potential well = 3N/1m*s^2*cos(psi1);
kinetic rotor = 0.01 [kg*m^2]*der(psi2)*(der(psi2) + 3*der(psi1));
dissipation bearing = 0.05*C*der(psi1)^2*exp(psi2);
der(z) == (4N - z)/0.1s + 2N/1m*der(s);
constraint slot { s == 300mm + 50mm*cos(psi2); }
drive lead: psi1 == 0.3 + t/1s;
start psi2 = 0.7 rate 2;
out squeeze: N = lambda(slot) + z;
out torque_1: N*m = effort(lead);
";

/// Statements of the picture.
const DRAWN: &str = "
/// A crank that is looked at.
pub mechanism Crank;
param r: [m; 2] = [50mm, 0.2];
param omega: rad/s = 30;
const N: 1 = 3;
coord theta: rad = 0.8;
drive motor: theta == omega*t;
body disc { mass: 2kg, com: 0.5*r[0]*unit(theta), inertia: 0.1, angle: theta }
pin hinge: disc, ground at [0, 0];
tsda strut { from: [0, 0], to: r[0]*unit(theta), stiffness: 3 }
out A: [m; 2] = r[0]*unit(theta);
out row: [m; 3, 2] = [[0, 0], [1, 0], A];
let A = r[0]*unit(theta);
title \"A crank\";
about \"It turns, \" \"always\";
preset fast \"at twice the speed\" { omega: 600rpm, r: [40mm, 0.1], r[1]: 2*N }
draw ground row[0], hinge;
for i in 1..N { let B = [i*r[0], 0]; draw link bars: row[i - 1], row[i], B; draw joint B; }
draw spring strut.from, strut.to;
draw slider A along [1, 0];
draw gear \"g\": hinge rim A teeth 2*N inside;
draw cam hinge contact disc.com turn theta;
draw road R: A speed 3 [m/s];
effect slow { span turn(omega); trace \"path\": A; }
effect short { span 2s; draw geneva A pin A wheel A rim A slots N; draw face A, A back A; }
scene Slow = slow { draw rail A along theta; }
scene Short = short;
";

/// Every statement of the language occurs in one of them.
const TEXTS: [&str; 5] = [FOUR_BAR, PRESS, MACHINE, ARM, DRAWN];

/// Runs `work` as the compiler runs a macro; `what` names it where it fails.
fn expands(what: &str, work: impl Fn() -> String + Send + UnwindSafe + Clone + 'static) -> String {
    let shown: String = what.chars().take(2000).collect();
    let mut shortest = Duration::MAX;
    // Other work on the machine may disturb one measurement, not three.
    for _ in 0..3 {
        let (work, started) = (work.clone(), Instant::now());
        let timed = move || {
            let result = catch_unwind(work).ok();
            (result, processor_time().unwrap_or_else(|| started.elapsed()))
        };
        let thread = thread::Builder::new().stack_size(STACK).spawn(timed).expect("a thread");
        let (result, elapsed) = thread.join().expect("no overflow");
        let result = result.unwrap_or_else(|| panic!("a panic for {shown}"));
        shortest = shortest.min(elapsed);
        if shortest < LONGEST {
            return result;
        }
    }
    panic!("{shortest:?} for {shown}")
}

/// Processor time of this thread, where the system tells it.
fn processor_time() -> Option<Duration> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// Expands a text in all ways; returns the report where it is faulty.
fn check(text: &str) -> Option<String> {
    let source = text.to_owned();
    let report = expands(text, move || match mbs_codegen::expand_source(&source) {
        Ok(_) => String::new(),
        Err(report) => report,
    });
    let source = text.to_owned();
    let definition = expands(text, move || match mbs_codegen::casadi_definition(&source, None) {
        Ok(_) => String::new(),
        Err(report) => report,
    });
    let source = text.to_owned();
    let picture = expands(text, move || match mbs_codegen::picture(&source, None) {
        Ok(picture) => picture.points([&[], &[], &[]], 0.0, &[]).iter().take(0).map(|_| ' ').collect(),
        Err(report) => report,
    });
    assert!(picture.is_empty() || !report.is_empty(), "{picture}{text}");
    let source = text.to_owned();
    let form = expands(text, move || {
        let form = mbs_codegen::faults_of_form(&source);
        let quoted = mbs_codegen::declarations(&source, None);
        assert!(quoted.is_err() || form.is_empty(), "{form:?}");
        form.into_iter().map(|fault| fault.message).collect()
    });
    assert!(form.is_empty() || !report.is_empty(), "{form}{text}");
    // Structure is no matter of a definition.
    assert!(definition.is_empty() || !report.is_empty(), "{text}");
    if let Ok(tokens) = text.parse::<TokenStream>() {
        drop(tokens);
        let source = text.to_owned();
        let items = expands(text, move || mbs_codegen::expand(source.parse().expect("tokens")).to_string());
        is_rust(&items, text);
    }
    if report.is_empty() {
        return None;
    }
    is_report(&report, text);
    Some(report)
}

fn is_rust(items: &str, text: &str) {
    if let Err(fault) = syn::parse_file(items) {
        let start = fault.span().start().column;
        let near: String = items.chars().skip(start.saturating_sub(200)).take(400).collect();
        panic!("{fault}\nin {near}\nfrom {text}");
    }
}

/// `line:column: message` and `help: cure`, in turn.
fn is_report(report: &str, text: &str) {
    assert!(!report.is_empty(), "{text}");
    for line in report.lines().filter(|line| !line.starts_with("  ")) {
        let place: Vec<_> = line.splitn(3, ':').collect();
        assert!(place.len() == 3 && place[0].parse::<usize>().is_ok(), "{report}\nfrom {text}");
    }
}

/// A generator of numbers, the same ones every time (xorshift64*).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % limit.max(1)
    }

    fn pick<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }
}

/// Words and marks of a text, white space left out.
fn words(text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let length = match first {
            _ if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            '/' if rest.starts_with("///") => rest.find('\n').unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let (word, behind) = rest.split_at(length);
        rest = behind;
        if !word.trim().is_empty() {
            words.push(word);
        }
    }
    words
}

const SOUP: [&str; 112] = [
    "const",
    "param",
    "input",
    "coord",
    "let",
    "constraint",
    "drive",
    "branch",
    "out",
    "for",
    "in",
    "sum",
    "rates",
    "at",
    "start",
    "redundant",
    "limit",
    "independent",
    "effect",
    "scene",
    "function",
    "periodic",
    "C2",
    "state",
    "body",
    "gravity",
    "force",
    "torque",
    "on",
    "tsda",
    "rsda",
    "potential",
    "kinetic",
    "dissipation",
    "event",
    "latch",
    "until",
    "never",
    "mass",
    "com",
    "angle",
    "lambda",
    "effort",
    "lift",
    "lift[0]",
    "[m; 2](rad)",
    "d1",
    "mechanism",
    "pub",
    "t",
    "PI",
    "TAU",
    "der",
    "der2",
    "rate",
    "sin",
    "atan2",
    "max",
    "norm",
    "dot",
    "cross",
    "det",
    "rot",
    "unit",
    "phi1",
    "p",
    "L",
    "L1",
    "omega",
    "x",
    "r#type",
    "self",
    "θ",
    "_",
    "0",
    "1",
    "2",
    "3",
    "0.5",
    "1e999",
    "1e-999",
    "100mm",
    "30deg",
    "3000rpm",
    "7furlong",
    "'c'",
    "\"s\"",
    "0x10",
    "m",
    "rad",
    "s",
    "+",
    "-",
    "*",
    "/",
    "^",
    "==",
    "<=",
    "->",
    "=",
    ">",
    "<",
    ";",
    ";",
    ",",
    ":",
    ".",
    "..",
    "#",
    "&",
    "1.",
    "\n",
];

#[test]
fn the_texts_that_are_mutated_are_valid() {
    for text in TEXTS {
        assert_eq!(check(text), None);
    }
}

#[test]
fn truncated_texts() {
    let step = if cfg!(feature = "long") { 1 } else { 3 };
    for words in TEXTS.map(words) {
        for length in (0..words.len()).step_by(step) {
            let mut text = joined(&words[..length]);
            check(&text);
            // The same with its brackets closed.
            let mut open = Vec::new();
            for c in text.chars() {
                match c {
                    '(' => open.push(')'),
                    '[' => open.push(']'),
                    '{' => open.push('}'),
                    ')' | ']' | '}' => drop(open.pop()),
                    _ => {}
                }
            }
            text.extend(open.into_iter().rev());
            check(&text);
        }
    }
}

#[test]
fn mutated_texts() {
    let mut random = Random(0x5EED_0001);
    let rounds = if cfg!(feature = "long") { 1000 } else { 200 };
    for valid in TEXTS.map(words) {
        for _ in 0..rounds {
            let mut text = valid.clone();
            for _ in 0..=random.below(4) {
                let (place, other) = (random.below(text.len()), random.below(text.len()));
                match random.below(4) {
                    0 => drop(text.remove(place)),
                    1 => text[place] = random.pick(&SOUP),
                    2 => text.insert(place, random.pick(&SOUP)),
                    _ => text.swap(place, other),
                }
            }
            check(&joined(&text));
        }
    }
}

/// Words as a text again: a doc comment ends with its line.
fn joined(words: &[&str]) -> String {
    let line = |word: &&str| if word.starts_with("///") { format!("{word}\n") } else { format!("{word} ") };
    words.iter().map(line).collect()
}

#[test]
fn random_tokens() {
    let mut random = Random(0x5EED_0002);
    for round in 0..1000 {
        let mut text = String::from(if round % 4 == 0 { "" } else { "pub mechanism X; coord phi1: rad; " });
        let mut open = Vec::new();
        for _ in 0..random.below(120) {
            match random.below(10) {
                0 => {
                    let (from, to) = [("(", ")"), ("[", "]"), ("{", "}")][random.below(3)];
                    text += from;
                    open.push(to);
                }
                1 => text += open.pop().unwrap_or(";"),
                _ => text += random.pick(&SOUP),
            }
            text.push(' ');
        }
        while let Some(close) = open.pop() {
            text += close;
        }
        check(&text);
    }
}

#[test]
fn random_characters() {
    let mut random = Random(0x5EED_0003);
    let characters: Vec<char> =
        "ab1.;:=[](){}<>+-*/^#!'\"\\ \n\tθ²∑\u{0}\u{feff}\u{202e}_e0x".chars().collect();
    for _ in 0..2000 {
        let text: String =
            (0..random.below(60)).map(|_| characters[random.below(characters.len())]).collect();
        check(&text);
        check(&format!("pub mechanism X; coord phi: rad; {text}"));
    }
}

/// A square text with one more statement.
fn with(statement: &str) -> String {
    format!("pub mechanism X; param L: m = 1; coord phi: rad; drive crank: phi == 2*t/1s; {statement}")
}

#[test]
fn deep_nests() {
    for (open, close) in [("(", ")"), ("[", "]"), ("sin(", ")"), ("phi[", "]"), ("{", "}"), ("-(", ")")] {
        for depth in [255, 256, 10_000] {
            let nest = format!("{}phi{}", open.repeat(depth), close.repeat(depth));
            let report = check(&with(&format!("out y: 1 = {nest};")));
            if depth == 10_000 {
                assert!(report.expect("too deep").contains("nest deeper than 256"), "{open}");
            }
            check(&nest);
            check(&format!(
                "#[a{}{}] pub mechanism X; coord phi: rad;",
                "(".repeat(depth),
                ")".repeat(depth)
            ));
        }
    }
    check(&with(&format!("param n: {}m{} = 1;", "(".repeat(200), ")".repeat(200))));
    check(&with(&format!("{}phi == 1;{}", "for i in 0..1 {".repeat(200), "}".repeat(200))));
    check(&with(&format!("out y: 1 = {}phi{};", "sum(i in 0..1: ".repeat(200), ")".repeat(200))));
}

#[test]
fn deep_nests_of_groups_without_delimiters() {
    for depth in [100, 300, 100_000] {
        let expand = move || {
            let mut nest: TokenStream = "phi".parse().expect("tokens");
            for _ in 0..depth {
                nest = TokenTree::from(Group::new(Delimiter::None, nest)).into();
            }
            let mut text: TokenStream = with("out y: 1 = 2*").parse().expect("tokens");
            text.extend(nest.clone());
            text.extend(";".parse::<TokenStream>().expect("tokens"));
            let items = mbs_codegen::expand(text).to_string();
            assert_eq!(items.contains("nest deeper"), depth > 256);
            items + &mbs_codegen::expand(nest).to_string()
        };
        is_rust(&expands("undelimited", expand), "undelimited");
    }
}

#[test]
fn long_chains() {
    check(&with(&format!("out y: 1 = {}phi;", "- ".repeat(100_000))));
    for term in ["phi + ", "phi*", "sin(phi) - ", "phi^3 + ", "phi/", "1/t*", "1 + "] {
        // Longer than any use; texts after it that are refused are longer than allowed.
        let term_count = if term.len() > 6 { 6_000 } else { 10_000 };
        check(&with(&format!("out y: 1 = {}phi;", term.repeat(term_count))));
    }
    check(&with(&(0..20_000).map(|i| format!("coord a{i}: m;")).collect::<String>()));
    check(&with(&format!("out y: 1 = {}phi;", "1 + ".repeat(60_000))));
    assert_eq!(check(&with(&format!("out y: 1 = {}phi;", "2^".repeat(300)))), None);
    assert!(check(&with(&format!("out y: 1 = {}phi;", "phi + ".repeat(70_000)))).is_some());
    assert!(check(&with(&format!("out y: 1 = {}phi;", "phi*".repeat(70_000)))).is_some());
    check(&with(&format!("out y: 1 = {}phi;", "phi^".repeat(1_000))));
    assert!(check(&with(&format!("out y: 1 = {}phi;", "sin(phi) - ".repeat(40_000)))).is_some());
    check(&with(&format!("param n: m{} = 1;", "*m".repeat(60_000))));
    check(&with(&format!("out y: 1 = max(phi{});", ", phi".repeat(70_000))));
    check(&with(&format!("out y: 1 = [phi{}][3];", ", phi".repeat(20_000))));
    check(&with(&"let a = phi; ".repeat(20_000)));
    check(&with(&"x ".repeat(250_000)));
    check(&"; ".repeat(100_000));
    check(&with(&(0..3000).map(|i| format!("let a{} = a{i};", i + 1)).collect::<String>()));
    check(&with(&(0..3000).map(|i| format!("const A{i}: 1 = A{};", i + 1)).collect::<String>()));
}

#[test]
fn huge_loops() {
    for text in [
        "for i in 0..1000000000 { constraint c { phi == i; } }",
        "for i in 0..400000 { for j in 0..400000 { } }",
        "for i in 0..400000 { let a = i; }",
        "out y: 1 = sum(i in 0..100000: sum(j in 0..100000: 1));",
        "out y: 1 = sum(i in 0..100000: A[0]*1); input A: [1; 1000];",
        "for i in 0..99999 { let a = i + 1; }",
        "for i in 0..400000 { constraint c { } }",
        "constraint c { for i in 0..400000 { for j in 0..400000 { } } }",
        "constraint c { for i in 0..400000 { phi == x; } }",
        "for i in 0..3000 { out y: 1 = i*phi; }",
        "for i in 0..30000 { out y: 1 = i*phi; }",
        "for i in 0..3000 { constraint c { i*phi == 1; } }",
        "out y: 1 = sum(i in 0..1000000000: phi);",
        "out y: 1 = sum(i in 0..400000: phi);",
        "out y: 1 = sum(i in 0..400000: sum(j in 0..400000: 1));",
        "out y: 1 = sum(i in 0..400000: sum(j in 0..0: 1));",
        "out y: 1 = sum(i in 0..20000: phi);",
        "param A: [1; 1000] = sum(i in 0..400000: 1); out y: 1 = sum(i in 0..400000: A[0]);",
        "input A: [1; 1000]; out y: 1 = sum(i in 0..400000: A[0]);",
        "input A: [1; 1000]; for i in 0..100000 { let a = A[0]; }",
        "let P = [phi*1m, 0]; for i in 0..99999 { draw joint P; }",
        "for i in 0..9000 { let P = [i*phi*1m, 0]; draw link bars: P, P; draw joint P, P, P, P; }",
        "for i in 0..99999 { draw joint PP; draw link Q, R; trace A; preset fast { omga: 1 } }",
        "out P: [m; 900, 2] = 0; let A = 0; for i in 0..900 { draw joint P[i]; draw spring s: P[i], P[0]; }",
        "for i in 0..400 { for j in 0..400 { title \"A title\"; span 2s; draw view diagonal; } }",
    ] {
        check(&with(text));
    }
}

#[test]
fn huge_arrays() {
    for text in [
        "input A: [m; 1000000000];",
        "input A: [m; 10000, 10000];",
        "input A: [m; 100000, 100000, 100000, 100000, 100000];",
        "input A: [1; 1000];",
        "input A: [1; 2000];",
        "input A: [1; 100, 100]; out y: [1; 100, 100] = A;",
        "coord q: [m; 10000];",
        "coord q: [m; 10000]; constraint c { q == 0; }",
        "coord q: [m; 299]; constraint c { for i in 0..299 { q[i] == 1m; } }",
        "coord q: [m; 300]; constraint c { for i in 0..300 { q[i] == 1m; } }",
        "coord q: [m; 1000]; constraint c { for i in 0..1000 { q[i] == 1m; } }",
        "coord q: [m; 100]; constraint c { for i in 0..100 { sum(j in 0..100: q[j]) == i*1m; } }",
    ] {
        check(&with(text));
    }
}

#[test]
fn extreme_numbers() {
    for (number, fault) in [
        ("1e999", "too large"),
        ("1e308km", "too large"),
        ("179769313486231580793728971405301e300", "too large"),
        ("1e-999", "too small"),
        ("0.0000001e-400", "too small"),
        ("1e99999999999999999999", "too large"),
    ] {
        let report = check(&with(&format!("param n: m = {number};"))).expect("a fault");
        assert!(report.contains(fault) && report.lines().count() == 2, "{number}: {report}");
    }
    for number in ["1e308", "-1e308", "5e-324", "0e999", "0.0", "1_000.5e-1_0", "1e3_0", "0_1"] {
        assert_eq!(check(&with(&format!("param n: m = {number};"))), None);
    }
    for number in ["0x1F", "0b1", "1f64", "1u8", "'a'", "b\"x\"", "1e", "1e+", "1.e5", "1.0.0", "1__"] {
        check(&with(&format!("param n: m = {number};")));
    }
    for expression in
        ["1e308*10", "1/0", "0/0", "0^-1", "(-1)^0.5", "sqrt(-1)", "ln(0)", "tan(PI/2)", "acos(2)"]
    {
        check(&with(&format!("out y: 1 = phi + {expression};")));
    }
    for exponent in ["1e308", "-1e308", "0.1", "1e-300", "400000000", "-2147483648"] {
        check(&with(&format!("out y: 1 = (phi*1m)^{exponent};")));
    }
}

#[test]
fn texts_without_sense() {
    for text in
        ["", " ", ";", "pub", "mechanism", "mechanism X", "mechanism X;", "pub mechanism X; coord", "()"]
    {
        let report = check(text).expect("a fault");
        assert!(report.contains("help: "), "{text}: {report}");
    }
    for text in ["(", "\"", "'", "/*", "r#\"", "}"] {
        assert!(mbs_codegen::expand_source(text).is_err());
        assert!(mbs_codegen::casadi_definition(text, None).is_err());
    }
}

#[test]
fn names_of_all_kinds() {
    for name in [
        "θ", "φ1", "ψ_ein", "名", "x_", "_x", "r#type", "r#fn", "r#match", "T", "Self_", "f64", "core",
        "Some",
    ] {
        let text = format!(
            "pub mechanism X; param {name}: m = 1; coord q_{0}: m; constraint c {{ q_{0} == {name}; }}",
            name.trim_start_matches("r#")
        );
        assert_eq!(check(&text), None, "{name}");
        let text =
            format!("pub mechanism X; coord {name}: m; drive d: {name} == 1m; out {name}: m = {name};");
        assert_eq!(check(&text), None, "{name}");
    }
    for keyword in [
        "as", "async", "await", "break", "const", "continue", "dyn", "else", "enum", "extern", "false", "fn",
        "for", "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return",
        "static", "struct", "trait", "true", "type", "unsafe", "use", "where", "while", "abstract", "become",
        "box", "do", "final", "gen", "macro", "override", "priv", "try", "typeof", "unsized", "virtual",
        "yield", "union", "auto", "default",
    ] {
        let text = format!("pub mechanism X; coord {keyword}: m; drive d: {keyword} == 1m;");
        assert_eq!(check(&text), None, "{keyword}");
    }
    for word in ["self", "Self", "super", "crate", "_", "r#_", "r#self"] {
        check(&format!("pub mechanism X; coord {word}: m; drive d: {word} == 1m;"));
        check(&format!("pub mechanism {word}; coord x: m; drive d: x == 1m;"));
        check(&format!("pub mechanism X; coord x: m; drive {word}: x == 1m; out {word}: m = x;"));
    }
}

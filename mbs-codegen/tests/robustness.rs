//! Any input ends the expansion soon, with Rust or with a report; it never panics or overflows its stack.
#![forbid(unsafe_code)]

#[path = "robustness/texts.rs"]
mod texts;

use std::panic::{UnwindSafe, catch_unwind};
use std::thread;
use std::time::{Duration, Instant};

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use texts::{SOUP, TEXTS};

/// Stack of the thread on which the compiler runs a macro, at the least.
const STACK: usize = 2 << 20;

/// Longest processor time of an expansion in a debug build: the longest one takes half of it on a machine whose cores are shared.
const LONGEST: Duration = Duration::from_secs(4);

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

#[test]
fn the_texts_that_are_mutated_are_valid() {
    for text in TEXTS {
        assert_eq!(check(text), None);
    }
}

#[test]
fn truncated_texts() {
    let step = if cfg!(feature = "long") { 1 } else { 7 };
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
    let rounds = if cfg!(feature = "long") { 1000 } else { 80 };
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
    for round in 0..if cfg!(feature = "long") { 1000 } else { 300 } {
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

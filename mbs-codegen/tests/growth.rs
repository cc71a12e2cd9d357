//! Long texts: functions of bounded length, and work that grows with the text and no faster.

use std::fs;
use std::time::{Duration, Instant};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Drag links that turn each other.
fn chain(loops: usize) -> String {
    format!(
        "pub mechanism Chain; const LOOPS: 1 = {loops};
        coord link: [rad; LOOPS + 1] = 0.4; coord rod: [rad; LOOPS] = 0.6;
        drive motor: link[0] == 0.5 + 2*t/1s;
        for i in 0..LOOPS {{
            let side = (-1)^i;
            constraint loops {{
                (275mm - side*25mm)*unit(link[i]) + 280mm*unit(rod[i])
                    == [side*100mm, 0] + (275mm + side*25mm)*unit(link[i + 1]);
            }}
            branch open: side*sin(link[i + 1] - rod[i]) > 0;
        }}"
    )
}

/// A Fourier series.
fn series(terms: usize) -> String {
    format!(
        "pub mechanism Series; param amplitude: m = 0.5; coord phi: rad; coord x: m; drive crank: phi == 2*t/1s;
        constraint series {{
            x == sum(k in 0..{terms}: amplitude/(k + 1)^2*sin((k + 1)*phi)*exp(-k*phi/1000));
        }}"
    )
}

/// A sum whose terms all differ in form.
fn disorder(terms: usize) -> String {
    let mut state = 1_u32;
    let mut next = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % below
    };
    let mut row = String::from("x == 0");
    for index in 0..terms {
        let mut term = format!("sin({index}*phi)");
        for _ in 0..4 + next(5) {
            term = match next(4) {
                0 => format!("cos({term})"),
                1 => format!("({term} + phi^2)"),
                2 => format!("({term}*phi)"),
                _ => format!("({term} - {index})"),
            };
        }
        row += &format!(" + {term}");
    }
    format!(
        "pub mechanism Disorder; coord phi: rad; coord x: 1; drive crank: phi == 2*t/1s; constraint row {{ {row}; }}"
    )
}

fn expanded(text: &str) -> TokenStream {
    mbs_codegen::expand_source(text).unwrap_or_else(|report| panic!("{report}"))
}

/// Tokens, those of a table of constants not counted: they are data.
fn length(tokens: TokenStream) -> usize {
    let (mut length, mut in_table) = (0, false);
    for tree in tokens {
        match tree {
            TokenTree::Ident(name) if name == "const" => in_table = true,
            // A scope, no table.
            TokenTree::Ident(name) if name == "_" => in_table = false,
            TokenTree::Punct(mark) if mark.as_char() == ';' => in_table = false,
            TokenTree::Group(group) if !in_table => length += length_of(group.stream()),
            _ if in_table => {}
            _ => length += 1,
        }
    }
    length
}

fn length_of(tokens: TokenStream) -> usize {
    2 + length(tokens)
}

/// The longest body of a function.
fn longest_body(tokens: TokenStream) -> usize {
    let (mut longest, mut in_function) = (0, false);
    for tree in tokens {
        match tree {
            TokenTree::Ident(name) if name == "fn" => in_function = true,
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                let inside = if in_function { length(group.stream()) } else { longest_body(group.stream()) };
                longest = longest.max(inside);
                in_function = false;
            }
            TokenTree::Group(group) if !in_function => longest = longest.max(longest_body(group.stream())),
            TokenTree::Punct(mark) if mark.as_char() == ';' => in_function = false,
            _ => {}
        }
    }
    longest
}

/// Most tokens of a function: 200 lines of sines and cosines of eight angles at most, with the values that they exchange with
/// other functions, or 2000 short ones in closures of 200.
const LONGEST: usize = 20_000;

#[test]
fn functions_have_bounded_length() {
    let texts = [
        chain(10),
        chain(50),
        chain(200),
        chain(600),
        series(50),
        series(1000),
        disorder(400),
        disorder(1200),
    ];
    let lengths = texts.map(|text| longest_body(expanded(&text)));
    assert!(lengths.iter().all(|length| (100..LONGEST).contains(length)), "{lengths:?}");
}

#[test]
fn repeated_lines_take_no_more_functions_and_no_more_operations() {
    let counts = |loops: usize| {
        let code = expanded(&chain(loops)).to_string();
        ["fn ", " * ", "sin_cos"].map(|what| code.matches(what).count())
    };
    let (some, many) = (counts(100), counts(800));
    assert!(many.iter().zip(&some).all(|(many, some)| many <= some), "{some:?} {many:?}");
}

/// Processor time of this thread, where the system tells it: other work on the machine does not count.
fn processor_time() -> Option<Duration> {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// A search in ordered maps is logarithmic, and a busy machine has colder caches.
const MORE_THAN_LINEAR: f64 = 1.6;

#[test]
fn the_largest_texts_expand_in_linear_time() {
    for text in [chain, series] {
        let time = |size: usize| {
            let text = text(size);
            let once = || {
                let started = (processor_time(), Instant::now());
                expanded(&text);
                started
                    .0
                    .zip(processor_time())
                    .map_or_else(|| started.1.elapsed(), |(before, after)| after - before)
            };
            once().min(once()).as_secs_f64()
        };
        let (some, many) = (time(250), time(1000));
        assert!(many < 4.0 * MORE_THAN_LINEAR * some, "{some} s, {many} s");
    }
}

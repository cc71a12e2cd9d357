//! A sample of the random texts, compiled by rustc: beside second-order Taylor arithmetic at every state, and beside
//! 50-digit arithmetic at some.
#![forbid(unsafe_code)]

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::thread;

use mbs_codegen::random::{Expected, STATES, State, TEXTS, expected, text};
use mbs_tests::tools;
use mbs_tests::written::WrittenCrate;

/// Relative size of a slip that the bounds must find in most values.
const SLIP: f64 = 1e-9;

/// Texts that are compiled.
const SAMPLE: usize = 50;

const MANIFEST: &str = r#"
[package]
name = "random-texts"
edition = "2024"

[dependencies]
mbs-runtime = { path = "../../mbs-runtime", default-features = false }
mechanisms = { path = "../../mechanisms", default-features = false }

[workspace]
"#;

/// The crate's program without its texts.
const PROGRAM: &str = include_str!("random_texts/program.rs");

/// A text of the sample.
struct Sampled {
    seed: u64,
    states: Vec<(State, Vec<Expected>)>,
}

/// Spread over all seeds, refused texts left out.
static TEXTS_OF_THE_SAMPLE: LazyLock<Vec<Sampled>> = LazyLock::new(|| {
    let step = TEXTS as usize / SAMPLE;
    let sampled = |first: u64| {
        let mut seeds = first..first + step as u64;
        seeds
            .find_map(|seed| Some(Sampled { seed, states: expected(seed)? }))
            .expect("a text that is not refused")
    };
    (0..TEXTS).step_by(step).map(sampled).collect()
});

static CRATE: LazyLock<WrittenCrate> = LazyLock::new(|| {
    let written = WrittenCrate::new(env!("CARGO_TARGET_TMPDIR"), "random_texts", MANIFEST);
    let mut modules = String::new();
    let (mut values, mut digits) = (String::new(), String::new());
    for Sampled { seed, states } in TEXTS_OF_THE_SAMPLE.iter() {
        let text = text(*seed).replace("mechanism Random;", &format!("mechanism Random{seed};"));
        modules += &format!("mod text_{seed} {{\nmbs_runtime::mechanism! {{\n{text}}}\n}}\n");
        let n = states[0].0.q.len();
        let of = format!("::<text_{seed}::Random{seed}, {n}, {n}>");
        values += &format!("        {seed} => values{of}(numbers),\n");
        digits += &format!("    digits{of}(&oracle, &mut summary);\n");
    }
    let program = PROGRAM.replace("// VALUES\n", &values).replace("// DIGITS\n", &digits);
    written.write("src/main.rs", &(program + &modules));
    written
});

fn run(argument: &str) -> Command {
    CRATE.cargo(&["run", "--quiet", "--", argument])
}

/// Bits of numbers, a line.
fn line(numbers: impl Iterator<Item = f64>) -> String {
    numbers.map(|number| format!(" {:x}", number.to_bits())).collect()
}

#[test]
fn compiled_texts_compute_what_second_order_taylor_arithmetic_computes() {
    let sample = &*TEXTS_OF_THE_SAMPLE;
    let mut questions = String::new();
    for Sampled { seed, states } in sample {
        for (state, _) in states {
            let State { q, qd, qdd, t, variables } = state;
            let numbers = [q.as_slice(), qd, qdd, &[*t], variables].concat();
            questions += &format!("{seed}{}\n", line(numbers.into_iter()));
        }
    }
    let mut child = run("values").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("cargo");
    let mut pipe = child.stdin.take().expect("a pipe");
    let feeder = thread::spawn(move || pipe.write_all(questions.as_bytes()));
    let output = child.wait_with_output().expect("an end");
    assert!(output.status.success(), "the compiled texts stop: {}", output.status);
    feeder.join().expect("no panic").expect("all states are read");
    let answers = String::from_utf8(output.stdout).expect("hexadecimal digits");

    let (mut answers, mut compared, mut worst) = (answers.lines(), 0_usize, 0.0_f64);
    let (mut slips, mut found) = (0_usize, 0_usize);
    for (seed, (_, expected)) in sample.iter().flat_map(|s| s.states.iter().map(|state| (s.seed, state))) {
        let words = answers.next().expect("an answer a state").split_whitespace();
        let values: Vec<u64> = words.map(|word| u64::from_str_radix(word, 16).expect("bits")).collect();
        assert_eq!(values.len(), expected.len(), "seed {seed}");
        for (index, (bits, expected)) in values.into_iter().zip(expected).enumerate() {
            let value = f64::from_bits(bits);
            let Some(error) = expected.error(value) else { continue };
            let instead = expected.value;
            assert!(error <= 1.0, "seed {seed}, value {index}: {value} instead of {instead}\n{}", text(seed));
            worst = worst.max(error);
            compared += 1;
            // The control: slips are outside the bound, but where terms cancel by five digits.
            slips += usize::from(value != 0.0);
            found += usize::from(expected.error(value * (1.0 + SLIP)).is_some_and(|error| error > 1.0));
        }
    }
    println!(
        "{compared} values of {SAMPLE} compiled texts at {STATES} states, largest error {worst:.2e} of what is allowed"
    );
    assert!(compared > 10 * SAMPLE * STATES, "{compared}");
    assert!(found * 5 > slips * 4, "{found} of {slips} slips found");
}

#[test]
fn fifty_digits_confirm_compiled_texts() {
    let said = tools::output(&mut run("digits"), "the tests need cargo, which runs them");
    let said = said.unwrap_or_else(|said| panic!("{said}"));
    assert!(said.starts_with(&format!("{SAMPLE} mechanisms × ")), "{said}");
    println!("{said}");
}

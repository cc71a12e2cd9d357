//! A sample of the random texts, compiled by rustc: against second-order Taylor arithmetic at every state, and against
//! 50-digit arithmetic at some.
#![forbid(unsafe_code)]

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::thread;

use mbs_codegen::random::{Evaluation, ExpectedScene, Features, STATES, TEXTS, expected, text};
use mbs_tests::tools;
use mbs_tests::written::WrittenCrate;

/// Relative size of a slip that the bounds must find in most values.
const SLIP: f64 = 1e-9;

/// Texts that are compiled.
const SAMPLE: usize = 50;

/// Every third of them is cut; as there are ten kinds, all are among them.
const EVERY_CUT: usize = 3;

const MANIFEST: &str = r#"
[package]
name = "random-texts"
edition = "2024"

[dependencies]
mbs-runtime = { path = "../../mbs-runtime", default-features = false }
mbs-workbench = { path = "../../mbs-workbench", default-features = false }

[workspace]
"#;

/// The crate's program without its texts.
const PROGRAM: &str = include_str!("random_texts/program.rs");

/// Kinds of the texts in turn.
const KINDS: [Features; 10] = [
    Features::Plain,
    Features::Functions,
    Features::Plain,
    Features::Scenes,
    Features::Plain,
    Features::Masses,
    Features::Functions,
    Features::Plain,
    Features::ScenesWithFunctions,
    Features::Plain,
];

/// A text of the sample.
struct Sampled {
    kind: Features,
    seed: u64,
    scenes: Vec<ExpectedScene>,
    /// `true` if the text is compiled in parts and loops, as long texts are.
    is_cut: bool,
}

impl Sampled {
    fn text(&self) -> String {
        text(self.kind, self.seed)
    }
}

/// Spread over all seeds, refused texts left out.
static TEXTS_OF_THE_SAMPLE: LazyLock<Vec<Sampled>> = LazyLock::new(|| {
    let step = TEXTS as usize / SAMPLE;
    let sampled = |(index, (first, kind)): (usize, (u64, Features))| {
        let is_cut = index % EVERY_CUT == 0;
        let mut seeds = first..first + step as u64;
        seeds
            .find_map(|seed| Some(Sampled { kind, seed, scenes: expected(kind, seed)?, is_cut }))
            .expect("a text that is not refused")
    };
    (0..TEXTS).step_by(step).zip(KINDS.into_iter().cycle()).enumerate().map(sampled).collect()
});

/// Scenes of the sample with their texts; a text without scenes is one.
fn scenes() -> impl Iterator<Item = (&'static Sampled, &'static ExpectedScene)> {
    TEXTS_OF_THE_SAMPLE.iter().flat_map(|sampled| sampled.scenes.iter().map(move |scene| (sampled, scene)))
}

static CRATE: LazyLock<WrittenCrate> = LazyLock::new(|| {
    let written = WrittenCrate::new(env!("CARGO_TARGET_TMPDIR"), "random_texts", MANIFEST);
    let mut modules = String::new();
    let (mut values, mut digits) = (String::new(), String::new());
    for sampled in TEXTS_OF_THE_SAMPLE.iter() {
        let seed = sampled.seed;
        let text = sampled.text().replace("mechanism Random;", &format!("mechanism Random{seed};"));
        let code = match sampled.is_cut {
            true => {
                mbs_codegen::expand_source_as_long(&text).expect("a text that is not refused").to_string()
            }
            false => format!("mbs_runtime::mechanism! {{\n{text}}}"),
        };
        modules += &format!("mod text_{seed} {{\n{code}\n}}\n");
    }
    for (index, (Sampled { kind, seed, .. }, ExpectedScene { name, rows, states })) in scenes().enumerate() {
        let n = states[0].0.q.len();
        let functions = if kind.has_functions() { "<StandIn<0>, StandIn<1>>" } else { "" };
        let of = format!("::<text_{seed}::Random{seed}{name}{functions}, {n}, {rows}>");
        let masses = *kind == Features::Masses;
        let call = if masses { "with_masses" } else { "values" };
        values += &format!("        {index} => {call}{of}(numbers),\n");
        // Those of masses are confirmed with the ready mechanisms: a facade of them is every method of integration once more.
        if !masses {
            digits += &format!("    digits{of}(&oracle, &mut summary);\n");
        }
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
    let mut questions = String::new();
    for (index, (_, scene)) in scenes().enumerate() {
        for (state, _) in &scene.states {
            let Evaluation { q, qd, qdd, t, variables, lambda, states } = state;
            let numbers = [q.as_slice(), qd, qdd, &[*t], lambda, states, variables].concat();
            questions += &format!("{index}{}\n", line(numbers.into_iter()));
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
    let all = scenes().flat_map(|(text, scene)| scene.states.iter().map(move |state| (text, scene, state)));
    for (sampled, ExpectedScene { name, .. }, (_, expected)) in all {
        let seed = sampled.seed;
        let words = answers.next().expect("an answer a state").split_whitespace();
        let values: Vec<u64> = words.map(|word| u64::from_str_radix(word, 16).expect("bits")).collect();
        assert_eq!(values.len(), expected.len(), "seed {seed}, scene `{name}`");
        for (index, (bits, expected)) in values.into_iter().zip(expected).enumerate() {
            let value = f64::from_bits(bits);
            let Some(error) = expected.error(value) else { continue };
            let instead = expected.value;
            assert!(
                error <= 1.0,
                "seed {seed}, scene `{name}`, value {index}: {value} instead of {instead}\n{}",
                sampled.text()
            );
            worst = worst.max(error);
            compared += 1;
            // The control: slips are outside the bound, but where terms cancel by five digits.
            slips += usize::from(value != 0.0);
            found += usize::from(expected.error(value * (1.0 + SLIP)).is_some_and(|error| error > 1.0));
        }
    }
    println!(
        "{compared} values of {SAMPLE} compiled texts at up to {STATES} states, largest error {worst:.2e} of what is allowed"
    );
    assert!(compared > 10 * SAMPLE * STATES, "{compared}");
    assert!(found * 5 > slips * 4, "{found} of {slips} slips found");
}

#[test]
fn fifty_digits_confirm_compiled_texts() {
    let said = tools::output(&mut run("digits"), "the tests need cargo, which runs them");
    let said = said.unwrap_or_else(|said| panic!("{said}"));
    let plain = scenes().filter(|(text, _)| text.kind != Features::Masses).count();
    assert!(said.starts_with(&format!("{plain} mechanisms × ")), "{said}");
    println!("{said}");
}

/// Elements of the language that can be written in no other way.
const LANGUAGE: [&str; 56] = [
    "sin(",
    "cos(",
    "exp(",
    "ln(",
    "sqrt(",
    "tan(",
    "asin(",
    "acos(",
    "atan(",
    "sinh(",
    "cosh(",
    "tanh(",
    "abs(",
    "sign(",
    "-(",
    ")^",
    " + ",
    " - ",
    "*(",
    ")/(",
    "min(",
    "max(",
    "hypot(",
    "atan2(",
    "dot(",
    "cross(",
    "norm(",
    "det(",
    "rot(",
    "unit(",
    "sum(",
    "for i in",
    "let ",
    "rate(",
    "drive ",
    "constraint ",
    "again redundant {",
    "rise(",
    "sag(",
    "rise.d1(",
    "sag.d1(",
    "sag.d2(",
    "v.1",
    "L[i",
    "u",
    "(t/1s)",
    "scene Third",
    "inertia: ",
    "gravity ",
    "potential ",
    "kinetic ",
    "dissipation ",
    "force push",
    "torque twist",
    "tsda strut",
    "rsda knee",
];

#[test]
fn the_sample_shows_the_whole_language() {
    let texts: String = TEXTS_OF_THE_SAMPLE.iter().map(Sampled::text).collect();
    let missing: Vec<_> = LANGUAGE.into_iter().filter(|word| !texts.contains(word)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert_eq!(TEXTS_OF_THE_SAMPLE.len(), SAMPLE);
    assert!(scenes().count() > SAMPLE + SAMPLE / 5, "{}", scenes().count());
}

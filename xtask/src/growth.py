"""Times that a compiler takes over long mechanisms, above an empty crate; `cargo xtask growth` runs it with the scratch crate.

Columns: operations of the functions of one step as the emitted code states them, processor time and time passed of a release
build, its memory, the same times of a debug build, and the time of an operation in the fastest of 100 steps. A limit holds for
the time passed or the processor time, whichever is less: others may be at work on the machine.
"""
import os, random, subprocess, sys, time
scratch = sys.argv[1]
# Mechanisms of about 10 000 and 100 000 operations: loops, terms of a series, and most seconds of a release build.
CHAIN_LIMITS = {250: 3, 2500: 20}
SERIES_LIMITS = {257: 3, 2600: 20}
ODD_LIMITS = {60: 3, 600: 20}
SERIES = """/// A Fourier series.
pub mechanism Long;
const TERMS: 1 = %d;
param amplitude: m = 0.5;
coord phi: rad;
coord x: m;
drive crank: phi == 2*t/1s;
constraint series { x == sum(k in 0..TERMS: amplitude/(k + 1)^2*sin((k + 1)*phi)*exp(-k*phi/1000)); }"""
CHAIN = """/// Drag links that turn each other.
pub mechanism Long;
const LOOPS: 1 = %d;
coord link: [rad; LOOPS + 1] = 0.4;
coord rod: [rad; LOOPS] = 0.6;
drive motor: link[0] == 0.5 + 2*t/1s;
for i in 0..LOOPS {
    let side = (-1)^i;
    constraint loops {
        (275mm - side*25mm)*unit(link[i]) + 280mm*unit(rod[i])
            == [side*100mm, 0] + (275mm + side*25mm)*unit(link[i + 1]);
    }
    branch open: side*sin(link[i + 1] - rod[i]) > 0;
}"""


def irregular(pairs):
    """Pairs of rows of which no two have one shape: nothing in them is a loop."""
    numbers = random.Random(1)

    def expression(depth, known):
        if depth <= 0:
            coordinate = numbers.choice(known)
            return numbers.choice(
                [f"sin({coordinate})", f"cos({coordinate} + {numbers.random():.3f})", coordinate, f"{numbers.random():.3f}"]
            )
        a, b = expression(depth - 1, known), expression(depth - 1 - numbers.randrange(2), known)
        return numbers.choice(
            [f"({a} + {b})", f"({a} - {b})", f"({a})*({b})", f"({a})/(2 + cos({b}))", f"(sqrt(2 + sin({a})) + {b})"]
        )

    lines = ["/// Rows of all shapes.", "pub mechanism Long;", "coord a: [1; %d] = 0.4;" % pairs, "coord b: [1; %d] = 0.6;" % pairs]
    lines += ["coord crank: 1 = 0.5;", "drive motor: crank == 0.5 + t/1s;"]
    known = ["crank"]
    for pair in range(pairs):
        own = [expression(numbers.randrange(1, 4), known[-3:]) for _ in range(2)]
        lines.append(f"constraint rows{pair} {{ a[{pair}] + 0.1*sin(b[{pair}]) == 0.4 + 0.1*sin({own[0]});")
        lines.append(f"    b[{pair}] + 0.1*cos(a[{pair}]) == 0.6 + 0.1*cos({own[1]}); }}")
        known += [f"a[{pair}]", f"b[{pair}]"]
    return "\n".join(lines)

MAIN = """
mbs_runtime::mechanism! {
%s
}
fn main() {
    let mechanism = Long::<f64>::default();
    let parameters = mbs_runtime::Mechanism::parameters(&mechanism);
    let guess = mbs_runtime::Mechanism::guess(&mechanism, &parameters);
    let mut stepper = mbs_runtime::Stepper::assemble(mechanism, guess, 0.0).expect("an assembly");
    let mut step = std::time::Duration::MAX;
    for _ in 0..100 {
        let begin = std::time::Instant::now();
        stepper.advance(0.001).expect("a step");
        step = step.min(begin.elapsed());
    }
    assert!(stepper.closure_error() < 1e-12);
    let work = <Long<f64> as mbs_runtime::WorstCase>::WORK;
    let mut operations = 0;
    let mut add = |count: mbs_runtime::Operations| {
        operations += count.additions + count.multiplications + count.divisions + count.sine_cosines + count.functions;
    };
    [work.position, work.phi, work.phi_q, work.phi_t, work.gamma, work.branch_values].map(&mut add);
    for block in work.blocks {
        add(block.before.times(block.count as u64));
        add(block.evaluation.times(block.count as u64));
    }
    println!("{operations} {:.1}", step.as_secs_f64() * 1e9 / operations as f64);
}
"""

def build(source, release):
    """Processor time and time passed (s), peak memory (MiB) of one compilation, and what the program prints."""
    with open(f"{scratch}/src/main.rs", "w") as file:
        file.write(source)
    command = ["cargo", "rustc", "--quiet", *(["--release"] if release else []), "--", "--cap-lints", "allow"]
    begin = time.monotonic()
    process = subprocess.Popen(command, cwd=scratch)
    _, status, usage = os.wait4(process.pid, 0)
    passed = time.monotonic() - begin
    if status != 0:
        sys.exit("does not compile")
    program = f"{scratch}/target/{'release' if release else 'debug'}/growth"
    printed = subprocess.run([program], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
    return usage.ru_utime + usage.ru_stime, passed, usage.ru_maxrss / 1024, *printed.split()

failed = False
print(f"{'mechanism':16} {'operations':>10} {'release s':>10} {'passed':>7} {'MiB':>6} {'debug s':>10} {'passed':>7} {'ns':>5}")
empty = {}
for release in (True, False):
    build("fn main() {}", release)
    empty[release] = build("fn main() { }", release)[:2]
ROWS = [
    *((f"{loops} loops", CHAIN % loops, None) for loops in (1, 10, 40, 100)),
    *((f"{loops} loops", CHAIN % loops, most) for loops, most in CHAIN_LIMITS.items()),
    *((f"{terms} terms", SERIES % terms, most) for terms, most in SERIES_LIMITS.items()),
    ("12 odd pairs", irregular(12), None),
    *((f"{pairs} odd pairs", irregular(pairs), most) for pairs, most in ODD_LIMITS.items()),
]
for name, text, most in ROWS:
    *release, memory, operations, nanoseconds = build(MAIN % text, True)
    *debug, _, _, _ = build(MAIN % text, False)
    seconds, passed = (spent - base for spent, base in zip(release, empty[True]))
    debug, debug_passed = (spent - base for spent, base in zip(debug, empty[False]))
    print(
        f"{name:16} {operations:>10} {seconds:10.1f} {passed:7.1f} {memory:6.0f} {debug:10.1f} {debug_passed:7.1f} {nanoseconds:>5}",
        flush=True,
    )
    if most and (min(seconds, passed) > most or memory > 1024):
        print(f"  more than {most} s or 1024 MiB")
        failed = True
sys.exit(failed)

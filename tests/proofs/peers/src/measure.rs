//! Times in interleaved rounds.

use std::hint::black_box;

/// One implementation of a problem.
pub struct Case {
    /// The problem.
    pub group: &'static str,
    /// The implementation.
    pub name: &'static str,
    /// Number of evaluations or steps, of one mechanism each, in a call of `run`.
    pub work: u32,
    /// Largest difference from the reference.
    pub error: f64,
    /// Does the work.
    pub run: Box<dyn FnMut()>,
}

/// Intended duration of a round of one case (s).
const ROUND: f64 = 1.5e-3;

/// Times the cases against each other. Prints a line for each: group, name, error, and the time (ns) of one
/// evaluation or step in every round.
///
/// Within a round all cases are timed one after the other, so that changes of the machine's speed cancel in a ratio of two.
pub fn compare(cases: &mut [Case], rounds: usize) {
    let repetitions: Vec<u32> =
        cases.iter_mut().map(|case| if rounds == 0 { 0 } else { repetitions(case) }).collect();
    let mut times = vec![Vec::with_capacity(rounds); cases.len()];
    let count = cases.len();
    for round in 0..rounds {
        for position in 0..count {
            // Another order in every round.
            let index = (position + 3 * round) % count;
            let (case, repetitions) = (&mut cases[index], repetitions[index]);
            let calls = f64::from(repetitions) * f64::from(case.work);
            times[index].push(1e9 * time(case, repetitions) / calls);
        }
    }
    for (case, times) in cases.iter().zip(times) {
        let times: Vec<String> = times.iter().map(|time| format!("{time:.4}")).collect();
        println!("{} {} {:e} {}", case.group, case.name, case.error, times.join(" "));
    }
}

/// Number of runs of a case in a round.
fn repetitions(case: &mut Case) -> u32 {
    time(case, 2);
    let once = time(case, 4) / 4.0;
    ((ROUND / once) as u32).clamp(1, 1_000_000)
}

/// Processor time (s) of some runs.
fn time(case: &mut Case, repetitions: u32) -> f64 {
    let start = processor_time();
    for _ in 0..repetitions {
        black_box(&mut case.run)();
    }
    processor_time() - start
}

/// Processor time of this thread so far (s). Time of other programs is left out: long runs are interrupted more often and
/// would seem slower than they are.
#[cfg(target_os = "linux")]
fn processor_time() -> f64 {
    #[repr(C)]
    struct Time {
        seconds: std::ffi::c_long,
        nanoseconds: std::ffi::c_long,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: std::ffi::c_int, time: *mut Time) -> std::ffi::c_int;
    }
    /// `CLOCK_THREAD_CPUTIME_ID`.
    const THREAD: std::ffi::c_int = 3;
    let mut time = Time { seconds: 0, nanoseconds: 0 };
    // SAFETY: the structure of a 64-bit Linux, which is written to.
    let code = unsafe { clock_gettime(THREAD, &mut time) };
    assert_eq!(code, 0, "Linux has this clock");
    time.seconds as f64 + 1e-9 * time.nanoseconds as f64
}

/// Elsewhere the wall-clock time (s).
#[cfg(not(target_os = "linux"))]
fn processor_time() -> f64 {
    use std::time::Instant;
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

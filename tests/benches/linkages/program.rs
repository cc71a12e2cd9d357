//! Emitted code against CasADi's C with dense LU, and with nalgebra's.

use std::ffi::{c_int, c_longlong};
use std::hint::black_box;

mod by_hand;

use by_hand::ByHand;
use mbs_runtime::{Failure, Kinematic, Mechanism, Stepper};
use nalgebra::{Const, DimMin, SMatrix, SVector};

type Function =
    unsafe extern "C" fn(*const *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;

/// Functions that CasADi wrote.
#[derive(Clone, Copy)]
struct Peer {
    all: Function,
    rows: Function,
    gamma: Function,
}

/// Steps of a motion.
const STEPS: u32 = 360;

/// Tolerances of the peers' rows over their scales, coarse ones first.
const TOLERANCES: [f64; 7] = [1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15];

/// Error that counts as equal, over ours; and that of any right motion.
const EQUAL: f64 = 1.25;
const RIGHT: f64 = 2e-14;

/// States that are evaluated.
const STATES: usize = 60;

static mut WORK: ([c_longlong; 4096], [f64; 65536]) = ([0; 4096], [0.0; 65536]);

fn call(function: Function, arguments: &[*const f64], results: &mut [*mut f64]) {
    // SAFETY: arrays of the sizes that the function was generated for, and one thread.
    unsafe {
        let (integers, numbers) = ((&raw mut WORK.0).cast(), (&raw mut WORK.1).cast());
        function(arguments.as_ptr(), results.as_mut_ptr(), integers, numbers, 0);
    }
}

#[derive(Clone, Copy)]
struct Motion<const N: usize> {
    q: [f64; N],
    qd: [f64; N],
    qdd: [f64; N],
}

/// LU with partial pivoting, column by column.
struct Lu<const N: usize>([[f64; N]; N], [usize; N]);

trait Solver<const N: usize> {
    fn factorized(columns: &[[f64; N]; N]) -> Self;
    fn solve(&self, b: &mut [f64; N]);
}

impl<const N: usize> Solver<N> for Lu<N> {
    #[inline(always)]
    fn factorized(columns: &[[f64; N]; N]) -> Self {
        let (mut a, mut swaps) = (*columns, [0; N]);
        for k in 0..N {
            let mut best = k;
            for i in k + 1..N {
                if a[k][i].abs() > a[k][best].abs() {
                    best = i;
                }
            }
            swaps[k] = best;
            if best != k {
                a.iter_mut().for_each(|column| column.swap(k, best));
            }
            let reciprocal = 1.0 / a[k][k];
            for i in k + 1..N {
                a[k][i] *= reciprocal;
            }
            for c in k + 1..N {
                let factor = a[c][k];
                for i in k + 1..N {
                    a[c][i] -= factor * a[k][i];
                }
            }
        }
        Lu(a, swaps)
    }

    #[inline(always)]
    fn solve(&self, b: &mut [f64; N]) {
        let Lu(a, swaps) = self;
        for k in 0..N {
            b.swap(k, swaps[k]);
        }
        for k in 0..N {
            for i in k + 1..N {
                b[i] -= b[k] * a[k][i];
            }
        }
        for k in (0..N).rev() {
            b[k] /= a[k][k];
            for i in 0..k {
                b[i] -= b[k] * a[k][i];
            }
        }
    }
}

struct Nalgebra<const N: usize>(nalgebra::LU<f64, Const<N>, Const<N>>)
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>;

impl<const N: usize> Solver<N> for Nalgebra<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    #[inline(always)]
    fn factorized(columns: &[[f64; N]; N]) -> Self {
        Nalgebra(SMatrix::<f64, N, N>::from(*columns).lu())
    }

    #[inline(always)]
    fn solve(&self, b: &mut [f64; N]) {
        let mut x = SVector::<f64, N>::from(*b);
        if self.0.solve_mut(&mut x) {
            *b = x.into();
        }
    }
}

/// Newton's method from the prediction until the rows are below their tolerances, then the rates.
#[inline(always)]
fn step<L: Solver<N>, const N: usize>(
    peer: Peer,
    h: f64,
    tolerances: &[f64; N],
    t: f64,
    motion: &mut Motion<N>,
) {
    for k in 0..N {
        motion.q[k] += h * (motion.qd[k] + 0.5 * h * motion.qdd[k]);
    }
    let (mut phi, mut columns, mut phi_t) = ([0.0; N], [[0.0; N]; N], [0.0; N]);
    for _ in 0..8 {
        let mut results = [phi.as_mut_ptr(), columns.as_mut_ptr().cast(), phi_t.as_mut_ptr()];
        call(peer.rows, &[motion.q.as_ptr(), &raw const t], &mut results);
        if phi.iter().zip(tolerances).all(|(phi, tolerance)| phi.abs() < *tolerance) {
            break;
        }
        L::factorized(&columns).solve(&mut phi);
        for k in 0..N {
            motion.q[k] -= phi[k];
        }
    }
    let factors = L::factorized(&columns);
    motion.qd = phi_t.map(|rate| -rate);
    factors.solve(&mut motion.qd);
    call(peer.gamma, &[motion.q.as_ptr(), motion.qd.as_ptr(), &raw const t], &mut [motion.qdd.as_mut_ptr()]);
    factors.solve(&mut motion.qdd);
}

/// Largest difference of two motions over the largest value of q, q̇ and q̈. A derivative is at least as large as the one before it over
/// the duration (s): accelerations that are zero have no size of their own.
fn difference<const N: usize>(a: &[Motion<N>], b: &[Motion<N>], duration: f64) -> f64 {
    let (mut largest, mut below) = (0.0_f64, 0.0);
    for part in [|m: &Motion<N>| m.q, |m: &Motion<N>| m.qd, |m: &Motion<N>| m.qdd] {
        let size = a.iter().flat_map(part).fold(1e-300_f64.max(below), |size, x| size.max(x.abs()));
        below = size / duration;
        for (a, b) in a.iter().zip(b) {
            for (a, b) in part(a).iter().zip(part(b)) {
                let error = (a - b).abs() / size;
                largest = if error <= largest { largest } else { error };
            }
        }
    }
    largest
}

/// Errors of the emitted motion `own` and of the peer's, and the coarsest tolerances of the peer's rows at which it is as accurate.
fn accuracy<const N: usize>(
    (peer, first, scales): (Peer, Motion<N>, &[f64; N]),
    own: &[Motion<N>],
    duration: f64,
) -> ([f64; 2], [f64; N]) {
    let h = duration / f64::from(STEPS);
    let motion = |tolerance: f64| -> Vec<Motion<N>> {
        let (mut motion, tolerances) = (first, scales.map(|scale| tolerance * scale));
        let mut through = |k| {
            step::<Lu<N>, N>(peer, h, &tolerances, f64::from(k) * h, &mut motion);
            motion
        };
        (1..=STEPS).map(&mut through).collect()
    };
    let truth = motion(0.0);
    let error = difference(&truth, own, duration);
    let equal = |tolerance: &&f64| difference(&truth, &motion(**tolerance), duration) <= RIGHT.max(EQUAL * error);
    let tolerance = TOLERANCES.iter().find(equal).copied().unwrap_or(1e-15);
    ([error, difference(&truth, &motion(tolerance), duration)], scales.map(|scale| tolerance * scale))
}

type Case = (f64, Box<dyn FnMut()>);

fn linkage<S, const N: usize, const Z: usize>(name: &str, peer: Peer, duration: f64, rounds: usize)
where
    S: Kinematic<f64, N> + Mechanism<f64, N, N, Entries = [f64; Z]> + Default + Copy + 'static,
    Stepper<S, f64, N>: Clone,
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    // No instant is that of a jump of the accelerations, which stands at a round part of the motion.
    let duration = 0.999 * duration;
    let (mechanism, h) = (S::default(), duration / f64::from(STEPS));
    let parameters = mechanism.parameters();
    let time = move |k: u32| f64::from(k) * h;
    let start = match Stepper::<S, f64, N>::assemble(mechanism, mechanism.guess(&parameters), 0.0) {
        Ok(start) => start,
        Err(failure) => return println!("{name} left out: {failure}"),
    };
    let of =
        |stepper: &Stepper<S, f64, N>| Motion { q: *stepper.q(), qd: *stepper.qd(), qdd: *stepper.qdd() };
    let (first, mut stepper, mut own) = (of(&start), start.clone(), Vec::new());
    for k in 1..=STEPS {
        if let Err(failure) = stepped(&mut stepper, time(k)) {
            return println!("{name} left out: {failure}");
        }
        own.push(of(&stepper));
    }
    let scales = mechanism.row_scales(&parameters).map(f64::abs);
    let ([error, peers_error], tolerances) = accuracy((peer, first, &scales), &own, duration);

    let states: Vec<(Motion<N>, f64)> =
        own.iter().zip(1..).map(|(motion, k)| (*motion, time(k))).step_by(STEPS as usize / STATES).collect();
    let theirs = states.clone();
    let evaluate_peer = move || {
        let (mut a, mut b, mut c, mut d) = ([0.0; N], [0.0; Z], [0.0; N], [0.0; N]);
        for (motion, t) in black_box(&theirs) {
            let mut results = [a.as_mut_ptr(), b.as_mut_ptr(), c.as_mut_ptr(), d.as_mut_ptr()];
            call(peer.all, &[motion.q.as_ptr(), motion.qd.as_ptr(), &raw const *t], &mut results);
            black_box(&results);
        }
    };
    let evaluate = move || {
        let mut out = ([0.0; N], [0.0; Z], [0.0; N], [0.0; N]);
        for (motion, t) in black_box(&states) {
            evaluated(black_box(&mechanism), motion, *t, black_box(&mut out));
        }
    };
    let peers_steps = |step: fn(Peer, f64, &[f64; N], f64, &mut Motion<N>)| -> Box<dyn FnMut()> {
        Box::new(move || {
            let mut motion = *black_box(&first);
            (1..=STEPS).for_each(|k| step(peer, h, &tolerances, time(k), &mut motion));
            black_box(&motion);
        })
    };
    let steps = move || {
        let mut stepper = black_box(&start).clone();
        for k in 1..=STEPS {
            black_box(stepped(&mut stepper, time(k)).is_ok());
        }
        black_box(stepper.q());
    };
    let mut cases: [Case; 5] = [
        (STATES as f64, Box::new(evaluate_peer)),
        (STATES as f64, Box::new(evaluate)),
        (f64::from(STEPS), peers_steps(step::<Lu<N>, N>)),
        (f64::from(STEPS), peers_steps(step::<Nalgebra<N>, N>)),
        (f64::from(STEPS), Box::new(steps)),
    ];
    let times = timed(&mut cases, rounds);
    let ratio = |peer: usize, own: usize| {
        let mut ratios: Vec<f64> = times[peer].iter().zip(&times[own]).map(|(a, b)| a / b).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let own_time = |case: usize| times[case].iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{name} {error:e} {peers_error:e} {} {} {} {} {}",
        ratio(0, 1),
        ratio(2, 4),
        ratio(3, 4),
        own_time(1),
        own_time(4)
    );
}

/// Times of a step with dimensions as parameters and with constants, in rounds in which both take turns.
fn as_parameters<S, C, const N: usize>(name: &str, duration: f64, rounds: usize)
where
    S: Kinematic<f64, N> + Default + Copy + 'static,
    C: Kinematic<f64, N> + Default + Copy + 'static,
    Stepper<S, f64, N>: Clone,
    Stepper<C, f64, N>: Clone,
{
    let (Some(parameters), Some(constants)) = (motion::<S, N>(duration), motion::<C, N>(duration)) else {
        return println!("{name} parameters: it does not assemble");
    };
    let times = timed(&mut [(f64::from(STEPS), parameters), (f64::from(STEPS), constants)], rounds);
    let least = |case: usize| times[case].iter().copied().fold(f64::INFINITY, f64::min);
    println!("{name} parameters {} {}", least(0), least(1));
}

/// Error of a step by hand, and time of an emitted step over its time, in rounds in which both take turns.
fn by_hand_too<S, H, const N: usize>(name: &str, duration: f64, rounds: usize)
where
    S: Kinematic<f64, N> + Default + Copy + 'static,
    H: ByHand<N> + Default + 'static,
    Stepper<S, f64, N>: Clone,
{
    let Some((own, typed)) = motion::<S, N>(duration).zip(hand::<S, H, N>(duration)) else {
        return println!("{name} by hand: it does not assemble");
    };
    let error = hands_error::<S, H, N>(duration).unwrap_or(f64::NAN);
    let times = timed(&mut [(f64::from(STEPS), own), (f64::from(STEPS), typed)], rounds);
    let mut ratios: Vec<f64> = times[0].iter().zip(&times[1]).map(|(own, hand)| own / hand).collect();
    ratios.sort_by(f64::total_cmp);
    println!("{name} hand {error:e} {}", ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN));
}

/// State of the assembled mechanism.
fn first<S, const N: usize>() -> Option<Motion<N>>
where
    S: Kinematic<f64, N> + Default + Copy,
{
    let mechanism = S::default();
    let start = Stepper::assemble(mechanism, mechanism.guess(&mechanism.parameters()), 0.0).ok()?;
    Some(Motion { q: *start.q(), qd: *start.qd(), qdd: *start.qdd() })
}

/// The steps of a motion, typed by hand.
fn hand<S, H, const N: usize>(duration: f64) -> Option<Box<dyn FnMut()>>
where
    S: Kinematic<f64, N> + Default + Copy + 'static,
    H: ByHand<N> + Default + 'static,
{
    let (first, h) = (first::<S, N>()?, 0.999 * duration / f64::from(STEPS));
    Some(Box::new(move || {
        let (mut motion, linkage) = (*black_box(&first), *black_box(&H::default()));
        for k in 1..=STEPS {
            black_box(linkage.step(f64::from(k) * h, h, &mut motion));
        }
        black_box(&motion);
    }))
}

/// Largest difference of the steps by hand from those of the emitted code; `None` where a step is refused.
fn hands_error<S, H, const N: usize>(duration: f64) -> Option<f64>
where
    S: Kinematic<f64, N> + Default + Copy,
    H: ByHand<N> + Default,
{
    let (mechanism, h) = (S::default(), 0.999 * duration / f64::from(STEPS));
    let mut stepper = Stepper::assemble(mechanism, mechanism.guess(&mechanism.parameters()), 0.0).ok()?;
    let (mut motion, linkage) = (first::<S, N>()?, H::default());
    let (mut emitted, mut typed) = (Vec::new(), Vec::new());
    for k in 1..=STEPS {
        let t = f64::from(k) * h;
        stepped(&mut stepper, t).ok()?;
        linkage.step(t, h, &mut motion).then_some(())?;
        emitted.push(Motion { q: *stepper.q(), qd: *stepper.qd(), qdd: *stepper.qdd() });
        typed.push(motion);
    }
    Some(difference(&emitted, &typed, 0.999 * duration))
}

/// Steps of a peer, as accurate as the emitted ones.
fn peers<S, const N: usize>(peer: Peer, duration: f64) -> Option<Box<dyn FnMut()>>
where
    S: Kinematic<f64, N> + Mechanism<f64, N, N> + Default + Copy + 'static,
{
    let (mechanism, h) = (S::default(), 0.999 * duration / f64::from(STEPS));
    let first = first::<S, N>()?;
    let scales = mechanism.row_scales(&mechanism.parameters()).map(f64::abs);
    let mut stepper = Stepper::assemble(mechanism, mechanism.guess(&mechanism.parameters()), 0.0).ok()?;
    let mut own = Vec::new();
    for k in 1..=STEPS {
        stepped(&mut stepper, f64::from(k) * h).ok()?;
        own.push(Motion { q: *stepper.q(), qd: *stepper.qd(), qdd: *stepper.qdd() });
    }
    let (_, tolerances) = accuracy((peer, first, &scales), &own, 0.999 * duration);
    Some(Box::new(move || {
        let mut motion = *black_box(&first);
        for k in 1..=STEPS {
            step::<Lu<N>, N>(peer, h, &tolerances, f64::from(k) * h, &mut motion);
        }
        black_box(&motion);
    }))
}

/// Repeats the steps of `subject` so many times, for a counter of instructions.
fn counted<S, C, H, const N: usize>(peer: Peer, duration: f64, [subject, count]: [&str; 2])
where
    S: Kinematic<f64, N> + Mechanism<f64, N, N> + Default + Copy + 'static,
    C: Kinematic<f64, N> + Default + Copy + 'static,
    H: ByHand<N> + Default + 'static,
    Stepper<S, f64, N>: Clone,
    Stepper<C, f64, N>: Clone,
{
    let run = match subject {
        "emitted" => motion::<S, N>(duration),
        "constants" => motion::<C, N>(duration),
        "hand" => hand::<S, H, N>(duration),
        _ => peers::<S, N>(peer, duration),
    };
    if let (Some(mut run), Ok(count)) = (run, count.parse::<u32>()) {
        (0..count).for_each(|_| run());
    }
}

/// A step, called alike by all: where a mechanism has one caller alone, the compiler would inline it there.
#[inline(never)]
fn stepped<S: Kinematic<f64, N>, const N: usize>(of: &mut Stepper<S, f64, N>, t: f64) -> Result<(), Failure> {
    of.advance_to(t).map(drop)
}

/// The steps of a motion.
fn motion<S, const N: usize>(duration: f64) -> Option<Box<dyn FnMut()>>
where
    S: Kinematic<f64, N> + Default + Copy + 'static,
    Stepper<S, f64, N>: Clone,
{
    let (mechanism, h) = (S::default(), 0.999 * duration / f64::from(STEPS));
    let start = Stepper::assemble(mechanism, mechanism.guess(&mechanism.parameters()), 0.0).ok()?;
    Some(Box::new(move || {
        let mut stepper = black_box(&start).clone();
        for k in 1..=STEPS {
            black_box(stepped(&mut stepper, f64::from(k) * h).is_ok());
        }
        black_box(stepper.q());
    }))
}

#[inline(never)]
fn evaluated<S, const N: usize, const Z: usize>(
    mechanism: &S,
    motion: &Motion<N>,
    t: f64,
    out: &mut ([f64; N], [f64; Z], [f64; N], [f64; N]),
) where
    S: Mechanism<f64, N, N, Entries = [f64; Z]>,
{
    let e = mechanism.evaluate(&mechanism.parameters(), &motion.q, t, &motion.qd);
    *out = (e.phi, e.phi_q_entries, e.phi_t, e.gamma);
}

/// Times (ns) of one evaluation or step in rounds in which all cases take turns.
fn timed(cases: &mut [Case], rounds: usize) -> Vec<Vec<f64>> {
    let repetitions: Vec<u32> = cases
        .iter_mut()
        .map(|(_, run)| {
            run();
            let start = processor_time();
            (0..3).for_each(|_| run());
            (1e-3 * 3.0 / (processor_time() - start)).clamp(1.0, 1e5) as u32
        })
        .collect();
    let mut times = vec![Vec::new(); cases.len()];
    for round in 0..rounds {
        for place in 0..cases.len() {
            let index = (place + 3 * round) % cases.len();
            let (work, run) = &mut cases[index];
            let start = processor_time();
            (0..repetitions[index]).for_each(|_| run());
            times[index].push(1e9 * (processor_time() - start) / (f64::from(repetitions[index]) * *work));
        }
    }
    times
}

/// Processor time (s) of this thread.
#[cfg(target_os = "linux")]
fn processor_time() -> f64 {
    unsafe extern "C" {
        fn clock_gettime(clock: c_int, time: *mut [std::ffi::c_long; 2]) -> c_int;
    }
    let mut time = [0; 2];
    // SAFETY: the structure of a 64-bit Linux, which is written to; 3 is the thread's clock.
    unsafe { clock_gettime(3, &mut time) };
    time[0] as f64 + 1e-9 * time[1] as f64
}

/// Elsewhere the wall-clock time (s).
#[cfg(not(target_os = "linux"))]
fn processor_time() -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [name, subject, count] = &arguments[..] {
        let asked = [subject.as_str(), count.as_str()];
        // COUNTS
        let _ = (name, asked);
        return;
    }
    let rounds = std::env::args().nth(1).and_then(|rounds| rounds.parse().ok()).unwrap_or(31);
    // LINKAGES
}

unsafe extern "C" {
    // FUNCTIONS
}

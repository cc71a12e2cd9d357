//! Errors that runs estimate, against the true ones: pendulums, contacts, friction, ready mechanisms.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, ErrorEstimate, Explicit, Projection, Simulation, Tolerance,
};
use mbs_runtime::{Dynamic, mechanism};
use mechanisms::andrews::Andrews;
use mechanisms::bricard::Bricard;
use mechanisms::car_axis::CarAxis;
use mechanisms::cart_pole::CartPole;
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::four_bar_mass::FourBarMassReleased;
use mechanisms::governor::Governor;
use mechanisms::heavy_top::HeavyTop;
use mechanisms::n_four_bar::NFourBar;
use mechanisms::n_four_bar_1::NFourBar1;
use mechanisms::n_four_bar_10::NFourBar10;
use mechanisms::n_four_bar_40::NFourBar40;
use mechanisms::pendulum::Pendulum;
use mechanisms::quarter_car::QuarterCar;
use mechanisms::slider_crank_engine::SliderCrankEngineTight;
use mechanisms::slider_crank_mass::CrankPistonReleased;

mechanism! {
    /// A ball that bounces on a soft floor.
    pub mechanism Ball;
    coord y: m = 0.3;
    coord x: m = 0;
    body ball { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, stiffness: 1e5, exponent: 1.5, depth: 0.001, damping: 20 }
    tsda spring { from: [0, 1], to: [x, y], stiffness: 3, length: 0.2, damping: 0 }
    start y = 0.3 rate 0;
    start x = 0 rate 0.4;
}

mechanism! {
    /// A pendulum that swings against a stop on each side.
    pub mechanism Stops;
    coord phi: rad = 0.4;
    body bob { mass: 0.5, com: 0.6m*[sin(phi), -cos(phi)], inertia: 0.01, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    contact right { gap: 0.25m - 0.6m*sin(phi), stiffness: 2e4, exponent: 1.5, depth: 0.002, damping: 5 }
    contact left { gap: 0.35m + 0.6m*sin(phi), stiffness: 2e4, exponent: 1.5, depth: 0.002, damping: 5 }
    start phi = 0.2 rate 1;
}

mechanism! {
    /// A block on a spring, with Coulomb friction smoothed by a small speed.
    pub mechanism Block;
    coord x: m = 0.3;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint table { y == 0; }
    tsda spring { from: [-1, 0], to: [x, y], stiffness: 80, length: 1, damping: 0 }
    friction table_friction { along: x, normal: lambda(table), coefficient: 0.2, speed: 0.01, viscous: 0 }
    start x = 0.3 rate 0;
    start y = 0 rate 0;
}

mechanism! {
    /// A point mass on a rod.
    pub mechanism Cartesian;
    coord p: [m; 2] = [-1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    start p = [-1, 0] rate [0, 0];
}

mechanism! {
    /// A double pendulum, level at the start: chaotic after some seconds.
    pub mechanism Double;
    coord a: rad = 1.5707963;
    coord b: rad = 1.5707963;
    let elbow = [sin(a), -cos(a)]*1m;
    body upper { mass: 1, com: elbow }
    body lower { mass: 1, com: elbow + [sin(b), -cos(b)]*1m }
    gravity weight { acceleration: [0, -9.81] }
    start a = 90deg rate 0;
    start b = 90deg rate 0;
}

/// Starts of a mechanism: of one whose runs take long fewer.
const STARTS: u32 = 8;
const FEW: u32 = 2;

/// Bounds of an estimate over the true error.
const BOUNDS: [f64; 2] = [0.3, 30.0];

/// Errors below it are rounding.
const ROUNDED: f64 = 1e-12;

/// A number in [−1, 1] for each start and coordinate: the fractional parts of multiples of the golden ratio.
fn shaken(start: u32, index: usize) -> f64 {
    2.0 * (f64::from(start * 31 + 7 * index as u32 + 1) * 0.618_033_988_749_895).fract() - 1.0
}

/// Estimates over true errors: those that are trusted, and how many are not.
#[derive(Default)]
struct Found {
    trusted: Vec<(f64, f64)>,
    untrusted: usize,
    outside: usize,
}

/// Coordinates at 16 instants to `until` (s).
fn course<S, I, const N: usize, const M: usize>(
    run: &Simulation<S, Explicit<I, Projection>, f64, N, M>,
    until: f64,
    tolerance: f64,
) -> Option<Vec<[f64; N]>>
where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    let mut run = run.clone().with_tolerance(Tolerance::new(tolerance));
    let mut course = Vec::new();
    run.sample(until, 16, |instant| course.push(instant.y.q)).ok()?;
    Some(course)
}

fn apart<const N: usize>(a: &[[f64; N]], b: &[[f64; N]], scales: &[f64; N]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten()).zip(scales.iter().cycle());
    pairs.map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, f64::max)
}

/// All starts with one integrator and tolerance.
fn estimates<S, I, const N: usize, const M: usize>(
    (mechanism, until, integrator): (&S, f64, I),
    (starts, finest): (u32, f64),
    tolerances: &[f64],
    found: &mut Found,
) where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    let method = Explicit::new(integrator, Projection::default());
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let text = Simulation::start_from_text(mechanism.clone(), method, 0.0).expect("it starts");
    for start in 0..starts {
        let (mut q, mut qd) = (*text.q(), *text.qd());
        for (index, (q, qd)) in q.iter_mut().zip(&mut qd).enumerate().filter(|_| start > 0) {
            *q += 0.02 * shaken(start, index) * scales[index];
            *qd *= 1.0 + 0.05 * shaken(start, index + N);
        }
        let Ok(run) = Simulation::start_near(mechanism.clone(), method, 0.0, q, qd) else { continue };
        let (Some(truth), Some(check)) = (course(&run, until, finest), course(&run, until, 30.0 * finest))
        else {
            continue;
        };
        let width = apart(&truth, &check, &scales);
        for tolerance in tolerances {
            let mut estimated = run.clone().with_tolerance(Tolerance::new(*tolerance)).with_error_estimate();
            if estimated.advance_to(until).is_err() {
                continue;
            }
            let own = course(&run, until, *tolerance).expect("the same run");
            let error = apart(&own, &truth, &scales);
            if error < 10.0 * width || error < ROUNDED {
                continue;
            }
            let ratio = estimated.error_estimate().value() / error;
            match estimated.error_estimate() {
                ErrorEstimate::Trusted(_) => found.trusted.push((ratio, *tolerance)),
                ErrorEstimate::Untrusted(_) => {
                    found.untrusted += 1;
                    found.outside += usize::from(!(BOUNDS[0]..=BOUNDS[1]).contains(&ratio));
                }
            }
        }
    }
}

/// Checks a mechanism with an integrator. Returns the number of trusted estimates and of all.
fn checked<S, I, const N: usize, const M: usize>(
    name: &str,
    run: (&S, f64, I),
    extent: (u32, f64),
    tolerances: &[f64],
    all: &mut [usize; 2],
) where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    let mut found = Found::default();
    estimates(run, extent, tolerances, &mut found);
    let Found { mut trusted, untrusted, outside } = found;
    trusted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ratio = |index: usize| trusted.get(index).map_or(f64::NAN, |ratio| ratio.0);
    println!(
        "{name}: {} trusted, {:.2} to {:.1}, median {:.1}; {untrusted} untrusted, {outside} of them outside",
        trusted.len(),
        ratio(0),
        ratio(trusted.len().wrapping_sub(1)),
        ratio(trusted.len() / 2)
    );
    assert!(trusted.len() + untrusted > 0, "{name}: no estimate");
    let is_outside = |ratio: &&(f64, f64)| !(BOUNDS[0] <= ratio.0 && ratio.0 <= BOUNDS[1]);
    let lost: Vec<&(f64, f64)> = trusted.iter().filter(is_outside).collect();
    assert!(lost.is_empty(), "{name}: {lost:?}");
    *all = [all[0] + trusted.len(), all[1] + trusted.len() + untrusted];
}

const TOLERANCES: [f64; 6] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// Runs `body` with a stack for the largest mechanisms.
fn with_large_stack(body: fn()) {
    let thread = std::thread::Builder::new().stack_size(1 << 28).spawn(body).expect("a thread");
    if let Err(reason) = thread.join() {
        std::panic::resume_unwind(reason);
    }
}

#[test]
fn estimates_are_trusted_within_their_bounds_alone() {
    with_large_stack(|| {
        let mut all = [0, 0];
        macro_rules! check {
            ($name:literal, $mechanism:expr, $until:expr) => {
                check!($name, $mechanism, $until, STARTS)
            };
            ($name:literal, $mechanism:expr, $until:expr, $starts:expr) => {{
                let mechanism = $mechanism;
                let run = (&mechanism, $until, DormandPrince8);
                checked($name, run, ($starts, 1e-13), &TOLERANCES, &mut all);
                let run = (&mechanism, $until, DormandPrince5);
                checked($name, run, ($starts, 1e-12), &TOLERANCES, &mut all);
            }};
        }
        check!("point mass on a rod", Cartesian::<f64>::default(), 3.0);
        check!("double pendulum, level", Double::<f64>::default(), 2.0);
        check!("ball", Ball::<f64>::default(), 1.5);
        check!("stops", Stops::<f64>::default(), 2.0);
        check!("block", Block::<f64>::default(), 1.5);
        check!("pendulum", Pendulum::<f64>::default(), 5.0);
        check!("double pendulum", DoublePendulum::<f64>::default(), 3.0);
        check!("cart-pole", CartPole::<f64>::default(), 1.0);
        check!("four-bar", FourBarMassReleased::<f64>::default(), 1.0);
        check!("slider-crank", CrankPistonReleased::<f64>::default(), 0.6);
        check!("engine", SliderCrankEngineTight::<f64>::default(), 0.05);
        check!("one loop", NFourBar1::<f64>::default(), 0.6);
        check!("two loops", NFourBar::<f64>::default(), 0.6);
        check!("ten loops", NFourBar10::<f64>::default(), 0.6, FEW);
        check!("forty loops", NFourBar40::<f64>::default(), 0.6, FEW);
        check!("Andrews", Andrews::<f64>::default(), 0.03);
        check!("heavy top", HeavyTop::<f64>::default(), 0.5, FEW);
        check!("car axle", CarAxis::<f64>::default(), 0.5);
        check!("quarter car", QuarterCar::<f64>::default(), 3.0);
        check!("Bricard", Bricard::<f64>::default(), 0.3, FEW);
        check!("governor", Governor::<f64>::default(), 0.3, FEW);
        let [trusted, count] = all;
        println!("{trusted} of {count} are trusted");
        assert!(5 * trusted > 4 * count, "{trusted} of {count} are trusted");
    });
}

#[test]
fn a_chaotic_motion_has_no_trusted_estimate() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Double::<f64>::default(), method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-6)).with_error_estimate();
    run.advance_to(60.0).expect("a motion");
    assert_eq!(run.error_estimate().trusted(), None);
    assert!(run.error_estimate().value() > 0.1);
}

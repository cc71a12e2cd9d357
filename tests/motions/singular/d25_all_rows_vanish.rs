//! D25: where all rows lose their entries at once, a motion changed its assembly with `Ok`: uprights in angles, one distance a loop.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince5, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method,
    Projection, Radau5, RungeKutta4, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::mechanism;

macro_rules! uprights {
    ($name:ident, $loops:literal, $row:literal) => {
        mechanism! {
            /// Uniform uprights and couplers of 1 kg; the couplers are rows of distances times a number.
            pub mechanism $name;
            const N: 1 = $loops;
            param L: m = 1;
            param b: m = 1;
            param speed: rad/s = -3;
            coord phi: [rad; N + 1] = PI/2;
            gravity weight { acceleration: [0, -9.81] }
            for i in 0..N + 1 {
                body upright { mass: 1, inertia: 1kg*L^2/12, com: [i*b, 0] + L/2*unit(phi[i]), angle: phi[i] }
                start phi[i] = PI/2 rate speed;
            }
            for i in 0..N {
                let A = [i*b, 0] + L*unit(phi[i]);
                let B = [(i + 1)*b, 0] + L*unit(phi[i + 1]);
                body coupler { mass: 1, com: (A + B)/2 }
                kinetic turned = 1kg*dot(der(B - A), der(B - A))/24;
                constraint couplers { $row*norm(B - A) == $row*b; }
            }
        }
    };
}

uprights!(OneLoop, 1, 1);
uprights!(TwoLoops, 2, 1);
uprights!(Small, 1, 0.001);
uprights!(Large, 1, 1000);

/// The first angle (rad) after `seconds`, by a composition of leapfrogs: (n/3 + n − 1) L φ̈ = −(n/2 + n − 1) g cos φ, n uprights.
/// Source: Yoshida 1990.
fn exact(loops: u32, length: f64, speed: f64, seconds: f64) -> f64 {
    const STEPS: u32 = 100_000;
    let uprights = f64::from(loops + 1);
    let couplers = f64::from(loops);
    let stiffness = 9.81 * (uprights / 2.0 + couplers) / (length * (uprights / 3.0 + couplers));
    let h = seconds / f64::from(STEPS);
    let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
    let (mut angle, mut rate) = (core::f64::consts::FRAC_PI_2, speed);
    for _ in 0..STEPS {
        for share in [outer, 1.0 - 2.0 * outer, outer] {
            angle += 0.5 * share * h * rate;
            rate -= share * h * stiffness * angle.cos();
            angle += 0.5 * share * h * rate;
        }
    }
    angle
}

/// Errors of the energy come back as errors of the angle, within a million times the tolerance of a step.
const GROWTH: f64 = 1e6;

macro_rules! assert_right {
    ($text:ident, $loops:literal, ($length:expr, $distance:expr), $speeds:expr, $seconds:expr, $tolerances:expr, $methods:tt) => {
        for speed in $speeds {
            let angle = exact($loops, $length, speed, $seconds);
            for tolerance in $tolerances {
                let text = || $text { L: $length, b: $distance, speed };
                assert_right!(@each text, angle, $seconds, tolerance, $methods);
            }
        }
    };
    (@each $text:ident, $angle:ident, $seconds:expr, $tolerance:ident, [$($method:expr),*]) => { $(
        let run = Simulation::start_from_text($text(), $method, 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new($tolerance));
        run.advance_to($seconds).unwrap_or_else(|failure| panic!("{}: {failure}", $tolerance));
        for found in run.q() {
            assert!((found - $angle).abs() < GROWTH * $tolerance, "{:?} {} at {}", run.q(), $angle, $tolerance);
        }
    )* };
}

/// Speeds (rad/s) from `first` in `count` steps of `step`.
fn speeds(first: f64, step: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| first - step * f64::from(k))
}

/// At 1e-6 an error of the energy is as large as the way from one assembly to the other is far.
const TOLERANCES: [f64; 3] = [1e-8, 1e-9, 1e-10];

#[test]
fn uprights_whose_rows_all_vanish_in_line_stay_parallel() {
    assert_right!(
        OneLoop,
        1,
        (1.0, 1.0),
        speeds(-3.0, 0.05, 20),
        10.0,
        TOLERANCES,
        [
            Explicit::new(DormandPrince8, Projection::default()),
            Explicit::new(DormandPrince8, VelocityTransformation),
            Explicit::new(DormandPrince5, Projection::default())
        ]
    );
    assert_right!(
        TwoLoops,
        2,
        (1.0, 1.0),
        speeds(-3.0, 0.05, 20),
        10.0,
        TOLERANCES,
        [
            Explicit::new(DormandPrince8, Projection::default()),
            Explicit::new(DormandPrince8, VelocityTransformation),
            Explicit::new(DormandPrince5, Projection::default())
        ]
    );
    assert_right!(
        OneLoop,
        1,
        (0.1, 0.3),
        speeds(-20.0, 0.1, 10),
        2.0,
        TOLERANCES,
        [
            Explicit::new(DormandPrince8, Projection::default()),
            Explicit::new(DormandPrince8, VelocityTransformation)
        ]
    );
}

#[test]
fn implicit_steps_take_such_uprights_through_the_line_too() {
    assert_right!(
        OneLoop,
        1,
        (1.0, 1.0),
        speeds(-3.0, 0.25, 4),
        4.0,
        [1e-8, 1e-9],
        [Explicit::new(Radau5, Projection::default())]
    );
}

#[test]
fn steps_of_fixed_size_take_such_uprights_through_the_line_too() {
    for speed in speeds(-3.0, 0.1, 10) {
        let angle = exact(2, 1.0, speed, 10.0);
        let text = TwoLoops { L: 1.0, b: 1.0, speed };
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut run = Simulation::start_from_text(text, method, 0.0).expect("it starts");
        run.step_to(10.0, 5000).expect("it turns");
        for found in run.q() {
            assert!((found - angle).abs() < 1e-5, "{:?} {angle}", run.q());
        }
    }
}

#[test]
fn a_number_in_such_a_row_changes_nothing() {
    assert_right!(
        Small,
        1,
        (1.0, 1.0),
        speeds(-3.0, 0.2, 5),
        10.0,
        [1e-9],
        [
            Explicit::new(DormandPrince8, Projection::default()),
            Explicit::new(DormandPrince8, VelocityTransformation)
        ]
    );
    assert_right!(
        Large,
        1,
        (1.0, 1.0),
        speeds(-3.0, 0.2, 5),
        10.0,
        [1e-9],
        [
            Explicit::new(DormandPrince8, Projection::default()),
            Explicit::new(DormandPrince8, VelocityTransformation)
        ]
    );
}

#[test]
fn the_margin_falls_with_the_distance_from_the_line() {
    for distance in [1e-2, 1e-4, 1e-6] {
        let text = OneLoop { L: 1.0, b: 1.0, speed: 0.0 };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start(text, method, 0.0, [distance; 2], [-3.0; 2]).expect("it starts");
        assert!(run.margin() < 4.0 * distance, "{} at {distance}", run.margin());
    }
}

mechanism! {
    /// A bead on two guides that cross: its row loses all entries at the crossing, and its weight acts across the motion.
    pub mechanism Guides;
    /// Direction of the guides.
    param turn: rad = 0;
    coord p: [m; 2] = [-1, 0];
    body bead { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    let along = dot(p, unit(turn));
    let across = dot(p, unit(turn + 90deg));
    constraint guides { along*across == 0 [m^2]; }
    start p = -1m*unit(turn) rate 6*unit(turn);
}

/// Runs of an implicit method that end right, wrong and refused, over the crossing at several directions.
fn crossed<X: Method<Guides<f64>, f64, 2, 1> + Copy>(name: &str, method: X) -> [u32; 3] {
    let (mut found, seconds) = ([0; 3], 0.5);
    for turn in [0.0, 0.1, 0.25_f64] {
        let along = -1.0 + 6.0 * seconds - 0.5 * 9.81 * turn.sin() * seconds * seconds;
        for steps in [100, 333, 1000, 3001, 10_007, 30_011] {
            let mut run = Simulation::start_from_text(Guides { turn }, method, 0.0).expect("it starts");
            let place = match run.step_to(seconds, steps) {
                Err(_) => 2,
                Ok(()) => {
                    let [x, y] = *run.q();
                    let error = (x - along * turn.cos()).hypot(y - along * turn.sin());
                    usize::from(0.01_f64.max(1e3 / f64::from(steps).powi(2)) < error)
                }
            };
            found[place] += 1;
        }
    }
    println!("{name}: {found:?} right, wrong, refused");
    found
}

#[test]
fn no_implicit_step_takes_speed_at_a_crossing_of_guides() {
    let found = [
        crossed("augmented Lagrangian", AugmentedLagrangian),
        crossed("extrapolated", Extrapolated),
        crossed("generalised-α", GeneralizedAlpha::default()),
    ];
    assert!(found.iter().all(|[_, wrong, _]| *wrong == 0), "{found:?}");
    assert!(found.iter().all(|[right, _, _]| 0 < *right), "{found:?}");
}

//! K1, K4: slider-cranks at and next to their dead centres, which are change points where the slider drives.
//!
//! A slider that an input moves by r cos θ and so on was at its place again behind a dead centre, and its crank stayed on the side
//! that it had come from, with `Ok`.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Budget, Kinematic, Lanes, Real, Scalar, Signal, Step, Stepper, mechanism};

use crate::linkages::follow::*;

/// A crank of length a and a rod of length 1 m, its slider at height e.
#[derive(Clone, Copy, Debug)]
struct Design {
    a: f64,
    e: f64,
}

const ROD: f64 = 1.0;

impl Design {
    /// Position (m) of the slider on the outer side at crank angle `theta` (rad).
    fn slider(&self, theta: f64) -> f64 {
        let rise = self.a * theta.sin() - self.e;
        self.a * theta.cos() + ((ROD - rise) * (ROD + rise)).sqrt()
    }

    /// Crank angles (rad) of the dead centres: crank and rod in line, stretched and folded.
    fn centres(&self) -> [f64; 2] {
        [(self.e / (ROD + self.a)).asin(), PI - (self.e / (ROD - self.a)).asin()]
    }

    fn tip(&self, theta: f64) -> [f64; 2] {
        [self.a * theta.cos(), self.a * theta.sin()]
    }

    /// Crank angle (rad) of the other assembly with the slider at the same place: mirrored on the line to the slider.
    fn mirrored(&self, theta: f64) -> f64 {
        2.0 * self.e.atan2(self.slider(theta)) - theta
    }

    /// Sine of the angle between crank and rod, with the sign of the assembly.
    fn sine(&self, theta: f64) -> f64 {
        let [x, y] = self.tip(theta);
        (x * (self.e - y) - y * (self.slider(theta) - x)) / (self.a * ROD)
    }
}

/// Drive of a slider-crank.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Driven {
    /// The crank: the slider is the point.
    Crank,
    /// The slider, by the motion that a turning crank gives it: the tip passes the dead centres with the crank.
    Slider,
    /// The slider, by its place: the tip comes back from the dead centres on its own side.
    Place,
}

/// A slider-crank as a text has it.
trait Case<T: Scalar, const N: usize>: Kinematic<T, N> {
    const DRIVEN: Driven;
    /// The time is the crank angle.
    const TIMED: bool;
    fn set_lengths(&mut self, design: &Design);
    /// The measured value and its rate.
    fn command(&mut self, value: T, rate: T);
    /// Coordinates with the tip at `tip`, the slider at `x` and the rod in direction `psi`.
    fn start(phi: f64, tip: [f64; 2], psi: f64, x: f64) -> [f64; N];
    /// The slider where the crank drives, the tip otherwise.
    fn point(design: &Design, q: [f64; N]) -> [f64; 2];
}

macro_rules! slider_crank {
    ($name:ident, $n:literal, $driven:expr, $timed:literal, { $($text:tt)* }, |$s:ident, $v:ident| $command:expr,
     |$phi:ident, $tip:ident, $psi:ident, $x:ident| $guess:expr, |$d:ident, $q:ident| $point:expr) => {
        mechanism! {
            /// A slider-crank.
            pub mechanism $name;
            param a: m = 0.23;
            param b: m = 1;
            param e: m = 0;
            $($text)*
        }
        impl<T: Scalar> Case<T, $n> for $name<T> {
            const DRIVEN: Driven = $driven;
            const TIMED: bool = $timed;
            fn set_lengths(&mut self, design: &Design) {
                [self.a, self.b, self.e] = [design.a, ROD, design.e].map(T::constant);
            }
            fn command(&mut self, value: T, rate: T) {
                let ($s, $v) = (self, Signal { value, rate, acceleration: T::constant(0.0) });
                $command
            }
            fn start($phi: f64, $tip: [f64; 2], $psi: f64, $x: f64) -> [f64; $n] {
                $guess
            }
            fn point($d: &Design, $q: [f64; $n]) -> [f64; 2] {
                $point
            }
        }
    };
}

slider_crank!(CrankAngles, 2, Driven::Crank, false, {
    input theta: rad, rates;
    coord psi: rad = 0.1;
    coord x: m = 1;
    constraint closure { a*unit(theta) + b*unit(psi) == [x, e]; }
}, |crank, v| crank.theta = v, |_phi, _tip, psi, x| [psi, x], |d, q| [q[1], d.e]);
slider_crank!(CrankPoints, 4, Driven::Crank, false, {
    input theta: rad, rates;
    coord crank: rad = 0;
    coord A: [m; 2] = [0.2, 0];
    coord x: m = 1;
    constraint bars { A == a*unit(crank); norm([x, e] - A) == b; }
    drive motor: crank == theta;
}, |crank, v| crank.theta = v, |phi, tip, _psi, x| [phi, tip[0], tip[1], x], |d, q| [q[3], d.e]);
slider_crank!(CrankPointsByTime, 3, Driven::Crank, true, {
    coord A: [m; 2] = [0.2, 0];
    coord x: m = 1;
    constraint bars { A == a*unit(1*t/1s); dot([x, e] - A, [x, e] - A) == b^2; }
}, |_crank, _v| (), |_phi, tip, _psi, x| [tip[0], tip[1], x], |d, q| [q[2], d.e]);
slider_crank!(SliderAngles, 2, Driven::Slider, false, {
    input theta: rad, rates;
    let x = a*cos(theta) + sqrt(b^2 - (a*sin(theta) - e)^2);
    coord phi: rad = 0.1;
    coord psi: rad = 0.1;
    constraint closure { a*unit(phi) + b*unit(psi) == [x, e]; }
}, |crank, v| crank.theta = v, |phi, _tip, psi, _x| [phi, psi], |d, q| d.tip(q[0]));
slider_crank!(SliderAnglesByTime, 3, Driven::Slider, true, {
    let theta = 1*t/1s;
    coord phi: rad = 0.1;
    coord psi: rad = 0.1;
    coord x: m = 1;
    constraint closure { a*unit(phi) + b*unit(psi) == [x, e]; }
    drive slider: x == a*cos(theta) + sqrt(b^2 - (a*sin(theta) - e)^2);
}, |_crank, _v| (), |phi, _tip, psi, x| [phi, psi, x], |d, q| d.tip(q[0]));
slider_crank!(SliderPoints, 2, Driven::Slider, false, {
    input theta: rad, rates;
    let x = a*cos(theta) + sqrt(b^2 - (a*sin(theta) - e)^2);
    coord A: [m; 2] = [0.2, 0];
    constraint bars { norm(A) == a; norm([x, e] - A) == b; }
}, |crank, v| crank.theta = v, |_phi, tip, _psi, _x| tip, |_d, q| q);
slider_crank!(SliderPointsByTime, 3, Driven::Slider, true, {
    let theta = 1*t/1s;
    coord A: [m; 2] = [0.2, 0];
    coord x: m = 1;
    constraint bars { dot(A, A) == a^2; dot([x, e] - A, [x, e] - A) == b^2; }
    drive slider: x == a*cos(theta) + sqrt(b^2 - (a*sin(theta) - e)^2);
}, |_crank, _v| (), |_phi, tip, _psi, x| [tip[0], tip[1], x], |_d, q| [q[0], q[1]]);
slider_crank!(PlaceAngles, 2, Driven::Place, false, {
    input x: m, rates;
    coord phi: rad = 0.1;
    coord psi: rad = 0.1;
    constraint closure { a*unit(phi) + b*unit(psi) == [x, e]; }
}, |crank, v| crank.x = v, |phi, _tip, psi, _x| [phi, psi], |d, q| d.tip(q[0]));
slider_crank!(PlacePoints, 3, Driven::Place, false, {
    input place: m, rates;
    coord A: [m; 2] = [0.2, 0];
    coord x: m = 1;
    constraint bars { norm(A) == a; norm([x, e] - A) == b; }
    drive slider: x == place;
}, |crank, v| crank.place = v, |_phi, tip, _psi, x| [tip[0], tip[1], x], |_d, q| [q[0], q[1]]);

/// One run: crank angles (rad), and the assembly at the first.
#[derive(Clone, Debug)]
struct Run {
    angles: Vec<f64>,
    side: f64,
}

/// Angle of the crank in the assembly `side` at sample angle `theta`.
fn crank(design: &Design, driven: Driven, theta: f64, side: f64) -> f64 {
    let own = match driven {
        Driven::Crank => true,
        Driven::Slider => side > 0.0,
        Driven::Place => design.sine(theta) * side > 0.0,
    };
    if own { theta } else { design.mirrored(theta) }
}

/// The points of the assembly `side` and of the other one.
fn assemblies(design: &Design, driven: Driven, theta: f64, side: f64) -> [[f64; 2]; 2] {
    match driven {
        Driven::Crank => {
            let outer = design.slider(theta);
            let inner = 2.0 * design.a * theta.cos() - outer;
            if side > 0.0 {
                [[outer, design.e], [inner, design.e]]
            } else {
                [[inner, design.e], [outer, design.e]]
            }
        }
        _ => [side, -side].map(|side| design.tip(crank(design, driven, theta, side))),
    }
}

/// The margin to singularity, of the coordinates that have less of it.
fn margin(design: &Design, driven: Driven, theta: f64) -> f64 {
    match driven {
        Driven::Crank => (1.0 - ((design.a * theta.sin() - design.e) / ROD).powi(2)).sqrt(),
        _ => 2.0 * (design.a * ROD * design.sine(theta)).abs() / (design.a.powi(2) + ROD.powi(2)),
    }
}

/// Coordinates at the start of a run.
fn start<T: Scalar, S: Case<T, N>, const N: usize>(design: &Design, run: &Run, theta: f64) -> [f64; N] {
    let phi = crank(design, S::DRIVEN, theta, run.side);
    let tip = design.tip(phi);
    let x = match S::DRIVEN {
        Driven::Crank => assemblies(design, S::DRIVEN, theta, run.side)[0][0],
        _ => design.slider(theta),
    };
    S::start(phi, tip, (design.e - tip[1]).atan2(x - tip[0]), x)
}

/// The value that a sample gives.
fn value<T: Scalar, S: Case<T, N>, const N: usize>(design: &Design, theta: f64) -> f64 {
    if S::DRIVEN == Driven::Place { design.slider(theta) } else { theta }
}

/// Follows a run with one stepper.
fn follow<S, R, const N: usize>(mechanism: S, design: &Design, run: &Run, rates: Rates, by: Steps) -> Tally
where
    S: Case<R, N>,
    R: Real,
{
    let exact = |number: f64| R::constant(number).to_f64();
    let design = &Design { a: exact(design.a), e: exact(design.e) };
    let angles: Vec<f64> = run.angles.iter().map(|angle| exact(*angle)).collect();
    let of = |theta: f64| R::constant(value::<R, S, N>(design, theta));
    let mut mechanism = mechanism;
    mechanism.set_lengths(design);
    mechanism.command(of(angles[0]), R::constant(0.0));
    let guess = start::<R, S, N>(design, run, angles[0]).map(R::constant);
    let t = R::constant(if S::TIMED { angles[0] } else { 0.0 });
    let mut stepper: Stepper<S, R, N> = Stepper::assemble(mechanism, guess, t)
        .unwrap_or_else(|failure| panic!("{} {design:?} {}: {failure}", S::NAME, angles[0]));
    let mut tally = Tally::default();
    let mut stands = angles[0];
    for pair in angles.windows(2) {
        let (last, theta) = (pair[0], pair[1]);
        let rate = match rates {
            Rates::Differences => of(theta) - of(last),
            Rates::Zero => R::constant(0.0),
        };
        stepper.change(|mechanism| mechanism.command(of(theta), rate));
        let h = if S::TIMED { R::constant(theta) - stepper.t() } else { R::constant(1.0) };
        let done = match by {
            Steps::Advance if S::TIMED => stepper.advance_to(R::constant(theta)).map(|_| ()),
            Steps::Advance => stepper.advance(h).map(|_| ()),
            Steps::Within(budget) => match stepper.step(h, budget) {
                Step::Done(_) | Step::Degraded { .. } => Ok(()),
                Step::Refused(failure) => Err(failure),
            },
        };
        let point = S::point(design, stepper.q().map(R::to_f64));
        let both = assemblies(design, S::DRIVEN, theta, run.side);
        let margin = margin(design, S::DRIVEN, theta);
        if tally.judge(both, margin, theta, R::EPSILON.to_f64(), done.map(|()| point)) {
            tally.passages += passed(design, stands, theta);
            stands = theta;
        }
    }
    tally
}

/// Number of dead centres between two crank angles.
fn passed(design: &Design, from: f64, to: f64) -> u64 {
    let turn = |theta: f64, centre: f64| ((theta - centre) / TAU).floor();
    design.centres().iter().filter(|centre| turn(from, **centre) != turn(to, **centre)).count() as u64
}

/// Follows four runs of one design in lanes.
fn follow_in_lanes<S, R, const N: usize>(
    mechanism: S,
    design: &Design,
    runs: &[Run; 4],
    rates: Rates,
) -> Tally
where
    R: Real,
    S: Case<Lanes<R, 4>, N>,
    S::Lane: Kinematic<R, N>,
{
    let exact = |number: f64| R::constant(number).to_f64();
    let design = &Design { a: exact(design.a), e: exact(design.e) };
    let angle = |lane: usize, k: usize| exact(runs[lane].angles[k]);
    let of = |k: usize| {
        Lanes::<R, 4>::from_lanes(|lane| R::constant(value::<Lanes<R, 4>, S, N>(design, angle(lane, k))))
    };
    let mut mechanism = mechanism;
    mechanism.set_lengths(design);
    mechanism.command(of(0), Lanes::constant(0.0));
    let guess = core::array::from_fn(|lane| {
        start::<Lanes<R, 4>, S, N>(design, &runs[lane], angle(lane, 0)).map(R::constant)
    });
    let time = |k: usize| core::array::from_fn(|lane| R::constant(angle(lane, k)));
    let mut batch = Batch::<S, R, 4, N>::assemble(
        mechanism,
        &guess,
        if S::TIMED { time(0) } else { [R::constant(0.0); 4] },
    )
    .unwrap_or_else(|(lane, failure)| panic!("{} {design:?} {lane}: {failure}", S::NAME));
    let mut tally = Tally::default();
    let count = runs.iter().map(|run| run.angles.len()).min().unwrap_or(0);
    let mut stands: [f64; 4] = core::array::from_fn(|lane| angle(lane, 0));
    for k in 1..count {
        let rate = match rates {
            Rates::Differences => of(k) - of(k - 1),
            Rates::Zero => Lanes::constant(0.0),
        };
        batch.change(|mechanism| mechanism.command(of(k), rate));
        let t = if S::TIMED { time(k) } else { batch.t().0.map(|t| t + R::constant(1.0)) };
        for (lane, step) in batch.advance_to(t).into_iter().enumerate() {
            let theta = angle(lane, k);
            let point = S::point(design, batch.q().map(|coordinate| coordinate.lane(lane).to_f64()));
            let both = assemblies(design, S::DRIVEN, theta, runs[lane].side);
            let margin = margin(design, S::DRIVEN, theta);
            if tally.judge(both, margin, theta, R::EPSILON.to_f64(), step.map(|_| point)) {
                tally.passages += passed(design, stands[lane], theta);
                stands[lane] = theta;
            }
        }
    }
    tally
}

/// The crank of 0.23 rods in line, and designs at random: short and long cranks, half of them with a height.
fn designs() -> Vec<Design> {
    let mut random = Random(41);
    let mut all = vec![Design { a: 0.23, e: 0.0 }, Design { a: 0.23, e: 0.1 }];
    for k in 0..24 {
        let a = random.between(0.05, 0.95);
        let e = if k % 2 == 0 { 0.0 } else { random.between(-0.9, 0.9) * (ROD - a) };
        all.push(Design { a, e });
    }
    all
}

/// Steps (rad).
const STEPS: [f64; 6] = [0.003, 0.01, 0.1, 0.3, 1.0, 3.0];

/// A run that starts where the design can be assembled in either number type.
fn run(
    design: &Design,
    driven: Driven,
    motion: Motion,
    step: f64,
    count: usize,
    side: f64,
    random: &mut Random,
) -> Run {
    loop {
        let angles = samples_about(motion, &design.centres(), step, count, random);
        // Cranks of a twentieth of the rod have margins of a tenth.
        if margin(design, driven, angles[0]) > 0.04 {
            return Run { angles, side };
        }
    }
}

/// Every design, motion and step.
fn matrix<S, R, const N: usize>(mechanism: S, by: Steps) -> Tally
where
    S: Case<R, N> + Copy,
    R: Real,
{
    let mut sum = Tally::default();
    let mut random = Random(N as u64);
    for design in designs() {
        for motion in MOTIONS {
            for (k, step) in STEPS.into_iter().enumerate() {
                for side in [1.0, -1.0] {
                    let rates = if k % 2 == 0 { Rates::Differences } else { Rates::Zero };
                    // Numbers of seven digits tell angles apart for some turns.
                    let turns = if R::EPSILON.to_f64() > 1e-10 { 2.0 } else { 1e3 };
                    let count = if step < 0.02 { 200 } else { 40.min((turns * TAU / step) as usize + 2) };
                    let run = run(&design, S::DRIVEN, motion, step, count, side, &mut random);
                    let tally = follow::<S, R, N>(mechanism, &design, &run, rates, by);
                    if tally.wrong + tally.off + tally.refused > 0 {
                        println!("  {design:?} {motion:?} {step} {rates:?} {side}: {tally:?}");
                    }
                    sum = sum.and(tally);
                }
            }
        }
    }
    println!("{}: {sum:?}", S::NAME);
    sum
}

/// Every design and motion in lanes.
fn in_lanes<S, R, const N: usize>(mechanism: S) -> Tally
where
    R: Real,
    S: Case<Lanes<R, 4>, N> + Copy,
    S::Lane: Kinematic<R, N>,
{
    let mut sum = Tally::default();
    let mut random = Random(43);
    for design in designs() {
        for motion in MOTIONS {
            for step in [0.01, 0.1, 1.0] {
                let runs = [1.0, -1.0, 1.0, -1.0]
                    .map(|side| run(&design, S::DRIVEN, motion, step, 40, side, &mut random));
                let tally = follow_in_lanes::<S, R, N>(mechanism, &design, &runs, Rates::Differences);
                if tally.wrong + tally.off + tally.refused > 0 {
                    println!("  {design:?} {motion:?} {step}: {tally:?}");
                }
                sum = sum.and(tally);
            }
        }
    }
    println!("{} in lanes: {sum:?}", S::NAME);
    sum
}

/// No wrong position. In `f32` a passage may be refused, and with it the steps until the crank is back: most of them where a crank of
/// nine tenths of the rod folds.
fn keeps(tally: Tally) {
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off), (0, 0), "{tally:?}");
    assert!(35 * tally.refused <= tally.steps, "{tally:?}");
}

fn holds(tally: Tally) {
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

/// More than any step takes.
const AMPLE: Steps = Steps::Within(Budget { newton: 3_000, fallback: 0 });

macro_rules! kept {
    ($($(#[$cfg:meta])? $test:ident: $mechanism:ident;)*) => {
        $(mod $test {
            use super::*;

            #[test]
            fn step_by_step() {
                holds(matrix::<_, f64, _>($mechanism::default(), Steps::Advance));
            }

            #[test]
            fn in_bounded_steps() {
                holds(matrix::<_, f64, _>($mechanism::default(), AMPLE));
            }

            $(#[$cfg])?
            #[test]
            fn in_lanes() {
                holds(super::in_lanes::<_, f64, _>($mechanism::<Lanes<f64, 4>>::default()));
            }

            $(#[$cfg])?
            #[test]
            fn in_single_precision() {
                keeps(matrix::<_, f32, _>($mechanism::default(), Steps::Advance));
                keeps(matrix::<_, f32, _>($mechanism::default(), AMPLE));
                keeps(super::in_lanes::<_, f32, _>($mechanism::<Lanes<f32, 4>>::default()));
            }
        })*
    };
}

// Lanes and single precision of the second tier are of mechanisms whose drive another test has in other coordinates.
kept! {
    a_crank_drives_angles: CrankAngles;
    #[cfg(feature = "long")] a_crank_drives_points: CrankPoints;
    #[cfg(feature = "long")] time_drives_points: CrankPointsByTime;
    #[cfg(feature = "long")] a_slider_drives_angles: SliderAngles;
    #[cfg(feature = "long")] a_slider_over_time_drives_angles: SliderAnglesByTime;
    a_slider_drives_points: SliderPoints;
    #[cfg(feature = "long")] a_slider_over_time_drives_points: SliderPointsByTime;
    a_place_drives_angles: PlaceAngles;
    #[cfg(feature = "long")] a_place_drives_points: PlacePoints;
}

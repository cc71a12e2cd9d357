//! Tests of `mechanisms::bouncing_balls`.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, MoreauJean, Projection, RungeKutta4, Simulation};

use mechanisms::bouncing_balls::*;

const G: f64 = 9.81;
const E: f64 = 0.9;
const MASSES: [f64; 3] = [0.3, 0.2, 0.1];
const RADIUS: f64 = 0.1;
const SIDE: f64 = 0.6 - RADIUS;

/// Balls between two impacts.
#[derive(Clone, Copy)]
struct Flight {
    t: f64,
    place: [[f64; 2]; 3],
    speed: [[f64; 2]; 3],
}

/// An impact: of a ball with the floor or a wall, of two balls.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Impact {
    Floor(usize),
    Wall(usize),
    Balls(usize, usize),
}

impl Flight {
    fn start() -> Self {
        let place = [[-0.3, 0.9], [0.1, 1.2], [0.35, 0.7]];
        Flight { t: 0.0, place, speed: [[1.1, 0.3], [-0.4, 0.0], [-0.9, 1.5]] }
    }

    fn at(&self, t: f64) -> Self {
        let h = t - self.t;
        let mut there = *self;
        there.t = t;
        for (place, speed) in there.place.iter_mut().zip(&mut there.speed) {
            place[0] += speed[0] * h;
            place[1] += speed[1] * h - 0.5 * G * h * h;
            speed[1] -= G * h;
        }
        there
    }

    /// The next impact and the time until then (s): of each pair of bodies the first time at which they approach.
    fn next(&self) -> (f64, Impact) {
        let mut found = (f64::INFINITY, Impact::Floor(0));
        let mut see = |h: f64, impact| {
            if h < found.0 {
                found = (h, impact);
            }
        };
        for (ball, ([x, y], [u, v])) in self.place.iter().zip(&self.speed).enumerate() {
            let height = (y - RADIUS).max(0.0);
            see((v + (v * v + 2.0 * G * height).sqrt()) / G, Impact::Floor(ball));
            if *u != 0.0 {
                see((SIDE * u.signum() - x) / u, Impact::Wall(ball));
            }
        }
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let between = |of: &[[f64; 2]; 3]| [of[b][0] - of[a][0], of[b][1] - of[a][1]];
            let (d, w) = (between(&self.place), between(&self.speed));
            let (dw, ww) = (d[0] * w[0] + d[1] * w[1], w[0] * w[0] + w[1] * w[1]);
            let root = dw * dw - ww * (d[0] * d[0] + d[1] * d[1] - 4.0 * RADIUS * RADIUS);
            if dw < 0.0 && root > 0.0 {
                see((-dw - root.sqrt()) / ww, Impact::Balls(a, b));
            }
        }
        found
    }

    fn strike(&mut self, impact: Impact) {
        match impact {
            Impact::Floor(ball) => self.speed[ball][1] *= -E,
            Impact::Wall(ball) => self.speed[ball][0] *= -E,
            Impact::Balls(a, b) => {
                let d = [self.place[b][0] - self.place[a][0], self.place[b][1] - self.place[a][1]];
                let length = d[0].hypot(d[1]);
                let n = [d[0] / length, d[1] / length];
                let rate = n[0] * (self.speed[b][0] - self.speed[a][0])
                    + n[1] * (self.speed[b][1] - self.speed[a][1]);
                let impulse = -(1.0 + E) * rate / (1.0 / MASSES[a] + 1.0 / MASSES[b]);
                for (n, axis) in n.into_iter().zip(0..2) {
                    self.speed[a][axis] -= impulse * n / MASSES[a];
                    self.speed[b][axis] += impulse * n / MASSES[b];
                }
            }
        }
    }
}

/// Positions in closed form at `count` equal distances up to `until` (s), and the impacts on the way.
fn flown(until: f64, count: u32) -> (Vec<[[f64; 2]; 3]>, Vec<Impact>) {
    let (mut flight, mut places, mut impacts) = (Flight::start(), Vec::new(), Vec::new());
    for index in 1..=count {
        let t = until * f64::from(index) / f64::from(count);
        loop {
            let (h, impact) = flight.next();
            if t < flight.t + h {
                break;
            }
            flight = flight.at(flight.t + h);
            flight.strike(impact);
            impacts.push(impact);
        }
        places.push(flight.at(t).place);
    }
    (places, impacts)
}

fn worst(found: &[f64; 6], exact: &[[f64; 2]; 3]) -> f64 {
    let pairs = found.iter().zip(exact.as_flattened());
    pairs.fold(0.0, |worst: f64, (found, exact)| worst.max((found - exact).abs()))
}

fn in_vacuum() -> BouncingBalls {
    BouncingBalls { drag: 0.0, ..BouncingBalls::default() }
}

#[test]
fn without_air_balls_fly_along_parabolas_between_impacts() {
    let (until, count) = (1.6, 80);
    let (places, impacts) = flown(until, count);
    let of_balls = impacts.iter().filter(|impact| matches!(impact, Impact::Balls(..))).count();
    let of_walls = impacts.iter().filter(|impact| matches!(impact, Impact::Wall(_))).count();
    assert!(of_balls >= 2 && of_walls >= 2 && impacts.len() >= 8, "{impacts:?}");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(in_vacuum(), method, 0.0_f64).expect("a start");
    let mut off = Vec::new();
    run.watch(until, count, |run| off.push(run.q().to_owned())).expect("a run");
    let adaptive = off.iter().zip(&places).map(|(q, exact)| worst(q, exact)).fold(0.0, f64::max);
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(in_vacuum(), method, 0.0_f64).expect("a start");
    let mut fixed = 0.0_f64;
    for (exact, index) in places.iter().zip(1..) {
        run.step_to(until * f64::from(index) / f64::from(count), 1).expect("a step");
        fixed = fixed.max(worst(run.q(), exact));
    }
    println!("bouncing balls, {} impacts: {adaptive:.1e} m, fixed steps {fixed:.1e} m", impacts.len());
    assert!(adaptive < 1e-9 && fixed < 1e-9, "{adaptive:e} {fixed:e}");
}

#[test]
fn steps_over_impacts_converge_to_parabolas() {
    let (until, count) = (0.8, 40);
    let (places, _) = flown(until, count);
    for (parts, most) in [(20, 1.5e-2), (160, 2e-3)] {
        let run = Simulation::start_from_text(in_vacuum(), MoreauJean, 0.0_f64);
        let (mut run, mut off, mut last) = (run.expect("a start"), 0.0_f64, f64::MAX);
        for (exact, index) in places.iter().zip(1..) {
            run.step_to(until * f64::from(index) / f64::from(count), parts).expect("a step");
            off = off.max(worst(run.q(), exact));
            let energy = run.balance().energy;
            assert!(energy.kinetic + energy.potential < last + 1e-12, "{parts}: {:?}", run.balance());
            last = energy.kinetic + energy.potential;
        }
        println!("bouncing balls, steps of {:.1e} s: {off:.1e} m", until / f64::from(count * parts));
        assert!(off < most, "{parts}: {off:e}");
    }
}

#[test]
fn in_the_air_energy_falls_and_all_balls_come_to_rest() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let dull = BouncingBalls { e: 0.5, ..BouncingBalls::default() };
    let mut run = Simulation::start_from_text(dull, method, 0.0_f64).expect("a start");
    let mut before = f64::INFINITY;
    for k in 1..=30 {
        run.advance_to(0.1 * f64::from(k)).expect("a run");
        let balance = run.balance();
        let energy = balance.energy.kinetic + balance.energy.potential;
        assert!(energy <= before + 1e-9 && balance.defect.abs() < 1e-8, "{energy} {}", balance.defect);
        before = energy;
    }
    for ball in 0..3 {
        assert!((run.q()[2 * ball + 1] - 0.1).abs() < 1e-9, "{:?}", run.q());
    }
}

//! Tests of `mechanisms::woodpecker`.

use mbs_runtime::dynamics::{
    Direction, DormandPrince8, Explicit, MoreauJean, Projection, Simulation, Tolerance,
};

use mechanisms::woodpecker::*;

/// Time, y and a of the strikes of the beak, by `mechanisms/references/woodpecker.c` with steps of 1e-8 s: `cc -O2 woodpecker.c -lm -o w && ./w 1e-8 1.2`.
const STRIKES: [[f64; 3]; 8] = [
    [0.080_989_30, -0.007_325_910, 0.089_219_199],
    [0.226_842_26, -0.026_634_691, 0.089_566_787],
    [0.372_922_65, -0.046_195_626, 0.089_272_928],
    [0.518_811_85, -0.065_544_659, 0.089_518_040],
    [0.664_861_32, -0.085_071_364, 0.089_311_144],
    [0.810_776_13, -0.104_448_804, 0.089_483_973],
    [0.956_803_91, -0.123_951_469, 0.089_338_313],
    [1.102_736_80, -0.143_348_952, 0.089_460_207],
];

/// Period (s) and fall (m) of the limit cycle by the same program with steps of 1e-7 s: the mean of cycles 35 to 46.
const PERIOD: f64 = 0.145_976_4;
const DROP: f64 = 0.019_445_6;

fn started() -> Simulation<Woodpecker<f64>, Explicit<DormandPrince8, Projection>, f64, 3, 0> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Woodpecker::default(), method, 0.0_f64).expect("it starts");
    run.with_tolerance(Tolerance::new(1e-10))
}

#[test]
fn a_woodpecker_descends_as_by_time_stepping() {
    let (mut run, after) = (started(), 1e-5);
    for [t, y, a] in STRIKES {
        // The bird turns with about 17 rad/s before a strike, and back with half of it.
        run.advance_to(t - after).expect("it goes on");
        assert!(run.qd()[2] > 16.0, "{t}: {:?}", run.instant());
        run.advance_to(t + after).expect("it strikes");
        assert!(run.qd()[2] < -8.0, "{t}: {:?}", run.instant());
        let off = [run.q()[0] - run.qd()[0] * after - y, run.q()[1] - run.qd()[1] * after - a];
        // Of the reference, whose times are 3e-7 s off; the sleeve turns with 23 rad/s.
        assert!(off[0].abs() < 3e-7 && off[1].abs() < 1e-5, "{t}: {off:?}");
    }
    assert!(run.balance().defect.abs() < 1e-10, "{:?}", run.balance());
}

/// Steps over impacts and jams, by the library's own time-stepping: the reference is that of another program.
#[test]
fn steps_over_strikes_converge_to_the_reference() {
    for h in [5e-5, 1.25e-5] {
        let run = Simulation::start_from_text(Woodpecker::default(), MoreauJean, 0.0_f64);
        let (mut run, mut last) = (run.expect("it starts"), f64::MAX);
        for [t, y, _] in STRIKES.into_iter().take(2) {
            let before = run.t();
            run.step_to(t, ((t - before) / h).round() as u32).expect("it goes on");
            assert!((run.q()[0] - y).abs() < 12.0 * h, "{h} {t}: {:?} {y}", run.q());
            let energy = run.balance().energy;
            assert!(energy.kinetic + energy.potential < last, "{h} {t}: {:?}", run.balance());
            last = energy.kinetic + energy.potential;
        }
    }
}

#[test]
fn a_woodpecker_settles_to_its_limit_cycle() {
    let (mut run, mut before, mut cycle) = (started(), [0.0; 4], [0.0; 4]);
    for _ in 0..60 {
        assert!(run.advance_until_event(20.0, Direction::Rising, |_, q, _| q[2]).expect("it goes on"));
        let [y, a, _] = *run.q();
        let now = [run.t(), y, a, run.qd()[2]];
        cycle = core::array::from_fn(|index| now[index] - before[index]);
        before = now;
    }
    let [period, drop, turned, faster] = cycle;
    assert!(turned.abs() < 1e-6 && faster.abs() < 1e-4, "{cycle:?}");
    assert!((period - PERIOD).abs() < 1e-6 && (drop + DROP).abs() < 1e-6, "{cycle:?}");
}

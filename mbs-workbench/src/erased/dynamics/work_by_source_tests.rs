//! Works of forces that act between two of the instants shown.

use mbs_runtime::mechanism;

use crate::erased::dynamics::direct_dynamics::{Approach, Pair, Rule, Stabilization, Steps};
use crate::erased::erase::erase;
use crate::erased::facade::AnyEquations;
use crate::motion::power_balance::PowerSource;
use crate::motion::{Forces, instants};

mechanism! {
    /// Blows of a tenth of a millisecond, two of them against each other; a carriage that a drive sets in motion within 0.3 s.
    mechanism Blows;
    coord x: m = 0;
    coord y: m = 0;
    coord z: m = 0;
    body cart { mass: 2, com: [x, 0] }
    body other { mass: 1, com: [0, y] }
    body carriage { mass: 3, com: [z, 1m] }
    for i in 0..4 { event after: t > 2.0001s + 0.1ms*i until never; }
    force kick: 2000N*(after[0] - after[1]) on x;
    force left: -500N*(after[2] - after[3]) on y;
    force right: 500N*(after[2] - after[3]) on y;
    force idle: 0*t/1s*1N on x;
    let u = (t - 2.5s)/0.3s;
    let c = min(max(u, 0), 1);
    drive ramp: z == 2m/1s*0.3s*(c^3 - c^4/2 + max(u - 1, 0));
    start x = 0 rate 0;
    start y = 0 rate 1;
}

fn followed(mechanism: &dyn AnyEquations, steps: Steps, count: usize) -> Forces {
    let approach = Approach { stabilization: Stabilization::Projection, steps };
    let dynamics = mechanism.dynamics().expect("it has masses");
    let found = dynamics.simulate(&approach, &instants(4.0, count), &mut |_| ()).expect("it starts");
    assert_eq!(found.failure, None);
    found.motion.dynamics.expect("it has masses")
}

#[test]
fn forces_that_act_between_two_instants_have_their_works() {
    let mechanism = erase(Blows::default()).into_equations();
    let equal = Steps::Equal { rule: Rule::RungeKutta4, longest: 1e-2 };
    let adaptive = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-10 };
    for (steps, has_ramp) in [(equal, true), (adaptive, false)] {
        for count in [1, 4, 40] {
            let found = followed(&*mechanism, steps, count);
            let work = |name: &str| {
                found.supplies.iter().find(|supply| supply.name == name).expect("a supply").total()
            };
            // p²/(2 m) of the cart, F v Δt of the other one, m v²/2 of the carriage.
            assert!((work("kick") - 0.01).abs() < 1e-12, "{count}: {}", work("kick"));
            assert!((work("left") + 0.05).abs() < 1e-12, "{count}: {}", work("left"));
            assert!((work("right") - 0.05).abs() < 1e-12, "{count}: {}", work("right"));
            assert_eq!(work("idle"), 0.0);
            if has_ramp {
                assert!((work("ramp") - 6.0).abs() < 1e-6, "{count}: {}", work("ramp"));
                let ramp = found.supplies.last().expect("a drive");
                assert!(ramp.by == PowerSource::Drive && !ramp.is_idle());
            }
        }
    }
}

mechanism! {
    /// Twelve carts, one of which is pushed for a moment.
    mechanism Many;
    const N: 1 = 12;
    coord x: [m; N] = 0;
    for i in 0..N {
        body carts { mass: 2, com: [x[i], 0] }
        event after: t > 1.0001s + 0.1ms*i/(N - 1) until never;
        force kicks: 2000N*(after[0] - after[N - 1])*min(max(i - 8, 0), 1)*max(10 - i, 0) on x[i];
        start x[i] = 0 rate 0;
    }
}

#[test]
fn one_of_many_that_acts_is_found() {
    let mechanism = erase(Many::default()).into_equations();
    let adaptive = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-10 };
    let found = followed(&*mechanism, adaptive, 3);
    assert_eq!(found.supplies.len(), 12);
    for supply in &found.supplies {
        let expected = if supply.name == "kicks.9" { 0.01 } else { 0.0 };
        assert!((supply.total() - expected).abs() < 1e-12, "{}: {}", supply.name, supply.total());
        assert!(supply.power.iter().all(|power| *power == 0.0));
    }
}

//! Numbers by chance as coordinates, times, inputs and parameters, and calls by chance on a running mechanism: an answer that holds,
//! or a typed failure and the state as it was.

#![no_main]

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince5, Explicit, Method, Projection, RungeKutta4, Simulation,
    VelocityTransformation,
};
use mbs_runtime::{Budget, Failure, Mechanism, Saved, Step, Stepper, mechanism};

mechanism! {
    /// A slider-crank that a measured angle and a time law drive.
    pub mechanism Press;
    param crank: m = 0.05;
    param rod: m = 0.18;
    param speed: rad/s = 3;
    input measured: rad, rates;
    coord theta: rad = 0.3;
    coord phi: rad = -0.1;
    coord x: m = 0.22;
    constraint closure { crank*unit(theta) + rod*unit(phi) == [x, 0]; }
    drive motor: theta == 0.3 + speed*t + measured;
    branch ahead: cos(phi) > 0;
    limit stroke: 0m <= x <= 1m;
}

mechanism! {
    /// A bob on a rod and a spring, above a floor.
    pub mechanism Swing;
    param length: m = 1;
    param mass: kg = 2;
    param stiffness: N/m = 30;
    input push: N;
    coord p: [m; 2] = [0.8, -0.6];
    body bob { mass: mass, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [1, 0], to: p, stiffness: stiffness, length: 0.4, damping: 0.5 }
    force wind: [push, 0] on p;
    contact floor { gap: p.1 + 0.9m, stiffness: 1e4, damping: 0.1 }
    constraint rod { dot(p, p) == length^2; }
}

/// Numbers near those of a motion, numbers of any size, and any bits.
fn number(choices: &mut Unstructured<'_>, usual: f64) -> Result<f64> {
    Ok(match choices.int_in_range(0..=3)? {
        0 => usual,
        1 => usual + f64::from(choices.arbitrary::<i16>()?) * 1e-5,
        2 => f64::from(choices.arbitrary::<i8>()?) * 10_f64.powi(choices.int_in_range(-20..=20)?),
        _ => choices.arbitrary()?,
    })
}

fn bits(values: &[&[f64]]) -> Vec<u64> {
    values.iter().flat_map(|values| values.iter()).map(|value| value.to_bits()).collect()
}

fn state(stepper: &Stepper<Press, f64, 3>) -> Vec<u64> {
    bits(&[stepper.q(), stepper.qd(), stepper.qdd(), &[stepper.t(), stepper.margin()]])
}

fn driven(choices: &mut Unstructured<'_>) -> Result<()> {
    let guess = [number(choices, 0.3)?, number(choices, -0.1)?, number(choices, 0.22)?];
    let mut press = Press::default();
    for index in 0..Press::<f64>::VARIABLES.len() {
        let usual = press.get(index).unwrap_or(0.0);
        press.set(index, number(choices, usual)?);
    }
    let Ok(mut stepper) = Stepper::assemble(press, guess, number(choices, 0.0)?) else { return Ok(()) };
    while !choices.is_empty() {
        let before = state(&stepper);
        let answer: Result<(), Failure> = match choices.int_in_range(0..=5)? {
            0 => stepper.advance(number(choices, 1e-3)?).map(|_| ()),
            1 => stepper.advance_to(number(choices, stepper.t())?).map(|_| ()),
            2 => {
                let budget =
                    Budget { newton: choices.int_in_range(0..=40)?, fallback: choices.int_in_range(0..=40)? };
                match stepper.step(number(choices, 1e-3)?, budget) {
                    Step::Refused(failure) => Err(failure),
                    // What is not closed yet says so, and its residual with it.
                    _ => continue,
                }
            }
            3 => {
                let mut page = [0_u8; 512];
                let length = stepper.save().to_le_bytes_into(&mut page).expect("room");
                let changed = choices.int_in_range(0..=page.len() - 1)?;
                let by = choices.arbitrary::<u8>()?;
                page[changed] ^= by;
                let saved = Saved::from_le_bytes(&page[..length]);
                assert!(changed >= length || by == 0 || saved.is_none(), "a byte has changed unseen");
                if let Some(saved) = saved {
                    let _ =
                        Stepper::assemble_near(*stepper.mechanism(), &saved, number(choices, stepper.t())?);
                }
                continue;
            }
            _ => {
                let index = choices.int_in_range(0..=Press::<f64>::VARIABLES.len() - 1)?;
                let value = number(choices, stepper.mechanism().get(index).unwrap_or(0.0))?;
                stepper.change(|press| press.set(index, value));
                continue;
            }
        };
        match answer {
            Ok(()) => {
                let finite =
                    [stepper.q(), stepper.qd(), stepper.qdd()].into_iter().flatten().all(|x| x.is_finite());
                assert!(finite && stepper.t().is_finite() && stepper.margin() > 0.0, "{:?}", stepper.qdd());
                // An angle of 1e10 rad has a rounding of 1e-6 rad.
                let coarse = stepper.q().iter().fold(1e7, |most: f64, x| most.max(x.abs()));
                assert!(
                    stepper.closure_error() < 64.0 * f64::EPSILON * coarse,
                    "{:e}: {:?} {:?} t {:e}",
                    stepper.closure_error(),
                    stepper.q(),
                    stepper.mechanism().values(),
                    stepper.t()
                );
                assert!(stepper.q()[1].cos() > 0.0, "the branch is left: {:?}", stepper.q());
            }
            Err(failure) => {
                assert_eq!(state(&stepper), before, "{failure}");
                assert!(!failure.to_string().is_empty());
            }
        }
    }
    Ok(())
}

fn moved<X: Method<Swing, f64, 2, 1> + Clone>(choices: &mut Unstructured<'_>, method: X) -> Result<()> {
    let q = [number(choices, 0.8)?, number(choices, -0.6)?];
    let qd = [number(choices, 0.0)?, number(choices, 0.0)?];
    let mut swing = Swing::default();
    for index in 0..Swing::<f64>::VARIABLES.len() {
        let usual = swing.get(index).unwrap_or(0.0);
        swing.set(index, number(choices, usual)?);
    }
    let t = number(choices, 0.0)?;
    let Ok(mut run) = Simulation::<Swing, X, f64, 2, 1>::start(swing, method, t, q, qd) else {
        return Ok(());
    };
    for _ in 0..8 {
        let state = |run: &Simulation<Swing, X, f64, 2, 1>| {
            bits(&[run.q(), run.qd(), run.qdd(), run.lambda(), &[run.t()]])
        };
        let before = state(&run);
        match run.step(number(choices, 1e-3)?) {
            Ok(()) => {
                let finite = [run.q(), run.qd(), run.qdd()].into_iter().flatten().all(|x| x.is_finite());
                assert!(finite && run.t().is_finite(), "{:?} {:?}", run.q(), run.qdd());
            }
            Err(failure) => {
                assert_eq!(state(&run), before, "{failure}");
                assert!(!failure.to_string().is_empty());
            }
        }
    }
    Ok(())
}

fuzz_target!(|bytes: &[u8]| {
    let mut choices = Unstructured::new(bytes);
    // Bytes that end early leave nothing to do.
    let _ = match choices.int_in_range(0..=5) {
        Ok(0 | 1) => driven(&mut choices),
        Ok(2) => moved(&mut choices, Explicit::new(RungeKutta4, Projection::default())),
        Ok(3) => moved(&mut choices, Explicit::new(DormandPrince5, VelocityTransformation)),
        Ok(4) => moved(&mut choices, Explicit::new(RungeKutta4, Baumgarte::default())),
        _ => moved(&mut choices, AugmentedLagrangian),
    };
});

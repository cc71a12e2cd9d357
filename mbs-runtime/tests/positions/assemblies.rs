//! Which of several assemblies is found, and how the caller can tell.

use mbs_runtime::{Failure, FailureKind, Signal, Stepper, assemble, mechanism};

mechanism! {
    /// A crank-rocker of ground 4, crank 1, coupler 3, rocker 3.5; without a branch.
    mechanism CrankRocker;
    coord phi: rad;
    coord psi: rad = 0;
    coord chi: rad = 0;
    constraint closure { 1m*unit(phi) + 3m*unit(psi) == [4m, 0] + 3.5m*unit(chi); }
    drive motor: phi == t*1rad/1s;
}

mechanism! {
    /// The same with a declared assembly.
    mechanism Declared;
    param side: 1 = 1;
    coord phi: rad;
    coord psi: rad = 0;
    coord chi: rad = 0;
    constraint closure { 1m*unit(phi) + 3m*unit(psi) == [4m, 0] + 3.5m*unit(chi); }
    drive motor: phi == t*1rad/1s;
    branch open: side*sin(chi - psi) > 0;
}

mechanism! {
    /// Crank and rod of one length: at 90° the slider is over the crank's bearing, where a second motion branches off.
    mechanism EqualRods;
    input theta: rad, rates;
    coord phi: rad;
    coord rod: rad = 0;
    coord x: m = 2;
    constraint closure { 1m*unit(phi) + 1m*unit(rod) == [x, 0]; }
    drive encoder: phi == theta;
}

/// At crank angle 1 rad: coupler and rocker angles of both assemblies, from the two circles that meet.
fn both() -> [[f64; 2]; 2] {
    let (sine, cosine) = 1.0_f64.sin_cos();
    let (x, y) = (4.0 - cosine, -sine);
    let diagonal = x.hypot(y);
    let along = (9.0 - 12.25 + diagonal * diagonal) / (2.0 * diagonal);
    let height = (9.0 - along * along).sqrt();
    [1.0, -1.0].map(|side| {
        let meet = [
            cosine + (along * x - side * height * y) / diagonal,
            sine + (along * y + side * height * x) / diagonal,
        ];
        [(meet[1] - sine).atan2(meet[0] - cosine), meet[1].atan2(meet[0] - 4.0)]
    })
}

/// Difference of two angles on the circle (rad).
fn apart(a: f64, b: f64) -> f64 {
    ((a - b + core::f64::consts::PI).rem_euclid(core::f64::consts::TAU) - core::f64::consts::PI).abs()
}

#[test]
fn a_guess_within_half_a_radian_leads_to_its_own_assembly() {
    for solution in both() {
        for k in 0..400 {
            // Over a square of half a radian.
            let offset = [k % 20, k / 20].map(|step| 0.5 * (f64::from(step) / 9.5 - 1.0));
            let guess = [1.0, solution[0] + offset[0], solution[1] + offset[1]];
            let q = assemble(&CrankRocker::<f64>::default(), guess, 1.0).expect("it can be assembled").q;
            assert!(
                apart(q[1], solution[0]) < 1e-12 && apart(q[2], solution[1]) < 1e-12,
                "{offset:?}: {q:?}"
            );
        }
    }
}

#[test]
fn the_signature_tells_two_assemblies_apart_whatever_the_guess_was() {
    let signatures = both().map(|solution| {
        let guess = [1.0, solution[0], solution[1]];
        Stepper::assemble(CrankRocker::<f64>::default(), guess, 1.0).expect("it assembles").signature()
    });
    assert_ne!(signatures[0], signatures[1]);
    for k in 0..400 {
        let guess = [1.0, f64::from(k % 20) * 0.3 - 3.0, f64::from(k / 20) * 0.3 - 3.0];
        let stepper = Stepper::assemble(CrankRocker::<f64>::default(), guess, 1.0).expect("it assembles");
        let found = both().map(|solution| apart(stepper.q()[2], solution[1]) < 1e-12);
        assert_eq!(found, signatures.map(|signature| signature == stepper.signature()), "{guess:?}");
    }
}

#[test]
fn a_declared_assembly_is_found_from_half_a_turn_and_a_thousand_radians_away_with_few_evaluations() {
    for (side, solution) in [1.0, -1.0].into_iter().zip(both()) {
        for k in 0..200 {
            let far = 1e3 + core::f64::consts::PI * (f64::from(k) / 100.0 - 1.0);
            let guess = [1.0, solution[0] + far, solution[1] - far * 0.7];
            let found = [side, -side]
                .map(|side| assemble(&Declared { side }, guess, 1.0).expect("it can be assembled"));
            let right =
                found.map(|found| [1, 2].into_iter().all(|k| apart(found.q[k], solution[k - 1]) < 1e-9));
            assert!(right[0] != right[1], "one side each: {right:?}");
            for assembled in found {
                // Turns of the guess are kept: it is reached, not wound back.
                assert!(
                    assembled.q.iter().zip(guess).all(|(q, guess)| (q - guess).abs() < 20.0),
                    "{assembled:?}"
                );
                assert!(assembled.statistics.evaluations < 33 * 160);
            }
        }
    }
}

#[test]
fn a_motion_in_the_undeclared_assembly_is_refused_with_the_branch_and_its_line() {
    let solution = both()[0];
    let guess = [1.0, solution[0], solution[1]];
    let side = (solution[1] - solution[0]).sin().signum();
    let mut stepper = Stepper::assemble(Declared { side }, guess, 1.0).expect("declared");
    let before = (*stepper.q(), *stepper.qd(), *stepper.qdd());
    stepper.change(|design| design.side = -side);
    let failure = stepper.advance(0.01).expect_err("the other side is declared now");
    assert!(
        matches!(failure, Failure { kind: FailureKind::WrongBranch { branch, .. }, .. } if branch.name == "open" && branch.line > 1)
    );
    assert_eq!((*stepper.q(), *stepper.qd(), *stepper.qdd()), before);
}

#[test]
fn a_slider_over_the_bearing_goes_on_in_the_motion_that_it_came_in() {
    // 90° itself, met and missed, from both sides; x = 2 cos θ is the one motion, x = 0 the other.
    for (steps, lands) in [(20, true), (21, false), (40, true), (133, false)] {
        let quarter = core::f64::consts::FRAC_PI_2;
        let at = |k: i32| quarter - 0.6 + 1.2 * f64::from(k) / f64::from(steps);
        let signal = |theta| Signal { value: theta, rate: 1.0, acceleration: 0.0 };
        let design = EqualRods { theta: signal(at(0)) };
        let mut stepper =
            Stepper::assemble(design, [at(0), -at(0), 2.0 * at(0).cos()], 0.0).expect("a regular position");
        for k in 1..=steps {
            stepper.change(|design| design.theta = signal(at(k)));
            match stepper.advance(1.2 / f64::from(steps)) {
                Ok(_) => {
                    let x = 2.0 * at(k).cos();
                    assert!((stepper.q()[2] - x).abs() < 1e-9 / (at(k) - quarter).abs(), "{steps}, {k}");
                }
                Err(failure) => {
                    assert!(lands && 2 * k == steps, "{steps}, {k}: {failure}");
                    assert!(
                        matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }),
                        "{failure}"
                    );
                }
            }
        }
        assert_eq!(stepper.passages(), 1);
    }
}

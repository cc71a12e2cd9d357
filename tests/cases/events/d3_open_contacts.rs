//! D3: an open contact costs no operation in the stages of a step; fixed steps that meet one.

use super::counted::{Counted, counted};
use super::texts::Roofed;
use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince5, DormandPrince8, Explicit, GeneralizedAlpha, Method, Projection,
    Radau5, RungeKutta4, SemiImplicitEuler, Simulation, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Mechanism, mechanism};

mechanism! {
    pub mechanism Free;
    coord phi: rad = 0.3;
    coord p: [m; 2] = [0.4, 0.1];
    coord y: m = 1;
    body rod { mass: 2, com: p, inertia: 0.1, angle: phi }
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [100, 1], to: p, stiffness: 40, length: 99.5m, damping: 2 }
    constraint arm { p == 0.5m*unit(phi); }
}

mechanism! {
    pub mechanism Crowd;
    coord phi: rad = 0.3;
    coord p: [m; 2] = [0.4, 0.1];
    coord y: m = 1;
    body rod { mass: 2, com: p, inertia: 0.1, angle: phi }
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [100, 1], to: p, stiffness: 40, length: 99.5m, damping: 2 }
    constraint arm { p == 0.5m*unit(phi); }
    contact floor { gap: y + 100m, stiffness: 1e6, damping: 0.2, bound: 9.81 }
    contact wall { gap: 9m + p[0]*sin(2*phi) + 0.1m*cos(3*phi + t/1s), stiffness: 1e6, exponent: 1.5, depth: 1mm, bound: 1e3 }
    contact touch { gap: 8m - sqrt(p[0]^2 + (y - p[1])^2), stiffness: 1e5, damping: 1, bound: 1e3 }
}

type States = ([Counted; 4], [Counted; 4]);

fn state() -> States {
    ([0.3, 0.5 * 0.3_f64.cos(), 0.5 * 0.3_f64.sin(), 1.0].map(Counted), [0.7, 0.2, -0.3, 2.0].map(Counted))
}

/// Operations of each function of a right-hand side, and of its tangents.
fn costs<S: Dynamic<Counted, 4, 2, States = [Counted; 0]>>(mechanism: &S, open: bool) -> [u64; 5] {
    let (q, qd) = state();
    let mut parameters = mechanism.parameters();
    if open {
        S::evaluated_mut(&mut parameters).fill(false);
    }
    let (p, l, z) = (&parameters, [Counted(0.0); 2], []);
    let (s, position) = counted(|| mechanism.position(p, &q, Counted(0.2)));
    let (_, force) = counted(|| mechanism.force(p, &s, &qd, &z, &l));
    let (_, powers) = counted(|| mechanism.powers(p, &s, &qd, &z, &l));
    let (_, force_q) = counted(|| mechanism.force_q(p, &s, &qd, &z, &l));
    let (_, force_qd) = counted(|| mechanism.force_qd(p, &s, &qd, &z, &l));
    [position, force, powers, force_q, force_qd].map(|operations| operations.total())
}

#[test]
fn an_open_contact_costs_no_operation_in_a_right_hand_side() {
    let (free, crowd) = (Free::<Counted>::default(), Crowd::<Counted>::default());
    let least = costs(&free, false);
    assert_eq!(costs(&crowd, true), least);
    let all = costs(&crowd, false);
    assert!(all.iter().zip(&least).skip(1).all(|(all, least)| *all > least + 10), "{all:?} {least:?}");
}

/// Contacts that are left out add nothing; an evaluated one adds the same power as if all were evaluated.
#[test]
fn a_contact_that_is_left_out_is_an_open_one() {
    let crowd = Crowd::<f64>::default();
    let free = Free::<f64>::default();
    // The ball is below the floor, the rod in the wall, both far apart.
    let (q, qd, l) = ([1.0, 0.2, 0.4, -100.001], [0.7, 0.2, -0.3, 2.0], [0.0; 2]);
    let t = 0.2;
    let mut parameters = crowd.parameters();
    let force = |parameters: &<Crowd<f64> as Mechanism<f64, 4, 2>>::Parameters| {
        let position = crowd.position(parameters, &q, t);
        (crowd.force(parameters, &position, &qd, &[], &l), crowd.powers(parameters, &position, &qd, &[], &l))
    };
    let all = force(&parameters);
    Crowd::<f64>::evaluated_mut(&mut parameters).fill(false);
    let (none, powers) = force(&parameters);
    let own = free.parameters();
    let others = free.force(&own, &free.position(&own, &q, t), &qd, &[], &l);
    assert_eq!((none, &powers[1..]), (others, &[0.0; 3][..]));
    let pushed = 1e6 * 1e-3 * (1.0 - 0.2 * 2.0);
    let touched = ((0.2_f64).hypot(-100.001 - 0.4) - 8.0) * 1e5;
    assert!(all.0[3] - none[3] > pushed && touched > 1e6, "{all:?}");
    for contact in 0..3 {
        let evaluated = Crowd::<f64>::evaluated_mut(&mut parameters);
        evaluated.fill(false);
        evaluated[contact] = true;
        let (one, power) = force(&parameters);
        let mut added = all.1;
        (0..4).filter(|force| *force > 0 && *force != contact + 1).for_each(|force| added[force] = 0.0);
        assert_eq!(power, added, "{contact}");
        if contact == 0 {
            assert!((one[3] - none[3] - pushed).abs() < 1e-6, "{}", one[3] - none[3]);
        }
    }
}

/// A whole run: in addition to the run without contacts, each step has three gaps, their rates and the times by their bounds.
#[test]
fn a_run_with_open_contacts_adds_their_gaps_once_a_step() {
    fn run<S, I>(mechanism: S, integrator: I) -> (u64, u64, u64)
    where
        S: Dynamic<Counted, 4, 2>,
        Explicit<I, Projection>: Method<S, Counted, 4, 2>,
        I: mbs_runtime::dynamics::Embedded,
    {
        let (q, mut qd) = state();
        (qd[1], qd[2]) = (Counted(-0.7 * q[2].0), Counted(0.7 * q[1].0));
        let method = Explicit::new(integrator, Projection::default());
        let mut run = Simulation::start(mechanism, method, Counted(0.0), q, qd).expect("a start");
        let ((), count) = counted(|| run.advance_to(Counted(1.0)).expect("it runs"));
        (count.total(), run.counts().steps, run.counts().evaluations)
    }
    let crowd = || Crowd::<Counted>::default();
    let free = || Free::<Counted>::default();
    let pairs = [
        (run(free(), DormandPrince8), run(crowd(), DormandPrince8)),
        (run(free(), DormandPrince5), run(crowd(), DormandPrince5)),
        (run(free(), Radau5), run(crowd(), Radau5)),
    ];
    for (free, crowd) in pairs {
        assert_eq!((free.1, free.2), (crowd.1, crowd.2));
        // A position with the gaps and rates of the three, 80 operations, and 12 each for the time by the bound.
        let [added, allowed] = [crowd.0 as i64 - free.0 as i64, 150 * crowd.1 as i64];
        assert!(added <= allowed, "{added} {allowed} of {}", free.0);
        println!(
            "{} operations a step for three open contacts, of {}",
            added / crowd.1 as i64,
            free.0 / free.1
        );
    }
}

/// A ball of 3 m/s in steps from a tenth of the contact's 3 ms to nearly twice that. A step does not have the force of a contact
/// that begins within it, and is not judged by the energy of one that does.
#[test]
fn a_contact_found_in_a_fixed_step_ends_it_before_its_energy_is_judged() {
    fn run<X: Method<Roofed<f64>, f64, 1, 0>>(method: X, h: f64) -> Result<(f64, f64), mbs_runtime::Failure> {
        let speed = (9.0_f64 + 2.0 * 9.81 * 1.9).sqrt();
        let mut run = Simulation::start(Roofed::default(), method, 0.0, [0.0], [speed])?;
        let (steps, mut highest) = ((0.5 / h).ceil() as u32, 0.0_f64);
        for _ in 0..steps {
            run.step(h)?;
            highest = highest.max(run.q()[0]);
        }
        Ok((highest, 0.5 * run.qd()[0].powi(2) + 9.81 * run.q()[0]))
    }
    let energy = 0.5 * 9.0 + 9.81 * 1.9;
    for factor in (0..27).step_by(every(3)) {
        let h = 3e-4 * 1.12_f64.powi(factor);
        let results = [
            run(Explicit::new(RungeKutta4, VelocityTransformation), h),
            run(Explicit::new(RungeKutta4, Projection::default()), h),
            run(Explicit::new(SemiImplicitEuler, Projection::default()), h),
            run(Explicit::new(Radau5, Projection::default()), h),
            run(AugmentedLagrangian, h),
            run(GeneralizedAlpha::default(), h),
        ];
        for (method, result) in results.into_iter().enumerate() {
            let (highest, left) = result.unwrap_or_else(|failure| panic!("{h:e} {method}: {failure}"));
            // A method of first order goes on by a whole step before it feels the depth.
            assert!(highest < 1.9031 + 3.1 * h, "{h:e} {method}: {highest}");
            assert!(method == 2 || left < 1.02 * energy, "{h:e} {method}: {left} of {energy}");
        }
    }
}

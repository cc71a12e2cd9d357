//! Assembly of dyads from their formulas: right from any guess, refused at once where they do not close.

use core::cell::Cell;
use core::f64::consts::TAU;

use mbs_runtime::{
    AssemblySolver, Failure, FailureKind, Function, Kinematic, Lanes, Mechanism, Outcome, Scalar, assemble,
    mechanism,
};

mechanism! {
    /// Two bars on a crank.
    pub mechanism Bars;
    param crank: m = 0.1;
    param coupler: m = 0.25;
    param side: 1 = 1;
    coord phi1: rad = 0;
    coord phi2: rad = 0;
    coord phi3: rad = 0;
    constraint closure { crank*unit(phi1) + coupler*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: phi1 == TAU*t/1s;
    branch open: side*sin(phi3 - phi2) > 0;
}

mechanism! {
    /// The same in coordinates of points.
    pub mechanism Points;
    param side: 1 = 1;
    coord a: [m; 2] = [0, 0];
    coord b: [m; 2] = [0, 0];
    constraint crank { a == 0.1m*unit(TAU*t/1s); }
    constraint bars { dot(b - a, b - a) == (0.25m)^2; dot(b - [0.3m, 0], b - [0.3m, 0]) == (0.2m)^2; }
    branch open: side*cross(b - [0.3m, 0], b - a) < 0;
}

mechanism! {
    /// A rod on a slide that is inclined and off the crank's centre.
    pub mechanism Rod;
    param side: 1 = 1;
    coord theta: rad = 0;
    coord phi: rad = 0;
    coord s: m = 0;
    constraint closure { 0.05m*unit(theta) + 0.18m*unit(phi) == s*unit(0.3) + [0, 0.02m]; }
    drive motor: theta == TAU*t/1s;
    branch ahead: side*cos(phi - 0.3) > 0;
}

mechanism! {
    /// A slide that turns about a fixed point, and a single angle behind it.
    pub mechanism Swing;
    param side: 1 = 1;
    coord theta: rad = 0;
    coord psi: rad = 0;
    coord s: m = 0;
    coord chi: rad = 0;
    coord y: m = 0;
    constraint closure { 0.05m*unit(theta) + rot(psi)*[s, 0.01m] == [0.2m, 0]; }
    constraint follower { 0.3*sin(chi) == 0.2*sin(psi) + 0.02; y^2 + 2*y*0.1m == (0.3m)^2*cos(psi)^2; }
    drive motor: theta == TAU*t/1s;
    branch ahead: side*s > 0;
    branch below: side*cos(chi) > 0;
    branch outside: side*y > -0.1m*side;
}

/// Numbers in ±1: SplitMix64 (Steele, Lea, Flood 2014).
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Largest number of evaluations: one more than steps, which rounding alone makes necessary. From the far guess an
/// angle is known to 1e-13 only, which costs no step more.
const POLISH: u32 = 3;

/// Assembles from 2000 guesses up to `far` away, both sides in turn; all must succeed from the guess itself.
fn assembles<S: Kinematic<f64, N> + Default, const N: usize>(far: f64) {
    let mut number = numbers();
    let side = S::variable("side").unwrap();
    let mut most = 0;
    for k in 0..2000 {
        let mut mechanism = S::default();
        mechanism.set(side, if k % 2 == 0 { 1.0 } else { -1.0 });
        let guess = [(); N].map(|()| far * number());
        let t = number();
        let assembled = assemble(&mechanism, guess, t).unwrap_or_else(|failure| panic!("{k}: {failure}"));
        assert_eq!((assembled.start, assembled.statistics.fallback), (0, false), "{k}");
        most = most.max(assembled.statistics.evaluations);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &assembled.q, t);
        assert!(mechanism.branches(&parameters, &position).as_ref().iter().all(|value| *value > 0.0));
        for ((q, guess), entry) in assembled.q.iter().zip(&guess).zip(S::COORDINATES) {
            let driven =
                S::ROWS.iter().any(|row| row.name == "motor") && entry.name == S::COORDINATES[0].name;
            assert!(driven || !entry.is_angle() || (q - guess).abs() < TAU / 2.0 + 1e-9, "{}", entry.name);
        }
    }
    assert!(most <= POLISH, "{most} evaluations");
}

#[test]
fn a_declared_branch_is_assembled_from_any_guess() {
    for far in [1.0, 10.0, 1000.0] {
        assembles::<Bars, 3>(far);
        assembles::<Points, 4>(far);
        assembles::<Rod, 3>(far);
        assembles::<Swing, 5>(far);
    }
}

mechanism! {
    /// Two bars without a declared branch.
    pub mechanism Free;
    param coupler: m = 0.25;
    param ground: m = 0.2;
    coord phi2: rad = 0;
    coord phi3: rad = 0;
    constraint closure { coupler*unit(phi2) == [ground, 0] + 0.2m*unit(phi3); }
}

#[test]
fn without_a_branch_the_root_nearest_the_guess_is_taken() {
    let mut number = numbers();
    for _ in 0..500 {
        let guess = [3.0 * number(), 3.0 * number()];
        let q = assemble(&Free::<f64>::default(), guess, 0.0).unwrap().q;
        // The mirror image, with its angles next to the guess.
        let near = |angle: f64, guess: f64| guess + (angle - guess).sin().atan2((angle - guess).cos());
        let distance = |q: [f64; 2]| (q[0] - guess[0]).hypot(q[1] - guess[1]);
        let mirror = [near(-q[0], guess[0]), near(-q[1], guess[1])];
        assert!(distance(q) <= distance(mirror) + 1e-12, "{guess:?}");
    }
}

#[test]
fn bars_that_do_not_reach_are_refused_without_a_search() {
    let apart = Bars::<f64> { crank: 1.0, ..Bars::default() };
    for guess in [[0.0; 3], [500.0, -300.0, 900.0]] {
        let parameters = apart.parameters();
        let mut solver = AssemblySolver::new(1.0);
        let mut q = guess;
        let outcome = apart.solve_blocks(&parameters, &mut q, 0.0, &mut solver);
        assert!(matches!(outcome, [Outcome::NotConverged { .. }]));
        let diagnosis = solver.diagnosis();
        assert!(!diagnosis.fallback && diagnosis.evaluations < 20, "{}", diagnosis.evaluations);
        // Crank and ground leave 0.7 m, the bars reach 0.45 m.
        let open = apart.phi(&parameters, &apart.position(&parameters, &q, 0.0));
        assert!((open[0].hypot(open[1]) - 0.25).abs() < 1e-9, "{open:?}");
        assert!(matches!(
            assemble(&apart, guess, 0.0),
            Err(Failure { kind: FailureKind::NotAssemblable { .. }, .. })
        ));
    }
}

mechanism! {
    /// Two bars on a crank, and two more on what they carry.
    pub mechanism Chained;
    param crank: m = 0.1;
    param last: m = 0.25;
    function law: rad(s), C2;
    coord phi: [rad; 3] = [0, 0, 0];
    coord psi: [rad; 2] = [0, 0];
    constraint first { crank*unit(phi[0]) + 0.25m*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
    constraint second { 0.2m*unit(phi[2]) + last*unit(psi[0]) == [0.2m, 0] + 0.25m*unit(psi[1]); }
    drive motor: phi[0] == law(t);
}

thread_local! {
    static ASKED: Cell<u32> = const { Cell::new(0) };
}

/// Counts how often a motion is asked for: once a start, and in reports.
#[derive(Clone, Copy, Debug)]
struct Asked;

impl Function<f64> for Asked {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        ASKED.set(ASKED.get() + 1);
        core::array::from_fn(|order| if order == 0 { x } else { 0.0 })
    }
}

#[test]
fn pivots_that_drives_hold_apart_are_refused_from_the_first_start_and_others_are_not() {
    let asked = |chained: Chained<Asked>| {
        ASKED.set(0);
        let failure = assemble(&chained, [0.0; 5], 1.0);
        assert!(
            matches!(failure, Err(Failure { kind: FailureKind::NotAssemblable { .. }, .. })),
            "{failure:?}"
        );
        ASKED.get()
    };
    let first = asked(Chained { crank: 1.0, ..Chained::new(Asked) });
    // Where the pivots stand depends on a position that another start might find in its other assembly.
    let second = asked(Chained { last: 2.0, ..Chained::new(Asked) });
    assert!(first <= 3 && second >= 9, "{first} {second}");
}

#[test]
fn bars_in_line_are_assembled() {
    let line = Free::<f64> { coupler: 0.4, ..Free::default() };
    let q = assemble(&line, [0.3, 0.4], 0.0).unwrap().q;
    // A double root: half the digits.
    assert!(q[0].abs() < 1e-6 && q[1].abs() < 1e-6, "{q:?}");
}

#[test]
fn a_formula_without_value_falls_back_to_the_search() {
    // Both pivots in one point and equal bars: any angle closes.
    let mechanism = Free::<f64> { coupler: 0.2, ground: 0.0 };
    let assembled = assemble(&mechanism, [0.4, 0.3], 0.0).unwrap();
    assert!(assembled.statistics.fallback && (assembled.q[0] - assembled.q[1]).abs() < 1e-12);
}

#[test]
fn lanes_are_assembled_from_their_own_roots() {
    type Three = Lanes<f64, 3>;
    let mechanism = Bars::<Three> {
        side: Lanes([1.0, -1.0, 1.0]),
        crank: Lanes([0.1, 0.1, 1.0]),
        ..Bars::<Three>::default()
    };
    let parameters = mechanism.parameters();
    let mut solver = AssemblySolver::new(Three::constant(1.0));
    let mut q = [Lanes([0.0; 3]), Lanes([5.0, -7.0, 0.1]), Lanes([-9.0, 0.2, 0.3])];
    let outcome = mechanism.solve_blocks(&parameters, &mut q, Three::constant(0.1), &mut solver);
    assert!(matches!(outcome, [Outcome::Converged, Outcome::Converged, Outcome::NotConverged { .. }]));
    for lane in 0..2 {
        let single = mechanism.lane(lane);
        let guess = [[0.0; 2], [5.0, -7.0], [-9.0, 0.2]].map(|angles| angles[lane]);
        let expected = assemble(&single, guess, 0.1).unwrap().q;
        for (found, expected) in q.iter().zip(expected) {
            assert!((found.0[lane] - expected).abs() < 1e-12);
        }
    }
}

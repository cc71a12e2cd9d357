//! Factors of M and all rows without their zeros: they solve the dense system, and are left where they are of no use.

use mbs_runtime::dynamics::{
    Baumgarte, DormandPrince8, Explicit, Formulation, Projection, Simulation, Tolerance,
    VelocityTransformation,
};
use mbs_runtime::{Dynamic, Lanes, Mechanism, Partitioned, mechanism};

mechanism! {
    /// Points on links.
    pub mechanism Chain;
    const N: 1 = 24;
    param light: kg = 1;
    coord P: [m; N, 2];
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..11 { body near { mass: 1, com: P[i] } }
    body middle { mass: light, com: P[11] }
    for i in 12..N { body far { mass: 1, com: P[i] } }
    for i in 0..N { start P[i] = [(i + 1)*0.1m, 0] rate [0, 0]; }
    constraint first { dot(P[0], P[0]) == (0.1m)^2; }
    for i in 1..N { constraint links { dot(P[i] - P[i - 1], P[i] - P[i - 1]) == (0.1m)^2; } }
}

mechanism! {
    /// A ring of bodies in reference-point coordinates, one held by a pin; each is a rod of 0.2 m with a mass beside its middle.
    pub mechanism Ring;
    const N: 1 = 24;
    coord P: [m; N, 2];
    coord a: [rad; N];
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..N {
        body rod { mass: 1, inertia: 0.01, com: P[i] + [0.02m*cos(a[i]), 0.02m*sin(a[i])], angle: a[i] }
        start P[i] = [cos(TAU*(i + 0.5)/N)*0.8m, sin(TAU*(i + 0.5)/N)*0.8m] rate [0, 0];
        start a[i] = TAU*(i + 0.5)/N + TAU/4 rate 0;
    }
    constraint pin { P[0] - 0.1m*unit(a[0]) == [0.8m, 0]; }
    for i in 1..N { constraint joints { P[i] - 0.1m*unit(a[i]) == P[i - 1] + 0.1m*unit(a[i - 1]); } }
}

mechanism! {
    /// Rods in space between points, which share their masses.
    pub mechanism Rods;
    const N: 1 = 18;
    coord P: [m; N, 3];
    gravity weight { acceleration: [0, 0, -9.81] }
    for i in 0..N {
        body point { mass: 0.5, com: P[i] }
        start P[i] = [0.3m*i + 0.3m, 0.02m*i*i, 0] rate [0, 0.1, 0.2];
    }
    for i in 1..N { body rod { mass: 1, com: 0.5*(P[i] + P[i - 1]) } }
    constraint first { dot(P[0], P[0]) == (0.3m)^2; }
    for i in 1..N { constraint links { dot(P[i] - P[i - 1], P[i] - P[i - 1]) == (0.3m)^2; } }
}

/// Margin of the sparse factors at a position, and the residuals of their solution in the dense system, over the largest terms.
fn residuals<S, const N: usize, const M: usize>(mechanism: &S, q: &[f64; N]) -> [f64; 3]
where
    S: Dynamic<f64, N, M>,
{
    const { assert!(S::IS_SPARSE) };
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, q, 0.0);
    let (partition, _) = mechanism.partition(&parameters, &position);
    let force: [f64; N] = std::array::from_fn(|i| (1.7 * i as f64).sin());
    let gamma: [f64; M] = std::array::from_fn(|i| (2.3 * i as f64).cos());
    let solved = mechanism.accelerations(&parameters, &position, &partition, &force, &gamma);
    assert!(solved.inert);
    let (mass, phi_q) = (mechanism.mass(&parameters, &position), mechanism.phi_q(&parameters, &position));
    let mut open = [0.0_f64; 2];
    for (i, (row, force)) in mass.iter().zip(&force).enumerate() {
        let inertia = row.iter().zip(&solved.qdd).map(|(a, b)| a * b);
        let reactions = phi_q.iter().zip(&solved.lambda).map(|(row, lambda)| row[i] * lambda);
        let terms: Vec<f64> = inertia.chain(reactions).chain([-force]).collect();
        let size = terms.iter().fold(0.0, |size: f64, term| size.max(term.abs()));
        open[0] = open[0].max(terms.iter().sum::<f64>().abs() / size);
    }
    for (row, gamma) in phi_q.iter().zip(&gamma) {
        let terms: Vec<f64> = row.iter().zip(&solved.qdd).map(|(a, b)| a * b).chain([-gamma]).collect();
        let size = terms.iter().fold(0.0, |size: f64, term| size.max(term.abs()));
        open[1] = open[1].max(terms.iter().sum::<f64>().abs() / size);
    }
    let margin = S::margin_of_rows(&partition);
    println!("margin {margin:.3}, residuals {:.1e} and {:.1e}", open[0], open[1]);
    [margin, open[0], open[1]]
}

/// Largest residual: some hundred roundings.
const RESIDUAL: f64 = 1e-12;

#[test]
fn they_solve_the_dense_system() {
    let chain = Chain::<f64>::default();
    let curled: [f64; 48] = std::array::from_fn(|i| {
        let sum = |part: fn(f64) -> f64| (0..=i / 2).map(|k| 0.1 * part(0.37 * k as f64)).sum::<f64>();
        if i % 2 == 0 { sum(f64::cos) } else { sum(f64::sin) }
    });
    let ring = Ring::<f64>::default();
    let rods = Rods::<f64>::default();
    for [margin, inertia, rows] in [
        residuals(&chain, &chain.guess(&chain.parameters())),
        residuals(&chain, &curled),
        residuals(&ring, &ring.guess(&ring.parameters())),
        residuals(&rods, &rods.guess(&rods.parameters())),
    ] {
        assert!(0.05 < margin && margin <= 1.0, "{margin}");
        assert!(inertia < RESIDUAL && rows < RESIDUAL, "{inertia} {rows}");
    }
}

#[test]
fn lanes_are_solved_as_single_numbers() {
    type Four = Lanes<f64, 4>;
    let one = Ring::<f64>::default();
    let four = Ring::<Four>::default();
    let parameters = four.parameters();
    let start = one.guess(&one.parameters());
    let shaken = |lane: usize| -> [f64; 72] {
        std::array::from_fn(|i| start[i] + 0.01 * ((i * (lane + 1)) as f64).sin())
    };
    let q: [Four; 72] = std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| shaken(lane)[i])));
    let position = four.position(&parameters, &q, Lanes([0.0; 4]));
    let (partition, _) = four.partition(&parameters, &position);
    let (force, gamma) = ([Lanes([1.0; 4]); 72], [Lanes([0.5; 4]); 48]);
    let solved = four.accelerations(&parameters, &position, &partition, &force, &gamma);
    for lane in 0..4 {
        let parameters = one.parameters();
        let position = one.position(&parameters, &shaken(lane), 0.0);
        let (partition, _) = one.partition(&parameters, &position);
        let single = one.accelerations(&parameters, &position, &partition, &[1.0; 72], &[0.5; 48]);
        assert_eq!(solved.qdd.map(|x| x.0[lane]), single.qdd);
        assert_eq!(solved.lambda.map(|x| x.0[lane]), single.lambda);
    }
}

/// A run of the chain.
type Run<F> = Simulation<Chain<f64>, Explicit<DormandPrince8, F>, f64, 48, 24>;

/// Result of `see` of a run of the chain at `end` (s).
fn fallen<F, X>(chain: Chain<f64>, formulation: F, end: f64, see: fn(&Run<F>) -> X) -> X
where
    F: Formulation<Chain<f64>, f64, 48, 24> + Send + 'static,
    X: Send + 'static,
{
    // Dense matrices of a start are large where nothing is optimised.
    let moved = move || {
        let method = Explicit::new(DormandPrince8, formulation);
        let mut run = Simulation::start_from_text(chain, method, 0.0)
            .expect("a start")
            .with_tolerance(Tolerance::new(1e-11));
        run.advance_to(end).expect("a motion");
        see(&run)
    };
    let thread = std::thread::Builder::new().stack_size(1 << 26).spawn(moved).expect("a thread");
    thread.join().expect("no panic")
}

#[test]
fn a_point_without_much_mass_is_left_to_all_rows_together() {
    let light = Chain { light: 1e-6 };
    let [margin, ..] = residuals(&light, &light.guess(&light.parameters()));
    // Both links of the light point are in line: M⁻¹ makes their rows alike.
    assert!(margin < 1e-2, "{margin}");
    let (qdd, rechosen) =
        fallen(light, Projection::default(), 0.0, |run| (*run.qdd(), run.counts().rechosen));
    assert!(rechosen > 0);
    // From rest at level no link is loaded: each point falls.
    for [x, y] in qdd.as_chunks::<2>().0 {
        assert!(x.abs() < 1e-8 && (y + 9.81).abs() < 1e-8, "{x} {y}");
    }
}

#[test]
fn formulations_agree_on_them() {
    let (projected, rechosen) =
        fallen(Chain::default(), Projection::default(), 0.3, |run| (*run.q(), run.counts().rechosen));
    assert_eq!(rechosen, 0);
    let transformed = fallen(Chain::default(), VelocityTransformation, 0.3, |run| *run.q());
    let stabilised = fallen(Chain::default(), Baumgarte::default(), 0.3, |run| *run.q());
    for (a, (b, c)) in projected.iter().zip(transformed.iter().zip(&stabilised)) {
        assert!((a - b).abs() < 1e-9 && (a - c).abs() < 1e-7, "{a} {b} {c}");
    }
}

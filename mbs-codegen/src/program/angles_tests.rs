use super::*;
use crate::diagnostics::Diagnostics;
use crate::model::scenes::Scenes;
use crate::program::Program;
use crate::symbolic::{Leaf, evaluate::evaluate};

/// The equations before and after, and the program.
fn shared(text: &str) -> (Equations, Equations, Program) {
    let mut diagnostics = Diagnostics::default();
    let text = crate::syntax::read(text.parse().unwrap(), &mut diagnostics).unwrap();
    let scenes = Scenes::resolve(&text, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{}", diagnostics.to_text());
    let model = &scenes.scenes[0].model;
    let plain = crate::equations::derive(model);
    let mut equations = crate::equations::derive(model);
    let mut structure = crate::structure::analyse(model, &mut equations, &mut diagnostics).unwrap();
    share_angles(&mut equations, &mut structure);
    let program = crate::program::order(&equations, &structure);
    (plain, equations, program)
}

fn sine_cosines(program: &Program) -> [usize; 3] {
    let sections = [&program.position.section, &program.branches, &program.outputs];
    sections.map(|section| section.operations.sine_cosines)
}

#[test]
fn a_difference_and_an_offset_come_from_the_angles_of_the_rows() {
    let text = "pub mechanism FourBar; param alpha: rad = 0.4; coord x: m; coord phi1: rad; coord phi2: rad = 0.9;
        coord phi3: rad = 1.8; drive crank: phi1 == 10*t/1s; constraint point { x == 0.15m*cos(alpha + phi2); }
        constraint closure { 0.1m*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
        branch open: sin(phi3 - phi2) > 0;";
    let (_, _, program) = shared(text);
    assert_eq!(sine_cosines(&program), [3, 0, 0]);
    assert_eq!(program.parameters.section.operations.sine_cosines, 1);
}

#[test]
fn a_part_that_only_a_branch_needs_comes_from_the_sum() {
    let text = "pub mechanism Loop; coord psi1: rad; coord psi2: rad = 0.9; coord psi3: rad = -2;
        drive crank: psi1 == 10*t/1s; branch open: sin(psi2) > 0;
        constraint closure { 0.1m*unit(psi1) + 0.3m*unit(psi1 + psi2) == [0.2m, 0] + 0.2m*unit(psi3); }";
    let (_, _, program) = shared(text);
    assert_eq!(sine_cosines(&program), [3, 0, 0]);
}

#[test]
fn offsets_of_one_angle_share_its_sine() {
    let text =
        "pub mechanism Plate; coord phi: rad; coord p: [m; 2]; coord q: [m; 2]; drive turn: phi == 10*t/1s;
        constraint points { p == 0.1m*unit(phi + 90deg); q == 0.1m*unit(210deg - phi); }";
    let (_, _, program) = shared(text);
    assert_eq!(sine_cosines(&program), [1, 0, 0]);
}

#[test]
fn a_sum_whose_part_is_not_at_hand_keeps_its_sine() {
    let text = "pub mechanism Arm; coord theta: [rad; 2]; coord p: [m; 2];
        drive first: theta[0] == 10*t/1s; drive second: theta[1] == 20*t/1s;
        constraint tip { p == 0.1m*unit(theta[0]) + 0.1m*unit(theta[0] + theta[1]); }
        out height: 1 = sin(theta[1]) + sin(theta[1] - 2*theta[0]);";
    let (_, _, program) = shared(text);
    // The output's first sine comes from the sum; twice an angle is known nowhere.
    assert_eq!(sine_cosines(&program), [2, 0, 1]);
}

/// Bound of [`ACCEPTED`], and half an ε for the sine that it is compared with.
const BOUND: f64 = (ACCEPTED as f64 + 1.0) * f64::EPSILON / 2.0;

#[test]
fn errors_of_a_chain_of_sums_stay_within_their_bound() {
    let text =
        "pub mechanism Chain; const N: 1 = 12; coord theta: [rad; N]; coord p: [1; N]; coord s: [1; N];
        for i in 0..N {
            drive motor: theta[i] == (i + 1)*t/1s;
            constraint single { p[i] == sin(theta[i]); }
            constraint sums { s[i] == cos(sum(k in 0..i + 1: theta[k])); }
        }";
    let (plain, equations, program) = shared(text);
    // Every third of the eleven sums beyond the first angle is computed from its angle again.
    assert_eq!(sine_cosines(&program), [12 + 3, 0, 0]);
    for sample in 0..200_u32 {
        // Numbers of few digits, so that their sums are exact and only sines, cosines and theorems err.
        let leaf = |leaf| match leaf {
            Leaf::Position(index) => {
                f64::from((index + 1).wrapping_mul(0x9E37 + 77 * sample) % 0x4000) / 4096.0
            }
            _ => 0.0,
        };
        let phi = |equations: &Equations| {
            let roots: Vec<NodeId> = equations.rows.iter().map(|row| row.phi).collect();
            evaluate(&equations.graph, &roots, leaf)
        };
        let rounding = f64::EPSILON * 4.0;
        for (found, expected) in phi(&equations).into_iter().zip(phi(&plain)) {
            assert!((found - expected).abs() <= BOUND + rounding, "{found} {expected}");
        }
    }
}

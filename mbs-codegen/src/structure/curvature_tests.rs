//! Second derivatives of circles and lines against second differences of their rows.

use super::*;
use crate::structure::analysed::analysed;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::sample_points::scattered;

/// Step of the differences.
const H: f64 = 1e-3;

/// Largest difference: h² of the fourth derivative, and roundings over h².
const DIFFERENCE: f64 = 1e-6;

/// Number of dyads of circles and lines, their curvatures checked.
fn checked(statements: &str) -> usize {
    let text = format!("mechanism M; param r: m = 0.1; param l: m = 0.3;\n{statements}");
    let (equations, structure) = analysed(&text);
    let mut found = 0;
    for block in &structure.blocks {
        let Some(curvature) = &block.curvature else { continue };
        let step = |index: usize| if index == block.coordinates[0] { 0.8 } else { -0.6 };
        let moved = |leaf: Leaf, part: f64| match leaf {
            Leaf::Position(index) if block.coordinates.contains(&(index as usize)) => {
                scattered(leaf, 0) + part * step(index as usize)
            }
            leaf => scattered(leaf, 0),
        };
        let phi: Vec<NodeId> = block.rows.iter().map(|row| equations.rows[*row].phi).collect();
        let [before, here, after] =
            [-H, 0.0, H].map(|part| evaluate(&equations.graph, &phi, |leaf| moved(leaf, part)));
        for (row, node) in curvature.iter().enumerate() {
            // |s| is 1, and so is what the factor of circles is multiplied by.
            let derived =
                node.map_or(0.0, |node| evaluate(&equations.graph, &[node], |leaf| moved(leaf, 0.0))[0]);
            let difference = (after[row] - 2.0 * here[row] + before[row]) / (H * H);
            assert!((derived - difference).abs() < DIFFERENCE, "{statements}: {derived} for {difference}");
        }
        found += 1;
    }
    found
}

const CRANK: &str = "coord phi: rad = 0; drive crank: phi == 1*t/1s;\n";

#[test]
fn curvatures_of_dyads_are_second_differences() {
    let point = "coord p: [m; 2] = [0.1, 0.2]; let d = p - r*unit(phi); let o = p - [l, 0];\n";
    for rows in ["3*dot(d, d) == 3*l^2; dot(o, o) == r^2;", "r^2 == dot(o, o); cross(d, unit(phi)) == 0;"] {
        assert_eq!(checked(&format!("{CRANK}{point}constraint c {{ {rows} }}")), 1, "{rows}");
    }
}

#[test]
fn other_blocks_have_none() {
    let single = "coord a: rad = 1; coord s: m = 0.2; constraint c { r*unit(phi) + l*unit(a) == [s, 0]; }";
    assert_eq!(checked(&format!("{CRANK}{single}")), 0);
    let other = "coord a: rad = 1; coord b: rad = 2; constraint c { r*cos(a)*cos(b) == r*phi; r*sin(a) + l*sin(b) == r; }";
    assert_eq!(checked(&format!("{CRANK}{other}")), 0);
}

//! The reference length: lengths that the geometry of the text uses; where it uses none, those of guesses and laws of forces.

use super::dynamics::{Action, Dynamics, Rotation};
use super::expression::{Id, Length, Node};
use super::units::Dimension;
use super::{Model, VariableKind};

impl Model {
    /// Before: all expressions. After: the lengths that determine the reference length.
    ///
    /// Rows and places of bodies, forces and pins count, an area by its root. Guesses and starts count in addition where rows have
    /// lengths of another origin: of an input, a function or a speed. They count with the laws of forces where nothing else is a length:
    /// either may be far off the size of the mechanism. Bounds, widths, outputs and defaults never count.
    pub(super) fn settle_reference_length(&mut self) {
        let rows = self.rows.iter().map(|row| row.residual);
        let in_rows = self.expressions.reachable(rows.clone());
        let is_open = self
            .expressions
            .iter()
            .filter(|(id, _)| in_rows.get(id.index()) == Some(&true))
            .any(|(id, node)| self.brings_length(node) || self.expressions.is_rate_of_length(id));
        let guesses: Vec<Id> = self.coordinates.iter().filter_map(|coordinate| coordinate.guess).collect();
        let [places, laws] = self.dynamics.as_ref().map(of_dynamics).unwrap_or_default();
        let mut roots: Vec<Id> = rows.chain(places).collect();
        let (longest, parameters) = self.lengths_of(&roots);
        let is_sized = longest.is_some() || !parameters.is_empty();
        if is_open || !is_sized {
            roots.extend(&guesses);
        }
        if !is_sized {
            roots.extend(laws);
        }
        (self.longest, self.lengths) = self.lengths_of(&roots);
        (self.longest_guess, _) = self.lengths_of(&guesses);
    }

    /// The largest length among the numbers that `roots` are made of, and the indices of the parameters that are lengths.
    fn lengths_of(&self, roots: &[Id]) -> (Option<Length>, Vec<usize>) {
        let reached = self.expressions.reachable(roots.iter().copied());
        let parameters = self.expressions.iter().filter_map(|(id, node)| match node {
            Node::Variable(index) if reached.get(id.index()) == Some(&true) => Some(index),
            _ => None,
        });
        let is_length = |index: &usize| {
            self.variables.get(*index).is_some_and(|variable| {
                variable.kind == VariableKind::Parameter && variable.dimension == Dimension::METRE
            })
        };
        (self.expressions.longest(&reached), parameters.filter(is_length).collect())
    }

    /// `true` if a node brings a length whose size the text does not give: a variable or a call of a declared function.
    fn brings_length(&self, node: Node) -> bool {
        match node {
            Node::Variable(index) => self.variables.get(index).is_some_and(|variable| {
                let is_length = variable.dimension == Dimension::METRE;
                variable.dimension.metres() != 0.0 && (!is_length || variable.kind != VariableKind::Parameter)
            }),
            Node::Call { function, .. } => self.functions.get(function).is_some_and(|function| {
                function.dimensions.iter().flatten().any(|dimension| dimension.metres() != 0.0)
            }),
            _ => false,
        }
    }

    /// `true` if some coordinate or row is measured by the reference length.
    pub fn is_measured_by_length(&self) -> bool {
        let rows = self.rows.iter().map(|row| row.dimension);
        self.coordinates.iter().map(|c| c.dimension).chain(rows).any(|dimension| dimension.metres() != 0.0)
    }
}

/// Places of bodies, forces and pins; then masses and laws of forces, of energies and of states.
fn of_dynamics(dynamics: &Dynamics) -> [Vec<Id>; 2] {
    let mut places: Vec<Id> = dynamics.pins.iter().flat_map(|pin| pin.at.clone()).collect();
    let mut laws: Vec<Id> = dynamics.potentials.clone();
    laws.extend(dynamics.kinetics.iter().map(|kinetic| kinetic.value));
    laws.extend(dynamics.states.iter().flat_map(|state| [state.start, state.rate]).flatten());
    for body in &dynamics.bodies {
        places.extend(&body.com);
        laws.push(body.mass);
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { inertia, angle }) => {
                places.push(*angle);
                laws.push(*inertia);
            }
            Some(Rotation::Space { inertia, orientation }) => {
                places.extend(orientation);
                laws.extend(inertia.iter().map(|(.., entry)| *entry));
            }
        }
    }
    for force in &dynamics.forces {
        match &force.action {
            Action::Work(pairs) => {
                places.extend(pairs.iter().map(|(_, displacement)| *displacement));
                laws.extend(pairs.iter().map(|(value, _)| *value));
            }
            Action::Dissipation(value) => laws.push(*value),
            Action::Line(line) => {
                places.extend(line.from.iter().chain(&line.to));
                laws.extend([line.stiffness, line.length, line.damping, line.actuator].into_iter().flatten());
            }
            Action::Turn(turn) => {
                places.push(turn.angle);
                laws.extend([turn.stiffness, turn.rest, turn.damping, turn.torque].into_iter().flatten());
            }
        }
    }
    [places, laws]
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::Diagnostics;
    use crate::model::scenes::read_source;

    /// The reference length of a text, parameters at their defaults, as emitted code computes it.
    fn reference(text: &str) -> f64 {
        let mut faults = Diagnostics::default();
        let read = read_source(&format!("mechanism Text; {text}"), &mut faults);
        let (_, scenes) = read.expect("a text that can be read");
        let scene = scenes.find(None).expect("the whole text");
        assert!(faults.is_empty() && scene.faults.is_empty(), "{}{text}", faults.to_text());
        let model = &scene.model;
        let fixed = model.longest.as_ref().map_or(0.0, |longest| longest.length);
        let default = |index: &usize| model.variables[*index].default.abs();
        match model.lengths.iter().map(default).fold(fixed, f64::max) {
            0.0 => model.longest_guess.as_ref().map_or(1.0, |guess| guess.length),
            length => length,
        }
    }

    /// A slider-crank of a few decimetres.
    const CRANK: &str = "param r: m = 0.1; const l: m = 300mm;
        coord phi: rad = 0.4; coord psi: rad; coord x: m = 0.38; let A = r*unit(phi);
        body rod { mass: 1, inertia: 0.01, com: A + l/2*unit(psi), angle: psi }
        body piston { mass: 2, com: [x, 0] }
        constraint closure { A + l*unit(psi) == [x, 0]; }";
    /// Rods in natural coordinates whose lengths are numbers of the rows.
    const RODS: &str = "coord a: [m; 2] = [0, 0.1]; coord x: m = 0.28;
        body joint { mass: 1, com: a } body end { mass: 1, com: [x, 0] }
        constraint rods { norm(a) == 100mm; dot(a - [x, 0], a - [x, 0]) == (0.3m)^2; }";
    /// A body that lies in a row by an area, which a constant gives.
    const AREA: &str = "const side: m = 0.3; const area: m^2 = side^2;
        coord x: m = 0.3; coord y: m = 0; body point { mass: 1, com: [x, y] }
        constraint circle { x^2 + y^2 == area; }";
    /// A ball without rows: its places have no lengths.
    const BALL: &str = "coord x: m = 0.3; coord y: m = 0; body ball { mass: 1, com: [x, y] }";

    /// Statements that show no size of the mechanism, small and large.
    const OTHERS: [&str; 24] = [
        "tsda s { from: [0, 0], to: [x, 0], stiffness: 2N/1mm, damping: 3 [N*s]/1um }",
        "let k: N/m = 2N/1um; tsda s { from: [0, 0], to: [x, 0], stiffness: k }",
        "const k: N/m = 2N/1km; tsda s { from: [0, 0], to: [x, 0], stiffness: k }",
        "param k: N/m = 2N/1km; tsda s { from: [0, 0], to: [x, 0], stiffness: k }",
        "const most: m = 1e9; limit range: -most <= x <= most;",
        "param most: m = 1e9; limit range: -1mm <= x <= most;",
        "let most = 1km; limit range: -most <= x <= 2*most;",
        "param scale: m = 1e4; let most = 3*scale; limit range: -most <= x <= most;",
        "let far = 1km; branch ahead: x > -far;",
        "param far: m = 1e4; branch ahead: x > -far;",
        "contact stop { gap: x, stiffness: 1e5, exponent: 1.5, depth: 1e-5m }",
        "param depth: m = 1e-5; contact stop { gap: x, stiffness: 1e5, exponent: 1.5, depth: depth }",
        "contact stop { gap: x, stiffness: 2N/1um, damping: 1s/1mm, bound: 1km/(1s)^2 }",
        "friction rub { along: x, normal: 1, coefficient: 0.1, speed: 1km/1s }",
        "const volume: m^3 = (1mm)^3; force gas: 1e5 [N/m^2]*volume/(1mm + abs(x)) on x;",
        "param dead: m = 1e-6; force gas: 1e-3 [N*m]/(dead + abs(x)) on x;",
        "potential pull = 2N/1mm*x^2/2;",
        "gravity weight { acceleration: [0, -1km/(1s)^2] }",
        "let away = [x, 0] + [1km, 2km]; out point: [m; 2] = away;",
        "param arm: m = 1e4; out point: m = x + arm;",
        "const unused: m = 1e6; param spare: m = 1e-9;",
        "const long: m = 1e6; param share: 1 = long/1e3m; potential turn = 1 [N/m]*share*x^2;",
        "state z: N = 0; der(z) == (1mm - x)*1 [N/(m*s)]; force control: z on x;",
        "start x = 0.3 rate 1km/1s;",
    ];

    #[test]
    fn coordinates_without_a_size_leave_the_reference_length() {
        for (text, expected) in [(CRANK, 0.3), (RODS, 0.3), (AREA, 0.3), (BALL, 0.3)] {
            let x = if text == CRANK { 0.38 } else { expected };
            assert_eq!(reference(text), expected, "{text}");
            for other in OTHERS {
                let found = reference(&format!("{text} {}", other.replace("0.3 rate", &format!("{x} rate"))));
                assert_eq!(found, expected, "{text} {other}");
            }
        }
    }

    #[test]
    fn an_area_counts_by_its_side_and_a_speed_lets_guesses_count() {
        let small = "param g: m = 1e-5; coord x: m = 0.1;";
        for four in ["4 [m^2]", "(2m)^2", "0.5 [m]*8m", "side", "4e6 [mm^2]"] {
            let text = format!(
                "const side: m^2 = 4; {small} constraint c {{ x^2 == {four}*sin(t/1s)^2 + g^2; }} branch one: x > 0;"
            );
            let expected = if four.contains('*') { 8.0 } else { 2.0 };
            assert!((reference(&text) - expected).abs() < 1e-12, "{text}");
        }
        assert!((reference("coord x: m = 1; constraint c { x^3 == 8e-9 [m^3]; }") - 2e-3).abs() < 1e-15);
        for speed in ["4 [m/s]*t", "4m/1s*t", "8 [m]/2s*t", "speed*t"] {
            let text = format!("const speed: m/s = 4; {small} constraint c {{ x == {speed} + g; }}");
            assert_eq!(reference(&text), 0.1, "{text}");
        }
    }

    #[test]
    fn laws_show_the_size_where_the_geometry_does_not() {
        let spring = "tsda s { from: [0, 0], to: [x, 0], stiffness: 1, length: 2m }";
        assert_eq!(reference(&format!("{BALL} {spring}")), 2.0);
        assert_eq!(reference(&format!("{RODS} {spring}")), 0.3);
        // A place of bodies and springs is geometry, with a unit or without one.
        for end in ["[-2, 0]", "[-2m, 0]", "[-d, 0]", "[-d, 0] + 0*[x, 0]"] {
            let text = format!("param d: m = 2; {BALL} tsda s {{ from: {end}, to: [x, 0], stiffness: 1 }}");
            assert_eq!(reference(&text), 2.0, "{text}");
        }
        assert_eq!(reference("coord x: m = 0; body ball { mass: 1, com: [x, 0] }"), 1.0);
    }

    #[test]
    fn a_parameter_counts_by_its_value_and_not_by_its_default() {
        let text = "param r: m = 300mm; coord x: m = 1; constraint place { x == r; }";
        let mut faults = Diagnostics::default();
        let (_, scenes) = read_source(&format!("mechanism Text; {text}"), &mut faults).expect("a text");
        let model = &scenes.find(None).expect("the whole text").model;
        assert!(model.longest.is_none() && model.lengths == [0]);
    }
}

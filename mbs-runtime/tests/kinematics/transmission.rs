//! Margins of constraints and ratios of transmission as outputs.

use mbs_runtime::{Lanes, Mechanism, Scalar, Stepper, mechanism};

mechanism! {
    /// Two loops behind each other, a second drive, a slide that follows a coupler point.
    pub mechanism Train;
    param omega: rad/s = 2;
    coord phi: [rad; 3] = [0.3, 0.9, 1.8];
    coord psi: [rad; 2] = [0.5, 1.5];
    coord x: m = 0.1;
    coord s: m = 0;
    constraint first { 0.1m*unit(phi[0]) + 0.25m*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
    constraint second { 0.2m*unit(phi[2]) + 0.3m*unit(psi[0]) == [0.1m, 0.05m] + 0.3m*unit(psi[1]); }
    constraint slide { x == 0.1m*cos(phi[0]) + 0.4m*cos(phi[1]) + s; }
    drive crank: omega*t + 0.3 == phi[0];
    drive push: s == 0.01m*sin(3*t/1s);
    branch one: sin(phi[2] - phi[1]) > 0;
    branch two: sin(psi[1] - psi[0]) > 0;
    out first_margin: 1 = margin(first);
    out second_margin: 1 = margin(second);
    out slide_margin: 1 = margin(slide);
    out both: 1 = min(margin(first), margin(second));
    out rocker: 1 = ratio(phi[2], crank);
    out point: [m; 2] = ratio(0.1m*unit(phi[0]) + 0.25m*unit(phi[1]), crank);
    out far: 1 = 100*ratio(psi[1] - psi[0], crank)^2;
    out stroke: m = ratio(x, crank);
    out pushed: 1 = ratio(x, push);
    out still: 1/m = ratio(phi[2], push);
    out own: 1 = ratio(phi[0], crank) + ratio(s, push);
}

fn index(name: &str) -> usize {
    Train::<f64>::OUTPUTS.iter().position(|output| output.name == name).unwrap()
}

#[test]
fn ratios_are_the_motion_over_the_motion_of_the_drive() {
    let mut train = Stepper::assemble(
        Train::default(),
        Train::<f64>::default().guess(&Train::<f64>::default().parameters()),
        0.0,
    )
    .unwrap();
    for _ in 0..200 {
        train.advance(0.01).unwrap();
        let outputs = train.outputs();
        let value = |name: &str| outputs[index(name)].value;
        assert!(outputs.iter().all(|output| output.rate.is_none() && output.acceleration.is_none()));
        // The loops move with the crank alone: their rates are ratios times its speed.
        let (q, qd) = (train.q(), train.qd());
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * (1.0 + b.abs());
        assert!(near(value("rocker"), qd[2] / 2.0));
        assert!(near(value("far"), 100.0 * ((qd[4] - qd[3]) / 2.0).powi(2)));
        let point = [
            -0.1 * q[0].sin() - 0.25 * q[1].sin() * qd[1] / 2.0,
            0.1 * q[0].cos() + 0.25 * q[1].cos() * qd[1] / 2.0,
        ];
        assert!(near(value("point.0"), point[0]) && near(value("point.1"), point[1]));
        assert!(near(value("stroke"), (qd[5] - qd[6]) / 2.0));
        assert_eq!([value("pushed"), value("still"), value("own")], [1.0, 0.0, 2.0]);
    }
}

/// 2σ₁σ₂/(σ₁² + σ₂²) of a block, with the singular values from the eigenvalues of SᵀS.
fn margin(block: [[f64; 2]; 2]) -> f64 {
    let [[a, b], [c, d]] = block;
    let (p, q, r) = (a * a + c * c, a * b + c * d, b * b + d * d);
    let (mean, half) = (0.5 * (p + r), (0.25 * (p - r) * (p - r) + q * q).sqrt());
    let (first, second) = ((mean + half).sqrt(), (mean - half).max(0.0).sqrt());
    2.0 * first * second / (first * first + second * second)
}

#[test]
fn margins_are_those_of_the_blocks_that_hold_the_rows() {
    let guess = Train::<f64>::default().guess(&Train::<f64>::default().parameters());
    let mut train = Stepper::assemble(Train::default(), guess, 0.0).unwrap();
    for _ in 0..200 {
        train.advance(0.01).unwrap();
        let (mechanism, parameters) = (*train.mechanism(), *train.parameters());
        let phi_q = mechanism.phi_q(&parameters, &mechanism.position(&parameters, train.q(), train.t()));
        // Columns are angles, and the two rows of a loop have one scale.
        let block = |row: usize, column: usize| {
            margin([0, 1].map(|i| [phi_q[row + i][column], phi_q[row + i][column + 1]]))
        };
        let outputs = train.outputs();
        let value = |name: &str| outputs[index(name)].value;
        let (first, second) = (block(0, 1), block(2, 3));
        assert!((value("first_margin") - first).abs() < 1e-12, "{first}");
        assert!((value("second_margin") - second).abs() < 1e-12, "{second}");
        assert_eq!(value("slide_margin"), 1.0);
        assert_eq!(value("both"), value("first_margin").min(value("second_margin")));
        assert!((value("both") - train.margin()).abs() < 1e-15);
    }
}

#[test]
fn lanes_have_their_own_ratios() {
    type Two = Lanes<f64, 2>;
    let guess = Train::<f64>::default().guess(&Train::<f64>::default().parameters());
    let wide = Train::<Two>::default();
    let states = [0.1, 0.4].map(|t| Stepper::assemble(Train::<f64>::default(), guess, t).unwrap());
    let lanes = |values: [[f64; 7]; 2]| -> [Two; 7] {
        core::array::from_fn(|k| Two::from_lanes(|lane| values[lane][k]))
    };
    let (q, qd) = (lanes([*states[0].q(), *states[1].q()]), lanes([*states[0].qd(), *states[1].qd()]));
    let position = wide.position(&wide.parameters(), &q, Lanes([0.1, 0.4]));
    let outputs = wide.outputs(&wide.parameters(), &position, &qd, &qd);
    for (lane, state) in states.iter().enumerate() {
        for (wide, single) in outputs.iter().zip(state.outputs()) {
            assert!((wide.value.0[lane] - single.value).abs() < 1e-12);
        }
    }
}

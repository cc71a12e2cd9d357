//! Pictures of compiled mechanisms: their points are at the outputs of the emitted code.

use mbs_codegen::picture;
use mbs_runtime::{Mechanism, OutputValue, Signal, Stepper, mechanism};

mechanism! {
    /// A press whose ram is looked at.
    pub mechanism Press;
    param L: [m; 2] = [0.1, 0.3];
    param omega: rad/s = 20rpm;
    input lift: m, rates;
    coord phi: rad = 0.5;
    coord rod: rad = -0.1;
    coord x: m = 0.35;
    let A = L[0]*unit(phi) + [0, lift];
    constraint closure { A + L[1]*unit(rod) == [x, 0]; }
    drive crank: rate(phi) == omega;
    branch ahead: cos(rod) > 0;
    out crank_pin: [m; 2] = A;
    out S: [m; 2] = [x, 0.01*t/1s];
    out ahead: [m; 2] = [x, 0] + der(A)*0.1s + der2([x, 0m])*0.01 [s^2];
    out middle: [m; 2, 2] = [A/2, (A + [x, 0])/2];
    title "Press";
    preset shorter "a shorter crank" { L[0]: 80mm, lift.rate: 0.1 }
    for i in 0..2 { draw joint middle[i]; }
    draw link rod: crank_pin, S;
    draw slider A along rod;
    trace ahead;
    effect pressed { param load: N = 3; trace S; }
    effect idle { param gain: 1 = 2; out top: [m; 2] = gain*A; draw ground top; }
    scene Working = pressed { span turn(omega); }
    scene Idle = idle;
}

/// Largest distance of a component of the picture from that of the outputs, in a motion of a second.
fn worst<S, const N: usize>(mechanism: S, scene: &str, drawn: usize) -> f64
where
    S: mbs_runtime::Kinematic<f64, N> + Mechanism<f64, N, N>,
    S::Outputs: AsRef<[OutputValue<f64>]>,
{
    let picture = picture(S::SOURCE, Some(scene)).expect("a picture");
    let guess = mechanism.guess(&mechanism.parameters());
    let mut motion = Stepper::assemble(mechanism, guess, 0.0).expect("an assembly");
    let (mut worst, mut compared) = (0.0_f64, 0);
    for _ in 0..50 {
        motion.advance(0.02).expect("a step");
        let outputs = motion.outputs();
        let variables: Vec<f64> =
            (0..S::VARIABLES.len()).map(|index| motion.mechanism().get(index).expect("a variable")).collect();
        let points = picture.points([motion.q(), motion.qd(), motion.qdd()], motion.t(), &variables);
        for (place, point) in picture.places().iter().zip(points).filter(|(place, _)| place.is_output) {
            for (component, found) in point.iter().take(place.kind.components()).enumerate() {
                let name = format!("{}.{component}", place.name);
                let index = S::OUTPUTS.iter().position(|output| output.name == name).expect("an output");
                worst = worst.max((found - outputs.as_ref()[index].value).abs());
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 50 * 2 * drawn, "{scene}");
    worst
}

#[test]
fn points_of_a_picture_are_where_the_outputs_are() {
    let lift = Signal { value: 0.02, rate: 0.01, acceleration: -0.05 };
    let working = PressWorking { lift, L: [0.09, 0.31], ..Default::default() };
    let idle = PressIdle { lift, gain: 1.5, ..Default::default() };
    // Lengths up to 1 m; sine and cosine of emitted code and of `libm` differ in their last place.
    for (scene, worst) in [("Working", worst(working, "Working", 5)), ("Idle", worst(idle, "Idle", 6))] {
        println!("{scene}: {worst:.1e} m");
        assert!(worst < 1e-14, "{scene}: {worst}");
    }
}

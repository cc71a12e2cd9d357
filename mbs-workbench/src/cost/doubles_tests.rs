//! Motions from drives with a function of the caller that exists in `f64` alone, against the same function in all numbers.

use core::f64::consts::TAU;

use mbs_runtime::Function;
use mbs_runtime::driver::Harmonic;

use super::kinematics::{Digits, exact_motion};
use crate::double_double::DoubleDouble as D;
use crate::erased::costs::Comparable;
use crate::setting::Closing;

mbs_runtime::mechanism! {
    /// A follower whose place decides where it touches its cam: the function's argument is unknown to the rounding of `f64`.
    pub mechanism Follower;
    function lift: m(rad), C3, periodic TAU;
    coord theta: rad;
    coord x: m = 0.2;
    drive cam: theta == 6 [rad/s]*t + 0.3;
    constraint touches { x == lift(theta + 2 [rad/m]*x); }
}

const LIFT: Harmonic = Harmonic { offset: 0.2, amplitude: 0.1, frequency: 1.0, phase: 0.0 };

/// The same function in `f64`.
#[derive(Clone)]
struct InDoubles;

impl Function<f64> for InDoubles {
    const ORDER: usize = 9;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        LIFT.jet(x)
    }
}

#[test]
fn positions_with_a_function_in_doubles_are_known_within_their_width() {
    let compared: fn(&[(usize, f64)]) -> Comparable =
        crate::comparable!(Follower::new(InDoubles), Follower, [lift]);
    let Comparable::Driven(mut mechanism) = compared(&[]) else { panic!("a drive moves it") };
    const PARTS: u32 = 60;
    let until = TAU / 6.0;
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let mut followed = Vec::new();
    let (_, _, double) = &mechanism.runs[0];
    double.run(Closing::Closed, &times, Some(&mut |placed| followed.push(placed))).expect("a run");
    mechanism.exact.begin(0.0, &followed[0].motion[0]);
    let digits = Digits::of(&mechanism.doubles);
    let found = exact_motion(mechanism.exact.as_ref(), &digits, &followed, until, &mut |_| ());
    let found = found.expect("positions");
    let width = found.width(&digits, TAU).expect("it has one");
    assert!((1e-16..1e-14).contains(&width), "{width:e}");
    // The function itself takes numbers of all digits: the row tells how far its solution is.
    let open = found.reference.iter().map(|exact| {
        let [value, slope] = LIFT.jet::<2>(exact.q[0] + D::new(2.0) * exact.q[1]);
        ((exact.q[1] - value).high / (1.0 - 2.0 * slope.high)).abs()
    });
    let open = open.fold(0.0, f64::max);
    assert!(open > 1e-20 && open < width * TAU, "{open:e} {width:e}");
    // Rates by differences have a rounding over the distance, and over its square.
    assert!(found.apart[0] < 1e-10 && found.apart[1] < 1e-6, "{:?}", found.apart);
}

//! The four-bar in every kind of coordinates, its crank driven in every way.

use core::f64::consts::TAU;

use mbs_runtime::{Function, Kinematic, Real, Scalar, Signal, mechanism};

use super::Linkage;

/// A four-bar of bars a, b, c on the ground d.
macro_rules! linkage {
    ($name:ident $text:tt) => { linkage! { @ $name $text } };
    (@ $name:ident { $($text:tt)* }) => {
        mechanism! {
            /// A four-bar.
            pub mechanism $name;
            param a: m = 1;
            param b: m = 2;
            param c: m = 1;
            param d: m = 2;
            $($text)*
        }
    };
}

linkage!(AnglesByTime {
    coord p1: rad = 0.5;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(p1) + b*unit(p2) == [d, 0] + c*unit(p3); }
    drive crank: p1 == 1*t/1s;
});
linkage!(AnglesByTimeInARow {
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(1*t/1s) + b*unit(p2) == [d, 0] + c*unit(p3); }
});
linkage!(AnglesByFunctionInARow {
    function law: rad(s), C2;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(law(t)) + b*unit(p2) == [d, 0] + c*unit(p3); }
});
linkage!(AnglesByInput {
    input theta: rad, rates;
    coord p1: rad = 0.5;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(p1) + b*unit(p2) == [d, 0] + c*unit(p3); }
    drive crank: p1 == theta;
});
linkage!(AnglesByInputInARow {
    input theta: rad, rates;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(theta) + b*unit(p2) == [d, 0] + c*unit(p3); }
});
linkage!(AnglesByTurnInARow {
    input theta: turn, rates;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(theta) + b*unit(p2) == [d, 0] + c*unit(p3); }
});
linkage!(NaturalByTurn {
    input theta: turn, rates;
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint crank { A == a*unit(theta); }
    constraint bars { norm(B - A) == b; norm(B - [d, 0]) == c; }
});
linkage!(AnglesBySine {
    input theta: rad, rates;
    coord p1: turn = 0.5;
    coord p2: turn = 0.5;
    coord p3: turn = 0.5;
    constraint closure { a*unit(p1) + b*unit(p2) == [d, 0] + c*unit(p3); }
    constraint encoder { sin(p1 - theta) == 0; }
    branch same: cos(p1 - theta) > 0;
});
linkage!(AnglesByRate {
    param omega: rad/s = 1;
    coord p1: rad = 0.5;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { a*unit(p1) + b*unit(p2) == [d, 0] + c*unit(p3); }
    drive crank: rate(p1) == omega;
});
linkage!(RelativeByTime {
    coord q1: rad = 0.5;
    coord q2: rad = 0.5;
    coord q3: rad = 0.5;
    constraint closure { a*unit(q1) + b*unit(q1 + q2) == [d, 0] + c*unit(q1 + q2 + q3); }
    drive crank: q1 == 1*t/1s;
});
linkage!(RelativeByInput {
    input theta: rad, rates;
    coord q1: rad = 0.5;
    coord q2: rad = 0.5;
    coord q3: rad = 0.5;
    constraint closure { a*unit(q1) + b*unit(q1 + q2) == [d, 0] + c*unit(q1 + q2 + q3); }
    drive crank: q1 == theta;
});
linkage!(NaturalByTimeInARow {
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint crank { A == a*unit(1*t/1s); }
    constraint bars { norm(B - A) == b; norm(B - [d, 0]) == c; }
});
linkage!(NaturalByInputInARow {
    input theta: rad, rates;
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint crank { A == a*unit(theta); }
    constraint bars { dot(B - A, B - A) == b^2; dot(B - [d, 0], B - [d, 0]) == c^2; }
});
linkage!(NaturalByInput {
    input theta: rad, rates;
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint bars { dot(A, A) == a^2; dot(B - A, B - A) == b^2; dot(B - [d, 0], B - [d, 0]) == c^2; }
    drive crank: cross(unit(theta), A) == 0;
});
linkage!(NaturalByRate {
    param omega: rad/s = 1;
    coord p1: rad = 0.5;
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint crank { A == a*unit(p1); }
    constraint bars { norm(B - A) == b; norm(B - [d, 0]) == c; }
    drive motor: rate(p1) == omega;
});
linkage!(ReferencePointsByInput {
    input theta: rad, rates;
    coord r1: [m; 2] = [0.5, 0.5];
    coord f1: rad = 0.5;
    coord r2: [m; 2] = [0.5, 0.5];
    coord f2: rad = 0.5;
    coord r3: [m; 2] = [0.5, 0.5];
    coord f3: rad = 0.5;
    constraint joints {
        r1 == a/2*unit(f1);
        r1 + a/2*unit(f1) == r2 - b/2*unit(f2);
        r2 + b/2*unit(f2) == r3 + c/2*unit(f3);
        r3 - c/2*unit(f3) == [d, 0];
    }
    drive crank: f1 == theta;
});
linkage!(MixedByInputInARow {
    input theta: rad, rates;
    coord A: [m; 2] = [0.5, 0.5];
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint crank { A == a*unit(theta); }
    constraint closure { A + b*unit(p2) == [d, 0] + c*unit(p3); }
});
linkage!(MixedByTime {
    coord p1: rad = 0.5;
    coord B: [m; 2] = [0.5, 0.5];
    coord p3: rad = 0.5;
    constraint coupler { norm(B - a*unit(p1)) == b; }
    constraint rocker { B == [d, 0] + c*unit(p3); }
    drive crank: p1 == 1*t/1s;
});

/// A law of the crank: twice the time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Twice;

impl<T: Scalar> Function<T> for Twice {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let all = [T::constant(2.0) * x, T::constant(2.0), T::constant(0.0)];
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(T::constant(0.0)))
    }
}

/// Driver of the crank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum By {
    /// By the time, at this speed (rad/s).
    Time(f64),
    /// By an input with rates.
    Input,
    /// By a prescribed rate.
    Rate,
}

/// A four-bar as a text has it.
pub trait Case<T: Scalar, const N: usize>: Kinematic<T, N> {
    const BY: By;
    /// Its dimensions.
    fn set_lengths(&mut self, linkage: &Linkage);
    /// The measured crank angle (rad) and its rate, or the rate alone.
    fn command(&mut self, theta: T, rate: T);
    /// Coordinates at crank angle `theta` (rad) with the point between coupler and rocker at `b` (m).
    fn start(linkage: &Linkage, theta: f64, b: [f64; 2]) -> [f64; N];
    /// That point (m).
    fn point(linkage: &Linkage, q: [f64; N]) -> [f64; 2];
}

macro_rules! case {
    ($name:ident $(<$function:ident>)?, $n:literal, $by:expr, |$crank:ident, $theta:ident, $rate:ident| $command:expr,
     |$l:ident, $angle:ident, $tip:ident, $b:ident| $guess:expr, |$ll:ident, $q:ident| $point:expr) => {
        impl<T: Scalar> Case<T, $n> for $name<$($function,)? T> {
            const BY: By = $by;
            fn set_lengths(&mut self, linkage: &Linkage) {
                let Linkage { crank, coupler, rocker, ground, .. } = *linkage;
                [self.a, self.b, self.c, self.d] = [crank, coupler, rocker, ground].map(T::constant);
            }
            fn command(&mut self, $theta: T, $rate: T) {
                let $crank = self;
                $command
            }
            fn start($l: &Linkage, $angle: f64, $b: [f64; 2]) -> [f64; $n] {
                let $tip = $l.tip($angle);
                $guess
            }
            fn point($ll: &Linkage, $q: [f64; $n]) -> [f64; 2] {
                $point
            }
        }
    };
}

fn signal<T: Scalar>(value: T, rate: T) -> Signal<T> {
    Signal { value, rate, acceleration: T::constant(0.0) }
}

/// Reading of an encoder: the angle from −π to π.
fn within_a_turn<T: Scalar>(theta: T) -> T {
    T::from_lanes(|lane| {
        let angle = theta.lane(lane).to_f64();
        T::Real::constant(angle - TAU * (angle / TAU).round())
    })
}

/// Direction (rad) of a vector.
fn angle(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

/// Directions of coupler and rocker.
fn bars(l: &Linkage, tip: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [angle(tip, b), angle([l.ground, 0.0], b)]
}

/// The end of the rocker at its angle.
fn rocker(l: &Linkage, p3: f64) -> [f64; 2] {
    [l.ground + l.rocker * p3.cos(), l.rocker * p3.sin()]
}

fn of_angles(l: &Linkage, theta: f64, tip: [f64; 2], b: [f64; 2]) -> [f64; 3] {
    let [p2, p3] = bars(l, tip, b);
    [theta, p2, p3]
}

fn of_relative(l: &Linkage, theta: f64, tip: [f64; 2], b: [f64; 2]) -> [f64; 3] {
    let [p2, p3] = bars(l, tip, b);
    [theta, p2 - theta, p3 - p2]
}

case!(
    AnglesByTime,
    3,
    By::Time(1.0),
    |_crank, _theta, _rate| (),
    |l, theta, tip, b| of_angles(l, theta, tip, b),
    |l, q| rocker(l, q[2])
);
case!(
    AnglesByTimeInARow,
    2,
    By::Time(1.0),
    |_crank, _theta, _rate| (),
    |l, theta, tip, b| bars(l, tip, b),
    |l, q| rocker(l, q[1])
);
case!(
    AnglesByFunctionInARow<Twice>,
    2,
    By::Time(2.0),
    |_crank, _theta, _rate| (),
    |l, theta, tip, b| bars(l, tip, b),
    |l, q| rocker(l, q[1])
);
case!(
    AnglesByInput,
    3,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| of_angles(l, theta, tip, b),
    |l, q| rocker(l, q[2])
);
case!(
    AnglesByInputInARow,
    2,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| bars(l, tip, b),
    |l, q| rocker(l, q[1])
);
case!(
    AnglesByTurnInARow,
    2,
    By::Input,
    |crank, theta, rate| crank.theta = signal(within_a_turn(theta), rate),
    |l, theta, tip, b| bars(l, tip, b),
    |l, q| rocker(l, q[1])
);
case!(
    NaturalByTurn,
    4,
    By::Input,
    |crank, theta, rate| crank.theta = signal(within_a_turn(theta), rate),
    |_l, theta, tip, b| [tip[0], tip[1], b[0], b[1]],
    |_l, q| [q[2], q[3]]
);
case!(
    AnglesBySine,
    3,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| of_angles(l, theta, tip, b),
    |l, q| rocker(l, q[2])
);
case!(
    AnglesByRate,
    3,
    By::Rate,
    |crank, _theta, rate| crank.omega = rate,
    |l, theta, tip, b| of_angles(l, theta, tip, b),
    |l, q| rocker(l, q[2])
);
case!(
    RelativeByTime,
    3,
    By::Time(1.0),
    |_crank, _theta, _rate| (),
    |l, theta, tip, b| of_relative(l, theta, tip, b),
    |l, q| rocker(l, q[0] + q[1] + q[2])
);
case!(
    RelativeByInput,
    3,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| of_relative(l, theta, tip, b),
    |l, q| rocker(l, q[0] + q[1] + q[2])
);
case!(
    NaturalByTimeInARow,
    4,
    By::Time(1.0),
    |_crank, _theta, _rate| (),
    |_l, theta, tip, b| [tip[0], tip[1], b[0], b[1]],
    |_l, q| [q[2], q[3]]
);
case!(
    NaturalByInputInARow,
    4,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |_l, theta, tip, b| [tip[0], tip[1], b[0], b[1]],
    |_l, q| [q[2], q[3]]
);
case!(
    NaturalByInput,
    4,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |_l, theta, tip, b| [tip[0], tip[1], b[0], b[1]],
    |_l, q| [q[2], q[3]]
);
case!(
    NaturalByRate,
    5,
    By::Rate,
    |crank, _theta, rate| crank.omega = rate,
    |_l, theta, tip, b| [theta, tip[0], tip[1], b[0], b[1]],
    |_l, q| [q[3], q[4]]
);
case!(
    ReferencePointsByInput,
    9,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| {
        let [p2, p3] = bars(l, tip, b);
        let middle = |from: [f64; 2], to: [f64; 2]| [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0];
        let [r1, r2, r3] = [middle([0.0; 2], tip), middle(tip, b), middle([l.ground, 0.0], b)];
        [r1[0], r1[1], theta, r2[0], r2[1], p2, r3[0], r3[1], p3]
    },
    |l, q| rocker(l, q[8])
);
case!(
    MixedByInputInARow,
    4,
    By::Input,
    |crank, theta, rate| crank.theta = signal(theta, rate),
    |l, theta, tip, b| {
        let [p2, p3] = bars(l, tip, b);
        [tip[0], tip[1], p2, p3]
    },
    |l, q| rocker(l, q[3])
);
case!(
    MixedByTime,
    4,
    By::Time(1.0),
    |_crank, _theta, _rate| (),
    |l, theta, tip, b| [theta, b[0], b[1], bars(l, tip, b)[1]],
    |_l, q| [q[1], q[2]]
);

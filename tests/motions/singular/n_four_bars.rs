//! Parallelograms in a row (IFToMM benchmark A02) in four sets of coordinates, through positions with every rod in line.

use mbs_runtime::mechanism;

/// A text of uniform rods of 1 kg: uprights of length `L` at a distance `b`, which turn by `angle` (rad) from the vertical, clockwise.
macro_rules! texts {
    (angles $angles:ident, $loops:literal) => {
        mechanism! {
            /// Bar angles.
            pub mechanism $angles;
            const N: 1 = $loops;
            param L: m = 1;
            param b: m = 1;
            param g: m/s^2 = 9.81;
            param angle: rad = 0;
            param speed: rad/s = 1;
            coord phi: [rad; N + 1] = PI/2;
            coord theta: [rad; N] = 0;
            gravity weight { acceleration: [0, -g] }
            for i in 0..N + 1 {
                body upright { mass: 1, inertia: 1kg*L^2/12, com: [i*b, 0] + L/2*unit(phi[i]), angle: phi[i] }
                start phi[i] = PI/2 - angle rate -speed;
            }
            for i in 0..N {
                body coupler {
                    mass: 1, inertia: 1kg*b^2/12, com: [i*b, 0] + L*unit(phi[i]) + b/2*unit(theta[i]), angle: theta[i]
                }
                constraint closure { L*unit(phi[i]) + b*unit(theta[i]) == [b, 0] + L*unit(phi[i + 1]); }
                start theta[i] = 0 rate 0;
            }
            out head: [m; 2] = L*unit(phi[0]);
        }
        design!($angles, $loops);
    };
    (natural $natural:ident, $loops:literal) => {
        mechanism! {
            /// Natural coordinates.
            pub mechanism $natural;
            const N: 1 = $loops;
            param L: m = 1;
            param b: m = 1;
            param g: m/s^2 = 9.81;
            param angle: rad = 0;
            param speed: rad/s = 1;
            coord B: [m; N + 1, 2] = 1;
            gravity weight { acceleration: [0, -g] }
            for i in 0..N + 1 {
                let A = [i*b, 0];
                body upright { mass: 1, com: (A + B[i])/2 }
                kinetic upright_turning = 1kg*dot(der(B[i]), der(B[i]))/24;
                constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
                start B[i] = A + L*[sin(angle), cos(angle)] rate L*speed*[cos(angle), -sin(angle)];
            }
            for i in 0..N {
                body coupler { mass: 1, com: (B[i] + B[i + 1])/2 }
                kinetic coupler_turning = 1kg*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
                constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == b^2; }
            }
            out head: [m; 2] = B[0];
        }
        design!($natural, $loops);
    };
    (mixed $mixed:ident, $loops:literal) => {
        mechanism! {
            /// Natural coordinates, and the angle of the first upright.
            pub mechanism $mixed;
            const N: 1 = $loops;
            param L: m = 1;
            param b: m = 1;
            param g: m/s^2 = 9.81;
            param angle: rad = 0;
            param speed: rad/s = 1;
            coord phi: rad = PI/2;
            coord B: [m; N, 2] = 1;
            gravity weight { acceleration: [0, -g] }
            body first { mass: 1, inertia: 1kg*L^2/12, com: L/2*unit(phi), angle: phi }
            start phi = PI/2 - angle rate -speed;
            for i in 0..N {
                let A = [(i + 1)*b, 0];
                body upright { mass: 1, com: (A + B[i])/2 }
                kinetic upright_turning = 1kg*dot(der(B[i]), der(B[i]))/24;
                constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
                start B[i] = A + L*[sin(angle), cos(angle)] rate L*speed*[cos(angle), -sin(angle)];
            }
            body link { mass: 1, com: (L*unit(phi) + B[0])/2 }
            kinetic link_turning = 1kg*dot(der(B[0] - L*unit(phi)), der(B[0] - L*unit(phi)))/24;
            constraint link { dot(B[0] - L*unit(phi), B[0] - L*unit(phi)) == b^2; }
            for i in 0..N - 1 {
                body coupler { mass: 1, com: (B[i] + B[i + 1])/2 }
                kinetic coupler_turning = 1kg*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
                constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == b^2; }
            }
            out head: [m; 2] = L*unit(phi);
        }
        design!($mixed, $loops);
    };
    (points $points:ident, $loops:literal) => {
        mechanism! {
            /// Reference points.
            pub mechanism $points;
            const N: 1 = $loops;
            param L: m = 1;
            param b: m = 1;
            param g: m/s^2 = 9.81;
            param angle: rad = 0;
            param speed: rad/s = 1;
            coord c: [m; N + 1, 2] = 1;
            coord phi: [rad; N + 1] = PI/2;
            coord d: [m; N, 2] = 1;
            coord theta: [rad; N] = 0;
            gravity weight { acceleration: [0, -g] }
            for i in 0..N + 1 {
                body upright { mass: 1, inertia: 1kg*L^2/12, com: c[i], angle: phi[i] }
                constraint feet { c[i] - L/2*unit(phi[i]) == [i*b, 0]; }
                start phi[i] = PI/2 - angle rate -speed;
                start c[i] = [i*b, 0] + L/2*[sin(angle), cos(angle)] rate L/2*speed*[cos(angle), -sin(angle)];
            }
            for i in 0..N {
                body coupler { mass: 1, inertia: 1kg*b^2/12, com: d[i], angle: theta[i] }
                constraint left { c[i] + L/2*unit(phi[i]) == d[i] - b/2*unit(theta[i]); }
                constraint right { c[i + 1] + L/2*unit(phi[i + 1]) == d[i] + b/2*unit(theta[i]); }
                start theta[i] = 0 rate 0;
                start d[i] = [(i + 0.5)*b, 0] + L*[sin(angle), cos(angle)] rate L*speed*[cos(angle), -sin(angle)];
            }
            out head: [m; 2] = c[0] + L/2*unit(phi[0]);
        }
        design!($points, $loops);
    };
}

/// Parameters that differ from run to run.
#[derive(Clone, Copy, Debug)]
pub struct Design {
    /// Length of an upright (m).
    pub upright: f64,
    /// Distance of the feet (m).
    pub distance: f64,
    /// Free fall (m/s²).
    pub gravity: f64,
    /// Angle of the uprights from the vertical at the start (rad).
    pub angle: f64,
    /// Its rate (rad/s).
    pub speed: f64,
}

impl Design {
    /// The benchmark's.
    pub const USUAL: Design = Design { upright: 1.0, distance: 1.0, gravity: 9.81, angle: 0.0, speed: 1.0 };

    /// The angle (rad) of all uprights of `loops` after `seconds`: θ̈ = (C/I) g/L sin θ with C = (N+1)/2 + N and I = (N+1)/3 + N.
    ///
    /// A composition of leapfrogs; halving its steps moves no digit of ten. Source: Yoshida 1990.
    pub fn exact(&self, loops: u32, seconds: f64) -> f64 {
        const STEPS: u32 = 50_000;
        let count = f64::from(loops);
        let ratio = ((count + 1.0) / 2.0 + count) / ((count + 1.0) / 3.0 + count);
        let stiffness = ratio * self.gravity / self.upright;
        let h = seconds / f64::from(STEPS);
        let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
        let (mut angle, mut rate) = (self.angle, self.speed);
        for _ in 0..STEPS {
            for share in [outer, 1.0 - 2.0 * outer, outer] {
                angle += 0.5 * share * h * rate;
                rate += share * h * stiffness * angle.sin();
                angle += 0.5 * share * h * rate;
            }
        }
        angle
    }
}

/// A text that takes a design.
pub trait Designed {
    /// Number of parallelograms.
    const LOOPS: u32;

    /// That design.
    fn designed(design: &Design) -> Self;
}

macro_rules! design {
    ($name:ident, $loops:literal) => {
        impl Designed for $name {
            const LOOPS: u32 = $loops;

            fn designed(design: &Design) -> Self {
                let Design { upright, distance, gravity, angle, speed } = *design;
                $name { L: upright, b: distance, g: gravity, angle, speed }
            }
        }
    };
}

texts!(angles Angles1, 1);
texts!(angles Angles2, 2);
texts!(angles Angles10, 10);
texts!(natural Natural1, 1);
texts!(natural Natural2, 2);
texts!(natural Natural10, 10);
texts!(mixed Mixed1, 1);
texts!(mixed Mixed2, 2);
texts!(points Points1, 1);
texts!(points Points2, 2);

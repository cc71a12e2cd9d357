//! A desmodromic valvetrain: one cam opens the valve by a finger, another one closes it by a bell crank.
//!
//! ```text
//!        closer's pad ( )    .-.
//!              .     ( o )  (   )   both cams turn about C
//!      opener's pad ( )__    '-'
//!     ____________.--'   `--o opener's pivot
//!     |  pad
//!     ===== valve's end        θ: cam, 0 at full lift; opener, closer: angles of the rockers (rad)
//!     |  fork from below ______o closer's pivot
//!     |                        s: lift (m), the valve opens along −y
//! ```
//!
//! Lengths in metres, angles in rad, `q = [θ opener s closer]`, with a valve spring in place of the closing cam `q = [θ opener s]`.
//!
//! | effect | law |
//! |---|---|
//! | `even`, `uneven` | the cam turns at constant speed, or with a harmonic on top |
//! | `closing` | bell crank on the closing cam |
//! | `permanent` | rows in place of contacts: pads on their cams, the finger on the valve |
//! | `held` | one row more: the fork on the valve, which yields to the others |
//! | `inertia`, `closing_inertia` | moments of inertia about the pivots, mass of the valve |
//! | `contacts`, `closing_contacts` | K dⁿ (1 + D ḋ) between cam and pad, pad and valve, valve and seat |
//! | `fitted`, `clearance` | no play, or play between the valve's end and both pads |
//! | `helper` | spring on the closer that keeps the valve on its seat |
//! | `guide` | friction of the valve's guide: c ṡ + F tanh(ṡ/v₀) |
//! | `gravity` | weight of the valve |
//! | `loads`, `closing_loads`, `books` | forces by name; work of the cam's torque, of contacts and guide |
//! | `spring` | an ordinary valve spring |
//!
//! The pitch curves of both cams are functions of the text. [`Design`] makes them from a lift law, in closed form. Radii of pads are in
//! the curves alone. So the gap of a pad and its cam is the distance of its centre from the pitch curve.
//!
//! Numbers: chosen here, none of a valvetrain in production. Source of the synthesis: Norton, Cam Design and Manufacturing Handbook,
//! ch. 7; of the contact: Hunt and Crossley 1975.

pub mod design;
pub mod motion;
pub mod study;

use mbs_runtime::mechanism;
use mbs_workbench::cams::follower::Direction;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::erase::erase;
use mbs_workbench::verify::NumberedStandIn;

pub use design::Design;

mechanism! {
    /// Desmodromic valvetrain of rigid bodies.
    pub mechanism Desmo;
    /// Centre of both cams.
    param centre: [m; 2] = [12mm, 20mm];
    /// Pivot of the opener, its pads on cam and valve at lift 0 from there.
    param opener_pivot: [m; 2] = [31mm, 1mm];
    param opener_cam: [m; 2] = [-18mm, -4.98mm];
    param opener_valve: [m; 2] = [-31mm, 7mm];
    /// 1 for cams that turn counter-clockwise, else -1.
    param sense: 1 = 1;
    param speed: rad/s = 9000rpm;
    /// Angle of the cam at the start: the valve is closed.
    param begin: rad = -180deg;
    /// Polar radii of the pitch curves: of the opener's cam, of the closer's.
    function pitch: [m; 2](rad), C3, periodic TAU;

    coord theta: rad = -180deg;
    coord opener: rad = 0;
    coord s: m = 0;
    let opener_pad = opener_pivot + rot(opener)*opener_cam;
    let opener_tip = opener_pivot + rot(opener)*opener_valve;
    curve opening_cam = polar pitch[0] about centre turned sense*theta;
    /// Way of the finger's pad along the valve's axis.
    let opener_way = opener_valve.1 - (rot(opener)*opener_valve).1;
    branch finger: cos(opener) > 0;

    effect even { drive shaft: theta == begin + speed*t; }
    effect uneven {
        /// Amplitude and order of a harmonic on top.
        param swing: rad = 0deg;
        param order: 1 = 2;
        drive shaft: theta == begin + speed*t + swing*sin(order*speed*t);
    }
    effect closing {
        param closer_pivot: [m; 2] = [35mm, -9mm];
        param closer_cam: [m; 2] = [5.7mm, 28.4mm];
        param closer_valve: [m; 2] = [-35mm, -3mm];
        coord closer: rad = 0;
        let closer_pad = closer_pivot + rot(closer)*closer_cam;
        let closer_tip = closer_pivot + rot(closer)*closer_valve;
        let closer_way = closer_valve.1 - (rot(closer)*closer_valve).1;
        curve closing_cam = polar pitch[1] about centre turned sense*theta;
        branch bell_crank: cos(closer) > 0;
    }
    effect permanent {
        /// Radii of the pads on the cams, for the drawing alone.
        param opener_radius: m = 12mm;
        param closer_radius: m = 12mm;
        constraint opens { opener_pad on opening_cam; }
        constraint closes { closer_pad on closing_cam; }
        constraint rests { s == opener_way; }
        /// Distance of the closer's fork from the place where the opener holds the valve.
        out apart: m = closer_way - opener_way;
        out lift: m = s;
        out C: [m; 2] = centre;
        out P: [m; 2] = opener_pivot;
        out A: [m; 2] = opener_pad;
        out B: [m; 2] = opener_tip;
        out V: [m; 2] = [0, -s];
        out plate: [m; 2] = [0, -s - 40mm];
        out Q: [m; 2] = closer_pivot;
        out D: [m; 2] = closer_pad;
        out E: [m; 2] = closer_tip;
        out opener_touch: [m; 2] = opener_pad - opener_radius*outward(opener_pad, opening_cam);
        out closer_touch: [m; 2] = closer_pad - closer_radius*outward(closer_pad, closing_cam);
        out turned: rad = sense*theta;
    }
    effect held {
        /// Largest contradiction of the closing cam and the opening one.
        param misfit: m = 10um;
        constraint holds redundant within misfit { s == closer_way; }
    }
    effect inertia {
        param valve_mass: kg = 28gram;
        param opener_inertia: kg*m^2 = 1.3e-5;
        kinetic opener_turns = opener_inertia*der(opener)^2/2;
        body valve { mass: valve_mass, com: [0, -s] }
    }
    effect closing_inertia {
        param closer_inertia: kg*m^2 = 2.2e-5;
        kinetic closer_turns = closer_inertia*der(closer)^2/2;
    }
    effect contacts {
        param stiffness: N/m^1.5 = 5e10;
        param damping: s/m = 1.5;
        contact nose {
            gap: distance(opener_pad, opening_cam),
            stiffness: stiffness*sqrt(1m),
            exponent: 1.5,
            depth: 1m,
            damping: damping
        }
        contact tip {
            gap: s - opener_way + open_play,
            stiffness: stiffness*sqrt(1m),
            exponent: 1.5,
            depth: 1m,
            damping: damping
        }
        contact seat { gap: s, stiffness: stiffness*sqrt(1m), exponent: 1.5, depth: 1m, damping: damping }
    }
    effect closing_contacts {
        contact heel {
            gap: distance(closer_pad, closing_cam),
            stiffness: stiffness*sqrt(1m),
            exponent: 1.5,
            depth: 1m,
            damping: damping
        }
        contact fork {
            gap: closer_way - s + close_play,
            stiffness: stiffness*sqrt(1m),
            exponent: 1.5,
            depth: 1m,
            damping: damping
        }
    }
    effect fitted {
        let open_play = 0 [m];
        let close_play = 0 [m];
    }
    effect clearance {
        param open_play: m = 0.10mm;
        param close_play: m = 0.03mm;
    }
    effect helper {
        /// Torque at lift 0, and its growth with the angle.
        param preload: N*m = 1.2;
        param winding: N*m = 1;
        rsda helper { angle: closer, stiffness: winding, rest: -preload/winding }
    }
    effect guide {
        param drag: N*s/m = 2;
        param dry: N = 3;
        friction guide { along: s, normal: dry, coefficient: 1, speed: 0.05 [m/s], viscous: drag }
    }
    effect gravity {
        gravity weight { acceleration: [0, -9.80665] }
    }
    effect spring {
        param valve_spring: N/m = 35000;
        param valve_preload: N = 250;
        tsda coil { from: [0, -60mm], to: [0, -s], stiffness: valve_spring, length: 60mm + valve_preload/valve_spring }
    }
    effect loads {
        out nose_force: N = force(nose);
        out tip_force: N = force(tip);
        out seat_force: N = force(seat);
        out cam_torque: N*m = effort(shaft);
    }
    effect closing_loads {
        out heel_force: N = force(heel);
        out fork_force: N = force(fork);
    }
    /// Since the start: work of the cam's torque, and what contacts and guide have taken, lost or stored.
    effect books {
        state cam_work: J = 0;
        state taken: J = 0;
        der(cam_work) == -der(theta)*(force(nose)*d(distance(opener_pad, opening_cam), theta)
                + force(heel)*d(distance(closer_pad, closing_cam), theta));
        der(taken) == -power(nose) - power(heel) - power(tip) - power(fork) - power(seat) - power(guide);
        out work: J = cam_work;
        out sink: J = taken;
    }

    /// Pads and valve keep their contacts.
    scene Kinematic = even + closing + permanent {
        title "Desmodromic valvetrain";
        about "One cam opens the valve by a finger, another one closes it by a bell crank.";
        preset "one turn" "all contacts kept" {}
        span turn(speed);
        draw ground C, P, Q;
        draw cam "closing cam": C contact closer_touch turn turned;
        draw cam "opening cam": C contact opener_touch turn turned;
        draw link opener: A, P, B;
        draw link closer: D, Q, E;
        draw wheel "opener's pad": A rim opener_touch;
        draw wheel "closer's pad": D rim closer_touch;
        draw link valve: V, plate;
        draw joint P, Q;
        trace "opener's pad": A;
        trace "closer's pad": D;
    }
    /// The same with a contact more than coordinates: the fork on the valve. What both cams contradict each other by is its mismatch.
    scene Held = even + closing + permanent + held;
    /// Contacts that give way, without play.
    scene Rigid = even + closing + inertia + closing_inertia + contacts + closing_contacts + fitted + helper + gravity;
    /// With play.
    scene Clearance = even + closing + inertia + closing_inertia + contacts + closing_contacts + clearance + helper
        + gravity;
    /// With play, friction, a cam that may turn unevenly, all forces by name, and the work of each.
    scene Friction = uneven + closing + inertia + closing_inertia + contacts + closing_contacts + clearance + helper
        + guide
        + gravity + loads + closing_loads + books;
    /// A valve spring in place of the closing cam.
    scene Ordinary = even + inertia + contacts + clearance + guide + gravity + spring + loads;
}

/// The ready valvetrain: 11 mm within 160°, cams that turn counter-clockwise.
///
/// # Panics
/// Never: its places and its law are numbers of this crate, and tests make it.
pub fn desmo() -> DesmoKinematic<design::Curve> {
    let ready = Design::law(0.011, 160_f64.to_radians())
        .and_then(|law| Design::ready(law, Direction::CounterClockwise).mechanism());
    ready.expect("a pair of cams for the law")
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(desmo())
    .compared_as(|| erase(DesmoKinematic::new(NumberedStandIn::array(0))))
    .studied_by(&study::STUDY);

//! The emitted functions of a slider-crank under fixed symbols, to be compared byte by byte between three builds.
//!
//! The text of the machine is written once; `alone` compiles it as it is. The other features add two scenes and an effect of
//! another machine at its slider, whose parameters are longer than those of the slider-crank.
//!
//! The same of bodies under forces: alone, in a scene of none of the effects of `every_effect/text.rs`, and in the scene of all of them.
#![no_std]

use mbs_runtime::{Dynamic, Energy, Evaluation, Kinematic, Margin, Mechanism, Newton, Outcome};

include!("../../../tests/every_effect/text.rs");

macro_rules! bodies {
    ([$($common:tt)*] $first:ident { $($text_of_first:tt)* } $($name:ident { $($text:tt)* })*) => {
        #[cfg(feature = "alone")]
        mbs_runtime::mechanism! {
            /// Bodies under their weight.
            pub mechanism Library;
            $($common)*
        }
        #[cfg(not(feature = "alone"))]
        mbs_runtime::mechanism! {
            /// Bodies under their weight, and every effect.
            pub mechanism Library;
            $($common)*
            effect $first { $($text_of_first)* }
            $(effect $name { $($text)* })*
            effect none {}
            scene Whole = $first $(+ $name)*;
            scene Bare = none;
        }
    };
}
every_effect!(bodies);

#[cfg(feature = "alone")]
type Bodies = Library;
#[cfg(feature = "without")]
type Bodies = LibraryBare<(), ()>;
#[cfg(feature = "with")]
type Bodies = LibraryWhole<mbs_runtime::driver::Harmonic, mbs_runtime::driver::Polynomial<2>>;

/// Coordinates of the bodies.
const B: usize = 5;

type Given = <Bodies as Mechanism<f64, B, 0>>::Parameters;
type Placed = <Bodies as Mechanism<f64, B, 0>>::Position;
type States = <Bodies as Dynamic<f64, B, 0>>::States;

macro_rules! slider_crank {
    ($($effects:tt)*) => {
        mbs_runtime::mechanism! {
            /// A slider-crank that is commanded to be out of line.
            pub mechanism Machine;
            param r: m = 50mm;
            param L: m = 180mm;
            param omega: rad/s = 30;
            input shift: m, rates;
            coord theta: rad = 0;
            coord phi: rad = 0;
            coord x: m = 230mm;
            constraint closure { r*unit(theta) + L*unit(phi) == [x, shift]; }
            drive crank: theta == omega*t;
            branch ahead: cos(phi) > 0;
            limit travel: 0.1m <= x <= 0.3m;
            out pin: [m; 2] = r*unit(theta);
            out speed: m/s = der(x);
            $($effects)*
        }
    };
}

#[cfg(feature = "alone")]
slider_crank! {}

#[cfg(not(feature = "alone"))]
slider_crank! {
    effect follower {
        param arm: m = 3;
        param tilt: rad = 0.3;
        input sway: m, rates;
        coord psi: rad = 0.5;
        coord y: [m; 2];
        constraint hung { y == arm*unit(psi) + [x, 0]; arm*sin(psi - tilt) == r*sin(theta) + sway; }
        branch low: cos(psi) > 0;
        limit swing: -1 <= psi <= 1;
        out height: m = y[1];
    }
    effect nothing {}
    scene With = follower;
    scene Without = nothing;
}

#[cfg(feature = "alone")]
type Chosen = Machine;
#[cfg(feature = "without")]
type Chosen = MachineWithout;
#[cfg(feature = "with")]
type Chosen = MachineWith;

const N: usize = if cfg!(feature = "with") { 6 } else { 3 };

type Parameters = <Chosen as Mechanism<f64, N, N>>::Parameters;
type Position = <Chosen as Mechanism<f64, N, N>>::Position;
type Entries = <Chosen as Mechanism<f64, N, N>>::Entries;
type Factors = <Chosen as Kinematic<f64, N>>::Factors;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

macro_rules! export {
    ($(fn $name:ident($($argument:ident: $kind:ty),*) -> $result:ty $body:block)*) => {
        $(
            /// A function as a symbol of its name.
            #[unsafe(no_mangle)]
            #[inline(never)]
            pub fn $name($($argument: $kind),*) -> $result $body
        )*
    };
}

export! {
    fn scene_parameters(m: &Chosen) -> Parameters { m.parameters() }
    fn scene_guess(m: &Chosen, p: &Parameters) -> [f64; N] { m.guess(p) }
    fn scene_coordinate_scales(m: &Chosen, p: &Parameters) -> [f64; N] { m.coordinate_scales(p) }
    fn scene_row_scales(m: &Chosen, p: &Parameters) -> [f64; N] { m.row_scales(p) }
    fn scene_position(m: &Chosen, p: &Parameters, q: &[f64; N], t: f64) -> Position { m.position(p, q, t) }
    fn scene_phi(m: &Chosen, p: &Parameters, s: &Position) -> [f64; N] { m.phi(p, s) }
    fn scene_phi_q(m: &Chosen, p: &Parameters, s: &Position) -> [[f64; N]; N] { m.phi_q(p, s) }
    fn scene_phi_q_entries(m: &Chosen, p: &Parameters, s: &Position) -> Entries { m.phi_q_entries(p, s) }
    fn scene_phi_t(m: &Chosen, p: &Parameters, s: &Position) -> [f64; N] { m.phi_t(p, s) }
    fn scene_phi_tt(m: &Chosen, p: &Parameters, s: &Position) -> [f64; N] { m.phi_tt(p, s) }
    fn scene_phi_qt_qd(m: &Chosen, p: &Parameters, s: &Position, qd: &[f64; N]) -> [f64; N] { m.phi_qt_qd(p, s, qd) }
    fn scene_gamma(m: &Chosen, p: &Parameters, s: &Position, qd: &[f64; N]) -> [f64; N] { m.gamma(p, s, qd) }
    fn scene_branches(m: &Chosen, p: &Parameters, s: &Position) -> <Chosen as Mechanism<f64, N, N>>::Branches {
        m.branches(p, s)
    }
    fn scene_limits(m: &Chosen, p: &Parameters, s: &Position) -> <Chosen as Mechanism<f64, N, N>>::Limits {
        m.limits(p, s)
    }
    fn scene_outputs(
        m: &Chosen, p: &Parameters, s: &Position, qd: &[f64; N], qdd: &[f64; N]
    ) -> <Chosen as Mechanism<f64, N, N>>::Outputs {
        m.outputs(p, s, qd, qdd)
    }
    fn scene_evaluate(m: &Chosen, p: &Parameters, q: &[f64; N], t: f64, qd: &[f64; N]) -> Evaluation<f64, Entries, N> {
        m.evaluate(p, q, t, qd)
    }
    fn scene_solve_blocks(m: &Chosen, p: &Parameters, q: &mut [f64; N], t: f64) -> [Outcome; 1] {
        m.solve_blocks(p, q, t, &mut Newton::new(1.0))
    }
    fn scene_factorize(m: &Chosen, p: &Parameters, s: &Position) -> (Factors, Margin<f64>) { m.factorize(p, s) }
    fn scene_solve_linear(m: &Chosen, f: &Factors, b: &[f64; N]) -> [f64; N] { m.solve_linear(f, b) }
    fn scene_get(m: &Chosen, index: usize) -> Option<f64> { m.get(index) }
    fn scene_set(m: &mut Chosen, index: usize, value: f64) -> bool { m.set(index, value) }
    fn scene_bodies_parameters(m: &Bodies) -> Given { m.parameters() }
    fn scene_bodies_position(m: &Bodies, p: &Given, q: &[f64; B], t: f64) -> Placed { m.position(p, q, t) }
    fn scene_bodies_mass(m: &Bodies, p: &Given, s: &Placed) -> [[f64; B]; B] { m.mass(p, s) }
    fn scene_bodies_mass_times(m: &Bodies, p: &Given, s: &Placed, x: &[f64; B]) -> [f64; B] { m.mass_times(p, s, x) }
    fn scene_bodies_force(m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B], z: &States) -> [f64; B] {
        m.force(p, s, qd, z, &[])
    }
    fn scene_bodies_force_q(m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B], z: &States) -> [[f64; B]; B] {
        m.force_q(p, s, qd, z, &[])
    }
    fn scene_bodies_force_qd(m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B], z: &States) -> [[f64; B]; B] {
        m.force_qd(p, s, qd, z, &[])
    }
    fn scene_bodies_energy(m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B]) -> Energy<f64> { m.energy(p, s, qd) }
    fn scene_bodies_powers(
        m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B], z: &States
    ) -> <Bodies as Dynamic<f64, B, 0>>::Powers {
        m.powers(p, s, qd, z, &[])
    }
    fn scene_bodies_state_rates(m: &Bodies, p: &Given, s: &Placed, qd: &[f64; B], z: &States) -> States {
        m.state_rates(p, s, qd, z, &[])
    }
}

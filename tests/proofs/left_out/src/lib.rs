//! The emitted functions of bodies under every effect but one under fixed symbols, to be compared byte by byte between two builds.
//!
//! With the feature `scenes` they are those of scenes of texts that have all effects, otherwise those of texts without one. `build.rs` writes
//! both, from `every_effect/text.rs` and `every_effect/rows.rs`.
#![no_std]
#![allow(non_camel_case_types)]

use mbs_runtime::driver::Harmonic;
use mbs_runtime::dynamics::{SetValuedRow, WithSetValuedRows};
use mbs_runtime::{Function, Scalar};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The law of every function. It has no data, so that its place in the struct counts for nothing.
#[derive(Clone, Copy)]
pub struct Law;

impl<T: Scalar> Function<T> for Law {
    const ORDER: usize = 3;

    #[inline(always)]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        Function::<T>::jet(&Harmonic { offset: 0.18, amplitude: 0.005, frequency: 1.0, phase: 0.3 }, x)
    }
}

/// Everything that set-valued rows say.
struct Sum;

impl<const N: usize> WithSetValuedRows<f64, N> for Sum {
    type Output = f64;

    fn at<const K: usize>(self, rows: &[SetValuedRow<f64, N>; K]) -> f64 {
        rows.iter().map(sum).sum()
    }
}

fn sum<const N: usize>(row: &SetValuedRow<f64, N>) -> f64 {
    let on = row.on.map_or(0.0, |on| on.coefficient + on.sliding + on.sticking);
    let own = row.place + row.rate + row.gamma + row.limit + row.restitution.unwrap_or(0.0) + on;
    row.gradient.iter().fold(own, |sum, entry| sum + entry)
}

macro_rules! export {
    ($name:ident, $machine:ty, $n:literal, $m:literal) => {
        use mbs_runtime::dynamics::{Condition, Event};
        use mbs_runtime::{Dynamic, DynamicState, Energy, Gap, Mechanism};

        type Machine = $machine;
        type Given = <Machine as Mechanism<f64, $n, $m>>::Parameters;
        type Placed = <Machine as Mechanism<f64, $n, $m>>::Position;
        type States = <Machine as Dynamic<f64, $n, $m>>::States;
        type Q = [f64; $n];
        type Rows = [f64; $m];

        export! { @functions $name, $n, $m;
            fn parameters(m: &Machine) -> Given { m.parameters() }
            fn position(m: &Machine, p: &Given, q: &Q, t: f64) -> Placed { m.position(p, q, t) }
            fn phi(m: &Machine, p: &Given, s: &Placed) -> Rows { m.phi(p, s) }
            fn phi_q(m: &Machine, p: &Given, s: &Placed) -> [Q; $m] { m.phi_q(p, s) }
            fn phi_t(m: &Machine, p: &Given, s: &Placed) -> Rows { m.phi_t(p, s) }
            fn gamma(m: &Machine, p: &Given, s: &Placed, qd: &Q) -> Rows { m.gamma(p, s, qd) }
            fn widths(m: &Machine, p: &Given) -> Rows { m.widths(p) }
            fn branches(m: &Machine, p: &Given, s: &Placed) -> <Machine as Mechanism<f64, $n, $m>>::Branches {
                m.branches(p, s)
            }
            fn limits(m: &Machine, p: &Given, s: &Placed) -> <Machine as Mechanism<f64, $n, $m>>::Limits {
                m.limits(p, s)
            }
            fn outputs(m: &Machine, p: &Given, s: &Placed, qd: &Q, qdd: &Q) -> <Machine as Mechanism<f64, $n, $m>>::Outputs {
                m.outputs(p, s, qd, qdd)
            }
            fn mass(m: &Machine, p: &Given, s: &Placed) -> [Q; $n] { m.mass(p, s) }
            fn mass_times(m: &Machine, p: &Given, s: &Placed, x: &Q) -> Q { m.mass_times(p, s, x) }
            fn force(m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows) -> Q { m.force(p, s, qd, z, l) }
            fn force_q(m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows) -> [Q; $n] {
                m.force_q(p, s, qd, z, l)
            }
            fn force_qd(m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows) -> [Q; $n] {
                m.force_qd(p, s, qd, z, l)
            }
            fn reaction(m: &Machine, p: &Given, s: &Placed, l: &Rows) -> Q { m.reaction(p, s, l) }
            fn reaction_q(m: &Machine, p: &Given, s: &Placed, l: &Rows) -> [Q; $n] { m.reaction_q(p, s, l) }
            fn energy(m: &Machine, p: &Given, s: &Placed, qd: &Q) -> Energy<f64> { m.energy(p, s, qd) }
            fn powers(
                m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows
            ) -> <Machine as Dynamic<f64, $n, $m>>::Powers {
                m.powers(p, s, qd, z, l)
            }
            fn state_rates(m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows) -> States {
                m.state_rates(p, s, qd, z, l)
            }
            fn loads(
                m: &Machine, p: &Given, s: &Placed, motion: &DynamicState<'_, f64, $n, $m, States>
            ) -> <Machine as Dynamic<f64, $n, $m>>::Loads {
                m.loads(p, s, motion)
            }
            fn gaps(m: &Machine, p: &Given, s: &Placed, qd: &Q) -> f64 {
                let mut sum = 0.0;
                m.gaps(p, s, qd, |Gap { gap, rate, .. }| sum += gap + rate);
                sum
            }
            fn set_valued(m: &Machine, p: &Given, s: &Placed, qd: &Q, z: &States, l: &Rows) -> f64 {
                m.set_valued_rows(p, s, qd, z, l, super::Sum)
            }
            fn events(m: &Machine, p: &Given, s: &Placed, motion: &DynamicState<'_, f64, $n, $m, States>) -> f64 {
                let of = |condition: &Condition<f64>| condition.larger - condition.smaller;
                let all = |event: &Event<f64>| of(&event.begins) + event.ends.as_ref().map_or(0.0, of);
                let mut sum = 0.0;
                m.events(p, s, motion, |events, latched| {
                    sum = events.iter().map(all).sum::<f64>() + latched.iter().sum::<f64>();
                });
                sum
            }
        }
    };
    (@functions $name:ident, $n:literal, $m:literal;
        $(fn $function:ident($($argument:ident: $kind:ty),*) -> $result:ty $body:block)*) => {
        $(
            /// A function as a symbol of its name.
            #[unsafe(export_name = concat!("left_out_", stringify!($name), ".", stringify!($function)))]
            #[inline(never)]
            pub fn $function($($argument: $kind),*) -> $result $body
        )*
    };
}

include!(concat!(env!("OUT_DIR"), "/left_out.rs"));

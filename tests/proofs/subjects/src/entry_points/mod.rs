//! Every function of emitted code, every solver, each by itself.
//!
//! With the feature `no-panic` a function that can panic does not link, and the linker names it.

macro_rules! entry_points {
    ($($(#[$attribute:meta])* fn $name:ident[$($generics:tt)*]($($argument:ident: $kind:ty),* $(,)?) -> $result:ty $(where [$($bounds:tt)*])? $body:block)*) => {
        $(
            $(#[$attribute])*
            #[cfg_attr(feature = "no-panic", no_panic::no_panic)]
            #[inline(never)]
            pub fn $name<$($generics)*>($($argument: $kind),*) -> $result $(where $($bounds)*)? $body
        )*
    };
}

pub mod batch;
pub mod drivers;
pub mod emitted;
pub mod masses;
pub mod simulations;
pub mod solvers;
pub mod tape;

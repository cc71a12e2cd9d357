//! Friction on rigid contacts: sticking, sliding, impacts and paradoxes, against closed forms.
#![forbid(unsafe_code)]

mod blocks;
mod coordinates;
mod cradle;
mod disk;
mod impulses;
mod random;
mod rod;

//! Friction on rigid contacts: sticking, sliding, impacts and paradoxes, against closed forms.
#![forbid(unsafe_code)]

mod blocks;
mod coordinates;
mod cradle;
mod disk;
mod hanging;
mod impulses;
mod random;
mod rod;

//! Steps over impacts and frictions: the method of Moreau and Jean against closed forms and located events.
#![forbid(unsafe_code)]

mod balls;
mod blocks;
mod linkages;
mod rods;

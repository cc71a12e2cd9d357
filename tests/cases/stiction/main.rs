//! Friction that sticks: belts, slopes, blocks on each other and pendulums against closed forms, by every explicit method.
#![forbid(unsafe_code)]

mod belt;
mod blocks;
mod bounces;
mod bristles;
mod contacts;
mod driven;
mod fixed_implicit;
mod implicit;
mod neighbours;
mod pendulum;
mod rests;
mod slope;

//! Change points passed with the crank measured: parallelograms in line, in angles and in natural coordinates.

mod landing;
mod lanes;
mod linkage;
mod plan;
mod runs;
mod turns;

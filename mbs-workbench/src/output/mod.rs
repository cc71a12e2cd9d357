//! Files that the program writes: tables of values, report pages, documents, pictures.

pub mod animation;
pub mod csv;
pub mod latex;
pub mod matrix;
pub mod origin;
pub(crate) mod page;
pub mod places;
pub mod reload;
pub mod report;
pub mod shapes;
pub mod svg;

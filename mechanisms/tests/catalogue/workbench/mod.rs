//! Tests of the workbench on ready mechanisms.

mod basins;
mod catalogue;
mod comparison;
mod drawing;
mod experiment;
mod facade;
mod formulas;
mod freedom;
mod latex;
mod modes;
mod motion;
mod next_position;
mod oracle;
mod picture;
mod powers;
mod settling;

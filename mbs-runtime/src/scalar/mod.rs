//! Number types: single and double precision, lanes of several numbers, sine and cosine.

pub(crate) mod interval;
pub(crate) mod lanes;
pub(crate) mod lengths;
pub(crate) mod number;
#[cfg(test)]
pub(crate) mod sequence;
pub(crate) mod trigonometry;

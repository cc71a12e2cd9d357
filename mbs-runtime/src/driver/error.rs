//! What can be wrong with the data of a driver.

use core::error::Error;
use core::fmt;

/// Why a motion law was not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LawError {
    /// A number of this name is NaN or infinite.
    NotFinite(&'static str),
    /// A number of this name is zero or negative.
    NotPositive(&'static str),
    /// A number of this name is negative.
    Negative(&'static str),
    /// The end or the height of the segment is NaN or infinite, counted from 0.
    SegmentNotFinite(usize),
    /// The segment does not end after it begins, counted from 0.
    SegmentEmpty(usize),
    /// Every segment is a dwell, so that none says at which height.
    NoHeight,
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LawError::NotFinite(name) => write!(f, "the {name} is not a finite number"),
            LawError::NotPositive(name) => write!(f, "the {name} must be above zero"),
            LawError::Negative(name) => write!(f, "the {name} must not be negative"),
            LawError::SegmentNotFinite(segment) => {
                write!(f, "segment {segment}: its end or its height is not a finite number")
            }
            LawError::SegmentEmpty(segment) => write!(f, "segment {segment} does not end after it begins"),
            LawError::NoHeight => f.write_str("every segment is a dwell; one must say at which height"),
        }
    }
}

impl Error for LawError {}

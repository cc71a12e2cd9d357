//! Errors in the data of a driver.

use core::error::Error;
use core::fmt;

/// Errors in the data of a motion law.
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

/// Errors in the data of a spline through or along points. Points and knots are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// Different numbers of abscissae and ordinates.
    Lengths {
        /// Number of abscissae.
        x: usize,
        /// Number of ordinates.
        y: usize,
    },
    /// A coordinate of the point is NaN or infinite.
    PointNotFinite {
        /// Index of the point.
        point: usize,
    },
    /// The abscissa is not above the one before it.
    PointsNotIncreasing {
        /// Index of the later point.
        point: usize,
    },
    /// The abscissa is below the first or above the last knot.
    PointOutside {
        /// Index of the point.
        point: usize,
    },
    /// Fewer points than the spline has degrees of freedom.
    TooFewPoints {
        /// Number of points.
        given: usize,
        /// Number of degrees of freedom.
        needed: usize,
    },
    /// A knot is NaN or infinite.
    KnotNotFinite {
        /// Index of the knot.
        knot: usize,
    },
    /// The knot is not above the one before it.
    KnotsNotIncreasing {
        /// Index of the later knot.
        knot: usize,
    },
    /// Fewer knots than the kind of spline has at least.
    TooFewKnots {
        /// Number of knots.
        given: usize,
        /// Least number of knots.
        needed: usize,
    },
    /// The period is not a finite number above the span of the knots.
    Period,
    /// A prescribed slope is NaN or infinite.
    EndNotFinite,
    /// The points say too little about the spline near the knot (Schoenberg and Whitney's condition).
    Undetermined {
        /// Index of the knot.
        knot: usize,
    },
    /// Rows or pieces are not as many as knots.
    Room,
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FitError::Lengths { x, y } => write!(f, "{x} abscissae, but {y} ordinates"),
            FitError::PointNotFinite { point } => write!(f, "point {point} is not finite"),
            FitError::PointsNotIncreasing { point } => {
                write!(f, "the abscissa of point {point} is not above the one before it")
            }
            FitError::PointOutside { point } => write!(f, "point {point} lies beyond the knots"),
            FitError::TooFewPoints { given, needed } => write!(f, "{given} points, but {needed} are needed"),
            FitError::KnotNotFinite { knot } => write!(f, "knot {knot} is not finite"),
            FitError::KnotsNotIncreasing { knot } => write!(f, "knot {knot} is not above the one before it"),
            FitError::TooFewKnots { given, needed } => write!(f, "{given} knots, but {needed} are needed"),
            FitError::Period => f.write_str("the period must be a finite number above the span of the knots"),
            FitError::EndNotFinite => f.write_str("a slope at an end is not finite"),
            FitError::Undetermined { knot } => {
                write!(f, "the points do not determine the spline near knot {knot}; take fewer knots there")
            }
            FitError::Room => f.write_str("as many rows and pieces as knots are needed"),
        }
    }
}

impl Error for FitError {}

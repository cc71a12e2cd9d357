//! Cams: from a lift law to a profile in closed form, its limits, the least size, and from a measured profile back to the lift.
//!
//! - [`lift`]: laws with exact derivatives.
//! - [`follower`]: the profile that moves a follower by a law.
//! - [`limits`]: bounds of a profile, and the least cam that keeps to them.
//! - [`pitch`]: the pitch curve as a function of a text.
//! - [`measured`]: the lift that a measured profile makes.
//! - [`files`]: files of profiles; [`page`]: the page of `mbs cam`.
//!
//! A cam turns about the origin. Its angle θ counts from the start of the law; lengths are in metres, angles in radians.

use core::error::Error;
use core::fmt;

pub mod bspline;
#[cfg(test)]
mod digits_tests;
pub mod files;
pub mod follower;
pub mod jet;
pub mod lift;
pub mod limits;
pub mod measured;
pub mod noise;
pub mod page;
pub mod pitch;
mod search;
pub mod shapes;
#[cfg(test)]
pub(crate) mod tests;

/// Fault of a law, a follower or a limit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CamError {
    /// Exponents of an even-power law, with the reason.
    Exponents(String),
    /// A quantity of this name has a value that it cannot have, with the reason.
    Value(&'static str, String),
    /// The follower does not reach the cam at this angle (rad).
    OutOfReach(f64),
    /// One limit is broken at every size that was tried.
    Never(&'static str),
    /// Two limits are never kept together: the first needs at least a size, the second at most another (m).
    Contradiction {
        /// Limit that needs a larger cam, and the least size that keeps it.
        larger: (&'static str, f64),
        /// Limit that needs a smaller cam, and the largest size that keeps it.
        smaller: (&'static str, f64),
    },
}

impl fmt::Display for CamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CamError::Exponents(why) => {
                write!(f, "exponents of an even-power law: {why}\nhelp: write them as `even:2,6,8,10,12`")
            }
            CamError::Value(name, why) => write!(f, "{name}: {why}"),
            CamError::OutOfReach(angle) => write!(
                f,
                "the follower does not reach the cam at {:.3} deg\nhelp: a longer arm, a smaller lift, or another pivot",
                angle.to_degrees()
            ),
            CamError::Never(limit) => write!(
                f,
                "no size keeps to the limit on the {limit}\nhelp: relax it, lower the lift, or lengthen the duration"
            ),
            CamError::Contradiction { larger, smaller } => write!(
                f,
                "the limits on {} and {} contradict each other: the first needs at least {:.4} mm, the second at most {:.4} mm\n\
                 help: relax one of both",
                larger.0,
                smaller.0,
                1e3 * larger.1,
                1e3 * smaller.1
            ),
        }
    }
}

impl Error for CamError {}

/// `value` where it is a finite number above 0.
fn positive(name: &'static str, value: f64) -> Result<f64, CamError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(CamError::Value(
            name,
            format!("{value} is not above 0\nhelp: give a number above 0, in SI units"),
        ))
    }
}

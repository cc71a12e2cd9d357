//! Options of `mbs cam`: follower and limits.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::CommandError;
use super::law_options::{LawOptions, angle, in_unit, length, number, usage};
use crate::cams::CamError;
use crate::cams::follower::{Follower, Side};
use crate::cams::lift::Lift;
use crate::cams::limits::{Limits, Load};
use crate::tables::constant;

/// Kind of follower.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kinds {
    /// Flat face on the axis
    Flat,
    /// Roller or round pad on an axis
    Roller,
    /// Flat face on an arm
    OscillatingFlat,
    /// Roller or round pad on an arm
    OscillatingRoller,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sense {
    /// Counter-clockwise
    Ccw,
    /// Clockwise
    Cw,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sides {
    /// Left of the line from the pivot to the cam
    Left,
    /// Right of it
    Right,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sizes {
    /// Base circle
    Base,
    /// Roller or pad
    Pad,
}

/// Options of `mbs cam`.
#[derive(Args)]
pub struct Arguments {
    /// Law: `even:2,6,8,10,12`, `345`, `4567`, `cycloid`, `modified-sine`, `modified-trapezoid`, `harmonic`, `constant-velocity`;
    /// `bspline:FILE` or `bspline:degree 5; knots …; at …`; or a table of the lift over one turn as CSV
    pub law: String,
    /// Kind of follower
    #[arg(long, value_enum)]
    pub follower: Kinds,
    #[command(flatten)]
    pub of_law: LawOptions,
    /// The file is a measured profile about the cam's centre, polar as "deg, mm" or x and y as "mm, mm": find its lift
    #[arg(long, conflicts_with_all = ["lift", "least", "rust", "polydyne"])]
    pub measured: bool,
    /// Radius of the base circle
    #[arg(long, value_name = "17mm", value_parser = length)]
    base: Option<f64>,
    /// Radius of the roller or pad
    #[arg(long, value_name = "8mm", value_parser = length)]
    roller: Option<f64>,
    /// Distance of a roller's axis from the cam's centre [default: 0mm]
    #[arg(long, value_name = "3mm", value_parser = length, allow_hyphen_values = true)]
    offset: Option<f64>,
    /// Pivot of an arm, from the cam's centre
    #[arg(long, value_name = "60mm,10mm", value_parser = point, allow_hyphen_values = true)]
    pivot: Option<[f64; 2]>,
    /// From the pivot to the roller's centre
    #[arg(long, value_name = "55mm", value_parser = length)]
    arm: Option<f64>,
    /// Distance of an oscillating face from its pivot, positive away from the cam [default: 0mm]
    #[arg(long, value_name = "4mm", value_parser = length, allow_hyphen_values = true)]
    face: Option<f64>,
    /// Side of an arm, seen from its pivot
    #[arg(long, value_enum, default_value = "left")]
    side: Sides,
    /// Sense of the cam's rotation
    #[arg(long, value_enum, default_value = "ccw")]
    pub direction: Sense,
    /// Noise of a table of the lift, its whole width: tell that of the acceleration against points and knots
    #[arg(long, value_name = "1um", conflicts_with_all = ["measured", "rust"])]
    noise: Option<String>,
    /// Find the least radius that keeps all limits
    #[arg(long, value_enum)]
    pub least: Option<Sizes>,
    /// Least radius of a convex contour
    #[arg(long, value_name = "2mm", value_parser = length)]
    radius: Option<f64>,
    /// Radius of the grinding wheel, which concave flanks must exceed
    #[arg(long, value_name = "60mm", value_parser = length)]
    wheel: Option<f64>,
    /// Largest pressure angle
    #[arg(long, value_name = "30deg", value_parser = angle)]
    pressure_angle: Option<f64>,
    /// Largest radius of the contour
    #[arg(long, value_name = "40mm", value_parser = length)]
    outer: Option<f64>,
    /// Half the width of a flat face
    #[arg(long, value_name = "16mm", value_parser = length)]
    half_face: Option<f64>,
    /// Largest Hertz pressure; needs `--force` and `--width`
    #[arg(long, value_name = "900MPa", value_parser = pressure, requires = "force", requires = "width")]
    hertz: Option<f64>,
    /// Normal force in the contact
    #[arg(long, value_name = "800N", value_parser = force)]
    force: Option<f64>,
    /// Width of the contact
    #[arg(long, value_name = "12mm", value_parser = length)]
    width: Option<f64>,
    /// Young's modulus of cam and follower
    #[arg(long, value_name = "210GPa", value_parser = pressure, default_value = "210GPa")]
    young: f64,
    /// Poisson's ratio of both
    #[arg(long, value_name = "0.3", value_parser = number, default_value = "0.3")]
    poisson: f64,
    /// Print the polar radius of the pitch curve as a Rust constant of this name, and nothing else
    #[arg(long, value_name = "NAME", value_parser = constant_name)]
    pub rust: Option<String>,
    /// Directory of page, CSV and DXF [default: mbs/cam in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn force(text: &str) -> Result<f64, String> {
    in_unit(text, "N", "800N")
}

fn pressure(text: &str) -> Result<f64, String> {
    in_unit(text, "Pa", "900MPa")
}

fn point(text: &str) -> Result<[f64; 2], String> {
    let (x, y) = text.split_once(',').ok_or("write both coordinates: `60mm,10mm`")?;
    Ok([length(x)?, length(y)?])
}

fn constant_name(text: &str) -> Result<String, String> {
    if constant::is_name(text) {
        Ok(text.to_string())
    } else {
        Err("a constant's name is needed, like `PITCH`".to_string())
    }
}

impl From<CamError> for CommandError {
    fn from(error: CamError) -> Self {
        CommandError::Failed(error.to_string())
    }
}

impl Arguments {
    pub fn turns(&self) -> bool {
        matches!(self.follower, Kinds::OscillatingFlat | Kinds::OscillatingRoller)
    }

    /// Width of the noise in a table of the lift.
    pub fn noise(&self) -> Result<Option<f64>, CommandError> {
        let read = |text: &String| if self.turns() { angle(text) } else { length(text) };
        let width = self.noise.as_ref().map(read).transpose();
        match width.map_err(|why| usage(format!("`--noise`: {why}")))? {
            Some(width) if width <= 0.0 => Err(usage("`--noise` is a width above 0")),
            width => Ok(width),
        }
    }

    pub fn law(&self) -> Result<(Lift, Vec<u8>), CommandError> {
        self.of_law.law(&self.law, self.turns())
    }

    pub fn the_follower(&self) -> Result<Follower, CommandError> {
        let needed = |value: Option<f64>, option: &str| {
            value.ok_or_else(|| {
                usage(format!("this follower needs `{option}`\nhelp: `mbs cam --help` tells its dimensions"))
            })
        };
        let pivot = || self.pivot.ok_or_else(|| usage("an oscillating follower needs `--pivot 60mm,10mm`"));
        // Where the size is sought, any one at which the follower can be built begins.
        let side = if self.side == Sides::Left { Side::Left } else { Side::Right };
        let base = match self.least {
            Some(Sizes::Base) => self.base.unwrap_or(f64::NAN),
            _ => needed(self.base, "--base 17mm")?,
        };
        let radius = || match self.least {
            Some(Sizes::Pad) => Ok(self.roller.unwrap_or(f64::NAN)),
            _ => needed(self.roller, "--roller 8mm"),
        };
        let foreign = |is_given: bool, option: &str| {
            if is_given {
                Err(usage(format!("`{option}` belongs to another follower\nhelp: leave it out")))
            } else {
                Ok(())
            }
        };
        let is_flat = matches!(self.follower, Kinds::Flat | Kinds::OscillatingFlat);
        foreign(self.roller.is_some() && is_flat, "--roller")?;
        foreign(self.half_face.is_some() && !is_flat, "--half-face")?;
        foreign(self.offset.is_some() && self.follower != Kinds::Roller, "--offset")?;
        foreign(self.pivot.is_some() && !self.turns(), "--pivot")?;
        foreign(self.arm.is_some() && self.follower != Kinds::OscillatingRoller, "--arm")?;
        foreign(self.face.is_some() && self.follower != Kinds::OscillatingFlat, "--face")?;
        Ok(match self.follower {
            Kinds::Flat => Follower::Flat { base },
            Kinds::Roller => Follower::Roller { base, radius: radius()?, offset: self.offset.unwrap_or(0.0) },
            Kinds::OscillatingFlat => {
                Follower::OscillatingFlat { base, pivot: pivot()?, face: self.face.unwrap_or(0.0), side }
            }
            Kinds::OscillatingRoller => {
                let arm = needed(self.arm, "--arm 55mm")?;
                Follower::OscillatingRoller { base, pivot: pivot()?, arm, radius: radius()?, side }
            }
        })
    }

    pub fn limits(&self) -> Limits {
        let modulus = Load::contact_modulus([self.young; 2], [self.poisson; 2]);
        let load = self.force.zip(self.width).map(|(force, width)| Load { force, width, modulus });
        Limits {
            radius: self.radius,
            wheel: self.wheel,
            pressure_angle: self.pressure_angle,
            hertz: self.hertz.zip(load),
            half_face: self.half_face,
            outer: self.outer,
        }
    }
}

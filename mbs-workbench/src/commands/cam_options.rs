//! Options of `mbs cam`: follower and limits.

use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

use clap::{Args, Parser, ValueEnum};

use super::CommandError;
use super::chosen::finite;
use super::law_options::{
    GivenLaw, LawOptions, angle, clap_reason, length, positive_angle, positive_in_unit, positive_length,
    usage,
};
use crate::cams::CamError;
use crate::cams::follower::{Direction, Follower, Side};
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
    /// Arm with a roller or pad on the cam, and a pad on the flat end of a valve that opens along -y
    Rocker,
    /// Two rockers on one shaft, the second one by `--closer`: one cam opens the valve, the other one closes it
    Desmodromic,
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

/// Dimensions of a follower.
#[derive(Args, Clone, Debug)]
pub struct Dimensions {
    /// Radius of the base circle, of the contour at lift 0
    #[arg(long, value_name = "17mm", value_parser = positive_length, allow_hyphen_values = true)]
    base: Option<f64>,
    /// Radius of the roller or pad
    #[arg(long, value_name = "8mm", value_parser = positive_length, allow_hyphen_values = true)]
    roller: Option<f64>,
    /// Distance of a roller's axis from the cam's centre [default: 0mm]
    #[arg(long, value_name = "3mm", value_parser = length, allow_hyphen_values = true)]
    offset: Option<f64>,
    /// Pivot of an arm, from the cam's centre
    #[arg(long, value_name = "60mm,10mm", value_parser = point, allow_hyphen_values = true)]
    pivot: Option<[f64; 2]>,
    /// From the pivot to the roller's centre
    #[arg(long, value_name = "55mm", value_parser = positive_length, allow_hyphen_values = true)]
    arm: Option<f64>,
    /// Distance of an oscillating face from its pivot, positive away from the cam [default: 0mm]
    #[arg(long, value_name = "4mm", value_parser = length, allow_hyphen_values = true)]
    face: Option<f64>,
    /// Side of an arm, seen from its pivot
    #[arg(long, value_enum, default_value = "left")]
    side: Sides,
    /// Centre of a rocker's pad on the valve at lift 0, from the cam's centre
    #[arg(long, value_name = "-12mm,-12mm", value_parser = point, allow_hyphen_values = true)]
    valve_pad: Option<[f64; 2]>,
}

/// The second rocker of a pair, in one text.
#[derive(Parser)]
#[command(name = "CLOSER", no_binary_name = true, disable_help_flag = true)]
struct Closer {
    #[command(flatten)]
    dimensions: Dimensions,
}

/// Options of `mbs cam`.
#[derive(Args)]
pub struct Arguments {
    /// Law: `even:2,6,8,10,12`, `345`, `4567`, `cycloid`, `modified-sine`, `modified-trapezoid`, `harmonic`, `constant-velocity`;
    /// `harmonics:4mm, -4mm 0.5mm`; `bspline:FILE` or `bspline:degree 5; knots …; at …`; or a table of the lift over one turn as CSV
    pub law: String,
    /// Kind of follower
    #[arg(long, value_enum)]
    pub follower: Kinds,
    #[command(flatten)]
    pub of_law: LawOptions,
    /// The file is a measured profile about the cam's centre, polar as "deg, mm" or x and y as "mm, mm": find its lift
    #[arg(long, conflicts_with_all = ["lift", "duration", "rise", "dwell", "back", "ramp", "polydyne", "knots", "least",
        "rust", "radius", "wheel", "pressure_angle", "outer", "shaft", "half_face", "hertz"])]
    pub measured: bool,
    #[command(flatten)]
    dimensions: Dimensions,
    /// Dimensions of the rocker that closes the valve
    #[arg(long, value_name = "\"--base 17mm …\"", allow_hyphen_values = true)]
    closer: Option<String>,
    /// Sense of the cam's rotation
    #[arg(long, value_enum, default_value = "ccw")]
    direction: Sense,
    /// Noise of a table of the lift, its whole width: tell that of the acceleration against points and knots
    #[arg(long, value_name = "1um", conflicts_with_all = ["measured", "rust"])]
    noise: Option<String>,
    /// Find the least radius that keeps all limits
    #[arg(long, value_enum)]
    pub least: Option<Sizes>,
    /// Least radius of a convex contour
    #[arg(long, value_name = "2mm", value_parser = positive_length, allow_hyphen_values = true)]
    radius: Option<f64>,
    /// Radius of the grinding wheel, which concave flanks must exceed
    #[arg(long, value_name = "60mm", value_parser = positive_length, allow_hyphen_values = true)]
    wheel: Option<f64>,
    /// Largest pressure angle
    #[arg(long, value_name = "30deg", value_parser = pressure_angle, allow_hyphen_values = true)]
    pressure_angle: Option<f64>,
    /// Largest radius of the contour
    #[arg(long, value_name = "40mm", value_parser = positive_length, allow_hyphen_values = true)]
    outer: Option<f64>,
    /// Radius of the shaft, which the follower stays clear of [default: 0mm, the cam's centre alone]
    #[arg(long, value_name = "9mm", value_parser = radius_of_shaft, allow_hyphen_values = true)]
    shaft: Option<f64>,
    /// Half the width of a flat face
    #[arg(long, value_name = "16mm", value_parser = positive_length, allow_hyphen_values = true)]
    half_face: Option<f64>,
    /// Largest Hertz pressure; needs `--force` and `--width`
    #[arg(long, value_name = "900MPa", value_parser = pressure, requires = "force", requires = "width")]
    hertz: Option<f64>,
    /// Normal force in the contact
    #[arg(long, value_name = "800N", value_parser = force, allow_hyphen_values = true, requires = "hertz")]
    force: Option<f64>,
    /// Width of the contact
    #[arg(long, value_name = "12mm", value_parser = positive_length, allow_hyphen_values = true, requires = "hertz")]
    width: Option<f64>,
    /// Young's modulus of cam and follower
    #[arg(long, value_name = "210GPa", value_parser = pressure, default_value = "210GPa")]
    young: f64,
    /// Poisson's ratio of both
    #[arg(long, value_name = "0.3", value_parser = poisson, default_value = "0.3")]
    poisson: f64,
    /// Print the polar radius of the pitch curve as a Rust constant of this name, and nothing else
    #[arg(long, value_name = "NAME", value_parser = constant_name)]
    pub rust: Option<String>,
    /// Directory of page, CSV and DXF [default: mbs/cam in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn force(text: &str) -> Result<f64, String> {
    positive_in_unit(text, "N", "800N")
}

fn pressure(text: &str) -> Result<f64, String> {
    positive_in_unit(text, "Pa", "900MPa")
}

fn poisson(text: &str) -> Result<f64, String> {
    match finite(text)? {
        ratio if -1.0 < ratio && ratio <= 0.5 => Ok(ratio),
        _ => Err(format!("`{text}` is no Poisson's ratio, which lies between -1 and 0.5")),
    }
}

fn radius_of_shaft(text: &str) -> Result<f64, String> {
    match length(text)? {
        radius if radius >= 0.0 => Ok(radius),
        _ => Err(format!("`{text}` is negative: write it as `9mm`")),
    }
}

fn pressure_angle(text: &str) -> Result<f64, String> {
    match positive_angle(text)? {
        angle if angle < FRAC_PI_2 => Ok(angle),
        _ => Err(format!("`{text}` is not below 90deg, which no pressure angle reaches")),
    }
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

    pub fn law(&self) -> Result<GivenLaw, CommandError> {
        self.of_law.law(&self.law, self.turns())
    }

    pub fn direction(&self) -> Direction {
        if self.direction == Sense::Cw { Direction::Clockwise } else { Direction::CounterClockwise }
    }

    /// Followers with their names: one without, or opener and closer of a pair.
    pub fn followers(&self) -> Result<Vec<(&'static str, Follower)>, CommandError> {
        let is_flat = matches!(self.follower, Kinds::Flat | Kinds::OscillatingFlat);
        foreign(self.half_face.is_some() && !is_flat, "--half-face")?;
        let is_pair = self.follower == Kinds::Desmodromic;
        foreign(self.closer.is_some() && !is_pair, "--closer")?;
        let first = self.dimensions.follower(self.follower, self.least)?;
        if !is_pair {
            return Ok(vec![("", first)]);
        }
        let example = "--closer \"--base 17mm --pivot 23mm,-29mm --arm 29mm --roller 12mm --side right --valve-pad -12mm,-32mm\"";
        let text = self.closer.as_ref().ok_or_else(|| {
            usage(format!("a desmodromic pair needs the rocker that closes\nhelp: say `{example}`"))
        })?;
        let closer = Closer::try_parse_from(text.split_whitespace()).map_err(|error| {
            usage(format!("`--closer`: {}\nhelp: write `{example}`", clap_reason(&error)))
        })?;
        let second = closer.dimensions.follower(self.follower, self.least).map_err(|error| match error {
            CommandError::Usage(why) => usage(format!("`--closer`: {why}")),
            CommandError::Failed(why) => CommandError::Failed(format!("closer: {why}")),
            other => other,
        })?;
        Ok(vec![("opener", first), ("closer", second)])
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
            shaft: self.shaft,
        }
    }
}

fn foreign(is_given: bool, option: &str) -> Result<(), CommandError> {
    if is_given {
        Err(usage(format!("`{option}` belongs to another follower\nhelp: leave it out")))
    } else {
        Ok(())
    }
}

impl Dimensions {
    /// The follower of these dimensions. Where its size is sought, any one of the same arm.
    fn follower(&self, kind: Kinds, least: Option<Sizes>) -> Result<Follower, CommandError> {
        let needed = |value: Option<f64>, option: &str| {
            value.ok_or_else(|| {
                usage(format!("this follower needs `{option}`\nhelp: `mbs cam --help` tells its dimensions"))
            })
        };
        let is_rocker = matches!(kind, Kinds::Rocker | Kinds::Desmodromic);
        let has_arm = is_rocker || kind == Kinds::OscillatingRoller;
        let is_flat = matches!(kind, Kinds::Flat | Kinds::OscillatingFlat);
        foreign(self.roller.is_some() && is_flat, "--roller")?;
        foreign(self.offset.is_some() && kind != Kinds::Roller, "--offset")?;
        foreign(self.pivot.is_some() && !(has_arm || kind == Kinds::OscillatingFlat), "--pivot")?;
        foreign(self.arm.is_some() && !has_arm, "--arm")?;
        foreign(self.face.is_some() && kind != Kinds::OscillatingFlat, "--face")?;
        foreign(self.valve_pad.is_some() && !is_rocker, "--valve-pad")?;
        let pivot = || self.pivot.ok_or_else(|| usage("a follower on an arm needs `--pivot 60mm,10mm`"));
        let side = if self.side == Sides::Left { Side::Left } else { Side::Right };
        let base = || match least {
            Some(Sizes::Base) => Ok(self.base.unwrap_or(f64::NAN)),
            _ => needed(self.base, "--base 17mm"),
        };
        let radius = || match least {
            Some(Sizes::Pad) => Ok(self.roller.unwrap_or(f64::NAN)),
            _ => needed(self.roller, "--roller 8mm"),
        };
        let arm = || needed(self.arm, "--arm 55mm");
        Ok(match kind {
            Kinds::Flat => Follower::Flat { base: base()? },
            Kinds::Roller => {
                Follower::Roller { base: base()?, radius: radius()?, offset: self.offset.unwrap_or(0.0) }
            }
            Kinds::OscillatingFlat => {
                let face = self.face.unwrap_or(0.0);
                Follower::OscillatingFlat { base: base()?, pivot: pivot()?, face, side }
            }
            Kinds::OscillatingRoller => {
                let (base, pivot, arm, radius) = (base()?, pivot()?, arm()?, radius()?);
                Follower::OscillatingRoller { base, pivot, arm, radius, side }
            }
            Kinds::Rocker | Kinds::Desmodromic => {
                let valve_pad =
                    self.valve_pad.ok_or_else(|| usage("a rocker needs `--valve-pad -12mm,-12mm`"))?;
                let (base, pivot, arm, radius) = (base()?, pivot()?, arm()?, radius()?);
                let Some(size) = least else {
                    return Ok(Follower::rocker(base, pivot, arm, radius, side, valve_pad)?);
                };
                // At a right angle, until the size that is sought places it.
                let [x, y] = pivot;
                let apart = x.hypot(y);
                let across = if side == Side::Left { arm / apart } else { -arm / apart };
                let radius = if size == Sizes::Base { radius } else { apart.hypot(arm) - base };
                let cam_pad = [x + across * y, y - across * x];
                Follower::Rocker { pivot, cam_pad, radius, valve_pad }
            }
        })
    }
}

//! A lift law on the command line: a word, and options with its dimensions.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Parser};
use mbs_codegen::quantity;

use super::CommandError;
use super::given_file::unreadable;
use crate::cams::bspline::text;
use crate::cams::lift::{FLANKS, Lift};
use crate::cams::shapes::Harmonics;
use crate::mismatch::nearest;
use crate::tables::{Columns, ReadFault, Spline, SplineKind, close_period, explained, read};

/// Dimensions of a law.
#[derive(Args, Clone, Debug)]
pub struct LawOptions {
    /// Largest lift, of an oscillating follower its angle
    #[arg(long, value_name = "11mm", allow_hyphen_values = true)]
    pub lift: Option<String>,
    /// From rest to rest, of an even-power law
    #[arg(long, value_name = "160deg", value_parser = positive_angle, allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Duration of the rise
    #[arg(long, value_name = "90deg", value_parser = positive_angle, allow_hyphen_values = true)]
    rise: Option<f64>,
    /// Duration of the dwell at full lift [default: 0deg]
    #[arg(long, value_name = "30deg", value_parser = duration_of_dwell, allow_hyphen_values = true)]
    dwell: Option<f64>,
    /// Duration of the return [default: that of the rise]
    #[arg(long = "return", value_name = "90deg", value_parser = positive_angle, allow_hyphen_values = true)]
    back: Option<f64>,
    /// Height and duration of ramps of constant velocity before and after the lift
    #[arg(long, value_name = "0.1mm,15deg", allow_hyphen_values = true)]
    ramp: Option<String>,
    /// Polydyne correction s + c s″, c = m ω²/k
    #[arg(long, value_name = "C", value_parser = positive_number, allow_hyphen_values = true)]
    polydyne: Option<f64>,
    /// Units of the columns of a table [default: those in the header]
    #[arg(long, value_name = "\"deg, mm\"", value_parser = Columns::parse, allow_hyphen_values = true)]
    pub columns: Option<Columns>,
    /// Knots of a least-squares fit to a table [default: through every point]
    #[arg(long, value_name = "N", value_parser = super::positive)]
    knots: Option<usize>,
}

/// A law with its origin.
pub struct GivenLaw {
    pub lift: Lift,
    /// Bytes that it was read from.
    pub source: Vec<u8>,
    /// File, number of points and of knots of a table; none of a law in words.
    pub table: Option<String>,
    /// The law in words, or the name of its file without folders.
    pub name: String,
}

/// The name of a file without folders.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or_else(|| path.into(), |name| name.to_string_lossy()).into_owned()
}

/// A table by the name of its file, without folders, and the number of its points.
pub fn named_table(path: &str, points: usize) -> String {
    format!("table {}, {points} points", file_name(path))
}

/// `true` if a B-spline is written itself, not the file that has it.
fn is_bspline_itself(text: &str) -> bool {
    text.contains([';', ' '])
}

/// A law with its options in one text.
#[derive(Parser)]
#[command(name = "LAW", no_binary_name = true, disable_help_flag = true)]
struct Written {
    law: String,
    #[command(flatten)]
    options: LawOptions,
}

/// A lift law in one text, as `4567 --lift 8mm --rise 75deg` or `lift.csv`: the words of `mbs cam`.
///
/// # Errors
/// [`CommandError`] with the option that is missing or wrong.
pub fn written(text: &str) -> Result<GivenLaw, CommandError> {
    written_for(text, false)
}

/// `true` if a text begins with the word of a law.
pub fn is_law(text: &str) -> bool {
    let word = text.split_whitespace().next().unwrap_or_default();
    ["even:", "harmonics:", "bspline:"].iter().any(|start| word.starts_with(start))
        || FLANKS.iter().any(|(name, _)| *name == word)
}

/// The law that is nearly written so.
pub fn near_law(text: &str) -> Option<&'static str> {
    let word = text.split_whitespace().next().unwrap_or_default();
    nearest(word, FLANKS.iter().map(|(name, _)| *name))
}

/// Options between backticks.
fn listed(options: &[&str]) -> String {
    options.iter().map(|option| format!("`{option}`")).collect::<Vec<_>>().join(", ")
}

/// The words of laws.
pub fn laws() -> String {
    FLANKS
        .iter()
        .map(|(name, _)| *name)
        .chain(["even:2,6,8,10,12", "harmonics:…", "bspline:…"])
        .collect::<Vec<_>>()
        .join(", ")
}

/// [`written`], of an angle where `turns`.
pub fn written_for(text: &str, turns: bool) -> Result<GivenLaw, CommandError> {
    // Harmonics and B-splines have spaces of their own.
    let words: Vec<&str> = match ["bspline:", "harmonics:"].iter().any(|word| text.starts_with(word)) {
        true => vec![text],
        false => text.split_whitespace().collect(),
    };
    if words.is_empty() {
        return Err(usage(format!("no law is written\nhelp: laws are {}, or a table `FILE.csv`", laws())));
    }
    let read = Written::try_parse_from(words).map_err(|error| usage(clap_reason(&error)))?;
    read.options.law(&read.law, turns)
}

pub fn in_unit(text: &str, unit: &str, example: &str) -> Result<f64, String> {
    let found = quantity(text.trim()).map_err(|(message, help)| format!("{message}; {help}"))?;
    if found.unit.is_none() && found.value != 0.0 {
        return Err(format!("a unit is needed, as in `{example}`"));
    }
    let fits = found.fits(unit) && found.value.is_finite();
    if fits { Ok(found.value) } else { Err(format!("a quantity like `{example}` is needed")) }
}

pub fn length(text: &str) -> Result<f64, String> {
    in_unit(text, "m", "12mm")
}

pub fn angle(text: &str) -> Result<f64, String> {
    in_unit(text, "rad", "30deg")
}

fn above_zero(value: f64, text: &str, example: &str) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("`{text}` is not above 0: write it as `{example}`")) }
}

/// A quantity above 0.
pub fn positive_in_unit(text: &str, unit: &str, example: &str) -> Result<f64, String> {
    above_zero(in_unit(text, unit, example)?, text, example)
}

pub fn positive_length(text: &str) -> Result<f64, String> {
    positive_in_unit(text, "m", "12mm")
}

pub fn positive_angle(text: &str) -> Result<f64, String> {
    positive_in_unit(text, "rad", "30deg")
}

pub fn positive_number(text: &str) -> Result<f64, String> {
    above_zero(super::chosen::finite(text)?, text, "0.05")
}

fn duration_of_dwell(text: &str) -> Result<f64, String> {
    match angle(text)? {
        dwell if dwell >= 0.0 => Ok(dwell),
        _ => Err(format!("`{text}` is negative: a dwell lasts 0deg or longer")),
    }
}

/// The first line of a message of the command line, with the proposal that follows it.
pub fn clap_reason(error: &clap::Error) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_string();
    let tip = text.lines().find_map(|line| line.trim().strip_prefix("tip: "));
    tip.map_or(first.clone(), |tip| format!("{first}\nhelp: {tip}"))
}

pub fn usage(message: impl Into<String>) -> CommandError {
    CommandError::Usage(message.into())
}

impl LawOptions {
    /// The largest lift in SI; an angle for an arm, a length elsewhere.
    pub fn height(&self, turns: bool) -> Result<f64, CommandError> {
        let text = self.lift.as_deref().ok_or_else(|| {
            usage(format!(
                "a law needs its lift\nhelp: say `--lift {}`",
                if turns { "18deg" } else { "11mm" }
            ))
        })?;
        let read = if turns { positive_angle(text) } else { positive_length(text) };
        read.map_err(|why| {
            let of = if turns {
                "the lift of an oscillating follower is the angle of its arm"
            } else {
                "the lift is a length"
            };
            usage(format!("`--lift {text}`: {of}; {why}"))
        })
    }

    /// The law that `word` names; `turns`: of an angle.
    ///
    /// # Errors
    /// [`CommandError`] with the option that is missing or wrong.
    pub fn law(&self, word: &str, turns: bool) -> Result<GivenLaw, CommandError> {
        self.require_own(word)?;
        let needed = |value: Option<f64>, option: &str| {
            value.ok_or_else(|| usage(format!("the law `{word}` needs `{option}`")))
        };
        let lift = if let Some(list) = word.strip_prefix("even:") {
            let read: Result<Vec<u32>, _> = list.split(',').map(|p| p.trim().parse::<u32>()).collect();
            let exponents = read
                .map_err(|_| usage(format!("`{list}` are no exponents\nhelp: write `even:2,6,8,10,12`")))?;
            Lift::hump(&exponents, self.height(turns)?, needed(self.duration, "--duration 160deg")?)?
        } else if let Some((_, flank)) = FLANKS.iter().find(|(name, _)| *name == word) {
            let rise = needed(self.rise, "--rise 90deg")?;
            Lift::flanks(
                *flank,
                self.height(turns)?,
                [rise, self.dwell.unwrap_or(0.0), self.back.unwrap_or(rise)],
            )?
        } else if let Some(list) = word.strip_prefix("harmonics:") {
            Lift::harmonics(self.harmonics(list, turns)?)
        } else if let Some(text) = word.strip_prefix("bspline:") {
            Lift::bspline(text::parse(&self.bspline(text)?, turns)?)?
        } else {
            return self.table(word, turns);
        };
        let lift = match &self.ramp {
            None => lift,
            Some(text) => {
                let example = if turns { "0.2deg,15deg" } else { "0.1mm,15deg" };
                let wrong =
                    |why: String| usage(format!("`--ramp {text}`: {why}\nhelp: write `--ramp {example}`"));
                let (height, duration) = text
                    .split_once(',')
                    .ok_or_else(|| wrong("height and duration are needed".to_string()))?;
                let height = if turns { positive_angle(height) } else { positive_length(height) };
                lift.with_ramps(height.map_err(wrong)?, positive_angle(duration).map_err(wrong)?)?
            }
        };
        // A law is no path, though it may have a `/` in its units.
        let name = match word.strip_prefix("bspline:").filter(|text| !is_bspline_itself(text)) {
            Some(file) => format!("bspline:{}", file_name(file)),
            None => word.to_string(),
        };
        Ok(GivenLaw { lift: self.corrected(lift)?, source: word.as_bytes().to_vec(), table: None, name })
    }

    /// Refuses options of another law: none is left aside silently.
    fn require_own(&self, word: &str) -> Result<(), CommandError> {
        let is_flank = FLANKS.iter().any(|(name, _)| *name == word);
        let (kind, own): (&str, &[&str]) = match word.split_once(':').map(|(start, _)| start) {
            Some("even") => ("an even-power law", &["--lift", "--duration", "--ramp"]),
            Some("harmonics") => ("a law of harmonics", &["--lift"]),
            Some("bspline") => ("a B-spline", &["--lift", "--ramp"]),
            _ if is_flank => ("this law", &["--lift", "--rise", "--dwell", "--return", "--ramp"]),
            _ => ("a table", &["--columns", "--knots"]),
        };
        let given = [
            (self.lift.is_some(), "--lift"),
            (self.duration.is_some(), "--duration"),
            (self.rise.is_some(), "--rise"),
            (self.dwell.is_some(), "--dwell"),
            (self.back.is_some(), "--return"),
            (self.ramp.is_some(), "--ramp"),
            (self.columns.is_some(), "--columns"),
            (self.knots.is_some(), "--knots"),
        ];
        match given.into_iter().find(|(is_given, option)| *is_given && !own.contains(option)) {
            // A word that is no law is told so.
            Some((_, option)) if kind != "a table" || Path::new(word).extension().is_some() => {
                let help = format!("leave it out; {kind} has {}, `--polydyne`", listed(own));
                Err(usage(format!("`{option}` belongs to another law than `{word}`\nhelp: {help}")))
            }
            _ => Ok(()),
        }
    }

    /// The mean, then cosine and sine of each harmonic; a sine that is left out is 0.
    fn harmonics(&self, list: &str, turns: bool) -> Result<Harmonics, CommandError> {
        let example =
            if turns { "harmonics:9deg, -8deg 1deg, -1deg" } else { "harmonics:4mm, -4mm 0.5mm, -0.5mm" };
        let wrong = |why: String| {
            usage(format!(
                "harmonics: {why}\nhelp: write the mean, then cosine and sine of each, as `{example}`"
            ))
        };
        if self.lift.is_some() {
            return Err(usage("the amplitudes of harmonics have their lift\nhelp: leave out `--lift`"));
        }
        let read = |text: &str| {
            let read = if turns { angle(text) } else { length(text) };
            read.map_err(|why| wrong(format!("`{text}`: {why}")))
        };
        let (mean, rest) =
            list.split_once(',').ok_or_else(|| wrong("one amplitude is needed".to_string()))?;
        let mut amplitudes = Vec::new();
        for one in rest.split(',') {
            match one.split_whitespace().collect::<Vec<_>>()[..] {
                [cosine] => amplitudes.push([read(cosine)?, 0.0]),
                [cosine, sine] => amplitudes.push([read(cosine)?, read(sine)?]),
                _ => return Err(wrong(format!("`{}` is no cosine and sine", one.trim()))),
            }
        }
        Ok(Harmonics::new(read(mean.trim())?, &amplitudes)?)
    }

    /// The text of a B-spline law, of the command line or in a file.
    fn bspline(&self, text: &str) -> Result<String, CommandError> {
        if self.lift.is_some() {
            return Err(usage("the constraints of a B-spline have its lift\nhelp: leave out `--lift`"));
        }
        if is_bspline_itself(text) {
            return Ok(text.to_string());
        }
        let named = |why: String| CommandError::Failed(format!("{text}: {why}"));
        fs::read_to_string(text).map_err(|error| {
            let help = "name a file, or write the law itself as `bspline:degree 5; knots …; at …`";
            named(unreadable(Path::new(text), &error, help))
        })
    }

    fn corrected(&self, lift: Lift) -> Result<Lift, CommandError> {
        Ok(match self.polydyne {
            None => lift,
            Some(c) => lift.with_polydyne(c)?,
        })
    }

    /// A lift from a file.
    fn table(&self, word: &str, turns: bool) -> Result<GivenLaw, CommandError> {
        let path = PathBuf::from(word);
        if path.extension().is_none() {
            let hint = near_law(word)
                .map_or_else(|| format!("laws are {}", laws()), |name| format!("did you mean `{name}`?"));
            return Err(usage(format!("`{word}` is no law and no file\nhelp: {hint}")));
        }
        let named = |message: String| CommandError::Failed(format!("{word}: {message}"));
        let bytes = fs::read(&path).map_err(|error| {
            let help = format!("name a CSV file of the lift over one turn, or a law: {}", laws());
            named(unreadable(&path, &error, &help))
        })?;
        let mut points = read(&bytes, self.columns.as_ref()).map_err(|fault| named(fault.to_string()))?;
        let (across, up) = (&points.columns.x.1, &points.columns.y.1);
        let expected = if turns { "rad" } else { "m" };
        if across.coherent != "rad" || up.coherent != expected {
            let why = format!(
                "a lift in {} over an angle is needed, not {} over {}",
                expected, up.name, across.name
            );
            let columns = if turns { "deg, deg" } else { "deg, mm" };
            return Err(named(format!("{why}\nhelp: name the columns, as `--columns \"{columns}\"`")));
        }
        let knots = self.knots.map_or_else(String::new, |knots| format!(", a fit with {knots} knots"));
        let table = named_table(word, points.x.len()) + &knots;
        let period = core::f64::consts::TAU;
        close_period(&mut points, period).map_err(|fault| {
            let cure =
                "write the lift over one turn, the last line a step before the first one or equal to it";
            named(ReadFault { cure: cure.to_string(), ..fault }.to_string())
        })?;
        let spline = Spline::fit(&points.x, &points.y, SplineKind::PeriodicQuintic(period), self.knots);
        let spline = spline.map_err(|error| named(explained(error, &points).to_string()))?;
        let name = file_name(word);
        Ok(GivenLaw { lift: self.corrected(Lift::table(spline)?)?, source: bytes, table: Some(table), name })
    }
}

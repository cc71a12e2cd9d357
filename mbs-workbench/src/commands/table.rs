//! `mbs table`.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use crate::output::origin::Origin;
use crate::tables::knots::{Advice, Estimate};
use crate::tables::{
    Columns, Points, ReadFault, SEED, Spline, SplineKind, chart, close_period, constant, read, sample,
};
use crate::target_directory::target_directory;
use clap::Args;
use mbs_runtime::driver::{End, FitError};
use serde_json::json;

use super::CommandError;
use super::chosen::{finite, require_named, svg_file, write_file};
use super::document::Output;
use super::given_file::unreadable;

#[derive(Args)]
pub struct Arguments {
    /// Table of numbers as CSV: comma, semicolon or tab; `#` begins a comment
    #[arg(required_unless_present = "sample")]
    file: Option<PathBuf>,
    /// Units of the columns, `-` for one that is not read [default: those in the header]
    #[arg(long, value_name = "\"deg, mm\"", value_parser = Columns::parse, allow_hyphen_values = true)]
    columns: Option<Columns>,
    /// The table repeats after a turn: a periodic quintic spline instead of a cubic one
    #[arg(long)]
    periodic: bool,
    /// The table repeats after this, in the unit of its first column
    #[arg(long, value_name = "P", value_parser = positive_number)]
    period: Option<f64>,
    /// Evenly spaced knots of a fit by least squares [default: through every point]
    #[arg(long, value_name = "N", value_parser = super::positive)]
    knots: Option<usize>,
    /// Slopes at both ends of a cubic spline, in SI [default: natural ends]
    #[arg(long, value_name = "A,B", value_parser = slopes, allow_hyphen_values = true, conflicts_with_all = ["periodic", "period"])]
    slopes: Option<[f64; 2]>,
    /// Print the spline as a Rust constant of this name, and nothing else
    #[arg(long, value_name = "NAME", value_parser = constant_name)]
    rust: Option<String>,
    /// File of the picture [default: mbs/table/FILE.svg in cargo's target directory]
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file)]
    out: Option<PathBuf>,
    /// Print a table to try this on, and nothing else
    #[arg(long, conflicts_with_all = ["file", "rust"])]
    sample: bool,
}

fn positive_number(text: &str) -> Result<f64, String> {
    finite(text)
        .and_then(|number| if number > 0.0 { Ok(number) } else { Err("it must be above 0".to_string()) })
}

fn slopes(text: &str) -> Result<[f64; 2], String> {
    let (first, last) = text.split_once(',').ok_or("write two slopes: `--slopes 0,0`")?;
    Ok([finite(first)?, finite(last)?])
}

fn constant_name(text: &str) -> Result<String, String> {
    if constant::is_name(text) {
        Ok(text.to_string())
    } else {
        Err("a constant's name is needed, like `LIFT`".to_string())
    }
}

/// Fits a spline to a table: prints residual and noise and draws a picture, or prints the spline as Rust.
pub fn run(arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    require_named(arguments.out.as_ref())?;
    let Some(file) = &arguments.file else {
        let text = sample::valve_lift().map_err(|error| CommandError::Failed(error.to_string()))?;
        out.put("sample", &text);
        return Ok(out.write_all(text.as_bytes())?);
    };
    let named = |message: String| CommandError::Failed(format!("{}: {message}", file.display()));
    let help = "name a CSV file of two columns; `mbs table` without a file prints a sample";
    let bytes = fs::read(file).map_err(|error| named(unreadable(file, &error, help)))?;
    let faulty = |fault: ReadFault| named(fault.to_string());
    let mut points = read(&bytes, arguments.columns.as_ref()).map_err(faulty)?;
    let kind = kind(arguments, &points)?;
    let mut repeated = false;
    if let SplineKind::PeriodicQuintic(period) = kind {
        repeated = close_period(&mut points, period).map_err(faulty)?;
    }
    let fitted = Spline::fit(&points.x, &points.y, kind, arguments.knots).and_then(|spline| {
        let gain = spline.noise_gain(&points.x, kind)?;
        Ok((spline, gain))
    });
    let (spline, gain) = fitted.map_err(|error| named(explain(error, &points)))?;
    let source = file.file_name().map_or_else(|| "table".into(), |name| name.to_string_lossy().into_owned());
    if let Some(name) = &arguments.rust {
        let (largest, ..) = spline.residual(&points.x, &points.y);
        let code = constant::rust(name, &source, &points, &spline, largest);
        out.put("code", &code);
        return Ok(out.write_all(code.as_bytes())?);
    }
    let origin = Origin::of_table(&source, &bytes);
    out.put("table", json!({ "path": file.display().to_string(), "hash": origin.hash }));
    let picture = arguments
        .out
        .clone()
        .unwrap_or_else(|| target_directory().join("mbs").join("table").join(&source).with_extension("svg"));
    // Written before the lines: printing fails if the reader of the output has left.
    let written = write_file(&picture, &origin.svg(&chart::svg(&points, &spline)));
    describe_in(out, &points, &spline, kind, gain);
    write_summary(out, &points, &spline, kind, repeated)?;
    let interpolated =
        Spline::fit(&points.x, &points.y, kind, None).and_then(|s| s.noise_gain(&points.x, kind));
    let second = points.columns.y.1.derivative(&points.columns.x.1, 2);
    writeln!(
        out,
        "noise     1e-6 {} in each point is {:.2e} {second} in the second derivative",
        points.columns.y.1.coherent,
        1e-6 * gain
    )?;
    if let (Some(_), Ok(interpolated)) = (arguments.knots, interpolated) {
        writeln!(out, "          {:.1} times less than through every point", interpolated / gain)?;
    }
    if let Ok(Some(advice)) = Advice::of(&points, kind) {
        advise(out, &points, &advice, arguments.knots)?;
    }
    written?;
    out.put_file("picture", &picture);
    writeln!(out, "picture   {}", picture.display())?;
    Ok(())
}

fn kind(arguments: &Arguments, points: &Points) -> Result<SplineKind, CommandError> {
    let unit = &points.columns.x.1;
    match (arguments.period, arguments.periodic) {
        (Some(period), _) => Ok(SplineKind::PeriodicQuintic(period * unit.factor)),
        (None, true) => unit.turn().map(SplineKind::PeriodicQuintic).ok_or_else(|| {
            CommandError::Usage(format!(
                "a turn is no period of a column in {}\nhelp: say `--period`, in {0}",
                unit.name
            ))
        }),
        (None, false) => {
            Ok(SplineKind::Cubic(arguments.slopes.map_or([End::Natural; 2], |slopes| slopes.map(End::Slope))))
        }
    }
}

/// The number of knots at which the second derivative is best, as estimated from the table.
fn advise(
    out: &mut Output,
    points: &Points,
    advice: &Advice,
    knots: Option<usize>,
) -> Result<(), CommandError> {
    let Some(best) = advice.best() else { return Ok(()) };
    let estimate = |one: &Estimate| json!({ "knots": one.knots, "noise": one.noise, "loss": one.loss, "error": one.error() });
    out.put(
        "advice",
        json!({
            "knots": best.knots, "deviation": advice.deviation,
            "estimates": advice.estimates.iter().map(estimate).collect::<Vec<_>>(),
        }),
    );
    let (across, up) = (&points.columns.x.1, &points.columns.y.1);
    let second = up.derivative(across, 2);
    writeln!(
        out,
        "advice    {}: the points deviate by {:.1e} {}, the second derivative then by {:.1e} {second}",
        if knots == Some(best.knots) {
            "keep these knots".to_string()
        } else {
            format!("--knots {}", best.knots)
        },
        advice.deviation,
        up.coherent,
        best.error()
    )?;
    let others = advice.estimates.iter().filter(|one| one.knots != best.knots);
    let near = others.filter(|one| one.knots.max(best.knots) <= 2 * one.knots.min(best.knots));
    for one in near {
        writeln!(
            out,
            "          {:>4} knots: {:.1e} (noise {:.1e}, smoothing {:.1e})",
            one.knots,
            one.error(),
            one.noise,
            one.loss
        )?;
    }
    Ok(())
}

/// Points, spline, residual and noise as data, in SI.
fn describe_in(out: &mut Output, points: &Points, spline: &Spline, kind: SplineKind, gain: f64) {
    let (largest, mean, place) = spline.residual(&points.x, &points.y);
    let columns = [&points.columns.x.1, &points.columns.y.1];
    let columns: Vec<_> = points.names.iter().zip(columns).collect();
    let column = |(name, unit): &(&String, &crate::tables::Unit)| json!({ "name": name, "unit": unit.name, "factor": unit.factor });
    out.put("columns", columns.iter().map(column).collect::<Vec<_>>());
    out.put("points", points.x.len());
    out.put("knots", spline.knots.len());
    out.put("spline", if matches!(kind, SplineKind::Cubic(_)) { "cubic" } else { "periodic quintic" });
    out.put("largest_residual", json!({ "value": largest, "line": points.lines[place] }));
    out.put("mean_residual", mean);
    out.put("noise_gain", gain);
    out.put("seed", SEED);
}

fn write_summary(
    out: &mut dyn Write,
    points: &Points,
    spline: &Spline,
    kind: SplineKind,
    repeated: bool,
) -> std::io::Result<()> {
    let (across, up) = (&points.columns.x.1, &points.columns.y.1);
    let [x, y] = &points.names;
    let [low, high] = [points.x[0], points.x[points.x.len() - 1]].map(|x| x / across.factor);
    let extra = if repeated { "; the last line repeats the first" } else { "" };
    writeln!(
        out,
        "points    {}: {y} ({}) over {x}, {low:.6} to {high:.6} {}{extra}",
        points.x.len(),
        up.name,
        across.name
    )?;
    let (degree, smooth) = match kind {
        SplineKind::Cubic(_) => ("cubic", 2),
        SplineKind::PeriodicQuintic(_) => ("periodic quintic", 4),
    };
    writeln!(out, "spline    {degree}, {} knots, {smooth} continuous derivatives", spline.knots.len())?;
    let (largest, mean, place) = spline.residual(&points.x, &points.y);
    writeln!(
        out,
        "residual  at most {largest:.2e} {} (line {}), root mean square {mean:.2e} {0}",
        up.coherent, points.lines[place]
    )
}

/// Message of a failed fit, with the line of the file and a cure.
fn explain(error: FitError, points: &Points) -> String {
    let column = &points.columns.x;
    let at = |point: usize| points.lines.get(point).copied().unwrap_or(0);
    let fault = |line: usize, cure: &str| {
        ReadFault { line, column: column.0 + 1, message: error.to_string(), cure: cure.to_string() }
            .to_string()
    };
    match error {
        FitError::TooFewPoints { given, .. } => fault(0, &format!("say `--knots {given}` at most")),
        FitError::TooFewKnots { needed, .. } => fault(0, &format!("{needed} points and knots are the least")),
        FitError::PointsNotIncreasing { point }
        | FitError::PointOutside { point }
        | FitError::PointNotFinite { point } => fault(at(point), "correct the line"),
        FitError::Undetermined { .. } => fault(0, "fewer `--knots`, or more points where there are few"),
        _ => fault(0, "check the table and the period"),
    }
}

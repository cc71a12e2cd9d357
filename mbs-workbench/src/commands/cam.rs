//! `mbs cam`.

use std::fs;
use std::io::Write;
use std::path::Path;

use mbs_runtime::driver::SMOOTH;
use serde_json::{Value, json};

use super::CommandError;
pub use super::cam_options::Arguments;
use super::cam_options::Sizes;
use super::chosen::write_file;
use super::document::Output;
use super::given_file::unreadable;
use super::law_options::GivenLaw;
use super::report_files::require_writable;
use crate::cams::files::{csv, dxf, rust, svg, turn};
use crate::cams::follower::{Cam, Direction, Follower};
use crate::cams::lift::Lift;
use crate::cams::limits::{Least, Size, Verdict, examine, least_size};
use crate::cams::measured::Profile;
use crate::cams::{noise, page};
use crate::output::origin::Origin;
use crate::tables::read_unordered;
use crate::target_directory::target_directory;

/// Value and bound of a limit as the table shows them.
fn shown(name: &str, value: f64) -> String {
    if !value.is_finite() {
        return "-".to_string();
    }
    match name {
        "pressure angle" => format!("{:.4} deg", value.to_degrees()),
        "Hertz pressure" => format!("{:.2} MPa", 1e-6 * value),
        // Next to a place where a face stands still radii have no bound.
        _ if value.abs() >= 1e3 => format!("{:.3e} mm", 1e3 * value),
        _ => format!("{:.5} mm", 1e3 * value),
    }
}

/// A cam with its limits. Opener and closer of a pair have names.
struct Made {
    name: &'static str,
    cam: Cam,
    verdicts: Vec<Verdict>,
    least: Option<Least>,
}

impl Made {
    fn of(
        arguments: &Arguments,
        lift: &Lift,
        (name, follower): (&'static str, Follower),
        direction: Direction,
    ) -> Result<Self, CommandError> {
        let limits = arguments.limits();
        let Some(size) = arguments.least else {
            let cam = Cam::new(lift.clone(), follower, direction)?;
            let verdicts = examine(&cam, &limits);
            return Ok(Made { name, cam, verdicts, least: None });
        };
        let size = if size == Sizes::Base { Size::Base } else { Size::Pad };
        // From a tenth to a hundred times what the follower moves, or is away.
        let scale = follower.pivot().map_or_else(
            || arguments.of_law.height(arguments.turns()).unwrap_or(0.01),
            |[x, y]| 0.5 * x.hypot(y),
        );
        let cam = Cam { lift: lift.clone(), follower, direction };
        let found = least_size(&cam, &limits, size, [0.03 * scale, 100.0 * scale])?;
        let (cam, verdicts) = (found.cam.clone(), found.verdicts.clone());
        Ok(Made { name, cam, verdicts, least: Some(found) })
    }
}

/// All cams of the command. The cams of a pair work against each other.
fn cams(arguments: &Arguments, lift: &Lift) -> Result<Vec<Made>, CommandError> {
    let direction = arguments.direction();
    let followers = arguments.followers()?;
    let made = |follower: (&'static str, Follower)| {
        Made::of(arguments, lift, follower, direction).map_err(|error| match error {
            CommandError::Failed(why) if !follower.0.is_empty() => {
                CommandError::Failed(format!("{}: {why}", follower.0))
            }
            other => other,
        })
    };
    let all = followers.into_iter().map(made).collect::<Result<Vec<_>, _>>()?;
    for (one, opens) in all.iter().zip([true, false]) {
        if all.len() == 2 && one.cam.opens() != Some(opens) {
            let does = if opens { "closes" } else { "opens" };
            return Err(CommandError::Failed(format!(
                "{}: its cam {does} the valve\nhelp: put its pad on the other `--side`, or its valve pad on the other side of the pivot",
                one.name
            )));
        }
    }
    Ok(all)
}

/// Makes the profile of a cam, says where limits are broken, writes page, CSV and DXF, or prints a Rust constant.
pub fn run(arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let directory = arguments.out.clone().unwrap_or_else(|| target_directory().join("mbs").join("cam"));
    if arguments.rust.is_none() {
        require_writable(&directory)?;
    }
    if arguments.measured {
        return recover(arguments, &directory, out);
    }
    let GivenLaw { lift, source, table, name } = arguments.law()?;
    let all = cams(arguments, &lift)?;
    let limits = arguments.limits();
    let places: Vec<_> = all.iter().map(|one| turn(&one.cam, 720)).collect();
    if let Some(constant) = &arguments.rust {
        let mut code = String::new();
        for (one, places) in all.iter().zip(&places) {
            let suffix = one.name.to_uppercase();
            let constant = if suffix.is_empty() { constant.clone() } else { format!("{constant}_{suffix}") };
            code += &rust(&constant, &name, &one.cam, places).map_err(CommandError::Failed)?;
        }
        out.put("code", &code);
        return Ok(out.write_all(code.as_bytes())?);
    }
    let origin = match table {
        Some(_) => Origin::of_table(&name, &source),
        None => Origin::of_law(&name, &source),
    };
    let sentences: Vec<String> = all.iter().map(|one| sentence(arguments, one)).collect();
    let of_table = table.iter().map(|table| format!("Lift law: {table}."));
    let sentence = sentences.iter().cloned().chain(of_table).collect::<Vec<_>>().join(" ");
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--json").collect();
    let quoted = |word: &String| if word.contains(' ') { format!("'{word}'") } else { word.clone() };
    let command = format!("mbs {}", words.iter().map(quoted).collect::<Vec<_>>().join(" "));
    let parts: Vec<page::Part<'_>> = all
        .iter()
        .zip(&places)
        .map(|(one, places)| page::Part { name: one.name, cam: &one.cam, places, verdicts: &one.verdicts })
        .collect();
    let mut data = page::data(&format!("Cam {name}"), &sentence, &command, &limits, &parts);
    let noise = arguments.noise()?.map(|width| noise::study(&lift, width)).transpose();
    let noise = noise.map_err(|error| CommandError::Failed(error.to_string()))?;
    data["noise"] = noise.as_ref().map(page::noise).into();
    let mut files = vec![("page", "cam.html".to_string(), page::html(&data, &origin.line()))];
    for (one, places) in all.iter().zip(&places) {
        let stem = if one.name.is_empty() { "profile" } else { one.name };
        let file = |ending: &str| format!("{stem}.{ending}");
        files.push(("profile", file("csv"), origin.csv(&csv(places, &one.cam.follower))));
        files.push(("drawing", file("dxf"), dxf(places)));
    }
    let contours: Vec<_> =
        all.iter().zip(&places).map(|(one, places)| (places.as_slice(), one.cam.follower.base())).collect();
    files.push(("picture", "profile.svg".to_string(), origin.svg(&svg(&contours))));
    for (kind, file, text) in &files {
        let path = directory.join(file);
        write_file(&path, text)?;
        out.put_file(kind, &path);
    }
    describe(out, &all, &sentences);
    out.put("table", &table);
    print_law(out, &lift, table.as_deref(), arguments.turns(), &sentences)?;
    for one in &all {
        print_limits(out, one)?;
    }
    if let Some(study) = &noise {
        out.put("noise", page::noise(study));
        print_noise(out, study, arguments.turns())?;
    }
    let names: Vec<&str> = files.iter().map(|(_, file, _)| file.as_str()).collect();
    writeln!(out, "files        {}: {}", directory.display(), names.join(", "))?;
    Ok(())
}

/// The lift of a measured profile, as a table.
fn recover(arguments: &Arguments, directory: &Path, out: &mut Output) -> Result<(), CommandError> {
    let followers = arguments.followers()?;
    let [(_, follower)] = followers.as_slice() else {
        let why =
            "a measured profile has one follower\nhelp: read each cam of a pair with `--follower rocker`";
        return Err(CommandError::Usage(why.to_string()));
    };
    let named = |message: String| CommandError::Failed(format!("{}: {message}", arguments.law));
    let bytes = fs::read(&arguments.law).map_err(|error| {
        let help = "name a CSV file of the profile, polar as `deg, mm` or x and y as `mm, mm`";
        named(unreadable(Path::new(&arguments.law), &error, help))
    })?;
    let points = read_unordered(&bytes, arguments.of_law.columns.as_ref())
        .map_err(|fault| named(fault.to_string()))?;
    let pairs: Vec<[f64; 2]> = points.x.iter().zip(&points.y).map(|(x, y)| [*x, *y]).collect();
    let profile = match [&points.columns.x.1, &points.columns.y.1].map(|unit| unit.coherent.as_str()) {
        ["rad", "m"] => Profile::polar(&pairs),
        ["m", "m"] => Profile::cartesian(&pairs),
        _ => {
            let why = "a profile has an angle and a radius, or x and y\nhelp: name the columns, as `--columns \"deg, mm\"`";
            return Err(named(why.to_string()));
        }
    };
    let found = profile.and_then(|profile| profile.motion(follower, arguments.direction()));
    let found = found.map_err(|error| named(error.to_string()))?;
    let by_angle = follower.lifts_by_angle();
    let (unit, factor) = if by_angle { ("deg", 1_f64.to_degrees()) } else { ("mm", 1e3) };
    let mut text = format!("theta (deg),lift ({unit}),velocity ({unit}/rad),acceleration ({unit}/rad^2)\n");
    for (theta, motion) in &found.motion {
        let [s, v, a] = motion.map(|value| factor * value);
        text += &format!("{:?},{s:?},{v:?},{a:?}\n", theta.to_degrees());
    }
    let origin = Origin::of_table(&arguments.law, &bytes);
    let path = directory.join("lift.csv");
    write_file(&path, &origin.csv(&text))?;
    out.put_file("lift", &path);
    let outliers: Vec<usize> = found.outliers.clone();
    out.put("knots", found.knots);
    out.put("deviation", found.deviation);
    out.put("second_error", found.second_error);
    out.put("acceleration_error", found.acceleration_error);
    out.put("outliers", outliers.len());
    writeln!(out, "points       {}, {} of them outliers that are left out", pairs.len(), outliers.len())?;
    writeln!(out, "spline       periodic quintic with {} knots, as the noise allows", found.knots)?;
    writeln!(out, "deviation    {:.2e} mm of a radius", 1e3 * found.deviation)?;
    writeln!(out, "d2r          known to {:.2e} mm/rad^2, root mean square", 1e3 * found.second_error)?;
    for order in 0..3 {
        let name = ["lift", "velocity", "acceleration"][order];
        let values = || found.motion.iter().map(|(_, motion)| factor * motion[order]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let per = ["", "/rad", "/rad^2"][order];
        let known = match order {
            2 => format!(", known to about {:.1e}, root mean square", factor * found.acceleration_error),
            _ => String::new(),
        };
        let [low, high] = [low, high].map(unsigned_zero);
        writeln!(out, "{name:<13}{low:.4} to {high:.4} {unit}{per}{known}")?;
    }
    if let Some(least) = least_off_the_base(found.motion.iter().map(|(_, motion)| motion[0])) {
        let least = factor * least;
        writeln!(
            out,
            "base         the least lift is {least:.4} {unit}, not 0: check `--base`, and that the profile is about the cam's centre"
        )?;
    }
    writeln!(out, "file         {}", path.display())?;
    Ok(())
}

/// The least of these lifts, where it is off 0 by more than a thousandth of their range.
fn least_off_the_base(lifts: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let least = lifts.clone().fold(f64::INFINITY, f64::min);
    let range = lifts.fold(f64::NEG_INFINITY, f64::max) - least;
    (least.abs() > 1e-3 * range).then_some(least)
}

/// Noise of the acceleration against points and knots.
fn print_noise(out: &mut Output, study: &noise::Study, by_angle: bool) -> Result<(), CommandError> {
    let (factor, unit) = if by_angle { (1_f64.to_degrees(), "deg") } else { (1e3, "mm") };
    writeln!(
        out,
        "noise of the acceleration of a table of the lift with uniform noise of {:.2e} {unit}, over 8 seeds ({unit}/rad^2)",
        factor * study.width
    )?;
    let heads: String =
        noise::KNOTS.iter().map(|knots| format!("{:>12}", format!("{knots} knots"))).collect();
    writeln!(out, "{:>8}{:>14}{:>14}{heads}", "points", "through all", "√3 q N²/4π²")?;
    for row in &study.rows {
        let cells: String = row
            .fitted
            .iter()
            .map(|cell| cell.map_or("-".to_string(), |error| format!("{:.4}", factor * error)))
            .map(|cell| format!("{cell:>12}"))
            .collect();
        writeln!(
            out,
            "{:>8}{:>14.4}{:>14.4}{cells}",
            row.points,
            factor * row.through,
            factor * row.expected
        )?;
    }
    Ok(())
}

fn sentence(arguments: &Arguments, one: &Made) -> String {
    let Made { cam, verdicts, least, .. } = one;
    let broken: Vec<String> = verdicts
        .iter()
        .filter(|one| !one.kept)
        .map(|one| format!("{} at {:.1} deg", one.limit.name(), one.angle.to_degrees()))
        .collect();
    let state = if broken.is_empty() {
        "keeps all limits".to_string()
    } else {
        format!("breaks {}", broken.join(", "))
    };
    let kind = match cam.opens() {
        Some(true) => "opening cam",
        Some(false) => "closing cam",
        None => "cam",
    };
    let (Some(found), Some(size)) = (least, arguments.least) else {
        return format!("Base circle of {:.5} mm: the {kind} {state}.", 1e3 * cam.follower.base());
    };
    let size = if size == Sizes::Base { "base circle" } else { "pad" };
    let of = if kind == "cam" { String::new() } else { format!(" of the {kind}") };
    match found.active {
        Some(limit) => format!(
            "The least {size}{of} has a radius of {:.6} mm: a smaller one breaks the limit on the {} of {}.",
            1e3 * found.size,
            limit.name(),
            shown(limit.name(), limit.bound())
        ),
        None if found.is_at_reach => format!(
            "The least {size}{of} has a radius of {:.6} mm: with a smaller one the follower does not reach the cam.",
            1e3 * found.size
        ),
        None => format!(
            "A {size}{of} of {:.6} mm, the smallest that is tried, keeps all limits.",
            1e3 * found.size
        ),
    }
}

fn describe(out: &mut Output, all: &[Made], sentences: &[String]) {
    let verdict = |one: &Verdict| {
        json!({
            "name": one.limit.name(), "bound": one.limit.bound(), "value": page::finite(one.value), "angle": one.angle, "kept": one.kept,
        })
    };
    let fields = |one: &Made, sentence: &str| {
        let limits = one.verdicts.iter().map(verdict).collect::<Vec<_>>();
        let active = one.least.as_ref().and_then(|found| found.active).map(|limit| limit.name());
        json!({
            "sentence": sentence, "base": one.cam.follower.base(), "pad": one.cam.follower.pad(), "limits": limits, "active": active,
        })
    };
    if let Some(continuity) = all.first().map(|one| one.cam.lift.continuity()) {
        out.put(
            "continuity",
            json!({ "stated": continuity.stated, "jumps": continuity.jumps, "confirmed": continuity.confirms() }),
        );
    }
    for (one, sentence) in all.iter().zip(sentences) {
        let fields = fields(one, sentence);
        // A single cam has its fields at the top.
        match fields {
            Value::Object(fields) if one.name.is_empty() => {
                fields.into_iter().for_each(|(field, value)| out.put(&field, value));
            }
            fields => out.put(one.name, fields),
        }
    }
}

/// A number of four decimals; what rounds to 0 has no sign.
fn unsigned_zero(value: f64) -> f64 {
    if value.abs() < 0.5e-4 { 0.0 } else { value }
}

fn print_law(
    out: &mut Output,
    lift: &Lift,
    table: Option<&str>,
    by_angle: bool,
    sentences: &[String],
) -> Result<(), CommandError> {
    for sentence in sentences {
        writeln!(out, "{sentence}")?;
    }
    let continuity = lift.continuity();
    let checked = if continuity.confirms() { "checked at its joints" } else { "NOT confirmed at its joints" };
    let table = table.map_or_else(String::new, |table| format!("; {table}"));
    match continuity.stated {
        SMOOTH => writeln!(out, "law          all derivatives are continuous{table}")?,
        1 => writeln!(out, "law          1 continuous derivative, {checked}{table}")?,
        count => writeln!(out, "law          {count} continuous derivatives, {checked}{table}")?,
    }
    for order in 0..3 {
        let (name, unit) = [("lift", ""), ("velocity", "/rad"), ("acceleration", "/rad^2")][order];
        let [low, high] = lift.range(order);
        let (factor, base) = if by_angle { (1_f64.to_degrees(), "deg") } else { (1e3, "mm") };
        let [low, high] = [low, high].map(|value| unsigned_zero(factor * value));
        writeln!(out, "{name:<13}{low:.4} to {high:.4} {base}{unit}")?;
    }
    Ok(())
}

fn print_limits(out: &mut Output, one: &Made) -> Result<(), CommandError> {
    let head = if one.name.is_empty() { "limit".to_string() } else { format!("{}: limit", one.name) };
    writeln!(out, "{head:<22}{:>16}{:>16}{:>12}", "bound", "value", "at")?;
    for one in &one.verdicts {
        let sign = if one.limit.is_least() { "≥" } else { "≤" };
        let bound = format!("{sign} {}", shown(one.limit.name(), one.limit.bound()));
        let mark = if one.kept { "" } else { "  broken" };
        let (value, at) = (shown(one.limit.name(), one.value), format!("{:.2} deg", one.angle.to_degrees()));
        writeln!(out, "{:<22}{bound:>16}{value:>16}{at:>12}{mark}", one.limit.name())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;

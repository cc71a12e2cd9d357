//! Functions of a text in a file: a table or a lift law for each, on the command line.

use std::collections::BTreeMap;
use std::env;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::exit;
use std::sync::{Arc, Mutex, PoisonError};

use mbs_codegen::{DeclaredFunction, quantity};
use mbs_runtime::driver::{End, SMOOTH};
use mbs_runtime::{Function, Interval, Scalar};

use super::CommandError;
use super::given_file::unreadable;
use super::law_options::{self, is_law, usage};
use crate::cams::lift::Lift;
use crate::mismatch::nearest;
use crate::tables::{Columns, Spline, SplineKind, UNITS_UNKNOWN, close_period, read};
use crate::text_file::TextFile;

/// The option, as messages name it.
const OPTION: &str = "--function";

/// Derivatives of a lift law that are known.
const OF_LAWS: usize = 3;

/// A function that the command line gives: a spline along a table, or a lift law.
#[derive(Clone, Debug)]
pub struct GivenFunction(Arc<Given>);

#[derive(Debug)]
struct Given {
    form: Form,
    /// Table or law in words.
    said: String,
}

/// The functions that this program has, by their names.
static MADE: Mutex<BTreeMap<String, GivenFunction>> = Mutex::new(BTreeMap::new());

#[derive(Debug)]
enum Form {
    Table(Spline),
    Law(Lift),
}

/// Values of `--function` on the command line of the program, in their order.
pub fn options() -> Vec<String> {
    let mut words = env::args_os().skip(1).filter_map(|word| word.into_string().ok());
    let mut found = Vec::new();
    while let Some(word) = words.next() {
        if word == OPTION {
            found.extend(words.next());
        } else if let Some(value) = word.strip_prefix(OPTION).and_then(|rest| rest.strip_prefix('=')) {
            found.push(value.to_string());
        }
    }
    found
}

/// Checks before anything is built that each function of a text is given once, and is what the text declares.
///
/// # Errors
/// [`CommandError`] with the function, the option that gives it, the place in a table.
pub fn require(text: &TextFile) -> Result<(), CommandError> {
    let given = parsed(&options())?;
    let known: Vec<&str> = text.functions.iter().map(|function| function.name.as_str()).collect();
    for (name, _) in &given {
        if known.contains(&name.as_str()) {
            continue;
        }
        let list = match known.as_slice() {
            [] => "it calls none".to_string(),
            _ => format!("known: {}", known.join(", ")),
        };
        let near = nearest(name, known.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        return Err(usage(format!("`{}` calls no function `{name}`{near}\n{list}", text.type_name())));
    }
    if let Some((index, (name, _))) = given
        .iter()
        .enumerate()
        .find(|(index, (name, _))| given[..*index].iter().any(|(other, _)| other == name))
    {
        return Err(usage(format!("`{OPTION} {name}=…` is given {} times", index + 1)));
    }
    let missing: Vec<&DeclaredFunction> = text
        .functions
        .iter()
        .filter(|function| given.iter().all(|(name, _)| *name != function.name))
        .collect();
    if !missing.is_empty() {
        let list = missing.iter().map(|function| format!("\n  {}", described(function))).collect::<String>();
        let options: Vec<String> =
            missing.iter().map(|function| format!("{OPTION} {0}=FILE.csv", function.name)).collect();
        return Err(usage(format!(
            "`{}` calls functions that the command line must give:{list}\n\
             help: give a table or a lift law for each: {}",
            text.type_name(),
            options.join(" ")
        )));
    }
    let mut known = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    for function in &text.functions {
        known.insert(function.name.clone(), made(function, &given)?);
    }
    Ok(())
}

/// The function of the command line by its name, where this program has it.
pub fn given(name: &str) -> Option<GivenFunction> {
    MADE.lock().unwrap_or_else(PoisonError::into_inner).get(name).cloned()
}

/// Facts of a page: the functions of the command line, each with the file and the points of its table, or with its law.
pub fn facts() -> Vec<[String; 2]> {
    let known = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    known.iter().map(|(name, function)| [format!("function {name}"), function.0.said.clone()]).collect()
}

/// Refuses the option where no text in a file is named.
pub fn refuse_without_file() -> Result<(), CommandError> {
    match options().as_slice() {
        [] => Ok(()),
        _ => Err(usage(format!(
            "`{OPTION}` gives a function of a text in a file; a mechanism of the list has its functions from its crate\n\
             help: name a file, as `mbs run cam.mbs {OPTION} lift=lift.csv`"
        ))),
    }
}

/// The function of the command line for one that a text declares: name, unit, unit of the argument, continuity, period. Programs that
/// are built for a file call it. It ends the program where the command line does not give the function.
pub fn given_function(
    (name, unit, argument_unit, continuity, period): (&str, &str, &str, u8, Option<f64>),
) -> GivenFunction {
    let mut known = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(function) = known.get(name) {
        return function.clone();
    }
    let declared = DeclaredFunction {
        name: name.to_string(),
        unit: unit.to_string(),
        argument_unit: argument_unit.to_string(),
        continuity,
        period,
    };
    match parsed(&options()).and_then(|given| made(&declared, &given)) {
        Ok(function) => {
            known.insert(name.to_string(), function.clone());
            function
        }
        Err(error) => {
            eprintln!("error: {error}");
            exit(error.exit_code().into())
        }
    }
}

fn described(function: &DeclaredFunction) -> String {
    let DeclaredFunction { name, unit, argument_unit, continuity, period } = function;
    let period = match period {
        Some(period) if *period == TAU => ", periodic with a turn".to_string(),
        Some(period) => format!(", periodic with {period} {argument_unit}"),
        None => String::new(),
    };
    format!("{name}: {unit} over {argument_unit}, {continuity} continuous derivatives{period}")
}

/// Names and what is given for them.
fn parsed(options: &[String]) -> Result<Vec<(String, String)>, CommandError> {
    let pair = |option: &String| {
        let (name, form) = option.split_once('=').unwrap_or((option, ""));
        if name.trim().is_empty() || form.trim().is_empty() {
            return Err(usage(format!(
                "`{OPTION} {option}`: write name and table or law, as `{OPTION} lift=lift.csv`, \
                 `{OPTION} \"lift=lift.csv:deg,mm\"` or `{OPTION} \"lift=4567 --lift 8mm --rise 75deg\"`"
            )));
        }
        Ok((name.split_whitespace().collect(), form.trim().to_string()))
    };
    options.iter().map(pair).collect()
}

fn made(declared: &DeclaredFunction, given: &[(String, String)]) -> Result<GivenFunction, CommandError> {
    let name = &declared.name;
    let Some((_, form)) = given.iter().find(|(known, _)| known == name) else {
        return Err(usage(format!("the function `{name}` is missing: `{OPTION} {name}=FILE.csv`")));
    };
    let named = |why: String| usage(format!("`{OPTION} {name}=…`: {why}"));
    let (form, said) =
        if is_law(form) { (law(declared, form)?, format!("law {form}")) } else { table(declared, form)? };
    let order = match &form {
        Form::Table(spline) => spline.order(),
        Form::Law(lift) => lift.order().min(OF_LAWS),
    };
    if order < usize::from(declared.continuity) {
        let cure = match (&form, declared.period) {
            (Form::Law(_), _) if OF_LAWS < usize::from(declared.continuity) => {
                "laws have three at most; give a table of it, which has four over a whole period"
            }
            (Form::Law(_), _) => "take a law with more, as `4567`, or a table of it",
            (Form::Table(_), Some(_)) => "a periodic table has four; declare no more",
            (Form::Table(_), None) => {
                "a table without a period is a cubic spline with two; declare `C2`, or a period"
            }
        };
        return Err(named(format!(
            "{order} continuous derivatives, and the text counts on {}\nhelp: {cure}",
            declared.continuity
        )));
    }
    Ok(GivenFunction(Arc::new(Given { form, said })))
}

/// A lift law: a length, or an angle, over an angle.
fn law(declared: &DeclaredFunction, form: &str) -> Result<Form, CommandError> {
    let DeclaredFunction { name, unit, argument_unit, period, .. } = declared;
    let named = |why: String| usage(format!("`{OPTION} {name}=…`: {why}"));
    let turns = is_unit("rad", unit);
    if !(is_unit("rad", argument_unit) && (turns || is_unit("m", unit))) {
        return Err(named(format!(
            "a law is a length or an angle over an angle, and `{name}` is in {unit} over {argument_unit}\nhelp: give a table"
        )));
    }
    if period.is_some_and(|period| (period - TAU).abs() > 1e-12) {
        return Err(named("a law repeats after a turn, and the text declares another period".to_string()));
    }
    law_options::written_for(form, turns).map(|given| Form::Law(given.lift)).map_err(|error| match error {
        CommandError::Usage(why) => named(why),
        other => other,
    })
}

/// A table, its units behind the last colon or in its header.
fn table(declared: &DeclaredFunction, form: &str) -> Result<(Form, String), CommandError> {
    let DeclaredFunction { name, unit, argument_unit, period, .. } = declared;
    let named = |why: String| usage(format!("`{OPTION} {name}=…`: {why}"));
    // Units have a comma between them, the rest of a path after a drive's letter has a slash.
    let units = form.rsplit_once(':').filter(|(_, units)| units.contains([',', ';']));
    let (path, columns) = match units.filter(|_| !Path::new(form).is_file()) {
        Some((path, units)) => (path, Some(Columns::parse(units).map_err(named)?)),
        None => (form, None),
    };
    let of_file = |why: String| CommandError::Failed(format!("`{name}`: {path}: {why}"));
    let bytes = fs::read(path).map_err(|error| {
        let help = match law_options::near_law(path) {
            Some(law) => format!("did you mean the law `{law}`?"),
            None => format!(
                "write a file of two columns, as `{OPTION} {name}=lift.csv`, or a law: {}",
                law_options::laws()
            ),
        };
        usage(format!("`{OPTION} {name}=…`: {path} {}", unreadable(Path::new(path), &error, &help)))
    })?;
    let mut points = read(&bytes, columns.as_ref()).map_err(|mut fault| {
        if fault.message == UNITS_UNKNOWN {
            let [across, up] = [argument_unit, unit].map(|unit| match unit.as_str() {
                "rad" => "deg",
                "m" => "mm",
                other => other,
            });
            fault.cure = format!(
                "say them behind the file, as `{OPTION} \"{name}={path}:{across},{up}\"`, or write a header \
                 `x ({across}), {name} ({up})`"
            );
        }
        of_file(fault.to_string())
    })?;
    let (across, up) = (&points.columns.x.1, &points.columns.y.1);
    if !(is_unit(&across.coherent, argument_unit) && is_unit(&up.coherent, unit)) {
        return Err(of_file(format!(
            "the columns are {} over {}, and the text declares {unit} over {argument_unit}\n\
             help: name the units, as `{OPTION} \"{name}={path}:deg,mm\"`, or in the header",
            up.name, across.name
        )));
    }
    let said = law_options::named_table(path, points.x.len());
    let kind = match period {
        Some(period) => {
            close_period(&mut points, *period).map_err(|fault| of_file(fault.to_string()))?;
            SplineKind::PeriodicQuintic(*period)
        }
        None => SplineKind::Cubic([End::Natural; 2]),
    };
    Spline::fit(&points.x, &points.y, kind, None)
        .map(|spline| (Form::Table(spline), said))
        .map_err(|error| of_file(crate::tables::explained(error, &points).to_string()))
}

/// `true` if values in one unit may stand for the other.
fn is_unit(unit: &str, declared: &str) -> bool {
    // A bare number would fit every unit.
    let one = if unit == "1" { "1rad".to_string() } else { format!("1 [{unit}]") };
    quantity(&one).is_ok_and(|quantity| quantity.fits(declared))
}

#[cfg(test)]
impl GivenFunction {
    /// A table of 36 points of a function over a turn.
    pub fn of_turn(function: impl Fn(f64) -> f64) -> Self {
        let x: Vec<f64> = (0..36).map(|k| f64::from(10 * k).to_radians()).collect();
        let y: Vec<f64> = x.iter().map(|angle| function(*angle)).collect();
        let spline = Spline::fit(&x, &y, SplineKind::PeriodicQuintic(TAU), None).expect("a table");
        GivenFunction(Arc::new(Given { form: Form::Table(spline), said: String::new() }))
    }
}

impl<T: Scalar> Function<T> for GivenFunction {
    // What it has is compared with the text before it is called.
    const ORDER: usize = SMOOTH;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        match &self.0.form {
            Form::Table(spline) => spline.jet(x),
            Form::Law(lift) => {
                let lanes = T::per_lane(|lane| lift.jet(x.lane(lane)));
                core::array::from_fn(|order| {
                    T::from_lanes(|lane| {
                        let jet = lanes.as_ref().get(lane).or(lanes.as_ref().last());
                        let value = jet.and_then(|jet| jet.get(order).copied());
                        value.unwrap_or(T::Real::constant(f64::NAN))
                    })
                })
            }
        }
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        match &self.0.form {
            Form::Table(spline) => spline.breakpoint_after(x),
            Form::Law(lift) => {
                let turns = ((x - lift.origin()) / TAU).floor();
                let joints = lift.joints();
                let ahead = |turn: f64| joints.iter().map(move |joint| joint + turn * TAU);
                [turns - 1.0, turns, turns + 1.0].into_iter().flat_map(ahead).find(|place| *place > x)
            }
        }
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        match &self.0.form {
            Form::Table(spline) => spline.enclosure(from, to),
            Form::Law(lift) => {
                let bounds = lift.enclosure(from, to)?;
                let unknown = Interval::between(f64::NEG_INFINITY, f64::INFINITY);
                Some(core::array::from_fn(|order| bounds.get(order).copied().unwrap_or(unknown)))
            }
        }
    }
}

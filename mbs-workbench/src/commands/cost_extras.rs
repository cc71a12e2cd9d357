//! Comparisons of `mbs cost` beside the settings: tables of functions, and other programs.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::cost::Arguments;
use super::target::Target;
use crate::cost::moved::MovedStudy;
use crate::cost::peers::{Described, PeerPoint, Question, ask_all};
use crate::double_double::DoubleDouble;
use crate::erased::facade::AnyEquations;
use crate::tables::valley::{NamedLaw, Valley};
use crate::text_file::is_file;
use crate::verify::generated_definition;

/// Tables of the periodic functions of the caller.
pub(super) fn valleys(
    equations: &dyn AnyEquations,
    laws: &[NamedLaw],
    progress: &mut dyn FnMut(&str, f64),
) -> Vec<Valley> {
    let mut found = Vec::new();
    for (name, law) in laws {
        let entry = equations.functions().iter().find(|entry| entry.name == *name);
        let Some((entry, period)) = entry.and_then(|entry| Some((entry, entry.period?))) else { continue };
        progress(&format!("tables of {name}"), 1.0);
        found.push(Valley::of(name, [entry.unit, entry.argument_unit], law, period));
    }
    found
}

/// Runs of other programs on the motion of a study.
pub(super) fn ask_peers(
    study: &MovedStudy,
    target: &Target,
    equations: &dyn AnyEquations,
    arguments: &Arguments,
    progress: &mut dyn FnMut(&str, f64),
) -> Vec<PeerPoint> {
    let Some(start) = study.judge().and_then(|reference| reference.shots.first()) else { return Vec::new() };
    let doubles = |values: &[DoubleDouble]| values.iter().map(|value| value.high).collect::<Vec<f64>>();
    let variables = equations.variables();
    let v: Vec<f64> = (0..variables.len()).map(|index| equations.get(index).unwrap_or_default()).collect();
    let parameters =
        variables.iter().zip(&v).map(|(entry, value)| (entry.name.to_string(), (*value).into())).collect();
    // Each pair of decades; of an overview fewer.
    let digits = if arguments.quick { vec![4, 6, 8] } else { vec![4, 6, 8, 10, 12] };
    let question = Question {
        name: target.file_name().to_string(),
        times: study.times.clone(),
        q: doubles(&start.at.q),
        qd: doubles(&start.at.qd),
        z: doubles(&start.at.states),
        v,
        parameters,
        digits,
        longest: if arguments.quick { 0.3 } else { 1.5 },
    };
    let functions = equations.functions().iter().map(|function| function.name).collect::<Vec<_>>();
    let definition = match functions[..] {
        [] => generated_definition(equations).map_err(|error| error.to_string()),
        _ => Err(format!("it calls functions of its crate ({})", functions.join(", "))),
    };
    // Beside the crate's manifest, or beside the file with the text.
    let place = match is_file(arguments.name()) {
        true => {
            Path::new(arguments.name().split(':').next().unwrap_or_default()).parent().map(Path::to_path_buf)
        }
        false => Some(PathBuf::from(target.card().manifest)),
    };
    let tree = place.unwrap_or_default().join("peers").join(format!("{}.py", target.file_name()));
    let progress = RefCell::new(progress);
    ask_all(&question, &Described { definition, tree }, &|q, qd| study.errors_of(q, qd), &|words| {
        progress.borrow_mut()(words, 1.0)
    })
}

//! `mbs drift`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::path::PathBuf;

use crate::erased::dynamics::direct_dynamics::{Approach, Rule, Simulated, Steps};
use crate::motion::instants;
use crate::target_directory::target_directory;
use crate::teaching::drift::{Curve, picture};
use clap::{Args, ValueEnum};
use serde_json::json;

use super::CommandError;
use super::analysis::{
    Damping, IntegratorName, MethodName, above_zero, doubtful, dynamics, largest, undetermined,
};
use super::assignment::{Assignment, assignment};
use super::chosen::{require_named, svg_file, write_file};
use super::document::Output;
use super::run::steps;
use super::target::Target;

#[derive(Args)]
pub struct Arguments {
    /// Name of a mechanism with masses, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    pub name: String,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<Assignment>,
    /// Stabilisation methods, one curve each
    #[arg(long, value_enum, value_delimiter = ',', default_value = "none,baumgarte,projection")]
    methods: Vec<MethodName>,
    /// End of the motion (s) [default: that of `mbs run`]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Equal steps of the integrator
    #[arg(long, default_value_t = 1000, value_parser = steps, allow_negative_numbers = true)]
    steps: usize,
    /// Integrator with steps of one size: rk4 or euler
    #[arg(long, value_enum, default_value_t = IntegratorName::Rk4)]
    integrator: IntegratorName,
    #[command(flatten)]
    damping: Damping,
    /// File of the picture [default: mbs/NAME/drift.svg in cargo's target directory]
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file)]
    out: Option<PathBuf>,
}

/// Prints the violation of the constraints and the energy defect of each method, and writes the picture.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    require_named(arguments.out.as_ref())?;
    let target = Target::find(catalogue, &arguments.name)?;
    let rule = arguments.integrator.rule().ok_or_else(|| {
        CommandError::Usage("adaptive steps hide what drifts: use `--integrator rk4` or `euler`".to_string())
    })?;
    if arguments.damping.is_given() && !arguments.methods.iter().any(|method| method.is_damped()) {
        let reason = "`--frequency` and `--damping` belong to `--methods baumgarte` or `penalty`";
        return Err(CommandError::Usage(reason.to_string()));
    }
    if arguments.damping.is_penalty_given() && !arguments.methods.contains(&MethodName::Penalty) {
        return Err(CommandError::Usage("`--alpha` belongs to `--methods penalty`".to_string()));
    }
    let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
    let until = arguments.until.map_or_else(|| target.duration(instance.equations()), Ok)?;
    let times = instants(until, arguments.steps);
    let dynamics = dynamics(&target, &instance)?;
    let mut found = Vec::new();
    for method in &arguments.methods {
        let stabilization = arguments.damping.stabilization(*method, f64::INFINITY);
        let approach = Approach { stabilization, steps: Steps::Fixed(rule) };
        let name = method.to_possible_value().map_or_else(String::new, |value| value.get_name().to_string());
        let simulated = dynamics
            .simulate(&approach, &times, &mut |_| ())
            .map_err(|failure| target.failed(instance.equations(), &format!("{name}: {failure}")))?;
        found.push((name, simulated));
    }
    let implicit = match arguments.methods.iter().any(|method| method.is_implicit()) {
        true => ", implicit methods as well,",
        false => "",
    };
    let integrator = match rule {
        Rule::RungeKutta4 => "RK4",
        Rule::SemiImplicitEuler => "semi-implicit Euler",
    };
    let title = format!("{}: {integrator}{implicit} in {} steps", target.title(), arguments.steps);
    let curves: Vec<Curve> = found
        .iter()
        .map(|(name, simulated)| Curve::of(name.clone(), &simulated.motion, simulated.failure.is_some()))
        .collect();
    let standard = || target_directory().join("mbs").join(target.file_name()).join("drift.svg");
    let path = arguments.out.clone().unwrap_or_else(standard);
    // Written before the table: printing fails if the reader of the output has left.
    let origin = out.put_mechanism(&target, instance.equations());
    let written = write_file(&path, &origin.svg(&picture(&title, until, &curves)));
    out.put("until", until);
    out.put("steps", arguments.steps);
    writeln!(out, "{title}, to t = {until} s\n")?;
    writeln!(
        out,
        "{:<10}  {:>11}  {:>11}  {:>17}  {:>11}",
        "method", "largest |Φ|", "|Φ̇| (1/s)", "energy defect (J)", "evaluations"
    )?;
    for (name, simulated) in &found {
        write_line(out, name, simulated)?;
        let forces = simulated.motion.dynamics.clone().unwrap_or_default();
        out.push(
            "methods",
            json!({
                "name": name, "largest_closure": largest(&simulated.motion.closure),
                "largest_closure_rate": largest(&forces.closure_rate), "largest_energy_defect": largest(&forces.defect),
                "evaluations": simulated.counts.evaluations,
                "failure": simulated.failure.as_ref().map(ToString::to_string),
                "undetermined_from": simulated.undetermined,
            }),
        );
    }
    writeln!(out, "\n|Φ| and |Φ̇|: each row measured in the reference metric")?;
    written?;
    out.put_file("picture", &path);
    writeln!(out, "\npicture  {}", path.display())?;
    Ok(())
}

fn write_line(out: &mut dyn Write, name: &str, simulated: &Simulated) -> std::io::Result<()> {
    let Simulated { motion, counts, doubt, undetermined: open, failure, .. } = simulated;
    let forces = motion.dynamics.clone().unwrap_or_default();
    writeln!(
        out,
        "{name:<10}  {:>11.1e}  {:>10.1e}  {:>17.1e}  {:>11}",
        largest(&motion.closure),
        largest(&forces.closure_rate),
        largest(&forces.defect),
        counts.evaluations
    )?;
    if let Some(failure) = failure {
        writeln!(out, "{:12}ends early: {failure}", "")?;
    }
    if let Some(t) = open {
        writeln!(out, "{:12}not determined: {}", "", undetermined(*t))?;
    }
    doubt.map_or(Ok(()), |doubt| writeln!(out, "{:12}{}", "", doubtful(doubt)))
}

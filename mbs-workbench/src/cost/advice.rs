//! The choice in one sentence, and as Rust.

use crate::cost::points::{Point, cheapest, cheapest_in_lanes, cheapest_with};
use crate::setting::{
    Closing, FormulationName, ImplicitName, Kernel, MotionMethod, Numbers, Resolution, Setting,
};

/// Two digits of a number.
pub fn two_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let text = format!("{value:.1e}");
    text.replace(".0e", "e")
}

/// A time in the unit that suits it: `nanoseconds` of a step, else µs.
pub fn time_text(time: f64, is_step: bool) -> String {
    let digits = |value: f64| match value {
        value if value >= 100.0 => format!("{value:.0}"),
        value if value >= 10.0 => format!("{value:.1}"),
        value if value >= 0.1 => format!("{value:.2}"),
        value => two_digits(value),
    };
    if is_step {
        format!("{} ns a step", digits(time))
    } else if time >= 1e4 {
        format!("{} ms a simulated second", digits(time / 1e3))
    } else {
        format!("{} µs a simulated second", digits(time))
    }
}

/// The setting to take for an error of `asked`, and the price of the next digit.
pub fn sentence(points: &[Point], asked: f64) -> String {
    let Some(chosen) = cheapest(points, asked) else {
        let best = points.iter().filter_map(Point::bound).fold(f64::INFINITY, f64::min);
        return match best.is_finite() {
            true => format!(
                "{}: no setting reaches it; the best has an error of {}.",
                two_digits(asked),
                two_digits(best)
            ),
            false => format!("{}: no setting went through.", two_digits(asked)),
        };
    };
    let is_step = matches!(chosen.setting, Setting::Kinematics { .. });
    let mut text = format!("{}: {}, {}.", two_digits(asked), chosen.setting, time_text(chosen.time, is_step));
    match cheapest(points, asked / 10.0) {
        Some(finer) if finer.time > 1.02 * chosen.time => {
            text += &format!(" Ten times better costs {:.1} times as much", finer.time / chosen.time);
        }
        Some(_) => text += " Ten times better costs nothing more",
        None => text += " Ten times better is out of reach",
    }
    text += &match cheapest(points, asked * 10.0) {
        Some(coarser) if coarser.time < 0.98 * chosen.time => {
            format!("; ten times coarser saves {:.0} %.", 100.0 * (1.0 - coarser.time / chosen.time))
        }
        _ => "; ten times coarser saves nothing.".to_string(),
    };
    if let Some(lanes) = cheapest_in_lanes(points, asked).filter(|lanes| lanes.time < chosen.time) {
        text += &format!(" Many at once: {}, {}.", lanes.setting, time_text(lanes.time, true));
    }
    for kernel in [Kernel::Fused, Kernel::Library] {
        let faster = cheapest_with(points, asked, kernel).filter(|point| point.time < 0.95 * chosen.time);
        if let (Some(point), Some(feature)) = (faster, kernel.feature()) {
            text += &format!(" With the feature `{feature}`: {}.", time_text(point.time, true));
        }
    }
    let single = points.iter().filter(|point| point.setting.numbers() == Numbers::Single);
    let floor = single.filter_map(Point::bound).fold(f64::INFINITY, f64::min);
    if floor.is_finite() {
        text += &format!(" f32 stops at {}.", two_digits(floor));
    }
    text
}

/// Statements of Rust that make the run of a setting for a mechanism made by `constructor`, up to `until` (s).
pub fn rust(setting: &Setting, constructor: &str, until: f64) -> String {
    match setting {
        Setting::Kinematics { numbers, lanes, closing, steps, .. } => {
            kinematics(*numbers, *lanes, *closing, *steps, constructor, until)
        }
        Setting::Motion { numbers, method, resolution } => {
            motion(*numbers, *method, *resolution, constructor, until)
        }
    }
}

fn kinematics(
    numbers: Numbers,
    lanes: u32,
    closing: Closing,
    steps: u32,
    constructor: &str,
    until: f64,
) -> String {
    let real = numbers.name();
    let head = format!(
        "let mechanism = {constructor};\nlet guess = mechanism.guess(&mechanism.parameters());\n\
         let h: {real} = {until:?} / {steps}.0;\n"
    );
    let step = match closing {
        Closing::Closed => "    stepper.advance(h)?;\n".to_string(),
        Closing::Evaluations(most) => format!(
            "    if let Step::Refused(failure) = stepper.step(h, Budget {{ newton: {most}, fallback: 0 }}) {{\n        \
             return Err(failure);\n    }}\n"
        ),
    };
    let lanes =
        if lanes == 1 { String::new() } else { format!("// The same in a `Batch` of {lanes} lanes.\n") };
    format!(
        "{lanes}{head}let mut stepper = Stepper::assemble(mechanism, guess, 0.0)?;\nfor _ in 0..{steps} {{\n{step}}}\n"
    )
}

fn motion(
    numbers: Numbers,
    method: MotionMethod,
    resolution: Resolution,
    constructor: &str,
    until: f64,
) -> String {
    let formulation = |name: FormulationName| match name {
        FormulationName::Projection => "Projection::default()",
        FormulationName::VelocityTransformation => "VelocityTransformation",
        FormulationName::Baumgarte => "Baumgarte::default()",
        FormulationName::Penalty => "Penalty::default()",
        FormulationName::Unstabilized => "Unstabilized",
    };
    let method = match method {
        MotionMethod::Explicit(name, integrator) => {
            format!("Explicit::new({integrator:?}, {})", formulation(name))
        }
        MotionMethod::Implicit(ImplicitName::GeneralizedAlpha) => "GeneralizedAlpha::default()".to_string(),
        MotionMethod::Implicit(name) => format!("{name:?}"),
    };
    let real = numbers.name();
    let run = format!(
        "let method = {method};\nlet mut run = Simulation::start_from_text({constructor}, method, 0.0_{real})?;\n"
    );
    match resolution {
        Resolution::Tolerance(tolerance) => format!(
            "{run}let mut run = run.with_tolerance(Tolerance::new({tolerance:e}));\nrun.advance_to({until:?})?;\n"
        )
        .replacen("let mut run = Sim", "let run = Sim", 1),
        Resolution::Steps(steps) => format!("{run}run.step_to({until:?}, {steps})?;\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_digits_at_any_size() {
        assert_eq!(time_text(5.83e-7, false), "5.8e-7 µs a simulated second");
        assert_eq!(time_text(0.5, false), "0.50 µs a simulated second");
        assert_eq!(time_text(23456.0, false), "23.5 ms a simulated second");
        assert_eq!(time_text(123.4, true), "123 ns a step");
    }
}

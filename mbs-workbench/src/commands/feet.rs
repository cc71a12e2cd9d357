//! Feet on the curves of a text in a file: each bound against the curve that the command line gives.

use mbs_runtime::driver::{ClosedCurve, Parametric, Polar, ReachError};

use super::CommandError;
use super::functions::{GivenFunction, given};
use super::summary::significant;
use crate::erased::facade::AnyEquations;
use crate::hard_cases::oracle::{Follower, Foot, Oracle, Outline};

/// Refuses a mechanism with a foot whose bound allows another place of the curve to be nearer. Curves whose functions the command line
/// does not give, and texts that the oracle does not read, are left.
///
/// # Errors
/// [`CommandError::Usage`] with the foot, the bound that its curve allows, and the cure.
pub fn require(equations: &dyn AnyEquations) -> Result<(), CommandError> {
    let names: Vec<&str> = equations.functions().iter().map(|function| function.name).collect();
    if names.iter().all(|name| given(name).is_none()) {
        return Ok(());
    }
    let known =
        |name: &str| equations.get(equations.variables().iter().position(|variable| variable.name == name)?);
    let scene = Some(equations.scene()).filter(|scene| *scene != mbs_codegen::WHOLE);
    let feet = Oracle::feet(equations.source(), scene, &known);
    feet.unwrap_or_default().iter().try_for_each(|foot| judged(foot, &given))
}

/// Refuses a foot whose bound is beyond what `function` gives of its curve.
fn judged(foot: &Foot, function: &dyn Fn(&str) -> Option<GivenFunction>) -> Result<(), CommandError> {
    let Foot { name, curve, follower } = foot;
    let Some(own) = Given::of(curve, function) else { return Ok(()) };
    let refused =
        |what: String, help: String| Err(CommandError::Usage(format!("foot `{name}`: {what}\nhelp: {help}")));
    let unknown = |reason: ReachError, curves: String| match reason {
        // Nothing is known of the curve then.
        ReachError::NoBounds | ReachError::Undecided(_) => Ok(()),
        ReachError::Clockwise => refused(
            format!("{curves} is gone through clockwise, so gaps have the wrong sign"),
            "turn the table round, so that its parameter runs counterclockwise".to_string(),
        ),
        reason => refused(
            format!("{curves}: {reason}"),
            "give another curve, or touch it by a point or circle".to_string(),
        ),
    };
    let named = format!("the curve `{}`", curve.name);
    match follower {
        Follower::Point { bound, lowest } => {
            let [inside, outside] = match own.reach() {
                Ok(reach) => reach,
                Err(reason) => return unknown(reason, named),
            };
            let least = inside.min(outside);
            let written = millimetres(*bound);
            let [least_mm, outside_mm, inside_mm] = [least, outside, inside].map(below);
            let is_kept = *bound <= inside || *lowest >= -inside;
            match (*bound <= outside, is_kept) {
                (true, true) => Ok(()),
                (true, false) => refused(
                    format!(
                        "`within {written}` is beyond the reach of {named} on its inner side, {inside_mm}: another place may be nearer"
                    ),
                    format!(
                        "write `within {least_mm}`, or keep it outside by `limit hollow: -{inside_mm} <= {name}_gap;`"
                    ),
                ),
                (false, _) => refused(
                    format!(
                        "`within {written}` is beyond the reach of {named}, {inside_mm} inside and {outside_mm} outside: another place \
                         may be nearer"
                    ),
                    format!("write `within {least_mm}`"),
                ),
            }
        }
        Follower::Flat => own.flattest().map(drop).or_else(|reason| unknown(reason, named)),
        Follower::Curve { other, bound } => {
            let Some(second) = Given::of(other, function) else { return Ok(()) };
            let reach = own.pair_reach(&second);
            match reach.map(|[depth, distance]| depth.min(distance)) {
                Ok(least) if *bound <= least => Ok(()),
                Ok(least) => refused(
                    format!(
                        "`within {}` is beyond {}, up to which {named} and `{}` have one pair of nearest places",
                        millimetres(*bound),
                        below(least),
                        other.name
                    ),
                    format!("write `within {}`", below(least)),
                ),
                Err(reason) => unknown(reason, format!("{named} or `{}`", other.name)),
            }
        }
    }
}

/// A length (m) as a text has it.
fn millimetres(length: f64) -> String {
    format!("{}mm", significant(1e3 * length, 4))
}

/// The next smaller length (m) with four digits.
fn below(length: f64) -> String {
    millimetres(length * (1.0 - 5e-4))
}

/// A curve of functions of the command line.
enum Given {
    Polar(GivenFunction),
    Parametric([GivenFunction; 2]),
}

/// The value of `$call` for the curve in `$given`, by the name `$curve`.
macro_rules! on {
    ($given:expr, $curve:ident => $call:expr) => {
        match $given {
            Given::Polar(radius) => {
                let $curve = Polar(radius);
                $call
            }
            Given::Parametric([x, y]) => {
                let $curve = Parametric { x, y };
                $call
            }
        }
    };
}

impl Given {
    fn of(curve: &Outline, function: &dyn Fn(&str) -> Option<GivenFunction>) -> Option<Self> {
        match curve.functions.as_slice() {
            [radius] => function(radius).map(Given::Polar),
            [x, y] => Some(Given::Parametric([function(x)?, function(y)?])),
            _ => None,
        }
    }

    fn reach(&self) -> Result<[f64; 2], ReachError> {
        on!(self, curve => curve.reach())
    }

    fn flattest(&self) -> Result<f64, ReachError> {
        on!(self, curve => curve.flattest())
    }

    fn pair_reach(&self, other: &Given) -> Result<[f64; 2], ReachError> {
        on!(self, curve => on!(other, second => curve.pair_reach(&second)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two functions of the caller.
    const HEAD: &str = "mechanism M; function one: m(rad), C3, periodic TAU; function two: m(rad), C3, periodic TAU; \
        param size: m = 5mm; coord theta: rad; coord y: m = 40mm; curve cam = polar one about [0m, 0m] turned theta; \
        curve pad = polar two about [0m, y]; curve rim = parametric one, two about [0m, 0m]; ";

    /// The message about the foot of a text, if it is refused.
    fn refusal(foot: &str, one: impl Fn(f64) -> f64, two: impl Fn(f64) -> f64) -> Option<String> {
        let [one, two] = [GivenFunction::of_turn(one), GivenFunction::of_turn(two)];
        let function = |name: &str| match name {
            "one" => Some(one.clone()),
            "two" => Some(two.clone()),
            _ => None,
        };
        let size = |name: &str| (name == "size").then_some(0.005);
        let feet = Oracle::feet(&format!("{HEAD}{foot}"), None, &size).expect("a text");
        assert_eq!(feet.len(), 1, "{foot}");
        judged(&feet[0], &function).err().map(|error| error.to_string())
    }

    /// A circle of 30 mm about a point 10 mm off the centre: reach 30 mm inside, any distance outside.
    fn eccentric(w: f64) -> f64 {
        0.01 * w.cos() + (0.03_f64.powi(2) - (0.01 * w.sin()).powi(2)).sqrt()
    }

    /// Three lobes with hollow flanks.
    fn lobed(w: f64) -> f64 {
        0.03 + 0.006 * (3.0 * w).cos()
    }

    #[test]
    fn a_bound_within_the_reach_passes_and_one_beyond_names_it() {
        let point = |bound: &str| format!("foot w of [0m, y] on cam within {bound} near 90deg;");
        assert_eq!(refusal(&point("29mm"), eccentric, lobed), None);
        let deep = refusal(&point("40mm"), eccentric, lobed).expect("too deep");
        assert!(
            deep.contains("foot `w`: `within 40mm`")
                && deep.contains("inner side, 29.")
                && deep.contains("w_gap;`"),
            "{deep}"
        );
        // Kept outside by a limit of its own.
        let kept = format!("{} limit hollow: -size <= w_gap <= 1m;", point("40mm"));
        assert_eq!(refusal(&kept, eccentric, lobed), None);
        // Tips have the radius of curvature r²/(r − r″), and flanks are hollow.
        let tip = 0.036_f64.powi(2) / (0.036 + 0.054);
        let circle = "foot w of circle([0m, y], 8mm) on cam within size + 20mm near 90deg;";
        let far = refusal(circle, lobed, eccentric).expect("too far");
        assert!(far.contains("`within 25mm` is beyond the reach of the curve `cam`"), "{far}");
        let advised = far.rsplit("within ").next().and_then(|rest| rest.strip_suffix("mm`"));
        let advised: f64 = advised.and_then(|number| number.parse().ok()).expect("a number");
        assert!(advised < 1e3 * tip && advised > 0.99e3 * tip, "{far} {tip}");
    }

    #[test]
    fn a_hollow_below_a_flat_face_and_a_clockwise_curve_are_refused() {
        let flat = "foot w of flat([0m, y], -90deg) on cam within 80mm near 90deg;";
        assert_eq!(refusal(flat, eccentric, lobed), None);
        let hollow = refusal(flat, lobed, eccentric).expect("a hollow curve");
        assert!(hollow.contains("the curve `cam`: the curve is hollow"), "{hollow}");
        let rim = "foot w of [0m, y] on rim within 5mm near 90deg;";
        let (along, up) = (|w: f64| 0.03 * w.cos(), |w: f64| 0.02 * w.sin());
        assert_eq!(refusal(rim, along, up), None);
        let turned = refusal(rim, along, |w| -up(w)).expect("clockwise");
        assert!(turned.contains("the curve `rim` is gone through clockwise"), "{turned}");
    }

    #[test]
    fn two_curves_have_the_reach_of_the_pair() {
        let pair = |bound: &str| format!("foot w of pad at v on cam within {bound} near 90deg, -90deg;");
        assert_eq!(refusal(&pair("30mm"), eccentric, eccentric), None);
        let beyond = refusal(&pair("70mm"), eccentric, eccentric).expect("beyond");
        assert!(beyond.contains("the curve `cam` and `pad` have one pair"), "{beyond}");
        let sharp = refusal(&pair("1mm"), lobed, lobed).expect("two hollow curves");
        assert!(sharp.contains("the curve `cam` or `pad`"), "{sharp}");
    }
}

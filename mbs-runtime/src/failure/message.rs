//! Messages of failures: the fault, its place, and the cure.

use core::fmt;

use crate::failure::checks::WIDTH;
use crate::failure::{DerivativeOrder, Failure, FailureKind};
use crate::mechanism::Entry;
use crate::mechanism::dynamic::MissingSlope;

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = Time(self.time.unwrap_or(0.0));
        match &self.kind {
            FailureKind::NonFinite { name, line: 0 } => write!(f, "`{name}` is not a finite number"),
            FailureKind::NonFinite { name, line } => {
                write!(f, "`{name}` (line {line}) is not a finite number")
            }
            FailureKind::Negative { name, line, parameter: WIDTH, value } => write!(
                f,
                "the width of row `{name}` (line {line}) is {value:e}: a row may contradict others by 0 or more"
            ),
            FailureKind::Negative { name, line, parameter, value } => write!(
                f,
                "`{name}` (line {line}) is {value:e}, with `{parameter}` as it is: masses, moments of inertia and the sum of two less the third, \
                 stiffness, damping and friction are at least 0"
            ),
            FailureKind::Unresolved { coordinate, value, .. } => write!(
                f,
                "`{}` (line {}) is {value:.3e} {} at t = {time} s, too large for its number type to tell positions \
                 apart; take off whole turns, or use `f64`",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            FailureKind::NotConverged { row, residual, required, iterations, .. } => write!(
                f,
                "no position at t = {time} s: after {iterations} iterations row `{}` (line {}) is still {residual:.3e} {} \
                 off, required {required:.3e}; take a smaller step, or check that the mechanism can reach this position",
                row.name, row.line, row.unit
            ),
            FailureKind::NotFollowed { part, margin, single } => write!(
                f,
                "the way to the position at t = {time} s is lost after {part:.6} of it, at margin {margin:.3e}: beyond, the assembly is in \
                 doubt; {}take a smaller step, or one that ends farther from the singular position",
                if *single { "compute in `f64`, which decides nearer to singular positions, " } else { "" },
            ),
            FailureKind::OverBudget { evaluations, required, .. } if evaluations < required => write!(
                f,
                "the budget leaves {evaluations} evaluations for the way to the position at t = {time} s, which no part of it takes: give \
                 it {required} more, or take a smaller step"
            ),
            FailureKind::OverBudget { part, evaluations, .. } => write!(
                f,
                "the budget of {evaluations} evaluations ended after {part:.6} of the way to the position at t = {time} s; the next step \
                 goes on from there"
            ),
            FailureKind::Discontinuous { row, part, .. } => write!(
                f,
                "row `{}` (line {}) jumps on the way to the position at t = {time} s, after {part:.6} of it; make what drives it \
                 continuous, or assemble anew behind the jump",
                row.name, row.line
            ),
            FailureKind::NotAssemblable { row, residual, rows, .. } => write!(
                f,
                "the mechanism cannot be assembled at t = {time} s: {rows} cannot hold {}, `{}` stays {residual:.3e} \
                 {} open at best; check the dimensions, or start from a better guess",
                if rows.rows().nth(1).is_some() { "together" } else { "with what is driven" },
                row.name,
                row.unit
            ),
            FailureKind::Singular { row, coordinate, margin, required, reference, .. } => {
                write!(
                    f,
                    "the mechanism is singular at t = {time} s: rows around `{}` (line {}) do not determine `{}` (line \
                     {}); margin {margin:.3e}, required {required:.3e}",
                    row.name, row.line, coordinate.name, coordinate.line
                )?;
                match reference {
                    Some(Entry { name, line, .. }) => {
                        write!(f, ", lengths in parts of `{name}` (line {line})")
                    }
                    None => Ok(()),
                }
            }
            FailureKind::WrongBranch { branch, value, .. } => write!(
                f,
                "the assembly found at t = {time} s is not the declared one: branch `{}` (line {}) is {value:.3e}, not \
                 positive; take a smaller step, or assemble from a guess on the other side",
                branch.name, branch.line
            ),
            FailureKind::BeyondLimit { limit, value, bound, .. } => write!(
                f,
                "limit `{}` (line {}) is passed at t = {time} s: {value} {} is beyond {bound}; turn back, or widen the \
                 range",
                limit.name, limit.line, limit.unit
            ),
            FailureKind::TooFar { coordinate, distance, allowed, .. } => write!(
                f,
                "the position at t = {time} s is not next to the saved one: `{}` (line {}) differs by {distance:.3e} in \
                 the reference metric, allowed {allowed:.3e}; start at the time and with the inputs of the saved state",
                coordinate.name, coordinate.line
            ),
            FailureKind::InvalidMethodParameter { name, value, most } if most.is_finite() => {
                write!(f, "the method's {name} is {value}: it must be between 0 and {most}")
            }
            FailureKind::InvalidMethodParameter { name, value: 0.0, .. } => {
                write!(f, "the method's {name} is 0: it must be above 0")
            }
            FailureKind::InvalidMethodParameter { name, value, .. } => {
                write!(f, "the method's {name} is {value:e}: it must be a number and at least 0")
            }
            FailureKind::FrictionLocked { row, .. } => write!(
                f,
                "no forces balance at t = {time} s: friction changes the force of row `{}` (line {}) by more than it takes up; with this \
                 coefficient the mechanism jams there, whatever the step",
                row.name, row.line
            ),
            FailureKind::Ambiguous { row, solutions, all: true, .. } => write!(
                f,
                "{solutions} sets of forces balance at t = {time} s: friction changes the force of row `{}` (line {}) by more than it takes \
                 up, so that rigid bodies have no one motion there; lower the coefficient, or make a body elastic",
                row.name, row.line
            ),
            FailureKind::Ambiguous { row, solutions, .. } => write!(
                f,
                "forces at t = {time} s are not known to be the only ones that balance ({solutions} found): friction changes the force of row \
                 `{}` (line {}) by about what it takes up; lower the coefficient, or make a body elastic",
                row.name, row.line
            ),
            FailureKind::SharedNormalForce { row, .. } => write!(
                f,
                "friction at t = {time} s depends on the force of row `{}` (line {}), which it shares in any way with rows that follow from \
                 each other; leave out what is too many, make a body elastic, or give friction a force that they bear together",
                row.name, row.line
            ),
            FailureKind::InvalidStep { step, .. } => write!(
                f,
                "a step of {step:e} s from t = {time} s leads nowhere: it must be positive and change the time"
            ),
            FailureKind::NoSteps { until } => write!(
                f,
                "no steps lead from t = {time} s to t = {} s: their number is 0; give 1 or more, or let `advance_to` choose them",
                Time(*until)
            ),
            FailureKind::Unbounded { coordinate, value, .. } => write!(
                f,
                "the motion grows without bound: a step takes `{}` (line {}) to {value:.3e} {} at t = {time} s; take smaller \
                 steps, project onto the constraints where they drift, or use an implicit method where the mechanism is stiff",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            FailureKind::EnergyGain { kinetic, available, .. } => write!(
                f,
                "the step to t = {time} s is too long to follow the motion: it ends with a kinetic energy of {kinetic:.3e} J, where its \
                 start, potentials and the power supplied explain {available:.3e} J; take smaller steps, or let `advance_to` choose them"
            ),
            FailureKind::OutOfReach { until, step, .. } => write!(
                f,
                "t = {} s is out of reach from t = {time} s: steps of {step:.3e} s, as the tolerance asks for, are too many; \
                 end earlier, loosen the tolerance, or advance in several calls",
                Time(*until)
            ),
            FailureKind::UnresolvedTolerance { tolerance, least, .. } => write!(
                f,
                "rounding alone is more than a tolerance of {tolerance:e} allows: at least {least:.1e} is needed in numbers of \
                 this type"
            ),
            FailureKind::Unreachable { accuracy, best } if best.is_finite() => write!(
                f,
                "an error of {accuracy:e} cannot be reached: the best estimate is {best:.1e}; ask for more than that, or end earlier"
            ),
            FailureKind::Unreachable { accuracy, .. } => write!(
                f,
                "an error of {accuracy:e} cannot be reached: errors do not fall with the tolerance; end earlier"
            ),
            FailureKind::Undecided { margin, single } => write!(
                f,
                "rounding{} decides where the motion goes at t = {time} s, next to a singular position (margin {margin:.1e}): \
                 {}take `Projection` if the formulation is another one, give the dimensions all their digits, or loosen the tolerance; of \
                 a start, declare the rates of all coordinates or start beside it",
                if *single { " of `f32`" } else { "" },
                if *single { "compute in `f64`, which decides nearer to it; or " } else { "" },
            ),
            FailureKind::StepTooSmall { step, .. } => write!(
                f,
                "stuck at t = {time} s: even a step of {step:.3e} s is not accurate enough; loosen the tolerance, look for \
                 a jump in the forces or for a mass or length of 0, or use an implicit method where the mechanism is stiff"
            ),
            FailureKind::StepTooShort { step, least } => write!(
                f,
                "the step of {step:.1e} s to t = {time} s is too short for numbers of this type: rounding of positions, over its square, \
                 hides the multipliers that friction needs; take steps of {least:.1e} s or more, compute in `f64`, or use `Extrapolated`"
            ),
            FailureKind::StepTooLong { product, allowed, .. } => write!(
                f,
                "the step at t = {time} s is too long: step times frequency is {product:.3}, allowed {allowed:.3}; take a \
                 smaller step or a lower frequency"
            ),
            FailureKind::StepUnresolved { step, part, allowed } => write!(
                f,
                "the step of {step:.1e} s from t = {time} s does not resolve the forces: its thirds correct the velocities by \
                 {part:.2} of the largest, allowed {allowed:.2}; take shorter steps, or adaptive ones"
            ),
            FailureKind::Inconsistent { rows, level, residual, required, .. } => write!(
                f,
                "{}{rows} contradict each other at t = {time} s: {residual:.3e} stays open at best, required \
                 {required:.3e}; give the dimensions that let these rows follow from one another all their digits, or \
                 leave the surplus rows out",
                match level {
                    DerivativeOrder::Position => "",
                    DerivativeOrder::Velocity => "the rates of ",
                    DerivativeOrder::Acceleration => "the accelerations of ",
                }
            ),
            FailureKind::OffConstraints { row, rate, residual, allowed, .. } => write!(
                f,
                "{} `{}` (line {}) is violated at t = {time} s: {residual:.3e}, allowed {allowed:.3e}; start on the \
                 constraints or let the start be projected; on the way, take smaller steps",
                if *rate { "the rate of row" } else { "row" },
                row.name,
                row.line
            ),
            FailureKind::SingularMass { coordinate, .. } => write!(
                f,
                "the acceleration of `{}` (line {}) is not determined at t = {time} s: it can move without any mass \
                 moving; give it mass, or a row that fixes it",
                coordinate.name, coordinate.line
            ),
            FailureKind::VanishingGradient { row, .. } => write!(
                f,
                "row `{}` (line {}) holds nothing at t = {time} s: no coordinate changes it there, as where a length is 0 or bars at \
                 rest are in line; give the length a value, or start beside that position",
                row.name, row.line
            ),
            FailureKind::NoEquilibrium { coordinate, force, .. } => write!(
                f,
                "no position of rest at t = {time} s: where the forces come nearest to balance they still push `{}` (line \
                 {}) with {force:.3e} J/{}; let a force answer it, hold it by a drive, or start elsewhere",
                coordinate.name, coordinate.line, coordinate.unit
            ),
            FailureKind::EquilibriumNotConverged { coordinate, iterations, .. } => write!(
                f,
                "no balance of forces at t = {time} s after {iterations} iterations: `{}` (line {}) is farthest off; take \
                 a smaller step, or search for a rest from nearer",
                coordinate.name, coordinate.line
            ),
            FailureKind::NoStateEquilibrium { state, .. } => write!(
                f,
                "no position of rest at t = {time} s: the rate of the state `{}` (line {}) does not vanish for any value of it",
                state.name, state.line
            ),
            FailureKind::StatesUnknown { state, .. } => write!(
                f,
                "the forces at t = {time} s depend on the state `{}` (line {}), whose value is not known; give the states too",
                state.name, state.line
            ),
            FailureKind::NotSmooth { missing: MissingSlope { slope, function, order, declared, .. } } => {
                write!(
                    f,
                    "{slope} needs the derivative of order {order} of `{}` (line {}), which is declared C{declared}: declare it C{order} and supply such a function, or take an explicit method",
                    function.name, function.line
                )
            }
            FailureKind::SetValuedForce { row } => write!(
                f,
                "`{}` (line {}) is a friction that sticks or a rigid contact, and this method or analysis does not know its force or its slope: \
                 follow the motion by `Explicit` with `Radau5`, or `DormandPrince8` where it is not stiff, or take a smooth law, `speed` in \
                 place of `sticks`, a contact with `stiffness`",
                row.name, row.line
            ),
            FailureKind::SetValuedEdge { row } => write!(
                f,
                "`{}` (line {}) is between two modes at t = {time} s: a contact that touches without a force, or a friction at its limit, so \
                 small motions have no linear equation; take a state beside it, or a smooth law, `speed` in place of `sticks`, a contact with \
                 `stiffness`",
                row.name, row.line
            ),
            FailureKind::EventOfMotion { event } => write!(
                f,
                "event `{}` (line {}) sets values that belong to a motion, which this method or analysis does not follow, or that change from \
                 rest to rest: follow the motion by `Explicit`, with `Radau5`, or `DormandPrince8` where it is not stiff, or take a scene \
                 without the event",
                event.name, event.line
            ),
            FailureKind::StickingUndecided { row } => write!(
                f,
                "`{}` (line {}) is undecided at t = {time} s: with the forces there a friction can neither stick nor slide, a contact neither \
                 push nor open, or a friction shares a force with others in a ratio that is not known; check coefficients and normal \
                 forces, and leave out frictions along lengths that follow from each other",
                row.name, row.line
            ),
            FailureKind::ContactUndecided { contact, modes } => write!(
                f,
                "{} of contact `{}` (line {}) with its friction at t = {time} s: friction presses it deeper than its force lifts it \
                 (Painlevé's paradox); lower its coefficient of friction, or give the contact a `stiffness`",
                if *modes == 0 {
                    "no force is consistent with the motion"
                } else {
                    "several forces are consistent with the motion"
                },
                contact.name,
                contact.line
            ),
            FailureKind::Penetration { contact, gap } => write!(
                f,
                "contact `{}` (line {}) is open with a gap of {gap:e} m at t = {time} s: start with gaps of 0 or more; in a motion take \
                 shorter steps, or an event resolution that sees the touch",
                contact.name, contact.line
            ),
            FailureKind::ImpactUndecided { contact } => write!(
                f,
                "the impact of contact `{}` (line {}) at t = {time} s is undecided: gaps that follow from each other have coefficients of \
                 restitution that contradict, or friction leaves several ways to go on; give them the same one, or less friction",
                contact.name, contact.line
            ),
            FailureKind::Chatter { entry, parts } => write!(
                f,
                "`{}` (line {}), or another one, changes between sticking and sliding, closed and open, or begun and ended, more than {parts} \
                 times within the step from t = {time} s: take shorter steps; give an event another end, `until`, where what it switches \
                 leads back to its condition",
                entry.name, entry.line
            ),
            FailureKind::MechanismMismatch { mechanism } => {
                write!(f, "the saved state is not one of `{mechanism}`: name or coordinates differ")
            }
        }
    }
}

/// A time in plain digits, or with an exponent where those would be many.
struct Time(f64);

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Time(time) = *self;
        let plain = time == 0.0 || (1e-5..1e9).contains(&time.max(-time));
        if plain { write!(f, "{time}") } else { write!(f, "{time:e}") }
    }
}

impl core::error::Error for Failure {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::failure::conflicting_rows::ConflictingRows;
    use std::string::ToString;

    const ROWS: &[Entry] = &[*ROW];
    const ROW: &Entry = &Entry { name: "closure.0", unit: "m", line: 21 };

    #[test]
    fn every_failure_names_its_line_in_the_text() {
        let (time, residual, required) = (0.5, 1e-3, 1e-14);
        let failures = [
            FailureKind::NonFinite { name: "omega", line: 21 }.without_time(),
            FailureKind::Negative { name: "rod.mass", line: 21, parameter: "rho", value: -1.0 }
                .without_time(),
            FailureKind::Negative { name: "pin.0", line: 21, parameter: WIDTH, value: -1.0 }.without_time(),
            FailureKind::Unresolved { coordinate: ROW, value: 1e300 }.at(time),
            FailureKind::NotConverged { row: ROW, residual, required, iterations: 9 }.at(time),
            FailureKind::NotAssemblable {
                row: ROW,
                residual,
                rows: ConflictingRows::of(ROWS, [1.0].into_iter()),
            }
            .at(time),
            FailureKind::Singular { row: ROW, coordinate: ROW, margin: 0.0, required, reference: None }
                .at(time),
            FailureKind::WrongBranch { branch: ROW, value: -1.0 }.at(time),
            FailureKind::BeyondLimit { limit: ROW, value: 2.0, bound: 1.0 }.at(time),
            FailureKind::TooFar { coordinate: ROW, distance: 1.0, allowed: 0.5 }.at(time),
            FailureKind::Inconsistent {
                rows: ConflictingRows::of(ROWS, [1.0].into_iter()),
                level: DerivativeOrder::Velocity,
                residual,
                required,
            }
            .at(time),
            FailureKind::OffConstraints { row: ROW, rate: false, residual, allowed: required }.at(time),
            FailureKind::Unbounded { coordinate: ROW, value: 1e12 }.at(time),
            FailureKind::SingularMass { coordinate: ROW }.at(time),
            FailureKind::VanishingGradient { row: ROW }.at(time),
            FailureKind::NoEquilibrium { coordinate: ROW, force: 0.5 }.at(time),
            FailureKind::EquilibriumNotConverged { coordinate: ROW, iterations: 9 }.at(time),
            FailureKind::FrictionLocked { row: ROW }.at(time),
            FailureKind::Ambiguous { row: ROW, solutions: 2, all: true }.at(time),
            FailureKind::Ambiguous { row: ROW, solutions: 1, all: false }.at(time),
            FailureKind::SharedNormalForce { row: ROW }.at(time),
            FailureKind::SetValuedForce { row: ROW }.without_time(),
            FailureKind::SetValuedEdge { row: ROW }.at(time),
            FailureKind::EventOfMotion { event: ROW }.without_time(),
            FailureKind::StickingUndecided { row: ROW }.at(time),
            FailureKind::ContactUndecided { contact: ROW, modes: 0 }.at(time),
            FailureKind::Penetration { contact: ROW, gap: -1e-3 }.at(time),
            FailureKind::ImpactUndecided { contact: ROW }.at(time),
            FailureKind::Chatter { entry: ROW, parts: 64 }.at(time),
            FailureKind::NoStateEquilibrium { state: ROW }.at(time),
            FailureKind::StatesUnknown { state: ROW }.at(time),
        ];
        for failure in failures {
            assert!(failure.to_string().contains("(line 21)"), "{failure}");
        }
        let foreign = FailureKind::MechanismMismatch { mechanism: "Crank" }.without_time().to_string();
        assert_eq!(foreign, "the saved state is not one of `Crank`: name or coordinates differ");
        let (name, most) = ("spectral radius rho", 1.0);
        let radius =
            FailureKind::InvalidMethodParameter { name, value: 1.5, most }.without_time().to_string();
        assert_eq!(radius, "the method's spectral radius rho is 1.5: it must be between 0 and 1");
        assert_eq!(
            FailureKind::NonFinite { name: "t", line: 0 }.without_time().to_string(),
            "`t` is not a finite number"
        );
    }
}

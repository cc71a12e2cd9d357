//! Names that are declared nowhere: which other name is meant, or the declaration that fits their uses.

use proc_macro2::Span;

use super::Model;
use super::names::{CONSTANTS, Elsewhere, Names, functions};
use super::resolve::resolve;
use super::unit_faults::parsed;
use super::uses::{OF_ANGLES, Undeclared};
use super::written::{operands, start, written};
use crate::diagnostics::{Diagnostics, nearest};
use crate::syntax::ast::{
    Element, Expression, Instruction, Name, Operation, Signature, Statement, StatementKind, Type,
};
use crate::syntax::unit_symbols::DOTS;

/// Values of the language by other names.
const OTHER_NAMES: [(&str, &str); 14] = [
    ("time", "t"),
    ("Time", "t"),
    ("TIME", "t"),
    ("zeit", "t"),
    ("π", "PI"),
    ("pi", "PI"),
    ("Pi", "PI"),
    ("M_PI", "PI"),
    ("τ", "TAU"),
    ("tau", "TAU"),
    ("Tau", "TAU"),
    ("g", "1g0"),
    ("gravity", "1g0"),
    ("e", "exp(1)"),
];

/// The value of the language that another name means, with the reason.
pub fn meant_value(name: &str) -> Option<String> {
    let (_, meant) = OTHER_NAMES.iter().find(|(other, _)| *other == name)?;
    Some(match *meant {
        "t" => "the time is `t`".into(),
        "1g0" => "declare it, or write standard gravity as `1g0`".into(),
        "exp(1)" => "declare it, or write Euler's number as `exp(1)`".into(),
        constant => format!("write `{constant}`"),
    })
}

/// Endings and beginnings that mean a rate, and its order.
const RATES: [(&str, &str, u8); 17] = [
    ("", "_ddot", 2),
    ("", "_dot", 1),
    ("", "ddot", 2),
    ("", "dot", 1),
    ("", "_dd", 2),
    ("", "_d", 1),
    ("", "_pp", 2),
    ("", "_p", 1),
    ("", "_prime", 1),
    ("", "dd", 2),
    ("", "d", 1),
    ("dd_", "", 2),
    ("d_", "", 1),
    ("dot_", "", 1),
    ("ddot_", "", 2),
    ("dd", "", 2),
    ("d", "", 1),
];

/// The declared name of which a name means the rate, and the order of the rate: `x` and 1 of `x_dot`.
pub fn rate_of(name: &str, is_declared: impl Fn(&str) -> bool) -> Option<(&str, u8)> {
    RATES.iter().find_map(|(before, behind, order)| {
        let stem = name.strip_prefix(before)?.strip_suffix(behind)?;
        (!stem.is_empty() && is_declared(stem)).then_some((stem, *order))
    })
}

/// Declared names that differ from a name in their digits alone.
fn is_sibling(name: &str, other: &str) -> bool {
    let stem = |text: &str| text.chars().filter(|c| !c.is_ascii_digit()).collect::<String>();
    let numbered = |text: &str| text.chars().any(|c| c.is_ascii_digit());
    name != other && numbered(name) && numbered(other) && stem(name) == stem(other)
}

/// Units that a name may have, those first that are met most.
const UNITS: [&str; 17] = [
    "1", "m", "m/s", "rad/s", "kg", "N", "N*m", "s", "N/m", "N*s/m", "N*m*s", "kg*m^2", "m/s^2", "rad/s^2",
    "m^2", "1/m", "N*s",
];

/// Most statements of a text in which units are tried: each trial resolves it once more.
const MOST_STATEMENTS: usize = 400;

/// Before: statements, and their names with those that are declared nowhere. After: a name that is used often, or has siblings,
/// is reported with a declaration that fits.
pub fn explain(statements: &[Statement], names: &mut Names, diagnostics: &mut Diagnostics) {
    let undeclared = names.undeclared.clone();
    for fault in &undeclared {
        let Undeclared { name, span, message, is_function } = fault;
        if *is_function {
            if let Some(help) = function(statements, names, name, diagnostics.number().saturating_sub(1))
                && diagnostics.withdraw(*span, message)
            {
                diagnostics.report(*span, message.clone(), help);
            }
            continue;
        }
        if let Some(help) = declared_otherwise(statements, name) {
            if diagnostics.withdraw(*span, message) {
                diagnostics.report(*span, message.clone(), help);
            }
            continue;
        }
        let times = names.uses.get(name).map_or(1, |(count, _)| *count);
        let sibling = statements.iter().find_map(|statement| match &statement.kind {
            StatementKind::Coord { name: other, kind, .. } if is_sibling(name, &other.text) => {
                Some(("coord", kind))
            }
            StatementKind::Param { name: other, kind, .. } if is_sibling(name, &other.text) => {
                Some(("param", kind))
            }
            _ => None,
        });
        let sibling_of_const = statements.iter().find_map(|statement| match &statement.kind {
            StatementKind::Const { name: other, unit, .. } if is_sibling(name, &other.text) => {
                Some(unit.text.clone())
            }
            _ => None,
        });
        let near = nearest(name, names.all().chain(CONSTANTS)).filter(|other| !is_sibling(name, other));
        if times < 2 && near.is_some() {
            continue;
        }
        let declaration = match (sibling, sibling_of_const) {
            (Some((keyword, kind)), _) if kind.shape.is_empty() => {
                format!("{keyword} {name}: {} = …;", kind.unit.text)
            }
            (_, Some(unit)) => format!("const {name}: {unit} = …;"),
            _ => {
                let others = diagnostics.number().saturating_sub(1);
                let Some((unit, is_square)) = fitting(statements, name, others) else {
                    continue;
                };
                let unit = if unit == "1" && is_in_angle(statements, name) { "rad" } else { unit };
                let keyword = if is_square { "coord" } else { keyword(statements, name) };
                format!("{keyword} {name}: {unit} = …;")
            }
        };
        let help = match near {
            Some(other) => format!("did you mean `{other}`? else declare it: `{declaration}`"),
            None => format!("declare it: `{declaration}`"),
        };
        if diagnostics.withdraw(*span, message) {
            diagnostics.report(*span, message.clone(), help);
        }
    }
}

/// Cure at a name that has a declaration without a value: an output, a body or another element.
fn declared_otherwise(statements: &[Statement], name: &str) -> Option<String> {
    statements.iter().find_map(|statement| match &statement.kind {
        StatementKind::Out { name: output, value, .. } if output.text == name => {
            let value = written(&value.code);
            Some(format!("`{name}` is an output, which is read outside alone: declare `let {name} = {value};` too, for the text"))
        }
        StatementKind::Element { kind: Element::Body, name: body, fields } if body.text == name => {
            let field = |wanted: &str| {
                fields.iter().find(|field| field.name.text == wanted).map(|field| written(&field.value.code))
            };
            let place = field("com").unwrap_or_else(|| "P".into());
            Some(match field("angle") {
                Some(angle) => format!(
                    "`{name}` is a body: write its angle `{angle}` for a torque, or a point on it, `{place} of {name}`, for a force"
                ),
                None => format!("`{name}` is a body: write a point on it, `{place} of {name}`"),
            })
        }
        _ => None,
    })
}

/// Cure at a function that is declared nowhere.
fn function(statements: &[Statement], names: &Names, name: &str, others: usize) -> Option<String> {
    let mut expressions = statements.iter().flat_map(|statement| statement.kind.expressions());
    let (arguments, indexed) = expressions.find_map(|Expression { code }| {
        code.iter().enumerate().find_map(|(index, instruction)| match &instruction.operation {
            Operation::Call { function, arguments, indexed, .. } if function == name => {
                Some((operands(code, index, *arguments)?, *indexed))
            }
            _ => None,
        })
    })?;
    let texts: Vec<String> = arguments.iter().map(|argument| written(argument)).collect();
    if let Some(meant) = meant_function(name, &texts) {
        return Some(meant);
    }
    if name.contains(DOTS) {
        let product = name.replace(DOTS, "*");
        return Some(format!(
            "`·` is part of the name; write a product as `{product}({})`",
            texts.join(", ")
        ));
    }
    let times = names.uses.get(name).map_or(1, |(count, _)| *count);
    let known = names.functions().chain(functions());
    if times < 2 && nearest(name, known).is_some() || arguments.len() != 1 {
        return None;
    }
    let (unit, argument) =
        signature(statements, name, (indexed, others)).unwrap_or_else(|| ("m".into(), "rad".into()));
    Some(match indexed {
        true => format!(
            "declare it with the number of functions, here 2: `function {name}: [{unit}; 2]({argument}), C2;`"
        ),
        false => format!("declare it: `function {name}: {unit}({argument}), C2;`"),
    })
}

/// Functions of an array that is tried.
const IN_TRIALS: f64 = 64.0;

/// The units of value and argument with which a function, or an array of them, leaves no fault but the `others`: `rad`, `s`.
fn signature(
    statements: &[Statement],
    name: &str,
    (indexed, others): (bool, usize),
) -> Option<(String, String)> {
    if statements.len() > MOST_STATEMENTS {
        return None;
    }
    let of_side = side_opposite(statements, name);
    let pairs = OF_ARGUMENTS.iter().flat_map(|argument| UNITS.iter().map(move |unit| (*unit, *argument)));
    pairs.into_iter().find_map(|(unit, argument)| {
        let span = Span::call_site();
        let length = Operation::Number { value: IN_TRIALS, unit: None, integer: true };
        let length = Expression { code: vec![Instruction { operation: length, span }] };
        let shape = if indexed { vec![length] } else { Vec::new() };
        let signature = Signature {
            value: Type { unit: parsed(unit, span)?, shape },
            argument: parsed(argument, span)?,
            continuity: 9,
            period: None,
        };
        let kind = StatementKind::Function { name: Name { text: name.to_owned(), span }, signature };
        let fits = leaves_no_fault(statements, kind, others);
        let unit = of_side.as_deref().filter(|_| unit == "1").unwrap_or(unit);
        fits.then(|| (unit.to_owned(), argument.to_owned()))
    })
}

/// Declared unit of the name that is the other side of an equation with a call of the function.
fn side_opposite(statements: &[Statement], function: &str) -> Option<String> {
    let is_call = |side: &Expression| matches!(side.code.last().map(|last| &last.operation), Some(Operation::Call { function: name, .. }) if name == function);
    let unit = |side: &Expression| match side.code.as_slice() {
        [Instruction { operation: Operation::Name(name), .. }] => {
            statements.iter().find_map(|statement| match &statement.kind {
                StatementKind::Coord { name: declared, kind, .. } if declared.text == *name => {
                    Some(kind.unit.text.clone())
                }
                _ => None,
            })
        }
        _ => None,
    };
    statements.iter().find_map(|statement| match &statement.kind {
        StatementKind::Drive { equation, .. } if is_call(&equation.right) => unit(&equation.left),
        _ => None,
    })
}

/// Units of arguments that are tried.
const OF_ARGUMENTS: [&str; 6] = ["s", "rad", "m", "m/s", "rad/s", "N"];

/// `true` if the text with one more declaration has no fault but the `others`.
fn leaves_no_fault(statements: &[Statement], kind: StatementKind, others: usize) -> bool {
    tried(statements, kind, others).is_some()
}

/// The text with one more declaration, if it has no fault but the `others`.
fn tried(statements: &[Statement], kind: StatementKind, others: usize) -> Option<Model> {
    let mut tried = statements.to_vec();
    tried.push(Statement { docs: Vec::new(), kind });
    let mut diagnostics = Diagnostics::default();
    let (model, names) = resolve(&tried, Elsewhere::default(), &mut diagnostics);
    (names.unit_faults.is_empty() && diagnostics.number() <= others).then_some(model)
}

/// The only unit with which the name, as a coordinate, leaves no fault but the `others`; `true` if the rows then fix every
/// coordinate of a text without masses, so that a coordinate is what is missing.
fn fitting(statements: &[Statement], name: &str, others: usize) -> Option<(&'static str, bool)> {
    if statements.len() > MOST_STATEMENTS {
        return None;
    }
    let mut fitting = UNITS.into_iter().filter_map(|symbol| {
        let span = Span::call_site();
        let unit = parsed(symbol, span)?;
        let zero =
            Instruction { operation: Operation::Number { value: 0.0, unit: None, integer: true }, span };
        let kind = StatementKind::Coord {
            name: Name { text: name.to_owned(), span },
            kind: Type { unit, shape: Vec::new() },
            guess: Some(Expression { code: vec![zero] }),
        };
        let model = tried(statements, kind, others)?;
        Some((symbol, model.dynamics.is_none() && model.rows.len() == model.coordinates.len()))
    });
    let first = fitting.next();
    first.filter(|_| fitting.next().is_none())
}

/// `true` if the name stands in the argument of a function of angles.
fn is_in_angle(statements: &[Statement], name: &str) -> bool {
    let mut expressions = statements.iter().flat_map(|statement| statement.kind.expressions());
    expressions.any(|expression| {
        expression.code.iter().enumerate().any(|(index, instruction)| {
            let is_call = matches!(&instruction.operation, Operation::Call { function, .. } if OF_ANGLES.contains(&function.as_str()));
            is_call
                && start(&expression.code, index)
                    .and_then(|from| expression.code.get(from..index))
                    .is_some_and(|argument| argument.iter().any(|part| is_name(part, name)))
        })
    })
}

fn is_name(instruction: &Instruction, name: &str) -> bool {
    matches!(&instruction.operation, Operation::Name(text) if text == name)
}

/// `coord` where the name stands alone in an equation, a vector, a rate or a condition; else `param`.
fn keyword(statements: &[Statement], name: &str) -> &'static str {
    let is_sought = statements.iter().any(|statement| {
        let rows = matches!(
            statement.kind,
            StatementKind::Constraint { .. }
                | StatementKind::Drive { .. }
                | StatementKind::Branch { .. }
                | StatementKind::Limit { .. }
        );
        statement.kind.expressions().into_iter().any(|Expression { code }| {
            let alone = rows && matches!(code.as_slice(), [only] if is_name(only, name));
            let inside = code.windows(2).any(|pair| {
                matches!(pair, [part, Instruction { operation: Operation::Call { function, .. }, .. }]
                    if is_name(part, name) && function.starts_with("der"))
            });
            alone || inside
        })
    });
    if is_sought { "coord" } else { "param" }
}

/// Functions of other languages, and what a text has in their place, of the arguments as written.
pub fn meant_function(name: &str, arguments: &[String]) -> Option<String> {
    let first = arguments.first().map_or("x", String::as_str);
    let second = arguments.get(1).map_or("y", String::as_str);
    let power = |base: &str, exponent: &str| {
        let atom =
            base.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.')) || base.ends_with([')', ']']);
        if atom { format!("{base}^{exponent}") } else { format!("({base})^{exponent}") }
    };
    let renamed = [
        ("cosine", "cos"),
        ("sine", "sin"),
        ("tangent", "tan"),
        ("arcsin", "asin"),
        ("arccos", "acos"),
        ("arctan", "atan"),
        ("arctan2", "atan2"),
        ("log", "ln"),
        ("fabs", "abs"),
        ("sgn", "sign"),
        ("signum", "sign"),
        ("length", "norm"),
        ("magnitude", "norm"),
        ("sqroot", "sqrt"),
    ];
    let call = |function: &str| format!("write `{function}({})`", arguments.join(", "));
    Some(match name {
        "sqr" | "square" | "sq" => format!("write a square as a power: `{}`", power(first, "2")),
        "cube" => format!("write it as a power: `{}`", power(first, "3")),
        "pow" | "power" | "powf" | "powi" => format!("write a power with `^`: `{}`", power(first, second)),
        "diff" | "deriv" | "ddt" | "derivative" | "velocity" | "vel" | "speed" => {
            format!("a rate is written `der({first})`")
        }
        "ddot" | "d2dt2" | "acceleration" | "accel" | "acc" => {
            format!("an acceleration is written `der2({first})`")
        }
        "floor" | "ceil" | "round" | "trunc" | "mod" | "fmod" | "rem" => {
            "a text has smooth functions alone: an angle over many turns is declared `coord phi: turn`".into()
        }
        "degrees" | "rad2deg" | "deg" => {
            format!("leave it out: `{first}` is in rad, and `mbs` shows angles in degrees")
        }
        "circle" => {
            format!(
                "a curve is that of the centre of a circle that rolls on it: write the centre, `{first}`; on a contour write \
                 `foot w of circle({}) on cam within 20mm;` and the row `w_gap == 0m;`",
                arguments.join(", ")
            )
        }
        "flat" => format!(
            "write `foot w of flat({}) on cam within 80mm;` and the row `w_gap == 0m;`",
            arguments.join(", ")
        ),
        "radians" | "deg2rad" => format!("a number takes its unit: `{first}deg`"),
        "sind" | "cosd" | "tand" => format!("write `{}({first}deg)`", name.trim_end_matches('d')),
        _ => {
            let (_, meant) = renamed.iter().find(|(other, _)| *other == name)?;
            call(meant)
        }
    })
}

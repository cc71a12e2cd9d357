//! Texts of the language's form with names, units and expressions by chance: each is translated or has faults, in every back end.

#![no_main]

use std::fmt::Write as _;

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;

const NAMES: [&str; 12] = ["a", "b", "c", "A", "B", "phi", "theta", "x", "y", "k", "e", "load"];
const UNITS: [&str; 13] =
    ["m", "rad", "s", "1", "kg", "N", "m/s", "rad/s", "N/m", "kg*m^2", "turn", "mm", "N*m"];
const NUMBERS: [&str; 14] = [
    "0",
    "1",
    "2",
    "0.5",
    "1e-3",
    "1e300",
    "2m",
    "30deg",
    "4 [m^2]",
    "3 [rad/s]",
    "1s",
    "9.81",
    "60rpm",
    "1kg",
];
const FUNCTIONS: [&str; 22] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "ln", "abs", "sinh", "tanh", "asinh", "unit",
    "norm", "rot", "der", "rate", "dot", "cross", "atan2", "law",
];
const OPERATORS: [&str; 5] = ["+", "-", "*", "/", "^"];

/// Writes parts of a text.
struct Writer<'a, 'b> {
    choices: &'a mut Unstructured<'b>,
    text: String,
}

impl Writer<'_, '_> {
    fn one(&mut self, of: &[&'static str]) -> Result<&'static str> {
        self.choices.choose(of).copied()
    }

    fn expression(&mut self, depth: u32) -> Result<String> {
        let most = if depth == 0 { 1 } else { 7 };
        Ok(match self.choices.int_in_range(0..=most)? {
            0 => self.one(&NAMES)?.to_owned(),
            1 => self.one(&NUMBERS)?.to_owned(),
            2 => format!(
                "{} {} {}",
                self.expression(depth - 1)?,
                self.one(&OPERATORS)?,
                self.expression(depth - 1)?
            ),
            3 => format!("{}({})", self.one(&FUNCTIONS)?, self.expression(depth - 1)?),
            4 => format!(
                "{}({}, {})",
                self.one(&FUNCTIONS)?,
                self.expression(depth - 1)?,
                self.expression(depth - 1)?
            ),
            5 => format!("[{}, {}]", self.expression(depth - 1)?, self.expression(depth - 1)?),
            6 => format!("-({})", self.expression(depth - 1)?),
            _ => {
                let name = self.one(&NAMES)?;
                format!("{name}[{}]", self.choices.int_in_range(0..=4)?)
            }
        })
    }

    fn unit(&mut self) -> Result<String> {
        let unit = self.one(&UNITS)?;
        Ok(match self.choices.int_in_range(0..=5)? {
            0 => format!("[{unit}; 2]"),
            1 => format!("[{unit}; 3]"),
            _ => unit.to_owned(),
        })
    }

    fn statement(&mut self) -> Result<()> {
        let (name, value) = (self.one(&NAMES)?, self.expression(2)?);
        let other = self.expression(3)?;
        let line = match self.choices.int_in_range(0..=24)? {
            0 => format!("const {name}: {} = {value};", self.unit()?),
            1 => format!("param {name}: {} = {value};", self.unit()?),
            2 => format!("param {name}: {} = {value} in 0.1..2, tolerance 0.1;", self.unit()?),
            3 => format!("input {name}: {}, rates;", self.unit()?),
            4 => format!("function {name}: {}({}), C2;", self.one(&UNITS)?, self.one(&UNITS)?),
            5..=7 => format!("coord {name}: {} = {value};", self.unit()?),
            8 => format!("coord {name}: {};", self.unit()?),
            9 => format!("let {name} = {other};"),
            10..=12 => format!("constraint c{} {{ {other} == {value}; }}", self.text.len()),
            13 => format!("constraint c{} redundant within 1e-6m {{ {other} == {value}; }}", self.text.len()),
            14 => format!("drive d{}: {other} == {value};", self.text.len()),
            15 => format!("branch b{}: {other} > 0;", self.text.len()),
            16 => format!("limit l{}: {value} <= {other} <= {value};", self.text.len()),
            17 => format!("out o{}: {} = {other};", self.text.len(), self.one(&UNITS)?),
            18 => format!("body {name} {{ mass: {value}, com: {other}, inertia: {value}, angle: {other} }}"),
            19 => format!("force f{}: {other} on {value};", self.text.len()),
            20 => format!(
                "tsda s{} {{ from: {value}, to: {other}, stiffness: 10, length: 0.4 }}",
                self.text.len()
            ),
            21 => format!("contact k{} {{ gap: {other}, stiffness: 1e5, damping: 0.1 }}", self.text.len()),
            22 => format!("state {name}: {} = 0, rate {other};", self.one(&UNITS)?),
            23 => format!("for i in 0..3 {{ constraint r{} {{ {other} == {value}; }} }}", self.text.len()),
            _ => format!("start {name} = {value} rate {other};"),
        };
        let _ = writeln!(self.text, "    {line}");
        Ok(())
    }
}

/// A text out of bytes.
fn written(bytes: &[u8]) -> Result<String> {
    let mut choices = Unstructured::new(bytes);
    let count = choices.int_in_range(1..=16)?;
    let mut writer = Writer { choices: &mut choices, text: String::from("pub mechanism Chance;\n") };
    for _ in 0..count {
        writer.statement()?;
    }
    Ok(writer.text)
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = written(bytes) else { return };
    let translated = mbs_codegen::expand_source(&text);
    assert!(
        translated.as_ref().map(ToString::to_string)
            == mbs_codegen::expand_source(&text).as_ref().map(ToString::to_string),
        "one text, two expansions:\n{text}"
    );
    // A fault is told by every back end, and by none where there is none.
    let definition = mbs_codegen::casadi_definition(&text, None);
    if translated.is_ok() && definition.is_err() {
        assert!(mbs_codegen::outline(&text).is_ok(), "translated and without an outline:\n{text}");
    }
    let _ = mbs_codegen::warnings(&text);
    let _ = mbs_codegen::formulas(&text, None);
    let _ = mbs_codegen::latex_formulas(&text, None);
    let _ = mbs_codegen::dynamic_formulas(&text, None);
    let _ = mbs_codegen::structure_of(&text, None);
    let _ = mbs_codegen::declarations(&text, None);
});

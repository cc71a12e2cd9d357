//! Texts by chance, written with arrays of functions and with functions one by one: the equations and the emitted code are the same.

use std::collections::BTreeMap;
use std::fmt::Write;

/// Functions of each array.
const LENGTH: usize = 3;

/// Numbers by chance (a linear congruential generator).
struct Chance(u64);

impl Chance {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// The same text with arrays, and with functions one by one.
#[derive(Clone, Default)]
struct Both {
    arrays: String,
    single: String,
}

impl Both {
    fn same(text: &str) -> Self {
        Both { arrays: text.to_owned(), single: text.to_owned() }
    }

    fn push(&mut self, other: &Both) {
        self.arrays += &other.arrays;
        self.single += &other.single;
    }
}

/// A call: `lift[K + 1].d1(…)` and `lift_2.d1(…)`.
fn call(chance: &mut Chance, depth: usize) -> Both {
    let (name, index) = (["lift", "law"][chance.below(2)], chance.below(LENGTH));
    let derivative = ["", "", ".d1", ".d2"][chance.below(4)];
    let number = match chance.below(4) {
        0 if index > 0 => format!("K + {}", index - 1),
        1 if index > 0 => format!("sum(i in 0..{index}: 1)"),
        2 => format!("2*{index} - {index}"),
        _ => index.to_string(),
    };
    let argument = expression(chance, depth);
    Both {
        arrays: format!("{name}[{number}]{derivative}({})", argument.arrays),
        single: format!("{name}_{index}{derivative}({})", argument.single),
    }
}

/// An expression of numbers.
fn expression(chance: &mut Chance, depth: usize) -> Both {
    let leaf = ["x", "y[0]", "y[1]", "y[2]", "p", "u", "1.25", "(t/1s)"];
    if depth == 0 {
        return Both::same(leaf[chance.below(leaf.len())]);
    }
    match chance.below(6) {
        0 => Both::same(leaf[chance.below(leaf.len())]),
        1 | 2 => call(chance, depth - 1),
        3 => {
            let mut text = Both::same(["sin(", "exp(-abs(", "sqrt(2 + sin("][chance.below(3)]);
            text.push(&expression(chance, depth - 1));
            let open = text.arrays.matches('(').count() - text.arrays.matches(')').count();
            text.push(&Both::same(&")".repeat(open)));
            text
        }
        operator => {
            let mut text = Both::same("(");
            text.push(&expression(chance, depth - 1));
            text.push(&Both::same([" + ", " - ", "*"][(operator + chance.below(3)) % 3]));
            text.push(&expression(chance, depth - 1));
            text.push(&Both::same(")"));
            text
        }
    }
}

/// A text with rows, forces, contacts, branches and outputs that call functions of two arrays.
fn text(seed: u64) -> Both {
    let mut chance = Chance(seed);
    let mut text = Both::same("pub mechanism Random; const K: 1 = 1; param p: 1 = 0.3; input u: 1, rates; ");
    for name in ["lift", "law"] {
        let _ = write!(text.arrays, "function {name}: [1; {LENGTH}](1), C9; ");
        for index in 0..LENGTH {
            let _ = write!(text.single, "function {name}_{index}: 1(1), C9; ");
        }
    }
    text.push(&Both::same(
        "coord x: 1 = 0.5; coord y: [1; 3] = [0.1, 0.2, 0.3]; coord z: [1; 2] = [0.1, 0.2]; drive first: x == ",
    ));
    // A drive knows the time alone, and calls of all functions keep each declaration in use.
    text.arrays += "lift[0](t/1s) + lift[1](p) + lift[K + 1](u) + sum(i in 0..3: law[i](t/1s));";
    text.single += "lift_0(t/1s) + lift_1(p) + lift_2(u) + (law_0(t/1s) + law_1(t/1s) + law_2(t/1s));";
    text.push(&Both::same(" constraint rows { "));
    for row in 0..3 {
        text.push(&Both::same(&format!("y[{row}] == 0.1*")));
        text.push(&expression(&mut chance, 4));
        text.push(&Both::same("; "));
    }
    text.push(&Both::same("} "));
    // The same body of a loop for each function.
    let (name, argument) = (["lift", "law"][chance.below(2)], ["x", "x*z[0]", "p"][chance.below(3)]);
    let _ = write!(
        text.arrays,
        "for i in 0..2 {{ potential well = 1J*z[i]*{name}[i + 1]({argument}); kinetic mass = 1 [kg*m^2]*der(z[i])^2; }} "
    );
    for index in 0..2 {
        let number = index + 1;
        let _ = write!(text.single, "potential well_{index} = 1J*z[{index}]*{name}_{number}({argument}); ");
        let _ = write!(text.single, "kinetic mass_{index} = 1 [kg*m^2]*der(z[{index}])^2; ");
    }
    for statement in ["branch up: 100 + x > ", "out first_output: 1 = ", "out rate_output: 1/s = der(x + "] {
        text.push(&Both::same(statement));
        text.push(&expression(&mut chance, 3));
        text.push(&Both::same(if statement.contains("der(") { "); " } else { "; " }));
    }
    text
}

/// Emitted code of functions of the position, each by its name, without blanks.
fn bodies(code: &str) -> Vec<(String, String)> {
    let code: String = code.split_whitespace().collect();
    let mut found = Vec::new();
    let mut rest = code.as_str();
    while let Some(at) = rest.find("fn") {
        let (before, behind) = rest.split_at(at);
        rest = &behind[2..];
        let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let is_function =
            before.ends_with([']', '}', ';', '{']) && rest[name.len()..].starts_with(['(', '<']);
        let (Some(open), true) = (rest.find('{'), is_function) else { continue };
        let mut depth = 0_usize;
        let end = rest[open..].find(|c| {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        let end = open + end.expect("a closed body");
        if !["new", "default", "lane", "scene", "in_numbers", "in_part"].contains(&name.as_str()) {
            found.push((name, rest[open..=end].to_owned()));
        }
    }
    found
}

/// Code with functions one by one, as it would be with arrays.
fn as_arrays(mut code: String) -> String {
    for (name, kind) in [("lift", "Lift"), ("law", "Law")] {
        for index in 0..LENGTH {
            code = code.replace(&format!("self.{name}_{index}"), &format!("self.{name}[{index}]"));
            code = code.replace(&format!("<{kind}{index}as"), &format!("<{kind}as"));
        }
    }
    code
}

/// Names `prefix` with a number, such as `e12`, by the order in which they come: numbers of functions are expressions too.
fn renumbered(code: &str, prefix: &str) -> String {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut text = String::new();
    let mut rest = code;
    while let Some(at) = rest.find(prefix) {
        let (before, behind) = rest.split_at(at + prefix.len());
        text += before;
        let digits = behind.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let is_name = prefix.starts_with('_')
            || !before[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.');
        let (digits, behind) = behind.split_at(digits);
        rest = behind;
        if is_name && !digits.is_empty() {
            let next = numbers.len();
            let _ = write!(text, "{}", numbers.entry(digits).or_insert(next));
        } else {
            text += digits;
        }
    }
    text + rest
}

/// Without assertions of the smoothness: one an array, one a function.
fn without_assertions(code: &str) -> String {
    let mut parts = code.split("const{::core::assert!");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once("};").map_or("", |(_, rest)| rest))
}

#[test]
fn texts_by_chance_have_the_equations_and_the_code_of_functions_by_name() {
    let mut calls = 0;
    for seed in 0..60 {
        let Both { arrays, single } = text(seed);
        let [of_arrays, of_single] = [&arrays, &single].map(|text| {
            let definition = mbs_codegen::casadi_definition(text, None);
            renumbered(&definition.unwrap_or_else(|fault| panic!("{seed}: {fault}\n{text}")), "e")
        });
        assert_eq!(of_arrays, of_single, "{seed}: {arrays}");
        let [of_arrays, of_single] = [&arrays, &single].map(|text| {
            let code =
                mbs_codegen::expand_source(text).unwrap_or_else(|fault| panic!("{seed}: {fault}\n{text}"));
            bodies(&code.to_string())
        });
        assert!(
            of_arrays.len() > 20 && of_arrays.iter().any(|(name, _)| name == "position"),
            "{of_arrays:?}"
        );
        for ((name, array), (other, one)) in of_arrays.iter().zip(&of_single) {
            let (array, one) = (without_assertions(array), as_arrays(without_assertions(one)));
            let [array, one] = [array, one].map(|code| renumbered(&code, "__n"));
            assert_eq!((name, array.as_str()), (other, one.as_str()), "{seed}: {arrays}");
            calls += array.matches("::jet::<").count();
        }
        assert_eq!(of_arrays.len(), of_single.len());
    }
    assert!(calls > 1_000, "{calls}");
}

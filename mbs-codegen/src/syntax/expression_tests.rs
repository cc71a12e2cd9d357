//! Expressions in postfix notation, and the messages of their faults.

use super::ast::Operation;
use super::expression::expression;
use super::parser::Parser;
use super::tokens::flatten;
use crate::diagnostics::Diagnostics;

/// The expression in postfix notation, or the messages.
fn postfix(text: &str) -> String {
    let mut diagnostics = Diagnostics::default();
    let tokens = flatten(text.parse().expect("tokens"), &mut diagnostics);
    let read = expression(&mut Parser::new(&tokens, &mut diagnostics));
    let expression = match read {
        Ok(expression) if diagnostics.is_empty() => expression,
        _ => return diagnostics.to_text(),
    };
    let mut words = Vec::new();
    for instruction in &expression.code {
        words.push(match &instruction.operation {
            Operation::Number { value, unit, .. } => {
                format!("{value}{}", unit.as_ref().map_or("", |unit| &unit.text))
            }
            Operation::Name(name) => name.clone(),
            Operation::Negate => "neg".into(),
            Operation::Binary(operator) => format!("{operator:?}").to_lowercase(),
            Operation::Call { function, order, arguments, indexed } => {
                let number = if *indexed { "[]" } else { "" };
                let derivative = if *order == 0 { String::new() } else { format!(".d{order}") };
                format!("{function}{number}{derivative}/{arguments}")
            }
            Operation::Array { length } => format!("[{length}]"),
            Operation::Index { indices } => format!("index/{indices}"),
            Operation::SumBegin { variable, end } => format!("sum {}→{end}", variable.text),
            Operation::SumEnd { begin } => format!("end←{begin}"),
            Operation::Reference { function, targets } => {
                let names: Vec<&str> = targets.iter().map(|target| target.name.text.as_str()).collect();
                format!("{function}({})", names.join(","))
            }
        });
    }
    words.join(" ")
}

#[test]
fn powers_bind_tighter_than_products_and_unary_minus() {
    assert_eq!(postfix("m*L^2/12"), "m L 2 power multiply 12 divide");
    assert_eq!(postfix("-x^2"), "x 2 power neg");
    assert_eq!(postfix("2^-x^2*y"), "2 x 2 power neg power y multiply");
    assert_eq!(postfix("2^3^2"), "2 3 2 power power");
    assert_eq!(postfix("a*-b"), "a b neg multiply");
    assert_eq!(postfix("-a*b"), "a neg b multiply");
}

#[test]
fn sums_and_differences_associate_to_the_left() {
    assert_eq!(postfix("a-b+c"), "a b subtract c add");
    assert_eq!(postfix("a/b*c"), "a b divide c multiply");
}

#[test]
fn numbers_carry_their_suffix() {
    assert_eq!(postfix("100mm + 1.5e-3 + 30deg + 1_000"), "100mm 0.0015 add 30deg add 1000 add");
    assert!(postfix("'x'").contains("expected a number"));
}

#[test]
fn a_unit_in_brackets_follows_a_number() {
    assert_eq!(postfix("4 [m^2] + -2[kg*m^2]*x"), "4m^2 2kg*m^2 neg x multiply add");
    assert_eq!(postfix("[1, 2 [m/s], [3][0]]"), "1 2m/s 3 [1] 0 index/1 [3]");
    assert_eq!(postfix("30 [rad/(s*A)^2]/x[1]"), "30rad/(s*A)^2 x 1 index/1 divide");
    assert!(postfix("2 [x, y]").contains("`2*[x, y]`"));
    assert!(postfix("2mm [m]").contains("a number has one unit"));
}

#[test]
fn a_unit_apart_from_its_number_is_put_in_brackets() {
    for (text, meant) in [
        ("9.81 m/s^2", "9.81 [m/s^2]"),
        ("2*9.81 m/s^2*cos(a)", "9.81 [m/s^2]"),
        ("-5 N*m", "5 [N*m]"),
        ("[0, 4 m ^ -2]", "4 [m^-2]"),
        ("f(9 mm)", "9mm"),
        ("30 deg + x", "30deg"),
        ("5 Nm/rad", "5 [N*m/rad]"),
        ("3 m*min(a, b)", "3m"),
        ("1/2 s", "2s"),
    ] {
        let message = postfix(text);
        assert!(message.contains("apart") && message.ends_with(&format!("write `{meant}`\n")), "{message}");
    }
    assert!(postfix("(2 rate)").contains("an operator or a closing bracket"));
}

#[test]
fn a_power_of_a_number_with_a_unit_is_refused_with_both_readings() {
    for text in ["4m^2", "4m ^ 2", "-4m^2*x", "sqrt(4m^2)", "x + 4m^2"] {
        let message = postfix(text);
        assert!(message.contains("`4 [m^2]`") && message.contains("`(4m)^2`"), "{message}");
    }
    assert!(postfix("2 [m/s]^-1").contains("`2 [(m/s)^-1]`"));
    assert!(postfix("2 [m/s]^-1").contains("`(2 [m/s])^-1`"));
    assert!(postfix("2e-3mm^k").contains("`(2e-3mm)^…`"));
    assert_eq!(postfix("(4m)^2"), "4m 2 power");
    assert_eq!(postfix("(4 [m])^2"), "4m 2 power");
    assert_eq!(postfix("4^2 + x^2"), "4 2 power x 2 power add");
}

#[test]
fn calls_arrays_indices_and_sums_nest() {
    assert_eq!(postfix("atan2(y, x)"), "y x atan2/2");
    assert_eq!(postfix("a - lift.d1(x + 1)^2"), "a x 1 add lift.d1/1 2 power subtract");
    assert_eq!(postfix("[a, b][1]"), "a b [2] 1 index/1");
    assert_eq!(postfix("p.1 + m[0, 1]"), "p 1 index/1 m 0 1 index/2 add");
    assert_eq!(postfix("m.0.1 + a.2.10.3"), "m 0 index/1 1 index/1 a 2 index/1 10 index/1 3 index/1 add");
    assert!(postfix("m.0.1e2").contains("expected the number of a component, found `0.1e2`"));
    assert_eq!(
        postfix("2*lambda(pin[i + 1]) - reaction(B, rod).1"),
        "2 i 1 add lambda(pin) multiply reaction(B,rod) 1 index/1 subtract"
    );
    assert_eq!(postfix("sum(i in 0..n: x[i]*2)"), "0 n sum i→8 x i index/1 2 multiply end←2");
}

#[test]
fn a_long_chain_needs_no_stack() {
    let minus = "- ".repeat(50_000);
    assert!(postfix(&format!("{minus} x")).starts_with("x neg neg"));
    let sum = "1 + ".repeat(50_000);
    assert!(postfix(&format!("{sum} x")).ends_with("x add"));
}

#[test]
fn a_missing_operand_or_operator_is_reported_at_its_place() {
    assert!(postfix("a + ;").starts_with("1:5: expected an expression, found `;`"));
    assert!(postfix("(a b)").starts_with("1:4: an operator is missing between `a` and `b`"));
    assert!(postfix("f(a,)").starts_with("1:5: expected an expression, found `)`"));
}

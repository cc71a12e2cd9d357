//! Table of the elementary functions: names, opcode, units, parity, domain, value and derivative, each once.

use super::derivatives;
use super::graph::{Graph, NodeId};

/// Relation between the units of an argument and of the value of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// A number gives a number.
    Number,
    /// A number gives an angle.
    Angle,
    /// The value has the unit of the argument.
    Same,
    /// The value has the square root of the unit of the argument.
    Root,
    /// An argument of any unit gives a number.
    Any,
}

/// Symmetry of a function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// f(−a) = f(a).
    Even,
    /// f(−a) = −f(a).
    Odd,
    /// Neither.
    None,
}

/// Spelling of an operation of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spelling {
    /// Between its operands.
    Infix(&'static str),
    /// Written in front of them, with parentheses.
    Function(&'static str),
}

impl Spelling {
    /// The operation on two operands as written; a function is called in `namespace`.
    pub fn of(self, namespace: &str, a: &str, b: &str) -> String {
        match self {
            Spelling::Infix(sign) => format!("{a} {sign} {b}"),
            Spelling::Function(name) => format!("{namespace}{name}({a}, {b})"),
        }
    }
}

/// Entry of a function of one argument.
pub struct UnaryEntry {
    /// Name in texts and formulas, and of the method of the runtime's `Scalar`.
    pub name: &'static str,
    /// Command in LaTeX.
    pub latex: &'static str,
    /// Name in the module of CasADi.
    pub casadi: &'static str,
    /// Opcode on the runtime's tapes.
    pub opcode: u8,
    /// Relation of the units.
    pub units: Units,
    /// Symmetry.
    pub parity: Parity,
    /// Argument inside of the domain for every number `{}`, in the text's language: for random texts.
    #[cfg(any(test, feature = "random"))]
    pub domain: &'static str,
    /// Value, the same on every host; the runtime's sine and cosine may differ in the last place.
    pub value: fn(f64) -> f64,
    /// Derivative of `y = f(a)` where `a` moves by `da`, as `(graph, y, a, da)`; `None` where it vanishes.
    pub derivative: fn(&mut Graph, NodeId, NodeId, NodeId) -> Option<NodeId>,
}

/// Entry of a function of two arguments.
pub struct BinaryEntry {
    /// Spelling in Rust.
    pub rust: Spelling,
    /// Spelling in CasADi.
    pub casadi: Spelling,
    /// Opcode on the runtime's tapes.
    pub opcode: u8,
    /// Value, the same on every host.
    pub value: fn(f64, f64) -> f64,
    /// Derivative of `y = f(a, b)` where at least one of them moves, as `(graph, y, a, b)`; `None` where it vanishes.
    pub derivative: fn(&mut Graph, NodeId, Moving, Moving) -> Option<NodeId>,
}

/// An operand and its derivative, `None` where it does not move.
pub type Moving = (NodeId, Option<NodeId>);

macro_rules! unary {
    ($($function:ident $name:literal $latex:literal $casadi:literal $opcode:literal $units:ident $parity:ident $domain:literal
       $value:path, $derivative:ident;)*) => {
        /// Functions of one argument.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Unary {
            $(#[doc = concat!("`", $name, "`")] $function,)*
        }

        impl Unary {
            /// All functions of one argument.
            pub const ALL: [Unary; [$(stringify!($function)),*].len()] = [$(Unary::$function),*];

            /// Functions that texts call by their names: all but the sign, which is an operator.
            pub fn called() -> impl Iterator<Item = Unary> {
                Unary::ALL.into_iter().filter(|function| *function != Unary::Negate)
            }

            /// Its row of the table.
            pub fn entry(self) -> &'static UnaryEntry {
                match self {
                    $(Unary::$function => &UnaryEntry {
                        name: $name,
                        latex: $latex,
                        casadi: $casadi,
                        opcode: $opcode,
                        units: Units::$units,
                        parity: Parity::$parity,
                        #[cfg(any(test, feature = "random"))]
                        domain: $domain,
                        value: $value,
                        derivative: derivatives::$derivative,
                    },)*
                }
            }
        }
    };
}

unary! {
    Negate "neg" "-" "neg" b'~' Same Odd "{}" core::ops::Neg::neg, negate;
    Sqrt "sqrt" "\\sqrt" "sqrt" b'r' Root None "1.5 + ({})^2" libm::sqrt, sqrt;
    Exp "exp" "\\exp" "exp" b'e' Number None "0.3*sin({})" libm::exp, exp;
    Ln "ln" "\\ln" "log" b'l' Number None "2 + sin({})" libm::log, ln;
    Sin "sin" "\\sin" "sin" b'c' Number Odd "{}" libm::sin, sin;
    Cos "cos" "\\cos" "cos" b'c' Number Even "{}" libm::cos, cos;
    Tan "tan" "\\tan" "tan" b't' Number Odd "0.4*sin({})" libm::tan, tan;
    Asin "asin" "\\arcsin" "asin" b'S' Angle Odd "0.6*sin({})" libm::asin, asin;
    Acos "acos" "\\arccos" "acos" b'C' Angle None "0.6*cos({})" libm::acos, acos;
    Atan "atan" "\\arctan" "atan" b'T' Angle Odd "{}" libm::atan, atan;
    Sinh "sinh" "\\sinh" "sinh" b'i' Number Odd "sin({})" libm::sinh, sinh;
    Cosh "cosh" "\\cosh" "cosh" b'o' Number Even "cos({})" libm::cosh, cosh;
    Tanh "tanh" "\\tanh" "tanh" b'a' Number Odd "{}" libm::tanh, tanh;
    Asinh "asinh" "\\operatorname{arsinh}" "asinh" b'I' Number Odd "{}" libm::asinh, asinh;
    Acosh "acosh" "\\operatorname{arcosh}" "acosh" b'O' Number None "1.5 + ({})^2" libm::acosh, acosh;
    Atanh "atanh" "\\operatorname{artanh}" "atanh" b'A' Number Odd "0.6*sin({})" libm::atanh, atanh;
    Abs "abs" "\\left|" "fabs" b'|' Same Even "{}" libm::fabs, abs;
    Sign "sign" "\\operatorname{sgn}" "sign" b'g' Any None "{}" sign, constant;
}

macro_rules! binary {
    ($($function:ident $rust:expr, $casadi:expr, $opcode:literal $value:path, $derivative:ident;)*) => {
        /// Functions of two arguments.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Binary {
            $(#[doc = concat!("`", stringify!($function), "`")] $function,)*
        }

        impl Binary {
            /// All functions of two arguments.
            #[cfg(test)]
            pub const ALL: [Binary; [$(stringify!($function)),*].len()] = [$(Binary::$function),*];

            /// Its row of the table.
            pub fn entry(self) -> &'static BinaryEntry {
                match self {
                    $(Binary::$function => &BinaryEntry {
                        rust: $rust,
                        casadi: $casadi,
                        opcode: $opcode,
                        value: $value,
                        derivative: derivatives::$derivative,
                    },)*
                }
            }
        }
    };
}

use Spelling::{Function, Infix};

binary! {
    Add Infix("+"), Infix("+"), b'+' core::ops::Add::add, add;
    Subtract Infix("-"), Infix("-"), b'-' core::ops::Sub::sub, subtract;
    Multiply Infix("*"), Infix("*"), b'*' core::ops::Mul::mul, multiply;
    Divide Infix("/"), Infix("/"), b'/' core::ops::Div::div, divide;
    Power Function("powf"), Infix("**"), b'^' libm::pow, power;
    Atan2 Function("atan2"), Function("atan2"), b'2' libm::atan2, atan2;
    Min Function("min"), Function("fmin"), b'm' min, min;
    Max Function("max"), Function("fmax"), b'M' max, max;
    Hypot Function("hypot"), Function("hypot"), b'h' libm::hypot, hypot;
}

/// −1, 1, or a zero or NaN as it is.
fn sign(a: f64) -> f64 {
    match a {
        a if a > 0.0 => 1.0,
        a if a < 0.0 => -1.0,
        a => a,
    }
}

/// The second where neither is less.
fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The first where neither is less.
fn max(a: f64, b: f64) -> f64 {
    if a < b { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opcodes_and_names_are_unique_but_for_sine_and_cosine() {
        let entries = Unary::ALL.map(Unary::entry);
        for (index, entry) in entries.iter().enumerate() {
            for other in &entries[..index] {
                assert_ne!(entry.name, other.name);
                // One operation of a tape computes both.
                let shared = (entry.name, other.name) == ("cos", "sin");
                assert_eq!(entry.opcode == other.opcode, shared, "{}, {}", entry.name, other.name);
            }
            assert!(
                Binary::ALL.iter().all(|function| function.entry().opcode != entry.opcode),
                "{}",
                entry.name
            );
        }
    }

    #[test]
    fn parities_hold_for_values() {
        for function in Unary::ALL {
            let UnaryEntry { value, parity, name, .. } = function.entry();
            for a in [0.3, 0.9, 1.7] {
                let (plus, minus) = (value(a), value(-a));
                match parity {
                    Parity::Even => assert!(plus == minus || plus.is_nan(), "{name}"),
                    Parity::Odd => assert!(plus == -minus || plus.is_nan(), "{name}"),
                    Parity::None => assert!(*name == "sign" || plus.abs() != minus.abs(), "{name}"),
                }
            }
        }
    }
}

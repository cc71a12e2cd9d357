//! Notation of formulas: plain text, or LaTeX.

use crate::emit::formula::atom::{Atom, Rank};
use crate::symbolic::{Binary, Unary};

/// A way to spell formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// `L1*sin(phi1)`, rates as `phi1'`.
    Text,
    /// `L_{1}\,\sin \varphi_{1}`, rates with dots.
    Latex,
}

use Notation::{Latex, Text};

/// Greek letters: their names in the text, their characters, their commands in LaTeX.
const GREEK: [(&str, &str, &str); 23] = [
    ("alpha", "α", "\\alpha"),
    ("beta", "β", "\\beta"),
    ("gamma", "γ", "\\gamma"),
    ("delta", "δ", "\\delta"),
    ("epsilon", "ε", "\\varepsilon"),
    ("zeta", "ζ", "\\zeta"),
    ("eta", "η", "\\eta"),
    ("theta", "θ", "\\theta"),
    ("kappa", "κ", "\\kappa"),
    ("lambda", "λ", "\\lambda"),
    ("mu", "μ", "\\mu"),
    ("nu", "ν", "\\nu"),
    ("xi", "ξ", "\\xi"),
    ("rho", "ρ", "\\rho"),
    ("sigma", "σ", "\\sigma"),
    ("tau", "τ", "\\tau"),
    ("phi", "φ", "\\varphi"),
    ("varphi", "ϕ", "\\varphi"),
    ("chi", "χ", "\\chi"),
    ("psi", "ψ", "\\psi"),
    ("omega", "ω", "\\omega"),
    ("Delta", "Δ", "\\Delta"),
    ("Omega", "Ω", "\\Omega"),
];

impl Notation {
    /// A name of the text, differentiated `order` times.
    pub fn name(self, name: &str, order: usize) -> String {
        match self {
            Text => format!("{name}{}", "'".repeat(order)),
            Latex => symbol(name, order),
        }
    }

    /// A name that is no symbol: that of a row.
    pub fn label(self, name: &str) -> String {
        match self {
            Text => name.into(),
            Latex => format!("\\mathrm{{{}}}", escaped(name)),
        }
    }

    /// π
    pub fn pi(self) -> &'static str {
        match self {
            Text => "PI",
            Latex => "\\pi",
        }
    }

    /// A positive number: as text the shortest that reads back as the same, in LaTeX seven digits.
    pub fn number(self, value: f64) -> String {
        /// Between these a number needs no power of ten.
        const PLAIN: core::ops::Range<f64> = 1e-4..1e7;
        // A mantissa of seven digits is a number again: its shortest form has no more.
        let rounded = format!("{value:.6e}").parse().unwrap_or(value);
        let value = if self == Latex { rounded } else { value };
        if value == 0.0 || !value.is_finite() || PLAIN.contains(&value) {
            return match self {
                Latex if value.is_infinite() => "\\infty".into(),
                _ => value.to_string(),
            };
        }
        let text = format!("{value:e}");
        match (self, text.split_once('e')) {
            (Latex, Some((digits, exponent))) => format!("{digits} \\cdot 10^{{{exponent}}}"),
            _ => text,
        }
    }

    /// Factors above and below the bar; there is one above.
    pub fn quotient(self, above: &[String], below: &[String]) -> String {
        match (self, below) {
            (Text, []) => above.join("*"),
            (Text, [only]) => format!("{}/{only}", above.join("*")),
            (Text, _) => format!("{}/({})", above.join("*"), below.join("*")),
            (Latex, []) => above.join("\\,"),
            (Latex, _) => format!("\\frac{{{}}}{{{}}}", above.join("\\,"), below.join("\\,")),
        }
    }

    /// A factor to a positive power.
    pub fn power(self, atom: &Atom, exponent: u32) -> String {
        let Atom { head, tail, rank } = atom;
        match (self, exponent) {
            (_, 1) => format!("{head}{tail}"),
            (Text, _) if *rank == Rank::Power => format!("({head})^{exponent}"),
            (Latex, _) if *rank == Rank::Power => format!("\\left({head}\\right)^{{{exponent}}}"),
            (Text, _) => format!("{head}{tail}^{exponent}"),
            (Latex, _) => format!("{head}^{{{exponent}}}{tail}"),
        }
    }

    /// Text in parentheses.
    pub fn parentheses(self, text: &str) -> String {
        match self {
            Text => format!("({text})"),
            Latex => format!("\\left({text}\\right)"),
        }
    }

    /// A function of one argument; `plain`: the argument is one symbol.
    pub fn call(self, function: Unary, argument: &str, plain: bool) -> Atom {
        let (text, latex) = (function.entry().name, function.entry().latex);
        let argument_of = |head: &str| {
            let tail = if plain { format!(" {argument}") } else { self.parentheses(argument) };
            Atom { head: head.into(), tail, rank: Rank::Function }
        };
        match (self, function) {
            (Text, _) => whole(format!("{text}({argument})")),
            (Latex, Unary::Sqrt) => whole(format!("\\sqrt{{{argument}}}")),
            (Latex, Unary::Abs) => whole(format!("\\left|{argument}\\right|")),
            (Latex, _) => argument_of(latex),
        }
    }

    /// A declared function, differentiated `order` times by its argument.
    pub fn declared(self, name: &str, order: usize, argument: &str) -> Atom {
        let head = format!("{}{}", self.name(name, 0), "'".repeat(order));
        match self {
            Text => whole(format!("{head}({argument})")),
            Latex => Atom { head, tail: self.parentheses(argument), rank: Rank::Function },
        }
    }

    /// A function of two arguments that has no sign of its own.
    pub fn call_two(self, function: Binary, a: &str, b: &str) -> Atom {
        let name = match function {
            Binary::Atan2 => "atan2",
            Binary::Min => "min",
            Binary::Max => "max",
            Binary::Hypot => "hypot",
            Binary::Power => "pow",
            Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => "",
        };
        match self {
            Text => whole(format!("{name}({a}, {b})")),
            Latex => Atom {
                head: format!("\\operatorname{{{name}}}"),
                tail: format!("\\left({a}, {b}\\right)"),
                rank: Rank::Function,
            },
        }
    }

    /// A base to a power that is no small whole number; a flag is `true` for a single symbol or number.
    pub fn general_power(
        self,
        (base, one_base): (&str, bool),
        (exponent, one_exponent): (&str, bool),
    ) -> Atom {
        let base = if one_base { base.to_owned() } else { self.parentheses(base) };
        let head = match self {
            Text if one_exponent => format!("{base}^{exponent}"),
            Text => format!("{base}^({exponent})"),
            Latex => format!("{{{base}}}^{{{exponent}}}"),
        };
        Atom { head, tail: String::new(), rank: Rank::Power }
    }

    /// `yes` where `less < than`, else `no`.
    pub fn choice(self, [less, than, yes, no]: [&str; 4]) -> Atom {
        match self {
            Text => whole(format!("if({less} < {than}, {yes}, {no})")),
            Latex => whole(format!(
                "\\left(\\begin{{cases}} {yes} & \\text{{if }} {less} < {than} \\\\ {no} & \\text{{else}} \
                 \\end{{cases}}\\right)"
            )),
        }
    }
}

fn whole(head: String) -> Atom {
    Atom { head, tail: String::new(), rank: Rank::Function }
}

/// `phi1` → `\varphi_{1}`, `L_crank.0` → `L_{\mathrm{crank},0}`, with `order` dots.
fn symbol(name: &str, order: usize) -> String {
    let (base, components) = name.split_once('.').unwrap_or((name, ""));
    let (stem, word) = match base.trim_start_matches('_').split_once('_') {
        Some((stem, word)) if !stem.is_empty() => (stem, word),
        _ => (base, ""),
    };
    let letters = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = stem.strip_prefix(letters).unwrap_or("");
    let letters = letter(letters);
    let stem = match order {
        0 => letters,
        1 => format!("\\dot{{{letters}}}"),
        _ => format!("\\ddot{{{letters}}}"),
    };
    let word = match word.chars().count() {
        0 | 1 => escaped(word),
        _ => format!("\\mathrm{{{}}}", escaped(word)),
    };
    let components = components.replace('.', ",");
    let below = [digits, &word, &components];
    let below: Vec<&str> = below.into_iter().filter(|part| !part.is_empty()).collect();
    if below.is_empty() { stem } else { format!("{stem}_{{{}}}", below.join(",")) }
}

/// A letter or a word as one symbol.
fn letter(stem: &str) -> String {
    let greek = GREEK.iter().find(|(name, letter, _)| stem == *name || stem == *letter);
    match (greek, stem.chars().count()) {
        (Some((_, _, command)), _) => (*command).into(),
        (None, 1) => escaped(stem),
        (None, _) => format!("\\mathit{{{}}}", escaped(stem)),
    }
}

/// Names may hold underscores, which LaTeX reads as subscripts.
fn escaped(text: &str) -> String {
    text.replace('_', "\\_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_the_symbols_of_a_blackboard() {
        let cases = [
            ("phi1", "\\varphi_{1}"),
            ("omega", "\\omega"),
            ("x2", "x_{2}"),
            ("OD", "\\mathit{OD}"),
            ("L_crank", "L_{\\mathrm{crank}}"),
            ("p.0", "p_{0}"),
            ("theta2_b.1.0", "\\theta_{2,b,1,0}"),
            ("ψ3", "\\psi_{3}"),
            ("_", "\\_"),
            ("_a1", "\\mathit{\\_a}_{1}"),
        ];
        for (name, expected) in cases {
            assert_eq!(symbol(name, 0), expected, "{name}");
        }
        assert_eq!(symbol("phi1", 1), "\\dot{\\varphi}_{1}");
        assert_eq!(symbol("x", 2), "\\ddot{x}");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.5, 2.0, 1e-9, 0.1].map(|x| Text.number(x)), ["0.5", "2", "1e-9", "0.1"]);
        assert_eq!(Latex.number(2.5e-9), "2.5 \\cdot 10^{-9}");
        assert_eq!([0.8660254037844384, 0.5].map(|x| Latex.number(x)), ["0.8660254", "0.5"]);
        assert_eq!(Text.number(0.8660254037844384), "0.8660254037844384");
        assert_eq!(Latex.number(f64::INFINITY), "\\infty");
    }
}

//! Sums of products as a person writes them: signs flattened, equal factors gathered, quotients under one bar.

use crate::emit::formula::atom::{Atom, Rank};
use crate::emit::formula::notation::Notation;

/// `± numerator · factors / denominator`.
#[derive(Clone, Debug)]
pub struct Term {
    negative: bool,
    numerator: f64,
    denominator: f64,
    /// Factors with their exponents.
    factors: Vec<(Atom, i32)>,
}

/// A sum of terms; never empty.
#[derive(Clone, Debug)]
pub struct Sum(Vec<Term>);

/// Denominators of multiples of π that are written as such.
const PARTS_OF_PI: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 6.0, 12.0];

/// Largest numerator of such a multiple: two turns in twelfths of π.
const LARGEST_MULTIPLE: f64 = 48.0;

impl Sum {
    /// A number; small multiples of π as what they are.
    pub fn number(value: f64, notation: Notation) -> Self {
        let (negative, value) = (value < 0.0, value.abs());
        for part in PARTS_OF_PI {
            let multiple = (value * part / core::f64::consts::PI).round();
            let error = (multiple * core::f64::consts::PI / part - value).abs();
            // Two roundings: `30deg` is 30 · (π/180), not π/6.
            if (1.0..=LARGEST_MULTIPLE).contains(&multiple) && error <= 2.0 * f64::EPSILON * value {
                let pi = Atom { head: notation.pi().into(), tail: String::new(), rank: Rank::Number };
                let factors = vec![(pi, 1)];
                return Sum(vec![Term { negative, numerator: multiple, denominator: part, factors }]);
            }
        }
        Sum(vec![Term { negative, numerator: value, denominator: 1.0, factors: Vec::new() }])
    }

    /// A factor alone.
    pub fn atom(atom: Atom) -> Self {
        Sum(vec![Term { negative: false, numerator: 1.0, denominator: 1.0, factors: vec![(atom, 1)] }])
    }

    /// `−x`
    pub fn negated(&self) -> Self {
        let turned = |term: &Term| Term { negative: !term.negative, ..term.clone() };
        Sum(self.0.iter().map(turned).collect())
    }

    /// `x + y`, equal products gathered.
    pub fn plus(&self, other: &Sum) -> Self {
        let mut terms = self.0.clone();
        for term in &other.0 {
            match terms.iter_mut().find(|known| known.is_like(term)) {
                Some(known) => known.absorb(term),
                None => terms.push(term.clone()),
            }
        }
        // The sum of opposites is empty; an empty sum is 0.
        terms.retain(|term| term.numerator != 0.0);
        if terms.is_empty() {
            terms.push(Term { negative: false, numerator: 0.0, denominator: 1.0, factors: Vec::new() });
        }
        Sum(terms)
    }

    /// `x · y`
    pub fn times(&self, other: &Sum, notation: Notation) -> Self {
        let (mut product, other) = (self.term(notation), other.term(notation));
        product.negative ^= other.negative;
        product.numerator *= other.numerator;
        product.denominator *= other.denominator;
        for (atom, exponent) in other.factors {
            product.gather(atom, exponent);
        }
        Sum(vec![product])
    }

    /// `x / y`
    pub fn over(&self, other: &Sum, notation: Notation) -> Self {
        let mut inverse = other.term(notation);
        (inverse.numerator, inverse.denominator) = (inverse.denominator, inverse.numerator);
        inverse.factors.iter_mut().for_each(|(_, exponent)| *exponent = exponent.saturating_neg());
        self.times(&Sum(vec![inverse]), notation)
    }

    /// The only factor, where the sum is one without coefficient and exponent.
    pub fn as_atom(&self) -> Option<&Atom> {
        match self.0.as_slice() {
            [Term { negative: false, numerator: 1.0, denominator: 1.0, factors }] => match factors.as_slice()
            {
                [(atom, 1)] => Some(atom),
                _ => None,
            },
            _ => None,
        }
    }

    /// `true` if it is a positive number without a fraction bar.
    pub fn is_number(&self) -> bool {
        match self.0.as_slice() {
            [Term { negative: false, denominator: 1.0, factors, .. }] => factors.is_empty(),
            _ => false,
        }
    }

    /// The whole as one term; a sum of several is put into parentheses.
    fn term(&self, notation: Notation) -> Term {
        match self.0.as_slice() {
            [only] => only.clone(),
            _ => {
                let head = notation.parentheses(&self.text(notation));
                let factors = vec![(Atom { head, tail: String::new(), rank: Rank::Sum }, 1)];
                Term { negative: false, numerator: 1.0, denominator: 1.0, factors }
            }
        }
    }

    /// Printed form.
    pub fn text(&self, notation: Notation) -> String {
        let mut text = String::new();
        for (index, term) in self.0.iter().enumerate() {
            text.push_str(match (index, term.negative) {
                (0, true) => "-",
                (0, false) => "",
                (_, true) => " - ",
                (_, false) => " + ",
            });
            text.push_str(&term.text(notation));
        }
        text
    }
}

impl Term {
    /// `true` if it differs from `other` in sign and numerator alone.
    fn is_like(&self, other: &Term) -> bool {
        self.denominator == other.denominator
            && self.factors.len() == other.factors.len()
            && self.factors.iter().all(|factor| other.factors.contains(factor))
    }

    /// Adds a term that is like it.
    fn absorb(&mut self, other: &Term) {
        let signed = |term: &Term| if term.negative { -term.numerator } else { term.numerator };
        let sum = signed(self) + signed(other);
        (self.negative, self.numerator) = (sum < 0.0, sum.abs());
    }

    fn gather(&mut self, atom: Atom, exponent: i32) {
        match self.factors.iter_mut().find(|(known, _)| *known == atom) {
            Some((_, sum)) => *sum = sum.saturating_add(exponent),
            None => self.factors.push((atom, exponent)),
        }
    }

    /// Without its sign.
    fn text(&self, notation: Notation) -> String {
        let mut factors: Vec<&(Atom, i32)> = self.factors.iter().collect();
        factors.sort_by(|(a, _), (b, _)| (a.rank, &a.head, &a.tail).cmp(&(b.rank, &b.head, &b.tail)));
        let print = |(atom, exponent): &&(Atom, i32)| notation.power(atom, exponent.unsigned_abs());
        let part = |number: f64, sign: i32| {
            let chosen = factors.iter().filter(|(_, exponent)| exponent.signum() == sign).map(print);
            let number = (number != 1.0).then(|| notation.number(number));
            number.into_iter().chain(chosen).collect::<Vec<String>>()
        };
        let (mut above, below) = (part(self.numerator, 1), part(self.denominator, -1));
        if above.is_empty() {
            above.push("1".into());
        }
        notation.quotient(&above, &below)
    }
}

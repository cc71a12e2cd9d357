//! Construction of nodes by numbered rewrite rules.
//!
//! Every rule is directional and exact in floating point, unless it says what it may lose. There is no reordering
//! of sums, no cancelling of `x/x` or `x − x`, no expansion of products, and no `0·x → 0`. Structural zeros never
//! enter the graph, because differentiation leaves them out. Each rule has a property test of its name.
//!
//! | rule | rewrite | loses |
//! |---|---|---|
//! | 1 `constants_fold` | a function of numbers → its value, if finite | a unit in the last place of sin and cos, which the runtime computes by its own kernel |
//! | 2 `zero_drops_from_sums` | `x + 0 → x`, `x − 0 → x`, `0 − x → −x` | the sign of a zero result |
//! | 3 `one_drops_from_products` | `1·x → x`, `x/1 → x`, `−1·x → −x`, `x/−1 → −x` | nothing |
//! | 4 `signs_move_outwards` | `−(−x) → x`, `(−x)·y → −(x·y)`, `(−x)/y → −(x/y)` | nothing |
//! | 5 `signs_join_sums` | `x + (−y) → x − y`, `x − (−y) → x + y`, `(−x) + y → y − x`, `(−x) − y → −(x + y)` | nothing |
//! | 6 `negated_differences_turn` | `−(x − y) → y − x` | the sign of a zero result |
//! | 7 `commuting_operands_are_sorted` | `y + x → x + y`, `y·x → x·y` | nothing |
//! | 8 `products_group_by_stage` | `(a·x)·(b·y) → (a·b)·(x·y)` where a, b are known before x, y | one rounding a factor |
//! | 9 `small_powers_multiply` | `x^n →` products for integer n up to 16, `x^−n → 1/x^n`, `x^½ → √x` | the roundings of n − 1 products; `x^½` at −0 and −∞ |
//! | 10 `odd_and_even_functions_take_signs_out` | `sin(−x) → −sin x`, `cos(−x) → cos x`, likewise tan, asin, atan, sinh, tanh, cosh, abs | nothing |
//! | 11 `selects_of_equals_vanish` | `select(a < b, x, x) → x` | nothing |
//! | 12 `division_by_two_powers_multiplies` | `x/c → x·(1/c)` where c is a power of two | nothing |
//! | 13 `reversed_differences_are_negations` | `y − x → −(x − y)` in products, sums and rule 10, where `x − y` is the older one | the sign of a zero result |
//! | 14 `doubled_terms_add_first` | `(x + x) ± (y + y) → (x ± y) + (x ± y)` | nothing but an overflow on the way |
//! | 15 `fractional_powers_take_roots` | `x^(n + ½) → x^n·√x`, `x^(n + ¼) → x^n·√√x`, `x^(n + ¾) → x^n·(√x·√√x)`, `x^−p → 1/x^p` for n up to 16, once all derivatives are there | the roundings of two roots and n products; the sign at −0; digits of results below the normal range; a power of −∞ |

use super::graph::{Graph, Node, NodeId, Stage};
use super::operations::{Binary, Parity, Unary};

/// Largest exponent that is multiplied out.
pub(super) const LARGEST_POWER: i32 = 16;

impl Graph {
    /// `−x`
    pub fn negate(&mut self, x: NodeId) -> NodeId {
        if let Some(value) = self.constant_value(x) {
            return self.constant(-value);
        }
        match self.node(x) {
            Node::Unary(Unary::Negate, inner) => inner,
            Node::Binary(Binary::Subtract, a, b) => self.intern(Node::Binary(Binary::Subtract, b, a)),
            _ => self.intern(Node::Unary(Unary::Negate, x)),
        }
    }

    /// `a + b`
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(folded) = self.fold_binary(Binary::Add, a, b) {
            return folded;
        }
        if self.is(a, 0.0) {
            return b;
        }
        if self.is(b, 0.0) {
            return a;
        }
        match (self.opposite(a), self.opposite(b)) {
            (None, Some(b)) => self.subtract(a, b),
            (Some(a), None) => self.subtract(b, a),
            (Some(a), Some(b)) => {
                let sum = self.add(a, b);
                self.negate(sum)
            }
            (None, None) => match self.halves(a, b) {
                Some((x, y)) => {
                    let half = self.add(x, y);
                    self.add(half, half)
                }
                None => self.intern(Node::Binary(Binary::Add, a.min(b), a.max(b))),
            },
        }
    }

    /// `a − b`
    pub fn subtract(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(folded) = self.fold_binary(Binary::Subtract, a, b) {
            return folded;
        }
        if self.is(b, 0.0) {
            return a;
        }
        if self.is(a, 0.0) {
            return self.negate(b);
        }
        // The sign of a reversed difference is taken out where it vanishes.
        match (self.negated(a), self.opposite(a), self.opposite(b)) {
            (Some(a), _, None) => {
                let sum = self.add(a, b);
                self.negate(sum)
            }
            (_, Some(a), Some(b)) => self.subtract(b, a),
            (_, _, Some(b)) => self.add(a, b),
            (None, _, None) => match self.halves(a, b) {
                Some((x, y)) => {
                    let half = self.subtract(x, y);
                    self.add(half, half)
                }
                None => self.intern(Node::Binary(Binary::Subtract, a, b)),
            },
        }
    }

    /// `a · b`
    pub fn multiply(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (a, b, negative) = self.take_signs(a, b, Self::opposite);
        let product = self.multiply_positive(a, b);
        if negative { self.negate(product) } else { product }
    }

    /// Groups the factors by stage, lower stages first; the depth of recursion is the number of stages.
    fn multiply_positive(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(folded) = self.fold_binary(Binary::Multiply, a, b) {
            return folded;
        }
        if self.is(a, 1.0) {
            return b;
        }
        if self.is(b, 1.0) {
            return a;
        }
        let stage = self.stage(a).max(self.stage(b));
        let ((low_a, high_a), (low_b, high_b)) = (self.split(a, stage), self.split(b, stage));
        let high = match (high_a, high_b) {
            (Some(x), Some(y)) => self.intern(Node::Binary(Binary::Multiply, x.min(y), x.max(y))),
            (Some(x), None) | (None, Some(x)) => x,
            (None, None) => return self.intern(Node::Binary(Binary::Multiply, a.min(b), a.max(b))),
        };
        let low = match (low_a, low_b) {
            (Some(x), Some(y)) => self.multiply_positive(x, y),
            (Some(x), None) | (None, Some(x)) => x,
            (None, None) => return high,
        };
        if self.is(low, 1.0) {
            return high;
        }
        self.intern(Node::Binary(Binary::Multiply, low.min(high), low.max(high)))
    }

    /// The factors known before `stage`, and those of it.
    fn split(&self, x: NodeId, stage: Stage) -> (Option<NodeId>, Option<NodeId>) {
        if self.stage(x) < stage {
            return (Some(x), None);
        }
        match self.node(x) {
            Node::Binary(Binary::Multiply, a, b) if self.stage(a) < stage => (Some(a), Some(b)),
            Node::Binary(Binary::Multiply, a, b) if self.stage(b) < stage => (Some(b), Some(a)),
            _ => (None, Some(x)),
        }
    }

    /// `a / b`
    pub fn divide(&mut self, a: NodeId, b: NodeId) -> NodeId {
        // Reversed differences would save no operation here, and might turn an infinite quotient.
        let (a, b, negative) = self.take_signs(a, b, Self::negated);
        let quotient = self.divide_positive(a, b);
        if negative { self.negate(quotient) } else { quotient }
    }

    fn divide_positive(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(folded) = self.fold_binary(Binary::Divide, a, b) {
            return folded;
        }
        match self.constant_value(b) {
            Some(1.0) => a,
            Some(divisor) if is_power_of_two(divisor) => {
                let factor = self.constant(1.0 / divisor);
                self.multiply_positive(a, factor)
            }
            _ => self.intern(Node::Binary(Binary::Divide, a, b)),
        }
    }

    /// A function of one argument.
    pub fn unary(&mut self, function: Unary, x: NodeId) -> NodeId {
        if function == Unary::Negate {
            return self.negate(x);
        }
        if let Some(value) = self.constant_value(x) {
            let folded = (function.entry().value)(value);
            if folded.is_finite() {
                return self.constant(folded);
            }
        }
        match (function.entry().parity, self.opposite(x)) {
            (Parity::Even, Some(inner)) => self.intern(Node::Unary(function, inner)),
            (Parity::Odd, Some(inner)) => {
                let odd = self.intern(Node::Unary(function, inner));
                self.negate(odd)
            }
            _ => self.intern(Node::Unary(function, x)),
        }
    }

    /// A function of two arguments.
    pub fn binary(&mut self, function: Binary, a: NodeId, b: NodeId) -> NodeId {
        match function {
            Binary::Add => self.add(a, b),
            Binary::Subtract => self.subtract(a, b),
            Binary::Multiply => self.multiply(a, b),
            Binary::Divide => self.divide(a, b),
            Binary::Power => self.power(a, b),
            Binary::Atan2 | Binary::Min | Binary::Max | Binary::Hypot => {
                match self.fold_binary(function, a, b) {
                    Some(folded) => folded,
                    None => self.intern(Node::Binary(function, a, b)),
                }
            }
        }
    }

    /// `a ^ b`
    pub fn power(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(folded) = self.fold_binary(Binary::Power, a, b) {
            return folded;
        }
        match self.constant_value(b) {
            Some(0.5) => self.unary(Unary::Sqrt, a),
            Some(exponent) if exponent.fract() == 0.0 && exponent.abs() <= f64::from(LARGEST_POWER) => {
                let power = self.integer_power(a, exponent.abs() as u32);
                if exponent < 0.0 {
                    let one = self.constant(1.0);
                    self.divide(one, power)
                } else {
                    power
                }
            }
            _ => self.intern(Node::Binary(Binary::Power, a, b)),
        }
    }

    fn integer_power(&mut self, base: NodeId, mut exponent: u32) -> NodeId {
        let mut result = self.constant(1.0);
        let mut square = base;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.multiply(result, square);
            }
            exponent >>= 1;
            if exponent > 0 {
                square = self.multiply(square, square);
            }
        }
        result
    }

    /// `yes` where `less < than`, else `no`.
    pub fn select(&mut self, less: NodeId, than: NodeId, yes: NodeId, no: NodeId) -> NodeId {
        if yes == no {
            return yes;
        }
        match (self.constant_value(less), self.constant_value(than)) {
            (Some(a), Some(b)) => {
                if a < b {
                    yes
                } else {
                    no
                }
            }
            _ => self.intern(Node::Select { less, than, yes, no }),
        }
    }

    fn fold_binary(&mut self, function: Binary, a: NodeId, b: NodeId) -> Option<NodeId> {
        let value = (function.entry().value)(self.constant_value(a)?, self.constant_value(b)?);
        value.is_finite().then(|| self.constant(value))
    }

    fn is(&self, x: NodeId, value: f64) -> bool {
        self.constant_value(x) == Some(value)
    }

    /// `x` of `−x`; a negative number counts as the negation of its absolute value.
    fn negated(&mut self, x: NodeId) -> Option<NodeId> {
        match self.node(x) {
            Node::Unary(Unary::Negate, inner) => Some(inner),
            Node::Constant(bits) if f64::from_bits(bits) < 0.0 => Some(self.constant(-f64::from_bits(bits))),
            _ => None,
        }
    }

    /// `x` of `−x`, and `x − y` of `y − x` where `x − y` is the older one.
    fn opposite(&mut self, x: NodeId) -> Option<NodeId> {
        match self.node(x) {
            Node::Binary(Binary::Subtract, a, b) => {
                self.find(Node::Binary(Binary::Subtract, b, a)).filter(|older| *older < x)
            }
            _ => self.negated(x),
        }
    }

    /// x and y, which differ, of `a = x + x` and `b = y + y`; not both of them doubled again, so that a sum of deeply nested
    /// ones is not taken apart to the bottom.
    fn halves(&self, a: NodeId, b: NodeId) -> Option<(NodeId, NodeId)> {
        let halved = |x: NodeId| match self.node(x) {
            Node::Binary(Binary::Add, a, b) if a == b => Some(a),
            _ => None,
        };
        let (x, y) = (halved(a)?, halved(b)?);
        (x != y && (halved(x).is_none() || halved(y).is_none())).then_some((x, y))
    }

    /// Both operands without their signs, and `true` if the product or quotient of them is negative.
    fn take_signs(
        &mut self,
        a: NodeId,
        b: NodeId,
        sign: fn(&mut Self, NodeId) -> Option<NodeId>,
    ) -> (NodeId, NodeId, bool) {
        let (plain_a, plain_b) = (sign(self, a), sign(self, b));
        (plain_a.unwrap_or(a), plain_b.unwrap_or(b), plain_a.is_some() != plain_b.is_some())
    }
}

/// `true` if 1/x is exact and x·(1/x) is 1.
fn is_power_of_two(x: f64) -> bool {
    const MANTISSA: u64 = (1 << 52) - 1;
    x.is_normal() && x.to_bits() & MANTISSA == 0 && (1.0 / x).is_normal()
}

#[cfg(test)]
#[path = "rules_tests.rs"]
mod tests;

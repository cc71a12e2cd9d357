//! Operation counts of straight-line code.

use core::fmt;

/// Number of operations on numbers, in one lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Sums, differences and changes of sign.
    pub additions: u64,
    /// Products.
    pub multiplications: u64,
    /// Quotients.
    pub divisions: u64,
    /// Angles of which sine, cosine or both are computed.
    pub sine_cosines: u64,
    /// Square roots and other elementary functions.
    pub functions: u64,
    /// Selections: absolute values, signs, smaller and larger ones, one of two by a mask.
    pub selections: u64,
    /// Comparisons and tests for finiteness.
    pub comparisons: u64,
    /// Calls of functions that the caller supplies, whose own operations are not counted.
    pub calls: u64,
}

impl Operations {
    /// None.
    pub const NONE: Self = Operations {
        additions: 0,
        multiplications: 0,
        divisions: 0,
        sine_cosines: 0,
        functions: 0,
        selections: 0,
        comparisons: 0,
        calls: 0,
    };

    /// All operations together.
    pub const fn total(self) -> u64 {
        let Operations {
            additions,
            multiplications,
            divisions,
            sine_cosines,
            functions,
            selections,
            comparisons,
            calls,
        } = self;
        additions
            .saturating_add(multiplications)
            .saturating_add(divisions)
            .saturating_add(sine_cosines)
            .saturating_add(functions)
            .saturating_add(selections)
            .saturating_add(comparisons)
            .saturating_add(calls)
    }

    /// Both, one after the other.
    pub const fn and(self, other: Self) -> Self {
        Operations {
            additions: self.additions.saturating_add(other.additions),
            multiplications: self.multiplications.saturating_add(other.multiplications),
            divisions: self.divisions.saturating_add(other.divisions),
            sine_cosines: self.sine_cosines.saturating_add(other.sine_cosines),
            functions: self.functions.saturating_add(other.functions),
            selections: self.selections.saturating_add(other.selections),
            comparisons: self.comparisons.saturating_add(other.comparisons),
            calls: self.calls.saturating_add(other.calls),
        }
    }

    /// The same `count` times.
    pub const fn times(self, count: u64) -> Self {
        Operations {
            additions: self.additions.saturating_mul(count),
            multiplications: self.multiplications.saturating_mul(count),
            divisions: self.divisions.saturating_mul(count),
            sine_cosines: self.sine_cosines.saturating_mul(count),
            functions: self.functions.saturating_mul(count),
            selections: self.selections.saturating_mul(count),
            comparisons: self.comparisons.saturating_mul(count),
            calls: self.calls.saturating_mul(count),
        }
    }

    /// The larger count of either, kind by kind.
    pub const fn or(self, other: Self) -> Self {
        Operations {
            additions: larger(self.additions, other.additions),
            multiplications: larger(self.multiplications, other.multiplications),
            divisions: larger(self.divisions, other.divisions),
            sine_cosines: larger(self.sine_cosines, other.sine_cosines),
            functions: larger(self.functions, other.functions),
            selections: larger(self.selections, other.selections),
            comparisons: larger(self.comparisons, other.comparisons),
            calls: larger(self.calls, other.calls),
        }
    }

    /// `true` if no kind has a larger count than in `other`.
    pub const fn within(self, other: Self) -> bool {
        self.additions <= other.additions
            && self.multiplications <= other.multiplications
            && self.divisions <= other.divisions
            && self.sine_cosines <= other.sine_cosines
            && self.functions <= other.functions
            && self.selections <= other.selections
            && self.comparisons <= other.comparisons
            && self.calls <= other.calls
    }
}

const fn larger(a: u64, b: u64) -> u64 {
    if a < b { b } else { a }
}

impl fmt::Display for Operations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} + −, {} ×, {} ÷, {} sine–cosine pairs, {} other functions, {} selections, {} comparisons",
            self.additions,
            self.multiplications,
            self.divisions,
            self.sine_cosines,
            self.functions,
            self.selections,
            self.comparisons
        )?;
        if self.calls > 0 { write!(f, ", {} declared functions", self.calls) } else { Ok(()) }
    }
}

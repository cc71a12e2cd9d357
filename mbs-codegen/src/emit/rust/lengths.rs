//! Bounds at which code is cut into parts or becomes a loop.

/// Bounds on the length of emitted functions.
#[derive(Clone, Copy, Debug)]
pub struct Lengths {
    /// Most `let`s of one function body. One long chain overflows rustc's stack in debug builds near 2 900 and takes its
    /// memory past 30 000; bodies of a few hundred keep both linear.
    pub body: usize,
    /// Longest section, solution or evaluation that stays one function: the compiler's optimisation takes more than linear time.
    pub function: usize,
    /// Most blocks that one function solves by Newton's method in sequence, each with its own copy of every solver. Of
    /// more, all but the next position is one loop.
    pub copies: usize,
    /// Most blocks whose factorization is inlined.
    pub factors: usize,
    /// Most blocks of which the next position, which each step waits for, is straight-line code; of more it is a loop too.
    pub in_line: usize,
    /// Most blocks of a part of a substitution.
    pub group: usize,
    /// Most lines with kernels, those in loops not counted, that have a copy each; of more all share one.
    pub kernels: usize,
    /// Most lines of a function, without those in loops, that are compiled; of more they are a tape.
    pub straight: usize,
    /// The same bound for the lines before the blocks, which each step executes one by one.
    pub straight_blocks: usize,
    /// Fewest rounds that make a loop.
    pub rounds: usize,
    /// Fewest lines that make one; those of several angles count as several.
    pub rolled: usize,
}

impl Lengths {
    /// Lengths that compilers handle well.
    pub const USUAL: Self = Lengths {
        body: 200,
        function: 2_000,
        copies: 4,
        factors: 16,
        in_line: 48,
        group: 24,
        kernels: 16,
        straight: 400,
        straight_blocks: 10_000,
        rounds: 4,
        rolled: 32,
    };

    /// Short texts are cut as long ones: tests of these need no long texts.
    #[cfg(any(test, feature = "random"))]
    pub const SHORT: Self = Lengths {
        body: 7,
        function: 12,
        copies: 0,
        factors: 0,
        in_line: 0,
        group: 2,
        kernels: 1,
        straight: 16,
        straight_blocks: 8,
        rounds: 2,
        rolled: 3,
    };
}

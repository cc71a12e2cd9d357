//! Words that begin a statement; [`super::statement`] calls the reader of each.

/// Words that begin a statement of this version.
pub const STATEMENTS: [&str; 34] = [
    "const",
    "param",
    "input",
    "function",
    "coord",
    "let",
    "curve",
    "foot",
    "constraint",
    "drive",
    "branch",
    "limit",
    "event",
    "latch",
    "independent",
    "out",
    "for",
    "effect",
    "release",
    "scene",
    "start",
    "state",
    "body",
    "pin",
    "gravity",
    "force",
    "torque",
    "tsda",
    "rsda",
    "friction",
    "contact",
    "potential",
    "kinetic",
    "dissipation",
];

/// Words that begin a statement of the language which this version does not translate.
pub const LATER: [&str; 2] = ["data", "include"];

//! Forms of shapes: the word after `draw`, points, and words with arguments.

/// A form: what `draw` and its word need.
#[derive(Debug)]
pub struct Form {
    /// The kind of the shape.
    pub kind: ShapeKind,
    /// The word after `draw`; `trace` is a statement of its own.
    pub word: &'static str,
    /// `true` if a label may precede the points.
    pub labelled: bool,
    /// Points in front of the words.
    pub points: Points,
    /// Words after the points: the word, its argument, `true` if it must be given.
    pub words: &'static [(&'static str, Takes, bool)],
    /// The statement as one writes it.
    pub example: &'static str,
}

/// Kinds of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeKind {
    View,
    Ground,
    Link,
    Plate,
    Slot,
    Spring,
    Joint,
    Slider,
    Rail,
    Wheel,
    Gear,
    Cam,
    Face,
    Geneva,
    Road,
    Trace,
}

/// Number of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// One or more, each with a shape of its own.
    Each,
    /// Exact number.
    Exactly(usize),
    /// Least number.
    AtLeast(usize),
}

/// Argument of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// No argument.
    Nothing,
    /// A point.
    Point,
    /// An angle.
    Angle,
    /// Two numbers, an angle or a vector.
    Direction,
    /// A positive integer.
    Count,
    /// A speed (m/s).
    Speed,
    /// Three numbers.
    Axis,
}

/// A form without words.
const fn plain(
    kind: ShapeKind,
    word: &'static str,
    labelled: bool,
    points: Points,
    example: &'static str,
) -> Form {
    Form { kind, word, labelled, points, words: &[], example }
}

/// Direction of a slider or a rail.
const ALONG: &[(&str, Takes, bool)] = &[("along", Takes::Direction, true)];

/// All forms of `draw`, in the order of the reference.
pub static FORMS: [Form; 15] = [
    plain(ShapeKind::Ground, "ground", false, Points::Each, "draw ground O, D;"),
    plain(ShapeKind::Joint, "joint", false, Points::Each, "draw joint A, B;"),
    plain(ShapeKind::Link, "link", true, Points::AtLeast(2), "draw link crank: O, A;"),
    plain(ShapeKind::Plate, "plate", true, Points::AtLeast(3), "draw plate coupler: A, B, P;"),
    plain(ShapeKind::Slot, "slot", true, Points::AtLeast(2), "draw slot guide: A, B;"),
    plain(ShapeKind::Spring, "spring", true, Points::Exactly(2), "draw spring suspension: A, B;"),
    Form {
        kind: ShapeKind::Slider,
        word: "slider",
        labelled: false,
        points: Points::Each,
        words: ALONG,
        example: "draw slider S along [1, 0];",
    },
    Form {
        kind: ShapeKind::Rail,
        word: "rail",
        labelled: false,
        points: Points::Each,
        words: ALONG,
        example: "draw rail S along [1, 0];",
    },
    Form {
        kind: ShapeKind::Wheel,
        word: "wheel",
        labelled: true,
        points: Points::Exactly(1),
        words: &[("rim", Takes::Point, true)],
        example: "draw wheel roller: A rim R;",
    },
    Form {
        kind: ShapeKind::Gear,
        word: "gear",
        labelled: true,
        points: Points::Exactly(1),
        words: &[
            ("rim", Takes::Point, true),
            ("teeth", Takes::Count, true),
            ("inside", Takes::Nothing, false),
        ],
        example: "draw gear sun: O rim R teeth 20;",
    },
    Form {
        kind: ShapeKind::Cam,
        word: "cam",
        labelled: true,
        points: Points::Exactly(1),
        words: &[("contact", Takes::Point, true), ("turn", Takes::Angle, true)],
        example: "draw cam disc: O contact C turn theta;",
    },
    Form {
        kind: ShapeKind::Face,
        word: "face",
        labelled: true,
        points: Points::Exactly(2),
        words: &[("back", Takes::Point, true)],
        example: "draw face follower: A, B back C;",
    },
    Form {
        kind: ShapeKind::Geneva,
        word: "geneva",
        labelled: false,
        points: Points::Exactly(1),
        words: &[
            ("pin", Takes::Point, true),
            ("wheel", Takes::Point, true),
            ("rim", Takes::Point, true),
            ("slots", Takes::Count, true),
        ],
        example: "draw geneva O pin P wheel W rim R slots 6;",
    },
    Form {
        kind: ShapeKind::Road,
        word: "road",
        labelled: true,
        points: Points::Exactly(1),
        words: &[("speed", Takes::Speed, true)],
        example: "draw road bumps: P speed 3 [m/s];",
    },
    Form {
        kind: ShapeKind::View,
        word: "view",
        labelled: true,
        points: Points::Exactly(0),
        words: &[
            ("diagonal", Takes::Nothing, false),
            ("right", Takes::Axis, false),
            ("up", Takes::Axis, false),
        ],
        example: "draw view diagonal;` or `draw view \"from the front\": right [1, 0, 0] up [0, 0, 1];",
    },
];

/// The form of `trace`.
pub static TRACE: Form =
    plain(ShapeKind::Trace, "trace", true, Points::Each, "trace P;` or `trace \"coupler curve\": P;");

impl Form {
    /// Words before the points: `draw link`, `trace`.
    pub fn name(&self) -> String {
        if self.kind == ShapeKind::Trace { self.word.into() } else { format!("draw {}", self.word) }
    }

    /// The cure: an example.
    pub fn help(&self) -> String {
        format!("write `{}`", self.example)
    }
}

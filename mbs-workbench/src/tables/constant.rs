//! A spline as a Rust constant for a crate without `std`.

use core::fmt::Write;

use super::spline::Pieces;
use super::{Points, Spline};

/// `pub const NAME: … = …;` with documentation; needs `mbs_runtime` alone.
///
/// `source` is the file's name, `largest` the largest error of the spline in its unit. Numbers are the shortest that read back as the
/// same bits.
pub fn rust(name: &str, source: &str, points: &Points, spline: &Spline, largest: f64) -> String {
    let [across, up] = [&points.columns.x.1.coherent, &points.columns.y.1.coherent];
    let [x, y] = &points.names;
    let (count, points_read) = (spline.knots.len(), points.x.len());
    let (kind, constructor, period) = match &spline.pieces {
        Pieces::Cubic(_) => ("cubic", "CubicSpline", None),
        Pieces::Quintic(_, period) => ("periodic quintic", "PeriodicQuintic", Some(*period)),
    };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "/// {y} ({up}) over {x} ({across}): {kind} spline with {count} knots along {points_read} points of"
    );
    let _ = writeln!(text, "/// `{source}`, off by at most {largest:.1e} {up}.");
    let _ = writeln!(text, "#[allow(clippy::all, reason = \"numbers of a table\")]");
    let _ = writeln!(text, "pub const {name}: ::mbs_runtime::driver::{constructor}<{count}> =");
    let _ = writeln!(text, "    ::mbs_runtime::driver::{constructor}::from_pieces(");
    let _ = writeln!(text, "        [");
    for four in spline.knots.chunks(4) {
        let _ = writeln!(text, "            {},", list(four));
    }
    let _ = writeln!(text, "        ],");
    if let Some(period) = period {
        let _ = writeln!(text, "        {period:?},");
    }
    let _ = writeln!(text, "        [");
    match &spline.pieces {
        Pieces::Cubic(pieces) => pieces.iter().for_each(|piece| write_piece(&mut text, piece)),
        Pieces::Quintic(pieces, _) => pieces.iter().for_each(|piece| write_piece(&mut text, piece)),
    }
    text + "        ],\n    );\n"
}

/// `true` if `name` is a valid name of a constant.
pub fn is_name(name: &str) -> bool {
    syn::parse_str::<syn::Ident>(name).is_ok()
}

fn write_piece(text: &mut String, piece: &[f64]) {
    let _ = writeln!(text, "            [{}],", list(piece));
}

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(", ")
}

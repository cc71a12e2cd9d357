//! Blanks between the pieces of a line.

use mbs_codegen::vocabulary::drawn;

use super::pieces::{Piece, PieceKind};

/// Words besides those of pictures that a value or a bracket may follow, as `rate [0, 1]`; they may be names as well, as in `rate[0]`.
const BEFORE_VALUES: [&str; 13] =
    ["at", "rate", "in", "tolerance", "right", "up", "span", "about", "turned", "on", "of", "near", "within"];

/// `true` where a value may stand behind the word.
fn takes_value(word: &str) -> bool {
    BEFORE_VALUES.contains(&word) || drawn().any(|known| known == word)
}

/// `true` where the piece at `index` is `+` or `-` in front of an operand, `false` where it stands between two.
pub fn is_sign(pieces: &[Piece<'_>], index: usize) -> bool {
    let piece = &pieces[index];
    if !(piece.is("-") || piece.is("+")) {
        return false;
    }
    let Some(before) = pieces[..index].iter().rev().find(|before| !before.is_comment()) else { return true };
    match before.kind {
        PieceKind::Mark | PieceKind::Open => true,
        // `rate -omega` and `rate - omega` are told apart by the author's blanks alone.
        PieceKind::Word if takes_value(before.text) => {
            piece.is_apart && pieces.get(index + 1).is_some_and(|next| !next.is_apart)
        }
        _ => false,
    }
}

/// `true` where a line may end next to the mark.
pub fn is_operator(piece: &Piece<'_>) -> bool {
    ["+", "-", "*", "/", "==", "=", "<", ">", "<=", ">="].iter().any(|mark| piece.is(mark))
}

/// `true` where a blank stands between the pieces before `index` and at it, both on one line.
pub fn is_apart(pieces: &[Piece<'_>], index: usize) -> bool {
    let (Some(before), Some(next)) = (index.checked_sub(1).and_then(|at| pieces.get(at)), pieces.get(index))
    else {
        return false;
    };
    if before.is_comment() || next.is_comment() {
        return true;
    }
    match (before.text, next.text) {
        _ if before.is("(") || before.is("[") || next.is(")") || next.is("]") => false,
        _ if before.is("{") && next.is("}") => false,
        _ if before.is("{") || next.is("}") || next.is("{") || before.is("}") => true,
        _ if next.is(",") || next.is(";") => false,
        _ if before.is(",") || before.is(";") => true,
        _ if next.is("::") || before.is("::") => false,
        _ if next.is(":") => false,
        _ if before.is(":") => true,
        // `1. ..` would be read anew.
        (number, ".." | "..=") => number.ends_with('.'),
        // `m.0 .1` has two indices, `m.0.1` an index and a number.
        _ if next.is(".") && before.kind == PieceKind::Literal => next.is_apart,
        _ if before.is(".") || next.is(".") || before.is("..") || before.is("..=") => false,
        _ if before.is("#") => false,
        _ if is_sign(pieces, index - 1) => false,
        _ if ["*", "/", "^"].iter().any(|mark| before.is(mark) || next.is(mark)) => false,
        _ if is_operator(before) || is_operator(next) => true,
        _ if before.kind == PieceKind::Mark || next.kind == PieceKind::Mark => next.is_apart,
        _ if next.kind == PieceKind::Open => match before.kind {
            PieceKind::Word => takes_value(before.text) && next.is_apart,
            PieceKind::Literal => true,
            _ => false,
        },
        _ => true,
    }
}

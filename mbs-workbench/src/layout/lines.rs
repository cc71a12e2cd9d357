//! Lines of one statement.

use super::LEVEL;
use super::blanks::{is_apart, is_operator, is_sign};
use super::pieces::{Piece, PieceKind};

/// Characters of a line that is not broken, comments left out.
pub const WIDTH: usize = 120;

/// The statement in lines, the first one at the margin, with a line end behind the last.
pub fn laid_out(pieces: &[Piece<'_>], margin: usize) -> String {
    let mut statement = Statement::of(pieces);
    let mut text = String::new();
    let mut open: Vec<usize> = Vec::new();
    let mut from = 0;
    while from < pieces.len() {
        let indent = statement.indent(from, &open, margin);
        let mut end = statement.end(from);
        while statement.width(from, end) + indent > WIDTH && statement.break_up(from, end, indent) {
            end = statement.end(from);
        }
        text.extend(core::iter::repeat_n(' ', indent));
        for index in from..end {
            if index > from && is_apart(pieces, index) {
                text.push(' ');
            }
            text += pieces[index].text;
            match pieces[index].kind {
                PieceKind::Open => open.push(indent),
                PieceKind::Close => drop(open.pop()),
                _ => {}
            }
        }
        text.push('\n');
        from = end;
    }
    text
}

struct Statement<'a> {
    pieces: &'a [Piece<'a>],
    /// `true` where a line begins with the piece.
    begins: Vec<bool>,
    /// The other bracket of each bracket.
    partner: Vec<usize>,
    /// Opening bracket that each piece stands in directly; a bracket stands in the one around it.
    within: Vec<Option<usize>>,
}

impl<'a> Statement<'a> {
    fn of(pieces: &'a [Piece<'a>]) -> Self {
        let mut partner: Vec<usize> = (0..pieces.len()).collect();
        let mut within = vec![None; pieces.len()];
        let mut open: Vec<usize> = Vec::new();
        for (index, piece) in pieces.iter().enumerate() {
            if piece.kind == PieceKind::Close
                && let Some(start) = open.pop()
            {
                (partner[start], partner[index]) = (index, start);
            }
            within[index] = open.last().copied();
            if piece.kind == PieceKind::Open {
                open.push(index);
            }
        }
        let begins = vec![false; pieces.len()];
        let mut statement = Statement { pieces, begins, partner, within };
        for (index, piece) in pieces.iter().enumerate().skip(1) {
            if statement.is_forced(index) || (piece.line_ends > 0 && statement.may_begin(index)) {
                statement.begin(index);
            }
        }
        statement
    }

    /// `true` where a comment makes a line begin with the piece.
    fn is_forced(&self, index: usize) -> bool {
        let (before, piece) = (&self.pieces[index - 1], &self.pieces[index]);
        matches!(before.kind, PieceKind::LineComment | PieceKind::Doc)
            || piece.kind == PieceKind::Doc
            || (piece.is_comment() && piece.line_ends > 0)
            || (before.kind == PieceKind::BlockComment && piece.line_ends > 0)
    }

    /// `true` where a line may begin with the piece.
    fn may_begin(&self, index: usize) -> bool {
        let (before, piece) = (&self.pieces[index - 1], &self.pieces[index]);
        let is_between = |at: usize| is_operator(&self.pieces[at]) && !is_sign(self.pieces, at);
        let has_begun = || {
            let open = self.partner[index] + 1;
            piece.kind == PieceKind::Close && self.begins.get(open).is_some_and(|begins| *begins)
        };
        (piece.kind != PieceKind::Close && (before.kind == PieceKind::Open || before.is(",")))
            || has_begun()
            || (is_between(index) && piece.text != "=")
            || is_between(index - 1)
    }

    /// Makes a line begin with the piece, and the lines that follow from it: a bracket that is opened by a line end is closed behind
    /// one, and fields have a line each.
    fn begin(&mut self, index: usize) {
        self.begins[index] = true;
        let Some(open) = self.within[index] else { return };
        let is_fields = self.pieces[open].is("{");
        if index == open + 1 || is_fields {
            let close = self.partner[open];
            if close > open {
                self.begins[close] = true;
            }
        }
        if is_fields {
            for at in open + 1..self.partner[open] {
                let begins = at == open + 1 || (self.pieces[at - 1].is(",") && !self.pieces[at].is_comment());
                self.begins[at] |= begins && self.within[at] == Some(open);
            }
        }
    }

    /// First piece of the next line.
    fn end(&self, from: usize) -> usize {
        (from + 1..self.pieces.len()).find(|index| self.begins[*index]).unwrap_or(self.pieces.len())
    }

    /// Characters of a line without its margin and its comments.
    fn width(&self, from: usize, end: usize) -> usize {
        let width = |index: usize| match self.pieces[index].is_comment() {
            true => 0,
            false => {
                let blank = index > from && is_apart(self.pieces, index);
                self.pieces[index].text.chars().count() + usize::from(blank)
            }
        };
        (from..end).map(width).sum()
    }

    /// Columns of the line that begins with the piece; `open` has those of the lines with the brackets around it.
    fn indent(&self, from: usize, open: &[usize], margin: usize) -> usize {
        if from == 0 {
            return margin;
        }
        let Some(bracket) = open.last() else { return margin + LEVEL };
        if self.pieces[from].kind == PieceKind::Close {
            return *bracket;
        }
        let before = self.pieces[..from].iter().rposition(|piece| !piece.is_comment());
        let is_next =
            before.is_none_or(|at| self.pieces[at].kind == PieceKind::Open || self.pieces[at].is(","));
        bracket + if is_next || self.pieces[from].is_comment() { LEVEL } else { 2 * LEVEL }
    }

    /// Makes lines begin within a line that is too long; `false` where it has no place for that.
    fn break_up(&mut self, from: usize, end: usize, indent: usize) -> bool {
        let mut depth = 0_isize;
        let mut best: Option<((bool, isize, u8), Vec<usize>)> = None;
        for index in from..end {
            let piece = &self.pieces[index];
            if piece.kind == PieceKind::Close {
                depth -= 1;
            }
            if let Some((at, rank)) = self.place(index, from, end) {
                let key = (rank == LAST, depth, rank);
                match &mut best {
                    Some((known, places)) if *known == key => places.push(at),
                    Some((known, _)) if *known < key => {}
                    _ => best = Some((key, vec![at])),
                }
            }
            if piece.kind == PieceKind::Open {
                depth += 1;
            }
        }
        let Some(((_, _, rank), places)) = best else { return false };
        let fits = |at: &&usize| self.width(from, **at) + indent <= WIDTH;
        let at = places.iter().rev().find(fits).or(places.first()).copied().unwrap_or(from);
        self.begin(at);
        if rank == BRACKET {
            let open = at - 1;
            for index in at..self.partner[open] {
                let is_behind = self.within[index - 1] == Some(open) && self.pieces[index - 1].is(",");
                self.begins[index] |= is_behind && !self.pieces[index].is_comment();
            }
        }
        true
    }

    /// Place that a line may begin at, because of the piece, and its rank.
    fn place(&self, index: usize, from: usize, end: usize) -> Option<(usize, u8)> {
        let piece = &self.pieces[index];
        let is_one_of = |marks: &[&str]| marks.iter().any(|mark| piece.is(mark));
        let is_inside = |at: usize| (at > from && at < end).then_some(at);
        if piece.kind == PieceKind::Open {
            let close = self.partner[index];
            let has = |mark: &str| {
                (index + 1..close).any(|at| self.within[at] == Some(index) && self.pieces[at].is(mark))
            };
            let is_worth = close > index + 1 && !has(";") && (has(",") || !piece.is("["));
            return is_inside(index + 1).filter(|_| is_worth).map(|at| (at, BRACKET));
        }
        if is_one_of(&["==", "<", ">", "<=", ">="]) {
            return is_inside(index).map(|at| (at, 0));
        }
        if is_one_of(&["+", "-"]) && !is_sign(self.pieces, index) {
            return is_inside(index).map(|at| (at, 1));
        }
        // Commas of a bracket that is opened in the line go with it.
        if piece.is(",") && self.within[index].is_none_or(|open| open < from) {
            return is_inside(index + 1).map(|at| (at, 1));
        }
        if is_one_of(&["*", "/"]) {
            return is_inside(index).map(|at| (at, 3));
        }
        if piece.is("=") {
            return is_inside(index + 1).map(|at| (at, LAST));
        }
        None
    }
}

/// Rank of a bracket whose parts get a line each.
const BRACKET: u8 = 2;
/// Rank of a place that is taken where there is no other.
const LAST: u8 = 4;

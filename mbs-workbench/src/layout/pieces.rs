//! Tokens of a text and the comments between them, in their order.

use core::ops::Range;

use proc_macro2::token_stream::IntoIter;
use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};

/// Kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceKind {
    /// Name or word.
    Word,
    /// Number or quoted text.
    Literal,
    /// Operator or mark of one to three characters.
    Mark,
    /// Opening bracket.
    Open,
    /// Closing bracket.
    Close,
    /// Doc comment, which is a token.
    Doc,
    /// Comment up to the end of its line.
    LineComment,
    /// Comment between `/*` and `*/`.
    BlockComment,
}

/// A token or a comment.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    pub kind: PieceKind,
    /// The piece as it is written.
    pub text: &'a str,
    /// Line ends before it, behind the previous piece.
    pub line_ends: usize,
    /// `true` where a blank or a line end stands before it.
    pub is_apart: bool,
}

impl Piece<'_> {
    /// `true` for a comment that is no token, and for a doc comment.
    pub fn is_comment(&self) -> bool {
        matches!(self.kind, PieceKind::Doc | PieceKind::LineComment | PieceKind::BlockComment)
    }

    /// `true` where both are the same token or comment.
    pub fn is_same(&self, other: &Piece<'_>) -> bool {
        self.kind == other.kind && self.text == other.text
    }

    pub fn is(&self, text: &str) -> bool {
        self.text == text
            && matches!(self.kind, PieceKind::Mark | PieceKind::Open | PieceKind::Close | PieceKind::Word)
    }
}

/// Marks of several characters.
const JOINED: [&str; 9] = ["..=", "..", "==", "<=", ">=", "!=", "::", "=>", "->"];

/// Pieces of a text; `None` where it is no token stream, or something stands between tokens that is no comment.
pub fn pieces(text: &str) -> Option<Vec<Piece<'_>>> {
    let tokens: TokenStream = text.parse().ok()?;
    let mut pieces = Vec::new();
    let mut end = 0;
    for (kind, place) in joined(text, places(text, tokens)?) {
        comments(text, end..place.start, &mut pieces)?;
        let gap = gap_before(text, place.start);
        // The compiler's tokens of a doc comment end before blanks of its line.
        let written = text.get(place.clone())?.trim_end();
        pieces.push(piece(kind, written, gap));
        end = place.end;
    }
    comments(text, end..text.len(), &mut pieces)?;
    Some(pieces)
}

fn piece<'a>(kind: PieceKind, text: &'a str, gap: &str) -> Piece<'a> {
    Piece { kind, text, line_ends: gap.matches('\n').count(), is_apart: !gap.is_empty() }
}

/// Blanks before a place.
fn gap_before(text: &str, place: usize) -> &str {
    let before = &text[..place];
    &before[before.trim_end().len()..]
}

/// Kinds and places of all tokens, brackets flattened. Nothing here recurses, so brackets may be nested as deep as they like.
fn places(text: &str, tokens: TokenStream) -> Option<Vec<(PieceKind, Range<usize>, bool)>> {
    let mut found: Vec<(PieceKind, Range<usize>, bool)> = Vec::new();
    let mut streams: Vec<(IntoIter, Option<Range<usize>>)> = vec![(tokens.into_iter(), None)];
    let mut doc = 0..0;
    while let Some((stream, close)) = streams.last_mut() {
        let Some(tree) = stream.next() else {
            found.extend(close.take().map(|place| (PieceKind::Close, place, false)));
            streams.pop();
            continue;
        };
        let place = tree.span().byte_range();
        if !doc.is_empty() && place == doc {
            continue;
        }
        match tree {
            TokenTree::Group(group) if group.delimiter() == Delimiter::None => return None,
            TokenTree::Group(group) => {
                found.push((PieceKind::Open, group.span_open().byte_range(), false));
                let close = Some(group.span_close().byte_range());
                streams.push((group.stream().into_iter(), close));
            }
            TokenTree::Punct(_) if text.get(place.clone())?.starts_with('/') && place.len() > 1 => {
                doc = place.clone();
                found.push((PieceKind::Doc, place, false));
            }
            TokenTree::Punct(mark) => {
                found.push((PieceKind::Mark, place, mark.spacing() == Spacing::Joint));
            }
            TokenTree::Ident(_) => found.push((PieceKind::Word, place, false)),
            TokenTree::Literal(_) => found.push((PieceKind::Literal, place, false)),
        }
    }
    Some(found)
}

/// The same with marks of several characters as one.
fn joined(text: &str, places: Vec<(PieceKind, Range<usize>, bool)>) -> Vec<(PieceKind, Range<usize>)> {
    let mut found: Vec<(PieceKind, Range<usize>)> = Vec::with_capacity(places.len());
    let mut is_joint = false;
    for (kind, place, joint) in places {
        let last = found
            .last_mut()
            .filter(|(last, _)| is_joint && *last == PieceKind::Mark && kind == PieceKind::Mark);
        match last {
            Some((_, last)) if JOINED.contains(&&text[last.start..place.end]) => last.end = place.end,
            _ => found.push((kind, place)),
        }
        is_joint = joint;
    }
    found
}

/// Comments in a place between tokens; `None` where something else stands there.
fn comments<'a>(text: &'a str, place: Range<usize>, pieces: &mut Vec<Piece<'a>>) -> Option<()> {
    let mut at = place.start;
    loop {
        let rest = text.get(at..place.end)?;
        let start = at + (rest.len() - rest.trim_start().len());
        let rest = text.get(start..place.end)?;
        let (kind, length) = match rest.get(..2) {
            Some("//") => (PieceKind::LineComment, rest.find('\n').unwrap_or(rest.len())),
            Some("/*") => (PieceKind::BlockComment, block_comment(rest)?),
            _ => return rest.is_empty().then_some(()),
        };
        pieces.push(piece(kind, rest.get(..length)?.trim_end(), text.get(at..start)?));
        at = start + length;
    }
}

/// Length of the comment that a text begins with; others may be nested in it.
fn block_comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(first) = text.get(at..)?.chars().next() {
        let pair = text.get(at..at + 2).unwrap_or_default();
        match pair {
            "/*" => depth += 1,
            "*/" => depth = depth.saturating_sub(1),
            _ => {
                at += first.len_utf8();
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

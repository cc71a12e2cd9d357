//! Statements and their blocks, one below the other.

use super::LEVEL;
use super::lines::{self, WIDTH};
use super::pieces::{Piece, PieceKind};

/// Statements whose braces hold statements; those of others hold fields.
const BLOCKS: [&str; 4] = ["constraint", "for", "effect", "scene"];

/// The pieces of a text at a margin, with a line end behind the last.
pub fn laid_out(pieces: &[Piece<'_>], margin: usize) -> String {
    let mut page = Page { text: String::new() };
    page.block(pieces, margin);
    page.text
}

struct Page {
    text: String,
}

impl Page {
    fn line(&mut self, margin: usize, written: &str) {
        self.text.extend(core::iter::repeat_n(' ', margin));
        self.text += written;
        self.text.push('\n');
    }

    /// Appends a comment to the last line.
    fn append(&mut self, comment: &str) {
        if self.text.ends_with('\n') {
            self.text.pop();
        }
        self.text += &format!(" {comment}\n");
    }

    /// Statements and comments of a block. One blank line stays of several, none at the block's ends.
    fn block(&mut self, pieces: &[Piece<'_>], margin: usize) {
        let mut rest = pieces;
        let mut is_first = true;
        while let Some(piece) = rest.first() {
            if piece.line_ends > 1 && !is_first {
                self.text.push('\n');
            }
            let is_behind = piece.line_ends == 0 && !self.text.is_empty() && piece.kind != PieceKind::Doc;
            let length = if piece.is_comment() {
                match is_behind {
                    true => self.append(piece.text),
                    false => self.line(margin, piece.text),
                }
                1
            } else {
                let length = statement(rest);
                self.statement(&rest[..length], margin);
                length
            };
            rest = &rest[length..];
            is_first = false;
        }
    }

    fn statement(&mut self, pieces: &[Piece<'_>], margin: usize) {
        let brace = pieces.iter().position(|piece| piece.is("{"));
        let holds_statements = pieces.first().is_some_and(|first| BLOCKS.iter().any(|word| first.is(word)));
        let (Some(brace), true) = (brace, holds_statements && pieces.last().is_some_and(|last| last.is("}")))
        else {
            let laid = lines::laid_out(pieces, margin);
            self.text += &laid;
            return;
        };
        let inside = &pieces[brace + 1..pieces.len() - 1];
        // Rows that the author has in one line stay there; of other blocks a single statement does.
        let is_one_line = !inside.is_empty()
            && !inside.iter().any(|piece| piece.is_comment() || piece.is("{"))
            && (pieces[0].is("constraint") || statement(inside) == inside.len())
            && pieces[brace..].iter().all(|piece| piece.line_ends == 0);
        if inside.is_empty() || is_one_line {
            let laid = lines::laid_out(pieces, margin);
            if laid.lines().count() == 1 && laid.trim_end().chars().count() <= WIDTH {
                self.text += &laid;
                return;
            }
        }
        self.text += &lines::laid_out(&pieces[..=brace], margin);
        self.block(inside, margin + LEVEL);
        self.line(margin, "}");
    }
}

/// Number of pieces of the statement that a block begins with: up to its `;`, behind its braces, or an attribute.
fn statement(pieces: &[Piece<'_>]) -> usize {
    let mut depth = 0_usize;
    let is_attribute = pieces.first().is_some_and(|first| first.is("#"));
    for (index, piece) in pieces.iter().enumerate() {
        match piece.kind {
            PieceKind::Open => depth += 1,
            PieceKind::Close => {
                depth = depth.saturating_sub(1);
                if depth == 0 && (piece.is("}") || is_attribute) {
                    return index + 1;
                }
            }
            PieceKind::Mark if depth == 0 && piece.is(";") => return index + 1,
            // A doc comment belongs to the next statement.
            PieceKind::Doc if depth == 0 && index > 0 => return index,
            _ => {}
        }
    }
    pieces.len()
}

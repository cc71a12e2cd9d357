//! A cursor over the flat list of tokens.

use std::collections::BTreeSet;

use proc_macro2::Span;

use super::ast::{Declares, Name, StatementKind, Type};
use super::keywords::STATEMENTS;
use super::missing;
use super::quotation::quoted;
use super::tokens::{Token, TokenKind};
use crate::diagnostics::Diagnostics;

/// A fault was reported; the statement is given up and reading continues after it.
#[derive(Debug)]
pub struct GivenUp;

/// Result of reading a part of a statement.
pub type Read<T> = Result<T, GivenUp>;

/// Reads tokens one after the other and reports what does not fit.
pub struct Parser<'a> {
    tokens: &'a [Token],
    next: usize,
    /// Receiver of faults.
    pub diagnostics: &'a mut Diagnostics,
    /// Declarations and scenes that were given up after their name.
    pub faulty: Vec<StatementKind>,
    /// Statements that one statement stands for, beside the one that its reader returned.
    pub more: Vec<StatementKind>,
    /// Names behind the word `function`.
    functions: BTreeSet<&'a str>,
    /// Names behind words that begin a statement.
    declared: BTreeSet<&'a str>,
}

static BEHIND: TokenKind = TokenKind::End;

impl<'a> Parser<'a> {
    /// `tokens` end with [`Kind::End`].
    pub fn new(tokens: &'a [Token], diagnostics: &'a mut Diagnostics) -> Self {
        let behind = |is_word: fn(&str) -> bool| {
            let pairs = tokens.iter().zip(tokens.iter().skip(1));
            let names = pairs.filter_map(move |(word, name)| match (&word.kind, &name.kind) {
                (TokenKind::Identifier(word), TokenKind::Identifier(name)) if is_word(word) => {
                    Some(name.as_str())
                }
                _ => None,
            });
            names.collect()
        };
        let functions = behind(|word| word == "function");
        let declared = behind(|word| STATEMENTS.contains(&word));
        Parser { tokens, next: 0, diagnostics, faulty: Vec::new(), more: Vec::new(), functions, declared }
    }

    /// `true` if a statement declares this name, as far as the words before names tell.
    pub fn declares(&self, name: &str) -> bool {
        self.declared.contains(name)
    }

    /// `true` if the text declares a function of this name.
    pub fn declares_function(&self, name: &str) -> bool {
        self.functions.contains(name)
    }

    /// The next token's kind.
    pub fn peek(&self) -> &'a TokenKind {
        self.peek_at(0)
    }

    /// The kind of the token `ahead` places further on.
    pub fn peek_at(&self, ahead: usize) -> &'a TokenKind {
        self.tokens.get(self.next + ahead).map_or(&BEHIND, |token| &token.kind)
    }

    /// The next token's span.
    pub fn span(&self) -> Span {
        let last = self.tokens.last().map_or_else(Span::call_site, |token| token.span);
        self.tokens.get(self.next).map_or(last, |token| token.span)
    }

    /// The tokens from here on.
    pub fn rest(&self) -> &'a [Token] {
        self.tokens.get(self.next..).unwrap_or(&[])
    }

    /// The tokens before this one.
    pub fn before(&self) -> &'a [Token] {
        self.tokens.get(..self.next).unwrap_or(&[])
    }

    /// Advances by `count` tokens.
    pub fn skip(&mut self, count: usize) {
        self.next = (self.next + count).min(self.tokens.len().saturating_sub(1));
    }

    /// Takes the next token if it is this punctuation.
    pub fn take(&mut self, character: char) -> bool {
        let found = matches!(self.peek(), TokenKind::Punctuation(c, _) | TokenKind::Open(c) | TokenKind::Close(c) if *c == character);
        if found {
            self.skip(1);
        }
        found
    }

    /// `true` if the next two tokens are this pair of punctuation.
    pub fn at_pair(&self, first: char, second: char) -> bool {
        matches!(self.peek(), TokenKind::Punctuation(c, true) if *c == first)
            && matches!(self.peek_at(1), TokenKind::Punctuation(c, _) if *c == second)
    }

    /// Takes the next token if it is this word.
    pub fn take_word(&mut self, word: &str) -> bool {
        let found = self.at_word(word);
        if found {
            self.skip(1);
        }
        found
    }

    /// `true` if the next token is this word.
    pub fn at_word(&self, word: &str) -> bool {
        matches!(self.peek(), TokenKind::Identifier(text) if text == word)
    }

    /// Reports that something else was expected here.
    pub fn expected<T>(&mut self, what: &str, help: &str) -> Read<T> {
        let found = self.tokens.get(self.next).map_or_else(|| "the end of the text".into(), Token::describe);
        let span = self.span();
        self.diagnostics.report(span, format!("expected {what}, found {found}"), help);
        Err(GivenUp)
    }

    /// Takes this punctuation or reports that it is missing.
    pub fn expect(&mut self, character: char, help: &str) -> Read<()> {
        if self.take(character) { Ok(()) } else { self.expected(&format!("`{character}`"), help) }
    }

    /// Takes a name or reports that it is missing.
    pub fn name(&mut self, help: &str) -> Read<Name> {
        match self.peek() {
            TokenKind::Identifier(text) if text != "_" => {
                let name = Name { text: text.clone(), span: self.span() };
                self.skip(1);
                Ok(name)
            }
            _ => self.expected("a name", help),
        }
    }

    /// Keeps the name of a declaration that `read` gives up after it.
    pub fn declare<T>(
        &mut self,
        declares: Declares,
        help: &str,
        read: impl FnOnce(&mut Self, &mut Option<Type>) -> Read<T>,
    ) -> Read<(Name, T)> {
        let word = self.before().last().map_or_else(String::new, |token| quoted(std::slice::from_ref(token)));
        let name = self.name(help)?;
        let mut others = Vec::new();
        if declares != Declares::Element
            && matches!(self.peek(), TokenKind::Punctuation(',', _))
            && matches!(self.peek_at(1), TokenKind::Identifier(_))
        {
            others = missing::more_names(self, &word, &name.text);
        }
        let mut kind = None;
        let begin = self.next;
        let read = match self.peek() {
            TokenKind::Punctuation('=', _)
                if declares != Declares::Element
                    && !matches!(word.as_str(), "let" | "curve")
                    && STATEMENTS.contains(&word.as_str()) =>
            {
                missing::no_unit(self, &word, &name.text)
            }
            _ => read(self, &mut kind),
        };
        if read.is_err() {
            let end = std::mem::replace(&mut self.next, begin);
            others.extend(missing::names_to_end(self));
            self.next = end;
            self.faulty.push(StatementKind::Faulty { name: name.clone(), declares, kind: kind.clone() });
        }
        let stand_in =
            |(text, span)| StatementKind::Faulty { name: Name { text, span }, declares, kind: kind.clone() };
        self.faulty.extend(others.into_iter().map(stand_in));
        read.map(|read| (name, read))
    }

    /// Keeps the name of a constraint or drive with rows that could not be read.
    pub fn faulty_rows(&mut self, name: &Name) {
        let (name, kind) = (name.clone(), None);
        self.faulty.push(StatementKind::Faulty { name, declares: Declares::Rows, kind });
    }

    /// Skips to the token after the bracket that closes the one just before the cursor, or to the end.
    pub fn skip_group(&mut self) {
        let mut depth = 1;
        while depth > 0 && *self.peek() != TokenKind::End {
            match self.peek() {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) => depth -= 1,
                _ => {}
            }
            self.skip(1);
        }
    }
}

/// Tokens of `#[doc = "text"]`.
pub const DOC_ATTRIBUTE: usize = 6;

/// The text where the tokens begin with `#[doc = "text"]`.
pub fn doc_attribute(tokens: &[Token]) -> Option<String> {
    let [mark, open, word, equals, literal, close, ..] = tokens else { return None };
    let is_doc = matches!(mark.kind, TokenKind::Punctuation('#', _))
        && open.kind == TokenKind::Open('[')
        && word.kind == TokenKind::Identifier("doc".into())
        && matches!(equals.kind, TokenKind::Punctuation('=', _))
        && close.kind == TokenKind::Close(']');
    match &literal.kind {
        TokenKind::Literal(text) if is_doc => {
            syn::parse_str::<syn::LitStr>(text).ok().map(|text| text.value())
        }
        _ => None,
    }
}

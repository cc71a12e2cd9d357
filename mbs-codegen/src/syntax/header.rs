//! `{ attr } [ vis ] mechanism Name ;` in front of the statements.

use proc_macro2::{Delimiter, Ident, Span, TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream, Parser};
use syn::{Attribute, Token, Visibility};

use super::keywords::STATEMENTS;
use super::rust_identifiers::{UNUSABLE, identifier};
use crate::diagnostics::Diagnostics;

/// Head of a text, before its statements.
pub struct Header {
    /// Path of the runtime crate, as the wrapper macro passes it on.
    pub runtime: TokenStream,
    /// Doc comments and attributes of the mechanism.
    pub attributes: Vec<Attribute>,
    /// Visibility of everything emitted.
    pub visibility: Visibility,
    /// Name of the mechanism, raw where it is a keyword.
    pub name: Ident,
}

impl Header {
    /// The name without the `r#` of a raw identifier: as messages and other names have it.
    pub fn label(&self) -> String {
        self.name.unraw().to_string()
    }

    /// Reason why no type can have the name, if there is one.
    pub fn name_fault(&self) -> Option<String> {
        let name = self.label();
        if UNUSABLE.contains(&name.as_str()) {
            Some(format!("`{name}` is a word of Rust that cannot be a name"))
        } else if name == SCALAR {
            Some(format!("`{name}` stands for the type of numbers in the emitted code"))
        } else if name.starts_with(OWN) {
            Some(format!("names that begin with `{OWN}` are those of the emitted code"))
        } else {
            None
        }
    }
}

/// Name of the emitted code's type parameter.
const SCALAR: &str = "T";
/// Prefix of the names that emitted code defines.
pub const OWN: &str = "__";

/// Before: the whole input. After: the runtime's path in parentheses at its begin (without it `::mbs_runtime`); the
/// tokens up to the first `;`, which the header is read from; the tokens after it.
pub fn split(input: TokenStream) -> (TokenStream, TokenStream, TokenStream) {
    let mut tokens = input.into_iter().peekable();
    let runtime = match tokens.peek() {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis => {
            let path = group.stream();
            tokens.next();
            path
        }
        _ => quote::quote!(::mbs_runtime),
    };
    let mut first = Vec::new();
    for tree in tokens.by_ref() {
        let is_end = matches!(&tree, TokenTree::Punct(mark) if mark.as_char() == ';');
        first.push(tree);
        if is_end {
            break;
        }
    }
    (runtime, first.into_iter().collect(), tokens.collect())
}

/// Before: the tokens up to the first `;`, measured to be of bounded depth. After: the header and the tokens that
/// do not belong to it, or the fault reported.
pub fn read(
    tokens: TokenStream,
    runtime: TokenStream,
    diagnostics: &mut Diagnostics,
) -> Option<(Header, TokenStream)> {
    let parser = |input: ParseStream<'_>| header(input, runtime);
    let (found, fault) = match parser.parse2(tokens) {
        Ok((header, rest, fault)) => (Some((header, rest)), fault),
        Err(fault) => (None, Some(fault)),
    };
    if let Some(fault) = fault {
        let span = if fault.span().start().line == 0 { Span::call_site() } else { fault.span() };
        diagnostics.report(
            span,
            format!("the header is incomplete: {fault}"),
            "begin the text with `pub mechanism Name;`, doc comments and attributes before it",
        );
    }
    found
}

/// The header, the tokens that do not belong to it, and the fault where its `;` is missing.
fn header(
    input: ParseStream<'_>,
    runtime: TokenStream,
) -> syn::Result<(Header, TokenStream, Option<syn::Error>)> {
    let attributes = input.call(Attribute::parse_outer)?;
    let visibility = Visibility::parse(input)?;
    let keyword: Ident = input.parse()?;
    if keyword != "mechanism" {
        return Err(syn::Error::new(keyword.span(), format!("expected `mechanism`, found `{keyword}`")));
    }
    let quoted = input.fork().parse::<syn::LitStr>().ok();
    let nameless = |fault: syn::Error| match &quoted {
        Some(name) => {
            syn::Error::new(fault.span(), format!("its name `{}` stands without quotes", name.value()))
        }
        None => syn::Error::new(fault.span(), "expected identifier"),
    };
    let name: Ident = input.call(Ident::parse_any).map_err(nameless)?;
    let name = identifier(&name.unraw().to_string(), name.span());
    if input.peek(syn::token::Brace) {
        let message = format!("its statements stand behind `{}`, not in braces", name.unraw());
        let fault = syn::Error::new(input.span(), message);
        let TokenTree::Group(braces) = input.parse()? else { return Err(fault) };
        input.parse::<TokenStream>()?;
        return Ok((Header { runtime, attributes, visibility, name }, braces.stream(), Some(fault)));
    }
    let end: syn::Result<Token![;]> = input.parse();
    let rest: TokenStream = input.parse()?;
    // After the name a statement may follow, its `;` forgotten, or tokens without meaning.
    let is_statement = match rest.clone().into_iter().next() {
        Some(TokenTree::Ident(word)) => STATEMENTS.iter().any(|known| word == known),
        _ => false,
    };
    let rest = if is_statement { rest } else { TokenStream::new() };
    Ok((Header { runtime, attributes, visibility, name }, rest, end.err()))
}

//! `{ attr } [ vis ] mechanism Name ;` in front of the statements.

use proc_macro2::{Delimiter, Ident, Span, TokenStream, TokenTree};
use syn::parse::{Parse, ParseStream, Parser};
use syn::{Attribute, Token, Visibility};

use crate::diagnostics::Diagnostics;

/// What stands in front of the statements.
pub struct Header {
    /// Path of the runtime crate, as the wrapper macro passes it on.
    pub runtime: TokenStream,
    /// Doc comments and attributes of the mechanism.
    pub attributes: Vec<Attribute>,
    /// Visibility of everything emitted.
    pub visibility: Visibility,
    /// Name of the mechanism.
    pub name: Ident,
}

/// Before: the whole input. After: the runtime's path, which leads in parentheses (without it `::mbs_runtime`), the
/// tokens up to the first `;`, which the header is read from, and the tokens behind it.
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

/// The header, the tokens that do not belong to it, and what is wrong where its `;` should stand.
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
    let name = input.parse()?;
    let end: syn::Result<Token![;]> = input.parse();
    let rest: TokenStream = input.parse()?;
    // Behind the name a statement may stand, its `;` forgotten, or something that means nothing.
    let is_statement = matches!(rest.clone().into_iter().next(), Some(TokenTree::Ident(_)));
    let rest = if is_statement { rest } else { TokenStream::new() };
    Ok((Header { runtime, attributes, visibility, name }, rest, end.err()))
}

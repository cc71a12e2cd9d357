//! `{ attr } [ vis ] mechanism Name ;` in front of the statements.

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
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

/// Before: the whole input, measured to be of bounded depth. After: the header and the tokens behind it.
///
/// A leading group in parentheses is the runtime's path; without one it is `::mbs_runtime`.
pub fn split(input: TokenStream, diagnostics: &mut Diagnostics) -> Option<(Header, TokenStream)> {
    let mut tokens = input.into_iter().peekable();
    let runtime = match tokens.peek() {
        Some(TokenTree::Group(group)) if group.delimiter() == proc_macro2::Delimiter::Parenthesis => {
            let path = group.stream();
            tokens.next();
            path
        }
        _ => quote::quote!(::mbs_runtime),
    };
    let parser = |input: ParseStream<'_>| header(input, runtime);
    match parser.parse2(tokens.collect()) {
        Ok(found) => Some(found),
        Err(fault) => {
            let span = if fault.span().start().line == 0 { Span::call_site() } else { fault.span() };
            diagnostics.report(
                span,
                format!("the header is incomplete: {fault}"),
                "begin the text with `pub mechanism Name;`, doc comments and attributes before it",
            );
            None
        }
    }
}

fn header(input: ParseStream<'_>, runtime: TokenStream) -> syn::Result<(Header, TokenStream)> {
    let attributes = input.call(Attribute::parse_outer)?;
    let visibility = Visibility::parse(input)?;
    let keyword: Ident = input.parse()?;
    if keyword != "mechanism" {
        return Err(syn::Error::new(keyword.span(), format!("expected `mechanism`, found `{keyword}`")));
    }
    let name = input.parse()?;
    input.parse::<Token![;]>()?;
    Ok((Header { runtime, attributes, visibility, name }, input.parse()?))
}

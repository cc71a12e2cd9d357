//! Tokens of a mechanism in, tokens of exact straight-line code out.

pub mod diagnostics;
pub mod model;
pub mod syntax;

use proc_macro2::TokenStream;

/// Expands the text of a mechanism, led by the runtime's path in parentheses.
pub fn expand(_input: TokenStream) -> TokenStream {
    TokenStream::new()
}

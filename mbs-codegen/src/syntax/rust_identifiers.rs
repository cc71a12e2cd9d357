//! Words of Rust as names.

use proc_macro2::{Ident, Span};

/// Words that cannot name anything, not even as raw identifiers.
pub const UNUSABLE: [&str; 5] = ["self", "Self", "super", "crate", "_"];

/// `true` if some edition keeps the word for itself; `syn` does not know those of 2024 yet.
pub fn is_keyword(name: &str) -> bool {
    name == "gen" || syn::parse_str::<Ident>(name).is_err()
}

/// The name as an identifier, raw where it is a keyword.
pub fn identifier(name: &str, span: Span) -> Ident {
    if is_keyword(name) && !UNUSABLE.contains(&name) {
        Ident::new_raw(name, span)
    } else {
        Ident::new(name, span)
    }
}

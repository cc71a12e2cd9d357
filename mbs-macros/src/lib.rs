//! The procedural macro of `mbs_runtime::mechanism!`.
//!
//! Use it through `mbs-runtime`, which passes its own path on, so that the crate may be renamed.

/// Expands `(path::to::runtime) text of a mechanism`.
#[doc(hidden)]
#[proc_macro]
pub fn mechanism(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    mbs_codegen::expand(input.into()).into()
}

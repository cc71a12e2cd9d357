//! Any bytes as a text: faults on its tokens or an expansion, never a panic.

#![no_main]

use libfuzzer_sys::fuzz_target;

/// Longest text (bytes): a longer one repeats what a short one has.
const LONGEST: usize = 4096;

fuzz_target!(|text: &str| {
    if text.len() > LONGEST {
        return;
    }
    if let Ok(tokens) = text.parse::<proc_macro2::TokenStream>() {
        let once = mbs_codegen::expand(tokens.clone()).to_string();
        assert_eq!(once, mbs_codegen::expand(tokens).to_string(), "one text, two expansions");
    }
    let _ = mbs_codegen::outline(text);
    let _ = mbs_codegen::faults_of_form(text);
    let _ = mbs_codegen::warnings(text);
    let _ = mbs_codegen::structure_of(text, None);
});

//! The feature `libm` of the runtime replaces the kernels of sine and cosine by those of the library, bit for bit. A
//! crate of its own: all others of the workspace share one choice of features.
#![forbid(unsafe_code)]

use mbs_tests::tools;
use mbs_tests::written::WrittenCrate;

const MANIFEST: &str = r#"
[package]
name = "library-trigonometry"
edition = "2024"

[features]
library = ["mbs-runtime/libm"]

[dependencies]
mbs-runtime = { path = "../../mbs-runtime", default-features = false }
libm = { version = "0.2.16", default-features = false, features = ["arch"] }

[workspace]
"#;

#[test]
fn the_feature_chooses_the_library_bit_for_bit() {
    let written = WrittenCrate::new(env!("CARGO_TARGET_TMPDIR"), "library_trigonometry", MANIFEST);
    written.write("src/main.rs", include_str!("library_trigonometry/program.rs"));
    let run = |arguments: &[&str]| {
        tools::output(&mut written.cargo(arguments), "the tests need cargo, which runs them")
    };
    let said = run(&["run", "--features=library"]).unwrap_or_else(|said| panic!("{said}"));
    assert_eq!(said.trim(), "16010 angles", "{said}");
    // The control: the kernels round some angles another way.
    let said = run(&["run"]).expect_err("the library without the feature");
    assert!(said.contains("panicked at src/main.rs"), "{said}");
}

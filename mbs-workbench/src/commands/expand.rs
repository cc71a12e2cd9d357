//! `mbs expand`.

use crate::catalogue::Catalogue;
use std::io::Write;

use clap::Args;

use super::CommandError;

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it
    name: String,
}

/// The emitted code, laid out as rustfmt would.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let source = catalogue.find(&arguments.name)?.equations().source();
    let tokens = mbs_codegen::expand_source(source).map_err(CommandError::Failed)?;
    let file = syn::parse2(tokens)
        .map_err(|error| CommandError::Failed(format!("the emitted code is no Rust file: {error}")))?;
    out.write_all(prettyplease::unparse(&file).as_bytes())?;
    Ok(())
}

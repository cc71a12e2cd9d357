//! `mbs expand`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::output::origin::Origin;
use crate::text_file::{TextFile, is_file};
use clap::Args;

use super::CommandError;
use super::document::Output;

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    pub name: String,
}

/// The emitted code, laid out as rustfmt would.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let source: String = match is_file(&arguments.name) {
        true => TextFile::read(&arguments.name)?.source,
        false => catalogue.find(&arguments.name)?.equations().source().to_string(),
    };
    out.put_text(&Origin::of_text(&arguments.name, &source), &arguments.name, None);
    let tokens = mbs_codegen::expand_source(&source).map_err(CommandError::Failed)?;
    let file = syn::parse2(tokens)
        .map_err(|error| CommandError::Failed(format!("the emitted code is no Rust file: {error}")))?;
    let code = prettyplease::unparse(&file);
    out.write_all(code.as_bytes())?;
    out.put("code", code);
    Ok(())
}

//! `mbs latex`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::path::PathBuf;

use crate::output::latex::document;
use clap::Args;

use super::CommandError;
use super::chosen::{Chosen, require_named, write_file};
use super::document::Output;
use super::text::Text;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Φ, Φ_q, Φ_t and γ, of a mechanism with masses M, Q and the energies too, as a document for `pdflatex`.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    require_named(arguments.out.as_ref())?;
    let text = Text::find(catalogue, &arguments.chosen)?;
    let formulas = mbs_codegen::latex_formulas(&text.source, text.scene()).map_err(CommandError::Failed)?;
    let dynamic =
        mbs_codegen::latex_dynamic_formulas(&text.source, text.scene()).map_err(CommandError::Failed)?;
    let origin = text.put(out);
    let text = origin.latex(&document(&text.values, &formulas, dynamic.as_ref(), &text.title));
    match &arguments.out {
        None => {
            out.write_all(text.as_bytes())?;
            out.put("document", text);
        }
        Some(path) => {
            write_file(path, &text)?;
            out.put_file("document", path);
            writeln!(out, "document  {}", path.display())?;
        }
    }
    Ok(())
}

//! Output of a command: lines of text, or with `--json` one document.

use std::io::{self, Write};
use std::path::Path;

use mbs_codegen::{Fault, WHOLE};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::CommandError;
use super::target::Target;
use crate::erased::facade::AnyEquations;
use crate::output::origin::{Origin, VERSION};

/// Number of the schemas: it grows when a field changes its meaning or goes.
const SCHEMA: u32 = 1;

/// Lines of text, or the fields of a document.
pub struct Output<'a> {
    text: &'a mut dyn Write,
    document: Option<Map<String, Value>>,
}

impl<'a> Output<'a> {
    /// Output of the command to `text`; `schema`: name of its document, where one is asked for.
    pub fn new(text: &'a mut dyn Write, schema: Option<&str>) -> Self {
        let document = schema.map(|name| {
            let arguments: Vec<String> =
                std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
            let head = json!({ "schema": format!("mbs/{name}/{SCHEMA}"), "version": VERSION, "arguments": arguments });
            match head {
                Value::Object(head) => head,
                _ => Map::new(),
            }
        });
        Output { text, document }
    }

    /// `true` where a document is asked for.
    pub fn is_document(&self) -> bool {
        self.document.is_some()
    }

    /// Sets a field of the document.
    pub fn put(&mut self, field: &str, value: impl Serialize) {
        if let Some(document) = &mut self.document {
            let value = serde_json::to_value(value).expect("plain data has a JSON form");
            document.insert(field.to_string(), value);
        }
    }

    /// Adds an element to a list of the document.
    pub fn push(&mut self, field: &str, value: impl Serialize) {
        if let Some(document) = &mut self.document {
            let value = serde_json::to_value(value).expect("plain data has a JSON form");
            match document.entry(field).or_insert_with(|| json!([])) {
                Value::Array(list) => list.push(value),
                other => *other = json!([value]),
            }
        }
    }

    /// The text that the results are of.
    pub fn put_text(&mut self, origin: &Origin, title: &str, scene: Option<&str>) {
        self.put("text", json!({ "name": origin.name, "title": title, "scene": scene, "hash": origin.hash }));
    }

    /// The mechanism that the results are of; its origin is that of the files.
    pub fn put_mechanism(&mut self, target: &Target, mechanism: &dyn AnyEquations) -> Origin {
        let origin = Origin::of_text(target.name(), mechanism.source());
        let scene = Some(mechanism.scene()).filter(|scene| *scene != WHOLE);
        self.put_text(&origin, target.title(), scene);
        origin
    }

    /// A file that was written.
    pub fn put_file(&mut self, kind: &str, path: &Path) {
        self.push("files", json!({ "kind": kind, "path": path.display().to_string() }));
    }

    /// Ends the document, with the error of the command.
    ///
    /// # Errors
    /// That of the writer.
    pub fn end(&mut self, error: Option<&CommandError>) -> io::Result<()> {
        if let Some(mut document) = self.document.take() {
            if let Some(error) = error {
                let message = error.to_string();
                let error = json!({ "message": message, "exit_code": error.exit_code() });
                document.insert("error".to_string(), error);
            }
            writeln!(self.text, "{}", Value::Object(document))?;
        }
        self.text.flush()
    }
}

/// Text is left out where a document is asked for.
impl Write for Output<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_document() { Ok(bytes.len()) } else { self.text.write(bytes) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.text.flush()
    }
}

/// A fault or a warning with its place.
pub fn fault(fault: &Fault) -> Value {
    let Fault { line, column, end_line, end_column, message, help } = fault;
    json!({
        "line": line, "column": column, "end_line": end_line, "end_column": end_column, "message": message, "help": help,
    })
}

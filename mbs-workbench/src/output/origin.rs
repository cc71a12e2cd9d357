//! Origin of a file that was written: program, version, text.

use crate::hash::{hash, hash_of_text};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Kind of a law in words.
const LAW: &str = "law";

/// Text, table or law that a file was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Its name on the command line.
    pub name: String,
    /// Its kind: `text`, `table` or `law`.
    kind: &'static str,
    /// Hash of its tokens, of a table of its bytes.
    pub hash: String,
}

impl Origin {
    /// That of a mechanism's text. Layout and comments change nothing.
    pub fn of_text(name: &str, source: &str) -> Self {
        Origin { name: name.to_string(), kind: "text", hash: hash_of_text(source) }
    }

    /// That of a table in a file.
    pub fn of_table(name: &str, bytes: &[u8]) -> Self {
        Origin { name: name.to_string(), kind: "table", hash: hash(&[bytes]) }
    }

    /// That of a law in words, which is no path.
    pub fn of_law(words: &str, bytes: &[u8]) -> Self {
        Origin { name: words.to_string(), kind: LAW, hash: hash(&[bytes]) }
    }

    /// `mbs 0.1.0, four_bar, text 0123456789abcdef`; of a file its name without folders.
    pub fn line(&self) -> String {
        let Origin { name, kind, hash } = self;
        let whole = (*kind == LAW).then_some(name.as_str());
        let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let name = whole.unwrap_or(last).replace(['\n', '\r'], " ");
        format!("mbs {VERSION}, {name}, {kind} {hash}")
    }

    /// The table with the origin as a comment in its first line.
    pub fn csv(&self, text: &str) -> String {
        format!("# {}\n{text}", self.line())
    }

    /// The picture with the origin as metadata.
    pub fn svg(&self, text: &str) -> String {
        let line = self.line().replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        match text.find("<svg").and_then(|start| Some(start + text[start..].find('>')? + 1)) {
            Some(end) => format!("{}\n<metadata>{line}</metadata>{}", &text[..end], &text[end..]),
            None => text.to_string(),
        }
    }

    /// The LaTeX document with the origin as a comment in its first line.
    pub fn latex(&self, text: &str) -> String {
        format!("% {}\n{text}", self.line())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layout_and_comments_are_no_part_of_the_hash() {
        let of = |text: &str| Origin::of_text("a", text).hash;
        let text = "mechanism A; coord phi: rad; // comment\ndrive d: phi == 1*t/1s;";
        assert_eq!(of(text), of("mechanism A;\n\ncoord  phi : rad;\ndrive d: phi==1*t/1s;\n"));
        assert_ne!(of(text), of(&text.replace("1*t", "2*t")));
        assert_ne!(of("a b"), of("ab"));
    }

    #[test]
    fn every_kind_of_file_names_its_origin() {
        assert!(Origin::of_text("../b/a.rs:A", "").line().contains(", a.rs:A, text "));
        assert!(Origin::of_law("bspline:s = 1mm/rad", b"").line().contains(", bspline:s = 1mm/rad, law "));
        let origin = Origin::of_text("a<b", "mechanism A;");
        let line = origin.line();
        assert!(line.starts_with(&format!("mbs {VERSION}, a<b, text ")) && line.len() > 30, "{line}");
        assert_eq!(origin.csv("t,x\n"), format!("# {line}\nt,x\n"));
        assert_eq!(origin.latex("\\a"), format!("% {line}\n\\a"));
        let svg = origin.svg("<svg width=\"1\">\n<g/></svg>");
        assert!(
            svg.starts_with("<svg width=\"1\">\n<metadata>mbs ") && svg.ends_with("</metadata>\n<g/></svg>"),
            "{svg}"
        );
        assert!(svg.contains("a&lt;b"));
    }
}

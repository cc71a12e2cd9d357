//! Straight-line code in pieces that define and use locals; of many pieces, in parts that are compiled by themselves.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::code::bind;

/// Some lines.
pub struct Piece {
    /// The lines.
    pub text: String,
    /// Locals that they define: numbers of the scalar type.
    pub defines: Vec<String>,
    /// Locals of earlier pieces that they use.
    pub uses: Vec<String>,
}

/// Code, and how its locals are written behind it.
pub struct Code {
    /// The code.
    pub text: String,
    places: BTreeMap<String, String>,
}

impl Code {
    /// A local behind the code.
    pub fn of(&self, local: String) -> String {
        self.places.get(&local).cloned().unwrap_or(local)
    }
}

/// One piece behind the other, behind locals that are `given` as something else.
pub fn in_line(pieces: &[Piece], given: Vec<(String, String)>) -> Code {
    let mut text = String::new();
    bind(given.into_iter(), &mut text);
    pieces.iter().for_each(|piece| text += &piece.text);
    Code { text, places: BTreeMap::new() }
}

/// As [`in_line`], `length` pieces a part; each part passes on what it defines.
pub fn apart(pieces: &[Piece], given: Vec<(String, String)>, length: usize) -> Code {
    let mut text = String::new();
    let mut places: BTreeMap<String, String> = given.into_iter().collect();
    for (number, part) in pieces.chunks(length).enumerate() {
        let defined: Vec<&str> = part.iter().flat_map(|piece| &piece.defines).map(String::as_str).collect();
        let _ = writeln!(text, "let __part{number} = __mbs::long::apart(|| -> [T; {}] {{", defined.len());
        let used: BTreeMap<&String, &String> = part
            .iter()
            .flat_map(|piece| &piece.uses)
            .filter_map(|local| places.get_key_value(local))
            .collect();
        bind(used.into_iter().map(|(local, place)| (local.clone(), place.clone())), &mut text);
        part.iter().for_each(|piece| text += &piece.text);
        let _ = writeln!(text, "[{}]\n}});", defined.join(", "));
        for (index, local) in defined.into_iter().enumerate() {
            places.insert(local.to_owned(), format!("__part{number}[{index}]"));
        }
    }
    Code { text, places }
}

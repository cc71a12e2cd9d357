//! Hashes of emitted code, in the names of the time when it was frozen: the CHANGELOG's table of renames is applied backwards.

use std::fs;
use std::path::Path;

use proc_macro2::{TokenStream, TokenTree};
use syn::Item;

use crate::Hash;

/// Names that changed since: as they were, as they are.
fn renames(root: &Path) -> Vec<(String, String)> {
    let text = fs::read_to_string(root.join("CHANGELOG.md")).expect("a changelog");
    let table = text.split("<!-- renames in emitted code -->").nth(1).unwrap_or_default();
    let table = table.split("<!-- end of renames -->").next().unwrap_or_default();
    let mut found: Vec<(String, String)> = table
        .lines()
        .filter_map(|line| {
            let mut names =
                line.split('`').skip(1).step_by(2).map(|name| words(name.parse().expect("a path")));
            Some((names.next()?, names.next()?))
        })
        .collect();
    // A path before the name that it begins with.
    found.sort_by_key(|(_, new)| std::cmp::Reverse(new.len()));
    found
}

/// Tokens as words, each followed by a space. Line numbers are 0; documentation and the copy of the text are left out.
fn words(tokens: TokenStream) -> String {
    let mut text = String::new();
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let name = |index: usize| match tokens.get(index) {
        Some(TokenTree::Ident(ident)) => ident.to_string(),
        _ => String::new(),
    };
    let mut index = 0;
    while let Some(token) = tokens.get(index) {
        let before = index.checked_sub(2).map(name).unwrap_or_default();
        match token {
            TokenTree::Punct(punct) if punct.as_char() == '#' && is_documentation(tokens.get(index + 1)) => {
                index += 1
            }
            TokenTree::Literal(_) if before == "line" => text += "0 ",
            TokenTree::Group(group) => {
                let [open, close] = match group.delimiter() {
                    proc_macro2::Delimiter::Parenthesis => ["( ", ") "],
                    proc_macro2::Delimiter::Brace => ["{ ", "} "],
                    proc_macro2::Delimiter::Bracket => ["[ ", "] "],
                    proc_macro2::Delimiter::None => ["", ""],
                };
                text = text + open + &words(group.stream()) + close;
            }
            TokenTree::Ident(ident) if *ident == "SOURCE" || *ident == "__SOURCE" => {
                while tokens.get(index).is_some_and(|token| !is_end(token)) {
                    index += 1;
                }
            }
            other => text = text + &other.to_string() + " ",
        }
        index += 1;
    }
    text
}

/// The copy of the text, or the end of the constant that names it.
fn is_end(token: &TokenTree) -> bool {
    match token {
        TokenTree::Literal(_) => true,
        TokenTree::Punct(punct) => punct.as_char() == ';',
        _ => false,
    }
}

/// `true` if the brackets of an attribute hold documentation.
fn is_documentation(brackets: Option<&TokenTree>) -> bool {
    let Some(TokenTree::Group(group)) = brackets else { return false };
    matches!(group.stream().into_iter().next(), Some(TokenTree::Ident(ident)) if ident == "doc")
}

/// `true` if an item registers a scene with the workbench.
fn reveals(item: &Item) -> bool {
    let Item::Impl(implementation) = item else { return false };
    let name = implementation.trait_.as_ref().and_then(|(path, _)| path.segments.last());
    name.is_some_and(|name| name.ident == "Reveal" || name.ident == "InNumbers")
}

/// The texts between the braces of `mechanism! { … }` in the Rust files below a directory.
fn texts(directory: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let file = fs::read_to_string(&path).expect("a readable file");
            for text in file.split("\nmechanism! {\n").skip(1) {
                found.push(text[..text.find("\n}\n").expect("the end of a text")].to_owned());
            }
        }
    }
}

/// A hash for each mechanism of the catalogue, by its name.
pub fn of_catalogue() -> Vec<(String, Hash)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let renames = renames(&root);
    let mut found = Vec::new();
    texts(&root.join("mechanisms/src"), &mut found);
    let mut hashes: Vec<(String, Hash)> = found
        .iter()
        .map(|text| {
            let code = mbs_codegen::expand_source(text).expect("a text without faults");
            let items = syn::parse2::<syn::File>(code).expect("emitted code").items;
            let kept = items.iter().filter(|item| !reveals(item));
            let mut tokens = words(kept.map(|item| quote::quote!(#item)).collect());
            for (old, new) in &renames {
                tokens = tokens.replace(new.as_str(), old);
            }
            let name = text.split("mechanism ").nth(1).and_then(|rest| rest.split(';').next());
            let mut hash = Hash::new();
            hash.take(tokens.as_bytes());
            (name.expect("a header").to_owned(), hash)
        })
        .collect();
    hashes.sort_by(|(a, _), (b, _)| a.cmp(b));
    assert!(hashes.len() > 30, "{}", hashes.len());
    hashes
}

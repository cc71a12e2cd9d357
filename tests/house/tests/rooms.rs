//! Rooms of the source trees: their order, and that no import runs against it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{env, fs};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{ItemMod, ItemUse, Macro, UseTree, VisRestricted};

/// Rooms of a crate in reading order: each uses itself and those before it.
struct House {
    /// Source folder, below the root of the workspace.
    source: &'static str,
    /// Rooms, the lowest first. A room is a folder or a file below `source`, without its ending.
    rooms: &'static [&'static str],
}

const HOUSES: &[House] = &[
    House {
        source: "mbs-runtime/src",
        rooms: &[
            "scalar",
            "tolerances",
            "linear_algebra",
            "mechanism",
            "failure",
            "block_solvers",
            "kinematics",
            "stepper",
            "batch",
            "worst_case",
            "driver",
            "dynamics/integrators",
            "dynamics/model",
            "dynamics/linear_systems",
            "dynamics/formulations",
            "dynamics/implicit",
            "dynamics/time_stepping",
            "dynamics/first_order_form",
            "dynamics/equilibrium",
            "dynamics/analyses",
            "dynamics/simulation",
            "nalgebra",
            "__private",
        ],
    },
    House {
        source: "mbs-codegen/src",
        rooms: &[
            "diagnostics",
            "second_reading",
            "sample_points",
            "syntax",
            "syntax_tree",
            "symbolic",
            "model",
            "equations",
            "structure",
            "program",
            "picture",
            "emit",
            "outline",
            "random",
            "vocabulary",
        ],
    },
    House {
        source: "mbs-workbench/src",
        rooms: &[
            "target_directory",
            "hash",
            "random",
            "double_double",
            "setting",
            "motion",
            "erased",
            "output",
            "tables",
            "cams",
            "mismatch",
            "study",
            "layout",
            "text_file",
            "known_motion",
            "card",
            "catalogue",
            "forge",
            "verify",
            "teaching",
            "cost",
            "hard_cases",
            "effects",
            "commands",
            "command_line",
        ],
    },
];

/// A path in a source file, from the root of its crate, and its line.
type Reference = (Vec<String>, usize);

/// Paths that begin with `crate`, `super` or `self`, of imports, of bodies and of macro calls.
struct Paths {
    /// Module of the file.
    module: Vec<String>,
    /// Inline modules around the present place.
    inline: Vec<String>,
    found: Vec<Reference>,
}

impl Paths {
    fn of(module: &[String], file: &syn::File) -> Vec<Reference> {
        let mut paths = Paths { module: module.to_vec(), inline: Vec::new(), found: Vec::new() };
        paths.visit_file(file);
        paths.found
    }

    fn record(&mut self, path: &[String], line: usize) {
        let mut here = [self.module.clone(), self.inline.clone()].concat();
        let mut rest = path;
        match rest.first().map(String::as_str) {
            Some("crate") => here.clear(),
            Some("self" | "super") => {}
            _ => return,
        }
        while let Some(first) = rest.first() {
            match first.as_str() {
                "crate" | "self" => {}
                "super" => {
                    here.pop();
                }
                _ => break,
            }
            rest = &rest[1..];
        }
        here.extend_from_slice(rest);
        self.found.push((here, line));
    }

    fn imports(&mut self, tree: &UseTree, before: &mut Vec<String>, line: usize) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.imports(&path.tree, before, line);
                before.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|item| self.imports(item, before, line)),
            UseTree::Name(name) => {
                let leaf = name.ident.to_string();
                let path =
                    [&before[..], if leaf == "self" { &[] } else { core::slice::from_ref(&leaf) }].concat();
                self.record(&path, line);
            }
            UseTree::Rename(rename) => {
                self.record(&[&before[..], &[rename.ident.to_string()]].concat(), line);
            }
            UseTree::Glob(_) => self.record(before, line),
        }
    }

    /// Paths among the tokens of a macro call, which are no syntax tree.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let (mut line, mut colons) = (0, 2);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) if colons == 2 && !path.is_empty() => {
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Ident(ident) => {
                    self.record(&path, line);
                    path = vec![ident.to_string()];
                    (line, colons) = (ident.span().start().line, 0);
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' && !path.is_empty() => colons += 1,
                TokenTree::Group(group) => {
                    self.record(&path, line);
                    path.clear();
                    self.tokens(group.stream());
                }
                _ => {
                    self.record(&path, line);
                    path.clear();
                }
            }
        }
        self.record(&path, line);
    }
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let line = item.use_token.span.start().line;
        self.imports(&item.tree, &mut Vec::new(), line);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        // Tests may use the whole crate.
        let is_test = item.attrs.iter().any(|attribute| attribute.path().is_ident("cfg"));
        if item.content.is_some() && !is_test {
            self.inline.push(item.ident.to_string());
            visit::visit_item_mod(self, item);
            self.inline.pop();
        }
    }

    /// A visibility uses nothing.
    fn visit_vis_restricted(&mut self, _: &'ast VisRestricted) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        let line = path.segments.first().map_or(0, |segment| segment.ident.span().start().line);
        self.record(&names, line);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.tokens(call.tokens.clone());
        visit::visit_macro(self, call);
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Modules of a crate, with their files.
fn modules(source: &Path) -> BTreeMap<Vec<String>, PathBuf> {
    let mut files = Vec::new();
    sources(source, &mut files);
    let module = |file: &PathBuf| {
        let inside = file.strip_prefix(source).expect("a file of the crate").with_extension("");
        let mut names: Vec<String> =
            inside.iter().map(|name| name.to_str().expect("a name in UTF-8").to_owned()).collect();
        if names.last().is_some_and(|last| last == "mod" || last == "lib" || last == "main") {
            names.pop();
        }
        names
    };
    files.into_iter().map(|file| (module(&file), file)).collect()
}

/// The room of a module: the longest one that is a beginning of its path.
fn room(house: &House, module: &[String]) -> Option<usize> {
    let contains = |room: &&str| {
        let room: Vec<&str> = room.split('/').collect();
        room.len() <= module.len() && room.iter().zip(module).all(|(room, name)| room == name)
    };
    house.rooms.iter().position(contains)
}

/// References of each module that leave its room, as `file:line: room -> room`, with both rooms.
fn arrows(house: &House) -> (Vec<(usize, usize, String)>, Vec<String>) {
    let source = root().join(house.source);
    let modules = modules(&source);
    let (mut arrows, mut unclear) = (Vec::new(), Vec::new());
    for (module, file) in &modules {
        if module.last().is_some_and(|name| name == "tests" || name.ends_with("_tests")) {
            continue;
        }
        let text = fs::read_to_string(file).expect("a readable source");
        let parsed = syn::parse_file(&text).expect("a source that compiles");
        let Some(from) = room(house, module) else {
            // The root, and a folder that holds rooms alone: they declare and re-export.
            let holds = house.rooms.iter().any(|room| room.starts_with(&module.join("/")));
            if !holds {
                unclear.push(format!("{}: in no room", file.display()));
            }
            continue;
        };
        for (path, line) in Paths::of(module, &parsed) {
            let place = format!("{}:{line}", file.display());
            match room(house, &path) {
                Some(to) if to != from => {
                    let text = format!("{place}: {} -> {}", house.rooms[from], house.rooms[to]);
                    arrows.push((from, to, text));
                }
                Some(_) => {}
                None => unclear.push(format!("{place}: `{}` names no room", path.join("::"))),
            }
        }
    }
    (arrows, unclear)
}

#[test]
fn every_import_names_the_room_that_it_comes_from() {
    for house in HOUSES {
        let (_, unclear) = arrows(house);
        assert!(unclear.is_empty(), "{}:\n{}", house.source, unclear.join("\n"));
    }
}

#[test]
fn no_room_uses_one_that_stands_after_it() {
    for house in HOUSES {
        let (arrows, _) = arrows(house);
        assert!(!arrows.is_empty(), "{}: no import was found", house.source);
        let backwards: BTreeSet<String> =
            arrows.into_iter().filter(|(from, to, _)| from < to).map(|(.., text)| text).collect();
        let listed: Vec<String> = backwards.into_iter().collect();
        assert!(listed.is_empty(), "{}: against the order:\n{}", house.source, listed.join("\n"));
    }
}

/// Rooms whose files use each other in one direction too.
const WITHOUT_CIRCLES: [(&str, &str); 5] = [
    ("mbs-codegen/src", "model"),
    ("mbs-codegen/src", "equations"),
    ("mbs-codegen/src", "structure"),
    ("mbs-codegen/src", "program"),
    ("mbs-codegen/src", "emit/rust"),
];

/// Files of a room that each file uses; the room's own file, which declares the others, left out.
fn uses(source: &str, room: &str) -> BTreeMap<String, BTreeSet<String>> {
    let modules = modules(&root().join(source));
    let room: Vec<&str> = room.split('/').collect();
    let name = |path: &[String]| {
        path.get(room.len()).filter(|_| room.iter().zip(path).all(|(room, name)| room == name)).cloned()
    };
    let known: BTreeSet<String> = modules.keys().filter_map(|module| name(module)).collect();
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, file) in &modules {
        let Some(from) = name(module) else { continue };
        let text = fs::read_to_string(file).expect("a readable source");
        let parsed = syn::parse_file(&text).expect("a source that compiles");
        let used = Paths::of(module, &parsed).into_iter().filter_map(|(path, _)| name(&path));
        let used = used.filter(|to| *to != from && known.contains(to));
        uses.entry(from.clone()).or_default().extend(used);
    }
    uses
}

#[test]
fn files_of_a_room_have_no_circle() {
    for (source, room) in WITHOUT_CIRCLES {
        let mut uses = uses(source, room);
        let all = uses.len();
        assert!(all > 3, "{source}/{room}: no files were found");
        // What uses nothing that is left is no part of a circle.
        while let Some(free) = uses.iter().find(|(_, used)| used.is_empty()).map(|(file, _)| file.clone()) {
            uses.remove(&free);
            for used in uses.values_mut() {
                used.remove(&free);
            }
        }
        assert!(uses.len() < all && uses.is_empty(), "{source}/{room}: in a circle, or above one: {uses:?}");
    }
}

#[test]
fn paths_of_imports_bodies_and_macros_are_found() {
    let text = "use crate::a::{b::C, d};\n\
                mod tests { use super::e::F; fn f() { super::super::g(); } }\n\
                fn h() { let _ = crate::i::J::<crate::k::L>::new(); assert!(self::m::n(crate::o::P)); }";
    let parsed = syn::parse_file(text).expect("a source");
    let found = Paths::of(&["x".to_owned(), "y".to_owned()], &parsed);
    let found: BTreeSet<String> = found.into_iter().map(|(path, _)| path.join("::")).collect();
    let expected = ["a::b::C", "a::d", "x::y::e::F", "x::g", "i::J::new", "k::L", "x::y::m::n", "o::P"];
    assert_eq!(found, expected.map(str::to_owned).into());
}

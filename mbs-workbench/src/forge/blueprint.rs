//! Crates that the forge builds: their `Cargo.toml` and their one source file.

use std::path::Path;
use std::process::Command;

use mbs_codegen::DeclaredFunction;
use mbs_runtime::FunctionEntry;

use super::{Forge, ForgeError, not_started, sources};
use crate::card::{Card, snake_case};
use crate::text_file::TextFile;

/// Head of the source file.
const HEAD: &str = "use std::process::ExitCode;";

/// A crate with one source file.
#[derive(Clone, Debug)]
pub struct Blueprint {
    /// Name of its folder before the hash: letters, digits and `_`.
    pub name: String,
    /// Dependencies, as lines of `Cargo.toml`.
    pub manifest: String,
    /// `src/main.rs`.
    pub main: String,
    /// The user's file, whose lines are those of `src/main.rs`.
    pub origin: Option<Origin>,
    /// `true` if the blueprint holds all but the sources of `mbs`: the same one always gives the same program.
    pub is_closed: bool,
    /// Parts that the compiler works on at a time, in a program of many texts: it runs for seconds and is compiled for minutes.
    pub units: Option<u32>,
    /// `true` if symbols of the program name types in full, and its scenes are compiled in parts.
    pub is_measured: bool,
}

/// Parts of a program of many texts. Each has a copy of the inlined functions that it calls.
const UNITS: u32 = 4;

/// A study that is built in a program of its own: it has the mechanism in more numbers than `mbs` does.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Suffix of the program's name.
    suffix: &'static str,
    /// Type of all that it needs of the mechanism, a macro that makes this, and the program: in `mbs_workbench`.
    kind: &'static str,
    make: &'static str,
    program: &'static str,
    /// `true` where the program takes the functions of the caller.
    with_laws: bool,
    /// Place that the type's name is taken from, where functions of the caller in `f64` alone are taken in all numbers.
    in_doubles: Option<NameFrom>,
}

/// Place that names the type of a mechanism whose constructor is a path of its card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameFrom {
    /// Module that has the text.
    Text,
    /// Module of the constructor, which may name a type of a private module anew.
    Constructor,
}

impl Study {
    /// That of `mbs cost`.
    pub const COST: Study = Study {
        suffix: "_cost",
        kind: "erased::costs::Comparable",
        make: "comparable",
        program: "cost_program",
        with_laws: true,
        in_doubles: None,
    };
    /// That of `mbs hard-cases`.
    pub const HARD_CASES: Study = Study {
        suffix: "_hard_cases",
        kind: "erased::variations::Variable",
        make: "variable",
        program: "hard_cases_program",
        with_laws: false,
        in_doubles: None,
    };

    /// The study for functions of the caller that exist in `f64` alone.
    pub const fn in_doubles(self, name_from: NameFrom) -> Study {
        Study { in_doubles: Some(name_from), ..self }
    }

    /// The import of the type `own`, a path, beside the names that a card's `constructor` is written with.
    fn import(&self, (constructor, own): (&str, &str)) -> String {
        let path = match self.in_doubles {
            None => None,
            Some(NameFrom::Text) => Some(format!("::{own}")).filter(|_| own.contains("::")),
            Some(NameFrom::Constructor) => module_of(constructor).map(|module| format!("{module}::*")),
        };
        path.map_or_else(String::new, |path| format!("#[allow(unused_imports)]\nuse {path};\n"))
    }

    /// The constants that make the mechanism of `constructor`, of type `own`, and its `functions` of the caller.
    fn item(&self, (constructor, own): (&str, &str), functions: &[FunctionEntry]) -> String {
        let Study { kind, make, .. } = self;
        let laws = if self.with_laws { laws(constructor, functions) } else { String::new() };
        // Functions of an array, `lift[0]` and on, are one argument.
        let name = |function: &FunctionEntry| function.name.split('[').next().unwrap_or_default();
        let mut names: Vec<&str> = functions.iter().map(name).collect();
        names.dedup();
        let own = own.rsplit("::").next().unwrap_or_default();
        let names = match self.in_doubles {
            Some(_) => format!(", {own}, [{}]", names.join(", ")),
            None => String::new(),
        };
        format!(
            "pub const STUDIED: fn(&[(usize, f64)]) -> ::mbs_workbench::{kind} = ::mbs_workbench::{make}!({constructor}{names}); {laws}"
        )
    }

    /// The call of the program, with names in `module` (`module::`).
    fn call(&self, module: &str) -> String {
        let laws = if self.with_laws { format!(", {module}LAWS") } else { String::new() };
        format!("mbs_workbench::{}({module}CARD, {module}STUDIED{laws})", self.program)
    }
}

/// The user's file that a source file was made from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Its path.
    pub path: String,
    /// Its content.
    pub content: String,
    /// A line that has a prefix in the source file, and the prefix's length in characters.
    pub shifted: (usize, usize),
}

impl Blueprint {
    /// `mbs` for the mechanism of a text, whose functions that program takes from its command line.
    pub fn of_text(text: &TextFile) -> Self {
        Self::for_text(text, "", "", |module| format!("mbs_workbench::program(&[{module}::CARD])"))
    }

    /// A study of the mechanism of a text, as [`of_text`](Self::of_text).
    pub fn study_of_text(study: &Study, text: &TextFile) -> Self {
        let own = text.type_name();
        let item = study.item((&constructor_of_text(text), &own), &[]);
        Self::for_text(text, study.suffix, &item, |module| study.call(&format!("{module}::")))
    }

    /// A program for the mechanism of a text; `items` stand beside its card, `body` is that of `main`.
    fn for_text(text: &TextFile, suffix: &str, items: &str, body: impl FnOnce(&str) -> String) -> Self {
        let plain = snake_case(&text.name);
        // Words of Rust name no module.
        let is_word = syn::parse_str::<syn::Ident>(&plain).is_err();
        let module = if is_word { format!("{plain}_") } else { plain };
        let lines = text.source.chars().take_while(|c| *c == '\n').count();
        let (before, source) = text.source.split_at(lines);
        let prefix = format!("mod {module} {{ ::mbs_runtime::mechanism! {{ ");
        let card = format!("::mbs_workbench::card!({})", constructor_of_text(text));
        // The user's lines keep their numbers, so nothing stands above them.
        let main = format!(
            "{before}{prefix}{source}\n}} pub const CARD: ::mbs_workbench::card::Card = {card}; {items} }}\n\n{HEAD}\n\n\
             fn main() -> ExitCode {{\n    {}\n}}\n",
            body(&module)
        );
        let shifted = (lines + 1, prefix.chars().count());
        Blueprint {
            name: format!("{}{suffix}", snake_case(&text.type_name())),
            manifest: dependencies(&[]),
            main,
            origin: Some(Origin { path: text.path.clone(), content: text.content.clone(), shifted }),
            is_closed: true,
            units: None,
            is_measured: false,
        }
    }

    /// A study of many texts in one program: name of each and of its type, and its text. The program takes a list of names, cards and
    /// what the study needs.
    pub fn study_of_texts(study: &Study, name: &str, texts: &[(&str, String, &str)]) -> Self {
        let mut main = format!("{HEAD}\n");
        let mut list = String::new();
        for (module, kind, text) in texts {
            let constructor = format!("{kind}::default()");
            main += &format!(
                "\nmod {module} {{\n::mbs_runtime::mechanism! {{\n{text}\n}}\n\
                 pub const CARD: ::mbs_workbench::card::Card = ::mbs_workbench::card!({constructor});\n{}\n}}\n",
                study.item((&constructor, kind), &[])
            );
            list += &format!("({module:?}, {module}::CARD, {module}::STUDIED), ");
        }
        main += &format!(
            "\nfn main() -> ExitCode {{\n    mbs_workbench::{}_list(&[{list}])\n}}\n",
            study.program
        );
        Blueprint {
            name: format!("{name}{}", study.suffix),
            manifest: dependencies(&[]),
            main,
            origin: None,
            is_closed: true,
            units: Some(UNITS),
            is_measured: false,
        }
    }

    /// A program called `name` on top of the library that declares the mechanism of `card`; `main` makes its source from the
    /// constructor. It is built with what the library is at that time.
    ///
    /// # Errors
    /// [`ForgeError::NoLibrary`] where neither the constructor nor the module of the card begins with a known library. Known are the
    /// card's crate and those that it depends on by path.
    pub fn of_card(
        forge: &Forge,
        card: &Card,
        name: &str,
        main: impl FnOnce(&str) -> String,
    ) -> Result<Self, ForgeError> {
        let Card { constructor, module, manifest, .. } = *card;
        let libraries = libraries(forge, Path::new(manifest))?;
        let named = |path: &str| {
            let first =
                path.trim_start_matches("::").split("::").next().unwrap_or_default().trim().to_string();
            libraries.iter().position(|library| library.name.replace('-', "_") == first)
        };
        // A constructor begins with a library, or it is seen in the module of its card.
        let (library, scope) = match (named(constructor), named(module)) {
            (Some(library), _) => (library, String::new()),
            (None, Some(library)) => (library, format!("#[allow(unused_imports)]\nuse ::{module}::*;\n")),
            (None, None) => return Err(ForgeError::NoLibrary { constructor: constructor.to_string() }),
        };
        let library = libraries.into_iter().nth(library);
        Ok(Blueprint {
            name: name.to_string(),
            manifest: dependencies(library.as_slice()),
            main: scope + &main(constructor),
            origin: None,
            is_closed: false,
            units: None,
            is_measured: false,
        })
    }

    /// A study of the mechanism of `card` with this type, a path, text and these functions of the caller. It is made from the text alone if
    /// the constructor is that of the text's defaults; else on top of the library, which is built anew for it.
    ///
    /// # Errors
    /// As [`of_card`](Self::of_card).
    pub fn study_of_card(
        study: &Study,
        forge: &Forge,
        card: &Card,
        (own, source, functions): (&str, &str, &[FunctionEntry]),
    ) -> Result<Self, ForgeError> {
        let Card { constructor, module, manifest, .. } = *card;
        let name = format!("{}{}", card.file_name(), study.suffix);
        let items = |constructor: &str| {
            format!(
                "pub const CARD: ::mbs_workbench::card::Card = ::mbs_workbench::card::Card {{ constructor: {constructor:?}, \
                 module: {module:?}, manifest: {manifest:?}, ..::mbs_workbench::card!({constructor}) }};\n{}\n",
                study.item((constructor, own), functions)
            )
        };
        let kind = constructor.strip_suffix("::default()").unwrap_or_default();
        if syn::parse_str::<syn::Ident>(kind).is_ok() {
            let main = format!(
                "{HEAD}\n\nmod studied {{\n::mbs_runtime::mechanism! {{\n{source}\n}}\n{}}}\n\n\
                 fn main() -> ExitCode {{\n    {}\n}}\n",
                items(constructor),
                study.call("studied::")
            );
            return Ok(Blueprint {
                name,
                manifest: dependencies(&[]),
                main,
                origin: None,
                is_closed: true,
                units: None,
                is_measured: false,
            });
        }
        Self::of_card(forge, card, &name, |constructor| {
            let (items, call) = (items(constructor), study.call(""));
            let import = study.import((constructor, own));
            format!("{import}{HEAD}\n\n{items}\nfn main() -> ExitCode {{\n    {call}\n}}\n")
        })
    }

    /// A program that measures the scenes called `scenes` of the mechanism called `mechanism` in `text`, for the `round`th time.
    pub fn of_scenes(mechanism: &str, text: &str, scenes: &[String], round: usize) -> Self {
        // A scene may be left without a function that another one calls: all have those of the text.
        let functions = mbs_codegen::outline(text).map_or_else(|_| Vec::new(), |outline| outline.functions);
        let entries: String = scenes
            .iter()
            .map(|scene| {
                let made = constructor(&format!("{mechanism}{scene}"), "", &functions);
                format!(
                    "    ({scene:?}, |values| ::mbs_workbench::erased::scene_runs::scene_runs({made}, values)),\n"
                )
            })
            .collect();
        let main = format!(
            "{HEAD}\n\nmod compared {{\n::mbs_runtime::mechanism! {{\n{text}\n}}\n\n\
             pub const SCENES: &[::mbs_workbench::effects::measurement::NamedScene] = &[\n{entries}];\n}}\n\n\
             fn main() -> ExitCode {{\n    mbs_workbench::effects_program(compared::SCENES)\n}}\n"
        );
        Blueprint {
            name: format!("{}_effects_{round}", snake_case(mechanism)),
            manifest: dependencies(&[]),
            main,
            origin: None,
            is_closed: true,
            units: None,
            is_measured: true,
        }
    }

    /// The same program with a feature of the runtime.
    pub fn with_feature(mut self, feature: &str) -> Self {
        self.manifest =
            self.manifest.replacen("features = []", &format!("features = [{}]", quoted(feature)), 1);
        self.name = format!("{}_{feature}", self.name);
        self
    }

    /// `Cargo.toml` of the crate called `package`.
    pub(super) fn manifest(&self, package: &str) -> String {
        let units = self.units.map_or_else(String::new, |units| {
            format!(
                "\n[profile.release.package.{}]\ncodegen-units = {units}\nopt-level = 1\n",
                quoted(package)
            )
        });
        format!(
            "# Written by `mbs`, which deletes it again.\n[package]\nname = {}\nversion = \"0.0.0\"\nedition = \"2024\"\npublish = false\n\n\
             [dependencies]\n{}\n[workspace]\n{units}",
            quoted(package),
            self.manifest
        )
    }
}

/// The module of the function or type that the expression `constructor` calls; none where it names no module.
fn module_of(constructor: &str) -> Option<String> {
    let called = match syn::parse_str::<syn::Expr>(constructor).ok()? {
        syn::Expr::Call(call) => *call.func,
        named => named,
    };
    let syn::Expr::Path(path) = called else { return None };
    let names: Vec<String> = path.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
    // A type is no module: `my_crate::Wiper::new`.
    let is_module = |name: &&String| !name.starts_with(char::is_uppercase);
    let modules: Vec<&str> =
        names.iter().take(names.len().saturating_sub(1)).take_while(is_module).map(String::as_str).collect();
    let root = if path.path.leading_colon.is_some() { "::" } else { "" };
    (!modules.is_empty()).then(|| root.to_string() + &modules.join("::"))
}

/// The call that makes the mechanism of a text, with the functions that it declares from the program's command line.
fn constructor_of_text(text: &TextFile) -> String {
    // Of the type in all scenes the last parameter is the scene: its default holds where others are given.
    let mut types: Vec<&str> = Vec::new();
    if text.is_whole {
        let mut arrays: Vec<&str> = text.functions.iter().map(|function| array(&function.name)).collect();
        arrays.dedup();
        types.extend(arrays.iter().map(|_| "_").chain(["f64"]));
    }
    let types = if types.is_empty() { String::new() } else { format!("::<{}>", types.join(", ")) };
    constructor(&text.type_name(), &types, &text.functions)
}

/// The name of an array of functions without the number; that of a function alone as it is.
fn array(name: &str) -> &str {
    name.split('[').next().unwrap_or_default()
}

/// The call that makes the mechanism of type `own` with these arguments, `types`.
fn constructor(own: &str, types: &str, functions: &[DeclaredFunction]) -> String {
    let mut arguments: Vec<(&str, Vec<String>)> = Vec::new();
    for function in functions {
        let DeclaredFunction { name, unit, argument_unit, continuity, period } = function;
        let period = period.map_or_else(|| "None".to_string(), |period| format!("Some({period:?})"));
        let call = format!(
            "::mbs_workbench::given_function(({name:?}, {unit:?}, {argument_unit:?}, {continuity}, {period}))"
        );
        match arguments.last_mut().filter(|(known, _)| *known == array(name)) {
            Some((_, calls)) => calls.push(call),
            None => arguments.push((array(name), vec![call])),
        }
    }
    let is_array = |name: &str| functions.iter().all(|function| function.name != name);
    let argument = |(name, calls): &(&str, Vec<String>)| match is_array(name) {
        true => format!("[{}]", calls.join(", ")),
        false => calls.concat(),
    };
    match arguments.is_empty() {
        true => format!("{own}{types}::default()"),
        false => {
            format!("{own}{types}::new({})", arguments.iter().map(argument).collect::<Vec<_>>().join(", "))
        }
    }
}

/// The functions of the caller that have two derivatives, by their names: an item of Rust.
fn laws(constructor: &str, functions: &[FunctionEntry]) -> String {
    let law = |function: &FunctionEntry| {
        let name = function.name;
        format!(
            "({name:?}, {{ let mechanism = ::mbs_workbench::tables::valley::in_doubles({constructor}); \
             ::std::boxed::Box::new(move |x: f64| ::mbs_runtime::Function::jet::<3>(&mechanism.{name}, x)) as _ }}), "
        )
    };
    let laws: String = functions.iter().filter(|function| function.continuity >= 2).map(law).collect();
    format!(
        "pub const LAWS: fn() -> ::std::vec::Vec<::mbs_workbench::tables::valley::NamedLaw> = || ::std::vec![{laws}];\n"
    )
}

/// A library that a crate depends on by path.
struct Library {
    /// Name in the dependent crate.
    name: String,
    /// Name of its package.
    package: String,
    /// Its folder.
    path: String,
}

fn libraries(forge: &Forge, manifest: &Path) -> Result<Vec<Library>, ForgeError> {
    let mut command = Command::new(&forge.cargo);
    command.args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"]);
    let manifest = manifest.join("Cargo.toml");
    let output = command.arg(&manifest).output().map_err(|error| not_started(&forge.cargo, &error))?;
    if !output.status.success() {
        return Err(ForgeError::Cargo(String::from_utf8_lossy(&output.stderr).trim().to_string()));
    }
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| ForgeError::Cargo(format!("`cargo metadata` printed no JSON: {error}")))?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let own: Vec<&serde_json::Value> = packages
        .filter(|package| {
            let path = package["manifest_path"].as_str().map(Path::new);
            path.is_some_and(|path| {
                path == manifest || path.canonicalize().ok() == manifest.canonicalize().ok()
            })
        })
        .collect();
    let dependencies = own.iter().filter_map(|package| package["dependencies"].as_array()).flatten();
    let library = |dependency: &serde_json::Value| {
        let package = dependency["name"].as_str()?.to_string();
        let name = dependency["rename"].as_str().map_or_else(|| package.clone(), str::to_string);
        Some(Library { name, package, path: dependency["path"].as_str()?.to_string() })
    };
    let itself = own.iter().filter_map(|package| {
        let targets = package["targets"].as_array().into_iter().flatten();
        let is_library = |target: &&serde_json::Value| {
            let kinds = target["kind"].as_array().into_iter().flatten();
            kinds.filter_map(serde_json::Value::as_str).any(|kind| matches!(kind, "lib" | "rlib"))
        };
        let name = targets.filter(is_library).find_map(|target| target["name"].as_str())?.to_string();
        let path = manifest.parent()?.display().to_string();
        Some(Library { name, package: package["name"].as_str()?.to_string(), path })
    });
    Ok(itself.chain(dependencies.filter_map(library)).collect())
}

/// The runtime, the program and libraries, as a program of the same sources has them.
fn dependencies(libraries: &[Library]) -> String {
    let path = |name: &str| quoted(&sources::folder().join(name).display().to_string());
    let mut lines = format!(
        "mbs-runtime = {{ path = {}, default-features = false, features = [] }}\nmbs-workbench = {{ path = {} }}\n",
        path("mbs-runtime"),
        path("mbs-workbench")
    );
    for Library { name, package, path } in libraries {
        lines += &format!("{name} = {{ package = {}, path = {} }}\n", quoted(package), quoted(path));
    }
    lines
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

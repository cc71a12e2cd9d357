//! `mbs new`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CommandError;
use super::chosen::write_file;
use super::document::Output;

/// Files of a new crate, with the text that each is made from.
const FILES: [(&str, &str); 7] = [
    ("Cargo.toml", include_str!("../../template/library.toml")),
    ("src/lib.rs", include_str!("../../template/library.rs")),
    ("examples/control_loop.rs", include_str!("../../template/control_loop.rs")),
    ("tests/derivatives.rs", include_str!("../../template/derivatives.rs")),
    ("mbs/Cargo.toml", include_str!("../../template/program.toml")),
    ("mbs/src/main.rs", include_str!("../../template/program.rs")),
    (".gitignore", "/target\n"),
];

/// Names of crates that the new one would hide.
const TAKEN: [&str; 10] = [
    "alloc",
    "core",
    "mbs",
    "mbs_codegen",
    "mbs_macros",
    "mbs_runtime",
    "mbs_workbench",
    "proc_macro",
    "std",
    "test",
];

/// Names that some systems keep for devices.
const DEVICES: [&str; 4] = ["aux", "con", "nul", "prn"];

#[derive(Args)]
pub struct Arguments {
    /// Name of the new crate and its folder: small letters, digits, `-` and `_`
    name: String,
    /// Repository that the crate takes `mbs` from [default: the folder that this program was built from]
    #[arg(long, value_name = "URL")]
    git: Option<String>,
}

/// Names that follow from that of the crate.
struct Names {
    package: String,
    /// Name in Rust.
    library: String,
    /// Name of the mechanism.
    mechanism: String,
    /// Heading.
    title: String,
}

/// Writes a library with a text, its program, a test and an example.
pub fn run(arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let names = Names::of(&arguments.name)?;
    let folder = Path::new(&names.package);
    if folder.symlink_metadata().is_ok() {
        return Err(CommandError::Usage(format!(
            "{0} exists already; choose another name, or remove it\nmore mechanisms in one crate: a second `mechanism!` in \
             its library, and a second card in {0}/mbs/src/main.rs",
            names.package
        )));
    }
    let source = Source::of(arguments.git.as_deref())?;
    let draft = PathBuf::from(format!("{}.{}.draft", names.package, std::process::id()));
    let written = FILES.iter().try_for_each(|(path, text)| {
        let text = source.filled(&names.filled(text));
        write_file(&draft.join(path), &text)
    });
    let written = written.and_then(|()| match source.lock_file() {
        Some(lock_file) => write_file(&draft.join("Cargo.lock"), &lock_file),
        None => Ok(()),
    });
    let placed = written.and_then(|()| {
        fs::rename(&draft, folder)
            .map_err(|error| CommandError::Failed(format!("cannot write {}: {error}", names.package)))
    });
    if placed.is_err() {
        drop(fs::remove_dir_all(&draft));
    }
    placed?;
    out.put("crate", &names.package);
    for (path, _) in FILES {
        out.put_file("source", &folder.join(path));
    }
    writeln!(out, "{}: a mechanism to begin from", names.package)?;
    for (path, content) in [
        ("src/lib.rs", "its text, in a library without std"),
        ("mbs/src/main.rs", "the program `mbs` for it"),
        ("tests/derivatives.rs", "the cross-check with CasADi and 50 digits"),
        ("examples/control_loop.rs", "a measured angle, steps of bounded work"),
    ] {
        writeln!(out, "  {path:<26}  {content}")?;
    }
    writeln!(out, "\ncd {}", names.package)?;
    for (command, result) in [
        ("cargo run", "a page with its motion"),
        ("cargo run -- list", "its name; `cargo run -- --help` lists all commands"),
        ("cargo test", "the cross-check; needs Python 3"),
    ] {
        writeln!(out, "{command:<28}  {result}")?;
    }
    Ok(())
}

impl Names {
    /// Names that follow from `name`.
    fn of(name: &str) -> Result<Self, CommandError> {
        let library = name.replace('-', "_");
        let fault = Self::fault(name, &library);
        if let Some(reason) = fault {
            let proposal = proposal(name);
            return Err(CommandError::Usage(format!(
                "`{name}` cannot name a crate: {reason}; for example `mbs new {proposal}`"
            )));
        }
        let words: Vec<&str> = library.split('_').filter(|word| !word.is_empty()).collect();
        let mechanism: String = words.iter().map(|word| capitalized(word)).collect();
        let title = capitalized(&words.join(" "));
        Ok(Names { package: name.to_string(), library, mechanism, title })
    }

    fn fault(name: &str, library: &str) -> Option<&'static str> {
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            Some("it begins with a small letter")
        } else if !name.chars().all(allowed) {
            Some("it has small letters, digits, `-` and `_`")
        } else if name.len() > 64 {
            Some("it has 64 characters at most")
        } else if name.len() == 1 {
            Some("its mechanism would be called by one letter, as the types of Rust's generic code are")
        } else if syn::parse_str::<syn::Ident>(library).is_err() || library == "gen" {
            Some("it is a word of Rust")
        } else if TAKEN.contains(&library) {
            Some("a crate that it needs has this name")
        } else if DEVICES.contains(&name) {
            Some("some systems keep it for a device")
        } else {
            None
        }
    }

    fn filled(&self, text: &str) -> String {
        text.replace("__NAME__", &self.package)
            .replace("__CRATE__", &self.library)
            .replace("__TYPE__", &self.mechanism)
            .replace("__TITLE__", &self.title)
    }
}

/// A name that is allowed and like `name`.
fn proposal(name: &str) -> String {
    let mut found = String::new();
    let mut before_lower = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && before_lower {
            found.push('-');
        }
        before_lower = c.is_ascii_lowercase();
        match c.to_ascii_lowercase() {
            c if c.is_ascii_lowercase() || (c.is_ascii_digit() && !found.is_empty()) => found.push(c),
            _ if found.ends_with('-') || found.is_empty() => {}
            _ => found.push('-'),
        }
    }
    let found: String = found.trim_end_matches('-').chars().take(64).collect();
    match Names::fault(&found, &found.replace('-', "_")) {
        None => found,
        Some(_) => format!("my-{}", if found.is_empty() || found.len() > 60 { "linkage" } else { &found }),
    }
}

fn capitalized(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Place that the new crate takes `mbs` from.
enum Source {
    /// A folder on this machine.
    Folder(PathBuf),
    /// A repository.
    Repository(String),
}

impl Source {
    fn of(git: Option<&str>) -> Result<Self, CommandError> {
        if let Some(url) = git {
            return Ok(Source::Repository(url.to_string()));
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        match folder.canonicalize() {
            Ok(folder) if folder.join("mbs-runtime/Cargo.toml").is_file() => Ok(Source::Folder(folder)),
            _ => Err(CommandError::Usage(format!(
                "the sources that `mbs` was built from are no longer in {}\n\
                 name a repository: `mbs new NAME --git URL`, or install `mbs` again from where they are",
                Path::new(env!("CARGO_MANIFEST_DIR")).display()
            ))),
        }
    }

    /// Fills in the dependencies on `mbs`.
    fn filled(&self, text: &str) -> String {
        let of = |name: &str| {
            let string = |text: &str| serde_json::Value::from(text).to_string();
            match self {
                Source::Folder(folder) => {
                    format!("path = {}", string(&folder.join(name).display().to_string().replace('\\', "/")))
                }
                Source::Repository(url) => format!("git = {}", string(url)),
            }
        };
        text.replace("__RUNTIME__", &of("mbs-runtime")).replace("__WORKBENCH__", &of("mbs-workbench"))
    }

    /// Versions of all dependencies as `mbs` has them: tested together, and on this machine already.
    fn lock_file(&self) -> Option<String> {
        match self {
            Source::Folder(folder) => fs::read_to_string(folder.join("Cargo.lock")).ok(),
            Source::Repository(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_crate_give_those_of_its_parts() {
        let names = Names::of("roof-wiper_2").expect("a name");
        assert_eq!(
            (names.library.as_str(), names.mechanism.as_str(), names.title.as_str()),
            ("roof_wiper_2", "RoofWiper2", "Roof wiper 2")
        );
    }

    #[test]
    fn bad_names_are_refused_with_one_that_is_good() {
        for (bad, good) in [
            ("Wiper", "wiper"),
            ("RoofWiper", "roof-wiper"),
            ("2wiper", "wiper"),
            ("wiper linkage", "wiper-linkage"),
            ("../wiper", "wiper"),
            ("wiper/", "wiper"),
            ("", "my-linkage"),
            ("t", "my-t"),
            ("fn", "my-fn"),
            ("self", "my-self"),
            ("gen", "my-gen"),
            ("core", "my-core"),
            ("mbs-runtime", "my-mbs-runtime"),
            ("con", "my-con"),
            ("größe", "gr-e"),
            ("-", "my-linkage"),
        ] {
            let error = Names::of(bad).err().expect(bad);
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().ends_with(&format!("for example `mbs new {good}`")), "{error}");
            assert!(Names::of(good).is_ok(), "{good}");
        }
        assert!(Names::of(&"a".repeat(65)).is_err());
    }

    #[test]
    fn no_name_is_left_open_in_any_file() {
        let names = Names::of("wiper").expect("a name");
        for source in
            [Source::Folder("/a b/\"c\"".into()), Source::Repository("https://example.org/mbs".into())]
        {
            for (path, text) in FILES {
                let text = source.filled(&names.filled(text));
                assert!(!text.contains("__"), "{path}: {text}");
            }
        }
    }
}

//! Mechanisms in files: a Rust source with `mechanism!` in it, or the bare text in a `.mbs` file.

mod argument;
pub mod excerpt;

use core::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

pub use self::argument::{Argument, is_file};
use mbs_codegen::{Call, DeclaredFunction, Fault, Outline, WHOLE};

use crate::hash::hash_of_text;
use crate::mismatch::nearest;

/// A mechanism's text in a file, without faults, in a scene.
#[derive(Clone, Debug)]
pub struct TextFile {
    /// Path of the file, as the command line names it.
    pub path: String,
    /// The whole file.
    pub content: String,
    /// The text, at its own lines and columns of the file.
    pub source: String,
    /// Name of the mechanism.
    pub name: String,
    /// Name of the scene; `None` for the whole text.
    pub scene: Option<String>,
    /// `true` for the whole of a text that declares scenes.
    pub is_whole: bool,
    /// Functions that the caller gives.
    pub functions: Vec<DeclaredFunction>,
}

/// Reason why there is no text, with the cure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextFileError {
    /// The file cannot be read.
    Unreadable {
        /// The file.
        path: String,
        /// Message of the operating system.
        reason: String,
    },
    /// Neither a Rust source nor a bare text.
    Suffix {
        /// The file.
        path: String,
    },
    /// No call of `mechanism!` in a Rust source.
    Empty {
        /// The file.
        path: String,
    },
    /// Several mechanisms or scenes, and the command line names none of them.
    Several {
        /// Argument of the command line.
        argument: String,
        /// Arguments that name one.
        known: Vec<String>,
    },
    /// No mechanism or scene of this name.
    Unknown {
        /// Argument of the command line.
        argument: String,
        /// Arguments that name one.
        known: Vec<String>,
    },
    /// Several mechanisms of one name.
    Repeated {
        /// The file.
        path: String,
        /// The name.
        name: String,
        /// Lines of the calls.
        lines: Vec<usize>,
    },
    /// Faults of the text, as the macro reports them.
    Faults(String),
}

impl TextFile {
    /// The text that `argument` names: `FILE`, `FILE:Name` or `FILE:Name:Scene`.
    ///
    /// # Errors
    /// [`TextFileError`], faults of the text with their lines in the file.
    pub fn read(argument: &str) -> Result<Self, TextFileError> {
        let asked = Argument::of(argument);
        let path = asked.path.to_string();
        let unreadable = |error: std::io::Error| TextFileError::Unreadable {
            path: path.clone(),
            reason: reason(&path, &error),
        };
        let content = fs::read_to_string(&path).map_err(unreadable)?;
        let calls = calls(&path, &content)?;
        let call = choose(&asked, &calls)?;
        let outline = outlined(&path, &content, call)?;
        if asked.name.is_some_and(|name| name != outline.name) {
            return Err(asked.unknown(&calls));
        }
        let scene = match (asked.scene, outline.scenes.as_slice()) {
            (None, []) => None,
            (None, [only]) => Some(only.clone()),
            (None, _) => {
                let known = arguments(&path, call, calls.len() > 1);
                return Err(TextFileError::Several { argument: argument.to_string(), known });
            }
            (Some(scene), known) if known.iter().any(|name| name == scene) => Some(scene.to_string()),
            (Some(WHOLE), _) if outline.has_whole => None,
            (Some(_), _) => return Err(asked.unknown(&calls)),
        };
        let is_whole = scene.is_none() && outline.has_whole;
        let Outline { name, functions, .. } = outline;
        Ok(TextFile { source: call.source.clone(), path, content, name, scene, is_whole, functions })
    }

    /// Name of the emitted type in the scene.
    pub fn type_name(&self) -> String {
        format!("{}{}", self.name, self.scene.as_deref().unwrap_or_default())
    }
}

/// Faults and warnings of the texts in a file.
pub struct Checked {
    /// Hashes of the texts.
    pub texts: Vec<String>,
    /// Faults of all texts.
    pub faults: Vec<Fault>,
    /// Warnings about texts without faults.
    pub warnings: Vec<Fault>,
    path: String,
    content: String,
}

impl Checked {
    /// The faults as a compiler shows them; `None` where there are none.
    pub fn error(&self) -> Option<TextFileError> {
        let Checked { path, content, faults, .. } = self;
        (!faults.is_empty()).then(|| TextFileError::Faults(excerpt::faults(path, content, faults)))
    }

    /// The warnings as a compiler shows them.
    pub fn shown_warnings(&self) -> Vec<String> {
        excerpt::warnings(&self.path, &self.content, &self.warnings)
    }
}

/// Faults and warnings of the texts in the file of an argument.
///
/// # Errors
/// As [`TextFile::read`], where there are no texts.
pub fn checked(argument: &str) -> Result<Checked, TextFileError> {
    let (path, content, calls) = texts(argument)?;
    let (mut faults, mut warnings) = (Vec::new(), Vec::new());
    for call in &calls {
        match mbs_codegen::warnings(&call.source) {
            Ok(found) => warnings.extend(found),
            Err(found) => faults.extend(found),
        }
    }
    for (index, call) in calls.iter().enumerate() {
        let same = |other: &&Call| other.name.is_some() && other.name == call.name;
        if let Some(first) = calls[..index].iter().find(same) {
            warnings.push(repeated(call, first.line));
        }
    }
    let texts = calls.iter().map(|call| hash_of_text(&call.source)).collect();
    Ok(Checked { texts, faults, warnings, path, content })
}

/// Warning about a second text of one name.
fn repeated(call: &Call, first: usize) -> Fault {
    let name = call.name.clone().unwrap_or_default();
    let header = format!("mechanism {name}");
    let mut lines = call.source.lines().enumerate().skip(call.line.saturating_sub(1));
    let found = lines.find_map(|(index, text)| {
        let before = text.find(&header)? + header.len() - name.len();
        Some((index + 1, text[..before].chars().count()))
    });
    let (line, before) = found.unwrap_or((call.line, 0));
    Fault {
        line,
        column: before + 1,
        end_line: line,
        end_column: before + 1 + name.chars().count(),
        message: format!("`{name}` is the name of the mechanism in line {first} as well"),
        help: "give each a name of its own, or put one into a module".to_string(),
    }
}

/// A mechanism or scene in a file.
pub struct Listed {
    /// Argument of the command line that names it.
    pub argument: String,
    /// Title of its picture.
    pub title: String,
    /// Its parameters and inputs.
    pub variables: Vec<mbs_codegen::Variable>,
    /// Hash of its text.
    pub hash: String,
}

/// All mechanisms and scenes in the file of an argument.
///
/// # Errors
/// As [`TextFile::read`].
pub fn listed(argument: &str) -> Result<Vec<Listed>, TextFileError> {
    let (path, content, calls) = texts(argument)?;
    let mut found = Vec::new();
    for call in &calls {
        let outline = outlined(&path, &content, call)?;
        let mut scenes: Vec<Option<&str>> = outline.scenes.iter().map(|scene| Some(scene.as_str())).collect();
        if scenes.is_empty() || outline.has_whole {
            scenes.push(None);
        }
        for (argument, scene) in arguments(&path, call, calls.len() > 1).into_iter().zip(scenes) {
            let title = mbs_codegen::picture(&call.source, scene).map(|picture| picture.title);
            let variables = mbs_codegen::variables(&call.source, scene);
            found.push(Listed {
                argument,
                title: title.map_err(TextFileError::Faults)?,
                variables: variables.map_err(TextFileError::Faults)?,
                hash: hash_of_text(&call.source),
            });
        }
    }
    Ok(found)
}

/// Path, content and texts of the file of an argument.
fn texts(argument: &str) -> Result<(String, String, Vec<Call>), TextFileError> {
    let path = Argument::of(argument).path.to_string();
    let content = fs::read_to_string(&path)
        .map_err(|error| TextFileError::Unreadable { path: path.clone(), reason: reason(&path, &error) })?;
    let calls = calls(&path, &content)?;
    Ok((path, content, calls))
}

/// Message of the operating system, with a text of nearly this name where there is no such file.
fn reason(path: &str, error: &std::io::Error) -> String {
    let near = || {
        let asked = Path::new(path);
        let folder = asked.parent().filter(|folder| !folder.as_os_str().is_empty());
        let files = fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
        let names = files.filter_map(|file| file.ok()?.file_name().into_string().ok());
        let texts: Vec<String> =
            names.filter(|name| name.ends_with(".mbs") || name.ends_with(".rs")).collect();
        let name = nearest(asked.file_name()?.to_str()?, texts.iter().map(String::as_str))?;
        Some(asked.with_file_name(name).display().to_string())
    };
    match near().filter(|_| error.kind() == ErrorKind::NotFound) {
        Some(near) => format!("{error}; did you mean `{near}`?"),
        None => error.to_string(),
    }
}

fn calls(path: &str, content: &str) -> Result<Vec<Call>, TextFileError> {
    if path.ends_with(".mbs") {
        return Ok(vec![Call { name: None, source: content.to_string(), line: 1, place: 0..content.len() }]);
    }
    if !path.ends_with(".rs") {
        return Err(TextFileError::Suffix { path: path.to_string() });
    }
    let calls = mbs_codegen::calls(content)
        .map_err(|fault| TextFileError::Faults(excerpt::faults(path, content, &[fault])))?;
    if calls.is_empty() { Err(TextFileError::Empty { path: path.to_string() }) } else { Ok(calls) }
}

fn choose<'a>(asked: &Argument, calls: &'a [Call]) -> Result<&'a Call, TextFileError> {
    let wanted = |call: &&Call| match (asked.name, &call.name) {
        (Some(asked), Some(name)) => asked == name,
        _ => true,
    };
    let found: Vec<&Call> = calls.iter().filter(wanted).collect();
    match (found.as_slice(), asked.name) {
        ([only], _) => Ok(only),
        ([], _) => Err(asked.unknown(calls)),
        (_, None) => Err(TextFileError::Several {
            argument: asked.path.to_string(),
            known: calls.iter().flat_map(|call| arguments(asked.path, call, true)).collect(),
        }),
        (several, Some(name)) => Err(TextFileError::Repeated {
            path: asked.path.to_string(),
            name: name.to_string(),
            lines: several.iter().map(|call| call.line).collect(),
        }),
    }
}

fn outlined(path: &str, content: &str, call: &Call) -> Result<Outline, TextFileError> {
    mbs_codegen::outline(&call.source)
        .map_err(|faults| TextFileError::Faults(excerpt::faults(path, content, &faults)))
}

/// Arguments that name the scenes of a call; of a text with faults its name alone.
fn arguments(path: &str, call: &Call, several: bool) -> Vec<String> {
    let outline = mbs_codegen::outline(&call.source).ok();
    let name = outline.as_ref().map(|outline| outline.name.clone()).or_else(|| call.name.clone());
    let named = format!("{path}:{}", name.unwrap_or_default());
    match outline {
        Some(outline) if !outline.scenes.is_empty() => {
            let whole = outline.has_whole.then_some(WHOLE);
            let scenes = outline.scenes.iter().map(String::as_str).chain(whole);
            scenes.map(|scene| format!("{named}:{scene}")).collect()
        }
        Some(_) if !several => vec![path.to_string()],
        _ => vec![named],
    }
}

impl Argument<'_> {
    fn unknown(&self, calls: &[Call]) -> TextFileError {
        let of = |call: &Call| arguments(self.path, call, calls.len() > 1);
        TextFileError::Unknown { argument: self.to_string(), known: calls.iter().flat_map(of).collect() }
    }
}

impl TextFileError {
    /// `true` where the command line is at fault, not the text.
    pub fn is_usage(&self) -> bool {
        !matches!(self, TextFileError::Faults(_))
    }
}

impl fmt::Display for TextFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |names: &[String]| names.iter().map(|name| format!("\n  {name}")).collect::<String>();
        match self {
            TextFileError::Unreadable { path, reason } => write!(
                f,
                "cannot read {path}: {reason}\nan argument with `/` or `.` is a file; `mbs list` prints the names of mechanisms"
            ),
            TextFileError::Suffix { path } => write!(
                f,
                "{path} is neither a Rust source (`.rs`, with `mechanism!` in it) nor the bare text of a mechanism (`.mbs`)"
            ),
            TextFileError::Empty { path } => write!(
                f,
                "{path} has no `mechanism!`\nput the text into `mbs_runtime::mechanism! {{ … }}`, or alone into a `.mbs` file"
            ),
            TextFileError::Several { argument, known } => {
                write!(f, "{argument} has several mechanisms or scenes; name one:{}", list(known))
            }
            TextFileError::Unknown { argument, known } => {
                write!(f, "there is no {argument}; known:{}", list(known))
            }
            TextFileError::Repeated { path, name, lines } => {
                let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
                write!(
                    f,
                    "{path} has several mechanisms called `{name}` (lines {}); give each a name of its own",
                    lines.join(", ")
                )
            }
            TextFileError::Faults(text) => f.write_str(text),
        }
    }
}

impl core::error::Error for TextFileError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target_directory::target_directory;

    const CRANK: &str =
        "coord phi: rad;\n    drive motor: phi == 1rad/1s*t;\n    out A: [m; 2] = 1m*unit(phi);";

    fn file(name: &str, content: &str) -> String {
        let folder = target_directory().join("tmp").join("text_file");
        fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join(name);
        fs::write(&path, content).expect("a file");
        path.display().to_string()
    }

    #[test]
    fn a_bare_text_is_one_mechanism() {
        let path = file("bare.mbs", &format!("// A crank.\npub mechanism Crank;\n{CRANK} // end"));
        let text = TextFile::read(&path).expect("a text");
        assert_eq!((text.name.as_str(), text.scene.as_deref()), ("Crank", None));
        assert!(TextFile::read(&format!("{path}:Crank")).is_ok());
        let error = TextFile::read(&format!("{path}:Rod")).expect_err("another name");
        assert_eq!(error, TextFileError::Unknown { argument: format!("{path}:Rod"), known: vec![path] });
    }

    #[test]
    fn mechanisms_and_scenes_of_a_source_are_chosen_by_name() {
        let source = format!(
            "//! Two.\nuse mbs_runtime::mechanism;\nmechanism! {{ pub mechanism One; {CRANK} }}\nmod inner {{\n  \
             mbs_runtime::mechanism! {{\n    mechanism Two;\n    coord phi: rad;\n    effect slow {{ drive m: phi == 1rad/1s*t; }}\n    \
             effect fast {{ drive m: phi == 9rad/1s*t; }}\n    scene Slow = slow;\n    scene Fast = fast;\n  }}\n}}\n"
        );
        let path = file("two.rs", &source);
        // Both drives at once contradict each other: `AllEffects` is no mechanism.
        let known = ["One", "Two:Slow", "Two:Fast"].map(|name| format!("{path}:{name}")).to_vec();
        let several = TextFileError::Several { argument: path.clone(), known: known.clone() };
        assert_eq!(TextFile::read(&path).expect_err("two"), several);
        let unknown = |argument: String| TextFileError::Unknown { argument, known: known.clone() };
        for wrong in ["Three", "One:Slow", "Two:Slower", "Two:AllEffects", "One:AllEffects"]
            .map(|name| format!("{path}:{name}"))
        {
            assert_eq!(TextFile::read(&wrong).expect_err("unknown"), unknown(wrong));
        }
        let text = TextFile::read(&known[2]).expect("a scene");
        assert_eq!((text.type_name().as_str(), text.scene.as_deref()), ("TwoFast", Some("Fast")));
        let scenes = TextFile::read(&format!("{path}:Two")).expect_err("two scenes").to_string();
        assert!(scenes.ends_with(&format!("name one:\n  {}\n  {}", known[1], known[2])), "{scenes}");
    }

    #[test]
    fn all_effects_of_a_text_with_scenes_are_a_scene_where_they_are_a_mechanism() {
        let source = "pub mechanism Arm; coord phi: rad; body arm { mass: 1kg, com: [0, 0], inertia: 1, angle: phi } start phi = 0; \
                      effect fan { torque fan: -der(phi)*1 [N*m*s] on phi; } effect push { torque push: 1 [N*m] on phi; } \
                      scene Still = fan;";
        let path = file("arm.mbs", source);
        let known: Vec<String> =
            listed(&path).expect("a text").into_iter().map(|listed| listed.argument).collect();
        assert_eq!(known, ["Still", "AllEffects"].map(|scene| format!("{path}:Arm:{scene}")));
        let only = TextFile::read(&path).expect("a scene");
        assert_eq!(
            (only.type_name().as_str(), only.scene.as_deref(), only.is_whole),
            ("ArmStill", Some("Still"), false)
        );
        let whole = TextFile::read(&known[1]).expect("all effects");
        assert_eq!((whole.type_name().as_str(), whole.scene, whole.is_whole), ("Arm", None, true));
    }

    #[test]
    fn a_fault_is_shown_at_its_line_of_the_file() {
        let source = format!(
            "fn before() {{}}\n\n\tmbs_runtime::mechanism! {{\n\tpub mechanism Crank;\n\tparam L: m = 1kg; {CRANK}\n}}"
        );
        let path = file("faulty.rs", &source);
        let error = TextFile::read(&path).expect_err("a unit");
        assert!(!error.is_usage());
        let text = error.to_string();
        assert!(text.contains(&format!("  --> {path}:5:11\n")), "{text}");
        assert!(
            text.contains("\n5 | \tparam L: m = 1kg; coord") && text.contains("\n  | \t         ^\n"),
            "{text}"
        );
    }

    #[test]
    fn files_that_are_no_texts_are_refused_with_a_cure() {
        for (path, cure) in [
            (file("none.rs", "fn f() {}"), "put the text into"),
            (file("note.txt", ""), "neither a Rust source"),
            (file("macro.rs", "macro_rules! m { ($t:tt) => { mechanism! { $t } } }"), "put the text into"),
            ("missing/file.mbs".to_string(), "cannot read"),
        ] {
            let error = TextFile::read(&path).expect_err("no text");
            assert!(error.is_usage() && error.to_string().contains(cure), "{error}");
        }
        let twice = "mechanism! { pub mechanism A; coord x: m; drive d: x == 1 [m/s]*t; }\n";
        let twice = checked(&file("twice.rs", &twice.repeat(2))).expect("two texts");
        assert_eq!((twice.texts.len(), twice.faults.len(), twice.warnings.len()), (2, 0, 1));
        let Fault { line, column, message, .. } = &twice.warnings[0];
        assert_eq!(
            (*line, *column, message.as_str()),
            (2, 28, "`A` is the name of the mechanism in line 1 as well")
        );
        let tick =
            file("tick.rs", "fn f() {}\nmechanism! {\n    pub mechanism A;\n    out w: 1/s = phi';\n}");
        let error = checked(&tick).err().expect("a tick").to_string();
        assert!(error.contains("tick.rs:4:21") && error.contains("write a rate as `der(phi)`"), "{error}");
        let open = file("open.rs", "fn f() {\n    (\n}");
        let error = TextFile::read(&open).expect_err("a bracket");
        assert!(error.to_string().contains("close every bracket"), "{error}");
    }

    #[test]
    fn names_of_feet_are_no_unused_ones() {
        let feet = "mechanism Rim; function x: [m; 2](rad), C4, periodic TAU; coord h: m = 1; param none: 1 = 1; \
            curve rim = parametric x[0], x[1] about [0m, 0m]; curve pad = parametric x[1], x[0] about [0m, h]; \
            foot r of pad at v on rim within 1m; constraint meets { r_gap == 0m; } out there: [m; 2] = v_place;";
        let found = checked(&file("feet.mbs", feet)).expect("a text");
        let messages: Vec<&str> = found.warnings.iter().map(|warning| warning.message.as_str()).collect();
        assert_eq!(messages, ["parameter `none` is used nowhere"], "{:?}", found.faults);
    }
}

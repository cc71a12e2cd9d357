//! An argument of the command line that names a text in a file.

use core::fmt;

/// `FILE`, `FILE:Name` or `FILE:Name:Scene`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Argument<'a> {
    /// Path of the file.
    pub path: &'a str,
    /// Name of the mechanism.
    pub name: Option<&'a str>,
    /// Name of the scene.
    pub scene: Option<&'a str>,
}

/// `true` where the argument names a file: names of mechanisms have neither a separator of folders nor a suffix.
pub fn is_file(argument: &str) -> bool {
    argument.contains(['/', '\\', '.'])
}

impl<'a> Argument<'a> {
    /// Parts of `argument`; colons that do not stand before a name belong to the path.
    pub fn of(argument: &'a str) -> Self {
        let split = |text: &'a str| match text.rsplit_once(':') {
            Some((before, name)) if is_file(before) && is_name(name) => (before, Some(name)),
            _ => (text, None),
        };
        match split(argument) {
            (path, None) => Argument { path, name: None, scene: None },
            (before, Some(last)) => match split(before) {
                (path, None) => Argument { path, name: Some(last), scene: None },
                (path, name) => Argument { path, name, scene: Some(last) },
            },
        }
    }
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

impl fmt::Display for Argument<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.path)?;
        [self.name, self.scene].into_iter().flatten().try_for_each(|name| write!(f, ":{name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_behind_colons_of_files_alone() {
        for (argument, path, name, scene) in [
            ("wiper.mbs", "wiper.mbs", None, None),
            ("src/lib.rs:Wiper", "src/lib.rs", Some("Wiper"), None),
            ("./a:b/lib.rs:Wiper:Slow", "./a:b/lib.rs", Some("Wiper"), Some("Slow")),
            (r"C:\texts\lib.rs:Wiper", r"C:\texts\lib.rs", Some("Wiper"), None),
            ("texts/wiper", "texts/wiper", None, None),
        ] {
            assert!(is_file(argument));
            let found = Argument::of(argument);
            assert_eq!(found, Argument { path, name, scene });
            assert_eq!(found.to_string(), argument);
        }
        assert!(!is_file("four_bar") && !is_file("slider_crank_mass:Driven"));
    }
}

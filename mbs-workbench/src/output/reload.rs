//! A page that loads itself anew when it is written again.

use crate::hash::hash;

/// Name of the file beside the page that says which one is there.
pub const VERSION: &str = "version.js";

/// Time (ms) between two looks at that file: shorter than a glance from the editor to the page.
const INTERVAL: u32 = 500;

/// The page with a script that looks for another version, and the content of [`VERSION`], to be written behind the page.
///
/// Nothing is fetched from a network: the file is loaded as a script, which pages from a disk may do.
pub fn reloading(page: &str) -> (String, String) {
    let version = hash(&[page.as_bytes()]);
    let script = format!(
        "<script>\n{{\n  window.mbsVersion = there => {{ if (there !== \"{version}\") location.reload(); }};\n  \
         setInterval(() => {{\n    const look = document.createElement(\"script\");\n    look.src = `{VERSION}?${{Date.now()}}`;\n    \
         look.onload = look.onerror = () => look.remove();\n    document.head.append(look);\n  }}, {INTERVAL});\n}}\n</script>\n"
    );
    let at = page.rfind("</body>").unwrap_or(page.len());
    let (before, behind) = page.split_at(at);
    (format!("{before}{script}{behind}"), format!("window.mbsVersion(\"{version}\");\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_knows_the_version_that_stands_beside_it() {
        let (page, version) = reloading("<body>one</body>");
        let own = version.strip_prefix("window.mbsVersion(\"").and_then(|rest| rest.strip_suffix("\");\n"));
        assert!(page.contains(&format!("there !== \"{}\"", own.expect("a version"))));
        assert!(page.starts_with("<body>one<script>\n") && page.ends_with("</script>\n</body>"));
        assert_eq!(reloading("<body>one</body>"), (page.clone(), version.clone()));
        let (other, other_version) = reloading("<body>two</body>");
        assert!(other != page && other_version != version);
    }
}

//! Self-contained pages: a template with style, script and data in one file.

use serde::Serialize;

/// Parts of a page: HTML with `{{title}}`, `{{origin}}`, `{{style}}`, `{{script}}` and `{{data}}`, its style and its script.
pub(crate) struct Template {
    pub html: &'static str,
    pub style: &'static str,
    pub script: &'static str,
}

impl Template {
    /// The page of `data`; `origin`: program, version and text.
    pub fn filled(&self, title: &str, origin: &str, data: &impl Serialize) -> String {
        let json = serde_json::to_string(data).expect("plain data has a JSON form");
        // A script element must contain neither `</script>` nor `<!--`.
        let json = json.replace('<', "\\u003c");
        self.html
            .replace("{{title}}", &escaped(title))
            .replace("{{origin}}", &escaped(origin))
            .replace("{{style}}", self.style)
            .replace("{{script}}", self.script)
            .replace("{{data}}", &json)
    }
}

/// Text of an element or of an attribute.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

//! The self-contained report of a study: a page a step, pictures as inline SVG, no script.
//!
//! A link to a step shows that step alone, `#all` all of them below each other, and so does a printer. Without either the first
//! step is shown.

use core::fmt::Write;

use super::{Report, Section, Table};
use crate::output::page::escaped;

/// The page. `command`: the line that makes it; `origin`: program, version and text.
pub fn html(report: &Report, command: &str, origin: &str) -> String {
    let mut body = String::new();
    for index in 0..report.sections.len() {
        write_section(&mut body, index, &report.sections);
    }
    let links: String = report
        .sections
        .iter()
        .enumerate()
        .map(|(index, section)| {
            format!("<a href=\"#step{}\">{}. {}</a>\n", index + 1, index + 1, escaped(&section.title))
        })
        .collect();
    // The link to the step on show is marked; without a target that is the first one.
    let mut marked: Vec<String> = (1..=report.sections.len())
        .map(|number| format!("body:has(#step{number}:target) header a[href=\"#step{number}\"]"))
        .collect();
    marked.push("body:not(:has(:target)) header a[href=\"#step1\"]".to_string());
    marked.push("body:has(#all:target) header a[href=\"#all\"]".to_string());
    let marked =
        format!("{} {{ color: var(--ink); font-weight: 600; text-decoration: none; }}", marked.join(", "));
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"{}\">\n<title>{title}</title>\n<style>{}{marked}\n</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1><p class=\"lead\">{}</p><nav aria-label=\"Steps\">{links}<a href=\"#all\">All steps</a></nav></header>\n<main id=\"all\">\n{body}</main>\n\
         <footer>Made by <code>{}</code> · {}</footer>\n</body>\n</html>\n",
        escaped(origin),
        include_str!("page.css"),
        escaped(&report.sentence),
        // A word is broken where it does not fit alone.
        command
            .split(' ')
            .map(|word| format!("<span>{}</span>", escaped(word)))
            .collect::<Vec<_>>()
            .join(" "),
        escaped(origin),
        title = escaped(&report.title),
    )
}

/// Links to the steps before and after the one at `index`.
fn neighbours(index: usize, sections: &[Section]) -> String {
    let link = |other: usize, before: &str, after: &str| match sections.get(other) {
        Some(section) => {
            format!(
                "<a href=\"#step{}\">{before}{}. {}{after}</a>",
                other + 1,
                other + 1,
                escaped(&section.title)
            )
        }
        None => "<span></span>".to_string(),
    };
    format!(
        "<nav class=\"turn\" aria-label=\"Neighbours\">{}{}</nav>",
        link(index.wrapping_sub(1), "‹ ", ""),
        link(index + 1, "", " ›")
    )
}

fn write_section(body: &mut String, index: usize, sections: &[Section]) {
    let (number, section) = (index + 1, &sections[index]);
    let turn = neighbours(index, sections);
    let _ =
        writeln!(body, "<section id=\"step{number}\">{turn}<h2>{number}. {}</h2>", escaped(&section.title));
    for paragraph in &section.text {
        let _ = writeln!(body, "<p>{}</p>", escaped(paragraph));
    }
    for table in &section.tables {
        write_table(body, table);
    }
    body.push_str("<div class=\"pictures\">\n");
    for picture in &section.pictures {
        let _ = writeln!(
            body,
            "<figure><figcaption>{}</figcaption><div class=\"scroll\">{}</div></figure>",
            escaped(&picture.caption),
            picture.svg
        );
    }
    let _ = writeln!(body, "</div>{turn}</section>");
}

fn write_table(body: &mut String, table: &Table) {
    let row = |cells: &[String], tag: &str| -> String {
        cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect()
    };
    let _ = write!(
        body,
        "<div class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>",
        row(&table.head, "th")
    );
    for cells in &table.rows {
        let _ = write!(body, "<tr>{}</tr>", row(cells, "td"));
    }
    body.push_str("</tbody></table></div>\n");
}

#[cfg(test)]
mod tests {
    use super::super::Picture;
    use super::*;

    #[test]
    fn a_page_has_all_steps_and_refers_to_nothing_outside() {
        let mut table = Table::new(["a", "b"]);
        table.push(["1 < 2".to_string(), "3".to_string()]);
        let section = Section {
            title: "Synthesis".to_string(),
            text: vec!["Both cams.".to_string()],
            tables: vec![table],
            pictures: vec![Picture { caption: "Lift".to_string(), svg: "<svg></svg>".to_string() }],
        };
        let report = Report {
            title: "A study".to_string(),
            sentence: "It ran.".to_string(),
            sections: vec![section.clone(), Section { title: "Motion".to_string(), ..section }],
        };
        let page = html(&report, "mbs study a", "mbs 0.1.0, a, text 0");
        // A page a step: both are in the list, each leads to the other, and one is marked.
        for part in
            ["‹ 1. Synthesis", "2. Motion ›", "header a[href=\"#step2\"]", "href=\"#all\"", "id=\"all\""]
        {
            assert!(page.contains(part), "{part}");
        }
        assert_eq!(page.matches("<a href=\"#step1\">").count(), 1 + 2);
        for part in [
            "1. Synthesis",
            "2. Motion",
            "1 &lt; 2",
            "<svg></svg>",
            "<span>study</span> <span>a</span>",
            "#step2",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("http") && !page.contains("<script"));
    }
}

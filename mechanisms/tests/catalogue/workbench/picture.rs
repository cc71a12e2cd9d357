//! Pictures of the structure and of basins of attraction of ready mechanisms.

use mbs_workbench::output::svg::structure;
use mbs_workbench::teaching::basins::Axis;
use mbs_workbench::teaching::basins::basins as compute;
use mbs_workbench::teaching::basins_picture::basins;
use mechanisms::CATALOGUE;

/// Every tag is closed; attributes aside, nothing but tags and text.
fn assert_well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1).map(|part| part.split('>').next().unwrap_or("")) {
        let name = tag.split([' ', '/']).next().unwrap_or("");
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "{tag}");
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert_eq!(svg.matches('"').count() % 2, 0);
}

#[test]
fn every_structure_is_drawn_below_its_blocks() {
    for card in CATALOGUE.fixed() {
        let mechanism = card.equations();
        let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()));
        let report = report.expect("a good text");
        let svg = structure(&report);
        assert_well_formed(&svg);
        assert_eq!(svg.matches("class=\"block\"").count(), report.blocks.len());
        let entries: usize = report.rows.iter().map(|row| row.entries.len()).sum();
        let colours = ["#bdd7e7", "#6baed6", "#08519c"];
        let drawn: usize = colours.iter().map(|colour| svg.matches(colour).count()).sum();
        assert_eq!(drawn, entries, "{}", card.name());
    }
}

#[test]
fn the_strokes_of_a_map_cover_what_was_found() {
    let mechanism = CATALOGUE.find("four_bar").expect("in the list").mechanism().expect("its rows fix it");
    let axes = [3, 4].map(|coordinate| Axis::of(mechanism.as_ref(), coordinate));
    let found = compute(mechanism.as_ref(), axes, 12, 0.0, &mut |_| ());
    let svg = basins(mechanism.as_ref(), &found);
    assert_well_formed(&svg);
    let strokes = svg.lines().filter(|line| line.starts_with("<path"));
    let runs = strokes.flat_map(|line| line.split('h').skip(1));
    let digits = |run: &str| run.split(|c: char| !c.is_ascii_digit()).next().unwrap_or("").parse::<usize>();
    let covered: usize = runs.filter_map(|run| digits(run).ok()).sum();
    let cells: usize = found.maps.iter().map(|map| map.cells.iter().flatten().count()).sum();
    assert_eq!(covered, cells);
    assert!(svg.contains("phi2") && svg.contains("-180°"), "{svg}");
}

//! The table of permitted contents in the language reference, each cell tried on the compiler.

use std::fs;
use std::path::Path;

use mbs_codegen::expand_source;

/// A mechanism with everything that a place may contain; `…` is the place.
const MECHANISM: &str = "mechanism Example;
    param k: 1 = 1; input u: 1; input v: 1, rates;
    coord x: m = 0; coord y: m = 0; state z: 1 = 0; der(z) == 1 [1/s];
    body b { mass: 1kg, com: [x, y] } constraint c { y == 0; } …";

/// Places by their words in the first column, with `…` for the content, a number.
const PLACES: [(&str, &str); 24] = [
    ("`const`", "const q: 1 = …;"),
    ("default of a `param`", "param q: 1 = …;"),
    ("period", "function f: 1(1), C9, periodic 2 + …; force w: [1N*f(x/1m), 0] on [x, y];"),
    ("counts", "coord w: [1; 2 + …]; constraint cw { w == 0; }"),
    ("guess", "coord w: 1 = …; constraint cw { w == 1; }"),
    ("`start`", "start x = 1m*…;"),
    ("bound of a `limit`", "limit l: … - 10 <= x/1m <= 20;"),
    ("`within`", "constraint cr redundant within 1m*… { y == 0; }"),
    ("mass", "body b2 { mass: 1kg*(… + 5), com: [x, y] }"),
    ("inertia", "body b2 { mass: 1kg, com: [x, y], inertia: 1 [kg*m^2]*(… + 5), angle: x/1m }"),
    ("prescribed rate of a drive", "coord w: rad; drive d: rate(w) == …/1s;"),
    ("constraint", "coord w: 1; constraint cw { w == …; }"),
    ("drive, points", "coord w: 1; drive d: w == …;"),
    ("points and angles of bodies and springs", "body b2 { mass: 1kg, com: [x + 1m*…, y] }"),
    ("branch", "branch br: x/1m + … > -5;"),
    ("quantity of a `limit`", "limit l: -10 <= x/1m + … <= 20;"),
    ("`potential`", "potential V = 1J*x/1m*…;"),
    ("`acceleration` of `gravity`", "gravity g { acceleration: [1 [m/s^2]*…, 0] }"),
    ("value of a force", "force f: [1N*…, 0] on [x, y];"),
    ("`tsda`", "tsda s { from: [0, 0], to: [x, 1], actuator: 1N*… }"),
    ("`friction`", "friction f { along: x, normal: 1N*…, coefficient: 0.1, speed: 1mm/1s }"),
    ("`dissipation`", "dissipation R = 1 [N*s/m]*der(x)^2*(2 + …);"),
    ("`der(z) ==`", "state z2: 1 = 0; der(z2) == …/1s;"),
    ("`out`", "out o: 1 = …;"),
];

/// Contents: number of the column, words of a cell that permit it, expression.
const CONTENTS: [(usize, &[&str], &str); 9] = [
    (1, &["yes"], "x/1m"),
    (1, &["yes", "only `t`"], "t/1s"),
    (2, &["yes"], "k"),
    (3, &["yes"], "u"),
    (3, &["yes", "with `rates`"], "v"),
    (4, &["yes"], "der(x)*1 [s/m]"),
    (5, &["yes"], "lambda(c)/1N"),
    (5, &["yes"], "z"),
    (6, &["yes"], "der2(x)*1 [s^2/m]"),
];

#[test]
fn each_cell_of_the_table_of_places_is_what_the_compiler_does() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src/language/expressions.md");
    let text = fs::read_to_string(path).expect("the chapter");
    let table = text.split("| place |").nth(1).expect("the table");
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.split('|').skip(1).map(str::trim).collect())
        .collect();
    let mut wrong = Vec::new();
    for (words, place) in PLACES {
        let row = rows.iter().find(|row| row.first().is_some_and(|cell| cell.contains(words)));
        let row = row.unwrap_or_else(|| panic!("no row of {words}"));
        let plain = MECHANISM.replace('…', &place.replace('…', "1"));
        assert_eq!(expand_source(&plain).err(), None, "{words}: the place itself");
        for (column, permitting, content) in CONTENTS {
            let permitted = row.get(column).is_some_and(|cell| permitting.contains(cell));
            let result = expand_source(&MECHANISM.replace('…', &place.replace('…', content)));
            if result.is_ok() != permitted {
                wrong.push(format!("{words}: `{content}` is permitted: {permitted}; {:?}", result.err()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

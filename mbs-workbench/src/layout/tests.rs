use super::*;

#[track_caller]
fn laid(before: &str, after: &str) {
    let layout = bare(before);
    assert_eq!(layout.faults, []);
    assert_eq!(layout.content, after);
    assert_eq!(bare(after), layout, "a second layout changes the text");
}

/// A text with the statements, its header and a coordinate in front.
#[track_caller]
fn statements(before: &str, after: &str) {
    let head = "mechanism A;\ncoord phi: rad;\n";
    laid(&format!("{head}{before}"), &format!("{head}{after}"));
}

#[test]
fn a_statement_has_a_line_and_its_marks_have_their_blanks() {
    laid(
        "mechanism   Crank ;param  L:m=0.2  in 50mm .. 400mm,tolerance 0.1mm;coord phi :rad= - 0.5 ;
         coord p:[m;2]=[0.1 ,0.2]; drive crank:phi==10[rad/s]*t-1 ;",
        "mechanism Crank;\nparam L: m = 0.2 in 50mm..400mm, tolerance 0.1mm;\ncoord phi: rad = -0.5;\n\
         coord p: [m; 2] = [0.1, 0.2];\ndrive crank: phi == 10 [rad/s]*t - 1;\n",
    );
}

#[test]
fn signs_stand_at_their_operands_and_operators_between() {
    statements(
        "let a = -phi*- 2-3 ;let b=L [ 0 ]^ -2/-x+m . 0+n.0 .1;start phi = 0 rate -w;let c = rate - w;",
        "let a = -phi*-2 - 3;\nlet b = L[0]^-2/-x + m.0 + n.0 .1;\nstart phi = 0 rate -w;\nlet c = rate - w;\n",
    );
}

#[test]
fn words_keep_a_blank_before_a_vector_and_names_have_none_before_an_index() {
    statements(
        "draw slider S along [1,0];let a = theta [0] + rate[1];start p = [0, 0] rate [0,\t0];",
        "draw slider S along [1, 0];\nlet a = theta[0] + rate[1];\nstart p = [0, 0] rate [0, 0];\n",
    );
    let curves = "force f: [1N, 0] on [0, y];\nfoot f of [x, y] on c within 1m near [1][0];\n\
                  curve c = polar r about [0, 0] turned [1][0];\n";
    statements(curves, curves);
    statements(
        "curve  c=parametric x[0],y about [0,0] turned psi ;foot w of circle ([x,y],1mm) turned -psi on c within 1m;\
         foot w of flat( [x, y],90deg ) on c within 1m near 0;foot w of c at  v on e within 1m near -1,[1][0];",
        "curve c = parametric x[0], y about [0, 0] turned psi;\n\
         foot w of circle([x, y], 1mm) turned -psi on c within 1m;\n\
         foot w of flat([x, y], 90deg) on c within 1m near 0;\n\
         foot w of c at v on e within 1m near -1, [1][0];\n",
    );
}

#[test]
fn arrays_of_functions_are_written_as_arrays_and_calls_are() {
    statements(
        "function  lift:[ m ;2 ] ( rad ),C3 ;let a = lift [ 1 ] ( phi )+lift[0] . d1 ( phi );curve c=polar lift [0] about [0,0];",
        "function lift: [m; 2](rad), C3;\nlet a = lift[1](phi) + lift[0].d1(phi);\ncurve c = polar lift[0] about [0, 0];\n",
    );
}

#[test]
fn comments_stay_where_they_are() {
    laid(
        "// first\n\n\n/// Doc.\nmechanism A;  // behind\n  /* alone */\ncoord phi: rad;/* behind */ coord x: m;\n\n\n\
         // before the loop\nfor i in 0..2 { // head\n// inside\nbody b {\nmass: m, // of a link\n   com: [0, 0]\n\
         /* last */ } }\n// end\n",
        "// first\n\n/// Doc.\nmechanism A; // behind\n/* alone */\ncoord phi: rad; /* behind */\ncoord x: m;\n\n\
         // before the loop\nfor i in 0..2 { // head\n    // inside\n    body b {\n        mass: m, // of a link\n        \
         com: [0, 0]\n        /* last */\n    }\n}\n// end\n",
    );
}

#[test]
fn blocks_with_one_statement_or_rows_may_have_one_line() {
    statements(
        "constraint a { x==y;y==x; }\nconstraint b {x==y;\ny==x;}\neffect f {let u=1;let v=2;}\neffect e {\nlet u = 1;\n}\nscene s = e+f { title \"x\"; }\nscene v=e;\
         preset slow \"a\" {omega:1rpm}\npreset plain \"b\" { }",
        "constraint a { x == y; y == x; }\nconstraint b {\n    x == y;\n    y == x;\n}\neffect f {\n    let u = 1;\n    \
         let v = 2;\n}\neffect e {\n    let u = 1;\n}\n\
         scene s = e + f { title \"x\"; }\nscene v = e;\npreset slow \"a\" { omega: 1rpm }\npreset plain \"b\" {}\n",
    );
}

#[test]
fn rows_of_a_matrix_stay_and_what_a_statement_needs_no_line_end_for_is_joined() {
    statements(
        "let\n  a\n =\n  [\n[1,2],\n [3,4]];\ncoord e : [1;2,2]=[\n[1,0],[0,1]\n] ;let b = phi\n + 1\n;",
        "let a =\n    [\n        [1, 2],\n        [3, 4]\n    ];\ncoord e: [1; 2, 2] = [\n    [1, 0], [0, 1]\n];\n\
         let b = phi\n    + 1;\n",
    );
}

#[test]
fn long_lines_are_broken_at_the_outermost_place() {
    let term = "some_long_name*cos(another_long_name + phi)";
    statements(
        &format!(
            "constraint c {{ {term} + {term} == {term}; }}\nout p: [m; 2] = {term} - {term} + {term};\n\
                  let v = [{term}, {term}, {term}];\nbody b {{ mass: {term}, com: {term}, inertia: 1 }}"
        ),
        &format!(
            "constraint c {{\n    {term} + {term}\n        == {term};\n}}\nout p: [m; 2] = {term} - {term}\n    + {term};\n\
             let v = [\n    {term},\n    {term},\n    {term}\n];\nbody b {{\n    mass: {term},\n    com: {term},\n    inertia: 1\n}}\n"
        ),
    );
}

#[test]
fn quoted_texts_stay_as_they_are() {
    statements("about \"one \\\n     two  //  three\";", "about \"one \\\n     two  //  three\";\n");
}

#[test]
fn calls_in_a_rust_source_are_laid_out_where_they_stand() {
    let before = "mod a {\n    mbs_runtime::mechanism! {  mechanism A;coord phi:rad;\n  // end\n }\n}\nfn  b( ) { }\n\
                  macro_rules! c { ($n:ident) => { mechanism! { mechanism $n;coord  x:m; } } }\n";
    let after = "mod a {\n    mbs_runtime::mechanism! {\n        mechanism A;\n        coord phi: rad;\n        // end\n    \
                 }\n}\nfn  b( ) { }\nmacro_rules! c { ($n:ident) => { mechanism! { mechanism $n;coord  x:m; } } }\n";
    for line_end in ["\n", "\r\n"] {
        for mark in ["", "\u{feff}"] {
            let of = |text: &str| format!("{mark}{}", text.replace('\n', line_end));
            let layout = rust(&of(before)).expect("Rust");
            assert_eq!((layout.content.as_str(), layout.faults.len()), (of(after).as_str(), 0));
            assert_eq!(rust(&of(after)), Ok(layout));
        }
    }
}

#[test]
fn texts_that_cannot_be_read_stay_with_their_fault() {
    let text = "mechanism  A;\ncoord  phi: rad\ncoord x: m;\n";
    let layout = bare(text);
    assert_eq!(layout.content, text);
    assert_eq!(layout.faults.iter().map(|fault| fault.line).collect::<Vec<_>>(), [2]);
    let two = format!("mechanism! {{ {text} }}\nmechanism! {{ mechanism B;coord x:m; }}\n");
    let layout = rust(&two).expect("Rust");
    assert!(
        layout.content.starts_with(&format!("mechanism! {{ {text} }}\nmechanism! {{\n    mechanism B;\n"))
    );
    assert_eq!(layout.faults.len(), 1);
    assert!(rust("fn a( {").is_err());
}

#[test]
fn names_units_and_equations_may_be_at_fault() {
    statements("out  a: m = nowhere+1;", "out a: m = nowhere + 1;\n");
}

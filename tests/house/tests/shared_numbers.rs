//! Numbers that the code generator and the runtime both hold.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::Radau5;

#[test]
fn a_mechanism_is_revealed_as_large_where_radau_does_not_take_it() {
    for (unknowns, large) in [(Radau5::MOST_UNKNOWNS, false), (Radau5::MOST_UNKNOWNS + 1, true)] {
        let bodies = format!("for i in 0..{unknowns} {{ body bob {{ mass: 1, com: [x[i], 0] }} }}");
        let text = format!("mechanism Row; coord x: [m; {unknowns}] = 0; {bodies}");
        let code = mbs_codegen::expand_source(&text).expect("a text without faults").to_string();
        assert_eq!([code.contains("large_free"), code.contains("__visitor")], [large, true], "{unknowns}");
    }
}

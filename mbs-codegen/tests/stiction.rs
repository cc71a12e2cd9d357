//! Friction that sticks: the size of its code, and what texts without it have of it.
#![forbid(unsafe_code)]

use proc_macro2::{TokenStream, TokenTree};

/// Twelve blocks, the first `count` of them with friction that sticks.
fn text(count: usize) -> String {
    let mut text = String::from(
        "/// Blocks in a row.\npub mechanism Row;\ncoord x: [m; 12] = 0;\nfor i in 0..12 { body block { mass: 1kg, com: [x[i], 0] } }\n",
    );
    for index in 0..count {
        text += &format!(
            "friction rub{index} {{ along: x[{index}], normal: 9.81N, coefficient: 0.1, sticks: 0.2, speed: 0.1 }}\n"
        );
    }
    text
}

fn tokens(stream: TokenStream) -> usize {
    let of = |tree: TokenTree| match tree {
        TokenTree::Group(group) => 2 + tokens(group.stream()),
        _ => 1,
    };
    stream.into_iter().map(of).sum()
}

#[test]
fn code_grows_in_proportion_to_the_number_of_frictions() {
    let expand = |count: usize| mbs_codegen::expand_source(&text(count)).expect("it expands");
    let [none, one, four, twelve] = [0, 1, 4, 12].map(|count| tokens(expand(count)));
    let each = |more: usize, less: usize, count: usize| (more - less) as f64 / count as f64;
    let (first, few, many) = (each(one, none, 1), each(four, one, 3), each(twelve, four, 8));
    assert!(few <= first && many <= 1.02 * few && few <= 1.02 * many, "{first} {few} {many}");
    let plain = expand(0).to_string();
    for word in ["FRICTIONS", "Grip", "friction_rows", "grips"] {
        assert!(!plain.contains(word) && expand(1).to_string().contains(word), "{word}");
    }
}

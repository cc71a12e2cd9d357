//! Friction that sticks and rigid contacts: the size of their code, what texts without them have of it, and messages.
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
    assert!(!expand(1).to_string().contains("HAS_RIGID_CONTACTS"));
    for word in ["SET_VALUED", "SetValuedMode", "set_valued_rows", "set_valued_modes"] {
        assert!(!plain.contains(word) && expand(1).to_string().contains(word), "{word}");
    }
}

/// Balls above a floor, the first `count` of them with a rigid contact.
fn balls(count: usize) -> String {
    let mut text = String::from(
        "/// Balls in a row.\npub mechanism Row;\ncoord y: [m; 24] = 1;\nfor i in 0..24 { body ball { mass: 1kg, com: [i*1m, y[i]] } }\n",
    );
    for index in 0..count {
        text += &format!("contact floor{index} {{ gap: y[{index}], restitution: 0.5 }}\n");
    }
    text
}

#[test]
fn code_grows_in_proportion_to_the_number_of_rigid_contacts() {
    let expand = |count: usize| mbs_codegen::expand_source(&balls(count)).expect("it expands");
    let [one, four, twelve, all] = [1, 4, 12, 24].map(|count| tokens(expand(count)));
    let each = |more: usize, less: usize, count: usize| (more - less) as f64 / count as f64;
    let (few, some, many) = (each(four, one, 3), each(twelve, four, 8), each(all, twelve, 12));
    assert!(some <= 1.02 * few && many <= 1.02 * few && few <= 1.02 * many, "{few} {some} {many}");
    let plain = expand(0).to_string();
    for word in ["SET_VALUED", "HAS_RIGID_CONTACTS", "SetValuedMode", "set_valued_rows", "restitution"] {
        assert!(!plain.contains(word) && expand(1).to_string().contains(word), "{word}");
    }
}

/// Blocks above a floor, the first `count` of them with a rigid contact and friction on it.
fn rubbing(count: usize) -> String {
    let mut text = String::from(
        "/// Blocks in a row.\npub mechanism Row;\ncoord p: [m; 24, 2] = 1;\nfor i in 0..24 { body block { mass: 1kg, com: p[i] } }\n",
    );
    for index in 0..count {
        text += &format!(
            "contact floor{index} {{ gap: p[{index}, 1], restitution: 0.5 }}\n\
             friction rub{index} {{ along: p[{index}, 0], normal: normal(floor{index}), coefficient: 0.2, sticks: 0.3, speed: 0.1 }}\n\
             out blow{index}: N*s = impulse(floor{index});\n"
        );
    }
    text
}

#[test]
fn code_grows_in_proportion_to_the_number_of_frictions_on_rigid_contacts() {
    let expand = |count: usize| mbs_codegen::expand_source(&rubbing(count)).expect("it expands");
    let [none, one, four, twelve, all] = [0, 1, 4, 12, 24].map(|count| tokens(expand(count)));
    let each = |more: usize, less: usize, count: usize| (more - less) as f64 / count as f64;
    let first = each(one, none, 1);
    let (few, some, many) = (each(four, one, 3), each(twelve, four, 8), each(all, twelve, 12));
    assert!(few <= first && some <= 1.02 * few && few <= 1.02 * some, "{first} {few} {some}");
    // From 19 contacts on forces and powers are long functions, whose parts have heads: 7 % more tokens.
    assert!(many <= 1.1 * few && few <= 1.02 * many, "{few} {many}");
    let plain = expand(0).to_string();
    for word in ["SET_VALUED", "HAS_RIGID_CONTACTS", "HAS_FRICTION_ON_CONTACTS", "SetValuedMode", "OnContact"]
    {
        assert!(!plain.contains(word) && expand(1).to_string().contains(word), "{word}");
    }
}

#[test]
fn wrong_rigid_contacts_are_named() {
    let said = |contacts: &str| {
        let text = format!(
            "/// Ball.\npub mechanism B;\nparam e: 1 = 1.5;\ncoord y: m = 1;\nbody ball {{ mass: 1kg, com: [0, y] }}\n{contacts}"
        );
        mbs_codegen::expand_source(&text).expect_err("it is wrong")
    };
    for (contacts, message) in [
        (
            "contact c { gap: y, restitution: 0.5, damping: 0.1 }",
            "`damping` is of contacts with a `stiffness`",
        ),
        (
            "contact c { gap: y, restitution: 0.5, approach: 1 }",
            "`approach` is of contacts with a `stiffness`",
        ),
        ("contact c { gap: y, restitution: 0.5, simultaneous: shared }", "`simultaneous` is `shared`"),
        (
            "contact c { gap: y, stiffness: 1e5, simultaneous: ordered }",
            "`c` has a stiffness and a `simultaneous`",
        ),
        ("contact c { gap: y, restitution: 0.5, bound: 10 }", "`bound` is of contacts with a `stiffness`"),
        ("contact c { gap: y, restitution: e }", "`1 - restitution` of `c` is negative"),
        ("contact c { gap: y, restitution: -0.1 }", "`restitution` of `c` is negative"),
        ("contact c { gap: y }", "`c` has no field `stiffness`"),
        (
            "contact c { gap: y, restitution: 0.5 }\nforce f: [force(c), 0] on [0, y];",
            "`f` needs the force of a friction that sticks, or of a rigid contact",
        ),
    ] {
        let found = said(&format!("{contacts}\nout push: N = force(c);"));
        assert!(found.contains(message), "{contacts}: {found}");
        assert!(!found.contains("depends on itself"), "{contacts}: {found}");
    }
}

#[test]
fn friction_on_rigid_contacts_is_told_apart() {
    let expand = |statements: &str| {
        mbs_codegen::expand_source(&format!(
            "/// Block.\npub mechanism B;\ncoord p: [m; 2] = [0, 1];\nbody block {{ mass: 1kg, com: p }}\ncontact floor {{ gap: p[1], restitution: 0.5 }}\n{statements}"
        ))
    };
    let word = "HAS_FRICTION_ON_CONTACTS";
    for (friction, has) in [
        ("along: p[0], normal: normal(floor), coefficient: 0.2, sticks: 0.3", true),
        ("along: p[0], normal: force(floor), coefficient: 0.2, sticks: 0.3, speed: 0.1, viscous: 2", true),
        ("along: p[0], normal: 2N, coefficient: 0.2, sticks: 0.3", false),
    ] {
        let tokens = expand(&format!("friction rub {{ {friction} }}")).expect("it expands").to_string();
        assert_eq!(tokens.contains(word), has, "{friction}");
        assert_eq!(tokens.contains("OnContact"), has, "{friction}");
    }
    // Other laws, and other functions of the force, have no mode to be found.
    for friction in [
        "along: p[0], normal: normal(floor), coefficient: 0.2, speed: 0.1",
        "along: p[0], normal: normal(floor), coefficient: 0.2, bristles: 1mm",
        "along: p[0], normal: 2*normal(floor), coefficient: 0.2, sticks: 0.3",
    ] {
        let said = expand(&format!("friction rub {{ {friction} }}")).expect_err("it is refused");
        assert!(
            said.contains("`rub` needs the force of a friction that sticks, or of a rigid contact"),
            "{said}"
        );
        assert!(said.contains("may be that of one rigid contact"), "{said}");
    }
}

//! Hygiene of names: emitted code is independent of the caller's declarations and passes the caller's lints.
#![no_std]
#![deny(warnings, missing_docs, missing_debug_implementations, unreachable_pub, unused)]
#![deny(clippy::all, clippy::pedantic)]
#![allow(clippy::float_cmp, clippy::similar_names, reason = "the tests compare exact numbers")]
#![forbid(unsafe_code)]
#![allow(mixed_script_confusables, reason = "angles are written in Greek")]

extern crate std;

use mbs_runtime::{Kinematic, Mechanism, Stepper};

/// Assembles a mechanism and moves it.
#[track_caller]
fn runs<S: Kinematic<f64, N>, const N: usize>(mechanism: S) -> [f64; N] {
    let guess = mechanism.guess(&mechanism.parameters());
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("assembled");
    stepper.advance(0.1).expect("a step");
    *stepper.q()
}

mod every_name {
    //! Names that emitted code might use itself.

    mbs_runtime::mechanism! {
        /// Coordinates and parameters named as locals, types, methods and keywords.
        pub(crate) mechanism Named;
        const _private: m = 2;
        param p: m = 1;
        param s: 1 = 1;
        param t1: 1 = 1;
        param T: 1 = 1;
        param f64: m = 1;
        param Phi: 1 = 1;
        param phi_q: 1 = 1;
        param lambda1: 1 = 1;
        param r#type: 1 = 1;
        param fn: 1 = 1;
        param gen: 1 = 1;
        param index: [1; 2] = [1, 2];
        param value: 1 = 1;
        param lane: 1 = 1;
        param parameters: 1 = 1;
        param Parameters: 1 = 1;
        param default: 1 = 1;
        param clone: 1 = 1;
        param core: 1 = 1;
        param mbs_runtime: 1 = 1;
        input x: m, rates;
        input θ: rad;
        coord q: m;
        coord qd: m;
        coord Self_: 1;
        coord match: 1;
        coord Option: [1; 2];
        coord named: 1;
        coord φ: rad;
        let __n1 = q*s;
        drive drive: q == p*t/1s + x;
        constraint constraint { qd == _private - __n1; }
        constraint self { Self_ == T*Phi*phi_q*lambda1*type*fn*gen; }
        constraint q { match == index[0] + value*lane*parameters; Option == [Parameters, default]; }
        constraint rest { named == clone*core*mbs_runtime; φ == f64/1m; }
        branch branch: named > 0;
        out q: m = q;
        out type: rad = θ;
    }

    #[test]
    fn any_name_names_a_field() {
        let named = Named { r#type: 2.0, θ: 0.5, ..Named::default() };
        let q = NamedCoordinates::from(super::runs(named));
        assert_eq!((q.q, q.Self_, q.r#match, q.Option), (0.1, 2.0, 2.0, [1.0, 1.0]));
        assert_eq!((q.qd, q.φ), (1.9, 1.0));
        let names: std::vec::Vec<&str> =
            <Named as mbs_runtime::Mechanism<f64, 8, 8>>::COORDINATES.iter().map(|c| c.name).collect();
        assert_eq!(names, ["q", "qd", "Self_", "match", "Option.0", "Option.1", "named", "φ"]);
    }
}

mod names_of_mechanisms {
    //! Mechanisms named as types of the emitted code.

    mbs_runtime::mechanism! {
        /// As the stage values.
        pub(super) mechanism Parameters;
        coord x: m;
        drive d: x == 1m;
    }
    mbs_runtime::mechanism! {
        /// As the other stage values.
        pub(super) mechanism Position;
        coord x: m;
        drive d: x == 2m;
    }
    mbs_runtime::mechanism! {
        /// As the factors.
        pub(super) mechanism Factors;
        coord x: m;
        drive d: x == 3m;
    }
    mbs_runtime::mechanism! {
        /// As a trait.
        pub(super) mechanism Mechanism;
        param L: m = 5;
        coord x: m;
        drive d: x == L;
    }

    #[test]
    fn any_name_names_a_mechanism() {
        assert_eq!(super::runs(Parameters::default()), [1.0]);
        assert_eq!(super::runs(Position::default()), [2.0]);
        assert_eq!(super::runs(Factors::default()), [3.0]);
        assert_eq!(super::runs(Mechanism::default()), [5.0]);
    }
}

mod shadows {
    //! A caller who has taken every name of the prelude.
    #![allow(non_camel_case_types, dead_code, reason = "they shadow")]

    mod core {}
    mod std {}
    mod mbs_codegen {}
    struct f64;
    struct f32;
    struct bool;
    struct str;
    struct usize;
    struct u8;
    struct u16;
    struct u32;
    struct Option;
    struct Result;
    struct Some;
    struct None;
    struct Ok;
    struct Err;
    struct Box;
    struct Scalar;
    struct Block;
    struct Outcome;
    struct Copy;
    struct Debug;
    struct PhantomData;
    trait Default {}
    trait Clone {}
    trait From {}
    trait Into {}
    trait Iterator {}
    trait PartialEq {}
    trait Fn {}
    trait Mechanism {}
    trait Kinematic {}
    trait Neg {
        fn neg(self);
    }
    trait Add {
        fn add(self);
    }

    mbs_runtime::mechanism! {
        /// In the middle of them.
        pub(super) mechanism Shadowed;
        param L: [m; 2] = [1, 2];
        input u: rad, rates;
        coord a: rad = 0.1;
        coord b: rad = 2;
        coord p: [m; 2];
        constraint bar { p == L[0]*unit(a) + L[1]*unit(b); }
        constraint loop { L[0]*sin(a) == L[1]*sin(b); }
        drive d: a == 0.1 + t/1s + u;
        branch open: cos(b) < 0;
        out speed: [m/s; 2] = der(p);
    }

    mbs_runtime::mechanism! {
        mechanism WithoutParameters;
        coord x: m;
        drive d: x == 1m*t/1s;
    }

    #[test]
    fn shadowed_names_are_not_used() {
        let [a, ..] = super::runs(Shadowed::default());
        assert_eq!(a, 0.2);
        assert_eq!(super::runs(WithoutParameters::default()), [0.1]);
    }
}

mod values {
    //! A caller whose constants, statics and functions are named as locals might be.
    #![allow(non_upper_case_globals, dead_code, reason = "they are named as locals")]

    const q: u8 = 1;
    const t: u8 = 1;
    const p: u8 = 1;
    const x: u8 = 1;
    const index: u8 = 1;
    const value: u8 = 1;
    const named: u8 = 1;
    const lane: u8 = 1;
    static qd: u8 = 1;
    static qdd: u8 = 1;
    static s: u8 = 1;
    static solver: u8 = 1;
    static outcome: u8 = 1;
    static T: u8 = 1;
    fn sin(_: u8) {}
    fn constant(_: u8) {}
    macro_rules! line {
        () => {
            "not a number"
        };
    }
    macro_rules! unreachable {
        () => {
            "not this one"
        };
    }

    mbs_runtime::mechanism! {
        /// Among them.
        pub(super) mechanism Valued;
        param L: m = 1;
        coord a: rad = 0.1;
        coord b: m = 0.2;
        constraint bar { b == L*sin(a); }
        drive d: a == t/1s;
    }

    #[test]
    fn values_of_the_caller_are_not_matched() {
        assert_eq!(super::runs(Valued::default())[0], 0.1);
        assert_eq!((line!(), unreachable!()), ("not a number", "not this one"));
    }
}

mod two {
    //! Two mechanisms in one module, one of them private.

    use mbs_runtime::mechanism;

    mechanism! {
        /// One.
        pub(super) mechanism One;
        coord x: m;
        drive d: x == 1m;
    }
    mechanism! {
        mechanism Other;
        param x: m = 2;
        coord y: m;
        drive d: y == x;
    }

    #[test]
    fn two_mechanisms_live_side_by_side() {
        assert_eq!((super::runs(One::default()), super::runs(Other::default())), ([1.0], [2.0]));
        assert_eq!((OneCoordinates::from([3.0]).x, OtherCoordinates::from([4.0]).y), (3.0, 4.0));
    }
}

#[test]
fn a_mechanism_may_stand_in_a_function() {
    const LENGTH: u8 = 3;
    mbs_runtime::mechanism! {
        mechanism Local;
        const LENGTH: m = 2;
        coord x: m;
        drive d: x == LENGTH;
    }
    assert_eq!((runs(Local::default()), LENGTH), ([2.0], 3));
}

mod through_macros {
    //! Texts that a caller's macros write, from tokens and from parsed fragments.

    /// The tokens as they are.
    macro_rules! forwarded {
        ($($text:tt)*) => { mbs_runtime::mechanism! { $($text)* } };
    }

    forwarded! {
        /// Forwarded.
        pub(super) mechanism Forwarded;
        /// Length.
        param L: m = 2;
        coord x: m;
        drive d: x == L;
    }

    /// Every kind of fragment.
    macro_rules! parsed {
        (
            $(#[$attribute:meta])* $visibility:vis $name:ident, $unit:ty, $length:literal,
            $count:expr, $coordinate:ident, $value:expr, $constant:item
        ) => {
            mbs_runtime::mechanism! {
                $(#[$attribute])*
                $visibility mechanism $name;
                $constant
                param L: [$unit; $count] = [$length, -$length];
                coord $coordinate: [$unit; $count];
                constraint c { for i in 0..$count { $coordinate[i] == L[i] + 2*$value - $value/HALF; } }
                out y: m = $value^2/1m - $coordinate[$count - 1];
            }
        };
    }

    parsed! {
        /// Parsed.
        #[allow(dead_code)]
        pub(super) Parsed, m, 0.5, 1 + 1, x, L[0] + 1m, const HALF: rad = 0.5;
    }

    #[test]
    fn the_text_of_a_macro_means_what_it_says() {
        assert_eq!(super::runs(Forwarded::default()), [2.0]);
        // The value is a sum, and is one operand wherever the macro puts it: 2·v − v/0.5 is 0.
        let parsed = Parsed::<f64>::default();
        assert_eq!(super::runs(parsed), [0.5, -0.5]);
        let source = <Parsed as mbs_runtime::Mechanism<f64, 2, 2>>::SOURCE;
        assert!(mbs_codegen::expand_source(source).is_ok(), "{source}");
    }
}

#[test]
fn a_source_that_a_macro_wrote_expands_to_the_same_code() {
    let source = <through_macros::Forwarded as Mechanism<f64, 1, 1>>::SOURCE;
    let expected = "/// Forwarded.\npub(super) mechanism Forwarded;\n/// Length.\nparam L: m = 2;\ncoord x: m;\n\
                    drive d: x == L;";
    assert_eq!(source, expected);
}

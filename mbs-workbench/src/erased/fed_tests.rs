use mbs_runtime::mechanism;

use super::*;

mechanism! {
    pub mechanism Pushed;
    param m: kg = 2;
    param mu: 1 = 0.2;
    input thrust: N;
    coord x: m = 0.1;
    coord y: m = 0;
    constraint floor { y == 0; }
    body block { mass: m, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    force motor: [thrust, 0] on [x, y];
    friction slide { along: x, normal: lambda(floor), coefficient: mu, speed: 1mm/1s }
    contact stop { gap: 0.5m - x, stiffness: 1e5, damping: 0.5 }
    state heat: J = 0;
    der(heat) == 1N*der(x);
    start x = 0.1 rate 0.5;
    limit range: 0 <= x <= 1m;
    independent x;
    out speed: m/s = der(x);
}

/// Constants and functions of a trait, in the source of the runtime.
fn items(source: &str, name: &str) -> Vec<String> {
    let from = source.find(&format!("pub trait {name}<")).expect("the trait");
    let source = &source[from..];
    let source = &source[..source.find("\n}\n").expect("its end")];
    let named = source.lines().filter_map(|line| {
        let item = ["    const ", "    fn "].iter().find_map(|start| line.strip_prefix(start))?;
        Some(item.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect())
    });
    named.collect()
}

/// Functions that are made of the others, and the bounds of intervals, which know no courses of inputs.
const OWN: [&str; 5] = ["evaluate", "reference", "variable", "enclosed", "differential"];

/// Those with a standard in the trait would be missed in silence.
#[test]
fn every_constant_and_function_of_the_mechanism_is_forwarded() {
    let kinematic = include_str!("../../../mbs-runtime/src/mechanism/mod.rs");
    let dynamic = include_str!("../../../mbs-runtime/src/mechanism/dynamic.rs");
    let wrapper = [include_str!("fed.rs"), include_str!("branching.rs")];
    let mut missing = Vec::new();
    let mut count = 0;
    for (source, name) in
        [(kinematic, "Mechanism"), (kinematic, "Kinematic"), (dynamic, "Partitioned"), (dynamic, "Dynamic")]
    {
        for item in items(source, name) {
            count += 1;
            // Constants of `Mechanism` are forwarded by a list that `branching.rs` has.
            let places = if name == "Mechanism" { &wrapper[..] } else { &wrapper[..1] };
            let is_forwarded = places.iter().any(|wrapper| {
                let forms = [format!("const {item}:"), format!("fn {item}("), format!("fn {item}<")];
                forms.iter().any(|form| wrapper.contains(form))
            });
            if !is_forwarded && !OWN.contains(&item.as_str()) {
                missing.push(format!("{name}::{item}"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
    assert!(count > 85, "{count}");
}

/// Every constant of the wrapper is that of the mechanism, but that it has signals.
fn assert_constants<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(_: S) {
    macro_rules! compare {
        ($(const $name:ident: $type:ty;)*) => {
            $(assert_eq!(
                format!("{:?}", <Fed<S> as Mechanism<f64, N, M>>::$name),
                format!("{:?}", S::$name),
                stringify!($name)
            );)*
        };
    }
    constants!(compare);
    const { assert!(<Fed<S> as Mechanism<f64, N, M>>::HAS_SIGNALS) };
    macro_rules! same {
        ($contract:ident: $($name:ident),*) => {
            $(assert_eq!(
                format!("{:?}", <Fed<S> as $contract<f64, N, M>>::$name),
                format!("{:?}", <S as $contract<f64, N, M>>::$name),
                stringify!($name)
            );)*
        };
    }
    same!(Partitioned: IS_PARTITIONED, INDEPENDENT, IS_UNCOUPLED, IS_SPARSE);
    same!(Dynamic: FORCE_USES_MULTIPLIERS, STARTED, STARTED_RATES, STATES, FORCES, LOADS, CONTACTS, NON_NEGATIVE);
    assert_eq!(
        <Fed<S> as Dynamic<f64, N, M>>::MISSING_SLOPE.is_some(),
        <S as Dynamic<f64, N, M>>::MISSING_SLOPE.is_some()
    );
}

#[test]
fn every_constant_is_that_of_the_mechanism() {
    assert_constants(Pushed::<f64>::default());
}

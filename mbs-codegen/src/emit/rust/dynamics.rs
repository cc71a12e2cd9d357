//! Bodies of the functions of masses and forces.

use std::fmt::Write;

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use crate::emit::rust::code::{array, block, body, lets, matrix};
use crate::emit::rust::contacts::{self, Blocks};
use crate::emit::rust::events;
use crate::emit::rust::scope::{Scope, number};
use crate::emit::rust::set_valued;
use crate::equations::deferred::Slopes;
use crate::equations::normal_forces::{NormalForces, NormalFunction};
use crate::equations::{Dynamics, Equations, Gap, Of, Slope, Sparse};
use crate::model::Model;
use crate::program::{DynamicsProgram, Program};
use crate::symbolic::NodeId;

/// Bodies of the functions of `Dynamic`.
pub struct DynamicBodies {
    /// Not a body: `true` if `force` reads the multipliers.
    pub force_uses_multipliers: bool,
    pub start_states: TokenStream,
    pub start_rates: TokenStream,
    /// Not a body: the table of the values that must be non-negative and its function, where there are any.
    pub signed: TokenStream,
    /// Not a body: the function that is left out, where one is.
    pub missing: TokenStream,
    /// Not a body: the table of contacts and the function of their gaps, where there are any.
    pub gaps: TokenStream,
    /// Not a body: the table of frictions with stiction and the function of their rows, where there are any.
    pub set_valued: TokenStream,
    /// Not a body: the table of events and the function of their conditions, where there are any.
    pub events: TokenStream,
    /// Not a body: the function of the rates of working ranges, where there are any.
    pub limit_rates: TokenStream,
    pub mass: TokenStream,
    pub mass_times: TokenStream,
    pub force: TokenStream,
    pub force_q: TokenStream,
    pub force_qd: TokenStream,
    /// Present if the force depends on the multipliers.
    pub force_lambda: Option<TokenStream>,
    /// Present if it does so as a sum of multipliers, their absolute values and norms.
    pub normal_forces: Option<TokenStream>,
    pub mass_times_q: TokenStream,
    pub reaction: TokenStream,
    pub reaction_q: TokenStream,
    /// Present if it needs no derivative of a declared function that nothing else needs.
    pub third: Option<TokenStream>,
    pub energy: TokenStream,
    pub powers: TokenStream,
    /// Present if time alone changes the energies.
    pub carried: Option<TokenStream>,
    pub state_rates: TokenStream,
    /// Present if the text has first-order states.
    pub state_slopes: Option<TokenStream>,
    pub loads: TokenStream,
}

/// Before: the program of a model. After: one body a function, where the text has masses or forces.
pub fn bodies(
    equations: &Equations,
    program: &Program,
    early: &Scope<'_>,
    scope: &Scope<'_>,
    runtime: &TokenStream,
) -> Option<DynamicBodies> {
    let (dynamics, program) = (equations.dynamics.as_ref()?, program.dynamics.as_ref()?);
    let energy = format!(
        "__mbs::Energy {{ kinetic: {}, potential: {} }}",
        scope.or_zero(dynamics.kinetic),
        scope.or_zero(dynamics.potential)
    );
    let vector =
        |nodes: &[Option<crate::symbolic::NodeId>], scope: &Scope<'_>| array(nodes.iter().copied(), scope);
    let of = |section, result: String| body(section, scope, &result, runtime);
    let is_missing = |slopes| dynamics.missing.iter().any(|missing| missing.slopes == slopes);
    let slopes_or_nan = |slopes: Slopes, rows: &Sparse| {
        let (n, nan) = (rows.len(), number(f64::NAN));
        if is_missing(slopes) { format!("[[{nan}; {n}]; {n}]") } else { matrix(rows.iter(), scope) }
    };
    let blocks = dynamics.by_contact.as_ref().zip(program.by_contact.as_ref());
    let blocks = blocks.map(|(by_contact, program)| Blocks {
        by_contact,
        gaps: &dynamics.gaps,
        program,
        scope,
        runtime,
    });
    let contact_slopes = |slopes, by_velocity| {
        blocks.as_ref().filter(|_| !is_missing(slopes)).map(|blocks| blocks.slopes(by_velocity))
    };
    Some(DynamicBodies {
        force_uses_multipliers: dynamics.force_uses_multipliers,
        start_states: body(&program.start_states, early, &vector(&dynamics.start_states, early), runtime),
        start_rates: body(&program.start_rates, early, &vector(&dynamics.start_rates, early), runtime),
        signed: signed(dynamics, program, early, runtime),
        missing: missing(dynamics, scope.model, runtime),
        gaps: gaps(dynamics, program, scope, runtime),
        set_valued: set_valued::items(&dynamics.set_valued, &program.set_valued, scope, runtime),
        events: events::items(&dynamics.events, &program.events, scope, runtime),
        limit_rates: limit_rates(dynamics, program, scope, runtime),
        mass: of(&program.mass, matrix(dynamics.mass.iter(), scope)),
        mass_times: of(&program.mass_times, vector(&dynamics.mass_times, scope)),
        force: match &blocks {
            Some(blocks) => blocks.force(),
            None => of(&program.force, vector(&dynamics.force, scope)),
        },
        force_q: contact_slopes(Slopes::ForceByPlace, false)
            .unwrap_or_else(|| of(&program.force_q, slopes_or_nan(Slopes::ForceByPlace, &dynamics.force_q))),
        force_qd: contact_slopes(Slopes::ForceBySpeed, true).unwrap_or_else(|| {
            of(&program.force_qd, slopes_or_nan(Slopes::ForceBySpeed, &dynamics.force_qd))
        }),
        force_lambda: dynamics.force_uses_multipliers.then(|| {
            let (n, m) = (scope.model.coordinates.len(), scope.model.rows.len());
            let zeros = format!("let mut __rows = [[{}; {m}]; {n}];\n", scope.or_zero(None));
            of(&program.force_lambda, zeros + &assigned("__rows", &dynamics.force_lambda, scope) + "__rows")
        }),
        normal_forces: dynamics.normal_forces.as_ref().map(|forces| {
            let result = normal_forces(forces, scope);
            let (m, k) = (scope.model.rows.len(), forces.terms.len());
            let mut text = format!("let __lambda = [{}; {}];\n", scope.or_zero(None), m + k);
            lets(&program.normal_forces, scope, &mut text);
            block(&(text + &result), runtime)
        }),
        mass_times_q: of(&program.mass_times_q, slopes_or_nan(Slopes::Inertia, &dynamics.mass_times_q)),
        reaction: of(&program.reaction, vector(&dynamics.reaction, scope)),
        reaction_q: of(&program.reaction_q, slopes_or_nan(Slopes::Reaction, &dynamics.reaction_q)),
        third: dynamics.third.as_ref().map(|third| {
            let (row, right) = (vector(&third.row, scope), scope.or_zero(third.right));
            of(&program.third, format!("::core::option::Option::Some(({row}, {right}))"))
        }),
        energy: of(&program.energy, energy),
        powers: match &blocks {
            Some(blocks) => blocks.powers(&dynamics.powers),
            None => of(&program.powers, vector(&dynamics.powers, scope)),
        },
        carried: dynamics.carried.map(|power| {
            let result = format!("::core::option::Option::Some({})", scope.operand(power));
            of(&program.carried, result)
        }),
        state_slopes: (!dynamics.slopes.is_empty())
            .then(|| of(&program.slopes, slopes(&dynamics.slopes, scope))),
        state_rates: of(&program.state_rates, vector(&dynamics.state_rates, scope)),
        loads: of(&program.loads, array(dynamics.loads.iter().map(|id| Some(*id)), scope)),
    })
}

/// Assignments of the entries of a matrix to those of `rows`.
fn assigned(rows: &str, matrix: &Sparse, scope: &Scope<'_>) -> String {
    let mut text = String::new();
    for (row, entries) in matrix.iter().enumerate() {
        for (column, entry) in entries {
            let _ = writeln!(text, "{rows}[{row}][{column}] = {};", scope.operand(*entry));
        }
    }
    text
}

/// Terms of Q in the multipliers, handed to the visitor.
fn normal_forces(forces: &NormalForces, scope: &Scope<'_>) -> String {
    let kinds = forces.terms.iter().map(|term| match term.kind {
        NormalFunction::Multiplier => "__mbs::dynamics::Term::Multiplier",
        NormalFunction::Absolute => "__mbs::dynamics::Term::Absolute",
        NormalFunction::Norm => "__mbs::dynamics::Term::Norm",
    });
    let kinds = kinds.collect::<Vec<_>>().join(", ");
    let (n, m) = (scope.model.coordinates.len(), scope.model.rows.len());
    let mut text = format!(
        "let mut __forces = __mbs::dynamics::NormalForces::<T, {n}, {m}, {}>::of([{kinds}]);\n",
        forces.terms.len()
    );
    text += &assigned("__forces.force", &forces.force, scope);
    for (index, term) in forces.terms.iter().enumerate() {
        for (component, offset) in term.components.iter().enumerate() {
            let _ = writeln!(text, "__forces.offset[{index}][{component}] = {};", scope.operand(*offset));
        }
        text += &assigned(&format!("__forces.by_multiplier[{index}]"), &term.by_multiplier, scope);
        text += &assigned(&format!("__forces.by_term[{index}]"), &term.by_term, scope);
    }
    text + &format!(
        "::core::option::Option::Some(<__See as __mbs::dynamics::WithNormalForces<T, {n}, {m}>>::at(__see, &__forces))"
    )
}

/// Values that must be non-negative: their table, and the function that evaluates them.
fn signed(
    dynamics: &Dynamics,
    program: &DynamicsProgram,
    early: &Scope<'_>,
    runtime: &TokenStream,
) -> TokenStream {
    let model = early.model;
    let Some(declared) = model.dynamics.as_ref().filter(|_| !dynamics.signed.is_empty()) else {
        return TokenStream::new();
    };
    let entries = dynamics.signed.iter().filter_map(|signed| {
        let (name, span) = match signed.of {
            Of::Field(index) => {
                let value = declared.signed.get(index)?;
                (format!("{}.{}", value.of, value.field), value.span)
            }
            Of::Inertia(index, condition) => {
                let inertia = declared.inertias.get(index)?;
                (format!("{}.inertia, {}", inertia.of, condition.name()), inertia.span)
            }
        };
        let parameter = model.variables.get(usize::try_from(signed.parameter).ok()?)?.name.as_str();
        let line = quote_spanned!(span=> ::core::line!());
        Some(quote! { #runtime::NonNegative { name: #name, line: #line, parameter: #parameter } })
    });
    let values = array(dynamics.signed.iter().map(|signed| Some(signed.node)), early);
    let show = body(&program.signed, early, &format!("{values}.into_iter().for_each(__see)"), runtime);
    quote! {
        const NON_NEGATIVE: &'static [#runtime::NonNegative] = &[#(#entries),*];
        fn signed(&self, __p: &__Parameters<T>, __see: impl FnMut(T)) #show
    }
}

/// The first of the functions that are left out, with the declared function that is not smooth enough for it.
fn missing(dynamics: &Dynamics, model: &Model, runtime: &TokenStream) -> TokenStream {
    let first = dynamics.missing.first();
    let Some((missing, function)) =
        first.and_then(|missing| Some((missing, model.functions.get(missing.function)?)))
    else {
        return TokenStream::new();
    };
    let (slope, order, declared) = (missing.slopes.name(), missing.order, function.continuity);
    let acts_at_rest = missing.slopes.acts_at_rest();
    let (name, unit) = (function.label(), &function.unit);
    let line = quote_spanned!(function.name.span=> ::core::line!());
    quote! {
        const MISSING_SLOPE: ::core::option::Option<&'static #runtime::MissingSlope> =
            ::core::option::Option::Some(&#runtime::MissingSlope {
                slope: #slope,
                function: #runtime::Entry { name: #name, unit: #unit, line: #line },
                order: #order,
                declared: #declared,
                acts_at_rest: #acts_at_rest,
            });
    }
}

/// Number of contacts, where their forces are evaluated one by one.
pub fn contacts(equations: &Equations) -> Option<usize> {
    let dynamics = equations.dynamics.as_ref()?;
    dynamics.by_contact.as_ref().map(|_| dynamics.gaps.len())
}

/// Number of frictions with stiction, where there are any.
pub fn frictions(equations: &Equations) -> Option<usize> {
    let count = equations.dynamics.as_ref()?.set_valued.len();
    (count > 0).then_some(count)
}

/// The contacts: their table, and the function that evaluates their gaps.
fn gaps(
    dynamics: &Dynamics,
    program: &DynamicsProgram,
    scope: &Scope<'_>,
    runtime: &TokenStream,
) -> TokenStream {
    let Some(declared) = scope.model.dynamics.as_ref().filter(|_| !dynamics.gaps.is_empty()) else {
        return TokenStream::new();
    };
    let entries = declared.contacts.iter().map(|contact| {
        let (name, line) = (&contact.name, quote_spanned!(contact.span=> ::core::line!()));
        quote! { #runtime::Entry { name: #name, unit: "m", line: #line } }
    });
    let gap = |gap: &Gap| {
        let bound = match gap.bound {
            Some(bound) => format!("::core::option::Option::Some({})", scope.operand(bound)),
            None => "::core::option::Option::None".to_owned(),
        };
        let (gap, rate) = (scope.operand(gap.gap), scope.or_zero(gap.rate));
        format!("__mbs::Gap {{ gap: {gap}, rate: {rate}, bound: {bound} }}")
    };
    let values: Vec<String> = dynamics.gaps.iter().map(gap).collect();
    let result = format!("[{}].into_iter().for_each(__see)", values.join(", "));
    let show = body(&program.gaps, scope, &result, runtime);
    let n = scope.model.coordinates.len();
    let access = dynamics.by_contact.as_ref().map(|_| contacts::access());
    quote! {
        const CONTACTS: &'static [#runtime::Entry] = &[#(#entries),*];
        #access
        fn gaps(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; #n],
            __see: impl FnMut(#runtime::Gap<T>),
        ) #show
    }
}

/// The function that evaluates the rates of working ranges.
fn limit_rates(
    dynamics: &Dynamics,
    program: &DynamicsProgram,
    scope: &Scope<'_>,
    runtime: &TokenStream,
) -> TokenStream {
    if dynamics.limit_rates.is_empty() {
        return TokenStream::new();
    }
    let rates = |[low, value, high]: &[Option<NodeId>; 3]| {
        let of = |id: &Option<NodeId>| scope.or_zero(*id);
        format!("__mbs::Limit {{ low: {}, value: {}, high: {} }}", of(low), of(value), of(high))
    };
    let values: Vec<String> = dynamics.limit_rates.iter().map(rates).collect();
    let result = format!("[{}].into_iter().for_each(__see)", values.join(", "));
    let show = body(&program.limit_rates, scope, &result, runtime);
    let n = scope.model.coordinates.len();
    quote! {
        fn limit_rates(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; #n],
            __see: impl FnMut(#runtime::Limit<T>),
        ) #show
    }
}

/// One struct a first-order state, in `Some`.
fn slopes(slopes: &[Slope], scope: &Scope<'_>) -> String {
    let slope = |slope: &Slope| {
        let [force, q, qd, states] = [&slope.force, &slope.q, &slope.qd, &slope.states]
            .map(|nodes| array(nodes.iter().copied(), scope));
        format!("__mbs::StateSlope {{ force: {force}, q: {q}, qd: {qd}, states: {states} }}")
    };
    let slopes: Vec<String> = slopes.iter().map(slope).collect();
    format!("::core::option::Option::Some([{}])", slopes.join(", "))
}

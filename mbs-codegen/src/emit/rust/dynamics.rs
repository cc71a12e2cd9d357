//! The emitted code of masses and forces: `impl Dynamic`.

use std::collections::BTreeSet;
use std::fmt::Write;

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use crate::emit::rust::code::{block, lets};
use crate::emit::rust::contacts::{self, Blocks};
use crate::emit::rust::functions::{array, body, matrix};
use crate::emit::rust::scope::{Scope, number};
use crate::equations::deferred::Slopes;
use crate::equations::normal_forces::{NormalForces, NormalFunction};
use crate::equations::{Dynamics, Equations, Gap, Of, Slope, Sparse};
use crate::model::Model;
use crate::model::dynamics::Dynamics as Declared;
use crate::model::expression::Node;
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

impl DynamicBodies {
    /// The same body for every function.
    pub fn all(body: impl Fn() -> TokenStream) -> Self {
        DynamicBodies {
            force_uses_multipliers: true,
            start_states: body(),
            start_rates: body(),
            signed: TokenStream::new(),
            missing: TokenStream::new(),
            gaps: TokenStream::new(),
            limit_rates: TokenStream::new(),
            mass: body(),
            mass_times: body(),
            force: body(),
            force_q: body(),
            force_qd: body(),
            force_lambda: None,
            normal_forces: None,
            mass_times_q: body(),
            reaction: body(),
            reaction_q: body(),
            third: None,
            energy: body(),
            powers: body(),
            carried: None,
            state_rates: body(),
            state_slopes: None,
            loads: body(),
        }
    }
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
    let blocks = blocks.map(|(by_contact, program)| Blocks { by_contact, program, scope, runtime });
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
    let (name, unit) = (&function.name.text, &function.unit);
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

/// `impl Dynamic` of a text with masses or forces.
pub fn implementation(
    name: &TokenStream,
    model: &Model,
    (bodies, generics, enclosed): (&DynamicBodies, &TokenStream, &TokenStream),
    runtime: &TokenStream,
) -> TokenStream {
    let Some(declared) = &model.dynamics else { return TokenStream::new() };
    let (n, m) = (model.coordinates.len(), model.rows.len());
    let (states, forces, loads) = (declared.states.len(), declared.forces.len(), declared.loads.len());
    let tables = tables(declared, runtime);
    let starts = starts(model, declared);
    let DynamicBodies {
        force_uses_multipliers,
        start_states,
        start_rates,
        signed,
        missing,
        gaps,
        limit_rates,
        mass,
        mass_times,
        force,
        force_q,
        force_qd,
        force_lambda,
        normal_forces,
        mass_times_q,
        reaction,
        reaction_q,
        third,
        energy,
        powers,
        carried,
        state_rates,
        state_slopes,
        loads: loads_body,
    } = bodies;
    let carried = carried.as_ref().map(|body| {
        quote! {
            #[inline]
            fn carried(
                &self,
                __p: &__Parameters<T>,
                __s: &__Position<T>,
                __qd: &[T; #n],
                __qdd: &[T; #n],
            ) -> ::core::option::Option<T> #body
        }
    });
    let third = third.as_ref().map(|body| {
        quote! {
            #[inline]
            fn third_derivative(
                &self,
                __p: &__Parameters<T>,
                __s: &__Position<T>,
                __qd: &[T; #n],
                __lambda: &[T; #m],
            ) -> ::core::option::Option<([T; #n], T)> #body
        }
    });
    let design = quote! { &self, __p: &__Parameters<T>, __s: &__Position<T> };
    let motion = quote! { __qd: &[T; #n], __z: &[T; #states], __lambda: &[T; #m] };
    let state_slopes = state_slopes.as_ref().map(|body| {
        quote! {
            #[inline]
            fn state_slopes(#design, #motion) -> ::core::option::Option<Self::StateSlopes> #body
        }
    });
    let force_lambda = force_lambda.as_ref().map(|body| {
        quote! {
            #[inline]
            fn force_lambda(#design, #motion) -> [[T; #m]; #n] #body
        }
    });
    let normal_forces = normal_forces.as_ref().map(|body| {
        quote! {
            #[inline]
            fn normal_forces<__See: #runtime::dynamics::WithNormalForces<T, #n, #m>>(
                #design,
                __qd: &[T; #n],
                __z: &[T; #states],
                __see: __See,
            ) -> ::core::option::Option<__See::Output> #body
        }
    });
    quote! {
        impl<#generics> #runtime::Dynamic<T, #n, #m> for #name {
            type States = [T; #states];
            type StateSlopes = [#runtime::StateSlope<T, #n, [T; #states]>; #states];
            type Powers = [T; #forces];
            type Loads = [T; #loads];
            const FORCE_USES_MULTIPLIERS: ::core::primitive::bool = #force_uses_multipliers;
            #starts
            #tables
            #[inline]
            fn start_states(&self, __p: &__Parameters<T>) -> [T; #states] #start_states
            #[inline]
            fn start_rates(&self, __p: &__Parameters<T>) -> [T; #n] #start_rates
            #signed
            #missing
            #gaps
            #limit_rates
            #enclosed
            #[inline]
            fn mass(#design) -> [[T; #n]; #n] #mass
            #[inline]
            fn mass_times(#design, __x: &[T; #n]) -> [T; #n] #mass_times
            #[inline]
            fn force(#design, #motion) -> [T; #n] #force
            #[inline]
            fn force_q(#design, #motion) -> [[T; #n]; #n] #force_q
            #[inline]
            fn force_qd(#design, #motion) -> [[T; #n]; #n] #force_qd
            #force_lambda
            #normal_forces
            #[inline]
            fn mass_times_q(#design, __x: &[T; #n]) -> [[T; #n]; #n] #mass_times_q
            #[inline]
            fn reaction(#design, __lambda: &[T; #m]) -> [T; #n] #reaction
            #[inline]
            fn reaction_q(#design, __lambda: &[T; #m]) -> [[T; #n]; #n] #reaction_q
            #third
            #[inline]
            fn energy(#design, __qd: &[T; #n]) -> #runtime::Energy<T> #energy
            #[inline]
            fn powers(#design, #motion) -> [T; #forces] #powers
            #carried
            #[inline]
            fn state_rates(#design, #motion) -> [T; #states] #state_rates
            #state_slopes
            #[inline]
            fn loads(
                #design,
                __motion: &#runtime::DynamicState<'_, T, #n, #m, [T; #states]>,
            ) -> [T; #loads] {
                let #runtime::DynamicState { qd: __qd, qdd: __qdd, lambda: __lambda, states: __z } = *__motion;
                #loads_body
            }
        }
    }
}

/// Coordinates that the text starts; empty where it starts none. The start of a coordinate that a drive holds is a guess.
fn starts(model: &Model, declared: &Declared) -> TokenStream {
    let sorted = |indices: &mut dyn Iterator<Item = usize>| {
        let indices = indices.filter(|index| !is_driven(model, *index));
        let indices: BTreeSet<u16> = indices.filter_map(|index| u16::try_from(index).ok()).collect();
        indices.into_iter().collect::<Vec<u16>>()
    };
    let positions = sorted(&mut declared.started.iter().copied());
    let rates = sorted(&mut declared.rates.iter().map(|(index, _)| *index));
    if positions.is_empty() {
        return TokenStream::new();
    }
    quote! {
        const STARTED: &'static [u16] = &[#(#positions),*];
        const STARTED_RATES: &'static [u16] = &[#(#rates),*];
    }
}

/// `true` if a drive prescribes a coordinate's value, not its rate alone.
fn is_driven(model: &Model, index: usize) -> bool {
    let is_phase = |node| matches!(node, Node::Variable(variable) if model.phases.iter().any(|phase| phase.variable == variable));
    model.rows.iter().filter(|row| row.driven).any(|row| {
        let contains = |is: &dyn Fn(Node) -> bool| model.expressions.contain(row.residual, is);
        contains(&|node| matches!(node, Node::Coordinate(own) if own == index))
            && !contains(&|node| matches!(node, Node::Coordinate(other) if other != index))
            && !contains(&is_phase)
    })
}

/// Names, units and lines as constants.
fn tables(declared: &Declared, runtime: &TokenStream) -> TokenStream {
    let entry = |name: &str, unit: &str, span: proc_macro2::Span| {
        let line = quote_spanned!(span=> ::core::line!());
        quote! { #runtime::Entry { name: #name, unit: #unit, line: #line } }
    };
    let states = declared.states.iter().map(|state| entry(&state.name, &state.unit, state.span));
    let forces = declared.forces.iter().map(|force| entry(&force.name, "W", force.span));
    let loads = declared.loads.iter().map(|load| entry(&load.name, &load.unit, load.span));
    quote! {
        const STATES: &'static [#runtime::Entry] = &[#(#states),*];
        const FORCES: &'static [#runtime::Entry] = &[#(#forces),*];
        const LOADS: &'static [#runtime::Entry] = &[#(#loads),*];
    }
}

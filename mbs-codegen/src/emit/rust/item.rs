//! The emitted items: struct, views, tables, trait implementations.

use proc_macro2::TokenStream;
use quote::quote;

use crate::diagnostics::Diagnostics;
use crate::emit::rust::SceneFunctions;
use crate::emit::rust::dynamic_trait;
use crate::emit::rust::fields::{
    access, array_type, constructors, enclosed, field_docs, field_type, function_docs, ident,
    in_other_numbers, in_part, markers,
};
use crate::emit::rust::functions::Bodies;
use crate::emit::rust::generics::Generics;
use crate::emit::rust::partitioned::{inlined, partitioned, unpartitioned};
use crate::emit::rust::scenes;
use crate::emit::rust::tables::tables;
use crate::emit::rust::view::{coordinates_view, outputs_view, stepper_alias};
use crate::model::Model;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::syntax::Text;

/// Before: bodies of all functions of all scenes. After: everything that the user's module gets.
pub fn item(
    text: &Text,
    scenes: &Scenes,
    parts: &[SceneFunctions<'_>],
    left_out: Option<&Diagnostics>,
) -> TokenStream {
    let header = &text.header;
    let (visibility, name, runtime) = (&header.visibility, &header.name, &header.runtime);
    let attributes = &header.attributes;
    let shared = &scenes.shared;
    let fields = shared.fields.iter().map(|field| {
        let (docs, ident, kind) = (field_docs(field, shared), ident(&field.name), field_type(field, runtime));
        quote! { #(#[doc = #docs])* pub #ident: #kind, }
    });
    let generics = Generics::of(text, scenes);
    let functions = shared.functions.iter().zip(generics.functions()).map(|(function, kind)| {
        let (docs, ident) = (function_docs(function), ident(&function.name));
        let kind = array_type(quote! { #kind }, &function.shape());
        quote! { #(#[doc = #docs])* pub #ident: #kind, }
    });
    let (declared, declaration) = (generics.declared(runtime), markers(scenes).declaration);
    let constructors = constructors(text, scenes, &generics);
    let docs = scenes::docs(text, scenes, parts, left_out);
    let of_scenes = scenes::items(text, scenes, parts);
    let views = parts.iter().map(|part| {
        let (coordinates, outputs) = (coordinates_view(text, part.scene), outputs_view(text, part.scene));
        let stepper = part.square.then(|| stepper_alias(text, scenes, part.scene));
        quote! { #coordinates #outputs #stepper }
    });
    let private = parts.iter().map(|part| implementations(text, scenes, part));
    quote! {
        #(#attributes)*
        #(#[doc = #docs])*
        #[allow(non_snake_case, reason = "the text names the parameters")]
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq)]
        #visibility struct #name<#declared> { #(#fields)* #(#functions)* #declaration }

        #constructors

        #of_scenes
        #(#views)*
        #(#private)*
    }
}

/// Trait implementations, with the types that only they name.
fn implementations(text: &Text, scenes: &Scenes, part: &SceneFunctions<'_>) -> TokenStream {
    let runtime = &text.header.runtime;
    let SceneFunctions { scene, bodies, .. } = part;
    let model = &scene.model;
    let name = scenes::type_in(text, scenes, scene, &quote! { T });
    let lane = scenes::type_in(text, scenes, scene, &quote! { T::Real });
    let callable = Generics::of(text, scenes).callable(model, runtime);
    let m = model.rows.len();
    let kinematic = part.square.then(|| {
        let group = group(text, scenes, scene, &lane);
        kinematic(&name, (model, m), (bodies, &callable, &group), runtime)
    });
    // Surplus rows leave multipliers open that only all rows together determine.
    let is_partitioned = model.dynamics.is_some() && !part.surplus;
    let partitioned = model.dynamics.as_ref().map(|_| match is_partitioned {
        true => partitioned(&name, (model, m), (part, &callable), runtime),
        false => unpartitioned(&name, (model, m), &callable, runtime),
    });
    let factors = (part.square || is_partitioned).then_some(&bodies.factors);
    let dynamic = bodies.dynamics.as_ref().map(|bodies| {
        let intervals = scenes::type_in(text, scenes, scene, &quote! { #runtime::Interval<T::Real> });
        let enclosed = enclosed(text, scenes, &intervals, (model, m));
        dynamic_trait::implementation(&name, model, (bodies, &callable, &enclosed), runtime)
    });
    let revealed = revealed(text, scenes, part, m);
    let (n, branches, outputs) = (model.coordinates.len(), model.branches.len(), model.outputs.len());
    let (limits, phase_count) = (model.limits.len(), model.phases.len());
    let variable_count = model.variables.len();
    let tables = tables(text, scenes, scene, bodies);
    let access = access(text, scenes, model);
    let Bodies {
        orders: _,
        kept_parameters,
        kept_position,
        parameters,
        guess,
        coordinate_scales,
        row_scales,
        widths,
        position,
        phi,
        phi_q,
        phi_q_entries,
        sparsity,
        phi_t,
        phi_tt,
        phi_qt_qd,
        gamma,
        evaluate,
        branches: branches_body,
        limits: limits_body,
        phases,
        speeds,
        outputs: outputs_body,
        ..
    } = bodies;
    let nonzeros = sparsity.len();
    let frictions = bodies.frictions.or(bodies.remembered.map(|_| 0));
    let contacts = bodies.contacts.or(frictions.map(|_| 0));
    let closed = contacts.map(|contacts| quote! { , [::core::primitive::bool; #contacts] });
    let modes = frictions.map(|count| quote! { , [#runtime::dynamics::SetValuedMode<T>; #count] });
    let remembered = bodies.remembered.map(|count| quote! { , [T; #count] });
    let places = sparsity.iter().map(|(row, column)| quote! { (#row, #column) });
    let widths = widths.as_ref().map(|widths| {
        quote! {
            #[inline]
            fn widths(&self, __p: &__Parameters<T>) -> [T; #m] #widths
        }
    });
    let evaluate = evaluate.as_ref().map(|evaluate| {
        quote! {
            #[inline]
            fn evaluate(
                &self,
                __p: &__Parameters<T>,
                __q: &[T; #n],
                __t: T,
                __qd: &[T; #n],
            ) -> #runtime::Evaluation<T, [T; #nonzeros], #m> #evaluate
        }
    });
    // They are not called where the rows of a text do not fix the coordinates.
    let methods = (part.square || is_partitioned).then_some(&bodies.methods).filter(|text| !text.is_empty());
    let parts = &bodies.parts;
    let own_item = match methods.is_none() && model.phases.is_empty() && parts.is_empty() {
        true => TokenStream::new(),
        false => quote! { impl<#callable> #name { #speeds #methods #parts } },
    };
    quote! {
        #[allow(clippy::approx_constant, reason = "numbers of the text stay as they are")]
        const _: () = {
            /// Values of parameters alone.
            #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
            pub struct __Parameters<T>([T; #kept_parameters] #closed #modes #remembered);

            /// Values of `(q, t)` that functions share.
            #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
            pub struct __Position<T>([T; #kept_position]);

            #own_item

            impl<#callable> #runtime::Mechanism<T, #n, #m> for #name {
                type Parameters = __Parameters<T>;
                type Position = __Position<T>;
                type Entries = [T; #nonzeros];
                type Branches = [T; #branches];
                type Limits = [#runtime::Limit<T>; #limits];
                type Phases = [#runtime::Phase<T>; #phase_count];
                type Values = [T; #variable_count];
                type Kept = [::core::primitive::f64; #variable_count];
                type Outputs = [#runtime::OutputValue<T>; #outputs];
                type Lane = #lane;
                #tables
                const SPARSITY: &'static [(::core::primitive::u16, ::core::primitive::u16)] = &[#(#places),*];
                #access
                #phases
                #[inline]
                fn parameters(&self) -> __Parameters<T> #parameters
                #[inline]
                fn guess(&self, __p: &__Parameters<T>) -> [T; #n] #guess
                #[inline]
                fn coordinate_scales(&self, __p: &__Parameters<T>) -> [T; #n] #coordinate_scales
                #[inline]
                fn row_scales(&self, __p: &__Parameters<T>) -> [T; #m] #row_scales
                #widths
                #[inline]
                fn position(&self, __p: &__Parameters<T>, __q: &[T; #n], __t: T) -> __Position<T> #position
                #[inline]
                fn phi(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; #m] #phi
                #[inline]
                fn phi_q(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [[T; #n]; #m] #phi_q
                #[inline]
                fn phi_q_entries(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; #nonzeros] #phi_q_entries
                #[inline]
                fn phi_t(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; #m] #phi_t
                #[inline]
                fn phi_tt(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; #m] #phi_tt
                #[inline]
                fn phi_qt_qd(&self, __p: &__Parameters<T>, __s: &__Position<T>, __qd: &[T; #n]) -> [T; #m] #phi_qt_qd
                #[inline]
                fn gamma(&self, __p: &__Parameters<T>, __s: &__Position<T>, __qd: &[T; #n]) -> [T; #m] #gamma
                #evaluate
                #[inline]
                fn branches(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; #branches] #branches_body
                #[inline]
                fn limits(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [#runtime::Limit<T>; #limits] #limits_body
                #[inline]
                fn outputs(
                    &self,
                    __p: &__Parameters<T>,
                    __s: &__Position<T>,
                    __qd: &[T; #n],
                    __qdd: &[T; #n],
                ) -> [#runtime::OutputValue<T>; #outputs] #outputs_body
            }

            #factors

            #kinematic
            #partitioned
            #dynamic
        };

        #revealed
    }
}

/// Coordinates and multipliers beyond which methods with dense matrices of all of them leave no room on the stack: the runtime's
/// `Radau5::MOST_UNKNOWNS`, with which `tests/house/tests/shared_numbers.rs` compares it.
const LARGE: usize = 120;

/// `impl Reveal`: the sizes and the traits of a scene; `impl InNumbers`: the scene in other numbers than double precision.
fn revealed(text: &Text, scenes: &Scenes, part: &SceneFunctions<'_>, m: usize) -> TokenStream {
    let (runtime, model) = (&text.header.runtime, &part.scene.model);
    let in_numbers = |numbers| scenes::type_in(text, scenes, part.scene, &numbers);
    let [name, double, other] =
        [quote! { T }, quote! { ::core::primitive::f64 }, quote! { __U }].map(in_numbers);
    let generics = Generics::of(text, scenes);
    let (generics, of_other) = (generics.revealed(model, runtime), generics.in_numbers(runtime));
    let fields = in_other_numbers(text, scenes);
    let n = model.coordinates.len();
    let method = match (model.dynamics.is_some(), part.square, n + m > LARGE) {
        (false, false, _) => "described",
        (false, true, _) => "kinematic",
        (true, false, false) => "free",
        (true, true, false) => "driven",
        (true, false, true) => "large_free",
        (true, true, true) => "large_driven",
    };
    let method = quote::format_ident!("{method}");
    quote! {
        impl<#generics> #runtime::Reveal<T> for #name {
            fn reveal<__V: #runtime::Visitor<Self, T>>(self, __visitor: __V) -> __V::Output {
                __visitor.#method::<#n, #m>(self)
            }
        }
        impl<#of_other> #runtime::InNumbers<__U> for #double {
            type Mechanism = #other;
            fn in_numbers(&self) -> Self::Mechanism { #fields }
        }
    }
}

/// The types and the function of `Kinematic` that take some lanes out of many. A function of the caller is known to take `T` and
/// single numbers alone.
fn group(text: &Text, scenes: &Scenes, scene: &Scene, lane: &TokenStream) -> TokenStream {
    let runtime = &text.header.runtime;
    let (number, group, first, value) = match scene.model.functions.as_slice() {
        [] => {
            let number = quote! { <T::Real as #runtime::Real>::Register };
            let group = scenes::type_in(text, scenes, scene, &number);
            let first = if scenes.shared.fields.is_empty() { "_first" } else { "__first" };
            (number, group, first, in_part(text, scenes))
        }
        _ => {
            (quote! { T::Real }, lane.clone(), "__first", quote! { #runtime::Mechanism::lane(self, __first) })
        }
    };
    let first = quote::format_ident!("{first}");
    quote! {
        type GroupNumber = #number;
        type Group = #group;
        #[inline]
        fn group(&self, #first: ::core::primitive::usize) -> Self::Group { #value }
    }
}

/// `impl Kinematic` with the factors that it keeps.
fn kinematic(
    name: &TokenStream,
    (model, m): (&Model, usize),
    (bodies, generics, group): (&Bodies, &TokenStream, &TokenStream),
    runtime: &TokenStream,
) -> TokenStream {
    let n = model.coordinates.len();
    let Bodies { solve_with_position, factorize, solve_linear, work, .. } = bodies;
    let (inline, factorize_inline) = (inlined(bodies.short), inlined(bodies.factorizes_in_line));
    let solve_blocks = match &bodies.solve_blocks {
        Some(body) => body.clone(),
        None => quote! { { #runtime::Kinematic::solve_with_position(self, __p, __q, __t, __solver).0 } },
    };
    let sizes = if m == n {
        quote! { #n }
    } else {
        quote! { #n, #m }
    };
    let solve_motion = bodies.solve_motion.as_ref().map(|body| {
        quote! {
            #inline
            fn solve_motion<__S: #runtime::BlockSolver<T>>(
                &self,
                __p: &__Parameters<T>,
                __motion: &mut [[T; #n]; 3],
                __t: T,
                __solver: &mut __S,
            ) -> #runtime::Solved<__Position<T>, T> #body
        }
    });
    let block_by_block =
        solve_motion.as_ref().map(|_| quote! { const BLOCK_BY_BLOCK: ::core::primitive::bool = true; });
    let has_circles =
        bodies.has_circles.then(|| quote! { const HAS_CIRCLES: ::core::primitive::bool = true; });
    let has_orders = (bodies.has_orders && solve_motion.is_some())
        .then(|| quote! { const HAS_ORDERS: ::core::primitive::bool = true; });
    quote! {
        impl<#generics> #runtime::WorstCase for #name {
            const WORK: #runtime::Work = #work;
        }
        impl<#generics> #runtime::Kinematic<T, #sizes> for #name {
            type Factors = __Factors<T>;
            #block_by_block
            #has_circles
            #has_orders
            #group
            #[inline]
            fn solve_blocks<__S: #runtime::BlockSolver<T>>(
                &self,
                __p: &__Parameters<T>,
                __q: &mut [T; #n],
                __t: T,
                __solver: &mut __S,
            ) -> T::Lanes<#runtime::Outcome> #solve_blocks
            #inline
            fn solve_with_position<__S: #runtime::BlockSolver<T>>(
                &self,
                __p: &__Parameters<T>,
                __q: &mut [T; #n],
                __t: T,
                __solver: &mut __S,
            ) -> (T::Lanes<#runtime::Outcome>, __Position<T>) #solve_with_position
            #factorize_inline
            fn factorize(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> (__Factors<T>, #runtime::Margin<T>) #factorize
            #solve_motion
            #inline
            fn solve_linear(&self, __factors: &__Factors<T>, __b: &[T; #m]) -> [T; #n] #solve_linear
        }
    }
}

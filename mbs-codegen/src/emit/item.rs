//! The emitted items: struct, views, tables, trait implementations.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote, quote_spanned};

use super::code::tokens;
use super::dynamics;
use super::functions::Bodies;
use super::generics::Generics;
use super::scope::{field_name, is_keyword, number, subscripts, variable};
use super::{Part, scenes};
use crate::diagnostics::Diagnostics;
use crate::model::scenes::{Scene, Scenes, alias};
use crate::model::{CoordinateField, Field, Function, Longest, Model, Role};
use crate::syntax::Text;
use crate::syntax::ast::Name;

/// Before: bodies of all functions of all scenes. After: everything that the user's module gets.
pub fn item(text: &Text, scenes: &Scenes, parts: &[Part<'_>], left_out: Option<&Diagnostics>) -> TokenStream {
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
        quote! { #(#[doc = #docs])* pub #ident: #kind, }
    });
    let (declared, declaration) = (generics.declared(runtime), markers(scenes).declaration);
    let constructors = constructors(text, scenes, &generics);
    let docs = scenes::docs(text, scenes, parts, left_out);
    let of_scenes = scenes::items(text, scenes, parts);
    let views = parts.iter().map(|part| coordinates_view(text, part.scene));
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

/// `Default`, and with declared functions `new`.
fn constructors(text: &Text, scenes: &Scenes, generics: &Generics) -> TokenStream {
    let (name, runtime, shared) = (&text.header.name, &text.header.runtime, &scenes.shared);
    let defaults = shared.fields.iter().map(|field| {
        let ident = ident(&field.name);
        let value = nested(&field.shape, &|component| default(shared, field, component));
        let value = tokens(&value, runtime);
        quote! { #ident: #value, }
    });
    let marker = markers(scenes).value;
    let arguments = generics.arguments(&quote! { T }, generics.scene());
    let allow = quote! {
        #[allow(clippy::approx_constant, reason = "numbers of the text stay as they are")]
    };
    let default = quote! { ::core::default::Default };
    let defaulted = generics.of_all_scenes(runtime, &quote! { : #default });
    if shared.functions.is_empty() {
        return quote! {
            #allow
            impl<#defaulted> #default for #name<#arguments> {
                fn default() -> Self {
                    Self { #(#defaults)* #marker }
                }
            }
        };
    }
    let visibility = &text.header.visibility;
    let free = generics.of_all_scenes(runtime, &TokenStream::new());
    let idents: Vec<Ident> = shared.functions.iter().map(|function| ident(&function.name)).collect();
    let given = idents.iter().zip(generics.functions()).map(|(ident, kind)| quote! { #ident: #kind });
    let functions = idents.iter().map(|_| quote! { #default::default() });
    let docs = new_docs(text, scenes);
    quote! {
        #allow
        impl<#free> #name<#arguments> {
            #(#[doc = #docs])*
            #[must_use]
            #[allow(non_snake_case, clippy::too_many_arguments, reason = "the text names the functions")]
            #visibility fn new(#(#given),*) -> Self {
                Self { #(#defaults)* #(#idents,)* #marker }
            }
        }

        impl<#defaulted> #default for #name<#arguments> {
            fn default() -> Self {
                Self::new(#(#functions),*)
            }
        }
    }
}

/// What `new` says: with scenes, which of them it makes.
fn new_docs(text: &Text, scenes: &Scenes) -> Vec<String> {
    let mut docs = vec![" The mechanism with these functions, everything else at its default.".to_owned()];
    let first = scenes.scenes.iter().find_map(Scene::label).filter(|_| scenes.are_declared());
    let functions = &scenes.shared.functions;
    if let Some(first) = first {
        let given =
            functions.iter().map(|function| function.name.text.as_str()).collect::<Vec<_>>().join(", ");
        let (name, alias) = (&text.header.name, alias(&text.header, first));
        let placeholders = vec!["_"; functions.len()].join(", ");
        docs.push(String::new());
        docs.push(format!(
            " No argument tells the scene: write `{alias}::new({given})`, or where the scene is a type"
        ));
        docs.push(format!(
            " parameter `{name}::<{placeholders}, f64, S>::new({given})`, not `{name}::new({given})`."
        ));
    }
    docs
}

/// What stands for type parameters without a field.
pub struct Markers {
    declaration: TokenStream,
    /// Values of the fields.
    pub value: TokenStream,
}

/// The fields that give the type parameters their use: that of the scene, and of the scalar where no other does.
pub fn markers(scenes: &Scenes) -> Markers {
    let marker = quote! { ::core::marker::PhantomData };
    let mut markers = Markers { declaration: TokenStream::new(), value: TokenStream::new() };
    let Model { fields, functions, .. } = &scenes.shared;
    if fields.is_empty() {
        let taken = functions.iter().any(|function| function.name.text == "scalar");
        let name = format_ident!("{}", if taken { "scalar_type" } else { "scalar" });
        markers.declaration.extend(quote! { #[doc(hidden)] pub #name: #marker<T>, });
        markers.value.extend(quote! { #name: #marker, });
    }
    if scenes.are_declared() {
        markers.declaration.extend(quote! { #[doc(hidden)] pub __scene: #marker<S>, });
        markers.value.extend(quote! { __scene: #marker, });
    }
    markers
}

/// Trait implementations, with the types that only they name.
fn implementations(text: &Text, scenes: &Scenes, part: &Part<'_>) -> TokenStream {
    let runtime = &text.header.runtime;
    let Part { scene, bodies, .. } = part;
    let model = &scene.model;
    let name = scenes::type_in(text, scenes, scene, &quote! { T });
    let lane = scenes::type_in(text, scenes, scene, &quote! { T::Real });
    let callable = Generics::of(text, scenes).callable(model, runtime);
    // The stub of a square text has as many rows as it was meant to have.
    let more = model.rows.len() > model.coordinates.len() && model.rows.iter().any(|row| row.redundant);
    let m = if part.square && !more { model.coordinates.len() } else { model.rows.len() };
    let kinematic = part.square.then(|| kinematic(&name, (model, m), (bodies, &callable), runtime));
    // Surplus rows leave multipliers open that only all rows together determine.
    let is_partitioned = model.dynamics.is_some() && !part.surplus;
    let partitioned = is_partitioned.then(|| partitioned(&name, (model, m), (part, &callable), runtime));
    let factors = (part.square || is_partitioned).then_some(&bodies.factors);
    let dynamic = bodies
        .dynamics
        .as_ref()
        .map(|bodies| dynamics::implementation(&name, model, (bodies, &callable), runtime));
    let (n, branches, outputs) = (model.coordinates.len(), model.branches.len(), model.outputs.len());
    let (limits, phase_count) = (model.limits.len(), model.phases.len());
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
    let places = sparsity.iter().map(|(row, column)| quote! { (#row, #column) });
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
    // Of a text whose rows fix nothing, nobody calls them.
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
            pub struct __Parameters<T>([T; #kept_parameters]);

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
    }
}

/// `impl Kinematic` with the factors that it keeps.
fn kinematic(
    name: &TokenStream,
    (model, m): (&Model, usize),
    (bodies, generics): (&Bodies, &TokenStream),
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
    quote! {
        impl<#generics> #runtime::WorstCase for #name {
            const WORK: #runtime::Work = #work;
        }
        impl<#generics> #runtime::Kinematic<T, #sizes> for #name {
            type Factors = __Factors<T>;
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
            #inline
            fn solve_linear(&self, __factors: &__Factors<T>, __b: &[T; #m]) -> [T; #n] #solve_linear
        }
    }
}

/// The attribute of a function that always, or perhaps, stands inside what calls it.
fn inlined(always: bool) -> TokenStream {
    match always {
        true => quote! { #[inline(always)] },
        false => quote! { #[inline] },
    }
}

/// `impl Partitioned`: the blocks over the dependent coordinates, and what the rows take of a force.
fn partitioned(
    name: &TokenStream,
    (model, m): (&Model, usize),
    (part, generics): (&Part<'_>, &TokenStream),
    runtime: &TokenStream,
) -> TokenStream {
    let n = model.coordinates.len();
    let Bodies { solve_with_position, factorize, independent, complete, reduce, .. } = &part.bodies;
    let (freedom, inline) = (independent.len(), inlined(part.bodies.factorizes_in_line));
    // Of a square text these are the functions of `Kinematic`.
    let (solve_blocks, factorize) = match part.square {
        true => (
            quote! { #runtime::Kinematic::solve_blocks(self, __p, __q, __t, __solver) },
            quote! { { #runtime::Kinematic::factorize(self, __p, __s) } },
        ),
        false => (
            quote! {
                (|| -> (T::Lanes<#runtime::Outcome>, __Position<T>) #solve_with_position)().0
            },
            factorize.clone(),
        ),
    };
    quote! {
        impl<#generics> #runtime::Partitioned<T, #n, #m> for #name {
            type Partition = __Factors<T>;
            const INDEPENDENT: &'static [::core::primitive::u16] = &[#(#independent),*];
            #[inline]
            fn solve_dependent<__S: #runtime::BlockSolver<T>>(
                &self,
                __p: &__Parameters<T>,
                __q: &mut [T; #n],
                __t: T,
                __solver: &mut __S,
            ) -> T::Lanes<#runtime::Outcome> { #solve_blocks }
            #inline
            fn partition(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> (__Factors<T>, #runtime::Margin<T>) #factorize
            #inline
            fn complete(&self, __factors: &__Factors<T>, __b: &[T; #m], __x: &mut [T; #n]) #complete
            #inline
            fn reduce(&self, __factors: &__Factors<T>, __y: &mut [T; #n]) -> [T; #m] #reduce
            #[inline(always)]
            fn accelerations(
                &self,
                __p: &<Self as #runtime::Mechanism<T, #n, #m>>::Parameters,
                __s: &<Self as #runtime::Mechanism<T, #n, #m>>::Position,
                __factors: &__Factors<T>,
                __force: &[T; #n],
                __gamma: &[T; #m],
            ) -> #runtime::dynamics::velocity_transformation::Transformed<T, #n, #m>
            where
                Self: #runtime::Dynamic<T, #n, #m>,
            {
                #runtime::dynamics::velocity_transformation::accelerations::<Self, T, #n, #m, #freedom>(
                    self, __p, __s, __factors, __force, __gamma,
                )
            }
        }
    }
}

/// Names, units and lines as constants.
fn tables(text: &Text, scenes: &Scenes, scene: &Scene, bodies: &Bodies) -> TokenStream {
    let runtime = &text.header.runtime;
    let source = scenes::source(text, scenes);
    let (name, model) = (text.header.name.to_string(), &scene.model);
    let scene = scene.label().map(|scene| quote! { const SCENE: &'static ::core::primitive::str = #scene; });
    let entry = |name: &str, unit: &str, span: Span| {
        let line = quote_spanned!(span=> ::core::line!());
        quote! { #runtime::Entry { name: #name, unit: #unit, line: #line } }
    };
    let coordinates = model.coordinates.iter().map(|c| entry(&c.name, &c.unit, c.span));
    let rows = model.rows.iter().map(|row| entry(&row.name, &row.unit(model), row.span));
    let marked = model.rows.iter().map(|row| row.redundant);
    let marked = model.rows.iter().any(|row| row.redundant).then(|| {
        quote! { const REDUNDANT: &'static [::core::primitive::bool] = &[#(#marked),*]; }
    });
    let reference = reference(model, runtime);
    let variables = model.variables.iter().map(|v| entry(&v.name, &v.unit, v.span));
    let branches = model.branches.iter().map(|b| entry(&b.name, &b.dimension.to_string(), b.span));
    let at_start = model.branches.iter().map(|branch| branch.at_start);
    let limits = model.limits.iter().map(|limit| entry(&limit.name, &limit.unit, limit.span));
    let phases = model.phases.iter().filter_map(|phase| model.variables.get(phase.variable));
    let phases = phases.map(|variable| entry(&variable.name, &variable.unit, variable.span));
    let outputs = model.outputs.iter().map(|output| entry(&output.name, &output.unit, output.span));
    let functions = model.functions.iter().zip(&bodies.orders);
    let functions = functions.map(|(function, order)| function_entry(function, *order, runtime));
    let functions = (!model.functions.is_empty()).then(|| {
        quote! { const FUNCTIONS: &'static [#runtime::FunctionEntry] = &[#(#functions),*]; }
    });
    quote! {
        const NAME: &'static ::core::primitive::str = #name;
        #scene
        const SOURCE: &'static ::core::primitive::str = #source;
        const COORDINATES: &'static [#runtime::Entry] = &[#(#coordinates),*];
        const ROWS: &'static [#runtime::Entry] = &[#(#rows),*];
        #marked
        #reference
        const VARIABLES: &'static [#runtime::Entry] = &[#(#variables),*];
        const BRANCHES: &'static [#runtime::Entry] = &[#(#branches),*];
        const BRANCHES_AT_START: &'static [::core::primitive::bool] = &[#(#at_start),*];
        const LIMITS: &'static [#runtime::Entry] = &[#(#limits),*];
        const PHASES: &'static [#runtime::Entry] = &[#(#phases),*];
        const OUTPUTS: &'static [#runtime::Entry] = &[#(#outputs),*];
        #functions
    }
}

/// What sets the reference length, where something is measured by it.
fn reference(model: &Model, runtime: &TokenStream) -> Option<TokenStream> {
    let parameters: Vec<u16> = model.lengths().filter_map(|index| u16::try_from(index).ok()).collect();
    if !model.is_measured_by_length() || (model.longest.is_none() && parameters.is_empty()) {
        return None;
    }
    let longest = match &model.longest {
        None => quote! { ::core::option::Option::None },
        Some(Longest { length, name, span }) => {
            let line = quote_spanned!(*span=> ::core::line!());
            quote! {
                ::core::option::Option::Some((
                    &#runtime::Entry { name: #name, unit: "m", line: #line }, #length
                ))
            }
        }
    };
    Some(quote! {
        #[allow(clippy::zero_prefixed_literal, reason = "the place of a number of the text, which may begin with 0")]
        const REFERENCE: #runtime::Reference =
            #runtime::Reference { longest: #longest, parameters: &[#(#parameters),*] };
    })
}

/// A declared function in the table.
fn function_entry(function: &Function, order: u8, runtime: &TokenStream) -> TokenStream {
    let Function { name, unit, argument_unit, continuity, period, .. } = function;
    let line = quote_spanned!(name.span=> ::core::line!());
    let name = &name.text;
    let period = match period {
        Some(period) => quote! { ::core::option::Option::Some(#period) },
        None => quote! { ::core::option::Option::None },
    };
    quote! {
        #runtime::FunctionEntry {
            name: #name,
            unit: #unit,
            argument_unit: #argument_unit,
            continuity: #continuity,
            order: #order,
            period: #period,
            line: #line,
        }
    }
}

/// `get`, `set`, `phases` and `lane`: a scene sees its own fields, and keeps the others.
fn access(text: &Text, scenes: &Scenes, model: &Model) -> TokenStream {
    let (name, runtime) = (&text.header.name, &text.header.runtime);
    let places: Vec<TokenStream> =
        (0..model.variables.len()).map(|index| tokens(&variable(model, index), runtime)).collect();
    let indices: Vec<usize> = (0..places.len()).collect();
    let lanes = scenes.shared.fields.iter().map(|field| {
        let ident = ident(&field.name);
        let value = nested(&field.shape, &|component| lane(field, component));
        let value = tokens(&value, runtime);
        quote! { #ident: #value, }
    });
    let functions = scenes.shared.functions.iter().map(|function| {
        let ident = ident(&function.name);
        quote! { #ident: ::core::clone::Clone::clone(&self.#ident), }
    });
    let marker = markers(scenes).value;
    let phases: Vec<Ident> = model.phase_fields().map(|field| ident(&field.name)).collect();
    let set_phases = match phases.as_slice() {
        [] => quote! { _: [#runtime::Phase<T>; 0] },
        _ => quote! { __phases: Self::Phases },
    };
    let put = (!phases.is_empty()).then(|| quote! { [#(self.#phases),*] = __phases; });
    let set = match places.as_slice() {
        [] => quote! { (_, _) => false, },
        _ => quote! { #((#indices, __value) => { #places = __value; true })* (_, _) => false, },
    };
    let lane_name = format_ident!("{}", if scenes.shared.fields.is_empty() { "_lane" } else { "__lane" });
    quote! {
        #[inline]
        fn get(&self, __index: ::core::primitive::usize) -> ::core::option::Option<T> {
            match __index {
                #(#indices => ::core::option::Option::Some(#places),)*
                _ => ::core::option::Option::None,
            }
        }
        #[inline]
        fn set(&mut self, __index: ::core::primitive::usize, __value: T) -> ::core::primitive::bool {
            match (__index, __value) { #set }
        }
        #[inline]
        fn phases(&self) -> Self::Phases {
            [#(self.#phases),*]
        }
        #[inline]
        fn set_phases(&mut self, #set_phases) { #put }
        #[inline]
        fn lane(&self, #lane_name: ::core::primitive::usize) -> Self::Lane {
            #name { #(#lanes)* #(#functions)* #marker }
        }
    }
}

fn lane(field: &Field, component: usize) -> String {
    let place = format!("self.{}{}", field_name(&field.name.text), subscripts(component, &field.shape));
    match field.role {
        Role::Parameter | Role::Input => format!("T::lane({place}, __lane)"),
        Role::InputWithRates => {
            let part = |part: &str| format!("{part}: T::lane({place}.{part}, __lane)");
            format!("__mbs::Signal {{ {}, {}, {} }}", part("value"), part("rate"), part("acceleration"))
        }
        Role::Phase => format!("__mbs::Phase::lane({place}, __lane)"),
    }
}

fn default(model: &Model, field: &Field, component: usize) -> String {
    let value = |offset: usize| {
        number(model.variables.get(field.first + offset).map_or(0.0, |variable| variable.default))
    };
    match field.role {
        Role::Parameter | Role::Input => value(component),
        Role::InputWithRates => {
            let zero = number(0.0);
            format!("__mbs::Signal {{ value: {zero}, rate: {zero}, acceleration: {zero} }}")
        }
        Role::Phase => {
            let zero = number(0.0);
            format!("__mbs::Phase::new({zero}, __mbs::Speed {{ value: {zero}, rate: {zero} }})")
        }
    }
}

/// An array literal of any depth, written from its components.
fn nested(shape: &[usize], component: &dyn Fn(usize) -> String) -> String {
    let size: usize = shape.iter().product();
    let mut items: Vec<String> = (0..size).map(component).collect();
    for length in shape.iter().rev() {
        items = items.chunks((*length).max(1)).map(|chunk| format!("[{}]", chunk.join(", "))).collect();
    }
    items.concat()
}

/// `T`, `[T; 2]`, `[[T; 3]; 2]`, …
fn array_type(scalar: TokenStream, shape: &[usize]) -> TokenStream {
    shape.iter().rev().fold(scalar, |inner, length| quote! { [#inner; #length] })
}

fn field_type(field: &Field, runtime: &TokenStream) -> TokenStream {
    let scalar = match field.role {
        Role::Parameter | Role::Input => quote! { T },
        Role::InputWithRates => quote! { #runtime::Signal<T> },
        Role::Phase => quote! { #runtime::Phase<T> },
    };
    array_type(scalar, &field.shape)
}

fn field_docs(field: &Field, model: &Model) -> Vec<String> {
    let mut docs = field.docs.clone();
    let role = match field.role {
        Role::Parameter => "Parameter",
        Role::Input => "Input",
        Role::InputWithRates => "Input with rates",
        Role::Phase => "Phase",
    };
    let default = match (field.role, field.shape.as_slice()) {
        (Role::Parameter, []) => model
            .variables
            .get(field.first)
            .map_or(String::new(), |variable| format!(", default {}", variable.default)),
        _ => String::new(),
    };
    if !docs.is_empty() {
        docs.push(String::new());
    }
    docs.push(format!(" {role} (`{}`){default}.", field.unit));
    docs
}

fn function_docs(function: &Function) -> Vec<String> {
    let Function { unit, argument_unit, continuity, period, .. } = function;
    let mut docs = function.docs.clone();
    if !docs.is_empty() {
        docs.push(String::new());
    }
    let derivatives = match continuity {
        0 => "continuous".into(),
        1 => "1 continuous derivative".into(),
        count => format!("{count} continuous derivatives"),
    };
    let period = period.map_or(String::new(), |period| format!(", period {period}"));
    docs.push(format!(" Function (`{unit}` of `{argument_unit}`), {derivatives}{period}."));
    docs
}

/// The coordinates by name.
fn coordinates_view(text: &Text, scene: &Scene) -> TokenStream {
    let visibility = &text.header.visibility;
    let (alias, model) = (alias(&text.header, scene.label().unwrap_or_default()), &scene.model);
    let name = format_ident!("{alias}Coordinates");
    let n = model.coordinates.len();
    let title = format!(" Coordinates of [`{alias}`] by name, in the order of `q`.");
    let fields = model.coordinate_fields.iter().map(|field| {
        let mut docs = field.docs.clone();
        docs.push(format!(" Coordinate (`{}`).", field.unit));
        let (ident, kind) = (ident(&field.name), array_type(quote! { T }, &field.shape));
        quote! { #(#[doc = #docs])* pub #ident: #kind, }
    });
    let runtime = &text.header.runtime;
    let from = model.coordinate_fields.iter().map(|field| {
        let ident = ident(&field.name);
        let value = match is_long(field) {
            true => format!("__mbs::long::part(&__q, {})", field.first),
            false => nested(&field.shape, &|component| format!("__q[{}]", field.first + component)),
        };
        let value = tokens(&value, runtime);
        quote! { #ident: #value, }
    });
    let into = tokens(&listed(model), runtime);
    // A text whose coordinates are all at fault still has a view, so that nothing but the fault turns red.
    let (marker, marker_value) = if model.coordinate_fields.is_empty() {
        let marker = quote! { ::core::marker::PhantomData };
        (quote! { #[doc(hidden)] pub scalar: #marker<T>, }, quote! { scalar: #marker, })
    } else {
        (TokenStream::new(), TokenStream::new())
    };
    quote! {
        #[doc = #title]
        #[allow(non_snake_case, reason = "the text names the coordinates")]
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq)]
        #visibility struct #name<T = ::core::primitive::f64> { #(#fields)* #marker }

        impl<T: ::core::marker::Copy> ::core::convert::From<[T; #n]> for #name<T> {
            fn from(__q: [T; #n]) -> Self {
                Self { #(#from)* #marker_value }
            }
        }

        impl<T: ::core::marker::Copy> ::core::convert::From<#name<T>> for [T; #n] {
            fn from(__named: #name<T>) -> Self { #into }
        }
    }
}

/// Most components of a field that are written one by one.
const LONGEST_FIELD: usize = 64;

/// Whether a field is a long list.
fn is_long(field: &CoordinateField) -> bool {
    matches!(field.shape.as_slice(), [length] if *length > LONGEST_FIELD)
}

/// All coordinates out of their fields.
fn listed(model: &Model) -> String {
    let component = |field: &CoordinateField, component: usize| {
        format!("__named.{}{}", field_name(&field.name.text), subscripts(component, &field.shape))
    };
    let Some(first) = model.coordinate_fields.first().filter(|_| model.coordinate_fields.iter().any(is_long))
    else {
        let places = model.coordinate_fields.iter().flat_map(|field| {
            let size: usize = field.shape.iter().product();
            (0..size).map(move |index| component(field, index))
        });
        return format!("[{}]", places.collect::<Vec<_>>().join(", "));
    };
    let mut text = format!("let mut __q = [{}; {}];\n", component(first, 0), model.coordinates.len());
    for field in &model.coordinate_fields {
        if is_long(field) {
            let name = field_name(&field.name.text);
            text += &format!("__mbs::long::put_part(&mut __q, {}, &__named.{name});\n", field.first);
        } else {
            let size: usize = field.shape.iter().product();
            for index in 0..size {
                text += &format!("__q[{}] = {};\n", field.first + index, component(field, index));
            }
        }
    }
    text + "__q"
}

/// The name as an identifier, raw where it is a keyword.
pub fn ident(name: &Name) -> Ident {
    if is_keyword(&name.text) {
        Ident::new_raw(&name.text, name.span)
    } else {
        Ident::new(&name.text, name.span)
    }
}

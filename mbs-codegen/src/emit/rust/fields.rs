//! Parameters, inputs, phases and functions as fields of the struct: types, documentation, values and access.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::emit::rust::code::tokens;
use crate::emit::rust::generics::Generics;
use crate::emit::rust::scope::{field_name, number, subscripts, variable};
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::selection::alias;
use crate::model::{Field, Function, Model, Role};
use crate::syntax::Text;
use crate::syntax::ast::Name;
use crate::syntax::rust_identifiers::identifier;

/// Fields of type parameters that no other field uses.
pub struct Markers {
    /// The fields.
    pub declaration: TokenStream,
    /// Values of the fields.
    pub value: TokenStream,
}

/// The fields that give the type parameters their use: that of the scene, and of the scalar where no other does.
pub fn markers(scenes: &Scenes) -> Markers {
    let marker = quote! { ::core::marker::PhantomData };
    let mut markers = Markers { declaration: TokenStream::new(), value: TokenStream::new() };
    if scenes.shared.fields.is_empty() {
        let name = unused(scenes, "scalar");
        markers.declaration.extend(quote! { #[doc(hidden)] pub #name: #marker<T>, });
        markers.value.extend(quote! { #name: #marker, });
    }
    if scenes.are_declared() {
        let name = unused(scenes, "__scene");
        markers.declaration.extend(quote! { #[doc(hidden)] pub #name: #marker<S>, });
        markers.value.extend(quote! { #name: #marker, });
    }
    markers
}

/// A name of a field that the text does not use.
fn unused(scenes: &Scenes, name: &str) -> Ident {
    let Model { fields, functions, .. } = &scenes.shared;
    let taken = |name: &str| {
        fields.iter().any(|field| field.name.text == name)
            || functions.iter().any(|function| function.name.text == name)
    };
    let mut name = name.to_owned();
    while taken(&name) {
        name.push('_');
    }
    format_ident!("{name}")
}

/// `Default`, and with declared functions `new`.
pub fn constructors(text: &Text, scenes: &Scenes, generics: &Generics) -> TokenStream {
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
    // An argument is a pattern: `Some`, or a constant that the caller has, would be matched.
    let arguments_of: Vec<Ident> =
        shared.functions.iter().map(|function| format_ident!("__{}", function.name.text)).collect();
    let types = shared
        .functions
        .iter()
        .zip(generics.functions())
        .map(|(function, kind)| array_type(quote! { #kind }, &function.shape()));
    let given = arguments_of.iter().zip(types).map(|(argument, kind)| quote! { #argument: #kind });
    let functions = shared.functions.iter().map(|function| match function.array {
        // Arrays of up to 32 have a default of their own.
        Some(_) => quote! { ::core::array::from_fn(|_| #default::default()) },
        None => quote! { #default::default() },
    });
    let docs = new_docs(text, scenes);
    quote! {
        #allow
        impl<#free> #name<#arguments> {
            #(#[doc = #docs])*
            #[must_use]
            #[allow(non_snake_case, clippy::too_many_arguments, reason = "the text names the functions")]
            #visibility fn new(#(#given),*) -> Self {
                Self { #(#defaults)* #(#idents: #arguments_of,)* #marker }
            }
        }

        impl<#defaulted> #default for #name<#arguments> {
            fn default() -> Self {
                Self::new(#(#functions),*)
            }
        }
    }
}

/// Documentation of `new`; with scenes, the scene that it makes.
fn new_docs(text: &Text, scenes: &Scenes) -> Vec<String> {
    let mut docs = vec![" The mechanism with these functions, everything else at its default.".to_owned()];
    let first = scenes.scenes.iter().find_map(Scene::label).filter(|_| scenes.are_declared());
    let functions = &scenes.shared.functions;
    if let Some(first) = first {
        let given =
            functions.iter().map(|function| function.name.text.as_str()).collect::<Vec<_>>().join(", ");
        let (name, alias) = (text.header.label(), alias(&text.header, first));
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

/// `get`, `set`, `values`, `phases` and `lane`: a scene sees its own fields, and keeps the others.
pub fn access(text: &Text, scenes: &Scenes, model: &Model) -> TokenStream {
    let (name, runtime) = (&text.header.name, &text.header.runtime);
    let places: Vec<TokenStream> =
        (0..model.variables.len()).map(|index| tokens(&variable(model, index), runtime)).collect();
    let indices: Vec<usize> = (0..places.len()).collect();
    let lanes = converted(scenes, runtime, lane);
    let phases: Vec<Ident> = model.phase_fields().map(|field| ident(&field.name)).collect();
    let set_phases = match phases.as_slice() {
        [] => quote! { _: [#runtime::Phase<T>; 0] },
        _ => quote! { __phases: Self::Phases },
    };
    let put = (!phases.is_empty()).then(|| quote! { [#(self.#phases),*] = __phases; });
    let set_values = match places.as_slice() {
        [] => quote! { _: [T; 0] },
        _ => quote! { __values: Self::Values },
    };
    let put_values = (!places.is_empty()).then(|| quote! { [#(#places),*] = __values; });
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
        fn values(&self) -> Self::Values {
            [#(#places),*]
        }
        #[inline]
        fn set_values(&mut self, #set_values) { #put_values }
        #[inline]
        fn phases(&self) -> Self::Phases {
            [#(self.#phases),*]
        }
        #[inline]
        fn set_phases(&mut self, #set_phases) { #put }
        #[inline]
        fn lane(&self, #lane_name: ::core::primitive::usize) -> Self::Lane {
            #name { #lanes }
        }
    }
}

/// `enclosed`: the mechanism in intervals, of the type `target`, where parts of a motion can be enclosed and something asks for it.
pub fn enclosed(
    text: &Text,
    scenes: &Scenes,
    target: &TokenStream,
    (model, m): (&Model, usize),
) -> TokenStream {
    let is_asked = model.dynamics.is_some() || !model.limits.is_empty();
    if !is_asked || !model.can_be_enclosed() {
        return TokenStream::new();
    }
    let (name, runtime, n) = (&text.header.name, &text.header.runtime, model.coordinates.len());
    let fields = converted(scenes, runtime, interval);
    quote! {
        fn enclosed<__V: #runtime::dynamics::WithIntervals<T, #n, #m>>(
            &self,
            __see: __V,
        ) -> ::core::option::Option<__V::Output> {
            let __enclosed: #target = #name { #fields };
            ::core::option::Option::Some(<__V as #runtime::dynamics::WithIntervals<T, #n, #m>>::at(__see, &__enclosed))
        }
    }
}

/// The designs in some lanes of a mechanism, from lane `__first` on.
pub fn in_part(text: &Text, scenes: &Scenes) -> TokenStream {
    let (name, fields) = (&text.header.name, converted(scenes, &text.header.runtime, part));
    quote! { #name { #fields } }
}

/// A mechanism in double precision as one in the numbers `__U`.
pub fn in_other_numbers(text: &Text, scenes: &Scenes) -> TokenStream {
    let (name, fields) = (&text.header.name, converted(scenes, &text.header.runtime, rounded));
    quote! { #name { #fields } }
}

/// The fields of the mechanism in another type of number, each component as `component` has it, and its functions.
fn converted(
    scenes: &Scenes,
    runtime: &TokenStream,
    component: impl Fn(&Field, usize) -> String,
) -> TokenStream {
    let fields = scenes.shared.fields.iter().map(|field| {
        let ident = ident(&field.name);
        let value = tokens(&nested(&field.shape, &|index| component(field, index)), runtime);
        quote! { #ident: #value, }
    });
    let functions = scenes.shared.functions.iter().map(|function| {
        let ident = ident(&function.name);
        quote! { #ident: ::core::clone::Clone::clone(&self.#ident), }
    });
    let marker = markers(scenes).value;
    quote! { #(#fields)* #(#functions)* #marker }
}

/// A field of the mechanism in intervals. Phases of other scenes are not asked for.
fn interval(field: &Field, component: usize) -> String {
    let place = format!("self.{}{}", field_name(&field.name.text), subscripts(component, &field.shape));
    let of = |place: &str| format!("__mbs::Interval::of(T::lane({place}, 0))");
    match field.role {
        Role::Parameter | Role::Input => of(&place),
        Role::InputWithRates => {
            let part = |part: &str| format!("{part}: {}", of(&format!("{place}.{part}")));
            format!("__mbs::Signal {{ {}, {}, {} }}", part("value"), part("rate"), part("acceleration"))
        }
        Role::Phase => {
            let zero = "__mbs::Interval::of(<T::Real as __mbs::Scalar>::constant(0.0))";
            format!("__mbs::Phase::new({zero}, __mbs::Speed {{ value: {zero}, rate: {zero} }})")
        }
    }
}

/// A field of a mechanism in double precision, in the numbers `__U`.
fn rounded(field: &Field, component: usize) -> String {
    let place = format!("self.{}{}", field_name(&field.name.text), subscripts(component, &field.shape));
    let of = |place: &str| format!("__U::constant({place})");
    let part = |part: &str| of(&format!("{place}.{part}"));
    match field.role {
        Role::Parameter | Role::Input => of(&place),
        Role::InputWithRates => {
            format!("__mbs::Signal::new({}, {}, {})", part("value"), part("rate"), part("acceleration"))
        }
        Role::Phase => format!(
            "__mbs::Phase::new({}, __mbs::Speed {{ value: {}, rate: {} }})",
            part("value"),
            part("rate"),
            part("acceleration")
        ),
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

fn part(field: &Field, component: usize) -> String {
    let place = format!("self.{}{}", field_name(&field.name.text), subscripts(component, &field.shape));
    match field.role {
        Role::Parameter | Role::Input => format!("T::part({place}, __first)"),
        Role::InputWithRates => {
            let part = |part: &str| format!("{part}: T::part({place}.{part}, __first)");
            format!("__mbs::Signal {{ {}, {}, {} }}", part("value"), part("rate"), part("acceleration"))
        }
        Role::Phase => format!("__mbs::Phase::part({place}, __first)"),
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
pub fn nested(shape: &[usize], component: &dyn Fn(usize) -> String) -> String {
    let size: usize = shape.iter().product();
    let mut items: Vec<String> = (0..size).map(component).collect();
    for length in shape.iter().rev() {
        items = items.chunks((*length).max(1)).map(|chunk| format!("[{}]", chunk.join(", "))).collect();
    }
    items.concat()
}

/// `T`, `[T; 2]`, `[[T; 3]; 2]`, …
pub fn array_type(scalar: TokenStream, shape: &[usize]) -> TokenStream {
    shape.iter().rev().fold(scalar, |inner, length| quote! { [#inner; #length] })
}

/// Type of a field of the struct.
pub fn field_type(field: &Field, runtime: &TokenStream) -> TokenStream {
    let scalar = match field.role {
        Role::Parameter | Role::Input => quote! { T },
        Role::InputWithRates => quote! { #runtime::Signal<T> },
        Role::Phase => quote! { #runtime::Phase<T> },
    };
    array_type(scalar, &field.shape)
}

/// Documentation of a field: the text's, its role, unit and default.
pub fn field_docs(field: &Field, model: &Model) -> Vec<String> {
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
    let turns = model.variables.get(field.first).is_some_and(|variable| variable.turns);
    let way = if turns { ", the short way round" } else { "" };
    docs.push(format!(" {role} (`{}`){default}{way}.", field.unit));
    docs
}

/// Documentation of a declared function: the text's, its units, its continuity and period.
pub fn function_docs(function: &Function) -> Vec<String> {
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
    let kind = match function.array {
        Some(array) => format!("Array of {} functions", array.length),
        None => "Function".into(),
    };
    docs.push(format!(" {kind} (`{unit}` of `{argument_unit}`), {derivatives}{period}."));
    docs
}

/// The name as an identifier, raw where it is a keyword.
pub fn ident(name: &Name) -> Ident {
    identifier(&name.text, name.span)
}

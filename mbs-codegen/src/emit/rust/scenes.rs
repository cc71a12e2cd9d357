//! Items of a text with scenes: markers, aliases, conversions from one scene to another.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::diagnostics::Diagnostics;
use crate::emit::rust::SceneFunctions;
use crate::emit::rust::fields::{ident, markers};
use crate::emit::rust::generics::Generics;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::selection::{WHOLE, alias};
use crate::syntax::Text;
use crate::syntax::rust_identifiers::identifier;

/// The mechanism in a scene: `Name<T>`, with functions `Name<Lift, T>`, with scenes `Name<T, marker>`.
pub fn type_in(text: &Text, scenes: &Scenes, scene: &Scene, scalar: &TokenStream) -> TokenStream {
    let (name, runtime) = (&text.header.name, &text.header.runtime);
    let marker = match &scene.name {
        Some(marker) => {
            let (module, marker) = (module(text), ident(marker));
            Some(quote! { #module::#marker })
        }
        None => scenes.are_declared().then(|| quote! { #runtime::AllEffects }),
    };
    let arguments = Generics::of(text, scenes).arguments(scalar, marker);
    quote! { #name<#arguments> }
}

/// The text as a constant: written once for any number of scenes.
pub fn source(text: &Text, scenes: &Scenes) -> TokenStream {
    let (module, source) = (module(text), &text.source);
    if scenes.are_declared() {
        quote! { #module::__SOURCE }
    } else {
        quote! { #source }
    }
}

/// Lines of the struct's documentation after the text's own.
pub fn docs(
    text: &Text,
    scenes: &Scenes,
    parts: &[SceneFunctions<'_>],
    left_out: Option<&Diagnostics>,
) -> Vec<String> {
    let whole = parts.iter().filter(|part| part.scene.name.is_none()).flat_map(|part| part.docs.clone());
    if !scenes.are_declared() {
        return whole.collect();
    }
    let mut lines = vec![String::new(), " # Scenes".into()];
    for scene in &scenes.scenes {
        let alias = alias(&text.header, scene.label().unwrap_or_default());
        let title = scene.docs.first().map(|line| format!(": {}", line.trim())).unwrap_or_default();
        lines.push(format!(" - [`{alias}`]{title}"));
    }
    let all = match left_out.and_then(Diagnostics::first) {
        Some(fault) => format!("is none of them: line {}, {}", fault.span.start().line, fault.message),
        None => "is described below".into(),
    };
    lines.push(format!(" - `{WHOLE}`, all effects at once, {all}."));
    lines.extend(whole);
    lines
}

/// Before: the scenes of a text. After: their markers, an alias each, and the conversion; empty for a text without.
pub fn items(text: &Text, scenes: &Scenes, parts: &[SceneFunctions<'_>]) -> TokenStream {
    if !scenes.are_declared() {
        return TokenStream::new();
    }
    let (visibility, module) = (&text.header.visibility, module(text));
    let declared = || parts.iter().filter_map(|part| Some((part, part.scene.name.as_ref()?)));
    let structs = declared().map(|(part, name)| {
        let (docs, name) = (marker_docs(part), ident(name));
        quote! {
            #(#[doc = #docs])*
            #[derive(
                ::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::default::Default,
                ::core::cmp::PartialEq, ::core::cmp::Eq
            )]
            pub struct #name {}
        }
    });
    let generics = Generics::of(text, scenes);
    let aliases = declared().map(|(part, name)| {
        let functions = generics.functions();
        let title = format!(" [`{}`] in its scene `{}`.", text.header.label(), name.text);
        let name = identifier(&alias(&text.header, &name.text), name.span);
        let target = type_in(text, scenes, part.scene, &quote! { T });
        quote! {
            #[doc = #title]
            #[allow(dead_code, non_camel_case_types, reason = "a short name for who wants it")]
            #visibility type #name<#(#functions,)* T = ::core::primitive::f64> = #target;
        }
    });
    let (conversion, source) = (conversion(text, scenes), &text.source);
    // Types and no values, so that no variable of the caller's is taken for a scene. By a glob, equal names of scenes in one module are no fault unless someone uses them.
    quote! {
        #[doc(hidden)]
        #[allow(
            dead_code, non_snake_case, non_camel_case_types, unreachable_pub,
            reason = "the text names the scenes, and no caller need use them all"
        )]
        mod #module {
            pub(super) const __SOURCE: &::core::primitive::str = #source;
            #(#structs)*
        }
        #[allow(unused_imports, ambiguous_glob_reexports, reason = "the aliases name the same scenes")]
        #visibility use #module::*;
        #(#aliases)*
        #conversion
    }
}

fn marker_docs(part: &SceneFunctions<'_>) -> Vec<String> {
    let mut lines = part.scene.docs.clone();
    if !lines.is_empty() {
        lines.push(String::new());
    }
    let effects: Vec<String> = part.scene.effects.iter().map(|effect| format!("`{effect}`")).collect();
    lines.push(format!(" A scene: {}.", effects.join(" + ")));
    lines.extend(part.docs.iter().cloned());
    lines
}

/// `scene`, from one scene to another.
fn conversion(text: &Text, scenes: &Scenes) -> TokenStream {
    let name = &text.header.name;
    let functions = scenes.shared.functions.iter().map(|function| &function.name);
    let fields = scenes.shared.fields.iter().map(|field| &field.name).chain(functions);
    let fields: Vec<_> = fields.map(ident).collect();
    let value = markers(scenes).value;
    let generics = Generics::of(text, scenes);
    let arguments = |scene| generics.arguments(&quote! { T }, Some(scene));
    let (here, there) = (arguments(quote! { S }), arguments(quote! { __Other }));
    quote! {
        impl<#here> #name<#here> {
            /// The same parameters and inputs in another scene.
            #[allow(dead_code, reason = "not every caller changes the scene")]
            pub fn scene<__Other>(self) -> #name<#there> {
                #name { #(#fields: self.#fields,)* #value }
            }
        }
    }
}

/// The module of the markers.
fn module(text: &Text) -> proc_macro2::Ident {
    format_ident!("__{}Scenes", text.header.label())
}

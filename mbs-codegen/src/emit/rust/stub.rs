//! Names that stand beside errors, so that the code that uses them gives no further ones.
//!
//! The first error of the text is a constant, and every type is generic over it. The compiler says nothing about a type with a
//! faulty constant: not on its fields, its methods, its traits, or how many rows it has. So the stub needs to know names alone.
//! Only patterns look fields up by name; fields are kept for them.

use std::collections::BTreeSet;

use proc_macro2::{Delimiter, Ident, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};

use crate::emit::rust::fields::ident;
use crate::emit::rust::generics::Generics;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::selection::{COORDINATES, OUTPUTS, STEPPER, alias};
use crate::syntax::ast::{Declares, StatementKind};
use crate::syntax::rust_identifiers::{UNUSABLE, identifier};
use crate::syntax::{OWN, Text};

/// Type parameters of the stub beyond those of the text: a declaration of a function may be out of recognition.
const SPARE: usize = 4;

/// Before: a text with faults, the first of them as an expression. After: the struct, the views and the scenes by their names.
pub fn stub(text: &Text, scenes: &Scenes, fault: &TokenStream) -> TokenStream {
    let (header, generics) = (&text.header, Generics::of(text, scenes));
    let visibility = &header.visibility;
    let docs = header.attributes.iter().filter(|attribute| attribute.path().is_ident("doc"));
    let fields: Vec<Ident> = {
        let functions = scenes.shared.functions.iter().map(|function| &function.name);
        scenes.shared.fields.iter().map(|field| &field.name).chain(functions).map(ident).collect()
    };
    // Those that have a fault are fields too.
    let outputs: Vec<Ident> = text
        .statements
        .iter()
        .filter_map(|statement| match &statement.kind {
            StatementKind::Out { name, .. } if !UNUSABLE.contains(&name.text.as_str()) => Some(ident(name)),
            _ => None,
        })
        .collect();
    let mut items = Items::new(&header.label(), fault, generics.functions().count() + SPARE);
    items.push((&quote! { #(#docs)* #visibility }, header.name.clone()), &fields);
    let all = || scenes.scenes.iter().chain(&scenes.whole);
    for scene in all() {
        let name = alias(header, scene.label().unwrap_or_default());
        if let Some(label) = &scene.name {
            items.push((&quote! { #visibility }, identifier(&name, label.span)), &fields);
        }
        let coordinates: Vec<Ident> =
            scene.model.coordinate_fields.iter().map(|field| ident(&field.name)).collect();
        items.views(&quote! { #visibility }, &name, (&coordinates, &outputs));
    }
    // What a word of no kind declares may be a scene.
    let lost: Vec<Ident> = text
        .statements
        .iter()
        .filter_map(|statement| match &statement.kind {
            StatementKind::Faulty { name, declares: Declares::Value, .. } if scenes.are_declared() => {
                usable(&ident(name))
            }
            _ => None,
        })
        .collect();
    for name in &lost {
        let label = alias(header, name.to_string().trim_start_matches("r#"));
        items.push((&quote! { #visibility }, identifier(&label, name.span())), &fields);
        items.views(&quote! { #visibility }, &label, (&[], &[]));
    }
    let named = all().filter_map(|scene: &Scene| scene.name.as_ref()).map(ident);
    items.scenes(&quote! { #visibility }, named.chain(lost));
    items.tokens
}

/// [`stub`] of a text that cannot be read: what its tokens say of its name and of those of its scenes. Without a name it is the
/// fault alone, as an item.
pub fn stub_of_tokens(input: TokenStream, fault: &TokenStream) -> TokenStream {
    let mut words = Vec::new();
    for tree in input {
        match tree {
            // Tokens of a caller's macro, or an effect.
            TokenTree::Group(group) if matches!(group.delimiter(), Delimiter::None | Delimiter::Brace) => {
                words.extend(group.stream());
            }
            tree => words.push(tree),
        }
    }
    let named = |keyword: &str| -> Vec<Ident> {
        let pairs = words.windows(2).filter_map(|pair| match pair {
            [TokenTree::Ident(word), TokenTree::Ident(name)] if *word == keyword => Some(name),
            _ => None,
        });
        pairs.filter_map(usable).collect()
    };
    let Some(name) = named("mechanism").into_iter().next() else { return fault.clone() };
    let label = name.to_string().trim_start_matches("r#").to_owned();
    let public = quote! { pub };
    let mut items = Items::new(&label, fault, SPARE);
    let fields: Vec<Ident> = ["param", "input", "function"].into_iter().flat_map(named).collect();
    let (coordinates, outputs) = (named("coord"), named("out"));
    items.push((&public, name), &fields);
    items.views(&public, &label, (&coordinates, &outputs));
    let scenes = named("scene");
    for scene in &scenes {
        let name = format!("{label}{}", scene.to_string().trim_start_matches("r#"));
        items.views(&public, &name, (&coordinates, &outputs));
        items.push((&public, identifier(&name, scene.span())), &fields);
    }
    items.scenes(&public, scenes.into_iter());
    items.tokens
}

/// A name that a type may have.
fn usable(name: &Ident) -> Option<Ident> {
    let text = name.to_string();
    let text = text.trim_start_matches("r#");
    let fits = !UNUSABLE.contains(&text) && !text.starts_with(OWN);
    fits.then(|| identifier(text, name.span()))
}

/// Items of the stub, each name once.
struct Items {
    tokens: TokenStream,
    known: BTreeSet<String>,
    /// Name of the mechanism, of which those of hidden items are made.
    label: String,
    /// Name of the faulty constant.
    fault: Ident,
    parameters: Vec<Ident>,
}

impl Items {
    fn new(label: &str, fault: &TokenStream, parameters: usize) -> Self {
        let constant = format_ident!("__{label}Fault");
        Items {
            tokens: quote! {
                #[doc(hidden)]
                #[allow(dead_code, non_upper_case_globals, reason = "named after the mechanism")]
                const #constant: ::core::primitive::usize = #fault;
            },
            known: BTreeSet::new(),
            label: label.into(),
            fault: constant,
            // The scalar and the scene are two of them.
            parameters: (0..parameters + 2).map(|index| format_ident!("__P{index}")).collect(),
        }
    }

    /// A struct with a faulty constant, under a name that takes any number of type arguments.
    fn push(&mut self, (head, name): (&TokenStream, Ident), fields: &[Ident]) {
        if !self.known.insert(name.to_string()) {
            return;
        }
        let (fault, parameters) = (&self.fault, &self.parameters);
        let hidden =
            format_ident!("__{}", name.to_string().trim_start_matches("r#"), span = Span::call_site());
        let marker = quote! { ::core::marker::PhantomData };
        let mut known = BTreeSet::new();
        let fields: Vec<&Ident> = fields.iter().filter(|field| known.insert(field.to_string())).collect();
        let none = fields.is_empty().then(|| quote! { pub __parameters: #marker<P>, });
        self.tokens.extend(quote! {
            #[doc(hidden)]
            #[allow(dead_code, non_snake_case, non_camel_case_types, unreachable_pub, reason = "named by the text")]
            pub struct #hidden<P, const FAULT: ::core::primitive::usize> {
                #(pub #fields: #marker<(P, [(); FAULT])>,)*
                #none
            }
            #[allow(dead_code, non_camel_case_types, reason = "named by the text")]
            #head type #name<#(#parameters = ()),*> = #hidden<(#(#parameters,)*), { #fault }>;
        });
    }

    /// Coordinates and outputs by name, and the stepper, of a scene whose type is called `alias`.
    fn views(&mut self, head: &TokenStream, alias: &str, (coordinates, outputs): (&[Ident], &[Ident])) {
        for (suffix, fields) in [(COORDINATES, coordinates), (OUTPUTS, outputs), (STEPPER, &[])] {
            self.push((head, format_ident!("{alias}{suffix}")), fields);
        }
    }

    /// Types that stand for the scenes. By a glob, equal names of scenes in one module are no fault.
    fn scenes(&mut self, visibility: &TokenStream, names: impl Iterator<Item = Ident>) {
        let module = format_ident!("__{}Scenes", self.label);
        let mut known = BTreeSet::new();
        let names: Vec<Ident> = names.filter(|name| known.insert(name.to_string())).collect();
        if names.is_empty() {
            return;
        }
        self.tokens.extend(quote! {
            #[doc(hidden)]
            #[allow(dead_code, non_snake_case, non_camel_case_types, unreachable_pub, reason = "named by the text")]
            mod #module {
                #(
                    #[derive(
                        ::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::default::Default,
                        ::core::cmp::PartialEq, ::core::cmp::Eq
                    )]
                    pub struct #names {}
                )*
            }
            #[allow(unused_imports, ambiguous_glob_reexports, reason = "not every caller uses them")]
            #visibility use #module::*;
        });
    }
}

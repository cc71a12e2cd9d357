//! Coordinates and outputs by name: structs with the same entries as their arrays. The stepper of a scene by a short name.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::emit::rust::code::tokens;
use crate::emit::rust::fields::{array_type, ident, nested};
use crate::emit::rust::generics::Generics;
use crate::emit::rust::scenes::type_in;
use crate::emit::rust::scope::{field_name, subscripts};
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::selection::{COORDINATES, OUTPUTS, STEPPER, alias};
use crate::model::{CoordinateField, Model};
use crate::syntax::Text;

/// The coordinates by name.
pub fn coordinates_view(text: &Text, scene: &Scene) -> TokenStream {
    let visibility = &text.header.visibility;
    let (alias, model) = (alias(&text.header, scene.label().unwrap_or_default()), &scene.model);
    let name = format_ident!("{alias}{COORDINATES}");
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
            true => format!("__mbs::__private::chunks::part(&__q, {})", field.first),
            false => nested(&field.shape, &|component| format!("__q[{}]", field.first + component)),
        };
        let value = tokens(&value, runtime);
        quote! { #ident: #value, }
    });
    let into = tokens(&listed(model), runtime);
    quote! {
        #[doc = #title]
        #[allow(non_snake_case, reason = "the text names the coordinates")]
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq)]
        #visibility struct #name<T = ::core::primitive::f64> { #(#fields)* }

        impl<T: ::core::marker::Copy> ::core::convert::From<[T; #n]> for #name<T> {
            fn from(__q: [T; #n]) -> Self {
                Self { #(#from)* }
            }
        }

        impl<T: ::core::marker::Copy> ::core::convert::From<#name<T>> for [T; #n] {
            fn from(__named: #name<T>) -> Self { #into }
        }
    }
}

/// The outputs by name; nothing where the text has none.
pub fn outputs_view(text: &Text, scene: &Scene) -> TokenStream {
    let fields = &scene.model.output_fields;
    if fields.is_empty() {
        return TokenStream::new();
    }
    let (visibility, runtime) = (&text.header.visibility, &text.header.runtime);
    let alias = alias(&text.header, scene.label().unwrap_or_default());
    let name = format_ident!("{alias}{OUTPUTS}");
    let count = scene.model.outputs.len();
    let title = format!(" Outputs of [`{alias}`] by name, with their time derivatives.");
    let output = quote! { #runtime::OutputValue<T> };
    let declared = fields.iter().map(|field| {
        let docs = format!(" Output (`{}`).", field.unit);
        let (ident, kind) = (ident(&field.name), array_type(output.clone(), &field.lengths()));
        quote! { #[doc = #docs] pub #ident: #kind, }
    });
    let from = fields.iter().map(|field| {
        let place = |component: usize| match field.components.get(component) {
            Some(index) => format!("__outputs[{index}]"),
            None => String::new(),
        };
        let (ident, value) = (ident(&field.name), tokens(&nested(&field.lengths(), &place), runtime));
        quote! { #ident: #value, }
    });
    quote! {
        #[doc = #title]
        #[allow(non_snake_case, dead_code, reason = "the text names the outputs")]
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq)]
        #visibility struct #name<T = ::core::primitive::f64> { #(#declared)* }

        impl<T: ::core::marker::Copy> ::core::convert::From<[#output; #count]> for #name<T> {
            fn from(__outputs: [#output; #count]) -> Self {
                Self { #(#from)* }
            }
        }
    }
}

/// The stepper of a scene whose rows fix every coordinate, by a short name.
pub fn stepper_alias(text: &Text, scenes: &Scenes, scene: &Scene) -> TokenStream {
    let (visibility, runtime) = (&text.header.visibility, &text.header.runtime);
    let alias = alias(&text.header, scene.label().unwrap_or_default());
    let name = format_ident!("{alias}{STEPPER}");
    let title = format!(" Stepper of [`{alias}`]; it is made by `Stepper::assemble`.");
    let generics = Generics::of(text, scenes);
    let functions = generics.functions();
    let mechanism = type_in(text, scenes, scene, &quote! { T });
    let (n, rows) = (scene.model.coordinates.len(), scene.model.rows.len());
    quote! {
        #[doc = #title]
        #[allow(dead_code, non_camel_case_types, reason = "a short name for who wants it")]
        #visibility type #name<#(#functions,)* T = ::core::primitive::f64> = #runtime::Stepper<#mechanism, T, #n, #rows>;
    }
}

/// Most components of a field that are written one by one.
const LONGEST_FIELD: usize = 64;

/// `true` if a field is a long list.
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
            text +=
                &format!("__mbs::__private::chunks::put_part(&mut __q, {}, &__named.{name});\n", field.first);
        } else {
            let size: usize = field.shape.iter().product();
            for index in 0..size {
                text += &format!("__q[{}] = {};\n", field.first + index, component(field, index));
            }
        }
    }
    text + "__q"
}

//! The coordinates by name: a struct with the same entries as the array of coordinates.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::emit::rust::code::tokens;
use crate::emit::rust::fields::{array_type, ident, nested};
use crate::emit::rust::scope::{field_name, subscripts};
use crate::model::scene::Scene;
use crate::model::selection::alias;
use crate::model::{CoordinateField, Model};
use crate::syntax::Text;

/// The coordinates by name.
pub fn coordinates_view(text: &Text, scene: &Scene) -> TokenStream {
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

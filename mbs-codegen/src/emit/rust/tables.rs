//! Tables of a mechanism as constants: names, units and lines, places of angles, the reference length, declared functions.

use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};

use crate::emit::rust::functions::Bodies;
use crate::emit::rust::scenes;
use crate::model::expression::Length;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::{Function, Model};
use crate::syntax::Text;

/// Names, units and lines as constants.
pub(super) fn tables(text: &Text, scenes: &Scenes, scene: &Scene, bodies: &Bodies) -> TokenStream {
    let runtime = &text.header.runtime;
    let source = scenes::source(text, scenes);
    let (name, model) = (text.header.label(), &scene.model);
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
    let angles = angles(model);
    let turning = turning_inputs(model);
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
        #angles
        #turning
        const BRANCHES: &'static [#runtime::Entry] = &[#(#branches),*];
        const BRANCHES_AT_START: &'static [::core::primitive::bool] = &[#(#at_start),*];
        const LIMITS: &'static [#runtime::Entry] = &[#(#limits),*];
        const PHASES: &'static [#runtime::Entry] = &[#(#phases),*];
        const OUTPUTS: &'static [#runtime::Entry] = &[#(#outputs),*];
        #functions
    }
}

/// `ANGLES`, where a parameter or an input is one.
fn angles(model: &Model) -> Option<TokenStream> {
    let indices: Vec<u16> = model.angles().filter_map(|index| u16::try_from(index).ok()).collect();
    (!indices.is_empty()).then(|| {
        quote! {
            #[allow(clippy::zero_prefixed_literal, reason = "places in the text's order")]
            const ANGLES: &'static [::core::primitive::u16] = &[#(#indices),*];
        }
    })
}

/// `TURNING_INPUTS`, where an input is declared as `turn`.
fn turning_inputs(model: &Model) -> Option<TokenStream> {
    let all = model.variables.iter().enumerate().filter(|(_, variable)| variable.turns);
    let indices: Vec<u16> = all.filter_map(|(index, _)| u16::try_from(index).ok()).collect();
    (!indices.is_empty()).then(|| {
        quote! {
            #[allow(clippy::zero_prefixed_literal, reason = "places in the text's order")]
            const TURNING_INPUTS: &'static [::core::primitive::u16] = &[#(#indices),*];
        }
    })
}

/// Sources of the reference length, where something is measured by it.
fn reference(model: &Model, runtime: &TokenStream) -> Option<TokenStream> {
    let parameters: Vec<u16> = model.lengths.iter().filter_map(|index| u16::try_from(*index).ok()).collect();
    if !model.is_measured_by_length() || (model.longest.is_none() && parameters.is_empty()) {
        return None;
    }
    let longest = match &model.longest {
        None => quote! { ::core::option::Option::None },
        Some(Length { length, name, span }) => {
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
    let name = function.label();
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

//! Items emitted together with errors, so that the code that uses them gives no further ones.

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::rust::SceneFunctions;
use crate::emit::rust::dynamics::DynamicBodies;
use crate::emit::rust::functions::Bodies;
use crate::emit::rust::item;
use crate::model::Model;
use crate::model::scenes::Scenes;
use crate::structure::shape_of;
use crate::syntax::Text;

/// Before: scenes with faults. After: the same items as without, with bodies that are never compiled to run.
pub fn stub(text: &Text, scenes: &Scenes) -> TokenStream {
    let all = scenes.scenes.iter().chain(&scenes.whole);
    let parts = all.map(|scene| {
        let model = &scene.model;
        let (square, surplus) = shape_of(model);
        let bodies = bodies(model, &text.header.runtime);
        SceneFunctions { scene, square, surplus, docs: Vec::new(), bodies }
    });
    item::item(text, scenes, &parts.collect::<Vec<_>>(), None)
}

fn bodies(model: &Model, runtime: &TokenStream) -> Bodies {
    let body = || quote! { { ::core::unreachable!() } };
    Bodies {
        orders: vec![0; model.functions.len()],
        contacts: None,
        kept_parameters: 0,
        kept_position: 0,
        parameters: body(),
        guess: body(),
        coordinate_scales: body(),
        row_scales: body(),
        widths: None,
        position: body(),
        phi: body(),
        phi_q: body(),
        phi_q_entries: body(),
        sparsity: Vec::new(),
        phi_t: body(),
        phi_tt: body(),
        phi_qt_qd: body(),
        gamma: body(),
        evaluate: Some(body()),
        branches: body(),
        limits: body(),
        phases: quote! {},
        speeds: quote! {},
        outputs: body(),
        factors: quote! {
            #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
            pub struct __Factors<T>([T; 0]);
        },
        short: false,
        factorizes_in_line: false,
        solve_with_position: body(),
        solve_blocks: None,
        solve_motion: None,
        methods: TokenStream::new(),
        parts: TokenStream::new(),
        factorize: body(),
        solve_linear: body(),
        // A constant: the compiler computes it.
        work: quote! { #runtime::Work::NONE },
        independent: Vec::new(),
        complete: body(),
        reduce: body(),
        dynamics: model.dynamics.as_ref().map(|_| DynamicBodies::all(body)),
    }
}

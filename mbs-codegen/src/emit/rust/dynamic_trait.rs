//! `impl Dynamic`: the functions of masses and forces, starts, and tables of states, forces and loads.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use crate::emit::rust::dynamics::DynamicBodies;
use crate::model::Model;
use crate::model::dynamics::Dynamics as Declared;
use crate::model::expression::Node;

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
        set_valued,
        events,
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
            #set_valued
            #events
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

//! Events: their table, the function of their conditions, and access to the values that they set.

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use crate::emit::rust::code::body;
use crate::emit::rust::scope::Scope;
use crate::equations::{Condition, Equations, Events};
use crate::program::Section;

/// Number of values that events set, where there are any.
pub fn remembered(equations: &Equations) -> Option<usize> {
    let events = &equations.dynamics.as_ref()?.events;
    let count = events.conditions.len() + events.latched.len();
    (count > 0).then_some(count)
}

/// Items of `Dynamic` for a text that has events.
pub fn items(events: &Events, section: &Section, scope: &Scope<'_>, runtime: &TokenStream) -> TokenStream {
    let Some(declared) = scope.model.dynamics.as_ref().filter(|_| !events.conditions.is_empty()) else {
        return TokenStream::new();
    };
    let entries = declared.events.iter().map(|event| {
        let (name, line) = (&event.name, quote_spanned!(event.span=> ::core::line!()));
        quote! { #runtime::Entry { name: #name, unit: "1", line: #line } }
    });
    let owners = declared.latches.iter().filter_map(|latch| u16::try_from(latch.event?).ok());
    let (n, m) = (scope.model.coordinates.len(), scope.model.rows.len());
    let states = declared.states.len();
    let condition = |[larger, smaller]: &Condition| {
        let (larger, smaller) = (scope.operand(*larger), scope.operand(*smaller));
        format!("__mbs::dynamics::Condition {{ larger: {larger}, smaller: {smaller} }}")
    };
    let events_text = events.conditions.iter().map(|(begins, ends)| {
        let ends = match ends {
            Some(ends) => format!("::core::option::Option::Some({})", condition(ends)),
            None => "::core::option::Option::None".to_owned(),
        };
        format!("__mbs::dynamics::Event {{ begins: {}, ends: {ends} }}", condition(begins))
    });
    let events_text = events_text.collect::<Vec<_>>().join(", ");
    let latched = events.latched.iter().map(|value| scope.operand(*value)).collect::<Vec<_>>().join(", ");
    let accelerations = events.use_accelerations(scope.graph);
    let watch = body(section, scope, &format!("__see(&[{events_text}], &[{latched}])"), runtime);
    quote! {
        const EVENTS: &'static [#runtime::Entry] = &[#(#entries),*];
        const LATCHED_BY: &'static [::core::primitive::u16] = &[#(#owners),*];
        const EVENTS_USE_ACCELERATIONS: ::core::primitive::bool = #accelerations;
        #[inline]
        fn remembered(__p: &__Parameters<T>) -> &[T] {
            &__p.3
        }
        #[inline]
        fn remembered_mut(__p: &mut __Parameters<T>) -> &mut [T] {
            &mut __p.3
        }
        fn events(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __motion: &#runtime::DynamicState<'_, T, #n, #m, [T; #states]>,
            __see: impl FnOnce(&[#runtime::dynamics::Event<T>], &[T]),
        ) {
            let #runtime::DynamicState { qd: __qd, qdd: __qdd, lambda: __lambda, states: __z } = *__motion;
            #watch
        }
    }
}

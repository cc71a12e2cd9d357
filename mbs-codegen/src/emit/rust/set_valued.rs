//! Frictions with stiction and rigid contacts: their table, the function of their rows, and access to how they stick and slide.

use std::fmt::Write;

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use crate::emit::rust::code::{block, lets};
use crate::emit::rust::scope::Scope;
use crate::equations::SetValuedRow;
use crate::program::Section;

/// Items of `Dynamic` for a text that has such frictions.
pub fn items(
    rows: &[SetValuedRow],
    section: &Section,
    scope: &Scope<'_>,
    runtime: &TokenStream,
) -> TokenStream {
    let Some(declared) = scope.model.dynamics.as_ref().filter(|_| !rows.is_empty()) else {
        return TokenStream::new();
    };
    let entries = declared.set_valued.iter().map(|friction| {
        let (name, line) = (&friction.name, quote_spanned!(friction.span=> ::core::line!()));
        quote! { #runtime::Entry { name: #name, unit: "N", line: #line } }
    });
    let (n, m) = (scope.model.coordinates.len(), scope.model.rows.len());
    let (states, k) = (declared.states.len(), rows.len());
    let mut text = String::new();
    lets(section, scope, &mut text);
    let _ = writeln!(text, "let mut __rows = [__mbs::dynamics::SetValuedRow::<T, {n}>::new(); {k}];");
    for (index, row) in rows.iter().enumerate() {
        let SetValuedRow { place, rate, gradient, gamma, limit, restitution, ordered, on } = row;
        let some = |value| format!("::core::option::Option::Some({value})");
        let on = on.map(|on| {
            let [coefficient, sliding, sticking] =
                [on.coefficient, on.sliding, on.sticking].map(|id| scope.operand(id));
            format!(
                "__mbs::dynamics::OnContact {{ contact: {}, coefficient: {coefficient}, sliding: {sliding}, sticking: {sticking} }}",
                on.contact
            )
        });
        let fields = [
            ("place", Some(scope.operand(*place))),
            ("rate", Some(scope.or_zero(*rate))),
            ("gamma", Some(scope.or_zero(*gamma))),
            ("limit", limit.map(|limit| scope.operand(limit))),
            ("restitution", restitution.map(|id| some(scope.operand(id)))),
            ("ordered", ordered.then(|| "true".into())),
            ("on", on.map(some)),
        ];
        for (field, value) in fields.into_iter().filter_map(|(field, value)| Some((field, value?))) {
            let _ = writeln!(text, "__rows[{index}].{field} = {value};");
        }
        for (column, entry) in gradient {
            let _ = writeln!(text, "__rows[{index}].gradient[{column}] = {};", scope.operand(*entry));
        }
    }
    let _ = write!(text, "<__See as __mbs::dynamics::WithSetValuedRows<T, {n}>>::at(__see, &__rows)");
    let body = block(&text, runtime);
    let rigid = rows.iter().any(|row| row.restitution.is_some());
    let rigid = rigid.then(|| quote! { const HAS_RIGID_CONTACTS: bool = true; });
    let rubs = rows.iter().any(|row| row.on.is_some());
    let rubs = rubs.then(|| quote! { const HAS_FRICTION_ON_CONTACTS: bool = true; });
    quote! {
        const SET_VALUED: &'static [#runtime::Entry] = &[#(#entries),*];
        #rigid
        #rubs
        #[inline]
        fn set_valued_modes(__p: &__Parameters<T>) -> &[#runtime::dynamics::SetValuedMode<T>] {
            &__p.2
        }
        #[inline]
        fn set_valued_modes_mut(__p: &mut __Parameters<T>) -> &mut [#runtime::dynamics::SetValuedMode<T>] {
            &mut __p.2
        }
        fn set_valued_rows<__See: #runtime::dynamics::WithSetValuedRows<T, #n>>(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; #n],
            __z: &[T; #states],
            __lambda: &[T; #m],
            __see: __See,
        ) -> __See::Output #body
    }
}

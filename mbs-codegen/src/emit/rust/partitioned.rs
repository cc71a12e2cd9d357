//! `impl Partitioned`: the blocks over the dependent coordinates, and factors of M and all rows without their zeros.

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::rust::SceneFunctions;
use crate::emit::rust::functions::Bodies;
use crate::model::Model;

/// The attribute of a function that is inlined always, or perhaps.
pub fn inlined(always: bool) -> TokenStream {
    match always {
        true => quote! { #[inline(always)] },
        false => quote! { #[inline] },
    }
}

/// `impl Partitioned`: the blocks over the dependent coordinates, and the part of a force that the rows carry. With sparse factors a
/// partition is a pair, the blocks first.
pub fn partitioned(
    name: &TokenStream,
    (model, m): (&Model, usize),
    (part, generics): (&SceneFunctions<'_>, &TokenStream),
    runtime: &TokenStream,
) -> TokenStream {
    let n = model.coordinates.len();
    let Bodies {
        solve_with_position, factorize, independent, complete, reduce, is_uncoupled, sparse, ..
    } = &part.bodies;
    let uncoupled = is_uncoupled.then(|| quote! { const IS_UNCOUPLED: ::core::primitive::bool = true; });
    let (mut freedom, inline) = (independent.len(), inlined(part.bodies.factorizes_in_line));
    // For a square text these are the functions of `Kinematic`.
    let (solve_blocks, factorize) = match part.square {
        true => (
            quote! { #runtime::Kinematic::solve_blocks(self, __p, __q, __t, __solver) },
            quote! { { #runtime::Kinematic::factorize(self, __p, __s) } },
        ),
        false => (
            quote! {
                (|| -> (T::Lanes<#runtime::Outcome>, __Position<T>) #solve_with_position)().0
            },
            factorize.clone(),
        ),
    };
    let mut table = TokenStream::new();
    let mut by_rows = TokenStream::new();
    let (mut kind, mut partition) = (quote! { __Factors<T> }, factorize);
    let (mut complete, mut reduce) = (complete.clone(), reduce.clone());
    if let Some(sparse) = sparse {
        let (factors, factorized) = (sparse.factors(runtime), sparse.factorized(n, runtime));
        table = sparse.table(runtime);
        kind = quote! { (__Factors<T>, #factors) };
        partition = quote! { {
            let (__blocks, __margin) = #partition;
            ((__blocks, #factorized), __margin)
        } };
        let of_blocks = |body: &TokenStream| quote! { { let __factors = &__factors.0; #body } };
        (complete, reduce) = (of_blocks(&complete), of_blocks(&reduce));
        by_rows = quote! {
            const IS_SPARSE: ::core::primitive::bool = true;
            #[inline]
            fn margin_of_rows(__factors: &#kind) -> T { __factors.1.margin() }
            #[inline]
            fn solve_by_rows(
                __factors: &#kind,
                __force: &[T; #n],
                __gamma: &[T; #m],
            ) -> #runtime::dynamics::Transformed<T, #n, #m> { __factors.1.solve(&__ORDER, __force, __gamma) }
        };
        // No motion of an independent coordinate is needed.
        freedom = 0;
    }
    quote! {
        #table
        impl<#generics> #runtime::Partitioned<T, #n, #m> for #name {
            type Partition = #kind;
            const INDEPENDENT: &'static [::core::primitive::u16] = &[#(#independent),*];
            #uncoupled
            #by_rows
            #[inline]
            fn solve_dependent<__S: #runtime::BlockSolver<T>>(
                &self,
                __p: &__Parameters<T>,
                __q: &mut [T; #n],
                __t: T,
                __solver: &mut __S,
            ) -> T::Lanes<#runtime::Outcome> { #solve_blocks }
            #inline
            fn partition(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> (#kind, #runtime::Margin<T>) #partition
            #inline
            fn complete(&self, __factors: &#kind, __b: &[T; #m], __x: &mut [T; #n]) #complete
            #inline
            fn reduce(&self, __factors: &#kind, __y: &mut [T; #n]) -> [T; #m] #reduce
            #[inline(always)]
            fn accelerations(
                &self,
                __p: &<Self as #runtime::Mechanism<T, #n, #m>>::Parameters,
                __s: &<Self as #runtime::Mechanism<T, #n, #m>>::Position,
                __factors: &<Self as #runtime::Partitioned<T, #n, #m>>::Partition,
                __force: &[T; #n],
                __gamma: &[T; #m],
            ) -> #runtime::dynamics::Transformed<T, #n, #m>
            where
                Self: #runtime::Dynamic<T, #n, #m>,
            {
                #runtime::__private::accelerations::<Self, T, #n, #m, #freedom>(
                    self, __p, __s, __factors, __force, __gamma,
                )
            }
        }
    }
}

/// `impl Partitioned` of a text that has no blocks of its own coordinates: [`partitioned`] without any.
pub fn unpartitioned(
    name: &TokenStream,
    (model, m): (&Model, usize),
    generics: &TokenStream,
    runtime: &TokenStream,
) -> TokenStream {
    let n = model.coordinates.len();
    let zero = quote! { T::constant(0.0f64) };
    quote! {
        impl<#generics> #runtime::Partitioned<T, #n, #m> for #name {
            type Partition = ();
            const IS_PARTITIONED: ::core::primitive::bool = false;
            const INDEPENDENT: &'static [::core::primitive::u16] = &[];
            fn solve_dependent<__S: #runtime::BlockSolver<T>>(
                &self,
                _: &__Parameters<T>,
                _: &mut [T; #n],
                _: T,
                _: &mut __S,
            ) -> T::Lanes<#runtime::Outcome> {
                T::per_lane(|_| #runtime::Outcome::NotConverged { row: 0 })
            }
            fn partition(&self, _: &__Parameters<T>, _: &__Position<T>) -> ((), #runtime::Margin<T>) {
                ((), #runtime::Margin::regular().with_block(#zero, 0, 0))
            }
            fn complete(&self, _: &(), _: &[T; #m], _: &mut [T; #n]) {}
            fn reduce(&self, _: &(), _: &mut [T; #n]) -> [T; #m] {
                [#zero; #m]
            }
            fn accelerations(
                &self,
                _: &<Self as #runtime::Mechanism<T, #n, #m>>::Parameters,
                _: &<Self as #runtime::Mechanism<T, #n, #m>>::Position,
                _: &<Self as #runtime::Partitioned<T, #n, #m>>::Partition,
                _: &[T; #n],
                _: &[T; #m],
            ) -> #runtime::dynamics::Transformed<T, #n, #m> {
                #runtime::dynamics::Transformed {
                    qdd: [#zero; #n],
                    lambda: [#zero; #m],
                    inert: false,
                }
            }
        }
    }
}

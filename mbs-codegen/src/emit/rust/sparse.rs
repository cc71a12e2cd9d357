//! Sparse factors of M and all rows: tables of their order, and the functions that use them.

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::rust::code::{array, body};
use crate::emit::rust::scope::Scope;
use crate::equations::Equations;
use crate::program::Program;
use crate::structure::Structure;
use crate::structure::sparse::{SparseOrder, order};

/// Order of the elimination, and masses, of a partition with sparse factors.
pub struct Sparse {
    order: SparseOrder,
    /// Body of the entries of M with `column <= row`.
    masses: TokenStream,
    /// `true` if the factors of the blocks keep all entries of Φ_q.
    is_long: bool,
}

impl Sparse {
    /// Before: the program of a model. After: its sparse factors, where they save much.
    pub fn of(
        equations: &Equations,
        structure: &Structure,
        program: &Program,
        (scope, is_long): (&Scope<'_>, bool),
        runtime: &TokenStream,
    ) -> Option<Self> {
        let (dynamics, section) = (equations.dynamics.as_ref()?, &program.dynamics.as_ref()?.mass);
        if structure.square || structure.has_surplus() {
            return None;
        }
        let order = order(equations, structure.independent.len())?;
        let masses = dynamics.mass.iter().enumerate().flat_map(|(row, entries)| {
            entries.iter().filter(move |(column, _)| *column <= row).map(|(_, entry)| Some(*entry))
        });
        let masses = body(section, scope, &array(masses, scope), runtime);
        Some(Sparse { order, masses, is_long })
    }

    /// The constant with the tables of the order.
    pub fn table(&self, runtime: &TokenStream) -> TokenStream {
        let SparseOrder { unknowns, lengths, below, targets, masses, rows } = &self.order;
        let short = |numbers: &[usize]| numbers.iter().map(|number| *number as u16).collect::<Vec<_>>();
        let long = |numbers: &[usize]| numbers.iter().map(|number| *number as u32).collect::<Vec<_>>();
        let [unknowns, lengths, below, targets] =
            [unknowns, lengths, below, targets].map(|numbers| short(numbers));
        let [masses, rows] = [masses, rows].map(|numbers| long(numbers));
        quote! {
            const __ORDER: #runtime::__private::SparseOrder = #runtime::__private::SparseOrder {
                unknowns: &[#(#unknowns),*],
                lengths: &[#(#lengths),*],
                below: &[#(#below),*],
                targets: &[#(#targets),*],
                masses: &[#(#masses),*],
                rows: &[#(#rows),*],
            };
        }
    }

    /// The type of the factors.
    pub fn factors(&self, runtime: &TokenStream) -> TokenStream {
        let (pivots, entries) = (self.order.unknowns.len(), self.order.below.len());
        quote! { #runtime::__private::SparseFactors<T, #pivots, #entries> }
    }

    /// The factors at a position, an expression beside the blocks `__blocks`.
    pub fn factorized(&self, coordinates: usize, runtime: &TokenStream) -> TokenStream {
        let (kind, masses) = (self.factors(runtime), &self.masses);
        let rows = match self.is_long {
            true => quote! { __blocks.entries },
            false => quote! { #runtime::Mechanism::phi_q_entries(self, __p, __s) },
        };
        quote! { <#kind>::factorize(&__ORDER, #coordinates, &#masses, &#rows) }
    }
}

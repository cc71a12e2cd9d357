//! Operation counts of the emitted functions of the kinematics, for the worst case of a step.

use std::collections::BTreeMap;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::emit::rust::elimination::{self, Cost};
use crate::equations::Equations;
use crate::model::{Model, Role};
use crate::program::{BlockMethod, Operations, Program};

/// `Work { … }`: the counts that the documentation's table shows, as a constant.
pub fn work(
    model: &Model,
    equations: &Equations,
    program: &Program,
    entries: usize,
    runtime: &TokenStream,
) -> TokenStream {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    let (branches, limits, phases) = (model.branches.len(), model.limits.len(), model.phases.len());
    let inputs = model.fields.iter().filter(|field| field.role == Role::InputWithRates);
    let inputs: usize = inputs.map(|field| field.shape.iter().product::<usize>()).sum();
    let of = |count: Operations| operations(count, runtime);
    let (variables, parameters) = (model.variables.len(), of(program.parameters.section.operations));
    let position = of(program.position.section.operations);
    let (phi, phi_q) = (of(program.phi.operations), of(program.phi_q.operations));
    let (phi_t, gamma) = (of(program.phi_t.operations), of(program.gamma.operations));
    let (branch_values, limit_values) = (of(program.branches.operations), of(program.limits.operations));
    let phase_speeds = of(program.phase_speeds.operations);
    let coordinate_scales = of(program.coordinate_scales.operations);
    let row_scales = of(program.row_scales.operations);
    let mut blocks = Kinds::default();
    for block in &program.blocks {
        let (unknowns, evaluation) = match &block.method {
            BlockMethod::Explicit { .. } => (0, Operations::default()),
            BlockMethod::Newton(system) => (block.coordinates.len(), system.section.operations),
        };
        let (before, evaluation) = (of(block.before.operations), of(evaluation));
        let rows = block.rows.len();
        let Cost { elimination, comparisons, substitution, last } = elimination::cost(equations, block);
        let comparisons = Literal::usize_unsuffixed(comparisons);
        let order = if last > 0 {
            let (elimination, substitution) = (of(elimination), of(substitution));
            quote! {
                elimination: #runtime::Operations { comparisons: #comparisons, ..#elimination },
                substitution: #substitution,
                last: #last,
            }
        } else {
            quote! { ..#runtime::BlockWork::NONE }
        };
        blocks.add(quote! {
            unknowns: #unknowns, rows: #rows, before: #before, evaluation: #evaluation, #order
        });
    }
    // Rest of the position stage after the blocks.
    let rest = of(program.rest.operations);
    blocks.add(quote! { before: #rest, ..#runtime::BlockWork::NONE });
    let blocks = blocks.kinds.into_iter().map(|(count, costs)| {
        quote! { #runtime::BlockWork { count: #count, #costs } }
    });
    quote! {
        #runtime::Work {
            coordinates: #n,
            rows: #m,
            entries: #entries,
            branches: #branches,
            limits: #limits,
            phases: #phases,
            inputs: #inputs,
            variables: #variables,
            parameters: #parameters,
            position: #position,
            phi: #phi,
            phi_q: #phi_q,
            phi_t: #phi_t,
            gamma: #gamma,
            branch_values: #branch_values,
            limit_values: #limit_values,
            phase_speeds: #phase_speeds,
            coordinate_scales: #coordinate_scales,
            row_scales: #row_scales,
            blocks: &[#(#blocks),*],
        }
    }
}

/// Blocks that cost the same, counted, in the order in which the first of each comes.
#[derive(Default)]
struct Kinds {
    kinds: Vec<(usize, TokenStream)>,
    /// Index by the emitted code.
    places: BTreeMap<String, usize>,
}

impl Kinds {
    fn add(&mut self, costs: TokenStream) {
        let place = *self.places.entry(costs.to_string()).or_insert(self.kinds.len());
        match self.kinds.get_mut(place) {
            Some((count, _)) => *count += 1,
            None => self.kinds.push((1, costs)),
        }
    }
}

/// Code of the counts: those that are not zero, the others as in `NONE`.
fn operations(count: Operations, runtime: &TokenStream) -> TokenStream {
    let Operations { additions, multiplications, divisions, sine_cosines, functions, selects, calls } = count;
    let kinds = [
        (quote! { additions }, additions),
        (quote! { multiplications }, multiplications),
        (quote! { divisions }, divisions),
        (quote! { sine_cosines }, sine_cosines),
        (quote! { functions }, functions),
        (quote! { selections }, selects),
        (quote! { calls }, calls),
    ];
    let counted = kinds.into_iter().filter(|(_, count)| *count > 0).map(|(kind, count)| {
        let count = Literal::usize_unsuffixed(count);
        quote! { #kind: #count, }
    });
    if count == Operations::default() {
        return quote! { #runtime::Operations::NONE };
    }
    quote! { #runtime::Operations { #(#counted)* ..#runtime::Operations::NONE } }
}

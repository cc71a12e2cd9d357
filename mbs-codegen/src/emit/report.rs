//! The structure as data, for programs that draw or print it.

use crate::emit::rust::docs;
use crate::equations::Equations;
use crate::model::Model;
use crate::program::{BlockMethod, Operations, Program, Section};
use crate::structure::Structure;
use crate::structure::dyad::Dyad;
use crate::structure::mobility::{Mobility, mobility};
use crate::symbolic::Stage;

/// Sparsity, matching and block-triangular order of a mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StructureReport {
    /// Name of the mechanism.
    pub name: String,
    /// Coordinates in the order of q: N.
    pub coordinates: Vec<CoordinateReport>,
    /// Rows in the order of Φ: M.
    pub rows: Vec<RowReport>,
    /// Degrees of freedom as they are counted.
    pub mobility: Mobility,
    /// Indices of the coordinates that the text names as independent; none where it does not say.
    pub independent: Vec<usize>,
    /// Diagonal blocks in the order in which they are solved.
    pub blocks: Vec<BlockReport>,
    /// Operations of one step of all functions, with one Newton iteration of every block.
    pub operations: usize,
    /// Operations of each emitted function, on top of the stages before it, as the generated documentation has them.
    pub costs: Vec<(&'static str, Operations)>,
}

/// A coordinate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoordinateReport {
    /// Name as the text spells it.
    pub name: String,
    /// Unit as the text spells it.
    pub unit: String,
}

/// A row of Φ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RowReport {
    /// Name of its group, with its number where the group has several.
    pub name: String,
    /// Unit of the residual.
    pub unit: String,
    /// `true` if a `drive` declares it.
    pub driven: bool,
    /// `true` if it may follow from others: its constraint is marked `redundant`.
    pub redundant: bool,
    /// Entries of the row of Φ_q that are not structurally zero: index of the coordinate and kind, ascending.
    pub entries: Vec<(usize, EntryKind)>,
    /// Index of the coordinate that the matching gives the row.
    pub matched: Option<usize>,
}

/// Dependence of an entry of Φ_q.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryKind {
    /// None: a number.
    Number,
    /// Parameters alone.
    Parameters,
    /// Coordinates, time or inputs.
    Varies,
}

/// A diagonal block of the block-triangular order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockReport {
    /// Indices of its rows, ascending.
    pub rows: Vec<usize>,
    /// Indices of its coordinates, ascending, as many as rows; fewer where rows may follow from others.
    pub coordinates: Vec<usize>,
    /// `true` if the coordinate is assigned, not solved for.
    pub explicit: bool,
    /// The dyad that it is: both its positions are known as formulas.
    pub dyad: Option<&'static str>,
    /// Method of the linear solution for four and more unknowns.
    pub elimination: String,
}

/// Before: a mechanism without faults. After: its structure, names and indices alone.
pub fn report(
    model: &Model,
    equations: &Equations,
    structure: &Structure,
    program: &Program,
    name: &str,
) -> StructureReport {
    let kind = |stage: Stage| match stage {
        Stage::Constant => EntryKind::Number,
        Stage::Parameter => EntryKind::Parameters,
        Stage::Position | Stage::Velocity | Stage::Acceleration => EntryKind::Varies,
    };
    let entries = |row: &crate::equations::Row| {
        row.phi_q.iter().map(|(column, entry)| (*column, kind(equations.graph.stage(*entry)))).collect()
    };
    let rows = model.rows.iter().zip(&equations.rows).enumerate().map(|(index, (row, equation))| RowReport {
        name: row.name.clone(),
        unit: row.unit(model),
        driven: row.driven,
        redundant: row.redundant,
        entries: entries(equation),
        matched: structure.matched.get(index).copied().flatten(),
    });
    let blocks = structure.blocks.iter().map(|block| BlockReport {
        rows: block.rows.clone(),
        coordinates: block.coordinates.clone(),
        explicit: block.explicit.is_some(),
        dyad: block.dyad.as_ref().map(Dyad::name),
        elimination: docs::elimination(model, block),
    });
    let coordinates = model.coordinates.iter();
    StructureReport {
        name: name.into(),
        coordinates: coordinates
            .map(|c| CoordinateReport { name: c.name.clone(), unit: c.unit.clone() })
            .collect(),
        rows: rows.collect(),
        mobility: mobility(model, equations),
        independent: model.independent.iter().map(|chosen| chosen.coordinate).collect(),
        blocks: blocks.collect(),
        operations: operations(program),
        costs: docs::costs(program),
    }
}

/// Number of operations of one step: each block once, then all functions of the solved position.
fn operations(program: &Program) -> usize {
    let functions = [
        &program.position.section,
        &program.phi_q,
        &program.phi_t,
        &program.gamma,
        &program.branches,
        &program.limits,
        &program.outputs,
    ];
    let iterations = program.blocks.iter().filter_map(|block| match &block.method {
        BlockMethod::Newton(system) => Some(&system.section),
        BlockMethod::Explicit { .. } => None,
    });
    let blocks = program.blocks.iter().map(|block| &block.before).chain(iterations);
    functions.into_iter().chain(blocks).map(count).sum()
}

fn count(section: &Section) -> usize {
    let Operations { additions, multiplications, divisions, sine_cosines, functions, selects, calls } =
        section.operations;
    [additions, multiplications, divisions, sine_cosines, functions, selects, calls].into_iter().sum()
}

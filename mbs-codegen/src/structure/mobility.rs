//! Degrees of freedom as they are counted, independent of the position: structural rank, and Grübler's count.

use super::matching;
use crate::equations::Equations;
use crate::model::Model;
use crate::model::dynamics::Rotation;

/// Coordinates, rows and bodies of a mechanism.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mobility {
    /// Coordinates.
    pub coordinates: usize,
    /// Rows of constraints.
    pub constraints: usize,
    /// Rows of drives.
    pub drives: usize,
    /// Largest rank that the sparsity of the constraints allows.
    pub constraint_rank: usize,
    /// Largest rank that the sparsity of all rows allows.
    pub rank: usize,
    /// Bodies with an angle.
    pub bodies: usize,
    /// Point masses.
    pub points: usize,
    /// Degrees of freedom that all of these would have without joints. A body has 3 in the plane and 6 in space,
    /// a point one for each dimension.
    pub apart: usize,
    /// Kinetic energies of the text: masses in addition to the declared bodies, which are in none of these counts.
    pub energies: usize,
}

impl Mobility {
    /// Degrees of freedom that the drives leave: coordinates less the structural rank of all rows.
    pub fn freedom(&self) -> usize {
        self.coordinates.saturating_sub(self.rank)
    }

    /// Grübler's count: coordinates less rows of constraints, those that follow from others among them.
    ///
    /// Grübler counts 3 for each body less 2 for each joint, in space 6 less 5. Each set of coordinates leaves out as many
    /// freedoms of bodies as equations of joints. So the difference is the same in relative, reference-point and natural
    /// coordinates.
    /// Source: García de Jalón & Bayo 1994, §2.1.
    pub fn grubler(&self) -> isize {
        difference(self.coordinates, self.constraints)
    }

    /// Degrees of freedom that joints and guides take from the declared bodies. `None` where no bodies are declared, or
    /// so few that the coordinates have more freedoms than they.
    pub fn taken(&self) -> Option<usize> {
        let taken = difference(self.apart, 0) - self.grubler();
        usize::try_from(taken).ok().filter(|_| self.apart > 0)
    }
}

fn difference(a: usize, b: usize) -> isize {
    let of = |count: usize| isize::try_from(count).unwrap_or(isize::MAX);
    of(a).saturating_sub(of(b))
}

/// Before: the equations of a model. After: its counts.
pub fn mobility(model: &Model, equations: &Equations) -> Mobility {
    let n = model.coordinates.len();
    let sparsity = |driven: bool| -> Vec<Vec<usize>> {
        let rows = model.rows.iter().zip(&equations.rows).filter(|(row, _)| driven || !row.driven);
        rows.map(|(_, row)| row.phi_q.iter().map(|(column, _)| *column).collect()).collect()
    };
    let rank = |rows: &[Vec<usize>]| n - matching::match_rows(rows, n).free_columns().count();
    let (constraints, all) = (sparsity(false), sparsity(true));
    let declared = model.dynamics.iter().flat_map(|dynamics| &dynamics.bodies);
    let (mut bodies, mut points, mut apart) = (0, 0, 0);
    for body in declared {
        match body.rotation {
            Some(Rotation::Plane { .. }) => (bodies, apart) = (bodies + 1, apart + 3),
            Some(Rotation::Space { .. }) => (bodies, apart) = (bodies + 1, apart + 6),
            None => (points, apart) = (points + 1, apart + body.com.len()),
        }
    }
    Mobility {
        coordinates: n,
        constraints: constraints.len(),
        drives: all.len() - constraints.len(),
        constraint_rank: rank(&constraints),
        rank: rank(&all),
        bodies,
        points,
        apart,
        energies: model.dynamics.as_ref().map_or(0, |dynamics| dynamics.kinetics.len()),
    }
}

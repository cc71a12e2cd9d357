//! Rows that are marked `redundant` where none can follow from others.

use super::Model;
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Statement, StatementKind};

/// Before: a text without faults, and the models of its scenes. After: constraints that are marked `redundant` are reported where
/// no scene has more rows than coordinates. Without masses all rows are then needed to fix the coordinates.
pub fn check<'a>(
    statements: &[Statement],
    mut models: impl Iterator<Item = &'a Model> + Clone,
    diagnostics: &mut Diagnostics,
) {
    let sizes = models.clone().map(|model| (model.rows.len(), model.coordinates.len())).max();
    let may_follow = |model: &Model| model.dynamics.is_some() || model.rows.len() > model.coordinates.len();
    if models.any(may_follow) {
        return;
    }
    let (rows, coordinates) = sizes.unwrap_or_default();
    for statement in statements {
        let StatementKind::Constraint { name, redundant: Some(span), within, .. } = &statement.kind else {
            continue;
        };
        let words = if within.is_some() { "redundant within …" } else { "redundant" };
        let message = format!(
            "no row of `{}` follows from others: {rows} rows fix {coordinates} coordinates, and all are needed",
            name.text
        );
        diagnostics.report(*span, message, format!("remove `{words}`"));
    }
}

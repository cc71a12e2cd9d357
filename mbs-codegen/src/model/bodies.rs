//! Bodies: their masses and rotations, in a plane or in space.

use super::dynamics::{Body, Rotation};
use super::element_fields::ORIENTATION;
use super::inertia::Inertia;
use super::masses_and_forces::Given;
use super::resolver::Resolver;
use super::value::{Fault, Value};
use crate::syntax::ast::Name;

impl Resolver<'_> {
    /// Before: fields of a body. After: it is in the model, or its faults are reported.
    pub(super) fn body(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        let rotation = self.rotation(name, given)?;
        let mass = given.scalar("mass").ok_or(Fault)?;
        let space = given.vector("com").len();
        if let Some(field) = self.dynamics().gravity.iter().map(Vec::len).find(|field| *field != space) {
            return Err(self.other_space(name, space, field));
        }
        if let (Some(Rotation::Space { inertia, .. }), Some(value)) = (&rotation, given.value("inertia")) {
            let (of, entries) = (name.text.clone(), inertia.clone());
            self.dynamics().inertias.push(Inertia { of, entries, span: value.span });
        }
        self.dynamics().bodies.push(Body { name: full, mass, com: given.vector("com"), rotation });
        Ok(())
    }

    /// A field of gravity, which must have as many components as the bodies' centres of mass.
    pub(super) fn gravity(&mut self, name: &Name, given: &Given) -> Result<(), Fault> {
        let field = given.vector("acceleration");
        let spaces = self.dynamics().bodies.iter().map(|body| body.com.len());
        if let Some(space) = spaces.into_iter().find(|space| *space != field.len()) {
            return Err(self.other_space(name, space, field.len()));
        }
        self.dynamics().gravity.push(field);
        self.dynamics().gravity_names.push((name.text.clone(), name.span));
        Ok(())
    }

    fn other_space(&mut self, name: &Name, space: usize, field: usize) -> Fault {
        let message = format!("`{}`: centres of mass of {space} components, gravity of {field}", name.text);
        self.fault(name.span, message, "give points and gravity as many components as the space has")
    }

    /// Inertia and orientation of a body: both or none.
    fn rotation(&mut self, name: &Name, given: &Given) -> Result<Option<Rotation>, Fault> {
        let body = &name.text;
        let (message, help) = match (given.value("inertia"), given.scalar("angle"), given.value(ORIENTATION))
        {
            (None, None, None) => return Ok(None),
            (Some(inertia), Some(angle), None) => match inertia.items.as_slice() {
                [inertia] => return Ok(Some(Rotation::Plane { inertia: inertia.id, angle })),
                _ => (
                    format!("body `{body}` has the inertia of a body in space and an angle"),
                    "give one moment of inertia, or write `orientation: e` with 4 Euler parameters",
                ),
            },
            (Some(inertia), None, Some(orientation)) => {
                if given.vector("com").len() == 3 {
                    return turning(inertia, orientation).map(Some).ok_or_else(|| {
                        let message = format!("body `{body}` in space has one moment of inertia");
                        let help = "write `inertia: [Jxx, Jyy, Jzz]` about the axes of the body; a plane body turns with `angle`";
                        self.fault(inertia.span, message, help)
                    });
                }
                (
                    format!("body `{body}` has an orientation and a centre of mass in a plane"),
                    "write `com: [x, y, z]`",
                )
            }
            (_, Some(_), Some(_)) => (
                format!("body `{body}` has an angle and an orientation"),
                "a body in a plane turns with its angle, one in space with its orientation",
            ),
            (Some(_), None, None) => (
                format!("body `{body}` has an inertia and no angle"),
                "write what turns: `angle: phi`, in space `orientation: e`",
            ),
            (None, Some(_), None) => (
                format!("body `{body}` has an angle and no inertia"),
                "write `inertia: …` about the centre of mass, or leave out both for a point mass",
            ),
            (None, None, Some(_)) => (
                format!("body `{body}` has an orientation and no inertia"),
                "write `inertia: [Jxx, Jyy, Jzz]` about the axes of the body, or leave out both for a point mass",
            ),
        };
        Err(self.fault(name.span, message, help))
    }
}

/// A body in space; `None` where its inertia is that of a plane.
fn turning(inertia: &Value, orientation: &Value) -> Option<Rotation> {
    const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    if inertia.shape.is_empty() {
        return None;
    }
    let entries = PLACES.iter().zip(&inertia.items);
    let inertia = entries.map(|((row, column), item)| (*row, *column, item.id)).collect();
    let &[e0, x, y, z] = orientation.items.as_slice() else { return None };
    Some(Rotation::Space { inertia, orientation: [e0.id, x.id, y.id, z.id] })
}

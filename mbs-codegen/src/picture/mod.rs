//! Title, presets, span and picture of a mechanism, read from its text on demand.
//!
//! The macro checks these statements and emits no code for them. A program reads them from the `SOURCE` of a mechanism by
//! [`picture`].

mod content;
mod draw;
mod found;
mod guess;
mod pin_forces;
mod places;
mod settings;
mod shape;

use std::collections::BTreeSet;

use content::Content;
pub(crate) use content::MOST_SHAPES;
use places::Places;
pub use places::{Place, PlaceKind};
pub use shape::{Along, Shape};

use crate::diagnostics::Diagnostics;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::symbolic::{Graph, Leaf, NodeId, evaluate::evaluate};
use crate::syntax::Text;

/// Title, presets, span and shapes of a scene, with the functions of its points.
#[derive(Debug)]
pub struct Picture {
    /// Heading: that of the text, else the name of the mechanism.
    pub title: String,
    /// One or two sentences: those of the text, else its doc comment.
    pub about: String,
    /// Motions worth showing; none where the text has none.
    pub presets: Vec<Preset>,
    /// Duration of a motion, where the text has one.
    pub span: Option<Span>,
    /// Shapes in the order of the text.
    pub shapes: Vec<Shape>,
    /// Outputs that are the force in a pin, each with the place of its pin.
    pub forces: Vec<PinForce>,
    /// `true` if the text draws no shape and the shapes are guessed from its points.
    pub is_guessed: bool,
    /// Points, angles and directions of the shapes, each once.
    places: Vec<Place>,
    graph: Graph,
    /// Components of each place; none where only the mechanism can evaluate them.
    roots: Vec<Vec<NodeId>>,
}

/// The force in a pin as an output, `out bearing: [N; 2] = reaction(O, crank);`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PinForce {
    /// Name of the output without its component.
    pub output: String,
    /// Name of the [`Place`] at which it acts.
    pub at: String,
}

/// A motion worth showing: parameters and inputs that differ from the defaults of the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Short name.
    pub label: String,
    /// One phrase; may be empty.
    pub description: String,
    /// Parameters and inputs by name, component by component, in coherent SI units.
    pub set: Vec<(String, f64)>,
}

/// Duration of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Span {
    /// One turn at the angular velocity (rad/s) that a parameter or input gives.
    Turn {
        /// Its name.
        rate: String,
    },
    /// A fixed time (s).
    Seconds(f64),
}

/// The picture of a scene (without a name the whole text) of a text that is kept as a string, a mechanism's `SOURCE` for
/// instance.
///
/// In the scene of all effects a heading may occur in several; there the first one counts.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`; or a list of the scenes.
pub fn picture(source: &str, scene: Option<&str>) -> Result<Picture, String> {
    let mut diagnostics = Diagnostics::default();
    let (text, scenes) = match crate::model::scenes::read_source(source, &mut diagnostics) {
        Some(read) if diagnostics.is_empty() => read,
        _ => return Err(diagnostics.to_text()),
    };
    let strict = !scenes.are_declared() || scenes.find(scene)?.name.is_some();
    let scene = scenes.take(scene)?;
    if !scene.faults.is_empty() {
        return Err(scene.faults.to_text());
    }
    of_scene(&text, scene, strict, diagnostics)
}

fn of_scene(
    text: &Text,
    mut scene: Scene,
    strict: bool,
    mut diagnostics: Diagnostics,
) -> Result<Picture, String> {
    let (mut names, mut expressions) = (scene.names.clone(), scene.model.expressions.clone());
    let mut content =
        content::read(&text.pictured, &scene, (&mut names, &mut expressions), strict, &mut diagnostics);
    let is_guessed = content.shapes.is_empty();
    if is_guessed && diagnostics.is_empty() {
        let mut places = Places::new(&scene.model, &mut names, &mut expressions, &mut diagnostics);
        content.shapes = guess::guess(&mut places);
        content.places = places.known;
        let used: BTreeSet<&str> = content.shapes.iter().flat_map(Shape::points).collect();
        content.places.retain(|known| used.contains(known.place.name.as_str()));
    }
    let mut forces = Vec::new();
    if diagnostics.is_empty() {
        let mut places = Places::new(&scene.model, &mut names, &mut expressions, &mut diagnostics);
        places.keep(content.places);
        forces = pin_forces::pin_forces(&mut places);
        content.places = places.known;
    }
    if !diagnostics.is_empty() {
        return Err(diagnostics.to_text());
    }
    scene.model.expressions = expressions;
    let Content { title, about, presets, span, shapes, places } = content;
    let (graph, nodes) = crate::equations::lowered(&scene.model);
    let node = |known: &places::Known| match known.place.is_evaluated {
        true => known.ids.iter().filter_map(|id| nodes.get(id.index()).copied()).collect(),
        false => Vec::new(),
    };
    let name = crate::model::selection::alias(&text.header, scene.label().unwrap_or_default());
    Ok(Picture {
        title: title.unwrap_or(name),
        about: about.unwrap_or_else(|| documentation(text, &scene)),
        presets,
        span,
        shapes,
        forces,
        is_guessed,
        roots: places.iter().map(node).collect(),
        places: places.into_iter().map(|known| known.place).collect(),
        graph,
    })
}

/// Lines of the doc comment of the scene, else of the mechanism, up to the first empty one.
fn documentation(text: &Text, scene: &Scene) -> String {
    let of_header = || {
        text.header.attributes.iter().filter_map(|attribute| match &attribute.meta {
            syn::Meta::NameValue(syn::MetaNameValue {
                path,
                value: syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(line), .. }),
                ..
            }) if path.is_ident("doc") => Some(line.value()),
            _ => None,
        })
    };
    let lines: Vec<String> = if scene.docs.is_empty() { of_header().collect() } else { scene.docs.clone() };
    let lines = lines.iter().map(|line| line.trim()).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}

/// Before: a text whose scenes have no fault. After: faults of its picture, if it has one, are reported.
pub fn check(text: &Text, scenes: &Scenes, diagnostics: &mut Diagnostics) {
    if text.pictured.is_empty() {
        return;
    }
    let mut found = Vec::new();
    for scene in &scenes.scenes {
        let mut faults = Diagnostics::default();
        let (mut names, mut expressions) = (scene.names.clone(), scene.model.expressions.clone());
        content::read(&text.pictured, scene, (&mut names, &mut expressions), true, &mut faults);
        found.push((scene.label(), faults));
    }
    diagnostics.gather(&found, found.len());
}

impl Picture {
    /// Points, angles and directions of the shapes, each once, in the order of [`points`](Self::points).
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Values of all [`places`](Self::places) at a state.
    ///
    /// `q`: coordinates, their rates and accelerations, N each; `t`: time (s); `variables`: parameters and inputs in the order of
    /// `VARIABLES`. A point has its components in metres, an angle (rad) is the first component; components that a place does not
    /// have are 0. All are NaN where [`is_evaluated`](Place::is_evaluated) is false, and where a number is missing.
    pub fn points(&self, q: [&[f64]; 3], t: f64, variables: &[f64]) -> Vec<[f64; 3]> {
        let [position, velocity, acceleration] = q;
        let of = |values: &[f64], index: u32| values.get(index as usize).copied().unwrap_or(f64::NAN);
        let leaf = |leaf: Leaf| match leaf {
            Leaf::Parameter(index) | Leaf::Input(index) => of(variables, index),
            Leaf::Time => t,
            Leaf::Position(index) => of(position, index),
            Leaf::Velocity(index) => of(velocity, index),
            Leaf::Acceleration(index) => of(acceleration, index),
            Leaf::State(_)
            | Leaf::Multiplier(_)
            | Leaf::Direction(_)
            | Leaf::Sliding(_)
            | Leaf::Holding(_)
            | Leaf::Impulse(_)
            | Leaf::Remembered(_)
            | Leaf::Given(..) => f64::NAN,
        };
        let all: Vec<NodeId> = self.roots.iter().flatten().copied().collect();
        let mut values = evaluate(&self.graph, &all, leaf).into_iter();
        let point = |roots: &Vec<NodeId>| {
            let mut point = if roots.is_empty() { [f64::NAN; 3] } else { [0.0; 3] };
            for (component, _) in point.iter_mut().zip(roots) {
                *component = values.next().unwrap_or(f64::NAN);
            }
            point
        };
        self.roots.iter().map(point).collect()
    }
}

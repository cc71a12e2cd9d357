//! The list of mechanisms. A new one is a file with a [`Card`], its `mod` in `lib.rs` and its line in [`ALL`].

use core::fmt;

use mbs_runtime::Failure;

use crate::drawing::Shape;
use crate::facade::{AnyEquations, AnyMechanism, Motion};
pub use crate::motion::instants;

/// Every mechanism; the first one is what `mbs` shows without arguments.
// A static, for what a constant leads to is compiled once more in every program that names it.
pub static ALL: &[&Card] = &[
    &crate::four_bar::CARD,
    &crate::loop_relative::CARD,
    &crate::loop_length::CARD,
    &crate::open_chain::CARD,
    &crate::slider_crank::CARD,
    &crate::five_angle_loop::CARD,
    &crate::four_bar_reference_point::CARD,
    &crate::four_bar_natural::CARD,
    &crate::four_bar_mixed::CARD,
    &crate::determinant_guide::CARD,
    &crate::quick_return::CARD,
    &crate::scotch_yoke::CARD,
    &crate::geneva::CARD,
    &crate::watt::CARD,
    &crate::stephenson::CARD,
    &crate::jansen::CARD,
    &crate::peaucellier::CARD,
    &crate::three_rrr::CARD,
    &crate::cam_flat::CARD,
    &crate::cam_roller::CARD,
    &crate::cam_oscillating::CARD,
    &crate::cam_law::CARD,
    &crate::planetary_gear::CARD,
    &crate::double_parallelogram::CARD,
    &crate::slider_crank_scenes::DRIVEN_CRANK,
    &crate::slider_crank_scenes::DRIVEN_SLIDER,
    &crate::slider_crank_scenes::TELESCOPING_ROD,
    &crate::slider_crank_mass::DRIVEN,
    &crate::four_bar_mass::DRIVEN,
];

/// Mechanisms with masses that their rows leave free to move; forces move them.
pub static FREE: &[&FreeCard] = &[
    &crate::pendulum::CARD,
    &crate::double_pendulum::CARD,
    &crate::cart_pole::CARD,
    &crate::n_four_bar_1::CARD,
    &crate::n_four_bar::CARD,
    &crate::n_four_bar_10::CARD,
    &crate::n_four_bar_40::CARD,
    &crate::andrews::CARD,
    &crate::heavy_top::CARD,
    &crate::car_axis::CARD,
    &crate::quarter_car::CARD,
    &crate::bricard::CARD,
    &crate::governor::CARD,
    &crate::slider_crank_mass::RELEASED,
    &crate::four_bar_mass::RELEASED,
];

/// What the program knows of a mechanism that is free to move.
#[derive(Clone, Copy, Debug)]
pub struct FreeCard {
    /// Name on the command line.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// One or two sentences.
    pub description: &'static str,
    /// What is run: one preset a motion in the report.
    pub runs: &'static [Preset],
    /// How long a motion lasts (s).
    pub duration: f64,
    /// What moves it where nothing is said.
    pub usual: Usual,
    /// How it is drawn.
    pub drawing: &'static [Shape],
    /// A new instance with default parameters.
    pub make: fn() -> Box<dyn AnyEquations>,
}

/// The method that is right for a mechanism; see [`mbs_runtime::dynamics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usual {
    /// Explicit steps, all rows together.
    Projection,
    /// Explicit steps through the blocks of the rows: of many rows the others take too long.
    Velocity,
    /// The same in equal steps of a known cost: where many rows lose rank together, matrices are dense.
    VelocityInEqualSteps,
    /// Implicit steps, extrapolated: the forces are too stiff for explicit ones, and steps of order 2 leave what no other method of
    /// that order leaves less of.
    Extrapolated,
}

/// What the program knows of a mechanism beside its text.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    /// Name on the command line; that of a scene is `text:Scene`.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// One or two sentences.
    pub description: &'static str,
    /// What is run: one preset a motion in the report.
    pub runs: &'static [Preset],
    /// How long a motion lasts.
    pub span: Span,
    /// How it is drawn.
    pub drawing: &'static [Shape],
    /// A new instance with default parameters.
    pub make: fn() -> Box<dyn AnyMechanism>,
}

/// A motion worth showing: parameters that differ from the text's defaults.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Short name.
    pub label: &'static str,
    /// One phrase.
    pub description: &'static str,
    /// Parameters by name, in the unit of the text.
    pub set: &'static [(&'static str, f64)],
}

/// How long a motion lasts.
#[derive(Clone, Copy, Debug)]
pub enum Span {
    /// One turn at the angular velocity (rad/s) that a parameter gives.
    Turn {
        /// Name of the parameter.
        rate: &'static str,
    },
    /// A fixed time (s).
    Seconds(f64),
}

/// A name or a value that does not fit a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Mismatch {
    /// No mechanism of this name.
    Mechanism {
        /// The name asked for.
        name: String,
    },
    /// The text has several scenes, each a mechanism of its own.
    Scenes {
        /// The name asked for.
        name: String,
        /// Their names.
        scenes: Vec<&'static str>,
    },
    /// The mechanism is written in one set of coordinates.
    Alone {
        /// The mechanism.
        name: &'static str,
    },
    /// No variant of the mechanism in these coordinates.
    Coordinates {
        /// The mechanism.
        name: &'static str,
        /// The kind asked for.
        kind: String,
        /// Those that there are.
        known: Vec<&'static str>,
    },
    /// The mechanism is free to move, and the command needs rows that fix it.
    Free {
        /// The name asked for.
        name: String,
    },
    /// No parameter of this name.
    Parameter {
        /// The name asked for.
        name: String,
        /// The mechanism.
        mechanism: &'static str,
        /// The names that there are.
        known: Vec<&'static str>,
    },
    /// A parameter that is no finite number.
    NotFinite {
        /// The parameter.
        name: String,
    },
    /// A turn never ends.
    NoTurn {
        /// The parameter that gives the angular velocity.
        rate: &'static str,
        /// Its value (rad/s).
        value: f64,
    },
}

/// The mechanism called `name`.
///
/// # Errors
/// [`Mismatch::Mechanism`] where there is none; its text lists the known names.
pub fn find(name: &str) -> Result<&'static Card, Mismatch> {
    let found = ALL.iter().copied().find(|card| card.name == name);
    let is_free = FREE.iter().any(|card| card.name == name);
    let name = || name.to_string();
    found.ok_or_else(|| if is_free { Mismatch::Free { name: name() } } else { unknown(&name()) })
}

/// Why there is no mechanism of this name: it is a text of several scenes, or nothing.
fn unknown(name: &str) -> Mismatch {
    let all = ALL.iter().map(|card| card.name).chain(FREE.iter().map(|card| card.name));
    let scenes: Vec<&str> =
        all.filter(|known| known.split_once(':').is_some_and(|(text, _)| text == name)).collect();
    let name = name.to_string();
    if scenes.is_empty() { Mismatch::Mechanism { name } } else { Mismatch::Scenes { name, scenes } }
}

/// Kinds of coordinates that a linkage may be written in; the name of such a mechanism ends with the kind.
pub const KINDS: [&str; 4] = ["relative", "reference_point", "natural", "mixed"];

/// The mechanism called `name` in coordinates of this kind; `relative` is `name` itself where it has variants of other
/// kinds.
///
/// # Errors
/// [`Mismatch::Alone`] where there are no variants, [`Mismatch::Coordinates`] where there is none of this kind.
pub fn variant(name: &str, kind: &str) -> Result<&'static Card, Mismatch> {
    let card = find(name)?;
    let of = |kind: &str| find(&format!("{}_{kind}", card.name)).ok();
    let others: Vec<&'static str> = KINDS.into_iter().filter(|kind| of(kind).is_some()).collect();
    if others.is_empty() {
        return Err(Mismatch::Alone { name: card.name });
    }
    let own = (kind == KINDS[0]).then_some(card);
    of(kind).or(own).ok_or_else(|| {
        let known = KINDS.into_iter().filter(|kind| *kind == KINDS[0] || others.contains(kind)).collect();
        Mismatch::Coordinates { name: card.name, kind: kind.to_string(), known }
    })
}

/// The functions of the mechanism called `name`, whether it is free to move or not.
///
/// # Errors
/// [`Mismatch::Mechanism`] where there is none; its text lists the known names.
pub fn equations(name: &str) -> Result<Box<dyn AnyEquations>, Mismatch> {
    match FREE.iter().find(|card| card.name == name) {
        Some(card) => Ok((card.make)()),
        None => Ok((find(name)?.make)()),
    }
}

/// Sets the parameter or input `name` (coherent SI unit of the text).
///
/// # Errors
/// [`Mismatch::Parameter`] and [`Mismatch::NotFinite`]; the mechanism is then as it was.
pub fn set(mechanism: &mut dyn AnyEquations, name: &str, value: f64) -> Result<(), Mismatch> {
    let variables = mechanism.variables();
    let index = variables.iter().position(|entry| entry.name == name);
    if !value.is_finite() {
        return Err(Mismatch::NotFinite { name: name.to_string() });
    }
    match index {
        Some(index) if mechanism.set(index, value) => Ok(()),
        _ => Err(Mismatch::Parameter {
            name: name.to_string(),
            mechanism: mechanism.type_name(),
            known: variables.iter().map(|entry| entry.name).collect(),
        }),
    }
}

impl FreeCard {
    /// An instance with the preset's parameters.
    ///
    /// # Errors
    /// [`Mismatch`] where the preset names a parameter that the text does not have.
    pub fn instance(&self, run: &Preset) -> Result<Box<dyn AnyEquations>, Mismatch> {
        let mut mechanism = (self.make)();
        for (name, value) in run.set {
            set(mechanism.as_mut(), name, *value)?;
        }
        Ok(mechanism)
    }
}

/// A name as part of a path: no colon, which some systems refuse.
pub fn file_name(name: &str) -> String {
    name.replace(':', "_")
}

impl Card {
    /// The name as part of a path: no colon, which some systems refuse.
    pub fn file_name(&self) -> String {
        file_name(self.name)
    }

    /// An instance with the preset's parameters.
    ///
    /// # Errors
    /// [`Mismatch`] where the preset names a parameter that the text does not have.
    pub fn instance(&self, run: &Preset) -> Result<Box<dyn AnyMechanism>, Mismatch> {
        let mut mechanism = (self.make)();
        for (name, value) in run.set {
            set(mechanism.as_mut(), name, *value)?;
        }
        Ok(mechanism)
    }

    /// Duration (s) of the motion of `mechanism`.
    ///
    /// # Errors
    /// [`Mismatch::NoTurn`] where the angular velocity is zero, [`Mismatch::Parameter`] where its name is unknown.
    pub fn duration(&self, mechanism: &dyn AnyMechanism) -> Result<f64, Mismatch> {
        let rate = match self.span {
            Span::Seconds(seconds) => return Ok(seconds),
            Span::Turn { rate } => rate,
        };
        let index = mechanism.variables().iter().position(|entry| entry.name == rate);
        let value = index.and_then(|index| mechanism.get(index)).ok_or_else(|| Mismatch::Parameter {
            name: rate.to_string(),
            mechanism: self.name,
            known: mechanism.variables().iter().map(|entry| entry.name).collect(),
        })?;
        let turn = core::f64::consts::TAU / value.abs();
        if turn.is_finite() { Ok(turn) } else { Err(Mismatch::NoTurn { rate, value }) }
    }
}

/// Follows `mechanism` through `steps` equal steps over `duration` (s).
///
/// # Errors
/// The solver's [`Failure`].
pub fn sweep(mechanism: &dyn AnyMechanism, duration: f64, steps: usize) -> Result<Motion, Failure> {
    mechanism.follow(&instants(duration, steps), &mut |_| ())
}

/// The name of `known` that is nearest to `name`, if any is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Below this Jaro-Winkler similarity a proposal confuses more than it helps.
    const NEAR: f64 = 0.75;
    let rated = known.into_iter().map(|known| (strsim::jaro_winkler(name, known), known));
    rated.filter(|(nearness, _)| *nearness > NEAR).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, known)| known)
}

fn write_known(f: &mut fmt::Formatter<'_>, name: &str, known: &[&str]) -> fmt::Result {
    if let Some(nearest) = nearest(name, known.iter().copied()) {
        write!(f, "; did you mean `{nearest}`?")?;
    }
    write!(f, "\nknown: {}", known.join(", "))
}

impl Mismatch {
    /// The same of the mechanism as it was asked for: types of one text share a part of their names.
    pub fn of(self, card: &'static str) -> Self {
        match self {
            Mismatch::Parameter { name, known, .. } => Mismatch::Parameter { name, mechanism: card, known },
            other => other,
        }
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mismatch::Mechanism { name } => {
                write!(f, "there is no mechanism `{name}`")?;
                {
                    let free = FREE.iter().map(|card| card.name);
                    write_known(f, name, &ALL.iter().map(|card| card.name).chain(free).collect::<Vec<_>>())
                }
            }
            Mismatch::Scenes { name, scenes } => write!(
                f,
                "`{name}` has several scenes, each a mechanism of its own; name one: {}",
                scenes.iter().map(|scene| format!("`{scene}`")).collect::<Vec<_>>().join(", ")
            ),
            Mismatch::Alone { name } => {
                write!(f, "`{name}` is written in one set of coordinates")?;
                let parts =
                    KINDS.iter().find_map(|kind| Some((name.strip_suffix(kind)?.strip_suffix('_')?, kind)));
                if let Some((linkage, kind)) = parts.filter(|(linkage, _)| find(linkage).is_ok()) {
                    write!(f, ": it is `{linkage}` in coordinates of the kind `{kind}`")?;
                }
                let several = ALL.iter().filter(|card| variant(card.name, KINDS[0]).is_ok());
                let several: Vec<String> =
                    several.map(|card| format!("`mbs compare {}`", card.name)).collect();
                write!(f, "; several have: {}", several.join(", "))
            }
            Mismatch::Coordinates { name, kind, known } => {
                write!(f, "`{name}` is not written in coordinates of the kind `{kind}`")?;
                write_known(f, kind, known)
            }
            Mismatch::Free { name } => write!(
                f,
                "`{name}` is free to move: its rows do not fix it; `mbs run {name}` moves it by its forces, and \
                 `print`, `latex`, `structure`, `dof`, `expand` and `verify` know it too"
            ),
            Mismatch::Parameter { name, mechanism, known } => {
                write!(f, "`{mechanism}` has no parameter `{name}`")?;
                write_known(f, name, known)
            }
            Mismatch::NotFinite { name } => write!(f, "parameter `{name}` must be a finite number"),
            Mismatch::NoTurn { rate, value } => {
                write!(f, "at `{rate}` = {value} rad/s a turn never ends; give `{rate}` another value")
            }
        }
    }
}

impl core::error::Error for Mismatch {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for (index, card) in ALL.iter().enumerate() {
            assert!(ALL[..index].iter().all(|other| other.name != card.name));
            assert_eq!(find(card.name).expect("in the list").title, card.title);
        }
    }

    #[test]
    fn a_free_mechanism_has_equations_and_says_that_it_cannot_be_run() {
        for (index, card) in FREE.iter().enumerate() {
            let others = FREE[..index].iter().map(|other| other.name);
            assert!(others.chain(ALL.iter().map(|other| other.name)).all(|other| other != card.name));
            let equations = equations(card.name).expect("in the list");
            // Rows that follow from others may hide what moves from a count.
            let hidden = usize::from(equations.source().contains(" redundant {"));
            assert!(equations.rows().len() < equations.coordinates().len() + hidden, "{}", card.name);
            assert!(equations.tables().is_some(), "{}", card.name);
            let text = find(card.name).expect_err("free").to_string();
            assert!(text.contains("is free to move"), "{text}");
        }
        assert_eq!(equations("four_bar").expect("in the list").type_name(), "FourBar");
    }

    #[test]
    fn an_unknown_mechanism_gets_a_proposal_and_the_list() {
        let text = find("fourbar").expect_err("no such name").to_string();
        assert!(text.contains("did you mean `four_bar`?") && text.contains("slider_crank"), "{text}");
        let text = find("zzz").expect_err("no such name").to_string();
        assert!(!text.contains("did you mean") && text.contains("four_bar"), "{text}");
    }

    #[test]
    fn every_preset_fits_its_mechanism() {
        for card in ALL {
            assert!(!card.runs.is_empty(), "{}", card.name);
            for run in card.runs {
                let mechanism = card.instance(run).expect("parameters of the preset");
                assert!(card.duration(mechanism.as_ref()).expect("a duration") > 0.0);
            }
        }
    }

    #[test]
    fn no_motion_comes_near_a_singular_position() {
        /// Rates are refused below 5e-7; the least here is 0.063, at `determinant_guide`.
        const MARGIN: f64 = 0.05;
        for card in ALL {
            for run in card.runs {
                let margin = crate::reference::one_turn(card, run, 360).margin;
                let least = margin.into_iter().fold(f64::INFINITY, f64::min);
                assert!(least > MARGIN, "{}, {}: {least}", card.name, run.label);
            }
        }
    }

    #[test]
    fn every_point_of_a_drawing_is_an_output() {
        let fixed = ALL.iter().map(|card| (card.name, card.drawing));
        for (card, drawing) in fixed.chain(FREE.iter().map(|card| (card.name, card.drawing))) {
            let mechanism = equations(card).expect("in the list");
            let spatial = drawing.iter().any(|shape| matches!(shape, Shape::View { .. }));
            for point in drawing.iter().flat_map(Shape::points) {
                for component in [".0", ".1", ".2"].into_iter().take(if spatial { 3 } else { 2 }) {
                    let name = format!("{point}{component}");
                    let output = mechanism.outputs().iter().find(|output| output.name == name);
                    assert_eq!(output.map(|output| output.unit), Some("m"), "{card}: {name}");
                }
            }
        }
    }

    #[test]
    fn every_direction_of_a_drawing_is_an_angle_or_a_vector() {
        let fixed = ALL.iter().map(|card| (card.name, card.drawing));
        for (card, drawing) in fixed.chain(FREE.iter().map(|card| (card.name, card.drawing))) {
            let mechanism = equations(card).expect("in the list");
            for name in drawing.iter().filter_map(Shape::direction) {
                let mut entries = mechanism.coordinates().iter().chain(mechanism.outputs());
                let component = format!("{name}.1");
                let found = entries.any(|e| (e.name == name && e.is_angle()) || e.name == component);
                assert!(found, "{card}: {name}");
            }
        }
    }

    #[test]
    fn a_bad_parameter_changes_nothing() {
        let mut mechanism = (ALL[0].make)();
        let before = mechanism.get(0);
        assert!(matches!(set(mechanism.as_mut(), "L9", 1.0), Err(Mismatch::Parameter { .. })));
        let name = mechanism.variables()[0].name;
        assert!(matches!(set(mechanism.as_mut(), name, f64::NAN), Err(Mismatch::NotFinite { .. })));
        assert_eq!(mechanism.get(0), before);
    }

    #[test]
    fn a_crank_at_rest_never_ends_its_turn() {
        let mut mechanism = (ALL[0].make)();
        set(mechanism.as_mut(), "omega", 0.0).expect("a parameter");
        assert!(matches!(ALL[0].duration(mechanism.as_ref()), Err(Mismatch::NoTurn { .. })));
    }
}

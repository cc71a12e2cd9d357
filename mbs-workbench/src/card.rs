//! Entries of a list of mechanisms: a constructor, and what the text says about itself.

use core::f64::consts::TAU;

use mbs_codegen::picture::{Picture, picture};
pub use mbs_codegen::picture::{Preset, Span};

use crate::erased::erase::Erased;
use crate::erased::facade::{AnyEquations, AnyMechanism};
use crate::known_motion::KnownMotion;
use crate::mismatch::{Mismatch, set};
use crate::study::Study;

/// Entry of a list of mechanisms, made by [`card!`](crate::card!).
///
/// Title, presets, span and picture are statements of the text. They are read when somebody asks.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    /// A new instance with default parameters.
    pub make: Make,
    /// The constructor as it is written in the crate.
    pub constructor: &'static str,
    /// Path of the module that has the card.
    pub module: &'static str,
    /// Folder of the crate's `Cargo.toml`.
    pub manifest: &'static str,
    /// Method for a motion from forces where the command line names none.
    pub default_method: DefaultMethod,
    /// An instance with functions that a cross-check knows, where the text declares functions.
    pub stand_in: Option<Make>,
    /// A chain of computations with one report, for `mbs study`.
    pub study: Option<&'static Study>,
    /// The motion from elsewhere, which `mbs cost` compares its references with.
    pub known: Option<&'static KnownMotion>,
}

/// Makes a mechanism.
pub type Make = fn() -> Erased;

/// The card of a mechanism, from an expression that makes it: `card!(Wiper::default())`, `card!(wiper::cam())`.
///
/// A card is named by the constructor: of a function by its name, of a type by the module in front of the type, else by the
/// module of the card, at the root of a crate by the type (`FourBar` is `four_bar`). A scene stands behind a colon.
#[macro_export]
macro_rules! card {
    ($make:expr $(,)?) => {
        $crate::card::Card {
            make: || $crate::erased::erase::erase($make),
            constructor: ::core::stringify!($make),
            module: ::core::module_path!(),
            manifest: ::core::env!("CARGO_MANIFEST_DIR"),
            default_method: $crate::card::DefaultMethod::Projection,
            stand_in: ::core::option::Option::None,
            study: ::core::option::Option::None,
            known: ::core::option::Option::None,
        }
    };
}

/// The method that is right for a mechanism; see [`mbs_runtime::dynamics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultMethod {
    /// Explicit steps, all rows together.
    Projection,
    /// Explicit steps through the blocks of the rows: of many rows the others take too long.
    Velocity,
    /// The same in equal steps of a known cost: if many rows lose rank together, matrices are dense.
    VelocityInEqualSteps,
    /// Implicit steps, extrapolated: the forces are too stiff for explicit ones, and steps of order 2 are not accurate enough.
    Extrapolated,
}

/// Duration (s) of a motion whose text has no `span`.
const SPAN: f64 = 1.0;

impl Card {
    /// The card with another method for a motion from forces.
    pub const fn moved_by(self, default_method: DefaultMethod) -> Self {
        Card { default_method, ..self }
    }

    /// The card with an instance for cross-checks, whose functions are [`StandIn`](crate::verify::StandIn)s.
    pub const fn compared_as(self, make: Make) -> Self {
        Card { stand_in: Some(make), ..self }
    }

    /// The card with a study.
    pub const fn studied_by(self, study: &'static Study) -> Self {
        Card { study: Some(study), ..self }
    }

    /// The card with a closed form or published digits of its motion.
    pub const fn known_by(self, known: &'static KnownMotion) -> Self {
        Card { known: Some(known), ..self }
    }

    /// Name on the command line; that of a scene is `text:Scene`.
    pub fn name(&self) -> String {
        let name = self.text_name();
        match self.equations().scene() {
            mbs_codegen::WHOLE => name,
            scene => format!("{name}:{scene}"),
        }
    }

    /// `self.name() == name`, without an instance where the texts are others: functions of the caller may take long to make.
    pub(crate) fn is_called(&self, name: &str) -> bool {
        name.split(':').next() == Some(&self.text_name()) && self.name() == name
    }

    /// The name without the scene.
    pub(crate) fn text_name(&self) -> String {
        name(self.constructor, self.module)
    }

    /// The name as part of a path: no colon, which some systems refuse.
    pub fn file_name(&self) -> String {
        self.name().replace(':', "_")
    }

    /// A new instance whose rows may leave it free.
    pub fn equations(&self) -> Box<dyn AnyEquations> {
        (self.make)().into_equations()
    }

    /// A new instance whose rows fix it.
    ///
    /// # Errors
    /// [`Mismatch::Free`] where they do not.
    pub fn mechanism(&self) -> Result<Box<dyn AnyMechanism>, Mismatch> {
        self.fixed((self.make)())
    }

    /// A new instance whose functions both sides of a cross-check know.
    pub fn comparable(&self) -> Box<dyn AnyEquations> {
        self.stand_in.unwrap_or(self.make)().into_equations()
    }

    /// `true` where the rows leave coordinates free.
    pub fn is_free(&self) -> bool {
        matches!((self.make)(), Erased::Free(_))
    }

    /// Title, presets, span and shapes, read from the text.
    ///
    /// # Errors
    /// [`Mismatch::Text`] where the mechanism has a text that is none.
    pub fn picture(&self) -> Result<Picture, Mismatch> {
        let equations = self.equations();
        picture(equations.source(), Some(equations.scene()))
            .map_err(|faults| Mismatch::Text { name: self.name(), faults })
    }

    /// Motions worth showing: the presets of the text, else its default parameters.
    ///
    /// # Errors
    /// [`Mismatch::Text`].
    pub fn runs(&self) -> Result<Vec<Preset>, Mismatch> {
        self.picture().map(|picture| runs(&picture))
    }

    /// An instance with the preset's parameters.
    ///
    /// # Errors
    /// [`Mismatch`] where the preset names a parameter that the text does not have.
    pub fn instance(&self, run: &Preset) -> Result<Erased, Mismatch> {
        let mut mechanism = (self.make)();
        for (name, value) in &run.set {
            set(mechanism.equations_mut(), name, *value)?;
        }
        Ok(mechanism)
    }

    /// An instance with the preset's parameters whose rows fix it.
    ///
    /// # Errors
    /// [`Mismatch`] where they do not, or where the preset names a parameter that the text does not have.
    pub fn fixed_instance(&self, run: &Preset) -> Result<Box<dyn AnyMechanism>, Mismatch> {
        self.fixed(self.instance(run)?)
    }

    fn fixed(&self, mechanism: Erased) -> Result<Box<dyn AnyMechanism>, Mismatch> {
        match mechanism {
            Erased::Fixed(mechanism) => Ok(mechanism),
            Erased::Free(_) => Err(Mismatch::Free { name: self.name() }),
        }
    }

    /// Duration (s) of the motion of `mechanism`.
    ///
    /// # Errors
    /// [`Mismatch::NoTurn`] where the angular velocity is zero, [`Mismatch::Text`].
    pub fn duration(&self, mechanism: &dyn AnyEquations) -> Result<f64, Mismatch> {
        duration(self.picture()?.span.as_ref(), mechanism)
    }
}

/// Presets of a text; of one without presets its default parameters.
pub fn runs(picture: &Picture) -> Vec<Preset> {
    let defaults = || Preset {
        label: "defaults".to_string(),
        description: "parameters of the text".to_string(),
        set: Vec::new(),
    };
    if picture.presets.is_empty() { vec![defaults()] } else { picture.presets.clone() }
}

/// Duration (s) of the motion of `mechanism` over the span of its text.
///
/// # Errors
/// [`Mismatch::NoTurn`] where the angular velocity is zero, [`Mismatch::Parameter`] where its name is unknown.
pub fn duration(span: Option<&Span>, mechanism: &dyn AnyEquations) -> Result<f64, Mismatch> {
    let rate = match span {
        None => return Ok(SPAN),
        Some(Span::Seconds(seconds)) => return Ok(*seconds),
        Some(Span::Turn { rate }) => rate,
    };
    let index = mechanism.variables().iter().position(|entry| entry.name == rate);
    let value = index.and_then(|index| mechanism.get(index)).ok_or_else(|| Mismatch::Parameter {
        name: rate.clone(),
        mechanism: mechanism.type_name().to_string(),
        known: mechanism.variables().iter().map(|entry| entry.name).collect(),
    })?;
    let turn = TAU / value.abs();
    if turn.is_finite() { Ok(turn) } else { Err(Mismatch::NoTurn { rate: rate.clone(), value }) }
}

/// Name of what `constructor` makes in `module`, without the scene.
fn name(constructor: &str, module: &str) -> String {
    let path = constructor.split(['(', '{', '!']).next().unwrap_or_default();
    let mut depth = 0_u32;
    let mut plain = String::new();
    for letter in path.chars() {
        match letter {
            '<' => depth += 1,
            '>' => depth = depth.saturating_sub(1),
            _ if depth == 0 && !letter.is_whitespace() => plain.push(letter),
            _ => {}
        }
    }
    let segments: Vec<&str> =
        plain.split("::").filter(|part| !matches!(*part, "" | "crate" | "self" | "super")).collect();
    match segments.iter().position(|part| part.starts_with(char::is_uppercase)) {
        Some(at) if at > 0 => segments[at - 1].to_string(),
        Some(at) => match module.rsplit_once("::") {
            Some((_, own)) => own.to_string(),
            None => snake_case(segments[at]),
        },
        None => segments.last().copied().unwrap_or(module).to_string(),
    }
}

/// `FourBar` as `four_bar`.
pub(crate) fn snake_case(name: &str) -> String {
    let mut found = String::new();
    let mut before_lower = false;
    for letter in name.chars() {
        if letter.is_uppercase() && before_lower {
            found.push('_');
        }
        before_lower = !letter.is_uppercase();
        found.extend(letter.to_lowercase());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    mbs_runtime::mechanism! {
        pub mechanism Crank;
        param omega: rad/s = 2;
        coord phi: rad;
        drive motor: phi == omega*t;
        out O: [m; 2] = [0, 0];
        out A: [m; 2] = 0.1m*unit(phi);
        effect slow { title "Slow crank"; preset half "at half the speed" { omega: 1 } span turn(omega); }
        scene Slow = slow;
    }

    fn twice() -> Crank<f64, Slow> {
        Crank { omega: 4.0, ..Crank::default() }
    }

    #[test]
    fn cards_are_named_by_their_constructors() {
        for (constructor, module, expected) in [
            ("FourBar::default()", "my_crate", "four_bar"),
            ("FourBar::default()", "my_crate::wiper", "wiper"),
            ("four_bar::FourBar::default()", "my_crate", "four_bar"),
            ("crate::linkages::four_bar::FourBar::<f64>::default()", "my_crate", "four_bar"),
            ("FourBar { side: -1.0, ..FourBar::default() }", "my_crate::crossed", "crossed"),
            ("wiper::cam()", "my_crate", "cam"),
            ("cam()", "my_crate::wiper", "cam"),
            ("ThreeRRR::default()", "my_crate", "three_rrr"),
        ] {
            assert_eq!(name(constructor, module), expected, "{constructor}");
        }
    }

    #[test]
    fn a_card_of_a_scene_has_what_its_text_says() {
        let card = card!(twice());
        assert_eq!((card.name().as_str(), card.file_name().as_str()), ("twice:Slow", "twice_Slow"));
        let picture = card.picture().expect("a text");
        assert_eq!((picture.title.as_str(), picture.is_guessed), ("Slow crank", true));
        let mechanism = card.mechanism().expect("a drive fixes it");
        assert_eq!(card.duration(mechanism.as_ref()), Ok(TAU / 4.0));
        let mechanism = card.fixed_instance(&card.runs().expect("a text")[0]).expect("its preset");
        assert_eq!(card.duration(mechanism.as_ref()), Ok(TAU));
        assert!(card.manifest.ends_with("mbs-workbench") && !card.is_free());
    }
}

//! A list of mechanisms, found by name.

use core::ops::Deref;

use mbs_runtime::Failure;

use crate::card::Card;
use crate::erased::facade::AnyMechanism;
use crate::mismatch::Mismatch;
use crate::motion::{Motion, instants};
use crate::target_directory::is_started;
use crate::text_file::is_file;

/// Kinds of coordinates that a linkage may be written in; the name of such a mechanism ends with the kind.
pub const KINDS: [&str; 4] = ["relative", "reference_point", "natural", "mixed"];

/// A list of mechanisms; the first one is what the program shows without arguments.
// The program takes it by reference: code that a constant refers to is compiled again in every program that names it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Catalogue<'a> {
    /// Mechanisms, fixed by their rows or free.
    pub cards: &'a [Card],
}

impl Deref for Catalogue<'_> {
    type Target = [Card];

    fn deref(&self) -> &[Card] {
        self.cards
    }
}

impl<'a> Catalogue<'a> {
    /// Mechanisms that their rows fix.
    pub fn fixed(self) -> impl Iterator<Item = &'a Card> {
        self.cards.iter().filter(|card| !card.is_free())
    }

    /// Mechanisms that their rows leave free to move.
    pub fn free(self) -> impl Iterator<Item = &'a Card> {
        self.cards.iter().filter(|card| card.is_free())
    }

    /// Names of all mechanisms.
    pub fn names(self) -> impl Iterator<Item = String> {
        self.cards.iter().map(Card::name)
    }

    /// The first name that two mechanisms have.
    pub fn repeated(self) -> Option<String> {
        // Scenes of a text are told apart by instances, which functions of the caller make dear.
        let texts: Vec<String> = self.cards.iter().map(Card::text_name).collect();
        let is_shared = |text: &String| texts.iter().filter(|other| *other == text).count() > 1;
        let shared = self.cards.iter().zip(&texts).filter(|(_, text)| is_shared(text));
        let mut names: Vec<String> = shared.map(|(card, _)| card.name()).collect();
        names.sort();
        names.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0].clone())
    }

    /// The mechanism called `name`.
    ///
    /// # Errors
    /// [`Mismatch::Mechanism`] where there is none, with the known names; [`Mismatch::Scenes`] where it has several.
    pub fn find(self, name: &str) -> Result<&'a Card, Mismatch> {
        // A program that was built for the text of a file has that text alone.
        if let (true, [card]) = (is_file(name) && is_started(), self.cards) {
            return Ok(card);
        }
        self.get(name).ok_or_else(|| self.unknown(name))
    }

    /// The mechanism called `name`, or the only scene of the text that is called so.
    fn get(self, name: &str) -> Option<&'a Card> {
        self.cards.iter().find(|card| card.is_called(name)).or_else(|| {
            let mut scenes = self.cards.iter().filter(|card| card.text_name() == name);
            scenes.next().filter(|_| scenes.next().is_none())
        })
    }

    /// Reason why there is no mechanism of this name: it is a text of several scenes, or unknown.
    fn unknown(self, name: &str) -> Mismatch {
        let is_scene = |known: &String| known.split_once(':').is_some_and(|(text, _)| text == name);
        let scenes: Vec<String> = self.names().filter(is_scene).collect();
        let name = name.to_string();
        if scenes.is_empty() {
            Mismatch::Mechanism { name, known: self.names().collect() }
        } else {
            Mismatch::Scenes { name, scenes }
        }
    }

    /// The mechanism called `name` in coordinates of this kind; `relative` is `name` itself where it has variants of other
    /// kinds.
    ///
    /// # Errors
    /// [`Mismatch::Alone`] where there are no variants, [`Mismatch::Coordinates`] where there is none of this kind.
    pub fn variant(self, name: &str, kind: &str) -> Result<&'a Card, Mismatch> {
        let card = self.find(name)?;
        card.mechanism()?;
        let others = self.other_kinds(name);
        if others.is_empty() {
            return Err(self.alone(name));
        }
        let own = (kind == KINDS[0]).then_some(card);
        self.of_kind(name, kind).or(own).ok_or_else(|| {
            let known = KINDS.into_iter().filter(|kind| *kind == KINDS[0] || others.contains(kind)).collect();
            Mismatch::Coordinates { name: name.to_string(), kind: kind.to_string(), known }
        })
    }

    fn of_kind(self, name: &str, kind: &str) -> Option<&'a Card> {
        self.get(&format!("{name}_{kind}"))
    }

    fn other_kinds(self, name: &str) -> Vec<&'static str> {
        KINDS.into_iter().filter(|kind| self.of_kind(name, kind).is_some()).collect()
    }

    fn alone(self, name: &str) -> Mismatch {
        let parts =
            KINDS.into_iter().find_map(|kind| Some((name.strip_suffix(kind)?.strip_suffix('_')?, kind)));
        let several = self.fixed().map(Card::name).filter(|name| !self.other_kinds(name).is_empty());
        Mismatch::Alone {
            name: name.to_string(),
            variant_of: parts
                .filter(|(linkage, _)| self.get(linkage).is_some())
                .map(|(linkage, kind)| (linkage.to_string(), kind)),
            several: several.collect(),
        }
    }
}

/// Follows `mechanism` through `steps` equal steps over `duration` (s).
///
/// # Errors
/// The solver's [`Failure`].
pub fn sweep(mechanism: &dyn AnyMechanism, duration: f64, steps: usize) -> Result<Motion, Failure> {
    mechanism.follow(&instants(duration, steps), &mut |_| ())
}

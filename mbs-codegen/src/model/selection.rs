//! Selection of the statements that belong to each scene.

use std::collections::{BTreeMap, BTreeSet};

use super::names::{Elsewhere, report_double};
use super::release::releases;
use crate::diagnostics::{Diagnostics, nearest};
use crate::syntax::ast::{Name, Statement, StatementKind};
use crate::syntax::rust_identifiers::UNUSABLE;
use crate::syntax::{Header, NAMELESS, OWN, declares_coordinate, stand_in};

/// The scene of all effects, and of a text that declares none.
pub const WHOLE: &str = "AllEffects";

/// Name of the mechanism in a scene: of the alias, of the beginning of the view of the coordinates.
pub fn alias(header: &Header, scene: &str) -> String {
    format!("{}{scene}", header.label())
}

/// Most scenes: each is translated by itself.
pub const MOST_SCENES: usize = 64;

/// The statements of a scene in the order of the text, no braces of effects among them.
pub struct Selection {
    /// `None` for the whole text.
    pub name: Option<Name>,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Names that other effects declare, with these effects.
    pub elsewhere: Elsewhere,
    /// `false` if it names an effect that the text lacks, which is reported.
    pub is_whole: bool,
    /// Names of its effects.
    pub effects: Vec<String>,
    /// Statements of the selected effects, and those outside any effect.
    pub statements: Vec<Statement>,
}

/// Before: statements as written. After: one selection a declared scene, the whole text, and the effects that no declared scene
/// selects; faults of effects and scenes are reported.
pub fn select(
    header: &Header,
    statements: &[Statement],
    diagnostics: &mut Diagnostics,
) -> (Vec<Selection>, Selection, Vec<Name>) {
    let mut work =
        Effects { declared: BTreeMap::new(), parts: Vec::new(), selected: Vec::new(), released: Vec::new() };
    work.divide(statements, diagnostics);
    let scenes: Vec<_> = statements
        .iter()
        .filter_map(|statement| match &statement.kind {
            StatementKind::Scene { name, effects, .. } => Some((name, &statement.docs, effects.as_slice())),
            _ => None,
        })
        .collect();
    if let Some((beyond, ..)) = scenes.get(MOST_SCENES) {
        let message = format!("the text declares more than {MOST_SCENES} scenes");
        diagnostics.report(beyond.span, message, "split it: each scene is translated by itself");
    }
    let mut names: BTreeMap<String, &Name> = BTreeMap::new();
    let mut selections = Vec::new();
    for (name, docs, effects) in scenes.iter().take(MOST_SCENES) {
        let (chosen, is_whole) = work.choose(name, effects, diagnostics);
        if is_free(header, name, &mut names, diagnostics) {
            let mut selection = work.selection(Some((*name).clone()), &chosen);
            selection.docs.clone_from(docs);
            selection.is_whole = is_whole;
            complete(&mut selection, name, diagnostics);
            selections.push(selection);
        }
    }
    let mut unused = Vec::new();
    if !scenes.is_empty() {
        if diagnostics.is_empty() {
            unused = work.unused();
        }
        if header.label() == SCENE_PARAMETER {
            diagnostics.report(
                header.name.span(),
                format!("`{SCENE_PARAMETER}` stands for the scene in the emitted code"),
                "give the mechanism another name",
            );
        }
    }
    let all: Vec<usize> = (0..work.selected.len()).collect();
    (selections, work.selection(None, &all), unused)
}

/// Name of the emitted code's type parameter.
const SCENE_PARAMETER: &str = "S";

/// The text divided into its effects.
struct Effects<'a> {
    /// Effects of each name; a second one only where that is reported.
    declared: BTreeMap<&'a str, Vec<usize>>,
    /// Each statement with the index of its effect.
    parts: Vec<(Option<usize>, &'a Statement)>,
    /// Name of each effect, and `true` if a scene selects it.
    selected: Vec<(&'a Name, bool)>,
    /// Effects with the constraints outside of effects that they release.
    released: Vec<(usize, &'a Name)>,
}

impl<'a> Effects<'a> {
    fn divide(&mut self, statements: &'a [Statement], diagnostics: &mut Diagnostics) {
        let mut inside = None;
        for statement in statements {
            match &statement.kind {
                StatementKind::Effect { name } => {
                    let index = self.selected.len();
                    inside = Some(index);
                    let known = self.declared.entry(&name.text).or_default();
                    if let Some((first, _)) = known.first().and_then(|first| self.selected.get(*first)) {
                        report_double(name, first.span, diagnostics);
                    }
                    known.push(index);
                    self.selected.push((name, false));
                }
                StatementKind::EndEffect => inside = None,
                StatementKind::Scene { .. } => {}
                _ => self.parts.push((inside, statement)),
            }
        }
        let effects: Vec<&Name> = self.selected.iter().map(|(name, _)| *name).collect();
        self.released = releases(&self.parts, &effects, diagnostics);
    }

    /// Indices of the effects that a scene names; of equal names all, so that none of their declarations is missing.
    /// Returns `false` too where one of them is unknown.
    fn choose(
        &mut self,
        scene: &Name,
        effects: &[Name],
        diagnostics: &mut Diagnostics,
    ) -> (Vec<usize>, bool) {
        let (mut chosen, mut is_whole) = (Vec::<usize>::new(), true);
        for name in effects {
            let Some(indices) = self.declared.get(name.text.as_str()) else {
                let is_faulty = |(_, statement): &(Option<usize>, &Statement)| matches!(&statement.kind, StatementKind::Faulty { name: known, .. } if known.text == name.text);
                if self.parts.iter().any(is_faulty) {
                    is_whole = false;
                    continue;
                }
                let begins = |known: &&str| {
                    known.len() > 2 && (name.text.starts_with(*known) || known.starts_with(&name.text))
                };
                let near = nearest(&name.text, self.declared.keys().copied());
                let meant = near.or_else(|| self.declared.keys().copied().find(begins));
                let is_statement = |(effect, statement): &(Option<usize>, &Statement)| {
                    effect.is_none()
                        && statement.kind.declared().is_some_and(|(_, known)| known.text == name.text)
                };
                let (message, help) = match meant {
                    _ if self.parts.iter().any(is_statement) => (
                        format!("`{}` is no effect: all scenes have it", name.text),
                        format!(
                            "leave it out, or write its statement in an `effect {}_effect {{ … }}`",
                            name.text
                        ),
                    ),
                    Some(meant) => {
                        (format!("unknown effect `{}`", name.text), format!("did you mean `{meant}`?"))
                    }
                    None => {
                        let help = format!("declare it: `effect {} {{ … }}`", name.text);
                        (format!("unknown effect `{}`", name.text), help)
                    }
                };
                diagnostics.report(name.span, message, help);
                // The scene is read as with the effect that is meant; without one its other faults only follow.
                is_whole &= meant.is_some();
                let meant = meant.and_then(|meant| self.declared.get(meant)).into_iter().flatten();
                let meant: Vec<usize> = meant.copied().filter(|index| !chosen.contains(index)).collect();
                chosen.extend(meant);
                continue;
            };
            if indices.iter().any(|index| chosen.contains(index)) {
                let message = format!("scene `{}` selects `{}` twice", scene.text, name.text);
                diagnostics.report(name.span, message, "remove one of them");
                continue;
            }
            for index in indices {
                chosen.push(*index);
                if let Some((_, selected)) = self.selected.get_mut(*index) {
                    *selected = true;
                }
            }
        }
        (chosen, is_whole)
    }

    fn selection(&self, name: Option<Name>, chosen: &[usize]) -> Selection {
        let belongs = |effect: Option<usize>| effect.is_none_or(|effect| chosen.contains(&effect));
        let mut declared = BTreeSet::new();
        let statements =
            self.parts.iter().filter(|(effect, _)| belongs(*effect)).filter(|(effect, statement)| {
                let name = statement.kind.declared().map(|(kind, name)| (kind, name.text.as_str()));
                let is_new = name.is_none_or(|name| declared.insert(name));
                is_new || !effect.is_some_and(|effect| self.is_repeated(effect))
            });
        let released: BTreeSet<&str> = self
            .released
            .iter()
            .filter(|(effect, _)| chosen.contains(effect))
            .map(|(_, name)| name.text.as_str())
            .collect();
        let statements = statements.map(|(effect, statement)| {
            let mut statement = (*statement).clone();
            if let (None, StatementKind::Constraint { name, released: is_released, .. }) =
                (effect, &mut statement.kind)
            {
                *is_released = released.contains(name.text.as_str());
            }
            statement
        });
        let effects = chosen.iter().filter(|index| !self.is_repeated(**index));
        let effects = effects.filter_map(|index| self.selected.get(*index));
        Selection {
            name,
            docs: Vec::new(),
            is_whole: true,
            elsewhere: self.elsewhere(chosen),
            effects: effects.map(|(name, _)| name.text.clone()).collect(),
            statements: statements.collect(),
        }
    }

    /// Names that the effects declare which are not chosen.
    fn elsewhere(&self, chosen: &[usize]) -> Elsewhere {
        let mut elsewhere = Elsewhere::default();
        for (effect, statement) in &self.parts {
            let effect = (*effect).filter(|effect| !chosen.contains(effect));
            let Some((effect, _)) = effect.and_then(|effect| self.selected.get(effect)) else { continue };
            let names = match statement.kind.declared() {
                Some(("value", name)) => Some((name, &mut elsewhere.values)),
                Some(("load", name)) => Some((name, &mut elsewhere.loads)),
                _ => None,
            };
            if let Some((name, names)) = names {
                names.insert(name.text.clone(), effect.text.clone());
            }
        }
        elsewhere
    }

    /// `true` if an earlier effect has the same name, which is reported.
    fn is_repeated(&self, effect: usize) -> bool {
        let name = self.selected.get(effect).map(|(name, _)| name.text.as_str());
        let first = name.and_then(|name| self.declared.get(name)).and_then(|indices| indices.first());
        first.is_some_and(|first| *first != effect)
    }

    /// Effects that no scene selects: the whole text alone contains them.
    fn unused(&self) -> Vec<Name> {
        let unused = self.selected.iter().filter(|(name, used)| !used && name.text != NAMELESS);
        unused.map(|(name, _)| (*name).clone()).collect()
    }
}

/// Reports effects that no scene selects, of a text whose effects together are no scene either.
pub fn report_unused(unused: &[Name], diagnostics: &mut Diagnostics) {
    for name in unused {
        diagnostics.report(
            name.span,
            format!("no scene selects effect `{}`", name.text),
            format!("add it to a scene: `scene Other = {};`, or remove it", name.text),
        );
    }
}

/// `true` if the types of the scene can have their names; a clash is reported.
fn is_free<'a>(
    header: &Header,
    name: &'a Name,
    names: &mut BTreeMap<String, &'a Name>,
    diagnostics: &mut Diagnostics,
) -> bool {
    let text = name.text.as_str();
    if let Some(first) = names.get(text) {
        report_double(name, first.span, diagnostics);
        return false;
    }
    let fault = if UNUSABLE.contains(&text) {
        format!("`{text}` is a word of Rust that cannot be a name")
    } else if text == WHOLE {
        format!("`{WHOLE}` is the scene of all effects, without a declaration")
    } else if text.starts_with(OWN) {
        format!("names that begin with `{OWN}` are those of the emitted code")
    } else if header.label() == text {
        format!("`{text}` is the name of the mechanism")
    } else if let Some((other, suffix)) = OF_SCENES.iter().find_map(|suffix| {
        let other = text.strip_suffix(suffix)?;
        (other.is_empty() || names.contains_key(other)).then_some((other, suffix))
    }) {
        format!("`{}{suffix}` is a type of the emitted code", alias(header, other))
    } else if let Some((other, suffix)) =
        OF_SCENES.iter().find_map(|suffix| Some((names.get(&format!("{text}{suffix}"))?, suffix)))
    {
        let alias = alias(header, text);
        format!("`{alias}{suffix}` is a type of the emitted code, and the name of scene `{}`", other.text)
    } else {
        names.insert(text.to_owned(), name);
        return true;
    };
    diagnostics.report(name.span, fault, "choose another name for the scene");
    false
}

/// Suffix in the name of the struct of the coordinates by name.
pub const COORDINATES: &str = "Coordinates";

/// The same of the outputs by name.
pub const OUTPUTS: &str = "Outputs";

/// Suffix in the name of the stepper.
pub const STEPPER: &str = "Stepper";

/// Suffixes of types that belong to a scene.
pub const OF_SCENES: [&str; 3] = [COORDINATES, OUTPUTS, STEPPER];

/// A scene needs a coordinate; it gets one where that is reported.
fn complete(selection: &mut Selection, name: &Name, diagnostics: &mut Diagnostics) {
    if selection.statements.iter().any(declares_coordinate) {
        return;
    }
    diagnostics.report(
        name.span,
        format!("scene `{}` has no coordinate", name.text),
        "declare what is sought outside the effects, or in one that it selects: `coord phi: rad = 0.5;`",
    );
    selection.statements.push(stand_in(name.span));
}

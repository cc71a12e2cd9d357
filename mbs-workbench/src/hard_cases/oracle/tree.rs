//! Statements of a scene in the order of the text, loops unrolled.

use mbs_codegen::syntax_tree::{Item, Loop, Statement, StatementKind, statements};

use super::evaluation::{Gap, Names, Scope, value};

/// Most rounds of all loops together.
const MOST_ROUNDS: usize = 100_000;

/// One round of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Number among all rounds of the text.
    pub id: usize,
    /// The loop's name.
    pub variable: String,
    /// Its count.
    pub count: usize,
}

/// A statement, with the rounds of the loops that it stands in.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The statement.
    pub kind: StatementKind,
    /// Rounds, the outermost first.
    pub rounds: Vec<Round>,
}

/// Statements of a scene (`None`: of all effects) with their loops unrolled.
///
/// # Errors
/// Faults of the text, or a bound of a loop that is no count.
pub fn unrolled(source: &str, scene: Option<&str>) -> Result<Vec<Placed>, String> {
    let all = statements(source)?;
    let chosen = selected(&all, scene);
    let mut constants = Names::default();
    for statement in &chosen {
        if let StatementKind::Const { name, value: expression, .. } = statement {
            let found = value(expression, &Scope::of(&constants, &[])).map_err(|gap| gap.0)?;
            constants.moving.insert(name.text.clone(), found);
        }
    }
    let mut work = Unrolling { constants: &constants, rounds: 0, placed: Vec::new() };
    let mut round = Vec::new();
    work.block(&chosen, &mut round).map_err(|gap| gap.0)?;
    Ok(work.placed)
}

/// Statements of effects that the scene selects, and of those outside any effect.
fn selected(all: &[Statement], scene: Option<&str>) -> Vec<StatementKind> {
    let effects = all.iter().find_map(|statement| match &statement.kind {
        StatementKind::Scene { name, effects, .. } if Some(name.text.as_str()) == scene => Some(effects),
        _ => None,
    });
    let is_in = |effect: &str| effects.is_none_or(|effects| effects.iter().any(|name| name.text == effect));
    let (mut kept, mut released) = (Vec::new(), Vec::new());
    // Of each kept statement: `true` outside of all effects.
    let mut of_base = Vec::new();
    let (mut outside, mut in_effect, mut in_scene) = (true, false, false);
    for statement in all {
        match &statement.kind {
            StatementKind::Effect { name } => (outside, in_effect) = (is_in(&name.text), true),
            StatementKind::EndEffect => (outside, in_effect) = (true, false),
            StatementKind::Scene { open, .. } => in_scene = *open,
            StatementKind::EndScene => in_scene = false,
            _ if in_scene || !outside => {}
            StatementKind::Release { names } => released.extend(names.iter().map(|name| name.text.clone())),
            kind => {
                kept.push(kind.clone());
                of_base.push(!in_effect);
            }
        }
    }
    for (kind, of_base) in kept.iter_mut().zip(of_base) {
        if let StatementKind::Constraint { name, released: is_released, .. } = kind {
            *is_released = of_base && released.contains(&name.text);
        }
    }
    kept
}

struct Unrolling<'a> {
    constants: &'a Names,
    rounds: usize,
    placed: Vec<Placed>,
}

impl Unrolling<'_> {
    fn block(&mut self, block: &[StatementKind], rounds: &mut Vec<Round>) -> Result<(), Gap> {
        let mut next = 0;
        while let Some(kind) = block.get(next) {
            next += 1;
            let StatementKind::For(head) = kind else {
                self.placed.push(Placed { kind: kind.clone(), rounds: rounds.clone() });
                continue;
            };
            let length = length(&block[next..], |kind| match kind {
                StatementKind::For(_) => 1,
                StatementKind::EndFor => -1,
                _ => 0,
            });
            let body = &block[next..next + length];
            for count in range(head, &Scope::of(self.constants, rounds))? {
                let id = self.rounds;
                self.rounds += 1;
                if id > MOST_ROUNDS {
                    return Err(Gap(format!("loops of more than {MOST_ROUNDS} rounds")));
                }
                rounds.push(Round { id, variable: head.variable.text.clone(), count });
                self.block(body, rounds)?;
                rounds.pop();
            }
            next += length + 1;
        }
        Ok(())
    }
}

/// Number of elements before the end of the loop that is open.
fn length<T>(rest: &[T], depth: impl Fn(&T) -> i32) -> usize {
    let mut open = 1;
    rest.iter()
        .position(|item| {
            open += depth(item);
            open == 0
        })
        .unwrap_or(rest.len())
}

/// Counts of a loop.
pub fn range(head: &Loop, scope: &Scope<'_>) -> Result<core::ops::Range<usize>, Gap> {
    let end = |expression| value(expression, scope).and_then(|value| value.count());
    Ok(end(&head.low)?..end(&head.high)?)
}

/// An equation with the rounds that it stands in.
type SeeItem<'s, 'a> = &'s mut dyn FnMut(&'a Item, &[Round]) -> Result<(), Gap>;

/// The equations of a constraint with their rounds.
pub fn equations<'a>(
    items: &'a [Item],
    names: &Names,
    rounds: &mut Vec<Round>,
    see: SeeItem<'_, 'a>,
) -> Result<(), Gap> {
    let mut next = 0;
    while let Some(item) = items.get(next) {
        next += 1;
        match item {
            Item::Equation(_) | Item::On { .. } => see(item, rounds)?,
            Item::EndFor => {}
            Item::For(head) => {
                let length = length(&items[next..], |item| match item {
                    Item::For(_) => 1,
                    Item::EndFor => -1,
                    Item::Equation(_) | Item::On { .. } => 0,
                });
                for count in range(head, &Scope::of(names, rounds))? {
                    // Nothing is declared in a constraint, so its rounds need no numbers.
                    rounds.push(Round { id: usize::MAX, variable: head.variable.text.clone(), count });
                    let found = equations(&items[next..next + length], names, rounds, see);
                    rounds.pop();
                    found?;
                }
                next += length + 1;
            }
        }
    }
    Ok(())
}

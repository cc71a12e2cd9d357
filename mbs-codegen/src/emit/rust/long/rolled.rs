//! Several rounds of the same lines as one loop, with tables of the differences from round to round.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::emit::rust::long::statement::{DEFINED, OPERAND, Operand, Statement, Wordings};
use crate::emit::rust::scope::{local, number};
use crate::symbolic::NodeId;

/// Place of discarded values.
const NOWHERE: usize = u32::MAX as usize;

/// Rounds of the same lines.
pub struct Rolled {
    /// Lines of each round, equally worded.
    rounds: Vec<Vec<Statement>>,
    /// Source of each operand of a round.
    sources: Vec<Source>,
}

/// Source of an operand, round by round unless all agree.
enum Source {
    /// The line before that computes the n-th value of the round.
    Round(usize),
    /// Another round or other code, through the passed values.
    Passed(Vec<NodeId>),
    Element(String, Vec<usize>),
    Number(Vec<f64>),
    Place(Vec<usize>),
}

/// A loop as text.
pub struct Text {
    /// Declarations of its tables.
    pub tables: String,
    /// Code of round `__k`.
    pub round: String,
}

impl Rolled {
    /// Before: rounds of equally worded lines. After: these, with the source of each operand.
    pub fn of(rounds: Vec<Vec<Statement>>) -> Self {
        let mut columns: Vec<Vec<(&Operand, Option<usize>)>> = Vec::new();
        for round in &rounds {
            let operands = round.iter().flat_map(|statement| &statement.operands);
            for (column, (operand, earlier)) in operands.zip(earlier(round)).enumerate() {
                match columns.get_mut(column) {
                    Some(column) => column.push((operand, earlier)),
                    None => columns.push(vec![(operand, earlier)]),
                }
            }
        }
        let sources = columns.iter().filter_map(|column| source(column)).collect();
        Rolled { rounds, sources }
    }

    /// Number of rounds.
    pub fn len(&self) -> usize {
        self.rounds.len()
    }

    /// Number of statements with a kernel of their own that a loop would share.
    pub fn kernels(&self, wordings: &Wordings) -> usize {
        let once = self.rounds.first().filter(|_| self.rounds.len() == 1);
        once.into_iter().flatten().filter(|statement| wordings.has_kernel(statement.wording)).count()
    }

    /// Values that must be passed on to it.
    pub fn passed(&self) -> impl Iterator<Item = NodeId> + '_ {
        let passed = self.sources.iter().filter_map(|source| match source {
            Source::Passed(ids) => Some(ids),
            _ => None,
        });
        passed.flatten().copied()
    }

    /// Values that it computes, in their order.
    pub fn defines(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.rounds.iter().flatten().flat_map(|statement| &statement.defines).copied()
    }

    /// Before: places of the values that are passed on. After: the text, which passes on those that it computes where it
    /// `exports` them.
    pub fn print(&self, slots: &BTreeMap<NodeId, usize>, exports: bool, wordings: &Wordings) -> Text {
        let mut tables = Tables { rounds: self.rounds.len(), ..Tables::default() };
        let (mut text, mut sources) = (String::new(), self.sources.iter());
        let names: Vec<NodeId> = self
            .rounds
            .first()
            .into_iter()
            .flatten()
            .flat_map(|statement| &statement.defines)
            .copied()
            .collect();
        for (line, statement) in self.rounds.first().into_iter().flatten().enumerate() {
            let mut defines = statement.defines.iter();
            for letter in wordings.text(statement.wording).chars() {
                match letter {
                    OPERAND => {
                        text += &sources
                            .next()
                            .map_or(String::new(), |source| tables.operand(source, slots, &names))
                    }
                    DEFINED => text += &defines.next().map_or_else(|| "_".to_owned(), |id| local(*id)),
                    letter => text.push(letter),
                }
            }
            for (index, id) in statement.defines.iter().enumerate().filter(|_| exports) {
                let of_round = |round: &Vec<Statement>| {
                    let id = round.get(line).and_then(|statement| statement.defines.get(index));
                    id.and_then(|id| slots.get(id)).copied().unwrap_or(NOWHERE)
                };
                let places: Vec<usize> = self.rounds.iter().map(of_round).collect();
                if places.iter().any(|place| *place != NOWHERE) {
                    let _ = writeln!(text, "__v.put({}, {});", tables.place(&places), local(*id));
                }
            }
        }
        tables.print(text)
    }
}

/// For each operand of a round, the number of the value of the same round that it is, in the order of computation.
pub fn earlier(round: &[Statement]) -> Vec<Option<usize>> {
    let (mut known, mut earlier) = (BTreeMap::new(), Vec::new());
    for Statement { operands, defines, .. } in round {
        earlier.extend(operands.iter().map(|operand| match operand {
            Operand::Local(id) => known.get(id).copied(),
            _ => None,
        }));
        for id in defines {
            known.insert(*id, known.len());
        }
    }
    earlier
}

/// Before: one operand in all rounds. After: its source.
fn source(column: &[(&Operand, Option<usize>)]) -> Option<Source> {
    let (first, earlier) = column.first()?;
    let operands = column.iter().map(|(operand, _)| *operand);
    Some(match first {
        Operand::Local(_) => match earlier.filter(|_| column.iter().all(|(_, other)| other == earlier)) {
            Some(earlier) => Source::Round(earlier),
            None => Source::Passed(
                operands
                    .filter_map(|operand| if let Operand::Local(id) = operand { Some(*id) } else { None })
                    .collect(),
            ),
        },
        Operand::Element { array, .. } => {
            Source::Element(array.clone(), operands.filter_map(place).collect())
        }
        Operand::Place(_) => Source::Place(operands.filter_map(place).collect()),
        Operand::Number(_) => Source::Number(
            operands
                .filter_map(|operand| if let Operand::Number(value) = operand { Some(*value) } else { None })
                .collect(),
        ),
    })
}

fn place(operand: &Operand) -> Option<usize> {
    match operand {
        Operand::Element { index, .. } | Operand::Place(index) => Some(*index),
        Operand::Local(_) | Operand::Number(_) => None,
    }
}

/// Tables of operands that change from round to round by no fixed step.
#[derive(Default)]
struct Tables {
    rounds: usize,
    places: Vec<Vec<usize>>,
    numbers: Vec<Vec<f64>>,
}

impl Tables {
    fn operand(&mut self, source: &Source, slots: &BTreeMap<NodeId, usize>, names: &[NodeId]) -> String {
        match source {
            Source::Round(value) => names.get(*value).map_or(String::new(), |id| local(*id)),
            Source::Passed(ids) => {
                let places: Option<Vec<usize>> = ids.iter().map(|id| slots.get(id).copied()).collect();
                match (places, ids.first()) {
                    (Some(places), _) => format!("__v.get({})", self.place(&places)),
                    // No code passes it on: an error of the compiler's, not a wrong number.
                    (None, id) => id.map_or(String::new(), |id| format!("__not_passed_{}", id.index())),
                }
            }
            Source::Element(array, indices) => match self.place(indices) {
                index if index.parse::<usize>().is_ok() => format!("{array}[{index}]"),
                index => format!("__mbs::__private::chunks::at(&{array}[..], {index})"),
            },
            Source::Number(values) => self.number(values),
            Source::Place(places) => self.place(places),
        }
    }

    /// A place in round `__k`: always the same, at a fixed distance from that of the round before, or out of a table.
    fn place(&mut self, places: &[usize]) -> String {
        let (first, second) = (places.first().copied().unwrap_or(0), places.get(1).copied());
        let step = second.unwrap_or(first).checked_sub(first);
        let is_at =
            |(round, place): (usize, &usize), step: usize| *place == first.saturating_add(step * round);
        match step.filter(|step| places.iter().enumerate().all(|at| is_at(at, *step))) {
            Some(0) => first.to_string(),
            Some(step) => format!("__mbs::__private::chunks::along({first}, {step}, __k)"),
            None => format!("__i{}", column(places, &mut self.places)),
        }
    }

    fn number(&mut self, values: &[f64]) -> String {
        let first = values.first().copied().unwrap_or(0.0);
        match values.iter().all(|value| value.to_bits() == first.to_bits()) {
            true => number(first),
            false => format!("T::constant(__c{})", column(values, &mut self.numbers)),
        }
    }

    fn print(&self, code: String) -> Text {
        let mut text = Text { tables: String::new(), round: String::new() };
        let (places, numbers, rounds) = (self.places.len(), self.numbers.len(), self.rounds);
        if places > 0 {
            let rows = rows(&self.places, rounds, |place| place.to_string());
            let _ = writeln!(
                text.tables,
                "const __PLACES: &[[::core::primitive::u32; {places}]; {rounds}] = &{rows};"
            );
            let _ = writeln!(
                text.round,
                "let {} = __mbs::__private::chunks::places(__PLACES, __k);",
                listed("__i", places)
            );
        }
        if numbers > 0 {
            let rows = rows(&self.numbers, rounds, |value| format!("{value:?}"));
            let _ = writeln!(
                text.tables,
                "const __NUMBERS: &[[::core::primitive::f64; {numbers}]; {rounds}] = &{rows};"
            );
            let _ = writeln!(
                text.round,
                "let {} = __mbs::__private::chunks::numbers(__NUMBERS, __k);",
                listed("__c", numbers)
            );
        }
        text.round += &code;
        text
    }
}

/// The number of a column among others, where it is put if it is new.
fn column<X: PartialEq + Clone>(column: &[X], columns: &mut Vec<Vec<X>>) -> usize {
    columns.iter().position(|other| other == column).unwrap_or_else(|| {
        columns.push(column.to_vec());
        columns.len() - 1
    })
}

fn rows<X>(columns: &[Vec<X>], rounds: usize, print: impl Fn(&X) -> String) -> String {
    let row = |round: usize| {
        columns.iter().filter_map(|column| column.get(round)).map(&print).collect::<Vec<_>>().join(", ")
    };
    format!("[{}]", (0..rounds).map(|round| format!("[{}]", row(round))).collect::<Vec<_>>().join(", "))
}

fn listed(name: &str, count: usize) -> String {
    format!("[{}]", (0..count).map(|index| format!("{name}{index}")).collect::<Vec<_>>().join(", "))
}

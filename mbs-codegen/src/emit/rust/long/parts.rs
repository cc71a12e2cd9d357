//! Long code as methods of bounded length, which pass values on to each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::ops::Range;

use crate::emit::rust::lengths::Lengths;
use crate::emit::rust::long::repetition::{Stretch, stretches};
use crate::emit::rust::long::rolled::{Rolled, Text, earlier};
use crate::emit::rust::long::statement::{KERNELS, PUT, Statement, Wordings};
use crate::emit::rust::long::tape::Tape;
use crate::emit::rust::scope::{Scope, Written};
use crate::program::Section;
use crate::symbolic::NodeId;

/// Placeholder of the number of passed values until it is known.
const PASSED: &str = "\u{3}";

/// Most statements of all arms together that are inlined where a solver asks for its block. After a call the next block would
/// have to wait for values that go through memory.
const LONGEST_INLINED: usize = 120;

/// Most statements of a tape: its values stay in a processor's caches, and their numbers in two bytes.
const LONGEST_TAPE: usize = 1_000;

/// Arguments of a family of methods, in addition to `self` and the passed values; a comma after each.
#[derive(Clone, Default)]
pub struct ExtraArguments {
    /// Declared form.
    pub declared: String,
    /// Form in which they are passed on.
    pub given: String,
    /// Type of the result of methods that have one.
    pub result: Option<String>,
}

/// Method that computes part of a function.
struct PartMethod {
    name: String,
    frame: ExtraArguments,
    /// Calls before anything else.
    calls: String,
    code: Code,
    /// `true` if it executes all rounds, not only the requested one.
    all: bool,
    /// `true` if it passes on its values.
    exports: bool,
    inline: &'static str,
}

/// Form of a method's code: a loop or a tape.
enum Code {
    Rolled(Rolled),
    Tape(Tape),
}

impl Code {
    /// Values that must be passed on to it.
    fn passed(&self) -> Vec<NodeId> {
        match self {
            Code::Rolled(rolled) => rolled.passed().collect(),
            Code::Tape(tape) => tape.passed().collect(),
        }
    }

    /// Values that it computes, in their order.
    fn defines(&self) -> Vec<NodeId> {
        match self {
            Code::Rolled(rolled) => rolled.defines().collect(),
            Code::Tape(tape) => tape.defines().collect(),
        }
    }

    /// Number of rounds.
    fn len(&self) -> usize {
        match self {
            Code::Rolled(rolled) => rolled.len(),
            Code::Tape(_) => 1,
        }
    }
}

/// Statements of one method: rounds of a `length`, or a tape.
struct Piece {
    range: Range<usize>,
    length: usize,
    on_tape: bool,
}

impl Piece {
    /// `true` if these statements can share a tape.
    fn takes(&self, next: &Range<usize>) -> bool {
        self.on_tape && self.range.end == next.start && next.end - self.range.start <= LONGEST_TAPE
    }
}

/// Methods that share passed values.
pub struct Parts {
    /// Bounds at which they are cut.
    pub lengths: Lengths,
    /// Wordings of all statements.
    pub wordings: Wordings,
    methods: Vec<PartMethod>,
    /// Methods that choose among others.
    choices: String,
    slots: BTreeMap<NodeId, usize>,
    next: usize,
}

impl Parts {
    /// Before: places of values that the caller asks for, all below `next`.
    pub fn new(slots: BTreeMap<NodeId, usize>, next: usize, lengths: Lengths) -> Self {
        Parts {
            lengths,
            wordings: Wordings::default(),
            methods: Vec::new(),
            choices: String::new(),
            slots,
            next,
        }
    }

    /// The same parts with at least as many passed values at the front.
    pub fn reserved(mut self, values: usize) -> Self {
        self.next = self.next.max(values);
        self
    }

    /// Adds statements that are executed in their order, at most `longest` in a method. After: the calls that do it.
    ///
    /// `recording`: the scope of statements that go on tapes where many are in no loop.
    pub fn sequence(
        &mut self,
        name: &str,
        frame: &ExtraArguments,
        statements: &[Statement],
        (longest, recording): (usize, Option<&Scope<'_>>),
    ) -> String {
        let stretches = self.stretches(statements, longest);
        let once = |stretch: &Stretch| if let Stretch::Once(range) = stretch { range.len() } else { 0 };
        let is_many = stretches.iter().map(once).sum::<usize>() > self.lengths.straight;
        let recording = recording.filter(|_| is_many);
        let mut calls = String::new();
        for (number, piece) in self.pieces(stretches, statements, recording).into_iter().enumerate() {
            let Piece { range, length, on_tape } = piece;
            let name = format!("{name}_{number}");
            let _ = writeln!(calls, "self.{name}({}__v);", frame.given);
            let statements = statements.get(range).unwrap_or_default();
            let code = match recording.filter(|_| on_tape) {
                Some(scope) => Code::Tape(Tape::of(statements, scope)),
                None => {
                    let rounds = statements.chunks(length.max(1));
                    Code::Rolled(Rolled::of(rounds.map(<[Statement]>::to_vec).collect()))
                }
            };
            let frame = ExtraArguments { result: None, ..frame.clone() };
            let (calls, inline) = (String::new(), "#[inline(never)]");
            self.methods.push(PartMethod { name, frame, calls, code, all: true, exports: true, inline });
        }
        calls
    }

    /// Before: stretches of statements. After: one piece a method.
    fn pieces(
        &self,
        stretches: Vec<Stretch>,
        statements: &[Statement],
        recording: Option<&Scope<'_>>,
    ) -> Vec<Piece> {
        let accepts = |statement: &Statement| {
            recording.is_some_and(|scope| Tape::accepts(statement, &self.wordings, scope))
        };
        let mut pieces: Vec<Piece> = Vec::new();
        for stretch in stretches {
            let (mut start, end) = match stretch {
                Stretch::Once(range) => (range.start, range.end),
                Stretch::Rounds { first, length, rounds } => {
                    pieces.push(Piece { range: first..first + length * rounds, length, on_tape: false });
                    continue;
                }
            };
            let alike =
                statements.get(start..end).unwrap_or_default().chunk_by(|a, b| accepts(a) == accepts(b));
            for alike in alike {
                let (on_tape, end) = (alike.first().is_some_and(accepts), start + alike.len());
                match pieces.last_mut().filter(|last| on_tape && last.takes(&(start..end))) {
                    Some(last) => last.range.end = end,
                    None => pieces.push(Piece { range: start..end, length: alike.len(), on_tape }),
                }
                start = end;
            }
        }
        pieces
    }

    /// Stretches in which statements repeat themselves.
    fn stretches(&self, statements: &[Statement], longest: usize) -> Vec<Stretch> {
        let wordings: Vec<usize> = statements.iter().map(|statement| statement.wording).collect();
        // A line of several angles is as long as several lines.
        let weigh =
            |index: usize| statements.get(index).map_or(0, |statement| statement.defines.len().max(1));
        stretches(&wordings, weigh, longest, self.lengths)
    }

    /// Adds a method that executes the arm of `__s`: `arms`, each with its number below `count`. The last statement of an arm is
    /// its result, where the frame has one. Values are passed on where it `exports` them.
    pub fn choice(
        &mut self,
        name: &str,
        frame: &ExtraArguments,
        arms: Vec<(usize, Vec<Statement>)>,
        (count, exports, recording): (usize, bool, Option<&Scope<'_>>),
    ) {
        let longest = self.lengths.body;
        // Equal wordings that take their values from equal places among those of the arm.
        let mut groups: BTreeMap<(Vec<usize>, Vec<Option<usize>>), usize> = BTreeMap::new();
        let mut grouped: Vec<Vec<Vec<Statement>>> = Vec::new();
        let mut table = vec![(0, 0); count];
        for (number, arm) in arms.into_iter().filter(|(_, arm)| !arm.is_empty()) {
            let key = match arm.len() > longest {
                // Alone in its group.
                true => (vec![usize::MAX, number], Vec::new()),
                false => (arm.iter().map(|statement| statement.wording).collect(), earlier(&arm)),
            };
            let group = *groups.entry(key).or_insert(grouped.len());
            if group == grouped.len() {
                grouped.push(Vec::new());
            }
            if let (Some(place), Some(rounds)) = (table.get_mut(number), grouped.get_mut(group)) {
                *place = (group + 1, rounds.len());
                rounds.push(arm);
            }
        }
        let length: usize = grouped.iter().filter_map(|rounds| rounds.first()).map(Vec::len).sum();
        let once: usize = grouped.iter().filter(|rounds| rounds.len() == 1).flatten().map(Vec::len).sum();
        let recording = recording.filter(|_| once > self.lengths.straight_blocks);
        let (inline, choice_inline) = match length <= LONGEST_INLINED {
            true => ("#[inline(always)]", "#[inline(always)]"),
            false => ("#[inline(never)]", "#[inline]"),
        };
        let mut choice = String::new();
        let (last, result) = (grouped.len(), frame.result.is_some());
        for (number, mut rounds) in grouped.into_iter().enumerate() {
            let (name, mut calls) = (format!("{name}_{number}"), String::new());
            let mut tape = None;
            if let ([arm], Some(scope)) = (rounds.as_slice(), recording.filter(|_| !result))
                && arm.len() <= LONGEST_TAPE
                && arm.iter().all(|statement| Tape::accepts(statement, &self.wordings, scope))
            {
                tape = Some(Code::Tape(Tape::of(arm, scope)));
            } else if let Some(arm) = rounds.first_mut().filter(|arm| arm.len() > longest) {
                let behind = arm.split_off(arm.len() - usize::from(result));
                calls = self.sequence(&name, frame, arm, (longest, recording));
                *arm = behind;
            }
            let pattern = if result && number + 1 == last { "_".into() } else { (number + 1).to_string() };
            let _ = writeln!(choice, "{pattern} => self.{name}(__k, {}__v),", frame.given);
            let code = tape.unwrap_or_else(|| Code::Rolled(Rolled::of(rounds)));
            let frame = frame.clone();
            self.methods.push(PartMethod { name, frame, calls, code, all: false, exports, inline });
        }
        if !result {
            choice += "_ => {}\n";
        }
        let rows: Vec<String> =
            table.into_iter().map(|(group, round)| format!("[{group}, {round}]")).collect();
        self.choices += &declared(choice_inline, name, "__s: ::core::primitive::usize, ", frame);
        let _ = writeln!(
            self.choices,
            "{{\nconst __ARMS: &[[::core::primitive::u32; 2]; {count}] = &[{}];\n\
             let [__arm, __k] = __mbs::__private::chunks::places(__ARMS, __s);\nmatch __arm {{\n{choice}}}\n}}",
            rows.join(", ")
        );
    }

    /// Adds `__called…`, a choice that is never inlined.
    pub fn called(&mut self, name: &str, frame: &ExtraArguments) {
        let of = name.trim_start_matches('_');
        let asked = "__s: ::core::primitive::usize, ";
        self.choices += &declared("#[inline(never)]", &format!("__called_{of}"), asked, frame);
        let _ = writeln!(self.choices, "{{ self.{name}(__s, {}__v) }}", frame.given);
    }

    /// Before: all is added. After: the text of all methods, and the number of values that they pass on.
    pub fn print(self) -> (String, usize) {
        let Parts { lengths, wordings, methods, choices, slots: taken, next } = self;
        let (slots, count) = slots(&methods, taken, next);
        let kernels =
            |code: &Code| if let Code::Rolled(rolled) = code { rolled.kernels(&wordings) } else { 0 };
        let kernels: usize = methods.iter().map(|method| kernels(&method.code)).sum();
        let mut text = String::new();
        for PartMethod { name, frame, calls, code, all, exports, inline } in &methods {
            let Text { tables, mut round } = match code {
                Code::Rolled(rolled) => rolled.print(&slots, *exports, &wordings),
                Code::Tape(tape) => Text { tables: String::new(), round: tape.print(&slots) },
            };
            if code.len() == 1 && kernels > lengths.kernels {
                round = KERNELS.iter().fold(round, |round, (copied, called)| round.replace(copied, called));
            }
            let asked = if *all { "" } else { "__k: ::core::primitive::usize, " };
            text += &declared(inline, name, asked, frame);
            let _ = match *all && code.len() > 1 {
                true => writeln!(text, "{{\n{tables}for __k in 0..{}_usize {{\n{round}}}\n}}", code.len()),
                false => writeln!(text, "{{\n{tables}{calls}{round}}}"),
            };
        }
        ((text + &choices).replace(PASSED, &count.to_string()), count)
    }

    /// Statements of a section.
    pub fn lines(&mut self, section: &Section, scope: &Scope<'_>) -> Vec<Statement> {
        let mut statements = Vec::new();
        section.lines.iter().for_each(|line| self.wordings.of_line(line, scope, &mut statements));
        statements
    }
}

fn declared(inline: &str, name: &str, asked: &str, frame: &ExtraArguments) -> String {
    let result = frame.result.as_ref().map_or(String::new(), |result| format!(" -> {result}"));
    format!(
        "{inline}\nfn {name}(&self, {asked}{}__v: &__mbs::__private::chunks::Passed<T, {PASSED}>){result} ",
        frame.declared
    )
}

/// A long function.
pub struct Function {
    /// Its body without the result, which is first in the passed values `__v`.
    pub body: String,
    /// Methods that it calls.
    pub methods: String,
}

/// Before: a section and its results, 0 where there is none. After: a function of bounded parts.
pub fn function(
    name: &str,
    frame: &ExtraArguments,
    (section, results): (&Section, &[Option<NodeId>]),
    scope: &Scope<'_>,
) -> Function {
    let (mut slots, mut others) = (BTreeMap::new(), Vec::new());
    for (place, result) in results.iter().enumerate() {
        match result.map(|id| scope.written(id)) {
            Some(Written::Local(id)) if !slots.contains_key(&id) => drop(slots.insert(id, place)),
            // A place that is not written is 0.
            Some(Written::Number(value)) if value.to_bits() == 0 => {}
            Some(_) => others.push((place, *result)),
            None => {}
        }
    }
    let mut parts = Parts::new(slots, results.len(), scope.lengths);
    let mut statements = parts.lines(section, scope);
    for (place, result) in others {
        statements.push(parts.wordings.put(PUT, place, result, scope));
    }
    let calls = parts.sequence(name, frame, &statements, (scope.lengths.body, Some(scope)));
    let (methods, count) = parts.print();
    Function {
        body: format!("let __v = &__mbs::__private::chunks::Passed::<T, {count}>::none();\n{calls}"),
        methods,
    }
}

/// Before: all code that shares passed values, and places that are taken already, below `next`. After: places of all passed
/// values in the order of computation, and their number.
fn slots(
    methods: &[PartMethod],
    taken: BTreeMap<NodeId, usize>,
    next: usize,
) -> (BTreeMap<NodeId, usize>, usize) {
    let needed: BTreeSet<NodeId> = methods.iter().flat_map(|method| method.code.passed()).collect();
    let (mut slots, mut next) = (taken, next);
    for id in methods.iter().filter(|method| method.exports).flat_map(|method| method.code.defines()) {
        if needed.contains(&id) && !slots.contains_key(&id) {
            slots.insert(id, next);
            next += 1;
        }
    }
    (slots, next)
}

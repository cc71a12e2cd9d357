//! Long code as methods of bounded length, which pass values on to each other.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::lengths::Lengths;
use super::repetition::{Stretch, stretches};
use super::rolled::{Rolled, Text, earlier, slots};
use super::scope::{Scope, Written};
use super::statement::{Statement, Wordings};
use crate::program::Section;
use crate::symbolic::NodeId;

/// Stands for the number of passed values until it is known.
const PASSED: &str = "\u{3}";

/// Most statements of all arms together that stand wherever a solver asks for its block: behind a call the next block would have
/// to wait for what goes through memory.
const LONGEST_INLINED: usize = 120;

/// Arguments of a family of methods, beside `self` and the passed values; a comma behind each.
#[derive(Clone, Default)]
pub struct Frame {
    /// As they are declared.
    pub declared: String,
    /// As they are handed on.
    pub given: String,
    /// Type of the result of methods that have one.
    pub result: Option<String>,
}

/// What some function consists of.
struct Method {
    name: String,
    frame: Frame,
    /// Calls before anything else.
    calls: String,
    code: Rolled,
    /// Whether it does all rounds, not only the one that it is asked for.
    all: bool,
    /// Whether it passes on what it computes.
    exports: bool,
    inline: &'static str,
}

/// Methods that share passed values.
pub struct Parts {
    /// Where they are cut.
    pub lengths: Lengths,
    /// Wordings of all statements.
    pub wordings: Wordings,
    methods: Vec<Method>,
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

    /// With as many passed values at the front, at least.
    pub fn reserved(mut self, values: usize) -> Self {
        self.next = self.next.max(values);
        self
    }

    /// Adds statements that are executed in their order, at most `longest` in a method. After: the calls that do it.
    pub fn sequence(
        &mut self,
        name: &str,
        frame: &Frame,
        statements: &[Statement],
        longest: usize,
    ) -> String {
        let wordings: Vec<usize> = statements.iter().map(|statement| statement.wording).collect();
        // A line of several angles is as long as several lines.
        let weigh =
            |index: usize| statements.get(index).map_or(0, |statement| statement.defines.len().max(1));
        let mut calls = String::new();
        for (number, stretch) in stretches(&wordings, weigh, longest, self.lengths).into_iter().enumerate() {
            let (range, length) = match stretch {
                Stretch::Once(range) => (range.clone(), range.len()),
                Stretch::Rounds { first, length, rounds } => (first..first + length * rounds, length),
            };
            let rounds = statements.get(range).unwrap_or_default().chunks(length.max(1));
            let name = format!("{name}_{number}");
            let _ = writeln!(calls, "self.{name}({}__v);", frame.given);
            let code = Rolled::of(rounds.map(<[Statement]>::to_vec).collect());
            let frame = Frame { result: None, ..frame.clone() };
            let (calls, inline) = (String::new(), "#[inline(never)]");
            self.methods.push(Method { name, frame, calls, code, all: true, exports: true, inline });
        }
        calls
    }

    /// Adds a method that does what stands at `__s`: `arms`, each with its number below `count`. The last statement of an arm is
    /// its result, where the frame says that there is one. Values are passed on where it `exports` them.
    pub fn choice(
        &mut self,
        name: &str,
        frame: &Frame,
        arms: Vec<(usize, Vec<Statement>)>,
        (count, exports): (usize, bool),
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
        let (inline, choice_inline) = match length <= LONGEST_INLINED {
            true => ("#[inline(always)]", "#[inline(always)]"),
            false => ("#[inline(never)]", "#[inline]"),
        };
        let mut choice = String::new();
        let (last, result) = (grouped.len(), frame.result.is_some());
        for (number, mut rounds) in grouped.into_iter().enumerate() {
            let (name, mut calls) = (format!("{name}_{number}"), String::new());
            if let Some(arm) = rounds.first_mut().filter(|arm| arm.len() > longest) {
                let behind = arm.split_off(arm.len() - usize::from(result));
                calls = self.sequence(&name, frame, arm, longest);
                *arm = behind;
            }
            let pattern = if result && number + 1 == last { "_".into() } else { (number + 1).to_string() };
            let _ = writeln!(choice, "{pattern} => self.{name}(__k, {}__v),", frame.given);
            let code = Rolled::of(rounds);
            let frame = frame.clone();
            self.methods.push(Method { name, frame, calls, code, all: false, exports, inline });
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
             let [__arm, __k] = __mbs::long::places(__ARMS, __s);\nmatch __arm {{\n{choice}}}\n}}",
            rows.join(", ")
        );
    }

    /// Adds `__called…`, which is a choice behind a call.
    pub fn called(&mut self, name: &str, frame: &Frame) {
        let of = name.trim_start_matches('_');
        let asked = "__s: ::core::primitive::usize, ";
        self.choices += &declared("#[inline(never)]", &format!("__called_{of}"), asked, frame);
        let _ = writeln!(self.choices, "{{ self.{name}(__s, {}__v) }}", frame.given);
    }

    /// Before: all is added. After: the text of all methods, and how many values they pass on.
    pub fn print(self) -> (String, usize) {
        let Parts { wordings, methods, choices, slots: taken, next, .. } = self;
        let all = methods.iter().map(|method| (&method.code, method.exports));
        let (slots, count) = slots(all, taken, next);
        let mut text = String::new();
        for Method { name, frame, calls, code, all, exports, inline } in &methods {
            let Text { tables, round } = code.print(&slots, *exports, &wordings);
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

fn declared(inline: &str, name: &str, asked: &str, frame: &Frame) -> String {
    let result = frame.result.as_ref().map_or(String::new(), |result| format!(" -> {result}"));
    format!(
        "{inline}\nfn {name}(&self, {asked}{}__v: &__mbs::long::Passed<T, {PASSED}>){result} ",
        frame.declared
    )
}

/// A long function.
pub struct Function {
    /// Its body but for the result, which stands first in the passed values `__v`.
    pub body: String,
    /// Methods that it calls.
    pub methods: String,
}

/// Before: a section, and the results behind it, 0 where there is none. After: a function of bounded parts.
pub fn function(
    name: &str,
    frame: &Frame,
    (section, results): (&Section, &[Option<NodeId>]),
    scope: &Scope<'_>,
) -> Function {
    let (mut slots, mut others) = (BTreeMap::new(), Vec::new());
    for (place, result) in results.iter().enumerate() {
        match result.map(|id| scope.written(id)) {
            Some(Written::Local(id)) if !slots.contains_key(&id) => drop(slots.insert(id, place)),
            // What nobody puts there is 0.
            Some(Written::Number(value)) if value.to_bits() == 0 => {}
            Some(_) => others.push((place, *result)),
            None => {}
        }
    }
    let mut parts = Parts::new(slots, results.len(), scope.lengths);
    let mut statements = parts.lines(section, scope);
    for (place, result) in others {
        statements.push(parts.wordings.put("__v.put(", place, result, scope));
    }
    let calls = parts.sequence(name, frame, &statements, scope.lengths.body);
    let (methods, count) = parts.print();
    Function { body: format!("let __v = &__mbs::long::Passed::<T, {count}>::none();\n{calls}"), methods }
}

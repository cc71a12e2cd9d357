//! The block-triangular solution of a long mechanism: one loop over all blocks, so that a solver is compiled once a
//! kind of block, and functions of bounded length for what differs from block to block.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::blocks::{formula, list};
use super::code::{LONGEST_BODY, LONGEST_FUNCTION, lets, lets_for, local, print};
use super::elimination::{Eliminations, factorization};
use super::scope::{Scope, number as number_of};
use crate::model::Model;
use crate::program::{BlockProgram, Line, Method, Program, Section, System};
use crate::symbolic::NodeId;

/// Most blocks that are solved by Newton's method one behind the other in one function, each with its own copy of every
/// solver; of more, the assembly is one loop.
const MOST_COPIES: usize = 16;

/// Most blocks of which the next position, which each step waits for, is straight-line code; of more it is a loop too.
const MOST_IN_LINE: usize = 48;

/// Whether all functions of a mechanism are emitted in parts.
pub fn is_long(program: &Program) -> bool {
    newton_blocks(program) > MOST_IN_LINE
        || program.length().max(program.evaluation.lines.len()) > LONGEST_FUNCTION
}

/// Whether its assembly is.
pub fn has_many_blocks(program: &Program) -> bool {
    newton_blocks(program) > MOST_COPIES
}

fn newton_blocks(program: &Program) -> usize {
    program.blocks.iter().filter(|block| matches!(block.method, Method::Newton(_))).count()
}

/// What is emitted of the solution.
pub struct Solution {
    /// Body of `solve_with_position`.
    pub body: String,
    /// Functions that it calls.
    pub methods: String,
}

/// What stands before an iteration, in the order in which it is computed.
enum Step<'a> {
    Line(&'a Line),
    /// A coordinate and its value.
    Assign(usize, NodeId),
}

/// Lines of bounded number, and the block behind them.
#[derive(Default)]
struct Segment<'a> {
    steps: Vec<Step<'a>>,
    newton: Option<(&'a BlockProgram, &'a System)>,
}

/// Blocks that one copy of the solvers solves: unknowns, rows, whether it is a dyad and whether it decides branches.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Kind {
    unknowns: usize,
    rows: usize,
    dyad: bool,
    branched: bool,
}

impl Kind {
    /// The kind of a block.
    pub fn of(block: &BlockProgram, system: &System) -> Self {
        Kind {
            unknowns: block.coordinates.len(),
            rows: block.rows.len(),
            dyad: system.dyad.is_some(),
            branched: !system.branches.is_empty(),
        }
    }
}

/// Before: a long program. After: the solution of Φ = 0 with the position stage of its values.
pub fn solve(program: &Program, eliminations: &Eliminations, scope: &Scope<'_>) -> Solution {
    let segments = segments(program);
    let kinds = kinds(program);
    let (slots, factors) = (slots(program, &segments, scope), factors(program, eliminations));
    let emission = Emission { scope, program, slots, segments, kinds, factors };
    let mut methods = emission.before();
    for (kind, number) in &emission.kinds {
        methods += &emission.evaluate(*kind, *number);
        methods += &emission.holds(*kind, *number);
        methods += &emission.roots(*kind, *number);
    }
    Solution { body: emission.body(), methods }
}

/// The kinds of a program's blocks, numbered.
pub fn kinds(program: &Program) -> BTreeMap<Kind, usize> {
    let mut kinds: BTreeMap<Kind, usize> = BTreeMap::new();
    for block in &program.blocks {
        if let Method::Newton(system) = &block.method {
            kinds.insert(Kind::of(block, system), 0);
        }
    }
    kinds.values_mut().enumerate().for_each(|(index, number)| *number = index);
    kinds
}

/// Types of the factors of each kind: those of its blocks where all have one pattern, else those of any.
pub fn factors(program: &Program, eliminations: &Eliminations) -> BTreeMap<Kind, String> {
    let mut factors: BTreeMap<Kind, String> = BTreeMap::new();
    for (index, block) in program.blocks.iter().enumerate() {
        if let Method::Newton(system) = &block.method {
            let (kind, size) = (Kind::of(block, system), block.rows.len());
            let own = eliminations.factorization(index, size);
            let of_kind = factors.entry(kind).or_insert_with(|| own.clone());
            if *of_kind != own {
                *of_kind = factorization(size);
            }
        }
    }
    factors
}

/// `Place { … }` of a block.
pub fn place(block: &BlockProgram, scope: &Scope<'_>) -> String {
    let is_angle =
        |c: &usize| scope.model.coordinates.get(*c).is_some_and(|coordinate| coordinate.unit == "rad");
    format!(
        "__mbs::long::Place {{ rows: {}, coordinates: {}, angles: {} }}",
        list(block.rows.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(|c| is_angle(c).to_string())),
    )
}

/// `let`s of the reference metric.
pub fn scales(model: &Model) -> String {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    format!(
        "let __coordinate_scales: [T; {n}] = __mbs::Mechanism::coordinate_scales(self, __p);\n\
         let __row_scales: [T; {m}] = __mbs::Mechanism::row_scales(self, __p);\n"
    )
}

/// Body of `phi_q`: its entries, put in their places.
pub fn phi_q(model: &Model) -> String {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    format!(
        "__mbs::long::scattered(<Self as __mbs::Mechanism<T, {n}, {m}>>::SPARSITY, \
         &<Self as __mbs::Mechanism<T, {n}, {m}>>::phi_q_entries(self, __p, __s))"
    )
}

/// Lines and assignments cut to bounded length, a nonlinear block behind a segment; the position stage's rest at the end.
fn segments(program: &Program) -> Vec<Segment<'_>> {
    let mut segments = vec![Segment::default()];
    for block in &program.blocks {
        for line in &block.before.lines {
            push(Step::Line(line), &mut segments);
        }
        match &block.method {
            Method::Explicit { value, .. } => {
                for coordinate in &block.coordinates {
                    push(Step::Assign(*coordinate, *value), &mut segments);
                }
            }
            Method::Newton(system) => match segments.last_mut() {
                Some(last) if last.newton.is_none() => last.newton = Some((block, system)),
                _ => segments.push(Segment { steps: Vec::new(), newton: Some((block, system)) }),
            },
        }
    }
    for line in &program.rest.lines {
        push(Step::Line(line), &mut segments);
    }
    segments
}

fn push<'a>(step: Step<'a>, segments: &mut Vec<Segment<'a>>) {
    match segments.last_mut() {
        Some(last) if last.newton.is_none() && last.steps.len() < LONGEST_BODY => last.steps.push(step),
        _ => segments.push(Segment { steps: vec![step], newton: None }),
    }
}

/// Values of a part: what it computes, and what it uses.
#[derive(Default)]
struct Values {
    computed: BTreeSet<NodeId>,
    used: BTreeSet<NodeId>,
}

impl Values {
    fn of_steps(steps: &[Step<'_>], scope: &Scope<'_>) -> Self {
        let mut values = Values::default();
        for step in steps {
            match step {
                Step::Line(line) => values.add(line, scope),
                Step::Assign(_, value) => drop(values.used.insert(*value)),
            }
        }
        values
    }

    fn of_section(section: &Section, results: impl IntoIterator<Item = NodeId>, scope: &Scope<'_>) -> Self {
        let mut values = Values::default();
        section.lines.iter().for_each(|line| values.add(line, scope));
        values.used.extend(results);
        values
    }

    fn add(&mut self, line: &Line, scope: &Scope<'_>) {
        self.computed.extend(line.values());
        self.used.extend(line.operands(scope.graph));
    }

    /// What it takes from other parts, among other things leaves.
    fn taken(&self) -> impl Iterator<Item = &NodeId> {
        self.used.difference(&self.computed)
    }
}

/// What an iterate's residuals and Jacobian are.
fn results(system: &System) -> impl Iterator<Item = NodeId> + '_ {
    system.phi.iter().copied().chain(system.phi_q.iter().flatten().copied().flatten())
}

/// Places of the values that parts pass on: those that the position stage keeps first, in its order.
fn slots(program: &Program, segments: &[Segment<'_>], scope: &Scope<'_>) -> BTreeMap<NodeId, usize> {
    let (mut parts, mut known) = (Vec::new(), BTreeSet::new());
    for Segment { steps, newton } in segments {
        let before = Values::of_steps(steps, scope);
        known.extend(before.computed.iter().copied());
        parts.push(before);
        let Some((_, system)) = newton else { continue };
        let iterate = Values::of_section(&system.section, results(system), scope);
        known.extend(iterate.computed.iter().copied());
        parts.push(iterate);
        parts.push(Values::of_section(&system.branch_section, system.branches.iter().copied(), scope));
        if let Some((dyad, section)) = &system.dyad {
            parts.push(Values::of_section(section, dyad.nodes(), scope));
        }
    }
    let mut slots = program.position.fields.clone();
    for value in parts.iter().flat_map(Values::taken).filter(|value| known.contains(value)) {
        let next = slots.len();
        slots.entry(*value).or_insert(next);
    }
    slots
}

/// What all functions of a solution are printed from.
struct Emission<'a> {
    scope: &'a Scope<'a>,
    program: &'a Program,
    segments: Vec<Segment<'a>>,
    kinds: BTreeMap<Kind, usize>,
    slots: BTreeMap<NodeId, usize>,
    factors: BTreeMap<Kind, String>,
}

/// A segment's share of a function: its number, its code and how many lines that is.
struct Arm {
    segment: usize,
    text: String,
    lines: usize,
}

impl Emission<'_> {
    /// Takes over what other parts have computed.
    fn imports(&self, values: &Values, text: &mut String) {
        for value in values.taken() {
            if let Some(slot) = self.slots.get(value).filter(|_| self.is_local(*value)) {
                let _ = writeln!(text, "let {} = __v.0[{slot}].get();", local(*value));
            }
        }
    }

    /// Passes on what other parts use.
    fn exports(&self, values: &Values, text: &mut String) {
        for value in &values.computed {
            if let Some(slot) = self.slots.get(value) {
                let _ = writeln!(text, "__v.0[{slot}].set({});", local(*value));
            }
        }
    }

    /// Whether it is computed by some part, and no leaf.
    fn is_local(&self, value: NodeId) -> bool {
        self.scope.operand(value) == local(value)
    }

    /// `__before`: what stands before each block.
    fn before(&self) -> String {
        let arms = self.segments.iter().enumerate().map(|(segment, Segment { steps, .. })| {
            let values = Values::of_steps(steps, self.scope);
            let mut text = String::new();
            self.imports(&values, &mut text);
            for step in steps {
                match step {
                    Step::Line(line) => print(line, self.scope, &mut text),
                    Step::Assign(coordinate, value) => {
                        let _ = writeln!(text, "__q[{coordinate}] = {};", self.scope.operand(*value));
                    }
                }
            }
            self.exports(&values, &mut text);
            Arm { segment, text, lines: steps.len() }
        });
        let n = self.scope.model.coordinates.len();
        let signature =
            Signature { name: "__before".into(), q: format!("&mut [T; {n}]"), more: None, result: None };
        self.function(&signature, arms.collect())
    }

    /// Segments with a block of this kind.
    fn of_kind(&self, kind: Kind) -> impl Iterator<Item = (usize, &BlockProgram, &System)> {
        let blocks = self.segments.iter().enumerate();
        blocks
            .filter_map(|(number, segment)| segment.newton.map(|(block, system)| (number, block, system)))
            .filter(move |(_, block, system)| Kind::of(block, system) == kind)
    }

    /// `__evaluate…`: residuals and Jacobian of an iterate.
    fn evaluate(&self, kind: Kind, number: usize) -> String {
        let arms = self.of_kind(kind).map(|(segment, block, system)| {
            let inner = Scope { unknowns: &block.coordinates, ..*self.scope };
            let values = Values::of_section(&system.section, results(system), self.scope);
            let mut text = String::new();
            self.imports(&values, &mut text);
            let shared = values.computed.iter().filter(|value| self.slots.contains_key(value)).copied();
            lets_for(&system.section, &results(system).chain(shared).collect(), &inner, &mut text);
            self.exports(&values, &mut text);
            let residuals = list(system.phi.iter().map(|id| inner.operand(*id)));
            let rows = list(system.phi_q.iter().map(|row| list(row.iter().map(|id| inner.or_zero(*id)))));
            let _ = writeln!(text, "({residuals}, {rows})");
            Arm { segment, text, lines: system.section.lines.len() }
        });
        let Kind { unknowns, rows, .. } = kind;
        let result = format!("([T; {rows}], [[T; {unknowns}]; {rows}])");
        self.function(&self.signature("evaluate", number, unknowns, "__x", result), arms.collect())
    }

    /// `__holds…`: whether the branches hold that a block decides.
    fn holds(&self, kind: Kind, number: usize) -> String {
        if !kind.branched {
            return String::new();
        }
        let arms = self.of_kind(kind).map(|(segment, block, system)| {
            let inner = Scope { unknowns: &block.coordinates, ..*self.scope };
            let (section, branches) = (&system.branch_section, &system.branches);
            let values = Values::of_section(section, branches.iter().copied(), self.scope);
            let mut text = String::new();
            self.imports(&values, &mut text);
            lets(section, &inner, &mut text);
            let zero = number_of(0.0);
            let holds = branches.iter().map(|id| format!("T::less({zero}, {})", inner.operand(*id)));
            let _ = writeln!(text, "{}", holds.collect::<Vec<_>>().join(" & "));
            Arm { segment, text, lines: section.lines.len() }
        });
        let signature = self.signature("holds", number, kind.unknowns, "__x", "T::Mask".into());
        self.function(&signature, arms.collect())
    }

    /// `__roots…`: both positions of a dyad.
    fn roots(&self, kind: Kind, number: usize) -> String {
        let arms: Vec<Arm> = (self.of_kind(kind))
            .filter_map(|(segment, _, system)| {
                let (dyad, section) = system.dyad.as_ref()?;
                let values = Values::of_section(section, dyad.nodes(), self.scope);
                let mut text = String::new();
                self.imports(&values, &mut text);
                lets(section, self.scope, &mut text);
                let _ = writeln!(text, "{}", formula(dyad, self.scope));
                Some(Arm { segment, text, lines: section.lines.len() })
            })
            .collect();
        if arms.is_empty() {
            return String::new();
        }
        let result = format!("__mbs::Roots<T, {}>", kind.unknowns);
        self.function(&self.signature("roots", number, kind.unknowns, "__near", result), arms)
    }

    fn signature(&self, role: &str, number: usize, unknowns: usize, x: &str, result: String) -> Signature {
        let n = self.scope.model.coordinates.len();
        Signature {
            name: format!("__{role}{number}"),
            q: format!("&[T; {n}]"),
            more: Some((x.into(), format!("&[T; {unknowns}]"))),
            result: Some(result),
        }
    }

    /// A function that does a segment's share, by way of functions of bounded length.
    fn function(&self, signature: &Signature, arms: Vec<Arm>) -> String {
        let values = format!("&__mbs::long::Passed<T, {}>", self.slots.len());
        let mut groups: Vec<(usize, Vec<Arm>)> = Vec::new();
        for arm in arms {
            match groups.last_mut() {
                Some((lines, group)) if *lines + arm.lines <= LONGEST_BODY => {
                    *lines += arm.lines;
                    group.push(arm);
                }
                _ => groups.push((arm.lines, vec![arm])),
            }
        }
        let (mut text, mut choice) = (String::new(), Vec::new());
        for (number, (_, group)) in groups.into_iter().enumerate() {
            let last = group.last().map_or(0, |arm| arm.segment);
            let name = format!("{}_{number}", signature.name);
            text += &signature.declared(&name, &values, "#[inline(never)]");
            choice.push((format!("..={last}"), format!("self.{}", signature.called(&name))));
            let arms = group.into_iter().map(|arm| (arm.segment.to_string(), arm.text));
            let _ = writeln!(text, "{{\n{}}}", selected("__s", arms.collect()));
        }
        text += &signature.declared(&signature.name, &values, "#[inline]");
        text + "{\n" + &selected("__s", choice) + "}\n"
    }

    /// The loop over all segments.
    fn body(&self) -> String {
        let mut text = format!(
            "let __v = __mbs::long::Passed::<T, {}>::none();\n\
             let mut __outcome = T::per_lane(|_| __mbs::Outcome::Converged);\n",
            self.slots.len()
        );
        text += &scales(self.scope.model);
        for (kind, number) in &self.kinds {
            text += &self.places(*kind, *number);
        }
        let choice =
            self.kinds.iter().map(|(kind, number)| (number.to_string(), self.solved(*kind, *number)));
        let mut choice: Vec<(String, String)> = choice.collect();
        choice.push((String::new(), "continue".into()));
        let kind_of = |segment: &Segment<'_>| {
            let kind = segment.newton.and_then(|(block, system)| self.kinds.get(&Kind::of(block, system)));
            kind.copied().unwrap_or(self.kinds.len()).to_string()
        };
        let kinds = list(self.segments.iter().map(kind_of));
        let call = "self.__before(__s, __p, __q, __t, &__v);";
        if self.kinds.is_empty() {
            let _ = writeln!(text, "for __s in 0..{} {{ {call} }}", self.segments.len());
        } else {
            let _ = writeln!(
                text,
                "const __KINDS: &[::core::primitive::u16] = &{kinds};\n\
                 for (__s, __kind) in __KINDS.iter().enumerate() {{\n{call}\n\
                 let __block = {};\n\
                 __outcome = __mbs::failure::first_failure::<T>(__outcome, __block);\n}}",
                selected("__kind", choice)
            );
        }
        let computed: BTreeSet<NodeId> = self.computed();
        for (value, slot) in
            self.program.position.fields.iter().filter(|(value, _)| !computed.contains(value))
        {
            let _ = writeln!(text, "__v.0[{slot}].set({});", self.scope.operand(*value));
        }
        text + "(__outcome, __Position(__v.kept()))"
    }

    /// All that some part computes and passes on.
    fn computed(&self) -> BTreeSet<NodeId> {
        let mut computed = BTreeSet::new();
        for Segment { steps, newton } in &self.segments {
            computed.extend(Values::of_steps(steps, self.scope).computed);
            computed.extend(newton.iter().flat_map(|(_, system)| system.section.computed()));
        }
        computed
    }

    /// The table of all blocks of a kind.
    fn places(&self, kind: Kind, number: usize) -> String {
        let Kind { unknowns, rows, .. } = kind;
        let places = self.of_kind(kind).map(|(_, block, _)| place(block, self.scope));
        format!(
            "const __PLACES{number}: &[__mbs::long::Place<{unknowns}, {rows}>] = &{};\n\
             let mut __places{number} = __PLACES{number}.iter();\n",
            list(places)
        )
    }

    /// The next block of a kind, solved.
    fn solved(&self, kind: Kind, number: usize) -> String {
        let Kind { unknowns, rows, dyad, branched } = kind;
        let factors = self.factors.get(&kind).map_or("", String::as_str);
        let method = if rows > unknowns {
            format!("solve_redundant::<{unknowns}, {rows}>")
        } else if dyad {
            format!("solve_closed::<{unknowns}, {factors}>")
        } else if branched {
            format!("solve_branched::<{unknowns}, {factors}>")
        } else {
            format!("solve::<{unknowns}, {factors}>")
        };
        let call = |role: &str, x: &str| format!("self.__{role}{number}(__s, __p, &*__q, __t, &__v, {x})");
        let mut more = String::new();
        if branched {
            let _ = write!(more, ", |__x| {}", call("holds", "__x"));
        } else if dyad || rows > unknowns {
            more += ", |_| T::mask(true)";
        }
        if dyad {
            let _ = write!(more, ", |__near| {}", call("roots", "__near"));
        }
        let (nowhere, evaluate) = (number_of(f64::INFINITY), call("evaluate", "__x"));
        format!(
            "let ::core::option::Option::Some(__place) = __places{number}.next() else {{ break }};\n\
             let __last = ::core::cell::Cell::new([{nowhere}; {unknowns}]);\n\
             let mut __evaluate = |__x: &[T; {unknowns}]| {{ __last.set(*__x); {evaluate} }};\n\
             let (__x, __block) = __solver.{method}(\
             &__place.block(&__row_scales, &__coordinate_scales), __place.of(&*__q), &mut __evaluate{more});\n\
             if !__mbs::mechanism::is_same(&__last.get(), &__x) {{ __evaluate(&__x); }}\n\
             __place.put(&__x, __q);\n__block\n"
        )
    }
}

/// How a function of all segments is declared and called.
struct Signature {
    name: String,
    /// Type of the coordinates.
    q: String,
    /// The last argument, where there is one more.
    more: Option<(String, String)>,
    result: Option<String>,
}

impl Signature {
    fn declared(&self, name: &str, values: &str, inline: &str) -> String {
        let more = self.more.as_ref().map_or(String::new(), |(name, kind)| format!(", {name}: {kind}"));
        let result = self.result.as_ref().map_or(String::new(), |result| format!(" -> {result}"));
        let q = &self.q;
        format!(
            "{inline}\nfn {name}(&self, __s: ::core::primitive::usize, __p: &__Parameters<T>, __q: {q}, __t: T, \
             __v: {values}{more}){result} "
        )
    }

    fn called(&self, name: &str) -> String {
        let more = self.more.as_ref().map_or(String::new(), |(name, _)| format!(", {name}"));
        format!("{name}(__s, __p, __q, __t, __v{more})")
    }
}

/// `match on { … }`; the last one is taken for all others.
fn selected(on: &str, mut arms: Vec<(String, String)>) -> String {
    let Some((_, last)) = arms.pop() else { return String::new() };
    if arms.is_empty() {
        return last;
    }
    let arms: String = arms.iter().map(|(pattern, code)| format!("{pattern} => {{\n{code}}}\n")).collect();
    format!("match {on} {{\n{arms}_ => {{\n{last}}}\n}}")
}

//! The block-triangular solution of a long mechanism: one loop over all blocks, so that a solver is compiled once per
//! kind of block. Lines that differ from block to block are in functions of bounded length.

pub(crate) mod factorization;
pub(crate) mod parts;
pub(crate) mod repetition;
pub(crate) mod rolled;
pub(crate) mod statement;
pub(crate) mod substitution;
pub(crate) mod tape;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::emit::rust::blocks::formula;
use crate::emit::rust::code::list;
use crate::emit::rust::elimination::{Eliminations, factorization};
use crate::emit::rust::lengths::Lengths;
use crate::emit::rust::long::parts::{ExtraArguments, Parts};
use crate::emit::rust::long::statement::{PUT, Statement};
use crate::emit::rust::scope::{Scope, number as number_of};
use crate::equations::Equations;
use crate::model::Model;
use crate::program::{Assignment, BlockMethod, BlockProgram, Program, System};
use crate::symbolic::NodeId;

/// `true` if all functions of a mechanism are emitted in parts.
pub fn is_long(program: &Program, lengths: Lengths) -> bool {
    newton_blocks(program) > lengths.in_line
        || program.length().max(program.evaluation.lines.len()) > lengths.function
}

/// `true` if its assembly is.
pub fn has_many_blocks(program: &Program, lengths: Lengths) -> bool {
    newton_blocks(program) > lengths.copies
}

/// Blocks that Newton's method solves.
pub fn newton_blocks(program: &Program) -> usize {
    program.blocks.iter().filter(|block| matches!(block.method, BlockMethod::Newton(_))).count()
}

/// Code of the solution.
pub struct Solution {
    /// Body of `solve_with_position`.
    pub body: String,
    /// Functions that it calls.
    pub methods: String,
}

/// Step before an iteration, in the order of computation.
enum Preparation<'a> {
    Line(&'a Assignment),
    /// A coordinate and its value.
    Assign(usize, NodeId),
}

/// Lines of bounded number, and the block solved after them.
#[derive(Default)]
struct Segment<'a> {
    steps: Vec<Preparation<'a>>,
    newton: Option<(&'a BlockProgram, &'a System)>,
}

/// Blocks that one copy of the solvers solves: unknowns, rows, flags for a dyad and for branches that it decides.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct BlockKind {
    unknowns: usize,
    rows: usize,
    dyad: bool,
    branched: bool,
}

impl BlockKind {
    /// The kind of a block.
    pub fn of(block: &BlockProgram, system: &System) -> Self {
        BlockKind {
            unknowns: block.coordinates.len(),
            rows: block.rows.len(),
            dyad: system.dyad.is_some(),
            branched: !system.branches.is_empty(),
        }
    }
}

/// Before: a long program. After: the solution of Φ = 0 with the position stage of its values.
pub fn solve(
    equations: &Equations,
    program: &Program,
    eliminations: &Eliminations,
    scope: &Scope<'_>,
) -> Solution {
    let emission = Emission {
        scope,
        program,
        segments: segments(program),
        kinds: kinds(program),
        factors: factors(program, eliminations),
        metrics: metrics(program, equations),
    };
    let fields = &program.position.fields;
    let mut parts = Parts::new(fields.clone(), fields.len(), scope.lengths);
    emission.before(&mut parts);
    for (kind, number) in &emission.kinds {
        emission.evaluate(*kind, *number, &mut parts);
        emission.holds(*kind, *number, &mut parts);
        emission.roots(*kind, *number, &mut parts);
    }
    let rest = emission.rest(&mut parts);
    let (methods, passed) = parts.print();
    Solution { body: emission.body(passed, &rest), methods }
}

/// The kinds of a program's blocks, numbered.
pub fn kinds(program: &Program) -> BTreeMap<BlockKind, usize> {
    let mut kinds: BTreeMap<BlockKind, usize> = BTreeMap::new();
    for block in &program.blocks {
        if let BlockMethod::Newton(system) = &block.method {
            kinds.insert(BlockKind::of(block, system), 0);
        }
    }
    kinds.values_mut().enumerate().for_each(|(index, number)| *number = index);
    kinds
}

/// Types of the factors of each kind: those of its blocks where all have one pattern, else those of any.
pub fn factors(program: &Program, eliminations: &Eliminations) -> BTreeMap<BlockKind, String> {
    let mut factors: BTreeMap<BlockKind, String> = BTreeMap::new();
    for (index, block) in program.blocks.iter().enumerate() {
        if let BlockMethod::Newton(system) = &block.method {
            let (kind, size) = (BlockKind::of(block, system), block.rows.len());
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
fn place(block: &BlockProgram, scope: &Scope<'_>) -> String {
    let is_angle =
        |c: &usize| scope.model.coordinates.get(*c).is_some_and(|coordinate| coordinate.unit == "rad");
    format!(
        "__mbs::__private::chunks::Place {{ rows: {}, coordinates: {}, angles: {} }}",
        list(block.rows.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(|c| is_angle(c).to_string())),
    )
}

/// `true` if the reference metric consists of numbers alone.
pub fn is_in_numbers(equations: &Equations) -> bool {
    let mut scales = equations.row_scales.iter().chain(&equations.coordinate_scales);
    scales.all(|scale| equations.graph.constant_value(*scale).is_some())
}

/// `let`s of the reference metric.
pub fn scales(model: &Model) -> String {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    format!(
        "let __coordinate_scales: [T; {n}] = __mbs::Mechanism::coordinate_scales(self, __p);\n\
         let __row_scales: [T; {m}] = __mbs::Mechanism::row_scales(self, __p);\n"
    )
}

/// A metric whose blocks differ.
const WHOLE_METRIC: &str = "__mbs::__private::chunks::Metric::Whole(&__row_scales, &__coordinate_scales)";

/// `Metric::…` of each kind: numbers where all blocks of a kind have the same ones.
fn metrics(program: &Program, equations: &Equations) -> BTreeMap<BlockKind, String> {
    let scale = |scales: &[NodeId], index: &usize| equations.graph.constant_value(*scales.get(*index)?);
    let scales = |all: &[NodeId], of: &[usize]| {
        Some(list(
            of.iter().map(|index| scale(all, index).map(number_of)).collect::<Option<Vec<_>>>()?.into_iter(),
        ))
    };
    let mut metrics: BTreeMap<BlockKind, String> = BTreeMap::new();
    for block in &program.blocks {
        if let BlockMethod::Newton(system) = &block.method {
            let rows = scales(&equations.row_scales, &block.rows);
            let coordinates = scales(&equations.coordinate_scales, &block.coordinates);
            let own = rows.zip(coordinates).map_or(WHOLE_METRIC.to_owned(), |(rows, coordinates)| {
                format!("__mbs::__private::chunks::Metric::Shared({rows}, {coordinates})")
            });
            let of_kind = metrics.entry(BlockKind::of(block, system)).or_insert_with(|| own.clone());
            if *of_kind != own {
                *of_kind = WHOLE_METRIC.to_owned();
            }
        }
    }
    metrics
}

/// Body of `phi_q`: its entries, put in their places.
pub fn phi_q(model: &Model) -> String {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    format!(
        "__mbs::__private::chunks::scattered(<Self as __mbs::Mechanism<T, {n}, {m}>>::SPARSITY, \
         &<Self as __mbs::Mechanism<T, {n}, {m}>>::phi_q_entries(self, __p, __s))"
    )
}

/// Segments of lines and assignments, each followed by a nonlinear block; the rest of the position stage is last.
fn segments(program: &Program) -> Vec<Segment<'_>> {
    let mut segments = vec![Segment::default()];
    for block in &program.blocks {
        for line in &block.before.lines {
            push(Preparation::Line(line), &mut segments);
        }
        match &block.method {
            BlockMethod::Explicit { value, .. } => {
                for coordinate in &block.coordinates {
                    push(Preparation::Assign(*coordinate, *value), &mut segments);
                }
            }
            BlockMethod::Newton(system) => match segments.last_mut() {
                Some(last) if last.newton.is_none() => last.newton = Some((block, system)),
                _ => segments.push(Segment { steps: Vec::new(), newton: Some((block, system)) }),
            },
        }
    }
    for line in &program.rest.lines {
        push(Preparation::Line(line), &mut segments);
    }
    segments
}

fn push<'a>(step: Preparation<'a>, segments: &mut Vec<Segment<'a>>) {
    match segments.last_mut() {
        Some(last) if last.newton.is_none() => last.steps.push(step),
        _ => segments.push(Segment { steps: vec![step], newton: None }),
    }
}

/// Data that the methods of a solution are emitted from.
struct Emission<'a> {
    scope: &'a Scope<'a>,
    program: &'a Program,
    segments: Vec<Segment<'a>>,
    kinds: BTreeMap<BlockKind, usize>,
    factors: BTreeMap<BlockKind, String>,
    metrics: BTreeMap<BlockKind, String>,
}

impl Emission<'_> {
    /// Segments with a block of this kind.
    fn of_kind(&self, kind: BlockKind) -> impl Iterator<Item = (usize, &BlockProgram, &System)> {
        let blocks = self.segments.iter().enumerate();
        blocks
            .filter_map(|(number, segment)| segment.newton.map(|(block, system)| (number, block, system)))
            .filter(move |(_, block, system)| BlockKind::of(block, system) == kind)
    }

    /// `__before`: code before each block.
    fn before(&self, parts: &mut Parts) {
        let n = self.scope.model.coordinates.len();
        let frame = frame(format!("&mut [T; {n}]"), None, None);
        let mut arms = Vec::new();
        for (segment, Segment { steps, .. }) in self.segments.iter().enumerate() {
            let mut arm = Vec::new();
            for step in steps {
                match step {
                    Preparation::Line(line) => parts.wordings.of_line(line, self.scope, &mut arm),
                    Preparation::Assign(coordinate, value) => {
                        arm.push(parts.wordings.assign(*coordinate, *value, self.scope));
                    }
                }
            }
            arms.push((segment, arm));
        }
        parts.choice("__before", &frame, arms, (self.segments.len(), true, Some(self.scope)));
    }

    /// `__evaluate…`: residuals and Jacobian of an iterate.
    fn evaluate(&self, kind: BlockKind, number: usize, parts: &mut Parts) {
        let BlockKind { unknowns, rows, .. } = kind;
        let result = format!("([T; {rows}], [[T; {unknowns}]; {rows}])");
        let mut arms = Vec::new();
        for (segment, block, system) in self.of_kind(kind) {
            let inner = Scope { unknowns: &block.coordinates, ..*self.scope };
            let mut arm = parts.lines(&system.section, &inner);
            arm.push(parts.wordings.statement(|open, text| {
                let residuals = list(system.phi.iter().map(|id| open.operand(Some(*id), &inner)));
                let mut row =
                    |row: &Vec<Option<NodeId>>| list(row.iter().map(|id| open.operand(*id, &inner)));
                let rows = list(system.phi_q.iter().map(&mut row));
                let _ = writeln!(text, "({residuals}, {rows})");
            }));
            arms.push((segment, arm));
        }
        let frame = self.frame_of_block("__x", unknowns, result);
        let name = format!("__evaluate{number}");
        parts.choice(&name, &frame, arms, (self.segments.len(), true, None));
        parts.called(&name, &frame);
    }

    /// `__holds…`: `true` if the branches hold that a block decides. Its values belong to a trial and are not passed on.
    fn holds(&self, kind: BlockKind, number: usize, parts: &mut Parts) {
        if !kind.branched {
            return;
        }
        let mut arms = Vec::new();
        for (segment, block, system) in self.of_kind(kind) {
            let inner = Scope { unknowns: &block.coordinates, ..*self.scope };
            let mut arm = parts.lines(&system.branch_section, &inner);
            arm.push(parts.wordings.statement(|open, text| {
                let zero = number_of(0.0);
                let mut holds = |id: &NodeId| format!("T::less({zero}, {})", open.operand(Some(*id), &inner));
                let holds = system.branches.iter().map(&mut holds).collect::<Vec<_>>();
                let _ = writeln!(text, "{}", holds.join(" & "));
            }));
            arms.push((segment, arm));
        }
        let frame = self.frame_of_block("__x", kind.unknowns, "T::Mask".into());
        parts.choice(&format!("__holds{number}"), &frame, arms, (self.segments.len(), false, None));
    }

    /// `__roots…`: both positions of a dyad.
    fn roots(&self, kind: BlockKind, number: usize, parts: &mut Parts) {
        let mut arms = Vec::new();
        for (segment, _, system) in self.of_kind(kind) {
            let Some((dyad, section)) = &system.dyad else { continue };
            let mut arm: Vec<Statement> = parts.lines(section, self.scope);
            arm.push(parts.wordings.statement(|open, text| {
                *text = formula(dyad, &mut |id| open.operand(Some(id), self.scope)) + "\n";
            }));
            arms.push((segment, arm));
        }
        if !arms.is_empty() {
            let result = format!("__mbs::Roots<T, {}>", kind.unknowns);
            let frame = self.frame_of_block("__near", kind.unknowns, result);
            parts.choice(&format!("__roots{number}"), &frame, arms, (self.segments.len(), false, None));
        }
    }

    fn frame_of_block(&self, x: &str, unknowns: usize, result: String) -> ExtraArguments {
        let n = self.scope.model.coordinates.len();
        frame(format!("&[T; {n}]"), Some((x, format!("&[T; {unknowns}]"))), Some(result))
    }

    /// Calls that keep values which no part computes: coordinates and the time that are terms of a row by themselves.
    fn rest(&self, parts: &mut Parts) -> String {
        let computed = self.computed();
        let fields = self.program.position.fields.iter().filter(|(value, _)| !computed.contains(value));
        let put = |(value, slot): (&NodeId, &usize)| parts.wordings.put(PUT, *slot, Some(*value), self.scope);
        let statements: Vec<Statement> = fields.map(put).collect();
        let n = self.scope.model.coordinates.len();
        parts.sequence(
            "__rest",
            &frame(format!("&[T; {n}]"), None, None),
            &statements,
            (self.scope.lengths.body, None),
        )
    }

    /// The loop over all segments, `passed` values passed on, and the `rest`.
    fn body(&self, passed: usize, rest: &str) -> String {
        let mut text = format!(
            "let __v = &__mbs::__private::chunks::Passed::<T, {passed}>::none();\n\
             let mut __outcome = T::per_lane(|_| __mbs::Outcome::Converged);\n"
        );
        if self.metrics.values().any(|metric| metric == WHOLE_METRIC) {
            text += &scales(self.scope.model);
        }
        for (kind, number) in &self.kinds {
            text += &self.places(*kind, *number);
        }
        let choice =
            self.kinds.iter().map(|(kind, number)| (number.to_string(), self.solved(*kind, *number)));
        let mut choice: Vec<(String, String)> = choice.collect();
        choice.push((String::new(), "continue".into()));
        // Twice the number of its kind, plus 1 where code precedes the block, which is rare.
        let segment_of = |segment: &Segment<'_>| {
            let kind =
                segment.newton.and_then(|(block, system)| self.kinds.get(&BlockKind::of(block, system)));
            let kind = kind.copied().unwrap_or(self.kinds.len());
            (2 * kind + usize::from(!segment.steps.is_empty())).to_string()
        };
        let segments = list(self.segments.iter().map(segment_of));
        let call = "self.__before(__s, __p, __q, __t, __v);";
        if self.kinds.is_empty() {
            let _ = writeln!(text, "for __s in 0..{} {{ {call} }}", self.segments.len());
        } else {
            let _ = writeln!(
                text,
                "const __SEGMENTS: &[::core::primitive::u16] = &{segments};\n\
                 for (__s, __segment) in __SEGMENTS.iter().enumerate() {{\n\
                 if __segment % 2 == 1 {{ {call} }}\n\
                 let __block = {};\n\
                 __outcome = __mbs::__private::first_failure::<T>(__outcome, __block);\n}}",
                selected("__segment / 2", choice)
            );
        }
        text += rest;
        text + "(__outcome, __Position(__v.kept()))"
    }

    /// All that some part computes and passes on.
    fn computed(&self) -> BTreeSet<NodeId> {
        let mut computed = BTreeSet::new();
        for Segment { steps, newton } in &self.segments {
            let lines = steps
                .iter()
                .filter_map(|step| if let Preparation::Line(line) = step { Some(line) } else { None });
            computed.extend(lines.flat_map(|line| line.values()));
            computed.extend(newton.iter().flat_map(|(_, system)| system.section.computed()));
        }
        computed
    }

    /// The table of all blocks of a kind.
    fn places(&self, kind: BlockKind, number: usize) -> String {
        let BlockKind { unknowns, rows, .. } = kind;
        let places = self.of_kind(kind).map(|(_, block, _)| place(block, self.scope));
        format!(
            "const __PLACES{number}: &[__mbs::__private::chunks::Place<{unknowns}, {rows}>] = &{};\n\
             let mut __places{number} = __PLACES{number}.iter();\n",
            list(places)
        )
    }

    /// The next block of a kind, solved.
    fn solved(&self, kind: BlockKind, number: usize) -> String {
        let BlockKind { unknowns, rows, dyad, branched } = kind;
        let factors = self.factors.get(&kind).map_or("", String::as_str);
        let metric = self.metrics.get(&kind).map_or(WHOLE_METRIC, String::as_str);
        let method = if rows > unknowns {
            format!("solve_redundant::<{unknowns}, {rows}>")
        } else if dyad {
            format!("solve_closed::<{unknowns}, {factors}>")
        } else if branched {
            format!("solve_branched::<{unknowns}, {factors}>")
        } else {
            format!("solve::<{unknowns}, {factors}>")
        };
        let call = |role: &str, x: &str| format!("self.__{role}{number}(__s, __p, &*__q, __t, {x}, __v)");
        let mut more = String::new();
        if branched {
            let _ = write!(more, ", |__x| {}", call("holds", "__x"));
        } else if dyad || rows > unknowns {
            more += ", |_| T::mask(true)";
        }
        if dyad {
            let _ = write!(more, ", |__near| {}", call("roots", "__near"));
        }
        let widths = if rows > unknowns {
            crate::emit::rust::blocks::widths(self.scope.model, "__place.rows")
        } else {
            String::new()
        };
        let nowhere = number_of(f64::INFINITY);
        let (evaluate, called) = (call("evaluate", "__x"), call("called_evaluate", "__x"));
        format!(
            "let ::core::option::Option::Some(__place) = __places{number}.next() else {{ break }};\n\
             let __last = ::core::cell::Cell::new([{nowhere}; {unknowns}]);\n\
             let mut __evaluate = |__x: &[T; {unknowns}]| {{\n\
             __last.set(*__x);\nif __S::INLINED_PER_BLOCK {{ {evaluate} }} else {{ {called} }}\n}};\n\
             let (__x, __block) = __solver.{method}(\
             &__place.block(&{metric}), {widths}__place.of(&*__q), &mut __evaluate{more});\n\
             if !__S::INLINED_PER_BLOCK && !__mbs::__private::is_same(&__last.get(), &__x) {{ __evaluate(&__x); }}\n\
             __place.put(&__x, __q);\n__block\n"
        )
    }
}

/// Arguments of the functions of all segments.
fn frame(q: String, more: Option<(&str, String)>, result: Option<String>) -> ExtraArguments {
    let (declared, given) = match more {
        Some((name, kind)) => (format!("{name}: {kind}, "), format!("{name}, ")),
        None => (String::new(), String::new()),
    };
    ExtraArguments {
        declared: format!("__p: &__Parameters<T>, __q: {q}, __t: T, {declared}"),
        given: format!("__p, __q, __t, {given}"),
        result,
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

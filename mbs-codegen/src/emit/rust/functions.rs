//! Bodies of the emitted functions.

use std::fmt::Write;

use proc_macro2::TokenStream;

use crate::emit::rust::blocks;
use crate::emit::rust::code::{array, block, body, lets, matrix, tokens};
use crate::emit::rust::dynamics::{self, DynamicBodies};
use crate::emit::rust::elimination::Eliminations;
use crate::emit::rust::events;
use crate::emit::rust::jacobian_outputs;
use crate::emit::rust::lengths::Lengths;
use crate::emit::rust::linear;
use crate::emit::rust::long;
use crate::emit::rust::long::parts::{self, ExtraArguments};
use crate::emit::rust::motion;
use crate::emit::rust::phases;
use crate::emit::rust::scope::{Scope, Written, number};
use crate::emit::rust::signals;
use crate::emit::rust::sparse::Sparse;
use crate::emit::rust::work;
use crate::equations::Equations;
use crate::equations::continuity::{self, Demand};
use crate::model::Model;
use crate::program::{Program, Section, Stage};
use crate::structure::Structure;
use crate::symbolic::NodeId;

/// The emitted functions, and the lengths of the arrays that stages keep.
pub struct Bodies {
    /// Highest derivative of each declared function that is used.
    pub orders: Vec<u8>,
    pub kept_parameters: usize,
    /// Number of contacts, where their forces are evaluated one by one.
    pub contacts: Option<usize>,
    /// Number of frictions with stiction, where there are any.
    pub frictions: Option<usize>,
    /// Number of values that events set, where there are any.
    pub remembered: Option<usize>,
    pub kept_position: usize,
    pub parameters: TokenStream,
    pub guess: TokenStream,
    pub coordinate_scales: TokenStream,
    pub row_scales: TokenStream,
    /// None where no row has a width.
    pub widths: Option<TokenStream>,
    pub position: TokenStream,
    pub phi: TokenStream,
    pub phi_q: TokenStream,
    pub phi_q_entries: TokenStream,
    /// Row and column of each entry of Φ_q.
    pub sparsity: Vec<(u16, u16)>,
    pub phi_t: TokenStream,
    pub phi_tt: TokenStream,
    pub phi_qt_qd: TokenStream,
    pub gamma: TokenStream,
    /// Φ, Φ_q, Φ_t and γ in one call; long ones are computed function by function.
    pub evaluate: Option<TokenStream>,
    pub branches: TokenStream,
    pub limits: TokenStream,
    /// `start_phases`, `advance_phases`, `phase_rates` and `carry_signals`, where there are any.
    pub phases: TokenStream,
    /// The function of speeds that they share.
    pub speeds: TokenStream,
    pub outputs: TokenStream,
    /// Declaration of the factors' struct.
    pub factors: TokenStream,
    /// `true` if they are short enough to be inlined.
    pub short: bool,
    /// `true` if the factorization is, which a step contains once and careful steps share.
    pub factorizes_in_line: bool,
    pub solve_with_position: TokenStream,
    /// Body of `solve_blocks`, where it is not that of `solve_with_position`.
    pub solve_blocks: Option<TokenStream>,
    /// Body of `solve_motion`, where it differs from the functions above in sequence.
    pub solve_motion: Option<TokenStream>,
    /// `true` if a step takes second derivatives of dyads of circles and lines.
    pub has_circles: bool,
    /// `true` if blocks are eliminated in orders of their own.
    pub has_orders: bool,
    /// Functions of bounded length that a long solution calls.
    pub methods: TokenStream,
    /// Those that other long functions call.
    pub parts: TokenStream,
    pub factorize: TokenStream,
    pub solve_linear: TokenStream,
    /// Operation counts of these functions.
    pub work: TokenStream,
    /// Coordinates that no block solves for.
    pub independent: Vec<u16>,
    /// `true` if each of them has a mass of its own.
    pub is_uncoupled: bool,
    /// Factors of M and all rows without their zeros, where they save much.
    pub sparse: Option<Sparse>,
    pub complete: TokenStream,
    pub reduce: TokenStream,
    /// Masses and forces, where the text has any.
    pub dynamics: Option<DynamicBodies>,
}

/// `true` if no row has one of the `independent` coordinates, and no entry of M couples one with any other coordinate.
fn is_uncoupled(equations: &Equations, independent: &[usize]) -> bool {
    let Some(dynamics) = &equations.dynamics else { return false };
    let is_free = |index: &usize| independent.binary_search(index).is_ok();
    let couples = |row: usize, column: usize| row != column && (is_free(&row) || is_free(&column));
    let in_rows = equations.rows.iter().flat_map(|row| &row.phi_q).any(|(column, _)| is_free(column));
    let mut masses = dynamics.mass.iter().enumerate();
    !in_rows && !masses.any(|(row, entries)| entries.iter().any(|(column, _)| couples(row, *column)))
}

/// Most operations of a solution with its factorization that is always inlined into a step. The numbers of one loop or
/// two stay in registers. Those of more do not, and copies in several places would only be longer.
const LONGEST_INLINED: usize = 150;

/// Before: the program of a model, and the types of its declared functions. After: one body a function.
pub fn bodies(
    model: &Model,
    equations: &Equations,
    structure: &Structure,
    program: &Program,
    runtime: &TokenStream,
    types: &[String],
    lengths: Lengths,
) -> Bodies {
    let graph = &equations.graph;
    let bare = Scope { graph, model, types, parameters: None, position: None, unknowns: &[], lengths };
    let demands = continuity::highest(model, equations);
    let early = Scope { parameters: Some(&program.parameters.fields), ..bare };
    let scope = Scope { position: Some(&program.position.fields), ..early };
    let is_long = long::is_long(program, lengths);
    let (contacts, frictions) = (dynamics::contacts(equations), dynamics::frictions(equations));
    let remembered = events::remembered(equations);
    let memory = memory(contacts, frictions, remembered);
    let mut emitter =
        Emitter { scope: &scope, early: &early, is_long, memory, parts: String::new(), runtime };
    let rows = |part: fn(&crate::equations::Row) -> Option<NodeId>| -> Vec<Option<NodeId>> {
        equations.rows.iter().map(part).collect()
    };
    let some = |nodes: &[NodeId]| -> Vec<Option<NodeId>> { nodes.iter().copied().map(Some).collect() };
    let given = jacobian_outputs::lets(equations, program, &scope);
    let mut outputs_text = String::new();
    lets(&program.outputs, &scope, &mut outputs_text);
    outputs_text += &outputs(equations, &scope);
    let (phases, speeds) = phases::functions(equations, program, &bare);
    let mut phases = phases::turns(equations, model) + &phases::folds(equations, model) + &phases;
    let orders = orders(model, &demands);
    phases += &jets(&orders, &bare);
    if equations.dynamics.is_some() {
        phases += &signals::carry(model);
    }
    let independent = &structure.independent;
    let eliminations = Eliminations::of(equations, program);
    let linear = linear::linear(equations, program, (&scope, &eliminations), independent, is_long);
    let position = kept(&program.position, &early, "__Position");
    let solve_motion = motion::solve(equations, program, (&early, &eliminations), &position);
    let parts = (is_long || long::has_many_blocks(program, lengths))
        .then(|| long::solve(equations, program, &eliminations, &early));
    let (solve_with_position, solve_blocks) = match &parts {
        Some(parts) if is_long => (parts.body.clone(), None),
        Some(parts) => (
            format!("if !__S::INLINED_PER_BLOCK {{\nreturn {{\n{}\n}};\n}}\n", parts.body)
                + &blocks::solve(equations, program, &eliminations, &early, &position),
            Some(format!("let (__outcome, _) = {{\n{}\n}};\n__outcome", parts.body)),
        ),
        None => (blocks::solve(equations, program, &eliminations, &early, &position), None),
    };
    let methods = parts.map_or(String::new(), |parts| parts.methods) + &linear.methods;
    let phi_q = match is_long {
        true => long::phi_q(model),
        false => {
            let mut text = String::new();
            lets(&program.phi_q, &scope, &mut text);
            text + &matrix(equations.rows.iter().map(|row| &row.phi_q), &scope)
        }
    };
    let entries: Vec<(usize, usize, NodeId)> = entries(equations).collect();
    let is_uncoupled = is_uncoupled(equations, independent);
    Bodies {
        kept_parameters: program.parameters.fields.len(),
        contacts,
        frictions,
        remembered,
        kept_position: program.position.fields.len(),
        orders,
        parameters: emitter.parameters(
            &program.parameters,
            smooth_enough(&continuity::of_declarations(model, demands), &bare),
            &bare,
        ),
        guess: emitter.of_parameters("guess", &program.guesses, &some(&equations.guesses)),
        coordinate_scales: emitter.of_parameters(
            "coordinate_scales",
            &program.coordinate_scales,
            &some(&equations.coordinate_scales),
        ),
        row_scales: emitter.of_parameters("row_scales", &program.row_scales, &some(&equations.row_scales)),
        widths: (!equations.widths.is_empty())
            .then(|| emitter.of_parameters("widths", &program.widths, &some(&equations.widths))),
        position: emitter.position(&program.position),
        phi: emitter.of_position("phi", &program.phi, &rows(|row| Some(row.phi))),
        phi_q: block(&phi_q, runtime),
        sparsity: entries.iter().map(|(row, column, _)| (*row as u16, *column as u16)).collect(),
        phi_q_entries: emitter.of_position(
            "phi_q_entries",
            &program.phi_q,
            &entries.iter().map(|(.., id)| Some(*id)).collect::<Vec<_>>(),
        ),
        phi_t: emitter.of_position("phi_t", &program.phi_t, &rows(|row| row.phi_t)),
        phi_tt: emitter.of_position("phi_tt", &program.phi_tt, &rows(|row| row.phi_tt)),
        phi_qt_qd: emitter.of_velocity("phi_qt_qd", &program.phi_qt_qd, &rows(|row| row.phi_qt_qd)),
        gamma: emitter.of_velocity("gamma", &program.gamma, &rows(|row| row.gamma)),
        evaluate: (!is_long)
            .then(|| body(&program.evaluation, &early, &evaluation(equations, &early), runtime)),
        branches: emitter.of_position("branches", &program.branches, &some(&equations.branches)),
        limits: body(&program.limits, &scope, &limits(equations, &scope), runtime),
        phases: tokens(&phases, runtime),
        speeds: tokens(&speeds, runtime),
        outputs: block(&(given + &outputs_text), runtime),
        has_orders: !eliminations.types.is_empty(),
        factors: tokens(&(eliminations.types + &linear.factors), runtime),
        short: program.length() <= LONGEST_INLINED,
        factorizes_in_line: long::newton_blocks(program) <= lengths.factors,
        solve_with_position: block(&solve_with_position, runtime),
        solve_blocks: solve_blocks.map(|text| block(&text, runtime)),
        solve_motion: solve_motion.map(|text| block(&text, runtime)),
        has_circles: structure.blocks.iter().any(|block| block.curvature.is_some()),
        methods: tokens(&methods, runtime),
        parts: tokens(&emitter.parts, runtime),
        factorize: block(&linear.factorize, runtime),
        solve_linear: block(&linear.solve, runtime),
        work: work::work(model, equations, program, entries.len(), runtime),
        is_uncoupled,
        sparse: (!is_uncoupled)
            .then(|| Sparse::of(equations, structure, program, (&scope, is_long), runtime))
            .flatten(),
        independent: independent.iter().map(|coordinate| *coordinate as u16).collect(),
        complete: block(&linear.complete, runtime),
        reduce: block(&linear.reduce, runtime),
        dynamics: dynamics::bodies(equations, program, &early, &scope, runtime),
    }
}

/// Emits functions of the stages: in one body, or long ones in parts.
struct Emitter<'a> {
    scope: &'a Scope<'a>,
    early: &'a Scope<'a>,
    is_long: bool,
    /// Further fields of the parameter stage.
    memory: String,
    /// The parts, all together.
    parts: String,
    runtime: &'a TokenStream,
}

impl Emitter<'_> {
    /// A function of the parameter stage.
    fn of_parameters(&mut self, name: &str, section: &Section, results: &[Option<NodeId>]) -> TokenStream {
        let frame = frame("__p: &__Parameters<T>, ", "__p, ");
        self.emitted((name, &frame), section, results, self.early)
    }

    /// A function of the position stage.
    fn of_position(&mut self, name: &str, section: &Section, results: &[Option<NodeId>]) -> TokenStream {
        let frame = frame("__p: &__Parameters<T>, __s: &__Position<T>, ", "__p, __s, ");
        self.emitted((name, &frame), section, results, self.scope)
    }

    /// A function of the position stage and q̇.
    fn of_velocity(&mut self, name: &str, section: &Section, results: &[Option<NodeId>]) -> TokenStream {
        let n = self.scope.model.coordinates.len();
        let declared = format!("__p: &__Parameters<T>, __s: &__Position<T>, __qd: &[T; {n}], ");
        self.emitted((name, &frame(&declared, "__p, __s, __qd, ")), section, results, self.scope)
    }

    /// The parameter stage, after `assertions`.
    fn parameters(&mut self, stage: &Stage, assertions: String, bare: &Scope<'_>) -> TokenStream {
        self.stage(("parameters", "__Parameters"), &frame("", ""), stage, (bare, assertions))
    }

    /// The position stage.
    fn position(&mut self, stage: &Stage) -> TokenStream {
        let n = self.scope.model.coordinates.len();
        let frame = frame(&format!("__p: &__Parameters<T>, __q: &[T; {n}], __t: T, "), "__p, __q, __t, ");
        self.stage(("position", "__Position"), &frame, stage, (self.early, String::new()))
    }

    fn stage(
        &mut self,
        (name, kind): (&str, &str),
        frame: &ExtraArguments,
        stage: &Stage,
        (scope, first): (&Scope<'_>, String),
    ) -> TokenStream {
        let more = if kind == "__Parameters" { self.memory.clone() } else { String::new() };
        if !self.is_long {
            let result = format!("{kind}({}{more})", kept_values(stage, scope));
            return body(&stage.section, scope, &(first + &result), self.runtime);
        }
        let results: Vec<Option<NodeId>> = stage.fields.keys().copied().map(Some).collect();
        let body = self.in_parts((name, frame), &stage.section, &results, scope);
        block(&format!("{first}{body}{kind}(__v.kept(){more})"), self.runtime)
    }

    fn emitted(
        &mut self,
        named: (&str, &ExtraArguments),
        section: &Section,
        results: &[Option<NodeId>],
        scope: &Scope<'_>,
    ) -> TokenStream {
        if !self.is_long {
            return body(section, scope, &array(results.iter().copied(), scope), self.runtime);
        }
        let in_numbers = numbers(results, scope);
        let text = in_numbers.unwrap_or_else(|| self.in_parts(named, section, results, scope) + "__v.kept()");
        block(&text, self.runtime)
    }

    fn in_parts(
        &mut self,
        (name, frame): (&str, &ExtraArguments),
        section: &Section,
        results: &[Option<NodeId>],
        scope: &Scope<'_>,
    ) -> String {
        let function = parts::function(&format!("__{name}"), frame, (section, results), scope);
        self.parts += &function.methods;
        function.body
    }
}

/// Within a stage itself its values are locals.
fn kept(stage: &Stage, scope: &Scope<'_>, name: &str) -> String {
    format!("{name}({})", kept_values(stage, scope))
}

fn kept_values(stage: &Stage, scope: &Scope<'_>) -> String {
    array(stage.fields.keys().map(|id| Some(*id)), scope)
}

/// By default the forces of all contacts are evaluated; how frictions stick and slide is not known, and no event holds.
fn memory(contacts: Option<usize>, frictions: Option<usize>, remembered: Option<usize>) -> String {
    let frictions = frictions.or(remembered.map(|_| 0));
    let contacts = contacts.or(frictions.map(|_| 0));
    let mut text = contacts.map_or(String::new(), |contacts| format!(", [true; {contacts}]"));
    if let Some(frictions) = frictions {
        text += &format!(", [__mbs::dynamics::SetValuedMode::new(); {frictions}]");
    }
    if let Some(remembered) = remembered {
        text += &format!(", [{}; {remembered}]", number(0.0));
    }
    text
}

fn frame(declared: &str, given: &str) -> ExtraArguments {
    ExtraArguments { declared: declared.into(), given: given.into(), result: None }
}

fn evaluation(equations: &Equations, scope: &Scope<'_>) -> String {
    let rows =
        |part: fn(&crate::equations::Row) -> Option<NodeId>| array(equations.rows.iter().map(part), scope);
    format!(
        "__mbs::Evaluation {{ phi: {}, phi_q_entries: {}, phi_t: {}, gamma: {} }}",
        rows(|row| Some(row.phi)),
        array(entries(equations).map(|(.., id)| Some(id)), scope),
        rows(|row| row.phi_t),
        rows(|row| row.gamma),
    )
}

/// Highest derivative of each function that is needed.
fn orders(model: &Model, demands: &[Demand]) -> Vec<u8> {
    let mut orders = vec![0; model.functions.len()];
    for demand in demands {
        if let Some(order) = orders.get_mut(demand.function) {
            *order = demand.order;
        }
    }
    orders
}

/// `jets`, where functions are declared: they as programs call them.
fn jets(orders: &[u8], scope: &Scope<'_>) -> String {
    if orders.is_empty() {
        return String::new();
    }
    let mut arms = String::new();
    for (index, order) in orders.iter().enumerate() {
        let (kind, field, place) = scope.function(index);
        let element = place.map_or_else(String::new, |place| format!("[{place}]"));
        let count = u16::from(*order) + 1;
        let _ = writeln!(
            arms,
            "{index} => __see(&<{kind} as __mbs::Function<T>>::jet::<{count}>(&{field}{element}, __x)),"
        );
    }
    format!(
        "fn jets(&self, __index: ::core::primitive::usize, __x: T, __see: impl ::core::ops::FnOnce(&[T])) {{\n\
         match __index {{\n{arms}_ => {{}}\n}}\n}}\n"
    )
}

/// Assertions at compile time that the types which the caller chose are smooth enough.
fn smooth_enough(demands: &[Demand], scope: &Scope<'_>) -> String {
    let mut text = String::new();
    for Demand { function, order, by, .. } in demands.iter().filter(|demand| demand.order > 0) {
        let (kind, ..) = scope.function(*function);
        let name = scope.model.functions.get(*function).map_or("", |function| &function.name.text);
        let plural = if *order == 1 { "" } else { "s" };
        let message =
            format!("function `{name}` must have {order} continuous derivative{plural}: {by} needs them");
        let _ = writeln!(
            text,
            "const {{ ::core::assert!(<{kind} as __mbs::Function<T>>::ORDER >= {order}, {message:?}) }};"
        );
    }
    text
}

/// Row, column and node of each entry of Φ_q, row by row.
fn entries(equations: &Equations) -> impl Iterator<Item = (usize, usize, NodeId)> {
    let rows = equations.rows.iter().enumerate();
    rows.flat_map(|(row, equation)| equation.phi_q.iter().map(move |(column, entry)| (row, *column, *entry)))
}

fn limits(equations: &Equations, scope: &Scope<'_>) -> String {
    let limit = |[low, value, high]: &[NodeId; 3]| {
        let of = |id: &NodeId| scope.operand(*id);
        format!("__mbs::Limit {{ low: {}, value: {}, high: {} }}", of(low), of(value), of(high))
    };
    format!("[{}]", equations.limits.iter().map(limit).collect::<Vec<_>>().join(", "))
}

fn outputs(equations: &Equations, scope: &Scope<'_>) -> String {
    let rate = |rate: Option<Option<NodeId>>| match rate {
        Some(value) => format!("::core::option::Option::Some({})", scope.or_zero(value)),
        None => "::core::option::Option::None".into(),
    };
    let mut text = String::from("[");
    for output in &equations.outputs {
        let _ = writeln!(
            text,
            "__mbs::OutputValue {{ value: {}, rate: {}, acceleration: {} }},",
            scope.operand(output.value),
            rate(output.rate),
            rate(output.acceleration)
        );
    }
    text + "]"
}

/// Before: results of a long function. After: their array out of a table, where all are numbers, as those of most metrics are;
/// an expression for each would keep a compiler busy for long.
fn numbers(results: &[Option<NodeId>], scope: &Scope<'_>) -> Option<String> {
    let number_of = |id: &Option<NodeId>| match id.map(|id| scope.written(id)) {
        None => Some(0.0),
        Some(Written::Number(value)) => Some(value),
        Some(_) => None,
    };
    let numbers: Vec<f64> = results.iter().map(number_of).collect::<Option<_>>()?;
    let (first, count) = (numbers.first().copied().unwrap_or(0.0), numbers.len());
    if numbers.iter().all(|number| number.to_bits() == first.to_bits()) {
        return Some(format!("[{}; {count}]", number(first)));
    }
    Some(format!(
        "const __NUMBERS: &[::core::primitive::f64; {count}] = &{numbers:?};\n__mbs::__private::chunks::constants(__NUMBERS)"
    ))
}

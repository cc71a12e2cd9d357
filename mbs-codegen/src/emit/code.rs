//! Function bodies: printed as text, parsed into tokens once.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use quote::quote;

use super::scope::Scope;
use crate::program::{Angle, Jet, Line, Section};
use crate::symbolic::{Binary, Node, NodeId, Unary};

/// Text in which `__mbs` stands for the runtime's path.
pub const RUNTIME: &str = "__mbs";

/// Before: printed code. After: its tokens, [`RUNTIME`] replaced by the path that the wrapper macro passed on.
pub fn tokens(text: &str, runtime: &TokenStream) -> TokenStream {
    match text.parse() {
        Ok(parsed) if text.contains(RUNTIME) => with_runtime(parsed, runtime),
        Ok(parsed) => parsed,
        Err(_) => {
            quote! { ::core::compile_error! { "the emitted code does not lex; please report the mechanism" } }
        }
    }
}

/// [`tokens`] as the body of a function: one group in braces, which is put in its place without a copy of each token.
pub fn block(text: &str, runtime: &TokenStream) -> TokenStream {
    TokenTree::Group(Group::new(Delimiter::Brace, tokens(text, runtime))).into()
}

/// The depth of emitted code is that of its own brackets, a handful.
fn with_runtime(stream: TokenStream, runtime: &TokenStream) -> TokenStream {
    let mut replaced: Vec<TokenTree> = Vec::new();
    for tree in stream {
        match tree {
            TokenTree::Ident(name) if name == RUNTIME => replaced.extend(runtime.clone()),
            TokenTree::Group(group) => {
                let inner = with_runtime(group.stream(), runtime);
                replaced.push(TokenTree::Group(Group::new(group.delimiter(), inner)));
            }
            other => replaced.push(other),
        }
    }
    replaced.into_iter().collect()
}

/// Most `let`s of one function body. One long chain overflows rustc's stack in debug builds near 2 900 and takes its
/// memory past 30 000; bodies of a few hundred keep both linear.
pub const LONGEST_BODY: usize = 200;

/// Longest section, solution or evaluation that stays one function behind the compiler's optimisation, which takes more than
/// linear time.
pub const LONGEST_FUNCTION: usize = 2_000;

/// Prints one `let` a line of the section; a long section is cut into closures that pass on what is used behind them.
pub fn lets(section: &Section, scope: &Scope<'_>, text: &mut String) {
    lets_for(section, &section.results, scope, text);
}

/// [`lets`], where other values than the section's results are used behind it.
pub fn lets_for(section: &Section, results: &BTreeSet<NodeId>, scope: &Scope<'_>, text: &mut String) {
    if section.lines.len() <= LONGEST_BODY {
        return section.lines.iter().for_each(|line| print(line, scope, text));
    }
    let (chunks, exports) = chunks(section, results, scope);
    if section.lines.len() > LONGEST_FUNCTION {
        return apart(&chunks, &exports, results, &BTreeMap::new(), scope, text);
    }
    for (chunk, exports) in chunks.into_iter().zip(exports) {
        let names = exports.iter().map(|id| local(*id)).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "let [{names}] = (|| -> [T; {}] {{", exports.len());
        chunk.iter().for_each(|line| print(line, scope, text));
        let _ = writeln!(text, "[{names}]\n}})();");
    }
}

/// Before: a section longer than [`LONGEST_FUNCTION`]. After: its code, which leaves the `kept` values at their places in the
/// array `__kept`. Each part puts there what it computes: one place that takes values out of all arrays of the parts would be
/// as long as they are together, and that is what takes a compiler longest.
pub fn lets_kept(section: &Section, kept: &BTreeMap<NodeId, usize>, scope: &Scope<'_>, text: &mut String) {
    let (chunks, exports) = chunks(section, &kept.keys().copied().collect(), scope);
    let zero = scope.or_zero(None);
    let _ = writeln!(text, "let mut __kept = [{zero}; {}];", kept.len());
    // Coordinates and the time stand in no line.
    let computed: BTreeSet<NodeId> = exports.iter().flatten().copied().collect();
    for (id, place) in kept.iter().filter(|(id, _)| !computed.contains(id)) {
        let _ = writeln!(text, "__kept[{place}] = {};", scope.operand(*id));
    }
    apart(&chunks, &exports, &BTreeSet::new(), kept, scope, text);
}

/// Lines in chunks of bounded length, and of each the values that chunks behind it, or the results, use.
fn chunks<'a>(
    section: &'a Section,
    results: &BTreeSet<NodeId>,
    scope: &Scope<'_>,
) -> (Vec<&'a [Line]>, Vec<Vec<NodeId>>) {
    let chunks: Vec<&[Line]> = section.lines.chunks(LONGEST_BODY).collect();
    // Values that chunks from here on use; collected from the back.
    let mut used = vec![false; scope.graph.len()];
    let mark = |ids: &[NodeId], used: &mut [bool]| {
        for id in ids {
            used.get_mut(id.index()).into_iter().for_each(|mark| *mark = true);
        }
    };
    results.iter().for_each(|id| mark(&[*id], &mut used));
    let mut exports: Vec<Vec<NodeId>> = Vec::new();
    for chunk in chunks.iter().rev() {
        let is_used = |id: &NodeId| used.get(id.index()).copied().unwrap_or(false);
        exports.push(chunk.iter().flat_map(Line::values).filter(is_used).collect());
        chunk.iter().for_each(|line| mark(&line.operands(scope.graph), &mut used));
    }
    exports.reverse();
    (chunks, exports)
}

/// Prints chunks that stay functions of their own; what they pass on is taken from arrays where it is used, `kept` values from
/// `__kept`.
fn apart(
    chunks: &[&[Line]],
    exports: &[Vec<NodeId>],
    results: &BTreeSet<NodeId>,
    kept: &BTreeMap<NodeId, usize>,
    scope: &Scope<'_>,
    text: &mut String,
) {
    let mut places: BTreeMap<NodeId, String> = BTreeMap::new();
    for (number, (chunk, exports)) in chunks.iter().zip(exports).enumerate() {
        let (stay, passed): (Vec<NodeId>, Vec<NodeId>) =
            exports.iter().copied().partition(|id| kept.contains_key(id));
        let _ = writeln!(text, "let __part{number} = __mbs::long::apart(|| -> [T; {}] {{", passed.len());
        let used: BTreeSet<NodeId> = chunk.iter().flat_map(|line| line.operands(scope.graph)).collect();
        taken(&used, &places, text);
        chunk.iter().for_each(|line| print(line, scope, text));
        for (id, place) in stay.iter().filter_map(|id| Some((*id, kept.get(id)?))) {
            let _ = writeln!(text, "__kept[{place}] = {};", local(id));
            places.insert(id, format!("__kept[{place}]"));
        }
        let names = passed.iter().map(|id| local(*id)).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "[{names}]\n}});");
        places.extend(passed.iter().enumerate().map(|(index, id)| (*id, format!("__part{number}[{index}]"))));
    }
    taken(results, &places, text);
}

/// Values out of the arrays of parts, as far as they stand there.
fn taken(ids: &BTreeSet<NodeId>, places: &BTreeMap<NodeId, String>, text: &mut String) {
    bind(ids.iter().filter_map(|id| Some((local(*id), places.get(id)?.clone()))), text);
}

/// Locals of the scalar type, all in one `let`: each further one nests what debug information says of the others.
pub fn bind(locals: impl Iterator<Item = (String, String)>, text: &mut String) {
    let (names, values): (Vec<String>, Vec<String>) = locals.unzip();
    if !names.is_empty() {
        let _ = writeln!(text, "let [{}] = [{}];", names.join(", "), values.join(", "));
    }
}

/// Prints a line.
pub fn print(line: &Line, scope: &Scope<'_>, text: &mut String) {
    match line {
        Line::Value(id) => {
            let value = operation(scope.graph.node(*id), scope);
            let _ = writeln!(text, "let {} = {value};", local(*id));
        }
        Line::SineCosine(angles) => {
            let name = |id: Option<NodeId>| id.map_or_else(|| "_".to_owned(), local);
            let (sines, cosines, operands) = (
                list(angles, |known| name(known.sine)),
                list(angles, |known| name(known.cosine)),
                list(angles, |known| scope.operand(known.angle)),
            );
            let _ = writeln!(text, "let ([{sines}], [{cosines}]) = T::sin_cos([{operands}]);");
        }
        Line::Jet(Jet { function, argument, orders }) => {
            let names: Vec<String> =
                orders.iter().map(|id| id.map_or_else(|| "_".to_owned(), local)).collect();
            let (names, count) = (names.join(", "), orders.len());
            let (kind, place) = scope.function(*function as usize);
            let argument = scope.operand(*argument);
            let _ = writeln!(
                text,
                "let [{names}] = <{kind} as __mbs::Function<T>>::jet::<{count}>(&{place}, {argument});"
            );
        }
    }
}

fn list(angles: &[Angle], part: impl FnMut(&Angle) -> String) -> String {
    angles.iter().map(part).collect::<Vec<_>>().join(", ")
}

/// Name of the local variable of a node.
pub fn local(id: NodeId) -> String {
    format!("__n{}", id.index())
}

fn operation(node: Node, scope: &Scope<'_>) -> String {
    let of = |id: NodeId| scope.operand(id);
    match node {
        // Calls stand in jets.
        Node::Constant(_) | Node::Leaf(_) | Node::Call { .. } => scope.leaf(node),
        Node::Unary(Unary::Negate, a) => format!("-{}", of(a)),
        Node::Unary(function, a) => format!("T::{}({})", unary(function), of(a)),
        Node::Binary(Binary::Add, a, b) => format!("{} + {}", of(a), of(b)),
        Node::Binary(Binary::Subtract, a, b) => format!("{} - {}", of(a), of(b)),
        Node::Binary(Binary::Multiply, a, b) => format!("{} * {}", of(a), of(b)),
        Node::Binary(Binary::Divide, a, b) => format!("{} / {}", of(a), of(b)),
        Node::Binary(function, a, b) => format!("T::{}({}, {})", binary(function), of(a), of(b)),
        Node::Select { less, than, yes, no } => {
            format!("T::select(T::less({}, {}), {}, {})", of(less), of(than), of(yes), of(no))
        }
    }
}

fn unary(function: Unary) -> &'static str {
    match function {
        Unary::Negate => "neg",
        Unary::Sqrt => "sqrt",
        Unary::Exp => "exp",
        Unary::Ln => "ln",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tan => "tan",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
        Unary::Sinh => "sinh",
        Unary::Cosh => "cosh",
        Unary::Tanh => "tanh",
        Unary::Abs => "abs",
        Unary::Sign => "sign",
    }
}

fn binary(function: Binary) -> &'static str {
    match function {
        Binary::Add => "add",
        Binary::Subtract => "sub",
        Binary::Multiply => "mul",
        Binary::Divide => "div",
        Binary::Power => "powf",
        Binary::Atan2 => "atan2",
        Binary::Min => "min",
        Binary::Max => "max",
        Binary::Hypot => "hypot",
    }
}

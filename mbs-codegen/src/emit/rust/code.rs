//! Function bodies: printed as text, parsed into tokens once.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use quote::quote;

use crate::emit::rust::scope::{Scope, local};
use crate::program::{Angle, Assignment, FunctionDerivatives, Section};
use crate::symbolic::{Node, NodeId, Unary};

/// Placeholder of the runtime's path in the printed text.
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
            TokenTree::Ident(name) if name == RUNTIME && !is_field(&replaced) => {
                replaced.extend(runtime.clone());
            }
            TokenTree::Group(group) => {
                let inner = with_runtime(group.stream(), runtime);
                replaced.push(TokenTree::Group(Group::new(group.delimiter(), inner)));
            }
            other => replaced.push(other),
        }
    }
    replaced.into_iter().collect()
}

/// `true` if a name that follows these tokens is that of a field: it follows a single dot.
fn is_field(before: &[TokenTree]) -> bool {
    let is_dot = |back: usize| {
        let tree = before.len().checked_sub(back).and_then(|index| before.get(index));
        matches!(tree, Some(TokenTree::Punct(mark)) if mark.as_char() == '.')
    };
    is_dot(1) && !is_dot(2)
}

/// Call of the kernel for sine and cosine.
pub const SINE_COSINE: &str = "T::sin_cos(";

/// Prints one `let` per line of the section; a long section is cut into closures that pass on the values used after them.
pub fn lets(section: &Section, scope: &Scope<'_>, text: &mut String) {
    lets_for(section, &section.results, scope, text);
}

/// [`lets`], where other values than the section's results are used after it.
pub fn lets_for(section: &Section, results: &BTreeSet<NodeId>, scope: &Scope<'_>, text: &mut String) {
    if section.lines.len() <= scope.lengths.body {
        return section.lines.iter().for_each(|line| print(line, scope, text));
    }
    let (chunks, exports) = chunks(section, results, scope);
    if section.lines.len() > scope.lengths.function {
        return apart(&chunks, &exports, results, &BTreeMap::new(), scope, text);
    }
    for (chunk, exports) in chunks.into_iter().zip(exports) {
        let names = exports.iter().map(|id| local(*id)).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "let [{names}] = (|| -> [T; {}] {{", exports.len());
        chunk.iter().for_each(|line| print(line, scope, text));
        let _ = writeln!(text, "[{names}]\n}})();");
    }
}

/// Lines in chunks of bounded length, and of each the values that later chunks, or the results, use.
fn chunks<'a>(
    section: &'a Section,
    results: &BTreeSet<NodeId>,
    scope: &Scope<'_>,
) -> (Vec<&'a [Assignment]>, Vec<Vec<NodeId>>) {
    let chunks: Vec<&[Assignment]> = section.lines.chunks(scope.lengths.body).collect();
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
        exports.push(chunk.iter().flat_map(Assignment::values).filter(is_used).collect());
        chunk.iter().for_each(|line| mark(&line.operands(scope.graph), &mut used));
    }
    exports.reverse();
    (chunks, exports)
}

/// Prints chunks that stay functions of their own. The values that they pass on are taken from arrays where they are used,
/// `kept` values from `__kept`.
fn apart(
    chunks: &[&[Assignment]],
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
        let _ = writeln!(
            text,
            "let __part{number} = __mbs::__private::chunks::apart(|| -> [T; {}] {{",
            passed.len()
        );
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

/// Binds values from the arrays of parts, as far as these hold them.
fn taken(ids: &BTreeSet<NodeId>, places: &BTreeMap<NodeId, String>, text: &mut String) {
    bind(ids.iter().filter_map(|id| Some((local(*id), places.get(id)?.clone()))), text);
}

/// Locals of the scalar type, all in one `let`: each further `let` nests the debug information of the others.
pub fn bind(locals: impl Iterator<Item = (String, String)>, text: &mut String) {
    let (names, values): (Vec<String>, Vec<String>) = locals.unzip();
    if !names.is_empty() {
        let _ = writeln!(text, "let [{}] = [{}];", names.join(", "), values.join(", "));
    }
}

/// Spelling of the values that a line uses and computes, in the order of its text.
pub trait Naming {
    /// A value that it uses.
    fn operand(&mut self, id: NodeId) -> String;
    /// A value that it computes.
    fn defined(&mut self, id: NodeId) -> String;
    /// A place in an array of functions, where lines that differ in it are one.
    fn place(&mut self, _: usize) -> Option<String> {
        None
    }
}

/// Every value by its own name.
struct Named<'a>(&'a Scope<'a>);

impl Naming for Named<'_> {
    fn operand(&mut self, id: NodeId) -> String {
        self.0.operand(id)
    }

    fn defined(&mut self, id: NodeId) -> String {
        local(id)
    }
}

/// Prints a line.
pub fn print(line: &Assignment, scope: &Scope<'_>, text: &mut String) {
    let mut names = Named(scope);
    match line {
        Assignment::Value(id) => value(*id, scope, &mut names, text),
        Assignment::SineCosine(angles) => sine_cosine(angles, &mut names, text),
        Assignment::Jet(called) => jet(called, scope, &mut names, text),
    }
}

/// Prints one operation.
pub fn value(id: NodeId, scope: &Scope<'_>, names: &mut impl Naming, text: &mut String) {
    let name = names.defined(id);
    let value = operation(scope.graph.node(id), scope, names);
    let _ = writeln!(text, "let {name} = {value};");
}

/// Prints sines and cosines of several angles.
pub fn sine_cosine(angles: &[Angle], names: &mut impl Naming, text: &mut String) {
    let mut defined = |id: Option<NodeId>| id.map_or_else(|| "_".to_owned(), |id| names.defined(id));
    let sines = of_angles(angles, |angle| defined(angle.sine));
    let cosines = of_angles(angles, |angle| defined(angle.cosine));
    let operands = of_angles(angles, |known| names.operand(known.angle));
    let _ = writeln!(text, "let ([{sines}], [{cosines}]) = {SINE_COSINE}[{operands}]);");
}

/// Prints a call of a declared function.
pub fn jet(jet: &FunctionDerivatives, scope: &Scope<'_>, names: &mut impl Naming, text: &mut String) {
    let FunctionDerivatives { function, argument, orders } = jet;
    let defined = orders.iter().map(|id| id.map_or_else(|| "_".to_owned(), |id| names.defined(id)));
    let (defined, count) = (defined.collect::<Vec<_>>().join(", "), orders.len());
    let (kind, field, index) = scope.function(*function as usize);
    let place = index.and_then(|index| names.place(index));
    let argument = names.operand(*argument);
    let _ = match place {
        Some(place) => writeln!(
            text,
            "let [{defined}] = __mbs::__private::chunks::jet::<T, {kind}, {count}>(&{field}, {place}, {argument});"
        ),
        None => {
            let element = index.map_or_else(String::new, |index| format!("[{index}]"));
            writeln!(
                text,
                "let [{defined}] = <{kind} as __mbs::Function<T>>::jet::<{count}>(&{field}{element}, {argument});"
            )
        }
    };
}

fn of_angles(angles: &[Angle], part: impl FnMut(&Angle) -> String) -> String {
    angles.iter().map(part).collect::<Vec<_>>().join(", ")
}

/// Straight-line code, then its value, in braces.
pub fn body(section: &Section, scope: &Scope<'_>, result: &str, runtime: &TokenStream) -> TokenStream {
    let mut text = String::new();
    lets(section, scope, &mut text);
    text += result;
    block(&text, runtime)
}

/// `[a, b, …]`
pub fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// `[a, 0, b, …]`
pub fn array(nodes: impl Iterator<Item = Option<NodeId>>, scope: &Scope<'_>) -> String {
    format!("[{}]", nodes.map(|id| scope.or_zero(id)).collect::<Vec<_>>().join(", "))
}

/// Rows of as many entries as there are coordinates. Zeros are not written one by one: a chain of 200 loops has
/// 160 000 of them.
pub fn matrix<'a>(
    rows: impl ExactSizeIterator<Item = &'a Vec<(usize, NodeId)>>,
    scope: &Scope<'_>,
) -> String {
    let (length, columns) = (rows.len(), scope.model.coordinates.len());
    let zero = scope.or_zero(None);
    let zeros = format!("[[{zero}; {columns}]; {length}]");
    let mut text = String::new();
    for (row, entries) in rows.enumerate() {
        for (column, entry) in entries {
            let _ = writeln!(text, "__rows[{row}][{column}] = {};", scope.operand(*entry));
        }
    }
    if text.is_empty() { zeros } else { format!("let mut __rows = {zeros};\n{text}__rows") }
}

fn operation(node: Node, scope: &Scope<'_>, names: &mut impl Naming) -> String {
    let mut of = |id: NodeId| names.operand(id);
    match node {
        // Calls are printed with jets.
        Node::Constant(_) | Node::Leaf(_) | Node::Call { .. } => scope.leaf(node),
        Node::Unary(Unary::Negate, a) => format!("-{}", of(a)),
        Node::Unary(function, a) => format!("T::{}({})", function.entry().name, of(a)),
        Node::Binary(function, a, b) => {
            let (a, b) = (of(a), of(b));
            function.entry().rust.of("T::", &a, &b)
        }
        Node::Select { less, than, yes, no } => {
            format!("T::select(T::less({}, {}), {}, {})", of(less), of(than), of(yes), of(no))
        }
    }
}

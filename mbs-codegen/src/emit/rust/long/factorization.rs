//! The factorization of a long mechanism's diagonal blocks: those of a kind one after the other, as rounds of loops.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::emit::rust::code::list;
use crate::emit::rust::long;
use crate::emit::rust::long::parts::{ExtraArguments, Parts};
use crate::emit::rust::long::statement::{Open, Operand, Statement};
use crate::emit::rust::matrix_entries::MatrixEntries;
use crate::program::BlockProgram;
use crate::symbolic::NodeId;

/// Blocks that are factorised in rounds, by the number of their kind.
#[derive(Default)]
pub struct Factorizations(BTreeMap<usize, Blocks>);

/// Blocks of a kind.
struct Blocks {
    /// Type of their factors.
    factors: String,
    statements: Vec<Statement>,
    parts: Parts,
}

/// Code of the factorizations.
pub struct Rounds {
    /// Fields of the factors: an array for each kind.
    pub fields: String,
    /// Their names with the locals that hold their values.
    pub names: String,
    /// Code that makes these locals from the entries of Φ_q and updates `__margin`.
    pub body: String,
    /// Methods that it calls.
    pub methods: String,
}

impl Factorizations {
    /// Adds a block of a kind; its place among the factors.
    pub fn add(
        &mut self,
        kind: usize,
        block: &BlockProgram,
        (factors, entries): (&str, &MatrixEntries<'_>),
    ) -> String {
        let blocks = self.0.entry(kind).or_insert_with(|| Blocks {
            factors: factors.to_owned(),
            statements: Vec::new(),
            parts: Parts::new(BTreeMap::new(), 0, entries.scope.lengths),
        });
        let place = blocks.statements.len();
        let statement = blocks.parts.wordings.statement(|open, text| {
            *text = factorized(block, place, (factors, entries), open);
        });
        blocks.statements.push(statement);
        format!("kind{kind}[{place}]")
    }

    /// Before: all blocks are added. After: their factorization, kind after kind.
    pub fn print(self, entries: &MatrixEntries<'_>) -> Rounds {
        let (model, equations) = (entries.scope.model, entries.equations);
        let mut rounds = Rounds {
            fields: String::new(),
            names: String::new(),
            body: String::new(),
            methods: String::new(),
        };
        if self.0.is_empty() {
            return rounds;
        }
        let (count, whole) = (entries.places.len(), !long::is_in_numbers(equations));
        let (mut declared, mut given) = (format!("__entries: &[T; {count}], "), "&__entries, ".to_owned());
        if whole {
            let (n, m) = (model.coordinates.len(), model.rows.len());
            rounds.body += &long::scales(model);
            declared += &format!("__row_scales: &[T; {m}], __coordinate_scales: &[T; {n}], ");
            given += "&__row_scales, &__coordinate_scales, ";
        }
        rounds.body += "let mut __margin = __margin;\n";
        for (kind, Blocks { factors, statements, mut parts }) in self.0 {
            let (count, group) = (statements.len(), parts.lengths.group);
            let _ = writeln!(rounds.fields, "/// Diagonal blocks.\nkind{kind}: [{factors}; {count}],");
            let _ = write!(rounds.names, "kind{kind}: __kind{kind}, ");
            let frame = ExtraArguments {
                declared: format!(
                    "{declared}__blocks: &mut [{factors}; {count}], __margin: &mut __mbs::Margin<T>, "
                ),
                given: format!("{given}&mut __kind{kind}, &mut __margin, "),
                result: None,
            };
            let calls = parts.sequence(&format!("__factorize{kind}"), &frame, &statements, (group, None));
            let (methods, passed) = parts.print();
            rounds.methods += &methods;
            let _ = writeln!(
                rounds.body,
                "let __v = &__mbs::__private::chunks::Passed::<T, {passed}>::none();\n\
                 let mut __kind{kind}: [{factors}; {count}] = __mbs::__private::chunks::unfactorized();\n{calls}"
            );
        }
        rounds
    }
}

/// The factors of a block, put in their `place`, and the update of the margin.
fn factorized(
    block: &BlockProgram,
    place: usize,
    (factors, entries): (&str, &MatrixEntries<'_>),
    open: &mut Open,
) -> String {
    let equations = entries.equations;
    let mut entry = |row: usize, column: usize| match entries.places.get(&(row, column)) {
        Some(index) => open.push(Operand::Element { array: "__entries".into(), index: *index }),
        None => entries.scope.or_zero(None),
    };
    let columns = block.coordinates.as_slice();
    let rows: Vec<String> =
        block.rows.iter().map(|row| list(columns.iter().map(|column| entry(*row, *column)))).collect();
    let mut scale = |array: &str, scales: &[NodeId], index: usize| {
        let number = scales.get(index).and_then(|scale| equations.graph.constant_value(*scale));
        open.push(match number {
            Some(number) => Operand::Number(number),
            None => Operand::Element { array: array.into(), index },
        })
    };
    let row_scales = list(block.rows.iter().map(|row| scale("__row_scales", &equations.row_scales, *row)));
    let coordinate_scales = list(
        columns.iter().map(|column| scale("__coordinate_scales", &equations.coordinate_scales, *column)),
    );
    let first = |all: &[usize]| Operand::Place(all.first().copied().unwrap_or(0));
    let (row, coordinate) = (open.push(first(&block.rows)), open.push(first(columns)));
    let (kind, size) =
        (format!("<{factors} as __mbs::Factorization<T, {}>>", block.rows.len()), list(rows.into_iter()));
    let place = open.push(Operand::Place(place));
    format!(
        "let (__factors, __value) = {kind}::factorize(&{size}, &{row_scales}, &{coordinate_scales});\n\
         __margin.take(__value, [{row}, {coordinate}], {kind}::reverses(&__factors));\n\
         __mbs::__private::chunks::put(__blocks, {place}, __factors);\n"
    )
}

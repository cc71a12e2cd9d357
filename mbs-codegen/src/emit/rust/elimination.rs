//! The elimination of a block in its order as straight-line code: a type of factors for each pattern.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::emit::rust::blocks::list;
use crate::emit::rust::scope::number;
use crate::equations::Equations;
use crate::program::{BlockProgram, Method, Operations, Program};
use crate::structure::pivots::{Order, Pivot};
use crate::symbolic::NodeId;

/// Types of factors, and the type of each block.
pub struct Eliminations {
    /// Declarations, one a pattern.
    pub types: String,
    /// Number of the type of each block that has one, by the index of the block in the program.
    of_block: BTreeMap<usize, usize>,
}

impl Eliminations {
    /// Before: blocks with their orders. After: a type for each pattern that occurs.
    pub fn of(equations: &Equations, program: &Program) -> Self {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let mut of_block = BTreeMap::new();
        let mut types = String::new();
        for (index, block) in program.blocks.iter().enumerate() {
            let Some(elimination) = elimination(equations, block) else { continue };
            let next = numbers.len();
            let number = *numbers.entry(elimination.text.clone()).or_insert(next);
            if number == next {
                types += &elimination.text.replace(NAME, &name(number));
            }
            of_block.insert(index, number);
        }
        Eliminations { types, of_block }
    }

    /// Type of the factors of a diagonal block.
    pub fn factorization(&self, index: usize, size: usize) -> String {
        match self.of_block.get(&index) {
            Some(number) => format!("__mbs::Guarded<{}<T>, T, {size}>", name(*number)),
            None => factorization(size),
        }
    }
}

/// Type of the factors of a diagonal block without an order of its own.
pub fn factorization(size: usize) -> String {
    match size {
        1..=3 => format!("__mbs::Direct{size}<T>"),
        _ => format!("__mbs::Lu<T, {size}>"),
    }
}

/// Exclusive or of the sign so far and that of another pivot.
const TURN: &str = "__reverses = (__reverses | __turn) & !(__reverses & __turn);";

/// Placeholder of the type's name in its text, so that equal patterns have equal texts.
const NAME: &str = "__Order";

fn name(number: usize) -> String {
    format!("{NAME}{number}")
}

/// Operations of an order's code, without the closed form at its end.
#[derive(Default)]
pub struct Cost {
    /// The elimination.
    pub elimination: Operations,
    /// Comparisons of the elimination.
    pub comparisons: usize,
    /// A solution with its factors.
    pub substitution: Operations,
    /// Unknowns of the closed form.
    pub last: usize,
}

/// Costs of a block's order; none where it has none.
pub fn cost(equations: &Equations, block: &BlockProgram) -> Cost {
    elimination(equations, block).map_or_else(Default::default, |elimination| elimination.cost)
}

/// A type of factors, and what its functions cost.
struct Elimination {
    text: String,
    cost: Cost,
}

fn elimination(equations: &Equations, block: &BlockProgram) -> Option<Elimination> {
    let Method::Newton(system) = &block.method else { return None };
    let order = system.order.as_ref()?;
    let scales = Scales::of(equations, block);
    let graph = &equations.graph;
    let entry = |row: usize, (column, id): (usize, &Option<NodeId>)| {
        id.map(|id| match graph.constant_value(id) {
            Some(value) => Value::Number(value),
            None => Value::Local(format!("__a[{row}][{column}]")),
        })
    };
    let entries = system.phi_q.iter().enumerate();
    let entries =
        entries.map(|(row, line)| line.iter().enumerate().map(|entry_of| entry(row, entry_of)).collect());
    Some(Printer { entries: entries.collect(), scales, ..Printer::default() }.print(order))
}

/// Scale of each row and column, by its index in the block: equal scales share the first index.
#[derive(Default)]
struct Scales {
    rows: Vec<usize>,
    /// `None` for 1.
    columns: Vec<Option<usize>>,
}

impl Scales {
    fn of(equations: &Equations, block: &BlockProgram) -> Self {
        let of = |scales: &[NodeId], indices: &[usize]| -> Vec<Option<NodeId>> {
            indices.iter().map(|index| scales.get(*index).copied()).collect()
        };
        let first = |all: &[Option<NodeId>], index: usize| {
            all.iter().position(|scale| all.get(index) == Some(scale)).unwrap_or(index)
        };
        let is_one =
            |scale: &Option<NodeId>| scale.and_then(|id| equations.graph.constant_value(id)) == Some(1.0);
        let rows = of(&equations.row_scales, &block.rows);
        let columns = of(&equations.coordinate_scales, &block.coordinates);
        let column = |(index, scale)| (!is_one(scale)).then(|| first(&columns, index));
        Scales {
            columns: columns.iter().enumerate().map(column).collect(),
            rows: (0..rows.len()).map(|index| first(&rows, index)).collect(),
        }
    }

    fn row(&self, row: usize) -> usize {
        self.rows.get(row).copied().unwrap_or(row)
    }
}

/// A number of the text, or a name with its value.
#[derive(Clone, PartialEq)]
enum Value {
    Number(f64),
    Local(String),
}

impl Value {
    fn text(&self) -> String {
        match self {
            Value::Number(value) => number(*value),
            Value::Local(name) => name.clone(),
        }
    }

    /// `true` if it is negative as it is written, and the text of the rest; no text for 1.
    fn parts(&self) -> (bool, Option<String>) {
        match self {
            Value::Number(value) => (*value < 0.0, (value.abs() != 1.0).then(|| number(value.abs()))),
            Value::Local(name) => match name.strip_prefix('-') {
                Some(name) => (true, Some(name.to_owned())),
                None => (false, Some(name.clone())),
            },
        }
    }
}

/// Zero where there is none.
type Entry = Option<Value>;

/// A pivot with what was eliminated by it.
struct Eliminated {
    pivot: Pivot,
    /// Row by row; empty for the last pivot.
    inverse: Vec<Vec<Entry>>,
    /// Rows below, and the multipliers of the pivot's rows that are subtracted from each.
    multipliers: Vec<(usize, Vec<Entry>)>,
    /// Columns outside the pivot, and the pivot's rows there.
    upper: Vec<(usize, Vec<Entry>)>,
}

/// Code of a type, printed so far.
#[derive(Default)]
struct Printer {
    entries: Vec<Vec<Entry>>,
    scales: Scales,
    text: String,
    locals: usize,
    operations: Operations,
    comparisons: usize,
    /// Sizes that are printed already.
    sizes: BTreeSet<String>,
    /// `true` if the pivots that are numbers turn the determinant's sign.
    odd: bool,
    /// Names that the factors keep, in the order of their array.
    kept: Vec<String>,
}

impl Printer {
    fn print(mut self, order: &Order) -> Elimination {
        let size = self.entries.len();
        let (mut done, mut last) = (Vec::new(), None);
        self.text = "let __one = T::constant(1.0);\n\
                     let __limit = T::constant(__mbs::__private::LARGEST_MULTIPLIER);\n\
                     let mut __bounded = T::mask(true);\n\
                     let mut __reverses = T::mask(false);\n\
                     let mut __least = T::constant(::core::primitive::f64::MAX);\n"
            .into();
        self.scales_of_rows();
        let places = (0..size).flat_map(|row| (0..size).map(move |column| (row, column)));
        let largest = self.largest(places);
        let _ = writeln!(self.text, "let __largest = {largest};");
        for (index, pivot) in order.pivots.iter().enumerate() {
            if index + 1 == order.pivots.len() {
                last = Some(pivot.clone());
            } else {
                let eliminated = self.eliminate(pivot);
                done.push(eliminated);
            }
        }
        let last = last.unwrap_or(Pivot { rows: Vec::new(), columns: Vec::new() });
        self.last(&last, is_odd(order));
        let elimination = core::mem::take(&mut self.operations);
        let factors = core::mem::take(&mut self.text);
        let solve = self.solve(&done, &last);
        let substitution = core::mem::take(&mut self.operations);
        let transposed = self.transposed(&done, &last);
        let (kept, count) = (list(self.kept.iter().cloned()), self.kept.len());
        let rank = last.rows.len();
        let text = format!(
            "/// Factors of {size} unknowns in the order that their sparsity makes the shortest.\n\
             #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]\n\
             pub struct {NAME}<T: __mbs::Scalar> {{\n\
             /// Inverses of pivots, multipliers, rows beside the pivots.\nvalues: [T; {count}],\n\
             /// What is left at the end.\nlast: __mbs::Direct{rank}<T>,\n\
             /// Where the determinant is negative.\nreverses: T::Mask,\n}}\n\
             impl<T: __mbs::Scalar> __mbs::Elimination<T, {size}> for {NAME}<T> {{\n\
             #[inline]\nfn eliminate(__a: &[[T; {size}]; {size}], __row_scales: &[T; {size}], \
             __coordinate_scales: &[T; {size}]) -> (Self, T, T::Mask) {{\n{factors}\
             ({NAME} {{ values: {kept}, last: __last, reverses: __reverses }}, __margin, __bounded)\n}}\n\
             #[inline]\nfn solve(&self, __b: &[T; {size}]) -> [T; {size}] {{\n{solve}}}\n\
             #[inline]\nfn solve_transposed(&self, __b: &[T; {size}]) -> [T; {size}] {{\n{transposed}}}\n\
             #[inline]\nfn reverses(&self) -> T::Mask {{ self.reverses }}\n}}\n"
        );
        let cost = Cost { elimination, comparisons: self.comparisons, substitution, last: rank };
        Elimination { text, cost }
    }

    /// Reciprocals of the rows' scales, each once.
    fn scales_of_rows(&mut self) {
        let mut firsts = self.scales.rows.clone();
        firsts.sort_unstable();
        firsts.dedup();
        for row in firsts {
            let _ = writeln!(self.text, "let __weight{row} = __one / __row_scales[{row}];");
            self.operations.divisions += 1;
        }
    }

    fn entry(&self, row: usize, column: usize) -> Entry {
        self.entries.get(row).and_then(|row| row.get(column)).cloned().flatten()
    }

    fn set(&mut self, row: usize, column: usize, value: Entry) {
        if let Some(entry) = self.entries.get_mut(row).and_then(|row| row.get_mut(column)) {
            *entry = value;
        }
    }

    /// `start − Σ a b`, as a number where all are, else under a name of its own.
    fn less(&mut self, start: Entry, products: Vec<(Entry, Entry)>) -> Entry {
        let products: Vec<(Value, Value)> = products.into_iter().filter_map(|(a, b)| a.zip(b)).collect();
        if products.is_empty() {
            return start;
        }
        let numbers = products.iter().map(|(a, b)| match (a, b) {
            (Value::Number(a), Value::Number(b)) => Some(a * b),
            _ => None,
        });
        let known = match &start {
            None => Some(0.0),
            Some(Value::Number(value)) => Some(*value),
            Some(Value::Local(_)) => None,
        };
        if let Some(value) = numbers.fold(known, |sum, product| Some(sum? - product?)) {
            return (value != 0.0).then_some(Value::Number(value));
        }
        let mut text = start.map_or(String::new(), |start| start.text());
        for (a, b) in products {
            let (negative, product) = self.product(&a, &b);
            self.operations.additions += usize::from(!text.is_empty() || !negative);
            text += match (negative, text.is_empty()) {
                (true, true) => "",
                (true, false) => " + ",
                (false, true) => "-",
                (false, false) => " - ",
            };
            text += &product;
        }
        Some(self.name(&text))
    }

    /// A product, its sign apart.
    fn product(&mut self, a: &Value, b: &Value) -> (bool, String) {
        let ((a_negative, a), (b_negative, b)) = (a.parts(), b.parts());
        let text = match (a, b) {
            (Some(a), Some(b)) => {
                self.operations.multiplications += 1;
                format!("{a} * {b}")
            }
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => number(1.0),
        };
        (a_negative != b_negative, text)
    }

    /// A name for a value.
    fn name(&mut self, text: &str) -> Value {
        let name = format!("__n{}", self.locals);
        self.locals += 1;
        let _ = writeln!(self.text, "let {name} = {text};");
        Value::Local(name)
    }

    /// Reference to a value that the factors store; numbers are written where they are used.
    fn keep(&mut self, value: Entry) -> Entry {
        match value {
            Some(Value::Local(name)) => {
                let index = self.kept.iter().position(|kept| *kept == name).unwrap_or(self.kept.len());
                if index == self.kept.len() {
                    self.kept.push(name);
                }
                Some(Value::Local(format!("self.values[{index}]")))
            }
            number => number,
        }
    }

    fn eliminate(&mut self, pivot: &Pivot) -> Eliminated {
        let (inverse, determinant) = match (pivot.rows.as_slice(), pivot.columns.as_slice()) {
            (&[first, second], &[left, right]) => self.inverse([first, second], [left, right]),
            (&[row], &[column]) => (vec![vec![self.reciprocal(row, column)]], self.entry(row, column)),
            _ => (Vec::new(), None),
        };
        let size = self.entries.len();
        let (mut growth, block) = (String::new(), self.block(pivot));
        let rows: Vec<usize> = (0..size).filter(|row| !pivot.rows.contains(row)).collect();
        let columns: Vec<usize> = (0..size).filter(|column| !pivot.columns.contains(column)).collect();
        let above = |printer: &Self, column: usize| -> Vec<Entry> {
            pivot.rows.iter().map(|row| printer.entry(*row, column)).collect()
        };
        let upper: Vec<(usize, Vec<Entry>)> =
            columns.iter().map(|column| (*column, above(self, *column))).collect();
        let upper: Vec<(usize, Vec<Entry>)> =
            upper.into_iter().filter(|(_, entries)| entries.iter().any(Option::is_some)).collect();
        let mut multipliers = Vec::new();
        for row in rows {
            let below: Vec<Entry> = pivot.columns.iter().map(|column| self.entry(row, *column)).collect();
            if below.iter().all(Option::is_none) {
                continue;
            }
            let factors: Vec<Entry> =
                (0..pivot.rows.len()).map(|k| self.multiplier(&below, &inverse, k)).collect();
            for (factor, of) in factors.iter().zip(&pivot.rows) {
                self.bound(factor, row, *of, &mut growth);
            }
            for (column, entries) in &upper {
                let start = self.entry(row, *column);
                let products = factors.iter().cloned().zip(entries.iter().cloned()).collect();
                let value = self.less(start, products);
                self.set(row, *column, value);
            }
            multipliers.push((row, factors));
        }
        self.measure(pivot, determinant, &block, &growth);
        for row in &pivot.rows {
            (0..size).for_each(|column| self.set(*row, column, None));
        }
        for column in &pivot.columns {
            (0..size).for_each(|row| self.set(row, *column, None));
        }
        let mut keep_all = |entries: Vec<Entry>| -> Vec<Entry> {
            entries.into_iter().map(|entry| self.keep(entry)).collect()
        };
        Eliminated {
            inverse: inverse.into_iter().map(&mut keep_all).collect(),
            multipliers: multipliers.into_iter().map(|(row, entries)| (row, keep_all(entries))).collect(),
            upper: upper.into_iter().map(|(column, entries)| (column, keep_all(entries))).collect(),
            pivot: pivot.clone(),
        }
    }

    /// Σ over the pivot's columns of the row's entries times column `k` of the inverse.
    fn multiplier(&mut self, below: &[Entry], inverse: &[Vec<Entry>], k: usize) -> Entry {
        let products =
            below.iter().zip(inverse).map(|(entry, row)| (negated(entry), row.get(k).cloned().flatten()));
        let products: Vec<(Entry, Entry)> = products.collect();
        self.less(None, products)
    }

    /// One over a pivot.
    fn reciprocal(&mut self, row: usize, column: usize) -> Entry {
        let pivot = self.entry(row, column)?;
        self.turn(&pivot);
        match pivot {
            Value::Number(value) => Some(Value::Number(1.0 / value)),
            Value::Local(name) => {
                self.operations.divisions += 1;
                let reciprocal = self.name(&format!("__one / {name}"));
                self.finite(&reciprocal);
                Some(reciprocal)
            }
        }
    }

    /// The inverse of two rows, and their determinant.
    fn inverse(
        &mut self,
        [first, second]: [usize; 2],
        [left, right]: [usize; 2],
    ) -> (Vec<Vec<Entry>>, Entry) {
        let places = [(first, left), (first, right), (second, left), (second, right)];
        let [p, q, r, s] = places.map(|(row, column)| self.entry(row, column));
        let cross = self.less(None, vec![(q.clone(), r.clone())]);
        let determinant = self.less(cross, vec![(negated(&p), s.clone())]).unwrap_or(Value::Number(0.0));
        self.turn(&determinant);
        self.operations.divisions += 1;
        let reciprocal = self.name(&format!("__one / {}", determinant.text()));
        self.finite(&reciprocal);
        let reciprocal = Some(reciprocal);
        let mut entry = |value: Entry, negative: bool| {
            let value = if negative { value } else { negated(&value) };
            self.less(None, vec![(value, reciprocal.clone())])
        };
        let inverse = vec![vec![entry(s, false), entry(q, true)], vec![entry(r, true), entry(p, false)]];
        (inverse, Some(determinant))
    }

    /// Notes that a reciprocal must be finite: a pivot without entries below it has no multiplier that would show it.
    fn finite(&mut self, reciprocal: &Value) {
        let _ = writeln!(self.text, "__bounded = __bounded & T::is_finite({});", reciprocal.text());
        self.comparisons += 1;
    }

    fn absolute(&mut self, entry: &Value) -> String {
        match entry {
            Value::Number(value) => number(value.abs()),
            Value::Local(name) => {
                self.operations.selects += 1;
                format!("T::abs({name})")
            }
        }
    }

    /// A size in the reference metric.
    fn weighted(&mut self, size: String, row: usize, column: usize) -> String {
        self.operations.multiplications += 1;
        let mut text = format!("{size} * __weight{}", self.scales.row(row));
        if let Some(scale) = self.scales.columns.get(column).copied().flatten() {
            let _ = write!(text, " * __coordinate_scales[{scale}]");
            self.operations.multiplications += 1;
        }
        text
    }

    /// The largest of the entries in the reference metric, as text: those of one scale are compared before they are weighted.
    fn largest(&mut self, places: impl Iterator<Item = (usize, usize)>) -> String {
        let mut groups: BTreeMap<(usize, Option<usize>), (usize, usize, String)> = BTreeMap::new();
        for (row, column) in places {
            let Some(entry) = self.entry(row, column) else { continue };
            let scale = (self.scales.row(row), self.scales.columns.get(column).copied().flatten());
            let size = self.absolute(&entry);
            match groups.get_mut(&scale) {
                None => drop(groups.insert(scale, (row, column, size))),
                Some((.., largest)) if *largest == size => {}
                Some((.., largest)) => {
                    *largest = format!("T::max({largest}, {size})");
                    self.operations.selects += 1;
                }
            }
        }
        let mut all = String::new();
        for (row, column, size) in groups.into_values() {
            let size = self.weighted(size, row, column);
            all = match all.is_empty() {
                true => size,
                false => format!("T::max({all}, {size})"),
            };
            self.operations.selects += 1;
        }
        if all.is_empty() { number(0.0) } else { all }
    }

    /// The largest entry of a pivot's columns; empty for a single entry.
    fn block(&mut self, pivot: &Pivot) -> String {
        if pivot.rows.len() < 2 {
            return String::new();
        }
        let size = self.entries.len();
        let places = (0..size).flat_map(|row| pivot.columns.iter().map(move |column| (row, *column)));
        let text = self.largest(places);
        self.name(&text).text()
    }

    /// Prints the update by the size of a pivot, as the best choice of rows for its columns would leave it; for two rows the
    /// determinant over their largest entry.
    fn measure(&mut self, pivot: &Pivot, determinant: Entry, block: &str, growth: &str) {
        let Some(determinant) = determinant else { return };
        let mut size = self.absolute(&determinant);
        for (row, column) in pivot.rows.iter().zip(&pivot.columns) {
            size = self.weighted(size, *row, *column);
        }
        if !block.is_empty() {
            size = format!("{size} / {block}");
            self.operations.divisions += 1;
        }
        if !growth.is_empty() {
            size = format!("{size} * T::max(__one, {growth})");
            self.operations.multiplications += 1;
            self.operations.selects += 1;
        }
        if self.sizes.insert(size.clone()) {
            let _ = writeln!(self.text, "__least = T::min(__least, {size});");
            self.operations.selects += 1;
        }
    }

    /// Prints the update by the sign of a pivot's determinant.
    fn turn(&mut self, determinant: &Value) {
        match determinant {
            Value::Number(value) => self.odd ^= *value < 0.0,
            Value::Local(name) => {
                let _ = writeln!(self.text, "let __turn = T::less({name}, {});\n{TURN}", number(0.0));
                self.comparisons += 1;
            }
        }
    }

    /// Prints the bound on the multiplier of row `of` in `row`; `growth` is the largest of these.
    fn bound(&mut self, multiplier: &Entry, row: usize, of: usize, growth: &mut String) {
        let (from, to) = (self.scales.row(of), self.scales.row(row));
        let mut size = match multiplier {
            None => return,
            Some(Value::Number(value)) if from == to && value.abs() <= 1.0 => return,
            Some(multiplier) => format!("T::abs({})", multiplier.text()),
        };
        if from != to {
            let _ = write!(size, " * __row_scales[{from}] * __weight{to}");
            self.operations.multiplications += 2;
        }
        let size = self.name(&size).text();
        let _ = writeln!(self.text, "__bounded = __bounded & T::less({size}, __limit);");
        self.operations.selects += 1;
        self.comparisons += 1;
        if !growth.is_empty() {
            *growth = format!("T::max({growth}, {size})");
            self.operations.selects += 1;
        } else {
            *growth = size;
        }
    }

    /// Closed form of the rows and columns that are left, and the margin of all.
    fn last(&mut self, last: &Pivot, odd: bool) {
        let rank = last.rows.len();
        let zero = || number(0.0);
        let text = |entry: Entry| entry.map_or_else(zero, |value| value.text());
        let rows = last.rows.iter().map(|row| list(last.columns.iter().map(|c| text(self.entry(*row, *c)))));
        let rows = list(rows);
        let scales = |name: &str, indices: &[usize]| list(indices.iter().map(|i| format!("{name}[{i}]")));
        let (row_scales, coordinate_scales) =
            (scales("__row_scales", &last.rows), scales("__coordinate_scales", &last.columns));
        let places = last.rows.iter().flat_map(|row| last.columns.iter().map(|column| (*row, *column)));
        let left = self.largest(places);
        let odd = if odd != self.odd { "__reverses = !__reverses;\n" } else { "" };
        let _ = write!(
            self.text,
            "let (__last, __own) = <__mbs::Direct{rank}<T> as __mbs::Factorization<T, {rank}>>::factorize(\
             &{rows}, &{row_scales}, &{coordinate_scales});\n\
             let __turn = <__mbs::Direct{rank}<T> as __mbs::Factorization<T, {rank}>>::reverses(&__last);\n\
             {TURN}\n{odd}\
             let __ratio = T::min(__least, {left} * __own) / __largest;\n\
             let __margin = T::select(T::is_finite(__ratio), T::min(__ratio, __one), {});\n",
            zero()
        );
        self.operations += Operations { divisions: 1, multiplications: 1, selects: 3, ..Default::default() };
        self.comparisons += 2;
    }

    /// Forwards through the multipliers, then the unknowns from the last pivot to the first.
    fn solve(&mut self, done: &[Eliminated], last: &Pivot) -> String {
        let size = self.entries.len();
        let given = |index: usize| Some(Value::Local(format!("__b[{index}]")));
        let (mut b, mut x): (Vec<Entry>, Vec<Entry>) = ((0..size).map(given).collect(), vec![None; size]);
        for Eliminated { pivot, multipliers, .. } in done {
            for (row, factors) in multipliers {
                let products = factors.iter().cloned().zip(pivot.rows.iter().map(|of| at(&b, *of))).collect();
                let value = self.less(at(&b, *row), products);
                put(&mut b, *row, value);
            }
        }
        self.solve_last("solve", last.rows.iter().map(|row| at(&b, *row)), &last.columns, &mut x);
        for Eliminated { pivot, inverse, upper, .. } in done.iter().rev() {
            let mut rest = Vec::new();
            for (k, row) in pivot.rows.iter().enumerate() {
                let products =
                    upper.iter().map(|(column, entries)| (at(entries, k), at(&x, *column))).collect();
                rest.push(self.less(at(&b, *row), products));
            }
            for (column, inverse) in pivot.columns.iter().zip(inverse) {
                let products = inverse.iter().map(negated).zip(rest.iter().cloned()).collect();
                let value = self.less(None, products);
                put(&mut x, *column, value);
            }
        }
        self.finish(&x)
    }

    /// The same backwards with all factors transposed.
    fn transposed(&mut self, done: &[Eliminated], last: &Pivot) -> String {
        let size = self.entries.len();
        let given = |index: usize| Some(Value::Local(format!("__b[{index}]")));
        let (mut b, mut x): (Vec<Entry>, Vec<Entry>) = ((0..size).map(given).collect(), vec![None; size]);
        for Eliminated { pivot, inverse, upper, .. } in done {
            for (k, row) in pivot.rows.iter().enumerate() {
                let of =
                    |(column, inverse): (&usize, &Vec<Entry>)| (negated(&at(inverse, k)), at(&b, *column));
                let products = pivot.columns.iter().zip(inverse).map(of).collect();
                let value = self.less(None, products);
                put(&mut x, *row, value);
            }
            for (column, entries) in upper {
                let products =
                    entries.iter().cloned().zip(pivot.rows.iter().map(|row| at(&x, *row))).collect();
                let value = self.less(at(&b, *column), products);
                put(&mut b, *column, value);
            }
        }
        self.solve_last("solve_transposed", last.columns.iter().map(|c| at(&b, *c)), &last.rows, &mut x);
        for Eliminated { pivot, multipliers, .. } in done.iter().rev() {
            for (k, row) in pivot.rows.iter().enumerate() {
                let products =
                    multipliers.iter().map(|(below, factors)| (at(factors, k), at(&x, *below))).collect();
                let value = self.less(at(&x, *row), products);
                put(&mut x, *row, value);
            }
        }
        self.finish(&x)
    }

    fn solve_last(
        &mut self,
        method: &str,
        right: impl Iterator<Item = Entry>,
        places: &[usize],
        x: &mut [Entry],
    ) {
        let rank = places.len();
        let right = list(right.map(|entry| entry.map_or_else(|| number(0.0), |value| value.text())));
        let names: Vec<String> = places.iter().map(|place| format!("__l{place}")).collect();
        let _ = writeln!(
            self.text,
            "let [{}] = <__mbs::Direct{rank}<T> as __mbs::Factorization<T, {rank}>>::{method}(&self.last, &{right});",
            names.join(", ")
        );
        for (place, name) in places.iter().zip(names) {
            put(x, *place, Some(Value::Local(name)));
        }
    }

    fn finish(&mut self, x: &[Entry]) -> String {
        let values = x.iter().map(|entry| entry.as_ref().map_or_else(|| number(0.0), Value::text));
        let values = list(values);
        core::mem::take(&mut self.text) + &values + "\n"
    }
}

fn at(entries: &[Entry], index: usize) -> Entry {
    entries.get(index).cloned().flatten()
}

fn put(entries: &mut [Entry], index: usize, value: Entry) {
    if let Some(entry) = entries.get_mut(index) {
        *entry = value;
    }
}

/// The value with the other sign.
fn negated(entry: &Entry) -> Entry {
    entry.as_ref().map(|value| match value {
        Value::Number(value) => Value::Number(-value),
        Value::Local(name) => match name.strip_prefix('-') {
            Some(name) => Value::Local(name.to_owned()),
            None => Value::Local(format!("-{name}")),
        },
    })
}

/// `true` if the order of rows and that of columns differ by an odd permutation.
fn is_odd(order: &Order) -> bool {
    let odd = |indices: Vec<usize>| {
        let pairs = indices
            .iter()
            .enumerate()
            .flat_map(|(place, index)| indices.iter().skip(place + 1).filter(move |later| *later < index));
        pairs.count() % 2 == 1
    };
    let rows = order.pivots.iter().flat_map(|pivot| pivot.rows.clone()).collect();
    let columns = order.pivots.iter().flat_map(|pivot| pivot.columns.clone()).collect();
    odd(rows) != odd(columns)
}

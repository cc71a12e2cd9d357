//! Code of a type of factors.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::pivots::Eliminated;
use super::scales::Scales;
use super::value::{Entry, Value, negated};
use super::{Cost, Elimination, NAME};
use crate::emit::rust::code::list;
use crate::emit::rust::scope::number;
use crate::program::Operations;
use crate::structure::pivots::{Order, Pivot};

/// Largest block whose solution for a step of Newton's method has code of its own, in line with the iteration.
const LARGEST_IN_LINE: usize = 8;

/// Code of a type, printed so far.
#[derive(Clone, Default)]
pub(super) struct Printer {
    pub(super) entries: Vec<Vec<Entry>>,
    /// The block's own.
    pub(super) own: Vec<Vec<Entry>>,
    pub(super) scales: Scales,
    pub(super) text: String,
    pub(super) locals: usize,
    pub(super) operations: Operations,
    pub(super) comparisons: usize,
    /// Sizes that are printed already.
    pub(super) sizes: BTreeSet<String>,
    /// `true` if the pivots that are numbers turn the determinant's sign.
    pub(super) odd: bool,
    /// Names that the factors keep, in the order of their array.
    pub(super) kept: Vec<String>,
    /// Rows that are not eliminated yet.
    pub(super) rest: Vec<usize>,
    /// Reciprocals of squares of lengths that are asked at the end to be finite: these are positive, so their sum tells.
    pub(super) reciprocals: Vec<String>,
    /// `true` for one solution without factors and margin.
    pub(super) once: bool,
}

impl Printer {
    pub(super) fn print(mut self, order: &Order) -> Elimination {
        let size = self.entries.len();
        self.rest = (0..size).collect();
        self.own = self.entries.clone();
        let once = (size <= LARGEST_IN_LINE).then(|| self.clone().solve_once(order));
        self.text = "let __one = T::constant(1.0);\n\
                     let __limit = T::constant(__mbs::__private::LARGEST_MULTIPLIER);\n\
                     let mut __bounded = T::mask(true);\n\
                     let mut __reverses = T::mask(false);\n\
                     let mut __least = T::constant(::core::primitive::f64::MAX);\n"
            .into();
        self.scales_of_rows();
        // Lengths stand for their entries. They are known later.
        let late = order.pivots.iter().any(|pivot| pivot.across.is_some());
        if !late {
            self.largest_of_all();
        }
        let (done, last, factor) = self.eliminate_all(order);
        if late {
            self.largest_of_all();
        }
        self.last(&last, is_odd(order), &factor);
        let elimination = core::mem::take(&mut self.operations);
        let factors = core::mem::take(&mut self.text);
        let solve = self.solve(&done, &last);
        let substitution = core::mem::take(&mut self.operations);
        let transposed = self.transposed(&done, &last);
        let (kept, count) = (list(self.kept.iter().cloned()), self.kept.len());
        let rank = last.rows.len();
        let once = once.unwrap_or_default();
        let text = format!(
            "/// Factors of {size} unknowns in the order that their sparsity makes the shortest.\n\
             #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]\n\
             pub struct {NAME}<T: __mbs::Scalar> {{\n\
             /// Inverses of pivots, multipliers, rows beside the pivots.\nvalues: [T; {count}],\n\
             /// Factors of the rows that are left at the end.\nlast: __mbs::Direct{rank}<T>,\n\
             /// Lanes with a negative determinant.\nreverses: T::Mask,\n}}\n\
             impl<T: __mbs::Scalar> __mbs::Elimination<T, {size}> for {NAME}<T> {{\n\
             #[inline(always)]\nfn eliminate(__a: &[[T; {size}]; {size}], __row_scales: &[T; {size}], \
             __coordinate_scales: &[T; {size}]) -> (Self, T, T::Mask) {{\n{factors}\
             ({NAME} {{ values: {kept}, last: __last, reverses: __reverses }}, __margin, __bounded)\n}}\n\
             {once}#[inline(always)]\nfn solve(&self, __b: &[T; {size}]) -> [T; {size}] {{\n{solve}}}\n\
             #[inline]\nfn solve_transposed(&self, __b: &[T; {size}]) -> [T; {size}] {{\n{transposed}}}\n\
             #[inline]\nfn reverses(&self) -> T::Mask {{ self.reverses }}\n}}\n"
        );
        let cost = Cost { elimination, comparisons: self.comparisons, substitution, last: rank };
        Elimination { text, cost }
    }

    /// Eliminates all pivots but the last, which is returned with the factor of its rows.
    fn eliminate_all(&mut self, order: &Order) -> (Vec<Eliminated>, Pivot, Entry) {
        let Some((last, pivots)) = order.pivots.split_last() else {
            return (Vec::new(), Pivot { rows: Vec::new(), columns: Vec::new(), across: None }, None);
        };
        let (mut done, mut factor) = (Vec::new(), None);
        for (index, pivot) in pivots.iter().enumerate() {
            let (eliminated, own) = self.eliminate(pivot, index + 1 == pivots.len());
            factor = own;
            done.push(eliminated);
        }
        if !self.reciprocals.is_empty() {
            let sum = core::mem::take(&mut self.reciprocals).join(" + ");
            self.finite(&Value::Local(sum));
        }
        (done, last.clone(), factor)
    }

    /// The function that solves once, without margin and factors.
    fn solve_once(mut self, order: &Order) -> String {
        let size = self.entries.len();
        self.once = true;
        self.text = "let __one = T::constant(1.0);\n\
                     let __limit = T::constant(__mbs::__private::LARGEST_MULTIPLIER);\n\
                     let mut __bounded = T::mask(true);\n"
            .into();
        self.scales_of_rows();
        let (done, last, _) = self.eliminate_all(order);
        let x = self.solve(&done, &last);
        let (code, x) = x.trim_end().rsplit_once('\n').unwrap_or(("", &x));
        format!(
            "#[inline(always)]\nfn solve_once(__a: &[[T; {size}]; {size}], __b: &[T; {size}], \
             __row_scales: &[T; {size}], __coordinate_scales: &[T; {size}]) -> ([T; {size}], T::Mask) {{\n\
             {code}\n({x}, __bounded)\n}}\n"
        )
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

    /// Text of a row's scale.
    pub(super) fn scale_of(&self, row: usize) -> String {
        match self.scales.components.get(&row) {
            Some(component) => component.scale.clone(),
            None => format!("__row_scales[{row}]"),
        }
    }

    /// Text of one over a row's scale.
    pub(super) fn weight_of(&self, row: usize) -> String {
        match self.scales.components.get(&row) {
            Some(component) => component.weight.clone(),
            None => format!("__weight{}", self.scales.group(row)),
        }
    }

    pub(super) fn entry(&self, row: usize, column: usize) -> Entry {
        self.entries.get(row).and_then(|row| row.get(column)).cloned().flatten()
    }

    /// `true` where no pivot has changed an entry of the block.
    pub(super) fn is_own(&self, (row, column): (usize, usize)) -> bool {
        self.own.get(row).and_then(|row| row.get(column)).is_some_and(|own| *own == self.entry(row, column))
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: Entry) {
        if let Some(entry) = self.entries.get_mut(row).and_then(|row| row.get_mut(column)) {
            *entry = value;
        }
    }

    /// `entry` times `factor`; as it is without one.
    pub(super) fn times(&mut self, entry: Entry, factor: &Entry) -> Entry {
        let (Some(value), Some(factor)) = (&entry, factor) else { return entry };
        if let (Value::Number(a), Value::Number(b)) = (value, factor) {
            return Some(Value::Number(a * b));
        }
        let (negative, product) = self.product(value, factor);
        Some(self.name(&format!("{}{product}", if negative { "-" } else { "" })))
    }

    /// `start − Σ a b`, as a number where all are, else under a name of its own.
    pub(super) fn less(&mut self, start: Entry, products: Vec<(Entry, Entry)>) -> Entry {
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
    pub(super) fn product(&mut self, a: &Value, b: &Value) -> (bool, String) {
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
    pub(super) fn name(&mut self, text: &str) -> Value {
        let name = format!("__n{}", self.locals);
        self.locals += 1;
        let _ = writeln!(self.text, "let {name} = {text};");
        Value::Local(name)
    }

    /// Reference to a value that the factors store; numbers are written where they are used.
    pub(super) fn keep(&mut self, value: Entry) -> Entry {
        match value {
            value if self.once => value,
            Some(Value::Local(name)) if name.starts_with('-') => {
                negated(&self.keep(negated(&Some(Value::Local(name)))))
            }
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

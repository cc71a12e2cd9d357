//! Forces by contact: the block of an open contact is skipped, known as open before or by its gap in the block.

use std::collections::BTreeSet;
use std::fmt::Write;

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::rust::code::{array, block, lets, print};
use crate::emit::rust::scope::{Scope, number};
use crate::equations::{ByContact, Gap, Pressing, Push, Sparse};
use crate::program::{Assignment, ContactProgram, PushProgram, Section};
use crate::symbolic::NodeId;

/// Field of the parameter stage with the contacts that are evaluated.
const CLOSED: &str = "__p.1";

/// Lines of a contact's block from which on a test skips them where the gap turns out to be open.
const LEAST_SKIPPED: usize = 16;

/// Lines of a contact's section.
struct Parted<'a> {
    /// Name of the gap.
    gap: String,
    /// Lines up to it.
    before: Vec<&'a Assignment>,
    /// The others.
    after: Vec<&'a Assignment>,
}

/// Forces of a text with contacts.
pub struct Blocks<'a> {
    pub by_contact: &'a ByContact,
    /// Gaps of all contacts.
    pub gaps: &'a [Gap],
    pub program: &'a ContactProgram,
    pub scope: &'a Scope<'a>,
    pub runtime: &'a TokenStream,
}

impl Blocks<'_> {
    /// Q
    pub fn force(&self) -> TokenStream {
        let first = array(self.by_contact.open.force.iter().copied(), self.scope);
        self.function(
            |program| &program.force,
            first,
            |contact| added("__sum", contact.push.force.iter().copied().enumerate(), self.scope),
        )
    }

    /// ∂Q/∂q or ∂Q/∂q̇.
    pub fn slopes(&self, by_velocity: bool) -> TokenStream {
        let entries = |push: &Push| -> Sparse {
            if by_velocity { push.force_qd.clone() } else { push.force_q.clone() }
        };
        let open = entries(&self.by_contact.open);
        let n = open.len();
        let mut first = format!("[[{}; {n}]; {n}]", self.scope.or_zero(None));
        for (row, entries) in open.iter().enumerate() {
            for (column, entry) in entries {
                let _ = write!(first, ";\n__sum[{row}][{column}] = {}", self.scope.operand(*entry));
            }
        }
        let section: fn(&PushProgram) -> &Section =
            if by_velocity { |program| &program.force_qd } else { |program| &program.force_q };
        self.function(section, first, |contact| {
            let rows = entries(&contact.push);
            rows.iter().enumerate().fold(String::new(), |text, (row, entries)| {
                let entries = entries.iter().map(|(column, entry)| (*column, Some(*entry)));
                text + &added(&format!("__sum[{row}]"), entries, self.scope)
            })
        })
    }

    /// Powers of the forces.
    pub fn powers(&self, powers: &[Option<NodeId>]) -> TokenStream {
        let contacts = &self.by_contact.contacts;
        let is_contact = |index: usize| contacts.iter().any(|contact| contact.named == index);
        let others = powers.iter().enumerate().map(|(index, power)| power.filter(|_| !is_contact(index)));
        self.function(
            |program| &program.powers,
            array(others, self.scope),
            |contact| match contact.power {
                Some(power) => format!("__sum[{}] = {};\n", contact.named, self.scope.operand(power)),
                None => String::new(),
            },
        )
    }

    /// Forces with all contacts open, then a block a contact.
    fn function(
        &self,
        section: fn(&PushProgram) -> &Section,
        first: String,
        add: impl Fn(&Pressing) -> String,
    ) -> TokenStream {
        let (mut gaps, mut forces) = (String::new(), String::new());
        for (contact, program) in self.by_contact.contacts.iter().zip(&self.program.contacts) {
            let added = add(contact);
            if added.is_empty() {
                continue;
            }
            let gap = self.gaps.get(contact.contact).map(|gap| gap.gap);
            let section = section(program);
            match gap.and_then(|gap| self.up_to(gap, section)) {
                Some(parted) => {
                    let (text, names) = self.gap(contact.contact, &parted, section);
                    gaps += &text;
                    let (zero, gap) = (self.scope.or_zero(None), &parted.gap);
                    let _ = writeln!(
                        forces,
                        "if {CLOSED}[{}] {{\nlet {names};\nif !T::all(T::less({zero}, {gap})) {{",
                        contact.contact
                    );
                    parted.after.iter().for_each(|line| print(line, self.scope, &mut forces));
                    forces += &(added + "}\n");
                }
                None => {
                    let _ = writeln!(forces, "if {CLOSED}[{}] {{", contact.contact);
                    lets(section, self.scope, &mut forces);
                    forces += &added;
                }
            }
            forces += "}\n";
        }
        let mut text = String::new();
        lets(section(&self.program.open), self.scope, &mut text);
        text += &self.shared(section);
        text += &gaps;
        let _ = writeln!(text, "let mut __sum = {first};");
        block(&(text + &forces + "__sum"), self.runtime)
    }

    /// Values that several contacts use: 1 where none of these is evaluated, for then nobody reads them.
    fn shared(&self, section: fn(&PushProgram) -> &Section) -> String {
        let shared = section(&self.program.shared);
        let uses = |program: &PushProgram| {
            let lines = section(program).lines.iter();
            lines.flat_map(|line| line.operands(self.scope.graph)).any(|id| shared.results.contains(&id))
        };
        let contacts = self.by_contact.contacts.iter().zip(&self.program.contacts);
        let users = contacts.filter(|(_, program)| uses(program));
        let users: Vec<String> = users.map(|(contact, _)| format!("{CLOSED}[{}]", contact.contact)).collect();
        if users.is_empty() {
            return String::new();
        }
        let names: Vec<String> = shared.results.iter().map(|id| self.scope.operand(*id)).collect();
        let (count, names) = (names.len(), names.join(", "));
        let mut text = format!("let [{names}] = if {} {{\n", users.join(" || "));
        lets(shared, self.scope, &mut text);
        let _ = writeln!(text, "[{names}]\n}} else {{\n[{}; {count}]\n}};", number(1.0));
        text
    }

    /// The gap of a contact with the values that its force needs of the way there. Those of a contact that is not evaluated are 1: such a
    /// gap is open. All gaps come before all forces: no gap waits for another one, while each is a long chain. Contacts may share values, so
    /// each has an array of its own. Returns that, and the definition of its entries by their names.
    fn gap(
        &self,
        contact: usize,
        Parted { gap, before, after }: &Parted<'_>,
        section: &Section,
    ) -> (String, String) {
        let used = after.iter().flat_map(|line| line.operands(self.scope.graph));
        let used: BTreeSet<NodeId> = used.chain(section.results.iter().copied()).collect();
        let known = before.iter().flat_map(|line| line.values());
        let kept = known.filter(|id| used.contains(id)).map(|id| self.scope.operand(id));
        let names: BTreeSet<String> = kept.chain([gap.clone()]).collect();
        let count = names.len();
        let names = names.into_iter().collect::<Vec<_>>().join(", ");
        let mut text = format!("let __gap{contact} = if {CLOSED}[{contact}] {{\n");
        before.iter().for_each(|line| print(line, self.scope, &mut text));
        let one = number(1.0);
        let _ = writeln!(text, "[{names}]\n}} else {{\n[{one}; {count}]\n}};");
        (text, format!("[{names}] = __gap{contact}"))
    }

    /// The gap of a contact, the lines of its section that the gap needs, and the others. `None` where the section does not compute it, is
    /// cut into parts, or has few other lines.
    fn up_to<'b>(&self, gap: NodeId, section: &'b Section) -> Option<Parted<'b>> {
        let is_short = section.lines.len() <= self.scope.lengths.body;
        let mut needed = BTreeSet::from([gap]);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for line in section.lines.iter().rev() {
            if line.values().iter().any(|value| needed.contains(value)) {
                needed.extend(line.operands(self.scope.graph));
                before.push(line);
            } else {
                after.push(line);
            }
        }
        before.reverse();
        after.reverse();
        let is_worth_it = !before.is_empty() && LEAST_SKIPPED <= after.len();
        (is_short && is_worth_it).then(|| Parted { gap: self.scope.operand(gap), before, after })
    }
}

/// Sums of entries of an array and the terms added to them.
fn added(array: &str, entries: impl Iterator<Item = (usize, Option<NodeId>)>, scope: &Scope<'_>) -> String {
    let mut text = String::new();
    for (index, entry) in entries {
        if let Some(entry) = entry {
            let _ = writeln!(text, "{array}[{index}] = {array}[{index}] + {};", scope.operand(entry));
        }
    }
    text
}

/// Access to the contacts that are evaluated.
pub fn access() -> TokenStream {
    quote! {
        #[inline]
        fn evaluated(__p: &__Parameters<T>) -> &[::core::primitive::bool] {
            &__p.1
        }
        #[inline]
        fn evaluated_mut(__p: &mut __Parameters<T>) -> &mut [::core::primitive::bool] {
            &mut __p.1
        }
    }
}

//! Rounds of loops that declare events and latched values: their arrays are known before any condition is resolved.

use super::counts::MOST_ROUNDS;
use super::declarations::Declarations;
use super::names::Symbol;
use super::resolve::behind_loop;
use super::resolver::LoopFrame;
use super::value::Fault;
use crate::syntax::ast::{Expression, Loop, Operation, Statement, StatementKind};

impl Declarations<'_> {
    /// Before: statements with loops. After: events and latched values in the order of the unrolled text, those in loops once a round.
    ///
    /// A loop whose bounds are at fault gives up the names in it.
    pub(super) fn unrolled<'a>(&mut self, statements: &'a [Statement]) -> Vec<&'a Statement> {
        let is_for = |statement: &Statement| matches!(statement.kind, StatementKind::For(_));
        let is_end = |statement: &Statement| matches!(statement.kind, StatementKind::EndFor);
        let (mut next, mut rounds, mut found) = (0, 0, Vec::new());
        let mut loops: Vec<LoopFrame> = Vec::new();
        while let Some(statement) = statements.get(next) {
            next += 1;
            match &statement.kind {
                StatementKind::For(head) => {
                    let end = behind_loop(statements, next, is_for, is_end);
                    let body = statements.get(next..end).unwrap_or_default();
                    let bounds = match body.iter().any(|statement| statement.kind.is_of_events()) {
                        true => self
                            .bounds(head, statements)
                            .inspect_err(|_| self.give_up(body.iter(), StatementKind::is_of_events)),
                        false => Ok((0, 0)),
                    };
                    match bounds {
                        Ok((low, high)) if low < high => {
                            rounds += 1;
                            let variable = head.variable.clone();
                            let scope = self.names.enter(&variable.text, Symbol::Count(low));
                            loops.push(LoopFrame { begin: next, variable, count: low, high, scope });
                        }
                        _ => next = end,
                    }
                }
                StatementKind::EndFor => {
                    let Some(mut frame) = loops.pop() else { continue };
                    self.names.leave(frame.scope);
                    frame.count += 1;
                    // More rounds are reported where they are resolved.
                    if frame.count < frame.high && rounds < MOST_ROUNDS {
                        rounds += 1;
                        self.names.enter(&frame.variable.text, Symbol::Count(frame.count));
                        next = frame.begin;
                        loops.push(frame);
                    }
                }
                kind if kind.is_of_events() => found.push(statement),
                _ => {}
            }
        }
        found
    }

    /// The counts of a loop from the first to the one behind the last.
    fn bounds(&mut self, head: &Loop, statements: &[Statement]) -> Result<(usize, usize), Fault> {
        if !self.names.is_free(&head.variable, self.diagnostics) {
            return Err(Fault);
        }
        let ends = [&head.low, &head.high];
        for instruction in ends.into_iter().flat_map(|Expression { code }| code) {
            let Operation::Name(used) = &instruction.operation else { continue };
            let is_let = |statement: &Statement| matches!(&statement.kind, StatementKind::Let { name, .. } if name.text == *used);
            if !self.names.is_scoped(used) && statements.iter().any(is_let) {
                let message = format!("the loop has events, and its range uses `{used}`, which is a `let`");
                let help = format!("make it a constant: `const {used}: 1 = …;`");
                self.diagnostics.report(instruction.span, message, help);
                return Err(Fault);
            }
        }
        let written = head.low.is_literal() && head.high.is_literal();
        self.elaborate(|work| {
            let (low, high) = (work.value(&head.low)?, work.value(&head.high)?);
            work.range(&low, &high, written)
        })
    }
}

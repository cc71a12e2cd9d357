//! Head of a loop: `for i in 0..3 {`.

use super::ast::{Instruction, Loop, Operation, Operator};
use super::expression::{closed_range, expression};
use super::parser::{Parser, Read};

const FOR: &str = "write `for i in 0..3 { … }`";
/// Reads a loop after `for`, the brace that opens its body included.
pub fn read_loop(parser: &mut Parser<'_>) -> Read<Loop> {
    let variable = parser.name(FOR)?;
    if !parser.take_word("in") {
        return parser.expected("`in`", FOR);
    }
    let low = expression(parser)?;
    if !parser.at_pair('.', '.') {
        return parser.expected("`..`", FOR);
    }
    parser.skip(2);
    let (closed, span) = (closed_range(parser), parser.span());
    let mut high = expression(parser)?;
    if closed {
        // Read as what was meant, so that the body's rows are those.
        let one = Operation::Number { value: 1.0, unit: None, integer: true };
        high.code
            .extend([one, Operation::Binary(Operator::Add)].map(|operation| Instruction { operation, span }));
    }
    parser.expect('{', FOR)?;
    Ok(Loop { variable, low, high })
}

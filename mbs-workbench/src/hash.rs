//! Names of folders after their content, and of texts after their tokens.

#[cfg(feature = "program")]
use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// FNV-1a, 64 bits, over the parts with a separator: names a directory, guards nothing.
pub fn hash(parts: &[&[u8]]) -> String {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for byte in parts.iter().flat_map(|part| part.iter().chain(&[0])) {
        hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
    format!("{hash:016x}")
}

/// [`hash`] of the tokens of a text, so that layout and comments are no part of it; of its bytes where it has none.
#[cfg(feature = "program")]
pub fn hash_of_text(source: &str) -> String {
    let Ok(tokens) = source.parse::<TokenStream>() else { return hash(&[source.as_bytes()]) };
    let mut words: Vec<String> = Vec::new();
    let mut streams = vec![(tokens.into_iter(), "")];
    while let Some((stream, close)) = streams.last_mut() {
        match stream.next() {
            Some(TokenTree::Group(group)) => {
                let [open, close] = match group.delimiter() {
                    Delimiter::Brace => ["{", "}"],
                    Delimiter::Bracket => ["[", "]"],
                    Delimiter::Parenthesis => ["(", ")"],
                    Delimiter::None => ["", ""],
                };
                words.push(open.to_string());
                streams.push((group.stream().into_iter(), close));
            }
            Some(token) => words.push(token.to_string()),
            None => {
                words.push(close.to_string());
                streams.pop();
            }
        }
    }
    hash(&words.iter().map(String::as_bytes).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_tells_parts_apart() {
        assert_ne!(hash(&[b"ab", b"c"]), hash(&[b"a", b"bc"]));
        assert_eq!(hash(&[b""]).len(), 16);
    }
}

//! Effects and scenes of a text as they are written, and copies of a text with other scenes.

use core::ops::Range;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Effects and scenes of a text that is kept as a string, in its order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EffectGroups {
    /// Names of the effects.
    pub effects: Vec<String>,
    /// Names of the declared scenes with those of their effects.
    pub scenes: Vec<(String, Vec<String>)>,
    /// Place of each effect in bytes of the text, its documentation included.
    effect_places: Vec<Range<usize>>,
    /// Place of each scene.
    scene_places: Vec<Range<usize>>,
}

/// Before: any string. After: its effects and scenes; none where it is no token stream.
pub fn effects(source: &str) -> EffectGroups {
    let mut found = EffectGroups::default();
    let Ok(tokens) = source.parse::<TokenStream>() else { return found };
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    // Documentation stands in front of the statement that it is about: a mark and a group each.
    let mut documented = None;
    while let Some(token) = tokens.get(at) {
        let next = |offset: usize| tokens.get(at + offset);
        match (token, next(1), next(2)) {
            (TokenTree::Punct(mark), Some(TokenTree::Group(_)), _) if mark.as_char() == '#' => {
                documented.get_or_insert_with(|| bytes(token).start);
                at += 2;
                continue;
            }
            (TokenTree::Ident(word), Some(TokenTree::Ident(name)), Some(TokenTree::Group(body)))
                if word == "effect" && body.delimiter() == Delimiter::Brace =>
            {
                let start = documented.unwrap_or(bytes(token).start);
                found.effects.push(plain(name));
                found.effect_places.push(start..body.span_close().byte_range().end);
                at += 3;
            }
            (TokenTree::Ident(word), Some(TokenTree::Ident(name)), Some(TokenTree::Punct(_)))
                if word == "scene" =>
            {
                let rest = tokens.get(at + 3..).unwrap_or_default();
                let ends = |token: &TokenTree| match token {
                    TokenTree::Punct(mark) => mark.as_char() == ';',
                    TokenTree::Group(_) => true,
                    _ => false,
                };
                let length = rest.iter().position(ends).unwrap_or(rest.len());
                let names = rest.iter().take(length).filter_map(|token| match token {
                    TokenTree::Ident(name) => Some(plain(name)),
                    _ => None,
                });
                found.scenes.push((plain(name), names.collect()));
                let start = documented.unwrap_or(bytes(token).start);
                let end = rest.get(length).map_or(source.len(), |token| bytes(token).end);
                found.scene_places.push(start..end);
                at += 4 + length;
            }
            _ => at += 1,
        }
        documented = None;
    }
    found
}

fn plain(name: &proc_macro2::Ident) -> String {
    name.to_string().trim_start_matches("r#").to_owned()
}

fn bytes(token: &TokenTree) -> Range<usize> {
    token.span().byte_range()
}

impl EffectGroups {
    /// The text `source`, which they are of, with the effects `kept` alone and `scenes` in place of its own. All lines keep their
    /// numbers; the scenes stand at the end. A scene without effects selects one that is empty.
    ///
    /// Without scenes the copy is the scene of all its effects.
    pub fn with_scenes(&self, source: &str, kept: &[String], scenes: &[(String, Vec<String>)]) -> String {
        let left_out = self.effects.iter().zip(&self.effect_places).filter(|(name, _)| !kept.contains(name));
        let places: Vec<&Range<usize>> = left_out.map(|(_, place)| place).chain(&self.scene_places).collect();
        let is_out = |byte: usize| places.iter().any(|place| place.contains(&byte));
        let blank = |(byte, letter): (usize, char)| match letter {
            '\n' => '\n',
            _ if is_out(byte) => ' ',
            letter => letter,
        };
        let mut copy: String = source.char_indices().map(blank).collect();
        copy.push('\n');
        if scenes.iter().any(|(_, effects)| effects.is_empty()) {
            copy += &format!("effect {NOTHING} {{}}\n");
        }
        for (name, effects) in scenes {
            copy += &format!("{}\n", statement(name, effects));
        }
        copy
    }
}

/// Name of the empty effect.
const NOTHING: &str = "nothing_more";

/// The statement of a scene, without effects of the base alone.
pub fn statement(name: &str, effects: &[String]) -> String {
    let effects = if effects.is_empty() { NOTHING.to_string() } else { effects.join(" + ") };
    format!("scene {name} = {effects};")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "mechanism Box;\ncoord effect: m;\n/// Slides.\neffect slow { drive d: effect == 1m; }\n\
                        effect fast { drive d: effect == 2m; }\n/// All.\nscene Both = slow + fast { title \"Both\"; }\nout scene: m = 1m;\nscene One = slow;\n";

    fn strings(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_string()).collect()
    }

    #[test]
    fn effects_and_scenes_are_found_where_they_are_declared() {
        let found = effects(TEXT);
        assert_eq!(found.effects, ["slow", "fast"]);
        let scenes =
            [("Both".to_string(), strings(&["slow", "fast"])), ("One".to_string(), strings(&["slow"]))];
        assert_eq!(found.scenes, scenes);
        assert_eq!(effects("mechanism A; ("), EffectGroups::default());
    }

    #[test]
    fn a_copy_has_other_scenes_at_the_lines_of_the_text() {
        let scenes = [("None".to_string(), Vec::new()), ("Other".to_string(), strings(&["fast"]))];
        let copy = effects(TEXT).with_scenes(TEXT, &strings(&["fast"]), &scenes);
        let lines: Vec<&str> = copy.lines().map(str::trim_end).collect();
        assert_eq!(lines[2..5], ["", "", "effect fast { drive d: effect == 2m; }"]);
        assert_eq!(lines[5..8], ["", "", "out scene: m = 1m;"]);
        let end = ["effect nothing_more {}", "scene None = nothing_more;", "scene Other = fast;"];
        assert_eq!(lines[lines.len() - 3..], end);
        assert_eq!(copy.find("out scene"), TEXT.find("out scene"));
    }
}

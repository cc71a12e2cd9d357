//! Type parameters of the emitted struct: one a declared function, then the scalar, then the scene.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use crate::model::Model;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::selection::{OF_SCENES, alias};
use crate::syntax::Text;
use crate::syntax::rust_identifiers::is_keyword;

/// Type parameters of a mechanism.
pub struct Generics {
    /// Names of the declared functions of all scenes, and their types.
    functions: Vec<(String, Ident)>,
    /// `true` if the scene is a parameter too.
    scenes: bool,
}

impl Generics {
    /// Before: the scenes of a text. After: one type for each declared function, named as the function in camel case,
    /// `LiftLaw` for `lift_law`. It differs from every other type in scope.
    pub fn of(text: &Text, scenes: &Scenes) -> Self {
        let mut taken: Vec<String> = vec!["T".into(), "S".into(), "AllEffects".into()];
        for scene in [""].into_iter().chain(scenes.scenes.iter().filter_map(Scene::label)) {
            let alias = alias(&text.header, scene);
            taken.extend(OF_SCENES.map(|suffix| format!("{alias}{suffix}")));
            taken.extend([scene.to_owned(), alias]);
        }
        let functions = scenes.shared.functions.iter().map(|function| {
            let base = camel_case(&function.name.text);
            let numbered = (2..).map(|number| format!("{base}Function{number}"));
            let candidates = [base.clone(), format!("{base}Function")].into_iter().chain(numbered);
            let free = |name: &String| !taken.contains(name) && !is_keyword(name);
            let name = candidates.into_iter().find(free).unwrap_or(base);
            taken.push(name.clone());
            (function.name.text.clone(), Ident::new(&name, Span::call_site()))
        });
        Generics { functions: functions.collect(), scenes: scenes.are_declared() }
    }

    /// The types of the functions.
    pub fn functions(&self) -> impl Iterator<Item = &Ident> {
        self.functions.iter().map(|(_, kind)| kind)
    }

    /// The types of the functions of a scene, as text.
    pub fn types_in(&self, model: &Model) -> Vec<String> {
        let kind = |name: &str| self.functions.iter().find(|(known, _)| known == name);
        let kinds = model.functions.iter().map(|function| kind(&function.name.text));
        kinds.map(|kind| kind.map_or_else(String::new, |(_, kind)| kind.to_string())).collect()
    }

    /// `Lift, T = f64, S = AllEffects`: parameters of the struct where it is declared.
    pub fn declared(&self, runtime: &TokenStream) -> TokenStream {
        let functions = self.functions();
        let scene = self.scenes.then(|| quote! { , S = #runtime::AllEffects });
        quote! { #(#functions,)* T = ::core::primitive::f64 #scene }
    }

    /// `Lift: bound, T: Scalar, S`: of an implementation for all scenes.
    pub fn of_all_scenes(&self, runtime: &TokenStream, bound: &TokenStream) -> TokenStream {
        let functions = self.functions();
        let scene = self.scenes.then(|| quote! { , S });
        quote! { #(#functions #bound,)* T: #runtime::Scalar #scene }
    }

    /// `Lift: Function<T> + …, T: Scalar`: of an implementation for a scene, which calls its own functions alone.
    pub fn callable(&self, model: &Model, runtime: &TokenStream) -> TokenStream {
        let called = |name: &str| model.functions.iter().any(|function| function.name.text == name);
        let functions = self.functions.iter().map(|(name, kind)| {
            let function = called(name).then(|| {
                let function = quote! { #runtime::Function };
                quote! { #function<T> + #function<T::Real> + }
            });
            quote! { #kind: #function ::core::clone::Clone }
        });
        quote! { #(#functions,)* T: #runtime::Scalar }
    }

    /// `Lift: Function<T> + … + 'static, T: Scalar`: of a scene that shows its sizes.
    pub fn revealed(&self, model: &Model, runtime: &TokenStream) -> TokenStream {
        let called = |name: &str| model.functions.iter().any(|function| function.name.text == name);
        let functions = self.functions.iter().map(|(name, kind)| {
            let function = called(name).then(|| {
                let function = quote! { #runtime::Function };
                quote! { #function<T> + #function<T::Real> + }
            });
            quote! { #kind: #function ::core::clone::Clone + 'static }
        });
        quote! { #(#functions,)* T: #runtime::Scalar }
    }

    /// `Lift: Clone, __U: Scalar`: of a scene in other numbers.
    pub fn in_numbers(&self, runtime: &TokenStream) -> TokenStream {
        let functions = self.functions();
        quote! { #(#functions: ::core::clone::Clone,)* __U: #runtime::Scalar }
    }

    /// `Lift, T, S`: arguments of the struct where it is used.
    pub fn arguments(&self, scalar: &TokenStream, scene: Option<TokenStream>) -> TokenStream {
        let functions = self.functions();
        let scene = scene.map(|scene| quote! { , #scene });
        quote! { #(#functions,)* #scalar #scene }
    }

    /// The scene's parameter, where there is one.
    pub fn scene(&self) -> Option<TokenStream> {
        self.scenes.then(|| quote! { S })
    }
}

/// `lift_law` → `LiftLaw`; a name without a letter at its beginning gets one.
fn camel_case(name: &str) -> String {
    let words = name.split('_').filter(|word| !word.is_empty());
    let capitalised = words.map(|word| {
        let mut letters = word.chars();
        let first = letters.next().into_iter().flat_map(char::to_uppercase);
        first.chain(letters).collect::<String>()
    });
    let joined: String = capitalised.collect();
    let begins_well = joined.chars().next().is_some_and(char::is_alphabetic);
    if begins_well { joined } else { format_ident!("F{joined}").to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_functions_become_names_of_types() {
        let cases = [
            ("lift", "Lift"),
            ("lift_law2", "LiftLaw2"),
            ("f64", "F64"),
            ("_1", "F1"),
            ("__", "F"),
            ("θ_x", "ΘX"),
            ("self_", "Self"),
        ];
        for (name, expected) in cases {
            assert_eq!(camel_case(name), expected, "{name}");
        }
    }
}

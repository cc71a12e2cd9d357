//! Scenes of a comparison: sets of effects, their names, their sizes as the text has them.

use mbs_codegen::{EffectGroups, Operations, StructureReport};

/// Most effects of a comparison.
pub const MOST_EFFECTS: usize = 12;

/// Effects of a scene by their places in the list of the comparison, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Scene(pub u16);

impl Scene {
    /// All of `count` effects.
    pub fn whole(count: usize) -> Self {
        Scene((0..count).fold(0, |bits, index| bits | 1 << index))
    }
    /// The effect at `index` alone.
    pub fn only(index: usize) -> Self {
        Scene(1 << index)
    }
    /// `true` if it has the effect at `index`.
    pub fn has(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }
    /// The scene without the effect at `index`.
    pub fn without(self, index: usize) -> Self {
        Scene(self.0 & !(1 << index))
    }
    /// Number of its effects.
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }
    /// `true` if it is the base alone.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
    /// Its effects of `all`.
    pub fn effects(self, all: &[String]) -> Vec<String> {
        all.iter().enumerate().filter(|(index, _)| self.has(*index)).map(|(_, name)| name.clone()).collect()
    }
    /// Name of its type: the numbers of its effects, for names of effects may not tell sets apart.
    pub fn name(self) -> String {
        format!("Compared{}", self.0)
    }
}

/// The text whose effects are compared.
#[derive(Clone, Debug)]
pub struct Text {
    /// The text.
    pub source: String,
    /// Its effects and scenes.
    pub groups: EffectGroups,
    /// Effects of the whole, at most [`MOST_EFFECTS`] of them compared.
    pub effects: Vec<String>,
    /// Effects that every scene has.
    pub kept: Vec<String>,
}

impl Text {
    /// The text with `scenes` in place of its own.
    pub fn copy(&self, scenes: &[Scene]) -> String {
        let in_some = |index: &usize| scenes.iter().any(|scene| scene.has(*index));
        let used = (0..self.effects.len()).filter(in_some).map(|index| self.effects[index].clone());
        let named: Vec<(String, Vec<String>)> =
            scenes.iter().map(|scene| (scene.name(), self.all_of(*scene))).collect();
        let used: Vec<String> = used.chain(self.kept.clone()).collect();
        self.groups.with_scenes(&self.source, &used, &named)
    }

    /// Effects of a scene with those that every scene has, in the order of the text.
    pub fn all_of(&self, scene: Scene) -> Vec<String> {
        let own = scene.effects(&self.effects);
        let is_in = |name: &&String| own.contains(name) || self.kept.contains(name);
        self.groups.effects.iter().filter(is_in).cloned().collect()
    }

    /// Sizes of a scene, or the reason why it is none.
    ///
    /// # Errors
    /// The first fault of the text with this scene alone.
    pub fn measures(&self, scene: Scene) -> Result<Measures, String> {
        // Presets may set parameters of effects that the scene leaves out: the whole declares them.
        let whole = Scene::whole(self.effects.len());
        let others = if scene == whole { &[][..] } else { &[whole][..] };
        let copy = self.copy(&[&[scene], others].concat());
        // The name of a compared scene tells a reader nothing.
        let plain = |words: &str| {
            words
                .replace(&format!("in scene `{}`", scene.name()), "there")
                .replace(&scene.name(), "the scene")
        };
        // All that the macro checks: a scene that is pasted compiles.
        mbs_codegen::outline(&copy)
            .map_err(|faults| faults.first().map_or_else(String::new, |fault| plain(&fault.message)))?;
        let report =
            mbs_codegen::structure_of(&copy, Some(&scene.name())).map_err(|faults| plain(&faults))?;
        Ok(Measures::of(&report))
    }
}

/// Sizes of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measures {
    /// Coordinates.
    pub coordinates: usize,
    /// Rows.
    pub rows: usize,
    /// Operations of the emitted functions of a right-hand side; where drives move the scene, of a step.
    pub operations: usize,
}

impl Measures {
    fn of(report: &StructureReport) -> Self {
        /// Functions of a right-hand side.
        const EVALUATED: [&str; 8] = [
            "`position` (once a `(q, t)`)",
            "`phi`",
            "`phi_q`",
            "`phi_t`",
            "`gamma`",
            "`mass`",
            "`force`",
            "`state_rates`",
        ];
        let total = |operations: &Operations| {
            let Operations { additions, multiplications, divisions, sine_cosines, functions, selects, calls } =
                operations;
            additions + multiplications + divisions + sine_cosines + functions + selects + calls
        };
        let is_square = report.rows.len() >= report.coordinates.len();
        let evaluated = report.costs.iter().filter(|(name, _)| EVALUATED.contains(name));
        Measures {
            coordinates: report.coordinates.len(),
            rows: report.rows.len(),
            operations: match is_square {
                true => report.operations,
                false => evaluated.map(|(_, operations)| total(operations)).sum(),
            },
        }
    }
}
